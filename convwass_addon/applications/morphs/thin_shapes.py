# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure parts of a shape that are too thin to survive a morph, and mass at the boundary of the grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids.boxes import box_around
from ...geometry.grids.near import capped_squares
from ...geometry.level_sets.thin_parts import LostPart, lost_parts
from .diagnostics import KEPT_CELLS

# Components below this fraction of a shape are ignored.
_LEAST_SHARE = 1e-3
# Rods and fins are at least this many times as long as thick; shorter parts are edges of the shape.
_SLENDER = 2.0
# Cells within this distance of thick parts belong to them.
_REACH = 2.0
# Assumed thickness of parts that fill no cell by a tenth.
_FAINT_CELLS = 0.5
# However little their volume, such parts are visible if a shape reaches farther by this share of its longest side, and
# by this many cells.
_VISIBLE_SHARE, _VISIBLE_CELLS = 0.05, 3.0
# Columns through a sheet have at least this share of the mass of the fullest one.
_COVERED = 0.25


def wall_share(density: NDArray[np.floating]) -> float:
    """Return the fraction of the mass of a density, (nx, ny, nz) or (nx, ny), in the outermost cells of its grid."""
    return 1.0 - float(density[(slice(1, -1),) * density.ndim].sum() / density.sum())


def thin_parts(occupancy: NDArray[np.floating]) -> dict[str, object]:
    """Measure the rods and fins of a shape that are too thin to survive a morph.

    Parameters
    ----------
    occupancy : (nx, ny, nz)
        Fraction of every cell that is inside, from 0 to 1.

    Returns
    -------
    dict
        Ready for JSON: ``share``, their fraction of the shape, and ``parts``, thinnest first, with thickness and length
        in cells.
    """
    filled = np.asarray(occupancy[box_around(occupancy > 0.0, 0)] if occupancy.any() else occupancy, dtype=np.float64)
    inside = np.pad(filled > 0.5, 1)
    # Depth of the axis of a rod that is just thick enough.
    deepest = (KEPT_CELLS + 1.0) / 2.0
    core = capped_squares(~inside, deepest) > deepest**2
    if not core.any():
        return _thin_all_over(filled)
    thick = inside & (capped_squares(core, deepest + 0.5) <= (deepest + 0.5) ** 2)
    lost = lost_parts(filled, thick[1:-1, 1:-1, 1:-1], _REACH)
    thin = [part for part in lost.parts if _is_too_thin(part)]
    parts = [{"thickness": part.thickness, "length": part.length} for part in thin]
    share = sum(part.share for part in thin)
    faint = _faint_length(inside[1:-1, 1:-1, 1:-1])
    is_visible = not parts and faint > max(_VISIBLE_SHARE * max(filled.shape), _VISIBLE_CELLS)
    if lost.scattered >= _LEAST_SHARE or is_visible:
        # No single cell has enough mass to trace these parts.
        parts.append({"thickness": _FAINT_CELLS, "length": faint})
        share += lost.scattered
    return {"share": float(share), "parts": tuple(sorted(parts, key=lambda part: part["thickness"]))}


def _faint_length(inside: NDArray[np.bool_]) -> float:
    """Return by how many cells a shape, which just fits the grid, reaches beyond the cells that it fills by a half."""
    box = box_around(inside, 0)
    return float(max(max(span.start, size - span.stop) for span, size in zip(box, inside.shape, strict=True)))


def _thin_all_over(filled: NDArray[np.float64]) -> dict[str, object]:
    """Measure a shape without thick parts as a sheet: its thickness is the volume divided by the largest projection."""
    columns = [filled.sum(axis=axis) for axis in range(3)]
    shadows = [np.count_nonzero(own > _COVERED * own.max()) for own in columns]
    thickness = float(filled.sum()) / max(*shadows, 1)
    if thickness >= KEPT_CELLS:
        return {"share": 0.0, "parts": ()}
    filled_cells = np.argwhere(filled > _COVERED * filled.max())
    length = float(np.ptp(filled_cells, axis=0).max() + 1) if len(filled_cells) else 0.0
    return {"share": 1.0, "parts": ({"thickness": thickness, "length": length},)}


def _is_too_thin(part: LostPart) -> bool:
    slender = part.length >= _SLENDER * part.thickness
    return slender and part.thickness < KEPT_CELLS and part.share >= _LEAST_SHARE
