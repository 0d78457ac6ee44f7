# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of inputs: editing, checking, and baking."""

from __future__ import annotations

import sys
import threading
import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs import shape_check
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.morphs.inputs.input_checks import face_count
from convwass_addon.bridge.morphs.stored import frame_objects, stored_inputs, stored_morph, stored_settings
from convwass_addon.operators import morph_inputs as morph_inputs_operators, shape_checks
from convwass_addon.operators.chosen_inputs import split_names
from convwass_addon.properties import morph_inputs
from tests.operators.morphs import add, baked_morph
from tests.operators.running import ESCAPE, Pressed, is_computing, started, until, window_context
from tests.scene import linked, select_only
from tests.searches import counted_searches

pytestmark = pytest.mark.usefixtures("empty_scene")

QUICK = {"frames": 2, "resolution": 24}


@pytest.fixture
def shapes():
    """Three meshes, all selected, of the names B, A and C from left to right."""
    made = [
        add("cube", "B", size=2, location=(-3, 0, 0)),
        add("uv_sphere", "A", segments=16, ring_count=8),
        add("cone", "C", location=(4, 0, 0)),
    ]
    select_only(*made)
    return made


def settings():
    return bpy.context.scene.convwass_morph


def listed():
    return [item.object.name for item in settings().inputs]


def test_adding_keeps_the_order_and_skips_duplicates(shapes):
    assert bpy.ops.convwass.add_morph_inputs() == {"FINISHED"}
    assert listed() == ["A", "B", "C"]
    assert bpy.ops.convwass.add_morph_inputs() == {"FINISHED"}
    assert listed() == ["A", "B", "C"]
    bpy.ops.convwass.clear_morph_inputs()
    settings().order = "LEFT_TO_RIGHT"
    bpy.ops.convwass.add_morph_inputs()
    assert listed() == ["B", "A", "C"]


def test_only_shapes_are_added(shapes):
    bpy.ops.object.empty_add()
    select_only(*shapes, bpy.context.object)
    bpy.ops.convwass.add_morph_inputs()
    assert listed() == ["A", "B", "C"]
    select_only()
    with pytest.raises(RuntimeError, match="Select meshes, texts, curves"):
        bpy.ops.convwass.add_morph_inputs()


def test_the_active_one_or_the_one_of_an_index_is_removed(shapes):
    bpy.ops.convwass.add_morph_inputs()
    assert settings().active_input == 2
    bpy.ops.convwass.remove_morph_input()
    assert (listed(), settings().active_input) == (["A", "B"], 1)
    bpy.ops.convwass.remove_morph_input(index=0)
    assert (listed(), settings().active_input) == (["B"], 0)
    with pytest.raises(RuntimeError, match="no item 7"):
        bpy.ops.convwass.remove_morph_input(index=7)
    bpy.ops.convwass.remove_morph_input()
    with pytest.raises(RuntimeError, match="input list is empty"):
        bpy.ops.convwass.remove_morph_input()
    assert len(bpy.data.objects) == 3


def test_moving_stops_at_the_ends_and_keeps_the_active_one(shapes):
    bpy.ops.convwass.add_morph_inputs()
    bpy.ops.convwass.move_morph_input(direction="UP")
    assert (listed(), settings().active_input) == (["A", "C", "B"], 1)
    bpy.ops.convwass.move_morph_input(index=0, direction="DOWN")
    assert (listed(), settings().active_input) == (["C", "A", "B"], 0)
    assert bpy.ops.convwass.move_morph_input(direction="UP") == {"CANCELLED"}
    assert bpy.ops.convwass.move_morph_input(index=2, direction="DOWN") == {"CANCELLED"}
    assert listed() == ["C", "A", "B"]


def test_undo_brings_the_list_back(shapes):
    bpy.ops.convwass.add_morph_inputs()
    bpy.ops.ed.undo_push(message="added")
    bpy.ops.convwass.clear_morph_inputs()
    bpy.ops.ed.undo_push(message="cleared")
    bpy.ops.ed.undo()
    assert listed() == ["A", "B", "C"]


