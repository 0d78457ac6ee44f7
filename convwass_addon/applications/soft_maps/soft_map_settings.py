# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the soft map from one mesh to another is computed."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from ...errors import InputError


@dataclass(frozen=True)
class SoftMapSettings:
    """How the soft map from one mesh to another is computed.

    Attributes
    ----------
    vertices : int
        Of the coarser meshes that the map is solved on, about; meshes with fewer are taken as they are.
    tau : float
        How much looks count against smoothness.
    sharpness : float
        0 to 1: how much of the kernel's blur is taken from the rows; 0 is the paper's map.
    sweeps : int
        Most times that every row is made anew, after some on yet coarser meshes. More only make the rows sharper.
    gamma_scale : float
        Entropic regularization in squared mean edge lengths of the coarser target.
    group_weight : float
        How much painted groups of equal names count against all else that tells points apart; 0 leaves them out.
    symmetric : bool
        Whether both directions are solved together.
    """

    vertices: int = 1000
    tau: float = 30.0
    sharpness: float = 1.0
    sweeps: int = 5
    gamma_scale: float = 1.7
    group_weight: float = 1.0
    symmetric: bool = False

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        if not all(isinstance(n, int | np.integer) for n in (self.vertices, self.sweeps)):
            raise InputError("Vertices and sweeps must be whole numbers.")
        if not 50 <= self.vertices <= 4000:
            raise InputError("The map must be solved on between 50 and 4000 vertices.")
        if not 1 <= self.sweeps <= 1000:
            raise InputError("There must be between 1 and 1000 sweeps.")
        if not 0 <= self.tau <= 1e6:
            raise InputError("Tau must lie between 0 and 1000000.")
        if not 0 <= self.sharpness <= 1:
            raise InputError("The sharpness must lie between 0 and 1.")
        if not 0.1 <= self.gamma_scale <= 100:
            raise InputError("The blur of the map must lie between 0.1 and 100.")
        if not 0 <= self.group_weight <= 100:
            raise InputError("The weight of painted groups must lie between 0 and 100.")

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)
