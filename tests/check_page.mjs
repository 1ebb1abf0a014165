// Opens the demo's page in headless Chromium, looks at its pictures, plays, scrubs, turns.
// usage: node tests/check_page.mjs PAGE FRAGMENTS DIRECTORY
//     FRAGMENTS  how many the page must show, each with a colour of its own seen from above
//     DIRECTORY  of the pictures
import {mkdirSync, writeFileSync} from "node:fs";
import {decodePng, findChromium, openPage} from "./chromium.mjs";

const [path, wanted, directory] = process.argv.slice(2);
let passed = 0, failed = 0;

function check(name, good, found = "") {
    if (good) passed++;
    else failed++;
    if (!good) console.log("FAILED " + name, found);
}

// The picture after the page has drawn
async function look(page, name) {
    await page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))");
    const png = await page.screenshot();
    writeFileSync(`${directory}/${name}.png`, png);
    return decodePng(png);
}

// Colours of the pixels above the controls, with their counts, most frequent first
function colours(picture) {
    const counts = new Map();
    for (let y = 70; y < picture.height - 70; y++)
        for (let x = 0; x < picture.width; x++) {
            const key = picture.pixel(x, y).join(" ");
            counts.set(key, (counts.get(key) ?? 0) + 1);
        }
    const list = [...counts].map(([key, count]) => ({bytes: key.split(" ").map(Number), count}));
    return list.sort((a, b) => b.count - a.count);
}

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

// Share of the pixels that differ
function difference(a, b) {
    let count = 0;
    for (let y = 0; y < a.height; y++)
        for (let x = 0; x < a.width; x++) count += distance(a.pixel(x, y), b.pixel(x, y)) > 12;
    return count / (a.width * a.height);
}

async function checkColours(page) {
    await page.evaluate("player.play(false); player.show(player.frames.count - 1); player.viewer.camera.pitch = 1.5;" +
                        "player.viewer.flat = true; player.draw()");
    const [background, ...seen] = colours(await look(page, "flat")).filter(colour => colour.count >= 12);
    const pairs = await page.evaluate("[...new Set(player.viewer.mesh.fragments)].map(f => " +
                                      "[gxFragmentColour(f, 0), gxFragmentColour(f, 1)])");
    const isSeen = bytes => seen.some(colour => distance(colour.bytes, bytes) <= 2);
    const outer = pairs.filter(([bytes]) => isSeen(bytes)), cut = pairs.filter(([, bytes]) => isSeen(bytes));
    let closest = Infinity;
    for (const [a] of outer)
        for (const [b] of outer) if (a !== b) closest = Math.min(closest, distance(a, b));
    check("fragments", pairs.length === Number(wanted), pairs.length);
    check("each fragment is seen by a colour of its own", outer.length === Number(wanted), outer.length);
    check("colours of two fragments differ", closest >= 30, closest);
    check("cut faces are seen", cut.length >= wanted / 2, cut.length);
    const tint = Math.min(...pairs.map(([a, b]) => distance(a, b)));
    check("cut faces differ from the outer surface", tint >= 60, tint);
    check("the background differs from all", pairs.flat().every(bytes => distance(bytes, background.bytes) > 15));
    await page.evaluate("player.viewer.flat = false; player.draw()");
}

