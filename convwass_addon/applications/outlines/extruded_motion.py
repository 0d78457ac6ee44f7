# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of extruded shapes, such as solid text: they move as the outlines of their sections do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.extrusion import common_extrusions
from ...progress import Control
from ..motions.guided_settings import GuidedSettings
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from ..workers import side_by_side
from .extruded_shape import ExtrudedShape
from .outline_motion import outline_motion
from .section_motion import SectionMotion


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
    settings = GuidedSettings(coherence=request.coherence)
    moved = outline_motion(sections, request.names, request.pairs, settings, control)
    if moved is None or moved.is_distorted:
        return None
    flat = moved.choice.motion
    meshes, rests = request.shapes, [carrier.rest for carrier in flat.guided.carriers]

    def extruded(shape: int) -> ExtrudedShape:
        return ExtrudedShape.of(meshes[shape], extrusions[shape], frame, rests[shape])

    shapes = tuple(side_by_side(extruded, len(meshes)))
    ends = np.array([[own.low, own.high] for own in extrusions])
    return replace(moved.choice, motion=SectionMotion(flat, shapes, ends))
