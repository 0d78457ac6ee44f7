# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean of solids that nearly coincide: averaging signed distances keeps all shared detail.

Next to the surface, distances follow from the filled fractions of cells, exactly where faces are plane. Further away,
they are distances of cells.

Where only some solids have a part, such as a feather or the arc of a ring, it grows out of what they share, or retracts
into it (:mod:`.mean_solid`). Transport would bring its mass from elsewhere, in pieces. Where a part lies beside its
counterpart, the mean of the distances would lose both, and the barycenter is used instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.special import ndtr

from ...geometry.arrays.steps import smooth_step
from ...geometry.grids.boxes import box_around, slabs
from ...geometry.level_sets.plane_depths import plane_depths
from ...geometry.level_sets.thin_parts import normalized_solid
from .growing_parts import extend, growing_in_place
from .mean_solid import mean_solid
from .thickened_parts import ThickenedParts

# Blur in cells from which distances are computed, and the largest known distance in units of the blur.
_BLUR, _KNOWN = 0.7, 2.6
# Distances from fractions are kept up to this many cells where those to the surface are computed; further away, they
# magnify the errors of the fractions.
_SURE = 1.0
# Solids agree where their distances differ by at most this many cells. Beyond that, agreement falls off like a Gaussian
# of the second width, and is smoothed over the third, so that no seam is visible.
_APART, _FALL, _SMOOTH = 1.2, 0.3, 1.5
# The smoothing is truncated at so many of its standard deviations.
_TRUNCATE = 4.0
# A point of the surface belongs to no agreeing part if its agreement is below this.
_AGREED = 0.5
# Where solids disagree on less than the first fraction of the surface, the mean is used there, too; from the second
# fraction on, the barycenter.
_SMALL_REST, _LARGE_REST = 0.12, 0.25
# Solids coincide if they disagree on at most this fraction of the surface.
_LEAST_REST = 1e-3


@dataclass(frozen=True)
class CoincidingSolids:
    """The mean of several solids, and where they agree.

    Attributes
    ----------
    density : (nx, ny, nz) float32
        The mean solid, blurred like densities before surface extraction; one half on its surface.
    agreement : (nx, ny, nz) float32
        1 where the solids nearly coincide, falling to 0 elsewhere.
    depths : (k, nx, ny, nz) float32
        Signed distance to the surface of every solid in cells, positive inside, to half a cell or better near it, and
        clipped as by :func:`.growing_parts.extend`.
    surplus : float
        Volume in cells that has been added to thin parts where the solids agree.
    """

    density: NDArray[np.float32]
    agreement: NDArray[np.float32]
    depths: NDArray[np.float32]
    surplus: float = 0.0

    @classmethod
    def of(
        cls,
        occupancies: Sequence[NDArray[np.floating]],
        weights: Sequence[float],
        volume: float | None = None,
        middles: Sequence[NDArray[np.float64]] | None = None,
    ) -> CoincidingSolids:
        """Average solids.

        Parameters
        ----------
        occupancies : sequence of (nx, ny, nz)
            Fraction of every cell that each solid fills.
        weights : (k,)
            Weights of the mean, of sum 1.
        volume : float, optional
            Volume of the mean in cells, without `surplus`; see :func:`.mean_solid.mean_solid`.
        middles : sequence of (m, 3) float64, optional
            Points in the middle of the thin parts of every solid, in cells; these parts are thickened, see
            :mod:`.thickened_parts`.
        """
        depths = np.empty((len(occupancies), *occupancies[0].shape), np.float32)
        for own, occupancy in zip(depths, occupancies, strict=True):
            own[...] = _depth(occupancy)
        thin = [()] * len(depths) if middles is None else middles
        thickened = [ThickenedParts.of(*own) for own in zip(depths, occupancies, thin, strict=True)]
        agreement = _agreement(depths, weights)
        _raise_beside_parts(agreement, depths)
        for own in depths:
            extend(own, 0.99 * _KNOWN * _BLUR)
        if volume is not None:
            volume += sum(weight * own.volume() for weight, own in zip(weights, thickened, strict=True))
        solids = cls(_blurred(mean_solid(depths, weights, _SURE, volume)), agreement, depths)._sparing_small_rests()
        surplus = sum(weight * own.volume(solids.agreement) for weight, own in zip(weights, thickened, strict=True))
        return replace(solids, surplus=float(surplus))

    def _sparing_small_rests(self) -> CoincidingSolids:
        """Let the solids agree everywhere if they disagree on little of the surface."""
        spared = smooth_step(self.disagreement, _LARGE_REST, _SMALL_REST)
        if spared == 0.0:
            return self
        if spared == 1.0:
            # One number stands for all cells.
            return replace(self, agreement=np.broadcast_to(np.float32(1.0), self.density.shape))
        raised = np.maximum(self.agreement, np.float32(spared))
        return replace(self, agreement=raised)

    @cached_property
    def disagreement(self) -> float:
        """Fraction of the mean surface where the solids do not coincide."""
        band = (self.density > 0.2) & (self.density < 0.8)
        return float((self.agreement[band] < _AGREED).mean()) if band.any() else 1.0

    @property
    def coincide(self) -> bool:
        """Whether the solids coincide everywhere, so that nothing is left to transport."""
        return self.disagreement <= _LEAST_REST

    def mixed(self, density: NDArray[np.floating], box: tuple[slice, ...]) -> NDArray[np.float32]:
        """Combine this density where the solids agree with another density elsewhere.

        Parameters
        ----------
        density : (mx, my, mz)
            The barycenter, about one inside and one half on the surface.
        box : tuple of slice
            Its box on the grid.
        """
        own, agreement = self.density[box], self.agreement[box]
        return agreement * own + (np.float32(1) - agreement) * density.astype(np.float32)


