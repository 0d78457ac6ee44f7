# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.applications.densities.density_pieces import on_same_pieces, piece
from convwass_addon.applications.densities.surface_densities import density_surface, distribution
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.transport.pieces import piece_masses
from tests.shapes import ball, joined
from tests.transport.spheres import icosphere

# A ball of 400 vertices around the origin, one of 300 around (5, 0, 0), and a loose vertex.
_MESH = joined(ball(1.0, points=400), ball(0.7, (5, 0, 0), points=300))
BALLS = density_surface(TriangleMesh.from_arrays(np.concatenate([_MESH.vertices, [(0, 9, 0)]]), _MESH.faces))


def on(large, small, seed=0):
    """Density of random values with the given masses on the two balls."""
    values = np.random.default_rng(seed).random(BALLS.shape) + 0.1
    values[-1] = 5.0
    for label, mass in ((0, large), (1, small)):
        own = BALLS.pieces == label
        values[own] *= mass / (values * BALLS.weights)[own].sum()
    return distribution(values, BALLS, "a")


def refusal(first, second, match=False):
    with pytest.raises(InputError) as caught:
        on_same_pieces(np.stack([first, second]), ("Head", "Tail"), BALLS, match)
    return str(caught.value)


def test_components_have_a_size_and_a_center():
    small = piece(BALLS, 1)
    assert small.vertices == 300
    assert small.size == pytest.approx(1.4, rel=0.01)
    np.testing.assert_allclose(small.center, (5, 0, 0), atol=0.01)
    np.testing.assert_allclose(piece_masses(on(0.25, 0.75)[None], BALLS), [[0.25, 0.75]])


def test_a_connected_mesh_needs_no_matching():
    surface = density_surface(icosphere(2))
    densities = np.random.default_rng(0).random((2, *surface.shape))
    assert on_same_pieces(densities, ("a", "b"), surface) is densities
    np.testing.assert_array_equal(piece_masses(densities, surface), [[1.0], [1.0]])


def test_mass_on_different_components_is_refused_by_group_and_component():
    text = refusal(on(1.0, 0.0), on(0.0, 1.0))
    assert text.startswith("Head and Tail lie on different pieces")
    assert "piece of 400 vertices, 2 long" in text
    assert "one of 300 vertices, 1.4 long, around (5, " in text
    assert "Head has 100.0% of its mass and Tail 0.0%" in text


def test_different_shares_are_refused_or_matched():
    pair = on(0.5, 0.5, 1), on(0.25, 0.75, 2)
    assert "Head has 50.0% and Tail 25.0%" in refusal(*pair)
    matched = on_same_pieces(np.stack(pair), ("a", "b"), BALLS, match=True)
    np.testing.assert_allclose(piece_masses(matched, BALLS), 0.5)
    np.testing.assert_allclose(matched[0], pair[0], rtol=1e-9)
    own = BALLS.pieces == 1
    np.testing.assert_allclose(matched[1][own] / pair[1][own], 0.5 / 0.75)


def test_an_empty_component_cannot_be_matched():
    assert "different pieces" in refusal(on(1.0, 0.0), on(0.5, 0.5), match=True)
    assert "different pieces" in refusal(on(0.5, 0.5), on(1.0, 0.0), match=True)


@settings(max_examples=15)
@given(st.floats(0.0, 1.0), st.floats(-9e-4, 9e-4))
def test_rounding_differences_are_evened_out(share, difference):
    other = min(max(share + difference, 0.0), 1.0)
    pair = np.stack([on(share, 1 - share, 1), on(other, 1 - other, 2)])
    even = on_same_pieces(pair, ("a", "b"), BALLS)
    masses = piece_masses(even, BALLS)
    np.testing.assert_allclose(masses[0], masses[1], rtol=1e-9, atol=1e-300)
    np.testing.assert_allclose(masses[0], [share, 1 - share], atol=2e-3)
    assert np.abs(even - pair) @ BALLS.weights == pytest.approx(0.0, abs=5e-3)
