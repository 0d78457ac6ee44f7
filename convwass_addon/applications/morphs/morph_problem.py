# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all blends of a morph have in common, and what a finished one is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.connectivity import Connectivity
from ...geometry.facing_points import FacingShape
from ...geometry.mesh import TriangleMesh
from ...geometry.orientation import orient_outward
from ...one_line import one_line
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
        Which one.
    mesh : TriangleMesh or None
        Its surface in the scene, closed and outward; None where an input is shown as it is.
    record : dict
        The solver's figures, the level, volume wanted and reached; ready for JSON.
    potentials : tuple of PartPotentials
        One per part, where they are kept: what blends next to it can be had from.
    origins : (k, n, 3) float32 or None
        Where in the scene the matter at every vertex of `mesh` comes from, on every input; None where that was not
        asked for. See :func:`.origins.blend_origins`.
    tangents : (k, n, 3) float32 or None
        What velocities are read from in place of the origins, where the inputs move; see
        :func:`.moved_origins.moved_tangents`.
    triangles : (k, m) int32 or None
        The triangle of every input that each triangle of `mesh` lies on, -1 for inputs without weight; None where the
        blend does not carry the detail of its inputs along.
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
        """What :func:`.origins.velocities` takes, (k, n, 3)."""
        return self.origins if self.tangents is None else self.tangents


@dataclass(frozen=True)
class MorphProblem:
    """What all blends of a morph have in common; can be sent to another process.

    Attributes
    ----------
    transport : TransportProblem
        The shapes as distributions, and how to blend them.
    connectivity : tuple of Connectivity
        How every shape is connected, as far as it can be told at this resolution; empty where there are to be sketches
        only.
    meshes : tuple of TriangleMesh
        The shapes, until their connectivity is known.
    keeps_potentials : bool
        Whether frames bring what blends next to them can be had from.
    motion : dict
        What the record of every frame says about the choice of a motion.
    shapes : tuple of FacingShape
        The shapes themselves, outward, where blends get their detail from them; empty where they do not.
    demand : Demand or None
        What the other blends demand of those that are made now.
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
        """Prepare voxelized shapes for many blends of them."""
        return cls.for_sketches(shapes, lattice, settings).with_connectivity()

    @classmethod
    def for_sketches(
        cls, shapes: SplitShapes, lattice: Lattice, settings: MorphSettings, meshes: Sequence[TriangleMesh] = ()
    ) -> MorphProblem:
        """Prepare voxelized shapes for sketches of their blends, which are not mended."""
        return cls(TransportProblem.of(shapes, lattice, settings), meshes=tuple(meshes))

    @property
    def lattice(self) -> Lattice:
        """Where the cells of the shapes are."""
        return self.transport.lattice

    @property
    def settings(self) -> MorphSettings:
        """How to blend the shapes."""
        return self.transport.settings

    def with_detail_of(self, shapes: Sequence[TriangleMesh]) -> MorphProblem:
        """Return what blends need that carry the detail of the shapes; the same problem where they are not to."""
        if not self.settings.carried_detail:
            return self
        return replace(self, shapes=tuple(FacingShape(orient_outward(shape)) for shape in shapes))

    def with_connectivity(self, executor: Executor | None = None) -> MorphProblem:
        """Return what finished blends need; an executor's threads, if there is one, read the shapes side by side."""
        each = map if executor is None else executor.map
        shapes = range(len(self.transport.volumes))
        return replace(self, connectivity=tuple(each(self.shape_connectivity, shapes)), meshes=())

    def demanding(self, demand: Demand) -> MorphProblem:
        """Return the same for blends of which something is demanded, whatever pieces and handles the shapes have."""
        connectivity = (demand.most,) * len(self.transport.volumes)
        return replace(self, connectivity=connectivity, meshes=(), demand=demand)

    def constraint(self, weights: Sequence[float]) -> Constraint:
        """Return how the surface of the blend with these weights is to be extracted."""
        return UNCONSTRAINED if self.demand is None else self.demand.constraint(self.lattice, weights)

    def shape_connectivity(self, index: int) -> Connectivity:
        """Tell how shape `index` is connected: what its cells show, less what only they show.

        Fingers that touch in the cells make handles which the shape does not have.
        """
        seen = connectivity_of(self.transport.occupancy(index), self.settings)
        if not self.meshes or seen == _SIMPLE:
            return seen
        finer = true_connectivity(self.meshes[index], index, self.lattice, self.settings)
        return seen if finer is None else seen.or_less(finer)
