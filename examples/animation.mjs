// Records the page of examples/web in headless Chromium: a cube of jelly is sliced by strokes of the mouse, as an animated WebP
// file; then two screenshots. The page is paused and goes on step by step, so that it is as smooth on any machine.
// usage: node examples/animation.mjs FOLDER DIRECTORY PICTURES
//     FOLDER     the page, as `make web` builds it
//     DIRECTORY  of the frames as PNG
//     PICTURES   where cut.webp, page_cube.png and page_bunny.png go
import {execFileSync} from "node:child_process";
import {mkdirSync, rmSync, writeFileSync} from "node:fs";
import {openPage} from "../tests/chromium.mjs";
import {serve} from "../tests/serve.mjs";

const [folder, directory, pictures] = process.argv.slice(2);
const [width, height] = [640, 440], each = 3, milliseconds = 50, rest = 800; // steps of 1/60 s, and ms, of a frame; of the last one

rmSync(directory, {recursive: true, force: true});
mkdirSync(directory, {recursive: true});
const {address, close} = await serve(folder), page = await openPage(address, {width, height});

async function until(expression) {
    for (const end = Date.now() + 60000; !await page.evaluate(expression);) {
        if (Date.now() > end) throw new Error("the page does not get to: " + expression);
        await new Promise(done => setTimeout(done, 5));
    }
}

// Headless browsers draw no cursor.
const cursor = `<svg id="cursor" width="20" height="28" style="position: fixed; left: 0; top: 0; pointer-events: none">
    <path d="M1 1v21l5-5 4 9 4-2-4-8h7z" fill="#fff" stroke="#1b2530" stroke-width="1.5" stroke-linejoin="round"/></svg>`;
let at = [0, 0];
async function move(x, y, more) {
    at = [x, y];
    await page.evaluate(`(c => { if (c) c.style.transform = "translate(${x - 1}px, ${y - 1}px)"; })(document.getElementById("cursor"))`);
    await page.mouse("mouseMoved", x, y, more);
}

let steps = 0;
const names = [];
async function step() {
    await page.key(".", ".");
    await until(`page.numbers.steps === ${++steps}`);
    if (steps % each !== 0) return;
    await page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))");
    names.push(`${directory}/${String(names.length).padStart(4, "0")}.png`);
    writeFileSync(names[names.length - 1], await page.screenshot());
}

// Moves the mouse to a point while the body takes a number of steps. Slow at both ends
async function glide(to, count, more) {
    const from = at;
    for (let i = 1; i <= count; i++) {
        const share = 0.5 - 0.5 * Math.cos(Math.PI * i / count);
        await move(...from.map((x, k) => x + share * (to[k] - x)), more);
        await step();
    }
}

async function stroke(from, to, count) {
    const button = {button: "left", buttons: 1, clickCount: 1};
    await glide(from, 12);
    await page.mouse("mousePressed", ...from, button);
    await glide(to, count, button);
    await page.mouse("mouseReleased", ...to, button);
}

await until("page.ready && page.numbers && page.numbers.steps > 3");
await page.key(" ", " ");
await page.key("n", "n"); // a new body, which has not moved yet
await until("page.numbers.steps === 0");
await page.evaluate(`
    document.querySelectorAll("#about, #keys, #bar").forEach(element => { element.style.display = "none"; });
    document.body.insertAdjacentHTML("beforeend", ${JSON.stringify(cursor)});
    page.viewer.lines = "none";
    Object.assign(page.viewer.camera, {yaw: -0.75, pitch: 0.2, zoom: 1.2});
    undefined`);
await move(40, 320);
await stroke([130, 250], [510, 205], 24);
await glide([345, 40], 60);
await stroke([335, 25], [316, 437], 30);
await glide([60, 340], 90);
const last = names.pop(), file = `${pictures}/cut.webp`;
execFileSync("img2webp", ["-loop", "0", "-lossy", "-q", "80", "-m", "6", "-d", milliseconds, ...names,
                          "-d", rest, last, "-o", file], {stdio: ["ignore", "ignore", "inherit"]});
console.log(`${file}: ${names.length + 1} frames`);

// The page as a whole, with what has come of it; then the bunny, with two slices through it
async function screenshot(name) {
    await page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))");
    writeFileSync(`${pictures}/page_${name}.png`, await page.screenshot());
}

await page.evaluate(`
    document.querySelectorAll("#about, #keys, #bar").forEach(element => { element.style.display = ""; });
    document.getElementById("cursor").remove();
    page.viewer.lines = "edges"; undefined`);
await page.send("Emulation.setDeviceMetricsOverride", {width: 960, height: 640, deviceScaleFactor: 1, mobile: false});
await screenshot("cube");
await page.evaluate(`(s => { s.value = 3; s.onchange(); })(document.getElementById("shape"))`);
await until("page.numbers.steps === 0");
steps = 0;
for (const [from, to] of [[[250, 260], [720, 330]], [[560, 90], [430, 560]]]) {
    await page.drag(from, to);
    for (let i = 0; i < 20; i++) {
        await page.key(".", ".");
        await until(`page.numbers.steps === ${++steps}`);
    }
}
await screenshot("bunny");
await page.close();
close();
