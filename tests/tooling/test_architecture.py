# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The architecture and the style: which package may import which, license headers, formatting."""

from __future__ import annotations

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE = PROJECT / "convwass_addon"

SOURCE_FOLDERS = ("assets", "benchmarks", "convwass_addon", "docs", "tests", "tools")
SOURCES = sorted(
    [*PROJECT.glob("*.py"), *(path for folder in SOURCE_FOLDERS for path in (PROJECT / folder).rglob("*.py"))]
)

BLENDER = {
    "addon_utils",
    "aud",
    "bl_ui",
    "blf",
    "bmesh",
    "bpy",
    "bpy_extras",
    "freestyle",
    "gpu",
    "idprop",
    "mathutils",
}

MAY_IMPORT = {
    "sentence": set(),
    "errors": {"sentence"},
    "schema": {"errors", "sentence"},
    "progress": {"errors", "sentence"},
    "disk_space": {"errors", "sentence"},
    "drafts": {"disk_space", "errors", "sentence"},
    "one_line": set(),
    "transport": {"errors", "one_line", "progress", "sentence", "geometry"},
    "geometry": {"errors", "one_line", "progress", "sentence"},
    "array_files": set(),
    "applications": {
        "array_files",
        "drafts",
        "errors",
        "one_line",
        "progress",
        "schema",
        "sentence",
        "transport",
        "geometry",
    },
    "bridge": {
        "array_files",
        "disk_space",
        "drafts",
        "errors",
        "progress",
        "schema",
        "sentence",
        "transport",
        "geometry",
        "applications",
    },
    "properties": {"errors", "progress", "schema", "sentence", "applications", "bridge"},
    "presets": set(),
    "solver_presets": {"applications", "errors", "schema", "sentence"},
    "preferences": {"sentence", "solver_presets"},
    "manual": set(),
    "translations": {"sentence"},
    "operators": {
        "drafts",
        "errors",
        "progress",
        "sentence",
        "applications",
        "bridge",
        "preferences",
        "properties",
        "solver_presets",
        "translations",
    },
    "panels": {
        "errors",
        "progress",
        "schema",
        "sentence",
        "applications",
        "bridge",
        "properties",
        "operators",
        "solver_presets",
        "translations",
    },
    "cluster": {"applications", "errors", "progress", "sentence"},
    "console": {"errors", "progress", "sentence"},
    "cli": {"drafts", "errors", "progress", "schema", "sentence", "applications", "bridge", "cluster", "console"},
    "__main__": {"cli", "console", "errors", "progress", "sentence"},
    "__init__": {
        "cli",
        "manual",
        "operators",
        "panels",
        "preferences",
        "properties",
        "solver_presets",
        "translations",
    },
}
"""For each module or subpackage of the add-on, the others that it may import."""

GEOMETRY = (
    "arrays",
    "algebra",
    "plane",
    "grids",
    "meshes",
    "remeshing",
    "level_sets",
    "solids",
    "recognition",
    "deformation",
)
"""The packages of geometry/; each may import those before it."""

WITHOUT_BLENDER = (
    "array_files",
    "disk_space",
    "drafts",
    "errors",
    "progress",
    "schema",
    "sentence",
    "transport",
    "geometry",
    "applications",
    "cluster",
    "console",
)


