# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.errors import Cancelled
from convwass_addon.transport import SourceEdges, Surface, point_distances, soft_map, soft_map_domain
from convwass_addon.transport.dense_kernel import dense_kernel
from tests.controls import CountingControl

from .soft_map_cases import Literal, sheet
from .spheres import icosphere

LONG = {"sweeps": 400, "tolerance": 1e-7}


def problem(seed=0, gamma=0.08, tau=8.0):
    """A source of 12 vertices, a target of 20, and random costs."""
    source, target = sheet(3, 4, seed), sheet(4, 5, seed + 1, gamma)
    graph = SourceEdges.of(source.laplacian)
    costs = np.random.default_rng(seed).uniform(0, 1, (12, 20))
    fixed = {2: target.with_kernel(0.02).apply(np.eye(20)[7] / target.weights[7])}
    return Literal(graph.edges, graph.weights, source.weights, costs, tau, target, fixed)


def solved(case, **options):
    options = {"sharpness": 0.0, "fixed": case.fixed, "tau": case.tau, **LONG, **options}
    return soft_map(case.costs, case.edges, case.weights, case.source_areas, case.domain, **options)


def mass_apart(one, other, domain):
    """For every row, the L1 distance between two densities, 0 to 2."""
    return np.abs(one - other) @ domain.weights


@pytest.mark.parametrize("seed", [0, 3])
@pytest.mark.parametrize("tau", [0.5, 8.0])
def test_agrees_with_the_papers_listing(seed, tau):
    """Algorithm 4, one vertex and edge at a time, with the rescaled kernels of section 7."""
    case = problem(seed, tau=tau)
    found = solved(case)
    assert found.converged
    assert mass_apart(found.densities, case.algorithm_4(400), case.domain).max() < 2e-5


def test_minimizes_the_objective():
    """Compared with a general optimizer on the dual, which shares nothing with Algorithm 4."""
    case = problem(gamma=0.2, tau=3.0)
    assert mass_apart(solved(case).densities, case.by_dual(), case.domain).max() < 1e-4


def test_without_pairs_it_minimizes_the_objective_too():
    case = problem(gamma=0.2, tau=3.0)
    free = Literal(case.edges, case.weights, case.source_areas, case.costs, case.tau, case.domain, {})
    assert mass_apart(solved(free).densities, free.by_dual(), free.domain).max() < 1e-4


@pytest.mark.parametrize("sharpness", [0.0, 1.0])
def test_order_of_vertices_does_not_matter(sharpness):
    case = problem(5)
    rng = np.random.default_rng(1)
    new, new_target = rng.permutation(12), rng.permutation(20)
    place, place_target = np.argsort(new), np.argsort(new_target)
    mesh = case.domain.mesh
    target = Surface(mesh.vertices[new_target], place_target[mesh.faces], case.domain.gamma)
    turned = Literal(
        place[case.edges][::-1, ::-1],
        case.weights[::-1],
        case.source_areas[new],
        case.costs[np.ix_(new, new_target)],
        case.tau,
        target,
        {int(place[2]): case.fixed[2][new_target]},
    )
    one, other = solved(case, sharpness=sharpness), solved(turned, sharpness=sharpness)
    back = other.densities[np.ix_(place, place_target)]
    assert mass_apart(back, one.densities, case.domain).max() < 5e-3


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 1000), tau=st.floats(0.0, 200.0), sharpness=st.floats(0.0, 1.0), sweeps=st.integers(1, 5))
def test_rows_are_densities_and_fixed_rows_are_unchanged(seed, tau, sharpness, sweeps):
    case = problem(seed)
    found = solved(case, tau=tau, sharpness=sharpness, sweeps=sweeps)
    assert found.densities.dtype == np.float32
    assert (found.densities >= 0).all()
    np.testing.assert_allclose(found.densities @ found.areas, 1.0, rtol=1e-5)
    np.testing.assert_allclose(found.densities[2], case.fixed[2], rtol=1e-4, atol=1e-6)
    assert len(found.changes) == found.iterations <= sweeps
    assert ((found.changes >= 0) & (found.changes <= 2.0001)).all()


