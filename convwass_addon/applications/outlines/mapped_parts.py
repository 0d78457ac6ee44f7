# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts attached to solids of revolution that become each other, such as the handles of two jugs, follow a map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.algebra.rotations import nearest_rotation
from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from ..motions.coherence import FULL_COHERENCE
from ..motions.guided_motion import GuidedMotion
from ..motions.motion import Motion, MovedShape, arriving
from .revolved_shape import RevolvedShape

# Two parts become each other if at least this share of the surface of each is mapped to the other.
_MAPPED = 0.75
# Their feet, the vertices that are at most the first share of the longest side off the body, or the second share of all
# that are nearest to it, move away from it at most by the third one, relative to the longest side. Otherwise, the map
# takes them to something else than the foot of a part, such as the tip of a spout.
_FOOT, _LOWEST, _OFF = 0.03, 0.1, 0.04
# The bodies are aligned by about so many vertices.
_ENOUGH = 1000


@dataclass(frozen=True)
class MappedParts:
    """The parts of one of two shapes that become parts of the other one, and some of its body.

    Attributes
    ----------
    vertices : (n,) int64
        Vertices of the parts.
    looseness : (n,) float64
        How far they move with their part, from 0, on the body, to 1.
    body : (k,) int64
        Some vertices of the body.
    places : ClosestPoints
        Where all vertices of the shape are on the surface that the map moves.
    """

    vertices: NDArray[np.int64]
    looseness: NDArray[np.float64]
    body: NDArray[np.int64]
    places: ClosestPoints

    @classmethod
    def of(cls, shape: RevolvedShape, labels: NDArray[np.int64], places: ClosestPoints) -> MappedParts:
        """Find the parts with some labels of a shape whose vertices have places on the surface that the map moves."""
        vertices = np.flatnonzero(np.isin(shape.attached.labels, labels))
        body = np.flatnonzero(shape.attached.labels == 0)
        return cls(vertices, shape.attached.looseness[vertices], body[:: 1 + len(body) // _ENOUGH], places)


@dataclass(frozen=True)
class MappedPartsMotion:
    """A motion of two solids of revolution, some parts of which follow a map; a :class:`.motion.Motion`.

    Attributes
    ----------
    motion : Motion
        The motion of the solids, whose parts retract.
    guided : GuidedMotion
        The motion by the map.
    parts : tuple of two MappedParts
        The parts of both shapes that follow it.
    """

    motion: Motion
    guided: GuidedMotion
    parts: tuple[MappedParts, MappedParts]

    @classmethod
    def of(cls, motion: Motion, guided: GuidedMotion, shapes: Sequence[RevolvedShape]) -> MappedPartsMotion | None:
        """Return the motion if some parts of two shapes become each other, and None otherwise."""
        places = [
            ClosestPointFinder(carrier.rest.corners).find_about(shape.divided.mesh.vertices)
            for carrier, shape in zip(guided.carriers, shapes, strict=True)
        ]
        images = [_images(guided, shapes, places[own], own) for own in (0, 1)]
        labels = 1 + np.argwhere((images[0] >= _MAPPED) & (images[1].T >= _MAPPED))

        def following(chosen: NDArray[np.int64]) -> MappedPartsMotion:
            one, other = map(MappedParts.of, shapes, chosen.T, places)
            return cls(motion, guided, (one, other))

        halfway = following(labels).moved([0.5, 0.5])
        stay = [
            all(_stays(shape, own.vertices, label) for shape, own, label in zip(shapes, halfway, pair, strict=True))
            for pair in labels
        ]
        return following(labels[stay]) if any(stay) else None

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return both shapes in a blend; see :meth:`.motion.Motion.moved`."""
        shapes = self.motion.moved(weights)
        if any(own is None for own in shapes):
            return shapes
        by_map = [
            parts.places.interpolated(own.mesh.corners)
            for parts, own in zip(self.parts, self.guided.moved(weights), strict=True)
        ]
        # The map may tilt the bodies. Both shapes are turned back alike, so that their parts still coincide, and not at
        # all where one of them is at rest.
        tilted = np.concatenate([own[parts.body] for own, parts in zip(by_map, self.parts, strict=True)])
        upright = np.concatenate([own.vertices[parts.body] for own, parts in zip(shapes, self.parts, strict=True)])
        counts = [len(parts.body) for parts in self.parts]
        shares = np.repeat(np.divide(weights, counts), counts)
        center, wanted = shares @ tilted, shares @ upright
        turn = nearest_rotation((upright - wanted).T @ (shares[:, None] * (tilted - center)))
        found: list[MovedShape | None] = []
        for shape, own, parts in zip(shapes, by_map, self.parts, strict=True):
            there = (own[parts.vertices] - center) @ turn.T + wanted
            vertices = shape.vertices.copy()
            vertices[parts.vertices] += parts.looseness[:, None] * (there - vertices[parts.vertices])
            found.append(MovedShape(shape.rest, vertices, shape.parents))
        return found


def _images(
    guided: GuidedMotion, shapes: Sequence[RevolvedShape], places: ClosestPoints, own: int
) -> NDArray[np.float64]:
    """Return the share of every part of one of two shapes, (k,), that is mapped to every part of the other, (k, l)."""
    shape, other = shapes[own], shapes[1 - own]
    arrived = arriving(guided.with_coherence(FULL_COHERENCE), 2, own, 1 - own)
    arrival = ClosestPointFinder(other.divided.mesh.corners).find_about(places.interpolated(arrived.mesh.corners))
    there = other.attached.labels[other.divided.mesh.faces[arrival.triangles, arrival.shares.argmax(axis=1)]]
    labels, areas = shape.attached.labels, shape.divided.mesh.vertex_areas
    counts = labels.max() + 1, other.attached.labels.max() + 1
    shared = np.bincount(labels * counts[1] + there, areas, counts[0] * counts[1]).reshape(counts)
    return shared[1:, 1:] / shared[1:].sum(axis=1, keepdims=True)


def _stays(shape: RevolvedShape, moved: NDArray[np.float64], label: int) -> bool:
    """Return whether the feet of a part stay on the body, given the moved vertices."""
    rest, size = shape.divided.mesh.vertices, shape.divided.mesh.longest_side
    part = np.flatnonzero((shape.attached.labels == label) & (shape.attached.looseness == 1.0))
    if not len(part):
        return True
    lengths = np.linalg.norm(shape.offsets[part], axis=1)
    feet = part[lengths <= max(_FOOT * size, np.quantile(lengths, _LOWEST))]
    body = np.flatnonzero(shape.attached.labels == 0)
    before, after = (cKDTree(own[body]).query(own[feet])[0].max() for own in (rest, moved))
    return after <= before + _OFF * size
