# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids between two height fields over triangles of the plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..meshes.edges import edge_ends, edge_use
from ..meshes.mesh import TriangleMesh


def prism(area: TriangleMesh, heights: ArrayLike) -> TriangleMesh:
    """Return the closed surface of the solid between two heights over every point of an area.

    Parameters
    ----------
    area : TriangleMesh
        Triangles in the plane z = 0, counterclockwise seen from above.
    heights : (2,) or (n, 2)
        The lower and the upper height; of all vertices, or of each.

    Returns
    -------
    TriangleMesh
        Vertices of the lower end come first, then those of the upper end, each in the order of the area's. Triangles
        of both ends, too, and then the walls.
    """
    count, use = len(area.vertices), edge_use(area.faces)
    first, second = edge_ends(area.faces, use)[use.count == 1].T
    walls = [np.stack([first, second, second + count], 1), np.stack([first, second + count, first + count], 1)]
    both = np.broadcast_to(np.asarray(heights, np.float64), (count, 2))
    vertices = np.column_stack([np.tile(area.vertices[:, :2], (2, 1)), both.T.ravel()])
    return TriangleMesh(vertices, np.concatenate([area.faces[:, ::-1], area.faces + count, *walls]))