def test_debiased_maps_do_not_blur():
    """Between equal distributions, only that distribution occurs; the paper's map gets wider with every edge."""
    target = sheet(6, 6, 2, 0.02)
    point = target.with_kernel(0.02).apply(np.eye(36)[14] / target.weights[14])
    arguments = (np.zeros((5, 36)), [[0, 1], [1, 2], [2, 3], [3, 4]], 1.0, np.ones(5), target)
    sharp = soft_map(*arguments, fixed={0: point, 4: point}, sharpness=1.0, **LONG)
    plain = soft_map(*arguments, fixed={0: point, 4: point}, sharpness=0.0, **LONG)
    assert mass_apart(sharp.densities, point, target).max() < 0.02
    assert plain.entropies[2] > sharp.entropies[2] + 0.3


def test_a_mesh_maps_to_itself():
    mesh = icosphere(2)
    surface = Surface(mesh.vertices, mesh.faces)
    costs = np.stack([point_distances(i, surface) for i in range(len(mesh.vertices))]) ** 2
    graph = SourceEdges.of(surface.laplacian)
    found = soft_map(costs, graph.edges, graph.weights, surface.weights, soft_map_domain(surface))
    assert (found.densities.argmax(axis=1) == np.arange(len(costs))).all()
    # On the unit sphere, with vertices 0.31 apart.
    images = (found.densities * found.areas) @ mesh.vertices
    assert np.linalg.norm(images - mesh.vertices, axis=1).max() < 0.2


def test_the_weight_of_the_compatibility():
    case = problem()
    free = {"fixed": {}, "tau": 1e4}
    found = solved(case, **free).densities
    assert (found.argmax(axis=1) == case.costs.argmin(axis=1)).all()
    np.testing.assert_allclose(solved(case, fixed={}, tau=0.0).densities, 1.0, atol=1e-3)


def test_entropies():
    case = problem()
    found = solved(case)
    held = np.maximum(found.densities.astype(float), 1e-300)
    np.testing.assert_allclose(found.entropies, -(held * np.log(held)) @ case.domain.weights, atol=1e-5)


def test_pairs_fix_their_vertices():
    case = problem(1)
    found = solved(case, fixed={}, pairs=[[0, 5], [11, 13]])
    assert found.densities[[0, 11]].argmax(axis=1).tolist() == [5, 13]


def test_contradictory_pairs_share_the_mass():
    found = solved(problem(), fixed={}, pairs=[[3, 0], [3, 19]])
    alone = [solved(problem(), fixed={}, pairs=[[3, target]], sweeps=1).densities[3] for target in (0, 19)]
    np.testing.assert_allclose(found.densities[3], np.mean(alone, axis=0), atol=1e-4)
    assert np.isfinite(found.densities).all()


def test_unused_vertices():
    case = problem()
    mesh = case.domain.mesh
    loose = Surface(np.vstack([mesh.vertices, [[9.0, 9, 9]]]), mesh.faces, case.domain.gamma)
    costs = np.pad(case.costs, ((0, 1), (0, 1)))
    fixed = {2: np.append(case.fixed[2], 0.0)}
    options = {"fixed": fixed, "tau": case.tau, "sharpness": 0.0, **LONG}
    found = soft_map(costs, case.edges, case.weights, np.append(case.source_areas, 0.0), loose, **options)
    np.testing.assert_allclose(found.densities[:-1, :-1], solved(case).densities, atol=1e-4)
    assert (found.densities[:, -1] == 0).all()
    np.testing.assert_allclose(found.densities[-1, :-1], 1.0)
    # With a pair, even a vertex without edges gets a density.
    held = soft_map(costs, case.edges, case.weights, np.ones(13), loose, pairs=[[12, 4]])
    assert held.densities[12].argmax() == 4


