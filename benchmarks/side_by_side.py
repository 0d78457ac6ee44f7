# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs compared with alternatives in Blender: linear fade of volumes, Shrinkwrap as a shape key, SDF mix."""

from __future__ import annotations

from pathlib import Path

from .processes import measured

SHAPES = Path(__file__).resolve().parent.parent / "assets" / "shapes"
PAIRS = (("horse", "cow"), ("horse", "bird"), ("double_torus", "horse"), ("dolphins", "bird"))
"""Pairs of sample shapes."""
TITLES = {
    "fade": "Linear fade of volumes",
    "shrinkwrap": "Shrinkwrap as a shape key",
    "sdf": "SDF mix in Geometry Nodes",
    "transport": "Convwass, Transport",
    "automatic": "Convwass, Automatic",
}
"""Names of the methods, in display order."""

_HEADING = """
The same two meshes, centers of mass aligned, {cells} cells along the longest side; five frames including both ends.

outside    fraction of the volume in cells that neither shape touches, mean of the inner frames: moving material. It is
           zero for an SDF mix, and only the blur for a fade.
detour     W2 from the first shape to the middle frame plus W2 from there to the second, all of mass 1, over W2 from the
           first to the second: 1 if all mass moves straight, 1.41 if half of one shape is replaced by half of the other
volume     largest deviation of a frame's volume from the interpolated volume, relative to the latter
pieces     largest number of components in an inner frame; smallest is the smallest component's fraction of its frame
handles    largest number in an inner frame
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
    """Make the frames of one method in a separate process and return their measures; see `rival_cases.passage`."""
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
    # Avoids "-0.0".
    volume = round(100 * excess, 1) + 0.0
    return (
        f"{TITLES[method]:28} {percent(found['outside']):>8} {found['detour']:7.2f} {volume:+6.1f} % "
        f"{found['pieces']:7} {percent(found['smallest']):>9} {found['handles']:8} {percent(found['arrival']):>8} "
        f"{found['cpu']:7.1f}"
    )


def percent(share: float) -> str:
    """Format a fraction as a percentage; small ones with more digits."""
    if 0.0 < share < 1e-4:
        return "< 0.01 %"
    return f"{100 * share:.0f} %" if share >= 0.1 or share == 0 else f"{100 * share:.2g} %"
