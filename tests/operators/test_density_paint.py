# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools on painted densities, as buttons and scripts call them."""

from __future__ import annotations

import threading
import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

from convwass_addon.applications.densities import density_tools
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.bridge.surfaces import surface_mesh
from convwass_addon.bridge.vertex_groups import read_group, write_group
from convwass_addon.operators import density_pick, picking
from convwass_addon.operators.density_paint import CONVWASS_OT_diffuse_density, CONVWASS_OT_drop_density
from tests.operators.densities import ball, center, linked, positions, two_balls
from tests.operators.running import ESCAPE, TIMER, Pressed, call, pretend_window, until, window_context

pytestmark = pytest.mark.usefixtures("empty_scene")

TOOLS = ("normalize_density", "diffuse_density", "sharpen_density", "drop_density")
MODES = ("OBJECT", "WEIGHT_PAINT", "EDIT")


def findings(obj):
    return obj.convwass_density_findings


def test_normalizing_scales_the_heat_map_and_reports_figures():
    obj = ball()
    write_group(obj, "A", read_group(obj, "A") / 4)
    assert call("normalize_density") == {"FINISHED"}
    weights = read_group(obj, "A")
    assert weights.max() == 1
    found = findings(obj)
    # A cap of height 0.2 to 0.27 on the unit sphere.
    assert 0.08 < found.covered < 0.15
    assert found.group == "A"
    assert found.radius == pytest.approx(np.sqrt(4 * found.covered), rel=0.05)
    assert found.entropy == pytest.approx(np.log(found.covered), abs=1e-3)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("tool", TOOLS)
def test_tools_work_in_every_mode_and_come_back_to_it(tool, mode):
    obj = ball()
    bpy.ops.object.mode_set(mode=mode)
    before = read_group(obj, "A")
    arguments = {"drop_density": {"vertices": "3"}, "sharpen_density": {"to": "ENTROPY", "entropy": 0.0}}
    assert call(tool, **arguments.get(tool, {})) == {"FINISHED"}
    assert obj.mode == mode
    after = read_group(obj, "A")
    assert np.array_equal(before, after) == (tool in ("normalize_density", "sharpen_density"))


def test_diffusing_spreads_by_the_length_in_scene_units():
    obj = ball(radius=3.0)
    call("drop_density", vertices="0")
    call("diffuse_density", length=0.6)
    weights = read_group(obj, "A")
    away = np.linalg.norm(positions(obj) - positions(obj)[0], axis=1)
    areas = density_surface(surface_mesh(obj, bpy.context.evaluated_depsgraph_get())).weights
    variance = (weights * areas) @ away**2 / (weights @ areas) / 2
    assert np.sqrt(variance) == pytest.approx(0.6, rel=0.15)


def test_hidden_heat_maps_cover_nothing():
    obj = ball()
    call("drop_density", vertices="0", radius=0.2)
    assert (read_group(obj, "A") > 0).mean() > 0.9
    assert findings(obj).covered < 0.4


def test_undo_in_edit_mode_takes_a_group_back():
    obj = ball()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.ed.undo_push(message="editing")
    before = read_group(obj, "A")
    call("drop_density", vertices="3")
    call("distance_from_vertices", vertices="3")
    bpy.ops.ed.undo_push(message="dropped")
    bpy.ops.ed.undo()
    obj = bpy.context.object
    assert obj.mode == "EDIT"
    np.testing.assert_array_equal(read_group(obj, "A"), before)
    assert obj.vertex_groups.keys() == ["A", "B"]


def test_sharpening_halves_the_area():
    obj = ball()
    call("drop_density", vertices="0", radius=0.5)
    before = findings(obj).entropy
    call("sharpen_density", share=0.5)
    assert findings(obj).entropy == pytest.approx(before + np.log(0.5), abs=2e-3)


def test_a_flat_top_cannot_be_sharpened():
    ball()
    with pytest.raises(RuntimeError, match="its top is flat"):
        call("sharpen_density")


def test_mass_is_dropped_on_selected_vertices_in_edit_mode():
    obj = ball()
    for items in (obj.data.polygons, obj.data.edges, obj.data.vertices):
        items.foreach_set("select", np.isin(np.arange(len(items)), (3, 70) if items == obj.data.vertices else ()))
    bpy.ops.object.mode_set(mode="EDIT")
    assert call("drop_density") == {"FINISHED"}
    assert set(np.flatnonzero(read_group(obj, "A"))) == {3, 70}


