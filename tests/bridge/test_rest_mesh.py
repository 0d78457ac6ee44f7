# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys of meshes that have armatures, modifiers and shape keys already start from the visible shape."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.keyframes import curves_of, driver_targets
from convwass_addon.bridge.morphs.morph_request import MorphRequest
from convwass_addon.bridge.one_mesh.records import key_records
from convwass_addon.bridge.one_mesh.rest_mesh import armature_last, pose_notices, rest_mesh
from convwass_addon.bridge.one_mesh.shape_key_job import ShapeKeyJob
from convwass_addon.bridge.one_mesh.shape_keys import animate_sliders, object_with_keys
from convwass_addon.errors import InputError
from convwass_addon.progress import drained
from tests.rigs import bend_by_two_bones
from tests.scene import world

pytestmark = pytest.mark.usefixtures("empty_scene")


def keyed(obj, target_of):
    """Create keys from the visible shape to `target_of` it; return the object, the visible shape, and the record."""
    with armature_last(obj):
        rest = rest_mesh(obj, bpy.context.evaluated_depsgraph_get())
    coordinates = rest.key_coordinates(target_of(rest.seen)[None])
    path = KeyPath("Target", (1.0,), coordinates, 0.9, 0.0, 0.0, 0.0, 0)
    return object_with_keys(obj, rest.mesh, [path], bpy.context.scene, rest.modifiers), rest


def slide(obj, value):
    obj["Target"] = value
    obj.update_tag()
    return world(obj)


def wider(points):
    return points * [1.0, 1.5, 1.0] + [0.0, 0.0, 0.3]


