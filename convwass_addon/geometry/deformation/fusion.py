# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fusion moves: combine the best parts of two solutions, with seams where they hardly differ.

Every vertex takes one of two proposals. The sum of the vertices' costs for their choices and of the edges' costs for
seams between their ends is minimized exactly by a minimum cut (V. Lempitsky et al., "Fusion Moves for Markov Random
Field Optimization", IEEE Transactions on Pattern Analysis and Machine Intelligence 32(8), 2010).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

# Costs are scaled to integers up to this.
_LARGEST = 1 << 20


def fused_choice(costs: NDArray[np.float64], edges: NDArray[np.int64], seams: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which vertices take the second proposal, (n,).

    Parameters
    ----------
    costs : (2, n)
        Cost of the first and of the second proposal at every vertex; nonnegative.
    edges : (e, 2) int64
        Pairs of neighbors, each once.
    seams : (e,)
        Cost of an edge whose ends choose differently; nonnegative.
    """
    count = costs.shape[1]
    highest = max(float(costs.max(initial=0.0)), float(seams.max(initial=0.0)))
    if not highest > 0:
        return np.zeros(count, bool)
    source, sink = count, count + 1
    vertices = np.arange(count)
    # Vertices on the source side take the first proposal, so their edge to the sink has its cost.
    tails = np.concatenate([np.full(count, source), vertices, edges[:, 0], edges[:, 1]])
    heads = np.concatenate([vertices, np.full(count, sink), edges[:, 1], edges[:, 0]])
    capacities = np.concatenate([costs[1], costs[0], seams, seams])
    whole = np.round(capacities / highest * _LARGEST).astype(np.int32)
    graph = csr_array(coo_array((whole, (tails, heads)), shape=(count + 2, count + 2)))
    left = csr_array(graph - maximum_flow(graph, source, sink).flow)
    left.data = np.maximum(left.data, 0)
    left.eliminate_zeros()
    reached = breadth_first_order(left, source, directed=True, return_predecessors=False)
    second = np.ones(count, bool)
    second[reached[reached < count]] = False
    return second
