# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft maps: for every vertex of a source, a distribution over a target (Solomon et al. 2015, section 7)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..one_line import one_line
from ..progress import UNINTERRUPTED, Control
from .checks import check_solver
from .soft_map_problem import SoftMapProblem
from .surface import Surface

# gamma over the squared mean edge length of the target. Chosen by eye: the whole map depends little on it, and
# annealing it is as good or worse (docs/performance, "Soft maps").
GAMMA_PER_SQUARED_EDGE = 1.7


@dataclass(frozen=True)
class SoftMap:
    """A distribution over the target for every vertex of the source.

    Attributes
    ----------
    densities : (n0, n1) float32
        With respect to the target's areas, each row of mass 1; uniform at isolated vertices without pairs.
    areas : (n1,) float64
        The target's area weights, of sum 1.
    changes : (sweeps,) float64
        For every sweep the mean, over the vertices, of the mass that it moved: 0 to 2.
    converged : bool
        Whether the last change is below the tolerance.
    coarse_iterations : tuple of int
        Sweeps between coarser meshes, coarse to fine, if any were used.
    numerics : str
        Name of the numerics used.
    """

    densities: NDArray[np.float32]
    areas: NDArray[np.float64]
    changes: NDArray[np.float64]
    converged: bool
    coarse_iterations: tuple[int, ...] = ()
    numerics: str = "float32 scalings, dense kernel"

    __repr__ = one_line("densities", "changes", "converged")

    @property
    def iterations(self) -> int:
        """Sweeps over the source."""
        return len(self.changes)

    @cached_property
    def entropies(self) -> NDArray[np.float64]:
        """Entropy of every row in nats, (n0,): 0 for uniform rows, negative for concentrated ones."""
        logs = np.log(np.maximum(self.densities, np.float32(1e-30)))
        return -np.einsum("xy,xy,y->x", self.densities, logs, self.areas)


def soft_map_domain(surface: Surface, gamma_scale: float = GAMMA_PER_SQUARED_EDGE) -> Surface:
    """Return the surface with a kernel for soft maps: gamma is this multiple of its squared mean edge length.

    Raises
    ------
    ValueError
        The multiple is not a positive number.
    """
    if not (np.isfinite(gamma_scale) and gamma_scale > 0):
        raise ValueError(f"gamma_scale must be a positive number, got {gamma_scale}")
    return surface.with_kernel(gamma_scale * surface.mean_edge_length**2)


def soft_map(
    compatibility: ArrayLike,
    edges: ArrayLike,
    edge_weights: ArrayLike | float,
    source_areas: ArrayLike,
    domain: Surface,
    *,
    pairs: ArrayLike = (),
    fixed: Mapping[int, ArrayLike] | None = None,
    tau: float = 30.0,
    sharpness: float = 1.0,
    sweeps: int = 10,
    tolerance: float = 1e-2,
    initial: ArrayLike | SoftMap | None = None,
    control: Control = UNINTERRUPTED,
) -> SoftMap:
    """Find the map that minimizes Dirichlet energy plus cost (Solomon et al. 2015, section 7), by Algorithm 4.

    Eq. (18): min sum_e alpha_e W2^2(mu_v, mu_w) + tau sum_v omega_v <mu_v, c_v>.

    Parameters
    ----------
    compatibility : (n0, n1)
        c(x, y), any finite numbers: small where the source at x looks like the target at y.
    edges : (e, 2)
        Pairs of vertices of the source; see :class:`SourceEdges`.
    edge_weights : (e,) or float
        Positive alpha of every edge, or one for all.
    source_areas : (n0,)
        omega; normalized to sum 1.
    domain : Surface
        The target with its kernel; see :func:`soft_map_domain`.
    pairs : (k, 2) int
        Corresponding vertices of the source and the target. If a source vertex has several partners, each gets an equal
        share of its mass.
    fixed : mapping from vertex to density
        Vertices of the source whose distributions are given, with their densities.
    tau : float
        Weight of the compatibility. The result hardly depends on it between 10 and 100.
    sharpness : float
        0 for the paper's map, to which every edge adds the blur of a kernel; 1 for the debiased one.
    sweeps : int
        Largest number of sweeps over the source. A map is accurate long before it has converged; more sweeps mainly
        make its distributions sharper.
    tolerance : float
        The solve ends when the mean mass moved by a sweep is below this.
    initial : (n0, n1) or SoftMap, optional
        Densities to start from.
    control : Control
        Ends the solve when cancelled.

    Returns
    -------
    SoftMap

    Raises
    ------
    ValueError
        Shapes that do not match or invalid parameters; the message names the argument.
    """
    problem = SoftMapProblem.of(
        compatibility, edges, edge_weights, source_areas, domain, pairs=pairs, fixed=fixed, tau=tau, sharpness=sharpness
    )
    check_solver(tolerance, sweeps, "sweeps")
    iteration = problem.iteration(initial.densities if isinstance(initial, SoftMap) else initial)
    changes: list[float] = []
    while len(changes) < sweeps and not (changes and changes[-1] < tolerance):
        changes.append(iteration.sweep())
        control.check()
    return SoftMap(problem.whole(iteration.densities), domain.weights, np.array(changes), changes[-1] < tolerance)
