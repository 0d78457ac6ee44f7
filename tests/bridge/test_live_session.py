# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live morphs in a scene: display, effect on the inputs, and cleanup."""

from __future__ import annotations

import threading
import time

import bpy
import numpy as np
import pytest

from convwass_addon.applications.live.live_settings import LiveSettings
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge import handles, visibility
from convwass_addon.bridge.live import input_watch
from convwass_addon.bridge.live.input_watch import InputWatch
from convwass_addon.bridge.live.leftovers import ignore_undo, remove_leftovers
from convwass_addon.bridge.live.live_session import LiveRequest, LiveSession
from convwass_addon.bridge.live.running import running_live
from convwass_addon.bridge.objects import write_triangles
from convwass_addon.bridge.shape_sources import ShapeSource
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.plates import Plates
from tests.grids import sheet
from tests.linked_objects import linked_object
from tests.searches import counted_searches
from tests.shapes import ball, joined

SIZES = (0.6, 1.0, 0.8, 0.9)


@pytest.fixture
def begin(make_object):
    """Yield a function that starts a live morph of selected separate balls; running ones are ended afterwards."""

    def begun(count=2, motion="transport", carry=False, **live):
        inputs = [obj for obj in bpy.data.objects if obj.name.startswith("Ball")]
        for place in range(len(inputs), count):
            mesh = ball(SIZES[place], (3.0 * place, 0.0, 0.0), 200)
            inputs.append(make_object(f"Ball {place}", mesh.vertices, faces=mesh.faces))
        for obj in inputs:
            obj.select_set(not obj.hide_get())
        bpy.context.view_layer.objects.active = inputs[-1]
        bpy.context.view_layer.update()
        request = LiveRequest(
            MorphSettings(motion=motion, carry=carry), LiveSettings(**{"live_resolution": 24} | live), {}
        )
        return LiveSession(bpy.context, sorted(inputs, key=lambda obj: obj.name), request)

    yield begun
    if running_live() is not None:
        running_live().end()


def ticked(session, until, seconds=60.0):
    """Let a session go on until something is so."""
    end = time.monotonic() + seconds
    while not until():
        assert session.tick()
        assert time.monotonic() < end, session.message
        time.sleep(0.005)


def ready(session):
    """Let a session go on until all is done and shown."""
    ticked(session, lambda: str(session.message) == "Ready" or session.is_frozen)
    quiet = time.monotonic() + 1.0
    ticked(session, lambda: time.monotonic() > quiet)


def volume(mesh):
    mesh.calc_loop_triangles()
    points = np.array([v.co for v in mesh.vertices])
    a, b, c = points[[list(t.vertices) for t in mesh.loop_triangles]].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def test_the_shape_follows_the_handle(begin):
    session = begin()
    ready(session)
    small, large = (ball(size, points=200).volume for size in SIZES[:2])
    for across in (0.25, 0.8):
        session.move_to(across, 0.0)
        assert session.tick()
        assert session.place[0] == pytest.approx(across)
        assert session.weights == pytest.approx((1.0 - across, across), abs=1e-6)
        assert volume(session.scene.shape.data) == pytest.approx((1.0 - across) * small + across * large, rel=0.03)
        np.testing.assert_allclose(session.scene.shape.location, (3.0 * across, 0.0, 0.0), atol=0.02)
    assert not session.scene.shape.data.validate()
    # The user drags it, beyond the end of the line.
    session.scene.pad.handle.location.x = 99.0
    assert session.tick()
    assert session.weights == (0.0, 1.0)


@pytest.fixture
def finned_balls(make_object):
    """Two balls with fins, 0.8 and 1.2 long."""
    for place, length in enumerate((0.8, 1.2)):
        flat = sheet(9, 9)
        fin = TriangleMesh(flat.vertices * [length, 0.6, 1.0] + [0.4, -0.3, 0.0], flat.faces)
        mesh = joined(ball(0.5, points=200), fin)
        make_object(f"Ball {place}", mesh.vertices, faces=mesh.faces)


@pytest.mark.usefixtures("finned_balls")
def test_sheets_beside_solids_are_shown(begin):
    """They are thicker than a cell, as in bakes, instead of missing."""
    session = begin()
    ready(session)
    session.move_to(0.5, 0.0)
    assert session.tick()
    shape = session.scene.shape
    farthest = max(vertex.co.x for vertex in shape.data.vertices) + shape.location.x
    assert farthest == pytest.approx(0.4 + 1.0, abs=0.15)