def test_targets_with_several_components():
    """A component of the source that is fixed to a component of the target stays there."""
    one, other = sheet(4, 5, 1).mesh, sheet(3, 4, 2).mesh
    target = Surface(
        np.vstack([one.vertices, other.vertices + 20.0]), np.vstack([one.faces, other.faces + 20]), gamma=0.05
    )
    costs = np.random.default_rng(0).uniform(0, 1, (6, 32))
    edges = [[0, 1], [1, 2], [3, 4], [4, 5]]
    found = soft_map(costs, edges, 1.0, np.ones(6), target, pairs=[[0, 3], [5, 25]], sweeps=30)
    on_first = found.densities[:, :20] @ target.weights[:20]
    np.testing.assert_allclose(on_first, [1, 1, 1, 0, 0, 0], atol=1e-3)


def test_a_solution_as_start_is_unchanged():
    case = problem()
    done = solved(case, sharpness=1.0)
    again = solved(case, sharpness=1.0, initial=done, sweeps=3)
    cold = solved(case, sharpness=1.0, sweeps=3)
    assert mass_apart(again.densities, done.densities, case.domain).mean() < 0.1
    assert mass_apart(cold.densities, done.densities, case.domain).mean() > 0.2


def test_a_solve_can_be_cancelled_at_any_sweep():
    control = CountingControl(last=3)
    with pytest.raises(Cancelled):
        solved(problem(), control=control)
    assert control.count == 3
    changes = solved(problem(), sweeps=3).changes
    assert changes[0] > changes[2] > 0


def test_the_solve_stops_at_the_tolerance():
    found = solved(problem(), tolerance=1e-3)
    assert found.converged
    assert (found.changes[:-1] >= 1e-3).all()
    assert found.changes[-1] < 1e-3
    assert not solved(problem(), sweeps=1).converged


@pytest.mark.parametrize("steps", [1, 4, 7])
def test_the_dense_kernel_is_the_domains(steps):
    surface = sheet(5, 6, 3).with_kernel(0.05, steps)
    rows = np.random.default_rng(0).uniform(0, 1, (3, 30))
    np.testing.assert_allclose(rows @ dense_kernel(surface), surface.apply(rows), rtol=1e-5)


BAD = [
    ({"costs": np.zeros((3, 20))}, "compatibility"),
    ({"costs": np.full((12, 20), np.nan)}, "compatibility"),
    ({"edges": [[0, 12]]}, "edges"),
    ({"edges": [[1, 1]]}, "edges"),
    ({"edges": np.zeros((0, 2), int)}, "edges"),
    ({"weights": 0.0}, "edge_weights"),
    ({"weights": [1.0, 2.0]}, "edge_weights"),
    ({"areas": np.zeros(12)}, "source_areas"),
    ({"pairs": [[0, 20]]}, "pairs"),
    ({"pairs": [[-1, 0]]}, "pairs"),
    ({"pairs": [[0.5, 1.0]]}, "pairs"),
    ({"pairs": [[0, 1, 2]]}, "pairs"),
    ({"pairs": [[2, 1]], "fixed": {2: np.ones(20)}}, "both"),
    ({"fixed": {12: np.ones(20)}}, "fixed"),
    ({"fixed": {0: -np.ones(20)}}, "fixed"),
    ({"tau": -1.0}, "tau"),
    ({"sharpness": 1.5}, "sharpness"),
    ({"sweeps": 0}, "sweeps"),
    ({"initial": np.zeros((12, 20))}, "initial"),
    ({"initial": np.ones((2, 20))}, "initial"),
]


@pytest.mark.parametrize(("change", "word"), BAD)
def test_invalid_arguments_are_named(change, word):
    case = problem()
    options = dict(change)
    positional = [
        options.pop("costs", case.costs),
        options.pop("edges", [[0, 1], [1, 2], [2, 3]]),
        options.pop("weights", 1.0),
        options.pop("areas", case.source_areas),
    ]
    with pytest.raises(ValueError, match=word):
        soft_map(*positional, case.domain, **options)
