# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is asked of Blender when an armature is fitted."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class FitRequest(Settings):
    """What a fit is asked for besides the settings of its solver."""

    bones: str = setting(
        "deform",
        "Bones",
        "Which bones are fitted",
        choices=(
            Choice(
                "deform",
                "That Deform",
                "Bones that deform meshes, or all if none does; others, such as handles of controls, go along with the "
                "joints next to them",
            ),
            Choice("all", "All", "All bones, those of controls too"),
        ),
        option="--all-bones",
        flag="all",
        help="Fit bones too that deform no mesh; otherwise they go along",
        panel="settings",
    )
    auto_weights: bool = setting(
        False,
        "Automatic Weights",
        "Bind the body to the armature afterwards, with Blender's automatic weights; they replace those of groups that "
        "are named like the bones",
    )
