# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances along a surface, as buttons and scripts ask for them."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.vertex_groups import read_group, write_group
from convwass_addon.operators.density_measure import CONVWASS_OT_measure_distance
from convwass_addon.operators.mesh_targets import length_text
from tests.operators.densities import ball, linked, positions, two_balls
from tests.operators.running import ESCAPE, Pressed, call, inventory, pretend_window, until, window_context

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.mark.parametrize("radius", [1.0, 10.0])
def test_caps_at_both_ends_are_as_far_apart_as_their_meridians_say(radius, capfd):
    """Mass stays on its meridian, so the edge of one cap moves to the middle of the other."""
    obj = ball(radius=radius)
    assert call("measure_distance", first="A", second="B") == {"FINISHED"}
    found = obj.convwass_density_findings
    assert (found.first, found.second) == ("A", "B")
    shares = (np.arange(1000) + 0.5) / 1000
    ways = np.pi - np.arccos(1 - 0.2 * shares) - np.arccos(1 - 0.2 * (1 - shares))
    assert found.distance == pytest.approx(radius * np.sqrt((ways**2).mean()), rel=0.05)
    assert f"From A to B: {length_text(bpy.context.scene, found.distance)}" in capfd.readouterr().out


def test_the_settings_of_the_object_are_the_default():
    obj = ball()
    obj.convwass_density.first, obj.convwass_density.second = "A", "A"
    call("measure_distance")
    assert obj.convwass_density_findings.distance == pytest.approx(0, abs=0.02)
    assert call("measure_distance", first="A", second="A", debias=False) == {"FINISHED"}
    obj.convwass_density.second = ""
    with pytest.raises(RuntimeError, match="Choose two groups"):
        call("measure_distance")


def test_other_pieces_are_named():
    two_balls()
    with pytest.raises(RuntimeError, match=r"different pieces.*266 vertices"):
        call("measure_distance", first="A", second="B")
    with pytest.raises(RuntimeError, match="no vertex group C"):
        call("measure_distance", first="A", second="C")


def test_linked_objects_are_measured(tmp_path):
    linked(tmp_path)
    assert call("measure_distance", first="A", second="B") == {"FINISHED"}


def test_all_groups_become_a_table():
    obj = ball()
    write_group(obj, "Whole", np.ones(len(obj.data.vertices)))
    obj.vertex_groups.new(name="Empty")
    assert call("measure_groups") == {"FINISHED"}
    text = bpy.data.texts[obj.convwass_density_findings.table]
    head, *rows = [line.body.split("\t") for line in text.lines if line.body]
    assert head == ["", "A", "B", "Whole"]
    assert [row[0] for row in rows] == ["A", "B", "Whole"]
    values = np.array([[float(cell) for cell in row[1:]] for row in rows])
    np.testing.assert_array_equal(values, values.T)
    np.testing.assert_array_equal(np.diag(values), 0)
    assert values[0, 1] > values[0, 2] == pytest.approx(values[1, 2], rel=1e-3)


def test_pieces_without_a_distance_leave_their_cells_empty():
    obj = two_balls()
    call("measure_groups", groups="A\nB")
    body = bpy.data.texts[obj.convwass_density_findings.table].as_string()
    assert body == "\tA\tB\nA\t0\t\nB\t\t0\n"


def test_one_group_is_no_table():
    obj = ball()
    obj.vertex_groups.remove(obj.vertex_groups["B"])
    with pytest.raises(RuntimeError, match="at least two groups"):
        call("measure_groups")


@pytest.mark.parametrize("mode", ["OBJECT", "WEIGHT_PAINT", "EDIT"])
def test_distances_from_a_vertex_become_a_group(mode, capfd):
    obj = ball(radius=2.0)
    points = positions(obj)
    bpy.ops.object.mode_set(mode=mode)
    assert call("distance_from_vertices", vertices="0") == {"FINISHED"}
    assert obj.mode == mode
    weights = read_group(obj, "Distance")
    angles = np.arccos(np.clip(points @ points[0] / 4, -1, 1))
    # So coarse a mesh makes long distances short by a sixth.
    np.testing.assert_allclose(weights, angles / np.pi, atol=0.1)
    assert weights[angles.argmax()] == 1
    assert obj.vertex_groups.active.name == "Distance"
    assert "Distance: a weight of 1 is 5." in capfd.readouterr().out


def test_a_painted_group_is_not_replaced_by_distances():
    obj = ball()
    before = read_group(obj, "A")
    with pytest.raises(RuntimeError, match="already has a vertex group A that is no result"):
        call("distance_from_vertices", vertices="0", group="A")
    np.testing.assert_array_equal(read_group(obj, "A"), before)
    for _ in range(2):
        assert call("distance_from_vertices", vertices="0") == {"FINISHED"}


def test_unreached_mass_is_reported(capfd):
    obj = two_balls()
    call("distance_from_vertices", vertices="0", group="Far")
    assert (read_group(obj, "Far")[positions(obj)[:, 0] > 2] == 1).all()
    assert "Vertices on other pieces of the mesh" in capfd.readouterr().out


@pytest.mark.parametrize("name", ["measure_distance", "measure_groups", "distance_from_vertices"])
def test_they_need_a_mesh(name):
    with pytest.raises(RuntimeError, match="Make a mesh object active"):
        call(name)


def test_only_one_job_at_a_time():
    ball()
    progress = bpy.context.window_manager.convwass_progress
    progress.running = True
    try:
        for name in ("measure_distance", "normalize_density", "interpolate_density"):
            with pytest.raises(RuntimeError, match="A job is running"):
                call(name)
    finally:
        progress.running = False


def test_undo_takes_a_table_back():
    ball()
    bpy.ops.ed.undo_push(message="painted")
    call("measure_groups")
    bpy.ops.ed.undo_push(message="measured")
    bpy.ops.ed.undo()
    assert not bpy.data.texts


@pytest.fixture
def press(monkeypatch):
    def start(context, **arguments):
        pressed = Pressed(CONVWASS_OT_measure_distance, **arguments)
        with monkeypatch.context() as patch:
            pretend_window(patch)
            assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
        return pressed

    return start


def test_it_measures_in_the_background(press):
    obj = ball()
    context = window_context()
    pressed = press(context, first="A", second="B")
    assert context.window_manager.convwass_progress.running
    assert until(pressed, context) == {"FINISHED"}
    assert not context.window_manager.convwass_progress.running
    assert obj.convwass_density_findings.distance > 2
    assert pressed.reports[-1][1].startswith("From A to B: ")


def test_escape_stops_it(press):
    obj = ball()
    before = inventory()
    context = window_context()
    assert press(context, first="A", second="B").modal(context, ESCAPE) == {"CANCELLED"}
    assert inventory() == before
    assert obj.convwass_density_findings.first == ""


def test_a_deleted_object_is_reported(press):
    obj = ball()
    context = window_context()
    pressed = press(context, first="A", second="B")
    bpy.data.objects.remove(obj)
    assert until(pressed, context) == {"CANCELLED"}
    assert "was deleted" in pressed.reports[-1][1]


@pytest.mark.parametrize(
    ("system", "scale", "text"), [("METRIC", 1.0, "2.5 m"), ("METRIC", 0.01, "2.5 cm"), ("NONE", 0.01, "2.5")]
)
def test_lengths_are_in_units_of_the_scene(system, scale, text):
    units = bpy.context.scene.unit_settings
    units.system, units.scale_length = system, scale
    assert length_text(bpy.context.scene, 2.5) == text
    assert length_text(bpy.context.scene, np.inf) == "-"
