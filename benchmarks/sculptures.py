# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes from smooth unions of signed distance functions, each with its own triangulation."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from assets.sculpting import Clay, Solid
from convwass_addon.geometry.meshes.mesh import TriangleMesh

from .deformed_pairs import decimated

SPACING = 0.017
"""Cell size of the grid for extraction; shapes are about 2 units long."""
TRIANGLES = 8000

# Grids of different shapes differ by up to this share in spacing and are shifted by up to one cell, so that two poses
# of one body share no triangles.
_SPACING_SPREAD = 0.12
# Margin around the solids in cells.
_MARGIN = 3.0
_RELAXING_ROUNDS = 2


@dataclass(frozen=True)
class _Step:
    solid: Solid
    blend: float
    carves: bool


@dataclass
class Sculpture:
    """Solids added and carved in order.

    Attributes
    ----------
    seed : int
        Determines the grid that the surface is extracted on.
    """

    seed: int
    _steps: list[_Step] = field(default_factory=list)

    def add(self, solid: Solid, blend: float = 0.0) -> None:
        """Add a solid, with its joint rounded by about `blend`."""
        self._steps.append(_Step(solid, blend, carves=False))

    def carve(self, solid: Solid, blend: float = 0.0) -> None:
        """Subtract a solid, with its rim rounded by about `blend`."""
        self._steps.append(_Step(solid, blend, carves=True))

    def mesh(self, triangles: int = TRIANGLES) -> TriangleMesh:
        """Return the closed surface, oriented outward, with approximately this many triangles."""
        draw = np.random.default_rng(self.seed)
        spacing = SPACING * (1.0 + _SPACING_SPREAD * draw.uniform(-1.0, 1.0))
        shift = spacing * draw.uniform(0.0, 1.0, 3)
        added = [step.solid for step in self._steps if not step.carves]
        low = np.min([solid.low for solid in added], axis=0) - _MARGIN * spacing - shift
        high = np.max([solid.high for solid in added], axis=0) + _MARGIN * spacing
        clay = Clay(low, high, spacing)
        for step in self._steps:
            (clay.carve if step.carves else clay.add)(step.solid, step.blend)
        vertices, faces = clay.surface()
        reduced = decimated(TriangleMesh.from_arrays(vertices, faces), triangles)
        return TriangleMesh(clay.relaxed(reduced.vertices, reduced.faces, _RELAXING_ROUNDS), reduced.faces)


def mirrored(points: ArrayLike, side: float) -> NDArray[np.float64]:
    """Return points, (n, 3) or (3,), on the side y > 0 for `side` 1, and their mirror images for -1."""
    return np.asarray(points, float) * (1.0, side, 1.0)
