# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of flat morphs."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, setting
from ..morphs.morph_settings import MorphSettings

# Automatic blur: wide enough for most pairs of shapes, so that all frames of a morph have the same blur.
_CELLS_PER_BLUR = 100.0


@dataclass(frozen=True)
class FlatSettings(MorphSettings):
    """Settings of a flat morph: those of :class:`.MorphSettings` with more cells, and those of words.

    The level "volume" encloses the interpolated area of the shapes (interpolating square roots, since lengths are
    linear), or the area that the blend evenly fills if that is larger. `detail`, `thickness`, `parts` and `thin_parts`
    are ignored.
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
        """Blur in cells, after the automatic choice."""
        return max(1.0, self.resolution / _CELLS_PER_BLUR) if self.blur is None else self.blur
