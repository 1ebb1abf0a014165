// Opens the page of examples/web in headless Chromium, served as files: slices, pulls, throws, goes back.
// usage: node tests/check_web.mjs FOLDER DIRECTORY
//     FOLDER     the page, as `make web` builds it
//     DIRECTORY  of the pictures
import {mkdirSync, readFileSync, writeFileSync} from "node:fs";
import {join} from "node:path";
import {brotliCompressSync} from "node:zlib";
import {decodePng, openPage} from "./chromium.mjs";
import {serve} from "./serve.mjs";

const [folder, directory] = process.argv.slice(2);
const width = 960, height = 700;
let passed = 0, failed = 0;

function check(name, good, found = "") {
    if (good) passed++;
    else failed++;
    if (!good) console.log("FAILED " + name, found);
    return good;
}

const {address, close} = await serve(folder);

// Waits until an expression of the page is true.
async function until(page, expression, seconds = 30) {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
        if (await page.evaluate(expression).catch(() => false)) return true;
        await new Promise(done => setTimeout(done, 50));
    }
    return false;
}

// Lets the body move for a number of frames.
const frames = (page, count) => page.evaluate("page.frames").then(at => until(page, `page.frames >= ${at + count}`, 120));
const numbers = page => page.evaluate("page.numbers");

async function look(page, name) {
    await page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))");
    const png = await page.screenshot();
    if (name) writeFileSync(`${directory}/${name}.png`, png);
    return decodePng(png);
}

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

// Connected regions of at least `least` pixels that have the flat colours of fragments
async function regions(page, least = 400) {
    await page.evaluate("page.viewer.flat = true; page.viewer.draw()");
    const colours = await page.evaluate("[...new Set(triangles.fragments)].map(f => [gxFragmentColour(f, 0), gxFragmentColour(f, 1)])");
    const picture = await look(page);
    await page.evaluate("page.viewer.flat = false; page.viewer.draw()");
    const of = new Int32Array(width * height).fill(-1);
    for (let y = 80; y < height - 70; y++)
        for (let x = 0; x < width; x++)
            of[y * width + x] = colours.findIndex(pair => pair.some(bytes => distance(picture.pixel(x, y), bytes) <= 3));
    let count = 0;
    for (let start = 0; start < of.length; start++) {
        if (of[start] < 0) continue;
        const piece = of[start], stack = [start];
        let size = 0;
        of[start] = -1;
        while (stack.length > 0) {
            const i = stack.pop();
            size++;
            for (const next of [i - 1, i + 1, i - width, i + width])
                if (of[next] === piece) {
                    of[next] = -1;
                    stack.push(next);
                }
        }
        count += size >= least;
    }
    return count;
}

// Share of the pixels that differ
function difference(a, b) {
    let count = 0;
    for (let y = 80; y < height - 70; y++) for (let x = 0; x < width; x++) count += distance(a.pixel(x, y), b.pixel(x, y)) > 12;
    return count / (width * height);
}

async function stroke(page, from, to) {
    const button = {button: "left", buttons: 1, clickCount: 1}, steps = 12;
    await page.mouse("mousePressed", ...from, button);
    for (let i = 1; i <= steps; i++) await page.mouse("mouseMoved", ...from.map((x, k) => x + (to[k] - x) * i / steps), button);
    await page.mouse("mouseReleased", ...to, button);
}

async function checkSlices(page) {
    const first = await look(page, "first");
    check("something is drawn", difference(first, {pixel: () => first.pixel(5, 400)}) > 0.05);
    check("one piece", (await numbers(page)).fragments === 1);
    check("nothing to go back to", await page.evaluate("document.getElementById('undo').disabled"));
    await page.evaluate("page.viewer.camera.yaw = 0; page.viewer.camera.pitch = 0.05");
    await stroke(page, [150, 350], [810, 330]);
    check("a stroke across gives two pieces", await until(page, "page.numbers.fragments === 2"), await numbers(page));
    await frames(page, 15);
    check("the lower one falls", await regions(page) === 2, await regions(page));
    await look(page, "across");
    await page.key(" ", " "); // what swings across a blade that is slow is cut into more pieces
    await stroke(page, [480, 100], [485, 620]);
    check("a stroke down gives four", await until(page, "page.numbers.fragments === 4"), await numbers(page));
    await page.key(" ", " ");
    await frames(page, 5);
    check("which are seen", await regions(page) === 4, await regions(page));
    await look(page, "four");
    await page.evaluate("document.getElementById('undo').click()");
    check("undo brings two back", await until(page, "page.numbers.fragments === 2"), await numbers(page));
    await page.key("u", "u");
    check("U brings one back", await until(page, "page.numbers.fragments === 1"), await numbers(page));
    check("it is one region", await frames(page, 2) && await regions(page) === 1, await regions(page));
}

