# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed rings of a flat input in space, and the depth of its curve."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.outlines import Rule
from ...sentence import Sentence
from .pencil_looks import StrokeLine


@dataclass(frozen=True)
class CurveStyle:
    """Depth and fill of a curve object.

    Attributes
    ----------
    extrude, bevel_depth, offset : float
        As for Blender's curves, in scene units.
    bevel_resolution : int
        Segments of a round bevel.
    fill_mode : str
        Filled sides, as for 2D curves in Blender.
    """

    extrude: float = 0.0
    bevel_depth: float = 0.0
    offset: float = 0.0
    bevel_resolution: int = 4
    fill_mode: str = "BOTH"

    def scaled(self, factor: float) -> CurveStyle:
        """Return the style of a shape scaled by a factor."""
        sizes = (factor * size for size in (self.extrude, self.bevel_depth, self.offset))
        return CurveStyle(*sizes, self.bevel_resolution, self.fill_mode)


@dataclass(frozen=True)
class FlatRings:
    """A flat input as read from the scene.

    Attributes
    ----------
    rings : list of (n, 3) float64
        Closed polygons in world space, without repeating the first point.
    matrix : (4, 4) float64
        World matrix of the object.
    rule : "non-zero" or "even-odd"
        Fill rule.
    letters : tuple of int or None
        Letter index of every ring in reading order, if the object is a text.
    slots : tuple of int
        Material slot of every ring.
    style : CurveStyle
        Depth.
    notice : Sentence or None
        A message about the input.
    fills : tuple of int or None
        For rings without orientation: rings with the same number are filled together, nested rings are holes, and fills
        overlap.
    colors : tuple of (float, float, float, float) or None
        Color of every ring, linear with opacity; None for that of its material slot.
    lines : tuple of StrokeLine or None
        The line along every ring of a drawing, each of which may be None; None for other objects.
    """

    rings: list[NDArray[np.float64]]
    matrix: NDArray[np.float64]
    rule: Rule
    letters: tuple[int, ...] | None = None
    slots: tuple[int, ...] = ()
    style: CurveStyle = field(default_factory=CurveStyle)
    notice: Sentence | None = None
    fills: tuple[int, ...] | None = None
    colors: tuple[tuple[float, ...], ...] | None = None
    lines: tuple[StrokeLine | None, ...] | None = None

    @property
    def points(self) -> NDArray[np.float64]:
        """All points, (n, 3)."""
        return np.concatenate([np.zeros((0, 3)), *self.rings])


def blended_style(styles: list[CurveStyle], weights: tuple[float, ...]) -> CurveStyle:
    """Weighted mean of the depths, and the fill mode of the nearest input that is filled."""
    order = np.argsort(-np.asarray(weights), kind="stable")
    filled = [styles[index] for index in order if styles[index].fill_mode != "NONE"]
    nearest = (filled or styles)[0]
    depths = np.asarray(weights) @ np.array([[style.extrude, style.bevel_depth, style.offset] for style in styles])
    # The bevel resolution only matters for inputs with a bevel.
    beveled = [style for style in styles if style.bevel_depth > 0] or [nearest]
    return CurveStyle(*(float(depth) for depth in depths), beveled[0].bevel_resolution, nearest.fill_mode)
