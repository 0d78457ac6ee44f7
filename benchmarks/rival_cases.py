# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One method between two shapes, in its own process: ``python -m benchmarks.rival_cases CASE OPTIONS``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from convwass_addon.applications.morphs.moved_room import Room

from .clock import Clock
from .coherence_cases import write_frames
from .processes import run_case
from .rival_measures import Passage
from .rivals import METHODS, TIMES, Ends, has_sdf_grids


def passage(paths: list[str], cells: int, method: str, keep: str | None = None) -> dict[str, object]:
    """Make the frames and measure them; `keep` is a file to write their meshes to, without its suffix."""
    if method == "sdf" and not has_sdf_grids():
        return {"missing": "needs Blender 5.0"}
    ends = Ends.read(paths, cells)
    clock = Clock()
    frames = METHODS[method](ends)
    used = clock.read()
    if keep is not None:
        write_frames(Path(keep), frames)
    # Limbs that swing may leave the grid of the two shapes.
    bounds = np.stack([mesh.bounds for mesh in (*frames, *ends.shapes)])
    lattice = ends.lattice.holding(Room(bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)))
    found = Passage.of(frames, ends.shapes, TIMES, lattice)
    return {
        "outside": found.outside,
        "detour": found.detour,
        "volumes": found.volumes.tolist(),
        "pieces": found.pieces,
        "handles": found.handles,
        "smallest": found.smallest,
        "arrival": found.arrival,
        **used,
    }


if __name__ == "__main__":
    run_case(passage)