@pytest.mark.usefixtures("finned_balls")
def test_sheets_are_found_in_the_background(begin, monkeypatch):
    """Of a million triangles that takes two seconds; Blender's window would not answer meanwhile."""
    threads, real = [], Plates.of
    monkeypatch.setattr(Plates, "of", lambda mesh: threads.append(threading.current_thread()) or real(mesh))
    session = begin()
    ready(session)
    assert len(threads) == 2
    for vertex in bpy.data.objects["Ball 0"].data.vertices:
        vertex.co *= 1.3
    bpy.data.objects["Ball 0"].data.update()
    bpy.context.view_layer.update()
    ticked(session, lambda: len(threads) == 4)
    assert threading.main_thread() not in threads


@pytest.mark.parametrize(("count", "place", "expected"), [(3, (0.5, 1.0), (0, 0, 1)), (4, (1.0, 1.0), (0, 1, 0, 0))])
def test_pads_of_three_and_four_have_shapes_at_their_corners(begin, count, place, expected):
    session = begin(count)
    session.move_to(*place)
    ticked(session, lambda: len(session.scene.shape.data.polygons) > 0)
    assert session.weights == pytest.approx(expected)
    middle = {3: (0.5, 1 / 3), 4: (0.5, 0.5)}[count]
    session.move_to(*middle)
    assert session.tick()
    assert session.weights == pytest.approx([1 / count] * count, abs=1e-5)


def test_nothing_is_left_behind(begin, inventory):
    session = begin(3)
    session.end()
    bpy.context.view_layer.update()
    before, selected = inventory(), {obj.name for obj in bpy.context.selected_objects}
    handlers = {
        name: list(getattr(bpy.app.handlers, name)) for name in ("save_pre", "save_post_fail", "depsgraph_update_post")
    }
    session = begin(3)
    ticked(session, lambda: len(session.scene.shape.data.polygons) > 0)
    assert inventory() != before
    assert all(obj.hide_get() and not obj.hide_render for obj in bpy.data.objects if obj.name.startswith("Ball"))
    assert bpy.data.collections["Live Morph"].hide_render
    session.end()
    session.end()
    assert inventory() == before
    assert {obj.name for obj in bpy.context.selected_objects} == selected
    assert bpy.context.view_layer.objects.active.name == "Ball 2"
    assert not any(obj.hide_get() for obj in bpy.data.objects)
    assert {name: list(getattr(bpy.app.handlers, name)) for name in handlers} == handlers
    assert running_live() is None


def test_only_one_runs_at_a_time(begin, inventory):
    begin()
    before = inventory()
    with pytest.raises(InputError, match="Another live morph"):
        begin()
    assert inventory() == before


def test_edited_inputs_are_blended_anew(begin):
    session = begin()
    ready(session)
    session.move_to(0.0, 0.0)
    session.tick()
    before = volume(session.scene.shape.data)
    for vertex in bpy.data.objects["Ball 0"].data.vertices:
        vertex.co *= 1.3
    bpy.data.objects["Ball 0"].data.update()
    bpy.context.view_layer.update()
    ticked(session, lambda: volume(session.scene.shape.data) > 1.5 * before, 20.0)
    ready(session)
    assert volume(session.scene.shape.data) == pytest.approx(1.3**3 * before, rel=0.05)


def test_inputs_can_be_looked_at_in_edit_mode(begin):
    session = begin()
    ready(session)
    blends = session.scene.shape.data.vertices[0].co.copy()
    obj = bpy.data.objects["Ball 0"]
    obj.hide_set(False)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    quiet = time.monotonic() + 1.0
    ticked(session, lambda: time.monotonic() > quiet)
    bpy.ops.object.mode_set(mode="OBJECT")
    ready(session)
    assert not session.is_frozen and session.fraction == 1.0
    assert session.scene.shape.data.vertices[0].co == blends


def test_a_deleted_input_freezes_it(begin):
    session = begin()
    ready(session)
    bpy.data.objects.remove(bpy.data.objects["Ball 1"])
    ticked(session, lambda: session.is_frozen)
    assert "Ball 1 was deleted" in str(session.message)
    # The result so far can still be viewed and kept.
    session.move_to(0.4, 0.0)
    assert session.tick()
    kept = session.kept_shape(1.0)
    assert len(kept.data.polygons) > 100
    session.end()
    assert {obj.name for obj in bpy.data.objects} == {"Ball 0", kept.name}


