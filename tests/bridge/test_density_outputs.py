# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities as vertex groups, color attributes, images and materials."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.densities.density_images import (
    ImageSettings,
    kept_files_notices,
    remember_images,
    write_step_images,
)
from convwass_addon.bridge.densities.density_material import GROWTHS, growth_material, heat_material
from convwass_addon.bridge.densities.density_nodes import NAME, color_name
from convwass_addon.bridge.densities.density_outputs import (
    show_heat_colors,
    step_name,
    write_step_colors,
    write_step_groups,
)
from convwass_addon.bridge.densities.density_player import animate_density, density_value, remove_density
from convwass_addon.bridge.densities.density_store import DENSITIES_KEY, stored_density
from convwass_addon.bridge.heat_map import heat_colors, heat_stops
from convwass_addon.bridge.vertex_groups import group_names, read_group, read_groups, write_group
from convwass_addon.errors import InputError
from tests.pictures import pixels_in

DENSITIES = np.array([[0, 0, 4.0, 1, 2, 3], [8, 0, 0, 0, 0, 0], [1, 2, 1, 2, 1, 2]])


@pytest.fixture
def obj(make_object):
    return make_object("A")


@pytest.fixture
def quad(make_object):
    """Make a square of two by two, unwrapped to the lower left quarter of the texture, as a single polygon."""
    corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)]
    obj = make_object("Quad", corners, faces=[(0, 1, 2, 3)])
    layer = obj.data.uv_layers.new(name="Map")
    layer.uv.foreach_set("vector", np.array(corners, np.float32)[:, :2].ravel() / 4)
    return obj


def colors_of(obj, name):
    return np.array([item.color for item in obj.data.attributes[name].data])


def pixels_of(path):
    """Read an image from below to above, its first channel."""
    return pixels_in(path, as_data=True)[..., 0]


def test_one_group_for_each_step(obj):
    obj.vertex_groups.new(name="Own")
    names = write_step_groups(obj, DENSITIES)
    assert names == ["Density.000", "Density.001", "Density.002"]
    assert group_names(obj) == ["Own", *names]
    np.testing.assert_allclose(read_groups(obj, names), DENSITIES / 8)
    write_step_groups(obj, DENSITIES[:2] / 3)
    assert group_names(obj) == ["Own", *names[:2]]
    assert stored_density(obj, NAME).outputs == {"groups": names[:2]}
    np.testing.assert_allclose(read_groups(obj, names[:2]), DENSITIES[:2] / 8, rtol=1e-6)


def test_painted_groups_stop_all(obj):
    write_group(obj, "Density.001", np.full(6, 0.5))
    with pytest.raises(InputError, match=r"A already has a vertex group Density\.001 that is no result"):
        write_step_groups(obj, DENSITIES)
    assert group_names(obj) == ["Density.001"]
    np.testing.assert_array_equal(read_group(obj, "Density.001"), 0.5)


def test_groups_of_a_removed_density_are_replaced(obj):
    animate_density(obj, DENSITIES, [0, 0.5, 1])
    names = write_step_groups(obj, DENSITIES)
    remove_density(obj)
    write_step_groups(obj, DENSITIES[::-1])
    np.testing.assert_allclose(read_groups(obj, names), DENSITIES[::-1] / 8)


def test_a_locked_group_stops_all(obj):
    write_step_groups(obj, DENSITIES)
    obj.vertex_groups["Density.002"].lock_weight = True
    with pytest.raises(InputError, match=r"The group Density.002 is locked"):
        write_step_groups(obj, DENSITIES[::-1])
    np.testing.assert_allclose(read_groups(obj, ["Density.000"])[0], DENSITIES[0] / 8)


def test_one_color_attribute_for_each_step(obj):
    obj.data.attributes.new("mark", "INT", "POINT")
    names = write_step_colors(obj, DENSITIES)
    assert names == [f"{step_name(NAME, step)} color" for step in range(3)]
    for name, density in zip(names, DENSITIES, strict=True):
        np.testing.assert_allclose(colors_of(obj, name), heat_colors(density / 8), atol=6e-3)
    assert obj.data.color_attributes.active_color.name == names[0]
    write_step_colors(obj, DENSITIES[1])
    assert obj.data.color_attributes.keys() == names[:1]
    assert "mark" in obj.data.attributes


@pytest.mark.parametrize("kind", ["attribute", "group"])
def test_other_attributes_and_groups_stop_all(obj, kind):
    animate_density(obj, DENSITIES, [0, 0.5, 1])
    for name in ("Density.001 color", "Density color"):
        if kind == "attribute":
            obj.data.attributes.new(name, "FLOAT", "POINT")
        else:
            obj.vertex_groups.new(name=name)
    before = obj.data.attributes.keys()
    with pytest.raises(InputError, match=r"A has an attribute or vertex group Density\.001 color of another kind"):
        write_step_colors(obj, DENSITIES)
    with pytest.raises(InputError, match=r"A has an attribute or vertex group Density color of another kind"):
        show_heat_colors(obj)
    assert obj.data.attributes.keys() == before


