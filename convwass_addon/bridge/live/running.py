# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The live morph that is running, if any: there is one at a time."""

from __future__ import annotations

from typing import Protocol

import bpy

from ...sentence import Sentence


class RunningLive(Protocol):
    """What panels, properties and buttons need of a live morph; see :class:`.live_session.LiveSession`."""

    count: int
    names: list[str]
    objects: list[str]
    weights: tuple[float, ...]
    place: tuple[float, float]
    message: Sentence
    notices: list[Sentence]
    fraction: float

    def move_to(self, across: float, up: float) -> None:
        """Put the handle to a place."""

    def kept_shape(self, patience: float) -> bpy.types.Object | None:
        """Make an object of the blend that is shown."""

    def tick(self) -> bool:
        """Go on; return whether it does."""

    def end(self) -> None:
        """Stop, and leave no trace."""


_RUNNING: list[RunningLive] = []


def running_live() -> RunningLive | None:
    """Return the live morph that is running."""
    return _RUNNING[-1] if _RUNNING else None


def set_running(session: RunningLive | None) -> None:
    """Note which one is running; None where it has ended."""
    _RUNNING[:] = [] if session is None else [session]
