# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Repair the topology of flat blends: drop crumbs, fill false holes, bridge narrow gaps.

Like :mod:`.mending` for solids; in the plane, only regions and holes need to be counted.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label, minimum

from .bumps import Bump
from .contours import LevelOutline, outline_enclosing
from .gaps import densest_gaps
from .handle_places import RAISED

# Chosen by eye, like those of `mending`.
# Regions below the first fraction of the area are crumbs and dropped. Regions below the second are strays, dropped only
# if no narrow gap leads to them.
_CRUMB_SHARE, _STRAY_SHARE = 5e-4, 5e-3
# A gap is narrow where its density does not fall below this fraction of the level. A hole is false if it is no deeper
# than that, or as small as a stray; deep and wide holes belong to the blend.
_DEEPEST_GAP = 0.3
# Least and largest radius of a bridge in cells.
_NECK, _WIDEST_NECK = 2.0, 4.0
_ATTEMPTS = 24
_ROUNDS = 4
_ALL_AROUND = np.ones((3, 3), bool)


@dataclass(frozen=True)
class FlatConnectivity:
    """The topology of a flat shape.

    Attributes
    ----------
    regions, holes : int
        Numbers of connected regions and of holes in them.
    """

    regions: int
    holes: int

    @classmethod
    def of(cls, drawn: LevelOutline) -> FlatConnectivity:
        """Count the regions and holes of an outline."""
        return cls(len(drawn.outline.regions), drawn.outline.holes)

    def or_more(self, other: FlatConnectivity) -> FlatConnectivity:
        """Return the larger of each pair of numbers."""
        return FlatConnectivity(max(self.regions, other.regions), max(self.holes, other.holes))

    def beyond(self, most: FlatConnectivity) -> int:
        """Return the total number of regions and holes in excess of another's."""
        return max(self.regions - most.regions, 0) + max(self.holes - most.holes, 0)


@dataclass(frozen=True)
class FlatMending:
    """An outline and how it was repaired.

    Attributes
    ----------
    drawn : LevelOutline
        The outline that encloses the area.
    density : (nx, ny)
        The density that it was extracted from.
    crumbs, filled, bridged : int
        Numbers of dropped regions, filled holes and bridged gaps.
    """

    drawn: LevelOutline
    density: NDArray[np.floating] = field(compare=False)
    crumbs: int = 0
    filled: int = 0
    bridged: int = 0

    @property
    def found(self) -> FlatConnectivity:
        """The topology of the outline."""
        return FlatConnectivity.of(self.drawn)

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        mended = {name: getattr(self, name) for name in ("crumbs", "filled", "bridged")}
        return {"found": asdict(self.found), "mended": mended}


def mended_outline(density: NDArray[np.floating], area: float, most: FlatConnectivity) -> FlatMending:
    """Extract the outline that encloses an area, with no more regions and holes than allowed.

    Only small changes are made. Defects that would need larger ones remain and are listed in the record.

    Parameters
    ----------
    density : (nx, ny)
        The density of the blend.
    area : float
        In cells.
    most : FlatConnectivity
        Largest numbers of regions and holes: those of the input shapes.

    Raises
    ------
    InputError
        As for :func:`.outline_enclosing`.
    """
    best = mending = FlatMending(outline_enclosing(density, area), density)
    work = None
    for _ in range(_ROUNDS):
        if best.found.beyond(most) == 0:
            break
        if work is None:
            work = np.array(density, dtype=np.float64)
        before = mending
        mending = _mended(work, mending, area, most)
        if mending == before:
            break
        mending = replace(mending, drawn=outline_enclosing(work, area))
        if mending.found.beyond(most) < best.found.beyond(most):
            best = replace(mending, density=work.copy())
    return best


def regions_above(density: NDArray[np.floating], level: float) -> tuple[NDArray[np.int32], int]:
    """Label the cells, (nx, ny), above a level, connected through sides; return the number of regions."""
    return label(density > level)


def holes_below(density: NDArray[np.floating], level: float) -> tuple[NDArray[np.int32], int]:
    """Label the cells, (nx, ny), in holes, connected through sides and corners; return the number of holes."""
    labels, count = label(np.pad(density <= level, 1, constant_values=True), _ALL_AROUND)
    # The first label is the outside.
    return np.maximum(labels[1:-1, 1:-1] - 1, 0), count - 1


def _mended(density: NDArray[np.float64], mending: FlatMending, area: float, most: FlatConnectivity) -> FlatMending:
    """Repair defects at the present level in place."""
    level = mending.drawn.level
    mending = _with_fewer_regions(density, mending, area, most.regions)
    labels, count = holes_below(density, level)
    excess = count - most.holes
    if excess > 0:
        sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
        depths = minimum(density, labels, np.arange(1, count + 1))
        false = np.flatnonzero((sizes < _STRAY_SHARE * area) | (depths > _DEEPEST_GAP * level))
        smallest = false[np.argsort(sizes[false], kind="stable")[:excess]]
        filled = binary_dilation(np.isin(labels, 1 + smallest))
        density[filled] = np.maximum(density[filled], RAISED * level)
        mending = replace(mending, filled=mending.filled + len(smallest))
    return mending


def _with_fewer_regions(density: NDArray[np.float64], mending: FlatMending, area: float, most: int) -> FlatMending:
    """Drop crumbs and bridge gaps, densest first."""
    level = mending.drawn.level
    for _ in range(_ATTEMPTS):
        labels, count = regions_above(density, level)
        if count <= most:
            break
        shares = np.bincount(labels.ravel(), minlength=count + 1)[1:] / area
        crumbs = _drop(density, labels, level, shares < _CRUMB_SHARE)
        excess = count - crumbs - most
        # The gap search works in 3D; the plane is a single layer.
        gaps = []
        if excess > 0:
            gaps = densest_gaps(density[..., None], labels[..., None], _DEEPEST_GAP * level, excess)
        for gap in gaps:
            radius = min(_NECK + gap.width / 2, _WIDEST_NECK)
            Bump.to(density, gap.place[:2], RAISED * level, radius).apply(density)
        strays = 0
        if not gaps and not crumbs:
            strays = _drop(density, labels, level, shares < _STRAY_SHARE)
        mending = replace(mending, crumbs=mending.crumbs + crumbs + strays, bridged=mending.bridged + len(gaps))
        if not gaps and not crumbs and not strays:
            break
    return mending


def _drop(density: NDArray[np.float64], labels: NDArray[np.int32], level: float, wanted: NDArray[np.bool_]) -> int:
    """Lower some regions to half the level, clear their labels, and return their number."""
    if wanted.any():
        crumbs = np.append(False, wanted)[labels]
        labels[crumbs] = 0
        around = binary_dilation(crumbs) & ((density <= level) | crumbs)
        density[around] = np.minimum(density[around], level / 2)
    return int(wanted.sum())
