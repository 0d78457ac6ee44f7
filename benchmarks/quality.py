# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Accuracy and sharpness of blends: compared with exact blends, and by the topology of their surfaces."""

from __future__ import annotations

from pathlib import Path
from statistics import mean

from .clean_frames import print_clean_frames
from .coherence_pairs import half, twelve
from .meshing import print_meshes
from .processes import PROJECT, measured

_CASES = "benchmarks.quality_cases"
SHAPES = PROJECT / "assets" / "shapes"
PAIRS = (("horse", "bird"), ("octopus", "horse"), ("dolphins", "bird"))
"""Pairs of sample shapes."""
MESH_PAIRS = (("spot", "bob"), ("blub", "spot"))
"""Pairs from a folder of other meshes; names are prefixes of file names."""

_SETTINGS = (("default", None), ("sharpness 1", 1.0), ("sharpness 0", 0.0))

_ELLIPSOIDS = """
Overlap (intersection over union) with the exact blend of two ellipsoids, {cells} cells, t = 0.25, 0.5, 0.75: the pair
used in the tests and five random ones.

cells     the densest cells with the exact blend's volume, compared with the cells whose centers are inside it
exact     surface enclosing the exact blend's volume
linear    surface enclosing the interpolated volume, as in a morph; the exact blend's volume is larger
read      surface of the exact blend's own occupancy, extracted as in a morph: the error of the extraction alone
"""

_HANDLES = """
Topology of the surfaces of {frames} frames, {cells} cells.

shapes    components and handles of the two shapes at this resolution, extracted like the frames
frames    number with more handles, or more components, than either shape; with crumbs (components below 0.1 % of the
          volume); with bubbles
"""

_EDGES = """
Width in cells over which the density falls from 90 to 10 % of its plateau at t = 0.5, {cells} cells, and the width for
the two shapes. The inside of a barycenter is uneven, and cells below 90 % there count as well.
"""

_LEGS = """
A body on four legs of radius 1.5 cells and its image, {cells} cells: fraction of the legs inside the blend's surface.
The exact blends are known: the legs move, get shorter, or spread and widen to 2.4 cells.

read      surface of the exact blend's own occupancy, extracted as in a morph
"""

_THIN = """
Volume that a ball of radius 3 cells cannot enter, relative to the interpolated volume of this kind in the two shapes;
{cells} cells.
"""

_STABILITY = """
{frames} frames at default settings. Volume in % of the mean; center and surface in cells.

step      largest change between consecutive frames; for the surface, their mean distance
bend      largest second difference of the curve, and its frame
"""


def main(cells: int, meshes: Path | None, *, clean_only: bool = False, held_back: bool = False) -> None:
    """Run all cases and print the tables.

    Parameters
    ----------
    cells : int
        Along the longest side.
    meshes : Path or None
        A folder with additional meshes; their pairs are added if both files exist.
    clean_only : bool
        Check only whether frames are clean.
    held_back : bool
        Check this on all pairs that no parameter was tuned on, instead of on twelve pairs, half of which were used for
        tuning.
    """
    folder = None if meshes is None else str(meshes.absolute())
    print_clean_frames(half(meshes, tuned=False) if held_back else twelve(), cells, frames=24, meshes=folder)
    if clean_only:
        return
    pairs = [*((str(SHAPES / f"{a}.ply"), str(SHAPES / f"{b}.ply")) for a, b in PAIRS), *_further_pairs(meshes)]
    print_meshes(cells)
    _print_ellipsoids(cells)
    _print_handles(pairs, cells, frames=24)
    _print_edges(pairs, cells)
    _print_legs(cells)
    _print_thin(pairs, cells)
    _print_stability(pairs, sorted({48, cells}), frames=100)


def _further_pairs(folder: Path | None) -> list[tuple[str, str]]:
    found = []
    for names in MESH_PAIRS if folder is not None else ():
        files = [sorted(folder.glob(f"{name}*tri*.obj")) for name in names]
        if all(files):
            found.append((str(files[0][0].absolute()), str(files[1][0].absolute())))
    return found


def _print_ellipsoids(cells: int) -> None:
    print(_ELLIPSOIDS.format(cells=cells))
    heads = " ".join(f"{name:>16}" for name in ("cells", "exact", "linear", "read"))
    print(f"{'':14}{heads}\n{'':14}" + " ".join(f"{'worst':>8} {'mean':>7}" for _ in range(4)))
    for name, sharpness in _SETTINGS:
        found = measured(_CASES, "ellipsoids", cells=cells, sharpness=sharpness)
        values = [found[kind] for kind in ("cells", "exact", "linear", "possible")]
        print(f"{name:14}" + " ".join(f"{min(v):8.4f} {mean(v):7.4f}" for v in values), flush=True)


