# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One object that plays a morph: its value *Morph* selects the visible blend.

Geometry Nodes select the blend, so a file does not need the add-on to play in the viewport and in renders.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np
from numpy.typing import NDArray

from ....errors import InputError
from ...keyframes import ease, repeat
from ...nodes.node_inputs import NodeInput, node_input
from ...nodes.node_math import math_node, new_node, switch
from ...nodes.node_trees import GroupInput, add_inputs
from ...render_settings import take_render_settings
from ...rendered_maps import take_color_name
from ...sequence import (
    along_x,
    frame_group,
    nearest,
    output,
    own_geometry,
    table_object,
    transformed,
    write_table,
)
from ..fields.mixed_frames import DETAIL, INTERPOLATE
from ..fields.path_mixture import MOMENT, SPEED, VALUE, moment_group, path_columns
from ..fields.stored_fields import StoredFields
from ..frame_switch import FrameSwitch
from ..looks.frame_colors import colored, made_for, seen_materials
from ..stand_ins import (
    SHOWS_KEY,
    adopt,
    adopted,
    collections_for_stand_ins,
    drop_numbers,
    frames_modifier,
    hide_frames,
    remove_unused,
    require_none,
    stand_ins,
)
from ..stored import (
    WEIGHTS_KEY,
    frame_number,
    frame_times,
    frame_weights,
    interpolates,
    some_frame_objects,
    stored_morph,
)
from .player_inputs import (
    MATERIAL,
    OVERRIDE,
    PLAYBACK,
    PLAYBACKS,
    SAME_MOMENT,
    interpolation,
    is_player,
    morph_value,
)

if TYPE_CHECKING:
    from ..fields.field_sampling import SampledFields


def make_player(
    collection: bpy.types.Collection, *, playback: str = "ONCE", easing: str = "LINEAR", between: str = "NEAREST"
) -> bpy.types.Object:
    """Sample fields if the player is to interpolate `between` blends, and run :func:`build_player`."""
    require_playable(collection, between)
    sampled = _sampled(collection) if interpolates(collection, between) else None
    return build_player(collection, playback=playback, easing=easing, sampled=sampled)


def build_player(
    collection: bpy.types.Collection, *, playback: str, easing: str, sampled: SampledFields | None
) -> bpy.types.Object:
    """Create an object that shows the blends of a path, and hide the baked objects.

    Its `VALUE` is keyed over the frames of the bake, so that the animation is unchanged at first. With `Once`, the
    first and last shapes are also shown outside of the path. `Loop` continues with the first shape after the last one,
    and `Ping-Pong` goes back and forth: a modifier of the curve lets the value go on beyond its keys.

    Parameters
    ----------
    collection : bpy.types.Collection
        A morph along a path.
    playback : str
        One of `PLAYBACKS`; can be changed in the modifier, which leaves the curve of the value as it is.
    easing : str
        One of `keyframes.EASINGS`.
    sampled : SampledFields or None
        Fields of the blends, with which the player mixes the two around a moment; without them, and for flat shapes,
        it shows the nearer one.

    Returns
    -------
    bpy.types.Object
        In the same collection as the frame objects. Its own mesh is a table with one vertex per blend, at the value of
        that blend on the X axis.

    Raises
    ------
    InputError
        As `require_playable`.
    """
    require_playable(collection, "NEAREST" if sampled is None else "INTERPOLATED")
    frames = _path_objects(collection)
    name = f"{collection.name} Player"
    fields = None if sampled is None else _stored(collection, frames, sampled)
    tree = frame_group(name)
    _add_inputs(tree, sampled is not None)
    _fill(tree, collection, frames, fields)
    player = table_object(name, _table(frames), tree, seen_materials(tree, frames))
    take_color_name(player.data, [obj.data for obj in frames])
    take_render_settings(player, frames)
    adopt(collection, [player, *made_for(tree)])
    node_input(frames_modifier(player), PLAYBACK).set_item(tuple(PLAYBACKS.values()), PLAYBACKS[playback])
    for parent in collections_for_stand_ins(collection):
        parent.objects.link(player)
    _key(morph_value(player), frames, frame_times(collection), easing)
    if playback != "ONCE":
        repeat(morph_value(player).curve())
    hide_frames(collection)
    return player


