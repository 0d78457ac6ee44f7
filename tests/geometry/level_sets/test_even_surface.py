# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation
from scipy.special import ndtr

from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.level_sets.even_surface import even_surface, straightened
from convwass_addon.geometry.level_sets.isosurface import surface_at_level, surface_enclosing
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.normals import vertex_normals
from convwass_addon.geometry.solids.occupancy import occupancy
from tests.shapes import box, smallest_angles

# Of the blur with which surfaces are read, and of a cell itself.
BLUR = 0.76
CENTER = np.array([22.3, 21.1, 20.7])
CELLS = np.stack(np.meshgrid(*[np.arange(44) + 0.5] * 3, indexing="ij"), axis=-1)
# No axis of the grid.
AXIS = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)


def ball(place, radius=14.0, center=CENTER):
    return radius - np.linalg.norm(place - center, axis=-1)


def ring(place):
    """Depth below the surface of a torus with radii 12 and 5."""
    along = (place - CENTER) @ AXIS
    outward = np.linalg.norm(place - CENTER - along[..., None] * AXIS, axis=-1)
    return 5.0 - np.hypot(outward - 12.0, along)


def meshed(depth):
    """A solid's blurred density, its surface by marching cubes, and the even one."""
    density = ndtr(depth(CELLS) / BLUR).astype(np.float32)
    drawn = surface_at_level(density, 0.5)
    return drawn, even_surface(drawn, density)


@pytest.mark.parametrize(("depth", "handles"), [(ball, 0), (ring, 1)])
def test_solids_of_known_radii(depth, handles):
    drawn, even = meshed(depth)
    assert topology(even.mesh).closed
    assert Connectivity.of(even) == Connectivity(1, handles, 0)
    assert even.mesh.volume == pytest.approx(drawn.mesh.volume, rel=1e-4)
    assert np.abs(depth(even.mesh.vertices)).max() < 0.02
    # Marching cubes: below one degree, and edges of a hundredth of a cell.
    assert np.percentile(smallest_angles(even.mesh), 1) > 30.0
    assert np.percentile(smallest_angles(drawn.mesh), 1) < 2.0
    edges = np.linalg.norm(even.mesh.corners - np.roll(even.mesh.corners, 1, axis=1), axis=2)
    assert edges.min() > 0.25 and edges.max() < 1.8


def test_normals_of_a_ball_are_smooth():
    """Those of the triangles are off by a degree where marching cubes draws them, which shows as ripples."""
    drawn, even = meshed(ball)
    off = [
        np.degrees(np.arccos(np.einsum("nd,nd->n", vertex_normals(mesh.vertices, mesh.faces), outward)))
        for mesh in (drawn.mesh, even.mesh)
        for outward in [(mesh.vertices - CENTER) / np.linalg.norm(mesh.vertices - CENTER, axis=1, keepdims=True)]
    ]
    assert off[1].mean() < 0.6 * off[0].mean()
    assert off[1].max() < 2.5


def test_two_balls_that_nearly_touch_are_one_piece_or_two_as_marching_cubes_has_them():
    def touching(place):
        return np.maximum(ball(place, 8.0, CENTER - 8.5 * AXIS), ball(place, 8.0, CENTER + 8.5 * AXIS))

    density = ndtr(touching(CELLS) / BLUR).astype(np.float32)
    pieces = []
    for level in (0.3, 0.35, 0.4, 0.45, 0.5):
        drawn = surface_at_level(density, level)
        even = even_surface(drawn, density)
        assert topology(even.mesh).closed
        assert Connectivity.of(even) == Connectivity.of(drawn)
        pieces.append(Connectivity.of(even).pieces)
    assert set(pieces) == {1, 2}


def test_edges_of_a_turned_box_are_as_sharp_as_those_of_marching_cubes():
    angles, half = (0.4, 0.3, 0.2), np.array([13.0, 10.0, 7.5])
    solid = box(2.0 * half, CENTER, angles)
    density = gaussian_filter(occupancy(solid.corners, (44, 44, 44)), 0.7)
    drawn = surface_enclosing(density, solid.volume)
    even = even_surface(drawn, density)
    waves, blunt = [], []
    for surface in (drawn, even):
        places = Rotation.from_euler("xyz", angles).inv().apply(surface.mesh.vertices - CENTER)
        farthest = np.sort(np.abs(places) - half, axis=1)
        waves.append(farthest[farthest[:, 1] < -2.0, 2].std())
        blunt.append(-farthest[farthest[:, 1] > -0.7, 2].mean())
    assert waves[1] < 0.5 * waves[0]
    assert blunt[1] < blunt[0] + 0.03
    assert even.mesh.volume == pytest.approx(solid.volume, rel=2e-3)


def test_quads_are_pairs_of_triangles_that_share_their_first_diagonal():
    _, even = meshed(ball)
    first, second = even.mesh.faces[::2], even.mesh.faces[1::2]
    np.testing.assert_array_equal(first[:, [0, 2]], second[:, [0, 1]])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_single_cell_keeps_its_side(sign):
    """A crumb, and a bubble."""
    density = np.full((9, 9, 9), 0.5 - 0.4 * sign, np.float32)
    density[4, 4, 4] = 0.5 + 0.05 * sign
    density = np.pad(density, 3)
    drawn = surface_at_level(density, 0.5)
    assert Connectivity.of(even_surface(drawn, density)) == Connectivity.of(drawn)


def test_solids_at_the_wall_of_the_grid_are_closed():
    density = ndtr(ball(CELLS[:, :, :30], 14.0, (0.0, 20.0, 20.0)) / BLUR)
    even = even_surface(surface_at_level(density, 0.5), density)
    assert topology(even.mesh).closed
    assert np.percentile(smallest_angles(even.mesh), 1) > 20.0


def test_blurred_solids_become_distances():
    depth = np.linspace(-1.0, 1.0, 21)[:, None, None]
    np.testing.assert_allclose(
        straightened(0.3 * 2.0 * ndtr(depth / BLUR), 0.3) * np.sqrt(np.pi / 2) * BLUR, depth, atol=2e-2
    )
