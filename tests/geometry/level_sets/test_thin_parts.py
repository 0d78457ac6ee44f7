# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.ndimage import gaussian_filter
from scipy.special import ndtr

from convwass_addon.errors import InputError
from convwass_addon.geometry.level_sets.isosurface import surface_enclosing
from convwass_addon.geometry.level_sets.thin_parts import locally_normalized, lost_parts, normalized_solid
from convwass_addon.geometry.solids.occupancy import occupancy

SHAPE = (72, 40, 40)
ROD_RADIUS = 1.5
BALL_RADIUS = 9.0
BALL_CENTER = np.array([14.3, 20.1, 19.6])
# The rod runs along x, separate from the ball.
ROD_AXIS, ROD_LOW, ROD_HIGH = (20.4, 19.8), 36.0, 62.0
BLUR = 1.2


def cells(shape=SHAPE):
    """Centers of the cells, (*shape, 3)."""
    return np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in shape], indexing="ij"), axis=-1)


def ball(radius=BALL_RADIUS, center=BALL_CENTER, shape=SHAPE):
    """Occupancy of a ball, from the distances of the cells' centers; accurate to 0.01."""
    return np.clip(radius + 0.5 - np.linalg.norm(cells(shape) - center, axis=-1), 0.0, 1.0)


def rod(radius=ROD_RADIUS, low=ROD_LOW, high=ROD_HIGH):
    """Occupancy of a rod along x, by subsampling its cross-section."""
    fine = (np.arange(4 * SHAPE[1]) + 0.5) / 4
    y, z = np.meshgrid(fine - ROD_AXIS[0], fine - ROD_AXIS[1], indexing="ij")
    section = (np.hypot(y, z) <= radius).reshape(SHAPE[1], 4, SHAPE[2], 4).mean(axis=(1, 3))
    x = np.arange(SHAPE[0])
    return np.clip(np.minimum(high - x, x + 1 - low), 0.0, 1.0)[:, None, None] * section


def volume_along_rod(density, volume):
    """Enclosed volume per cell of the rod's length, away from its ends."""
    shown = occupancy(surface_enclosing(density, volume).mesh.corners, SHAPE)
    return float(shown[42:56].sum() / 14)


@pytest.mark.parametrize(("blur", "most"), [(0.7, 0.82), (1.0, 0.65), (1.3, 0.3), (1.6, 0.0)])
def test_a_blurred_rod_is_kept_where_a_plain_level_loses_it(blur, most):
    """At the widest blur it peaks at 1 - exp(-r^2 / 2 s^2) = 0.36, which a plain level does not show at all."""
    solid = ball() + rod()
    volume = float(solid.sum())
    blurred = gaussian_filter(solid, blur)
    peak = 1.0 - np.exp(-((ROD_RADIUS / blur) ** 2) / 2)
    assert blurred[49, 20, 19] == pytest.approx(peak, rel=0.1)
    exact = np.pi * ROD_RADIUS**2
    assert volume_along_rod(blurred, volume) <= most * exact
    assert 0.95 * exact < volume_along_rod(locally_normalized(blurred, volume), volume) < 1.15 * exact


@pytest.mark.parametrize("radius", [6.0, 10.0, 15.0])
@pytest.mark.parametrize("blur", [0.7, 1.0, 1.3])
def test_level_sets_of_a_ball_are_unchanged(radius, blur):
    center = np.array([20.2, 19.7, 20.5])
    solid = ball(radius, center, (40, 40, 40))
    volume = float(solid.sum())
    blurred = gaussian_filter(solid, blur)
    for share in (0.9, 1.0, 1.1):
        meshes = [
            surface_enclosing(density, share * volume).mesh
            for density in (blurred, locally_normalized(blurred, volume))
        ]
        plain, normalized = (np.linalg.norm(mesh.vertices - center, axis=1) for mesh in meshes)
        assert normalized.mean() == pytest.approx(plain.mean(), abs=0.02)
        assert normalized.std() < plain.std() + 0.03


