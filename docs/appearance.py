# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a morph with colors, docs/pictures/appearance.jpg: ``python3 run.py python docs/appearance.py``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from numpy.typing import NDArray
from photographs import color_material, finer, sample_shape, save_jpeg

import convwass_addon
from convwass_addon.bridge.morphs.pictures.contact_sheet import render_contact_sheet
from convwass_addon.progress import drained

_SPOTS = 26


def main() -> None:
    """Paint two shapes, morph them and render the frames."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    for name, paint in (("horse", _spotted), ("bird", _banded)):
        _paint(finer(sample_shape(name), 2), paint)
    bpy.ops.convwass.bake_morph(frames=4, resolution=128, motion="TRANSPORT", reverse=True)
    morph = next(collection for collection in bpy.data.collections if collection.name.startswith("Morph"))
    with TemporaryDirectory() as folder:
        save_jpeg(drained(render_contact_sheet(morph, Path(folder) / "appearance.png")), "appearance")


def _paint(obj: bpy.types.Object, paint: Callable[[NDArray[np.float32]], NDArray[np.float64]]) -> None:
    """Color an object by the positions of its vertices, and add a material that shows the colors."""
    mesh = obj.data
    mesh.shade_smooth()
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    colors = np.ones((len(mesh.vertices), 4), dtype=np.float32)
    colors[:, :3] = paint(points.reshape(-1, 3))
    attribute = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", colors.ravel())
    mesh.materials.clear()
    mesh.materials.append(color_material(obj.name, "Paint"))


def _spotted(points: NDArray[np.float32]) -> NDArray[np.float64]:
    rng = np.random.default_rng(11)
    centers = points[rng.choice(len(points), _SPOTS, replace=False)]
    reach = rng.uniform(0.07, 0.16, _SPOTS)
    depth = (np.linalg.norm(points[:, None] - centers, axis=2) - reach).min(axis=1)
    inside = np.clip(0.5 - depth / 0.02, 0.0, 1.0)[:, None]
    return inside * [0.16, 0.06, 0.03] + (1.0 - inside) * [0.9, 0.84, 0.74]


def _banded(points: NDArray[np.float32]) -> NDArray[np.float64]:
    wave = np.clip(0.5 + 3.0 * np.sin(14.0 * points[:, 1]), 0.0, 1.0)[:, None]
    return wave * [0.05, 0.22, 0.55] + (1.0 - wave) * [0.85, 0.6, 0.1]


if __name__ == "__main__":
    main()
