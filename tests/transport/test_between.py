# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.transport import Grid, Inputs, barycenter, barycenter_between

GRID = Grid((48, 40), 1.3)


def bump(center, deviation):
    cells = np.moveaxis(np.indices(GRID.shape), 0, -1) + 0.5
    return np.exp(-(((cells - center) / deviation) ** 2).sum(axis=-1) / 2)


INPUTS = Inputs.of(
    [bump((12, 12), (3, 5)) + 0.5 * bump((20, 26), (4, 3)), bump((33, 24), (6, 3)), bump((24, 30), 4)], GRID
)


def solved(weights, tolerance=1e-2, sharpness=0.75):
    return barycenter(INPUTS, weights, GRID, sharpness=sharpness, tolerance=tolerance, max_iterations=2000)


def difference(one, other):
    return float(np.abs(one.density - other.density).mean())


@pytest.mark.parametrize("share", [0.25, 0.5, 0.9])
def test_between_neighbors_it_is_the_barycenter(share):
    first, second = solved([0.5, 0.5, 0.0], 1e-6), solved([0.45, 0.55, 0.0], 1e-6)
    weights = (1 - share) * first.weights + share * second.weights
    truth = solved(weights, 1e-6)
    found = barycenter_between(first, second, share, INPUTS)
    assert found.converged
    assert found.iterations[0] <= 3
    np.testing.assert_allclose(found.weights, weights)
    assert difference(found, truth) < 5e-3
    # No cross-fade, which is off by more.
    fade = (1 - share) * first.density + share * second.density
    assert difference(found, truth) < 0.5 * np.abs(fade - truth.density).mean()
    exact = barycenter_between(first, second, share, INPUTS, tolerance=1e-6, max_iterations=2000)
    assert difference(exact, truth) < 1e-5


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_the_ends_are_the_neighbors(share):
    neighbors = solved([0.3, 0.3, 0.4], 1e-6), solved([0.25, 0.3, 0.45], 1e-6, sharpness=0.8)
    found = barycenter_between(*neighbors, share, INPUTS)
    assert found.iterations == (1,)
    assert found.sharpness == neighbors[round(share)].sharpness
    assert difference(found, neighbors[round(share)]) < 1e-5


def test_strangers_are_refused():
    first, other = solved([0.5, 0.5, 0.0]), solved([0.5, 0.4, 0.1])
    with pytest.raises(ValueError, match="second must give weight to the inputs that first does"):
        barycenter_between(first, other, 0.5, INPUTS)
    with pytest.raises(ValueError, match=r"share must lie between 0 and 1, got 1\.5"):
        barycenter_between(first, first, 1.5, INPUTS)
    two = Inputs.of([bump((12, 12), 3), bump((33, 24), 3)], GRID)
    with pytest.raises(ValueError, match="first must be a barycenter of these inputs"):
        barycenter_between(first, first, 0.5, two)


def test_it_can_be_stopped():
    first, second = solved([0.5, 0.5, 0.0]), solved([0.4, 0.6, 0.0])

    def stop(*_):
        raise Cancelled("stop")

    with pytest.raises(Cancelled):
        barycenter_between(first, second, 0.5, INPUTS, monitor=stop)
