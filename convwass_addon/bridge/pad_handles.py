# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What pads have in common: their lines, the Empty that is dragged, what it drives, and the names at the corners."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

OUTLINES = {2: [(0, 1)], 3: [(0, 1), (1, 2), (2, 0)], 4: [(0, 1), (1, 3), (3, 2), (2, 0)]}
"""Edges around a pad by the number of its corners; those of a square are in rows."""

PLACES = {"x": "X on Pad", "z": "Z on Pad"}
"""Custom properties of an Empty that drives something: its place in local space of the pad."""

# Rows of a world matrix with the axes X and Z.
_ROWS = (0, 2)
# Where the handle h is along an axis a of a pad that is at p.
_ALONG = "((h0 - p0) * a0 + (h1 - p1) * a1 + (h2 - p2) * a2) / (a0 * a0 + a1 * a1 + a2 * a2)"


def pad_lines(name: str, points: NDArray[np.float64], edges: Sequence[Sequence[int]]) -> bpy.types.Object:
    """Draw the lines of a pad, edges between points, (n, 3); the object is not in a collection yet."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), edges, [])
    pad = bpy.data.objects.new(mesh.name, mesh)
    pad.hide_render = True
    return pad


def pad_handle(name: str, size: float, points: NDArray[np.float64], pad: bpy.types.Object) -> bpy.types.Object:
    """Create an Empty that cannot leave the bounds or the plane of a pad.

    Parameters
    ----------
    name : str
        Name of the Empty.
    size : float
        Display radius.
    points : (n, 3) float64
        Points of the pad in local space; X and Z span its plane.
    pad : bpy.types.Object
        Parent of the Empty, at its origin.

    Returns
    -------
    bpy.types.Object
        Not in a collection yet.
    """
    handle = bpy.data.objects.new(name, None)
    handle.empty_display_type, handle.empty_display_size = "SPHERE", size
    handle.show_in_front, handle.parent = True, pad
    handle.lock_location[1] = True
    limit = handle.constraints.new("LIMIT_LOCATION")
    limit.owner_space, limit.use_transform_limit = "LOCAL", True
    for axis, low, high in zip("xyz", points.min(axis=0), points.max(axis=0), strict=True):
        for end, value in (("min", low), ("max", high)):
            setattr(limit, f"use_{end}_{axis}", True)
            setattr(limit, f"{end}_{axis}", value)
    return handle


def drive_by_handle(driver: bpy.types.Driver, handle: bpy.types.Object, expression: str) -> None:
    """Let the place of the Empty drive a property, by an expression of x and z in local space of the pad.

    The place is where the Empty is seen, whatever its parent, as in the nodes of blend pads.
    """
    if any(name not in handle for name in PLACES.values()):
        _drive_places(handle, handle.parent)
    for letter, name in PLACES.items():
        variable = driver.variables.new()
        variable.name = letter
        target = variable.targets[0]
        target.id, target.data_path = handle, f'["{name}"]'
    driver.expression = expression


def _drive_places(handle: bpy.types.Object, pad: bpy.types.Object) -> None:
    """Let the places of an Empty and a pad, which is not sheared, drive the properties `PLACES` of the Empty."""
    for name, row in zip(PLACES.values(), _ROWS, strict=True):
        handle[name] = 0.0
        driver = handle.driver_add(f'["{name}"]').driver
        for letter, obj, own in (("h", handle, 3), ("p", pad, 3), ("a", pad, row)):
            for axis in range(3):
                variable = driver.variables.new()
                variable.name = f"{letter}{axis}"
                target = variable.targets[0]
                target.id, target.data_path = obj, f"matrix_world[{own}][{axis}]"
        driver.expression = _ALONG


def pad_labels(
    names: Sequence[str],
    corners: NDArray[np.float64],
    size: float,
    pad: bpy.types.Object,
    gaps: tuple[float, float] = (1.1, -1.9),
    called: str = "{} Label",
) -> list[bpy.types.Object]:
    """Write names at the corners of a pad: above the upper ones, below the lower ones.

    Parameters
    ----------
    names : sequence of str
        One name per corner.
    corners : (n, 3) float64
        In local space of the pad; X and Z span its plane.
    size : float
        Size of the letters.
    pad : bpy.types.Object
        Parent of the names, at its origin.
    gaps : (float, float)
        Distances of the names from upper and from lower corners, upward, relative to the size.
    called : str
        Names of the objects, given those at the corners.

    Returns
    -------
    list of bpy.types.Object
        Not in a collection yet.
    """
    shifts = size * np.where(corners[:, 2] > corners[:, 2].mean(), *gaps)
    return [
        _label(called.format(name), name, size, x, z + shift, pad)
        for name, (x, _, z), shift in zip(names, corners, shifts, strict=True)
    ]


def _label(name: str, text: str, size: float, x: float, z: float, pad: bpy.types.Object) -> bpy.types.Object:
    """Write a centered text at a place on a pad."""
    font = bpy.data.curves.new(text, "FONT")
    font.body, font.size, font.align_x = text, size, "CENTER"
    # Move the text instead of the object: Blender draws a line from every child to its parent.
    font.offset_x, font.offset_y = x, z
    label = bpy.data.objects.new(name, font)
    label.parent, label.rotation_euler.x = pad, math.pi / 2.0
    label.hide_render = label.hide_select = True
    return label
