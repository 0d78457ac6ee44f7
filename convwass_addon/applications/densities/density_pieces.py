# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities on surfaces of several connected components, between which no mass can cross."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.algebra.quotients import quotients
from ...transport import Surface
from ...transport.pieces import piece_masses

SAME_SHARE = 1e-3
"""Differences of mass below this are removed: nobody paints more precisely."""


@dataclass(frozen=True)
class Piece:
    """A connected component of a surface.

    Attributes
    ----------
    vertices : int
        Number of its vertices.
    size : float
        Longest side of its bounding box, in scene units.
    center : (float, float, float)
        Its centroid by area, in scene units.
    """

    vertices: int
    size: float
    center: tuple[float, float, float]


def piece(surface: Surface, label: int) -> Piece:
    """Return the component of a surface whose label in ``surface.pieces`` is `label`."""
    own = surface.pieces == label
    points, areas = surface.positions[own], surface.weights[own]
    center = areas @ points / areas.sum()
    return Piece(int(own.sum()), float(np.ptp(points, axis=0).max()), tuple(float(x) for x in center))


def on_same_pieces(
    densities: NDArray[np.float64], names: Sequence[str], surface: Surface, match: bool = False
) -> NDArray[np.float64]:
    """Return the densities, rescaled to the first one's mass on every component of the surface.

    Parameters
    ----------
    densities : (k, n)
        Densities of mass 1.
    names : sequence of str
        Names of the densities for messages.
    surface : Surface
        The surface of the densities.
    match : bool
        Whether to rescale any differing masses; otherwise only differences below `SAME_SHARE` are removed.

    Raises
    ------
    InputError
        Masses differ, or cannot be matched because a density is empty on a component where the first one is not. The
        message names two densities and the components, by their size, center and number of vertices.
    """
    if surface.pieces is None:
        return densities
    masses = piece_masses(densities, surface)
    for other in range(1, len(densities)):
        differs = np.abs(masses[other] - masses[0]).max() > SAME_SHARE
        empty = (masses[0] > 0) != (masses[other] > 0)
        if (differs and not match) or (empty & (np.maximum(masses[0], masses[other]) > SAME_SHARE)).any():
            raise _refusal(names[0], names[other], masses[[0, other]], surface, empty.any())
    factors = quotients(masses[0], masses)
    scaled = densities * np.where(surface.pieces >= 0, factors[:, surface.pieces], 0.0)
    # If one density is empty on a component, drop the tiny masses of the others there.
    first_only = (masses[0] > 0) & (masses > 0).all(axis=0)
    scaled *= first_only[surface.pieces]
    return scaled / (scaled @ surface.weights)[:, None]


def _refusal(first: str, second: str, masses: NDArray[np.float64], surface: Surface, is_empty: bool) -> InputError:
    """Describe where two densities have different masses, given as `masses`, (2, p), on the components."""
    excess = masses[0] - masses[1]
    here, there = int(excess.argmax()), int(excess.argmin())
    values: dict[str, object] = {"first": first, "second": second}
    for place, label in (("here", here), ("there", there)):
        found = piece(surface, label)
        x, y, z = found.center
        values |= {f"{place}_vertices": found.vertices, f"{place}_size": found.size}
        values |= {f"{place}_x": x, f"{place}_y": y, f"{place}_z": z}
        values |= {f"{place}_first": float(masses[0, label]), f"{place}_second": float(masses[1, label])}
    if is_empty:
        return InputError(_ELSEWHERE, **values)
    return InputError(_UNEQUAL, **values)


_ELSEWHERE = (
    "{first} and {second} lie on different pieces of the mesh, which no face joins. On the piece of {here_vertices} "
    "vertices, {here_size:.3g} long, around ({here_x:.3g}, {here_y:.3g}, {here_z:.3g}), {first} has {here_first:.1%} "
    "of its mass and {second} {here_second:.1%}; on the one of {there_vertices} vertices, {there_size:.3g} long, "
    "around ({there_x:.3g}, {there_y:.3g}, {there_z:.3g}), {there_first:.1%} and {there_second:.1%}. Paint both on the "
    "same pieces, or join the pieces."
)
_UNEQUAL = (
    "{first} and {second} have different shares of their mass on the pieces of the mesh, which no face joins. On the "
    "piece of {here_vertices} vertices, {here_size:.3g} long, around ({here_x:.3g}, {here_y:.3g}, {here_z:.3g}), "
    "{first} has {here_first:.1%} and {second} {here_second:.1%}; on the one of {there_vertices} vertices, "
    "{there_size:.3g} long, around ({there_x:.3g}, {there_y:.3g}, {there_z:.3g}), {there_first:.1%} and "
    "{there_second:.1%}. Join the pieces, or let the shares be matched."
)
