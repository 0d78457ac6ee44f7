# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's zip files contain exactly what is needed, with the same bytes each time."""

from __future__ import annotations

import os
import re
import runpy
import shutil
import tomllib
import zipfile
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

from tools import builder, package
from tools.manual import PAGES

WHEELS = (
    "cholespy-2.2.0-cp311-cp311-macosx_11_0_arm64.whl",
    "cholespy-2.2.0-cp311-cp311-manylinux_2_27_x86_64.manylinux_2_28_x86_64.whl",
    "cholespy-2.2.0-cp311-cp311-win_amd64.whl",
    "cholespy-2.2.0-cp312-abi3-macosx_11_0_arm64.whl",
    "cholespy-2.2.0-cp312-abi3-manylinux_2_27_x86_64.manylinux_2_28_x86_64.whl",
    "cholespy-2.2.0-cp312-abi3-win_amd64.whl",
    "lazy_loader-0.6-py3-none-any.whl",
    "robust_laplacian-1.1.0-cp311-cp311-macosx_11_0_arm64.whl",
    "robust_laplacian-1.1.0-cp311-cp311-manylinux_2_24_x86_64.manylinux_2_28_x86_64.whl",
    "robust_laplacian-1.1.0-cp311-cp311-win_amd64.whl",
    "robust_laplacian-1.1.0-cp313-cp313-macosx_11_0_arm64.whl",
    "robust_laplacian-1.1.0-cp313-cp313-manylinux_2_24_x86_64.manylinux_2_28_x86_64.whl",
    "robust_laplacian-1.1.0-cp313-cp313-win_amd64.whl",
    "scikit_image-0.26.0-cp311-cp311-macosx_11_0_arm64.whl",
    "scikit_image-0.26.0-cp311-cp311-manylinux_2_24_x86_64.manylinux_2_28_x86_64.whl",
    "scikit_image-0.26.0-cp311-cp311-win_amd64.whl",
    "scikit_image-0.26.0-cp313-cp313-macosx_11_0_arm64.whl",
    "scikit_image-0.26.0-cp313-cp313-manylinux_2_24_x86_64.manylinux_2_28_x86_64.whl",
    "scikit_image-0.26.0-cp313-cp313-win_amd64.whl",
    "scipy-1.17.1-cp311-cp311-macosx_12_0_arm64.whl",
    "scipy-1.17.1-cp311-cp311-manylinux_2_27_x86_64.manylinux_2_28_x86_64.whl",
    "scipy-1.17.1-cp311-cp311-win_amd64.whl",
    "scipy-1.17.1-cp313-cp313-macosx_12_0_arm64.whl",
    "scipy-1.17.1-cp313-cp313-manylinux_2_27_x86_64.manylinux_2_28_x86_64.whl",
    "scipy-1.17.1-cp313-cp313-win_amd64.whl",
    "threadpoolctl-3.8.0-py3-none-any.whl",
)

# The client of Dask clusters; the manifest requests no network permission.
NOT_SHIPPED = {"convwass_addon/cluster.py"}


def names_in(path: Path) -> list[str]:
    with zipfile.ZipFile(path) as archive:
        return archive.namelist()


def manifest_in(path: Path) -> dict:
    with zipfile.ZipFile(path) as archive:
        return tomllib.loads(archive.read("blender_manifest.toml").decode())


def without_manual(path: Path) -> list[str]:
    """Return the names in a zip file without the pages of the manual and their pictures."""
    return [name for name in names_in(path) if not name.startswith("convwass_addon/pages/")]


def shipped_files(project: Path) -> list[str]:
    """Everything that the extension needs: two files for Blender, the license, its own modules and translations."""
    found = (path for kind in ("*.py", "*.po") for path in (project / "convwass_addon").rglob(kind))
    package_files = {path.relative_to(project).as_posix() for path in found}
    assert package_files >= NOT_SHIPPED
    return sorted(["LICENSE", "__init__.py", "blender_manifest.toml", *package_files - NOT_SHIPPED])


@pytest.fixture(scope="module")
def wheels(tmp_path_factory) -> Path:
    """A folder of files that stand in for wheels."""
    folder = tmp_path_factory.mktemp("wheels")
    for name in WHEELS:
        (folder / name).write_bytes(b"stands in for a wheel")
    return folder


@pytest.fixture(scope="module")
def small(tmp_path_factory) -> tuple[Path, str]:
    """The small zip, built by the command line, and what this printed."""
    folder = tmp_path_factory.mktemp("first")
    with redirect_stdout(StringIO()) as said:
        assert package.main(["--no-wheels", "--output", str(folder)]) == 0
    (path,) = folder.glob("*.zip")
    return path, said.getvalue()


