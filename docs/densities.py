# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the picture of densities on a surface, docs/pictures/densities.jpg: ``python3 run.py python docs/densities.py``.

First row: distances from a vertex, and midpoints of two densities with decreasing entropy bounds. Second and third
row: a density of two peaks that moves to another, without and with an entropy bound.
"""

from __future__ import annotations

import math
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from numpy.typing import NDArray
from photographs import color_material, finer, sample_shape, save_jpeg

from convwass_addon.applications.densities.density_paths import blend_steps, interpolation_steps
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.densities.density_tools import diffused, unit_mass
from convwass_addon.applications.densities.surface_densities import density_figures, density_surface
from convwass_addon.applications.densities.vertex_distances import distances_from
from convwass_addon.bridge.densities.density_material import ROUGHNESS
from convwass_addon.bridge.heat_map import heat_colors
from convwass_addon.bridge.studio.framing import Pose, View
from convwass_addon.bridge.studio.rendered_scene import Studio
from convwass_addon.bridge.surfaces import surface_mesh
from convwass_addon.progress import drained
from convwass_addon.transport import Surface

_STEP = (2.5, 2.2)
_LINES = 16
_CLAY = np.array([0.42, 0.4, 0.38])
_SIZE = (2000, 1100)


def main() -> None:
    """Compute all densities on one animal, and render them in rows."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    obj = finer(sample_shape("horse"), 1)
    obj.data.shade_smooth()
    surface = density_surface(surface_mesh(obj, bpy.context.evaluated_depsgraph_get()))
    rows = [_first_row(surface), _travelling(surface, None), _travelling(surface, "max")]
    _photograph(obj, rows)


def _first_row(surface: Surface) -> list[NDArray[np.float64]]:
    lengths = distances_from(_nearest(surface, (-0.95, 0.0, 1.2)), surface).heat_map().weights
    lines = 1.0 - 0.65 * np.exp(-(((lengths * _LINES % 1.0) - 0.5) ** 2) / 0.02)
    ends = [_bump(surface, place, 0.14) for place in ((0.35, -0.3, 0.95), (-0.65, -0.3, 0.95))]
    limit = max(density_figures(end, surface, "end").entropy for end in ends)
    pictures = [heat_colors(1.0 - lengths)[:, :3] * lines[:, None]]
    for bound in (None, limit + 0.6, limit, limit - 0.6):
        settings = DensitySettings(entropy_limit=bound, blend_sharpness=0.0)
        steps = blend_steps(ends, ("A", "B"), (0.5, 0.5), surface, settings)
        pictures.append(_heat(drained(steps).densities[0]))
    return pictures


def _travelling(surface: Surface, entropy_limit: str | None) -> list[NDArray[np.float64]]:
    first = _bump(surface, (0.5, -0.2, 0.5), 0.1) + _bump(surface, (-0.6, -0.2, 0.1), 0.1)
    second = _bump(surface, (0.6, -0.1, 1.5), 0.1) + _bump(surface, (-0.9, -0.1, 0.8), 0.1)
    steps = interpolation_steps(first, second, surface, DensitySettings(steps=4, entropy_limit=entropy_limit))
    return [_heat(density) for density in drained(steps).densities]


def _nearest(surface: Surface, place: tuple[float, float, float]) -> int:
    return int(np.argmin(np.linalg.norm(surface.positions - place, axis=1)))


def _bump(surface: Surface, place: tuple[float, float, float], length: float) -> NDArray[np.float64]:
    return diffused(unit_mass(_nearest(surface, place), surface), surface, length, "bump")


def _heat(density: NDArray[np.float64]) -> NDArray[np.float64]:
    shares = density / density.max()
    painted = np.clip(shares / 0.2, 0.0, 1.0)[:, None]
    return (1.0 - painted) * _CLAY + painted * heat_colors(0.25 + 0.75 * shares)[:, :3]


def _photograph(obj: bpy.types.Object, rows: list[list[NDArray[np.float64]]]) -> None:
    points = np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])
    columns = max(map(len, rows))
    view = View(-math.pi / 2 + math.radians(20.0), math.radians(10.0))
    with Studio() as studio, TemporaryDirectory() as folder:
        for row, pictures in enumerate(rows):
            for column, colors in enumerate(pictures):
                shift = _STEP[0] * column * view.axes[0] - _STEP[1] * row * view.axes[1]
                own = studio.show(obj, tuple(shift))
                own.data = _painted(obj.data, colors)
        middle = points.mean(axis=0) + _STEP[0] * (columns - 1) / 2 * view.axes[0]
        middle = middle - _STEP[1] * (len(rows) - 1) / 2 * view.axes[1]
        studio.build([points - 100.0], view)
        studio.look_flat(Pose(middle + 50.0 * view.axes[2], view), _STEP[0] * columns, 200.0)
        studio.set_quality(_SIZE, 24)
        studio.render(Path(folder) / "densities.png")
        save_jpeg(Path(folder) / "densities.png", "densities", (_SIZE[0] * 3 // 4, _SIZE[1] * 3 // 4))


def _painted(mesh: bpy.types.Mesh, colors: NDArray[np.float64]) -> bpy.types.Mesh:
    copy = mesh.copy()
    attribute = copy.color_attributes.new("Heat", "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", np.column_stack([colors, np.ones(len(colors))]).astype(np.float32).ravel())
    copy.materials.clear()
    copy.materials.append(bpy.data.materials.get("Heat") or color_material("Heat", "Heat", ROUGHNESS))
    return copy


if __name__ == "__main__":
    main()
