# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenEXR files are checked before Blender reads them: complete ones of any kind pass, damaged ones never do."""

from __future__ import annotations

import math
import struct
import zlib

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.files.image_files import drawn_image
from convwass_addon.bridge.reflectance.exr_header import ExrSize, exr_size
from convwass_addon.errors import InputError

# More rows than a block has, and no multiple.
WIDTH, HEIGHT = 21, 37
CODEC = b"compression\0compression\0\1\0\0\0"


def written(path, codec="ZIP", mode="RGB", depth="32"):
    """Let Blender write a picture, and return its bytes."""
    pixels = np.ones((HEIGHT, WIDTH, 4), np.float32)
    # Few distinct values, so that every codec compresses them: incompressible data would be stored raw.
    pixels[..., :3] = np.round(np.linspace(0.0, 8.0, HEIGHT * WIDTH * 3)).reshape(HEIGHT, WIDTH, 3)
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", mode, depth
    settings.exr_codec = codec
    with drawn_image(pixels, "Non-Color") as image:
        image.save_render(str(path))
    return path.read_bytes()


@pytest.mark.parametrize("codec", ["NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"])
def test_whole_files_of_every_codec_pass(empty_scene, tmp_path, codec):
    depth = "16" if codec.startswith("B44") else "32"
    for mode in ("RGB", "RGBA", "BW"):
        written(tmp_path / "a.exr", codec, mode, depth)
        assert exr_size(tmp_path / "a.exr") == ExrSize(WIDTH, HEIGHT)


@pytest.mark.parametrize("codec", ["NONE", "ZIP", "PIZ"])
def test_truncated_files_are_refused(empty_scene, tmp_path, codec):
    path = tmp_path / "a.exr"
    good = written(path, codec)
    for length in {*range(0, len(good), 89), len(good) - 1}:
        path.write_bytes(good[:length])
        with pytest.raises(InputError, match="is damaged"):
            exr_size(path)


def test_changed_bits_of_packed_rows_are_noticed(empty_scene, tmp_path):
    path = tmp_path / "a.exr"
    good = written(path)
    # The table of blocks begins where the first entry points just behind it.
    table = 8 * math.ceil(HEIGHT / 16)
    start = next(at for at in range(table, len(good)) if struct.unpack_from("<Q", good, at - table)[0] == at)
    (length,) = struct.unpack_from("<i", good, start + 4)
    block = slice(start + 8, start + 8 + length)
    refused = 0
    for place in range(block.start, block.stop):
        content = good[:place] + bytes([good[place] ^ 16]) + good[place + 1 :]
        path.write_bytes(content)
        try:
            exr_size(path)
        except InputError:
            refused += 1
        else:
            # Some bits, as of codes that are not used, mean nothing.
            assert zlib.decompress(content[block]) == zlib.decompress(good[block])
    assert refused > 0.9 * length


def test_wrong_headers_are_refused(empty_scene, tmp_path):
    path = tmp_path / "a.exr"
    good = written(path, "NONE")
    window = good.index(b"dataWindow\0box2i\0") + 21
    lies = {
        "magic": b"\x77" + good[1:],
        "of tiles": good[:5] + b"\x02" + good[6:],
        "huge": good[:window] + struct.pack("<4i", 0, 0, 2**31 - 1, 2**31 - 1) + good[window + 16 :],
        "inside out": good[:window] + struct.pack("<4i", 5, 5, 0, 0) + good[window + 16 :],
        "a row less": good[:window] + struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT) + good[window + 16 :],
        "a column less": good[:window] + struct.pack("<4i", 0, 0, WIDTH, HEIGHT - 1) + good[window + 16 :],
        "no such type": good.replace(b"compression\0compression\0", b"compression\0compressiox\0"),
        "not needed": good.replace(b"pixelAspectRatio\0", b"pixelAspectRatix\0"),
        "codec": good.replace(CODEC + b"\0", CODEC + b"\x0b"),
        "twice": good.replace(b"displayWindow\0", b"dataWindow\0"),
    }
    for name, content in lies.items():
        assert content != good, name
        path.write_bytes(content)
        with pytest.raises(InputError, match="not an OpenEXR picture"):
            exr_size(path)


def test_missing_files_are_reported(tmp_path):
    with pytest.raises(InputError, match="There is no file"):
        exr_size(tmp_path / "a.exr")
