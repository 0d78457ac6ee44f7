# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids of revolution are found below what is attached to them."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.props import revolved
from convwass_addon.geometry.recognition.revolution import common_revolutions
from convwass_addon.geometry.recognition.revolved_bodies import common_revolved_bodies
from tests.shapes import ball, body, box, joined, rotated, torus, with_faces

CUP = revolved([(0.0, 0.0), (0.8, 0.0), (1.0, 1.5), (0.9, 1.5), (0.7, 0.1), (0.0, 0.1)])
SECTION = 2.0 * (0.9 * 1.5 - 0.8 * 1.4)
# Three sides of a frame whose ends are in the wall.
HANDLE = joined(
    box((0.7, 0.16, 0.16), (1.2, 0.0, 1.1)),
    box((0.7, 0.16, 0.16), (1.2, 0.0, 0.5)),
    box((0.16, 0.16, 0.8), (1.5, 0.0, 0.8)),
)
MUG = joined(CUP, HANDLE)
LYING = (0.5 * np.pi, 0.0, 0.0)


@pytest.mark.parametrize("mug", [MUG, MUG.moved((3.0, 1.0, 0.5)), joined(MUG, rotated(HANDLE, (0.0, 0.0, 2.0)))])
def test_the_body_of_a_mug_is_its_cup(mug):
    assert common_revolutions([mug]) is None
    frame, (found,) = common_revolved_bodies([mug])
    assert not found.is_whole
    assert frame[1] == pytest.approx([0.0, 0.0, 1.0])
    assert found.section.area == pytest.approx(SECTION, rel=0.01)
    # The handle moves the center of the area, but not the axis.
    wanted = mug.vertices[: len(CUP.vertices)].mean(axis=0)
    assert found.center[:2] == pytest.approx(wanted[:2], abs=2e-3)


def test_a_handle_across_the_axis_is_no_part_of_the_body():
    posts = [box((0.12, 0.12, 0.7), (side * 0.92, 0.0, 1.8)) for side in (1.0, -1.0)]
    _, (bucket,) = common_revolved_bodies([joined(CUP, *posts, box((1.96, 0.12, 0.12), (0.0, 0.0, 2.1)))])
    assert not bucket.is_whole
    assert bucket.section.area == pytest.approx(SECTION, rel=0.01)
    assert bucket.section.bounds[1, 1] - bucket.section.bounds[0, 1] == pytest.approx(1.5, abs=0.01)


def test_what_is_revolved_stays_whole():
    _, (cup, mug) = common_revolved_bodies([CUP, MUG])
    assert cup.is_whole
    assert not mug.is_whole
    assert cup.section.area == pytest.approx(SECTION, rel=1e-6)


def test_the_axis_may_lie():
    frame, _ = common_revolved_bodies([rotated(MUG, LYING), ball()])
    assert np.abs(frame[1]) == pytest.approx([0.0, 1.0, 0.0])
    assert common_revolved_bodies([MUG, rotated(CUP, LYING)]) is None


@pytest.mark.parametrize(
    "other",
    [
        box(),
        body(),
        joined(CUP, box((3.0, 0.8, 0.8), (2.0, 0.0, 0.8))),
        joined(torus(), torus(center=(2.7, 0.0, 0.0))),
        with_faces(CUP, CUP.corners[:, :, 0].mean(axis=1) > 0.0),
    ],
    ids=["box", "limbs", "large part", "two rings", "half a cup"],
)
def test_other_solids_have_no_such_body(other):
    assert common_revolved_bodies([other]) is None
