# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Record the motions that morphs use, to measure what they leave to transport."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.motions.motion import Motion


@contextmanager
def recorded_motions() -> Iterator[list[Motion]]:
    """Record the motions of all morphs made in the body, as they are baked: growing evenly, and on their floor."""
    recorded: list[Motion] = []
    original = MovingProblem.__dict__["of"]

    def recording(_kind: type, *parts: object, **named: object) -> MovingProblem:
        problem = original.__func__(MovingProblem, *parts, **named)
        recorded.append(problem.motion)
        return problem

    MovingProblem.of = classmethod(recording)
    try:
        yield recorded
    finally:
        MovingProblem.of = original
