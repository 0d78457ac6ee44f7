# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wasserstein propagation on a graph of densities on a surface: some nodes are painted, the rest is filled in.

Solomon et al. 2015, section 6.2 and Algorithm 4.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.arrays.components import component_labels
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence, first_names
from ...transport import Surface
from ...transport.propagation import propagation
from .density_frames import DensityFrames, record, require_reachable_limit
from .density_memory import check_frames_memory
from .density_pieces import on_same_pieces
from .density_preparing import preparing_levels
from .density_settings import DensitySettings
from .density_solving import solving
from .surface_densities import distribution


def propagation_steps(
    edges: ArrayLike,
    fixed: Mapping[int, ArrayLike],
    surface: Surface,
    settings: DensitySettings,
    names: Sequence[str] | None = None,
    edge_weights: ArrayLike | float = 1.0,
    control: Control = UNINTERRUPTED,
) -> Work[DensityFrames]:
    """Fill in the densities at the nodes of a graph so that adjacent ones are as close to each other as possible.

    Parameters
    ----------
    edges : (e, 2) int
        Pairs of adjacent nodes, by index from 0.
    fixed : mapping from place to (n,)
        Painted weights, or densities, of the known nodes.
    surface : Surface
        The surface of the densities, with its kernel.
    settings : DensitySettings
        Only bound, tolerance and iterations are used here.
    names : sequence of str, optional
        Names of all nodes for messages; by default their indices.
    edge_weights : float or (e,)
        Positive weights of the edges: the larger, the closer their ends.
    control : Control
        Stops the job when cancelled.

    Yields
    ------
    Progress
        After every sweep.

    Returns
    -------
    DensityFrames
        One frame per node; the times are the indices of the nodes.

    Raises
    ------
    InputError, ResourceError
        Before the work starts: an invalid graph, nodes without a path to a known one, invalid densities, or densities
        on different components.
    """
    pairs = _pairs(edges)
    size = int(max(pairs.max(initial=-1), max(fixed, default=-1))) + 1
    known = [str(place) for place in range(size)] if names is None else list(names)
    size = max(size, len(known))
    _check_graph(pairs, fixed, known, size)
    shares = _edge_weights(edge_weights, len(pairs))
    places = sorted(fixed)
    given_names = [known[place] for place in places]
    require_reachable_limit(surface, settings)
    given = np.stack([distribution(fixed[place], surface, known[place]) for place in places])
    given = on_same_pieces(given, given_names, surface, settings.pieces == "match")
    check_frames_memory(surface, size, len(pairs))
    yield from preparing_levels(surface)
    filled = size - len(places)
    message = Sentence("Filling in {count} of {total} places", {"count": filled, "total": size})
    yield Progress(0.0, message)
    work = propagation(
        pairs,
        shares,
        dict(zip(places, given, strict=True)),
        surface,
        size=size,
        entropy_limit="max" if settings.entropy_limit == "between" else settings.entropy_limit,
        tolerance=settings.tolerance,
        max_iterations=settings.max_iterations,
        control=control,
    )
    solved = yield from within(solving(work, surface, given_names), 0.0, 1.0, message)
    records = []
    for place in range(size):
        if place in fixed:
            records.append(record(place, solved.entropies[place], known[place]))
            continue
        figures = solved.marginal_errors[place], solved.converged[place], solved.iterations, solved.numerics
        records.append(record(place, solved.entropies[place], None, *figures))
    return DensityFrames(np.arange(float(size)), solved.densities, records, surface)


def _pairs(edges: ArrayLike) -> NDArray[np.int64]:
    pairs = np.asarray(edges)
    if not pairs.size:
        return np.empty((0, 2), np.int64)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or pairs.dtype.kind not in "iu":
        raise InputError("Edges must be pairs of the numbers of places.")
    return pairs.astype(np.int64)


def _check_graph(pairs: NDArray[np.int64], fixed: Mapping[int, ArrayLike], names: Sequence[str], size: int) -> None:
    if not fixed:
        raise InputError("No place of the graph is known; paint at least one of them.")
    if min(pairs.min(initial=0), *fixed) < 0 or size > len(names):
        raise InputError(
            "Edges and painted places must be numbers from 0 to {last}, as there are {count} places.",
            last=len(names) - 1,
            count=len(names),
        )
    loops = pairs[pairs[:, 0] == pairs[:, 1], 0]
    if len(loops):
        raise InputError("An edge runs from {name} to itself; leave it out.", name=names[loops[0]])
    labels = component_labels(*pairs.T, size)
    lost = np.flatnonzero(~np.isin(labels, labels[list(fixed)]))
    if len(lost):
        raise InputError(
            "No edges lead from a painted place to {names}; add an edge, or paint there.",
            names=first_names([names[place] for place in lost]),
        )


def _edge_weights(edge_weights: ArrayLike | float, count: int) -> NDArray[np.float64]:
    weights = np.asarray(edge_weights, dtype=np.float64)
    if weights.shape not in ((), (count,)):
        raise InputError("There are {edges} edges and {weights} weights.", edges=count, weights=weights.size)
    if not (np.isfinite(weights).all() and (weights > 0).all()):
        raise InputError("The weights of edges must be positive numbers.")
    return np.broadcast_to(weights, (count,))