def test_the_inputs_are_looked_after_in_one_search(make_object, monkeypatch):
    """Also while something else is edited, and however many there are."""
    parts = tuple(make_object(name) for name in ("Body", "Hat", "Tail", "Sword"))
    watch = InputWatch([ShapeSource("Hero", parts[0], parts)])
    kept, removed = [obj.name for obj in parts[:2]], [obj.name for obj in parts[2:]]
    bpy.data.objects.remove(parts[3])
    bpy.context.scene.collection.objects.unlink(parts[2])
    parts[2].use_fake_user = True
    searches = counted_searches(monkeypatch, input_watch, handles, visibility)
    assert watch.lost == removed
    assert searches == {"objects": 1, "scenes": 1}
    searches.clear()
    assert [obj.name for obj in watch.roots] == kept[:1]
    assert watch.may_have_changed
    assert searches == {"objects": 2}


def test_edits_of_inputs_are_heard_of_and_no_others(make_object):
    body, hat, other = (make_object(name) for name in ("Body", "Hat", "Other"))
    watch = InputWatch([ShapeSource("Hero", body, (body, hat))])
    bpy.context.view_layer.update()
    watch.register()
    try:
        other.data.vertices[0].co.x += 1.0
        other.data.update()
        bpy.context.view_layer.update()
        assert not watch.may_have_changed
        hat.data.update()
        bpy.context.view_layer.update()
        assert watch.may_have_changed
        watch.note()
        assert not watch.may_have_changed
    finally:
        watch.unregister()


def test_undone_objects_end_it(begin):
    session = begin()
    bpy.data.objects.remove(session.scene.pad.handle)
    assert not session.tick()


def test_shapes_that_cannot_be_blended_are_reported(begin, make_object):
    for place in range(2):
        make_object(f"Ball {place}", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces=[(0, 1, 2)]).select_set(True)
    session = begin()
    ticked(session, lambda: session.has_failed)
    assert "encloses no volume" in str(session.message)


def test_files_are_saved_without_it(begin, tmp_path, inventory):
    session = begin()
    ticked(session, lambda: len(session.scene.shape.data.polygons) > 0)
    path = str(tmp_path / "live.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    # It continues after saving the file, and if that fails.
    assert session.tick() and bpy.data.objects["Ball 0"].hide_get()
    with pytest.raises(RuntimeError):
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "missing" / "live.blend"), copy=True)
    assert bpy.data.objects["Ball 0"].hide_get()
    session.end()
    before = inventory()
    bpy.ops.wm.open_mainfile(filepath=path)
    assert inventory() >= before and not any("Live" in name for _, name in inventory())
    assert not any(obj.hide_get() for obj in bpy.data.objects)


def test_kept_shapes_are_solved_in_full_and_stay(begin):
    session = begin()
    session.move_to(0.5, 0.0)
    ticked(session, lambda: len(session.scene.shape.data.polygons) > 0)
    kept = session.kept_shape(60.0)
    assert session.scene.shape is not kept
    session.end()
    assert kept.name in bpy.context.scene.objects
    expected = np.mean([ball(size, points=200).volume for size in SIZES[:2]])
    assert volume(kept.data) == pytest.approx(expected, rel=0.02)


def test_objects_restored_by_undo_are_removed(begin, inventory):
    session = begin()
    session.end()
    before = inventory()
    session = begin()
    hidden = [obj for obj in bpy.data.objects if obj.hide_get()]
    assert len(hidden) == 2
    remove_leftovers()
    assert inventory() == before
    assert not any(obj.hide_get() for obj in hidden)


def test_shapes_that_are_hidden_in_another_scene_stay_so(begin):
    session = begin()
    other = bpy.data.scenes.new("Other")
    hidden = [obj for obj in bpy.data.objects if obj.hide_get()]
    for obj in hidden:
        other.collection.objects.link(obj)
        obj.hide_set(True, view_layer=other.view_layers[0])
    remove_leftovers()
    assert not any(obj.hide_get() for obj in hidden)
    assert all(obj.hide_get(view_layer=other.view_layers[0]) for obj in hidden)
    assert not session.tick()


