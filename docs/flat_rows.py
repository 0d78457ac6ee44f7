# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw words, letters that move, and Fig. 13 of Solomon et al. 2015: ``python3 run.py python docs/flat_rows.py``.

Writes docs/pictures/flat_words.png, letter by letter above and as one mass below, docs/pictures/flat_motions.png,
letters by transport at the left and with a motion at the right, and docs/pictures/flat_grays.png: two gray images by a
linear fade, by transport, with the grays of the images, and with a threshold.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from flat import centered, frames_of, heart, lettered, pixels, save
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from convwass_addon.applications.flat.flat_frames import FlatFrame
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatImage, FlatShape
from convwass_addon.applications.flat.gray_pictures import PictureMaker
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.geometry.plane.coverage import coverage
from convwass_addon.geometry.plane.planar_fill import filled_boundary

_PAPER = np.array([0.985, 0.98, 0.965])
_WORDS = ("MILK", "TOAST")
_INKS = ((0.10, 0.22, 0.42), (0.70, 0.28, 0.08))
# Width and height of a tile, and pixels per unit, at most: a word's length, or a letter's height.
_WORD, _LETTER = (300, 110, 270.0), (120, 150, 75.0)
# Of the second ones, one has limbs that the other has not, and of the last ones, more holes or separate areas.
_SHORTENED = (("E", "F"), ("L", "T"), ("P", "R"))
_DIVIDED = (("O", "C"), ("B", "E"), ("?", "7"), ("=", "H"), ("heart", "hearts"), ("sun", "moon"), ("one", "six"))
_UNROLLED = (("5", "2"), ("S", "Z"), ("spiral", "line"))
_WHOLE = (("6", "9"), ("F", "y"), ("H", "U"), ("heart", "star"), ("gear", "star"), ("smile", "frown"))
_PAIRS = (*_UNROLLED, *_WHOLE, *_SHORTENED, *_DIVIDED)
# Signs of the gray images, and their margin in pixels.
_SIGNS, _MARGIN = "69", 24


