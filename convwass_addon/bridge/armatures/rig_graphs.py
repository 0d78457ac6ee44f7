# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The joints of a rig, either an armature or a mesh of edges, and their counterparts in Blender."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.skeletons.skeleton_graph import JointGraph
from ...errors import InputError
from ..matrix_checks import is_flattening, require_finite


@dataclass(frozen=True)
class RigGraph:
    """The joints of a rig.

    Attributes
    ----------
    graph : JointGraph
        Joints and edges, world space.
    ends : tuple of tuple of str
        Parts of the rig at each joint: ends of bones, such as "Arm.L.head", or a vertex number. The first one is the
        joint's name.
    selected : (v,) bool
        Joints selected in Edit Mode.
    matrix : (4, 4) float64
        From rig space to world space.
    parts : tuple of str
        Identifies later changes of the rig: names of bones, or the number of vertices.
    clashes : tuple of (str, str)
        Ends that were apart and are now pinned at the same position.
    """

    graph: JointGraph
    ends: tuple[tuple[str, ...], ...]
    selected: NDArray[np.bool_]
    matrix: NDArray[np.float64]
    parts: tuple[str, ...]
    clashes: tuple[tuple[str, str], ...] = ()

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {end: joint for joint, own in enumerate(self.ends) for end in own}

    def joint(self, name: str) -> int:
        """Return the index of a joint by the name of any of its ends; raises InputError if there is none."""
        if name not in self._numbers:
            raise InputError(
                "There is no joint {name}; joints are named after bones, such as {example}.",
                name=name,
                example=self.graph.names[0],
            )
        return self._numbers[name]

    def require_pins_apart(self) -> None:
        """Raise InputError if two pinned ends were moved to the same position and would become one joint."""
        for first, second in self.clashes:
            raise InputError(
                "{first} and {second} are pinned in the same place; move or unpin one of them.",
                first=first,
                second=second,
            )

    def pinned_at(self, names: Iterable[str], places: Mapping[str, NDArray[np.float64]]) -> RigGraph:
        """Return a copy of the rig with more pins, some of them at given positions in world space."""
        positions, pinned = self.graph.positions.copy(), self.graph.pinned.copy()
        for name in (*names, *places):
            pinned[self.joint(name)] = True
        for name, place in places.items():
            positions[self.joint(name)] = place
        # The rest positions are kept, and with them the lengths of bones.
        return replace(self, graph=replace(self.graph, positions=positions, pinned=pinned))


def world_matrix(obj: bpy.types.Object) -> NDArray[np.float64]:
    """Return the (4, 4) matrix from rig space to world space.

    Raises
    ------
    InputError
        The matrix flattens the rig, or is not finite.
    """
    matrix = np.array(obj.matrix_world, dtype=np.float64)
    require_finite(obj.name, matrix)
    if is_flattening(matrix):
        raise InputError("{object} has a scale of zero; give it another scale in Item > Transform.", object=obj.name)
    return matrix
