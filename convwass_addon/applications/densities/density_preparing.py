# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Preparations of solves on large surfaces, in steps with progress reports."""

from __future__ import annotations

import time

from ...progress import Progress, Work
from ...sentence import Sentence
from ...transport import Surface

LARGE = 100_000
"""Number of vertices from which on preparations are reported: below it they take up to 6.5 CPU seconds
(docs/performance, "Meshes")."""

DRAWN_SECONDS = 0.2
"""Time for the window to redraw before it blocks; chosen: a few of its frames."""


def preparing(surface: Surface) -> Work[None]:
    """Factorize the heat equation of a large surface: 20 s for a million vertices, which cannot be interrupted."""
    if surface.shape[0] >= LARGE:
        yield Progress(0.0, Sentence("Preparing the flow of heat; this takes a while and cannot be interrupted"))
        # Factorization blocks the window, so let it show the message first.
        time.sleep(DRAWN_SECONDS)
        surface.factorize()


def preparing_levels(surface: Surface) -> Work[None]:
    """Like :func:`preparing`, and build the coarser surfaces on which solves of large surfaces start."""
    yield from preparing(surface)
    if surface.shape[0] < LARGE:
        return
    count, done, level = surface.levels_below, 0, surface
    while level is not None:
        level.factorize()
        done += 1
        if done <= count:
            yield Progress(0.0, Sentence("Coarsening the surface, {done} of {count}", {"done": done, "count": count}))
        level = level.coarser()
