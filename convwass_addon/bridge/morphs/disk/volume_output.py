# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a morph as VDB files, shown by a Volume object and a mesh with adjustable level and smoothing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ....disk_space import require_space
from ....drafts import written_together
from ....errors import InputError
from ....geometry.arrays.bounds import common_bounds
from ....geometry.meshes.mesh import TriangleMesh
from ....geometry.solids.occupancy import occupancy
from ....progress import Progress, Work
from ....sentence import Sentence
from ...files.numbered_files import file_number, numbered_paths
from ...files.openvdb_module import openvdb_module
from ...objects import triangle_meshes
from ...render_settings import take_render_settings
from ...visibility import layers_with
from ..looks.materials import morph_material
from ..stored import frame_objects, shown_frames, some_frame_objects, stored_morph
from .disk_output import OUTPUT_KEY, DiskOutput, disk_outputs, for_blender, readers_along, remember_readers
from .still_frames import still_frames

GRID_NAME = "density"

OFFSET_KEY = "convwass_offset"
"""Custom property of a Volume object: by how much it is shifted along all axes."""

# Cells over which coverage is averaged: this limits how far other levels can move the surface.
_BLUR = 1.0
_MARGIN = 4
# Values below this are empty space in the file.
_EMPTY = 1e-3
_LEVEL = 0.5
# OpenVDB refuses smaller cells, in scene units; see `tests/operators/test_morph_output.py`.
_LEAST_SPACING = 1.45e-5


def as_volume(collection: bpy.types.Collection, folder: Path) -> Work[DiskOutput]:
    """Write a morph as VDB files, one per scene frame, and let objects show them, which are kept if they exist.

    A file contains one grid, "density": the covered share of every cell, averaged over a cell. The surface of the frame
    is its level set at one half.

    Parameters
    ----------
    collection : bpy.types.Collection
        A baked morph with its frames, which are kept.
    folder : Path
        An existing folder, which gives the files their name; those of the same name are replaced once all are
        complete, but Blender shows their old content until it ends.

    Yields
    ------
    Progress
        After each file.

    Returns
    -------
    DiskOutput

    Raises
    ------
    InputError
        Blender lacks OpenVDB's Python module (included from 4.5), the collection has no frames, or these are too small.
    ConvwassError
        There is too little free space, or a file could not be written.
    """
    openvdb = openvdb_module()
    if openvdb is None:
        raise InputError(
            "Volumes require OpenVDB for Python, which this Blender lacks; use another Blender, or Make Cache."
        )
    frames = some_frame_objects(collection)
    scene_frames, every, shown = _timeline(collection, frames)
    spacing = _spacing(every, stored_morph(collection).resolution)
    if spacing < _LEAST_SPACING:
        raise InputError(
            "{name} is too small for volumes: its cells would be {spacing:.1e} wide, but must be {least:.1e} or wider. "
            "Scale its shapes up, or choose another output.",
            name=collection.name,
            spacing=spacing,
            least=_LEAST_SPACING,
        )
    numbers = [file_number(frame, scene_frames[0]) for frame in scene_frames]
    files = numbered_paths(folder, f"{folder.name}_", ".vdb", numbers)
    with written_together() as drafts:
        for done, (file, meshes) in enumerate(zip(files, shown, strict=True), 1):
            with drafts.written(file) as draft:
                _write(openvdb, draft, meshes, spacing)
            if done == 1:
                # The others are about as large.
                require_space(folder, (len(files) - 1) * draft.stat().st_size)
            progress = {"done": done, "total": len(shown)}
            yield Progress(done / len(shown), Sentence("Writing {done} of {total}", progress))
    # Before Blender 5, Volume to Mesh places values at the corners of their cells.
    offset = -spacing / 2 if bpy.app.version < (5, 0, 0) else 0.0
    return DiskOutput(_objects(collection, files, scene_frames, offset), tuple(files))


def _spacing(meshes: Sequence[TriangleMesh], resolution: int) -> float:
    """Return the cell size: the resolution of the bake applied to the longest side of all frames."""
    low, high = common_bounds([mesh.bounds for mesh in meshes])
    return float((high - low).max()) / resolution


def _timeline(
    collection: bpy.types.Collection, frames: list[bpy.types.Object]
) -> tuple[range, list[TriangleMesh], list[list[TriangleMesh]]]:
    """Return the scene frames of a morph, its meshes, and those visible at each; a sheet is one frame with all."""
    span, now = shown_frames(collection), bpy.context.scene.frame_current
    with still_frames(frames, span) as still:
        objects = still.all
        meshes = dict(zip(objects, triangle_meshes(objects, bpy.context.evaluated_depsgraph_get()), strict=True))
        shown = [[meshes[obj] for obj in group] for group in (still.shown if span else [still.first])]
    return span or range(now, now + 1), list(meshes.values()), shown


