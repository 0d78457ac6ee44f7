# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The outer surface of solids that consist of overlapping bodies, such as furniture made of boxes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from ...progress import UNINTERRUPTED, Control
from ..level_sets.marching_cubes import marching_cubes
from ..meshes.closest_points import ClosestPointFinder, TriangleSamples
from ..meshes.edges import face_components
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import triangle_areas
from .occupancy import occupancy

# Cells along the longest side, and empty ones around.
_CELLS, _MARGIN = 96, 2
# Points of the surface that are not inside, and farther than this from the skin, in cells, are missing from it; up to
# this share of the area may be.
_FAR, _MISSING = 1.0, 0.01


def outer_skin(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> TriangleMesh | None:
    """Return the surface of the union of bodies that overlap, without what is inside.

    Parameters
    ----------
    mesh : TriangleMesh
        Oriented outward.
    control : Control
        Stops the work.

    Returns
    -------
    TriangleMesh or None
        Closed; its vertices lie on the mesh, except at sharp edges. None if no connected components overlap, or if the
        skin would lack parts that are thinner than a cell.
    """
    count = int(face_components(mesh.faces).max(initial=-1)) + 1
    if count < 2 or mesh.longest_side == 0.0:
        return None
    low, spacing = mesh.bounds[0], mesh.longest_side / _CELLS
    corners = (mesh.corners - low) / spacing + _MARGIN
    shape = tuple(np.ceil(np.ptp(mesh.bounds, axis=0) / spacing).astype(int) + 2 * _MARGIN)
    filled = occupancy(corners, shape, control)
    skin = marching_cubes(filled, 0.5)
    if not len(skin.faces) or _bodies(skin) >= count:
        return None
    # Samples are in the centers of cells.
    skin = TriangleMesh(skin.vertices + 0.5, skin.faces)
    control.check()
    if _missing_share(corners, skin, filled) > _MISSING:
        return None
    found = ClosestPointFinder(corners).find_about(skin.vertices, control)
    near = found.distances < _FAR
    vertices = np.where(near[:, None], found.interpolated(corners), skin.vertices)
    return TriangleMesh((vertices - _MARGIN) * spacing + low, skin.faces)


def _bodies(skin: TriangleMesh) -> int:
    """Return the number of closed surfaces that are not around cavities."""
    return int(np.count_nonzero(np.bincount(face_components(skin.faces), skin.face_volumes) > 0.0))


def _missing_share(corners: NDArray[np.float64], skin: TriangleMesh, filled: NDArray[np.float32]) -> float:
    """Return the share of the area of triangles in cells, (m, 3, 3), that is outside of a skin and far from it."""
    samples = TriangleSamples.of(corners)
    areas = samples.divided(triangle_areas(corners))
    outside = map_coordinates(filled, samples.points.T - 0.5, order=1) < 0.5
    away = ClosestPointFinder(skin.corners).find_about(samples.points[outside]).distances
    return float(areas[outside][away > _FAR].sum() / areas.sum())
