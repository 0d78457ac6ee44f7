# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of files in a sequence for Blender."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

# As in Blender's render output.
_LEAST_DIGITS = 4


def file_number(frame: int, first: int) -> int:
    """Return the number in the name of the file of a scene frame, in a sequence that begins at the frame `first`.

    It is the frame itself, unless the sequence begins before 0: Blender does not read negative numbers.
    """
    return frame - min(first, 0)


def split_number(path: Path) -> tuple[str, str, str] | None:
    """Split a name as Blender does: the part before the last digits, the digits, and the rest; None without digits."""
    found = re.fullmatch(r"(.*?)([0-9]+)([^0-9]*)", path.stem)
    return None if found is None else (found.group(1), found.group(2), found.group(3) + path.suffix)


def with_number(path: Path, number: int) -> Path:
    """Return the path of another file of the same sequence; `path` has a number."""
    before, digits, after = split_number(path)
    return path.with_name(f"{before}{number:0{len(digits)}d}{after}")


def numbered_paths(folder: Path, before: str, suffix: str, numbers: Sequence[int]) -> list[Path]:
    """Return a numbered path for each number.

    All have the same number of digits, at least four: Blender does not find files with more digits than the first one.

    Parameters
    ----------
    folder : Path
        Folder of the files.
    before, suffix : str
        Parts before and after the number, such as "sky." and ".exr".
    numbers : sequence of int
        Non-negative numbers.
    """
    digits = max([_LEAST_DIGITS, *(len(str(number)) for number in numbers)])
    return [folder / f"{before}{number:0{digits}d}{suffix}" for number in numbers]