@pytest.fixture
def rigged():
    """A bar with smooth weights on two bones; its object and its armature stand somewhere."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=9, y_subdivisions=2, size=2, location=(0.5, 0.2, 0.1))
    bar = bpy.context.object
    bar.name, bar.rotation_euler, bar.scale = "Bar", (0.1, 0.2, 0.3), (1.0, 0.4, 1.0)
    return bar, bend_by_two_bones(bar, 1, location=(0.3, 0.0, 0.0))


def pose(rig, angle):
    bone = rig.pose.bones["Upper"]
    bone.rotation_mode = "XYZ"
    bone.rotation_euler = (0.0, 0.0, angle)
    bpy.context.view_layer.update()


@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_keys_come_before_the_armature(rigged, angle):
    """In the pose that the mesh is seen in, the key leads to the target; in others, the armature moves both."""
    bar, rig = rigged
    bar.modifiers.new("Finer", "SUBSURF").levels = 1
    pose(rig, angle)
    obj, rest = keyed(bar, wider)
    assert [modifier.name for modifier in obj.modifiers] == ["Rig", "Finer"]
    assert [group.name for group in obj.vertex_groups] == ["Lower", "Upper"]
    with armature_last(obj), armature_last(bar):
        np.testing.assert_allclose(slide(obj, 0.0), rest.seen, atol=1e-5)
        np.testing.assert_allclose(slide(obj, 1.0), wider(rest.seen), atol=1e-5)
        pose(rig, 0.0)
        np.testing.assert_allclose(slide(obj, 0.0), world(bar), atol=1e-5)
        moved = slide(obj, 1.0) - slide(obj, 0.0)
    far = np.array([vertex.co.x < -0.6 for vertex in bar.data.vertices])
    np.testing.assert_allclose(moved[far], (wider(rest.seen) - rest.seen)[far], atol=1e-5)


@pytest.fixture
def twice_rigged(rigged):
    """The bar with a second armature, whose one bone moves a part of each end; both are posed."""
    bar, rig = rigged
    bpy.ops.object.armature_add(location=(0.1, 0.3, 0.0), rotation=(0.2, 0.0, 0.4))
    other = bpy.context.object
    other.data.bones[0].name = "Face"
    group = bar.vertex_groups.new(name="Face")
    for vertex in bar.data.vertices:
        group.add([vertex.index], 0.3 + 0.7 * abs(vertex.co.x), "REPLACE")
    bar.modifiers.new("Face Rig", "ARMATURE").object = other
    pose(rig, 0.8)
    bone = other.pose.bones["Face"]
    bone.location, bone.rotation_quaternion = (0.2, 0.5, 0.1), (0.9, 0.3, 0.1, 0.2)
    bpy.context.view_layer.update()
    return bar


@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("limited", [False, True])
def test_armatures_that_follow_each_other_are_all_heeded(twice_rigged, mixed, limited):
    second = twice_rigged.modifiers["Face Rig"]
    second.use_multi_modifier = mixed
    if limited:
        second.vertex_group, second.invert_vertex_group = "Upper", True
    twice_rigged.modifiers.new("Finer", "SUBSURF").levels = 1
    obj, _ = keyed(twice_rigged, wider)
    assert [modifier.name for modifier in obj.modifiers] == ["Rig", "Face Rig", "Finer"]
    assert pose_notices(twice_rigged) == []
    obj.modifiers.remove(obj.modifiers["Finer"])
    twice_rigged.modifiers.remove(twice_rigged.modifiers["Finer"])
    np.testing.assert_allclose(slide(obj, 0.0), world(twice_rigged), atol=1e-5)
    np.testing.assert_allclose(slide(obj, 1.0), wider(world(twice_rigged)), atol=1e-5)


def test_a_posed_armature_after_other_modifiers_is_named(twice_rigged):
    twice_rigged.modifiers.new("Finer", "SUBSURF").levels = 1
    twice_rigged.modifiers.move(2, 1)
    (notice,) = pose_notices(twice_rigged)
    assert str(notice).startswith("The keys of Bar are made without the pose of Face Rig;")
    twice_rigged.modifiers["Face Rig"].object.data.pose_position = "REST"
    bpy.context.view_layer.update()
    assert pose_notices(twice_rigged) == []


@pytest.mark.parametrize("invert", [False, True])
def test_a_vertex_group_limits_the_armature(rigged, invert):
    bar, rig = rigged
    group, modifier = bar.vertex_groups.new(name="Limit"), bar.modifiers["Rig"]
    for vertex in list(bar.data.vertices)[::2]:
        group.add([vertex.index], (vertex.index % 5) / 4, "REPLACE")
    modifier.vertex_group, modifier.invert_vertex_group = "Limit", invert
    pose(rig, 0.5)
    obj, rest = keyed(bar, wider)
    np.testing.assert_allclose(slide(obj, 1.0), wider(rest.seen), atol=1e-5)


def test_bendy_bones_are_reported_where_they_are_posed(rigged):
    bar, rig = rigged
    rig.data.bones["Upper"].bbone_segments = 4
    assert keyed(bar, wider)[1].notices == []
    pose(rig, 0.5)
    (notice,) = keyed(bar, wider)[1].notices
    assert str(notice).startswith("Bar is posed by bendy bones")


def test_new_shape_keys_begin_at_the_visible_shape(rigged):
    bar, _ = rigged
    bar.modifiers.clear()
    bar.shape_key_add(name="Basis")
    bent = bar.shape_key_add(name="Bent")
    bent.data[3].co.z += 1.0
    bent.value = 0.5
    before = world(bar)
    obj, rest = keyed(bar, wider)
    assert rest.notices == []
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "Bent", "Target"]
    np.testing.assert_allclose(slide(obj, 0.0), before, atol=1e-5)
    np.testing.assert_allclose(slide(obj, 1.0), wider(before), atol=1e-5)
    obj.data.shape_keys.key_blocks["Bent"].value = 0.0
    assert np.linalg.norm(slide(obj, 1.0) - wider(before), axis=1).max() == pytest.approx(0.5, abs=1e-5)


def test_kept_modifiers_and_custom_properties_stay_animated(rigged):
    bar, _ = rigged
    bar.modifiers.new("Off", "WAVE").show_viewport = False
    bar.modifiers.move(len(bar.modifiers) - 1, 0)
    bar.modifiers.new('Wide "one"', "DISPLACE")
    bar["own"] = 0.0
    for frame in (1, 9):
        bar["own"] = bar.modifiers["Off"].height = bar.modifiers['Wide "one"'].strength = bar.location.y = frame
        for path in ('["own"]', "location", 'modifiers["Off"].height', 'modifiers["Wide \\"one\\""].strength'):
            bar.keyframe_insert(path, frame=frame)
    driver = bar.driver_add('modifiers["Wide \\"one\\""].mid_level').driver
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = bar, '["own"]'
    driver.expression = variable.name
    bpy.context.scene.frame_set(1)
    obj, _ = keyed(bar, wider)
    bpy.context.scene.frame_set(9)
    modifier = obj.modifiers['Wide "one"']
    assert (obj["own"], modifier.strength, modifier.mid_level, obj.location.y) == (9.0, 9.0, 9.0, 1.0)
    assert variable.targets[0].id == bar and {target.id for target in driver_targets(obj)} == {obj}
    assert {curve.data_path for curve in curves_of(obj)} == {'["own"]', 'modifiers["Wide \\"one\\""].strength'}
    assert len(curves_of(bar)) == 6


def test_custom_properties_stay_animated_without_an_armature(rigged):
    bar, _ = rigged
    bar.modifiers.clear()
    bar["own"] = bar["driven"] = 0.0
    for frame in (1, 9):
        bar["own"] = float(frame)
        bar.keyframe_insert('["own"]', frame=frame)
    driver = bar.driver_add('["driven"]').driver
    for name, path in (("a", '["own"]'), ("b", "location[1]")):
        variable = driver.variables.new()
        variable.name, variable.targets[0].id, variable.targets[0].data_path = name, bar, path
    driver.expression = "a + b"
    obj, _ = keyed(bar, wider)
    bpy.context.scene.frame_set(9)
    assert (obj["own"], obj["driven"]) == (9.0, pytest.approx(9.0 + bar.location.y))
    assert [target.id for target in driver_targets(obj)] == [obj, bar]


def test_sliders_of_an_earlier_bake_are_not_animated_by_the_next_one(rigged):
    bar, _ = rigged
    first, _ = keyed(bar, wider)
    animate_sliders(first, ["Target"], 1, 10)
    bpy.context.scene.frame_set(6)
    second, _ = keyed(first, wider)
    assert curves_of(second) == [] and second["Target"] == first["Target"]


@pytest.mark.parametrize("with_keys", [False, True])
def test_materials_of_the_object_itself_are_kept(rigged, with_keys):
    bar, _ = rigged
    bar.modifiers.clear()
    if with_keys:
        bar.shape_key_add(name="Basis")
    bar.data.materials.append(bpy.data.materials.new("Of Mesh"))
    (slot,) = bar.material_slots
    slot.link, slot.material = "OBJECT", bpy.data.materials.new("Of Object")
    obj, _ = keyed(bar, wider)
    assert [own.material.name for own in obj.material_slots] == ["Of Object"]


def only_active(obj):
    obj.show_only_shape_key = True


def absolute(obj):
    obj.data.shape_keys.use_relative = False


@pytest.mark.parametrize(("odd", "message"), [(only_active, "unpin it"), (absolute, "make them Relative")])
def test_shape_keys_that_show_no_others_are_refused(rigged, odd, message):
    bar, _ = rigged
    bar.shape_key_add(name="Basis")
    bar.shape_key_add(name="Bent")
    bar.active_shape_key_index = 1
    odd(bar)
    before = len(bpy.data.meshes)
    with pytest.raises(InputError, match=f"^Bar .*{message}"):
        keyed(bar, wider)
    assert len(bpy.data.meshes) == before
    # Applied with a modifier, they are what is seen.
    bar.modifiers.new("Finer", "SUBSURF").levels = 1
    bar.modifiers.move(1, 0)
    obj, rest = keyed(bar, wider)
    with armature_last(obj):
        np.testing.assert_allclose(slide(obj, 1.0), wider(rest.seen), atol=1e-5)


def test_modifiers_before_the_armature_are_applied_and_named(rigged):
    bar, rig = rigged
    bar.modifiers.new("Thick", "SOLIDIFY")
    bar.modifiers.move(1, 0)
    pose(rig, 0.7)
    obj, rest = keyed(bar, wider)
    assert [modifier.name for modifier in obj.modifiers] == ["Rig"]
    assert len(obj.data.vertices) == 2 * len(bar.data.vertices)
    assert ["Thick" in str(notice.values) for notice in rest.notices] == [True]
    np.testing.assert_allclose(slide(obj, 1.0), wider(world(bar)), atol=1e-5)


@pytest.mark.parametrize("after", [0, 1])
def test_poses_of_one_mesh_end_exactly_also_before_other_modifiers(rigged, after):
    """Both bars are subdivided after their armatures, and the keys lead from one pose to the other."""
    bar, rig = rigged
    other = bar.copy()
    other.data = bar.data.copy()
    other_rig = rig.copy()
    bpy.context.collection.objects.link(other)
    bpy.context.collection.objects.link(other_rig)
    other.modifiers["Rig"].object = other_rig
    for own in (bar, other):
        if after:
            own.modifiers.new("Finer", "SUBSURF").levels = 1
    pose(rig, 0.3)
    pose(other_rig, 1.4)
    job = ShapeKeyJob([bar, other], MorphRequest(frames=8, output="SHAPE_KEYS"), MorphSettings(), 1)
    drained(job.steps())
    (obj,) = job.finish(hide_inputs=False)
    (slider,) = (record["name"] for record in key_records(obj))
    bpy.context.scene.frame_set(int(job.span[1]))
    assert obj[slider] == pytest.approx(1.0)
    np.testing.assert_allclose(world(obj), world(other), atol=1e-5)
    assert [own.name for own in other.modifiers if not own.show_viewport] == []
