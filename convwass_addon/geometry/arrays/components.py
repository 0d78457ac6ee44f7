# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected components of graphs that are given by their edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def component_labels(tails: ArrayLike, heads: ArrayLike, count: int) -> NDArray[np.int64]:
    """Label the nodes of an undirected graph by connected component, in the order of their first nodes.

    Parameters
    ----------
    tails, heads : (e,) int
        The nodes that every edge connects, in any order; edges may be repeated.
    count : int
        Number of nodes.

    Returns
    -------
    (count,) int64
        Labels from 0.
    """
    graph = coo_array((np.ones(len(np.asarray(tails)), np.int8), (tails, heads)), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
