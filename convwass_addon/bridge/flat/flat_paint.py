# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the colors of regions to frames of flat morphs: to material slots, or to a color attribute."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..element_values import element_values, write_attribute
from ..morphs.looks.appearance import COLOR
from ..morphs.looks.materials import attribute_material, object_property_material, see_through_material
from ..scene_colors import kind_of_colors

REGION_KEY = "convwass_region_{}"
"""Custom property of a curve object with the color of a region, numbered from 1."""

_CURVE_NAME, _MESH_NAME, _SINGLE_NAME = "Convwass Region {}", "Convwass Regions", "Convwass Flat Morph"
# Appended to the names of materials that show the opacity of their colors.
_SEE_THROUGH = " with Alpha"


def assign_region_materials(obj: bpy.types.Object, colors: Sequence[Sequence[float]]) -> None:
    """Assign one material per region to a curve object; the colors are stored as custom properties.

    Frames of different colors can therefore share materials.

    Parameters
    ----------
    obj : bpy.types.Object
        The material slots of its splines are the region indices.
    colors : sequence of (r, g, b, a)
        Colors of the regions.
    """
    obj.data.materials.clear()
    clear = _is_see_through(colors)
    for number, color in enumerate(colors, start=1):
        key = REGION_KEY.format(number)
        obj[key] = [float(value) for value in color]
        name = _CURVE_NAME.format(number) + (_SEE_THROUGH if clear else "")
        obj.data.materials.append(object_property_material(name, key, is_see_through=clear))


def assign_see_through_material(data: bpy.types.ID) -> None:
    """Assign the material that shows the color and opacity of the object."""
    data.materials.append(see_through_material(_SINGLE_NAME + _SEE_THROUGH))


def region_colors(obj: bpy.types.Object) -> list[tuple[float, ...]]:
    """Return the colors that `assign_region_materials` stored on an object; empty for a single color."""
    colors: list[tuple[float, ...]] = []
    while (color := obj.get(REGION_KEY.format(len(colors) + 1))) is not None:
        colors.append(tuple(color))
    return colors


def paint_mesh(mesh: bpy.types.Mesh, colors: Sequence[Sequence[float]]) -> None:
    """Write the colors of regions to the points of a mesh, and assign the material that shows them.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The material slots of its faces are the region indices; regions do not share points.
    colors : sequence of (r, g, b, a)
        Colors of the regions.
    """
    slots = element_values(mesh.polygons, "material_index", kind=np.int32)
    totals = element_values(mesh.polygons, "loop_total", kind=np.int32)
    corners = element_values(mesh.loops, "vertex_index", kind=np.int32)
    table = np.array(colors, dtype=np.float32)
    points = np.repeat(table[:1], len(mesh.vertices), axis=0)
    points[corners] = table[np.minimum(np.repeat(slots, totals), len(table) - 1)]
    write_attribute(mesh, COLOR, kind_of_colors(), points)
    mesh.color_attributes.active_color_name = COLOR
    mesh.color_attributes.render_color_index = mesh.color_attributes.find(COLOR)
    mesh.polygons.foreach_set("material_index", np.zeros(len(mesh.polygons), np.int32))
    mesh.materials.clear()
    clear = _is_see_through(colors)
    name = _MESH_NAME + (_SEE_THROUGH if clear else "")
    mesh.materials.append(attribute_material(name, COLOR, is_see_through=clear))


def _is_see_through(colors: Sequence[Sequence[float]]) -> bool:
    return any(color[3] < 1.0 for color in colors)


def unused_materials() -> list[bpy.types.Material]:
    """Return the materials made by this module that nothing uses."""
    names = (_MESH_NAME, _CURVE_NAME.partition("{")[0], _SINGLE_NAME)
    return [one for one in bpy.data.materials if not one.users and one.name.startswith(names)]
