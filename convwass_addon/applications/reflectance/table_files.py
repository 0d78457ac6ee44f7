# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of lobes as NumPy files, validated when read; nothing is unpickled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...array_files import ArrayReader, DamagedArraysError, array_bytes
from ...drafts import written_whole
from ...errors import InputError
from .lobe_table import LobeTable

_NAMES = ("theta_in", "phi_in", "lobes", "albedo")
MOST_DIRECTIONS, MOST_ROWS = 8100, 256
"""Largest numbers of incoming directions, and of rows of a lobe, that can be read."""

_FEWEST_ROWS = 4
_MOST_BYTES = 4 << 30
# Compression level of NumPy's own files.
_LEVEL = 6
# Lobes are stored in single precision; tolerance of their masses, which should be 1.
_MASS_TOLERANCE = 1e-3


def write_table(path: Path, table: LobeTable) -> None:
    """Write a table as ``.npz``: `theta_in`, `phi_in`, `lobes` (float32) and `albedo`, as in :class:`LobeTable`.

    The file is written completely or not at all.

    Raises
    ------
    ConvwassError
        The file could not be written.
    """
    arrays = {"theta_in": table.theta_in, "phi_in": table.phi_in, "albedo": table.albedo}
    content = array_bytes(arrays | {"lobes": table.lobes.astype(np.float32)}, level=_LEVEL)
    with written_whole(path) as draft:
        draft.write_bytes(content)


def read_table(path: Path) -> LobeTable:
    """Read a file of :func:`write_table`.

    Raises
    ------
    InputError
        The file cannot be read, or is not such a table.
    """
    try:
        with path.open("rb") as file:
            # Other programs may have written the file.
            reader = ArrayReader(file, _MOST_BYTES, is_sealed=False)
            arrays = [reader.take(name, ("<f4", "<f8"), (1, 2, 3)).astype(np.float64) for name in _NAMES]
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise InputError("{name} cannot be read: {problem}", name=path.name, problem=reason) from problem
    except DamagedArraysError as problem:
        raise InputError("{name} is not a table of lobes.", name=path.name) from problem
    return checked_table(*arrays, path.name)


def checked_table(
    theta: NDArray[np.float64],
    phi: NDArray[np.float64],
    lobes: NDArray[np.float64],
    albedo: NDArray[np.float64],
    name: str,
) -> LobeTable:
    """Create a table from the contents of a file if they are valid.

    Parameters
    ----------
    theta, phi : (d,) float64
        Incoming directions, in radians.
    lobes : (d, rows, 4 rows) float64
        One lobe per direction.
    albedo : (d, 3) float64
        Red, green and blue.
    name : str
        Name of the file for messages.

    Raises
    ------
    InputError
        Sizes that do not match, or invalid values.
    """
    fits = (
        theta.ndim == 1
        and 2 <= len(theta) <= MOST_DIRECTIONS
        and phi.shape == theta.shape
        and lobes.ndim == 3
        and len(lobes) == len(theta)
        and _FEWEST_ROWS <= lobes.shape[1] <= MOST_ROWS
        and lobes.shape[1] % 2 == 0
        and lobes.shape[2] == 4 * lobes.shape[1]
        and albedo.shape == (len(theta), 3)
    )
    if not fits:
        raise InputError("{name} is not a table of lobes.", name=name)
    finite = all(np.isfinite(array).all() for array in (theta, phi, lobes, albedo))
    if not finite or min(lobes.min(), albedo.min()) < 0:
        raise InputError("{name} has values that are invalid for a table of lobes.", name=name)
    if theta.min() < 0 or theta.max() >= np.pi / 2 or (not phi.any() and (np.diff(theta) <= 0).any()):
        raise InputError("{name} has values that are invalid for a table of lobes.", name=name)
    table = LobeTable(theta, phi, lobes, albedo)
    masses = (lobes * table.cells).sum(axis=(1, 2))
    if np.abs(masses - 1.0).max() > _MASS_TOLERANCE:
        raise InputError("{name} has values that are invalid for a table of lobes.", name=name)
    return LobeTable(theta, phi, lobes / masses[:, None, None], albedo)