async function checkHand(page) {
    await page.key("n", "n");
    await until(page, "page.numbers.fragments === 1");
    await frames(page, 120);
    await page.key("h", "h");
    check("H chooses the hand", await page.evaluate("page.tool") === "hand");
    const reach = () => page.evaluate("page.viewer.frame.positions.reduce((most, x, i) => i % 3 < 2 ? Math.max(most, Math.abs(x)) : most, 0)");
    const before = await look(page), rest = await reach(), button = {button: "left", buttons: 1, clickCount: 1};
    await page.mouse("mousePressed", 480, 420, button);
    check("the hand takes hold", await until(page, "page.grabbed !== null", 5));
    for (let i = 1; i <= 10; i++) await page.mouse("mouseMoved", 480 + 20 * i, 420, button);
    await frames(page, 20);
    const pulled = await look(page, "pulled"), far = await reach();
    check("pulling moves it", difference(before, pulled) > 0.01, difference(before, pulled));
    await page.mouse("mouseReleased", 680, 420, button);
    check("letting go ends the hold", await page.evaluate("page.grabbed === null"));
    await frames(page, 120);
    const back = await reach();
    check("and it swings back", back < rest + 0.5 * (far - rest), [rest, far, back]);
    await page.key("k", "k");
}

async function checkGround(page) {
    await page.key("n", "n");
    await until(page, "page.numbers.fragments === 1");
    await page.key("Enter");
    check("Enter slices across", await until(page, "page.numbers.fragments === 2"), await numbers(page));
    await frames(page, 120);
    check("what has fallen lies on the ground", await page.evaluate("Math.min(...page.viewer.frame.positions.filter((x, i) => i % 3 === 2))") > -0.15);
    await look(page, "fallen");
    await page.key(" ", " ");
    const still = await look(page);
    await new Promise(done => setTimeout(done, 300));
    check("space pauses", difference(still, await look(page)) === 0);
    await checkPaused(page);
    await page.key(" ", " ");
}

// A body that is paused goes on step by step. A stroke along an earlier one, which divides nothing, leaves it as well as it was.
async function checkPaused(page) {
    await page.key("n", "n");
    await until(page, "page.numbers.steps === 0");
    for (let i = 1; i <= 40; i++) {
        await page.key(".", ".");
        if (!check("a step is one step", await until(page, `page.numbers.steps === ${i}`), await numbers(page))) return;
    }
    for (let i = 0; i < 3; i++) {
        await stroke(page, [150, 350], [810, 330]);
        check("a stroke again", await until(page, `page.numbers.marks === ${i + 1} && page.numbers.fragments === 2`), await numbers(page));
    }
    await page.key(".", ".");
    check("it goes on", await until(page, "page.numbers.steps === 41") && await page.evaluate("page.trouble") === "",
          await page.evaluate("page.trouble"));
}

// A new body that stands still, of a kind of those in the list
async function still(page, kind = 0) {
    if (!await page.evaluate("page.paused")) await page.key(" ", " ");
    const meshes = await page.evaluate("page.meshes");
    await page.evaluate(`(s => { s.value = ${kind}; s.onchange(); })(document.getElementById("shape"))`);
    await until(page, `page.meshes > ${meshes} && page.numbers.steps === 0`);
}

async function step(page, count, before = () => {}) {
    const at = (await numbers(page)).steps;
    for (let i = 1; i <= count; i++) {
        await before(i);
        await page.key(".", ".");
        if (!await until(page, `page.numbers.steps === ${at + i}`)) return;
    }
}

// Moves a slider by a key: to its least value, to its greatest
const slide = async (page, id, key) => {
    await page.evaluate(`document.getElementById("${id}").focus()`);
    await page.key(key);
    await page.evaluate("document.activeElement.blur()");
};

// The mean of the vertices of the lowest piece
const lowest = page => page.evaluate(`(() => {
    const {positions} = page.viewer.frame, pieces = new Map();
    triangles.fragments.forEach((piece, t) => {
        if (!pieces.has(piece)) pieces.set(piece, new Set());
        for (let k = 0; k < 3; k++) pieces.get(piece).add(triangles.triangles[3 * t + k]);
    });
    const means = [...pieces.values()].map(of => [0, 1, 2].map(k => [...of].reduce((sum, v) => sum + positions[3 * v + k], 0) / of.size));
    return means.reduce((a, b) => b[2] < a[2] ? b : a);
})()`);

