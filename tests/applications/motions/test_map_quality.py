# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of sheets that lie on each other in known folds."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.motions.carriers import carrier_of
from convwass_addon.applications.motions.laid_meshes import Laid
from convwass_addon.applications.motions.map_quality import map_quality
from convwass_addon.applications.motions.shape_deformations import split_deformation
from convwass_addon.progress import UNINTERRUPTED
from tests.grids import sheet


def quality(source, target, laid):
    """The figures of a sheet on another one, on which a function lays its points."""
    one, other = (carrier_of(mesh, "sheet", 4000, UNINTERRUPTED) for mesh in (source, target))
    points = Laid(laid(one.mesh.vertices), np.ones(len(one.mesh.vertices)))
    return map_quality(one, other, split_deformation(one, other, points, None, UNINTERRUPTED))


@pytest.mark.parametrize("folds", [1, 2, 3])
def test_a_sheet_in_folds_crumples(folds):
    """Folded like a fan, a strip as long as some squares lies on one of them."""

    def folded(points):
        return np.stack([np.abs((points[:, 0] + 1.0) % 2.0 - 1.0), *points.T[1:]], axis=1)

    found = quality(sheet(40 * folds + 1, 41, (float(folds), 1.0)), sheet(41, 41), folded)
    assert found.crumpling == pytest.approx(folds)


def test_a_sheet_that_is_stretched_onto_another_one_does_not_crumple():
    half, square = sheet(21, 41, (0.5, 1.0)), sheet(41, 41)
    there = quality(half, square, lambda points: points * (2.0, 1.0, 1.0))
    assert there.crumpling == pytest.approx(1.0)
    back = quality(square, half, lambda points: points)
    assert back.crumpling == pytest.approx(2.0)
    assert there.or_worse(back).crumpling == back.or_worse(there).crumpling == back.crumpling
