# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolated skies: position of the sun, amount of light, and errors."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.skies.lamps import SUN_RADIUS, Lamp, matched
from convwass_addon.applications.skies.sky_frames import Skies
from convwass_addon.applications.skies.sky_images import LUMINANCE, add_disc, great_circle, light_of
from convwass_addon.applications.skies.sky_settings import SkySettings
from convwass_addon.errors import InputError
from convwass_addon.transport.sphere import directions, solid_angles

ROWS = 256
QUICK = SkySettings(rows=32)


def toward(elevation, azimuth):
    up, turn = np.radians(elevation), np.radians(azimuth)
    return np.array([np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), np.sin(up)])


LOW, HIGH = toward(12, 70), toward(50, 165)


def clear_sky(sun, haze, flux, rows=ROWS):
    vectors = directions(rows, 2 * rows)
    above = vectors[..., 2:] > 0
    air = np.array([0.2, 0.35, 0.8]) * (0.3 + 0.7 * np.exp(-3 * np.maximum(vectors[..., 2:], 0)))
    image = np.where(above, air, [0.08, 0.07, 0.05])
    if sun is not None:
        angle = np.arccos(np.clip(vectors @ sun, -1, 1))[..., None]
        image = image + np.exp(-angle / np.radians(15)) * np.array(haze) * above
        add_disc(image, sun, np.array(flux), SUN_RADIUS)
    return image


@pytest.fixture(scope="module")
def skies():
    first = clear_sky(LOW, (3, 1.5, 0.5), (0.5, 0.3, 0.15))
    second = clear_sky(HIGH, (1.5, 1.4, 1.2), (2.0, 1.9, 1.7))
    return first, second, Skies(first, second, QUICK)


def test_sun_is_found(skies):
    _, _, found = skies
    for lamps, sun, flux in zip(found.lamps, (LOW, HIGH), ((0.5, 0.3, 0.15), (2.0, 1.9, 1.7)), strict=True):
        assert len(lamps) == 1
        assert np.degrees(np.arccos(lamps[0].direction @ sun)) < 0.25 * 180 / ROWS
        assert lamps[0].flux == pytest.approx(flux, rel=0.02)


@pytest.mark.parametrize("time", [0.1, 0.25, 0.5, 0.75])
def test_sun_travels_and_light_is_kept(skies, time):
    first, second, found = skies
    frame = found.frame(time)
    image = frame.image.astype(float)
    luminance = image @ LUMINANCE
    areas, vectors = solid_angles(ROWS, 2 * ROWS), directions(ROWS, 2 * ROWS)
    mass = areas * np.where(luminance > 0.1 * luminance.max(), luminance, 0.0)
    place = (mass[..., None] * vectors).sum(axis=(0, 1))
    place /= np.linalg.norm(place)
    aim = great_circle(LOW, HIGH, time)
    assert np.linalg.norm(place - aim) < 0.25 * np.pi / ROWS
    assert light_of(image) == pytest.approx((1 - time) * light_of(first) + time * light_of(second), rel=1e-4)
    flux = (1 - time) * found.lamps[0][0].flux + time * found.lamps[1][0].flux
    assert frame.lamps[0].flux == pytest.approx(flux, rel=1e-12)
    assert [found["converged"] for found in frame.record["transport"]] == [True]
    # There is one sun, not two.
    assert angle_to(place, vectors[luminance > 0.1 * luminance.max()]).max() < np.radians(4)


def angle_to(center, vectors):
    return np.arccos(np.clip(vectors @ center, -1, 1))


def test_the_ends_are_the_input_skies(skies):
    first, second, found = skies
    assert np.array_equal(found.frame(0).image, first.astype(np.float32))
    assert np.array_equal(found.frame(1).image, second.astype(np.float32))
    near = found.frame(1e-6).image.astype(float)
    away = angle_to(LOW, directions(ROWS, 2 * ROWS)) > np.radians(3)
    assert np.abs(near - first)[away].max() < 0.01 * first[away].max()


