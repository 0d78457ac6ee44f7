# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Choose the motion of a morph: the requested one, or the one that suits the shapes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ...errors import Cancelled
from ...geometry.common_axes import plane_share
from ...geometry.edges import vertex_components
from ...geometry.mesh import TriangleMesh
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..outlines.extruded_motion import extruded_motion
from ..outlines.revolved_motion import revolved_motion
from ..workers import one_blas_thread
from .coherence import FULL_COHERENCE
from .combined_motion import CombinedMotion, combined_motion
from .guided_motion import GuidedMotion, guided_motion
from .guided_settings import GuidedSettings
from .limbs import is_compact
from .mapped_pairs import DOUBTED, TRUSTED
from .motion import arriving
from .motion_choice import FAILURES, MotionChoice, attempted
from .motion_request import MotionRequest
from .promising_maps import may_map
from .remaining_distance import remaining_share
from .separate_bodies import SeparateBodies
from .skinned_motion import following, with_skins
from .turned_motion import Turning
from .warp_motion import WarpEffort, WarpMotion, warp_motion

# A guided motion that leaves more than this share of the distance between two shapes is completed by a warp. A coarse
# one, which costs a tenth of the motion, is tried first. It fades on the way to the other shape, where it would leave
# more than without it: from an octopus to a horse, three times as much.
_MUCH_LEFT = 0.3
_COARSE = WarpEffort(cells=24, rounds=8, filled=750)
# A fine warp is tried if the coarse one still leaves that much, and used if at most this share of what the map leaves
# is left all along the way. From an A to a B, two fifths are. Four fifths are left, and crumpled, where only one shape
# has a part (the front legs of a giraffe that was a flamingo). Such parts grow in place without a warp.
_WELL_WARPED = 0.5
# From an A to a B, it leaves 0.28 instead of 0.26 with the effort of warps alone, in a sixth of the time, and the
# largest step between frames is smaller.
_FINE = WarpEffort(cells=40, rounds=10, filled=3500)
# Where the guided motion leaves more than this share of the distance, a warp alone is tried, too: the map of an O to an
# X cuts the O open and leaves three quarters. A map that makes long detours is given up then: a stool that became a
# trophy turned a somersault on the way. Between animals, such maps leave at most a third.
_MOST_LEFT = 0.5
# Beyond this share, a map is given up without guides, even if no warp is better: from a stool to a wine glass, a map
# leaves 0.99 and tears the bowl. From a table to a trophy, it leaves 0.57, and looks better than transport.
_NEARLY_ALL_LEFT = 0.75
# Without a map, a warp is used if at most this share of the whole distance is left. From two dolphins to a bird, four
# fifths are, and torn; half from two balls to three, and at most a third from solids to each other.
_JOINED = 0.65
# Unless a shape becomes longer or shorter than by this factor, at equal volume: a ball that becomes a thin rod of the
# same height is a rod 2.6 times as high just before, and shrinks within a frame.
_MOST_GROWTH = 3.0
# If one of two shapes is compact, maps are good from this score on. A straight rod and a bent one have 0.99. A monkey's
# head and a cube have 0.89, and an ear would become a corner; a warp is symmetric.
_SURE = 0.95
# Below this score, a map is given up for a warp that leaves clearly less of the distance. By eye, a duck becomes a bird
# with its head in place (score 0.38), and a torus becomes a horse without being cut open (0.25). Between an octopus and
# a horse, which map with 0.44, the warp leaves less, but tears arms.
_UNSURE = 0.4
# Such a map, however low its score, is kept if it leaves at most `_MUCH_LEFT`, and no shape has more than this many
# times the area of the other one where it lies on it. A scorpion and a lobster, whose legs a warp would tear, have 1.33
# times the area of a hand (score 0.15). Tori, which maps cut open, have 1.9 to 2.1 times the area of a horse, a dog or
# a man, although only 0.11 to 0.28 of the distance is left.
_CRUMPLED = 1.5
# With more than the first number of times the area, a warp is used instead if it joins the shapes and crumples them at
# most this share as much, though it may leave more. It has 0.6 to 0.8 of the area of a map from a crocodile or a rocket
# to a hand, from a dog to a bird, and from a torus to a horse or a dog, and looks better. It has 0.82 of it from a
# scorpion to an octopus, 0.9 from a torus to a man, and 0.94 from a goat to a bird, where the map looks better.
_MUCH_CRUMPLED, _SMOOTHER = 1.8, 0.8
# Shapes of which at least the first share is plane are transported instead of warped if a coarse warp crumples them
# more than that: it bows the legs of a table or a chair, and the boards of a shelf, on the way to a box (1.4 to 2.1
# times the area), but not a toy brick or the letter L (1.1, 1.2).
_PLANE, _BENT = 0.9, 1.25
# Clearly less is this share or less. From a duck to a bird, the warp leaves 0.83 of what the map does; from a rocket to
# a boat 0.89, and crumples the hull, where the map turns the hull into the sail.
_CLEARLY_LESS = 0.85
# A warp that may replace a map is not computed if a coarse one leaves so much that this share of it is too much, and
# crumples shapes, which finer ones do at least as much (docs/performance, "Doubtful maps").
_FINER = 1.0 / 3.0
# A warp does not complete a map that moves shapes farther than this many times the Wasserstein distance: that matches
# other parts than those near each other (a horse's neck and a bird's wing), which a warp would tear.
_DETOUR = 1.4
# Connected components with at least this share of the area count as bodies.
_BODY = 0.1
# Where bodies overlap and the motion of their outer surface leaves much, they are also mapped as they are, and that is
# used if it leaves at most this share: from a robot of boxes to a chair, 0.14 instead of 0.6.
_BETTER_APART = 0.5
# Cells of the grid on which distances are compared; with 32, shares differ by less than 0.006 on the benchmark.
_CELLS = 24
# Fractions of the work for a rough map, for the guided motion, if a warp follows, for outer surfaces, and for bodies
# that lie apart.
_ROUGH_SHARE, _GUIDED_SHARE, _SKIN_SHARE, _APART_SHARE = 0.05, 0.4, 0.6, 0.7


