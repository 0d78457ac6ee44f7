# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep the most recent motions: computing one takes longer than solving many blends."""

from __future__ import annotations

import hashlib
import json
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass

from ...geometry.mesh import TriangleMesh
from ...progress import Control, Work
from .choosing import MotionChoice, chosen_motion
from .guides import Guide

# Motions are kept for shapes with at most this many vertices in all: about 150 MB. The motions of horse to cow (5400
# vertices) and chair to man (8000) take 11 and 26 MB.
_MOST_VERTICES = 50_000


class MotionMemory:
    """Computes motions, or returns them if they are among the most recent ones; thread-safe.

    A motion depends only on the arguments of :meth:`chosen`, so a stored one is the same as a new one.
    """

    def __init__(self) -> None:
        self._known: OrderedDict[bytes, _Known] = OrderedDict()
        self._lock = threading.Lock()

    def chosen(
        self,
        shapes: Sequence[TriangleMesh],
        names: Sequence[str],
        pairs: Sequence[tuple[int, int]],
        asked: str,
        coherence: float,
        guides: Sequence[Guide],
        control: Control,
    ) -> Work[MotionChoice]:
        """Return the motion of a morph; parameters and errors as for :func:`.choosing.chosen_motion`."""
        if asked == "transport":
            return (yield from chosen_motion(shapes, names, pairs, asked, coherence, guides, control))
        key = _digest(shapes, names, pairs, asked, coherence, guides)
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key].choice
        choice = yield from chosen_motion(shapes, names, pairs, asked, coherence, guides, control)
        with self._lock:
            self._known[key] = _Known(choice, sum(len(shape.vertices) for shape in shapes))
            while sum(known.vertices for known in self._known.values()) > _MOST_VERTICES:
                self._known.popitem(last=False)
        return choice


@dataclass(frozen=True)
class _Known:
    """A motion, and the number of vertices of its shapes."""

    choice: MotionChoice
    vertices: int


def _digest(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    asked: str,
    coherence: float,
    guides: Sequence[Guide],
) -> bytes:
    """Return a hash of everything that a motion depends on."""
    sizes = [[len(shape.vertices), len(shape.faces)] for shape in shapes]
    entries = [sorted(guide.items()) for guide in guides]
    about = [list(names), list(pairs), asked, coherence, entries, sizes]
    hashed = hashlib.sha256(json.dumps(about).encode())
    for shape in shapes:
        hashed.update(shape.vertices.astype("<f8").tobytes())
        hashed.update(shape.faces.astype("<i8").tobytes())
    return hashed.digest()
