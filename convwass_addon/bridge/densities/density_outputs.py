# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities as vertex groups and color attributes, one for each step."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ..heat_map import heat_colors
from ..mesh_checks import writable_mesh
from ..node_inputs import node_input
from ..vertex_groups import as_weights, require_unlocked, write_group
from .density_nodes import COLORS, NAME, color_name
from .density_player import density_modifier, density_value
from .density_store import store_density, stored_or_new

GROUPS, COLOR_ATTRIBUTES = "groups", "colors"
"""Kinds of outputs that an object remembers."""


def step_name(name: str, step: int) -> str:
    """Return the name of what is written for one step, counted from 0."""
    return f"{name}.{step:03d}"


def write_step_groups(obj: bpy.types.Object, densities: ArrayLike, name: str = NAME) -> list[str]:
    """Write one vertex group for each step, the largest weight of all being 1.

    Groups that were written under this name before are replaced, those of steps that are no more are removed.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object in any mode but Edit Mode.
    densities : (f, n) array_like
        One value per vertex, not negative.
    name : str
        The groups are called by it and the number of the step.

    Returns
    -------
    list of str
        Names of the groups.

    Raises
    ------
    InputError
        As `write_group`.
    """
    mesh = writable_mesh(obj)
    weights = _checked(densities, len(mesh.vertices))
    names = [step_name(name, step) for step in range(len(weights))]
    # Before anything is written.
    require_unlocked(obj, names)
    for own, values in zip(names, weights, strict=True):
        write_group(obj, own, values)
    for stale in _written(obj, name, GROUPS, names):
        if stale in obj.vertex_groups:
            obj.vertex_groups.remove(obj.vertex_groups[stale])
    return names


def write_step_colors(obj: bpy.types.Object, densities: ArrayLike, name: str = NAME) -> list[str]:
    """Write one color attribute for each step, in the colors of a heat map that is the same for all.

    Parameters
    ----------
    obj, densities, name
        As for `write_step_groups`; a single density is one step.

    Returns
    -------
    list of str
        Names of the attributes, of points, 8 bits. The first one becomes the active one, which viewports show.

    Raises
    ------
    InputError
        Not a mesh, in Edit Mode, linked, or something else has such a name.
    """
    mesh = writable_mesh(obj)
    weights = _checked(densities, len(mesh.vertices))
    names = [f"{step_name(name, step)} color" for step in range(len(weights))]
    for own, values in zip(names, weights, strict=True):
        _write_color(obj, own, heat_colors(values))
    for stale in _written(obj, name, COLOR_ATTRIBUTES, names):
        if stale in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[stale])
    _show(mesh, names[0])
    return names


def show_heat_colors(obj: bpy.types.Object, name: str = NAME) -> None:
    """Let the color attribute of a played density show its heat map at every frame.

    Solid viewports show it under Viewport Shading > Color > Attribute, without any material.

    Raises
    ------
    InputError
        As `writable_mesh`, nothing of this name is played, or something else has the name of the attribute.
    """
    mesh = writable_mesh(obj)
    choice = node_input(density_modifier(obj, name), COLORS)
    own = color_name(name)
    # Viewports look for the name in the mesh itself; the modifier fills in the colors.
    _write_color(obj, own, heat_colors(np.zeros(len(mesh.vertices))))
    _show(mesh, own)
    choice.set(True)
    density_value(obj, name).modifier.id_data.update_tag()


def _checked(densities: ArrayLike, count: int) -> NDArray[np.float64]:
    frames = np.atleast_2d(np.asarray(densities, dtype=np.float64))
    if frames.ndim != 2 or not len(frames) or frames.shape[1] != count:
        raise ValueError(f"densities of shape {frames.shape} for {count} vertices")
    if not (np.isfinite(frames).all() and frames.min(initial=0.0) >= 0.0):
        raise ValueError("densities are negative or no numbers")
    return as_weights(frames)


def _written(obj: bpy.types.Object, name: str, kind: str, names: list[str]) -> list[str]:
    """Remember what was written; return what was before and is not any more."""
    known = stored_or_new(obj, name)
    store_density(obj, name, replace(known, outputs={**known.outputs, kind: names}))
    return [old for old in known.outputs.get(kind, ()) if old not in names]


def _write_color(obj: bpy.types.Object, name: str, colors: NDArray[np.float64]) -> None:
    mesh = obj.data
    attribute = mesh.attributes.get(name)
    if attribute is None:
        attribute = mesh.attributes.new(name, "BYTE_COLOR", "POINT")
    if (attribute.name, attribute.domain, attribute.data_type) != (name, "POINT", "BYTE_COLOR"):
        raise InputError(
            "{object} has an attribute or a vertex group {name} of another kind; rename that, or choose another name.",
            object=obj.name,
            name=name,
        )
    attribute.data.foreach_set("color", np.ascontiguousarray(colors, dtype=np.float32).ravel())
    mesh.update()


def _show(mesh: bpy.types.Mesh, name: str) -> None:
    mesh.color_attributes.active_color_name = name
