# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well shapes are mapped to each other, and whether what the map says about itself is true.

Of bodies in two poses it is known which tips belong together: a map that leads a tip nearer to another one's place is
wrong there, however sure it is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.motions.guided_motion import GuidedMotion, guided_motion
from convwass_addon.errors import ConvwassError
from convwass_addon.progress import drained

from .clock import Clock
from .coherence_pairs import CoherencePair, Ends
from .processes import measured

_HEADING = """
The map that guides two shapes, worse of both ways.

wrong      tips of limbs that the map leads to another limb, of all whose place is known
score      of the map, 0 to 1; doubtful is the share of the surface of which the map is unsure
trip       95 % of the surface come back closer than this from the other shape, in sizes of the surface
left       99 % of the deformed surface lie closer than this to the other shape, in its sizes
torn       share of the surface that is stretched beyond measure; folded is the share turned over
"""
_COLUMNS = (
    f"{'':18} {'build':11} {'wrong':>6} {'score':>6} {'confidence':>10} {'doubtful':>8} {'trip':>6} {'left':>6} "
    f"{'stretch':>7} {'torn':>6} {'folded':>6} {'CPU':>6}"
)


def print_maps(pairs: list[CoherencePair], meshes: str | None) -> None:
    """Map the shapes of every pair and print the table; `meshes` is a folder with further ones."""
    print(_HEADING)
    print(_COLUMNS)
    for pair in pairs:
        found = measured("benchmarks.coherence_cases", "mapping", pair=pair.name, meshes=meshes)
        print(line(pair, found), flush=True)


def line(pair: CoherencePair, found: dict[str, object]) -> str:
    """Return a row of the table."""
    if "error" in found:
        return f"{pair.name:18} {pair.build:11} {found['error']}"
    wrong = "" if found["tips"] is None else f"{found['wrong']}/{found['tips']}"
    return (
        f"{pair.name:18} {pair.build:11} {wrong:>6} {found['score']:6.2f} {found['confidence']:10.2f} "
        f"{found['doubtful']:8.2f} {found['round_trip_95']:6.2f} {found['left_99']:6.3f} {found['stretch']:7.2f} "
        f"{found['torn']:6.3f} {found['folded']:6.3f} {found['cpu']:6.1f}"
    )


def mapped(ends: Ends) -> dict[str, object]:
    """Map the shapes of a pair; return what the map says of itself and how many tips it leads astray."""
    clock = Clock()
    try:
        motion = drained(guided_motion([ends.first, ends.second], ["first", "second"], [(0, 1)]))
    except ConvwassError as error:
        return {"error": str(error)}
    seconds = clock.read()
    said = {key: value for key, value in motion.record()["pairs"][0].items() if key != "shapes"}
    wrong = None if ends.tips is None else int(astray(motion, ends.tips).any(axis=0).sum())
    return {**said, "wrong": wrong, "tips": None if ends.tips is None else ends.tips.shape[1], **seconds}


def astray(motion: GuidedMotion, tips: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which tips a map of two shapes leads nearer to another tip than to their own, (2, k), from either shape.

    Parameters
    ----------
    motion : GuidedMotion
        Of the two shapes.
    tips : (2, k, 3)
        On either shape.
    """
    found = []
    for own, other in ((0, 1), (1, 0)):
        deformation, carriers = motion.deformations[own, other], motion.carriers
        images = deformation.images.interpolated(carriers[other].mesh.corners)
        starts = _nearest(tips[own], carriers[own].mesh.vertices)
        found.append(_nearest(images[starts], tips[other]) != np.arange(tips.shape[1]))
    return np.stack(found)


def _nearest(points: NDArray[np.float64], among: NDArray[np.float64]) -> NDArray[np.int64]:
    return np.linalg.norm(points[:, None] - among, axis=2).argmin(axis=1)