async function checkControls(page, width, height) {
    await page.evaluate("document.getElementById('reset').click()");
    const still = await look(page, "still");
    check("pausing holds the picture", difference(still, await look(page, "still")) === 0);
    await page.evaluate("player.show(0)");
    const first = await look(page, "first");
    check("frames differ", difference(still, first) > 0.005, difference(still, first));

    await page.key(" ", " ");
    await new Promise(done => setTimeout(done, 700));
    const moved = await page.evaluate("player.playing && player.at");
    const playing = await look(page, "playing");
    check("the space bar plays", moved > 0, moved);
    check("playing changes the picture", difference(first, playing) > 0.003, difference(first, playing));
    await page.key(" ", " ");
    check("the space bar pauses", !await page.evaluate("player.playing"));

    const box = await page.evaluate("(b => [b.left, b.top, b.width, b.height])" +
                                    "(document.getElementById('scrub').getBoundingClientRect())");
    await page.drag([box[0] + 0.1 * box[2], box[1] + box[3] / 2], [box[0] + 0.75 * box[2], box[1] + box[3] / 2]);
    const at = await page.evaluate("player.at / (player.frames.count - 1)");
    check("the slider goes to a frame", Math.abs(at - 0.75) < 0.06, at);
    check("its number is shown", await page.evaluate(
        "document.getElementById('number').textContent === (player.at + 1) + ' / ' + player.frames.count"));
    await page.evaluate("document.activeElement.blur()");
    const before = await page.evaluate("player.at");
    await page.key("ArrowLeft");
    check("an arrow key steps by a frame", await page.evaluate("player.at") === before - 1);

    const straight = await look(page, "straight"), middle = [width / 2, height / 2];
    await page.drag(middle, [middle[0] + 150, middle[1] - 40]);
    const turned = await look(page, "turned");
    check("dragging turns", difference(straight, turned) > 0.02, difference(straight, turned));
    await page.drag(middle, [middle[0] + 90, middle[1]], {button: "right", buttons: 2});
    const panned = await look(page, "panned");
    check("the right button pans", difference(turned, panned) > 0.02, difference(turned, panned));
    await page.mouse("mouseWheel", ...middle, {deltaX: 0, deltaY: -300});
    const zoomed = await look(page, "zoomed");
    check("the wheel zooms", difference(panned, zoomed) > 0.02, difference(panned, zoomed));
    const zoom = await page.evaluate("player.viewer.camera.zoom");
    await page.touch("touchStart", [[400, 300], [500, 300]]);
    await page.touch("touchMove", [[350, 300], [550, 300]]);
    await page.touch("touchEnd", []);
    const pinched = await page.evaluate("player.viewer.camera.zoom") / zoom;
    check("two fingers zoom", Math.abs(pinched - 2) < 0.2, pinched);
    await page.key("r", "r");
    const reset = difference(straight, await look(page, "reset"));
    check("R resets the view", reset < 1e-4, reset);

    await page.key("c", "c");
    check("C changes the colours", difference(straight, await look(page, "cuts")) > 0.05);
    await page.key("c", "c");
    await page.key("l", "l");
    check("L changes the lines", difference(straight, await look(page, "triangles")) > 0.001);
}

// A dark page is dark and its text is bright; on a phone the controls fit.
async function checkDark() {
    const page = await openPage(path, {width: 400, height: 800, scale: 2, dark: true});
    await page.evaluate("player.play(false)");
    const picture = await look(page, "dark"), background = colours(picture)[0].bytes;
    check("dark background", Math.max(...background) < 60, background);
    const ink = await page.evaluate("getComputedStyle(document.body).color.match(/\\d+/g).map(Number)");
    check("bright text on it", Math.min(...ink) > 180, ink);
    const width = await page.evaluate("Math.max(...[...document.querySelectorAll('#bar, #bar *')]" +
                                      ".map(element => element.getBoundingClientRect().right))");
    check("controls fit a phone", width <= 400, width);
    check("no error on a phone", page.errors.length === 0, page.errors);
    await page.close();
}

async function checkWithout() {
    const before = "const get = HTMLCanvasElement.prototype.getContext;" +
                   "HTMLCanvasElement.prototype.getContext = function (kind, ...more) {" +
                   "return kind === 'webgl2' ? null : get.call(this, kind, ...more); };";
    const page = await openPage(path, {before});
    const text = await page.evaluate("(e => e.hidden ? '' : e.textContent)(document.getElementById('trouble'))");
    check("says that WebGL2 is missing", /WebGL2/.test(text), text);
    await look(page, "without");
    await page.close();
}

if (!findChromium()) {
    console.log("left out: no chromium");
    process.exit(0);
}
mkdirSync(directory, {recursive: true});
const [width, height] = [960, 640], page = await openPage(path, {width, height});
check("no message", await page.evaluate("document.getElementById('trouble').hidden"));
check("plays from the start", await page.evaluate("player.playing"));
const [background, ...body] = colours(await look(page, "start"));
const share = body.reduce((sum, colour) => sum + colour.count, 0) / (width * height);
check("not blank", share > 0.08 && body.length > 100, share);
await checkColours(page);
await checkControls(page, width, height);
check("no error", page.errors.length === 0, page.errors);
check("asks for nothing but itself", page.requests.filter(url => !/^(file|data):/.test(url)).length === 0 &&
      page.requests.length === 1, page.requests);
await page.close();
await checkDark();
await checkWithout();
console.log(`page: ${passed} passed, ${failed} failed; pictures in ${directory}`);
process.exit(failed ? 1 : 0);
