# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find out from a rough map whether two shapes may map onto each other beyond doubt."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.alignment import aligned
from ...progress import Control, Progress, Work, drained
from ...sentence import Sentence
from ..workers import both_ways
from .carriers import Carrier, carrier_of
from .facing_turns import symmetric_turn, turned_carrier
from .mirrored_sides import MirroredSides
from .pair_maps import mirrored_map

# Vertices of the meshes, and of the map between them.
_CARRIER_VERTICES, _MAP_VERTICES = 1500, 240
# Rods in different poses, heads with other ears, a snake and a rod, which map onto each other beyond doubt, have rough
# scores of 0.90 and more; a ball and a ring, a cactus, a bird or a knot, two balls and one have 0.1 to 0.57.
_PROMISING = 0.7
# Rough maps do not depend on turns by less than this angle.
_SMALL = np.radians(20.0)


def may_map(first: TriangleMesh, second: TriangleMesh, control: Control) -> Work[bool]:
    """Return whether a complete map of two shapes, as they stand or turned, is worth solving.

    Parameters
    ----------
    first, second : TriangleMesh
        The shapes, in scene units.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The meshes cannot be mapped.
    """
    yield Progress(0.0, Sentence("Comparing the shapes"))
    one, other = (carrier_of(mesh, "", _CARRIER_VERTICES, control) for mesh in (first, second))
    turns = symmetric_turn(one.mesh, other.mesh), _turn_of_axes(one.mesh, other.mesh)
    poses = [one, *(turned_carrier(one, turn) for turn in turns if turn is not None)]
    return any(_rough_score(pose, other, control) >= _PROMISING for pose in poses)


def _turn_of_axes(one: TriangleMesh, other: TriangleMesh) -> NDArray[np.float64] | None:
    """Return the rotation, (3, 3), that aligns the principal axes of a shape with another's, unless it is small."""
    turn = aligned((other, one), "PRINCIPAL_AXES", "PLACED")[1].rotation
    return turn if np.trace(turn) < 1.0 + 2.0 * np.cos(_SMALL) else None


def _rough_score(one: Carrier, other: Carrier, control: Control) -> float:
    """Return the better score of two maps, from either shape to the other one."""
    sides = MirroredSides.of(one.mesh, other.mesh)
    ways = (one, other, sides), (other, one, None if sides is None else sides.swapped)

    def score(k: int) -> float:
        first, second, kept = ways[k]
        return drained(mirrored_map(first, second, _MAP_VERTICES, control, kept)).score

    return max(both_ways(score))
