# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of :mod:`.looks`, in processes of their own: ``python -m benchmarks.looks_cases CASE OPTIONS``."""

from __future__ import annotations

import time
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.looks.carrying import Carrying
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.geometry.meshes.uv_charts import uv_sizes

from .look_scenes import (
    add_light,
    add_object_coordinates,
    baked,
    checkered_material,
    empty_scene,
    pictured,
    textured_cube,
    textured_sphere,
    three_materials,
)
from .processes import run_case

# Close-ups: their number, width in the scene, and width in pixels. A pixel of the texture is about eight of these wide.
_VIEWS, _WIDTH, _PIXELS = 6, 0.1, 256
# Size in pixels of windows that must contain black and white.
_WINDOW = 33
# A UV map is wrong where it is stretched or squeezed by more than this factor.
_OFF = 2.0
# The map between two shapes is even where it is stretched or squeezed by less than this factor.
_EVEN = 1.5


def checker(cells: int, motion: str) -> dict[str, object]:
    """Bake a sphere and a cube with checkerboards of single pixels, and examine close-ups of the frames."""
    empty_scene()
    inputs = [textured_sphere(checkered_material("Sphere")), textured_cube(checkered_material("Cube"))]
    frames = baked(inputs, path_blends(2, 4), cells, motion=motion)[1:-1]
    found: dict[str, object] = {}
    for number, name in enumerate(("sphere", "cube"), start=1):
        own = _contrast(inputs[number - 1])
        for frame, weight in zip(frames, (0.25, 0.5, 0.75), strict=True):
            for other in (1, 2):
                _fill(frame.data, f"source_weight_{other}", float(other == number))
            found[f"{name} contrast {weight:g}"] = _contrast(frame) / own
            found[f"{name} seams {weight:g}"] = _seams(frame.data, number)
    return found


def animals(folder: str, cells: int, motion: str) -> dict[str, object]:
    """Bake spot and blub, and tell seams from places where the map between them is stretched or squeezed itself."""
    empty_scene()
    inputs = []
    for name in ("spot", "blub"):
        (obj,) = import_objects(Path(folder) / f"{name}_triangulated.obj", None)
        material = checkered_material(name)
        add_object_coordinates(material)
        obj.data.materials.clear()
        obj.data.materials.append(material)
        inputs.append(obj)
    bpy.context.view_layer.update()
    frames = baked(inputs, path_blends(2, 4), cells, motion=motion)[1:-1]
    found: dict[str, object] = {}
    for number, name in enumerate(("spot", "blub"), start=1):
        for frame, weight in zip(frames, (0.25, 0.5, 0.75), strict=True):
            found[f"{name} all {weight:g}"] = _seams(frame.data, number)
            found[f"{name} seams {weight:g}"] = _seams(frame.data, number, _EVEN)
    return found


def start(cells: int) -> dict[str, object]:
    """Compare an object with three materials with the frame directly after it."""
    empty_scene()
    add_light()
    materials = three_materials()
    inputs = [textured_sphere(materials[0]), textured_cube(checkered_material("Cube"))]
    for material in materials[1:]:
        inputs[0].data.materials.append(material)
    for polygon in inputs[0].data.polygons:
        polygon.material_index = int(polygon.center.x > 0.2) + int(polygon.center.z > 0.3)
    inputs[0].rotation_euler, inputs[0].scale = (0.4, 0.2, 0.9), (1.0, 0.8, 1.2)
    bpy.context.view_layer.update()
    path = path_blends(2, 2000)
    frames = baked(inputs, [path[0], path[1], path[-1]], cells)
    found = {}
    for name, frame in (("end", frames[0]), ("next", frames[1])):
        differences = [
            _difference(pictured(frame, view, 3.0, 256, 64), pictured(inputs[0], view, 3.0, 256, 64))
            for view in ((1, -1, 0.6), (-1, 1, 0.4))
        ]
        found[name] = float(np.mean(differences))
    return found


