# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of flat shapes: those of surfaces, with sheets in their place, for every part of the shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.planar_fill import Boundary
from ...progress import Control, Work, within
from ..morphs.bake_plan import pairs_of
from ..morphs.layouts import Blend
from ..motions.choosing import MotionChoice, chosen_motion
from ..motions.limbs import is_nearly_convex
from ..motions.motion import MovedShape
from .flat_pieces import FilledPieces, FlatPieces
from .flat_settings import FlatSettings
from .sheets import AttachedPoints, Sheet

# Motions of more parts are made only where they are asked for.
_MOST_PARTS = 6


@dataclass(frozen=True)
class MovedPart:
    """A part of an input, moved towards the others.

    Attributes
    ----------
    sheet : Sheet
        Where it stands.
    shape : MovedShape or None
        Where it has moved to; None for a part that is only laid about the blend's center.
    shift : (2,) float64
        From where a part without a motion stands to the blend.
    """

    sheet: Sheet
    shape: MovedShape | None
    shift: NDArray[np.float64]

    @property
    def boundary(self) -> Boundary:
        """Where its boundary has moved to."""
        return self.sheet.boundary.moved(self.shift) if self.shape is None else self.sheet.moved(self.shape)

    def origins(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where points of the moved part, (n, 2), come from."""
        if self.shape is None:
            return points - self.shift
        # Its triangles may be cut finer than those of the sheet.
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
        The centers of mass of the inputs, about which parts without a motion are laid.
    """

    sheets: tuple[tuple[Sheet, ...], ...]
    choices: tuple[MotionChoice, ...]
    centers: NDArray[np.float64]

    def moved(self, weights: Sequence[float]) -> list[list[MovedPart | None]]:
        """Return all parts, each for every input, in the blend with these weights; None where the weight is zero."""
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
    """What was chosen for a flat morph.

    Attributes
    ----------
    motion : FlatMotion or None
        None for transport alone.
    record : dict
        What every frame says about it: of several parts about that which agrees least.
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
    """Choose how flat shapes move, as :func:`.motions.choosing.chosen_motion` does for solids.

    Images and densities are transported, and so are shapes of several regions and words of many letters unless a motion
    is asked for: there is no map between words, and each letter takes seconds.

    Parameters
    ----------
    pieces : sequence of FlatPieces
        What every shape fills, in parts.
    names : sequence of str
        What messages call the shapes.
    blends : sequence of Blend
        All of them.
    settings : FlatSettings
        What is asked for.
    regions : int
        How many the shape has that has most.
    centers : (k, 2) float64
        Centers of mass of the shapes, scene units.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        A motion that was asked for and cannot be made.
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
        work = chosen_motion(meshes, names, pairs_of(blends), settings.motion, settings.coherence, (), control)
        choices.append((yield from within(work, index / count, (index + 1) / count)))
        sheets.append(own)
    record = min(choices, key=lambda choice: (choice.motion is not None, choice.score or 0.0)).record()
    if all(choice.motion is None for choice in choices):
        return FlatChoice(None, record)
    return FlatChoice(FlatMotion(tuple(sheets), tuple(choices), centers), record)