def test_ground_fades(skies):
    first, second, found = skies
    image = found.frame(0.5).image
    ground = slice(ROWS // 2 + 4, None)
    assert np.allclose(image[ground], 0.5 * (first + second)[ground], rtol=0.02)


def test_glow_travels_with_the_sun(skies):
    first, second, found = skies
    image = found.frame(0.5).image @ LUMINANCE
    vectors = directions(ROWS, 2 * ROWS)
    faded = 0.5 * (first + second) @ LUMINANCE
    ring = angle_to(great_circle(LOW, HIGH, 0.5), vectors)
    around = (ring > np.radians(4)) & (ring < np.radians(12))
    old = angle_to(LOW, vectors)
    there = (old > np.radians(4)) & (old < np.radians(12)) & (vectors[..., 2] > 0.05)
    assert image[around].mean() > 1.2 * faded[around].mean()
    assert image[there].mean() < 0.9 * faded[there].mean()


def test_overcast_sky_lets_the_sun_appear(skies):
    _, second, _ = skies
    found = Skies(clear_sky(None, None, None), second, QUICK)
    frame = found.frame(0.25)
    assert not found.lamps[0]
    assert frame.lamps[0].direction @ HIGH > np.cos(np.radians(0.5))
    assert frame.lamps[0].flux == pytest.approx(0.25 * found.lamps[1][0].flux)


def test_black_borders_are_ignored():
    dark = np.zeros((32, 64, 3))
    dark[10, 20] = 1.0
    frame = Skies(dark, np.roll(dark, 7, axis=1), QUICK).frame(0.5)
    assert np.isfinite(frame.image).all()
    assert light_of(frame.image.astype(float)) == pytest.approx(light_of(dark), rel=1e-4)


def lamp(elevation, azimuth, power):
    return Lamp(toward(elevation, azimuth), np.full(3, float(power)), SUN_RADIUS)


def test_lamps_are_matched_with_the_least_motion():
    moves = matched([lamp(20, 0, 1), lamp(20, 90, 1)], [lamp(30, 95, 1), lamp(30, 5, 1)])
    assert len(moves) == 2
    assert all(np.arccos(move.first.direction @ move.second.direction) < np.radians(12) for move in moves)


def test_lamps_split_their_light():
    moves = matched([lamp(60, 0, 3)], [lamp(20, 0, 1), lamp(20, 90, 2)])
    assert sum(move.first_share for move in moves) == pytest.approx(1)
    assert sorted(move.first_share for move in moves) == pytest.approx([1 / 3, 2 / 3])
    assert [move.second_share for move in moves] == pytest.approx([1, 1])


@pytest.mark.parametrize("center", [toward(90, 0), toward(89.9, 33), toward(0, 180), toward(-20, 359.9), toward(45, 0)])
def test_discs_keep_their_light(center):
    image = np.zeros((64, 128, 3))
    add_disc(image, center, np.array([1.0, 2.0, 3.0]), SUN_RADIUS)
    assert light_of(image) == pytest.approx([1, 2, 3], rel=1e-12)
    place = ((solid_angles(64, 128) * image[..., 0])[..., None] * directions(64, 128)).sum(axis=(0, 1))
    assert np.linalg.norm(place / np.linalg.norm(place) - center) < 1.0 * np.pi / 64


def test_opposite_suns_pass_overhead():
    assert great_circle(toward(0, 0), toward(0, 180), 0.5)[2] == pytest.approx(1.0)


BAD = {
    "flat": (np.ones((32, 64)), "three channels"),
    "square": (np.ones((32, 32, 3)), "three channels"),
    "odd": (np.ones((40, 80, 3)), "multiple of 32"),
    "nan": (np.full((32, 64, 3), np.nan), "no numbers"),
    "black": (np.zeros((32, 64, 3)), "no light"),
    "large": (np.ones((64, 128, 3)), "different sizes"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_skies_are_refused(name):
    image, message = BAD[name]
    with pytest.raises(InputError, match=message):
        Skies(np.ones((32, 64, 3)), image, QUICK)


@pytest.mark.parametrize(
    "options",
    [
        {"rows": 10},
        {"sigma": 0},
        {"sharpness": 2},
        {"near": 70},
        {"brightness": 1},
        {"least_share": 1},
        {"tolerance": 0},
    ],
)
def test_bad_settings_are_refused(options):
    with pytest.raises(InputError):
        SkySettings(**options)


def test_times_beyond_the_ends_are_refused(skies):
    with pytest.raises(InputError, match="between 0 and 1"):
        skies[2].frame(1.5)
