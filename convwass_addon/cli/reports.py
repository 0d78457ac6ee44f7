# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What commands write besides the .blend: reports as JSON, and notes on standard error."""

from __future__ import annotations

import json
import sys
from argparse import ArgumentParser
from pathlib import Path

from ..drafts import written_whole


def add_output_options(parser: ArgumentParser, out: Path, report: str) -> None:
    """Add the options of what a command writes: ``--out``, ``--report`` and ``--json``.

    Parameters
    ----------
    parser : ArgumentParser
        Of the command, or a group of its options.
    out : Path
        The .blend that is written where no other is named.
    report : str
        What the help says of the report.
    """
    parser.add_argument("--out", type=Path, metavar="FILE", default=out, help="the .blend to write (%(default)s)")
    parser.add_argument("--report", type=Path, metavar="FILE", help=report)
    parser.add_argument("--json", action="store_true", help="print it as JSON")


def write_report(path: Path, record: dict[str, object]) -> None:
    """Write a record as JSON; raises ConvwassError where that cannot be."""
    with written_whole(path) as draft:
        draft.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def note(text: object) -> None:
    """Tell the user something, in a line on standard error."""
    print(f"convwass: {text}", file=sys.stderr)
