# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane
from convwass_addon.transport import (
    SoftMapSweeps,
    SourceEdges,
    Surface,
    soft_map,
    soft_map_between,
    soft_map_domain,
    symmetric_soft_map,
)
from tests.controls import CountingControl

from .soft_map_cases import sheet

# The costs here are a tenth of those for real shapes.
HEAVY = SoftMapSweeps(tau=300.0)


@cache
def case():
    """Two sheets with corresponding positions, and costs that know the correspondence roughly."""
    source, target = sheet(18, 20, 1), sheet(17, 21, 2)
    rng = np.random.default_rng(0)
    places = [np.stack(np.indices(size).reshape(2, -1), 1) / (np.array(size) - 1) for size in ((18, 20), (17, 21))]
    noisy = places[0] + rng.normal(0, 0.1, places[0].shape)
    costs = ((noisy[:, None] - places[1]) ** 2).sum(axis=2)
    return source, target, costs.astype(np.float32), places


def error_of(densities, target, here, there):
    """Mean distance, in sizes of the sheet, of the rows' means from the true points."""
    return np.linalg.norm((densities * target.weights) @ there - here, axis=1).mean()


def test_is_as_accurate_as_many_sweeps_on_the_given_meshes():
    source, target, costs, (here, there) = case()
    graph = SourceEdges.of(source.laplacian)
    pairs = [[0, 0], [359, 356]]
    few = soft_map_between(costs, source, target, pairs=pairs, sweeps=HEAVY)
    domain = soft_map_domain(target)
    many = soft_map(costs, graph.edges, graph.weights, source.weights, domain, pairs=pairs, tau=HEAVY.tau, sweeps=30)
    unsolved = np.eye(len(there))[costs.argmin(axis=1)] / target.weights
    assert error_of(few.densities, target, here, there) < 1.2 * error_of(many.densities, target, here, there)
    assert error_of(few.densities, target, here, there) < 0.5 * error_of(unsolved, target, here, there)
    assert few.iterations <= 2
    assert len(few.coarse_iterations) == 1
    assert few.densities[[0, 359]].argmax(axis=1).tolist() == [0, 356]
    np.testing.assert_allclose(few.densities @ target.weights, 1.0, rtol=1e-5)


def test_small_meshes_take_all_sweeps_themselves():
    source, target = sheet(4, 5, 1), sheet(5, 5, 2)
    costs = np.random.default_rng(0).uniform(0, 1, (20, 25))
    graph = SourceEdges.of(source.laplacian)
    sweeps = SoftMapSweeps(coarse=4, fine=3, tolerance=1e-9)
    found = soft_map_between(costs, source, target, pairs=[[3, 4]], sweeps=sweeps)
    same = soft_map(
        costs,
        graph.edges,
        graph.weights,
        source.weights,
        soft_map_domain(target),
        pairs=[[3, 4]],
        sweeps=7,
        tolerance=1e-9,
    )
    np.testing.assert_array_equal(found.densities, same.densities)
    assert (found.iterations, found.coarse_iterations) == (7, ())


def disagreement(both, source, target):
    """L1 distance between the couplings of the two directions, 0 to 2."""
    forward = source.weights[:, None] * both.forward.densities * target.weights
    backward = target.weights[:, None] * both.backward.densities * source.weights
    return np.abs(forward - backward.T).sum()


def test_directions_agree_as_requested():
    source, target, costs, (here, there) = case()
    found = {a: symmetric_soft_map(costs, source, target, agreement=a, sweeps=HEAVY) for a in (0.0, 0.25, 0.6)}
    apart = [disagreement(both, source, target) for both in found.values()]
    assert apart[1] < 0.8 * apart[0]
    assert apart[2] < 0.9 * apart[1]
    errors = [error_of(both.forward.densities, target, here, there) for both in found.values()]
    back = [error_of(both.backward.densities, source, there, here) for both in found.values()]
    assert max(errors[1], back[1]) < 0.7 * max(errors[0], back[0])


