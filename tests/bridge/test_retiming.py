# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Timings of a player, the speed that follows from them, and frames of any frame rate."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.keyframes import curves_of, interpolate, shown_during
from convwass_addon.bridge.morphs.players.dense_bake import bake_player, sample_times
from convwass_addon.bridge.morphs.players.player import make_player
from convwass_addon.bridge.morphs.players.player_inputs import morph_value, speed
from convwass_addon.bridge.morphs.players.retiming import Retiming, key_speed, keyed_span, keys_of, retime
from convwass_addon.bridge.morphs.players.seen_frames import shows_as_baked
from convwass_addon.bridge.morphs.stored import WEIGHTS_KEY, frame_objects
from convwass_addon.errors import InputError
from convwass_addon.progress import drained
from tests.moving_balls import FIRST, FRAMES, TRAVEL
from tests.scene import linked, world


def corners(timing, shapes=3, now=0.0):
    return [(key.frame, pytest.approx(key.value)) for key in keys_of(timing, 100.0, shapes, now)]


def test_keys_of_the_styles():
    assert corners(Retiming(style="LINEAR", frames=10)) == [(100, 0), (110, 1), (120, 2)]
    assert corners(Retiming(style="HOLD", frames=10, hold=5)) == [
        (100, 0), (105, 0), (115, 1), (120, 1), (130, 2), (135, 2)
    ]  # fmt: skip
    assert corners(Retiming(style="BACK_AND_FORTH", frames=10), 2) == [(100, 0), (110, 1), (120, 0)]
    slow = corners(Retiming(style="SLOW_MOTION", frames=10, slowness=10.0), now=0.5)
    assert slow == [(100, 0), (103.5, 0.35), (pytest.approx(133.5), 0.65), (pytest.approx(147.0), 2)]
    # About an end there is nothing before it.
    assert corners(Retiming(style="SLOW_MOTION", frames=10), now=2.0)[-1] == (pytest.approx(133.5), 2)


def values(player, frames):
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(int(np.floor(frame)), subframe=float(frame % 1.0))
        found.append((morph_value(player).get(), speed(player).get() if speed(player) else None))
    return np.array(found, dtype=float)


def test_slow_motion_has_the_chosen_speed(player):
    morph_value(player).set(0.5)
    player.animation_data.action = None
    bpy.context.scene.frame_set(FIRST)
    span = retime(player, Retiming(style="SLOW_MOTION", frames=20, slowness=10.0))
    assert span == range(FIRST, FIRST + 75)
    assert keyed_span(player) == (FIRST, FIRST + 74)
    before, slow, after, over = values(player, [FIRST + 3, FIRST + 37, FIRST + 71, FIRST + 80])
    assert np.allclose(before, (3 / 20, FRAMES / 20), atol=1e-4)
    assert np.allclose(slow, (0.5, FRAMES / 200), atol=1e-3)
    assert np.isclose(after[1], FRAMES / 20, atol=1e-4)
    assert np.allclose(over, (1.0, 0.0))


def test_easing_and_edited_keys_have_their_speed(player):
    retime(player, Retiming(style="EASE", frames=24))
    middle = values(player, [FIRST + 12])[0]
    assert np.allclose(middle, (0.5, np.pi / 2.0 * FRAMES / 24), rtol=1e-2)
    player.animation_data.action.layers[0].strips[0].channelbags[0].fcurves[0].keyframe_points[1].co.x += 24
    key_speed(player)
    assert np.allclose(values(player, [FIRST + 24])[0], (0.5, np.pi / 2.0 * FRAMES / 48), rtol=1e-2)


def test_the_speed_goes_on_where_a_modifier_repeats_the_keys(player):
    retime(player, Retiming(style="BACK_AND_FORTH", frames=12))
    bpy.context.scene.frame_end = FIRST + 24 * 4
    once = values(player, FIRST + np.arange(1, 24))
    curves_of(player)[0].modifiers.new("CYCLES")
    key_speed(player)
    assert np.allclose(values(player, FIRST + np.arange(1, 24)), once, atol=1e-5)
    assert np.allclose(values(player, FIRST + 48 + np.arange(1, 24)), once, atol=1e-4)