def test_heat_colors_at_every_frame(obj):
    animate_density(obj, DENSITIES, [0, 0.5, 1])
    show_heat_colors(obj)
    density_value(obj).set(0.75)
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert mesh.color_attributes.active_color.name == color_name(NAME)
    seen = np.array([item.color for item in mesh.color_attributes.active_color.data])
    np.testing.assert_allclose(seen, heat_colors((DENSITIES[1] + DENSITIES[2]) / 16), atol=6e-3)


def test_removing_a_density_removes_its_colors(obj):
    attributes = obj.data.attributes.keys()
    animate_density(obj, DENSITIES, [0, 0.5, 1])
    show_heat_colors(obj)
    remove_density(obj)
    assert obj.data.attributes.keys() == attributes


def test_colors_get_brighter_evenly():
    luminance = heat_colors(np.linspace(0, 1, 50))[:, :3] @ (0.2126, 0.7152, 0.0722)
    assert (np.diff(luminance) > 0).all()
    lightness = np.cbrt(heat_stops()[:, :3] @ (0.2126, 0.7152, 0.0722))
    steps = np.diff(lightness)
    assert steps.max() < 2.5 * steps.min()
    np.testing.assert_array_equal(heat_colors([-1, 2]), heat_stops()[[0, -1]])


@pytest.mark.parametrize(("file_format", "step"), [("PNG", 1 / 65535), ("OPEN_EXR", 1e-6)])
def test_images_hold_the_values(quad, tmp_path, inventory, file_format, step):
    frames = np.array([[0, 3.0, 5, 2], [1, 1, 1, 1]])
    settings = ImageSettings(size=64, margin=0, file_format=file_format)
    before = inventory()
    paths = list(write_step_images(quad, frames, tmp_path / "out", "my/name", settings))
    assert inventory() == before
    suffix = {"PNG": ".png", "OPEN_EXR": ".exr"}[file_format]
    assert [path.name for path in paths] == [f"my_name.0000{suffix}", f"my_name.0001{suffix}"]
    assert sorted((tmp_path / "out").iterdir()) == paths
    scale = 5.0 if file_format == "PNG" else 1.0
    flat = pixels_of(paths[1])
    np.testing.assert_allclose(flat[:32, :32], 1 / scale, atol=step)
    assert not flat[32:].any()
    assert not flat[:, 32:].any()
    # The polygon's two triangles share the corners 0 and 2, or 1 and 3; their values show which.
    x, y = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(32) + 0.5) / 32)
    ways = (
        np.where(y <= x, 3 * x + 2 * y, 2 * y + 3 * x),
        np.where(x + y <= 1, 3 * x + 2 * y, 5 - 3 * (1 - y) - 2 * (1 - x)),
    )
    seen = pixels_of(paths[0])[:32, :32] * scale
    assert min(np.abs(seen - way).max() for way in ways) < 2 * scale * step


def test_margins(quad, tmp_path):
    settings = ImageSettings(size=64, margin=4)
    (path,) = write_step_images(quad, np.ones(4), tmp_path, settings=settings)
    seen = pixels_of(path)
    assert (seen[:36, 20] > 0.99).all()
    assert not seen[36:].any()


def test_images_next_to_the_file(quad, tmp_path):
    with pytest.raises(InputError, match="Save the file first"):
        write_step_images(quad, np.ones(4), "//images")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "file.blend"))
    (path,) = write_step_images(bpy.data.objects["Quad"], np.ones(4), "//images", settings=ImageSettings(size=8))
    assert path == tmp_path / "images" / "Density.0000.png"
    assert path.is_file()


def test_old_images_are_replaced_only_by_complete_ones(quad, tmp_path, monkeypatch):
    settings = ImageSettings(size=8)
    (path,) = write_step_images(quad, np.ones(4), tmp_path, settings=settings)
    remember_images(quad, "Density", [path])
    before = path.read_bytes()
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(Exception, match="could not be written: disk full"):
        list(write_step_images(quad, np.zeros(4), tmp_path, settings=settings))
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == before


def test_images_of_another_blend_file_are_not_replaced(quad, tmp_path):
    """The other file is a copy of this one, or has nothing to do with it."""
    settings, folder = ImageSettings(size=8), tmp_path / "images"

    def written(values):
        obj = bpy.data.objects["Quad"]
        (path,) = write_step_images(obj, np.array(values), folder, settings=settings)
        remember_images(obj, "Density", [path])
        return path

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "first.blend"))
    written([0.0, 0, 0, 1])
    path = written([1.0, 0, 0, 1])
    before = path.read_bytes()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "second.blend"))
    for number in (1, 2):
        own = folder / f"Density_{number:03d}" / path.name
        for values in ([1.0, 1, 1, 1], [0.0, 1, 1, 1]):
            assert written(values) == own
            assert path.read_bytes() == before
        bpy.data.objects["Quad"].pop(DENSITIES_KEY, None)


