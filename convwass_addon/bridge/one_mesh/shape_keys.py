# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""An object with shape keys to other shapes, each controlled by one animatable value."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ...applications.one_mesh.key_paths import KeyPath
from ...errors import InputError
from ..element_values import write_attribute, write_floats
from ..keyframes import ensure_action, own_action, take_animation
from ..morphs.bake import assign_default_material
from ..morphs.inputs.hidden_inputs import HIDDEN_KEY
from ..object_names import numbered_names
from ..render_settings import take_render_settings
from .carried_properties import custom_properties, read_from_copy, take_properties
from .records import BAKE_KEYS, has_key_record, key_names, key_records, store_records
from .texture_looks import remember_shape, remembered_shapes

POOR = "{name} poor"
"""Name of the attribute that marks vertices which are not where they should be in a shape."""

# Bytes of the name of a shape in those of its slider, keys and attribute; Blender admits 63 with what is added to them.
_LONGEST = 48


def object_with_keys(
    source: bpy.types.Object,
    mesh: bpy.types.Mesh,
    paths: Sequence[KeyPath],
    scene: bpy.types.Scene,
    modifiers: Sequence[str] = (),
) -> bpy.types.Object:
    """Create an object whose shape keys lead to other shapes.

    For each path, the object has a custom property from 0 to 1, which drives the shape keys of the path. The drivers
    are simple expressions, which Blender evaluates without running scripts. Vertices move linearly between two keys;
    several paths add up.

    The custom properties of `source` are kept, with their keyframes and drivers, and drivers read the copies.

    Parameters
    ----------
    source : bpy.types.Object
        The object that the mesh was copied from.
    mesh : bpy.types.Mesh
        Without users, with the vertices of the paths. Its shape keys, vertex groups, UV maps, attributes and materials
        are kept.
    paths : sequence of KeyPath
        Paths of the vertices.
    scene : bpy.types.Scene
        The scene to add the object to.
    modifiers : sequence of str
        Modifiers of `source` to keep, with their keyframes and drivers, if the mesh is in the space of `source`;
        without any, it is in world space.
    """
    assign_default_material(mesh)
    name = f"{source.name} Morph"
    obj = _copy_with_modifiers(source, mesh, modifiers) if modifiers else _new_object(source, mesh)
    obj.name, obj.color = name, source.color
    scene.collection.objects.link(obj)
    records = _kept_sliders(source, obj)
    take_animation(obj, source, [*map(slider_path, custom_properties(source)), *map(_modifier_path, modifiers)])
    for block in (mesh, mesh.shape_keys):
        if block is not None:
            own_action(block)
    for block in (obj, mesh.shape_keys):
        read_from_copy(block, source, obj, is_in_place=bool(modifiers))
    if mesh.shape_keys is None:
        obj.shape_key_add(name="Basis", from_mix=False)
    for path in paths:
        name = free_slider(obj, path.name, len(path.times))
        _add_path(obj, path, name)
        records.append({**path.record(), "name": name})
    store_records(obj, records)
    return obj


def _kept_sliders(source: bpy.types.Object, obj: bpy.types.Object) -> list[dict[str, object]]:
    """Give a copy with the shape keys of `source` its sliders too; return their records."""
    records = key_records(source) if has_key_record(source) else []
    if obj.data.shape_keys is None:
        for record in records:
            obj.pop(record["name"], None)
        return []
    for slider, (shape, placement) in remembered_shapes(source).items():
        remember_shape(obj, slider, shape, placement)
    for name in (record["name"] for record in records):
        add_slider(obj, name)
        obj[name] = source.get(name, 0.0)
    return records


def free_slider(obj: bpy.types.Object, name: str, keys: int = 0) -> str:
    """Return the name of a shape as that of a slider, shortened, with a number if the object has such a name already.

    Parameters
    ----------
    obj : bpy.types.Object
        The object to get the slider.
    name : str
        Name of the shape.
    keys : int
        Number of shape keys that are named after the slider.
    """
    own = obj.data.shape_keys
    taken = set(obj.keys()) | ({key.name for key in own.key_blocks} if own is not None else set())
    tried = numbered_names(name, _LONGEST)
    return next(each for each in tried if not taken.intersection([each, *key_names(each, keys)]))


def _add_path(obj: bpy.types.Object, path: KeyPath, slider: str) -> None:
    """Add the shape keys of a path, and the slider that drives them."""
    add_slider(obj, slider)
    names, expressions = key_names(slider, len(path.times)), key_expressions(path.times)
    for name, positions, expression in zip(names, path.positions, expressions, strict=True):
        key = obj.shape_key_add(name=name, from_mix=False)
        write_floats(key.data, "co", positions)
        drive_key(obj, key, slider, expression)
    _mark(obj.data, POOR.format(name=slider), path.poor)


