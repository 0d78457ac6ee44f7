# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.ndimage import gaussian_filter

from convwass_addon.errors import InputError
from convwass_addon.geometry.edges import topology
from convwass_addon.geometry.isosurface import surface_at_level, surface_enclosing


def cone(shape, center):
    """A density that falls off linearly from its center, so that its level sets are spheres of known radius."""
    cells = np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in shape], indexing="ij"), axis=-1)
    return np.maximum(20.0 - np.linalg.norm(cells - center, axis=-1), 0.0)


def test_a_sphere_is_where_it_should_be():
    center = np.array([14.2, 16.9, 18.4])
    mesh = surface_at_level(cone((30, 34, 38), center), 10.0).mesh
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - center, axis=1), 10.0, atol=0.03)
    assert topology(mesh).closed
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * 1000, rel=0.01)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.02, 0.5), st.floats(1.0, 3.0))
def test_any_surface_is_closed_outward_and_encloses_what_was_asked_for(seed, share, blur):
    density = gaussian_filter(np.random.default_rng(seed).random((18, 20, 16)) ** 4, blur, mode="constant")
    mesh = surface_enclosing(density, share * density.size).mesh
    assert topology(mesh).open_edges == 0
    assert mesh.volume == pytest.approx(share * density.size, rel=0.01)


def test_a_solid_at_the_wall_is_closed():
    mesh = surface_at_level(cone((20, 20, 20), np.array([0.0, 10.0, 10.0])), 8.0).mesh
    assert topology(mesh).closed
    assert mesh.volume > 0


def test_a_plateau_at_the_level_makes_no_double_points():
    density = np.zeros((12, 12, 12))
    density[3:9, 3:9, 3:9] = 1.0
    density[4:8, 4:8, 4:8] = 2.0
    assert topology(surface_at_level(density, 1.0).mesh).closed


@pytest.mark.parametrize("level", [0.0, 1.0, -1.0])
def test_levels_out_of_reach_are_refused(level):
    with pytest.raises(InputError, match="No surface"):
        surface_at_level(np.pad(np.ones((3, 3, 3)), 2), level)


@pytest.mark.parametrize("volume", [0.0, 28.0])
def test_volumes_out_of_reach_are_refused(volume):
    with pytest.raises(InputError, match="cannot enclose"):
        surface_enclosing(np.pad(np.ones((3, 3, 3)), 2), volume)
