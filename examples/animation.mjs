// Draws the frames of a page of gxcut or a scene in headless Chromium and makes one animated WebP file of them, on a
// transparent ground.
// usage: node examples/animation.mjs PAGE DIRECTORY FILE
//     DIRECTORY  of the frames as PNG
import {execFileSync} from "node:child_process";
import {mkdirSync, rmSync, writeFileSync} from "node:fs";
import {openPage} from "../tests/chromium.mjs";

const [path, directory, file] = process.argv.slice(2);
const [width, height] = [640, 440], milliseconds = 50, rest = 400; // of a frame; of the last one

rmSync(directory, {recursive: true, force: true});
mkdirSync(directory, {recursive: true});
const page = await openPage(path, {width, height});
await page.evaluate(`
    document.querySelectorAll("#about, #keys, #bar").forEach(element => { element.style.display = "none"; });
    document.documentElement.style.background = document.body.style.background = "transparent";
    player.play(false);
    player.viewer.lines = "none";
    Object.assign(player.viewer.camera, {yaw: -0.75, pitch: 0.08, zoom: 1.75});
    player.viewer.camera.pan(0, 0.21, ${width / height});
    undefined`);
const count = await page.evaluate("player.frames.count"), names = [];
for (let i = 0; i < count; i++) {
    await page.evaluate(`player.show(${i});
        new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))`);
    names.push(`${directory}/${String(i).padStart(4, "0")}.png`);
    writeFileSync(names[i], await page.screenshot({transparent: true}));
}
await page.close();
const last = names.pop();
execFileSync("img2webp", ["-loop", "0", "-lossy", "-q", "80", "-m", "6", "-d", milliseconds, ...names,
                          "-d", rest, last, "-o", file], {stdio: ["ignore", "ignore", "inherit"]});
console.log(`${file}: ${count} frames`);
