# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs beside what else Blender offers: a linear fade of volumes, Shrinkwrap as a shape key, a mix of distances."""

from __future__ import annotations

from pathlib import Path

from .processes import measured

SHAPES = Path(__file__).resolve().parent.parent / "assets" / "shapes"
PAIRS = (("horse", "cow"), ("horse", "bird"), ("double_torus", "horse"), ("dolphins", "bird"))
"""Of the sample shapes."""
TITLES = {
    "fade": "Linear fade of volumes",
    "shrinkwrap": "Shrinkwrap as a shape key",
    "sdf": "SDF mix in Geometry Nodes",
    "transport": "Convwass, Transport",
    "automatic": "Convwass, Automatic",
}
"""What the methods are called, in the order in which they are shown."""

_HEADING = """
The same two meshes, center of mass on center of mass, {cells} cells along the longest side; five frames with both ends.

outside    share of the volume in cells that neither shape touches, mean of the frames between: what is under way. A
           mix of distances never gets there, and a fade by no more than its blur.
detour     W2 from the first shape to the middle frame and on to the second, all of mass 1, over W2 from one to the
           other: 1 where all mass goes straight, 1.41 where half of one shape is replaced by half of the other
volume     of the frame that is farthest from the straight line between the volumes, relative to that line
pieces     the most of a frame between; smallest is the share that the smallest piece has of its frame
handles    the most of a frame between
arrival    intersection over union of the last frame and the second shape
"""
COLUMNS = (
    f"{'':28} {'outside':>8} {'detour':>7} {'volume':>8} {'pieces':>7} {'smallest':>9} {'handles':>8} {'arrival':>8} "
    f"{'CPU s':>7}"
)


def main(cells: int) -> None:
    """Print a table for every pair.

    Parameters
    ----------
    cells : int
        Along the longest side.
    """
    print(_HEADING.format(cells=cells))
    for pair in PAIRS:
        print(f"{' to '.join(pair).replace('_', ' ')}\n{COLUMNS}")
        for method in TITLES:
            print(line(method, passage(pair, cells, method)), flush=True)
        print()


def passage(pair: tuple[str, str], cells: int, method: str, keep: Path | None = None) -> dict[str, object]:
    """Make the frames of one method in a process of its own and return their figures; see `rival_cases.passage`."""
    paths = [str(SHAPES / f"{name}.ply") for name in pair]
    return measured(
        "benchmarks.rival_cases",
        "passage",
        paths=paths,
        cells=cells,
        method=method,
        keep=None if keep is None else str(keep),
    )


def line(method: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    if "missing" in found:
        return f"{TITLES[method]:28} {found['missing']}"
    excess = max((volume - 1.0 for volume in found["volumes"][1:-1]), key=abs)
    # Zero has no sign.
    volume = round(100 * excess, 1) + 0.0
    return (
        f"{TITLES[method]:28} {percent(found['outside']):>8} {found['detour']:7.2f} {volume:+6.1f} % "
        f"{found['pieces']:7} {percent(found['smallest']):>9} {found['handles']:8} {percent(found['arrival']):>8} "
        f"{found['cpu']:7.1f}"
    )


def percent(share: float) -> str:
    """Write a share; small ones with more places."""
    if 0.0 < share < 1e-4:
        return "< 0.01 %"
    return f"{100 * share:.0f} %" if share >= 0.1 or share == 0 else f"{100 * share:.2g} %"
