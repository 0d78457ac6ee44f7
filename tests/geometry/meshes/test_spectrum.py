# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Eigenvalues and eigenfunctions of surfaces with known spectra."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import eigh_tridiagonal
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.laplacian import laplacian
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.spectrum import spectrum
from tests.grids import sheet
from tests.shapes import ball, joined, torus


@pytest.fixture(params=["dense", "Lanczos"])
def solved(request):
    """Return the spectrum of a surface by either solver; over a quarter of all values are solved densely."""

    def first(stiffness, count):
        most = stiffness.matrix.shape[0] // 3 if request.param == "dense" else count
        return spectrum(stiffness, max(most, count)).first(count)

    return first


def test_a_sphere_has_the_spectrum_of_spherical_harmonics(solved):
    found = solved(laplacian(ball(radius=3.0, points=1500)), 25).eigenvalues
    degrees = np.repeat(np.arange(5), 2 * np.arange(5) + 1)
    np.testing.assert_allclose(found, 4.0 * np.pi * degrees * (degrees + 1), rtol=0.02, atol=1e-9)


def test_a_square_has_the_spectrum_of_cosines(solved):
    found = solved(laplacian(sheet(33, 33)), 12).eigenvalues
    squares = np.add.outer(np.arange(6) ** 2, np.arange(6) ** 2).ravel()
    np.testing.assert_allclose(found, np.pi**2 * np.sort(squares)[:12], rtol=0.01, atol=1e-9)


def torus_eigenvalues(major, minor, count, nodes=2000):
    """Eigenvalues of a torus of revolution, from an ordinary differential equation per wave number around the axis."""
    step = 2.0 * np.pi / nodes
    angles = (np.arange(nodes) + 0.5) * step
    # Functions are even or odd in the angle around the tube: half of it with Neumann or Dirichlet conditions.
    half = nodes // 2
    ring = lambda angle: major + minor * np.cos(angle)  # noqa: E731
    values = []
    for wave in range(8):
        for sign in (1.0, -1.0):
            inner, outer = ring(angles[:half] - step / 2), ring(angles[:half] + step / 2)
            mass = ring(angles[:half])
            diagonal = (inner + outer) / (minor * step) ** 2 + wave**2 / mass
            diagonal[0] -= sign * inner[0] / (minor * step) ** 2
            diagonal[-1] -= sign * outer[-1] / (minor * step) ** 2
            beside = -outer[:-1] / (minor * step) ** 2
            scale = np.sqrt(mass)
            own = eigh_tridiagonal(diagonal / mass, beside / (scale[:-1] * scale[1:]), select="i", select_range=(0, 8))[
                0
            ]
            values.extend(np.repeat(own, 1 if wave == 0 else 2))
    return np.sort(values)[:count] * 4.0 * np.pi**2 * major * minor


def test_a_torus_has_the_spectrum_of_its_differential_equation(solved):
    found = solved(laplacian(torus(1.0, 0.35, segments=(64, 32))), 20).eigenvalues
    np.testing.assert_allclose(found, torus_eigenvalues(1.0, 0.35, 20), rtol=0.02, atol=1e-6)


def test_functions_are_orthonormal_and_solve_the_equation(solved):
    stiffness = laplacian(torus(segments=(30, 20)))
    found = solved(stiffness, 40)
    functions, areas = found.functions, found.areas
    assert areas.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(functions.T @ (areas[:, None] * functions), np.eye(40), atol=1e-10)
    applied = stiffness.matrix @ functions
    np.testing.assert_allclose(applied, areas[:, None] * functions * found.eigenvalues, atol=1e-8)
    assert (np.diff(found.eigenvalues) >= 0).all()


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 100.0))
def test_moving_scaling_and_reordering_change_nothing(seed, factor):
    draw = np.random.default_rng(seed)
    mesh = ball(points=300)
    order = draw.permutation(300)
    moved = Rotation.random(rng=draw).apply(mesh.vertices * (1.0, 1.4, 0.7)) * factor + draw.normal(size=3)
    other = TriangleMesh(moved[order], np.argsort(order)[mesh.faces])
    first = spectrum(laplacian(TriangleMesh(mesh.vertices * (1.0, 1.4, 0.7), mesh.faces)), 12)
    second = spectrum(laplacian(other), 12)
    np.testing.assert_allclose(second.eigenvalues, first.eigenvalues, rtol=1e-6, atol=1e-8)
    agreement = first.functions[order].T @ (second.areas[:, None] * second.functions)
    # The same functions except for signs.
    np.testing.assert_allclose(np.abs(np.diag(agreement)), 1.0, atol=1e-4)


def test_every_component_adds_a_zero_and_its_eigenvalues(solved):
    one = ball(points=200)
    two = joined(one, ball(points=200, center=(5, 0, 0)))
    alone, found = solved(laplacian(one), 6).eigenvalues, solved(laplacian(two), 12)
    # With unit area in total, each of the two components has half of it.
    np.testing.assert_allclose(found.eigenvalues, np.repeat(2.0 * alone, 2), rtol=1e-9, atol=1e-9)
    assert (np.abs(found.functions).max(axis=0) > 0).all()
    for column in found.functions.T:
        assert not column[:200].any() or not column[200:].any()


def test_eigenfunctions_vanish_at_loose_vertices():
    mesh = ball(points=150)
    loose = TriangleMesh(np.concatenate([[[9.0, 9, 9]], mesh.vertices]), mesh.faces + 1)
    found, without = spectrum(laplacian(loose), 10), spectrum(laplacian(mesh), 10)
    assert not found.functions[0].any()
    assert found.areas[0] == 0
    np.testing.assert_allclose(found.eigenvalues, without.eigenvalues, rtol=1e-9, atol=1e-9)


def test_a_triangle_has_three_eigenvalues():
    triangle = TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    assert len(spectrum(laplacian(triangle), 50).eigenvalues) == 3


def test_the_first_eigenvalues_do_not_depend_on_the_count():
    found = spectrum(laplacian(torus()), 20)
    np.testing.assert_array_equal(found.first(5).functions, found.functions[:, :5])
    np.testing.assert_array_equal(found.first(5).eigenvalues, found.eigenvalues[:5])


def test_a_count_must_be_positive():
    with pytest.raises(ValueError, match="positive"):
        spectrum(laplacian(ball(points=50)), 0)
