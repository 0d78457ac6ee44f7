# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.densities.density_measures import (
    MEASURING_SUBSTEPS,
    distance_table_steps,
    measuring_steps,
)
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained
from tests.applications.test_density_pieces import BALLS, on
from tests.controls import CountingControl, recorded
from tests.transport.sheets import strip
from tests.transport.spheres import cap, icosphere, sphere

# Radius 3 in scene units; the blur corresponds to gamma 0.0145 on the unit sphere.
_UNIT = icosphere(3)
LARGE = density_surface(TriangleMesh(3.0 * _UNIT.vertices, _UNIT.faces), 0.9, MEASURING_SUBSTEPS)
PLAIN = sphere(3, 0.0145)


def caps(*places):
    return [cap(PLAIN, angle) for angle in places]


@pytest.mark.parametrize("apart", [0.5, 1.0, 1.5])
def test_the_distance_of_caps_is_that_of_their_centers(apart):
    """In scene units, for any scale of the weights. A rotation is not optimal: the distance is 0 to 5 % shorter."""
    first, second = caps(0.0, apart)
    found = drained(measuring_steps(0.2 * first, 7.0 * second, LARGE, ("A", "B")))
    assert found.converged
    assert found.length == pytest.approx(3.0 * apart, rel=0.06)
    assert found.squared == pytest.approx(found.length**2)
    assert found.marginal_error < 1e-5


def test_only_the_debiased_distance_to_itself_is_zero():
    (only,) = caps(0.0)
    found = drained(measuring_steps(only, only, LARGE, ("A", "A")))
    assert found.length < 1e-3
    plain = drained(measuring_steps(only, only, LARGE, ("A", "A"), debias=False))
    assert not plain.debiased
    assert abs(plain.squared) > 0.1
    assert plain.length == pytest.approx(np.sqrt(max(plain.squared, 0.0)))


def test_tables_hold_the_distances():
    groups = caps(0.0, 0.7, 2.0)
    table = drained(distance_table_steps(groups, "ABC", LARGE))
    assert table.names == ("A", "B", "C")
    assert table.converged
    assert not table.notices
    for i, j in ((0, 1), (1, 2), (0, 2)):
        expected = drained(measuring_steps(groups[i], groups[j], LARGE, ("a", "b"))).length
        assert table.lengths[i, j] == table.lengths[j, i] == pytest.approx(expected, rel=1e-4)
    np.testing.assert_array_equal(np.diag(table.lengths), 0.0)


def test_tables_report_progress():
    groups = caps(*np.linspace(0.0, 2.0, 8))
    found = recorded(distance_table_steps(groups, "ABCDEFGH", LARGE))
    fractions = [step.fraction for step in found.reports]
    assert fractions == sorted(fractions) and fractions[0] == 0.0 and 0.9 < fractions[-1] <= 1.0
    assert len({round(fraction, 1) for fraction in fractions}) > 5
    assert found.result.converged


def test_tables_leave_out_pairs_on_different_components():
    groups = [on(1.0, 0.0, 1), on(1.0, 0.0, 2), on(0.0, 1.0, 3), on(0.5, 0.5, 4)]
    table = drained(distance_table_steps(groups, ["Head", "Ear", "Tail", "All"], BALLS))
    apart = np.isinf(table.lengths)
    assert apart.sum() == 10
    assert not apart[0, 1]
    assert "Head, Ear; Tail; All" in str(table.notices[0])


def test_different_masses_of_components_are_refused_or_matched():
    pair = on(0.5, 0.5, 1), on(0.4, 0.6, 2)
    with pytest.raises(InputError, match="Head and Tail have different shares"):
        drained(measuring_steps(*pair, BALLS, ("Head", "Tail")))
    found = drained(measuring_steps(*pair, BALLS, ("Head", "Tail"), match_pieces=True))
    assert found.converged
    assert 0 <= found.length < 0.5


def test_it_can_be_cancelled():
    control = CountingControl(last=2)
    with pytest.raises(Cancelled):
        drained(distance_table_steps(caps(0.0, 1.0), "AB", LARGE, control=control))
    assert control.count == 2


def test_weights_that_are_no_distribution_are_refused_by_name():
    first, second = caps(0.0, 1.0)
    with pytest.raises(InputError, match="The end is empty"):
        drained(measuring_steps(first, 0 * second, LARGE, ("The start", "The end")))
    with pytest.raises(InputError, match="C has negative"):
        drained(distance_table_steps([first, second, -first], "ABC", LARGE))
    with pytest.raises(InputError, match="at least two"):
        drained(distance_table_steps([first], "A", LARGE))


def test_a_blur_too_short_for_the_distance_is_refused():
    """On more vertices than a dense kernel supports."""
    long = strip(1300, 1e-6)
    first, second = np.zeros((2, *long.shape))
    first[0] = second[-1] = 1.0
    with pytest.raises(InputError, match=r"A blur of 0\.0255 is too short to carry mass between A, B; try 0\.0382"):
        drained(measuring_steps(first, second, long, ("A", "B")))
