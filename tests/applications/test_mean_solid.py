# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Means of solids of which only one has a part: it grows evenly, in one piece."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import label

from convwass_addon.applications.morphs.growing_parts import FARTHEST
from convwass_addon.applications.morphs.mean_solid import mean_solid

GRID = np.stack(np.meshgrid(*[np.arange(44) + 0.5] * 3, indexing="ij"), axis=-1)


def rod(*points, radius=2.5):
    """The signed distance to a bent rod, positive inside."""
    nearest = np.inf
    for start, end in pairwise(points):
        start, along = np.array(start, float), np.subtract(end, start).astype(float)
        share = np.clip((GRID - start) @ along / (along @ along), 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(GRID - start - share[..., None] * along, axis=-1))
    return radius - nearest


def ball(radius, center=(22.0, 22.0, 22.0)):
    return radius - np.linalg.norm(GRID - center, axis=-1)


SLAB = np.minimum(10.0 - GRID[..., 2], GRID[..., 2] - 2.0)
SLAB = np.minimum(SLAB, np.minimum(GRID[..., 0] - 3.0, 41.0 - GRID[..., 0]))
SLAB = np.minimum(SLAB, np.minimum(GRID[..., 1] - 3.0, 41.0 - GRID[..., 1]))


def mean(one, other, share, volume=None):
    farthest = FARTHEST * max(one.shape)
    depths = np.clip(np.stack([one, other]), -farthest, farthest).astype(np.float32)
    return mean_solid(depths, (1.0 - share, share), 1.0, volume)


def slab_and_column(shape, slab_top, radius, column_top):
    """The distances to a slab, and to the same slab with a column in its middle."""
    x, y, z = (np.arange(size) + 0.5 for size in shape)
    across = np.hypot(x[:, None] - shape[0] / 2.0, y - shape[1] / 2.0)[..., None]
    slab = np.minimum(slab_top - z, z - 2.0) * np.ones_like(across)
    return slab, np.maximum(slab, np.minimum(radius - across, np.minimum(column_top - z, z - 2.0)))


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_a_long_rod_grows_evenly_on_a_fine_grid(share):
    """Fronts are measured on a coarser grid if there are many cells along a side."""
    found = mean(*slab_and_column((30, 30, 200), 20.0, 6.0, 190.0), share)
    top = np.flatnonzero(found[15, 15] > 0.0)[-1] + 1.0
    # At a weight of 1, the front is three cells of two further than the rod.
    assert top == pytest.approx(20.0 + 176.0 * share, abs=3.0)
    assert pieces(found) == 1
    assert (found[:, :, 40] > 0.0).sum() == pytest.approx(np.pi * 36.0, rel=0.1)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_a_thick_column_grows_evenly(share):
    """It is longer than distances are known: its length is not, which must not make it stout."""
    found = mean(*slab_and_column((40, 40, 130), 14.0, 16.0, 124.0), share)
    top = np.flatnonzero(found[20, 20] > 0.0)[-1] + 1.0
    # Its front, which is three cells further than the column at a weight of 1, rounds it within four cells before and
    # eight behind. Without a front, 16 w / (1 - w) of the column is left.
    assert top == pytest.approx(14.0 + 112.0 * share, abs=10.0)


def pieces(depth):
    return label(depth > 0.0)[1]


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_a_rod_grows_evenly(share):
    tall = np.maximum(SLAB, rod((22, 22, 5), (22, 22, 38)))
    found = mean(SLAB, tall, share)
    top = np.flatnonzero(found[22, 22] > 0.0)[-1] + 1.0
    # The rod rises to 40.5 with its round tip; at a weight of 1, its front is three cells further.
    assert top == pytest.approx(10.0 + 33.5 * share, abs=1.6)
    assert pieces(found) == 1
    section = (found[:, :, 13] > 0.0).sum()
    assert section == pytest.approx(np.pi * 2.5**2, rel=0.25)


@pytest.mark.parametrize("share", [0.02, 0.05, 0.1])
def test_a_short_part_is_not_cut_off_below_the_tip_of_a_long_one(share):
    """The tip of a part that has hardly begun to grow does not hold back parts that need no front."""
    stub = np.maximum(SLAB, rod((22, 22, 5), (22, 22, 10.5), radius=2.0))
    hook = np.maximum(SLAB, rod((36, 22, 5), (36, 22, 15), (22, 22, 15), radius=1.5))
    alone, found = mean(stub, SLAB, share) > 0.0, mean(stub, hook, share) > 0.0
    assert alone[20:24, 20:24, 10:].sum() > 10
    assert found[20:24, 20:24, 10:13][alone[20:24, 20:24, 10:13]].all()
    assert not found[20:24, 20:24, 13:].any()


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_an_arch_opens_in_its_middle_and_retracts_to_both_sides(share):
    arch = np.maximum(SLAB, rod((9, 22, 8), (9, 22, 28), (35, 22, 28), (35, 22, 8)))
    found = mean(arch, SLAB, share)
    assert pieces(found) == 1
    # Each half is 18 cells high and 13 wide, along the axis of the rod.
    heights = [np.flatnonzero(found[x, 22] > 0.0)[-1] + 1.0 for x in (8, 35)]
    assert heights[0] == pytest.approx(heights[1], abs=1.01)
    if (1.0 - share) * 31.0 < 16.0:
        assert heights[0] == pytest.approx(10.0 + 34.0 * (1.0 - share), abs=3.0)


