# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of solids that are determined by a section, and move as its outlines do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ..motions.motion import Motion, MovedShape


class FlatMotion(Motion, Protocol):
    """A motion of sections in their plane."""

    @property
    def way(self) -> float:
        """Fraction of the way towards the others that sections move, from 0 to 1."""
        ...


class SectionShape(Protocol):
    """A solid that is determined by a section."""

    def moved(self, section: TriangleMesh, place: NDArray[np.float64], left: float) -> MovedShape:
        """Return the solid for its moved section.

        Parameters
        ----------
        section : TriangleMesh
            In the plane z = 0.
        place : (d,)
            Where the solid is across its section.
        left : float
            How far it is from the others, from 1 at rest to 0.
        """
        ...


@dataclass(frozen=True)
class SectionMotion:
    """Moves the sections of solids in their plane, and interpolates where these are; a :class:`.motion.Motion`.

    Attributes
    ----------
    flat : FlatMotion
        The motion of the sections.
    shapes : tuple of SectionShape
        The solids.
    places : (k, d) float64
        Where every solid is across its section: its ends along an axis, or a point of it.
    """

    flat: FlatMotion
    shapes: tuple[SectionShape, ...]
    places: NDArray[np.float64]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        way = self.flat.way
        places = moved_towards_mean(self.places, weights, way)
        return [
            None if flat is None else own.moved(flat.mesh, place, share_left(weight, way))
            for own, flat, place, weight in zip(self.shapes, self.flat.moved(weights), places, weights, strict=True)
        ]


def share_left(weight: float, way: float) -> float:
    """Return how far a shape of a weight is from the others, from 1 at rest to 0, if it moves a fraction of the way."""
    return 1.0 - way * (1.0 - weight)


def moved_towards_mean(values: NDArray[np.float64], weights: Sequence[float], way: float) -> NDArray[np.float64]:
    """Return values of shapes, (k, ...), moved a fraction of the way towards their weighted mean."""
    mean = np.tensordot(np.asarray(weights, np.float64), values, axes=1) / sum(weights)
    return (1.0 - way) * values + way * mean
