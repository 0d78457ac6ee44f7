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
from numpy.typing import NDArray

from ...progress import Control, Progress, Work, drained
from ...sentence import Sentence
from ..soft_maps.soft_map_settings import SoftMapSettings
from ..workers import one_blas_thread
from .carriers import Carrier, coarser
from .laid_meshes import Laid
from .mirrored_sides import MirroredSides
from .pair_maps import PairMap, mirrored_map
from .pair_proposals import FROM_MAP, proposed, total_cost, trusted
from .pair_registration import DRAFT_VERTICES, carried

# Numbers of vertices of the maps, each of which takes a second (docs/performance.md, "Left and right").
_VERTICES = (160, 240, 320, 400)
# What shapes without a common mirror plane count as their cost of losing left and right; chosen by eye.
_ASKEW = 2.0
_NO_PAIRS = np.empty((0, 2), np.int64)


@dataclass(frozen=True)
class RoughMap:
    """A rough map and the registrations that start from it.

    Attributes
    ----------
    turn : (3, 3) float64 or None
        Rotation of the first shape before it was mapped.
    map : PairMap
        The score of the map.
    starts : (Laid, Laid)
        The registered vertices of each shape on the other one, as turned.
    cost : float
        Cost of the registrations; see :func:`.pair_proposals.total_cost`.
    """

    turn: NDArray[np.float64] | None
    map: PairMap
    starts: tuple[Laid, Laid]
    cost: float


def best_rough_map(
    poses: Sequence[tuple[NDArray[np.float64] | None, Carrier]], other: Carrier, control: Control
) -> Work[RoughMap]:
    """Return the rough map of the lowest cost.

    Parameters
    ----------
    poses : sequence of (turn, Carrier)
        The first shape after each turn that is tried, and the rotation, (3, 3), or None.
    other : Carrier
        The second shape.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The meshes cannot be mapped.
    """
    best: RoughMap | None = None
    total = len(poses) * len(_VERTICES)
    target = _draft(other, control)
    for number, (turn, one) in enumerate(poses):
        drafts = _draft(one, control), target
        for place, vertices in enumerate(_VERTICES):
            done = number * len(_VERTICES) + place
            yield Progress(
                done / total, Sentence("Comparing map {done} of {total}", {"done": done + 1, "total": total})
            )
            found = _rough_map(turn, drafts, vertices, control)
            if best is None or found.cost < best.cost:
                best = found
    return best


def _draft(shape: Carrier, control: Control) -> Carrier:
    return coarser(shape, _NO_PAIRS[:, 0], DRAFT_VERTICES, control)


def _rough_map(
    turn: NDArray[np.float64] | None, drafts: tuple[Carrier, Carrier], vertices: int, control: Control
) -> RoughMap:
    """Solve a map between coarse meshes, register them from it, and carry the result to all vertices."""
    sides = MirroredSides.of(drafts[0].mesh, drafts[1].mesh)
    with one_blas_thread():
        found = drained(mirrored_map(*drafts, SoftMapSettings(vertices=vertices), control, sides))
        starts = found.starts(*drafts)
        both = [proposed(drafts, k, starts[k], _NO_PAIRS, FROM_MAP, control) for k in (0, 1)]
        cost = total_cost(drafts, both, sides) + (_ASKEW if sides is None else 0.0)
        laid = [carried(draft, trusted(own)) for draft, own in zip(drafts, both, strict=True)]
    return RoughMap(turn, found, (laid[0], laid[1]), cost)
