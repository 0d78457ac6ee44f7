# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Named arrays and a JSON header in one checked file, which ``numpy.load`` can open as ``.npz``.

The file is a zip archive with a member ``NAME.npy`` for every array and, optionally, ``header.json``. The archive
comment is the SHA-256 of all preceding bytes, in hexadecimal. Files of other programs lack it; for them, only the
CRC-32 of the members is checked.

Files are not trusted: objects are not unpickled, and memory is limited by the caller.
"""

from __future__ import annotations

import errno
import hashlib
import io
import json
import math
import zipfile
import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from tokenize import TokenError
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

_HEADER = "header.json"
_MOST_HEADER_BYTES = 1 << 22
# Length of a SHA-256 in hexadecimal.
_SEAL_BYTES = 64
# Compression level of booleans and bytes.
_BYTE_LEVEL = 6
# Bytes that are hashed at a time.
_CHUNK = 1 << 20
# The earliest date of the format, so that equal arrays give equal files.
_DATE = (1980, 1, 1, 0, 0, 0)

_DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, KeyError, ValueError, EOFError, NotImplementedError, RuntimeError),
    # NumPy parses the headers of arrays as Python.
    *(SyntaxError, TokenError, MemoryError),
)


class DamagedArraysError(ValueError):
    """The file is damaged or invalid; the message says briefly why."""


def array_bytes(arrays: Mapping[str, NDArray], header: Mapping[str, object] | None = None, level: int = 0) -> bytes:
    """Serialize named arrays.

    Parameters
    ----------
    arrays : mapping of str to ndarray
        Numeric or boolean arrays.
    header : mapping, optional
        Must be serializable as JSON.
    level : int
        Compression level, from 0 (none) to 9. Booleans and bytes are always compressed.
    """
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.comment = bytes(_SEAL_BYTES)
        if header is not None:
            _write_member(archive, _HEADER, json.dumps(header).encode(), 1)
        for name, array in arrays.items():
            member = io.BytesIO()
            npy.write_array(member, np.asarray(array, order="C"), version=(1, 0), allow_pickle=False)
            _write_member(archive, f"{name}.npy", member.getbuffer(), level or _level_of(array))
    sealed = file.getbuffer()[:-_SEAL_BYTES]
    return b"".join([sealed, hashlib.sha256(sealed).hexdigest().encode()])


def _level_of(array: NDArray) -> int:
    """Return the default compression level; other numbers are nearly random."""
    return _BYTE_LEVEL if array.dtype.itemsize == 1 else 0


def _write_member(archive: zipfile.ZipFile, name: str, content: bytes | memoryview, level: int) -> None:
    entry = zipfile.ZipInfo(name, _DATE)
    archive.writestr(entry, content, zipfile.ZIP_DEFLATED if level else zipfile.ZIP_STORED, level or None)


class ArrayReader:
    """Reads arrays from a file.

    Parameters
    ----------
    file : binary file
        Seekable; remains open.
    most_bytes : int
        Maximum total size of the arrays.
    is_sealed : bool
        Whether the SHA-256 of :func:`array_bytes` is required; false for files of other programs.

    Attributes
    ----------
    header : dict
        The header; empty if the file has none.

    Raises
    ------
    DamagedArraysError
        The file is invalid, truncated or modified.
    OSError
        The file cannot be read.
    """

    def __init__(self, file: BinaryIO, most_bytes: int, *, is_sealed: bool = True) -> None:
        if is_sealed:
            _check_seal(file)
        with _damage_told():
            self._archive = zipfile.ZipFile(file)
            names = self._archive.namelist()
        self._names, self._left = set(names), most_bytes
        if len(self._names) != len(names):
            raise DamagedArraysError("two of its arrays have the same name")
        self.header: dict[str, object] = {}
        if _HEADER in self._names:
            with _damage_told():
                self.header = json.loads(self._content(_HEADER, _MOST_HEADER_BYTES))
            if not isinstance(self.header, dict):
                raise DamagedArraysError("its header is not a table")

    def __contains__(self, name: str) -> bool:
        return f"{name}.npy" in self._names

    def take(self, name: str, types: Collection[str], axes: Collection[int]) -> NDArray:
        """Read an array. Each array can be read once.

        Parameters
        ----------
        name : str
            Name of the array.
        types : collection of str
            The allowed NumPy types, such as ``<f4``.
        axes : collection of int
            The allowed numbers of axes.

        Returns
        -------
        ndarray
            In C order and native byte order, writable.

        Raises
        ------
        DamagedArraysError
            The array is missing, damaged, larger than allowed, or of the wrong type or number of axes.
        """
        if name not in self:
            raise DamagedArraysError(f"its {name} is missing")
        with _damage_told():
            content = self._content(f"{name}.npy", self._left)
            start = io.BytesIO(content)
            # Later versions are only needed for longer headers.
            if npy.read_magic(start) != (1, 0):
                raise DamagedArraysError(f"its {name} is of an unknown version")
            shape, in_columns, dtype = npy.read_array_header_1_0(start)
        self._left -= len(content)
        if dtype.str not in types or in_columns or len(shape) not in axes:
            raise DamagedArraysError(f"its {name} is of another type")
        if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != len(content) - start.tell():
            raise DamagedArraysError(f"its {name} does not have the size that it says")
        array = np.frombuffer(content, dtype, offset=start.tell()).reshape(shape)
        if dtype.kind == "b" and array.view(np.uint8).max(initial=0) > 1:
            raise DamagedArraysError(f"its {name} is neither true nor false")
        return array.astype(dtype.newbyteorder("="))

    def end(self) -> None:
        """Check that all arrays have been read.

        Raises
        ------
        DamagedArraysError
            The file contains other data.
        """
        if self._names:
            raise DamagedArraysError("it contains more than it should")

    def _content(self, name: str, most: int) -> bytes:
        self._names.remove(name)
        entry = self._archive.getinfo(name)
        if entry.file_size > most:
            raise DamagedArraysError(f"its {name.removesuffix('.npy')} is too large")
        # Other methods allow extreme compression ratios.
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise DamagedArraysError("it is compressed in an unknown way")
        # Checks the CRC-32.
        return self._archive.read(entry)


@contextmanager
def _damage_told() -> Iterator[None]:
    """Convert exceptions that libraries raise for damaged files to `DamagedArraysError`."""
    try:
        yield
    except DamagedArraysError:
        raise
    except _DAMAGE as error:
        raise DamagedArraysError(f"it cannot be unpacked: {error}") from error
    except OSError as error:
        # An offset before the beginning of the file.
        if error.errno != errno.EINVAL:
            raise
        raise DamagedArraysError("it cannot be unpacked") from error


def _check_seal(file: BinaryIO) -> None:
    size = file.seek(0, io.SEEK_END) - _SEAL_BYTES
    file.seek(0)
    hashed = hashlib.sha256()
    for start in range(0, max(size, 0), _CHUNK):
        hashed.update(file.read(min(_CHUNK, size - start)))
    if file.read(_SEAL_BYTES + 1) != hashed.hexdigest().encode():
        raise DamagedArraysError("it was truncated or modified")
