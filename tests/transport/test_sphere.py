# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transport on the sphere compared with distances, great circles and rotated inputs."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.transport import KernelTooNarrowError, Sphere, barycenter, distance
from convwass_addon.transport.region import Region

COLUMN = 5


def unit(colatitude, longitude):
    theta, phi = np.radians(colatitude), np.radians(longitude)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def angles(center, vectors):
    return 2.0 * np.arcsin(np.clip(np.linalg.norm(vectors - center, axis=-1) / 2.0, 0.0, 1.0))


def blob(domain, center, width):
    return np.exp(-(angles(center, domain.positions) ** 2) / (2.0 * width**2))


def mean_direction(density, domain):
    total = ((density * domain.weights)[..., None] * domain.positions).sum(axis=(0, 1))
    return total / np.linalg.norm(total)


def midpoint(first, second):
    return (first + second) / np.linalg.norm(first + second)


@pytest.mark.parametrize("part", ["whole", "upper"])
def test_solid_angles(part):
    domain = Sphere(16, 2.0, part=part)
    assert domain.solid_angles.sum() == pytest.approx(4 * np.pi if part == "whole" else 2 * np.pi, rel=1e-14)
    assert domain.weights.sum() == pytest.approx(1.0, rel=1e-14)
    edges = np.cos(np.linspace(0, np.pi, domain.whole_rows + 1))
    bands = (edges[:-1] - edges[1:])[:16] * 2 * np.pi
    assert np.allclose(domain.solid_angles.sum(axis=1), bands, rtol=1e-12)


@pytest.mark.parametrize("row", [0, 1, 2, 8, 32])
@pytest.mark.parametrize("method", ["log_apply", "log_apply_far"])
def test_kernel_is_exact_in_logarithms(row, method):
    domain = Sphere(64, 1.5)
    point = np.full(domain.shape, -1e4)
    point[row, COLUMN] = 0.0
    found = np.empty(domain.shape)
    getattr(domain, method)(point, found)
    sigma = 1.5 * domain.radians
    far = angles(domain.positions[row, COLUMN], domain.positions)
    near = far < 25 * sigma
    # With one constant for all rows, no row sums to more than one, and the largest sum is one.
    constant = found[row, COLUMN] - np.log(domain.weights[row, 0])
    assert np.abs(found - (constant + np.log(domain.weights[row, 0]) - far**2 / (2 * sigma**2)))[near].max() < 1e-10
    assert near.any() and not near.all()


def test_one_constant_for_all_rows():
    domain = Sphere(32, 1.5)
    ones = domain.apply(np.ones(domain.shape))
    assert 0.98 < ones.min() <= ones.max() == pytest.approx(1.0, abs=1e-12)
    assert np.ptp(ones, axis=1).max() < 1e-13


@pytest.mark.parametrize("kernel", ["exact", "filter"])
@pytest.mark.parametrize("part", ["whole", "upper"])
def test_kernel_is_symmetric(kernel, part):
    domain = Sphere(16, 1.5, part=part, kernel=kernel)
    rng = np.random.default_rng(0)
    f, g = rng.random((2, *domain.shape))
    there = (domain.weights * g * domain.apply(f)).sum()
    assert there == pytest.approx((domain.weights * f * domain.apply(g)).sum(), rel=1e-12)


def test_far_numerics_reach_where_scalings_do_not():
    domain = Sphere(32, 0.5)
    point = np.full((1, *domain.shape), -1e4)
    point[0, 16, 0] = 0.0
    near, far = np.empty_like(point), np.empty_like(point)
    domain.log_apply(point, near)
    domain.log_apply_far(point, far)
    known = near > -1e3
    assert np.abs(near - far)[known].max() < 1e-9
    assert (near == -1e4).any()
    opposite = -((np.pi / (0.5 * domain.radians)) ** 2) / 2
    assert far[0, 15, 32] - far[0, 16, 0] == pytest.approx(opposite, rel=0.1)


def test_far_numerics_refuse_large_grids():
    domain = Sphere(128, 1.5)
    with pytest.raises(KernelTooNarrowError, match="too small for scalings"):
        domain.log_apply_far(np.zeros(domain.shape), np.zeros(domain.shape))


PLACES = {
    "equator": (unit(90, 40), unit(90, 140), 0.01),
    "slanted": (unit(40, 20), unit(110, 110), 0.01),
    "near a pole": (unit(15, 20), unit(60, 170), 0.01),
    "over the pole": (unit(45, 20), unit(40, 200), 0.01),
    "across the seam": (unit(80, 350), unit(100, 60), 0.01),
}


@pytest.mark.parametrize("name", PLACES)
def test_barycenter_lies_on_the_great_circle(name):
    first, second, pixels = PLACES[name]
    domain = Sphere(64, 1.5)
    width = 3 * domain.radians
    mus = np.stack([blob(domain, first, width), blob(domain, second, width)])
    found = barycenter(mus, [0.5, 0.5], domain, tolerance=1e-3)
    assert found.converged and found.numerics == "scaling" and len(found.iterations) == 3
    assert angles(mean_direction(found.density, domain), midpoint(first, second)) < pixels * domain.radians


