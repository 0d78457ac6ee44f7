# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings declared once appear in every layer."""

from __future__ import annotations

import re
from argparse import ArgumentParser, HelpFormatter
from dataclasses import dataclass, fields
from functools import partial

import bpy
import pytest

from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.palettes.palette_settings import RecolorSettings, TableSettings
from convwass_addon.applications.reflectance.reflectance_settings import ReflectanceSettings
from convwass_addon.applications.skeletons.skeleton_settings import SkeletonSettings
from convwass_addon.applications.skies.sky_settings import SkySettings
from convwass_addon.applications.soft_maps.soft_map_settings import SoftMapSettings
from convwass_addon.bridge.armatures.fit_request import FitRequest
from convwass_addon.bridge.densities.density_request import DensityRequest
from convwass_addon.bridge.morphs.morph_request import MorphRequest
from convwass_addon.bridge.soft_maps.soft_map_requests import MapRequest, TransferRequest
from convwass_addon.cli.from_schema import add_setting_options, given_settings
from convwass_addon.cli.program import COMMANDS
from convwass_addon.errors import InputError
from convwass_addon.panels.from_schema import draw_settings
from convwass_addon.properties.from_schema import arguments_of, values_of, with_properties
from convwass_addon.schema import Choice, Companion, Settings, setting, settings_of
from tools.docstrings import described

from .panels.fake_layout import FakeLayout


@dataclass(frozen=True)
class BrushSettings(Settings):
    """How a brush paints."""

    softness: float = setting(0.5, "Softness", "How soft the edge is", least=0.0, most=1.0, panel="brush")


@dataclass(frozen=True)
class RichSettings(Settings):
    """One setting of every kind.

    Attributes
    ----------
    inputs : tuple of str
        Not a setting.
    """

    inputs: tuple[str, ...] = ()
    count: int = setting(3, "Count", "How many", least=1, most=9, unit="strokes")
    mend: bool = setting(True, "Mend", "Close gaps")
    trail: bool = setting(False, "Trail", "Leave a trail")
    kind: str = setting(
        "near-by",
        "Kind",
        "Which one",
        choices=(Choice("near-by", "Near", "The nearest"), Choice("far", "Far", "Others")),
    )
    pieces: str = setting(
        "keep",
        "Pieces",
        "What to do",
        choices=(Choice("keep", "Keep", "Leave them", identifier="keep"), Choice("match", "Match", "Make them alike")),
        option="--match-pieces",
        flag="match",
    )
    blur: float | None = setting(
        None,
        "Blur",
        "How blurred",
        least=0.5,
        most=20.0,
        switch=Companion("use_custom_blur", "Set Blur", "Set it by hand", start=1.5),
        automatic="what suits",
    )
    limit: str | float | None = setting(
        None,
        "Limit",
        "What bounds it",
        choices=(Choice(None, "Off", "Nothing"), Choice("max", "Max", "The largest"), Choice(float, "Own", "A number")),
        number=Companion("bound", "Bound", "In nats", start=-2.0),
    )
    width: float | None = setting(
        None,
        "Width",
        "How wide; 0 for automatic",
        help="How wide",
        least=0.0,
        open_ends=True,
        soft_most=1.0,
        zero_is_automatic=True,
        automatic="what suits",
    )
    angle: float = setting(90.0, "Angle", "How far around", least=0.0, most=180.0, subtype="ANGLE")
    share: float = setting(0.5, "Share", "How much", least=1e-5, most=0.99)
    tolerance: float = setting(
        0.01, "Tolerance", "When it is done", least=0.0, most=1.0, open_ends=True, soft_least=1e-6, soft_most=0.5
    )
    reach: int = setting(1, "Far End", "How far it goes", least=1)
    hidden: int = setting(1, "Hidden", "For scripts only", least=0, prop=None, option=None)


