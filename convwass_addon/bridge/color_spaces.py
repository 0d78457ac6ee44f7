# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Color spaces and view transforms, by the names that they have in common OpenColorIO configurations.

Studios replace Blender's configuration by another one, mostly of ACES, with the environment variable ``OCIO``.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..errors import ConvwassError

SRGB = ("sRGB", "sRGB - Texture", "Utility - sRGB - Texture", "sRGB OETF")
"""Names of sRGB for textures."""

DATA = ("Non-Color", "Raw", "Utility - Raw", "Generic Data")
"""Names for values that are not colors."""

LINEAR = ("Linear Rec.709", "Linear Rec.709 (sRGB)", "Linear", "scene_linear", "Linear BT.709 I-D65")
"""Names of the linear space of sRGB."""

_UNCHANGED = ("Standard", "Un-tone-mapped")


def color_space(names: Sequence[str]) -> str:
    """Return the first of some names of a color space that the configuration has.

    Raises
    ------
    ConvwassError
        It has none of them.
    """
    known = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items
    found = next((name for name in names if name in known), None)
    if found is None:
        raise _unknown(names[0])
    return found


def show_unchanged(scene: bpy.types.Scene) -> None:
    """Let renders and saved images of a scene have their colors encoded, but not graded.

    Raises
    ------
    ConvwassError
        The configuration has no such view transform.
    """
    for name in _UNCHANGED:
        try:
            scene.view_settings.view_transform = name
        except TypeError:
            continue
        return
    raise _unknown(_UNCHANGED[0])


def _unknown(name: str) -> ConvwassError:
    return ConvwassError(
        "The OpenColorIO configuration of this Blender has nothing like {name}; start Blender without the environment "
        "variable OCIO, or with a configuration of ACES 1.3.",
        name=name,
    )
