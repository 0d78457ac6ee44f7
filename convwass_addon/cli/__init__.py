# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``blender --command convwass COMMAND …`` and ``python -m convwass_addon COMMAND …``."""

from __future__ import annotations

from collections.abc import Sequence

import bpy


def main(arguments: Sequence[str], program: str = "blender --command convwass") -> int:
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
    # Imported here because Blender's window does not need the commands and must not load them at startup.
    from .program import run

    return run(arguments, program)


_commands: list[object] = []


def register() -> None:
    """Add the commands to ``blender --command convwass``."""
    _commands.append(bpy.utils.register_cli_command("convwass", main))


def unregister() -> None:
    """Remove the commands."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
