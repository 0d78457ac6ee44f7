# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert maps between two surfaces to the bytes of :mod:`.array_files`, encoded to compress well.

An array is stored as its bytes, (bytes of a value, columns, rows): all first bytes, then all second ones, and so on,
column by column, since they are alike.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from ...applications.soft_maps.surface_maps import CoarseRows, PointMap, SurfaceMap, VertexInterpolation
from ...array_files import ArrayReader, array_bytes
from ...sentence import Sentence
from .first_schema import first_schema, is_first_schema

SCHEMA = 2

_MOST_BYTES = 1 << 31
# The default level of zlib.
_LEVEL = 6
# Largest integer for stored shares.
_ONE = 65535
# Stored bits of a float, for more than four digits.
_KEPT_BITS = np.uint32(0xFFFFF800)

_WHOLE, _SHARES, _FLOATS = np.dtype("<i4"), np.dtype("<u2"), np.dtype("<f4")
_POINT_MAP = {"faces": _WHOLE, "barycentric": _SHARES, "spread": _FLOATS, "entropy": _FLOATS, "confidence": _FLOATS}
_INTERPOLATION = {"columns": _WHOLE, "shares": _SHARES}
_KINDS = {
    **{f"{side}.{name}": kind for side in ("forward", "backward") for name, kind in _POINT_MAP.items()},
    "rows.starts": _WHOLE,
    "rows.columns": _WHOLE,
    "rows.values": _FLOATS,
    **{f"{side}.{name}": kind for side in ("source", "target") for name, kind in _INTERPOLATION.items()},
    "source.triangles": _WHOLE,
    "target.triangles": _WHOLE,
}
"""All arrays in order, with their stored types."""


@dataclass(frozen=True)
class MeshMark:
    """Identifies the mesh for which a map was computed.

    Attributes
    ----------
    vertices, polygons : int
        Number of elements.
    topology : str
        Hash of the vertices at all corners of all polygons.
    shape : str
        Hash of the vertex positions in local space, without modifiers and shape keys.
    """

    vertices: int
    polygons: int
    topology: str
    shape: str


@dataclass(frozen=True)
class MappedSide:
    """One of the two meshes of a stored map.

    Attributes
    ----------
    mark : MeshMark
        Mark of the mesh when the map was computed.
    triangles : (m, 3) int64
        Triangles of the map. Once the object is posed, Blender may triangulate polygons differently.
    """

    mark: MeshMark
    triangles: NDArray[np.int64]


@dataclass(frozen=True)
class StoredSoftMap:
    """A stored map.

    Attributes
    ----------
    found : SurfaceMap
        The map.
    source, target : MappedSide
        The two meshes of the map.
    """

    found: SurfaceMap
    source: MappedSide
    target: MappedSide


def packed(stored: StoredSoftMap) -> bytes:
    """Return a map as bytes; shares are rounded to 16 bits, and numbers to four digits."""
    arrays = _arrays_of(stored)
    found = stored.found
    header = {
        "schema": SCHEMA,
        "sides": [vars(side.mark) for side in (stored.source, stored.target)],
        "record": dict(found.record),
        "notices": [_plain(notice) for notice in found.notices],
    }
    planes = {name: _planes(_stored_form(arrays[name], kind)) for name, kind in _KINDS.items()}
    return array_bytes(planes, json.loads(json.dumps(header, default=_number)), _LEVEL)


def unpacked(data: bytes) -> StoredSoftMap:
    """Return the map from the bytes of `packed`, in the current or the previous format.

    Raises
    ------
    ValueError, TypeError, KeyError, RecursionError
        The bytes are not a map, or damaged; the message gives the reason.
    """
    if not isinstance(data, bytes):
        raise TypeError("it is not made of bytes")
    if is_first_schema(data):
        header, planes = first_schema(data, _KINDS)
    else:
        reader = ArrayReader(BytesIO(data), _MOST_BYTES)
        header = reader.header
        if header["schema"] != SCHEMA:
            raise ValueError(f"schema {header['schema']!r}, while this version reads {SCHEMA}")
        planes = {name: reader.take(name, ("|u1",), (2, 3)) for name in _KINDS}
        reader.end()
    arrays = {name: _usual_form(_of_planes(planes[name], kind), kind) for name, kind in _KINDS.items()}
    _check_sizes(arrays)
    _check_values(arrays)
    return _map_of(header, arrays)


def _arrays_of(stored: StoredSoftMap) -> dict[str, NDArray]:
    found = stored.found
    arrays = {
        f"{side}.{name}": getattr(getattr(found, side), name) for side in ("forward", "backward") for name in _POINT_MAP
    }
    rows = found.coarse
    arrays |= {"rows.starts": rows.starts, "rows.columns": rows.columns, "rows.values": rows.values}
    arrays |= {
        f"{side}.{name}": getattr(getattr(rows, side), name) for side in ("source", "target") for name in _INTERPOLATION
    }
    arrays |= {"source.triangles": stored.source.triangles, "target.triangles": stored.target.triangles}
    return {name: np.asarray(arrays[name]) for name in _KINDS}


def _map_of(header: dict[str, object], arrays: dict[str, NDArray]) -> StoredSoftMap:
    def of(kind: type, place: str, names: Mapping[str, np.dtype]) -> object:
        return kind(**{name: arrays[f"{place}.{name}"] for name in names})

    source, target = (of(VertexInterpolation, side, _INTERPOLATION) for side in ("source", "target"))
    rows = CoarseRows(
        arrays["rows.starts"].astype(np.int64), arrays["rows.columns"], arrays["rows.values"], source, target
    )
    forward, backward = (of(PointMap, side, _POINT_MAP) for side in ("forward", "backward"))
    if not isinstance(header["record"], dict):
        raise TypeError("the record is not a table")
    found = SurfaceMap(forward, backward, rows, header["record"], tuple(map(_sentence, header["notices"])))
    first, second = header["sides"]
    return StoredSoftMap(found, _side(first, arrays["source.triangles"]), _side(second, arrays["target.triangles"]))


