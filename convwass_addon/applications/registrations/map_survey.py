# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Several rough maps of two shapes, of which the most plausible one is used.

A map of shapes with little in common is one of many that are about equally good, and tiny changes of the meshes decide
which one is found. So maps are solved between coarse meshes with different numbers of vertices, as the shapes stand and
turned, and judged by rough registrations that start from them. Maps of symmetric shapes keep left and right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...progress import Control, Progress, Work, drained
from ...sentence import Sentence
from ..workers import both_ways
from .carriers import Carrier
from .facing_turns import is_turned_over
from .laid_meshes import Laid
from .mirrored_sides import MirroredSides
from .pair_maps import PairMap, mirrored_map
from .pair_proposals import FROM_MAP, DraftPair, total_cost, trusted
from .pair_registration import carried, draft_of

# Numbers of vertices of the maps, each of which takes a second (docs/performance, "Left and right").
_VERTICES = (400, 320, 240, 160)
# What shapes without a common mirror plane count as their cost of losing left and right; chosen by eye.
_ASKEW = 2.0
# What registrations that turn a body over cost. From a caterpillar to a butterfly, it takes 0.4 to avoid them; from 1.1
# on, a dog no longer becomes a bird symmetrically, whose final registrations turn it by less than the rough ones.
_TURNED_OVER = 0.75
_NO_PAIRS = np.empty((0, 2), np.int64)


@dataclass(frozen=True)
class Promise:
    """What the score of the first rough map tells.

    Attributes
    ----------
    least : float
        With a lower score, no other map is tried.
    enough : float
        With at least this score, no other pose is tried.
    """

    least: float = 0.0
    enough: float = np.inf


@dataclass(frozen=True)
class RoughMap:
    """A rough map and the registrations that start from it.

    Attributes
    ----------
    pose : int
        Index of the pose of the first shape that was mapped.
    map : PairMap
        The score of the map.
    starts : (Laid, Laid)
        The registered vertices of each shape on the other one, in this pose.
    cost : float
        Cost of the registrations; see :func:`.pair_proposals.total_cost`.
    """

    pose: int
    map: PairMap
    starts: tuple[Laid, Laid]
    cost: float


def best_rough_map(
    poses: Sequence[Carrier], other: Carrier, promise: Promise, control: Control
) -> Work[RoughMap | None]:
    """Return the rough map of the lowest cost, or None if not even the first one is promising.

    Parameters
    ----------
    poses : sequence of Carrier
        The first shape, turned in every way that is tried.
    other : Carrier
        The second shape.
    promise : Promise
        Which maps are tried after the first one.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The meshes cannot be mapped.
    """
    found: list[RoughMap] = []
    total = len(poses) * len(_VERTICES)
    target = draft_of(other, control)
    for pose, one in enumerate(poses):
        if found and found[0].map.score >= promise.enough:
            break
        drafts = draft_of(one, control), target
        sides = MirroredSides.of(drafts[0].mesh, drafts[1].mesh)
        for vertices in _VERTICES:
            message = Sentence("Comparing map {done} of {total}", {"done": len(found) + 1, "total": total})
            yield Progress(len(found) / total, message)
            found.append(_rough_map(pose, drafts, sides, vertices, control))
            if found[0].map.score < promise.least:
                return None
    return min(found, key=lambda rough: rough.cost)


def _rough_map(
    pose: int, drafts: tuple[Carrier, Carrier], sides: MirroredSides | None, vertices: int, control: Control
) -> RoughMap:
    """Solve a map between coarse meshes, register them from it, and carry the result to all vertices."""
    found = drained(mirrored_map(*drafts, vertices, control, sides))
    starts = found.starts(*drafts)
    # Each direction needs both, and two threads would compute each twice.
    both_ways(lambda k: drafts[k].unit)
    pair = DraftPair(drafts, _NO_PAIRS, control)
    both = list(both_ways(lambda k: pair.proposed(k, starts[k], FROM_MAP)))
    drafted = [trusted(own) for own in both]
    over = any(is_turned_over(draft.mesh, own) for draft, own in zip(drafts, drafted, strict=True))
    cost = total_cost(pair, both, sides) + (_ASKEW if sides is None else 0.0) + (_TURNED_OVER if over else 0.0)
    laid = both_ways(lambda k: carried(drafts[k], drafted[k]))
    return RoughMap(pose, found, laid, cost)
