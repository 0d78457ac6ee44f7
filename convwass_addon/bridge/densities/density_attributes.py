# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh attributes that store the frames of a density."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ..element_values import write_attribute
from .density_nodes import NAME, TAKEN_BY_RENDERERS, color_name, frame_name, is_frame

# Values are rounded to this share of the maximum, because numbers that end in zeros compress well.
_STEP = 2.0**-16


def stored_frames(obj: bpy.types.Object, name: str = NAME) -> NDArray[np.float32]:
    """Return the stored frames, (f, n), with maximum 1; empty if there are none."""
    attributes, places = obj.data.attributes, []
    while frame_name(name, len(places)) in attributes:
        places.append(frame_name(name, len(places)))
    frames = np.zeros((len(places), len(obj.data.vertices)), dtype=np.float32)
    for row, place in zip(frames, places, strict=True):
        attributes[place].data.foreach_get("value", row)
    return frames


def require_free(obj: bpy.types.Object, name: str) -> None:
    """Check that a name is not used by Blender or by the user.

    Raises
    ------
    InputError
        The name is already used.
    """
    if not name:
        raise InputError("A density needs a name; choose a short one.")
    if name.startswith(".") or "*" in name or len(frame_name(name, 9999).encode()) > 63:
        raise InputError(
            "{name} cannot be the name of a density; choose a short name without asterisks that does not start with a "
            "dot.",
            name=name,
        )
    if name in TAKEN_BY_RENDERERS:
        raise InputError(
            "Renderers use {name} for something else; choose another name, such as {other}.",
            name=name,
            other=f"My {name}",
        )
    if name in obj.vertex_groups or name in obj.data.attributes:
        raise InputError(
            "{object} already has a vertex group or an attribute {name}; choose another name for the density.",
            object=obj.name,
            name=name,
        )


def checked_frames(densities: ArrayLike, count: int, least: int = 1) -> NDArray[np.float64]:
    """Return densities of `count` vertices, (f, n); raises ValueError for invalid ones, and fewer than `least`."""
    frames = np.atleast_2d(np.asarray(densities, dtype=np.float64))
    if frames.ndim != 2 or len(frames) < least or frames.shape[1] != count:
        raise ValueError(f"densities of shape {frames.shape} for {count} vertices")
    if not (np.isfinite(frames).all() and frames.min(initial=0.0) >= 0.0):
        raise ValueError("densities are negative or not finite")
    return frames


def write_frames(mesh: bpy.types.Mesh, name: str, frames: NDArray[np.float64]) -> None:
    """Replace the stored frames by others, (f, n), with maximum 1."""
    remove_frames(mesh, name)
    for place, values in enumerate(frames):
        write_attribute(mesh, frame_name(name, place), "FLOAT", np.rint(values / _STEP) * _STEP)


def remove_frames(mesh: bpy.types.Mesh, name: str) -> None:
    """Remove the stored frames."""
    for frame in [attribute.name for attribute in mesh.attributes if is_frame(attribute.name, name)]:
        mesh.attributes.remove(mesh.attributes[frame])


def remove_color(mesh: bpy.types.Mesh, name: str) -> None:
    """Remove the color attribute that the nodes write."""
    color = mesh.color_attributes.get(color_name(name))
    if color is not None:
        mesh.color_attributes.remove(color)
