# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur of pads: keys of the handle's velocity, because Geometry Nodes know only its current position."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..animation_time import times_per_second
from ..keyframes import changing_span, curves_of
from ..node_inputs import NodeInput, node_input
from .stand_ins import frames_modifier, stand_ins

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
    """Key the velocity of a pad's handle from the keys of its location.

    The velocity at a frame is the difference of the locations half a frame before and after it.

    Raises
    ------
    InputError
        There is no pad that interpolates, or the location of its handle has no keys.
    """
    target = handle_velocity(collection)
    if target is None:
        raise InputError("{name} has no pad that interpolates.", name=collection.name)
    handle = next(obj for obj in stand_ins(collection) if obj.type == "EMPTY")
    curves = [curve for curve in curves_of(handle) if curve.data_path == "location" and len(curve.keyframe_points)]
    if not curves:
        raise InputError("The location of {name} has no keyframes; animate it first.", name=handle.name)
    span = changing_span(curves, bpy.context.scene)
    frames = np.arange(span.start - 1, span.stop + 1)
    before, after = (_places(handle, curves, frames + side) for side in (-0.5, 0.5))
    _write(target, frames, (after - before) * times_per_second(bpy.context.scene))


def _places(
    handle: bpy.types.Object, curves: list[bpy.types.FCurve], frames: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return the locations of a handle at some frames, (n, 3), within the bounds of its pad."""
    places = np.tile(np.array(handle.location), (len(frames), 1))
    for curve in curves:
        places[:, curve.array_index] = [curve.evaluate(frame) for frame in frames]
    # Its user may have removed the limit.
    for limit in (own for own in handle.constraints if own.type == "LIMIT_LOCATION"):
        low, high = ([getattr(limit, f"{end}_{axis}") for axis in "xyz"] for end in ("min", "max"))
        places = np.clip(places, low, high)
    return places


def _write(target: NodeInput, frames: NDArray[np.integer], values: NDArray[np.float64]) -> None:
    """Replace the keys of a vector, (n, 3)."""
    target.owner.keyframe_insert(target.path, frame=int(frames[0]))
    for curve in curves_of(target.modifier.id_data):
        if curve.data_path == target.data_path:
            curve.keyframe_points.clear()
            curve.keyframe_points.add(len(frames))
            points = np.stack([frames, values[:, curve.array_index]], axis=1)
            curve.keyframe_points.foreach_set("co", points.astype(np.float32).ravel())
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
            curve.update()
