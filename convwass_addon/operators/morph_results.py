# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake leaves when it ends or is stopped: the frames of a morph, or one mesh with shape keys."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.edited_materials import made_as
from ..bridge.frame_range import play_whole
from ..bridge.morphs.disk.disk_output import ReadFiles, disk_outputs, packed_bytes, read_files
from ..bridge.morphs.inputs.hidden_inputs import (
    instances_without,
    missed_in_renders,
    shown_when_opened,
    still_in_renders,
)
from ..bridge.morphs.players.blend_pad import build_blend_pad
from ..bridge.morphs.players.player import build_player
from ..bridge.morphs.replace import replace_bake
from ..bridge.morphs.showing import main_object
from ..bridge.morphs.stand_ins import stand_ins
from ..bridge.morphs.stored import frame_objects
from ..bridge.operator_errors import reason
from ..bridge.scene_context import in_scene
from ..errors import InputError
from ..sentence import Sentence, first_names
from ..translations import translated
from .morph_manage import select_only
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.morphs.frame_cache import FrameCache
    from ..bridge.flat.flat_job import FlatJob
    from ..bridge.flat.picture_job import PictureJob
    from ..bridge.morphs.fields.field_sampling import SampledFields
    from ..bridge.morphs.job import MorphJob
    from ..bridge.one_mesh.shape_key_job import ShapeKeyJob
    from ..bridge.one_mesh.swap_job import SwapJob

# Total size of the meshes above which a warning is shown.
_LARGE_MEGABYTES = 250.0
# The operator that creates the output, by kind and layout.
_OUTPUT_OPERATORS = {
    ("PLAYER", "PATH"): "make_player",
    ("PLAYER", "GRID"): "make_blend_pad",
    ("PLAYER", "TRIANGLE"): "make_blend_pad",
    ("VOLUME", ""): "make_volume",
    ("CACHE", ""): "make_cache",
}
# Functions that create the same of frames that are already sampled.
_MIXING = {
    "make_player": lambda morph, sampled: build_player(morph, playback="ONCE", easing="LINEAR", sampled=sampled),
    "make_blend_pad": lambda morph, sampled: build_blend_pad(morph, sampled=sampled),
}


