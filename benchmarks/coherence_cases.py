# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One pair of the coherence benchmark per process: ``python -m benchmarks.coherence_cases CASE OPTIONS``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.applications.motions.motion import Motion
from convwass_addon.applications.motions.remaining_distance import remaining_share
from convwass_addon.errors import ConvwassError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.outer_skin import outer_skin
from convwass_addon.schema import setting_of

from .blends import baked_frames
from .clock import Clock
from .coherence_guides import guided
from .coherence_maps import mapped
from .coherence_measures import (
    Along,
    Evenness,
    changes_of_topology,
    crossing_share,
    limb_errors,
    steps_between,
    worst_angle,
)
from .coherence_pairs import Ends, pairs_named
from .coherence_poses import posed
from .coherence_turned import turned
from .end_frames import EndLoss
from .processes import run_case
from .recorded_motions import recorded_motions
from .rival_measures import Connectivity

TRANSPORT = "transport"
"""The motion of a morph by transport alone."""

# Crossings are counted in every fourth frame.
_CROSSINGS_EVERY = 4


def motions() -> tuple[str, ...]:
    """Return the motions that the morph settings offer."""
    return tuple(choice.value for choice in setting_of(MorphSettings, "motion").choices)


def settings_for(motion: str, cells: int) -> MorphSettings:
    """Return the default settings with the given motion and resolution."""
    return MorphSettings(resolution=cells, motion=motion)


@dataclass(frozen=True)
class Bake:
    """A morph including its two shapes as the first and the last frame.

    Attributes
    ----------
    meshes : list of TriangleMesh
        In the space of the shapes; see :func:`outside` for the first and the last.
    times : (n,) float64
        From 0 to 1.
    records : list of dict
        The solver's record of every frame between the shapes.
    spacing : float
        Size of a cell.
    seconds : dict
        CPU and wall seconds.
    """

    meshes: list[TriangleMesh]
    times: NDArray[np.float64]
    records: list[dict[str, object]]
    spacing: float
    seconds: dict[str, float]

    @classmethod
    def of(cls, ends: Ends, settings: MorphSettings, frames: int) -> Bake:
        """Bake `frames` frames from one shape to the other with the application."""
        shapes = [ends.first, ends.second]
        clock = Clock()
        found = [frame for frame in baked_frames(shapes, frames, settings) if frame.mesh is not None]
        seconds = clock.read()
        times = np.array([0.0, *(frame.blend.weights[1] for frame in found), 1.0])
        meshes = [outside(ends.first), *(frame.mesh for frame in found), outside(ends.second)]
        spacing = Lattice.around(shapes, settings.resolution, settings.sigma).spacing
        return cls(meshes, times, [frame.record for frame in found], spacing, seconds)


def passage(
    pair: str, motion: str, cells: int, frames: int, meshes: str | None = None, keep: str | None = None
) -> dict[str, object]:
    """Bake one pair with one motion and measure the frames.

    Parameters
    ----------
    pair, motion : str
        Names.
    cells, frames : int
        Cells along the longest side, and frames of the morph.
    meshes : str, optional
        A folder with additional meshes.
    keep : str, optional
        A file to write the frames to, without its suffix.
    """
    (chosen,) = pairs_named([pair], None if meshes is None else Path(meshes))
    ends = chosen.ends()
    try:
        with recorded_motions() as recorded:
            bake = Bake.of(ends, settings_for(motion, cells), frames)
    except ConvwassError as error:
        return {"error": str(error)}
    if keep is not None:
        write_frames(Path(keep), bake.meshes)
    motion = recorded[-1] if recorded else None
    figures = {**held(bake, ends), **clean(bake, motion), "records": [_brief(record) for record in bake.records]}
    if motion is not None:
        figures["residual"] = remaining_share(motion, [ends.first, ends.second])
        figures["motion"] = bake.records[0]["motion"]
    return figures