@pytest.fixture
def group():
    """Register a property group of settings on scenes; return the group of the current scene."""
    made = []

    def registered(kind):
        own = with_properties(kind)(type("Mixin", (), {"__doc__": "Settings."}))
        cls = type("CONVWASS_PG_test", (own, bpy.types.PropertyGroup), {})
        bpy.utils.register_class(cls)
        bpy.types.Scene.convwass_test = bpy.props.PointerProperty(type=cls)
        made.append(cls)
        return bpy.context.scene.convwass_test

    yield registered
    for cls in made:
        del bpy.types.Scene.convwass_test
        bpy.utils.unregister_class(cls)


def parsed(kind, *words):
    parser = ArgumentParser()
    add_setting_options(parser, kind)
    return given_settings(parser.parse_args(words), kind)


def help_of(kind):
    parser = ArgumentParser()
    add_setting_options(parser, kind)
    return " ".join(parser.format_help().split())


def test_a_setting_of_one_line_is_in_every_layer(group):
    own = group(BrushSettings)
    prop = own.bl_rna.properties["softness"]
    assert (prop.name, prop.description) == ("Softness", "How soft the edge is")
    assert (prop.default, prop.hard_min, prop.hard_max) == (0.5, 0.0, 1.0)
    layout = FakeLayout()
    draw_settings(layout, own, BrushSettings, "brush")
    assert ("prop", "softness") in layout.drawn
    own.softness = 0.25
    assert BrushSettings(**values_of(own, BrushSettings)) == BrushSettings(0.25)

    assert parsed(BrushSettings, "--softness", "0.75") == {"softness": 0.75}
    assert "--softness X how soft the edge is; 0 to 1 (0.5)" in help_of(BrushSettings)

    assert BrushSettings(0.75).as_dict() == {"softness": 0.75}
    assert arguments_of({"softness": 0.75}, BrushSettings) == {"softness": 0.75}

    assert "- `softness` (float, 0 to 1): How soft the edge is." in described("BrushSettings", BrushSettings)
    with pytest.raises(InputError, match="Softness must lie between 0 and 1, not 2"):
        BrushSettings(softness=2.0)


def nearly(asked):
    """The values of settings in Blender's single precision."""
    return {
        name: pytest.approx(value, rel=1e-6) if isinstance(value, float) else value
        for name, value in asked.as_dict().items()
    }


def test_properties_have_the_values_of_the_settings(group):
    own = group(RichSettings)
    assert RichSettings(**values_of(own, RichSettings)).as_dict() == nearly(RichSettings())
    asked = RichSettings(
        (), 7, False, True, "far", "match", blur=2.5, limit=-1.5, width=0.25, angle=45.0, tolerance=0.125
    )
    for name, value in arguments_of(asked.as_dict(), RichSettings).items():
        setattr(own, name, value)
    assert RichSettings(**values_of(own, RichSettings)).as_dict() == nearly(asked)
    assert (own.kind, own.pieces, own.limit, own.bound, own.use_custom_blur) == ("FAR", "MATCH", "NUMBER", -1.5, True)
    assert not hasattr(own, "hidden")
    properties = own.bl_rna.properties
    assert (properties["width"].hard_min, properties["width"].soft_max, properties["width"].default) == (0.0, 1.0, 0.0)
    assert properties["width"].hard_max > 1e9
    assert properties["tolerance"].hard_min == pytest.approx(1e-6)
    assert properties["angle"].hard_max == pytest.approx(3.14159265)
    assert own.bl_rna.properties["blur"].default == 1.5


def test_rounded_ends_of_a_range_are_valid(group):
    own = group(RichSettings)
    own.angle, own.share = 10.0, 0.0
    assert own.bl_rna.properties["share"].hard_min < 1e-5
    found = RichSettings(**values_of(own, RichSettings))
    assert (found.angle, found.share) == (180.0, 1e-5)
    own.share = 1.0
    assert own.share > 0.99
    assert RichSettings(**values_of(own, RichSettings)).share == 0.99


