# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the appearance of meshes as arrays, and write what frames carry of it as attributes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ....applications.morphs.appearance import Appearance, Carried, Paint, Painted, Plain, Textured
from ....applications.morphs.shading import FrameNormals, Shading
from ....geometry.meshes.mesh import TriangleMesh
from ....geometry.meshes.polygons import Polygons
from ...color_spaces import SRGB
from ...element_values import MeshTriangles, element_values, triangle_materials, vectors_of, write_attribute
from ...files.image_files import pixel_values
from ...rendered_maps import render_colors, render_uv_map
from ...scene_colors import kind_of_colors, scene_of_srgb
from ...vertex_groups import mesh_weights
from .frame_attributes import COLOR, CUSTOM_NORMAL, LOOK, SOURCE_MATERIAL, SOURCE_WEIGHT, VELOCITY
from .materials import base_color, is_carrying, is_object_color, shows_color_attribute
from .mixed_materials import emission_node

# Rounding steps of normals per unit.
_NORMAL_STEPS = np.float32(1024)
# Largest rounding step of velocities, relative to the maximum.
_ROUNDED = 1e-2
# Images are halved to at most this size, since the vertices of frames are much farther apart than pixels.
_MOST_PIXELS = 1024
# What renders show in empty slots beside others.
_UNASSIGNED = Plain((0.8, 0.8, 0.8, 1.0))


def read_appearance(mesh: bpy.types.Mesh, color: Sequence[float]) -> Appearance:
    """Read the base colors of a mesh.

    A material has the color of its Principled BSDF: the first image or color attribute linked to it, or its plain
    color. Without either, it has its viewport color. A mesh without materials has the render color attribute, or the
    color of its object; faces without a material beside others are light gray, as in renders.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        A frozen copy, in the space of origins.
    color : (r, g, b, a)
        Color of the object, scene linear.
    """
    return _appearance(mesh, MeshTriangles.of(mesh), color, ())


@dataclass(frozen=True)
class Looks:
    """How an input looks.

    Attributes
    ----------
    appearance : Appearance
        Base colors, see :func:`read_appearance`, and vertex groups.
    shading : Shading
        Flat and smooth faces, sharp edges and custom normals.
    """

    appearance: Appearance
    shading: Shading


def read_looks(mesh: bpy.types.Mesh, color: Sequence[float], group_names: Sequence[str] = ()) -> Looks:
    """Read how a mesh looks, given as for :func:`read_appearance`, and the names of its vertex groups in order."""
    triangles = MeshTriangles.of(mesh)
    appearance = _appearance(mesh, triangles, color, group_names)
    normals = element_values(mesh.corner_normals, "vector", 3).take(triangles.loops, axis=0)
    return Looks(appearance, Shading(appearance.corners, appearance.faces, normals))


def _appearance(
    mesh: bpy.types.Mesh, triangles: MeshTriangles, color: Sequence[float], group_names: Sequence[str]
) -> Appearance:
    faces, loops = triangles.vertices.astype(np.int64), triangles.loops
    slots = list(mesh.materials) or [None]
    return Appearance(
        # Three to four times as fast as indexing with an array.
        vectors_of(mesh.vertices).take(faces, axis=0),
        # A face may have an invalid slot index; Blender then uses the last slot.
        np.minimum(triangle_materials(mesh).astype(np.int64), len(slots) - 1),
        tuple(_paint(mesh, slot, color, faces, loops) for slot in slots),
        faces,
        _groups(mesh, group_names),
    )


def write_normals(mesh: bpy.types.Mesh, normals: FrameNormals, surface: TriangleMesh) -> None:
    """Set custom normals of a frame.

    They are rounded to a twentieth of a degree, which halves their compressed size.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The frame, with triangles or quads.
    normals : FrameNormals
        Normals of points, or of triangle corners.
    surface : TriangleMesh
        The surface of the frame as written.
    """
    vectors = normals.vectors
    if normals.of_corners and len(mesh.loops) != len(vectors):
        vectors = vectors[Polygons.of_quads(surface).sources]
    rounded = np.rint(vectors * _NORMAL_STEPS) / _NORMAL_STEPS
    write_attribute(mesh, CUSTOM_NORMAL, "FLOAT_VECTOR", rounded, "CORNER" if normals.of_corners else "POINT")