def _side(mark: object, triangles: NDArray[np.int32]) -> MappedSide:
    read = MeshMark(**mark)
    kinds = (int, int, str, str)
    if not all(isinstance(value, kind) for value, kind in zip(vars(read).values(), kinds, strict=True)):
        raise TypeError("the mark of a mesh is not made of two numbers and two texts")
    return MappedSide(read, triangles.astype(np.int64))


def _plain(sentence: Sentence) -> list[object]:
    values = {
        name: {"sentence": _plain(value)} if isinstance(value, Sentence) else value
        for name, value in sentence.values.items()
    }
    return [sentence.template, values]


def _sentence(plain: object) -> Sentence:
    template, values = plain
    if not (isinstance(template, str) and isinstance(values, dict)):
        raise TypeError("a notice is not a text with values")
    read = {name: _sentence(value["sentence"]) if isinstance(value, dict) else value for name, value in values.items()}
    made = Sentence(template, read)
    if not made.is_plain:
        raise ValueError("a notice asks for more than its values")
    str(made)
    return made


def _number(value: object) -> object:
    """Convert a NumPy number or array to a value for JSON."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is none of what a record holds")


def _stored_form(array: NDArray, kind: np.dtype) -> NDArray:
    """Return an array in its stored type, without excess digits."""
    if kind == _SHARES:
        return np.rint(np.clip(array, 0.0, 1.0) * _ONE).astype(kind)
    if kind == _FLOATS:
        bits = np.ascontiguousarray(array, dtype=kind).view("<u4") & _KEPT_BITS
        return bits.view(kind)
    # Neighbors have similar values.
    whole = array.astype(kind)
    return np.diff(whole, axis=0, prepend=np.zeros((1, *whole.shape[1:]), kind))


def _usual_form(array: NDArray, kind: np.dtype) -> NDArray:
    """Undo `_stored_form`."""
    if kind == _SHARES:
        sums = array.sum(axis=1, keepdims=True, dtype=np.float64)
        return np.divide(array, sums, out=np.zeros(array.shape), where=sums > 0).astype(np.float32)
    return array if kind == _FLOATS else np.cumsum(array, axis=0, dtype=kind)


def _planes(array: NDArray) -> NDArray[np.uint8]:
    """Return the stored bytes of an array, (rows,) or (rows, columns)."""
    columns = np.ascontiguousarray(array.T)
    return np.moveaxis(columns.view(np.uint8).reshape(*columns.shape, array.dtype.itemsize), -1, 0)


def _of_planes(planes: NDArray[np.uint8], kind: np.dtype) -> NDArray:
    """Undo `_planes`."""
    if len(planes) != kind.itemsize or planes.shape[1:-1] not in ((), (3,)):
        raise ValueError("the shapes of its arrays are not what they should be")
    values = np.ascontiguousarray(np.moveaxis(planes, 0, -1)).view(kind)[..., 0]
    return np.ascontiguousarray(values.T)


def _check_sizes(arrays: dict[str, NDArray]) -> None:
    """Raise an error if arrays do not match."""
    vertices = {"forward": len(arrays["forward.faces"]), "backward": len(arrays["backward.faces"])}
    vertices |= {"source": vertices["forward"], "target": vertices["backward"]}
    flat = {"faces", "spread", "entropy", "confidence", "starts", "values"}
    for name, array in arrays.items():
        side, _, own = name.partition(".")
        is_flat = own in flat or name == "rows.columns"
        count = vertices.get(side, len(array)) if own != "triangles" else len(array)
        if array.shape != ((count,) if is_flat else (count, 3)):
            raise ValueError(f"{name} has the shape {array.shape}")
    starts = arrays["rows.starts"]
    ordered = len(starts) > 0 and starts[0] == 0 and (np.diff(starts) >= 0).all()
    if not (ordered and starts[-1] == len(arrays["rows.columns"]) == len(arrays["rows.values"])):
        raise ValueError("its rows do not begin where they should")


def _check_values(arrays: dict[str, NDArray]) -> None:
    """Raise an error if indices are out of range."""
    counts = {"source": len(arrays["forward.faces"]), "target": len(arrays["backward.faces"])}
    triangles = {side: arrays[f"{side}.triangles"] for side in counts}
    coarse = len(arrays["rows.starts"]) - 1
    _require_within(triangles["source"], 0, counts["source"], "source.triangles")
    _require_within(triangles["target"], 0, counts["target"], "target.triangles")
    _require_within(arrays["forward.faces"], -1, len(triangles["target"]), "forward.faces")
    _require_within(arrays["backward.faces"], -1, len(triangles["source"]), "backward.faces")
    _require_within(arrays["source.columns"], 0, max(coarse, 1), "source.columns")
    for name in ("rows.columns", "target.columns"):
        _require_within(arrays[name], 0, max(counts["target"], 1), name)
    for name, kind in _KINDS.items():
        if kind == _FLOATS and np.isnan(arrays[name]).any():
            raise ValueError(f"{name} holds what is no number")
    if not np.isfinite(arrays["rows.values"]).all():
        raise ValueError("rows.values are not finite")


def _require_within(array: NDArray, least: int, end: int, name: str) -> None:
    if array.size and not (array.min() >= least and array.max() < end):
        raise ValueError(f"{name} are not from {least} to {end - 1}")
