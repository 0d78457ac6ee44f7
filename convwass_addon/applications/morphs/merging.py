# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Combine the densities of parts that travel together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Densities vary by this fraction around their proper value; only what exceeds it counts as overlap of two parts.
_WAVER = 0.1


@dataclass(frozen=True)
class MergedParts:
    """Barycenters of parts, combined into one density.

    Attributes
    ----------
    density : (nx, ny, nz) float64
        In any unit.
    volume : float
        Volume that the surface should enclose, in cells.
    overlap : float
        Volume shared by several parts, in cells.
    """

    density: NDArray[np.float64]
    volume: float
    overlap: float = 0.0


def merged_parts(densities: Sequence[NDArray[np.float64]], volumes: NDArray[np.float64]) -> MergedParts:
    """Add up the barycenters of parts; cells that several parts fill count once.

    Without this correction, a surface enclosing the total volume would have to swell wherever one part passes through
    another.

    Parameters
    ----------
    densities : sequence of (nx, ny, nz) float64
        Of mass 1 each; a single one is not changed.
    volumes : (p,) float64
        Volumes of the parts in cells, used as weights.
    """
    if len(densities) == 1:
        return MergedParts(densities[0], float(volumes[0]))
    # Scaled by their volume, so that a cell filled by a part has density one.
    cells = [density * (volume / density.size) for density, volume in zip(densities, volumes, strict=True)]
    full = (1.0 + _WAVER) * max(1.0, typical_density(cells))
    total, separate = np.zeros_like(cells[0]), 0.0
    for own in cells:
        total += own
        separate += float(np.minimum(own, full).sum())
    np.minimum(total, full, out=total)
    overlap = max(1.0 - float(total.sum()) / separate, 0.0) * float(volumes.sum())
    return MergedParts(total, float(volumes.sum()) - overlap, overlap)


def typical_density(densities: Sequence[NDArray[np.float64]]) -> float:
    """Return the density above which half of the mass lies: that in large parts, over one where it is compressed."""
    values = np.concatenate([density[density > 0] for density in densities])
    values.sort()
    mass = np.cumsum(values)
    return float(values[np.searchsorted(mass, 0.5 * mass[-1])])
