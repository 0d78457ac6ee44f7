# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Join all parts of a shape, of any type and with instances, to one mesh object."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import partial

import bpy
import numpy as np
from mathutils import Matrix

from ..errors import InputError
from ..geometry.algebra.affine import transformed_points
from .element_values import vectors_of, write_attribute
from .mesh_checks import not_a_mesh
from .nodes.node_math import feed, joined, matrix_node, named_attribute, new_node, stored_attribute, without_attribute
from .nodes_output import NodesOutput, has_nodes, nodes_output
from .object_copies import copied, copies_of, has_copies, is_copied_by_parent
from .object_materials import with_own_materials
from .objects import (
    MESHED,
    checked_matrix,
    checked_vertices,
    evaluated_mesh,
    frozen_copy,
    transform_mesh,
    use_existing_slots,
)
from .rendered_maps import render_with, share_colors, share_uv_map
from .sequence import MODIFIER, frame_group, mirrors, object_info, transformed
from .shape_sources import ShapeSource, instanced_parts, shows_collection
from .unused_data import removed_on_errors
from .visibility import current_objects, evaluated_object

Builder = Callable[[bpy.types.NodeTree], bpy.types.NodeSocket | None]
"""Adds the nodes of a part to a tree, and returns its mesh in world space; None if it is empty."""

VOLUME_THRESHOLD = 0.1
"""Density of volumes at their surface, as in Blender's Volume to Mesh."""

_HERE = Matrix()
_MESHED = ("MESH", "FONT", "CURVE", "SURFACE", "META")
_WITH_RADIUS = ("CURVES", "POINTCLOUD")
# Nesting depth up to which mirrored instances are handled.
_DEPTH = 6
_MIRRORED = "convwass_mirrored"
OWN_POSITION = "convwass_own_position"
"""Attribute of the vertices of joined meshes: the position in the own space of their part."""
_TUBE_CORNERS, _BALL_SUBDIVISIONS = 8, 2


@contextmanager
def joined_shape(source: ShapeSource, depsgraph: bpy.types.Depsgraph) -> Iterator[bpy.types.Object]:
    """Provide an object with the surface of a whole shape: its only part, or a joined mesh that is removed afterwards.

    Modifiers are applied, in world space; materials, UV maps, vertex groups and attributes are kept, and instances
    realized, also those of particles. Strands and points become tubes and balls of their radius, volumes their surface
    at a density of `VOLUME_THRESHOLD`.

    Parameters
    ----------
    source : ShapeSource
        Its parts may be hidden, or come from a linked library.
    depsgraph : bpy.types.Depsgraph
        ``context.evaluated_depsgraph_get()``; updated here.

    Raises
    ------
    InputError
        No part has a surface, or strands or points have no radius.
    """
    if len(source.parts) == 1 and not needs_joining(source.parts[0], depsgraph):
        yield source.parts[0]
        return
    temporary: list[bpy.types.ID] = []
    try:
        mesh = _joined(source, depsgraph, temporary)
    finally:
        bpy.data.batch_remove(temporary)
    obj = bpy.data.objects.new(source.name, mesh)
    obj.color = source.parts[0].color
    # Linked, so that it is evaluated only once.
    depsgraph.scene.collection.objects.link(obj)
    try:
        yield obj
    finally:
        bpy.data.batch_remove([obj, mesh])


def current_shapes(sources: Sequence[ShapeSource], depsgraph: bpy.types.Depsgraph) -> AbstractContextManager[None]:
    """Keep shapes evaluated in their current state during a block of code that reads them with `joined_shape`.

    Blender rebuilds its graph to show hidden parts, here once for all.
    """
    return current_objects(_independent_parts(sources), depsgraph)


def shown_live(tree: bpy.types.NodeTree, parts: Sequence[bpy.types.Object]) -> bpy.types.NodeSocket | None:
    """Return the geometry of a shape in every frame, in world space, wherever the object is whose nodes show it.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new nodes.
    parts : sequence of bpy.types.Object
        What the shape is made of.

    Returns
    -------
    bpy.types.NodeSocket or None
        None if a part has no mesh that nodes could show.
    """
    if any((part.type not in ("MESH", "META") and not shows_collection(part)) or has_copies(part) for part in parts):
        return None
    return joined(tree, [_realized(tree, instance) for part in parts for instance in _as_instances(tree, part)])


