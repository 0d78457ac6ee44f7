# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Skeletons fitted into bodies with known axes, and the messages if that fails."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.skeletons import skeleton_bodies
from convwass_addon.applications.skeletons.skeleton_carrying import between_pins
from convwass_addon.applications.skeletons.skeleton_fit import FittedSkeleton, fit_steps
from convwass_addon.applications.skeletons.skeleton_graph import JointGraph
from convwass_addon.applications.skeletons.skeleton_links import Links, chains
from convwass_addon.applications.skeletons.skeleton_settings import SkeletonSettings
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.controls import cancelled_control, recorded
from tests.line_tubes import tube
from tests.shapes import box, joined, square, torus, with_faces

_SETTINGS = SkeletonSettings()


def chain(count, first, last):
    """Joints in a row between two pins."""
    shares = np.linspace(0.0, 1.0, count)[:, None]
    positions = (1.0 - shares) * np.asarray(first, float) + shares * np.asarray(last, float)
    pinned = np.isin(np.arange(count), (0, count - 1))
    return JointGraph.from_arrays(positions, [(i, i + 1) for i in range(count - 1)], pinned)


def fit(mesh, graph, settings=_SETTINGS) -> FittedSkeleton:
    found = recorded(fit_steps(mesh, graph, settings))
    fractions = [step.fraction for step in found.reports]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    return found.result


