# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Filled regions of closed curves, and their coverage of cells, compared with known areas."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.geometry.plane.coverage import coverage
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from tests.flat_shapes import ellipse, rectangle, star

# The lattice moves corners by up to this fraction of the longest side.
_EXACT = 1e-7


@pytest.mark.parametrize(
    ("rings", "rule", "area"),
    [
        ([rectangle()], "non-zero", 1.0),
        ([rectangle()[::-1]], "even-odd", 1.0),
        ([rectangle(), rectangle((0.5, 0.5), (1.5, 1.5))], "non-zero", 1.75),
        ([rectangle(), rectangle((0.5, 0.5), (1.5, 1.5))], "even-odd", 1.5),
        ([rectangle((0, 0), (3, 3)), rectangle((1, 1), (2, 2))], "non-zero", 9.0),
        ([rectangle((0, 0), (3, 3)), rectangle((1, 1), (2, 2))], "even-odd", 8.0),
        ([rectangle((0, 0), (3, 3)), rectangle((1, 1), (2, 2))[::-1]], "non-zero", 8.0),
        ([rectangle(), rectangle()], "even-odd", 0.0),
        ([rectangle(), rectangle()[::-1]], "non-zero", 0.0),
        # Coincident and overlapping edges.
        ([rectangle(), rectangle((1, 0), (2, 1))], "even-odd", 2.0),
        ([rectangle((0, 0), (2, 2)), rectangle((2, 1), (4, 3))], "non-zero", 8.0),
        # A bow tie winds around its halves in opposite directions.
        ([np.array([[0, 0], [2, 2], [2, 0], [0, 2.0]])], "non-zero", 2.0),
        ([np.array([[0, 0], [1, 1], [2, 2.0]])], "non-zero", 0.0),
    ],
)
def test_areas_filled_by_the_rules(rings, rule, area):
    assert filled_boundary(rings, rule).area == pytest.approx(area, abs=_EXACT * 4)


def test_a_star_is_filled_or_has_a_hole():
    # Area of a pentagram: 10 tan(pi/10) / (3 - tan(pi/10)^2) times the squared radius; with its inner pentagon.
    tangent = np.tan(np.pi / 10)
    whole = 10 * tangent / (3 - tangent**2)
    inner = np.cos(2 * np.pi / 5) / np.cos(np.pi / 5)
    pentagon = 2.5 * np.sin(2 * np.pi / 5) * inner**2
    assert filled_boundary([star()], "non-zero").area == pytest.approx(whole, abs=1e-6)
    assert filled_boundary([star()], "even-odd").area == pytest.approx(whole - pentagon, abs=1e-6)


def test_the_center_is_that_of_the_filled_region():
    ring = [rectangle((0, 0), (4, 2)), rectangle((2, 0), (4, 2))[::-1]]
    np.testing.assert_allclose(filled_boundary(ring, "non-zero").center, [1.0, 1.0], atol=1e-6)


def test_overlapping_rings_agree_with_inclusion_and_exclusion():
    one, other = ellipse(), ellipse((0.9, 0.1))
    union = filled_boundary([one, other], "non-zero").area
    apart = filled_boundary([one, other], "even-odd").area
    # Both sides are the area of the intersection.
    assert 2 * np.pi - union == pytest.approx((2 * np.pi - apart) / 2, abs=1e-6)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 24), st.sampled_from(["non-zero", "even-odd"]))
def test_tangled_curves_agree_with_winding_numbers_of_points(seed, corners, rule):
    ring = np.random.default_rng(seed).random((corners, 2))
    boundary = filled_boundary([ring], rule)
    points = np.random.default_rng(seed + 1).random((64, 2))
    turns = _turns(points, ring)
    inside = turns != 0 if rule == "non-zero" else turns % 2 == 1
    closed = np.stack([boundary.starts, boundary.ends], axis=1)
    found = _turns_of_edges(points, closed[:, 0], closed[:, 1])
    np.testing.assert_array_equal(found, inside.astype(int))


def _turns(points, ring):
    return _turns_of_edges(points, ring, np.roll(ring, -1, axis=0))


def _turns_of_edges(points, starts, ends):
    """Sum of the angles that edges subtend at points, in full turns."""
    a, b = starts[None] - points[:, None], ends[None] - points[:, None]
    angles = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=-1))
    return np.rint(angles.sum(axis=1) / (2 * np.pi)).astype(int)


@pytest.mark.parametrize("shape", [(40, 30), (64, 64)])
def test_coverage_is_the_exact_area_of_rectangles(shape):
    low, high = np.array([3.25, 4.5]), np.array([20.125, 11.75])
    found = coverage(filled_boundary([rectangle(low, high)], "non-zero"), shape)
    lengths = [
        np.clip(np.minimum(np.arange(n) + 1, b) - np.maximum(np.arange(n), a), 0, 1)
        for n, a, b in zip(shape, low, high, strict=True)
    ]
    np.testing.assert_allclose(found, np.outer(*lengths), atol=1e-6)


def test_coverage_of_a_triangle_is_exact_in_every_cell():
    found = coverage(filled_boundary([np.array([[0, 0], [3, 0], [3, 3.0]])], "non-zero"), (4, 4))
    expected = np.zeros((4, 4))
    expected[:3, :3] = np.triu(np.ones((3, 3))).T
    np.fill_diagonal(expected[:3, :3], 0.5)
    np.testing.assert_allclose(found, expected, atol=1e-7)


@settings(max_examples=25, deadline=None)
@given(st.floats(-6, 40), st.floats(-6, 40), st.floats(0.3, 12), st.floats(0.3, 12), st.floats(0, 3))
def test_coverage_of_a_window_agrees_with_the_full_coverage(x, y, first, second, angle):
    boundary = filled_boundary([ellipse((x, y), (first, second), 40, angle)], "even-odd")
    whole = coverage(boundary.moved([20, 20]), (80, 80))
    assert whole.sum() == pytest.approx(np.pi * first * second, abs=1e-4)
    np.testing.assert_allclose(coverage(boundary, (32, 24)), whole[20:52, 20:44], atol=1e-9)


def test_no_rings_fill_nothing():
    assert filled_boundary([], "non-zero").area == 0.0
    assert not coverage(filled_boundary([np.zeros((5, 2))], "even-odd"), (8, 8)).any()


def test_the_area_of_a_transformed_boundary_is_scaled():
    assert filled_boundary([star()], "non-zero").moved([3, 4], 2.0).area == pytest.approx(4 * 1.12256994, abs=1e-6)
