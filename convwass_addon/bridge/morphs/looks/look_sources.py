# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read what the materials of the inputs read: UV maps, attributes, and positions in the inputs' own space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
import numpy as np

from ....applications.morphs.appearance import Appearance
from ....applications.morphs.carried_uvs import UvMap
from ....geometry.algebra.affine import transformed_points
from ....geometry.meshes.normals import unit_vectors
from ...element_values import element_values, triangle_corners, triangle_polygons, write_attribute
from ...joined_shapes import OWN_POSITION
from ...nodes.shown_nodes import nodes_of
from ...rendered_maps import render_colors, render_uv_map
from ..inputs.frozen_inputs import FrozenInput
from .appearance import write_source_weights
from .frame_attributes import GENERATED, LOOKS, REST_NORMAL, REST_POSITION
from .look_groups import CarriedNames

# Attributes that can be interpolated: the property of their values and its components.
_VALUES = {
    "FLOAT": ("value", 1),
    "INT": ("value", 1),
    "INT8": ("value", 1),
    "BOOLEAN": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
    "QUATERNION": ("value", 4),
}
_TYPES = {"BOOLEAN": bool, "INT": np.int32, "INT8": np.int32}
_KINDS = {1: "FLOAT", 2: "FLOAT2", 3: "FLOAT_VECTOR", 4: "FLOAT_COLOR"}


def carried_names(number: int, mesh: bpy.types.Mesh, source: FrozenInput) -> CarriedNames:
    """Describe what the materials of an input can read.

    Parameters
    ----------
    number : int
        Number of the input, from 1.
    mesh : bpy.types.Mesh
        A frozen copy.
    source : FrozenInput
        The input.
    """
    color_map, uv_map = render_colors(mesh), render_uv_map(mesh)
    return CarriedNames(
        number=number,
        uv_maps=[layer.name for layer in mesh.uv_layers],
        attributes=[*(own.name for own in mesh.attributes if own.data_type in _VALUES), *source.groups],
        default_uv="" if uv_map is None else uv_map.name,
        default_color="" if color_map is None else color_map.name,
        values_of_object=source.values,
    )


def with_looks(
    appearance: Appearance, mesh: bpy.types.Mesh, source: FrozenInput, names: CarriedNames, always: Sequence[str]
) -> Appearance:
    """Add to the appearance of an input what its materials read.

    Parameters
    ----------
    appearance : Appearance
        Of the input.
    mesh : bpy.types.Mesh
        A frozen copy.
    source : FrozenInput
        The input.
    names : CarriedNames
        What its materials read.
    always : sequence of str
        Names on frames of positions to add in any case.
    """
    loops = triangle_corners(mesh, "loops")
    repeats = _repeats([mesh.materials[slot] for slot in np.unique(appearance.materials) if len(mesh.materials)])
    uv_maps = {}
    for carried, name in names.uvs.items():
        uvs = element_values(mesh.uv_layers[name].uv, "vector", 2)
        corners = uvs[loops].astype(np.float64)
        uv_maps[carried] = UvMap(appearance.corners, appearance.faces, corners, repeats)
    fields = {carried: _corner_values(mesh, name, appearance, loops) for carried, name in names.values.items()}
    wanted = {*names.vectors, *always}
    number = names.number
    if wanted & {REST_POSITION.format(number), GENERATED.format(number)}:
        own = _own_positions(mesh, source)
        low, high = own.min(axis=0), own.max(axis=0)
        spread = np.where(high > low, high - low, 1.0)
        positions = {REST_POSITION.format(number): own, GENERATED.format(number): (own - low) / spread}
        fields |= {name: values[appearance.faces] for name, values in positions.items() if name in wanted}
    if REST_NORMAL.format(number) in wanted:
        normals = element_values(mesh.corner_normals, "vector", 3)
        turned = normals[loops] @ np.linalg.pinv(source.own_space[:3, :3])
        fields[REST_NORMAL.format(number)] = unit_vectors(turned.reshape(-1, 3)).reshape(turned.shape)
    fields = {name: np.asarray(values, np.float32) for name, values in fields.items()}
    return replace(appearance, uv_maps=uv_maps, fields=fields)


