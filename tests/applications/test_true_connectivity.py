# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes whose cells show handles or lumps that the shapes do not have."""

from __future__ import annotations

import numpy as np

from convwass_addon.applications.morphs.extraction import connectivity_of
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.progress import drained
from tests.shapes import bent_tube, torus, with_faces

SETTINGS = MorphSettings(resolution=40, motion="transport")


def test_parts_that_touch_in_the_cells_make_no_handle():
    shapes = [bent_tube(np.radians(357)), torus()]
    problem = drained(prepared_problem(MorphInputs.of(shapes, ("bow", "ring")), SETTINGS, 1))
    assert connectivity_of(problem.transport.occupancy(0), SETTINGS) == Connectivity(1, 1, 0)
    assert problem.connectivity == (Connectivity(1, 0, 0), Connectivity(1, 1, 0))
    assert problem.meshes == ()


def test_an_open_shape_is_read_on_a_finer_lattice():
    bow = bent_tube(np.radians(356))
    shapes = [with_faces(bow, np.arange(len(bow.faces)) != 100), torus()]
    problem = drained(prepared_problem(MorphInputs.of(shapes, ("bow", "ring")), SETTINGS, 1))
    assert connectivity_of(problem.transport.occupancy(0), SETTINGS).handles == 1
    assert problem.connectivity[0] == Connectivity(1, 0, 0)
