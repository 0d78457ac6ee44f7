# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an uncertain map is used, completed by a warp, or given up for a warp or for transport."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...geometry.meshes.edges import component_areas
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import Progress, Work, within
from ...sentence import Sentence
from ..registrations.pair_maps import DOUBTED
from .motion_candidates import COARSE_EFFORT, MotionCandidates
from .motion_choice import FAILURES, MotionChoice, attempted
from .unmapped_motion import unmapped_motion
from .warp_motion import WarpEffort, WarpMotion

MUCH_LEFT = 0.3
"""A guided motion that leaves more than this share of the distance between two shapes is completed by a warp.

A coarse one, which costs a tenth of the motion, is tried first. It fades on the way to the other shape, where it would
leave more than without it: from an octopus to a horse, three times as much.
"""

# A fine warp is tried if the coarse one still leaves that much, and used if at most this share of what the map leaves
# is left all along the way. From an A to a B, two fifths are. Four fifths are left, and crumpled, where only one shape
# has a part (the front legs of a giraffe that was a flamingo). Such parts grow in place without a warp.
_WELL_WARPED = 0.5
# From an A to a B, it leaves 0.28 instead of 0.26 with the effort of warps alone, in a sixth of the time, and the
# largest step between frames is smaller.
_FINE_EFFORT = WarpEffort(cells=40, rounds=10, filled=3500)
# A map that makes long detours is given up if it leaves more than this share of the distance: a stool that became a
# trophy turned a somersault on the way. Between animals, such maps leave at most a third.
_MOST_LEFT = 0.5
# Beyond this share, a map is given up without guides, even if no warp is better: from a stool to a wine glass, a map
# leaves 0.99 and tears the bowl. From a table to a trophy, it leaves 0.57, and looks better than transport.
_NEARLY_ALL_LEFT = 0.75
# Below this score, a map is given up for a warp that leaves clearly less of the distance. By eye, a duck becomes a bird
# with its head in place (score 0.38), and a torus becomes a horse without being cut open (0.25). Between an octopus and
# a horse, which map with 0.44, the warp leaves less, but tears arms.
_UNSURE = 0.4
# Such a map, however low its score, is kept if it leaves at most `MUCH_LEFT`, and no shape has more than this many
# times the area of the other one where it lies on it. A scorpion and a lobster, whose legs a warp would tear, have 1.33
# times the area of a hand (score 0.15). Tori, which maps cut open, have 1.9 to 2.1 times the area of a horse, a dog or
# a man, although only 0.11 to 0.28 of the distance is left.
_CRUMPLED = 1.5
# With more than the first number of times the area, a warp is used instead if it joins the shapes and crumples them at
# most this share as much, though it may leave more. It has 0.6 to 0.8 of the area of a map from a crocodile or a rocket
# to a hand, from a dog to a bird, and from a torus to a horse or a dog, and looks better. It has 0.82 of it from a
# scorpion to an octopus, 0.9 from a torus to a man, and 0.94 from a goat to a bird, where the map looks better.
_MUCH_CRUMPLED, _SMOOTHER = 1.8, 0.8
# Clearly less is this share or less. From a duck to a bird, the warp leaves 0.83 of what the map does; from a rocket to
# a boat 0.89, and crumples the hull, where the map turns the hull into the sail.
_CLEARLY_LESS = 0.85
# A warp that may replace a map is not computed if a coarse one leaves so much that this share of it is too much, and
# crumples shapes, which finer ones do at least as much (docs/performance, "Doubtful maps").
_FINER = 1.0 / 3.0
# A warp does not complete a map that moves shapes farther than this many times the Wasserstein distance: that matches
# other parts than those near each other (a horse's neck and a bird's wing), which a warp would tear.
_DETOUR = 1.4
# Below this score, a map is given up if shapes tumble: a hand that becomes a chair (score 0.57) or a teapot that
# becomes a lamp (0.20) turns a somersault, though little may be left (0.15). Where people stand on their hands, it is
# above 0.9.
_STEADY = 0.6
# Connected components with at least this share of the area count as bodies.
_BODY = 0.1


