# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that coordinates are small enough to compute with."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from ..geometry.mesh import TriangleMesh

# Up to this length, squares are finite in single precision.
_FARTHEST = 1e18


def refuse_far(mesh: TriangleMesh) -> None:
    """Refuse coordinates whose squares or products would overflow; raises InputError."""
    if mesh.vertices.size and np.abs(mesh.vertices).max() > _FARTHEST:
        raise InputError(
            "Some vertices are farther away than {farthest:.0e}, where nothing can be computed; delete them, or apply "
            "another scale.",
            farthest=_FARTHEST,
        )
