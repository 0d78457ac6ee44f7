# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""New meshes of a shape, to replace one that is too coarse, uneven or made of overlapping parts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter

from ...geometry.deformation.surface_projection import drawn_along_normals
from ...geometry.level_sets.even_surface import even_surface
from ...geometry.level_sets.isosurface import surface_enclosing
from ...geometry.level_sets.surface_detail import DetailSource, with_detail
from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.facing_points import FacingShape
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.orientation import orient_outward
from ...geometry.solids.solid_angles import winding_numbers
from ...progress import Control
from ..morphs.volumes import Lattice, voxelized

# Cells over which the occupancy is averaged before its surface is read, as for morphs.
_BLUR = 0.7


@dataclass(frozen=True)
class _Coarse:
    """A surface read from a grid, and the size of a cell in scene units."""

    mesh: TriangleMesh
    cell: float


def even_mesh(mesh: TriangleMesh, name: str, cells: int, control: Control) -> TriangleMesh:
    """Return a closed mesh of a shape with triangles of even size, which are halves of quads.

    Parameters
    ----------
    mesh : TriangleMesh
        The shape, scene units.
    name : str
        What messages call it.
    cells : int
        Cells along the longest side; edges are about as long as a cell.
    control : Control
        Stops the work.

    Returns
    -------
    TriangleMesh
        As :func:`.even_surface.even_surface` orders its triangles.

    Raises
    ------
    InputError
        The shape encloses too little for this resolution.
    """
    outward = orient_outward(mesh)
    coarse = _read(outward, name, cells, control).mesh
    return TriangleMesh(drawn_along_normals(coarse, outward, control), coarse.faces)


def adaptive_mesh(mesh: TriangleMesh, name: str, cells: int, control: Control) -> TriangleMesh:
    """Return a closed mesh of a shape as :func:`even_mesh`, with edges halved where it is curved and along creases."""
    outward = orient_outward(mesh)
    coarse = _read(outward, name, cells, control)
    points = coarse.mesh.vertices
    certain, empty = np.ones(len(points)), lambda places: np.zeros(len(places))
    source = DetailSource(FacingShape(outward), 1.0, points, certain, empty)
    return with_detail(coarse.mesh, [source], coarse.cell, 1.0, coarse.mesh.volume, control).mesh


def missing_reach(mesh: TriangleMesh, remeshed: TriangleMesh, least: float, control: Control) -> float:
    """Return how far a shape reaches outside a closed mesh that was made of it; what is inside is not missing.

    Parameters
    ----------
    mesh, remeshed : TriangleMesh
        The shape and its new mesh.
    least : float
        Smaller distances count as none.
    control : Control
        Stops the work.

    Returns
    -------
    float
        A length, in the units of the meshes.
    """
    points = mesh.vertices[mesh.is_used]
    # Exact distances would take most of the time of large meshes.
    distances = ClosestPointFinder(remeshed.corners).find_about(points, control).distances
    far = distances > least
    outside = winding_numbers(points[far], remeshed) < 0.5
    return float(distances[far].max(where=outside, initial=0.0))


def _read(outward: TriangleMesh, name: str, cells: int, control: Control) -> _Coarse:
    """Voxelize a shape and read its surface."""
    lattice = Lattice.around([outward], cells, _BLUR)
    filled = voxelized(outward, name, 0, lattice, 0.0, control)
    control.check()
    density = gaussian_filter(filled, _BLUR)
    surface = even_surface(surface_enclosing(density, float(filled.sum(dtype=np.float64))), density)
    return _Coarse(lattice.to_scene(surface.mesh, np.ones(1)), lattice.spacing)
