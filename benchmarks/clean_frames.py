# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether every frame of a morph is clean: no pops, stable topology, detail at the ends, well-shaped triangles."""

from __future__ import annotations

from collections.abc import Sequence

from convwass_addon.applications.morphs.morph_settings import MorphSettings

from .coherence_pairs import CoherencePair
from .processes import measured

_HEADING = """
{frames} frames from one shape to the other, {cells} cells, default settings except the motion: {motion}.

jumps      steps between frames whose largest distance is more than twice the mean distance of all steps
largest    the largest distance of a step, divided by that mean
changes    of genus and of the number of components along the path, beyond the minimum possible
ends       mean distance from a shape to its adjacent frame over that of the inner steps, worse end
area lost  from a shape, moved by the motion and offset to the volume of its adjacent frame, to that frame, worse end
detail     mean distance between these two, in cells, worse end
angle      first percentile of the smallest angles of a frame's triangles, degrees, worst frame
crossing   fraction of triangles that cross others, worst of every fourth frame
triangles  of a frame, mean
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
"""Figure, goal, format; larger is worse, except for the angle."""


_MOTIONS = (MorphSettings().motion, "transport")
"""The default motion, and that of the paper."""


def print_clean_frames(pairs: Sequence[CoherencePair], cells: int, frames: int, meshes: str | None) -> None:
    """Bake pairs with default settings and by transport alone, and print the quality of their frames.

    Parameters
    ----------
    pairs : sequence of CoherencePair
        The pairs to bake.
    cells, frames : int
        Cells along the longest side, and frames of the morph.
    meshes : str or None
        A folder with additional meshes.
    """
    for motion in _MOTIONS:
        _print_table(pairs, motion, cells, frames, meshes)


def _print_table(pairs: Sequence[CoherencePair], motion: str, cells: int, frames: int, meshes: str | None) -> None:
    """Print the frame quality of pairs for one motion."""
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
    print(f"\n{'worst pair':18} {'goal':>20} {'here':>10}")
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
