# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyframes: visibility of objects, and interpolation of values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import bpy
from bpy_extras.anim_utils import action_get_channelbag_for_slot
from numpy.typing import ArrayLike

from .animation_time import time_of_frame
from .element_values import element_values, write_floats
from .unused_data import remove_if_unused

VISIBILITY_PATHS = ("hide_viewport", "hide_render")

EASINGS = {"LINEAR": "LINEAR", "SMOOTH": "SINE"}
"""Blender's interpolation for each kind of easing."""


@dataclass(frozen=True)
class FrameRange:
    """Scene frames from `first` to `last`, both included; None for unlimited."""

    first: int | None
    last: int | None


def driver_targets(block: bpy.types.ID | None) -> list[bpy.types.DriverTarget]:
    """Return what the drivers of a data-block read; nothing without a data-block."""
    return [target for variable in driver_variables(block) for target in variable.targets]


def driver_variables(block: bpy.types.ID | None) -> list[bpy.types.DriverVariable]:
    """Return the variables of the drivers of a data-block; none without a data-block."""
    return [variable for curve in drivers_of(block) for variable in curve.driver.variables]


def key_visibility(obj: bpy.types.Object, action: bpy.types.Action, shown: Sequence[FrameRange]) -> None:
    """Show an object in viewport and render only in the given frames.

    Keys are set where visibility changes, and hold until the next one. Existing visibility keys of the object are
    replaced.

    Parameters
    ----------
    obj : bpy.types.Object
        The object to show.
    action : bpy.types.Action
        Receives the keys in a slot of the object, so that a whole morph can share one action.
    shown : sequence of FrameRange
        Ascending, with gaps of at least one frame.
    """
    bag = _channels(obj, action)
    keys = _keys(shown)
    for path in VISIBILITY_PATHS:
        old = bag.fcurves.find(path)
        if old:
            bag.fcurves.remove(old)
        _hold(bag.fcurves.new(path), keys)


def key_scale(obj: bpy.types.Object, action: bpy.types.Action, axis: int, keys: list[tuple[float, float]]) -> None:
    """Key the scale of an object along an axis, which has no keys yet, by (frame, value), each held until the next."""
    _hold(_channels(obj, action).fcurves.new("scale", index=axis), keys)


def shown_during(obj: bpy.types.Object, frames: Iterable[float]) -> list[bool]:
    """Return whether an object is rendered at each of some scene frames, by its keys or else by its current setting."""
    curve = _render_curve(obj)
    if curve and not curve.mute:
        return [curve.evaluate(frame) < 0.5 for frame in frames]
    return [not obj.hide_render for _ in frames]


def shown_from(obj: bpy.types.Object) -> float | None:
    """Return the time of the first key that shows an object in renders, or None."""
    curve = _render_curve(obj)
    return next((point.co.x for point in curve.keyframe_points if point.co.y < 0.5), None) if curve else None


def _render_curve(obj: bpy.types.Object) -> bpy.types.FCurve | None:
    """Return the keys of whether an object is hidden in renders, or None."""
    return next(iter(curves_of(obj, "hide_render")), None)


def take_key_times(before: bpy.types.Object, after: bpy.types.Object) -> None:
    """Move the visibility keys of an object to where another one has as many of them."""
    old, new = channels_of(before), channels_of(after)
    for path in VISIBILITY_PATHS if old and new else ():
        theirs, own = old.fcurves.find(path), new.fcurves.find(path)
        if theirs and own and len(theirs.keyframe_points) == len(own.keyframe_points):
            write_floats(own.keyframe_points, "co", element_values(theirs.keyframe_points, "co", 2))
            own.update()


def keyed_frames(objects: Iterable[bpy.types.Object]) -> range:
    """Return the scene frames from the first to the last visibility key of some objects, or NLA strip with such keys.

    Empty without any.
    """
    objects = list(objects)
    # In tweak mode, keys are at the times of their strip.
    keyed = [obj for obj in objects if not is_tweaked(obj)]
    keys = key_span(curve for obj in keyed for path in VISIBILITY_PATHS for curve in curves_of(obj, path))
    spans = [span for span in (keys, *(strips_span(objects, path) for path in VISIBILITY_PATHS)) if span]
    return range(min(span.start for span in spans), max(span.stop for span in spans)) if spans else range(0)


def key_span(curves: Iterable[bpy.types.FCurve]) -> range:
    """Return the scene frames from the first to the last key of some curves; empty without keys."""
    spans = [curve.range() for curve in curves if len(curve.keyframe_points)]
    if not spans:
        return range(0)
    return range(round(min(span[0] for span in spans)), round(max(span[1] for span in spans)) + 1)


