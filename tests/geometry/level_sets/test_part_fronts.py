# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from convwass_addon.geometry.level_sets.part_fronts import (
    Along,
    PartFronts,
    linked_components,
    separate_parts,
    shared_core,
)

SHAPE = (30, 12, 40)


def filled(*boxes):
    """Cells in boxes, each given by its first cell and the one after its last."""
    cells = np.zeros(SHAPE, bool)
    for low, high in boxes:
        cells[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = True
    return cells


SLAB = filled(((1, 1, 1), (29, 11, 8)))
POLE = filled(((8, 6, 8), (9, 7, 33)))
BRANCH = filled(((9, 6, 14), (15, 7, 15)))
ARCH = filled(((4, 6, 8), (5, 7, 20)), ((4, 6, 20), (25, 7, 21)), ((24, 6, 8), (25, 7, 20)))


def separated(cells, depth=1.0, length=10.0, core=SLAB):
    """Parts of a largest depth and a length."""
    return separate_parts(
        cells | core, core, linked_components(core), np.where(cells, depth, -1.0), np.where(cells, length, -1.0), 40.0
    )


def fronts(cells, core=SLAB):
    """The fronts of a part and their box."""
    (part,) = separated(cells, core=core)
    return PartFronts.of(core | cells, core, part), part.box


def on_grid(values, box):
    found = np.zeros(SHAPE, values.dtype)
    found[box] = values
    return found


def test_distances_follow_a_part_and_its_reach_is_its_end():
    along = Along.of(POLE | BRANCH, SLAB)
    distance, reach = along.distance, along.reach
    np.testing.assert_allclose(distance[8, 6, 8:33], np.arange(1, 26))
    assert (reach[8, 6, 8:33] == 25.0).all()
    # The branch leaves the pole at a distance of 6 or 7 and ends five cells further.
    assert reach[11:15, 6, 14] == pytest.approx(distance[14, 6, 14])
    assert distance[14, 6, 14] == pytest.approx(7 + 5 + np.sqrt(2) - 1, abs=0.5)
    assert not distance[SLAB].any()
    assert np.isinf(distance[20, 6, 30])


def test_an_arch_is_farthest_in_its_middle():
    along = Along.of(ARCH, SLAB)
    distance, reach = along.distance, along.reach
    top = distance[5:24, 6, 20]
    assert abs(int(np.argmax(top)) - 9) <= 1
    assert reach[4, 6, 8:20] == pytest.approx(top.max(), abs=1.0)
    assert reach[24, 6, 10] == pytest.approx(reach[4, 6, 10], abs=1.0)


@pytest.mark.parametrize("weight", [0.25, 0.5, 0.75])
def test_a_front_is_at_its_share_of_a_part(weight):
    part, box = fronts(POLE)
    along = on_grid(part.heights(weight, 1.0), box)[8, 6, 10:31]
    assert np.interp(0.0, -along, np.arange(10, 31) + 0.5 - 8.0) == pytest.approx(25.0 * weight, abs=0.6)
    assert on_grid(part.hold, box)[8, 6, 13:20].max() < 0.1


def test_the_front_of_a_layer_is_held_back():
    layer = filled(((1, 1, 8), (29, 11, 15)))
    part, box = fronts(layer)
    assert on_grid(part.hold, box)[15, 6, 10:13] == pytest.approx(4.0, abs=0.1)


def test_a_separate_part_is_loose():
    apart = filled(((20, 4, 20), (24, 8, 24)))
    part, box = fronts(apart)
    np.testing.assert_array_equal(on_grid(part.loose, box), apart)


def test_parts_are_separated_if_that_is_less_work_than_the_whole_grid():
    long = np.zeros((200, 60, 60), bool)
    first, second, third = ((slice(at, at + 4), slice(28, 32), slice(28, 32)) for at in (40, 110, 170))
    far = np.zeros_like(long)
    for box in (first, second, third):
        long[box] = True
    for box in (first, third):
        far[box] = True
    parts = separate_parts(
        long,
        np.zeros_like(long),
        np.zeros(long.shape, np.int32),
        np.where(long, 1.0, -1.0),
        np.where(far, 10.0, -1.0),
        40.0,
    )
    assert [int(part.cells.sum()) for part in parts] == [64, 64]
    for part, own in zip(parts, (first, third), strict=True):
        found = np.zeros_like(long)
        found[part.box] = part.cells
        assert found[own].all()
    crowded = np.zeros((40, 40, 40), bool)
    crowded[5:35:3, 5:35:3, 20] = True
    nowhere, (row, column, _) = np.zeros_like(crowded), np.argwhere(crowded)[0]
    beyond = np.where(crowded, 10.0, -1.0)
    beyond[row, column] = 2.0
    (whole,) = separate_parts(crowded, nowhere, nowhere.astype(np.int32), np.where(crowded, 1.0, -1.0), beyond, 40.0)
    # The first part is too short for a front.
    np.testing.assert_array_equal(whole.cells, crowded & (beyond > 2.0))


@pytest.mark.parametrize(
    ("depth", "length", "without"), [(1.0, 5.0, 0.0), (1.0, 4.0, 0.5), (2.0, 4.0, 0.75), (3.0, 6.0, 0.5)]
)
def test_fronts_of_short_and_of_stout_parts_count_less(depth, length, without):
    (part,) = separated(POLE, depth, length)
    assert part.without_front[part.cells] == pytest.approx(without, abs=1e-6)
    held = PartFronts.of(SLAB | POLE, SLAB, part).hold - PartFronts.of(SLAB | POLE, SLAB, *separated(POLE)).hold
    assert on_grid(held, part.box)[8, 6, 20] == pytest.approx(25.0 * without, abs=0.1)


@pytest.mark.parametrize(("depth", "length"), [(0.5, 2.9), (2.0, 3.0), (4.0, 6.0), (20.0, 30.0)])
def test_short_and_stout_parts_have_no_front(depth, length):
    assert not separated(POLE, depth, length)


def test_of_parts_that_reach_as_far_as_distances_are_known_stoutness_is_not():
    (part,) = separated(POLE, 30.0, 40.0)
    assert not part.without_front[part.cells].any()


def test_parts_that_a_thin_layer_connects_are_judged_by_themselves():
    layer = filled(((1, 1, 8), (29, 11, 10)))
    # So close to each other that each is around the tip of the other one.
    pole, block = filled(((4, 4, 10), (8, 8, 20))), filled(((11, 1, 10), (28, 11, 15)))
    cells = layer | pole | block
    depth = distance_transform_edt(cells | SLAB) - 0.5
    beyond = distance_transform_edt(~SLAB) - 0.5
    (part,) = separate_parts(cells | SLAB, SLAB, linked_components(SLAB), depth, beyond, 40.0)
    found = on_grid(np.where(part.cells, part.without_front, np.float32(-1.0)), part.box)
    assert (found[pole] == 0.0).all()
    assert (found[block & (np.arange(SHAPE[0]) > 16)[:, None, None]] == 1.0).all()
    np.testing.assert_array_equal(on_grid(part.cells, part.box), cells)
    assert not on_grid(part.fronted, part.box)[25:].any()


def test_the_core_is_the_largest_common_part():
    crossing = filled(((7, 5, 20), (10, 8, 23)))
    np.testing.assert_array_equal(shared_core([SLAB | crossing, SLAB | crossing | POLE]), SLAB)
    assert shared_core([SLAB, POLE]) is None


CEILING = filled(((1, 1, 34), (29, 11, 38)))
BEAM = filled(((13, 4, 8), (16, 7, 34)))


def test_a_part_between_components_of_the_core_is_a_link():
    core = SLAB | CEILING
    (link,) = separated(BEAM, depth=1.5, core=core)
    # Half of its thickness, everywhere.
    np.testing.assert_array_equal(link.links[link.cells], np.float32(1.5))
    (pole,) = separated(POLE, core=core)
    assert not pole.links.any()
    (same,) = separated(ARCH, core=SLAB)
    assert not same.links.any()


def test_links_in_the_box_of_another_one_do_not_belong_to_it():
    beside = filled(((19, 4, 8), (22, 7, 34)))
    for link, own in zip(separated(BEAM | beside, depth=1.5, core=SLAB | CEILING), (BEAM, beside), strict=True):
        np.testing.assert_array_equal(on_grid(link.links > 0.0, link.box), own)


def test_links_are_whole_at_their_own_weight_and_thinned_in_their_middle():
    part, box = fronts(BEAM, SLAB | CEILING)
    heights = on_grid(part.heights(0.5, 1.0, 3.0), box)[14, 5, 8:34]
    assert (heights > 3.0).all()
    ordinary = on_grid(part.heights(0.5, 0.5), box)[14, 5, 8:34]
    # At half of the weight, half of either end is there.
    assert np.count_nonzero(ordinary > 0.0) == pytest.approx(13, abs=2)
    thins = on_grid(part.thins, box)[14, 5, 8:34]
    assert thins[12] == pytest.approx(1.0, abs=0.05)
    assert thins[0] < 0.5
    assert (np.diff(thins[:4]) > 0.0).all()
