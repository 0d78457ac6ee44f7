# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Render a whole morph as one picture: its shapes in rows on a light floor, with the same view and lighting."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ....errors import InputError
from ....progress import Progress, Work
from ....sentence import Sentence
from ...studio.framing import Pose, View, broad_view
from ...studio.rendered_scene import Studio, checked_output, world_points
from ..stored import WEIGHTS_KEY, frame_objects

ELEVATION = math.radians(20.0)
GAP = (0.10, 0.16)
"""Gaps between columns and rows, relative to the largest shape."""
MARGIN = 0.22
"""Margin around the sheet, relative to the largest shape."""


@dataclass(frozen=True)
class _Cell:
    """A shape on the sheet; `place` is its column and row."""

    obj: bpy.types.Object
    points: np.ndarray
    place: tuple[float, float]


@dataclass(frozen=True)
class _Sheet:
    """Shifts (n, 3) that arrange the shapes, and the picture's bounds along the camera's right and up axes."""

    shifts: np.ndarray
    low: np.ndarray
    high: np.ndarray


def render_contact_sheet(
    collection: bpy.types.Collection,
    path: str | Path,
    *,
    columns: int = 5,
    count: int = 15,
    width: int = 1920,
    samples: int = 12,
) -> Work[Path]:
    """Render the shapes of a morph in reading order to a PNG.

    For a path, `count` evenly spaced frames are chosen, including all inputs; shorter paths are shown completely. A
    sheet is shown completely, in its own rows and columns.

    Parameters
    ----------
    collection : bpy.types.Collection
        A morph; neither it nor the scene is changed.
    path : str or Path
        The PNG to write; replaced if it exists.
    columns, count : int
        Shapes per row, and in total.
    width : int
        Width in pixels; the height depends on the shapes.
    samples : int
        Light paths per pixel.

    Yields
    ------
    Progress
        Before setting up, and before rendering.

    Returns
    -------
    Path
        The file, absolute.

    Raises
    ------
    InputError
        The folder does not exist, the name does not end in ``.png``, or the collection contains no morph.
    ConvwassError
        Blender cannot render.
    """
    target = checked_output(path, ".png")
    objects = frame_objects(collection)
    if not objects:
        raise InputError(
            "{name} contains no frames of a morph; choose a collection made by Bake Morph.", name=collection.name
        )
    yield Progress(0.0, Sentence("Setting up the contact sheet"))
    cells = _path_cells(_evenly_chosen(objects, count), columns) if _is_path(objects) else _placed_cells(objects)
    view = broad_view([cell.points for cell in cells], ELEVATION)
    sheet = _arranged(cells, view)
    size = sheet.high - sheet.low
    with Studio() as studio:
        for cell, shift in zip(cells, sheet.shifts, strict=True):
            studio.show(cell.obj, shift)
        _set_up(studio, cells, sheet, view)
        studio.set_quality((width, max(1, round(width * size[1] / size[0]))), samples)
        yield Progress(0.05, Sentence("Rendering {count} shapes", {"count": len(cells)}))
        studio.render(target)
    yield Progress(1.0, Sentence("Wrote {name}", {"name": target.name}))
    return target


def _is_path(objects: Sequence[bpy.types.Object]) -> bool:
    """Return whether a morph is a path, rather than a sheet."""
    return any(obj.animation_data and obj.animation_data.action for obj in objects)


def _evenly_chosen(objects: Sequence[bpy.types.Object], count: int) -> list[bpy.types.Object]:
    """Choose frames of a path, including the inputs."""
    last = len(objects) - 1
    if count > last:
        return list(objects)
    fixed = sorted({0, last, *(index for index, obj in enumerate(objects) if max(obj[WEIGHTS_KEY]) == 1.0)})
    chosen = np.round(np.linspace(0, last, max(count, len(fixed)))).astype(int)
    # Keep the number of frames between two inputs, and space them evenly.
    slots = np.round(np.array(fixed) * (len(chosen) - 1) / last).astype(int)
    return [objects[index] for index in np.round(np.interp(np.arange(len(chosen)), slots, fixed)).astype(int)]


