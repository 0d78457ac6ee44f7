# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rough maps of two shapes, as they stand and turned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.blends import ASSETS, read_meshes
from convwass_addon.applications.registrations import map_survey
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.map_survey import Promise, RoughMap, best_rough_map
from convwass_addon.applications.registrations.pair_maps import PairMap
from convwass_addon.geometry.algebra.rotation_fields import rotation_matrices
from convwass_addon.geometry.solids.orientation import orient_outward
from convwass_addon.progress import UNINTERRUPTED, drained

HALF = rotation_matrices(np.array([[0.0, 0.0, np.pi]]))[0]


@pytest.fixture(scope="module")
def cow():
    mesh = orient_outward(read_meshes([ASSETS / "cow.ply"])[0])
    return carrier_of(mesh, "cow", 500, UNINTERRUPTED)


def test_the_pose_that_fits_is_found_and_registered(monkeypatch, cow):
    monkeypatch.setattr(map_survey, "_VERTICES", (120,))
    turned = cow.posed(cow.rest.vertices @ HALF.T)
    found = drained(best_rough_map([cow, turned], turned, Promise(), UNINTERRUPTED))
    assert found.pose == 1
    # Costs of shapes that have nothing in common are above 6.
    assert found.cost < 1.0
    for laid in found.starts:
        apart = np.linalg.norm(laid.points - turned.mesh.vertices, axis=1)
        assert turned.mesh.vertex_areas @ (apart < 0.05 * turned.mesh.root_area) > 0.9 * turned.mesh.area


def test_a_pose_that_a_registration_turns_over_is_avoided(monkeypatch, cow):
    """A cow that lies on its back is registered by turning it over; on its side, with a lower score, it is not."""
    monkeypatch.setattr(map_survey, "_VERTICES", (120,))
    back, side = (
        cow.posed(cow.rest.vertices @ rotation_matrices(np.array([[angle, 0.0, 0.0]]))[0].T) for angle in (3.0, 1.5)
    )
    costs = {id(back): 0.5, id(side): 1.0}
    monkeypatch.setattr(map_survey, "total_cost", lambda drafts, *_found: costs[id(drafts.both[0])])
    monkeypatch.setattr(map_survey, "draft_of", lambda shape, *_others: shape)
    assert drained(best_rough_map([side, back], cow, Promise(), UNINTERRUPTED)).pose == 0


@pytest.mark.parametrize(
    ("promise", "score", "poses", "tried"),
    [
        (Promise(least=0.8), 0.7, 1, 1),
        (Promise(least=0.8), 0.9, 1, 2),
        (Promise(least=0.8), 0.9, 2, 4),
        (Promise(), 0.0, 1, 2),
        (Promise(enough=0.8), 0.7, 2, 4),
        (Promise(enough=0.8), 0.9, 2, 2),
    ],
)
def test_the_first_map_tells_which_others_are_tried(monkeypatch, cow, promise, score, poses, tried):
    """None if it is not promising, and no other poses if it is good enough."""
    left = [4.0, 3.0, 2.0, 1.0][-2 * poses :]

    def solved(pose, *_others):
        return RoughMap(pose, replace(PairMap.unneeded(), score=score), (), left.pop(0))

    monkeypatch.setattr(map_survey, "_VERTICES", (120, 100))
    monkeypatch.setattr(map_survey, "_rough_map", solved)
    found = drained(best_rough_map(poses * [cow], cow, promise, UNINTERRUPTED))
    assert 2 * poses - len(left) == tried
    assert (None if found is None else found.cost) == (None if tried == 1 else 1.0 + len(left))
