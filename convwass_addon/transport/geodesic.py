# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances between points, as transport between unit masses (Solomon et al. 2015, Fig. 3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .domain import Domain
from .log_range import LOG_NOTHING


def point_distances(sources: int | Sequence[int] | ArrayLike, domain: Domain) -> NDArray[np.float64]:
    """Distances from single elements to all others, by one application of the kernel.

    The transport between unit masses at x and y costs -gamma ln H(x, y), which goes to the squared distance with gamma
    (Varadhan). The logarithm is taken relative to that at the source, which makes the distance zero there, and is
    turned into a distance by the domain's own formula for its kernel in flat space, which is right for larger gamma
    and for few substeps too.

    Parameters
    ----------
    sources : int or (k,) int
        Elements, by their flat index.
    domain : Domain
        Owns the kernel.

    Returns
    -------
    domain.shape or (k, *domain.shape) float64
        Distances in units of the domain's maker; infinite where no heat arrives: on other pieces of a surface, and
        where float64 ends.

    Raises
    ------
    ValueError
        Indices that are not elements of the domain, or that hold no area.
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
