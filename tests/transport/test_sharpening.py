# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.transport.sharpening import entropy, sharpening_exponent

CELLS = 400
AXIS = (np.arange(CELLS) + 0.5) / CELLS
WEIGHT = 1.0 / CELLS


def gaussian(deviation):
    density = np.exp(-((AXIS - 0.5) ** 2) / (2 * deviation**2))
    return density / density.sum() / WEIGHT


def test_entropy_of_a_gaussian_and_of_the_uniform_density():
    assert entropy(gaussian(0.05), WEIGHT) == pytest.approx(0.5 * np.log(2 * np.pi * np.e * 0.05**2), abs=1e-9)
    assert entropy(np.ones(CELLS), WEIGHT) == pytest.approx(0.0)


def test_cells_without_mass_have_no_entropy():
    half = np.where(AXIS < 0.5, 2.0, 0.0)
    assert entropy(half, WEIGHT) == pytest.approx(-np.log(2))


@pytest.mark.parametrize("ratio", [0.3, 0.6, 0.9])
def test_a_gaussian_to_a_power_is_a_narrower_gaussian(ratio):
    # Deviation s / sqrt(beta): the bound for deviation r s requires beta = 1 / r^2.
    wide = gaussian(0.08)
    limit = 0.5 * np.log(2 * np.pi * np.e * (ratio * 0.08) ** 2)
    assert sharpening_exponent(np.log(wide), limit, WEIGHT) == pytest.approx(1 / ratio**2, rel=1e-6)


def test_a_density_within_the_bound_is_unchanged():
    assert sharpening_exponent(np.log(gaussian(0.05)), 0.0, WEIGHT) == 1.0


def test_an_unreachable_bound_gives_no_nan():
    # No power separates two equal peaks of one cell.
    density = np.full(CELLS, 1e-9)
    density[[100, 300]] = 1.0
    beta = sharpening_exponent(np.log(density), -10.0, WEIGHT)
    assert np.isfinite(beta)
    assert beta >= 1.0
