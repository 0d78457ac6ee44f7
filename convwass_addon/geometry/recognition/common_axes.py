# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find directions in which shapes may be extruded or revolved, and what several shapes have in common along one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..meshes.mesh import TriangleMesh

# Cosine of the angle within which normals have one direction.
_ONE_DIRECTION = np.cos(np.radians(2.0))
# Faces of a direction are plane if they are at least this share of the surface, which sides of a round tube are not. So
# many directions are tried, in the order of their largest triangles.
_PLANE, _TRIED = 0.07, 64

Shape, Found = TypeVar("Shape"), TypeVar("Found")


def found_for_all(find: Callable[[Shape], Found | None], shapes: Iterable[Shape]) -> list[Found] | None:
    """Return what is found for every shape, or None as soon as nothing is found for one."""
    result = []
    for shape in shapes:
        found = find(shape)
        if found is None:
            return None
        result.append(found)
    return result


def normal_axes(normals: NDArray[np.float64], areas: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the eigenvectors of the sum of n n^T over a surface, as rows, (3, 3).

    Axes of extrusions and of solids of revolution are among them, unless eigenvalues are equal.

    Parameters
    ----------
    normals : (m, 3)
        Unit normals n of the triangles.
    areas : (m,)
        Their areas.
    """
    return np.linalg.eigh(np.einsum("m,mi,mj->ij", areas, normals, normals))[1].T


def face_directions(
    normals: NDArray[np.float64], areas: NDArray[np.float64], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return directions in which large triangles face, and the areas that face there or the opposite way.

    Parameters
    ----------
    normals : (m, 3)
        Unit normals of the triangles.
    areas : (m,)
        Their areas.
    count : int
        Number of directions.

    Returns
    -------
    (k, 3) float64, (k,) float64
        At most `count` directions, and their areas.
    """
    left, found, sums = areas.copy(), [], []
    while len(found) < count and left.any():
        direction = normals[int(left.argmax())]
        facing = np.abs(normals @ direction) > _ONE_DIRECTION
        found.append(direction)
        sums.append(left[facing].sum())
        left[facing] = 0.0
    return np.array(found).reshape(-1, 3), np.array(sums)


def plane_share(mesh: TriangleMesh) -> float:
    """Return the share of a surface that consists of large plane faces, which may be divided: one for a table."""
    _, areas = face_directions(mesh.face_normals, mesh.face_areas, _TRIED)
    return float(areas[areas >= _PLANE * mesh.area].sum() / mesh.area)
