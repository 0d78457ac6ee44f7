# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How guides change the map between two shapes: correct guides, one wrong guide, and guides in a plane.

The guides are at tips of limbs, where a user clicks on seeing a limb go to the wrong place.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.motions.guided_motion import GuidedMotion, guided_motion
from convwass_addon.applications.motions.guides import Guide
from convwass_addon.errors import ConvwassError
from convwass_addon.progress import drained

from .clock import Clock
from .coherence_maps import astray
from .coherence_pairs import CoherencePair, Ends
from .processes import measured

_HEADING = """
Guides at the tips of limbs, and the map computed with them. Tips with a guide are not counted.

two        guides at two tips: if possible, tips that the map without guides sends to another limb, else the two
           farthest apart
wrong one  the same, and a third guide from one tip to the place of another
plane      guides at the three or four tips nearest to a common plane
astray     tips that the map sends to another limb
off        mean distance of the others from their correct positions, in sizes of the surface
score      of the map, 0 to 1
kept       guides that the map follows, of those given
"""
_COLUMNS = f"{'':18} {'guides':10} {'astray':>7} {'off':>6} {'score':>6} {'kept':>5} {'CPU':>6}"


def print_guides(pairs: Sequence[CoherencePair], meshes: str | None) -> None:
    """Map the shapes of every pair with known tips with and without guides, and print the table."""
    print(_HEADING)
    print(_COLUMNS)
    for pair in pairs:
        if pair.ends().tips is not None:
            found = measured("benchmarks.coherence_cases", "guiding", pair=pair.name, meshes=meshes)
            for kind, figures in found.items():
                print(line(pair.name, kind, figures), flush=True)


def line(pair: str, kind: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    if "error" in found:
        return f"{pair:18} {kind:10} {found['error']}"
    astray_of = f"{found['astray']}/{found['tips']}"
    kept = f"{found['followed']}/{found['given']}" if found["given"] else ""
    return f"{pair:18} {kind:10} {astray_of:>7} {found['off']:6.3f} {found['score']:6.2f} {kept:>5} {found['cpu']:6.1f}"


def guided(ends: Ends) -> dict[str, dict[str, object]]:
    """Map the shapes of a pair with known tips, with every kind of guides."""
    plain = _mapped(ends, [])
    found = {"none": _figures(plain, ends, [])}
    missed = np.zeros(ends.tips.shape[1], bool) if isinstance(plain, str) else astray(plain[0], ends.tips).any(axis=0)
    for kind, clicked in kinds_of_guides(ends.tips, missed).items():
        found[kind] = _figures(_mapped(ends, clicked), ends, clicked)
    return found


def kinds_of_guides(tips: NDArray[np.float64], missed: NDArray[np.bool_]) -> dict[str, list[tuple[int, int]]]:
    """Return the guides of every kind, as indices of tips on the first and the second shape.

    Parameters
    ----------
    tips : (2, k, 3)
        On both shapes; at least three.
    missed : (k,) bool
        Tips that the map without guides sends to another limb.
    """
    among = np.flatnonzero(missed) if missed.sum() >= 2 else np.arange(tips.shape[1])
    two = among[_farthest(tips[0, among])]
    right = [(int(tip), int(tip)) for tip in two]
    one, other = (int(tip) for tip in np.setdiff1d(np.arange(tips.shape[1]), two)[[0, -1]])
    # With three tips, only one other tip is left: its guide leads to the place of the first of the two.
    wrong = [*right, (one, other)] if one != other else [*right[1:], (one, right[0][1])]
    plane = [(int(tip), int(tip)) for tip in _in_a_plane(tips[0], min(4, tips.shape[1]))]
    return {"two": right, "wrong one": wrong, "plane": plane}


def _farthest(points: NDArray[np.float64]) -> NDArray[np.int64]:
    apart = np.linalg.norm(points[:, None] - points, axis=2)
    return np.array(np.unravel_index(apart.argmax(), apart.shape))


def _in_a_plane(points: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Return the tips whose largest distance from their common plane is smallest."""

    def thickness(chosen: tuple[int, ...]) -> float:
        own = points[list(chosen)]
        return float(np.linalg.svd(own - own.mean(axis=0), compute_uv=False)[2]) if count > 3 else 0.0

    return np.array(min(combinations(range(len(points)), count), key=thickness))


def guides_at_tips(ends: Ends, clicked: Sequence[tuple[int, int]]) -> list[Guide]:
    """Return guides at tips of a pair, given as indices of tips on the first and the second shape."""
    return [
        {0: _vertex(ends.first.vertices, ends.tips[0, one]), 1: _vertex(ends.second.vertices, ends.tips[1, other])}
        for one, other in clicked
    ]


def motion_with_guides(ends: Ends, clicked: Sequence[tuple[int, int]]) -> GuidedMotion:
    """Map a pair with guides at tips."""
    guides = guides_at_tips(ends, clicked)
    return drained(guided_motion([ends.first, ends.second], ["first", "second"], [(0, 1)], guides=guides))


def _mapped(ends: Ends, clicked: Sequence[tuple[int, int]]) -> tuple[GuidedMotion, dict[str, float]] | str:
    clock = Clock()
    try:
        motion = motion_with_guides(ends, clicked)
    except ConvwassError as error:
        return str(error)
    return motion, clock.read()


def _figures(
    found: tuple[GuidedMotion, dict[str, float]] | str, ends: Ends, clicked: Sequence[tuple[int, int]]
) -> dict[str, object]:
    if isinstance(found, str):
        return {"error": found}
    motion, seconds = found
    others = np.setdiff1d(np.arange(ends.tips.shape[1]), [tip for pair in clicked for tip in pair])
    pair = motion.pairs[0, 1]
    return {
        "astray": int(astray(motion, ends.tips).any(axis=0)[others].sum()),
        "tips": len(others),
        "off": float(_off(motion, ends.tips)[:, others].mean()) if len(others) else 0.0,
        "score": pair.score,
        "followed": len(clicked) - pair.guides_left_out,
        "given": len(clicked),
        **seconds,
    }


def _off(motion: GuidedMotion, tips: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance of mapped tips from their correct positions, (2, k), for either direction."""
    found = []
    for own, other in ((0, 1), (1, 0)):
        source, target = motion.carriers[own], motion.carriers[other]
        images = motion.deformations[own, other].images.interpolated(target.mesh.corners)
        starts, aims = (
            [_vertex(carrier.mesh.vertices, tip) for tip in tips[shape]]
            for carrier, shape in ((source, own), (target, other))
        )
        found.append(np.linalg.norm(images[starts] - target.mesh.vertices[aims], axis=1) / target.mesh.root_area)
    return np.stack(found)


def _vertex(vertices: NDArray[np.float64], place: NDArray[np.float64]) -> int:
    return int(np.linalg.norm(vertices - place, axis=1).argmin())
