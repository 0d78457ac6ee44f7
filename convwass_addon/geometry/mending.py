# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mend what transport tears: crumbs are dropped, bubbles filled, narrow gaps bridged, false handles cut or filled.

The level set of a blend follows every wrinkle of its density. Where a density next to the level would give another
topology, and the shapes have that one, it is raised or lowered a little around the cell that decides.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label
from scipy.spatial import cKDTree

from .edges import vertex_components
from .isosurface import LevelSurface, bounding_box, euler_number_within, surface_enclosing
from .saddles import saddles

# Pieces of a smaller share of the volume are crumbs; those of less than the other are strays where no narrow gap leads
# to them, and are dropped as well.
_CRUMB_SHARE, _STRAY_SHARE = 5e-4, 5e-3
# A gap is narrow where the density in it does not fall below this share of the level; a handle is false where the level
# is within the other of the density of its thinnest place, or of that in its hole.
_DEEPEST_GAP = 0.3
_FALSE_HANDLE = 0.5
# Wide necks would swell: a wide gap is bridged in several steps.
_WIDEST_NECK = 2.0
# Cells on either side of a gap that are looked at.
_WIDEST_GAP = 10
# Steps of the search for the level at which two pieces meet, and how often a surface is taken anew at most.
_BISECTED = 8
_ATTEMPTS = 24
# Density over the level where cells are raised, and where they are lowered, and the radii of it in cells.
_RAISED, _LOWERED = 1.1, 0.85
# The surface between cells may pass a saddle of the cells that lies closer to the level than this.
_SLACK = 0.95
_RADIUS, _WIDER = 1.5, 2.25
# How far a change reaches, in radii; how often handles are looked for, and at how many places.
_REACH = 4.0
_ROUNDS = 5
_TRIED = 80


