# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies as images, files and worlds, with correct values and directions in Cycles."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from hypothesis import given, strategies as st

from convwass_addon.applications.skies.lamps import split_lamps
from convwass_addon.applications.skies.sky_images import light_of
from convwass_addon.applications.skies.sky_settings import SkySettings
from convwass_addon.bridge.keyframes import curves_of, interpolate
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.skies import sky_sequence, world_skies
from convwass_addon.bridge.skies.sky_pixels import read_sky, read_sky_file, resized, turned, write_sky
from convwass_addon.bridge.skies.sky_sequence import PlacedSky, SkyFiles, fitting_height, sky_steps
from convwass_addon.bridge.skies.world_skies import sequence_world, shown_files, world_sky
from convwass_addon.errors import ConvwassError, InputError
from convwass_addon.progress import payloads
from tests.lights import sky
from tests.reroutes import with_reroutes


def test_a_sky_survives_a_file(tmp_path):
    image = np.random.default_rng(1).random((16, 32, 3), np.float32) * 1e5
    write_sky(tmp_path / "a.exr", image)
    np.testing.assert_allclose(read_sky_file(tmp_path / "a.exr"), image, rtol=1e-6)
    assert [item.name for item in tmp_path.iterdir()] == ["a.exr"]
    assert not bpy.data.images


def test_columns_are_turned_there_and_back():
    image = np.random.default_rng(1).random((4, 8, 3), np.float32)
    np.testing.assert_array_equal(turned(turned(image)), image)


@given(st.integers(1, 24), st.integers(1, 24))
def test_another_size_has_the_same_light(before, after):
    image = np.random.default_rng(before).random((before, 2 * before, 3))
    np.testing.assert_allclose(light_of(resized(image, after)), light_of(image), rtol=1e-10)


@given(st.integers(1, 24), st.integers(1, 24))
def test_a_uniform_sky_is_uniform_in_another_size(before, after):
    np.testing.assert_allclose(resized(np.full((before, 2 * before, 3), 0.7), after), 0.7)


def test_cycles_renders_files_with_correct_direction_and_brightness(tmp_path):
    """A lamp towards +Y, a little up: rendered from a world, it is read there."""
    image = sky((0, 1, 0.3), rows=32)
    write_sky(tmp_path / "sky.0001.exr", image)
    world = sequence_world("Shown", [tmp_path / "sky.0001.exr"], 1)
    seen = world_sky(world, 32)
    np.testing.assert_allclose(light_of(seen), light_of(image), rtol=0.01)
    assert np.unravel_index(seen[..., 0].argmax(), (32, 64)) == np.unravel_index(image[..., 0].argmax(), (32, 64))
    far = seen.max(axis=2) < 3.0
    np.testing.assert_allclose(seen[far], image[far], atol=0.05)


