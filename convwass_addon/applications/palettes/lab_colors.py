# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversions of arrays to and from CIE-Lab and sRGB, in the precision of their input; channels come first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# IEC 61966-2-1: linear Rec.709 to CIE XYZ under D65.
_TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
_WHITE = _TO_XYZ.sum(axis=1)
_TO_RELATIVE = _TO_XYZ / _WHITE[:, None]
_FROM_RELATIVE = np.linalg.inv(_TO_RELATIVE)
# CIE 15:2004: the lower end of the cube root, and the slope of the linear segment below it.
_END, _SLOPE = 216.0 / 24389.0, 24389.0 / 27.0


def linear_of_srgb(encoded: NDArray[np.floating]) -> NDArray[np.floating]:
    """Decode sRGB values of any shape to linear ones; negative values use the linear segment."""
    curved = np.maximum(encoded, 0.04045)
    curved += 0.055
    curved *= 1.0 / 1.055
    np.power(curved, 2.4, out=curved)
    np.multiply(encoded, 1.0 / 12.92, out=curved, where=encoded <= 0.04045)
    return curved


def srgb_of_linear(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """Encode linear values of any shape as sRGB.

    Values above 1 extend the curve, negative ones the linear segment.
    """
    curved = np.maximum(linear, 0.0031308)
    np.power(curved, 1.0 / 2.4, out=curved)
    curved *= 1.055
    curved -= 0.055
    np.multiply(linear, 12.92, out=curved, where=linear <= 0.0031308)
    return curved


def lab_of_linear(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return CIE-Lab under D65.

    Parameters
    ----------
    linear : (3, ...) float32 or float64
        Linear Rec.709; values above 1 are brighter than white, with L above 100.

    Returns
    -------
    (3, ...) of the same type
        L, a and b.
    """
    relative = transformed(_TO_RELATIVE, linear)
    roots = _cube_roots(relative)
    found = np.empty_like(roots)
    found[0] = 116.0 * roots[1] - 16.0
    found[1] = 500.0 * (roots[0] - roots[1])
    found[2] = 200.0 * (roots[1] - roots[2])
    return found


def _cube_roots(relative: NDArray[np.floating]) -> NDArray[np.floating]:
    """Cube roots, with the linear segment near zero."""
    roots = np.maximum(relative, _END)
    if roots.dtype == np.float32:
        # A quarter of the time of cbrt, accurate to three units in the last place.
        np.log(roots, out=roots)
        roots *= 1.0 / 3.0
        np.exp(roots, out=roots)
    else:
        np.cbrt(roots, out=roots)
    dark = relative <= _END
    np.copyto(roots, (relative * (_SLOPE / 116.0)) + 16.0 / 116.0, where=dark)
    return roots


def linear_of_lab(lab: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return linear Rec.709, (3, ...), possibly outside 0 to 1; the inverse of `lab_of_linear`."""
    roots = np.empty_like(lab)
    roots[1] = (lab[0] + 16.0) / 116.0
    roots[0] = roots[1] + lab[1] / 500.0
    roots[2] = roots[1] - lab[2] / 200.0
    cubes = roots * roots * roots
    return transformed(_FROM_RELATIVE, np.where(cubes > _END, cubes, (116.0 * roots - 16.0) / _SLOPE))


def transformed(matrix: NDArray[np.float64], channels: NDArray[np.floating]) -> NDArray[np.floating]:
    """Multiply three channels, (3, ...), by a matrix, row by row, because BLAS would transpose the array first."""
    found = np.empty_like(channels)
    for row, own in zip(matrix.astype(channels.dtype), found, strict=True):
        np.multiply(channels[0], row[0], out=own)
        own += channels[1] * row[1]
        own += channels[2] * row[2]
    return found
