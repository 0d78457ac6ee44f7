# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends that are computed again from kept barycenters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.applications.morphs.blend_solver import BlendSolver
from convwass_addon.applications.morphs.blending import solve_blends
from convwass_addon.applications.morphs.demands import Demand
from convwass_addon.applications.morphs.kept_blends import KeptBlends
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.morphs.resting_problem import RestingProblem
from convwass_addon.applications.morphs.runs import as_solved
from convwass_addon.applications.morphs.solving_again import again_in_threads
from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.progress import Control, drained
from tests.shapes import ball, box

RUN = tuple(path_blends(2, 4)[1:4])
ASKED = {RUN[2]: Demand(Connectivity(1, 0, 0))}


@pytest.fixture(scope="module")
def problem():
    settings = MorphSettings(motion="transport", resolution=24)
    prepared = drained(prepared_problem(MorphInputs.of((ball(), box()), ("a", "b")), settings, 1))
    return replace(prepared, keeps_potentials=True)


@pytest.fixture(scope="module")
def kept(problem):
    blends = KeptBlends(1 << 30, finest=True)
    solve_blends(problem, RUN, kept=blends)
    return blends


@pytest.fixture
def solves(monkeypatch):
    """The blends that are solved."""
    found, real = [], BlendSolver.solve

    def solve(self, blend, *others):
        found.append(blend)
        return real(self, blend, *others)

    monkeypatch.setattr(BlendSolver, "solve", solve)
    return found


def test_kept_blends_give_the_same_frames_without_a_solve(problem, kept, solves):
    (solved,) = RestingProblem(problem).frames_again(RUN, ASKED)
    assert solves == list(RUN)
    (found,) = RestingProblem(problem, kept).frames_again(RUN, ASKED)
    assert solves == list(RUN)
    assert found.record == solved.record
    np.testing.assert_array_equal(found.mesh.vertices, solved.mesh.vertices)
    np.testing.assert_array_equal(found.mesh.faces, solved.mesh.faces)
    np.testing.assert_array_equal(found.origins, solved.origins)
    for one, other in zip(found.potentials, solved.potentials, strict=True):
        np.testing.assert_array_equal(one.columns, other.columns)


def test_only_as_many_blends_are_kept_as_fit(problem):
    few = KeptBlends(0)
    solve_blends(problem, RUN, kept=few)
    assert not any(blend in few for blend in RUN)


def test_all_are_solved_again_if_one_is_missing_and_kept_then(problem, solves):
    first = KeptBlends(1 << 30, finest=True)
    solve_blends(problem, RUN[:1], kept=first)
    assert RUN[0] in first
    assert RUN[2] not in first
    solves.clear()
    for _ in range(2):
        RestingProblem(problem, first).frames_again(RUN, ASKED)
        assert solves == list(RUN)


def test_kept_blends_are_computed_again_side_by_side(problem, kept):
    """Those that are not kept are solved from each other."""
    asked = {blend: Demand(Connectivity(1, 0, 0)) for blend in RUN[1:]}
    for known, count in ((kept, 2), (None, 1)):
        with again_in_threads(RestingProblem(problem, known), {0: RUN}, asked, Control(), 2) as pending:
            assert len(pending) == count
            found = [frame.blend for solved in as_solved(pending, Control()) for frame in solved.frames]
        assert sorted(found, key=RUN.index) == list(RUN[1:])
