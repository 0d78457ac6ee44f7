# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and videos of morphs: their content, and cleanup."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.keyframes import FrameRange, key_visibility
from convwass_addon.bridge.morphs.looks.materials import morph_material
from convwass_addon.bridge.morphs.pictures.animation import render_animation
from convwass_addon.bridge.morphs.pictures.contact_sheet import render_contact_sheet
from convwass_addon.bridge.morphs.stored import INDEX_KEY, WEIGHTS_KEY
from convwass_addon.bridge.studio.framing import View, broad_view, orbit
from convwass_addon.bridge.studio.rendered_scene import Studio, choose_cycles, opening, world_matrix, world_points
from convwass_addon.errors import ConvwassError, InputError
from convwass_addon.progress import drained
from tests.controls import recorded
from tests.pictures import pixels_in

RED, GREEN = (0.6, 0.02, 0.02, 1.0), (0.02, 0.5, 0.02, 1.0)
SAMPLES = 2


def cube(collection, index, count, size=1.0):
    """Add a frame object, a cube whose color changes from red to green."""
    t = index / max(count - 1, 1)
    name = f"Morph {index + 1:04d}"
    mesh = bpy.data.meshes.new(name)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (0, 2)]) * size / 2.0
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners.tolist(), [], faces)
    mesh.materials.append(morph_material())
    obj = bpy.data.objects.new(name, mesh)
    obj.color = (1.0 - t) * np.array(RED) + t * np.array(GREEN)
    obj[WEIGHTS_KEY], obj[INDEX_KEY] = [1.0 - t, t], index
    collection.objects.link(obj)
    return obj


@pytest.fixture
def collection(empty_scene):
    made = bpy.data.collections.new("Morph Red to Green")
    empty_scene.collection.children.link(made)
    return made


@pytest.fixture
def path_morph(collection):
    """Five cubes, shown in frames 11 to 15."""
    action = bpy.data.actions.new("Morph")
    for index in range(5):
        first = None if index == 0 else 11 + index
        last = None if index == 4 else 11 + index
        key_visibility(cube(collection, index, 5), action, [FrameRange(first, last)])
    bpy.context.scene.frame_set(12)
    return collection


@pytest.fixture
def sheet_morph(collection):
    """A triangle of three cubes above each other, as a sheet hangs in the scene."""
    for index, (x, z) in enumerate([(1.0, 0.0), (0.0, -2.0), (2.0, -2.0)]):
        cube(collection, index, 3).location = (x, 0.0, z)
    return collection


def photographed(objects, path, resolution, samples):
    """Render objects in place."""
    points = [world_points(obj) for obj in objects]
    view = broad_view(points, np.radians(18.0))
    with Studio() as studio:
        for obj in objects:
            studio.show(obj)
        reach = studio.build(points, view)
        studio.look(orbit(np.concatenate(points), [view], opening(resolution))[0], reach)
        studio.set_quality(resolution, samples)
        studio.render(path)
    return pixels(path)


def pixels(path):
    """Return a picture as (height, width, 3), from the top, 0 to 1 as shown."""
    return pixels_in(path)[::-1, :, :3]


def is_red(picture):
    return (picture[..., 0] - picture[..., 1:].max(axis=-1)) > 0.2


def is_green(picture):
    return (picture[..., 1] - picture[..., [0, 2]].max(axis=-1)) > 0.2


def snapshot():
    """Return the state in which a user could notice a change."""
    scene = bpy.context.scene
    render = scene.render
    names = {
        kind: sorted(block.name for block in getattr(bpy.data, kind))
        for kind in ("scenes", "objects", "meshes", "materials", "worlds", "lights", "cameras", "images", "actions")
    }
    objects = {
        obj.name: (obj.hide_render, obj.hide_viewport, tuple(obj.location), obj.users, len(obj.users_scene))
        for obj in bpy.data.objects
    }
    settings = (scene.name, scene.frame_current, scene.frame_start, scene.frame_end, scene.camera, scene.world)
    output = (render.engine, render.filepath, render.resolution_x, render.resolution_y, render.use_persistent_data)
    return names, objects, settings, output, scene.view_settings.view_transform