@pytest.fixture(scope="module", autouse=True)
def coarse():
    """Do not divide bodies of few vertices."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(skeleton_bodies, "_FEWEST_VERTICES", 300)
        yield


@pytest.fixture(scope="module")
def straight():
    return tube(np.linspace((0.0, 0.0, 0.0), (3.0, 0.0, 0.0), 30), 0.2)


@pytest.fixture(scope="module")
def bent():
    turns = np.linspace(0.0, np.pi, 36)
    return tube(np.stack([np.cos(turns), 0.0 * turns, np.sin(turns)], axis=1), 0.2)


def test_a_chain_is_evenly_spread_on_the_axis_of_a_cylinder(straight):
    found = fit(straight, chain(6, (0.1, 0.0, 0.0), (2.9, 0.0, 0.0)))
    expected = np.linspace((0.1, 0.0, 0.0), (2.9, 0.0, 0.0), 6)
    assert np.abs(found.positions - expected).max() < 0.04
    assert found.inside.all() and not found.projected.any() and found.notices == ()


def test_bones_keep_their_proportions(straight):
    graph = chain(4, (0.1, 0.0, 0.0), (2.9, 0.0, 0.0))
    found = fit(
        straight, replace(graph, rest=np.array([[0.0, 7.0, 0.0], [1.0, 7.0, 0.0], [1.0, 8.0, 0.0], [1.0, 8.0, 2.0]]))
    )
    np.testing.assert_allclose(np.diff(found.positions[:, 0]), [0.7, 0.7, 1.4], atol=0.06)


@pytest.mark.parametrize("placement", ["centered", "expected"])
def test_a_chain_follows_a_bent_tube(bent, placement):
    graph = chain(7, (0.99, 0.0, 0.1), (-0.99, 0.0, 0.1))
    found = fit(bent, graph, SkeletonSettings(placement=placement))
    assert found.inside.all() and (found.winding > 0.5).all()
    if placement == "centered":
        assert np.abs(np.hypot(found.positions[:, 0], found.positions[:, 2]) - 1.0).max() < 0.06
    line = chain(7, (0.99, 0.0, 0.1), (-0.99, 0.0, 0.1)).positions
    assert np.hypot(line[3, 0], line[3, 2]) < 0.2


def test_a_symmetric_body_has_symmetric_joints(bent):
    found = fit(bent, chain(7, (0.99, 0.0, 0.1), (-0.99, 0.0, 0.1)))
    mirrored = found.positions[::-1] * (-1.0, 1.0, 1.0)
    assert np.abs(found.positions - mirrored).max() < 0.05
    assert np.abs(found.positions[:, 1]).max() < 0.03


def test_pose_size_and_order_do_not_matter(bent):
    graph = chain(5, (0.99, 0.0, 0.1), (-0.99, 0.0, 0.1))
    expected = fit(bent, graph).positions
    turn, scale, offset = Rotation.from_euler("xyz", (0.4, 1.1, -2.0)).as_matrix(), 17.0, np.array([3.0, -90.0, 4.0])
    order = np.random.default_rng(0).permutation(len(bent.vertices))
    moved = TriangleMesh(scale * bent.vertices[order] @ turn.T + offset, np.argsort(order)[bent.faces])
    found = fit(moved, replace(graph, positions=scale * graph.positions @ turn.T + offset))
    assert np.abs((found.positions - offset) @ turn / scale - expected).max() < 0.03


def test_a_branching_joint_lies_where_limbs_meet():
    ways = [
        tube(np.linspace((0.0, 0.0, 0.0), 1.5 * np.array(end), 30), 0.2)
        for end in ((1, 0, 0), (-1, 0, 0.3), (0.2, 0, -1))
    ]
    tips = [1.4 * np.array(end) for end in ((1, 0, 0), (-1, 0, 0.3), (0.2, 0, -1))]
    positions = [(0.0, 0.0, 9.0), *tips, *(0.5 * tip for tip in tips)]
    graph = JointGraph.from_arrays(
        positions,
        [(0, 4), (0, 5), (0, 6), (4, 1), (5, 2), (6, 3)],
        [False, *[True] * 3, *[False] * 3],
        rest=[(0.0, 0.0, 0.0), *tips, *(0.5 * tip for tip in tips)],
    )
    found = fit(joined(*ways), graph)
    assert found.record["body"] == "solid"
    assert np.linalg.norm(found.positions[0]) < 0.12
    assert found.inside.all()


def test_open_bodies_are_accepted(bent):
    found = fit(with_faces(bent, np.arange(len(bent.faces) - 20)), chain(5, (0.99, 0.0, 0.1), (-0.98, 0.0, 0.2)))
    assert found.inside.all()


def test_a_loop_with_three_pins_follows_a_ring():
    turns = np.arange(9) * 2 * np.pi / 9
    positions = np.stack([np.cos(turns), np.sin(turns), 0.0 * turns], axis=1)
    pinned = np.arange(9) % 3 == 0
    edges = [(i, (i + 1) % 9) for i in range(9)]
    found = fit(
        torus(), JointGraph.from_arrays(np.where(pinned[:, None], positions, 0.0), edges, pinned, rest=positions)
    )
    assert np.linalg.norm(found.positions - positions, axis=1).max() < 0.06
    with pytest.raises(InputError, match="three of its joints"):
        fit(torus(), JointGraph.from_arrays(positions, edges, np.isin(np.arange(9), (0, 4))))


def test_limbs_without_a_pin_move_rigidly(straight):
    positions = [(0.1, 0, 0), (1.0, 0, 0), (2.0, 0, 0), (2.9, 0, 0), (1.0, 0.1, 0)]
    graph = JointGraph.from_arrays(positions, [(0, 1), (1, 2), (2, 3), (1, 4)], [1, 0, 0, 1, 0], tuple("abcde"))
    assert between_pins(graph).tolist() == [True, True, True, True, False]
    found = fit(straight, graph)
    assert np.linalg.norm(found.positions[4] - found.positions[1] - [0.0, 0.1, 0.0]) < 0.03
    assert [str(notice) for notice in found.notices] == ["No pin lies beyond these joints, which keep their shape: e."]


def test_pins_outside_are_refused_or_moved(straight):
    graph = chain(4, (0.1, 0.0, 0.0), (3.2, 0.0, 0.0))
    with pytest.raises(InputError, match=r"Pins outside the body: 3\. Move them inside \(3 to 2\.9"):
        fit(straight, graph)
    found = fit(straight, graph, SkeletonSettings(outside_pins="move"))
    assert found.inside.all()
    assert 2.8 < found.positions[3, 0] < 3.0
    assert str(found.notices[0]) == "Pins moved into the body: 3."


@pytest.mark.parametrize(
    ("edges", "pinned", "message"),
    [
        ([], [1, 1, 0, 0], "no bones"),
        ([(0, 1), (1, 2), (2, 3)], [0, 0, 0, 0], "No joint is pinned; pin"),
        ([(0, 1), (2, 3)], [1, 1, 0, 0], "in the part of the skeleton with 2, 3"),
        ([(0, 1), (1, 2), (2, 3)], [0, 1, 0, 0], "Only 1 is pinned in its part of the skeleton; .* such as 0, 3"),
    ],
)
def test_too_few_pins(straight, edges, pinned, message):
    positions = [(0.1, 0, 0), (1.0, 0, 0), (2.0, 0, 0), (2.9, 0, 0)]
    with pytest.raises(InputError, match=message):
        fit(straight, JointGraph.from_arrays(positions, edges, pinned))


def test_pins_in_one_place(straight):
    graph = JointGraph.from_arrays(
        [(1, 0, 0), (2, 0, 0), (1, 0, 0), (2.5, 0, 0)], [(0, 1), (1, 2), (1, 3)], [1, 0, 1, 1]
    )
    with pytest.raises(InputError, match="0 and 2 are pinned in the same place"):
        fit(straight, graph)


def test_pins_in_separate_parts_of_the_body_are_refused():
    mesh = joined(box(), box(center=(3.0, 0.0, 0.0)))
    with pytest.raises(InputError, match="The pins 0 and 2 lie in parts of the body that do not touch"):
        fit(mesh, chain(3, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0)))
    # Components without a pin do not belong to the body.
    assert fit(mesh, chain(3, (2.7, 0.0, 0.0), (3.3, 0.0, 0.0))).inside.all()


def test_sheets_need_thickness():
    graph = chain(4, (-0.4, 0.0, 0.0), (0.4, 0.1, 0.0))
    with pytest.raises(InputError, match="encloses no volume"):
        fit(square(), graph)
    assert fit(square(), graph, SkeletonSettings(thickness=0.08)).inside.all()


def test_bones_that_leave_the_body_are_reported(bent):
    found = fit(bent, chain(3, (0.99, 0.0, 0.1), (-0.99, 0.0, 0.1)))
    assert [str(notice) for notice in found.notices] == [
        "Bones that leave the body between their joints: 2 (0 - 1, 1 - 2)."
    ]


def test_a_fit_can_be_cancelled(straight):
    with pytest.raises(Cancelled):
        list(fit_steps(straight, chain(4, (0.1, 0, 0), (2.9, 0, 0)), _SETTINGS, cancelled_control()))


def test_records_are_ready_for_json(straight):
    record = fit(straight, chain(4, (0.1, 0, 0), (2.9, 0, 0))).record
    assert json.loads(json.dumps(record)) == record
    assert record["inside"] == 4 and record["converged"]


def test_large_bodies_are_reduced():
    mesh = torus(segments=(160, 80))
    turns = np.linspace(0.0, 2.0, 5)
    positions = np.stack([np.cos(turns), np.sin(turns), 0.0 * turns], axis=1)
    graph = JointGraph.from_arrays(positions, [(i, i + 1) for i in range(4)], [1, 0, 0, 0, 1])
    found = fit(mesh, graph)
    assert found.record["body"] == "reduced" and found.record["vertices"] < 4000
    assert np.linalg.norm(found.positions - positions, axis=1).max() < 0.08


def test_links_have_similar_lengths():
    graph = JointGraph.from_arrays([(0, 0, 0), (1, 0, 0), (4, 0, 0)], [(0, 1), (1, 2)], [1, 0, 1])
    links = Links.of(graph, graph.lengths, 2)
    assert [len(path) - 1 for path in links.paths] == [1, 3]
    assert links.size == 5
    np.testing.assert_allclose(links.weights, 1.0)


def test_chains_end_at_pins_and_branches():
    edges = [(0, 1), (1, 2), (2, 3), (2, 4), (4, 5)]
    graph = JointGraph.from_arrays(np.zeros((6, 3)), edges, [1, 0, 0, 1, 0, 1])
    assert sorted(way.tolist() for way in chains(graph)) == [[0, 1, 2], [2, 3], [2, 4, 5]]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gamma": 0.0}, r"Blur \(gamma\) must lie between 1e-05 and 1"),
        ({"slack": -1.0}, "Slack"),
        ({"weights": "even"}, r"Lengths \(weights\) must be one of"),
        ({"links": 0}, "Links"),
        ({"placement": "middle"}, "Placement"),
        ({"outside_pins": "keep"}, "Pins Outside"),
        ({"thickness": -1.0}, "Thickness"),
        ({"tolerance": 1.0}, "Tolerance"),
        ({"max_iterations": 0}, "Iterations"),
    ],
)
def test_invalid_settings_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        SkeletonSettings(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"positions": np.zeros((3, 2))}, "shape"),
        ({"edges": [(0, 3)]}, "do not exist"),
        ({"edges": [(1, 1)]}, "joint 1 to itself"),
        ({"pinned": [True]}, "each of its 3 joints"),
        ({"positions": [(0, 0, 0), (np.nan, 0, 0), (1, 1, 1)]}, "joint 1 has coordinates"),
        ({"rest": np.zeros((2, 3))}, "shape"),
    ],
)
def test_invalid_graphs_are_refused(changes, message):
    given = {"positions": np.zeros((3, 3)), "edges": [(0, 1), (1, 2)], "pinned": [True, False, True]}
    with pytest.raises(InputError, match=message):
        JointGraph.from_arrays(**{**given, **changes})
