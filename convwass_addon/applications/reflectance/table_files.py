# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of lobes as files of NumPy's, checked when they are read; nothing in them is unpickled."""

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
"""Incoming directions, and rows of a lobe, that a table that is read may have."""

_FEWEST_ROWS = 4
_MOST_BYTES = 4 << 30
# That of NumPy's own compressed files.
_LEVEL = 6
# Lobes are stored in single precision, in which a mass of 1 is this near to it.
_MASS_TOLERANCE = 1e-3


def write_table(path: Path, table: LobeTable) -> None:
    """Write a table as ``.npz``: `theta_in`, `phi_in`, `lobes` (float32) and `albedo`, as :class:`LobeTable` has them.

    The file is there as a whole or not at all.

    Raises
    ------
    ConvwassError
        It cannot be written.
    """
    arrays = {"theta_in": table.theta_in, "phi_in": table.phi_in, "albedo": table.albedo}
    content = array_bytes(arrays | {"lobes": table.lobes.astype(np.float32)}, level=_LEVEL)
    with written_whole(path) as draft:
        draft.write_bytes(content)


def read_table(path: Path) -> LobeTable:
    """Read what :func:`write_table` has written.

    Raises
    ------
    InputError
        The file cannot be read, or is no such table.
    """
    try:
        with path.open("rb") as file:
            # Other programs may have made it.
            reader = ArrayReader(file, _MOST_BYTES, is_sealed=False)
            arrays = [reader.take(name, ("<f4", "<f8"), (1, 2, 3)).astype(np.float64) for name in _NAMES]
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise InputError("{name} cannot be read: {problem}", name=path.name, problem=reason) from problem
    except DamagedArraysError as problem:
        raise InputError("{name} is no table of lobes.", name=path.name) from problem
    return checked_table(*arrays, path.name)


def checked_table(
    theta: NDArray[np.float64],
    phi: NDArray[np.float64],
    lobes: NDArray[np.float64],
    albedo: NDArray[np.float64],
    name: str,
) -> LobeTable:
    """Make a table of what a file of this name holds, if it can be one.

    Parameters
    ----------
    theta, phi : (d,) float64
        Of the incoming directions, in radians.
    lobes : (d, rows, 4 rows) float64
        One for each.
    albedo : (d, 3) float64
        Red, green and blue.
    name : str
        Of the file.

    Raises
    ------
    InputError
        Sizes that do not go together, or values that no table has.
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
        raise InputError("{name} is no table of lobes.", name=name)
    finite = all(np.isfinite(array).all() for array in (theta, phi, lobes, albedo))
    if not finite or min(lobes.min(), albedo.min()) < 0:
        raise InputError("{name} has values that no table of lobes has.", name=name)
    if theta.min() < 0 or theta.max() >= np.pi / 2 or (not phi.any() and (np.diff(theta) <= 0).any()):
        raise InputError("{name} has values that no table of lobes has.", name=name)
    table = LobeTable(theta, phi, lobes, albedo)
    masses = (lobes * table.cells).sum(axis=(1, 2))
    if np.abs(masses - 1.0).max() > _MASS_TOLERANCE:
        raise InputError("{name} has values that no table of lobes has.", name=name)
    return LobeTable(theta, phi, lobes / masses[:, None, None], albedo)
