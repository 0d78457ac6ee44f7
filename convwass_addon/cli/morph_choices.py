# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpret and check the combined options of the command ``morph``."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path

import bpy

from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.frame_cache import FrameCache
from ..applications.morphs.layouts import Blend
from ..applications.one_mesh.texture_settings import TextureSettings
from ..bridge.files.output_paths import checked_target
from ..bridge.flat.choosing import refuse_volumes
from ..bridge.morphs.disk.exports import SUFFIXES
from ..bridge.morphs.inputs.followed_inputs import FOLLOW
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.morphs.outputs import SHAPE_KEYS, folder_beside
from ..errors import InputError
from .from_schema import given_options, given_settings

# Options and settings of a request that only apply to frames.
_OF_FRAMES = ("weights", "render", "at", "frames_range", "cache", "scheduler")
_SETTINGS_OF_FRAMES = ("layout", "follow", "steps", "flat_output", "faces", "looks", "grays", "between")
# Settings of a request that only apply to shape keys.
_SETTINGS_OF_SHAPE_KEYS = ("basis", "key_error", "symmetric", "two_meshes")


@dataclass(frozen=True)
class Between:
    """Fractional frame numbers such as 7.35, and the path that they refer to."""

    path: list[Blend]
    numbers: list[float]


@dataclass(frozen=True)
class Computing:
    """Where frames are computed and cached, and which frames are needed."""

    workers: int | None = None
    scheduler: str | None = None
    cache: FrameCache | None = None
    wanted: range | None = None
    between: Between | None = None


def flat_settings_of(options: Namespace) -> FlatSettings:
    """Return the settings of a morph of flat shapes.

    Raises
    ------
    InputError
        Some options do not apply to flat shapes.
    """
    if options.cache is not None or options.scheduler or options.at is not None or options.frames_range is not None:
        raise InputError(
            "Frames of flat shapes cannot be cached or computed on other machines; leave out --cache, --scheduler, "
            "--at and --frames-range."
        )
    refuse_volumes(options.output == "volume")
    return FlatSettings(**given_settings(options, FlatSettings) | {"parts": "none"})


def request_of(options: Namespace, target: Path) -> MorphRequest:
    """Return the request in terms of the operator Bake Morph, as it is stored; `target` is the .blend to write.

    Settings that do not apply to the shapes are stored too, as the operator does.
    """
    given = given_settings(options, MorphRequest)
    flat_output = "MESH" if _requiring_meshes(options) else given.get("flat_output", "CURVE")
    folder = folder_beside(target)
    if flat_output == "PICTURE":
        # Pictures are written before the .blend exists.
        folder = bpy.path.abspath(folder, start=str(target.parent))
    kinds = {"volume": "VOLUME", "player": "PLAYER", "pad": "PLAYER", "alembic": "CACHE", "usd": "CACHE"}
    own = {
        "output": kinds.get(options.output, "OBJECTS"),
        "folder": folder,
        "cache_format": "usd" if options.output == "usd" else "alembic",
        "words": getattr(options, "words", "mass").upper(),
        "flat_output": flat_output,
        "weights": options.weights,
        "at": options.at,
    }
    if options.weights is not None:
        own["layout"] = "BLEND"
    return MorphRequest(**given | own)


def _requiring_meshes(options: Namespace) -> list[str]:
    """Return the options that require frames to be meshes."""
    output = [] if options.output == "objects" else [f"--output {options.output}"]
    return output + [f"--{name}" for name in ("render", "export") if getattr(options, name)]


def refuse_unsuitable_output(options: Namespace, request: MorphRequest, blends: list[Blend]) -> None:
    """Raise InputError if the output cannot show the blends: a pad shows a sheet, a player or a cache shows a path."""
    if options.output in ("player", "alembic", "usd") and blends[0].frame is None:
        raise InputError(
            "--output {output} requires a path; sheets and single blends do not move. Choose another output.",
            output=options.output,
        )
    if options.output == "pad" and request.layout not in ("GRID", "TRIANGLE"):
        raise InputError(
            "--output pad requires a sheet; use --layout grid with four shapes or --layout triangle with three, or "
            "choose another output."
        )


