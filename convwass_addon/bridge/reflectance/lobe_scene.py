# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create a scene that shows blended materials: balls, a sun, a camera, and a pad if there is one."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy

from ...applications.reflectance.lobe_frames import LobeFrame
from ...applications.reflectance.weight_sheets import PadSheet
from .frame_span import Frames
from .lobe_materials import PrincipledFit, fitted_material, lobe_material
from .material_pad import material_pad
from .pad_materials import pad_fitted_material, pad_lobe_material

# Frames from one blend to the next.
_STEP = 10
_BLACK = (0.0, 0.0, 0.0)


def show_on_balls(names: Sequence[str], shown: Sequence[LobeFrame], sheet: PadSheet | None) -> list[bpy.types.Object]:
    """Show blends of tabulated metals in an empty scene.

    Parameters
    ----------
    names : sequence of str
        Names of the materials.
    shown : sequence of LobeFrame
        One blend, those of an animation, or those of all positions of a pad.
    sheet : PadSheet or None
        The pad.

    Returns
    -------
    list of bpy.types.Object
        A ball for the tabulated lobes, if they are isotropic, and one for the best fitting Principled BSDF.
    """
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    sun = _sun(scene)
    _camera(scene)
    scene.frame_start, scene.frame_end = 1, 1 + _STEP * max(len(shown) - 1, 1)
    made = _materials("-".join(names), names, shown, sheet, sun)
    balls = [_ball(material, place - 0.5 * (len(made) - 1)) for place, material in enumerate(made)]
    scene.frame_set(scene.frame_start)
    return balls


def _materials(
    name: str, names: Sequence[str], shown: Sequence[LobeFrame], sheet: PadSheet | None, sun: bpy.types.Object
) -> list[bpy.types.Material]:
    scene, images = bpy.context.scene, [frame.image for frame in shown if frame.image is not None]
    fits = [PrincipledFit(frame.fit.material, frame.fit.material.color, 1.0) for frame in shown]
    dark = [_BLACK] * len(images)
    if sheet is not None:
        scene.cursor.location = (0.0, 0.0, 2.6)
        pad = material_pad(scene, name, names, sheet.side)
        lobes = [pad_lobe_material(name, images, dark, sun, pad)] if images else []
        return [*lobes, pad_fitted_material(f"{name} fitted", fits, pad)]
    frames = Frames(scene.frame_start, scene.frame_end) if len(shown) > 1 else None
    lobes = [lobe_material(name, images, dark, sun, frames)] if images else []
    return [*lobes, fitted_material(f"{name} fitted", fits, frames)]


def _ball(material: bpy.types.Material, place: float) -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(2.4 * place, 0.0, 0.0))
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    ball.data.materials.append(material)
    ball.name = material.name
    return ball


def _sun(scene: bpy.types.Scene) -> bpy.types.Object:
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.0, 0.0
    sun.rotation_euler = (math.radians(50.0), 0.0, math.radians(-30.0))
    sun.location = (-3.0, -3.0, 4.0)
    scene.collection.objects.link(sun)
    return sun


def _camera(scene: bpy.types.Scene) -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 5.4
    camera.location, camera.rotation_euler = (0.0, -8.0, 0.0), (math.radians(90.0), 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
