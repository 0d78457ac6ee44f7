# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Match flat shapes that are strokes along their center lines, so that they unroll: an S becomes a Z.

Outlines that are matched by how they turn, or where they are, may tie opposite sides of strokes that bend to opposite
sides: what bends most becomes a thick blob.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.curve_maps import smooth_map
from ...geometry.plane.strokes import Stroke
from .matched_outlines import MatchedOutlines, have_upright_axis, matched_outlines
from .outline_curves import OutlineCurve

# Chords of a stroke that are matched, and places inside each end.
_CHORDS, _INSIDE_END = 81, 8
# Narrower places of a stroke count as this share of its mean width.
_LEAST_WIDTH = 1e-3
# Times at which the size of a stroke that unrolls is measured.
_TIMES = 0.25, 0.5, 0.75


def outlines_and_strokes(one: OutlineCurve, other: OutlineCurve) -> list[MatchedOutlines]:
    """Match two closed curves as :func:`.matched_outlines.matched_outlines`, and at last as strokes if they are."""
    found = matched_outlines(one, other)
    # What both have in common is kept on the way.
    unrolled = None if have_upright_axis(one, other) else matched_strokes(one, other)
    return found if unrolled is None else [*found, unrolled]


def matched_strokes(one: OutlineCurve, other: OutlineCurve) -> MatchedOutlines | None:
    """Match two closed curves around strokes, None if one is none.

    Equal shares of the center lines match. Of both ends of a stroke, the one is matched to the first end of the other
    stroke after which pieces turn less. The cost is the variance of the ratio of their widths along them, in
    logarithms.
    """
    strokes = [Stroke.of(own.curve, own.filled) for own in (one, other)]
    if any(own is None for own in strokes):
        return None
    shares = np.linspace(0.0, 1.0, _CHORDS)
    first, *ways = (own.at(shares) for own in (*strokes, strokes[1].from_other_end()))
    second = min(ways, key=lambda own: np.square(_turns(first, own)).mean())
    ratios = np.log(_widths(first) / _widths(second))
    places, images = first.around(_INSIDE_END), second.around(_INSIDE_END)
    found = smooth_map((one.curve, other.curve), (one.corners, other.corners), places, images)
    return MatchedOutlines(found, float(ratios.var()), 0.0, False, _largest_on_the_way(first, second))


def _widths(stroke: Stroke) -> NDArray[np.float64]:
    """Return the lengths of chords, (k,), none of them zero."""
    return np.maximum(stroke.widths, _LEAST_WIDTH * stroke.widths.mean())


def _turns(one: Stroke, other: Stroke) -> NDArray[np.float64]:
    """Return the angles in radians by which pieces of a stroke turn to become those of another one."""
    angles = other.directions() - one.directions()
    return angles - 2.0 * np.pi * np.round(angles.mean() / (2.0 * np.pi))


def _largest_on_the_way(one: Stroke, other: Stroke) -> float:
    """Return the largest radius of the center line of a stroke that becomes another one, relative to those of both."""
    directions, turns = one.directions(), _turns(one, other)
    radii = [
        _radius(directions + time * turns, one.length + time * (other.length - one.length))
        for time in (0.0, *_TIMES, 1.0)
    ]
    return max(radii) / max(radii[0], radii[-1])


def _radius(directions: NDArray[np.float64], length: float) -> float:
    """Return the root mean square distance from the center of a line with these directions in equal pieces."""
    points = np.cumsum(np.exp(1j * directions)) * (length / len(directions))
    return float(np.sqrt(np.square(np.abs(points - points.mean())).mean()))