def chosen_motion(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Choose and compute the motion of a morph.

    Raises
    ------
    InputError
        Invalid guides, or a requested motion that cannot be computed.
    """
    with one_blas_thread():
        return (yield from _chosen(request, control))


def _chosen(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    if request.kind == "transport" or request.coherence == 0.0 or not request.pairs:
        return MotionChoice("transport", "ASKED")
    if request.kind == "warp":
        return MotionChoice("warp", "ASKED", (yield from _warp(request, control)))
    yield Progress(0.0, Sentence("Reading the shapes"))
    outlined = _by_outlines(request, control)
    if outlined is not None:
        return outlined if request.kind == "automatic" else replace(outlined, reason="ASKED")
    apart = attempted(SeparateBodies.of, request) if request.is_free else None
    if apart is None:
        return (yield from _unless_outlined(request, control))
    found = yield from within(_by_separate_bodies(apart, control), 0.0, _APART_SHARE)
    return found or (yield from within(_unless_outlined(request, control), _APART_SHARE, 1.0))


def _by_separate_bodies(apart: SeparateBodies, control: Control) -> Work[MotionChoice | None]:
    """Return the motion of shapes whose bodies move by themselves, or None if a body is not guided."""
    found = []
    for number, request in enumerate(apart.requests):
        choice = _by_outlines(request, control)
        if choice is None:
            if all(map(is_compact, request.shapes)):
                return None
            begin, end = (share / len(apart.requests) for share in (number, number + 1))
            choice = yield from within(_unless_outlined(request, control), begin, end)
        if choice.kind != "guided":
            return None
        found.append(choice)
    return apart.joined(found)


def _unless_outlined(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the motion of shapes that outlines do not determine as they stand, though perhaps once they are turned."""
    turning = attempted(Turning.of, request, control) if request.is_free else None
    if turning is None:
        return (yield from _by_bodies(request, control))
    turned = turning.request
    return turning.applied(_by_outlines(turned, control) or (yield from _by_bodies(turned, control)))


def _by_bodies(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the motion of the shapes, or of the outer surfaces of those whose bodies overlap."""
    skinned = attempted(with_skins, request, control) or request
    if request.is_free and _are_plane(request.shapes):
        bends = bool((yield from within(_bends(skinned, control), 0.0, _ROUGH_SHARE)))
        request, skinned = replace(request, bends=bends), replace(skinned, bends=bends)
    if skinned.shapes is request.shapes:
        return (yield from _by_surfaces(request, control))
    return (yield from _by_outer_surfaces(request, skinned, control))


def _are_plane(shapes: Sequence[TriangleMesh]) -> bool:
    return all(plane_share(shape) >= _PLANE for shape in shapes)


def _bends(request: MotionRequest, control: Control) -> Work[bool]:
    """Return whether a coarse warp crumples shapes, as it bends their plane faces then."""
    try:
        warp = yield from _coarse_warp(request, control)
        return _warp_crumpling(warp, request) > _BENT
    except Cancelled:
        raise
    except FAILURES:
        # The complete warp fails, too, and says why.
        return False


def _by_outer_surfaces(request: MotionRequest, skinned: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the motion of the outer surfaces of overlapping bodies, or that of the bodies if it is much better."""
    found = yield from within(_by_surfaces(skinned, control), 0.0, _SKIN_SHARE)
    if found.left is not None and found.left > _MUCH_LEFT:
        other = yield from within(_by_surfaces(request, control), _SKIN_SHARE, 1.0)
        if other.left is not None and other.left <= _BETTER_APART * found.left:
            return other
    if found.motion is None:
        return found
    return replace(found, motion=following(found.motion, request.shapes, skinned.shapes))


def _by_surfaces(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the guided motion if it was asked for; otherwise the one that suits the shapes."""
    if request.kind == "guided":
        guided = yield from _guided(request, control)
        return _mapped("ASKED", guided)
    found = yield from _automatic(request, control)
    if request.bends and found.kind == "warp":
        return replace(found, kind="transport", reason="BENT", motion=None)
    return found


def _by_outlines(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the motion of shapes that outlines determine; None if they do not, or if there are guides."""
    if request.guides:
        return None
    for found_by in (extruded_motion, revolved_motion):
        found = attempted(found_by, request, control)
        if found is not None:
            return found
    return None


def _automatic(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the guided motion if the shapes map onto each other, at least in part, perhaps completed by a warp.

    If they do not, they are warped. An uncertain map of limbs onto a shape that has none crumples them, where a warp
    lets them merge with it.
    """
    compact = [not request.guides and is_compact(shape) for shape in request.shapes]
    merges = all(compact[one] or compact[other] for one, other in request.pairs)
    solid = MotionChoice("transport", "SOLID")
    begin = _ROUGH_SHARE if merges else 0.0
    if all(compact):
        return (yield from _unmapped(solid, request, control))
    if merges and not (yield from within(_may_all_map(request, control), 0.0, begin)):
        return (yield from within(_unmapped(solid, request, control), begin, 1.0))
    try:
        guided = yield from within(_guided(request, control), begin, _GUIDED_SHARE)
    except Cancelled:
        raise
    except FAILURES as error:
        if request.guides:
            raise
        yield Progress(1.0, Sentence("Transporting without a motion"))
        return MotionChoice("transport", "FAILED", None, failure=str(error))
    if _score(guided) >= (_SURE if merges else TRUSTED):
        return _mapped("FITS", guided)
    return (yield from within(_by_uncertain_map(guided, merges, request, control), _GUIDED_SHARE, 1.0))


def _by_uncertain_map(
    guided: GuidedMotion, merges: bool, request: MotionRequest, control: Control
) -> Work[MotionChoice]:
    """Return the guided motion of an uncertain map, perhaps completed by a warp, or a warp or transport instead of it.

    The map `merges` limbs with something if one shape of every pair has none.
    """
    score, detour = _score(guided), max(pair.detour for pair in guided.pairs.values())
    far = detour > _DETOUR
    # Where bodies divide or join far from each other, a map tears something.
    divides = any(_bodies(request.shapes[one]) != _bodies(request.shapes[other]) for one, other in request.pairs)
    unfit = merges or (far and divides and not request.guides)
    alone = replace(_mapped("PARTLY", guided), detour=detour)
    if not unfit and score < _UNSURE:
        yield Progress(0.0, Sentence("Moving the shapes"))
        smooth = _lying_smoothly(alone, request, control)
        if smooth is not None:
            return smooth
    unmoved = MotionChoice("transport", "SOLID" if merges else "APART", None, score, detour=detour)
    if unfit or score < DOUBTED:
        return (yield from _unmapped(unmoved, request, control))
    doubtful = (score < _UNSURE or _crumpling(guided) > _MUCH_CRUMPLED) and not request.guides
    if far and not doubtful:
        return (yield from _by_detours(alone, unmoved, request, control))
    better = _perhaps_warped_instead if doubtful else _perhaps_warped
    found = yield from _unless_failing(better, alone, request, control)
    leaves_all = found.kind != "warp" and found.left is not None and found.left > _NEARLY_ALL_LEFT
    given_up = leaves_all and not request.guides
    return replace(unmoved, left=found.left, failure=found.failure) if given_up else found


def _by_detours(
    alone: MotionChoice, unmoved: MotionChoice, request: MotionRequest, control: Control
) -> Work[MotionChoice]:
    """Return the guided motion of a map that makes detours, unless it leaves most of the distance without guides."""
    if request.guides:
        return alone
    alone = replace(alone, left=attempted(_left, alone.motion, request, control))
    if alone.left is None or alone.left <= _MOST_LEFT:
        return alone
    return (yield from _unmapped(unmoved, request, control))


def _mapped(reason: str, guided: GuidedMotion) -> MotionChoice:
    """Return the choice of a guided motion."""
    left_out = sum(pair.guides_left_out for pair in guided.pairs.values())
    return MotionChoice("guided", reason, guided, _score(guided), turned=_turned(guided), guides_left_out=left_out)


def _lying_smoothly(alone: MotionChoice, request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return a guided motion of an unsure map if shapes come close to each other without crumpling, otherwise None."""
    if _crumpling(alone.motion) > _CRUMPLED:
        return None
    left = attempted(_left, alone.motion, request, control)
    return replace(alone, left=left) if left is not None and left <= _MUCH_LEFT else None


def _may_all_map(request: MotionRequest, control: Control) -> Work[bool]:
    """Return whether rough maps leave open that all pairs of shapes map onto each other beyond doubt."""
    for number, pair in enumerate(request.pairs):
        one, other = (request.shapes[shape] for shape in pair)
        begin, end = (share / len(request.pairs) for share in (number, number + 1))
        try:
            if not (yield from within(may_map(one, other, control), begin, end)):
                return False
        except Cancelled:
            raise
        except FAILURES:
            # The complete map fails, too, and says why, or it is better off with more vertices.
            continue
    return True


def _unmapped(unmoved: MotionChoice, request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the warp if it joins the shapes all along the way; otherwise transport, which tears and bends less."""
    if request.bends:
        yield Progress(1.0, Sentence("Transporting without a motion"))
        return replace(unmoved, reason="BENT")
    try:
        warped = yield from _warped(unmoved, request, control)
    except Cancelled:
        raise
    except FAILURES as error:
        return replace(unmoved, reason="FAILED", failure=str(error))
    if _joins(warped, request):
        return warped
    yield Progress(1.0, Sentence("Transporting without a motion"))
    return replace(unmoved, left=warped.left)


def _unless_failing(
    better: Callable[[MotionChoice, MotionRequest, Control], Work[MotionChoice]],
    alone: MotionChoice,
    request: MotionRequest,
    control: Control,
) -> Work[MotionChoice]:
    """Measure what the guided motion leaves, and return what is better; the guided motion if anything fails."""
    yield Progress(0.0, Sentence("Moving the shapes"))
    try:
        alone = replace(alone, left=_left(alone.motion, request, control))
        return (yield from better(alone, request, control))
    except Cancelled:
        raise
    except FAILURES as error:
        return replace(alone, failure=str(error))


def _perhaps_warped_instead(alone: MotionChoice, request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return a warp instead of a motion that crumples or follows an unsure map, if it is better in one of these."""
    if (yield from within(_may_be_better_warped(alone, request, control), 0.0, 0.05)):
        warped = yield from within(_warped(replace(alone, reason="UNLIKE"), request, control), 0.05, 0.5)
        smoother = _is_smoother(warped.motion, alone, request)
        if (smoother or _is_nearer(warped.left, alone)) and _joins(warped, request):
            return replace(warped, reason="CRUMPLED") if smoother else warped
    if alone.score < _UNSURE or alone.detour > _DETOUR:
        return alone
    return (yield from within(_perhaps_warped(alone, request, control), 0.5, 1.0))


def _may_be_better_warped(alone: MotionChoice, request: MotionRequest, control: Control) -> Work[bool]:
    """Return whether a coarse warp leaves open that a warp is smoother than a guided motion, or leaves less."""
    coarse = yield from _coarse_warp(request, control)
    if _is_smoother(coarse, alone, request):
        return True
    return alone.score < _UNSURE and _is_nearer(_FINER * _left(coarse, request, control), alone)


def _is_smoother(warp: WarpMotion, alone: MotionChoice, request: MotionRequest) -> bool:
    """Return whether a guided motion crumples shapes much, and a warp does so clearly less."""
    crumpling = _crumpling(alone.motion)
    return crumpling > _MUCH_CRUMPLED and _warp_crumpling(warp, request) <= _SMOOTHER * crumpling


def _is_nearer(left: float, alone: MotionChoice) -> bool:
    """Return whether a warp that leaves this share of the distance is better than the motion of an unsure map."""
    return alone.score < _UNSURE and left <= _CLEARLY_LESS * alone.left


def _perhaps_warped(alone: MotionChoice, request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the guided motion, unless it leaves much that a warp removes, after it or instead of it."""
    if alone.left <= _MUCH_LEFT:
        return alone
    coarse = yield from within(_completed(alone, request, control, _COARSE, arrival=0.0), 0.0, 0.2)
    best = coarse if coarse.left <= _CLEARLY_LESS * alone.left else alone
    if best.left <= _MUCH_LEFT:
        return best
    fine = yield from within(_completed(alone, request, control, _FINE, arrival=1.0), 0.2, 0.6)
    if fine.left <= min(_WELL_WARPED * alone.left, best.left):
        return fine
    if alone.left <= _MOST_LEFT:
        return best
    return (yield from within(_warped_instead(best, request, control), 0.6, 1.0))


def _completed(
    alone: MotionChoice, request: MotionRequest, control: Control, effort: WarpEffort, arrival: float
) -> Work[MotionChoice]:
    """Return the guided motion with a warp that removes some of what it leaves."""
    guided, names, pairs = alone.motion, request.names, request.pairs
    motion = yield from combined_motion(guided, names, pairs, request.coherence, control, effort, arrival)
    left = _left(motion, request, control)
    return replace(alone, kind="combined", reason="UNLIKE", motion=motion, left=left)


def _warped_instead(mapped: MotionChoice, request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return a warp alone if it joins the shapes and leaves clearly less than a mapped motion; otherwise the latter."""
    warped = yield from _warped(replace(mapped, reason="UNLIKE"), request, control)
    return warped if warped.left <= _CLEARLY_LESS * mapped.left and _joins(warped, request) else mapped


def _warped(unmoved: MotionChoice, request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the choice of the warp, for the reason of another choice."""
    motion = yield from _warp(request, control)
    return replace(unmoved, kind="warp", motion=motion, left=_left(motion, request, control), turned=0.0)


def _joins(warped: MotionChoice, request: MotionRequest) -> bool:
    """Return whether a warp brings the shapes close to each other, and none of them grows too much on the way."""
    growth = max(np.ptp(np.log(warped.motion.sizes[list(pair)])) for pair in request.pairs)
    return warped.left <= _JOINED and growth <= np.log(_MOST_GROWTH)


def _left(motion: GuidedMotion | CombinedMotion | WarpMotion, request: MotionRequest, control: Control) -> float:
    """Return the largest share of the distance between two shapes that a motion leaves at full coherence."""
    full = motion.with_coherence(FULL_COHERENCE)
    return max(remaining_share(full, request.shapes, pair, _CELLS, control) for pair in request.pairs)


def _crumpling(guided: GuidedMotion) -> float:
    """Return how much the shapes of a guided motion crumple on each other at most."""
    return max(pair.crumpling for pair in guided.pairs.values())


def _warp_crumpling(warp: WarpMotion, request: MotionRequest) -> float:
    """Return how much warped shapes crumple on each other at most, measured as in :class:`.map_quality.MapQuality`."""
    full, shapes = warp.with_coherence(FULL_COHERENCE), request.shapes
    ways = [way for pair in request.pairs for way in (pair, pair[::-1])]
    return max(arriving(full, len(shapes), *way).mesh.area / shapes[way[1]].area for way in ways)


def _bodies(shape: TriangleMesh) -> int:
    labels = vertex_components(shape)
    # Vertices without faces belong to no component.
    used = labels >= 0
    areas = np.bincount(labels[used], shape.vertex_areas[used])
    return int(np.count_nonzero(areas >= _BODY * areas.sum()))


def _guided(request: MotionRequest, control: Control) -> Work[GuidedMotion]:
    settings = GuidedSettings(coherence=request.coherence)
    return guided_motion(request.shapes, request.names, request.pairs, settings, request.guides, control)


def _warp(request: MotionRequest, control: Control) -> Work[WarpMotion]:
    return warp_motion(request.shapes, request.names, request.pairs, request.coherence, control)


def _coarse_warp(request: MotionRequest, control: Control) -> Work[WarpMotion]:
    return warp_motion(request.shapes, request.names, request.pairs, request.coherence, control, effort=_COARSE)


def _score(guided: GuidedMotion) -> float:
    """Return the score of the worst map between two shapes."""
    return min(pair.score for pair in guided.pairs.values())


def _turned(guided: GuidedMotion) -> float:
    """Return the largest angle in degrees by which a shape was turned to be mapped."""
    return max(abs(pair.turn) for pair in guided.pairs.values())
