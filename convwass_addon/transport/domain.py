# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a solver asks of a domain: area weights and the heat kernel, in logarithms."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Logarithm that stands for "nothing here": far below all that float64 scalings can express, still finite.
LOG_NOTHING = -1e4


class Domain(Protocol):
    """A place where distributions live. Solvers take one and never ask which.

    Attributes
    ----------
    shape : tuple of int
        Shape of one distribution.
    weights : float or ndarray of `shape`
        Area weights a, with sum 1.
    gamma : float
        Entropic regularization, K = exp(-d^2 / gamma).
    """

    shape: tuple[int, ...]
    weights: float | NDArray[np.float64]
    gamma: float

    def apply(self, columns: ArrayLike) -> NDArray[np.float64]:
        """H (a * column) of every column."""

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) to `out`; LOG_NOTHING where float64 scalings cannot express it."""

    def log_apply_by_line(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the same by numerics that reach further, at a higher cost."""

    def coarser(self) -> Domain | None:
        """Return the domain of half the resolution, if there is a useful one."""

    def restrict(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Densities on the coarser domain."""

    def prolong(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Columns of the coarser domain, interpolated to this one."""
