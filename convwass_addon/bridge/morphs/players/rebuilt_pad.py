# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Let the objects of a pad show a new bake of its morph."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import bpy
from bpy_extras.anim_utils import action_get_channelbag_for_slot
from mathutils import Matrix, Vector

from ...keyframes import curves_of, own_action
from ...unused_data import remove_if_unused
from ..stand_ins import SHOWS_KEY, adopt, adopted, drop_numbers, frames_modifier, marked_by, remove_unused, stand_ins
from ..stored import WEIGHTS_KEY
from .blend_pad import PLACE_KEY, build_blend_pad, make_blend_pad, require_all_blends
from .pad_inputs import HANDLE, PAD, handle_velocities, pad_input, pad_part
from .pad_velocity import key_handle_velocity
from .player_inputs import can_mix

if TYPE_CHECKING:
    from ..fields.field_sampling import SampledFields

# Relative difference of widths that rounding makes.
_SAME_WIDTH = 1e-6


def rebuild_pad(collection: bpy.types.Collection, sampled: SampledFields | None = None) -> None:
    """Let the pad of a morph show its current frames.

    Its objects remain, with all that was added to them. The handle stays at its blend, and what was moved keeps its
    distance from where it is made. Deleted objects are made again.

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph.
    sampled : SampledFields, optional
        Fields of its frames; without them, they are sampled if the pad mixes blends.

    Raises
    ------
    InputError
        The morph is no longer a sheet; the pad is kept then.
    """
    require_all_blends(collection)
    bpy.context.view_layer.update()
    before, parents = stand_ins(collection), marked_by(collection, bpy.data.collections)
    known = {block.session_uid for block in adopted(collection)}
    mixed = any(can_mix(obj) for obj in before)
    # A morph cannot have two pads.
    for obj in before:
        del obj[SHOWS_KEY]
    try:
        if mixed and sampled is not None:
            build_blend_pad(collection, sampled=sampled)
        else:
            make_blend_pad(collection, between="INTERPOLATED" if mixed else "NEAREST")
    finally:
        adopt(collection, before)
    _take_over(_parts(before), _parts(obj for obj in stand_ins(collection) if obj not in before))
    _merge(parents, [new for new in marked_by(collection, bpy.data.collections) if new not in parents])
    remove_unused(collection)
    drop_numbers(block for block in adopted(collection) if block.session_uid not in known)
    for velocity in handle_velocities(collection):
        if curves_of(pad_part(velocity.modifier, HANDLE), "location"):
            key_handle_velocity(velocity)


def _merge(parents: Sequence[bpy.types.Collection], others: Sequence[bpy.types.Collection]) -> None:
    """Move the objects of other collections to the first one, if there is one, and remove those that are empty then."""
    for other in others:
        for obj in [obj for obj in other.objects if parents]:
            if len(obj.users_collection) == 1:
                parents[0].objects.link(obj)
            other.objects.unlink(obj)
        if not other.objects:
            bpy.data.collections.remove(other)


def _parts(objects: Iterable[bpy.types.Object]) -> dict[object, list[bpy.types.Object]]:
    """Return the objects of a pad that are in a collection by their purpose, duplicates after their originals."""
    parts: dict[object, list[bpy.types.Object]] = defaultdict(list)
    for obj in objects:
        if obj.users_collection:
            parts[_purpose(obj)].append(obj)
    return parts


def _purpose(obj: bpy.types.Object) -> object:
    """Return what an object of a pad is for, with the corner of a name."""
    if obj.type == "FONT":
        x, y = obj.data.offset_x, obj.data.offset_y
        return obj.type, 0 if 2.0 * abs(x) < abs(y) else math.copysign(1, x), math.copysign(1, y)
    if obj.type != "MESH":
        return obj.type
    modifier = frames_modifier(obj)
    if modifier is None:
        # Without its modifier, an object that shows frames is a point.
        return "PAD" if len(obj.data.edges) else "NOTHING"
    infos = [node for node in modifier.node_group.nodes if node.bl_idname == "GeometryNodeObjectInfo"]
    read = [node.inputs["Object"].default_value for node in infos]
    # The blend also reads the pad and its handle.
    return "CORNERS" if all(other is not None and WEIGHTS_KEY in other for other in read) else "BLEND"


