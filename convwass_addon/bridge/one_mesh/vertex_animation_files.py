# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write vertex animation textures with their mesh, for game engines and browsers."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.one_mesh.vertex_textures import VertexAnimation, packed_normals, split_steps, y_up
from ...applications.palettes.png_bytes import png_bytes
from ...disk_space import require_space
from ...drafts import DraftFiles, written_together
from ...geometry.meshes.mesh import TriangleMesh
from ..color_spaces import DATA, color_space
from ..element_values import element_values, write_floats
from ..files.image_files import ImageFormat, drawn_image, opaque_pixels, save_image
from ..files.scene_writing import write_draft, write_still_gltf
from ..files.scratch_scene import scratch_scene
from ..objects import write_triangles
from ..uv_maps import add_uv_map
from .moving_meshes import MovingVertices

UV_MAP = "VAT"
"""Name of the UV map with the positions of vertices in the textures, with a number if the mesh has such a map."""

# Bytes per texel of all textures, uncompressed; per corner of the mesh, with positions, normals, colors and UV maps;
# and for the description and the headers.
_TEXEL, _CORNER, _FILES = 32, 80, 1 << 20

_EXR = ImageFormat("OPEN_EXR", "RGB", "32")


def write_moving_mesh(mesh: bpy.types.Mesh, name: str, moving: MovingVertices, target: Path, fps: float) -> list[Path]:
    """Write a mesh of constant topology with textures of its vertices.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        Has as many vertices as `moving`. It is written in its first frame, with another UV map, and modified.
    name : str
        What messages call it.
    moving : MovingVertices
        Positions of the vertices in all frames.
    target : Path
        The .json file; the names of the other files start with its name.
    fps : float
        Frames per second.

    Returns
    -------
    list of Path
        All files: the description, the mesh (.glb) and the textures.

    Raises
    ------
    InputError
        Too many vertices and frames for a texture, or there are eight UV maps.
    ConvwassError
        A file could not be written.
    """
    animation = VertexAnimation(y_up(moving.points), y_up(moving.normals))
    write_floats(mesh.vertices, "co", moving.points[0])
    mesh.update()
    vertices = element_values(mesh.loops, "vertex_index", kind=np.int32)
    uv_map = _add_coordinates(mesh, animation.grid.coordinates()[vertices], name)
    return _written(animation, mesh, target, fps, uv_map)


def write_changing_mesh(animation: VertexAnimation, target: Path, fps: float) -> list[Path]:
    """Write triangles of changing topology, padded to the same number in all frames, with textures of their corners.

    Parameters
    ----------
    animation : VertexAnimation
        World space, corners of triangles.
    target, fps
        As for `write_moving_mesh`, which also documents the result and the errors.
    """
    corners = animation.points[0]
    mesh = bpy.data.meshes.new(target.stem)
    try:
        write_triangles(mesh, TriangleMesh(corners, np.arange(len(corners)).reshape(-1, 3)))
        upright = replace(animation, points=y_up(animation.points), normals=y_up(animation.normals))
        uv_map = _add_coordinates(mesh, upright.grid.coordinates(), mesh.name)
        return _written(upright, mesh, target, fps, uv_map)
    finally:
        bpy.data.meshes.remove(mesh)


def _add_coordinates(mesh: bpy.types.Mesh, coordinates: NDArray[np.float64], owner: str) -> str:
    """Add the UV map to the corners, (k, 2), and return its name; V points up in Blender, and down in glTF."""
    layer = add_uv_map(mesh, UV_MAP, owner)
    upward = np.stack([coordinates[:, 0], 1.0 - coordinates[:, 1]], axis=1)
    write_floats(layer.uv, "vector", upward)
    return layer.name


def _written(animation: VertexAnimation, mesh: bpy.types.Mesh, target: Path, fps: float, uv_map: str) -> list[Path]:
    """Write the textures, the mesh and the description, in glTF's axes."""
    grid, bounds = animation.grid, animation.bounds
    names = ["positions.png", "normals.png", "positions.exr", "mesh.glb"]
    names += [] if animation.colors is None else ["colors.png"]
    files = {name: target.with_name(f"{target.stem}_{name}") for name in names}
    split = split_steps(animation.points, bounds)
    record = {
        "format": "convwass vertex animation texture",
        "version": 1,
        "topology": "changing" if animation.changing else "constant",
        "vertices": grid.points,
        "frames": grid.frames,
        "frames_per_second": fps,
        "texture": {"width": grid.width, "height": grid.height, "rows_per_frame": grid.rows},
        "texture_coordinates": {"name": uv_map, "index": mesh.uv_layers.find(uv_map)},
        "bounds": {"low": bounds[0].tolist(), "high": bounds[1].tolist()},
        "axes": "right-handed, Y up, as in glTF",
        "files": {name.replace(".", "_"): file.name for name, file in files.items()},
    }
    require_space(target.parent, _needed_bytes(animation, mesh))
    with written_together() as drafts:
        _write_png(np.concatenate([grid.arranged(half) for half in split]), files["positions.png"], drafts)
        _write_png(grid.arranged(packed_normals(animation.normals)), files["normals.png"], drafts)
        _write_exr(grid.arranged(animation.points.astype(np.float32)), files["positions.exr"], drafts)
        if animation.colors is not None:
            colors = np.rint(255.0 * animation.colors).astype(np.uint8)
            _write_png(grid.arranged(colors), files["colors.png"], drafts)
        _write_glb(mesh, files["mesh.glb"], drafts)
        with drafts.written(target) as draft:
            draft.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    return [target, *files.values()]


def _needed_bytes(animation: VertexAnimation, mesh: bpy.types.Mesh) -> int:
    """Return a generous estimate of the size of all files."""
    return _FILES + _TEXEL * animation.grid.width * animation.grid.height + _CORNER * len(mesh.loops)


def _write_png(pixels: NDArray[np.uint8], path: Path, drafts: DraftFiles) -> None:
    """Write an 8-bit image, (height, width, 3), top row first."""
    with drafts.written(path) as draft:
        draft.write_bytes(png_bytes(opaque_pixels(pixels / np.float32(255.0))[::-1]))


def _write_exr(pixels: NDArray[np.float32], path: Path, drafts: DraftFiles) -> None:
    """Write an image of floats, (height, width, 3), top row first."""
    with drawn_image(opaque_pixels(pixels)[::-1], color_space(DATA)) as image, drafts.written(path) as draft:
        save_image(image, draft, _EXR)


def _write_glb(mesh: bpy.types.Mesh, path: Path, drafts: DraftFiles) -> None:
    """Write a mesh unchanged, with its materials and UV maps."""
    with _alone(mesh, path.stem), drafts.written(path) as draft:
        write_draft(write_still_gltf, draft, path)


@contextmanager
def _alone(mesh: bpy.types.Mesh, name: str) -> Iterator[None]:
    """Link a mesh to a temporary scene."""
    with scratch_scene() as scene:
        obj = bpy.data.objects.new(name, mesh)
        scene.collection.objects.link(obj)
        try:
            yield
        finally:
            bpy.data.objects.remove(obj)
