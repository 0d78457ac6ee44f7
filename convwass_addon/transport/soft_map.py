# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft maps: to every vertex of a source a distribution over a target (Solomon et al. 2015, section 7)."""

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

# gamma over the squared mean edge length of the target, which the whole map depends little on: chosen by eye,
# annealing it is as good or worse (docs/performance.md, "Soft maps").
GAMMA_PER_SQUARED_EDGE = 1.7


@dataclass(frozen=True)
class SoftMap:
    """A distribution over the target for every vertex of the source.

    Attributes
    ----------
    densities : (n0, n1) float32
        With respect to the target's areas, each row of mass 1; even where nothing is known, at vertices without edges.
    areas : (n1,) float64
        The target's area weights, of sum 1.
    changes : (sweeps,) float64
        For every sweep the mean, over the vertices, of the mass that it has moved: 0 to 2.
    converged : bool
        Whether the last of them is below the tolerance.
    coarse_iterations : tuple of int
        Sweeps between coarser meshes, coarse to fine, where it was solved on such first.
    numerics : str
        How it was calculated.
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
        """Entropy of every row in nats, (n0,): 0 where it is even, the more negative the sharper."""
        logs = np.log(np.maximum(self.densities, np.float32(1e-30)))
        return -np.einsum("xy,xy,y->x", self.densities, logs, self.areas)


def soft_map_domain(surface: Surface, gamma_scale: float = GAMMA_PER_SQUARED_EDGE) -> Surface:
    """Return the same surface with a kernel for soft maps: gamma is this multiple of its squared mean edge length.

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
    """Find the map of least Dirichlet energy and cost (Solomon et al. 2015, section 7), by Algorithm 4.

    Eq. (18): min sum_e alpha_e W2^2(mu_v, mu_w) + tau sum_v omega_v <mu_v, c_v>.

    Parameters
    ----------
    compatibility : (n0, n1)
        c(x, y), any numbers: small where the source at x looks like the target at y.
    edges : (e, 2)
        Pairs of vertices of the source; see :class:`SourceEdges`.
    edge_weights : (e,) or float
        Positive alpha of every edge, or of all.
    source_areas : (n0,)
        omega; normalized to sum 1.
    domain : Surface
        The target, with its kernel: see :func:`soft_map_domain`.
    pairs : (k, 2) int
        A vertex of the source and one of the target that belong together. Of several with the same vertex of the
        source each gets an equal share.
    fixed : mapping from vertex to density
        Vertices of the source whose distributions are given.
    tau : float
        Weight of the compatibility. 10 to 100 give nearly the same.
    sharpness : float
        0 for the paper's map, where every edge adds the blur of a kernel; 1 for the debiased one.
    sweeps : int
        Largest number of sweeps over the source. A map is right long before it has converged; more sweeps only make
        its distributions sharper.
    tolerance : float
        Mean mass moved by a sweep, below which it ends.
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
        Arrays that do not fit together, or parameters that make no sense; the message names the argument.
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
