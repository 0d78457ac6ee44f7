# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends computed as in the application, from volumes or files; shared by the cases of the other benchmarks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.morphs import blending, extraction
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame, MorphProblem
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.parts import SplitShapes
from convwass_addon.applications.morphs.transport_problem import TransportProblem
from convwass_addon.applications.morphs.volumes import Lattice, voxelized
from convwass_addon.applications.motions.guides import Guide
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import payloads
from convwass_addon.transport import barycenter

ASSETS = Path(__file__).resolve().parent.parent / "assets" / "shapes"


@dataclass(frozen=True)
class Pair:
    """Two shapes on a common grid.

    Attributes
    ----------
    shapes : tuple of TriangleMesh
        In the space of the files.
    lattice : Lattice
        The grid.
    densities : (2, nx, ny, nz) float32
        Filled fraction of every cell, for each shape.
    """

    shapes: tuple[TriangleMesh, TriangleMesh]
    lattice: Lattice
    densities: NDArray[np.float32]

    @classmethod
    def read(cls, paths: Sequence[str | Path], cells: int, sigma: float) -> Pair:
        """Voxelize two meshes with `cells` along the longest side and the margin that `sigma` requires."""
        shapes = read_meshes(paths)
        lattice = Lattice.around(shapes, cells, sigma)
        filled = [
            voxelized(shape, Path(path).stem, index, lattice, 0.0)
            for index, (shape, path) in enumerate(zip(shapes, paths, strict=True))
        ]
        return cls(shapes, lattice, np.stack(filled))

    @property
    def volumes(self) -> NDArray[np.float64]:
        """Volumes of the two shapes in cells."""
        return self.densities.sum(axis=(1, 2, 3), dtype=np.float64)


def read_meshes(paths: Sequence[str | Path]) -> tuple[TriangleMesh, ...]:
    """Read meshes from files, each scaled to a longest side of one, so that any two can be blended."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shapes = []
    for path in paths:
        (obj,) = import_objects(Path(path), None)
        mesh = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
        shapes.append(TriangleMesh(mesh.vertices / mesh.longest_side, mesh.faces))
    return tuple(shapes)


def density_at(
    densities: NDArray[np.floating], lattice: Lattice, t: float, settings: MorphSettings
) -> NDArray[np.float64]:
    """Solve the application's barycenter at t from a cold start."""
    weights = (1.0 - t, t)
    grid, sharpness = lattice.grid(settings.sigma), settings.sharpness_at(weights)
    return barycenter(
        densities,
        weights,
        grid,
        sharpness=sharpness,
        tolerance=settings.stopping_error,
        debias_tolerance=settings.debias_stopping_error_at(weights),
    ).density


def surface_at(
    densities: NDArray[np.floating], volumes: Sequence[float], t: float, settings: MorphSettings
) -> TriangleMesh:
    """Blend two volumes on a cubic grid as the application does; return the surface in cells.

    Parameters
    ----------
    densities : (2, n, n, n)
        The two solids.
    volumes : (2,)
        The volumes to interpolate between.
    t, settings
        Position and parameters of the blend.
    """
    lattice = Lattice(densities.shape[1:], 1.0, np.zeros(3), np.zeros((2, 3)))
    whole = SplitShapes(("all",), (list(densities),), densities.sum(axis=(1, 2, 3), dtype=np.float64)[None], ())
    transport = TransportProblem.of(whole, lattice, settings)
    part = replace(transport.parts[0], volumes=np.asarray(volumes, np.float64))
    # The shapes themselves have the volumes of their densities, whatever the blend is to have.
    problem = replace(MorphProblem(transport).with_connectivity(), transport=replace(transport, parts=(part,)))
    (frame,) = blending.solve_blends(problem, [Blend((1.0 - t, t))])
    return frame.mesh


def own_surface(filled: NDArray[np.floating]) -> TriangleMesh:
    """Return the surface of a shape's own occupancy, extracted like the surface of a blend."""
    return extraction.own_surface(filled, MorphSettings()).mesh


def baked(shapes: Sequence[TriangleMesh], frames: int, settings: MorphSettings) -> list[TriangleMesh]:
    """Bake a path from the first shape to the second; return the frames in between, in cells."""
    spacing = Lattice.around(shapes, settings.resolution, settings.sigma).spacing
    meshes = [frame.mesh for frame in baked_frames(shapes, frames, settings) if frame.mesh is not None]
    return [TriangleMesh(mesh.vertices / spacing, mesh.faces) for mesh in meshes]


def baked_frames(
    shapes: Sequence[TriangleMesh], frames: int, settings: MorphSettings, guides: Sequence[Guide] = ()
) -> list[MorphFrame]:
    """Bake a path from the first shape to the second; return all frames, in the space of the shapes."""
    names = [f"shape {index}" for index in range(len(shapes))]
    steps = morph(MorphInputs.of(shapes, names, guides=guides), path_blends(len(shapes), frames), settings)
    # A frame may be yielded more than once.
    return list({frame.blend: frame for frame in payloads(steps, MorphFrame)}.values())
