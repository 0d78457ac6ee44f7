# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Empty that is dragged on a pad."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray


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
