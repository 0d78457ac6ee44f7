# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages about how well meshes with shape keys arrive at their shapes."""

from __future__ import annotations

from collections.abc import Sequence

from ...applications.one_mesh.key_paths import KeyPath
from ...applications.one_mesh.swapped_meshes import SwappedMeshes
from ...sentence import Sentence

# Smaller shares of a shape that the mesh misses are not told.
_LITTLE = 0.01


def key_summary(name: str, paths: Sequence[KeyPath]) -> Sentence:
    """Return how well the mesh of an object arrives at the other shapes."""
    count, distance = sum(len(path.times) for path in paths), max(path.surface_95 for path in paths)
    if count == 1:
        return Sentence(
            "{name}: one shape key; 95 % of the mesh ends within {distance:.2%} of the other shape",
            {"name": name, "distance": distance},
        )
    return Sentence(
        "{name}: {count} shape keys; 95 % of the mesh ends within {distance:.2%} of the other shape",
        {"name": name, "count": count, "distance": distance},
    )


def swap_summary(first: str, second: str, found: SwappedMeshes) -> Sentence:
    """Return how well the meshes of two objects, the second of which replaces the first, fit each other."""
    return Sentence(
        "{second} replaces {first} at {time:.2f}; 98 % of both are within {gap:.2%} of the morph there",
        {"first": first, "second": second, "time": found.time, "gap": found.gap},
    )


def poor_notices(paths: Sequence[KeyPath]) -> list[Sentence]:
    """Return notices for the other shapes at which vertices do not arrive, or remain folded, or that are missed."""
    poor = [
        Sentence(
            "{count} vertices are folded or do not arrive at {name}; an attribute marks them: add guides there",
            {"count": len(path.poor), "name": path.name},
        )
        for path in paths
        if len(path.poor)
    ]
    return [*poor, *(notice for path in paths for notice in _missed_notices(path))]


def _missed_notices(path: KeyPath) -> list[Sentence]:
    """Return why parts of a shape are missed, each reason for its share of the surface."""
    beyond = path.beyond if path.beyond > _LITTLE else 0.0
    told = []
    if path.missed - beyond > _LITTLE:
        told.append(
            Sentence(
                "{share:.0%} of the surface of {name} is missed: the mesh has too few vertices there; "
                "choose another Basis, or subdivide it",
                {"share": path.missed - beyond, "name": path.name},
            )
        )
    if beyond > 0.0:
        told.append(
            Sentence(
                "{share:.0%} of the surface of {name} is missed: no part of the mesh takes its form; add guides, "
                "or set Two Meshes",
                {"share": beyond, "name": path.name},
            )
        )
    return told
