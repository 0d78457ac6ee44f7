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
        The words after the program.
    program : str
        How the user called it, for the help text.

    Returns
    -------
    int
        The exit code; see the help text.
    """
    # Imported here: Blender's window does without the commands, and should not wait for them when it starts.
    from .program import run

    return run(arguments, program)


_commands: list[object] = []


def register() -> None:
    """Add the commands to ``blender --command convwass``."""
    _commands.append(bpy.utils.register_cli_command("convwass", main))


def unregister() -> None:
    """Take the commands away."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
