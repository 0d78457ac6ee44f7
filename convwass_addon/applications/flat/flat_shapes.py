# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of flat morphs: closed rings in a plane, or images."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.plane.outlines import Rule
from ...one_line import one_line

# Squares of lengths up to this are finite in single precision.
_FARTHEST = 1e18


@dataclass(frozen=True)
class FlatShape:
    """A flat shape as closed rings, which may overlap and cross; the fill rule determines its inside.

    Attributes
    ----------
    rings : tuple of (n, 2) float64
        Corners of closed polygons in the plane of the shape, scene units, without repeating the first corner. Holes are
        rings, too.
    rule : "non-zero" or "even-odd"
        Points are inside if the winding number of the rings is not zero, or odd.
    colors : (r, 4) float64 or None
        Red, green, blue, opacity of every ring, linear; a hole has the color of the ring around it. Rings of the same
        color form a layer, filled by the rule; layers are painted in the order in which their colors first occur.
    letters : tuple of int or None
        The index of every ring's letter in reading order, from 0; None detects letters from the positions of the rings.
    """

    rings: tuple[NDArray[np.float64], ...]
    rule: Rule = "non-zero"
    colors: NDArray[np.float64] | None = None
    letters: tuple[int, ...] | None = None

    __repr__ = one_line("rings", "rule", "letters")

    def __post_init__(self) -> None:
        """Check the values.

        Raises
        ------
        InputError
            Rings with too few corners, values that are not finite, or a wrong number of colors or letters.
        """
        if self.rule not in ("non-zero", "even-odd"):
            raise InputError("The fill rule must be 'non-zero' or 'even-odd'.")
        if any(ring.ndim != 2 or ring.shape[1] != 2 or len(ring) < 3 for ring in self.rings):
            raise InputError("A closed curve needs three corners in the plane.")
        if not all(np.isfinite(ring).all() for ring in self.rings):
            raise InputError("Corners of closed curves must be finite numbers.")
        if any(np.abs(ring).max() > _FARTHEST for ring in self.rings):
            raise InputError(
                "Corners of closed curves must not be farther away than {farthest:.0e}.", farthest=_FARTHEST
            )
        if self.colors is not None and (
            self.colors.shape != (len(self.rings), 4) or not np.isfinite(self.colors).all()
        ):
            raise InputError("Every closed curve needs a color of four numbers.")
        if self.letters is not None and len(self.letters) != len(self.rings):
            raise InputError("Every closed curve needs the number of its letter.")


@dataclass(frozen=True)
class FlatImage:
    """A gray image: a silhouette, or a density in which brighter pixels have more mass.

    Attributes
    ----------
    values : (width, height) float
        From 0, empty, to 1, full; columns from left to right, rows from the bottom up.
    pixel : float
        Size of a pixel in scene units.
    corner : (float, float)
        Position of the lower left corner of the image in its plane.
    kind : "density" or "silhouette"
        A silhouette consists of the pixels that are at least half full; in a density every value counts.
    colors : (width, height, 4) float or None
        Red, green, blue, opacity of every pixel, linear.
    """

    values: NDArray[np.floating]
    pixel: float = 1.0
    corner: tuple[float, float] = (0.0, 0.0)
    kind: Literal["density", "silhouette"] = "density"
    colors: NDArray[np.floating] | None = None

    __repr__ = one_line("values", "pixel", "corner", "kind")

    def __post_init__(self) -> None:
        """Check the values.

        Raises
        ------
        InputError
            Negative or infinite values, a pixel without size, or colors of another size.
        """
        if self.values.ndim != 2 or not self.values.size:
            raise InputError("An image needs a value for every pixel.")
        if not np.isfinite(self.values).all() or self.values.min() < 0:
            raise InputError("Values of an image must be zero or positive numbers.")
        if not (np.isfinite(self.pixel) and self.pixel > 0 and np.isfinite(self.corner).all()):
            raise InputError("A pixel must have a size, and an image a place.")
        if self.kind not in ("density", "silhouette"):
            raise InputError("An image is a 'density' or a 'silhouette'.")
        if self.colors is not None and (
            self.colors.shape != (*self.values.shape, 4) or not np.isfinite(self.colors).all()
        ):
            raise InputError("Every pixel of an image needs a color of four numbers.")


FlatInput = FlatShape | FlatImage
"""What can be blended with what; shapes and images may be mixed."""
