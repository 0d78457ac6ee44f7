# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The closed, connected surface on which the joints of a skeleton are laid out as densities."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.arrays.components import component_labels
from ...geometry.level_sets.isosurface import surface_at_level
from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.edges import EdgeUse, edge_use, topology, vertex_components
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.welding import welded
from ...geometry.remeshing.coarsening import coarsened
from ...geometry.solids.occupancy import occupancy
from ...geometry.solids.orientation import orient_outward
from ...geometry.solids.solid_angles import Inside, winding_numbers
from ...geometry.solids.thicken import shell_occupancy
from ...progress import UNINTERRUPTED, Control
from ..morphs.volumes import Lattice, voxelized

# The kernel needs vertices closer together than its blur; more than enough only take time.
_FEWEST_VERTICES, _MOST_VERTICES = 800, 4000
# Target number of vertices when larger meshes are reduced.
_REDUCED_VERTICES = 2500
# Above this, inside tests on the mesh itself would dominate the time, so its reduction is used.
_MOST_FACES = 100_000
# Voxelizing a thick shell takes time in proportion to its thickness in cells.
_THICK_RESOLUTION = 80
# Lower limit of vertex areas for spreading seeds, relative to the mean.
_LEAST_AREA = 1e-6
_SIGMA = 1.0

RESOLUTION = 128
"""Cells along the longest side when the body is built from what the mesh encloses."""

MOST_HANDLES = 1000
"""Above this, a body is rebuilt with cells twice as large: it is a thicket rather than a body with limbs, and each
handle keeps about sixteen vertices however far it is reduced."""


@dataclass(frozen=True)
class SkeletonBody:
    """A body, as a surface for laying out joints and as a solid that must contain them.

    Attributes
    ----------
    surface : TriangleMesh
        Closed, connected, with a few thousand vertices, oriented outward.
    inside : Inside
        Inside tests, on the mesh itself if it encloses a volume.
    made : str
        "as it is", "subdivided", "reduced", or "solid" for the surface of what the mesh encloses.
    """

    surface: TriangleMesh
    inside: Inside
    made: str


def skeleton_body(
    mesh: TriangleMesh,
    pins: NDArray[np.float64],
    names: Sequence[str],
    thickness: float = 0.0,
    control: Control = UNINTERRUPTED,
) -> SkeletonBody:
    """Return the body of a mesh, for a skeleton with given pins.

    Parameters
    ----------
    mesh : TriangleMesh
        May be open, disconnected, self-intersecting, with any number of vertices.
    pins : (k, 3)
        Known joints, at least one. If the mesh has parts that do not touch, the body is the part that contains them.
    names : sequence of str
        Names of the pins for messages.
    thickness : float
        Thickness for surfaces that enclose nothing and for closing gaps between parts; 0 for none.
    control : Control
        Stops the work when cancelled.

    Raises
    ------
    InputError
        The mesh encloses nothing, or the pins lie in parts that do not touch.
    ResourceError
        The body does not fit in memory.
    """
    joined = welded(mesh)
    control.check()
    if not len(joined.faces):
        raise InputError("The body has no faces; choose a mesh with a surface.")
    use = edge_use(joined.faces)
    outward = orient_outward(joined, use)
    control.check()
    found = topology(outward, use if outward is joined else None)
    control.check()
    if found.closed and _is_connected(outward, use) and not thickness > 0 and outward.volume > 0:
        sized = _sized(outward, control)
        if sized is not None:
            surface, made = sized
            return SkeletonBody(surface, Inside(outward if len(outward.faces) <= _MOST_FACES else surface), made)
    return _solid_body(outward, pins, names, thickness, control)


def _is_connected(mesh: TriangleMesh, use: EdgeUse) -> bool:
    """Return whether all triangles are connected across edges; heat does not flow through a shared vertex.

    The edge use is independent of the orientation of faces.
    """
    same = np.ones(len(use.face), bool)
    same[use.start] = False
    tails, heads = use.face[:-1][same[1:]], use.face[1:][same[1:]]
    return not component_labels(tails, heads, len(mesh.faces)).any()


