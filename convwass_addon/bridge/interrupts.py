# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep interrupts, such as Ctrl+C, that come while Blender works: its operators turn them into errors, or lose them."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType

_Handler = Callable[[int, FrameType | None], object]

# Windows has no SIGHUP.
INTERRUPTS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that end a command: Ctrl+C, and those with which the system asks it to end."""


@contextmanager
def kept_interrupts() -> Iterator[None]:
    """Let interrupts stop an operator that is written in Python, and raise them again after it.

    Blender makes a RuntimeError of an interrupt in such an operator, which may also ignore it.
    """
    came: list[int] = []

    def keep(number: int, frame: FrameType | None) -> None:
        came.append(number)
        handlers[number](number, frame)

    handlers = _python_handlers()
    with _replaced(handlers, keep):
        try:
            yield
        finally:
            _raise_first(came, handlers)


@contextmanager
def delayed_interrupts() -> Iterator[None]:
    """Raise interrupts only at the end of the context.

    A renderer prints an interrupt in its own Python code, and goes on.
    """
    came: list[int] = []
    handlers = _python_handlers()
    with _replaced(handlers, lambda number, _: came.append(number)):
        try:
            yield
        finally:
            _raise_first(came, handlers)


def _python_handlers() -> dict[int, _Handler]:
    """Return the signals for which there are functions; those of Blender itself do not raise exceptions."""
    found = {number: signal.getsignal(number) for number in INTERRUPTS}
    return {number: handler for number, handler in found.items() if callable(handler)}


@contextmanager
def _replaced(handlers: Mapping[int, _Handler], handle: _Handler) -> Iterator[None]:
    """Replace the functions for some signals; only the main thread can, and is interrupted."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    for number in handlers:
        signal.signal(number, handle)
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)


def _raise_first(came: list[int], handlers: Mapping[int, _Handler]) -> None:
    """Hand the first of some signals to the function for it, if there are any."""
    for number in came[:1]:
        handlers[number](number, None)
