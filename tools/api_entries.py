# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The public functions and classes outside ``transport``, by package and module."""

from __future__ import annotations

APPLICATIONS = {
    "morphs": {
        "morph": ("morph",),
        "morph_inputs": ("MorphInputs",),
        "computation": ("Computation",),
        "bake_plan": ("MorphPreview",),
        "morph_problem": ("MorphFrame",),
        "morph_settings": ("MorphSettings",),
        "layouts": ("Blend", "path_blends", "grid_blends", "triangle_blends", "single_blend"),
        "frame_cache": ("FrameCache",),
    },
    "motions": {
        "choosing": ("chosen_motion",),
        "motion_choice": ("MotionChoice",),
        "motion_request": ("MotionRequest",),
        "guided_motion": ("guided_motion", "GuidedMotion", "GuidedPair"),
        "guided_settings": ("GuidedSettings",),
        "warp_motion": ("warp_motion", "WarpMotion", "WarpEffort"),
        "combined_motion": ("combined_motion", "CombinedMotion"),
        "motion": ("Motion", "MovedShape"),
    },
    "registrations": {
        "carriers": ("carrier_of", "Carrier"),
        "mapped_pairs": ("mapped_pair",),
        "pair_merits": ("MappedPair",),
    },
    "outlines": {
        "outline_motion": ("outline_motion",),
        "moved_sheets": ("MovedSheets",),
    },
    "live": {
        "live_blends": ("LiveBlends",),
        "live_shapes": ("LiveShapes", "LiveShape"),
        "live_settings": ("LiveSettings",),
        "level_fields": ("LevelField", "MixedField", "FieldBox", "mixed"),
        "weight_layouts": ("path_weights", "square_weights", "checked_weights"),
    },
    "one_mesh": {
        "key_paths": ("key_paths", "KeyPath"),
    },
    "flat": {
        "flat_morph": ("flat_morph",),
        "flat_frames": ("FlatFrame",),
        "flat_settings": ("FlatSettings",),
        "flat_shapes": ("FlatShape", "FlatImage"),
    },
    "densities": {
        "surface_densities": ("density_surface", "distribution", "heat_map"),
        "density_settings": ("DensitySettings",),
        "density_paths": ("interpolation_steps", "path_steps", "blend_steps"),
        "density_graphs": ("propagation_steps",),
        "density_frames": ("DensityFrames",),
        "density_measures": ("measuring_steps", "distance_table_steps"),
        "vertex_distances": ("distances_from",),
        "density_tools": ("diffused", "sharpened", "sharpened_by", "unit_mass"),
    },
    "soft_maps": {
        "map_solving": ("soft_map_steps",),
        "map_sides": ("MapSide",),
        "soft_map_settings": ("SoftMapSettings",),
        "mirror_maps": ("mirror_map_steps",),
        "surface_maps": ("SurfaceMap", "PointMap"),
        "map_repair": ("repaired_map",),
        "transfer": ("transferred_values", "transferred_weights"),
    },
    "skeletons": {
        "skeleton_fit": ("fit_steps", "FittedSkeleton"),
        "skeleton_graph": ("JointGraph",),
        "skeleton_settings": ("SkeletonSettings",),
    },
    "palettes": {
        "recolor_job": ("recolor_steps", "map_steps", "Picture", "Recolored"),
        "palette_settings": ("RecolorSettings",),
        "palette_statistics": ("measured_palette", "pooled_palette"),
        "recoloring": ("recoloring", "palette_barycenter", "Recoloring"),
        "pixel_blocks": ("recolored_blocks",),
        "lookup_table": ("lookup_table", "write_cube", "read_cube"),
    },
    "reflectance": {
        "materials": ("Ggx", "BlinnPhong", "AshikhminShirley"),
        "merl": ("read_merl",),
        "lobe_table": ("LobeTable", "incoming_directions", "tabulated"),
        "lobe_interpolation": ("LobeBlend", "InterpolatedLobes"),
        "lobe_frames": ("lobe_frames", "LobeFrame", "path_weights"),
        "reflectance_settings": ("ReflectanceSettings",),
        "ggx_fit": ("fit_ggx",),
        "table_files": ("write_table", "read_table"),
    },
    "skies": {
        "sky_frames": ("Skies", "SkyFrame"),
        "sky_settings": ("SkySettings",),
    },
}
"""In ``convwass_addon.applications``; arrays in, arrays out, no Blender."""

BRIDGE = {
    "files.imports": ("import_objects",),
    "objects": ("triangle_mesh", "write_mesh"),
    "surfaces": ("read_surface",),
    "morphs.disk.exports": ("export_frames",),
    "vertex_groups": ("read_group", "write_group", "as_weights"),
    "files.image_files": ("opened_image",),
    "palettes.image_files": ("save_pixels",),
    "palettes.image_pixels": ("read_picture",),
}
"""In ``convwass_addon.bridge``; between Blender's data and arrays."""