def write_carried(mesh: bpy.types.Mesh, carried: Carried) -> None:
    """Write the data carried by a frame to point attributes.

    `COLOR` is the mean of the inputs' colors, which are in `LOOK`, weighted by `SOURCE_WEIGHT`, the share of the input
    in the blend. `SOURCE_MATERIAL` is the material slot, for inputs with several. Vertex groups of all inputs become
    attributes of the same name.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        A frame with matching vertices.
    carried : Carried
        The data to write.
    """
    # With 8 bits if possible, since colors come from images, and files stay small; values are clamped to one.
    write_attribute(mesh, COLOR, kind_of_colors(), carried.color)
    write_source_weights(mesh, carried.weights)
    for index, seen in carried.inputs.items():
        write_attribute(mesh, LOOK.format(index + 1), kind_of_colors(), seen.colors)
        if seen.materials.any():
            write_attribute(mesh, SOURCE_MATERIAL.format(index + 1), "INT", seen.materials.astype(np.int32))
    for name, weights in carried.groups.items():
        if name not in mesh.attributes:
            write_attribute(mesh, name, "FLOAT", weights)
    mesh.color_attributes.active_color_name = COLOR
    mesh.color_attributes.render_color_index = mesh.color_attributes.find(COLOR)


def write_materials(
    mesh: bpy.types.Mesh, materials: Sequence[bpy.types.Material], faces: np.ndarray, surface: TriangleMesh
) -> None:
    """Assign the materials of a frame.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The frame, with triangles or quads; existing materials are removed.
    materials : sequence of bpy.types.Material
        Materials of the slots.
    faces : (m,) int
        Slot index of every triangle.
    surface : TriangleMesh
        The surface of the frame as written.
    """
    mesh.materials.clear()
    for material in materials:
        mesh.materials.append(material)
    if len(materials) == 1:
        return
    if len(mesh.polygons) != len(faces):
        polygons = Polygons.of_quads(surface)
        faces = faces[polygons.sources[polygons.starts] // 3]
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(faces, dtype=np.int32))


def write_velocity(mesh: bpy.types.Mesh, velocity: np.ndarray) -> None:
    """Write the velocity of the points of a frame, (n, 3), in local units per second.

    Cycles uses this attribute for motion blur, regardless of neighboring frames, and exporters write it as the velocity
    in Alembic and USD files. Eevee does not use it. Values are rounded to at most half a hundredth of the maximum,
    which is invisible and halves their compressed size.
    """
    largest = float(np.abs(velocity).max(initial=0.0))
    # A power of two, so that rounded numbers end in zeros.
    step = 2.0 ** np.floor(np.log2(largest * _ROUNDED)) if largest > 0 else 1.0
    write_attribute(mesh, VELOCITY, "FLOAT_VECTOR", np.round(velocity / step) * step)


def seen_colors(mesh: bpy.types.Mesh, color: Sequence[float]) -> np.ndarray:
    """Colors of the points of a mesh as rendered, (n, 4); `color` is that of its object."""
    carried = mesh.color_attributes.get(COLOR)
    if carried is not None and carried.domain == "POINT" and _shows_carried(mesh):
        return element_values(carried.data, "color", 4)
    return read_appearance(mesh, color).at(element_values(mesh.vertices, "co", 3)).colors


def _shows_carried(mesh: bpy.types.Mesh) -> bool:
    """Return whether the faces of a frame have its own materials, not others that its user has assigned."""
    slots = np.unique(element_values(mesh.polygons, "material_index", kind=np.int32))
    used = [mesh.materials[slot] for slot in slots if slot < len(mesh.materials)]
    return all(is_carrying(material) or shows_color_attribute(material) for material in used)


def write_own_appearance(mesh: bpy.types.Mesh, index: int, count: int) -> bool:
    """Let an input without material show its color attribute as frames do; return whether it has one.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        A frozen copy.
    index, count : int
        Index of the input, and number of inputs.
    """
    attribute = render_colors(mesh)
    if any(mesh.materials) or attribute is None:
        return False
    domain, colors = attribute.domain, element_values(attribute.data, "color", 4)
    write_attribute(mesh, COLOR, "FLOAT_COLOR", colors, domain)
    write_source_weights(mesh, np.eye(count)[index])
    return True


def write_source_weights(mesh: bpy.types.Mesh, weights: Sequence[float]) -> None:
    """Write the shares of all inputs in a frame, which are the same at all of its points."""
    for number, weight in enumerate(weights, start=1):
        write_attribute(mesh, SOURCE_WEIGHT.format(number), "FLOAT", np.full(len(mesh.vertices), weight, np.float32))


