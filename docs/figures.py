# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw results of the transport functions, after figures 2 to 6 of Solomon et al. 2015, and a morph with parts.

``python3 run.py python docs/figures.py [NAME ...]`` writes docs/pictures/NAME.png, all of them by default. It needs
matplotlib, which ``python3 run.py gallery --only 2`` installs.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse
from numpy.typing import NDArray
from PIL import Image
from renderer import Shape, read_mesh, read_shape, rendered
from scipy.spatial.transform import Rotation

from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.part_labels import FaceLabels
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.transport import (
    Grid,
    Surface,
    barycenter,
    bisect,
    distance,
    interpolate,
    point_distances,
    propagate,
)
from convwass_addon.transport.sharpening import entropy

PROJECT = Path(__file__).resolve().parents[1]
PICTURES = Path(__file__).resolve().parent / "pictures"
_WIDTH = 1600
_DPI = 100
_INK = "#333333"
_GRAY = "#9a9a9a"
_FIRST, _SECOND = "#5b5f97", "#b8476b"
_GIVEN = "#e4e7f0"

# A perceptually even color map, from clay, which shows the shape, to a red that is visible even in shadows.
_DENSITY = LinearSegmentedColormap.from_list(
    "density", ["#eeebe6", "#f9d9b4", *matplotlib.colormaps["magma_r"](np.linspace(0.22, 0.80, 7))]
)
_DISTANCE = matplotlib.colormaps["viridis_r"]

# Corresponding parts of horse and bird, their colors, and clay for everything else.
_PARTS = ("head", "tail", "left limbs", "right limbs", "body")
_PART_COLORS = np.array([to_rgb(name) for name in ("#c8553d", "#4a7fb5", "#5a9e6f", "#d9a441", "#a39a94", "#eeebe6")])


@dataclass(frozen=True)
class Subject:
    """A shape with its domain.

    Attributes
    ----------
    shape : Shape
        The drawn shape.
    surface : Surface
        The domain on the same vertices.
    """

    shape: Shape
    surface: Surface

    @staticmethod
    def of(name: str, turn: float, tilt: float, gamma: float | None = None) -> Subject:
        """Read a sample shape, rotate it about the vertical and tilt it, in degrees; -90 shows it from the side."""
        rotation = Rotation.from_euler("zx", [turn, tilt], degrees=True).as_matrix()
        shape = read_shape(PROJECT / "assets" / "shapes" / f"{name}.ply", rotation)
        return Subject(shape, Surface(shape.vertices, shape.faces, gamma=gamma))

    def at(self, x: float, y: float) -> int:
        """Return the front vertex at a position of the picture, in [-0.5, 0.5]."""
        vertices = self.shape.vertices
        near = np.linalg.norm(vertices[:, :2] - (x, y), axis=1)
        return int(np.where(near < near.min() + 0.015, vertices[:, 2], -np.inf).argmax())

    def bump(self, x: float, y: float, radius: float) -> NDArray[np.float64]:
        """Return a Gaussian of mass 1 in the distance along the surface, with a radius in units of the picture."""
        lengths = point_distances(self.at(x, y), self.surface)
        density = np.exp(-0.5 * (lengths / radius) ** 2)
        return density / float(density @ self.surface.weights)

    def entropy(self, density: NDArray[np.float64]) -> float:
        """Return the entropy of a density in nats."""
        return entropy(density, self.surface.weights)

    def density_image(self, density: NDArray[np.float64], width: int) -> NDArray[np.float64]:
        """Draw the square root of a density, relative to its maximum."""
        shares = np.sqrt(np.clip(density / density.max(), 0.0, 1.0))
        return rendered(self.shape, shares, lambda values, _: _DENSITY(values)[:, :3], width)


