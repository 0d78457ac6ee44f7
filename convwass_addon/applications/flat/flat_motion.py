# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of flat shapes: every part is moved as a surface, in the form of a planar sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.planar_fill import Boundary
from ...progress import Control, Work, within
from ..morphs.layouts import Blend, pairs_of
from ..motions.choosing import MotionChoice, chosen_motion
from ..motions.limbs import is_nearly_convex
from ..motions.motion import MovedShape
from ..motions.motion_request import MotionRequest
from .flat_pieces import FilledPieces, FlatPieces
from .flat_settings import FlatSettings
from .sheets import AttachedPoints, Sheet

# With more parts, a motion is used only if the user chose one.
_MOST_PARTS = 6


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
        rest = self.shape.rest
        return AttachedPoints.of(points, self.shape.vertices, rest.faces, self.shape.finder).on(
            rest.vertices, rest.faces
        )


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
        Figures for the record of every frame; of several parts, those of the worst.
    """

    motion: FlatMotion | None
    record: dict[str, object]


def chosen_flat_motion(
    pieces: Sequence[FlatPieces],
    names: Sequence[str],
    blends: Sequence[Blend],
    settings: FlatSettings,
    regions: int,
    centers: NDArray[np.float64],
    control: Control,
) -> Work[FlatChoice]:
    """Choose the motion of flat shapes, as :func:`.motions.choosing.chosen_motion` does for solids.

    Images and densities are transported. So are shapes of several regions and words of many letters, unless the user
    chose a motion: words cannot be mapped as a whole, and each letter takes seconds.

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
    regions : int
        The largest number of regions of a shape.
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
    if settings.motion == "automatic" and all(
        is_nearly_convex(part.starts, part.area) for own in filled for part in own.parts
    ):
        return FlatChoice(None, MotionChoice("transport", "SOLID").record())
    count = len(filled[0].parts)
    if settings.motion == "automatic" and (count > _MOST_PARTS or (count == 1 and regions > 1)):
        return FlatChoice(None, MotionChoice("transport", "MANY").record())
    sheets, choices = [], []
    for index in range(count):
        own = tuple(Sheet.of(each.parts[index]) for each in filled)
        meshes = [sheet.mesh for sheet in own]
        request = MotionRequest(meshes, names, pairs_of(blends), settings.motion, settings.coherence)
        choices.append((yield from within(chosen_motion(request, control), index / count, (index + 1) / count)))
        sheets.append(own)
    record = min(choices, key=lambda choice: (choice.motion is not None, choice.score or 0.0)).record()
    if all(choice.motion is None for choice in choices):
        return FlatChoice(None, record)
    return FlatChoice(FlatMotion(tuple(sheets), tuple(choices), centers), record)