def test_images_can_be_baked_again_after_undo_and_saving_under_another_name(quad, tmp_path):
    settings, folder = ImageSettings(size=8), tmp_path / "images"
    first = list(write_step_images(quad, np.eye(4), folder, settings=settings))
    before = [path.read_bytes() for path in first]
    for number in (1, 2):
        # Undo takes back what is stored with the object, but not the files.
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / f"v{number:03d}.blend"))
        obj = bpy.data.objects["Quad"]
        made = list(write_step_images(obj, np.eye(4), folder, settings=settings))
        remember_images(obj, "Density", made)
        assert [path.parent for path in made] == [folder / f"Density_{number:03d}"] * 4
        (notice,) = kept_files_notices(str(folder), made)
        assert f"{folder} contains other files of these names (4)" in str(notice)
    assert [path.read_bytes() for path in first] == before
    assert kept_files_notices(str(folder), first) == []


def test_images_are_replaced_when_they_were_moved_with_their_file(quad, tmp_path):
    (tmp_path / "old").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old" / "file.blend"))
    settings = ImageSettings(size=8)
    remember_images(quad, "Density", list(write_step_images(quad, np.ones(4), "//images", settings=settings)))
    bpy.ops.wm.save_mainfile()
    (tmp_path / "old").rename(tmp_path / "new")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "new" / "file.blend"))
    (path,) = write_step_images(bpy.data.objects["Quad"], np.ones(4), "//images", settings=settings)
    assert path == tmp_path / "new" / "images" / "Density.0000.png"


def test_the_map_of_renders_or_one_by_name(quad, tmp_path):
    other = quad.data.uv_layers.new(name="Other")
    other.uv.foreach_set("vector", np.full(8, 7, np.float32))
    settings = ImageSettings(size=8, uv_map="Other")
    with pytest.raises(InputError, match="The UV map Other of Quad covers no pixel"):
        write_step_images(quad, np.ones(4), tmp_path, settings=settings)
    assert len(list(write_step_images(quad, np.ones(4), tmp_path, settings=ImageSettings(size=8)))) == 1
    with pytest.raises(InputError, match="Quad has no UV map Third; it has: Map, Other"):
        write_step_images(quad, np.ones(4), tmp_path, settings=ImageSettings(uv_map="Third"))


def test_meshes_without_texture_coordinates(obj, tmp_path):
    with pytest.raises(InputError, match="A has no UV map; unwrap it in Edit Mode"):
        write_step_images(obj, np.ones(6), tmp_path)


@pytest.mark.parametrize("place", ["missing/deep", "file", "file/deep"])
def test_folders_that_cannot_be(quad, tmp_path, place):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="folder"):
        write_step_images(quad, np.ones(4), tmp_path / place)


def test_edit_mode(quad, tmp_path):
    bpy.context.view_layer.objects.active = quad
    bpy.ops.object.mode_set(mode="EDIT")
    for write in (write_step_groups, write_step_colors):
        with pytest.raises(InputError, match="Quad is in Edit Mode"):
            write(quad, np.ones(4))
    with pytest.raises(InputError, match="Quad is in Edit Mode"):
        write_step_images(quad, np.ones(4), tmp_path)


@pytest.mark.parametrize("densities", [np.ones((2, 5)), -np.ones((2, 6)), np.full(6, np.inf), np.ones((0, 6))])
def test_arrays_that_do_not_fit(obj, densities):
    with pytest.raises(ValueError, match="densities"):
        write_step_groups(obj, densities)


def rendered(scene, path):
    """Return the mean color of a render from above, in display space."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    scene.render.resolution_x = scene.render.resolution_y = 16
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
    if scene.camera is None:
        scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 1.8
        scene.camera.location = (1, 1, 5)
        scene.collection.objects.link(scene.camera)
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        sun.data.energy, sun.rotation_euler = 4, (0.9, 0, 0)
        scene.collection.objects.link(sun)
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return pixels_in(path)[..., :3].mean(axis=(0, 1))


@pytest.mark.parametrize("kind", ["HEAT", *GROWTHS])
def test_materials_follow_the_density_in_renders(quad, bare_scene, tmp_path, kind):
    animate_density(quad, [[0, 0, 0, 0], [1, 1, 1, 1]], [0, 1])
    quad.data.materials.append(heat_material() if kind == "HEAT" else growth_material(kind=kind, color=(0.5, 0, 0, 1)))
    seen = {}
    for value in (0.0, 1.0):
        density_value(quad).set(value)
        seen[value] = rendered(bare_scene, tmp_path / "frame.png")
    if kind == "HEAT":
        assert seen[0.0].max() < 0.3
        assert seen[1.0].min() > 0.6
    else:
        red, green, _ = seen[0.0]
        assert red > 0.6
        assert green < 0.3
        assert seen[1.0][1] > seen[0.0][1] + 0.05
        assert seen[1.0][1] >= seen[1.0][0]


def test_heat_materials_are_shared():
    assert heat_material() == heat_material()
    assert heat_material("other") != heat_material()