def test_blobs_widen_across_the_great_circle():
    domain = Sphere(64, 1.5)
    first, second, _ = PLACES["equator"]
    width = 3 * domain.radians
    mus = np.stack([blob(domain, first, width), blob(domain, second, width)])
    found = barycenter(mus, [0.5, 0.5], domain, sharpness=1.0, tolerance=1e-3)
    # Along the path the width is unchanged; across it, great circles bulge by 1 / cos(d / 2).
    mass = found.density * domain.weights
    middle = midpoint(first, second)
    sideways = np.arcsin(domain.positions[..., 2])
    along = np.cross([0, 0, 1.0], middle) @ np.moveaxis(domain.positions, -1, 0).reshape(3, -1)
    along = np.arcsin(along).reshape(domain.shape)
    bulge = 1 / np.cos(np.radians(50))
    assert np.sqrt((mass * sideways**2).sum()) == pytest.approx(bulge * width, rel=0.03)
    assert np.sqrt((mass * along**2).sum()) == pytest.approx(width, rel=0.03)


def test_the_error_of_the_filter_is_below_a_third_of_sigma():
    domain = Sphere(64, 1.5, kernel="filter")
    first, second, _ = PLACES["near a pole"]
    mus = np.stack([blob(domain, end, 3 * domain.radians) for end in (first, second)])
    found = barycenter(mus, [0.5, 0.5], domain, tolerance=1e-3)
    off = angles(mean_direction(found.density, domain), midpoint(first, second)) / (1.5 * domain.radians)
    assert 0.02 < off < 0.33


def test_distance_is_that_of_the_great_circle():
    domain = Sphere(64, 2.0)
    first, second = unit(30, 10), unit(80, 60)
    width = 3 * domain.radians
    found = distance(blob(domain, first, width), blob(domain, second, width), domain, tolerance=1e-4)
    # Points at distance y from the path have a shorter path: sin(d' / 2) = cos(y) sin(d / 2).
    beside = np.linspace(-4, 4, 201) * width
    shorter = 2 * np.arcsin(np.cos(beside) * np.sin(angles(first, second) / 2))
    expected = np.sqrt(np.average(shorter**2, weights=np.exp(-((beside / width) ** 2) / 2)))
    assert np.sqrt(found.value) == pytest.approx(expected, rel=0.003)


@settings(max_examples=8, deadline=None)
@given(turn=st.integers(1, 63), flip=st.booleans(), seed=st.integers(0, 99))
def test_rotating_the_inputs_rotates_the_barycenter(turn, flip, seed):
    domain = Sphere(32, 1.5)
    rng = np.random.default_rng(seed)
    ends = [midpoint(v, v) for v in rng.normal(size=(2, 3))]
    mus = np.stack([blob(domain, end, 4 * domain.radians) + 1e-6 for end in ends])
    plain = barycenter(mus, [0.4, 0.6], domain).density
    moved = np.roll(mus, turn, axis=2)[:, :: -1 if flip else 1]
    turned = barycenter(moved, [0.4, 0.6], domain).density
    # Coarser levels rotate by whole cells only if the rotation is a multiple of theirs.
    expected = np.roll(plain, turn, axis=1)[:: -1 if flip else 1]
    error = (np.abs(turned - expected) * domain.weights).sum()
    assert error < (1e-9 if turn % 4 == 0 else 2e-2)


@pytest.mark.parametrize("part", ["whole", "upper"])
def test_coarser_sphere(part):
    domain = Sphere(32, 2.0, part=part)
    coarse = domain.coarser()
    assert coarse.shape == (16, domain.shape[1] // 2) and coarse.part == part
    assert domain.fall_of_gamma == pytest.approx(coarse.gamma / domain.gamma)
    rng = np.random.default_rng(1)
    density = rng.random((2, *domain.shape))
    masses = [
        (values * own.weights).sum(axis=(1, 2))
        for values, own in ((density, domain), (domain.restrict(density), coarse))
    ]
    assert np.allclose(*masses, rtol=1e-13)
    heights = coarse.positions[None, ..., 0]
    finer = domain.prolong(heights, Region.whole(domain.shape)).reshape(domain.shape)
    assert np.abs(finer - domain.positions[..., 0])[: 32 if part == "whole" else 31].max() < 0.02
    with_edge = Region(domain.positions[..., 0] > 0.9) if part == "whole" else Region(domain.positions[..., 2] > 0.9)
    assert np.array_equal(domain.prolong(heights, with_edge)[0], with_edge.gather(finer))


def test_ladder_ends():
    sizes = []
    domain = Sphere(64, 2.0)
    while domain is not None:
        sizes.append(domain.shape)
        domain = domain.coarser()
    assert sizes == [(64, 128), (32, 64), (16, 32)]


def test_survives_pickling():
    domain = Sphere(16, 1.5)
    values = np.random.default_rng(2).random(domain.shape)
    assert np.array_equal(pickle.loads(pickle.dumps(domain)).apply(values), domain.apply(values))


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"rows": 7, "sigma": 2.0}, "rows"),
        ({"rows": 2048, "sigma": 2.0}, "rows"),
        ({"rows": 16, "sigma": 0.0}, "sigma"),
        ({"rows": 16, "sigma": np.nan}, "sigma"),
        ({"rows": 16, "sigma": 2.0, "columns": 31}, "columns"),
        ({"rows": 16, "sigma": 2.0, "part": "lower"}, "part"),
        ({"rows": 16, "sigma": 2.0, "kernel": "fft"}, "kernel"),
    ],
)
def test_bad_spheres_are_refused(options, name):
    with pytest.raises(ValueError, match=f"^{name} must"):
        Sphere(**options)


def test_bad_columns_are_refused():
    with pytest.raises(ValueError, match=r"^columns must have the shape"):
        Sphere(16, 2.0).apply(np.ones((16, 16)))
