# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Clothes, hair and eyes that follow a body with shape keys to other shapes."""

from __future__ import annotations

import json
from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.algebra.affine import transformed_points
from ...geometry.deformation.attachment import Attachment, rigidly_moved
from ...geometry.meshes.edges import vertex_components
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..element_values import triangle_corners, vectors_of, write_floats
from ..handles import Handle, found, found_or_none
from ..mesh_checks import other_vertices, writable_mesh
from ..objects import checked_matrix, checked_vertices
from .records import has_key_record, key_records, recorded_keys
from .shape_keys import drive_key, is_key_expression, key_expressions, require_mixable_keys

ATTACHED_KEY = "convwass_attached_keys"
"""Custom property of the shape keys of a part: JSON of the names of those with which it follows bodies.

Parts that earlier versions attached lack it.
"""


@dataclass(frozen=True)
class _Part:
    """What is read of a part.

    Attributes
    ----------
    handle : Handle
        The object.
    name : str
        Its name.
    points : (n, 3) float64
        The vertices of its base mesh, world space.
    labels : (n,) int64 or None
        Their connected component if these move as a whole.
    inverse : Matrix
        From world to local space.
    """

    handle: Handle
    name: str
    points: NDArray[np.float64]
    labels: NDArray[np.int64] | None
    inverse: Matrix

    def local(self, moved: NDArray[np.float64]) -> NDArray[np.float32]:
        """Return points of the world in local space."""
        return np.ascontiguousarray(transformed_points(moved, self.inverse), dtype=np.float32)


