# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that face different ways."""

import numpy as np
import pytest

from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.geometry.rotation_fields import rotation_matrices
from convwass_addon.progress import drained
from tests.applications.maps import shuffled
from tests.grids import figure

ROUGH = GuidedSettings(map_vertices=150, carrier_vertices=600)


def long_figure():
    """A body with limbs and a tail, longer than wide, whose head is at one end."""
    mesh = figure()[0]
    x, y, z = mesh.vertices.T
    return TriangleMesh(np.stack([0.6 * x, 2.0 * y + 0.4 * z, z + 0.3 * y], axis=1), mesh.faces)


def about_z(degrees):
    return rotation_matrices(np.radians([[0.0, 0.0, degrees]]))[0]


def test_a_shape_turned_to_another_side_turns_as_a_whole():
    """For half a turn, see test_a_figure_that_faces_the_other_way_needs_no_guides."""
    shape, degrees = long_figure(), 90.0
    turned = shuffled(TriangleMesh(shape.vertices @ about_z(degrees).T, shape.faces))[0]
    motion = drained(guided_motion([shape, turned], ["one", "other"], [(0, 1)], ROUGH))
    assert abs(motion.pairs[0, 1].turn) == pytest.approx(degrees)
    assert abs(motion.record()["pairs"][0]["turned"]) == degrees
    # The turn itself is no detour.
    assert motion.pairs[0, 1].detour < 1.1
    size = np.sqrt(shape.area)
    for share in (0.25, 0.5, 0.75):
        moved = motion.moved((1.0 - share, share))[0].vertices
        ideal = shape.vertices @ about_z(share * degrees).T
        apart = np.linalg.norm(moved - moved.mean(axis=0) - (ideal - ideal.mean(axis=0)), axis=1)
        assert apart.max() < 0.03 * size
