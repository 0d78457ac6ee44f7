# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse-to-fine solves on surfaces."""

from __future__ import annotations

from copy import copy
from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from convwass_addon.errors import Cancelled
from convwass_addon.progress import Control
from convwass_addon.transport import Surface, barycenter, bisect, bisection, distance, mesh_levels, propagate
from convwass_addon.transport.graph import line
from convwass_addon.transport.region import Region
from convwass_addon.transport.sharpening import entropy
from tests.shapes import ball, joined
from tests.transport.spheres import angles, cap, center, off_center, peaks, sphere
from tests.transport.tubes import BEND, LEG, RADIUS, bent_tube, rings, total_length

FAR = 1.6
RINGS, SIDES = 640, 16


def alone(surface):
    """The same surface without levels."""
    own = copy(surface)
    own.coarser = lambda: None
    return own


@cache
def globe(gamma=0.01):
    """A sphere with 10242 vertices."""
    return sphere(5, gamma)


@pytest.fixture(scope="module")
def small_globe():
    """A sphere with 4500 vertices, for solves that are compared; it has a coarser surface like larger ones."""
    mesh = ball(points=4500)
    surface = Surface(mesh.vertices, mesh.faces, 0.01)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mesh_levels, "FEWEST_VERTICES", 4000)
        assert surface.coarser().shape == (1125,)
    return surface


@cache
def tube():
    mesh = bent_tube(RINGS, SIDES)
    return Surface(mesh.vertices, mesh.faces, 0.01)


@pytest.fixture(scope="module", params=["globe", "tube", "pieces"])
def surface(request):
    if request.param == "pieces":
        mesh = joined(ball(points=9000), ball(center=(3, 0, 0), points=4000))
        return Surface(np.concatenate([mesh.vertices, [(0, 9, 0)]]), mesh.faces, 0.01)
    return globe() if request.param == "globe" else tube()


def test_the_coarser_surface(surface):
    """A quarter of the vertices; the same lengths and the same kernel."""
    coarse = surface.coarser()
    assert coarse is surface.coarser()
    assert coarse.shape[0] == pytest.approx(surface.shape[0] / 4, rel=0.1)
    assert coarse.coarser() is None
    assert (coarse.gamma, coarse.steps, surface.fall_of_gamma) == (surface.gamma, surface.steps, 1.0)
    assert coarse.unit_length == pytest.approx(surface.unit_length, rel=1e-12)
    assert coarse.weights.sum() == pytest.approx(1, abs=1e-12)
    assert coarse.weights.min() > 0
    assert (coarse.pieces is None) == (surface.pieces is None)


def test_kernels_share_the_coarser_mesh():
    surface = globe()
    other = surface.with_kernel(0.02, 5).coarser()
    assert other.mesh is surface.coarser().mesh
    assert (other.gamma, other.steps) == (0.02, 5)


def test_a_narrow_kernel_is_wider_on_the_coarser_mesh():
    """As wide as the coarse edges require, but no wider relative to them than the fine kernel to its edges."""
    narrow, narrower = globe(0.003), globe(1e-4)
    assert narrow.coarser().gamma == pytest.approx(0.2 * narrow.coarser().mean_edge_length, rel=1e-9)
    assert narrow.fall_of_gamma == pytest.approx(narrow.coarser().gamma / 0.003)
    ratios = [domain.gamma / domain.mean_edge_length for domain in (narrower, narrower.coarser())]
    assert ratios[1] == pytest.approx(ratios[0])


def test_small_meshes_have_no_coarser_level():
    assert sphere(4, 0.01).coarser() is None


def test_masses_and_smooth_functions_survive_a_round_trip(surface):
    coarse = surface.coarser()
    densities = np.random.default_rng(0).random((2, *surface.shape)) * (surface.weights > 0)
    restricted = surface.restrict(densities)
    assert restricted.shape == (2, *coarse.shape)
    np.testing.assert_allclose(restricted @ coarse.weights, densities @ surface.weights, rtol=1e-12)
    smooth = np.sin(surface.positions.T)
    back = surface.prolong(np.sin(coarse.positions.T), Region.whole(surface.shape))
    used = surface.weights > 0
    np.testing.assert_allclose(back[:, used], smooth[:, used], atol=0.04)
    part = Region(surface.positions[:, 0] > 0)
    np.testing.assert_array_equal(surface.prolong(np.sin(coarse.positions.T), part), back[:, part.index])


def test_the_coarser_kernel_is_the_same_kernel(surface):
    """Heat of a wide patch at the vertices of the coarser mesh."""
    coarse = surface.coarser()
    first = surface.positions[0]
    patch = np.where(surface.weights > 0, np.exp(-20 * np.square(surface.positions - first).sum(axis=1)), 0.0)
    heat = surface.apply(patch)
    found = coarse.apply(surface.restrict(patch[None])[0])
    # Vertices of the coarser mesh are a subset of those of the finer one.
    _, seeds = cKDTree(surface.positions).query(coarse.positions)
    np.testing.assert_allclose(found, heat[seeds], atol=0.02 * heat.max())


