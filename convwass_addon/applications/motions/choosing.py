# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Choose the motion of a morph: the requested one, or the one that suits the shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...errors import Cancelled, ConvwassError
from ...geometry.mesh import TriangleMesh
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from .combined_motion import combined_motion
from .guided_motion import GuidedMotion, guided_motion
from .guided_settings import GuidedSettings
from .guides import Guide
from .limbs import is_nearly_convex
from .motion import Motion
from .warp_motion import warp_motion

# Guided motions are used alone if the worst map between two shapes has at least the first score, and are completed by a
# warp from the second on. Chosen by eye on pairs of the benchmark.
_TRUSTED, _DOUBTED = 0.88, 0.2
# Errors that computing a motion may raise on unforeseen meshes; the bake then continues without it.
_FAILURES = (ConvwassError, np.linalg.LinAlgError, ValueError, IndexError, ArithmeticError)
# Fraction of the work for the guided motion, if a warp may follow.
_GUIDED_SHARE = 0.4


@dataclass(frozen=True)
class MotionChoice:
    """The chosen motion and the reason.

    Attributes
    ----------
    kind : str
        "guided", "combined" (guided, and completed by a warp), "warp" or "transport".
    reason : str
        "ASKED" (requested), "SOLID" (no shape has limbs), "FITS" (the shapes map onto each other), "UNLIKE" (they do
        not), or "FAILED" (an error occurred).
    motion : Motion or None
        None for transport alone.
    score : float or None
        Score of the worst map between two shapes, 0 to 1, if there is one.
    failure : str
        Message of the error, if one occurred.
    """

    kind: str
    reason: str
    motion: Motion | None = field(default=None, repr=False)
    score: float | None = None
    failure: str = ""

    def record(self) -> dict[str, object]:
        """Return the description of the motion for the record of every frame, ready for JSON."""
        known = {"score": self.score, "failure": self.failure or None}
        return {"kind": self.kind, "reason": self.reason, **{k: v for k, v in known.items() if v is not None}}


def chosen_motion(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    asked: str,
    coherence: float,
    guides: Sequence[Guide],
    control: Control,
) -> Work[MotionChoice]:
    """Choose and compute the motion of a morph.

    Parameters
    ----------
    shapes, names
        The inputs, oriented outward, and their names for messages.
    pairs : sequence of (int, int)
        Pairs of inputs that occur together in a blend.
    asked : str
        "automatic", "guided", "warp" or "transport".
    coherence : float
        0 to 1; there is no motion at 0.
    guides : sequence of mappings from int to int
        See :func:`.guided_motion.guided_motion`.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        Invalid guides, or a requested motion that cannot be computed.
    """
    if asked == "transport" or coherence == 0.0 or not pairs:
        return MotionChoice("transport", "ASKED")
    if (
        asked == "automatic"
        and not guides
        and all(is_nearly_convex(shape.vertices[np.unique(shape.faces)], shape.volume) for shape in shapes)
    ):
        return MotionChoice("transport", "SOLID")
    if asked == "warp":
        motion = yield from warp_motion(shapes, names, pairs, coherence, control)
        return MotionChoice("warp", "ASKED", motion)
    settings = GuidedSettings(coherence=coherence)
    share = 1.0 if asked == "guided" else _GUIDED_SHARE
    guided, failure = None, ""
    try:
        guided = yield from within(guided_motion(shapes, names, pairs, settings, guides, control), 0.0, share)
    except Cancelled:
        raise
    except _FAILURES as error:
        if asked == "guided" or guides:
            raise
        failure = str(error)
    score = None if guided is None else _score(guided)
    if asked == "guided":
        return MotionChoice("guided", "ASKED", guided, score)
    if guided is not None and score >= _TRUSTED:
        return MotionChoice("guided", "FITS", guided, score)
    doubted = guided is not None and score >= _DOUBTED
    try:
        if doubted:
            work = combined_motion(guided, names, pairs, coherence, control)
        else:
            work = warp_motion(shapes, names, pairs, coherence, control)
        motion = yield from within(work, share, 1.0)
    except Cancelled:
        raise
    except _FAILURES as error:
        yield Progress(1.0, Sentence("Transporting without a motion"))
        return MotionChoice("transport", "FAILED", None, score, failure or str(error))
    kind = "combined" if doubted else "warp"
    return MotionChoice(kind, "FAILED" if guided is None else "UNLIKE", motion, score, failure)


def _score(guided: GuidedMotion) -> float:
    """Return the score of the worst map between two shapes."""
    return min(pair.score for pair in guided.pairs.values())
