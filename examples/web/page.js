/* page.js: a body to slice, pull and throw, in a page. worker.js has the body, player.js draws it.

   contents
     >>view     rays through the cursor
     >>tools    knife, hand, view: by mouse, pen, fingers and keys; the knife's trail
     >>page     controls, models, numbers */
"use strict";

/* ---------------------------------------------------------------------------------------------------- >>view */

const shapes = ["jelly cube", "thin slab", "octopus", "bunny"];
const canvas = document.getElementById("view"), at = id => document.getElementById(id);

/* All that the page knows; a test reads it, too. */
const page = {viewer: null, worker: null, tool: "knife", paused: false, ready: false, grabbed: null, numbers: null, frames: 0,
              meshes: 0, trouble: "", model: ""};

/* The ray through a point of the canvas: from the eye, and so far that it has passed the body */
function rayAt(x, y) {
    const {camera} = page.viewer, aspect = canvas.clientWidth / canvas.clientHeight;
    const {right, above, back} = camera.axes(), distance = camera.distance(aspect);
    const across = (2 * x / canvas.clientWidth - 1) * camera.slope * aspect, up = (1 - 2 * y / canvas.clientHeight) * camera.slope;
    const eye = gxMix(camera.target, 1, back, distance);
    return {eye, direction: gxMix(gxMix(right, across, above, up), 1, back, -1), distance};
}

/* A blade's edge: that ray, about the body */
function edgeAt(x, y) {
    const {eye, direction, distance} = rayAt(x, y), reach = 4;
    const near = Math.max(distance - reach, 0.05 * distance);
    return [...gxMix(eye, 1, direction, near), ...gxMix(eye, 1, direction, distance + reach)];
}

/* -------------------------------------------------------------------------------------------------- >>tools */

const pointers = new Map(); /* id: {x, y} */
let depth = 0;              /* of what the hand holds, along the view */
let last = null;            /* where the knife was last sent */

function sendStroke(x, y, more = {}) {
    page.worker.postMessage({stroke: edgeAt(x, y), ...more});
    last = {x, y};
    leaveTrail(x, y, more);
}

/* While a stroke lasts, one sees where it has been. */
let trail = [];
function leaveTrail(x, y, {first, last}) {
    if (first || last) trail = [];
    if (!last) trail.push(`${x},${y}`);
    at("trail").firstElementChild.setAttribute("points", trail.join(" "));
}

function grabAt(x, y) {
    const {eye, direction} = rayAt(x, y);
    page.worker.postMessage({grab: [...eye, ...direction]});
}

function pullTo(x, y) {
    const {eye, direction} = rayAt(x, y);
    page.worker.postMessage({pull: gxMix(eye, 1, direction, depth)});
}

/* Points of the canvas, from the corner of the page */
const place = event => {
    const box = canvas.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top};
};

const turns = event => event.button === 2 || event.button === 1 || event.shiftKey || page.tool === "view";

let action = null; /* "knife", "hand", "view" while pointers are down */

function finish() {
    if (action === "knife" && last) sendStroke(last.x, last.y, {last: true});
    if (action === "hand") page.worker.postMessage({release: true});
    page.grabbed = null;
    action = last = null;
}

canvas.addEventListener("contextmenu", event => event.preventDefault());
canvas.addEventListener("pointerdown", event => {
    const {x, y} = place(event);
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, {x, y});
    if (pointers.size > 1) {
        finish();
        action = "view";
    } else if (turns(event)) action = "view";
    else if (page.tool === "hand") {
        action = "hand";
        grabAt(x, y);
    } else {
        action = "knife";
        sendStroke(x, y, {first: true});
    }
});

function spread() {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y) || 1;
}

canvas.addEventListener("pointermove", event => {
    const before = pointers.get(event.pointerId), {x, y} = place(event);
    if (!before) return;
    if (action === "view") {
        const size = pointers.size > 1 ? spread() : 0;
        pointers.set(event.pointerId, {x, y});
        page.viewer.camera.turn(-(x - before.x) / 150 / pointers.size, (y - before.y) / 150 / pointers.size);
        if (size > 0) page.viewer.camera.magnify(spread() / size);
        draw();
        return;
    }
    pointers.set(event.pointerId, {x, y});
    if (action === "knife") for (const part of event.getCoalescedEvents?.() ?? [event]) sendStroke(place(part).x, place(part).y);
    else if (page.grabbed) pullTo(x, y);
});

