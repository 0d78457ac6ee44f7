# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Means of stretches: what is known of diagonal matrices and of rotations."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.algebra.mean_stretches import area_preserving_mean, arithmetic_mean
from convwass_addon.geometry.algebra.rotation_fields import rotation_matrices

LONG = np.diag([9.0, 1.0 / 9.0, 1.0])[None]
WIDE = np.diag([1.0 / 4.0, 4.0, 1.0])[None]
MEANS = (arithmetic_mean, area_preserving_mean)


def turned(angle):
    return rotation_matrices(np.array([[0.0, 0.0, angle]]))


def in_plane(across, along):
    return np.diag([across, along, 1.0])


def test_means_of_a_stretch_and_the_identity():
    assert arithmetic_mean([(0.5, LONG)])[0] == pytest.approx(in_plane(5.0, 5.0 / 9.0))
    assert area_preserving_mean([(0.5, LONG)])[0] == pytest.approx(in_plane(3.0, 1.0 / 3.0))


@pytest.mark.parametrize("share", [0.1, 0.5, 0.8])
def test_areas_stay_the_same_from_both_ends(share):
    there, back = area_preserving_mean([(share, LONG)]), area_preserving_mean([(1.0 - share, np.linalg.inv(LONG))])
    assert np.linalg.det(there) == pytest.approx(1.0)
    assert back @ LONG == pytest.approx(there)


def test_several_stretches():
    assert area_preserving_mean([(0.5, LONG), (0.5, WIDE)])[0] == pytest.approx(in_plane(1.5, 2.0 / 3.0))


def test_sizes_grow_evenly():
    doubled, tripled = in_plane(2.0, 2.0), in_plane(3.0, 3.0)
    assert area_preserving_mean([(0.25, in_plane(5.0, 5.0)[None])])[0] == pytest.approx(doubled)
    assert area_preserving_mean([(0.5, tripled @ LONG)])[0] == pytest.approx(doubled @ in_plane(3.0, 1.0 / 3.0))


def test_a_part_of_the_angle():
    wanted = turned(0.3)[0] @ in_plane(np.sqrt(3.0), 1.0 / np.sqrt(3.0))
    assert area_preserving_mean([(0.25, turned(1.2) @ LONG)])[0] == pytest.approx(wanted)


@pytest.mark.parametrize("mean", MEANS)
def test_weights_of_one_and_zero(mean):
    sheared = np.array([[[1.2, 0.4, 0.0], [-0.3, 0.8, 0.0], [0.0, 0.0, 1.0]]])
    assert mean([(1.0, sheared)]) == pytest.approx(sheared)
    assert mean([(0.0, sheared)])[0] == pytest.approx(np.eye(3))


def test_a_collapsed_triangle_has_a_mean():
    assert np.isfinite(area_preserving_mean([(0.5, in_plane(1.0, 0.0)[None])])).all()
