# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Invalid values for every argument of every public function: a ValueError names the argument and its condition."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

from convwass_addon import transport
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane
from convwass_addon.transport import (
    Grid,
    Inputs,
    SoftMapSweeps,
    Surface,
    barycenter,
    barycenter_between,
    barycenter_from_neighbor,
    barycentric_coordinates,
    bisect,
    distance,
    distance_matrix,
    from_masses,
    interpolate,
    nearest_barycenter,
    point_distances,
    propagate,
    soft_map,
    soft_map_between,
    soft_map_domain,
    symmetric_soft_map,
    transport_map,
)

GRID = Grid((6, 5), 1.0)
MU = np.ones((6, 5))
MUS = np.ones((3, 6, 5))
ONE_NEGATIVE = MU - 1.5 * (np.arange(30).reshape(6, 5) == 7)
WEIGHTS = [0.2, 0.3, 0.5]
LINE = [[0, 1], [1, 2]]
ENDS = {0: MU, 2: MU}
PREPARED = Inputs.of(MUS, GRID)
SOLVED = barycenter(PREPARED, WEIGHTS, GRID)
ELSEWHERE = barycenter(np.ones((3, 5, 6)), WEIGHTS, Grid((5, 6), 1.0))

SOLID = Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.2]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
COSTS = np.arange(16.0).reshape(4, 4)

# Valid arguments of every function; a case changes one of them.
GOOD = {
    Grid: {"shape": (6, 5), "sigma": 1.0},
    barycenter: {"mus": MUS, "weights": WEIGHTS, "domain": GRID},
    barycenter_from_neighbor: {"neighbor": SOLVED, "weights": WEIGHTS, "inputs": PREPARED, "sharpness": 0.0},
    barycenter_between: {"first": SOLVED, "second": SOLVED, "share": 0.5, "inputs": PREPARED},
    barycentric_coordinates: {"mu": MU, "mus": MUS, "domain": GRID},
    nearest_barycenter: {"mu": MU, "mus": MUS, "domain": GRID},
    distance: {"mu0": MU, "mu1": MU, "domain": GRID},
    distance_matrix: {"mus": MUS, "domain": GRID},
    interpolate: {"mu0": MU, "mu1": MU, "times": [0.5], "domain": GRID},
    from_masses: {"masses": MU, "domain": GRID},
    bisect: {"mu0": MU, "mu1": MU, "domain": GRID},
    propagate: {"edges": LINE, "edge_weights": 1.0, "fixed": ENDS, "domain": GRID},
    transport_map: {"log_scaling": np.zeros((6, 5)), "domain": GRID},
    point_distances: {"sources": 3, "domain": GRID},
    soft_map: {
        "compatibility": COSTS,
        "edges": [[0, 1], [1, 2], [2, 3]],
        "edge_weights": 1.0,
        "source_areas": np.ones(4),
        "domain": SOLID,
    },
    soft_map_between: {"compatibility": COSTS, "source": SOLID, "target": SOLID},
    symmetric_soft_map: {"compatibility": COSTS, "source": SOLID, "target": SOLID},
    soft_map_domain: {"surface": SOLID},
}

DENSITIES = [
    (MU[:5], r"must have the shape \(6, 5\), got \(5, 5\)"),
    (MU[None], r"must have the shape \(6, 5\), got \(1, 6, 5\)"),
    (np.nan * MU, "has values that are not numbers"),
    (np.inf * MU, "has values that are not numbers"),
    (ONE_NEGATIVE, "has negative values; a distribution must not"),
    (0 * MU, "has no mass"),
]
SOLVERS = [barycenter, barycentric_coordinates, nearest_barycenter, distance, distance_matrix, interpolate, bisect]
SOLVERS += [propagate, barycenter_between, barycenter_from_neighbor, soft_map]
SOFT_MAPS = [soft_map, soft_map_between, symmetric_soft_map]
RATHER = {
    "tolerance": [(0.0, "must be positive, got 0.0"), (-1e-3, "must be positive"), (np.nan, "must be positive")],
    "debias_tolerance": [(0.0, "must be positive, got 0.0"), (-1e-3, "must be positive"), (np.nan, "must be positive")],
    "max_iterations": [(0, "must be at least 1, got 0"), (-1, "must be at least 1")],
    "sharpness": [(-0.1, "must lie between 0 and 1, got -0.1"), (1.1, "must lie between"), (np.nan, "must lie")],
    "entropy_limit": [("least", 'must be "max", a number'), (np.nan, "must be"), ([0.0] * 7, "must be")],
}


