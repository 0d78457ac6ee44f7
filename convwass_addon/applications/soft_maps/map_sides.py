# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One of the two meshes that a soft map leads from and to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ...one_line import one_line


@dataclass(frozen=True)
class MapSide:
    """One of the two meshes of a soft map.

    Attributes
    ----------
    mesh : TriangleMesh
        In scene units. Vertices that no triangle uses have no image.
    name : str
        What messages call it.
    groups : mapping of str to (n,) float64
        Painted weights, 0 to 1, that take part: those whose names both sides have.
    """

    mesh: TriangleMesh
    name: str
    groups: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    __repr__ = one_line("name", "mesh")
