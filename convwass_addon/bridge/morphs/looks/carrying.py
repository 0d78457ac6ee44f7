# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write colors, vertex groups, normals and velocity of the inputs to the frames of a bake."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from scipy.spatial import cKDTree

from ....applications.morphs.appearance import Carried, carried
from ....applications.morphs.layouts import Blend
from ....applications.morphs.morph_problem import MorphFrame
from ....applications.morphs.origins import velocities
from ....applications.morphs.shading import FrameNormals, frame_normals
from ....geometry.meshes.mesh import TriangleMesh
from ....geometry.meshes.polygons import Polygons
from ....progress import Work
from ...animation_time import times_per_second
from ...element_values import element_values
from ...handles import Handle, found
from ..inputs.frozen_inputs import FrozenInput
from .appearance import (
    read_looks,
    write_carried,
    write_materials,
    write_normals,
    write_own_appearance,
    write_velocity,
)
from .dropped_appearance import dropped_notes
from .look_mixing import FADE
from .look_sources import write_looks
from .mixed_materials import MixedMaterials
from .whole_looks import assign_end_materials, prepared_looks


@dataclass(frozen=True)
class CarriedFrame(MorphFrame):
    """A finished frame with the data carried from the inputs."""

    carried: Carried | None = None
    normals: FrameNormals | None = None


