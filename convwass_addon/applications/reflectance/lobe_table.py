# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tabulated materials: for every incoming direction, the distribution of the outgoing light."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...one_line import one_line
from ...transport.sphere import directions, solid_angles
from .materials import Material

# Every cell of a lobe is the mean over this many points along each side, because highlights are narrower than cells.
_POINTS = 4
# The largest incoming angle: at the horizon nothing is reflected.
_LAST_ANGLE = np.radians(85.0)


@dataclass(frozen=True)
class LobeTable:
    """Distribution and amount of the outgoing light for every incoming direction.

    Attributes
    ----------
    theta_in : (n,) float64
        Angles of the incoming directions from the normal in radians; ascending if there is only one azimuth.
    phi_in : (n,) float64
        Their azimuths in radians; all 0 for isotropic materials.
    lobes : (n, rows, 4 * rows) float64
        Densities per steradian over the outgoing hemisphere, f cos(theta_out) normalized. Row i has the angle
        (i + 1/2) 90 degrees / rows from the normal, column j the azimuth (j + 1/2) 360 degrees / columns.
    albedo : (n, 3) float64
        The fraction of the light that goes out, per channel.
    """

    theta_in: NDArray[np.float64]
    phi_in: NDArray[np.float64]
    lobes: NDArray[np.float64]
    albedo: NDArray[np.float64]

    __repr__ = one_line("theta_in", "phi_in", "lobes", "albedo")

    @property
    def is_isotropic(self) -> bool:
        """Whether reflectance is independent of the incoming azimuth."""
        return not self.phi_in.any()

    @property
    def rows(self) -> int:
        """Number of rows of a lobe."""
        return self.lobes.shape[1]

    @cached_property
    def cells(self) -> NDArray[np.float64]:
        """Solid angles of the cells of a lobe in steradians, (rows, columns)."""
        return solid_angles(2 * self.rows, self.lobes.shape[2])[: self.rows]

    @cached_property
    def outgoing(self) -> NDArray[np.float64]:
        """Unit vectors to the cells, (rows, columns, 3); the normal is +Z."""
        return directions(2 * self.rows, self.lobes.shape[2])[: self.rows]

    @property
    def incoming(self) -> NDArray[np.float64]:
        """Unit vectors towards the light, (n, 3)."""
        return incoming_vectors(self.theta_in, self.phi_in)

    def reflectance(self) -> NDArray[np.float64]:
        """Return f in 1/sr, (n, rows, columns, 3)."""
        cosines = self.outgoing[..., 2]
        return (self.lobes / cosines)[..., None] * self.albedo[:, None, None, :]

    def fits(self, other: LobeTable) -> bool:
        """Return whether another table has the same directions."""
        return self.lobes.shape == other.lobes.shape and all(
            np.allclose(own, their, atol=1e-9)
            for own, their in ((self.theta_in, other.theta_in), (self.phi_in, other.phi_in))
        )


def incoming_vectors(theta: NDArray[np.float64], phi: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return unit vectors for polar angles and azimuths in radians, (n, 3)."""
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


@dataclass(frozen=True)
class IncomingDirections:
    """The incoming directions of a table, (n,) in radians; see :class:`LobeTable`."""

    theta: NDArray[np.float64]
    phi: NDArray[np.float64]


def incoming_directions(angles: int, turns: int) -> IncomingDirections:
    """Evenly spaced incoming angles from the normal almost to the horizon, for `turns` azimuths (1 for isotropic).

    Consecutive directions are adjacent: every second azimuth is traversed backward.
    """
    thetas = np.linspace(0.0, _LAST_ANGLE, angles)
    phis = np.arange(turns) * (2.0 * np.pi / turns)
    there_and_back = [thetas[:: -1 if turn % 2 else 1] for turn in range(turns)]
    return IncomingDirections(np.concatenate(there_and_back), np.repeat(phis, angles))


def tabulated(material: Material, incoming: IncomingDirections, rows: int) -> LobeTable:
    """Sample a material.

    Parameters
    ----------
    material : Material
        The material, averaged over the cells.
    incoming : IncomingDirections
        The incoming directions.
    rows : int
        Rows of every lobe.

    Returns
    -------
    LobeTable
        Lobes of mass 1. If a material reflects nothing, its lobe is that of a diffuse one, with albedo 0.
    """
    columns = 4 * rows
    cells = solid_angles(2 * rows, columns)[:rows]
    matte = directions(2 * rows, columns)[:rows, :, 2] / np.pi
    lobes, albedo = [], []
    for light in reflected_light(material, incoming, rows):
        grey = light.sum(axis=2)
        lobes.append(grey / (grey.sum() * cells) if grey.sum() > 0 else matte / (matte * cells).sum())
        albedo.append(light.sum(axis=(0, 1)))
    return LobeTable(incoming.theta, incoming.phi, np.array(lobes), np.array(albedo))


def reflected_light(material: Material, incoming: IncomingDirections, rows: int) -> Iterator[NDArray[np.float64]]:
    """Yield for every incoming direction the fraction of light that goes out to every cell, (rows, 4 rows, 3)."""
    fine_rows, fine_columns = rows * _POINTS, 4 * rows * _POINTS
    outgoing = directions(2 * fine_rows, fine_columns)[:fine_rows]
    projected = (solid_angles(2 * fine_rows, fine_columns)[:fine_rows] * outgoing[..., 2])[..., None]
    for vector in incoming_vectors(incoming.theta, incoming.phi):
        light = material.reflectance(vector, outgoing) * projected
        yield light.reshape(rows, _POINTS, 4 * rows, _POINTS, 3).sum(axis=(1, 3))
