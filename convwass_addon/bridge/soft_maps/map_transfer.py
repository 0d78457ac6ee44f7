# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is carried from one object to another along a map: read at first, computed beside, written at the end.

Nothing is written before all of it has been computed, and all that could be refused has been.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.soft_maps.surface_maps import PointMap
from ...applications.soft_maps.transfer import transferred_corner_values, transferred_values, transferred_weights
from ...applications.soft_maps.transfer_shapes import ShapeCarrier
from ...applications.soft_maps.transfer_uvs import TransferredUvs, transferred_uvs
from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ...sentence import Sentence
from ..color_attributes import color_kind, color_names, is_per_corner, read_colors, require_color_name, write_colors
from ..uv_maps import mark_seams, read_uvs, require_uv_names, uv_names, write_uvs
from ..vertex_groups import group_names, read_groups
from .map_corners import triangle_loops, triangle_polygons
from .map_shape_keys import KeyOffsets, key_names, locked_keys, read_keys, write_keys
from .map_weights import (
    WeightRules,
    bone_names,
    deforming_groups,
    fitted_weights,
    locked_groups,
    require_group_names,
    staying_weights,
    write_weights,
)


@dataclass(frozen=True)
class TransferEnds:
    """From where to where something is carried, and what of it.

    Attributes
    ----------
    giver, receiver : bpy.types.Object
        Mesh objects; of a map of a mesh to its mirror image one and the same.
    points : PointMap
        A point of the giver for every vertex of the receiver.
    giver_mesh, receiver_mesh : TriangleMesh
        Both without modifiers and shape keys, world space, with the triangles that the map counts.
    names : tuple of str
        What is carried, of each kind; empty for all.
    keep : bool
        Whether what the receiver has already stays; locked groups and keys always do.
    flip : bool
        Whether names with a side, such as Arm.L, get the other one. Of a mesh to itself they always do.
    is_backward : bool
        Of a mesh to itself: from right to left.
    """

    giver: bpy.types.Object
    receiver: bpy.types.Object
    points: PointMap
    giver_mesh: TriangleMesh
    receiver_mesh: TriangleMesh
    names: tuple[str, ...] = ()
    keep: bool = False
    flip: bool = False
    is_backward: bool = False

    @property
    def is_mirror(self) -> bool:
        """Whether something is carried to the mirror image on the same mesh."""
        return self.giver == self.receiver

    def destinations(self, known: Sequence[str]) -> dict[str, str]:
        """Return, for the names of the giver that are carried, those under which they are written."""
        chosen = [name for name in known if not self.names or name in self.names]
        flipped = {name: bpy.utils.flip_name(name) for name in chosen}
        if self.is_mirror:
            # Left comes before right in every way of writing it.
            return {
                name: other
                for name, other in flipped.items()
                if (self.names and other != name) or (name > other if self.is_backward else name < other)
            }
        return flipped if self.flip else {name: name for name in chosen}


@dataclass(frozen=True)
class Carried:
    """What has been written, and what has stayed as it was.

    Attributes
    ----------
    written, kept : tuple of str
        Names at the receiver.
    notices : tuple of Sentence
        What the user should know.
    """

    written: tuple[str, ...]
    kept: tuple[str, ...] = ()
    notices: tuple[Sentence, ...] = ()