def test_a_flat_face_is_unchanged():
    density = np.broadcast_to(ndtr(20.2 - np.arange(40) - 0.5)[:, None, None], (40, 30, 30))
    result = locally_normalized(density, float(density.sum()))
    middle = (slice(None), 15, 15)
    np.testing.assert_allclose(result[6:19, 6:-6, 6:-6], density[6:19, 6:-6, 6:-6], atol=1e-6)
    assert np.interp(-0.5, -result[middle], np.arange(40) + 0.5) == pytest.approx(20.2, abs=0.15)


@pytest.mark.parametrize("normal", [(1, 0, 0), (2, 1, 0), (3, 2, 1)])
@pytest.mark.parametrize("offset", [0.2, 0.3, 0.5])
def test_a_blurred_solid_is_unchanged_at_all_distances_from_a_plane_face(normal, offset):
    cells = np.stack(np.meshgrid(*[np.arange(30) - 14.5] * 3, indexing="ij"), axis=-1)
    depth = offset - cells @ (np.array(normal) / np.linalg.norm(normal))
    solid = np.clip(depth + 0.5, 0.0, 1.0)
    blurred = gaussian_filter(solid, 0.7)
    inner = (slice(8, -8),) * 3
    np.testing.assert_allclose(normalized_solid(blurred, 0.7)[inner], blurred[inner], atol=0.01)
    # Unlike the normalization of densities whose blur is not known.
    assert np.abs(locally_normalized(blurred, float(solid.sum()))[inner] - blurred[inner]).max() > 0.01


@pytest.mark.parametrize("radius", [1.0, 1.5, 2.0, 3.0])
def test_rods_of_a_blurred_solid_keep_their_thickness(radius):
    across = np.hypot(*np.meshgrid(np.arange(24) - 12.2, np.arange(24) - 11.7, indexing="ij"))
    solid = np.repeat(np.clip(radius - across + 0.5, 0.0, 1.0)[..., None], 24, axis=2)
    middle = normalized_solid(gaussian_filter(solid, 0.7), 0.7)[..., 12]
    rim = np.abs(across - radius) < 0.25
    # A tenth of the density is a fifth of a cell.
    assert middle[rim].mean() == pytest.approx(0.5, abs=0.1)


def test_a_constant_stays_constant():
    density = np.full((20, 22, 24), 3.0)
    np.testing.assert_allclose(locally_normalized(density, density.size)[5:-5, 5:-5, 5:-5], 1.0, rtol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-250, 250))
def test_only_the_ratios_of_the_densities_matter(seed, exponent):
    density = gaussian_filter(np.random.default_rng(seed).random((12, 14, 16)) ** 4, 1.0)
    expected = locally_normalized(density, 200.0)
    np.testing.assert_allclose(locally_normalized(density * 10.0**exponent, 200.0), expected, rtol=1e-5)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_values_are_never_lowered_and_raised_only_up_to_the_bound(seed):
    density = gaussian_filter(np.random.default_rng(seed).random((12, 14, 16)) ** 6, 1.0)
    volume = 300.0
    solid = density * (volume / density.sum())
    ratio = locally_normalized(density, volume) / solid
    assert ratio.min() >= 1.0 - 1e-6
    assert ratio.max() <= (0.75 / 0.2) ** 0.7 * (1.0 + 1e-6)
    # Very low densities are raised, but not enough to be visible at a level.
    assert (locally_normalized(density, volume)[solid < 0.1] < 0.26).all()


def test_scattered_density_does_not_become_crumbs():
    noise = np.random.default_rng(5).random(SHAPE)
    dust = gaussian_filter(noise, 0.8)
    dust *= 0.1 / dust.max()
    solid = ball()
    volume = float(solid.sum())
    density = gaussian_filter(solid, BLUR) + dust
    surface = surface_enclosing(locally_normalized(density, volume + dust.sum()), volume)
    assert np.linalg.norm(surface.mesh.vertices - BALL_CENTER, axis=1).max() < BALL_RADIUS + 1.0


def removed_rod():
    """A blurred ball and rod, and the cells of a ball with the volume of both."""
    density = gaussian_filter(ball() + rod(), BLUR)
    larger = (BALL_RADIUS**3 + rod().sum() / (4 / 3 * np.pi)) ** (1 / 3)
    return density, ball(larger) > 0.5


