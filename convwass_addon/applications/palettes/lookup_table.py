# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""3D lookup tables for color grading, written and read as .cube files (Adobe, Cube LUT Specification 1.0)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...drafts import written_whole
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control
from .interpolation import interpolated
from .lab_colors import linear_of_srgb, srgb_of_linear
from .recoloring import Recoloring

SIZES = (2, 129)
"""Smallest and largest number of colors along an edge."""

# A table of the largest size with twenty digits per number is smaller than this.
_MOST_BYTES = 1 << 28


@dataclass(frozen=True)
class LookupTable:
    """A 3D lookup table.

    Attributes
    ----------
    colors : (n, n, n, 3) float32
        Resulting colors for red (first axis), green and blue in even steps over the domain; inputs and outputs are
        sRGB-encoded.
    lowest, highest : (3,) float64
        Lower and upper corner of the domain.
    strength : float
        How far the colors of an image go when it is recolored: 0 leaves them as they are, 1 gives those of the table.
    """

    colors: NDArray[np.float32]
    lowest: NDArray[np.float64]
    highest: NDArray[np.float64]
    strength: float = 1.0

    def applied(self, encoded: NDArray[np.floating]) -> NDArray[np.floating]:
        """Look up colors, (3, ...), with trilinear interpolation; colors outside the domain are clamped."""
        steps = (len(self.colors) - 1) / (self.highest - self.lowest)
        places = np.empty((3, encoded[0].size), dtype=encoded.dtype)
        for channel, lowest, step, own in zip(encoded, self.lowest, steps, places, strict=True):
            np.subtract(channel.reshape(-1), float(lowest), out=own)
            own *= float(step)
        return interpolated(self._channels, places).reshape(encoded.shape)

    def beyond(self, encoded: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return how far colors, (3, ...), lie outside the domain, as do parts of a scene brighter than white."""
        ends = (own.astype(encoded.dtype).reshape(3, *[1] * (encoded.ndim - 1)) for own in (self.lowest, self.highest))
        return encoded - np.clip(encoded, *ends)

    @cached_property
    def _channels(self) -> NDArray[np.float32]:
        """Red, green and blue as separate arrays."""
        return np.ascontiguousarray(np.moveaxis(self.colors, -1, 0), dtype=np.float32)


def lookup_table(change: Recoloring, size: int = 65) -> LookupTable:
    """Apply a recoloring to a lattice of all colors.

    Parameters
    ----------
    change : Recoloring
        A recoloring with the desired strength; its edge-aware filter is ignored, because a table has no neighbors.
    size : int
        Number of colors along an edge; errors are measured in `docs/performance`.

    Raises
    ------
    InputError
        A size that other programs would not accept.
    """
    _check_size(size)
    steps = np.linspace(0.0, 1.0, size, dtype=np.float32)
    lattice = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"))
    found = np.clip(srgb_of_linear(change(linear_of_srgb(lattice))), 0.0, 1.0)
    return LookupTable(np.ascontiguousarray(np.moveaxis(found, 0, -1)), np.zeros(3), np.ones(3))


def write_cube(table: LookupTable, path: Path, title: str = "Convwass", control: Control = UNINTERRUPTED) -> None:
    """Write a table as a .cube file, red fastest; the file is written completely or not at all.

    Parameters
    ----------
    table : LookupTable
        The table.
    path : Path
        The file to write.
    title : str
        Title for other programs.
    control : Control
        Stops the work when cancelled.

    Raises
    ------
    ConvwassError
        The file could not be written.
    """
    size = len(table.colors)
    safe = "".join(letter for letter in title if letter.isprintable() and letter not in '"\\')[:80]
    head = [f'TITLE "{safe}"', f"LUT_3D_SIZE {size}"]
    for name, values in (("MIN", table.lowest), ("MAX", table.highest)):
        head.append(f"DOMAIN_{name} " + " ".join(f"{value:g}" for value in values))
    with written_whole(path) as draft, open(draft, "w", encoding="utf-8", newline="\n") as file:
        file.write("\n".join(head) + "\n")
        for layer in table.colors.transpose(2, 1, 0, 3):
            control.check()
            np.savetxt(file, layer.reshape(-1, 3), fmt="%.6f")


def read_cube(path: Path) -> LookupTable:
    """Read a .cube file with a 3D table.

    Raises
    ------
    InputError
        No such file, or not a valid 3D table; the message says what is wrong.
    """
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise InputError("{file} is too large for a .cube file.", file=str(path))
        lines = path.read_text(encoding="utf-8", errors="strict").splitlines()
    except OSError as error:
        raise InputError("{file} could not be read: {reason}", file=str(path), reason=str(error).strip()) from error
    except UnicodeDecodeError as error:
        raise InputError("{file} is not a .cube file: it is not text.", file=str(path)) from error
    return _table_of(lines, path)


def _table_of(lines: list[str], path: Path) -> LookupTable:
    words = [line.split() for line in lines if line.strip() and not line.lstrip().startswith("#")]
    named = [line[0][0].isalpha() and line[0].lower() not in ("nan", "inf") for line in words]
    head = [line for line, is_named in zip(words, named, strict=True) if is_named]
    rows = [line for line, is_named in zip(words, named, strict=True) if not is_named]
    sizes = [line[1] for line in head if line[0] == "LUT_3D_SIZE" and len(line) == 2]
    if len(sizes) != 1 or not (sizes[0].isascii() and sizes[0].isdigit() and len(sizes[0]) < 5):
        raise InputError("{file} contains no 3D table (LUT_3D_SIZE).", file=str(path))
    size = int(sizes[0])
    _check_size(size)
    if len(rows) != size**3 or any(len(row) != 3 for row in rows):
        raise InputError(
            "{file} does not contain the {count} colors of three numbers that it should.", file=str(path), count=size**3
        )
    lowest, highest = (_numbers(head, name, default, path) for name, default in (("MIN", 0.0), ("MAX", 1.0)))
    colors = _finite(rows, path).reshape(size, size, size, 3).transpose(2, 1, 0, 3)
    if not (highest > lowest).all():
        raise InputError("The domain of {file} is empty.", file=str(path))
    return LookupTable(np.ascontiguousarray(colors, dtype=np.float32), lowest, highest)


def _numbers(head: list[list[str]], name: str, default: float, path: Path) -> NDArray[np.float64]:
    found = [line[1:] for line in head if line[0] == f"DOMAIN_{name}" and len(line) == 4]
    return _finite(found[-1:], path)[0] if found else np.full(3, default)


def _finite(rows: list[list[str]], path: Path) -> NDArray[np.float64]:
    try:
        values = np.array(rows, dtype=np.float64)
    except ValueError:
        values = np.full(1, np.nan)
    if not np.isfinite(values).all() or np.abs(values).max() > 1e6:
        raise InputError("{file} contains values that are not numbers.", file=str(path))
    return values


def _check_size(size: int) -> None:
    if not SIZES[0] <= size <= SIZES[1]:
        raise InputError(
            "A table has between {least} and {most} colors along an edge, not {size}.",
            least=SIZES[0],
            most=SIZES[1],
            size=size,
        )
