# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``reflect``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..applications.reflectance.lobe_frames import LobeFrame, blended_frames, path_weights
from ..applications.reflectance.lobe_interpolation import LobeBlend
from ..applications.reflectance.lobe_table import LobeTable
from ..applications.reflectance.materials import AshikhminShirley, BlinnPhong, Ggx, Material
from ..applications.reflectance.merl import read_merl
from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.reflectance.weight_sheets import MOST_ON_PAD, PadSheet, spread_out, way_weights
from ..bridge.files.blend_files import open_empty
from ..bridge.files.output_paths import checked_target, save_blend
from ..bridge.reflectance.lobe_files import is_whole, read_whole_table, write_whole_table
from ..bridge.reflectance.lobe_images import write_lobe_exr
from ..bridge.reflectance.lobe_scene import show_on_balls
from ..console import ProgressBar
from ..errors import InputError
from ..progress import payloads
from .answer import Answer
from .from_schema import given_settings
from .overwriting import refuse_overwriting

# For every kind of material: how many parameters it may have, and its constructor.
_KINDS = {
    "principled": ((1, 2), Ggx.principled),
    "ggx": ((2,), Ggx),
    "blinn": ((1,), BlinnPhong),
    "ashikhmin": ((2,), AshikhminShirley),
}


def run_reflect(options: Namespace) -> Answer:
    """Blend materials and write the result.

    Raises
    ------
    InputError
        The materials or options cannot be used.
    """
    target = checked_target(options.out)
    kind = target.suffix.lower()
    _check_kind(target, kind, options)
    refuse_overwriting(map(Path, options.materials), [target])
    settings = ReflectanceSettings(**given_settings(options, ReflectanceSettings))
    sheet = None if options.pad is None else PadSheet.of(len(options.materials), options.pad)
    weights = _weights(options) if sheet is None else sheet.weights
    blend = _blend(options.materials, settings)
    if kind == ".exr" and not is_whole(target) and not blend.tables[0].is_isotropic:
        raise InputError("Anisotropic materials need all directions; choose .npz or .lobes.exr.")
    frames = _solved(blend, weights)
    shown = frames if sheet is None else spread_out(sheet, frames)
    if is_whole(target):
        write_whole_table(target, frames[0].table)
    elif kind == ".exr":
        write_lobe_exr(target, [frame.image for frame in shown])
    else:
        open_empty()
        show_on_balls(options.materials, shown, sheet)
        save_blend(target)
    record = {"materials": list(options.materials), "blends": [frame.record for frame in frames]}
    return Answer.of_files(record, [target])


def _check_kind(target: Path, kind: str, options: Namespace) -> None:
    """Raise InputError if the file format cannot hold the result."""
    if kind not in (".npz", ".exr", ".blend"):
        raise InputError("{name} does not end in .npz, .exr or .blend.", name=target.name)
    if is_whole(target) and (options.steps is not None or options.pad is not None):
        raise InputError(
            ".npz and .lobes.exr files hold one blend; leave out --steps and --pad, or name a different .exr file."
        )
    if options.steps is not None and options.steps < 2:
        raise InputError("--steps must be 2 or more.")
    if options.pad is not None and not 2 <= options.pad <= MOST_ON_PAD:
        raise InputError("--pad must be 2 to {most}.", most=MOST_ON_PAD)
    if options.pad is not None and (options.steps is not None or options.weights):
        raise InputError("--pad covers all weights; leave out --steps and --weights.")
    if options.weights and len(options.weights) > 1 and options.steps is None:
        raise InputError("Several --weights define a path; set the number of blends on it with --steps.")
    if options.weights and len(options.weights) == 1 and options.steps is not None:
        raise InputError("A single --weights defines one blend; leave out --steps, or give more --weights.")


def _weights(options: Namespace) -> NDArray[np.float64]:
    count = len(options.materials)
    if options.steps is not None:
        return way_weights(options.weights, options.steps) if options.weights else path_weights(options.steps, count)
    return np.array([options.weights[0] if options.weights else [1.0] * count])


def _blend(words: Sequence[str], settings: ReflectanceSettings) -> LobeBlend:
    found = [_material(word) for word in words]
    tables = [own for own in found if isinstance(own, LobeTable)]
    if not tables:
        return LobeBlend.of(found, settings)
    if len(tables) < len(found):
        raise InputError("Tables can only be blended with tables; write the other materials as tables first.")
    return LobeBlend(tables, settings)


def _material(word: str) -> Material | LobeTable:
    """Parse a material or read its file; raises InputError if it is neither."""
    path = Path(word)
    if path.suffix.lower() == ".binary":
        return read_merl(path)
    if path.suffix.lower() in (".npz", ".exr"):
        return read_whole_table(path)
    kind, _, text = word.partition(":")
    counts, make = _KINDS.get(kind, ((), None))
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if make is None or len(values) not in counts:
        raise InputError("{word} is neither a material such as principled:0.3 or ggx:0.1,0.4, nor a file.", word=word)
    return make(*values)


def _solved(blend: LobeBlend, weights: NDArray[np.float64]) -> list[LobeFrame]:
    with ProgressBar("Blending materials") as bar:
        return list(payloads(bar.shown(blended_frames(blend, weights)), LobeFrame))
