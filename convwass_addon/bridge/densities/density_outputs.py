# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write densities as vertex groups and color attributes, one per step."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import ArrayLike

from ..color_attributes import show_colors, write_colors
from ..heat_map import heat_colors
from ..mesh_checks import other_kind, writable_mesh
from ..nodes.node_inputs import node_input
from ..vertex_groups import as_weights, require_unlocked
from .density_attributes import checked_frames
from .density_nodes import COLORS, NAME, color_name
from .density_player import density_modifier, density_value
from .density_store import store_density, stored_or_new
from .result_groups import replace_by_result, require_unpainted

GROUPS, COLOR_ATTRIBUTES = "groups", "colors"
"""Keys of the outputs stored with an object."""


def step_name(name: str, step: int) -> str:
    """Return the name for a step, counted from 0."""
    return f"{name}.{step:03d}"


def write_step_groups(obj: bpy.types.Object, densities: ArrayLike, name: str = NAME) -> list[str]:
    """Write one vertex group per step; the maximum over all groups is 1.

    Groups previously written under this name are replaced; surplus ones are removed. Painted groups are not replaced.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object, not in Edit Mode.
    densities : (f, n) array_like
        One non-negative value per vertex.
    name : str
        Group names are this name followed by the number of the step.

    Returns
    -------
    list of str
        Names of the groups.

    Raises
    ------
    InputError
        As `write_group`, or a group of such a name was painted; nothing is written then.
    """
    mesh = writable_mesh(obj)
    weights = as_weights(checked_frames(densities, len(mesh.vertices)))
    names = [step_name(name, step) for step in range(len(weights))]
    # Checked before anything is written.
    require_unlocked(obj, names)
    for own in set(names).difference(stored_or_new(obj, name).outputs.get(GROUPS, ())):
        require_unpainted(obj, own)
    for own, values in zip(names, weights, strict=True):
        replace_by_result(obj, own, values)
    for stale in _written(obj, name, GROUPS, names):
        if stale in obj.vertex_groups:
            obj.vertex_groups.remove(obj.vertex_groups[stale])
    return names


def write_step_colors(obj: bpy.types.Object, densities: ArrayLike, name: str = NAME) -> list[str]:
    """Write one color attribute per step, with the same heat map for all steps.

    Parameters
    ----------
    obj, densities, name
        As for `write_step_groups`; a single density is one step.

    Returns
    -------
    list of str
        Names of the attributes, which have 8 bits and the point domain. The first one becomes active and is shown in
        viewports.

    Raises
    ------
    InputError
        The object is not a mesh, is in Edit Mode or linked, or the name belongs to something else.
    """
    mesh = writable_mesh(obj)
    weights = as_weights(checked_frames(densities, len(mesh.vertices)))
    names = [f"{step_name(name, step)} color" for step in range(len(weights))]
    # Checked before anything is written.
    for own in names:
        _require_colors(obj, own)
    for own, values in zip(names, weights, strict=True):
        write_colors(obj, own, heat_colors(values))
    for stale in _written(obj, name, COLOR_ATTRIBUTES, names):
        if stale in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[stale])
    show_colors(obj, names[0])
    return names


def show_heat_colors(obj: bpy.types.Object, name: str = NAME) -> None:
    """Write the heat map of the current frame to a color attribute.

    Solid viewports show it with Viewport Shading > Color > Attribute, without a material.

    Raises
    ------
    InputError
        As for `writable_mesh`; no density of this name is played; or the name of the attribute belongs to something
        else.
    """
    mesh = writable_mesh(obj)
    choice = node_input(density_modifier(obj, name), COLORS)
    own = color_name(name)
    _require_colors(obj, own)
    # Viewports look up the name in the original mesh; the modifier fills in the colors.
    write_colors(obj, own, heat_colors(np.zeros(len(mesh.vertices))))
    show_colors(obj, own)
    choice.set(True)
    density_value(obj, name).modifier.id_data.update_tag()


def _written(obj: bpy.types.Object, name: str, kind: str, names: list[str]) -> list[str]:
    """Store which outputs were written; return the previous ones that no longer exist."""
    known = stored_or_new(obj, name)
    store_density(obj, name, replace(known, outputs={**known.outputs, kind: names}))
    return [old for old in known.outputs.get(kind, ()) if old not in names]


def _require_colors(obj: bpy.types.Object, name: str) -> None:
    """Raise InputError if a name belongs to something else than colors as they are written here."""
    attribute = obj.data.attributes.get(name)
    is_other = attribute is not None and (attribute.domain, attribute.data_type) != ("POINT", "BYTE_COLOR")
    if is_other or name in obj.vertex_groups:
        raise other_kind(obj, name)