def test_one_share_is_dropped_and_the_others_are_kept():
    obj = ball()
    far = int(read_group(obj, "B").argmax())
    call("drop_density", vertices=str(far), share=0.25, radius=0.3)
    weights = read_group(obj, "A")
    assert weights[far] > 0
    assert (weights[read_group(ball(), "A") > 0] > 0).all()


def test_a_missing_group_is_created():
    obj = ball()
    obj.vertex_groups.clear()
    call("drop_density", vertices="5")
    assert obj.vertex_groups.keys() == ["Mass"]
    call("drop_density", vertices="6", group="Other")
    assert obj.vertex_groups.keys() == ["Mass", "Other"]
    assert obj.vertex_groups.active.name == "Other"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"vertices": "x"}, "whole numbers"),
        ({"vertices": "266"}, "from 0 to 265"),
        ({"vertices": "-1"}, "from 0 to 265"),
        ({}, "All vertices of Sphere are selected"),
    ],
)
def test_vertices_that_cannot_be(arguments, message):
    ball()
    with pytest.raises(RuntimeError, match=message):
        call("drop_density", **arguments)


def test_a_missing_selection_is_reported():
    obj = ball()
    obj.data.vertices.foreach_set("select", np.zeros(len(obj.data.vertices), bool))
    with pytest.raises(RuntimeError, match="No vertex of Sphere is selected"):
        call("drop_density")


def test_loose_vertices_lose_their_weight_and_hold_no_mass():
    obj = ball()
    obj.data.vertices.add(1)
    loose = len(obj.data.vertices) - 1
    obj.vertex_groups["A"].add([loose], 1.0, "REPLACE")
    call("normalize_density")
    assert read_group(obj, "A")[loose] == 0
    with pytest.raises(RuntimeError, match=f"Vertex {loose} is loose"):
        call("drop_density", vertices=str(loose))
    write_group(obj, "A", np.eye(loose + 1)[loose])
    with pytest.raises(RuntimeError, match="loose vertices only"):
        call("normalize_density")


def test_heat_does_not_cross_to_another_piece():
    obj = two_balls()
    before = read_group(obj, "A")
    call("diffuse_density", group="A", length=2.0)
    assert not read_group(obj, "A")[positions(obj)[:, 0] > 2].any()
    assert (read_group(obj, "A")[positions(obj)[:, 0] < 2] > 0).all()
    assert before.any()


def test_hidden_vertices_count_like_others():
    obj = ball()
    hidden = np.ones(len(obj.data.vertices), bool)
    obj.data.vertices.foreach_set("hide", hidden)
    call("diffuse_density", length=0.5)
    assert (read_group(obj, "A") > 0).all()


def test_failed_writing_is_reported():
    obj = ball()
    with pytest.raises(RuntimeError, match="no vertex group Nobody"):
        call("normalize_density", group="Nobody")
    write_group(obj, "Empty", np.zeros(len(obj.data.vertices)))
    with pytest.raises(RuntimeError, match="Empty is empty; paint some weight"):
        call("normalize_density", group="Empty")
    obj.vertex_groups["A"].lock_weight = True
    with pytest.raises(RuntimeError, match="A is locked"):
        call("normalize_density", group="A")


def test_undo_takes_it_back():
    obj = ball()
    bpy.ops.ed.undo_push(message="painted")
    before = read_group(obj, "A")
    call("diffuse_density", length=0.5)
    bpy.ops.ed.undo_push(message="diffused")
    assert not np.array_equal(read_group(bpy.context.object, "A"), before)
    bpy.ops.ed.undo()
    np.testing.assert_array_equal(read_group(bpy.context.object, "A"), before)


def test_ignored_modifiers_are_reported(capfd):
    obj = ball()
    obj.modifiers.new("Finer", "SUBSURF")
    call("normalize_density")
    assert "Modifiers that change the vertices are ignored: Finer" in capfd.readouterr().out


@pytest.mark.parametrize("tool", TOOLS)
def test_tools_need_a_mesh_and_a_mode(tool):
    operator = getattr(bpy.ops.convwass, tool)
    assert not operator.poll()
    bpy.ops.object.empty_add()
    with pytest.raises(RuntimeError, match="Make a mesh object active"):
        operator()
    ball()
    assert operator.poll()
    bpy.ops.object.mode_set(mode="SCULPT")
    with pytest.raises(RuntimeError, match="Go to Object, Weight Paint or Edit Mode first"):
        operator()


