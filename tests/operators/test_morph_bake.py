# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator as the panel and scripts call it, in a Blender without a window."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications import memory
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.morphs.inputs.animated_inputs import animation_notices, is_animated
from convwass_addon.bridge.morphs.stored import frame_objects, stored_settings
from convwass_addon.geometry.algebra.affine import transformed_points
from tests.linked_objects import linked_to_new_file
from tests.operators.morphs import add, baked_morph, census, guide_coarsely, two_shapes
from tests.panels.fake_layout import FakeLayout

pytestmark = pytest.mark.usefixtures("empty_scene")

QUICK = {"frames": 3, "resolution": 32}


def vertices(obj):
    return transformed_points(element_values(obj.data.vertices, "co", 3), obj.matrix_world)


def test_a_bake_shows_exactly_one_mesh_per_frame_and_the_originals_at_the_ends():
    two_shapes()
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK) == {"FINISHED"}
    frames = frame_objects(baked_morph())
    assert [obj.name for obj in frames] == ["Morph 0001", "Morph 0002", "Morph 0003", "Morph 0004"]
    scene = bpy.context.scene
    assert (scene.frame_start, scene.frame_end) == (1, 250)
    for number in range(-2, 9):
        scene.frame_set(number)
        shown = [obj for obj in frames if not obj.hide_render]
        assert shown == [frames[min(max(number, 1), 4) - 1]]
    assert len(frames[0].data.vertices) == 8
    assert len(frames[-1].data.polygons) == 24 * 12


def test_blends_lie_where_the_inputs_are():
    two_shapes()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    for share, obj in zip((1 / 3, 2 / 3), frame_objects(baked_morph())[1:-1], strict=True):
        center = vertices(obj).mean(axis=0)
        np.testing.assert_allclose(center, np.array([-3, 0, 0]) + share * np.array([6, 0, 1]), atol=0.1)
        assert all(polygon.use_smooth for polygon in obj.data.polygons)


def test_transforms_and_modifiers_are_respected():
    cube, _ = two_shapes()
    cube.scale = (0.5, 1.0, 1.0)
    cube.modifiers.new("Array", "ARRAY").count = 2
    bpy.context.view_layer.update()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=4, resolution=40)
    near_cube = vertices(frame_objects(baked_morph())[1])
    ends = vertices(frame_objects(baked_morph())[0])
    assert np.ptp(ends[:, 0]) == pytest.approx(2.0, abs=1e-4)
    assert np.ptp(near_cube[:, 0]) == pytest.approx(2.0, abs=0.35)


def test_a_morph_in_stretched_time_starts_at_the_current_frame():
    two_shapes()
    scene = bpy.context.scene
    scene.render.frame_map_old, scene.render.frame_map_new = 100, 200
    scene.frame_set(20)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, start="CURRENT", fit_range=True)
    frames = frame_objects(baked_morph())
    assert (scene.frame_start, scene.frame_end, scene.frame_current) == (20, 26, 20)
    for frame, number in ((20, 0), (22, 1), (24, 2), (26, 3)):
        scene.frame_set(frame)
        assert [obj for obj in frames if not obj.hide_render] == [frames[number]]
    # Half as fast as without stretching: 6 units in 3 frames of 24 a second.
    velocities = element_values(frames[1].data.attributes["velocity"].data, "vector", 3)
    assert velocities[:, 0].mean() == pytest.approx(24.0, rel=0.1)


@pytest.mark.parametrize("output", ["OBJECTS", "PLAYER", "SHAPE_KEYS"])
def test_renders_treat_a_morph_like_its_inputs(output):
    both, lights = two_shapes(), bpy.data.collections.new("Lights")
    for obj in both:
        obj.pass_index, obj.visible_shadow, obj.light_linking.receiver_collection = 5, False, lights
    both[0].is_holdout = True
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", output=output, **QUICK)
    found = [obj for obj in bpy.data.objects if obj not in both and not obj.name.endswith("Fields")]
    shown = [obj for obj in found if obj.users_scene]
    assert len(shown) == {"OBJECTS": 4, "PLAYER": 5, "SHAPE_KEYS": 1}[output]
    for obj in shown:
        assert (obj.pass_index, obj.visible_shadow, obj.light_linking.receiver_collection) == (5, False, lights)
        # Where inputs differ, Blender's default holds; shape keys belong to one mesh.
        assert obj.is_holdout == (output == "SHAPE_KEYS")


