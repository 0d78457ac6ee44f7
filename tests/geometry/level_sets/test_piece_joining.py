# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.level_sets.level_topology import pieces_above
from convwass_addon.geometry.level_sets.mending import mended_surface
from convwass_addon.geometry.level_sets.piece_joining import DEEPEST_GAP, STRAY_SHARE, grown_share, join_pieces

CELLS = np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in (48, 28, 28)], indexing="ij"), axis=-1)
LEVEL = 1.0


def ball(center, radius):
    return 2.0 / (1.0 + np.exp(2.0 * (np.linalg.norm(CELLS - center, axis=-1) - radius)))


def gap(first, last, height):
    """A thin rod of some density along x."""
    x, y, z = np.moveaxis(CELLS - [0, 14, 14], -1, 0)
    along = np.clip(CELLS[..., 0], first, last)
    return height * np.exp(-(y**2 + z**2 + (x - along) ** 2) / 4.0)


def drawn_out(height):
    """A ball and one slightly larger than half a stray, six cells apart, with a rod of this density between them."""
    return np.maximum.reduce([ball((14, 14, 14), 9), ball((30.3, 14, 14), 1.5), gap(14, 30.3, height)])


def test_the_fraction_of_growth_is_continuous():
    sizes, heights = STRAY_SHARE * np.linspace(0.0, 3.0, 61), np.linspace(0.0, 1.0, 101)
    grown = np.array([[grown_share(size, height, 3.0, 12.0) for height in heights] for size in sizes])
    assert (np.diff(grown, axis=0) >= 0).all()
    assert (np.diff(grown, axis=1) >= 0).all()
    assert np.diff(grown[2:], axis=0).max() < 0.3
    assert np.diff(grown, axis=1).max() < 0.11
    assert (grown[0, heights < 0.5] == 0.0).all()
    assert (grown[-1] == 1.0).all()
    assert grown_share(STRAY_SHARE, DEEPEST_GAP, 3.0, 12.0) == 0.0


def test_a_small_component_grows_out_of_a_large_one_and_back():
    """They stay connected, and the tip moves by less than two cells per step instead of appearing seven cells away."""
    volume = float((ball((14, 14, 14), 9) > LEVEL).sum())
    tips = []
    for height in np.linspace(0.3, 0.9, 31):
        mended = mended_surface(drawn_out(height), volume, Connectivity(1, 0, 0))
        assert mended.found == Connectivity(1, 0, 0)
        tips.append(mended.surface.mesh.bounds[1][0])
    assert tips[0] < 24.5
    assert tips[-1] > 31
    assert np.abs(np.diff(tips)).max() < 2.0


@pytest.mark.parametrize("most", [1, 2])
def test_the_largest_components_stay_separate(most):
    density = np.maximum.reduce(
        [ball((8, 14, 14), 6), ball((40, 14, 14), 6), ball((24, 14, 14), 3), gap(8, 24, 0.9), gap(24, 40, 0.8)]
    )
    pieces = pieces_above(density, LEVEL)
    assert pieces.count == 3
    done = join_pieces(density, LEVEL, pieces, most, float((density > LEVEL).sum()))
    assert (done.bridged, done.clipped, done.dropped) == (3 - most, 0, 0)
    left = pieces_above(density, LEVEL)
    assert left.count == most
    assert (left.labels[24, 14, 14] == left.labels[40, 14, 14]) == (most == 1)


def test_small_components_without_a_gap_are_dropped_and_larger_ones_kept():
    density = np.maximum.reduce([ball((12, 14, 14), 9), ball((30, 14, 14), 1.5), ball((40, 14, 14), 4)])
    pieces = pieces_above(density, LEVEL)
    done = join_pieces(density, LEVEL, pieces, 1, float((density > LEVEL).sum()))
    assert (done.bridged, done.clipped, done.dropped) == (0, 0, 1)
    left = pieces_above(density, LEVEL)
    assert left.count == 2
    assert left.labels[40, 14, 14] > 0