def main() -> None:
    """Draw all pictures."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    draw_words()
    draw_motions()
    draw_grays()


def draw_words() -> None:
    """Draw two words: letter by letter, and as one mass."""
    words = [_inked(lettered(word), ink) for word, ink in zip(_WORDS, _INKS, strict=True)]
    rows = []
    for how in ("letters", "mass"):
        frames = frames_of(words, path_blends(2, 5), FlatSettings(resolution=512, words=how, motion="transport"))
        rows.append(np.concatenate([_drawn(frame, words, *_WORD) for frame in frames], axis=1))
    save(np.concatenate(rows, axis=0), "flat_words.png")


def draw_motions() -> None:
    """Draw letters and signs: by transport alone, and with the automatic motion."""
    signs = {"heart": heart(), "star": _star(), "gear": _gear(), "hearts": _hearts(), "sun": _sun(), "moon": _moon()}
    signs |= {"smile": _face(1.0), "frown": _face(-1.0), "spiral": _spiral(), "line": _line()}
    signs |= {"one": _die([(0.0, 0.0)]), "six": _die([(x, y) for x in (-0.2, 0.2) for y in (-0.25, 0.0, 0.25)])}
    rows = []
    for pair in _PAIRS:
        shapes = (signs[name] if name in signs else lettered(name) for name in pair)
        letters = [_inked(shape, ink) for shape, ink in zip(shapes, _INKS, strict=True)]
        halves = []
        for motion in ("transport", "automatic"):
            frames = frames_of(letters, path_blends(2, 6), FlatSettings(resolution=512, motion=motion))
            tile = (*_LETTER[:2], _fitting(frames, *_LETTER))
            halves.append(np.concatenate([_drawn(frame, letters, *tile) for frame in frames], axis=1))
        gap = np.ones((_LETTER[1], _LETTER[0] // 2, 3)) * _PAPER
        rows.append(np.concatenate([halves[0], gap, halves[1]], axis=1))
    save(np.concatenate(rows, axis=0), "flat_motions.png")


def _star() -> FlatShape:
    """Draw a star of five points."""
    angles = 0.5 * np.pi + np.arange(10) * (np.pi / 5)
    radii = np.where(np.arange(10) % 2, 0.2, 0.5)
    return centered([radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)], "even-odd")


def _gear() -> FlatShape:
    """Draw a gear of eight teeth with a hole."""
    angles = np.arange(8)[:, None] * (np.pi / 4) + np.array([-0.22, -0.15, 0.15, 0.22])
    radii = np.tile([0.35, 0.5, 0.5, 0.35], 8)
    teeth = radii[:, None] * np.stack([np.cos(angles.ravel()), np.sin(angles.ravel())], axis=1)
    around = np.linspace(0.0, 2.0 * np.pi, 96, endpoint=False)
    return centered([teeth, 0.18 * np.stack([np.cos(around), np.sin(around)], axis=1)], "even-odd")


def _spiral() -> FlatShape:
    """Draw a band of five half turns."""
    angles = np.linspace(np.pi, 6.0 * np.pi, 200)
    radii = 0.43 * angles / angles[-1]
    sides = [
        radius[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        for radius in (radii - 0.035, radii + 0.035)
    ]
    return centered([np.concatenate([sides[1], sides[0][::-1]])], "even-odd")


def _line() -> FlatShape:
    """Draw a thick line."""
    return centered([np.array([(-0.7, -0.06), (0.7, -0.06), (0.7, 0.06), (-0.7, 0.06)])], "even-odd")


def _hearts() -> FlatShape:
    """Draw two hearts side by side."""
    (ring,) = heart().rings
    return centered([0.5 * ring - np.array([0.3, 0.0]), 0.5 * ring + np.array([0.3, 0.0])], "even-odd")


def _sun() -> FlatShape:
    """Draw a disc with eight rays."""
    ray = np.array([(0.31, -0.035), (0.5, -0.035), (0.5, 0.035), (0.31, 0.035)])
    turns = [np.array([(np.cos(a), np.sin(a)), (-np.sin(a), np.cos(a))]) for a in np.arange(8) * (np.pi / 4)]
    return centered([_arc(0.22, 0.0, 2.0 * np.pi)[:-1], *(ray @ turn for turn in turns)], "even-odd")


def _moon() -> FlatShape:
    """Draw a crescent."""
    tip = np.radians(60.0)
    outer = _arc(0.5, tip, 2.0 * np.pi - tip)
    # Through the same tips, around a center at the right.
    right = 0.25
    radius = float(np.hypot(outer[0, 0] - right, outer[0, 1]))
    begin = float(np.arctan2(outer[0, 1], outer[0, 0] - right))
    inner = _arc(radius, begin, 2.0 * np.pi - begin)[::-1] + np.array([right, 0.0])
    return centered([np.concatenate([outer, inner[1:-1]])], "even-odd")


def _face(mood: float) -> FlatShape:
    """Draw a face in a ring, whose mouth is bent up or, for -1, down."""
    eye = _arc(0.055, 0.0, 2.0 * np.pi)[:-1]
    tip = np.radians(50.0)
    lips = [_arc(radius, -0.5 * np.pi - tip, -0.5 * np.pi + tip) for radius in (0.34, 0.27)]
    mouth = np.concatenate([lips[0], lips[1][::-1]]) + np.array([0.0, 0.2])
    ring = [_arc(radius, 0.0, 2.0 * np.pi)[:-1] for radius in (0.5, 0.43)]
    eyes = [np.add(eye, (side * 0.16, 0.14)) for side in (-1, 1)]
    return centered([*ring, *eyes, np.add(mouth * (1.0, mood), (0.0, 0.1 * mood - 0.1))], "even-odd")


def _die(dots: Sequence[tuple[float, float]]) -> FlatShape:
    """Draw the frame of a die around dots."""
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    return centered([corners, 0.86 * corners, *(_arc(0.08, 0.0, 2.0 * np.pi)[:-1] + dot for dot in dots)], "even-odd")


def _arc(radius: float, begin: float, end: float) -> NDArray[np.float64]:
    angles = np.linspace(begin, end, 97)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _inked(shape: FlatShape, ink: Sequence[float]) -> FlatShape:
    return FlatShape(shape.rings, shape.rule, np.tile([*ink, 1.0], (len(shape.rings), 1)))


def _fitting(frames: Sequence[FlatFrame], wide: int, high: int, scale: float) -> float:
    """Return the scale at which blends fit on a tile."""
    points = np.concatenate([ring for frame in frames if frame.outline for ring in frame.outline.rings])
    return float(min(scale, (0.47 * np.array([wide, high]) / np.abs(points).max(axis=0)).min()))


def _drawn(frame: FlatFrame, shapes: Sequence[FlatShape], wide: int, high: int, scale: float) -> NDArray[np.float64]:
    """Draw a blend on a tile, (high, wide, 3)."""
    source = shapes[frame.blend.source] if frame.outline is None else None
    rings, rule = (frame.outline.rings, "non-zero") if source is None else (source.rings, source.rule)
    boundary = filled_boundary(list(rings), rule).moved([wide / 2, high / 2], scale)
    ink = sum(weight * np.array(own) for weight, own in zip(frame.blend.weights, _INKS, strict=True))
    return _PAPER + coverage(boundary, (wide, high)).T[::-1, :, None] * (ink - _PAPER)


def draw_grays() -> None:
    """Draw two gray images: signs with a shadow."""
    images = [_image(sign, ink) for sign, ink in zip(_SIGNS, _INKS, strict=True)]
    settings = FlatSettings(resolution=256, output="densities", motion="transport")
    blends = path_blends(2, 6)
    frames = frames_of(images, blends, settings)
    ends = [frames[0].density, frames[-1].density]
    grounds = np.tile([*_PAPER, 1.0], (2, 1))
    rows = [np.concatenate([_faded(ends, blend) for blend in blends], axis=1)]
    for grays in ("density", "images", "threshold"):
        maker = PictureMaker(images, grounds, ends, grays)
        rows.append(np.concatenate([maker.picture(frame)[::-1, :, :3] for frame in frames], axis=1))
    save(np.concatenate(rows, axis=0), "flat_grays.png")


def _image(sign: str, ink: Sequence[float]) -> FlatImage:
    """Make a sign with a soft shadow, as a density with the color of its ink."""
    full = pixels(lettered(sign).rings, "even-odd")
    full = np.pad(full, _MARGIN)
    shadow = 0.3 * gaussian_filter(np.roll(full, (10, 10), (0, 1)), 5.0)
    values = np.maximum(full, shadow)[::-1].T
    values[values < 0.02] = 0.0
    colors = np.tile([*ink, 1.0], (*values.shape, 1))
    return FlatImage(values, 1.0, (0.0, 0.0), "density", colors)


def _faded(ends: Sequence, blend: Blend) -> NDArray[np.float64]:
    """Draw the mean of the two images."""
    mixed = sum(weight * end.values for weight, end in zip(blend.weights, ends, strict=True))
    ink = sum(weight * np.array(own) for weight, own in zip(blend.weights, _INKS, strict=True))
    return _PAPER + np.clip(mixed, 0.0, 1.0).T[::-1, :, None] * (ink - _PAPER)


if __name__ == "__main__":
    main()
