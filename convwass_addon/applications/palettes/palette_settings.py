# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What recoloring is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...errors import InputError


@dataclass(frozen=True)
class RecolorSettings:
    """How an image takes a palette.

    Attributes
    ----------
    strength : float
        t: 0 leaves the image as it is, 1 gives it the palette, and between them colors are on their way.
    lightness : "transport" or "keep"
        Whether L is carried too, or stays as it is.
    smoothing : float
        How far the map is averaged, in bins of two units of a and b, and in half units of L: less reaches the palette
        more closely, more amplifies noise less.
    steepest : float
        Largest slope of the map of L; 0 for no limit.
    gamut : "clip" or "chroma"
        What happens to colors that a screen cannot show: channels are cut off, or colors grow paler at equal L.
    edge_radius : int
        Radius in pixels of an edge-aware filter of what changes; 0 for none.
    """

    strength: float = 1.0
    lightness: Literal["transport", "keep"] = "transport"
    smoothing: float = 1.0
    steepest: float = 0.0
    gamut: Literal["clip", "chroma"] = "clip"
    edge_radius: int = 0

    def __post_init__(self) -> None:
        """Refuse settings that make no sense; raises InputError."""
        if not 0.0 <= self.strength <= 1.0:
            raise InputError("The strength must lie between 0 and 1, not {strength}.", strength=self.strength)
        if not 0.0 <= self.smoothing <= 20.0:
            raise InputError("The smoothing must lie between 0 and 20, not {smoothing}.", smoothing=self.smoothing)
        if not (self.steepest == 0.0 or 1.0 <= self.steepest <= 1000.0):
            raise InputError("The slope limit must be 0 for none, or 1 or more, not {slope}.", slope=self.steepest)
        if not 0 <= self.edge_radius <= 200:
            raise InputError(
                "The edge radius must lie between 0 and 200 pixels, not {radius}.", radius=self.edge_radius
            )
