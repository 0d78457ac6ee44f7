# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sample the signed distances of baked blends for :mod:`.stored_fields`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, maximum_filter

from ....applications.morphs.extraction import EXTRACTION_BLUR
from ....errors import InputError
from ....geometry.algebra.affine import transformed_points
from ....geometry.arrays.bounds import common_bounds
from ....geometry.level_sets.isosurface import surface_enclosing
from ....geometry.meshes.centroid import centroid
from ....geometry.meshes.edges import topology
from ....geometry.meshes.mesh import TriangleMesh
from ....geometry.meshes.welding import welded
from ....geometry.solids.occupancy import occupancy
from ....geometry.solids.orientation import orient_outward
from ....geometry.solids.thicken import solid_or_shell_occupancy
from ....progress import UNINTERRUPTED, Control, Progress, Work, drained
from ....sentence import Sentence
from ...animation_time import returning, show_time
from ...element_values import write_attribute
from ...files.openvdb_module import openvdb_module
from ...objects import triangle_meshes
from ...sequence import write_table
from ..inputs.followed_inputs import stays_animated
from ..stand_ins import adopt, hide_fields
from ..stored import frame_times, frame_weights, stored_morph
from .field_sampler import SampleGrid, field_sampler
from .stored_fields import (
    BAND,
    COLOR,
    ENCLOSED,
    FIELD,
    LOSES_PARTS,
    OFFSET,
    SCALE,
    VOLUME,
    Column,
    StoredFields,
    field_cells,
)

# Margin of samples around all blends.
_MARGIN = 3
# A part is missing where so many samples in it are lost, at least so deep inside of it, in cells.
_LEAST_LOST, _LEAST_HALF = 4, 0.4
# More samples take more than a second for each moment (docs/performance, "Moments of players").
_MOST_SAMPLES = 4_000_000


@dataclass(frozen=True)
class BlendMeshes:
    """Baked blends as arrays.

    Attributes
    ----------
    meshes : list of TriangleMesh
        One per blend, in local space of its object.
    weights : (n, k) float64
        Weights of the shapes.
    cells : float
        Cells of the fields along the longest side.
    """

    meshes: list[TriangleMesh]
    weights: NDArray[np.float64]
    cells: float


@dataclass(frozen=True)
class SampledFields:
    """Signed distances of blends, not stored yet.

    Attributes
    ----------
    grid : SampleGrid
        Positions of the samples, relative to the center of a blend.
    steps : list of (m,) int8
        Distances in steps, per blend.
    columns : list of Column
        Columns of the table, with one row per blend.
    """

    grid: SampleGrid
    steps: list[NDArray[np.int8]]
    columns: list[Column]


def read_blends(collection: bpy.types.Collection, frames: Sequence[bpy.types.Object]) -> BlendMeshes:
    """Read the blends of a morph for :func:`sample_fields`, with ends that stay animated as they are at their times.

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph.
    frames : sequence of bpy.types.Object
        Its frame objects.

    Raises
    ------
    InputError
        Blender lacks OpenVDB's Python module.
    """
    if openvdb_module() is None:
        raise InputError(
            "Interpolation requires OpenVDB for Python, which this Blender lacks; use another Blender, or set In "
            "Between to Nearest Blend."
        )
    meshes = _local_meshes(frames)
    ends = [number for number, obj in enumerate(frames) if stays_animated(obj)]
    if ends:
        times = frame_times(collection)
        with returning(bpy.context.scene):
            for number in ends:
                show_time(bpy.context.scene, times[number])
                meshes[number : number + 1] = _local_meshes([frames[number]])
    return BlendMeshes(meshes, frame_weights(frames), field_cells(stored_morph(collection)))


