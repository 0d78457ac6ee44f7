# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all kinds of morphs have in common, whether their inputs rest, move or follow an animation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from ...progress import UNINTERRUPTED, Control
from .blending import HandOver
from .demands import Demand
from .layouts import Blend
from .morph_problem import MorphFrame
from .spare_threads import at_once
from .volumes import Lattice


class BlendProblem(Protocol):
    """The problem shared by all blends of a morph; can be sent to another process.

    It is a :class:`.RestingProblem`, a :class:`.MovingProblem` or a :class:`.FollowingProblem`.
    """

    @property
    def lattice(self) -> Lattice:
        """A grid that holds all blends."""
        ...

    def effort(self, blend: Blend) -> float:
        """Estimate the relative time that a blend takes."""
        ...

    def frames(
        self, run: Sequence[Blend], control: Control = UNINTERRUPTED, hand_over: HandOver = at_once
    ) -> list[MorphFrame]:
        """Solve a run of blends; parameters as for :func:`.blending.solve_blends`."""
        ...

    def frames_again(
        self, run: Sequence[Blend], asked: Mapping[Blend, Demand], control: Control = UNINTERRUPTED
    ) -> list[MorphFrame]:
        """Compute some blends of a run again, with a demand on each, from the same barycenters, in order.

        The connectivity of the inputs is not needed.
        """
        ...

    def solves_singly(self, blends: Sequence[Blend]) -> bool:
        """Whether these blends can be computed again without others of their run."""
        ...
