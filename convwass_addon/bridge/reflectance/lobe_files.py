# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read and write files of highlights in all supported formats."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...applications.reflectance.lobe_lookup import half_angle_table
from ...applications.reflectance.lobe_table import LobeTable, incoming_directions, tabulated
from ...applications.reflectance.merl import read_merl
from ...applications.reflectance.reflectance_settings import ReflectanceSettings
from ...applications.reflectance.table_files import read_table, write_table
from ...errors import InputError
from .lobe_images import holds_whole_table, read_lobe_exr, read_table_exr, write_table_exr

WHOLE = (".npz", ".lobes.exr")
"""Extensions of files that store whole tables."""


def is_whole(path: Path) -> bool:
    """Return whether the name of a file is that of a whole table, with all directions of one blend."""
    return path.name.lower().endswith(WHOLE)


def write_whole_table(path: Path, table: LobeTable) -> None:
    """Write a whole table in the format of its extension; raises InputError or ConvwassError on failure."""
    if path.suffix.lower() == ".npz":
        write_table(path, table)
    else:
        write_table_exr(path, table)


def read_whole_table(path: Path) -> LobeTable:
    """Read a whole table from an .npz or .exr file; raises InputError if it is something else."""
    return read_table(path) if path.suffix.lower() == ".npz" else read_table_exr(path)


def read_lobe_file(path: Path) -> list[NDArray[np.float32]]:
    """Read a file as tables by half and difference angle, (64, 256, 3) each.

    Raises
    ------
    InputError
        Unknown extension, another content, or an anisotropic material.
    """
    kind = path.suffix.lower()
    if kind == ".exr" and not holds_whole_table(path):
        return read_lobe_exr(path)
    if kind in (".npz", ".exr"):
        return [half_angle_table(read_whole_table(path))]
    if kind == ".binary":
        default = ReflectanceSettings()
        table = tabulated(read_merl(path), incoming_directions(default.incoming, 1), default.rows)
        return [half_angle_table(table)]
    raise InputError("{name} is not a table of highlights; those end in .exr, .npz or .binary.", name=path.name)
