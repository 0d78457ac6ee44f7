# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Try to break the add-on, for any length of time.

    python3 run.py fuzz --minutes 10 --seed monday

Operators are called in odd scenes, modes and editors with odd arguments, in child processes whose crashes are detected.
At the end, calls are counted by kind, and every failure is printed with the session that reproduces it:

    python3 run.py fuzz --seed monday --session 17

The first tenth of the time is for truncated, changed and forged files, the second for broken meshes, curves and images
without Blender. `python3 run.py python -m tests.fuzz.many_bakes 200` bakes very often in one Blender and prints what
remains afterwards.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from tests.fuzz.campaigns import arrays, files

PROJECT = Path(__file__).resolve().parents[2]
BAD = ("traceback", "unsound", "warning", "crash", "hang", "stopped")
_BATCH = 40
_PATIENCE = 120.0


def main() -> int:
    """Run until the time is over; return 1 if any failure was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", default=str(int(time.time())))
    parser.add_argument("--session", type=int, help="run only this session and print everything it does")
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    if options.session is not None:
        for entry in batch(options.seed, options.session, 1):
            print(json.dumps(entry), flush=True)
        return 0
    found = [*files(options.seed, 6 * options.minutes), *arrays(options.seed, 6 * options.minutes)]
    until, first, entries = time.monotonic() + 48 * options.minutes, 0, []
    while time.monotonic() < until:
        more = batch(options.seed, first, _BATCH, until)
        entries += more
        first = max(entry["session"] for entry in more) + 1 if more else first + 1
        print(f"{first} sessions, {sum(entry['doing'] == 'called' for entry in entries)} calls", flush=True)
    return _summary(entries, first) or bool(found)


def batch(seed: str, first: int, count: int, until: float = float("inf")) -> list[dict[str, object]]:
    """Run a child process to its end or crash, and return its log entries."""
    with tempfile.TemporaryDirectory(prefix="convwass-fuzz-") as folder:
        results = Path(folder) / "results"
        results.touch()
        command = [sys.executable, "-m", "tests.fuzz.operator_session", seed, str(first), str(count), str(results)]
        environment = {**os.environ, "PYTHONFAULTHANDLER": "1"}
        child = subprocess.Popen(
            command, cwd=PROJECT, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        ended = _watched(child, results, until)
        entries = [json.loads(line) for line in results.read_text(encoding="utf-8").splitlines()]
        screen = results.with_name("screen")
        last = screen.read_text(encoding="utf-8", errors="replace") if screen.exists() else ""
        last = last[max(last.rfind("Fatal Python error"), len(last) - 9000, 0) :][:3000]
    if ended and entries:
        entries.append({**entries[-1], "doing": "called", "outcome": ended, "text": last})
    elif entries:
        entries.pop()
    return entries


def _watched(child: subprocess.Popen, results: Path, until: float) -> str:
    """Wait for a child process; return how it failed, if it did."""
    size, heard = 0, time.monotonic()
    while child.poll() is None:
        time.sleep(0.5)
        now = time.monotonic()
        if results.stat().st_size != size:
            size, heard = results.stat().st_size, now
        if now - heard > _PATIENCE or now > until + 30.0:
            child.kill()
            child.wait()
            return "hang" if now - heard > _PATIENCE else ""
    return "crash" if child.returncode else ""


def _summary(entries: list[dict[str, object]], sessions: int) -> int:
    calls = [entry for entry in entries if entry.get("outcome")]
    made = [entry for entry in calls if entry["doing"] == "called"]
    print(f"\n{sessions} sessions, {len(made)} calls of {len({entry['operator'] for entry in made})} operators")
    for name in ("outcome", "mode", "area"):
        print(f"  by {name}:", dict(Counter(str(entry.get(name)) for entry in made).most_common()))
    groups: dict[str, list[dict[str, object]]] = {}
    for entry in calls:
        if entry["outcome"] in BAD:
            groups.setdefault(_place(entry), []).append(entry)
    for place, own in sorted(groups.items(), key=lambda item: -len(item[1])):
        print(f"\n{len(own)} × {place}\n  {own[0]['operator']} in session {own[0]['session']}")
        print("   ", str(own[0]["text"]).strip().replace("\n", "\n    ")[-2500:])
    return 1 if groups else 0


def _place(entry: dict[str, object]) -> str:
    """Describe the place of a failure: the project's last line in a traceback, and the error."""
    text = str(entry["text"])
    places = re.findall(r'File "[^"]*(convwass_addon/[^"]*)", line (\d+)', text)
    errors = re.findall(r"^(\w*(?:Error|Warning|Exception)\b.{0,80})", text, re.MULTILINE)
    place = ":".join(places[-1]) if places else str(entry.get("operator"))
    return f"{entry['outcome']} {place} {errors[-1] if errors else text[:80]}"


if __name__ == "__main__":
    sys.exit(main())
