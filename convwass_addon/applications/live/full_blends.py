# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of a live morph solved in full, as in a bake: shown where the handle rests."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ...progress import Control
from ..morphs.appearance import carried
from ..morphs.blend_problem import BlendProblem
from ..morphs.layouts import Blend
from ..morphs.morph_problem import MorphProblem
from ..morphs.preparing import with_connectivity
from ..morphs.resting_problem import RestingProblem
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
    problem : BlendProblem
        The voxelized shapes.
    """

    def __init__(self, shapes: LiveShapes, problem: BlendProblem) -> None:
        self._shapes, self._problem = shapes, problem

    @classmethod
    def at_rest(cls, shapes: LiveShapes, problem: MorphProblem) -> FullSolver:
        """Add what finished blends of shapes that do not move need: their connectivity and detail."""
        whole = with_connectivity(replace(problem, meshes=tuple(shapes.inputs.shapes)), 1)
        return cls(shapes, RestingProblem(whole.with_detail_of(shapes.inputs.shapes)))

    def solve(self, blend: Blend, control: Control) -> FullBlend:
        """Solve a blend; errors as for a bake."""
        (frame,) = self._problem.frames([blend], control)
        appearances = self._shapes.appearances
        mesh = self._shapes.inputs.shapes[blend.source] if frame.mesh is None else frame.mesh
        if not appearances:
            return FullBlend(blend.weights, mesh, None)
        if frame.mesh is None:
            colors = appearances[blend.source].at(mesh.vertices).colors
        else:
            colors = carried(frame.origins, mesh.faces, appearances, blend.weights).color
        return FullBlend(blend.weights, mesh, colors[:, :3])
