# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for interpolating skies."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import InputError
from ...schema import Settings, setting


@dataclass(frozen=True)
class SkySettings(Settings):
    """Settings for interpolating skies."""

    near: float = setting(
        20.0,
        "Glow",
        "Angle around a sun within which everything brighter than the other sky moves with it",
        least=1.0,
        most=170.0,
        soft_most=60.0,
        unit="degrees",
        subtype="ANGLE",
        panel="sky",
    )
    far: float = setting(
        60.0,
        "Fade Out",
        "Angle around a sun beyond which nothing moves with it",
        least=2.0,
        most=180.0,
        soft_most=120.0,
        unit="degrees",
        subtype="ANGLE",
        panel="sky",
    )
    least_share: float = setting(
        0.01,
        "Least Share",
        "Share of all light that a lamp must have to move; fainter ones fade in place",
        least=0.0,
        most=0.99,
        soft_most=0.1,
        precision=3,
        panel="sky",
    )
    rows: int = setting(
        64,
        "Rows",
        "Rows of the sphere that the glow travels on: 16, 32, 64 or 128",
        least=16,
        most=128,
        prop=None,
        option=None,
    )
    sigma: float = setting(
        2.0,
        "Blur",
        "Blur of the transport of the glow, in rows",
        least=0.5,
        most=20.0,
        unit="rows",
        prop=None,
        option=None,
    )
    sharpness: float = setting(
        0.5,
        "Sharpness",
        "0 is the paper's barycenter, 1 the debiased one",
        least=0.0,
        most=1.0,
        prop=None,
        option=None,
    )
    brightness: float = setting(
        20.0,
        "Brightness",
        "How many times brighter than its surroundings a sun or lamp must be",
        least=1.0,
        open_ends=True,
        prop=None,
        option=None,
    )
    most_lamps: int = setting(
        8,
        "Most Lamps",
        "Largest number of lamps that move, the brightest first",
        least=0,
        most=64,
        prop=None,
        option=None,
    )
    tolerance: float = setting(
        3e-3,
        "Tolerance",
        "Marginal error at which the transport of the glow is done",
        least=0.0,
        most=1.0,
        open_ends=True,
        prop=None,
        option=None,
    )

    def __post_init__(self) -> None:
        """Refuse invalid settings.

        Raises
        ------
        InputError
            The message names the setting and its valid values.
        """
        super().__post_init__()
        if self.rows not in (16, 32, 64, 128):
            raise InputError("The glow must travel on 16, 32, 64 or 128 rows.")
        if self.sigma > self.rows:
            raise InputError(
                "A blur of {sigma:g} rows exceeds the number of rows, {rows}.", sigma=self.sigma, rows=self.rows
            )
        if not self.near < self.far:
            raise InputError("The glow must end between the angle up to which it is complete and 180 degrees.")
