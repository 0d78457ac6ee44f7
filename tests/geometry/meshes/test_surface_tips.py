# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tips of limbs."""

import numpy as np
import pytest

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.surface_tips import surface_tips
from tests.grids import sheet
from tests.shapes import ball, bent_tube, body, capsules, joined


def places(mesh, persistence=0.07):
    return mesh.vertices[[tip.vertex for tip in surface_tips(mesh, persistence)]]


def test_a_person_has_five_tips():
    """The feet are the farthest ones, and the head is the nearest one."""
    found = places(body())
    assert len(found) == 5
    expected = ((-0.14, 0.0, 0.0), (0.14, 0.0, 0.0), (-0.85, 0.0, 1.25), (0.85, 0.0, 1.25), (0.0, 0.0, 1.81))
    apart = np.linalg.norm(found[:, None] - np.array(expected), axis=2)
    assert apart.min(axis=0).max() < 0.08
    assert set(apart.argmin(axis=1)[:2]) == {0, 1}
    assert apart.argmin(axis=1)[-1] == 4


def test_the_persistence_of_the_end_of_a_rod_is_a_quarter_of_its_length():
    """Points on a thin rod are half of its length away from its end on average, and a quarter from its middle."""
    rod = capsules((((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.05),), (-1.2, -0.1, -0.1), (1.2, 0.1, 0.1), 0.02)
    expected = 0.25 * 2.1 / rod.root_area
    assert len(places(rod, 0.93 * expected)) == 2
    assert len(places(rod, 1.07 * expected)) == 0


def test_a_bump_is_no_tip():
    limbs = (((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.15), ((0.5, 0.0, 0.1), (0.5, 0.0, 0.2), 0.08))
    bumpy = capsules(limbs, (-1.3, -0.3, -0.3), (1.3, 0.3, 0.5), 0.04)
    assert np.abs(places(bumpy)[:, 0]).min() > 1.0
    assert len(places(bumpy, 0.01)) >= 2


def test_tips_do_not_depend_on_the_pose():
    """The corners of a sheet are the tips, also of a rolled one."""
    flat = sheet(41, 17, (3.0, 1.0))
    x, y = flat.vertices[:, 0], flat.vertices[:, 1]
    rolled = TriangleMesh(np.stack([np.sin(x), y, np.cos(x)], axis=1), flat.faces)
    tips = [tip.vertex for tip in surface_tips(flat, 0.02)]
    assert len(tips) == 4
    assert sorted(tip.vertex for tip in surface_tips(rolled, 0.02)) == sorted(tips)


def test_distances_are_lengths_along_the_surface_in_its_sizes():
    rod = bent_tube(np.pi)
    tips = surface_tips(rod, 0.1)
    assert len(tips) == 2
    between = tips[0].distances[tips[1].vertex] * rod.root_area
    direct = np.linalg.norm(rod.vertices[tips[0].vertex] - rod.vertices[tips[1].vertex])
    assert between > 1.3 * direct
    assert tips[1].distances[tips[0].vertex] * rod.root_area == pytest.approx(between)


def test_only_the_largest_component_and_no_loose_vertex_has_tips():
    person = body(0.06)
    crowd = joined(ball(0.05, (5.0, 0.0, 0.0), 60), person)
    loose = TriangleMesh(np.concatenate([crowd.vertices, [[9.0, 9.0, 9.0]]]), crowd.faces)
    found = surface_tips(loose, 0.07)
    assert sorted(tip.vertex for tip in found) == sorted(60 + tip.vertex for tip in surface_tips(person, 0.07))
    assert np.isinf(found[0].distances[[0, len(loose.vertices) - 1]]).all()