def test_a_world_with_a_plain_image_is_read_and_not_rendered(tmp_path, monkeypatch):
    image = sky((1, 0, 1), rows=32)
    write_sky(tmp_path / "a.exr", image)
    world = sequence_world("Plain", [tmp_path / "a.exr"], 1)
    next(node for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT").image.source = "FILE"
    np.testing.assert_allclose(world_sky(world, 32), image, rtol=1e-6)
    with_reroutes(world.node_tree)
    monkeypatch.setattr(world_skies, "_rendered", None)
    np.testing.assert_allclose(world_sky(world, 32), image, rtol=1e-6)


def test_every_frame_shows_its_file_and_the_ends_stay_on(tmp_path):
    files = [tmp_path / f"sky.{frame:04d}.exr" for frame in (4, 5, 6)]
    for value, path in enumerate(files, 1):
        write_sky(path, np.full((8, 16, 3), value, np.float32))
    world = sequence_world("Frames", files, 4)
    for frame, value in ((5, 2), (20, 3)):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(world_sky(world, 8), value, atol=1e-3)
    assert sequence_world("Frames", files, 4) == world
    assert [image.name for image in bpy.data.images if image.source != "VIEWER"] == ["Frames"]


def test_skies_before_frame_0_are_numbered_from_0(tmp_path):
    files = SkyFiles(tmp_path, -2, 4)
    for value, path in enumerate(files.paths, 1):
        write_sky(path, np.full((8, 16, 3), value, np.float32))
    assert [path.name for path in files.paths] == [f"sky.000{number}.exr" for number in range(4)]
    world = sequence_world("Early", files.paths, -2)
    assert shown_files(world) == set(files.paths)
    for frame, value in ((-5, 1), (-2, 1), (-1, 2), (1, 4), (9, 4)):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(world_sky(world, 8), value, atol=1e-3)


def test_an_animated_world_is_read_as_it_is_now_with_time_stretching(bare_scene):
    world = bpy.data.worlds.new("Brightening")
    tree = own_tree(world)
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value, strength = (1, 1, 1, 1), background.inputs["Strength"]
    for time in (0, 20):
        strength.default_value = time
        strength.keyframe_insert("default_value", frame=time)
    interpolate(curves_of(tree))
    bare_scene.render.frame_map_old, bare_scene.render.frame_map_new = 100, 400
    bare_scene.frame_set(26, subframe=0.5)
    np.testing.assert_allclose(world_sky(world, 8), 26.5 / 4, rtol=1e-4)


def test_the_image_of_another_file_stays_as_it_is(tmp_path):
    """It is shown by a world that was linked and then made local."""
    for name in ("there.0001.exr", "here.0001.exr"):
        write_sky(tmp_path / name, np.ones((8, 16, 3), np.float32))
    world = sequence_world("Sky", [tmp_path / "there.0001.exr"], 1)
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {world})
    bpy.data.worlds.remove(world)
    bpy.data.batch_remove(bpy.data.images)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.worlds = ["Sky"]
    linked = next(node.image for node in wanted.worlds[0].node_tree.nodes if node.type == "TEX_ENVIRONMENT")
    world = wanted.worlds[0].make_local()
    assert sequence_world("Sky", [tmp_path / "here.0001.exr"], 1) == world
    shown = next(node.image for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT")
    assert shown.library is None and bpy.path.basename(shown.filepath) == "here.0001.exr"
    assert bpy.path.basename(linked.filepath) == "there.0001.exr"


def test_the_sun_of_the_middle_is_on_the_great_circle():
    steps = list(sky_steps([sky((1, 0, 0.4)), sky((0, 1, 0.4))], 3, SkySettings()))
    frames = [step.payload.frame for step in steps if step.payload is not None]
    assert [frame.time for frame in frames] == [0.0, 0.5, 1.0]
    first, middle, last = (frame.lamps[0].direction for frame in frames)
    expected = (first + last) / np.linalg.norm(first + last)
    np.testing.assert_allclose(middle, expected, atol=1e-6)
    lights = [light_of(frame.image.astype(float)) for frame in frames]
    np.testing.assert_allclose(lights[1], (lights[0] + lights[2]) / 2, rtol=5e-3)


def test_the_way_leads_through_every_sky():
    ends = [sky((1, 0, 0.4)), sky((0, 1, 0.4)), sky((0, 1, 1.2))]
    steps = list(sky_steps(ends, 5, SkySettings(rows=32)))
    frames = [step.payload.frame for step in steps if step.payload is not None]
    assert [step.fraction for step in steps] == sorted(step.fraction for step in steps)
    for frame, end in zip(frames[::2], ends, strict=True):
        np.testing.assert_array_equal(frame.image, end)
    assert abs(frames[3].lamps[0].direction[0]) < np.pi / 64


def test_images_that_are_no_sky_are_refused(tmp_path):
    with pytest.raises(InputError, match="twice as wide"):
        read_sky(bpy.data.images.new("Square", 8, 8))
    with pytest.raises(InputError, match="There is no file"):
        read_sky_file(tmp_path / "none.exr")
    (tmp_path / "a.exr").write_bytes(b"nonsense")
    with pytest.raises(InputError):
        read_sky_file(tmp_path / "a.exr")


@pytest.mark.parametrize(
    ("space", "expected"), [("sRGB", 0.21404), ("Linear Rec.709", 0.5), ("Non-Color", 0.5), ("AgX Base sRGB", None)]
)
def test_bytes_are_read_in_their_color_space_or_refused(space, expected):
    image = bpy.data.images.new("Bytes", 8, 4)
    image.colorspace_settings.name = space
    image.pixels.foreach_set(np.full(4 * 32, 0.5, np.float32))
    if expected is None:
        with pytest.raises(InputError, match="is in the color space AgX Base sRGB"):
            read_sky(image)
    else:
        np.testing.assert_allclose(read_sky(image), expected, atol=0.003)


def test_without_cycles_a_world_is_refused_with_advice(monkeypatch):
    def refuse(scene):
        raise ConvwassError("Pictures need the Cycles render engine; switch it on.")

    world, scenes = bpy.data.worlds.new("Gray"), list(bpy.data.scenes)
    monkeypatch.setattr(world_skies, "choose_cycles", refuse)
    with pytest.raises(ConvwassError, match="need the Cycles"):
        world_sky(world, 8)
    assert list(bpy.data.scenes) == scenes


def test_folders_that_cannot_be_used_are_refused(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="is a file"):
        SkyFiles(tmp_path / "file", 1, 2)
    with pytest.raises(InputError, match="does not exist"):
        SkyFiles(tmp_path / "no" / "where", 1, 2)
    with pytest.raises(InputError, match="Save the file first"):
        SkyFiles("//skies", 1, 2)


def written(folder, first=7):
    """Write two frames, but do not finish."""
    files = SkyFiles(folder, first, 2)
    for made in payloads(sky_steps([sky((1, 0, 1)), sky((0, 1, 1))], 2, SkySettings(rows=32)), PlacedSky):
        files.write(made)
    return files


def test_numbers_have_the_same_digits(tmp_path):
    assert [path.name for path in SkyFiles(tmp_path, 9999, 2).paths] == ["sky.09999.exr", "sky.10000.exr"]
    assert [path.name for path in SkyFiles(tmp_path, 9998, 2).paths] == ["sky.9998.exr", "sky.9999.exr"]


def test_files_appear_together(tmp_path):
    files = written(tmp_path / "new")
    assert not [item for item in (tmp_path / "new").iterdir() if not item.name.startswith(".")]
    files.finish()
    assert sorted(item.name for item in (tmp_path / "new").iterdir()) == ["sky.0007.exr", "sky.0008.exr"]
    files.discard()
    assert len(list((tmp_path / "new").iterdir())) == 2


def test_written_files_are_discarded_with_their_folder(tmp_path):
    written(tmp_path / "new").discard()
    assert not list(tmp_path.iterdir())


def test_older_files_are_kept_when_new_ones_are_discarded(tmp_path):
    for name in ("sky.0007.exr", "sky.0008.exr", "note.txt"):
        (tmp_path / name).write_text(name)
    written(tmp_path).discard()
    assert {item.name: item.read_text() for item in tmp_path.iterdir()} == {
        name: name for name in ("sky.0007.exr", "sky.0008.exr", "note.txt")
    }


def test_a_file_that_cannot_be_replaced_is_reported(tmp_path):
    (tmp_path / "sky.0008.exr").mkdir()
    files = written(tmp_path)
    with pytest.raises(ConvwassError, match=r"sky.0008.exr could not be written"):
        files.finish()
    files.discard()
    assert sorted(item.name for item in tmp_path.iterdir()) == ["sky.0008.exr"]


def test_a_folder_that_cannot_be_created_is_reported_and_discarding_is_silent(tmp_path):
    (tmp_path / "gone").mkdir()
    files = SkyFiles(tmp_path / "gone" / "new", 1, 2)
    (tmp_path / "gone").rmdir()
    _, second = payloads(sky_steps([sky((1, 0, 1)), sky((0, 1, 1))], 2, SkySettings(rows=32)), PlacedSky)
    with pytest.raises(ConvwassError, match=r"sky.0002.exr could not be written"):
        files.write(second)
    files.discard()
    assert not list(tmp_path.iterdir())


def test_nothing_is_replaced_until_every_file_is_complete(tmp_path, monkeypatch):
    """The second draft is cut off: the first one does not take its place either."""
    for name in ("sky.0007.exr", "sky.0008.exr"):
        (tmp_path / name).write_text("older")

    def cut(path, image):
        path.write_bytes(b"" if image.sum() > whole.sum() else b"whole")

    whole = sky((1, 0, 1))
    monkeypatch.setattr(sky_sequence, "write_sky", cut)
    files = SkyFiles(tmp_path, 7, 2)
    for place, image in enumerate((whole, 2.0 * whole)):
        files.write(PlacedSky(place, SimpleNamespace(image=image)))
    with pytest.raises(ConvwassError, match=r"sky.0008.exr could not be written"):
        files.finish()
    files.discard()
    assert {item.name: item.read_text() for item in tmp_path.iterdir()} == {
        "sky.0007.exr": "older",
        "sky.0008.exr": "older",
    }


def plain_world(tmp_path):
    """A world with a sun, by an image that is read and not rendered."""
    image = sky((1, 0, 1), rows=32)
    write_sky(tmp_path / "a.exr", image)
    world = sequence_world("Plain", [tmp_path / "a.exr"], 1)
    texture = next(node for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT")
    texture.image.source = "FILE"
    return world, texture


@pytest.mark.parametrize("what", ["texture", "background", "link"])
def test_muted_nodes_are_ignored(tmp_path, what):
    world, texture = plain_world(tmp_path)
    background = texture.outputs["Color"].links[0].to_node
    if what == "link":
        background.inputs["Color"].links[0].is_muted = True
        background.inputs["Color"].default_value = (0.25, 0.25, 0.25, 1.0)
    else:
        (texture if what == "texture" else background).mute = True
    seen = world_sky(world, 32)
    assert seen.max() < 2.0
    if what == "link":
        np.testing.assert_allclose(seen, 0.25, atol=0.01)


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="from Blender 5 on nodes cannot be switched off")
def test_a_world_without_its_nodes_has_one_color(tmp_path):
    world, _ = plain_world(tmp_path)
    world.use_nodes, world.color = False, (0.25, 0.5, 0.75)
    np.testing.assert_allclose(world_sky(world, 8), np.full((8, 16, 3), (0.25, 0.5, 0.75)), atol=0.01)


def test_rendering_a_world_leaves_nothing_behind():
    world = bpy.data.worlds.new("Gray")
    before = {(block.id_type, block.name) for block in bpy.data.user_map()}
    world_sky(world, 8)
    assert {(block.id_type, block.name) for block in bpy.data.user_map()} == before
    assert not world.cycles.is_property_set("sampling_method")
    world.cycles.sampling_method = "MANUAL"
    world_sky(world, 8)
    assert world.cycles.sampling_method == "MANUAL"


def test_a_linked_world_is_rendered(tmp_path):
    world = bpy.data.worlds.new("Bright")
    background = next(node for node in own_tree(world).nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (2, 1, 0, 1)
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {world})
    bpy.data.worlds.remove(world)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.worlds = ["Bright"]
    np.testing.assert_allclose(world_sky(wanted.worlds[0], 8), np.full((8, 16, 3), (2.0, 1.0, 0.0)), rtol=1e-4)


def test_the_sun_of_blenders_sky_texture_is_found():
    """Within a quarter of a pixel of 512 x 256, in a panorama that Cycles renders."""
    elevation = 12.0
    world = bpy.data.worlds.new("Sky")
    tree = own_tree(world)
    texture = tree.nodes.new("ShaderNodeTexSky")
    kinds = texture.bl_rna.properties["sky_type"].enum_items.keys()
    texture.sky_type = "MULTIPLE_SCATTERING" if "MULTIPLE_SCATTERING" in kinds else "NISHITA"
    texture.sun_elevation, texture.sun_rotation = np.radians(elevation), np.radians(20.0)
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    (lamp,), _ = split_lamps(world_sky(world, 256), SkySettings())
    # Turned by 20 degrees from +Y, clockwise as seen from above.
    turn = np.radians(90.0 - 20.0)
    up = np.radians(elevation)
    expected = np.array([np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), np.sin(up)])
    assert np.degrees(np.arccos(min(1.0, lamp.direction @ expected))) < 0.25 * 180 / 256


def test_heights_fit_the_grid():
    assert [fitting_height(width, SkySettings()) for width in (64, 512, 1000, 2048)] == [64, 256, 512, 1024]
