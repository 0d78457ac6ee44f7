# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes for soft maps, and slow, simple reference solutions of eq. (18)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from convwass_addon.transport import Surface


def sheet(rows: int, columns: int, seed: int = 0, gamma: float | None = None) -> Surface:
    """A wavy sheet of `rows` times `columns` vertices without symmetries."""
    rng = np.random.default_rng(seed)
    y, x = np.indices((rows, columns)).reshape(2, -1)
    points = np.stack([x, y, 0.4 * np.sin(x + 0.7 * y)], axis=1) + rng.uniform(-0.2, 0.2, (len(x), 3))
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.stack([corner, corner + 1, corner + columns + 1], axis=1)
    upper = np.stack([corner, corner + columns + 1, corner + columns], axis=1)
    return Surface(points, np.concatenate([lower, upper]), gamma)


@dataclass(frozen=True)
class Literal:
    """Eq. (18) taken literally: one kernel per edge, in float64."""

    edges: np.ndarray
    weights: np.ndarray
    source_areas: np.ndarray
    costs: np.ndarray
    tau: float
    domain: Surface
    fixed: dict[int, np.ndarray]

    @property
    def heat(self) -> np.ndarray:
        """The kernel H as a matrix, (n1, n1), applied as H (a * x)."""
        kernel = self.domain.apply(np.eye(len(self.domain.weights))) / self.domain.weights[:, None]
        return 0.5 * (kernel + kernel.T)

    def algorithm_4(self, sweeps: int) -> np.ndarray:
        """The paper's listing with the kernels of section 7, one vertex at a time, with equal shares for all edges."""
        area, count = self.domain.weights, len(self.source_areas)
        valence = np.bincount(self.edges.ravel(), minlength=count)
        share = self.tau * self.source_areas / (self.domain.gamma * valence)
        factors = [
            [np.exp(-share[vertex] * self.costs[vertex] / weight) for vertex in edge]
            for edge, weight in zip(self.edges, self.weights, strict=True)
        ]
        kernels = [first[:, None] * self.heat * second for first, second in factors]
        scalings = np.ones((len(self.edges), 2, len(area)))
        densities = np.ones((count, len(area)))
        for _ in range(sweeps):
            for vertex in range(count):
                ends = np.argwhere(self.edges == vertex)
                marginals = []
                for edge, side in ends:
                    kernel = kernels[edge] if side == 0 else kernels[edge].T
                    marginals.append(scalings[edge, side] * (kernel @ (area * scalings[edge, 1 - side])))
                if vertex in self.fixed:
                    mean = self.fixed[vertex]
                else:
                    powers = self.weights[ends[:, 0]] / self.weights[ends[:, 0]].sum()
                    mean = np.exp(powers @ np.log(marginals))
                    mean /= area @ mean
                for (edge, side), marginal in zip(ends, marginals, strict=True):
                    scalings[edge, side] *= mean / marginal
                densities[vertex] = mean
        return densities

    def by_dual(self) -> np.ndarray:
        """Densities by a general optimizer on the dual of the transport plans.

        Every end of an edge has a potential psi. The potentials at a free vertex sum to lambda_v - tau omega_v c_v, so
        the last one is eliminated; the plans are R exp((psi + psi') / (alpha gamma)) with R = a H a.
        """
        area, gamma = self.domain.weights, self.domain.gamma
        plan_of_heat = area[:, None] * self.heat * area
        size, ends = len(area), self.edges.ravel()
        count = len(self.source_areas)
        last = {vertex: int(np.flatnonzero(ends == vertex)[-1]) for vertex in range(count) if vertex not in self.fixed}

        def potentials(unknowns):
            psi, constants = unknowns[: -count or None].reshape(len(ends), size).copy(), unknowns[-count:]
            for vertex, end in last.items():
                psi[end] = 0.0
                others = psi[ends == vertex].sum(axis=0)
                psi[end] = constants[vertex] - self.tau * self.source_areas[vertex] * self.costs[vertex] - others
            return psi, constants

        def marginals_of(psi):
            found = np.empty_like(psi)
            mass = 0.0
            for edge, weight in enumerate(self.weights):
                plan = plan_of_heat * np.exp((psi[2 * edge][:, None] + psi[2 * edge + 1]) / (weight * gamma))
                found[2 * edge], found[2 * edge + 1] = plan.sum(axis=1), plan.sum(axis=0)
                mass += weight * gamma * plan.sum()
            return found, mass

        def negative_dual(unknowns):
            psi, constants = potentials(unknowns)
            marginals, mass = marginals_of(psi)
            value, slope, slope_of_constants = mass, marginals.copy(), np.zeros(count)
            for vertex, end in last.items():
                value -= constants[vertex]
                slope[ends == vertex] -= marginals[end]
                slope_of_constants[vertex] = marginals[end].sum() - 1.0
            for vertex, density in self.fixed.items():
                value -= (psi[ends == vertex] @ (area * density)).sum()
                slope[ends == vertex] -= area * density
            return value, np.concatenate([slope.ravel(), slope_of_constants])

        start = np.zeros(len(ends) * size + count)
        options = {"maxiter": 20000, "maxfun": 40000, "ftol": 1e-15, "gtol": 1e-6, "maxcor": 30}
        found = minimize(negative_dual, start, jac=True, method="L-BFGS-B", options=options)
        marginals, _ = marginals_of(potentials(found.x)[0])
        first = [np.flatnonzero(ends == vertex)[0] for vertex in range(count)]
        return marginals[first] / area
