# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of a morph by stage, and of single barycenters."""

from __future__ import annotations

from .processes import measured

_CASES = "benchmarks.cases"
SINGLE = (
    ("plain, blur N / 40", {"blur": None, "sharpness": 0.0}),
    ("sharpness 0.75, blur 1 cell", {"blur": 1.0, "sharpness": 0.75}),
    ("debiased, blur 1 cell", {"blur": 1.0, "sharpness": 1.0}),
)

# On finer grids, mass that moves farther than 36 blurs is blurred line by line in the log domain, for hours.
_FINEST = 128

_SINGLE = """One cold barycenter, horse and bird, t = 0.5, to 1 % marginal error

peak MB     largest resident memory of the process; Blender itself takes about 300 of it
bytes/cell  NumPy's peak memory over the cells of the grid: shapes, inputs and barycenter (tracemalloc)

With a blur of one cell, up to {finest} cells.
"""

_PATH = """
A morph from horse to bird, {frames} frames, from meshes to .blend, CPU s by stage

solve wall  wall s from the start of the first solve to the end of the last one
"""


def main(resolutions: list[int], frames: int) -> None:
    """Run all cases and print two tables.

    Parameters
    ----------
    resolutions : list of int
        Cells along the longest side.
    frames : int
        Number of frames of the morph.
    """
    print(_SINGLE.format(finest=_FINEST))
    print(
        f"{'cells':>6}  {'case':30} {'CPU s':>7} {'iterations':>16} {'error':>7} {'numerics':>20} {'peak MB':>8} "
        f"{'bytes/cell':>10}"
    )
    for cells in resolutions:
        for name, case in SINGLE:
            if case["blur"] is not None and cells > _FINEST:
                continue
            found = measured(_CASES, "single", cells=cells, **case)
            print(
                f"{cells:6}  {name:30} {found['cpu']:7.2f} {found['iterations']!s:>16} {found['error']:7.4f} "
                f"{found['numerics']:>20} {found['peak']:8.0f} {found['bytes_per_cell']:10.0f}",
                flush=True,
            )
    print(_PATH.format(frames=frames))
    names = f"{'read':>6} {'voxelize':>9} {'solve':>8} {'surface':>8} {'write':>7} {'all':>7}"
    print(f"{'cells':>6} {names} {'solve wall':>10} {'wall s':>7} {'workers':>7} {'peak MB':>8}")
    for cells in resolutions:
        found = measured(_CASES, "path", cells=cells, frames=frames)
        stages = [found[name] for name in ("read", "voxelize", "solve", "surface", "write", "cpu")]
        read, voxelize, solve, surface, write, cpu = stages
        print(
            f"{cells:6} {read:6.2f} {voxelize:9.2f} {solve:8.2f} {surface:8.2f} {write:7.2f} {cpu:7.2f} "
            f"{found['solve_wall']:10.2f} {found['wall']:7.2f} {found['workers']:7} {found['peak']:8.0f}",
            flush=True,
        )
