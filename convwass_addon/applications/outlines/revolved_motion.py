# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of solids of revolution: they move as the outlines of their sections through the axis do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.mean_stretches import area_preserving_mean
from ...geometry.revolution import common_revolutions
from ...geometry.revolved_bodies import common_revolved_bodies
from ...geometry.ring_nesting import outline_of
from ...progress import Control
from ..motions.guided_settings import GuidedSettings
from ..motions.motion import Motion, weights_between
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from .even_volume import EvenVolumeMotion
from .lent_parts import LendingMotion
from .matched_outlines import only_placed
from .outline_motion import outline_motion
from .revolved_shape import RevolvedShape
from .section_motion import SectionMotion

# A section is symmetric all along the way if both sides differ at most by this share of its longest side.
_SYMMETRIC = 0.05
# Largest share of the area of a section that may overlap itself on the way.
_MOST_OVERLAP = 0.03


def revolved_motion(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the guided motion of solids of revolution about parallel axes, of which one may have attached parts.

    Returns
    -------
    MotionChoice or None
        None if a shape is not revolved, if two have attached parts, or if sections have different numbers of regions or
        holes, do not stay symmetric, or overlap themselves.
    """
    found = common_revolutions(request.shapes) or common_revolved_bodies(request.shapes)
    if found is None:
        return None
    frame, revolutions = found
    # Handles are better mapped onto each other.
    if any(not revolutions[one].is_whole and not revolutions[other].is_whole for one, other in request.pairs):
        return None
    sections = [own.section for own in revolutions]
    if len({tuple(len(region.holes) for region in outline_of(own).regions) for own in sections}) > 1:
        return None
    # With the arithmetic mean of stretches, thin walls would become thick on the way.
    settings = GuidedSettings(coherence=request.coherence, mean_stretch=area_preserving_mean)
    moved = outline_motion(sections, request.names, request.pairs, settings, control, only_placed)
    if moved is None or moved.overlap > _MOST_OVERLAP:
        return None
    flat = moved.choice.motion
    shapes = tuple(
        RevolvedShape.of(mesh, own, frame, carrier.rest)
        for mesh, own, carrier in zip(request.shapes, revolutions, flat.guided.carriers, strict=True)
    )
    for pair in request.pairs:
        halfway = flat.moved(weights_between(len(shapes), pair, 0.5))
        for index in pair:
            if shapes[index].asymmetry(halfway[index].mesh) > _SYMMETRIC * np.ptp(sections[index].bounds, axis=0).max():
                return None
    centers = np.stack([own.center for own in revolutions])
    volumes = np.array([mesh.volume for mesh in request.shapes])
    motion: Motion = SectionMotion(flat, shapes, centers)
    # Shapes that do not come all the way are not where the others' parts are.
    if flat.guided.settings.way == 1.0 and not all(own.is_whole for own in revolutions):
        motion = LendingMotion.of(motion, [own.attached.looseness > 0.0 for own in shapes], request.pairs)
    motion = EvenVolumeMotion(motion, volumes, centers, flat.guided.settings.way)
    return replace(moved.choice, motion=motion)
