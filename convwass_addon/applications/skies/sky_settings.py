# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How skies are interpolated."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from ...errors import InputError


@dataclass(frozen=True)
class SkySettings:
    """How skies are interpolated.

    Attributes
    ----------
    rows : int
        Rows of the sphere that the glow travels on.
    sigma : float
        Blur of its transport, in these rows.
    sharpness : float
        0 is the paper's barycenter, 1 the debiased one.
    near, far : float
        Degrees from the sun within which all that is brighter than the other sky counts as glow, and beyond which
        nothing does.
    brightness : float
        So many times brighter than its surroundings the sun is, or a lamp.
    least_share : float
        Share of all light that a lamp must have; smaller ones fade in place.
    most_lamps : int
        The brightest so many are moved.
    tolerance : float
        Marginal error at which the transport of the glow is done.
    """

    rows: int = 64
    sigma: float = 2.0
    sharpness: float = 0.5
    near: float = 20.0
    far: float = 60.0
    brightness: float = 20.0
    least_share: float = 0.01
    most_lamps: int = 8
    tolerance: float = 3e-3

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        if self.rows not in (16, 32, 64, 128):
            raise InputError("The glow must travel on 16, 32, 64 or 128 rows.")
        if not (np.isfinite(self.sigma) and 0.5 <= self.sigma <= 20):
            raise InputError("The blur of the glow must lie between 0.5 and 20 rows.")
        if self.sigma > self.rows:
            raise InputError(
                "A blur of {sigma:g} rows is more than there are: {rows}.", sigma=self.sigma, rows=self.rows
            )
        if not (np.isfinite(self.sharpness) and 0 <= self.sharpness <= 1):
            raise InputError("The sharpness must lie between 0 and 1.")
        if not 0 < self.near < self.far <= 180:
            raise InputError("The glow must end between where it is whole and 180 degrees.")
        if not self.brightness > 1:
            raise InputError("A lamp must be brighter than its surroundings.")
        if not 0 <= self.least_share < 1:
            raise InputError("The share of a lamp must lie between 0 and 1.")
        if not 0 <= self.most_lamps <= 64:
            raise InputError("There can be 0 to 64 lamps.")
        if not 0 < self.tolerance < 1:
            raise InputError("The tolerance must lie between 0 and 1.")

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)