def seconds(cells: int) -> dict[str, object]:
    """Transfer and write the looks of frames: whole materials with a UV map each, and colors only."""
    empty_scene()
    inputs = [textured_sphere(checkered_material("Sphere")), textured_cube(checkered_material("Cube"))]
    depsgraph, blends = bpy.context.evaluated_depsgraph_get(), path_blends(2, 4)
    shapes = [triangle_mesh(obj, depsgraph) for obj in inputs]
    work = morph(MorphInputs.of(shapes, ["Sphere", "Cube"]), blends, MorphSettings(cells), computation=Computation(1))
    reports = [report for report in work if isinstance(report.payload, MorphFrame) and report.payload.mesh is not None]
    found: dict[str, object] = {"triangles": max(len(report.payload.mesh.faces) for report in reports)}
    for looks in ("COLORS", "FADE"):
        bake = MorphBake.begin(inputs, blends, {}, 1)
        carrying = Carrying(bake.inputs, bake.frozen, blends, looks)
        carried = []
        begin = time.process_time()
        carried += [report.payload for report in carrying.looked_up(iter(reports))]
        spent = time.process_time() - begin
        objects = [bake.add(frame) for frame in carried]
        begin = time.process_time()
        for obj, frame in zip(objects, carried, strict=True):
            carrying.write(obj.data, frame)
        found[looks] = (spent + time.process_time() - begin) / len(carried)
        bake.discard()
    return found


def _contrast(obj: bpy.types.Object) -> float:
    """Return the mean difference of the lightest and darkest pixels in the window around each pixel."""
    rng = np.random.default_rng(0)
    contrasts = []
    for direction in rng.normal(size=(_VIEWS, 3)):
        values = pictured(obj, direction, _WIDTH, _PIXELS, 16)[..., 0]
        contrasts.append(float(np.mean(maximum_filter(values, _WINDOW) - minimum_filter(values, _WINDOW))))
    return float(np.mean(contrasts))


def _seams(mesh: bpy.types.Mesh, number: int, even: float = np.inf) -> float:
    """Return the share of the surface on which a UV map is stretched or squeezed relative to its surroundings.

    Only triangles count whose origins on the shape are stretched or squeezed by less than `even`.
    """
    mesh.calc_loop_triangles()
    loops = element_values(mesh.loop_triangles, "loops", 3, np.int32)
    faces = element_values(mesh.loops, "vertex_index", kind=np.int32)[loops]
    layer = next(own for own in mesh.uv_layers if own.name.startswith(f"uv_{number}_"))
    corners = element_values(mesh.vertices, "co", 3)[faces].astype(np.float64)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    sizes = uv_sizes(corners, element_values(layer.uv, "vector", 2)[loops].astype(np.float64))
    off = _is_uneven(sizes, faces, _OFF)
    if even < np.inf:
        places = element_values(mesh.attributes[f"rest_position_{number}"].data, "vector", 3)
        off &= ~_is_uneven(_stretches(corners, places[faces].astype(np.float64)), faces, even)
    return float(areas[off].sum() / areas.sum())


def _is_uneven(sizes: NDArray[np.float64], faces: NDArray[np.int64], factor: float) -> NDArray[np.bool_]:
    """Return where the values of triangles differ from those around them by more than a factor."""
    usual = _surrounding(sizes, faces)
    return (sizes > factor * usual) | (sizes < usual / factor)


def _stretches(corners: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest stretch from triangles to other triangles, (n, 3, 3) each: (n,)."""
    first = others[:, 1] - others[:, 0]
    second = others[:, 2] - others[:, 0]
    length = np.maximum(np.linalg.norm(first, axis=1), 1e-12)
    along = np.einsum("nd,nd->n", first, second) / length
    across = np.linalg.norm(np.cross(first, second), axis=1) / length
    nothing = np.zeros_like(length)
    flat = np.stack([nothing, nothing, length, nothing, along, across], axis=1)
    return uv_sizes(corners, flat.reshape(-1, 3, 2))


def _surrounding(values: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the median of the values of triangles over two rings of neighbors, approximately."""
    for _ in range(2):
        of_corners = np.sort(_means(values, faces)[faces], axis=1)
        values = np.median(np.concatenate([of_corners, values[:, None]], axis=1), axis=1)
    return values


def _means(values: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the geometric means over the triangles at every vertex."""
    logs = np.repeat(np.log(np.maximum(values, 1e-9)), 3)
    counts = np.bincount(faces.ravel())
    return np.exp(np.bincount(faces.ravel(), logs) / np.maximum(counts, 1))


def _fill(mesh: bpy.types.Mesh, name: str, value: float) -> None:
    mesh.attributes[name].data.foreach_set("value", np.full(len(mesh.vertices), value, np.float32))


def _difference(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the mean difference of displayed colors, from 0 to 255, where both pictures show something."""
    both = (one[..., 3] > 0.99) & (other[..., 3] > 0.99)
    return float(255.0 * np.abs(one - other)[both][:, :3].mean())


if __name__ == "__main__":
    run_case(checker, animals, start, seconds)