def _path_cells(objects: Sequence[bpy.types.Object], columns: int) -> list[_Cell]:
    return [_Cell(obj, world_points(obj), (i % columns, i // columns)) for i, obj in enumerate(objects)]


def _placed_cells(objects: Sequence[bpy.types.Object]) -> list[_Cell]:
    """Derive columns and rows of a sheet from the positions of its shapes: along X, and downwards."""
    points = [world_points(obj) for obj in objects]
    middles = np.array([(shape.min(axis=0) + shape.max(axis=0)) / 2.0 for shape in points])
    height = max(np.ptp(shape[:, 2]) for shape in points)
    order = np.argsort(-middles[:, 2])
    rows = np.empty(len(objects))
    rows[order] = np.concatenate(([0], np.cumsum(-np.diff(middles[order, 2]) > height / 2.0)))
    step = max(float(np.ptp(shape[:, :2], axis=0).max()) for shape in points)
    across = (middles[:, 0] - middles[:, 0].min()) / step
    return [_Cell(*cell) for cell in zip(objects, points, zip(across, rows, strict=True), strict=True)]


def _arranged(cells: Sequence[_Cell], view: View) -> _Sheet:
    """Place the shapes on the floor (z = 0) so that the camera sees them in rows and columns."""
    right, up, _ = view.axes
    places = np.array([cell.place for cell in cells])
    feet = np.array([_foot(cell.points, right) for cell in cells])
    spans = [cell.points - foot for cell, foot in zip(cells, feet, strict=True)]
    low = np.array([np.min(span @ np.array([right, up]).T, axis=0) for span in spans])
    high = np.array([np.max(span @ np.array([right, up]).T, axis=0) for span in spans])
    largest = float((high - low).max())
    step = (high - low)[:, 0].max() + GAP[0] * largest
    baselines = _baselines(places[:, 1].astype(int), low[:, 1], high[:, 1], GAP[1] * largest)
    across = places[:, 0] * step
    depth = baselines / math.sin(view.elevation)
    targets = across[:, None] * right + depth[:, None] * view.forward
    edges = np.column_stack([across, baselines])
    margin = MARGIN * largest
    return _Sheet(targets - feet, (low + edges).min(axis=0) - margin, (high + edges).max(axis=0) + margin)


def _foot(points: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the floor point below a shape, centered in the camera's view, (3,)."""
    foot = (points.min(axis=0) + points.max(axis=0)) / 2.0
    foot[2] = points[:, 2].min()
    across = points @ right
    return foot + ((across.min() + across.max()) / 2.0 - foot @ right) * right


def _baselines(rows: np.ndarray, low: np.ndarray, high: np.ndarray, gap: float) -> np.ndarray:
    """Return the height of each shape in the picture, (n,), such that rows do not overlap."""
    heights, height = {}, 0.0
    for row in range(rows.max() + 1):
        height -= high[rows == row].max()
        heights[row] = height
        height += low[rows == row].min() - gap
    return np.array([heights[row] for row in rows])


def _set_up(studio: Studio, cells: Sequence[_Cell], sheet: _Sheet, view: View) -> None:
    """Build the set for the arranged shapes, and aim the camera at the center of the sheet."""
    reach = studio.build([cell.points + shift for cell, shift in zip(cells, sheet.shifts, strict=True)], view)
    center = (sheet.low + sheet.high) / 2.0
    # Rows farther back are higher in the picture, so the camera distance is measured from the center.
    on_floor = center[1] / math.sin(view.elevation) * view.forward + center[0] * view.axes[0]
    studio.look_flat(Pose(on_floor + reach / 2.0 * view.axes[2], view), float((sheet.high - sheet.low)[0]), reach)
