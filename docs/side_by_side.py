# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw docs/pictures/side_by_side.jpg: ``python3 run.py python docs/side_by_side.py``.

Compare morphs with other methods in Blender: four pairs of shapes, five methods, five frames each, from the same meshes
at the same resolution, with one material and one camera; the figures of docs/side_by_side.md are printed. The
first pair is also written as side_by_side_one.jpg. Requires Blender 5.0 or newer.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from clay import clay, frame_object
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from convwass_addon.bridge.studio.framing import Pose, View
from convwass_addon.bridge.studio.rendered_scene import Studio
from convwass_addon.geometry.meshes.mesh import TriangleMesh

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.coherence_cases import read_frames
from benchmarks.rivals import TIMES
from benchmarks.side_by_side import COLUMNS, PAIRS, TITLES, line, passage

PICTURE = Path(__file__).resolve().parent / "pictures" / "side_by_side.jpg"
_VIEW = View(-math.pi / 2 + math.radians(24.0), math.radians(12.0))
# Column spacing, gap between rows, and margins for the names, in scene units.
_STEP, _GAP, _GUTTER, _HEAD = 2.12, 0.2, 1.75, 0.36
_WIDTH, _MARGIN, _BETWEEN = 1100, 20, 23
_QUALITY = 70
_INK, _FAINT = (52, 52, 56), (120, 120, 126)
_CLAY = (0.48, 0.12, 0.05, 1.0)


def main() -> None:
    """Compute all frames, print their figures and render them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=100, help="along the longest side (%(default)s)")
    parser.add_argument("--samples", type=int, default=12, help="light paths per pixel (%(default)s)")
    parser.add_argument("--out", type=Path, default=PICTURE, help="the JPEG to write (%(default)s)")
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        blocks = [_block(pair, options.cells, options.samples, Path(folder)) for pair in PAIRS]
    height = sum(block.height + _BETWEEN for block in blocks) - _BETWEEN
    picture = Image.new("RGB", (_WIDTH, height), "white")
    top = 0
    for block in blocks:
        picture.paste(block, (0, top))
        top += block.height + _BETWEEN
    for image, path in ((picture, options.out), (blocks[0], options.out.with_stem(f"{options.out.stem}_one"))):
        image.save(path, quality=_QUALITY, optimize=True, progressive=True)


def _block(pair: tuple[str, str], cells: int, samples: int, folder: Path) -> Image.Image:
    """Compute, measure and render the frames from one shape to another."""
    print(f"\n{' to '.join(pair).replace('_', ' ')}\n{COLUMNS}")
    rows = []
    for method in TITLES:
        kept = folder / f"{'-'.join(pair)}-{method}.npz"
        print(line(method, passage(pair, cells, method, kept)), flush=True)
        rows.append(read_frames(kept))
    block = _rendered(rows, samples, folder / "block.png")
    _write_names(block, pair)
    return block


def _rendered(rows: Sequence[Sequence[TriangleMesh]], samples: int, path: Path) -> Image.Image:
    """Render rows of frames at their own positions, not all on the ground."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    material = clay(_CLAY)
    points = np.concatenate([frame.vertices for frames in rows for frame in frames])
    floor, right, up = float(points[:, 2].min()), *_VIEW.axes[:2]
    (left, bottom), (across, upright) = _extent(points @ np.stack([right, up], axis=1))
    step = upright + _GAP
    size = np.array([_GUTTER + _STEP * len(rows[0]), _HEAD + step * len(rows)])
    with Studio() as studio:
        shown = []
        for row, frames in enumerate(rows):
            # Rows are placed behind each other on the floor, far enough to appear above each other in the picture.
            back = step * (len(rows) - 1 - row) / math.sin(_VIEW.elevation)
            for column, frame in enumerate(frames):
                shift = _STEP * column * right + back * _VIEW.forward - [0.0, 0.0, floor]
                studio.show(frame_object(frame, material), tuple(shift))
                shown.append(frame.vertices + shift)
        reach = studio.build(shown, _VIEW)
        corner = [left + (across - _STEP) / 2.0 - _GUTTER, bottom - floor * up[2] - _GAP / 2.0]
        center = corner + size / 2.0
        on_floor = center[1] / math.sin(_VIEW.elevation) * _VIEW.forward + center[0] * right
        studio.look_flat(Pose(on_floor + reach / 2.0 * _VIEW.axes[2], _VIEW), float(size[0]), reach)
        studio.set_quality((_WIDTH, round(_WIDTH * size[1] / size[0])), samples)
        studio.render(path)
    with Image.open(path) as picture:
        return picture.convert("RGB")


def _extent(places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the low corner and the size of the box around points."""
    return places.min(axis=0), np.ptp(places, axis=0)


def _write_names(block: Image.Image, pair: tuple[str, str]) -> None:
    """Write the names of the shapes and of the methods, and the times."""
    draw = ImageDraw.Draw(block)
    scale = _WIDTH / (_GUTTER + len(TIMES) * _STEP)
    large, small = ImageFont.load_default(19), ImageFont.load_default(16)
    head = 0.5 * _HEAD * scale
    draw.text((_MARGIN, head), " to ".join(pair).replace("_", " "), _INK, large, anchor="lm")
    for column, t in enumerate(TIMES):
        draw.text((scale * (_GUTTER + (column + 0.5) * _STEP), head), f"t = {t:g}", _FAINT, small, anchor="mm")
    step = (block.height - scale * _HEAD) / len(TITLES)
    for row, title in enumerate(TITLES.values()):
        lines = _wrapped(title, lambda text: draw.textlength(text, small), scale * _GUTTER - _MARGIN)
        place = (_MARGIN, scale * _HEAD + (row + 0.5) * step)
        draw.multiline_text(place, "\n".join(lines), _INK, small, anchor="lm", spacing=7)


def _wrapped(title: str, length: Callable[[str], float], most: float) -> list[str]:
    """Break a title into lines of at most this length."""
    lines = [""]
    for word in title.split():
        longer = f"{lines[-1]} {word}".strip()
        lines[-1:] = [longer] if length(longer) <= most else [lines[-1], word]
    return lines


if __name__ == "__main__":
    main()
