# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from convwass_addon.geometry.level_sets.dual_surface import dual_surface
from convwass_addon.geometry.level_sets.isosurface import surface_at_level
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import piece_count


def dual_of(density, level):
    """The surface that marching cubes draws, with samples at integers, and its dual."""
    drawn = surface_at_level(density, level).mesh.moved([-0.5] * 3)
    return drawn, dual_surface(drawn, density > level)


def triangulated(dual):
    return TriangleMesh.from_arrays(
        dual.points, np.concatenate([dual.quads[:, [0, 1, 2]], dual.quads[:, [0, 2, 3]], dual.triangles])
    )


@pytest.mark.parametrize("blur", [0.0, 0.4, 0.7, 1.2])
@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_noise_keeps_its_topology_and_every_edge_has_two_faces(blur, share):
    """Most cubes of noise are ambiguous, and hundreds of its patches are tubes or share two segments with another."""
    noise = gaussian_filter(np.random.default_rng(7).random((20, 21, 22)), blur)
    drawn, dual = dual_of(np.pad(noise, 1), float(np.quantile(noise, share)))
    mesh = triangulated(dual)
    expected, found = topology(drawn), topology(mesh)
    assert expected.closed and found.closed
    assert found.euler == expected.euler
    assert piece_count(mesh) == piece_count(drawn)


def test_a_sphere_has_a_quad_for_every_crossed_edge():
    places = np.stack(np.meshgrid(*[np.arange(24)] * 3, indexing="ij"), axis=-1)
    center = np.array([11.3, 12.1, 11.7])
    drawn, dual = dual_of(np.maximum(20.0 - np.linalg.norm(places - center, axis=-1), 0.0), 12.0)
    assert not len(dual.triangles)
    assert len(dual.quads) == len(drawn.vertices)
    assert len(dual.points) == len(dual.quads) + 2
    assert ((dual.points >= dual.cubes) & (dual.points <= dual.cubes + 1)).all()
    mesh = triangulated(dual)
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * 8**3, rel=0.03)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - center, axis=1), 8.0, atol=0.1)
