# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Origins of the matter of a blend: its transport maps to the inputs, computed from the potentials of the solve.

With a Gaussian kernel, the barycentric map of a blend to input i, T_i = H(a w_i y) / H(a w_i), has a closed form in the
potentials: T_i(x) = x + gamma / 2 grad ln H(a w_i)(x). For a solved blend ln H(a w_i) = ln mu - ln v_i / e, where e is
1 if all mass travels. Entropic maps shrink towards the middle of the shapes, all by about the same amount. Since the
matter of a blend lies at the mean of its origins, sum_i alpha_i T_i(x) = x, the mean displacement can be subtracted,
which also removes ln mu:

    T_i(x) = x - gamma / (2 e) grad (ln v_i - sum_j alpha_j ln v_j)(x)

The potentials gamma ln v_i are smooth, so the second finest level of the solve represents them well enough.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from ...transport import Barycenter, Grid
from ...transport.fidelity import fidelity
from ...transport.log_range import LOG_NOTHING
from .blend_solver import SolvedBlend
from .transport_problem import TransportProblem
from .volumes import Lattice

# Interpolated values are valid where known cells have at least this fraction of the weight.
_LEAST_KNOWN = 1e-3


@dataclass(frozen=True)
class PartTransport:
    """The data from which the maps of one part of a blend are computed.

    Attributes
    ----------
    solved : Barycenter
        The solved part.
    grid : Grid
        The finest domain, with the blur that was needed.
    volume : float
        Volume of the part in the blend, in cells.
    reach : float or None
        The reach that the blend was solved with, in cells.
    """

    solved: Barycenter
    grid: Grid
    volume: float
    reach: float | None = None


def part_transports(solved: SolvedBlend, problem: TransportProblem) -> list[PartTransport]:
    """Return the data from which the maps of every part of a blend are computed."""
    return [
        PartTransport(part, problem.lattice.grid(sigma), float(volume), problem.settings.reach)
        for part, sigma, volume in zip(solved.parts, solved.sigmas, solved.volumes, strict=True)
    ]


def blend_origins(
    surface: NDArray[np.float64], parts: Sequence[PartTransport], lattice: Lattice, weights: Sequence[float]
) -> NDArray[np.float32]:
    """Return the points in scene space that the vertices of a blend come from.

    Parameters
    ----------
    surface : (n, 3) float64
        Vertices of the blend in cells of the lattice.
    parts : sequence of PartTransport
        Every vertex follows the part that has most of the mass around it.
    lattice : Lattice
        The grid of the shapes.
    weights : (k,)
        Weights of the blend.

    Returns
    -------
    (k, n, 3) float32
        On or close to the surface of every input as it stands in the scene. Their weighted mean is the vertex. For an
        input of weight 0, which has no map, it is the vertex itself, displaced like the centers of mass.
    """
    alphas = np.asarray(weights, dtype=np.float64)
    moves = np.zeros((len(alphas), *surface.shape))
    owners = _owners(surface, parts)
    for index, part in enumerate(parts):
        own = owners == index
        if own.any():
            moves[np.ix_(part.solved.active, own)] = displacements(surface[own], part)
    moves += surface
    moves *= lattice.spacing
    moves += (lattice.origin + lattice.centers)[:, None]
    return moves.astype(np.float32)


def displacements(points: NDArray[np.float64], part: PartTransport) -> NDArray[np.float64]:
    """Return the displacements from points to their origins, on every input of positive weight.

    Parameters
    ----------
    points : (n, 3) float64
        In cells.
    part : PartTransport
        A part of a blend.

    Returns
    -------
    (k, n, 3) float64
        T_i(x) - x in cells; the weighted mean is zero. Outside the cells where the blend may have mass, the
        displacement is that of the nearest such cell.
    """
    return Displacements.of(part).at(points)


def velocities(origins: NDArray[np.float32], rates: Sequence[float]) -> NDArray[np.float32]:
    """Return the velocities of the vertices of a blend whose weights change.

    Matter moves on straight lines between its origins, sum_i alpha_i T_i, as if the maps were constant in time; they
    are those of the blend at this moment.

    Parameters
    ----------
    origins : (k, n, 3) float32
        From `blend_origins`.
    rates : (k,)
        Change of the weights per unit of time, of sum 0.

    Returns
    -------
    (n, 3) float32
        In scene units per unit of time.
    """
    return np.tensordot(np.asarray(rates, dtype=np.float32), origins, 1)


