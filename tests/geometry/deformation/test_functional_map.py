# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Spectral maps between surfaces with known correspondence."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.meshes import blob
from convwass_addon.geometry.deformation.functional_map import spectral_match, upsampled
from convwass_addon.geometry.deformation.signatures import wave_kernel_signature
from convwass_addon.geometry.meshes.laplacian import laplacian
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.spectrum import spectrum
from tests.grids import figure


def test_a_reordered_surface_is_matched():
    mesh = TriangleMesh.from_arrays(*blob(500))
    order = np.random.default_rng(0).permutation(500)
    other = TriangleMesh(mesh.vertices[order], np.argsort(order)[mesh.faces])
    here, there = (spectrum(laplacian(shape), 60) for shape in (mesh, other))
    found = spectral_match(here, there, wave_kernel_signature(here, 20), wave_kernel_signature(there, 20))
    np.testing.assert_array_equal(order[found.forward], np.arange(500))
    np.testing.assert_array_equal(found.backward, order)


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_descriptors_distinguish_left_and_right(is_mirrored):
    mesh, mirror = figure()
    modes = spectrum(laplacian(mesh), 60)
    side = np.tanh(4.0 * mesh.vertices[:, 0])[:, None]
    signature = wave_kernel_signature(modes, 20)
    own, other = np.hstack([signature, side]), np.hstack([signature, -side if is_mirrored else side])
    found = spectral_match(modes, modes, own, other).forward
    np.testing.assert_array_equal(found, mirror if is_mirrored else np.arange(len(mirror)))


def test_upsampling_keeps_an_exact_map():
    modes = spectrum(laplacian(TriangleMesh.from_arrays(*blob(300))), 45)
    found = upsampled(np.eye(10), modes, modes)
    np.testing.assert_array_equal(found.forward, np.arange(300))
    np.testing.assert_array_equal(found.backward, np.arange(300))


def test_tiny_surfaces_get_a_map():
    triangle = TriangleMesh.from_arrays([(0, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    modes = spectrum(laplacian(triangle), 120)
    other = spectrum(laplacian(TriangleMesh.from_arrays(*blob(40))), 120)
    found = spectral_match(modes, other, np.ones((3, 2)), np.ones((40, 2)))
    assert found.forward.shape == (3,)
    assert found.backward.shape == (40,)
    assert found.backward.max() < 3


def test_both_surfaces_need_the_same_number_of_descriptors():
    modes = spectrum(laplacian(TriangleMesh.from_arrays(*blob(40))), 10)
    with pytest.raises(ValueError, match="same number"):
        spectral_match(modes, modes, np.ones((40, 2)), np.ones((40, 3)))