def test_inputs_are_hidden_on_request_only():
    cube, ball = two_shapes()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, hide_inputs=False)
    assert not cube.hide_render
    assert not ball.hide_get()


def test_other_scenes_that_lack_hidden_shapes_are_named(capfd):
    cube, _ = two_shapes()
    for name in ("Set", "Close Up"):
        bpy.data.scenes.new(name).collection.objects.link(cube)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    said = capfd.readouterr().out
    assert "Renders of Set lack Cube," in said and "Renders of Close Up lack Cube," in said
    bpy.data.scenes["Set"].collection.children.link(baked_morph())
    bpy.ops.convwass.rebake_morph()
    said = capfd.readouterr().out
    assert "Renders of Set" not in said and "Renders of Close Up lack Cube," in said


def test_instances_that_lack_hidden_shapes_are_named(capfd):
    cube, _ = two_shapes()
    figure, empty = bpy.data.collections.new("Figure"), bpy.data.objects.new("Crowd", None)
    figure.objects.link(cube)
    empty.instance_type, empty.instance_collection = "COLLECTION", figure
    bpy.context.scene.collection.objects.link(empty)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert "Renders of the instances Crowd lack Cube," in capfd.readouterr().out


def set_visibility(obj, kind):
    """Animate whether renders show an object."""
    if kind == "driver":
        obj.driver_add("hide_render").driver.expression = "0"
        return
    for frame in (1, 2):
        obj.keyframe_insert("hide_render", frame=frame)
    data = obj.animation_data
    if kind == "strip":
        strip = data.nla_tracks.new().strips.new("Shown", 1, data.action)
        strip.action_slot = data.action_slot
        data.action = None
    if kind == "muted":
        curves_of(obj)[0].mute = True


@pytest.mark.parametrize("kind", ["keys", "driver", "strip", "muted", "none"])
def test_inputs_whose_visibility_is_animated_are_named(capfd, kind):
    cube, ball = two_shapes()
    if kind != "none":
        set_visibility(cube, kind)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    bpy.context.scene.frame_set(2)
    assert cube.hide_render == (kind in ("muted", "none")) and ball.hide_render
    assert ("Renders may show Cube beside the morph" in capfd.readouterr().out) == (not cube.hide_render)


@pytest.mark.parametrize("how", ["linked", "override"])
def test_linked_inputs_that_renders_show_again_in_the_opened_file_are_named(capfd, tmp_path, how):
    name = two_shapes()[0].name
    cube = linked_to_new_file(name, tmp_path)
    if how == "override":
        cube = cube.override_create(remap_local_usages=True)
    add("uv_sphere", "Ball", location=(3, 0, 0))
    capfd.readouterr()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", inputs=f"{name},Ball", **QUICK)
    assert cube.hide_render
    assert (f"Renders show {name} again when the file is opened" in capfd.readouterr().out) == (how == "linked")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "opened.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "opened.blend"))
    assert bpy.data.objects[name].hide_render == (how == "override")


def test_undo_takes_the_morph_away():
    two_shapes()
    bpy.ops.ed.undo_push(message="shapes")
    before = census()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    bpy.ops.ed.undo_push(message="morph")
    bpy.ops.ed.undo()
    assert census() == before


def test_suzanne_works_untouched():
    add("monkey")
    add("torus", location=(3, 0, 0))
    bpy.data.objects["Suzanne"].select_set(True)
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=48) == {"FINISHED"}


def test_sheets_are_arranged_in_a_grid():
    add("cube", size=1.5)
    add("uv_sphere", location=(3, 0, 0))
    add("torus", location=(6, 0, 0))
    for obj in bpy.data.objects:
        obj.select_set(True)
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="TRIANGLE", steps=3, resolution=32) == {"FINISHED"}
    frames = frame_objects(baked_morph())
    assert len(frames) == 6
    places = {tuple(np.round(vertices(obj).mean(axis=0), 1)) for obj in frames}
    assert len(places) == 6
    assert not any(obj.hide_render for obj in frames)


