# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``density``."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

import numpy as np

from ..applications.densities.density_frames import DensityFrames
from ..applications.densities.density_graphs import propagation_steps
from ..applications.densities.density_measures import MEASURING_SUBSTEPS, distance_table_steps, measuring_steps
from ..applications.densities.density_paths import blend_steps, path_steps
from ..applications.densities.density_settings import DensitySettings
from ..applications.densities.surface_densities import heat_map
from ..applications.densities.vertex_distances import distances_from
from ..applications.whole_paths import path_with_suffix
from ..bridge.densities.density_attributes import require_free
from ..bridge.densities.density_material import heat_material
from ..bridge.densities.density_nodes import NAME
from ..bridge.densities.density_player import animate_density, keys_at
from ..bridge.densities.density_request import DensityRequest, path_request
from ..bridge.densities.density_store import StoredDensity
from ..bridge.densities.result_groups import require_unpainted, write_result
from ..bridge.files.imports import parse_source
from ..bridge.files.output_paths import checked_target, save_blend
from ..bridge.vertex_groups import group_names
from ..console import ProgressBar
from ..errors import InputError
from ..progress import Work, drained
from .answer import Answer
from .density_inputs import DensityScene, open_mesh
from .from_schema import given_settings
from .overwriting import refuse_overwriting
from .reports import note

_DIGITS = 6


def run_density(options: Namespace) -> Answer:
    """Run the task that the options select.

    Raises
    ------
    InputError, ResourceError
        The mesh, groups or options cannot be used.
    """
    if (options.start is None) != (options.end is None):
        raise InputError("--from and --to must be used together; name both groups.")
    if options.biased and not options.measure:
        raise InputError("--biased requires --measure; leave it out.")
    if options.distance_from and _chosen_limits(options):
        raise InputError("--distance-from does not iterate; leave out --tolerance and --max-iterations.")
    target = _target(options)
    usual = {} if _makes_densities(options) else {"substeps": MEASURING_SUBSTEPS}
    settings = DensitySettings(**usual | given_settings(options, DensitySettings))
    with ProgressBar("Reading the mesh") as bar:
        scene = open_mesh(options.mesh, settings)
        bar.show(1.0, options.mesh)
    note(*scene.notices)
    if options.measure:
        return _measured(options, scene, settings)
    if options.matrix:
        return _matrix(options, scene)
    if options.distance_from:
        return _distances(options, scene, target)
    if options.propagate:
        return _propagated(options, scene, settings, target)
    if options.blend:
        return _blended(options, scene, settings, target)
    return _animated(options, scene, settings, target)


def _chosen_limits(options: Namespace) -> dict[str, object]:
    """Return the stopping criteria that were given; the defaults depend on the task."""
    return given_settings(options, DensitySettings, only=("tolerance", "max_iterations"))


def _makes_densities(options: Namespace) -> bool:
    return bool(options.end is not None or options.through or options.blend or options.propagate)


def _target(options: Namespace) -> Path | None:
    """Return the file to write, checked before the work begins, or None."""
    if options.out is None and not _makes_densities(options):
        return None
    if options.out is not None and (options.measure or options.matrix):
        raise InputError("Distances between groups are printed, not written to a file; leave out --out.")
    target = checked_target(path_with_suffix(options.out or "density.blend", ".blend"))
    refuse_overwriting([parse_source(options.mesh).path], [target])
    return target


def _animated(options: Namespace, scene: DensityScene, settings: DensitySettings, target: Path) -> Answer:
    name = options.name or NAME
    # Checked before the work begins.
    require_free(scene.object, name)
    names = options.through or [options.start, options.end]
    weights = [scene.weights(name) for name in names]
    frames = _frames(path_steps(weights, names, scene.surface, settings))
    stops = [scene.first_frame + place * settings.steps for place in range(len(names))]
    request = DensityRequest(**given_settings(options, DensityRequest))
    own = path_request(scene.object, weights, settings, request, stops)
    stored = StoredDensity(inputs=list(names), settings=own, records=frames.records)
    shown = frames.covered if request.trail else frames.densities
    animate_density(
        scene.object, shown, frames.times, name, keys=keys_at(stops), easing=request.easing, description=stored
    )
    if not any(scene.object.data.materials):
        scene.object.data.materials.append(heat_material(name))
    scene.play_to(stops[-1])
    record = {"object": scene.object.name, "settings": settings.as_dict(), "frames": frames.records}
    return Answer.of_files(record, [save_blend(target)])


