# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A finished frame as a file: surface, origins, figures and potentials, validated when they are read.

The format is that of :mod:`.array_files`. The header has the ``key``, which identifies the frame, the ``record`` of
figures, and the ``sharpness`` and ``sigma`` of the ``potentials`` of every part of the blend; an unblended input has no
potentials. A surface has the arrays ``vertices`` (n, 3) and ``faces`` (m, 3); ``origins`` (k, n, 3), if they were
requested; ``tangents`` (k, n, 3), if the inputs move; and ``triangles`` (k, m), if it carries detail. Part i has
``inside.i``, a mask of the cells with potentials, and ``columns.i``, the potentials.

Positions are rounded far below the size of a cell, so that a frame takes a fifth of its size in memory
(docs/performance, "Stored frames"). The arrays of a surface have the form of :mod:`.compact_arrays`, and the header
has the ``rounding`` of every array of positions: its exponent and its lowest corners. Origins and tangents are relative
to the rounded vertices. Positions that are too far apart for that are stored as they are, and have no rounding.
"""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...array_files import ArrayReader, array_bytes
from ...drafts import draft_of
from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from .compact_arrays import Rounding, packed_integers, unpacked_integers
from .part_potentials import PartPotentials

# Far larger than any surface of the finest grid; larger files are not even read.
_MOST_BYTES = 2 << 30
# The longest side of a surface has at least this many steps of its vertices, origins and tangents. At 128 cells, a
# coordinate of a vertex is off by at most 1/1024 of a cell, and of an origin by 1/256. Velocities are differences of
# tangents divided by the number of frames, so that 1/32 of a cell does no harm.
_VERTEX_STEPS, _ORIGIN_STEPS, _TANGENT_STEPS = 1 << 16, 1 << 14, 1 << 11
# Figures of a record that other modules read, and their types.
_TYPES: dict[str, tuple[type, ...]] = {
    "weights": (tuple,),
    "converged": (bool,),
    "marginal_error": (float, int, type(None)),
    "notices": (tuple,),
}


class DamagedFrameError(Exception):
    """The file is not the expected frame; the message states the reason in a few words."""


@dataclass(frozen=True)
class StoredFrame:
    """The contents of a frame file.

    Attributes
    ----------
    mesh : TriangleMesh or None
        The surface, if there is one.
    record : dict
        The solver's figures.
    potentials : tuple of PartPotentials
        One per part; empty for an unblended input.
    origins : (k, n, 3) float32 or None
        Origins of the surface's vertices on the inputs.
    tangents : (k, n, 3) float32 or None
        Points that determine the velocities of the vertices, if the inputs move.
    triangles : (k, m) int32 or None
        The triangles of the inputs on which the triangles of the surface lie, if it carries detail.
    """

    mesh: TriangleMesh | None
    record: dict[str, object]
    potentials: tuple[PartPotentials, ...] = ()
    origins: NDArray[np.float32] | None = None
    tangents: NDArray[np.float32] | None = None
    triangles: NDArray[np.int32] | None = None


def as_stored(mesh: TriangleMesh) -> TriangleMesh:
    """Return a surface with its vertices rounded as in a file; one that was read from a file does not change."""
    rounding = Rounding.of(mesh.vertices[None], _size(mesh) / _VERTEX_STEPS) if len(mesh.vertices) else None
    if rounding is None:
        return mesh
    return TriangleMesh(rounding.positions(rounding.rounded(mesh.vertices[None]))[0], mesh.faces)


def write_frame(path: Path, key: str, frame: StoredFrame) -> None:
    """Write a frame atomically.

    Parameters
    ----------
    path : Path
        The file; an existing one is replaced.
    key : str
        Identifies the frame.
    frame : StoredFrame
        The frame.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with draft_of(path, ".part") as draft:
        draft.write_bytes(_packed(key, frame))


def read_frame(path: Path, key: str) -> StoredFrame:
    """Read a frame and validate all of it.

    Raises
    ------
    FileNotFoundError
        The file does not exist.
    OSError
        The file cannot be read.
    DamagedFrameError
        Not a regular file, too large, truncated, modified, another frame, or with invalid contents.
    """
    # A link could lead out of the folder, and reading a pipe would never end.
    if not stat.S_ISREG(os.lstat(path).st_mode):
        raise DamagedFrameError("it is no regular file")
    try:
        with open(path, "rb") as file:
            if os.fstat(file.fileno()).st_size > _MOST_BYTES:
                raise DamagedFrameError("it is too large")
            reader = ArrayReader(file, _MOST_BYTES)
            frame = _unpacked(reader, key)
            reader.end()
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError, InputError) as error:
        raise DamagedFrameError(str(error) or type(error).__name__) from error
    return frame


def _packed(key: str, frame: StoredFrame) -> bytes:
    solves = [{"sharpness": part.sharpness, "sigma": part.sigma} for part in frame.potentials]
    header = {"key": key, "potentials": solves, "record": frame.record}
    arrays: dict[str, NDArray] = {}
    if frame.mesh is not None:
        surface = _PackedSurface.of(frame)
        arrays |= surface.arrays
        header["rounding"] = surface.rounding
    for index, part in enumerate(frame.potentials):
        arrays |= {f"inside.{index}": part.inside, f"columns.{index}": part.columns.astype("<f4")}
    return array_bytes(arrays, header)


