# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.applications import memory
from convwass_addon.applications.background import BackgroundJob
from convwass_addon.applications.densities.density_graphs import propagation_steps
from convwass_addon.applications.densities.density_paths import blend_steps, interpolation_steps, path_steps
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.errors import Cancelled, InputError, ResourceError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained
from convwass_addon.transport import bisect
from convwass_addon.transport.sharpening import entropy
from tests.applications.test_density_pieces import BALLS, on
from tests.controls import recorded
from tests.shapes import body, square, torus
from tests.transport.sheets import sheet_mesh
from tests.transport.spheres import angles, at, cap, off_center, sphere

SPHERE = sphere(3, 0.01)
FINE = sphere(4, 0.01)
FAR = 1.6


def radius(surface, density, angle):
    """Root mean square angle from a point on the equator."""
    return np.sqrt((density * surface.weights) @ angles(surface, at(angle)) ** 2)


def check_records(frames):
    np.testing.assert_allclose(frames.densities @ frames.surface.weights, 1.0, rtol=1e-6)
    assert (frames.densities >= 0).all()
    for time, density, figures in zip(frames.times, frames.densities, frames.records, strict=True):
        assert figures["time"] == time
        assert figures["entropy"] == pytest.approx(entropy(density, frames.surface.weights), abs=1e-9)
        assert not figures["converged"] or figures["marginal_error"] <= 1e-2
        assert (figures["iterations"] == 0) == (figures["key"] is not None)
    json.dumps(frames.records, allow_nan=False)


@pytest.mark.parametrize("steps", [6, 8])
def test_a_cap_stays_a_cap_on_the_great_circle(steps):
    """Centers measured within 0.0023 rad; radii are 4 % below that of the cap, as for a bump of the same entropy."""
    first, second = cap(FINE, 0.0), cap(FINE, FAR)
    frames = drained(interpolation_steps(first, second, FINE, DensitySettings(steps=steps)))
    check_records(frames)
    np.testing.assert_allclose(frames.times, np.arange(steps + 1) / steps)
    np.testing.assert_allclose(frames.densities[[0, -1]], [first, second])
    expected = radius(FINE, first, 0.0)
    for time, density, figures in zip(frames.times, frames.densities, frames.records, strict=True):
        assert figures["converged"]
        assert off_center(FINE, density, FAR * time) < 0.005
        assert radius(FINE, density, FAR * time) == pytest.approx(expected, rel=0.06)


def test_a_pulse_from_head_to_foot_keeps_the_peak_of_a_gaussian():
    """A Gaussian with entropy H has the peak e^(1 - H); the mass uses the areas of the mesh."""
    mesh = body()
    up, across = mesh.vertices[:, 2], mesh.vertices[:, 0]
    head, foot = np.clip((up - 1.72) / 0.05, 0, 1), np.clip((0.08 - up) / 0.04, 0, 1) * (across > 0)
    surface = density_surface(mesh)
    frames = drained(interpolation_steps(head, foot, surface, DensitySettings(steps=12)))
    entropies = np.array([figures["entropy"] for figures in frames.records])
    peaks = frames.densities.max(axis=1) / np.exp(1.0 - entropies)
    assert peaks[1:-1].max() < 1.2
    assert peaks[1:-1].min() > 0.8
    np.testing.assert_allclose(frames.densities @ mesh.vertex_areas / mesh.area, 1.0, atol=0.025)


def test_without_a_bound_frames_spread_and_contract_monotonically():
    """No frame is sharper than both of its neighbors beyond rounding, so nothing flickers."""
    ends = cap(SPHERE, 0.0), cap(SPHERE, FAR)
    frames = drained(interpolation_steps(*ends, SPHERE, DensitySettings(steps=12, entropy_limit=None)))
    check_records(frames)
    entropies = np.array([figures["entropy"] for figures in frames.records])
    assert (np.diff(entropies[:7]) > 0).all()
    assert (np.diff(entropies[6:]) < 0).all()
    assert entropies[6] > entropies[0] + 1.0
    for time, density in zip(frames.times, frames.densities, strict=True):
        assert off_center(SPHERE, density, FAR * time) < 0.05


