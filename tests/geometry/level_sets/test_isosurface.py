# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from scipy.ndimage import gaussian_filter

from convwass_addon.errors import InputError
from convwass_addon.geometry.level_sets.isosurface import surface_at_level, surface_enclosing
from convwass_addon.geometry.meshes.edges import topology
from tests.shapes import piece_count


def cone(shape, center):
    """A density that decreases linearly from its center, so that its level sets are spheres of known radius."""
    cells = np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in shape], indexing="ij"), axis=-1)
    return np.maximum(20.0 - np.linalg.norm(cells - center, axis=-1), 0.0)


def test_a_sphere_has_the_correct_place_and_size():
    center = np.array([14.2, 16.9, 18.4])
    mesh = surface_at_level(cone((30, 34, 38), center), 10.0).mesh
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - center, axis=1), 10.0, atol=0.03)
    assert topology(mesh).closed
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * 1000, rel=0.01)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.02, 0.5), st.floats(1.0, 3.0))
def test_any_surface_is_closed_outward_and_has_the_requested_volume(seed, share, blur):
    density = gaussian_filter(np.random.default_rng(seed).random((18, 20, 16)) ** 4, blur, mode="constant")
    mesh = surface_enclosing(density, share * density.size).mesh
    assert topology(mesh).open_edges == 0
    assert mesh.volume == pytest.approx(share * density.size, rel=0.01)


def test_a_solid_at_the_boundary_is_closed():
    mesh = surface_at_level(cone((20, 20, 20), np.array([0.0, 10.0, 10.0])), 8.0).mesh
    assert topology(mesh).closed
    assert mesh.volume > 0


def blocks(shape, cells, values, seed):
    """Cubes of `cells` cells per side with constant values, like blocky occupancies."""
    return np.kron(np.random.default_rng(seed).choice(values, shape), np.ones((cells, cells, cells)))


def stepped():
    """Nested cubes with two values, 22 and 14 cells per side."""
    density = np.zeros((30, 30, 30))
    density[4:26, 4:26, 4:26] = 0.5
    density[8:22, 8:22, 8:22] = 1.0
    return density


def has_double_points(mesh):
    return len(np.unique(mesh.vertices, axis=0)) < len(mesh.vertices)


@pytest.mark.parametrize("level", [0.5, 0.5 * (1 - 1e-9), 0.5 * (1 + 1e-9)])
@pytest.mark.parametrize("offset", [0, 290])
def test_a_plateau_at_the_level_makes_no_duplicate_points(level, offset):
    density = np.zeros((offset + 30, 30, 30))
    density[offset:] = stepped()
    mesh = surface_at_level(density, level).mesh
    found = topology(mesh)
    assert found.closed
    assert (piece_count(mesh), found.euler) == (1, 2)
    assert not has_double_points(mesh)


def test_a_plateau_counts_as_outside_at_its_own_level_and_as_inside_below():
    """Vertices lie on edges between samples: a cube of n samples extends from n - 1 cells to nearly n + 1."""
    at, below = (surface_at_level(stepped(), level).mesh for level in (0.5, 0.5 * (1 - 1e-9)))
    np.testing.assert_allclose(np.ptp(at.bounds, axis=0), 15.0, atol=2e-3)
    np.testing.assert_allclose(np.ptp(below.bounds, axis=0), 21.0, atol=2e-3)
    # First a box with a slab of almost one cell on each face but not at its edges, then a nearly complete box.
    assert at.volume == pytest.approx(13**3 + 6 * 13**2 + 12 * 13 / 2 + 8 / 6, rel=1e-3)
    assert below.volume == pytest.approx(21**3, rel=1e-3)


@pytest.mark.parametrize("level", [0.5, 1.0, 1.5])
def test_cells_symmetric_about_the_level_give_a_closed_surface(level):
    """Ambiguous faces: with equal values inside and outside, neighboring cubes must still agree."""
    mesh = surface_at_level(blocks((24, 24, 24), 1, [0.0, 1.0, 2.0], seed=1), level).mesh
    assert topology(mesh).closed
    assert not has_double_points(mesh)


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_the_unit_of_the_density_does_not_matter(scale):
    density = gaussian_filter(np.random.default_rng(3).random((16, 16, 16)), 1.5)
    expected = surface_at_level(density, 0.5).mesh
    mesh = surface_at_level(density * scale, 0.5 * scale).mesh
    np.testing.assert_array_equal(mesh.faces, expected.faces)
    np.testing.assert_allclose(mesh.vertices, expected.vertices, atol=1e-4)


def test_cells_far_above_the_level_get_distinct_vertices():
    """Next to such a cell, all vertices are close to the outside sample, which float32 must still resolve."""
    density = 10.0 ** -blocks((20, 20, 20), 1, np.linspace(0.0, 8.0, 50), seed=2)
    mesh = surface_at_level(density, 1e-6).mesh
    assert topology(mesh).open_edges == 0
    assert not has_double_points(mesh)


@pytest.mark.parametrize("volume", [2200, 2500, 3200, 9300, 10000, 10600])
def test_volume_of_a_density_of_two_values(volume):
    mesh = surface_enclosing(stepped() if volume > 3000 else np.where(stepped() == 1.0, 1.0, 0.0), volume).mesh
    assert topology(mesh).closed
    assert mesh.volume == pytest.approx(volume, rel=2e-3)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.95))
@example(seed=15953, share=0.05)
def test_volume_of_blocks_of_one_value(seed, share):
    """Between the only value and the surrounding zero, there is nothing to count."""
    density = blocks((4, 5, 4), 4, [0.0, 2.5], seed)
    # Blocks that touch lose less at the highest level, and gain less at the lowest one, than single ones.
    least, most = (surface_at_level(density, level).mesh.volume for level in (2.49, 0.01))
    volume = least + share * (min(most, 0.95 * np.count_nonzero(density)) - least)
    assert surface_enclosing(density, volume).mesh.volume == pytest.approx(volume, rel=2e-3)


@pytest.mark.parametrize(
    ("volume", "nearest"), [(2.0, 13**3), (4000.0, 3290.0), (6000.0, 3290.0), (7000.0, 9261.0), (9000.0, 9261.0)]
)
def test_the_nearest_possible_volume_is_returned_at_jumps(volume, nearest):
    """Beyond the inner cube, 13 cells per side, it grows to 3290; then to the outer cube with 21 cells per side."""
    surface = surface_enclosing(stepped(), volume)
    assert surface.mesh.volume == pytest.approx(nearest, rel=1e-3)
    assert topology(surface.mesh).closed


def test_single_precision_is_accepted_unchanged():
    density = stepped().astype(np.float32)
    assert surface_enclosing(density, 2.0).mesh.volume == pytest.approx(13**3, rel=1e-3)


@pytest.mark.parametrize("level", [0.0, 1.0, -1.0])
def test_levels_out_of_reach_are_refused(level):
    with pytest.raises(InputError, match="No surface"):
        surface_at_level(np.pad(np.ones((3, 3, 3)), 2), level)


@pytest.mark.parametrize("volume", [0.0, 28.0])
def test_volumes_out_of_reach_are_refused(volume):
    with pytest.raises(InputError, match="cannot enclose"):
        surface_enclosing(np.pad(np.ones((3, 3, 3)), 2), volume)