@dataclass(frozen=True)
class FrameResults:
    """The frames of a morph.

    Attributes
    ----------
    operator : bpy.types.Operator
        *Bake Morph*, which holds the options and shows the messages.
    job : MorphJob or FlatJob or PictureJob
        Wrote the frames.
    cache : FrameCache or None
        Frames of earlier bakes, if they are kept.
    """

    operator: bpy.types.Operator
    job: MorphJob | FlatJob | PictureJob
    cache: FrameCache | None

    def nothing_kept(self) -> str:
        """Return the message of a bake that was stopped without a result."""
        if self.operator.replaces:
            return rpt_("Stopped; the morph was not changed")
        return rpt_("Stopped before the first frame was finished")

    def keep(self, context: bpy.types.Context, scene: bpy.types.Scene) -> bool:
        """Keep what is there after a stop; return whether there is anything."""
        from ..bridge.morphs.job import MorphJob

        if self.operator.replaces:
            return False
        message = rpt_("Stopped; {:d} finished frames are kept").format(len(self.job.records))
        if not self.job.records:
            # Flat shapes have no previews.
            if not (isinstance(self.job, MorphJob) and self.job.keep_previews()):
                return False
            message = rpt_("Stopped; the previews are kept, coarser than requested")
        collection = self.job.finish(self.operator.hide_inputs)
        _fit_range(self.operator, self.job, scene)
        select_only(context, frame_objects(collection)[:1])
        self.operator.report({"WARNING"}, message)
        return True

    def finish(self, context: bpy.types.Context, scene: bpy.types.Scene) -> None:
        """Put the frames into the scene, convert them to the requested output, and report."""
        collection = self.job.finish(self.operator.hide_inputs)
        sampled = self._sampled()
        _fit_range(self.operator, self.job, scene)
        replaced = self.operator.replaced()
        if replaced is not None:
            edited = replace_bake(replaced, collection, sampled)
            collection = replaced
            _report_kept(self.operator, edited)
        select_only(context, frame_objects(collection)[:1])
        self._hand_over(scene, collection, sampled)
        shown = main_object(collection)
        select_only(context, [] if shown is None else [shown])
        _report_hiding(self.operator, collection)
        self._report(collection)

    def _report(self, collection: bpy.types.Collection) -> None:
        """Show the most important message: errors of the solver, notices, the size, or a summary."""
        slack = [record for record in self.job.records if not record.get("converged", True)]
        notices = [*self.job.notices, *(self.cache.notices if self.cache is not None else ())]
        megabytes = packed_bytes(frame_objects(collection)) / 1e6
        if slack:
            worst = max(record["marginal_error"] for record in slack)
            message = rpt_("{:d} frames are less exact than requested (marginal error up to {:.1%}); try more blur")
            self.operator.report({"WARNING"}, message.format(len(slack), worst))
        elif notices:
            self.operator.report({"WARNING"}, " ".join(translated(notice) for notice in notices))
        elif megabytes > _LARGE_MEGABYTES:
            message = rpt_(
                "The meshes add about {:.0f} MB to the file; Make Cache or Make Volume stores them next to it"
            )
            self.operator.report({"WARNING"}, message.format(megabytes))
        else:
            self.operator.report({"INFO"}, self._summary(collection.name) + self._when())

    def _summary(self, name: str) -> str:
        count = len(self.job.records)
        if self.cache is None or not self.cache.reused:
            made = {
                "CURVE": rpt_("{:s}: {:d} curves"),
                "DRAWING": rpt_("{:s}: {:d} drawings"),
                "PICTURE": rpt_("{:s}: {:d} pictures"),
            }
            return made.get(getattr(self.job, "kind", ""), rpt_("{:s}: {:d} meshes")).format(name, count)
        return rpt_("{:s}: {:d} meshes, {:d} of them from the cache").format(name, count, self.cache.reused)

    def _when(self) -> str:
        """Return the frame range of the morph as text."""
        if self.job.span is None:
            return ""
        return rpt_(", frames {:d} to {:d}").format(*map(round, self.job.span))

    def _sampled(self) -> SampledFields | None:
        """Return the fields of the frames if the bake has sampled them."""
        from ..bridge.morphs.mixed_job import MixedMorphJob

        return self.job.sampled if isinstance(self.job, MixedMorphJob) else None

    def _hand_over(self, scene: bpy.types.Scene, morph: bpy.types.Collection, sampled: SampledFields | None) -> None:
        """Convert the morph to the requested output, or to that of the replaced morph.

        If that fails, its meshes are kept, and so are objects that show the files of the replaced morph.
        """
        output, layout = self.operator.output, self.operator.layout
        files = read_files(morph) or ReadFiles(output, self.operator.folder, self.operator.cache_format)
        name = _OUTPUT_OPERATORS.get((files.output, layout)) or _OUTPUT_OPERATORS.get((files.output, ""))
        if name is None or stand_ins(morph):
            return
        options = {"folder": files.folder} if files.output in ("VOLUME", "CACHE") else {}
        if files.output == "PLAYER":
            options["between"] = self.operator.between
        if files.output == "CACHE":
            options["kind"] = files.cache_format
        try:
            with _showing(scene, morph):
                if files.output == "PLAYER" and sampled is not None:
                    _MIXING[name](morph, sampled)
                else:
                    getattr(bpy.ops.convwass, name)(**options)
        except InputError as error:
            self.operator.report({"WARNING"}, translated(error.sentence))
        except RuntimeError as error:
            self.operator.report({"WARNING"}, " ".join([str(reason(error)), *_outdated(morph)]))


@dataclass(frozen=True)
class ShapeKeyResults:
    """One mesh with shape keys, which is there as a whole or not at all.

    Attributes
    ----------
    operator : bpy.types.Operator
        *Bake Morph*, which holds the options and shows the messages.
    job : ShapeKeyJob or SwapJob
        Computed the keys.
    """

    operator: bpy.types.Operator
    job: ShapeKeyJob | SwapJob

    def nothing_kept(self) -> str:
        """Return the message of a bake that was stopped."""
        return rpt_("Stopped; nothing was changed")

    def keep(self, _context: bpy.types.Context, _scene: bpy.types.Scene) -> bool:
        """Return False: without all of its keys the mesh is of no use."""
        return False

    def finish(self, context: bpy.types.Context, scene: bpy.types.Scene) -> None:
        """Put the objects into the scene, or their meshes into those of the replaced bake, and report."""
        from ..bridge.one_mesh.key_notices import poor_notices
        from ..bridge.one_mesh.replaced_keys import following_notices, replace_keys

        made, replaced = self.job.finish(self.operator.hide_inputs), self.operator.replaced()
        shown = made if replaced is None else replace_keys(replaced, made)
        _fit_range(self.operator, self.job, scene)
        select_only(context, shown)
        _report_hiding(self.operator, shown[0])
        warnings = [*self.job.notices, *poor_notices(self.job.paths), *following_notices(shown)]
        tell(self.operator, translated(self._summary(shown)), (), warnings)

    def _summary(self, shown: list[bpy.types.Object]) -> Sentence:
        """Return how well the mesh arrives."""
        from ..bridge.one_mesh.key_notices import key_summary

        return key_summary(shown[0].name, self.job.paths)


