# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How shapes are guided towards each other by maps between their surfaces."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from ...errors import InputError


@dataclass(frozen=True)
class GuidedSettings:
    """How shapes are guided towards each other.

    Attributes
    ----------
    coherence : float
        From 0 to 1. At 0 nothing is moved and all is left to transport; up to 0.5 shapes go a growing share of the way,
        at 0.5 all of it. Beyond, they resist being stretched more and more; at 1 parts only turn, and the whole shape
        grows or shrinks, so that all differences in proportion are left to transport.
    map_vertices : int
        Vertices of the coarse meshes that maps are solved on, about.
    carrier_vertices : int
        Meshes with more than half as many vertices again are deformed by a coarser mesh of about so many.
    """

    coherence: float = 0.5
    map_vertices: int = 1000
    carrier_vertices: int = 6000

    def __post_init__(self) -> None:
        """Refuse settings that make no sense; raises InputError."""
        if not 0 <= self.coherence <= 1:
            raise InputError("The coherence must lie between 0 and 1.")
        if self.carrier_vertices < 100:
            raise InputError("Shapes must be deformed by meshes of at least 100 vertices.")

    @property
    def way(self) -> float:
        """Share of the way towards the others that shapes go, from 0 to 1."""
        return min(1.0, 2.0 * self.coherence)

    @property
    def stiffness(self) -> float:
        """Share of the stretch that is left out, from 0 to 1."""
        return max(0.0, 2.0 * self.coherence - 1.0)

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)
