# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Give objects with shape keys the meshes of a new bake, or delete them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy

from ...sentence import Sentence
from ..keyframes import curves_of, driver_targets, drivers_of, ensure_action, remove_curve
from ..morphs.inputs.hidden_inputs import hidden_only_by, show_again, take_hidden, unfound_notices
from ..unused_data import remove_mesh, remove_with_data
from .attached_parts import detach_parts
from .baked_keys import SWAP_KEY
from .carried_properties import custom_properties, take_properties
from .key_pad import pads_of, remove_idle_pads
from .records import BAKE_KEYS, objects_of, slider_names
from .shape_keys import add_slider, slider_path


def replace_keys(old: bpy.types.Object, new: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Move meshes and sliders of a new bake to the objects of the last one, and remove the new objects.

    The objects keep their names, places, modifiers, custom properties and the keys of their sliders, and their
    materials if the new mesh has as many slots. A pad that drives none of the sliders any more is removed.

    Parameters
    ----------
    old : bpy.types.Object
        The object of the last bake, the first one of two.
    new : sequence of bpy.types.Object
        The objects of the new bake, in the same order.

    Returns
    -------
    list of bpy.types.Object
        The objects that have the new meshes.
    """
    kept, pads = dict(zip(new, objects_of(old), strict=False)), _pads(old)
    for own, before in kept.items():
        _take_sliders(before, own)
        there = [name for name in custom_properties(own) if name in before]
        take_properties(before, own, [name for name in custom_properties(own) if name not in there])
        _take_drivers(before, own, ["modifiers[", *map(slider_path, there)])
        _take_mesh(before, own)
        _take_records(before, own)
        if own.parent is not None and own.parent in kept:
            before.matrix_local = own.matrix_local
    found = [kept.get(own, own) for own in new]
    for obj in found:
        _read_from(obj, kept)
    for own in [own for own in found if own not in kept.values() and own.parent in kept]:
        own.parent = kept[own.parent]
    remove_with_data(list(kept))
    remove_idle_pads(pads)
    return found


def delete_keys(keyed: bpy.types.Object) -> tuple[list[Sentence], list[Sentence]]:
    """Remove the objects of a bake, their pad and the keys of parts that follow them, and show what it has hidden.

    Parameters
    ----------
    keyed : bpy.types.Object
        The object of the bake, the first one of two.

    Returns
    -------
    remarks : list of Sentence
        What else was removed.
    warnings : list of Sentence
        What the user has to do.
    """
    hidden, pads, objects = hidden_only_by(keyed), _pads(keyed), objects_of(keyed)
    remarks = _detached_notices(detach_parts(objects))
    warnings = _dangling_notices(_followers(objects))
    remove_with_data(objects)
    remove_idle_pads(pads)
    show_again(hidden)
    return remarks, [*warnings, *unfound_notices(hidden)]


def _detached_notices(detached: Sequence[bpy.types.Object]) -> list[Sentence]:
    """Return a notice about objects that no longer follow a bake."""
    if not detached:
        return []
    return [Sentence("The shape keys with which {names} followed it are removed", {"names": _names(detached)})]


def _dangling_notices(left: Sequence[bpy.types.Object]) -> list[Sentence]:
    """Return a notice about objects whose drivers read nothing now."""
    if not left:
        return []
    names = {"names": _names(left)}
    return [Sentence("Drivers of shape keys of {names} read sliders that are deleted; remove these drivers", names)]


def following_notices(keyed: Sequence[bpy.types.Object]) -> list[Sentence]:
    """Return a notice that parts attached to objects with new keys still follow the keys of the last bake."""
    followers = _followers(keyed)
    if not followers:
        return []
    return [Sentence("Attach {names} again, since their keys follow the last bake", {"names": _names(followers)})]


def _names(objects: Sequence[bpy.types.Object]) -> str:
    return ", ".join(obj.name for obj in objects)


def _followers(keyed: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the objects of other meshes whose shape keys are driven by sliders of some objects."""
    meshes = [obj.data for obj in keyed]
    return [obj for obj in bpy.data.objects if obj.data not in meshes and _follows(obj, keyed)]


def _follows(obj: bpy.types.Object, keyed: Sequence[bpy.types.Object]) -> bool:
    """Return whether shape keys of another object are driven by sliders of some objects."""
    keys = obj.data.shape_keys if obj.type == "MESH" else None
    return any(target.id in keyed for target in driver_targets(keys))


def _pads(keyed: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the pads that drive the sliders of a bake."""
    return list(dict.fromkeys(pad for obj in objects_of(keyed) for pad in pads_of(obj)))


def _take_sliders(before: bpy.types.Object, own: bpy.types.Object) -> None:
    """Give an object the sliders of a new one; those that it has keep their values and keys."""
    for name in slider_names(before):
        if name not in slider_names(own):
            before.driver_remove(slider_path(name))
            remove_curve(before, slider_path(name))
            before.pop(name, None)
    for name in slider_names(own):
        if name in before:
            continue
        add_slider(before, name)
        for curve in curves_of(own, slider_path(name)):
            ensure_action(before)
            for point in curve.keyframe_points:
                before[name] = point.co.y
                before.keyframe_insert(slider_path(name), frame=point.co.x)
        before[name] = own[name]


def _take_drivers(before: bpy.types.Object, own: bpy.types.Object, kept: Sequence[str]) -> None:
    """Give an object the drivers of a new one, except for those of properties whose data paths begin like `kept`."""
    for curve in [curve for curve in drivers_of(own) if not curve.data_path.startswith(tuple(kept))]:
        before.driver_remove(curve.data_path)
        data = before.animation_data or before.animation_data_create()
        data.drivers.from_existing(src_driver=curve)


def _take_mesh(before: bpy.types.Object, own: bpy.types.Object) -> None:
    """Give an object, and all others that show the same mesh, the mesh of a new one."""
    spare, mesh = before.data, own.data
    if len(spare.materials) == len(mesh.materials):
        for place, material in enumerate(spare.materials):
            mesh.materials[place] = material
    for obj in [obj for obj in bpy.data.objects if obj.data == spare]:
        obj.data = mesh
    before.active_shape_key_index = 0
    if spare.users == 0:
        name = spare.name
        remove_mesh(spare)
        mesh.name = name


def _take_records(before: bpy.types.Object, own: bpy.types.Object) -> None:
    """Give an object what is stored with a new one."""
    for key in BAKE_KEYS:
        before.pop(key, None)
        if key in own:
            value = own[key]
            before[key] = value.to_dict() if hasattr(value, "to_dict") else value
    take_hidden(before, own)


def _read_from(obj: bpy.types.Object, kept: Mapping[bpy.types.Object, bpy.types.Object]) -> None:
    """Let an object and its keys read sliders from the objects that take the place of others."""
    if SWAP_KEY in obj:
        swap = obj[SWAP_KEY].to_dict()
        obj[SWAP_KEY] = {**swap, "object": kept.get(swap["object"], swap["object"])}
    for block in (obj, obj.data.shape_keys):
        for target in driver_targets(block):
            target.id = kept.get(target.id, target.id)
