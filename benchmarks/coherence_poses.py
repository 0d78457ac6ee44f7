# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether people in all poses are mapped onto each other: hands to hands and feet to feet, left to left.

From the front and from behind, people look nearly alike, and bent legs look like legs that face the other way.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np

from .bipeds import CHILD, MAN, OGRE, Build, Limb, Posture, biped, degrees, straight
from .coherence_maps import mapped
from .coherence_pairs import Ends, people
from .processes import measured

_AHEAD, _UP = straight(degrees(5, 90)), straight(degrees(160))
_BENT = Limb(degrees(20), degrees(15, 80))
_BUILDS = {"man": MAN, "ogre": OGRE, "child": CHILD}


def _squatting(build: Build) -> Posture:
    """Return a posture with the knees ahead of the feet, which are below the hips."""
    shin = np.arcsin(build.thigh / build.shin * np.sin(np.radians(50.0)))
    leg = Limb(degrees(3, 50), degrees(3, -np.degrees(shin)))
    return Posture(arms=(_AHEAD, _AHEAD), legs=(leg, leg))


_POSTURES: dict[str, Callable[[Build], Posture]] = {
    "stands": lambda _build: Posture(),
    "spreads": lambda _build: Posture(arms=(straight(degrees(125)),) * 2, legs=(straight(degrees(28)),) * 2),
    "cheers": lambda _build: Posture(arms=(_UP, _UP)),
    "waves": lambda _build: Posture(arms=(_UP, straight(degrees(20)))),
    "squats": _squatting,
    "sits": lambda _build: Posture(arms=(_BENT, _BENT), legs=(Limb(degrees(5, 85), degrees(3)),) * 2),
    "kneels": lambda _build: Posture(legs=(Limb(degrees(3, 5), degrees(3, -85)),) * 2, toes=(-1.2, -1.2)),
    "kicks": lambda _build: Posture(legs=(straight(degrees(3, 80)), straight(degrees(3)))),
    "walks": lambda _build: Posture(
        arms=(straight(degrees(15, -25)), straight(degrees(15, 30))),
        legs=(straight(degrees(3, 30)), Limb(degrees(3, -15), degrees(3, -45))),
    ),
}

_HEADING = """
People in poses, meshed separately, without guides.

wrong      hands and feet that the map sends to another limb, of four
score      of the map, 0 to 1; turn is the angle in degrees by which the first one was turned, which should be 0
"""


def print_poses() -> None:
    """Map every two poses of a man, and all poses of people of two builds, and print the table."""
    print(_HEADING)
    print(f"{'':14} {'':14} {'wrong':>6} {'score':>6} {'turn':>5} {'CPU':>6}")
    man = [f"man {posture}" for posture in _POSTURES]
    others = [f"{build} {posture}" for build in ("ogre", "child") for posture in _POSTURES]
    # With a shift, everyone meets somebody in another pose.
    shifted = [man[(number + 1 + number // len(man)) % len(man)] for number in range(len(others))]
    right, pairs = 0, [*combinations(man, 2), *zip(others, shifted, strict=True)]
    for first, second in pairs:
        found = measured("benchmarks.coherence_cases", "posed", first=first, second=second)
        right += found.get("wrong") == 0
        print(line(first, second, found), flush=True)
    print(f"\n{right} of {len(pairs)} pairs are mapped rightly.")


def line(first: str, second: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    if "error" in found:
        return f"{first:14} {second:14} {found['error']}"
    wrong = f"{found['wrong']}/{found['tips']}"
    return f"{first:14} {second:14} {wrong:>6} {found['score']:6.2f} {found['turn']:5.0f} {found['cpu']:6.1f}"


def posed(first: str, second: str) -> dict[str, object]:
    """Map two people, each given by a build and a posture."""
    return mapped(_ends(first, second))


def _ends(first: str, second: str) -> Ends:
    bodies = []
    for seed, name in enumerate((first, second)):
        build, posture = name.split()
        bodies.append(biped(_BUILDS[build], _POSTURES[posture](_BUILDS[build]), 60 + seed))
    return people(*bodies)
