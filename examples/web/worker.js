/* worker.js: runs the body of a page (jelly.c) in a thread of its own: strokes, pulls, a step for each frame.

   Messages in: {files, plain} first: folder of the modules; plain: the one without vectors. Then
     {make: kind, young}   a new body      {undo: true}    goes back to before the last stroke
     {model: bytes, name, young}           a new body of a closed surface: an OBJ or STL file
     {stroke: [6 numbers], first, last}    the blade's edge, two points in space; first: a stroke begins, last: it ends
     {grab: [6 numbers]}, {pull: [3 numbers]}, {release: true}     a hand: ray; point
     {pause: flag}, {gravity: m/s2}        {once: true}    a step, though it is paused
     {seen: true}                          the page has shown the last frame
   Messages out: {ready, simd}; {made: kind}; {grabbed: point or null}; {trouble: text};
     {frame: {mesh or null, positions, normals}, numbers: {fragments, elements, unknowns, steps, step, cut, marks, memory}}
     steps: since the body is there; step, cut: the last one's time, ms; marks: strokes to go back; memory: bytes */
"use strict";

let lib = null;          /* exports of the module */
let made = false;        /* there is a body */
let mesh = true;         /* the page lacks the present triangles */
let waiting = false;     /* the page has not shown the last frame */
let moved = false;       /* something is different from there */
let paused = false, gravity = 9.81;
let owed = 0, steps = 0; /* to be taken while paused; taken since the body is there */
const strokes = [];      /* edges that are to be moved through the body */
const times = {step: 0, cut: 0};

/* A module of two instructions with vectors: engines without them refuse it. */
const vectors = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);

const numbers = () => new Float64Array(lib.memory.buffer, lib.jelly_numbers(), 16);

function text(at) {
    const bytes = new Uint8Array(lib.memory.buffer, at), end = bytes.indexOf(0);
    return new TextDecoder().decode(bytes.slice(0, end));
}

/* Says what a call was refused for. */
function good(result) {
    if (result !== 0) postMessage({trouble: text(lib.jelly_error_text(result))});
    return result === 0;
}

/* The vertices and triangles of an OBJ file, whose y is up; polygons become fans. */
function readObj(lines) {
    const vertices = [], triangles = [];
    for (const line of lines.split("\n")) {
        const word = line.trim().split(/\s+/);
        if (word[0] === "v") vertices.push(Number(word[1]), -Number(word[3]), Number(word[2]));
        if (word[0] !== "f") continue;
        const corner = word.slice(1).map(text => parseInt(text, 10)).map(i => i < 0 ? vertices.length / 3 + i : i - 1);
        for (let k = 2; k < corner.length; k++) triangles.push(corner[0], corner[k - 1], corner[k]);
    }
    return {vertices, triangles};
}

/* The corners of an STL file's triangles, z up; those with equal coordinates become one vertex. */
function readStl(bytes) {
    const view = new DataView(bytes), count = bytes.byteLength >= 84 ? view.getUint32(80, true) : 0, corners = [];
    if (bytes.byteLength === 84 + 50 * count) {
        for (let t = 0; t < count; t++)
            for (let k = 3; k < 12; k++) corners.push(view.getFloat32(84 + 50 * t + 4 * k, true));
    } else {
        for (const match of new TextDecoder().decode(bytes).matchAll(/vertex\s+(\S+)\s+(\S+)\s+(\S+)/g))
            corners.push(...match.slice(1, 4).map(Number));
    }
    const known = new Map(), vertices = [], triangles = [];
    for (let i = 0; i < corners.length; i += 3) {
        const x = corners.slice(i, i + 3).map(c => c + 0), key = x.join();
        if (!known.has(key)) {
            known.set(key, vertices.length / 3);
            vertices.push(...x);
        }
        triangles.push(known.get(key));
    }
    return {vertices, triangles};
}

/* A file becomes the module's model. Throws where it is none. */
function takeModel(bytes, name) {
    const model = /\.stl$/i.test(name) ? readStl(bytes) : /\.obj$/i.test(name) ? readObj(new TextDecoder().decode(bytes)) : null;
    if (!model) throw new Error(`${name}: neither an OBJ nor an STL file`);
    const {vertices, triangles} = model, count = vertices.length / 3;
    if (triangles.length === 0) throw new Error(`${name}: has no triangles`);
    if (vertices.length % 3 !== 0 || !vertices.every(Number.isFinite)) throw new Error(`${name}: has a vertex that is no point`);
    if (!triangles.every(i => i >= 0 && i < count)) throw new Error(`${name}: has a triangle without one of its vertices`);
    if (lib.jelly_model_room(count, triangles.length / 3) !== 0) throw new Error(`${name}: is too large`);
    new Float64Array(lib.memory.buffer, lib.jelly_model_vertices(), vertices.length).set(vertices);
    new Uint32Array(lib.memory.buffer, lib.jelly_model_triangles(), triangles.length).set(triangles);
}