def transport_plans() -> Figure:
    """Figure 2: plans between two densities on a line, for growing gamma."""
    cells, gammas = 320, (4e-4, 2e-3, 1e-2, 5e-2)
    x = (np.arange(cells) + 0.5) / cells
    first = np.exp(-0.5 * ((x - 0.25) / 0.07) ** 2) + 0.6 * np.exp(-0.5 * ((x - 0.62) / 0.05) ** 2)
    second = 0.5 * np.exp(-0.5 * ((x - 0.35) / 0.05) ** 2) + np.exp(-0.5 * ((x - 0.74) / 0.09) ** 2)
    # A small constant, so that the narrowest kernel connects all mass.
    first, second = first + 0.003, second + 0.003
    side, strip, gap = 306, 52, 34
    canvas = Canvas(_WIDTH, side + strip + 70)
    for index, gamma in enumerate(gammas):
        left = 20 + strip + index * (side + strip + gap)
        grid = Grid((cells,), sigma=np.sqrt(gamma / 2.0) * cells)
        found = distance(first, second, grid)
        plan = found.v[:, None] * grid.apply(np.eye(cells)) * found.w
        axes = canvas.axes(left, 50, side, side)
        axes.imshow((plan / plan.max()) ** 0.6, cmap=_DENSITY, origin="lower", extent=(0, 1, 0, 1))
        _frame(axes)
        above = canvas.axes(left, 50 + side + 5, side, strip)
        above.fill_between(x, second / second.max(), color=_SECOND, linewidth=0)
        above.set(xlim=(0, 1), ylim=(0, 1.02))
        beside = canvas.axes(left - strip - 5, 50, strip, side)
        beside.fill_betweenx(x, -first / first.max(), color=_FIRST, linewidth=0)
        beside.set(ylim=(0, 1), xlim=(-1.02, 0))
        canvas.text(left + side / 2, 24, f"γ = {gamma:g}")
        canvas.text(left - strip / 2, 50 + 0.85 * side, "$\\mu_0$", _FIRST)
        canvas.text(left + 0.12 * side, 50 + side + strip / 2, "$\\mu_1$", _SECOND)
    return canvas.figure


def distances() -> Figure:
    """Figure 3: distances from a point, and the logarithm of the kernel without correction."""
    horse = Subject.of("horse", -18, -84)
    source = horse.at(0.16, 0.06)
    surface = horse.surface
    fine = _raw_distances(source, surface.with_kernel(gamma=1e-5))
    lengths = point_distances(source, surface)
    stretch = lengths.max() / fine.max()
    columns = [
        ("point_distances", lengths),
        (f"$\\sqrt{{-γ\\,\\ln H}}$,  γ = {surface.gamma:.2g}", _raw_distances(source, surface)),
        (f"$\\sqrt{{-γ\\,\\ln H}}$,  γ = 10$^{{-5}}$,  times {stretch:.0f}", stretch * fine),
    ]
    width = 500
    canvas = Canvas(_WIDTH, int(width / horse.shape.aspect) + 80)
    for index, (title, found) in enumerate(columns):
        left = 20 + index * (width + 30)
        canvas.image(left, 60, rendered(horse.shape, found / lengths.max(), _with_lines, width))
        canvas.text(left + width / 2, 26, title)
    return canvas.figure


def _raw_distances(source: int, surface: Surface) -> NDArray[np.float64]:
    """Return sqrt(-gamma ln H) as in eq. (7); infinite where float64 underflows."""
    peak = np.full((1, *surface.shape), -1e300)
    peak[0, source] = -np.log(surface.weights[source])
    logs = np.empty_like(peak)
    surface.log_apply(peak, logs)
    return surface.unit_length * np.sqrt(np.maximum(-surface.gamma * logs[0], 0.0))


