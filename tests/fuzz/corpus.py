# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and flat shapes with all known kinds of defects from modeling and importing."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.flat_shapes import ellipse, star
from tests.shapes import ball, box, joined, square, torus, with_faces


def broken_meshes() -> dict[str, Callable[[], tuple[np.ndarray, np.ndarray]]]:
    """Return functions that make vertices and triangles of broken meshes, which may be refused."""
    return {**_SIZES, **_SURFACES}


def _of(mesh: TriangleMesh) -> tuple[np.ndarray, np.ndarray]:
    return mesh.vertices.copy(), mesh.faces.copy()


def _scaled(factor: float, offset: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = _of(ball(points=80))
    return vertices * factor + offset, faces


def _with(value: float) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = _of(ball(points=80))
    vertices[3, 1] = value
    return vertices, faces


def _fan() -> tuple[np.ndarray, np.ndarray]:
    """Many triangles at one edge."""
    angles = np.linspace(0, 2 * np.pi, 9)[:-1]
    rim = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    return np.concatenate([[(0, 0, -1), (0, 0, 1)], rim]), np.array([(0, 1, 2 + k) for k in range(8)])


def _moebius() -> tuple[np.ndarray, np.ndarray]:
    count = 24
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    ends = [
        np.stack(
            [
                (2 + s * np.cos(turns / 2)) * np.cos(turns),
                (2 + s * np.cos(turns / 2)) * np.sin(turns),
                s * np.sin(turns / 2),
            ],
            1,
        )
        for s in (-0.5, 0.5)
    ]
    faces = []
    for k in range(count):
        a, b = k, k + count
        c, d = (k + 1, k + 1 + count) if k + 1 < count else (count, 0)
        faces += [(a, b, c), (b, d, c)]
    return np.concatenate(ends), np.array(faces)


def _mixed() -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = _of(ball(points=120))
    faces[::2] = faces[::2, ::-1]
    return vertices, faces


def _soup() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    return rng.normal(size=(90, 3)), np.arange(90).reshape(30, 3)


def _scrambled() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    return rng.normal(size=(40, 3)), rng.integers(0, 40, (120, 3))


def _split() -> tuple[np.ndarray, np.ndarray]:
    """Every triangle has its own vertices."""
    mesh = ball(points=100)
    return mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3)


def _crowd() -> tuple[np.ndarray, np.ndarray]:
    """Two thousand tetrahedra."""
    rng = np.random.default_rng(2)
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]) * 0.03
    faces = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
    places = rng.uniform(-1, 1, (2000, 1, 3))
    return (places + corners).reshape(-1, 3), (np.arange(2000)[:, None, None] * 4 + faces).reshape(-1, 3)


def _repeated() -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = _of(ball(points=60))
    return vertices, np.concatenate([faces, faces[:, [0, 0, 1]], faces[:, [2, 2, 2]], faces[:5]])


def _loose() -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = _of(ball(points=60))
    return np.concatenate([vertices, [(9, 9, 9), (-50, 0, 0), (1e20, 0, 0)]]), faces


def _flattened(*scale: float) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = _of(ball(points=80))
    return vertices * scale, faces


