# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Laplacians of triangle meshes that keep heat nonnegative for any triangulation."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control
from ..arrays.chunks import chunks
from .delaunay import closed_surface, flipped_to_delaunay, heron_areas
from .edges import proper_part, side_lengths
from .mesh import TriangleMesh
from .normals import triangle_areas

# Mollification makes every triangle inequality hold by this fraction of the mean edge length (Sharp and Crane 2020).
_MARGIN = 1e-5
# Weights are cotangents, of order one. Negative weights of the tufted cover (edges are flipped until none is below
# -1e-6) and rounding errors are smaller than this.
_NOTICEABLE = 1e-5
# Triangles processed together.
_AT_ONCE = 1 << 16
# Upper limit of coordinates: squared lengths, and their squares, must stay within float64.
_LARGEST = 1e75


class TuftedLaplacianError(ArithmeticError):
    """The tufted Laplacian of a mesh could not be computed in float64."""


@dataclass(frozen=True)
class Laplacian:
    """Stiffness and lumped areas of a triangle mesh.

    Attributes
    ----------
    matrix : (n, n) csc_array
        Stiffness L, positive semi-definite: exactly symmetric, without positive off-diagonal entries, and with row sums
        of zero up to rounding. Zero at vertices without area. It does not depend on the scale of the mesh.
    areas : (n,) float64
        Area around every vertex, in squared units of the mesh. Zero at vertices that no non-degenerate triangle uses,
        positive everywhere else.
    method : "tufted" or "cotangent"
        How the weights were computed.
    clamped : int
        Number of edges with a negative weight, which was set to zero because it would move heat the wrong way.
    """

    matrix: csc_array
    areas: NDArray[np.float64]
    method: Literal["tufted", "cotangent"]
    clamped: int


