# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The motion of shapes that do not map onto each other."""

from __future__ import annotations

from dataclasses import replace

from ...progress import Progress, Work
from ...sentence import Sentence
from .motion_candidates import MotionCandidates
from .motion_choice import FAILURES, MotionChoice


def unmapped_motion(unmoved: MotionChoice, candidates: MotionCandidates) -> Work[MotionChoice]:
    """Return the warp if it joins the shapes all along the way; otherwise transport, which tears and bends less.

    Parameters
    ----------
    unmoved : MotionChoice
        Transport, and why the shapes do not map.
    candidates : MotionCandidates
        Computes the warp.
    """
    if candidates.request.bends:
        yield Progress(1.0, Sentence("Transporting without a motion"))
        return replace(unmoved, reason="BENT")
    try:
        warped = yield from candidates.warped(unmoved)
    except FAILURES as error:
        return replace(unmoved, reason="FAILED", failure=str(error))
    if candidates.joins(warped):
        return warped
    yield Progress(1.0, Sentence("Transporting without a motion"))
    return replace(unmoved, left=warped.left)
