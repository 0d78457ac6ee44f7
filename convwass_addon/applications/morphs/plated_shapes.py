# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes whose sheets are plates: a grid shows only what has a thickness.

Plates of two cells survive any motion. With a quarter of a cell, more maps are poor, and transport loses plates (Sheets
beside solids in docs/performance/frames.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ...geometry.mesh import TriangleMesh
from ...geometry.plates import Plates
from ...geometry.thicken import LEAST_THICKNESS
from .animation import Animation, ShapeAnimation
from .morph_settings import MorphSettings
from .part_labels import Matching


@dataclass(frozen=True)
class PlatedShapes:
    """The inputs of a morph with plates instead of sheets; shapes without sheets are as they were.

    Attributes
    ----------
    shapes : list of TriangleMesh
        Their vertices begin with those of the inputs.
    matching : Matching
        The corresponding parts of these shapes.
    animation : Animation or None
        These shapes at all times, if they are animated.
    """

    shapes: list[TriangleMesh]
    matching: Matching
    animation: Animation | None

    @classmethod
    def of(
        cls,
        shapes: Sequence[TriangleMesh],
        settings: MorphSettings,
        matching: Matching,
        animation: Animation | None = None,
    ) -> PlatedShapes:
        """Find the sheets of shapes, and give them the thickness of the settings, at least two cells."""
        cell = max(shape.longest_side for shape in shapes) / settings.resolution
        thickness = max(settings.thickness, LEAST_THICKNESS * cell)
        animated = [None] * len(shapes) if animation is None else list(animation.shapes)
        plated, parts = list(shapes), list(matching.faces)
        for index, shape in enumerate(shapes):
            moving = animated[index]
            plates = Plates.of(shape) if moving is None or moving.keeps_topology else None
            if plates is None:
                continue
            plated[index] = plates.thick(shape.vertices, thickness)
            if moving is not None:
                animated[index] = _thick(moving, plates, thickness)
            # Shapes of one part have no labels.
            if len(parts[index]):
                parts[index] = parts[index][plates.sources]
        moving = None if animation is None else replace(animation, shapes=tuple(animated))
        return cls(plated, replace(matching, faces=tuple(parts)), moving)


def _thick(moving: ShapeAnimation, plates: Plates, thickness: float) -> ShapeAnimation:
    """Return an input with plates at all of its times."""
    return replace(moving, meshes=tuple(plates.thick(mesh.vertices, thickness) for mesh in moving.meshes))
