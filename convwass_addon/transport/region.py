# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsets of a domain: solvers keep values only where a distribution can have mass."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from math import prod

import numpy as np
from numpy.typing import NDArray

from ..geometry.grids.boxes import Box, box_around
from ..geometry.grids.dilation import dilated
from .log_range import LOG_NOTHING


class Region:
    """Some elements of a domain, in the order of their flat indices.

    Parameters
    ----------
    inside : ndarray of bool, the domain's shape
        True at the elements of the region; at least one.
    """

    def __init__(self, inside: NDArray[np.bool_]) -> None:
        self.inside = inside

    @classmethod
    def whole(cls, shape: tuple[int, ...]) -> Region:
        """All elements of a domain."""
        return cls(np.ones(shape, bool))

    def __len__(self) -> int:
        return len(self.index)

    @cached_property
    def index(self) -> NDArray[np.int64]:
        """Flat indices of the elements, (len,), ascending."""
        return np.flatnonzero(self.inside)

    @cached_property
    def is_whole(self) -> bool:
        """Whether the region has all elements."""
        return len(self.index) == self.inside.size

    @cached_property
    def box(self) -> Box:
        """The smallest box of the array that holds all elements."""
        return box_around(self.inside, 0)

    @property
    def box_cells(self) -> int:
        """Number of elements in the box, including those outside the region."""
        return prod(span.stop - span.start for span in self.box)

    @cached_property
    def index_in_box(self) -> NDArray[np.int64]:
        """Flat indices of the elements within their box, (len,)."""
        return np.flatnonzero(self.inside[self.box])

    def gather(self, values: NDArray) -> NDArray:
        """Values at the elements, (..., len), of arrays (..., *shape)."""
        leading = values.shape[: values.ndim - self.inside.ndim]
        return values.reshape(*leading, -1)[..., self.index]

    def scatter(self, values: NDArray, fill: float) -> NDArray:
        """Arrays (..., *shape) with `values`, (..., len), at the elements and `fill` elsewhere."""
        dense = np.full((*values.shape[:-1], self.inside.size), fill, values.dtype)
        dense[..., self.index] = values
        return dense.reshape(*values.shape[:-1], *self.inside.shape)

    def transferred(self, values: NDArray, other: Region, fill: float) -> NDArray:
        """Values at the elements of `other`, (..., len(other)): those known here, `fill` elsewhere."""
        if other is self:
            return values
        place = np.full(self.inside.size, -1, np.int32)
        place[self.index] = np.arange(len(self), dtype=np.int32)
        place = place[other.index]
        result = values[..., place]
        result[..., place < 0] = fill
        return result

    def grown(self, cells: int) -> Region:
        """Return the region and all elements of the grid that this many steps across faces reach from it."""
        return Region(dilated(self.inside, cells))

    def refined(self) -> Region:
        """Return the same subset of the grid of twice the resolution."""
        inside = self.inside
        for axis in range(inside.ndim):
            inside = np.repeat(inside, 2, axis)
        return Region(inside)

    @cached_property
    def interior(self) -> NDArray[np.bool_]:
        """Mask, of the grid's shape, of elements whose neighbors, including diagonal ones, all lie in the region."""
        if self.is_whole:
            return self.inside
        interior = self.inside
        for axis in range(interior.ndim):
            # Erode by three cells along one axis after the other; the border of the grid does not erode.
            around = np.moveaxis(interior, axis, 0)
            eroded = around.copy()
            eroded[1:] &= around[:-1]
            eroded[:-1] &= around[1:]
            interior = np.moveaxis(eroded, 0, axis)
        return interior


class ThroughWholeArrays:
    """A domain that applies its kernel to all elements even if only some are needed."""

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) of every column, (k, *shape), to `out`; see :class:`.domain.Domain`."""
        raise NotImplementedError

    def log_apply_far(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Like :meth:`log_apply`, slower but with a longer range."""
        raise NotImplementedError

    def log_transfer(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Apply the kernel between regions, on whole arrays.

        Parameters
        ----------
        columns : sequence of (len(source),) float64
            Logarithms of scalings.
        sources, targets : sequence of Region
            The elements on which every column is given and its result returned.

        Returns
        -------
        list of (len(target),) float64
            log H (a * exp(column)), accurate or `LOG_NOTHING`.
        """
        return _through_whole_arrays(self.log_apply, columns, sources, targets)

    def log_transfer_far(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Like :meth:`log_transfer`, by :meth:`log_apply_far`."""
        return _through_whole_arrays(self.log_apply_far, columns, sources, targets)


def _through_whole_arrays(
    log_apply: Callable[[NDArray[np.float64], NDArray[np.float64]], None],
    columns: Sequence[NDArray[np.float64]],
    sources: Sequence[Region],
    targets: Sequence[Region],
) -> list[NDArray[np.float64]]:
    """Apply a domain's kernel to all elements, in logarithms, and return the values on the targets."""
    dense = np.stack([source.scatter(logs, LOG_NOTHING) for logs, source in zip(columns, sources, strict=True)])
    log_apply(dense, dense)
    return [target.gather(logs) for logs, target in zip(dense, targets, strict=True)]
