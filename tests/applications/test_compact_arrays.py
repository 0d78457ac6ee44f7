# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compact arrays: integers come back exactly, positions to half a step, and surfaces take few bytes."""

from __future__ import annotations

import zlib

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from skimage.measure import marching_cubes

from convwass_addon.applications.morphs.compact_arrays import Rounding, packed_integers, unpacked_integers


@given(arrays(np.int64, array_shapes(min_dims=2, max_dims=2, min_side=0), elements=st.integers(1 - 2**30, 2**30 - 1)))
def test_integers_come_back(values):
    np.testing.assert_array_equal(unpacked_integers(packed_integers(values)), values)


@given(st.integers(1, 3), st.integers(1, 5), st.floats(1e-6, 1e6), st.floats(-1e6, 1e6), st.integers(0, 9))
def test_positions_come_back_within_half_a_step(sets, count, size, place, seed):
    points = place + size * np.random.default_rng(seed).random((sets, count, 3))
    rounding = Rounding.of(points, size / 1000.0)
    assert size / 2000.0 < rounding.step <= size / 1000.0
    found = rounding.positions(rounding.rounded(points))
    assert np.abs(found - points).max() <= 0.5 * rounding.step + 1e-9


@pytest.mark.parametrize(("width", "most"), [(1.0, 0.0), (1.0, 1e-10), (1.0, 1e-300), (1e300, 1e299)])
def test_positions_that_are_too_far_apart_have_no_rounding(width, most):
    assert Rounding.of(np.array([[[0.0, 0.0, 0.0], [width, 0.0, 0.0]]]), most) is None


def test_surfaces_take_few_bytes():
    """They take 5.9 bytes a vertex; compressed as they are, in single precision, they take 10.6."""
    axes = np.linspace(-1.0, 1.0, 40)
    radii = np.linalg.norm(np.meshgrid(axes, axes, axes, indexing="ij"), axis=0)
    vertices, faces, *_ = marching_cubes(radii.astype(np.float32), 0.8)
    steps = Rounding.of(vertices[None], 1.0 / 1000.0).rounded(vertices[None])
    packed = (packed_integers(steps), packed_integers(faces.reshape(1, -1)))
    assert sum(len(zlib.compress(part.tobytes())) for part in packed) < 6.5 * len(vertices)