def mapping(pair: str, meshes: str | None = None) -> dict[str, object]:
    """Map the shapes of one pair to each other; see :func:`.coherence_maps.mapped`."""
    (chosen,) = pairs_named([pair], None if meshes is None else Path(meshes))
    return mapped(chosen.ends())


def guiding(pair: str, meshes: str | None = None) -> dict[str, object]:
    """Map the shapes of one pair with guides; see :func:`.coherence_guides.guided`."""
    (chosen,) = pairs_named([pair], None if meshes is None else Path(meshes))
    return guided(chosen.ends())


def turning(pair: str, meshes: str | None = None) -> dict[str, object]:
    """Map one pair of people that face different ways with guides; see :func:`.coherence_turned.turned`."""
    (chosen,) = pairs_named([pair], None if meshes is None else Path(meshes))
    return turned(chosen.ends())


def held(bake: Bake, ends: Ends) -> dict[str, object]:
    """Measure the coherence of the frames."""
    along = Along.of(bake.meshes, bake.times)
    connectivities = [Connectivity.of(mesh) for mesh in (bake.meshes[0], bake.meshes[-1])]
    allowed = max(len(each.shares) for each in connectivities)
    pieces = [record["found"]["pieces"] for record in bake.records]
    limb = None if ends.limb is None else asdict(limb_errors(bake.meshes, bake.times, ends.limb))
    return {
        "pieces": max(pieces),
        "torn": float(np.mean([count > allowed for count in pieces])),
        "area": [float(along.area.min()), float(along.area.max())],
        "reach": float(along.reach.min()),
        "volume": float(np.abs(along.volume - 1.0).max()),
        "limb": limb,
        "residual": None,
        **bake.seconds,
    }


def clean(bake: Bake, motion: Motion | None = None) -> dict[str, object]:
    """Measure the evenness of the steps and the quality of the meshes; `motion` is the motion of the bake."""
    between = bake.meshes[1:-1]
    losses = [end_loss(bake, motion, end) for end in (0, 1)]
    return {
        **asdict(Evenness.of(steps_between(bake.meshes, bake.spacing))),
        "changes": changes_of_topology(bake.meshes),
        "detail": max(loss.detail for loss in losses),
        "lost_area": max(loss.area for loss in losses),
        "angle": min(worst_angle(mesh) for mesh in between),
        "crossing": max(crossing_share(mesh) for mesh in between[::_CROSSINGS_EVERY]),
        "triangles": int(np.mean([len(mesh.faces) for mesh in between])),
    }


def end_loss(bake: Bake, motion: Motion | None, end: int) -> EndLoss:
    """Return what the frame next to a shape has lost of the shape, moved by the motion."""
    beside = (1, -2)[end]
    frame, t = bake.meshes[beside], bake.times[beside]
    shape = bake.meshes[-end] if motion is None else motion.moved((1.0 - t, t))[end].mesh
    return EndLoss.of(outside(shape), frame, bake.spacing)


def outside(mesh: TriangleMesh) -> TriangleMesh:
    """Return the outer surface of bodies that overlap; frames have nothing of what is inside."""
    return outer_skin(mesh) or mesh


def read_frames(path: Path) -> list[TriangleMesh]:
    """Read the frames kept by a case."""
    with np.load(path) as stored:
        count = len(stored.files) // 2
        return [TriangleMesh(stored[f"vertices{i}"], stored[f"faces{i}"]) for i in range(count)]


def write_frames(path: Path, meshes: Sequence[TriangleMesh]) -> None:
    """Keep frames for :func:`read_frames`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    arrays = {f"{kind}{i}": getattr(mesh, kind) for i, mesh in enumerate(meshes) for kind in ("vertices", "faces")}
    np.savez_compressed(path, **arrays)


def _brief(record: dict[str, object]) -> dict[str, object]:
    return {key: record[key] for key in ("weights", "found", "mended", "motion") if key in record}


if __name__ == "__main__":
    run_case(passage, mapping, guiding, turning, posed)