def _take_over(before: Mapping[object, list[bpy.types.Object]], made: Mapping[object, list[bpy.types.Object]]) -> None:
    """Let the objects of a pad show what new ones show, and remove these; new ones without a counterpart are kept."""
    width = _width(before.get("PAD", ()))
    ratio = _width(made["PAD"]) / width if width else 1.0
    pairs = [(before[purpose], new) for purpose, (new,) in made.items() if before.get(purpose)]
    spare = [obj.data for objects, new in pairs for obj in (*objects, new)]
    for objects, new in pairs:
        for obj in objects:
            _give(obj, new)
        parents = objects[0].users_collection
        new.user_remap(objects[0])
        for parent in set(objects[0].users_collection).difference(parents):
            parent.objects.unlink(objects[0])
    if not math.isclose(ratio, 1.0, rel_tol=_SAME_WIDTH):
        _scale_locations(before.get("EMPTY", ()), ratio)
    bpy.data.batch_remove([new for _, new in pairs])
    remove_if_unused(spare)


def _width(pads: Sequence[bpy.types.Object]) -> float:
    """Return the width of the first pad; 0 if there is none."""
    places = [vertex.co.x for pad in pads[:1] for vertex in pad.data.vertices]
    return max(places) - min(places) if places else 0.0


def _give(obj: bpy.types.Object, new: bpy.types.Object) -> None:
    """Let an object show what a new one shows."""
    if PLACE_KEY in new:
        _move_along(obj, new)
    if obj.type == "FONT":
        for name in ("size", "offset_x", "offset_y"):
            setattr(obj.data, name, getattr(new.data, name))
    elif obj.type == "EMPTY":
        _give_reach(obj, new)
    else:
        obj.data = new.data
        if (modifier := frames_modifier(new)) is not None:
            _give_nodes(frames_modifier(obj), modifier)


def _give_nodes(modifier: bpy.types.NodesModifier, new: bpy.types.NodesModifier) -> None:
    """Let a modifier use the nodes of a new one, and the lattice and the handle of that if its own are missing."""
    modifier.node_group = new.node_group
    for name in (PAD, HANDLE):
        own = pad_input(modifier, name)
        if own is not None and own.get() is None:
            own.set(pad_part(new, name))


def _move_along(obj: bpy.types.Object, new: bpy.types.Object) -> None:
    """Move an object as far as a new one is made from where the object was made, if an earlier version stored that."""
    if PLACE_KEY in obj:
        further = new.location - Vector(obj[PLACE_KEY])
        space = obj.parent.matrix_world @ obj.matrix_parent_inverse if obj.parent else Matrix()
        obj.location += space.to_3x3().inverted_safe() @ further
    obj[PLACE_KEY] = new[PLACE_KEY]


def _give_reach(handle: bpy.types.Object, new: bpy.types.Object) -> None:
    """Limit a handle to the bounds of a new pad, unless its user has removed the limits."""
    limits = [next((own for own in obj.constraints if own.type == "LIMIT_LOCATION"), None) for obj in (handle, new)]
    if None not in limits:
        for name in (f"{end}_{axis}" for end in ("min", "max") for axis in "xyz"):
            setattr(limits[0], name, getattr(limits[1], name))


def _scale_locations(handles: Sequence[bpy.types.Object], ratio: float) -> None:
    """Multiply the sizes, the locations and the keyed locations of handles, also keys that they share once."""
    for handle in handles:
        handle.empty_display_size *= ratio
        handle.location *= ratio
        own_action(handle)
    for curve in _location_curves(handles):
        for key in curve.keyframe_points:
            # The left and right ends of its tangent are stored as positions.
            left, right = (ratio * end.y for end in (key.handle_left, key.handle_right))
            key.co.y *= ratio
            key.handle_left.y, key.handle_right.y = left, right
        curve.update()


def _location_curves(objects: Iterable[bpy.types.Object]) -> list[bpy.types.FCurve]:
    """Return the curves of the locations of objects, also those in NLA strips, each once."""
    there = [data for obj in objects if (data := obj.animation_data) is not None]
    strips = [own for data in there for own in (data, *(one for track in data.nla_tracks for one in track.strips))]
    animated = dict.fromkeys((own.action, own.action_slot) for own in strips if own.action and own.action_slot)
    bags = [action_get_channelbag_for_slot(*both) for both in animated]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves if curve.data_path == "location"]
