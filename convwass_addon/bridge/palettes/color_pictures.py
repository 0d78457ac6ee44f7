# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert color attributes of meshes to pictures and back."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.palettes.pixels import PixelFormat
from ...applications.palettes.recolor_job import Picture
from ...errors import InputError
from ..color_attributes import color_kind, read_colors, require_color_name, show_colors
from ..element_values import element_values
from ..mesh_checks import other_vertices, require_not_edited
from ..scene_colors import scene_to_rec709, set_colors


def read_colors_as_picture(obj: bpy.types.Object) -> Picture:
    """Read the active color attribute of a mesh object as a picture one pixel wide, weighted by area.

    Raises
    ------
    InputError
        The object is in Edit Mode, where attributes cannot be read, or has no faces.
    """
    mesh = obj.data
    require_not_edited(obj)
    name = mesh.color_attributes.active_color_name
    colors = read_colors(obj, name).astype(np.float32)[:, None]
    highest = 1.0 if color_kind(obj, name) == "BYTE_COLOR" else np.inf
    form = PixelFormat("linear", "ignored", scene_to_rec709(), highest)
    corners = _corner_areas(mesh)
    if mesh.color_attributes[name].domain == "CORNER":
        areas = corners
    else:
        vertices = element_values(mesh.loops, "vertex_index", kind=np.int32)
        areas = np.bincount(vertices, corners, len(mesh.vertices))
    if not areas.sum() > 0:
        raise InputError("{object} has no faces, so its colors cover no area.", object=obj.name)
    return Picture(colors, form, weights=areas[:, None] / areas.mean(), name=obj.name)


def write_picture_colors(obj: bpy.types.Object, source: str, name: str, pixels: NDArray[np.float32]) -> None:
    """Write a picture as a color attribute of the same domain and type as another one, and make it active.

    Raises
    ------
    InputError
        The name belongs to something else, or the mesh has changed.
    """
    require_color_name(obj, name)
    mesh = obj.data
    like = mesh.color_attributes.get(source)
    if like is None or len(like.data) != len(pixels):
        raise other_vertices(obj)
    kind, domain = like.data_type, like.domain
    present = mesh.color_attributes.get(name)
    if present is not None and (present.data_type, present.domain) != (kind, domain):
        mesh.color_attributes.remove(present)
        present = None
    if present is None:
        present = mesh.color_attributes.new(name, kind, domain)
    set_colors(present, pixels)
    mesh.update()
    show_colors(obj, name)


def _corner_areas(mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Distribute the area of every face over its corners, (l,)."""
    areas = element_values(mesh.polygons, "area")
    counts = element_values(mesh.polygons, "loop_total", kind=np.int32)
    return np.repeat(areas.astype(np.float64) / np.maximum(counts, 1), counts)
