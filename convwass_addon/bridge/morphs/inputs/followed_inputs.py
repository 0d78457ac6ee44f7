# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read animated inputs at every frame of a morph, and keep the ends of the morph animated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import bpy
import numpy as np
from mathutils import Matrix

from ....applications.morphs.animation import Animation, ShapeAnimation
from ....applications.morphs.layouts import Blend
from ....errors import InputError
from ....geometry.meshes.mesh import TriangleMesh
from ....geometry.solids.alignment import RigidMove
from ...animation_time import returning, show_time
from ...handles import found
from ...joined_shapes import joined_shape, shown_live
from ...keyframes import drivers_of
from ...mouse_progress import progress_at_mouse
from ...nodes.node_math import matrix_node, new_node
from ...objects import MESHED, frozen_copy, triangle_mesh
from ...rendered_maps import put_rendered_first
from ...sequence import MODIFIER, frame_group, transformed
from ...shape_sources import ShapeSource
from ...unused_data import removed_on_errors
from ..looks.materials import shows_object_color
from .animated_inputs import data_of
from .frozen_inputs import FrozenInput

FOLLOW = "FOLLOW"
"""Value of the setting `follow` with which every blend reads the inputs at its own frame."""


@dataclass(frozen=True)
class FollowedInputs:
    """Animated inputs.

    Attributes
    ----------
    animation : Animation
        The inputs at every frame of the morph in which they have a weight.
    stations : list of bpy.types.Mesh
        Copies of the inputs in the frames in which they are shown unchanged; without users.
    """

    animation: Animation
    stations: list[bpy.types.Mesh]


@dataclass
class _Reading:
    """Data read from one input."""

    times: list[float] = field(default_factory=list)
    meshes: list[TriangleMesh] = field(default_factory=list)

    def add(self, time: float, mesh: TriangleMesh) -> None:
        if self.meshes and np.array_equal(mesh.faces, self.meshes[-1].faces):
            # One array for all frames.
            mesh = TriangleMesh(mesh.vertices, self.meshes[-1].faces)
        self.times.append(time)
        self.meshes.append(mesh)


def followed_inputs(
    sources: Sequence[ShapeSource],
    blends: Sequence[Blend],
    moves: Sequence[RigidMove] | None,
    first_frame: int,
) -> FollowedInputs:
    """Read the inputs at every frame in which they have a weight; restores the current frame of the scene.

    Parameters
    ----------
    sources : sequence of ShapeSource
        The inputs.
    blends : sequence of Blend
        A path.
    moves : sequence of RigidMove, optional
        Transforms of the inputs, one per input.
    first_frame : int
        Scene frame of the blend with frame 0.

    Raises
    ------
    InputError
        No path, a driver that fails, or an input that cannot be read in some frame. Nothing is created then.
    """
    if blends[0].frame is None:
        raise InputError(
            "Only an animation can follow its inputs: set Layout to Animation, or Inputs to At Bake Frame."
        )
    _refuse_failing_drivers(sources)
    scene, readings = bpy.context.scene, [_Reading() for _ in sources]
    stations: dict[int, bpy.types.Mesh] = {}
    with removed_on_errors(stations.values()), returning(scene), progress_at_mouse() as show:
        for number, blend in enumerate(blends):
            show(number / len(blends))
            show_time(scene, first_frame + blend.frame)
            depsgraph = bpy.context.evaluated_depsgraph_get()
            for index, source in enumerate(sources):
                if blend.weights[index] > 0:
                    move = None if moves is None else moves[index]
                    with _naming_frame(source, first_frame + blend.frame), joined_shape(source, depsgraph) as obj:
                        mesh = triangle_mesh(obj, depsgraph, MESHED)
                        readings[index].add(blend.frame, mesh if move is None else move.moved(mesh))
                        if blend.source == index:
                            stations[index] = frozen_copy(obj, depsgraph, MESHED)
                            put_rendered_first(stations[index])
                            stations[index].transform(Matrix.Identity(4) if move is None else Matrix(move.matrix))
    times = {blend.source: float(blend.frame) for blend in blends if blend.source is not None}
    shapes = [ShapeAnimation(tuple(map(float, own.times)), tuple(own.meshes)) for own in readings]
    everything = range(len(sources))
    animation = Animation(tuple(shapes), tuple(times[index] for index in everything))
    return FollowedInputs(animation, [stations[index] for index in everything])


def keep_animated(obj: bpy.types.Object, own: FrozenInput, move: RigidMove | None) -> None:
    """Make an end of a morph, which is a copy of an input, show the input itself in every frame.

    The copy is exported. Inputs whose parts are not all meshes, such as texts, are not replaced.

    Parameters
    ----------
    obj : bpy.types.Object
        The frame object, in world space.
    own : FrozenInput
        The input.
    move : RigidMove, optional
        Its transform.
    """
    parts = found(list(own.objects))
    if len(parts) < len(own.objects):
        return
    tree = frame_group(f"{own.name} Live")
    geometry = shown_live(tree, parts)
    if geometry is None:
        bpy.data.node_groups.remove(tree)
        return
    if move is not None:
        geometry = transformed(tree, geometry, matrix_node(tree, move.matrix))
    material = obj.data.materials[0] if len(obj.data.materials) else None
    if shows_object_color(material) and not any(part.material_slots for part in parts):
        inputs = {"Material": material, "Geometry": geometry}
        geometry = new_node(tree, "GeometryNodeSetMaterial", inputs).outputs["Geometry"]
    new_node(tree, "NodeGroupOutput", {"Geometry": geometry})
    obj.modifiers.new(MODIFIER, "NODES").node_group = tree


def stays_animated(obj: bpy.types.Object) -> bool:
    """Return whether an end of a morph shows its input in every frame; see `keep_animated`."""
    return MODIFIER in obj.modifiers


@contextmanager
def _naming_frame(source: ShapeSource, frame: int) -> Iterator[None]:
    """Add the frame to the error of an input."""
    try:
        yield
    except InputError as error:
        raise InputError("In frame {frame}: {reason}", frame=frame, reason=error.sentence) from error
    except ReferenceError as error:
        raise InputError("{name} was deleted in frame {frame}.", name=source.name, frame=frame) from error


def _refuse_failing_drivers(sources: Sequence[ShapeSource]) -> None:
    """Raise InputError for drivers with errors, because the shapes would be wrong."""
    for part in [part for source in sources for part in source.parts]:
        for block in data_of(part):
            for curve in drivers_of(block):
                if not curve.driver.is_valid:
                    raise InputError(
                        "The driver of {path} on {name} has an error: fix or delete it in the Drivers editor.",
                        path=curve.data_path,
                        name=block.name,
                    )
