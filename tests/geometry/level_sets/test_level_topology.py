# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Topology computed on cells agrees with that of the surface."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.ndimage import gaussian_filter

from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.level_sets.isosurface import surface_at_level
from convwass_addon.geometry.level_sets.level_topology import (
    euler_number,
    euler_numbers_within,
    hollows_below,
    pieces_above,
)


def euler_of_surface(density, level):
    mesh = surface_at_level(density, level).mesh
    return len(mesh.vertices) - len(mesh.faces) // 2


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**31 - 1), st.sampled_from([0.7, 1.0, 2.0]), st.floats(0.3, 0.9))
def test_euler_number_of_noise_agrees_with_its_surface(seed, blur, share):
    density = gaussian_filter(np.random.default_rng(seed).random((20, 18, 16)), blur, mode="constant")
    level = float(np.quantile(density, share))
    # Two values inside an ambiguous cube may be too close for single precision.
    assert euler_number(density, level) == pytest.approx(euler_of_surface(density, level), abs=2)


def test_the_change_in_a_window_is_the_change_of_the_euler_number():
    density = gaussian_filter(np.random.default_rng(2).random((30, 28, 26)), 1.0, mode="constant")
    level = float(np.quantile(density, 0.7))
    changed = density.copy()
    changed[12:17, 12:16, 11:15] *= 0.6
    windows = np.stack([density[8:21, 8:21, 8:21], changed[8:21, 8:21, 8:21]])
    before, after = euler_numbers_within(windows, level)
    assert after != before
    assert after - before == euler_number(changed, level) - euler_number(density, level)


def test_components_and_hollows_of_boxes():
    density = np.zeros((20, 12, 12))
    density[2:9, 2:9, 2:9] = 1.0
    density[4:7, 4:7, 4:7] = 0.2
    density[12:18, 3:8, 3:8] = 1.0
    assert pieces_above(density, 0.5).count == 2
    assert hollows_below(density, 0.5).count == 1
    assert hollows_below(density, 0.5).labels[5, 5, 5] == 1
    assert hollows_below(density, 0.1).count == 0
    # Cut off here, the cavity reaches the boundary of the grid.
    assert hollows_below(density[4:], 0.5).count == 0
    assert Connectivity.of(surface_at_level(density, 0.5)) == Connectivity(2, 0, 1)


@pytest.mark.parametrize(("beside", "pieces"), [(0.45, 1), (0.05, 2)])
def test_boxes_touching_at_an_edge_are_connected_like_their_surface(beside, pieces):
    """This depends on the values next to the edge."""
    density = np.zeros((14, 14, 8))
    density[2:7, 2:7, 2:6] = density[7:12, 7:12, 2:6] = 0.8
    density[2:7, 7:12, 2:6] = density[7:12, 2:7, 2:6] = beside
    assert pieces_above(density, 0.5).count == pieces
    assert Connectivity.of(surface_at_level(density, 0.5)).pieces == pieces


def test_parts_of_a_grid_add_up():
    density = np.random.default_rng(3).random((9, 7, 8))
    whole = euler_numbers_within(density[None], 0.6)[0]
    parts = [density[:5], density[4:]]
    # Every cube between cells belongs to one part.
    alone = [euler_numbers_within(part[None], 0.6)[0] for part in parts]
    np.testing.assert_allclose(sum(alone), whole)
    np.testing.assert_allclose(euler_numbers_within(np.stack(parts), 0.6), alone)
