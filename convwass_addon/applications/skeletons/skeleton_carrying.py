# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Move limbs without pins rigidly along with the joints that they are attached to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .skeleton_graph import JointGraph

# Joints up to this number of bones from a limb's root determine the rotation of the limb.
_HOPS = 2


def between_pins(graph: JointGraph) -> NDArray[np.bool_]:
    """Return which joints lie on a path between pins or in a loop, as opposed to loose limbs, (v,)."""
    kept = np.ones(len(graph.positions), bool)
    degree = np.array([len(own) for own in graph.neighbors])
    loose = [joint for joint in np.flatnonzero(~graph.pinned).tolist() if degree[joint] <= 1]
    while loose:
        joint = loose.pop()
        kept[joint] = False
        for other in graph.neighbors[joint]:
            degree[other] -= 1
            if kept[other] and not graph.pinned[other] and degree[other] == 1:
                loose.append(other)
    return kept


def carried(graph: JointGraph, fitted: NDArray[np.float64], kept: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the joints, (v, 3), with loose limbs moved, rotated and scaled like what they are attached to.

    Parameters
    ----------
    graph : JointGraph
        The skeleton before the fit.
    fitted : (v, 3)
        Fitted positions of the other joints.
    kept : (v,) bool
        Mask of those joints.
    """
    positions = fitted.copy()
    for root in np.flatnonzero(kept).tolist():
        limb = _connected_joints(graph, [other for other in graph.neighbors[root] if not kept[other]], ~kept)
        if not limb:
            continue
        near = _nearby(graph, root, kept)
        before, after = graph.rest[near] - graph.rest[root], fitted[near] - fitted[root]
        turned = (graph.rest[limb] - graph.rest[root]) @ _similarity(before, after).T
        positions[limb] = fitted[root] + turned
    return positions


def _similarity(before: NDArray[np.float64], after: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation times scale, (3, 3), that best maps vectors to others (Kabsch 1976; Umeyama 1991)."""
    spread = float(np.square(before).sum())
    if not spread > 0:
        return np.eye(3)
    left, sizes, right = np.linalg.svd(after.T @ before)
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(left) * np.linalg.det(right))])
    return float(sizes @ signs) / spread * (left * signs) @ right


def _nearby(graph: JointGraph, root: int, kept: NDArray[np.bool_]) -> list[int]:
    found = {root}
    for _ in range(_HOPS):
        found |= {other for joint in found for other in graph.neighbors[joint] if kept[other]}
    return sorted(found)


def _connected_joints(graph: JointGraph, starts: list[int], allowed: NDArray[np.bool_]) -> list[int]:
    found, waiting = set(starts), list(starts)
    while waiting:
        for other in graph.neighbors[waiting.pop()]:
            if allowed[other] and other not in found:
                found.add(other)
                waiting.append(other)
    return sorted(found)
