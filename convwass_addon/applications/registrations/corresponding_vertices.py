# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes whose vertices correspond by their numbers, such as poses of one mesh: they need no map."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from ...geometry.algebra.rotations import nearest_rotation
from ...geometry.arrays.label_groups import label_groups
from ...geometry.arrays.label_sums import label_sums
from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.edges import proper_faces, vertex_components
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.touching_components import touching_components
from ...geometry.meshes.welding import place_labels
from .carriers import Carrier
from .laid_meshes import Laid
from .map_detour import map_detour
from .pair_maps import PairMap
from .pair_merits import MappedPair
from .pair_registration import LaidPair

# Least share of triangles that meshes with the same polygons have in common: Blender divides a quad along another
# diagonal if the first one would fold it. Of components that touch, too, at least this share touches in every pose.
_COMMON = 0.7
# Components with equal numbers of vertices and triangles, such as boxes, may have been joined in any order. Their order
# counts if other pairs would move the surface by at most this much less in the mean square, in areas of the shape: two
# legs of a table, 4 cm thick, that change places move it by 0.007.
_ARBITRARY = 5e-4
# Smaller turns, as traces of rotations (45 degrees), are seen. After others, some of the corners of so many triangles
# must be farther from the shape than this, in its sizes: 0.04 for a cable from the other end that also rolls.
_SMALL_TURN, _SOME, _ALIKE = 1.0 + np.sqrt(2.0), 2000, 0.05
# More components of one kind are compared with the nearest ones instead of the best pairs, which takes seconds for
# thousands, such as strands of hair.
_MOST_PAIRED = 500


def vertices_correspond(first: TriangleMesh, second: TriangleMesh) -> bool:
    """Return whether two shapes are versions of one mesh, so that vertices with the same number correspond.

    They have the same polygons, facing the same way. If they consist of several components of the same kind, those with
    the same numbers are near each other, apart from a turn of the whole shape, or touch the same other ones, as the
    limbs and clothes of a character do in every pose. That turn can be seen: a cable that was drawn from the other end
    does not turn around.
    """
    if len(first.vertices) != len(second.vertices) or len(first.faces) != len(second.faces):
        return False
    if not (first.area > 0.0 and second.area > 0.0):
        return False
    if not np.array_equal(first.faces, second.faces) and _common_triangles(first, second) < _COMMON:
        return False
    # Whoever asks about the shapes in the other order gets the same answer.
    return all(_components_correspond(*way) for way in ((first, second), (second, first)))


def _components_correspond(first: TriangleMesh, second: TriangleMesh) -> bool:
    """Return whether components with the same numbers correspond, and a turn to the second shape can be seen."""
    components = _Components.of(first, second)
    if components.excess_movement > _ARBITRARY and not components.touch_the_same((first, second)):
        return False
    is_seen = np.trace(components.turn) >= _SMALL_TURN
    return bool(is_seen or not all(_looks_alike(mesh, components.turn) for mesh in (first, second)))


