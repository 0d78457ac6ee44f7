# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene apart, in which Blender's importers and exporters leave the user's scene alone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ..sentence import Sentence


@contextmanager
def workshop() -> Iterator[bpy.types.Scene]:
    """Make a new scene the context's, and remove it in the end.

    Importers change the frame range, the frame rate and the selection of the scene they work in, and exporters write
    all that is in theirs. Objects that were made in the scene outlive it.
    """
    scene = bpy.data.scenes.new("Convwass Workshop")
    try:
        with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0], collection=scene.collection):
            yield scene
    finally:
        bpy.data.scenes.remove(scene)


def reason(error: Exception) -> str | Sentence:
    """Return what went wrong from the error of a Blender operator, which may wrap a whole traceback."""
    lines = [line for line in str(error).splitlines() if line.strip() and not line.startswith("Location:")]
    if not lines:
        return Sentence("no reason given")
    return (lines[-1] if "Traceback" in str(error) else lines[0]).removeprefix("Error: ").strip()