def changing_span(curves: Iterable[bpy.types.FCurve], scene: bpy.types.Scene) -> range:
    """Return the times from the first to the last key of some curves; of the whole scene if modifiers go on there."""
    curves = list(curves)
    if not any(modifier.active and not modifier.mute for curve in curves for modifier in curve.modifiers):
        return key_span(curves)
    return scene_span(scene, curves)


def scene_span(scene: bpy.types.Scene, curves: Iterable[bpy.types.FCurve] = ()) -> range:
    """Return the times from the first frame of a scene, or key of some curves before it, to the last."""
    first, last = (round(time_of_frame(scene, frame)) for frame in (scene.frame_start, scene.frame_end))
    keyed = key_span(curves) or range(first, last + 1)
    return range(min(keyed.start, first), max(keyed.stop, last + 1))


def channels_of(block: bpy.types.ID) -> bpy.types.ActionChannelbag | None:
    """Return what holds the F-curves of a data-block, or of a node tree; None if there are none."""
    data = block.animation_data
    return action_get_channelbag_for_slot(data.action, data.action_slot) if data and data.action else None


def curves_of(block: bpy.types.ID, path: str | None = None) -> list[bpy.types.FCurve]:
    """Return the F-curves of a data-block, or of a node tree; all of them, or those of one property."""
    bag = channels_of(block)
    return [] if bag is None else [curve for curve in bag.fcurves if path in (None, curve.data_path)]


def drivers_of(block: bpy.types.ID | None) -> list[bpy.types.FCurve]:
    """Return the drivers of a data-block, or of a node tree; none without a data-block, or if it cannot have any."""
    data = getattr(block, "animation_data", None)
    return [] if data is None else list(data.drivers)


def has_animation(block: bpy.types.ID) -> bool:
    """Return whether a data-block, or a node tree, has an action, drivers or NLA tracks."""
    data = getattr(block, "animation_data", None)
    return data is not None and (data.action is not None or bool(data.drivers) or bool(data.nla_tracks))


def is_driven(block: bpy.types.ID, path: str) -> bool:
    """Return whether a property of a data-block has a driver."""
    return any(curve.data_path == path for curve in drivers_of(block))


def is_animated_property(block: bpy.types.ID, path: str) -> bool:
    """Return whether a driver, keyframes or NLA strips that are not muted set a property of a data-block."""
    curves = (*curves_of(block, path), *(curve for curve in drivers_of(block) if curve.data_path == path))
    return not all(curve.mute for curve in curves) or bool(strips_span([block], path))


def is_tweaked(block: bpy.types.ID) -> bool:
    """Return whether the action of an NLA strip of a data-block is edited, in tweak mode."""
    data = block.animation_data
    return data is not None and data.use_tweak_mode


def strips_span(blocks: Iterable[bpy.types.ID], path: str | None = None) -> range:
    """Return the scene frames from the first to the last NLA strip of some data-blocks; empty without strips.

    Parameters
    ----------
    blocks : iterable of bpy.types.ID
        Objects and other data.
    path : str, optional
        The property that the strips animate; any by default.
    """
    there = [data for block in blocks if (data := block.animation_data) is not None]
    tracks = [track for data in there for track in data.nla_tracks if not track.mute]
    found = [strip for track in tracks for strip in _strips(track.strips) if _animates(strip, path)]
    if not found:
        return range(0)
    return range(round(min(one.frame_start for one in found)), round(max(one.frame_end for one in found)) + 1)


def _strips(strips: Iterable[bpy.types.NlaStrip]) -> Iterator[bpy.types.NlaStrip]:
    """Yield strips and those inside of them."""
    for strip in strips:
        if not strip.mute:
            yield strip
            yield from _strips(strip.strips)


def _animates(strip: bpy.types.NlaStrip, path: str | None) -> bool:
    bag = None if strip.action is None else action_get_channelbag_for_slot(strip.action, strip.action_slot)
    return bag is not None and any(path in (None, curve.data_path) for curve in bag.fcurves)


def remove_curve(block: bpy.types.ID, path: str) -> None:
    """Remove the keyframes of a property of a data-block, if it has any."""
    bag = channels_of(block)
    for curve in curves_of(block, path):
        bag.fcurves.remove(curve)


def own_action(block: bpy.types.ID) -> None:
    """Give a data-block an action of its own if it shares its keyframes, as linked duplicates and copies do."""
    data = block.animation_data
    if data and data.action and data.action_slot and len(data.action_slot.users()) > 1:
        _copy_action(data, data.action, data.action_slot.identifier)


def ensure_action(block: bpy.types.ID) -> None:
    """Give a data-block without an action a new one.

    Without it, Blender inserts the keys of an object into the action of its mesh, shape keys or materials, if they have
    one.
    """
    data = block.animation_data
    if data is None or data.action is None:
        use_action(block, bpy.data.actions.new(f"{block.name}Action"))


