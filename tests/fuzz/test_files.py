# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are not what they should be are refused, with no more memory than their size justifies."""

from __future__ import annotations

import zipfile

import bpy
import numpy as np
import pytest

from convwass_addon.applications.palettes import lookup_table
from convwass_addon.bridge.soft_maps.soft_map_bytes import packed, unpacked
from convwass_addon.sentence import Sentence
from tests.bridge.test_soft_map_store import ball, stored_between
from tests.fuzz.file_cases import (
    READERS,
    bomb,
    good_content,
    lying_frame,
    lying_map,
    outcome,
    pickled_table,
    spoiled,
)

SEEDS = 80


@pytest.mark.parametrize("name", READERS)
def test_spoiled_files_are_read_or_refused(name, tmp_path):
    good = good_content(name, tmp_path)
    assert outcome(name, good, tmp_path) == "read"
    found = [outcome(name, spoiled(good, seed), tmp_path) for seed in range(SEEDS)]
    assert "refused" in found


def test_frames_that_lie_are_refused(tmp_path):
    good = good_content("frame", tmp_path)
    found = [outcome("frame", lying_frame(good, seed), tmp_path) for seed in range(SEEDS)]
    assert found.count("refused") > SEEDS // 2


def test_maps_that_lie_are_refused(empty_scene):
    good = packed(stored_between(ball("Source"), ball("Target", segments=12)))
    refused = 0
    for seed in range(SEEDS):
        for content in (lying_map(good, seed), spoiled(good, seed)):
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
def test_templates_from_files_take_values_as_they_are(template, is_plain):
    assert Sentence(template, {"a": 1, "b": 2}).is_plain == is_plain


@pytest.mark.parametrize("header", [b"{'descr", b"\x02\x00\x01", b"(((", b"1 +"])
def test_headers_that_are_no_python_are_refused(header, tmp_path):
    path = tmp_path / "odd.npz"
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("theta_in", "phi_in", "lobes", "albedo"):
            archive.writestr(f"{name}.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
    assert outcome("table.npz", path.read_bytes(), tmp_path) == "refused"


def test_objects_are_not_unpickled(tmp_path):
    assert outcome("table.npz", pickled_table(), tmp_path) == "refused"


def test_tables_packed_so_that_a_few_bytes_stand_for_any_number_are_refused(tmp_path):
    path = tmp_path / "bomb.npz"
    header = np.lib.format.header_data_from_array_1_0(np.zeros(3, "<f4"))
    assert header["shape"] == (3,)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_BZIP2) as archive:
        for name in ("theta_in", "phi_in", "lobes", "albedo"):
            archive.writestr(f"{name}.npy", b"\x93NUMPY\x02\x00" + b"\xff\xff\xff\x7f" + bytes(1 << 24))
    assert outcome("table.npz", path.read_bytes(), tmp_path) == "refused"
    assert len(bomb()) < 1 << 20


def test_a_cube_file_of_nothing_but_words_takes_no_longer_than_others(tmp_path, monkeypatch):
    """Sorting its lines took the square of their number."""
    compared = []

    class Line(list):
        def __eq__(self, other):
            compared.append(1)
            return list.__eq__(self, other)

        __hash__ = None

    words = [f"A{number} x" for number in range(200)] + [f"{number} 0 0" for number in range(200)]

    class Text(str):
        def split(self):
            return Line(str.split(self))

    with pytest.raises(lookup_table.InputError):
        lookup_table._table_of([Text(word) for word in words], tmp_path / "x.cube")
    assert len(compared) < 2 * len(words)
