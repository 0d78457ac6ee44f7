# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Align flat inputs before a morph: translate, rotate and scale them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...applications.flat.flat_pieces import filled_by
from ...applications.flat.flat_shapes import FlatShape
from ...geometry.plane.flat_moments import FlatMoments
from .flat_objects import FlatObject
from .flat_rings import CurveStyle
from .pencil_looks import StrokeLine, mean_line
from .planes import Plane


@dataclass(frozen=True)
class MovedFlat:
    """An aligned flat input.

    Attributes
    ----------
    shape : FlatShape
        In coordinates of the plane.
    plane : Plane
        The plane of the aligned input.
    style : CurveStyle
        Depth and fill.
    move : (4, 4) float64
        Transform from the original to the aligned position, in world space.
    lines : tuple of StrokeLine or None
        The line along every ring of a drawing, each of which may be None; None for other objects.
    """

    shape: FlatShape
    plane: Plane
    style: CurveStyle
    move: NDArray[np.float64]
    lines: tuple[StrokeLine | None, ...] | None

    def line(self, layer: NDArray[np.int64]) -> StrokeLine | None:
        """Return the mean line along the rings of a layer, given by their indices, that have one."""
        own = [self.lines[ring] for ring in layer if self.lines[ring] is not None] if self.lines is not None else []
        return mean_line(own, [1.0 / len(own)] * len(own)) if own else None


def moved_flats(flats: Sequence[FlatObject], alignment: str, scaling: str) -> list[MovedFlat]:
    """Align flat shapes with the first one.

    Parameters
    ----------
    flats : sequence of FlatObject
        In their original positions.
    alignment : "PLACED", "CENTERED" or "PRINCIPAL_AXES"
        Unchanged; or centers of mass in the plane of the first shape; or also principal axes, with the heavy ends on
        the same side.
    scaling : "PLACED" or "EQUAL_VOLUME"
        Unchanged, or with the area of the first one.
    """
    if (alignment, scaling) == ("PLACED", "PLACED"):
        return [MovedFlat(flat.shape, flat.plane, flat.read.style, np.eye(4), flat.read.lines) for flat in flats]
    moments = [_moments(flat.shape) for flat in flats]
    first = moments[0]
    found = []
    for flat, own in zip(flats, moments, strict=True):
        factor = 1.0 if scaling == "PLACED" or own.area <= 0 else float(np.sqrt(first.area / own.area))
        angle = first.angle_from(own) if alignment == "PRINCIPAL_AXES" and flat is not flats[0] else 0.0
        target, plane = (own.center, flat.plane) if alignment == "PLACED" else (first.center, flats[0].plane)
        turn = factor * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        rings = tuple((ring - own.center) @ turn.T + target for ring in flat.shape.rings)
        within = np.diag([1.0, 1.0, factor, 1.0])
        within[:2, :2], within[:2, 3] = turn, target - turn @ own.center
        move = plane.matrix @ within @ np.linalg.inv(flat.plane.matrix)
        style, lines = flat.read.style.scaled(factor), flat.read.lines
        if lines is not None:
            lines = tuple(None if line is None else line.scaled(factor) for line in lines)
        found.append(MovedFlat(replace(flat.shape, rings=rings), plane, style, move, lines))
    return found


def _moments(shape: FlatShape) -> FlatMoments:
    filled = filled_by(shape, np.arange(len(shape.rings)))
    return FlatMoments.of(filled.starts, filled.ends)
