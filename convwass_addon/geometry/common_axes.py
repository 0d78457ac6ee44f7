# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find what several shapes have in common along one of some axes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

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
