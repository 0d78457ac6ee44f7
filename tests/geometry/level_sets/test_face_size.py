# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.level_sets.even_surface import even_surface
from convwass_addon.geometry.level_sets.face_size import with_face_size
from convwass_addon.geometry.level_sets.isosurface import surface_at_level
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.polygons import Polygons
from convwass_addon.geometry.remeshing.angle_smoothing import smallest_angles

CENTER = np.array([14.3, 13.1, 13.7])
CELLS = np.stack(np.meshgrid(*[np.arange(28) + 0.5] * 3, indexing="ij"), axis=-1)


def ball(place):
    return 10.0 - np.linalg.norm(place - CENTER, axis=-1)


def thin_ring(place):
    """Depth below the surface of a torus with radii 9 and 2."""
    along = place[..., 2] - CENTER[2]
    return 2.0 - np.hypot(np.linalg.norm((place - CENTER)[..., :2], axis=-1) - 9.0, along)


def density_and_even(depth):
    density = ndtr(depth(CELLS) / 0.76).astype(np.float32)
    return density, even_surface(surface_at_level(density, 0.5), density)


@pytest.mark.parametrize("size", [0.5, 0.8, 1.4, 2.0])
def test_the_number_of_faces_falls_with_the_square_of_their_size(size):
    density, even = density_and_even(ball)
    sized = with_face_size(even, density, size)
    assert len(sized.mesh.faces) == pytest.approx(len(even.mesh.faces) / size**2, rel=0.02)
    assert topology(sized.mesh).closed
    assert Connectivity.of(sized) == Connectivity(1, 0, 0)
    assert sized.mesh.volume == pytest.approx(even.mesh.volume, rel=1e-5)
    assert np.abs(ball(sized.mesh.vertices)).max() < 0.04 * max(size, 1.0)
    assert np.degrees(np.percentile(smallest_angles(sized.mesh.corners), 1)) > 20.0
    edges = np.linalg.norm(sized.mesh.corners - np.roll(sized.mesh.corners, 1, axis=1), axis=2)
    assert np.percentile(edges, 99) < 1.9 * np.median(edges)


def test_thin_parts_keep_their_topology_and_more_faces():
    density, even = density_and_even(thin_ring)
    sized = with_face_size(even, density, 3.0)
    assert topology(sized.mesh).closed
    assert Connectivity.of(sized) == Connectivity(1, 1, 0)
    assert 1.0 / 9.0 < len(sized.mesh.faces) / len(even.mesh.faces) < 0.6


def test_larger_faces_can_be_joined_to_quads():
    density, even = density_and_even(ball)
    polygons = Polygons.of_quads(with_face_size(even, density, 1.5).mesh)
    sides = np.diff(polygons.starts, append=len(polygons.corners))
    assert (sides == 4).mean() > 0.55


def test_a_size_of_one_changes_nothing():
    density, even = density_and_even(ball)
    assert with_face_size(even, density, 1.0) is even
