# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts attached to solids of revolution that become each other, such as the handles of two jugs, follow a map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.mesh import TriangleMesh
from ...geometry.rotations import nearest_rotation
from ..motions.coherence import FULL_COHERENCE
from ..motions.guided_motion import GuidedMotion
from ..motions.motion import Motion, MovedShape, arriving, unmoved
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
    places : ClosestPoints
        Where they are on the surface that the map moves.
    body : (k,) int64
        Some vertices of the body.
    body_places : ClosestPoints
        Where these are on that surface.
    """

    vertices: NDArray[np.int64]
    looseness: NDArray[np.float64]
    places: ClosestPoints
    body: NDArray[np.int64]
    body_places: ClosestPoints

    @classmethod
    def of(cls, shape: RevolvedShape, labels: NDArray[np.int64], surface: TriangleMesh) -> MappedParts:
        """Find the parts with some labels on the surface that the map moves."""
        vertices = np.flatnonzero(np.isin(shape.attached.labels, labels))
        body = np.flatnonzero(shape.attached.labels == 0)
        body, finder = body[:: 1 + len(body) // _ENOUGH], ClosestPointFinder(surface.corners)
        places, body_places = (finder.find_about(shape.divided.mesh.vertices[own]) for own in (vertices, body))
        return cls(vertices, shape.attached.looseness[vertices], places, body, body_places)


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
        images = [_images(guided, shapes, own) for own in (0, 1)]
        labels = 1 + np.argwhere((images[0] >= _MAPPED) & (images[1].T >= _MAPPED))
        halfway = cls._with(motion, guided, shapes, labels).moved([0.5, 0.5])
        stay = [
            all(_stays(shape, own.vertices, label) for shape, own, label in zip(shapes, halfway, pair, strict=True))
            for pair in labels
        ]
        return cls._with(motion, guided, shapes, labels[stay]) if any(stay) else None

    @classmethod
    def _with(
        cls, motion: Motion, guided: GuidedMotion, shapes: Sequence[RevolvedShape], labels: NDArray[np.int64]
    ) -> MappedPartsMotion:
        """Let the parts with some labels, (m, 2), follow the map."""
        one, other = (
            MappedParts.of(shape, labels[:, index], unmoved(guided, 2, index).rest)
            for index, shape in enumerate(shapes)
        )
        return cls(motion, guided, (one, other))

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return both shapes in a blend; see :meth:`.motion.Motion.moved`."""
        shapes = self.motion.moved(weights)
        if any(own is None for own in shapes):
            return shapes
        corners = [own.mesh.corners for own in self.guided.moved(weights)]
        together = list(zip(shapes, corners, self.parts, strict=True))
        # The map may tilt the bodies. Both shapes are turned back alike, so that their parts still coincide, and not at
        # all where one of them is at rest.
        by_map = np.concatenate([parts.body_places.interpolated(own) for _, own, parts in together])
        by_sections = np.concatenate([shape.vertices[parts.body] for shape, _, parts in together])
        counts = [len(parts.body) for parts in self.parts]
        shares = np.repeat(np.divide(weights, counts), counts)
        center, wanted = shares @ by_map, shares @ by_sections
        turn = nearest_rotation((by_sections - wanted).T @ (shares[:, None] * (by_map - center)))
        found: list[MovedShape | None] = []
        for shape, own, parts in together:
            there = (parts.places.interpolated(own) - center) @ turn.T + wanted
            vertices = shape.vertices.copy()
            vertices[parts.vertices] += parts.looseness[:, None] * (there - vertices[parts.vertices])
            found.append(MovedShape(shape.rest, vertices, shape.parents))
        return found


def _images(guided: GuidedMotion, shapes: Sequence[RevolvedShape], own: int) -> NDArray[np.float64]:
    """Return the share of every part of one of two shapes, (k,), that is mapped to every part of the other, (k, l)."""
    shape, other = shapes[own], shapes[1 - own]
    arrived = arriving(guided.with_coherence(FULL_COHERENCE), 2, own, 1 - own)
    places = ClosestPointFinder(arrived.rest.corners).find_about(shape.divided.mesh.vertices)
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