def motion_by_uncertain_map(mapped: MotionChoice, merges: bool, candidates: MotionCandidates) -> Work[MotionChoice]:
    """Return the guided motion of an uncertain map, perhaps completed by a warp, or a warp or transport instead of it.

    Parameters
    ----------
    mapped : MotionChoice
        The guided motion.
    merges : bool
        Whether one shape of every pair has no limbs, so that those of the other merge with it.
    candidates : MotionCandidates
        Computes other motions, and measures what they leave.
    """
    guides, score = candidates.request.guides, mapped.score
    detour = max(pair.detour for pair in mapped.motion.pairs.values())
    far = detour > _DETOUR
    tumbles = any(pair.tumbles and pair.score < _STEADY for pair in mapped.motion.pairs.values()) and not guides
    # Where bodies divide or join far from each other, a map tears something.
    unfit = merges or tumbles or (far and _divides(candidates) and not guides)
    alone = replace(mapped, reason="PARTLY", detour=detour)
    if not unfit and score < _UNSURE:
        yield Progress(0.0, Sentence("Moving the shapes"))
        smooth = _lying_smoothly(alone, candidates)
        if smooth is not None:
            return smooth
    reason = "SOLID" if merges else "TUMBLING" if tumbles else "APART"
    unmoved = MotionChoice("transport", reason, None, score, detour=detour)
    if unfit or score < DOUBTED:
        return (yield from unmapped_motion(unmoved, candidates))
    doubtful = (score < _UNSURE or _crumpling(alone) > _MUCH_CRUMPLED) and not guides
    if far and not doubtful:
        return (yield from _by_detours(alone, unmoved, candidates))
    better = _perhaps_warped_instead if doubtful else _perhaps_warped
    found = yield from _unless_failing(better, alone, candidates)
    leaves_all = found.kind != "warp" and found.left is not None and found.left > _NEARLY_ALL_LEFT
    return replace(unmoved, left=found.left, failure=found.failure) if leaves_all and not guides else found


def _divides(candidates: MotionCandidates) -> bool:
    """Return whether two shapes differ in the number of their bodies."""
    shapes = candidates.request.shapes
    return any(_bodies(shapes[one]) != _bodies(shapes[other]) for one, other in candidates.request.pairs)


def _bodies(shape: TriangleMesh) -> int:
    areas = component_areas(shape)
    return int(np.count_nonzero(areas >= _BODY * areas.sum()))


def _lying_smoothly(alone: MotionChoice, candidates: MotionCandidates) -> MotionChoice | None:
    """Return a guided motion of an unsure map if shapes come close to each other without crumpling, otherwise None."""
    if _crumpling(alone) > _CRUMPLED:
        return None
    left = attempted(candidates.left, alone.motion)
    return replace(alone, left=left) if left is not None and left <= MUCH_LEFT else None


def _by_detours(alone: MotionChoice, unmoved: MotionChoice, candidates: MotionCandidates) -> Work[MotionChoice]:
    """Return the guided motion of a map that makes detours, unless it leaves most of the distance without guides."""
    if candidates.request.guides:
        return alone
    alone = replace(alone, left=attempted(candidates.left, alone.motion))
    if alone.left is None or alone.left <= _MOST_LEFT:
        return alone
    return (yield from unmapped_motion(unmoved, candidates))


def _unless_failing(
    better: Callable[[MotionChoice, MotionCandidates], Work[MotionChoice]],
    alone: MotionChoice,
    candidates: MotionCandidates,
) -> Work[MotionChoice]:
    """Measure what the guided motion leaves, and return what is better; the guided motion if anything fails."""
    yield Progress(0.0, Sentence("Moving the shapes"))
    try:
        alone = replace(alone, left=candidates.left(alone.motion))
        return (yield from better(alone, candidates))
    except FAILURES as error:
        return replace(alone, failure=str(error))


