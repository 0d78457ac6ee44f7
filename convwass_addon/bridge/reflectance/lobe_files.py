# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that hold highlights, whatever wrote them."""

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
"""How names of files end that hold whole tables."""


def is_whole(path: Path) -> bool:
    """Whether a file is called as one that holds a whole table, with all directions of one blend."""
    return path.name.lower().endswith(WHOLE)


def write_whole_table(path: Path, table: LobeTable) -> None:
    """Write a whole table, as its name says; raises InputError or ConvwassError where that does not go."""
    if path.suffix.lower() == ".npz":
        write_table(path, table)
    else:
        write_table_exr(path, table)


def read_whole_table(path: Path) -> LobeTable:
    """Read a file .npz, or .exr, as a whole table; raises InputError where it is none."""
    return read_table(path) if path.suffix.lower() == ".npz" else read_table_exr(path)


def read_lobe_file(path: Path) -> list[NDArray[np.float32]]:
    """Read a file as tables by half and difference angle, (64, 256, 3) each.

    Raises
    ------
    InputError
        The name ends otherwise, the file holds something else, or a material with a grain.
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
    raise InputError("{name} is no table of highlights; those end in .exr, .npz or .binary.", name=path.name)
