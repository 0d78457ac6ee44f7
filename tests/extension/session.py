# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One user session: ``session.py REPORT SITE STEPS``, in its own process, with the given profile.

STEPS is a JSON list of [name of a function in this file, its arguments]. Results go to REPORT by name; those of a
second call as "name 2". Nothing of the project can be imported. SITE is a folder of packages to use instead of this
Python's own, or empty.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import os
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from types import ModuleType
from urllib.request import url2pathname

if sys.argv[2]:
    sys.path.insert(0, sys.argv[2])

import bpy  # isort: skip  (addon_utils is found only once this is imported)
import addon_utils

MODULE = "bl_ext.user_default.convwass"
HERE = Path(__file__).resolve().parent

# Audit events of network access.
_NETWORK = {"socket.connect", "socket.getaddrinfo", "socket.gethostbyname", "socket.bind", "socket.sendto"}
_CHANGES = {"os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.chmod", "os.truncate", "os.link", "os.symlink"}

_refused: list[str] = []
_read_only: list[str] = []
_large_products: list[str] = []


def refuse(event: str, arguments: tuple) -> None:
    """Audit hook: allow no network access, and no changes where the extension is installed, not even for root."""
    if event in _NETWORK:
        _refused.append(f"{event} {arguments[-1]}")
        raise PermissionError("this session is offline")
    if not _read_only:
        return
    if event == "open":
        is_writing = isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        touched = arguments[:1] if is_writing else ()
    else:
        touched = arguments if event in _CHANGES else ()
    for path in touched:
        if isinstance(path, (str, bytes)) and os.fsdecode(path).startswith(tuple(_read_only)):
            if not os.fsdecode(path).partition(".cpython")[0].endswith("__init__") and "__pycache__" not in str(path):
                _refused.append(f"{event} {path}")
            raise PermissionError(f"{path} is read-only")


def manual_page(identifier: str) -> str:
    """Return the page that *Online Manual* opens for an operator or setting, if the file exists."""
    url = bpy.types.WM_OT_doc_view_manual._lookup_rna_url(identifier, verbose=False)
    page = Path(url2pathname(url.removeprefix("file:")))
    return page.name if page.is_file() else ""


def install(zip_file: str) -> list[bool]:
    """Install and enable, as from the preferences; return whether it is enabled by default and now."""
    bpy.ops.extensions.package_install_files(filepath=zip_file, repo="user_default", enable_on_install=True)
    bpy.ops.wm.save_userpref()
    return list(addon_utils.check(MODULE))


def leave_module(folder: str) -> None:
    """Put a module that nobody imports beside those of the installed extension."""
    stray = Path(folder) / "convwass_addon" / "of_the_earlier_version.py"
    stray.write_text("raise RuntimeError('nobody imports this any more')\n", encoding="utf-8")


def lock(folder: str) -> None:
    """From now on, allow no writing to the folder of the installed extension."""
    for path in [Path(folder), *Path(folder).rglob("*")]:
        path.chmod(0o555 if path.is_dir() else 0o444)
    _read_only.append(folder)


def module_files() -> list[str]:
    """Return the files of all loaded modules of the extension and of its dependencies."""
    names = ("scipy", "skimage", "lazy_loader", "robust_laplacian", "cholespy", "threadpoolctl", "convwass_addon")
    found = [name for name in sys.modules if name.startswith(MODULE + ".") or name in names]
    return sorted(str(getattr(sys.modules[name], "__file__", "")) for name in found)


def version() -> str:
    """Return the installed version according to Blender."""
    return next(".".join(map(str, m.bl_info["version"])) for m in addon_utils.modules() if m.__name__ == MODULE)


def prefer(values: dict[str, object]) -> None:
    """Set preferences of the extension and save them."""
    own = bpy.context.preferences.addons[MODULE].preferences
    for name, value in values.items():
        setattr(own, name, value)
    bpy.ops.wm.save_userpref()


