# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the pictures of flat morphs, after Figs. 12 and 13 of the paper: ``python3 run.py python docs/flat.py``.

Writes docs/pictures/flat.png, a letter that becomes another and then an icon, by a linear fade and by transport, and
docs/pictures/flat_sheet.png, four shapes at the corners of a sheet, in both ways.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from convwass_addon.applications.flat.flat_colors import carried_colors
from convwass_addon.applications.flat.flat_frames import FlatFrame
from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_pieces import filled_by
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatShape
from convwass_addon.applications.morphs.layouts import Blend, grid_blends, path_blends
from convwass_addon.geometry.plane.coverage import coverage
from convwass_addon.geometry.plane.planar_fill import filled_boundary

PICTURES = Path(__file__).resolve().parent / "pictures"
_PAPER = np.array([0.985, 0.98, 0.965])
_INKS = {"A": (0.11, 0.14, 0.30), "B": (0.62, 0.13, 0.25), "heart": (0.86, 0.34, 0.16), "bubbles": (0.10, 0.36, 0.28)}
_TILE, _HALF = 200, 0.64
# Points of a Bezier piece of text.
_STEPS = 16


def main() -> None:
    """Draw both pictures."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shapes = {"A": lettered("A"), "B": lettered("B"), "heart": heart(), "bubbles": bubbles()}
    inked = {name: tinted(shape, _INKS[name]) for name, shape in shapes.items()}
    settings = FlatSettings(resolution=512, motion="transport")
    path = [inked[name] for name in ("A", "B", "heart")]
    transported = frames_of(path, path_blends(3, 4), settings)
    faded = [fade(path, frame.blend) for frame in transported]
    save(np.concatenate([np.concatenate(faded, axis=1), row(transported, path)], axis=0), "flat.png")
    corners = [inked[name] for name in ("A", "B", "bubbles", "heart")]
    sheet = frames_of(corners, grid_blends(4, 5), FlatSettings(resolution=256, motion="transport"))
    halves = [
        np.concatenate([np.concatenate(tiles[5 * r : 5 * r + 5], axis=1) for r in range(5)], axis=0)
        for tiles in ([fade(corners, frame.blend) for frame in sheet], [drawn(frame, corners) for frame in sheet])
    ]
    gap = np.ones((halves[0].shape[0], _TILE // 3, 3)) * _PAPER
    save(np.concatenate([halves[0], gap, halves[1]], axis=1), "flat_sheet.png")


def lettered(text: str) -> FlatShape:
    """Convert a text in Blender's default font to rings."""
    curve = bpy.data.curves.new(text, "FONT")
    curve.body, curve.resolution_u = text, _STEPS
    obj = bpy.data.objects.new(text, curve)
    bpy.context.scene.collection.objects.link(obj)
    plain = obj.to_curve(bpy.context.evaluated_depsgraph_get())
    rings = [_polygon(spline) for spline in plain.splines if len(spline.bezier_points) > 2]
    return centered(rings, "even-odd")


def _polygon(spline: bpy.types.Spline) -> NDArray[np.float64]:
    points = spline.bezier_points
    t = np.arange(_STEPS)[:, None] / _STEPS
    pieces = []
    for point, following in zip(points, [*points[1:], points[0]], strict=True):
        a, b = np.array(point.co)[:2], np.array(point.handle_right)[:2]
        c, d = np.array(following.handle_left)[:2], np.array(following.co)[:2]
        pieces.append((1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t * t * c + t**3 * d)
    ring = np.concatenate(pieces)
    return ring[np.abs(ring - np.roll(ring, 1, axis=0)).sum(axis=1) > 1e-9]


def heart() -> FlatShape:
    """Draw a heart."""
    t = np.linspace(0.0, 2 * np.pi, 400, endpoint=False)
    y = 13 * np.cos(t) - 5 * np.cos(2 * t) - 2 * np.cos(3 * t) - np.cos(4 * t)
    return centered([np.stack([16 * np.sin(t) ** 3, y], axis=1)], "non-zero")


def bubbles() -> FlatShape:
    """Draw a shape of two parts, like one of the corners of Fig. 12."""
    t = np.linspace(0.0, 2 * np.pi, 300, endpoint=False)
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    large, hole, small = circle * 0.8 + [-0.55, 0.5], circle[::-1] * 0.35 + [-0.55, 0.5], circle * 0.6 + [0.75, -0.6]
    return centered([large, hole, small], "non-zero")


def centered(rings: Sequence[NDArray[np.float64]], rule: str) -> FlatShape:
    """Scale rings to a height of one, and center them."""
    whole = np.concatenate(rings)
    rings = [(ring - whole.min(axis=0)) / np.ptp(whole, axis=0).max() for ring in rings]
    center = filled_boundary(rings, rule).center
    return FlatShape(tuple(ring - center for ring in rings), rule)


def tinted(shape: FlatShape, ink: tuple[float, float, float]) -> FlatShape:
    """Give all rings of a shape one color."""
    return FlatShape(shape.rings, shape.rule, np.tile([*ink, 1.0], (len(shape.rings), 1)))


def frames_of(shapes: Sequence[FlatShape], blends: Sequence[Blend], settings: FlatSettings) -> list[FlatFrame]:
    """Compute all blends."""
    names = [str(index) for index in range(len(shapes))]
    return [step.payload for step in flat_morph(shapes, names, blends, settings) if step.payload is not None]


def pixels(rings: Sequence[NDArray[np.float64]], rule: str) -> NDArray[np.float64]:
    """Coverage of the pixels of a tile, rows from the top."""
    boundary = filled_boundary(list(rings), rule)
    factor = _TILE / (2 * _HALF)
    return coverage(boundary.moved([_TILE / 2] * 2, factor), (_TILE, _TILE)).T[::-1]


def drawn(frame: FlatFrame, shapes: Sequence[FlatShape]) -> NDArray[np.float64]:
    """Draw a blend in its own colors, (n, n, 3)."""
    if frame.outline is None:
        shape = shapes[frame.blend.source]
        return _inked(pixels(shape.rings, shape.rule), shape.colors[0, :3])
    ink = carried_colors(frame.outline.points[:1], frame, shapes)[0, :3]
    return _inked(pixels(frame.outline.rings, "non-zero"), ink)


def fade(shapes: Sequence[FlatShape], blend: Blend) -> NDArray[np.float64]:
    """Draw the mean of the shapes' densities, scaled so that its maximum is as dark as a shape."""
    masks = [pixels(shape.rings, shape.rule) / filled_by(shape, np.arange(len(shape.rings))).area for shape in shapes]
    mixed = sum(weight * mask for weight, mask in zip(blend.weights, masks, strict=True))
    ink = sum(weight * shape.colors[0, :3] for weight, shape in zip(blend.weights, shapes, strict=True))
    return _inked(mixed / max(mixed.max(), 1e-9), ink)


def _inked(mask: NDArray[np.float64], ink: NDArray[np.float64]) -> NDArray[np.float64]:
    return _PAPER + mask[..., None] * (np.asarray(ink) - _PAPER)


def row(frames: Sequence[FlatFrame], shapes: Sequence[FlatShape]) -> NDArray[np.float64]:
    """Draw blends in a row."""
    return np.concatenate([drawn(frame, shapes) for frame in frames], axis=1)


def save(image: NDArray[np.float64], name: str) -> None:
    """Write a picture in display colors."""
    Image.fromarray(np.rint(255 * np.clip(image, 0, 1)).astype(np.uint8)).save(PICTURES / name, optimize=True)


if __name__ == "__main__":
    main()
