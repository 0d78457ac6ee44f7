# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Group items by their labels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

# So many items and more are sorted in less time by counting their labels than by comparing them.
_FEW = 8192


def label_groups(labels: NDArray[np.integer], count: int) -> list[NDArray[np.int64]]:
    """Return for each of `count` labels, from 0, the indices of the items with this label, ascending.

    Parameters
    ----------
    labels : (n,) int
        The label of every item.
    count : int
        At least 1.
    """
    order = label_order(labels, count)
    return np.split(order, np.cumsum(np.bincount(labels, minlength=count))[:-1])


def label_order(labels: NDArray[np.integer], count: int) -> NDArray[np.int64]:
    """Return the stable order of items by label, (n,); parameters as for :func:`label_groups`."""
    if len(labels) < _FEW:
        return np.argsort(labels, kind="stable")
    # Reading a matrix with one entry in every column row by row counts the labels instead of comparing them.
    places = np.arange(len(labels) + 1, dtype=np.int32)
    by_item = csc_array((places[:-1], labels.astype(np.int32), places), shape=(count, len(labels)))
    return by_item.tocsr().indices.astype(np.int64)
