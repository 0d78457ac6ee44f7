# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.grids.coarser_grid import CoarserGrid, doubled, halved

RANDOM = np.random.default_rng(6)


@pytest.mark.parametrize("shape", [(8, 6, 4), (7, 5, 3, 2), (1, 1, 1)])
def test_sums_are_kept(shape):
    field = RANDOM.uniform(size=shape)
    np.testing.assert_allclose(halved(field).sum() * 8.0, field.sum())
    assert halved(field).shape[:3] == tuple((size + 1) // 2 for size in shape[:3])


def test_linear_fields_stay_linear_inside():
    centers = np.moveaxis(np.indices((10, 8, 12)), 0, -1) + 0.5
    field = centers @ (1.0, -2.0, 0.5)
    np.testing.assert_allclose(
        halved(field), 2.0 * (np.moveaxis(np.indices((5, 4, 6)), 0, -1) + 0.5) @ (1.0, -2.0, 0.5)
    )
    found = doubled(halved(field), field.shape)
    np.testing.assert_allclose(found[1:-1, 1:-1, 1:-1], field[1:-1, 1:-1, 1:-1])


def test_odd_sides_are_restored():
    assert doubled(np.ones((4, 3, 2, 5)), (7, 5, 3)).shape == (7, 5, 3, 5)


def test_other_axes_are_left_alone():
    field = RANDOM.uniform(size=(6, 5, 4))
    flat = halved(field, dimensions=2)
    assert flat.shape == (3, 3, 4)
    np.testing.assert_allclose(flat[1, 1], field[2:4, 2:4].mean(axis=(0, 1)))


@pytest.mark.parametrize(("most", "cell"), [(40, 1), (39, 2), (20, 2), (13, 4)])
def test_a_grid_is_halved_until_it_has_few_enough_cells(most, cell):
    grid = CoarserGrid((40, 12, 9), most)
    assert grid.cell == cell
    assert grid.means(np.ones((40, 12, 9), np.float32)).shape == tuple(-(-size // cell) for size in (40, 12, 9))


def test_linear_fields_are_interpolated_exactly():
    grid = CoarserGrid((32, 16), 8)
    field = np.add.outer(np.arange(32.0), 2.0 * np.arange(16.0))
    found = grid.interpolated(grid.means(field))
    np.testing.assert_allclose(found[4:-4, 4:-4], field[4:-4, 4:-4], atol=1e-5)


def test_a_cell_is_held_by_the_coarser_cell_around_it():
    cells = np.zeros((32, 16), bool)
    cells[13, 6] = True
    np.testing.assert_array_equal(np.argwhere(CoarserGrid(cells.shape, 8).holding(cells)), [[3, 1]])
    assert CoarserGrid(cells.shape, 32).holding(cells) is cells


def test_values_within_cells_depend_on_no_others():
    grid = CoarserGrid((32, 32), 8)
    known = np.zeros((8, 8), bool)
    known[2:6, 2:6] = True
    within = grid.within(known)
    assert within[12:20, 12:20].all()
    one, other = (grid.interpolated(np.where(known, 1.0, outside)) for outside in (0.0, 1e3))
    np.testing.assert_array_equal(one[within], 1.0)
    np.testing.assert_array_equal(other[within], 1.0)


@pytest.mark.parametrize("shape", [(150, 90, 100), (37, 22, 19), (40, 16)])
def test_parts_of_a_grid_are_the_same_as_the_whole(shape):
    """Means are taken slab by slab, and values are interpolated in boxes, also at odd sides."""
    grid, field = CoarserGrid(shape, 10), RANDOM.uniform(size=shape).astype(np.float32)
    means = field
    while max(means.shape) > 10:
        means = halved(means, len(shape))
    np.testing.assert_array_equal(grid.means(field), means)
    whole = grid.interpolated(means)
    for box in ((slice(5, 31), slice(0, 13), slice(3, 4)), (slice(1, shape[0]), slice(9, shape[1]), slice(18, None))):
        np.testing.assert_array_equal(grid.interpolated(means, box[: len(shape)]), whole[box[: len(shape)]])


def test_a_box_of_coarser_cells_ends_with_the_grid():
    assert CoarserGrid((37, 22), 10).finer_box((slice(2, 10), slice(0, 3))) == (slice(8, 37), slice(0, 12))