def test_contact_sheet_shows_the_frames_in_reading_order(path_morph, tmp_path):
    before = snapshot()
    work = render_contact_sheet(path_morph, tmp_path / "sheet.png", columns=3, count=5, width=96, samples=SAMPLES)
    path = drained(work)
    picture = pixels(path)
    height = picture.shape[0]
    assert picture.shape[1] == 96
    assert is_red(picture[: height // 2, :32]).sum() > 50
    assert not is_red(picture[height // 2 :]).any()
    assert is_green(picture[height // 2 :, 32:64]).sum() > 50
    assert not is_green(picture[: height // 2]).any()
    assert 0.93 < picture[:2].mean() < 0.985, "the floor is nearly white, and not overexposed"
    assert snapshot() == before


def test_contact_sheet_of_few_frames_always_has_the_inputs(path_morph, tmp_path):
    work = render_contact_sheet(path_morph, tmp_path / "sheet.png", columns=2, count=2, width=64, samples=SAMPLES)
    picture = pixels(drained(work))
    assert is_red(picture[:, :32]).sum() > 50
    assert is_green(picture[:, 32:]).sum() > 50


def test_contact_sheet_keeps_the_places_of_a_sheet(sheet_morph, tmp_path):
    picture = pixels(drained(render_contact_sheet(sheet_morph, tmp_path / "sheet.png", width=64, samples=SAMPLES)))
    rows, columns = np.nonzero(is_red(picture))
    assert rows.max() < picture.shape[0] * 0.55
    assert abs(columns.mean() - 32) < 5
    rows, columns = np.nonzero(is_green(picture))
    assert rows.min() > picture.shape[0] * 0.4
    assert columns.min() > 32


def test_the_studio_shows_the_given_objects(path_morph, tmp_path):
    bpy.context.scene.frame_set(15)
    before = snapshot()
    visible = [obj for obj in path_morph.objects if not obj.hide_render]
    picture = photographed(visible, tmp_path / "still.png", (64, 48), SAMPLES)
    assert picture.shape == (48, 64, 3)
    assert is_green(picture).sum() > 200
    assert not is_red(picture).any()
    assert snapshot() == before


def test_objects_with_hidden_parents_are_shown_in_place(collection, tmp_path):
    anchor = bpy.data.objects.new("Anchor", None)
    anchor.location = (100.0, 0.0, 0.0)
    obj = cube(collection, 0, 1, size=0.01)
    obj.parent = anchor
    picture = photographed([obj], tmp_path / "still.png", (32, 32), SAMPLES)
    assert is_red(picture).mean() > 0.1


def test_sheared_objects_are_shown_as_they_are(collection, tmp_path):
    """A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give."""
    parent, obj = bpy.data.objects.new("Stretch", None), cube(collection, 0, 1)
    parent.scale.x, obj.parent, obj.rotation_euler.y = 3.0, parent, 0.6
    before = snapshot()
    shown = photographed([obj], tmp_path / "sheared.png", (64, 48), SAMPLES)
    assert snapshot() == before
    obj.data.transform(world_matrix(obj))
    obj.parent, obj.rotation_euler.y = None, 0.0
    expected = photographed([obj], tmp_path / "plain.png", (64, 48), SAMPLES)
    assert (is_red(shown) == is_red(expected)).mean() > 0.99


def test_animation_shows_all_frames(path_morph, tmp_path):
    before = snapshot()
    found = recorded(render_animation(path_morph, tmp_path / "morph {blend} #.mp4", resolution=(64, 48), samples=1))
    path, reports = found.result, [report.fraction for report in found.reports]
    assert snapshot() == before
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    assert reports == sorted(reports)
    assert reports[-1] == 1.0
    clip = bpy.data.movieclips.load(str(path))
    assert tuple(clip.size) == (64, 48)
    # Frames 11 to 15, and ten more of the first and the last one.
    assert clip.frame_duration == 5 + 2 * 10
    bpy.data.movieclips.remove(clip)


def test_animation_can_be_stopped(path_morph, tmp_path):
    before = snapshot()
    work = render_animation(path_morph, tmp_path / "morph.mp4", resolution=(16, 16), samples=1)
    while next(work).fraction <= 0.0:
        pass
    work.close()
    assert snapshot() == before
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("render", "name"),
    [(render_contact_sheet, "sheet.png"), (render_animation, "morph.mp4")],
)
def test_output_is_checked_before_rendering(path_morph, tmp_path, render, name):
    with pytest.raises(InputError, match="does not exist; create it first"):
        drained(render(path_morph, tmp_path / "missing" / name))
    with pytest.raises(InputError, match="file name that ends with"):
        drained(render(path_morph, tmp_path / "picture.xyz"))


def test_invalid_pictures_are_refused(collection, tmp_path):
    for render, name in ((render_contact_sheet, "a.png"), (render_animation, "a.mp4")):
        with pytest.raises(InputError):
            drained(render(collection, tmp_path / name))


def test_animation_of_a_sheet_is_refused(sheet_morph, tmp_path):
    with pytest.raises(InputError, match="contact sheet"):
        drained(render_animation(sheet_morph, tmp_path / "a.mp4"))


def test_studio_vanishes_after_an_error(path_morph):
    before = snapshot()
    with pytest.raises(ConvwassError), Studio() as studio:
        studio.show(path_morph.objects[0])
        raise ConvwassError("Something went wrong.")
    assert snapshot() == before


def test_without_a_denoiser_more_light_is_followed(path_morph, tmp_path, monkeypatch):
    monkeypatch.setattr("_cycles.with_openimagedenoise", False)
    visible = [obj for obj in path_morph.objects if not obj.hide_render]
    picture = photographed(visible, tmp_path / "still.png", (32, 32), 1)
    assert 0.9 < picture[:2].mean() < 0.985
    with Studio() as studio:
        studio.set_quality((8, 8), 3)
        assert studio.scene.cycles.samples > 3


def test_without_cycles_the_message_tells_how_to_enable_it():
    class Render:
        @property
        def engine(self):
            return "BLENDER_EEVEE"

        @engine.setter
        def engine(self, name):
            raise TypeError(f'enum "{name}" not found')

    with pytest.raises(ConvwassError, match="Preferences > Add-ons"):
        choose_cycles(SimpleNamespace(render=Render()))


@pytest.mark.parametrize("turn", [0.0, 1.0])
def test_orbit_frames_all_points_tightly(turn):
    points = np.random.default_rng(3).uniform([-3.0, -1.0, 5.0], [4.0, 2.0, 9.0], (500, 3))
    views = [View(0.4 + angle, 0.3) for angle in (-turn / 2.0, turn / 2.0)]
    tangents = (0.2, 0.15)
    filled = []
    for pose in orbit(points, views, tangents):
        right, up, backward = ((points - pose.position) @ pose.view.axes.T).T
        filled += [np.abs(right / backward).max() / tangents[0], np.abs(up / backward).max() / tangents[1]]
    assert max(filled) == pytest.approx(1.0)
