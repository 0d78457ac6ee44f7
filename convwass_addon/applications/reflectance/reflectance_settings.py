# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for interpolating materials."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import InputError
from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class ReflectanceSettings(Settings):
    """Settings for interpolating materials."""

    rows: int = setting(
        64,
        "Detail",
        "Rows of a highlight from the normal to the horizon: narrow ones need more, and time grows with the third "
        "power",
        least=8,
        # More would take minutes for an image that is visually the same.
        most=128,
        soft_least=32,
        soft_most=96,
        prop="detail",
        note="An even number; there are four times as many columns, and 64 rows are 1.4 degrees each",
        panel="settings",
    )
    incoming: int = setting(
        12,
        "Incoming Angles",
        "Incoming angles from the normal to the horizon for which lobes are tabulated",
        least=2,
        most=90,
        prop=None,
        option=None,
    )
    turns: int = setting(
        8,
        "Turns",
        "Directions around the normal for which an incoming angle of anisotropic materials is tabulated",
        least=1,
        most=90,
        prop=None,
        option=None,
    )
    sigma: float = setting(
        2.0,
        "Blur",
        "Blur of the transport, in rows",
        least=0.5,
        most=20.0,
        soft_least=1.5,
        soft_most=4.0,
        unit="rows",
        prop="blur",
        panel="settings",
    )
    sharpness: float = setting(
        1.0,
        "Sharpness",
        "How much of that blur is removed from the result",
        help="How much of the blur is removed from the result: 0 is the paper's barycenter, 1 the debiased one",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        panel="settings",
    )
    entropy_limit: str = setting(
        "free",
        "Entropy Limit",
        "How widely an interpolated highlight may spread",
        choices=(
            Choice("free", "No Limit", "No bound on how widely it spreads"),
            Choice("largest", "As the Widest", "No more than the widest of the materials, as in the paper"),
            Choice("mean", "As Their Mean", "No more than their weighted mean"),
        ),
        note="The bound is applied to every solved lobe; that of the widest material rarely has an effect",
        panel="settings",
    )
    tolerance: float = setting(
        1e-2,
        "Tolerance",
        "Marginal error at which a lobe is done",
        least=0.0,
        most=1.0,
        open_ends=True,
        prop=None,
        option=None,
    )
    max_iterations: int = setting(
        200, "Iterations", "Largest number of iterations per level", least=1, prop=None, option=None
    )

    def __post_init__(self) -> None:
        """Refuse invalid settings.

        Raises
        ------
        InputError
            The message names the setting and its valid values.
        """
        super().__post_init__()
        if self.sigma > self.rows:
            raise InputError(
                "A blur of {sigma:g} rows exceeds the number of rows, {rows}.", sigma=self.sigma, rows=self.rows
            )
        if self.rows % 2:
            raise InputError("The rows of a lobe must be an even number.")
