# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the matter of a blend comes from: its transport maps onto the inputs, read off the potentials of the solve.

The barycentric map of a blend onto input i, T_i = H(a w_i y) / H(a w_i), has with a Gaussian kernel a closed form in
the potentials: T_i(x) = x + gamma / 2 grad ln H(a w_i)(x), and of a solved blend ln H(a w_i) = ln mu - ln v_i / e,
where e is 1 if all mass travels. Entropic maps shrink towards the middle of the shapes. All of them do so by about as
much, and what they share is known: the matter of a blend lies at the mean of where it comes from, sum_i alpha_i T_i(x)
= x. So the mean displacement is taken off, ln mu with it, and

    T_i(x) = x - gamma / (2 e) grad (ln v_i - sum_j alpha_j ln v_j)(x)

The potentials gamma ln v_i are smooth, so the next coarser level of the solve has all there is to know.
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

# Interpolated values count where cells that are known have at least this share of them.
_LEAST_KNOWN = 1e-3


@dataclass(frozen=True)
class PartTransport:
    """What the maps of one part of a blend are read from.

    Attributes
    ----------
    solved : Barycenter
        On the grid.
    grid : Grid
        Its finest domain, with the blur that it needed.
    volume : float
        Of the part in the blend, in cells.
    reach : float or None
        As the blend was solved with, in cells.
    """

    solved: Barycenter
    grid: Grid
    volume: float
    reach: float | None = None


def part_transports(solved: SolvedBlend, problem: TransportProblem) -> list[PartTransport]:
    """Return what the maps of every part of a blend are read from."""
    return [
        PartTransport(part, problem.lattice.grid(sigma), float(volume), problem.settings.reach)
        for part, sigma, volume in zip(solved.parts, solved.sigmas, solved.volumes, strict=True)
    ]


def blend_origins(
    surface: NDArray[np.float64], parts: Sequence[PartTransport], lattice: Lattice, weights: Sequence[float]
) -> NDArray[np.float32]:
    """Places in the scene that the vertices of a blend come from.

    Parameters
    ----------
    surface : (n, 3) float64
        Vertices of the blend in cells of the lattice.
    parts : sequence of PartTransport
        Every vertex goes with the part that has most of the mass about it.
    lattice : Lattice
        Where the cells of the shapes are.
    weights : (k,)
        Of the blend.

    Returns
    -------
    (k, n, 3) float32
        On or a little beside the surface of every input as it stands in the scene. The mean of all, with the weights,
        is the vertex. For an input of weight 0, which no map leads to, it is the vertex itself, moved as the centers of
        mass are.
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
    """How far away matter at some points comes from, on every input of positive weight.

    Parameters
    ----------
    points : (n, 3) float64
        In cells.
    part : PartTransport
        A part of a blend.

    Returns
    -------
    (k, n, 3) float64
        T_i(x) - x in cells; the mean of all, with the weights, is zero. Beyond the cells where the blend may have mass
        it is that of the nearest of them.
    """
    return Displacements.of(part).at(points)


def velocities(origins: NDArray[np.float32], rates: Sequence[float]) -> NDArray[np.float32]:
    """Velocities of the vertices of a blend whose weights change.

    Matter moves on straight lines between the places that it comes from, sum_i alpha_i T_i, as if the maps stayed; they
    are those of the blend at this moment, and the matter at a vertex keeps its own.

    Parameters
    ----------
    origins : (k, n, 3) float32
        As `blend_origins` gives them.
    rates : (k,)
        Change of the weights per unit of time, of sum 0.

    Returns
    -------
    (n, 3) float32
        In scene units per unit of time.
    """
    return np.tensordot(np.asarray(rates, dtype=np.float32), origins, 1)


def _owners(surface: NDArray[np.float64], parts: Sequence[PartTransport]) -> NDArray[np.int64]:
    """Index of the part that has most of the mass about every vertex, (n,)."""
    if len(parts) == 1:
        return np.zeros(len(surface), np.int64)
    places = surface.T - 0.5
    masses = [part.volume * map_coordinates(part.solved.density, places, order=1, mode="nearest") for part in parts]
    return np.argmax(masses, axis=0)


@dataclass(frozen=True)
class Displacements:
    """Displacements of a part of a blend, in space or in a plane, without what they were read from.

    Attributes
    ----------
    alphas : (k,) float64
        Weights of the inputs, all positive.
    field : _Field or None
        Those onto all inputs but the one of the largest weight; None where there is one input only.
    """

    alphas: NDArray[np.float64]
    field: _Field | None

    @classmethod
    def of(cls, part: PartTransport) -> Displacements:
        """Read them off the potentials of a part."""
        alphas = part.solved.weights[part.solved.active]
        others = np.delete(np.arange(len(alphas)), np.argmax(alphas))
        return cls(alphas, _Field.of(part, others) if len(others) else None)

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Look up the displacements of points, (n, d) in cells, onto all inputs, (k, n, d)."""
        found = np.zeros((len(self.alphas), *points.shape))
        if self.field is not None:
            # The mean of all is known to be zero: what is hardest to tell from it is had from the others.
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
        """Differentiate the potentials of some of the inputs on the level before the finest, if there is one."""
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
        """Interpolate between the centers of cells that are known, (k, n, 3)."""
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
    """Central differences along an axis; not a number at its ends, and next to what is not."""
    slopes = np.full(values.shape, np.nan)
    along, source = np.moveaxis(slopes, axis, 0), np.moveaxis(values, axis, 0)
    along[1:-1] = 0.5 * (source[2:] - source[:-2])
    return slopes