def test_a_removed_rod_is_found_with_its_mass_and_size():
    density, shown = removed_rod()
    found = lost_parts(density, shown, 3 * BLUR)
    assert found.count == len(found.parts) == 1
    (part,) = found.parts
    expected = rod().sum() / density.sum()
    assert part.share == pytest.approx(expected, rel=0.01)
    assert found.share == pytest.approx(part.share)
    assert part.cells == pytest.approx(rod().sum(), rel=0.03)
    np.testing.assert_allclose(part.center, (49.0, *ROD_AXIS), atol=0.1)
    # The blur adds its variance along the axis.
    assert part.length == pytest.approx(np.sqrt(26.0**2 + 12 * BLUR**2), rel=0.02)
    assert part.thickness == pytest.approx(2 * ROD_RADIUS, rel=0.05)
    assert part.low[0] <= ROD_LOW and part.high[0] >= ROD_HIGH
    assert part.low[0] > BALL_CENTER[0] + BALL_RADIUS
    assert found.scattered < 1e-3


def test_only_the_detached_part_of_a_touching_rod_is_counted():
    density = gaussian_filter(np.maximum(ball(), rod(low=14.0)), BLUR)
    shown = gaussian_filter(ball(), BLUR) > 0.5
    found = lost_parts(density, shown, 3 * BLUR)
    missing = (ROD_HIGH - BALL_CENTER[0] - BALL_RADIUS) * np.pi * ROD_RADIUS**2 / density.sum()
    assert 0.85 * missing < found.share < missing


def test_parts_are_listed_by_their_size_and_counted():
    density = gaussian_filter(ball() + rod(high=50.0) + rod(low=58.0, high=64.0), BLUR)
    found = lost_parts(density, gaussian_filter(ball(), BLUR) > 0.5, 3 * BLUR)
    assert found.count == 2
    assert [round(part.length) for part in found.parts] == [15, 7]
    assert found.share == pytest.approx(sum(part.share for part in found.parts))


@pytest.mark.parametrize("blur", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("radius", [5.0, 9.0])
def test_a_blurred_ball_loses_nothing(blur, radius):
    density = gaussian_filter(ball(radius), blur)
    shown = density > surface_enclosing(density, float(density.sum())).level
    found = lost_parts(density, shown, 3 * blur)
    assert found.count == 0
    assert found.share == 0.0
    assert found.scattered < 1e-3


def test_the_loss_does_not_depend_on_the_unit_of_the_density():
    density, shown = removed_rod()
    one, other = lost_parts(density, shown, 4.0), lost_parts(density * 1e-200, shown, 4.0)
    assert other.share == pytest.approx(one.share, rel=1e-5)
    assert other.parts[0].center == pytest.approx(one.parts[0].center, rel=1e-5)


def test_parts_move_with_the_grid_that_they_are_cut_from():
    density, shown = removed_rod()
    whole = lost_parts(density, shown, 4.0)
    cut = lost_parts(density[2:, 3:, 1:], shown[2:, 3:, 1:], 4.0).moved((2, 3, 1))
    assert cut.parts[0].center == pytest.approx(whole.parts[0].center, abs=1e-3)
    assert (cut.parts[0].low, cut.parts[0].high) == (whole.parts[0].low, whole.parts[0].high)


def test_the_record_is_json():
    density, shown = removed_rod()
    found = lost_parts(density, shown, 4.0)
    read = json.loads(json.dumps(found.record()))
    assert read["share"] == found.share
    assert read["parts"][0]["center"] == list(found.parts[0].center)


def test_invalid_input_is_refused():
    density, shown = removed_rod()
    with pytest.raises(InputError, match="must be some of the cells"):
        lost_parts(density, np.zeros_like(shown), 3.0)
    with pytest.raises(InputError, match="must be some of the cells"):
        lost_parts(density, shown[1:], 3.0)
    with pytest.raises(InputError, match="without mass"):
        lost_parts(np.zeros(SHAPE), shown, 3.0)
    with pytest.raises(InputError, match="without mass"):
        locally_normalized(np.zeros(SHAPE), 10.0)
    with pytest.raises(InputError, match="without mass"):
        locally_normalized(density, 0.0)
