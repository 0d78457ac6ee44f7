# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshes of two shapes of different topology that replace each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.one_mesh import swapped_meshes as module
from convwass_addon.applications.one_mesh.followed_surfaces import turned_around
from convwass_addon.applications.one_mesh.swapped_meshes import swapped_meshes
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.visible_gap import VisibleGap
from convwass_addon.progress import UNINTERRUPTED, Control, Progress, drained
from convwass_addon.sentence import Sentence
from tests.shapes import ball, torus

SETTINGS = MorphSettings(resolution=18, motion="transport")


def found(shapes):
    names = [f"Shape {number}" for number in range(len(shapes))]
    return drained(swapped_meshes(MorphInputs.of(shapes, names), 0.005, SETTINGS, UNINTERRUPTED, Computation()))


@pytest.fixture(scope="module", autouse=True)
def few_steps():
    steps = 12
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_STEPS", steps)
        patch.setattr(module, "_SWAPS", (0, *range(3, steps - 2), steps))
        yield


@pytest.fixture(scope="module")
def ring_to_ball():
    """The shapes, what is found, and the morph that their meshes follow."""
    ring, other, kept = torus(segments=(36, 18)), ball(0.9, points=400), []
    computed = module._moments

    def remembered(*arguments):
        kept.extend((yield from computed(*arguments)))
        return kept

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_moments", remembered)
        return ring, other, found([ring, other]), kept


def known(moments):
    """A morph that is known already."""

    def work(*_arguments):
        yield Progress(0.5, Sentence("Half"))
        return moments

    return work


def test_the_mesh_of_a_ring_closes_its_hole_and_becomes_a_ball(ring_to_ball):
    ring, other, result, _ = ring_to_ball
    # Only the ring's mesh can take both forms, up to a slit.
    assert result.time == 1.0 and result.second is None and result.paths == [result.first]
    assert result.first.times[-1] == 1.0 and result.first.positions.shape[1] == len(ring.vertices)
    last = TriangleMesh(result.first.positions[-1], ring.faces)
    gap = VisibleGap.between(last, other).most / other.diagonal
    assert gap < 0.01 and result.gap == pytest.approx(gap)
    assert result.record()["shapes"][0]["score"] is None


def test_in_the_other_direction_the_mesh_of_the_ring_takes_over_at_once(ring_to_ball, monkeypatch):
    ring, other, result, moments = ring_to_ball
    monkeypatch.setattr(module, "_moments", known(turned_around(moments)))
    back = found([other, ring])
    assert (back.time, back.first) == (0.0, None)
    assert back.second.positions.shape[1] == len(ring.vertices)
    assert back.gap == pytest.approx(result.gap, abs=1e-4)


def test_meshes_that_do_not_meet_are_refused(ring_to_ball, monkeypatch):
    ring, other, _, moments = ring_to_ball
    away = np.array([5.0, 0.0, 0.0])
    half = len(moments) // 2
    torn = [replace(own, surface=TriangleMesh(own.surface.vertices + away, own.surface.faces)) for own in moments]
    monkeypatch.setattr(module, "_moments", known([*moments[:half], *torn[half:]]))
    with pytest.raises(InputError, match="Between Shape 0 and Shape 1 the surface tears"):
        found([ring, other])


def test_swapping_reports_its_progress_and_can_be_cancelled(ring_to_ball, monkeypatch):
    ring, other, _, moments = ring_to_ball
    monkeypatch.setattr(module, "_moments", known(moments))

    def work(control):
        inputs = MorphInputs.of([ring, other], ["Ring", "Ball"])
        return swapped_meshes(inputs, 0.005, SETTINGS, control, Computation())

    last = [report.fraction for report in work(UNINTERRUPTED) if report.fraction >= module._FOLLOWED]
    assert len(set(last)) > 10 and max(last) > module._SWAPPED
    for stage in (module._FOLLOWED, module._SWAPPED):
        control = Control()
        own = work(control)
        assert next(report for report in own if report.fraction >= stage)
        control.cancel()
        with pytest.raises(Cancelled):
            drained(own)


def test_three_shapes_are_refused():
    with pytest.raises(InputError, match="needs two shapes; there are 3"):
        found([ball(points=50)] * 3)
