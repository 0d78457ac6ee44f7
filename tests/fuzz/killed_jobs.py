# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a Blender process that is killed at one of its steps: python -m tests.fuzz.killed_jobs NAME FOLDER STEP.

With "placing: " before the name, it is killed when one of its files is about to be moved into place.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest.mock import patch

import bpy

from convwass_addon.applications.skies.sky_settings import SkySettings
from convwass_addon.bridge.morphs.disk import exports
from convwass_addon.bridge.skies.sky_sequence import SkyFiles, sky_steps
from convwass_addon.operators.background import BackgroundOperator
from convwass_addon.progress import Control
from tests.fuzz.job_cases import prepare
from tests.lights import sky

_PLACING = "placing: "

Step = Callable[[], None]
"""Called at every step."""


def run(name: str, folder: Path, step: Step = lambda: None) -> None:
    """Do all of the work in an empty scene; before operators start, the file is saved."""
    if name in _WITH_FILES:
        _WITH_FILES[name](folder, step)
        return
    folder.mkdir(exist_ok=True)
    work = prepare(name, folder)
    if not (folder / "work.blend").exists():
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "work.blend"))
    with patch.object(BackgroundOperator, "work", _stepping(BackgroundOperator.work, step)):
        work()


def _stepping(own: Callable[[object], Callable], step: Step) -> Callable:
    def work(self: object) -> Callable[[object], Iterator]:
        make = own(self)

        def stepping(control: Control) -> Iterator:
            for found in make(control):
                step()
                yield found

        return stepping

    return work


def _sky(folder: Path, step: Step) -> None:
    files = SkyFiles(folder, 1, 3)
    for report in sky_steps([sky((1, 0, 1)), sky((0, 1, 1))], 3, SkySettings(rows=32)):
        if report.payload is not None:
            files.write(report.payload)
        step()
    files.finish()


def _export(folder: Path, step: Step) -> None:
    prepare("bake_morph", folder)()
    whole = exports.write_draft

    def looked_at(*arguments: object) -> None:
        whole(*arguments)
        step()

    exports.write_draft = looked_at
    try:
        exports.export_frames(bpy.context.scene.collection.children[0], folder / "rise", "obj")
    finally:
        exports.write_draft = whole


_WITH_FILES = {"sky": _sky, "export": _export}


def main(name: str, folder: Path, last: int) -> None:
    """Run in a fresh Blender, up to a step."""
    import convwass_addon

    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    seen = []

    def step() -> None:
        seen.append(1)
        if len(seen) > last:
            os.kill(os.getpid(), signal.SIGKILL)

    if name.startswith(_PLACING):
        place = os.replace

        def placed(draft: str | Path, target: str | Path) -> None:
            # Drafts are also written to a temporary file and moved.
            if "out" in Path(target).parts and not any(part.startswith(".") for part in Path(target).parts):
                step()
            place(draft, target)

        os.replace = placed
        run(name.removeprefix(_PLACING), folder)
    else:
        run(name, folder, step)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]))
    sys.stdout.flush()
    # Some versions of the bpy module crash during Python's cleanup.
    os._exit(0)