def require_playable(collection: bpy.types.Collection, between: str) -> None:
    """Raise InputError if no player that shows something `between` blends can be created for a morph.

    Raises
    ------
    InputError
        Not a path, a path that is too short, another object already plays the morph, or blends cannot be interpolated
        because they are not in the order of their values.
    """
    require_none(collection)
    frames = _path_objects(collection)
    if interpolates(collection, between) and (np.diff(_values(frames)) < -SAME_MOMENT).any():
        # Frames of a player that went back and forth.
        raise InputError(
            "{name} returns to moments that it has left, so its frames cannot be interpolated; set In Between to "
            "Nearest Blend.",
            name=collection.name,
        )


def refresh_player(collection: bpy.types.Collection, sampled: SampledFields | None = None) -> None:
    """Make the player of a morph, if there is one, show its current frame objects; its keys are kept.

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph.
    sampled : SampledFields, optional
        Fields of its frames; without them, they are sampled if the player mixes blends.

    Raises
    ------
    InputError
        As `make_player`, if the morph is no longer a path.
    """
    before = set(adopted(collection))
    for player in [obj for obj in stand_ins(collection) if is_player(obj)]:
        frames = _path_objects(collection)
        tree = frames_modifier(player).node_group
        fields = None
        if interpolation(player) is not None:
            sampled = _sampled(collection) if sampled is None else sampled
            fields = _stored(collection, frames, sampled)
        tree.nodes.clear()
        _fill(tree, collection, frames, fields)
        adopt(collection, made_for(tree))
        write_table(player.data, _table(frames), seen_materials(tree, frames))
        take_color_name(player.data, [obj.data for obj in frames])
    remove_unused(collection)
    drop_numbers(set(adopted(collection)) - before)


def pace(player: bpy.types.Object) -> float:
    """Return the change of the value per frame of the bake."""
    frames = _path_objects(player[SHOWS_KEY])
    values = _values(frames)
    return float((values[-1] - values[0]) / (frame_number(frames[-1]) - frame_number(frames[0])))


