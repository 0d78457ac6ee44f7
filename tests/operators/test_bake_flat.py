# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator with flat shapes, in a Blender without a window."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.flat.flat_pieces import filled_by
from convwass_addon.bridge.flat.flat_objects import flat_objects
from convwass_addon.bridge.keyframes import driver_targets
from convwass_addon.bridge.morphs.changes import changed_inputs
from convwass_addon.bridge.morphs.players.player_inputs import is_player
from convwass_addon.bridge.morphs.stored import frame_objects, stored_morph, stored_settings
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.visibility import update_places
from tests.bridge.test_flat import drawing, square
from tests.operators.morphs import baked_morph, census
from tests.scene import linked, select_only

pytestmark = pytest.mark.usefixtures("empty_scene")

QUICK = {"frames": 3, "flat_resolution": 128}


def text(body, x=0.0, **options):
    bpy.ops.object.text_add(location=(x, 0, 0))
    obj = bpy.context.object
    obj.name = obj.data.body = body
    for name, value in options.items():
        setattr(obj.data, name, value)
    return obj


def enclosed(obj):
    """Area that Blender fills of a frame."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    curve = obj.data.copy()
    curve.extrude = curve.bevel_depth = 0.0
    mesh = bpy.data.meshes.new_from_object(bpy.data.objects.new("Copy", curve), depsgraph=depsgraph)
    return sum(face.area for face in mesh.polygons)


def flat_area(flat):
    return filled_by(flat.shape, np.arange(len(flat.shape.rings))).area


def test_a_word_becomes_another_with_the_originals_at_both_ends():
    first, last = text("A", extrude=0.2, bevel_depth=0.02), text("B", 4.0)
    select_only(first, last)
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK) == {"FINISHED"}
    frames = frame_objects(baked_morph())
    assert [obj.type for obj in frames] == ["FONT", "CURVE", "CURVE", "FONT"]
    assert [frames[0].data.body, frames[-1].data.body] == ["A", "B"]
    np.testing.assert_allclose([obj.data.extrude for obj in frames], [0.2, 0.4 / 3, 0.2 / 3, 0.0], atol=1e-6)
    np.testing.assert_allclose([obj.data.bevel_depth for obj in frames], [0.02, 0.04 / 3, 0.02 / 3, 0.0], atol=1e-6)
    for number in range(-1, 8):
        bpy.context.scene.frame_set(number)
        assert [obj for obj in frames if not obj.hide_render] == [frames[min(max(number, 1), 4) - 1]]
    assert first.hide_render and last.hide_render
    # The solver's area equals the area that Blender fills.
    wanted = [record["area_wanted"] for record in stored_morph(baked_morph()).records[1:-1]]
    np.testing.assert_allclose([enclosed(obj) for obj in frames[1:-1]], wanted, rtol=5e-3)
    stored = stored_settings(baked_morph())
    assert (stored["flat"], stored["resolution"], stored["words"]) == (True, 128, "MASS")


def test_frames_lie_between_the_planes_of_the_inputs():
    first, last = text("A"), text("A", 6.0)
    last.location.z = 3.0
    select_only(first, last)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    for share, obj in zip((1 / 3, 2 / 3), frame_objects(baked_morph())[1:-1], strict=True):
        points = np.array([point.co[:] for spline in obj.data.splines for point in spline.bezier_points])
        world = points @ np.array(obj.matrix_world)[:3, :3].T + np.array(obj.matrix_world.translation)
        low, high = world.min(axis=0), world.max(axis=0)
        np.testing.assert_allclose((low + high) / 2, (0.3335 + 6 * share, 0.343, 3 * share), atol=0.03)
        assert np.ptp(world[:, 2]) < 1e-5


@pytest.mark.parametrize("made", ["FONT", "CURVE", "MESH"])
def test_sheared_shapes_are_shown_at_the_ends(made):
    """A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give."""
    first, last = text("L"), text("V", 4.0)
    if made != "FONT":
        select_only(first)
        bpy.context.view_layer.objects.active = first
        bpy.ops.object.convert(target=made)
    first.data.materials.append(bpy.data.materials.new("Gold"))
    parent = linked("Stretch", None)
    parent.scale.x, first.parent, first.rotation_euler.z = 3.0, parent, 0.6
    (expected,) = flat_objects([first], bpy.context.evaluated_depsgraph_get())
    select_only(first, last)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    shown = frame_objects(baked_morph())[0]
    (found,) = flat_objects([shown], bpy.context.evaluated_depsgraph_get())
    for pick in (np.min, np.max):
        np.testing.assert_allclose(pick(found.read.points, axis=0), pick(expected.read.points, axis=0), atol=1e-3)
    assert flat_area(found) == pytest.approx(flat_area(expected), rel=1e-3)
    assert shown.active_material.name == "Gold"


def test_sheared_drawings_are_shown_at_the_ends():
    first, last = drawing([square(2.0), square(1.0, 3.0)], [1, 2]), drawing([square(2.0)], [1])
    layer = first.data.layers[0]
    layer.translation, layer.rotation, layer.scale = (1.0, 0.0, 0.5), (0.0, 0.4, 0.0), (1.0, 1.0, 2.0)
    # Another keyframe of the same drawing is sheared only once.
    layer.frames.copy(1, 5, instance_drawing=True)
    parent = linked("Stretch", None)
    parent.scale.x, first.parent, first.rotation_euler.y, last.location.x = 3.0, parent, 0.6, 20.0
    (expected,) = flat_objects([first], bpy.context.evaluated_depsgraph_get())
    select_only(first, last)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    shown = frame_objects(baked_morph())[0]
    assert shown.type == "GREASEPENCIL"
    (found,) = flat_objects([shown], bpy.context.evaluated_depsgraph_get())
    for pick in (np.min, np.max):
        np.testing.assert_allclose(pick(found.read.points, axis=0), pick(expected.read.points, axis=0), atol=1e-3)
    assert flat_area(found) == pytest.approx(flat_area(expected), rel=1e-3)


def test_drawings_are_shown_as_they_are_now_and_with_the_parents_of_their_layers():
    first, last = drawing([square(2.0)], [1]), drawing([square(3.0)], [1])
    layer = first.data.layers[0]
    redraw(first, 3, drawing([square(4.0)], [1]))
    redraw(last, 9, drawing([square(1.0)], [1]))
    rig = linked("Rig", None)
    rig.location, rig.scale.x, layer.parent = (20.0, 0.0, 5.0), 2.0, rig
    bpy.context.scene.frame_set(3)
    select_only(first, last)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", start="CURRENT", **QUICK)
    rig.location.z = 50.0
    frames = frame_objects(baked_morph())
    for number, obj, size, place in ((1, frames[0], (8, 4), (20, 5)), (12, frames[-1], (3, 3), (0, 0))):
        bpy.context.scene.frame_set(number)
        (flat,) = flat_objects([obj], bpy.context.evaluated_depsgraph_get())
        low, high = (pick(flat.read.points, axis=0)[[0, 2]] for pick in (np.min, np.max))
        np.testing.assert_allclose((high - low, (high + low) / 2), (size, place), atol=1e-5)


def test_drawings_that_a_modifier_retimes_stay_so():
    first, last = drawing([square(2.0)], [1]), drawing([square(3.0)], [1])
    redraw(first, 9, drawing([square(4.0)], [1]))
    modifier = first.modifiers.new("Fixed", "GREASE_PENCIL_TIME")
    modifier.mode, modifier.offset = "FIX", 9
    select_only(first, last)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert filled(frame_objects(baked_morph())[0], 1).area == pytest.approx(16.0)


def redraw(obj, number, other):
    """Add a keyframe with the strokes of another drawing."""
    points = [point.position[:] for point in other.data.layers[0].frames[0].drawing.strokes[0].points]
    stroke = obj.data.layers[0].frames.copy(1, number).drawing.strokes[0]
    for point, place in zip(stroke.points, points, strict=True):
        point.position = place
    bpy.data.objects.remove(other)


def test_letters_travel_to_letters():
    first, last = text("IO"), text("OI", 0.0)
    select_only(first, last)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", words="LETTERS", **QUICK)
    stored = stored_settings(baked_morph())
    assert stored["words"] == "LETTERS"
    assert len(frame_objects(baked_morph())) == 4


def test_meshes_and_a_player_are_made_on_request():
    first, last = text("A", extrude=0.1), text("B", 3.0)
    select_only(first, last)
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", output="PLAYER", **QUICK) == {"FINISHED"}
    frames = frame_objects(baked_morph())
    assert {obj.type for obj in frames} == {"MESH"}
    assert [obj.name for obj in frames] == [f"Morph {number:04d}" for number in range(1, 5)]
    assert all(len(obj.data.polygons) > 10 for obj in frames)
    player = bpy.context.object
    assert is_player(player)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    bpy.context.scene.frame_set(1)
    shown = player.evaluated_get(depsgraph)
    assert len(shown.data.polygons) == len(frames[0].data.polygons)
    # Half of its depth is above, half below.
    assert max(vertex.co.z for vertex in shown.data.vertices) == pytest.approx(0.1)


def test_curves_meshes_and_words_mix():
    bpy.ops.curve.primitive_bezier_circle_add(location=(-4, 0, 0))
    ring = bpy.context.object
    bpy.ops.mesh.primitive_plane_add(location=(4, 0, 0))
    plane = bpy.context.object
    select_only(ring, plane, text("A"))
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", inputs=f"{ring.name},{plane.name},A", **QUICK) == {
        "FINISHED"
    }
    assert [obj.type for obj in frame_objects(baked_morph())] == ["CURVE"] * 3 + ["MESH"] + ["CURVE"] * 2 + ["FONT"]


def test_a_sheet_lies_in_the_plane_of_the_shapes():
    letters = [text(sign, 5.0 * index) for index, sign in enumerate("ABC")]
    select_only(*letters)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="TRIANGLE", steps=3, flat_resolution=128)
    frames = frame_objects(baked_morph())
    places = np.array([obj.matrix_world.translation for obj in frames])
    assert len(frames) == 6
    np.testing.assert_allclose(places[:, 2], 0.0, atol=1e-6)
    assert np.ptp(places[:, 1]) > 1.0


def test_shapes_are_centered_and_made_as_large():
    first, last = text("O"), text("O", 7.0, size=3.0)
    select_only(first, last)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", alignment="CENTERED", scaling="EQUAL_VOLUME", **QUICK)
    bpy.context.view_layer.update()
    boxes = []
    for obj in frame_objects(baked_morph()):
        corners = np.array([obj.matrix_world @ type(obj.location)(corner) for corner in obj.bound_box])
        boxes.append((corners.min(axis=0), corners.max(axis=0)))
    np.testing.assert_allclose(boxes[-1], boxes[0], atol=1e-2)


def test_a_solid_shape_takes_a_text_with_depth_or_with_a_thickness():
    bpy.ops.mesh.primitive_cube_add(size=1, location=(3, 0, 0))
    cube, word = bpy.context.object, text("A")
    select_only(cube, word)
    with pytest.raises(RuntimeError, match="A is flat but Cube is solid"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=32)
    assert not any(collection.name.startswith("Morph") for collection in bpy.data.collections)
    word.data.extrude = 0.2
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=32) == {"FINISHED"}
    assert {obj.type for obj in frame_objects(baked_morph())} == {"MESH"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda obj: setattr(obj.data, "body", " "), "is empty; type something"),
        (lambda obj: setattr(obj, "scale", (0, 1, 1)), "flattened to a line"),
        (lambda obj: setattr(obj, "scale", (1e-3, 1e-3, 1)), "too small next to the others.*Equal Volume"),
    ],
)
def test_invalid_shapes_are_reported_and_leave_nothing_behind(change, message):
    first, last = text("A"), text("B", 3.0)
    change(last)
    select_only(first, last)
    before = census()
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert census() == before


def test_volumes_are_refused():
    select_only(text("A"), text("B", 3.0))
    with pytest.raises(RuntimeError, match="Flat shapes have no volume"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", output="VOLUME", **QUICK)


def test_a_flat_morph_is_baked_again_and_deleted():
    first, last = text("A"), text("B", 3.0)
    select_only(first, last)
    before = census()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert changed_inputs(baked_morph()) == []
    last.data.body = "C"
    assert changed_inputs(baked_morph()) == ["B"]
    bpy.context.view_layer.objects.active = frame_objects(baked_morph())[0]
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert frame_objects(baked_morph())[-1].data.body == "C"
    assert stored_settings(baked_morph())["resolution"] == 128
    bpy.context.view_layer.objects.active = frame_objects(baked_morph())[0]
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    after = census()
    after["materials"] = []
    assert after == before


def test_a_shared_material_is_kept():
    material = bpy.data.materials.new("Gold")
    letters = text("A"), text("B", 3.0)
    for letter in letters:
        letter.data.materials.append(material)
    select_only(*letters)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert {slot.material for obj in frame_objects(baked_morph()) for slot in obj.material_slots} == {material}


def test_drawings_are_checked_on_the_list():
    select_only(text("A"), text("B", 3.0))
    bpy.ops.convwass.add_morph_inputs()
    bpy.context.scene.convwass_morph.inputs[0].object.data.body = ""
    bpy.ops.convwass.check_morph_inputs()
    inputs = bpy.context.scene.convwass_morph.inputs
    assert [item.verdict for item in inputs] == ["UNUSABLE", "SOUND"]
    assert "is empty" in inputs[0].finding


def test_curves_become_meshes_for_a_player_and_stay_so():
    select_only(text("A", extrude=0.1), text("B", 3.0))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    before = frame_objects(baked_morph())
    names, places = [obj.name for obj in before], [obj.matrix_world.translation.copy() for obj in before]
    assert bpy.ops.convwass.make_player() == {"FINISHED"}
    frames = frame_objects(baked_morph())
    assert [obj.name for obj in frames] == names
    assert [obj.matrix_world.translation for obj in frames] == places
    assert {obj.type for obj in frames} == {"MESH"}
    assert all(len(obj.data.polygons) for obj in frames)
    assert stored_settings(baked_morph())["flat_output"] == "MESH"
    bpy.ops.convwass.remove_player()
    bpy.context.scene.frame_set(2)
    assert [obj.hide_render for obj in frames] == [True, False, True, True]
    bpy.context.view_layer.objects.active = frames[0]
    with pytest.raises(RuntimeError, match="Flat shapes have no volume"):
        bpy.ops.convwass.make_volume()


def colored(obj, *colors):
    """Give an object materials of plain colors."""
    for number, color in enumerate(colors):
        material = bpy.data.materials.new(f"{obj.name} {number}")
        own_tree(material).nodes["Principled BSDF"].inputs["Base Color"].default_value = color
        obj.data.materials.append(material)
    return obj


def two_letters(body, first, second):
    obj = colored(text(body), first, second)
    obj.data.body_format[1].material_index = 1
    return obj


RED, GREEN, BLUE = (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1)


def region(obj, number):
    return tuple(obj[f"convwass_region_{number}"])


def places(frames):
    """Return the world matrices of frames, also of hidden ones."""
    update_places(frames, bpy.context.evaluated_depsgraph_get())
    return [obj.matrix_world.copy() for obj in frames]


def test_curves_that_become_meshes_keep_their_parent():
    select_only(text("A"), text("B", 3.0))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    parent = linked("Stretch", None)
    parent.scale.x = 3.0
    for obj in frame_objects(baked_morph()):
        obj.parent, obj.rotation_euler.z = parent, 0.6
    before = places(frame_objects(baked_morph()))
    bpy.ops.convwass.make_player()
    frames = frame_objects(baked_morph())
    assert {(obj.type, obj.parent) for obj in frames} == {("MESH", parent)}
    np.testing.assert_allclose(places(frames), before, atol=1e-6)


def test_curves_that_become_meshes_keep_tracks_drivers_and_constraints():
    select_only(text("A"), text("B", 3.0))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    frames, follower = frame_objects(baked_morph()), linked("Follower", None)
    curve, after = frames[1], frames[2]
    own = curve.animation_data
    strip = own.nla_tracks.new().strips.new("Turn", 4, bpy.data.actions.new("Turn"))
    strip.scale = 2.0
    curve.driver_add("location", 2).driver.expression = "0.5"
    variable = after.driver_add("location", 2).driver.variables.new()
    variable.targets[0].id = curve
    curve.data.driver_add("extrude")
    curve.constraints.new("COPY_ROTATION").target = after
    follower.constraints.new("COPY_LOCATION").target = curve
    bpy.context.view_layer.objects.active = frames[0]
    bpy.ops.convwass.make_player()
    mesh, after = frame_objects(baked_morph())[1:3]
    assert mesh.type == "MESH"
    assert [(strip.name, strip.scale) for track in mesh.animation_data.nla_tracks for strip in track.strips] == [
        ("Turn", 2.0)
    ]
    assert mesh.animation_data.action is not None
    assert [curve.driver.expression for curve in mesh.animation_data.drivers] == ["0.5"]
    assert [target.id for target in driver_targets(after)] == [mesh]
    assert mesh.data.animation_data is None
    assert mesh.constraints[0].target == after
    assert follower.constraints[0].target == mesh
    assert len(mesh.users_collection) == 1


def test_letters_keep_their_colors_and_share_materials():
    select_only(two_letters("IO", RED, GREEN), two_letters("OI", BLUE, BLUE))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", words="LETTERS", **QUICK)
    first, *between, _ = frame_objects(baked_morph())
    assert [slot.material.name for slot in first.material_slots] == ["IO 0", "IO 1"]
    for share, obj in zip((1 / 3, 2 / 3), between, strict=True):
        names = [slot.material.name for slot in obj.material_slots]
        assert names == ["Convwass Region 1", "Convwass Region 2"]
        colors = {region(obj, 1), region(obj, 2)}
        wanted = {(1 - share, 0, share, 1), (0, 1 - share, share, 1)}
        np.testing.assert_allclose(sorted(colors), sorted(wanted), atol=1e-6)
        assert {spline.material_index for spline in obj.data.splines} == {0, 1}


def glowing(obj, color):
    """Give an object an Emission shader of a color."""
    material = bpy.data.materials.new(obj.name)
    tree = own_tree(material)
    shader = tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = color
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    obj.data.materials.append(material)
    return obj


def test_blends_have_the_colors_of_other_shaders():
    select_only(glowing(text("A"), RED), glowing(text("B", 3.0), BLUE))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    colors = np.array([obj.color for obj in frame_objects(baked_morph())])
    np.testing.assert_allclose(colors, np.linspace(RED, BLUE, len(colors)), atol=1e-6)


def with_alpha(obj, alpha):
    """Set the alpha of all materials of an object."""
    for slot in obj.material_slots:
        slot.material.node_tree.nodes["Principled BSDF"].inputs["Alpha"].default_value = alpha
    return obj


def alpha_source(material):
    """Return the node whose alpha a material has, and None if it is opaque."""
    links = material.node_tree.nodes["Principled BSDF"].inputs["Alpha"].links
    return links[0].from_node if links and links[0].from_socket.name == "Alpha" else None


def test_blends_are_as_transparent_as_their_shapes():
    select_only(with_alpha(colored(text("A"), RED), 0.25), with_alpha(colored(text("B", 3.0), RED), 0.75))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    frames = frame_objects(baked_morph())
    np.testing.assert_allclose([obj.color[3] for obj in frames], np.linspace(0.25, 0.75, len(frames)), atol=1e-6)
    assert {alpha_source(obj.active_material).type for obj in frames[1:-1]} == {"OBJECT_INFO"}
    bpy.context.view_layer.objects.active = frames[0]
    assert bpy.ops.convwass.make_player() == {"FINISHED"}
    shown = [one for one in bpy.data.materials if one.name.endswith(" Player")]
    assert [alpha_source(material).attribute_name for material in shown] == ["morph_color"]


@pytest.mark.parametrize(("kind", "source"), [("CURVE", "ATTRIBUTE"), ("MESH", "VERTEX_COLOR")])
def test_letters_keep_their_transparency(kind, source):
    letters = two_letters("IO", RED, GREEN), two_letters("OI", BLUE, BLUE)
    select_only(*(with_alpha(obj, 0.25) for obj in letters))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", words="LETTERS", flat_output=kind, **QUICK)
    for obj in frame_objects(baked_morph())[1:-1]:
        assert {alpha_source(slot.material).type for slot in obj.material_slots} == {source}
        if kind == "CURVE":
            assert region(obj, 1)[3] == pytest.approx(0.25)


def test_the_color_of_an_object_does_not_make_blends_transparent():
    letters = text("A"), text("B", 3.0)
    for obj in letters:
        obj.color = (1.0, 0.0, 0.0, 0.5)
    select_only(*letters)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert {obj.active_material.name for obj in frame_objects(baked_morph())} == {"Convwass Morph"}


def test_a_player_of_curves_shows_the_colors_of_regions():
    select_only(two_letters("IO", RED, GREEN), two_letters("OI", BLUE, BLUE))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", words="LETTERS", **QUICK)
    bpy.ops.convwass.make_player()
    painted = frame_objects(baked_morph())[1].data
    assert [material.name for material in painted.materials] == ["Convwass Regions"]
    colors = np.array([tuple(point.color) for point in painted.color_attributes["Color"].data])
    # 8 bits, and no point between two regions.
    np.testing.assert_allclose(np.unique(colors.round(2), axis=0), [(0, 0.67, 0.33, 1), (0.67, 0, 0.33, 1)], atol=0.02)


def test_colored_frames_are_deleted_with_their_materials():
    letters = two_letters("IO", RED, GREEN), two_letters("OI", BLUE, BLUE)
    before = census()
    for kind in ("CURVE", "MESH", "DRAWING"):
        select_only(*letters)
        for obj in letters:
            obj.hide_set(False)
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", inputs="IO,OI", flat_output=kind, **QUICK)
        bpy.context.view_layer.objects.active = frame_objects(baked_morph())[0]
        assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
        after = census()
        shared = [name for name in after["materials"] if name.startswith("Convwass")]
        after["materials"] = [name for name in after["materials"] if name not in shared]
        assert after == before


def drawings(obj):
    return {frame.frame_number: frame.drawing for frame in obj.data.layers[0].frames}


def filled(obj, number):
    """What a drawing fills at a frame of the scene."""
    bpy.context.scene.frame_set(number)
    (flat,) = flat_objects([obj], bpy.context.evaluated_depsgraph_get())
    return filled_by(flat.shape, np.arange(len(flat.shape.rings)))


def test_one_drawing_has_a_keyframe_per_frame():
    first, last = colored(text("A"), RED), colored(text("B", 3.0), BLUE)
    last.location.z = 2.0
    select_only(first, last)
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", flat_output="DRAWING", **QUICK) == {"FINISHED"}
    (obj,) = frame_objects(baked_morph())
    assert obj.type == "GREASEPENCIL"
    assert not obj.hide_render
    assert obj.animation_data is None
    assert list(drawings(obj)) == [1, 2, 3, 4]
    records = stored_morph(baked_morph()).records
    for number, record in enumerate(records, start=1):
        found = filled(obj, number)
        assert found.area == pytest.approx(record.get("area_wanted", record["area"]), rel=5e-3)
    points = np.array([point.position[:] for stroke in drawings(obj)[3].strokes for point in stroke.points])
    world = points @ np.array(obj.matrix_world)[:3, :3].T + np.array(obj.matrix_world.translation)
    np.testing.assert_allclose(world[:, 2], 4 / 3, atol=1e-5)
    # The originals have colors as materials, blends have their own.
    ends = [drawings(obj)[number].strokes[0] for number in (1, 4)]
    inks = [obj.data.materials[stroke.material_index].grease_pencil.fill_color[:] for stroke in ends]
    np.testing.assert_allclose(inks, [RED, BLUE])
    np.testing.assert_allclose(drawings(obj)[2].strokes[0].fill_color, (2 / 3, 0, 1 / 3, 1), atol=1e-6)
    assert ends[0].fill_color[3] == 0.0


def test_a_drawing_may_begin_before_frame_0():
    select_only(text("A"), text("B", 3.0))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", flat_output="DRAWING", **QUICK, start="CUSTOM", frame_start=-2)
    (obj,) = frame_objects(baked_morph())
    assert list(drawings(obj)) == [-2, -1, 0, 1]


def test_a_drawing_is_shown_before_it_changes():
    select_only(text("A"), text("B", 3.0))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", flat_output="DRAWING", **QUICK, start="CUSTOM", frame_start=8)
    (obj,) = frame_objects(baked_morph())
    assert list(drawings(obj)) == [1, 9, 10, 11]


def test_drawings_of_a_sheet_are_objects_of_their_own():
    select_only(*(text(sign, 5.0 * index) for index, sign in enumerate("ABC")))
    bpy.ops.convwass.bake_morph(
        motion="TRANSPORT", layout="TRIANGLE", steps=3, flat_resolution=128, flat_output="DRAWING"
    )
    frames = frame_objects(baked_morph())
    assert [obj.type for obj in frames] == ["GREASEPENCIL"] * 6
    assert np.ptp([obj.matrix_world.translation.y for obj in frames]) > 1.0


def test_operators_for_meshes_refuse_drawings(tmp_path):
    select_only(text("A"), text("B", 3.0))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", flat_output="DRAWING", **QUICK)
    with pytest.raises(RuntimeError, match="bake it again with meshes"):
        bpy.ops.convwass.make_player()
    with pytest.raises(RuntimeError, match="bake it again with meshes"):
        bpy.ops.convwass.export_morph(filepath=str(tmp_path / "drawings.abc"))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".obj", ".abc"])
def test_curves_are_exported_as_what_they_fill(tmp_path, suffix):
    select_only(colored(text("A"), RED), colored(text("B", 3.0), RED))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    area, before = enclosed(frame_objects(baked_morph())[1]), census()
    assert bpy.ops.convwass.export_morph(filepath=str(tmp_path / f"letters{suffix}")) == {"FINISHED"}
    assert census() == before
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    if suffix == ".obj":
        bpy.ops.wm.obj_import(filepath=str(tmp_path / "letters_0002.obj"))
    else:
        bpy.ops.wm.alembic_import(filepath=str(tmp_path / "letters.abc"), as_background_job=False)
    bpy.context.scene.frame_set(2)
    (obj,) = (obj for obj in bpy.context.scene.objects if obj.type == "MESH")
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert sum(face.area for face in mesh.polygons) == pytest.approx(area, rel=1e-3)


def test_a_drawing_is_drawn_again_without_leaving_materials():
    select_only(colored(text("A"), RED), colored(text("B", 3.0), BLUE))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", flat_output="DRAWING", **QUICK)
    before = len(bpy.data.materials)
    bpy.context.view_layer.objects.active = frame_objects(baked_morph())[0]
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert [obj.type for obj in frame_objects(baked_morph())] == ["GREASEPENCIL"]
    assert len(bpy.data.materials) == before


@pytest.mark.parametrize("operator", ["make_cache", "make_blend_pad"])
def test_refused_operators_leave_the_curves_unchanged(operator):
    """The file was never saved, and two shapes are no sheet."""
    select_only(text("A"), text("B", 3.0))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    kinds = [obj.type for obj in frame_objects(baked_morph())]
    assert set(kinds) <= {"CURVE", "FONT"}
    with pytest.raises(RuntimeError, match=r"Save the file first|not a complete sheet"):
        getattr(bpy.ops.convwass, operator)()
    assert [obj.type for obj in frame_objects(baked_morph())] == kinds


def test_a_sheet_has_no_player_and_keeps_its_curves():
    select_only(*(text(sign, 5.0 * index) for index, sign in enumerate("ABC")))
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="TRIANGLE", steps=2, flat_resolution=128)
    with pytest.raises(RuntimeError, match="no morph along a path"):
        bpy.ops.convwass.make_player()
    assert not any(obj.type == "MESH" for obj in frame_objects(baked_morph()))
