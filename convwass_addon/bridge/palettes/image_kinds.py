# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What an image is: a clip with frames, or the result of recoloring another one."""

from __future__ import annotations

import bpy

_KINDS = ("SEQUENCE", "MOVIE")


def is_clip(image: bpy.types.Image | None) -> bool:
    """Tell whether an image has frames."""
    return image is not None and image.source in _KINDS


RESULT_OF = "convwass_recolored"
"""Custom property of a result: the name of the image that it was made from."""
