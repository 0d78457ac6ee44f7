# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur of pads: keys of the handle's velocity, because Geometry Nodes know only its current position."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ....errors import InputError
from ...animation_time import returning, show_time, times_per_second
from ...keyframes import changing_span, curves_of, own_action, scene_span, set_keys
from ...nodes.node_inputs import NodeInput
from ...visibility import hidden_modifiers, update_places
from .pad_inputs import HANDLE, PAD, pad_part


def key_handle_velocity(target: NodeInput) -> None:
    """Key the velocity of a pad's handle from its movement, by keys of its location or by anything else.

    The velocity at a frame is the difference of the locations half a frame before and after it.

    Parameters
    ----------
    target : NodeInput
        One of `handle_velocities`.

    Raises
    ------
    InputError
        The handle does not exist, or it does not move.
    """
    pad, handle = (pad_part(target.modifier, name) for name in (PAD, HANDLE))
    if pad is None or handle is None:
        name = target.modifier.id_data.name
        raise InputError("The pad of {name} has lost its handle; bake it again.", name=name)
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
    own_action(target.modifier.id_data)
    _write(target, frames, velocities)


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
