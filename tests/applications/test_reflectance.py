# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes with closed forms, their interpolation, and the tables that render them."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.reflectance.ggx_fit import fit_ggx
from convwass_addon.applications.reflectance.lobe_frames import path_weights
from convwass_addon.applications.reflectance.lobe_interpolation import LobeBlend, blend_weights, linear_lobes
from convwass_addon.applications.reflectance.lobe_lookup import half_angle_table, reflectance_at
from convwass_addon.applications.reflectance.lobe_table import (
    LobeTable,
    incoming_directions,
    incoming_vectors,
    tabulated,
)
from convwass_addon.applications.reflectance.materials import AshikhminShirley, BlinnPhong, Ggx
from convwass_addon.applications.reflectance.reflectance_settings import ReflectanceSettings
from convwass_addon.errors import InputError
from convwass_addon.progress import drained
from convwass_addon.transport.sharpening import entropy

ROWS = 32
QUICK = ReflectanceSettings(rows=ROWS, incoming=4, turns=2)
MATERIALS = {
    "Blinn": BlinnPhong(50),
    "Ashikhmin": AshikhminShirley(20, 200),
    "GGX": Ggx(0.3, 0.3),
    "anisotropic GGX": Ggx(0.4, 0.15),
}


def finished(blend, weights, before=None):
    return drained(blend.steps(weights, before))


@pytest.fixture(scope="module")
def midpoint():
    blend = LobeBlend.of([Ggx(0.15, 0.15), Ggx(0.5, 0.5)], QUICK)
    return blend, finished(blend, [1, 1])


@pytest.mark.parametrize("name", MATERIALS)
def test_reflectance_is_reciprocal(name):
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(2, 20, 3))
    first[:, 2], second[:, 2] = np.abs(first[:, 2]) + 0.1, np.abs(second[:, 2]) + 0.1
    first, second = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (first, second))
    for a, b in zip(first, second, strict=True):
        material = MATERIALS[name]
        assert material.reflectance(a, b) == pytest.approx(material.reflectance(b, a), rel=1e-10)


@pytest.mark.parametrize("name", MATERIALS)
def test_tables_have_mass_one_and_conserve_energy(name):
    table = tabulated(MATERIALS[name], incoming_directions(4, 1), ROWS)
    assert (table.lobes * table.cells).sum(axis=(1, 2)) == pytest.approx(np.ones(4), rel=1e-12)
    assert (table.albedo > 0.02).all() and (table.albedo < 1.01).all()


def test_ggx_has_the_exact_median():
    """Half of the facets' projected area lies within tan(theta) = alpha of the normal, by the closed form."""
    alpha, rows = 0.2, 128
    table = tabulated(Ggx(alpha, alpha), incoming_directions(2, 1), rows)
    light = table.incoming[0]
    half = table.outgoing + light
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    # f cos(out) is D G / (4 cos(in)), half vectors have the measure d(out) / (4 H.in), and G is nearly one.
    facets = Ggx(alpha, alpha).reflectance(light, table.outgoing)[..., 0] * table.outgoing[..., 2]
    masking = 1 / (1 + 0.5 * (np.sqrt(1 + alpha**2 * (1 / table.outgoing[..., 2] ** 2 - 1)) - 1))
    mass = facets / masking * table.cells
    tangent = np.hypot(half[..., 0], half[..., 1]) / half[..., 2]
    for share in (0.2, 0.5, 0.7):
        inside = tangent < alpha * np.sqrt(share / (1 - share))
        assert mass[inside].sum() == pytest.approx(share, abs=0.02)


def test_barycenter_of_ggx_has_nearly_the_mean_alpha(midpoint):
    """In the half angle, transport interpolates alpha linearly; the horizon and the blur reduce it slightly."""
    _, found = midpoint
    fit = fit_ggx(found.table)
    assert 0.27 < fit.material.alpha_x < 0.335
    assert fit.total_variation < 0.12
    assert 0.85 < fit.peak_ratio < 1.15
    assert found.record["converged"] and not found.notices
    assert found.table.albedo == pytest.approx(sum(table.albedo for table in midpoint[0].tables) / 2)


