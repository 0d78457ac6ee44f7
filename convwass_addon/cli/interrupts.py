# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Signals that end a command: Ctrl+C, SIGTERM and SIGHUP."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import NoReturn

from ..bridge.interrupts import INTERRUPTS

# Seconds after which users wonder whether their interrupt was noticed.
_PATIENCE = 1.0


class Ended(KeyboardInterrupt):
    """The system asks the command to end, by the signal `number`."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


@contextmanager
def heeded_signals() -> Iterator[None]:
    """Let signals of the system end the work as Ctrl+C does, with an exception, and answer them if that takes long.

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
        for number in INTERRUPTS:
            # Python raises KeyboardInterrupt for SIGINT.
            if signal.getsignal(number) is signal.SIG_DFL and number != signal.SIGINT:
                restored.callback(signal.signal, number, signal.signal(number, _end))
        restored.enter_context(_answered())
        yield


def _end(number: int, _: FrameType | None) -> NoReturn:
    raise Ended(number)


@contextmanager
def _answered() -> Iterator[None]:
    """Answer an interrupt that has not ended the context after a while, from a thread.

    Python hands signals to functions between two of its own instructions only, so not while Blender renders.
    """
    inner, outer = os.pipe()
    if hasattr(os, "set_blocking"):  # Windows needs it, and has it, from Python 3.12 on
        os.set_blocking(outer, False)
    before = signal.set_wakeup_fd(outer, warn_on_full_buffer=False)
    ended = threading.Event()
    answering = threading.Thread(target=_answer, args=(inner, ended), daemon=True)
    answering.start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)
        ended.set()
        os.close(outer)
        answering.join()
        os.close(inner)


def _answer(inner: int, ended: threading.Event) -> None:
    """Answer the first interrupt, whose number arrives at a pipe, unless the work ends soon."""
    while number := os.read(inner, 1):
        if number[0] in INTERRUPTS:
            break
    if not ended.wait(_PATIENCE):
        said = "convwass: interrupted; the current step, such as the rendering of a picture, is finished first"
        print(said, file=sys.stderr, flush=True)
