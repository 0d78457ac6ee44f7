# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes whose sheets are plates: a grid shows only what has a thickness.

Plates of two cells survive any motion. With a quarter of a cell, more maps are poor, and transport loses plates (Sheets
beside solids in docs/performance/frames.md).
"""

from __future__ import annotations

from dataclasses import replace

from ...geometry.solids.plates import Plates
from ...geometry.solids.thicken import LEAST_THICKNESS
from .animation import ShapeAnimation
from .morph_inputs import MorphInputs
from .morph_settings import MorphSettings


def with_plates(inputs: MorphInputs, settings: MorphSettings) -> MorphInputs:
    """Give the sheets of inputs the thickness of the settings, at least two cells.

    The vertices of the shapes begin with those of the inputs; shapes without sheets are as they were.
    """
    cell = max(shape.longest_side for shape in inputs.shapes) / settings.resolution
    thickness = max(settings.thickness, LEAST_THICKNESS * cell)
    animation = inputs.animation
    animated = [None] * len(inputs.shapes) if animation is None else list(animation.shapes)
    shapes, parts = list(inputs.shapes), list(inputs.matching.faces)
    for index, shape in enumerate(inputs.shapes):
        moving = animated[index]
        plates = Plates.of(shape) if moving is None or moving.keeps_topology else None
        if plates is None:
            continue
        shapes[index] = plates.thick(shape.vertices, thickness)
        if moving is not None:
            animated[index] = _thick(moving, plates, thickness)
        # Shapes of one part have no labels.
        if len(parts[index]):
            parts[index] = parts[index][plates.sources]
    moving = None if animation is None else replace(animation, shapes=tuple(animated))
    return replace(inputs, shapes=shapes, matching=replace(inputs.matching, faces=tuple(parts)), animation=moving)


def _thick(moving: ShapeAnimation, plates: Plates, thickness: float) -> ShapeAnimation:
    """Return an input with plates at all of its times."""
    return replace(moving, meshes=tuple(plates.thick(mesh.vertices, thickness) for mesh in moving.meshes))
