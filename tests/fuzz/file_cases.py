# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Truncated, changed and forged files for every reader of the add-on that works without Blender."""

from __future__ import annotations

import io
import json
import random
import struct
import tracemalloc
import zipfile
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from convwass_addon.applications.morphs.frame_file import DamagedFrameError, StoredFrame, read_frame, write_frame
from convwass_addon.applications.morphs.part_potentials import PartPotentials
from convwass_addon.applications.palettes.lookup_table import LookupTable, read_cube, write_cube
from convwass_addon.applications.reflectance.lobe_table import incoming_directions, tabulated
from convwass_addon.applications.reflectance.materials import Ggx
from convwass_addon.applications.reflectance.table_files import read_table, write_table
from convwass_addon.array_files import array_bytes
from convwass_addon.errors import InputError
from tests.shapes import box

KEY = "0" * 64
_HUGE = (2**60, 2**31, 2**63, 2**64 - 1, 10**400, -1, 0, 1e308, None, True, "x", [], {}, [2**60] * 3)
# Memory that a reader may need: a constant, and a multiple of the file's size.
_ROOM, _TIMES = 6 << 20, 60


def frame_file(path: Path) -> None:
    """Write a frame with potentials and origins."""
    inside = np.random.default_rng(0).random((3, 4, 5)) > 0.5
    columns = np.random.default_rng(1).random((2, np.count_nonzero(inside))).astype(np.float32)
    mesh = box()
    origins = np.zeros((2, len(mesh.vertices), 3), np.float32)
    parts = (PartPotentials(inside, columns, 0.5, 1.0),)
    write_frame(path, KEY, StoredFrame(mesh, {"converged": True, "weights": (0.5, 0.5)}, parts, origins))


def _table_file(path: Path) -> None:
    write_table(path, tabulated(Ggx(0.4, 0.2), incoming_directions(3, 2), 8))


def _cube_file(path: Path) -> None:
    colors = np.random.default_rng(2).random((3, 3, 3, 3)).astype(np.float32)
    write_cube(LookupTable(colors, np.zeros(3), np.ones(3)), path)


def _frame(path: Path) -> None:
    read_frame(path, KEY)


READERS: dict[str, tuple[Callable[[Path], None], Callable[[Path], object], tuple[type[Exception], ...]]] = {
    "frame": (frame_file, _frame, (DamagedFrameError,)),
    "table.npz": (_table_file, read_table, (InputError,)),
    "grade.cube": (_cube_file, read_cube, (InputError,)),
}
"""Writer of a valid file, its reader, and the errors that count as refusals."""


def outcome(name: str, content: bytes, folder: Path) -> str:
    """Read a file; return "read" or "refused". Other errors and too much memory are raised."""
    _, read, refused = READERS[name]
    path = folder / name
    path.write_bytes(content)
    tracemalloc.start()
    try:
        read(path)
        found = "read"
    except refused:
        found = "refused"
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    if peak > _ROOM + _TIMES * len(content):
        raise MemoryError(f"{name}: {peak} bytes for a file of {len(content)}")
    return found


def good_content(name: str, folder: Path) -> bytes:
    """Return the content of a valid file."""
    path = folder / f"good {name}"
    READERS[name][0](path)
    return path.read_bytes()


def spoiled(content: bytes, seed: int) -> bytes:
    """Return a damaged copy of a file."""
    chance = random.Random(seed)
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 2, 8))):
        place = min(int(chance.random() ** 2 * len(data)), max(len(data) - 1, 0))
        match chance.randrange(6):
            case 0 if data:
                data[place] ^= 1 << chance.randrange(8)
            case 1:
                del data[place:]
            case 2:
                data[place : place + 8] = chance.choice((b"\xff" * 8, bytes(8), struct.pack("<Q", 2**60)))
            case 3:
                data[place:place] = chance.randbytes(chance.randrange(1, 40))
            case 4:
                del data[place : place + chance.randrange(1, 40)]
            case 5:
                data[place : place + 1] = chance.choice((b"9" * 9, b"nan", b"\n" * 3, b"1e999", b"[" * 2000, b"\0"))
    return bytes(data)


def lying_file(content: bytes, seed: int, notices: Sequence[object] = ()) -> bytes:
    """Return a file of arrays with a correct hash and a wrong header, optionally with notices."""
    chance = random.Random(seed)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    header = json.loads(members.pop("header.json"))
    if notices:
        header["notices"] = [chance.choice(notices)]
    holder, key = chance.choice(_places(header))
    holder[key] = chance.choice((*_HUGE, "{a.__class__}", ["{0}", {}], ["{a[0]}", {"a": "x"}]))
    arrays = {name.removesuffix(".npy"): np.load(io.BytesIO(array)) for name, array in members.items()}
    return array_bytes(arrays, header)


NOTICES = (["{a}", {"a": 1}], ["{a.real}", {"a": 1}], ["{a:99999999}", {"a": 1}], 3)
"""Notices of a soft map, most of which expect something other than a value."""


def pickled_table() -> bytes:
    """Return a NumPy file with an array of objects, which a naive reader would unpickle."""
    file = io.BytesIO()
    objects = np.array([Ggx, 1], dtype=object)
    np.savez(file, theta_in=objects, phi_in=objects, lobes=objects, albedo=objects)
    return file.getvalue()


def bomb(size: int = 1 << 26) -> bytes:
    """Return a few bytes that decompress to very many."""
    return zlib.compress(bytes(size), 9)


def _places(value: object) -> list[tuple[object, object]]:
    """Return all places in nested lists and tables where a value could be inserted."""
    keys = list(value) if isinstance(value, dict) else list(range(len(value))) if isinstance(value, list) else []
    return [(value, key) for key in keys] + [place for key in keys for place in _places(value[key])]