def test_settings_missing_from_storage_leave_the_property_unchanged(group):
    own = group(RichSettings)
    own.count = 5
    for name, value in arguments_of({"mend": False, "limit": "max", "unheard": 1}, RichSettings).items():
        setattr(own, name, value)
    assert (own.count, own.mend, own.limit) == (5, False, "MAX")
    assert arguments_of({"kind": "FAR"}, RichSettings) == {"kind": "FAR"}
    with pytest.raises(ValueError, match="kind is 'else'"):
        arguments_of({"kind": "else"}, RichSettings)


@pytest.mark.parametrize(
    ("words", "given"),
    [
        ([], {}),
        (["--count", "4"], {"count": 4}),
        (["--no-mend"], {"mend": False}),
        (["--mend", "--trail"], {"mend": True, "trail": True}),
        (["--kind", "near-by"], {"kind": "near-by"}),
        (["--match-pieces"], {"pieces": "match"}),
        (["--blur", "3"], {"blur": 3.0}),
        (["--limit", "off"], {"limit": None}),
        (["--limit", "max"], {"limit": "max"}),
        (["--limit", "-2.5"], {"limit": -2.5}),
    ],
)
def test_options_give_only_the_values_passed(words, given):
    assert parsed(RichSettings, *words) == given


@pytest.mark.parametrize("words", [["--kind", "else"], ["--limit", "NUMBER"], ["--count", "1.5"], ["--hidden", "1"]])
def test_invalid_options_are_refused(words, capsys):
    with pytest.raises(SystemExit):
        parsed(RichSettings, *words)
    assert "error:" in capsys.readouterr().err


def test_help_states_the_defaults():
    text = help_of(RichSettings)
    assert "--mend, --no-mend close gaps (on)" in text
    assert "--blur X how blurred; 0.5 to 20 (what suits)" in text
    assert "--width X how wide; more than 0 (what suits)" in text
    assert "--angle X how far around; 0 to 180 (90)" in text
    assert "--kind {near-by,far} which one; near-by: the nearest; far: others (near-by)" in text
    assert "--limit off|max|NUMBER what bounds it; off: nothing; max: the largest; NUMBER: a number (off)" in text


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"count": 0}, "Count must lie between 1 and 9, not 0."),
        ({"count": 2.5}, "Count must be a whole number, not 2.5."),
        ({"count": "2"}, "Count must be a number, not '2'."),
        ({"mend": "yes"}, "Mend must be on or off, not 'yes'."),
        ({"kind": "else"}, 'Kind must be one of "near-by", "far", not \'else\'.'),
        ({"kind": 1.0}, 'Kind must be one of "near-by", "far", not 1.0.'),
        ({"blur": float("nan")}, "Blur must be a number, not nan."),
        ({"limit": float("inf")}, 'Limit must be one of None, "max", a number, not inf.'),
        ({"angle": None}, "Angle must be a number, not None."),
        ({"tolerance": 0.0}, "Tolerance must be more than 0 and less than 1, not 0."),
        ({"width": 0.0}, "Width must be more than 0, not 0."),
        ({"reach": 0}, "Far End (reach) must be 1 or more, not 0."),
        ({"hidden": -1}, "Hidden must be 0 or more, not -1."),
    ],
)
def test_values_out_of_range_are_refused_with_the_label(wrong, message):
    with pytest.raises(InputError) as caught:
        RichSettings(**wrong)
    assert str(caught.value) == message


def test_the_docstring_lists_the_declared_settings():
    @dataclass(frozen=True)
    class Finer(RichSettings):
        """As the others, with more strokes."""

        count: int = setting(5, "Count", "How many", least=1, most=90)

    assert (
        "inputs : tuple of str\n    Not a setting.\ncount : int, 1 to 9 strokes\n    How many." in RichSettings.__doc__
    )
    assert "blur : float or None, 0.5 to 20\n    How blurred. None is what suits." in RichSettings.__doc__
    assert 'kind : "near-by" or "far"\n    Which one. "near-by": The nearest. "far": Others.' in RichSettings.__doc__
    assert Finer.__doc__.endswith("Attributes\n----------\ncount : int, 1 to 90\n    How many.\n")
    assert [one.name for one in settings_of(Finer)] == [one.name for one in fields(Finer) if one.name != "inputs"]


