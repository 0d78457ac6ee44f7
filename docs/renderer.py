# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of densities and distances on meshes: a small rasterizer in NumPy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from convwass_addon.geometry.meshes.mesh import TriangleMesh

Shader = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
"""Colors, (p, 3), of values, (p,), and of how much these change from a pixel to the next, (p,)."""

_SAMPLES = 3
_KEY, _FILL = np.array([-0.35, 0.55, 0.76]), np.array([0.8, 0.1, 0.55])


@dataclass(frozen=True)
class Shape:
    """A triangle mesh in the coordinates of the view.

    Attributes
    ----------
    vertices : (n, 3) float64
        In the coordinates of the picture: x to the right, y up, z to the viewer; within the unit box.
    faces : (m, 3) int64
        Counterclockwise seen from outside.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]

    @property
    def aspect(self) -> float:
        """Width over height."""
        extent = np.ptp(self.vertices, axis=0)
        return float(extent[0] / extent[1])


def read_shape(path: Path, rotation: NDArray[np.float64]) -> Shape:
    """Read one of the project's sample shapes and rotate it."""
    mesh = read_mesh(path)
    return posed(mesh.vertices, mesh.faces, rotation)


def read_mesh(path: Path) -> TriangleMesh:
    """Read one of the project's own sample shapes (binary PLY, triangles)."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    counts = [int(line.split()[2]) for line in header.decode().splitlines() if line.startswith("element")]
    vertices = np.frombuffer(body, "<f4", 3 * counts[0]).reshape(-1, 3).astype(np.float64)
    triangle = np.dtype([("corners", "u1"), ("vertices", "<i4", 3)])
    faces = np.frombuffer(body, triangle, counts[1], 12 * counts[0])["vertices"].astype(np.int64)
    return TriangleMesh.from_arrays(vertices, faces)


def posed(vertices: NDArray[np.float64], faces: NDArray[np.int64], rotation: NDArray[np.float64]) -> Shape:
    """Rotate a mesh and fit it into the unit box around the origin."""
    turned = vertices @ rotation.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    return Shape((turned - 0.5 * (low + high)) / (high - low)[:2].max(), faces)


def rendered(shape: Shape, values: NDArray[np.float64], shader: Shader, width: int) -> NDArray[np.float64]:
    """Draw values of the vertices by an orthographic view from +z.

    Returns
    -------
    (height, width, 4) float64
        Colors and coverage, both in [0, 1].
    """
    fine = width * _SAMPLES
    margin = 0.01
    extent = np.ptp(shape.vertices[:, :2], axis=0) + 2.0 * margin
    scale = fine / extent[0]
    height = int(np.ceil(extent[1] * width / extent[0])) * _SAMPLES
    pixels = np.stack(
        [
            (shape.vertices[:, 0] - shape.vertices[:, 0].min() + margin) * scale,
            (shape.vertices[:, 1].max() + margin - shape.vertices[:, 1]) * scale,
        ],
        axis=1,
    )
    face, corners = _visible(pixels, shape.vertices[:, 2], shape.faces, (height, fine))
    inside = face >= 0
    triangles, corners = shape.faces[face[inside]], corners[inside]
    normals = np.einsum("pc,pcx->px", corners, _vertex_normals(shape)[triangles])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    picture = np.zeros((height, fine, 4))
    slopes = _slopes(pixels[shape.faces] / _SAMPLES, values[shape.faces])[face[inside]]
    colors = shader(np.einsum("pc,pc->p", corners, values[triangles]), slopes)
    picture[inside] = np.concatenate([_lit(colors, normals), np.ones((len(colors), 1))], axis=1)
    picture = picture.reshape(height // _SAMPLES, _SAMPLES, width, _SAMPLES, 4).mean(axis=(1, 3))
    covered = picture[..., 3:]
    picture[..., :3] = np.where(covered > 0, picture[..., :3] / np.maximum(covered, 1e-9), 1.0)
    return picture


def _visible(
    pixels: NDArray[np.float64], depths: NDArray[np.float64], faces: NDArray[np.int64], size: tuple[int, int]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the visible face at every pixel, -1 for none, and its barycentric coordinates there."""
    nearest = np.full(size, -np.inf)
    seen = np.full(size, -1)
    weights = np.zeros((*size, 3))
    a, b, c = np.moveaxis(pixels[faces], 1, 0)
    # The picture's y axis points down, so that fronts run clockwise.
    doubled = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    for index in np.flatnonzero(doubled < -1e-9):
        corners = pixels[faces[index]]
        left, top = np.maximum(np.ceil(corners.min(axis=0) - 0.5).astype(int), 0)
        right, bottom = np.floor(corners.max(axis=0) - 0.5).astype(int) + 1
        x, y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
        (ax, ay), (bx, by), (cx, cy) = corners
        u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / doubled[index]
        v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / doubled[index]
        part = np.stack([u, v, 1.0 - u - v], axis=-1)
        depth = part @ depths[faces[index]]
        window = np.s_[top:bottom, left:right]
        hit = (part >= -1e-6).all(axis=-1) & (depth > nearest[window])
        nearest[window][hit] = depth[hit]
        seen[window][hit] = index
        weights[window][hit] = part[hit]
    return seen, weights


def _slopes(corners: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the gradient norms of values that are linear on triangles in the plane."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    u, v = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    doubled = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    rise = np.hypot(u * second[:, 1] - v * first[:, 1], v * first[:, 0] - u * second[:, 0])
    return rise / np.maximum(np.abs(doubled), 1e-9)


def _vertex_normals(shape: Shape) -> NDArray[np.float64]:
    a, b, c = np.moveaxis(shape.vertices[shape.faces], 1, 0)
    normals = np.zeros_like(shape.vertices)
    for corner in shape.faces.T:
        np.add.at(normals, corner, np.cross(b - a, c - a))
    return normals


def _lit(colors: NDArray[np.float64], normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shade colors softly with a key light and a fill light, so that they remain comparable."""
    key = np.clip(normals @ (_KEY / np.linalg.norm(_KEY)), 0.0, 1.0)
    fill = np.clip(normals @ (_FILL / np.linalg.norm(_FILL)), 0.0, 1.0)
    # Darker toward the outline, so that shapes stand out from white.
    rim = np.clip(normals[:, 2], 0.0, 1.0) ** 0.4
    light = (0.62 + 0.36 * key + 0.12 * fill) * (0.55 + 0.45 * rim)
    gloss = 0.12 * np.clip(2.0 * key * normals[:, 2] - _KEY[2], 0.0, 1.0) ** 6
    return np.clip(colors * light[:, None] + gloss[:, None], 0.0, 1.0)