def _looks_alike(mesh: TriangleMesh, turn: NDArray[np.float64]) -> bool:
    """Return whether a shape looks the same after a turn about its center."""
    center = mesh.area_center
    some = mesh.corners[:: 1 + len(mesh.faces) // _SOME, 0] - center
    found = ClosestPointFinder(mesh.corners).find_about(some @ turn.T + center)
    return bool(found.distances.max() <= _ALIKE * mesh.root_area)


def corresponding_pair(shapes: tuple[TriangleMesh, TriangleMesh], carriers: tuple[Carrier, Carrier]) -> MappedPair:
    """Register two shapes whose vertices correspond: every point moves to the same place of the other shape.

    Parameters
    ----------
    shapes : (TriangleMesh, TriangleMesh)
        The shapes.
    carriers : (Carrier, Carrier)
        Their carriers.
    """
    laid = tuple(_laid(own, shape, other) for own, shape, other in zip(carriers, shapes, shapes[::-1], strict=True))
    meshes = carriers[0].mesh, carriers[1].mesh
    detour = map_detour(meshes, (laid[0].points, laid[1].points))
    return MappedPair(
        LaidPair(*laid, confidence=1.0), PairMap.unneeded(), symmetry=None, detour=detour, by_vertices=True
    )


def _laid(carrier: Carrier, shape: TriangleMesh, other: TriangleMesh) -> Laid:
    places = carrier.embedding(shape).interpolated(other.vertices[shape.faces])[carrier.seeds]
    return Laid(places, np.ones(len(places)))


def _common_triangles(first: TriangleMesh, second: TriangleMesh) -> float:
    """Return the share of the triangles of a mesh that another one of as many triangles has, too."""
    both = np.concatenate([first.faces, second.faces])
    # Every triangle begins with its smallest vertex.
    begun = np.take_along_axis(both, (both.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    # Equal rows get equal numbers, those of points as well as those of triangles.
    kinds, count = place_labels(begun), len(first.faces)
    counts = [np.bincount(own, minlength=len(kinds)) for own in (kinds[:count], kinds[count:])]
    return float(np.minimum(*counts).sum() / count)


@dataclass(frozen=True)
class _Components:
    """The connected components of two shapes with the same triangles.

    Attributes
    ----------
    labels : (n,) int64
        The component of every vertex; -1 where no triangle uses it.
    centers : (2, c, 3) float64
        By shape, relative to its center and in its sizes.
    areas : (c,) float64
        Mean areas, in those of the shapes.
    kinds : (c,) int64
        Equal for components with equal numbers of vertices and triangles.
    turn : (3, 3) float64
        The rotation that is nearest to that of most components about their own centers.
    """

    labels: NDArray[np.int64]
    centers: NDArray[np.float64]
    areas: NDArray[np.float64]
    kinds: NDArray[np.int64]
    turn: NDArray[np.float64]

    @classmethod
    def of(cls, first: TriangleMesh, second: TriangleMesh) -> _Components:
        """Find the components of the first shape, and where they are on the second one."""
        labels = vertex_components(first)
        used = labels >= 0
        own, count = labels[used], int(labels.max(initial=-1)) + 1
        sizes = np.bincount(own, minlength=count)
        triangles = np.bincount(labels[proper_faces(first.faces)[:, 0]], minlength=count)
        _, kinds = np.unique(np.stack([sizes, triangles], axis=1), axis=0, return_inverse=True)
        points = [(mesh.vertices[used] - mesh.area_center) / mesh.root_area for mesh in (first, second)]
        areas = [np.bincount(own, mesh.vertex_areas[used], count) / mesh.area for mesh in (first, second)]
        centers = np.stack([label_sums(own, each, count) for each in points]) / sizes[:, None]
        here, there = (each - center[own] for each, center in zip(points, centers, strict=True))
        turn = nearest_rotation((first.vertex_areas[used, None] * there).T @ here)
        return cls(labels, centers, 0.5 * (areas[0] + areas[1]), kinds, turn)

    @cached_property
    def partners(self) -> NDArray[np.int64]:
        """For each, the one of its kind whose place it would take if all moved as little as possible, (c,).

        Relative to the centers of the shapes, and after the first one is turned.
        """
        partners, (here, there) = np.arange(len(self.kinds)), self._turned_centers
        for own in label_groups(self.kinds, int(self.kinds.max()) + 1):
            partners[own] = own[_partners_of_kind(here[own], there[own], self.areas[own])]
        return partners

    @property
    def excess_movement(self) -> float:
        """How much farther they move than to their partners, in the mean square, in areas of the shapes."""
        here, there = self._turned_centers
        swapped = 0.5 * (self.areas + self.areas[self.partners])
        return float(
            self.areas @ np.square(here - there).sum(axis=1)
            - swapped @ np.square(here - there[self.partners]).sum(axis=1)
        )

    def touch_the_same(self, shapes: tuple[TriangleMesh, TriangleMesh]) -> bool:
        """Return whether those that touch on one shape touch on the other, and more so than their partners would."""
        here, there = (touching_components(shape, self.labels) for shape in shapes)
        kept, swapped = (_common_pairs(own, there) for own in (here, np.sort(self.partners[here], axis=1)))
        return kept >= _COMMON * min(len(here), len(there)) and kept > swapped

    @property
    def _turned_centers(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The centers on both shapes, (c, 3) each, after the first one is turned."""
        return self.centers[0] @ self.turn.T, self.centers[1]


def _common_pairs(here: NDArray[np.int64], there: NDArray[np.int64]) -> int:
    """Return how many of some pairs of numbers, (k, 2), are among others, (l, 2)."""
    shifted = int(max(here.max(initial=0), there.max(initial=0))) + 1, 1
    return int(np.isin(here @ shifted, there @ shifted).sum())


def _partners_of_kind(
    here: NDArray[np.float64], there: NDArray[np.float64], areas: NDArray[np.float64]
) -> NDArray[np.intp]:
    """Return for components of one kind, (k, 3) centers, which of them they would be paired with, (k,)."""
    if len(here) > _MOST_PAIRED:
        return cKDTree(there).query(here)[1]
    # A large one and a small one that change places count alike, whichever shape comes first.
    return linear_sum_assignment(cdist(here, there, "sqeuclidean") * (areas[:, None] + areas))[1]
