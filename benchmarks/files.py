# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sizes of stored morphs, how long they take to open, and how fast they play, by output."""

from __future__ import annotations

import tempfile
from pathlib import Path

from .processes import measured

OUTPUTS = ("objects", "player, nearest blend", "player, interpolated", "alembic", "usd", "volume")
"""What a morph can be stored as."""

_CASES = "benchmarks.file_cases"

_HEADING = """
A morph of {frames} frames from horse to cow at {cells} cells, stored in a compressed .blend file and opened by another
process

.blend   MB of the .blend file
beside   MB of the files that it refers to
save     CPU s to create the output and save the file
open     CPU s to open the file and show its first frame
a frame  CPU ms to show the next frame, median; in parentheses frames per second
memory   MB that the process takes with the file open, beyond those of an empty Blender

{title:24} {blend:>7} {beside:>7} {save:>6} {open:>6} {frame:>14} {memory:>7}"""


def main(cells: int, frames: int) -> None:
    """Bake one morph, store it in every way and print a table.

    Parameters
    ----------
    cells : int
        Along the longest side.
    frames : int
        Of the path.
    """
    names = {"blend": ".blend", "beside": "beside", "save": "save", "open": "open", "frame": "a frame"}
    print(_HEADING.format(frames=frames, cells=cells, title="output", memory="memory", **names))
    empty = measured(_CASES, "empty")["memory"]
    with tempfile.TemporaryDirectory(prefix="convwass-files-") as folder:
        baked = str(Path(folder) / "baked.blend")
        measured(_CASES, "bake", cells=cells, frames=frames, target=baked)
        for output in OUTPUTS:
            stored = measured(_CASES, "store", baked=baked, output=output)
            played = measured(_CASES, "play", stored=stored["file"])
            frame = f"{played['frame']:.1f} ({1e3 / played['frame']:.0f})"
            sizes = f"{stored['blend']:7.1f} {stored['beside']:7.1f} {stored['save']:6.1f}"
            times = f"{played['open']:6.2f} {frame:>14} {played['memory'] - empty:7.0f}"
            print(f"{output:24} {sizes} {times}", flush=True)
