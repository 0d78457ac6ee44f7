# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live morphs: blends per second while a handle is dragged, time to the first shape, and accuracy of mixed blends."""

from __future__ import annotations

from .processes import measured

_CASES = "benchmarks.live_cases"
_SHAPES = {2: ("horse", "bird"), 3: ("horse", "bird", "cow")}
# On finer grids than the first, the blend at the handle is solved on this many cells.
_FINE, _STAND_IN = 56, 48
# Three shapes, coarse lattices and the largest steps are only measured up to this resolution.
_LARGE = 64

_HEADING = """
Live morphs by plain transport, one thread

first      CPU s (and wall s) from the shapes as arrays to the first evaluated mesh
before     CPU ms from weights to the evaluated mesh before the lattice is filled: the blend is solved (above {fine}
           cells on {stand_in} cells); 10th percentile, median, in parentheses blends per second for the median
fill       CPU s until the lattice is complete
blends, MB in the lattice, and their memory
draw       CPU ms from weights to the evaluated mesh, in the same format
distance   between the mixed and the solved surface (to 0.1 %), in cells: mean and worst of 9 blends
volume     error in percent: mean and worst
"""

_JUMPS = """
Largest step, in cells, between two shapes shown 1/30 s apart while the handle moves by 1/4 per second
"""


def main(resolutions: list[int]) -> None:
    """Run all cases and print two tables.

    Parameters
    ----------
    resolutions : list of int
        Cells along the longest side.
    """
    print(_HEADING.format(fine=_FINE, stand_in=_STAND_IN))
    print(
        f"{'cells':>5} {'shapes':>6} {'steps':>5} {'first':>13} {'before':>17} {'fill':>6} {'blends':>6} {'MB':>6} "
        f"{'draw':>19} {'distance':>12} {'volume':>11}"
    )
    for cells in resolutions:
        for names in _shapes_at(cells):
            solved = cells if cells <= _FINE else _STAND_IN
            before = measured(_CASES, "hand", names=names, cells=cells, solved=solved)
            for steps in (0,) if cells > _LARGE else (8, 0):
                found = measured(_CASES, "lattice", names=names, cells=cells, steps=steps)
                _print_row(cells, len(names), steps, before, found)
    print(_JUMPS)
    print(f"{'cells':>5} {'shapes':>6} {'before the lattice':>18} {'while it is filled':>18} {'after':>6}")
    for cells in [own for own in resolutions if own <= _LARGE]:
        for names in _shapes_at(cells):
            found = measured(_CASES, "jumps", names=names, cells=cells)
            stages = f"{found['solving']:18.3f} {found['filling']:18.3f} {found['filled']:6.3f}"
            print(f"{cells:5} {len(names):6} {stages}", flush=True)


def _shapes_at(cells: int) -> list[tuple[str, ...]]:
    """Return the shapes to blend at a resolution: on fine grids only two, since three take minutes."""
    return [names for count, names in _SHAPES.items() if count == 2 or cells <= _LARGE]


def _print_row(cells: int, shapes: int, steps: int, before: dict[str, object], found: dict[str, object]) -> None:
    first = f"{found['first']:.2f} ({found['first_wall']:.2f})"
    solved, draw = _times(before), _times(found)
    distance = f"{found['distance']:.3f} {found['distance_worst']:.3f}"
    volume = f"{100 * found['volume']:.2f} {100 * found['volume_worst']:.2f}"
    print(
        f"{cells:5} {shapes:6} {steps or '16+':>5} {first:>13} {solved:>17} {found['fill']:6.1f} {found['blends']:6} "
        f"{found['megabytes']:6.1f} {draw:>19} {distance:>12} {volume:>11}",
        flush=True,
    )


def _times(found: dict[str, object]) -> str:
    return f"{found['draw_best']:.1f} {found['draw']:.1f} ({1e3 / found['draw']:.0f})"
