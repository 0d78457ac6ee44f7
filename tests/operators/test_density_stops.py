# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of groups that a density passes."""

from __future__ import annotations

import bpy
import pytest

from tests.operators.densities import ball

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def obj():
    return ball()


def call(name, **arguments):
    return getattr(bpy.ops.convwass, f"{name}_density_stop{'s' if name == 'clear' else ''}")(**arguments)


def listed(obj):
    return [(stop.group, stop.frame) for stop in obj.convwass_density.stops]


def test_stops_are_some_frames_apart(obj):
    obj.convwass_density.steps = 10
    assert call("add") == {"FINISHED"}
    call("add", group="B")
    obj.convwass_density.stops[1].frame = 20.5
    call("add", which="EMPTY")
    assert listed(obj) == [("A", 1), ("B", 20.5), ("", 30.5)]
    assert obj.convwass_density.active_stop == 2


def test_all_groups_come_once(obj):
    call("add", group="B")
    call("add", which="ALL")
    assert [name for name, _ in listed(obj)] == ["B", "A"]
    assert call("add", which="ALL") == {"CANCELLED"}


def test_moving_a_stop_keeps_the_frames(obj):
    call("add", which="ALL")
    call("move", direction="UP")
    assert listed(obj) == [("B", 1), ("A", 25)]
    assert obj.convwass_density.active_stop == 0
    assert call("move", index=1, direction="DOWN") == {"CANCELLED"}
    call("move", index=1, direction="UP")
    assert (listed(obj)[0], obj.convwass_density.active_stop) == (("A", 1), 1)


def test_removing_and_clearing(obj):
    call("add", which="ALL")
    call("add", which="EMPTY")
    call("remove", index=0)
    assert ([name for name, _ in listed(obj)], obj.convwass_density.active_stop) == (["B", ""], 1)
    with pytest.raises(RuntimeError, match="no item 7"):
        call("remove", index=7)
    call("clear")
    assert listed(obj) == []
    for name in ("remove", "move", "clear"):
        with pytest.raises(RuntimeError, match="list of stops is empty"):
            call(name)
    assert obj.vertex_groups.keys() == ["A", "B"]


def test_a_mesh_without_groups_has_places_only(obj):
    obj.vertex_groups.clear()
    with pytest.raises(RuntimeError, match="no active vertex group"):
        call("add")
    assert call("add", which="EMPTY") == {"FINISHED"}


def test_undo_brings_the_list_back(obj):
    call("add", which="ALL")
    bpy.ops.ed.undo_push(message="added")
    call("clear")
    bpy.ops.ed.undo_push(message="cleared")
    bpy.ops.ed.undo()
    assert [name for name, _ in listed(bpy.context.object)] == ["A", "B"]
