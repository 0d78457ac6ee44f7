# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files are refused, using no more memory than their size justifies."""

from __future__ import annotations

import struct
import zipfile
from itertools import product

import bpy
import numpy as np
import pytest

from convwass_addon.applications.reflectance.lobe_lookup import HEIGHT, WIDTH
from convwass_addon.applications.reflectance.lobe_table import incoming_directions, tabulated
from convwass_addon.applications.reflectance.materials import Ggx
from convwass_addon.applications.reflectance.merl import read_merl
from convwass_addon.applications.reflectance.table_pictures import table_of_picture, table_picture
from convwass_addon.bridge.reflectance.lobe_images import (
    read_lobe_exr,
    read_table_exr,
    write_lobe_exr,
    write_table_exr,
)
from convwass_addon.bridge.soft_maps.soft_map_bytes import packed, unpacked
from convwass_addon.errors import InputError
from convwass_addon.sentence import Sentence
from tests.bridge.test_soft_map_store import ball, stored_between
from tests.fuzz.file_cases import (
    NOTICES,
    READERS,
    bomb,
    good_content,
    lying_file,
    outcome,
    pickled_table,
    spoiled,
)

SEEDS = 80


@pytest.mark.parametrize("name", READERS)
def test_damaged_files_are_read_or_refused(name, tmp_path):
    good = good_content(name, tmp_path)
    assert outcome(name, good, tmp_path) == "read"
    found = [outcome(name, spoiled(good, seed), tmp_path) for seed in range(SEEDS)]
    assert "refused" in found


def test_measured_materials_are_read_or_refused(tmp_path):
    """Because the files are large, only some bytes are changed."""
    header, count = struct.pack("<3i", 90, 90, 180), 3 * 90 * 90 * 180
    good = header + np.full(count, 0.1).tobytes()
    path, file = tmp_path / "own.binary", bytearray(good)
    found = []
    # The header; a sign; exponents, whose highest bit makes numbers too large.
    for place, bit in ((0, 0), (3, 7), (11, 7), (12 + 8 * 9 + 7, 7), (12 + 8 * 9 + 7, 6), (12 + 8 * count - 1, 6)):
        file[place] ^= 1 << bit
        path.write_bytes(file)
        try:
            found.append(bool(np.isfinite(read_merl(path).values).all()))
        except InputError:
            found.append(None)
        file[place] ^= 1 << bit
    assert found == [None, None, None, True, None, None]
    for content in (good[:-1], good[:12], b"", good + b"x", bytes(len(good)), header + bytes(len(good) - 12)):
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"own\.binary"):
            read_merl(path)


LOBES = {
    "x.lobes.exr": (
        lambda path: write_table_exr(path, tabulated(Ggx(0.4, 0.2), incoming_directions(3, 2), 8)),
        read_table_exr,
    ),
    "x.exr": (lambda path: write_lobe_exr(path, [np.full((HEIGHT, WIDTH, 3), 0.5, np.float32)]), read_lobe_exr),
}


@pytest.mark.parametrize("name", LOBES)
def test_lobes_in_damaged_pictures_are_read_or_refused(name, tmp_path, empty_scene):
    """In bytes, and in the sizes in the header, for both the data and the display window."""
    write, read = LOBES[name]
    path = tmp_path / name
    write(path)
    good = path.read_bytes()
    assert read(path)
    spoils = [spoiled(good, seed) for seed in range(20)]
    for window, corners in product((b"dataWindow", b"displayWindow"), ((0, 0, 2**31 - 1, 2**31 - 1), (5, 5, 0, 0))):
        named = window + b"\0box2i\0" + struct.pack("<I", 16)
        start, _, end = good.partition(named)
        spoils.append(start + named + struct.pack("<4i", *corners) + end[16:])
    found = []
    for content in spoils:
        path.write_bytes(content)
        try:
            found.append(bool(read(path)))
        except InputError:
            found.append(False)
    assert not all(found) and not bpy.data.images
    assert bpy.context.scene == empty_scene


def test_pictures_with_signaling_nans_are_refused():
    picture = table_picture(tabulated(Ggx(0.4, 0.2), incoming_directions(3, 2), 8)).astype(np.float32)
    # A signaling NaN.
    picture.view(np.uint32)[-1, 0, 0] = 0x7F800001
    with pytest.raises(InputError, match="values that are invalid for a table"):
        table_of_picture(picture, "x.exr")


def test_forged_frames_are_refused(tmp_path):
    good = good_content("frame", tmp_path)
    found = [outcome("frame", lying_file(good, seed), tmp_path) for seed in range(SEEDS)]
    assert found.count("refused") > SEEDS // 2


def test_forged_maps_are_refused(empty_scene):
    good = packed(stored_between(ball("Source"), ball("Target", segments=12)))
    refused = 0
    for seed in range(SEEDS):
        for content in (lying_file(good, seed, NOTICES), spoiled(good, seed)):
            try:
                unpacked(content)
            except (ValueError, TypeError, KeyError, RecursionError):
                refused += 1
    assert refused > SEEDS // 2
    assert bpy.context.scene == empty_scene


@pytest.mark.parametrize(
    ("template", "is_plain"),
    [
        ("{a} of {b}", True),
        ("{a:.1%} {b:d} {{}}", True),
        ("{a:.3g} {b:>4}", True),
        ("{a.real}", False),
        ("{a[0]}", False),
        ("{a:99999999}", False),
        ("{0}", False),
        ("{}", False),
        ("{a:{b}}", False),
    ],
)
def test_only_templates_with_simple_fields_are_plain(template, is_plain):
    assert Sentence(template, {"a": 1, "b": 2}).is_plain == is_plain


@pytest.mark.parametrize("header", [b"{'descr", b"\x02\x00\x01", b"(((", b"1 +"])
def test_headers_that_are_not_python_are_refused(header, tmp_path):
    path = tmp_path / "odd.npz"
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("theta_in", "phi_in", "lobes", "albedo"):
            archive.writestr(f"{name}.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
    assert outcome("table.npz", path.read_bytes(), tmp_path) == "refused"


def test_objects_are_not_unpickled(tmp_path):
    assert outcome("table.npz", pickled_table(), tmp_path) == "refused"


def test_decompression_bombs_are_refused(tmp_path):
    path = tmp_path / "bomb.npz"
    header = np.lib.format.header_data_from_array_1_0(np.zeros(3, "<f4"))
    assert header["shape"] == (3,)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_BZIP2) as archive:
        for name in ("theta_in", "phi_in", "lobes", "albedo"):
            archive.writestr(f"{name}.npy", b"\x93NUMPY\x02\x00" + b"\xff\xff\xff\x7f" + bytes(1 << 24))
    assert outcome("table.npz", path.read_bytes(), tmp_path) == "refused"
    assert len(bomb()) < 1 << 20
