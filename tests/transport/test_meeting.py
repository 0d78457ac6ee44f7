# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.progress import Control
from convwass_addon.transport import Grid
from convwass_addon.transport.meeting import meeting

SHAPE = (24, 16, 16)


def ball(center, radius=3.5):
    cells = np.moveaxis(np.indices(SHAPE), 0, -1) + 0.5
    return np.clip(radius + 0.5 - np.linalg.norm(cells - center, axis=-1), 0.0, 1.0)


def test_equal_shapes_are_unchanged():
    solid = ball((12.0, 8.0, 8.0)) + ball((16.0, 8.0, 8.0), 2.0)
    found = meeting(solid, solid, Grid(SHAPE, 1.5), 8.0, Control())
    assert np.abs(found.displacements[:, solid > 0.5]).max() < 0.05


def test_equal_balls_meet_in_the_middle():
    first, second = ball((9.0, 8.0, 8.0)), ball((15.0, 8.0, 8.0))
    there, back = meeting(first, second, Grid(SHAPE, 1.5), 30.0, Control()).displacements
    np.testing.assert_allclose(there[first > 0.5], np.broadcast_to((3.0, 0.0, 0.0), there[first > 0.5].shape), atol=0.2)
    np.testing.assert_allclose(back[second > 0.5], -there[first > 0.5], atol=0.2)


def test_distant_parts_fade_instead():
    pole = ball((4.0, 8.0, 8.0))
    first, second = pole + ball((19.0, 8.0, 8.0), 2.5), pole
    found = meeting(first, second, Grid(SHAPE, 1.5), 2.0, Control()).displacements[0]
    assert np.abs(found[pole > 0.5]).max() < 0.1


def test_the_start_changes_the_result_little():
    first, second = ball((9.0, 8.0, 8.0)), ball((14.0, 9.0, 8.0), 4.0)
    grid = Grid(SHAPE, 1.5)
    before = meeting(ball((9.5, 8.0, 8.0)), second, grid, 10.0, Control())
    cold, warm = (meeting(first, second, grid, 10.0, Control(), start) for start in (None, before.solved))
    inside = first > 0.5
    np.testing.assert_allclose(warm.displacements[0][inside], cold.displacements[0][inside], atol=0.1)


def test_it_can_be_cancelled():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        meeting(ball((9.0, 8.0, 8.0)), ball((15.0, 8.0, 8.0)), Grid(SHAPE, 1.5), 10.0, control)
