# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Histograms that sum to one as input and output, on cells of equal and of different areas."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.transport import Grid, Sphere, Surface, barycenter, bisect, from_masses, interpolate, propagate
from tests.shapes import box

SHEET = box((1.0, 2.0, 0.5))
DOMAINS = [Grid((8, 6), 1.0), Sphere(8, 1.0), Surface(SHEET.vertices, SHEET.faces)]


def histograms(domain, count=2):
    found = np.random.default_rng(0).random((count, *domain.shape))
    return found / found.reshape(count, -1).sum(axis=1).reshape(count, *[1] * len(domain.shape))


@pytest.mark.parametrize("domain", DOMAINS, ids=lambda domain: type(domain).__name__)
def test_every_result_gives_histograms_that_sum_to_one(domain):
    given = from_masses(histograms(domain), domain)
    results = [
        barycenter(given, [1.0, 1.0], domain),
        interpolate(*given, [0.0, 0.5, 1.0], domain),
        bisect(*given, domain, levels=1),
        propagate([[0, 1], [1, 2]], 1.0, {0: given[0], 2: given[1]}, domain),
    ]
    axes = tuple(range(-len(domain.shape), 0))
    for result in results:
        # For results with one distribution and with several.
        np.testing.assert_allclose(result.masses.sum(axis=axes), 1.0, atol=0.02)


@pytest.mark.parametrize("domain", DOMAINS, ids=lambda domain: type(domain).__name__)
def test_masses_are_converted_there_and_back(domain):
    given = histograms(domain)
    densities = from_masses(given, domain)
    np.testing.assert_allclose((densities * domain.weights).sum(axis=tuple(range(1, densities.ndim))), 1.0)
    found = interpolate(*densities, [0.0, 1.0], domain)
    np.testing.assert_allclose(found.masses, given, rtol=1e-12)
    np.testing.assert_array_equal(from_masses(given[0], domain), densities[0])


def test_a_grid_accepts_histograms_unchanged():
    grid = DOMAINS[0]
    given = histograms(grid)
    np.testing.assert_allclose(
        barycenter(given, [1, 1], grid).density, barycenter(from_masses(given, grid), [1, 1], grid).density, rtol=1e-9
    )


def test_invalid_masses_are_refused():
    loose = Surface(np.concatenate([SHEET.vertices, [[5.0, 5.0, 5.0]]]), SHEET.faces)
    with pytest.raises(ValueError, match="no area"):
        from_masses(np.full(9, 1 / 9), loose)
    assert from_masses([1.0] + [0.0] * 8, loose)[8] == 0.0
    with pytest.raises(ValueError, match=r"masses must have the shape \(k, 9\), got \(8,\)"):
        from_masses(np.ones(8), loose)
