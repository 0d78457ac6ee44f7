# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The attributes of a mesh that hold the frames of a density."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .density_nodes import NAME, TAKEN_BY_RENDERERS, color_name, frame_name, is_frame

# Values are rounded to this share of the largest: numbers that end in zeros make small files.
_STEP = 2.0**-16


def stored_frames(obj: bpy.types.Object, name: str = NAME) -> NDArray[np.float32]:
    """Return the frames that a mesh holds, (f, n), the largest value 1; of no rows where there are none."""
    attributes, places = obj.data.attributes, []
    while frame_name(name, len(places)) in attributes:
        places.append(frame_name(name, len(places)))
    frames = np.zeros((len(places), len(obj.data.vertices)), dtype=np.float32)
    for row, place in zip(frames, places, strict=True):
        attributes[place].data.foreach_get("value", row)
    return frames


def require_free(obj: bpy.types.Object, name: str) -> None:
    """Refuse names that Blender, or the user, needs for something else.

    Raises
    ------
    InputError
        It says what the name is needed for.
    """
    if not name or name.startswith(".") or "*" in name or len(frame_name(name, 9999).encode()) > 63:
        raise InputError(
            "{name} cannot be the name of a density; choose a short one without stars, not starting with a dot.",
            name=name,
        )
    if name in TAKEN_BY_RENDERERS:
        raise InputError(
            "Renderers mean something else by {name}; choose another name, such as {other}.",
            name=name,
            other=f"My {name}",
        )
    if name in obj.vertex_groups or name in obj.data.attributes:
        raise InputError(
            "{object} has a vertex group or an attribute {name} already; choose another name for the density.",
            object=obj.name,
            name=name,
        )


def write_frames(mesh: bpy.types.Mesh, name: str, frames: NDArray[np.float64]) -> None:
    """Replace the frames that a mesh holds, (f, n), the largest value 1."""
    remove_frames(mesh, name)
    for place, values in enumerate(frames):
        attribute = mesh.attributes.new(frame_name(name, place), "FLOAT", "POINT")
        attribute.data.foreach_set("value", (np.rint(values / _STEP) * _STEP).astype(np.float32))


def remove_frames(mesh: bpy.types.Mesh, name: str) -> None:
    """Remove the frames that a mesh holds."""
    for frame in [attribute.name for attribute in mesh.attributes if is_frame(attribute.name, name)]:
        mesh.attributes.remove(mesh.attributes[frame])


def remove_color(mesh: bpy.types.Mesh, name: str) -> None:
    """Remove the attribute that stands for the colors that the nodes write."""
    color = mesh.color_attributes.get(color_name(name))
    if color is not None:
        mesh.color_attributes.remove(color)
