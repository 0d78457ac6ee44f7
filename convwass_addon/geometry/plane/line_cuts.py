# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut filled areas of the plane along straight lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from .planar_fill import Boundary

# Corners this close to a line lie on it, relative to the square root of the area. Blender's coordinates are rounded by
# about a tenth of it.
_ON_LINE = 1e-5


def cut_at_share(boundary: Boundary, normal: NDArray[np.float64], share: float) -> tuple[Boundary, Boundary]:
    """Cut a filled area by the line across a direction that leaves a share of the area behind it.

    Parameters
    ----------
    boundary : Boundary
        The filled area.
    normal : (2,)
        The direction, of any length.
    share : float
        Share of the area behind the line, between 0 and 1.

    Returns
    -------
    tuple of Boundary
        What is behind the line, and what is beyond it.
    """
    along = normal / np.linalg.norm(normal)
    heights = boundary.starts @ along
    low, high = float(heights.min()), float(heights.max())
    wanted = share * boundary.area

    def missing(offset: float) -> float:
        return beyond_line(boundary, -along, -offset).area - wanted

    offset = float(brentq(missing, low, high, xtol=1e-4 * _ON_LINE * (high - low)))
    return beyond_line(boundary, -along, -offset).resolved(), beyond_line(boundary, along, offset).resolved()


def beyond_line(boundary: Boundary, along: NDArray[np.float64], offset: float) -> Boundary:
    """Return the part of a filled area beyond a line.

    Parameters
    ----------
    boundary : Boundary
        The filled area.
    along : (2,)
        Unit vector across the line.
    offset : float
        Product of that vector with the points of the line; beyond it is where the product is larger.
    """
    near = _ON_LINE * boundary.root_area
    starts, before = _snapped(boundary.starts, along, offset, near)
    ends, after = _snapped(boundary.ends, along, offset, near)
    is_first, is_last = before >= 0.0, after >= 0.0
    crosses = is_first != is_last
    share = np.where(crosses, before / np.where(crosses, before - after, 1.0), 0.0)
    points = starts + share[:, None] * (ends - starts)
    kept = is_first | is_last
    clipped = Boundary(
        np.where(is_first[:, None], starts, points)[kept], np.where(is_last[:, None], ends, points)[kept]
    )
    # Along the line, with what is beyond on the left, the area is entered and left in turn.
    across = np.array([along[1], -along[0]])
    on_line = points[crosses]
    on_line = on_line[np.argsort(on_line @ across, kind="stable")]
    return Boundary.joined([clipped, Boundary(on_line[0::2], on_line[1::2])])


def _snapped(
    points: NDArray[np.float64], along: NDArray[np.float64], offset: float, near: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return points, with those near a line moved onto it, and their distances from it."""
    distances = points @ along - offset
    on_line = np.abs(distances) < near
    return np.where(on_line[:, None], points - distances[:, None] * along, points), np.where(on_line, 0.0, distances)
