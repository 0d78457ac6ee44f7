# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a density on its way was asked for, as it is stored with every one, whoever asked."""

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
    """What a density on its way was asked for besides the settings of its solver."""

    easing: str = setting(
        "LINEAR",
        "Easing",
        "How the value goes from group to group; edit its curve for more",
        choices=(
            Choice("LINEAR", "Linear", "At constant speed"),
            Choice("SMOOTH", "Smooth", "Slow away from every group and slow into the next"),
        ),
        panel="path",
    )
    trail: bool = setting(
        False,
        "Leave a Trail",
        "What the density has covered stays covered, as moss or frost that creeps along",
        panel="path",
    )


def path_request(
    obj: bpy.types.Object,
    weights: ArrayLike,
    settings: DensitySettings,
    request: DensityRequest,
    frames: Sequence[float],
) -> dict[str, object]:
    """Return the settings that :class:`.StoredDensity` keeps, so that the density can be made again.

    Parameters
    ----------
    obj : bpy.types.Object
        The mesh object that the density is on.
    weights : (k, n) array_like
        Of the groups that it goes through; later ones are compared with them.
    settings : DensitySettings
        How it is moved.
    request : DensityRequest
        How it is shown.
    frames : sequence of float, (k,)
        The scene frames at which it has come to each of them.
    """
    asked = {"frames": [float(frame) for frame in frames], **request.as_dict()}
    return {**settings.as_dict(), **asked, **marks_of(obj, np.asarray(weights))}


def marks_of(obj: bpy.types.Object, weights: ArrayLike) -> dict[str, object]:
    """Return numbers that tell later whether groups, of which `weights` are (k, n), or the mesh have changed."""
    ramp = np.linspace(1.0, 2.0, np.shape(weights)[1])
    return {"mesh": [len(obj.data.vertices), len(obj.data.polygons)], "marks": [float(own @ ramp) for own in weights]}
