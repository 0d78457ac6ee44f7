# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A child process that calls operators in odd scenes, and logs every action before it starts.

python -m tests.fuzz.operator_session SEED FIRST COUNT RESULTS
"""

from __future__ import annotations

import json
import os
import signal
import sys
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from random import Random

CALLS = 8
# A call that takes more CPU seconds is cancelled, as a user would do.
SECONDS = 25


class Log:
    """The log, one JSON line per action, written to disk immediately."""

    def __init__(self, path: Path) -> None:
        self._file = open(path, "a", encoding="utf-8")  # noqa: SIM115

    def write(self, **entry: object) -> None:
        """Add a line."""
        self._file.write(json.dumps(entry, default=repr) + "\n")
        self._file.flush()


class Screen:
    """Standard error redirected to a file, because Blender prints tracebacks of polls and callbacks there."""

    def __init__(self, path: Path) -> None:
        self._file = open(path, "w+b")  # noqa: SIM115
        os.dup2(self._file.fileno(), 2)
        self._seen = 0

    def news(self) -> str:
        """Return what has been printed since the last call."""
        sys.stderr.flush()
        self._file.seek(self._seen)
        found = self._file.read()
        self._seen += len(found)
        return found.decode(errors="replace")


def main(seed: str, first: int, count: int, results: Path) -> None:
    """Run the given number of sessions."""
    with tempfile.TemporaryDirectory(prefix="convwass-fuzz-") as folder:
        os.environ["BLENDER_USER_RESOURCES"] = folder
        import bpy

        import convwass_addon
        from tests.fuzz import stages

        convwass_addon.register()
        os.chdir(folder)
        warnings.simplefilter("default")
        log, screen = Log(results), Screen(results.with_name("screen"))
        library = Path(folder) / "library.blend"
        stages.write_library(library)
        operators = [getattr(bpy.ops.convwass, name) for name in dir(bpy.ops.convwass)]
        for number in range(first, first + count):
            random = Random(f"{seed}:{number}")
            log.write(session=number, doing="build")
            stages.build(random, library)
            screen.news()
            for _ in range(CALLS):
                _step(random, operators, log, screen, number)
        log.write(session=first + count, doing="done")
    sys.stdout.flush()
    os._exit(0)


def _step(random: Random, operators: list[object], log: Log, screen: Screen, number: int) -> None:
    import bpy

    from tests.fuzz import arguments, stages

    event = random.random()
    if event < 0.05 and bpy.data.objects:
        bpy.data.objects.remove(random.choice(list(bpy.data.objects)))
    elif event < 0.10:
        with suppress(RuntimeError):
            bpy.ops.ed.undo_push(message="x")
            bpy.ops.ed.undo()
    elif event < 0.15:
        _spoil_stored(random)
    if random.random() < 0.7:
        stages.enter_some_mode(random)
    owners = [bpy.context.scene, bpy.context.object]
    for owner in (owner for owner in owners if owner is not None and random.random() < 0.5):
        for prop in owner.bl_rna.properties:
            if prop.identifier.startswith("convwass_") and prop.identifier != "convwass_density_findings":
                with suppress(AttributeError, TypeError):
                    arguments.stir(getattr(owner, prop.identifier), random)
    operator = _chosen(operators, random)
    kind = operator.get_rna_type()
    given = arguments.arguments(kind.properties, random)
    area = random.choice(stages.AREAS)
    about = {
        "session": number,
        "operator": operator.idname_py(),
        "given": given,
        "area": area,
        "mode": bpy.context.mode,
    }
    log.write(**about, active=getattr(bpy.context.object, "name", None), doing="call")
    before = {block.as_pointer() for block in bpy.data.meshes}
    outcome, text = _called(operator, given, area, random)
    printed = screen.news()
    if "Traceback" in printed and "Traceback" not in text:
        outcome, text = "traceback", printed
    elif "Warning" in printed and "blend relative" not in printed and outcome != "traceback":
        outcome, text = "warning", printed
    if outcome == "finished":
        unsound = _unsound(before)
        if unsound:
            outcome, text = "unsound", unsound
    log.write(**about, doing="called", outcome=outcome, text=text[-3000:])
    shown = _drawn(screen)
    if shown:
        log.write(**about, doing="drawn", outcome="traceback", text=shown[-3000:])


def _chosen(operators: list[object], random: Random) -> object:
    """Choose any operator, preferring those that can be called now."""
    if random.random() < 0.25:
        return random.choice(operators)
    return next((own for own in random.sample(operators, len(operators)) if own.poll()), operators[0])


def _called(operator: object, given: dict[str, object], area: str | None, random: Random) -> tuple[str, str]:
    how = random.choice(("EXEC_DEFAULT", "INVOKE_DEFAULT", "EXEC_REGION_WIN"))
    try:
        with _in_area(area), _limited():
            # With an undo step, Blender lays out its panel of the last action and crashes without a window.
            found = operator(how, area is None, **given)
        return ("finished" if "FINISHED" in found else "cancelled"), ""
    except RuntimeError as error:
        text = str(error)
        if "Traceback" in text:
            return ("stopped" if "_Stopped" in text else "traceback"), text
        return ("poll" if "poll()" in text else "refused"), text
    except TypeError as error:
        # Blender rejects such an argument itself, for example an unknown enum item.
        return "no call", str(error)


class _Stopped(BaseException):
    """A call takes too long."""


@contextmanager
def _limited() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise _Stopped

    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    except _Stopped as error:
        raise RuntimeError("Traceback of _Stopped") from error
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


@contextmanager
def _in_area(kind: str | None) -> Iterator[None]:
    import bpy

    window = bpy.context.window_manager.windows[0]
    if kind is None:
        with bpy.context.temp_override(window=None, area=None, region=None):
            yield
        return
    area = window.screen.areas[-1]
    area.type = kind
    region = next((region for region in area.regions if region.type == "WINDOW"), None)
    with bpy.context.temp_override(window=window, area=area, region=region):
        yield


def _spoil_stored(random: Random) -> None:
    """Overwrite what the add-on has stored on data-blocks with nonsense."""
    import bpy

    values = (
        "",
        "{",
        "[" * 100_000,
        "null",
        '{"schema": 1}',
        3,
        2.5,
        [1, 2],
        b"CWMAP\0xxxx",
        "[[1, 2]]",
        '{"schema": 99}',
    )
    for block in (*bpy.data.objects, *bpy.data.collections, *bpy.data.meshes):
        for key in stored_keys(block):
            if random.random() < 0.5 and block.library is None:
                block[key] = random.choice(values)


def stored_keys(block: object) -> list[str]:
    """Return the add-on's custom properties; before Blender 5, they include registered properties."""
    return [key for key in block.keys() if key.startswith("convwass") and key not in block.bl_rna.properties]  # noqa: SIM118


