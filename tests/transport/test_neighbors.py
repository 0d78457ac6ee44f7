# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.progress import Control
from convwass_addon.transport import Grid, Inputs, barycenter, barycenter_between, barycenter_from_neighbor
from convwass_addon.transport.log_range import LOG_NOTHING
from convwass_addon.transport.potentials import Potentials
from convwass_addon.transport.region import Region

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
def test_interpolating_neighbors_gives_the_barycenter(share):
    first, second = solved([0.5, 0.5, 0.0], 1e-6), solved([0.45, 0.55, 0.0], 1e-6)
    weights = (1 - share) * first.weights + share * second.weights
    truth = solved(weights, 1e-6)
    found = barycenter_between(first, second, share, INPUTS)
    assert found.converged
    assert found.iterations[0] <= 3
    np.testing.assert_allclose(found.weights, weights)
    assert difference(found, truth) < 5e-3
    # A linear cross-fade has a larger error.
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


def test_neighbors_of_other_problems_are_refused():
    first, other = solved([0.5, 0.5, 0.0]), solved([0.5, 0.4, 0.1])
    with pytest.raises(ValueError, match="second must give weight to the inputs that first does"):
        barycenter_between(first, other, 0.5, INPUTS)
    with pytest.raises(ValueError, match=r"share must lie between 0 and 1, got 1\.5"):
        barycenter_between(first, first, 1.5, INPUTS)
    two = Inputs.of([bump((12, 12), 3), bump((33, 24), 3)], GRID)
    with pytest.raises(ValueError, match="first must be a barycenter of these inputs"):
        barycenter_between(first, first, 0.5, two)


def test_it_can_be_cancelled():
    first, second = solved([0.5, 0.5, 0.0]), solved([0.4, 0.6, 0.0])
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        barycenter_between(first, second, 0.5, INPUTS, control=control)


def only_finest(one):
    return replace(one, levels=one.levels[-1:], density=np.full(one.density.shape, np.nan))


@pytest.mark.parametrize("reach", [None, 12.0])
def test_starting_from_one_neighbor_gives_the_barycenter(reach):
    options = {"sharpness": 0.75, "reach": reach, "tolerance": 1e-6, "max_iterations": 3000}
    first = barycenter(INPUTS, [0.5, 0.5, 0.0], GRID, **options)
    truth = barycenter(INPUTS, [0.42, 0.58, 0.0], GRID, **options)
    found = barycenter_from_neighbor(only_finest(first), [0.42, 0.58, 0.0], INPUTS, **options)
    assert found.converged
    assert difference(found, truth) < 1e-4
    quick = barycenter_from_neighbor(only_finest(first), [0.42, 0.58, 0.0], INPUTS, sharpness=0.75, reach=reach)
    assert quick.converged
    assert difference(quick, truth) < 0.2 * difference(first, truth)


def test_values_that_represent_nothing_are_not_interpolated():
    """Cells where neither neighbor has a scaling must not get one."""
    first, second = solved([0.5, 0.5, 0.0], 1e-6), solved([0.45, 0.55, 0.0], 1e-6)
    plain = barycenter_between(first, second, 0.5, INPUTS, tolerance=1e-6, max_iterations=2000)

    def with_nothing(one):
        finest = one.levels[-1].on(Region.whole(GRID.shape))
        far = finest.region.gather(one.density) < 1e-9 * one.density.max()
        assert far.any()
        columns = np.where(far, LOG_NOTHING + 400.0 * np.arange(2)[:, None], finest.log_v)
        return replace(one, levels=(Potentials(finest.region, columns, finest.log_debias),))

    found = barycenter_between(with_nothing(first), with_nothing(second), 0.5, INPUTS)
    assert found.converged
    assert found.iterations[0] <= 3
    assert difference(found, plain) < 5e-3


@pytest.mark.parametrize("unknown", [0, 1])
def test_where_one_neighbor_has_no_scaling_that_of_the_other_is_used(unknown):
    """Of either input, in half of the grid, and left out or replaced by a value that represents nothing."""
    one = solved([0.5, 0.5, 0.0], 1e-6)
    finest = one.levels[-1].on(Region.whole(GRID.shape))
    left = np.broadcast_to(np.arange(GRID.shape[1]) < 20, GRID.shape)
    columns = finest.log_v.copy()
    columns[unknown, finest.region.gather(left)] = LOG_NOTHING
    for potentials in (Potentials(finest.region, columns, finest.log_debias), finest.on(Region(~left))):
        found = barycenter_between(replace(one, levels=(potentials,)), one, 0.5, INPUTS)
        assert found.iterations == (1,)
        assert difference(found, one) < 1e-5
