# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about the bones of a fitted skeleton."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...sentence import Sentence, first_names
from .skeleton_bodies import SkeletonBody
from .skeleton_graph import JointGraph
from .skeleton_links import chains

# Points along a bone that are tested.
_PLACES = np.linspace(0.0, 1.0, 9)[1:-1]
# Bones that leave the body by less than this, relative to its diagonal, are not visible.
_VISIBLE = 0.01
# A chain that is stretched by this factor relative to the others has its pins in the wrong places.
_TOO_LONG = 4.0


def bone_notices(
    graph: JointGraph, positions: NDArray[np.float64], lengths: NDArray[np.float64], body: SkeletonBody
) -> list[Sentence]:
    """Return warnings about bones that leave the body between their joints, and about pins that contradict the bones.

    Parameters
    ----------
    graph : JointGraph
        The skeleton.
    positions : (v, 3)
        Current positions of its joints.
    lengths : (e,)
        Relative lengths of its bones, positive.
    body : SkeletonBody
        The body.
    """
    notices = []
    leaving = _bones_outside(graph, positions, body)
    if len(leaving):
        names = [f"{graph.names[a]} - {graph.names[b]}" for a, b in graph.edges[leaving]]
        shown = {"count": len(leaving), "names": first_names(names, 3)}
        notices.append(Sentence("Bones that leave the body between their joints: {count} ({names}).", shown))
    for chain, times in _stretched(graph, positions, lengths):
        way = {"first": graph.names[chain[0]], "last": graph.names[chain[-1]], "times": times}
        notices.append(
            Sentence(
                "The path from {first} to {last} is {times:.1f} times as long as its bones; check the pins there.",
                way,
            )
        )
    return notices


def _bones_outside(graph: JointGraph, positions: NDArray[np.float64], body: SkeletonBody) -> NDArray[np.int64]:
    """Find the bones that visibly leave the body between their joints."""
    tails, heads = positions[graph.edges[:, 0]], positions[graph.edges[:, 1]]
    points = (tails[:, None] + _PLACES[:, None] * (heads - tails)[:, None]).reshape(-1, 3)
    outside = ~body.inside.contains(points)
    outside[outside] = body.inside.distances(points[outside]) > _VISIBLE * body.surface.diagonal
    return np.flatnonzero(outside.reshape(-1, len(_PLACES)).any(axis=1))


def _stretched(
    graph: JointGraph, positions: NDArray[np.float64], lengths: NDArray[np.float64]
) -> list[tuple[NDArray[np.int64], float]]:
    """Find the chains that are much more stretched than the others, and their factors."""
    ways = chains(graph)
    laid = np.array([np.linalg.norm(np.diff(positions[way], axis=0), axis=1).sum() for way in ways])
    ratios = laid / [sum(lengths[graph.bones_along(way)]) for way in ways]
    usual = np.median(ratios)
    return [(way, float(r / usual)) for way, r in zip(ways, ratios, strict=True) if r > _TOO_LONG * usual > 0]
