# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A new domain in thirty lines: a periodic line, such as the hours of a day, hues or directions.

python3 run.py python docs/scripts/ring_domain.py

Solvers use a domain only through `transport.domain.Domain`: area weights and the heat kernel. This one
applies the kernel as a matrix of logarithms, which has an unlimited range and is fast enough for a few hundred cells.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import logsumexp

from convwass_addon.transport import barycenter, distance
from convwass_addon.transport.gaussian import GaussianKernel
from convwass_addon.transport.log_range import LOG_NOTHING
from convwass_addon.transport.region import ThroughWholeArrays

# Number of turns around the ring that contribute heat.
_TURNS = np.arange(-3, 4)


class Ring(GaussianKernel, ThroughWholeArrays):
    """A periodic line of cells; `sigma`, in cells, is the blur of its kernel."""

    dimension = 1
    has_fast_propagation = has_fast_balance = False
    relaxation = 1.5
    far_numerics = "log domain"
    pieces = None

    def __init__(self, cells: int, sigma: float) -> None:
        self.shape = (cells,)
        self.weights = 1.0 / cells
        self.unit_length = float(cells)
        self.gamma = 2.0 * (sigma / cells) ** 2
        self.positions = np.arange(cells)[:, None] + 0.5
        # Heat from around the ring comes from periodic images of its source.
        apart = (self.positions - self.positions.T)[..., None] / cells + _TURNS
        logs = logsumexp(-(apart**2) / self.gamma, axis=-1)
        self._log_kernel = logs - logsumexp(logs + np.log(self.weights), axis=1, keepdims=True)

    def apply(self, columns: ArrayLike) -> np.ndarray:
        """Return H (a * column) of every column."""
        return np.asarray(columns) * self.weights @ np.exp(self._log_kernel)

    def log_apply(self, logs: np.ndarray, out: np.ndarray) -> None:
        """Write log H (a * exp(column)) to `out`."""
        found = logsumexp(logs[..., None, :] + np.log(self.weights) + self._log_kernel, axis=-1)
        out[...] = np.where(found < LOG_NOTHING / 2, LOG_NOTHING, found)

    log_apply_far = log_apply

    def coarser(self) -> None:
        """Return None: there are so few cells that coarser levels are not needed."""
        return None


def hours_around(ring: Ring, hour: float, width: float = 0.5) -> np.ndarray:
    """Return a density of mass 1 around an hour of the day."""
    away = (ring.positions[:, 0] / ring.shape[0] * 24.0 - hour + 12.0) % 24.0 - 12.0
    density = np.exp(-0.5 * (away / width) ** 2)
    return density / (density * ring.weights).sum()


def mean_hour(density: np.ndarray, ring: Ring) -> float:
    """Return the mean hour of a density."""
    turns = np.exp(2j * np.pi * ring.positions[:, 0] / ring.shape[0])
    return round(float(np.angle((density * turns).sum())) / (2.0 * np.pi) * 24.0, 6) % 24.0


def main() -> None:
    """Print blends between eleven at night and three in the morning."""
    ring = Ring(240, sigma=2.0)
    evening, night = hours_around(ring, 23.0), hours_around(ring, 3.0)
    found = distance(evening, night, ring)
    print(f"distance: {found.length / ring.shape[0] * 24.0:.3f} hours")
    for share in (0.25, 0.5, 0.75):
        blend = barycenter([evening, night], [1.0 - share, share], ring, sharpness=1.0)
        print(f"{share:.2f} of the way: {mean_hour(blend.density, ring):.3f} h, converged {blend.converged}")


if __name__ == "__main__":
    main()
