# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.grids.grid_sampling import sampled
from convwass_addon.geometry.grids.step_flow import StepFlow
from convwass_addon.progress import Control

RANDOM = np.random.default_rng(2)
SHAPE = (24, 20, 22)


def wild_flow(rounds=6):
    """Steps that rotate, compress and fold as much as a step may."""
    flow = StepFlow(SHAPE)
    for _ in range(rounds):
        noise = np.stack([gaussian_filter(RANDOM.normal(size=SHAPE), 2.0) for _ in range(3)], axis=-1)
        flow.add(60.0 * noise)
    return flow


def ball(center, radius):
    cells = np.moveaxis(np.indices(SHAPE), 0, -1) + 0.5
    return np.clip(radius + 0.5 - np.linalg.norm(cells - center, axis=-1), 0.0, 1.0)


def test_the_inverse_undoes_the_flow():
    flow = wild_flow()
    points = RANDOM.uniform(-2.0, 26.0, (2000, 3))
    there = flow.moved(points)
    assert np.linalg.norm(there - points, axis=1).mean() > 1.0
    assert np.abs(flow.moved_back(there) - points).max() < 1e-3
    assert np.abs(flow.moved(flow.moved_back(points)) - points).max() < 1e-3


def test_uniform_steps_are_translations():
    flow = StepFlow(SHAPE)
    for step in ((1.0, 0.5, -0.25), (0.5, 1.0, 0.0)):
        flow.add(np.broadcast_to(step, (*SHAPE, 3)))
    points = RANDOM.uniform(0.0, 20.0, (50, 3))
    np.testing.assert_allclose(flow.moved(points), points + np.array([1.5, 1.5, -0.25]), atol=1e-12)


def test_fields_are_carried_along():
    flow = StepFlow(SHAPE)
    for _ in range(2):
        flow.add(np.broadcast_to((1.0, -1.0, 1.0), (*SHAPE, 3)))
    carried = flow.carried(ball((10.0, 10.0, 10.0), 5.0))
    np.testing.assert_allclose(carried, ball((12.0, 8.0, 12.0), 5.0), atol=1e-9)


def test_carried_fields_agree_with_the_inverse():
    flow = wild_flow(4)
    field = gaussian_filter(RANDOM.normal(size=SHAPE), 3.0)
    cells = np.moveaxis(np.indices(SHAPE), 0, -1)[6:-6, 6:-6, 6:-6].reshape(-1, 3)
    exact = sampled(field[..., None], flow.moved_back(cells + 0.5))[:, 0]
    found = flow.carried(field)[tuple(cells.T)]
    assert np.abs(found - exact).max() < 0.15 * np.abs(field).max()


def test_steps_are_limited_to_be_invertible():
    flow = StepFlow(SHAPE)
    flow.add(RANDOM.normal(size=(*SHAPE, 3)) * 50.0)
    assert max(np.linalg.norm(np.diff(flow.steps[0], axis=a), axis=-1).max() for a in range(3)) <= 0.5 + 1e-12


def test_it_can_be_cancelled():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        wild_flow(1).moved_back(np.zeros((1, 3)), control)