def test_without_agreement_both_directions_are_independent():
    source, target, costs, _ = case()
    # A direction alone would stop earlier than both together.
    sweeps = SoftMapSweeps(coarse=3, fine=2, tolerance=1e-9)
    both = symmetric_soft_map(costs, source, target, pairs=[[5, 7]], agreement=0.0, sweeps=sweeps)
    forward = soft_map_between(costs, source, target, pairs=[[5, 7]], sweeps=sweeps)
    backward = soft_map_between(costs.T, target, source, pairs=[[7, 5]], sweeps=sweeps)
    np.testing.assert_array_equal(both.forward.densities, forward.densities)
    np.testing.assert_array_equal(both.backward.densities, backward.densities)


def test_pairs_fix_both_directions():
    source, target, costs, _ = case()
    both = symmetric_soft_map(costs, source, target, pairs=[[5, 300], [350, 2]])
    assert both.forward.densities[[5, 350]].argmax(axis=1).tolist() == [300, 2]
    assert both.backward.densities[[300, 2]].argmax(axis=1).tolist() == [5, 350]


def test_unused_vertices():
    source, target, costs, _ = case()
    loose = [Surface(np.vstack([[[5.0, 5, 5]], s.mesh.vertices]), s.mesh.faces + 1) for s in (source, target)]
    found = symmetric_soft_map(np.pad(costs, ((1, 0), (1, 0))), *loose, pairs=[[1, 1], [0, 5]])
    assert found.forward.densities[0].argmax() == 5
    for densities in (found.forward.densities, found.backward.densities):
        assert np.isfinite(densities).all()
        assert (densities[:, 0] == 0).all()
        assert densities[1].argmax() == 1


def test_a_solve_can_be_cancelled_on_any_level():
    source, target, costs, _ = case()
    whole, sweeps = CountingControl(), SoftMapSweeps(coarse=3, fine=5)
    found = soft_map_between(costs, source, target, control=whole, sweeps=sweeps)
    (coarse,) = found.coarse_iterations
    assert coarse > 0
    assert whole.count == coarse + found.iterations
    for last in (1, coarse, coarse + 1, whole.count):
        control = CountingControl(last)
        with pytest.raises(Cancelled):
            soft_map_between(costs, source, target, control=control, sweeps=sweeps)
        assert control.count == last


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"compatibility": np.zeros((2, 2))}, "compatibility"),
        ({"pairs": [[0, 357]]}, "target"),
        ({"pairs": [[360, 0]]}, "source"),
        ({"pairs": [[0.0, 1.0]]}, "pairs"),
        ({"agreement": 1.0}, "agreement"),
        ({"sweeps": SoftMapSweeps(coarse=0)}, "sweeps"),
        ({"sweeps": SoftMapSweeps(tau=-1.0)}, "tau"),
        ({"sweeps": SoftMapSweeps(tolerance=0.0)}, "tolerance"),
    ],
)
def test_invalid_arguments_are_named(change, word):
    source, target, costs, _ = case()
    options = {"compatibility": costs, "source": source, "target": target, **change}
    with pytest.raises(ValueError, match=word):
        symmetric_soft_map(**options)


def test_mirrors_tell_left_from_right():
    """Costs that are the same on both sides do not, even if a corner is known."""
    source, target, _costs, (here, there) = case()
    features = [np.stack([np.abs(2 * own[:, 0] - 1), own[:, 1]], axis=1) for own in (here, there)]
    noise = np.random.default_rng(1).normal(0, 0.05, (len(here), len(there)))
    costs = np.square(features[0][:, None] - features[1]).sum(axis=2) + noise
    # The rows of the sheets lie along y.
    mirrors = tuple(MirrorPlane(own.mesh.area_center, np.array([0.0, 1.0, 0.0])) for own in (source, target))
    asymmetries, errors = [], []
    for planes in (None, mirrors):
        found = soft_map_between(costs, source, target, pairs=[[0, 0]], mirrors=planes)
        rows = ((found.densities * target.weights) @ there[:, 0]).reshape(18, 20)
        asymmetries.append(np.abs(rows + rows[::-1] - 1.0).mean())
        errors.append(error_of(found.densities, target, here, there))
    assert asymmetries[1] < 0.05 < asymmetries[0]
    assert errors[1] < 0.6 * errors[0]
