# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Validate skeletons, and suggest what to pin if they cannot be fitted."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.arrays.components import component_labels
from ...sentence import first_names
from .skeleton_graph import JointGraph
from .skeleton_links import chains

# Pins within this distance, relative to the diagonal of their bounding box, coincide.
_SAME_PLACE = 1e-4


def check_pins(graph: JointGraph) -> None:
    """Refuse skeletons whose pins are insufficient or contradictory.

    Raises
    ------
    InputError
        No bones; components with no pin or only one; coincident pins.
    """
    if not len(graph.edges):
        raise InputError("The skeleton has no bones.")
    if not graph.pinned.any():
        raise InputError("No joint is pinned; pin the ends of the limbs where they belong.")
    labels = skeleton_parts(graph)
    for label in range(labels.max() + 1):
        own = np.flatnonzero(labels == label)
        pins = own[graph.pinned[own]]
        if not len(pins):
            raise InputError(
                "No joint is pinned in the part of the skeleton with {names}; pin the ends of its limbs.",
                names=named(graph, own),
            )
        if len(pins) == 1 and len(own) > 1:
            raise InputError(
                "Only {name} is pinned in its part of the skeleton; pin the ends of the other limbs, such as {names}.",
                name=graph.names[pins[0]],
                names=named(graph, _ends(graph, own)),
            )
    _check_places(graph)


def check_loops(graph: JointGraph) -> None:
    """Refuse loops with two equivalent sides, both of which would be laid out through the hole between them.

    Parameters
    ----------
    graph : JointGraph
        The skeleton without loose limbs.

    Raises
    ------
    InputError
        Two paths between the same two joints, or a path back to its start, without a pin or branch.
    """
    found = {}
    for chain in chains(graph):
        ends = tuple(sorted((int(chain[0]), int(chain[-1]))))
        if ends[0] == ends[1] or (ends in found and max(len(chain), len(found[ends])) > 2):
            loop = np.unique(np.concatenate([chain, found.get(ends, chain)]))
            raise InputError(
                "The sides of the loop with {names} cannot be distinguished; pin three of its joints, evenly spread.",
                names=named(graph, loop),
            )
        found[ends] = chain


def check_inside(graph: JointGraph, outside: NDArray[np.int64], places: NDArray[np.float64]) -> None:
    """Refuse pins outside the body.

    Parameters
    ----------
    graph : JointGraph
        The skeleton.
    outside : (k,) int64
        Pins outside the body.
    places : (k, 3)
        The nearest points inside.

    Raises
    ------
    InputError
        There are such pins; the message suggests a position for the first one.
    """
    if not len(outside):
        return
    x, y, z = places[0]
    raise InputError(
        "Pins outside the body: {names}. Move them inside ({name} to {x:.4g}, {y:.4g}, {z:.4g}), or set Pins Outside "
        "to Move Inside (--move-pins).",
        names=named(graph, outside),
        name=graph.names[outside[0]],
        x=x,
        y=y,
        z=z,
    )


def skeleton_parts(graph: JointGraph) -> NDArray[np.int64]:
    """Label the joints by connected component, (v,)."""
    return component_labels(*graph.edges.T, len(graph.positions))


def named(graph: JointGraph, joints: NDArray[np.int64]) -> str:
    """Names of joints, abbreviated if there are many."""
    return first_names([graph.names[joint] for joint in joints])


def _ends(graph: JointGraph, joints: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the free joints with only one bone, or all free joints if there are none."""
    free = joints[~graph.pinned[joints]]
    tips = np.array([joint for joint in free if len(graph.neighbors[joint]) == 1], np.int64)
    return tips if len(tips) else free


def _check_places(graph: JointGraph) -> None:
    pins = np.flatnonzero(graph.pinned)
    points = graph.positions[pins]
    near = _SAME_PLACE * float(np.linalg.norm(np.ptp(points, axis=0)))
    for first, second in combinations(range(len(pins)), 2):
        if np.linalg.norm(points[first] - points[second]) <= near:
            raise InputError(
                "{first} and {second} are pinned in the same place; move or unpin one of them.",
                first=graph.names[pins[first]],
                second=graph.names[pins[second]],
            )
