# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Effect of the solver's constants: rounds, CPU seconds and errors when one of them is changed.

The barycenters of a ring and of a box across it on a grid, from a cold start: plain with a wide blur, sharpened with a
narrow blur, and debiased. Their error is the L1 distance to the same barycenter solved a hundred times more accurately.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from convwass_addon.transport import (
    Barycenter,
    Grid,
    Inputs,
    barycenter,
    bregman as bregman_module,
    gaussian as gaussian_module,
)

barycenter_module = sys.modules["convwass_addon.transport.barycenter"]


@dataclass(frozen=True)
class Varied:
    """A constant and the values to compare with its own."""

    module: ModuleType
    name: str
    values: tuple[float, ...]


VARIED = (
    Varied(barycenter_module, "_COARSE_TOLERANCE", (0.3, 0.9)),
    Varied(barycenter_module, "_RIM_SHARE", (0.03, 0.3)),
    Varied(barycenter_module, "_RIM_CELLS", (1, 6)),
    Varied(bregman_module, "_NEGLIGIBLE_SHARE", (0.1, 0.6)),
    Varied(bregman_module, "_STALLED", (0.8, 10.0)),
    Varied(bregman_module, "_DEBIAS_STEP", (0.5, 0.7)),
    Varied(bregman_module, "_DEBIAS_MOMENTUM", (0.3, 0.8)),
    Varied(bregman_module, "_MOMENTUM_FALL", (0.8, 2.4)),
    Varied(gaussian_module, "_NARROWEST_COARSE", (1.0, 1.6)),
)


@dataclass(frozen=True)
class Case:
    """A barycenter."""

    name: str
    blur: float
    sharpness: float


def shapes(cells: int) -> NDArray[np.float64]:
    """Return a ring and a box across it, (2, cells, cells, cells)."""
    x, y, z = (np.indices((cells,) * 3) + 0.5) / cells - 0.5
    ring = np.hypot(np.hypot(x, y) - 0.28, z) < 0.1
    box = (np.abs(x) < 0.08) & (np.abs(y) < 0.3) & (np.abs(z) < 0.25)
    return np.stack([ring, box]).astype(np.float64)


def main(cells: int) -> None:
    """Print a row per constant and value."""
    cases = (Case("plain", cells / 40, 0.0), Case("sharp", 1.0, 0.75), Case("debiased", cells / 40, 1.0))
    prepared = [Inputs.of(shapes(cells), Grid((cells,) * 3, case.blur)) for case in cases]
    exact = [_solved(case, inputs, 1e-4) for case, inputs in zip(cases, prepared, strict=True)]
    print(f"| {cells}^3 cells | {' | '.join(f'{case.name}: rounds, CPU s, error' for case in cases)} |")
    print("|---" * (len(cases) + 1) + "|")
    print(_row("as it is", cases, prepared, exact))
    for varied in VARIED:
        own = getattr(varied.module, varied.name)
        for value in varied.values:
            setattr(varied.module, varied.name, value)
            # Prepared inputs depend on the constants of domains.
            inputs = [Inputs.of(shapes(cells), Grid((cells,) * 3, case.blur)) for case in cases]
            print(_row(f"{varied.name} {own:g}: {value:g}", cases, inputs, exact), flush=True)
        setattr(varied.module, varied.name, own)


def _row(title: str, cases: tuple[Case, ...], prepared: list[Inputs], exact: list[Barycenter]) -> str:
    found = []
    for case, inputs, truth in zip(cases, prepared, exact, strict=True):
        start = time.process_time()
        solved = _solved(case, inputs, 1e-2)
        seconds = time.process_time() - start
        error = np.abs(solved.density - truth.density).mean()
        rounds = " ".join(map(str, solved.iterations))
        found.append(f"{rounds}{'' if solved.converged else ' (not converged)'}, {seconds:.2f}, {error:.4f}")
    return f"| {title} | {' | '.join(found)} |"


def _solved(case: Case, inputs: Inputs, tolerance: float) -> Barycenter:
    options = {"sharpness": case.sharpness, "tolerance": tolerance, "max_iterations": 5000}
    return barycenter(inputs, [0.5, 0.5], inputs.domain, **options)
