# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of files that Blender plays as one sequence."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

# As Blender numbers what it renders.
_LEAST_DIGITS = 4


def numbered_paths(folder: Path, before: str, suffix: str, numbers: Sequence[int]) -> list[Path]:
    """Return a path for each number, between what comes before it and the ending.

    All of them have as many digits as the largest one, four at least: Blender finds no file with more digits than the
    first one has.

    Parameters
    ----------
    folder : Path
        Where they are.
    before, suffix : str
        Such as "sky." and ".exr".
    numbers : sequence of int
        0 or more.
    """
    digits = max([_LEAST_DIGITS, *(len(str(number)) for number in numbers)])
    return [folder / f"{before}{number:0{digits}d}{suffix}" for number in numbers]