@dataclass(frozen=True)
class Connectivity:
    """How a solid hangs together.

    Attributes
    ----------
    pieces, handles, bubbles : int
        Parts apart from each other, holes through them, and hollows inside them.
    """

    pieces: int
    handles: int
    bubbles: int

    @classmethod
    def of(cls, surface: LevelSurface) -> Connectivity:
        """Count what a closed surface has; every vertex belongs to triangles, every edge to two of them."""
        mesh = surface.mesh
        pieces = vertex_components(mesh)[mesh.faces[:, 0]]
        volumes = np.bincount(pieces, weights=mesh.face_volumes)
        # Edges are three halves of the triangles.
        euler = len(mesh.vertices) - len(mesh.faces) // 2
        bubbles = int((volumes < 0).sum())
        return cls(len(volumes) - bubbles, len(volumes) - euler // 2, bubbles)

    def or_more(self, other: Connectivity) -> Connectivity:
        """Return the larger number of each kind."""
        return Connectivity(
            max(self.pieces, other.pieces), max(self.handles, other.handles), max(self.bubbles, other.bubbles)
        )


@dataclass(frozen=True)
class Mending:
    """A surface and what was done to get it.

    Attributes
    ----------
    surface : LevelSurface
        Encloses the volume.
    found : Connectivity
        What it has.
    crumbs, filled, bridged, unhandled : int
        Pieces too small to matter that were dropped, bubbles that were filled, gaps that were bridged, handles that
        were cut or filled.
    """

    surface: LevelSurface
    found: Connectivity
    crumbs: int
    filled: int
    bridged: int
    unhandled: int

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        return {
            "found": asdict(self.found),
            "mended": {name: getattr(self, name) for name in ("crumbs", "filled", "bridged", "unhandled")},
        }


def mended_surface(density: NDArray[np.floating], volume: float, most: Connectivity) -> Mending:
    """Surface that encloses a volume, with no more pieces, handles and bubbles than asked for.

    Only small changes are made. What would take more stays as it is: the record tells.

    Parameters
    ----------
    density : (nx, ny, nz)
        What to take the surface of.
    volume : float
        In cells.
    most : Connectivity
        As many as the shapes have that are blended.

    Raises
    ------
    InputError
        As :func:`surface_enclosing` does.
    """
    density = np.asarray(density, dtype=np.float64)
    # What is thinner than the deepest gap plays no part.
    box, low = _box_of_interest(density, volume)
    work = _Work(density[box], volume)
    work.join_pieces(most.pieces)
    work.remove_handles(most.handles)
    work.fill_bubbles(most.bubbles)
    surface = LevelSurface(work.surface.mesh.moved(low), work.surface.level)
    return Mending(surface, work.found, work.crumbs, work.filled, work.bridged, work.unhandled)


class _Work:
    """A density that is changed step by step, and its surface."""

    def __init__(self, density: NDArray[np.float64], volume: float) -> None:
        self.volume = volume
        self.crumbs = self.filled = self.bridged = self.unhandled = 0
        self._take(density, None)

    def _take(self, density: NDArray[np.float64], near: float | None) -> None:
        self.density = density
        self.surface = surface_enclosing(density, self.volume, near)
        self.found = Connectivity.of(self.surface)

    def join_pieces(self, most: int) -> None:
        """Drop crumbs and bridge gaps, the densest gap first."""
        for _ in range(_ATTEMPTS):
            if self.found.pieces <= most:
                return
            level, density = self.surface.level, self.density
            labels, count = label(density > level)
            shares = np.bincount(labels.ravel())[1:] / self.volume
            density, crumbs = _dropped(density, labels, shares < _CRUMB_SHARE, level)
            bridged = _bridged(density, labels, level) if count - crumbs > most else None
            if bridged is None and not crumbs:
                density, crumbs = _dropped(density, labels, shares < _STRAY_SHARE, level)
                if not crumbs:
                    return
            self._take(density if bridged is None else bridged, level)
            self.crumbs += crumbs
            self.bridged += bridged is not None

    def remove_handles(self, most: int) -> None:
        """Cut or fill handles, those that take the smallest change first."""
        best, crumbs, bridged = (self.density, self.surface, self.found), self.crumbs, self.bridged
        for _ in range(_ROUNDS):
            excess = self.found.handles - most
            changed = _with_fewer_handles(self.density, self.surface.level, excess) if excess > 0 else None
            if changed is None:
                break
            self._take(changed, self.surface.level)
            # The level moves a little, and what hung on by a thread may come off.
            self.join_pieces(best[2].pieces)
            if self.found.handles < best[2].handles and self.found.pieces <= best[2].pieces:
                self.unhandled += best[2].handles - self.found.handles
                best, crumbs, bridged = (self.density, self.surface, self.found), self.crumbs, self.bridged
        self.density, self.surface, self.found = best
        self.crumbs, self.bridged = crumbs, bridged

    def fill_bubbles(self, most: int) -> None:
        """Fill the smallest hollows."""
        for _ in range(_ATTEMPTS):
            if self.found.bubbles <= most:
                break
            # Outside is what hangs together with a rim around the grid.
            hollow, count = label(np.pad(self.density <= self.surface.level, 1, constant_values=True))
            sizes = np.bincount(hollow.ravel(), minlength=count + 1).astype(float)
            sizes[[0, hollow[0, 0, 0]]] = np.inf
            smallest = hollow[1:-1, 1:-1, 1:-1] == np.argmin(sizes)
            if not np.isfinite(sizes.min()):
                break
            level = self.surface.level
            self._take(np.where(smallest, np.maximum(self.density, _RAISED * level), self.density), level)
            self.filled += 1


def _box_of_interest(density: NDArray[np.float64], volume: float) -> tuple[tuple[slice, ...], NDArray[np.int64]]:
    """Return the box that holds all that mending may look at, and its low corner."""
    positive = density[density > 0]
    rank = max(len(positive) - 1 - int(volume), 0)
    level = np.partition(positive, rank)[rank] if len(positive) else 0.0
    if level <= 0.0:
        return (slice(None),) * 3, np.zeros(3, np.int64)
    low, high = bounding_box(density > _DEEPEST_GAP / 2 * level)
    low, high = np.maximum(low - 1, 0), np.minimum(high + 1, density.shape)
    return tuple(slice(a, b) for a, b in zip(low, high, strict=True)), low


def _dropped(
    density: NDArray[np.float64], labels: NDArray[np.int32], wanted: NDArray[np.bool_], level: float
) -> tuple[NDArray[np.float64], int]:
    """Press some pieces down to half of the level, so that a slightly lower level does not bring them back.

    Their labels are cleared; the second result is how many there were.
    """
    if not wanted.any():
        return density, 0
    crumbs = np.append(False, wanted)[labels]
    labels[crumbs] = 0
    around = binary_dilation(crumbs) & ((density <= level) | crumbs)
    return np.where(around, np.minimum(density, level / 2), density), int(wanted.sum())


def _bridged(density: NDArray[np.float64], labels: NDArray[np.int32], level: float) -> NDArray[np.float64] | None:
    """Give the first two pieces that meet as the level falls a neck; None where all gaps are too deep."""
    inside = labels > 0
    pieces = _pieces_above(density, inside, level)
    low, high = _DEEPEST_GAP, 1.0
    if _pieces_above(density, inside, low * level) == pieces:
        return None
    for _ in range(_BISECTED):
        middle = (low + high) / 2
        low, high = (low, middle) if _pieces_above(density, inside, middle * level) == pieces else (middle, high)
    place, gap = _meeting_place(density, labels, low * level, high * level)
    return _changed(density, place, _RAISED * level, min(_RADIUS + gap / 2, _WIDEST_NECK))


def _pieces_above(density: NDArray[np.float64], inside: NDArray[np.bool_], level: float) -> int:
    """Count the pieces above a lower level that hold something of the inside."""
    merged, count = label(density > level)
    return count if count <= 1 else int((np.bincount(merged[inside], minlength=count + 1) > 0).sum())


def _meeting_place(
    density: NDArray[np.float64], labels: NDArray[np.int32], low: float, high: float
) -> tuple[tuple[int, ...], float]:
    """Find the cell between two levels through which two pieces meet first, and how wide their gap is there."""
    merged, _ = label(density > low)
    parts, _ = label(density > high)
    inside = labels > 0
    homes = {int(part): int(merged[parts == part][0]) for part in np.unique(parts[inside])}
    home = next(h for h in homes.values() if list(homes.values()).count(h) > 1)
    met = [part for part, its_home in homes.items() if its_home == home][:2]
    candidates = np.argwhere((merged == home) & (density <= high))
    # What is far from all of them is not what they join.
    low_corner, high_corner = candidates.min(axis=0) - _WIDEST_GAP, candidates.max(axis=0) + _WIDEST_GAP + 1
    window = tuple(slice(max(a, 0), b) for a, b in zip(low_corner, high_corner, strict=True))
    start = np.array([span.start for span in window])
    candidates, parts, inside = candidates - start, parts[window], inside[window]
    to_parts = [_distances(candidates, np.argwhere(parts == part)) for part in met]
    chosen = int(np.argmin(to_parts[0] + to_parts[1]))
    place = candidates[chosen : chosen + 1]
    gap = sum(float(_distances(place, np.argwhere((parts == part) & inside))[0]) for part in met)
    return tuple(int(i) for i in place[0] + start), gap


def _distances(cells: NDArray[np.int64], others: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the distance from each cell to the nearest of the others, and the widest gap where there are none."""
    return np.minimum(cKDTree(others).query(cells)[0], _WIDEST_GAP) if len(others) else np.full(len(cells), _WIDEST_GAP)


def _with_fewer_handles(density: NDArray[np.float64], level: float, excess: int) -> NDArray[np.float64] | None:
    """Move saddles near the level to its other side until so many handles have gone; None where that removes none."""
    density, left = density.copy(), excess
    pieces = _count_pieces(density, level)
    for place, wanted in _saddles_near(density, level)[:_TRIED]:
        window = _around(density.shape, place, _REACH * _WIDER)
        kept = density[window].copy()
        before = euler_number_within(kept, level)
        for radius in (_RADIUS, _WIDER):
            spans, change = _bump(density, place, wanted, radius)
            density[spans] *= change
            gained = euler_number_within(density[window], level) - before
            # Cutting a piece in two changes the Euler number as cutting a handle does.
            if gained > 0 and _count_pieces(density, level) <= pieces:
                left -= round(gained / 2)
                break
            density[window] = kept
        if left <= 0:
            break
    return density if left < excess else None


def _saddles_near(density: NDArray[np.float64], level: float) -> list[tuple[tuple[int, ...], float]]:
    """Return the saddles that may be false, the nearest to the level first, and the densities to give them."""
    found = saddles(density, level * _FALSE_HANDLE, level / _FALSE_HANDLE)
    cells = np.concatenate([found.bridges, found.lids])
    wanted = np.repeat([_LOWERED * level, _RAISED * level], [len(found.bridges), len(found.lids)])
    above = density[tuple(cells.T)] / level
    wrong = np.where(wanted < level, above > _SLACK, above < 1.0 / _SLACK)
    order = np.argsort(np.where(wrong, np.abs(np.log(above)), np.inf))[: np.count_nonzero(wrong)]
    return [(tuple(int(i) for i in cells[index]), float(wanted[index])) for index in order]


def _count_pieces(density: NDArray[np.float64], level: float) -> int:
    return label(density > level)[1]


def _changed(density: NDArray[np.float64], place: tuple[int, ...], wanted: float, radius: float) -> NDArray[np.float64]:
    """Change the density smoothly around a cell so that it has the value wanted there."""
    spans, change = _bump(density, place, wanted, radius)
    changed = density.copy()
    changed[spans] *= change
    return changed


def _bump(
    density: NDArray[np.float64], place: tuple[int, ...], wanted: float, radius: float
) -> tuple[tuple[slice, ...], NDArray[np.float64]]:
    """Return the box around a cell that such a change reaches, and by what to multiply the density there."""
    spans = _around(density.shape, place, _REACH * radius)
    squared = sum((axis - at) ** 2 for axis, at in zip(np.ogrid[spans], place, strict=True))
    return spans, 1.0 + (wanted / density[place] - 1.0) * np.exp(-squared / (2.0 * radius**2))


def _around(shape: tuple[int, ...], place: tuple[int, ...], reach: float) -> tuple[slice, ...]:
    cells = int(np.ceil(reach))
    return tuple(slice(max(at - cells, 0), min(at + cells + 1, n)) for at, n in zip(place, shape, strict=True))
