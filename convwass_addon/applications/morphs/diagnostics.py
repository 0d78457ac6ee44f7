# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Diagnostics of a bake, from the solver's figures, in sentences that an artist can act on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from ...sentence import Sentence
from .morph_settings import MorphSettings
from .part_labels import NOTICES, part_notices

Severity = Literal["INFO", "WARNING", "ERROR"]
Value = str | int | float

TEXTS: dict[str, str] = {
    "TOO_COARSE": "Resolution {resolution} is too coarse for thin parts of {name} ({cells:.1f} cells): {better} keeps "
    "them",
    "LOST": "Parts are lost in {frames}, up to {share:.1%} of the shape: try resolution {better}",
    "LOST_THIN": "Parts {thickness:.1f} cells thick and {length:.0f} long are lost in {frames}, up to {share:.1%} of "
    "the shape: try resolution {better}",
    "NOT_CONVERGED": "Less exact than asked for in {frames}, by up to {error:.1%}: try more blur",
    "TORN": "Torn into up to {pieces} pieces in {frames}, where the shapes have {most}: try another motion",
    "HOLES": "Up to {holes} more holes than the shapes have in {frames}, where parts meet on the way",
    "WALL": "Up to {share:.1%} of the shape touches the wall of the volume in {frames}: try less blur",
    "WIDENED": "Blur was widened to {sigma:.1f} cells in {frames}, to reach from shape to shape",
    **NOTICES,
    "GUIDED": "Guided was chosen: the shapes map onto each other (agreement {score:.0%})",
    "PARTLY": "Guided was chosen: the shapes map onto each other in part (agreement {score:.0%}), and parts that only "
    "one of them has grow in place; guides may help",
    "COMBINED": "Guided, completed by Warp, was chosen: the map between the shapes is uncertain "
    "(agreement {score:.0%})",
    "WARPED": "Warp was chosen: there is no good map between the shapes (agreement {score:.0%}, detour {detour:.1f})",
    "CLOSER": "Warp was chosen: it brings the shapes closer to each other than the map between them "
    "(agreement {score:.0%})",
    "CRUMPLED": "Warp was chosen: the map between the shapes (agreement {score:.0%}) would crumple them",
    "UPRIGHT": "Warp was chosen: by the map between the shapes (agreement {score:.0%}), they would tumble",
    "TURNED": "The shapes turn by up to {angle:.0f} degrees on the way, since they seem to face different ways; if "
    "they do not, set guides",
    "GUIDES": "Guides left out: {count}; the shapes map better without them: check their points",
    "APART": "Transport was chosen: there is no good map between the shapes (agreement {score:.0%}, "
    "detour {detour:.1f}); guides may help",
    "TUMBLING": "Transport was chosen: by the map between the shapes (agreement {score:.0%}), they would tumble; "
    "guides may help",
    "VERTICES": "Guided was chosen: the shapes have the same vertices and faces",
    "OUTLINES": "Guided was chosen: the outlines of the shapes match",
    "OUTLINES_TURNED": "Guided was chosen: the outlines of the shapes match if they turn by up to {angle:.0f} degrees",
    "TUBES": "Guided was chosen: the shapes are tubes, and move as their center lines bend",
    "MERGED": "Warp was chosen: at least one of the shapes has no limbs",
    "SOLID": "Transport was chosen: at least one of the shapes has no limbs",
    "BENT": "Transport was chosen: a warp would bend the plane faces of the shapes",
    "REGIONS": "Transport was chosen: a shape has too many separate areas",
    "DISTORTED": "Transport was chosen: the outlines of the shapes differ too much",
    "TOPOLOGY": "Transport was chosen: triangles of a shape change from frame to frame, which no motion can follow",
    "NO_MOTION": "Transport was chosen: no motion between the shapes could be computed ({failure})",
    "LOOK_PROCEDURAL": "Procedural colors of {materials} ({names}) became one color: bake them to an image or to "
    "vertex colors",
    "LOOK_SHADER": "Frames do not have the shaders of {materials} ({names}): only Principled BSDF and Emission are "
    "mixed",
    "LOOK_MISSING": "The image of {materials} ({names}) could not be read, or there is no UV map: its color is that of "
    "the viewport",
    "LOOK_NODES": "Nodes between texture and base color of {materials} ({names}) were left out: bake them into the "
    "image",
    "LOOK_ANIMATED": "Animated values of {materials} ({names}) stay as they were when the morph was baked",
    "LOOK_NORMALS": "Normal maps, bump and displacement of {materials} ({names}) were left out",
    "LOOK_MAPS": "Textures of {sockets} of {materials} ({names}) were left out",
    "LOOK_TILES": "Of the UDIM tiles of {materials} ({names}) only the first one was read",
    "LOOK_VOLUME": "Volumes inside of {materials} ({names}) were left out",
    "LOOK_SPACE": "Normal maps of {materials} ({names}) in object or world space do not turn with the surface: use "
    "tangent space",
    "LOOK_AOV": "AOV outputs of {materials} ({names}) were left out",
    "LOOK_BLURRED": "Textures of {materials} ({names}) became colors of vertices, as sharp as the cells",
    "PREVIEWS": "The bake was stopped before its first frame: these are previews, coarser than asked for; bake again",
    "GOOD": "All meshes are as exact as asked for, and no parts are lost",
}
"""A template for every kind of note; the user interface translates it before the values are filled in."""

