# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A collection as a shape, and its morph in the Asset Browser."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window

_FRAMES = 8


def assets(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _bakes_a_collection(window)
    yield from _marks_the_player(window)


def _bakes_a_collection(window: Window) -> Iterator[float]:
    yield from window.empty_scene()
    snowman = bpy.data.collections.new("Snowman")
    with window.override():
        for radius, height in ((1.0, 0.9), (0.7, 2.2), (0.45, 3.1)):
            bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=(0.0, 0.0, height))
            ball = bpy.context.object
            ball.color = (0.9, 0.95, 1.0, 1.0)
            for home in ball.users_collection:
                home.objects.unlink(ball)
            snowman.objects.link(ball)
        bpy.ops.object.collection_instance_add(collection="Snowman", location=(-2.0, 0.0, 0.0))
        shown = bpy.context.object
        bpy.ops.mesh.primitive_cone_add(radius1=1.2, depth=3.5, location=(2.0, 0.0, 1.75))
        bpy.context.object.color = (0.1, 0.4, 0.1, 1.0)
        shown.select_set(True)
        bpy.ops.view3d.view_all()
    settings = bpy.context.scene.convwass_morph
    settings.frames, settings.resolution = _FRAMES, 48
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_morph")
    yield from window.press("convwass.bake_morph")
    progress = bpy.context.window_manager.convwass_progress
    yield from window.wait(lambda: _morph() is not None and not progress.running, 120, "the collection is baked")
    frames = [obj for obj in _morph().objects if "convwass_index" in obj]
    assert len(frames) == _FRAMES + 1, f"{len(frames)} frames of a collection"
    bpy.context.scene.frame_set(1 + _FRAMES // 2)
    yield from window.picture("90 collection")
    window.say(f"a collection of three balls becomes a cone in {len(frames)} frames")


def _marks_the_player(window: Window) -> Iterator[float]:
    yield from window.press("convwass.make_player")
    yield from window.wait(lambda: _player() is not None, 60, "there is a player")
    yield from window.open_panel("CONVWASS_PT_baked_morph")
    yield from window.press("convwass.mark_morph_asset")
    yield from window.wait(lambda: _player().asset_data is not None, 60, "the player is an asset")
    marked = [
        block.name
        for blocks in (bpy.data.objects, bpy.data.node_groups, bpy.data.materials)
        for block in blocks
        if block.asset_data is not None
    ]
    assert len(marked) >= 3, f"only {marked} are assets"
    areas = bpy.context.window_manager.windows[0].screen.areas
    lower = max((area for area in areas if area.type != "VIEW_3D"), key=lambda area: area.width)
    lower.ui_type = "ASSETS"
    yield 2.0
    lower.spaces.active.params.asset_library_reference = "LOCAL"
    yield 3.0
    yield from window.picture("91 asset browser")
    window.say(f"the Asset Browser shows {len(marked)} assets with pictures")


def _morph() -> bpy.types.Collection | None:
    return next((collection for collection in bpy.data.collections if "convwass_morph" in collection), None)


def _player() -> bpy.types.Object | None:
    return next((obj for obj in bpy.data.objects if obj.name.endswith("Player")), None)