def cases():
    """Yield function, argument, value, and the message after the argument's name."""
    for solver in SOLVERS:
        for name, wrong in RATHER.items():
            if name in inspect.signature(solver).parameters:
                yield from ((solver, name, value, message) for value, message in wrong)
    for solver, name in (
        (distance, "mu0"),
        (distance, "mu1"),
        (interpolate, "mu0"),
        (interpolate, "mu1"),
        (bisect, "mu0"),
        (bisect, "mu1"),
        (barycentric_coordinates, "mu"),
        (nearest_barycenter, "mu"),
    ):
        yield from ((solver, name, value, message) for value, message in DENSITIES)
    for solver in (barycenter, distance_matrix, barycentric_coordinates, nearest_barycenter):
        yield solver, "mus", MU, r"must have the shape \(k, 6, 5\), got \(6, 5\)"
        yield solver, "mus", MUS[:0], r"must have the shape \(k, 6, 5\), got \(0, 6, 5\)"
        yield solver, "mus", MUS[:, :, :4], r"must have the shape \(k, 6, 5\), got \(3, 6, 4\)"
        for density, message in DENSITIES[2:]:
            yield solver, "mus", np.stack([MU, density, MU]), rf"\[1\] {message}"
    yield barycenter, "weights", [1, 1], r"must be 3 numbers, one per distribution, got shape \(2,\)"
    yield barycenter, "weights", [1, 1, -1], r"must be zero or positive numbers"
    yield barycenter, "weights", [1, 1, np.nan], r"must be zero or positive numbers"
    yield barycenter, "weights", [0, 0, 0], "must not all be zero"
    for solver in (barycenter, barycenter_between, barycenter_from_neighbor):
        yield solver, "numerics", "exact", 'must be "automatic" or "scaling", got \'exact\''
    for wrong in (0.0, -1.0, np.nan, np.inf):
        for solver in (barycenter, barycenter_between, barycenter_from_neighbor):
            yield solver, "reach", wrong, f"must be a positive length, got {wrong}"
    yield barycenter_from_neighbor, "neighbor", ELSEWHERE, "must be a barycenter of these inputs"
    yield barycenter_from_neighbor, "weights", [1, 1], r"must be 3 numbers, one per distribution, got shape \(2,\)"
    for name in ("first", "second"):
        yield barycenter_between, name, ELSEWHERE, "must be a barycenter of these inputs"
    yield barycenter_between, "second", barycenter(PREPARED, [1, 1, 0], GRID), "must give weight to the inputs that"
    for wrong in (-0.1, 1.1, np.nan):
        yield barycenter_between, "share", wrong, f"must lie between 0 and 1, got {wrong}"
    yield barycenter, "tightening", -1, "must be zero or a positive whole number, got -1"
    yield barycenter, "tightening", 1.5, "must be zero or a positive whole number, got 1.5"
    yield barycenter, "initial", ELSEWHERE, r"must be a barycenter on a domain of shape \(6, 5\)"
    yield barycenter, "begun", ELSEWHERE, "must be a barycenter of the coarser levels of these inputs"
    yield nearest_barycenter, "max_evaluations", 0, "must be at least 1, got 0"
    for solver in (interpolate, bisect):
        yield solver, "times", [0.2, 1.01], "must lie between 0 and 1"
        yield solver, "times", [-0.01], "must lie between 0 and 1"
        yield solver, "times", [np.nan], "must lie between 0 and 1"
        yield solver, "times", 0.5, r"must be a list of numbers, got shape \(\)"
        yield solver, "times", [], r"must be a list of numbers, got shape \(0,\)"
        yield solver, "times", [[0.5]], r"must be a list of numbers, got shape \(1, 1\)"
    yield bisect, "levels", 0, "must be a positive whole number, got 0"
    yield bisect, "levels", 1.5, "must be a positive whole number, got 1.5"
    yield propagate, "edges", [[0, 1, 2]], r"must have the shape \(e, 2\), got \(1, 3\)"
    yield propagate, "edges", [[0.5, 1], [1, 2]], "must name vertices by whole numbers"
    yield propagate, "edges", [[0, 1], [1, 1], [1, 2]], "must not run from a vertex to itself, as one at vertex 1 does"
    yield propagate, "edges", [[0, 1], [3, 4], [1, 2]], "must connect every vertex with a fixed one; no path leads to 3"
    yield propagate, "edges", [[0, 1], [1, -2]], "and fixed must name vertices between 0 and"
    yield propagate, "edge_weights", [1.0, 2.0, 3.0], r"must be one number or 2, got shape \(3,\)"
    yield propagate, "edge_weights", [1.0, 0.0], "must be positive numbers"
    yield propagate, "edge_weights", -1.0, "must be positive numbers"
    yield propagate, "edge_weights", np.nan, "must be positive numbers"
    for wrong in (-1.0, np.nan, np.inf):
        yield propagate, "relief", wrong, f"must be zero or a positive number, got {wrong}"
    yield propagate, "fixed", {}, "must hold at least one vertex with its distribution"
    yield propagate, "fixed", {0.5: MU}, "must name vertices by whole numbers"
    for density, message in DENSITIES:
        yield propagate, "fixed", {0: MU, 2: density}, rf"\[2\] {message}"
    yield propagate, "initial", propagate([[0, 1]], 1.0, {0: MU}, GRID), "must be a solution for the same graph"
    yield propagate, "initial", propagate(LINE, 1.0, {0: MU.T, 2: MU.T}, Grid((5, 6), 1.0)), "must be a solution for"
    yield from_masses, "masses", MU.T, r"must have the shape \(k, 6, 5\), got \(5, 6\)"
    yield from_masses, "masses", MU[None, None], r"must have the shape \(k, 6, 5\), got \(1, 1, 6, 5\)"
    for wrong in (np.nan * MU, ONE_NEGATIVE):
        yield from_masses, "masses", wrong, "must be zero or positive numbers"
    yield transport_map, "log_scaling", np.zeros((5, 6)), r"must have the shape \(6, 5\), got \(5, 6\)"
    yield transport_map, "log_scaling", np.full((6, 5), np.nan), "must be finite numbers"
    yield transport_map, "log_scaling", np.full((6, 5), -np.inf), "must be finite numbers"
    yield transport_map, "values", MU, r"must have the shape \(6, 5, 'd'\), got \(6, 5\)"
    yield transport_map, "values", np.zeros((5, 6, 2)), "must have the shape"
    yield transport_map, "values", np.full((6, 5, 2), np.nan), "must be finite numbers"
    yield point_distances, "sources", -1, "must lie between 0 and 29"
    yield point_distances, "sources", [0, 30], "must lie between 0 and 29"
    yield point_distances, "sources", 1.5, "must be one index or a list of them"
    yield point_distances, "sources", [], "must be one index or a list of them"
    for solver in SOFT_MAPS:
        yield solver, "compatibility", COSTS[:3], r"must have the shape \(4, 4\), got \(3, 4\)"
        yield solver, "compatibility", np.nan * COSTS, "has values that are not numbers"
        yield solver, "pairs", [0, 1], r"must hold two vertices each, \(k, 2\)"
        yield solver, "pairs", [[4, 0]], "must name vertices of the source between 0 and 3"
        yield solver, "pairs", [[0, -1]], "must name vertices of the target between 0 and 3"
    yield soft_map, "edges", [[0, 1, 2]], r"must be pairs of vertices, \(e, 2\)"
    yield soft_map, "edges", [[0, 4]], "must name vertices between 0 and 3"
    yield soft_map, "edges", [[1, 1]], "must not run from a vertex to itself"
    yield soft_map, "edge_weights", [1.0, 2.0], r"must be one number or 3, got shape \(2,\)"
    yield soft_map, "edge_weights", 0.0, "must be positive numbers"
    yield soft_map, "source_areas", np.zeros(4), "must be one number for each vertex, not negative, and not all zero"
    yield soft_map, "fixed", {4: np.ones(4)}, "must name vertices of the source between 0 and 3"
    yield soft_map, "fixed", {0: -np.ones(4)}, r"\[0\] has negative values"
    yield soft_map, "tau", -1.0, "must be zero or a positive number, got -1.0"
    yield soft_map, "sweeps", 0, "must be at least 1, got 0"
    for solver in (soft_map_between, symmetric_soft_map):
        yield solver, "sweeps", SoftMapSweeps(fine=0), "must be at least 1, got 0"
    yield soft_map_between, "mirrors", (MirrorPlane(np.zeros(3), np.eye(3)[0]),), "must be the two planes .* got 1"
    yield soft_map, "initial", np.ones((2, 4)), r"must have the shape \(4, 4\), got \(2, 4\)"
    yield soft_map, "initial", np.zeros((4, 4)), "must hold densities"
    for wrong in (-0.1, 1.0, np.nan):
        yield symmetric_soft_map, "agreement", wrong, f"must be at least 0 and below 1, got {wrong}"
    for wrong in (0.0, -1.0, np.inf):
        yield soft_map_domain, "gamma_scale", wrong, f"must be a positive number, got {wrong}"
    yield Grid, "shape", (), "must be one to three positive whole numbers of cells"
    yield Grid, "shape", (2, 2, 2, 2), "must be one to three positive whole numbers of cells"
    yield Grid, "shape", (6, 0), "must be one to three positive whole numbers of cells"
    yield Grid, "shape", (6, -5), "must be one to three positive whole numbers of cells"
    yield Grid, "shape", (6, 5.5), "must be one to three positive whole numbers of cells"
    yield Grid, "sigma", 0.0, "must be a positive number of cells, got 0.0"
    yield Grid, "sigma", -2.0, "must be a positive number of cells"
    yield Grid, "sigma", np.nan, "must be a positive number of cells"
    yield Grid, "sigma", np.inf, "must be a positive number of cells"
    yield Grid, "boundary", "closed", 'must be "open" or "reflecting", got \'closed\''


