# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Decide whether frames show the whole materials of the inputs, and prepare them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ....applications.morphs.appearance import Appearance
from ...handles import Handle
from ...joined_shapes import OWN_POSITION
from ...nodes.node_trees import node_trees
from ...nodes.shown_nodes import nodes_of
from ...object_values import reads_property
from ..inputs.frozen_inputs import FrozenInput
from .dropped_appearance import DroppedPart, dropped_parts, dropped_passes, dropped_with_looks
from .frame_attributes import GENERATED
from .look_groups import CarriedNames, LookGroups, is_wrapped
from .look_mixing import COLORS, FADE, PATCHES
from .look_sources import carried_names, with_looks, write_own_looks
from .mixed_materials import MixedMaterials, WholeLooks


@dataclass(frozen=True)
class PreparedLooks:
    """How the frames of a bake look.

    Attributes
    ----------
    appearances : list of Appearance
        Of the inputs, with everything that their materials read.
    whole : WholeLooks or None
        Their materials; None if frames only have colors and the values of shaders.
    dropped : list of list of DroppedPart
        What frames do not show, for every input.
    """

    appearances: list[Appearance]
    whole: WholeLooks | None
    dropped: list[list[DroppedPart]]


def prepared_looks(
    inputs: Sequence[FrozenInput], frozen: Sequence[bpy.types.Mesh], appearances: Sequence[Appearance], how: str
) -> PreparedLooks:
    """Copy the materials of the inputs if colors and values do not show all of them.

    Parameters
    ----------
    inputs : sequence of FrozenInput
        The shapes.
    frozen : sequence of bpy.types.Mesh
        Copies of them.
    appearances : sequence of Appearance
        Read from these.
    how : str
        Value of the setting `looks`.
    """
    simple = [dropped_parts(*own) for own in zip(frozen, appearances, strict=True)]
    # Whole materials do not show these either.
    passes = [dropped_passes(_used_materials(*own)) for own in zip(frozen, appearances, strict=True)]
    if how == COLORS or (how == FADE and not any(simple)):
        return PreparedLooks(list(appearances), None, [own + more for own, more in zip(simple, passes, strict=True)])
    found, groups, dropped = [], [], []
    for number, (source, mesh, own, parts) in enumerate(zip(inputs, frozen, appearances, simple, strict=True), start=1):
        names = carried_names(number, mesh, source)
        groups.append(_groups(mesh, own, names))
        always = [GENERATED.format(number)] if how == PATCHES and number > 1 else []
        found.append(with_looks(own, mesh, source, names, always))
        wrapped = [material for material in _used_materials(mesh, own) if is_wrapped(material)]
        kept = {material.name for material in wrapped}
        dropped.append([part for part in parts if part.material not in kept] + dropped_with_looks(wrapped))
    dropped = [own + more for own, more in zip(dropped, passes, strict=True)]
    return PreparedLooks(found, WholeLooks(groups, how), dropped)


def assign_end_materials(
    prepared: PreparedLooks, materials: MixedMaterials, inputs: Sequence[FrozenInput], frozen: Sequence[bpy.types.Mesh]
) -> None:
    """Give copies of inputs the materials of frames where their own materials read what copies do not have.

    Copies are in world space, in which materials that read positions in object space would look different, and are
    data of other objects, which have the color of a frame.
    """
    for index, (source, mesh, own) in enumerate(zip(inputs, frozen, prepared.appearances, strict=True)):
        is_moved = OWN_POSITION in mesh.attributes or not np.allclose(source.own_space, np.eye(4), atol=1e-6)
        slots = _slots_in_own_space(prepared.whole, index, own) if is_moved else []
        slots = sorted({*slots, *_slots_with_object_values(prepared.whole, index, mesh)})
        for slot in slots:
            combination = [0] * len(frozen)
            combination[index] = slot
            mesh.materials[slot] = materials.of(combination)
        if slots:
            write_own_looks(mesh, own, index + 1, len(frozen))
        if OWN_POSITION in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[OWN_POSITION])


def _groups(mesh: bpy.types.Mesh, appearance: Appearance, names: CarriedNames) -> list[Handle | None]:
    """Return a group for every slot of an input; slots with the same material share it."""
    made, groups = {}, LookGroups(names)
    used = _used_materials(mesh, appearance)
    for material in used:
        group = groups.of(material)
        if group is not None:
            made[material] = Handle.of("node_groups", group)
    return [made.get(material) for material in mesh.materials] or [None]


def _used_materials(mesh: bpy.types.Mesh, appearance: Appearance) -> list[bpy.types.Material]:
    """Return the materials that any face uses."""
    slots = [slot for slot in np.unique(appearance.materials) if len(mesh.materials)]
    return list(dict.fromkeys(mesh.materials[slot] for slot in slots if mesh.materials[slot] is not None))


def _slots_in_own_space(whole: WholeLooks | None, index: int, appearance: Appearance) -> list[int]:
    """Return the slots of an input whose materials read positions or normals in its own space."""
    if whole is None:
        return []
    groups = whole.of_input(index)
    return [slot for slot, group in groups.items() if not appearance.fields.keys().isdisjoint(_read(group))]


def _slots_with_object_values(whole: WholeLooks | None, index: int, mesh: bpy.types.Mesh) -> list[int]:
    """Return the slots of an input whose materials read something of the object itself."""
    if whole is None:
        return []
    return [
        slot for slot in whole.of_input(index) if slot < len(mesh.materials) and _reads_object(mesh.materials[slot])
    ]


def _reads_object(material: bpy.types.Material | None) -> bool:
    nodes = nodes_of([material])
    info = [output for node in nodes if node.type == "OBJECT_INFO" for output in node.outputs]
    # Copies have the material itself, with its index.
    read = any(output.is_linked and output.name != "Material Index" for output in info)
    return read or any(reads_property(node) for node in nodes)


def _read(group: bpy.types.NodeTree) -> Iterator[str]:
    """Return the names of the attributes that a group reads."""
    for tree in node_trees(group):
        yield from (node.attribute_name for node in tree.nodes if node.type == "ATTRIBUTE")
