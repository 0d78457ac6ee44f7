# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A chosen motion, and why it was chosen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from ...errors import InputError, ResourceError
from .motion import Motion

# Cancelled is not among them. SciPy's eigensolvers raise RuntimeError if they do not converge.
FAILURES = (InputError, ResourceError, np.linalg.LinAlgError, ValueError, IndexError, ArithmeticError, RuntimeError)
"""Errors that computing a motion may raise on unforeseen meshes; the bake then continues without it."""

Found = TypeVar("Found")


def attempted(compute: Callable[..., Found], *arguments: object) -> Found | None:
    """Return what is computed from some arguments, or None if that fails on unforeseen meshes."""
    try:
        return compute(*arguments)
    except FAILURES:
        return None


def reason_of_stand_ins(reason: str) -> str:
    """Return the reason for shapes for that of others in their place, such as outer surfaces or bodies paired by place.

    The numbers of their vertices say nothing about the shapes.
    """
    return "FITS" if reason == "VERTICES" else reason


@dataclass(frozen=True)
class MotionChoice:
    """The chosen motion and the reason.

    Attributes
    ----------
    kind : str
        "guided", "combined" (guided, and completed by a warp), "warp" or "transport".
    reason : str
        "ASKED" (requested), "VERTICES" (the shapes have the same vertices and faces), "FITS" (the shapes map onto
        each other), "PARTLY" (they do in part, and the rest grows in place), "UNLIKE" (they do in part, and are
        warped towards each other), "CRUMPLED" (the map would crumple them more than a warp does), "SOLID" (they do
        not, and one of them has no limbs), "APART" (they do not), "TUMBLING" (by their map, they would tumble),
        "BENT" (a warp would bend plane faces), "OUTLINES" (outlines determine the shapes, and match), "TUBES" (center
        lines do), "REGIONS" (one has too many regions), "DISTORTED" (their outlines would distort them too much), or
        "FAILED" (an error occurred).
    motion : Motion or None
        None for transport alone.
    score : float or None
        Score of the worst map between two shapes, 0 to 1, if there is one.
    failure : str
        Message of the error, if one occurred.
    turned : float
        Largest angle in degrees by which a shape was turned as a whole to be mapped to another.
    detour : float or None
        Largest detour of an uncertain map, see :func:`.map_detour.map_detour`.
    left : float or None
        Largest share of the distance between two shapes that the motion leaves, if it was measured.
    guides_left_out : int
        Number of guides without which two shapes map better, so that they were left out.
    bodies : int
        Number of bodies of each shape that move by themselves; see :mod:`.separate_bodies`.
    limbs : int
        Number of limbs of all shapes that retract along themselves; see :mod:`.vanishing_limbs`.
    """

    kind: str
    reason: str
    motion: Motion | None = field(default=None, repr=False)
    score: float | None = None
    failure: str = ""
    turned: float = 0.0
    detour: float | None = None
    left: float | None = None
    guides_left_out: int = 0
    bodies: int = 1
    limbs: int = 0

    def record(self) -> dict[str, object]:
        """Return the description of the motion for the record of every frame, ready for JSON."""
        known = {"score": self.score, "failure": self.failure or None, "turned": round(self.turned) or None}
        known |= {"detour": self.detour, "left": self.left, "guides_left_out": self.guides_left_out or None}
        known |= {"bodies": self.bodies if self.bodies > 1 else None, "limbs": self.limbs or None}
        return {"kind": self.kind, "reason": self.reason, **{k: v for k, v in known.items() if v is not None}}