@pytest.mark.parametrize("share", [0.2, 0.35, 0.5, 0.65, 0.8])
def test_parts_that_cross_stay_in_one_piece(share):
    """A hook reaches across a pole of the other solid; what both fill there hangs free of the rest."""
    hook = np.maximum(SLAB, rod((8, 22, 8), (8, 22, 26), (36, 22, 26)))
    pole = np.maximum(SLAB, rod((27, 22, 8), (27, 22, 38)))
    assert pieces(np.minimum(hook, pole)) == 2
    assert pieces(mean(hook, pole, share)) == 1


@pytest.mark.parametrize("share", [0.3, 0.5])
def test_parts_that_are_connected_to_nothing_do_not_grow(share):
    """They have no place to grow from, and come with the mean of the distances."""
    apart = np.maximum(SLAB, rod((22, 22, 20), (22, 22, 36)))
    found = mean(SLAB, apart, share)
    assert not (found[:, :, 14:] > 0.0).any()
    assert (found[22, 22, 3:9] > 0.0).all()


POSTS = np.maximum(rod((9, 22, 4), (9, 22, 40)), rod((35, 22, 4), (35, 22, 40)))
RUNGS = [np.maximum(POSTS, rod((9, 22, height), (35, 22, height))) for height in (12, 32)]


@pytest.mark.parametrize("share", [0.1, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7, 0.9])
@pytest.mark.parametrize("exact", [False, True])
def test_posts_stay_connected_by_one_rung_or_the_other(share, exact):
    """Each rung is whole in the half of the time in which its solid weighs more."""
    volume = None
    if exact:
        ends = [float(np.clip(rung + 0.5, 0.0, 1.0).sum()) for rung in RUNGS]
        volume = (1.0 - share) * ends[0] + share * ends[1]
    found = mean(*RUNGS, share, volume)
    assert pieces(found) == 1
    whole, opened = (12, 32) if share <= 0.5 else (32, 12)
    assert (found[9:35, 22, whole] > 0.0).all()
    if min(share, 1.0 - share) <= 0.3:
        assert not (found[9:35, 22, opened] > 0.0).all()
    if exact:
        assert np.clip(found + 0.5, 0.0, 1.0).sum() == pytest.approx(volume, rel=0.01)
        # The posts keep their width; the rungs take up the difference.
        assert np.count_nonzero(found[:20, :, 22] > 0.0) == pytest.approx(
            np.count_nonzero(POSTS[:20, :, 22] > 0.0), abs=4
        )


@pytest.mark.parametrize("share", [0.3, 0.4, 0.45, 0.5])
def test_heavy_parts_are_no_links(share):
    """A block becomes two pads: held whole in between, it would have far too much volume."""
    x, y = np.meshgrid(np.arange(128) + 0.5, np.arange(128) + 0.5, indexing="ij")

    def box(low, high):
        return np.minimum(np.minimum(x - low[0], high[0] - x), np.minimum(y - low[1], high[1] - y))

    block = box((20, 44), (108, 84))
    pads = np.maximum(box((20, 44), (40, 84)), box((88, 44), (108, 84)))
    volume = (1.0 - share) * 3520.0 + share * 1600.0
    plain = np.clip(mean(block, pads, share) + 0.5, 0.0, 1.0).sum()
    assert plain < 1.15 * volume
    if share < 0.5:
        assert pieces(mean(block, pads, share, volume)) == 1


def test_the_volume_is_reached_where_solids_differ():
    """A rod that both solids share keeps its width; the balls next to it take up the difference."""
    common = rod((22, 22, 4), (22, 22, 40), radius=2.0)
    small, large = np.maximum(common, ball(6.0)), np.maximum(common, ball(12.0))
    plain = np.count_nonzero(mean(small, large, 0.5) > 0.0)
    found = mean(small, large, 0.5, volume=1.3 * plain)
    assert np.count_nonzero(found > 0.0) == pytest.approx(1.3 * plain, rel=0.02)
    assert (found[:, :, 36] > 0.0).sum() == (common[:, :, 36] > 0.0).sum()


@pytest.mark.parametrize("radius", [13.0, 12.5, 8.3])
def test_where_solids_do_not_differ_the_whole_surface_is_offset(radius):
    found = mean(ball(10.0), ball(10.0), 0.5, volume=4.0 / 3.0 * np.pi * radius**3)
    distances = np.linalg.norm(GRID - 22.0, axis=-1)[np.abs(found) < 0.5]
    assert np.abs(distances - radius).max() < 0.6
    assert distances.mean() == pytest.approx(radius, abs=0.1)


@pytest.mark.parametrize("share", [0.25, 0.75])
def test_distances_that_are_not_known_are_computed(share):
    """Beyond a cell, those given are a third too large."""
    balls = [np.where(np.abs(depth) > 1.0, 1.3 * depth, depth) for depth in (ball(8.0), ball(12.0))]
    found = mean(*balls, share)
    near = np.abs(found) < 1.0
    expected = 8.0 + 4.0 * share - np.linalg.norm(GRID - 22.0, axis=-1)
    assert np.abs(found - expected)[near].max() < 0.15


def test_only_links_become_thinner_where_that_is_enough():
    plain = mean(*RUNGS, 0.4)
    volume = 0.92 * np.clip(plain + 0.5, 0.0, 1.0).sum()
    found = mean(*RUNGS, 0.4, volume)
    assert np.clip(found + 0.5, 0.0, 1.0).sum() == pytest.approx(volume, rel=1e-3)
    np.testing.assert_allclose(found[9, 22, 20:24], POSTS[9, 22, 20:24], atol=1e-3)
    assert (found[22, 22, [12, 32]] < plain[22, 22, [12, 32]] - 0.3).all()
