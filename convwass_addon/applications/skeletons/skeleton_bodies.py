# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The closed surface, in one piece, on which the joints of a skeleton are laid out as densities."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ...errors import InputError
from ...geometry.closest_points import ClosestPointFinder
from ...geometry.coarsening import coarsened
from ...geometry.edges import EdgeUse, edge_use, topology, vertex_components
from ...geometry.isosurface import surface_at_level
from ...geometry.mesh import TriangleMesh
from ...geometry.occupancy import occupancy
from ...geometry.orientation import orient_outward
from ...geometry.solid_angles import Inside, winding_numbers
from ...geometry.thicken import shell_occupancy
from ...geometry.welding import welded
from ...progress import UNINTERRUPTED, Control
from ..morphs.volumes import Lattice, voxelized

# The kernel needs vertices that are closer together than its blur; more than enough of them only take time.
_FEWEST_VERTICES, _MOST_VERTICES = 800, 4000
# What larger ones are reduced to.
_REDUCED_VERTICES = 2500
# Looking up what lies inside a mesh of more triangles takes longer than all the rest; its reduction does.
_MOST_FACES = 100_000
# Laying a thick shell takes the longer, the more cells it is thick.
_THICK_RESOLUTION = 80
# Areas from which seeds are spread are no less than this share of the mean.
_LEAST_AREA = 1e-6
_SIGMA = 1.0

RESOLUTION = 128
"""Cells along the longest side where the body is made of what the mesh encloses."""

MOST_HANDLES = 1000
"""A body with more handles is a thicket, not one with limbs: each keeps about sixteen vertices however far it is
reduced, so it is made of cells that are twice as large."""


@dataclass(frozen=True)
class SkeletonBody:
    """A body, as a surface to lay out joints on and as a solid that they are to lie in.

    Attributes
    ----------
    surface : TriangleMesh
        Closed, in one piece, of a few thousand vertices, outward.
    inside : Inside
        Tells what lies inside: the mesh itself where it encloses something.
    made : str
        "as it is", "subdivided", "reduced", or "solid" where it is the surface of what the mesh encloses.
    size : float
        Diagonal of the box around the surface.
    """

    surface: TriangleMesh
    inside: Inside
    made: str

    @property
    def size(self) -> float:
        """Diagonal of the box around the surface."""
        return float(np.linalg.norm(np.ptp(self.surface.bounds, axis=0)))


def skeleton_body(
    mesh: TriangleMesh,
    pins: NDArray[np.float64],
    names: Sequence[str],
    thickness: float = 0.0,
    control: Control = UNINTERRUPTED,
) -> SkeletonBody:
    """Return the body that a mesh is, for a skeleton with some pins in it.

    Parameters
    ----------
    mesh : TriangleMesh
        Open, in several parts, self-intersecting, of any number of vertices.
    pins : (k, 3)
        Joints that are known, one at least. Where the mesh is in parts that do not touch, the part that they lie in is
        the body.
    names : sequence of str
        What messages call the pins.
    thickness : float
        Given to surfaces that enclose nothing, and across gaps between parts; 0 for none.
    control : Control
        Ends the work when cancelled.

    Raises
    ------
    InputError
        The mesh encloses nothing, or the pins lie in parts that do not touch.
    ResourceError
        It does not fit in memory.
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
    if found.closed and _hangs_together(outward, use) and not thickness > 0 and outward.volume > 0:
        sized = _sized(outward, control)
        if sized is not None:
            surface, made = sized
            return SkeletonBody(surface, Inside(outward if len(outward.faces) <= _MOST_FACES else surface), made)
    return _solid_body(outward, pins, names, thickness, control)


def _hangs_together(mesh: TriangleMesh, use: EdgeUse) -> bool:
    """Tell whether all triangles are joined across edges; at a vertex alone, no heat gets from one part to another.

    Which way faces are turned makes no difference to the edge use that is looked at.
    """
    count = len(mesh.faces)
    same = np.ones(len(use.face), bool)
    same[use.start] = False
    tails, heads = use.face[:-1][same[1:]], use.face[1:][same[1:]]
    graph = coo_array((np.ones(len(tails), np.int8), (tails, heads)), shape=(count, count))
    return connected_components(graph, directed=False)[0] == 1


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
        # Where larger cells lose what holds the pins together, it takes the time that it takes.
        with suppress(InputError):
            piece = _piece_around(_solid(mesh, resolution // 2, thickness, control), pins, names)
    sized = _sized(piece, control)
    surface = piece if sized is None else sized[0]
    own = piece if thickness > 0 or len(mesh.faces) > _MOST_FACES else mesh
    return SkeletonBody(surface, Inside(own), "solid")


def _solid(mesh: TriangleMesh, resolution: int, thickness: float, control: Control) -> TriangleMesh:
    """Return the surface of what a mesh, or a shell of some thickness around it, fills."""
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
    """Return which share of every cell the mesh encloses."""
    try:
        return voxelized(mesh, "", 0, lattice, 0.0, control)
    except InputError as error:
        raise InputError(
            "The body encloses no volume: it is open, or thinner than the eye can see. Close it, or give it thickness "
            "(the Thickness setting, or --thickness)."
        ) from error


def _piece_around(solid: TriangleMesh, pins: NDArray[np.float64], names: Sequence[str]) -> TriangleMesh:
    """Return the outer surface of the piece that the pins lie in; hollows inside of it are filled."""
    labels = vertex_components(solid)[solid.faces[:, 0]]
    pieces = [_part(solid, labels == label) for label in range(labels.max() + 1)]
    pieces = [piece for piece in pieces if piece.volume > 0]
    if len(pieces) == 1:
        return pieces[0]
    holds = np.stack([winding_numbers(pins, piece) for piece in pieces]) > 0.5
    # A pin outside of all pieces belongs to the nearest. There may be thousands of them, so they are asked together.
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
    """Bring a closed mesh to a moderate number of vertices; None where that would open it."""
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
    """Cut every triangle into four; the surface stays what it is."""
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
