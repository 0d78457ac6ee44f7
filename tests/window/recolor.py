# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""First steps with palettes: recolor a picture in the Image Editor, make a grade from it, and grade a clip."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

if TYPE_CHECKING:
    from inside import Window

_SIZE = (360, 240)
_FRAMES = 4


def recolor(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    with tempfile.TemporaryDirectory(prefix="convwass-window-") as folder:
        yield from _begins(window, Path(folder))
        yield from _goes_wrong(window)
        yield from _recolors(window)
        yield from _other_size(window)
        yield from _grades(window, Path(folder))
        yield from _clips(window, Path(folder))
    window.editor = "VIEW_3D"


def _begins(window: Window, folder: Path) -> Iterator[float]:
    bpy.ops.wm.read_homefile(use_empty=False, app_template="")
    yield 1.5
    # A separate window might not get the keys, because there is no window manager.
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "recolor.blend"))
    _saved(_landscape((0.9, 0.5, 0.25), (0.35, 0.2, 0.12), 1.0), folder / "dusk.png")
    _saved(_landscape((0.3, 0.55, 0.85), (0.12, 0.35, 0.2), 1.0)[:, :200], folder / "noon.png")
    (folder / "shot").mkdir()
    for frame in range(_FRAMES):
        _saved(
            _landscape((0.9, 0.5, 0.25), (0.35, 0.2, 0.12), 0.7 + 0.1 * frame), folder / f"shot/a.{frame + 5:03d}.png"
        )
    window.area.type = "IMAGE_EDITOR"
    window.editor = "IMAGE_EDITOR"
    for name in ("dusk.png", "noon.png"):
        bpy.data.images.load(str(folder / name))
    window.area.spaces.active.image = bpy.data.images["dusk.png"]
    yield 1.0
    yield from window.into_view()
    if not window.area.spaces.active.show_region_ui:
        yield from window.key("n")
    yield 1.0
    assert window.area.spaces.active.show_region_ui, "N opens no sidebar"
    yield from window.click_tab("Convwass")
    yield 0.5


def _goes_wrong(window: Window) -> Iterator[float]:
    """Press the button without a palette: it is disabled, and its tooltip says why."""
    before = len(bpy.data.images)
    yield from window.press("convwass.recolor_image")
    yield 0.5
    assert len(bpy.data.images) == before and not window.progress.running
    x, y = window.at
    yield from window.move(x + 40, y + 1)
    yield 2.0
    yield from window.picture("30 no palette")
    window.say("without a palette the button does nothing, and says so")


def _recolors(window: Window) -> Iterator[float]:
    yield from window.click_field("convwass_recolor.palette")
    yield 0.5
    yield from window.key("n", "o", "o", "n")
    yield 0.5
    yield from window.key("Return")
    yield 0.5
    own = bpy.context.scene.convwass_recolor
    assert own.palette is not None and own.palette.name == "noon.png", f"the palette is {own.palette}"
    yield from window.press("convwass.recolor_image")
    yield from window.wait(lambda: "dusk.png recolored" in bpy.data.images, 60, "the picture is recolored")
    yield from window.picture("31 recolored")
    result = bpy.data.images["dusk.png recolored"]
    assert window.area.spaces.active.image == result, "the editor shows something else"
    before, found, wanted = (_mean(bpy.data.images[name]) for name in ("dusk.png", result.name, "noon.png"))
    assert np.abs(found - wanted).max() < 0.2 * np.abs(before - wanted).max(), f"{before} -> {found}, not {wanted}"
    window.say(f"a picture of mean color {before} takes the palette of one of {wanted}: {found}")


