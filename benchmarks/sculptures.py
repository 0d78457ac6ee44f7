# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes from smooth unions of signed distances, each with triangles of its own."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from assets.sculpting import Clay, Solid, tube
from convwass_addon.geometry.mesh import TriangleMesh

from .deformed_pairs import decimated

SPACING = 0.017
"""Of the grid that a surface is found on, for shapes about 2 units long."""
TRIANGLES = 8000

# Grids of different shapes differ by up to this share in spacing and are shifted by up to one cell, so that two poses
# of one body share no triangles.
_SPACING_SPREAD = 0.12
# Free room around the solids in cells.
_MARGIN = 3.0
_RELAXING_ROUNDS = 2


@dataclass(frozen=True)
class _Step:
    solid: Solid
    blend: float
    carves: bool


@dataclass
class Sculpture:
    """Solids that are added and carved in order.

    Attributes
    ----------
    seed : int
        Decides the grid that the surface is found on.
    """

    seed: int
    _steps: list[_Step] = field(default_factory=list)

    def add(self, solid: Solid, blend: float = 0.0) -> None:
        """Add a solid, its joint rounded over about `blend`."""
        self._steps.append(_Step(solid, blend, carves=False))

    def carve(self, solid: Solid, blend: float = 0.0) -> None:
        """Take a solid away, the rim rounded over about `blend`."""
        self._steps.append(_Step(solid, blend, carves=True))

    def mesh(self, triangles: int = TRIANGLES) -> TriangleMesh:
        """Return the surface, closed and outward, with about so many triangles."""
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


def capsules(points: ArrayLike, radii: ArrayLike) -> Solid:
    """Straight rods with round ends from point to point, (n, 3), joined where they meet; radii (n,)."""
    return tube(points, radii, steps=1)


def mirrored(points: ArrayLike, side: float) -> NDArray[np.float64]:
    """Return points, (n, 3) or (3,), on the side y > 0 for 1, and their mirror images for -1."""
    return np.asarray(points, float) * (1.0, side, 1.0)