def _perhaps_warped_instead(alone: MotionChoice, candidates: MotionCandidates) -> Work[MotionChoice]:
    """Return a warp instead of a motion that crumples or follows an unsure map, if it is better in one of these."""
    if (yield from within(_may_be_better_warped(alone, candidates), 0.0, 0.05)):
        warped = yield from within(candidates.warped(replace(alone, reason="UNLIKE")), 0.05, 0.5)
        smoother = _is_smoother(warped.motion, alone, candidates)
        if (smoother or _is_nearer(warped.left, alone)) and candidates.joins(warped):
            return replace(warped, reason="CRUMPLED") if smoother else warped
    if alone.score < _UNSURE or alone.detour > _DETOUR:
        return alone
    return (yield from within(_perhaps_warped(alone, candidates), 0.5, 1.0))


def _may_be_better_warped(alone: MotionChoice, candidates: MotionCandidates) -> Work[bool]:
    """Return whether a coarse warp leaves open that a warp is smoother than a guided motion, or leaves less."""
    coarse = yield from candidates.coarse_warp()
    if _is_smoother(coarse, alone, candidates):
        return True
    return alone.score < _UNSURE and _is_nearer(_FINER * candidates.left(coarse), alone)


def _is_smoother(warp: WarpMotion, alone: MotionChoice, candidates: MotionCandidates) -> bool:
    """Return whether a guided motion crumples shapes much, and a warp does so clearly less."""
    crumpling = _crumpling(alone)
    return crumpling > _MUCH_CRUMPLED and candidates.warp_crumpling(warp) <= _SMOOTHER * crumpling


def _crumpling(alone: MotionChoice) -> float:
    """Return how much the shapes of a guided motion crumple on each other at most."""
    return max(pair.crumpling for pair in alone.motion.pairs.values())


def _is_nearer(left: float, alone: MotionChoice) -> bool:
    """Return whether a warp that leaves this share of the distance is better than the motion of an unsure map."""
    return alone.score < _UNSURE and left <= _CLEARLY_LESS * alone.left


def _perhaps_warped(alone: MotionChoice, candidates: MotionCandidates) -> Work[MotionChoice]:
    """Return the guided motion, unless it leaves much that a warp removes, instead of it or after it."""
    if alone.left <= MUCH_LEFT:
        return alone
    if not candidates.request.guides:
        warped = yield from within(_warped_instead(alone, candidates), 0.0, 0.4)
        if warped is not None:
            return warped
    coarse = yield from within(candidates.completed(alone, COARSE_EFFORT, arrival=0.0), 0.4, 0.6)
    best = coarse if coarse.left <= _CLEARLY_LESS * alone.left else alone
    if best.left <= MUCH_LEFT:
        return best
    fine = yield from within(candidates.completed(alone, _FINE_EFFORT, arrival=1.0), 0.6, 1.0)
    return fine if fine.left <= min(_WELL_WARPED * alone.left, best.left) else best


def _warped_instead(mapped: MotionChoice, candidates: MotionCandidates) -> Work[MotionChoice | None]:
    """Return a warp alone if it joins the shapes and leaves clearly less than a map; None otherwise.

    It is not tried unless even a coarse one leaves no more than the map. From a table to a chair and from a cup to a
    ring (scores of 0.44 and 0.52), that leaves 0.56 and 0.97 of it; the maps twist legs and tear the wall. From an
    octopus to a horse, it leaves 1.06 of it, and between 14 other pairs (0.41 to 0.84) at least 1.3; there, maps look
    better (docs/performance, "Doubtful maps").
    """
    coarse = yield from within(candidates.coarse_warp(), 0.0, 0.1)
    if candidates.left(coarse) > mapped.left:
        return None
    warped = yield from within(candidates.warped(replace(mapped, reason="UNLIKE")), 0.1, 1.0)
    return warped if warped.left <= _CLEARLY_LESS * mapped.left and candidates.joins(warped) else None
