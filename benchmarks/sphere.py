# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed and accuracy of transport on the sphere: kernels, lobes of materials, skies."""

from __future__ import annotations

from .processes import measured

_CASES = "benchmarks.sphere_cases"

_KERNELS = """
Kernels with a sigma of 4.2 degrees. CPU seconds to build a kernel, to apply it to 2 columns, and for a barycenter of
two blobs to a marginal error of 0.1 %, the mean over four paths; the last column is the largest distance of a midpoint
from the great circle.
"""
_LOBES = """
Materials halfway between two, 64 x 256 cells per lobe. CPU seconds to tabulate both, for all incoming directions, and
for one of them; the marginal error, the mean entropy, and the fraction of light that the nearest GGX misplaces.
"""
_SKIES = """
Skies between two with suns 93 degrees apart. CPU seconds to prepare including the first frame, and per frame; largest
distance of the sun from the great circle, and of the energy from the linear mix.
"""


def main(rows: list[int]) -> None:
    """Run all cases and print the tables.

    Parameters
    ----------
    rows : list of int
        Numbers of rows of the spheres; the skies have four times as many.
    """
    print(_KERNELS)
    print(f"{'rows':>5}  {'kernel':8} {'build':>7} {'apply':>7} {'solve':>7} {'off, px':>8}")
    for size in rows:
        for kind in ("exact", "filter"):
            found = measured(_CASES, "kernel", rows=size, kind=kind)
            figures = f"{found['built']:7.3f} {found['applied']:7.4f} {found['seconds']:7.2f} {found['off']:8.3f}"
            print(f"{size:5}  {kind:8} {figures}", flush=True)
    print(_LOBES)
    print(f"{'pair':9} {'entropy':8} {'tables':>7} {'all':>6} {'one':>6} {'error':>7} {'H':>6} {'GGX':>6}")
    for pair in ("round", "models", "crossed"):
        for bound in ("free", "mean"):
            found = measured(_CASES, "lobes", pair=pair, entropy=bound)
            one = found["seconds"] / found["directions"]
            figures = f"{found['prepared']:7.1f} {found['seconds']:6.1f} {one:6.2f} {found['error']:7.4f}"
            last = f"{found['entropy']:6.2f} {found['fit']['total_variation']:6.2f}"
            print(f"{pair:9} {bound:8} {figures} {last}", flush=True)
    print(_SKIES)
    print(f"{'size':>11} {'prepare':>8} {'frame':>6} {'off, px':>8} {'energy':>9}")
    for size in rows:
        found = measured(_CASES, "skies", rows=4 * size)
        figures = f"{found['prepared']:8.2f} {found['seconds']:6.2f} {found['off']:8.3f} {found['energy']:9.1e}"
        print(f"{8 * size:4} x {4 * size:4} {figures}", flush=True)
