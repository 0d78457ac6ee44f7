# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Group the ends of bones into joints.

A connected bone starts at its parent's tail, and ends at the same position are one joint. An unconnected bone is
attached to the nearer end of its parent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.arrays.components import component_labels
from .rig_bones import RigBone

# Relative to the extent of the armature.
_SAME = 1e-5


@dataclass(frozen=True)
class JointLayout:
    """The joints that the ends of bones belong to.

    Attributes
    ----------
    bones : sequence of RigBone
        All bones, parents before their children.
    joints : (b, 2) int
        Joint indices of head and tail of each bone.
    extent : float
        Diagonal of the bounding box of all ends.
    """

    bones: Sequence[RigBone]
    joints: NDArray[np.int64]
    extent: float

    @property
    def tolerance(self) -> float:
        """Ends closer to each other than this are one joint."""
        return _SAME * self.extent

    @cached_property
    def places(self) -> dict[str, int]:
        """The index of each bone by name."""
        return {bone.name: place for place, bone in enumerate(self.bones)}

    @cached_property
    def fitted(self) -> NDArray[np.int64]:
        """Indices of the bones to fit, (f,): those that deform meshes, or all if none does."""
        deforming = [place for place, bone in enumerate(self.bones) if bone.is_deforming]
        return np.array(deforming or range(len(self.bones)), dtype=np.int64)

    def points(self) -> NDArray[np.float64]:
        """Positions of the joints, (j, 3)."""
        return self._of_joints([bone.ends for bone in self.bones])

    def rest(self) -> NDArray[np.float64]:
        """Positions before any joint was pinned, (j, 3); the current ones if they are unknown for some bone."""
        noted = [bone.rest for bone in self.bones]
        return self.points() if any(ends is None for ends in noted) else self._of_joints(noted)

    def _of_joints(self, ends: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        found = np.empty((int(self.joints.max(initial=-1)) + 1, 3))
        # Ends of one joint may differ by rounding; use those of parents.
        for joints, own in reversed([*zip(self.joints, ends, strict=True)]):
            found[joints[::-1]] = own[::-1]
        return found


def joint_layout(bones: Sequence[RigBone]) -> JointLayout:
    """Group the ends of at least one bone into joints."""
    points = np.concatenate([bone.ends for bone in bones])
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    pairs = cKDTree(points).query_pairs(_SAME * extent, output_type="ndarray").reshape(-1, 2)
    places = {bone.name: place for place, bone in enumerate(bones)}
    joined = [(2 * places[bone.parent] + 1, 2 * place) for place, bone in enumerate(bones) if bone.is_connected]
    first, second = np.concatenate([pairs, np.array(joined, dtype=np.int64).reshape(-1, 2)]).T
    # Joints are numbered in the order of the bones.
    return JointLayout(bones, component_labels(first, second, len(points)).reshape(-1, 2), extent)
