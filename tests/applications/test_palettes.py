# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between palettes, compared with known solutions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import sqrtm
from skimage.color import lab2rgb, rgb2lab

from convwass_addon.applications.palettes.lab_colors import (
    lab_of_linear,
    linear_of_lab,
    linear_of_srgb,
    srgb_of_linear,
)
from convwass_addon.applications.palettes.lightness_curve import lightness_curve
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.applications.palettes.palette_statistics import (
    QUANTILES,
    measured_palette,
    pooled_palette,
    sample_places,
)
from convwass_addon.applications.palettes.recoloring import palette_barycenter, recoloring
from convwass_addon.errors import Cancelled, InputError
from tests.controls import cancelled_control

from .palettes import cloud, palette_of

MIDDLE = (55.0, 10.0, -5.0)


def moved(source, targets, own=None, weights=None):
    """Return the colors of the source and their change by the map, (3, n) each."""
    found = recoloring(palette_of(source), [palette_of(target) for target in targets], weights, own)
    return found.shifts(source)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_lab_agrees_with_scikit_image(kind):
    rgb = np.random.default_rng(0).random((500, 3))
    found = lab_of_linear(linear_of_srgb(rgb.T.astype(kind)))
    np.testing.assert_allclose(found.T, rgb2lab(rgb), atol=0.01)
    np.testing.assert_allclose(srgb_of_linear(linear_of_lab(found)).T, rgb, atol=2e-5)
    assert found.dtype == kind
    inside = rgb2lab(rgb)
    np.testing.assert_allclose(srgb_of_linear(linear_of_lab(inside.T)).T, lab2rgb(inside), atol=1e-3)


@given(st.floats(-3.0, 1000.0), st.floats(-3.0, 1000.0), st.floats(-3.0, 1000.0))
def test_lab_conversion_is_invertible_for_any_scene_color(red, green, blue):
    linear = np.array([[red], [green], [blue]])
    np.testing.assert_allclose(linear_of_lab(lab_of_linear(linear)), linear, atol=1e-9 * (1 + np.abs(linear).max()))


def test_the_source_palette_changes_nothing():
    source = cloud(1, MIDDLE, np.diag([12.0, 9.0, 6.0]))
    assert np.abs(moved(source, [source])).max() == 0.0


@pytest.mark.parametrize("by", [(0.0, 20.0, 0.0), (7.0, -24.0, 16.0), (-20.0, 3.3, -1.7)])
def test_a_translated_palette_gives_that_translation(by):
    source = cloud(2, MIDDLE, np.diag([8.0, 9.0, 6.0]))
    target = source + np.array(by)[:, None]
    found = moved(source, [target])
    inner = (np.abs(source - source.mean(axis=1, keepdims=True)) < 2 * source.std(axis=1, keepdims=True)).all(axis=0)
    np.testing.assert_allclose(found[:, inner].mean(axis=1), by, atol=0.05)
    assert np.abs(found[:, inner] - np.array(by)[:, None]).max() < 0.5


def test_gaussians_follow_the_linear_monge_map():
    """Compared with T(x) = m1 + A (x - m0), A = S0^-1/2 (S0^1/2 S1 S0^1/2)^1/2 S0^-1/2, Olkin and Pukelsheim 1982."""
    turned = np.array([[10.0, 4.0], [4.0, 7.0]])
    source = cloud(3, MIDDLE, np.diag([10.0, 12.0, 8.0]))
    target = cloud(4, (60.0, -20.0, 15.0), np.block([[5.0, np.zeros((1, 2))], [np.zeros((2, 1)), turned]]))
    found = moved(source, [target], RecolorSettings(smoothing=0.5))
    ab = source[1:]
    first, second = np.cov(ab), turned @ turned
    root = np.real(sqrtm(first))
    linear = np.linalg.solve(root, np.real(sqrtm(root @ second @ root))) @ np.linalg.inv(root)
    wanted = target[1:].mean(axis=1)[:, None] + linear @ (ab - ab.mean(axis=1, keepdims=True))
    error = np.abs(ab + found[1:] - wanted)
    assert np.mean(error) < 0.6 and np.mean(error) < 0.02 * np.abs(found[1:]).mean() + 0.3
    lightness = 60.0 + 0.5 * (source[0] - 55.0) - source[0]
    assert np.abs(found[0] - lightness).mean() < 0.1


