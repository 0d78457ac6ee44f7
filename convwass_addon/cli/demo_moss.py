# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface part of the demo: moss that grows over an animal."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from ..applications.densities.density_frames import DensityFrames
from ..applications.densities.density_paths import interpolation_steps
from ..applications.densities.density_settings import DensitySettings
from ..applications.densities.surface_densities import density_surface
from ..bridge.densities.density_material import growth_material
from ..bridge.densities.density_player import DensityKey, animate_density
from ..bridge.densities.density_store import StoredDensity
from ..bridge.files.blend_files import open_empty
from ..bridge.files.imports import import_objects
from ..bridge.files.output_paths import save_blend
from ..bridge.studio.photograph import set_up_photograph
from ..bridge.surfaces import surface_mesh
from ..bridge.vertex_groups import write_group
from ..progress import drained

_NAME = "Moss"
_SETTINGS = DensitySettings(steps=24, entropy_limit=None)
# Share of the height that counts as hooves.
_HOOVES = 0.06


def save_moss(shape: Path, target: Path) -> Path:
    """Animate moss that grows from the feet of an animal over its body, and save it as a .blend.

    Parameters
    ----------
    shape : Path
        The animal, Z up.
    target : Path
        The .blend to write.
    """
    open_empty()
    (obj,) = import_objects(shape, None)
    obj.data.shade_smooth()
    mesh = surface_mesh(obj, bpy.context.evaluated_depsgraph_get())
    height = mesh.vertices[:, 2] - mesh.bounds[0, 2]
    groups = {"Hooves": (height < _HOOVES * height.max()).astype(float), "Body": np.ones(len(height))}
    for name, weights in groups.items():
        write_group(obj, name, weights)
    work = interpolation_steps(*groups.values(), density_surface(mesh), _SETTINGS, tuple(groups))
    _play(obj, drained(work), list(groups))
    set_up_photograph(bpy.context.scene, obj)
    return save_blend(target)


def _play(obj: bpy.types.Object, frames: DensityFrames, groups: list[str]) -> None:
    scene = bpy.context.scene
    keys = [DensityKey(1, 0.0), DensityKey(5 * _SETTINGS.steps, 1.0)]
    stored = StoredDensity(inputs=groups, settings=_SETTINGS.as_dict(), records=frames.records)
    animate_density(obj, frames.covered, frames.times, _NAME, keys=keys, description=stored)
    # With a finer mesh, the edge of the moss can lie between the vertices of the original one.
    obj.modifiers.new("Finer", "SUBSURF").levels = 1
    obj.data.materials.clear()
    obj.data.materials.append(growth_material(_NAME, "MOSS"))
    scene.frame_start, scene.frame_end = 1, int(keys[-1].frame)
    scene.frame_set(scene.frame_end // 2)
