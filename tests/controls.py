# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Controls that stop long work at a given point, and recorders of its reports."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from convwass_addon.progress import Control, Progress, Work

Result = TypeVar("Result")


class CountingControl(Control):
    """Counts its checks, over all threads.

    Parameters
    ----------
    last : int, optional
        Number of the check that ends the work.
    """

    def __init__(self, last: int | None = None) -> None:
        super().__init__()
        self.count, self._last, self._lock = 0, last, threading.Lock()

    def check(self) -> None:
        with self._lock:
            self.count += 1
            if self.count == self._last:
                self.cancel()
        super().check()


class ConditionalControl(Control):
    """Ends the work at the first check where a condition holds."""

    def __init__(self, ends: Callable[[], object]) -> None:
        super().__init__()
        self._ends = ends

    def check(self) -> None:
        if self._ends():
            self.cancel()
        super().check()


def cancelled_control() -> Control:
    """Return a control that ends work at its first check."""
    control = Control()
    control.cancel()
    return control


@dataclass(frozen=True)
class Recorded(Generic[Result]):
    """The reports of long work, and its result."""

    reports: list[Progress[Any]]
    result: Result


def recorded(work: Work[Result]) -> Recorded[Result]:
    """Do the work; return all its reports and its result."""
    reports = []
    while True:
        try:
            reports.append(next(work))
        except StopIteration as end:
            return Recorded(reports, end.value)