def test_settings_are_stored_and_taken_back():
    cube, ball = two_shapes()
    bpy.ops.convwass.bake_morph(
        motion="TRANSPORT", frames=5, resolution=24, use_custom_sharpness=True, sharpness=0.4, entropy_limit="MAX"
    )
    stored = stored_settings(baked_morph())
    assert stored["sharpness"] == pytest.approx(0.4)
    assert (stored["frames"], stored["resolution"], stored["entropy_limit"]) == (5, 24, "max")
    settings = bpy.context.scene.convwass_morph
    assert settings.frames == 24
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
    assert (settings.frames, settings.resolution, settings.entropy_limit) == (5, 24, "MAX")
    assert settings.use_custom_sharpness
    assert {obj.name for obj in bpy.context.selected_objects} == {cube.name, ball.name}
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK) == {"FINISHED"}


def test_delete_removes_everything_and_shows_the_inputs():
    cube, _ = two_shapes()
    before = census()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert cube.hide_render
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    after = census()
    after["materials"] = before["materials"] = []  # the shared material may remain
    assert after == before
    assert not cube.hide_render
    assert not cube.hide_get()


def plane():
    return add("plane", location=(3, 0, 0))


def only_edges():
    obj = add("plane", location=(3, 0, 0))
    obj.data.clear_geometry()
    obj.data.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    return obj


def no_geometry():
    obj = add("cube", location=(3, 0, 0))
    obj.data.clear_geometry()
    return obj


def no_size():
    obj = add("cube", location=(3, 0, 0))
    obj.scale.z = 0.0
    bpy.context.view_layer.update()
    return obj


def not_a_number():
    obj = add("cube", location=(3, 0, 0))
    obj.data.vertices[0].co.x = float("nan")
    return obj


@pytest.mark.parametrize("bad", [plane, only_edges, no_geometry, no_size, not_a_number])
def test_bad_shapes_are_named_and_nothing_is_left_behind(bad):
    cube = add("cube")
    obj = bad()
    cube.select_set(True)
    before = census()
    with pytest.raises(RuntimeError, match=obj.name):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert census() == before


def test_a_plane_with_thickness_works():
    add("cube")
    plane()
    bpy.data.objects["Cube"].select_set(True)
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK, thickness=0.2) == {"FINISHED"}


def test_a_grid_needs_four_shapes():
    two_shapes()
    before = census()
    with pytest.raises(RuntimeError, match="four shapes"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="GRID", resolution=32)
    assert census() == before


def test_an_excessive_resolution_is_refused_with_one_that_fits(monkeypatch):
    two_shapes()
    monkeypatch.setattr(memory, "available_memory", lambda: 200_000_000)
    before = census()
    with pytest.raises(RuntimeError, match=r"needs about .* GB .* Resolution \d+ would fit"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=256)
    assert census() == before


def test_poll_reports_missing_input():
    add("cube")
    with pytest.raises(RuntimeError, match="Select at least two shapes"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT")
    two_shapes()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Object Mode"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for name in ("select_morph_inputs", "delete_morph"):
        with pytest.raises(RuntimeError, match="Select an object of a baked morph"):
            getattr(bpy.ops.convwass, name)()


def test_every_property_explains_itself():
    properties = bpy.ops.convwass.bake_morph.get_rna_type().properties
    for prop in properties:
        if prop.identifier != "rna_type":
            assert prop.description
            assert not prop.description.endswith(".")


def test_order_and_reverse():
    left = add("cube", location=(-3, 0, 0))
    left.name = "Z"
    right = add("uv_sphere", location=(3, 0, 0))
    right.name = "A"
    settings = bpy.context.scene.convwass_morph
    assert [obj.name for obj in settings.sorted_shapes([left, right])] == ["A", "Z"]
    settings.order = "LEFT_TO_RIGHT"
    assert [obj.name for obj in settings.sorted_shapes([left, right])] == ["Z", "A"]
    settings.reverse = True
    assert [obj.name for obj in settings.sorted_shapes([left, right])] == ["A", "Z"]


def two_cubes(name, left, right):
    """A mesh of two separate cubes with a material each."""
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    sides = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    mesh = bpy.data.meshes.new(name)
    points = np.concatenate([corners - np.array([1, 0, 0]), corners + np.array([1, 0, 0])])
    mesh.from_pydata(points.tolist(), [], np.concatenate([sides, sides + 8]).tolist())
    for material in (left, right):
        mesh.materials.append(bpy.data.materials.get(material) or bpy.data.materials.new(material))
    mesh.polygons.foreach_set("material_index", [0] * 6 + [1] * 6)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


@pytest.mark.parametrize(("parts", "width"), [("none", 3.0), ("materials", 1.0)])
def test_parts_of_one_material_travel_together(parts, width):
    """Two cubes that change places meet half-way."""
    for obj in (two_cubes("A", "Red", "Blue"), two_cubes("B", "Blue", "Red")):
        obj.select_set(True)
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=40, parts=parts) == {"FINISHED"}
    assert stored_settings(baked_morph())["parts"] == parts
    assert np.ptp(vertices(frame_objects(baked_morph())[1]), axis=0)[0] == pytest.approx(width, abs=0.25)
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
    assert bpy.context.scene.convwass_morph.parts == parts


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: bpy.ops.object.volume_add(), "no faces"),
        (lambda: bpy.ops.object.collection_instance_add(collection=_full_collection()), "no faces"),
    ],
)
def test_selected_objects_that_are_no_meshes_are_named(make, message):
    two_shapes()
    shapes = list(bpy.context.selected_objects)
    make()
    other = bpy.context.object
    for obj in shapes:
        obj.select_set(True)
    with pytest.raises(RuntimeError, match=message) as refused:
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **QUICK)
    assert other.name in str(refused.value)