SEVERITIES: dict[str, Severity] = {
    "TOO_COARSE": "WARNING",
    "LOST": "WARNING",
    "LOST_THIN": "WARNING",
    "NOT_CONVERGED": "ERROR",
    "TORN": "WARNING",
    "HOLES": "INFO",
    "WALL": "WARNING",
    "WIDENED": "INFO",
    **dict.fromkeys(NOTICES, "INFO"),
    **dict.fromkeys(("GUIDED", "PARTLY", "VERTICES", "OUTLINES", "OUTLINES_TURNED", "TUBES", "COMBINED"), "INFO"),
    **dict.fromkeys(("WARPED", "CLOSER", "CRUMPLED", "UPRIGHT", "MERGED", "TURNED"), "INFO"),
    **dict.fromkeys(("APART", "TUMBLING", "SOLID", "BENT", "REGIONS", "DISTORTED", "TOPOLOGY"), "INFO"),
    **dict.fromkeys(("NO_MOTION", "GUIDES"), "WARNING"),
    **dict.fromkeys(("LOOK_PROCEDURAL", "LOOK_SHADER", "LOOK_MISSING", "LOOK_NODES", "LOOK_TILES"), "WARNING"),
    **dict.fromkeys(("LOOK_ANIMATED", "LOOK_NORMALS", "LOOK_MAPS", "LOOK_VOLUME", "LOOK_SPACE", "LOOK_AOV"), "WARNING"),
    "LOOK_BLURRED": "INFO",
    "PREVIEWS": "WARNING",
    "GOOD": "INFO",
}

# The notes on reasons not to follow a map, if the shapes are warped and not transported.
_IF_WARPED = {"SOLID": "MERGED", "APART": "WARPED", "TUMBLING": "UPRIGHT"}
# Parts of at least this thickness in cells survive a morph.
KEPT_CELLS = 2.0
# Fractions of the shape below this are not reported.
_SHARE = 0.002
_WALL_SHARE = 0.001
# A blur is reported as widened if it exceeds the requested one by this factor.
_WIDER = 1.01
# Suggested resolutions are multiples of the first number, up to the second.
_STEP, _FINEST = 8, 512
# The smallest increase of the resolution that makes a difference, and the one to try if nothing was measured.
_LEAST_FINER, _MUCH_FINER = 1.25, 1.5


@dataclass(frozen=True)
class Diagnostic:
    """One message about a bake.

    Attributes
    ----------
    kind : str
        A key of `TEXTS`.
    values : dict
        Values for its template.
    """

    kind: str
    values: dict[str, Value]

    @property
    def severity(self) -> Severity:
        """The severity of this kind."""
        return SEVERITIES[self.kind]

    @property
    def sentence(self) -> Sentence:
        """The message."""
        return Sentence(TEXTS[self.kind], self.values)

    @property
    def text(self) -> str:
        """Return the message in English; raises KeyError or ValueError for an invalid diagnostic."""
        return TEXTS[self.kind].format(**self.values)


