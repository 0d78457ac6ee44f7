# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cavities of sections of solids of revolution: what is filled, and volumes known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.planar_fill import Boundary, filled_boundary
from convwass_addon.geometry.recognition.section_cavities import SectionCavity, revolved_volume

# Radius 2 and height 3, with a cavity of radius 1 and depth 2.
CUP = np.array([(-2.0, 0.0), (2.0, 0.0), (2.0, 3.0), (1.0, 3.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, 3.0), (-2.0, 3.0)])
CONE = np.array([(-1.0, 0.0), (1.0, 0.0), (0.0, 2.0)])


def section(*rings):
    return filled_boundary(list(rings), "non-zero")


@pytest.mark.parametrize(("ring", "volume"), [(CONE, 2.0 / 3.0 * np.pi), (CUP, 10.0 * np.pi)])
def test_volumes_of_solids_of_revolution(ring, volume):
    assert revolved_volume(section(ring)) == pytest.approx(volume)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_cup_is_filled_to_the_rim(side):
    """Whichever way it is open."""
    ring = CUP * (1.0, side)
    found = SectionCavity.of(section(ring if side > 0.0 else ring[::-1]))
    assert (found.side, found.rim.tolist()) == (side, [1.0, pytest.approx(3.0 * side)])
    assert revolved_volume(found.filled) == pytest.approx(12.0 * np.pi)
    np.testing.assert_allclose(found.filled.bounds, section(ring).bounds, atol=1e-6)
    wanted = [(1.0, 3.0), (1.0, 1.0), (0.0, 1.0)]
    np.testing.assert_allclose(found.profile, np.array(wanted) * (1.0, side), atol=1e-6)


def test_of_two_cavities_the_larger_one_is_taken():
    """A cup whose foot is hollow, too."""
    foot = np.array([(-2.0, 0.0), (-1.5, 0.0), (-1.5, 0.5), (1.5, 0.5), (1.5, 0.0), (2.0, 0.0)])
    found = SectionCavity.of(section(np.concatenate([foot, CUP[2:]])))
    assert (found.side, found.rim[0]) == (1.0, 1.0)
    # The foot is not filled.
    assert revolved_volume(found.filled) == pytest.approx(12.0 * np.pi - 0.5 * 1.5**2 * np.pi)


def test_solids_dents_and_several_regions_have_none():
    dented = np.array([(-2.0, 0.0), (2.0, 0.0), (2.0, 3.0), (1.0, 3.0), (0.0, 2.5), (-1.0, 3.0), (-2.0, 3.0)])
    flat = np.array([(-2.0, 0.0), (2.0, 0.0), (2.0, 3.0), (0.5, 3.0), (-0.5, 3.0), (-2.0, 3.0)])
    for ring in (CONE, dented, flat):
        assert SectionCavity.of(section(ring)) is None
    assert SectionCavity.of(section(CUP, CUP + np.array([0.0, 9.0]))) is None


def test_the_boundary_is_that_of_the_section():
    found = SectionCavity.of(section(CUP))
    whole = Boundary.joined([found.outside, found.surface])
    assert revolved_volume(whole) == pytest.approx(10.0 * np.pi)
    assert len(whole.starts) == len(CUP)
