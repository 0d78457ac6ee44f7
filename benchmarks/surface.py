# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of interpolating densities on surfaces, with and without bounded entropy."""

from __future__ import annotations

from .processes import measured

SIZES = (1000, 10_000, 100_000, 500_000)
"""Numbers of vertices of the meshes."""

_TITLE = """
CPU seconds of {steps} steps to a marginal error of 1 %, by bisection.

setup    Laplacian and factorization
coarser  all coarser meshes, once per mesh
solve    all steps
sweeps   on the finest mesh, for the slowest step of every bisection level
MB       peak memory
"""


def main(sizes: list[int], steps: int) -> None:
    """Run all cases and print a table."""
    print(_TITLE.format(steps=steps))
    print(f"{'vertices':>8} {'bound':>5}  {'setup':>7} {'coarser':>7} {'solve':>7}  {'error':>7} {'MB':>6}  sweeps")
    for size in sizes:
        for bounded in (True, False):
            found = measured("benchmarks.surface_cases", "interpolation", count=size, steps=steps, bounded=bounded)
            print(
                f"{size:8} {'yes' if bounded else 'no':>5}  {found['setup']:7.2f} {found['coarser']:7.2f} "
                f"{found['solve']:7.2f}  {found['error']:7.4f} {found['peak']:6.0f}  {found['sweeps']}",
                flush=True,
            )
