# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of the command line: a progress bar, and a standard output that contains only the result."""

from __future__ import annotations

import ctypes
import os
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from types import TracebackType
from typing import TextIO, TypeVar

from .progress import Work, drained, watched

Result = TypeVar("Result")

_WIDTH = 30
# Interval between lines if the output is a file or a pipe.
_SECONDS_PER_LINE = 10.0


class ProgressBar:
    """A progress bar on standard error: redrawn in place on a terminal, otherwise printed now and then."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._start = self._last = time.monotonic()
        self._terminal = sys.stderr.isatty()

    def __enter__(self) -> ProgressBar:
        if not self._terminal:
            print(f"{self._title} …", file=sys.stderr, flush=True)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._terminal:
            print(file=sys.stderr)
        if error is None:
            print(f"{self._title}: done in {time.monotonic() - self._start:.0f} s", file=sys.stderr, flush=True)

    def show(self, fraction: float, message: str) -> None:
        """Show the finished share of the job, 0 to 1, and its current step."""
        now = time.monotonic()
        if self._terminal:
            filled = round(_WIDTH * fraction)
            bar = "#" * filled + "." * (_WIDTH - filled)
            line = f"{self._title} [{bar}] {fraction:4.0%}  {message}{self._left(fraction, now)}"
            width = shutil.get_terminal_size().columns - 1
            print("\r" + line[:width].ljust(width), end="", file=sys.stderr, flush=True)
        elif now - self._last > _SECONDS_PER_LINE:
            self._last = now
            print(f"{self._title} {fraction:4.0%}  {message}{self._left(fraction, now)}", file=sys.stderr, flush=True)

    def result_of(self, work: Work[Result]) -> Result:
        """Run the work with a progress bar and return its result."""
        return drained(self.shown(work))

    def shown(self, work: Work[Result]) -> Work[Result]:
        """Show the reports of some work while passing them on, and return its result."""
        return watched(work, lambda report: self.show(report.fraction, str(report.message)))

    def _left(self, fraction: float, now: float) -> str:
        """Estimate of the remaining time; empty while it is too early."""
        passed = now - self._start
        if fraction < 0.05 or passed < 2.0:
            return ""
        return f", {passed * (1.0 - fraction) / fraction:.0f} s left"


def open_streams() -> None:
    """Open the null device in place of standard streams that the caller has closed.

    Otherwise, the next files to be opened would take their place and receive what Blender prints.
    """
    # In the order of their numbers, because every file gets the lowest free one.
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115


@contextmanager
def own_stdout() -> Iterator[TextIO]:
    """Reserve standard output for the caller; anything that Blender prints to it is dropped.

    Blender's warnings and errors on standard error are not affected.
    """
    sys.stdout.flush()
    saved = os.dup(1)
    with open(os.devnull, "w", encoding="utf-8") as nowhere, os.fdopen(os.dup(saved), "w", encoding="utf-8") as answer:
        os.dup2(nowhere.fileno(), 1)
        try:
            # Operators print through Python, the rest of Blender through the C library.
            with redirect_stdout(nowhere):
                yield answer
        finally:
            # Drop what is still in the C library's buffer.
            ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None).fflush(None)
            os.dup2(saved, 1)
            os.close(saved)
