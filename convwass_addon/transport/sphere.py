# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The sphere, or its upper half, as a domain of transport: a latitude-longitude grid."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..geometry.grids.coarser_grid import doubled
from ..one_line import one_line
from .domain import KernelTooNarrowError
from .gaussian import GaussianKernel
from .log_range import HEADROOM, LOG_NOTHING, floored_log, flushed_exp
from .region import Region, ThroughWholeArrays
from .sphere_filter import SphereFilter
from .zonal_kernel import ZonalKernel, log_zonal

_FEWEST_COLUMNS = 32
# Above these limits, tables take gigabytes, and a round in the log domain takes minutes.
_MOST_ROWS = 512
_FAR_CELLS = 1 << 13
# A term whose logarithm is below that of the sum by more than this does not change it:
# e^-45 is 3e-20, and float64 sums are accurate to 1e-16.
_DEPTH = 45.0


class Sphere(GaussianKernel, ThroughWholeArrays):
    """A latitude-longitude grid on the unit sphere or its upper half.

    Row i has the angle (i + 1/2) pi / rows from the north pole, +Z, and column j the longitude (j + 1/2) 2 pi / columns
    from +X towards +Y. The upper half ends at the equator, with empty space below. Lengths are those of the sphere
    rescaled to unit area. The kernel is a constant times exp(-d^2 / gamma), with d the geodesic distance and
    gamma = 2 sigma^2.

    Parameters
    ----------
    rows : int
        From pole to pole, or from the pole to the equator; even.
    sigma : float
        Standard deviation of the kernel in rows.
    columns : int, optional
        An even number; by default such that cells are square at the equator.
    part : "whole" or "upper"
        Which part of the sphere to use.
    kernel : "exact" or "filter"
        "filter" is the separable blur of the paper, :class:`.sphere_filter.SphereFilter`: up to twice as fast on
        256 x 128 cells, but distances are off by up to 10 % and midpoints by up to 0.2 sigma.

    Attributes
    ----------
    area : float
        In steradians.
    radians : float
        Angle between two rows.

    Raises
    ------
    ValueError
        Invalid numbers; the message names the argument.
    """

    dimension = 2
    has_fast_propagation = False
    has_fast_balance = False
    relaxation = 1.5
    far_numerics = "log domain by rows"
    pieces = None

    __repr__ = one_line("shape", "sigma", "part", "kernel")

    def __init__(
        self,
        rows: int,
        sigma: float,
        columns: int | None = None,
        part: Literal["whole", "upper"] = "whole",
        kernel: Literal["exact", "filter"] = "exact",
    ) -> None:
        if part not in ("whole", "upper"):
            raise ValueError(f'part must be "whole" or "upper", got {part!r}')
        if kernel not in ("exact", "filter"):
            raise ValueError(f'kernel must be "exact" or "filter", got {kernel!r}')
        whole = rows if part == "whole" else 2 * rows
        columns = 2 * whole if columns is None else columns
        if rows != int(rows) or rows < 2 or rows % 2 or whole > _MOST_ROWS:
            raise ValueError(f"rows must be an even number, at most {_MOST_ROWS} from pole to pole, got {rows}")
        if columns != int(columns) or not 4 <= columns <= 4 * _MOST_ROWS or columns % 2:
            raise ValueError(f"columns must be an even number between 4 and {4 * _MOST_ROWS}, got {columns}")
        if not (np.isfinite(sigma) and 0.1 <= sigma <= rows):
            raise ValueError(f"sigma must lie between 0.1 and {rows} rows, got {sigma}")
        self.shape = (int(rows), int(columns))
        self.sigma = float(sigma)
        self.part = part
        self.kernel = kernel
        self.area = 4.0 * np.pi if part == "whole" else 2.0 * np.pi
        self.unit_length = float(np.sqrt(self.area))
        self.radians = np.pi / whole
        self.gamma = 2.0 * (self.sigma * self.radians / self.unit_length) ** 2
        self.solid_angles = solid_angles(whole, self.shape[1])[: self.shape[0]]
        self.weights = self.solid_angles / self.area

    @property
    def whole_rows(self) -> int:
        """Rows from pole to pole."""
        return self.shape[0] * (1 if self.part == "whole" else 2)

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """Unit vectors to the centers of the cells, (*shape, 3); lengths are radians."""
        return directions(self.whole_rows, self.shape[1])[: self.shape[0]]

    @cached_property
    def _applied(self) -> ZonalKernel | SphereFilter:
        """The kernel, built on first use, because solid angles do not need it."""
        kind = ZonalKernel if self.kernel == "exact" else SphereFilter
        return kind(self.whole_rows, self.shape[1], self.shape[0], self.sigma * self.radians, self.weights[:, 0])

    def apply(self, columns: ArrayLike) -> NDArray[np.float64]:
        """Apply the kernel, H (a * column), to every column.

        Parameters
        ----------
        columns : (k, *shape) or shape
            Densities or scalings.

        Returns
        -------
        ndarray
            The same shape, blurred. Constants are preserved up to discretization error, except near the edge of an
            upper half, where they fall.
        """
        values = np.ascontiguousarray(columns, dtype=np.float64)
        if values.shape[-2:] != self.shape or values.ndim > 3:
            raise ValueError(f"columns must have the shape (k, {self.shape[0]}, {self.shape[1]}), got {values.shape}")
        result = np.empty_like(values)
        self._applied.apply(values.reshape(-1, *self.shape), result.reshape(-1, *self.shape))
        return result

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) of every column to `out`, by float64 scalings.

        Accurate or `LOG_NOTHING` within 36 sigma of a column's largest value. `logs` and `out` may be the same array.
        """
        columns, results = logs.reshape(-1, *self.shape), out.reshape(-1, *self.shape)
        shifts = columns.max(axis=(1, 2), keepdims=True) - HEADROOM
        self._applied.apply(flushed_exp(columns, shifts), results)
        floored_log(results, shifts)

    def log_apply_far(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Like :meth:`log_apply`, with the exact kernel in the log domain, row by row: any range, 100 times slower.

        Raises
        ------
        KernelTooNarrowError
            The grid is too large for this.
        """
        if self.shape[0] * self.shape[1] > _FAR_CELLS:
            raise KernelTooNarrowError(
                f"sigma = {self.sigma:.3g} rows is too small for scalings of float64 on a sphere of "
                f"{self.shape[0]} x {self.shape[1]} cells; try {2 * self.sigma:.3g}"
            )
        results = [self._log_blur(column) for column in logs.reshape(-1, *self.shape)]
        out.reshape(-1, *self.shape)[...] = results

    def _log_blur(self, logs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Blur one column: for every target row, sum over the source rows in order of their upper bounds."""
        logs = np.where(logs > LOG_NOTHING / 2, logs + np.log(self.weights), -np.inf)
        tops = logs.max(axis=1)
        there = [np.flatnonzero(np.isfinite(row)) for row in logs]
        result = np.full(self.shape, LOG_NOTHING)
        around = np.arange(self.shape[1])
        for row, target in enumerate(result):
            kernels = self._log_rows[:, row]
            bounds = tops + kernels[0]
            best = np.full(self.shape[1], -np.inf)
            for other in np.argsort(-bounds):
                if bounds[other] < best.min() - _DEPTH or not len(there[other]):
                    break
                steps = (around[:, None] - there[other]) % self.shape[1]
                terms = kernels[np.minimum(steps, self.shape[1] - steps), other] + logs[other, there[other]]
                most = terms.max(axis=1)
                best = np.logaddexp(best, most + np.log(np.exp(terms - most[:, None]).sum(axis=1)))
            np.maximum(best, LOG_NOTHING, out=target)
        return result

    @cached_property
    def _log_rows(self) -> NDArray[np.float64]:
        """Logarithms of the exact kernel, (columns / 2 + 1, rows, rows)."""
        sigma = self.sigma * self.radians
        offsets = range(self.shape[1] // 2 + 1)
        logs = np.stack([log_zonal(self.whole_rows, self.shape[1], self.shape[0], d, sigma) for d in offsets])
        sums = np.tensordot(np.exp(logs), self.weights[:, 0], 1)
        logs -= np.log((2.0 * sums.sum(axis=0) - sums[0] - sums[-1]).max())
        return logs

    def coarser(self) -> Sphere | None:
        """Return the sphere of half the resolution; None where it would be too small."""
        return self._coarser

    @cached_property
    def _coarser(self) -> Sphere | None:
        rows, columns = self.shape
        if rows % 4 or columns % 4 or columns < 2 * _FEWEST_COLUMNS:
            return None
        return Sphere(rows // 2, self.coarser_sigma, columns // 2, self.part, self.kernel)

    def restrict(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Densities on the coarser sphere, (k, rows / 2, columns / 2): means of 2 x 2 cells by solid angle."""
        rows, width = self.shape
        masses = (columns * self.weights).reshape(len(columns), rows // 2, 2, width // 2, 2).sum(axis=(2, 4))
        return masses / self.coarser().weights

    def prolong(self, columns: NDArray[np.float64], region: Region) -> NDArray[np.float64]:
        """Interpolate columns of the coarser sphere linearly, also across the poles, to a region, (k, len)."""
        result = np.empty((len(columns), len(region)), columns.dtype)
        for values, target in zip(columns, result, strict=True):
            padded = doubled(_padded(values, self.part), [side + 4 for side in self.shape])
            target[...] = region.gather(padded[2:-2, 2:-2])
        return result

    def refined(self, support: Region, region: Region) -> Region:
        """Return the whole sphere, which is always blurred at once."""
        return Region.whole(self.shape)


def solid_angles(rows: int, columns: int) -> NDArray[np.float64]:
    """Solid angles of the cells of a whole sphere in steradians, (rows, columns)."""
    edges = np.linspace(0.0, np.pi, rows + 1)
    # cos a - cos b, without the cancellation at the poles.
    bands = 2.0 * np.sin((edges[:-1] + edges[1:]) / 2.0) * np.sin(np.pi / (2 * rows))
    return np.repeat((bands * (2.0 * np.pi / columns))[:, None], columns, axis=1)


def directions(rows: int, columns: int) -> NDArray[np.float64]:
    """Return unit vectors to the centers of the cells of a whole sphere, (rows, columns, 3)."""
    theta = ((np.arange(rows) + 0.5) * (np.pi / rows))[:, None]
    phi = (np.arange(columns) + 0.5) * (2.0 * np.pi / columns)
    parts = (np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta) + 0.0 * phi)
    return np.stack(parts, axis=-1)


def _padded(values: NDArray, part: Literal["whole", "upper"]) -> NDArray:
    """Pad by one cell on every side: beyond a pole are the cells half a turn away, beyond the equator copies."""
    half = values.shape[1] // 2
    south = np.roll(values[-1:], half, axis=1) if part == "whole" else values[-1:]
    rows = np.concatenate([np.roll(values[:1], half, axis=1), values, south])
    return np.concatenate([rows[:, -1:], rows, rows[:, :1]], axis=1)
