# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that are stopped, or fail, at every one of their steps leave the file as it was."""

from __future__ import annotations

import errno
import gc

import bpy
import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.operators.background import BackgroundOperator
from tests.lights import principled
from tests.operators.densities import ESCAPE, Pressed, ball, inventory, until, window_context
from tests.pictures import image_of
from tests.rigs import chain

pytestmark = pytest.mark.usefixtures("empty_scene")


def two_cubes():
    for place in (0, 3):
        bpy.ops.mesh.primitive_cube_add(location=(place, 0, 0))
    bpy.ops.object.select_all(action="SELECT")


def two_circles():
    for place in (0, 3):
        bpy.ops.curve.primitive_bezier_circle_add(location=(place, 0, 0))
        bpy.context.object.data.dimensions = "2D"
    bpy.ops.object.select_all(action="SELECT")


def painted_ball():
    ball()


def body_and_rig():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, radius=3)
    own, body = bpy.context.scene.convwass_armature, bpy.context.object
    own.body, own.rig = body, chain(3, 0.7)
    bpy.ops.convwass.pin_joints(joints="A.head, C.tail")


def two_balls():
    own = bpy.context.scene.convwass_soft_map
    for name in ("source", "target"):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
        setattr(own, name, bpy.context.object)
    own.pairs.add()


def two_images():
    for number, name in enumerate(("Red", "Blue")):
        made = image_of(name, np.random.default_rng(number).random((8, 9, 4)))
    bpy.context.scene.convwass_recolor.palette = made


def two_metals():
    principled("A", 0.4)
    principled("B", 0.7)


CASES = {
    "bake_morph": (two_cubes, {"frames": 2, "resolution": 16, "use_custom_blur": True, "blur": 0.6}),
    "bake_morph flat": (two_circles, {"frames": 2, "flat_resolution": 256}),
    "interpolate_density": (painted_ball, {"first": "A", "second": "B", "steps": 2, "max_iterations": 10}),
    "measure_groups": (painted_ball, {}),
    "fit_armature": (body_and_rig, {"links": 1}),
    "compute_soft_map": (two_balls, {"vertices": 50, "sweeps": 1}),
    "recolor_image": (two_images, {"image": "Red"}),
    "interpolate_reflectance": (two_metals, {"materials": "A, B", "detail": 8, "blends": 2}),
}


def call(name, **arguments):
    return getattr(bpy.ops.convwass, name.split()[0])(**arguments)


def stopped_after(monkeypatch, count, error):
    """Let jobs fail after so many steps; return a list that has an entry where one had no so many."""
    ended = []

    def steps_of(kind):
        own = kind._steps

        def steps(self):
            make = own(self)

            def failing(check):
                for number, step in enumerate(make(check)):
                    if number == count:
                        raise error
                    yield step
                ended.append(True)

            return failing

        return steps

    for kind in {found for found in kinds_of(BackgroundOperator) if "_steps" in vars(found)}:
        monkeypatch.setattr(kind, "_steps", steps_of(kind))
    return ended


def kinds_of(kind):
    """All classes below one."""
    for own in kind.__subclasses__():
        yield own
        yield from kinds_of(own)


@pytest.mark.parametrize("name", CASES)
def test_nothing_is_left_of_what_was_stopped_at_any_step(name, monkeypatch):
    make, arguments = CASES[name]
    make()
    before = inventory()
    # One of its steps is like the other, and each takes a while.
    for count in range(0, 100, 9 if name == "interpolate_reflectance" else 1):
        error = (Cancelled("Cancelled."), MemoryError(), OSError(errno.ENOSPC, "No space left on device"))[count % 3]
        with monkeypatch.context() as patch:
            ended = stopped_after(patch, count, error)
            try:
                result = call(name, **arguments)
            except RuntimeError as told:
                assert "Traceback" not in str(told), told
                assert inventory() == before
                continue
            assert ended and result == {"FINISHED"}
            break
    assert count > 0 and not bpy.context.window_manager.convwass_progress.running


@pytest.mark.parametrize("where", ["write", "_finish"])
def test_a_defect_while_the_window_waits_stops_the_job_and_is_not_hidden(where, monkeypatch):
    """Otherwise nothing could be baked until Blender was started anew."""
    from convwass_addon.operators.bake_morph import CONVWASS_OT_bake_morph as Bake

    two_cubes()
    before = inventory()
    pressed, context = Pressed(Bake, **CASES["bake_morph"][1]), window_context()
    context.selected_objects, context.collection = bpy.context.selected_objects, bpy.context.collection

    def fail(*_):
        raise ZeroDivisionError("a defect")

    assert pressed._start(context) == {"RUNNING_MODAL"}
    if where == "write":
        monkeypatch.setattr(pressed._job, "write", fail)
    else:
        pressed._finish = fail
    with pytest.raises(ZeroDivisionError):
        until(pressed, context)
    assert not context.window_manager.convwass_progress.running
    assert inventory() == before


def test_two_bakes_at_once_do_not_mix():
    from convwass_addon.operators.bake_morph import CONVWASS_OT_bake_morph as Bake

    two_cubes()
    given = CASES["bake_morph"][1]
    contexts = [window_context(), window_context()]
    jobs = [Pressed(Bake, **given, inputs=names, layout="PATH") for names in ("Cube, Cube.001", "Cube.001, Cube")]
    for pressed, context in zip(jobs, contexts, strict=True):
        context.selected_objects, context.collection = [], bpy.context.collection
        assert pressed._start(context) == {"RUNNING_MODAL"}
    assert until(jobs[1], contexts[1]) == {"FINISHED"}
    assert jobs[0].modal(contexts[0], ESCAPE) in ({"CANCELLED"}, {"FINISHED"}, {"PASS_THROUGH"})
    morphs = [own for own in bpy.data.collections if own.name.startswith("Morph")]
    assert len(morphs) in (1, 2)
    assert all(len(own.objects) <= 3 for own in morphs)


def test_bakes_in_a_row_leave_no_more_than_one():
    two_cubes()
    given = CASES["bake_morph"][1]
    counts = []
    for _ in range(4):
        call("bake_morph", **given, inputs="Cube, Cube.001")
        counts.append({(block.id_type, block.name) for block in bpy.data.user_map()})
        call("delete_morph")
        gc.collect()
    assert counts[0] == counts[1] == counts[-1]