def _agreement(depths: NDArray[np.float32], weights: Sequence[float]) -> NDArray[np.float32]:
    """Return where distances next to the mean surface differ little, 1, or much, falling to 0."""
    weights = np.asarray(weights, np.float32)
    spread, near = np.empty(depths.shape[1:], np.float32), np.empty(depths.shape[1:], bool)
    for slab in slabs(near.shape):
        own = depths[:, *slab]
        # Far from all surfaces, all solids agree.
        near[slab] = np.abs(np.tensordot(weights, own, 1)) < _KNOWN * _BLUR
        spread[slab] = np.where(near[slab], np.ptp(own, axis=0), np.float32(0))
    apart = spread > _APART
    if not apart.any():
        return np.ones(apart.shape, np.float32)
    # Means of the spread exceed it only as far from these cells as the smoothing reaches.
    outer = box_around(apart, 2 * int(_TRUNCATE * _SMOOTH + 0.5))
    smooth, about = (
        gaussian_filter(values[outer].astype(np.float32), _SMOOTH, truncate=_TRUNCATE) for values in (spread, near)
    )
    smooth /= np.maximum(about, np.float32(1e-3), out=about)
    typical = np.maximum(spread[outer], smooth, out=smooth)
    # On fine grids, it is large.
    del spread
    agreement, differing = np.ones(apart.shape, np.float32), typical > _APART
    agreement[outer][differing] = np.exp(-np.square((typical[differing] - _APART) / _FALL))
    return agreement


def _raise_beside_parts(agreement: NDArray[np.float32], depths: NDArray[np.float32]) -> None:
    """Raise the agreement, in place, around parts that only some solids have."""
    differing = agreement < 1.0
    if differing.any():
        box = box_around(differing, 0)
        np.maximum(agreement[box], growing_in_place(depths, _blurred, box), out=agreement[box])


def _blurred(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the density of a blurred solid at signed distances in cells; beyond the known ones it is 0 or 1."""
    density = np.empty(depth.shape, np.float32)
    for slab in slabs(depth.shape):
        own, found = depth[slab].ravel(), (depth[slab] > 0.0).astype(np.float32).ravel()
        near = np.flatnonzero(np.abs(own) < 0.99 * _KNOWN * _BLUR)
        found[near] = ndtr(own[near] / np.float32(_BLUR))
        density[slab] = found.reshape(density[slab].shape)
    return density


def _depth(occupancy: NDArray[np.floating]) -> NDArray[np.float32]:
    """Signed distance to the surface of a solid in cells, positive inside, clipped where it is unknown."""
    # Thin parts, whose density never reaches one half, count as surfaces, too.
    density = normalized_solid(_fractions_blurred(occupancy), _BLUR)
    least = float(ndtr(-_KNOWN))
    # Distances far from the surface are unknown, which concerns most cells.
    depth = np.where(density > 0.5, np.float32(_KNOWN * _BLUR), np.float32(-_KNOWN * _BLUR))
    near = np.flatnonzero((density > least) & (density < 1.0 - least))
    depth.ravel()[near] = np.clip(plane_depths(density, near, _BLUR), -_KNOWN * _BLUR, _KNOWN * _BLUR)
    return depth


def _fractions_blurred(occupancy: NDArray[np.floating]) -> NDArray[np.float32]:
    """Blur the fraction that a solid fills of every cell."""
    blurred = np.zeros(occupancy.shape, np.float32)
    inside = occupancy > 0.0
    if inside.any():
        # A blur fills no other cells.
        box = box_around(inside, int(_TRUNCATE * _BLUR + 0.5))
        gaussian_filter(occupancy[box].astype(np.float32, copy=False), _BLUR, truncate=_TRUNCATE, output=blurred[box])
    return blurred
