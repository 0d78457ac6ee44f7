# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Map two shapes and register them to each other, as they stand or after turning one to face like the other.

Maps of bodies that stand head to tail can be wrong in spite of a high score: registrations prefer the nearest surface.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.upright_turns import upright_turn, upright_turn_of_points
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..soft_maps.soft_map_settings import SoftMapSettings
from ..soft_maps.surface_maps import PointMap
from ..workers import one_blas_thread
from .carriers import Carrier
from .guided_settings import GuidedSettings
from .laid_meshes import Laid
from .pair_maps import PairMap, pair_map
from .pair_registration import LaidPair, grown_pair, laid_on_each_other

# Fractions of the work after the grown registration, and after solving the map.
_GROWN, _MAPPED = 0.22, 0.67


@dataclass(frozen=True)
class MappedPair:
    """Two registered shapes.

    Attributes
    ----------
    laid : LaidPair
        The registrations.
    map : PairMap
        The map between the shapes, with the score of the registrations if these were not started from it.
    turn : float
        Angle in degrees by which the first shape was turned about the vertical axis for the registration.
    """

    laid: LaidPair
    map: PairMap
    turn: float = 0.0


def mapped_pair(
    one: Carrier, other: Carrier, pairs: NDArray[np.int64], settings: GuidedSettings, control: Control
) -> Work[MappedPair]:
    """Register two shapes to each other.

    Shapes that face different ways, as guides tell or as it seems, are registered as they stand, and with one of them
    turned about the vertical axis. The result that follows more guides is returned, or the one with the better score:
    a bent limb may seem to face another way.

    Parameters
    ----------
    one, other : Carrier
        The two shapes.
    pairs : (k, 2) int64
        Corresponding vertices of their meshes: the guides. A map that follows more of them is better.
    settings : GuidedSettings
        Settings of the motion.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The meshes cannot be mapped.
    """
    marked = (_about_center(carrier, pairs[:, side]) for side, carrier in enumerate((one, other)))
    turn = upright_turn_of_points(*marked)
    if turn is None:
        turn = upright_turn(one.mesh, other.mesh)
    if turn is None:
        return (yield from _registered(one, other, pairs, settings, control))
    standing = yield from within(_registered(one, other, pairs, settings, control), 0.0, 0.5)
    turned = yield from within(_registered_turned(one, other, pairs, turn, settings, control), 0.5, 1.0)
    # Guides may have told the turn, so the map without guides is the one without a turn.
    turned = replace(turned, map=replace(turned.map, score_without=standing.map.score_without))
    return max(standing, turned, key=lambda found: (len(found.map.pairs), found.map.score))


def _about_center(carrier: Carrier, vertices: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return vertices of a shape relative to its center, (k, 3), in sizes of the surface."""
    return (carrier.mesh.vertices[vertices] - _center(carrier)) / carrier.size


def _center(carrier: Carrier) -> NDArray[np.float64]:
    return carrier.mesh.vertex_areas @ carrier.mesh.vertices / carrier.mesh.area


def registering(one: Carrier, other: Carrier) -> Sentence:
    """Return the message of the work on two shapes."""
    return Sentence("Registering {first} to {second}", {"first": one.name, "second": other.name})


def _registered_turned(
    one: Carrier,
    other: Carrier,
    pairs: NDArray[np.int64],
    turn: NDArray[np.float64],
    settings: GuidedSettings,
    control: Control,
) -> Work[MappedPair]:
    """Register two shapes after turning the first one, (3, 3), about its center."""
    center = _center(one)
    turned = one.posed((one.rest.vertices - center) @ turn.T + center)
    found = yield from _registered(turned, other, pairs, settings, control)
    second = replace(found.laid.second, points=(found.laid.second.points - center) @ turn + center)
    angle = float(np.degrees(np.arctan2(turn[1, 0], turn[0, 0])))
    return MappedPair(replace(found.laid, second=second), found.map, angle)


def _registered(
    one: Carrier, other: Carrier, pairs: NDArray[np.int64], settings: GuidedSettings, control: Control
) -> Work[MappedPair]:
    """Register two shapes to each other, from their map or from where they coincide."""
    message = registering(one, other)
    yield Progress(0.0, message)
    with one_blas_thread():
        grown = None if len(pairs) else grown_pair((one, other), control)
    yield Progress(_GROWN, message)
    found, starts = PairMap.none(), None
    if grown is None or not grown.fits:
        map_settings = SoftMapSettings(vertices=settings.map_vertices)
        found = yield from within(pair_map(one, other, pairs, map_settings, control), _GROWN, _MAPPED)
        starts = (_start(one, other, found.found.forward), _start(other, one, found.found.backward))
    yield Progress(_MAPPED, message)
    with one_blas_thread():
        laid = laid_on_each_other((one, other), starts, found.pairs, grown, control)
    if laid.is_grown:
        shares = [carrier.mesh.vertex_areas / carrier.mesh.area for carrier in (one, other)]
        trust = [float(share @ own.trust) for share, own in zip(shares, (laid.first, laid.second), strict=True)]
        found = replace(found, score=min(trust))
    return MappedPair(laid, found)


def _start(source: Carrier, target: Carrier, points: PointMap) -> Laid:
    """Return the registration's start: mapped positions of a shape's vertices, with confidences."""
    places = np.where(points.found[:, None], points.positions(target.mesh), source.mesh.vertices)
    # Mapped points need some weight, even those without confidence.
    return Laid(places, np.where(points.found, np.maximum(points.confidence.astype(np.float64), 1e-6), 0.0))