def _with_lines(shares: NDArray[np.float64], slopes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return colors of distances relative to the largest one, with lines of equal width at equal steps."""
    step, half_width = 1.0 / 24.0, 0.8
    colors = _DISTANCE(0.05 + 0.9 * np.clip(shares, 0.0, 1.0))[:, :3]
    nearest = np.maximum(np.round(shares / step), 1.0) * step
    is_line = np.abs(shares - nearest) < half_width * slopes
    return np.where(is_line[:, None], 0.25 * colors, colors)


def barycenters() -> Figure:
    """Figure 4: barycenters of two densities under increasingly tight entropy bounds."""
    horse = Subject.of("horse", -18, -84)
    inputs = np.stack([horse.bump(-0.22, 0.04, 0.05), horse.bump(0.36, 0.38, 0.05)])
    bound = max(map(horse.entropy, inputs))
    columns = [("$\\mu_0$", inputs[0]), ("$\\mu_1$", inputs[1])]
    for title, limit in (
        ("no bound", None),
        ("$H_0 = H + 1$", bound + 1.0),
        ("$H_0 = H$", bound),
        ("$H_0 = H - 1$", bound - 1.0),
    ):
        found = barycenter(inputs, [0.5, 0.5], horse.surface, entropy_limit=limit, tolerance=1e-3)
        _say(title, found.converged, found.entropy)
        columns.append((title, found.density))
    width = 500
    height = int(width / horse.shape.aspect)
    canvas = Canvas(_WIDTH, 2 * (height + 60))
    for index, (title, density) in enumerate(columns):
        left, bottom = 20 + index % 3 * (width + 30), 50 + (1 - index // 3) * (height + 60)
        canvas.image(left, bottom, horse.density_image(density, width))
        canvas.text(left + width / 2, bottom - 26, title)
    return canvas.figure


def propagations() -> Figure:
    """Figure 5: propagation on a star and a line; solid vertices are given."""
    diameter = 292
    canvas = Canvas(_WIDTH, 1060)
    horse = Subject.of("horse", -18, -84)
    tips = [(0.44, 0.2), (0.26, -0.45), (-0.43, -0.05), (-0.31, -0.45)]
    given = {vertex: horse.bump(*tip, 0.05) for vertex, tip in enumerate(tips, start=1)}
    star = propagate([(0, v) for v in given], 1.0, given, horse.surface, entropy_limit="max", tolerance=1e-3)
    _say("star", star.converged.all(), star.entropies)
    places = [(800, 700), (1190, 880), (1190, 530), (410, 880), (410, 530)]
    for vertex in given:
        canvas.edge(places[0], places[vertex])
    for vertex, place in enumerate(places):
        canvas.vertex(place, diameter, vertex in given)
        canvas.centered(place, horse.density_image(star.densities[vertex], 220))
    bird = Subject.of("bird", -35, -70)
    ends = {0: bird.bump(-0.39, 0.30, 0.05), 4: bird.bump(0.42, -0.27, 0.05)}
    line = propagate([(v, v + 1) for v in range(4)], 1.0, ends, bird.surface, entropy_limit="max", tolerance=1e-3)
    _say("line", line.converged.all(), line.entropies)
    canvas.edge((170, 170), (170 + 4 * 315, 170))
    for vertex, density in enumerate(line.densities):
        place = (170 + vertex * 315, 170)
        canvas.vertex(place, diameter, vertex in ends)
        canvas.centered(place, bird.density_image(density, 185))
    return canvas.figure


def interpolations() -> Figure:
    """Figure 6: displacement interpolation of two peaks, without and with a bound on the entropy."""
    # Narrow enough to separate the two peaks in thin parts of the shape.
    rings = Subject.of("double_torus", 0, -84, gamma=0.006)
    first = rings.bump(-0.28, 0.22, 0.04) + rings.bump(-0.28, -0.22, 0.04)
    second = rings.bump(0.28, 0.22, 0.04) + rings.bump(0.28, -0.22, 0.04)
    times = np.linspace(0.0, 1.0, 5)
    without = interpolate(first, second, times, rings.surface, tolerance=1e-3)
    limited = bisect(first, second, rings.surface, levels=2, tolerance=1e-3)
    _say("interpolate", without.converged, without.entropies)
    _say("bisect", limited.converged, limited.entropies)
    width = 300
    height = int(width / rings.shape.aspect)
    canvas = Canvas(_WIDTH, 2 * (height + 70))
    for row, (found, title) in enumerate(((without, "no bound"), (limited, "$H_0 = H$"))):
        bottom = 55 + (1 - row) * (height + 70)
        for column, density in enumerate(found.densities):
            left = 20 + column * (width + 15)
            canvas.image(left, bottom, rings.density_image(density, width))
            canvas.text(left + width / 2, bottom - 24, f"{title},  t = {times[column]:g}")
    return canvas.figure


def parts() -> Figure:
    """Morph a horse into a bird without and with parts that travel together."""
    names = ("horse", "bird")
    meshes = [read_mesh(PROJECT / "assets" / "shapes" / f"{name}.ply") for name in names]
    labels = [
        FaceLabels(_PARTS, split(mesh)) for mesh, split in zip(meshes, (_parts_of_horse, _parts_of_bird), strict=True)
    ]
    turn = Rotation.from_euler("zx", [-20, -75], degrees=True).as_matrix()
    settings = MorphSettings(resolution=96, motion="transport", mend=False)
    canvas = Canvas(_WIDTH, 760)
    for row, chosen in enumerate((None, labels)):
        steps = morph(MorphInputs.of(meshes, names, labels=chosen), path_blends(2, 4), settings)
        for column, frame in enumerate(step.payload for step in steps if step.payload):
            mesh = meshes[frame.blend.source] if frame.mesh is None else frame.mesh
            own = labels[frame.blend.source].faces if frame.mesh is None and chosen else np.full(len(mesh.faces), -1)
            place = (160 + column * 320, 570 - row * 375)
            canvas.centered(place, _part_image(mesh, own, turn))
            canvas.text(place[0], place[1] - 172, f"t = {frame.blend.weights[1]:g}")
            _say(chosen is not None, frame.blend.weights, frame.record.get("volume"), frame.record.get("overlap"))
    return canvas.figure


def _parts_of_horse(mesh: TriangleMesh) -> NDArray[np.int64]:
    """Cut the horse into parts by planes."""
    x, y, z = mesh.corners.mean(axis=1).T
    is_head = (x > -0.1) & (z > 1.25) | (0.6 * x + 0.8 * z > 1.36) & (z > 0.9)
    is_tail = (x < -0.6) & (z > 0.8) | (z > 0.42) & ((x < -0.7) | (x < -0.63) & (y > -0.07))
    return np.select([is_head, is_tail, (z < 0.8) & (y > 0), z < 0.8], [0, 1, 2, 3], 4)


def _parts_of_bird(mesh: TriangleMesh) -> NDArray[np.int64]:
    """Cut the bird into parts by planes."""
    x, y, z = mesh.corners.mean(axis=1).T
    is_head = (x > 0.36) & (z > 0.58) & (np.abs(y) < 0.24) & (z < 1.0)
    is_wing = (z > 0.46) & (np.abs(y) > 0.21) | (z > 1.0)
    is_tail = (x < -0.42) & (z < 0.42)
    return np.select([is_head, is_tail, is_wing & (y > 0), is_wing], [0, 1, 2, 3], 4)


def _part_image(mesh: TriangleMesh, labels: NDArray[np.int64], rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Draw a mesh in the colors of its parts, all meshes at one scale."""
    # Duplicate vertices for every part that they belong to, so that colors end at edges.
    pairs, faces = np.unique(
        np.stack([mesh.faces, np.repeat(labels[:, None], 3, axis=1)], -1).reshape(-1, 2), axis=0, return_inverse=True
    )
    shape = Shape(mesh.vertices[pairs[:, 0]] @ rotation.T, faces.reshape(-1, 3))
    width = round(145 * float(np.ptp(shape.vertices[:, 0])))
    return rendered(
        shape, pairs[:, 1].astype(float), lambda values, _: _PART_COLORS[np.round(values).astype(int)], width
    )


class Canvas:
    """A white picture with content placed in pixels, relative to its lower left corner."""

    def __init__(self, width: int, height: int) -> None:
        self.size = (width, height)
        self.figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")

    def axes(self, left: float, bottom: float, width: float, height: float) -> Axes:
        """Return axes without ticks or frame."""
        size = np.array([*self.size, *self.size])
        axes = self.figure.add_axes(np.array([left, bottom, width, height]) / size)
        axes.axis("off")
        return axes

    def image(self, left: float, bottom: float, image: NDArray[np.float64]) -> None:
        """Draw an image with its lower left corner at a position, pixel by pixel."""
        height, width = image.shape[:2]
        self.axes(round(left), round(bottom), width, height).imshow(image, interpolation="none", aspect="auto")

    def centered(self, place: tuple[float, float], image: NDArray[np.float64]) -> None:
        """Draw an image centered at a position."""
        height, width = image.shape[:2]
        self.image(place[0] - width / 2, place[1] - height / 2, image)

    def edge(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Draw an edge of a graph; vertices drawn later cover it."""
        ends = np.array([start, end]) / self.size
        self.figure.add_artist(Line2D(*ends.T, color=_INK, linewidth=2.5, zorder=-1))

    def vertex(self, place: tuple[float, float], diameter: float, is_given: bool) -> None:
        """Draw a vertex of a graph as a disc, solid where its distribution is given."""
        share = np.array([diameter, diameter]) / self.size
        disc = Ellipse(np.array(place) / self.size, *share, transform=self.figure.transFigure, linewidth=2.5)
        disc.set(facecolor=_GIVEN if is_given else "white", edgecolor=_INK, zorder=-1)
        self.figure.add_artist(disc)

    def text(self, x: float, y: float, text: str, color: str = _INK) -> None:
        """Write a line around a point."""
        width, height = self.size
        self.figure.text(x / width, y / height, text, ha="center", va="center", fontsize=15, color=color)


def _frame(axes: Axes) -> None:
    axes.axis("on")
    axes.set(xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set(color=_GRAY, linewidth=0.8)


def _say(*what: object) -> None:
    print("   ", *what)


FIGURES: dict[str, Callable[[], Figure]] = {
    "transport_plans": transport_plans,
    "distances": distances,
    "barycenters": barycenters,
    "propagations": propagations,
    "interpolations": interpolations,
    "parts": parts,
}


def main(names: Sequence[str]) -> None:
    """Write the pictures of these names."""
    PICTURES.mkdir(exist_ok=True)
    for name in names or FIGURES:
        print(name)
        canvas = FigureCanvasAgg(FIGURES[name]())
        canvas.draw()
        # Seven bits per color: the difference is invisible, and the file is a third smaller.
        pixels = np.asarray(canvas.buffer_rgba())[..., :3] | 1
        Image.fromarray(np.ascontiguousarray(pixels)).save(PICTURES / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
