# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of frames: sharpness of textures, seams, difference from the input at the start, seconds per frame."""

from __future__ import annotations

from pathlib import Path

from .processes import measured

_CASES = "benchmarks.looks_cases"

_HEADING = """
A sphere becomes a cube, {cells} cells; each has a checkerboard of single pixels, 2048 x 2048

contrast   of close-ups in which a pixel of the texture is about 8 wide, relative to that of the input
seams      share of the surface on which the UV map is stretched or squeezed against its surroundings
"""
_TIMES = (0.25, 0.5, 0.75)
_START = """
An object with a normal map, procedural textures and three slots, turned and scaled: mean difference of displayed
colors, of 255, between it and the first frame, and the frame at 1/2000 of the way
"""
_SECONDS = """
CPU seconds per frame to transfer and write looks: whole materials with one UV map each, and colors only
"""


_ANIMALS = """
From spot to blub, {cells} cells: share of the surface on which the UV maps of both are stretched or squeezed against
their surroundings; seams are where the map between the animals is not
"""


def main(cells: int, meshes: Path | None = None) -> None:
    """Run all cases and print their figures.

    Parameters
    ----------
    cells : int
        Along the longest side.
    meshes : Path or None
        A folder with spot and blub, two textured animals of very different form; without it, this case is left out.
    """
    print(_HEADING.format(cells=cells))
    for motion in ("automatic", "transport"):
        found = measured(_CASES, "checker", cells=cells, motion=motion)
        print(f"{motion:12} {'t = .25':>10} {'.5':>8} {'.75':>8}")
        for name in ("sphere", "cube"):
            for figure in ("contrast", "seams"):
                row = "".join(f"{found[f'{name} {figure} {weight:g}']:9.1%}" for weight in _TIMES)
                print(f"{name + ' ' + figure:16}{row}", flush=True)
    if meshes is not None:
        print(_ANIMALS.format(cells=cells))
        for motion in ("automatic", "transport"):
            found = measured(_CASES, "animals", folder=str(meshes.absolute()), cells=cells, motion=motion)
            for name in ("spot", "blub"):
                shares = [(found[f"{name} all {t:g}"], found[f"{name} seams {t:g}"]) for t in _TIMES]
                row = ", ".join(f"{every:.2%} ({seams:.2%})" for every, seams in shares)
                print(f"{motion:12} {name}: all (seams) at t = .25, .5, .75: {row}", flush=True)
    print(_START)
    found = measured(_CASES, "start", cells=cells)
    print(f"first frame {found['end']:.2f}, next frame {found['next']:.2f} (goal: 2)", flush=True)
    print(_SECONDS)
    found = measured(_CASES, "seconds", cells=cells)
    print(f"{found['triangles']} triangles: {found['FADE']:.2f} s (goal: 0.3), colors only {found['COLORS']:.2f} s")
