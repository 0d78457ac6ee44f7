# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigged mesh with shape keys in files for other programs."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from scipy.spatial import cKDTree

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.one_mesh.key_files import export_shape_keys
from convwass_addon.bridge.one_mesh.shape_keys import animate_sliders, object_with_keys
from tests.rigs import chain, tube
from tests.scene import linked

# Blender's own add-ons use what newer versions of NumPy and Python advise against.
pytestmark = [pytest.mark.usefixtures("empty_scene"), pytest.mark.filterwarnings("ignore::DeprecationWarning")]


@pytest.fixture
def rigged():
    """Make a tube on two bones, the second one bent, with a key in which it is twice as thick."""
    body, rig = tube(length=2.0), chain(2)
    along = np.array([vertex.co.x for vertex in body.data.vertices])
    for name, chosen in (("A", along < 1.0), ("B", along >= 1.0)):
        body.vertex_groups.new(name=name).add(np.flatnonzero(chosen).tolist(), 1.0, "REPLACE")
    body.modifiers.new("Rig", "ARMATURE").object = rig
    body.parent = rig
    rig.location = (0.0, 0.0, 3.0)
    rig.pose.bones["B"].rotation_mode = "XYZ"
    rig.pose.bones["B"].rotation_euler = (math.radians(30.0), 0.0, 0.0)
    mesh = body.data.copy()
    points = np.array([vertex.co for vertex in mesh.vertices])
    path = KeyPath("Thick", (1.0,), (points * [1.0, 2.0, 2.0])[None], 0.9, 0.0, 0.0, 0.0, 0)
    obj = object_with_keys(body, mesh, [path], bpy.context.scene, ("Rig",))
    animate_sliders(obj, ["Thick"], 1, 4)
    bpy.data.objects.remove(body)
    return obj


def seen(obj, frame):
    bpy.context.scene.frame_set(frame)
    points = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).vertices
    # Files may split and reorder vertices.
    return np.unique(np.round(points, 4) + 0.0, axis=0)


def limit(obj, what, inverted):
    """Limit a key or the armature to the lower half of the tube, with a soft edge along it."""
    group = obj.vertex_groups.new(name="Fixed")
    for vertex in obj.data.vertices:
        weight = np.clip(1.5 - vertex.co.x, 0.0, 1.0)
        group.add([vertex.index], float(1.0 - weight if inverted else weight), "REPLACE")
    if what == "key":
        obj.data.shape_keys.key_blocks["Thick"].vertex_group = "Fixed"
    else:
        (modifier,) = obj.modifiers
        modifier.vertex_group, modifier.invert_vertex_group = "Fixed", inverted
    group.lock_weight = True


@pytest.mark.parametrize("what", ["key", "armature", "inverted armature"])
@pytest.mark.parametrize("suffix", [".glb", ".fbx"])
def test_groups_that_limit_keys_and_armatures_still_do(rigged, tmp_path, suffix, what, inventory):
    whole = [seen(rigged, frame) for frame in (1, 5)]
    limit(rigged, what.split()[-1], "inverted" in what)
    expected = [seen(rigged, frame) for frame in (1, 5)]
    assert any(cKDTree(own).query(points)[0].max() > 0.05 for own, points in zip(whole, expected, strict=True))
    before = inventory()
    (file,) = export_shape_keys(rigged, tmp_path / f"limited{suffix}")
    assert inventory() == before
    obj, key = read_back(file)
    for value, points in zip((0.0, 1.0), expected, strict=True):
        key.value = value
        np.testing.assert_allclose(cKDTree(seen(obj, 1)).query(points)[0], 0.0, atol=2e-3)


