# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The problem shared by all blends of a morph, and a finished blend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...geometry.level_sets.connectivity import Connectivity
from ...geometry.meshes.facing_points import FacingShape
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.orientation import orient_outward
from ...one_line import one_line
from ...progress import UNINTERRUPTED, Control
from .demands import Demand
from .extraction import UNCONSTRAINED, Constraint, connectivity_of
from .layouts import Blend
from .morph_settings import MorphSettings
from .part_potentials import PartPotentials
from .parts import SplitShapes
from .transport_problem import TransportProblem
from .true_connectivity import true_connectivity
from .volumes import Lattice

_SIMPLE = Connectivity(1, 0, 0)


@dataclass(frozen=True)
class MorphFrame:
    """A finished blend.

    Attributes
    ----------
    blend : Blend
        Its weights and place.
    mesh : TriangleMesh or None
        Its surface in scene space, closed and oriented outward; None for an unblended input.
    record : dict
        The solver's figures, the level, and the wanted and actual volume; ready for JSON.
    potentials : tuple of PartPotentials
        One per part, if they are kept: neighboring blends can be solved from them.
    origins : (k, n, 3) float32 or None
        For every input, the point in scene space that the matter at every vertex of `mesh` comes from; None if not
        requested. See :func:`.origins.blend_origins`.
    tangents : (k, n, 3) float32 or None
        Points that determine velocities instead of the origins, if the inputs move; see
        :func:`.moved_origins.moved_tangents`.
    triangles : (k, m) int32 or None
        The triangle of every input that each triangle of `mesh` lies on, -1 for inputs without weight; None if the
        blend does not carry the detail of its inputs.
    """

    blend: Blend
    mesh: TriangleMesh | None
    record: dict[str, object]
    potentials: tuple[PartPotentials, ...] = ()
    origins: NDArray[np.float32] | None = None
    tangents: NDArray[np.float32] | None = None
    triangles: NDArray[np.int32] | None = None

    __repr__ = one_line("blend", "mesh", "origins")

    @property
    def velocity_points(self) -> NDArray[np.float32] | None:
        """The points for :func:`.origins.velocities`, (k, n, 3)."""
        return self.origins if self.tangents is None else self.tangents


@dataclass(frozen=True)
class MorphProblem:
    """The problem shared by all blends of a morph; can be sent to another process.

    Attributes
    ----------
    transport : TransportProblem
        The shapes as distributions, and how to blend them.
    connectivity : tuple of Connectivity
        Connectivity of every shape, as far as this resolution shows it; empty if only sketches are needed.
    meshes : tuple of TriangleMesh
        The shapes, until their connectivity is known.
    keeps_potentials : bool
        Whether frames keep potentials, from which blends next to them can be solved.
    motion : dict
        What the record of every frame says about the choice of a motion.
    shapes : tuple of FacingShape
        The shapes themselves, oriented outward, if blends get detail from them; else empty.
    demand : Demand or None
        Constraints on blends that are computed again, from the other blends.
    """

    transport: TransportProblem
    connectivity: tuple[Connectivity, ...] = ()
    keeps_potentials: bool = False
    motion: Mapping[str, object] = field(default_factory=dict)
    meshes: tuple[TriangleMesh, ...] = ()
    shapes: tuple[FacingShape, ...] = ()
    demand: Demand | None = None

    @classmethod
    def of(cls, shapes: SplitShapes, lattice: Lattice, settings: MorphSettings) -> MorphProblem:
        """Prepare voxelized shapes for blends."""
        return cls.for_sketches(shapes, lattice, settings).with_connectivity()

    @classmethod
    def for_sketches(
        cls, shapes: SplitShapes, lattice: Lattice, settings: MorphSettings, meshes: Sequence[TriangleMesh] = ()
    ) -> MorphProblem:
        """Prepare voxelized shapes for sketches of their blends, which are not repaired."""
        return cls(TransportProblem.of(shapes, lattice, settings), meshes=tuple(meshes))

    @property
    def lattice(self) -> Lattice:
        """The common grid of the shapes."""
        return self.transport.lattice

    @property
    def settings(self) -> MorphSettings:
        """The settings of the morph."""
        return self.transport.settings

    def with_detail_of(self, shapes: Sequence[TriangleMesh]) -> MorphProblem:
        """Return the problem with the shapes that give blends their detail; unchanged if the settings ask for none."""
        if not self.settings.carried_detail:
            return self
        return replace(self, shapes=tuple(FacingShape(orient_outward(shape)).ready() for shape in shapes))

    def with_connectivity(self, executor: Executor | None = None, control: Control = UNINTERRUPTED) -> MorphProblem:
        """Return the problem with the connectivity of its shapes, extracted in parallel if there is an executor."""
        each = map if executor is None else executor.map
        shapes = range(len(self.transport.volumes))
        found = each(partial(self.shape_connectivity, control=control), shapes)
        return replace(self, connectivity=tuple(found), meshes=())

    def demanding(self, demand: Demand) -> MorphProblem:
        """Return the problem with a demand on its blends, which overrides the connectivity of the shapes."""
        connectivity = (demand.most,) * len(self.transport.volumes)
        return replace(self, connectivity=connectivity, meshes=(), demand=demand)

    def constraint(self, weights: Sequence[float]) -> Constraint:
        """Return the constraint for the surface of the blend with these weights."""
        return UNCONSTRAINED if self.demand is None else self.demand.constraint(self.lattice, weights)

    def shape_connectivity(self, index: int, control: Control = UNINTERRUPTED) -> Connectivity:
        """Return the connectivity of shape `index`: that of its cells, without what is due to the grid.

        For example, fingers that touch on the grid make handles that the shape does not have.
        """
        seen = connectivity_of(self.transport.occupancy(index), self.settings)
        if not self.meshes or seen == _SIMPLE:
            return seen
        finer = true_connectivity(self.meshes[index], index, self.lattice, self.settings, control)
        return seen if finer is None else seen.or_less(finer)
