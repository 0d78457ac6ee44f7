# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from convwass_addon.applications.morphs.coinciding_solids import CoincidingSolids
from convwass_addon.geometry.isosurface import surface_at_level
from convwass_addon.geometry.occupancy import occupancy
from tests.shapes import ball

CENTER = np.array([20.3, 19.7, 20.1])


def filled(radius, center=CENTER):
    return occupancy(ball(radius, center, 4000).corners, (40, 40, 40))


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_the_mean_of_concentric_balls_is_the_ball_between(share):
    solids = CoincidingSolids.of([filled(10.0), filled(11.0)], (1.0 - share, share))
    assert solids.disagreement == 0.0
    mesh = surface_at_level(solids.density, 0.5).mesh
    radii = np.linalg.norm(mesh.vertices - CENTER, axis=1)
    assert radii.std() < 0.02
    assert radii.mean() == pytest.approx(10.0 + share, abs=0.05)


def test_balls_that_are_apart_disagree():
    solids = CoincidingSolids.of([filled(8.0), filled(8.0, CENTER + np.array([6.0, 0.0, 0.0]))], (0.5, 0.5))
    assert solids.disagreement > 0.5


def test_the_mixture_is_the_mean_where_solids_agree_and_the_other_density_elsewhere():
    """A ball with a ball on top of it on one side only."""
    plain = filled(8.0)
    knob = np.maximum(plain, filled(3.0, CENTER + np.array([0.0, 0.0, 10.0])))
    solids = CoincidingSolids.of([plain, knob], (0.5, 0.5))
    other = np.full(plain.shape, 0.25, np.float32)
    mixed = solids.mixed(other, (slice(None),) * 3)
    bottom, top = (20, 20, 12), (20, 20, 31)
    assert mixed[bottom] == pytest.approx(solids.density[bottom], abs=1e-3)
    assert mixed[top] == pytest.approx(0.25, abs=0.02)