/* A new body; the old one stays where there can be none. */
const MODEL = 4;
function make(kind, young, name = "") {
    const result = lib.jelly_new(kind, young), triangle = lib.jelly_error_triangle();
    const blame = name + (triangle < 0 ? "" : `, triangle ${triangle}`);
    if (result !== 0) {
        postMessage({trouble: (blame ? blame + ": " : "") + text(lib.jelly_error_text(result))});
        return;
    }
    strokes.length = owed = steps = 0;
    made = mesh = true;
    postMessage({made: kind});
}

async function start(files, plain) {
    const simd = !plain && WebAssembly.validate(vectors);
    const response = await fetch(files + (simd ? "jelly-simd.wasm" : "jelly.wasm"));
    if (!response.ok) throw new Error("jelly.wasm: " + response.status);
    const {instance} = await WebAssembly.instantiate(await response.arrayBuffer(), {});
    lib = instance.exports;
    lib._initialize?.();
    postMessage({ready: true, simd});
    tick();
}

function stroke({stroke: edge, first, last}) {
    const begin = performance.now();
    if (first) good(lib.jelly_mark());
    numbers().set(edge);
    good(lib.jelly_stroke(last ? 1 : 0));
    if (numbers()[6] === 1) {
        mesh = true;
        times.cut = performance.now() - begin;
    }
}

function copy(kind, at, count) { return new kind(lib.memory.buffer, at, count).slice(); }

/* Numbers for life of the fragments of triangles */
function fragments(count) {
    const ids = lib.jelly_ids(), all = numbers()[0];
    const id = new Uint32Array(lib.memory.buffer, ids, all);
    return copy(Uint32Array, lib.jelly_fragments(), count).map(f => id[f]);
}

function show() {
    const vertices = 3 * lib.jelly_vertex_count(), count = lib.jelly_triangle_count();
    const frame = {mesh: null};
    if (!good(lib.jelly_draw())) return;
    frame.positions = copy(Float32Array, lib.jelly_positions(), vertices);
    frame.normals = copy(Float32Array, lib.jelly_normals(), vertices);
    if (mesh)
        frame.mesh = {triangles: copy(Uint32Array, lib.jelly_triangles(), 3 * count), fragments: fragments(count),
                      surfaces: copy(Uint32Array, lib.jelly_surfaces(), count)};
    mesh = moved = false;
    lib.jelly_ids();
    const [pieces, elements, unknowns] = numbers();
    postMessage({frame, numbers: {fragments: pieces, elements, unknowns, steps, step: times.step, cut: times.cut,
                                  marks: lib.jelly_mark_count(), memory: lib.memory.buffer.byteLength}},
                [frame.positions.buffer, frame.normals.buffer]);
    waiting = true;
}

/* A frame: strokes, a step, a picture. Where steps take longer than frames, time goes slower. */
function tick() {
    const begin = performance.now();
    if (made) {
        moved = moved || strokes.length > 0 || mesh;
        while (strokes.length > 0) stroke(strokes.shift());
        if (!paused || owed > 0) {
            const stepping = performance.now();
            owed = Math.max(owed - 1, 0);
            numbers().set([1 / 60, gravity]);
            if (good(lib.jelly_step())) steps++;
            moved = true;
            times.step = performance.now() - stepping;
        }
        if (moved && !waiting) show();
    }
    setTimeout(tick, Math.max(0, 1000 / 60 - (performance.now() - begin)));
}

onmessage = ({data}) => {
    if (data.files !== undefined) start(data.files, data.plain).catch(error => postMessage({trouble: error.message}));
    else if (data.make !== undefined) {
        make(data.make, data.young);
    } else if (data.model) {
        try {
            takeModel(data.model, data.name);
            make(MODEL, data.young, data.name);
        } catch (error) {
            postMessage({trouble: error.message});
        }
    } else if (data.stroke) strokes.push(data);
    else if (data.grab) {
        numbers().set(data.grab);
        good(lib.jelly_grab());
        postMessage({grabbed: numbers()[6] === 1 ? [...numbers().slice(0, 3)] : null});
    } else if (data.pull) {
        numbers().set(data.pull);
        lib.jelly_pull();
    } else if (data.release) lib.jelly_release();
    else if (data.undo) {
        good(lib.jelly_undo());
        mesh = true;
    } else if (data.pause !== undefined) paused = data.pause;
    else if (data.once) owed += paused;
    else if (data.gravity !== undefined) gravity = data.gravity;
    else if (data.seen) waiting = false;
};
