# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.solids.exact_depths import exact_depths


@pytest.mark.parametrize("shape", [(34, 36, 35), (60, 55)])
def test_distances_from_a_ball_are_exact_from_its_signs_and_the_cells_next_to_it(shape):
    center, radius = np.array(shape) / 2.0 + 0.3, 10.4
    cells = np.stack(np.meshgrid(*[np.arange(n) + 0.0 for n in shape], indexing="ij"), axis=-1)
    true = radius - np.linalg.norm(cells - center, axis=-1)
    rough = np.where(np.abs(true) < 1.6, true, 9.0 * np.sign(true)).astype(np.float32)
    chosen = np.flatnonzero((np.abs(true) > 1.6) & (np.abs(true) < 8.0))
    assert np.abs(exact_depths(rough, chosen) - true.ravel()[chosen]).max() < 0.1


def test_next_to_an_edge_distances_are_those_to_the_edge():
    cells = np.stack(np.meshgrid(np.arange(40.0), np.arange(40.0), indexing="ij"), axis=-1)
    outside = np.maximum(cells - 20.2, 0.0)
    true = np.where(
        (cells < 20.2).all(axis=-1),
        np.minimum(*np.moveaxis(20.2 - cells, -1, 0)),
        -np.hypot(*np.moveaxis(outside, -1, 0)),
    )
    chosen = np.array([np.ravel_multi_index((26, 26), (40, 40)), np.ravel_multi_index((25, 10), (40, 40))])
    assert exact_depths(true, chosen) == pytest.approx(true.ravel()[chosen], abs=0.15)


def test_without_a_surface_distances_stay_as_they_are():
    empty = np.full((8, 8, 8), -3.0)
    assert exact_depths(empty, np.array([5, 100])) == pytest.approx([-3.0, -3.0])


def test_distances_end_where_those_of_the_grid_end():
    """A clipped distance keeps parts whose counterpart is far away."""
    cells = np.arange(60.0)
    depth = np.clip(np.broadcast_to(10.3 - cells, (8, 60)), -12.0, 12.0)
    found = exact_depths(depth, np.array([np.ravel_multi_index((4, x), depth.shape) for x in (18, 50)]))
    assert found == pytest.approx([-7.7, -12.0], abs=0.05)
