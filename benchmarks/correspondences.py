# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Accuracy of soft maps on pairs of surfaces with known correspondence, compared with other methods."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean

from tools.environment import SetupError
from tools.peers import PeersEnvironment

from .deformed_pairs import PAIRS, shape_file
from .processes import PROJECT, measured, reports
from .soft_map_cases import RADII

_CASES, _PEERS = "benchmarks.soft_map_cases", "benchmarks.soft_map_peers"
# CPU seconds allowed for a run of pyFM; on a busy machine they also bound the wall seconds.
_LIMIT = 300.0

_TITLE = """
Error of maps: distance along the target to the true point, over the square root of the target's area, x 100 (Princeton
benchmark), mean / percentage of vertices below 0.05. The target is the source deformed and remeshed, with about
{vertices} vertices each. The methods know only the marked pairs of points.

floor      error of the vertex nearest to the true point
nearest    nearest point (Data Transfer), after the rigid motion that fits the truth best
inpainted  nearest points with similar normals, the rest filled in (robust weight transfer), after the same motion
pyFM       functional map, 30 functions, wave kernel signatures and landmarks;  ZoomOut  refined to 150
flips      percentage of off-center vertices that our map puts on the wrong side
CPU s      from meshes to points for all vertices
"""

_COLUMNS = (
    f"{'pair':14} {'pairs':>5} {'floor':>6} {'nearest':>11} {'inpainted':>11} {'pyFM':>11} {'ZoomOut':>11} "
    f"{'CPU s':>6} {'ours':>11} {'flips':>6} {'CPU s':>6}"
)


def main(meshes: Path | None, vertices: int) -> None:
    """Run all pairs and print the tables.

    Parameters
    ----------
    meshes : Path or None
        A folder with additional meshes, such as spot, blub and bob; pairs whose shape is missing are skipped.
    vertices : int
        Approximate number of vertices of each mesh.
    """
    environment = PeersEnvironment.of(PROJECT)
    try:
        environment.prepare_peers()
    except (SetupError, OSError) as error:
        print(f"\n{error}\nGoing on without pyFM.")
        environment = None
    print(_TITLE.format(vertices=vertices))
    print(_COLUMNS)
    curves = _Curves()
    with tempfile.TemporaryDirectory() as folder:
        for kind in PAIRS:
            file = shape_file(kind.shape, meshes)
            if file is None:
                print(f"{kind.name:14} no file of {kind.shape}; --meshes says where to look")
                continue
            path = str(Path(folder) / f"{kind.name}.npz")
            made = measured(_CASES, "make", name=kind.name, file=str(file.absolute()), path=path, vertices=vertices)
            rigid = {name: measured(_CASES, name, path=path) for name in ("nearest", "inpainted")}
            for landmarks in made["landmarks"]:
                found = {**rigid, **_functional_maps(environment, path, landmarks, folder)}
                found["ours"] = measured(_CASES, "ours", path=path, landmarks=landmarks)
                curves.add(found)
                _print_row(kind.name, landmarks, made["floor"], found)
    curves.print()


@dataclass
class _Curves:
    """Princeton curves of all methods over all rows."""

    rows: list[dict[str, dict[str, object]]] = field(default_factory=list)

    def add(self, found: dict[str, dict[str, object]]) -> None:
        """Add the results of all methods for one pair."""
        self.rows.append(found)

    def print(self) -> None:
        """Print each method's means over the rows that it has."""
        print("\nPercent of vertices whose error is below a radius, over all rows\n")
        print(f"{'':10}" + "".join(f"{radius:>7}" for radius in RADII) + f"{'mean':>8}{'worst':>8}")
        for name in ("nearest", "inpainted", "fitted", "refined", "ours"):
            own = [row[name] for row in self.rows if name in row]
            if own:
                shares = [mean(values) for values in zip(*(row["curve"] for row in own), strict=True)]
                means = [row["mean"] for row in own]
                label = {"fitted": "pyFM", "refined": "ZoomOut"}.get(name, name)
                print(
                    f"{label:10}"
                    + "".join(f"{share:7.1f}" for share in shares)
                    + f"{mean(means):8.2f}{max(means):8.2f}"
                )


def _functional_maps(
    environment: PeersEnvironment | None, path: str, landmarks: int, folder: str
) -> dict[str, dict[str, object]]:
    """Run pyFM if available, and evaluate its maps."""
    if environment is None:
        return {}
    files = {name: str(Path(folder) / f"{name}.npy") for name in ("fitted", "refined")}
    options = {"path": path, "landmarks": landmarks, **files}
    lines = reports(_PEERS, "functional_map", _LIMIT, program=environment.program, **options)
    if not lines:
        return {}
    found = {name: measured(_CASES, "matched", path=path, match=file) for name, file in files.items()}
    found["refined"]["seconds"] = lines[-1]["seconds"]
    return found


def _print_row(name: str, landmarks: int, floor: float, found: dict[str, dict[str, object]]) -> None:
    def shown(method: str) -> str:
        if method not in found:
            return f"{'-':>11}"
        curve = found[method]["curve"][RADII.index(0.05)]
        return f"{found[method]['mean']:7.2f}/{curve:3.0f}"

    def seconds(method: str) -> str:
        return f"{found[method]['seconds']:6.1f}" if method in found else f"{'-':>6}"

    ours = found["ours"]
    flips = f"{ours['flipped']:6.1f}" if "flipped" in ours else f"{'-':>6}"
    print(
        f"{name:14} {landmarks:5} {floor:6.2f} {shown('nearest')} {shown('inpainted')} {shown('fitted')} "
        f"{shown('refined')} {seconds('refined')} {shown('ours')} {flips} {seconds('ours')}",
        flush=True,
    )
