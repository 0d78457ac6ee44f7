# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement interpolation: by weighted barycenters of the ends, or by recursive bisection."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .barycenter import barycenter
from .checks import check_entropy_limit, check_pair, check_sharpness, check_solver
from .distance import distance
from .domain import Domain
from .inputs import Inputs
from .propagation import Propagation, propagate
from .sharpening import entropy
from .sinkhorn import Monitor


@dataclass(frozen=True)
class Interpolation:
    """Distributions on the way from one to another.

    Attributes
    ----------
    times : (f,) float64
        In [0, 1].
    densities : (f, *shape) float64
        Mass 1; the ends themselves at times 0 and 1.
    entropies : (f,) float64
        In nats.
    marginal_errors : (f,) float64
        Of every frame's solve; 0 for the ends.
    converged : (f,) bool
        Whether the frame's solve has reached the tolerance.
    iterations : tuple of int
        Per frame for weighted barycenters, per level for bisection.
    numerics : str
        "scaling", or the domain's far_numerics if any frame needed it.
    """

    times: NDArray[np.float64]
    densities: NDArray[np.float64]
    entropies: NDArray[np.float64]
    marginal_errors: NDArray[np.float64]
    converged: NDArray[np.bool_]
    iterations: tuple[int, ...]
    numerics: str


def interpolate(
    mu0: ArrayLike,
    mu1: ArrayLike,
    times: ArrayLike,
    domain: Domain,
    *,
    sharpness: float = 0.0,
    entropy_limit: Literal["max"] | float | None = None,
    tolerance: float = 1e-2,
    max_iterations: int = 500,
    monitor: Monitor | None = None,
) -> Interpolation:
    """Interpolate by barycenters of the two ends, eq. (16), each started from the one before.

    The weights are (1 - t, t) where the kernel's cost is quadratic. On meshes the cost of long ways turns linear, with
    which (1 - t, t) would lag near the ends; there the weights are those for which mass that goes the whole distance is
    at t: (c'((1 - t) D), c'(t D)) up to their sum, c' the slope of the cost and D the distance of the ends.
    :func:`bisect` gets the place of the mass right without a formula, and keeps it sharper.

    Parameters
    ----------
    mu0, mu1 : domain.shape
        Densities, not negative; each is normalized to mass 1.
    times : (f,)
        In [0, 1], in any order.
    domain, sharpness, entropy_limit, tolerance, max_iterations, monitor
        As in :func:`barycenter`.

    Returns
    -------
    Interpolation
        In the order of `times`.

    Raises
    ------
    ValueError
        Distributions or parameters that make no sense; the message names the argument.
    KernelTooNarrowError
        gamma is too small for numerics of any kind to get from one distribution to the other.
    """
    ends = check_pair(mu0, mu1, domain)
    instants = _instants(times)
    check_sharpness(sharpness)
    check_entropy_limit(entropy_limit)
    check_solver(tolerance, max_iterations)
    shares = _shares(instants, ends, domain, max_iterations, monitor)
    inputs = Inputs.of(ends, domain)
    frames: list[_Frame] = []
    before = None
    for t, share in zip(instants, shares, strict=True):
        if t in (0.0, 1.0):
            frames.append(_Frame(ends[int(t)], 0.0, True, 0, "scaling"))
            continue
        before = barycenter(
            inputs,
            [1.0 - share, share],
            domain,
            sharpness=sharpness,
            entropy_limit=entropy_limit,
            initial=before,
            tolerance=tolerance,
            max_iterations=max_iterations,
            monitor=monitor,
        )
        error = max(before.marginal_error, before.debias_error)
        frames.append(_Frame(before.density, error, before.converged, sum(before.iterations), before.numerics))
    return Interpolation(
        times=instants,
        densities=np.stack([frame.density for frame in frames]),
        entropies=np.array([entropy(frame.density, domain.weights) for frame in frames]),
        marginal_errors=np.array([frame.error for frame in frames]),
        converged=np.array([frame.converged for frame in frames]),
        iterations=tuple(frame.iterations for frame in frames),
        numerics=_furthest(frames),
    )


