# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the figures of the paper with shapes of our own, and write docs/gallery.md: ``python3 run.py gallery``.

It runs the other scripts in this folder one by one; the longest, for Fig. 8, takes a quarter of an hour.
``--only 7 14`` draws only these, ``--page`` none. The first start installs the extra ``docs`` of pyproject.toml.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path

from gallery_figures import FIGURES, Figure

DOCS = Path(__file__).resolve().parent
PROJECT = DOCS.parent
_HEAD = """# The figures of the paper, with shapes of our own

All figures of *Convolutional Wasserstein Distances* (Solomon et al. 2015), in its order. `python3 run.py gallery`
draws them and writes this page; `--only 7 14` draws only these. Below each picture is the command or the Python code
that computes it.
"""


def main() -> int:
    """Draw the requested figures and write the page; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    numbers = [figure.number for figure in FIGURES]
    parser.add_argument("--only", type=int, nargs="+", choices=numbers, metavar="FIG", help="draw these figures")
    parser.add_argument("--page", action="store_true", help="write the page and draw nothing")
    options = parser.parse_args()
    failed = []
    if not options.page and not find_spec("matplotlib"):
        install_drawing()
    for figure in FIGURES:
        if not options.page and (options.only is None or figure.number in options.only) and not drawn(figure):
            failed.append(figure.number)
    (DOCS / "gallery.md").write_text(page(FIGURES), encoding="utf-8")
    if failed:
        print(f"Not drawn: {', '.join(f'Fig. {number}' for number in failed)}", file=sys.stderr)
    return 1 if failed else 0


def install_drawing() -> None:
    """Install the packages for drawing into the current environment."""
    declared = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = declared["project"]["optional-dependencies"]["docs"]
    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", *wanted], check=True)


def drawn(figure: Figure) -> bool:
    """Run the script of a figure; return whether it succeeded."""
    name, *arguments = figure.script
    if not (DOCS / name).is_file():
        print(f"Fig. {figure.number}: docs/{name} is missing", file=sys.stderr)
        return False
    print(f"Fig. {figure.number}: docs/{' '.join(figure.script)}", flush=True)
    path = os.pathsep.join(filter(None, [str(PROJECT), os.environ.get("PYTHONPATH")]))
    command = [sys.executable, str(DOCS / name), *arguments]
    return subprocess.run(command, cwd=PROJECT, env={**os.environ, "PYTHONPATH": path}, check=False).returncode == 0


def page(figures: tuple[Figure, ...]) -> str:
    """Return the gallery in Markdown."""
    return "\n".join([_HEAD, *map(_section, figures)])


def _section(figure: Figure) -> str:
    return f"""## Fig. {figure.number}: {figure.title}

![{figure.ours.split(". ")[0]}](pictures/{figure.picture})

The paper: {figure.paper}

Here: {figure.ours} Drawn by `docs/{" ".join(figure.script)}`.

```{figure.language}
{figure.line}
```
"""


if __name__ == "__main__":
    sys.exit(main())
