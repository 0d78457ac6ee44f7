# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a sample shape with a UV map and a texture, as OBJ, MTL and PNG."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

PIXELS = 512
"""Width and height of the texture: the left side of the body is below, the right side above."""

_SPOTS, _RADII, _SEED = 80, (0.02, 0.09), 4
# Width of the border of a spot, relative to its radius.
_SOFT = 0.12
_COAT, _SPOT = np.array([0.93, 0.9, 0.85]), np.array([0.27, 0.15, 0.09])


def side_map(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Project both sides of a body that faces +X onto a square, (m, 3, 2): one island each, with seams between them."""
    low = vertices.min(axis=0)
    size = np.ptp(vertices, axis=0).max()
    flat = (vertices[:, [0, 2]] - low[[0, 2]]) / size
    corners = vertices[triangles]
    right = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 1] < 0
    uv = flat[triangles] * (1.0, 0.5)
    uv[right, :, 1] += 0.5
    return uv


def spotted_texture() -> np.ndarray:
    """Return a light coat with dark spots, (PIXELS, PIXELS, 3), 0 to 1, rows from the top."""
    random = np.random.default_rng(_SEED)
    v, u = (np.indices((PIXELS, PIXELS)) + 0.5) / PIXELS
    field = np.zeros((PIXELS, PIXELS))
    for (x, y), radius in zip(random.random((_SPOTS, 2)), random.uniform(*_RADII, _SPOTS), strict=True):
        # Half as high, because both sides of the body share the height of the image.
        distance = np.hypot(u - x, 2.0 * (v - y)) / radius
        field = np.maximum(field, np.clip((1.0 - distance) / _SOFT, 0.0, 1.0))
    return _COAT + field[..., None] * (_SPOT - _COAT)


def write_textured(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Write a mesh to `path`.obj with its material and texture beside it; OBJ files have +Y up."""
    name = path.stem
    image = np.round(255.0 * spotted_texture()).astype(np.uint8)
    Image.fromarray(image).quantize(64, dither=Image.Dither.NONE).save(path.with_suffix(".png"), optimize=True)
    material = f"newmtl {name}\nKd 1 1 1\nmap_Kd {name}.png\n"
    path.with_suffix(".mtl").write_text(f"# CC0 1.0\n{material}", encoding="utf-8")
    lines = ["# CC0 1.0", f"mtllib {name}.mtl", f"o {name}"]
    lines += [f"v {x:.4f} {z:.4f} {-y:.4f}" for x, y, z in vertices]
    lines += [f"vt {u:.4f} {v:.4f}" for u, v in side_map(vertices, triangles).reshape(-1, 2)]
    lines += [f"usemtl {name}", "s 1"]
    for index, (a, b, c) in enumerate(triangles + 1):
        first = 3 * index + 1
        lines.append(f"f {a}/{first} {b}/{first + 1} {c}/{first + 2}")
    path.with_suffix(".obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
