# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One object that plays a morph: its *Morph* value says which of the baked blends is seen.

Geometry nodes choose, so that a file needs no add-on to play, in the viewport as in renders.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from bpy_extras.anim_utils import action_get_channelbag_for_slot

from ...errors import InputError
from ..keyframes import EASINGS
from ..node_inputs import NodeInput, node_input
from ..node_math import math_node
from ..sequence import (
    MODIFIER,
    along_x,
    frame_group,
    nearest,
    object_info,
    output,
    own_geometry,
    pick,
    table_object,
    write_table,
)
from .frame_colors import colored, colored_materials, seen_materials
from .stand_ins import SHOWS_KEY, adopt, homes, require_none, set_shown, stand_ins
from .stored import INDEX_KEY, WEIGHTS_KEY, frame_objects, stored_morph

VALUE = "Morph"
"""The modifier's input to animate: 0 is the first shape, 1 the second, and so on."""

PLAYBACK = "Playback"
"""The modifier's input that says what is beyond the last shape and before the first: one of `PLAYBACKS`."""

PLAYBACKS = {"ONCE": "Once", "LOOP": "Loop", "PING_PONG": "Ping-Pong"}
"""The items of that menu as the user sees them."""

OVERRIDE = "Override Material"
MATERIAL = "Material"


def make_player(
    collection: bpy.types.Collection, *, playback: str = "ONCE", easing: str = "LINEAR"
) -> bpy.types.Object:
    """Make an object that shows the blends of a path, and hide the objects that were baked.

    Its `VALUE` is keyed over the frames of the bake, so that what is seen is at first what was seen before. Between two
    blends the nearer one is seen. Under `Once` the ends stay beyond the ends. `Loop` starts again at the first shape
    past the last one, and `Ping-Pong` goes back and forth; to see either, add keys or extrapolate the curve.

    Parameters
    ----------
    collection : bpy.types.Collection
        A morph along a path.
    playback : str
        One of `PLAYBACKS`; to be changed later in the modifier.
    easing : str
        One of `keyframes.EASINGS`.

    Returns
    -------
    bpy.types.Object
        Beside the collection, where the frame objects stand. Its own mesh is a table: one vertex per blend, at the
        value of that blend on the X axis.

    Raises
    ------
    InputError
        As `require_path`.
    """
    require_path(collection)
    frames = _path_objects(collection)
    shapes = len(frames[0][WEIGHTS_KEY])
    name = f"{collection.name} Player"
    tree = frame_group(name)
    _add_inputs(tree)
    _fill(tree, frames, shapes)
    player = table_object(name, _table(frames), tree, seen_materials(tree, frames))
    modifier = player.modifiers[MODIFIER]
    node_input(modifier, PLAYBACK).set_item(tuple(PLAYBACKS.values()), PLAYBACKS[playback])
    adopt(collection, [player, tree, *colored_materials(tree)])
    for home in homes(collection):
        home.objects.link(player)
    _key(morph_value(player), frames, stored_morph(collection).first_frame, easing)
    set_shown(collection, False)
    return player


def require_path(collection: bpy.types.Collection) -> None:
    """Refuse a morph that no player can be made of.

    Raises
    ------
    InputError
        No path, too little of it, or something that plays the morph already.
    """
    require_none(collection)
    _path_objects(collection)


def refresh_player(collection: bpy.types.Collection) -> None:
    """Let the player of a morph, if there is one, show the frame objects that there are now; its keys stay.

    Raises
    ------
    InputError
        As `make_player`, where the morph is no longer a path.
    """
    for player in stand_ins(collection):
        if is_player(player):
            frames = _path_objects(collection)
            tree = player.modifiers[MODIFIER].node_group
            tree.nodes.clear()
            _fill(tree, frames, len(frames[0][WEIGHTS_KEY]))
            adopt(collection, colored_materials(tree))
            write_table(player.data, _table(frames), seen_materials(tree, frames))


def is_player(obj: bpy.types.Object | None) -> bool:
    """Tell whether an object plays a morph."""
    if obj is None or obj.get(SHOWS_KEY) is None or MODIFIER not in obj.modifiers:
        return False
    try:
        morph_value(obj)
    except InputError:
        return False
    return True


def morph_value(player: bpy.types.Object) -> NodeInput:
    """Return the value of a player to animate; draw it with ``layout.prop(value.owner, value.path, text="Morph")``."""
    return node_input(player.modifiers[MODIFIER], VALUE)


def playback(player: bpy.types.Object) -> NodeInput:
    """Return the choice of a player of what is seen beyond the last shape and before the first."""
    return node_input(player.modifiers[MODIFIER], PLAYBACK)


