# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Array files can be written and read, NumPy opens them, and damaged ones are refused with the reason."""

from __future__ import annotations

import hashlib
import io
import struct
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.array_files import ArrayReader, DamagedArraysError, array_bytes

ARRAYS = {
    "floats": np.linspace(0, 1, 6).reshape(2, 3),
    "bools": np.arange(5) % 2 == 0,
    "none": np.zeros((0, 3), "<i4"),
    "turned": np.arange(6, dtype="<i8").reshape(2, 3).T,
}
HEADER = {"schema": 1, "names": ["a", "ä"]}


def reader_of(content: bytes, most_bytes: int = 1 << 20, **options: bool) -> ArrayReader:
    return ArrayReader(io.BytesIO(content), most_bytes, **options)


def zipped(members: dict[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    """A sealed archive with any members."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as archive:
        archive.comment = bytes(64)
        for name, content in members.items():
            archive.writestr(name, content)
    sealed = file.getvalue()[:-64]
    return sealed + hashlib.sha256(sealed).hexdigest().encode()


def member(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def promising(shape: str, content: bytes = bytes(24)) -> bytes:
    """An array whose header claims the given shape."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + content


@pytest.mark.parametrize("level", [0, 1, 9])
def test_frames_survive_writing_and_reading(level):
    reader = reader_of(array_bytes(ARRAYS, HEADER, level))
    assert reader.header == HEADER
    for name, array in ARRAYS.items():
        found = reader.take(name, (array.dtype.str,), (array.ndim,))
        np.testing.assert_array_equal(found, array)
        assert found.dtype == array.dtype
        assert found.flags.writeable
        with pytest.raises(DamagedArraysError, match="missing"):
            reader.take(name, (array.dtype.str,), (array.ndim,))
    reader.end()


def test_the_same_arrays_make_the_same_file():
    assert array_bytes(ARRAYS, HEADER) == array_bytes(ARRAYS, HEADER)


def test_numpy_opens_files_and_its_files_are_opened():
    content = array_bytes(ARRAYS)
    with np.load(io.BytesIO(content)) as found:
        assert set(found) == set(ARRAYS)
        np.testing.assert_array_equal(found["floats"], ARRAYS["floats"])
    file = io.BytesIO()
    np.savez(file, **ARRAYS)
    reader = reader_of(file.getvalue(), is_sealed=False)
    np.testing.assert_array_equal(reader.take("floats", ("<f8",), (2,)), ARRAYS["floats"])
    with pytest.raises(DamagedArraysError, match="more than it should"):
        reader.end()
    with pytest.raises(DamagedArraysError, match="truncated or modified"):
        reader_of(file.getvalue())


GOOD = array_bytes(ARRAYS, HEADER)


@settings(max_examples=80)
@given(st.data())
def test_any_changed_byte_and_any_truncation_is_detected(data):
    content = bytearray(GOOD)
    place = data.draw(st.integers(0, len(content) - 1))
    if data.draw(st.booleans()):
        content[place] ^= data.draw(st.integers(1, 255))
    else:
        del content[place:]
    with pytest.raises(DamagedArraysError, match="truncated or modified"):
        reader_of(bytes(content))


@settings(max_examples=80)
@given(st.data())
def test_files_without_a_seal_are_read_or_refused(data):
    content = bytearray(GOOD)
    for _ in range(data.draw(st.integers(1, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    try:
        reader = reader_of(bytes(content), is_sealed=False)
        found = reader.take("floats", ("<f8",), (2,))
    except DamagedArraysError:
        return
    np.testing.assert_array_equal(found, ARRAYS["floats"])


@pytest.mark.parametrize(
    ("array", "reason"),
    [
        (member(np.zeros(3, np.float32)), "another type"),
        (member(np.zeros((3, 1))), "another type"),
        (member(np.zeros((3, 1, 1)).T), "another type"),
        (promising("(99999999, 99999999)"), "another type"),
        (promising("(4,)"), "size that it says"),
        (promising("(2,)"), "size that it says"),
        (promising("(-3,)"), "cannot be unpacked|size that it says"),
        (promising("(10 ** 9,)"), "cannot be unpacked"),
        (b"\x93NUMPY\x02\x00" + b"\xff\xff\xff\x7f", "unknown version"),
        (b"\x93NUMPY\x01\x00\x07\x00{'descr", "cannot be unpacked"),
        (b"\x93NUMPY\x01\x00\x03\x00(((", "cannot be unpacked"),
        (b"", "cannot be unpacked"),
        (bytes(2000), "too large"),
    ],
)
def test_arrays_with_wrong_headers_are_refused(array, reason):
    reader = reader_of(zipped({"x.npy": array}), 1999)
    with pytest.raises(DamagedArraysError, match=reason):
        reader.take("x", ("<f8",), (1,))


def test_bools_must_be_true_or_false():
    bools = member(np.array([True, False]))
    reader = reader_of(zipped({"x.npy": bools[:-1] + b"\x07"}))
    with pytest.raises(DamagedArraysError, match="neither true nor false"):
        reader.take("x", ("|b1",), (1,))


def test_objects_are_not_unpickled():
    reader = reader_of(zipped({"x.npy": member(np.array([{}, 1], dtype=object))}))
    with pytest.raises(DamagedArraysError, match="another type"):
        reader.take("x", ("<f8",), (1,))


def test_the_total_size_of_arrays_is_limited():
    each = len(member(np.zeros(100)))
    reader = reader_of(array_bytes({"a": np.zeros(100), "b": np.zeros(100)}), 2 * each - 1)
    reader.take("a", ("<f8",), (1,))
    with pytest.raises(DamagedArraysError, match="b is too large"):
        reader.take("b", ("<f8",), (1,))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (b"[1, 2]", "not a table"),
        (b"\xff\xfe", "cannot be unpacked"),
        (b"[" * 100_000, "cannot be unpacked"),
        (b" " * (1 << 22) + b"{}", "header.json is too large"),
    ],
)
def test_headers_that_are_not_tables_are_refused(text, reason):
    with pytest.raises(DamagedArraysError, match=reason):
        reader_of(zipped({"header.json": text}))


def test_other_files_are_refused():
    sealed = zipped({"x.npy": b""})[:-64]
    for content in (b"", b"hello", b"PK\x03\x04" + bytes(300), sealed):
        with pytest.raises(DamagedArraysError, match="truncated or modified"):
            reader_of(content)
        with pytest.raises(DamagedArraysError, match="cannot be unpacked"):
            reader_of(content[:40], is_sealed=False)


def test_other_compression_methods_are_refused():
    reader = reader_of(zipped({"x.npy": member(np.zeros(1000))}, zipfile.ZIP_BZIP2))
    with pytest.raises(DamagedArraysError, match="unknown way"):
        reader.take("x", ("<f8",), (1,))


def test_duplicate_names_are_refused():
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive, pytest.warns(UserWarning, match="Duplicate"):
        for _ in range(2):
            archive.writestr("x.npy", member(np.zeros(1)))
    with pytest.raises(DamagedArraysError, match="same name"):
        reader_of(file.getvalue(), is_sealed=False)
