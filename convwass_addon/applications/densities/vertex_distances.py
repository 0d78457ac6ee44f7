# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geodesic distances along a surface from given vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...geometry.arrays.chunks import chunks
from ...progress import UNINTERRUPTED, Control
from ...sentence import Sentence
from ...transport import Surface, point_distances
from ..workers import one_blas_thread
from .density_tools import check_vertices
from .surface_densities import HeatMap, blur_of, heat_map

VALUES_AT_ONCE = 1 << 22
"""Number of values solved together, 32 MB: sources times vertices."""


@dataclass(frozen=True)
class VertexDistances:
    """Distances from given vertices to all vertices.

    Attributes
    ----------
    lengths : (n,) float64
        In scene units, to the nearest source; infinite for unreachable vertices.
    notices : tuple of Sentence
        Why some are infinite, with the numbers of vertices.
    """

    lengths: NDArray[np.float64]
    notices: tuple[Sentence, ...]

    def heat_map(self) -> HeatMap:
        """Return weights proportional to the distance; 1 at the farthest reachable vertex and at unreachable ones."""
        reached = np.isfinite(self.lengths)
        far = float(self.lengths[reached].max(initial=0.0))
        return heat_map(np.where(reached, self.lengths, far))


def distances_from(vertices: ArrayLike, surface: Surface, control: Control = UNINTERRUPTED) -> VertexDistances:
    """Measure the distances along the surface from the nearest of some vertices to all (Fig. 3 of the paper).

    Parameters
    ----------
    vertices : int or (k,) int
        The sources.
    surface : Surface
        Its blur determines how far float64 reaches: a wider blur reaches farther.
    control : Control
        Stops the work when cancelled.

    Raises
    ------
    InputError
        No vertices, invalid indices, or loose vertices.
    """
    chosen = np.unique(np.atleast_1d(np.asarray(vertices)))
    check_vertices(chosen, surface)
    nearest = np.full(surface.shape, np.inf)
    for some in chunks(len(chosen), max(1, VALUES_AT_ONCE // surface.shape[0])):
        control.check()
        with one_blas_thread():
            found = point_distances(chosen[some], surface)
        np.minimum(nearest, found.min(axis=0), out=nearest)
    return VertexDistances(nearest, tuple(_unreached(nearest, chosen, surface)))


def _unreached(lengths: NDArray[np.float64], sources: NDArray[np.int64], surface: Surface) -> Iterator[Sentence]:
    """Explain why vertices are unreachable."""
    lost = ~np.isfinite(lengths)
    loose = lost & (surface.weights == 0)
    apart = np.zeros_like(lost)
    if surface.pieces is not None:
        apart = lost & ~loose & ~np.isin(surface.pieces, surface.pieces[sources])
    far = lost & ~loose & ~apart
    if loose.any():
        yield Sentence("Loose vertices, which belong to no face: {count}.", {"count": int(loose.sum())})
    if apart.any():
        pieces = len(np.unique(surface.pieces[apart]))
        counts = {"count": int(apart.sum()), "pieces": pieces}
        yield Sentence(
            "Vertices on other pieces of the mesh, which no face connects: {count}, in {pieces} pieces.", counts
        )
    if far.any():
        values = {"count": int(far.sum()), "blur": blur_of(surface)}
        yield Sentence("Vertices too far away for a blur of {blur:.3g}: {count}. A longer one reaches them.", values)