CASES = list(cases())


@pytest.mark.parametrize(
    ("function", "argument", "value", "message"),
    CASES,
    ids=[f"{function.__name__}-{argument}-{i}" for i, (function, argument, *_) in enumerate(CASES)],
)
def test_the_message_names_the_argument(function, argument, value, message):
    assert argument in inspect.signature(function).parameters
    with pytest.raises(ValueError, match=rf"^{argument}(\[\d\])? ?{message}"):
        function(**{**GOOD[function], argument: value})


@pytest.mark.parametrize("function", GOOD, ids=lambda f: f.__name__)
def test_valid_arguments_are_accepted(function):
    function(**GOOD[function])


def test_no_argument_was_forgotten():
    """All except domains and callbacks, and flags, which accept any value."""
    unchecked = {"domain", "inputs", "control", "debias", "size", "source", "target", "surface"}
    tried = {(function, argument) for function, argument, *_ in CASES}
    for function in GOOD:
        for argument in set(inspect.signature(function).parameters) - unchecked:
            assert (function, argument) in tried, f"{function.__name__}: {argument}"
    callables = {getattr(transport, name) for name in transport.__all__}
    functions = {f for f in callables if inspect.isfunction(f)}
    # The generator behind bisect has the same arguments and is only started by the first report.
    assert functions - {transport.bisection} | {Grid} == set(GOOD)
    assert inspect.signature(transport.bisection).parameters == inspect.signature(bisect).parameters


