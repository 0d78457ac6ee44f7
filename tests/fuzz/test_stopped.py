# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that are cancelled or fail at any of their steps leave the file unchanged."""

from __future__ import annotations

import errno
import gc
from contextlib import suppress
from functools import partial
from itertools import cycle

import bpy
import pytest

from convwass_addon.applications.motions import motion_candidates
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.errors import Cancelled
from convwass_addon.operators.background import BackgroundOperator
from tests.controls import CountingControl
from tests.fuzz.job_cases import CASES, call, prepare, traces, two_cubes
from tests.lights import coarse_lobes
from tests.operators.running import ESCAPE, Pressed, inventory, started, until, window_context

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Use coarse maps for guiding, and coarse lobes, since quality does not matter here."""
    monkeypatch.setattr(motion_candidates, "GuidedSettings", partial(GuidedSettings, map_vertices=100))
    with coarse_lobes():
        yield


def stopped_after(monkeypatch, count, error):
    """Let jobs fail after this many steps; return a list with an entry for each job that ended before."""
    ended = []

    own = BackgroundOperator.work

    def work(self):
        make = own(self)

        def failing(control):
            for number, step in enumerate(make(control)):
                if number == count:
                    raise error
                yield step
            ended.append(True)

        return failing

    monkeypatch.setattr(BackgroundOperator, "work", work)
    return ended


@pytest.mark.parametrize("name", CASES)
def test_nothing_is_left_after_stopping_at_any_step(name, monkeypatch, tmp_path):
    work = prepare(name, tmp_path)
    before = traces(tmp_path)
    errors = cycle((Cancelled("Cancelled."), MemoryError(), OSError(errno.ENOSPC, "No space left on device")))
    # The first steps differ from each other, later ones are repetitions.
    for count, error in zip((0, 1, 3, 9, 27, 81, 243), errors, strict=False):
        with monkeypatch.context() as patch:
            ended = stopped_after(patch, count, error)
            try:
                result = work()
            except RuntimeError as told:
                assert "Traceback" not in str(told), told
                assert traces(tmp_path) == before
                continue
            assert ended and result == {"FINISHED"}
            break
    assert count > 0 and not bpy.context.window_manager.convwass_progress.running


def checked_by(monkeypatch, control):
    """Let all jobs check `control`, and end their steps at it like those of a thread."""

    own = BackgroundOperator.work

    def work(self):
        make = own(self)

        def asking(_):
            for step in make(control):
                yield step
                control.check()
            # The number of checks in threads varies between runs; jobs that reach their end are cancelled there.
            raise Cancelled("Cancelled.")

        return asking

    monkeypatch.setattr(BackgroundOperator, "work", work)


# Cancelling inside a guided motion is covered by tests/applications/motions/test_guided_motion.py.
@pytest.mark.parametrize("name", sorted(CASES.keys() - {"bake_morph guided"}))
def test_nothing_is_left_after_cancelling_at_any_check(name, monkeypatch, tmp_path):
    """Also inside solves: halfway and at the last check. Later work is unaffected."""
    work = prepare(name, tmp_path)
    before = traces(tmp_path)
    whole = CountingControl()
    with monkeypatch.context() as patch:
        checked_by(patch, whole)
        with suppress(RuntimeError):
            work()
    assert traces(tmp_path) == before
    assert whole.count > 2, "it never asks"
    for last in (whole.count // 2, whole.count):
        with monkeypatch.context() as patch:
            checked_by(patch, CountingControl(last))
            with suppress(RuntimeError):
                assert work() == {"CANCELLED"}
        assert traces(tmp_path) == before, f"at check {last} of {whole.count}"
    assert work() == {"FINISHED"}


@pytest.mark.parametrize("where", ["write", "finish"])
def test_a_bug_in_the_modal_operator_stops_the_job_and_is_shown(where, monkeypatch):
    """Otherwise nothing could be baked until Blender was restarted."""
    from convwass_addon.operators.morph_bake import CONVWASS_OT_bake_morph as Bake

    two_cubes(None)
    before = inventory()
    pressed, context = Pressed(Bake, **CASES["bake_morph"][1]), window_context()
    context.selected_objects, context.collection = bpy.context.selected_objects, bpy.context.collection

    def fail(*_):
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr(MorphJob, where, fail)
    assert started(pressed, context)
    with pytest.raises(ZeroDivisionError):
        until(pressed, context)
    assert not context.window_manager.convwass_progress.running
    assert inventory() == before


def test_two_bakes_at_once_do_not_mix():
    from convwass_addon.operators.morph_bake import CONVWASS_OT_bake_morph as Bake

    two_cubes(None)
    given = CASES["bake_morph"][1]
    contexts = [window_context(), window_context()]
    jobs = [Pressed(Bake, **given, inputs=names, layout="PATH") for names in ("Cube, Cube.001", "Cube.001, Cube")]
    for pressed, context in zip(jobs, contexts, strict=True):
        context.selected_objects, context.collection = [], bpy.context.collection
        assert started(pressed, context)
    assert until(jobs[1], contexts[1]) == {"FINISHED"}
    assert jobs[0].modal(contexts[0], ESCAPE) in ({"CANCELLED"}, {"FINISHED"}, {"PASS_THROUGH"})
    morphs = [own for own in bpy.data.collections if own.name.startswith("Morph")]
    assert len(morphs) in (1, 2)
    assert all(len(own.objects) <= 3 for own in morphs)


def test_repeated_bakes_leave_no_more_than_one():
    two_cubes(None)
    given = CASES["bake_morph"][1]
    counts = []
    for _ in range(3):
        call("bake_morph", **given, inputs="Cube, Cube.001")
        counts.append({(block.id_type, block.name) for block in bpy.data.user_map()})
        call("delete_morph")
        gc.collect()
    assert counts[0] == counts[1] == counts[-1]
