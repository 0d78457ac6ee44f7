# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in the scene in which a job began."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def in_scene(scene: bpy.types.Scene, **others: object) -> Iterator[None]:
    """Make a scene that of the context, although the user may have gone to another one; override `others`, too."""
    layer = bpy.context.view_layer if scene == bpy.context.scene else scene.view_layers[0]
    with bpy.context.temp_override(scene=scene, view_layer=layer, **others):
        yield
