# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools for painted densities: diffusion, sharpening, point masses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control
from ...transport import Surface
from ...transport.pieces import PieceMasses
from ...transport.sharpening import entropy, sharpening_exponent
from ...transport.sinkhorn import log_density
from ..workers import one_blas_thread
from .surface_densities import distribution

# Diffusing by more than this many times the size of the surface changes nothing, and numbers would overflow.
_LONGEST = 1e3
# Tolerance of a sharpened density's entropy, in nats.
_CLOSE = 1e-3


def diffused(
    weights: ArrayLike, surface: Surface, length: float, name: str, control: Control = UNINTERRUPTED
) -> NDArray[np.float64]:
    """Diffuse a density along the surface.

    Parameters
    ----------
    weights : (n,)
        Painted weights, or a density.
    surface : Surface
        Only the number of substeps of its own kernel is used.
    length : float
        Standard deviation, per axis, of the diffusion, in scene units. Variances add up: 3 and then 4 make 5.
    name : str
        Name of the weights for messages.
    control : Control
        Stops the work when cancelled.

    Returns
    -------
    (n,) float64
        Density of mass 1; every connected component keeps its mass.

    Raises
    ------
    InputError
        A length that is not positive or much longer than the surface; otherwise as for :func:`.distribution`.
    """
    density = distribution(weights, surface, name)
    if not (np.isfinite(length) and length > 0):
        raise InputError("The length to diffuse by must be positive, got {length:.3g}.", length=length)
    if length > _LONGEST * surface.unit_length:
        raise InputError(
            "The length {length:.3g} is far longer than the surface; {most:.3g} evens everything out.",
            length=length,
            most=10.0 * surface.unit_length,
        )
    with one_blas_thread():
        # The kernel's variance per axis is gamma / 2 for any number of substeps.
        control.check()
        kernel = surface.with_kernel(2.0 * (length / surface.unit_length) ** 2, surface.steps)
        control.check()
        spread = kernel.apply(density)
    control.check()
    return distribution(spread, surface, name)


def sharpened(
    weights: ArrayLike, surface: Surface, limit: float, name: str, control: Control = UNINTERRUPTED
) -> NDArray[np.float64]:
    """Raise a density to the power at which its entropy is `limit`; every connected component keeps its mass.

    Parameters
    ----------
    weights : (n,)
        Painted weights, or a density.
    surface : Surface
        The surface of the weights.
    limit : float
        Entropy in nats. A density with a lower entropy is returned unchanged.
    name : str
        Name of the weights for messages.
    control : Control
        Stops the work when cancelled.

    Returns
    -------
    (n,) float64
        Density of mass 1.

    Raises
    ------
    InputError
        No power reaches the limit, because the density has a flat top; otherwise as for :func:`.distribution`.
    """
    density = distribution(weights, surface, name)
    if not np.isfinite(limit):
        raise InputError("The entropy to sharpen to must be a number, got {limit}.", limit=limit)
    pieces = PieceMasses.of(density, surface)
    logs = log_density(density)
    control.check()
    exponent = sharpening_exponent(logs, limit, surface.weights, pieces)
    control.check()
    result = _raised_to_power(logs, exponent, pieces, surface)
    reached = entropy(result, surface.weights)
    if reached > limit + _CLOSE:
        raise InputError(
            "{name} cannot be sharpened to an entropy of {limit:.2f}: its top is flat and leaves {reached:.2f}. "
            "Diffuse it a little first.",
            name=name,
            limit=limit,
            reached=reached,
        )
    return result


def sharpened_by(
    weights: ArrayLike, surface: Surface, share: float, name: str, control: Control = UNINTERRUPTED
) -> NDArray[np.float64]:
    """Sharpen a density, (n,), until it covers the fraction `share` of the area that it covered, 0 < share <= 1.

    The covered area is that of the uniform density with the same entropy.

    Raises
    ------
    InputError
        A share outside these bounds, or as for :func:`sharpened`.
    """
    if not 0 < share <= 1:
        raise InputError("The share of the area to keep must lie between 0 and 1, got {share:.3g}.", share=share)
    density = distribution(weights, surface, name)
    return sharpened(density, surface, entropy(density, surface.weights) + float(np.log(share)), name, control)


def unit_mass(vertices: int | Sequence[int] | ArrayLike, surface: Surface) -> NDArray[np.float64]:
    """Return the density of mass 1, (n,), that is concentrated on some vertices, with the same mass on each.

    Raises
    ------
    InputError
        No vertices, invalid indices, or loose vertices, which cannot hold mass.
    """
    chosen = np.unique(np.atleast_1d(np.asarray(vertices)))
    check_vertices(chosen, surface)
    density = np.zeros(surface.shape)
    density[chosen] = 1.0 / (len(chosen) * surface.weights[chosen])
    return density


def check_vertices(vertices: NDArray[np.int64], surface: Surface) -> None:
    """Check that indices, (k,), belong to vertices with area.

    Raises
    ------
    InputError
        The message names the first invalid one.
    """
    count = surface.shape[0]
    if not len(vertices):
        raise InputError("No vertex is selected; select at least one.")
    if vertices.dtype.kind not in "iu":
        raise InputError("Vertices must be whole numbers from 0 to {last}.", last=count - 1)
    missing = vertices[(vertices < 0) | (vertices >= count)]
    if len(missing):
        raise InputError(
            "There is no vertex {vertex}; vertices are numbered from 0 to {last}.",
            vertex=int(missing[0]),
            last=count - 1,
        )
    loose = vertices[surface.weights[vertices] == 0]
    if len(loose):
        raise InputError(
            "Vertex {vertex} is loose: no face with an area uses it, so that it can hold no mass. Choose another one.",
            vertex=int(loose[0]),
        )


def _raised_to_power(
    logs: NDArray[np.float64], exponent: float, pieces: PieceMasses | None, surface: Surface
) -> NDArray[np.float64]:
    """Raise a density, given by its logarithms, to a power; every component keeps its mass."""
    powered = exponent * (logs - logs.max())
    if pieces is not None:
        powered = pieces.balanced(exponent * (logs - pieces.tops(logs)[pieces.labels]), surface.weights)
    density = np.exp(powered)
    return density / (density @ surface.weights)
