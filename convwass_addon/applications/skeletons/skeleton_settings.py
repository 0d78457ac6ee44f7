# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a skeleton is fitted into a body."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from ...errors import InputError


@dataclass(frozen=True)
class SkeletonSettings:
    """How a skeleton is fitted into a body.

    Attributes
    ----------
    gamma : float
        Regularization on the body's surface rescaled to unit area: joints come to lie deeper with more of it, and with
        too much all of them at the center. 0.0015 to 0.0073 do.
    slack : float or None
        Nats by which the entropy of what is made may exceed that of the pins; None lets it spread, which keeps joints
        deepest. Less than one may not converge.
    weights : "length" or "uniform"
        Whether bones take up as much of the way as they are long in the skeleton as it is, or all alike.
    links : int
        Parts that a bone of average length is cut into, so that it can bend with the body while it is laid out.
    placement : "centered" or "expected"
        Whether joints are settled along the middle of the limbs, or stay at the means of their distributions, as in
        the paper; where limbs are thin or bent, the latter leave the body.
    outside_pins : "refuse" or "move"
        Whether pins outside the body end the job with a message, or are moved to the nearest place inside.
    thickness : float
        Thickness in the units of the body that is given to surfaces which enclose nothing, and that closes gaps
        between parts; 0 for none.
    tolerance : float
        Marginal error at which distributions are done.
    max_iterations : int
        Most sweeps over the skeleton.
    """

    gamma: float = 0.003
    slack: float | None = None
    weights: Literal["length", "uniform"] = "length"
    links: int = 2
    placement: Literal["centered", "expected"] = "centered"
    outside_pins: Literal["refuse", "move"] = "refuse"
    thickness: float = 0.0
    tolerance: float = 3e-2
    max_iterations: int = 200

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        if not (np.isfinite(self.gamma) and 0 < self.gamma <= 1):
            raise InputError("The blur (gamma) must be a positive number, 1 at most.")
        if self.slack is not None and not (np.isfinite(self.slack) and self.slack >= 0):
            raise InputError("The slack of the entropy must be zero or a positive number, or off.")
        if self.weights not in ("length", "uniform"):
            raise InputError("Weights must be 'length' or 'uniform'.")
        if not 1 <= self.links <= 20:
            raise InputError("A bone must be cut into 1 to 20 links.")
        if self.placement not in ("centered", "expected"):
            raise InputError("The placement must be 'centered' or 'expected'.")
        if self.outside_pins not in ("refuse", "move"):
            raise InputError("Pins outside must be 'refuse' or 'move'.")
        if not (np.isfinite(self.thickness) and self.thickness >= 0):
            raise InputError("The thickness must be zero or a positive length.")
        if not 0 < self.tolerance < 1:
            raise InputError("The tolerance must lie between 0 and 1.")
        if self.max_iterations < 1:
            raise InputError("There must be at least one iteration.")

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)