def test_shapes_are_checked_when_they_are_added_and_when_asked(shapes):
    cube, _, cone = shapes
    add("plane", "D", location=(8, 0, 0))
    select_only(*bpy.data.objects)
    cone.data.clear_geometry()
    bpy.ops.convwass.add_morph_inputs()
    found = {item.object.name: item for item in settings().inputs}
    assert {name: item.verdict for name, item in found.items()} == {
        "A": "SOUND",
        "B": "SOUND",
        "C": "UNUSABLE",
        "D": "NO_VOLUME",
    }
    assert "C is an empty mesh" in found["C"].finding
    assert "Thickness" in found["D"].finding
    assert [item.warns for item in settings().inputs] == [False, False, True, True]
    # Nothing is noticed before it is asked for.
    cube.data.polygons[0].flip()
    cube.data.update_tag()
    bpy.context.view_layer.update()
    assert found["B"].verdict == "SOUND"
    bpy.ops.convwass.check_morph_inputs(index=1)
    assert (found["B"].verdict, found["B"].finding[:19]) == ("FLIPPED", "2 flipped triangles")


def test_holes_are_found(shapes):
    import bmesh

    cube = shapes[0]
    mesh = bmesh.new()
    mesh.from_mesh(cube.data)
    mesh.faces.ensure_lookup_table()
    bmesh.ops.delete(mesh, geom=[mesh.faces[0]], context="FACES_ONLY")
    mesh.to_mesh(cube.data)
    mesh.free()
    bpy.ops.convwass.add_morph_inputs()
    item = next(item for item in settings().inputs if item.object == cube)
    assert (item.verdict, item.finding[:24]) == ("HOLES", "Holes with 4 open edges;")


def test_the_warning_states_the_problem(shapes):
    from convwass_addon.operators.morph_inputs import CONVWASS_OT_check_morph_inputs

    class Properties:
        index = 0

    bpy.ops.convwass.add_morph_inputs()
    settings().inputs[0].finding = "It is bad"
    assert CONVWASS_OT_check_morph_inputs.description(bpy.context, Properties).startswith("It is bad.")
    Properties.index = -1
    assert CONVWASS_OT_check_morph_inputs.description(bpy.context, Properties).startswith("Check the shapes")


def test_the_list_is_baked_rather_than_the_selection(shapes):
    bpy.ops.convwass.add_morph_inputs()
    bpy.ops.convwass.move_morph_input(index=0, direction="DOWN")
    settings().inputs[2].enabled = False
    select_only(shapes[2])
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK) == {"FINISHED"}
    assert [obj.name for obj in stored_inputs(baked_morph())] == ["B", "A"]


def test_names_are_baked_rather_than_the_list(shapes):
    bpy.ops.convwass.add_morph_inputs()
    select_only()
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="C, A") == {"FINISHED"}
    assert stored_morph(baked_morph()).inputs == ["C", "A"]


def test_names_with_commas_are_on_separate_lines(shapes):
    shapes[0].name = "Cow, brown"
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="Cow, brown\nA\n")
    assert stored_morph(baked_morph()).inputs == ["Cow, brown", "A"]
    assert split_names(" a ,b,, c d ") == ["a", "b", "c d"]
    assert split_names(" a \n b \n", [" a "]) == [" a ", "b"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"inputs": "A, Nobody"}, "no object named Nobody"),
        ({"inputs": "A"}, "Select at least two shapes"),
        ({"inputs": "A, B", "layout": "BLEND", "weights": "1, x"}, "Weights must be numbers"),
        ({"inputs": "A, B", "layout": "BLEND", "weights": "1, 2, 3"}, "each of the 2 inputs, but there are 3"),
        ({"inputs": "A, B", "layout": "BLEND", "weights": "0, 0"}, "All weights are zero"),
    ],
)
def test_wrong_arguments_are_refused_and_leave_nothing_behind(shapes, arguments, message):
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, **arguments)
    assert not bpy.data.collections.get("Morph A to B")
    assert len(bpy.data.objects) == 3


def test_numbers_in_names_are_sorted_by_value(shapes):
    for obj, name in zip(shapes, ("Step 10", "step 9", "Step 1"), strict=True):
        obj.name = name
    bpy.ops.convwass.add_morph_inputs()
    assert listed() == ["Step 1", "step 9", "Step 10"]