def needs_joining(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether an object must be converted to a joined mesh."""
    if obj.type in ("SURFACE", "META", "VOLUME", *_WITH_RADIUS) or shows_collection(obj):
        return True
    # For mirrored meshes, all data must come from one copy with flipped faces.
    if obj.type == "MESH" and (obj.matrix_world.determinant() < 0 or has_copies(obj)):
        return True
    return obj.type in MESHED and _is_made_of_others(obj, depsgraph)


def has_instances(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether Geometry Nodes of an object make instances."""
    return has_nodes(obj) and nodes_output(obj, depsgraph).instances


def _is_made_of_others(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether Geometry Nodes make something other than a mesh of an object."""
    if not has_nodes(obj):
        return False
    made = nodes_output(obj, depsgraph)
    # A mesh without faces is refused as such.
    return not made.is_mesh and (obj.type != "MESH" or made != NodesOutput())


def _independent_parts(sources: Sequence[ShapeSource]) -> list[bpy.types.Object]:
    """Return the parts of shapes that change no other shape while they are shown.

    Metaballs merge with others, and hidden objects are not copied at particles, vertices of their parent, or Empties.
    """
    groups = {own.instance_collection for own in (*bpy.data.particles, *bpy.data.objects)} - {None}
    copied = {obj for group in groups for obj in group.all_objects}
    parts = [part for source in sources for part in source.parts]
    return [part for part in parts if part.type != "META" and part not in copied and not is_copied_by_parent(part)]


def _joined(source: ShapeSource, depsgraph: bpy.types.Depsgraph, temporary: list[bpy.types.ID]) -> bpy.types.Mesh:
    """Return a new mesh of all parts, and add temporary data to a list."""
    # All parts are read before anything is built, for Blender would rebuild its graph after each.
    pieces = [_piece(part, depsgraph, temporary) for part in source.parts]
    read = [block for block in temporary if isinstance(block, bpy.types.Mesh)]
    uv_map, colors = share_uv_map(read), share_colors(read)
    tree = frame_group(source.name)
    temporary.append(tree)
    new_node(tree, "NodeGroupOutput", {"Geometry": _all_of(tree, pieces)})
    probe = _linked(_kept_for_now(bpy.data.meshes.new(source.name), temporary), depsgraph, temporary)
    probe.modifiers.new(MODIFIER, "NODES").node_group = tree
    depsgraph.update()
    mesh = evaluated_mesh(probe.evaluated_get(depsgraph), depsgraph)
    with removed_on_errors([mesh]):
        if not len(mesh.polygons):
            raise InputError("{name} has no faces; choose parts with a surface.", name=source.name)
        # Parts of instances are not checked one by one.
        checked_vertices(source.name, mesh)
    # The mesh of a part that only shows copies is left out.
    render_with(mesh, uv_map, colors)
    mesh.name = source.name
    return mesh


def _piece(
    part: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    temporary: list[bpy.types.ID],
    place: Matrix = _HERE,
) -> Builder:
    """Read a part, and return what builds its mesh, moved by a matrix in world space."""
    if shows_collection(part):
        return _instanced_piece(part, depsgraph, temporary, place)
    if part.type in _WITH_RADIUS or (part.type in MESHED and _is_made_of_others(part, depsgraph)):
        return _moved(partial(_solids, part=part, made=_checked_output(part, depsgraph)), place)
    if part.type == "VOLUME":
        return _moved(partial(_surface_of_volume, part=part), place)
    if part.type not in _MESHED:
        raise not_a_mesh(part)
    if has_copies(part):
        own = _own_piece(part, depsgraph, temporary)
        return _moved(_with_copies(part, own, depsgraph, temporary), place)
    return _own_piece(part, depsgraph, temporary, place)


def _instanced_piece(
    empty: bpy.types.Object, depsgraph: bpy.types.Depsgraph, temporary: list[bpy.types.ID], place: Matrix
) -> Builder:
    """Read the objects of the collection that an Empty shows, and return what builds their mesh.

    Realizing an instance would lose the materials of objects, keep what is disabled, and distort custom normals.
    """
    with evaluated_object(empty, depsgraph) as evaluated:
        checked_matrix(evaluated)
        offset = Matrix.Translation(empty.instance_collection.instance_offset).inverted()
        inside = place @ evaluated.matrix_world @ offset
    parts = instanced_parts(empty)
    with current_objects(parts, depsgraph):
        # Unlike in scenes, objects that their parent copies are not shown themselves.
        shown = [part for part in parts if not is_copied_by_parent(part)]
        pieces = [_piece(part, depsgraph, temporary, inside) for part in shown]
    return partial(_all_of, pieces=pieces)


def _all_of(tree: bpy.types.NodeTree, pieces: Sequence[Builder]) -> bpy.types.NodeSocket:
    """Return the mesh of several parts."""
    built = [piece(tree) for piece in pieces]
    return joined(tree, [mesh for mesh in built if mesh is not None])


def _moved(piece: Builder, place: Matrix) -> Builder:
    """Return what builds a mesh that is moved by a matrix in world space."""
    if place == _HERE:
        return piece
    return lambda tree: transformed(tree, piece(tree), matrix_node(tree, place))


def _own_piece(
    part: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    temporary: list[bpy.types.ID],
    place: Matrix = _HERE,
) -> Builder:
    """Return what builds the mesh of a part alone, moved by a matrix in world space."""
    mesh = _own_mesh(part, depsgraph, temporary)
    if mesh is None:
        return lambda _tree: None
    transform_mesh(mesh, place)
    return lambda tree: _geometry_of(tree, _linked(mesh, depsgraph, temporary))


def _with_copies(
    part: bpy.types.Object, own: Builder, depsgraph: bpy.types.Depsgraph, temporary: list[bpy.types.ID]
) -> Builder:
    """Return what builds the mesh of a part joined with its copies; see :func:`.object_copies.copies_of`."""
    read = [
        (_own_piece(copies.original, depsgraph, temporary), _kept_for_now(copies.as_points(), temporary))
        for copies in copies_of(part, depsgraph)
    ]

    def built(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        found = []
        for piece, points in reversed(read):
            source = piece(tree)
            if source is not None:
                places = _geometry_of(tree, _linked(points, depsgraph, temporary))
                found.append(_realized(tree, copied(tree, places, source)))
        alone = own(tree) if part.show_instancer_for_render else None
        return joined(tree, found if alone is None else [alone, *found])

    return built


def _own_mesh(
    part: bpy.types.Object, depsgraph: bpy.types.Depsgraph, temporary: list[bpy.types.ID]
) -> bpy.types.Mesh | None:
    """Return a new mesh of a part; None if it has no faces, such as metaballs joined to others, and paths."""
    with evaluated_object(part, depsgraph) as evaluated:
        is_empty = not len(evaluated.to_mesh().polygons)
        evaluated.to_mesh_clear()
    if is_empty:
        return None
    mesh = _kept_for_now(frozen_copy(part, depsgraph, _MESHED), temporary)
    use_existing_slots(mesh)
    own = transformed_points(vectors_of(mesh.vertices), np.array(part.matrix_world.inverted_safe()))
    write_attribute(mesh, OWN_POSITION, "FLOAT_VECTOR", own)
    return mesh


def _kept_for_now(mesh: bpy.types.Mesh, temporary: list[bpy.types.ID]) -> bpy.types.Mesh:
    """Add a new mesh to the temporary data."""
    temporary.append(mesh)
    return mesh


def _linked(mesh: bpy.types.Mesh, depsgraph: bpy.types.Depsgraph, temporary: list[bpy.types.ID]) -> bpy.types.Object:
    """Link a mesh to the scene until the temporary data is removed."""
    obj = bpy.data.objects.new(mesh.name, mesh)
    temporary.append(obj)
    depsgraph.scene.collection.objects.link(obj)
    return obj


def _geometry_of(tree: bpy.types.NodeTree, obj: bpy.types.Object) -> bpy.types.NodeSocket:
    return object_info(tree, obj, space="RELATIVE").outputs["Geometry"]


def _as_instances(
    tree: bpy.types.NodeTree, part: bpy.types.Object, outside: bpy.types.NodeSocket | None = None
) -> list[bpy.types.NodeSocket]:
    """Return instances of a part, or of all that an Empty shows, in world space.

    Objects of instanced collections are moved from the world by the matrix `outside`.
    """
    place = object_info(tree, part).outputs["Transform"]
    if outside is not None:
        place = _product(tree, outside, place)
    if not shows_collection(part):
        return [_as_instance(tree, part, place)]
    offset = Matrix.Translation(part.instance_collection.instance_offset).inverted()
    inside = _product(tree, place, matrix_node(tree, offset))
    return [one for own in instanced_parts(part) for one in _as_instances(tree, own, inside)]


def _as_instance(tree: bpy.types.NodeTree, part: bpy.types.Object, place: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return an instance of a part at a place."""
    shown = with_own_materials(tree, object_info(tree, part).outputs["Geometry"], part)
    position = tree.nodes.new("GeometryNodeInputPosition").outputs["Position"]
    positioned = stored_attribute(tree, shown, OWN_POSITION, position, "FLOAT_VECTOR")
    instance = new_node(tree, "GeometryNodeGeometryToInstance", {"Geometry": positioned}).outputs["Instances"]
    inputs = {"Instances": instance, "Transform": place}
    return new_node(tree, "GeometryNodeSetInstanceTransform", inputs).outputs["Instances"]


def _product(
    tree: bpy.types.NodeTree, first: bpy.types.NodeSocket, second: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Return the product of two matrices."""
    node = tree.nodes.new("FunctionNodeMatrixMultiply")
    feed(tree, node.inputs, [first, second])
    return node.outputs["Matrix"]


def _realized(tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return a mesh with its instances realized; faces of mirrored ones are flipped outwards.

    Realizing instances does not flip faces. They are therefore realized level by level, and every level stores whether
    its accumulated transform mirrors it.
    """
    for _ in range(_DEPTH):
        transform = tree.nodes.new("GeometryNodeInstanceTransform").outputs["Transform"]
        marked = stored_attribute(tree, geometry, _MIRRORED, mirrors(tree, transform), "BOOLEAN", "INSTANCE")
        inputs = {"Realize All": False, "Depth": 1, "Geometry": marked}
        geometry = new_node(tree, "GeometryNodeRealizeInstances", inputs).outputs["Geometry"]
    rest = new_node(tree, "GeometryNodeRealizeInstances", {"Geometry": geometry}).outputs["Geometry"]
    inputs = {"Mesh": rest, "Selection": named_attribute(tree, _MIRRORED, "BOOLEAN")}
    return without_attribute(tree, new_node(tree, "GeometryNodeFlipFaces", inputs).outputs["Mesh"], _MIRRORED)


def _surface_of_volume(tree: bpy.types.NodeTree, part: bpy.types.Object) -> bpy.types.NodeSocket:
    inputs = {"Threshold": VOLUME_THRESHOLD, "Volume": _geometry_of(tree, part)}
    return new_node(tree, "GeometryNodeVolumeToMesh", inputs).outputs["Mesh"]


def _checked_output(part: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> NodesOutput:
    """Return what a part consists of; raises InputError if that is only strands or points without a radius."""
    made = nodes_output(part, depsgraph)
    if made == NodesOutput(lacks_radius=True):
        raise InputError(
            "{name} has strands or points without a radius, so there is nothing solid: give them one with Geometry "
            "Nodes (Set Curve Radius, Set Point Radius).",
            name=part.name,
        )
    return made


def _solids(tree: bpy.types.NodeTree, part: bpy.types.Object, made: NodesOutput) -> bpy.types.NodeSocket:
    """Return all surfaces of a part that is not only a mesh."""
    (instance,) = _as_instances(tree, part)
    realized = _realized(tree, instance)
    kinds = new_node(tree, "GeometryNodeSeparateComponents", {"Geometry": realized}).outputs
    found = [kinds["Mesh"]]
    if made.strands:
        found.append(_solid_of(tree, "CURVES", kinds["Curve"]))
    if made.points:
        found.append(_solid_of(tree, "POINTCLOUD", kinds["Point Cloud"]))
    if made.volume:
        found.append(_surface_of_volume(tree, part))
    return joined(tree, found)


def _solid_of(tree: bpy.types.NodeTree, kind: str, geometry: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return tubes along strands, or balls at points, with their radius."""
    radius = tree.nodes.new("GeometryNodeInputRadius").outputs["Radius"]
    if kind == "CURVES":
        circle = {"Resolution": _TUBE_CORNERS, "Radius": 1.0}
        profile = new_node(tree, "GeometryNodeCurvePrimitiveCircle", circle).outputs["Curve"]
        inputs = {"Fill Caps": True, "Curve": geometry, "Profile Curve": profile}
        tube = new_node(tree, "GeometryNodeCurveToMesh", inputs)
        if "Scale" in tube.inputs:  # earlier versions of Blender apply the radius automatically
            tree.links.new(radius, tube.inputs["Scale"])
        return tube.outputs["Mesh"]
    sphere = {"Radius": 1.0, "Subdivisions": _BALL_SUBDIVISIONS}
    ball = new_node(tree, "GeometryNodeMeshIcoSphere", sphere).outputs["Mesh"]
    inputs = {"Points": geometry, "Instance": ball, "Scale": radius}
    balls = new_node(tree, "GeometryNodeInstanceOnPoints", inputs).outputs["Instances"]
    return new_node(tree, "GeometryNodeRealizeInstances", {"Geometry": balls}).outputs["Geometry"]