OPTIONS = [
    ({}, 0.01),
    ({"entropy_limit": "max"}, 0.01),
    ({"sharpness": 0.75}, 0.04),
]


@pytest.mark.parametrize(("options", "away"), OPTIONS, ids=["plain", "bound", "sharp"])
def test_barycenters_agree_with_cold_ones(small_globe, options, away):
    """Within the tolerance, in fewer rounds on the finest mesh; sharp ones have a tighter marginal constraint."""
    surface = small_globe
    mus = [cap(surface, 0.0), cap(surface, FAR), peaks(surface, 1)]
    found = barycenter(mus, [0.5, 0.3, 0.2], surface, **options)
    cold = barycenter(mus, [0.5, 0.3, 0.2], alone(surface), **options)
    assert found.converged
    assert cold.converged
    assert len(found.iterations) == 2
    assert found.iterations[-1] < cold.iterations[-1]
    assert np.abs(found.density - cold.density) @ surface.weights < away
    assert found.density @ surface.weights == pytest.approx(1, abs=1e-12)
    # With an entropy bound, the invariant is only as accurate as the marginals.
    assert "entropy_limit" in options or found.invariant_error < 1e-9


@pytest.mark.parametrize(("gamma", "limit"), [(0.003, "max"), (0.01, None), (0.03, "max")])
def test_propagation_agrees_with_a_cold_one(gamma, limit):
    surface = globe(gamma)
    ends = {0: cap(surface, 0.0), 2: cap(surface, FAR)}
    found = propagate(line(3), 1.0, ends, surface, entropy_limit=limit)
    cold = propagate(line(3), 1.0, ends, alone(surface), entropy_limit=limit)
    tight = propagate(line(3), 1.0, ends, alone(surface), entropy_limit=limit, tolerance=1e-6)
    assert found.converged.all()
    assert cold.coarse_iterations == ()
    assert len(found.coarse_iterations) == 1
    assert found.iterations <= cold.iterations
    for solved in (found, cold):
        assert np.abs(solved.densities[1] - tight.densities[1]) @ surface.weights < 5e-3


@pytest.mark.parametrize("limit", [None, "max"])
def test_errors_are_those_of_the_plans(limit):
    """Recomputed from the scalings with the surface's own kernel."""
    surface = globe()
    found = propagate(line(4), 1.0, {0: cap(surface, 0.0), 3: cap(surface, FAR)}, surface, entropy_limit=limit)
    scalings = np.exp(np.maximum(found.log_scalings, -600))
    plans = scalings * surface.apply(scalings[np.arange(6) ^ 1])
    errors = np.abs(plans - found.densities[line(4).ravel()]) @ surface.weights
    assert found.converged.all()
    assert errors.max() < 2e-2


def test_distances_are_solved_on_the_mesh_itself():
    surface = globe()
    found = distance(cap(surface, 0.0), cap(surface, FAR), surface)
    cold = distance(cap(surface, 0.0), cap(surface, FAR), alone(surface))
    assert (found.value, found.iterations) == (cold.value, cold.iterations)


def radius(surface, density):
    return np.sqrt((density * surface.weights) @ np.square(angles(surface, center(surface, density))))


@pytest.mark.parametrize("limit", ["max", None])
def test_caps_move_along_the_great_circle(small_globe, limit):
    """At any times; without a bound, the blur of all levels adds up, but the center stays on the path."""
    surface = small_globe
    ends = cap(surface, 0.0), cap(surface, FAR)
    times = np.arange(1, 12) / 12
    found = bisect(*ends, surface, times=times, entropy_limit=limit)
    assert found.converged.all()
    assert (found.marginal_errors < 0.01).all()
    np.testing.assert_allclose(found.densities @ surface.weights, 1, rtol=1e-12)
    assert max(off_center(surface, mu, FAR * t) for mu, t in zip(found.densities, times, strict=True)) < 0.01
    if limit == "max":
        np.testing.assert_allclose([radius(surface, mu) for mu in found.densities], radius(surface, ends[0]), rtol=0.15)
        assert (found.entropies < entropy(ends[0], surface.weights) + 1e-4).all()
        assert (found.raised_limits == 0).all()
    assert max(found.iterations) < 10


def test_bisection_agrees_with_cold_solves(small_globe):
    surface = small_globe
    ends = cap(surface, 0.0), peaks(surface, 1)
    found, cold = (bisect(*ends, domain, levels=2) for domain in (surface, alone(surface)))
    assert sum(found.iterations) < sum(cold.iterations)
    np.testing.assert_allclose(np.abs(found.densities - cold.densities) @ surface.weights, 0, atol=0.02)


