# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Assemble boundaries into rings, assign holes to regions, and convert regions with holes to single rings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .outlines import FlatRegion, Outline, ring_area
from .planar_fill import Boundary
from .plane_angles import signed_angles


def outline_of(boundary: Boundary) -> Outline:
    """Chain the edges of a boundary to rings, and assign every hole to the smallest region around it.

    Parameters
    ----------
    boundary : Boundary
        Directed edges with the filled side on their left, in any order.

    Returns
    -------
    Outline
        The largest region first.
    """
    rings = [ring for ring in boundary_rings(boundary) if len(ring) >= 3]
    outers = sorted((ring for ring in rings if ring_area(ring) > 0), key=ring_area, reverse=True)
    holes: list[list[NDArray[np.float64]]] = [[] for _ in outers]
    for hole in (ring for ring in rings if ring_area(ring) < 0):
        around = [index for index, outer in enumerate(outers) if is_within(_inner_point(hole), outer)]
        if around:
            holes[around[-1]].append(hole)
    return Outline(tuple(FlatRegion(outer, tuple(own)) for outer, own in zip(outers, holes, strict=True)))


def boundary_rings(boundary: Boundary) -> list[NDArray[np.float64]]:
    """Chain the edges of a boundary to polygons, (n, 2): counterclockwise around regions, clockwise around holes.

    Where regions touch at a corner, each has its own ring.
    """
    corners, numbers = np.unique(np.concatenate([boundary.starts, boundary.ends]), axis=0, return_inverse=True)
    first, last = numbers.ravel().reshape(2, -1)
    leaving: dict[int, list[int]] = {}
    for edge, corner in enumerate(first.tolist()):
        leaving.setdefault(corner, []).append(edge)
    directions = corners[last] - corners[first]
    rings, left = [], dict.fromkeys(range(len(first)))
    while left:
        edges, edge = [], next(iter(left))
        while edge in left:
            del left[edge]
            edges.append(edge)
            beyond = leaving[int(last[edge])]
            # The sharpest turn to the left goes on around the same region.
            turns = signed_angles(directions[edge], directions[beyond])
            edge = beyond[int(turns.argmax())]
        rings.append(corners[first[edges]])
    return rings


def without_slivers(boundary: Boundary, share: float) -> Boundary:
    """Return a boundary without regions and holes of less than a share of the area."""
    least = share * boundary.area
    return Boundary.of_rings([ring for ring in boundary_rings(boundary) if abs(ring_area(ring)) >= least])


def keyholed(region: FlatRegion) -> NDArray[np.float64]:
    """Join a region and its holes to one closed polygon, (n, 2), by cuts that it follows in both directions.

    Every cut is the shortest possible one, so it crosses no ring.
    """
    ring = region.outer
    waiting = list(region.holes)
    while waiting:
        found = [cKDTree(ring).query(hole) for hole in waiting]
        chosen = int(np.argmin([distances.min() for distances, _ in found]))
        distances, places = found[chosen]
        start = int(np.argmin(distances))
        hole = np.roll(waiting.pop(chosen), -start, axis=0)
        place = int(places[start])
        ring = np.concatenate([ring[: place + 1], hole, hole[:1], ring[place:]])
    return ring


def is_within(point: NDArray[np.float64], ring: NDArray[np.float64]) -> bool:
    """Return whether a point lies within a polygon, (n, 2), by casting a ray to the right."""
    starts, ends = ring, np.roll(ring, -1, axis=0)
    crossed = (starts[:, 1] <= point[1]) != (ends[:, 1] <= point[1])
    a, b = starts[crossed], ends[crossed]
    places = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((places > point[0]).sum() % 2)


def _inner_point(ring: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a point just inside a ring, next to the middle of its longest edge."""
    along = np.roll(ring, -1, axis=0) - ring
    longest = int(np.argmax((along**2).sum(axis=1)))
    away = np.array([-along[longest, 1], along[longest, 0]]) * np.sign(ring_area(ring))
    return ring[longest] + 0.5 * along[longest] + 1e-6 * away


def closed_chains(first: NDArray[np.int64], second: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Decompose directed edges, of which equally many start and end at every point, into closed chains.

    Parameters
    ----------
    first, second : (e,) int64
        Indices of the points where edges start and end.

    Returns
    -------
    list of (n,) int64
        Consecutive points, three or more; the last one connects to the first.
    """
    leaving: dict[int, list[int]] = {}
    for start, end in zip(first.tolist(), second.tolist(), strict=True):
        leaving.setdefault(start, []).append(end)
    chains = []
    for start, following in leaving.items():
        while following:
            chain, place = [start], following.pop()
            while place != start:
                chain.append(place)
                place = leaving[place].pop()
            if len(chain) >= 3:
                chains.append(np.array(chain))
    return chains
