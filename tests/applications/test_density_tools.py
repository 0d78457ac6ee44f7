# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.applications.densities.density_tools import diffused, sharpened, sharpened_by, unit_mass
from convwass_addon.applications.densities.surface_densities import density_surface, distribution
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.transport.sharpening import entropy
from tests.applications.test_surface_densities import SURFACE
from tests.controls import cancelled_control
from tests.shapes import ball, joined
from tests.transport.sheets import sheet_mesh
from tests.transport.spheres import cap, icosphere

PLANE = density_surface(sheet_mesh(40, 40))
MIDDLE = 20 * 41 + 20
BALLS = density_surface(joined(ball(1.0, points=400), ball(0.7, (5, 0, 0), points=300)))


def variances(density):
    away = PLANE.positions - PLANE.positions[MIDDLE]
    return (density * PLANE.weights) @ away[:, :2] ** 2


def test_a_unit_mass_is_at_its_vertices():
    density = unit_mass([3, 50, 50], SURFACE)
    assert density @ SURFACE.weights == pytest.approx(1.0)
    np.testing.assert_array_equal(np.flatnonzero(density), [3, 50])
    np.testing.assert_allclose((density * SURFACE.weights)[[3, 50]], 0.5)
    np.testing.assert_array_equal(unit_mass(3, SURFACE), unit_mass([3], SURFACE))


@pytest.mark.parametrize(
    ("vertices", "message"),
    [([], "No vertex"), ([444], "0 to 443"), ([-1], "0 to 443"), ([1.5], "whole numbers"), ([2, 442], "442 is loose")],
)
def test_unit_masses_need_vertices_with_area(vertices, message):
    with pytest.raises(InputError, match=message):
        unit_mass(vertices, SURFACE)


def test_diffusing_adds_the_square_of_the_length():
    """On a plane, the variance per axis grows by length^2, so 3 and then 4 equal 5, except for the time steps."""
    density = diffused(unit_mass(MIDDLE, PLANE), PLANE, 1.0, "a")
    before = variances(density)
    np.testing.assert_allclose(variances(diffused(density, PLANE, 1.5, "a")) - before, 2.25, rtol=2e-3)
    twice = diffused(diffused(density, PLANE, 1.2, "a"), PLANE, 1.6, "a")
    np.testing.assert_allclose(variances(twice) - before, 4.0, rtol=2e-3)
    once = diffused(density, PLANE, 2.0, "a")
    # Measured 0.012.
    assert np.abs(twice - once) @ PLANE.weights < 0.03


def test_the_first_harmonic_of_a_sphere_decays_at_the_exact_rate():
    """m Euler steps of total time L^2 / 2 scale it by (1 + L^2 / m)^-m, because its eigenvalue is 2."""
    surface = density_surface(icosphere(4))
    height = surface.positions[:, 2]
    density = 1.0 + 0.5 * height
    for length in (0.1, 0.5, 1.0):
        expected = 1.0 + 0.5 * height * (1.0 + length**2 / 10) ** -10
        np.testing.assert_allclose(diffused(density, surface, length, "a"), expected, atol=2e-3)


@settings(max_examples=20)
@given(st.floats(1e-3, 500.0), st.integers(0, 2**32))
def test_diffusing_keeps_the_mass_of_every_component_and_raises_entropy(length, seed):
    rng = np.random.default_rng(seed)
    density = distribution(np.where(rng.random(BALLS.shape) < 0.1, rng.random(BALLS.shape), 0.0), BALLS, "a")
    spread = diffused(density, BALLS, length, "a")
    assert (spread >= 0).all()
    for label in (0, 1):
        own = BALLS.pieces == label
        assert (spread * BALLS.weights)[own].sum() == pytest.approx((density * BALLS.weights)[own].sum(), rel=1e-6)
    assert entropy(spread, BALLS.weights) >= entropy(density, BALLS.weights) - 1e-9


@pytest.mark.parametrize("length", [0.0, -1.0, np.nan, np.inf, 1e9])
def test_invalid_lengths_are_refused(length):
    with pytest.raises(InputError, match="length"):
        diffused(unit_mass(0, PLANE), PLANE, length, "a")


@pytest.mark.parametrize("tool", [partial(diffused, length=0.3), partial(sharpened_by, share=0.5)])
def test_it_can_be_cancelled(tool):
    density = diffused(unit_mass(MIDDLE, PLANE), PLANE, 1.0, "a")
    with pytest.raises(Cancelled):
        tool(density, PLANE, name="a", control=cancelled_control())


def test_sharpening_a_gaussian_narrows_it():
    """Half of the area means the deviation over sqrt(2), and ln 2 nats less."""
    away = np.linalg.norm(PLANE.positions - PLANE.positions[MIDDLE], axis=1)
    gauss = distribution(np.exp(-(away**2) / (2 * 4.0**2)), PLANE, "a")
    half = sharpened_by(gauss, PLANE, 0.5, "a")
    assert entropy(half, PLANE.weights) == pytest.approx(entropy(gauss, PLANE.weights) - np.log(2), abs=1e-6)
    np.testing.assert_allclose(variances(half), 8.0, rtol=0.01)


def test_a_density_that_is_sharp_enough_is_unchanged():
    surface = density_surface(icosphere(3))
    density = cap(surface, 0.0)
    np.testing.assert_allclose(sharpened(density, surface, 0.0, "a"), density, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(sharpened_by(density, surface, 1.0, "a"), density, rtol=1e-9, atol=1e-12)


@settings(max_examples=20)
@given(st.floats(-4.0, -1.5), st.integers(0, 2**32))
def test_sharpening_reaches_its_entropy_and_keeps_the_mass_of_every_component(limit, seed):
    rng = np.random.default_rng(seed)
    density = diffused(unit_mass([*rng.integers(0, 400, 3), 500], BALLS), BALLS, 0.5, "a")
    sharp = sharpened(density, BALLS, limit, "a")
    assert entropy(sharp, BALLS.weights) <= limit + 1e-3
    for label in (0, 1):
        own = BALLS.pieces == label
        assert (sharp * BALLS.weights)[own].sum() == pytest.approx((density * BALLS.weights)[own].sum(), rel=1e-6)


def test_a_flat_top_cannot_be_sharpened():
    flat = np.where(np.linalg.norm(PLANE.positions - PLANE.positions[MIDDLE], axis=1) < 8, 1.0, 0.0)
    with pytest.raises(InputError, match=r"Paint cannot be sharpened.*Diffuse"):
        sharpened_by(flat, PLANE, 0.5, "Paint")
    soft = diffused(flat, PLANE, 2.0, "Paint")
    assert entropy(sharpened_by(soft, PLANE, 0.5, "Paint"), PLANE.weights) < entropy(soft, PLANE.weights) - 0.69


@pytest.mark.parametrize("share", [0.0, -0.5, 1.5, np.nan])
def test_area_fractions_lie_between_zero_and_one(share):
    with pytest.raises(InputError, match="share"):
        sharpened_by(unit_mass(0, PLANE), PLANE, share, "a")


def test_an_entropy_limit_must_be_a_number():
    with pytest.raises(InputError, match="number"):
        sharpened(unit_mass(0, PLANE), PLANE, np.nan, "a")
