# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""``python -m convwass_addon COMMAND …``, with the bpy module from pip."""

import os
import signal
import sys
from contextlib import suppress

from .console import open_streams, own_stdout

open_streams()
# As an exception, an interrupt would be ignored by Blender's start or crash it. Until then, it ends the process.
interrupted = signal.getsignal(signal.SIGINT)
if interrupted is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

try:
    with own_stdout():
        # Importing bpy prints a message to standard output.
        import bpy

        from .cli import main
    signal.signal(signal.SIGINT, interrupted)
    code = main(sys.argv[1:], "python -m convwass_addon")
    sys.stdout.flush()
    sys.stderr.flush()
    # Blender removes its folder for temporary files at a normal exit only; if that is shared, it is not empty.
    with suppress(OSError):
        os.rmdir(bpy.app.tempdir)
    # Blender 4.5 may wait forever for one of its own threads at a normal exit.
    os._exit(code)
except ModuleNotFoundError as error:
    if error.name != "bpy":
        raise
    sys.exit("The command line needs Blender as a Python module: pip install 'convwass[blender]'")
except KeyboardInterrupt:
    # Interrupted before the command line could handle it.
    sys.stderr.write("convwass: interrupted\n")
    sys.exit(130)
