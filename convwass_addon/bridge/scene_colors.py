# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The linear color space of the scene and sRGB; from Blender 5.0 on, a file chooses the former."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Color
from numpy.typing import NDArray

from ..applications.palettes.lab_colors import linear_of_srgb, srgb_of_linear


def scene_to_rec709() -> NDArray[np.float64]:
    """Return the matrix from the linear scene color space to Rec.709; exactly the identity if they are the same."""
    columns = [Color(unit).from_scene_linear_to_rec709_linear() for unit in np.eye(3)]
    matrix = np.array(columns, dtype=np.float64).T
    return np.eye(3) if np.abs(matrix - np.eye(3)).max() < 1e-4 else matrix


def scene_of_rec709(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """Convert linear Rec.709 colors, (..., 3), to scene linear ones of the same type."""
    return _converted(linear, np.linalg.inv(scene_to_rec709()))


def scene_of_srgb(encoded: NDArray[np.floating]) -> NDArray[np.floating]:
    """Decode sRGB colors, (..., 3), to scene linear ones of the same type."""
    return scene_of_rec709(linear_of_srgb(encoded))


def srgb_of_scene(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """Encode scene linear colors, (..., 3), as sRGB, such as for 8-bit images; values outside of 0 to 1 are clipped."""
    return srgb_of_linear(np.clip(_converted(linear, scene_to_rec709()), 0.0, 1.0))


def kind_of_colors() -> str:
    """Return the type of color attribute that holds the colors of a scene: bytes, unless sRGB does not reach them."""
    return "BYTE_COLOR" if _is_rec709() else "FLOAT_COLOR"


def set_colors(attribute: bpy.types.Attribute, colors: NDArray[np.floating]) -> None:
    """Write scene linear RGBA colors, (n, 4), to all elements of a color attribute."""
    values = np.ascontiguousarray(colors, dtype=np.float32)
    if attribute.data_type == "BYTE_COLOR" and not _is_rec709():
        # Blender decodes bytes to the space of the scene, but encodes as if that were always Rec.709.
        encoded = np.concatenate([srgb_of_scene(values[:, :3]), values[:, 3:]], axis=1)
        attribute.data.foreach_set("color_srgb", encoded.ravel())
    else:
        attribute.data.foreach_set("color", values.ravel())


def _is_rec709() -> bool:
    return np.array_equal(scene_to_rec709(), np.eye(3))


def _converted(colors: NDArray[np.floating], matrix: NDArray[np.float64]) -> NDArray[np.floating]:
    if np.array_equal(matrix, np.eye(3)):
        return colors
    return colors @ matrix.T.astype(colors.dtype)
