# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of live morphs: read them from the shapes, and show them on blends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np
from numpy.typing import NDArray

from ..handles import found
from ..morphs.looks.frame_attributes import COLOR
from ..morphs.looks.materials import wire
from ..shape_sources import ShapeSource
from .leftovers import LIVE_KEY

if TYPE_CHECKING:
    from ...applications.morphs.appearance import Appearance
    from ...geometry.solids.alignment import RigidMove

KEPT_MATERIAL = "Convwass Blend"
"""Name of the material of kept shapes that have colors."""

_LIVE_MATERIAL = "Live Morph"


def read_colors(sources: Sequence[ShapeSource], moves: Sequence[RigidMove] | None) -> tuple[Appearance, ...]:
    """Return the colors of shapes, in the space of the blends; empty if they all have the same color.

    Parameters
    ----------
    sources : sequence of ShapeSource
        The shapes.
    moves : sequence of RigidMove or None
        Transforms that align them.
    """
    from ..morphs.inputs.frozen_inputs import frozen_inputs
    from ..morphs.looks.appearance import read_appearance

    shapes = frozen_inputs(sources, moves or [None] * len(sources))
    copies = found([shape.mesh for shape in shapes])
    try:
        looks = [read_appearance(mesh, own.values.color) for mesh, own in zip(copies, shapes, strict=True)]
    finally:
        bpy.data.batch_remove(copies)
    if all(look.is_even and look.paints == looks[0].paints for look in looks):
        return ()
    return tuple(looks)


def are_alike(looks: Sequence[Appearance], others: Sequence[Appearance]) -> bool:
    """Return whether shapes have the same colors at the same places."""
    return len(looks) == len(others) and all(
        len(own.paints) == len(other.paints)
        and np.array_equal(own.materials, other.materials)
        and all(map(_is_same_paint, own.paints, other.paints))
        for own, other in zip(looks, others, strict=True)
    )


def write_colors(mesh: bpy.types.Mesh, colors: NDArray[np.float32]) -> None:
    """Write colors of the vertices, (n, 3), scene linear."""
    values = np.ones((len(colors), 4), np.float32)
    values[:, :3] = colors
    attribute = mesh.attributes.get(COLOR) or mesh.attributes.new(COLOR, "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", values.ravel())
    mesh.color_attributes.active_color_name = COLOR
    mesh.color_attributes.render_color_index = mesh.color_attributes.find(COLOR)


def show_colors(mesh: bpy.types.Mesh, colors: NDArray[np.float32], *, in_solid: bool) -> None:
    """Write colors of the vertices of a live shape, and give it a material that shows them.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        Of the live shape.
    colors : (n, 3) float32
        Scene linear.
    in_solid : bool
        Whether to set the color of the material in Solid mode as well, to the mean; that makes renderers read the
        material again.
    """
    write_colors(mesh, colors)
    material = next((own for own in mesh.materials if own is not None and LIVE_KEY in own), None)
    if material is None:
        material = _live_material()
        mesh.materials.clear()
        mesh.materials.append(material)
        in_solid = True
    if in_solid:
        material.diffuse_color = (*colors.mean(axis=0).tolist(), 1.0)


def _live_material() -> bpy.types.Material:
    """Create a material that is removed with the live morph."""
    material = bpy.data.materials.new(_LIVE_MATERIAL)
    wire(material, "ShaderNodeVertexColor", layer_name=COLOR)
    material[LIVE_KEY] = True
    material.is_runtime_data = True
    return material


def _is_same_paint(own: object, other: object) -> bool:
    return type(own) is type(other) and all(
        np.array_equal(value, vars(other)[name]) for name, value in vars(own).items()
    )
