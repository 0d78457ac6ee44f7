# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.grids.divergence import divergence_free
from convwass_addon.geometry.grids.field_extension import extended
from convwass_addon.geometry.grids.solid_cells import SolidCells
from convwass_addon.geometry.grids.step_flow import StepFlow
from convwass_addon.progress import Control

SHAPE = (32, 32, 32)
CENTERS = np.moveaxis(np.indices(SHAPE), 0, -1) + 0.5 - 16.0


def ball(radius=9.0):
    return np.clip(radius + 0.5 - np.linalg.norm(CENTERS, axis=-1), 0.0, 1.0)


def volume_after(mass, field):
    flow = StepFlow(SHAPE)
    flow.add(field)
    return flow.carried(mass).sum()


@pytest.mark.parametrize(
    "flow",
    [
        lambda x: np.broadcast_to((0.5, 0.2, -0.1), x.shape),
        lambda x: np.cross((0.05, -0.1, 0.02), x),
        lambda x: 0.05 * x * (1.0, 1.0, -2.0),
    ],
    ids=["translation", "rotation", "shear"],
)
def test_divergence_free_fields_are_unchanged(flow):
    solid = SolidCells.of(ball(), 0.1)
    displacements = solid.gathered(flow(CENTERS))
    np.testing.assert_allclose(divergence_free(solid, displacements, Control()), displacements, atol=1e-12)


def test_gradient_fields_are_removed():
    solid = SolidCells.of(ball(), 0.1)
    pressed = solid.gathered(-0.1 * CENTERS)
    left = divergence_free(solid, pressed, Control())
    # The pressure is the squared distance; the remainder is due to the rough surface of the cells.
    assert np.linalg.norm(left, axis=1).mean() < 0.1 * np.linalg.norm(pressed, axis=1).mean()


@pytest.mark.parametrize("stretch", [(0.08, 0.0, 0.0), (-0.05, 0.03, -0.06)])
def test_a_ball_keeps_its_volume(stretch):
    mass = ball()
    solid = SolidCells.of(mass, 0.1)
    stretched = solid.gathered(CENTERS * stretch + 0.05 * np.sin(CENTERS / 4.0))
    before = volume_after(mass, extended(solid.scattered(stretched), mass)) / mass.sum()
    kept = divergence_free(solid, stretched, Control())
    after = volume_after(mass, extended(solid.scattered(kept), mass)) / mass.sum()
    assert abs(before - 1.0) > 0.04
    assert abs(after - 1.0) < 0.01
