# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What solves on a large surface need before their first round, made step by step, and told."""

from __future__ import annotations

import time

from ...progress import Progress, Work
from ...sentence import Sentence
from ...transport import Surface

LARGE = 100_000
"""Vertices from which on a surface is prepared in steps that are told: a smaller one takes up to 6.5 CPU seconds
(docs/performance.md, "Meshes")."""

DRAWN_SECONDS = 0.2
"""How long the window gets to draw that it will not answer; chosen: a few of its frames."""


def preparing(surface: Surface) -> Work[None]:
    """Factorize the equations of heat of a large surface: 20 s for a million vertices, which nothing can cut short."""
    if surface.shape[0] >= LARGE:
        yield Progress(0.0, Sentence("Preparing the flow of heat; this takes a while and cannot be interrupted"))
        # Nothing is drawn while the library is at it: let the window say so first.
        time.sleep(DRAWN_SECONDS)
        surface.factorize()


def preparing_levels(surface: Surface) -> Work[None]:
    """Do the same, and make the coarser surfaces from which densities of a large one are solved."""
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
