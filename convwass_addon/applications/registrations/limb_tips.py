# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The limbs of a symmetric shape: where their tips are, how much surface is around these, and where they point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.mirror_planes import MirrorPlane
from ...geometry.meshes.surface_graph import surface_distances, surface_graph
from ...geometry.meshes.surface_tips import surface_tips
from .mirrored_sides import relative_heights

# Chosen by eye on animals and people, in sizes of the surface. The persistence of the tip of a limb, which is 0.13 to
# 0.46 for legs, heads and tails, 0.08 for the short arms of a kangaroo and at most 0.06 for ears; the radius around the
# tip in which its area is measured; and the largest distance of a tip from the mirror image of its counterpart.
_PERSISTENCE, _AROUND, _MIRRORED = 0.07, 0.35, 0.15
# Two tips of a symmetric pair that are this close, such as horns, may count as one in the middle: a head.
_CLOSE = 0.45
# A shape looks where its head is, if that is so far from its center, in sizes of the surface, and otherwise where its
# toes are, if these are so far from the middle of the foot and the shin.
_HEAD_AHEAD, _TOES_AHEAD = 0.2, 0.03
# Toes tell nothing unless the shin is upright: when people squat or kneel, it lies ahead of the foot or behind it.
# Between these distances from the tip, its middle then moves forward or back by more than this share of the height: by
# at most 0.23 in people who stand or sit on a chair, by 0.3 in those who sit on the floor, and by at least 0.57 in
# those who squat, kneel or jump.
_SHIN, _MOST_LEAN = (0.15, 0.23, 0.31, 0.39), 0.27
# A limb of a long shape is this far from its center: heads of four-legged animals are 0.34 to 0.76 ahead, and toes of
# people 0.1, or 0.26 if they sit.
_LONG = 0.3


@dataclass(frozen=True)
class Limb:
    """A limb in the mirror plane, or a symmetric pair of limbs.

    Attributes
    ----------
    tips : tuple of int
        Indices in the tips of the shape: of one limb, or of the left and the right one.
    middle : int or None
        Index of a tip in the mirror plane that may stand for the limb; None for pairs whose tips are far apart.
    """

    tips: tuple[int, ...]
    middle: int | None