@dataclass(frozen=True)
class SwapResults(ShapeKeyResults):
    """Two meshes with shape keys, one of which replaces the other.

    Attributes
    ----------
    job : SwapJob
        Computed the keys.
    """

    job: SwapJob

    def _summary(self, shown: list[bpy.types.Object]) -> Sentence:
        """Return how well both meshes fit each other."""
        from ..bridge.one_mesh.key_notices import swap_summary

        return swap_summary(shown[0].name, shown[1].name, self.job.found)


def _report_kept(operator: bpy.types.Operator, materials: list[bpy.types.Material]) -> None:
    """Report materials that are kept although frames no longer have them, because they are edited or may be."""
    edited = [material.name for material in materials if made_as(material) is not None]
    earlier = [material.name for material in materials if made_as(material) is None]
    if edited:
        text = rpt_("The materials of the shapes have changed, so frames have new ones; the edited ones are kept: {:s}")
        operator.report({"WARNING"}, text.format(first_names(edited)))
    if earlier:
        text = rpt_(
            "Materials of an earlier version cannot be compared, so frames have new ones; the old ones are kept: {:s}"
        )
        operator.report({"WARNING"}, text.format(first_names(earlier)))


def _report_hiding(operator: bpy.types.Operator, morph: bpy.types.ID) -> None:
    """Report shapes that cannot be hidden in renders, and those that other scenes and instances lack from now on."""
    if shown := still_in_renders(morph):
        text = rpt_(
            "Renders may show {:s} beside the morph, since keyframes or drivers set whether renders show them; "
            "remove or mute these"
        )
        operator.report({"WARNING"}, text.format(first_names(shown)))
    if linked := shown_when_opened(morph):
        text = rpt_(
            "Renders show {:s} again when the file is opened, since they are linked; hide them in their file, or make "
            "library overrides and bake again"
        )
        operator.report({"WARNING"}, text.format(first_names(linked)))
    for scene, names in missed_in_renders(morph).items():
        text = rpt_(
            "Renders of {:s} lack {:s}, since objects are hidden in all scenes; if needed, turn Hide Inputs off"
        )
        operator.report({"WARNING"}, text.format(scene, first_names(names)))
    instances, names = instances_without(morph)
    if instances:
        text = rpt_(
            "Renders of the instances {:s} lack {:s}, since objects are hidden in all instances; if needed, turn Hide "
            "Inputs off"
        )
        operator.report({"WARNING"}, text.format(first_names(instances), first_names(names)))


def _outdated(morph: bpy.types.Collection) -> list[str]:
    """Return a message that an object shows the files of the last bake, if there is one."""
    if not disk_outputs(morph):
        return []
    text = rpt_("{:s} still shows the last bake, beside the new meshes; select it and press Make Volume or Make Cache")
    return [text.format(main_object(morph).name)]


def bake_following(operator: bpy.types.Operator) -> None:
    """Start the next one of several bakes in the background, and report those that cannot start."""
    if not operator.following:
        return
    try:
        bpy.ops.convwass.rebake_morph("INVOKE_DEFAULT", session_uids=operator.following)
    except RuntimeError as error:
        operator.report({"ERROR"}, str(reason(error)))


def _fit_range(operator: bpy.types.Operator, job: MorphJob | ShapeKeyJob | SwapJob, scene: bpy.types.Scene) -> None:
    if operator.fit_range and job.span is not None:
        play_whole(scene, *job.span)


def _showing(scene: bpy.types.Scene, morph: bpy.types.Collection) -> AbstractContextManager[None]:
    """Make a morph active for operators, although it is excluded from the view layer or in another scene."""
    nothing = {"object": None, "active_object": None, "selected_objects": []}
    return in_scene(scene, collection=morph, **nothing)
