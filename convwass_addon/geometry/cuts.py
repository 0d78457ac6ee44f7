# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Decide which of many cuts preserve the topology of a set of cells, from one labelling of what remains after all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from .labelling import Pieces


@dataclass(frozen=True)
class _Plug:
    """A connected component of the cells that a cut removes.

    Attributes
    ----------
    cells, regions : set of int
        The cells, and the labels of the regions that they connect.
    is_open : bool
        Whether the cells touch the outside of the set, so that removing them makes no hollow.
    """

    cells: set[int]
    regions: set[int]
    is_open: bool


class Cuts:
    """Cuts that can be applied one after the other.

    Parameters
    ----------
    inside : (nx, ny, nz) bool
        The set. No cut may remove cells at the boundary of the grid.
    removed : mapping of int to (m, 3) int64
        The cells that each cut removes, all of them inside the set.
    """

    def __init__(self, inside: NDArray[np.bool_], removed: Mapping[int, NDArray[np.int64]]) -> None:
        self._plugs: dict[int, list[_Plug]] = {}
        if not removed:
            return
        left = inside.copy()
        for taken in removed.values():
            left[tuple(taken.T)] = False
        regions = Pieces.of(left)
        for cut, taken in removed.items():
            self._plugs[cut] = _plugs(taken, regions, inside)

    def take(self, cut: int) -> bool:
        """Apply a cut unless it would disconnect regions or make a hollow; return whether it was applied."""
        if cut not in self._plugs:
            return False
        own = self._plugs[cut]
        gone = set().union(*(plug.cells for plug in own))
        # Plugs that share cells with the cut no longer connect anything.
        others = {
            key: [plug for plug in plugs if not plug.cells & gone] for key, plugs in self._plugs.items() if key != cut
        }
        links = [plug.regions for plugs in others.values() for plug in plugs]
        if not all(plug.is_open and _are_connected(plug.regions, links) for plug in own):
            return False
        self._plugs = others
        return True


def _plugs(taken: NDArray[np.int64], regions: Pieces, inside: NDArray[np.bool_]) -> list[_Plug]:
    low = taken.min(axis=0)
    window = np.zeros(taken.max(axis=0) - low + 1, bool)
    window[tuple((taken - low).T)] = True
    names = label(window)[0][tuple((taken - low).T)]
    places = np.ravel_multi_index(tuple(taken.T), regions.shape)
    # Include edge neighbors, since the surface between cells may connect these as well.
    steps = np.ravel_multi_index(np.indices((3, 3, 3)).reshape(3, -1), regions.shape)
    steps -= steps[13]
    faces = steps[[4, 10, 12, 14, 16, 22]]
    plugs = []
    for name in range(1, int(names.max()) + 1):
        cells = places[names == name]
        touched = regions.at((cells[:, None] + steps).ravel())
        is_open = not inside.ravel()[cells[:, None] + faces].all()
        plugs.append(_Plug(set(cells.tolist()), set(touched.tolist()) - {0}, is_open))
    return plugs


def _are_connected(regions: set[int], links: list[set[int]]) -> bool:
    """Return whether regions are connected by links, each of which connects several regions."""
    if not regions:
        return True
    reached = {next(iter(regions))}
    before = 0
    while len(reached) > before:
        before = len(reached)
        reached.update(*(link for link in links if link & reached))
    return regions <= reached
