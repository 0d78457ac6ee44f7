# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow, simple reference solvers with the kernel as a matrix; lengths in cells."""

from __future__ import annotations

import numpy as np


def squared_distances(shape):
    """Squared distances between all pairs of cells, (n, n)."""
    cells = np.moveaxis(np.indices(shape), 0, -1).reshape(-1, len(shape))
    return ((cells[:, None] - cells) ** 2).sum(axis=-1).astype(float)


def kernel(grid):
    """The kernel H of eq. (10) in open space, (n, n), normalized so that the rows of a complete Gaussian sum to one."""
    line = np.arange(-np.ceil(40 * grid.sigma), np.ceil(40 * grid.sigma) + 1)
    total = np.exp(-(line**2) / (2.0 * grid.sigma**2)).sum()
    return np.exp(-squared_distances(grid.shape) / (2.0 * grid.sigma**2)) / total ** len(grid.shape) * grid.cells


def log_product(log_matrix, logs):
    """ln(A b) from ln A, (m, n), and ln b, (n,)."""
    terms = log_matrix + logs
    # The largest term of each row, or zero where all are -inf.
    largest = terms.max(axis=1)
    largest[np.isneginf(largest)] = 0.0
    with np.errstate(divide="ignore"):
        return largest + np.log(np.exp(terms - largest[:, None]).sum(axis=1))


def sinkhorn_value(first, second, grid, h):
    """Eq. (10) from the plan, in squared cells: gamma (1 + sum a a pi (ln(pi / H) - 1)).

    Plain Sinkhorn iteration in the log domain to convergence.
    """
    log_h, area = np.log(h), 1.0 / grid.cells
    mu, nu = (m.ravel() / m.mean() for m in (first, second))
    with np.errstate(divide="ignore"):
        log_mu, log_nu = np.log(mu), np.log(nu)
    log_w = np.zeros(grid.cells)
    for _ in range(20000):
        log_v = log_mu - log_product(log_h + np.log(area), log_w)
        moved = log_nu - log_product(log_h + np.log(area), log_v)
        if np.abs(np.exp(moved) - np.exp(log_w)).max() <= 1e-13 * np.exp(moved).max():
            break
        log_w = moved
    plan = np.exp(log_v[:, None] + log_h + log_w)
    held = plan > 0
    divergence = (plan[held] * (np.log(plan[held] / h[held]) - 1.0)).sum() * area**2
    return 2.0 * grid.sigma**2 * (1.0 + divergence)


def propagated(edges, edge_weights, fixed, grid):
    """Densities of all vertices that minimize sum_e alpha_e KL(pi_e | H), by Newton's method on the dual.

    At the end h of an edge of weight alpha, the dual variable is phi_h = alpha ln s_h. The variables at a free vertex
    sum to zero, so the last one is eliminated. Shares no code with the alternating updates of Algorithm 4. All
    densities must be positive.
    """
    count = grid.cells
    area = 1.0 / count
    h = kernel(grid)
    edges = np.asarray(edges)
    weights = np.broadcast_to(np.asarray(edge_weights, dtype=float), len(edges))
    vertex_of_end = edges.ravel()
    # phi = basis @ unknowns, one end after the other.
    columns, linear = [], []
    for vertex in range(vertex_of_end.max() + 1):
        ends = np.flatnonzero(vertex_of_end == vertex)
        for end in ends if vertex in fixed else ends[:-1]:
            column = np.zeros(len(vertex_of_end))
            column[end] = 1.0
            if vertex not in fixed:
                column[ends[-1]] = -1.0
            columns.append(column)
            linear.append(fixed[vertex].ravel() * area if vertex in fixed else np.zeros(count))
    basis, linear = np.array(columns).T, np.array(linear)

    def plans(unknowns):
        phi = basis @ unknowns
        return [np.exp((phi[2 * e][:, None] + phi[2 * e + 1]) / alpha) * h * area**2 for e, alpha in enumerate(weights)]

    def objective(unknowns):
        return sum(alpha * plan.sum() for alpha, plan in zip(weights, plans(unknowns), strict=True)) - float(
            (linear * unknowns).sum()
        )

    unknowns = np.zeros((len(columns), count))
    for _ in range(200):
        found = plans(unknowns)
        marginals = np.array([side for plan in found for side in (plan.sum(axis=1), plan.sum(axis=0))])
        gradient = basis.T @ marginals - linear
        if np.abs(gradient).sum() < 1e-13:
            break
        hessian = np.zeros((len(vertex_of_end), count) * 2)
        for e, (alpha, plan) in enumerate(zip(weights, found, strict=True)):
            hessian[2 * e, :, 2 * e + 1, :] = plan / alpha
            hessian[2 * e + 1, :, 2 * e, :] = plan.T / alpha
            for end in (2 * e, 2 * e + 1):
                hessian[end, :, end, :] = np.diag(marginals[end]) / alpha
        curved = np.einsum("hi,hxgy,gj->ixjy", basis, hessian, basis, optimize=True)
        size = len(columns) * count
        # Constants can move between the ends of an edge; the least-squares step leaves this freedom alone.
        step = np.linalg.lstsq(curved.reshape(size, size), -gradient.ravel(), rcond=1e-14)[0].reshape(unknowns.shape)
        slope, before, length = float((gradient * step).sum()), objective(unknowns), 1.0
        while length > 1e-9 and not objective(unknowns + length * step) <= before + 1e-4 * length * slope + 1e-15:
            length *= 0.5
        unknowns = unknowns + length * step
    densities = [fixed.get(vertex) for vertex in range(vertex_of_end.max() + 1)]
    for end, vertex in enumerate(vertex_of_end):
        if vertex not in fixed:
            densities[vertex] = marginals[end].reshape(grid.shape) / area
    return np.array(densities)
