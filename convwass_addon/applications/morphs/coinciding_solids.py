# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean of solids that nearly coincide: their signed distances are averaged, which keeps every detail they share.

Next to a flat face, a solid that is blurred by sigma has the density Phi(d / sigma) at the signed distance d, so
d = sigma Phi^-1(density), which for densities of exact volume fractions is smooth to a hundredth of a cell. Where the
solids are further apart than the blur, distances say nothing, and the barycenter is taken instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.special import ndtr, ndtri

from ...geometry.thin_parts import locally_normalized

# Blur in cells by which distances are told; they are known up to so many times as much.
_BLUR, _KNOWN = 0.7, 2.6
# Solids agree where their distances differ by so many cells at the most; beyond, agreement falls off like a Gaussian of
# this width, and is smoothed over so many cells, so that no seam is seen.
_APART, _FALL, _SMOOTH = 1.2, 0.3, 1.5
# Below this share of agreeing surface the barycenter is needed somewhere.
_AGREED = 0.5
# Solids that differ on no more than this share of the surface coincide.
_LEAST_REST = 1e-3


@dataclass(frozen=True)
class CoincidingSolids:
    """What is known of the mean of several solids.

    Attributes
    ----------
    density : (nx, ny, nz) float32
        That of the mean solid, blurred as surfaces are read, one half on its surface.
    agreement : (nx, ny, nz) float32
        1 where the solids nearly coincide, falling to 0 where they do not.
    depths : (k, nx, ny, nz) float32
        Distance into every solid in cells, as far as it is known.
    """

    density: NDArray[np.float32]
    agreement: NDArray[np.float32]
    depths: NDArray[np.float32]

    @classmethod
    def of(cls, occupancies: Sequence[NDArray[np.floating]], weights: Sequence[float]) -> CoincidingSolids:
        """Average solids.

        Parameters
        ----------
        occupancies : sequence of (nx, ny, nz)
            Share of every cell that each solid fills.
        weights : (k,)
            Of the mean, of sum 1.
        """
        depths = np.stack([_depth(occupancy) for occupancy in occupancies])
        mean = np.tensordot(np.asarray(weights, np.float32), depths, 1)
        spread = np.ptp(depths, axis=0)
        # Far from all surfaces everybody agrees that there is none.
        near = np.abs(mean) < _KNOWN * _BLUR
        apart = gaussian_filter(np.where(near, spread, np.float32(0)), _SMOOTH)
        about = gaussian_filter(near.astype(np.float32), _SMOOTH)
        typical = np.maximum(np.where(near, spread, 0), apart / np.maximum(about, np.float32(1e-3)))
        agreement = np.exp(-np.square(np.maximum(typical - _APART, 0) / _FALL)).astype(np.float32)
        return cls(ndtr(mean / _BLUR).astype(np.float32), agreement, depths)

    @cached_property
    def disagreement(self) -> float:
        """Share of the mean surface where the solids do not coincide."""
        band = (self.density > 0.2) & (self.density < 0.8)
        return float((self.agreement[band] < _AGREED).mean()) if band.any() else 1.0

    @property
    def coincide(self) -> bool:
        """Whether the solids coincide everywhere, so that nothing is left to transport."""
        return self.disagreement <= _LEAST_REST

    def mixed(self, density: NDArray[np.floating], box: tuple[slice, ...]) -> NDArray[np.float32]:
        """Return a density that is this one where the solids agree, and another one where they do not.

        Parameters
        ----------
        density : (mx, my, mz)
            Of the barycenter, about one in solid parts and about one half on the surface.
        box : tuple of slice
            Where it is on the grid.
        """
        own, agreement = self.density[box], self.agreement[box]
        return agreement * own + (np.float32(1) - agreement) * density.astype(np.float32)


def _depth(occupancy: NDArray[np.floating]) -> NDArray[np.float32]:
    """Signed distance in cells into a solid, as far as its blurred occupancy tells."""
    blurred = gaussian_filter(occupancy.astype(np.float32), _BLUR)
    # Thin parts, whose density never reaches one half, count as surfaces as well.
    density = locally_normalized(blurred, float(occupancy.sum(dtype=np.float64)))
    least = float(ndtr(-_KNOWN))
    # Away from the surface distances are not known, and most cells are.
    depth = np.where(density > 0.5, np.float32(_KNOWN * _BLUR), np.float32(-_KNOWN * _BLUR))
    near = np.flatnonzero((density > least) & (density < 1.0 - least))
    depth.ravel()[near] = _BLUR * ndtri(density.ravel()[near])
    return depth
