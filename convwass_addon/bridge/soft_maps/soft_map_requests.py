# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is asked of Blender when a map is computed, or something is transferred by it."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class MapRequest(Settings):
    """What a soft map is asked for besides the settings of its solver."""

    use_groups: bool = setting(
        False,
        "Use Equal Groups",
        "Let painted vertex groups of the same name on both objects tell points apart",
        option="--groups",
        panel="settings",
    )


@dataclass(frozen=True)
class TransferRequest(Settings):
    """How a transfer by a soft map is done."""

    direction: str = setting(
        "FORWARD",
        "Direction",
        "Which way along the map",
        choices=(
            Choice(
                "FORWARD",
                "Source to Target",
                "The target gets what the source has; on one object what is left goes right",
            ),
            Choice(
                "BACKWARD",
                "Target to Source",
                "The source gets what the target has; on one object what is right goes left",
            ),
        ),
        option="--reverse",
        flag="BACKWARD",
        panel="transfer",
    )
    existing: str = setting(
        "REPLACE",
        "Existing",
        "What to do with groups, keys and others that the receiving object has already; locked vertex groups and "
        "locked shape keys always stay",
        choices=(
            Choice("REPLACE", "Replace", "Write what is transferred over those of the same name; others stay"),
            Choice("KEEP", "Keep", "Leave what is there, and transfer the rest"),
        ),
        option="--keep",
        flag="KEEP",
        help="Leave what is there under the same name, and transfer the rest",
        panel="transfer",
    )
    limit: int = setting(
        4,
        "Limit",
        "Most deforming groups of a vertex: of more the largest weights stay; 0 for all of them",
        least=0,
        most=1000,
        soft_most=8,
        panel="groups",
    )
    normalize: bool = setting(
        True,
        "Normalize",
        "Let the weights of deforming groups add up to 1 at every vertex, with those of locked groups",
        panel="groups",
    )
    flip_names: bool = setting(
        False,
        "Flip Names",
        "Write vertex groups and shape keys under the name of the other side, as from Arm.L to Arm.R; the map of an "
        "object to itself always does",
        panel="names",
    )
