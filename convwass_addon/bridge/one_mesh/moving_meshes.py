# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the vertices of animated objects and baked morphs in all their frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.one_mesh.vertex_textures import VertexAnimation, padded_triangles
from ...errors import InputError
from ...geometry.algebra.affine import transformed_points
from ..animation_time import returning, show_time
from ..element_values import MeshTriangles, vectors_of
from ..keyframes import curves_of, driver_targets, key_span, strips_span
from ..morphs.looks.appearance import seen_colors
from ..scene_colors import srgb_of_scene


@dataclass(frozen=True)
class MovingVertices:
    """Vertices of constant number over scene frames.

    Attributes
    ----------
    points, normals : (f, n, 3) float64
        World space.
    frames : range
        The scene frames.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    frames: range


def keyed_span(obj: bpy.types.Object) -> range:
    """Return the scene frames from the first to the last key or NLA strip of an object, or of its drivers' inputs.

    Raises
    ------
    InputError
        There are neither.
    """
    blocks = _with_drivers(obj)
    found = key_span(curve for block in blocks for curve in curves_of(block)) or strips_span(blocks)
    if found:
        return found
    driving = next((own for own in blocks if isinstance(own, bpy.types.Object) and own != obj), None)
    if driving is not None:
        raise InputError(
            "{name} is not animated; key {driving}, which drives it, first.", name=obj.name, driving=driving.name
        )
    raise InputError("{name} is not animated; key its sliders first.", name=obj.name)


def _with_drivers(obj: bpy.types.Object) -> list[bpy.types.ID]:
    """Return an object, its shape keys, and all data-blocks that their drivers read."""
    waiting, found = [obj, obj.data.shape_keys], []
    while waiting:
        block = waiting.pop()
        if block is None or block in found:
            continue
        found.append(block)
        waiting += [target.id for target in driver_targets(block)]
    return found


def sampled_vertices(obj: bpy.types.Object, frames: range) -> MovingVertices:
    """Read the vertices of an object, with modifiers, in every frame; restores the current frame of the scene.

    The object must be visible in all of them (`shown_objects`).

    Raises
    ------
    InputError
        A modifier changes the number of vertices over time.
    """
    scene, points, normals = bpy.context.scene, [], []
    with returning(scene):
        for frame in frames:
            show_time(scene, frame)
            evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
            mesh = evaluated.to_mesh()
            matrix = np.array(evaluated.matrix_world, dtype=np.float64)
            points.append(transformed_points(vectors_of(mesh.vertices), matrix))
            normals.append(_turned(vectors_of(mesh.vertex_normals, "vector"), matrix))
            evaluated.to_mesh_clear()
    if len({len(one) for one in points}) > 1:
        raise InputError(
            "The number of vertices of {name} changes over time; remove the modifier that changes it.", name=obj.name
        )
    return MovingVertices(np.stack(points), np.stack(normals), frames)


def triangles_of_frames(objects: Sequence[bpy.types.Object]) -> VertexAnimation:
    """Read the triangles of frame objects in order, with normals and colors, in world space."""
    corners, normals, colors = [], [], []
    for obj in objects:
        mesh, matrix = obj.data, np.array(obj.matrix_world, dtype=np.float64)
        triangles = MeshTriangles.of(mesh)
        loops, vertices = triangles.loops, triangles.vertices
        if np.linalg.det(matrix[:3, :3]) < 0.0:
            # Triangles still point outwards if they are mirrored.
            loops, vertices = loops[:, ::-1], vertices[:, ::-1]
        corners.append(transformed_points(vectors_of(mesh.vertices), matrix)[vertices])
        normals.append(_turned(vectors_of(mesh.corner_normals, "vector"), matrix)[loops])
        seen = srgb_of_scene(np.asarray(seen_colors(mesh, obj.color), dtype=np.float64)[:, :3])
        colors.append(seen[vertices].reshape(-1, 3, 3))
    return padded_triangles(corners, normals, colors)


def _turned(normals: NDArray[np.float64], matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    turned = normals @ np.linalg.inv(matrix[:3, :3])
    lengths = np.linalg.norm(turned, axis=1, keepdims=True)
    return np.where(lengths > 0.0, turned / np.maximum(lengths, 1e-30), [0.0, 0.0, 1.0])