class CarriedGroups:
    """Vertex groups on their way.

    Parameters
    ----------
    ends : TransferEnds
        From where to where.
    rules : WeightRules
        For weights of bones.

    Raises
    ------
    InputError
        The giver has no such groups, or the receiver cannot be written to.
    """

    def __init__(self, ends: TransferEnds, rules: WeightRules) -> None:
        self._ends, self._rules = ends, rules
        known = group_names(ends.giver)
        names = ends.destinations(known)
        _require_any(
            names,
            InputError(
                "{object} has no vertex groups to transfer; paint some, or choose others.", object=ends.giver.name
            ),
        )
        require_group_names(ends.receiver, list(names.values()))
        self._kept = _kept(ends, names, locked_groups, group_names)
        self._names = {name: own for name, own in names.items() if own not in self._kept}
        weights = read_groups(ends.giver, known)
        deforming = deforming_groups(ends.giver, ends.receiver, known, weights)
        self._weights = dict(zip(known, weights, strict=True))
        self._deforming = [name for name in self._names if name in deforming]
        self._total = [name for name in known if name in deforming]
        # Locked groups leave the others less room, whether the giver has them or not.
        own = bone_names(ends.receiver) | {names.get(name, name) for name in deforming}
        stays = own & {*self._kept, *locked_groups(ends.receiver, group_names(ends.receiver))}
        self._fixed = staying_weights(ends.receiver, sorted(stays))
        self._result: dict[str, NDArray[np.float64]] = {}

    def steps(self) -> Iterator[Sentence]:
        """Compute, and say what comes next."""
        yield Sentence("Transferring vertex groups")
        deforming = self._values(self._deforming)
        total = self._values(self._total).sum(axis=0)
        fitted = fitted_weights(deforming, total, self._fixed, self._rules)
        plain = [name for name in self._names if name not in self._deforming]
        self._result = dict(zip(self._deforming, fitted, strict=True)) | dict(
            zip(plain, self._values(plain), strict=True)
        )

    def _values(self, names: Sequence[str]) -> NDArray[np.float64]:
        ends = self._ends
        given = np.array([self._weights[name] for name in names]).reshape(len(names), len(ends.giver_mesh.vertices))
        return transferred_weights(ends.points, ends.giver_mesh, given, None, False)

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the groups."""
        names = list(self._names)
        if names:
            rows = np.stack([self._result[name] for name in names])
            write_weights(receiver, list(self._names.values()), rows, self._ends.points.found)
        return Carried(tuple(self._names.values()), self._kept)


class CarriedKeys:
    """Shape keys on their way.

    Parameters
    ----------
    ends : TransferEnds
        From where to where.

    Raises
    ------
    InputError
        The giver has no such keys.
    """

    def __init__(self, ends: TransferEnds) -> None:
        self._ends = ends
        names = ends.destinations(key_names(ends.giver))
        _require_any(
            names,
            InputError("{object} has no shape keys to transfer besides its basis.", object=ends.giver.name),
        )
        self._kept = _kept(ends, names, locked_keys, key_names)
        self._names = {name: own for name, own in names.items() if own not in self._kept}
        self._keys = read_keys(ends.giver, list(self._names))
        self._result: list[KeyOffsets] = []

    def steps(self) -> Iterator[Sentence]:
        """Compute key by key."""
        ends, total = self._ends, len(self._keys)
        yield Sentence("Comparing the shapes")
        carrier = ShapeCarrier.of(ends.points, ends.giver_mesh, ends.receiver_mesh) if self._keys else None
        for place, key in enumerate(self._keys, start=1):
            yield Sentence("Transferring shape key {done} of {total}", {"done": place, "total": total})
            offsets = carrier.carried(key.offsets)
            base = self._names.get(key.relative_to, key.relative_to)
            self._result.append(KeyOffsets(self._names[key.name], base, offsets, key.slider))

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the keys."""
        if self._result:
            write_keys(receiver, _bases_first(self._result))
        return Carried(tuple(self._names.values()), self._kept)


