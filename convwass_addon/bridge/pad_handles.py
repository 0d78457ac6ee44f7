# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The empty that is dragged on a pad."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray


def pad_handle(name: str, size: float, points: NDArray[np.float64], pad: bpy.types.Object) -> bpy.types.Object:
    """Make an empty that cannot be dragged out of the bounds of a pad, nor off its plane.

    Parameters
    ----------
    name : str
        Of the empty.
    size : float
        Its radius as it is drawn.
    points : (n, 3) float64
        Of the pad, in its local space: X and Z are its plane.
    pad : bpy.types.Object
        What the empty hangs on, at its origin.

    Returns
    -------
    bpy.types.Object
        In no collection yet.
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
