# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether every frame of a morph is clean: no pops, no flickering topology, detail at the ends, even triangles."""

from __future__ import annotations

from collections.abc import Sequence

from convwass_addon.applications.morphs.morph_settings import MorphSettings

from .coherence_pairs import CoherencePair
from .processes import measured

_HEADING = """
{frames} frames from one shape to the other, {cells} cells, default settings but for the motion: {motion}.

jumps      steps from a frame to the next whose largest distance is more than twice the mean of all
largest    the largest distance of a step over that mean
changes    of genus and of the number of pieces along the way, beyond the least possible
ends       mean distance from a shape to the frame beside it over the mean distance of the steps inside, the worse end
area lost  from a shape to the frame beside it, relative to the shapes' area interpolated, the worse end
detail     mean distance from a shape, moved as the motion moves it, to the frame beside it, in cells, the worse end
angle      first percentile of the smallest angles of a frame's triangles, degrees, the worst frame
crossing   share of triangles that cross others, the worst of every fourth frame
triangles  of a frame, the mean
"""
_COLUMNS = (
    f"{'':18} {'jumps':>5} {'largest':>7} {'changes':>7} {'ends':>5} {'area lost':>9} {'detail':>6} {'angle':>5} "
    f"{'crossing':>8} {'triangles':>9} {'CPU':>6} {'wall':>6}"
)
_GOALS = (
    ("jumps", "0", "{:.0f}"),
    ("changes", "0", "{:.0f}"),
    ("at_ends", "1.2", "{:.2f}"),
    ("lost_area", "0.01", "{:.3f}"),
    ("detail", "0.1 cells", "{:.2f}"),
    ("angle", "20 degrees at least", "{:.1f}"),
    ("wall", "10 s", "{:.1f}"),
)
"""Figure, what is to be reached, how it is written; a larger one is worse, but for the angle."""


_MOTIONS = (MorphSettings().motion, "transport")
"""The default, and the paper's."""


def print_clean_frames(pairs: Sequence[CoherencePair], cells: int, frames: int, meshes: str | None) -> None:
    """Bake pairs with default settings and by transport alone, and print what their frames are like.

    Parameters
    ----------
    pairs : sequence of CoherencePair
        Which.
    cells, frames : int
        Along the longest side, and of the morph.
    meshes : str or None
        A folder with further meshes.
    """
    for motion in _MOTIONS:
        _print_table(pairs, motion, cells, frames, meshes)


def _print_table(pairs: Sequence[CoherencePair], motion: str, cells: int, frames: int, meshes: str | None) -> None:
    """Print what the frames of pairs are like with one motion."""
    print(_HEADING.format(frames=frames, cells=cells, motion=motion))
    print(_COLUMNS)
    found = []
    for pair in pairs:
        options = {"pair": pair.name, "motion": motion, "cells": cells, "frames": frames, "meshes": meshes}
        figures = measured("benchmarks.coherence_cases", "passage", **options)
        print(line(pair.name, figures), flush=True)
        if "error" not in figures:
            found.append(figures)
    if not found:
        return
    print(f"\n{'worst of all pairs':18} {'to reach':>20} {'here':>10}")
    for figure, goal, written in _GOALS:
        worst = (min if figure == "angle" else max)(figures[figure] for figures in found)
        print(f"{figure.replace('_', ' '):18} {goal:>20} {written.format(worst):>10}")
    print(f"{'all jumps':18} {'0':>20} {sum(figures['jumps'] for figures in found):>10}")


def line(pair: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    if "error" in found:
        return f"{pair:18} {found['error']}"
    return (
        f"{pair:18} {found['jumps']:5} {found['largest']:7.2f} {found['changes']:7} {found['at_ends']:5.2f} "
        f"{100 * found['lost_area']:7.1f} % {found['detail']:6.2f} {found['angle']:5.1f} "
        f"{100 * found['crossing']:6.2f} % {found['triangles']:9} {found['cpu']:6.1f} {found['wall']:6.1f}"
    )
