# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether morphs are coherent: limbs swing and shapes stay in one piece. Compares every motion with plain transport."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from .coherence_cases import TRANSPORT, motions
from .coherence_guides import print_guides
from .coherence_maps import print_maps
from .coherence_pairs import ONE_BUILD, OTHER_BUILD, CoherencePair, half, pairs_named
from .coherence_poses import print_poses
from .coherence_sheets import write_sheets
from .coherence_turned import print_turned
from .processes import PROJECT, measured

FRAMES_FOLDER = PROJECT / "out" / "coherence"
"""Folder where the benchmark keeps frames for the picture sheets."""

_HEADING = """
{frames} frames from one shape to the other, {cells} cells, default settings except the motion. {half}

pieces     largest number of connected components of a frame before mending; torn is the fraction of frames that have
           more components than either shape
area       smallest and largest area of a frame over the interpolated area of the shapes
reach      smallest radius that holds 95 % of a frame's volume over the interpolated radius of the shapes
volume     largest error of a frame's volume
jump       largest distance between consecutive frames over the mean of the steps' largest distances
left       largest W2 that remains for transport over the W2 of the shapes
length     largest error of the length of the swinging limb
tip        largest distance of its tip from the expected position, over the diagonal
CPU, wall  seconds from the meshes of the shapes to the meshes of all frames
"""
_COLUMNS = (
    f"{'':18} {'motion':10} {'pieces':>6} {'torn':>5} {'area':>11} {'reach':>5} {'volume':>7} {'jump':>5} {'left':>5} "
    f"{'length':>6} {'tip':>6} {'CPU':>7} {'wall':>6}"
)


def main(
    pairs: Sequence[str] | None,
    motions: Sequence[str] | None,
    resolution: int,
    frames: int,
    *,
    held_back: bool = False,
    meshes: Path | None = None,
    as_json: bool = False,
    sheets: Path | None = None,
    maps: bool = False,
    guides: bool = False,
    poses: bool = False,
) -> None:
    """Bake the pairs with every motion and print the tables.

    Parameters
    ----------
    pairs : sequence of str or None
        Names of pairs; by default all of one half.
    motions : sequence of str or None
        Motions; by default all that the settings offer.
    resolution, frames : int
        Cells along the longest side, and frames of the morph.
    held_back : bool
        Take the half of the pairs that no parameter was tuned on.
    meshes : Path or None
        A folder with additional meshes.
    as_json : bool
        Print one line of JSON per pair and motion instead.
    sheets : Path or None
        A folder to write one picture per pair to, with a row of frames for every motion.
    maps : bool
        Measure only how well the shapes are mapped to each other.
    guides : bool
        Measure only how guides change these maps.
    poses : bool
        Measure only how people in many poses are mapped to each other.
    """
    if poses:
        print_poses()
        return
    chosen = list(half(meshes, tuned=not held_back)) if pairs is None else _named(pairs, meshes)
    folder = None if meshes is None else str(meshes.absolute())
    if maps:
        print_maps(chosen, folder)
        return
    if guides:
        print_guides(chosen, folder)
        print_turned(chosen, folder)
        return
    ways = _offered(motions)
    if not as_json:
        print(_HEADING.format(frames=frames, cells=resolution, half="Pairs held back." if held_back else ""))
        print(_COLUMNS)
    found: dict[tuple[str, str], dict[str, object]] = {}
    for pair in chosen:
        for way in ways:
            figures = measured(
                "benchmarks.coherence_cases",
                "passage",
                pair=pair.name,
                motion=way,
                cells=resolution,
                frames=frames,
                meshes=folder,
                keep=str(kept_frames(pair.name, way)),
            )
            found[pair.name, way] = figures
            shown = {"cells": resolution, **figures, "pair": pair.name, "build": pair.build, "way": way}
            print(json.dumps(shown) if as_json else line(pair.name, way, figures), flush=True)
    if not as_json:
        _print_summary(chosen, ways, found)
    if sheets is not None:
        write_sheets({pair.name: {way: kept_frames(pair.name, way) for way in ways} for pair in chosen}, sheets)


