# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times of keys and frames of a scene with Time Stretching."""

from __future__ import annotations

from fractions import Fraction

import pytest

from convwass_addon.bridge.animation_time import frame_of_time, time_of_frame


@pytest.mark.parametrize("old", [100, 300, 7])
@pytest.mark.parametrize("new", [100, 150, 300, 49])
def test_what_is_whole_stays_whole(bare_scene, old, new):
    """Ranges of frames are rounded outwards, and the start of a morph upwards, so that an error would add a frame."""
    bare_scene.render.frame_map_old, bare_scene.render.frame_map_new = old, new
    for frame in range(400):
        assert time_of_frame(bare_scene, frame) == float(Fraction(frame * old, new))
        assert frame_of_time(bare_scene, frame) == float(Fraction(frame * new, old))
