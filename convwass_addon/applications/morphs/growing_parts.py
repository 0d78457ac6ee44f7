# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that only some of several solids have: where they are, and distances by which they grow and shrink.

Both concern many cells around a surface and need little accuracy, so they are computed on a coarser grid.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...geometry.arrays.steps import smooth_step
from ...geometry.grids.boxes import Box, slabs
from ...geometry.grids.coarser_grid import CoarserGrid
from ...geometry.grids.near import capped_distances

# Grids are halved until they have no more cells along a side, those of distances at most once.
_MOST_CELLS = 64
# Distances are known to this fraction of the longest side: a part that reaches further would appear in one piece.
FARTHEST = 0.25
# Solids are compared within a Gaussian of this many cells, truncated at this many standard deviations.
_AROUND, _REACH = 5.0, 2.0
# Around a place, the excess of one solid over the others, as a fraction of all that differs, is at most the first value
# where parts have moved, and at least the second where parts grow in place. Chosen by eye on double torus to bird.
_MOVED, _GROWN = 0.15, 0.4


def growing_in_place(
    depths: NDArray[np.float32], filled: Callable[[NDArray[np.float32]], NDArray[np.float32]], box: Box
) -> NDArray[np.float32]:
    """Return where solids differ by parts that only some of them have.

    Near a part that has moved, all solids fill the same amount of space, but in different places.

    Parameters
    ----------
    depths : (k, nx, ny, nz) float32
        Signed distance to the surface of every solid, positive inside; also (k, nx, ny).
    filled : callable
        Returns the fractions of cells that a solid fills at such distances.
    box : Box
        Cells of the grid.

    Returns
    -------
    (mx, my, mz) float32
        For every cell in the box, 1 around such parts, falling to 0 where parts have moved.
    """
    grid = CoarserGrid(depths.shape[1:], _MOST_CELLS)
    sigma = _AROUND / grid.cell
    means = []
    for slab in slabs(depths.shape[1:], grid.cell):
        solids = [filled(own[slab]) for own in depths]
        differing = np.maximum.reduce(solids) - np.minimum.reduce(solids)
        means.append([grid.means_in_slab(own) for own in (differing, *solids)])
    differing, *smooth = (
        gaussian_filter(np.concatenate(own), sigma, truncate=_REACH) for own in zip(*means, strict=True)
    )
    share = np.ptp(smooth, axis=0) / np.maximum(differing, 1e-4)
    return grid.interpolated(smooth_step(share, _MOVED, _GROWN), box)


def extend(depth: NDArray[np.float32], known: float) -> None:
    """Extend signed distances from a surface, positive inside, in place.

    New distances are clipped at a quarter of the longest side, and up to a cell of the coarser grid too short.

    Parameters
    ----------
    depth : (nx, ny, nz) float32
        In cells, clipped at some distance; also (nx, ny).
    known : float
        Distances up to this one are kept.
    """
    # With cells of more than two, means of distances have errors larger than the band in which they are made exact, and
    # their surface crumbles. A flat grid may have as many cells in all as one in space.
    most = max(round(_MOST_CELLS ** (3 / depth.ndim)), -(-max(depth.shape) // 2))
    grid = CoarserGrid(depth.shape, most)
    inside = depth > 0.0
    reach = FARTHEST * max(depth.shape) / grid.cell
    outward, inward = (capped_distances(grid.holding(part), reach) for part in (inside, ~inside))
    distances = grid.cell * (inward - outward)
    for slab in slabs(depth.shape):
        own, far = depth[slab], grid.interpolated(distances, slab)
        longer = np.where(inside[slab], np.maximum(far, own), np.minimum(far, own))
        np.copyto(own, longer, where=np.abs(own) >= known)
