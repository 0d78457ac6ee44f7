# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A collection as a shape, and its morph in the Asset Browser, from which the mouse drags it into another file."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

if TYPE_CHECKING:
    from inside import Window

_FRAMES = 8
# Step in pixels when searching for a preview, which is about 100 wide.
_PREVIEW_STEP = 50


def assets(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _bakes_a_collection(window)
    yield from _marks_the_player(window)
    yield from _drags_it_into_another_file(window)


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
    yield from window.wait(lambda: _morph() is not None and not window.progress.running, 120, "the collection is baked")
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
    yield from _shows_assets(window, "LOCAL")
    yield from window.picture("91 asset browser")
    window.say(f"the Asset Browser shows {len(marked)} assets with pictures")


def _shows_assets(window: Window, library: str) -> Iterator[float]:
    """Let the lower half of the viewport show a library."""
    with window.override():
        bpy.ops.screen.area_split(direction="HORIZONTAL", factor=0.5)
    yield 1.0
    halves = [area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D"]
    min(halves, key=lambda area: area.y).ui_type = "ASSETS"
    yield 2.0
    _browser().spaces.active.params.asset_library_reference = library
    yield 4.0


def _drags_it_into_another_file(window: Window) -> Iterator[float]:
    name = _player().name
    with tempfile.TemporaryDirectory() as folder:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "library.blend"))
        library = bpy.context.preferences.filepaths.asset_libraries.new(name="Morphs", directory=folder)
        yield from window.empty_scene()
        yield from _shows_assets(window, library.name)
        x, y = yield from _preview_of(window, name)
        yield from window.picture("92 library")
        to_x, to_y = window.on_screen((0.0, 0.0, 0.0))
        yield from window.drag([(x, y), (x + 20, y - 20), (to_x - 30, to_y + 20), (to_x, to_y)])
        yield from window.wait(lambda: _player() is not None and _player().users_scene, 30, "the player is dropped")
    dropped, heights = _player(), []
    for frame in (1, 1 + _FRAMES // 2, 1 + _FRAMES):
        bpy.context.scene.frame_set(frame)
        yield 0.5
        seen = dropped.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        heights.append(float(np.ptp([vertex.co.z for vertex in seen.vertices])))
    assert np.ptp(heights) > 0.05 * min(heights), f"the dropped player stands still: {heights}"
    bpy.context.scene.frame_set(1 + _FRAMES // 2)
    yield from window.picture("93 dropped")
    window.say("the mouse drags the player from the Asset Browser into another file, where it plays")


def _preview_of(window: Window, name: str) -> Iterator[float]:
    """Click previews until the object of that name is active, and return the place on the screen."""
    area = _browser()
    region = next(region for region in area.regions if region.type == "WINDOW")
    screen = bpy.context.window_manager.windows[0]
    for below in range(_PREVIEW_STEP, region.height, _PREVIEW_STEP):
        for right in range(_PREVIEW_STEP, region.width, _PREVIEW_STEP):
            place = region.x + right, screen.height - region.y - region.height + below
            yield from window.click(*place)
            with bpy.context.temp_override(window=screen, area=area, region=region):
                asset = bpy.context.asset
            # The node group has the same name.
            if asset is not None and (asset.name, asset.id_type) == (name, "OBJECT"):
                return place
    raise AssertionError(f"the Asset Browser shows no {name}")


def _browser() -> bpy.types.Area:
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.ui_type == "ASSETS")


def _morph() -> bpy.types.Collection | None:
    return next((collection for collection in bpy.data.collections if "convwass_morph" in collection), None)


def _player() -> bpy.types.Object | None:
    return next((obj for obj in bpy.data.objects if obj.name.endswith("Player")), None)
