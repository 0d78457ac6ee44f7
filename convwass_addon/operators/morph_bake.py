# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a morph, in the background if there is a window."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..bridge.files import absolute_folder
from ..bridge.frame_range import play_whole
from ..bridge.morphs.disk_output import packed_bytes
from ..bridge.morphs.morph_guides import NamedGuide, check_guide_names, guides_among, parsed_guides
from ..bridge.morphs.replace import replace_bake
from ..bridge.morphs.stand_ins import stand_ins
from ..bridge.morphs.stored import frame_objects
from ..bridge.operator_errors import reason
from ..bridge.shape_sources import is_plain, shape_source
from ..errors import InputError
from ..preferences import preferences
from ..progress import Control, Work
from ..properties.morphs import MorphProperties
from ..sentence import Sentence
from ..translations import translated
from .background import BackgroundOperator
from .chosen_inputs import chosen_inputs
from .morph_manage import is_free_to_bake, select_only
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.morphs.computation import Computation
    from ..applications.one_mesh.key_paths import KeyPath
    from ..bridge.flat.flat_job import FlatJob
    from ..bridge.flat.picture_job import PictureJob
    from ..bridge.morphs.job import MorphJob
    from ..bridge.one_mesh.shape_key_job import ShapeKeyJob

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


class CONVWASS_OT_bake_morph(BackgroundOperator, MorphProperties, bpy.types.Operator):
    """Morph shapes into each other by optimal transport: the shapes on the list, or the selected ones if it is empty"""

    bl_idname = "convwass.bake_morph"
    bl_label = "Bake Morph"
    bl_options = {"REGISTER", "UNDO"}

    inputs: StringProperty(
        name="Inputs",
        description="Names of the objects to morph in order, one per line or separated by commas; empty for the "
        "shapes on the input list, or the selected ones",
        options={"SKIP_SAVE"},
    )
    weights: StringProperty(
        name="Weights",
        description="Numbers separated by commas, one per shape, for a single blend; empty for the weights on the list",
        options={"SKIP_SAVE"},
    )

    guides: StringProperty(
        name="Guides",
        description='Corresponding points, such as [{"name": "nose", "points": {"Man": 12, "Woman": 345}}]; empty for '
        "the list of guides",
        options={"SKIP_SAVE"},
    )
    replaces: StringProperty(
        name="Replaces",
        description="Name of the collection of a morph whose frames are replaced; empty for a new morph",
        options={"SKIP_SAVE"},
    )
    following: StringProperty(
        name="Following",
        description="Names of morphs to bake again after this one, one per line",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        if not is_free_to_bake(cls, context):
            return False
        # The shapes depend on the arguments, so the poll only counts objects.
        if len(bpy.data.objects) < 2:
            cls.poll_message_set("Select at least two shapes")
            return False
        return True

    def _begin(self, context: bpy.types.Context) -> MorphJob | FlatJob | PictureJob:
        """Read the inputs. Invalid input is refused here or before the first frame."""
        from ..bridge.flat.choosing import asks_for_flat, refuse_following, refuse_volumes
        from ..bridge.flat.flat_job import FlatJob
        from ..bridge.flat.picture_job import PictureJob
        from ..bridge.morphs.job import MorphJob

        self._computing = self._preferred()
        chosen = chosen_inputs(context, self, self.inputs, self.weights)
        weights = chosen.weights if self.layout == "BLEND" else None
        guides = self._guides(context, [obj.name for obj in chosen.objects])
        request = self.request(weights)
        blends = request.blends(len(chosen.objects))
        depsgraph, first_frame = context.evaluated_depsgraph_get(), self.first_frame(context.scene)
        are_plain = all(is_plain(shape_source(obj, self.grouping)) for obj in chosen.objects)
        are_flat = are_plain and asks_for_flat(chosen.objects, depsgraph, self.thickness)
        refuse_volumes(are_flat and self.output == "VOLUME")
        refuse_following(are_flat and self.follow == "FOLLOW")
        if self.output in ("VOLUME", "CACHE"):
            absolute_folder(self.folder)
        if self.output == "SHAPE_KEYS":
            return self._shape_keys(context, chosen.objects, guides, first_frame)
        if are_flat:
            if guides:
                self.report({"INFO"}, rpt_("Flat shapes do not support guides"))
            # Players, volumes and caches require meshes.
            kind = self.flat_output if self.output == "OBJECTS" else "MESH"
            options = replace(request, flat_output=kind).as_dict()
            settings = self.flat_settings()
            flat_job = partial(PictureJob, replaces=self.replaces) if kind == "PICTURE" else FlatJob
            return flat_job(context.scene, depsgraph, chosen.objects, blends, settings, options, first_frame)
        settings = self.solver_settings()
        options = replace(request, guides=[guide.as_dict() for guide in guides]).as_dict()
        return MorphJob(context.scene, depsgraph, chosen.objects, blends, settings, options, first_frame)

    def _shape_keys(
        self, context: bpy.types.Context, objects: list[bpy.types.Object], guides: list[NamedGuide], first_frame: int
    ) -> ShapeKeyJob:
        from ..bridge.one_mesh.shape_key_job import ShapeKeyJob, refuse_one_mesh

        refuse_one_mesh(objects)
        request = replace(self.request(), guides=[guide.as_dict() for guide in guides])
        depsgraph = context.evaluated_depsgraph_get()
        return ShapeKeyJob(context.scene, depsgraph, objects, request, self.solver_settings(), first_frame)

    def _guides(self, context: bpy.types.Context, names: list[str]) -> list[NamedGuide]:
        """Return the guides on the shapes; raises InputError if the argument names other objects."""
        if not self.guides:
            return guides_among(context.scene.convwass_guides.named, names)
        guides = parsed_guides(self.guides)
        check_guide_names(guides, names)
        return guides

    def _preferred(self) -> Computation:
        """Return the computation settings of the preferences; raises InputError if the cache folder cannot be used."""
        from ..applications.morphs.computation import Computation
        from ..applications.morphs.frame_cache import FrameCache, SpareFrameCache
        from ..bridge.morphs.found_motions import FOUND_MOTIONS

        preferred = preferences()
        cache = None
        if preferred.cache_folder is not None:
            if not preferred.cache_folder.is_absolute():
                raise InputError(
                    "The cache folder {path} is relative, so it depends on the file; set an absolute path in the "
                    "preferences of the add-on.",
                    path=str(preferred.cache_folder),
                )
            cache = FrameCache(preferred.cache_folder)
        elif preferred.spare_folder is not None:
            try:
                cache = SpareFrameCache(preferred.spare_folder, preferred.spare_bytes)
            except InputError as error:
                # This cache is optional, so the bake continues without it.
                self.report({"WARNING"}, translated(error.sentence))
        return Computation(workers=preferred.workers, cache=cache, motions=FOUND_MOTIONS)

    def _steps(self) -> Callable[[Control], Work[None]]:
        # Previews are only useful if the user can see them and stop the bake.
        how = replace(self._computing, previews=self._in_background)
        return lambda control: self._job.steps(control, how)

    def _title(self) -> str:
        return rpt_("Baking morph")

    def _nothing_kept(self) -> str:
        if self.output == "SHAPE_KEYS":
            return rpt_("Stopped; nothing was changed")
        if self.replaces:
            return rpt_("Stopped; the morph was not changed")
        return rpt_("Stopped before the first frame was finished")

    def _keep(self, context: bpy.types.Context, job: MorphJob | FlatJob | PictureJob) -> bool:
        from ..bridge.morphs.job import MorphJob

        if self.replaces or self.output == "SHAPE_KEYS":
            return False
        message = rpt_("Stopped; {:d} finished frames are kept").format(len(job.records))
        if not job.records:
            # Flat shapes have no previews.
            if not (isinstance(job, MorphJob) and job.keep_previews()):
                return False
            message = rpt_("Stopped; the previews are kept, coarser than requested")
        collection = job.finish(self.hide_inputs)
        self._fit_range(context, job)
        select_only(context, frame_objects(collection)[:1])
        self.report({"WARNING"}, message)
        return True

    def _finish(self, context: bpy.types.Context, job: MorphJob) -> set[str]:
        if self.output == "SHAPE_KEYS":
            return self._finish_keys(context, job)
        collection = job.finish(self.hide_inputs)
        self._fit_range(context, job)
        replaced = bpy.data.collections.get(self.replaces)
        if replaced is not None:
            collection = replace_bake(replaced, collection)
        select_only(context, frame_objects(collection)[:1])
        self._hand_over(self._own_scene(context), collection)
        slack = [record for record in job.records if not record.get("converged", True)]
        if slack:
            worst = max(record["marginal_error"] for record in slack)
            message = rpt_("{:d} frames are less exact than requested (marginal error up to {:.1%}); try more blur")
            self.report({"WARNING"}, message.format(len(slack), worst))
        elif notices := [translated(notice) for notice in (*job.notices, *self._cache_notices())]:
            self.report({"WARNING"}, " ".join(notices))
        elif (megabytes := packed_bytes(frame_objects(collection)) / 1e6) > _LARGE_MEGABYTES:
            message = rpt_(
                "The meshes add about {:.0f} MB to the file; Make Cache or Make Volume stores them next to it"
            )
            self.report({"WARNING"}, message.format(megabytes))
        else:
            self.report({"INFO"}, self._summary(collection.name, len(job.records)) + self._when(job))
        if self.following:
            bpy.ops.convwass.rebake_morph("INVOKE_DEFAULT", morphs=self.following)
        return {"FINISHED"}

    def _finish_keys(self, context: bpy.types.Context, job: ShapeKeyJob) -> set[str]:
        obj = job.finish(self.hide_inputs)
        self._fit_range(context, job)
        select_only(context, [obj])
        count = sum(len(path.times) for path in job.paths)
        farthest = max(path.distance_95 for path in job.paths)
        text = rpt_("{:s}: {:d} shape keys; 95 % of the mesh ends within {:.2%} of the other shape")
        warnings = [*job.notices, *(_poor_notice(path) for path in job.paths if len(path.poor))]
        tell(self, text.format(obj.name, count, farthest), (), warnings)
        return {"FINISHED"}

    def _fit_range(self, context: bpy.types.Context, job: MorphJob) -> None:
        if self.fit_range and job.span is not None:
            play_whole(self._own_scene(context), *job.span)

    def _when(self, job: MorphJob) -> str:
        """Return the frame range of the morph as text."""
        if job.span is None:
            return ""
        return rpt_(", frames {:d} to {:d}").format(*map(round, job.span))

    def _cache_notices(self) -> list[Sentence]:
        cache = self._computing.cache
        return [] if cache is None else cache.notices

    def _summary(self, name: str, count: int) -> str:
        cache = self._computing.cache
        if cache is None or not cache.reused:
            made = {
                "CURVE": rpt_("{:s}: {:d} curves"),
                "DRAWING": rpt_("{:s}: {:d} drawings"),
                "PICTURE": rpt_("{:s}: {:d} pictures"),
            }
            return made.get(getattr(self._job, "kind", ""), rpt_("{:s}: {:d} meshes")).format(name, count)
        return rpt_("{:s}: {:d} meshes, {:d} of them from the cache").format(name, count, cache.reused)

    def _hand_over(self, scene: bpy.types.Scene, morph: bpy.types.Collection) -> None:
        """Convert the morph to the requested output; if that fails, its meshes are kept."""
        name = _OUTPUT_OPERATORS.get((self.output, self.layout)) or _OUTPUT_OPERATORS.get((self.output, ""))
        if name is None or stand_ins(morph):
            return
        options = {"folder": self.folder} if self.output in ("VOLUME", "CACHE") else {}
        if self.output == "PLAYER":
            options["between"] = self.between
        if self.output == "CACHE":
            options["kind"] = self.cache_format
        try:
            with nullcontext() if scene == bpy.context.scene else _showing(scene, morph):
                getattr(bpy.ops.convwass, name)(**options)
        except RuntimeError as error:
            self.report({"WARNING"}, str(reason(error)))


def _poor_notice(path: KeyPath) -> Sentence:
    return Sentence(
        "{count} vertices are folded or do not arrive at {name}; an attribute marks them: add guides there",
        {"count": len(path.poor), "name": path.name},
    )


@contextmanager
def _showing(scene: bpy.types.Scene, morph: bpy.types.Collection) -> Iterator[None]:
    """Make a morph active for operators, although the window shows another scene."""
    nothing = {"object": None, "active_object": None, "selected_objects": []}
    with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0], collection=morph, **nothing):
        yield


classes = (CONVWASS_OT_bake_morph,)