def test_invalid_arguments_are_refused_even_if_nothing_is_solved():
    """The ends of an interpolation need no solve, and neither does a graph without free vertices."""
    for wrong in ({"tolerance": 0.0}, {"max_iterations": 0}, {"sharpness": 2.0}, {"entropy_limit": "least"}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            interpolate(MU, MU, [0.0, 1.0], GRID, **wrong)
    with pytest.raises(ValueError, match="tolerance"):
        propagate([[0, 1]], 1.0, {0: MU, 1: MU}, GRID, tolerance=0.0)


@pytest.mark.parametrize("size", [0, 1, 2])
def test_the_size_of_a_graph_must_include_its_vertices(size):
    with pytest.raises(ValueError, match=f"^edges and fixed must name vertices between 0 and {size - 1}"):
        propagate(LINE, 1.0, ENDS, GRID, size=size)
    with pytest.raises(ValueError, match="no path leads to 3"):
        propagate(LINE, 1.0, ENDS, GRID, size=4)


@pytest.mark.parametrize("columns", [np.ones((5, 6)), np.ones((2, 30)), np.ones(30), np.ones((6, 10))])
def test_the_kernel_refuses_columns_of_another_shape(columns):
    with pytest.raises(ValueError, match=r"^columns must have the shape \(k, 6, 5\), got "):
        GRID.apply(columns)