def _new_object(source: bpy.types.Object, mesh: bpy.types.Mesh) -> bpy.types.Object:
    """Create an object of a mesh in world space, with the custom properties and render settings of another one."""
    obj = bpy.data.objects.new(source.name, mesh)
    take_render_settings(obj, [source])
    take_properties(obj, source, custom_properties(source))
    return obj


def _copy_with_modifiers(source: bpy.types.Object, mesh: bpy.types.Mesh, modifiers: Sequence[str]) -> bpy.types.Object:
    """Copy an object with its parent, vertex groups and some of its modifiers, but visible and without animation."""
    obj = source.copy()
    obj.data = mesh
    obj.animation_data_clear()
    obj.hide_viewport = obj.hide_render = obj.show_only_shape_key = False
    for key in (*BAKE_KEYS, HIDDEN_KEY):
        obj.pop(key, None)
    for modifier in [own for own in obj.modifiers if own.name not in modifiers]:
        obj.modifiers.remove(modifier)
    return obj


def key_expressions(times: Sequence[float]) -> list[str]:
    """Return each key as a function of the slider v: 1 at its own time, 0 at neighboring keys, linear in between.

    Parameters
    ----------
    times : sequence of float
        Times of the keys, increasing, from above 0 to 1. The last key stays at 1 beyond its time.
    """
    found = []
    for before, own, after in zip((0.0, *times[:-1]), times, (*times[1:], None), strict=True):
        rising = f"(v - {before:.6g}) / {own - before:.6g}"
        falling = "1" if after is None else f"({after:.6g} - v) / {after - own:.6g}"
        found.append(f"max(0, min({rising}, {falling}))")
    return found


def is_key_expression(expression: str) -> bool:
    """Return whether an expression may be one of `key_expressions`."""
    return expression.startswith("max(0, min((v - ")


def animate_sliders(obj: bpy.types.Object, names: Sequence[str], first: int, frames: int) -> None:
    """Key the sliders such that the mesh takes the shapes one after another, `frames` scene frames apart."""
    ensure_action(obj)
    for number, name in enumerate(names):
        begin, end = first + number * frames, first + (number + 1) * frames
        values = {begin: 0.0, end: 1.0}
        if number + 1 < len(names):
            # The next shape replaces this one.
            values[end + frames] = 0.0
        for frame, value in values.items():
            obj[name] = value
            obj.keyframe_insert(slider_path(name), frame=frame)
        obj[name] = 0.0


def _mark(mesh: bpy.types.Mesh, name: str, vertices: np.ndarray) -> None:
    """Mark some vertices by an attribute, if there are any."""
    if len(vertices):
        marked = np.zeros(len(mesh.vertices), dtype=bool)
        marked[vertices] = True
        write_attribute(mesh, name, "BOOLEAN", marked)


def add_slider(obj: bpy.types.Object, name: str) -> None:
    """Add a custom property from 0 to 1 to an object."""
    obj[name] = 0.0
    obj.id_properties_ui(name).update(min=0.0, max=1.0, description="Progress towards this shape")


def require_mixable_keys(obj: bpy.types.Object) -> None:
    """Raise InputError if further shape keys of an object would have no effect."""
    keys = obj.data.shape_keys
    if keys is not None and not keys.use_relative:
        raise InputError("{name} has absolute shape keys, which cannot be mixed; make them Relative.", name=obj.name)
    if keys is not None and obj.show_only_shape_key:
        raise InputError("{name} shows its active shape key only; unpin it in the list of shape keys.", name=obj.name)


def drive_key(obj: bpy.types.Object, key: bpy.types.ShapeKey, slider: str, expression: str) -> None:
    """Drive a shape key by an expression of v, a slider of an object."""
    drive(key.driver_add("value"), obj, slider, expression)


def drive(curve: bpy.types.FCurve, obj: bpy.types.Object, slider: str, expression: str) -> None:
    """Set the driver of a property to an expression of v, a slider of an object."""
    variable = curve.driver.variables.new()
    variable.name = "v"
    variable.targets[0].id = obj
    variable.targets[0].data_path = slider_path(slider)
    curve.driver.expression = expression


def _modifier_path(name: str) -> str:
    """Return with what the data paths of all settings of a modifier begin."""
    return f'modifiers["{bpy.utils.escape_identifier(name)}"]'


def slider_path(name: str) -> str:
    """Return the data path of a slider of an object."""
    return f'["{bpy.utils.escape_identifier(name)}"]'