def refuse_idle_options(options: Namespace) -> None:
    """Raise InputError if there are options that the output does not use."""
    if options.output == SHAPE_KEYS:
        _refuse_options_of_frames(options)
    else:
        _refuse_options_of_shape_keys(options)
        _refuse_other_frames(options)
    layout = given_settings(options, MorphRequest, ("layout",)).get("layout", "BLEND")
    if options.weights is not None and layout != "BLEND":
        raise InputError("--weights makes a single blend; leave out --layout.")
    given = given_options(options, TextureSettings)
    if given and not options.textures:
        raise InputError(
            "{option} requires --output shape-keys --textures; leave it out, or add both.", option=given[0]
        )


def _refuse_options_of_frames(options: Namespace) -> None:
    given = [f"--{name.replace('_', '-')}" for name in _OF_FRAMES if getattr(options, name)]
    given += given_options(options, MorphRequest, _SETTINGS_OF_FRAMES)
    if given:
        raise InputError("--output shape-keys makes one mesh without frames; leave out {option}.", option=given[0])


def _refuse_options_of_shape_keys(options: Namespace) -> None:
    if options.textures:
        raise InputError("--textures requires --output shape-keys, since frames have no common UV map.")
    given = given_options(options, MorphRequest, _SETTINGS_OF_SHAPE_KEYS)
    if given:
        raise InputError("{option} requires --output shape-keys; leave it out, or choose that output.", option=given[0])


def _refuse_other_frames(options: Namespace) -> None:
    """Raise InputError if frames of flat shapes are to be other objects than the meshes that an option requires."""
    chosen = given_settings(options, MorphRequest, ("flat_output",)).get("flat_output", "MESH")
    required = _requiring_meshes(options)
    if chosen != "MESH" and required:
        raise InputError(
            "{option} requires meshes; leave out --flat-output, or choose --flat-output mesh.", option=required[0]
        )


def between_of(options: Namespace, request: MorphRequest, path: list[Blend]) -> Between:
    """Return the requested frames between others.

    Raises
    ------
    InputError
        Other options exclude a path, or leave no frames to start from.
    """
    if request.layout != "PATH":
        raise InputError("--at requires a path; leave out --weights and --layout.")
    if request.follow == FOLLOW:
        raise InputError("--at requires inputs at rest; leave out --follow.")
    if options.frames_range is not None:
        raise InputError("--at makes blends, but --frames-range only fills the cache; choose one of them.")
    if options.cache is None:
        raise InputError("--at requires --cache FOLDER, which holds the frames that it starts from.")
    return Between(path, options.at)


def computing_of(options: Namespace, blends: list[Blend], between: Between | None) -> Computing:
    """Return where the blends are computed.

    Raises
    ------
    InputError
        Options exclude each other, or the path does not have the requested frames.
    """
    wanted = options.frames_range
    if options.workers is not None and options.scheduler:
        raise InputError("--workers uses threads of this machine, --scheduler other machines; choose one of them.")
    if wanted is not None:
        last = blends[-1].frame
        if last is None:
            raise InputError("--frames-range requires a path; sheets and single blends have no frames.")
        if wanted[-1] > last:
            raise InputError(
                "--frames-range {first}-{final}: the path has the frames 0-{last}.",
                first=wanted[0],
                final=wanted[-1],
                last=last,
            )
        if options.cache is None:
            raise InputError("--frames-range requires --cache FOLDER, the only place it writes to.")
        if options.render or options.export:
            raise InputError("--frames-range writes no scene; use --render and --export in the run without it.")
    cache = FrameCache(options.cache) if options.cache is not None else None
    return Computing(options.workers, options.scheduler, cache, wanted, between)


def export_format(path: Path) -> str:
    """Return the export format for the extension of a file.

    Raises
    ------
    InputError
        The extension is unknown, or the file cannot be written.
    """
    checked_target(path)
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(
            "--export {path}: the extension must be one of {endings}.", path=str(path), endings=", ".join(SUFFIXES)
        )
    return SUFFIXES[path.suffix.lower()]
