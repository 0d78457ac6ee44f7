# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``blender --command convwass VERB …`` and ``python -m convwass_addon VERB …``."""

from __future__ import annotations

import json
import re
import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import bpy

from .applications.between_frames import places_at
from .applications.cluster import cluster_workers
from .applications.frame_cache import FrameCache
from .applications.layouts import Blend, grid_blends, path_blends, single_blend, triangle_blends
from .applications.morph import MorphStep
from .applications.morph_settings import MorphSettings
from .bridge.animation import render_animation
from .bridge.contact_sheet import render_contact_sheet
from .bridge.exports import FORMATS, export_frames
from .bridge.files import checked_target, save_blend
from .bridge.imports import import_objects, parse_source
from .bridge.job import MorphJob
from .bridge.outputs import ON_DISK, PACKED, save_as
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
  morph a.obj b.obj --frames 240 --cache /shared/frames --frames-range 0-119
  morph a.obj b.obj --frames 240 --cache /shared/frames --scheduler tcp://192.168.1.10:8786
  morph a.obj b.obj --frames 24 --cache frames --at 7.35,8.5 --out between.blend

"""

# Colors of shapes that bring no material.
_PALETTE = ((0.55, 0.09, 0.035, 1.0), (0.72, 0.30, 0.02, 1.0), (0.02, 0.13, 0.40, 1.0), (0.08, 0.24, 0.06, 1.0))
_WORKERS = {"type": int, "metavar": "N", "help": "threads that compute frames (one per processor)"}
_DEMO_SHAPES = ("horse", "double_torus", "bird")


@dataclass(frozen=True)
class _Between:
    """Frame numbers such as 7.35, and the path that they are on."""

    path: list[Blend]
    numbers: list[float]


@dataclass(frozen=True)
class _Computing:
    """Where frames are computed, where they are kept, and which of them are wanted (all), or which between them."""

    workers: int | None = None
    scheduler: str | None = None
    cache: FrameCache | None = None
    wanted: range | None = None
    between: _Between | None = None


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
        kept = getattr(options, "cache", None)
        left = f"finished frames are kept in {kept}" if kept else "nothing was saved"
        print(f"convwass: interrupted; {left}", file=sys.stderr)
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
    _add_computing_options(morph)
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
    demo.add_argument("--workers", **_WORKERS)
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
    group.add_argument(
        "--align",
        choices=("placed", "centered", "principal-axes"),
        default="placed",
        help="lay the shapes onto the first one: center on center, or also long side on long side (%(default)s)",
    )
    group.add_argument(
        "--scale",
        choices=("placed", "equal-volume"),
        default="placed",
        help="leave the sizes of the shapes, or give all the volume of the first one (%(default)s)",
    )
    group.add_argument("--weights", type=_numbers, help="one blend instead, such as 0.2,0.3,0.5: one number per shape")
    group.add_argument(
        "--at",
        type=_numbers,
        metavar="NUMBERS",
        help="path: a sheet of the blends at these frame numbers instead, such as 7.35,8.5; they start from the frames "
        "about them in --cache, where those that are missing are put first",
    )


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
        "--locality",
        type=float,
        default=0.0,
        help="0: all mass travels; up to 1: parts shrink here and grow there instead of going far (%(default)s)",
    )
    group.add_argument(
        "--no-thin-parts",
        action="store_true",
        help="take one level for thick and thin parts; thin ones get thinner or vanish",
    )
    group.add_argument(
        "--no-mend", action="store_true", help="leave crumbs, gaps and handles that the shapes do not have as they come"
    )
    group.add_argument(
        "--no-carry",
        action="store_true",
        help="leave out the colors of the shapes, their vertex groups and the velocity, which blends carry along",
    )
    group.add_argument(
        "--parts",
        choices=("none", "vertex-groups", "materials"),
        default="none",
        help="parts of the same name on all shapes travel together: head to head (%(default)s)",
    )
    group.add_argument(
        "--tolerance",
        type=float,
        help="marginal error at which a blend is done (automatic: 0.01, down to 0.002 with a sharpness of 1)",
    )


def _add_computing_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("where it is computed")
    group.add_argument("--workers", **_WORKERS)
    group.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="compute frames on the workers of a Dask cluster instead, such as tcp://HOST:8786",
    )
    group.add_argument(
        "--cache",
        type=Path,
        metavar="FOLDER",
        help="keep finished frames there, and compute only those that are missing; several machines may share it",
    )
    group.add_argument(
        "--frames-range",
        type=_frame_range,
        metavar="A-B",
        help="path: only put these frames into the cache and write no .blend; the first shape is frame 0",
    )


def _add_output_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what is written")
    group.add_argument(
        "--output",
        choices=[*PACKED, *ON_DISK],
        default="objects",
        help="what shows the morph in the .blend: an object per frame, one player object, a pad to drag on (a sheet), "
        "or files beside it that are read as VDB volumes, Alembic or USD (%(default)s)",
    )
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
        locality=options.locality,
        thin_parts=not options.no_thin_parts,
        mend=not options.no_mend,
        parts=options.parts,
        tolerance=options.tolerance,
        carry=not options.no_carry,
    )
    blends = _blends(options, len(options.shapes))
    between = None
    if options.at is not None:
        between = _between(options, blends)
        blends = [place.blend for place in places_at(between.path, between.numbers)]
    # Everything that can be refused is refused before the work begins.
    target = options.out.with_suffix(".blend")
    if options.frames_range is None:
        target = checked_target(target)
    export_format = _export_format(options.export) if options.export else None
    computing = _computing(options, blends, between)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    inputs = []
    for text in options.shapes:
        source = parse_source(text)
        inputs += import_objects(source.path, [source.object_name] if source.object_name else None)
    stored = {"layout": options.layout.upper(), "frames": options.frames, "steps": options.steps}
    stored["alignment"], stored["scaling"] = (_as_enum(choice) for choice in (options.align, options.scale))
    if between is not None:
        stored["at"] = between.numbers
    if computing.wanted is not None:
        return _cached(inputs, blends, settings, stored, computing)
    collection, records = _baked(inputs, blends, settings, stored, computing)
    besides = _rendered(collection, target, animated=blends[0].frame is not None) if options.render else []
    if export_format:
        besides += export_frames(collection, options.export, export_format)
    written = save_as(collection, options.output, target) + besides
    return _report(collection, settings, records, written)


def _as_enum(choice: str) -> str:
    return choice.replace("-", "_").upper()


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
    collection, records = _baked(inputs, blends, settings, stored, _Computing(options.workers))
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
    computing: _Computing,
) -> tuple[bpy.types.Collection, list[dict[str, object]]]:
    job = _job(inputs, blends, settings, stored)
    try:
        _run(job, computing, job.write)
    except BaseException:
        job.discard()
        raise
    slack = sum(not record.get("converged", True) for record in job.records)
    if slack:
        print(f"convwass: {slack} blends are less exact than asked for; more --blur helps", file=sys.stderr)
    for notice in job.notices:
        print(f"convwass: {notice}", file=sys.stderr)
    return job.finish(hide_inputs=True), job.records


def _cached(
    inputs: list[bpy.types.Object],
    blends: list[Blend],
    settings: MorphSettings,
    stored: dict[str, object],
    computing: _Computing,
) -> dict[str, object]:
    """Put some frames into the cache and nothing into the scene."""
    job = _job(inputs, blends, settings, stored)
    frames, records = [], []

    def note(step: MorphStep) -> None:
        if step.frame is not None:
            frames.append(step.frame.blend.frame)
            records.append(step.frame.record)

    try:
        _run(job, computing, note)
    finally:
        job.discard()
    folder = computing.cache.folder
    print(
        f"convwass: frames {frames[0]}-{frames[-1]} of {blends[-1].frame} are in {folder}; the same command without "
        "--frames-range makes the .blend once all are",
        file=sys.stderr,
    )
    return {
        "settings": settings.as_dict(),
        "range": [frames[0], frames[-1]],
        "frames": records,
        "written": [str(folder)],
    }


def _job(
    inputs: list[bpy.types.Object], blends: list[Blend], settings: MorphSettings, stored: dict[str, object]
) -> MorphJob:
    for index, obj in enumerate(inputs):
        if not any(obj.data.materials):
            obj.color = _PALETTE[index % len(_PALETTE)]
    scene = bpy.context.scene
    return MorphJob(scene, bpy.context.evaluated_depsgraph_get(), inputs, blends, settings, stored, scene.frame_start)


def _run(job: MorphJob, computing: _Computing, take: Callable[[MorphStep], None]) -> None:
    """Do all steps of a job, wherever its frames are computed, and hand them on."""
    cluster = cluster_workers(computing.scheduler) if computing.scheduler else nullcontext()
    with cluster as executor, ProgressBar("Morphing") as bar:
        where = {"workers": computing.workers, "executor": executor}
        if computing.between is None:
            steps = job.steps(cache=computing.cache, wanted=computing.wanted, **where)
        else:
            steps = job.steps_between(computing.between.path, computing.between.numbers, computing.cache, **where)
        for step in steps:
            take(step)
            bar.show(step.fraction, step.message)
    for notice in computing.cache.notices if computing.cache else ():
        print(f"convwass: {notice}", file=sys.stderr)


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


def _between(options: Namespace, path: list[Blend]) -> _Between:
    if options.weights is not None or options.layout != "path":
        raise InputError("--at is for a path; leave out --weights and --layout.")
    if options.frames_range is not None:
        raise InputError("--at makes blends and --frames-range only fills the cache; choose one of them.")
    if options.cache is None:
        raise InputError("--at needs --cache FOLDER, which holds the frames that it starts from.")
    return _Between(path, options.at)


def _computing(options: Namespace, blends: list[Blend], between: _Between | None) -> _Computing:
    wanted = options.frames_range
    if options.workers is not None and options.scheduler:
        raise InputError("--workers are threads of this machine and --scheduler means others; choose one of them.")
    if wanted is not None:
        last = blends[-1].frame
        if last is None:
            raise InputError("--frames-range is for a path; sheets and single blends have no frames.")
        if wanted[-1] > last:
            raise InputError(f"--frames-range {wanted[0]}-{wanted[-1]}: the path has the frames 0-{last}.")
        if options.cache is None:
            raise InputError("--frames-range needs --cache FOLDER, which is all that it writes to.")
        if options.render or options.export:
            raise InputError("--frames-range writes no scene; leave --render and --export to the run without it.")
    cache = FrameCache(options.cache) if options.cache is not None else None
    return _Computing(options.workers, options.scheduler, cache, wanted, between)


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


def _frame_range(text: str) -> range:
    found = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text, re.ASCII)
    first, last = (int(number) for number in (found[1], found[2] or found[1])) if found else (1, 0)
    if first > last:
        raise ArgumentTypeError(f"{text!r} is not a range of frames such as 0-23, or a frame such as 7")
    return range(first, last + 1)


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