def _paint(
    mesh: bpy.types.Mesh,
    material: bpy.types.Material | None,
    color: Sequence[float],
    faces: np.ndarray,
    loops: np.ndarray,
) -> Paint:
    if material is None and any(mesh.materials):
        return _UNASSIGNED
    if material is None:
        attribute = render_colors(mesh)
        return Plain(tuple(color)) if attribute is None else _painted(attribute, faces, loops)
    if emission_node(material) is not None:
        return Plain((0.0, 0.0, 0.0, 1.0))
    base = base_color(material)
    if base is None:
        return Plain(tuple(material.diffuse_color))
    if not base.is_linked:
        return Plain(tuple(base.default_value))
    for link in upstream_links(base):
        node = link.from_node
        if is_object_color(link.from_socket):
            return Plain(tuple(color))
        if node.type == "VERTEX_COLOR" or (node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY"):
            name = node.layer_name if node.type == "VERTEX_COLOR" else node.attribute_name
            attribute = mesh.color_attributes.get(name) if name else render_colors(mesh)
            if attribute is not None:
                return _painted(attribute, faces, loops)
        if node.type == "TEX_IMAGE" and (paint := _textured(mesh, node, loops)) is not None:
            return paint
    return Plain(tuple(material.diffuse_color))


def upstream_nodes(socket: bpy.types.NodeSocket) -> list[bpy.types.Node]:
    """Return the nodes that an input depends on, nearest first."""
    return list(dict.fromkeys(link.from_node for link in upstream_links(socket)))


def upstream_links(socket: bpy.types.NodeSocket) -> list[bpy.types.NodeLink]:
    """Return the links that an input depends on, nearest first."""
    found, seen = list(socket.links), set()
    for link in found:
        if link.from_node not in seen:
            seen.add(link.from_node)
            found += [other for own in link.from_node.inputs for other in own.links]
    return found


def _painted(attribute: bpy.types.Attribute, faces: np.ndarray, loops: np.ndarray) -> Painted:
    colors = element_values(attribute.data, "color", 4)
    return Painted(colors[faces if attribute.domain == "POINT" else loops])


def _textured(mesh: bpy.types.Mesh, node: bpy.types.Node, loops: np.ndarray) -> Textured | None:
    """Return the paint of an image node, or None without an image or a UV map."""
    named = [other.uv_map for other in upstream_nodes(node.inputs["Vector"]) if other.type == "UVMAP"]
    layer = mesh.uv_layers.get(named[0]) if named else None
    layer = render_uv_map(mesh) if layer is None else layer
    pixels = _pixels(node.image)
    if layer is None or pixels is None:
        return None
    return Textured(pixels, element_values(layer.uv, "vector", 2)[loops], node.extension == "REPEAT")


def _pixels(image: bpy.types.Image | None) -> np.ndarray | None:
    """Return an image as (h, w, 4) float32 in scene linear colors, downsampled to at most `_MOST_PIXELS`.

    Only the first tile of a tiled image is used.
    """
    if image is None or not all(image.size):
        return None
    # An unreadable file has a size but no pixels.
    if len(image.pixels) != image.size[0] * image.size[1] * 4:
        return None
    pixels = pixel_values(image)
    if not image.is_float and image.colorspace_settings.name in SRGB:
        pixels[..., :3] = scene_of_srgb(pixels[..., :3])
    while max(pixels.shape[:2]) > _MOST_PIXELS:
        pixels = _halved(pixels)
    return pixels


def _halved(pixels: np.ndarray) -> np.ndarray:
    """Average blocks of 2 x 2 pixels; an odd last row or column is repeated."""
    for axis in (0, 1):
        if pixels.shape[axis] > 1:
            even, odd = (pixels[slice(first, None, 2)] if axis == 0 else pixels[:, first::2] for first in (0, 1))
            if odd.shape[axis] < even.shape[axis]:
                odd = np.concatenate([odd, even[-1:] if axis == 0 else even[:, -1:]], axis=axis)
            pixels = 0.5 * (even + odd)
    return pixels


def _groups(mesh: bpy.types.Mesh, names: Sequence[str]) -> dict[str, np.ndarray]:
    if not names:
        return {}
    groups = mesh_weights(mesh, names, range(len(names)))
    return {name: own for name, own in zip(names, groups, strict=True) if own.any()}
