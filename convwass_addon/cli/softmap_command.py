# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``softmap``."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..applications.soft_maps.map_extension import DOUBTFUL
from ..applications.soft_maps.map_repair import repaired_map
from ..applications.soft_maps.map_solving import soft_map_steps
from ..applications.soft_maps.mirror_maps import mirror_map_steps
from ..applications.soft_maps.soft_map_settings import SoftMapSettings
from ..applications.soft_maps.surface_maps import PointMap, SurfaceMap
from ..bridge.color_attributes import color_names
from ..bridge.soft_maps.carried_groups import CarriedGroups
from ..bridge.soft_maps.carried_keys import CarriedKeys
from ..bridge.soft_maps.carried_layers import CarriedColors, CarriedUvs
from ..bridge.soft_maps.map_pairs import pairs_from_empties, pairs_from_groups
from ..bridge.soft_maps.map_shape_keys import key_names
from ..bridge.soft_maps.map_transfer import CarriedPart, TransferEnds, all_carried, require_names
from ..bridge.soft_maps.mapped_meshes import equal_groups, map_side, resting_mesh
from ..bridge.soft_maps.soft_map_bytes import StoredSoftMap
from ..bridge.soft_maps.soft_map_requests import MapRequest, TransferRequest
from ..bridge.soft_maps.soft_map_store import mapped_side, store_soft_map
from ..bridge.surfaces import SurfaceReading, read_surface
from ..bridge.uv_maps import uv_names
from ..bridge.vertex_groups import group_names
from ..console import ProgressBar
from ..errors import InputError
from .answer import Answer
from .from_schema import given_settings
from .reports import checked_outputs, note, saved
from .softmap_inputs import open_objects

# The map before it is computed.
_NO_POINTS = PointMap(np.zeros(0, np.int32), np.zeros((0, 3)), *3 * [np.zeros(0)])

# The names of the data of every kind.
_NAMES = {"weights": group_names, "keys": key_names, "uvs": uv_names, "colors": color_names}


@dataclass(frozen=True)
class _Ends:
    """The two objects and their surfaces.

    Attributes
    ----------
    source, target : bpy.types.Object
        Identical for a mirror map.
    readings : (SurfaceReading, SurfaceReading)
        Their surfaces in the scene.
    """

    source: bpy.types.Object
    target: bpy.types.Object
    readings: tuple[SurfaceReading, SurfaceReading]


def run_softmap(options: Namespace) -> Answer:
    """Compute a soft map, transfer data with it and save the result.

    Raises
    ------
    InputError, ResourceError
        The meshes, pairs or options cannot be used.
    """
    _check_options(options)
    target, report = checked_outputs(options, [text for text in (options.source, options.target) if text is not None])
    settings = SoftMapSettings(**given_settings(options, SoftMapSettings))
    request = TransferRequest(**given_settings(options, TransferRequest))
    ends = _opened_ends(options)
    pairs = _pairs(options, ends)
    way = _way(options, request, ends)
    known = [name for kind in dict.fromkeys(options.transfer) for name in _NAMES[kind](way.giver)]
    require_names(way.giver, known, options.names)
    # These check what is transferred, before the work begins.
    _parts(options, way)
    found = _solved(options, ends, pairs, settings)
    note(*found.notices)
    marks = (
        mapped_side(ends.source, ends.readings[0].mesh.faces),
        mapped_side(ends.target, ends.readings[1].mesh.faces),
    )
    store_soft_map(ends.source, ends.target, StoredSoftMap(found, *marks))
    record = _record(ends, pairs, found) | {"transferred": _transferred(options, way, found)}
    return saved(target, report, record)


def _check_options(options: Namespace) -> None:
    if options.mirror == (options.target is not None):
        raise InputError("Name two meshes, or one mesh with --mirror.")
    if options.mirror and {"uvs", "colors"} & set(options.transfer):
        raise InputError("A mirror map can transfer weights and keys, but not UV maps or colors.")
    if options.repair is not None and not 0.0 <= options.repair <= 1.0:
        raise InputError("The threshold must lie between 0 and 1.")
    if options.names and not options.transfer:
        raise InputError("--names requires --transfer with the kinds of data that have these names.")
    if options.pairs and options.pairs_from:
        raise InputError("--pairs and --pairs-from cannot be combined; choose one.")