def preferred() -> dict[str, object]:
    """Return the preferences of the extension."""
    own = bpy.context.preferences.addons[MODULE].preferences
    return {name: getattr(own, name) for name in own.__annotations__}


def add_preset(name: str, resolution: int) -> None:
    """Save the solver settings as a preset."""
    bpy.context.scene.convwass_morph.resolution = resolution
    bpy.ops.convwass.add_solver_preset(name=name)


def presets() -> dict[str, int]:
    """Return the resolution of every preset."""
    own = sys.modules[f"{MODULE}.convwass_addon.solver_presets"]
    found = {}
    for name in own.preset_names():
        assert own.apply_preset(name)
        found[name] = bpy.context.scene.convwass_morph.resolution
    return found


def languages() -> list[str]:
    """Return the languages of the extension's translations; the bpy module itself is built without any."""
    return sys.modules[f"{MODULE}.convwass_addon.translations"].languages()


def clear() -> None:
    """Open an empty file."""
    bpy.ops.wm.read_homefile(use_empty=True)


def coarsen() -> None:
    """Let maps and warps be coarse from now on."""
    motions = f"{MODULE}.convwass_addon.applications.motions"
    candidates, warps = (importlib.import_module(f"{motions}.{name}") for name in ("motion_candidates", "warp_motion"))
    candidates.USUAL_EFFORT = warps.WarpEffort(24, 4)
    candidates.GuidedSettings = partial(candidates.GuidedSettings, map_vertices=300, carrier_vertices=400)


def make(folder: str, only: str = "") -> dict[str, list[str]]:
    """Create one of everything, or of one kind, and save the file in the folder."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    with beside("../large_products").noted_products() as noted:
        answers = beside("everything").make_everything(Path(folder), only)
    _large_products.extend(sorted(set(noted)))
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "everything.blend"))
    return answers


def large_products() -> list[str]:
    """Return the large matrix products that NumPy computed while everything was created."""
    return _large_products


def open_file(folder: str) -> None:
    """Open the file saved by `make`."""
    bpy.ops.wm.open_mainfile(filepath=str(Path(folder) / "everything.blend"))


def figures() -> dict:
    """Return what the file shows."""
    return beside("figures").figures()


def leftovers() -> dict:
    """Return everything in the file that would fail without the extension."""
    return beside("figures").leftovers()


def bake_again(name: str) -> list[str]:
    """Bake a morph of the file again."""
    return sorted(bpy.ops.convwass.rebake_morph(morphs=name))


def own_files() -> dict[str, int]:
    """Return the files in the extension's own folder of the profile, with sizes."""
    folder = Path(bpy.utils.extension_path_user(MODULE))
    return {str(path.relative_to(folder)): path.stat().st_size for path in folder.rglob("*") if path.is_file()}


def polls() -> dict[str, int]:
    """Poll every operator in every situation; return how often each can be called."""
    names = [name.removeprefix("CONVWASS_OT_") for name in dir(bpy.types) if name.startswith("CONVWASS_OT_")]
    found = dict.fromkeys(names, 0)
    for _ in _situations():
        for name in names:
            found[name] += bool(getattr(bpy.ops.convwass, name).poll())
    return found


def panels() -> dict[str, int]:
    """Draw every panel in every situation; return how often each was shown."""
    sys.modules["fake_layout"] = beside("../panels/fake_layout")
    names = [name for name in dir(bpy.types) if name.startswith("CONVWASS_PT_") and "preset" not in name]
    found = dict.fromkeys([*names, "preferences"], 0)
    for _ in _situations():
        for name in names:
            found[name] += _draw(getattr(bpy.types, name))
    layout = sys.modules["fake_layout"].FakeLayout()
    own = bpy.context.preferences.addons[MODULE].preferences
    type(own).draw(_Shown(own, layout), bpy.context)
    found["preferences"] = len(layout.drawn)
    return found


def disable() -> None:
    """Disable the extension."""
    addon_utils.disable(MODULE, default_set=True)