def _print_handles(pairs: list[tuple[str, str]], cells: int, frames: int) -> None:
    print(_HANDLES.format(cells=cells, frames=frames))
    print(
        f"{'pair':15} {'settings':12} {'shapes: pieces':>14} {'handles':>8}   "
        f"{'frames: handles':>15} {'pieces':>7} {'crumbs':>7} {'bubbles':>8}"
    )
    for pair in pairs:
        for name, sharpness in _SETTINGS[:2]:
            found = measured(_CASES, "handles", paths=pair, cells=cells, frames=frames, sharpness=sharpness)
            ends = found["ends"]
            extra = _extra(ends, found["frames"])
            pieces, handles = (",".join(str(end[kind]) for end in ends) for kind in ("pieces", "handles"))
            counts = [len(extra[kind]) for kind in ("handles", "pieces", "crumbs", "cavities")]
            print(
                f"{_shown(pair):15} {name:12} {pieces:>14} {handles:>8}   "
                f"{counts[0]:>15} {counts[1]:>7} {counts[2]:>7} {counts[3]:>8}",
                flush=True,
            )
            for kind in ("handles", "pieces"):
                if extra[kind]:
                    listed = " ".join(f"{frame}(+{more})" for frame, more in extra[kind].items())
                    print(f"{'':15} {kind} too many at frame: {listed}", flush=True)


def _extra(ends: list[dict[str, int]], frames: list[dict[str, int]]) -> dict[str, dict[int, int]]:
    """Return, by kind, the frames with more of it than either shape, and the excess; crumbs always count."""
    found = {}
    for kind in ("handles", "pieces", "crumbs", "cavities"):
        allowed = 0 if kind == "crumbs" else max(end[kind] for end in ends)
        excess = {frame: record[kind] - allowed for frame, record in enumerate(frames, start=1)}
        found[kind] = {frame: more for frame, more in excess.items() if more > 0}
    return found


def _print_edges(pairs: list[tuple[str, str]], cells: int) -> None:
    print(_EDGES.format(cells=cells))
    cases = [*((name, sharpness, None) for name, sharpness in _SETTINGS)]
    cases += [("paper, N / 40", 0.0, cells / 40), ("1, N / 40", 1.0, cells / 40)]
    print(f"{'pair':15} {'shapes':>12} " + " ".join(f"{name:>14}" for name, _, _ in cases))
    for pair in pairs:
        found = [measured(_CASES, "edges", paths=pair, cells=cells, sharpness=s, blur=b) for _, s, b in cases]
        ends = ", ".join(f"{end:.2f}" for end in found[0]["ends"])
        print(f"{_shown(pair):15} {ends:>12} " + " ".join(f"{f['blend']:14.2f}" for f in found), flush=True)


def _print_legs(cells: int) -> None:
    print(_LEGS.format(cells=cells))
    print(f"{'legs':10} {'settings':22} {'t = 0.1':>8} {'0.5':>6} {'0.9':>6}   {'read: 0.1':>9} {'0.5':>6} {'0.9':>6}")
    cases = [*((name, s, "volume") for name, s in _SETTINGS), ("default, half-maximum", None, "half-max")]
    for legs in ("moved", "shortened", "spread"):
        for name, sharpness, level in cases:
            found = measured(_CASES, "legs", cells=cells, motion=legs, sharpness=sharpness, level=level)
            a, b, c = (f"{100 * share:.0f} %" for share in found["kept"])
            x, y, z = (f"{100 * share:.0f} %" for share in found["possible"])
            print(f"{legs:10} {name:22} {a:>8} {b:>6} {c:>6}   {x:>9} {y:>6} {z:>6}", flush=True)


def _print_thin(pairs: list[tuple[str, str]], cells: int) -> None:
    print(_THIN.format(cells=cells))
    print(f"{'pair':15} {'settings':22} {'t = 0.1':>8} {'0.5':>6} {'0.9':>6}   {'thin share of the shapes':>24}")
    for pair in pairs:
        for name, sharpness, level in (("default", None, "volume"), ("default, half-maximum", None, "half-max")):
            found = measured(_CASES, "thin", paths=pair, cells=cells, sharpness=sharpness, level=level)
            a, b, c = (f"{100 * share:.0f} %" for share in found["share"])
            ends = ", ".join(f"{100 * end:.0f} %" for end in found["ends"])
            print(f"{_shown(pair):15} {name:22} {a:>8} {b:>6} {c:>6}   {ends:>24}", flush=True)


def _print_stability(pairs: list[tuple[str, str]], resolutions: list[int], frames: int) -> None:
    print(_STABILITY.format(frames=frames))
    heads = [f"{name + ': step':>14} {'bend':>6} {'frame':>6}" for name in ("volume", "center")]
    print(f"{'pair':15} {'cells':>6} {' '.join(heads)} {'surface: mean':>14} {'step':>6} {'bend':>6} {'frame':>6}")
    for pair in pairs:
        for cells in resolutions:
            found = measured(_CASES, "stability", paths=pair, cells=cells, frames=frames)
            curves = [found[kind] for kind in ("volume", "center")]
            line = " ".join(f"{c['step']:14.3f} {c['bend']:6.3f} {c['frame']:6}" for c in curves)
            surface = found["surface"]
            print(
                f"{_shown(pair):15} {cells:6} {line} {found['mean']:14.3f} {found['largest']:6.3f} "
                f"{surface['bend']:6.3f} {surface['frame']:6}",
                flush=True,
            )


def _shown(pair: tuple[str, str]) -> str:
    return " - ".join(Path(path).stem.partition("_")[0] for path in pair)