def write_looks(
    mesh: bpy.types.Mesh,
    uvs: dict[str, np.ndarray],
    fields: dict[str, np.ndarray],
    sources: np.ndarray | None,
) -> None:
    """Write carried UV maps and other attributes to a frame.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        A frame with matching vertices.
    uvs : dict of str to (m, 3, 2)
        UVs of the corners of triangles. The first map becomes the active one, which exporters write first.
    fields : dict of str to (n, d)
        Values of the vertices.
    sources : (c,) int or None
        For each corner of the mesh, the corner of a triangle that it is, 3 f + c; None if in the same order.
    """
    for name, corners in uvs.items():
        values = corners.reshape(-1, 2)
        values = _rounded(values if sources is None else values[sources])
        write_attribute(mesh, name, "FLOAT2", values, "CORNER")
    for name in list(uvs)[:1]:
        mesh.uv_layers.active = mesh.uv_layers[name]
        mesh.uv_layers[name].active_render = True
    for name, values in fields.items():
        _write(mesh, name, values)
    _write(mesh, LOOKS, np.ones((len(mesh.vertices), 1), np.float32))


def write_own_looks(mesh: bpy.types.Mesh, appearance: Appearance, number: int, count: int) -> None:
    """Write to a frozen copy of an input what the materials of frames read, as if it were a frame.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The copy, with triangles or other polygons.
    appearance : Appearance
        Of the input, with what its materials read.
    number, count : int
        Number of the input, from 1, and how many inputs there are.
    """
    names = [layer.name for layer in mesh.uv_layers]
    loops = triangle_corners(mesh, "loops")
    for name, uv_map in appearance.uv_maps.items():
        if name not in names:
            values = np.zeros((len(mesh.loops), 2), np.float32)
            values[loops] = uv_map.uvs
            write_attribute(mesh, name, "FLOAT2", values, "CORNER")
    for name, corners in appearance.fields.items():
        values = np.zeros((len(mesh.vertices), corners.shape[2]), np.float32)
        values[appearance.faces] = corners
        _write(mesh, name, values)
    write_source_weights(mesh, np.eye(count)[number - 1])
    _write(mesh, LOOKS, np.ones((len(mesh.vertices), 1), np.float32))


def _own_positions(mesh: bpy.types.Mesh, source: FrozenInput) -> np.ndarray:
    """Return the vertices in the own space of their object, (n, 3)."""
    if OWN_POSITION in mesh.attributes:
        return element_values(mesh.attributes[OWN_POSITION].data, "vector", 3).astype(np.float64)
    return transformed_points(element_values(mesh.vertices, "co", 3), source.own_space)


def _corner_values(mesh: bpy.types.Mesh, name: str, appearance: Appearance, loops: np.ndarray) -> np.ndarray:
    """Return the values of an attribute or vertex group at the corners of triangles, (m, 3, d)."""
    attribute = mesh.attributes.get(name)
    if attribute is None:
        # Groups without any weight are left out of appearances.
        weights = appearance.groups.get(name, np.zeros(len(mesh.vertices), np.float32))
        return weights[appearance.faces][..., None]
    prop, size = _VALUES[attribute.data_type]
    kind = _TYPES.get(attribute.data_type, np.float32)
    values = element_values(attribute.data, prop, size, kind).reshape(-1, size).astype(np.float32)
    if attribute.domain == "CORNER":
        return values[loops]
    if attribute.domain == "POINT":
        return values[appearance.faces]
    if attribute.domain == "FACE":
        polygons = triangle_polygons(mesh)
        return np.repeat(values[polygons][:, None], 3, axis=1)
    return _at_vertices(mesh, values, attribute.data_type)[appearance.faces]


def _at_vertices(mesh: bpy.types.Mesh, values: np.ndarray, kind: str) -> np.ndarray:
    """Return values of edges as renders show them: means at the vertices, rounded for integers; for truth values, any.

    This was measured in Cycles of Blender 5.2.
    """
    ends = element_values(mesh.edges, "vertices", 2, np.int32)
    sums = np.zeros((len(mesh.vertices), values.shape[1]))
    np.add.at(sums, ends, values[:, None])
    if kind == "BOOLEAN":
        return (sums > 0.0).astype(np.float32)
    counts = np.bincount(ends.ravel(), minlength=len(sums))
    means = sums / np.maximum(counts, 1)[:, None]
    return (np.floor(means + 0.5) if kind in _TYPES else means).astype(np.float32)


def _repeats(materials: Sequence[bpy.types.Material | None]) -> bool:
    """Return whether materials have image textures, and all of these repeat."""
    images = [node for node in nodes_of(materials) if node.type == "TEX_IMAGE"]
    return bool(images) and all(
        node.extension == "REPEAT" and (node.image is None or node.image.source != "TILED") for node in images
    )


def _rounded(uvs: np.ndarray) -> np.ndarray:
    """Round UVs to a 32nd of a pixel at 2K; files compress better."""
    steps = np.float32(1 << 16)
    return np.rint(uvs * steps) / steps


def _write(mesh: bpy.types.Mesh, name: str, values: np.ndarray) -> None:
    write_attribute(mesh, name, _KINDS[values.shape[1]], values)
