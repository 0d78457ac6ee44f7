# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How densities on a surface are moved along it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from ...errors import InputError


@dataclass(frozen=True)
class DensitySettings:
    """How densities on a surface are moved along it.

    Attributes
    ----------
    steps : int
        Steps from one density to the next: 24 make 23 frames between the two.
    blur : float or None
        Standard deviation of the kernel along the surface, in scene units; None is what suits the mesh.
    entropy_limit : "between", "max", None or float
        Bound for the entropy of all that is made, in nats; "between" goes from that of the density on one side to that
        of the other, by time or by weights (at the places of a graph it is "max"), "max" takes the larger of them,
        so that nothing spreads on its way; None lets it spread, as the plain barycenters of the paper do.
    blend_sharpness : float
        0 to 1: how much of the kernel's blur is taken from blends of several densities before the bound acts. It keeps
        their peaks apart, which a bound alone would melt into one.
    pieces : "keep" or "match"
        Whether densities with other shares of their mass on the connected pieces of the surface are refused, since no
        mass can cross, or scaled on every piece to the share that the first one has there.
    tolerance : float
        Marginal error at which a frame is done.
    max_iterations : int
        Most iterations of the solver.
    substeps : int
        Steps of time that the kernel takes: 10 for interpolations, 20 for distances to the percent.
    """

    steps: int = 24
    blur: float | None = None
    entropy_limit: Literal["between", "max"] | float | None = "between"
    blend_sharpness: float = 0.75
    pieces: Literal["keep", "match"] = "keep"
    tolerance: float = 1e-2
    max_iterations: int = 500
    substeps: int = 10

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        is_whole = all(isinstance(n, int | np.integer) for n in (self.steps, self.max_iterations, self.substeps))
        if not is_whole:
            raise InputError("Steps, iterations and substeps must be whole numbers.")
        if not 1 <= self.steps <= 10_000:
            raise InputError("There must be between 1 and 10000 steps from one density to the next.")
        if self.blur is not None and not (np.isfinite(self.blur) and self.blur > 0):
            raise InputError("The blur must be a positive length, or left out.")
        if not (self.entropy_limit in (None, "between", "max") or _is_number(self.entropy_limit)):
            raise InputError("The entropy limit must be 'between', 'max', a number, or off.")
        if not 0 <= self.blend_sharpness <= 1:
            raise InputError("The sharpness of blends must lie between 0 and 1.")
        if self.pieces not in ("keep", "match"):
            raise InputError("Pieces must be 'keep' or 'match'.")
        if not 0 < self.tolerance < 1:
            raise InputError("The tolerance must lie between 0 and 1.")
        if self.max_iterations < 1:
            raise InputError("There must be at least one iteration.")
        if not 1 <= self.substeps <= 100:
            raise InputError("The kernel must take between 1 and 100 substeps.")

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool) and bool(np.isfinite(value))
