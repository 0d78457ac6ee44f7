# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of limbs of symmetric shapes."""

from functools import cache
from itertools import permutations

import numpy as np
import pytest

from convwass_addon.applications.registrations.limb_pairs import best_pairing, limb_pairs
from convwass_addon.applications.registrations.limb_tips import Limb, Limbs
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane
from tests.shapes import PERSON, ball, body, capsules, joined


def legs(front, hind):
    return [((x, y, 0.6), (x, y, 0.0), 0.07) for x in (-0.2, 0.2) for y in (front, hind)]


TRUNK = ((0.0, -0.6, 0.75), (0.0, 0.6, 0.75), 0.2)
NECK = [((0.0, -0.6, 0.8), (0.0, -0.8, 1.1), 0.1), ((0.0, -0.8, 1.15), (0.0, -1.05, 1.1), 0.13)]
RAISED_TAIL = ((0.0, 0.7, 0.8), (0.0, 1.0, 1.35), 0.05)
HORNS = [((0.05 * side, -0.82, 1.25), (0.12 * side, -0.75, 1.6), 0.04) for side in (-1, 1)]


@cache
def animal(*others):
    """An animal that faces -y, made of capsules."""
    limbs = (TRUNK, *NECK, *legs(-0.6, 0.6), *others)
    return capsules(limbs, (-0.6, -1.3, -0.15), (0.6, 1.2, 1.75), 0.04)


FEET = [((0.14 * side, 0.0, 0.08), (0.14 * side, -0.2, 0.06), 0.06) for side in (-1, 1)]


@cache
def person():
    """A person who faces -y, as the feet tell."""
    return capsules((*PERSON, *FEET), (-1.0, -0.4, -0.1), (1.0, 0.3, 1.95), 0.04)


def middle(mesh):
    return MirrorPlane(mesh.area_center, np.array([1.0, 0.0, 0.0]))


def paired_places(first, second):
    pairs = limb_pairs(first, second, (middle(first), middle(second))).tips
    return np.stack([first.vertices[pairs[:, 0]], second.vertices[pairs[:, 1]]], axis=1)


def named(places):
    """Say which parts of an animal and of a person are paired, and whether they are on the same side."""
    found = set()
    for here, there in places:
        own = "tail" if here[1] > 0.8 else "head" if here[2] > 0.8 else "front leg" if here[1] < 0 else "hind leg"
        other = "head" if there[2] > 1.5 else "hand" if there[2] > 0.5 else "foot"
        sides = "" if other == "head" else (" same side" if here[0] * there[0] > 0 else " other side")
        found.add(f"{own} to {other}{sides}")
    return sorted(found)


@pytest.mark.parametrize("others", [(), (RAISED_TAIL,), tuple(HORNS)], ids=["no tail", "raised tail", "horns"])
def test_an_animal_stands_up_to_become_a_person(others):
    """Its raised tail is as high as its head, but thinner."""
    found = paired_places(animal(*others), person())
    assert len(found) == 5
    assert named(found) == ["front leg to hand same side", "head to head", "hind leg to foot same side"]


def test_limbs_of_one_shape_are_paired_with_themselves():
    for second in (person(), backward(person())):
        found = limb_pairs(person(), second, (middle(person()), middle(second)))
        assert len(found.tips) == 5
        at_hand = np.abs(person().vertices[found.tips[:, 0], 0]) > 0.5
        np.testing.assert_array_equal(at_hand, np.abs(second.vertices[found.tips[:, 1], 0]) > 0.5)
        sides = person().vertices[found.tips[:, 0], 0] * second.vertices[found.tips[:, 1], 0]
        assert (sides > -0.01).all()


def test_limbs_of_two_animals_are_not_paired():
    """The raised tail of one is more like the head of another one than its head is."""
    assert not len(paired_places(animal(RAISED_TAIL), animal(*HORNS)))


def backward(mesh):
    return TriangleMesh(mesh.vertices * (-1.0, -1.0, 1.0), mesh.faces)


@pytest.mark.parametrize("turned", [False, True])
def test_animals_look_where_their_heads_are_and_people_where_their_toes_are(turned):
    for first in (animal(RAISED_TAIL), person()):
        second = backward(person()) if turned else person()
        found = limb_pairs(first, second, (middle(first), middle(second)))
        assert found.facing == (-1 if turned else 1)


def test_without_toes_it_is_not_known_where_people_look():
    first, second = animal(), body(0.04)
    assert limb_pairs(first, second, (middle(first), middle(second))).facing == 0


def bent(*joints):
    """A person who faces -y, with the hips, knees, ankles and toes at given places, (y, z)."""
    moved = np.array((0.0, joints[0][0], joints[0][1] - 0.95))
    trunk = [(start + moved, end + moved, radius) for start, end, radius in PERSON[:5]]
    legs = [
        ((0.14 * side, *one), (0.14 * side, *other), radius)
        for side in (-1, 1)
        for one, other, radius in zip(joints, joints[1:], (0.07, 0.07, 0.06), strict=False)
    ]
    return capsules((*trunk, *legs), (-1.0, -0.8, -0.1), (1.0, 0.9, 1.95), 0.04)


