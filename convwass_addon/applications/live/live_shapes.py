# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Input and output of live morphs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ..morphs.appearance import Appearance
from ..morphs.morph_inputs import MorphInputs


@dataclass(frozen=True)
class LiveShapes:
    """The shapes of a live morph.

    Attributes
    ----------
    inputs : MorphInputs
        Two to four shapes without an animation.
    appearances : tuple of Appearance
        Colors, one per shape, in the space of the meshes; empty if blends carry no colors.
    """

    inputs: MorphInputs
    appearances: tuple[Appearance, ...] = ()


@dataclass(frozen=True)
class LiveShape:
    """A displayed blend.

    Attributes
    ----------
    mesh : TriangleMesh
        In scene units, relative to `center`.
    center : (3,) float64
        Position of the blend in the scene.
    is_solved : bool
        Whether it was solved completely; otherwise it was mixed.
    colors : (n, 3) float32 or None
        Colors of the vertices: RGB, scene linear; None if there are none.
    """

    mesh: TriangleMesh
    center: NDArray[np.float64]
    is_solved: bool = False
    colors: NDArray[np.float32] | None = None
