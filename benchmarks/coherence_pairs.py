# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of shapes whose morph should be coherent: poses and builds of one kind of body, and different bodies.

Pairs in `TUNED` may be used for choosing parameters; those in `HELD_BACK` are other bodies, for the final check.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.mesh import TriangleMesh

from . import bipeds, centaurs, creatures, hands, props, quadrupeds, things
from .bipeds import CHILD, MAN, OGRE, Limb as Bones, Posture, biped, degrees, straight
from .blends import ASSETS, read_meshes
from .limb_paths import LimbPath, PosedLimb
from .quadrupeds import DOG, GIRAFFE, GOAT, GRAZING, REARING, STANDING, TROTTING, quadruped
from .skinning import skinned

ONE_BUILD = "one build"
OTHER_BUILD = "other build"


@dataclass(frozen=True)
class Ends:
    """The two shapes of a pair.

    Attributes
    ----------
    first, second : TriangleMesh
        Each meshed separately.
    limb : LimbPath or None
        A limb that swings between them, if its joints are known.
    tips : (2, k, 3) float64 or None
        Corresponding tips of limbs on both shapes.
    """

    first: TriangleMesh
    second: TriangleMesh
    limb: LimbPath | None = None
    tips: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class CoherencePair:
    """A pair of shapes.

    Attributes
    ----------
    name : str
        Name in tables.
    build : str
        `ONE_BUILD` or `OTHER_BUILD`.
    ends : callable
        Creates the shapes.
    """

    name: str
    build: str
    ends: Callable[[], Ends]


_ARM_DOWN, _ARM_UP = straight(degrees(out=20)), straight(degrees(out=140))
_ARM_AHEAD = straight(degrees(out=20, forward=120))
_STRIDE = Posture(
    arms=(Bones(degrees(16, -32), degrees(14, -8)), Bones(degrees(16, 34), degrees(12, 62))),
    legs=(Bones(degrees(3, 36), degrees(3, 20)), Bones(degrees(3, -18), degrees(3, -42))),
    toes=(0.25, -0.6),
)
_BACK_STRIDE = Posture(
    arms=(Bones(degrees(16, 34), degrees(12, 62)), Bones(degrees(16, -32), degrees(14, -8))),
    legs=(Bones(degrees(3, -18), degrees(3, -42)), Bones(degrees(3, 36), degrees(3, 20))),
    toes=(-0.6, 0.25),
)
_SPREAD = Posture(arms=(straight(degrees(out=80)),) * 2, legs=(straight(degrees(out=12)),) * 2)
_WAVING = Posture(arms=(straight(degrees(out=150)), _ARM_DOWN))
_SITTING = Posture(arms=(Bones(degrees(20), degrees(15, 80)),) * 2, legs=(Bones(degrees(5, 85), degrees(3)),) * 2)
_KNEELING = Posture(legs=(Bones(degrees(3, 5), degrees(3, -85)),) * 2)
_TALL = replace(STANDING, neck=66.0, tail=(235.0, 262.0))


def people(one: bipeds.Biped, other: bipeds.Biped) -> Ends:
    """Return two people, whose tips are the hands, then the feet."""
    tips = np.array([[chain[-1] for chain in (*body.arms, *body.legs)] for body in (one, other)])
    return Ends(one.sculpture.mesh(), other.sculpture.mesh(), tips=tips)


def _swings_arm(build: bipeds.Build, up: Bones, seeds: tuple[int, int]) -> Ends:
    down, raised = Posture(), Posture(arms=(up, _ARM_DOWN))
    one, other = (biped(build, posture, seed) for posture, seed in zip((down, raised), seeds, strict=True))

    def posed(t: float) -> PosedLimb:
        body = biped(build, down.toward(raised, t), seeds[0])
        return PosedLimb(body.sculpture.mesh(), body.arms[0])

    return replace(people(one, other), limb=LimbPath(one.arms[0], other.arms[0], posed=posed))


def _animals(one: quadrupeds.Quadruped, other: quadrupeds.Quadruped) -> Ends:
    tips = np.array([[chain[-1] for chain in (*body.fore, *body.hind, body.neck)] for body in (one, other)])
    return Ends(one.sculpture.mesh(), other.sculpture.mesh(), tips=tips)


