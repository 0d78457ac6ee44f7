# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep the most recent motions: computing one takes longer than solving many blends."""

from __future__ import annotations

import pickle
import threading
from collections import OrderedDict
from dataclasses import dataclass

from ...progress import Control, Work
from .choosing import chosen_motion
from .motion_choice import MotionChoice
from .motion_request import MotionRequest

# Motions of at most this size in all are kept. Those of horse to cow and chair to man have 11 and 26 MB.
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
        known = _Known(choice, _pickled_bytes(choice))
        with self._lock:
            self._known[key] = known
            while sum(each.bytes for each in self._known.values()) > _MOST_BYTES:
                self._known.popitem(last=False)
        return choice


@dataclass(frozen=True)
class _Known:
    """A motion, and its size."""

    choice: MotionChoice
    bytes: int


class _Counter:
    """Counts bytes that are written to it."""

    def __init__(self) -> None:
        self.count = 0

    def write(self, data: bytes | pickle.PickleBuffer) -> None:
        self.count += memoryview(data).nbytes


def _pickled_bytes(choice: MotionChoice) -> int:
    counter = _Counter()
    pickle.Pickler(counter, pickle.HIGHEST_PROTOCOL).dump(choice)
    return counter.count
