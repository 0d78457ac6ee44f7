# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in files: values are preserved, and nothing is left behind."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.image_files import ImageFormat, drawn_image, opened_image, pixel_values, write_image
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
