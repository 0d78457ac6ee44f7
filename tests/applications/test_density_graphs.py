# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.densities.density_graphs import propagation_steps
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.progress import drained
from convwass_addon.transport import barycenter
from tests.applications.test_density_paths import SPHERE, check_records
from tests.applications.test_density_pieces import BALLS, on
from tests.controls import cancelled_control, recorded
from tests.transport.spheres import cap, off_center

LINE = [(0, 1), (1, 2), (2, 3), (3, 4)]
ENDS = {0: cap(SPHERE, 0.0), 4: cap(SPHERE, 1.2)}
NAMES = ["Dawn", "Morning", "Noon", "Evening", "Night"]


def test_densities_between_two_fixed_ones_lie_between_them():
    """On a line, the nodes are equally spaced; measured within 0.01 rad."""
    found = recorded(propagation_steps(LINE, ENDS, SPHERE, DensitySettings(), NAMES))
    assert str(found.reports[0].message) == "Filling in 3 of 5 places"
    frames = found.result
    check_records(frames)
    np.testing.assert_array_equal(frames.times, np.arange(5))
    assert [figures["key"] for figures in frames.records] == ["Dawn", None, None, None, "Night"]
    for place, density in enumerate(frames.densities):
        assert off_center(SPHERE, density, 0.3 * place) < 0.03
        assert frames.records[place]["converged"]


def test_a_star_is_the_barycenter_of_its_tips():
    tips = [cap(SPHERE, angle) for angle in (0.0, 0.5, 1.2)]
    asked = DensitySettings(entropy_limit=None, tolerance=1e-6)
    frames = drained(
        propagation_steps([(0, 3), (1, 3), (2, 3)], dict(enumerate(tips)), SPHERE, asked, edge_weights=[1, 2, 1])
    )
    expected = barycenter(tips, [1, 2, 1], SPHERE, tolerance=1e-6).density
    assert np.abs(frames.densities[3] - expected) @ SPHERE.weights < 1e-5


def test_nothing_is_solved_if_all_nodes_are_fixed():
    frames = drained(propagation_steps([(0, 1)], {0: ENDS[0], 1: ENDS[4]}, SPHERE, DensitySettings()))
    assert len(frames.times) == 2
    alone = drained(propagation_steps([], {0: ENDS[0]}, SPHERE, DensitySettings()))
    np.testing.assert_allclose(alone.densities[0], ENDS[0])


@pytest.mark.parametrize(
    ("edges", "fixed", "names", "message"),
    [
        (LINE, {}, NAMES, "No place"),
        (LINE, ENDS, NAMES[:3], "from 0 to 2, as there are 3"),
        ([(0, -1)], ENDS, NAMES, "from 0 to 4"),
        ([(0, 1, 2)], ENDS, NAMES, "pairs"),
        ([(0.5, 1.0)], ENDS, NAMES, "pairs"),
        ([*LINE, (2, 2)], ENDS, NAMES, "from Noon to itself"),
        ([(0, 4), (2, 3)], ENDS, NAMES, "to Morning, Noon, Evening"),
        (LINE, {0: ENDS[0], 4: 0 * ENDS[4]}, NAMES, "Night is empty"),
    ],
)
def test_invalid_graphs_are_refused_by_name(edges, fixed, names, message):
    with pytest.raises(InputError, match=message):
        next(propagation_steps(edges, fixed, SPHERE, DensitySettings(), names))


@pytest.mark.parametrize(("weights", "message"), [([1.0, 2.0], "2 weights"), (0.0, "positive"), (np.nan, "positive")])
def test_edges_need_positive_weights(weights, message):
    with pytest.raises(InputError, match=message):
        next(propagation_steps(LINE, ENDS, SPHERE, DensitySettings(), edge_weights=weights))


def test_components_are_respected():
    with pytest.raises(InputError, match="0 and 2 lie on different pieces"):
        next(propagation_steps([(0, 1), (1, 2)], {0: on(1, 0), 2: on(0, 1)}, BALLS, DensitySettings()))


def test_it_can_be_cancelled():
    with pytest.raises(Cancelled):
        list(propagation_steps(LINE, ENDS, SPHERE, DensitySettings(), control=cancelled_control()))
