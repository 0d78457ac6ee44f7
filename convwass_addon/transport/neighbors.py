# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters solved from the potentials of others with similar weights: a few rounds at the finest level."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..progress import UNINTERRUPTED, Control
from .barycenter import Barycenter, barycenter
from .inputs import Inputs
from .log_range import LOG_NOTHING
from .potentials import Potentials
from .region import Region


def barycenter_between(
    first: Barycenter,
    second: Barycenter,
    share: float,
    inputs: Inputs,
    *,
    sharpness: float | None = None,
    entropy_limit: Literal["max"] | float | None = None,
    reach: float | None = None,
    tolerance: float = 1e-2,
    debias_tolerance: float | None = None,
    max_iterations: int = 100,
    numerics: Literal["automatic", "scaling"] = "automatic",
    control: Control = UNINTERRUPTED,
) -> Barycenter:
    """Barycenter whose weights lie between those of two others, without solving from coarse to fine.

    The potentials gamma ln v_i are smooth functions of the weights, so interpolated potentials are nearly right (while
    interpolated densities would be a cross-fade). One or two rounds remove the remaining error.

    Parameters
    ----------
    first, second : Barycenter
        Barycenters of the same inputs, with the same inputs at weight zero, and at most a few cells of motion apart.
    share : float
        0 is `first`, 1 is `second`; weights are interpolated.
    inputs : Inputs
        Their inputs.
    sharpness : float, optional
        By default interpolated as well.
    entropy_limit, reach, tolerance, debias_tolerance, max_iterations, numerics, control
        As for :func:`barycenter`.

    Raises
    ------
    ValueError
        Barycenters of other inputs, or a share outside [0, 1].
    """
    if not 0.0 <= share <= 1.0:
        raise ValueError(f"share must lie between 0 and 1, got {share}")
    _check_inputs("first", first, inputs)
    _check_inputs("second", second, inputs)
    if not np.array_equal(first.active, second.active):
        raise ValueError("second must give weight to the inputs that first does")
    mixed = _mixed(first.levels[-1], second.levels[-1], share)
    return barycenter(
        Inputs(inputs.levels[-1:], inputs.entropies),
        (1.0 - share) * first.weights + share * second.weights,
        inputs.domain,
        sharpness=(1.0 - share) * first.sharpness + share * second.sharpness if sharpness is None else sharpness,
        entropy_limit=entropy_limit,
        reach=reach,
        initial=replace(first, levels=(mixed,)),
        tolerance=tolerance,
        debias_tolerance=debias_tolerance,
        max_iterations=max_iterations,
        numerics=numerics,
        control=control,
    )


def barycenter_from_neighbor(
    neighbor: Barycenter,
    weights: Sequence[float] | NDArray[np.float64],
    inputs: Inputs,
    *,
    sharpness: float,
    entropy_limit: Literal["max"] | float | None = None,
    reach: float | None = None,
    tolerance: float = 1e-2,
    debias_tolerance: float | None = None,
    max_iterations: int = 500,
    numerics: Literal["automatic", "scaling"] = "automatic",
    control: Control = UNINTERRUPTED,
) -> Barycenter:
    """Barycenter with weights similar to those of another, of which only the finest potentials are needed.

    How mass moves between the two is found on coarser domains, where solving both is cheap; from the finest potentials
    alone it would take a hundred rounds at the finest level.

    Parameters
    ----------
    neighbor : Barycenter
        A barycenter of the same inputs, with the same inputs at weight zero.
    weights : (k,)
        The new weights.
    inputs : Inputs
        Its inputs.
    sharpness, entropy_limit, reach, tolerance, debias_tolerance, max_iterations, numerics, control
        As for :func:`barycenter`.

    Raises
    ------
    ValueError
        A barycenter of other inputs.
    """
    _check_inputs("neighbor", neighbor, inputs)
    options = {
        "entropy_limit": entropy_limit,
        "tolerance": tolerance,
        "debias_tolerance": debias_tolerance,
        "max_iterations": max_iterations,
        "numerics": numerics,
        "control": control,
    }
    before: tuple[Potentials, ...] = ()
    if len(inputs.levels) > 1:
        coarse = Inputs(inputs.levels[:-1], inputs.entropies)
        # Lengths in units of the coarser domain.
        own = None if reach is None else reach * coarse.domain.unit_length / inputs.domain.unit_length
        solved = barycenter(coarse, neighbor.weights, coarse.domain, sharpness=neighbor.sharpness, reach=own, **options)
        before = solved.levels
    initial = replace(neighbor, levels=(*before, neighbor.levels[-1]))
    return barycenter(inputs, weights, inputs.domain, sharpness=sharpness, reach=reach, initial=initial, **options)


def _check_inputs(name: str, solved: Barycenter, inputs: Inputs) -> None:
    if solved.density.shape != tuple(inputs.domain.shape) or len(solved.weights) != len(inputs):
        raise ValueError(f"{name} must be a barycenter of these inputs")


def _mixed(first: Potentials, second: Potentials, share: float) -> Potentials:
    """Interpolate logarithms of scalings; where one is missing, use the other.

    The result's region leaves out cells where both are missing, whose placeholders would be taken for scalings.
    """
    region = Region(_known(first) | _known(second))
    one, other = first.on(region).columns, second.on(region).columns
    mixed = (1.0 - share) * one + share * other
    columns = np.where(_missing(one), other, np.where(_missing(other), one, mixed))
    return Potentials(region, columns[:-1], columns[-1])


def _known(potentials: Potentials) -> NDArray[np.bool_]:
    return potentials.region.scatter(~_missing(potentials.columns), False)


def _missing(columns: NDArray[np.float64]) -> NDArray[np.bool_]:
    return (columns[:-1] <= LOG_NOTHING / 2).any(axis=0)
