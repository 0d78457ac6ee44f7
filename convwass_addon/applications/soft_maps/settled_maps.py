# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regularize the means of a soft map's rows as an elastic surface.

A mean lies inside the points that it averages, so a map of means shrinks away from the ends of limbs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.registration import SETTLING, Registration
from ...geometry.deformation.unit_shape import UnitShape
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import Control


def settled(
    mesh: TriangleMesh,
    surface: TriangleMesh,
    images: NDArray[np.float64],
    pairs: NDArray[np.int64],
    is_mirrored: bool,
    control: Control,
) -> NDArray[np.float64]:
    """Return improved images of a mesh's vertices, (n, 3), on or near a surface.

    Parameters
    ----------
    mesh, surface : TriangleMesh
        Coarse meshes, which use all of their vertices.
    images : (n, 3)
        Images of the mesh's vertices, in the surface's units.
    pairs : (k, 2) int64
        Corresponding vertices.
    is_mirrored : bool
        Whether the map reverses orientation.
    control : Control
        Stops the work.
    """
    own, other = UnitShape.of(mesh), UnitShape.of(surface)
    size = surface.root_area
    center = surface.vertices[0] - size * other.vertices[0]
    found = Registration(own.mirrored() if is_mirrored else own, other, pairs, (images - center) / size)
    found.advance(SETTLING, control)
    return size * found.points + center
