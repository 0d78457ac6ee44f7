# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Quality of level set meshes, compared with Blender's Remesh and OpenVDB's adaptive meshing."""

from __future__ import annotations

from .meshing_cases import METHODS
from .processes import measured

SHAPES = ("ball", "torus", "turned box", "horse", "octopus")

_HEADING = """
Shapes at {cells} cells, blurred as in a morph, meshed in several ways. Remesh receives the mesh of marching cubes and
uses voxels of one cell.

angle     first percentile and median of the smallest angles of all triangles, degrees
edges     first percentile, median and 99th percentile of the lengths, cells
off       mean distance of the vertices from the true surface, cells; turn: mean angle of their normals to the true ones
volume    difference from the volume of the shape
topology  difference of the Euler number from marching cubes, and number of edges without exactly two triangles
"""


def print_meshes(cells: int) -> None:
    """Mesh all shapes with all methods and print a table."""
    print(_HEADING.format(cells=cells))
    print(
        f"{'shape':11} {'method':23} {'triangles':>9} {'angle':>10} {'edges':>14} {'off':>6} {'turn':>5} {'volume':>8} "
        f"{'topology':>8} {'CPU':>6}"
    )
    for shape in SHAPES:
        for method in METHODS:
            found = measured("benchmarks.meshing_cases", "meshed", shape=shape, method=method, cells=cells)
            print(line(shape, method, found), flush=True)


def line(shape: str, method: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    off, turn = (
        "" if found[name] is None else f"{found[name]:.{places}f}" for name, places in (("off", 3), ("turn", 1))
    )
    edges = " ".join(f"{length:.2f}" for length in found["edges"])
    return (
        f"{shape:11} {method:23} {found['triangles']:9} {found['angle']:5.1f} {found['median_angle']:4.1f} {edges:>14} "
        f"{off:>6} {turn:>5} {100 * found['volume']:6.2f} % {found['euler']:3} {found['uneven']:4} {found['cpu']:6.3f}"
    )
