# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a laid-out skeleton to the medial axis of the body's limbs.

The objective is that of the propagation: the weighted sum of squared distances along the bones. Points take the place
of distributions, and paths lead through the body instead of along its surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from ...geometry.plane.polylines import along_polyline, arc_lengths
from ...geometry.solids.inner_balls import InnerBalls
from ...geometry.solids.solid_angles import Inside
from .skeleton_graph import JointGraph
from .skeleton_links import chains, spaced

# Chosen by eye; docs/performance, "Skeletons", lists what these and the other constants of the fit achieve.
# Weight that holds a branching joint where it was laid out, relative to the pull of its bones.
_ANCHOR_WEIGHT = 0.25
_ROUNDS = 10
# Paths from ball to ball are smoothed over the first of these fractions of their length that keeps joints inside, on
# this many points.
_SMOOTHING, _POINTS = (0.12, 0.06, 0.02), 400


def settled(
    graph: JointGraph, initial: NDArray[np.float64], lengths: NDArray[np.float64], balls: InnerBalls, inside: Inside
) -> NDArray[np.float64]:
    """Return the joints moved to the middle of the body, (v, 3).

    Parameters
    ----------
    graph : JointGraph
        The skeleton. Pins keep their positions in `initial`.
    initial : (v, 3)
        Laid-out positions of the joints.
    lengths : (e,)
        Lengths of the bones, positive, in any unit; joints on a path are spaced in proportion to them.
    balls : InnerBalls
        Inner balls of the body.
    inside : Inside
        Inside tests of the body.
    """
    limbs = [_Limb(chain, lengths[graph.bones_along(chain)]) for chain in chains(graph)]
    keys = np.unique([joint for limb in limbs for joint in (limb.joints[0], limb.joints[-1])])
    places = _Places(graph, initial, balls, keys)
    places.improve(limbs)
    positions = initial.copy()
    for limb in limbs:
        limb.place(positions, places, inside)
    return positions


@dataclass(frozen=True)
class _Limb:
    """A chain of bones from one pinned or branching joint to another."""

    joints: NDArray[np.int64]
    lengths: NDArray[np.float64]

    @property
    def length(self) -> float:
        """Total length of the bones."""
        return float(sum(self.lengths))

    def place(self, positions: NDArray[np.float64], places: _Places, inside: Inside) -> None:
        """Set the positions of the joints."""
        first, last = self.joints[0], self.joints[-1]
        curve = places.curve(first, last)
        positions[first], positions[last] = curve[0], curve[-1]
        for share in (*_SMOOTHING, 0.0):
            joints = spaced(_smoothed_path(curve, share), self.lengths)
            if inside.contains(joints).all():
                break
        positions[self.joints[1:-1]] = joints


class _Places:
    """Positions of the pinned and branching joints as nodes: the balls, followed by one node per pin."""

    def __init__(
        self, graph: JointGraph, initial: NDArray[np.float64], balls: InnerBalls, keys: NDArray[np.int64]
    ) -> None:
        pins = [joint for joint in keys.tolist() if graph.pinned[joint]]
        self._initial = initial
        self.points = np.concatenate([balls.centers, initial[pins]])
        self._links = _with_pins(balls, initial[pins])
        self._hubs = [joint for joint in keys.tolist() if not graph.pinned[joint]]
        self._node = {joint: len(balls.centers) + i for i, joint in enumerate(pins)}
        for joint in self._hubs:
            self._node[joint] = int(np.argmin(np.linalg.norm(balls.centers - initial[joint], axis=1) * balls.costs))
        self._free = np.arange(len(self.points)) < len(balls.centers)
        self._distances = {joint: self._from(joint) for joint in self._node}

    def _from(self, joint: int) -> NDArray[np.float64]:
        return dijkstra(self._links, indices=self._node[joint])

    def improve(self, limbs: list[_Limb]) -> None:
        """Move each branching joint in turn to the ball where the pull of its bones is least."""
        about = {hub: [limb for limb in limbs if hub in (limb.joints[0], limb.joints[-1])] for hub in self._hubs}
        scale = sum(limb.length for limb in limbs) / sum(
            self._distances[limb.joints[0]][self._node[limb.joints[-1]]] for limb in limbs
        )
        for _ in range(_ROUNDS):
            moved = False
            for hub, own in about.items():
                away = np.square(self.points - self._initial[hub]).sum(axis=1)
                pull = _ANCHOR_WEIGHT * away * scale / (sum(limb.length for limb in own) / len(own))
                for limb in own:
                    other = limb.joints[0] if limb.joints[-1] == hub else limb.joints[-1]
                    if other != hub:
                        pull += np.square(self._distances[other]) * scale / limb.length
                best = int(np.argmin(np.where(self._free, pull, np.inf)))
                if best != self._node[hub]:
                    self._node[hub], moved = best, True
                    self._distances[hub] = self._from(hub)
            if not moved:
                break

    def curve(self, first: int, last: int) -> NDArray[np.float64]:
        """Return the shortest path between two joints, (k, 3)."""
        before = dijkstra(self._links, indices=self._node[first], return_predecessors=True)[1]
        node, nodes = self._node[last], [self._node[last]]
        while node != self._node[first]:
            node = int(before[node])
            nodes.append(node)
        return self.points[nodes[::-1]]


def _with_pins(balls: InnerBalls, pins: NDArray[np.float64]) -> csr_array:
    """Link every pin to the balls that contain it."""
    links = balls.links.tocoo()
    tails, heads, costs = [links.row], [links.col], [links.data]
    count = len(balls.centers)
    for index, pin in enumerate(pins):
        near = balls.entrances(pin)
        away = np.maximum(np.linalg.norm(balls.centers[near] - pin, axis=1), np.finfo(float).tiny) * balls.costs[near]
        own = np.full(len(near), count + index)
        tails += [own, near]
        heads += [near, own]
        costs += [away, away]
    size = count + len(pins)
    entries = np.concatenate(costs), (np.concatenate(tails), np.concatenate(heads))
    return coo_array(entries, shape=(size, size)).tocsr()


def _smoothed_path(path: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Smooth a path from ball to ball over a fraction of its length, keeping its ends."""
    covered = arc_lengths(path)
    if not (covered[-1] > 0 and share > 0):
        return path
    places = np.linspace(0.0, covered[-1], _POINTS)
    curve = along_polyline(places, covered, path)
    # Extend the curve by point reflection at its ends, which keeps them fixed.
    width = max(1, round(share * _POINTS))
    before, after = 2 * curve[0] - curve[width:0:-1], 2 * curve[-1] - curve[-2 : -width - 2 : -1]
    padded = np.concatenate([before, curve, after])
    for _ in range(2):
        padded = uniform_filter1d(padded, width | 1, axis=0, mode="nearest")
    smoothed = padded[width:-width]
    smoothed[0], smoothed[-1] = path[0], path[-1]
    return smoothed
