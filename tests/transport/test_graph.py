# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.transport.graph import PropagationGraph, line


def graph(edges, fixed, weights=1.0, size=None):
    return PropagationGraph.from_edges(edges, weights, fixed, size)


def reached_from(vertex, pairs, blocked):
    """Vertices reachable by paths without blocked vertices."""
    found, waiting = {vertex}, [vertex]
    while waiting:
        here = waiting.pop()
        for pair in pairs:
            if here in pair:
                there = pair[0] if pair[1] == here else pair[1]
                if there not in found and there not in blocked:
                    found.add(there)
                    waiting.append(there)
    return found


@st.composite
def graphs(draw):
    """Connected multigraphs with some fixed vertices: a random tree plus edges, some of them duplicates."""
    size = draw(st.integers(2, 14))
    tree = [(draw(st.integers(0, v - 1)), v) for v in range(1, size)]
    vertex = st.integers(0, size - 1)
    more = draw(st.lists(st.tuples(vertex, vertex).filter(lambda e: e[0] != e[1]), max_size=20))
    pairs = draw(st.permutations(tree + more))
    fixed = draw(st.sets(vertex, min_size=1, max_size=size))
    weights = draw(st.lists(st.floats(0.1, 10.0), min_size=len(pairs), max_size=len(pairs)))
    return pairs, fixed, weights, size


@settings(max_examples=150, deadline=None, derandomize=True)
@given(graphs())
def test_ends_parts_and_colors_of_any_graph(drawn):
    pairs, fixed, weights, size = drawn
    made = graph(pairs, fixed, weights, size)
    kept = [(p, w) for p, w in zip(pairs, weights, strict=True) if not set(p) <= fixed]

    # Two ends per edge, in the given order.
    assert [tuple(e) for e in made.vertex_of_end.reshape(-1, 2)] == [p for p, _ in kept]
    np.testing.assert_array_equal(made.weight_of_end, np.repeat([w for _, w in kept], 2))
    assert sorted(np.concatenate(made.ends_at).tolist()) == list(range(2 * len(kept)))
    for vertex, ends in enumerate(made.ends_at):
        assert (made.vertex_of_end[ends] == vertex).all()
    assert set(np.flatnonzero(made.fixed).tolist()) == fixed

    # Neighbors have different colors, every vertex has exactly one, and the fixed vertices have the first.
    color = np.full(size, -1)
    for number, vertices in enumerate(made.colors):
        assert (color[vertices] == -1).all()
        color[vertices] = number
    assert (color >= 0).all()
    assert all(color[a] != color[b] for (a, b), _ in kept)
    assert set(made.colors[0].tolist()) == fixed
    degree = np.bincount(made.vertex_of_end, minlength=size)
    assert len(made.colors) <= degree.max() + 2

    # Parts are the connected components without the fixed vertices.
    for vertex in range(size):
        if vertex in fixed:
            assert made.parts[vertex] == -1
        else:
            same = reached_from(vertex, pairs, fixed)
            assert {v for v in range(size) if made.parts[v] == made.parts[vertex]} == same
    free = sorted(set(made.parts[~made.fixed].tolist()))
    assert free == list(range(len(free)))
    for end in range(2 * len(kept)):
        here, there = (int(made.parts[made.vertex_of_end[e]]) for e in (end, end ^ 1))
        assert made.part_of_end[end] == max(here, there)
        assert -1 in (here, there) or here == there


def test_edges_between_fixed_vertices_are_left_out():
    made = graph([[0, 1], [1, 2], [0, 2], [2, 3]], {0, 1, 3}, [1.0, 2.0, 3.0, 4.0])
    np.testing.assert_array_equal(made.vertex_of_end, [1, 2, 0, 2, 2, 3])
    np.testing.assert_array_equal(made.weight_of_end, [2, 2, 3, 3, 4, 4])


def test_a_line_has_two_colors_of_free_vertices():
    made = graph(line(9), {0, 8})
    np.testing.assert_array_equal(line(4), [[0, 1], [1, 2], [2, 3]])
    assert line(1).shape == (0, 2)
    assert len(made.colors) == 3
    assert set(made.parts.tolist()) == {-1, 0}


def test_vertices_without_edges_need_a_distribution():
    made = graph(np.empty((0, 2), int), {0, 1}, size=2)
    assert made.vertex_of_end.shape == (0,)
    assert len(made.colors) == 1
    assert graph([], {0}).size == 1


@pytest.mark.parametrize(
    ("edges", "fixed", "weights", "size", "named"),
    [
        ([[0, 1, 2]], {0}, 1.0, None, r"edges must have the shape \(e, 2\), got \(1, 3\)"),
        ([0, 1], {0}, 1.0, None, r"edges must have the shape \(e, 2\), got \(2,\)"),
        ([[0.0, 1.5]], {0}, 1.0, None, "edges must name vertices by whole numbers"),
        ([["a", "b"]], {0}, 1.0, None, "edges must name vertices by whole numbers"),
        ([[0, 1], [2, 2]], {0, 2}, 1.0, None, "edges must not run from a vertex to itself, as one at vertex 2"),
        ([[0, -1]], {0}, 1.0, None, "edges and fixed must name vertices between"),
        ([[0, 5]], {0}, 1.0, 3, "edges and fixed must name vertices between 0 and 2"),
        ([[0, 1]], {7}, 1.0, 3, "edges and fixed must name vertices between 0 and 2"),
        ([[0, 1]], {-1}, 1.0, None, "edges and fixed must name vertices between"),
        ([[0, 1]], {0.5}, 1.0, None, "fixed must name vertices by whole numbers"),
        ([[0, 1]], set(), 1.0, None, "fixed must hold at least one vertex"),
        ([[0, 1], [2, 3], [3, 4]], {0}, 1.0, None, "connect every vertex with a fixed one; no path leads to 2, 3, 4"),
        ([[0, 1]], {0}, 1.0, 9, r"no path leads to 2, 3, 4, 5, 6, \.\.\."),
        ([[0, 1], [1, 2]], {0}, [1.0], None, "edge_weights must be one number or 2"),
        ([[0, 1]], {0}, [[1.0]], None, "edge_weights must be one number or 1"),
        ([[0, 1]], {0}, 0.0, None, "edge_weights must be positive numbers"),
        ([[0, 1]], {0}, [-1.0], None, "edge_weights must be positive numbers"),
        ([[0, 1]], {0}, np.nan, None, "edge_weights must be positive numbers"),
        ([[0, 1]], {0}, np.inf, None, "edge_weights must be positive numbers"),
    ],
)
def test_invalid_graphs_are_refused(edges, fixed, weights, size, named):
    with pytest.raises(ValueError, match=named):
        graph(edges, fixed, weights, size)