@pytest.mark.parametrize(("playback", "back"), [("ONCE", 0), ("LOOP", 1), ("PING_PONG", -1)])
def test_the_speed_is_that_of_the_playback(moving, playback, back):
    player = make_player(moving, playback=playback, between="INTERPOLATED")
    bpy.context.scene.frame_end = FIRST + 40
    key_speed(player)
    assert np.allclose(values(player, FIRST + FRAMES * np.arange(4) + 1)[:, 1], [1, back, back**2, back], atol=1e-4)
    retime(player, Retiming(style="LINEAR", frames=10))
    wanted = np.array([1, back, back**2, back]) * FRAMES / 10
    assert np.allclose(values(player, FIRST + 10 * np.arange(4) + 5)[:, 1], wanted, atol=1e-4)
    if playback == "PING_PONG":
        assert np.allclose(values(player, FIRST + np.arange(10, 40, 10))[:, 1], 0.0, atol=1e-4)


def test_a_single_key_has_the_speed_of_its_modifier_and_else_none(player):
    retime(player, Retiming(style="EASE", frames=24))
    (curve,) = (own for own in curves_of(player) if own.data_path == morph_value(player).data_path)
    while len(curve.keyframe_points) > 1:
        curve.keyframe_points.remove(curve.keyframe_points[-1])
    key_speed(player)
    assert np.allclose(values(player, FIRST + np.arange(24))[:, 1], 0.0)
    bpy.context.scene.frame_end = FIRST + 24
    ramp = curve.modifiers.new("GENERATOR")
    ramp.use_additive, ramp.coefficients[0], ramp.coefficients[1] = True, -FIRST / 48, 1 / 48
    key_speed(player)
    assert np.allclose(values(player, FIRST + np.arange(2, 23))[:, 1], FRAMES / 48, rtol=1e-3)


def push_down(obj, start, scale):
    """Move the action of an object to a strip of its own."""
    data = obj.animation_data
    action, slot = data.action, data.action_slot
    strip = data.nla_tracks.new().strips.new("Strip", start, action)
    strip.action_slot, strip.scale = slot, scale
    data.action = None


def frames_of(player):
    """Weights of the last shape in the frames that are made of a player."""
    first, last = keyed_span(player)
    morph = drained(bake_player(player, range(first, last + 1), first))
    return [obj[WEIGHTS_KEY][1] for obj in frame_objects(morph)]


def test_strips_are_as_good_as_keys(player):
    push_down(player, 20, 2.0)
    assert keyed_span(player) == (20, 20 + 2 * FRAMES)
    assert not shows_as_baked(player)
    key_speed(player)
    assert player.modifiers[0].show_viewport
    assert np.allclose(values(player, [20 + FRAMES])[0], (0.5, 0.5), atol=1e-4)
    assert np.allclose(frames_of(player), np.arange(2 * FRAMES + 1) / (2 * FRAMES), atol=1e-5)
    # New keys are above the strips.
    assert retime(player, Retiming(style="LINEAR", frames=10)) == range(20, 31)
    assert np.allclose(values(player, [25])[0], (0.5, FRAMES / 10), atol=1e-4)


def test_a_driven_player_plays_its_driver(player):
    player.animation_data_clear()
    value = morph_value(player)
    slider = bpy.data.objects.new("Slider", None)
    bpy.context.scene.collection.objects.link(slider)
    driver = value.owner.driver_add(value.path).driver
    driver.type = "AVERAGE"
    target = driver.variables.new().targets[0]
    target.id, target.data_path = slider, '["amount"]'
    slider["amount"] = 0.0
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 3, 7
    assert keyed_span(player) == (3, 7)
    for frame in (10, 20):
        slider["amount"] = (frame - 10) / 10
        slider.keyframe_insert('["amount"]', frame=frame)
    interpolate(curves_of(slider))
    assert keyed_span(player) == (10, 20)
    key_speed(player)
    assert np.allclose(values(player, [15])[0], (0.5, FRAMES / 10), atol=1e-4)
    assert np.allclose(frames_of(player), np.arange(11) / 10, atol=1e-5)
    with pytest.raises(InputError, match="has a driver, which keys would not change"):
        retime(player, Retiming())


