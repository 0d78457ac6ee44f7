# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wasserstein distances along a surface, between two densities or all pairs of several."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ...transport import Surface
from ...transport.distance import distance_matrix_rounds, distance_rounds
from ...transport.pieces import piece_masses
from .density_pieces import SAME_SHARE, on_same_pieces
from .density_preparing import preparing
from .density_solving import solving
from .surface_densities import distribution

MEASURING_SUBSTEPS = 20
"""Number of substeps for distances accurate to a few percent (tests/applications/test_density_measures.py);
interpolations need only 10."""


@dataclass(frozen=True)
class DensityDistance:
    """A distance between two densities and how accurately it was solved.

    Attributes
    ----------
    length : float
        The Wasserstein distance W2 in scene units.
    squared : float
        Its square. For the undebiased value of eq. (10) this may be negative; `length` is 0 then.
    debiased : bool
        Whether the distance vanishes between equal densities; otherwise `squared` is the value of eq. (10).
    iterations : int
        Iterations of the solver.
    marginal_error : float
        The largest over all plans.
    converged : bool
        Whether the marginal error is below the tolerance.
    numerics : str
        Name of the numerics used.
    """

    length: float
    squared: float
    debiased: bool
    iterations: int
    marginal_error: float
    converged: bool
    numerics: str


@dataclass(frozen=True)
class DistanceTable:
    """Distances between all pairs of densities.

    Attributes
    ----------
    names : tuple of str
        Names of the densities.
    lengths : (k, k) float64
        In scene units, symmetric, zero on the diagonal; infinite between densities on different components.
    iterations : int
        Iterations of the slowest pair.
    marginal_error : float
        The largest over all plans.
    converged : bool
        Whether the marginal error is below the tolerance.
    notices : tuple of Sentence
        Why some distances are infinite.
    """

    names: tuple[str, ...]
    lengths: NDArray[np.float64]
    iterations: int
    marginal_error: float
    converged: bool
    notices: tuple[Sentence, ...]


def measuring_steps(
    first: ArrayLike,
    second: ArrayLike,
    surface: Surface,
    names: tuple[str, str],
    *,
    debias: bool = True,
    match_pieces: bool = False,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    control: Control = UNINTERRUPTED,
) -> Work[DensityDistance]:
    """Measure the Wasserstein distance between two densities (Algorithm 1).

    Parameters
    ----------
    first, second : (n,)
        Painted weights, or densities.
    surface : Surface
        With `MEASURING_SUBSTEPS` substeps for an accurate distance.
    names : (str, str)
        Names of the densities for messages.
    debias : bool
        Whether to remove the kernel's blur from the value; otherwise it is the value of eq. (10).
    match_pieces : bool
        Whether to match the masses on connected components; see :func:`.density_pieces.on_same_pieces`.
    tolerance, max_iterations
        As in :func:`.transport.distance`.
    control : Control
        Stops the solve when cancelled.

    Yields
    ------
    Progress
        After every round.

    Returns
    -------
    DensityDistance

    Raises
    ------
    InputError
        Invalid weights, or weights on different components.
    """
    pair = np.stack([distribution(w, surface, name) for w, name in zip((first, second), names, strict=True)])
    pair = on_same_pieces(pair, names, surface, match_pieces)
    yield from preparing(surface)
    message = Sentence("From {first} to {second}", {"first": names[0], "second": names[1]})
    yield Progress(0.0, message)
    rounds = distance_rounds(
        pair[0],
        pair[1],
        surface,
        debias=debias,
        tolerance=tolerance,
        max_iterations=max_iterations,
        control=control,
    )
    found = yield from within(solving(rounds, surface, names), 0.0, 1.0, message)
    figures = found.iterations, found.marginal_error, found.converged, found.numerics
    return DensityDistance(found.length, found.value, debias, *figures)


def distance_table_steps(
    weights: Sequence[ArrayLike],
    names: Sequence[str],
    surface: Surface,
    *,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    control: Control = UNINTERRUPTED,
) -> Work[DistanceTable]:
    """Measure the debiased distances between all pairs of densities; parameters are those of :func:`measuring_steps`.

    Densities between which no mass can travel are at infinite distance.

    Raises
    ------
    InputError
        Fewer than two densities, or invalid weights.
    """
    if len(weights) < 2:
        raise InputError("There must be at least two groups to measure between; paint one more.")
    densities = np.stack([distribution(w, surface, name) for w, name in zip(weights, names, strict=True)])
    lengths = np.full((len(densities), len(densities)), np.inf)
    np.fill_diagonal(lengths, 0.0)
    iterations, error, converged = 0, 0.0, True
    families = _comparable_groups(densities, surface)
    message = Sentence("Between {count} groups", {"count": len(names)})
    yield Progress(0.0, message)
    done, total = 0, sum(len(family) * (len(family) - 1) // 2 for family in families)
    for family in families:
        own = [names[i] for i in family]
        if len(family) == 1:
            continue
        alike = on_same_pieces(densities[family], own, surface)
        rounds = distance_matrix_rounds(
            alike, surface, tolerance=tolerance, max_iterations=max_iterations, control=control
        )
        pairs = len(family) * (len(family) - 1) // 2
        begin, end = done / total, (done + pairs) / total
        found = yield from within(solving(rounds, surface, own), begin, end, message)
        done += pairs
        lengths[np.ix_(family, family)] = np.sqrt(np.maximum(found.values, 0.0))
        iterations, error = max(iterations, found.iterations), max(error, found.marginal_error)
        converged &= found.converged
    notices = ()
    if len(families) > 1:
        groups = "; ".join(", ".join(names[i] for i in family) for family in families)
        notices = (
            Sentence(
                "Only groups with equal shares on the pieces of the mesh have distances: {groups}.",
                {"groups": groups},
            ),
        )
    return DistanceTable(tuple(names), lengths, iterations, error, converged, notices)


def _comparable_groups(densities: NDArray[np.float64], surface: Surface) -> list[list[int]]:
    """Group densities that have the same mass on every component as the first of their group."""
    masses = piece_masses(densities, surface)
    families: list[list[int]] = []
    for index in range(len(densities)):
        for family in families:
            first = masses[family[0]]
            if np.abs(first - masses[index]).max() <= SAME_SHARE:
                family.append(index)
                break
        else:
            families.append([index])
    return families
