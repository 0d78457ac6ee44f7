# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points along polylines."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def arc_lengths(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the length of a polyline, (n, d), from its first point to each of its points, (n,)."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def along_polyline(places: ArrayLike, knots: ArrayLike, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Interpolate linearly between points, such as those of a polyline or the colors of a ramp.

    Parameters
    ----------
    places : (m,) or any other shape (...)
        Places in the units of `knots`; those beyond the first or the last knot get its point.
    knots : (n,)
        Rising places of the points.
    points : (n, d)
        The points.

    Returns
    -------
    (m, d) or (..., d) float64
    """
    return np.stack([np.interp(places, knots, column) for column in points.T], axis=-1)
