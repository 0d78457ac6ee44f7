# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes after a frame read its attributes by their names."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_trees import own_tree
from tests.shapes import ball

TRAVEL, BLENDS = 2.0, path_blends(2, 2)


@pytest.fixture
def frame(bare_scene, make_object):
    """The frame between a red and a blue ball of radius 1, two frames and 2 units along X apart."""
    shapes = [textured_ball(make_object, name, color) for name, color in (("A", (1, 0, 0, 1)), ("B", (0, 0, 1, 1)))]
    shapes[1].location.x = TRAVEL
    bpy.context.view_layer.update()
    settings = MorphSettings(32, motion="transport")
    job = MorphJob(shapes, BLENDS, settings, {}, 1)
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    made = frame_objects(job.finish(hide_inputs=True))[1]
    made.animation_data_clear()
    made.hide_viewport = False
    bare_scene.render.fps, bare_scene.render.fps_base = 24, 1.0
    return made


def textured_ball(make_object, name, color):
    """Add a ball with an image of one color, mapped from above."""
    mesh = ball(points=900)
    obj = make_object(name, mesh.vertices, (), mesh.faces)
    layer = obj.data.uv_layers.new(name="Above")
    for corner, loop in zip(layer.uv, obj.data.loops, strict=True):
        corner.vector = obj.data.vertices[loop.vertex_index].co.xy / 2
    image = bpy.data.images.new(name, 4, 4)
    image.pixels.foreach_set(np.tile(np.float32(color), 16))
    material = bpy.data.materials.new(name)
    texture = own_tree(material).nodes.new("ShaderNodeTexImage")
    texture.image = image
    base = material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    material.node_tree.links.new(texture.outputs["Color"], base)
    obj.data.materials.append(material)
    return obj


def read(obj, name, kind):
    """Return an attribute of points, (n, 3), as Geometry Nodes read it: they put the points there."""
    tree = bpy.data.node_groups.new("Read", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    attribute, place = tree.nodes.new("GeometryNodeInputNamedAttribute"), tree.nodes.new("GeometryNodeSetPosition")
    attribute.data_type, attribute.inputs["Name"].default_value = kind, name
    value = next(output for output in attribute.outputs if output.enabled and output.name == "Attribute")
    tree.links.new(value, place.inputs["Position"])
    tree.links.new(start.outputs[0], place.inputs["Geometry"])
    tree.links.new(place.outputs[0], end.inputs[0])
    obj.modifiers.new("Read", "NODES").node_group = tree
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.array([vertex.co[:] for vertex in mesh.vertices])


def test_the_velocity_is_that_of_the_ball(frame):
    # 2 units in 2 frames of 24 a second.
    velocity = read(frame, "velocity", "FLOAT_VECTOR")
    np.testing.assert_allclose(velocity.mean(axis=0), [24.0, 0.0, 0.0], atol=0.5)
    np.testing.assert_allclose(velocity, np.broadcast_to([24.0, 0.0, 0.0], velocity.shape), atol=4.0)


def test_colors_are_mixed_by_the_weights(frame):
    # Weights of one half, mixed as light.
    color = read(frame, "Color", "FLOAT_COLOR")
    np.testing.assert_allclose(color, np.broadcast_to([0.5, 0.0, 0.5], color.shape), atol=0.02)


@pytest.mark.parametrize("number", [1, 2])
def test_uv_maps_are_those_of_the_shapes(frame, number):
    points = np.array([frame.matrix_world @ vertex.co for vertex in frame.data.vertices]) - [TRAVEL / 2, 0.0, 0.0]
    found = read(frame, f"uv_{number}_Above", "FLOAT_VECTOR")
    np.testing.assert_allclose(np.abs(found[:, :2] - points[:, :2] / 2).mean(axis=0), 0.0, atol=0.01)


def test_weights_are_those_of_the_frame(frame):
    np.testing.assert_allclose(read(frame, "source_weight_1", "FLOAT"), 0.5, atol=1e-3)