def _moves(
    build: quadrupeds.Build,
    poses: tuple[quadrupeds.Pose, quadrupeds.Pose],
    seeds: tuple[int, int],
    limb: Callable[[quadrupeds.Quadruped], NDArray[np.float64]],
) -> Ends:
    """Return an animal in two poses, with the limb that moves most."""
    first, second = poses
    one, other = (quadruped(build, pose, seed) for pose, seed in zip(poses, seeds, strict=True))

    def joints(body: quadrupeds.Quadruped) -> NDArray[np.float64]:
        return np.vstack([body.hips, limb(body)])

    def posed(t: float) -> PosedLimb:
        body = quadruped(build, first.toward(second, t), seeds[0])
        return PosedLimb(body.sculpture.mesh(), joints(body))

    return replace(_animals(one, other), limb=LimbPath(joints(one), joints(other), root=1, posed=posed))


def _foreleg(body: quadrupeds.Quadruped) -> NDArray[np.float64]:
    return body.fore[0]


def _hands(one: hands.Hand, other: hands.Hand) -> Ends:
    tips = np.array([[finger[-1] for finger in each.fingers] for each in (one, other)])
    return Ends(one.sculpture.mesh(), other.sculpture.mesh(), tips=tips)


def _man_raises_arm() -> Ends:
    return _swings_arm(MAN, _ARM_UP, (1, 2))


def _man_walks() -> Ends:
    return people(biped(MAN, Posture(), 3), biped(MAN, _STRIDE, 4))


def _man_to_ogre() -> Ends:
    return people(biped(MAN, Posture(), 5), biped(OGRE, Posture(), 6))


def _child_points() -> Ends:
    return _swings_arm(CHILD, _ARM_AHEAD, (7, 8))


def _ogre_to_child() -> Ends:
    return people(biped(OGRE, _BACK_STRIDE, 9), biped(CHILD, Posture(), 10))


def _dog_rears() -> Ends:
    return _moves(DOG, (STANDING, REARING), (11, 12), _foreleg)


def _goat_rears() -> Ends:
    return _moves(GOAT, (STANDING, REARING), (13, 14), _foreleg)


def _giraffe_grazes() -> Ends:
    return _moves(GIRAFFE, (_TALL, GRAZING), (15, 16), lambda body: body.neck)


def _goat_to_giraffe() -> Ends:
    return _animals(quadruped(GOAT, STANDING, 17), quadruped(GIRAFFE, _TALL, 18))


def _hand_points() -> Ends:
    return _hands(hands.hand(hands.HAND, hands.SPREAD, 19), hands.hand(hands.HAND, hands.BENT, 20))


def _glove_bends() -> Ends:
    return _hands(hands.hand(hands.GLOVE, hands.GLOVE_OPEN, 21), hands.hand(hands.GLOVE, hands.GLOVE_BENT, 22))


def _skinned_people(build: bipeds.Build, postures: tuple[Posture, Posture], turn: float = 0.0) -> Ends:
    """Return a person in two poses of one mesh; the second one is turned about the vertical axis, in degrees."""
    mesh, bones = biped(build, _SPREAD, 71).sculpture.mesh(), _bones_of(build, _SPREAD)
    first, second = (_bones_of(build, posture) for posture in postures)
    one, other = (skinned(mesh, bones, pose, 0.03) for pose in (first, second))
    about_z = Rotation.from_euler("z", turn, degrees=True)
    # The trunk has no tip.
    tips = [[chain[-1] for chain in pose[1:]] for pose in (first, [about_z.apply(chain) for chain in second])]
    return Ends(one, TriangleMesh(about_z.apply(other.vertices), other.faces), tips=np.array(tips))


def _bones_of(build: bipeds.Build, posture: Posture) -> list[NDArray[np.float64]]:
    """Return the chains of joints of a person: trunk, arms and legs."""
    body = biped(build, posture, 71)
    hips, shoulders = (np.mean([limb[0] for limb in limbs], axis=0) for limbs in (body.legs, body.arms))
    crown = shoulders + np.array([0.0, 0.0, build.neck + 2.0 * build.head[2]])
    return [np.stack([hips, shoulders, crown]), *body.arms, *body.legs]


