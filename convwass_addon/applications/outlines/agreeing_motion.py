# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A guided motion of shapes whose maps are complete: they agree on where every point is.

Shapes that are deformed towards each other separately differ on the way by how their joints bend, which adds up along
limbs. Where every point of a shape has an image on every other one, shapes move to the weighted mean of all. It is the
same for two shapes. Maps between three need not be consistent, and what remains between the shapes is small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..motions.guided_motion import GuidedMotion
from ..motions.motion import MovedShape


@dataclass(frozen=True)
class AgreeingMotion:
    """Moves every point to the weighted mean of where the shapes move it; a :class:`.motion.Motion`.

    Attributes
    ----------
    guided : GuidedMotion
        The motion of the shapes, whose carriers are not coarser than the shapes.
    """

    guided: GuidedMotion

    @property
    def way(self) -> float:
        """Fraction of the way towards the others that shapes move, from 0 to 1."""
        return self.guided.settings.way

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        moved = self.guided.moved(weights)
        active = [shape for shape, own in enumerate(moved) if own is not None]
        if len(active) < 2 or self.way < 1.0:
            return moved
        found: list[MovedShape | None] = [None] * len(moved)
        total = sum(weights[shape] for shape in active)
        for shape in active:
            vertices = weights[shape] / total * moved[shape].vertices
            for other in active:
                if other != shape:
                    images = self.guided.deformations[shape, other].images
                    corners = moved[other].vertices[self.guided.carriers[other].mesh.faces]
                    vertices = vertices + weights[other] / total * images.interpolated(corners)
            found[shape] = MovedShape(moved[shape].rest, vertices, moved[shape].parents)
        return found