async function checkSliders(page) {
    const count = 12, falls = {};
    for (const [key, gravity] of [["Home", 0], ["End", 20]]) {
        await slide(page, "gravity", key);
        await still(page);
        await stroke(page, [150, 350], [810, 330]);
        await until(page, "page.numbers.fragments === 2");
        const [, , before] = await lowest(page);
        await step(page, count);
        falls[gravity] = before - (await lowest(page))[2];
    }
    const free = 0.5 * 20 * (count / 60) ** 2;
    check("without gravity nothing falls", Math.abs(falls[0]) < 1e-3, falls);
    check("with it a piece falls as far as it should", Math.abs(falls[20] / free - 1) < 0.1, [falls, free]);
    const sags = [];
    for (const key of ["", "End"]) {
        if (key) await slide(page, "young", key);
        await still(page);
        const [, , before] = await lowest(page);
        let most = 0;
        await step(page, 30, async () => { most = Math.max(most, before - (await lowest(page))[2]); });
        sags.push(most);
    }
    const stiffer = 10 ** (5.7 - 4.4);
    check("stiffness 20 times as great, a sag so much less", Math.abs(sags[0] / sags[1] / stiffer - 1) < 0.3, [sags, stiffer]);
    check("the slider says so", await page.evaluate("young()") === Math.round(10 ** 5.7));
}

// A hand that moves evenly pulls a piece along. Let go, the piece goes on as fast as it was, and comes down on the ground.
async function checkThrow(page) {
    await slide(page, "gravity", "Home");
    await still(page, 1);
    await page.evaluate("page.viewer.camera.yaw = -Math.PI / 2; page.viewer.camera.pitch = 0.05");
    await page.key("k", "k");
    await stroke(page, [100, 290], [860, 290]);
    check("the slab is sliced", await until(page, "page.numbers.fragments === 2"), await numbers(page));
    await page.key("h", "h");
    const start = [480, 330], button = {button: "left", buttons: 1, clickCount: 1}, path = [await lowest(page)];
    await page.mouse("mousePressed", ...start, button);
    check("the hand takes hold of it", await until(page, "page.grabbed !== null"));
    const hand = x => page.evaluate(`(({eye, direction}) => gxMix(eye, 1, direction, depth))(rayAt(${x}, ${start[1]}))`);
    const follow = async () => path.push(await lowest(page));
    await step(page, 20, async i => {
        await page.mouse("mouseMoved", start[0] + 4 * i, start[1], button);
        await follow();
    });
    await follow();
    const a = await hand(start[0]), b = await hand(start[0] + 4), speed = distance(a, b);
    const along = i => path[i].reduce((sum, x, k) => sum + (x - path[i - 1][k]) * (b[k] - a[k]), 0) / speed ** 2;
    const across = i => Math.sqrt(Math.max(0, (distance(path[i], path[i - 1]) / speed) ** 2 - along(i) ** 2));
    check("the piece goes as fast as the hand, and its way", Math.abs(along(21) - 1) < 0.3 && across(21) < 0.1, [along(21), across(21)]);
    await page.mouse("mouseReleased", start[0] + 80, start[1], button);
    await step(page, 6, follow);
    await follow();
    check("let go, it flies on", Math.abs(along(28) / along(21) - 1) < 0.15, [along(21), along(28)]);
    await slide(page, "gravity", "End");
    const before = path[path.length - 1];
    await step(page, 10);
    const after = await lowest(page), far = after.reduce((sum, x, k) => sum + (x - before[k]) * (b[k] - a[k]), 0) / speed ** 2;
    check("falls meanwhile", Math.abs((before[2] - after[2]) / (0.5 * 20 * (10 / 60) ** 2) - 1) < 0.15, [before, after]);
    check("and not on the spot", Math.abs(far / 10 / along(28) - 1) < 0.15, [far, along(28)]);
    await page.key(" ", " ");
    await frames(page, 90);
    const low = await page.evaluate("Math.min(...page.viewer.frame.positions.filter((x, i) => i % 3 === 2))"), lies = await lowest(page);
    check("and lands on the ground", low > -0.05 && low < 0.05 && lies[2] < after[2] - 0.2, [low, lies, after]);
    await look(page, "thrown");
    await page.key("k", "k");
    await page.evaluate("at('gravity').value = 9.8; at('gravity').oninput(); at('young').value = 4.4");
}

