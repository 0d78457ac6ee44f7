# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in files: values are preserved, and nothing is left behind."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.files.image_files import (
    ImageFormat,
    drawn_image,
    files_in_frame,
    opened_image,
    pixel_values,
    write_image,
)
from convwass_addon.bridge.nodes.node_math import new_node
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.errors import ConvwassError, InputError

PIXELS = np.random.default_rng(0).random((4, 6, 4), dtype=np.float32)
PIXELS[..., 3] = 1.0


@pytest.mark.parametrize(
    ("name", "how", "step"),
    [
        ("a.exr", ImageFormat("OPEN_EXR", "RGB", "32"), 0.0),
        ("a.png", ImageFormat("PNG", "RGB", "16"), 1 / 65535),
        ("a.PNG", ImageFormat("PNG", "RGB", "8"), 1 / 255),
        ("a.jpg", ImageFormat("JPEG", "BW", "8"), 2 / 255),
    ],
)
def test_values_come_back(tmp_path, inventory, name, how, step):
    pixels = PIXELS.copy()
    if how.color_mode == "BW":
        pixels[..., :3] = 0.25
    before = inventory()
    with drawn_image(pixels, "Non-Color") as image:
        write_image(image, tmp_path / name, how)
    with opened_image(str(tmp_path / name)) as image:
        image.colorspace_settings.name = "Non-Color"
        assert tuple(image.size) == (6, 4)
        np.testing.assert_allclose(pixel_values(image)[..., :3], pixels[..., :3], atol=step + 1e-6)
    assert inventory() == before
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_bytes(tmp_path):
    with drawn_image(PIXELS, is_float=False) as image:
        assert not image.is_float
        write_image(image, tmp_path / "a.png", ImageFormat("PNG", "RGBA", "8"))
    with opened_image(tmp_path / "a.png") as image:
        np.testing.assert_allclose(pixel_values(image), PIXELS, atol=1.01 / 255)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(InputError, match="There is no file"), opened_image(tmp_path / "none.png"):
        pass
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(InputError, match="There is no file"), opened_image(tmp_path / "folder.png"):
        pass
    assert not bpy.data.images


def test_failed_writing_leaves_nothing_behind(tmp_path, inventory):
    (tmp_path / "taken.png").mkdir()
    before = inventory()
    with pytest.raises(ConvwassError, match="could not be written"), drawn_image(PIXELS) as image:
        write_image(image, tmp_path / "taken.png", ImageFormat("PNG", "RGB", "8"))
    assert inventory() == before
    assert [path.name for path in tmp_path.iterdir()] == ["taken.png"]


@pytest.fixture
def loaded_texture(tmp_path, make_object):
    """A function that writes files and returns an image texture of the first one, on an object."""

    def load(source, *names):
        for name in names:
            with drawn_image(PIXELS) as image:
                write_image(image, tmp_path / name, ImageFormat("PNG", "RGB", "8"))
        image = bpy.data.images.load(str(tmp_path / names[0]))
        image.source = source
        material = bpy.data.materials.new("Showing")
        make_object("Canvas").data.materials.append(material)
        return new_node(own_tree(material), "ShaderNodeTexImage", image=image)

    return load


@pytest.mark.parametrize("is_cyclic", [False, True])
@pytest.mark.parametrize(("count", "start", "offset"), [(4, 3, 10), (0, 1, 2), (1, 1, -5), (4, -3, -2)])
def test_files_of_sequences_are_those_that_blender_reads(loaded_texture, is_cyclic, count, start, offset):
    node = loaded_texture("SEQUENCE", "wave_005.png")
    user = node.image_user
    user.frame_duration, user.frame_start, user.frame_offset, user.use_cyclic = count, start, offset, is_cyclic
    user.use_auto_refresh = True
    for frame in (-9, -6, 0, 1, 2, 3, 4, 6, 7, 11):
        bpy.context.scene.frame_set(frame)
        material = bpy.data.materials["Showing"].evaluated_get(bpy.context.evaluated_depsgraph_get())
        expected = node.image.filepath_from_user(image_user=material.node_tree.nodes[node.name].image_user)
        assert [str(file) for file in files_in_frame(node.image, user, frame)] == [expected]


@pytest.mark.parametrize(
    ("token", "names"),
    [("<UDIM>", ("wood.1001.png", "wood.1013.png")), ("<UVTILE>", ("wood.u1_v1.png", "wood.u3_v2.png"))],
)
def test_every_tile_has_a_file_until_it_is_packed(loaded_texture, tmp_path, token, names):
    node = loaded_texture("TILED", *names)
    node.image.filepath = str(tmp_path / f"wood.{token}.png")
    if 1013 not in [tile.number for tile in node.image.tiles]:
        node.image.tiles.new(1013)
    assert files_in_frame(node.image, node.image_user, 1) == [tmp_path / name for name in names]
    node.image.pack()
    assert files_in_frame(node.image, node.image_user, 1) == []


def test_generated_and_edited_images_have_no_file(loaded_texture, tmp_path):
    node = loaded_texture("FILE", "wood.png")
    assert files_in_frame(node.image, node.image_user, 1) == [tmp_path / "wood.png"]
    node.image.pixels[0] = 0.5
    assert files_in_frame(node.image, node.image_user, 1) == []
    for is_tiled in (False, True):
        image = bpy.data.images.new("Made", 4, 4, tiled=is_tiled)
        assert files_in_frame(image, node.image_user, 1) == []
