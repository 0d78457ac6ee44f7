# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a flat morph is made."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, setting
from ..morphs.morph_settings import MorphSettings

# Automatic blur: most pairs of shapes can be reached with it, and all frames of a morph then have the same.
_CELLS_PER_BLUR = 100.0


@dataclass(frozen=True)
class FlatSettings(MorphSettings):
    """How a flat morph is made: as solids are, :class:`.MorphSettings`, with more cells, and with words.

    The level "volume" encloses the area interpolated between the shapes (their roots are, as lengths go evenly), or
    what the blend evenly fills where that is more. `detail`, `thickness`, `parts` and `thin_parts` mean nothing here.
    """

    resolution: int = setting(
        512,
        "Resolution",
        "Cells along the longest side of flat shapes; twice as many take about four times as long and keep strokes "
        "that are half as wide",
        least=8,
        most=1024,
        soft_least=256,
        unit="cells",
        prop="flat_resolution",
        preset=False,
    )
    words: str = setting(
        "mass",
        "Words",
        "How texts and other shapes of several parts travel, where all shapes are flat",
        choices=(
            Choice("mass", "As One Mass", "All that a shape fills travels together"),
            Choice("letters", "Letter by Letter", "Letters travel to letters in reading order"),
        ),
        preset=False,
    )
    output: str = setting(
        "outlines",
        "Output",
        "What frames have",
        choices=(
            Choice("outlines", "Outlines", "Outlines that enclose the interpolated area"),
            Choice("densities", "Densities", "Densities, for gray images"),
        ),
        prop=None,
        option=None,
    )
    fit_error: float = setting(
        0.15,
        "Fit Error",
        "How far a fitted outline may be from the one that was read, in cells",
        least=0.001,
        most=10.0,
        unit="cells",
        prop=None,
        option=None,
        note="See :func:`.fitted_outline`",
    )

    @property
    def sigma(self) -> float:
        """Blur in cells, with the automatic choice made."""
        return max(1.0, self.resolution / _CELLS_PER_BLUR) if self.blur is None else self.blur