// All that the mouse does, by keys
async function checkKeys(page) {
    await page.evaluate("document.activeElement.blur()");
    const seen = new Set();
    for (let i = 0; i < 16; i++) {
        await page.key("Tab");
        seen.add(await page.evaluate("document.activeElement.id || document.activeElement.dataset.tool || document.activeElement.tagName"));
    }
    const controls = ["SUMMARY", "knife", "hand", "view", "pause", "new", "open", "shape", "young", "gravity", "wires", "colours"];
    check("Tab comes to each control", controls.every(name => seen.has(name)), [...seen]);
    await page.evaluate("document.getElementById('gravity').focus()");
    const gravity = () => page.evaluate("Number(document.getElementById('gravity').value)"), before = await gravity();
    await page.key("ArrowLeft");
    check("arrows move a slider", await gravity() < before, [before, await gravity()]);
    await page.evaluate("document.activeElement.blur()");
    await still(page);
    await page.key("Enter");
    await until(page, "page.numbers.fragments === 2");
    await page.evaluate("document.getElementById('new').focus()");
    await page.key("Enter", "\r");
    check("Enter presses the button that has the focus", await until(page, "page.numbers.steps === 0 && page.numbers.fragments === 1"));
    await page.evaluate("document.activeElement.blur()");
    await page.key("Enter", undefined, {modifiers: 8});
    check("shift Enter slices down", await until(page, "page.numbers.fragments === 2"), await numbers(page));
    const yaw = await page.evaluate("page.viewer.camera.yaw");
    await page.key("ArrowRight");
    check("arrows turn", await page.evaluate("page.viewer.camera.yaw") !== yaw);
    const rest = [...await page.evaluate("[...page.viewer.frame.positions]")];
    for (let i = 0; i < 10; i++) await page.key("ArrowDown", undefined, {modifiers: 8});
    check("shift arrows take hold", await until(page, "page.grabbed !== null"));
    await page.key("ArrowDown", undefined, {modifiers: 8});
    await step(page, 10);
    const moved = await page.evaluate("[...page.viewer.frame.positions]");
    check("and pull", Math.max(...moved.map((x, i) => Math.abs(x - rest[i]))) > 0.02);
    await page.key("Shift");
    check("until shift is let go", await page.evaluate("page.grabbed === null"));
    await page.key(" ", " ");
}

async function checkView(page) {
    const straight = await look(page);
    await page.drag([480, 350], [600, 330], {button: "right", buttons: 2});
    check("the right button turns", difference(straight, await look(page)) > 0.02);
    const zoom = await page.evaluate("page.viewer.camera.zoom");
    await page.mouse("mouseWheel", 480, 350, {deltaX: 0, deltaY: -300});
    check("the wheel zooms", await page.evaluate("page.viewer.camera.zoom") > 1.2 * zoom);
    await page.touch("touchStart", [[400, 300], [500, 300]]);
    await page.touch("touchMove", [[350, 300], [550, 300]]);
    await page.touch("touchEnd", []);
    check("two fingers zoom", await page.evaluate("page.viewer.camera.zoom") > 1.5 * zoom);
    await page.key("w", "w");
    check("W changes the lines", await page.evaluate("page.viewer.lines") !== "edges");
}

async function checkTouch(page) {
    await page.key(" ", " ");
    await page.key("n", "n");
    await until(page, "page.numbers.steps === 0");
    await page.touch("touchStart", [[120, 360]]);
    for (let i = 1; i <= 12; i++) await page.touch("touchMove", [[120 + 60 * i, 360]]);
    await page.touch("touchEnd", []);
    check("a finger slices", await until(page, "page.numbers.fragments === 2"), await numbers(page));
    await page.key(" ", " ");
}

async function checkShapes(page) {
    for (let shape = 1; shape < 4; shape++) {
        const meshes = await page.evaluate("page.meshes");
        await page.evaluate(`(s => { s.value = ${shape}; s.onchange(); })(document.getElementById("shape"))`);
        check(`shape ${shape} is drawn`, await until(page, `page.meshes > ${meshes} && page.numbers.fragments === 1`) && await frames(page, 20));
        await look(page, `shape_${shape}`);
        check(`shape ${shape} has no trouble`, await page.evaluate("page.trouble") === "", await page.evaluate("page.trouble"));
    }
}

// Drops a file onto the page.
const give = (page, name, text) => page.evaluate(`(() => {
    const data = new DataTransfer();
    data.items.add(new File([${JSON.stringify(text)}], ${JSON.stringify(name)}));
    window.dispatchEvent(new DragEvent("drop", {dataTransfer: data, cancelable: true}));
})()`);

