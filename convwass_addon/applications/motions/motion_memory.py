# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep the most recent motions: computing one takes longer than solving many blends."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass

from ...progress import Control, Work
from .choosing import chosen_motion
from .motion_choice import MotionChoice
from .motion_request import MotionRequest

# Motions are kept for shapes with at most this many vertices in all: about 150 MB. The motions of horse to cow (5400
# vertices) and chair to man (8000) take 11 and 26 MB.
_MOST_VERTICES = 50_000


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
        with self._lock:
            self._known[key] = _Known(choice, sum(len(shape.vertices) for shape in request.shapes))
            while sum(known.vertices for known in self._known.values()) > _MOST_VERTICES:
                self._known.popitem(last=False)
        return choice


@dataclass(frozen=True)
class _Known:
    """A motion, and the number of vertices of its shapes."""

    choice: MotionChoice
    vertices: int