OWNERS = [
    (MorphSettings, bpy.types.Scene, "convwass_morph", "morph"),
    (FlatSettings, bpy.types.Scene, "convwass_morph", "morph"),
    (MorphRequest, bpy.types.Scene, "convwass_morph", "morph"),
    (DensitySettings, bpy.types.Object, "convwass_density", "density"),
    (DensityRequest, bpy.types.Object, "convwass_density", "density"),
    (SoftMapSettings, bpy.types.Scene, "convwass_soft_map", "softmap"),
    (MapRequest, bpy.types.Scene, "convwass_soft_map", "softmap"),
    (TransferRequest, bpy.types.Scene, "convwass_soft_map", "softmap"),
    (SkeletonSettings, bpy.types.Scene, "convwass_armature", "armature"),
    (FitRequest, bpy.types.Scene, "convwass_armature", "armature"),
    (RecolorSettings, bpy.types.Scene, "convwass_recolor", "recolor"),
    (TableSettings, bpy.types.Scene, "convwass_recolor", "recolor"),
    (ReflectanceSettings, bpy.types.Scene, "convwass_reflectance", "reflect"),
    (SkySettings, bpy.types.Scene, "convwass_sky", "sky"),
]


@pytest.mark.usefixtures("empty_scene")
@pytest.mark.parametrize(
    ("kind", "owner", "group", "command"), OWNERS, ids=lambda value: getattr(value, "__name__", value)
)
def test_every_setting_is_in_its_group_and_among_the_options_of_its_command(kind, owner, group, command):
    held = owner.bl_rna.properties[group].fixed_type.properties
    parser = ArgumentParser(add_help=False)
    next(one for one in COMMANDS if one.name == command).add_options(parser)
    options = set(re.findall(r"--[a-z][\w-]*", parser.format_help()))
    settings = list(settings_of(kind))
    assert settings
    for one in settings:
        assert all(name in held for name in one.properties), one.name
        assert one.option is None or one.option in options, one.name
    assert set(arguments_of(kind().as_dict(), kind)) <= {name for one in settings for name in one.properties}


def option_help(command, option):
    wide = partial(HelpFormatter, max_help_position=100, width=10_000)
    parser = ArgumentParser(add_help=False, formatter_class=wide)
    next(one for one in COMMANDS if one.name == command).add_options(parser)
    return next(line for line in parser.format_help().splitlines() if line.lstrip().startswith(option))


def test_the_documented_tolerance_is_the_one_used():
    told = f"{MorphSettings().stopping_error:g}, and less for the debiasing density"
    assert told in MorphSettings.__doc__
    assert told in option_help("morph", "--tolerance")


@pytest.mark.usefixtures("empty_scene")
@pytest.mark.parametrize(("kind", "name"), [(MorphSettings, "resolution"), (FlatSettings, "flat_resolution")])
def test_the_resolution_is_the_same_everywhere(kind, name):
    least, usual, most = 8, kind().resolution, 1024
    for properties in (
        bpy.types.Scene.bl_rna.properties["convwass_morph"].fixed_type.properties,
        bpy.ops.convwass.bake_morph.get_rna_type().properties,
    ):
        assert (properties[name].hard_min, properties[name].default, properties[name].hard_max) == (least, usual, most)
    assert f"({usual})" in option_help("morph", "--resolution")
    assert kind(resolution=least).resolution == least and kind(resolution=most).resolution == most
    for wrong in (least - 1, most + 1):
        with pytest.raises(InputError, match="Resolution must lie between 8 and 1024"):
            kind(resolution=wrong)
