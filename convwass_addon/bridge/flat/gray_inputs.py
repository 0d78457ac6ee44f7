# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read flat objects for pictures: images with their shades of gray, other objects as filled shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.flat.flat_shapes import FlatImage, FlatInput
from ...errors import InputError
from ...geometry.arrays.steps import linear_step
from ..scene_colors import srgb_of_scene
from ..visibility import evaluated_object
from .flat_images import border_of, figure_of, has_ground, one_tone, pixels_of
from .flat_kinds import is_image
from .flat_objects import flat_objects
from .planes import Plane, plane_of

# Relative difference above which the two scales of an image are not equal.
_UNEVEN = 1e-2
# Pixels with less coverage do not determine the color of ink.
_INKED = 0.1
# Coverage below this is noise.
_FAINT = 0.02
_NO_GROUND = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class GrayInput:
    """A flat object that is morphed as a picture.

    Attributes
    ----------
    shape : FlatShape or FlatImage
        In coordinates of its plane; colors are sRGB encoded, as in image files.
    plane : Plane
        The plane of the object.
    ground : (4,) float64
        Background color, sRGB encoded RGBA.
    """

    shape: FlatInput
    plane: Plane
    ground: NDArray[np.float64]


def gray_inputs(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> list[GrayInput]:
    """Read flat objects of the scene.

    Raises
    ------
    InputError
        An object cannot be read; the message names it and says what to do.
    """
    return [_image(obj, depsgraph) if is_image(obj) else _shape(obj, depsgraph) for obj in objects]


def _shape(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> GrayInput:
    (flat,) = flat_objects([obj], depsgraph)
    colors = flat.shape.colors.copy()
    colors[:, :3] = srgb_of_scene(colors[:, :3])
    return GrayInput(replace(flat.shape, colors=colors), flat.plane, np.array(_NO_GROUND))


def _image(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> GrayInput:
    pixels = pixels_of(obj.data)
    with evaluated_object(obj, depsgraph) as evaluated:
        matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    high, wide = pixels.shape[:2]
    local = obj.empty_display_size / max(wide, high)
    scales = np.linalg.norm(matrix[:3, :2], axis=0) * local
    if not np.isfinite(scales).all() or scales.min() <= 0 or np.ptp(scales) > _UNEVEN * scales.max():
        raise InputError(
            "{name} is scaled unevenly, but pictures have square pixels; make the X and Y scale equal in Item > "
            "Transform.",
            name=obj.name,
        )
    size, offset = np.array([wide, high]) * local, np.array(obj.empty_image_offset)
    corners = (np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + offset) * size
    pixel = float(scales.mean())
    plane = plane_of(corners @ matrix[:3, :2].T + matrix[:3, 3], matrix)
    full = _fullness(obj.data.name, figure_of(pixels))
    colors = _rgb(pixels)
    opaque = has_ground(pixels)
    ground = np.median(border_of(colors), axis=0) if opaque else np.zeros(3)
    if opaque:
        # A partially covered pixel is a mix of background and ink; solve for the ink.
        colors = ground + (colors - ground) / np.maximum(full, _INKED)[..., None]
    elif obj.data.alpha_mode == "PREMUL":
        colors = colors / np.maximum(full, _INKED)[..., None]
    # The last channel marks the pixels with ink.
    inked = np.dstack([np.clip(colors, 0.0, 1.0), full > _INKED]).swapaxes(0, 1)
    corner = -0.5 * pixel * np.array([wide, high])
    image = FlatImage(full.T.astype(np.float64), pixel, (float(corner[0]), float(corner[1])), "density", inked)
    return GrayInput(image, plane, np.append(ground, float(opaque)))


def _fullness(name: str, figure: NDArray[np.float32]) -> NDArray[np.float32]:
    """Scale the coverage, (h, w), from 0 on the background to 1 at its maximum."""
    base, top = float(np.median(border_of(figure))), float(figure.max())
    if top - base < _FAINT:
        raise one_tone(name)
    full = linear_step(figure, base, top)
    # Faint values are noise, and would add mass all over the picture.
    return np.where(full < _FAINT, 0.0, full)


def _rgb(pixels: NDArray[np.float32]) -> NDArray[np.float64]:
    colors = pixels[:, :, :3] if pixels.shape[2] > 2 else np.repeat(pixels[:, :, :1], 3, axis=2)
    return np.clip(colors.astype(np.float64), 0.0, 1.0)
