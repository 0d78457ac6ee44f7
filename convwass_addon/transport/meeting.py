# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Midpoints of two distributions: displacements to their barycenter from debiased unbalanced plans."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..progress import Control, drained
from .barycenter import Barycenter, barycenter
from .checks import check_pair
from .domain import Domain
from .maps import transport_map
from .sinkhorn import self_balancing

# A registration recomputes its step in every round, so rough plans are sufficient.
_TOLERANCE, _MOST_ITERATIONS = 1e-2, 100
_SELF_TOLERANCE, _MOST_SELF_ITERATIONS = 3e-3, 100


@dataclass(frozen=True)
class Meeting:
    """Displacements of two distributions to their midpoint.

    Attributes
    ----------
    displacements : (2, *shape, d) float64
        Of the elements of the domain, for each of the two distributions, in the units of `positions`.
    solved : Barycenter
        Their barycenter with equal weights; a start for similar problems.
    """

    displacements: NDArray[np.float64]
    solved: Barycenter


def meeting(
    mu0: NDArray[np.float64],
    mu1: NDArray[np.float64],
    domain: Domain,
    reach: float,
    control: Control,
    initial: Barycenter | None = None,
) -> Meeting:
    """Find the displacements of two distributions to their unbalanced barycenter.

    The map of an entropic plan averages over all partners of an element, so it also contracts. The map of each
    distribution's plan to itself contracts in the same way. The displacements are the differences of the two maps, zero
    between equal distributions (A. Feydy, "Geometric data analysis, beyond convolutions", 2020, section 3.2.3).

    Parameters
    ----------
    mu0, mu1 : (*shape,) float64
        Nonnegative densities; each is normalized to mass 1.
    domain : Domain
        Owns the area weights and the heat kernel.
    reach : float
        Distance, in units of the domain, beyond which mass fades in one place and appears in another.
    control : Control
        Stops the work.
    initial : Barycenter, optional
        `solved` of similar distributions on a domain of the same shape, to start from.
    """
    pair = check_pair(mu0, mu1, domain)

    def here() -> NDArray[np.float64]:
        limits = {"tolerance": _SELF_TOLERANCE, "max_iterations": _MOST_SELF_ITERATIONS, "control": control}
        return _maps(drained(self_balancing(pair, domain, **limits)).log_v, domain)

    with ThreadPoolExecutor(1, thread_name_prefix="convwass") as executor:
        # Both take equally long.
        own = executor.submit(here)
        half_way = barycenter(
            pair,
            (0.5, 0.5),
            domain,
            sharpness=1.0,
            reach=reach,
            initial=initial,
            tolerance=_TOLERANCE,
            max_iterations=_MOST_ITERATIONS,
            control=control,
        )
        return Meeting(_maps(half_way.log_v, domain) - own.result(), half_way)


def _maps(log_scalings: NDArray[np.float64], domain: Domain) -> NDArray[np.float64]:
    """Return the transport maps of plans, (p, *shape, d), from the scalings on their target sides, (p, *shape)."""
    return np.stack([transport_map(log_scaling, domain) for log_scaling in log_scalings])
