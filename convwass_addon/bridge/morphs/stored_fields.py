# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Signed distances of baked blends on one grid, stored in the .blend as attributes that geometry nodes can mix.

Blends that lie apart in the scene are sampled about their own centers, so that the grid holds one shape and not the way
from one place to another; the surface between two blends is then mixed about the center between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from .field_sampler import SampleGrid

FIELD = "field_{}"
"""Point attribute of the samples for every blend: signed distance in cells times `SCALE`, positive inside, 8 bits."""

SCALE = 40
"""Steps of a stored distance per cell: 127 / 40 cells is `BAND` and half a step 0.0125 cells."""

BAND = 3.0
"""Distances are cut off here, in cells."""

OFFSET, VOLUME, COLOR = "offset", "volume", "color"
"""Point attributes of the table of steps: center, volume in cells, and color of every blend."""

_FALLBACK_RESOLUTION = 100
# Hooves and manes of a horse at 64 cells have their edges from here on (by eye), and surfaces about as many vertices as
# baked blends with detail have.
_FINER = 1.25


@dataclass(frozen=True)
class Column:
    """What a table says of every step: the name and type of an attribute, and its values, (n,) or (n, d)."""

    name: str
    kind: str
    values: NDArray[np.floating]


@dataclass(frozen=True)
class StoredFields:
    """Fields of all blends of a morph.

    Attributes
    ----------
    samples : bpy.types.Object
        Its mesh has a vertex per sample, in the order of `ravel`, and an attribute `FIELD` per blend.
    steps : bpy.types.Object
        Its mesh has a vertex per blend, with the attributes `OFFSET`, `VOLUME` and `COLOR`.
    sampler : bpy.types.NodeTree
        Interpolates between samples.
    grid : SampleGrid
        Where the samples are, relative to the center of a blend.
    """

    samples: bpy.types.Object
    steps: bpy.types.Object
    sampler: bpy.types.NodeTree
    grid: SampleGrid

    @property
    def blocks(self) -> list[bpy.types.ID]:
        """What goes when the fields go."""
        return [self.samples, self.steps, self.sampler]


def field_cells(settings: dict[str, object]) -> float:
    """Return how many cells a morph's fields have along the longest side: more where detail is finer than the bake."""
    resolution = int(settings.get("resolution") or _FALLBACK_RESOLUTION)
    detail = settings.get("detail")
    carries = settings.get("motion", "transport") != "transport" if detail is None else detail > 0.0
    return resolution * (_FINER if carries else 1.0)
