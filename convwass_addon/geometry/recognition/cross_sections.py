# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Circles or regular polygons that the sections of a solid across an axis are, the second coordinate axis here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

# Polygons have at least and at most so many sides: a glass in a game is revolved, a box is not. Angles of vertices
# about the axis are equal within the last number, in radians.
_FEWEST_SIDES, _MOST_SIDES, _EQUAL = 6, 128, 2e-3
# Vertices nearer to the axis than this share of the largest distance have no angle.
_ON_AXIS = 1e-3


class CrossSection(Protocol):
    """The form that all sections across an axis have."""

    @property
    def rotation(self) -> NDArray[np.float64]:
        """The rotation, (3, 3), after which a corner is in the direction of the first coordinate axis."""

    @property
    def filled(self) -> float:
        """Area relative to that of the circle through the corners."""

    @property
    def opposite(self) -> float:
        """Distance of what is opposite a corner from the axis, relative to that of the corner."""

    def radii(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances of corners from the axis in the sections whose outlines points, (n, 3), are on."""

    def facing(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return directions across the axis, (n, 3), of any length, that the outlines face at points."""


@dataclass(frozen=True)
class Circle:
    """Sections are circles about the axis; each of their points counts as a corner."""

    filled = opposite = 1.0

    @property
    def rotation(self) -> NDArray[np.float64]:
        """See :class:`CrossSection`."""
        return np.eye(3)

    def radii(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """See :class:`CrossSection`."""
        return np.hypot(points[:, 0], points[:, 2])

    def facing(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """See :class:`CrossSection`."""
        return points * (1.0, 0.0, 1.0)


@dataclass(frozen=True)
class RegularPolygon:
    """Sections are regular polygons about the axis.

    Attributes
    ----------
    sides : int
        Number of sides.
    angle : float
        Angle of a corner about the axis, in radians.
    """

    sides: int
    angle: float

    @property
    def rotation(self) -> NDArray[np.float64]:
        """See :class:`CrossSection`."""
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])

    @property
    def filled(self) -> float:
        """See :class:`CrossSection`."""
        return float(np.sin(self._step) / self._step)

    @property
    def opposite(self) -> float:
        """See :class:`CrossSection`."""
        return 1.0 if self.sides % 2 == 0 else float(np.cos(0.5 * self._step))

    @property
    def _step(self) -> float:
        return 2.0 * np.pi / self.sides

    def radii(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """See :class:`CrossSection`."""
        return (points * self.facing(points)).sum(axis=1) / np.cos(0.5 * self._step)

    def facing(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """See :class:`CrossSection`; unit vectors."""
        turns = np.floor((np.arctan2(points[:, 2], points[:, 0]) - self.angle) / self._step) + 0.5
        angles = self.angle + turns * self._step
        return np.column_stack([np.cos(angles), np.zeros(len(angles)), np.sin(angles)])


def cross_section_of(points: NDArray[np.float64]) -> CrossSection:
    """Return what sections between vertices, (n, 3), are, if they are circles or regular polygons: few angles tell."""
    radii = np.hypot(points[:, 0], points[:, 2])
    away = points[radii > _ON_AXIS * radii.max(initial=0.0)]
    angles = np.sort(np.arctan2(away[:, 2], away[:, 0]))
    if len(angles) < _FEWEST_SIDES:
        return Circle()
    gaps = np.diff(angles, append=angles[0] + 2.0 * np.pi)
    corners = angles[gaps > _EQUAL]
    if not _FEWEST_SIDES <= len(corners) <= _MOST_SIDES:
        return Circle()
    uneven = np.diff(corners, append=corners[0] + 2.0 * np.pi) - 2.0 * np.pi / len(corners)
    return Circle() if np.abs(uneven).max() > _EQUAL else RegularPolygon(len(corners), float(corners[0]))
