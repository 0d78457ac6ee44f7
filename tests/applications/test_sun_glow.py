# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moving suns with their glow: its local frames, what stays behind, and what keeps its shape."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from convwass_addon.applications.skies.glow_travel import GlowTravel
from convwass_addon.applications.skies.lamps import SUN_RADIUS, split_lamps
from convwass_addon.applications.skies.sky_frames import Skies
from convwass_addon.applications.skies.sky_images import LUMINANCE, add_disc, great_circle
from convwass_addon.applications.skies.sky_settings import SkySettings
from convwass_addon.applications.skies.sun_frames import SunWay, seen_in
from convwass_addon.applications.skies.sun_glow import split_glows
from convwass_addon.transport.sphere import directions, solid_angles
from tests.applications.test_skies import HIGH, LOW, QUICK, toward

ROWS = 128
PLACES = st.tuples(st.floats(-89, 89), st.floats(0, 360)).map(lambda place: toward(*place))


def hazy_sky(*suns, rows=ROWS):
    """Return a uniform sky with a decreasing glow around every sun; the ground reflects half of it."""
    vectors = directions(rows, 2 * rows)
    height = np.degrees(np.arcsin(vectors[..., 2]))
    image = np.where(height > 0, 0.3, 0.1)[..., None] * np.array([0.6, 0.8, 1.0])
    for sun in suns:
        flat = np.stack([vectors[..., 0], vectors[..., 1], np.maximum(vectors[..., 2], np.radians(0.5))], axis=-1)
        angle = np.degrees(np.arccos(np.clip(flat @ sun / np.linalg.norm(flat, axis=-1), -1, 1)))
        glow = 3.0 * np.exp(-angle / 10) * np.where(height > 0, 1.0, 0.5 * np.exp(height / 3))
        image += glow[..., None] * np.array([1.0, 0.8, 0.5])
    for sun in suns:
        add_disc(image, sun, np.array([0.5, 0.4, 0.3]), SUN_RADIUS)
    return image


@given(PLACES, PLACES, st.floats(0, 1))
def test_frames_point_at_the_sun(first, second, time):
    frame = SunWay.between(first, second).frame(time)
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-9)
    assert np.linalg.det(frame) == pytest.approx(1)
    np.testing.assert_allclose(frame[:, 0], great_circle(first, second, time), atol=1e-9)


def test_frames_are_upright_at_both_ends_and_turn_evenly():
    way = SunWay.between(LOW, HIGH)
    for time in (0.0, 1.0):
        _, across, up = way.frame(time).T
        assert abs(across[2]) < 1e-12 < up[2]
    frames = [way.frame(time) for time in np.linspace(0, 1, 11)]
    turns = [np.arccos((np.trace(a.T @ b) - 1) / 2) for a, b in pairwise(frames)]
    assert max(turns) < 1.001 * min(turns)


@pytest.mark.parametrize("second", [toward(12, 250), toward(12, 249), toward(20, 245)])
def test_frames_do_not_flip_near_the_zenith(second):
    way = SunWay.between(LOW, second)
    assert way.twist == 0
    frames = [way.frame(time) for time in np.linspace(0, 1, 101)]
    turns = [np.arccos(np.clip((np.trace(a.T @ b) - 1) / 2, -1, 1)) for a, b in pairwise(frames)]
    assert max(turns) < np.radians(2)


def test_pictures_are_sampled_at_the_right_directions():
    image = np.random.default_rng(1).random((16, 32, 3))
    np.testing.assert_allclose(seen_in(image, directions(16, 32)), image, atol=1e-10)
    np.testing.assert_allclose(seen_in(np.full((16, 32, 3), 0.7), directions(9, 18)), 0.7)


def test_nothing_stays_behind_at_the_horizon():
    """The band above and below it, at the place of the low sun, is hardly brighter halfway than far away."""
    first, second = hazy_sky(LOW), hazy_sky(HIGH)
    image = Skies(first, second, QUICK).frame(0.5).image @ LUMINANCE
    column = int(70 / 360 * 2 * ROWS)
    far = (column + ROWS) % (2 * ROWS)
    for row in (ROWS // 2 - 2, ROWS // 2 - 1, ROWS // 2):
        before = (first[row, column] - first[row, far]) @ LUMINANCE
        assert before > 0.2
        assert image[row, column] - image[row, far] < 0.15 * before


def test_the_lit_ground_moves_with_the_sun():
    image = Skies(hazy_sky(LOW), hazy_sky(toward(12, 130)), QUICK).frame(0.5).image @ LUMINANCE
    row = ROWS // 2
    columns = [int(azimuth / 360 * 2 * ROWS) for azimuth in (100, 70, 130, 280)]
    under, *others, away = image[row, columns]
    assert under - away > 2.5 * max(other - away for other in others)


def test_the_glow_is_not_stretched_sideways():
    first, second = hazy_sky(LOW), hazy_sky(HIGH)
    split = [split_lamps(sky, SkySettings()) for sky in (first, second)]
    lamps, rest = ([part for part, _ in split], [part for _, part in split])
    glows = [glow for (glow,) in split_glows(rest, lamps, SkySettings())]
    way = SunWay.between(*(own.direction for (own,) in lamps))
    travel = GlowTravel(glows, way, SkySettings())
    areas, vectors = solid_angles(ROWS, 2 * ROWS), directions(ROWS, 2 * ROWS)

    def width(time):
        mass = areas * (travel.at(time)[0] @ LUMINANCE)
        across = vectors @ way.frame(time)[:, 1]
        return np.sqrt((mass * across**2).sum() / mass.sum())

    assert width(0.5) < 1.1 * max(width(0), width(1))


def test_every_sun_has_its_own_glow():
    places = [LOW, toward(30, 250)]
    glows = []
    for sky in (hazy_sky(*places), hazy_sky(HIGH)):
        lamps, rest = split_lamps(sky, QUICK)
        glows.append((lamps, rest))
    split = split_glows([rest for _, rest in glows], [lamps for lamps, _ in glows], QUICK)
    assert [len(own) for own in split] == [2, 1]
    for lamp, glow in zip(glows[0][0], split[0], strict=True):
        luminance = glow.light @ LUMINANCE
        brightest = directions(ROWS, 2 * ROWS)[np.unravel_index(luminance.argmax(), luminance.shape)]
        assert brightest @ lamp.direction > np.cos(np.radians(4))
    together = sum(glow.light for glow in split[0])
    assert (together <= glows[0][1] + 1e-12).all()


def test_two_suns_move_with_their_glows():
    first = hazy_sky(toward(20, 40), toward(20, 220))
    second = hazy_sky(toward(40, 80), toward(40, 260))
    image = Skies(first, second, QUICK).frame(0.5).image @ LUMINANCE
    vectors = directions(ROWS, 2 * ROWS)

    def around(place):
        angle = np.degrees(np.arccos(np.clip(vectors @ place, -1, 1)))
        return image[(angle > 3) & (angle < 8)].mean()

    for turn in (0, 180):
        middle = great_circle(toward(20, 40 + turn), toward(40, 80 + turn), 0.5)
        assert around(middle) > 2 * around(toward(20, 40 + turn))
        assert around(middle) > 2 * around(toward(40, 80 + turn))
