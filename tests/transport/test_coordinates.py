# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import scipy.optimize

from convwass_addon.errors import Cancelled
from convwass_addon.transport import Grid, barycenter, barycentric_coordinates, distance, nearest_barycenter
from tests.controls import CountingControl
from tests.transport.gaussians import gaussian


def family(shape, count=4, seed=1):
    """Pairs of blobs, which span one dimension per pair; single Gaussians on a line would span only two."""
    rng = np.random.default_rng(seed)
    blobs = [
        gaussian(shape, rng.uniform(0.35, 0.65, len(shape)) * shape, rng.uniform(2.0, 3.0) ** 2) for _ in range(count)
    ]
    return np.stack([blob + 0.3 * other for blob, other in zip(blobs, [*blobs[1:], blobs[0]], strict=True)])


@pytest.mark.parametrize(("shape", "seed"), [((48,), 1), ((24, 20), 2), ((10, 12, 11), 1)])
@pytest.mark.parametrize(("sharpness", "tolerance"), [(0.0, 1e-6), (0.75, 1e-6), (1.0, 1e-5)])
def test_the_weights_of_a_barycenter_are_recovered(shape, sharpness, tolerance, seed):
    """To the accuracy of the barycenter."""
    mus, grid = family(shape), Grid(shape, 1.3)
    weights = np.random.default_rng(seed).dirichlet(np.ones(4))
    member = barycenter(mus, weights, grid, sharpness=sharpness, tolerance=tolerance, max_iterations=3000)
    found = barycentric_coordinates(member.density, mus, grid, sharpness=sharpness)
    np.testing.assert_allclose(found.weights, weights, atol=1e-5)
    assert found.weights.sum() == pytest.approx(1.0, abs=1e-12)
    assert found.converged
    assert found.marginal_error < 1e-5
    assert found.residual < 2e-3


@pytest.mark.parametrize("absent", [0, 2])
def test_inputs_without_weight_are_identified(absent):
    mus, grid = family((24, 20)), Grid((24, 20), 1.3)
    weights = np.array([0.3, 0.2, 0.4, 0.1])
    weights[absent] = 0.0
    member = barycenter(mus, weights, grid, tolerance=1e-6, max_iterations=1000)
    found = barycentric_coordinates(member.density, mus, grid)
    np.testing.assert_allclose(found.weights, weights / weights.sum(), atol=1e-5)
    assert found.weights[absent] < 1e-5


@pytest.mark.parametrize("corner", range(4))
@pytest.mark.parametrize("sharpness", [0.0, 0.75, 1.0])
def test_inputs_are_found_as_corners(corner, sharpness):
    """Only debiased is an input its own barycenter; plain, it is sharper than any barycenter of the family."""
    mus, grid = family((24, 20)), Grid((24, 20), 1.3)
    member = barycenter(mus, np.eye(4)[corner], grid, sharpness=sharpness, tolerance=1e-6).density
    found = barycentric_coordinates(member, mus, grid, sharpness=sharpness)
    np.testing.assert_allclose(found.weights, np.eye(4)[corner], atol=1e-5)
    assert found.residual < 2e-3
    sharper = barycentric_coordinates(mus[corner], mus, grid, sharpness=sharpness)
    assert sharper.weights.argmax() == corner
    assert (sharper.residual < 1e-3) == (sharpness == 1.0)


def test_the_residual_depends_on_the_sharpness_of_the_family():
    """The residual is smallest for the sharpness that was used."""
    mus, grid = family((24, 20)), Grid((24, 20), 1.3)
    member = barycenter(mus, [0.4, 0.3, 0.2, 0.1], grid, sharpness=0.75, tolerance=1e-6, max_iterations=1000).density
    right, *wrong = (barycentric_coordinates(member, mus, grid, sharpness=s).residual for s in (0.75, 0.0, 0.5, 1.0))
    assert right < 1e-3
    assert min(wrong) > 100 * right


def test_other_densities_have_a_residual_in_squared_cells():
    """Residual of the potentials, sigma^2 times that of their logarithms; does not depend on the margin."""
    mus, grid = family((24, 20)), Grid((24, 20), 1.3)
    stranger = gaussian((24, 20), [12, 10], 6.0**2)
    found = barycentric_coordinates(stranger, mus, grid)
    assert found.residual > 1.0
    mus, stranger = mus[:, 4:18, 3:17], gaussian((14, 14), [7, 7], 4.0)
    one = barycentric_coordinates(stranger, mus, Grid((14, 14), 1.3), tolerance=1e-8)
    pad = ((3, 5), (2, 6))
    other = barycentric_coordinates(
        np.pad(stranger, pad), [np.pad(mu, pad) for mu in mus], Grid((22, 22), 1.3), tolerance=1e-8
    )
    np.testing.assert_allclose(one.weights, other.weights, atol=1e-6)
    assert one.residual == pytest.approx(other.residual, rel=1e-6)


