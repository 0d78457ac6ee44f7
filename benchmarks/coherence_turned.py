# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How guides help where the map without them is wrong: people of whom one stands the other way around.

From the front and from behind, people look nearly alike, so the map without guides sends the left hand to the right
one. The map of the same people facing the same way, which needs no guides, tells where every point belongs.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from convwass_addon.applications.motions.guided_motion import GuidedMotion
from convwass_addon.geometry.meshes.mesh import TriangleMesh

from .clock import Clock
from .coherence_guides import motion_with_guides
from .coherence_pairs import CoherencePair, Ends
from .processes import measured

PEOPLE = ("man raises arm", "man walks", "man to ogre", "child points", "ogre to child")
"""Pairs of people; their tips are the hands, then the feet."""

GUIDES = {
    "none": (),
    "one right": ((0, 0),),
    "two right": ((0, 0), (1, 1)),
    "three right": ((0, 0), (1, 1), (2, 2)),
    "four right": ((0, 0), (1, 1), (2, 2), (3, 3)),
    "two right, one wrong": ((0, 0), (1, 1), (2, 3)),
    "one wrong": ((2, 3),),
}
"""Guides of every kind, as indices of tips on the first and the second shape."""

# A point counts as wrong if it is mapped farther than this from where it belongs, and as far from a wrong guide if it
# is farther than the second number from both of its ends; in sizes of the surface.
_WRONG, _AWAY = 0.15, 0.3

_HEADING = """
The second shape turned by 180 degrees about the vertical axis, and the map computed with guides at hands and feet.

error      mean distance of mapped points from where the map of the shapes before the turn sends them, in sizes of the
           surface
wrong      share of the surface with an error of more than {wrong}; beyond is the same farther than {away} from all
           wrong guides
kept       guides that the map follows, of those given
"""
_COLUMNS = f"{'':18} {'guides':20} {'error':>6} {'wrong':>6} {'beyond':>6} {'score':>6} {'kept':>5} {'CPU':>6}"


def print_turned(pairs: Sequence[CoherencePair], meshes: str | None) -> None:
    """Map people that face different ways with every kind of guides, and print the table."""
    print(_HEADING.format(wrong=_WRONG, away=_AWAY))
    print(_COLUMNS)
    for pair in pairs:
        if pair.name in PEOPLE:
            found = measured("benchmarks.coherence_cases", "turning", pair=pair.name, meshes=meshes)
            for kind, figures in found.items():
                print(line(pair.name, kind, figures), flush=True)


def line(pair: str, kind: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    kept = f"{found['followed']}/{found['given']}" if found["given"] else ""
    return (
        f"{pair:18} {kind:20} {found['error']:6.3f} {100 * found['wrong']:4.0f} % {100 * found['beyond']:4.0f} % "
        f"{found['score']:6.2f} {kept:>5} {found['cpu']:6.1f}"
    )


def turned(ends: Ends) -> dict[str, dict[str, object]]:
    """Map a pair of people, the second of whom is turned by 180 degrees, with every kind of guides."""
    known = motion_with_guides(ends, ())
    center = ends.second.vertices.mean(axis=0)
    half_turn = np.diag([-1.0, -1.0, 1.0])

    def turn(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return (points - center) @ half_turn + center

    around = Ends(
        ends.first,
        TriangleMesh(turn(ends.second.vertices), ends.second.faces),
        tips=np.stack([ends.tips[0], turn(ends.tips[1])]),
    )
    starts, images = known.carriers[0].mesh, turn(known.deformations[0, 1].points)
    found = {}
    for kind, clicked in GUIDES.items():
        clock = Clock()
        motion = motion_with_guides(around, clicked)
        seconds = clock.read()
        off = _errors(motion, starts.vertices, images)
        wrong = [around.tips[0, tip] for one, other in clicked if one != other for tip in (one, other)]
        pair = motion.pairs[0, 1]
        found[kind] = {
            **_figures(off, starts, wrong),
            "score": pair.score,
            "followed": len(clicked) - pair.guides_left_out,
            "given": len(clicked),
            **seconds,
        }
    return found


def _errors(motion: GuidedMotion, starts: NDArray[np.float64], images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far a map sends points, (n, 3), from their known images, (n, 3), in sizes of the surface, (n,)."""
    source, target = (motion.carriers[shape] for shape in (0, 1))
    nearest = cKDTree(source.mesh.vertices).query(starts)[1]
    return np.linalg.norm(motion.deformations[0, 1].points[nearest] - images, axis=1) / target.mesh.root_area


def _figures(off: NDArray[np.float64], mesh: TriangleMesh, wrong: Sequence[NDArray[np.float64]]) -> dict[str, float]:
    """Average the errors at the vertices of a mesh; `wrong` are the ends of wrong guides on it."""
    shares = mesh.vertex_areas / mesh.area
    apart = np.linalg.norm(mesh.vertices[:, None] - np.reshape(wrong, (-1, 3)), axis=2).min(axis=1, initial=np.inf)
    beyond = shares * (apart > _AWAY * mesh.root_area)
    return {
        "error": float(shares @ off),
        "wrong": float(shares[off > _WRONG].sum()),
        "beyond": float(beyond[off > _WRONG].sum() / beyond.sum()),
    }
