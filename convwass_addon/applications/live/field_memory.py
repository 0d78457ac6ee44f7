# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory that the level fields of a live morph take and may take."""

from __future__ import annotations

from dataclasses import dataclass

from ..memory import available_memory
from ..morphs.volumes import Lattice
from .field_sources import estimated_field_bytes
from .filling_lattice import LEVELS
from .layered_fields import LayeredFields
from .live_shapes import LiveShapes
from .weight_layouts import WeightLayout

# Share of the free memory that fields may take.
_MEMORY_SHARE = 0.25
# Memory of the colors of a field relative to that of its values (docs/performance, "Live blends").
_COLOR_SHARE = 0.4


@dataclass(frozen=True)
class FieldMemory:
    """The memory for the fields of a live morph.

    Attributes
    ----------
    shapes : LiveShapes
        The shapes.
    lattice : Lattice
        The grid of the fields.
    layout : WeightLayout
        Layout of the blends.
    megabytes : int
        Maximum memory that the user allows.
    """

    shapes: LiveShapes
    lattice: Lattice
    layout: WeightLayout
    megabytes: int

    def field_bytes(self, known: LayeredFields) -> float:
        """Estimate the memory of one field: the mean of the known ones, if any."""
        if known.filled:
            return known.bytes / known.filled
        blends = [self.layout.weights(node, LEVELS[0]) for node in self.layout.nodes(LEVELS[0])]
        values = estimated_field_bytes(self.shapes.inputs.shapes, self.lattice, blends)
        return values * (1.0 + _COLOR_SHARE * bool(self.shapes.appearances))

    def most(self, known: LayeredFields) -> int:
        """Return how many fields there is memory for, given the known ones."""
        allowed, free = self.megabytes * 1e6, available_memory()
        if free is not None:
            allowed = min(allowed, _MEMORY_SHARE * free)
        return int(allowed // self.field_bytes(known))
