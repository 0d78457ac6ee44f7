# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the documentation names exists: links, pictures, files, commands, options, operators, arguments."""

from __future__ import annotations

import ast
import re
import shlex
import textwrap
from argparse import ArgumentParser
from pathlib import Path

import bpy
import pytest

import run
from convwass_addon.applications.morphs.diagnostics import TEXTS
from convwass_addon.cli import program

PROJECT = Path(__file__).resolve().parents[2]
_FOLDERS = (".", "docs", "docs/api", "docs/performance", "docs/scripts", "assets")
PAGES = sorted(path for folder in _FOLDERS for path in (PROJECT / folder).glob("*.md"))
NAMES = [command.name for command in program.COMMANDS]
# Placeholders in examples.
_PLACEHOLDERS = ("COMMAND", "…")
# Pages that name options of other programs or removed options.
_TELLS_OF_OTHERS = (PROJECT / "CHANGELOG.md", *(PROJECT / "docs" / "performance").glob("*.md"))

_LINK = re.compile(r"\]\(([^()\s]+)\)")
_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
_INLINE = re.compile(r"`([^`\n]+)`")
_CALL = re.compile(r"bpy\.ops\.convwass\.(\w+)(\([^`\n]*\))?")

# Files that a page tells the reader to create.
_TO_BE_WRITTEN = ("transport/ring.py", "tests/transport/test_ring.py")

# Largest picture of the walk-through, in bytes.
_LIGHT = 150_000


def shown(page: Path) -> str:
    return page.relative_to(PROJECT).as_posix()


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def prose_of(page: Path) -> str:
    """Return a page without code blocks; inline code broken across lines is joined."""
    return re.sub(r"(?<!\n)\n(?!\n)", " ", _BLOCK.sub("", text_of(page)))


def headings_of(page: Path) -> set[str]:
    """Return the anchors that GitHub gives to the headings of a page."""
    found = re.findall(r"^#+ (.+)$", _BLOCK.sub("", text_of(page)), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in found}


def commands_of(text: str) -> list[str]:
    """Return the command lines in code blocks and inline code that call this project."""
    lines = [line for _, block in _BLOCK.findall(text) for line in re.sub(r"\\\n\s*", "", block).splitlines()]
    lines += _INLINE.findall(re.sub(r"(?<!\n)\n(?!\n)", " ", _BLOCK.sub("", text)))
    return [line.strip() for line in lines if calls_us(line.split()) and not any(p in line for p in _PLACEHOLDERS)]


def calls_us(words: list[str]) -> bool:
    if words[:2] == ["python3", "run.py"] or words[:3] == ["blender", "--command", "convwass"]:
        return True
    return len(words) > 2 and words[0] in NAMES and any(word.startswith("--") or "." in word for word in words[1:])


COMMANDS = sorted(
    {(shown(page), command) for page in PAGES if page.name != "CHANGELOG.md" for command in commands_of(text_of(page))}
)


@pytest.mark.parametrize("page", PAGES, ids=shown)
def test_links_and_pictures_exist(page):
    wrong = []
    for target in _LINK.findall(_BLOCK.sub("", text_of(page))):
        if target.startswith(("http://", "https://")):
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        if not file.exists() or (anchor and anchor not in headings_of(file)):
            wrong.append(target)
    assert wrong == []


def test_comments_name_sections_that_exist():
    code = "\n".join(text_of(path) for path in (PROJECT / "convwass_addon").rglob("*.py"))
    named = {re.sub(r"\s*\n[ #]*", " ", own) for own in re.findall(r'docs/performance,[\s#]+"([^"]+)"', code)}
    pages = (PROJECT / "docs" / "performance").glob("*.md")
    assert len(named) > 10
    assert named <= {heading for page in pages for heading in re.findall(r"^## (.+)$", text_of(page), re.MULTILINE)}


def test_there_is_something_to_test():
    assert len(PAGES) > 10
    assert len(COMMANDS) > 40
    assert len([page for page in PAGES if _CALL.search(text_of(page))]) > 2


@pytest.mark.parametrize(("page", "command"), COMMANDS)
def test_commands_are_understood(page, command):
    words = shlex.split(command, comments=True)
    if words[:2] == ["python3", "run.py"]:
        understood_by_run(words[2:])
    else:
        understood_by_convwass(words[3:] if words[0] == "blender" else words)