@pytest.mark.parametrize("strength", [0.0, 0.25, 1.0])
def test_two_single_colors(strength):
    first, second = np.array([[40.0], [30.0], [-20.0]]), np.array([[70.3], [-11.7], [33.1]])
    own = RecolorSettings(strength=strength)
    found = moved(np.repeat(first, 50, axis=1), [np.repeat(second, 9, axis=1)], own)
    np.testing.assert_allclose(found, np.repeat(strength * (second - first), 50, axis=1), atol=0.02)


def test_the_recolored_palette_is_the_target():
    rng = np.random.default_rng(5)
    source = np.concatenate([cloud(6, (40, 20, 20), np.eye(3) * 5), cloud(7, (70, -20, 5), np.eye(3) * 4)], axis=1)
    target = cloud(8, (50, -10, -30), np.diag([15.0, 14.0, 5.0]))
    arrived = palette_of(source + moved(source, [target], RecolorSettings(smoothing=0.0)))
    wanted, before = palette_of(target), palette_of(source)
    distances = [_sliced(palette.chroma, wanted.chroma, rng) for palette in (before, arrived)]
    assert distances[1] < 0.06 * distances[0]
    np.testing.assert_allclose(arrived.lightness, wanted.lightness, atol=1.0)


def _sliced(first, second, rng):
    """Return the sliced Wasserstein distance between two histograms, in bins."""
    places = np.indices(first.shape).reshape(2, -1)
    found = []
    for angle in rng.uniform(0, np.pi, 16):
        line = np.cos(angle) * places[0] + np.sin(angle) * places[1]
        order = np.argsort(line)
        apart = np.cumsum(first.ravel()[order] - second.ravel()[order])[:-1]
        found.append((np.abs(apart) * np.diff(line[order])).sum())
    return float(np.mean(found))


def test_the_barycenter_of_translates_is_a_translate():
    clouds = [cloud(9, (50.0, x, y), np.diag([10.0, 7.0, 7.0])) for x, y in ((-40, 0), (40, 0), (0, 48))]
    weights = np.array([0.2, 0.3, 0.5])
    found = palette_barycenter([palette_of(own) for own in clouds], weights)
    places = (np.indices(found.chroma.shape) + 0.5) * 2.0 - 128.0
    mean = (found.chroma * places).sum(axis=(1, 2))
    np.testing.assert_allclose(mean, [0.1 * 40, 0.5 * 48], atol=0.1)
    variance = (found.chroma * (places - mean[:, None, None]) ** 2).sum(axis=(1, 2))
    np.testing.assert_allclose(np.sqrt(variance), 7.0, atol=0.4)


def test_palettes_with_weight_zero_have_no_effect():
    source, first, second = (cloud(n, (50, 10 * n, 0), np.eye(3) * 5) for n in range(3))
    np.testing.assert_array_equal(moved(source, [first, second], weights=[0, 2]), moved(source, [second]))


@given(st.lists(st.floats(0, 100), min_size=2, max_size=30), st.floats(-20, 20), st.floats(0, 3))
@settings(max_examples=50)
def test_the_lightness_map_is_monotone(values, shift, stretch):
    source = np.sort(np.repeat(values, 20))
    curve = lightness_curve(source, source * stretch + shift, smoothing=1.0)
    levels = np.linspace(-10, 120, 400)
    assert (np.diff(levels + curve(levels)) > -1e-3).all()


def test_equal_lightness_has_equal_images():
    curve = lightness_curve([0, 0, 0, 50], [10, 20, 30, 80])
    np.testing.assert_allclose(curve(np.array([0.0, 50.0, -5.0])), [20.0, 30.0, 20.0], atol=1e-4)