def modules() -> list[str]:
    return sorted(path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py"))


def package_of(module: str) -> str:
    return Path(module).parts[0].removesuffix(".py")


@cache
def imports_of(module: str) -> list[tuple[int, str]]:
    """Return line and full name of every import in a module, including those inside functions.

    Relative imports are written as paths from ``.``, the add-on's package.
    """
    folder, found = Path(module).parts[:-1], []
    for node in ast.walk(ast.parse((PACKAGE / module).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = [".", *folder[: len(folder) - node.level + 1]] if node.level else []
            parts = [*start, *(node.module or "").split(".")]
            found += [(node.lineno, "/".join([*filter(None, parts), alias.name])) for alias in node.names]
    return found


def complaint(package: str, name: str) -> str | None:
    """Return why `package` may not import `name`, or None if it may."""
    first, *rest = name.split("/")
    if first == ".":
        is_forbidden = rest[0] in MAY_IMPORT.keys() - MAY_IMPORT[package] - {package}
        return f"{package} may not import {rest[0]}" if is_forbidden else None
    library = first.partition(".")[0]
    if library == "convwass_addon":
        return "use a relative import; absolute ones fail in an installed extension"
    return f"{package} must not import Blender" if library in BLENDER and package in WITHOUT_BLENDER else None


def test_all_packages_are_covered():
    assert {package_of(module) for module in modules()} <= MAY_IMPORT.keys()


def test_imports_point_one_way():
    found = [
        f"{module}:{line}: {wrong}"
        for module in modules()
        for line, name in imports_of(module)
        if (wrong := complaint(package_of(module), name))
    ]
    assert found == []


@pytest.mark.parametrize(
    ("package", "name"),
    [
        ("transport", "bpy"),
        ("transport", "bpy.types"),
        ("transport", "./applications/morph"),
        ("geometry", "./transport"),
        ("geometry", "mathutils/Vector"),
        ("applications", "./bridge/objects"),
        ("bridge", "./operators"),
        ("operators", "convwass_addon/errors"),
    ],
)
def test_violations_are_found(package, name):
    assert complaint(package, name)


def geometry_complaint(module: str, name: str) -> str | None:
    """Return why a module of geometry/ may not import `name`, or None if it may."""
    package, imported = (Path(path).parts[1] for path in (module, name))
    if GEOMETRY.index(imported) > GEOMETRY.index(package):
        return f"geometry/{package} may not import geometry/{imported}"
    return None


def test_all_packages_of_geometry_are_covered():
    assert {path.name for path in (PACKAGE / "geometry").iterdir() if any(path.glob("*.py"))} == set(GEOMETRY)


def test_imports_within_geometry_point_one_way():
    found = [
        f"{module}:{line}: {wrong}"
        for module in modules()
        if package_of(module) == "geometry" and module != "geometry/__init__.py"
        for line, name in imports_of(module)
        if name.startswith("./geometry/") and (wrong := geometry_complaint(module, name.removeprefix("./")))
    ]
    assert found == []


def test_violations_within_geometry_are_found():
    assert geometry_complaint("geometry/arrays/chunks.py", "geometry/meshes/mesh/TriangleMesh")
    assert geometry_complaint("geometry/meshes/edges.py", "geometry/meshes/mesh/TriangleMesh") is None


def imported_modules(module: str) -> set[str]:
    """Return the add-on's modules that a module imports, including imports in functions and for annotations."""
    found = set()
    for _, name in imports_of(module):
        parts = name.split("/")[1:] if name.startswith("./") else []
        # The last part is either a module or a name in one.
        candidates = ["/".join(taken) for taken in (parts, parts[:-1]) if taken]
        files = [f"{path}{end}" for path in candidates for end in (".py", "/__init__.py")]
        found.update([file for file in files if (PACKAGE / file).is_file()][:1])
    return found - {module}


def test_there_are_no_import_cycles():
    imports = {module: imported_modules(module) for module in modules()}
    with_imports = sum(map(bool, imports.values()))
    assert with_imports > 300
    while imports:
        free = {module for module, needed in imports.items() if not needed & imports.keys()}
        assert free, f"these modules import each other: {sorted(imports)}"
        imports = {module: needed for module, needed in imports.items() if module not in free}


def test_numerical_code_does_not_load_blender():
    """Importing any of these modules must not load bpy indirectly either."""
    names = [module for module in modules() if package_of(module) in WITHOUT_BLENDER]
    assert len(names) > 100
    dotted = [".".join(("convwass_addon", *Path(name).with_suffix("").parts)) for name in names]
    script = (
        "import sys, importlib\n"
        "for name in sys.argv[1:]:\n"
        "    importlib.import_module(name.removesuffix('.__init__'))\n"
        "    assert 'bpy' not in sys.modules, name"
    )
    subprocess.run([sys.executable, "-c", script, *dotted], cwd=PROJECT, check=True)


def license_lines(source: Path) -> list[str]:
    """Return the first two lines of a file after a shebang."""
    lines = [line for line in source.read_text(encoding="utf-8").splitlines() if not line.startswith("#!")]
    return lines[:2]


def test_sources_state_their_license():
    expected = ["# SPDX-FileCopyrightText: 2026 Convwass authors", "# SPDX-License-Identifier: GPL-3.0-or-later"]
    without = [source.relative_to(PROJECT).as_posix() for source in SOURCES if license_lines(source) != expected]
    assert without == []
    assert len(SOURCES) > 800


@pytest.mark.parametrize("command", [["check"], ["format", "--check", "--diff"]], ids=["check", "format"])
def test_style(command):
    answer = subprocess.run(
        [sys.executable, "-m", "ruff", *command, "--no-cache"], cwd=PROJECT, capture_output=True, text=True
    )
    assert answer.returncode == 0, answer.stdout + answer.stderr
