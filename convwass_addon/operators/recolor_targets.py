# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The image to recolor and the palettes, and the poll methods of their operators."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import bpy
from bpy.props import StringProperty

from ..bridge.palettes.image_kinds import source_of
from ..errors import InputError
from .background import is_idle

if TYPE_CHECKING:
    from ..applications.palettes.recolor_job import Picture


def image_property() -> object:
    """Return the property that names an image in scripts."""
    return StringProperty(
        name="Image",
        description="Name of the image; empty for the image in the Image Editor",
        options={"SKIP_SAVE"},
    )


def shown_image(context: bpy.types.Context) -> bpy.types.Image | None:
    """Return the image in the current Image Editor; for a result, the image that it was made from."""
    space = context.space_data
    image = space.image if space is not None and space.type == "IMAGE_EDITOR" else None
    return None if image is None else source_of(image) or image


def chosen_image(context: bpy.types.Context, name: str) -> bpy.types.Image:
    """Return the named image, or the one in the Image Editor.

    Raises
    ------
    InputError
        There is none.
    """
    image = bpy.data.images.get(name) if name else shown_image(context)
    if image is None and name:
        raise InputError("There is no image named {name}.", name=name)
    if image is None:
        raise InputError("Open an image in the Image Editor first, or name one.")
    return image


class OnImage:
    """Base of operators on an image and its chosen palettes."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not context.scene.convwass_recolor.chosen_palettes:
            cls.poll_message_set("Choose a palette, an image with the desired colors")
            return False
        space = context.space_data
        if space is not None and space.type == "IMAGE_EDITOR" and space.image is None:
            cls.poll_message_set("Open an image first")
            return False
        return is_idle(cls, context)


def read_pictures(context: bpy.types.Context, image: bpy.types.Image) -> tuple[Picture, list[Picture], list[float]]:
    """Read the image, its mask, and the palettes with their weights.

    Raises
    ------
    InputError
        An image cannot be read, or a mask has a different size.
    """
    from ..bridge.palettes.image_pixels import read_picture

    source = read_picture(image, context.scene.convwass_recolor.mask)
    return source, *read_palettes(context)


def read_palettes(context: bpy.types.Context) -> tuple[list[Picture], list[float]]:
    """Read the palettes, with their weights.

    Raises
    ------
    InputError
        An image cannot be read, or the mask has a different size.
    """
    from ..bridge.palettes.image_pixels import read_picture

    own = context.scene.convwass_recolor
    palettes = [read_picture(palette) for palette, _ in own.chosen_palettes]
    if own.palette_mask is not None and own.palette is not None:
        masked = read_picture(own.palette, own.palette_mask)
        palettes[0] = replace(palettes[0], mask=masked.mask)
    return palettes, [weight for _, weight in own.chosen_palettes]


def palette_names(context: bpy.types.Context) -> list[str]:
    """Return the names of the palettes with a positive weight.

    Called when a job begins, because the choice can change while it runs.
    """
    return [image.name for image, weight in context.scene.convwass_recolor.chosen_palettes if weight > 0]
