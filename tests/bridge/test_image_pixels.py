# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as pixels, color attributes as pictures, and both back."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.palettes.png_bytes import png_bytes
from convwass_addon.bridge.files.image_files import opened_image, pixel_values
from convwass_addon.bridge.palettes import image_files, image_pixels
from convwass_addon.bridge.palettes.color_pictures import read_colors_as_picture, write_picture_colors
from convwass_addon.errors import ConvwassError, InputError
from tests.pictures import image_of, red_image


@pytest.fixture
def noise():
    return np.random.default_rng(0).random((4, 6, 4)).astype(np.float32)


@pytest.mark.parametrize("as_floats", [False, True])
def test_pixels_are_as_blender_has_them(noise, as_floats):
    image = image_of("A", noise, as_floats=as_floats)
    picture = image_pixels.read_picture(image)
    np.testing.assert_allclose(picture.pixels, noise, atol=0.0 if as_floats else 0.5 / 255 + 1e-6)
    form = picture.pixel_format
    assert (form.encoding, form.alpha) == (("linear", "associated") if as_floats else ("srgb", "straight"))
    assert np.isinf(form.highest) == as_floats
    np.testing.assert_array_equal(form.to_rec709, np.eye(3))
    image.alpha_mode = "CHANNEL_PACKED"
    assert image_pixels.image_format(image).alpha == "ignored"


def test_color_spaces_of_bytes(noise):
    image = image_of("A", noise)
    image.colorspace_settings.name = "Linear Rec.709"
    assert image_pixels.image_format(image).encoding == "linear"
    image.colorspace_settings.name = "Linear Rec.2020"
    with pytest.raises(InputError, match="color space Linear"):
        image_pixels.image_format(image)


def test_images_without_pixels_are_refused(tmp_path, noise):
    image = image_of("A", noise)
    missing = bpy.data.images.new("Missing", 4, 4)
    missing.source, missing.filepath = "FILE", str(tmp_path / "none.png")
    with pytest.raises(InputError, match="no pixels"):
        image_pixels.read_pixels(missing)
    with pytest.raises(InputError, match="mask"):
        image_pixels.read_picture(image, image_of("Mask", np.ones((3, 3, 4))))


def test_images_with_tiles_are_refused():
    tiled = bpy.data.images.new("Skin", 4, 4, tiled=True)
    tiled.tiles.new(1002)
    with pytest.raises(InputError, match="Skin has UDIM tiles"):
        image_pixels.read_picture(tiled)


def test_masks_are_gray_values(noise):
    values = np.ones((4, 6, 4), np.float32)
    values[..., :3] = np.linspace(0, 1.2, 24).reshape(4, 6, 1)
    picture = image_pixels.read_picture(image_of("A", noise), image_of("Mask", values, as_floats=True))
    np.testing.assert_allclose(picture.mask, np.minimum(values[..., 0], 1.0), atol=1e-6)


@pytest.mark.parametrize("as_floats", [False, True])
def test_results_are_like_their_source_and_used_again(noise, as_floats):
    image = image_of("A", noise, as_floats=as_floats)
    result = image_pixels.result_image(image)
    image_pixels.write_pixels(result, noise)
    image_pixels.keep_in_file(result)
    assert result != image and result.is_float == as_floats and result.packed_file
    np.testing.assert_array_equal(pixel_values(result), pixel_values(image))
    assert image_pixels.image_format(result).encoding == image_pixels.image_format(image).encoding
    assert image_pixels.result_image(image) == result
    with pytest.raises(InputError, match="has changed since the start"):
        image_pixels.write_pixels(result, noise[:3])