def diagnose(
    records: Sequence[Mapping[str, object]],
    settings: Mapping[str, object],
    names: Sequence[str],
    numbers: Sequence[int] | None = None,
    dropped: Sequence[Diagnostic] = (),
) -> list[Diagnostic]:
    """Return what is wrong with a bake and what to do about it, the worst first.

    Parameters
    ----------
    records : sequence of dict
        The solver's figures of every frame, complete or reduced by `diagnostic_figures`; missing figures count as good.
    settings : dict
        The settings of the bake: ``resolution``, and ``blur`` if it was set.
    names : sequence of str
        Names of the shapes.
    numbers : sequence of int, optional
        Numbers of the frames; 1, 2, ... by default.
    dropped : sequence of Diagnostic
        What frames do not show of the shapes' materials.
    """
    if any(record.get("preview") for record in records):
        return [Diagnostic("PREVIEWS", {})]
    figures = [{**record, **diagnostic_figures(record)} for record in records]
    calls = _Frames(figures, list(numbers) if numbers is not None else list(range(1, len(figures) + 1)))
    resolution = int(settings["resolution"])
    notes = [
        *_not_converged(calls),
        *_too_coarse(figures, resolution, names),
        *_lost(calls, resolution),
        *_torn(calls),
        *_holes(calls),
        *_at_the_wall(calls),
        *_widened(calls, settings, resolution),
        *_notices(figures),
        *dropped,
    ]
    return [*(notes or [Diagnostic("GOOD", {})]), *_guides(figures), *_motion(figures), *_turned(figures)]


def diagnostic_figures(record: Mapping[str, object]) -> dict[str, str | float]:
    """Return the figures in nested parts of a record that `diagnose` needs, as a flat dictionary."""
    result: dict[str, str | float] = {}
    motion = record.get("motion")
    if isinstance(motion, Mapping):
        result |= {f"motion_{name}": value for name, value in motion.items()}
    for name in ("found", "most"):
        counts = record.get(name)
        if isinstance(counts, Mapping):
            result |= {f"{name}_{kind}": counts[kind] for kind in ("pieces", "handles") if kind in counts}
    for name in ("lost", "thin"):
        lost = record.get(name)
        if not isinstance(lost, Mapping):
            continue
        result[f"{name}_share"] = float(lost["share"])
        if lost["parts"]:
            chosen = lost["parts"][0]
            result[f"{name}_thickness"] = float(chosen["thickness"])
            result[f"{name}_length"] = float(chosen["length"])
    return result


@dataclass(frozen=True)
class _Frames:
    """Figures of all frames, and the frame numbers."""

    figures: list[dict[str, object]]
    numbers: list[int]

    def where(self, holds: Callable[[dict[str, object]], bool]) -> _Frames:
        """Return the frames that satisfy a condition."""
        chosen = [index for index, figure in enumerate(self.figures) if holds(figure)]
        return _Frames([self.figures[index] for index in chosen], [self.numbers[index] for index in chosen])

    def most(self, name: str) -> float:
        """Return the largest value of a figure."""
        return max(_number(figure, name) for figure in self.figures)

    def __str__(self) -> str:
        return listed(self.numbers)


def listed(numbers: Iterable[int]) -> str:
    """Abbreviate frame numbers as ranges: 3-7, 9."""
    runs: list[list[int]] = []
    for number in sorted(numbers):
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def _number(figure: Mapping[str, object], name: str) -> float:
    value = figure.get(name)
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else 0.0


def finer(resolution: int, cells: float) -> int:
    """Return the resolution at which a part of this thickness in cells becomes thick enough to survive."""
    wanted = resolution * (max(KEPT_CELLS / cells, _LEAST_FINER) if cells > 0.0 else _MUCH_FINER)
    return min(math.ceil(wanted / _STEP) * _STEP, max(_FINEST, resolution))


def _not_converged(frames: _Frames) -> list[Diagnostic]:
    slack = frames.where(lambda figure: figure.get("converged") is False)
    if not slack.figures:
        return []
    return [Diagnostic("NOT_CONVERGED", {"frames": str(slack), "error": slack.most("marginal_error")})]


def _too_coarse(figures: Sequence[dict[str, object]], resolution: int, names: Sequence[str]) -> list[Diagnostic]:
    notes, said = [], set()
    for figure in figures:
        index, cells = figure.get("input"), _number(figure, "thin_thickness")
        if not isinstance(index, int) or not 0 <= index < len(names) or index in said:
            continue
        if 0.0 < cells < KEPT_CELLS:
            said.add(index)
            values = {
                "resolution": resolution,
                "name": names[index],
                "cells": cells,
                "better": finer(resolution, cells),
            }
            notes.append(Diagnostic("TOO_COARSE", values))
    return notes


