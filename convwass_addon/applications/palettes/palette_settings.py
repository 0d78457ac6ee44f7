# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of recoloring."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import InputError
from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class RecolorSettings(Settings):
    """How an image is recolored with a palette."""

    strength: float = setting(
        1.0,
        "Strength",
        "How far colors go: 0 leaves them as they are, 1 gives the palette",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        panel="attribute",
    )
    lightness: str = setting(
        "transport",
        "Lightness",
        "What happens to the lightness of colors",
        choices=(
            Choice("transport", "From Palette", "Transfer it as well, which also changes the contrast"),
            Choice("keep", "Keep", "Keep it, and transfer only the hues"),
        ),
        option="--keep-lightness",
        flag="keep",
        help="Transfer only the hues, and keep L",
        panel="settings",
    )
    smoothing: float = setting(
        1.0,
        "Smoothing",
        "How widely the map of colors is averaged: with less, the palette is matched more closely; with more, noise "
        "and faint steps are amplified less",
        least=0.0,
        most=20.0,
        soft_most=4.0,
        note="In bins of two units of a and b, and in half units of L",
        panel="settings",
    )
    steepest: float = setting(
        0.0,
        "Slope Limit",
        "Largest factor by which contrast in lightness may grow; 0 for no limit",
        least=0.0,
        most=1000.0,
        soft_most=10.0,
        option="--slope-limit",
        note="It is the largest slope of the map of L, 1 or more",
        panel="settings",
    )
    gamut: str = setting(
        "clip",
        "Out of Gamut",
        "What becomes of colors that a screen cannot show",
        choices=(
            Choice("clip", "Clip", "Cut off red, green and blue"),
            Choice("chroma", "Less Chroma", "Make them paler until they can be shown, as light as they are"),
        ),
        panel="settings",
    )
    edge_radius: int = setting(
        0,
        "Edge Radius",
        "Radius of a filter that evens out the change of colors between edges, which takes grain from steep maps; 0 "
        "for none",
        least=0,
        most=200,
        soft_most=20,
        unit="pixels",
        subtype="PIXEL",
        panel="image",
    )

    def __post_init__(self) -> None:
        """Refuse invalid settings; raises InputError."""
        super().__post_init__()
        if 0.0 < self.steepest < 1.0:
            raise InputError("The slope limit must be 0 for none, or 1 or more, not {slope}.", slope=self.steepest)


@dataclass(frozen=True)
class TableSettings(Settings):
    """How a lookup table is written."""

    cube_size: int = setting(
        65,
        "Table Size",
        "Colors along an edge of the table: 33 is usual, 65 is three times as exact",
        least=2,
        most=129,
        soft_least=17,
    )
