# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters continued from their coarse levels: bitwise the same as those solved at once."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.transport import Grid, Inputs, barycenter
from tests.controls import CountingControl

SHAPE = (32, 48, 32)
WAYS = [
    {"sharpness": 0.75},
    {"sharpness": 0.0, "entropy_limit": "max"},
    {"sharpness": 0.5, "entropy_limit": "max", "tightening": 2},
    {"sharpness": 0.75, "reach": 7.0},
]


def solids():
    """A ball, a slab and a rod, off center."""
    x, y, z = np.moveaxis(Grid(SHAPE, 1.0).positions, -1, 0)
    ball = (x - 11) ** 2 + (y - 20) ** 2 + (z - 16) ** 2 < 49
    slab = (abs(x - 17) < 9) & (abs(y - 26) < 4) & (abs(z - 15) < 7)
    rod = (abs(x - 20) < 3) & (abs(y - 24) < 17) & (abs(z - 18) < 3)
    return np.stack([ball, slab, rod]).astype(float)


GRID = Grid(SHAPE, 1.2)
INPUTS = Inputs.of(solids(), GRID)


def part(inputs, weights, **options):
    return barycenter(inputs, weights, inputs.domain, **options)


def assert_same(one, other):
    np.testing.assert_array_equal(one.density, other.density)
    for first, second in zip(one.levels, other.levels, strict=True):
        np.testing.assert_array_equal(first.region.inside, second.region.inside)
        np.testing.assert_array_equal(first.columns, second.columns)
    assert one.record() == other.record()


@pytest.mark.parametrize("options", WAYS)
def test_continued_solves_equal_those_solved_at_once(options):
    assert len(INPUTS.levels) == 3
    at_once = part(INPUTS, [0.5, 0.3, 0.2], **options)
    coarsest = part(INPUTS.coarser.coarser, [0.5, 0.3, 0.2], **options)
    coarse = part(INPUTS.coarser, [0.5, 0.3, 0.2], begun=coarsest, **options)
    for begun in (coarsest, coarse):
        assert_same(part(INPUTS, [0.5, 0.3, 0.2], begun=begun, **options), at_once)


@pytest.mark.parametrize("options", WAYS)
def test_chains_of_continued_solves_equal_those_solved_at_once(options):
    """The coarse parts start from each other, and so do the complete solves."""
    whole, coarse, finished = None, None, None
    for t in (0.2, 0.3, 0.4):
        weights = [1 - t, t, 0]
        whole = part(INPUTS, weights, initial=whole, **options)
        coarse = part(INPUTS.coarser, weights, initial=coarse, **options)
        finished = part(INPUTS, weights, initial=finished, begun=coarse, **options)
        assert_same(finished, whole)


def test_the_coarse_levels_are_not_solved_again():
    begun = part(INPUTS.coarser, [1, 1, 1])
    control = CountingControl()
    found = part(INPUTS, [1, 1, 1], begun=begun, control=control)
    assert found.iterations[:-1] == begun.iterations
    assert control.count == found.iterations[-1]


def test_a_coarse_part_lies_where_the_whole_does():
    whole, coarse = part(INPUTS, [1, 2, 0]), part(INPUTS.coarser, [1, 2, 0])
    assert coarse.converged
    middles = [
        np.tensordot(one.density / one.density.sum(), scale * positions, 3)
        for one, scale, positions in ((whole, 1, GRID.positions), (coarse, 2, INPUTS.coarser.domain.positions))
    ]
    np.testing.assert_allclose(*middles, atol=0.1)


def test_inputs_on_a_single_level_cannot_be_begun():
    with pytest.raises(ValueError, match="no coarser"):
        _ = INPUTS.coarser.coarser.coarser


@pytest.mark.parametrize(
    ("weights", "options", "message"),
    [
        ([1, 1, 2], {}, "the weights"),
        ([1, 1, 1], {"sharpness": 0.5}, "the sharpness"),
    ],
)
def test_a_start_for_another_problem_is_refused(weights, options, message):
    begun = part(INPUTS.coarser, [1, 1, 1])
    with pytest.raises(ValueError, match=f"begun must have .*{message}"):
        part(INPUTS, weights, begun=begun, **options)


def test_a_complete_solution_is_refused_as_a_start():
    whole = part(INPUTS, [1, 1, 1])
    with pytest.raises(ValueError, match="begun must be a barycenter of the coarser levels"):
        part(INPUTS, [1, 1, 1], begun=whole)
