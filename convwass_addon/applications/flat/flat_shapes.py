# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a flat morph is made of: closed rings in a plane, or images."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.outlines import Rule
from ...one_line import one_line

# Squares of lengths up to this are numbers in single precision too.
_FARTHEST = 1e18


@dataclass(frozen=True)
class FlatShape:
    """A flat shape as closed rings: what it fills follows from the rule, so rings may overlap and cross.

    Attributes
    ----------
    rings : tuple of (n, 2) float64
        Corners in the plane of the shape, scene units, of polygons that close by themselves: the first corner is not
        repeated at the end. Holes are rings too.
    rule : "non-zero" or "even-odd"
        Which points are inside: around which the rings turn other than zero times, or an odd number of times.
    colors : (r, 4) float64 or None
        Red, green, blue, opacity of every ring, linear; a hole has the color of what it is a hole of. Rings of one
        color are one layer, filled by the rule; layers are painted in the order in which their colors come first.
    letters : tuple of int or None
        For every ring the number of its letter in reading order, from 0; None finds letters by how the rings lie.
    """

    rings: tuple[NDArray[np.float64], ...]
    rule: Rule = "non-zero"
    colors: NDArray[np.float64] | None = None
    letters: tuple[int, ...] | None = None

    __repr__ = one_line("rings", "rule", "letters")

    def __post_init__(self) -> None:
        """Refuse what no shape can be.

        Raises
        ------
        InputError
            Rings that are no polygons, numbers that are none, colors or letters for another number of rings.
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
    """A grey image: a silhouette, or a density of which brighter pixels have more.

    Attributes
    ----------
    values : (width, height) float
        From 0, nothing, to 1, full; columns from left to right, rows from the bottom up.
    pixel : float
        Size of a pixel in scene units.
    corner : (float, float)
        Place of the lower left corner of the image in its plane.
    kind : "density" or "silhouette"
        A silhouette is what of the image is at least half full; of a density every value counts.
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
        """Refuse what no image can be.

        Raises
        ------
        InputError
            Values that are no numbers or negative, a pixel without size, or colors of another size.
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
