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
"""Custom property of a result: the name of the source image."""
