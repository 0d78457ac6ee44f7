# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep the most recent motions: computing one takes longer than solving many blends."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ...progress import Control, Work
from .choosing import chosen_motion
from .motion_choice import MotionChoice
from .motion_request import MotionRequest

# Motions whose arrays have at most this size in all are kept. Those of horse to cow and chair to man have 23 and 31 MB.
_MOST_BYTES = 150_000_000


class MotionMemory:
    """Computes motions, or returns them if they are among the most recent ones; thread-safe.

    A motion depends only on the request, so a stored one is the same as a new one.
    """

    def __init__(self) -> None:
        self._known: OrderedDict[bytes, _Known] = OrderedDict()
        self._lock = threading.Lock()

    def chosen(self, request: MotionRequest, control: Control) -> Work[MotionChoice]:
        """Return the motion of a morph; errors as for :func:`.choosing.chosen_motion`."""
        if request.kind == "transport":
            return (yield from chosen_motion(request, control))
        key = request.digest()
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key].choice
        choice = yield from chosen_motion(request, control)
        known = _Known(choice, _array_bytes(choice, set()))
        with self._lock:
            self._known[key] = known
            while sum(each.bytes for each in self._known.values()) > _MOST_BYTES:
                self._known.popitem(last=False)
        return choice


@dataclass(frozen=True)
class _Known:
    """A motion, and the size of its arrays."""

    choice: MotionChoice
    bytes: int


def _array_bytes(value: object, counted: set[int]) -> int:
    """Return the size of all arrays that a value holds, except for those already counted, by their ids."""
    if id(value) in counted or isinstance(value, type):
        return 0
    counted.add(id(value))
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, Mapping):
        held: Iterable[object] = value.values()
    else:
        held = value if isinstance(value, tuple | list) else getattr(value, "__dict__", {}).values()
    return sum(_array_bytes(each, counted) for each in held)
