# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of images: clips with frames, and results of recoloring."""

from __future__ import annotations

import bpy

_KINDS = ("SEQUENCE", "MOVIE")


def is_clip(image: bpy.types.Image | None) -> bool:
    """Return whether an image has frames."""
    return image is not None and image.source in _KINDS


RESULT_OF = "convwass_recolored"
"""Custom property of a result: the source image."""


def source_of(result: bpy.types.Image) -> bpy.types.Image | None:
    """Return the image that another one was made from; None if that is no result, or if the source was deleted."""
    source = result.get(RESULT_OF)
    # Earlier versions stored the name.
    return bpy.data.images.get((source, None)) if isinstance(source, str) else source
