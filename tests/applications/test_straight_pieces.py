# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths as few straight pieces."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.one_mesh.refined_samples import RefinedPath
from convwass_addon.applications.one_mesh.straight_pieces import StayNear, deviation, fitted_pieces, straight_pieces
from convwass_addon.progress import UNINTERRUPTED, drained
from convwass_addon.sentence import Sentence


def arc(angle, count):
    """A point on the unit circle and the center, at even times."""
    turned = np.linspace(0.0, angle, count)
    return np.array([[[np.cos(a), np.sin(a), 0.0], [0.0, 0.0, 0.0]] for a in turned])


def ends_of(path, most):
    return straight_pieces(len(path), [StayNear(RefinedPath.of(path, 0), most)])


def test_a_straight_and_even_path_is_one_piece():
    path = np.linspace(0.0, 1.0, 9)[:, None, None] * [[1.0, 2.0, 0.0]]
    assert ends_of(path, 1e-12) == [8]


@pytest.mark.parametrize("pieces", [2, 3, 4, 6])
def test_the_number_of_pieces_of_an_arc_follows_from_its_sagitta(pieces):
    """A chord of an arc of angle a stays within 1 - cos(a / 2) of it, up to where the pace differs a little."""
    angle = np.radians(120.0)
    sagitta = 1.0 - np.cos(angle / pieces / 2.0)
    ends = ends_of(arc(angle, 12 * pieces + 1), 1.02 * sagitta)
    assert ends == [12 * (number + 1) for number in range(pieces)]
    path = arc(angle, 25)
    assert deviation(RefinedPath.of(path, 0), [0, 24], np.eye(25)[[0, 24]], UNINTERRUPTED) == pytest.approx(
        1.0 - np.cos(angle / 2.0), rel=0.02
    )


def test_samples_that_cannot_be_joined_stay_all():
    corner = np.array([[[0.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]], [[1.0, 1.0, 0.0]]])
    assert ends_of(corner, 0.1) == [1, 2]


def test_fitted_pieces_are_fewer_and_stay_as_near():
    """Ends beyond an arc share the error out to both sides: pieces may be longer by the root of a third and more."""
    samples, most = arc(np.radians(120.0), 121), 0.02
    path = RefinedPath.of(samples, 0)
    found = drained(fitted_pieces(path, [StayNear(path, most)], Sentence("Choosing"), UNINTERRUPTED))
    assert len(found.ends) < len(ends_of(samples, most))
    assert found.deviation <= most
    knots = np.array([0, *found.ends]) / 120
    points = np.concatenate([samples[:1], found.positions])
    followed = np.stack([np.interp(np.linspace(0, 1, 121), knots, points[:, 0, axis]) for axis in range(3)], axis=1)
    away = np.linalg.norm(followed - samples[:, 0], axis=1)
    assert away.max() == pytest.approx(found.deviation)
    assert away[[0, -1]] == pytest.approx(0.0, abs=1e-12)