@pytest.mark.parametrize("space", ["sRGB", "Linear Rec.709", "Non-Color"])
@pytest.mark.parametrize("alpha_mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
def test_packed_files_hold_the_same_pixels(noise, tmp_path, space, alpha_mode):
    """Also after reopening the .blend file; without alpha if all pixels are opaque."""
    if alpha_mode == "NONE":
        noise[..., 3] = 1.0
    image = image_of("A", np.tile(noise, (40, 3, 1)))
    image.colorspace_settings.name, image.alpha_mode = space, alpha_mode
    picture = image_pixels.read_picture(image)
    result = image_pixels.result_image(image)
    for pixels in (picture.pixels[::-1], picture.pixels):
        image_pixels.keep_in_file(result, png_bytes(pixels))
        np.testing.assert_array_equal(pixel_values(result), pixels)
    assert not result.is_dirty
    result.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    again = image_pixels.read_picture(bpy.data.images["A recolored"])
    np.testing.assert_array_equal(again.pixels, picture.pixels)
    assert again.pixel_format.encoding == picture.pixel_format.encoding


@pytest.mark.parametrize(
    ("name", "depth", "error"),
    [("a.png", "automatic", 1e-6), ("a.tif", "8", 1e-6), ("a.jpg", "automatic", 0.25), ("a.png", "16", 1e-4)],
)
def test_bytes_are_written_unchanged(tmp_path, name, depth, error):
    image = red_image()
    image_files.save_pixels(pixel_values(image), image, tmp_path / name, depth)
    with opened_image(tmp_path / name) as found:
        assert tuple(found.size) == tuple(image.size)
        form = image_pixels.image_format(found)
        wanted = form.linear(pixel_values(found))
        have = image_pixels.image_format(image).linear(pixel_values(image))
        assert np.abs(wanted - have).max() < error
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert not bpy.data.scenes.get("Recolored") and not bpy.data.images.get("Recolored")


def test_scene_values_are_written_unchanged(tmp_path, noise):
    noise[..., 3] = np.linspace(0.1, 1.0, 24).reshape(4, 6)
    noise[..., :3] *= 50.0 * noise[..., 3:]
    image = image_of("A", noise, as_floats=True)
    image_files.save_pixels(noise, image, tmp_path / "a.exr")
    with opened_image(tmp_path / "a.exr") as found:
        np.testing.assert_allclose(image_pixels.read_pixels(found), noise, rtol=1e-6)


def test_files_that_cannot_be(tmp_path, noise):
    image = image_of("A", noise)
    with pytest.raises(InputError, match="does not end like an image"):
        image_files.save_pixels(noise, image, tmp_path / "a.gif")
    with pytest.raises(InputError, match="bits a channel"):
        image_files.save_pixels(noise, image, tmp_path / "a.jpg", "16")
    (tmp_path / "taken.png").mkdir()
    with pytest.raises(ConvwassError, match="could not be written"):
        image_files.save_pixels(noise, image, tmp_path / "taken.png")
    with pytest.raises(InputError, match="no file"), opened_image(tmp_path / "none.png"):
        pass


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
@pytest.mark.parametrize("kind", ["BYTE_COLOR", "FLOAT_COLOR"])
def test_attributes_become_pictures_and_back(make_object, domain, kind):
    # A square of area 4 and a triangle of area 1/2, apart.
    points = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (5, 0, 0), (6, 0, 0), (5, 1, 0)]
    obj = make_object("A")
    obj.data.clear_geometry()
    obj.data.from_pydata(points, [], [(0, 1, 2, 3), (4, 5, 6)])
    attribute = obj.data.color_attributes.new("Col", kind, domain)
    obj.data.color_attributes.active_color_name = "Col"
    colors = np.zeros((7, 4), np.float32)
    colors[:4], colors[4:] = (0.25, 0.5, 0.125, 0.75), (0.5, 0.25, 1.0, 1.0)
    attribute.data.foreach_set("color", colors.ravel())
    picture = read_colors_as_picture(obj)
    np.testing.assert_allclose(picture.pixels[:, 0], colors, atol=0.01)
    shares = picture.weights[:, 0] / picture.weights.sum()
    np.testing.assert_allclose(shares, [2 / 9] * 4 + [1 / 27] * 3, rtol=1e-5)
    write_picture_colors(obj, "Col", "Other", picture.pixels[:, :, [1, 0, 2, 3]])
    found = obj.data.color_attributes["Other"]
    assert (found.domain, found.data_type) == (domain, kind)
    assert obj.data.color_attributes.active_color_name == "Other"
    np.testing.assert_allclose(read_colors_as_picture(obj).pixels[:, 0], colors[:, [1, 0, 2, 3]], atol=0.01)