def laplacian(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> Laplacian:
    """Return the tufted Laplacian of `mesh` if it can be computed, otherwise the cotangent Laplacian.

    The tufted Laplacian needs float64 to be precise enough for many edge flips and, for edges with more than two
    triangles, robust_laplacian. Cancelling `control` stops the work.

    Raises
    ------
    InputError
        No triangle has any area, or coordinates are too large or too small to compute with.
    """
    with suppress(ImportError, TuftedLaplacianError):
        return tufted_laplacian(mesh, control)
    return cotangent_laplacian(mesh)


def tufted_laplacian(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> Laplacian:
    """Return the Laplacian of the intrinsic Delaunay triangulation of the mesh's tufted cover.

    Negative weights are rounding errors only, and edges may have any number of triangles. N. Sharp and K. Crane, "A
    Laplacian for Nonmanifold Triangle Meshes", Computer Graphics Forum 39(5), 2020.

    robust_laplacian handles every mesh but blocks Blender meanwhile, for 40 s with a million vertices. It is only used
    where more than two triangles share an edge, or where rounding keeps the flips of :mod:`.delaunay` from ending.

    Raises
    ------
    ImportError
        robust_laplacian is needed but not installed.
    InputError
        No triangle has any area, or coordinates are too large or too small to compute with.
    TuftedLaplacianError
        robust_laplacian failed, as it may for edges that differ in length by more than about 1e10.
    """
    surface = _unit_surface(mesh)
    control.check()
    return _by_flips(surface, control) or _by_robust_laplacian(surface)


def _by_flips(surface: _UnitSurface, control: Control) -> Laplacian | None:
    """Flip many edges at once; None for edges with more than two triangles or if float64 is not precise enough."""
    # Length of the side that starts at each corner.
    lengths = np.roll(_mollified(_edge_lengths(surface)), -2, axis=1)
    control.check()
    closed = closed_surface(surface.faces, lengths)
    if closed is None:
        return None
    control.check()
    with np.errstate(all="ignore"):
        flipped = flipped_to_delaunay(closed, control)
    if flipped is None:
        return None
    control.check()
    count = len(surface.vertices)
    tails = flipped.tails.reshape(-1, 3)
    heads = np.roll(tails, -1, axis=1)
    # Half of each weight, because every edge occurs once per side.
    weights = (0.5 / closed.sheets) * flipped.cotangents
    halves = coo_array((weights.ravel(), (tails.ravel(), heads.ravel())), shape=(count, count))
    areas = np.bincount(tails.ravel(), np.repeat(flipped.areas / (3.0 * closed.sheets), 3), count)
    control.check()
    return _assemble(surface, halves, areas, "tufted", control) if areas.min() > 0 else None


def _by_robust_laplacian(surface: _UnitSurface) -> Laplacian:
    from robust_laplacian import mesh_laplacian

    try:
        stiffness, masses = mesh_laplacian(surface.vertices, surface.faces, mollify_factor=_MARGIN)
    except RuntimeError as error:
        raise TuftedLaplacianError(f"robust_laplacian failed: {error}") from error
    areas = masses.diagonal()
    if not (np.isfinite(stiffness.data).all() and np.isfinite(areas).all() and areas.min() > 0):
        raise TuftedLaplacianError("robust_laplacian returned areas or weights that are not numbers.")
    entries = coo_array(stiffness)
    # Half of each weight, because a symmetric matrix contains every edge twice.
    weights = coo_array((-0.5 * entries.data, entries.coords), shape=entries.shape)
    return _assemble(surface, weights, areas, "tufted")


def cotangent_laplacian(mesh: TriangleMesh) -> Laplacian:
    """Return the cotangent Laplacian of the mesh, with negative weights set to zero.

    Computed from edge lengths alone. All lengths are increased by the same amount, the smallest that makes the triangle
    inequalities hold by a margin (mollification, section 4.5 of Sharp and Crane 2020), so that degenerate triangles
    also have areas and angles. U. Pinkall and K. Polthier, "Computing Discrete Minimal Surfaces and Their Conjugates",
    Experimental Mathematics 2(1), 1993.

    Raises
    ------
    InputError
        No triangle has any area, or coordinates are too large or too small to compute with.
    """
    surface = _unit_surface(mesh)
    lengths = _mollified(_edge_lengths(surface))
    areas = heron_areas(lengths)
    squares = lengths**2
    # Column c belongs to the edge opposite corner c, whose weight is half the cotangent of the angle at c.
    weights = (squares.sum(axis=1, keepdims=True) - 2.0 * squares) / (8.0 * areas[:, None])
    tails, heads = np.roll(surface.faces, -1, axis=1), np.roll(surface.faces, -2, axis=1)
    count = len(surface.vertices)
    entries = coo_array((weights.ravel(), (tails.ravel(), heads.ravel())), shape=(count, count))
    thirds = np.bincount(surface.faces.ravel(), np.repeat(areas / 3.0, 3), count)
    return _assemble(surface, entries, thirds, "cotangent")


@dataclass(frozen=True)
class _UnitSurface:
    """The non-degenerate triangles of a mesh and the vertices that they use, rescaled to unit size.

    Attributes
    ----------
    vertices : (k, 3) float64
        The largest extent is one.
    faces : (j, 3) int64
        Three different vertices each.
    used : (k,) int64
        Index of every vertex in the mesh.
    count : int
        Number of vertices of the mesh.
    scale : float
        Length in the mesh of one unit.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    used: NDArray[np.int64]
    count: int
    scale: float


def _unit_surface(mesh: TriangleMesh) -> _UnitSurface:
    used, faces = proper_part(mesh)
    if not len(used):
        raise InputError("The mesh has no triangle with three different vertices.")
    vertices = mesh.vertices[used]
    reach = float(np.abs(vertices).max())
    if reach > _LARGEST:
        raise InputError("The mesh is too large to calculate with: its coordinates reach {reach:.3g}.", reach=reach)
    vertices = vertices - 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    scale = float(np.ptp(vertices, axis=0).max())
    if 0 < scale < 1.0 / _LARGEST:
        raise InputError("The mesh is too small to calculate with: it is {scale:.3g} long.", scale=scale)
    if scale > 0:
        surface = _UnitSurface(vertices / scale, faces, used, len(mesh.vertices), scale)
        if _has_area(surface, reach / scale):
            return surface
    raise InputError("The mesh has no area: the corners of every triangle lie on a line or in a point.")


def _has_area(surface: _UnitSurface, reach: float) -> bool:
    """Return whether any triangle is higher than the rounding error of coordinates of size `reach`."""
    least = 8.0 * np.finfo(float).eps * max(reach, 1.0)
    # Usually one of the first triangles is.
    for some in chunks(len(surface.faces), _AT_ONCE):
        corners = surface.vertices[surface.faces[some]]
        if (2.0 * triangle_areas(corners) > least * side_lengths(corners).max(axis=1)).any():
            return True
    return False


def _edge_lengths(surface: _UnitSurface) -> NDArray[np.float64]:
    """Length of the edge opposite each corner, (j, 3)."""
    points, (a, b, c) = surface.vertices, surface.faces.T
    return np.stack([np.linalg.norm(points[one] - points[other], axis=1) for one, other in ((b, c), (c, a), (a, b))], 1)


def _mollified(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    slack = lengths.sum(axis=1) - 2.0 * lengths.max(axis=1)
    return lengths + max(0.0, _MARGIN * lengths.mean() - slack.min())


def _assemble(
    surface: _UnitSurface,
    halves: coo_array,
    areas: NDArray[np.float64],
    method: Literal["tufted", "cotangent"],
    control: Control = UNINTERRUPTED,
) -> Laplacian:
    """Sum the weights of every edge in both directions, clamp them, and expand to the vertices of the mesh."""
    one_way = halves.tocsc()
    control.check()
    weights = (one_way + one_way.T).tocoo()
    control.check()
    rows, columns = weights.coords
    clamped = np.count_nonzero((weights.data < -_NOTICEABLE) & (rows < columns))
    keep = (weights.data > 0) & (rows != columns)
    rows, columns, values = rows[keep], columns[keep], weights.data[keep]
    # Without negative weights D_a + t L is an M-matrix: its inverse is nonnegative, and a Cholesky solve only adds
    # numbers of one sign, so even heat of 1e-200 is accurate to many digits.
    diagonal = np.bincount(columns, values, len(areas))
    control.check()
    used = surface.used
    matrix = coo_array(
        (
            np.concatenate([-values, diagonal]),
            (np.concatenate([used[rows], used]), np.concatenate([used[columns], used])),
        ),
        shape=(surface.count, surface.count),
    )
    spread = np.zeros(surface.count)
    spread[used] = areas * surface.scale**2
    return Laplacian(matrix.tocsc(), spread, method, int(clamped))
