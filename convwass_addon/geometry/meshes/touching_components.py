# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find which components of a mesh touch or pass through each other, as the limbs and clothes of a character do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .closest_points import TriangleSamples
from .mesh import TriangleMesh
from .welding import place_labels

# Components touch if samples of their surfaces are at most this far apart, in sizes of the whole surface. Of those in a
# cell of half that size, one is enough. See "Poses of one mesh" in docs/performance/motions.md.
_NEAR = 0.02


def touching_components(mesh: TriangleMesh, labels: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the pairs of components whose surfaces meet, (k, 2), each once and the smaller number first.

    Parameters
    ----------
    mesh : TriangleMesh
        With an area.
    labels : (n,) int64
        The component of every vertex; see :func:`.edges.vertex_components`.
    """
    samples = TriangleSamples.of(mesh.corners)
    points, own = samples.points / (_NEAR * mesh.root_area), labels[mesh.faces[samples.triangles, 0]]
    cells = np.concatenate([np.floor(2.0 * points), own[:, None]], axis=1)
    _, some = np.unique(place_labels(cells), return_index=True)
    near = np.sort(own[some][cKDTree(points[some]).query_pairs(1.0, output_type="ndarray")], axis=1)
    near = near[(near[:, 0] >= 0) & (near[:, 0] < near[:, 1])]
    _, first = np.unique(near @ (int(labels.max()) + 1, 1), return_index=True)
    return near[first]
