# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a command answers on standard output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Answer:
    """What a command answers: lines for people, or a record for programs.

    Attributes
    ----------
    record : dict
        All that is known, ready for JSON.
    lines : tuple of str
        What is printed without ``--json``.
    """

    record: dict[str, object]
    lines: tuple[str, ...]

    @classmethod
    def of_files(cls, record: dict[str, object], written: Sequence[Path]) -> Answer:
        """Answer with the paths of the files that were written."""
        paths = [str(path) for path in written]
        return cls({**record, "written": paths}, tuple(paths))
