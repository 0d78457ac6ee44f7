# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Timings of a player as keys of its value, and the resulting speed for motion blur."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from ...schema import Choice, Settings, setting
from ..animation_time import time_of_frame
from ..keyframes import changing_span, curves_of
from ..node_inputs import NodeInput
from .player import last_value, morph_value, pace, playback_item, speed

# Half of the range shown in slow motion, in shapes.
_SLOW_HALF = 0.15


@dataclass(frozen=True)
class Retiming(Settings):
    """Settings of the timing of a player."""

    style: str = setting(
        "EASE",
        "Style",
        "Timing of the value between shapes",
        choices=(
            Choice("LINEAR", "Linear", "At constant speed"),
            Choice("EASE", "Ease", "Ease out of every shape and into the next"),
            Choice("HOLD", "Hold", "Ease, and pause at every shape"),
            Choice("BOUNCE", "Bounce", "Fall into every shape and bounce back from it, less each time"),
            Choice("SLOW_MOTION", "Slow Motion", "At constant speed, but slowly around the current moment"),
            Choice("BACK_AND_FORTH", "Back and Forth", "Ease to the last shape and back to the first"),
        ),
    )
    frames: int = setting(24, "Frames", "Scene frames from each shape to the next", least=1, most=10_000, soft_most=250)
    hold: int = setting(
        24, "Hold", "Scene frames for which every shape is shown unchanged", least=0, most=10_000, soft_most=250
    )
    slowness: float = setting(
        10.0, "Slowness", "Factor by which slow motion is slower", least=1.0, most=1000.0, soft_most=20.0
    )


@dataclass(frozen=True)
class Key:
    """A key of the value, and the interpolation after it.

    Attributes
    ----------
    frame, value : float
        Frame and value of the key.
    interpolation, easing : str
        Blender's identifiers.
    """

    frame: float
    value: float
    interpolation: str = "LINEAR"
    easing: str = field(default="AUTO")


def keys_of(timing: Retiming, start: float, shapes: int, now: float) -> list[Key]:
    """Return the keys of a timing.

    Parameters
    ----------
    timing : Retiming
        The style.
    start : float
        Scene frame of the first key.
    shapes : int
        Number of shapes.
    now : float
        Center of the slow motion.
    """
    last, frames = shapes - 1, timing.frames
    if timing.style == "SLOW_MOTION":
        return _slow_keys(timing, start, last, now)
    stops = list(range(shapes))
    if timing.style == "BACK_AND_FORTH":
        stops += stops[-2::-1]
    how = {"LINEAR": ("LINEAR", "AUTO"), "BOUNCE": ("BOUNCE", "EASE_OUT")}.get(timing.style, ("SINE", "EASE_IN_OUT"))
    if timing.style != "HOLD":
        return [Key(start + frames * place, float(stop), *how) for place, stop in enumerate(stops)]
    keys = []
    for place, stop in enumerate(stops):
        frame = start + (frames + timing.hold) * place
        keys += [Key(frame, float(stop)), Key(frame + timing.hold, float(stop), *how)]
    return keys


def _slow_keys(timing: Retiming, start: float, last: int, now: float) -> list[Key]:
    low, high = max(now - _SLOW_HALF, 0.0), min(now + _SLOW_HALF, float(last))
    keys = [Key(start, 0.0)]
    for value, slowness in ((low, 1.0), (high, timing.slowness), (float(last), 1.0)):
        if value > keys[-1].value:
            frame = keys[-1].frame + (value - keys[-1].value) * timing.frames * slowness
            keys.append(Key(frame, value))
    return keys


def retime(player: bpy.types.Object, timing: Retiming) -> range:
    """Replace the keys of a player's value, starting where the old ones did, or else at the current frame.

    Returns
    -------
    range
        Scene frames of the first and the last key.
    """
    value = morph_value(player)
    curve = _curve(player, value)
    scene = bpy.context.scene
    start = curve.range()[0] if curve is not None else time_of_frame(scene, scene.frame_current)
    keys = keys_of(timing, start, last_value(player) + 1, float(value.get()))
    curve = _written(player, value, [(key.frame, key.value) for key in keys])
    for point, key in zip(curve.keyframe_points, keys, strict=True):
        point.interpolation, point.easing = key.interpolation, key.easing
    curve.update()
    key_speed(player)
    return range(round(keys[0].frame), round(keys[-1].frame) + 1)


def key_speed(player: bpy.types.Object) -> None:
    """Key the speed of a player from the change of its value; without keys of the value the speed is 0.

    The speed at a frame is the difference of the value half a frame before and after it, and 0 beyond the ends unless
    they repeat.
    """
    target = speed(player)
    if target is None:
        return
    curve = _curve(player, morph_value(player))
    if curve is None or not len(curve.keyframe_points):
        return
    span = changing_span([curve], bpy.context.scene)
    frames = np.arange(span.start - 1, span.stop + 1)
    sides = np.array([[curve.evaluate(frame + side) for side in (-0.5, 0.5)] for frame in frames])
    if playback_item(player) == "ONCE":
        sides = np.clip(sides, 0.0, last_value(player))
    speeds = (sides[:, 1] - sides[:, 0]) / pace(player)
    written = _written(player, target, np.stack([frames, speeds], axis=1).tolist())
    for point in written.keyframe_points:
        point.interpolation = "LINEAR"
    written.update()


def keyed_span(player: bpy.types.Object) -> tuple[int, int]:
    """Return the scene frames of the first and last keys of a player's value; without keys, the current frame."""
    curve = _curve(player, morph_value(player))
    if curve is None:
        now = bpy.context.scene.frame_current
        return now, now
    first, last = curve.range()
    return round(first), round(last)


def _curve(player: bpy.types.Object, value: NodeInput) -> bpy.types.FCurve | None:
    return next((curve for curve in curves_of(player) if curve.data_path == value.data_path), None)


def _written(player: bpy.types.Object, value: NodeInput, points: Sequence[Sequence[float]]) -> bpy.types.FCurve:
    """Return the curve of a value, with keys only at points, (n, 2)."""
    value.owner.keyframe_insert(value.path, frame=points[0][0])
    curve = _curve(player, value)
    curve.keyframe_points.clear()
    curve.keyframe_points.add(len(points))
    curve.keyframe_points.foreach_set("co", np.asarray(points, np.float32).ravel())
    return curve
