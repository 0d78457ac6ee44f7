# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Use the extension in a real Blender window, with mouse and keys, on a virtual display.

python3 run.py window --blender PATH [--zip ZIP] [--out FOLDER] [--only SCENARIO...]

Installs the extension into a fresh profile, opens Blender's window on a virtual display and runs scenarios that click,
type and take pictures, which are saved in the folder. A scenario is a file next to this one with a function of the same
name. Needs Linux with Xvfb, xdotool and ImageMagick; with ``--zip``, any Python from 3.11 on can run it.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[1]

# Programs and their Debian packages.
NEEDED = {"Xvfb": "xvfb", "xdotool": "xdotool", "import": "imagemagick"}

SCENARIOS = (
    "armatures",
    "soft_maps",
    "densities",
    "recolor",
    "light",
    "flat",
    "elsewhere",
    "newcomer",
    "morphs",
    "live",
    "guides",
    "assets",
    "two_meshes",
    "disabling",
)
# Run only on request, because they test little.
PICTURES = ("walkthrough",)

_SETTINGS = """
import bpy
view = bpy.context.preferences.view
view.show_splash = False
bpy.context.preferences.filepaths.use_auto_save_temporary_files = False
bpy.context.preferences.use_preferences_save = False
bpy.ops.wm.save_userpref()
"""


def main() -> int:
    """Run the scenarios; return 0 if all succeeded."""
    options = _options()
    missing = [package for program, package in NEEDED.items() if not shutil.which(program)]
    if missing:
        print(f"The window test needs {' '.join(missing)}: apt install {' '.join(missing)}", file=sys.stderr)
        return 2
    if not shutil.which(options.blender):
        print(f"There is no Blender at {options.blender}.", file=sys.stderr)
        return 2
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="convwass-window-") as scratch:
        profile = Path(scratch) / "profile with späces"
        profile.mkdir()
        environment = {**os.environ, "BLENDER_USER_RESOURCES": str(profile), "LIBGL_ALWAYS_SOFTWARE": "1"}
        zip_file = options.zip or _built_zip(Path(scratch), options.blender)
        _install(options.blender, zip_file, environment)
        with _display(options.size) as display:
            return _use(options, {**environment, "DISPLAY": display})


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="run.py window", description=__doc__.partition("\n")[0])
    parser.add_argument("--blender", required=True, help="the Blender to use")
    parser.add_argument("--zip", type=Path, help="the extension; built from this checkout if left out")
    parser.add_argument("--out", type=Path, default=PROJECT / "out" / "window", help="where pictures go (%(default)s)")
    parser.add_argument("--size", default="1600x1000", help="of the window (%(default)s)")
    parser.add_argument(
        "--only",
        nargs="+",
        choices=(*SCENARIOS, *PICTURES),
        default=SCENARIOS,
        metavar="SCENARIO",
        help="out of: %(choices)s",
    )
    parser.add_argument("--timeout", type=float, default=2400.0, help="seconds until it is stopped (%(default)g)")
    return parser.parse_args()


def _built_zip(folder: Path, blender: str) -> Path:
    """Build the small zip if this Blender has SciPy, otherwise the one for this platform."""
    has_scipy = subprocess.run(
        [blender, "--background", "--python-exit-code", "1", "--python-expr", "import scipy, skimage"],
        capture_output=True,
        check=False,
    )
    small = ["--no-wheels"] if has_scipy.returncode == 0 else []
    subprocess.run(
        [sys.executable, "-m", "tools.package", *small, "--output", str(folder / "dist")], cwd=PROJECT, check=True
    )
    fitting = sorted(path for path in (folder / "dist").glob("*.zip") if small or "linux" in path.name)
    return fitting[0]


def _install(blender: str, zip_file: Path, environment: dict[str, str]) -> None:
    command = [blender, "--background", "--command", "extension", "install-file", "-r", "user_default", "-e"]
    subprocess.run([*command, str(zip_file.resolve())], env=environment, check=True, capture_output=True)
    command = [blender, "--background", "--python-exit-code", "1", "--python-expr", _SETTINGS]
    subprocess.run(command, env=environment, check=True, capture_output=True)


@contextmanager
def _display(size: str) -> Iterator[str]:
    """Start a virtual screen and yield its name."""
    reading, writing = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{size}x24", "-nolisten", "tcp"],
        pass_fds=[writing],
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    try:
        with os.fdopen(reading) as pipe:
            yield f":{pipe.readline().strip()}"
    finally:
        server.terminate()
        server.wait()


def _use(options: argparse.Namespace, environment: dict[str, str]) -> int:
    """Run the scenarios in the window and print their messages."""
    width, height = options.size.split("x")
    command = [options.blender, "--gpu-backend", "opengl", "-p", "0", "0", width, height]
    command += ["--python", str(HERE / "inside.py"), "--", str(options.out.resolve()), *options.only]
    log = options.out / "blender.log"
    with open(log, "w", encoding="utf-8") as file:
        try:
            code = subprocess.run(
                command, env=environment, stdout=file, stderr=subprocess.STDOUT, timeout=options.timeout, check=False
            ).returncode
        except subprocess.TimeoutExpired:
            print(f"It did not come to its end in {options.timeout:g} s.", file=sys.stderr)
            code = 124
    said = [line for line in log.read_text(encoding="utf-8", errors="replace").splitlines() if line.startswith("*")]
    print("\n".join(said))
    print(f"Pictures and log: {options.out}" if code == 0 else f"It went wrong (exit code {code}); see {log}")
    return code


if __name__ == "__main__":
    sys.exit(main())
