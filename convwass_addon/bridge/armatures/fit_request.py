# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a fit that concern Blender."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class FitRequest(Settings):
    """Settings of a fit besides those of its solver."""

    bones: str = setting(
        "deform",
        "Bones",
        "The bones to fit",
        choices=(
            Choice(
                "deform",
                "Deforming",
                "Bones that deform meshes, or all bones if none does; other bones, such as control handles, follow "
                "the nearest joints",
            ),
            Choice("all", "All", "All bones, including control bones"),
        ),
        option="--all-bones",
        flag="all",
        help="Also fit bones that do not deform meshes; otherwise they follow the others",
        panel="settings",
    )
    auto_weights: bool = setting(
        False,
        "Automatic Weights",
        "Bind the body to the armature afterwards with Blender's automatic weights, which replace the groups named "
        "after bones",
    )
