# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""``python -m convwass_addon COMMAND …``, where the bpy module comes from pip."""

import os
import sys

from .console import own_stdout

try:
    with own_stdout():
        # Blender greets on standard output when it is imported.
        from .cli import main
    code = main(sys.argv[1:], "python -m convwass_addon")
    sys.stdout.flush()
    sys.stderr.flush()
    # Blender 4.5 may wait for ever for a thread of its own when the process ends the ordinary way.
    os._exit(code)
except ModuleNotFoundError as error:
    if error.name != "bpy":
        raise
    sys.exit("The command line needs Blender as a Python module: pip install 'convwass[blender]'")
except KeyboardInterrupt:
    # Before the command line is there to say more.
    sys.exit(130)
