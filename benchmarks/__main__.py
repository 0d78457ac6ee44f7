# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure speed, memory and quality: ``python -m benchmarks [NAME] [OPTIONS]``; without a name, runs everything.

Every case runs in its own process, one after the other, with one BLAS thread, so that CPU seconds and peak memory are
its own. CPU seconds and not wall seconds, because other load on the machine stretches the latter.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from . import (
    coherence,
    constants,
    correspondences,
    files,
    flat,
    live,
    looks,
    mesh,
    meshing,
    midpoints,
    moments,
    morph,
    peers,
    quality,
    recolor,
    side_by_side,
    skeleton,
    sphere,
    surface,
    table1,
)


def main(arguments: list[str] | None = None) -> int:
    """Run the benchmarks named on the command line."""
    parser = argparse.ArgumentParser(prog="run.py bench", description=__doc__)
    names = parser.add_subparsers(title="benchmarks", metavar=" | ".join(ALL))
    for name, (module, add_options) in _BENCHMARKS.items():
        own = names.add_parser(name, help=module.__doc__)
        own.set_defaults(run=module.main)
        add_options(own)
    arguments = sys.argv[1:] if arguments is None else arguments
    for chosen in [arguments] if arguments else [[name] for name in ALL]:
        options = vars(parser.parse_args(chosen))
        options.pop("run")(**options)
    return 0


def _add_morph(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resolutions", type=_numbers, default="64,100", help="cells along the longest side (%(default)s)"
    )
    parser.add_argument("--frames", type=int, default=24, help="frames of the morph (%(default)s)")


def _add_live(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resolutions", type=_numbers, default="48,64,100", help="cells along the longest side (%(default)s)"
    )


