# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Choose the motion of a morph: the requested one, or the one that suits the shapes."""

from __future__ import annotations

from dataclasses import replace

from ...geometry.recognition.common_axes import plane_share
from ...progress import Control, Progress, Work, as_part, within
from ...sentence import Sentence
from ..outlines.extruded_motion import extruded_motion
from ..outlines.revolved_motion import revolved_motion
from ..outlines.tube_motion import tube_motion
from ..registrations.limbs import is_compact
from ..workers import one_blas_thread
from .motion_candidates import MotionCandidates
from .motion_choice import FAILURES, MotionChoice, attempted, reason_of_stand_ins
from .motion_request import MotionRequest
from .separate_bodies import SeparateBodies
from .skinned_motion import following, one_body_prevails, with_skins
from .surface_choice import motion_of_surfaces
from .turned_motion import Turning
from .uncertain_maps import MUCH_LEFT

# Shapes of which at least the first share is plane are transported instead of warped if a coarse warp crumples them
# more than that: it bows the legs of a table or a chair, and the boards of a shelf, on the way to a box (1.4 to 2.1
# times the area), but not a toy brick or the letter L (1.1, 1.2).
_PLANE, _BENT = 0.9, 1.25
# Where bodies overlap and the motion of their outer surface leaves much, they are also mapped as they are, and that is
# used if it leaves at most this share: from a robot of boxes to a chair, 0.14 instead of 0.6. Details such as eyes
# change little.
_BETTER_APART = 0.5
# Fractions of the work for a coarse warp, for outer surfaces, and for bodies that lie apart.
_COARSE_SHARE, _SKIN_SHARE, _APART_SHARE = 0.05, 0.6, 0.7


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
        return MotionChoice("warp", "ASKED", (yield from MotionCandidates(request, control).warp()))
    yield Progress(0.0, Sentence("Reading the shapes"))
    outlined = _by_outlines(request, control)
    if outlined is not None:
        return outlined if request.kind == "automatic" else replace(outlined, reason="ASKED")
    divides = request.is_free and not request.vertices_correspond
    apart = attempted(SeparateBodies.of, request) if divides else None
    if apart is None:
        return (yield from _unless_outlined(request, control))
    found = yield from within(_by_separate_bodies(apart, control), 0.0, _APART_SHARE)
    return found or (yield from within(_unless_outlined(request, control), _APART_SHARE, 1.0))


def _by_outlines(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the motion of shapes that outlines or center lines determine, None if there are guides or they do not."""
    if request.guides:
        return None
    for found_by in (extruded_motion, revolved_motion, tube_motion):
        found = attempted(found_by, request, control)
        if found is not None:
            return found
    return None


def _by_separate_bodies(apart: SeparateBodies, control: Control) -> Work[MotionChoice | None]:
    """Return the motion of shapes whose bodies move by themselves, or None if a body is not guided."""
    found = []
    for number, request in enumerate(apart.requests):
        choice = _by_outlines(request, control)
        if choice is None:
            if all(map(is_compact, request.shapes)):
                return None
            choice = yield from as_part(_unless_outlined(request, control), number, len(apart.requests))
        if choice.kind != "guided":
            return None
        found.append(choice)
    return apart.joined(found)


def _unless_outlined(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the motion of shapes that outlines do not determine as they stand, though perhaps once they are turned."""
    if request.vertices_correspond:
        return (yield from motion_of_surfaces(request, control))
    turning = attempted(Turning.of, request, control) if request.is_free else None
    if turning is None:
        return (yield from _by_bodies(request, control))
    turned = turning.request
    return turning.applied(_by_outlines(turned, control) or (yield from _by_bodies(turned, control)))


def _by_bodies(request: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the motion of the shapes, or of the outer surfaces of those whose bodies overlap."""
    skinned = attempted(with_skins, request, control) or request
    if request.is_free and all(plane_share(shape) >= _PLANE for shape in request.shapes):
        bends = bool((yield from within(_bends(skinned, control), 0.0, _COARSE_SHARE)))
        request, skinned = replace(request, bends=bends), replace(skinned, bends=bends)
    if skinned.shapes is request.shapes:
        return (yield from motion_of_surfaces(request, control))
    return (yield from _by_outer_surfaces(request, skinned, control))


def _bends(request: MotionRequest, control: Control) -> Work[bool]:
    """Return whether a coarse warp crumples shapes, as it bends their plane faces then."""
    candidates = MotionCandidates(request, control)
    try:
        return candidates.warp_crumpling((yield from candidates.coarse_warp())) > _BENT
    except FAILURES:
        # The complete warp fails, too, and says why.
        return False


def _by_outer_surfaces(request: MotionRequest, skinned: MotionRequest, control: Control) -> Work[MotionChoice]:
    """Return the motion of the outer surfaces of overlapping bodies, or that of the bodies if it is much better."""
    found = yield from within(motion_of_surfaces(skinned, control), 0.0, _SKIN_SHARE)
    if found.left is not None and found.left > MUCH_LEFT and not all(map(one_body_prevails, request.shapes)):
        other = yield from within(motion_of_surfaces(request, control), _SKIN_SHARE, 1.0)
        if other.left is not None and other.left <= _BETTER_APART * found.left:
            return other
    if found.motion is None:
        return found
    motion = following(found.motion, request.shapes, skinned.shapes)
    return replace(found, reason=reason_of_stand_ins(found.reason), motion=motion)