def kept_frames(pair: str, way: str) -> Path:
    """Return the path where the frames of a pair and a motion are kept."""
    return FRAMES_FOLDER / f"{pair.replace(' ', '_')}-{way}.npz"


def _named(names: Sequence[str], meshes: Path | None) -> list[CoherencePair]:
    try:
        return pairs_named(names, meshes)
    except ValueError as error:
        sys.exit(f"benchmark coherence: {error}")


def _offered(ways: Sequence[str] | None) -> list[str]:
    """Return the motions to try, plain transport first, without those that the settings do not offer."""
    offered = sorted(motions(), key=lambda way: way != TRANSPORT)
    if ways is None:
        return offered
    for way in ways:
        if way not in offered:
            print(f"There is no motion {way}; there are: {', '.join(offered)}.", file=sys.stderr)
    return [way for way in ways if way in offered]


def line(pair: str, way: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    if "error" in found:
        return f"{pair:18} {way:10} {found['error']}"
    low, high = found["area"]
    left = "" if found["residual"] is None else f"{found['residual']:.2f}"
    length, tip = ("", "") if found["limb"] is None else (_percent(found["limb"][key]) for key in ("length", "tip"))
    return (
        f"{pair:18} {way:10} {found['pieces']:6} {found['torn']:5.2f} {low:5.2f} {high:5.2f} {found['reach']:5.2f} "
        f"{100 * found['volume']:5.2f} % {found['largest']:5.2f} {left:>5} {length:>6} {tip:>6} {found['cpu']:7.1f} "
        f"{found['wall']:6.1f}"
    )


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


_GOALS = (
    ("fraction of torn frames, worst pair", ONE_BUILD, "0", lambda f: f["torn"], "{:.2f}"),
    ("error of the limb's length", ONE_BUILD, "3 %", lambda f: f["limb"] and 100 * f["limb"]["length"], "{:.1f} %"),
    ("distance of the limb's tip", ONE_BUILD, "2 %", lambda f: f["limb"] and 100 * f["limb"]["tip"], "{:.1f} %"),
    ("remaining W2 over that of the shapes", ONE_BUILD, "0.1", lambda f: f["residual"], "{:.2f}"),
    ("remaining W2 over that of the shapes", OTHER_BUILD, "0.3", lambda f: f["residual"], "{:.2f}"),
    ("largest area", OTHER_BUILD, "1.05", lambda f: f["area"][1], "{:.2f}"),
    ("least area", OTHER_BUILD, "0.93", lambda f: -f["area"][0], "{:.2f}"),
    ("fraction of torn frames, worst pair", OTHER_BUILD, "0.1", lambda f: f["torn"], "{:.2f}"),
    ("least reach", OTHER_BUILD, "0.85", lambda f: -f["reach"], "{:.2f}"),
    ("error of the volume", None, "0.2 %", lambda f: 100 * f["volume"], "{:.2f} %"),
    ("largest jump over the mean jump", None, "1.5", lambda f: f["largest"], "{:.2f}"),
    ("seconds, wall", None, "12 guided, 20 warp", lambda f: f["wall"], "{:.1f}"),
)
# Title, pairs (one or another build), goal, figure (larger is worse), format.


def _print_summary(
    pairs: Sequence[CoherencePair], ways: Sequence[str], found: dict[tuple[str, str], dict[str, object]]
) -> None:
    """Print the worst figure of all pairs next to its goal."""
    print(f"\n{'worst pair':44} {'pairs':12} {'goal':>18} " + " ".join(f"{way:>10}" for way in ways))
    for title, build, goal, figure, written in _GOALS:
        names = [pair.name for pair in pairs if build in (None, pair.build)]
        cells = []
        for way in ways:
            values = [figure(found[name, way]) for name in names if "error" not in found[name, way]]
            known = [value for value in values if value is not None]
            cells.append(written.format(abs(max(known))) if known else "")
        if any(cells):
            print(f"{title:44} {build or 'all':12} {goal:>18} " + " ".join(f"{cell:>10}" for cell in cells))