def test_an_entropy_bound_in_nats_holds():
    ends = cap(SPHERE, 0.0), cap(SPHERE, FAR)
    frames = drained(interpolation_steps(*ends, SPHERE, DensitySettings(steps=4, entropy_limit=-2.5)))
    assert max(figures["entropy"] for figures in frames.records) < -2.5 + 1e-3


def test_an_entropy_bound_that_no_density_meets_is_refused():
    """The least entropy is that of a unit mass at the vertex with the smallest area."""
    least = np.log(SPHERE.weights.min())
    ends, shown = [cap(SPHERE, 0.0), cap(SPHERE, FAR)], f"a single vertex has {least:.2f}"
    settings = DensitySettings(steps=4, entropy_limit=float(least) - 0.01)
    for work in (
        path_steps(ends, "AB", SPHERE, settings),
        blend_steps(ends, "AB", [1, 1], SPHERE, settings),
        propagation_steps([(0, 1)], {0: ends[0]}, SPHERE, settings, "AB"),
    ):
        with pytest.raises(InputError, match=shown):
            next(work)
    next(path_steps(ends, "AB", SPHERE, replace(settings, entropy_limit=float(least) + 0.01)))


def test_a_path_reaches_its_keys_at_their_times():
    places, times = [0.0, 0.8, 0.2], [1.0, 3.0, 11.0]
    groups = [cap(SPHERE, place) for place in places]
    found = recorded(path_steps(groups, "ABC", SPHERE, DensitySettings(steps=4), times))
    frames = found.result
    check_records(frames)
    np.testing.assert_allclose(frames.times, [1, 1.5, 2, 2.5, 3, 5, 7, 9, 11])
    assert [figures["key"] for figures in frames.records] == ["A", None, None, None, "B", None, None, None, "C"]
    np.testing.assert_allclose(frames.densities[[0, 4, 8]], groups)
    for time, density in zip(frames.times, frames.densities, strict=True):
        assert off_center(SPHERE, density, np.interp(time, times, places)) < 0.02
    fractions = [step.fraction for step in found.reports]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] == 1.0
    assert str(found.reports[0].message) == "From A to B"
    assert "From B to C" in [str(step.message) for step in found.reports]
    assert str(found.reports[-1].message) == "Reached C"


def test_one_step_returns_the_two_ends():
    groups = cap(SPHERE, 0.0), 5.0 * cap(SPHERE, 1.0)
    frames = drained(interpolation_steps(*groups, SPHERE, DensitySettings(steps=1), ("A", "B")))
    check_records(frames)
    assert [figures["key"] for figures in frames.records] == ["A", "B"]


def test_iterations_are_reported_per_solve():
    """Midpoints of one level share a number of iterations, and frames that are no midpoints have one each."""
    ends = cap(SPHERE, 0.0), cap(SPHERE, FAR)
    frames = drained(interpolation_steps(*ends, SPHERE, DensitySettings(steps=12)))
    found = [figures["iterations"] for figures in frames.records]
    alike = [{6}, {3, 9}, {1, 2, 4, 5, 7, 8, 10, 11}]
    solve = bisect(*ends, SPHERE, times=np.arange(13) / 12)
    assert [{found[i] for i in own} for own in alike] == [{solve.iterations[i]} for i in (0, 1, 3)]