@pytest.fixture(scope="module")
def zips(small, wheels, tmp_path_factory) -> list[Path]:
    """The small zip and those of the platforms, which no test changes."""
    folder = tmp_path_factory.mktemp("platforms")
    return [small[0], *package.build_platforms(folder / "work", wheels, folder)]


def test_the_small_zip_contains_exactly_what_is_needed(project, zips):
    assert without_manual(zips[0]) == shipped_files(project)
    pages = {Path(name).name for name in names_in(zips[0]) if name.endswith(".html")}
    assert pages == {f"{name}.html" for name in PAGES}
    assert "wheels" not in manifest_in(zips[0])


def test_blenders_own_command_builds_the_same_files(project, tmp_path):
    """``blender --command extension build`` in the project; extra files belong in paths_exclude_pattern."""
    builder.build(project, output=tmp_path)
    (path,) = tmp_path.glob("*.zip")
    assert sorted(names_in(path)) == shipped_files(project)


def test_same_source_gives_the_same_bytes(zips, wheels, tmp_path, monkeypatch):
    """At another time, in another folder, and independent of the permissions for new files."""
    other = tmp_path / "other source"
    shutil.copytree(package.PROJECT / "convwass_addon", other / "convwass_addon")
    for name in package.SHIPPED:
        if (package.PROJECT / name).is_file():
            shutil.copyfile(package.PROJECT / name, other / name)
    for path in other.rglob("*"):
        os.utime(path, (1e9, 1e9))
    monkeypatch.setattr(package, "PROJECT", other)
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    mask = os.umask(0o077)
    try:
        work, output = tmp_path / "work", tmp_path / "ë elsewhere"
        again = [package.build_small(work, output), *package.build_platforms(work, wheels, output)]
        assert [path.read_bytes() for path in again] == [path.read_bytes() for path in zips]
    finally:
        os.umask(mask)


def test_each_platform_gets_its_own_wheels_for_both_pythons(project, zips):
    own = zips[1:]
    assert len(own) == len(package.PLATFORMS)
    for path, platform, tag in zip(own, sorted(package.PLATFORMS), ("manylinux", "macosx", "win"), strict=True):
        bundled = [Path(name).name for name in names_in(path) if name.startswith("wheels/")]
        assert bundled == [name for name in WHEELS if tag in name or name.endswith("none-any.whl")]
        assert [name for name in without_manual(path) if not name.startswith("wheels/")] == shipped_files(project)
        generated = manifest_in(path)["build"]["generated"]
        assert generated["platforms"] == [platform]
        assert sorted(Path(name).name for name in generated["wheels"]) == bundled


def test_blender_accepts_the_wheels_of_each_platform_on_both_pythons():
    """Blender rejects an extension for a Python that none of its wheels names; abi3 wheels name none."""
    taken_on = runpy.run_path(str(builder.program()), run_name="blender_ext")["python_versions_from_wheels"]
    for tag in ("manylinux", "macosx", "win"):
        assert taken_on([name for name in WHEELS if tag in name]) == {(3, 11), (3, 13)}


def test_every_platform_and_python_has_a_wheel_of_each_package(project):
    listed = (project / "tools" / "wheels.txt").read_text(encoding="utf-8")
    pins = re.findall(r"^([\w-]+)==(\S+)((?: \\\n +--hash=sha256:\w{64})+)$", listed, flags=re.MULTILINE)
    assert {(name.replace("-", "_"), version) for name, version, _ in pins} == {tuple(w.split("-")[:2]) for w in WHEELS}
    for name, _, hashes in pins:
        is_plain_python = name in ("lazy-loader", "threadpoolctl")
        assert len(hashes.split("--hash=")) - 1 == (
            1 if is_plain_python else len(package.PLATFORMS) * len(package.PYTHONS)
        )


def test_the_tracked_manifest_is_only_read(project):
    text = (project / "blender_manifest.toml").read_text(encoding="utf-8")
    stated = tomllib.loads(package.manifest_with_wheels(text, list(WHEELS)))
    assert stated.pop("platforms") == list(package.PLATFORMS)
    assert stated.pop("wheels") == [f"./wheels/{name}" for name in WHEELS]
    assert stated == tomllib.loads(text)


def test_command_line_reports_what_it_built(small):
    path, said = small
    assert str(path) in said


def test_failure_is_a_message_and_an_exit_code(tmp_path, capsys, monkeypatch):
    def refuse(*_, **__):
        raise builder.BuilderError("tagline too long")

    monkeypatch.setattr(builder, "build", refuse)
    assert package.main(["--no-wheels", "--output", str(tmp_path)]) == 1
    assert "tagline too long" in capsys.readouterr().err
