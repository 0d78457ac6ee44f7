# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The parser of the command line and its commands."""

from __future__ import annotations

import json
import signal
import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..applications.system_errors import error_to_tell
from ..console import own_stdout
from ..errors import Cancelled, ConvwassError, InputError, ResourceError
from .answer import Answer
from .armature_command import run_armature
from .armature_options import ARMATURE_HELP, add_armature_options
from .demo_command import DEMO_HELP, add_demo_options, run_demo
from .density_command import run_density
from .density_options import DENSITY_HELP, add_density_options
from .interrupts import Ended, heeded_signals
from .morph_command import run_morph
from .morph_options import MORPH_HELP, add_morph_options
from .recolor_command import run_recolor
from .recolor_options import RECOLOR_HELP, add_recolor_options
from .reflect_command import run_reflect
from .reflect_options import REFLECT_HELP, SKY_HELP, add_reflect_options, add_sky_options
from .sky_command import run_sky
from .softmap_command import run_softmap
from .softmap_options import SOFTMAP_HELP, add_softmap_options

EXIT_CODES = """exit codes:
  0  success                         3  unusable shapes or settings (the message says what to do)
  1  failure while working           4  not enough memory
  2  wrong command line        128 + n  ended by the signal n: 130 by Ctrl+C
"""


@dataclass(frozen=True)
class Command:
    """A command of the command line: its name, its help, its options and the function that runs it."""

    name: str
    summary: str
    description: str
    add_options: Callable[[ArgumentParser], None]
    run: Callable[[Namespace], Answer]


COMMANDS = (
    Command("morph", "morph shapes into each other", MORPH_HELP, add_morph_options, run_morph),
    Command("density", "transport densities on a surface", DENSITY_HELP, add_density_options, run_density),
    Command("softmap", "map one mesh to another, transfer its data", SOFTMAP_HELP, add_softmap_options, run_softmap),
    Command("armature", "fit an armature into a mesh", ARMATURE_HELP, add_armature_options, run_armature),
    Command("recolor", "give images the palette of others", RECOLOR_HELP, add_recolor_options, run_recolor),
    Command("reflect", "blend materials", REFLECT_HELP, add_reflect_options, run_reflect),
    Command("sky", "blend skies", SKY_HELP, add_sky_options, run_sky),
    Command("demo", "morph the project's sample shapes", DEMO_HELP, add_demo_options, run_demo),
)


def run(arguments: Sequence[str], program: str) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str
        Arguments after the program's name.
    program : str
        Name of the program in the help text.

    Returns
    -------
    int
        The exit code, as listed in the help text.
    """
    try:
        options = command_line_parser(program).parse_args(list(arguments))
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        with heeded_signals(), own_stdout() as output:
            found = options.run(options)
            print(json.dumps(found.record, indent=2) if options.json else "\n".join(found.lines), file=output)
    # In Blender itself, an interrupt cancels a rendering.
    except (KeyboardInterrupt, Cancelled) as stop:
        kept = getattr(options, "cache", None)
        left = f"finished frames are kept in {kept}" if kept else "unfinished files were not saved"
        print(f"convwass: interrupted; {left}", file=sys.stderr)
        return 128 + (stop.number if isinstance(stop, Ended) else signal.SIGINT)
    except (ConvwassError, OSError, MemoryError) as failure:
        error = error_to_tell(failure)
        print(f"convwass: {error}", file=sys.stderr)
        return 4 if isinstance(error, ResourceError) else 3 if isinstance(error, InputError) else 1
    return 0


def command_line_parser(program: str) -> ArgumentParser:
    """Return the parser of all commands; `program` is its name in the help text."""
    parser = ArgumentParser(program, description="Convolutional Wasserstein distances for Blender.")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for command in COMMANDS:
        own = commands.add_parser(
            command.name,
            help=command.summary,
            description=command.description,
            formatter_class=RawDescriptionHelpFormatter,
            epilog=EXIT_CODES,
        )
        command.add_options(own)
        own.set_defaults(run=command.run)
    return parser