@dataclass(frozen=True)
class Limbs:
    """The limbs of a shape.

    Attributes
    ----------
    limbs : list of Limb
    vertices : (t,) int64
        Vertices of the tips.
    shares : (t,) float64
        Shares of the surface around the tips.
    heights : (t,) float64
        How far up the tips are, from 0 to 1.
    apart : (t, t) float64
        Distances between the tips on the surface, in sizes of the surface.
    ahead, pointing : (t,) float64
        How far the tips are from the center of the shape, and from that of the surface around them, along the
        horizontal direction of the mirror plane, in sizes of the surface.
    upright : (t,) bool
        Whether the limbs rise from their tips without leaning forward or back, as the shins of standing people.
    """

    limbs: list[Limb]
    vertices: NDArray[np.int64]
    shares: NDArray[np.float64]
    heights: NDArray[np.float64]
    apart: NDArray[np.float64]
    ahead: NDArray[np.float64]
    pointing: NDArray[np.float64]
    upright: NDArray[np.bool_]

    @classmethod
    def of(cls, mesh: TriangleMesh, plane: MirrorPlane) -> Limbs:
        """Find the limbs of a shape that is nearly symmetric in a plane."""
        tips = surface_tips(mesh, _PERSISTENCE)
        vertices = [tip.vertex for tip in tips]
        distances = [tip.distances for tip in tips]
        limbs = []
        for own in _symmetric(mesh, plane, vertices):
            if len(own) == 1:
                limbs.append(Limb(own, own[0]))
            elif distances[own[0]][vertices[own[1]]] > _CLOSE:
                limbs.append(Limb(own, None))
            else:
                limbs.append(Limb(own, len(vertices)))
                between = mesh.vertices[[vertices[tip] for tip in own]].mean(axis=0)
                # Not on another component, such as an eye.
                away = np.where(np.isfinite(distances[own[0]]), np.linalg.norm(mesh.vertices - between, axis=1), np.inf)
                vertices.append(int(away.argmin()))
                distances.append(surface_distances(surface_graph(mesh), vertices[-1:])[0] / mesh.root_area)
        away = np.array(distances).reshape(len(vertices), len(mesh.vertices))
        around = (away < _AROUND) * mesh.vertex_areas
        forward = np.cross([0.0, 0.0, 1.0], plane.normal) / mesh.root_area
        along, ends = mesh.vertices @ forward, np.array(vertices, np.int64)
        return cls(
            limbs,
            ends,
            shares=around.sum(axis=1) / mesh.area,
            heights=relative_heights(mesh)[ends],
            apart=away[:, ends],
            ahead=along[ends] - mesh.area_center @ forward,
            pointing=along[ends] - around @ along / around.sum(axis=1),
            upright=np.array([_is_upright(mesh, along, own) for own in away], bool),
        )

    @property
    def count(self) -> int:
        """Number of tips."""
        return sum(len(limb.tips) for limb in self.limbs)

    @property
    def is_long(self) -> bool:
        """Whether the shape extends along its mirror plane, as animals do, instead of upward."""
        return bool(np.abs(self.ahead).max() > _LONG)

    @property
    def costs(self) -> NDArray[np.float64]:
        """What the limbs cost that have no counterpart, in mean limbs: the bulk around their tips."""
        bulks = np.array([self.shares[list(limb.tips)].sum() for limb in self.limbs])
        return bulks * self.count / bulks.sum()

    def heading(self, known: Sequence[list[int]]) -> int:
        """Return whether the shape looks along the horizontal direction of its mirror plane.

        It looks where its head is, the bulkiest limb in the middle, or where its toes are if its shins are upright.

        Parameters
        ----------
        known : sequence of list of int
            The tips of limbs that it has in common with another shape.

        Returns
        -------
        int
            1, or -1 for the opposite direction, or 0 if that is not known.
        """
        head = max((own for own in known if len(own) == 1), key=lambda own: self.shares[own[0]], default=[])
        feet = min((own for own in known if len(own) == 2), key=lambda own: self.heights[own].mean(), default=[])
        feet = feet if self.upright[feet].all() else []
        for tips, offsets, least in ((head, self.ahead, _HEAD_AHEAD), (feet, self.pointing, _TOES_AHEAD)):
            if tips and abs(offsets[tips].mean()) > least:
                return int(np.sign(offsets[tips].mean()))
        return 0


def _is_upright(mesh: TriangleMesh, along: NDArray[np.float64], away: NDArray[np.float64]) -> bool:
    """Return whether the middle of a shin rises without moving forward or back.

    Parameters
    ----------
    mesh : TriangleMesh
        The shape.
    along, away : (n,)
        How far ahead its vertices are, and how far from the tip of the limb, in sizes of the surface.
    """
    parts = [mesh.vertex_areas * ((away >= low) & (away < high)) for low, high in pairwise(_SHIN)]
    if not all(part.any() for part in parts):
        return False
    heights = mesh.vertices[:, 2] / mesh.root_area
    ahead, up = (np.diff([part @ values / part.sum() for part in parts]) for values in (along, heights))
    return bool((np.abs(ahead) <= _MOST_LEAN * up).all())


def _symmetric(mesh: TriangleMesh, plane: MirrorPlane, vertices: list[int]) -> list[tuple[int, ...]]:
    """Return the tips that are their own mirror images, and pairs of tips that are each other's, the left one first."""
    if not vertices:
        return []
    points = mesh.vertices[vertices]
    away = np.linalg.norm(points[None] - plane.mirrored(points)[:, None], axis=2) / mesh.root_area
    sides, found = plane.heights(points), []
    for tip, image in enumerate(away.argmin(axis=1).tolist()):
        if image == tip:
            found.append((tip,))
        elif away[image].argmin() == tip and away[tip, image] < _MIRRORED and sides[tip] > sides[image]:
            found.append((tip, image))
    return found
