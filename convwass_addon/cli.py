# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``blender --command convwass VERB …`` and ``python -m convwass_addon VERB …``."""

from __future__ import annotations

import json
import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Sequence
from pathlib import Path

import bpy

from .applications.layouts import Blend, grid_blends, path_blends, single_blend, triangle_blends
from .applications.morph_settings import MorphSettings
from .bridge.animation import render_animation
from .bridge.contact_sheet import render_contact_sheet
from .bridge.exports import FORMATS, export_frames
from .bridge.files import checked_target, save_blend
from .bridge.imports import import_objects, parse_source
from .bridge.job import MorphJob
from .console import ProgressBar, own_stdout
from .errors import Cancelled, ConvwassError, InputError, ResourceError

EXIT_CODES = """exit codes:
  0  done                            3  the shapes or settings cannot be used (the message says what to do)
  1  a failure while working         4  the job needs more memory than there is
  2  the command line is wrong     130  interrupted
"""

_MORPH_HELP = """Morph shapes of any topology into each other by optimal transport and save the result as a .blend.

A shape is a file that Blender reads (OBJ, PLY, STL, glTF, FBX, USD, Alembic), or an object in a .blend, written
file.blend:Object. It may be open, in several parts, self-intersecting or inside out.

examples:
  morph cow.obj duck.ply torus.stl --frames 24 --resolution 100 --out morph.blend --render
  morph scene.blend:Cube scene.blend:Suzanne --frames 48
  morph a.obj b.obj c.obj d.obj --layout grid --steps 5 --out sheet.blend --render
  morph a.obj b.obj c.obj --weights 0.2,0.3,0.5 --export blend.ply

"""

# Colors of shapes that bring no material.
_PALETTE = ((0.55, 0.09, 0.035, 1.0), (0.72, 0.30, 0.02, 1.0), (0.02, 0.13, 0.40, 1.0), (0.08, 0.24, 0.06, 1.0))
_DEMO_SHAPES = ("horse", "double_torus", "bird")


def main(arguments: Sequence[str], program: str = "blender --command convwass") -> int:
    """Run one verb.

    Parameters
    ----------
    arguments : sequence of str
        The words after the program.
    program : str
        How the user called it, for the help text.

    Returns
    -------
    int
        The exit code; see the help text.
    """
    try:
        options = _parser(program).parse_args(list(arguments))
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        with own_stdout() as answer:
            result = options.run(options)
            if options.json:
                print(json.dumps(result, indent=2), file=answer)
            else:
                print("\n".join(result["written"]), file=answer)
    except Cancelled as stop:
        print(f"convwass: {stop}", file=sys.stderr)
        return 130
    except ConvwassError as error:
        print(f"convwass: {error}", file=sys.stderr)
        return 4 if isinstance(error, ResourceError) else 3 if isinstance(error, InputError) else 1
    except KeyboardInterrupt:
        print("convwass: interrupted; nothing was saved", file=sys.stderr)
        return 130
    return 0


def _parser(program: str) -> ArgumentParser:
    parser = ArgumentParser(program, description="Convolutional Wasserstein distances for Blender.")
    verbs = parser.add_subparsers(metavar="VERB", required=True)
    common = {"formatter_class": RawDescriptionHelpFormatter, "epilog": EXIT_CODES}
    morph = verbs.add_parser("morph", help="morph shapes into each other", description=_MORPH_HELP, **common)
    morph.add_argument("shapes", nargs="+", metavar="SHAPE", help="a file, or file.blend:Object; two or more, in order")
    morph.add_argument("--out", type=Path, default=Path("morph.blend"), help="the .blend to write (%(default)s)")
    _add_layout_options(morph)
    _add_solver_options(morph)
    _add_output_options(morph)
    morph.set_defaults(run=_morph)
    demo = verbs.add_parser(
        "demo",
        help="morph the project's sample shapes",
        description="Morph three sample shapes; write morph.blend, a picture and an animation.",
        **common,
    )
    demo.add_argument("--out", type=Path, default=Path("out"), help="the folder to write to (%(default)s)")
    demo.add_argument("--frames", type=int, default=24, help="frames from each shape to the next (%(default)s)")
    demo.add_argument("--resolution", type=int, default=96, help="cells along the longest side (%(default)s)")
    _add_workers(demo)
    demo.add_argument("--json", action="store_true", help="print the records of the solver as JSON")
    demo.set_defaults(run=_demo)
    return parser


