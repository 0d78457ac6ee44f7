# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of a command on standard output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Answer:
    """The result of a command: lines for people, or a record for programs.

    Attributes
    ----------
    record : dict
        The complete result, ready for JSON.
    lines : tuple of str
        Printed without ``--json``.
    """

    record: dict[str, object]
    lines: tuple[str, ...]

    @classmethod
    def of_files(cls, record: dict[str, object], written: Sequence[Path]) -> Answer:
        """Return an answer that lists the files written."""
        paths = [str(path) for path in written]
        return cls({**record, "written": paths}, tuple(paths))
