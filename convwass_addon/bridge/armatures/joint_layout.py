# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The joints that bones meet in.

A connected bone begins in its parent's tail, and ends of bones that lie on each other are one joint as well. A bone
that is not connected hangs on the nearer end of its parent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .rig_bones import RigBone

# Share of the armature's extent.
_SAME = 1e-5


@dataclass(frozen=True)
class JointLayout:
    """Which ends of bones are one joint.

    Attributes
    ----------
    bones : sequence of RigBone
        All of them, parents before their children.
    joints : (b, 2) int
        The joints of each bone's head and tail.
    extent : float
        Diagonal of the box around all ends.
    """

    bones: Sequence[RigBone]
    joints: NDArray[np.int64]
    extent: float

    @property
    def tolerance(self) -> float:
        """Ends that are nearer to each other are one joint."""
        return _SAME * self.extent

    @cached_property
    def places(self) -> dict[str, int]:
        """The number of each bone by its name."""
        return {bone.name: place for place, bone in enumerate(self.bones)}

    @cached_property
    def fitted(self) -> NDArray[np.int64]:
        """Numbers of the bones that are fitted, (f,): those that deform meshes, or all where none does."""
        deforming = [place for place, bone in enumerate(self.bones) if bone.is_deforming]
        return np.array(deforming or range(len(self.bones)), dtype=np.int64)

    def points(self) -> NDArray[np.float64]:
        """Where the joints are, (j, 3)."""
        return self._of_joints([bone.ends for bone in self.bones])

    def rest(self) -> NDArray[np.float64]:
        """Where they were before any was pinned elsewhere, (j, 3); where they are, if there are bones that were not."""
        noted = [bone.rest for bone in self.bones]
        return self.points() if any(ends is None for ends in noted) else self._of_joints(noted)

    def _of_joints(self, ends: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        found = np.empty((int(self.joints.max(initial=-1)) + 1, 3))
        # Where ends lie on each other but for rounding, those of parents count.
        for joints, own in reversed([*zip(self.joints, ends, strict=True)]):
            found[joints[::-1]] = own[::-1]
        return found


def joint_layout(bones: Sequence[RigBone]) -> JointLayout:
    """Find which ends of bones, of which there is at least one, are one joint."""
    points = np.concatenate([bone.ends for bone in bones])
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    pairs = cKDTree(points).query_pairs(_SAME * extent, output_type="ndarray").reshape(-1, 2)
    places = {bone.name: place for place, bone in enumerate(bones)}
    joined = [(2 * places[bone.parent] + 1, 2 * place) for place, bone in enumerate(bones) if bone.is_connected]
    first, second = np.concatenate([pairs, np.array(joined, dtype=np.int64).reshape(-1, 2)]).T
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(len(points), len(points)))
    _, labels = connected_components(graph, directed=False)
    # Numbered in the order in which bones come upon them.
    _, firsts, inverse = np.unique(labels, return_index=True, return_inverse=True)
    order = np.empty(len(firsts), dtype=np.int64)
    order[np.argsort(firsts)] = np.arange(len(firsts))
    return JointLayout(bones, order[inverse].reshape(-1, 2), extent)
