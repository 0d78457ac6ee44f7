# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw docs/pictures/recolor.jpg, the colors of two photographs exchanged: ``python3 run.py python docs/recolor.py``.

As in figure 11 of Solomon et al. 2015. Above: each photograph with barycenters of both palettes, from its own to the
other's, with limited lightness slope and grain. Below: the histogram of the barycenter over b
(to the right) and a (up), in the colors that it counts; rarer ones are paler. The photographs, from
scikit-image, are in the public domain: coffee by Rachel Michetti, a rocket by SpaceX.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from skimage import data

from convwass_addon.applications.palettes.lab_colors import linear_of_lab, srgb_of_linear
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.applications.palettes.palette_statistics import BINS, REACH
from convwass_addon.applications.palettes.pixel_blocks import recolored_blocks
from convwass_addon.applications.palettes.pixels import PixelFormat, image_palette
from convwass_addon.applications.palettes.recoloring import Recoloring, palette_barycenter, recoloring
from convwass_addon.bridge.palettes.image_files import save_pixels
from convwass_addon.progress import drained

PICTURE = Path(__file__).resolve().parent / "pictures" / "recolor.jpg"
_TIMES = (0.0, 0.25, 0.5, 0.75, 1.0)
_WIDTH, _GAP = 420, 12
_SETTINGS = RecolorSettings(steepest=2.0, edge_radius=8)
# The part of the plane of a and b that is shown: its center, and pixels per unit. Rare colors are
# emphasized by a power of their frequency.
_MIDDLE, _SCALE, _POWER = (18.0, 24.0), 3.0, 0.3
_HISTOGRAM_HEIGHT = 260
_FORM = PixelFormat()


def main() -> None:
    """Draw all pictures, and combine them."""
    photographs = [_fitted(own) for own in (data.coffee(), data.rocket())]
    palettes = [image_palette(own, _FORM) for own in photographs]
    changes = [recoloring(own, [other], None, _SETTINGS) for own, other in (palettes, palettes[::-1])]
    columns = []
    for time in _TIMES:
        shown = [
            _recolored(own, change, strength)
            for own, change, strength in zip(photographs, changes, (time, 1.0 - time), strict=True)
        ]
        shown.append(_histogram(palette_barycenter(palettes, (1.0 - time, time)).chroma))
        columns.append(_joined(shown, axis=0))
    picture = _joined(columns, axis=1)
    like = bpy.data.images.new("sRGB", 1, 1)
    save_pixels(np.ascontiguousarray(picture[::-1]), like, PICTURE)


def _fitted(photograph: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return a photograph scaled to the common width, and cropped to 3 : 2 from the top."""
    width = photograph.shape[1]
    photograph = photograph[: width * 2 // 3]
    height = _WIDTH * 2 // 3
    rows, columns = (
        np.linspace(0, most - 1, size) for most, size in zip(photograph.shape, (height, _WIDTH), strict=False)
    )
    pixels = np.ones((height, _WIDTH, 4), dtype=np.float32)
    pixels[..., :3] = _between(photograph / 255.0, rows, columns)
    return pixels


def _between(
    picture: NDArray[np.float64], rows: NDArray[np.float64], columns: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Interpolate a picture between its pixels."""
    for axis, places in ((0, rows), (1, columns)):
        low = np.minimum(places.astype(int), picture.shape[axis] - 2)
        part = (places - low).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        picture = np.take(picture, low, axis) * (1 - part) + np.take(picture, low + 1, axis) * part
    return picture


def _recolored(pixels: NDArray[np.float32], change: Recoloring, strength: float) -> NDArray[np.float32]:
    own = replace(change, settings=replace(change.settings, strength=strength))
    out = np.empty_like(pixels)
    drained(recolored_blocks(pixels, _FORM, own, None, out))
    return out


def _histogram(chroma: NDArray[np.float64]) -> NDArray[np.float32]:
    """Draw a histogram: b to the right, a up."""
    rows, columns = np.mgrid[0:_HISTOGRAM_HEIGHT, 0:_WIDTH] + 0.5
    a = _MIDDLE[0] + (_HISTOGRAM_HEIGHT / 2 - rows) / _SCALE
    b = _MIDDLE[1] + (columns - _WIDTH / 2) / _SCALE
    shown = np.clip(srgb_of_linear(linear_of_lab(np.stack([np.full(a.shape, 52.0), a, b]))), 0, 1)
    places = (np.stack([a, b]) + REACH) * (BINS / (2 * REACH)) - 0.5
    amount = np.clip(map_coordinates(chroma / chroma.max(), places, order=1), 0, 1) ** _POWER
    pixels = np.ones((*a.shape, 4), dtype=np.float32)
    pixels[..., :3] = 1.0 + (np.moveaxis(shown, 0, -1) - 1.0) * amount[..., None]
    return pixels


def _joined(parts: list[NDArray[np.float32]], axis: int) -> NDArray[np.float32]:
    """Concatenate pictures with a white gap."""
    shape = list(parts[0].shape)
    shape[axis] = _GAP
    spaced = [piece for part in parts for piece in (part, np.ones(shape, dtype=np.float32))]
    return np.concatenate(spaced[:-1], axis=axis)


if __name__ == "__main__":
    main()