class AttachJob:
    """Gives objects shape keys that follow those of a body, driven by the body's sliders.

    Keys are made for the base mesh, before modifiers, as on the body. Other keys of the objects are kept; keys that
    already follow this body are replaced. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    body : bpy.types.Object
        Has shape keys to other shapes.
    parts : iterable of bpy.types.Object
        Meshes in their correct place when all sliders are at 0.
    rigid : bool
        Whether every connected component of a part is only moved, rotated and scaled.

    Raises
    ------
    InputError
        The body has no such keys; or an object is not a mesh, has coordinates that are not finite or a scale of zero,
        is linked from another file, or would show no further keys.

    Attributes
    ----------
    body_name : str
        Name of the body at the start.
    """

    def __init__(self, body: bpy.types.Object, parts: Iterable[bpy.types.Object], *, rigid: bool) -> None:
        self._records, parts = key_records(body), list(parts)
        if not self._records:
            raise InputError(
                "{name} keeps its form, so there are no keys to follow; parent parts to it.", name=body.name
            )
        for part in parts:
            _require_attachable(part)
            checked_matrix(part)
            checked_vertices(part.name, part.data)
        blocks = body.data.shape_keys.key_blocks
        names = [name for record in self._records for name in recorded_keys(record)]
        missing = [name for name in names if name not in blocks]
        if missing:
            raise InputError(
                "The shape key {key} of {name} is missing; make the keys again.", key=missing[0], name=body.name
            )
        self._body, self.body_name = Handle.of("objects", body), body.name
        self._surface = TriangleMesh(_placed(blocks[0].data, body), _triangles(body.data))
        self._keys = {name: _placed(blocks[name].data, body) for name in names}
        self._parts = [_read_part(part, rigid=rigid) for part in parts]
        self._moved: list[dict[str, NDArray[np.float32]]] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the keys."""
        done, count = 0, len(self._parts) * (1 + len(self._keys))
        for part in self._parts:
            message = Sentence("Attaching {name}", {"name": part.name})
            yield Progress(done / count, message)
            attached = Attachment.of(part.points, self._surface, control)
            self._moved.append({})
            for name, vertices in self._keys.items():
                done += 1
                yield Progress(done / count, message)
                moved = attached.followed(vertices)
                if part.labels is not None:
                    moved = rigidly_moved(part.points, moved, part.labels)
                self._moved[-1][name] = part.local(moved)
            done += 1

    def write(self, report: Progress[None]) -> None:
        """Write nothing; the keys are written at the end."""

    def discard(self) -> None:
        """Discard the keys."""
        self._moved.clear()

    @property
    def is_edited(self) -> bool:
        """Whether a part is in Edit Mode."""
        return any(part.type == "MESH" and part.data.is_editmode for part in found(self._handles))

    @property
    def part_names(self) -> list[str]:
        """Names of the parts at the start."""
        return [part.name for part in self._parts]

    @property
    def _handles(self) -> list[Handle]:
        return [part.handle for part in self._parts]

    def finish(self) -> list[Sentence]:
        """Write the keys, and return messages for the user.

        Raises
        ------
        InputError
            The body or a part was deleted, or has changed too much. Nothing is changed then.
        """
        body, parts = self._found()
        notices = []
        for part, moved in zip(parts, self._moved, strict=True):
            notices += _own_mesh(part)
            _follow(part, body, self._records, moved)
        return notices

    def _found(self) -> tuple[bpy.types.Object, list[bpy.types.Object]]:
        """Return the body and the parts, if they still can be attached."""
        body, *parts = found_or_none([self._body, *self._handles])
        for obj, name in zip([body, *parts], [self.body_name, *self.part_names], strict=True):
            if obj is None:
                raise InputError(
                    "{name} was deleted, or its creation undone, while parts were attached; start again.", name=name
                )
        if key_records(body) != self._records:
            raise InputError("The keys of {name} have changed since the start; start again.", name=body.name)
        for part, read in zip(parts, self._parts, strict=True):
            _require_attachable(part)
            if len(part.data.vertices) != len(read.points):
                raise other_vertices(part)
        return body, parts


def _require_attachable(part: bpy.types.Object) -> None:
    """Raise InputError if no shape keys can be added to an object, or would not be shown."""
    if part.type != "MESH" or not len(part.data.vertices):
        raise InputError("{name} is not a mesh with vertices; convert it first.", name=part.name)
    writable_mesh(part)
    require_mixable_keys(part)


def _placed(points: bpy.types.bpy_prop_collection, obj: bpy.types.Object) -> NDArray[np.float64]:
    """Return the points of a key or a mesh in world space, (n, 3)."""
    return transformed_points(vectors_of(points), obj.matrix_world)


def _read_part(part: bpy.types.Object, *, rigid: bool) -> _Part:
    keys = part.data.shape_keys
    points = _placed(part.data.vertices if keys is None else keys.key_blocks[0].data, part)
    labels = _components(part.data, points) if rigid else None
    return _Part(Handle.of("objects", part), part.name, points, labels, part.matrix_world.inverted_safe())


def detach_parts(bodies: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Remove the shape keys with which parts follow bodies; other keys are kept, unless only the first one is left.

    Parameters
    ----------
    bodies : sequence of bpy.types.Object
        Objects with shape keys to other shapes.

    Returns
    -------
    list of bpy.types.Object
        The parts that followed them; those that are linked from another file are left as they are.
    """
    parts = [part for part in attached_parts(bodies) if part.is_editable and part.data.is_editable]
    return [part for part in parts if _detach(part, bodies)]


