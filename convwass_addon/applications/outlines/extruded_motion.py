# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of extruded shapes, such as solid text: they move as the outlines of their sections do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.extrusion import common_extrusions
from ...progress import Control
from ..motions.motion import MovedShape
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from .agreeing_motion import AgreeingMotion
from .extruded_shape import ExtrudedShape
from .outline_motion import outline_motion


@dataclass(frozen=True)
class ExtrudedMotion:
    """Moves the sections of extruded shapes in their plane, and interpolates their ends; a :class:`.motion.Motion`.

    Attributes
    ----------
    flat : AgreeingMotion
        The motion of the sections.
    frame : (3, 3) float64
        Two directions of the plane and the axis, as rows.
    shapes : tuple of ExtrudedShape
        The shapes.
    ends : (k, 2) float64
        Where every shape begins and ends along the axis.
    """

    flat: AgreeingMotion
    frame: NDArray[np.float64]
    shapes: tuple[ExtrudedShape, ...]
    ends: NDArray[np.float64]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        way = self.flat.guided.settings.way
        between = np.asarray(weights, np.float64) @ self.ends / sum(weights)
        found: list[MovedShape | None] = []
        for own, flat, ends in zip(self.shapes, self.flat.moved(weights), self.ends, strict=True):
            if flat is None:
                found.append(None)
                continue
            low, high = (1.0 - way) * ends + way * between
            heights = low + (high - low) * own.heights
            vertices = np.column_stack([own.places.interpolated(flat.mesh.corners)[:, :2], heights]) @ self.frame
            found.append(MovedShape(own.rest, vertices, own.parents))
        return found


def extruded_motion(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the guided motion of shapes that are extruded along a common axis.

    Returns
    -------
    MotionChoice or None
        None if a shape is not extruded, has too many regions, or would be distorted too much by its outline.
    """
    found = common_extrusions(request.shapes)
    if found is None:
        return None
    frame, extrusions = found
    sections = [own.section for own in extrusions]
    moved = outline_motion(sections, request.names, request.pairs, request.coherence, control)
    if moved is None or moved.is_distorted:
        return None
    flat = moved.choice.motion
    shapes = tuple(
        ExtrudedShape.of(mesh, own, frame, carrier.rest)
        for mesh, own, carrier in zip(request.shapes, extrusions, flat.guided.carriers, strict=True)
    )
    ends = np.array([[own.low, own.high] for own in extrusions])
    return replace(moved.choice, motion=ExtrudedMotion(flat, frame, shapes, ends))
