# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regular grids as domains of transport; the heat kernel is a separable Gaussian."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from math import prod
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import map_coordinates

from ..geometry.algebra.products import contract
from ..geometry.arrays.chunks import chunks
from ..geometry.grids.coarser_grid import doubled_along
from ..one_line import one_line
from .gaussian import GaussianKernel
from .log_lines import log_blur
from .log_range import HEADROOM, LOG_NOTHING, NEGLIGIBLE, floored_log, flushed_exp
from .region import Region, ThroughWholeArrays

# Below this the Gaussian is a single cell; above it, uniform on any grid that fits in memory.
_NARROWEST, _WIDEST = 1e-3, 1e4
# Kernel entries extend to this many standard deviations.
_ENTRIES = 36.0
# Number of cells blurred at once in the log domain.
_AT_ONCE = 1 << 17
# If fewer than this fraction of a box's cells are needed, each is interpolated separately.
_FEW = 0.1
# Coarse cells around the support of a density that are refined as well.
_MARGIN = 1


class Grid(GaussianKernel, ThroughWholeArrays):
    """A grid of equal square cells, in free space or surrounded by walls.

    Lengths are those of the grid rescaled to unit volume. With cell size h the kernel is K = exp(-d^2 / gamma), gamma =
    2 (sigma h)^2, normalized per axis like the heat kernel (Solomon et al. 2015, section 4; sigma^2 = 2 t in
    df/dt = Laplacian(f)).

    Parameters
    ----------
    shape : sequence of int
        Cells per axis, one to three axes.
    sigma : float
        Standard deviation of the kernel in cells.
    boundary : "open" or "reflecting"
        "open" lets heat leave the grid as if it were surrounded by empty space; "reflecting" has walls without flux,
        so that constants are preserved everywhere.

    Raises
    ------
    ValueError
        `shape` is not one to three positive integers, `sigma` is not a positive number, or `boundary` is unknown.

    Notes
    -----
    A grid keeps scratch arrays between calls, one set per thread.
    """

    has_fast_propagation = False
    has_fast_balance = False
    relaxation = 1.5
    far_numerics = "log domain by line"
    pieces = None

    __repr__ = one_line("shape", "sigma", "boundary")

    def __init__(self, shape: Sequence[int], sigma: float, boundary: Literal["open", "reflecting"] = "open") -> None:
        self.shape = tuple(int(n) for n in shape)
        self.sigma = float(sigma)
        self.boundary = boundary
        if not 1 <= len(self.shape) <= 3 or min(self.shape) < 1 or self.shape != tuple(shape):
            raise ValueError(f"shape must be one to three positive whole numbers of cells, got {tuple(shape)}")
        if not (np.isfinite(self.sigma) and self.sigma > 0):
            raise ValueError(f"sigma must be a positive number of cells, got {sigma}")
        if not _NARROWEST <= self.sigma <= _WIDEST:
            raise ValueError(f"sigma must lie between {_NARROWEST} and {_WIDEST} cells, got {sigma}")
        if boundary not in ("open", "reflecting"):
            raise ValueError(f'boundary must be "open" or "reflecting", got {boundary!r}')
        self.cells = prod(self.shape)
        self.spacing = self.cells ** (-1.0 / len(self.shape))
        self.gamma = 2.0 * (self.sigma * self.spacing) ** 2
        self.unit_length = 1.0 / self.spacing
        self.weights = 1.0 / self.cells
        self._of_thread = threading.local()
        self._kernels = {n: _gaussian(n, self.sigma, boundary) for n in set(self.shape)}

    @property
    def dimension(self) -> int:
        """Number of axes."""
        return len(self.shape)

    @property
    def positions(self) -> NDArray[np.float64]:
        """Centers of the cells, in cells, (*shape, d); the first is at 0.5."""
        return np.moveaxis(np.indices(self.shape), 0, -1) + 0.5

    def apply(self, columns: ArrayLike) -> NDArray[np.float64]:
        """Apply the heat kernel, H (a * column), to every column.

        Parameters
        ----------
        columns : (k, *shape) or shape
            Densities or scalings.

        Returns
        -------
        ndarray
            The same shape, blurred; constants are preserved away from the walls.
        """
        values = np.ascontiguousarray(columns, dtype=np.float64)
        if values.shape[-len(self.shape) :] != self.shape:
            raise ValueError(f"columns must have the shape (k, {', '.join(map(str, self.shape))}), got {values.shape}")
        result = np.empty_like(values)
        for source, target in zip(self._columns(values), self._columns(result), strict=True):
            self._blur(source, target)
        return result

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) of every column to `out`, by float64 scalings.

        In a sum of positive terms the largest one underflows last, so a result is either accurate or `LOG_NOTHING` as
        long as that term lies within 36 sigma on every axis, where the kernel's entries end. `logs` and `out` may be
        the same array.
        """
        scaled, _, _ = self._scratch
        for source, target in zip(self._columns(logs), self._columns(out), strict=True):
            shift = source.max() - HEADROOM
            self._blur(flushed_exp(source, shift, scaled), target)
            floored_log(target, shift)

    def log_apply_far(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) to `out`, line by line in the log domain.

        Lines no longer than the kernel's support are shifted by their own maximum, so that only differences along one
        line can underflow; this costs two to three times as much as :meth:`log_apply`. Longer lines are blurred in
        blocks (:func:`.log_lines.log_blur`), which is accurate up to a hundred sigma and costs ten to twenty times as
        much.
        """
        first, second, _ = (buffer.reshape(-1) for buffer in self._scratch)
        for source, target in zip(self._columns(logs), self._columns(out), strict=True):
            current = source.reshape(-1)
            # Values further below the largest than this are indistinguishable from zero.
            end = float(current.max()) + LOG_NOTHING / 2
            for axis in reversed(range(len(self.shape))):
                size = self.shape[axis]
                turned = target.reshape(-1) if axis == 0 else second
                if size > _ENTRIES * self.sigma:
                    turned.reshape(size, -1)[...] = self._log_blur(current.reshape(-1, size)).T
                    current = turned
                    continue
                lines = current.reshape(-1, size)
                shift = lines.max(axis=1, keepdims=True) - HEADROOM
                flushed_exp(lines, shift, first.reshape(-1, size))
                contract(first, turned, self._kernels[size])
                floored_log(turned.reshape(size, -1), shift[:, 0])
                current = turned
            np.copyto(target, LOG_NOTHING, where=target < end)

    def _log_blur(self, lines: NDArray[np.float64]) -> NDArray[np.float64]:
        """Blur long lines, (m, n); one mirror image on each side provides the reflections at walls."""
        size = lines.shape[1]
        log_scale = -float(np.log(_whole_row(self.sigma)))
        # Few lines at a time, because each may need hundreds of temporary arrays.
        result = np.empty_like(lines)
        for few in chunks(len(lines), max(_AT_ONCE // size, 1)):
            some = lines[few]
            if self.boundary == "open":
                result[few] = log_blur(some, self.sigma, log_scale)
            else:
                mirrored = np.concatenate([some[:, ::-1], some, some[:, ::-1]], axis=1)
                result[few] = log_blur(mirrored, self.sigma, log_scale)[:, size : 2 * size]
        return result

    def log_transfer(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Apply the kernel between regions; only their boxes are multiplied, and logs taken only of their elements.

        Parameters and result are those of :meth:`.region.ThroughWholeArrays.log_transfer`.
        """
        first, second, _ = (buffer.reshape(-1) for buffer in self._scratch)
        results = []
        for logs, source, target in zip(columns, sources, targets, strict=True):
            shift = logs.max() - HEADROOM
            current = first[: source.box_cells]
            current.fill(0.0)
            current[source.index_in_box] = flushed_exp(logs, shift)
            spare = [second, first]
            for axis in reversed(range(len(self.shape))):
                kernel = self._kernels[self.shape[axis]][source.box[axis], target.box[axis]]
                turned = spare[0][: current.size // kernel.shape[0] * kernel.shape[1]]
                contract(current, turned, np.asfortranarray(kernel))
                current, spare = turned, spare[::-1]
            values = current[target.index_in_box]
            floored_log(values, shift)
            results.append(values)
        return results

    def coarser(self) -> Grid | None:
        """Return the grid of half the resolution; None where it would be too small.

        A wide kernel keeps its width, so that potentials of the coarser grid are almost right on the finer one; a
        narrow one keeps sigma in cells. :attr:`fall_of_gamma` lies between 1 and 4.
        """
        if any(n % 2 or n < 16 for n in self.shape):
            return None
        return Grid([n // 2 for n in self.shape], self.coarser_sigma, self.boundary)

    def restrict(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Densities on the coarser grid, (k, *shape / 2): means of 2 x 2 x 2 cells, which preserve the mass."""
        split = [size for n in self.shape for size in (n // 2, 2)]
        means = tuple(range(2, 2 * len(self.shape) + 1, 2))
        return columns.reshape(len(columns), *split).mean(axis=means)

    def prolong(self, columns: NDArray[np.float64], region: Region) -> NDArray[np.float64]:
        """Interpolate columns of the coarser grid, (k, *shape / 2), linearly to a region of this one, (k, len)."""
        result = np.empty((len(columns), len(region)), columns.dtype)
        if len(region) < _FEW * region.box_cells:
            # The center of cell i is at (i - 1/2) / 2 in indices of the coarser cells.
            places = np.stack(np.unravel_index(region.index, self.shape)) / 2.0 - 0.25
            for values, target in zip(columns, result, strict=True):
                map_coordinates(values, places, target, order=1, mode="nearest")
            return result
        for values, target in zip(columns, result, strict=True):
            for axis, span in enumerate(region.box):
                # One extra neighbor on both sides; values are constant beyond the outer cells of the grid.
                low = max(span.start // 2 - 1, 0)
                near = values[(slice(None),) * axis + (slice(low, span.stop // 2 + 2),)]
                wanted = slice(span.start - 2 * low, span.stop - 2 * low)
                values = doubled_along(near, axis)[(slice(None),) * axis + (wanted,)]
            np.take(np.ascontiguousarray(values).reshape(-1), region.index_in_box, out=target)
        return result

    def refined(self, support: Region, region: Region) -> Region:
        """Return the cells that refine a region of the coarser grid and a margin of one of its cells.

        The coarse neighbors of these cells all belong to `region`, so that they can be interpolated.
        """
        return Region(support.grown(_MARGIN).inside & region.interior).refined()

    def _columns(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return values.reshape(-1, *self.shape)

    @property
    def _scratch(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Scratch arrays of this thread; page faults make new arrays slower than the computation that fills them."""
        if not hasattr(self._of_thread, "arrays"):
            self._of_thread.arrays = np.empty(self.shape), np.empty(self.shape), np.empty(self.shape)
        return self._of_thread.arrays

    def __getstate__(self) -> dict[str, object]:
        return {name: value for name, value in self.__dict__.items() if name != "_of_thread"}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self._of_thread = threading.local()

    def _blur(self, source: NDArray[np.float64], target: NDArray[np.float64]) -> None:
        """One matrix product per axis; `source` may be the first scratch array, never `target`."""
        _, second, third = self._scratch
        current = source.reshape(-1)
        spare = [second.reshape(-1), third.reshape(-1)]
        for axis in reversed(range(len(self.shape))):
            turned = target.reshape(-1) if axis == 0 else spare[axis % 2]
            contract(current, turned, self._kernels[self.shape[axis]])
            current = turned


def _gaussian(size: int, sigma: float, boundary: Literal["open", "reflecting"]) -> NDArray[np.float64]:
    """Gaussian between the cells of one axis, (size, size) in Fortran order; an untruncated row sums to one."""
    cells = np.arange(size)
    reach = int(np.ceil(40 * sigma))
    kernel = _bell(cells[:, None] - cells, sigma)
    if boundary == "reflecting":
        # Mirror images of the source provide the heat that a wall reflects.
        kernel += _bell(cells[:, None] + cells + 1, sigma)
        for shift in range(2 * size, reach + 2 * size, 2 * size):
            for far in (-shift, shift):
                kernel += _bell(cells[:, None] - cells + far, sigma) + _bell(cells[:, None] + cells + 1 + far, sigma)
    kernel /= _whole_row(sigma)
    kernel[kernel < NEGLIGIBLE] = 0.0
    return np.asfortranarray(kernel)


def _whole_row(sigma: float) -> float:
    reach = int(np.ceil(40 * sigma))
    return float(_bell(np.arange(-reach, reach + 1), sigma).sum())


def _bell(distance: NDArray[np.int64], sigma: float) -> NDArray[np.float64]:
    return np.exp(-(distance**2) / (2.0 * sigma**2))