def enable() -> None:
    """Enable the extension again."""
    addon_utils.enable(MODULE, default_set=True)


def remove() -> None:
    """Uninstall the extension."""
    repositories = bpy.context.preferences.extensions.repos
    place = next(index for index, repository in enumerate(repositories) if repository.module == "user_default")
    bpy.ops.extensions.package_uninstall(repo_index=place, pkg_id="convwass")


def offered() -> list[str]:
    """Return what Blender has registered of the extension: operators, panels, properties, commands."""
    owners = (bpy.types.Scene, bpy.types.Object, bpy.types.Collection, bpy.types.Mesh, bpy.types.WindowManager)
    kinds = [name for name in dir(bpy.types) if name.lower().startswith("convwass")]
    return kinds + [
        f"{owner.__name__}.{name}" for owner in owners for name in dir(owner) if name.startswith("convwass")
    ]


def refused() -> list[str]:
    """Return the attempted actions that fail for an offline user with a read-only folder."""
    return _refused


def beside(name: str) -> ModuleType:
    """Load a module from the folder of this file."""
    path = (HERE / name).with_suffix(".py")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class _Shown:
    """A panel while it is drawn: its own methods and a layout."""

    def __init__(self, own: object, layout: object) -> None:
        self._own, self.layout = own, layout

    def __getattr__(self, name: str) -> object:
        found = getattr(self._own, name)
        is_method = isinstance(self._own, type) and hasattr(found, "__code__")
        return found.__get__(self) if is_method else found


def _draw(panel: type) -> bool:
    """Draw a panel if it is shown; return whether it is."""
    if not _is_shown(panel):
        return False
    shown = _Shown(panel, sys.modules["fake_layout"].FakeLayout())
    for name in ("draw_header_preset", "draw"):
        if hasattr(panel, name):
            getattr(panel, name)(shown, bpy.context)
    return True


def _is_shown(panel: type) -> bool:
    """Return whether Blender shows a panel, which it does not without the panel that contains it."""
    if hasattr(panel, "poll") and not panel.poll(bpy.context):
        return False
    outer = getattr(panel, "bl_parent_id", "")
    return not outer.startswith("CONVWASS_PT_") or _is_shown(getattr(bpy.types, outer))


def _situations() -> Iterator[None]:
    """Iterate over every kind of active object in each of its modes."""
    context, seen = bpy.context, set()
    for obj in list(context.view_layer.objects):
        own = tuple(sorted(key for key in obj.keys() if "convwass" in key))  # noqa: SIM118 (no dict)
        kind = (obj.type, tuple(obj.modifiers.keys())[:1], own)
        if kind in seen or not obj.visible_get():
            continue
        seen.add(kind)
        for other in context.selected_objects:
            other.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        modes = {"MESH": ("OBJECT", "EDIT", "WEIGHT_PAINT"), "ARMATURE": ("OBJECT", "EDIT", "POSE")}
        for mode in modes.get(obj.type, ("OBJECT",)):
            bpy.ops.object.mode_set(mode=mode)
            yield
        bpy.ops.object.mode_set(mode="OBJECT")


if __name__ == "__main__":
    sys.addaudithook(refuse)
    if (Path(os.environ["BLENDER_USER_RESOURCES"]) / "config" / "userpref.blend").exists():
        bpy.ops.wm.read_userpref()  # Blender does this at startup, the bpy module does not
    report, _, steps = sys.argv[1:]
    told = {"blender": bpy.app.version_string}
    for step, arguments in json.loads(steps):
        answer = globals()[step](*arguments)
        count = sum(name.partition(" ")[0] == step for name in told) + 1
        told[step if count == 1 else f"{step} {count}"] = answer
    Path(report).write_text(json.dumps(told), encoding="utf-8")
    if bpy.app.version < (5, 0):
        # Blender 4.5 may wait forever for one of its own threads if the process ends normally.
        sys.stdout.flush()
        os._exit(0)