def _add_layout_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what is made")
    layouts = ("path", "grid", "triangle")
    group.add_argument(
        "--layout",
        choices=layouts,
        default="path",
        help="path: an animation through the shapes in order (default); grid: a sheet between four shapes; triangle: a "
        "sheet between three",
    )
    group.add_argument("--frames", type=int, default=24, help="path: frames from each shape to the next (%(default)s)")
    group.add_argument("--steps", type=int, default=5, help="grid, triangle: blends along each side (%(default)s)")
    group.add_argument("--weights", type=_numbers, help="one blend instead, such as 0.2,0.3,0.5: one number per shape")


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("how it is made")
    group.add_argument(
        "--resolution", type=int, default=100, help="cells along the longest side of the volume (%(default)s)"
    )
    group.add_argument(
        "--sharpness",
        type=float,
        help="0: the barycenter of the paper, smooth; 1: debiased, crisp, may tear (0.75, rising to 1 at the shapes)",
    )
    group.add_argument("--blur", type=float, help="blur in cells (1, or an eightieth of the resolution)")
    group.add_argument(
        "--entropy-limit",
        type=_entropy_limit,
        metavar="max|NUMBER|off",
        help="keep blends from spreading more than the shapes (max) or than a number of nats (off)",
    )
    group.add_argument(
        "--level",
        choices=("volume", "half-max"),
        default="volume",
        help="take the surface where it encloses the interpolated volume (default), or at half of the maximum",
    )
    group.add_argument(
        "--thickness", type=float, default=0.0, help="thickness for shapes without volume, such as planes (none)"
    )
    group.add_argument(
        "--tolerance", type=float, default=0.01, help="marginal error at which a blend is done (%(default)s)"
    )
    _add_workers(parser)


def _add_workers(parser: ArgumentParser) -> None:
    parser.add_argument("--workers", type=int, metavar="N", help="threads that compute frames (one per processor)")


def _add_output_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what is written besides")
    group.add_argument(
        "--render",
        action="store_true",
        help="also render a picture of the sequence and, for a path, an animation, beside the .blend",
    )
    group.add_argument(
        "--export",
        type=Path,
        metavar="FILE",
        help="also write the meshes for other programs; the ending says how: " + ", ".join(_suffixes()),
    )
    group.add_argument("--json", action="store_true", help="print the records of the solver as JSON")


def _morph(options: Namespace) -> dict[str, object]:
    settings = MorphSettings(
        resolution=options.resolution,
        blur=options.blur,
        sharpness=options.sharpness,
        entropy_limit=options.entropy_limit,
        level=options.level,
        thickness=options.thickness,
        tolerance=options.tolerance,
    )
    blends = _blends(options, len(options.shapes))
    # Everything that can be refused is refused before the work begins.
    target = checked_target(options.out.with_suffix(".blend"))
    export_format = _export_format(options.export) if options.export else None
    bpy.ops.wm.read_factory_settings(use_empty=True)
    inputs = []
    for text in options.shapes:
        source = parse_source(text)
        inputs += import_objects(source.path, [source.object_name] if source.object_name else None)
    stored = {"layout": options.layout.upper(), "frames": options.frames, "steps": options.steps}
    collection, records = _baked(inputs, blends, settings, stored, options.workers)
    save_blend(target)
    written = [target]
    if options.render:
        written += _rendered(collection, target, animated=blends[0].frame is not None)
    if export_format:
        written += export_frames(collection, options.export, export_format)
    return _report(collection, settings, records, written)


