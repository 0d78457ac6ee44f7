# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed rings with few points: polygons, and smooth curves of cubic Bezier pieces, within a stated distance.

Polygons by Ramer's and Douglas and Peucker's subdivision (1972, 1973), all pieces of a round at once. Curves by
Schneider's least squares (Graphics Gems, 1990): corners stay corners, and everywhere else tangents are shared.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .outlines import Outline

# A ring turns at a corner by more than this within a few points; noise of marching squares does not.
_CORNER = np.radians(50.0)
# Corners are looked for, and tangents taken, over an arc of so many errors on either side.
_ARC = 8.0
# How often the places of points on a curve are corrected.
_CORRECTED = 4


@dataclass(frozen=True)
class BezierRing:
    """A closed curve of cubic pieces, each from a point over its right and the next left handle to the next point.

    Attributes
    ----------
    points, left, right : (n, 2) float64
        Points of the curve and their handles, in the order of the ring.
    corners : (n,) bool
        Where the handles of a point are free of each other.
    error : float
        Largest distance found between the curve and the ring.
    """

    points: NDArray[np.float64]
    left: NDArray[np.float64]
    right: NDArray[np.float64]
    corners: NDArray[np.bool_]
    error: float

    def sampled(self, count: int) -> NDArray[np.float64]:
        """Return `count` points of every piece, (n * count, 2), the first one at its start."""
        controls = [self.points, self.right, np.roll(self.left, -1, axis=0), np.roll(self.points, -1, axis=0)]
        basis = _basis(np.arange(count) / count)
        return np.einsum("tc,cnd->ntd", basis, np.stack(controls)).reshape(-1, 2)


def fitted_polygons(outline: Outline, error: float) -> Outline:
    """Leave out corners of an outline of which the polygon stays within a distance.

    Parameters
    ----------
    outline : Outline
        Dense.
    error : float
        Largest distance of a left out corner from its edge, in the outline's units.
    """
    return outline.with_rings([ring[_kept(ring, error)] for ring in outline.rings])


def fitted_beziers(outline: Outline, error: float) -> tuple[BezierRing, ...]:
    """Fit smooth curves to the rings of an outline, in their order.

    Parameters
    ----------
    outline : Outline
        Dense.
    error : float
        Largest distance between a corner of the outline and its curve, in the outline's units.
    """
    return tuple(_fitted_ring(ring, error) for ring in outline.rings)


def _kept(ring: NDArray[np.float64], error: float) -> NDArray[np.int64]:
    """Numbers of the corners that a polygon needs."""
    count = len(ring)
    if count <= 3:
        return np.arange(count)
    first = int(np.argmax(((ring - ring.mean(axis=0)) ** 2).sum(axis=1)))
    turned = np.roll(ring, -first, axis=0)
    closed = np.concatenate([turned, turned[:1]])
    kept = np.zeros(count + 1, bool)
    kept[[0, int(np.argmax(((turned - turned[0]) ** 2).sum(axis=1))), count]] = True
    while True:
        places = np.flatnonzero(kept)
        piece = np.minimum(np.cumsum(kept) - 1, len(places) - 2)
        away = _distance_to(closed, closed[places[piece]], closed[places[piece + 1]])
        far = np.maximum.reduceat(away, places[:-1])
        if far.max() <= error:
            break
        # The first of the farthest points of every piece.
        top = np.flatnonzero((away == far[piece]) & (far[piece] > error))
        _, firsts = np.unique(piece[top], return_index=True)
        kept[top[firsts]] = True
    if len(places) < 4:
        # A ring is no line.
        kept[int(np.argmax(away))] = True
        places = np.flatnonzero(kept)
    return np.sort((places[:-1] + first) % count)


def _distance_to(points: NDArray[np.float64], starts: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray:
    """Distances of points from segments, each from its own."""
    along, away = ends - starts, points - starts
    squared = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    share = np.clip((along * away).sum(axis=1) / squared, 0.0, 1.0)
    return np.linalg.norm(away - share[:, None] * along, axis=1)


def _fitted_ring(ring: NDArray[np.float64], error: float) -> BezierRing:
    """Fit curves between corners; where there are none, between the two points farthest apart."""
    arc = _ARC * error
    corners = _corners(ring, arc)
    breaks = corners
    if len(breaks) < 2:
        first = int(breaks[0]) if len(breaks) else int(np.argmax(((ring - ring.mean(axis=0)) ** 2).sum(axis=1)))
        breaks = np.sort([first, int(np.argmax(((ring - ring[first]) ** 2).sum(axis=1)))])
    is_corner = np.zeros(len(ring), bool)
    is_corner[corners] = True
    pieces: list[_Piece] = []
    for start, end in zip(breaks, np.append(breaks[1:], breaks[0] + len(ring)), strict=True):
        _fit(ring, int(start), int(end), is_corner, arc, error, pieces)
    controls = np.stack([piece.controls for piece in pieces])
    starts = np.array([piece.start for piece in pieces]) % len(ring)
    worst = max(piece.error for piece in pieces)
    return BezierRing(controls[:, 0], np.roll(controls[:, 2], 1, axis=0), controls[:, 1], is_corner[starts], worst)


@dataclass(frozen=True)
class _Piece:
    start: int
    controls: NDArray[np.float64]
    error: float


def _corners(ring: NDArray[np.float64], arc: float) -> NDArray[np.int64]:
    """Numbers of the points at which a ring turns sharply: the sharpest within an arc."""
    lengths = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    reach = max(2, round(arc / max(float(lengths.mean()), np.finfo(np.float64).tiny)))
    if len(ring) < 4 * reach:
        return np.zeros(0, np.int64)
    # Directions before and after a point leave it out by a little: marching squares cut corners.
    gap = max(1, reach // 3)
    before = np.roll(ring, gap, axis=0) - np.roll(ring, reach, axis=0)
    after = np.roll(ring, -reach, axis=0) - np.roll(ring, -gap, axis=0)
    turn = np.abs(np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1)))
    found = []
    free = turn > _CORNER
    for place in np.argsort(-turn, kind="stable"):
        if turn[place] <= _CORNER:
            break
        if free[place]:
            found.append(place)
            free[np.arange(place - reach, place + reach + 1) % len(ring)] = False
    return np.sort(np.array(found, dtype=np.int64))


