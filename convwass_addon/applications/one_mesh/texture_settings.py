# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the images baked for one mesh."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class TextureSettings(Settings):
    """How images of the looks of several shapes are baked for one mesh."""

    texture_size: int = setting(
        1024,
        "Size",
        "Number of pixels along a side of every image",
        least=16,
        most=16384,
        soft_least=256,
        soft_most=4096,
        subtype="PIXEL",
    )
    texture_samples: int = setting(
        16,
        "Samples",
        "Samples per pixel, for smooth borders within textures",
        least=1,
        most=4096,
        soft_most=64,
    )
    texture_looks: str = setting(
        "ALL",
        "Looks",
        "The shapes whose looks are baked",
        choices=(
            Choice("ALL", "All Shapes", "Images of every shape, which the material mixes by the sliders"),
            Choice("START", "First Shape", "Images of the look of the undeformed mesh"),
            Choice("END", "Last Shape", "Images of the look of the last shape, such as for a game engine"),
        ),
    )
    texture_uvs: str = setting(
        "AUTO",
        "UV Map",
        "The UV map of the images",
        choices=(
            Choice("AUTO", "Automatic", "That of the mesh if its faces do not overlap in it, otherwise a new one"),
            Choice("OWN", "Own", "That of the mesh, as it is used in renders"),
            Choice("NEW", "New", "A new one, made with Smart UV Project"),
        ),
    )
    texture_folder: str = setting(
        "",
        "Folder",
        "Where the images are written as PNG files; if empty, they are packed into the .blend file",
        subtype="DIR_PATH",
        help="where the images are written as PNG files; // stands for the folder of the .blend file; by default, "
        "they are packed into that file",
    )
