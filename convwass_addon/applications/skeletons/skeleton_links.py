# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Divide bones into links so that a skeleton can bend during layout, and space joints along the result."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.polylines import along_polyline, arc_lengths
from .skeleton_graph import JointGraph


@dataclass(frozen=True)
class Links:
    """A graph whose bones are divided into links; its first vertices are the joints.

    Attributes
    ----------
    size : int
        Number of vertices.
    edges : (l, 2) int64
        Links.
    weights : (l,) float64
        Weights of the links: the larger, the closer their ends.
    paths : tuple of (k,) int64
        For every bone, the vertices from its first joint to its second.
    """

    size: int
    edges: NDArray[np.int64]
    weights: NDArray[np.float64]
    paths: tuple[NDArray[np.int64], ...]

    @classmethod
    def of(cls, graph: JointGraph, lengths: NDArray[np.float64], count: int) -> Links:
        """Divide bones with given lengths, (e,), into `count` links on average, such that links have similar lengths.

        With these weights the sum of weighted squares is minimal when the links' ends are spaced in proportion to their
        lengths.
        """
        relative = lengths / lengths.mean()
        counts = np.maximum(np.round(count * relative), 1).astype(np.int64)
        size, paths = len(graph.positions), []
        for (tail, head), number in zip(graph.edges, counts, strict=True):
            paths.append(np.concatenate([[tail], size + np.arange(number - 1), [head]]))
            size += int(number) - 1
        edges = np.concatenate([np.stack([path[:-1], path[1:]], axis=1) for path in paths])
        weights = np.repeat(counts / (count * relative), counts)
        return cls(size, edges, weights, tuple(paths))


def chains(graph: JointGraph) -> list[NDArray[np.int64]]:
    """Return the joints along every maximal path through free joints with two bones, including its ends."""
    neighbors = graph.neighbors
    is_inner = ~graph.pinned & (np.array([len(own) for own in neighbors]) == 2)
    found = []
    for start in np.flatnonzero(~is_inner):
        for second in neighbors[start]:
            way = [start, second]
            while is_inner[way[-1]]:
                way.append(next(joint for joint in neighbors[way[-1]] if joint != way[-2]))
            # Every chain is found from both ends; keep one of the two. The same goes for loops.
            if (way[0], way[1]) <= (way[-1], way[-2]):
                found.append(np.array(way))
    return found


def spread_along(
    graph: JointGraph, links: Links, initial: NDArray[np.float64], lengths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return joints, (v, 3), spaced along the laid-out chains in proportion to the lengths of the bones.

    Parameters
    ----------
    graph : JointGraph
        The skeleton.
    links : Links
        The links of the skeleton.
    initial : (links.size, 3)
        Laid-out positions of the links' ends.
    lengths : (e,)
        Lengths of the bones, positive.
    """
    positions = initial[: len(graph.positions)].copy()
    for chain in chains(graph):
        if len(chain) < 3:
            continue
        bones = graph.bones_along(chain)
        paths = [
            links.paths[b] if links.paths[b][0] == joint else links.paths[b][::-1]
            for b, joint in zip(bones, chain[:-1], strict=True)
        ]
        curve = initial[np.concatenate([paths[0], *(path[1:] for path in paths[1:])])]
        positions[chain[1:-1]] = spaced(curve, lengths[bones])
    return positions


def spaced(curve: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points, (k - 1, 3), that divide a curve, (n, 3), in proportion to some lengths, (k,)."""
    gone = arc_lengths(curve)
    wanted = np.cumsum(lengths)
    places = wanted[:-1] / wanted[-1] * gone[-1]
    return along_polyline(places, gone, curve)
