# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters of uniform ellipsoids in three dimensions, which are known exactly."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.transport import Grid, barycenter
from tests.transport.ellipsoids import Ellipsoid, intersection_over_union

CELLS = 64
FIRST = Ellipsoid.rotated([30, 31, 33], [20, 9, 8], [0.3, 0.5, 0.2])
SECOND = Ellipsoid.rotated([34, 33, 31], [9, 18, 10], [-0.4, 0.2, 0.9])


@pytest.fixture(scope="module")
def densities():
    return np.stack([FIRST.occupancy(CELLS), SECOND.occupancy(CELLS)])


def enclosed(density, volume):
    """The densest cells with the given total volume."""
    level = np.sort(density, axis=None)[::-1][round(volume)]
    return (density > level).astype(float)


@pytest.mark.parametrize("t", [0.25, 0.5])
@pytest.mark.parametrize(("sharpness", "least"), [(0.0, 0.98), (None, 0.99), (1.0, 0.99)])
def test_overlap_with_the_exact_ellipsoid(densities, t, sharpness, least):
    settings = MorphSettings(motion="transport", resolution=CELLS, sharpness=sharpness)
    chosen = settings.sharpness_at((1 - t, t))
    found = barycenter(densities, [1 - t, t], Grid((CELLS,) * 3, settings.sigma), sharpness=chosen)
    exact = FIRST.barycenter(SECOND, t)
    overlap = intersection_over_union(enclosed(found.density, exact.volume), exact.occupancy(CELLS, 1))
    assert found.converged
    assert overlap >= least


def test_the_closed_form_has_the_inputs_at_its_ends():
    for t, end in ((0.0, FIRST), (1.0, SECOND)):
        np.testing.assert_allclose(FIRST.barycenter(SECOND, t).stretch, end.stretch, atol=1e-9)