def test_a_blend_lies_at_the_weighted_mean():
    """Measured 0.025 rad off between two, and 0 for three of equal weight."""
    groups = [cap(SPHERE, 0.0), cap(SPHERE, 0.8), cap(SPHERE, 0.4)]
    for shares, place in (([6.0, 2.0, 0.0], 0.2), ([1, 1, 1], 0.4), ([0, 1, 1], 0.6)):
        frames = drained(blend_steps(groups, "ABC", shares, SPHERE, DensitySettings()))
        (figures,) = frames.records
        assert figures["converged"]
        assert 0 < figures["marginal_error"] < 1e-2
        assert figures["weights"][0] == {"name": "A", "weight": pytest.approx(shares[0] / sum(shares))}
        assert off_center(SPHERE, frames.densities[0], place) < 0.03
        assert figures["entropy"] < entropy(groups[0], SPHERE.weights) + 1e-2


def test_a_blend_of_one_density_is_that_density():
    groups = [cap(SPHERE, 0.0), cap(SPHERE, 0.8)]
    for shares, expected in (([2, 0], groups[0]), ([0, 1], groups[1])):
        (density,) = drained(blend_steps(groups, "AB", shares, SPHERE, DensitySettings())).densities
        np.testing.assert_allclose(density, expected)


def test_a_blend_without_a_bound_is_that_of_the_paper():
    groups = [cap(SPHERE, 0.0), cap(SPHERE, 0.8), cap(SPHERE, 0.4)]
    settings_ = DensitySettings(entropy_limit=None)
    (density,) = drained(blend_steps(groups, "ABC", [1, 1, 1], SPHERE, settings_)).densities
    assert off_center(SPHERE, density, 0.4) < 0.01
    assert entropy(density, SPHERE.weights) > entropy(groups[0], SPHERE.weights) + 0.5


def test_components_keep_their_mass_in_every_frame():
    pair = on(0.4, 0.6, 1), on(0.4, 0.6, 2)
    frames = drained(interpolation_steps(*pair, BALLS, DensitySettings(steps=4)))
    own = BALLS.pieces == 0
    np.testing.assert_allclose((frames.densities * BALLS.weights)[:, own].sum(axis=1), 0.4, atol=1e-6)


def test_different_masses_of_components_are_refused_by_name_or_matched():
    pair = on(0.4, 0.6, 1), on(0.5, 0.5, 2)
    with pytest.raises(InputError, match=r"Head and Tail have different shares.*300 vertices"):
        next(interpolation_steps(*pair, BALLS, DensitySettings(), ("Head", "Tail")))
    with pytest.raises(InputError, match="Head and Tail lie on different pieces"):
        next(interpolation_steps(on(1, 0), on(0, 1), BALLS, DensitySettings(), ("Head", "Tail")))
    matching = DensitySettings(steps=2, pieces="match")
    assert len(drained(interpolation_steps(*pair, BALLS, matching)).times) == 3


def fins():
    """Three square sheets that share one edge line, with loose vertices."""
    flat = sheet_mesh(12, 12)
    turns = [np.array([[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]]) for a in (0.0, 2.1, 4.2)]
    vertices = np.concatenate([flat.vertices @ turn.T for turn in turns])
    faces = np.concatenate([flat.faces + len(flat.vertices) * i for i in range(3)])
    _, first, names = np.unique(np.round(vertices, 6), axis=0, return_index=True, return_inverse=True)
    loose = np.full((4, 3), 3.0)
    return TriangleMesh.from_arrays(np.concatenate([vertices[first], loose]), names.ravel()[faces])


def test_nonmanifold_edges_and_loose_vertices_do_not_distort_the_mass():
    """From the tip of one fin to the tip of another, through the edge that all three share."""
    mesh = fins()
    surface = density_surface(mesh)
    away = np.linalg.norm(mesh.vertices - [12, 6, 0], axis=1)
    to = np.linalg.norm(mesh.vertices - [12 * np.cos(2.1), 6, 12 * np.sin(2.1)], axis=1)
    first, second = np.where(away < 4, 1.0, 0.0), np.where(to < 4, 1.0, 0.0)
    first[-1] = 1.0
    frames = drained(interpolation_steps(first, second, surface, DensitySettings(steps=2)))
    assert not frames.densities[:, -4:].any()
    middle = frames.densities[1] * surface.weights
    assert middle @ np.linalg.norm(mesh.vertices[:, [0, 2]], axis=1) < 4.0
    assert frames.records[1]["converged"]


