# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Decide which of many cuts preserve the topology of a set of cells, from one labelling of what remains after all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import generate_binary_structure, label

from ..grids.labelling import Pieces

# Face neighbors of a cell in the last three of four axes.
_WITHIN_WINDOWS = generate_binary_structure(4, 1) & (np.arange(3) == 1)[:, None, None, None]


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
        self._plugs = _plugs(removed, Pieces.of(left), inside)

    def take(self, cut: int) -> bool:
        """Apply a cut unless it would disconnect regions or make a hollow; return whether it was applied."""
        if cut not in self._plugs:
            return False
        own = self._plugs[cut]
        gone = set().union(*(plug.cells for plug in own))
        # Plugs that share cells with the cut no longer connect anything.
        others = {
            key: [plug for plug in plugs if plug.cells.isdisjoint(gone)]
            for key, plugs in self._plugs.items()
            if key != cut
        }
        links = [plug.regions for plugs in others.values() for plug in plugs]
        if not all(plug.is_open and _are_connected(plug.regions, links) for plug in own):
            return False
        self._plugs = others
        return True


def _plugs(
    removed: Mapping[int, NDArray[np.int64]], regions: Pieces, inside: NDArray[np.bool_]
) -> dict[int, list[_Plug]]:
    """Return the components of the cells that each cut removes."""
    sizes = [len(taken) for taken in removed.values()]
    taken, cut = np.concatenate(list(removed.values())), np.repeat(np.arange(len(sizes)), sizes)
    names = _components(removed)
    places = np.ravel_multi_index(tuple(taken.T), regions.shape)
    # Include edge neighbors, since the surface between cells may connect these as well.
    steps = np.ravel_multi_index(np.indices((3, 3, 3)).reshape(3, -1), regions.shape)
    steps -= steps[13]
    touched = regions.at((places[:, None] + steps).ravel()).reshape(-1, len(steps))
    is_open = ~inside.ravel()[places[:, None] + steps[[4, 10, 12, 14, 16, 22]]].all(axis=1)
    order = np.argsort(names, kind="stable")
    ends = np.searchsorted(names[order], np.arange(1, int(names.max()) + 2))
    plugs: dict[int, list[_Plug]] = {key: [] for key in removed}
    keys = list(removed)
    for start, end in pairwise(ends):
        own = order[start:end]
        plug = _Plug(set(places[own].tolist()), set(touched[own].ravel().tolist()) - {0}, bool(is_open[own].any()))
        plugs[keys[cut[own[0]]]].append(plug)
    return plugs


def _components(removed: Mapping[int, NDArray[np.int64]]) -> NDArray[np.int64]:
    """Return the component of every removed cell, 1, 2, ...; those of different cuts have different ones."""
    lows = [taken.min(axis=0) for taken in removed.values()]
    sizes = np.max([taken.max(axis=0) - low + 1 for taken, low in zip(removed.values(), lows, strict=True)], axis=0)
    windows = np.zeros((len(lows), *sizes), bool)
    places = np.concatenate(
        [
            np.column_stack([np.full(len(taken), index), taken - low])
            for index, (taken, low) in enumerate(zip(removed.values(), lows, strict=True))
        ]
    )
    windows[tuple(places.T)] = True
    return label(windows, _WITHIN_WINDOWS)[0][tuple(places.T)]


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