def _owners(surface: NDArray[np.float64], parts: Sequence[PartTransport]) -> NDArray[np.int64]:
    """Return the index of the part that has most of the mass around every vertex, (n,)."""
    if len(parts) == 1:
        return np.zeros(len(surface), np.int64)
    places = surface.T - 0.5
    masses = [part.volume * map_coordinates(part.solved.density, places, order=1, mode="nearest") for part in parts]
    return np.argmax(masses, axis=0)


@dataclass(frozen=True)
class Displacements:
    """Displacements of a part of a blend, in space or in a plane, without the data that they were computed from.

    Attributes
    ----------
    alphas : (k,) float64
        Weights of the inputs, all positive.
    field : _Field or None
        Displacements to all inputs except the one of the largest weight; None if there is only one input.
    """

    alphas: NDArray[np.float64]
    field: _Field | None

    @classmethod
    def of(cls, part: PartTransport) -> Displacements:
        """Compute displacements from the potentials of a part."""
        alphas = part.solved.weights[part.solved.active]
        others = np.delete(np.arange(len(alphas)), np.argmax(alphas))
        return cls(alphas, _Field.of(part, others) if len(others) else None)

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the displacements of points, (n, d) in cells, to all inputs, (k, n, d)."""
        found = np.zeros((len(self.alphas), *points.shape))
        if self.field is not None:
            # Since the weighted mean is zero, the displacement of the largest weight follows from the others.
            last = int(np.argmax(self.alphas))
            others = np.delete(np.arange(len(self.alphas)), last)
            found[others] = self.field.at(points)
            found[last] = -np.tensordot(self.alphas[others], found[others], 1) / self.alphas[last]
        return found


@dataclass(frozen=True)
class _Field:
    """Displacements on a box of one level of a solve."""

    values: NDArray[np.float64]
    """(k, d, *box), in cells of the finest grid; zero where they are not known."""
    known: NDArray[np.bool_]
    """(*box)"""
    low: NDArray[np.int64]
    """First cell of the box, (d,)."""
    size: float
    """Of the cells, in cells of the finest grid."""

    @classmethod
    def of(cls, part: PartTransport, chosen: NDArray[np.int64]) -> _Field:
        """Differentiate the potentials of some inputs on the second finest level, if there is one."""
        levels, grid = part.solved.levels, part.grid
        size, half_gamma = 1.0, grid.sigma**2
        length = None if part.reach is None else part.reach * grid.spacing
        exponent = fidelity(length, grid.gamma).exponent
        if len(levels) > 1:
            size, half_gamma = 2.0, half_gamma * grid.fall_of_gamma
            exponent = fidelity(length, grid.gamma * grid.fall_of_gamma).exponent
        level = levels[max(len(levels) - 2, 0)]
        alphas = part.solved.weights[part.solved.active]
        solved = (level.log_v > LOG_NOTHING / 2).all(axis=0)
        potentials = level.log_v[chosen] - alphas @ level.log_v
        potentials *= -half_gamma / (size * exponent)
        potentials[:, ~solved] = np.nan
        box = level.region.box
        dense = np.full((len(chosen), *(span.stop - span.start for span in box)), np.nan)
        dense.reshape(len(chosen), -1)[:, level.region.index_in_box] = potentials
        values = np.stack([_slope(dense, axis) for axis in range(1, dense.ndim)], axis=1)
        known = np.isfinite(values).all(axis=(0, 1))
        values[:, :, ~known] = 0.0
        return cls(values, known, np.array([span.start for span in box]), size)

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Interpolate between the centers of known cells, (k, n, 3)."""
        places = (points / self.size - 0.5 - self.low).T
        found = np.empty((len(self.values), *points.shape))
        for values, target in zip(self.values, found, strict=True):
            for axis in range(points.shape[1]):
                target[:, axis] = map_coordinates(values[axis], places, order=1, mode="nearest")
        share = map_coordinates(self.known.astype(np.float32), places, order=1, mode="nearest")
        found /= np.maximum(share, _LEAST_KNOWN)[:, None]
        beyond = share < _LEAST_KNOWN
        if beyond.any() and self.known.any():
            centers = np.argwhere(self.known)
            nearest = centers[cKDTree(centers).query(places.T[beyond])[1]]
            found[:, beyond] = np.moveaxis(self.values[(slice(None), slice(None), *nearest.T)], 1, 2)
        return found


def _slope(values: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Return central differences along an axis; NaN at its ends and next to NaN."""
    slopes = np.full(values.shape, np.nan)
    along, source = np.moveaxis(slopes, axis, 0), np.moveaxis(values, axis, 0)
    along[1:-1] = 0.5 * (source[2:] - source[:-2])
    return slopes
