# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""``python -m benchmarks [--resolutions 64,100] [--frames 24]``: the morph by stage, and single barycenters.

Every case runs in a process of its own, one after the other, with one BLAS thread, so that CPU seconds and peak memory
are its own. CPU seconds, not wall seconds: a busy machine stretches the latter.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys

SINGLE = (
    ("plain, blur N / 40", {"blur": None, "sharpness": 0.0}),
    ("sharpness 0.75, blur 1 cell", {"blur": 1.0, "sharpness": 0.75}),
    ("debiased, blur 1 cell", {"blur": 1.0, "sharpness": 1.0}),
)


def main() -> int:
    """Run all cases and print two tables."""
    parser = argparse.ArgumentParser(prog="run.py bench", description=__doc__)
    parser.add_argument("--resolutions", default="64,100", help="cells along the longest side (%(default)s)")
    parser.add_argument("--frames", type=int, default=24, help="frames of the morph (%(default)s)")
    options = parser.parse_args()
    resolutions = [int(part) for part in options.resolutions.split(",")]

    print("One cold barycenter, horse and bird, t = 0.5, to 1 % marginal error\n")
    print(f"{'cells':>6}  {'case':30} {'CPU s':>7} {'iterations':>16} {'error':>7} {'numerics':>20} {'peak MB':>8}")
    for cells in resolutions:
        for name, case in SINGLE:
            found = measured("single", cells=cells, **case)
            print(
                f"{cells:6}  {name:30} {found['cpu']:7.2f} {found['iterations']!s:>16} {found['error']:7.4f} "
                f"{found['numerics']:>20} {found['peak']:8.0f}",
                flush=True,
            )
    print(f"\nA morph from horse to bird, {options.frames} frames, from meshes to .blend, CPU s by stage\n")
    names = f"{'read':>6} {'voxelize':>9} {'solve':>8} {'surface':>8} {'write':>7} {'all':>7}"
    print(f"{'cells':>6} {names} {'wall s':>7} {'peak MB':>8}")
    for cells in resolutions:
        found = measured("path", cells=cells, frames=options.frames)
        stages = [found[name] for name in ("read", "voxelize", "solve", "surface", "write", "cpu")]
        read, voxelize, solve, surface, write, cpu = stages
        print(
            f"{cells:6} {read:6.2f} {voxelize:9.2f} {solve:8.2f} {surface:8.2f} {write:7.2f} {cpu:7.2f} "
            f"{found['wall']:7.2f} {found['peak']:8.0f}",
            flush=True,
        )
    return 0


def measured(case: str, **options: object) -> dict[str, object]:
    """Run one case in a fresh process and return what it reports."""
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    command = [sys.executable, "-m", "benchmarks.cases", case, json.dumps(options)]
    done = subprocess.run(command, env={**os.environ, **threads}, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"benchmark {case} {options} failed:\n{done.stderr}")
    return json.loads(done.stdout.strip().splitlines()[-1])


sys.exit(main())