def attached_parts(bodies: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the objects that have shape keys with which they follow bodies, which are none of these."""
    meshes = {body.data for body in bodies}
    others = [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.data not in meshes]
    return [
        obj
        for obj in others
        if obj.data.shape_keys is not None
        and any(_is_following(key, body) for key in obj.data.shape_keys.key_blocks for body in bodies)
    ]


def _detach(part: bpy.types.Object, bodies: Sequence[bpy.types.Object]) -> bool:
    """Remove the keys with which a part follows bodies; return whether there were any.

    There are none if another part has the same mesh, and was detached before.
    """
    keys = part.data.shape_keys
    if keys is None:
        return False
    count = len(keys.key_blocks)
    for body in bodies:
        _remove_other_keys(part, body, ())
    left = len(keys.key_blocks)
    if left == 1:
        part.shape_key_remove(keys.key_blocks[0])
    part.data.update()
    return left < count


def _follow(
    part: bpy.types.Object,
    body: bpy.types.Object,
    records: list[dict[str, object]],
    moved: dict[str, NDArray[np.float32]],
) -> None:
    """Add the keys of one part, given their points by their names."""
    if part.data.shape_keys is None:
        part.shape_key_add(name="Basis", from_mix=False)
    _remove_other_keys(part, body, moved)
    attached_names = _attached_names(part)
    for record in records:
        for name, expression in zip(recorded_keys(record), key_expressions(record["times"]), strict=True):
            key = _key(part, body, name)
            write_floats(key.data, "co", moved[name])
            drive_key(body, key, record["name"], expression)
            attached_names.append(key.name)
    part.data.shape_keys[ATTACHED_KEY] = json.dumps(list(dict.fromkeys(attached_names)))
    part.data.update()


def _own_mesh(part: bpy.types.Object) -> list[Sentence]:
    """Give an object its own mesh, and return messages about it."""
    notices = []
    if part.data.users > 1:
        part.data = part.data.copy()
        notices.append(
            Sentence("{name} shared its mesh with other objects and got one of its own", {"name": part.name})
        )
    if any(modifier.type == "MULTIRES" for modifier in part.modifiers):
        notices.append(Sentence("{name} is multiresolution; the keys move its base mesh", {"name": part.name}))
    return notices


def _remove_other_keys(part: bpy.types.Object, body: bpy.types.Object, names: Container[str]) -> None:
    """Remove keys that follow a body, unless they have one of these names: their body has other keys now."""
    for key in [key for key in part.data.shape_keys.key_blocks if key.name not in names]:
        if _is_following(key, body):
            key.driver_remove("value")
            part.shape_key_remove(key)


def _key(part: bpy.types.Object, body: bpy.types.Object, name: str) -> bpy.types.ShapeKey:
    """Return the existing key of that name that follows the body, without its driver, or a new key."""
    key = part.data.shape_keys.key_blocks.get(name)
    if key is not None and _is_following(key, body):
        key.driver_remove("value")
        return key
    return part.shape_key_add(name=name, from_mix=False)


def _is_following(key: bpy.types.ShapeKey, body: bpy.types.Object) -> bool:
    """Return whether a key was made to follow a body; users may have driven others by its sliders.

    Such a driver may be a copy of the body's own, so the names of the keys decide: those stored with the part or, if
    an earlier version has attached it, those of the body.
    """
    if body not in _driving(key):
        return False
    stored = _stored_names(key.id_data)
    return key.name in (body.data.shape_keys.key_blocks if stored is None else stored)


def _driving(key: bpy.types.ShapeKey) -> list[bpy.types.ID | None]:
    """Return the objects whose sliders drive a key by an expression as this add-on makes them."""
    data = key.id_data.animation_data
    curve = None if data is None else data.drivers.find(f"{key.path_from_id()}.value")
    if curve is None or not is_key_expression(curve.driver.expression):
        return []
    return [target.id for own in curve.driver.variables for target in own.targets]


def _attached_names(part: bpy.types.Object) -> list[str]:
    """Return the names of the keys with which a part follows any bodies."""
    return [
        key.name
        for key in part.data.shape_keys.key_blocks
        if any(has_key_record(body) and _is_following(key, body) for body in _driving(key))
    ]


def _stored_names(keys: bpy.types.Key) -> list[str] | None:
    """Return the names stored with the shape keys of a part; None if there are none, or they are damaged."""
    try:
        names = json.loads(keys[ATTACHED_KEY])
    except (KeyError, TypeError, ValueError, RecursionError):
        return None
    return names if isinstance(names, list) else None


def _components(mesh: bpy.types.Mesh, points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Label the vertices by connected component; all vertices without faces form another one."""
    labels = vertex_components(TriangleMesh(points, _triangles(mesh)))
    return np.where(labels < 0, labels.max() + 1, labels)


def _triangles(mesh: bpy.types.Mesh) -> NDArray[np.int64]:
    return triangle_corners(mesh, "vertices").astype(np.int64)
