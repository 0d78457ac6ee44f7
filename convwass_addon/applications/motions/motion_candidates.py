# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The motions that a request can get, and figures that compare them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ...progress import Control, Work
from .coherence import FULL_COHERENCE
from .combined_motion import CombinedMotion, combined_motion
from .guided_motion import GuidedMotion, guided_motion
from .guided_settings import GuidedSettings
from .motion import arriving, ways_between
from .motion_choice import MotionChoice
from .motion_request import MotionRequest
from .remaining_distance import remaining_share
from .warp_motion import USUAL_EFFORT, WarpEffort, WarpMotion, warp_motion

COARSE_EFFORT = WarpEffort(cells=24, rounds=8, filled=750)
"""A warp of this effort costs a tenth of a guided motion."""

# Without a map, a warp is used if at most this share of the whole distance is left. From two dolphins to a bird, four
# fifths are, and torn; half from two balls to three, and at most a third from solids to each other.
_JOINED = 0.65
# Unless a shape becomes longer or shorter than by this factor, at equal volume: a ball that becomes a thin rod of the
# same height is a rod 2.6 times as high just before, and shrinks within a frame.
_MOST_GROWTH = 3.0
# Cells of the grid on which distances are compared; with 32, shares differ by less than 0.006 on the benchmark.
_CELLS = 24


@dataclass(frozen=True)
class MotionCandidates:
    """Computes the motions that a request can get, and measures them at full coherence.

    Attributes
    ----------
    request : MotionRequest
        The shapes, and the pairs that need a motion.
    control : Control
        Stops the work.
    """

    request: MotionRequest
    control: Control
    _warps: dict[WarpEffort, WarpMotion] = field(default_factory=dict, init=False, repr=False)

    def guided(self) -> Work[GuidedMotion]:
        """Compute the motion that maps between the surfaces guide."""
        request, settings = self.request, GuidedSettings(coherence=self.request.coherence)
        return guided_motion(request.shapes, request.names, request.pairs, settings, request.guides, self.control)

    def warp(self) -> Work[WarpMotion]:
        """Compute a warp."""
        return self._warped_by(USUAL_EFFORT)

    def coarse_warp(self) -> Work[WarpMotion]:
        """Compute a warp of less effort."""
        return self._warped_by(COARSE_EFFORT)

    def _warped_by(self, effort: WarpEffort) -> Work[WarpMotion]:
        """Compute a warp of some effort, unless a choice has asked for it before."""
        request = self.request
        if effort not in self._warps:
            self._warps[effort] = yield from warp_motion(
                request.shapes, request.names, request.pairs, request.coherence, self.control, effort
            )
        return self._warps[effort]

    def warped(self, unmoved: MotionChoice) -> Work[MotionChoice]:
        """Compute the choice of a warp, for the reason of another choice."""
        warp = yield from self.warp()
        return replace(unmoved, kind="warp", motion=warp, left=self.left(warp), turned=0.0)

    def completed(self, mapped: MotionChoice, effort: WarpEffort, arrival: float) -> Work[MotionChoice]:
        """Compute the choice of a guided motion with a warp that removes some of what it leaves."""
        motion = yield from combined_motion(mapped.motion, self.request, effort, arrival, self.control)
        return replace(mapped, kind="combined", reason="UNLIKE", motion=motion, left=self.left(motion))

    def left(self, motion: GuidedMotion | CombinedMotion | WarpMotion) -> float:
        """Return the largest share of the distance between two shapes that a motion leaves."""
        full, request = motion.with_coherence(FULL_COHERENCE), self.request
        return max(remaining_share(full, request.shapes, pair, _CELLS, self.control) for pair in request.pairs)

    def joins(self, warped: MotionChoice) -> bool:
        """Return whether a warp brings the shapes close to each other, and none of them grows too much on the way."""
        growth = max(np.ptp(np.log(warped.motion.sizes[list(pair)])) for pair in self.request.pairs)
        return warped.left <= _JOINED and growth <= np.log(_MOST_GROWTH)

    def warp_crumpling(self, warp: WarpMotion) -> float:
        """Return how much warped shapes crumple on each other at most, as :class:`.map_quality.MapQuality` says."""
        full, shapes = warp.with_coherence(FULL_COHERENCE), self.request.shapes
        ways = ways_between(self.request.pairs)
        return max(arriving(full, len(shapes), *way).mesh.area / shapes[way[1]].area for way in ways)


def mapped_choice(reason: str, guided: GuidedMotion) -> MotionChoice:
    """Return the choice of a guided motion."""
    pairs = guided.pairs.values()
    return MotionChoice(
        "guided",
        reason,
        guided,
        score=min(pair.score for pair in pairs),
        turned=max(abs(pair.turn) for pair in pairs),
        guides_left_out=sum(pair.guides_left_out for pair in pairs),
    )