def test_the_fit_recovers_the_tabulated_material():
    for material in (Ggx(0.3, 0.3), Ggx(0.4, 0.15)):
        turns = 1 if material.is_isotropic else 2
        fit = fit_ggx(tabulated(material, incoming_directions(4, turns), ROWS))
        assert (fit.material.alpha_x, fit.material.alpha_y) == pytest.approx(
            (material.alpha_x, material.alpha_y), rel=0.05
        )
        assert fit.total_variation < 0.02
        assert fit.material.color == pytest.approx((1, 1, 1), abs=0.01)


def test_highlights_move_instead_of_doubling():
    """Two separate narrow lobes: linear interpolation keeps both, transport gives one between them."""
    table = tabulated(Ggx(0.1, 0.1), incoming_directions(9, 1), ROWS)
    # The same lobes four incoming angles further; the lobes between them are two angles further.
    near, far = (
        LobeTable(table.theta_in[:3], table.phi_in[:3], table.lobes[own], table.albedo[own])
        for own in (slice(0, 3), slice(4, 7))
    )
    found = finished(LobeBlend([near, far], QUICK), [1, 1]).table
    linear = linear_lobes([near, far], [1, 1])
    for index in range(3):
        middle = table.lobes[index + 2]
        off = [0.5 * (np.abs(own.lobes[index] - middle) * table.cells).sum() for own in (found, linear)]
        assert off[0] < 0.25 < 0.5 < off[1]


def test_weight_one_returns_the_material():
    blend = LobeBlend.of([BlinnPhong(50), Ggx(0.5, 0.5)], QUICK)
    found = finished(blend, [1, 0])
    off = 0.5 * (np.abs(found.table.lobes - blend.tables[0].lobes) * found.table.cells).sum(axis=(1, 2))
    assert off.max() < 0.05
    assert np.array_equal(found.table.albedo, blend.tables[0].albedo)


def test_the_start_changes_only_the_number_of_iterations(midpoint):
    blend, found = midpoint
    cold = finished(blend, [0.4, 0.6])
    warm = finished(blend, [0.4, 0.6], found)
    assert np.sum([sum(own) for own in warm.record["iterations"]]) < np.sum([sum(o) for o in cold.record["iterations"]])
    off = 0.5 * (np.abs(warm.table.lobes - cold.table.lobes) * cold.table.cells).sum(axis=(1, 2))
    assert off.max() < 0.02


def test_bound_is_reached_after_convergence():
    materials = [Ggx(0.4, 0.1), Ggx(0.1, 0.4)]
    bound = LobeBlend.of(materials, ReflectanceSettings(rows=ROWS, incoming=2, turns=2, entropy_limit="mean"))
    found = finished(bound, [1, 1])
    domain = bound.domain
    for index, lobe in enumerate(found.table.lobes):
        own = [entropy(table.lobes[index] * domain.area, domain.weights) for table in bound.tables]
        assert entropy(lobe * domain.area, domain.weights) == pytest.approx(np.mean(own), abs=0.01)
    assert min(found.record["exponents"]) > 1.05


def test_four_materials():
    found = finished(LobeBlend.of(list(MATERIALS.values()), QUICK), [1, 2, 3, 4])
    assert found.record["converged"] and not found.table.is_isotropic
    assert (found.table.lobes * found.table.cells).sum(axis=(1, 2)) == pytest.approx(1.0, abs=1e-9)


def test_the_half_angle_table_reproduces_the_material():
    material = Ggx(0.25, 0.25)
    image = half_angle_table(tabulated(material, incoming_directions(18, 1), 64))
    assert image.shape == (64, 256, 3) and image.dtype == np.float32
    theta_h = ((np.arange(256) + 0.5) / 256) ** 2 * np.pi / 2
    theta_d = (10 + 0.5) / 64 * np.pi / 2
    # Light perpendicular to the half vector: both directions are symmetric.
    light = np.stack(
        [np.sin(theta_h) * np.cos(theta_d), np.full(256, np.sin(theta_d)), np.cos(theta_h) * np.cos(theta_d)], -1
    )
    exact = np.array([material.reflectance(v, v * [1, -1, 1])[0] for v in light])
    assert np.abs(image[10, :200, 0] - exact[:200]).max() < 0.02 * exact.max()


