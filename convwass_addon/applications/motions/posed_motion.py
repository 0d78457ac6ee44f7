# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A motion between shapes that also change their poses: its maps stay attached to the meshes.

The maps of a guided motion hold in all poses: for the vertices of a pose they give the deformations between the poses,
and so a guided motion. If the motion at rest is not guided, its difference from the guided motion is added, rotated
with the surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from ...geometry.deformation.surface_rotations import surface_rotations
from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import Control
from ..registrations.carriers import Carrier, carrier_of
from ..registrations.laid_meshes import Laid
from ..registrations.shape_deformations import posed_deformation, split_deformation
from .combined_motion import CombinedMotion
from .guided_motion import GuidedMotion
from .guided_settings import GuidedSettings
from .motion import Motion, MovedShape, arriving, weights_between


@dataclass(frozen=True)
class PosedMotion:
    """A motion of shapes at rest, applicable to any poses of them.

    Attributes
    ----------
    chosen : Motion
        The motion between the shapes at rest.
    guided : GuidedMotion
        A guided motion with the same maps; possibly a part of `chosen`.
    embeddings : tuple of ClosestPoints
        The points of the inputs at which the vertices of the guided shapes are.
    places : dict of int to ClosestPoints
        By input, the points of the guided shapes at which the vertices of the chosen motion's shapes are; nothing for
        inputs whose vertices are the same in both motions.
    """

    chosen: Motion
    guided: GuidedMotion
    embeddings: tuple[ClosestPoints, ...]
    places: dict[int, ClosestPoints]

    @classmethod
    def of(
        cls,
        chosen: Motion,
        shapes: Sequence[TriangleMesh],
        names: Sequence[str],
        pairs: Sequence[tuple[int, int]],
        coherence: float,
        control: Control,
    ) -> PosedMotion:
        """Extract the maps of a motion.

        Parameters
        ----------
        chosen : Motion
            The motion between the shapes at rest.
        shapes, names
            The inputs at rest, oriented outward, and their names for messages.
        pairs : sequence of (int, int)
            Pairs of inputs that occur together.
        coherence : float
            Coherence of the motion.
        control : Control
            Stops the work.

        Raises
        ------
        InputError
            A shape has no coarser mesh that can carry it.
        """
        if isinstance(chosen, GuidedMotion):
            guided = chosen
        elif isinstance(chosen, CombinedMotion):
            guided = chosen.guided
        else:
            guided = _guided_along(chosen, shapes, names, pairs, coherence, control)
        embeddings = [own.embedding(shape) for own, shape in zip(guided.carriers, shapes, strict=True)]
        return cls(chosen, guided, tuple(embeddings), _places(chosen, guided, pairs))

    def at(self, shapes: Sequence[TriangleMesh], active: Sequence[int], control: Control) -> Motion:
        """Return the motion between poses of the `active` shapes, which keep their triangles."""
        carriers = list(self.guided.carriers)
        for index in active:
            rest = self.embeddings[index].interpolated(shapes[index].corners)
            carriers[index] = carriers[index].posed(rest)
        before = self.guided.carriers
        deformations = {
            (one, other): posed_deformation(
                self.guided.deformations[one, other], carriers[one], before[other].mesh, carriers[other].mesh, control
            )
            for one, other in permutations(active, 2)
        }
        # There are none unless vertices correspond.
        versions = tuple(own.posed(shape) for own, shape in zip(self.guided.versions, shapes, strict=False))
        posed = replace(self.guided, carriers=tuple(carriers), deformations=deformations, versions=versions)
        return _Posed(self, posed)


@dataclass(frozen=True)
class _Posed:
    """The motion between poses; its `rest` meshes are those of the shapes at rest, to which origins refer."""

    motion: PosedMotion
    guided: GuidedMotion

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        posed = self.guided.moved(weights)
        still = self.motion.guided
        if self.motion.chosen is still:
            return [
                None if own is None else MovedShape(carrier.rest, own.vertices, own.parents)
                for own, carrier in zip(posed, still.carriers, strict=True)
            ]
        chosen, guided = self.motion.chosen.moved(weights), still.moved(weights)
        return [
            None if own is None else _with_difference(own, guided[index], chosen[index], self.motion.places.get(index))
            for index, own in enumerate(posed)
        ]


def _with_difference(
    posed: MovedShape, guided: MovedShape, chosen: MovedShape, places: ClosestPoints | None
) -> MovedShape:
    """Return a posed shape with the difference between the chosen and the guided motion at rest."""
    faces = guided.rest.faces
    turns = surface_rotations(guided.vertices, posed.vertices, faces)
    if places is None:
        difference = chosen.vertices - guided.vertices
        vertices = posed.vertices + np.einsum("nij,nj->ni", turns, difference)
        return MovedShape(chosen.rest, vertices, chosen.parents)
    nearest = faces[places.triangles, places.shares.argmax(axis=1)]
    difference = chosen.vertices - places.interpolated(guided.vertices[faces])
    vertices = places.interpolated(posed.vertices[faces]) + np.einsum("nij,nj->ni", turns[nearest], difference)
    return MovedShape(chosen.rest, vertices, chosen.parents)


def _places(chosen: Motion, guided: GuidedMotion, pairs: Sequence[tuple[int, int]]) -> dict[int, ClosestPoints]:
    """Return the places of the chosen motion's vertices on the guided shapes; see :class:`PosedMotion`."""
    found: dict[int, ClosestPoints] = {}
    for pair in pairs:
        moved = chosen.moved(weights_between(len(guided.carriers), pair, 0.5))
        for index in pair:
            rest, own = guided.carriers[index].rest, moved[index].rest
            if index not in found and own is not rest:
                found[index] = ClosestPointFinder(rest.corners).find(own.vertices)
    return found


def _guided_along(
    motion: Motion,
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    coherence: float,
    control: Control,
) -> GuidedMotion:
    """Return a guided motion whose maps are those of another motion, which moves shapes onto each other."""
    settings = GuidedSettings(coherence=coherence)
    carriers = [
        carrier_of(shape, name, settings.carrier_vertices, control) for shape, name in zip(shapes, names, strict=True)
    ]
    deformations = {}
    for one, other in pairs:
        there = _laid(motion, carriers[one], one, other, len(shapes))
        back = _laid(motion, carriers[other], other, one, len(shapes))
        deformations[one, other] = split_deformation(carriers[one], carriers[other], there, None, control)
        deformations[other, one] = split_deformation(
            carriers[other], carriers[one], back, deformations[one, other], control
        )
    return GuidedMotion(tuple(carriers), deformations, {}, settings)


def _laid(motion: Motion, carrier: Carrier, one: int, other: int, count: int) -> Laid:
    """Return the positions of a carrier's vertices on another shape, as a motion moves them."""
    moved = arriving(motion, count, one, other)
    places = ClosestPointFinder(moved.rest.corners).find(carrier.mesh.vertices)
    return Laid(places.interpolated(moved.mesh.corners), np.ones(len(carrier.mesh.vertices)))
