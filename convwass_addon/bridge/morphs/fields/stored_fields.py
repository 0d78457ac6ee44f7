# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Signed distances of baked blends on one grid, stored in the .blend as attributes for Geometry Nodes.

Blends at different places in the scene are sampled around their own centers, so that the grid contains one shape and
not the distance between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ..stored import StoredMorph
from .field_sampler import SampleGrid

FIELD = "field_{}"
"""Point attribute of the samples for every blend: signed distance in cells times `SCALE`, positive inside, 8 bits."""

SCALE = 40
"""Steps of a stored distance per cell: `BAND` is 127 / 40 cells, and half a step 0.0125 cells."""

BAND = 3.0
"""Distances are clamped to this, in cells."""

OFFSET, VOLUME, ENCLOSED, COLOR = "offset", "volume", "enclosed", "color"
"""Point attributes of the table of steps: center, volume in counted cells, that of the mesh, and color of every blend.

The volume in cells finds the level of a mixture, and that of the mesh, in scene units, is what is shown.
"""

# From this factor on, the hooves and manes of a horse at 64 cells have sharp edges (by eye), and surfaces have about as
# many vertices as baked blends with detail.
_FINER = 1.25


LOSES_PARTS = "loses_parts"
"""Point attribute of the table of steps: 1 where the mixture of a blend and the next one misses a part, else 0."""


@dataclass(frozen=True)
class Column:
    """A column of a table with one row per step: name and type of an attribute, and its values, (n,) or (n, d)."""

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
        Its mesh has a vertex per blend, with the attributes `OFFSET`, `VOLUME`, `ENCLOSED` and `COLOR`.
    sampler : bpy.types.NodeTree
        Interpolates between samples.
    grid : SampleGrid
        Positions of the samples, relative to the center of a blend.
    """

    samples: bpy.types.Object
    steps: bpy.types.Object
    sampler: bpy.types.NodeTree
    grid: SampleGrid

    @property
    def blocks(self) -> list[bpy.types.ID]:
        """Data-blocks to remove with the fields."""
        return [self.samples, self.steps, self.sampler]


def field_cells(morph: StoredMorph) -> float:
    """Return the number of cells of the fields along the longest side; higher if the detail is finer than the bake."""
    detail = morph.settings.get("detail")
    carries = morph.settings.get("motion", "transport") != "transport" if detail is None else detail > 0.0
    return morph.resolution * (_FINER if carries else 1.0)
