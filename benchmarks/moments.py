# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments of players: distance and volume of what they show between two baked blends, against blends left out."""

from __future__ import annotations

from .processes import measured

_CASES = "benchmarks.moments_cases"
# Pairs with their resolution, and the steps of 24 that are kept.
_PAIRS = (("horse to cow", 64, 1), ("man raises arm", 64, 1), ("chair to man", 64, 1), ("ball to knot", 48, 1))

_HEADING = """
Players between baked blends: of 25, every other one is left out and compared

distance   between the surfaces, in cells of the fields: mean and worst moment; mixed fields, laid onto the baked
           meshes (Detail), the nearest baked blend
volume     error in percent: mean and worst
ms         for a moment, mixed and laid
"""


def main() -> None:
    """Run all pairs and print a table."""
    print(_HEADING)
    columns = ("mixed", "laid", "nearest")
    print(
        f"{'pair':18} {'cells':>5} {'motion':>10} " + " ".join(f"{name + ' distance, volume':>27}" for name in columns)
    )
    for pair, cells, kept in _PAIRS:
        motion = "transport" if pair == "ball to knot" else "automatic"
        found = measured(_CASES, "between", pair=pair, cells=cells, motion=motion, kept=kept)
        figures = []
        for name in columns:
            (mean, worst), (off, most) = found[f"{name} distance"], found[f"{name} volume"]
            figures.append(f"{f'{mean:.3f} {worst:.3f}  {100 * off:.2f} {100 * most:.2f}':>27}")
        times = f"{found['mixed ms']:.0f} {found['laid ms']:.0f} ms"
        print(f"{pair:18} {cells:5} {motion:>10} " + " ".join(figures) + f"  {times}", flush=True)