@pytest.mark.parametrize(("limit", "away"), [("max", 0.03), (None, 0.1)])
def test_mass_does_not_jump_across_the_gap(limit, away):
    """From the middle of one leg of a U to the middle of the other, 0.5 apart through the air and 2.3 along the tube.

    The shortest path is along the inside of the bend. Without a bound, frames are as wide as a leg.
    """
    surface = tube()
    along = np.append(np.repeat(rings(RINGS), SIDES), [0.0, total_length()])
    start, end = 0.5 * LEG, total_length() - 0.5 * LEG
    ends = [np.exp(-0.5 * ((along - place) / 0.1) ** 2) * (np.abs(along - place) < 0.3) for place in (start, end)]
    way = LEG + np.pi * (BEND - RADIUS)
    found = bisect(*ends, surface, times=[0.1, 0.25, 0.5, 0.75, 0.9], entropy_limit=limit)
    assert found.converged.all()
    places = np.array([start + 0.1 * way, start + 0.25 * way, 0.5 * total_length()])
    places = np.append(places, total_length() - places[1::-1])
    mass = found.densities * surface.weights
    np.testing.assert_allclose(mass @ along, places, atol=away)
    if limit == "max":
        # While mass moves down one leg, the other leg is as near as ever through the air.
        far = np.abs(along - places[:, None]) > 0.6
        assert (mass * far).sum(axis=1)[[0, 1, 3, 4]].max() < 0.01


def test_unneeded_frames_are_not_solved():
    surface = sphere(3, 0.0145)
    ends = cap(surface, 0.0), cap(surface, FAR)
    found = bisect(*ends, surface, levels=4, times=[0.1, 0.0])
    everything = bisect(*ends, surface, levels=4, times=np.append(np.arange(1, 16) / 16, 0.1))
    assert len(found.iterations) == 5
    np.testing.assert_allclose(found.densities[0], everything.densities[-1], rtol=1e-9)
    assert len(bisect(*ends, surface, levels=4, times=[0.5]).iterations) == 1
    assert bisect(*ends, surface, levels=4, times=[0.0, 1.0]).iterations == ()


def test_steps_report_the_progress(small_globe):
    surface = small_globe
    ends = cap(surface, 0.0), cap(surface, FAR)
    reports, results = [], []

    def work():
        results.append((yield from bisection(*ends, surface, levels=3)))

    for report in work():
        reports.append(report)
        assert not results
    fractions = [report.fraction for report in reports]
    assert fractions == sorted(fractions)
    assert len(set(fractions)) >= 4
    assert 0.0 <= fractions[0] < 0.1
    assert 0.9 < fractions[-1] <= 1.0
    assert {report.payload.elements for report in reports} == {surface.coarser().shape[0], surface.shape[0]}
    np.testing.assert_array_equal(results[0].times, np.arange(9) / 8)


def test_a_solve_can_be_cancelled_on_any_level():
    surface = globe()
    ends = cap(surface, 0.0), cap(surface, FAR)
    for vertices in (surface.coarser().shape[0], surface.shape[0]):
        control, rounds = Control(), []
        with pytest.raises(Cancelled):
            for report in bisection(*ends, surface, levels=1, control=control):
                rounds.append(report.payload.elements)
                if rounds[-1] == vertices:
                    control.cancel()
        assert rounds.count(vertices) == 1


def test_a_bound_that_prevents_convergence_is_raised():
    """With a tolerance so small that 60 sweeps are not enough; the raised bound returns to its value at the ends."""
    surface = sphere(2, 0.05)
    ends = cap(surface, 0.0, 0.5), cap(surface, FAR, 0.5)
    found = bisect(*ends, surface, levels=2, tolerance=1e-300, max_iterations=100)
    assert not found.converged[1:-1].any()
    np.testing.assert_allclose(found.raised_limits, [0, 1.5, 1, 1.5, 0])
    limit = max(entropy(mu, surface.weights) for mu in ends)
    assert (found.entropies <= limit + found.raised_limits + 1e-6).all()
    assert found.entropies[2] > limit + 0.5
    fixed = bisect(*ends, surface, levels=1, tolerance=1e-300, max_iterations=100, entropy_limit=limit)
    assert fixed.entropies[1] == pytest.approx(limit, abs=1e-6)
    assert fixed.raised_limits[1] == 0


@pytest.mark.parametrize("share", [0.5, 0.85])
def test_two_peaks_converge_under_a_bound(share):
    """With step sizes for the range of a single peak, such frames never converged, and their bounds rose by nats."""
    surface = sphere(4, 0.016)
    north, south = [np.exp(-(angles(surface, np.array([0.0, 0.0, side])) ** 2) / 0.08) for side in (1.0, -1.0)]
    east, west = [np.exp(-(angles(surface, np.array([side, 0.3, 0.0])) ** 2) / 0.06) for side in (1.0, -1.0)]
    north, south, east, west = (peak / (peak @ surface.weights) for peak in (north, south, east, west))
    first = share * (north + east) / 2 + (1 - share) * (south + west) / 2
    second = share * east + (1 - share) * west
    found = bisect(first, second, surface, times=np.arange(13) / 12, entropy_limit="between")
    assert found.converged.all()
    assert (found.raised_limits == 0.0).all()
    assert max(found.iterations) < 80
    assert (np.diff(found.entropies) < 0.0).all()
    right = found.densities @ (surface.weights * (surface.positions[:, 0] > 0))
    ends = right[0], right[-1]
    assert right.min() > min(ends) - 0.03
    assert right.max() < max(ends) + 0.03
