# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of guided motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.algebra.mean_stretches import Parts, arithmetic_mean
from .coherence import check_coherence, excess_at, way_at


@dataclass(frozen=True)
class GuidedSettings:
    """Settings of a guided motion.

    Attributes
    ----------
    coherence : float
        From 0 to 1. At 0 there is no motion, and everything is transported. Up to 0.5 the shapes move a growing
        fraction of the way, at 0.5 all of it. Beyond 0.5 they resist stretching more and more. At 1 parts only rotate
        and the whole shape is scaled, so that all differences in proportion are left to transport.
    map_vertices : int
        Approximate number of vertices of the coarse meshes on which maps are solved.
    carrier_vertices : int
        Meshes with more than 1.5 times as many vertices are deformed by a coarser mesh of about this many vertices.
    mean_stretch : callable
        Interpolates the stretches of triangles; see :mod:`.mean_stretches`.
    """

    coherence: float = 0.5
    map_vertices: int = 1000
    carrier_vertices: int = 6000
    mean_stretch: Callable[[Parts], NDArray[np.float64]] = arithmetic_mean

    def __post_init__(self) -> None:
        """Check the settings; raises InputError."""
        check_coherence(self.coherence)
        if self.carrier_vertices < 100:
            raise InputError("Shapes must be deformed by meshes of at least 100 vertices.")

    @property
    def way(self) -> float:
        """Fraction of the way towards the others that shapes move, from 0 to 1."""
        return way_at(self.coherence)

    @property
    def stiffness(self) -> float:
        """Fraction of the stretch that is removed, from 0 to 1."""
        return excess_at(self.coherence)