def _hand_closes() -> Ends:
    """Return a hand that makes a fist, in two poses of one mesh."""
    open_, fist = (hands.hand(hands.HAND, gesture, 72) for gesture in (hands.SPREAD, hands.FIST))
    palm = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.9 * hands.HAND.height]])
    mesh = open_.sculpture.mesh()
    closed = skinned(mesh, [palm, *open_.fingers], [palm, *fist.fingers], 0.04)
    return Ends(mesh, closed, tips=np.array([[finger[-1] for finger in own.fingers] for own in (open_, fist)]))


def _octopus_moves() -> Ends:
    crawl, up, far = creatures.CRAWLING, creatures.RAISED, creatures.REACHING
    first = creatures.octopus([up, crawl, crawl, crawl, up, crawl, crawl, crawl], [40.0] * 8, 23)
    turns = [-50.0, 0.0, -30.0, 40.0, -50.0, 0.0, 40.0, -30.0]
    second = creatures.octopus([crawl, far, up, crawl, crawl, far, crawl, up], turns, 24)
    return _creatures(first, second)


def _starfish_curls() -> Ends:
    bent = creatures.starfish([50.0, -40.0, 60.0, -55.0, 40.0], [20.0, 0.0, -30.0, 40.0, 0.0], 26)
    return _creatures(creatures.starfish([0.0] * 5, [0.0] * 5, 25), bent)


def _creatures(one: creatures.Creature, other: creatures.Creature) -> Ends:
    return Ends(one.sculpture.mesh(), other.sculpture.mesh(), tips=np.array([one.tips, other.tips]))


def _chair_to_man() -> Ends:
    return Ends(things.chair(27).mesh(), biped(MAN, Posture(), 28).sculpture.mesh())


def _dog_to_man() -> Ends:
    return Ends(quadruped(DOG, STANDING, 22).sculpture.mesh(), biped(MAN, Posture(), 20).sculpture.mesh())


def _goat_to_ogre() -> Ends:
    return Ends(quadruped(GOAT, STANDING, 43).sculpture.mesh(), biped(OGRE, Posture(), 44).sculpture.mesh())


def _dog_to_centaur() -> Ends:
    """Only the legs and the trunk correspond; the limb is a hind leg."""
    dog, other = quadruped(DOG, STANDING, 41), centaurs.centaur(DOG, TROTTING, 42)
    limb = LimbPath(*(np.vstack([body.hips, body.hind[0]]) for body in (dog, other.body)), root=1)
    tips = np.array([[chain[-1] for chain in (*body.fore, *body.hind)] for body in (dog, other.body)])
    return Ends(dog.sculpture.mesh(), other.sculpture.mesh(), limb, tips)


def _table_to_dog() -> Ends:
    return Ends(things.table(29).mesh(), quadruped(DOG, STANDING, 30).sculpture.mesh())


def _cactus_to_child() -> Ends:
    up = Posture(arms=(straight(degrees(out=150)), straight(degrees(out=130))))
    return Ends(things.cactus(31).mesh(), biped(CHILD, up, 32).sculpture.mesh())


def _shark_to_airplane() -> Ends:
    return Ends(creatures.shark(33).mesh(), things.airplane(34).mesh())


def _starfish_to_hand() -> Ends:
    return Ends(
        creatures.starfish([0.0] * 5, [0.0] * 5, 35).sculpture.mesh(),
        hands.hand(hands.HAND, hands.SPREAD, 36).sculpture.mesh(),
    )


def _star_to_cross() -> Ends:
    return Ends(things.star(37).mesh(), things.cross(38).mesh())


def _ball_to_knot() -> Ends:
    return Ends(things.ball(39).mesh(), *_sample("knot"))


def _ball_to_ring() -> Ends:
    return Ends(things.ball(40).mesh(), things.ring(41).mesh())


def _two_balls_to_one() -> Ends:
    return Ends(things.two_balls(42).mesh(), things.ball(43).mesh())


def _cactus_to_ball() -> Ends:
    cactus, ball = things.cactus(44).mesh(), things.ball(45).mesh()
    return Ends(cactus, TriangleMesh(np.cbrt(cactus.volume / ball.volume) * ball.vertices, ball.faces))


