# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of meshes to their own mirror images: left to right, in any pose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Work
from .map_pairs import checked_pairs
from .map_sides import MapSide
from .map_solving import soft_map_steps
from .soft_map_settings import SoftMapSettings
from .surface_maps import SurfaceMap


def mirror_map_steps(
    side: MapSide, pairs: ArrayLike, settings: SoftMapSettings | None = None, control: Control = UNINTERRUPTED
) -> Work[SurfaceMap]:
    """Compute the map of a mesh to its mirror image.

    Parameters
    ----------
    side : MapSide
        The mesh, symmetric except for its pose. Painted groups are ignored.
    pairs : (k, 2) int
        Vertices that mirror each other, in either order, and vertices in the middle paired with themselves.
    settings : SoftMapSettings, optional
        Settings of the solve.
    control : Control
        Stops the work when cancelled.

    Yields
    ------
    Progress
        Before every stage of the work.

    Returns
    -------
    SurfaceMap
        With equal forward and backward maps.

    Raises
    ------
    InputError
        No pair of different vertices, or an invalid mesh or pairs.
    """
    mirrored = mirrored_pairs(pairs, side)
    reflected = _reflected(side.mesh, mirrored)
    plain = replace(side, groups={})
    found = yield from soft_map_steps(plain, replace(plain, mesh=reflected), mirrored, settings, control)
    return _both_ways(found)


def mirrored_pairs(pairs: ArrayLike, side: MapSide) -> NDArray[np.int64]:
    """Return pairs of a mesh's vertices and their reversals, (k, 2).

    Raises
    ------
    InputError
        No pair of different vertices, invalid indices, or a vertex in several pairs.
    """
    found = np.asarray(pairs)
    if found.size and found.ndim == 2:
        found = np.concatenate([found, found[:, ::-1]])
    found = checked_pairs(found, side, side)
    if not (found[:, 0] != found[:, 1]).any():
        raise InputError(
            "A mirror map needs at least one pair of vertices that mirror each other; mark a left and a right one."
        )
    return found


def _reflected(mesh: TriangleMesh, pairs: NDArray[np.int64]) -> TriangleMesh:
    """Reflect a mesh in the plane between mirrored vertices, and flip its faces so that they point outward again.

    With the reflected mesh as the target, left lies where right is, and the map preserves orientation.
    """
    ends = mesh.vertices[pairs]
    middle = ends.mean(axis=(0, 1))
    across = ends[:, 1] - ends[:, 0]
    # The main direction of the vectors between mirrored vertices.
    axis = np.linalg.eigh(across.T @ across)[1][:, -1]
    offset = (mesh.vertices - middle) @ axis
    return TriangleMesh(mesh.vertices - 2.0 * offset[:, None] * axis, np.ascontiguousarray(mesh.faces[:, ::-1]))


def _both_ways(found: SurfaceMap) -> SurfaceMap:
    """Convert barycentric coordinates on the reflection, whose corners are in reverse order, to the mesh itself."""
    forward = replace(found.forward, barycentric=np.ascontiguousarray(found.forward.barycentric[:, ::-1]))
    return replace(found, forward=forward, backward=forward)
