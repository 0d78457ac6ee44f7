# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of many cuts leave the pieces of a set of cells whole, told from one labelling of what is left by all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from .labelling import Pieces


@dataclass(frozen=True)
class _Plug:
    """Cells that hang together and that a cut takes out.

    Attributes
    ----------
    cells, regions : set of int
        Which, and what they hold together.
    is_open : bool
        Whether what is left in their place joins the rest of what does not belong to the set.
    """

    cells: set[int]
    regions: set[int]
    is_open: bool


class Cuts:
    """Cuts that may be taken one after the other.

    Parameters
    ----------
    inside : (nx, ny, nz) bool
        The set. No cut may take cells at the grid's walls.
    removed : mapping of int to (m, 3) int64
        The cells that each cut takes out, all of them inside.
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
        """Take a cut unless it parts what nothing else is known to hold together, or makes a hollow; tell if it was."""
        if cut not in self._plugs:
            return False
        own = self._plugs[cut]
        gone = set().union(*(plug.cells for plug in own))
        # What shares cells with the cut holds nothing together any more.
        others = {
            key: [plug for plug in plugs if not plug.cells & gone] for key, plugs in self._plugs.items() if key != cut
        }
        links = [plug.regions for plugs in others.values() for plug in plugs]
        if not all(plug.is_open and _hang_together(plug.regions, links) for plug in own):
            return False
        self._plugs = others
        return True


def _plugs(taken: NDArray[np.int64], regions: Pieces, inside: NDArray[np.bool_]) -> list[_Plug]:
    low = taken.min(axis=0)
    window = np.zeros(taken.max(axis=0) - low + 1, bool)
    window[tuple((taken - low).T)] = True
    names = label(window)[0][tuple((taken - low).T)]
    places = np.ravel_multi_index(tuple(taken.T), regions.shape)
    # The surface between cells may also join what touches along an edge.
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


def _hang_together(regions: set[int], links: list[set[int]]) -> bool:
    """Tell whether regions are joined by links, each of which joins some."""
    if not regions:
        return True
    reached = {next(iter(regions))}
    before = 0
    while len(reached) > before:
        before = len(reached)
        reached.update(*(link for link in links if link & reached))
    return regions <= reached
