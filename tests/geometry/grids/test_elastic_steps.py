# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.grids import elastic_steps
from convwass_addon.geometry.grids.elastic_steps import elastic_step
from convwass_addon.geometry.grids.solid_cells import SolidCells
from convwass_addon.progress import Control

RANDOM = np.random.default_rng(3)


def blob():
    """An irregular solid, and the centers of its cells."""
    cells = np.moveaxis(np.indices((9, 8, 7)), 0, -1) + 0.5
    mass = np.clip(4.0 - np.linalg.norm((cells - (4.0, 4.0, 3.5)) * (0.8, 1.0, 1.4), axis=-1), 0.0, 1.0)
    mass[4:6, 4:6, :] = 0.6
    solid = SolidCells.of(mass, 0.1)
    return solid, solid.gathered(cells)


def solved(solid, aims, trust, width=4.0):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(elastic_steps, "_RESIDUAL", 1e-12)
        return elastic_step(solid, aims, trust, width, Control())


@pytest.mark.parametrize("kind", ["translation", "rotation"])
@pytest.mark.parametrize("known", ["everywhere", "at four cells"])
def test_rigid_motions_cost_nothing(kind, known):
    solid, points = blob()
    aims = (
        np.broadcast_to((0.3, -0.7, 1.1), points.shape) if kind == "translation" else np.cross((0.1, 0.2, -0.3), points)
    )
    trust = solid.filled
    start = np.array(aims)
    if known != "everywhere":
        trust = np.zeros(len(solid))
        trust[[0, 17, 60, -1]] = 1e4
        start = np.where(trust[:, None] > 0, aims, 0.0)
    # Even without trust, cells have a small weight, so that components without data have a place.
    np.testing.assert_allclose(solved(solid, start, trust), aims, atol=1e-8 if known == "everywhere" else 0.02)


def test_the_energy_is_minimal():
    solid, points = blob()
    aims = RANDOM.normal(size=points.shape)
    width = 1.7
    distance = np.linalg.norm(points[:, None] - points, axis=-1)
    first, second = np.nonzero(np.triu((distance > 0) & (distance < 1.8)))
    edges = points[second] - points[first]

    def energy(step):
        near = np.square(step - aims).sum(axis=1) @ solid.filled
        length = np.linalg.norm(edges, axis=1)
        pressed = ((step[second] - step[first]) * edges).sum(axis=1) / length
        return near + width**2 * (np.minimum(solid.filled[first], solid.filled[second]) / length**2) @ pressed**2

    best = solved(solid, aims, solid.filled, width)
    for _ in range(20):
        nudge = RANDOM.normal(size=points.shape)
        assert abs(energy(best + 1e-3 * nudge) - energy(best - 1e-3 * nudge)) < 1e-6
        assert energy(best + 1e-3 * nudge) > energy(best)


def test_separate_parts_move_independently():
    mass = np.zeros((9, 5, 5))
    mass[1:4, 1:4, 1:4] = mass[5:8, 1:4, 1:4] = 1.0
    solid = SolidCells.of(mass, 0.1)
    right = solid.gathered(np.indices(mass.shape)[0]) >= 5
    aims = np.where(right[:, None], (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    np.testing.assert_allclose(solved(solid, aims, solid.filled), aims, atol=1e-9)


def test_it_can_be_cancelled():
    solid, points = blob()
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        elastic_step(solid, RANDOM.normal(size=points.shape), solid.filled, 3.0, control)
