# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One shape deformed to lie on another, split into how its parts turn and how they stretch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import InputError
from ...geometry.closest_points import ClosestPoints
from ...geometry.edges import vertex_components
from ...geometry.elastic_surface import ElasticSurface
from ...geometry.facing_points import FacingPointFinder
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import vertex_normals
from ...geometry.poisson_deformation import deformation_gradients
from ...geometry.registration import Registration, Stage
from ...geometry.rotation_fields import rotation_matrices, rotation_vectors, unwound, unwound_towards
from ...geometry.rotations import nearest_rotations
from ...geometry.surface_projection import drawn_along_normals
from ...geometry.unit_shape import UnitShape
from ...progress import Control
from ..soft_maps.surface_maps import PointMap
from .carriers import Carrier

# From the map's points to the other surface: first as the map says, then as smooth as the surfaces allow. Tighter
# stages gain little closeness and turn triangles over.
_STAGES = (
    Stage(0.0, 100.0, 0.06, 3),
    Stage(20.0, 30.0, 0.05, 5),
    Stage(100.0, 5.0, 0.04, 6),
    Stage(300.0, 0.0, 0.03, 5),
)
# Size of the neighborhoods that turn together, in sizes of the surface.
_TURN_WIDTH = 0.03
# Vertices around a part without counterpart that say how it moves.
_AROUND = 40


@dataclass(frozen=True)
class ShapeDeformation:
    """How a shape is deformed to lie on another.

    The gradient of triangle t is exp(r_t) Q_t, where r_t is the mean of the rotation vectors of its corners.

    Attributes
    ----------
    points : (n, 3) float64
        Where the carrier's vertices come to lie, scene units.
    vectors : (n, 3) float64
        Rotation vectors of its vertices, radians, continuous along the surface.
    stretches : (m, 3, 3) float64
        Q of every triangle.
    link_stretches : (k, 3) float64
        What every link becomes, turned back by its rotation.
    scale : float
        How much longer lengths of the whole shape become.
    images : ClosestPoints
        The points of the other carrier on which its vertices come to lie.
    confidence : (n,) float64
        How far the map was trusted there, 0 to 1.
    """

    points: NDArray[np.float64]
    vectors: NDArray[np.float64]
    stretches: NDArray[np.float64]
    link_stretches: NDArray[np.float64]
    scale: float
    images: ClosestPoints
    confidence: NDArray[np.float64]

    def inverse_vectors_at(self, images: ClosestPoints, mesh: TriangleMesh) -> NDArray[np.float64]:
        """Return the rotation vectors of the way back, (k, 3), at points of the carrier's mesh."""
        return -images.interpolated(self.vectors[mesh.faces])


def laid_points(
    source: Carrier, target: Carrier, found: PointMap, pairs: NDArray[np.int64], control: Control
) -> NDArray[np.float64]:
    """Return the vertices of one carrier laid on another, (n, 3): as similar to the source as its surface allows.

    Parameters
    ----------
    source, target : Carrier
        The two shapes.
    found : PointMap
        A point of the target's mesh for every vertex of the source's.
    pairs : (k, 2) int64
        Vertices of the two meshes that belong together.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        No vertex has a point.
    """
    mesh = source.mesh
    own = _mapped_part(mesh, found, source.name, target.name)
    part = TriangleMesh(mesh.vertices[own], _renumbered(mesh.faces, own, len(mesh.vertices)))
    shape, other = UnitShape.of(part), UnitShape.of(target.mesh)
    size = np.sqrt(target.mesh.area)
    center = target.mesh.vertices[0] - size * other.vertices[0]
    start = found.positions(target.mesh)[own]
    lost = ~found.found[own]
    start[lost] = 0.0
    ours = pairs[np.isin(pairs[:, 0], own)]
    ours = np.stack([np.searchsorted(own, ours[:, 0]), ours[:, 1]], axis=1)
    confidence = np.where(lost, 0.0, found.confidence[own])
    laid = Registration(shape, other, ours, (start - center) / size, confidence)
    for stage in _STAGES:
        for _ in range(stage.rounds):
            control.check()
            laid.advance(Stage(stage.closeness, stage.trust, stage.width, 1))
    moved = drawn_along_normals(TriangleMesh(size * laid.points + center, part.faces), target.mesh, control)
    return _with_others(mesh.vertices, own, moved)


