# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed rings with few points, within a given distance: polygons, and smooth curves of cubic Bezier pieces.

Polygons by the Ramer-Douglas-Peucker algorithm (1972, 1973), vectorized over all pieces. Curves consist of the pieces
of :mod:`.bezier_pieces`: corners are preserved, and everywhere else adjacent pieces share their tangents.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .bezier_pieces import BezierPieces, basis, fitted_pieces
from .outlines import Outline
from .plane_angles import signed_angles

# A corner turns by more than this within a few points; noise of marching squares does not.
_CORNER = np.radians(50.0)
# Arc length on either side over which corners are detected and tangents estimated, in multiples of the error.
_ARC = 8.0


@dataclass(frozen=True)
class BezierRing:
    """A closed curve of cubic pieces; each runs from a point via its right and the next left handle to the next point.

    Attributes
    ----------
    points, left, right : (n, 2) float64
        Points of the curve and their handles, in the order of the ring.
    corners : (n,) bool
        Where the two handles of a point are independent.
    error : float
        Largest distance between the curve and the ring.
    """

    points: NDArray[np.float64]
    left: NDArray[np.float64]
    right: NDArray[np.float64]
    corners: NDArray[np.bool_]
    error: float

    def sampled(self, count: int) -> NDArray[np.float64]:
        """Return `count` points per piece, (n * count, 2), beginning at its start."""
        controls = [self.points, self.right, np.roll(self.left, -1, axis=0), np.roll(self.points, -1, axis=0)]
        weights = basis(np.arange(count) / count)
        return np.einsum("tc,cnd->ntd", weights, np.stack(controls)).reshape(-1, 2)


def fitted_polygons(outline: Outline, error: float) -> Outline:
    """Simplify the polygons of an outline within a distance.

    Parameters
    ----------
    outline : Outline
        A dense outline.
    error : float
        Largest distance of a removed corner from its edge, in the outline's units.
    """
    return outline.with_rings([ring[_kept_corners(ring, error)] for ring in outline.rings])


def fitted_beziers(outline: Outline, error: float) -> tuple[BezierRing, ...]:
    """Fit smooth curves to the rings of an outline, in order.

    Parameters
    ----------
    outline : Outline
        A dense outline.
    error : float
        Largest distance between a corner of the outline and its curve, in the outline's units.
    """
    rings, arc = outline.rings, _ARC * error
    if not rings:
        return ()
    corners = [_corners(ring, arc) for ring in rings]
    breaks = [_break_points(ring, own) for ring, own in zip(rings, corners, strict=True)]
    is_corner = [np.isin(np.arange(len(ring)), own) for ring, own in zip(rings, corners, strict=True)]
    pieces = fitted_pieces(rings, breaks, is_corner, arc, error)
    return tuple(_ring_of(own, which) for own, which in zip(pieces, is_corner, strict=True))


def _kept_corners(ring: NDArray[np.float64], error: float) -> NDArray[np.int64]:
    """Return the indices of the corners that the simplified polygon keeps."""
    count = len(ring)
    if count <= 3:
        return np.arange(count)
    first = _farthest(ring, ring.mean(axis=0))
    turned = np.roll(ring, -first, axis=0)
    closed = np.concatenate([turned, turned[:1]])
    kept = np.zeros(count + 1, bool)
    kept[[0, _farthest(turned, turned[0]), count]] = True
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
        # A ring needs at least three corners.
        kept[int(np.argmax(away))] = True
        places = np.flatnonzero(kept)
    return np.sort((places[:-1] + first) % count)


def _distance_to(points: NDArray[np.float64], starts: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray:
    """Distances of points from segments, one each."""
    along, away = ends - starts, points - starts
    squared = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    share = np.clip((along * away).sum(axis=1) / squared, 0.0, 1.0)
    return np.linalg.norm(away - share[:, None] * along, axis=1)


def _break_points(ring: NDArray[np.float64], corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Points where pieces begin: the corners, or the two points farthest apart if there are none."""
    if len(corners) >= 2:
        return corners
    first = int(corners[0]) if len(corners) else _farthest(ring, ring.mean(axis=0))
    return np.sort([first, _farthest(ring, ring[first])])


def _farthest(ring: NDArray[np.float64], place: NDArray[np.float64]) -> int:
    """Return the index of the point of a ring that is farthest from a place."""
    return int(np.argmax(((ring - place) ** 2).sum(axis=1)))


def _ring_of(pieces: BezierPieces, is_corner: NDArray[np.bool_]) -> BezierRing:
    controls = pieces.controls
    left = np.roll(controls[:, 2], 1, axis=0)
    return BezierRing(controls[:, 0], left, controls[:, 1], is_corner[pieces.starts], float(pieces.errors.max()))


def _corners(ring: NDArray[np.float64], arc: float) -> NDArray[np.int64]:
    """Return the indices of corners: points where a ring turns sharply, and most sharply within an arc."""
    lengths = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    reach = max(2, round(arc / max(float(lengths.mean()), np.finfo(np.float64).tiny)))
    if len(ring) < 4 * reach:
        return np.zeros(0, np.int64)
    # Directions are measured at some distance from the point, because marching squares cuts corners.
    gap = max(1, reach // 3)
    before = np.roll(ring, gap, axis=0) - np.roll(ring, reach, axis=0)
    after = np.roll(ring, -reach, axis=0) - np.roll(ring, -gap, axis=0)
    turn = np.abs(signed_angles(before, after))
    found = []
    free = turn > _CORNER
    for place in np.argsort(-turn, kind="stable"):
        if turn[place] <= _CORNER:
            break
        if free[place]:
            found.append(place)
            free[np.arange(place - reach, place + reach + 1) % len(ring)] = False
    return np.sort(np.array(found, dtype=np.int64))
