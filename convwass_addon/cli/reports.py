# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of commands besides the .blend: JSON reports, and notes on standard error."""

from __future__ import annotations

import json
import sys
from argparse import ArgumentParser
from pathlib import Path

from ..drafts import written_whole


def add_output_options(parser: ArgumentParser, out: Path, report: str) -> None:
    """Add the output options of a command: ``--out``, ``--report`` and ``--json``.

    Parameters
    ----------
    parser : ArgumentParser
        The parser of the command, or one of its option groups.
    out : Path
        Default output file.
    report : str
        Help text of ``--report``.
    """
    parser.add_argument("--out", type=Path, metavar="FILE", default=out, help="the .blend to write (%(default)s)")
    parser.add_argument("--report", type=Path, metavar="FILE", help=report)
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def write_report(path: Path, record: dict[str, object]) -> None:
    """Write a record as JSON; raises ConvwassError if that fails."""
    with written_whole(path) as draft:
        draft.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def note(text: object) -> None:
    """Print a note for the user on standard error."""
    print(f"convwass: {text}", file=sys.stderr)
