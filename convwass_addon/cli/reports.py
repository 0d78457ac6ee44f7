# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of commands besides the .blend: JSON reports, and notes on standard error."""

from __future__ import annotations

import json
import re
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path

from ..applications.whole_paths import path_with_suffix, share_a_place
from ..bridge.files.imports import parse_source
from ..bridge.files.output_paths import checked_target, save_blend
from ..drafts import written_whole
from ..errors import InputError
from .answer import Answer
from .overwriting import refuse_overwriting

# Names of files in sequences: text, a number of at least four digits, and the extension.
_NUMBERED = re.compile(r"(.*?)([0-9]{4,})(\.[^.]+)")


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


def checked_outputs(options: Namespace, sources: Sequence[str]) -> tuple[Path, Path | None]:
    """Return the absolute paths of ``--out`` and ``--report``, the second one None if it was not given.

    Parameters
    ----------
    options : Namespace
        The options of the command.
    sources : sequence of str
        The files or objects that the command reads.

    Raises
    ------
    InputError
        A file cannot be written, or would overwrite an input or the other one.
    """
    target = checked_target(path_with_suffix(options.out, ".blend"))
    report = None if options.report is None else checked_target(options.report)
    refuse_overwriting([parse_source(text).path for text in sources], [target, report])
    if report is not None and share_a_place([target], [report]):
        raise InputError("--report would overwrite {file} of --out; write it to another file.", file=str(target))
    return target, report


def saved(target: Path, report: Path | None, record: dict[str, object]) -> Answer:
    """Save the scene, write its record as JSON if there is a report, and return the answer; raises ConvwassError."""
    written = [save_blend(target)]
    if report is not None:
        with written_whole(report) as draft:
            draft.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
        written.append(report)
    return Answer.of_files(record, written)


def note_leftovers(written: Sequence[Path]) -> None:
    """Print a note if files of a longer sequence, which a viewer would show too, lie next to a numbered sequence.

    Parameters
    ----------
    written : sequence of Path
        The files of a run; those without a number, and single ones, are ignored.
    """
    sequences: dict[tuple[Path, str, str], set[str]] = {}
    for path in written:
        parts = _NUMBERED.fullmatch(path.name)
        if parts:
            sequences.setdefault((path.parent, parts[1], parts[3]), set()).add(path.name)
    for (folder, before, suffix), names in sequences.items():
        alike = [_NUMBERED.fullmatch(path.name) for path in folder.iterdir()] if len(names) > 1 else []
        left = sorted(own[0] for own in alike if own and (own[1], own[3]) == (before, suffix) and own[0] not in names)
        if left:
            shown = left[0] if len(left) == 1 else f"{left[0]} to {left[-1]}"
            note(f"{folder} also contains {shown}, not written by this run; delete what does not belong to it")


def note(*texts: object) -> None:
    """Print notes for the user on standard error."""
    for text in texts:
        print(f"convwass: {text}", file=sys.stderr)
