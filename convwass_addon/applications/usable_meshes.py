# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuse meshes with which nothing can be computed."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from ..geometry.meshes.mesh import TriangleMesh

# Up to this length, squares are finite in single precision.
_FARTHEST = 1e18


def require_surface(mesh: TriangleMesh, name: str) -> None:
    """Refuse a mesh that is too far from the origin, or has no area; raises InputError."""
    refuse_far(mesh)
    if not mesh.area > 0.0:
        raise InputError("{name} has no faces with an area; choose an object with a surface.", name=name)


def refuse_far(mesh: TriangleMesh) -> None:
    """Refuse coordinates whose squares or products would overflow; raises InputError."""
    if mesh.vertices.size and np.abs(mesh.vertices).max() > _FARTHEST:
        raise InputError(
            "Some vertices are farther away than {farthest:.0e}, where nothing can be computed; delete them, or apply "
            "another scale.",
            farthest=_FARTHEST,
        )


def too_intricate(name: str, most: int) -> InputError:
    """Return the error for a mesh that cannot be simplified to so many vertices."""
    return InputError(
        "{name} cannot be simplified to fewer than {most} vertices: it has too many pieces or holes. Remesh it.",
        name=name,
        most=most,
    )
