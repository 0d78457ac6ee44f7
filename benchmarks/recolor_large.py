# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of film frame size, recolored as arrays and in Blender."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from convwass_addon.applications.palettes.distinct_colors import LEVELS, color_keys, present_flags
from convwass_addon.applications.palettes.lab_colors import linear_of_srgb
from convwass_addon.applications.palettes.lookup_table import lookup_table
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.applications.palettes.pixel_blocks import recolored_blocks
from convwass_addon.applications.palettes.pixels import PixelFormat, image_palette
from convwass_addon.applications.palettes.recoloring import recoloring
from convwass_addon.progress import drained

from .clock import Clock
from .processes import peak_megabytes, run_case
from .recolor_cases import opaque, photograph

_HEIGHT, _WIDTH = 2160, 3840
# Camera noise in levels: without it, an enlarged photograph would have far fewer colors than a real one.
_GRAIN = 3.0

FORMATS = {
    "bytes": PixelFormat(levels=LEVELS),
    "floats": PixelFormat("linear", "associated", highest=np.inf),
}
"""Pixel formats: that of most files, and that of rendered scenes."""


def enlarged(name: str) -> NDArray[np.float32]:
    """Return a photograph cropped and enlarged to a film frame, with grain: byte values, opaque."""
    picture = photograph(name)
    height = min(picture.shape[0], picture.shape[1] * _HEIGHT // _WIDTH)
    right = np.linspace(0.0, height * _WIDTH // _HEIGHT - 1.0, _WIDTH)
    pixels = np.ones((_HEIGHT, _WIDTH, 4), dtype=np.float32)
    rng = np.random.default_rng(0)
    # Row by row: large temporary arrays would hide the memory needed later.
    for row, down in zip(pixels, np.linspace(0.0, height - 1.0, _HEIGHT), strict=True):
        for channel in range(3):
            large = map_coordinates(picture[..., channel], [np.full(_WIDTH, down), right], order=1)
            grain = rng.standard_normal(_WIDTH, dtype=np.float32) * _GRAIN
            row[:, channel] = np.clip(np.round(large * LEVELS + grain), 0, LEVELS) * np.float32(1.0 / LEVELS)
    return pixels


def arrays(source: str, target: str, kind: str, workers: int) -> dict[str, object]:
    """Recolor arrays to arrays, exactly and by a lookup table."""
    pixels, form = enlarged(source), FORMATS[kind]
    present = present_flags()
    for row in pixels:
        present[color_keys(row)] = True
    colors = np.count_nonzero(present)
    if form.encoding == "linear":
        for row in pixels:
            row[:, :3] = linear_of_srgb(row[:, :3])
    clock = Clock()
    wanted = image_palette(opaque(photograph(target)), PixelFormat())
    change = recoloring(image_palette(pixels, form), [wanted], None, RecolorSettings())
    found: dict[str, object] = {"colors": int(colors), "solve": clock.read()["cpu"]}
    base = peak_megabytes()
    out = np.empty_like(pixels)
    for name, own in (("exact", change), ("table", lookup_table(change))):
        clock = Clock()
        drained(recolored_blocks(pixels, form, own, None, out, workers=workers))
        found[name] = clock.read()
    return found | {"more": peak_megabytes() - base}


def editor(source: str, target: str, output: str) -> dict[str, float]:
    """Recolor an image in Blender by its operator: read, measured, solved, applied, written and, if new, packed."""
    import convwass_addon

    convwass_addon.register()
    for name, pixels in (("Source", enlarged(source)), ("Palette", opaque(photograph(target)))):
        image = bpy.data.images.new(name, *pixels.shape[1::-1], alpha=True)
        image.pixels.foreach_set(pixels.ravel())
    del pixels
    bpy.context.scene.convwass_recolor.palette = bpy.data.images["Palette"]
    base, clock = peak_megabytes(), Clock()
    bpy.ops.convwass.recolor_image(image="Source", output=output)
    return clock.read() | {"more": peak_megabytes() - base}


if __name__ == "__main__":
    run_case(arrays, editor)