def test_the_slope_limit_holds_and_keeps_the_mean():
    source = np.sort(np.random.default_rng(0).normal(50, 1, QUANTILES))
    target = np.linspace(0, 100, QUANTILES)
    free, limited = (lightness_curve(source, target, 1.0, steepest) for steepest in (0.0, 3.0))
    levels = np.linspace(40, 60, 1000)
    assert np.diff(levels + free(levels)).max() > 10 * np.diff(levels)[0]
    assert np.diff(levels + limited(levels)).max() < 3.01 * np.diff(levels)[0]
    assert abs(limited(source).mean() - free(source).mean()) < 1e-3


def test_keeping_the_lightness():
    source, target = cloud(1, MIDDLE, np.eye(3) * 6), cloud(2, (20, -10, 10), np.eye(3) * 3)
    assert np.abs(moved(source, [target], RecolorSettings(lightness="keep"))[0]).max() == 0.0


@pytest.mark.parametrize("gamut", ["clip", "chroma"])
def test_results_are_displayable(gamut):
    source, target = cloud(1, MIDDLE, np.eye(3) * 6), cloud(2, (90, 60, -60), np.eye(3) * 20)
    found = recoloring(palette_of(source), [palette_of(target)], None, RecolorSettings(gamut=gamut))
    linear = linear_of_lab(source)
    changed = found(linear)
    assert changed.min() >= -1e-9 and changed.max() <= 1.0
    if gamut == "chroma":
        wanted = np.clip(source[0] + found.shifts(source)[0], 0, 100)
        assert np.abs(lab_of_linear(changed)[0] - wanted).max() < 0.1


def test_pooled_palettes_are_those_of_all_pixels_together():
    parts = [cloud(1, (40, 5, 5), np.eye(3) * 4, 3000), cloud(2, (70, -15, 5), np.eye(3) * 8, 9000)]
    pooled = pooled_palette([measured_palette(part) for part in parts])
    whole = measured_palette(np.concatenate(parts, axis=1))
    np.testing.assert_allclose(pooled.chroma, whole.chroma, atol=1e-12)
    assert np.abs(pooled.lightness - whole.lightness).mean() < 0.02
    assert pooled.mass == whole.mass


def test_nonfinite_and_weightless_pixels_are_ignored():
    lab = cloud(1, MIDDLE, np.eye(3) * 4, 1000)
    spoiled = np.concatenate([lab, np.full((3, 5), np.nan), np.full((3, 5), 80.0)], axis=1)
    weights = np.r_[np.ones(1005), np.zeros(5)]
    whole, part = measured_palette(lab), measured_palette(spoiled, weights)
    np.testing.assert_allclose(part.chroma, whole.chroma, atol=1e-15)
    with pytest.raises(InputError, match="No pixel counts"):
        measured_palette(lab, np.zeros(1000))


def test_samples_are_spread_evenly():
    places = sample_places(3840 * 2160)
    assert len(places) < 300_000 and (np.diff(places) > 0).all() and places[-1] < 3840 * 2160
    columns = np.bincount(places % 3840, minlength=3840)
    assert columns.min() > 0.4 * columns.mean() and columns.max() < 1.7 * columns.mean()


def test_a_solve_can_be_cancelled():
    own = palette_of(cloud(1, MIDDLE, np.eye(3) * 4))
    with pytest.raises(Cancelled):
        recoloring(own, [palette_of(cloud(2, MIDDLE, np.eye(3) * 9))], control=cancelled_control())


@pytest.mark.parametrize(
    "wrong",
    [
        {"strength": 1.5},
        {"strength": float("nan")},
        {"smoothing": -1.0},
        {"steepest": 0.5},
        {"edge_radius": 500},
    ],
)
def test_settings_are_checked(wrong):
    with pytest.raises(InputError):
        replace(RecolorSettings(), **wrong)


@pytest.mark.parametrize(("count", "weights"), [(0, None), (2, [1.0]), (2, [0.0, 0.0]), (2, [-1.0, 2.0])])
def test_weights_are_checked(count, weights):
    own = palette_of(cloud(1, MIDDLE, np.eye(3) * 4))
    with pytest.raises(InputError):
        palette_barycenter([own] * count, weights)
