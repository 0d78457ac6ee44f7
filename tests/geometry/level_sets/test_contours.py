# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of densities in the plane: areas, holes, islands, mending and fitting."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree

from convwass_addon.errors import InputError
from convwass_addon.geometry.level_sets.contours import outline_at_level, outline_enclosing
from convwass_addon.geometry.level_sets.flat_mending import FlatConnectivity, holes_below, mended_outline, regions_above
from convwass_addon.geometry.plane.coverage import coverage
from convwass_addon.geometry.plane.fitting import fitted_beziers, fitted_polygons
from convwass_addon.geometry.plane.outlines import ring_area
from convwass_addon.geometry.plane.pixels import means_in_cells
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from tests.flat_shapes import ellipse, rectangle


def drawn(rings, cells=96, rule="even-odd"):
    return coverage(filled_boundary(rings, rule), (cells, cells))


def test_a_disc_has_the_correct_area_and_center():
    density = gaussian_filter(drawn([ellipse((40.3, 52.1), (25, 25))]), 0.7)
    outline = outline_enclosing(density, np.pi * 625).outline
    (region,) = outline.regions
    assert outline.area == pytest.approx(np.pi * 625, rel=3e-4)
    np.testing.assert_allclose(np.linalg.norm(region.outer - [40.3, 52.1], axis=1), 25.0, atol=0.06)


def test_holes_and_islands_are_nested_in_their_rings():
    rings = [ellipse((48, 48), (40, 40)), ellipse((48, 48), (25, 25)), ellipse((48, 48), (10, 10))]
    outline = outline_at_level(drawn(rings), 0.5).outline
    large, small = outline.regions
    assert [len(large.holes), len(small.holes)] == [1, 0]
    assert outline.holes == 1
    assert ring_area(large.outer) > 0 > ring_area(large.holes[0])
    assert ring_area(large.outer) == pytest.approx(np.pi * 1600, rel=2e-3)
    assert ring_area(small.outer) == pytest.approx(np.pi * 100, rel=1e-2)


def test_outlines_at_the_boundary_are_closed():
    assert outline_at_level(np.ones((6, 8)), 0.5).outline.area == pytest.approx(48, abs=0.6)


@pytest.mark.parametrize("seed", range(5))
def test_components_of_cells_agree_with_the_outlines(seed):
    density = np.random.default_rng(seed).random((24, 17))
    found = FlatConnectivity.of(outline_at_level(density, 0.55))
    assert found.regions == regions_above(density, 0.55)[1]
    assert found.holes == holes_below(density, 0.55)[1]


def test_levels_equal_to_values_of_cells_make_closed_rings():
    density = np.zeros((9, 9))
    density[2:7, 2:7] = 0.5
    assert len(outline_at_level(density, 0.5).outline.regions) == 1


@pytest.mark.parametrize("density", [np.zeros((8, 8)), np.pad(np.ones((2, 2)), 3)])
def test_a_density_too_small_for_the_area_is_refused(density):
    with pytest.raises(InputError, match="dense enough"):
        outline_enclosing(density, 20.0)


def test_crumbs_and_false_holes_are_removed():
    rings = [ellipse((48, 48), (30, 30)), ellipse((48, 48), (2, 2)), ellipse((8, 8), (1, 1))]
    density = gaussian_filter(drawn(rings), 0.7)
    mending = mended_outline(density, np.pi * 900, FlatConnectivity(1, 0))
    assert (mending.crumbs, mending.filled) == (1, 1)
    assert mending.found == FlatConnectivity(1, 0)
    assert mending.drawn.outline.area == pytest.approx(np.pi * 900, rel=3e-3)


def test_narrow_gaps_are_bridged_and_wide_ones_are_not():
    for gap, regions in ((1.2, 1), (20.0, 2)):
        halves = [rectangle((10, 30), (46, 60)), rectangle((46 + gap, 30), (90, 60))]
        density = gaussian_filter(drawn(halves), 1.0)
        assert mended_outline(density, density.sum(), FlatConnectivity(1, 0)).found.regions == regions


def test_features_of_the_shapes_are_kept():
    density = gaussian_filter(drawn([ellipse((48, 48), (30, 30)), ellipse((48, 48), (2, 2))]), 0.7)
    mending = mended_outline(density, density.sum(), FlatConnectivity(1, 1))
    assert mending.found == FlatConnectivity(1, 1)
    assert mending.filled == 0


@pytest.fixture(scope="module")
def blob():
    rings = [ellipse((48, 48), (40, 30), angle=0.4), rectangle((35, 40), (55, 56))]
    return outline_enclosing(gaussian_filter(drawn(rings), 0.7), np.pi * 1200 - 320).outline


@pytest.mark.parametrize("error", [0.1, 0.3, 1.0])
def test_polygons_stay_within_the_error(blob, error):
    fitted = fitted_polygons(blob, error)
    for ring, few in zip(blob.rings, fitted.rings, strict=True):
        assert len(few) < len(ring) / 3
        share, ahead = np.linspace(0, 1, 200)[:, None, None], np.roll(few, -1, axis=0)
        dense = (few + share * (ahead - few)).reshape(-1, 2)
        assert cKDTree(dense).query(ring)[0].max() <= error + 0.05
    assert fitted.area == pytest.approx(blob.area, rel=0.03 * error / 0.3)


@pytest.mark.parametrize("error", [0.1, 0.3, 1.0])
def test_curves_stay_within_the_stated_error(blob, error):
    for ring, curve in zip(blob.rings, fitted_beziers(blob, error), strict=True):
        assert curve.error <= error
        samples = curve.sampled(1500)
        assert cKDTree(samples).query(ring)[0].max() <= curve.error + 0.05
        assert cKDTree(ring).query(samples)[0].max() <= curve.error + 0.75
        assert len(curve.points) < len(ring) / 4


def test_a_circle_needs_few_pieces_and_has_no_corners():
    outline = outline_enclosing(gaussian_filter(drawn([ellipse((48, 48), (30, 30))]), 0.7), np.pi * 900).outline
    (curve,) = fitted_beziers(outline, 0.2)
    assert len(curve.points) <= 8
    assert not curve.corners.any()


def test_a_rectangle_keeps_its_corners():
    outline = outline_enclosing(gaussian_filter(drawn([rectangle((20, 30), (70, 60))]), 0.7), 1500.0).outline
    (curve,) = fitted_beziers(outline, 0.5)
    assert curve.corners.sum() == 4


def test_images_keep_their_mass_when_resampled():
    values = np.random.default_rng(1).random((13, 9))
    found = means_in_cells(values, (2.3, 4.6), 1.7, (40, 32))
    assert found.sum() == pytest.approx(values.sum() * 1.7**2)
    np.testing.assert_allclose(means_in_cells(values, (0, 0), 1.0, (13, 9)), values)
    assert means_in_cells(values, (-50, 0), 1.0, (8, 8)).sum() == 0
