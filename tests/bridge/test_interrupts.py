# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interrupts that come while Blender works are not lost."""

from __future__ import annotations

import signal
import sys
import threading
from importlib import import_module

import bpy
import pytest

from convwass_addon.bridge.files.blend_files import open_blend, open_empty
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.files.output_paths import save_blend
from convwass_addon.bridge.files.scene_writing import write_still_gltf
from convwass_addon.bridge.interrupts import delayed_interrupts, kept_interrupts
from convwass_addon.bridge.morphs.disk.gltf_animation import write_gltf_animation
from convwass_addon.bridge.studio.rendered_scene import run_render
from convwass_addon.errors import Cancelled

pytestmark = pytest.mark.usefixtures("empty_scene")


def interrupt(*_args, **_options):
    signal.raise_signal(signal.SIGINT)


@pytest.fixture(autouse=True)
def same_handler():
    """Python's own, also where the tests run in the background, which ignores interrupts; it is still there after."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    assert signal.signal(signal.SIGINT, before) is signal.default_int_handler


@pytest.mark.parametrize("write", [write_still_gltf, write_gltf_animation])
def test_an_interrupt_ends_an_export(tmp_path, monkeypatch, write):
    assert write(str(tmp_path / "a.glb")) == {"FINISHED"}
    monkeypatch.setattr(sys.modules["io_scene_gltf2.blender.exp.export"], "save", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write(str(tmp_path / "b.glb"))


def test_an_interrupt_ends_an_import(tmp_path, monkeypatch):
    bpy.ops.mesh.primitive_cube_add()
    write_still_gltf(str(tmp_path / "a.glb"))
    monkeypatch.setattr(import_module("io_scene_gltf2.io.imp.gltf2_io_gltf"), "glTFImporter", interrupt)
    with pytest.raises(KeyboardInterrupt):
        import_objects(tmp_path / "a.glb", None)


def test_an_interrupt_while_blender_enables_its_addons_is_raised_after_it(monkeypatch):
    addons, enabled = import_module("addon_utils"), []
    enable = addons.reset_all

    def interrupted(**options):
        interrupt()
        enable(**options)
        enabled.append(True)

    monkeypatch.setattr(addons, "reset_all", interrupted)
    with pytest.raises(KeyboardInterrupt):
        open_empty()
    assert enabled


def test_an_interrupt_while_a_file_is_opened_is_raised_after_it(tmp_path):
    bpy.ops.mesh.primitive_cube_add()
    path = save_blend(tmp_path / "cube.blend")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    # Blender removes it when another file is open.
    bpy.app.handlers.load_pre.append(interrupt)
    with pytest.raises(KeyboardInterrupt):
        open_blend(path)
    assert "Cube" in bpy.data.objects


def test_an_interrupt_that_an_operator_ignores_is_raised_after_it():
    done = []
    with pytest.raises(KeyboardInterrupt), kept_interrupts():
        try:
            interrupt()
        except KeyboardInterrupt:
            done.append("ignored")
        done.append("finished")
    assert done == ["ignored", "finished"]


def test_an_interrupt_is_raised_at_the_end():
    done = []
    with pytest.raises(KeyboardInterrupt), delayed_interrupts():
        interrupt()
        done.append("finished")
    assert done == ["finished"]


@pytest.mark.parametrize("context", [kept_interrupts, delayed_interrupts])
def test_errors_without_interrupts_and_other_threads_are_left_alone(context):
    def work():
        with pytest.raises(RuntimeError, match="own"), context():
            raise RuntimeError("own")
        done.append(True)

    done = []
    work()
    other = threading.Thread(target=work)
    other.start()
    other.join()
    assert done == [True, True]


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
@pytest.mark.skipif(sys.platform == "win32", reason="signals are POSIX")
def test_a_signal_takes_effect_after_the_render(name):
    """Blender calls Python now and then while it renders, and prints what that raises."""
    number, came, early, finished = getattr(signal, name), [], [], []

    class Stopped(BaseException):
        """What the command line raises."""

    def stop(*_):
        came.append(name)
        raise Stopped

    scene = bpy.context.scene
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "CYCLES", 8, 8
    scene.cycles.samples = 1
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)

    def signal_once(*_):
        signal.raise_signal(number)
        early.extend(came)

    before = signal.signal(number, stop)
    bpy.app.handlers.render_pre.append(signal_once)
    bpy.app.handlers.render_complete.append(lambda *_: finished.append(True))
    try:
        with pytest.raises(Stopped):
            run_render(scene)
    finally:
        bpy.app.handlers.render_pre.remove(signal_once)
        bpy.app.handlers.render_complete.clear()
        signal.signal(number, before)
    assert (early, finished, came) == ([], [True], [name])


def test_a_render_that_its_window_stops_is_reported(monkeypatch):
    def cancelled(**_options):
        for handler in list(bpy.app.handlers.render_cancel):
            handler(bpy.context.scene)

    class Operators:
        """Stands in for Blender's operators, of which only a window can stop the real one."""

        class render:  # noqa: N801
            render = staticmethod(cancelled)

    monkeypatch.setattr(bpy, "ops", Operators)
    with pytest.raises(Cancelled):
        run_render(bpy.context.scene)