def understood_by_run(words: list[str]) -> None:
    """Fail unless run.py accepts a command and those of its arguments that the project defines."""
    _, words = run.take_option("--python", run.pythons.WANTED, words)
    if words in (["help"], ["--help"]):
        return
    assert words[0] in run.COMMANDS
    if words[:3] == ["python", "-m", "convwass_addon"]:
        understood_by_convwass(words[3:])
    elif words[0] == "test":
        run.take_option("--blender", run.pythons.BLENDERS, words[1:])
    elif words[0] == "python" and words[1:] and words[1].endswith(".py"):
        assert (PROJECT / words[1]).is_file()


def understood_by_convwass(words: list[str]) -> None:
    try:
        options = program.command_line_parser("convwass").parse_args(words)
    except SystemExit as stop:
        assert stop.code == 0, words
    else:
        # Commands refuse to overwrite their inputs.
        files = [re.sub(r"\.blend:.*", ".blend", word) for word in words]
        assert files.count(str(getattr(options, "out", None))) <= 1, words


def test_a_wrong_command_is_detected():
    with pytest.raises(AssertionError):
        understood_by_convwass(["morph", "a.obj", "b.obj", "--no-such-option"])
    with pytest.raises(AssertionError):
        understood_by_run(["pakcage"])


@pytest.mark.parametrize("page", [page for page in PAGES if page not in _TELLS_OF_OTHERS], ids=shown)
def test_options_exist(page):
    known = {"--python", "--blender", "--check", "--help", "--command", "--only", "--out", "--glb"}
    # Options of the tests that install the extension.
    known |= {"--zip", "--from-zip"}
    # Of a benchmark.
    known |= {"--poses"}
    for command in program.COMMANDS:
        parser = ArgumentParser()
        command.add_options(parser)
        known |= set(re.findall(r"--[a-z][\w-]*", parser.format_help()))
    named = {word for code in _INLINE.findall(prose_of(page)) for word in re.findall(r"(?<!\S)--[a-z][a-z-]*", code)}
    assert named <= known


@pytest.mark.usefixtures("registered_addon")
@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=shown)
def test_operators_and_their_arguments_exist(page):
    for name, arguments in _CALL.findall(text_of(page)):
        if name == "NAME":
            continue
        assert name in dir(bpy.ops.convwass), name
        if arguments and "..." not in arguments and "…" not in arguments:
            keywords = {keyword.arg for keyword in ast.parse(f"f{arguments}", mode="eval").body.keywords}
            assert keywords <= set(getattr(bpy.ops.convwass, name).get_rna_type().properties.keys())


@pytest.mark.parametrize("page", PAGES, ids=shown)
def test_python_compiles_and_its_imports_exist(page):
    blocks = [textwrap.dedent(block) for kind, block in _BLOCK.findall(text_of(page)) if kind == "python"]
    imports = []
    for block in blocks:
        tree = ast.parse(block)
        imports += [ast.unparse(node) for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    exec("\n".join(dict.fromkeys(imports)), {})


def named_files(page: Path) -> list[str]:
    return [
        code for code in _INLINE.findall(prose_of(page)) if re.fullmatch(r"[\w.]+(/[\w.]+)+\.(py|md|js|toml)", code)
    ]


@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=shown)
def test_named_files_exist(page):
    places = (
        PROJECT,
        PROJECT / "convwass_addon",
        PROJECT / "convwass_addon/applications",
        PROJECT / "docs",
        page.parent,
    )
    named = [name for name in named_files(page) if name not in _TO_BE_WRITTEN]
    assert [name for name in named if not any((place / name).is_file() for place in places)] == []


def test_pictures_of_the_walk_through_are_small_and_all_used():
    pictures = {path.name: path.stat().st_size for path in (PROJECT / "docs/pictures/walkthrough").glob("*.jpg")}
    heavy = [name for name, size in pictures.items() if size > _LIGHT]
    assert not heavy, heavy
    used = set(re.findall(r"pictures/walkthrough/([\w.]+)", text_of(PROJECT / "docs/walkthrough.md")))
    assert used == set(pictures) != set()


def test_the_commands_of_run_py_are_documented_in_contributing():
    text = text_of(PROJECT / "CONTRIBUTING.md") + text_of(PROJECT / "docs/extending.md")
    assert [command for command in ("test", "lint", "api", "bench", "window") if f"run.py {command}" not in text] == []


def test_troubleshooting_quotes_every_diagnostic():
    page = text_of(PROJECT / "docs/troubleshooting.md")
    quotes = {re.sub(r"\{[^}]*\}", "…", text) for text in TEXTS.values()}
    assert [quote for quote in quotes if f"`{quote}`" not in page] == []
