# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regular grids as a domain of transport: the heat kernel is a Gaussian, one axis after the other."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import prod

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import blas

from .domain import LOG_NOTHING

# The largest scaling is exp(600): half of the range of float64 lies below one, and no row of the kernel sums to more.
_HEADROOM = 600.0
# Kernel entries and scalings below this would only produce subnormal products, which are many times slower.
_NEGLIGIBLE = 1e-290


class Grid:
    """A grid of equal square cells with free space around it.

    Lengths of the domain are those of the grid rescaled to unit volume. With cell size h the kernel is
    K = exp(-d^2 / gamma), gamma = 2 (sigma h)^2, normalized per axis as the heat kernel is (Solomon et al. 2015,
    section 4; sigma^2 = 2 t in df/dt = Laplacian(f)).

    Parameters
    ----------
    shape : sequence of int
        Cells per axis, one to three axes.
    sigma : float
        Standard deviation of the kernel in cells.

    Raises
    ------
    ValueError
        `shape` is not one to three positive numbers, or `sigma` is not a positive number.

    Notes
    -----
    A grid keeps scratch arrays between calls, so each thread needs a grid of its own.
    """

    def __init__(self, shape: Sequence[int], sigma: float) -> None:
        self.shape = tuple(int(n) for n in shape)
        self.sigma = float(sigma)
        if not 1 <= len(self.shape) <= 3 or min(self.shape) < 1:
            raise ValueError(f"shape must be one to three positive numbers of cells, got {tuple(shape)}")
        if not (np.isfinite(self.sigma) and self.sigma > 0):
            raise ValueError(f"sigma must be a positive number of cells, got {sigma}")
        self.cells = prod(self.shape)
        self.spacing = self.cells ** (-1.0 / len(self.shape))
        self.gamma = 2.0 * (self.sigma * self.spacing) ** 2
        self.weights = 1.0 / self.cells
        self._kernels = {n: _gaussian(n, self.sigma) for n in set(self.shape)}

    def apply(self, columns: ArrayLike) -> NDArray[np.float64]:
        """Apply the heat kernel, H (a * column), to every column.

        Parameters
        ----------
        columns : (k, *shape) or shape
            Densities or scalings.

        Returns
        -------
        ndarray
            The same shape, blurred; constants stay constant away from the walls.
        """
        values = np.ascontiguousarray(columns, dtype=np.float64)
        result = np.empty_like(values)
        for source, target in zip(self._columns(values), self._columns(result), strict=True):
            self._blur(source, target)
        return result

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) of every column to `out`, by scalings of float64.

        A result is either right or `LOG_NOTHING`: the largest term of a sum of positive terms is the last to
        underflow. `logs` and `out` may be the same array.
        """
        scaled, _, _ = self._scratch
        for source, target in zip(self._columns(logs), self._columns(out), strict=True):
            shift = source.max() - _HEADROOM
            np.subtract(source, shift, out=scaled)
            np.exp(scaled, out=scaled)
            np.copyto(scaled, 0.0, where=scaled < _NEGLIGIBLE)
            self._blur(scaled, target)
            _log_in_place(target)
            target += shift

    def log_apply_by_line(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) to `out`, every grid line shifted by its own maximum.

        Only differences along one line can underflow, so it survives kernels too narrow for :meth:`log_apply`, at
        two to three times the cost.
        """
        first, second, _ = (buffer.reshape(-1) for buffer in self._scratch)
        for source, target in zip(self._columns(logs), self._columns(out), strict=True):
            current = source.reshape(-1)
            for axis in reversed(range(len(self.shape))):
                size = self.shape[axis]
                lines = first.reshape(-1, size)
                shift = current.reshape(-1, size).max(axis=1, keepdims=True) - _HEADROOM
                np.subtract(current.reshape(-1, size), shift, out=lines)
                np.exp(lines, out=lines)
                np.copyto(lines, 0.0, where=lines < _NEGLIGIBLE)
                turned = target.reshape(-1) if axis == 0 else second
                self._contract(first, turned, size)
                _log_in_place(turned)
                turned.reshape(size, -1)[...] += shift[:, 0]
                current = turned
            np.maximum(target, LOG_NOTHING, out=target)

    def coarser(self) -> Grid | None:
        """Return the grid of half the resolution and the same sigma in cells; None where it would be too small."""
        if any(n % 2 or n < 16 for n in self.shape):
            return None
        return Grid([n // 2 for n in self.shape], self.sigma)

    def restrict(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Densities on the coarser grid, (k, *shape / 2): the means of 2 x 2 x 2 cells, which keep the mass."""
        split = [size for n in self.shape for size in (n // 2, 2)]
        means = tuple(range(2, 2 * len(self.shape) + 1, 2))
        return columns.reshape(len(columns), *split).mean(axis=means)

    def prolong(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Interpolate columns of the coarser grid linearly to this one, (k, *shape)."""
        for axis in range(1, columns.ndim):
            columns = _double(columns, axis)
        return columns

    def _columns(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return values.reshape(-1, *self.shape)

    @cached_property
    def _scratch(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        # Fresh arrays of this size cost more in page faults than the arithmetic that fills them.
        return np.empty(self.shape), np.empty(self.shape), np.empty(self.shape)

    def _blur(self, source: NDArray[np.float64], target: NDArray[np.float64]) -> None:
        """One matrix product per axis; `source` may be the first scratch array, never `target`."""
        _, second, third = self._scratch
        current = source.reshape(-1)
        spare = [second.reshape(-1), third.reshape(-1)]
        for axis in reversed(range(len(self.shape))):
            turned = target.reshape(-1) if axis == 0 else spare[axis % 2]
            self._contract(current, turned, self.shape[axis])
            current = turned

    def _contract(self, source: NDArray[np.float64], target: NDArray[np.float64], size: int) -> None:
        """Contract the last axis (of `size`) with its kernel and put it first, so that the next axis comes last.

        BLAS writes the turned order at no cost. It is SciPy's because the NumPy inside Blender may have none.
        """
        blas.dgemm(
            1.0,
            source.reshape(-1, size).T,
            self._kernels[size],
            trans_a=1,
            c=target.reshape(size, -1).T,
            overwrite_c=1,
        )


def _gaussian(size: int, sigma: float) -> NDArray[np.float64]:
    """Gaussian between the cells of one axis, (size, size) in Fortran order; a whole row sums to one."""
    distance = np.arange(size)[:, None] - np.arange(size)
    reach = np.arange(-int(np.ceil(40 * sigma)), int(np.ceil(40 * sigma)) + 1)
    kernel = np.exp(-(distance**2) / (2.0 * sigma**2)) / np.exp(-(reach**2) / (2.0 * sigma**2)).sum()
    kernel[kernel < _NEGLIGIBLE] = 0.0
    return np.asfortranarray(kernel)


def _log_in_place(values: NDArray[np.float64]) -> None:
    with np.errstate(divide="ignore"):
        np.log(values, out=values)
    np.maximum(values, LOG_NOTHING, out=values)


def _double(values: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Double the cells of one axis by linear interpolation between cell centers, constant beyond the outer ones."""
    values = np.moveaxis(values, axis, 0)
    before = np.concatenate([values[:1], values[:-1]])
    after = np.concatenate([values[1:], values[-1:]])
    doubled = np.empty((2 * len(values), *values.shape[1:]))
    doubled[0::2] = 0.75 * values + 0.25 * before
    doubled[1::2] = 0.75 * values + 0.25 * after
    return np.ascontiguousarray(np.moveaxis(doubled, 0, axis))
