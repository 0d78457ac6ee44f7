# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The densities of parts that travel together, as one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Densities waver by this share about the value they should have; only what is above lies in two parts at once.
_WAVER = 0.1


@dataclass(frozen=True)
class MergedParts:
    """Barycenters of parts as one density.

    Attributes
    ----------
    density : (nx, ny, nz) float64
        In any unit.
    volume : float
        What its surface should enclose, in cells.
    overlap : float
        Volume that parts have in common, in cells.
    """

    density: NDArray[np.float64]
    volume: float
    overlap: float = 0.0


def merged_parts(densities: Sequence[NDArray[np.float64]], volumes: NDArray[np.float64]) -> MergedParts:
    """Add up the barycenters of parts; where several fill the same cells, these count once.

    Otherwise a surface that is to enclose the volume of all would have to swell wherever one part passes through
    another.

    Parameters
    ----------
    densities : sequence of (nx, ny, nz) float64
        Of mass 1 each; one alone is left as it is.
    volumes : (p,) float64
        Volumes of the parts in cells: what they weigh.
    """
    if len(densities) == 1:
        return MergedParts(densities[0], float(volumes[0]))
    # Times their volume in cells, so that a cell that is full of a part holds one.
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
    """Density of which half of all mass has more: that inside the large parts, above one where they are compressed."""
    values = np.concatenate([density[density > 0] for density in densities])
    values.sort()
    mass = np.cumsum(values)
    return float(values[np.searchsorted(mass, 0.5 * mass[-1])])
