# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Access to the live morph that is running; there is at most one."""

from __future__ import annotations

from typing import Protocol

import bpy

from ...sentence import Sentence


class RunningLive(Protocol):
    """Interface of a live morph for panels, properties and operators; see :class:`.live_session.LiveSession`."""

    count: int
    names: list[str]
    objects: list[str]
    weights: tuple[float, ...]
    place: tuple[float, float]
    message: Sentence
    notices: list[Sentence]
    fraction: float

    def move_to(self, across: float, up: float) -> None:
        """Move the handle."""

    def kept_shape(self, patience: float) -> bpy.types.Object | None:
        """Create an object from the visible blend."""

    def tick(self) -> bool:
        """Advance the computation; return whether it continues."""

    def end(self) -> None:
        """Stop, and remove everything temporary."""


_RUNNING: list[RunningLive] = []


def running_live() -> RunningLive | None:
    """Return the running live morph."""
    return _RUNNING[-1] if _RUNNING else None


def set_running(session: RunningLive | None) -> None:
    """Set the running live morph; None when it has ended."""
    _RUNNING[:] = [] if session is None else [session]