// A box as an OBJ file of six quadrilaterals, or without the last one
const box = faces => "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 1.5\nv 2 0 1.5\nv 2 1 1.5\nv 0 1 1.5\n" +
    ["1 4 3 2", "5 6 7 8", "1 2 6 5", "3 4 8 7", "2 3 7 6", "-8 -4 -1 -5"].slice(0, faces).map(f => `f ${f}\n`).join("");

// A tetrahedron as an ASCII STL file
const tetrahedron = () => [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(face => "facet normal 0 0 0\nouter loop\n" +
    face.map(i => `vertex ${[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]][i].join(" ")}\n`).join("") + "endloop\nendfacet\n").join("");

async function checkModels(page) {
    let meshes = await page.evaluate("page.meshes");
    const shown = () => until(page, `page.meshes > ${meshes} && page.numbers.fragments === 1`);
    await give(page, "box.obj", box(6));
    check("a box becomes the body", await shown() && await page.evaluate("page.trouble") === "", await page.evaluate("page.trouble"));
    await frames(page, 10);
    await look(page, "box");
    const {elements} = await numbers(page);
    await page.key("Enter");
    check("the box is sliced", await until(page, "page.numbers.fragments === 2"), await numbers(page));
    await give(page, "open.obj", box(5));
    check("an open box says why not", await until(page, "/open.obj, triangle \\d+: .*closed/.test(page.trouble)"), await page.evaluate("page.trouble"));
    await give(page, "notes.txt", "v 0 0 0");
    check("what is no model says so", await until(page, "/notes.txt: neither/.test(page.trouble)"), await page.evaluate("page.trouble"));
    await give(page, "bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
    check("a triangle without a vertex says so", await until(page, "/bad.obj: .*vertices/.test(page.trouble)"), await page.evaluate("page.trouble"));
    check("after bad models the body is there", (await numbers(page)).elements === elements && (await numbers(page)).fragments === 2, await numbers(page));
    meshes = await page.evaluate("page.meshes");
    await give(page, "tet.stl", tetrahedron());
    check("a tetrahedron becomes the body", await shown() && await page.evaluate("page.trouble") === "", await page.evaluate("page.trouble"));
    check("the list has the model", await page.evaluate("document.getElementById('shape').selectedOptions[0].text") === "tet.stl");
}

async function checkMemory(page) {
    await page.evaluate(`(s => { s.value = 0; s.onchange(); })(document.getElementById("shape"))`);
    await frames(page, 100);
    const before = (await numbers(page)).memory, start = Date.now(), at = await page.evaluate("page.frames");
    await frames(page, 600);
    const rate = 1000 * (await page.evaluate("page.frames") - at) / (Date.now() - start);
    check("600 frames take no more memory", (await numbers(page)).memory === before, (await numbers(page)).memory - before);
    const {step, elements} = await numbers(page);
    console.log(`${elements} elements: ${rate.toFixed(0)} frames a second, drawn in software; a step ${step.toFixed(1)} ms`);
}

mkdirSync(directory, {recursive: true});
const loaded = ["index.html", "player.css", "player.js", "page.js", "worker.js", "jelly-simd.wasm"]
    .reduce((sum, name) => sum + brotliCompressSync(readFileSync(join(folder, name))).length, 0);
check("what the page loads has at most 250,000 bytes by brotli", loaded <= 250000, loaded);
console.log(`the page loads ${loaded} bytes, by brotli`);
const page = await openPage(address, {width, height});
check("the body is there", await until(page, "page.ready && page.frames > 3"), await page.evaluate("page.trouble"));
await checkSlices(page);
await checkHand(page);
await checkGround(page);
await checkSliders(page);
await checkThrow(page);
await checkKeys(page);
await checkView(page);
await checkTouch(page);
await checkShapes(page);
await checkModels(page);
await checkMemory(page);
check("nothing went wrong", page.errors.length === 0, page.errors);
check("nothing came from elsewhere", page.requests.every(url => url.startsWith(address) || url.startsWith("data:")), page.requests);
await page.close();

// Where vectors are missing, the other module runs.
const plain = await openPage(address + "?plain", {width, height});
check("without vectors", await until(plain, "page.ready && page.frames > 3") &&
      await plain.evaluate("document.getElementById('engine').textContent") === "WebAssembly");
await plain.key("Enter");
check("it slices, too", await until(plain, "page.numbers.fragments === 2"), await numbers(plain));
await plain.close();
close();
console.log(`check-web: ${passed} passed, ${failed} failed`);
process.exit(failed === 0 ? 0 : 1);
