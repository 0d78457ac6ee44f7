# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One session of a user with the extension: install the zip, morph two shapes, disable it, remove it.

Started by test_installed.py in a process of its own, with a clean profile: ``installed_session.py ZIP REPORT``. Writes
what it saw to REPORT, as JSON, for the test to judge.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy  # isort: skip  (addon_utils is found only once this is imported)
import addon_utils

MODULE = "bl_ext.user_default.convwass"


def is_offered() -> bool:
    """Whether the operator is there to be called."""
    return hasattr(bpy.types, "CONVWASS_OT_bake_morph")


def select_two_shapes() -> None:
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.mesh.primitive_cube_add(size=2, location=(-2, 0, 0))
    cube = bpy.context.object
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, location=(2, 0, 0))
    cube.select_set(True)


def meshes_shown_in_turn() -> list[int]:
    """For each frame of the scene, how many mesh objects of the new collection are rendered."""
    scene = bpy.context.scene
    morph = next(collection for collection in bpy.data.collections if collection.name.startswith("Morph"))
    shown = []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        shown.append(sum(not shape.hide_render for shape in morph.objects if shape.type == "MESH"))
    return shown


def main(extension: Path) -> dict[str, object]:
    seen: dict[str, object] = {"blender": bpy.app.version_string, "offered before": is_offered()}

    bpy.ops.extensions.package_install_files(filepath=str(extension), repo="user_default", enable_on_install=True)
    seen["enabled"] = addon_utils.check(MODULE)
    seen["offered"] = is_offered()
    seen["module file"] = sys.modules[MODULE + ".convwass_addon"].__file__
    seen["imported from the checkout"] = "convwass_addon" in sys.modules

    select_two_shapes()
    seen["baked"] = sorted(bpy.ops.convwass.bake_morph(frames=4, resolution=24))
    seen["shown"] = meshes_shown_in_turn()

    addon_utils.disable(MODULE, default_set=True)
    seen["offered while disabled"] = is_offered()
    seen["shown while disabled"] = meshes_shown_in_turn()

    addon_utils.enable(MODULE, default_set=True)
    seen["offered again"] = is_offered()
    bpy.ops.extensions.package_uninstall(repo_index=user_repository(), pkg_id="convwass")
    seen["offered after removal"] = is_offered()
    seen["left behind"] = Path(str(seen["module file"])).exists()
    return seen


def user_repository() -> int:
    repositories = bpy.context.preferences.extensions.repos
    return next(index for index, repository in enumerate(repositories) if repository.module == "user_default")


if __name__ == "__main__":
    zip_file, report = map(Path, sys.argv[1:])
    report.write_text(json.dumps(main(zip_file)), encoding="utf-8")
