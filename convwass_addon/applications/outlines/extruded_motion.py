# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of extruded shapes, such as solid text: they move as the outlines of their sections do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.recognition.extrusion import common_extrusions
from ...progress import Control
from ..motions.guided_settings import GuidedSettings
from ..motions.motion import Motion, unmoved
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from ..workers import side_by_side
from .added_parts import MotionWithAddedParts
from .extruded_shape import ExtrudedShape
from .limb_motion import LimbMotion
from .outline_motion import outline_motion
from .section_motion import SectionMotion

# Points of triangles of which a corner with this share is on a limb are on it, too.
_LOOSE = 1e-6


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
    meshes, rests = request.shapes, [unmoved(flat, len(sections), index).rest for index in range(len(sections))]

    def extruded(shape: int) -> ExtrudedShape:
        return ExtrudedShape.of(meshes[shape], extrusions[shape], frame, rests[shape])

    shapes = tuple(side_by_side(extruded, len(meshes)))
    ends = np.array([[own.low, own.high] for own in extrusions])
    motion: Motion = SectionMotion(flat, shapes, ends)
    if isinstance(flat, LimbMotion) and flat.way == 1.0:
        loose = [
            own.places.interpolated(is_loose[rest.faces][..., None].astype(np.float64))[:, 0] > _LOOSE
            for own, rest, is_loose in zip(shapes, rests, flat.is_loose, strict=True)
        ]
        motion = MotionWithAddedParts.of(motion, motion, loose, request.pairs)
    return replace(moved.choice, motion=motion)
