# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The verb ``reflect``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..applications.reflectance.lobe_interpolation import LobeBlend
from ..applications.reflectance.lobe_table import LobeTable
from ..applications.reflectance.materials import AshikhminShirley, BlinnPhong, Ggx, Material
from ..applications.reflectance.merl import read_merl
from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.reflectance.table_files import read_table, write_table
from ..bridge.files import checked_target
from ..bridge.reflectance.lobe_frames import LobeFrame, blended_frames, path_weights
from ..bridge.reflectance.lobe_images import write_lobe_exr
from ..console import ProgressBar
from ..errors import InputError
from .answer import Answer

# How many numbers every kind of material takes, and what makes it of them.
_KINDS = {
    "principled": ((1, 2), Ggx.principled),
    "ggx": ((2,), Ggx),
    "blinn": ((1,), BlinnPhong),
    "ashikhmin": ((2,), AshikhminShirley),
}


def run_reflect(options: Namespace) -> Answer:
    """Do what the command line asks for.

    Raises
    ------
    InputError
        Materials or options that cannot work.
    """
    target = checked_target(options.out)
    kind = target.suffix.lower()
    if kind not in (".npz", ".exr"):
        raise InputError("{name} ends neither in .npz nor in .exr.", name=target.name)
    if kind == ".npz" and options.steps is not None:
        raise InputError("A file .npz holds one blend; leave --steps out, or name a file .exr.")
    if options.steps is not None and options.steps < 2:
        raise InputError("--steps must be 2 or more.")
    settings = ReflectanceSettings(
        rows=options.rows, sigma=options.sigma, sharpness=options.sharpness, entropy=options.entropy
    )
    weights = _weights(options)
    blend = _blend(options.materials, settings)
    if kind == ".exr" and not blend.tables[0].is_isotropic:
        raise InputError("Materials with a grain fill no .exr; choose .npz.")
    frames = _solved(blend, weights)
    if kind == ".npz":
        write_table(target, frames[0].table)
    else:
        write_lobe_exr(target, [frame.image for frame in frames])
    record = {"materials": list(options.materials), "blends": [frame.record for frame in frames]}
    return Answer.of_files(record, [target])


def _weights(options: Namespace) -> NDArray[np.float64]:
    count = len(options.materials)
    if options.steps is not None:
        return path_weights(options.steps, count)
    return np.array([options.weights or [1.0] * count])


def _blend(words: Sequence[str], settings: ReflectanceSettings) -> LobeBlend:
    found = [_material(word) for word in words]
    tables = [own for own in found if isinstance(own, LobeTable)]
    if not tables:
        return LobeBlend.of(found, settings)
    if len(tables) < len(found):
        raise InputError("Tables go with tables only; write one of the other materials first.")
    return LobeBlend(tables, settings)


def _material(word: str) -> Material | LobeTable:
    """Make a material of a word, or read its file; raises InputError where it is neither."""
    path = Path(word)
    if path.suffix.lower() == ".binary":
        return read_merl(path)
    if path.suffix.lower() == ".npz":
        return read_table(path)
    kind, _, text = word.partition(":")
    counts, make = _KINDS.get(kind, ((), None))
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if make is None or len(values) not in counts:
        raise InputError("{word} is no material such as principled:0.3 or ggx:0.1,0.4, and no file.", word=word)
    return make(*values)


def _solved(blend: LobeBlend, weights: NDArray[np.float64]) -> list[LobeFrame]:
    frames = []
    with ProgressBar("Blending materials") as bar:
        for step in blended_frames(blend, weights):
            bar.show(step.fraction, str(step.message))
            if step.frame is not None:
                frames.append(step.frame)
    return frames
