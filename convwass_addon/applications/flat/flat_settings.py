# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a flat morph is made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...errors import InputError
from ..morphs.morph_settings import MorphSettings

# Automatic blur: most pairs of shapes can be reached with it, and all frames of a morph then have the same.
_CELLS_PER_BLUR = 100.0


@dataclass(frozen=True)
class FlatSettings(MorphSettings):
    """How a flat morph is made: as solids are, :class:`.MorphSettings`, with more cells, and with words.

    The level "volume" encloses the area interpolated between the shapes (their roots are, as lengths go evenly), or
    what the blend evenly fills where that is more. `thickness`, `parts` and `thin_parts` mean nothing here.

    Attributes
    ----------
    resolution : int
        Cells along the longest side of the grid.
    blur : float or None
        Standard deviation of the kernel in cells; None is a hundredth of the resolution, one cell at least.
    words : "mass" or "letters"
        Whether a shape travels as one mass, or letter by letter in reading order.
    output : "outlines" or "densities"
        What frames have: outlines that enclose the interpolated area, or densities, for grey images.
    fit_error : float
        How far a fitted outline may be from the one that was read, in cells; see :func:`.fitted_outline`.
    """

    resolution: int = 512
    words: Literal["mass", "letters"] = "mass"
    output: Literal["outlines", "densities"] = "outlines"
    fit_error: float = 0.15

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        super().__post_init__()
        if self.words not in ("mass", "letters"):
            raise InputError("Words must be 'mass' or 'letters'.")
        if self.output not in ("outlines", "densities"):
            raise InputError("The output must be 'outlines' or 'densities'.")
        if not 0 < self.fit_error <= 10:
            raise InputError("The fit error must lie between 0 and 10 cells.")

    @property
    def sigma(self) -> float:
        """Blur in cells, with the automatic choice made."""
        return max(1.0, self.resolution / _CELLS_PER_BLUR) if self.blur is None else self.blur