def _solid_body(
    mesh: TriangleMesh,
    pins: NDArray[np.float64],
    names: Sequence[str],
    thickness: float,
    control: Control,
) -> SkeletonBody:
    resolution = _THICK_RESOLUTION if thickness > 0 else RESOLUTION
    piece = _piece_around(_solid(mesh, resolution, thickness, control), pins, names)
    control.check()
    if topology(piece).euler < 2 - 2 * MOST_HANDLES:
        # If larger cells disconnect the pins, accept the longer time.
        with suppress(InputError):
            piece = _piece_around(_solid(mesh, resolution // 2, thickness, control), pins, names)
    sized = _sized(piece, control)
    surface = piece if sized is None else sized[0]
    own = piece if thickness > 0 or len(mesh.faces) > _MOST_FACES else mesh
    return SkeletonBody(surface, Inside(own), "solid")


def _solid(mesh: TriangleMesh, resolution: int, thickness: float, control: Control) -> TriangleMesh:
    """Return the surface of the solid of a mesh, or of a shell of some thickness around it."""
    lattice = Lattice.around([mesh], resolution, _SIGMA)
    if thickness > 0:
        corners = lattice.to_cells(mesh, 0)
        cells = lattice.shell_cells(thickness)
        inner = occupancy(corners, lattice.shape, control)
        filled = np.maximum(inner, shell_occupancy(corners, lattice.shape, cells))
    else:
        filled = _enclosed(mesh, lattice, control)
    control.check()
    return lattice.to_scene(surface_at_level(filled, 0.5).mesh, np.ones(1))


def _enclosed(mesh: TriangleMesh, lattice: Lattice, control: Control) -> NDArray[np.float32]:
    """Return the fraction of every cell that the mesh encloses."""
    try:
        return voxelized(mesh, "", 0, lattice, 0.0, control)
    except InputError as error:
        raise InputError(
            "The body encloses no volume: it is open, or extremely thin. Close it, or give it thickness "
            "(the Thickness setting, or --thickness)."
        ) from error


def _piece_around(solid: TriangleMesh, pins: NDArray[np.float64], names: Sequence[str]) -> TriangleMesh:
    """Return the outer surface of the component that contains the pins, with inner hollows filled."""
    labels = vertex_components(solid)[solid.faces[:, 0]]
    pieces = [_part(solid, labels == label) for label in range(labels.max() + 1)]
    pieces = [piece for piece in pieces if piece.volume > 0]
    if len(pieces) == 1:
        return pieces[0]
    holds = np.stack([winding_numbers(pins, piece) for piece in pieces]) > 0.5
    # A pin outside all components belongs to the nearest. There may be thousands, so one query covers all.
    nearest = ClosestPointFinder(np.concatenate([piece.corners for piece in pieces])).find(pins).triangles
    starts = np.cumsum([len(piece.faces) for piece in pieces])
    owners = np.where(holds.any(axis=0), holds.argmax(axis=0), np.searchsorted(starts, nearest, side="right"))
    if (owners != owners[0]).any():
        other = int(np.flatnonzero(owners != owners[0])[0])
        raise InputError(
            "The pins {first} and {second} lie in parts of the body that do not touch. Join the parts (a Boolean or "
            "Remesh modifier), give the body thickness, or choose a skeleton for one of them.",
            first=names[0],
            second=names[other],
        )
    return pieces[owners[0]]


def _sized(mesh: TriangleMesh, control: Control) -> tuple[TriangleMesh, str] | None:
    """Bring a closed mesh to a moderate number of vertices; None if that would open it."""
    if len(mesh.vertices) > _MOST_VERTICES:
        control.check()
        areas = np.maximum(mesh.vertex_areas, _LEAST_AREA * mesh.vertex_areas.mean())
        reduced = coarsened(mesh, areas, _REDUCED_VERTICES, control=control)
        if reduced is None or not topology(reduced.mesh).closed:
            return None
        return reduced.mesh, "reduced"
    made = "as it is"
    while len(mesh.vertices) < _FEWEST_VERTICES:
        mesh, made = _subdivided(mesh), "subdivided"
    return mesh, made


def _subdivided(mesh: TriangleMesh) -> TriangleMesh:
    """Split every triangle into four without changing the surface."""
    faces, count = mesh.faces, len(mesh.vertices)
    ends = np.sort(np.concatenate([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]]), axis=1)
    edges, index = np.unique(ends, axis=0, return_inverse=True)
    across_a, across_b, across_c = index.reshape(3, -1) + count
    a, b, c = faces.T
    parts = [(a, across_c, across_b), (across_c, b, across_a), (across_b, across_a, c), (across_a, across_b, across_c)]
    vertices = np.concatenate([mesh.vertices, mesh.vertices[edges].mean(axis=1)])
    return TriangleMesh(vertices, np.concatenate([np.stack(part, axis=1) for part in parts]))


def _part(mesh: TriangleMesh, chosen: NDArray[np.bool_]) -> TriangleMesh:
    used, faces = np.unique(mesh.faces[chosen], return_inverse=True)
    return TriangleMesh(mesh.vertices[used], faces.reshape(-1, 3))