def _opened_ends(options: Namespace) -> _Ends:
    with ProgressBar("Reading the meshes") as bar:
        source, target = open_objects(options.source, options.target)
        if source == target and not options.mirror:
            raise InputError("Both names refer to {object}; name another object, or use --mirror.", object=source.name)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        readings = tuple(read_surface(obj, depsgraph) for obj in (source, target))
        bar.show(1.0, f"{source.name}, {target.name}")
    ignored = dict.fromkeys(name for reading in readings for name in reading.ignored)
    if ignored:
        note(f"modifiers that change the vertices are ignored: {', '.join(ignored)}")
    return _Ends(source, target, readings)


def _pairs(options: Namespace, ends: _Ends) -> np.ndarray:
    """Return the pairs given or found, (k, 2)."""
    if not options.pairs_from:
        return np.array(options.pairs, dtype=np.int64).reshape(-1, 2)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if options.pairs_from == "groups":
        found = pairs_from_groups(ends.source, ends.target, depsgraph)
    else:
        found = pairs_from_empties(ends.source, ends.target, depsgraph, bpy.context.scene.objects)
    if not found.pairs:
        raise InputError(
            "{source} and {target} have no {kind} with the same names; mark some.",
            source=ends.source.name,
            target=ends.target.name,
            kind=options.pairs_from,
        )
    return np.array([(pair.source, pair.target) for pair in found.pairs], dtype=np.int64)


def _solved(options: Namespace, ends: _Ends, pairs: np.ndarray, settings: SoftMapSettings) -> SurfaceMap:
    use_groups = MapRequest(**given_settings(options, MapRequest)).use_groups
    groups = equal_groups(ends.source, ends.target) if use_groups else []
    objects = (ends.source, ends.target)
    sides = [map_side(obj, reading, groups) for obj, reading in zip(objects, ends.readings, strict=True)]
    work = mirror_map_steps(sides[0], pairs, settings) if options.mirror else soft_map_steps(*sides, pairs, settings)
    with ProgressBar("Computing the map") as bar:
        found = bar.result_of(work)
    if options.repair is None:
        return found
    return repaired_map(found, *(reading.mesh for reading in ends.readings), options.repair)


def _parts(options: Namespace, way: TransferEnds) -> dict[str, CarriedPart]:
    """Return the data to transfer, by kind."""
    makers = {"weights": CarriedGroups, "keys": CarriedKeys, "uvs": CarriedUvs, "colors": CarriedColors}
    return {kind: makers[kind](way) for kind in dict.fromkeys(options.transfer)}


def _transferred(options: Namespace, way: TransferEnds, found: SurfaceMap) -> dict[str, list[str]]:
    """Transfer the requested data and return the names written, by kind."""
    points = found.forward if way.is_backward else found.backward
    parts = _parts(options, replace(way, points=points))
    if parts:
        with ProgressBar("Transferring") as bar:
            bar.result_of(all_carried(parts.values()))
    names = {}
    for kind, part in parts.items():
        done = part.write(way.receiver)
        names[kind] = list(done.written)
        note(*done.notices)
        if done.kept:
            note(f"left as they were: {', '.join(done.kept)}")
    return names


def _way(options: Namespace, request: TransferRequest, ends: _Ends) -> TransferEnds:
    """Return the ends of the transfer, still without the map."""
    objects, readings = (ends.source, ends.target), ends.readings
    if request.direction == "BACKWARD":
        objects, readings = objects[::-1], readings[::-1]
    meshes = [resting_mesh(obj, reading.mesh.faces) for obj, reading in zip(objects, readings, strict=True)]
    return TransferEnds(*objects, _NO_POINTS, *meshes, tuple(options.names), request)


def _record(ends: _Ends, pairs: np.ndarray, found: SurfaceMap) -> dict[str, object]:
    return {
        "source": ends.source.name,
        "target": ends.target.name,
        **found.record,
        "pairs": pairs.tolist(),
        "forward": _figures(found.forward),
        "backward": _figures(found.backward),
        "notices": [str(notice) for notice in found.notices],
    }


def _figures(points: PointMap) -> dict[str, object]:
    """Summarize the confidence of a point map."""
    confidence = points.confidence
    return {
        "vertices": len(points),
        "without_point": int((~points.found).sum()),
        "doubtful": int((confidence < DOUBTFUL).sum()),
        "median_confidence": float(np.median(confidence)),
    }
