# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the API pages, ``docs/api.md`` and ``docs/api/``, from the docstrings.

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
from convwass_addon.geometry.meshes.mesh import TriangleMesh

from .api_blender import command_pages, operator_pages, scene_pages
from .api_entries import APPLICATIONS, BRIDGE
from .docstrings import described, parsed, plain

PROJECT = Path(__file__).resolve().parents[1]
FOLDER = "docs/api"
INDEX = "docs/api.md"

_MADE = "<!-- Generated from the docstrings by `python3 run.py api`; edit those instead. -->"

_INDEX = """# The API

For script authors. There are four interfaces, from the highest level to the lowest:

- [The command line](api/command_line.md): `blender --command convwass COMMAND` or `python -m convwass_addon COMMAND`.
- [Operators](api/operators.md): `bpy.ops.convwass.…` in Blender's Python, the same ones that the buttons call. In a
  script they return when all their work is done; in the window they work in the background.
- [Applications](api/applications.md): the work of the operators on arrays, without Blender.
- [Transport](api/transport.md): the algorithms of the paper on arrays.

The [scripts](scripts/README.md) use all four. Names that are not listed here may change without notice.

"""

_TRANSPORT = """# Transport

Distances, barycenters, interpolation, propagation and maps between distributions, on any domain. Import them from
`convwass_addon.transport`. A density has the shape of its domain and a mass of one under the domain's area weights; in
arrays of several densities the first axis counts them.

"""

_APPLICATIONS = """# Applications

The features of the extension on arrays, without Blender. Functions whose names end in `_steps`, and `morph`,
`flat_morph` and `lobe_frames`, do long work: they are generators that yield `Progress` (a `fraction`, a `message` and,
whenever a part is finished, its `payload`) and return their result. Drive them with a loop, or with `drained` if you
need only the result:

```python
from convwass_addon.progress import drained

for progress in morph(MorphInputs.of(shapes, names), blends, MorphSettings()):
    print(f"{progress.fraction:.0%} {progress.message}")
frames = drained(interpolation_steps(first, second, surface, DensitySettings()))
```

All of them take a `Control` from the same module. Calling its `cancel` from any thread ends them with
`convwass_addon.errors.Cancelled`.

Errors that the user can fix are `convwass_addon.errors.InputError`; the message says what to do.

"""

_OPERATORS = """# Operators

`bpy.ops.convwass.NAME(...)`, available when the extension is enabled, or after `convwass_addon.register()` if `bpy`
came from pip. On failure they raise `RuntimeError`; the message says what to do. Omitted arguments take the defaults
below, not the values in the panels; those are in `bpy.context.scene` (see the end).

"""

_SCENES = """## Scene settings

The settings that the panels show, such as `bpy.context.scene.convwass_soft_map.source`.

"""

_COMMAND_LINE = """# The command line

With the extension installed, run `blender --command convwass COMMAND …`; in a checkout of this project,
`python3 run.py python -m convwass_addon COMMAND …`. `COMMAND --help` prints the same text as this page.

Exit codes: 0 success, 1 failure while working, 2 invalid command line, 3 unusable shapes or settings, 4 not enough
memory, 128 + n ended by the signal n (130 by Ctrl+C).

"""


@dataclass(frozen=True)
class Entry:
    """A heading of a page.

    Attributes
    ----------
    name : str
        The heading; marked for classes, because some differ from a function only in case, and anchors ignore case.
    summary : str
        One sentence of Markdown, or empty.
    lines : list of str
        The Markdown below the heading.
    """

    name: str
    summary: str
    lines: list[str]


def main() -> int:
    """Write the pages, or with ``--check`` list those that are out of date."""
    parser = argparse.ArgumentParser(prog="run.py api", description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a page is out of date")
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
    """Return all pages by their path in the project; registers the add-on while it works."""
    convwass_addon.register()
    try:
        return pages_of_registered()
    finally:
        convwass_addon.unregister()


def pages_of_registered() -> dict[str, str]:
    """Return all pages; the add-on must be registered."""
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
    """Return the applications by package, and the mesh that all of them take."""
    parts = [
        "## geometry.meshes.mesh\n\nThe mesh that all of them take.\n\n",
        *_written([_entry("TriangleMesh", TriangleMesh)], "###"),
    ]
    for name, modules in APPLICATIONS.items():
        package = importlib.import_module(f"{applications.__name__}.{name}")
        parts.append(f"## applications.{name}\n\n{plain(parsed(package.__doc__).text)}\n\n")
        for module, names in modules.items():
            parts += _of_module(f"{package.__name__}.{module}", names)
    return parts


def _bridge() -> list[str]:
    """Return the functions that convert between Blender's data and arrays."""
    parts = ["## bridge\n\nConversion between Blender's data and arrays; needs `bpy`.\n\n"]
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
    """Return the table of contents of the transport page, which has no packages."""
    lines = [
        f"- [{entry.name}](api/transport.md#{entry.name.lower().replace(' ', '-')}): {entry.summary}"
        for entry in functions
    ]
    return "\n".join(["## Overview of transport", "", *lines, ""])


if __name__ == "__main__":
    sys.exit(main())