def split_deformation(
    source: Carrier,
    target: Carrier,
    points: NDArray[np.float64],
    confidence: NDArray[np.float64],
    back: ShapeDeformation | None,
    control: Control,
) -> ShapeDeformation:
    """Split a deformation into rotations and stretches.

    Parameters
    ----------
    source, target : Carrier
        The shape that is deformed, and the one it lies on then.
    points : (n, 3)
        Where the vertices of the source's mesh lie then.
    confidence : (n,)
        How far the map is trusted there.
    back : ShapeDeformation, optional
        How the target is deformed to lie on the source, where that is known: parts that may turn either way then take
        the same one.
    control : Control
        Stops the work.
    """
    mesh, links = source.mesh, source.poisson.links
    control.check()
    images = FacingPointFinder(target.mesh).find(points, vertex_normals(points, mesh.faces), control=control)
    shortest = rotation_vectors(_smooth_rotations(mesh, points))
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]], links.ends])
    edges = np.sort(edges, axis=1)
    edges = edges[np.unique(edges[:, 0] * len(points) + edges[:, 1], return_index=True)[1]]
    if back is None:
        vectors = unwound(shortest, edges)
    else:
        vectors = unwound_towards(shortest, back.inverse_vectors_at(images, target.mesh), edges)
    turns = rotation_matrices(vectors[mesh.faces].mean(axis=1))
    stretches = np.swapaxes(turns, 1, 2) @ deformation_gradients(mesh.vertices, points, mesh.faces)
    link_turns = rotation_matrices(vectors[links.ends].mean(axis=1))
    link_stretches = np.einsum("kji,kj->ki", link_turns, points[links.ends[:, 0]] - points[links.ends[:, 1]])
    scale = float(np.sqrt(TriangleMesh(points, mesh.faces).area / mesh.area))
    return ShapeDeformation(points, vectors, stretches, link_stretches, scale, images, confidence)


def _smooth_rotations(mesh: TriangleMesh, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations of neighborhoods of every vertex, (n, 3, 3)."""
    centered = (points - points.mean(axis=0)) / np.sqrt(mesh.area)
    fits = ElasticSurface(UnitShape.of(mesh)).fits(centered, _TURN_WIDTH)
    turns = nearest_rotations(np.ascontiguousarray(np.moveaxis(fits, 0, 2))).rotations
    return np.ascontiguousarray(np.moveaxis(turns, 2, 0))


def _mapped_part(mesh: TriangleMesh, found: PointMap, name: str, other: str) -> NDArray[np.int64]:
    """Return the vertices of the components of which some vertex has a point."""
    labels = vertex_components(mesh)
    known = found.found & (labels >= 0)
    if not known.any():
        raise InputError("No point of {name} has a counterpart on {other}.", name=name, other=other)
    return np.flatnonzero((labels >= 0) & np.isin(labels, labels[known]))


def _renumbered(faces: NDArray[np.int64], own: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return the triangles of some vertices only, (f, 3), in their numbers."""
    if len(own) == count:
        return faces
    place = np.full(count, -1, np.int64)
    place[own] = np.arange(len(own))
    kept = place[faces]
    return kept[(kept >= 0).all(axis=1)]


def _with_others(rest: NDArray[np.float64], own: NDArray[np.int64], moved: NDArray[np.float64]) -> NDArray[np.float64]:
    """Let all other vertices go, turned and scaled, with the moved ones around each, (n, 3)."""
    points = np.empty_like(rest)
    points[own] = moved
    others = np.setdiff1d(np.arange(len(rest)), own)
    if not len(others):
        return points
    nearest = cKDTree(rest[own]).query(rest[others], min(_AROUND, len(own)))[1].reshape(len(others), -1)
    before, after = rest[own][nearest], moved[nearest]
    here, there = before.mean(axis=1), after.mean(axis=1)
    before, after = before - here[:, None], after - there[:, None]
    fitted = nearest_rotations(np.einsum("nki,nkj->ijn", after, before))
    scales = fitted.traces / np.maximum(np.square(before).sum(axis=(1, 2)), np.finfo(float).tiny)
    turned = np.einsum("ijn,nj->ni", fitted.rotations, rest[others] - here)
    points[others] = there + np.maximum(scales, 0.0)[:, None] * turned
    return points
