# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Map two shapes and register them to each other, as they stand or after turning one to face like the other.

Maps of bodies that stand head to tail can be wrong in spite of a high score: registrations prefer the nearest surface.
Symmetric shapes are turned only into positions in which they have a common mirror plane. If they have none as they
stand, a quarter turn may give them one, and if they have one, they are turned around where the map does not keep sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.deformation.poisson_deformation import mean_stretch
from ...geometry.deformation.upright_turns import distances_after, rotation_about_z, upright_turn_of_points
from ...geometry.meshes.mesh import TriangleMesh, is_level
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from .carriers import Carrier
from .facing_turns import is_turned_over, symmetric_turn, tumbles, turned_carrier, turned_mesh
from .limb_pairs import limb_pairs
from .limbs import is_compact
from .map_detour import map_detour
from .map_survey import Promise, best_rough_map
from .mirrored_guides import MirroredGuides, agreeing_sides
from .mirrored_sides import MirroredSides
from .pair_maps import DOUBTED, PairMap, limb_map, pair_map
from .pair_merits import TRUSTED, MappedPair, better
from .pair_registration import LaidPair, draft_of, grown_pair, laid_on_each_other

# Fractions of the work after the grown registration, and after solving the map.
_GROWN, _MAPPED = 0.22, 0.67
# Half a turn must not make the distance of shapes more than this number of times as large.
_FARTHER = 1.1
# Rough maps of shapes with limbs whose map is not beyond doubt are tried if the first one has at least this score: 0.71
# from sitting to a lunge (map 0.78, and 0.95 from the rough maps) and 0.94 from raised arms to kneeling (0.53, 0.94),
# but 0.53 from a starfish to a hand and 0.64 from a cactus to a child, whose rough maps are no better.
_PROMISING = 0.7
# With a lower score, other maps of symmetric shapes are tried. A cow maps onto a bird with 0.20, 0.48, 0.80 or 0.82 if
# its vertices move by a millionth to a thousandth of its size.
_FAIR = 0.5
# They are used if the merit is at most this share of theirs. A horse maps onto a bird with 0.31, and with 0.38 from a
# rough map, which leaves more of the distance and is no better by eye.
_CLEARLY = 0.75
# Flat shapes are turned upside down, or otherwise, if the score as they stand is at most this share of the score then.
# Upside down, it is 0.4 to 0.76 from a w to an m, and 0.89 from a 9 to a g. Otherwise, it is 0.4 from a W to an E,
# and 0.6 from a man to a horse.
_UPSIDE_DOWN, _SIDEWAYS = 0.8, 0.5
# The same share if they map beyond doubt then; it is 0.83 to 0.85 from an e to an a, an n to a u, and a 6 to a 9.
_TURNED = 0.95
# Flat shapes fold on their way if they move matter farther than this number of times the Wasserstein distance: an H to
# a U and an M to a W that fold move it 2.8 to 3.3 times as far, an F to a y and an L to a V that swing 1.5 to 1.7.
_FOLDING = 1.8
# Shapes registered by their limbs with this score need no other map: 0.82 to 0.89 from a dog, goat, giraffe or cow to a
# man. With less, this share of the merit of others is enough: a kangaroo becomes a man with 0.63 and legs that stay
# legs, and otherwise with 0.63, too; but an elephant becomes a child with 0.53 and its tail as the head, or with 0.83.
_CLEAR_LIMBS, _DOUBTFUL_LIMBS = 0.75, 0.9
_HALF, *_QUARTERS = (rotation_about_z(angle) for angle in (np.pi, 0.5 * np.pi, -0.5 * np.pi))