def test_locked_keys_are_not_replaced(moving):
    player = make_player(moving, between="NEAREST")
    (curve,) = curves_of(player)
    curve.lock = True
    with pytest.raises(InputError, match="are locked; unlock its curve"):
        retime(player, Retiming())
    assert [tuple(point.co) for point in curve.keyframe_points] == [(FIRST, 0), (FIRST + FRAMES, 1)]


def test_muted_keys_are_named_and_give_no_speed(player):
    curve = next(own for own in curves_of(player) if own.data_path == morph_value(player).data_path)
    curve.mute = True
    with pytest.raises(InputError, match="are muted, so they have no effect; unmute its curve"):
        retime(player, Retiming())
    assert len(curve.keyframe_points) == 2
    key_speed(player)
    assert not values(player, FIRST + np.arange(FRAMES))[:, 1].any()
    assert not shows_as_baked(player)


def test_a_player_of_baked_blends_has_keys_only(moving):
    player = make_player(moving, between="NEAREST")
    retime(player, Retiming(style="BOUNCE", frames=12))
    found = values(player, FIRST + np.arange(13))[:, 0]
    assert (found[0], found[-1]) == (0.0, 1.0)
    assert (np.diff(found) < 0).any()
    assert found.max() <= 1.0


def test_samples_of_a_frame_rate():
    assert np.allclose(sample_times(10, 12, 24, 60), [10, 10.4, 10.8, 11.2, 11.6, 12])
    assert np.allclose(sample_times(10, 13, 24, 12), [10, 12])


def test_frames_at_another_rate(player):
    times = sample_times(FIRST, FIRST + FRAMES, 24, 48)
    morph = drained(bake_player(player, times, FIRST))
    frames = frame_objects(morph)
    assert len(frames) == 2 * FRAMES + 1
    assert player.hide_render
    for number, obj in enumerate(frames):
        middle = np.mean([vertex.co for vertex in obj.data.vertices], axis=0)
        assert np.allclose(middle, (TRAVEL * number / (2 * FRAMES), 0, 0), atol=0.02)
        assert np.isclose(obj[WEIGHTS_KEY][1], number / (2 * FRAMES), atol=1e-5)
        assert shown_during(obj, range(FIRST, FIRST + len(frames))).count(True) == 1


@pytest.mark.parametrize("style", ["EASE", "HOLD", "BACK_AND_FORTH"])
def test_a_player_of_frames_of_a_player_has_their_timing(player, style):
    retime(player, Retiming(style=style, frames=6, hold=2))
    first, last = keyed_span(player)
    times = range(first, last + 1)
    morph = drained(bake_player(player, times, first))
    expected = [obj[WEIGHTS_KEY][1] for obj in frame_objects(morph)]
    if style == "BACK_AND_FORTH":
        with pytest.raises(InputError, match="returns to moments that it has left"):
            make_player(morph, between="INTERPOLATED")
    second = make_player(morph, between="NEAREST" if style == "BACK_AND_FORTH" else "INTERPOLATED")
    assert np.allclose(values(second, times)[:, 0], expected, atol=1e-5)
    assert shows_as_baked(second)


def test_frames_of_a_sheared_player_keep_its_shape(player):
    """A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give."""
    parent = linked("Stretch", None)
    parent.scale.x, parent.location.z = 3.0, 5.0
    player.parent, player.rotation_euler.y = parent, 0.6
    times, shown = [FIRST, FIRST + 2], []
    for time in times:
        bpy.context.scene.frame_set(time)
        shown.append(world(player))
    morph = drained(bake_player(player, times, FIRST))
    for obj, expected in zip(frame_objects(morph), shown, strict=True):
        assert np.allclose(world(obj), expected, atol=1e-5)
