# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How materials are interpolated."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from ...errors import InputError

# Rows from the normal to the horizon; more take minutes for a picture that no render tells from these.
_FEWEST_ROWS, _MOST_ROWS = 8, 128


@dataclass(frozen=True)
class ReflectanceSettings:
    """How materials are interpolated.

    Attributes
    ----------
    rows : int
        Rows of a lobe from the normal to the horizon; it has four times as many columns. 64 are 1.4 degrees each.
    incoming : int
        Incoming angles from the normal to the horizon that a lobe is tabulated for.
    turns : int
        Directions around the normal that an incoming angle of materials with a grain is tabulated for.
    sigma : float
        Blur of the transport, in rows.
    sharpness : float
        0 is the paper's barycenter, 1 the debiased one.
    entropy_limit : "free", "largest" or "mean"
        Bound of the entropy, applied to every lobe once it is there: none, the largest of the materials', or their
        weighted mean. The largest one rarely acts.
    tolerance : float
        Marginal error at which a lobe is done.
    max_iterations : int
        Most iterations per level.
    """

    rows: int = 64
    incoming: int = 12
    turns: int = 8
    sigma: float = 2.0
    sharpness: float = 1.0
    entropy_limit: Literal["free", "largest", "mean"] = "free"
    tolerance: float = 1e-2
    max_iterations: int = 200

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        if not (_FEWEST_ROWS <= self.rows <= _MOST_ROWS and self.rows == int(self.rows)):
            raise InputError("A lobe must have {least} to {most} rows.", least=_FEWEST_ROWS, most=_MOST_ROWS)
        if not 2 <= self.incoming <= 90:
            raise InputError("There must be 2 to 90 incoming angles.")
        if not 1 <= self.turns <= 90:
            raise InputError("There must be 1 to 90 directions around the normal.")
        if not (np.isfinite(self.sigma) and 0.5 <= self.sigma <= 20):
            raise InputError("The blur of a lobe must lie between 0.5 and 20 rows.")
        if self.sigma > self.rows:
            raise InputError(
                "A blur of {sigma:g} rows is more than there are: {rows}.", sigma=self.sigma, rows=self.rows
            )
        if self.rows % 2:
            raise InputError("The rows of a lobe must be an even number.")
        if not (np.isfinite(self.sharpness) and 0 <= self.sharpness <= 1):
            raise InputError("The sharpness must lie between 0 and 1.")
        if self.entropy_limit not in ("free", "largest", "mean"):
            raise InputError("The bound of the entropy must be 'free', 'largest' or 'mean'.")
        if not 0 < self.tolerance < 1:
            raise InputError("The tolerance must lie between 0 and 1.")
        if self.max_iterations < 1:
            raise InputError("There must be at least one iteration.")

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)
