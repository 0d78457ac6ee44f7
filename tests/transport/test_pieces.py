# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mass on several connected components of a mesh: each keeps its own."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.transport import Surface, barycenter, bisect, propagate
from convwass_addon.transport.pieces import PieceMasses
from convwass_addon.transport.sharpening import entropy, sharpening_exponent
from tests.shapes import ball, joined, torus

MESH = joined(ball(points=400), torus(center=(4, 0, 0), segments=(24, 12)))
SHARES = (0.3, 0.7)


@pytest.fixture(scope="module")
def surface():
    return Surface(MESH.vertices, MESH.faces)


def bumps(surface, *centers):
    """One bump around each center on its own component, with the masses SHARES."""
    total = np.zeros(surface.shape)
    for piece, (center, share) in enumerate(zip(centers, SHARES, strict=True)):
        bump = np.exp(-((MESH.vertices - center) ** 2).sum(axis=1) / 0.3) * (surface.pieces == piece)
        total += share * bump / (surface.weights @ bump)
    return total


@pytest.fixture(scope="module")
def ends(surface):
    return bumps(surface, [0, 0, 1], [5.3, 0, 0]), bumps(surface, [1, 0, 0], [2.7, 0, 0])


def masses(surface, densities):
    return np.stack([(densities * surface.weights)[:, surface.pieces == piece].sum(axis=1) for piece in (0, 1)], axis=1)


@pytest.mark.parametrize("limit", ["max", None, -1.0])
def test_bisection_keeps_the_mass_of_every_component(surface, ends, limit):
    found = bisect(*ends, surface, levels=3, entropy_limit=limit)
    assert found.converged.all()
    np.testing.assert_allclose(masses(surface, found.densities), np.tile(SHARES, (9, 1)), atol=1e-9)
    if limit is not None:
        bound = max(found.entropies[[0, -1]]) if limit == "max" else limit
        assert found.entropies[1:-1].max() <= bound + 1e-6


@pytest.mark.parametrize(("sharpness", "limit"), [(0.0, None), (0.75, None), (1.0, None), (0.0, "max")])
def test_barycenters_keep_the_mass_of_every_component(surface, ends, sharpness, limit):
    found = barycenter(ends, [0.4, 0.6], surface, sharpness=sharpness, entropy_limit=limit)
    assert found.converged
    np.testing.assert_allclose(masses(surface, found.density[None])[0], SHARES, atol=1e-9)
    if limit is None:
        assert found.invariant_error < 1e-9


def test_components_are_independent(surface, ends):
    """Without a bound, which couples them, every component is solved as if alone."""
    alone = [np.where(surface.pieces == 1, mu, 0.0) for mu in ends]
    together = propagate([(0, 2), (2, 1)], 1.0, dict(enumerate(ends)), surface, tolerance=1e-9)
    single = propagate([(0, 2), (2, 1)], 1.0, dict(enumerate(alone)), surface, tolerance=1e-9)
    there = surface.pieces == 1
    np.testing.assert_allclose(together.densities[2][there], SHARES[1] * single.densities[2][there], rtol=1e-6)


def test_the_bound_is_reached_with_the_masses_kept(surface, ends):
    rng = np.random.default_rng(0)
    pieces = PieceMasses.of(ends[0], surface)
    log_mu = pieces.balanced(rng.normal(0, 1, surface.shape), surface.weights)
    limit = entropy(np.exp(log_mu), surface.weights) - 0.5
    beta = sharpening_exponent(log_mu, limit, surface.weights, pieces)
    sharp = np.exp(pieces.balanced(beta * log_mu, surface.weights))
    assert entropy(sharp, surface.weights) == pytest.approx(limit, abs=1e-6)
    np.testing.assert_allclose(masses(surface, sharp[None])[0], SHARES)


def test_mass_on_a_single_component_is_accepted(surface, ends):
    assert PieceMasses.of(np.where(surface.pieces == 1, ends[0], 0.0), surface) is None