def _tangent(ring: NDArray[np.float64], place: int, arc: float, side: int) -> NDArray[np.float64]:
    """Direction of a ring at a point: to points on both sides (0), behind it (-1), or before it (1)."""
    count = len(ring)
    reach = max(1, min(round(arc / 4.0 / max(_mean_step(ring), np.finfo(np.float64).tiny)), count // 8 or 1))
    behind = ring[(place - (reach if side <= 0 else 0)) % count]
    ahead = ring[(place + (reach if side >= 0 else 0)) % count]
    along = ahead - behind
    return along / max(float(np.linalg.norm(along)), np.finfo(np.float64).tiny)


def _mean_step(ring: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1).mean())


def _fit(
    ring: NDArray[np.float64],
    start: int,
    end: int,
    is_corner: NDArray[np.bool_],
    arc: float,
    error: float,
    pieces: list[_Piece],
) -> None:
    """Fit one curve from point `start` to point `end` of a ring; cut it where it is farthest away, and go on."""
    count = len(ring)
    waiting = [(start, end)]
    while waiting:
        low, high = waiting.pop()
        points = ring[np.arange(low, high + 1) % count]
        leaving = _tangent(ring, low, arc, 1 if is_corner[low % count] else 0)
        arriving = -_tangent(ring, high, arc, -1 if is_corner[high % count] else 0)
        controls, away = _best(points, leaving, arriving, error)
        worst = float(away.max())
        if worst <= error or high - low < 2:
            pieces.append(_Piece(low, controls, worst if high - low >= 2 else 0.0))
            continue
        middle = low + int(np.clip(np.argmax(away), 1, high - low - 1))
        waiting += [(middle, high), (low, middle)]


def _best(
    points: NDArray[np.float64], leaving: NDArray[np.float64], arriving: NDArray[np.float64], error: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Fit one cubic to points, (m, 2), between its first and last; return its controls and all distances."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    length = float(steps.sum())
    places = np.append(0.0, np.cumsum(steps)) / max(length, np.finfo(np.float64).tiny)
    for attempt in range(_CORRECTED + 1):
        controls = _least_squares(points, places, leaving, arriving, length)
        curve = _basis(places) @ controls
        away = np.linalg.norm(curve - points, axis=1)
        worst = float(away.max())
        # What is far off is not mended by moving places along.
        if worst <= error or worst > 16.0 * error or attempt == _CORRECTED:
            break
        places = _corrected(points, places, controls)
    return controls, away


def _basis(places: NDArray[np.float64]) -> NDArray[np.float64]:
    t, s = places, 1.0 - places
    return np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], axis=-1)


def _least_squares(
    points: NDArray[np.float64],
    places: NDArray[np.float64],
    leaving: NDArray[np.float64],
    arriving: NDArray[np.float64],
    length: float,
) -> NDArray[np.float64]:
    """Lengths of the two handles for which the curve is nearest to the points."""
    basis = _basis(places)
    first, last = points[0], points[-1]
    rest = points - (basis[:, :2].sum(axis=1)[:, None] * first + basis[:, 2:].sum(axis=1)[:, None] * last)
    a, b = basis[:, 1, None] * leaving, basis[:, 2, None] * arriving
    aa, ab, bb = (a * a).sum(), (a * b).sum(), (b * b).sum()
    x, y = (a * rest).sum(), (b * rest).sum()
    determinant = aa * bb - ab * ab
    third = length / 3.0
    sizes = np.array([third, third])
    if determinant > 1e-12 * aa * bb:
        solved = np.array([bb * x - ab * y, aa * y - ab * x]) / determinant
        # Handles that point back, or that are longer than the way, make loops.
        if (solved > 1e-3 * length).all() and (solved < 2.0 * length).all():
            sizes = solved
    return np.stack([first, first + sizes[0] * leaving, last + sizes[1] * arriving, last])


def _corrected(points: NDArray[np.float64], places: NDArray[np.float64], controls: NDArray[np.float64]) -> NDArray:
    """Move every place one step of Newton's method nearer to its point."""
    first = 3.0 * np.diff(controls, axis=0)
    second = 2.0 * np.diff(first, axis=0)
    t, s = places[:, None], 1.0 - places[:, None]
    away = _basis(places) @ controls - points
    slope = s * s * first[0] + 2 * s * t * first[1] + t * t * first[2]
    bend = s * second[0] + t * second[1]
    lower = (slope * slope).sum(axis=1) + (away * bend).sum(axis=1)
    step = np.where(np.abs(lower) > 1e-12, (away * slope).sum(axis=1) / np.where(lower == 0.0, 1.0, lower), 0.0)
    moved = np.clip(places - step, 0.0, 1.0)
    moved[[0, -1]] = 0.0, 1.0
    return np.maximum.accumulate(moved)
