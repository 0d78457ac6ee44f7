# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert the pages of docs/ that users of the extension need to HTML, with their pictures."""

from __future__ import annotations

import re
import shutil
from html import escape
from pathlib import Path

from markdown import Markdown

PROJECT = Path(__file__).resolve().parent.parent
PAGES = (
    "walkthrough",
    "choosing",
    "morphs",
    "motions",
    "live",
    "looks",
    "exports",
    "densities",
    "soft_maps",
    "armatures",
    "palettes",
    "light",
    "troubleshooting",
)
"""Names of the pages, in the order of their links."""

_TEMPLATE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{title} – Convwass</title>
<style>
body {{ max-width: 60rem; margin: 0 auto; padding: 1rem; font: 1rem/1.5 sans-serif; color: #222; background: #fff }}
img {{ max-width: 100% }}
nav a {{ margin-right: 1rem; white-space: nowrap }}
table {{ border-collapse: collapse }}
td, th {{ border: 1px solid #ccc; padding: .3rem .6rem; text-align: left; vertical-align: top }}
pre {{ overflow-x: auto; background: #f4f4f4; padding: .6rem }}
</style>
</head>
<body>
<nav>{links}</nav>
{body}
</body>
</html>
"""


def write_manual(folder: Path) -> None:
    """Write the pages and the pictures that they show to a folder.

    Links between the pages are kept; links to other files of the project become text.
    """
    folder.mkdir(parents=True)
    texts = {name: (PROJECT / "docs" / f"{name}.md").read_text(encoding="utf-8") for name in PAGES}
    titles = {name: text.removeprefix("# ").partition("\n")[0] for name, text in texts.items()}
    links = "".join(f'<a href="{name}.html">{escape(title)}</a>\n' for name, title in titles.items())
    for name, text in texts.items():
        body = Markdown(extensions=["tables", "fenced_code", "toc", "sane_lists"]).convert(text)
        body = re.sub(r'<a href="([^"]*)">(.*?)</a>', _link, body, flags=re.DOTALL)
        body = re.sub(r'(?<=src=")[^"]*', lambda found: _copied(found[0], folder), body)
        page = _TEMPLATE.format(title=escape(titles[name]), links=links, body=body)
        (folder / f"{name}.html").write_text(page, encoding="utf-8", newline="\n")


def _link(found: re.Match[str]) -> str:
    """Return a link to a page of the manual or another site, else only its text."""
    target, text = found.groups()
    name, _, section = target.partition("#")
    if name.removesuffix(".md") in PAGES:
        target = f"{name.removesuffix('.md')}.html" + (f"#{section}" if section else "")
    elif name and not name.startswith("https:"):
        return text
    return f'<a href="{target}">{text}</a>'


def _copied(source: str, folder: Path) -> str:
    """Copy a picture to the folder of the manual; return its place there."""
    place = f"pictures/{source.rpartition('pictures/')[2]}"
    (folder / place).parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(PROJECT / "docs" / source, folder / place)
    return place