def _write(openvdb: ModuleType, file: Path, meshes: Sequence[TriangleMesh], spacing: float) -> None:
    """Write a VDB file."""
    grid = openvdb.FloatGrid()
    grid.name = GRID_NAME
    grid.gridClass = openvdb.GridClass.FOG_VOLUME
    if meshes:
        low, high = common_bounds([mesh.bounds for mesh in meshes])
        low, high = low - _MARGIN * spacing, high + _MARGIN * spacing
        shape = tuple(int(n) for n in np.ceil((high - low) / spacing))
        grid.copyFromArray(_filled(meshes, low, spacing, shape), tolerance=_EMPTY)
        # Values are located at cell centers.
        grid.transform = openvdb.createLinearTransform(voxelSize=spacing)
        grid.transform.postTranslate(tuple(float(x) for x in low + spacing / 2))
    openvdb.write(str(file), grids=[grid])


def _filled(
    meshes: Sequence[TriangleMesh], low: NDArray[np.float64], spacing: float, shape: tuple[int, int, int]
) -> NDArray[np.float32]:
    filled = np.zeros(shape, np.float32)
    for mesh in meshes:
        np.maximum(filled, occupancy((mesh.corners - low) / spacing, shape), out=filled)
    soft = gaussian_filter(filled, _BLUR)
    return np.ascontiguousarray(np.where(soft > _EMPTY, soft, 0.0), dtype=np.float32)


def _objects(
    collection: bpy.types.Collection, files: list[Path], scene_frames: range, offset: float
) -> bpy.types.Object:
    """Let the objects of a volume read files, and return the mesh object; missing ones are created.

    A new Volume object is hidden. It is shifted along all axes; one that exists stays where its user has moved it.
    """
    there = {obj.type: obj for obj in reversed(disk_outputs(collection))}
    volume = there.get("VOLUME") or _volume_object(collection)
    _read(_own_data(collection, volume), files, scene_frames)
    shift = offset - volume.get(OFFSET_KEY, offset)
    volume.location = [place + shift for place in volume.location]
    volume[OFFSET_KEY] = offset
    shown = there.get("MESH") or _mesh_object(collection, volume)
    for modifier in (own for own in shown.modifiers if own.type == "VOLUME_TO_MESH" and own.object is None):
        # The object that it read was deleted.
        modifier.object = volume
    if "VOLUME" not in there:
        _hide(volume)
    remember_readers(collection, [volume, shown])
    return shown


def _own_data(collection: bpy.types.Collection, volume: bpy.types.Object) -> bpy.types.Volume:
    """Return the data of a Volume object, with which duplicates follow it, but not a copy of the morph."""
    users = [obj for obj in bpy.data.objects if obj.data == volume.data]
    along = readers_along(collection, users)
    if along != users:
        data = volume.data.copy()
        for obj in along:
            obj.data = data
    return volume.data


def _hide(volume: bpy.types.Object) -> None:
    """Hide a new object in the viewport; its surface is shown instead."""
    bpy.context.view_layer.update()
    for layer in layers_with(volume, [bpy.context.scene]):
        volume.hide_set(True, view_layer=layer)


def _read(data: bpy.types.Volume, files: list[Path], scene_frames: range) -> None:
    data.filepath = for_blender(files[0])
    data.is_sequence = len(files) > 1
    if data.is_sequence:
        first = scene_frames[0]
        data.frame_start, data.frame_duration, data.frame_offset = first, len(files), file_number(first, first) - 1
        data.sequence_mode = "EXTEND"


def _volume_object(collection: bpy.types.Collection) -> bpy.types.Object:
    name = f"{collection.name} Volume"
    volume = bpy.data.objects.new(name, bpy.data.volumes.new(name))
    volume[OUTPUT_KEY] = "volume"
    volume[OFFSET_KEY] = 0.0
    volume.hide_render = True
    collection.objects.link(volume)
    return volume


def _mesh_object(collection: bpy.types.Collection, volume: bpy.types.Object) -> bpy.types.Object:
    name = f"{collection.name} Surface"
    shown = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    shown[OUTPUT_KEY] = "volume"
    take_render_settings(shown, frame_objects(collection))
    shown.data.materials.append(morph_material())
    modifier = shown.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
    modifier.object = volume
    modifier.grid_name = GRID_NAME
    modifier.threshold = _LEVEL
    modifier.resolution_mode = "GRID"
    modifier.use_smooth_shade = True
    # The solver's result is already smooth; the user can increase this.
    smooth = shown.modifiers.new("Smooth", "SMOOTH")
    smooth.iterations = 0
    collection.objects.link(shown)
    return shown
