# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given
from hypothesis.extra.numpy import arrays

from convwass_addon.applications.soft_maps.transfer import (
    transferred_corner_values,
    transferred_values,
    transferred_weights,
)
from convwass_addon.errors import InputError
from tests.applications.maps import exact_map, subdivided, without_points
from tests.shapes import box, torus

GIVER = torus(segments=(24, 12))
FINER = subdivided(GIVER)
ONTO_GIVER = exact_map(FINER.vertices, GIVER)
LOST = np.arange(len(FINER.vertices)) < 10


def test_functions_linear_on_triangles_are_transferred_exactly():
    direction = np.array([0.3, -1.0, 2.0])
    np.testing.assert_allclose(transferred_values(ONTO_GIVER, GIVER, GIVER.vertices), FINER.vertices, atol=1e-6)
    found = transferred_values(ONTO_GIVER, GIVER, GIVER.vertices @ direction)
    np.testing.assert_allclose(found, FINER.vertices @ direction, atol=1e-6)


def test_vertices_without_a_point_get_zero():
    found = transferred_values(without_points(ONTO_GIVER, LOST), GIVER, np.ones(len(GIVER.vertices)))
    assert not found[LOST].any()
    np.testing.assert_allclose(found[~LOST], 1.0, rtol=1e-6)


def test_corner_colors_may_jump_between_triangles():
    colors = np.repeat(np.eye(3)[np.arange(len(GIVER.faces)) % 3][:, None], 3, axis=1)
    found = transferred_corner_values(ONTO_GIVER, colors)
    np.testing.assert_allclose(found, colors[ONTO_GIVER.faces, 0], atol=1e-6)


def weights_of_bones(count=6):
    """Weights with sum 1 that decrease with the distance from each of several bones."""
    bones = GIVER.vertices[:: len(GIVER.vertices) // count][:count]
    near = np.exp(-np.linalg.norm(GIVER.vertices - bones[:, None], axis=2) / 0.5)
    return near / near.sum(axis=0)


def test_bone_weights_sum_to_one_and_respect_the_limit():
    weights = weights_of_bones()
    free = transferred_weights(ONTO_GIVER, GIVER, weights)
    np.testing.assert_allclose(free.sum(axis=0), 1.0)
    np.testing.assert_allclose(free[:, : len(GIVER.vertices)], weights, atol=1e-5)
    limited = transferred_weights(ONTO_GIVER, GIVER, weights, limit=3)
    assert ((limited > 0).sum(axis=0) == 3).all()
    np.testing.assert_allclose(limited.sum(axis=0), 1.0)
    # The largest weights stay, in proportion.
    top = np.argsort(-free, axis=0, kind="stable")[:3]
    kept = np.take_along_axis(free, top, 0)
    np.testing.assert_allclose(np.take_along_axis(limited, top, 0), kept / kept.sum(axis=0))


def test_weights_of_other_groups_keep_their_sums():
    weights = 0.4 * weights_of_bones()
    found = transferred_weights(ONTO_GIVER, GIVER, weights, limit=2, normalize=False)
    np.testing.assert_allclose(found.sum(axis=0), 0.4, atol=2e-3)
    assert ((found > 0).sum(axis=0) <= 2).all()


@given(arrays(np.float64, (3, len(GIVER.vertices)), elements=st.floats(0, 1)), st.integers(1, 4), st.booleans())
def test_weights_are_valid_for_any_input(weights, limit, normalize):
    found = transferred_weights(without_points(ONTO_GIVER, LOST), GIVER, weights, limit, normalize)
    assert found.shape == (3, len(FINER.vertices))
    assert (found >= 0).all() and (found <= 1).all()
    assert ((found > 0).sum(axis=0) <= limit).all()
    assert not found[:, LOST].any()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: transferred_values(ONTO_GIVER, GIVER, np.ones(3)), "one value for every vertex"),
        (lambda: transferred_values(ONTO_GIVER, box(), np.ones(8)), "more faces"),
        (lambda: transferred_corner_values(ONTO_GIVER, np.ones((4, 3, 2))), "three values for every triangle"),
        (lambda: transferred_weights(ONTO_GIVER, GIVER, np.ones(len(GIVER.vertices))), "for every group and vertex"),
        (lambda: transferred_weights(ONTO_GIVER, GIVER, -np.ones((1, len(GIVER.vertices)))), "not negative"),
        (lambda: transferred_weights(ONTO_GIVER, GIVER, np.ones((1, len(GIVER.vertices))), 0), "at least 1"),
    ],
)
def test_mismatched_arrays_are_refused(call, message):
    with pytest.raises(InputError, match=message):
        call()
