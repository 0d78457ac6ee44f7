# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Named arrays and a JSON header in one checked file, which NumPy opens too: ``numpy.load`` takes it as ``.npz``.

The file is a zip archive with a member ``NAME.npy`` for every array and, where there is a header, ``header.json``. Its
comment is the SHA-256 of all bytes before it, in hexadecimal. Files that other programs write have none; then the
CRC-32 of the members is all that is checked.

Reading trusts nothing: objects are not unpickled, and no more memory is used than the caller allows.
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
# Characters of a SHA-256.
_SEAL_BYTES = 64
# Bytes that are hashed at a time.
_CHUNK = 1 << 20
# The earliest date that an archive knows: the same arrays make the same file.
_DATE = (1980, 1, 1, 0, 0, 0)

_DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, KeyError, ValueError, EOFError, NotImplementedError, RuntimeError),
    # NumPy reads the headers of arrays as Python.
    *(SyntaxError, TokenError, MemoryError),
)


class DamagedArraysError(ValueError):
    """The file is not what it should be; the message says in a few words why."""


def array_bytes(arrays: Mapping[str, NDArray], header: Mapping[str, object] | None = None, level: int = 0) -> bytes:
    """Return named arrays as the content of a file.

    Parameters
    ----------
    arrays : mapping of str to ndarray
        Of numbers or bools.
    header : mapping, optional
        Of what JSON knows.
    level : int
        How hard to compress numbers, from 0, not at all, to 9. Bools always are.
    """
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.comment = bytes(_SEAL_BYTES)
        if header is not None:
            _write_member(archive, _HEADER, json.dumps(header).encode(), 1)
        for name, array in arrays.items():
            member = io.BytesIO()
            npy.write_array(member, np.asarray(array, order="C"), version=(1, 0), allow_pickle=False)
            _write_member(archive, f"{name}.npy", member.getbuffer(), level or int(array.dtype.kind == "b"))
    sealed = file.getbuffer()[:-_SEAL_BYTES]
    return b"".join([sealed, hashlib.sha256(sealed).hexdigest().encode()])


def _write_member(archive: zipfile.ZipFile, name: str, content: bytes | memoryview, level: int) -> None:
    entry = zipfile.ZipInfo(name, _DATE)
    archive.writestr(entry, content, zipfile.ZIP_DEFLATED if level else zipfile.ZIP_STORED, level or None)


class ArrayReader:
    """Takes arrays out of a file.

    Parameters
    ----------
    file : binary file
        That can be read at any place; it stays open.
    most_bytes : int
        How large all of the arrays may be together.
    is_sealed : bool
        Whether it must have the SHA-256 that :func:`array_bytes` gives it; without, other programs may have made it.

    Attributes
    ----------
    header : dict
        What the file says of its arrays; empty where it has no header.

    Raises
    ------
    DamagedArraysError
        It is no such file, cut off or changed.
    OSError
        It cannot be read.
    """

    def __init__(self, file: BinaryIO, most_bytes: int, *, is_sealed: bool = True) -> None:
        if is_sealed:
            _check_seal(file)
        with _damage_told():
            self._archive = zipfile.ZipFile(file)
            names = self._archive.namelist()
        self._names, self._left = set(names), most_bytes
        if len(self._names) != len(names):
            raise DamagedArraysError("two of its arrays have one name")
        self.header: dict[str, object] = {}
        if _HEADER in self._names:
            with _damage_told():
                self.header = json.loads(self._content(_HEADER, _MOST_HEADER_BYTES))
            if not isinstance(self.header, dict):
                raise DamagedArraysError("its header is no table")

    def __contains__(self, name: str) -> bool:
        return f"{name}.npy" in self._names

    def take(self, name: str, types: Collection[str], axes: Collection[int]) -> NDArray:
        """Read an array, once.

        Parameters
        ----------
        name : str
            Which one.
        types : collection of str
            Those of NumPy's that it may have, such as ``<f4``.
        axes : collection of int
            How many axes it may have.

        Returns
        -------
        ndarray
            In rows, and in the byte order of the machine; it can be written to.

        Raises
        ------
        DamagedArraysError
            There is none, or it is damaged, of another type, has another number of axes, or is larger than allowed.
        """
        if name not in self:
            raise DamagedArraysError(f"its {name} is missing")
        with _damage_told():
            content = self._content(f"{name}.npy", self._left)
            start = io.BytesIO(content)
            # Later versions are for longer headers than numbers need.
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
        """Refuse a file that holds more than has been taken.

        Raises
        ------
        DamagedArraysError
            Something is left.
        """
        if self._names:
            raise DamagedArraysError("it holds more than it should")

    def _content(self, name: str, most: int) -> bytes:
        self._names.remove(name)
        entry = self._archive.getinfo(name)
        if entry.file_size > most:
            raise DamagedArraysError(f"its {name.removesuffix('.npy')} is too large")
        # Other methods let a few bytes stand for any number of them.
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise DamagedArraysError("it is compressed in an unknown way")
        # This checks the CRC-32.
        return self._archive.read(entry)


@contextmanager
def _damage_told() -> Iterator[None]:
    """Call what libraries raise at damaged files by one name."""
    try:
        yield
    except DamagedArraysError:
        raise
    except _DAMAGE as error:
        raise DamagedArraysError(f"it cannot be unpacked: {error}") from error
    except OSError as error:
        # A place that lies before the beginning of the file.
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
        raise DamagedArraysError("it was cut off or changed")
