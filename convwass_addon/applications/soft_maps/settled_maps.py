# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The means of a soft map's rows, settled as a skin that resists being squeezed.

A mean lies inside of what it is the mean of, so that a map of means shrinks away from the ends of limbs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ...geometry.registration import SETTLING, Registration
from ...geometry.unit_shape import UnitShape


def settled(
    mesh: TriangleMesh,
    surface: TriangleMesh,
    images: NDArray[np.float64],
    pairs: NDArray[np.int64],
    is_mirrored: bool,
) -> NDArray[np.float64]:
    """Return better images of a mesh's vertices, (n, 3), on or near a surface.

    Parameters
    ----------
    mesh, surface : TriangleMesh
        Coarse meshes, all of whose vertices are used.
    images : (n, 3)
        Where the map puts the mesh's vertices, in the surface's units.
    pairs : (k, 2) int64
        Vertices of the two that belong together.
    is_mirrored : bool
        Whether the map turns the surface over.
    """
    own, other = UnitShape.of(mesh), UnitShape.of(surface)
    size = np.sqrt(surface.area)
    center = surface.vertices[0] - size * other.vertices[0]
    found = Registration(own.mirrored() if is_mirrored else own, other, pairs, (images - center) / size)
    for stage in SETTLING:
        found.advance(stage)
    return size * found.points + center
