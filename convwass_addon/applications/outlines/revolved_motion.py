# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of solids of revolution: they move as the outlines of their sections through the axis do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.mean_stretches import area_preserving_mean
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.plane.planar_fill import Boundary
from ...geometry.plane.ring_nesting import outline_of
from ...geometry.recognition.revolution import Revolution, common_revolutions
from ...geometry.recognition.revolved_bodies import common_revolved_bodies
from ...geometry.recognition.section_cavities import SectionCavity, revolved_volume
from ...progress import Control
from ..motions.guided_motion import GuidedMotion
from ..motions.guided_settings import GuidedSettings
from ..motions.motion import Motion, arriving, ways_between, weights_between
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from .added_parts import MotionWithAddedParts
from .agreeing_motion import AgreeingMotion
from .attached_parts import AttachedParts
from .even_volume import EvenVolumeMotion
from .filling_motion import FillingMotion
from .hollow_shape import HollowShape
from .mapped_parts import MappedPartsMotion
from .matched_motion import matched_motion
from .matched_outlines import only_placed
from .matched_sections import RimMatcher
from .outline_pairs import KnownMatches
from .outlined_shape import OutlinedShape
from .revolved_shape import RevolvedShape

# A section is symmetric all along the way if both sides differ at most by this share of its longest side.
_SYMMETRIC = 0.05
# Largest share of the area of a section that may overlap itself on the way.
_MOST_OVERLAP = 0.03
# Largest share of a surface that may be on flat parts, which would crumple while they retract. A submarine has none, a
# whale 0.06, and a penguin 0.34.
_MOST_FLAT = 0.05
# Ends beside the axis reach at most so far, as a share of the longest side. The stem of an apple reaches 0.19, and is
# mapped onto that of a pear; otherwise it would retract while another one grows.
_MOST_LEANING = 0.05