def mapped_pair(
    one: Carrier, other: Carrier, pairs: NDArray[np.int64], map_vertices: int, control: Control
) -> Work[MappedPair]:
    """Register two shapes to each other.

    Shapes that face different ways, as guides tell or as it seems, are registered as they stand, and with one of them
    turned about the vertical axis. The result that follows more guides is returned, or the one with the best score: a
    bent limb may seem to face another way. Guides on symmetric shapes also count for the other side, and may leave no
    doubt about the turn. Without guides, shapes whose mirror planes are perpendicular, such as animals and people, and
    those that look in opposite directions, as limbs tell, are turned and registered by their limbs first. Flat shapes
    that do not map beyond doubt as they stand are turned if they do so then, or clearly better, above all upside down:
    a w turns to become an m, but a bolt does not turn to become a drop. Where the score is poor, flat shapes fold, or
    shapes with limbs are turned over, seem to face opposite ways, or may be poses of one body, they are also registered
    from the best of several rough maps.

    Parameters
    ----------
    one, other : Carrier
        The two shapes.
    pairs : (k, 2) int64
        Corresponding vertices of their meshes: the guides. A map that follows more of them is better.
    map_vertices : int
        Approximate number of vertices of the coarse meshes on which maps are solved.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The meshes cannot be mapped.
    """
    guides = MirroredGuides.of(one, other, pairs)
    pairs, turn = guides.pairs, guides.turn
    if guides.are_askew:
        return (yield from _registered_turned(one, other, pairs, turn, map_vertices, control))
    if turn is None:
        marked = (_about_center(carrier, pairs[:, side]) for side, carrier in enumerate((one, other)))
        turn = upright_turn_of_points(*marked)
    if turn is None:
        turn = symmetric_turn(one.mesh, other.mesh)
    # In their plane, flat shapes do not face any way. Shape keys map them; flat morphs follow outlines instead.
    is_flat = not len(pairs) and is_level(one.mesh.vertices) and is_level(other.mesh.vertices)
    by_limbs = None
    if turn is None and not len(pairs) and not is_flat:
        by_limbs = yield from within(_registered_by_limbs(one, other, map_vertices, control), 0.0, 0.2)
        if by_limbs is not None and by_limbs.score >= _CLEAR_LIMBS:
            return by_limbs
    best = yield from within(_registered(one, other, pairs, map_vertices, control), 0.2, 0.5)
    if turn is not None and not (is_flat and best.score >= TRUSTED):
        turned = yield from within(_registered_turned(one, other, pairs, turn, map_vertices, control), 0.5, 0.8)
        if not is_flat or _may_turn(best, turned):
            best = better(best, turned)
    if len(pairs) or best.score >= TRUSTED:
        return best
    survey = _or_surveyed(best, one, other, turn, is_flat, control)
    best = yield from within(survey, 0.5 if turn is None else 0.8, 1.0)
    return best if by_limbs is None or by_limbs.merit < _DOUBTFUL_LIMBS * best.merit else by_limbs


def _or_surveyed(
    best: MappedPair, one: Carrier, other: Carrier, turn: NDArray[np.float64] | None, is_flat: bool, control: Control
) -> Work[MappedPair]:
    """Return a pair, or what is clearly better: the shapes registered from the best of rough maps, if those are tried.

    The first shape has been turned by `turn`, (3, 3), unless that is None.
    """
    if is_flat:
        turns = []
    elif turn is None:
        turns = _facing_turns(one.mesh, other.mesh, best)
    else:
        turns = [turn]
    # A letter may fold on its way to another, which is worse than a slightly lower score.
    folds = is_flat and best.detour > _FOLDING
    is_poor = folds or best.is_turned_over or best.score < (DOUBTED if best.symmetry is None else _FAIR)
    may_face_away = bool(turn is None and turns)
    if not may_face_away and (is_compact(one.mesh) or is_compact(other.mesh)):
        return best
    # The merit of shapes without a common mirror plane is lowered already.
    needed = best.merit if best.symmetry is None else best.merit / _CLEARLY
    if may_face_away and best.symmetry is None:
        # A person with a raised arm is nearly symmetric from front to back, which suggests a quarter turn.
        promise = Promise(enough=_PROMISING)
    elif is_poor or may_face_away:
        promise = Promise()
    elif is_flat or needed >= 1.0:
        return best
    else:
        promise = Promise(least=_PROMISING)
    try:
        surveyed = yield from _registered_from_survey(one, other, [None, *turns], promise, control)
    except InputError:
        # Between coarser meshes, there may be no map.
        return best
    if surveyed is None:
        return best
    # The right map stretches shapes least: 0.22 instead of 0.49 from standing to standing on hands, and 0.16 instead of
    # 0.20 from a raised arm to kneeling, which maps back to front with a score of 0.92, and rightly with 0.54. Only a
    # turn that brings mirror planes together may stretch them more.
    if (turn is not None or surveyed.turn == best.turn) and surveyed.stretches_more_than(best):
        return best
    if folds and surveyed.detour < _FOLDING:
        needed = _CLEARLY * best.merit
    return surveyed if surveyed.merit > needed else best


