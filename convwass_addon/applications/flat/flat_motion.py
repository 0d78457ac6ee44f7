# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of flat shapes: every part is moved as a surface, in the form of a planar sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.plane.planar_fill import Boundary
from ...progress import Control, Progress, Work, as_part
from ...sentence import Sentence
from ..morphs.layouts import Blend, pairs_of
from ..motions.choosing import chosen_motion
from ..motions.guided_settings import GuidedSettings
from ..motions.motion import MovedShape
from ..motions.motion_choice import FAILURES, MotionChoice
from ..motions.motion_request import MotionRequest
from ..outlines.limb_motion import with_added_limbs
from ..outlines.matched_motion import MOST_REGIONS
from ..outlines.moved_sheets import MovedSheets
from ..outlines.outline_motion import outline_motion
from ..outlines.sheets import AttachedPoints, Sheet
from .flat_pieces import FilledPieces, FlatPieces
from .flat_settings import FlatSettings


@dataclass(frozen=True)
class MovedPart:
    """A part of an input, moved towards the others.

    Attributes
    ----------
    sheet : Sheet
        The sheet at rest.
    shape : MovedShape or None
        The moved sheet; None for a part that is only translated.
    shift : (2,) float64
        Translation of a part without a motion.
    """

    sheet: Sheet
    shape: MovedShape | None
    shift: NDArray[np.float64]

    @property
    def boundary(self) -> Boundary:
        """The moved boundary."""
        return self.sheet.boundary.moved(self.shift) if self.shape is None else self.sheet.moved(self.shape)

    def origins(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the origins of points of the moved part, (n, 2)."""
        if self.shape is None:
            return points - self.shift
        # Its triangles may be finer than those of the sheet.
        return AttachedPoints.of(points, self.shape.mesh, self.shape.finder).on(self.shape.rest)


@dataclass(frozen=True)
class FlatMotion:
    """Moves flat shapes towards each other, part by part.

    Attributes
    ----------
    sheets : tuple of tuple of Sheet
        By part, and by input.
    choices : tuple of MotionChoice
        Of every part.
    centers : (k, 2) float64
        Centers of mass of the inputs, which are moved together for parts without a motion.
    """

    sheets: tuple[tuple[Sheet, ...], ...]
    choices: tuple[MotionChoice, ...]
    centers: NDArray[np.float64]

    def moved(self, weights: Sequence[float]) -> list[list[MovedPart | None]]:
        """Return all parts of every input in the blend with these weights; None for inputs without weight."""
        middle = np.asarray(weights) @ self.centers
        found = []
        for sheets, choice in zip(self.sheets, self.choices, strict=True):
            shapes = [None] * len(sheets) if choice.motion is None else choice.motion.moved(weights)
            found.append(
                [
                    MovedPart(sheet, shape, middle - center) if weight > 0 else None
                    for sheet, shape, center, weight in zip(sheets, shapes, self.centers, weights, strict=True)
                ]
            )
        return found


@dataclass(frozen=True)
class FlatChoice:
    """The chosen motion of a flat morph.

    Attributes
    ----------
    motion : FlatMotion or None
        None for transport alone.
    record : dict
        Figures for the record of every frame; of several parts, those of the first one without a motion, or else of the
        one that turns most.
    """

    motion: FlatMotion | None
    record: dict[str, object]


def chosen_flat_motion(
    pieces: Sequence[FlatPieces],
    names: Sequence[str],
    blends: Sequence[Blend],
    settings: FlatSettings,
    centers: NDArray[np.float64],
    control: Control,
) -> Work[FlatChoice]:
    """Choose the motion of flat shapes.

    Outlines determine shapes, so that parts whose outlines match move as these do. Images, densities and parts of very
    many regions are transported.

    Parameters
    ----------
    pieces : sequence of FlatPieces
        The transported parts of every shape.
    names : sequence of str
        Names of the shapes, for messages.
    blends : sequence of Blend
        All blends.
    settings : FlatSettings
        Settings of the morph.
    centers : (k, 2) float64
        Centers of mass of the shapes, scene units.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        A requested motion that cannot be computed.
    """
    filled = [own for own in pieces if isinstance(own, FilledPieces)]
    still = len(filled) < len(pieces) or settings.output == "densities"
    if still and settings.motion in ("guided", "warp"):
        raise InputError("Images and densities have no outline that could move. Set Motion to Automatic or Transport.")
    if still or settings.motion == "transport" or settings.coherence == 0.0:
        return FlatChoice(None, MotionChoice("transport", "ASKED").record())
    count, moved = len(filled[0].parts), []
    for index in range(count):
        work = _moved_part([each.parts[index] for each in filled], names, pairs_of(blends), settings, control)
        moved.append((yield from as_part(work, index, count)))
    choices = tuple(own.choice for own in moved)
    record = min(choices, key=lambda choice: (choice.motion is not None, -choice.turned)).record()
    if all(choice.motion is None for choice in choices):
        if settings.motion == "guided":
            raise InputError(
                "Shapes of more than {most} separate areas cannot be guided. "
                "Set Motion to Automatic, Warp or Transport.",
                most=MOST_REGIONS,
            )
        return FlatChoice(None, record)
    return FlatChoice(FlatMotion(tuple(own.sheets for own in moved), choices, centers), record)


def _moved_part(
    parts: Sequence[Boundary],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    settings: FlatSettings,
    control: Control,
) -> Work[MovedSheets]:
    """Return one part of every shape with the motion that the settings ask for, or without one."""
    yield Progress(0.0, Sentence("Moving the shapes"))
    if settings.motion == "warp":
        sheets = tuple(map(Sheet.of, parts))
        request = MotionRequest([sheet.mesh for sheet in sheets], names, pairs, "warp", settings.coherence)
        return MovedSheets(sheets, (yield from chosen_motion(request, control)))
    unmoved = MotionChoice("transport", "REGIONS")
    try:
        found = outline_motion(parts, names, pairs, GuidedSettings(coherence=settings.coherence), control)
    except FAILURES as error:
        if settings.motion == "guided":
            raise
        found, unmoved = None, MotionChoice("transport", "FAILED", failure=str(error))
    if found is not None and settings.motion == "automatic" and found.is_distorted:
        found, unmoved = None, MotionChoice("transport", "DISTORTED")
    if found is None:
        return MovedSheets(tuple(map(Sheet.of, parts)), unmoved)
    found = with_added_limbs(found, pairs)
    return replace(found, choice=replace(found.choice, reason="ASKED")) if settings.motion == "guided" else found