def sample_fields(blends: BlendMeshes, control: Control) -> Work[SampledFields]:
    """Sample the signed distances of blends; any thread may do this.

    Parameters
    ----------
    blends : BlendMeshes
        As `read_blends` returns them.
    control : Control
        Stops the work.

    Yields
    ------
    Progress
        Yielded after every blend.
    """
    meshes, openvdb = blends.meshes, openvdb_module()
    offsets = _centers(meshes, blends.weights)
    grid = _grid(meshes, offsets, blends.cells)
    stored, volumes, enclosed, lost, last = [], [], [], [], None
    for number, (mesh, offset, own) in enumerate(zip(meshes, offsets, blends.weights, strict=True), start=1):
        control.check()
        inner = TriangleMesh((mesh.vertices - offset - grid.low) / grid.spacing, mesh.faces)
        closed = closed_surface(inner, grid.shape, control) if own.max() == 1.0 else inner
        control.check()
        field = signed_distances(openvdb, closed, grid.shape)
        steps = np.rint(field * SCALE).astype(np.int32)
        stored.append(steps.astype(np.int8).ravel())
        volumes.append(counted_volume(steps / SCALE))
        enclosed.append(abs(closed.volume) * grid.spacing**3)
        if last is not None:
            lost.append(float(_loses_parts(last, field)))
        last = field
        done = {"done": number, "total": len(meshes)}
        yield Progress(number / len(meshes), Sentence("Blend {done} of {total}", done))
    columns = [
        Column(OFFSET, "FLOAT_VECTOR", offsets),
        Column(VOLUME, "FLOAT", np.array(volumes)),
        Column(ENCLOSED, "FLOAT", np.array(enclosed)),
        Column(LOSES_PARTS, "FLOAT", np.array([*lost, 0.0])),
    ]
    return SampledFields(grid, stored, columns)


def sampled_fields(collection: bpy.types.Collection, frames: Sequence[bpy.types.Object]) -> SampledFields:
    """Read the blends of a morph, given its frame objects, and sample them; raises as :func:`read_blends`."""
    return drained(sample_fields(read_blends(collection, frames), UNINTERRUPTED))


def store_fields(
    collection: bpy.types.Collection,
    frames: Sequence[bpy.types.Object],
    sampled: SampledFields,
    places: NDArray[np.float64],
    columns: Sequence[Column],
) -> StoredFields:
    """Store sampled distances with their morph.

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph.
    frames : sequence of bpy.types.Object
        Its frame objects.
    sampled : SampledFields
        Their distances.
    places : (n, 3)
        Vertices of the table, one per blend.
    columns : sequence of Column
        Further columns of the table.
    """
    name, grid = collection.name, sampled.grid
    data = bpy.data.meshes.new(f"{name} Fields")
    data.vertices.add(int(np.prod(grid.shape)))
    for number, steps in enumerate(sampled.steps):
        write_attribute(data, FIELD.format(number), "INT8", steps)
    colors = Column(COLOR, "FLOAT_COLOR", np.array([tuple(obj.color) for obj in frames]))
    table = _table(name, places, [*sampled.columns, colors, *columns])
    samples = bpy.data.objects.new(data.name, data)
    fields = StoredFields(samples, table, field_sampler(f"{name} Sampler", grid), grid)
    hide_fields(data.name, [samples, table])
    adopt(collection, fields.blocks)
    return fields


def _grid(meshes: Sequence[TriangleMesh], offsets: NDArray[np.float64], cells: float) -> SampleGrid:
    """Return a grid around meshes at their centers, with larger cells if it would exceed `_MOST_SAMPLES`."""
    low, high = common_bounds([mesh.bounds - offset for mesh, offset in zip(meshes, offsets, strict=True)])
    spacing = float((high - low).max()) / cells
    count = float(np.prod((high - low) / spacing + 2 * _MARGIN + 1))
    spacing *= max(count / _MOST_SAMPLES, 1.0) ** (1.0 / 3.0)
    shape = np.ceil((high - low) / spacing).astype(int) + 2 * _MARGIN + 1
    return SampleGrid(low - _MARGIN * spacing, spacing, tuple(int(n) for n in shape))


