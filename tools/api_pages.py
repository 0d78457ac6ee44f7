# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the pages about the API from docstrings: ``docs/api.md`` and what it leads to in ``docs/api/``.

python3 run.py api [--check]
"""

from __future__ import annotations

import argparse
import importlib
import inspect
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import convwass_addon
from convwass_addon import applications, bridge, transport
from convwass_addon.geometry.mesh import TriangleMesh

from .api_blender import command_pages, operator_pages, scene_pages
from .api_entries import APPLICATIONS, BRIDGE
from .docstrings import described, parsed, plain

PROJECT = Path(__file__).resolve().parents[1]
FOLDER = "docs/api"
INDEX = "docs/api.md"

_MADE = "<!-- Made by `python3 run.py api` from the docstrings; changes belong there. -->"

_INDEX = """# The API

For those who write scripts. The same work can be asked for in four ways, from the shortest to the most open:

- [The command line](api/command_line.md): `blender --command convwass COMMAND` or `python -m convwass_addon COMMAND`.
- [Operators](api/operators.md): `bpy.ops.convwass.…` in Blender's Python, the same that the buttons call. In a script
  they do all of their work before they return; in the window they work in the background.
- [Applications](api/applications.md): what the operators do, on arrays; no Blender is needed.
- [Transport](api/transport.md): the functions of the paper on arrays.

The [scripts](scripts/README.md) show all four. Names that do not stand here may change without notice.

"""

_TRANSPORT = """# Transport

Distances, barycenters, interpolation, propagation and maps between distributions, on any domain. Import them from
`convwass_addon.transport`. Densities have the shape of their domain and a mass of one under its area weights; arrays of
several have the distribution first.

"""

_APPLICATIONS = """# Applications

What a user does, on arrays and without Blender. Functions whose names end in `_steps`, and `morph`, `flat_morph` and
`lobe_frames`, do long work: generators that yield `Progress` with a `fraction`, a `message` and, where something is
finished on the way, a `payload`, and that return their result. A loop drives them, or `drained` where only the result
counts:

```python
from convwass_addon.progress import drained

for progress in morph(shapes, names, blends, MorphSettings()):
    print(f"{progress.fraction:.0%} {progress.message}")
frames = drained(interpolation_steps(first, second, surface, DensitySettings()))
```

All of them take a `Control` of the same module, whose `cancel` ends them from any thread with
`convwass_addon.errors.Cancelled`.

Errors that a user can mend are `convwass_addon.errors.InputError`; their text says what to do.

"""

_OPERATORS = """# Operators

`bpy.ops.convwass.NAME(...)`, where the extension is enabled, or after `convwass_addon.register()` where `bpy` came from
pip. What cannot work raises `RuntimeError` with a sentence that says what to do. Arguments that are left out have the
defaults below, not what the panels show; where a panel keeps settings, they are in `bpy.context.scene` (see the end).

"""

_SCENES = """## What scenes keep

The settings that the panels show, such as `bpy.context.scene.convwass_soft_map.source`.

"""

_COMMAND_LINE = """# The command line

With the extension installed, run `blender --command convwass COMMAND …`; in a checkout of this project,
`python3 run.py python -m convwass_addon COMMAND …`. `COMMAND --help` prints what this page says.

Exit codes: 0 success, 1 failure while working, 2 wrong command line, 3 unusable shapes or settings, 4 not enough
memory, 130 interrupted.