def test_lookup_between_incoming_angles_keeps_narrow_highlights():
    material = Ggx(0.15, 0.15)
    table = tabulated(material, incoming_directions(18, 1), 64)
    theta = np.full(200, np.radians(42.0))
    light = incoming_vectors(theta, np.zeros(200))
    view = incoming_vectors(np.linspace(0.2, 1.2, 200), np.full(200, np.pi))
    found = reflectance_at(table, light.copy(), view)[:, 0]
    exact = material.reflectance(light[0], view)[:, 0]
    assert np.abs(found - exact).max() < 0.08 * exact.max()


def test_principled_values():
    material = Ggx.principled(0.5, 1.0)
    assert (material.roughness, material.anisotropic) == pytest.approx((0.5, 1.0))
    assert material.alpha_x * material.alpha_y == pytest.approx(0.5**4)
    assert Ggx(0.1, 0.4).rotation == 0.25 and material.rotation == 0.0


def test_the_roughest_most_anisotropic_material_is_tabulated():
    """Its table reflects no more light than arrives."""
    table = tabulated(Ggx.principled(1.0, 1.0), incoming_directions(4, 2), ROWS)
    assert np.isfinite(table.albedo).all()
    assert (table.albedo > 0.1).all() and (table.albedo <= 1.0).all()


@pytest.mark.parametrize("weights", [[1], [1, -1], [0, 0], [np.nan, 1]])
def test_bad_weights_are_refused(weights):
    with pytest.raises(InputError, match=r"weight|Weights"):
        blend_weights(weights, 2)


def test_the_limit_of_alpha_is_the_one_in_its_message():
    Ggx(4.0, 4.0)
    with pytest.raises(InputError, match="4 at most"):
        Ggx(4.01, 0.1)
    with pytest.raises(InputError, match="between 0 and 1"):
        Ggx.principled(1.01)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Ggx(0, 0.1),
        lambda: Ggx(0.1, np.nan),
        lambda: Ggx(0.1, 0.1, (2, 0, 0)),
        lambda: Ggx.principled(2),
        lambda: Ggx.principled(0.5, -1),
        lambda: BlinnPhong(0),
        lambda: AshikhminShirley(10, np.inf),
        lambda: LobeBlend.of([Ggx(0.1, 0.1)], QUICK),
        lambda: LobeBlend.of([Ggx(0.1, 0.1)] * 5, QUICK),
        lambda: ReflectanceSettings(rows=4),
        lambda: ReflectanceSettings(incoming=1),
        lambda: ReflectanceSettings(turns=0),
        lambda: ReflectanceSettings(sigma=np.nan),
        lambda: ReflectanceSettings(sharpness=2),
        lambda: ReflectanceSettings(entropy_limit="max"),
        lambda: ReflectanceSettings(tolerance=1),
        lambda: ReflectanceSettings(max_iterations=0),
    ],
)
def test_bad_materials_and_settings_are_refused(make):
    with pytest.raises(InputError):
        make()


def test_invalid_lookups_are_refused():
    grain = tabulated(Ggx(0.4, 0.1), incoming_directions(2, 2), 8)
    with pytest.raises(InputError, match="anisotropic"):
        half_angle_table(grain)
    with pytest.raises(InputError, match="different directions"):
        LobeBlend([grain, tabulated(Ggx(0.4, 0.1), incoming_directions(3, 2), 8)], QUICK)


def test_a_path_goes_through_all_materials():
    np.testing.assert_allclose(path_weights(3, 2), [[1, 0], [0.5, 0.5], [0, 1]])
    np.testing.assert_allclose(path_weights(5, 3)[[1, 2]], [[0.5, 0.5, 0], [0, 1, 0]])
    np.testing.assert_allclose(path_weights(7, 4).sum(axis=1), 1.0)
