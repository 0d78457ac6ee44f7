# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera, a lamp and a sky that stay in a scene, so that it is ready to render."""

from __future__ import annotations

import math

import bpy

from ..nodes.node_trees import own_tree
from .framing import View, broad_view, orbit
from .rendered_scene import LENS, opening, pose_matrix, world_points

_ELEVATION = math.radians(16.0)
_SIZE = (1280, 960)
# Energy of the lamp next to the camera.
_TURN, _HEIGHT, _STRENGTH = math.radians(-45.0), math.radians(48.0), 3.0
_SKY = (0.5, 0.55, 0.62, 1.0)


def set_up_photograph(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    """Frame an object in a three-quarter view, lit from the left, for rendering with Cycles.

    Parameters
    ----------
    scene : bpy.types.Scene
        Gets a camera, a sun and a world.
    obj : bpy.types.Object
        A mesh object of the scene.
    """
    points = world_points(obj)
    view = broad_view([points], _ELEVATION)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.sensor_fit, camera.data.angle = "HORIZONTAL", 2.0 * math.atan(LENS)
    camera.matrix_world = pose_matrix(orbit(points, [view], opening(_SIZE))[0])
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = _STRENGTH, math.radians(8.0)
    pose = orbit(points, [View(view.azimuth + _TURN, _HEIGHT)], opening(_SIZE))[0]
    sun.matrix_world = pose_matrix(pose)
    for own in (camera, sun):
        scene.collection.objects.link(own)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("Sky")
    background = next(node for node in own_tree(scene.world).nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = _SKY
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 64
    scene.render.resolution_x, scene.render.resolution_y = _SIZE