def _props(first: Callable[[], TriangleMesh], second: Callable[[], TriangleMesh]) -> Callable[[], Ends]:
    return lambda: Ends(first(), second())


def _sample(*names: str) -> tuple[TriangleMesh, ...]:
    return _read([ASSETS / f"{name}.ply" for name in names])


def _samples(first: str, second: str) -> Callable[[], Ends]:
    return lambda: Ends(*_sample(first, second))


TUNED = (
    CoherencePair("man raises arm", ONE_BUILD, _man_raises_arm),
    CoherencePair("man walks", ONE_BUILD, _man_walks),
    CoherencePair("man to ogre", ONE_BUILD, _man_to_ogre),
    CoherencePair("dog rears", ONE_BUILD, _dog_rears),
    CoherencePair("hand points", ONE_BUILD, _hand_points),
    CoherencePair("octopus moves", ONE_BUILD, _octopus_moves),
    CoherencePair("horse to cow", ONE_BUILD, _samples("horse", "cow")),
    CoherencePair("chair to man", OTHER_BUILD, _chair_to_man),
    CoherencePair("dog to man", OTHER_BUILD, _dog_to_man),
    CoherencePair("octopus to horse", OTHER_BUILD, _samples("octopus", "horse")),
    CoherencePair("horse to bird", OTHER_BUILD, _samples("horse", "bird")),
    CoherencePair("star to cross", OTHER_BUILD, _star_to_cross),
    CoherencePair("dog to centaur", OTHER_BUILD, _dog_to_centaur),
    CoherencePair("ball to knot", OTHER_BUILD, _ball_to_knot),
)
"""May be used for choosing parameters."""

HELD_BACK = (
    CoherencePair("child points", ONE_BUILD, _child_points),
    CoherencePair("giraffe grazes", ONE_BUILD, _giraffe_grazes),
    CoherencePair("goat rears", ONE_BUILD, _goat_rears),
    CoherencePair("glove bends", ONE_BUILD, _glove_bends),
    CoherencePair("starfish curls", ONE_BUILD, _starfish_curls),
    CoherencePair("goat to giraffe", ONE_BUILD, _goat_to_giraffe),
    CoherencePair("ogre to child", ONE_BUILD, _ogre_to_child),
    CoherencePair("goat to ogre", OTHER_BUILD, _goat_to_ogre),
    CoherencePair("table to dog", OTHER_BUILD, _table_to_dog),
    CoherencePair("cactus to child", OTHER_BUILD, _cactus_to_child),
    CoherencePair("shark to airplane", OTHER_BUILD, _shark_to_airplane),
    CoherencePair("starfish to hand", OTHER_BUILD, _starfish_to_hand),
    CoherencePair("dolphins to bird", OTHER_BUILD, _samples("dolphins", "bird")),
    CoherencePair("A to B", OTHER_BUILD, _samples("letter_a", "letter_b")),
)
"""Other bodies, not used for choosing parameters."""

SOLIDS = (
    CoherencePair("ball to ring", OTHER_BUILD, _ball_to_ring),
    CoherencePair("two balls to one", OTHER_BUILD, _two_balls_to_one),
    CoherencePair("cactus to ball", OTHER_BUILD, _cactus_to_ball),
)
"""Shapes of which one has no limbs; only computed if they are named."""