def _other_size(window: Window) -> Iterator[float]:
    """A mask of another size: there is a message, and nothing else happens."""
    own = bpy.context.scene.convwass_recolor
    own.mask = bpy.data.images["noon.png"]
    before = _mean(bpy.data.images["dusk.png recolored"])
    yield from window.press("convwass.recolor_image")
    yield 1.0
    yield from window.picture("32 mask of another size")
    own.mask = None
    assert (_mean(bpy.data.images["dusk.png recolored"]) == before).all()
    yield from window.into_view()
    yield 0.5
    window.say("a mask of another size is refused with a message")


def _grades(window: Window, folder: Path) -> Iterator[float]:
    yield from window.open_panel("CONVWASS_PT_recolor_grade")
    yield from window.press("convwass.write_cube")
    yield 1.5
    yield from window.picture("33 file browser")
    yield from window.key("Return")
    yield from window.wait((folder / "grade.cube").is_file, 30, "the table is written")
    lines = (folder / "grade.cube").read_text().splitlines()
    size = bpy.context.scene.convwass_recolor.cube_size
    assert f"LUT_3D_SIZE {size}" in lines and len(lines) == size**3 + 4, f"{len(lines)} lines"
    window.say(f"its grade is a .cube of {size}^3 colors, by the file browser")


def _clips(window: Window, folder: Path) -> Iterator[float]:
    clip = bpy.data.images.load(str(folder / "shot/a.005.png"))
    clip.name, clip.source = "Shot", "SEQUENCE"
    space = window.area.spaces.active
    space.image = clip
    space.image_user.frame_duration, space.image_user.frame_offset = _FRAMES, 4
    bpy.context.scene.frame_set(1)
    yield 1.0
    yield from window.press("convwass.recolor_clip")
    yield from window.wait(
        lambda: "Shot recolored" in bpy.data.images and not window.progress.running, 60, "the clip is done"
    )
    bpy.context.scene.frame_set(3)
    yield from window.picture("34 clip")
    found = sorted(path.name for path in (folder / "recolored").iterdir())
    assert found == [f"a.{frame + 5:03d}.png" for frame in range(_FRAMES)], f"there are {found}"
    means = []
    for name in found:
        image = bpy.data.images.load(str(folder / "recolored" / name))
        means.append(_mean(image))
        bpy.data.images.remove(image)
    assert (np.diff([mean.sum() for mean in means]) > 0.02).all(), f"the frames do not grow brighter: {means}"
    assert space.image.name == "Shot recolored", f"the editor shows {space.image.name}"
    (folder / "grade.cube").unlink()
    yield from window.press("convwass.write_cube")
    yield 1.5
    yield from window.key("Return")
    yield from window.wait((folder / "grade.cube").is_file, 60, "the table of the clip is written")
    yield from window.wait(lambda: not window.progress.running, 10, "the work ends")
    window.say(f"{len(found)} frames are graded by one map, and their table is written")


def _landscape(sky: tuple[float, ...], ground: tuple[float, ...], gain: float) -> np.ndarray:
    """Return pixels: a sky that brightens towards hills, with a sun and some grain."""
    width, height = _SIZE
    up, right = np.mgrid[0.0 : 1.0 : height * 1j, 0.0 : 1.5 : width * 1j]
    hills = 0.35 + 0.08 * np.sin(5.0 * right) + 0.03 * np.sin(17.0 * right + 1.0)
    colors = np.where((up > hills)[..., None], np.array(sky) * (1.25 - 0.5 * up)[..., None], np.array(ground) * 1.2)
    colors += 0.5 * np.exp(-((right - 1.0) ** 2 + (up - 0.7) ** 2) / 0.006)[..., None]
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = np.clip(gain * colors + np.random.default_rng(0).normal(0.0, 0.015, colors.shape), 0.0, 1.0)
    return pixels


def _saved(pixels: np.ndarray, path: Path) -> None:
    image = bpy.data.images.new("Made", pixels.shape[1], pixels.shape[0])
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)


def _mean(image: bpy.types.Image) -> np.ndarray:
    found = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(found)
    return found.reshape(-1, 4)[:, :3].mean(axis=0).round(3)
