# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A rough map tells whether a complete one is worth solving."""

from functools import cache

import numpy as np
import pytest

from assets.sculpting import tube
from benchmarks.sculptures import Sculpture
from convwass_addon.applications.registrations import promising_maps
from convwass_addon.applications.registrations.promising_maps import may_map
from convwass_addon.errors import Cancelled
from convwass_addon.geometry.deformation.upright_turns import rotation_about_z
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, Control, drained
from tests.shapes import ball, torus


@cache
def rod(angle):
    """A rod on an arc of the given angle."""
    turns = np.linspace(-0.5, 0.5, 16) * angle
    arc = np.stack([2.0 * np.sin(turns) / angle, 2.0 * (1.0 - np.cos(turns)) / angle, 0.0 * turns], axis=1)
    clay = Sculpture(5)
    clay.add(tube(arc, [0.12] * len(arc), 1))
    return clay.mesh(3000)


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Map on coarse meshes, which are enough for rods, balls and rings."""
    monkeypatch.setattr(promising_maps, "_CARRIER_VERTICES", 500)
    monkeypatch.setattr(promising_maps, "_MAP_VERTICES", 100)


def promising(first, second, control=UNINTERRUPTED):
    return drained(may_map(first, second, control))


def test_a_straight_rod_may_map_to_a_bent_one_but_a_ball_not_to_a_ring():
    assert promising(rod(0.01), rod(3.5))
    assert not promising(ball(), torus())


@pytest.mark.parametrize(
    ("turn", "other"),
    [
        (rotation_about_z(0.5 * np.pi), "_turn_of_axes"),
        (np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), "symmetric_turn"),
    ],
    ids=["about the vertical axis", "raised"],
)
def test_rods_that_cross_are_turned(monkeypatch, turn, other):
    bent, scores = rod(3.5), []
    across = TriangleMesh(bent.vertices @ turn.T, bent.faces)
    scored = promising_maps._rough_score
    monkeypatch.setattr(promising_maps, "_rough_score", lambda *shapes: scores.append(scored(*shapes)) or scores[-1])
    monkeypatch.setattr(promising_maps, other, lambda *_shapes: None)
    assert promising(rod(0.01), across)
    as_they_stand, turned = scores
    assert as_they_stand < promising_maps._PROMISING <= turned


def test_it_can_be_cancelled():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        promising(ball(), torus(), control)
