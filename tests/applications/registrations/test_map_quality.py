# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of sheets that lie on each other in known folds."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.applications.registrations.map_quality import MapQuality, map_quality
from convwass_addon.applications.registrations.shape_deformations import split_deformation
from convwass_addon.progress import UNINTERRUPTED
from tests.grids import sheet


def quality(source, target, laid, confidence=np.ones_like, vertices=4000):
    """The figures of a sheet on another one, on which a function lays its points with a confidence by their x."""
    one, other = (carrier_of(mesh, "sheet", vertices, UNINTERRUPTED) for mesh in (source, target))
    points = Laid(laid(one.mesh.vertices), confidence(one.mesh.vertices[:, 0]))
    return map_quality(one, other, split_deformation(one, other, points, None, UNINTERRUPTED))


@pytest.mark.parametrize("folds", [1, 2, 3])
def test_a_sheet_in_folds_crumples(folds):
    """Folded like a fan, a strip as long as some squares lies on one of them."""

    def folded(points):
        return np.stack([np.abs((points[:, 0] + 1.0) % 2.0 - 1.0), *points.T[1:]], axis=1)

    found = quality(sheet(40 * folds + 1, 41, (float(folds), 1.0)), sheet(41, 41), folded)
    assert found.crumpling == pytest.approx(folds)
    # Every second square lies upside down.
    assert found.folded == pytest.approx((folds // 2) / folds, abs=0.05)
    assert (found.torn, found.confidence) == (0.0, pytest.approx(1.0))


def test_a_sheet_that_is_stretched_onto_another_one_does_not_crumple():
    half, square = sheet(21, 41, (0.5, 1.0)), sheet(41, 41)
    there = quality(half, square, lambda points: points * (2.0, 1.0, 1.0))
    assert there.crumpling == pytest.approx(1.0)
    back = quality(square, half, lambda points: points)
    assert back.crumpling == pytest.approx(2.0)
    assert there.or_worse(back).crumpling == back.or_worse(there).crumpling == back.crumpling


@pytest.mark.parametrize(("factor", "torn"), [(3.9, 0.0), (4.2, 1.0), (1.0 / 4.2, 1.0)])
def test_what_is_stretched_by_more_than_a_factor_of_four_is_torn(factor, torn):
    size = np.array([factor, 1.0 / factor, 1.0])
    square, strip = sheet(21, 21, (2.0, 2.0)), sheet(21, 21, 2.0 * size[:2])
    found = quality(square, strip, lambda points: points * size, vertices=500)
    assert found.torn == pytest.approx(torn)


def test_confidence_is_averaged_over_the_area():
    strip = sheet(41, 11, (4.0, 1.0))
    found = quality(strip, strip, np.copy, lambda x: 0.5 + x / 8.0, vertices=500)
    center = strip.vertices[:, 0].mean()
    assert found.confidence == pytest.approx(0.5 + center / 8.0, abs=0.01)


def test_the_worse_of_two_records_is_so_in_every_figure():
    one, other = MapQuality(0.9, 0.1, 0.2, 1.5), MapQuality(0.8, 0.3, 0.1, 1.2)
    assert one.or_worse(other) == other.or_worse(one) == MapQuality(0.8, 0.3, 0.2, 1.5)


@pytest.mark.parametrize(
    ("figures", "beyond"),
    [((0.97, 0.02, 0.01), True), ((0.96, 0.0, 0.0), False), ((1.0, 0.03, 0.0), False), ((1.0, 0.0, 0.02), False)],
)
def test_maps_are_beyond_doubt_if_they_are_confident_and_hardly_torn_or_folded(figures, beyond):
    assert MapQuality(*figures, crumpling=1.0).is_beyond_doubt is beyond
