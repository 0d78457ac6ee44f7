# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh a level set with quads of even size instead of the slivers of marching cubes.

The vertices of the dual surface are moved along the surface to the mean of their neighbors, and back onto it by Newton
steps. The density is interpolated as that of a blurred solid: see :func:`straightened`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..arrays.chunks import chunks
from ..grids.boxes import padded_box
from ..grids.cubic_sampling import cubic_samples
from ..meshes.mesh import TriangleMesh
from .dual_surface import DualSurface, dual_surface
from .isosurface import LevelSurface
from .quad_cleaning import without_short_edges

# Rounds of smoothing. On a horse at 64 cells the first percentile of angles is 29 degrees after one, 32 after two.
_ROUNDS = 2
# Largest distance in cells by which vertices may leave their cubes, so that the surface cannot fold.
_LEEWAY = 0.3
# Largest Newton step in cells. On a horse, an octopus and a turned box, the dual is up to 0.24 off the surface.
_LONGEST_STEP = 0.3
# Smaller gradients do not determine the position of the surface. Typical values are 1.1; the least on a horse is 0.47.
_LEAST_SLOPE = 0.05
# The volume is restored by shifting all vertices along their normals, typically by 0.004 cells. If more than this
# fraction of the volume was missing, it is measured again, up to this many times.
_MUCH_MISSING, _SHIFTS = 5e-3, 6
# Samples around those inside: interpolation takes two, and vertices leave their cubes.
_MARGIN = 3
# Samples whose density differs from the level by more than this fraction of it are far from the surface.
_FAR = 0.95
# A quad whose area, projected along its former normal, falls below this fraction counts as flipped. Fragments of a
# thousandth of a cell shrink to less and could turn inside out.
_LEAST_AREA = 0.05
# Power series of the inverse error function, erfinv(e) = sqrt(pi) / 2 (e + pi / 12 e^3 + ...).
_SERIES = (1.0, np.pi / 12, 7 * np.pi**2 / 480, 127 * np.pi**3 / 40320, 4369 * np.pi**4 / 5806080)
# Diagonals of a quad with at least this ratio of lengths count as equally long; the first one is then chosen.
_EQUAL = 0.98
# Layers of cells that are processed together, to save memory.
_SLAB = 32


def even_surface(surface: LevelSurface, density: NDArray[np.floating]) -> LevelSurface:
    """Remesh a level set: about as many triangles, with the same topology and volume, without slivers.

    Parameters
    ----------
    surface : LevelSurface
        From :func:`.isosurface.surface_at_level`.
    density : (nx, ny, nz)
        The density of the level set.

    Returns
    -------
    LevelSurface
        Triangles 2 i and 2 i + 1 of its mesh form a quad (a, b, c, d) as (a, b, c) and (a, c, d). A few single
        triangles may follow the quads.
    """
    box, low = padded_box(density, density > surface.level, _MARGIN, 0.0)
    dual = without_short_edges(dual_surface(surface.mesh.moved(-low - 0.5), box > surface.level))
    field = straightened(box, surface.level)
    # On fine grids, it is large.
    del box
    points, normals = _evened(dual, field)
    mesh = TriangleMesh(points + (low + 0.5), _triangles(points, dual))
    return LevelSurface(_enclosing(mesh, normals, surface.mesh.volume), surface.level)


def straightened(density: NDArray[np.floating], level: float) -> NDArray[np.float32]:
    """Convert a density, (nx, ny, nz), to an approximate signed distance, positive inside, up to a constant factor.

    Next to a flat face, a solid blurred by sigma has the density level (1 + erf(d / (sqrt(2) sigma))) at the signed
    distance d. For sigma = 0.7, interpolating the density itself has errors of up to 0.03 cells, and interpolating d of
    0.004 (on a sphere with a radius of 20 cells).
    """
    result = np.empty(density.shape, np.float32)
    for own in chunks(len(density), _SLAB):
        excess = np.subtract(density[own], np.float32(level), dtype=np.float32)
        excess /= np.float32(level)
        np.clip(excess, -_FAR, _FAR, out=excess)
        square = excess * excess
        slab = result[own]
        slab[...] = _SERIES[-1]
        for coefficient in _SERIES[-2::-1]:
            slab *= square
            slab += np.float32(coefficient)
        slab *= excess
    return result


