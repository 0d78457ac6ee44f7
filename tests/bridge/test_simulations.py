# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked frames in Blender's simulations."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.progress import payloads
from tests.shapes import ball, torus

SHAPES, BLENDS = (ball(points=200), torus(1.0, 0.4)), path_blends(2, 2)


@pytest.fixture(scope="module")
def frames():
    inputs = MorphInputs.of(SHAPES, ("A", "B"))
    work = morph(inputs, BLENDS, MorphSettings(20, motion="transport"), computation=Computation(1))
    return list(payloads(work, MorphFrame))


@pytest.fixture
def frame(make_object, frames):
    """The middle frame of a ball that becomes a torus, at a height of 5."""
    objects = [make_object(name, mesh.vertices, faces=mesh.faces) for name, mesh in zip("AB", SHAPES, strict=True)]
    made = MorphBake.begin(objects, BLENDS, {"resolution": 20}, 1)
    for found in frames:
        made.add(found)
    obj = made.finish(hide_inputs=True).objects[1]
    obj.animation_data_clear()
    obj.hide_viewport = obj.hide_render = False
    obj.location.z = 5.0
    bpy.context.view_layer.objects.active = obj
    return obj


def heights(obj):
    """The lowest and highest z of an object in world space."""
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([seen.matrix_world @ vertex.co for vertex in seen.data.vertices])
    assert np.isfinite(points).all()
    return points[:, 2].min(), points[:, 2].max()


def advance(frames):
    for number in range(1, frames + 1):
        bpy.context.scene.frame_set(number)


def test_frames_are_closed_and_without_degenerate_faces(frame):
    assert not frame.data.validate()
    faces = np.array([polygon.vertices[:] for polygon in frame.data.polygons])
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    # Every edge has one face in either direction.
    assert len(np.unique(directed, axis=0)) == len(directed)
    np.testing.assert_array_equal(np.unique(directed, axis=0), np.unique(directed[:, ::-1], axis=0))
    areas = np.array([polygon.area for polygon in frame.data.polygons])
    assert areas.min() > 0.01 * areas.mean()


def test_a_frame_falls_as_a_rigid_body(frame):
    bpy.ops.rigidbody.world_add()
    bpy.ops.rigidbody.object_add(type="ACTIVE")
    frame.rigid_body.collision_shape = "CONVEX_HULL"
    before = heights(frame)
    advance(12)
    # Half a second of free fall: 1.03 m after 11 frames of 24 a second.
    fallen = before[0] - heights(frame)[0]
    assert fallen == pytest.approx(0.5 * 9.81 * (11 / 24) ** 2, rel=0.15)


def test_a_frame_is_cloth(frame):
    frame.modifiers.new("Cloth", "CLOTH")
    before = heights(frame)
    advance(8)
    assert heights(frame)[1] < before[1] - 0.05


def test_others_collide_with_the_mesh_of_a_frame(frame):
    # A ring with a hole of radius 0.3, which its convex hull would close.
    bpy.ops.rigidbody.world_add()
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    frame.rigid_body.collision_shape = "MESH"
    wide, narrow = (falling_cube(size) for size in (1.2, 0.2))
    advance(24)
    low, high = heights(frame)
    assert 0.5 * (low + high) < heights(wide)[0] < high + 0.05
    assert heights(narrow)[1] < low


def falling_cube(size):
    """Add a rigid body above the middle of the frame, higher the larger it is."""
    bpy.ops.mesh.primitive_cube_add(size=size, location=(0.0, 0.0, 5.8 + size))
    bpy.ops.rigidbody.object_add(type="ACTIVE")
    return bpy.context.object
