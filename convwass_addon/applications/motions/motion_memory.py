# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep the most recent motions: computing one takes longer than solving many blends."""

from __future__ import annotations

import hashlib
import json
import threading
from collections import OrderedDict
from collections.abc import Sequence

from ...geometry.mesh import TriangleMesh
from ...progress import Control, Work
from .choosing import MotionChoice, chosen_motion
from .guides import Guide

# A motion of two shapes of 10 000 vertices takes about 20 MB.
_KEPT = 2


class MotionMemory:
    """Computes motions, or returns them if they are among the most recent ones; thread-safe.

    A motion depends only on the arguments of :meth:`chosen`, so a stored one is the same as a new one.
    """

    def __init__(self) -> None:
        self._known: OrderedDict[bytes, MotionChoice] = OrderedDict()
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
                return self._known[key]
        choice = yield from chosen_motion(shapes, names, pairs, asked, coherence, guides, control)
        with self._lock:
            self._known[key] = choice
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
        return choice


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
