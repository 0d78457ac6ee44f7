# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a morph, in the background if there is a window."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..bridge.files.output_paths import creatable_folder
from ..bridge.handles import Handle
from ..bridge.morphs.inputs.morph_guides import NamedGuide, check_guide_names, guides_among, guides_now, parsed_guides
from ..bridge.shape_sources import is_plain, shape_sources
from ..errors import InputError
from ..preferences import preferences
from ..progress import Control, Work
from ..properties.morphs import MorphProperties
from ..sentence import Sentence
from ..translations import translated
from .background import BackgroundOperator, Job
from .chosen_inputs import ChosenInputs, baked_inputs, chosen_inputs
from .morph_manage import is_free_to_bake, is_own
from .morph_results import FrameResults, ShapeKeyResults, SwapResults, bake_following

if TYPE_CHECKING:
    from ..applications.morphs.computation import Computation
    from ..bridge.flat.flat_job import FlatJob
    from ..bridge.flat.picture_job import PictureJob
    from ..bridge.morphs.job import MorphJob
    from ..bridge.one_mesh.shape_key_job import ShapeKeyJob
    from ..bridge.one_mesh.swap_job import SwapJob


class CONVWASS_OT_bake_morph(BackgroundOperator, MorphProperties, bpy.types.Operator):
    """Morph shapes into each other by optimal transport: the shapes on the list, or the selected ones if it is empty"""

    bl_idname = "convwass.bake_morph"
    bl_label = "Bake Morph"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Baking morph")

    inputs: StringProperty(
        name="Inputs",
        description="Names of the objects to morph in order, one per line or separated by commas; empty for those of "
        "the replaced morph, the shapes on the input list, or the selected ones",
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
        description="Name of the morph that is replaced, which is a collection or an object with shape keys; empty for "
        "a new morph",
        options={"SKIP_SAVE"},
    )
    following: StringProperty(
        name="Following",
        description="Session IDs of morphs to bake again after this one, one per line",
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
        from ..bridge.morphs.disk.disk_output import own_folder
        from ..bridge.morphs.job import MorphJob
        from ..bridge.morphs.mixed_job import MixedMorphJob, will_mix

        self._computing = self._preferred()
        self._replaced = self._named()
        chosen = self._chosen(context)
        guides = self._guides(context, chosen.objects)
        first_frame = self.first_frame(context.scene)
        if self.output == "SHAPE_KEYS":
            return self._shape_keys(chosen.objects, guides, first_frame)
        request = self.request(chosen.weights if self.layout == "BLEND" else None)
        request.check_output()
        blends = request.blends(len(chosen.objects))
        are_plain = all(map(is_plain, shape_sources(chosen.objects, self.grouping)))
        are_flat = are_plain and asks_for_flat(chosen.objects, context.evaluated_depsgraph_get(), self.thickness)
        refuse_volumes(are_flat and self.output == "VOLUME")
        refuse_following(are_flat and self.follow == "FOLLOW")
        self._require_folder()
        if are_flat:
            if guides:
                self.report({"INFO"}, rpt_("Flat shapes do not support guides"))
            # Players, volumes and caches require meshes.
            kind = self.flat_output if self.output == "OBJECTS" else "MESH"
            options = replace(request, flat_output=kind).as_dict()
            settings = self.flat_settings()
            pictures = partial(PictureJob, replaces=self.replaced(), folder_of=own_folder)
            flat_job = pictures if kind == "PICTURE" else FlatJob
            return flat_job(chosen.objects, blends, settings, options, first_frame)
        settings = self.solver_settings()
        options = replace(request, guides=[guide.as_dict() for guide in guides]).as_dict()
        job = MixedMorphJob if will_mix(self.replaced(), request) else MorphJob
        return job(chosen.objects, blends, settings, options, first_frame)

    def _chosen(self, context: bpy.types.Context) -> ChosenInputs:
        """Return the shapes to morph; raises InputError as `chosen_inputs`."""
        replaced = self.replaced()
        if replaced is not None and not self.inputs.strip():
            return baked_inputs(replaced, self.weights)
        return chosen_inputs(context, self, self.inputs, self.weights)

    def replaced(self) -> bpy.types.Collection | bpy.types.Object | None:
        """Return what the bake replaces, which may have another name since the bake began; None if it was deleted."""
        block = None if self._replaced is None else self._replaced.find()
        return block if block is not None and is_own(block) else None

    def _require_folder(self) -> None:
        """Raise InputError if the files of the morph could not be written after the bake."""
        from ..bridge.morphs.disk.disk_output import read_files, require_rewritable

        replaced = self.replaced()
        if replaced is not None and read_files(replaced) is not None:
            require_rewritable(replaced)
        elif self.output in ("VOLUME", "CACHE"):
            creatable_folder(self.folder)

    def _named(self) -> Handle | None:
        """Return a handle of the local data that is to be replaced, or None."""
        kind = "objects" if self.output == "SHAPE_KEYS" else "collections"
        block = getattr(bpy.data, kind).get((self.replaces, None))
        return None if block is None else Handle.of(kind, block)

    def _shape_keys(
        self, objects: list[bpy.types.Object], guides: list[NamedGuide], first_frame: int
    ) -> ShapeKeyJob | SwapJob:
        from ..bridge.one_mesh.shape_key_job import ShapeKeyJob, refuse_one_mesh
        from ..bridge.one_mesh.swap_job import SwapJob

        refuse_one_mesh(objects)
        request = replace(self.request(), layout=self.used_layout, guides=[guide.as_dict() for guide in guides])
        job = SwapJob if self.two_meshes else ShapeKeyJob
        return job(objects, request, self.solver_settings(), first_frame)

    def _guides(self, context: bpy.types.Context, objects: list[bpy.types.Object]) -> list[NamedGuide]:
        """Return the guides on the shapes; raises InputError if the argument names other objects."""
        if not self.guides:
            own = context.scene.convwass_guides
            own.renew()
            return guides_among(own.named, objects)
        guides = parsed_guides(self.guides)
        check_guide_names(guides, objects)
        return guides_now(guides, objects)

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

    def _steps(self, job: Job) -> Callable[[Control], Work[None]]:
        # Previews are only useful if the user can see them and stop the bake.
        computation = replace(self._computing, previews=self._in_background)
        return lambda control: job.steps(control, computation)

    def _waits_for(self, _context: bpy.types.Context, _job: Job) -> Sentence | None:
        """Return a message if an object that gets another mesh is in Edit Mode, where Blender keeps its mesh."""
        from ..bridge.one_mesh.records import objects_of

        replaced = self.replaced()
        if isinstance(replaced, bpy.types.Object) and any(obj.mode == "EDIT" for obj in objects_of(replaced)):
            return Sentence("Done; leave Edit Mode to apply the result")
        return None

    def _results(self, job: Job) -> FrameResults | ShapeKeyResults | SwapResults:
        from ..bridge.one_mesh.shape_key_job import ShapeKeyJob
        from ..bridge.one_mesh.swap_job import SwapJob

        if isinstance(job, SwapJob):
            return SwapResults(self, job)
        if isinstance(job, ShapeKeyJob):
            return ShapeKeyResults(self, job)
        return FrameResults(self, job, self._computing.cache)

    def _nothing_kept(self, job: Job) -> str:
        return self._results(job).nothing_kept()

    def _keep(self, context: bpy.types.Context, job: Job) -> bool:
        return self._results(job).keep(context, self._own_scene(context))

    def _finish(self, context: bpy.types.Context, job: Job) -> set[str]:
        self._results(job).finish(context, self._own_scene(context))
        return {"FINISHED"}

    def _go_on(self) -> None:
        bake_following(self)


classes = (CONVWASS_OT_bake_morph,)
