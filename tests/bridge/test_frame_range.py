# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scene plays after an animation was made."""

from __future__ import annotations

import pytest

from convwass_addon.bridge.frame_range import play_among_others, play_whole


@pytest.fixture
def previewed_scene(bare_scene):
    """A scene of which the frames 30 to 40 are played, by its preview range."""
    bare_scene.frame_start, bare_scene.frame_end = 10, 50
    bare_scene.use_preview_range = True
    bare_scene.frame_preview_start, bare_scene.frame_preview_end = 30, 40
    return bare_scene


def ranges(scene):
    """Return the frame range, and the preview range if it is on."""
    preview = (scene.frame_preview_start, scene.frame_preview_end) if scene.use_preview_range else None
    return (scene.frame_start, scene.frame_end), preview


def test_a_morph_is_played_whole_in_place_of_the_preview_range(previewed_scene):
    play_whole(previewed_scene, 100, 123)
    assert ranges(previewed_scene) == ((100, 123), None)
    previewed_scene.use_preview_range = True
    assert ranges(previewed_scene)[1] == (30, 40)


def test_a_morph_that_begins_before_0_is_played_by_the_preview_range(previewed_scene):
    play_whole(previewed_scene, -10, 13)
    assert ranges(previewed_scene) == ((0, 13), (-10, 13))
    play_whole(previewed_scene, -10, -3)
    assert ranges(previewed_scene)[1] == (-10, -3)


def test_what_is_added_to_others_leaves_the_preview_range(previewed_scene):
    play_among_others(previewed_scene, 5, 20)
    assert ranges(previewed_scene) == ((5, 50), (30, 40))