@pytest.mark.parametrize("tool", TOOLS[:3])
def test_tools_need_a_group(tool):
    bpy.ops.mesh.primitive_cube_add()
    with pytest.raises(RuntimeError, match="Paint a vertex group first"):
        call(tool)


@pytest.mark.parametrize("tool", TOOLS)
def test_linked_objects_are_not_painted(tool, tmp_path):
    linked(tmp_path)
    with pytest.raises(RuntimeError, match="is linked from another file"):
        call(tool, **({"vertices": "1"} if tool == "drop_density" else {}))


@pytest.fixture
def view():
    """A view from above, orthographic, of two by two meters on 200 by 200 pixels at (100, 50) of the window."""
    return SimpleNamespace(
        type="WINDOW",
        x=100,
        y=50,
        width=200,
        height=200,
        data=SimpleNamespace(
            is_perspective=False,
            view_perspective="ORTHO",
            view_matrix=Matrix.Translation((0, 0, -10)),
            perspective_matrix=Matrix.Diagonal(Vector((1, 1, -0.01, 1))),
        ),
    )


def click(x, y):
    return SimpleNamespace(type="LEFTMOUSE", value="PRESS", mouse_x=x, mouse_y=y)


def test_a_click_drops_mass_where_the_surface_is(view, monkeypatch):
    obj = ball()
    context = window_context()
    context.window.screen.areas.append(SimpleNamespace(type="VIEW_3D", regions=[view], tag_redraw=lambda: None))
    pressed = Pressed(CONVWASS_OT_drop_density, vertices="")
    pretend_window(monkeypatch, density_pick)
    assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    assert pressed.modal(context, click(10, 10)) == {"PASS_THROUGH"}
    assert pressed.modal(context, SimpleNamespace(type="MIDDLEMOUSE", value="PRESS")) == {"PASS_THROUGH"}
    assert pressed.modal(context, click(102, 52)) == {"RUNNING_MODAL"}
    assert "click on its surface" in pressed.reports[-1][1]
    del pressed.arguments["vertices"]
    # Half a meter to the right of the middle of the view, on the upper half of the ball.
    assert pressed.modal(context, click(250, 150)) == {"RUNNING_MODAL"}
    assert until(pressed, context) == {"FINISHED"}
    point = center(obj, read_group(obj, "A"))
    np.testing.assert_allclose(point, [0.5, 0, np.sqrt(0.75)], atol=0.2)
    assert pressed.vertices.isdecimal()


def test_picking_can_be_given_up(view, monkeypatch):
    obj = ball()
    before = read_group(obj, "A")
    context = window_context()
    pressed = Pressed(CONVWASS_OT_drop_density)
    pretend_window(monkeypatch, density_pick)
    assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    assert pressed.modal(context, ESCAPE) == {"CANCELLED"}
    pressed.invoke(context, None)
    context.object = None
    assert pressed.modal(context, click(250, 150)) == {"CANCELLED"}
    np.testing.assert_array_equal(read_group(obj, "A"), before)


@pytest.mark.parametrize("kind", ["UI", "TOOLS", "HEADER", "TOOL_HEADER", "HUD", "ASSET_SHELF"])
def test_what_lies_over_a_view_is_not_clicked_through(view, kind):
    over = SimpleNamespace(type=kind, x=200, y=50, width=100, height=200)
    window = SimpleNamespace(screen=SimpleNamespace(areas=[SimpleNamespace(type="VIEW_3D", regions=[view, over])]))
    assert picking.view_at(window, 150, 100) is view
    assert picking.view_at(window, 250, 100) is None


def test_stopping_rarely_checked_work_does_not_block_the_window(monkeypatch):
    """A factorization cannot be stopped; Esc is taken in at once all the same, and nothing is written."""
    obj = ball()
    before = read_group(obj, "A")
    begun, going = threading.Event(), threading.Event()

    def slow(weights, *_):
        begun.set()
        assert going.wait(30)
        return weights

    monkeypatch.setattr(density_tools, "diffused", slow)
    context = window_context()
    pressed = Pressed(CONVWASS_OT_diffuse_density)
    pretend_window(monkeypatch)
    assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    assert begun.wait(30)
    assert pressed.modal(context, ESCAPE) == {"PASS_THROUGH"}
    assert context.window_manager.convwass_progress.message == "Stopping"
    began = time.monotonic()
    assert pressed.modal(context, TIMER) == {"PASS_THROUGH"}
    assert time.monotonic() - began < 0.4
    going.set()
    assert until(pressed, context) == {"CANCELLED"}
    np.testing.assert_array_equal(read_group(obj, "A"), before)
