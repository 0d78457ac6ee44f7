# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Give every image of a folder the palette of one image, each by its own map, and save the maps as .cube tables.

python3 run.py python docs/scripts/grade_folder.py photos --palette painting.jpg --strength 0.8 --out graded

Frames of a clip need a common map, or they flicker: use the command ``recolor`` for these.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from convwass_addon.applications.palettes.lookup_table import lookup_table, write_cube
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.applications.palettes.pixel_blocks import recolored_blocks
from convwass_addon.applications.palettes.recoloring import recoloring
from convwass_addon.bridge.files.image_files import opened_image
from convwass_addon.bridge.palettes.image_files import save_pixels
from convwass_addon.bridge.palettes.image_pixels import read_picture
from convwass_addon.progress import drained

ENDINGS = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr")


def main() -> None:
    """Measure the palette once, then grade every image."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--palette", type=Path, required=True, help="the image whose colors are wanted")
    parser.add_argument("--strength", type=float, default=1.0, help="0 to 1")
    parser.add_argument("--out", type=Path, default=Path("graded"), help="another folder")
    options = parser.parse_args()

    settings = RecolorSettings(strength=options.strength)
    options.out.mkdir(exist_ok=True)
    with opened_image(options.palette) as image:
        wanted = read_picture(image).palette()
    for path in sorted(path for path in options.folder.iterdir() if path.suffix.lower() in ENDINGS):
        with opened_image(path) as image:
            picture = read_picture(image)
            change = recoloring(picture.palette(), [wanted], settings=settings)
            pixels = np.empty_like(picture.pixels)
            drained(recolored_blocks(picture.pixels, picture.pixel_format, change, None, pixels))
            save_pixels(pixels, image, options.out / path.name)
        write_cube(lookup_table(change, 33), options.out / f"{path.stem}.cube", path.stem)
        print(f"{path.name}: marginal error {change.chroma.marginal_error:.1e}")


if __name__ == "__main__":
    main()