for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, event => {
        pointers.delete(event.pointerId);
        if (pointers.size === 0) finish();
    });

canvas.addEventListener("wheel", event => {
    event.preventDefault();
    page.viewer.camera.magnify(Math.exp(-event.deltaY / 600));
    draw();
}, {passive: false});

/* Slices through the middle of the view by keys: across, or down */
function sliceMiddle(down) {
    const width = canvas.clientWidth, height = canvas.clientHeight, steps = 24;
    for (let i = 0; i <= steps; i++) {
        const share = i / steps;
        sendStroke(down ? width / 2 : width * share, down ? height * share : height / 2, {first: i === 0, last: i === steps});
    }
}

/* Shift and arrows pull at what is in the middle of the view, until shift is let go. */
const spot = {x: 0, y: 0};
function pullBy(right, down) {
    if (action !== "hand") {
        action = "hand";
        spot.x = canvas.clientWidth / 2;
        spot.y = canvas.clientHeight / 2;
        grabAt(spot.x, spot.y);
    }
    spot.x += 20 * right;
    spot.y += 20 * down;
    if (page.grabbed) pullTo(spot.x, spot.y);
}

const arrow = (right, down) => event => event.shiftKey ? pullBy(right, down) : turn(0.1 * right, -0.1 * down);
const keys = {
    k: () => choose("knife"), h: () => choose("hand"), v: () => choose("view"), u: undo, n: make, w: wires, c: colours,
    o: () => at("file").click(), " ": pause, ".": once, Enter: event => sliceMiddle(event.shiftKey),
    ArrowLeft: arrow(-1, 0), ArrowRight: arrow(1, 0), ArrowUp: arrow(0, -1), ArrowDown: arrow(0, 1),
    "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15),
};
window.addEventListener("keydown", event => {
    const key = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!key || event.ctrlKey || event.metaKey || event.altKey) return;
    if (/^(INPUT|SELECT|BUTTON)$/.test(event.target.tagName) && (event.key.length > 1 || event.key === " ")) return;
    event.preventDefault();
    key(event);
});
window.addEventListener("keyup", event => { if (event.key === "Shift" && pointers.size === 0) finish(); });

/* ---------------------------------------------------------------------------------------------------- >>page */

function turn(yaw, pitch) {
    page.viewer.camera.turn(yaw, pitch);
    draw();
}

function zoom(factor) {
    page.viewer.camera.magnify(factor);
    draw();
}

function choose(tool) {
    page.tool = tool;
    for (const button of document.querySelectorAll("[data-tool]")) button.setAttribute("aria-pressed", button.dataset.tool === tool);
    canvas.style.cursor = {knife: "crosshair", hand: "grab", view: "move"}[tool];
}

function pause() {
    page.paused = !page.paused;
    at("pause").setAttribute("aria-pressed", page.paused);
    page.worker.postMessage({pause: page.paused});
}

/* A step of a body that is paused */
function once() { page.worker.postMessage({once: true}); }

function undo() { page.worker.postMessage({undo: true}); }

function wires() {
    page.viewer.lines = gxLines[(gxLines.indexOf(page.viewer.lines) + 1) % gxLines.length];
    draw();
}

function colours() {
    page.viewer.colourOf = page.viewer.colourOf === gxFragmentColour ? gxSurfaceColour : gxFragmentColour;
    draw();
}

const young = () => Math.round(10 ** Number(at("young").value));

function clear() { page.trouble = at("trouble").textContent = ""; }

function make() {
    clear();
    page.worker.postMessage({make: Number(at("shape").value), young: young()});
}

/* A model's file becomes the body, and a choice of its own. */
async function open(file) {
    clear();
    const model = await file.arrayBuffer();
    page.model = file.name;
    page.worker.postMessage({model, name: file.name, young: young()}, [model]);
}