def counted_volume(field: NDArray[np.floating]) -> float:
    """Return the volume of a field of signed distances in cells, as the nodes do, with partial cells at the surface."""
    return float(np.clip(field + 0.5, 0.0, 1.0).sum())


def _loses_parts(first: NDArray[np.float32], second: NDArray[np.float32]) -> bool:
    """Tell whether halfway between two fields a part is missing, since it moves by more than it is thick.

    What is inside of one of the blends there has nothing of the mixture within `BAND` cells.
    """
    empty = maximum_filter(0.5 * (first + second), 2 * int(BAND) + 1) <= 0.0
    return np.count_nonzero(empty & (np.maximum(first, second) > _LEAST_HALF)) >= _LEAST_LOST


def signed_distances(openvdb: ModuleType, mesh: TriangleMesh, shape: tuple[int, int, int]) -> NDArray[np.float32]:
    """Sample the signed distance of a mesh, (nx, ny, nz), positive inside, up to `BAND`.

    Parameters
    ----------
    openvdb : module
        See :func:`.openvdb_module.openvdb_module`.
    mesh : TriangleMesh
        Closed, in cells: sample (i, j, k) is at this point.
    shape : (int, int, int)
        Samples along the axes.
    """
    grid = openvdb.FloatGrid.createLevelSetFromPolygons(
        mesh.vertices.astype(np.float32),
        triangles=mesh.faces.astype(np.uint32),
        transform=openvdb.createLinearTransform(1.0),
        halfWidth=BAND,
    )
    distances = np.empty(shape, np.float32)
    grid.copyToArray(distances, ijk=(0, 0, 0))
    return np.clip(-distances, -BAND, BAND)


def closed_surface(mesh: TriangleMesh, shape: tuple[int, int, int], control: Control = UNINTERRUPTED) -> TriangleMesh:
    """Return a mesh that bounds a solid: the mesh itself, or the surface of its cells at this resolution.

    Parameters
    ----------
    mesh : TriangleMesh
        In cells, as for `signed_distances`; may be open, self-intersecting or nested, like shapes of users.
    shape : (int, int, int)
        Samples along the axes.
    control : Control
        Stops the work.
    """
    whole = welded(mesh)
    control.check()
    if len(whole.faces) and topology(whole).closed:
        outward = orient_outward(whole)
        control.check()
        filled = occupancy(outward.corners + 0.5, shape, control)
        if abs(filled.sum() - outward.volume) <= 0.01 * outward.volume:
            return outward
    else:
        outward = orient_outward(mesh)
    control.check()
    filled = solid_or_shell_occupancy(outward.corners + 0.5, shape, control)
    control.check()
    surface = surface_enclosing(gaussian_filter(filled, EXTRACTION_BLUR), float(filled.sum(dtype=np.float64)))
    return surface.mesh.moved((-0.5, -0.5, -0.5))


def _local_meshes(frames: Sequence[bpy.types.Object]) -> list[TriangleMesh]:
    """Read frame objects as they are now, in their local spaces."""
    found = triangle_meshes(frames, bpy.context.evaluated_depsgraph_get())
    return [
        TriangleMesh(transformed_points(mesh.vertices, obj.matrix_world.inverted()), mesh.faces)
        for obj, mesh in zip(frames, found, strict=True)
    ]


def _centers(meshes: Sequence[TriangleMesh], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weighted means of the centers of the shapes, (n, 3), as the blends define them."""
    found = np.array([centroid(mesh) for mesh in meshes])
    return weights @ np.linalg.lstsq(weights, found, rcond=None)[0]


def _table(name: str, places: NDArray[np.float64], columns: Sequence[Column]) -> bpy.types.Object:
    """Create the object whose mesh is the table of the blends."""
    mesh = bpy.data.meshes.new(f"{name} Steps")
    write_table(mesh, places)
    for column in columns:
        write_attribute(mesh, column.name, column.kind, column.values)
    return bpy.data.objects.new(mesh.name, mesh)
