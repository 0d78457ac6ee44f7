# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated flat shapes whose insides follow a map between their outlines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array
from scipy.spatial import cKDTree

from ...geometry.algebra.factorization import factorize
from ...geometry.deformation.foldover_free import DeformedTriangles, foldover_free
from ...geometry.meshes.edges import proper_part, rim_vertices, vertex_components
from ...geometry.meshes.laplacian import laplacian
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.plane.closed_curves import ClosedCurve, boundary_of
from ...geometry.remeshing.planar_mesh import planar_mesh, without_bridges
from ...progress import Control
from .outline_pairs import ShapePair
from .outlined_shape import OutlinedShape

# Spacing of vertices along narrow gaps, relative to the square root of the area; gaps of up to so many times that are
# narrow; and how many times as far the sides are apart along the curve.
_NARROW, _GAP, _AROUND = 0.003, 2.0, 6.0
# Least number of vertices along a curve.
_FEWEST = 24
# Stiffness of the springs that hold the outline; an edge between two equilateral triangles has 0.58.
_HELD = 1e8


def outline_knots(
    shapes: Sequence[OutlinedShape], matches: Mapping[tuple[int, int], ShapePair]
) -> list[list[NDArray[np.float64]]]:
    """Return the places of corners and marks on every curve of every shape, and the images of those of the others."""
    corners = [[shape.knots(index) for index in range(len(shape.curves))] for shape in shapes]
    found = [[[own] for own in shape] for shape in corners]
    for (one, other), match in matches.items():
        for pair in match.pairs:
            found[one][pair.first].append(pair.map.inverse()(corners[other][pair.second]))
            found[other][pair.second].append(pair.map(corners[one][pair.first]))
    return [[np.concatenate(own) for own in shape] for shape in found]


def region_meshes(shape: OutlinedShape, knots: Sequence[NDArray[np.float64]], edge: float) -> list[TriangleMesh]:
    """Triangulate the regions of a shape, with vertices at the knots of every curve.

    Parameters
    ----------
    shape : OutlinedShape
        The shape, whose regions may nearly touch, or overlap while they are points.
    knots : sequence of (k,)
        Places on every curve.
    edge : float
        Length of the edges, relative to the size of the shape.
    """
    length = edge * shape.filled.root_area
    found = []
    for region in shape.regions:
        curves = [shape.curves[index] for index in region.curves]
        narrow = _narrow_places(curves, shape.filled.root_area)
        rim = [
            curve.resampled(np.concatenate([knots[index], own]), min(length, curve.length / _FEWEST))
            for index, curve, own in zip(region.curves, curves, narrow, strict=True)
        ]
        mesh = without_bridges(planar_mesh(boundary_of(rim), length))
        # Where an outline is finer than the triangles, some of its points belong to none.
        used, faces = proper_part(mesh)
        found.append(TriangleMesh(mesh.vertices[used], faces))
    return found


def _narrow_places(curves: Sequence[ClosedCurve], size: float) -> list[NDArray[np.float64]]:
    """Return places on the curves around a region, close to each other, where gaps are narrower than triangles.

    Triangles with corners farther apart than the gap is wide would reach across it.
    """
    spacing = _NARROW * size
    places = [np.arange(0.0, curve.length, spacing) for curve in curves]
    points = np.concatenate([curve.at(own) for curve, own in zip(curves, places, strict=True)])
    owner = np.repeat(np.arange(len(curves)), [len(own) for own in places])
    along, lengths = np.concatenate(places), np.array([curve.length for curve in curves])
    one, other = cKDTree(points).query_pairs(_GAP * spacing, output_type="ndarray").T
    apart = np.abs(along[one] - along[other])
    apart = np.minimum(apart, lengths[owner[one]] - apart)
    is_gap = (owner[one] != owner[other]) | (apart > _AROUND * _GAP * spacing)
    chosen = np.unique(np.concatenate([one[is_gap], other[is_gap]]))
    return [along[chosen[owner[chosen] == index]] for index in range(len(curves))]


def region_labels(mesh: TriangleMesh, shape: OutlinedShape) -> NDArray[np.int64]:
    """Return the region of a shape that every vertex of a mesh of it belongs to, (n,).

    Every connected component of the mesh fills the region to whose curves its boundary is closest.
    """
    if len(shape.regions) == 1:
        return np.zeros(len(mesh.vertices), np.int64)
    components = vertex_components(mesh)
    vertices = rim_vertices(mesh.faces)
    away = [
        np.min([shape.curves[index].nearest(mesh.vertices[vertices, :2])[1] for index in region.curves], axis=0)
        for region in shape.regions
    ]
    total = np.stack([np.bincount(components[vertices], own) for own in away])
    return total.argmin(axis=0)[components]


@dataclass(frozen=True)
class Rim:
    """The vertices of a mesh that lie on the closed curves around it.

    Attributes
    ----------
    vertices : (k,) int64
        Their indices.
    curves : (k,) int64
        The nearest of the curves.
    places : (k,) float64
        Their places on it.
    """

    vertices: NDArray[np.int64]
    curves: NDArray[np.int64]
    places: NDArray[np.float64]

    @classmethod
    def of(cls, mesh: TriangleMesh, shape: OutlinedShape) -> Rim:
        """Find the places of the vertices on the boundary of a mesh of a shape."""
        vertices = rim_vertices(mesh.faces)
        labels = region_labels(mesh, shape)[vertices]
        curves, places = np.empty(len(vertices), np.int64), np.empty(len(vertices))
        for region, own in enumerate(shape.regions):
            rows = np.flatnonzero(labels == region)
            found = [shape.curves[index].nearest(mesh.vertices[vertices[rows], :2]) for index in own.curves]
            nearest = np.argmin([away for _, away in found], axis=0)
            curves[rows] = np.array(own.curves)[nearest]
            places[rows] = np.stack([place for place, _ in found])[nearest, np.arange(len(rows))]
        return cls(vertices, curves, places)

    def on(self, curve: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the vertices on a curve and their places, in order."""
        own = np.flatnonzero(self.curves == curve)
        order = own[np.argsort(self.places[own], kind="stable")]
        return self.vertices[order], self.places[order]


def filled_outline(mesh: TriangleMesh, match: ShapePair, control: Control) -> DeformedTriangles:
    """Return the first shape's mesh with its outline on the second shape's, without folds.

    Parameters
    ----------
    mesh : TriangleMesh
        The mesh of the first shape.
    match : ShapePair
        The match of the shapes.
    control : Control
        Stops the work.
    """
    rim = Rim.of(mesh, match.first)
    target, held = np.zeros((len(mesh.vertices), 2)), np.zeros(len(mesh.vertices), bool)
    for pair in match.pairs:
        own, places = rim.on(pair.first)
        target[own] = match.second.curves[pair.second].at(pair.map(places))
        held[own] = True
    # The harmonic map to start with.
    stiffness = csc_array(laplacian(mesh).matrix + diags_array(np.where(held, _HELD, 0.0)))
    start = factorize(stiffness).solve(np.ascontiguousarray((_HELD * target).T)).T
    return foldover_free(mesh, np.where(held[:, None], target, start), held, control)
