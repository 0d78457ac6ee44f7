# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Record the problems of morphs whose inputs move, to measure what their motions leave to transport."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from convwass_addon.applications.morphs.moving_problem import MovingProblem


@contextmanager
def recorded_problems() -> Iterator[list[MovingProblem]]:
    """Record the problems of all morphs that are made in the body and have a motion."""
    recorded: list[MovingProblem] = []
    original = MovingProblem.__dict__["of"]

    def recording(_kind: type, *parts: object, **named: object) -> MovingProblem:
        recorded.append(original.__func__(MovingProblem, *parts, **named))
        return recorded[-1]

    MovingProblem.of = classmethod(recording)
    try:
        yield recorded
    finally:
        MovingProblem.of = original