PROPS = (
    CoherencePair("star to heart", OTHER_BUILD, _props(props.star, props.heart)),
    CoherencePair("arrow to tick", OTHER_BUILD, _props(props.arrow, props.tick)),
    CoherencePair("ring to C", OTHER_BUILD, _props(props.ring, lambda: props.ring(0.8))),
    CoherencePair("pawn to rook", OTHER_BUILD, _props(props.pawn, props.rook)),
    CoherencePair("goblet to bottle", OTHER_BUILD, _props(props.goblet, props.bottle)),
    CoherencePair("barrel to goblet", OTHER_BUILD, _props(props.barrel, props.goblet)),
    CoherencePair("wine glass to vase", OTHER_BUILD, _props(props.wine_glass, props.vase)),
    CoherencePair("pawn to bowl", OTHER_BUILD, _props(props.pawn, props.bowl)),
    CoherencePair("mug to bottle", OTHER_BUILD, _props(things.mug(46).mesh, props.bottle)),
    CoherencePair("trophy to wine glass", OTHER_BUILD, _props(things.trophy(47).mesh, props.wine_glass)),
    CoherencePair("mug to trophy", OTHER_BUILD, _props(things.mug(46).mesh, things.trophy(47).mesh)),
    CoherencePair("bottle to lying rook", OTHER_BUILD, _props(props.bottle, lambda: props.lying(props.rook()))),
    CoherencePair("table to crate", OTHER_BUILD, _props(props.table, props.crate)),
    CoherencePair("sofa to bed", OTHER_BUILD, _props(props.sofa, props.bed)),
    CoherencePair("robot to chair", OTHER_BUILD, _props(props.robot, props.seat)),
    CoherencePair("locomotive to car", OTHER_BUILD, _props(props.locomotive, props.car)),
    CoherencePair("coil to rod", OTHER_BUILD, _props(things.coil(61).mesh, things.rod(62).mesh)),
    CoherencePair("spring to rod", OTHER_BUILD, _props(things.spring(63).mesh, things.rod(62).mesh)),
    CoherencePair("spring to snake", OTHER_BUILD, _props(things.spring(63).mesh, things.snake(64).mesh)),
)
"""Signs, solids of revolution, things of overlapping parts, and tubes; only computed if they are named."""

SKINNED = (
    CoherencePair("one mesh sits down", ONE_BUILD, lambda: _skinned_people(MAN, (_WAVING, _SITTING), 175.0)),
    CoherencePair("one mesh kneels", ONE_BUILD, lambda: _skinned_people(MAN, (_STRIDE, _KNEELING))),
    CoherencePair("one mesh makes a fist", ONE_BUILD, _hand_closes),
)
"""Poses of one mesh, whose vertices correspond; only computed if they are named."""

_TWELVE = (
    *("man raises arm", "octopus moves", "horse to cow", "chair to man", "star to cross", "ball to knot"),
    *("giraffe grazes", "goat rears", "ogre to child", "cactus to child", "shark to airplane", "starfish to hand"),
)

_FOLDER_PAIRS = (("spot", "bob", True), ("blub", "spot", False))


def further_pairs(folder: Path, *, tuned: bool) -> tuple[CoherencePair, ...]:
    """Return the pairs of one half from a folder of additional meshes, if both files exist."""
    found = []
    for first, second, is_tuned in _FOLDER_PAIRS:
        files = [sorted(folder.glob(f"{name}*tri*.obj")) for name in (first, second)]
        if is_tuned == tuned and all(files):
            paths = [matches[0].absolute() for matches in files]
            found.append(CoherencePair(f"{first} to {second}", OTHER_BUILD, _files(paths)))
    return tuple(found)


def pairs_named(names: Sequence[str], folder: Path | None) -> list[CoherencePair]:
    """Return pairs by name.

    Raises
    ------
    ValueError
        A name is unknown; the message lists all names.
    """
    known = {
        pair.name: pair for pair in (*half(folder, tuned=True), *half(folder, tuned=False), *SOLIDS, *PROPS, *SKINNED)
    }
    unknown = [name for name in names if name not in known]
    if unknown:
        raise ValueError(f"no pair {unknown[0]}; there are: {', '.join(known)}")
    return [known[name] for name in names]


def twelve() -> tuple[CoherencePair, ...]:
    """Return six pairs of each half, with all kinds of shapes."""
    return tuple(pairs_named(_TWELVE, None))


def half(folder: Path | None, *, tuned: bool) -> tuple[CoherencePair, ...]:
    """Return one half of the pairs, including those from a folder of additional meshes."""
    pairs = TUNED if tuned else HELD_BACK
    return pairs if folder is None else (*pairs, *further_pairs(folder, tuned=tuned))


def _files(paths: list[Path]) -> Callable[[], Ends]:
    return lambda: Ends(*_read(paths))


def _read(paths: list[Path]) -> tuple[TriangleMesh, ...]:
    """Read meshes and scale them to the size of the sculpted ones."""
    return tuple(TriangleMesh(2.0 * mesh.vertices, mesh.faces) for mesh in read_meshes(paths))
