# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur of pads: keys of the handle's velocity, because Geometry Nodes know only its current position."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ...errors import InputError
from ..animation_time import returning, show_time, times_per_second
from ..keyframes import changing_span, curves_of, scene_span, set_keys
from ..node_inputs import NodeInput, node_input
from ..visibility import hidden_modifiers, update_places
from .stand_ins import frames_modifier, stand_ins
from .stored import WEIGHTS_KEY

HANDLE_VELOCITY = "Handle Velocity"
"""Input of the modifier: velocity of the handle in local space of the pad, per second."""


def handle_velocity(collection: bpy.types.Collection) -> NodeInput | None:
    """Return the velocity of the handle of a morph's pad; None without a pad that interpolates."""
    for obj in stand_ins(collection):
        modifier = frames_modifier(obj)
        if modifier is not None:
            try:
                return node_input(modifier, HANDLE_VELOCITY)
            except InputError:
                continue
    return None


def key_handle_velocity(collection: bpy.types.Collection) -> None:
    """Key the velocity of a pad's handle from its movement, by keys of its location or by anything else.

    The velocity at a frame is the difference of the locations half a frame before and after it.

    Raises
    ------
    InputError
        There is no pad that interpolates, its handle does not exist, or it does not move.
    """
    target = handle_velocity(collection)
    if target is None:
        raise InputError("{name} has no pad that interpolates.", name=collection.name)
    pad, handle = _parts_read_by(target)
    if pad is None or handle is None:
        raise InputError("The pad of {name} has lost its handle; bake it again.", name=collection.name)
    scene = bpy.context.scene
    curves = [curve for curve in curves_of(handle, "location") if len(curve.keyframe_points)]
    is_keyed = _moves_by_keys_alone(handle, pad)
    span = changing_span(curves, scene) if is_keyed else scene_span(scene, curves)
    frames = np.arange(span.start - 1, span.stop + 1)
    times = np.append(frames, frames[-1] + 1) - 0.5
    places = _keyed_places(handle, curves, times) if is_keyed else _seen_places(target, pad, handle, times)
    velocities = np.diff(places, axis=0) * times_per_second(scene)
    if not curves and not velocities.any():
        raise InputError("The location of {name} has no keyframes; animate it first.", name=handle.name)
    _write(target, frames, velocities)


def _parts_read_by(target: NodeInput) -> tuple[bpy.types.Object | None, bpy.types.Object | None]:
    """Return the pad and the handle from which the nodes of a modifier take the blend; None for those that are gone."""
    infos = [node for node in target.modifier.node_group.nodes if node.bl_idname == "GeometryNodeObjectInfo"]
    read = [obj for node in infos if (obj := node.inputs["Object"].default_value) is not None]
    handle = next((obj for obj in read if obj.type == "EMPTY"), None)
    # The pad is the outline, and tables of fields are points.
    outlines = (obj for obj in read if obj.type == "MESH" and len(obj.data.edges) and WEIGHTS_KEY not in obj)
    return next(outlines, None), handle


def _moves_by_keys_alone(handle: bpy.types.Object, pad: bpy.types.Object) -> bool:
    """Return whether the keys of a handle's location tell all of its movement on its pad."""
    data = handle.animation_data
    is_animated_otherwise = data is not None and bool(data.nla_tracks or data.drivers)
    is_child = handle.parent == pad and handle.parent_type == "OBJECT" and handle.matrix_parent_inverse == Matrix()
    return is_child and not is_animated_otherwise and all(own.type == "LIMIT_LOCATION" for own in handle.constraints)


def _keyed_places(
    handle: bpy.types.Object, curves: list[bpy.types.FCurve], times: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return the locations of a handle by its keys at some times, (n, 3), within the bounds of its pad."""
    places = np.tile(np.array(handle.location), (len(times), 1))
    for curve in curves:
        places[:, curve.array_index] = [curve.evaluate(time) for time in times]
    # Its user may have removed the limit.
    for limit in (own for own in handle.constraints if own.type == "LIMIT_LOCATION"):
        low, high = ([getattr(limit, f"{end}_{axis}") for axis in "xyz"] for end in ("min", "max"))
        places = np.clip(places, low, high)
    return places


def _seen_places(
    target: NodeInput, pad: bpy.types.Object, handle: bpy.types.Object, times: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return where a handle is in local space of its pad at some times, (n, 3)."""
    scene, found = bpy.context.scene, []
    # Nothing of what the modifier shows is needed.
    with hidden_modifiers([target.modifier]), returning(scene):
        for time in times:
            show_time(scene, float(time))
            update_places([pad, handle], bpy.context.evaluated_depsgraph_get())
            found.append(pad.matrix_world.inverted_safe() @ handle.matrix_world.translation)
    return np.array(found, dtype=np.float64)


def _write(target: NodeInput, frames: NDArray[np.integer], values: NDArray[np.float64]) -> None:
    """Replace the keys of a vector, (n, 3)."""
    target.owner.keyframe_insert(target.path, frame=int(frames[0]))
    for curve in target.curves():
        set_keys(curve, np.stack([frames, values[:, curve.array_index]], axis=1))