def test_a_deleted_shape_is_reported(shapes):
    bpy.ops.convwass.add_morph_inputs()
    select_only(shapes[0])
    bpy.ops.object.delete()
    with pytest.raises(RuntimeError, match="B on the input list was deleted"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    bpy.ops.convwass.check_morph_inputs()
    assert settings().inputs[1].verdict == "UNUSABLE"


def test_a_shape_that_no_longer_exists_is_numbered(shapes):
    bpy.ops.convwass.add_morph_inputs()
    settings().inputs[0].enabled = False
    bpy.data.objects.remove(shapes[0])
    with pytest.raises(RuntimeError, match="Shape 2 on the input list no longer exists"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)


def test_a_shape_of_another_scene_is_not_called_deleted(shapes):
    bpy.ops.convwass.add_morph_inputs()
    bpy.data.scenes.new("Elsewhere").collection.objects.link(shapes[2])
    bpy.context.scene.collection.objects.unlink(shapes[2])
    with pytest.raises(RuntimeError, match="C on the input list is not in this scene but in Elsewhere"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    settings().inputs[2].enabled = False
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK) == {"FINISHED"}


def test_a_single_blend_takes_the_weights_of_the_list(shapes):
    bpy.ops.convwass.add_morph_inputs()
    for item, weight in zip(settings().inputs, (3.0, 1.0, 0.0), strict=True):
        item.weight = weight
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="BLEND", resolution=24) == {"FINISHED"}
    (blend,) = frame_objects(baked_morph())
    np.testing.assert_allclose(blend["convwass_weights"], (0.75, 0.25, 0.0))
    assert not blend.hide_render


def test_weights_can_be_named(shapes):
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="BLEND", resolution=24, inputs="A,B", weights="1, 3")
    np.testing.assert_allclose(frame_objects(baked_morph())[0]["convwass_weights"], (0.25, 0.75))


def world_points(obj):
    return element_values(obj.data.vertices, "co", 3)


def test_aligned_shapes_are_at_the_place_of_the_first_in_all_frames(shapes):
    cube, ball, _ = shapes
    cube.rotation_euler.z = 0.4
    ball.scale = (1.5, 0.7, 1.0)
    bpy.context.view_layer.update()
    bpy.ops.convwass.bake_morph(
        motion="TRANSPORT",
        frames=3,
        resolution=32,
        inputs="B, A",
        alignment="CENTERED",
        scaling="EQUAL_VOLUME",
        hide_inputs=False,
    )
    frames = frame_objects(baked_morph())
    assert len(frames) == 4
    for obj in frames:
        points = world_points(obj)
        np.testing.assert_allclose((points.min(axis=0) + points.max(axis=0)) / 2, (-3, 0, 0), atol=0.1)
        assert obj.location.length == 0.0
    volumes = [summary_volume(obj) for obj in frames]
    np.testing.assert_allclose(volumes, 8.0, rtol=0.02)
    # The originals are not moved.
    assert (ball.location.x, ball.scale.x) == (0.0, 1.5)
    stored = stored_settings(baked_morph())
    assert (stored["alignment"], stored["scaling"]) == ("CENTERED", "EQUAL_VOLUME")


def summary_volume(obj):
    import bmesh

    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    try:
        return mesh.calc_volume(signed=True)
    finally:
        mesh.free()


def test_principal_axes_turn_a_copy_back(shapes):
    one = add("cone", "One", vertices=3, radius1=1.0, depth=3.0, location=(0, 0, 5))
    one.data.transform(__import__("mathutils").Matrix.Diagonal((1.6, 1.0, 1.0, 1.0)))
    other = one.copy()
    bpy.context.scene.collection.objects.link(other)
    other.name, other.location, other.rotation_euler = "Other", (5, 1, 0), (0.8, 0.3, 1.9)
    bpy.context.view_layer.update()
    bpy.ops.convwass.bake_morph(
        motion="TRANSPORT", frames=2, resolution=24, inputs="One, Other", alignment="PRINCIPAL_AXES"
    )
    first, _, last = frame_objects(baked_morph())
    np.testing.assert_allclose(world_points(last), world_points(first), atol=1e-4)


