# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from dataclasses import asdict

import pytest

from convwass_addon.applications.morphs.layouts import grid_blends, path_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.steady_topology import SteadyTopology, legs_of
from convwass_addon.geometry.level_sets.connectivity import Connectivity

BLENDS = path_blends(2, 6)
RINGS = Connectivity(1, 1, 0)


def frame(blend, found, most=RINGS):
    record = {"found": asdict(found), **({} if blend.source is not None else {"most": asdict(most)})}
    return MorphFrame(blend, None, record)


def topology_of(handles, pieces=None, most=RINGS):
    """Return the topology after a path of six frames with these numbers of handles and pieces."""
    topology = SteadyTopology(legs_of(BLENDS))
    for blend, holes, parts in zip(BLENDS, handles, pieces or [1] * len(handles), strict=True):
        topology.add(frame(blend, Connectivity(parts, holes, 0), most))
    return topology


def test_legs_lie_between_shapes():
    three = path_blends(3, 4)
    first, second = legs_of(three)
    assert (first.first, first.last, second.last) == (three[0], three[4], three[8])
    assert first.between + second.between == (*three[1:4], *three[5:8])
    assert legs_of(three[1:4]) == legs_of(grid_blends(4, 3)) == []


def test_a_flickering_hole_is_closed():
    assert topology_of([1, 1, 0, 1, 0, 0, 1]).asked() == {BLENDS[3]: Connectivity(1, 0, 0)}
    assert topology_of([1, 1, 1, 0, 0, 1, 1]).asked() == {}


def test_a_leg_needs_only_its_own_shapes_and_blends():
    """One blend of the second leg is not known."""
    blends = path_blends(3, 6)
    topology = SteadyTopology(legs_of(blends))
    for blend, holes in zip(blends, [1, 1, 0, 1, 0, 0, 1, 1, 0, 1, 0, 0, 1], strict=True):
        if blend != blends[8]:
            topology.add(frame(blend, Connectivity(1, holes, 0)))
    assert topology.asked() == {blends[3]: Connectivity(1, 0, 0)}


def test_a_flickering_piece_is_joined():
    two = Connectivity(2, 0, 0)
    assert topology_of([0] * 7, [1, 1, 2, 1, 2, 2, 2], two).asked() == {BLENDS[2]: Connectivity(1, 0, 0)}


def test_more_than_the_shapes_have_is_asked_away_too():
    assert topology_of([1, 1, 1, 2, 1, 0, 1]).asked() == {BLENDS[3]: RINGS}


def test_unreachable_counts_are_requested_once():
    topology = topology_of([1, 1, 0, 1, 0, 0, 1])
    ((blend, most),) = topology.asked().items()
    assert topology.better(frame(blend, RINGS, most), most) is None
    assert topology.asked() == {}


def test_recomputed_frames_keep_the_maximum_over_their_shapes():
    topology = topology_of([1, 1, 0, 1, 0, 0, 1])
    ((blend, most),) = topology.asked().items()
    better = topology.better(frame(blend, Connectivity(1, 0, 0), most), most)
    assert better.record["most"] == asdict(RINGS)
    assert topology.asked() == {}


@pytest.mark.parametrize(
    "record",
    [
        {},
        {"found": 1},
        {"found": {"pieces": 1}},
        {"found": dict.fromkeys("abc", 1)},
        {"found": {**asdict(RINGS), "handles": "1"}, "most": asdict(RINGS)},
    ],
)
def test_nothing_is_requested_if_a_frame_is_unknown(record):
    topology = SteadyTopology(legs_of(BLENDS))
    for blend, handles in zip(BLENDS, [1, 1, 0, 1, 0, 0, 1], strict=True):
        topology.add(frame(blend, Connectivity(1, handles, 0)) if blend.frame != 2 else MorphFrame(blend, None, record))
    assert topology.asked() == {}


def tried(handles):
    """Return the topology after no blend could be repaired."""
    topology = topology_of(handles)
    for blend, most in topology.asked().items():
        topology.better(frame(blend, Connectivity(1, handles[blend.frame], 0)), most)
    assert topology.asked() == {}
    return topology


def test_single_blends_that_could_not_be_repaired_are_known():
    topology = tried([0, 0, 0, 1, 0, 0, 0])
    assert topology.unreached() == {BLENDS[3]: Connectivity(1, 0, 0)}
    assert topology.beside(BLENDS[3]) == (BLENDS[2], BLENDS[4])
    assert topology.reaches(frame(BLENDS[3], Connectivity(1, 0, 2)), Connectivity(1, 0, 0))
    assert not topology.reaches(frame(BLENDS[3], RINGS), Connectivity(1, 0, 0))
    topology.better(frame(BLENDS[3], Connectivity(1, 0, 0)), Connectivity(1, 0, 0))
    assert topology.unreached() == {}


def test_next_to_a_shape_there_is_one_neighbor():
    topology = tried([0, 1, 0, 0, 0, 0, 0])
    assert topology.unreached() == {BLENDS[1]: Connectivity(1, 0, 0)}
    assert topology.beside(BLENDS[1]) == (BLENDS[2],)


def test_several_successive_blends_stay_as_they_are():
    assert tried([0, 0, 1, 1, 0, 0, 0]).unreached() == {}
    assert tried([0, 0, 1, 1, 1, 1, 1]).unreached() == {}