def _blended(options: Namespace, scene: DensityScene, settings: DensitySettings, target: Path) -> Answer:
    names, shares = list(options.blend), list(options.blend.values())
    group = options.name or "Blend"
    require_unpainted(scene.object, group)
    weights = [scene.weights(name) for name in names]
    frames = _frames(blend_steps(weights, names, shares, scene.surface, settings))
    shown = heat_map(frames.densities[0])
    write_result(scene.object, group, shown.weights)
    record = {"object": scene.object.name, "settings": settings.as_dict(), "frames": frames.records}
    return Answer.of_files({**record, "scale": shown.scale}, [save_blend(target)])


def _propagated(options: Namespace, scene: DensityScene, settings: DensitySettings, target: Path) -> Answer:
    names = list(dict.fromkeys(name for pair in options.propagate for name in pair))
    known = {place: scene.weights(name) for place, name in enumerate(names) if scene.stands_for_weights(name)}
    edges = [(names.index(first), names.index(second)) for first, second in options.propagate]
    frames = _frames(propagation_steps(edges, known, scene.surface, settings, names))
    scales = {}
    for place, name in enumerate(names):
        if place not in known:
            shown = heat_map(frames.densities[place])
            write_result(scene.object, name, shown.weights)
            scales[name] = shown.scale
    record = {"object": scene.object.name, "settings": settings.as_dict(), "frames": frames.records, "scales": scales}
    return Answer.of_files(record, [save_blend(target)])


def _measured(options: Namespace, scene: DensityScene, settings: DensitySettings) -> Answer:
    first, second = options.measure
    found = drained(
        measuring_steps(
            scene.weights(first),
            scene.weights(second),
            scene.surface,
            (first, second),
            debias=not options.biased,
            match_pieces=settings.pieces == "match",
            **_chosen_limits(options),
        )
    )
    if not found.converged:
        note("the distance is less exact than requested; try a larger --blur or --max-iterations")
    record = {"object": scene.object.name, "groups": [first, second], **vars(found), "blur": scene.blur}
    return Answer({**record, "written": []}, (f"{found.squared if options.biased else found.length:.{_DIGITS}g}",))


def _matrix(options: Namespace, scene: DensityScene) -> Answer:
    groups = {name: scene.weights(name) for name in group_names(scene.object)}
    names = [name for name, weights in groups.items() if weights.any()]
    if len(names) < 2:
        raise InputError(
            "--matrix requires at least two vertex groups with weights; {object} has fewer. Paint some.",
            object=scene.object.name,
        )
    if len(names) < len(groups):
        note(f"empty groups ignored: {len(groups) - len(names)}")
    weights = [groups[name] for name in names]
    table = drained(distance_table_steps(weights, names, scene.surface, **_chosen_limits(options)))
    note(*table.notices)
    width = max(*map(len, names), _DIGITS + 6)
    cells = [["", *names], *([name, *map(_number, row)] for name, row in zip(names, table.lengths, strict=True))]
    lines = tuple("  ".join(cell.rjust(width) for cell in row) for row in cells)
    record = {"object": scene.object.name, "groups": names, "lengths": _plain(table.lengths)}
    figures = {"iterations": table.iterations, "marginal_error": table.marginal_error, "converged": table.converged}
    return Answer({**record, **figures, "blur": scene.blur, "written": []}, lines)


def _distances(options: Namespace, scene: DensityScene, target: Path | None) -> Answer:
    group = options.name or "Distance"
    if target is not None:
        require_unpainted(scene.object, group)
    found = distances_from(options.distance_from, scene.surface)
    note(*found.notices)
    reached = np.flatnonzero(np.isfinite(found.lengths))
    far = int(reached[found.lengths[reached].argmax()])
    shown = found.heat_map()
    written = []
    if target is not None:
        write_result(scene.object, group, shown.weights)
        written.append(str(save_blend(target)))
    record = {"object": scene.object.name, "from": options.distance_from, "furthest": far, "scale": shown.scale}
    record |= {"lengths": _plain(found.lengths), "blur": scene.blur, "written": written}
    line = f"farthest of {len(reached)} vertices reached is vertex {far}: {_number(found.lengths[far])}"
    return Answer(record, (line, *written))


def _frames(work: Work[DensityFrames]) -> DensityFrames:
    with ProgressBar("Moving the density") as bar:
        frames = bar.result_of(work)
    slack = sum(not record["converged"] for record in frames.records)
    if slack:
        note(
            f"{slack} of {len(frames.records)} frames are less exact than requested; try a larger --max-iterations, "
            "--blur or --entropy-limit"
        )
    return frames


def _plain(values: np.ndarray) -> list[object]:
    """Return numbers ready for JSON, with None for infinity."""
    return np.where(np.isfinite(values), values, None).tolist()


def _number(value: float) -> str:
    return f"{value:.{_DIGITS}g}" if np.isfinite(value) else "-"
