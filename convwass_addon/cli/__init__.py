# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``blender --command convwass VERB …`` and ``python -m convwass_addon VERB …``."""

from __future__ import annotations

from collections.abc import Sequence

import bpy


def main(arguments: Sequence[str], program: str = "blender --command convwass") -> int:
    """Run one verb.

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
    # Imported here: Blender's window does without the verbs, and should not wait for them when it starts.
    from .program import run

    return run(arguments, program)


_commands: list[object] = []


def register() -> None:
    """Add the verbs to ``blender --command convwass``."""
    _commands.append(bpy.utils.register_cli_command("convwass", main))


def unregister() -> None:
    """Take the verbs away."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
