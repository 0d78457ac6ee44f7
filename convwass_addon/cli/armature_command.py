# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``armature``."""

from __future__ import annotations

from argparse import Namespace

import bpy
import numpy as np

from ..applications.skeletons.inner_points import InnerPointFinder
from ..applications.skeletons.skeleton_fit import FittedSkeleton, fit_steps
from ..applications.skeletons.skeleton_settings import SkeletonSettings
from ..bridge.armatures.auto_weights import bind_with_weights, require_bindable
from ..bridge.armatures.fit_notices import short_notice, unweighted_notice
from ..bridge.armatures.fit_request import FitRequest
from ..bridge.armatures.pins import pin_joints, with_pins
from ..bridge.armatures.rig_graphs import RigGraph
from ..bridge.armatures.rig_imports import BodyAndRig, open_body_and_rig
from ..bridge.armatures.rigs import move_joints, require_movable, resting_body, rig_graph
from ..bridge.files.imports import parse_source
from ..console import ProgressBar
from ..errors import InputError
from .answer import Answer
from .from_schema import given_settings
from .reports import checked_outputs, note, saved


def run_armature(options: Namespace) -> Answer:
    """Fit an armature into a mesh and save the result.

    Raises
    ------
    InputError, ResourceError
        The body, rig, pins or options cannot be used.
    """
    target, report = checked_outputs(options, [options.body, options.rig])
    settings = SkeletonSettings(**given_settings(options, SkeletonSettings))
    request = FitRequest(**given_settings(options, FitRequest))
    with with_pins():
        return saved(target, report, _fitted(options, settings, request))


def _fitted(options: Namespace, settings: SkeletonSettings, request: FitRequest) -> dict[str, object]:
    """Fit the rig in the scene and return the record."""
    with ProgressBar("Reading the files") as bar:
        pair = open_body_and_rig(parse_source(options.body), parse_source(options.rig))
        bpy.context.view_layer.update()
        _check(pair, request.auto_weights)
        rig = rig_graph(pair.rig, only_deforming=request.bones == "deform")
        mesh = resting_body(pair.body, pair.rig, bpy.context.evaluated_depsgraph_get())
        bar.show(1.0, f"{pair.body.name}, {pair.rig.name}")
    rig.require_pins_apart()
    rig = _with_pins(options, rig, InnerPointFinder(mesh))
    if not rig.graph.pinned.any():
        raise InputError("No joint is pinned; name some with --pin, such as {example}.", example=rig.graph.names[0])
    with ProgressBar("Fitting the armature") as bar:
        found = bar.result_of(fit_steps(mesh, rig.graph, settings))
    # Bones are measured before the joints move.
    pin_joints(pair.rig, rig, np.flatnonzero(rig.graph.pinned).tolist())
    short = move_joints(pair.rig, rig, found.positions)
    notices = [*found.notices, *short_notice(short)]
    record = _record(pair, rig, found)
    if request.auto_weights:
        record["unweighted"] = bind_with_weights(pair.body, pair.rig)
        notices += unweighted_notice(record["unweighted"], pair.body)
    note(*notices)
    return record


def _check(pair: BodyAndRig, has_weights: bool) -> None:
    """Raise InputError if the objects cannot be fitted or bound."""
    if pair.body == pair.rig:
        raise InputError("Both names refer to {object}; name a body and a skeleton.", object=pair.body.name)
    if pair.rig.type not in ("ARMATURE", "MESH"):
        raise InputError("{object} is not a skeleton; name an armature or a mesh of edges.", object=pair.rig.name)
    require_movable(pair.rig)
    if has_weights:
        require_bindable(pair.body, pair.rig)


def _with_pins(options: Namespace, rig: RigGraph, finder: InnerPointFinder) -> RigGraph:
    """Add the pins named on the command line to those of the rig."""
    places = {name: np.array(place) for name, place in options.pin if place is not None}
    for name, point in options.place:
        rig.joint(name)
        places[name] = finder.find(point).position
    return rig.pinned_at([name for name, place in options.pin if place is None], places)


def _record(pair: BodyAndRig, rig: RigGraph, found: FittedSkeleton) -> dict[str, object]:
    joints = {
        name: {
            "position": found.positions[joint].tolist(),
            "pinned": bool(rig.graph.pinned[joint]),
            "inside": bool(found.inside[joint]),
            "winding": float(found.winding[joint]),
            "projected": bool(found.projected[joint]),
        }
        for joint, name in enumerate(rig.graph.names)
    }
    notices = [str(notice) for notice in found.notices]
    return {"body": pair.body.name, "rig": pair.rig.name, "fit": found.record, "joints": joints, "notices": notices}
