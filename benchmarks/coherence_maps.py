# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well shapes are mapped to each other, and how reliable the map's own scores are.

For bodies in two poses, corresponding tips of limbs are known. A map that sends a tip nearer to another tip than to the
corresponding one is wrong there, however high its score.
"""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.motions.guided_motion import GuidedMotion, guided_motion
from convwass_addon.applications.registrations.map_quality import map_quality
from convwass_addon.errors import ConvwassError
from convwass_addon.geometry.arrays.weighted_quantile import weighted_quantile
from convwass_addon.geometry.deformation.poisson_deformation import mean_stretch
from convwass_addon.progress import drained

from .clock import Clock
from .coherence_pairs import CoherencePair, Ends
from .processes import measured

# Vertices with less confidence count as doubtful.
_DOUBTFUL = 0.3

_HEADING = """
The map that guides two shapes, worse of the two directions.

wrong      tips of limbs that the map sends to another limb, of all tips with a known place
score      of the map, 0 to 1; doubtful is the fraction of the surface with an uncertain map
trip       95 % of the surface returns from the other shape to within this distance, in sizes of the surface
left       99 % of the deformed surface is closer than this to the other shape, in sizes of the latter
torn       fraction of the surface that is stretched too much; folded is the fraction that is turned over
"""
_COLUMNS = (
    f"{'':18} {'build':11} {'wrong':>6} {'score':>6} {'confidence':>10} {'doubtful':>8} {'trip':>6} {'left':>6} "
    f"{'stretch':>7} {'torn':>6} {'folded':>6} {'CPU':>6}"
)


def print_maps(pairs: list[CoherencePair], meshes: str | None) -> None:
    """Map the shapes of every pair and print the table; `meshes` is a folder with additional meshes."""
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
    """Map the shapes of a pair; return the map's own scores and the number of tips sent to another limb."""
    clock = Clock()
    try:
        motion = drained(guided_motion([ends.first, ends.second], ["first", "second"], [(0, 1)]))
    except ConvwassError as error:
        return {"error": str(error)}
    seconds = clock.read()
    wrong = None if ends.tips is None else int(astray(motion, ends.tips).any(axis=0).sum())
    tips = None if ends.tips is None else ends.tips.shape[1]
    pair = motion.pairs[0, 1]
    return {"score": pair.score, "turn": pair.turn, **_fit(motion), "wrong": wrong, "tips": tips, **seconds}


def _fit(motion: GuidedMotion) -> dict[str, float]:
    """Measure how well the deformed shapes match each other; the worse figures of both directions."""
    ways = [_one_fit(motion, *way) for way in ((0, 1), (1, 0))]
    return {name: (min if name == "confidence" else max)(way[name] for way in ways) for name in ways[0]}


def _one_fit(motion: GuidedMotion, own: int, other: int) -> dict[str, float]:
    """Measure how well one deformed shape matches the other."""
    source, target = motion.carriers[own], motion.carriers[other]
    there, back = motion.deformations[own, other], motion.deformations[other, own]
    weights = source.mesh.vertex_areas / source.mesh.area
    home = there.images.interpolated(back.points[target.mesh.faces])
    trip = np.linalg.norm(home - source.mesh.vertices, axis=1) / source.mesh.root_area
    return {
        **asdict(map_quality(source, target, there)),
        "doubtful": float(weights[there.confidence < _DOUBTFUL].sum()),
        "round_trip_95": weighted_quantile(trip, weights, 0.95),
        "left_99": weighted_quantile(there.images.distances / target.mesh.root_area, weights, 0.99),
        "stretch": mean_stretch(source.mesh, there.points),
    }


def astray(motion: GuidedMotion, tips: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which tips a map sends nearer to another tip than to their own, (2, k), for either direction.

    Parameters
    ----------
    motion : GuidedMotion
        The motion of the two shapes.
    tips : (2, k, 3)
        On both shapes.
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