class Carrying:
    """Reads the inputs of a bake, and writes their attributes to the frames.

    All methods except :meth:`looked_up` must be called on the main thread.

    Parameters
    ----------
    inputs : sequence of FrozenInput
        The shapes.
    frozen : sequence of bpy.types.Mesh
        Copies of the inputs at their positions in the bake. Those with a color attribute but without a material get the
        material of the frames, so that the colors do not change at the start of the morph.
    blends : sequence of Blend
        All frames of the bake.
    looks : str
        How frames look; see :attr:`.morph_request.MorphRequest.looks`.
    quads : bool
        Whether the frames have quads.

    Attributes
    ----------
    dropped : list of Diagnostic
        Diagnostics of materials that frames do not show.
    """

    def __init__(
        self,
        inputs: Sequence[FrozenInput],
        frozen: Sequence[bpy.types.Mesh],
        blends: Sequence[Blend],
        looks: str = FADE,
        quads: bool = False,
    ) -> None:
        read = [read_looks(mesh, own.values.color, own.groups) for own, mesh in zip(inputs, frozen, strict=True)]
        prepared = prepared_looks(inputs, frozen, [own.appearance for own in read], looks)
        self._appearances, self._quads = prepared.appearances, quads
        self._shadings = [own.shading for own in read]
        names = [own.name for own in inputs]
        self.dropped = dropped_notes(names, prepared.dropped)
        per_second = times_per_second(bpy.context.scene)
        self._rates = {blend: rate * per_second for blend, rate in rates_of(blends).items()}
        self._shown = [own.shown for own in inputs]
        self._frozen = [Handle.of("meshes", mesh) for mesh in frozen]
        self._beside = _beside_shapes(blends)
        self._passing: dict[Blend, list[_Passing]] = {}
        name = "Morph " + " and ".join(names)
        slots = [list(mesh.materials) or [None] for mesh in frozen]
        self._materials = MixedMaterials(name, slots, prepared.whole)
        material = self._materials.of([0] * len(slots))
        shown = found([own.shown for own in inputs if own.shown is not None])
        for index, mesh in [*enumerate(frozen), *enumerate(shown)]:
            if write_own_appearance(mesh, index, len(frozen)):
                mesh.materials.clear()
                mesh.materials.append(material)
        assign_end_materials(prepared, self._materials, inputs, frozen)

    def _owners(self, mesh: TriangleMesh) -> np.ndarray | None:
        """Return the polygon of every triangle if they are joined to quads."""
        if not self._quads or not any(own.uv_maps for own in self._appearances):
            return None
        return Polygons.of_quads(mesh).owners

    def looked_up(self, work: Work[None]) -> Work[None]:
        """Report the work of a morph, with finished frames as :class:`CarriedFrame`; on any thread."""
        for report in work:
            frame = report.payload
            if isinstance(frame, MorphFrame) and frame.origins is not None:
                taken = carried(
                    frame.origins,
                    frame.mesh.faces,
                    self._appearances,
                    frame.blend.weights,
                    frame.triangles,
                    self._owners(frame.mesh),
                )
                carrying = CarriedFrame(**vars(frame), carried=taken, normals=self._normals(frame))
                report = replace(report, payload=carrying)
            yield report

    def _normals(self, frame: MorphFrame) -> FrameNormals | None:
        """Return the normals of a frame if they differ from those of its surface."""
        if frame.triangles is None:
            return None
        return frame_normals(frame.mesh, frame.origins, frame.triangles, self._shadings, frame.blend.weights)

    def write(self, mesh: bpy.types.Mesh, frame: MorphFrame) -> None:
        """Write the attributes carried by a finished frame, and assign its materials."""
        if frame.mesh is None or frame.origins is None:
            return
        if frame.blend in self._rates:
            velocity = velocities(frame.velocity_points, self._rates[frame.blend])
            write_velocity(mesh, velocity)
            for shape in self._beside.get(frame.blend, ()):
                self._pass(shape, _Passing(frame.origins[shape.source], velocity))
        if isinstance(frame, CarriedFrame):
            write_carried(mesh, frame.carried)
            self._write_looks(mesh, frame)
            if frame.normals is not None:
                write_normals(mesh, frame.normals, frame.mesh)
            materials = [self._materials.of(slots) for slots in frame.carried.slots.combinations]
            if None not in materials:
                write_materials(mesh, materials, frame.carried.slots.faces, frame.mesh)

    def _write_looks(self, mesh: bpy.types.Mesh, frame: CarriedFrame) -> None:
        """Write what whole materials read, the UV maps of the largest weight first."""
        if not self._materials.are_whole:
            return
        seen, weights = frame.carried.inputs, frame.carried.weights
        order = sorted(seen, key=lambda index: -weights[index])
        uvs = {name: frame.carried.uvs[name] for index in order for name in self._appearances[index].uv_maps}
        fields = {name: values for own in seen.values() for name, values in own.fields.items()}
        is_triangles = len(mesh.loops) == frame.mesh.faces.size
        write_looks(mesh, uvs, fields, None if is_triangles else Polygons.of_quads(frame.mesh).sources)

    def _pass(self, shape: Blend, passing: _Passing) -> None:
        """Set the velocity of an input within a path to the mean of the blends before and after it."""
        both = self._passing.setdefault(shape, [])
        both.append(passing)
        mesh = self._frozen[shape.source].find()
        if len(both) == 2 and mesh is not None:
            points = element_values(mesh.vertices, "co", 3)
            velocity = np.mean([side.at(points) for side in both], axis=0)
            shown = self._shown[shape.source].find() if self._shown[shape.source] else mesh
            if shown is not None and len(shown.vertices) == len(velocity):
                write_velocity(shown, velocity)
            both.clear()

    def drop_unused(self) -> None:
        """Remove materials that no frame uses."""
        self._materials.drop_unused()


@dataclass(frozen=True)
class _Passing:
    """Velocities at points of an input, taken from a neighboring blend."""

    points: np.ndarray
    velocity: np.ndarray

    def at(self, points: np.ndarray) -> np.ndarray:
        return self.velocity[cKDTree(self.points).query(points)[1]]


def _beside_shapes(blends: Sequence[Blend]) -> dict[Blend, list[Blend]]:
    """For every blend of a path, return the inputs directly before and after it."""
    path = [blend for blend in blends if blend.frame is not None]
    beside: dict[Blend, list[Blend]] = {}
    for before, here, after in zip(path, path[1:], path[2:], strict=False):
        if here.source is not None:
            for blend in (before, after):
                beside.setdefault(blend, []).append(here)
    return beside


def rates_of(blends: Sequence[Blend]) -> dict[Blend, np.ndarray]:
    """Central differences of the weights along a path, per frame, (k,) each.

    Blends outside an animation, and its ends, where the morph stands still, have none.
    """
    path = [blend for blend in blends if blend.frame is not None]
    return {
        here: (np.array(after.weights) - np.array(before.weights)) / (after.frame - before.frame)
        for before, here, after in zip(path, path[1:], path[2:], strict=False)
    }
