# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The motion of shapes whose surfaces are mapped onto each other, if they match."""

from __future__ import annotations

from dataclasses import replace

from ...progress import Control, Progress, Work, as_part, within
from ...sentence import Sentence
from ..outlines.revolved_motion import motion_with_parts
from ..registrations.limbs import is_compact
from ..registrations.pair_merits import TRUSTED
from ..registrations.promising_maps import may_map
from .motion_candidates import MotionCandidates, mapped_choice
from .motion_choice import FAILURES, MotionChoice, attempted
from .motion_request import MotionRequest
from .uncertain_maps import motion_by_uncertain_map
from .unmapped_motion import unmapped_motion

# If one of two shapes is compact, maps are good from this score on. A straight rod and a bent one have 0.99. A monkey's
# head and a cube have 0.89, and an ear would become a corner; a warp is symmetric.
_SURE = 0.95
# Below this score, solids of revolution move as such if what is attached to both does not map beyond doubt. A penguin
# whose wings become the arms of a snowman has 0.87, a mug whose rim is torn as it becomes a jug 0.78.
_TORN = 0.85
# Fractions of the work for a rough map and for the guided motion, if a warp follows.
_ROUGH_SHARE, _GUIDED_SHARE = 0.05, 0.4


def motion_of_surfaces(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the guided motion if it was asked for; otherwise the one that suits the shapes.

    Raises
    ------
    InputError
        Invalid guides, or a requested motion that cannot be computed.
    """
    candidates = MotionCandidates(request, control)
    if request.kind == "guided":
        return mapped_choice("ASKED", (yield from candidates.guided()))
    found = yield from _automatic(candidates)
    if request.bends and found.kind == "warp":
        return replace(found, kind="transport", reason="BENT", motion=None)
    return found


def _automatic(candidates: MotionCandidates) -> Work[MotionChoice]:
    """Return the guided motion if the shapes map onto each other, at least in part, perhaps completed by a warp.

    If they do not, they are warped. An uncertain map of limbs onto a shape that has none crumples them, where a warp
    lets them merge with it.
    """
    request = candidates.request
    known = request.guides or request.vertices_correspond
    compact = [not known and is_compact(shape) for shape in request.shapes]
    merges = all(compact[one] or compact[other] for one, other in request.pairs)
    solid = MotionChoice("transport", "SOLID")
    begin = _ROUGH_SHARE if merges else 0.0
    if all(compact):
        return (yield from unmapped_motion(solid, candidates))
    if merges and not (yield from within(_may_all_map(candidates), 0.0, begin)):
        return (yield from within(unmapped_motion(solid, candidates), begin, 1.0))
    try:
        guided = yield from within(candidates.guided(), begin, _GUIDED_SHARE)
    except FAILURES as error:
        if request.guides:
            raise
        yield Progress(1.0, Sentence("Transporting without a motion"))
        return MotionChoice("transport", "FAILED", None, failure=str(error))
    mapped = mapped_choice("VERTICES" if request.vertices_correspond else "FITS", guided)
    if mapped.score >= (_SURE if merges else TRUSTED):
        return mapped
    # Shapes without limbs have no handles either.
    if mapped.score < _TORN and not merges and not request.guides:
        revolved = attempted(motion_with_parts, request, guided, candidates.control)
        if revolved is not None:
            return revolved
    return (yield from within(motion_by_uncertain_map(mapped, merges, candidates), _GUIDED_SHARE, 1.0))


def _may_all_map(candidates: MotionCandidates) -> Work[bool]:
    """Return whether rough maps leave open that all pairs of shapes map onto each other beyond doubt."""
    pairs = candidates.request.pairs
    for number, pair in enumerate(pairs):
        one, other = (candidates.request.shapes[shape] for shape in pair)
        try:
            if not (yield from as_part(may_map(one, other, candidates.control), number, len(pairs))):
                return False
        except FAILURES:
            # The complete map fails, too, and says why, or it is better off with more vertices.
            continue
    return True
