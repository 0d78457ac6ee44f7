# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh a level set with larger or smaller faces; its topology and volume stay.

The vertices of the new mesh are chosen by :mod:`.coarsening` among those of the old one, possibly after halving all
edges: evenly by area, but closer together where the surface bends.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..grids.cubic_sampling import cubic_samples
from ..meshes.edge_means import EdgeMeans
from ..meshes.edges import edge_lengths, edge_use
from ..meshes.mesh import TriangleMesh
from ..remeshing.angle_smoothing import with_wider_angles
from ..remeshing.coarsening import coarsened
from ..remeshing.edge_flips import with_flipped_edges
from ..remeshing.subdivision import with_edges_halved
from .even_surface import straightened
from .isosurface import LevelSurface

# Coarsening needs a choice: if there are fewer than this many vertices for each one wanted, edges are halved first.
_LEAST_CHOICE = 2.25
# Larger faces may deviate from the surface by this many cells times the size.
_DEVIATION = 0.05
# Largest step onto the level set, in cells, number of steps, and margin of samples around the density.
_STEP, _STEPS, _MARGIN = 0.3, 2, 3
# The direction to the level set is unreliable where gradients are below this; see `even_surface`.
_LEAST_SLOPE = 0.05
# Edge flips and smoothing may move the surface by at most this many cells times the face size.
_FLAT = 0.03
# Maximum number of steps to restore the volume, and the length of a step in cells.
_SHIFTS, _LONGEST_SHIFT = 3, 0.3


def with_face_size(
    surface: LevelSurface, density: NDArray[np.floating], size: float, control: Control = UNINTERRUPTED
) -> LevelSurface:
    """Remesh an even surface with about 1 / size² as many faces.

    The mesh has more faces where larger ones could not follow the curvature, and thin parts keep enough of them for
    their topology.

    Parameters
    ----------
    surface : LevelSurface
        From :func:`.even_surface.even_surface`; returned unchanged for a size of 1.
    density : (nx, ny, nz)
        The density that it is a level set of.
    size : float
        Length of an edge relative to that of the given mesh, 0.5 or more.
    control : Control
        Stops the work when cancelled.
    """
    if size == 1.0:
        return surface
    given = surface.mesh
    fine = given if size * size >= _LEAST_CHOICE else _halved(given, _Field(density, surface.level))
    weights = fine.vertex_areas * _closeness(fine, size)
    count = round(len(given.vertices) * float(weights.sum()) / fine.area / size**2)
    mesh = fine
    if count < len(fine.vertices):
        coarse = coarsened(fine, weights, count, most=1.0, control=control)
        mesh = fine if coarse is None else coarse.mesh
    mesh = with_wider_angles(with_flipped_edges(mesh, _FLAT * size), _FLAT * size)
    return LevelSurface(_enclosing(mesh, given.volume), surface.level)


class _Field:
    """Moves points onto the level set of a density."""

    def __init__(self, density: NDArray[np.floating], level: float) -> None:
        self._field = straightened(np.pad(density, _MARGIN), level)

    def projected(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points, (n, 3), after a few Newton steps onto the level set."""
        for _ in range(_STEPS):
            samples = cubic_samples(self._field, points + (_MARGIN - 0.5))
            lengths = np.linalg.norm(samples.gradients, axis=1)
            steps = np.clip(samples.values / np.maximum(lengths, _LEAST_SLOPE) ** 2, -_STEP, _STEP)
            points = points - np.where(lengths > _LEAST_SLOPE, steps, 0.0)[:, None] * samples.gradients
        return points


def _halved(mesh: TriangleMesh, field: _Field) -> TriangleMesh:
    """Halve all edges, and move their midpoints onto the level set."""
    use = edge_use(mesh.faces)
    halved = with_edges_halved(mesh, use, np.ones(len(use.start), bool)).mesh
    vertices = halved.vertices.copy()
    vertices[len(mesh.vertices) :] = field.projected(vertices[len(mesh.vertices) :])
    return TriangleMesh(vertices, halved.faces)


def _closeness(mesh: TriangleMesh, size: float) -> NDArray[np.float64]:
    """Return the factor by which the density of vertices, by area, is increased where the surface bends, (n,).

    An edge of length h deviates from a surface of curvature k by k h² / 8.
    """
    if size <= 1.0:
        return np.ones(len(mesh.vertices))
    normals, means = mesh.vertex_normals, EdgeMeans.of(mesh)
    first, second = means.ends.T
    turns = np.linalg.norm(normals[first] - normals[second], axis=1)
    lengths = edge_lengths(mesh.vertices, means.ends)
    curvatures = np.zeros(len(mesh.vertices))
    for ends in (first, second):
        np.maximum.at(curvatures, ends, turns / np.maximum(lengths, np.finfo(float).tiny))
    wanted = np.sqrt(8.0 * _DEVIATION * size / np.maximum(means.mean(curvatures), 1e-6))
    return np.square(size / np.clip(wanted, 1.0, size))


def _enclosing(mesh: TriangleMesh, volume: float) -> TriangleMesh:
    """Shift a surface along its normals until it encloses a volume."""
    for _ in range(_SHIFTS):
        shift = float(np.clip((volume - mesh.volume) / mesh.area, -_LONGEST_SHIFT, _LONGEST_SHIFT))
        mesh = TriangleMesh(mesh.vertices + shift * mesh.vertex_normals, mesh.faces)
    return mesh
