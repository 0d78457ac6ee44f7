# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.densities.density_measures import MEASURING_SUBSTEPS
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.applications.densities.vertex_distances import distances_from
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.applications.test_density_pieces import BALLS
from tests.controls import cancelled_control
from tests.transport.sheets import strip
from tests.transport.spheres import icosphere

_UNIT = icosphere(4)
LARGE = density_surface(TriangleMesh(3.0 * _UNIT.vertices, _UNIT.faces), substeps=MEASURING_SUBSTEPS)


def great_circle(vertex):
    return 3.0 * np.arccos(np.clip(_UNIT.vertices @ _UNIT.vertices[vertex], -1.0, 1.0))


def test_distances_agree_with_great_circles():
    """In scene units; measured within 5 % except near the opposite pole, where heat arrives from all sides."""
    found = distances_from(7, LARGE)
    exact = great_circle(7)
    beyond = (exact > 1.5) & (exact < 8.0)
    np.testing.assert_allclose(found.lengths[beyond], exact[beyond], rtol=0.06)
    assert found.lengths[7] == 0.0
    assert not found.notices
    shown = found.heat_map()
    assert shown.weights.max() == 1.0
    np.testing.assert_allclose(shown.weights * shown.scale, found.lengths)


def test_several_sources_give_the_nearest_distance(monkeypatch):
    alone = [distances_from(vertex, LARGE).lengths for vertex in (3, 900)]
    expected = np.minimum(*alone)
    np.testing.assert_allclose(distances_from([900, 3, 3], LARGE).lengths, expected, atol=1e-12)
    monkeypatch.setattr("convwass_addon.applications.densities.vertex_distances.VALUES_AT_ONCE", 1)
    np.testing.assert_allclose(distances_from([900, 3], LARGE).lengths, expected, atol=1e-9)


def test_unreachable_vertices_are_explained():
    found = distances_from(0, BALLS)
    assert np.isfinite(found.lengths[:400]).all()
    assert np.isinf(found.lengths[400:]).all()
    texts = list(map(str, found.notices))
    assert texts[0].endswith("belong to no face: 1.")
    assert texts[1].endswith("no face connects: 300, in 1 pieces.")
    shown = found.heat_map()
    np.testing.assert_array_equal(shown.weights[400:], 1.0)
    assert shown.scale == found.lengths[:400].max()


def test_a_blur_that_is_too_short_is_explained():
    found = distances_from(0, strip(200, 1e-6))
    lost = int(np.isinf(found.lengths).sum())
    assert 100 < lost < 400
    (text,) = map(str, found.notices)
    assert text == f"Vertices too far away for a blur of 0.01: {lost}. A longer one reaches them."


@pytest.mark.parametrize(
    ("vertices", "message"), [([], "No vertex"), ([701], "0 to 700"), ([700], "700 is loose"), ([0.5], "whole")]
)
def test_sources_need_area(vertices, message):
    with pytest.raises(InputError, match=message):
        distances_from(vertices, BALLS)


def test_it_can_be_cancelled():
    with pytest.raises(Cancelled):
        distances_from([0], BALLS, cancelled_control())