def _unsound(before: set[int]) -> str:
    """Describe the first invalid new mesh."""
    import bpy
    import numpy as np

    for mesh in bpy.data.meshes:
        if mesh.as_pointer() in before or mesh.library is not None or mesh.is_editmode:
            continue
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        if not np.isfinite(points).all():
            return f"{mesh.name} has coordinates that are not numbers"
        if mesh.validate():
            return f"{mesh.name} is not valid"
    return ""


def _drawn(screen: Screen) -> str:
    """Draw all panels; return the errors."""
    import traceback

    import bpy

    from tests.panels.drawing import draw, panels

    for area in ("VIEW_3D", "IMAGE_EDITOR"):
        # Without a window regions have no size.
        with _in_area(area), bpy.context.temp_override(region=None):
            for panel in panels():
                try:
                    if _is_shown(panel):
                        draw(panel, bpy.context)
                except Exception:
                    return f"{panel.__name__}: {traceback.format_exc()}"
    printed = screen.news()
    return printed if "Traceback" in printed else ""


def _is_shown(panel: type) -> bool:
    """Tell whether the parent panels of a panel are shown."""
    import bpy

    name = getattr(panel, "bl_parent_id", "")
    if not name:
        return True
    parent = getattr(bpy.types, name)
    return (not hasattr(parent, "poll") or parent.poll(bpy.context)) and _is_shown(parent)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), Path(sys.argv[4]))