class CarriedColors:
    """Color attributes on their way.

    Parameters
    ----------
    ends : TransferEnds
        From where to where.

    Raises
    ------
    InputError
        The giver has none, or something else of the receiver has such a name.
    """

    def __init__(self, ends: TransferEnds) -> None:
        self._ends = ends
        giver = ends.giver
        nothing = InputError("{object} has no color attributes to transfer.", object=giver.name)
        chosen = _chosen_layers(ends, color_names, nothing)
        self._kept = chosen.kept
        self._kinds = {name: color_kind(giver, name) for name in chosen.written}
        self._colors = {name: read_colors(giver, name) for name in chosen.written}
        for name in chosen.written:
            require_color_name(ends.receiver, name)
        corners = [name for name in chosen.written if is_per_corner(giver, name)]
        if corners:
            loops = triangle_loops(giver, ends.giver_mesh.faces)
            self._colors |= {name: self._colors[name][loops] for name in corners}
        self._result: dict[str, NDArray[np.float64]] = {}

    def steps(self) -> Iterator[Sentence]:
        """Compute."""
        yield Sentence("Transferring color attributes")
        points, mesh = self._ends.points, self._ends.giver_mesh
        for name, colors in self._colors.items():
            is_corner = colors.ndim == 3
            self._result[name] = (
                transferred_corner_values(points, colors) if is_corner else transferred_values(points, mesh, colors)
            )
            # Black that hides nothing.
            self._result[name][~points.found] = (0.0, 0.0, 0.0, 1.0)

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the attributes."""
        for name, colors in self._result.items():
            write_colors(receiver, name, colors, self._kinds[name])
        return Carried(tuple(self._result), self._kept)


class CarriedUvs:
    """UV maps on their way.

    Parameters
    ----------
    ends : TransferEnds
        From where to where.

    Raises
    ------
    InputError
        The giver has none, or the receiver can have no more.
    """

    def __init__(self, ends: TransferEnds) -> None:
        self._ends = ends
        giver, receiver = ends.giver, ends.receiver
        nothing = InputError("{object} has no UV maps to transfer; unwrap it first.", object=giver.name)
        chosen = _chosen_layers(ends, uv_names, nothing)
        self._kept = chosen.kept
        require_uv_names(receiver, chosen.written)
        loops = triangle_loops(giver, ends.giver_mesh.faces)
        self._given = {name: read_uvs(giver, name)[loops] for name in chosen.written}
        self._loops, self._polygons = triangle_loops(receiver, ends.receiver_mesh.faces), triangle_polygons(receiver)
        self._result: dict[str, TransferredUvs] = {}

    def steps(self) -> Iterator[Sentence]:
        """Compute map by map."""
        ends = self._ends
        for name, given in self._given.items():
            yield Sentence("Transferring UV map {name}", {"name": name})
            self._result[name] = transferred_uvs(
                ends.points, ends.giver_mesh, given, ends.receiver_mesh, self._polygons
            )

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the maps, and mark their seams."""
        for name, found in self._result.items():
            write_uvs(receiver, name, self._loops.ravel(), found.uvs.reshape(-1, 2))
            mark_seams(receiver, found.seams)
        notices = tuple(notice for found in self._result.values() for notice in found.notices)
        return Carried(tuple(self._result), self._kept, notices)


def _require_any(names: Mapping[str, str] | Sequence[str], error: InputError) -> None:
    if not names:
        raise error


@dataclass(frozen=True)
class _ChosenLayers:
    """Names of layers of a mesh: those that are written, and those that stay as they are at the receiver."""

    written: list[str]
    kept: tuple[str, ...]


def _chosen_layers(
    ends: TransferEnds, known: Callable[[bpy.types.Object], list[str]], nothing: InputError
) -> _ChosenLayers:
    """Choose among the layers of the giver, which keep their names; raises `nothing` where there are none."""
    names = [name for name in known(ends.giver) if not ends.names or name in ends.names]
    _require_any(names, nothing)
    kept = tuple(name for name in names if ends.keep and name in known(ends.receiver))
    return _ChosenLayers([name for name in names if name not in kept], kept)


def _kept(
    ends: TransferEnds,
    names: Mapping[str, str],
    locked: Callable[[bpy.types.Object, Sequence[str]], list[str]],
    known: Callable[[bpy.types.Object], list[str]],
) -> tuple[str, ...]:
    """Return the names at the receiver that are not to be written."""
    wanted = list(names.values())
    there = set(locked(ends.receiver, wanted)) | (set(known(ends.receiver)) if ends.keep else set())
    return tuple(name for name in wanted if name in there)


def _bases_first(keys: Sequence[KeyOffsets]) -> list[KeyOffsets]:
    """Return keys so that those that others start from come before them."""
    left, done = list(keys), []
    while left:
        names = {key.name for key in left}
        ready = [key for key in left if key.relative_to not in names] or left
        done += ready
        names -= {key.name for key in ready}
        left = [key for key in left if key.name in names]
    return done
