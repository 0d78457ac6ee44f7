# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of solids of revolution of which some have a cavity: it fills up while the outside moves.

If the section of a vase were deformed to that of a bottle, its wall would become thick while the bottom rises, and the
vase would be a third lower on the way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..motions.motion import MovedShape
from .agreeing_motion import AgreeingMotion
from .hollow_shape import HollowShape
from .revolved_shape import RevolvedShape
from .section_motion import moved_towards_mean, share_left
from .sheets import Sheet


@dataclass(frozen=True)
class FillingMotion:
    """Moves solids as their filled sections move, and keeps as much of them hollow as there is between the shapes.

    It is a :class:`.motion.Motion`. Of the volume of a blend, filled, that of the cavity is the share that it has in
    the weighted mean of the shapes.

    Attributes
    ----------
    flat : AgreeingMotion
        The motion of the filled sections.
    sheets : tuple of Sheet
        The filled sections.
    shapes : tuple of RevolvedShape or HollowShape
        The solids.
    volumes : (k, 2) float64
        Volumes of the cavities, and of the filled solids.
    centers : (k, 3) float64
        Points of the axes.
    """

    flat: AgreeingMotion
    sheets: tuple[Sheet, ...]
    shapes: tuple[RevolvedShape | HollowShape, ...]
    volumes: NDArray[np.float64]
    centers: NDArray[np.float64]

    @property
    def full(self) -> FillingMotion:
        """The motion whose cavities are full."""
        return replace(self, volumes=self.volumes * (0.0, 1.0))

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        way = self.flat.way
        places, volumes = (moved_towards_mean(own, weights, way) for own in (self.centers, self.volumes))
        found: list[MovedShape | None] = []
        for index, (shape, flat) in enumerate(zip(self.shapes, self.flat.moved(weights), strict=True)):
            left = share_left(weights[index], way)
            if flat is None:
                found.append(None)
            elif isinstance(shape, RevolvedShape):
                found.append(shape.moved(flat.mesh, places[index], left))
            else:
                outline, hollow = self.sheets[index].moved(flat), volumes[index, 0] / volumes[index, 1]
                found.append(shape.moved(flat.mesh, outline, places[index], left, hollow))
        return found
