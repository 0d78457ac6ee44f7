# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns without Blender: damaged files, and broken input with random variations."""

from __future__ import annotations

import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.fuzz import array_cases, file_cases
from tests.fuzz.corpus import broken_images, broken_meshes, broken_rings

# Slower cases are reported.
_SECONDS = 60.0


def files(seed: str, seconds: float) -> list[str]:
    """Read damaged files for this time; print the counts and return the failures."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        good = {kind: file_cases.good_content(kind, folder) for kind in file_cases.READERS}

        def cases() -> Iterator[tuple[str, Callable[[], str]]]:
            for number in count():
                for kind, content in good.items():
                    own = hash_of(seed, number)
                    spoiled = file_cases.spoiled(content, own)
                    yield kind, partial(file_cases.outcome, kind, spoiled, folder)
                lying = file_cases.lying_frame(good["frame"], hash_of(seed, number))
                yield "lying frame", partial(file_cases.outcome, "frame", lying, folder)

        return _tried("files", cases(), seconds)


def arrays(seed: str, seconds: float) -> list[str]:
    """Pass broken meshes, rings and pixels to every application, unchanged and then varied; return the failures."""

    def cases() -> Iterator[tuple[str, Callable[[], str]]]:
        for number in count():
            random = np.random.default_rng(hash_of(seed, number))
            for name, make in broken_meshes().items():
                vertices, faces = make()
                if number:
                    vertices, faces = _varied(vertices, faces, random)
                for kind, run in array_cases.ON_MESHES.items():
                    yield f"{kind} {name}", partial(_on_mesh, run, vertices, faces)
            for name, rings in broken_rings():
                moved = [ring * random.lognormal(size=2) + random.normal(size=2) if number else ring for ring in rings]
                yield f"flat {name}", partial(array_cases.outcome, partial(array_cases.flat_of, moved))
            for name, pixels in broken_images():
                scaled = pixels * random.lognormal(sigma=3) if number else pixels
                for kind, run in array_cases.ON_PIXELS.items():
                    yield f"{kind} {name}", partial(array_cases.outcome, partial(run, scaled))

    return _tried("arrays", cases(), seconds)


def hash_of(seed: str, number: int) -> int:
    """Return a seed for one case."""
    return int.from_bytes(f"{seed}:{number}".encode(), "little") % (1 << 63)


def _on_mesh(run: Callable[[TriangleMesh], None], vertices: np.ndarray, faces: np.ndarray) -> str:
    return array_cases.outcome(lambda: run(TriangleMesh.from_arrays(vertices, faces)))


def _varied(vertices: np.ndarray, faces: np.ndarray, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Rotate and stretch a mesh, and damage a little of it."""
    with np.errstate(all="ignore"):
        vertices = vertices @ Rotation.random(rng=random).as_matrix() * random.lognormal(size=3)
    if len(faces) > 4 and random.random() < 0.5:
        faces = faces[random.random(len(faces)) < 0.9]
    if len(faces) and random.random() < 0.3:
        faces = np.concatenate([faces, random.integers(0, len(vertices), (3, 3))])
    if len(vertices) and random.random() < 0.2:
        vertices[random.integers(len(vertices))] = random.choice((np.nan, 1e12, 0.0))
    return vertices, faces


def _tried(name: str, cases: Iterator[tuple[str, Callable[[], str]]], seconds: float) -> list[str]:
    until, counts, wrong = time.monotonic() + seconds, Counter(), []
    for case, run in cases:
        if time.monotonic() > until:
            break
        begun = time.process_time()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                warnings.filterwarnings("ignore", "Setting the shape on a NumPy array", DeprecationWarning)
                counts[run()] += 1
        except Exception:
            counts["wrong"] += 1
            wrong.append(f"{name}: {case}\n{traceback.format_exc()}")
        if time.process_time() - begun > _SECONDS:
            wrong.append(f"{name}: {case} took {time.process_time() - begun:.0f} s")
    print(f"{name}: {sum(counts.values())} cases, {dict(counts)}", flush=True)
    for text in wrong:
        print(text, flush=True)
    return wrong