def _lost(frames: _Frames, resolution: int) -> list[Diagnostic]:
    torn = frames.where(lambda figure: _number(figure, "lost_share") >= _SHARE)
    if not torn.figures:
        return []
    worst = max(torn.figures, key=lambda figure: _number(figure, "lost_share"))
    thickness, length = _number(worst, "lost_thickness"), _number(worst, "lost_length")
    values = {"frames": str(torn), "share": torn.most("lost_share"), "better": finer(resolution, thickness)}
    if thickness:
        return [Diagnostic("LOST_THIN", {**values, "thickness": thickness, "length": length})]
    return [Diagnostic("LOST", values)]


def _torn(frames: _Frames) -> list[Diagnostic]:
    torn = frames.where(lambda figure: _number(figure, "found_pieces") > _number(figure, "most_pieces") > 0.0)
    if not torn.figures:
        return []
    values = {"frames": str(torn), "pieces": int(torn.most("found_pieces")), "most": int(torn.most("most_pieces"))}
    return [Diagnostic("TORN", values)]


def _holes(frames: _Frames) -> list[Diagnostic]:
    def beyond(figure: Mapping[str, object]) -> int:
        return int(_number(figure, "found_handles") - _number(figure, "most_handles"))

    pierced = frames.where(lambda figure: "most_handles" in figure and beyond(figure) > 0)
    if not pierced.figures:
        return []
    return [Diagnostic("HOLES", {"frames": str(pierced), "holes": max(map(beyond, pierced.figures))})]


def _at_the_wall(frames: _Frames) -> list[Diagnostic]:
    touching = frames.where(lambda figure: _number(figure, "wall") >= _WALL_SHARE)
    if not touching.figures:
        return []
    return [Diagnostic("WALL", {"frames": str(touching), "share": touching.most("wall")})]


def _widened(frames: _Frames, settings: Mapping[str, object], resolution: int) -> list[Diagnostic]:
    if settings.get("blur") is not None:
        return []
    # Morphs that were baked before it was recorded are in space.
    usual = MorphSettings(resolution=resolution).sigma
    wide = frames.where(lambda figure: _number(figure, "sigma") > _WIDER * (_number(figure, "sigma_wanted") or usual))
    return [Diagnostic("WIDENED", {"frames": str(wide), "sigma": wide.most("sigma")})] if wide.figures else []


def _motion(figures: Sequence[dict[str, object]]) -> list[Diagnostic]:
    """Return the automatically chosen motion with the reason; nothing if the user chose one."""
    chosen = next((figure for figure in figures if figure.get("motion_reason") not in (None, "ASKED")), None)
    if chosen is None:
        return []
    reason, kind = str(chosen["motion_reason"]), str(chosen.get("motion_kind"))
    note = _IF_WARPED.get(reason, reason) if kind == "warp" else reason
    if reason in ("VERTICES", "TUBES", "SOLID", "BENT", "REGIONS", "DISTORTED", "TOPOLOGY"):
        return [Diagnostic(note, {})]
    if reason == "OUTLINES":
        turned = _number(chosen, "motion_turned")
        return [Diagnostic("OUTLINES_TURNED", {"angle": turned}) if turned > 0.0 else Diagnostic("OUTLINES", {})]
    score = {"score": _number(chosen, "motion_score")}
    if reason == "APART":
        return [Diagnostic(note, {**score, "detour": _number(chosen, "motion_detour")})]
    if reason in ("PARTLY", "CRUMPLED", "TUMBLING"):
        return [Diagnostic(note, score)]
    note = {"guided": "GUIDED", "combined": "COMBINED", "warp": "CLOSER"}.get(kind)
    if note is None:
        return [Diagnostic("NO_MOTION", {"failure": str(chosen.get("motion_failure", ""))})]
    return [Diagnostic(note, score)] if chosen.get("motion_score") is not None else []


def _guides(figures: Sequence[dict[str, object]]) -> list[Diagnostic]:
    count = int(max((_number(figure, "motion_guides_left_out") for figure in figures), default=0.0))
    return [Diagnostic("GUIDES", {"count": count})] if count else []


def _turned(figures: Sequence[dict[str, object]]) -> list[Diagnostic]:
    # Flat shapes have no guides, and their note on the motion tells the angle.
    solid = [figure for figure in figures if figure.get("motion_reason") != "OUTLINES"]
    angle = max((_number(figure, "motion_turned") for figure in solid), default=0.0)
    return [Diagnostic("TURNED", {"angle": angle})] if angle > 0.0 else []


def _notices(figures: Sequence[dict[str, object]]) -> list[Diagnostic]:
    notices = dict.fromkeys(notice for figure in figures for notice in part_notices(figure))
    return [Diagnostic(notice.kind, {"name": notice.name}) for notice in notices]
