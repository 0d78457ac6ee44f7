# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A temporary scene for Blender's importers and exporters, so that they leave the user's scene alone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def scratch_scene() -> Iterator[bpy.types.Scene]:
    """Run a block of code in a new scene, which is removed afterwards.

    Importers change the frame range, frame rate and selection of the current scene, and exporters write everything
    in it. Objects created in the temporary scene are kept. It has the units of the current scene, by which FBX files
    are scaled.
    """
    units, scene = bpy.context.scene.unit_settings, bpy.data.scenes.new("Convwass Scratch")
    scene.unit_settings.system, scene.unit_settings.scale_length = units.system, units.scale_length
    try:
        with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0], collection=scene.collection):
            yield scene
    finally:
        bpy.data.scenes.remove(scene)


@contextmanager
def scratch_animation(first: int, last: int) -> Iterator[bpy.types.Scene]:
    """Like `scratch_scene`, with a range of frames and the frame rate of the current scene."""
    render = bpy.context.scene.render
    with scratch_scene() as scene:
        scene.frame_start, scene.frame_end = first, last
        scene.render.fps, scene.render.fps_base = render.fps, render.fps_base
        yield scene
