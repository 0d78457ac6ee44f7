# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests to compute a soft map, or to transfer data along it."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, Settings, setting


@dataclass(frozen=True)
class MapRequest(Settings):
    """Settings of a soft map in addition to those of its solver."""

    use_groups: bool = setting(
        False,
        "Use Equal Groups",
        "Use vertex groups of the same name on both objects to tell points apart",
        option="--groups",
        panel="settings",
    )


@dataclass(frozen=True)
class TransferRequest(Settings):
    """Settings of a transfer along a soft map."""

    direction: str = setting(
        "FORWARD",
        "Direction",
        "Direction of the transfer",
        choices=(
            Choice(
                "FORWARD",
                "Source to Target",
                "Write data of the source to the target; on one object, from left to right",
            ),
            Choice(
                "BACKWARD",
                "Target to Source",
                "Write data of the target to the source; on one object, from right to left",
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
            Choice("REPLACE", "Replace", "Replace data of the same name; keep everything else"),
            Choice("KEEP", "Keep", "Keep existing data, and transfer the rest"),
        ),
        option="--keep",
        flag="KEEP",
        help="keep existing data of the same name, and transfer the rest",
        panel="transfer",
    )
    limit: int = setting(
        4,
        "Limit",
        "Maximum number of deforming groups per vertex, of which the largest weights are kept; 0 for no limit",
        least=0,
        most=1000,
        soft_most=8,
        panel="groups",
    )
    normalize: bool = setting(
        True,
        "Normalize",
        "Scale the weights of deforming groups so that they sum to 1 at every vertex, including those of locked groups",
        panel="groups",
    )
    flip_names: bool = setting(
        False,
        "Flip Names",
        "Write vertex groups and shape keys under the name of the other side, as from Arm.L to Arm.R; the map of an "
        "object to itself always does",
        panel="names",
    )
