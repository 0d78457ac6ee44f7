# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the coherence benchmark: one sheet per pair, with a row of seven frames for every motion.

Rendered with the product's own contact sheet: ``python -m benchmarks.coherence_sheets sheet OPTIONS``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

from convwass_addon.bridge.morphs.pictures.contact_sheet import render_contact_sheet
from convwass_addon.bridge.morphs.stored import INDEX_KEY, WEIGHTS_KEY
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained

from .coherence_cases import read_frames
from .processes import measured, run_case

COLUMNS = 7
WIDTH = 2100
"""Size of a sheet in pixels."""

# Distance of rows over the height of the tallest frame.
_ROW_STEP = 1.2
_CLAY = (0.56, 0.30, 0.19, 1.0)


def write_sheets(pairs: dict[str, dict[str, Path]], folder: Path) -> None:
    """Write a picture per pair from the files with the frames of every motion.

    Parameters
    ----------
    pairs : dict
        File with the kept frames, by pair and motion; missing files are skipped.
    folder : Path
        Output folder; created if missing.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, files in pairs.items():
        rows = [str(path) for path in files.values() if path.exists()]
        target = folder / f"{name.replace(' ', '_')}.png"
        if rows:
            measured("benchmarks.coherence_sheets", "sheet", rows=rows, target=str(target.absolute()))
            print(f"{target}: {', '.join(way for way, path in files.items() if path.exists())}", flush=True)


def sheet(rows: list[str], target: str) -> dict[str, object]:
    """Render a row of frames for every file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    collection = bpy.data.collections.new("sheet")
    bpy.context.scene.collection.children.link(collection)
    meshes = [_evenly(read_frames(Path(row))) for row in rows]
    extents = np.max([np.ptp(mesh.bounds, axis=0) for row in meshes for mesh in row], axis=0)
    across, down = float(extents[:2].max()), _ROW_STEP * float(extents[2])
    clay = _clay()
    for number, row in enumerate(meshes):
        for column, mesh in enumerate(row):
            obj = _object(mesh, clay, (column * across, 0.0, -number * down))
            obj[WEIGHTS_KEY] = [1.0 - column / (len(row) - 1), column / (len(row) - 1)]
            obj[INDEX_KEY] = number * len(row) + column
            collection.objects.link(obj)
    drained(render_contact_sheet(collection, target, width=WIDTH))
    return {}


def _evenly(meshes: Sequence[TriangleMesh]) -> list[TriangleMesh]:
    return [meshes[i] for i in np.round(np.linspace(0, len(meshes) - 1, COLUMNS)).astype(int)]


def _clay() -> bpy.types.Material:
    material = bpy.data.materials.new("clay")
    shader = own_tree(material).nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = _CLAY
    shader.inputs["Roughness"].default_value = 0.6
    return material


def _object(mesh: TriangleMesh, clay: bpy.types.Material, place: tuple[float, float, float]) -> bpy.types.Object:
    data = bpy.data.meshes.new("frame")
    data.from_pydata(mesh.vertices.tolist(), [], mesh.faces.tolist())
    data.shade_smooth()
    data.materials.append(clay)
    obj = bpy.data.objects.new("frame", data)
    obj.location = place
    return obj


if __name__ == "__main__":
    run_case(sheet)
