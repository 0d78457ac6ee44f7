# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Signatures compared with closed forms, and their invariances."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.deformation.signatures import wave_kernel_signature
from convwass_addon.geometry.meshes.laplacian import laplacian
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.spectrum import Spectrum, spectrum
from tests.grids import figure, sheet
from tests.shapes import ball, torus

# Number of spherical harmonics up to degree 6.
_SHELLS = 49


def test_the_wave_kernel_of_a_sphere_is_one():
    # The squared harmonics of a degree have a constant sum (addition theorem), and the weights sum to one.
    found = wave_kernel_signature(spectrum(laplacian(ball(points=2500)), _SHELLS))
    np.testing.assert_allclose(found, 1.0, atol=0.06)


def test_the_wave_kernel_of_single_levels_is_the_square_of_their_functions():
    values = np.array([0.0, 1.0, 1e3, 1e6])
    functions = np.random.default_rng(0).normal(size=(7, 4))
    found = wave_kernel_signature(Spectrum(values, functions, np.full(7, 1.0 / 7.0)), 100)
    # Bands are 7 % of the range wide, so the first excludes the next level, half the range away.
    np.testing.assert_allclose(found[:, 0], functions[:, 1] ** 2, rtol=1e-6)


@pytest.mark.parametrize("shape", [torus(segments=(24, 16)), sheet(15, 11, (2.0, 1.0))])
def test_the_mean_of_wave_kernels_is_one(shape):
    modes = spectrum(laplacian(shape), 40)
    found = wave_kernel_signature(modes, 30)
    assert found.shape == (len(shape.vertices), 30)
    np.testing.assert_allclose(modes.areas @ found, 1.0, rtol=1e-9)


def test_signatures_are_invariant_to_moving_scaling_and_reordering():
    mesh, _ = figure()
    draw = np.random.default_rng(3)
    order = draw.permutation(len(mesh.vertices))
    moved = 7.0 * Rotation.random(rng=draw).apply(mesh.vertices)[order] + 2.0
    other = TriangleMesh(moved, np.argsort(order)[mesh.faces])
    first, second = (wave_kernel_signature(spectrum(laplacian(shape), 40), 20) for shape in (mesh, other))
    np.testing.assert_allclose(second, first[order], rtol=1e-5, atol=1e-7)


def test_left_and_right_of_a_symmetric_figure_have_equal_signatures():
    mesh, mirror = figure()
    found = wave_kernel_signature(spectrum(laplacian(mesh), 40), 20)
    np.testing.assert_allclose(found[mirror], found, rtol=1e-4, atol=1e-6)
    spread = found.std(axis=0) / found.mean(axis=0)
    assert spread.max() > 0.15, "it distinguishes other points"


def test_loose_vertices_have_no_signature():
    mesh = ball(points=100)
    loose = TriangleMesh(np.concatenate([mesh.vertices, [[5.0, 5, 5]]]), mesh.faces)
    modes = spectrum(laplacian(loose), 20)
    assert not wave_kernel_signature(modes)[-1].any()


def test_invalid_input_is_refused():
    modes = spectrum(laplacian(ball(points=100)), 10)
    with pytest.raises(ValueError, match="energies"):
        wave_kernel_signature(modes, 1)
    with pytest.raises(ValueError, match="not zero"):
        wave_kernel_signature(modes.first(2))