def _evened(dual: DualSurface, field: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the moved points of a dual and the outward unit normals of the field there, both (n, 3).

    Points without a nearby surface, as on tips and fragments that are too small for the field, are only moved to the
    mean of their neighbors. Points that would flip or collapse a quad are not moved. The normals of both are zero.
    """
    low, high = dual.cubes - _LEEWAY, dual.cubes + (1.0 + _LEEWAY)
    middles = _Middles(dual)
    points, normals, found = _projected(dual.points, field, low, high)
    points[~found], normals[~found] = dual.points[~found], 0.0
    for _ in range(_ROUNDS):
        moves = middles.of(points) - points
        moves -= np.einsum("nd,nd->n", moves, normals)[:, None] * normals
        points = np.clip(points + moves, low, high)
    relaxed = points
    points, normals, _ = _projected(relaxed, field, low, high)
    points[~found], normals[~found] = relaxed[~found], 0.0
    before, after = (_area_vectors(at, dual.quads) for at in (dual.points, points))
    remaining, former = (np.einsum("nd,nd->n", before, vectors) for vectors in (after, before))
    turned = dual.quads[remaining < _LEAST_AREA * former]
    points[turned], normals[turned] = dual.points[turned], 0.0
    return points, normals


def _area_vectors(points: NDArray[np.float64], quads: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return normals of quads, (q, 3), whose length is twice the area."""
    a, b, c, d = (points[own] for own in quads.T)
    return np.cross(c - a, d - b)


def _projected(
    points: NDArray[np.float64], field: NDArray[np.float32], low: NDArray[np.float64], high: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Move points by a Newton step towards the zero level of a field, within boxes.

    Returns
    -------
    points : (n, 3) float64
    normals : (n, 3) float64
        Unit normals before the step, outward; shorter where gradients are too small.
    found : (n,) bool
        Whether a surface was found nearby.
    """
    samples = cubic_samples(field, points)
    lengths = np.linalg.norm(samples.gradients, axis=1)
    slopes = np.maximum(lengths, _LEAST_SLOPE)
    normals = samples.gradients / -slopes[:, None].astype(np.float64)
    steps = samples.values / slopes
    found = (np.abs(steps) < _LONGEST_STEP) & (lengths > _LEAST_SLOPE)
    steps = np.clip(steps, -_LONGEST_STEP, _LONGEST_STEP)
    return np.clip(points + steps[:, None] * normals, low, high), normals, found


def _enclosing(mesh: TriangleMesh, normals: NDArray[np.float64], volume: float) -> TriangleMesh:
    """Shift a surface along the normals of its vertices, (n, 3), until it encloses a volume."""
    for _ in range(_SHIFTS):
        missing = volume - mesh.volume
        shift = np.clip(missing / mesh.area, -_LEEWAY, _LEEWAY)
        mesh = TriangleMesh(mesh.vertices + shift * normals, mesh.faces)
        if abs(missing) <= _MUCH_MISSING * abs(volume):
            break
    return mesh


class _Middles:
    """Means of the centers of the faces around every point of a surface."""

    def __init__(self, dual: DualSurface) -> None:
        quads, triangles, count = len(dual.quads), len(dual.triangles), len(dual.points)
        corners = np.concatenate([dual.quads.ravel(), dual.triangles.ravel()])
        ends = np.concatenate([np.arange(0, 4 * quads, 4), np.arange(4 * quads, len(corners) + 1, 3)])
        self._faces = csr_array((np.ones(len(corners)), corners, ends), shape=(quads + triangles, count))
        self._shares = np.repeat([1.0 / 4.0, 1.0 / 3.0], [quads, triangles])[:, None]
        self._faces_around = np.bincount(corners, minlength=count)[:, None]

    def of(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the means for points at given positions, (n, 3)."""
        return self._faces.T @ ((self._faces @ points) * self._shares) / self._faces_around


def _triangles(points: NDArray[np.float64], dual: DualSurface) -> NDArray[np.int64]:
    """Cut quads along their shorter diagonals; faces that are triangles come last."""
    a, b, c, d = (points[own] for own in dual.quads.T)
    lengths = [np.einsum("nd,nd->n", line, line) for line in (c - a, d - b)]
    across = lengths[1] < _EQUAL**2 * lengths[0]
    quads = np.where(across[:, None], np.roll(dual.quads, -1, axis=1), dual.quads)
    return np.concatenate([quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3), dual.triangles])
