# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement interpolation by weighted barycenters of the two ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..one_line import one_line
from ..progress import UNINTERRUPTED, Control
from .barycenter import barycenter
from .checks import check_entropy_limit, check_pair, check_sharpness, check_solver
from .distance import distance
from .domain import Domain
from .inputs import Inputs
from .sharpening import entropy


@dataclass(frozen=True)
class Interpolation:
    """Distributions on the path from one to another.

    Attributes
    ----------
    times : (f,) float64
        In [0, 1].
    densities : (f, *shape) float64
        Mass 1 under the area weights; the ends themselves at times 0 and 1.
    entropies : (f,) float64
        In nats.
    marginal_errors : (f,) float64
        Of every frame; 0 for the two ends.
    converged : (f,) bool
        Whether the frame's solve reached the tolerance.
    raised_limits : (f,) float64
        Nats by which the frame's entropy bound was raised, because it did not converge otherwise.
    iterations : tuple of int
        Per frame for weighted barycenters, per level for bisection.
    numerics : str
        "scaling", or the domain's far_numerics if any frame needed it.
    areas : float or (*shape) float64
        The area weights of the domain, of sum 1.
    """

    times: NDArray[np.float64]
    densities: NDArray[np.float64]
    entropies: NDArray[np.float64]
    marginal_errors: NDArray[np.float64]
    converged: NDArray[np.bool_]
    raised_limits: NDArray[np.float64]
    iterations: tuple[int, ...]
    numerics: str
    areas: float | NDArray[np.float64]

    __repr__ = one_line("densities", "times", "iterations", "marginal_errors")

    @property
    def masses(self) -> NDArray[np.float64]:
        """The distributions as histograms, (f, *shape), each of sum 1."""
        return self.densities * self.areas

    @classmethod
    def of(
        cls,
        times: NDArray[np.float64],
        frames: Sequence[SolvedFrame],
        iterations: tuple[int, ...],
        numerics: Sequence[str],
        areas: float | NDArray[np.float64],
    ) -> Interpolation:
        """Combine frames, one per time; `numerics` lists those of all solves."""
        return cls(
            times=times,
            densities=np.stack([frame.density for frame in frames]),
            entropies=np.array([frame.entropy for frame in frames]),
            marginal_errors=np.array([frame.error for frame in frames]),
            converged=np.array([frame.converged for frame in frames]),
            raised_limits=np.array([frame.raised for frame in frames]),
            iterations=iterations,
            numerics=next((name for name in numerics if name != "scaling"), "scaling"),
            areas=areas,
        )


@dataclass(frozen=True)
class SolvedFrame:
    """One frame and how well it was solved; `raised` is the number of nats by which its entropy bound was raised."""

    density: NDArray[np.float64]
    entropy: float
    error: float = 0.0
    converged: bool = True
    raised: float = 0.0
    numerics: str = "scaling"


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
    control: Control = UNINTERRUPTED,
) -> Interpolation:
    """Interpolate by barycenters of the two ends, eq. (16), each started from the one before.

    The weights are (1 - t, t) where the kernel's cost is quadratic. On meshes the cost of long distances becomes
    linear, and these weights would make the mass lag near the ends. There the weights put mass that travels the whole
    distance in the right place at t: they are proportional to (c'((1 - t) D), c'(t D)), with c' the slope of the cost
    and D the distance of the ends. :func:`.bisect` puts the mass in the right place without a formula, and keeps it
    sharper.

    Parameters
    ----------
    mu0, mu1 : domain.shape
        Nonnegative densities; each is normalized to mass 1.
    times : (f,)
        In [0, 1], in any order.
    domain, sharpness, entropy_limit, tolerance, max_iterations, control
        As in :func:`barycenter`.

    Returns
    -------
    Interpolation
        In the order of `times`.

    Raises
    ------
    ValueError
        Invalid distributions or parameters; the message names the argument.
    KernelTooNarrowError
        gamma is too small for any of the numerics to reach from one distribution to the other.
    """
    ends = check_pair(mu0, mu1, domain)
    instants = check_times(times)
    check_sharpness(sharpness)
    check_entropy_limit(entropy_limit)
    check_solver(tolerance, max_iterations)
    shares = _shares(instants, ends, domain, max_iterations, control)
    inputs = Inputs.of(ends, domain)
    frames: list[SolvedFrame] = []
    iterations: list[int] = []
    before = None
    for t, share in zip(instants, shares, strict=True):
        if t in (0.0, 1.0):
            end = ends[int(t)]
            frames.append(SolvedFrame(end, entropy(end, domain.weights)))
            iterations.append(0)
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
            control=control,
        )
        own = entropy(before.density, domain.weights)
        frames.append(SolvedFrame(before.density, own, before.marginal_error, before.converged, 0.0, before.numerics))
        iterations.append(sum(before.iterations))
    return Interpolation.of(instants, frames, tuple(iterations), [frame.numerics for frame in frames], domain.weights)


def _shares(
    instants: NDArray[np.float64],
    ends: NDArray[np.float64],
    domain: Domain,
    max_iterations: int,
    control: Control,
) -> NDArray[np.float64]:
    """Weights of the second end that put travelling mass in the right place at `instants`."""
    if domain.has_quadratic_cost:
        return instants
    # The weights change slowly with the distance, so a rough distance is enough.
    whole = distance(ends[0], ends[1], domain, tolerance=1e-3, max_iterations=max_iterations, control=control)
    length = max(whole.length / domain.unit_length, np.sqrt(domain.gamma) * 1e-3)
    done, left = domain.cost_slope(instants * length), domain.cost_slope((1.0 - instants) * length)
    return done / (done + left)


def check_times(times: ArrayLike) -> NDArray[np.float64]:
    """Return times as float64, (f,).

    Raises
    ------
    ValueError
        Not a list of numbers, or some outside [0, 1].
    """
    instants = np.asarray(times, dtype=np.float64)
    if instants.ndim != 1 or not len(instants):
        raise ValueError(f"times must be a list of numbers, got shape {instants.shape}")
    if not ((instants >= 0) & (instants <= 1)).all():
        raise ValueError("times must lie between 0 and 1")
    return instants