@pytest.mark.parametrize(
    ("arguments", "first", "span"),
    [
        ({}, 5, (5, 50)),
        ({"start": "CURRENT"}, 40, (5, 50)),
        ({"start": "CUSTOM", "frame_start": 100}, 100, (5, 50)),
        ({"start": "CUSTOM", "frame_start": -10}, -10, (5, 50)),
        ({"fit_range": True}, 5, (5, 7)),
        ({"start": "CUSTOM", "frame_start": 100, "fit_range": True}, 100, (100, 102)),
    ],
)
def test_a_morph_begins_at_the_given_frame(shapes, arguments, first, span):
    """The scene keeps its frame range unless the option to change it is set."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 5, 50
    scene.frame_set(40)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="A,B", **arguments)
    assert stored_morph(baked_morph()).first_frame == first
    assert (scene.frame_start, scene.frame_end) == span


def test_a_step_skips_frames_but_no_shapes(shapes):
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=5, frame_step=2, resolution=24, inputs="A,B,C")
    frames = frame_objects(baked_morph())
    assert len(frames) == 7
    scene = bpy.context.scene
    shown = []
    for number in range(1, 12):
        scene.frame_set(number)
        shown.append([index for index, obj in enumerate(frames) if not obj.hide_render])
    assert shown == [[0], [0], [1], [1], [2], [3], [3], [4], [4], [5], [6]]


def test_diagnostics_are_stored_with_a_morph(shapes):
    from convwass_addon.bridge.morphs.stored import DIAGNOSTICS_KEY, stored_diagnostics

    thin = add("cylinder", "Thin", radius=0.08, depth=3.0, location=(0, 0, 2))
    ball = shapes[1]
    select_only(thin, ball)
    bpy.context.view_layer.objects.active = ball
    bpy.ops.object.join()
    ball.name = "A"
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=40, inputs="A, B", thickness=0.1)
    collection = baked_morph()
    kinds = {note.kind for note in stored_diagnostics(collection)}
    assert "TOO_COARSE" in kinds
    assert any("thin parts of A" in note.text for note in stored_diagnostics(collection))
    for damage in ("", "[", "[1]", '[["GOOD"]]', '[["NO SUCH", {}]]', '[["LOST", {}]]', '{"a": 1}'):
        collection[DIAGNOSTICS_KEY] = damage
        assert stored_diagnostics(collection) == []


def test_selecting_the_inputs_of_a_morph_brings_back_their_order_and_weights(shapes):
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="B, A")
    bpy.ops.convwass.select_morph_inputs()
    assert listed() == ["B", "A"]
    delete_morph()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="BLEND", resolution=24, inputs="A,B", weights="1, 3")
    bpy.ops.convwass.select_morph_inputs()
    assert [item.weight for item in settings().inputs] == [1.0, 3.0]
    assert settings().layout == "BLEND"
    delete_morph()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="A,B")
    bpy.ops.convwass.select_morph_inputs()
    assert listed() == []


def delete_morph():
    bpy.context.view_layer.objects.active = frame_objects(baked_morph())[0]
    bpy.ops.convwass.delete_morph()


@pytest.mark.parametrize(
    ("arguments", "kind"),
    [
        ({"output": "OBJECTS"}, None),
        ({"output": "PLAYER"}, "MESH"),
        ({"output": "PLAYER", "layout": "TRIANGLE", "steps": 2, "inputs": "A,B,C"}, "EMPTY"),
    ],
)
def test_the_output_is_made_of_the_morph(shapes, arguments, kind):
    before = set(bpy.data.objects)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **{**QUICK, "inputs": "A,B", **arguments})
    frames = set(frame_objects(baked_morph()))
    made = set(bpy.data.objects) - before - frames
    assert bool(made) == (kind is not None)
    assert kind is None or bpy.context.object.type == kind


def test_an_output_that_fails_leaves_the_meshes(shapes, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "openvdb", None)
    folder = str(tmp_path / "folder")
    made = bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="A,B", output="VOLUME", folder=folder)
    assert made == {"FINISHED"}
    assert len(frame_objects(baked_morph())) == 3


@pytest.mark.parametrize("output", ["CACHE", "VOLUME"])
def test_a_folder_that_cannot_be_is_refused_before_the_bake(shapes, tmp_path, output):
    """A file that was never saved has no folder."""
    known = len(bpy.data.objects)
    with pytest.raises(RuntimeError, match="Save the file first"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="A,B", output=output)
    (tmp_path / "file").touch()
    with pytest.raises(RuntimeError, match="is a file; choose a folder"):
        bpy.ops.convwass.bake_morph(
            motion="TRANSPORT", **QUICK, inputs="A,B", output=output, folder=str(tmp_path / "file")
        )
    inside = str(tmp_path / "file" / "folder")
    with pytest.raises(RuntimeError, match=f"{inside} cannot be written to; choose another one"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, inputs="A,B", output=output, folder=inside)
    assert len(bpy.data.objects) == known


def test_every_property_and_operator_explains_itself():
    from convwass_addon.preferences import CONVWASS_AP_preferences
    from convwass_addon.properties.morph_inputs import CONVWASS_PG_input, CONVWASS_PG_morph
    from convwass_addon.properties.progress import CONVWASS_PG_progress

    base = {prop.identifier for prop in bpy.types.PropertyGroup.bl_rna.properties}
    base |= {prop.identifier for prop in bpy.types.AddonPreferences.bl_rna.properties}
    own = [CONVWASS_PG_input, CONVWASS_PG_morph, CONVWASS_PG_progress, CONVWASS_AP_preferences]
    groups = [(cls.__name__, [p for p in cls.bl_rna.properties if p.identifier not in base]) for cls in own]
    # What Blender's own preset operator brings along is not ours to explain.
    blenders = {"rna_type", "name", "remove_name", "remove_active"}
    for name in dir(bpy.ops.convwass):
        operator = getattr(bpy.ops.convwass, name).get_rna_type()
        assert operator.description, name
        assert not operator.description.endswith("."), name
        # Hidden properties, such as the file extensions of a dialog, have no labels.
        seen = [prop for prop in operator.properties if not prop.is_hidden]
        groups.append((name, [prop for prop in seen if prop.identifier not in blenders]))
    for name, properties in groups:
        for prop in properties:
            assert prop.name, (name, prop.identifier)
            assert prop.description, (name, prop.identifier)
            assert not prop.description.endswith("."), (name, prop.identifier)


def test_metaballs_that_are_joined_are_one_shape(empty_scene):
    for x in (0.0, 1.0):
        bpy.ops.object.metaball_add(location=(x, 0, 0))
    bpy.ops.mesh.primitive_cube_add(location=(6, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=16) == {"FINISHED"}
    (morph,) = (collection for collection in bpy.data.collections if "convwass_morph" in collection)
    assert stored_inputs(morph) == [bpy.data.objects["Cube"], bpy.data.objects["Mball"]]
    frames = frame_objects(morph)
    assert frames[-1].dimensions.x == pytest.approx(bpy.data.objects["Mball"].dimensions.x, rel=0.1)
    # One that has no surface of its own stands for all.
    assert bpy.ops.convwass.bake_morph(inputs="Cube, Mball.001", motion="TRANSPORT", frames=2, resolution=16) == {
        "FINISHED"
    }


def test_several_objects_that_are_one_shape_are_told(empty_scene):
    for x in (0.0, 9.0):
        bpy.ops.object.metaball_add(location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    with pytest.raises(RuntimeError, match=r"Mball and Mball\.001 are one surface"):
        bpy.ops.convwass.bake_morph(**QUICK)
    bpy.data.objects["Mball.001"].name = "Blob"
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK) == {"FINISHED"}


def test_several_objects_of_one_parent_are_told(shapes):
    for part in shapes[1:]:
        part.parent = shapes[0]
    with pytest.raises(RuntimeError, match=r"parts of one shape, B; .* or set Shapes to Objects"):
        bpy.ops.convwass.bake_morph(grouping="PARENTS", **QUICK)


def test_the_file_is_searched_once_for_a_list_of_objects(shapes, monkeypatch):
    """Shapes and what has children can be chosen, also soon after that has changed."""
    clock = [1.0]
    monkeypatch.setattr(morph_inputs, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    monkeypatch.setattr(morph_inputs, "_PARENTS", morph_inputs._Parents())
    rig, empty, other = (linked(name, None) for name in ("Rig", "Empty", "Other"))
    other.parent = rig
    searches = counted_searches(monkeypatch, morph_inputs)

    def chosen_among():
        searches.clear()
        return [obj for obj in (*shapes, rig, empty, other) if morph_inputs._is_shape(None, obj)]

    assert chosen_among() == [*shapes, rig]
    assert searches == {"objects": 1}
    other.parent = empty
    clock[0] += 0.2
    assert chosen_among() == [*shapes, empty]
    assert searches == {"objects": 1}


def shapes_selected(shapes):
    context = window_context()
    context.selected_objects = shapes
    return context


def unchecked(shapes, operator):
    """An operator that checks shapes, and the context to press it in; what it checks has not been checked."""
    if operator == "check_morph_inputs":
        bpy.ops.convwass.add_morph_inputs()
        for item in settings().inputs:
            item.verdict = "UNCHECKED"
    return Pressed(getattr(morph_inputs_operators, f"CONVWASS_OT_{operator}")), shapes_selected(shapes)


@pytest.fixture
def many_faces(monkeypatch):
    """Let a single face count as many."""
    monkeypatch.setattr(shape_checks, "_AT_ONCE", 0)


@pytest.mark.usefixtures("many_faces")
@pytest.mark.parametrize("operator", ["add_morph_inputs", "check_morph_inputs"])
def test_shapes_are_checked_in_the_background(shapes, operator):
    pressed, context = unchecked(shapes, operator)
    shapes[1].data.polygons[0].flip()
    shapes[1].data.update_tag()
    assert started(pressed, context)
    # What is on the list is there at once; meanwhile it may be sorted, and get shorter.
    assert listed() == ["A", "B", "C"]
    assert {item.verdict for item in settings().inputs} == {"UNCHECKED"}
    bpy.ops.convwass.move_morph_input(index=0, direction="DOWN")
    bpy.ops.convwass.remove_morph_input(index=2)
    assert until(pressed, context) == {"FINISHED"}
    assert [(item.object.name, item.verdict) for item in settings().inputs] == [("B", "SOUND"), ("A", "FLIPPED")]
    if operator == "check_morph_inputs":
        assert pressed.reports == [("WARNING", "Shapes with problems: 1 of 2")]


@pytest.mark.usefixtures("many_faces")
@pytest.mark.parametrize("operator", ["add_morph_inputs", "check_morph_inputs"])
def test_a_check_can_be_stopped(shapes, operator, monkeypatch):
    pressed, context = unchecked(shapes, operator)
    checking = threading.Event()

    def endless(mesh, control):
        checking.set()
        while True:
            control.check()
            time.sleep(0.005)

    monkeypatch.setattr(shape_check, "check_shape", endless)
    assert started(pressed, context)
    assert until(pressed, context, checking.is_set) == {"PASS_THROUGH"}
    until(pressed, context, event=ESCAPE)
    assert not is_computing()
    assert listed() == ["A", "B", "C"]
    assert {item.verdict for item in settings().inputs} == {"UNCHECKED"}
    (report,) = pressed.reports
    assert report[0] == "INFO"
    assert report[1].startswith("Stopped; ")


@pytest.mark.usefixtures("many_faces")
@pytest.mark.parametrize("operator", ["add_morph_inputs", "check_morph_inputs"])
def test_shapes_are_checked_at_once_while_a_job_runs(shapes, operator):
    pressed, context = unchecked(shapes, operator)
    context.window_manager.convwass_progress.running = True
    assert not started(pressed, context)
    assert {item.verdict for item in settings().inputs} == {"SOUND"}
    assert context.window_manager.convwass_progress.running


@pytest.mark.parametrize("operator", ["add_morph_inputs", "check_morph_inputs"])
def test_few_faces_are_checked_at_once(shapes, operator):
    kind = getattr(morph_inputs_operators, f"CONVWASS_OT_{operator}")
    bpy.ops.convwass.add_morph_inputs()
    context = shapes_selected(shapes)
    assert not started(Pressed(kind), context)
    assert {item.verdict for item in settings().inputs} == {"SOUND"}
    modifier = shapes[0].modifiers.new("Fine", "SUBSURF")
    modifier.subdivision_type, modifier.levels = "SIMPLE", 7
    pressed = Pressed(kind)
    assert started(pressed, context)
    assert until(pressed, context) == {"FINISHED"}


def test_faces_of_children_and_instances_count(shapes):
    def depsgraph_of():
        return bpy.context.evaluated_depsgraph_get()

    assert face_count(shapes[:1], depsgraph_of()) == 6
    shapes[0].parent = shapes[2]
    assert face_count(shapes[::2], depsgraph_of()) == 6 + len(shapes[2].data.polygons)
    assert face_count(shapes[2:], depsgraph_of()) == 6 + len(shapes[2].data.polygons)
    shapes[0].instance_type = "VERTS"
    assert face_count(shapes[2:], depsgraph_of()) == np.inf