def _path_objects(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the frame objects of a path in their order."""
    frames = frame_objects(collection)
    if len(frames) < 2 or not all(_is_on_path(obj) for obj in frames):
        raise InputError(
            "{name} holds no morph along a path; for a sheet make a blend pad instead.", name=collection.name
        )
    return frames


def _is_on_path(obj: bpy.types.Object) -> bool:
    """Tell whether a frame object belongs to a path: it has its time, and blends at most two shapes in a row."""
    mixed = np.flatnonzero(obj[WEIGHTS_KEY])
    return obj.animation_data is not None and mixed.size > 0 and mixed[-1] - mixed[0] <= 1


def _values(frames: Sequence[bpy.types.Object]) -> np.ndarray:
    """Return the value at which each blend is exact, (n,)."""
    weights = np.array([list(obj[WEIGHTS_KEY]) for obj in frames])
    return weights @ np.arange(weights.shape[1])


def _table(frames: Sequence[bpy.types.Object]) -> np.ndarray:
    """Return the points of the player's own mesh, (n, 3)."""
    return np.outer(_values(frames), (1.0, 0.0, 0.0))


def _add_inputs(tree: bpy.types.NodeTree) -> None:
    """Give the node group what the user sets in the modifier."""
    for name, kind, description in (
        (VALUE, "NodeSocketFloat", "What is seen: 0 is the first shape, 1 the second, and so on"),
        (PLAYBACK, "NodeSocketMenu", "What is seen beyond the last shape and before the first"),
        (OVERRIDE, "NodeSocketBool", "Use one material instead of those of the baked meshes"),
        (MATERIAL, "NodeSocketMaterial", "The material to use instead"),
    ):
        tree.interface.new_socket(name, in_out="INPUT", socket_type=kind).description = description


def _fill(tree: bpy.types.NodeTree, frames: Sequence[bpy.types.Object], shapes: int) -> None:
    """Make the nodes: value, number of the nearest blend, its mesh where its object stands, its material."""
    inputs = tree.nodes.new("NodeGroupInput").outputs
    value = _played(tree, inputs[VALUE], inputs[PLAYBACK], shapes - 1.0)
    index = nearest(tree, own_geometry(tree), along_x(tree, value))
    infos = [object_info(tree, obj) for obj in frames]
    moved = tree.nodes.new("GeometryNodeTransform")
    if "Mode" in moved.inputs:
        moved.inputs["Mode"].default_value = "Matrix"
    else:  # Blender 4.5
        moved.mode = "MATRIX"
    chosen = pick(tree, "GEOMETRY", index, [info.outputs["Geometry"] for info in infos])
    place = pick(tree, "MATRIX", index, [info.outputs["Transform"] for info in infos])
    tree.links.new(chosen, moved.inputs["Geometry"])
    tree.links.new(place, moved.inputs["Transform"])
    own = colored(tree, moved.outputs["Geometry"], index, frames)
    output(tree, _dressed(tree, own, inputs[OVERRIDE], inputs[MATERIAL]), len(frames))


def _dressed(
    tree: bpy.types.NodeTree,
    geometry: bpy.types.NodeSocket,
    override: bpy.types.NodeSocket,
    material: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    """Return the geometry in its own materials, or all of it in another one."""
    other = tree.nodes.new("GeometryNodeSetMaterial")
    tree.links.new(geometry, other.inputs["Geometry"])
    tree.links.new(material, other.inputs["Material"])
    choice = tree.nodes.new("GeometryNodeSwitch")
    choice.input_type = "GEOMETRY"
    tree.links.new(override, choice.inputs["Switch"])
    tree.links.new(geometry, choice.inputs["False"])
    tree.links.new(other.outputs["Geometry"], choice.inputs["True"])
    return choice.outputs["Output"]


def _played(
    tree: bpy.types.NodeTree, value: bpy.types.NodeSocket, playback: bpy.types.NodeSocket, last: float
) -> bpy.types.NodeSocket:
    """Bring a value to 0 ... `last`, as the menu says; the ends stay as they are."""
    clamped = tree.nodes.new("ShaderNodeClamp")
    clamped.inputs["Max"].default_value = last
    tree.links.new(value, clamped.inputs["Value"])
    outside = tree.nodes.new("FunctionNodeCompare")
    outside.data_type, outside.operation = "FLOAT", "NOT_EQUAL"
    outside.inputs["Epsilon"].default_value = 0.0
    tree.links.new(value, outside.inputs["A"])
    tree.links.new(clamped.outputs["Result"], outside.inputs["B"])
    # A value that is neither, the last shape's, is kept: it would wrap to the first shape.
    wrapped = math_node(tree, "WRAP", value, last, 0.0)
    looped = tree.nodes.new("GeometryNodeSwitch")
    looped.input_type = "FLOAT"
    tree.links.new(outside.outputs["Result"], looped.inputs["Switch"])
    tree.links.new(value, looped.inputs["False"])
    tree.links.new(wrapped, looped.inputs["True"])
    menu = tree.nodes.new("GeometryNodeMenuSwitch")
    menu.data_type = "FLOAT"
    # The two items that a new menu has keep their numbers 0 and 1, so those of all are their places.
    texts = list(PLAYBACKS.values())
    for item, text in zip(menu.enum_items, texts, strict=False):
        item.name = text
    for text in texts[len(menu.enum_items) :]:
        menu.enum_items.new(text)
    bounced = math_node(tree, "PINGPONG", value, last)
    for text, source in zip(texts, (clamped.outputs["Result"], looped.outputs["Output"], bounced), strict=True):
        tree.links.new(source, menu.inputs[text])
    tree.links.new(playback, menu.inputs["Menu"])
    return menu.outputs["Output"]


def _key(value: NodeInput, frames: Sequence[bpy.types.Object], first_frame: int, easing: str) -> None:
    """Key the value at every shape that was baked and at the two ends of what was."""
    values = _values(frames)
    corners = {0, len(frames) - 1, *np.flatnonzero(values == np.round(values)).tolist()}
    for place in sorted(corners):
        value.set(float(values[place]))
        value.owner.keyframe_insert(value.path, frame=first_frame + frames[place][INDEX_KEY])
    data = value.modifier.id_data.animation_data
    bag = action_get_channelbag_for_slot(data.action, data.action_slot)
    curve = bag.fcurves.find(value.data_path)
    for point in curve.keyframe_points:
        point.interpolation = EASINGS[easing]
        point.easing = "EASE_IN_OUT"
    curve.update()
