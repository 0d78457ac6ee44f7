# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transport maps: the barycentric projection of entropic plans (Solomon et al. 2015, section 7)."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .domain import Domain, KernelTooNarrowError
from .log_range import LOG_NOTHING


def transport_map(log_scaling: ArrayLike, domain: Domain, values: ArrayLike | None = None) -> NDArray[np.float64]:
    """Mean of `values` over the elements that each element is matched with.

    For a plan D_v H D_w with marginals mu (of v) and nu (of w), the map of nu is T(x) = 1 / nu(x) int pi(y, x) y dy =
    H(a v y) / H(a v) at x. It needs only the scaling on its target side, and is defined beyond the support of nu.

    Parameters
    ----------
    log_scaling : domain.shape
        Logarithm of the scaling on the target side of the map: ``distance(...).log_w`` for the map from mu0 to mu1,
        ``barycenter(...).log_v[i]`` for the map from input i to the barycenter.
    domain : Domain
        The domain of both distributions.
    values : (*domain.shape, d), optional
        The values to average: positions, colors, texture coordinates; by default the positions of the elements.

    Returns
    -------
    (*domain.shape, d) float64
        Images of all elements, in units of `values`. On a surface these are points in space, in general off the
        surface. An element that no mass can reach keeps its own value.

    Raises
    ------
    ValueError
        Shapes that do not match, or values that are not finite.
    """
    scaling = np.asarray(log_scaling, dtype=np.float64)
    own = np.asarray(domain.positions if values is None else values, dtype=np.float64)
    if scaling.shape != tuple(domain.shape):
        raise ValueError(f"log_scaling must have the shape {tuple(domain.shape)}, got {scaling.shape}")
    if own.shape[:-1] != tuple(domain.shape):
        raise ValueError(f"values must have the shape {(*domain.shape, 'd')}, got {own.shape}")
    if not np.isfinite(scaling).all():
        raise ValueError("log_scaling must be finite numbers")
    if not np.isfinite(own).all():
        raise ValueError("values must be finite numbers")
    carried = np.moveaxis(own, -1, 0).reshape(own.shape[-1], -1)
    low, high = carried.min(axis=1, keepdims=True), carried.max(axis=1, keepdims=True)
    # Logarithms need positive numbers; values between 1 and 2 keep all digits.
    unit = np.where(high > low, high - low, 1.0)
    raised = ((carried - low) / unit + 1.0).reshape(-1, *domain.shape)
    columns = np.concatenate([scaling[None], scaling + np.log(raised)])
    blurred = np.empty(columns.shape)
    domain.log_apply(columns, blurred)
    unreached = (blurred[0] <= LOG_NOTHING / 2) & (np.broadcast_to(domain.weights, domain.shape) > 0)
    if unreached.any():
        with suppress(KernelTooNarrowError):
            domain.log_apply_far(columns, blurred)
    reached = blurred[0] > LOG_NOTHING
    means = np.exp(np.minimum(blurred[1:] - blurred[0], 1.0)).reshape(len(carried), -1)
    images = np.moveaxis(((means - 1.0) * unit + low).reshape(-1, *domain.shape), 0, -1)
    return np.where(reached[..., None], images, own)