_NO_FACES = np.empty((0, 3), int)
_SIZES = {
    "nothing": lambda: (np.empty((0, 3)), _NO_FACES),
    "points": lambda: (np.eye(3), _NO_FACES),
    "one triangle": lambda: (np.eye(3), np.array([(0, 1, 2)])),
    "one point thrice": lambda: (np.ones((3, 3)), np.array([(0, 1, 2)])),
    "one vertex thrice": lambda: (np.eye(3), np.array([(0, 0, 0)])),
    "needle": lambda: (np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0)]), np.array([(0, 1, 2)])),
    "NaN": lambda: _with(np.nan),
    "infinite": lambda: _with(np.inf),
    "spike": lambda: _with(1e7),
    "huge": lambda: _scaled(1e30),
    "largest": lambda: _scaled(3e38),
    "beyond": lambda: _scaled(1e200),
    "tiny": lambda: _scaled(1e-30),
    "least": lambda: _scaled(1e-44),
    "below": lambda: _scaled(1e-200),
    "far": lambda: _scaled(1.0, 1e7),
    "so far that it has no size": lambda: _scaled(1.0, 1e17),
    "flat": lambda: _flattened(1, 1, 0),
    "line": lambda: _flattened(1, 0, 0),
    "almost flat": lambda: _flattened(1, 1, 1e-12),
    "thread": lambda: _flattened(1, 1e-9, 1e-9),
    "point": lambda: _flattened(0, 0, 0),
}
_SURFACES = {
    "crowd": _crowd,
    "repeated": _repeated,
    "loose": _loose,
    "split": _split,
    "soup": _soup,
    "scrambled": _scrambled,
    "fan": _fan,
    "moebius": _moebius,
    "mixed": _mixed,
    "inside out": lambda: _of(ball(points=80).flipped()),
    "doubled": lambda: _of(joined(ball(points=80), ball(points=80))),
    "cancelled": lambda: _of(joined(ball(points=80), ball(points=80).flipped())),
    "nested": lambda: _of(joined(ball(points=80), ball(0.5, points=80).flipped())),
    "crossing": lambda: _of(joined(ball(points=80), box((3, 0.3, 0.3)))),
    "sheet": lambda: _of(square()),
    "half": lambda: _of(with_faces(ball(points=200), slice(0, 200))),
    "ring": lambda: _of(torus(segments=(8, 4))),
    "touching": lambda: _of(joined(box(), box(center=(1, 1, 1)))),
    "apart": lambda: _of(joined(ball(points=60), ball(1e-4, (1000, 0, 0), points=60))),
    "spike on a ball": lambda: _of(joined(ball(points=60), box((1e-5, 1e-5, 50)))),
}


def broken_rings() -> Iterator[tuple[str, list[np.ndarray]]]:
    """Yield names and rings of broken flat shapes, which may be refused."""
    good = ellipse(corners=16)
    yield "none", []
    yield "star", [star()]
    yield "line", [np.array([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)])]
    yield "point", [np.zeros((4, 2))]
    yield "two corners", [np.eye(2)]
    yield "NaN", [np.array([(0.0, 0.0), (np.nan, 0.0), (0.0, 1.0)])]
    yield "cancelled", [good, good[::-1]]
    yield "doubled", [good, good]
    yield "bow", [np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])]
    yield "repeated corners", [np.repeat(good, 3, axis=0)]
    yield "spike", [np.array([(0.0, 0.0), (1.0, 0.0), (1e6, 1e-3), (1.0, 1.0), (0.0, 1.0)])]
    yield "scribble", [np.random.default_rng(3).normal(size=(200, 2))]
    yield "many", [ellipse(center, (0.03, 0.03), 8) for center in np.random.default_rng(4).uniform(size=(300, 2))]
    for name, factor, offset in (("huge", 1e30, 0), ("beyond", 1e200, 0), ("tiny", 1e-30, 0), ("below", 1e-200, 0)):
        yield name, [good * factor + offset]
    yield "far", [good + 1e7]
    yield "so far that it has no size", [good + 1e17]
    yield "almost flat", [good * (1.0, 1e-12)]


def broken_images() -> Iterator[tuple[str, np.ndarray]]:
    """Yield names and pixels, (height, width, 4), of images."""
    rng = np.random.default_rng(5)
    good = rng.random((12, 10, 4))
    yield "one pixel", np.ones((1, 1, 4))
    yield "nothing", np.empty((0, 0, 4))
    yield "row", good[:1]
    yield "clear", good * (1, 1, 1, 0)
    yield "black", np.zeros((6, 6, 4))
    yield "white", np.ones((6, 6, 4))
    yield "one color", np.full((6, 6, 4), (0.2, 0.6, 0.1, 1.0))
    for name, value in (("NaN", np.nan), ("infinite", np.inf), ("negative", -1.0), ("bright", 1e30), ("dark", -np.inf)):
        yield f"all {name}", np.full((6, 6, 4), value)
        one = good.copy()
        one[3, 4, 1] = value
        yield f"one {name}", one
        clear = good.copy()
        clear[3, 4, 3] = value
        yield f"alpha {name}", clear
