# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recolor rows of an image by a map between palettes or by a lookup table."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from .lab_colors import lab_of_linear, linear_of_lab, linear_of_srgb, srgb_of_linear
from .lookup_table import LookupTable
from .pixels import PixelFormat
from .recoloring import Recoloring

# Squared contrast in Lab below which the edge-aware filter averages.
_EDGE = 4.0
# Upper limit of the guide's values, in Lab.
_BRIGHTEST = 256.0


def recolor_rows(
    pixels: NDArray[np.float32],
    pixel_format: PixelFormat,
    change: Recoloring | LookupTable,
    mask: NDArray[np.float32] | None,
    own: slice,
    out: NDArray[np.float32],
) -> None:
    """Recolor rows of an image.

    Parameters
    ----------
    pixels : (rows, width, 4) float32
        The rows to recolor and those that the edge-aware filter needs; pixels that are not finite are preserved.
    pixel_format : PixelFormat
        Meaning of the values.
    change : Recoloring or LookupTable
        The map to apply.
    mask : (rows, width) float32 or None
        Strength of the change.
    own : slice
        The rows to recolor, which go to `out`.
    out : (rows, width, 4) float32
        Output.
    """
    is_table = isinstance(change, LookupTable)
    with np.errstate(invalid="ignore", over="ignore"):
        colors = pixel_format.displayed(pixels) if is_table else pixel_format.linear(pixels)
        # A sum is finite if all of its terms are.
        usable = np.isfinite(colors[0] + colors[1] + colors[2] + pixels[..., 3])
    if not usable.all():
        np.copyto(colors, 0.0, where=~usable)
    found = (
        _apply_table(colors, pixel_format, change, mask) if is_table else _mapped(colors, pixel_format, change, mask)
    )[:, own]
    old, alpha, colors = pixels[own], pixels[own][..., 3], colors[:, own]
    new = (pixel_format.encoded_displayed if is_table else pixel_format.encoded)(found, alpha)
    stays = (found == colors).all(axis=0)
    stays |= ~usable[own]
    stays |= ~(alpha > 0)
    out[..., 3] = alpha
    out[..., :3] = new
    if stays.any():
        out[stays] = old[stays]


def _apply_table(
    displayed: NDArray[np.float32], pixel_format: PixelFormat, table: LookupTable, mask: NDArray[np.float32] | None
) -> NDArray[np.float32]:
    """Apply a table to sRGB-encoded colors; in scenes, the excess over white is added back unchanged."""
    found = table.applied(displayed)
    if np.isinf(pixel_format.highest):
        found += table.beyond(displayed)
    if mask is None and table.strength == 1.0:
        return found
    share = np.float32(table.strength) if mask is None else table.strength * mask
    return _mixed(displayed, found, share, pixel_format.highest)


def _mixed(
    displayed: NDArray[np.float32],
    found: NDArray[np.float32],
    share: NDArray[np.float32] | np.float32,
    highest: float,
) -> NDArray[np.float32]:
    """Go only a share of the way to the colors found: straight in Lab, as maps between palettes do."""
    linear = linear_of_srgb(displayed)
    lab = lab_of_linear(linear)
    shifts = share * (lab_of_linear(linear_of_srgb(found)) - lab)
    mixed = np.clip(linear_of_lab(lab + shifts), np.minimum(linear, 0.0), highest)
    return np.where((shifts == 0.0).all(axis=0), displayed, srgb_of_linear(mixed))


def _mapped(
    linear: NDArray[np.float32], pixel_format: PixelFormat, change: Recoloring, mask: NDArray[np.float32] | None
) -> NDArray[np.float32]:
    """Apply a map to linear colors."""
    lab = lab_of_linear(linear)
    shifts = change.shifts(lab)
    if change.settings.edge_radius:
        shifts = _along_edges(shifts, lab, change.settings.edge_radius)
    if mask is not None:
        shifts *= mask
    return change.finished(linear, lab, shifts, pixel_format.highest)


def _along_edges(shifts: NDArray[np.float32], guide: NDArray[np.float32], radius: int) -> NDArray[np.float32]:
    """Smooth changes where colors are uniform but not across edges: the guided filter of He et al. 2013.

    The guide is L, a and b. With L alone, the change of a red saucer would extend over its white highlights.
    """
    size = 2 * radius + 1
    # Squares of very bright lamps would drown everything next to them.
    guide = np.clip(guide, -_BRIGHTEST, _BRIGHTEST)

    def mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
        return uniform_filter(values, size, mode="nearest")

    middles = [mean(channel) for channel in guide]
    spread = {
        (row, column): mean(guide[row] * guide[column]) - middles[row] * middles[column] + _EDGE * (row == column)
        for row in range(3)
        for column in range(row + 1)
    }
    inverse = _inverse(spread)
    found = np.empty_like(shifts)
    for values, own in zip(shifts, found, strict=True):
        average = mean(values)
        along = [mean(channel * values) - middle * average for channel, middle in zip(guide, middles, strict=True)]
        rest = average
        own[...] = 0.0
        for row in range(3):
            slope = sum(inverse[max(row, column), min(row, column)] * along[column] for column in range(3))
            rest = rest - slope * middles[row]
            own += mean(slope) * guide[row]
        own += mean(rest)
    return found


def _inverse(matrix: dict[tuple[int, int], NDArray[np.float32]]) -> dict[tuple[int, int], NDArray[np.float32]]:
    """Invert symmetric 3 x 3 matrices, given by their lower triangles: cofactors over the determinant."""
    (a, b, c, d, e, f) = (matrix[place] for place in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)))
    found = {
        (0, 0): c * f - e * e,
        (1, 0): d * e - b * f,
        (2, 0): b * e - c * d,
        (1, 1): a * f - d * d,
        (2, 1): b * d - a * e,
        (2, 2): a * c - b * b,
    }
    scale = 1.0 / (a * found[0, 0] + b * found[1, 0] + d * found[2, 0])
    return {place: own * scale for place, own in found.items()}