def _add_files(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--cells", type=int, default=100, help="cells along the longest side (%(default)s)")
    parser.add_argument("--frames", type=int, default=24, help="frames of the morph (%(default)s)")


def _add_flat(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--resolutions", type=_numbers, default="256,512", help="cells along a side (%(default)s)")
    parser.add_argument("--frames", type=int, default=24, help="frames of the morph (%(default)s)")
    parser.add_argument("--side", type=int, default=256, help="cells along a side of the images (%(default)s)")
    parser.add_argument(
        "--limit", type=float, default=300.0, help="maximum CPU seconds per run of a peer (%(default)s)"
    )
    parser.add_argument("--peer-python", type=Path, help="a Python that has POT; by default one is prepared")


def _add_looks(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--cells", type=int, default=100, help="cells along the longest side (%(default)s)")
    parser.add_argument("--meshes", type=Path, help="a folder with further meshes: spot and blub")


def _add_quality(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--cells", type=int, default=64, help="cells along the longest side (%(default)s)")
    parser.add_argument("--meshes", type=Path, help="a folder with further meshes, such as spot and bob")
    parser.add_argument(
        "--clean-only", action="store_true", help="measure only whether the frames of twelve pairs are clean"
    )
    parser.add_argument("--held-back", action="store_true", help="all pairs that no parameter was tuned on")
    parser.add_argument(
        "--meshing-only", action="store_true", help="only compare meshes with those of Blender's Remesh"
    )
    parser.set_defaults(run=_run_quality)


def _run_quality(cells: int, meshes: Path | None, *, meshing_only: bool, **options: bool) -> None:
    if meshing_only:
        meshing.print_meshes(cells)
    else:
        quality.main(cells, meshes, **options)


def _add_coherence(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--pairs", type=_names, help="names of pairs, separated by commas; by default all of one half")
    parser.add_argument("--motions", type=_names, help="motions, separated by commas; by default all")
    parser.add_argument("--frames", type=int, default=24, help="frames of the morph (%(default)s)")
    parser.add_argument("--resolution", type=int, default=100, help="cells along the longest side (%(default)s)")
    parser.add_argument("--held-back", action="store_true", help="the pairs that no parameter was tuned on")
    parser.add_argument("--meshes", type=Path, help="a folder with further meshes: spot, bob and blub")
    parser.add_argument(
        "--json", dest="as_json", action="store_true", help="a line of JSON per pair and motion instead of tables"
    )
    parser.add_argument("--sheets", type=Path, help="a folder to write pictures of every pair to")
    parser.add_argument("--maps", action="store_true", help="measure only the maps between the shapes")
    parser.add_argument("--guides", action="store_true", help="measure only how guides change these maps")
    parser.add_argument("--poses", action="store_true", help="measure only maps between people in many poses")


def _add_mesh(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--pairs", type=_names, help="names of pairs of coherence, separated by commas")
    parser.add_argument("--error", type=float, default=0.5, help="key error in percent (%(default)s)")
    parser.add_argument(
        "--json", dest="as_json", action="store_true", help="a line of JSON per pair instead of the table"
    )
    parser.add_argument("--keep", type=Path, help="a folder to write the keys to")


def _add_constants(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--cells", type=int, default=72, help="cells along each side (%(default)s)")


def _add_rivals(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--cells", type=int, default=100, help="cells along the longest side (%(default)s)")


def _add_table1(parser: argparse.ArgumentParser) -> None:
    sizes = ",".join(map(str, table1.SIZES))
    parser.add_argument("--sizes", type=_numbers, default=sizes, help="vertices of the meshes (%(default)s)")
    parser.add_argument("--trials", type=int, default=5, help="random pairs of densities per mesh (%(default)s)")
    parser.add_argument("--limit", type=float, default=60.0, help="maximum seconds per distance (%(default)s)")


def _add_surface(parser: argparse.ArgumentParser) -> None:
    sizes = ",".join(map(str, surface.SIZES))
    parser.add_argument("--sizes", type=_numbers, default=sizes, help="vertices of the meshes (%(default)s)")
    parser.add_argument("--steps", type=int, default=24, help="number of densities between the two (%(default)s)")


def _add_skeleton(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--meshes", type=Path, help="a folder with further meshes: spot, blub and bob")


def _add_softmap(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--meshes", type=Path, help="a folder with further meshes: spot, blub and bob")
    parser.add_argument(
        "--vertices", type=int, default=1000, help="approximate number of vertices of every mesh (%(default)s)"
    )


def _add_sphere(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--rows", type=_numbers, default="64,128", help="rows of the spheres (%(default)s)")


def _add_peers(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resolutions", type=_numbers, default="64,100", help="cells along the longest side (%(default)s)"
    )
    parser.add_argument("--side", type=int, default=256, help="cells along a side of the images (%(default)s)")
    sizes = ",".join(map(str, midpoints.SIZES))
    parser.add_argument("--sizes", type=_numbers, default=sizes, help="vertices of the surfaces (%(default)s)")
    parser.add_argument(
        "--limit", type=float, default=300.0, help="maximum CPU seconds per run of a peer (%(default)s)"
    )


def _add_nothing(_parser: argparse.ArgumentParser) -> None:
    """Leave a benchmark without options."""


def _numbers(text: str) -> list[int]:
    return [int(part) for part in text.split(",")]


def _names(text: str) -> list[str]:
    return [part.strip() for part in text.split(",")]


_BENCHMARKS = {
    "morph": (morph, _add_morph),
    "live": (live, _add_live),
    "moments": (moments, _add_nothing),
    "files": (files, _add_files),
    "flat": (flat, _add_flat),
    "looks": (looks, _add_looks),
    "quality": (quality, _add_quality),
    "coherence": (coherence, _add_coherence),
    "mesh": (mesh, _add_mesh),
    "rivals": (side_by_side, _add_rivals),
    "table1": (table1, _add_table1),
    "surface": (surface, _add_surface),
    "skeleton": (skeleton, _add_skeleton),
    "softmap": (correspondences, _add_softmap),
    "recolor": (recolor, _add_nothing),
    "sphere": (sphere, _add_sphere),
    "peers": (peers, _add_peers),
    "constants": (constants, _add_constants),
}

ALL = tuple(_BENCHMARKS)
"""The names of all benchmarks."""


if __name__ == "__main__":
    sys.exit(main())