def revolved_motion(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the guided motion of solids of revolution about parallel axes, of which one may have attached parts.

    Returns
    -------
    MotionChoice or None
        None if a shape is not revolved, if two have attached parts, if such parts cannot retract, or if sections have
        different numbers of regions or holes, do not stay symmetric, or overlap themselves.
    """
    found = common_revolutions(request.shapes) or common_revolved_bodies(request.shapes)
    # Handles are better mapped onto each other.
    return None if found is None or _two_have_parts(found[1], request) else _by_sections(found, request, control)


def motion_with_parts(request: MotionRequest, guided: GuidedMotion, control: Control) -> MotionChoice | None:
    """Return the guided motion of solids of revolution that have attached parts, if two that become each other have.

    Of two shapes, parts that are mapped onto each other follow the map. Others retract into the body or grow out of it.

    Parameters
    ----------
    request : MotionRequest
        The shapes.
    guided : GuidedMotion
        Their motion by maps between the surfaces.
    control : Control
        Stops the work.

    Returns
    -------
    MotionChoice or None
        None if no two shapes have attached parts, and otherwise as for :func:`revolved_motion`.
    """
    found = common_revolved_bodies(request.shapes)
    if found is None or not _two_have_parts(found[1], request):
        return None
    return _by_sections(found, request, control, guided)


def _two_have_parts(revolutions: Sequence[Revolution], request: MotionRequest) -> bool:
    """Return whether there are two shapes with attached parts that become each other."""
    return any(not revolutions[one].is_whole and not revolutions[other].is_whole for one, other in request.pairs)


def _by_sections(
    found: tuple[NDArray[np.float64], list[Revolution]],
    request: MotionRequest,
    control: Control,
    guided: GuidedMotion | None = None,
) -> MotionChoice | None:
    """Return the guided motion of solids of revolution, given the frame of their axes, if their sections match."""
    frame, revolutions = found
    sections = [own.section for own in revolutions]
    if len({tuple(len(region.holes) for region in outline_of(own).regions) for own in sections}) > 1:
        return None
    cavities = _filling_cavities(sections, request.pairs)
    filled = [own if cavity is None else cavity.filled for own, cavity in zip(sections, cavities, strict=True)]
    vessels = [own for own in cavities if own is not None]
    match = RimMatcher(tuple(own.rim for own in vessels), vessels[0].side) if vessels else only_placed
    # With the arithmetic mean of stretches, thin walls would become thick on the way.
    settings = GuidedSettings(coherence=request.coherence, mean_stretch=area_preserving_mean)
    outlined = [OutlinedShape.of(own) for own in filled]
    moved = matched_motion(outlined, request.names, request.pairs, settings, KnownMatches(match), control)
    if moved is None or moved.overlap > _MOST_OVERLAP:
        return None
    flat = moved.choice.motion
    rests = [carrier.rest for carrier in flat.guided.carriers]
    shapes = [
        RevolvedShape.of(mesh, own, frame, rest, _arrivals(flat, index, request))
        for index, (mesh, own, rest) in enumerate(zip(request.shapes, revolutions, rests, strict=True))
    ]
    if not all(_retracts(own.attached) for own in shapes):
        return None
    if not all(_stay_symmetric(flat, shapes, sections, pair) for pair in request.pairs):
        return None
    solids = tuple(
        shape if cavity is None else HollowShape.of(shape, own, frame, rest, sheet.boundary, cavity)
        for shape, own, rest, sheet, cavity in zip(shapes, revolutions, rests, moved.sheets, cavities, strict=True)
    )
    centers = np.stack([own.center for own in revolutions])
    whole = [revolved_volume(own) for own in filled]
    hollow = np.subtract(whole, [revolved_volume(own) for own in sections])
    filling = FillingMotion(flat, moved.sheets, solids, np.column_stack([hollow, whole]), centers)
    motion = _with_parts(filling, shapes, guided, request.pairs)
    volumes = np.array([mesh.volume for mesh in request.shapes])
    return replace(moved.choice, motion=EvenVolumeMotion(motion, volumes, centers, flat.way))


def _with_parts(
    filling: FillingMotion,
    shapes: Sequence[RevolvedShape],
    guided: GuidedMotion | None,
    pairs: Sequence[tuple[int, int]],
) -> Motion:
    """Return the motion of solids with parts that follow the map of two shapes, and with those that they borrow."""
    motion: Motion = filling
    loose = [own.is_loose for own in filling.shapes]
    mapped = MappedPartsMotion.of(filling, guided, shapes) if guided is not None and len(shapes) == 2 else None
    if mapped is not None:
        motion = mapped
        for own, parts in zip(loose, mapped.parts, strict=True):
            own[parts.vertices] = False
    # Shapes that do not come all the way are not where the others' parts are.
    if filling.flat.way == 1.0 and any(map(np.any, loose)):
        motion = MotionWithAddedParts.of(motion, filling.full, loose, pairs)
    return motion


def _arrivals(flat: AgreeingMotion, index: int, request: MotionRequest) -> list[TriangleMesh]:
    """Return a section moved onto every section that it occurs with."""
    ways = ways_between(request.pairs)
    return [arriving(flat, len(request.shapes), *way).mesh for way in ways if way[0] == index]


def _stay_symmetric(
    flat: AgreeingMotion, shapes: Sequence[RevolvedShape], sections: Sequence[Boundary], pair: tuple[int, int]
) -> bool:
    """Return whether both sides of two sections are the same halfway."""
    halfway = flat.moved(weights_between(len(shapes), pair, 0.5))
    return all(
        shapes[index].places.asymmetry(halfway[index].mesh) <= _SYMMETRIC * np.ptp(sections[index].bounds, axis=0).max()
        for index in pair
    )


def _retracts(attached: AttachedParts) -> bool:
    """Return whether attached parts stand out of a body, so that they can retract into it."""
    return attached.flatness <= _MOST_FLAT and attached.leaning <= _MOST_LEANING


def _filling_cavities(sections: Sequence[Boundary], pairs: Sequence[tuple[int, int]]) -> list[SectionCavity | None]:
    """Return the cavities of sections if one of every pair has one, and all are open to the same side; else none."""
    found = [SectionCavity.of(own) for own in sections]
    sides = {own.side for own in found if own is not None}
    fills = len(sides) == 1 and all((found[one] is None) != (found[other] is None) for one, other in pairs)
    return found if fills else [None] * len(found)
