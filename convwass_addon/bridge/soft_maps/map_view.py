# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Visualize soft maps: positions as colors, the distribution of one vertex, and confidence."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.soft_maps.surface_maps import SurfaceMap, distribution_of
from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ..color_attributes import require_color_name, show_colors, write_colors
from ..heat_map import heat_colors
from ..mesh_checks import writable_mesh
from ..vertex_groups import as_weights, require_unlocked, write_group

PLACES = "Soft Map"
"""Color attribute of both objects: position on the source."""

DISTRIBUTION = "Soft Map Distribution"
"""Color attribute of both objects: a vertex of the source and its image."""

CONFIDENCE = "Soft Map Confidence"
"""Vertex group of both objects."""

# Radius of the spot that marks a vertex, relative to the diagonal of the bounds.
_SPOT = 0.03
# Color of vertices without an image; no position has it.
_NOWHERE = (0.0, 0.0, 0.0, 1.0)


def place_colors(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return a color for every position in the bounds of a mesh, red, green and blue along X, Y and Z, (n, 4)."""
    low, high = mesh.bounds
    size = np.where(high > low, high - low, 1.0)
    return np.concatenate([np.clip((mesh.vertices - low) / size, 0.0, 1.0), np.ones((len(mesh.vertices), 1))], axis=1)


def show_places(
    source: bpy.types.Object, target: bpy.types.Object, found: SurfaceMap, source_mesh: TriangleMesh
) -> None:
    """Color the source by position, and the target by the corresponding positions.

    Parameters
    ----------
    source, target : bpy.types.Object
        Two mesh objects in any mode except Edit Mode; for a map of a mesh to itself one, which gets the colors of
        images.
    found : SurfaceMap
        The map between them.
    source_mesh : TriangleMesh
        The source, with the triangles of the map.

    Raises
    ------
    InputError
        As `writable_mesh`, or the name of the attribute is used for something else; nothing is written then.
    """
    _require_writable((source, target), PLACES)
    colors = place_colors(source_mesh)
    images = found.backward.at(source_mesh, colors)
    images[~found.backward.found] = _NOWHERE
    for obj, own in ((source, colors), (target, images)):
        write_colors(obj, PLACES, own)
        show_colors(obj, PLACES)


def show_distribution(
    source: bpy.types.Object, target: bpy.types.Object, found: SurfaceMap, source_mesh: TriangleMesh, vertex: int
) -> NDArray[np.float64]:
    """Color the target by the distribution of one source vertex, and mark that vertex on the source.

    Parameters
    ----------
    source, target, found, source_mesh
        As for `show_places`.
    vertex : int
        Index of the vertex of the source.

    Returns
    -------
    (m,) float64
        The density at the target's vertices.

    Raises
    ------
    InputError
        As `show_places`, or the vertex does not exist or has no image.
    """
    _require_writable((source, target), DISTRIBUTION)
    density = distribution_of(found, vertex)
    if not density.any():
        raise InputError(
            "Vertex {vertex} of {object} has no image on the other surface; choose another one.",
            vertex=vertex,
            object=source.name,
        )
    away = np.linalg.norm(source_mesh.vertices - source_mesh.vertices[vertex], axis=1)
    spot = np.exp(-0.5 * (away / (_SPOT * source_mesh.diagonal)) ** 2)
    for obj, values in ((source, spot), (target, as_weights(density))):
        write_colors(obj, DISTRIBUTION, heat_colors(values))
        show_colors(obj, DISTRIBUTION)
    return density


def write_confidence(source: bpy.types.Object, target: bpy.types.Object, found: SurfaceMap) -> None:
    """Write the confidence of the map at every vertex, from 0 to 1, to a vertex group of each object.

    Raises
    ------
    InputError
        As `write_group`; nothing is written then.
    """
    for obj in (source, target):
        writable_mesh(obj)
        require_unlocked(obj, [CONFIDENCE])
    # For a map of a mesh to itself, both are the same group.
    for obj, points in ((target, found.backward), (source, found.forward)):
        write_group(obj, CONFIDENCE, np.clip(points.confidence, 0.0, 1.0))
        obj.vertex_groups.active_index = obj.vertex_groups[CONFIDENCE].index


def _require_writable(objects: tuple[bpy.types.Object, ...], name: str) -> None:
    for obj in objects:
        writable_mesh(obj)
        require_color_name(obj, name)
