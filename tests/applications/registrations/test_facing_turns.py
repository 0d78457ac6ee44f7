# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether registrations turn bodies over, or far around."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.registrations.facing_turns import is_turned_over, tumbles
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.geometry.algebra.rotation_fields import rotation_matrices
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.grids import figure

SHAPE = figure()[0]


def turned(degrees):
    """The vertices of a figure after a turn, moved and scaled."""
    turn = rotation_matrices(np.radians([degrees]))[0]
    return 2.0 * SHAPE.vertices @ turn.T + (5.0, -3.0, 1.0)


@pytest.mark.parametrize(
    ("degrees", "over"),
    [
        ((0.0, 0.0, 180.0), False),
        ((90.0, 0.0, 0.0), False),
        ((0.0, -90.0, 0.0), False),
        ((105.0, 0.0, 0.0), False),
        ((115.0, 0.0, 0.0), True),
        ((0.0, 180.0, 0.0), True),
    ],
)
def test_a_body_is_turned_over_if_up_becomes_down(degrees, over):
    assert is_turned_over(SHAPE, Laid(turned(degrees), np.ones(len(SHAPE.vertices)))) is over


@pytest.mark.parametrize(
    ("degrees", "far"),
    [
        ((0.0, 0.0, 180.0), False),
        ((60.0, 0.0, 165.0), False),
        ((120.0, 0.0, 0.0), False),
        ((130.0, 0.0, 0.0), True),
        ((0.0, 180.0, 0.0), True),
    ],
)
def test_a_body_tumbles_if_it_turns_far_around_and_not_about_the_vertical_axis(degrees, far):
    assert tumbles(SHAPE, Laid(turned(degrees), np.ones(len(SHAPE.vertices)))) is far


def test_a_body_tumbles_if_it_lies_down_and_turns_around():
    """As a robot on its way to an airplane: up becomes forward, and left becomes right."""
    around = SHAPE.vertices @ np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
    laid = Laid(around, np.ones(len(SHAPE.vertices)))
    assert tumbles(SHAPE, laid)
    assert not is_turned_over(SHAPE, laid)


def test_a_registration_that_is_trusted_nowhere_turns_nothing_over():
    assert not is_turned_over(SHAPE, Laid(turned((0.0, 180.0, 0.0)), np.zeros(len(SHAPE.vertices))))


def test_flat_shapes_stay_in_their_plane():
    """Left and right of letters may change places, stroke by stroke."""
    flat = TriangleMesh(SHAPE.vertices[:, [0, 2, 1]] * (1.0, 1.0, 0.0), SHAPE.faces)
    assert not is_turned_over(flat, Laid(flat.vertices * (-1.0, 1.0, 1.0), np.ones(len(flat.vertices))))


def test_parts_that_are_not_trusted_do_not_count():
    upper = SHAPE.vertices[:, 2] > np.median(SHAPE.vertices[:, 2])
    points = np.where(upper[:, None], turned((180.0, 0.0, 0.0)), turned((0.0, 0.0, 0.0)))
    assert is_turned_over(SHAPE, Laid(points, np.where(upper, 1.0, 0.01)))
    assert not is_turned_over(SHAPE, Laid(points, np.where(upper, 0.01, 1.0)))