def test_names_that_earlier_versions_stored_do_not_stop_the_removal(begin, inventory):
    session = begin()
    session.end()
    before = inventory()
    begin()
    (live,) = [own for own in bpy.data.collections if "convwass_live" in own]
    (first, *_), names = live["convwass_live"].splitlines(), ["Ball", "Ball 0", "²"]
    hidden = [obj for obj in bpy.data.objects if obj.hide_get()]
    live["convwass_live"] = "\n".join([*names, first])
    remove_leftovers()
    assert inventory() == before
    assert [obj.session_uid for obj in hidden if not obj.hide_get()] == [int(first)]


@pytest.fixture
def namesakes(make_object, tmp_path):
    """Make a local and a linked ball of the same name."""
    mesh = ball(SIZES[0], (0.0, 0.0, 0.0), 200)
    local = make_object("Ball 0", mesh.vertices, faces=mesh.faces)
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {local})
    local.location.x = 3.0
    return local, linked_object(path, local.name)


def test_two_inputs_of_one_name_are_told_apart(begin, namesakes):
    session = begin()
    assert [obj.hide_get() for obj in namesakes] == [True, True]
    remove_leftovers()
    assert [obj.hide_get() for obj in namesakes] == [False, False]
    session.end()
    assert [obj.select_get() for obj in namesakes] == [True, True]


def test_an_input_outside_the_view_layer_is_not_taken_for_its_namesake(begin, namesakes):
    """It was taken out of the scene after the start."""
    local, linked = namesakes
    session = begin()
    bpy.context.scene.collection.objects.unlink(linked)
    session.end()
    assert not local.hide_get()


def test_colors_are_mixed_and_kept(begin, inventory):
    session = begin(carry=True)
    session.end()
    for place, color in enumerate([(1.0, 0.0, 0.2, 1.0), (0.0, 0.5, 0.2, 1.0)]):
        bpy.data.objects[f"Ball {place}"].color = color
    before = inventory()
    session = begin(carry=True)
    session.move_to(0.25, 0.0)
    ticked(session, lambda: len(session.scene.shape.data.polygons) > 0)
    mesh = session.scene.shape.data
    colors = [tuple(value.color) for value in mesh.color_attributes["Color"].data]
    np.testing.assert_allclose(colors, np.tile((0.75, 0.125, 0.2, 1.0), (len(mesh.vertices), 1)), atol=2e-3)
    kept = session.kept_shape(60.0)
    np.testing.assert_allclose(kept.data.color_attributes["Color"].data[7].color, (0.75, 0.125, 0.2, 1.0), atol=1e-3)
    assert [material.name for material in kept.data.materials] == ["Convwass Blend"]
    session.end()
    for block in (kept.data, bpy.data.materials["Convwass Blend"]):
        bpy.data.batch_remove([block])
    assert inventory() == before


def test_shapes_of_one_color_keep_their_material(begin):
    session = begin(carry=True)
    ticked(session, lambda: len(session.scene.shape.data.polygons) > 0)
    assert not session.scene.shape.data.color_attributes and not session.scene.shape.data.materials


def test_undo_is_watched_from_the_first_live_morph_on(begin):
    def watched():
        return [len(handlers) for handlers in (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post)]

    ignore_undo()
    before = watched()
    for _ in range(2):
        begin().end()
    assert watched() == [count + 1 for count in before]
    # Another file has no undo steps of it.
    bpy.ops.wm.read_homefile(use_empty=True)
    assert watched() == before


def test_triangles_are_written_unchanged():
    mesh = bpy.data.meshes.new("Written")
    for triangles in (ball(points=50), ball(2.0, points=20)):
        write_triangles(mesh, triangles)
        np.testing.assert_allclose([v.co for v in mesh.vertices], triangles.vertices, atol=1e-6)
        np.testing.assert_array_equal([list(p.vertices) for p in mesh.polygons], triangles.faces)
        assert len(mesh.edges) == 3 * len(triangles.faces) // 2
        assert not mesh.validate()


def test_a_live_morph_ends_with_its_scene(begin):
    session = begin()
    ready(session)
    gone = bpy.context.scene
    bpy.context.window.scene = bpy.data.scenes.new("Other")
    bpy.data.scenes.remove(gone)
    assert session.kept_shape(0.0) is None
    assert not any(obj.name.startswith("Blend") for obj in bpy.data.objects)
    assert not session.tick()
    session.end()
    assert running_live() is None