def _full_collection():
    collection = bpy.data.collections.new("Props")
    collection.objects.link(bpy.data.objects.new("Prop", bpy.data.meshes.new("Prop")))
    return collection.name


def test_animated_shapes_are_named_with_the_frame_that_is_taken():
    one, _ = two_shapes()
    assert animation_notices([one]) == []
    one.keyframe_insert("location", frame=1)
    bpy.context.scene.frame_set(7)
    (notice,) = animation_notices([one])
    assert (notice.values["names"], notice.values["frame"]) == (one.name, 7)
    bent = bpy.data.objects.new("Bent", bpy.data.meshes.new("Bent"))
    modifier = bent.modifiers.new("Hook", "HOOK")
    modifier.object = one
    assert is_animated(bent)


def test_the_object_menu_offers_bakes_and_live_morph(registered_addon):
    layout = FakeLayout()
    layout.separator = lambda: None
    for draw in bpy.types.VIEW3D_MT_object.draw._draw_funcs:
        if draw.__module__ == "convwass_addon.panels.menus":
            draw(SimpleNamespace(layout=layout), bpy.context)
    commands = ("convwass.bake_morph", "convwass.live_morph", "convwass.bake_textures")
    assert layout.drawn == [("operator", command) for command in commands]


@pytest.mark.parametrize(
    ("count", "layout", "output", "message"),
    [
        (2, "BLEND", "PLAYER", "A single blend is one mesh, so there is nothing to play"),
        (2, "BLEND", "CACHE", "A cache requires an animation"),
        (3, "TRIANGLE", "CACHE", "A cache requires an animation"),
    ],
)
def test_an_output_that_the_layout_cannot_have_is_refused(tmp_path, count, layout, output, message):
    two_shapes()
    if count == 3:
        add("cone")
    bpy.ops.object.select_all(action="SELECT")
    before = census()
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.convwass.bake_morph(layout=layout, output=output, resolution=16, folder=str(tmp_path))
    assert census() == before


def test_a_single_blend_of_an_earlier_version_can_be_baked_again():
    """It was made with the output Player, which then was ignored."""
    two_shapes()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="BLEND", resolution=16)
    morph = baked_morph()
    morph["convwass_morph"] = morph["convwass_morph"].replace('"output": "OBJECTS"', '"output": "PLAYER"')
    assert stored_settings(morph)["output"] == "PLAYER"
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert stored_settings(morph)["output"] == "OBJECTS"


def test_shape_keys_have_no_layout(monkeypatch):
    """Two shapes are no triangle, but the panel does not show the layout that is set."""
    guide_coarsely(monkeypatch)
    cube, ball = (add("ico_sphere", subdivisions=2, location=(x, 0, 0)) for x in (0, 3))
    cube.select_set(True)
    ball.scale.z = 1.3
    assert bpy.ops.convwass.bake_morph(layout="TRIANGLE", output="SHAPE_KEYS", frames=5) == {"FINISHED"}
    assert bpy.context.object.data.shape_keys is not None
