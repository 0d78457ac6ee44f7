# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for computing the soft map between two meshes."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Settings, setting


@dataclass(frozen=True)
class SoftMapSettings(Settings):
    """Settings for computing the soft map between two meshes."""

    vertices: int = setting(
        1000,
        "Vertices",
        "The map is solved on meshes of about this many vertices, and then extended to all vertices",
        least=50,
        most=4000,
        soft_least=200,
        soft_most=2000,
        note="Meshes with fewer vertices are used directly",
        panel="settings",
    )
    tau: float = setting(
        30.0,
        "Tau",
        "Weight of the similarity of points relative to the smoothness of the map",
        least=0.0,
        most=1e6,
        soft_most=100.0,
        panel="settings",
    )
    sharpness: float = setting(
        1.0,
        "Sharpness",
        "How much of the blur is removed from the map; 0 is the map as published",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        panel="settings",
    )
    sweeps: int = setting(
        5,
        "Sweeps",
        "Largest number of times that the image of every vertex is updated",
        least=1,
        most=1000,
        soft_most=50,
        note="Sweeps on coarser meshes come before these; more sweeps mainly make the map sharper",
        panel="settings",
    )
    symmetric: bool = setting(
        False,
        "Both Ways",
        "Solve both directions together, so that they agree; takes twice as long",
        panel="settings",
    )
    group_weight: float = setting(
        1.0,
        "Weight of Groups",
        "Weight of painted groups relative to everything else that distinguishes points",
        least=0.0,
        most=100.0,
        soft_most=10.0,
        note="Groups with equal names are compared; 0 ignores them",
    )
    gamma_scale: float = setting(
        1.7,
        "Blur",
        "Entropic regularization in squared mean edge lengths of the coarser target",
        least=0.1,
        most=100.0,
        prop=None,
        option=None,
    )
