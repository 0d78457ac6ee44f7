# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that hold highlights, whatever wrote them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...applications.reflectance.lobe_lookup import half_angle_table
from ...applications.reflectance.lobe_table import incoming_directions, tabulated
from ...applications.reflectance.merl import read_merl
from ...applications.reflectance.reflectance_settings import ReflectanceSettings
from ...applications.reflectance.table_files import read_table
from ...errors import InputError
from .lobe_images import HEIGHT, WIDTH, read_lobe_exr


def read_lobe_file(path: Path) -> list[NDArray[np.float32]]:
    """Read a file as tables by half and difference angle, (64, 256, 3) each.

    Raises
    ------
    InputError
        The name ends otherwise, the file holds something else, or a material with a grain.
    """
    kind = path.suffix.lower()
    if kind == ".exr":
        return read_lobe_exr(path)
    if kind == ".npz":
        return [half_angle_table(read_table(path), HEIGHT, WIDTH)]
    if kind == ".binary":
        default = ReflectanceSettings()
        table = tabulated(read_merl(path), incoming_directions(default.incoming, 1), default.rows)
        return [half_angle_table(table, HEIGHT, WIDTH)]
    raise InputError("{name} is no table of highlights; those end in .exr, .npz or .binary.", name=path.name)
