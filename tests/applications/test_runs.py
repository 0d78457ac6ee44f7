# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The order in which runs are solved: one thread must not be left with the longest when the others are done."""

from __future__ import annotations

import numpy as np

from convwass_addon.applications.morphs import resting_problem
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from tests.shapes import ball, box

QUICK = MorphSettings(motion="transport", resolution=24)


def frames_of(shapes, **how):
    steps = morph(MorphInputs.of(shapes, ["a", "b"]), path_blends(2, 10), QUICK, computation=Computation(**how))
    return [step.payload for step in steps if step.payload is not None]


def begun(monkeypatch, shapes):
    """The first frame of every run, in the order in which they begin."""
    seen = []

    def solve(problem, run, *arguments, real=resting_problem.solve_blends):
        seen.append(run[0].frame)
        return real(problem, run, *arguments)

    monkeypatch.setattr(resting_problem, "solve_blends", solve)
    frames = frames_of(shapes, workers=1)
    assert [frame.blend.frame for frame in frames] == list(range(11))
    return seen


def test_the_run_with_the_largest_boxes_comes_first_and_the_others_in_order(monkeypatch):
    small, large = ball(0.4), box((3.0, 3.0, 3.0))
    assert begun(monkeypatch, (small, large)) == [4, 0, 8]
    monkeypatch.undo()
    assert begun(monkeypatch, (large, small)) == [0, 4, 8]


def test_frames_do_not_depend_on_the_extracting_thread():
    pairs = [*zip(*(frames_of((ball(), box()), workers=workers) for workers in (1, 3)), strict=True)]
    for one, other in pairs:
        assert one.record == other.record
    meshes = [(one.mesh, other.mesh) for one, other in pairs if one.blend.source is None]
    assert len(meshes) == len(pairs) - 2
    for one, other in meshes:
        np.testing.assert_array_equal(one.vertices, other.vertices)
        np.testing.assert_array_equal(one.faces, other.faces)
