# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Signals that end a command: Ctrl+C, SIGTERM and SIGHUP."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import NoReturn

# Windows has no SIGHUP.
_ENDING = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]


class Ended(KeyboardInterrupt):
    """The system asks the command to end, by the signal `number`."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


@contextmanager
def heeded_signals() -> Iterator[None]:
    """Let signals of the system end the work as Ctrl+C does, with an exception.

    Signals that are ignored, as after ``nohup``, or that Blender handles, are left alone.

    Raises
    ------
    Ended
        Such a signal came.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    with ExitStack() as restored:
        for number in _ENDING:
            if signal.getsignal(number) is signal.SIG_DFL:
                restored.callback(signal.signal, number, signal.signal(number, _end))
        yield


def _end(number: int, _: FrameType | None) -> NoReturn:
    raise Ended(number)