@dataclass
class _PackedSurface:
    """The arrays of a surface, and the rounding of those that are rounded."""

    arrays: dict[str, NDArray]
    rounding: dict[str, object]

    @classmethod
    def of(cls, frame: StoredFrame) -> _PackedSurface:
        """Pack the surface of a frame that has one."""
        vertices = frame.mesh.vertices
        packed = cls({}, {})
        size = _size(frame.mesh)
        rounded = packed._add("vertices", vertices[None], size / _VERTEX_STEPS)
        base = vertices[None] if rounded is None else rounded
        packed.arrays["faces"] = packed_integers(frame.mesh.faces.reshape(1, -1))
        if frame.origins is not None:
            packed._add("origins", frame.origins - base, size / _ORIGIN_STEPS)
        if frame.tangents is not None:
            packed._add("tangents", frame.tangents - base, size / _TANGENT_STEPS)
        if frame.triangles is not None:
            packed.arrays["triangles"] = packed_integers(frame.triangles)
        return packed

    def _add(self, name: str, points: NDArray[np.float64], most: float) -> NDArray[np.float64] | None:
        """Add k sets of points, (k, n, 3), in steps of at most `most`; return them rounded, or None."""
        rounding = Rounding.of(points, most) if points.size else None
        if rounding is None:
            self.arrays[name] = points.astype("<f8")
            return None
        steps = rounding.rounded(points)
        self.arrays[name] = packed_integers(steps)
        self.rounding[name] = [rounding.exponent, rounding.lows.tolist()]
        return rounding.positions(steps)


def _size(mesh: TriangleMesh) -> float:
    """Return the longest side of the bounds of all vertices."""
    return float(np.ptp(mesh.vertices, axis=0).max()) if len(mesh.vertices) else 0.0


def _unpacked(reader: ArrayReader, key: str) -> StoredFrame:
    if reader.header["key"] != key:
        raise ValueError("it is another frame")
    mesh = _mesh(reader) if "vertices" in reader else None
    origins = _of_vertices(reader, "origins", mesh) if "origins" in reader else None
    tangents = _of_vertices(reader, "tangents", mesh) if "tangents" in reader else None
    triangles = _of_faces(reader, mesh) if "triangles" in reader else None
    return StoredFrame(mesh, _record(reader.header["record"]), _potentials(reader), origins, tangents, triangles)


def _mesh(reader: ArrayReader) -> TriangleMesh:
    points, corners = _points(reader, "vertices"), _integers(reader, "faces")
    if len(points) != 1 or len(corners) != 1 or corners.size % 3:
        raise ValueError("its surface is not made of triangles in space")
    return TriangleMesh.from_arrays(points[0], corners.reshape(-1, 3))


def _points(reader: ArrayReader, name: str) -> NDArray[np.float64]:
    """Read sets of points, (k, n, 3)."""
    roundings = reader.header.get("rounding", {})
    if not isinstance(roundings, dict):
        raise TypeError("its rounding is no table")
    if name not in roundings:
        return reader.take(name, ("<f8",), (3,))
    exponent, lows = roundings[name]
    return Rounding.read(exponent, lows).positions(_integers(reader, name))


def _integers(reader: ArrayReader, name: str) -> NDArray[np.int64]:
    return unpacked_integers(reader.take(name, ("|u1",), (3,)))


def _of_vertices(reader: ArrayReader, name: str, mesh: TriangleMesh | None) -> NDArray[np.float32]:
    found = _points(reader, name)
    if mesh is None or found.shape[1:] != mesh.vertices.shape:
        raise ValueError(f"its {name} are not those of its vertices")
    with np.errstate(over="ignore", invalid="ignore"):
        placed = (found + mesh.vertices).astype(np.float32)
    if not np.isfinite(placed).all():
        raise ValueError(f"its {name} are not numbers")
    return placed


def _of_faces(reader: ArrayReader, mesh: TriangleMesh | None) -> NDArray[np.int32]:
    found = _integers(reader, "triangles")
    if mesh is None or found.shape[1] != len(mesh.faces):
        raise ValueError("its triangles are not those of its surface")
    return found.astype(np.int32)


def _potentials(reader: ArrayReader) -> tuple[PartPotentials, ...]:
    solves = reader.header["potentials"]
    if not (isinstance(solves, list) and all(isinstance(solve, dict) for solve in solves)):
        raise TypeError("its potentials are no list of tables")
    return tuple(
        PartPotentials(
            reader.take(f"inside.{index}", ("|b1",), (3,)),
            reader.take(f"columns.{index}", ("<f4",), (2,)),
            _number(solve["sharpness"]),
            _number(solve["sigma"]),
        )
        for index, solve in enumerate(solves)
    )


def _number(value: object) -> float:
    if type(value) not in (int, float):
        raise TypeError("its potentials are of no solve")
    return float(value)


def _record(value: object) -> dict[str, object]:
    if not isinstance(value, dict):
        raise TypeError("its record is no table")
    record = {name: _tupled(item) for name, item in value.items()}
    for name, types in _TYPES.items():
        if name in record and not isinstance(record[name], types):
            raise TypeError(f"its {name} is of the wrong type")
    return record


def _tupled(value: object) -> object:
    """Convert lists, which JSON makes of tuples, back to tuples."""
    if isinstance(value, list):
        return tuple(map(_tupled, value))
    if isinstance(value, dict):
        return {name: _tupled(item) for name, item in value.items()}
    return value