def test_one_input_has_all_the_weight():
    mus, grid = family((24, 20)), Grid((24, 20), 1.3)
    found = barycentric_coordinates(mus[1], mus[:1], grid)
    np.testing.assert_array_equal(found.weights, [1.0])
    assert found.residual > 0.1
    assert barycentric_coordinates(mus[0], mus[:1], grid, sharpness=1.0).residual < 1e-3
    np.testing.assert_array_equal(nearest_barycenter(mus[1], mus[:1], grid).weights, [1.0])


def test_order_of_inputs_does_not_matter():
    mus, grid = family((24, 20)), Grid((24, 20), 1.3)
    target = gaussian((24, 20), [13, 9], 9.0)
    order = [2, 0, 3, 1]
    one, other = (barycentric_coordinates(target, m, grid, tolerance=1e-9).weights for m in (mus, mus[order]))
    np.testing.assert_allclose(other, one[order], atol=1e-6)


def test_identical_inputs_share_their_weight():
    mus, grid = family((24, 20)), Grid((24, 20), 1.3)
    member = barycenter(mus[:2], [0.3, 0.7], grid, tolerance=1e-7, max_iterations=1000).density
    found = barycentric_coordinates(member, mus[[0, 1, 1]], grid)
    assert found.weights[0] == pytest.approx(0.3, abs=1e-4)
    assert found.weights[1:].sum() == pytest.approx(0.7, abs=1e-4)


LINE = Grid((48,), 1.5)
SPAN = np.stack(
    [
        gaussian((48,), [16], 4.0) + 0.5 * gaussian((48,), [24], 4.0),
        gaussian((48,), [30], 9.0),
        gaussian((48,), [22], 4.0) + gaussian((48,), [34], 4.0),
    ]
)
STRANGERS = {
    "two bumps": gaussian((48,), [25], 16.0) + 0.4 * gaussian((48,), [33], 2.0),
    "box": (np.abs(np.arange(48) - 22.5) < 5).astype(float),
}


@cache
def nearest(name, sharpness):
    return nearest_barycenter(STRANGERS[name], SPAN, LINE, sharpness=sharpness)


def reached(weights, target, sharpness):
    """Distance from the barycenter with these weights, computed from scratch."""
    blend = barycenter(SPAN, weights, LINE, sharpness=sharpness, tolerance=1e-4, max_iterations=1000)
    return distance(blend.density, target, LINE).value


@pytest.mark.parametrize(("name", "sharpness"), [("two bumps", 0.0), ("box", 0.75)])
def test_the_nearest_barycenter_is_nearer_than_any_other(name, sharpness):
    """Nearer than the starting point, the barycenter of equal weights, and its own neighbors."""
    target = STRANGERS[name]
    found = nearest(name, sharpness)
    assert found.weights.sum() == pytest.approx(1.0)
    assert found.weights.min() >= 0.0
    assert found.distance.value == pytest.approx(reached(found.weights, target, sharpness), abs=1e-3)
    start = barycentric_coordinates(target, SPAN, LINE, sharpness=sharpness).weights
    assert found.distance.value <= reached(start, target, sharpness)
    thirds = [np.array([i, j, 3 - i - j]) / 3 for i in range(4) for j in range(4 - i)]
    neighbors = [0.96 * found.weights + 0.04 * corner for corner in np.eye(3)]
    assert min(reached(w, target, sharpness) for w in [*thirds, *neighbors]) > found.distance.value - 1e-3
    np.testing.assert_allclose(found.barycenter.weights, found.weights, atol=1e-12)
    assert 1 < found.evaluations < 30


def test_a_barycenter_is_its_own_nearest_barycenter():
    member = barycenter(SPAN, [0.2, 0.5, 0.3], LINE, tolerance=1e-6, max_iterations=1000).density
    found = nearest_barycenter(member, SPAN, LINE)
    np.testing.assert_allclose(found.weights, [0.2, 0.5, 0.3], atol=1e-4)
    assert abs(found.distance.value) < 1e-6


def test_a_search_of_one_step_keeps_the_better_end():
    target = STRANGERS["two bumps"]
    start = reached(barycentric_coordinates(target, SPAN, LINE).weights, target, 0.0)
    one, many = nearest_barycenter(target, SPAN, LINE, max_evaluations=1), nearest("two bumps", 0.0)
    assert many.distance.value <= one.distance.value <= start + 1e-4
    assert one.evaluations < many.evaluations


def test_a_diverging_search_never_returns_a_worse_result(monkeypatch):
    """For any last point that the minimizer tries."""
    target = STRANGERS["two bumps"]
    start = barycentric_coordinates(target, SPAN, LINE).weights
    monkeypatch.setattr(scipy.optimize, "minimize", lambda value, x, **rest: [value(corner) for corner in np.eye(3)])
    found = nearest_barycenter(target, SPAN, LINE)
    np.testing.assert_allclose(found.weights, start)
    assert found.evaluations == 4
    assert found.distance.value == pytest.approx(reached(start, target, 0.0), abs=1e-3)


@pytest.mark.parametrize("solve", [barycentric_coordinates, nearest_barycenter])
def test_both_can_be_cancelled_at_any_iteration(solve):
    control = CountingControl(last=30)
    with pytest.raises(Cancelled):
        solve(STRANGERS["box"], SPAN, LINE, tolerance=1e-9, control=control)
    assert control.count == 30
