# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Render frames of a morph with a static camera, and save them as moving pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from convwass_addon.bridge.studio.framing import View, broad_view, orbit
from convwass_addon.bridge.studio.rendered_scene import Studio, opening, world_points

PICTURES = Path(__file__).resolve().parent / "pictures"

# Elevation of the camera in radians; duration of a frame and of both ends in milliseconds; samples; WebP quality.
_ELEVATION = math.radians(18.0)
_FRAME, _HOLD = 45, 700
_SAMPLES, _QUALITY = 10, 86
_INK = (52, 52, 56)
_POINTS_PER_SHAPE = 1500


@dataclass(frozen=True)
class Film:
    """The frames of a morph, seen by a static camera.

    Attributes
    ----------
    frames : list of bpy.types.Object
        Shown one at a time.
    label : str
        Text at the bottom; may be empty.
    """

    frames: list[bpy.types.Object]
    label: str = ""

    def rendered(self, size: tuple[int, int], view: View | None = None) -> list[Image.Image]:
        """Render every frame, `size` pixels wide and high, from `view` or where the shapes are widest."""
        pictures = []
        with Studio() as studio, TemporaryDirectory() as folder:
            copies = [studio.show(frame) for frame in self.frames]
            points = [world_points(frame) for frame in self.frames]
            points = [shape[:: 1 + len(shape) // _POINTS_PER_SHAPE] for shape in points]
            view = view or broad_view(points, _ELEVATION)
            depth = studio.build(points, view)
            studio.set_quality(size, _SAMPLES)
            (pose,) = orbit(np.concatenate(points), [view], opening(size))
            studio.look(pose, depth)
            for shown in copies:
                for copy in copies:
                    copy.hide_render = copy != shown
                path = Path(folder) / "frame.png"
                studio.render(path)
                with Image.open(path) as picture:
                    pictures.append(labeled(picture.convert("RGB"), self.label))
                print(".", end="", flush=True)
        print()
        return pictures


def labeled(picture: Image.Image, label: str) -> Image.Image:
    """Write a label at the lower edge of a picture."""
    if label:
        place = (picture.width / 2, picture.height - 18)
        ImageDraw.Draw(picture).text(place, label, _INK, ImageFont.load_default(18), anchor="mm")
    return picture


def save(name: str, *columns: Sequence[Image.Image]) -> None:
    """Save films side by side as docs/pictures/NAME.webp, which plays back and forth forever."""
    forth = [_beside(pictures) for pictures in zip(*columns, strict=True)]
    loop = [*forth, *forth[-2:0:-1]]
    save_loop(name, loop, [_HOLD if index in (0, len(forth) - 1) else _FRAME for index in range(len(loop))])


def save_loop(name: str, loop: Sequence[Image.Image], durations: Sequence[int]) -> None:
    """Save pictures as docs/pictures/NAME.webp, which plays forever; each is shown for so many milliseconds."""
    path = PICTURES / f"{name}.webp"
    # Frames that are stored as differences leave traces of the ones before.
    options = {"save_all": True, "loop": 0, "quality": _QUALITY, "method": 6, "kmin": 0, "kmax": 1}
    loop[0].save(path, append_images=loop[1:], duration=durations, **options)
    print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB")


def _beside(pictures: Sequence[Image.Image]) -> Image.Image:
    joined = Image.new("RGB", (sum(picture.width for picture in pictures), pictures[0].height), "white")
    left = 0
    for picture in pictures:
        joined.paste(picture, (left, 0))
        left += picture.width
    return joined
