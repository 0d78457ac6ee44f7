# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geodesic distances between points, as transport between unit masses (Solomon et al. 2015, Fig. 3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .domain import Domain
from .log_range import LOG_NOTHING


def point_distances(sources: int | Sequence[int] | ArrayLike, domain: Domain) -> NDArray[np.float64]:
    """Distances from given elements to all others, by one application of the kernel.

    Transport between unit masses at x and y costs -gamma ln H(x, y), which tends to the squared distance as gamma goes
    to zero (Varadhan). The logarithm is taken relative to the source, where the distance becomes zero, and is converted
    to a distance by the domain's formula for its kernel in flat space, which also holds for larger gamma and for few
    substeps.

    Parameters
    ----------
    sources : int or (k,) int
        Flat indices of elements.
    domain : Domain
        Owns the kernel.

    Returns
    -------
    domain.shape or (k, *domain.shape) float64
        Distances in the domain's input units; infinite where no heat arrives: on other connected components, and where
        float64 underflows.

    Raises
    ------
    ValueError
        Indices outside the domain, or of elements without area.
    """
    size = int(np.prod(domain.shape))
    chosen = np.atleast_1d(np.asarray(sources))
    if chosen.ndim != 1 or chosen.dtype.kind not in "iu" or not len(chosen):
        raise ValueError(f"sources must be one index or a list of them, got {sources!r}")
    if chosen.min() < 0 or chosen.max() >= size:
        raise ValueError(f"sources must lie between 0 and {size - 1}")
    weights = np.broadcast_to(domain.weights, domain.shape).ravel()
    if (weights[chosen] == 0).any():
        raise ValueError(f"sources must hold some area; element {chosen[weights[chosen] == 0][0]} has none")
    logs = np.full((len(chosen), size), LOG_NOTHING)
    rows = np.arange(len(chosen))
    logs[rows, chosen] = -np.log(weights[chosen])
    blurred = np.empty((len(chosen), *domain.shape))
    domain.log_apply(logs.reshape(blurred.shape), blurred)
    flat = blurred.reshape(len(chosen), size)
    lengths = domain.unit_length * domain.kernel_distance(flat, flat[rows, chosen][:, None])
    lengths[flat <= LOG_NOTHING / 2] = np.inf
    lengths[rows, chosen] = 0.0
    lengths = lengths.reshape(blurred.shape)
    return lengths[0] if np.ndim(sources) == 0 else lengths
