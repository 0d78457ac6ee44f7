# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Laplacian of the graph of a mesh's edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array

from .edges import mesh_edges


def edge_laplacian(faces: NDArray[np.int64], strengths: NDArray[np.float64]) -> csc_array:
    """Return the graph Laplacian of the edges between different vertices, (n, n).

    Parameters
    ----------
    faces : (m, 3)
        The triangles.
    strengths : (n,)
        Of the vertices, positive; the weight of an edge is the product of those of its ends.
    """
    count, (tails, heads) = len(strengths), mesh_edges(faces).T
    weights = coo_array((strengths[tails] * strengths[heads], (tails, heads)), shape=(count, count)).tocsc()
    weights = weights + weights.T
    return csc_array(diags_array(np.asarray(weights.sum(axis=0)).ravel()) - weights)
