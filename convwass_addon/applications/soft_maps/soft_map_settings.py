# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the soft map from one mesh to another is computed."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Settings, setting


@dataclass(frozen=True)
class SoftMapSettings(Settings):
    """How the soft map from one mesh to another is computed."""

    vertices: int = setting(
        1000,
        "Vertices",
        "The map is solved on meshes of about so many vertices, and then taken to all of them",
        least=50,
        most=4000,
        soft_least=200,
        soft_most=2000,
        note="Meshes with fewer are taken as they are",
        panel="settings",
    )
    tau: float = setting(
        30.0,
        "Tau",
        "How much what points look like counts against smoothness of the map",
        least=0.0,
        most=1e6,
        soft_most=100.0,
        panel="settings",
    )
    sharpness: float = setting(
        1.0,
        "Sharpness",
        "How much of the blur is taken out of the map; 0 is the map as published",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        panel="settings",
    )
    sweeps: int = setting(
        5,
        "Sweeps",
        "Most times that the image of every vertex is made anew",
        least=1,
        most=1000,
        soft_most=50,
        note="Some on coarser meshes come before; more only make the map sharper",
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
        "How much painted groups count against all else that tells points apart",
        least=0.0,
        most=100.0,
        soft_most=10.0,
        note="Groups of equal names count; 0 leaves them out",
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