def bisect(
    mu0: ArrayLike,
    mu1: ArrayLike,
    domain: Domain,
    *,
    levels: int = 5,
    times: ArrayLike | None = None,
    entropy_limit: Literal["max"] | float | None = "max",
    tolerance: float = 1e-2,
    max_iterations: int = 500,
    monitor: Monitor | None = None,
) -> Interpolation:
    """Interpolate by recursive bisection: every new frame is the midpoint of its two neighbors.

    Only equal weights are used, and every hop is half as long as the one before, so that the mass is where transport
    puts it although the cost of a mesh's kernel turns linear far away. All midpoints of a level are solved together.

    Parameters
    ----------
    mu0, mu1 : domain.shape
        Densities, not negative; each is normalized to mass 1.
    domain : Domain
        Owns the area weights and the heat kernel.
    levels : int
        Frames at the multiples of 1 / 2^levels.
    times : (f,), optional
        Other times to return instead, in [0, 1]; each is a barycenter of the two frames next to it.
    entropy_limit : "max", None or float
        Bound for the entropy of every new frame in nats; "max" takes the larger of its two neighbors', without which
        the blur of every level would add up.
    tolerance, max_iterations, monitor
        As in :func:`propagate`.

    Returns
    -------
    Interpolation
        In the order of `times`, or of time.

    Raises
    ------
    ValueError
        Distributions or parameters that make no sense; the message names the argument.
    KernelTooNarrowError
        gamma is too small for numerics of any kind to get from one distribution to the other.

    Notes
    -----
    A bound makes one bump of what the blur of a level joins: distributions of several peaks need a gamma that keeps the
    peaks apart, or no bound. Where two ways are equally long, frames may not converge, and say so.
    """
    ends = check_pair(mu0, mu1, domain)
    check_entropy_limit(entropy_limit)
    check_solver(tolerance, max_iterations)
    if levels < 1 or levels != int(levels):
        raise ValueError(f"levels must be a positive whole number, got {levels}")
    wanted = None if times is None else _instants(times)
    solver = _Midpoints(domain, entropy_limit, tolerance, max_iterations, monitor)
    path = _Path(np.array([0.0, 1.0]), ends, np.zeros(2), np.ones(2, bool))
    solves: list[Propagation] = []
    for _ in range(levels):
        middles = 0.5 * (path.times[:-1] + path.times[1:])
        path, solved = solver.inserted(path, middles)
        solves.append(solved)
    if wanted is not None:
        missing = np.setdiff1d(wanted, path.times)
        if len(missing):
            path, solved = solver.inserted(path, missing)
            solves.append(solved)
        path = path.selected(np.searchsorted(path.times, wanted))
    return Interpolation(
        times=path.times,
        densities=path.densities,
        entropies=np.array([entropy(mu, domain.weights) for mu in path.densities]),
        marginal_errors=path.errors,
        converged=path.converged,
        iterations=tuple(solved.iterations for solved in solves),
        numerics=_furthest(solves),
    )


@dataclass(frozen=True)
class _Frame:
    """One frame of an interpolation and how well it was solved."""

    density: NDArray[np.float64]
    error: float
    converged: bool
    iterations: int
    numerics: str


@dataclass(frozen=True)
class _Path:
    """Frames in the order of time."""

    times: NDArray[np.float64]
    densities: NDArray[np.float64]
    errors: NDArray[np.float64]
    converged: NDArray[np.bool_]

    def selected(self, order: NDArray[np.int64]) -> _Path:
        return _Path(self.times[order], self.densities[order], self.errors[order], self.converged[order])


@dataclass(frozen=True)
class _Midpoints:
    """What stays the same from level to level."""

    domain: Domain
    entropy_limit: Literal["max"] | float | None
    tolerance: float
    max_iterations: int
    monitor: Monitor | None

    def inserted(self, path: _Path, times: NDArray[np.float64]) -> tuple[_Path, Propagation]:
        """Put frames between their neighbors in time, all of them in one propagation over separate parts of a graph.

        Frames at `times` are vertices count, count + 1, ... after the known ones.
        """
        known = len(path.times)
        right = np.searchsorted(path.times, times)
        share = (times - path.times[right - 1]) / (path.times[right] - path.times[right - 1])
        new = known + np.arange(len(times))
        edges = np.concatenate([np.stack([right - 1, new], 1), np.stack([new, right], 1)])
        solved = propagate(
            edges,
            np.concatenate([1.0 - share, share]),
            dict(enumerate(path.densities)),
            self.domain,
            entropy_limit=self._limits(path, right),
            tolerance=self.tolerance,
            max_iterations=self.max_iterations,
            monitor=self.monitor,
        )
        whole = _Path(
            np.concatenate([path.times, times]),
            solved.densities,
            np.concatenate([path.errors, solved.marginal_errors[known:]]),
            np.concatenate([path.converged, solved.converged[known:]]),
        )
        return whole.selected(np.argsort(whole.times)), solved

    def _limits(self, path: _Path, right: NDArray[np.int64]) -> NDArray[np.float64] | float | None:
        if self.entropy_limit != "max":
            return self.entropy_limit
        entropies = np.array([entropy(mu, self.domain.weights) for mu in path.densities])
        return np.concatenate([entropies, np.maximum(entropies[right - 1], entropies[right])])


def _shares(
    instants: NDArray[np.float64],
    ends: NDArray[np.float64],
    domain: Domain,
    max_iterations: int,
    monitor: Monitor | None,
) -> NDArray[np.float64]:
    """Weights of the second end for which mass on its way is at `instants`."""
    if domain.has_quadratic_cost:
        return instants
    # The weights change slowly with the distance, so that a rough one will do.
    whole = distance(ends[0], ends[1], domain, tolerance=1e-3, max_iterations=max_iterations, monitor=monitor)
    length = max(whole.length / domain.unit_length, np.sqrt(domain.gamma) * 1e-3)
    done, left = domain.cost_slope(instants * length), domain.cost_slope((1.0 - instants) * length)
    return done / (done + left)


def _furthest(solves: Sequence[_Frame | Propagation]) -> str:
    """Numerics of the first solve that needed other than scalings."""
    return next((solved.numerics for solved in solves if solved.numerics != "scaling"), "scaling")


def _instants(times: ArrayLike) -> NDArray[np.float64]:
    instants = np.asarray(times, dtype=np.float64)
    if instants.ndim != 1 or not len(instants):
        raise ValueError(f"times must be a list of numbers, got shape {instants.shape}")
    if not ((instants >= 0) & (instants <= 1)).all():
        raise ValueError("times must lie between 0 and 1")
    return instants
