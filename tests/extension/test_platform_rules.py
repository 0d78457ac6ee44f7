# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules of Blender's extension platform, checked in the manifest and in everything shipped.

See https://developer.blender.org/docs/features/extensions/moderation/guidelines/ and the chapter on extensions in
Blender's manual.
"""

from __future__ import annotations

import ast
import re
import struct
import sys
import tomllib
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

import convwass_addon
from convwass_addon import cluster
from convwass_addon.cli import morph_baking
from convwass_addon.cli.morph_choices import Computing
from convwass_addon.errors import InputError

PACKAGE = Path(convwass_addon.__file__).parent
PROJECT = PACKAGE.parent
LISTING = PROJECT / "assets" / "listing"
NOT_SHIPPED = {"cluster.py"}
SHIPPED = sorted({path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py")} - NOT_SHIPPED)

# Only these may use their own path, only to read: pages, presets, translations, samples of a checkout, source files.
MAY_LOOK_AROUND = {
    "manual.py",
    "solver_presets.py",
    "translations/__init__.py",
    "cli/demo_command.py",
    "applications/morphs/code_digest.py",
}
NETWORK = {"asyncio", "dask", "distributed", "ftplib", "http", "requests", "smtplib", "socket", "ssl", "urllib"}
NETWORK |= {"webbrowser", "xmlrpc"}
PROCESSES = {"multiprocessing", "pip", "subprocess"}


@pytest.fixture(scope="module")
def manifest() -> dict:
    return tomllib.loads((PROJECT / "blender_manifest.toml").read_text(encoding="utf-8"))


def source(name: str) -> str:
    return (PACKAGE / name).read_text(encoding="utf-8")


def tree(name: str) -> ast.Module:
    """Return the syntax tree of a file. With all of them in memory, each would take twice as long."""
    return ast.parse(source(name))


def imported(nodes: list[ast.AST]) -> set[str]:
    """Return the external modules that the nodes of a file import."""
    found = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add((node.module or "").partition(".")[0])
    return found


def used(nodes: list[ast.AST]) -> set[str]:
    """Return the names in the nodes of a file, including those with one dot."""
    dotted = (node for node in nodes if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name))
    return {node.id for node in nodes if isinstance(node, ast.Name)} | {f"{n.value.id}.{n.attr}" for n in dotted}


def complaints(name: str) -> list[str]:
    """Return what a reviewer would question in a file."""
    known = {
        "__file__": name in MAY_LOOK_AROUND,
        "print": name == "console.py" or name.startswith("cli/"),
        **dict.fromkeys(("eval", "exec", "__import__", "os.system", "sys.path", "pickle"), False),
    }
    words = set(re.findall(r"\w+", source(name)))
    if not any(words.issuperset(what.split(".")) for what in (*known, *NETWORK, *PROCESSES)):
        return []
    nodes = list(ast.walk(tree(name)))
    asked = {what for what in used(nodes) & known.keys() if not known[what]} | imported(nodes) & (NETWORK | PROCESSES)
    return [f"{name}: {what}" for what in sorted(asked)]


def test_the_manifest_has_exactly_the_required_entries(manifest):
    texts = [manifest["tagline"], *manifest["permissions"].values()]
    assert all(len(text) <= 64 and text[-1].isalnum() for text in texts)
    # No network, no clipboard, no camera.
    assert list(manifest["permissions"]) == ["files"]
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert not {"website", "blender_version_max", "platforms", "wheels"} & manifest.keys()
    assert all(owner.partition(" ")[0].isdigit() for owner in manifest["copyright"])


@pytest.mark.parametrize(
    ("name", "size", "most", "color"), [("icon.png", (256, 256), 120e3, 6), ("featured.png", (1920, 1080), 3e6, 2)]
)
def test_pictures_of_the_listing_have_the_required_sizes(name, size, most, color):
    """The icon has a transparent background, because it appears on any color."""
    data = (LISTING / name).read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n") and data[12:16] == b"IHDR"
    *found, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert (tuple(found), depth, kind) == (size, 8, color)
    assert len(data) < most
    # By default, Blender writes file name and date into pictures.
    assert not re.search(rb"tEXt(File|Date|Hostname)\0", data)


def test_the_listing_names_all_contents_and_permissions(manifest):
    text = (LISTING / "description.md").read_text(encoding="utf-8")
    wheels = re.findall(r"(?m)^([a-z-]+)==", (PROJECT / "tools" / "wheels.txt").read_text(encoding="utf-8"))
    assert len(wheels) >= 6
    listed = re.findall(r"(?m)^- ([A-Za-z-]+): [A-Z]", text)
    assert sorted(map(str.lower, listed)) == sorted(wheels)
    permissions = re.findall(r"(?m)^- \*\*(\w+)\*\*: ", text.partition("## Permissions")[2])
    assert sorted(map(str.lower, permissions)) == sorted(manifest["permissions"])


def test_the_listing_has_no_links():
    """Links would be taken for those of the project, which has no website."""
    assert not re.search(r"https?:|www\.", (LISTING / "description.md").read_text(encoding="utf-8"))


def test_the_listing_is_not_shipped(manifest):
    assert "/assets/" in manifest["build"]["paths_exclude_pattern"]


def test_the_message_of_a_blender_that_is_too_old_is_documented(manifest):
    page = (PROJECT / "docs" / "walkthrough.md").read_text(encoding="utf-8")
    assert f"doesn't meet the minimum supported version ({manifest['blender_version_min']})" in page


def test_tags_are_known_to_blender(manifest):
    pytest.importorskip("bpy")  # makes Blender's own modules importable
    from _bpy_internal.extensions.tags import addons

    assert set(manifest["tags"]) <= addons


def test_no_file_breaks_the_rules_of_reviewers():
    assert [complaint for name in SHIPPED for complaint in complaints(name)] == []
    assert len(SHIPPED) > 300


def test_importing_a_file_has_no_side_effects():
    """Except for tables built from constants."""
    kinds = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign)
    found = []
    # The first is a program, presets are run when chosen.
    for name in (name for name in SHIPPED if name != "__main__.py" and not name.startswith("presets/")):
        for node in tree(name).body:
            is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            is_for_types = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
            if not (isinstance(node, kinds) or is_text or is_for_types):
                found.append(f"{name}:{node.lineno}")
    assert found == []


@pytest.mark.parametrize("is_there", [True, False])
@pytest.mark.parametrize("name", ["bl_ext.user_default.convwass", "convwass_addon"])
def test_the_installed_extension_stays_off_the_network(monkeypatch, name, is_there):
    """Under its name in Blender, and if the file excluded from the zip is missing."""
    asked = []
    monkeypatch.setattr(cluster, "cluster_workers", lambda address: asked.append(address) or nullcontext())
    if not is_there:
        monkeypatch.setitem(sys.modules, "convwass_addon.cluster", None)
    monkeypatch.setattr(morph_baking, "extension_id", lambda: name)
    if is_there and name == "convwass_addon":
        idle = SimpleNamespace(steps=lambda computation: (report for report in ()))
        morph_baking.run_job(idle, Computing(scheduler="tcp://192.0.2.1:8786"), print)
        assert asked == ["tcp://192.0.2.1:8786"]
        return
    with pytest.raises(InputError, match="does not use the network"):
        morph_baking.run_job(None, Computing(scheduler="tcp://192.0.2.1:8786"), print)
    assert asked == []
