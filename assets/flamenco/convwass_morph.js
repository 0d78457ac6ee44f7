// SPDX-FileCopyrightText: 2026 Convwass authors
// SPDX-License-Identifier: CC0-1.0
//
// A job type for Flamenco 3.3 or newer, the farm manager of Blender: bakes a morph in chunks of frames, side by side,
// and assembles the .blend when all of them are done. Copy it into the folder "scripts" beside the Flamenco Manager.
// The workers' Blender must have the Convwass extension, and all of them must reach the shapes, the output and the cache.

const JOB_TYPE = {
    label: "Convwass Morph",
    description: "Bake a morph between shapes in chunks of frames, then assemble the .blend",
    settings: [
        { key: "shapes", type: "string", required: true,
          eval: "'; '.join(o.name for o in sorted(C.selected_objects, key=lambda o: o.matrix_world.translation.x) " +
                "if o.type == 'MESH')",
          evalInfo: { showLinkButton: true, description: "The selected meshes, from left to right" },
          description: "Two or more shapes in their order, with ';' between them: objects of the submitted .blend, or " +
                       "files with their folder, such as /shapes/cow.obj or /shapes/zoo.blend:Duck" },
        { key: "frames", type: "int32", default: 24, propargs: { min: 2 },
          description: "Frames from each shape to the next" },
        { key: "chunk_size", type: "int32", default: 8, propargs: { min: 1 }, visible: "submission",
          description: "Frames in one task, rounded up to whole runs of four, which are solved together" },
        { key: "resolution", type: "int32", default: 100, propargs: { min: 8, max: 1024 },
          description: "Cells along the longest side of the volume" },
        { key: "options", type: "string", default: "",
          description: "More options as on the command line, such as: --sharpness 1 --parts materials" },
        { key: "output", type: "string", subtype: "file_path", required: true,
          eval: "str(Path(abspath('//'), jobname + '.morph.blend'))",
          description: "The .blend to write" },
        { key: "cache", type: "string", subtype: "dir_path", required: true,
          eval: "str(Path(abspath('//'), jobname + '.frames'))",
          description: "Folder for finished frames, shared by all workers; it may be deleted when the job is done" },
        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "The submitted .blend, which holds the shapes that are no files" },
    ],
};

// The solver starts each frame from the one before, in runs of so many; a chunk that cut one would solve it twice.
const RUN_LENGTH = 4;

function compileJob(job) {
    const settings = job.settings;
    const shapes = shapeArguments(settings);
    const frames = wholeNumber(settings.frames, "frames", 2);
    const chunkSize = RUN_LENGTH * Math.ceil(wholeNumber(settings.chunk_size, "chunk_size", 1) / RUN_LENGTH);
    const words = [
        "--command", "convwass", "morph", ...shapes,
        "--frames", String(frames),
        "--resolution", String(wholeNumber(settings.resolution, "resolution", 8)),
        ...shellSplit(settings.options || ""),
        "--out", given(settings.output, "output"),
        "--cache", given(settings.cache, "cache"),
    ];
    // The first shape is frame 0, so that n shapes take (n - 1) * frames + 1 of them.
    const last = (shapes.length - 1) * frames;
    const assemble = blenderTask("assemble", words);
    for (let first = 0; first <= last; first += chunkSize) {
        const range = `${first}-${Math.min(first + chunkSize - 1, last)}`;
        const bake = blenderTask(`bake-${range}`, [...words, "--frames-range", range]);
        job.addTask(bake);
        assemble.addDependency(bake);
    }
    job.addTask(assemble);
}

// Runs Blender by "exec": "blender-render" would open a file first, and look for pictures in what Blender prints.
function blenderTask(name, words) {
    const task = author.Task(name, "blender");
    task.addCommand(author.Command("exec", { exe: "{blender}", args: words }));
    return task;
}

function shapeArguments(settings) {
    const names = given(settings.shapes, "shapes").split(";").map((name) => name.trim()).filter((name) => name !== "");
    if (names.length < 2) {
        throw "shapes: a morph needs two of them at least, with ';' between them";
    }
    return names.map((name) => /[\/\\]/.test(name) ? name : `${given(settings.blendfile, "blendfile")}:${name}`);
}

function given(value, key) {
    if (!value) {
        throw `${key}: this setting is missing`;
    }
    return String(value);
}

function wholeNumber(value, key, least) {
    if (!Number.isInteger(value) || value < least) {
        throw `${key}: must be a whole number, ${least} or more`;
    }
    return value;
}
