# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of a flat input: closed rings in space, and how deep a curve of them is."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...geometry.outlines import Rule
from ...sentence import Sentence


@dataclass(frozen=True)
class CurveStyle:
    """What makes a curve object solid.

    Attributes
    ----------
    extrude, bevel_depth, offset : float
        As of Blender's curves, in scene units.
    bevel_resolution : int
        Steps of a round bevel.
    fill_mode : str
        Which sides are filled: one of those of flat curves in Blender.
    """

    extrude: float = 0.0
    bevel_depth: float = 0.0
    offset: float = 0.0
    bevel_resolution: int = 4
    fill_mode: str = "BOTH"

    def scaled(self, factor: float) -> CurveStyle:
        """Return the style of a shape that is so many times as large."""
        sizes = (factor * size for size in (self.extrude, self.bevel_depth, self.offset))
        return CurveStyle(*sizes, self.bevel_resolution, self.fill_mode)


@dataclass(frozen=True)
class FlatRings:
    """A flat input as it stands in the scene.

    Attributes
    ----------
    rings : list of (n, 3) float64
        Closed polygons in world space, the first corner not repeated.
    matrix : (4, 4) float64
        The object's.
    rule : "non-zero" or "even-odd"
        What the rings fill.
    letters : tuple of int or None
        Number of the letter of every ring in reading order, where the object has letters.
    slots : tuple of int
        Material slot of every ring.
    style : CurveStyle
        Depth.
    notice : Sentence or None
        What the user should know about it.
    fills : tuple of int or None
        Where rings have no direction of their own: rings of the same number are filled together, one within another
        is a hole, and fills lie over each other.
    """

    rings: list[NDArray[np.float64]]
    matrix: NDArray[np.float64]
    rule: Rule
    letters: tuple[int, ...] | None = None
    slots: tuple[int, ...] = ()
    style: CurveStyle = field(default_factory=CurveStyle)
    notice: Sentence | None = None
    fills: tuple[int, ...] | None = None

    @property
    def points(self) -> NDArray[np.float64]:
        """All corners, (n, 3)."""
        return np.concatenate([np.zeros((0, 3)), *self.rings])


def blended_style(styles: list[CurveStyle], weights: tuple[float, ...]) -> CurveStyle:
    """Depths between those of the inputs, and the fill of the nearest of those that have one."""
    order = np.argsort(-np.asarray(weights), kind="stable")
    filled = [styles[index] for index in order if styles[index].fill_mode != "NONE"]
    nearest = (filled or styles)[0]
    depths = np.asarray(weights) @ np.array([[style.extrude, style.bevel_depth, style.offset] for style in styles])
    # What has no bevel has no resolution that counts.
    beveled = [style for style in styles if style.bevel_depth > 0] or [nearest]
    return CurveStyle(*(float(depth) for depth in depths), beveled[0].bevel_resolution, nearest.fill_mode)
