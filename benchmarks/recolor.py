# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How close recolored photographs come to a palette, how much noise this adds, and how long it takes."""

from __future__ import annotations

from .processes import measured

_CASES, _LARGE_CASES = "benchmarks.recolor_cases", "benchmarks.recolor_large"
PAIRS = (("coffee", "rocket"), ("rocket", "coffee"), ("chelsea", "astronaut"))

_TITLE = """
Photographs from scikit-image (synthetic pictures if missing) that take each other's palette at strength 1.

left      sliced Wasserstein distance W2 in Lab to the palette, for 8-bit screen colors
growth    how much small differences between neighbors grow (95th percentile): noise, contours, halos
seconds   CPU seconds of one thread, including measuring and solving
          ours        L by quantiles, ab by convolutional transport, with various smoothing
          linear      linear Monge-Kantorovich
          sliced      quantiles along 30 random rotations of Lab, as by Pitie et al.
          histograms  red, green and blue, by scikit-image
          samples     POT's domain adaptation from 1000 samples each
"""
_LARGE = """
An enlarged photograph with grain, 3840 x 2160 pixels of {colors} colors; measuring and solving take {solve:.2f} CPU s.
CPU s / wall s from arrays to arrays, and peak MB in addition to the picture, including the result.
"""
_EDITOR = """
The same in Blender by the operator, 8 bits: read, measured, solved, applied, written.
"""


def main() -> None:
    """Run all cases and print the tables."""
    print(_TITLE)
    found = {pair: measured(_CASES, "pair", source=pair[0], target=pair[1]) for pair in PAIRS}
    print(f"{'':24}" + "".join(f"{f'{source} -> {target}':>28}" for source, target in PAIRS))
    print(f"{'':24}" + f"{'left growth seconds':>28}" * len(PAIRS))
    print(f"{'before':24}" + "".join(f"{found[pair]['before']:14.1f}{'':14}" for pair in PAIRS))
    for way in [name for name in found[PAIRS[0]] if name != "before"]:
        rows = [found[pair][way] for pair in PAIRS]
        print(f"{way:24}" + "".join(f"{own['left']:14.1f} {own['growth']:6.1f} {own['seconds']:6.2f}" for own in rows))
    _print_large(*PAIRS[0])
    print("error of tables in levels of 255, mean / 99 % / worst:")
    for size in (17, 33, 65):
        errors = [measured(_CASES, "table_error", source=a, target=b, size=size) for a, b in PAIRS]
        print(f"{size:4}" + "".join(f"{own['mean']:10.2f} /{own['most']:5.1f} /{own['worst']:5.1f}" for own in errors))


def _print_large(source: str, target: str) -> None:
    """Print the cost for a film frame."""
    rows = [
        (kind, workers, measured(_LARGE_CASES, "arrays", source=source, target=target, kind=kind, workers=workers))
        for kind in ("bytes", "floats")
        for workers in (1, 2)
    ]
    print(_LARGE.format(**rows[0][2]))
    print(f"{'':24}{'exactly':>16}{'by a table of 65':>20}{'MB':>8}")
    for kind, workers, own in rows:
        name = f"{kind}, {workers} thread{'s' if workers > 1 else ''}"
        times = "".join(f"{own[way]['cpu']:13.2f} / {own[way]['wall']:.2f}" for way in ("exact", "table"))
        print(f"{name:20}{times}{own['more']:10.0f}")
    print(_EDITOR)
    for output, name in (("REPLACE", "replaced"), ("NEW", "new, and packed")):
        own = measured(_LARGE_CASES, "editor", source=source, target=target, output=output)
        print(f"{name:20}{own['cpu']:13.2f} / {own['wall']:.2f}{own['more']:27.0f}")
    print()
