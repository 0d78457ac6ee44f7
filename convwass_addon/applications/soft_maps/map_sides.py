# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The source or target mesh of a soft map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ...one_line import one_line


@dataclass(frozen=True)
class MapSide:
    """The source or target mesh of a soft map.

    Attributes
    ----------
    mesh : TriangleMesh
        In scene units. Vertices without triangles have no image.
    name : str
        Name for messages.
    groups : mapping of str to (n,) float64
        Painted weights, 0 to 1. Only groups that both sides have, by name, are used.
    """

    mesh: TriangleMesh
    name: str
    groups: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    __repr__ = one_line("name", "mesh")
