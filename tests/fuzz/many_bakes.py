# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Very many bakes in one Blender, and what they leave behind: python -m tests.fuzz.many_bakes 200."""

from __future__ import annotations

import gc
import os
import sys
import tempfile
import threading
from pathlib import Path

_EVERY = 20


def main(count: int) -> int:
    """Bake and delete, printing memory and counts regularly; return 1 if data-blocks or threads remain."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["BLENDER_USER_RESOURCES"] = folder
        import bpy

        import convwass_addon
        from tests.fuzz import stages

        convwass_addon.register()
        bpy.ops.wm.read_factory_settings(use_empty=True)
        stages.painted_cubes()
        left = []
        for number in range(count + 1):
            bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=3, resolution=24, inputs="In 0, In 1")
            bpy.ops.convwass.delete_morph()
            bpy.context.view_layer.objects.active = bpy.data.objects["In 0"]
            bpy.ops.convwass.interpolate_density(first="A", second="B", steps=2, max_iterations=20)
            bpy.ops.convwass.remove_density()
            if number % _EVERY == 0:
                gc.collect()
                blocks = len(bpy.data.user_map())
                left.append((blocks, threading.active_count()))
                memory = _resident() / 1e6
                print(f"{number:4d} bakes: {memory:.0f} MB, {blocks} data-blocks, {left[-1][1]} threads", flush=True)
    sys.stdout.flush()
    os._exit(int(len(set(left)) > 1))


def _resident() -> int:
    """Return the resident memory of this process in bytes; 0 if unknown."""
    try:
        return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
