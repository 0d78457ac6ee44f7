# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of a live morph solved in full, as in a bake: shown where the handle rests."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ...progress import Control
from ..morphs.appearance import carried
from ..morphs.blending import solve_blends
from ..morphs.layouts import Blend
from ..morphs.morph_problem import MorphFrame, MorphProblem
from ..morphs.moving_problem import MovingProblem
from ..morphs.preparing import with_connectivity
from .live_shapes import LiveShape, LiveShapes


@dataclass(frozen=True)
class FullBlend:
    """A blend that was solved in full.

    Attributes
    ----------
    weights : tuple of float
        Its weights, (k,).
    mesh : TriangleMesh
        Its surface, in scene space.
    colors : (n, 3) float32 or None
        Colors of the vertices: RGB, scene linear; None if there are none.
    """

    weights: tuple[float, ...]
    mesh: TriangleMesh
    colors: NDArray[np.float32] | None

    def shown(self, center: NDArray[np.float64]) -> LiveShape:
        """Return it relative to its center, (3,)."""
        return LiveShape(self.mesh.moved(-center), center, is_solved=True, colors=self.colors)


class FullSolver:
    """Solves blends in full.

    Parameters
    ----------
    shapes : LiveShapes
        The shapes.
    problem : MorphProblem or MovingProblem
        The voxelized shapes; at rest without their connectivity and detail, which are added here.
    """

    def __init__(self, shapes: LiveShapes, problem: MorphProblem | MovingProblem) -> None:
        self._shapes, self._problem = shapes, problem
        if not isinstance(problem, MovingProblem):
            whole = with_connectivity(replace(problem, meshes=shapes.meshes), 1)
            self._problem = whole.with_detail_of(shapes.meshes)

    def solve(self, blend: Blend, control: Control) -> FullBlend:
        """Solve a blend; errors as for a bake."""
        if isinstance(self._problem, MovingProblem):
            return self._with_colors(self._problem.frame(blend, control))
        return self._with_colors(solve_blends(self._problem, [blend], control)[0])

    def _with_colors(self, frame: MorphFrame) -> FullBlend:
        blend, appearances = frame.blend, self._shapes.appearances
        mesh = self._shapes.meshes[blend.source] if frame.mesh is None else frame.mesh
        if not appearances:
            return FullBlend(blend.weights, mesh, None)
        if frame.mesh is None:
            colors = appearances[blend.source].at(mesh.vertices).colors
        else:
            colors = carried(frame.origins, mesh.faces, appearances, blend.weights).color
        return FullBlend(blend.weights, mesh, colors[:, :3])