def _demo(options: Namespace) -> dict[str, object]:
    folder = Path(__file__).resolve().parent.parent / "assets" / "shapes"
    if not folder.is_dir():
        raise InputError("The sample shapes are part of the project's source, not of the installed add-on.")
    blends = path_blends(len(_DEMO_SHAPES), options.frames)
    settings = MorphSettings(resolution=options.resolution)
    options.out.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    inputs = [obj for name in _DEMO_SHAPES for obj in import_objects(folder / f"{name}.ply", None)]
    for obj in inputs:
        obj.data.shade_smooth()
    stored = {"layout": "PATH", "frames": options.frames}
    collection, records = _baked(inputs, blends, settings, stored, options.workers)
    target = save_blend(options.out / "morph.blend")
    sheet, movie = _rendered(collection, target, animated=True)
    print(
        f"\nThe morph     {target}\n              open it in Blender and press Space to play it"
        f"\nIts pictures  {sheet}\nIts movie     {movie}",
        file=sys.stderr,
    )
    return _report(collection, settings, records, [target, sheet, movie])


def _baked(
    inputs: list[bpy.types.Object],
    blends: list[Blend],
    settings: MorphSettings,
    stored: dict[str, object],
    workers: int | None,
) -> tuple[bpy.types.Collection, list[dict[str, object]]]:
    for index, obj in enumerate(inputs):
        if not any(obj.data.materials):
            obj.color = _PALETTE[index % len(_PALETTE)]
    scene = bpy.context.scene
    job = MorphJob(scene, bpy.context.evaluated_depsgraph_get(), inputs, blends, settings, stored, scene.frame_start)
    with ProgressBar("Morphing") as bar:
        try:
            for step in job.steps(workers=workers):
                job.write(step)
                bar.show(step.fraction, step.message)
        except BaseException:
            job.discard()
            raise
    slack = sum(not record.get("converged", True) for record in job.records)
    if slack:
        print(f"convwass: {slack} blends are less exact than asked for; more --blur helps", file=sys.stderr)
    return job.finish(hide_inputs=True), job.records


def _rendered(collection: bpy.types.Collection, target: Path, animated: bool) -> list[Path]:
    with ProgressBar("Rendering the picture") as bar:
        pictures = [render_contact_sheet(collection, target.with_suffix(".png"), progress=bar.show)]
    if animated:
        with ProgressBar("Rendering the movie") as bar:
            pictures.append(render_animation(collection, target.with_suffix(".mp4"), progress=bar.show))
    return [Path(picture) for picture in pictures]


def _report(
    collection: bpy.types.Collection, settings: MorphSettings, records: list[dict[str, object]], written: list[Path]
) -> dict[str, object]:
    return {
        "morph": collection.name,
        "settings": settings.as_dict(),
        "frames": records,
        "written": [str(path) for path in written],
    }


def _blends(options: Namespace, count: int) -> list[Blend]:
    if count < 2:
        raise InputError("A morph needs at least two shapes; name one more.")
    if options.weights is not None:
        return single_blend(options.weights, count)
    makers: dict[str, Callable[[], list[Blend]]] = {
        "path": lambda: path_blends(count, options.frames),
        "grid": lambda: grid_blends(count, options.steps),
        "triangle": lambda: triangle_blends(count, options.steps),
    }
    return makers[options.layout]()


def _export_format(path: Path) -> str:
    checked_target(path)
    if path.suffix.lower() not in _suffixes():
        raise InputError(f"--export {path}: the ending must be one of {', '.join(_suffixes())}.")
    return _suffixes()[path.suffix.lower()]


def _suffixes() -> dict[str, str]:
    return {suffix: name for name, form in FORMATS.items() for suffix in form.suffixes}


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not a list of numbers such as 0.2,0.3,0.5") from None


def _entropy_limit(text: str) -> str | float | None:
    if text in ("max", "off"):
        return "max" if text == "max" else None
    try:
        return float(text)
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not max, off or a number") from None


_commands: list[object] = []


def register() -> None:
    """Add the verbs to ``blender --command convwass``."""
    _commands.append(bpy.utils.register_cli_command("convwass", main))


def unregister() -> None:
    """Take the verbs away."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