/* The body is another one now. */
function begin(kind) {
    const list = at("shape");
    if (kind === shapes.length) {
        if (list.length === kind) list.add(new Option("", kind));
        list.options[kind].text = page.model;
        list.value = kind;
    }
    if (kind < 2) page.viewer.camera.fit([-0.9, -0.9, 0], [0.9, 0.9, 1.7]);
    else page.viewer.camera.fit([-0.7, -0.7, 0], [0.7, 0.7, 1.4]); /* shapes and models: jelly.c scales them */
}

let drawing = false;
function draw() {
    if (drawing) return;
    drawing = true;
    requestAnimationFrame(() => {
        drawing = false;
        page.viewer.draw();
    });
}

function say(numbers) {
    page.numbers = numbers;
    const {fragments, elements, unknowns, step, cut, marks} = numbers;
    at("counts").textContent = `${fragments} ${fragments === 1 ? "piece" : "pieces"}, ${elements.toLocaleString("en")} elements, ` +
        `${unknowns.toLocaleString("en")} unknowns; step ${step.toFixed(1)} ms, cut ${cut.toFixed(1)} ms`;
    at("undo").disabled = marks === 0;
}

let triangles = null;
function take({data}) {
    if (data.ready) {
        page.ready = true;
        at("engine").textContent = data.simd ? "WebAssembly, vectors" : "WebAssembly";
        make();
    } else if ("made" in data) {
        begin(data.made);
    } else if (data.trouble) {
        page.trouble = at("trouble").textContent = data.trouble;
    } else if ("grabbed" in data) {
        page.grabbed = data.grabbed;
        if (data.grabbed) {
            const {eye, direction} = rayAt(0.5 * canvas.clientWidth, 0.5 * canvas.clientHeight);
            depth = gxDot(gxMix(data.grabbed, 1, eye, -1), gxUnit(direction)); /* rays have length 1 along the view's middle */
        } else if (action === "hand") action = "view"; /* nothing there: turns the view */
    } else if (data.frame) {
        if (data.frame.mesh) {
            triangles = data.frame.mesh;
            page.meshes++;
        }
        page.viewer.show({mesh: triangles, positions: data.frame.positions, normals: data.frame.normals});
        page.frames++;
        say(data.numbers);
        draw();
        requestAnimationFrame(() => page.worker.postMessage({seen: true}));
    }
}

function start() {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    try {
        page.viewer = new GxViewer(canvas);
    } catch (error) {
        at("trouble").textContent = error.message;
        return;
    }
    page.viewer.background = dark ? [0.07, 0.09, 0.11, 1] : [0.95, 0.96, 0.97, 1];
    page.viewer.ground = {height: 0, size: 2.5, colour: dark ? [0.5, 0.6, 0.7] : [0.1, 0.15, 0.2]};
    page.worker = new Worker("worker.js");
    page.worker.onmessage = take;
    page.worker.onerror = event => { page.trouble = at("trouble").textContent = event.message; };
    page.worker.postMessage({files: "", plain: new URLSearchParams(location.search).has("plain")});
    shapes.forEach((name, i) => at("shape").add(new Option(name, i)));
    at("shape").onchange = make;
    at("young").onchange = make;
    at("gravity").oninput = () => page.worker.postMessage({gravity: Number(at("gravity").value)});
    at("pause").onclick = pause;
    at("undo").onclick = undo;
    at("new").onclick = make;
    at("open").onclick = () => at("file").click();
    at("file").onchange = () => {
        if (at("file").files.length > 0) open(at("file").files[0]);
        at("file").value = "";
    };
    window.addEventListener("dragover", event => event.preventDefault());
    window.addEventListener("drop", event => {
        event.preventDefault();
        if (event.dataTransfer.files.length > 0) open(event.dataTransfer.files[0]);
    });
    at("wires").onclick = wires;
    at("colours").onclick = colours;
    for (const button of document.querySelectorAll("[data-tool]")) button.onclick = () => choose(button.dataset.tool);
    choose("knife");
    window.addEventListener("resize", draw);
}

start();