def _may_turn(standing: MappedPair, turned: MappedPair) -> bool:
    """Return whether flat shapes may be turned, because they then map beyond doubt and better, or clearly better."""
    share = _UPSIDE_DOWN if abs(turned.turn) > 179.0 else _SIDEWAYS
    share = _TURNED if turned.score >= TRUSTED else share
    return turned.score >= _FAIR and standing.score <= share * turned.score


def _facing_turns(first: TriangleMesh, second: TriangleMesh, standing: MappedPair) -> list[NDArray[np.float64]]:
    """Return turns after which symmetric shapes may face the same way.

    Quarter turns bring mirror planes together that are perpendicular. There are none if the shapes seem to face the
    same way as they stand, are not symmetric, or would be much farther from each other after half a turn.
    """
    if standing.symmetry is None:
        # After either of them, the planes are the same.
        return [] if MirroredSides.of(turned_mesh(first, _QUARTERS[0]), second) is None else _QUARTERS
    if not standing.is_lopsided:
        return []
    return [_HALF] if _may_turn_around(first, second) else []


def _about_center(carrier: Carrier, vertices: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return vertices of a shape relative to its center, (k, 3), in sizes of the surface."""
    return (carrier.mesh.vertices[vertices] - carrier.mesh.area_center) / carrier.mesh.root_area


def registering(one: Carrier, other: Carrier) -> Sentence:
    """Return the message of the work on two shapes."""
    return Sentence("Registering {first} to {second}", {"first": one.name, "second": other.name})


def _registered_from_survey(
    one: Carrier, other: Carrier, turns: Sequence[NDArray[np.float64] | None], promise: Promise, control: Control
) -> Work[MappedPair | None]:
    """Register two shapes from the best of their rough maps, with the first one turned or as it stands.

    Returns None if not even the first one of these is promising.
    """
    poses = [one if turn is None else turned_carrier(one, turn) for turn in turns]
    rough = yield from within(best_rough_map(poses, other, promise, control), 0.0, 0.5)
    if rough is None:
        return None
    turn, pose = turns[rough.pose], poses[rough.pose]
    yield Progress(0.5, registering(one, other))
    sides = MirroredSides.of(pose.mesh, other.mesh)
    laid = laid_on_each_other((pose, other), rough.starts, rough.map.pairs, None, control, sides)
    found = _mapped(pose, other, laid, rough.map, sides)
    return found if turn is None else _turned_back(found, one, turn)


def _registered_by_limbs(one: Carrier, other: Carrier, map_vertices: int, control: Control) -> Work[MappedPair | None]:
    """Register two shapes by their limbs, with the first one turned so that both look in the same direction.

    Where that is not known, the better one of both quarter turns is taken. Returns None if their limbs do not
    correspond, or if they need no turn.
    """
    target, found = draft_of(other, control), []
    turns = _limb_turns(one, other, target, control)
    for number, turn in enumerate(turns):
        pose = turned_carrier(one, turn)
        sides = MirroredSides.of(pose.mesh, other.mesh)
        if sides is None:
            continue
        drafts = draft_of(pose, control), target
        limbs = limb_pairs(drafts[0].mesh, drafts[1].mesh, sides.planes)
        if not len(limbs.tips) or limbs.facing < 0:
            continue
        pairs = np.stack([draft.seeds[tips] for draft, tips in zip(drafts, limbs.tips.T, strict=True)], axis=1)
        solved = limb_map(pose, other, pairs, map_vertices, control, sides)
        mapped = yield from within(solved, number / len(turns), (number + 0.7) / len(turns))
        laid = laid_on_each_other((pose, other), mapped.starts(pose, other), pairs, None, control, sides)
        found.append(_turned_back(_mapped(pose, other, laid, mapped, sides), one, turn))
    return max(found, key=lambda pair: pair.merit, default=None)


def _limb_turns(one: Carrier, other: Carrier, target: Carrier, control: Control) -> list[NDArray[np.float64]]:
    """Return turns of a shape after which it may look in the direction of the other one, whose coarse mesh is `target`.

    Quarter turns, if only these give them a common mirror plane; or half a turn, if they look in opposite directions.
    """
    sides = MirroredSides.of(one.mesh, other.mesh)
    if sides is None:
        askew = MirroredSides.of(turned_mesh(one.mesh, _QUARTERS[0]), other.mesh)
        return [] if askew is None else _QUARTERS
    limbs = limb_pairs(draft_of(one, control).mesh, target.mesh, sides.planes)
    turns_around = limbs.facing < 0 and _may_turn_around(one.mesh, other.mesh)
    return [_HALF] if turns_around else []


def _may_turn_around(first: TriangleMesh, second: TriangleMesh) -> bool:
    """Return whether half a turn does not bring two shapes much farther from each other."""
    apart = distances_after(first, second, np.stack([np.eye(3), _HALF]))
    return bool(apart[1] <= _FARTHER * apart[0])


def _registered_turned(
    one: Carrier,
    other: Carrier,
    pairs: NDArray[np.int64],
    turn: NDArray[np.float64],
    map_vertices: int,
    control: Control,
) -> Work[MappedPair]:
    """Register two shapes after turning the first one, (3, 3), about its center."""
    found = yield from _registered(turned_carrier(one, turn), other, pairs, map_vertices, control)
    return _turned_back(found, one, turn)


def _turned_back(found: MappedPair, one: Carrier, turn: NDArray[np.float64]) -> MappedPair:
    """Return a pair whose first shape was turned about its center, (3, 3), with points on the shape as it stands."""
    center = one.mesh.area_center
    second = replace(found.laid.second, points=(found.laid.second.points - center) @ turn + center)
    angle = float(np.degrees(np.arctan2(turn[1, 0], turn[0, 0])))
    return replace(found, laid=replace(found.laid, second=second), turn=angle)


def _registered(
    one: Carrier, other: Carrier, pairs: NDArray[np.int64], map_vertices: int, control: Control
) -> Work[MappedPair]:
    """Register two shapes to each other, from their map or from where they coincide."""
    message = registering(one, other)
    yield Progress(0.0, message)
    grown = grown_pair((one, other), control)
    if grown is not None and len(pairs):
        followed = grown.followed(pairs)
        # A minority of guides may be wrong.
        if grown.fits and 2 * followed.sum() >= len(pairs):
            pairs = pairs[followed]
        else:
            grown = None
    yield Progress(_GROWN, message)
    found, starts, sides = replace(PairMap.unneeded(), pairs=pairs), None, None
    if grown is None or not grown.fits:
        sides = agreeing_sides(one, other, pairs)
        found = yield from within(pair_map(one, other, pairs, map_vertices, control, sides), _GROWN, _MAPPED)
        starts = found.starts(one, other)
    yield Progress(_MAPPED, message)
    laid = laid_on_each_other((one, other), starts, found.pairs, grown, control, sides)
    if laid.is_grown:
        found = replace(found, score=laid.confidence)
    return _mapped(one, other, laid, found, sides)


def _mapped(one: Carrier, other: Carrier, laid: LaidPair, found: PairMap, sides: MirroredSides | None) -> MappedPair:
    points = laid.first.points, laid.second.points
    symmetry = None if sides is None else sides.kept(points)
    ways = (one.mesh, laid.first), (other.mesh, laid.second)
    over, tumbling = (any(turns(*way) for way in ways) for turns in (is_turned_over, tumbles))
    detour = map_detour((one.mesh, other.mesh), points)
    stretch = 0.5 * (mean_stretch(one.mesh, points[0]) + mean_stretch(other.mesh, points[1]))
    return MappedPair(laid, found, symmetry, detour, is_turned_over=over, stretch=stretch, tumbles=tumbling)
