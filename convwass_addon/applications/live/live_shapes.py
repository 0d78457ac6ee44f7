# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a live morph is given, and what it shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ..morphs.part_labels import Matching
from ..motions.guides import Guide


@dataclass(frozen=True)
class LiveShapes:
    """What is blended.

    Attributes
    ----------
    meshes : tuple of TriangleMesh
        Two to four, in one space.
    names : tuple of str
        What messages call them.
    matching : Matching
        Their parts that travel together.
    guides : tuple of mappings from int to int
        Points that belong together; see :func:`.morph.morph`.
    """

    meshes: tuple[TriangleMesh, ...]
    names: tuple[str, ...]
    matching: Matching
    guides: tuple[Guide, ...] = ()


@dataclass(frozen=True)
class LiveShape:
    """A blend to be shown.

    Attributes
    ----------
    mesh : TriangleMesh
        In scene units about `center`.
    center : (3,) float64
        Where the blend is in the scene.
    is_solved : bool
        Whether it was solved in full; otherwise it was mixed.
    """

    mesh: TriangleMesh
    center: NDArray[np.float64]
    is_solved: bool = False