def test_an_open_and_a_closed_mesh_of_few_triangles_work():
    for mesh in (square(), torus(segments=(6, 4))):
        surface = density_surface(mesh)
        first, second = np.eye(len(mesh.vertices))[[0, 2]]
        frames = drained(interpolation_steps(first, second, surface, DensitySettings(steps=4)))
        np.testing.assert_allclose(frames.densities @ surface.weights, 1.0)


@settings(max_examples=6)
@given(
    st.integers(0, 2**32),
    st.integers(1, 9),
    st.sampled_from(["max", None, -1.0]),
    st.floats(1e-6, 1e6),
)
def test_any_paint_gives_the_requested_number_of_valid_frames(seed, steps, entropy_limit, scale):
    rng = np.random.default_rng(seed)
    groups = np.where(rng.random((2, *COARSE.shape)) < 0.2, rng.random((2, *COARSE.shape)), 0.0) * scale
    groups[:, 0] += scale
    asked = DensitySettings(steps=steps, entropy_limit=entropy_limit, max_iterations=40)
    frames = drained(interpolation_steps(*groups, COARSE, asked))
    assert frames.densities.shape == (steps + 1, *COARSE.shape)
    check_records(frames)


COARSE = sphere(2, 0.05)


@pytest.mark.parametrize(
    ("groups", "names", "options", "message"),
    [
        (1, "A", {}, "at least two groups"),
        (2, "A", {}, "2 groups and 1 names"),
        (2, "AB", {"key_times": [0.0]}, "2 groups and 1 key times"),
        (2, "AB", {"key_times": [1.0, 1.0]}, "later"),
        (2, "AB", {"key_times": [0.0, np.nan]}, "later"),
    ],
)
def test_invalid_paths_are_refused(groups, names, options, message):
    caps = [cap(SPHERE, 0.0), cap(SPHERE, 1.0)][:groups]
    with pytest.raises(InputError, match=message):
        next(path_steps(caps, names, SPHERE, DensitySettings(), **options))


@pytest.mark.parametrize(
    ("shares", "message"),
    [([1.0], "2 inputs, but there are 1"), ([1, -1], "positive"), ([0, 0], "zero"), ([1, np.nan], "positive")],
)
def test_blends_need_weights(shares, message):
    with pytest.raises(InputError, match=message):
        next(blend_steps([cap(SPHERE, 0.0), cap(SPHERE, 1.0)], "AB", shares, SPHERE, DensitySettings()))


def test_paint_is_refused_by_name_before_the_first_step():
    with pytest.raises(InputError, match="Tail is empty"):
        next(interpolation_steps(cap(SPHERE, 0.0), 0 * SPHERE.weights, SPHERE, DensitySettings(), ("Head", "Tail")))


def test_more_frames_than_memory_are_refused(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: 10_000_000)
    ends = cap(SPHERE, 0.0), cap(SPHERE, 1.0)
    with pytest.raises(ResourceError, match=r"9001 frames on 642 vertices need about .*fewer steps"):
        next(interpolation_steps(*ends, SPHERE, DensitySettings(steps=9000)))


@pytest.mark.parametrize("entropy_limit", ["max", None])
def test_a_job_in_the_background_is_cancelled_between_iterations(entropy_limit):
    ends = cap(FINE, 0.0), cap(FINE, FAR)
    slow = DensitySettings(steps=500, entropy_limit=entropy_limit, tolerance=1e-9, max_iterations=100_000)
    job = BackgroundJob(lambda control: interpolation_steps(*ends, FINE, slow, control=control))
    while not any(step.fraction == 0.0 for step in job.poll()):
        pass
    job.cancel()
    assert isinstance(job.error, Cancelled)
