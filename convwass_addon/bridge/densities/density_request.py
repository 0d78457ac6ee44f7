# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of an animated density that are stored with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import ArrayLike

from ...applications.densities.density_settings import DensitySettings
from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class DensityRequest(Settings):
    """Settings of an animated density besides those of its solver."""

    easing: str = setting(
        "LINEAR",
        "Easing",
        "Interpolation of the value between groups; edit its curve for more control",
        choices=(
            Choice("LINEAR", "Linear", "Constant speed"),
            Choice("SMOOTH", "Smooth", "Slow down at every group"),
        ),
        panel="path",
    )
    trail: bool = setting(
        False,
        "Leave a Trail",
        "Everything that the density has passed stays covered, like growing moss or frost",
        panel="path",
    )


def path_request(
    obj: bpy.types.Object,
    weights: ArrayLike,
    settings: DensitySettings,
    request: DensityRequest,
    frames: Sequence[float],
) -> dict[str, object]:
    """Return the settings stored in :class:`.StoredDensity`, with which the density can be computed again.

    Parameters
    ----------
    obj : bpy.types.Object
        The mesh object with the density.
    weights : (k, n) array_like
        Weights of the groups, used to detect later changes.
    settings : DensitySettings
        Settings of the transport.
    request : DensityRequest
        Settings of the animation.
    frames : sequence of float, (k,)
        Scene frame at each group.
    """
    asked = {"frames": [float(frame) for frame in frames], **request.as_dict()}
    return {**settings.as_dict(), **asked, **marks_of(obj, np.asarray(weights))}


def marks_of(obj: bpy.types.Object, weights: ArrayLike) -> dict[str, object]:
    """Return checksums to detect later changes of the mesh and of groups with `weights`, (k, n)."""
    ramp = np.linspace(1.0, 2.0, np.shape(weights)[1])
    return {"mesh": [len(obj.data.vertices), len(obj.data.polygons)], "marks": [float(own @ ramp) for own in weights]}