"""


@dataclass(frozen=True)
class Entry:
    """A heading of a page.

    Attributes
    ----------
    name : str
        The heading; classes are marked as such, since some differ from a function only by a capital, and addresses of
        headings have none.
    summary : str
        In one sentence, as Markdown; empty where none is wanted.
    lines : list of str
        The Markdown below the heading.
    """

    name: str
    summary: str
    lines: list[str]


def main() -> int:
    """Write the pages, or with ``--check`` say which are out of date."""
    parser = argparse.ArgumentParser(prog="run.py api", description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail where a page is out of date")
    options = parser.parse_args()
    stale = {name: text for name, text in made_pages().items() if _text_of(PROJECT / name) != text}
    for name, text in stale.items():
        print(f"{name}: {'out of date; run: python3 run.py api' if options.check else 'written'}")
        if not options.check:
            (PROJECT / name).parent.mkdir(exist_ok=True)
            (PROJECT / name).write_text(text, encoding="utf-8")
    return int(options.check and bool(stale))


def _text_of(path: Path) -> str | None:
    return path.read_text(encoding="utf-8") if path.is_file() else None


def made_pages() -> dict[str, str]:
    """Return all pages by their path in the project; registers the add-on for as long as it takes."""
    convwass_addon.register()
    try:
        return pages_of_registered()
    finally:
        convwass_addon.unregister()


def pages_of_registered() -> dict[str, str]:
    """Return all pages, where the add-on is registered."""
    functions = [_entry(name, getattr(transport, name)) for name in transport.__all__]
    operators = [Entry(f"bpy.ops.{name}", "", lines) for name, lines in operator_pages().items()]
    scenes = [Entry(f"scene.{name}", "", lines) for name, lines in scene_pages().items()]
    commands = [Entry(name, "", lines) for name, lines in command_pages().items()]
    return {
        INDEX: f"{_MADE}\n\n{_INDEX}" + _index(functions),
        f"{FOLDER}/transport.md": _page(_TRANSPORT, _written(functions)),
        f"{FOLDER}/applications.md": _page(_APPLICATIONS, [*_application_packages(), *_bridge()]),
        f"{FOLDER}/operators.md": _page(_OPERATORS, [*_written(operators), _SCENES, *_written(scenes, "###")]),
        f"{FOLDER}/command_line.md": _page(_COMMAND_LINE, _written(commands)),
    }


def _page(introduction: str, parts: Iterable[str]) -> str:
    return f"{_MADE}\n\n{introduction}" + "".join(parts).rstrip() + "\n"


def _entry(name: str, thing: object) -> Entry:
    title = f"class {name}" if inspect.isclass(thing) else name
    return Entry(title, plain(parsed(inspect.getdoc(thing) or "").summary), described(name, thing))


def _written(entries: Iterable[Entry], marks: str = "##") -> list[str]:
    return ["\n".join([f"{marks} {entry.name}", "", *entry.lines, "", ""]) for entry in entries]


def _application_packages() -> list[str]:
    """Return the applications, package by package, and the mesh that all of them take."""
    parts = ["## geometry.mesh\n\nWhat all of them take.\n\n", *_written([_entry("TriangleMesh", TriangleMesh)], "###")]
    for name, modules in APPLICATIONS.items():
        package = importlib.import_module(f"{applications.__name__}.{name}")
        parts.append(f"## applications.{name}\n\n{plain(parsed(package.__doc__).text)}\n\n")
        for module, names in modules.items():
            parts += _of_module(f"{package.__name__}.{module}", names)
    return parts


def _bridge() -> list[str]:
    """Return what leads from Blender's data to arrays and back."""
    parts = ["## bridge\n\nBetween Blender's data and arrays; these need `bpy`.\n\n"]
    for module, names in BRIDGE.items():
        parts += _of_module(f"{bridge.__name__}.{module}", names)
    return parts


def _of_module(path: str, names: Iterable[str]) -> list[str]:
    module = importlib.import_module(path)
    entries = []
    for name in names:
        found = _entry(name, getattr(module, name))
        entries.append(Entry(name, found.summary, [f"`from {path} import {name}`", "", *found.lines]))
    return _written(entries, "###")


def _index(functions: Iterable[Entry]) -> str:
    """Return the contents of the page on transport, which has no packages."""
    lines = [
        f"- [{entry.name}](api/transport.md#{entry.name.lower().replace(' ', '-')}): {entry.summary}"
        for entry in functions
    ]
    return "\n".join(["## Overview of transport", "", *lines, ""])


if __name__ == "__main__":
    sys.exit(main())
