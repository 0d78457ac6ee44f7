# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Choices between two proposals, compared with brute force."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from convwass_addon.geometry.deformation.fusion import fused_choice


def total(second, costs, edges, seams):
    chosen = np.where(second, costs[1], costs[0]).sum()
    return chosen + seams[second[edges[:, 0]] != second[edges[:, 1]]].sum()


@pytest.mark.parametrize("seed", range(6))
def test_no_other_choice_is_cheaper(seed):
    rng = np.random.default_rng(seed)
    costs, count = rng.random((2, 9)), 9
    edges = np.array([pair for pair in itertools.combinations(range(count), 2) if rng.random() < 0.4])
    seams = 0.6 * rng.random(len(edges))
    least = min(total(np.array(way, bool), costs, edges, seams) for way in itertools.product((0, 1), repeat=count))
    assert total(fused_choice(costs, edges, seams), costs, edges, seams) == pytest.approx(least, abs=1e-4)


def test_an_indifferent_region_follows_its_neighbors():
    """One end of a chain prefers the first proposal, the other the second; the seam is where it is cheapest."""
    count = 20
    costs = np.zeros((2, count))
    costs[1, 0] = costs[0, -1] = 5.0
    edges = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    seams = np.ones(count - 1)
    seams[12] = 0.1
    np.testing.assert_array_equal(fused_choice(costs, edges, seams), np.arange(count) > 12)


def test_without_costs_the_first_is_chosen():
    assert not fused_choice(np.zeros((2, 4)), np.array([[0, 1]]), np.zeros(1)).any()