@pytest.mark.parametrize(
    "joints",
    [
        ((0.1, 0.6), (-0.35, 0.42), (0.0, 0.08), (-0.2, 0.06)),
        ((0.0, 0.5), (0.0, 0.07), (0.42, 0.08), (0.6, 0.06)),
    ],
    ids=["squatting", "kneeling"],
)
def test_toes_tell_nothing_while_the_shins_are_not_upright(joints):
    """These would lie behind the shins of people who squat, and those of people who kneel point back."""
    second = bent(*joints)
    assert limb_pairs(person(), second, (middle(person()), middle(second))).facing == 0


def test_shapes_whose_limbs_do_not_correspond_have_no_pairs():
    log = capsules((((0.0, -1.0, 0.3), (0.0, 1.0, 0.3), 0.3),), (-0.5, -1.5, -0.1), (0.5, 1.5, 0.8), 0.05)
    for other in (log, ball(points=400)):
        assert not len(paired_places(person(), other))
        assert not len(paired_places(other, person()))


def test_a_person_who_raises_an_arm_has_no_pair_of_arms():
    raised = [((0.15, 0.0, 1.42), (0.75, 0.0, 1.8), 0.05) if limb == PERSON[4] else limb for limb in PERSON]
    first = capsules((*raised, *FEET), (-1.0, -0.4, -0.1), (1.0, 0.3, 2.1), 0.04)
    found = paired_places(first, person())
    assert (np.abs(found[:, :, 0]) < 0.5).all()


def test_shapes_with_many_limbs_are_not_compared():
    branches = [((0.0, 0.0, z), (0.9 * side, 0.0, z), 0.06) for z in 0.4 * np.arange(9) for side in (-1, 1)]
    tree = capsules((((0.0, 0.0, 0.0), (0.0, 0.0, 3.2), 0.1), *branches), (-1.1, -0.2, -0.2), (1.1, 0.2, 3.4), 0.05)
    assert not len(paired_places(tree, tree))


def test_other_components_and_loose_vertices_are_no_limbs():
    """Not even between the horns, where the middle of the head is looked for."""
    horned, places = animal(*HORNS), [(0.0, -0.8, 1.5), (3.0, 0.0, 0.0)]
    crowded = joined(horned, ball(0.03, places[0], 60), ball(0.05, places[1], 60))
    loose = TriangleMesh(np.concatenate([crowded.vertices, [[0.0, -0.75, 1.6]]]), crowded.faces)
    planes = middle(horned), middle(person())
    np.testing.assert_array_equal(limb_pairs(loose, person(), planes).tips, limb_pairs(horned, person(), planes).tips)


def limbs_at_random(random, sizes):
    tips = iter(range(sum(sizes)))
    limbs = [Limb(tuple(next(tips) for _ in range(size)), None) for size in sizes]
    limbs = [Limb(limb.tips, limb.tips[0] if len(limb.tips) == 1 else None) for limb in limbs]
    count = sum(sizes)
    places = random.random((count, 3))
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    shares, heights, unknown = random.uniform(0.05, 0.3, count), random.random(count), np.zeros(count)
    return Limbs(limbs, np.arange(count), shares, heights, apart, unknown, unknown, unknown > 0)


def pairing_cost(one, other, found):
    """The cost by its definition."""
    here, there = np.array([pair for pairs in found for pair in pairs], int).reshape(-1, 2).T
    others = min(len(one.vertices), len(other.vertices)) - 1
    cost = np.abs(np.log(one.shares[here] / other.shares[there])).sum()
    cost += np.abs(one.heights[here] - other.heights[there]).sum()
    cost += np.abs(one.apart[np.ix_(here, here)] - other.apart[np.ix_(there, there)]).sum() / others
    for own, tips in ((one, here), (other, there)):
        cost += np.delete(own.shares, tips).sum() / own.shares.mean()
    return cost


@pytest.mark.parametrize("seed", range(6))
def test_the_best_pairing_is_that_of_an_exhaustive_search(seed):
    random = np.random.default_rng(seed)
    one, other = limbs_at_random(random, (1, 2, 1, 2)), limbs_at_random(random, (2, 1, 2))
    costs = []
    for order in permutations([*range(3), None, None, None, None], 4):
        pairs = [(one.limbs[k].tips, other.limbs[j].tips) for k, j in enumerate(order) if j is not None]
        if all(len(here) == len(there) for here, there in pairs):
            costs.append(pairing_cost(one, other, [list(zip(*both, strict=True)) for both in pairs]))
    found, cost = best_pairing(one, other)
    assert cost == pytest.approx(min(costs))
    assert pairing_cost(one, other, found) == pytest.approx(cost)
