# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Constraints on a blend that is computed again, from the other blends of a bake."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geometry.level_sets.connectivity import Connectivity
from ...geometry.level_sets.handle_removal import FIRM
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.surface_bounds import SurfaceBounds
from .extraction import Constraint
from .volumes import Lattice


@dataclass(frozen=True)
class Demand:
    """Constraints on a blend.

    Attributes
    ----------
    most : Connectivity
        The maximum numbers of pieces, handles and bubbles.
    near : TriangleMesh or None
        The surface of a neighboring blend, in scene space; None if there is no limit on the distance to it.
    reach : float
        The largest allowed distance to that surface, in scene units.
    has : Connectivity or None
        The numbers that the blend has so far. A frame that does not have fewer beyond `most` is of no use, and need not
        be finished: its record is enough.
    """

    most: Connectivity
    near: TriangleMesh | None = None
    reach: float = 0.0
    has: Connectivity | None = None

    def is_missed_by(self, found: Connectivity) -> bool:
        """Whether a frame with these numbers is of no use."""
        return self.has is not None and not found.beyond(self.most) < self.has.beyond(self.most)

    def constraint(self, lattice: Lattice, weights: Sequence[float]) -> Constraint:
        """Return the constraint for the surface of the blend with these weights, on the grid."""
        if self.near is None:
            return Constraint(FIRM)
        corner = np.asarray(weights) @ lattice.centers + lattice.origin
        corners, reach = (self.near.corners - corner) / lattice.spacing, self.reach / lattice.spacing
        return Constraint(FIRM, SurfaceBounds.of(corners, lattice.shape, reach))

    def digest(self) -> str:
        """Return a hash of all values."""
        has = None if self.has is None else vars(self.has)
        hashed = hashlib.sha256(json.dumps([vars(self.most), self.reach, has]).encode())
        if self.near is not None:
            for array in (self.near.vertices.astype("<f8"), self.near.faces.astype("<i8")):
                hashed.update(np.ascontiguousarray(array).data)
        return hashed.hexdigest()