def read_back(file):
    """Import a file; returns the rigged mesh and its key, without animation."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    read = bpy.ops.import_scene.gltf if file.suffix == ".glb" else bpy.ops.import_scene.fbx
    read(filepath=str(file))
    (obj,) = (one for one in bpy.data.objects if one.type == "MESH" and one.find_armature())
    (key,) = list(obj.data.shape_keys.key_blocks)[1:]
    obj.data.shape_keys.animation_data_clear()
    return obj, key


def test_files_have_the_names_of_mesh_and_rig(rigged, tmp_path):
    rig = rigged.modifiers[0].object
    rigged.name, rig.name, rig.data.name = "Hero", "Rig", "Bones"
    (file,) = export_shape_keys(rigged, tmp_path / "keys.fbx")
    assert (rigged.name, rig.name, rig.data.name) == ("Hero", "Rig", "Bones")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.fbx(filepath=str(file))
    assert {obj.name for obj in bpy.data.objects} == {"Hero", "Rig"}


@pytest.mark.parametrize("sheared", ["nothing", "mesh", "armature", "mirrored armature"])
@pytest.mark.parametrize("suffix", [".glb", ".fbx"])
def test_the_rig_goes_along(rigged, tmp_path, suffix, sheared, inventory):
    if sheared != "nothing":
        # A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give.
        parent, child = linked("Stretch", None), rigged if sheared == "mesh" else rigged.modifiers[0].object
        child.parent, child.rotation_euler.y, child.location.z = parent, 0.3, 2.0
        parent.scale.z = -1.5 if sheared.startswith("mirrored") else 1.5
    frames = bpy.context.scene.frame_start + np.array([0, 4])
    expected = [seen(rigged, int(frame)) for frame in frames]
    before = inventory()
    (file,) = export_shape_keys(rigged, tmp_path / f"rigged{suffix}")
    assert inventory() == before
    obj, key = read_back(file)
    assert sorted(bone.name for bone in obj.find_armature().data.bones) == ["A", "B"]
    for value, points in zip((0.0, 1.0), expected, strict=True):
        key.value = value
        found = seen(obj, 1)
        assert found.shape == points.shape
        # Rounding may change their order.
        np.testing.assert_allclose(cKDTree(found).query(points)[0], 0.0, atol=2e-3)


def turning(rig):
    """Let bone B turn, and the armature move and turn."""
    for frame, angle in ((21, 0.0), (25, 1.2)):
        rig.pose.bones["B"].rotation_euler.z = rig.rotation_euler.x = rig.location.y = angle
        rig.pose.bones["B"].keyframe_insert("rotation_euler", frame=frame)
        for path in ("rotation_euler", "location"):
            rig.keyframe_insert(path, frame=frame)


def aiming(rig):
    """Let bone B follow an object that moves."""
    goal = linked("Goal", None)
    goal.location = (2.0, 0.0, 4.0)
    goal.keyframe_insert("location", frame=21)
    goal.location.y = 1.5
    goal.keyframe_insert("location", frame=25)
    rig.pose.bones["B"].constraints.new("DAMPED_TRACK").target = goal


def playing(rig):
    """Let an NLA strip turn bone B."""
    turning(rig)
    data = rig.animation_data
    strip = data.nla_tracks.new().strips.new("Turn", 21, data.action)
    strip.action_slot = data.action_slot
    data.action = None


@pytest.mark.parametrize("moving", [turning, aiming, playing])
def test_fbx_files_play_the_rig_with_the_sliders(rigged, tmp_path, moving, inventory):
    """Both begin at the same time, wherever they are in the scene."""
    rig = rigged.modifiers[0].object
    for key in (key for curve in curves_of(rigged) for key in curve.keyframe_points):
        key.co_ui.x += 20.0
    moving(rig)
    frames = range(21, 26)
    expected = [seen(rigged, frame) for frame in frames]
    assert np.abs(expected[-1] - expected[0]).max() > 0.5
    before = inventory()
    (file,) = export_shape_keys(rigged, tmp_path / "moving.fbx")
    assert inventory() == before
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.fbx(filepath=str(file))
    (obj,) = (one for one in bpy.data.objects if one.type == "MESH")
    for frame, points in zip(frames, expected, strict=True):
        # Blender imports the first frame as frame 1.
        np.testing.assert_allclose(cKDTree(seen(obj, frame - 20)).query(points)[0], 0.0, atol=2e-3)
