# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a density along a mesh from one vertex to another, and store every step as a vertex group.

python3 run.py python docs/scripts/density_flow.py assets/shapes/cow.ply --start 0 --end 900 --steps 6 --out flow.blend

The computation is a generator on arrays, run by a loop; the results are written to Blender afterwards.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from convwass_addon.applications.densities.density_paths import interpolation_steps
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.densities.density_tools import diffused, unit_mass
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.surfaces import read_surface
from convwass_addon.bridge.vertex_groups import as_weights, write_group
from convwass_addon.progress import drained


def main() -> None:
    """Read a mesh, move the density, write the groups."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("mesh", type=Path)
    parser.add_argument("--start", type=int, default=0, help="number of a vertex")
    parser.add_argument("--end", type=int, required=True, help="number of another one")
    parser.add_argument("--steps", type=int, default=6)
    parser.add_argument("--out", type=Path, default=Path("flow.blend"))
    options = parser.parse_args()

    bpy.ops.wm.read_factory_settings(use_empty=True)
    (obj,) = import_objects(options.mesh, None)
    mesh = read_surface(obj, bpy.context.evaluated_depsgraph_get()).mesh
    surface = density_surface(mesh)

    # A spot at each end: the mass of one vertex, spread over a twentieth of the size of the surface.
    width = 0.05 * mesh.area**0.5
    ends = [diffused(unit_mass(vertex, surface), surface, width, "the spot") for vertex in (options.start, options.end)]
    steps = interpolation_steps(*ends, surface, DensitySettings(steps=options.steps))
    frames = drained(steps)

    for number, (density, record) in enumerate(zip(frames.densities, frames.records, strict=True)):
        write_group(obj, f"Flow {number:02d}", as_weights(density))
        print(f"Flow {number:02d}: time {record['time']:.2f}, densest at vertex {int(density.argmax())}")
    bpy.ops.wm.save_as_mainfile(filepath=str(options.out.absolute()))


if __name__ == "__main__":
    main()