def _path_objects(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the frame objects of a path in order."""
    frames = some_frame_objects(collection)
    if len(frames) < 2:
        raise InputError(
            "{name} consists of one mesh, so there is nothing to play; bake an animation.", name=collection.name
        )
    if not all(_is_on_path(obj) for obj in frames):
        raise InputError(
            "{name} holds no morph along a path; for a sheet make a blend pad instead.", name=collection.name
        )
    return frames


def _is_on_path(obj: bpy.types.Object) -> bool:
    """Return whether a frame object belongs to a path: it has a time, and blends at most two consecutive shapes."""
    mixed = np.flatnonzero(obj[WEIGHTS_KEY])
    return obj.animation_data is not None and mixed.size > 0 and mixed[-1] - mixed[0] <= 1


def _values(frames: Sequence[bpy.types.Object]) -> np.ndarray:
    """Return the value of each blend, (n,)."""
    weights = frame_weights(frames)
    return weights @ np.arange(weights.shape[1])


def _table(frames: Sequence[bpy.types.Object]) -> np.ndarray:
    """Return the points of the player's own mesh, (n, 3)."""
    return np.outer(_values(frames), (1.0, 0.0, 0.0))


def _add_inputs(tree: bpy.types.NodeTree, interpolates: bool) -> None:
    """Add the inputs of the modifier to the node group."""
    value, *others = MOMENT
    interpolate = "Mix the two baked blends beside the value instead of showing the nearer one"
    mixing = (GroupInput(INTERPOLATE, "Bool", True, interpolate), *others)
    inputs = (
        value,
        GroupInput(PLAYBACK, "Menu", None, "What to show beyond the last shape and before the first"),
        *(mixing if interpolates else ()),
        GroupInput(OVERRIDE, "Bool", False, "Use one material instead of those of the baked meshes"),
        GroupInput(MATERIAL, "Material", None, "The material to use instead"),
    )
    add_inputs(tree, inputs)


def _fill(
    tree: bpy.types.NodeTree,
    collection: bpy.types.Collection,
    frames: Sequence[bpy.types.Object],
    fields: StoredFields | None,
) -> None:
    """Create the nodes: value, index of the nearest blend, its mesh at its object's position, its material.

    With fields of the blends, mixtures of two are shown while interpolation is enabled.
    """
    blends = FrameSwitch.of(collection.name, frames)
    shapes = len(frames[0][WEIGHTS_KEY])
    inputs = tree.nodes.new("NodeGroupInput").outputs
    value = _played(tree, inputs[VALUE], inputs[PLAYBACK], shapes - 1.0)
    index = nearest(tree, own_geometry(tree), along_x(tree, value))
    blend = blends.at(tree, index)
    shown = transformed(tree, blend["Geometry"], blend["Transform"])
    shown = colored(tree, shown, blend["Color"], frames)
    if fields is not None:
        moment = moment_group(f"{collection.name} Moment", fields, blends)
        fed = {VALUE: value, DETAIL: inputs[DETAIL], SPEED: inputs[SPEED]}
        node = new_node(tree, "GeometryNodeGroup", fed, node_tree=moment)
        shown = switch(tree, "GEOMETRY", inputs[INTERPOLATE], shown, node.outputs["Geometry"])
    output(tree, _with_override(tree, shown, inputs[OVERRIDE], inputs[MATERIAL]), len(frames))


def _sampled(collection: bpy.types.Collection) -> SampledFields:
    """Sample the fields of the blends of a path."""
    from ..fields.field_sampling import sampled_fields

    return sampled_fields(collection, _path_objects(collection))


def _stored(
    collection: bpy.types.Collection, frames: Sequence[bpy.types.Object], sampled: SampledFields
) -> StoredFields:
    """Store the fields of the blends of a path."""
    from ..fields.field_sampling import store_fields

    # The scene may play at another rate since the bake; the velocities of the frames do not change with it.
    columns = path_columns(frames, stored_morph(collection).rate_in(bpy.context.scene))
    return store_fields(collection, frames, sampled, _table(frames), columns)


def _with_override(
    tree: bpy.types.NodeTree,
    geometry: bpy.types.NodeSocket,
    override: bpy.types.NodeSocket,
    material: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    """Return the geometry with its own materials, or with another one."""
    other = new_node(tree, "GeometryNodeSetMaterial", {"Geometry": geometry, "Material": material})
    return switch(tree, "GEOMETRY", override, geometry, other.outputs["Geometry"])


def _played(
    tree: bpy.types.NodeTree, value: bpy.types.NodeSocket, playback: bpy.types.NodeSocket, last: float
) -> bpy.types.NodeSocket:
    """Map a value to the range from 0 to `last`, as the menu selects; both ends are included."""
    clamped = new_node(tree, "ShaderNodeClamp", {"Max": last, "Value": value}).outputs["Result"]
    ends = {"Epsilon": 0.0, "A": value, "B": clamped}
    outside = new_node(tree, "FunctionNodeCompare", ends, data_type="FLOAT", operation="NOT_EQUAL")
    # The value of the last shape is kept, because it would wrap to the first shape.
    wrapped = math_node(tree, "WRAP", value, last, 0.0)
    looped = switch(tree, "FLOAT", outside.outputs["Result"], value, wrapped)
    menu = new_node(tree, "GeometryNodeMenuSwitch", data_type="FLOAT")
    # The two items of a new menu keep their numbers 0 and 1, so all numbers are positions.
    texts = list(PLAYBACKS.values())
    for item, text in zip(menu.enum_items, texts, strict=False):
        item.name = text
    for text in texts[len(menu.enum_items) :]:
        menu.enum_items.new(text)
    bounced = math_node(tree, "PINGPONG", value, last)
    for text, source in zip(texts, (clamped, looped, bounced), strict=True):
        tree.links.new(source, menu.inputs[text])
    tree.links.new(playback, menu.inputs["Menu"])
    return menu.outputs["Output"]


def _key(value: NodeInput, frames: Sequence[bpy.types.Object], times: NDArray[np.float64], easing: str) -> None:
    """Key the value at every baked shape and at both ends of the bake; at all frames if those between are not even."""
    values = _values(frames)
    keyed = np.isin(np.arange(len(frames)), (0, len(frames) - 1)) | (values == np.round(values))
    if easing == "LINEAR" and np.abs(np.interp(times, times[keyed], values[keyed]) - values).max() > SAME_MOMENT:
        # Frames of a player that was retimed, or whose keys were moved.
        keyed[:] = True
    for time, own in zip(times[keyed].tolist(), values[keyed].tolist(), strict=True):
        value.set(own)
        value.owner.keyframe_insert(value.path, frame=time)
    ease(value.curve(), easing)
