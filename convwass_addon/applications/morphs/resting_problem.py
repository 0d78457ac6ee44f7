# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs whose inputs rest: each blend transports them as they are, starting from the preceding blend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ...progress import UNINTERRUPTED, Control
from .blending import HandOver, solve_blends, solve_some_blends
from .demands import Demand
from .kept_blends import KeptBlends
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .spare_threads import at_once
from .volumes import Lattice


@dataclass(frozen=True)
class RestingProblem:
    """The problem shared by all blends of inputs that do not move; see :class:`.BlendProblem`.

    Attributes
    ----------
    still : MorphProblem
        The inputs.
    kept : KeptBlends or None
        Where solved blends are kept, to compute them again under a demand.
    """

    still: MorphProblem
    kept: KeptBlends | None = None

    @property
    def lattice(self) -> Lattice:
        """The common grid of the inputs."""
        return self.still.lattice

    def effort(self, blend: Blend) -> float:
        """Estimate the relative time that a blend takes."""
        return self.still.transport.effort(blend)

    def frames(
        self, run: Sequence[Blend], control: Control = UNINTERRUPTED, hand_over: HandOver = at_once
    ) -> list[MorphFrame]:
        """Solve a run of blends, each started from the preceding one."""
        return solve_blends(self.still, run, control, None, hand_over, self.kept)

    def frames_again(
        self, run: Sequence[Blend], asked: Mapping[Blend, Demand], control: Control = UNINTERRUPTED
    ) -> list[MorphFrame]:
        """Compute some blends of a run again, with a demand on each, from the same barycenters."""
        limited = [self.still.demanding(asked[blend]) if blend in asked else None for blend in run]
        while limited and limited[-1] is None:
            limited.pop()
        return solve_some_blends(self.still.transport, run, limited, control, self.kept)

    def solves_singly(self, blends: Sequence[Blend]) -> bool:
        """Whether these blends are kept, so that they need not be solved from each other."""
        return self.kept is not None and all(blend in self.kept for blend in blends)
