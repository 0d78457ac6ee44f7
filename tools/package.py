# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the extension: a small zip for Blender versions that include SciPy, and one with wheels per platform.

Everything happens in ``build/``; the tracked manifest is only read. The zip files contain the manual as HTML. They are
rewritten with sorted entries and a fixed date, so that the same source gives the same bytes.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from . import builder
from .manual import write_manual

PROJECT = Path(__file__).resolve().parents[1]

SHIPPED = ("__init__.py", "blender_manifest.toml", "LICENSE", "convwass_addon")
"""The files and folders of the extension."""

PLATFORMS = {
    "linux-x64": ("manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux_2_24_x86_64", "manylinux2014_x86_64"),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_12_0_arm64", "macosx_11_0_arm64"),
}
"""Blender's platform names, each with the wheel tags that run on every system Blender supports there."""

PYTHONS = ("311", "313")
"""The Python versions of Blender 4.5 to 5.0, and of 5.1 to 5.2."""

_DATE = (1980, 1, 1, 0, 0, 0)  # earliest date of the zip format


def main(arguments: list[str] | None = None) -> int:
    """Build the requested zip files, print their sizes and return the exit code."""
    parser = argparse.ArgumentParser(prog="run.py package", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--output", type=Path, default=PROJECT / "dist", help="folder for the zip files (default: dist)"
    )
    parser.add_argument("--no-wheels", action="store_true", help="build only the small zip; fast, needs no network")
    options = parser.parse_args(arguments)
    build = PROJECT / "build"
    try:
        build.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="package-", dir=build) as work:
            zips = [build_small(Path(work), options.output)]
            if not options.no_wheels:
                download_wheels(build / "wheels")
                zips += build_platforms(Path(work), build / "wheels", options.output)
    except (builder.BuilderError, OSError) as error:
        print(f"run.py package: {error}", file=sys.stderr)
        return 1
    for path in zips:
        print(f"{path.stat().st_size / 1e6:8.2f} MB  {path}")
    return 0


def build_small(work: Path, output: Path) -> Path:
    """Build the zip without wheels and return its path.

    Parameters
    ----------
    work : Path
        Folder to build in.
    output : Path
        Folder for the zip file; created if missing.

    Raises
    ------
    builder.BuilderError
        If Blender's builder rejects the extension.
    """
    stage = work / "source"
    _copy_shipped(stage)
    return _build(stage, work / "small", output, split_platforms=False)[0]


def build_platforms(work: Path, wheels: Path, output: Path) -> list[Path]:
    """Build one zip per platform, with its wheels, and return the paths.

    Parameters
    ----------
    work, output
        As in `build_small`.
    wheels : Path
        Folder filled by `download_wheels`.

    Raises
    ------
    builder.BuilderError
        If Blender's builder rejects the extension.
    """
    stage = work / "source"
    _copy_shipped(stage)
    names = sorted(wheel.name for wheel in wheels.glob("*.whl"))
    (stage / "wheels").mkdir()
    for name in names:
        _link_or_copy(wheels / name, stage / "wheels" / name)
    manifest = stage / "blender_manifest.toml"
    stated = manifest_with_wheels(manifest.read_text(encoding="utf-8"), names)
    manifest.write_text(stated, encoding="utf-8", newline="\n")
    return _build(stage, work / "platforms", output, split_platforms=True)


def manifest_with_wheels(manifest: str, wheels: list[str]) -> str:
    """Return the text of a manifest with platforms and wheels inserted before its first table."""
    lines = ["platforms = [", *(f'    "{name}",' for name in PLATFORMS), "]"]
    lines += ["wheels = [", *(f'    "./wheels/{name}",' for name in wheels), "]"]
    head, table, tail = manifest.partition("\n[")
    return head + "\n" + "\n".join(lines) + "\n" + table + tail


def download_wheels(folder: Path) -> None:
    """Fill a folder with exactly the wheels of ``wheels.txt`` for every platform and Python version.

    Raises
    ------
    builder.BuilderError
        If pip cannot download them.
    """
    print(f"downloading the wheels for {', '.join(PLATFORMS)} (about 320 MB, unless pip has them already)", flush=True)
    shutil.rmtree(folder, ignore_errors=True)
    for tags in PLATFORMS.values():
        for python in PYTHONS:
            command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
            command += ["--only-binary=:all:", "--implementation=cp", f"--python-version={python}", f"--abi=cp{python}"]
            command += [f"--platform={tag}" for tag in tags]
            command += ["--require-hashes", f"--requirement={PROJECT / 'tools' / 'wheels.txt'}", f"--dest={folder}"]
            if subprocess.run(command).returncode:
                raise builder.BuilderError("the wheels could not be downloaded; pip's message is above")


def _copy_shipped(stage: Path) -> None:
    """Copy only the files of the extension, so that no stray file of the project is shipped."""
    shutil.rmtree(stage, ignore_errors=True)
    stage.mkdir(parents=True)
    for name in SHIPPED:
        source = PROJECT / name
        if source.is_dir():
            shutil.copytree(source, stage / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copyfile(source, stage / name)
    write_manual(stage / "convwass_addon" / "pages")


def _build(stage: Path, built: Path, output: Path, *, split_platforms: bool) -> list[Path]:
    """Build the staged files, make the zip reproducible, validate it and move it to the output folder."""
    shutil.rmtree(built, ignore_errors=True)
    builder.build(stage, output=built, split_platforms=split_platforms)
    output.mkdir(parents=True, exist_ok=True)
    results = []
    for path in sorted(built.glob("*.zip")):
        print(f"building {path.name}", flush=True)
        result = output / path.name
        _rewrite(path, result)
        builder.validate(result)
        results.append(result)
    return results


def _rewrite(source: Path, target: Path) -> None:
    """Copy a zip file with sorted entries and without traces of when and where it was built."""
    unfinished = target.with_suffix(".new")
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(unfinished, "w") as new:
        for entry in sorted(old.infolist(), key=lambda entry: entry.filename):
            plain = zipfile.ZipInfo(entry.filename, _DATE)
            plain.compress_type = entry.compress_type
            plain.create_system = 3  # Unix, on every system, because Unix permissions follow
            plain.external_attr = 0o100644 << 16
            new.writestr(plain, old.read(entry), compresslevel=9)
    unfinished.replace(target)


def _link_or_copy(source: Path, target: Path) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)


if __name__ == "__main__":
    sys.exit(main())
