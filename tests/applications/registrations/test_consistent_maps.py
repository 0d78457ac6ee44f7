# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between three and more shapes agree with each other."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.consistent_maps import composed, composed_ways
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.applications.registrations.shape_deformations import split_deformation
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import arm
from tests.shapes import shuffled

ALL = list(combinations(range(3), 2))


def test_the_worst_map_of_a_cycle_is_composed():
    assert composed_ways({(0, 1): 0.9, (0, 2): 0.5, (1, 2): 0.8}, 3) == {(0, 2): [0, 1, 2]}
    assert composed_ways({(0, 1): 0.5, (0, 2): 0.9, (1, 2): 0.8}, 3) == {(0, 1): [0, 2, 1]}
    assert composed_ways({(0, 1): 0.9, (0, 2): 0.9, (1, 2): 0.9}, 3) == {(1, 2): [1, 0, 2]}


def test_maps_on_a_path_are_kept():
    assert composed_ways({(0, 1): 0.1, (1, 2): 0.0, (2, 3): 1.0}, 4) == {}
    # Two pairs without a common shape.
    assert composed_ways({(0, 3): 0.1, (1, 2): 0.7}, 4) == {}


@pytest.mark.parametrize("seed", range(8))
def test_no_map_on_a_way_is_worse_than_the_direct_one(seed):
    scores = dict(zip(combinations(range(6), 2), np.random.default_rng(seed).random(15).tolist(), strict=True))
    ways = composed_ways(scores, 6)
    assert len(ways) == 15 - 5
    for (begin, end), way in ways.items():
        assert (way[0], way[-1]) == (begin, end)
        steps = [(min(step), max(step)) for step in pairwise(way)]
        assert not set(steps) & set(ways)
        assert min(scores[step] for step in steps) > scores[begin, end]


def placed(index):
    """An affine map, (3, 4): turned, stretched and moved by its number."""
    turn = Rotation.from_euler("z", 35.0 * index, degrees=True).as_matrix()
    return np.column_stack([turn @ np.diag([1.0, 1.0 + 0.2 * index, 1.0]), index * np.array([0.5, -1.0, 0.25])])


def between(points, one, other):
    """Points on one affine image where they are on another one."""
    start, end = placed(one), placed(other)
    return (points - start[:, 3]) @ np.linalg.inv(start[:, :3]).T @ end[:, :3].T + end[:, 3]


@pytest.mark.parametrize("way", [(0, 1, 2), (0, 1, 2, 3), (2, 0, 3)])
def test_exact_maps_are_composed_exactly(way):
    straight = arm(0.0)[0]
    images = [TriangleMesh(between(straight.vertices, 0, index), straight.faces) for index in range(4)]
    carriers = [carrier_of(shuffled(own, seed)[0], "arm", 800, UNINTERRUPTED) for seed, own in enumerate(images)]
    deformations = {}
    for one, other in pairwise(way):
        points = between(carriers[one].mesh.vertices, one, other)
        laid = Laid(points, np.full(len(points), 0.9))
        deformations[one, other] = split_deformation(carriers[one], carriers[other], laid, None, UNINTERRUPTED)
    found = composed(carriers, deformations, way, UNINTERRUPTED)
    known = between(carriers[way[0]].mesh.vertices, way[0], way[-1])
    assert np.abs(found.points - known).max() < 1e-6
    np.testing.assert_allclose(found.trust, 0.9 ** (len(way) - 1))


def test_three_shapes_coincide():
    shapes = [arm(0.0)[0], *(shuffled(arm(np.radians(angle))[0])[0] for angle in (40.0, 120.0))]
    settings = GuidedSettings(map_vertices=200, carrier_vertices=500)
    motion = drained(guided_motion(shapes, ["one", "two", "three"], ALL, settings))
    (pair,) = composed_ways({pair: motion.pairs[pair].score for pair in ALL}, 3)
    (middle,) = {0, 1, 2} - set(pair)
    laid = composed(motion.carriers, motion.deformations, (pair[0], middle, pair[1]), UNINTERRUPTED)
    np.testing.assert_allclose(motion.deformations[pair].points, laid.points)
    moved = [own.mesh for own in motion.moved([1.0 / 3.0] * 3)]
    for one, other in ALL:
        gaps = ClosestPointFinder(moved[other].corners).find(moved[one].vertices).distances
        assert gaps.max() < 0.02 * moved[one].root_area
