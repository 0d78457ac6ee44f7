# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a morph is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from ...errors import InputError

# Automatic sharpness: whole in the middle, exact towards the ends (where the weight of one shape exceeds the second).
_SHARPNESS = 0.75
_CRISP_FROM = 0.85
# Automatic blur: one cell, and no narrower than float64 carries across a grid.
_CELLS_PER_BLUR = 80.0
# The automatic tolerance, that of full sharpness, and the sharpness from which it goes there.
_TOLERANCE, _CRISP_TOLERANCE, _SLOW_FROM = 1e-2, 1e-3, 0.9
# Mass goes a quarter of the longest side at a locality of a half, and at least this many cells.
_REACHES = 4.0
_LEAST_REACH = 1.0


@dataclass(frozen=True)
class MorphSettings:
    """How a morph is made.

    Attributes
    ----------
    resolution : int
        Cells along the longest side of the grid.
    blur : float or None
        Standard deviation of the kernel in cells; None is one cell, or an eightieth of the resolution if that is more.
    sharpness : float or None
        0 is the paper's barycenter, 1 the debiased one; None is 0.75, rising to 1 towards the ends.
    entropy_limit : None, "max" or float
        Bound for the entropy of every blend in nats; "max" is the largest entropy of the inputs.
    level : "volume" or "half-max"
        Surface at the level that encloses the interpolated volume, or at half of the largest density.
    thickness : float
        Thickness in scene units given to shapes that enclose no volume; 0 refuses them.
    parts : "none", "vertex-groups" or "materials"
        What tells the parts of a shape: those of the same name on all shapes travel together.
    locality : float
        0: all mass travels; towards 1 it goes less and less far, and parts rather shrink here and grow there.
    thin_parts : bool
        Whether thin parts keep their volume where one level for all would take it from them.
    mend : bool
        Whether crumbs are dropped, narrow gaps bridged and false handles removed, as far as the shapes have none.
    tolerance : float or None
        Marginal error, and error of the debiasing density, at which a blend is done; None is 1 %, falling to 0.2 %
        where a sharpness near 1 is asked for, whose last details come slowly.
    max_iterations : int
        Most iterations per level of the solver.
    carry : bool
        Whether frames know where their matter comes from, so that colors and velocities can be carried along.
    """

    resolution: int = 100
    blur: float | None = None
    sharpness: float | None = None
    entropy_limit: Literal["max"] | float | None = None
    level: Literal["volume", "half-max"] = "volume"
    thickness: float = 0.0
    parts: Literal["none", "vertex-groups", "materials"] = "none"
    locality: float = 0.0
    thin_parts: bool = True
    mend: bool = True
    tolerance: float | None = None
    max_iterations: int = 200
    carry: bool = True

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        _require(8 <= self.resolution <= 1024, InputError("Resolution must lie between 8 and 1024 cells."))
        _require(self.blur is None or 0.5 <= self.blur <= 20, InputError("Blur must lie between 0.5 and 20 cells."))
        _require(self.sharpness is None or 0 <= self.sharpness <= 1, InputError("Sharpness must lie between 0 and 1."))
        limit = self.entropy_limit
        is_number = isinstance(limit, (int, float)) and bool(np.isfinite(limit))
        _require(
            limit is None or limit == "max" or is_number,
            InputError("The entropy limit must be 'max', a number, or off."),
        )
        _require(self.level in ("volume", "half-max"), InputError("The level must be 'volume' or 'half-max'."))
        _require(0 <= self.thickness < np.inf, InputError("Thickness must be zero or positive."))
        _require(
            self.parts in ("none", "vertex-groups", "materials"),
            InputError("Parts must be 'none', 'vertex-groups' or 'materials'."),
        )
        _require(0 <= self.locality <= 1, InputError("Locality must lie between 0 and 1."))
        _require(
            self.locality == 0 or limit is None,
            InputError("An entropy limit needs all mass to travel; set the locality to 0."),
        )
        _require(
            self.tolerance is None or 0 < self.tolerance < 1, InputError("The tolerance must lie between 0 and 1.")
        )
        _require(self.max_iterations >= 1, InputError("There must be at least one iteration."))

    @property
    def sigma(self) -> float:
        """Blur in cells, with the automatic choice made."""
        return max(1.0, self.resolution / _CELLS_PER_BLUR) if self.blur is None else self.blur

    @property
    def reach(self) -> float | None:
        """How far mass goes before it fades, in cells; None where all of it travels."""
        if self.locality == 0:
            return None
        return max(self.resolution / _REACHES * (1.0 / self.locality - 1.0), _LEAST_REACH)

    def sharpness_at(self, weights: Sequence[float]) -> float:
        """Sharpness of the blend with these weights, with the automatic choice made."""
        if self.sharpness is not None:
            return self.sharpness
        near = np.clip((max(weights) - _CRISP_FROM) / (1.0 - _CRISP_FROM), 0.0, 1.0)
        return float(_SHARPNESS + (1.0 - _SHARPNESS) * near**2 * (3.0 - 2.0 * near))

    @property
    def stopping_error(self) -> float:
        """The tolerance, with the automatic choice made."""
        if self.tolerance is not None:
            return self.tolerance
        crisp = 0.0 if self.sharpness is None else max(self.sharpness - _SLOW_FROM, 0.0) / (1.0 - _SLOW_FROM)
        return _TOLERANCE * (_CRISP_TOLERANCE / _TOLERANCE) ** crisp

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)


def _require(holds: bool, error: InputError) -> None:
    if not holds:
        raise error