def use_action(block: bpy.types.ID, action: bpy.types.Action) -> None:
    """Let an action animate a data-block, with a new slot for it."""
    data = block.animation_data_create()
    data.action, data.action_slot = action, action.slots.new(block.id_type, block.name)


def take_animation(block: bpy.types.ID, source: bpy.types.ID, paths: Sequence[str]) -> None:
    """Give a data-block without animation copies of the keyframes and drivers of another one, for some properties.

    Strips of the NLA are left out, and so are keyframes that are edited inside of one, at the times of the strip.

    Parameters
    ----------
    block, source : bpy.types.ID
        Data-blocks of the same type.
    paths : sequence of str
        With what the data paths of these properties begin.
    """
    data, taken = source.animation_data, tuple(paths)
    if data is None:
        return
    if not is_tweaked(source) and any(curve.data_path.startswith(taken) for curve in curves_of(source)):
        _take_curves(block, data, taken)
    for curve in [own for own in data.drivers if own.data_path.startswith(taken)]:
        own = block.animation_data or block.animation_data_create()
        own.drivers.from_existing(src_driver=curve)


def _take_curves(block: bpy.types.ID, data: bpy.types.AnimData, taken: tuple[str, ...]) -> None:
    """Give a data-block a copy of an action, in which only curves remain whose data paths begin in some way."""
    _copy_action(block.animation_data_create(), data.action, data.action_slot.identifier)
    bag = channels_of(block)
    for curve in [curve for curve in bag.fcurves if not curve.data_path.startswith(taken)]:
        bag.fcurves.remove(curve)
    for group in [group for group in bag.groups if not len(group.channels)]:
        bag.groups.remove(group)


def _copy_action(data: bpy.types.AnimData, action: bpy.types.Action, slot: str) -> None:
    """Assign a copy of an action that has only one of its slots, given by its identifier."""
    data.action = action.copy()
    data.action_slot = data.action.slots[slot]
    for other in [own for own in data.action.slots if own != data.action_slot]:
        data.action.slots.remove(other)


def clear_animation(block: bpy.types.ID) -> None:
    """Remove the keyframes and drivers of a data-block, and its action unless something else uses it."""
    action = None if block.animation_data is None else block.animation_data.action
    block.animation_data_clear()
    remove_if_unused([action])


def interpolate(curves: Iterable[bpy.types.FCurve], how: str = "LINEAR") -> None:
    """Set the interpolation of all keys of some curves, regardless of the user's default."""
    for curve in curves:
        for point in curve.keyframe_points:
            point.interpolation = how
        curve.update()


def ease(curve: bpy.types.FCurve, easing: str) -> None:
    """Set the interpolation of all keys of a curve to a kind of `EASINGS`."""
    for point in curve.keyframe_points:
        point.easing = "EASE_IN_OUT"
    interpolate([curve], EASINGS[easing])


def repeat(curve: bpy.types.FCurve) -> None:
    """Repeat the keys of a curve before and after them, each time from the value at which the last time ended."""
    modifier = curve.modifiers.new("CYCLES")
    modifier.mode_before = modifier.mode_after = "REPEAT_OFFSET"


def set_keys(curve: bpy.types.FCurve, keys: ArrayLike, how: str = "LINEAR") -> None:
    """Replace the keys of a curve by frames and values, (n, 2)."""
    points = curve.keyframe_points
    points.clear()
    points.add(len(keys))
    write_floats(points, "co", keys)
    interpolate([curve], how)


def _channels(obj: bpy.types.Object, action: bpy.types.Action) -> bpy.types.ActionChannelbag:
    """Return the object's channels in the action, assigned and created as needed."""
    data = obj.animation_data_create()
    if data.action != action or data.action_slot is None:
        use_action(obj, action)
    layer = action.layers[0] if action.layers else action.layers.new("Visibility")
    strip = layer.strips[0] if layer.strips else layer.strips.new(type="KEYFRAME")
    return strip.channelbag(data.action_slot, ensure=True)


def _keys(shown: Sequence[FrameRange]) -> list[tuple[float, float]]:
    """Return frames and values (1 is hidden); each value holds until the next key."""
    keys = []
    for span in shown:
        if span.first is not None:
            # The first key's value also holds before it, so hiding earlier frames needs an extra key.
            if not keys:
                keys.append((span.first - 1, 1.0))
            keys.append((span.first, 0.0))
        if span.last is not None:
            if not keys:
                keys.append((span.last, 0.0))
            keys.append((span.last + 1, 1.0))
    return keys or [(0, 0.0 if shown else 1.0)]


def _hold(curve: bpy.types.FCurve, keys: list[tuple[float, float]]) -> None:
    """Set the keys of a curve, each held until the next."""
    curve.extrapolation = "CONSTANT"
    set_keys(curve, keys, "CONSTANT")
