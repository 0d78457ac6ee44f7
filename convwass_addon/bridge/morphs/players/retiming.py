# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Timings of a player as keys of its value, and the resulting speed for motion blur."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ....errors import InputError
from ....schema import Choice, Settings, setting
from ...animation_time import returning, show_time, time_of_frame
from ...keyframes import (
    changing_span,
    curves_of,
    driver_targets,
    is_driven,
    is_tweaked,
    key_span,
    scene_span,
    set_keys,
    strips_span,
)
from ...nodes.node_inputs import NodeInput
from ...visibility import hidden_modifiers
from .player import pace
from .player_inputs import last_value, morph_value, playback_item, shown_value, speed

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
    easing: str = "AUTO"


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
    """Replace the keys of a player's value, starting where it was animated, or else at the current frame.

    Returns
    -------
    range
        Scene frames of the first and the last key.

    Raises
    ------
    InputError
        The value is driven, or its curve is locked or muted.
    """
    value = morph_value(player)
    if is_driven(player, value.data_path):
        raise InputError(
            "The value of {name} has a driver, which keys would not change; delete the driver first.", name=player.name
        )
    curve = value.curve()
    if curve is not None and curve.lock:
        raise InputError(
            "The keys of the value of {name} are locked; unlock its curve in the Graph Editor first.", name=player.name
        )
    if curve is not None and curve.mute:
        raise InputError(
            "The keys of the value of {name} are muted, so they have no effect; unmute its curve in the Graph Editor "
            "first.",
            name=player.name,
        )
    start = keyed_span(player)[0] if curve is None else curve.range()[0]
    keys = keys_of(timing, start, last_value(player) + 1, float(value.get()))
    curve = _keyed_curve(value, keys[0].frame)
    set_keys(curve, [(key.frame, key.value) for key in keys])
    for point, key in zip(curve.keyframe_points, keys, strict=True):
        point.interpolation, point.easing = key.interpolation, key.easing
    curve.update()
    key_speed(player)
    return range(round(keys[0].frame), round(keys[-1].frame) + 1)


def key_speed(player: bpy.types.Object) -> None:
    """Key the speed of a player from the change of its value, which may also be driven or in NLA strips.

    The speed at a frame is the difference of the value half a frame before and after it, and 0 beyond the ends unless
    they repeat; it is negative on the way back. Nothing is keyed if the value is not animated.
    """
    target = speed(player)
    if target is None:
        return
    span, curve = _span(player), sole_curve(player)
    if not span:
        return
    if curve is not None:
        span = changing_span([curve], bpy.context.scene)
    frames = np.arange(span.start - 1, span.stop + 1)
    values = _values_at(player, np.append(frames - 0.5, span.stop + 0.5))
    item, last = playback_item(player), last_value(player)
    if item != "LOOP":
        # A loop jumps where it starts again, which is no motion.
        values = np.array([shown_value(value, item, last) for value in values])
    speeds = np.diff(values) / pace(player)
    set_keys(_keyed_curve(target, int(frames[0])), np.stack([frames, speeds], axis=1))


def keyed_span(player: bpy.types.Object) -> tuple[int, int]:
    """Return the scene frames between which a player's value is animated; the current frame if it is not.

    These are the frames of its first and last keys, or of the NLA strips that contain it. A driven value is animated
    where its driver's inputs have keys, or else in all frames of the scene.
    """
    span = _span(player)
    if span:
        return span[0], span[-1]
    scene = bpy.context.scene
    return 2 * (round(time_of_frame(scene, scene.frame_current)),)


def sole_curve(player: bpy.types.Object) -> bpy.types.FCurve | None:
    """Return the curve of a player's value if nothing else animates it, or None."""
    value, data = morph_value(player), player.animation_data
    if data is None or data.nla_tracks or is_driven(player, value.data_path):
        return None
    curve = value.curve()
    return None if curve is None or curve.mute else curve


def _span(player: bpy.types.Object) -> range:
    """Return the scene frames in which the value of a player is animated; empty if it is not."""
    value, scene = morph_value(player), bpy.context.scene
    if is_driven(player, value.data_path):
        inputs = [target.id for target in driver_targets(player) if target.id is not None]
        return key_span(curve for block in inputs for curve in curves_of(block)) or scene_span(scene)
    # In tweak mode, keys are at the times of their strip.
    curve = None if is_tweaked(player) else value.curve()
    return key_span([] if curve is None else [curve]) or strips_span([player], value.data_path)


def _values_at(player: bpy.types.Object, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the value of a player at some times, (n,)."""
    value, curve, scene = morph_value(player), sole_curve(player), bpy.context.scene
    if curve is not None:
        return np.array([curve.evaluate(time) for time in times])
    found = []
    # Nothing of what the modifier shows is needed.
    with hidden_modifiers([value.modifier]), returning(scene):
        for time in times:
            show_time(scene, float(time))
            found.append(value.get())
    return np.array(found, dtype=np.float64)


def _keyed_curve(value: NodeInput, frame: float) -> bpy.types.FCurve:
    """Return the curve of a value, created with a key at a frame if there is none."""
    value.owner.keyframe_insert(value.path, frame=frame)
    return value.curve()
