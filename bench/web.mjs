// web.mjs - what WebAssembly costs: steps of the page's jelly, a cube of some 10,000 elements that strokes divide and whose pieces
// fall onto the ground and onto each other, natively, in node and in headless Chromium, with vectors and without.
//
// make bench-web runs it. It prints CSV to stdout and writes it to build/bench/web.csv, and a table to stderr.
// usage: node bench/web.mjs FILE FOLDER NAME=PROGRAM... [--small]
//     FILE     the table
//     FOLDER   of the page's modules (make web)
//     PROGRAM  web.c by a native compiler; the first is what others are compared with. NAME has "musl": with the modules' C library
//
// All run the same calls, one after the other in each of five rounds; --small: one round, fewer steps. step_ms, skin_ms: the least of
// the rounds' means, of a step and of the skin for a frame. slowest_ms: of a step, the least of the rounds' slowest. ratio: step_ms
// beside the first native program's. fragments, vertices, topology, bits: what the calls end in. It must be the same for all with one
// C library; the last places of another one's functions move the body, and so where a blade in space meets it: fragments are the same.
import {execFileSync} from "node:child_process";
import {readFileSync, writeFileSync} from "node:fs";
import {findChromium, openPage} from "../tests/chromium.mjs";
import {serve} from "../tests/serve.mjs";

const [file, folder, ...rest] = process.argv.slice(2), small = rest.includes("--small");
const rounds = small ? 1 : 5, frames = small ? 40 : 240;

// Calls of the module: [name, integer, numbers for jelly_numbers]
function scene() {
    const calls = [["new", 0, 25119]], step = measured => calls.push(["step", measured, 1 / 60, 9.81]);
    const stroke = edgeAt => {
        for (let i = 0; i <= 24; i++) {
            calls.push(["stroke", i === 24 ? 1 : 0, ...edgeAt(i / 24)]);
            if (i % 3 === 0) step(0);
        }
    };
    for (let i = 0; i < 30; i++) step(0);
    stroke(t => [2.4 * t - 1.2, -1.3, 1.12, 2.4 * t - 1.2, 1.3, 1.05]); // across
    stroke(t => [0.04, -1.3, 2 - 2.3 * t, -0.07, 1.3, 2 - 2.3 * t]);    // down, twice
    stroke(t => [-1.3, 0.05, 2 - 2.3 * t, 1.3, -0.03, 2 - 2.3 * t]);
    for (let i = 0; i < frames; i++) step(1);
    return calls;
}

// Runs calls of a module: {times, ends}, as web.c prints them. Also sent to the browser, as text.
async function run(bytes, calls) {
    const lib = (await WebAssembly.instantiate(bytes, {})).instance.exports, times = [];
    lib._initialize?.();
    const good = result => { if (result !== 0) throw new Error("a call failed: " + result); };
    const numbers = () => new Float64Array(lib.memory.buffer, lib.jelly_numbers(), 16);
    for (const [name, integer, ...values] of calls) {
        numbers().set(values);
        const start = performance.now();
        good(name === "new" ? lib.jelly_new(integer, values[0]) : name === "stroke" ? lib.jelly_stroke(integer) : lib.jelly_step());
        if (name !== "step" || !integer) continue;
        times.push(performance.now() - start);
        good(lib.jelly_draw());
        times.push(performance.now() - start);
    }
    good(lib.jelly_draw());
    const words = (at, count, sum = 2166136261) => {
        for (const word of new Uint32Array(lib.memory.buffer, at, count)) sum = Math.imul(sum ^ word, 16777619);
        return sum >>> 0;
    };
    const triangles = lib.jelly_triangle_count(), vertices = lib.jelly_vertex_count();
    const topology = words(lib.jelly_fragments(), triangles, words(lib.jelly_triangles(), 3 * triangles));
    lib.jelly_ids();
    return {times, ends: [numbers()[0], vertices, topology, words(lib.jelly_positions(), 3 * vertices)]};
}

const calls = scene(), list = calls.map(call => call.join(" ") + "\n").join("");
const runners = rest.filter(argument => argument.includes("=")).map(argument => {
    const [name, program] = argument.split("=");
    return {name, vectors: "yes", libc: name.includes("musl") ? "musl" : "native", once() {
        const [times, ends] = execFileSync(program, {input: list, encoding: "utf8"}).trim().split("\n");
        return {times: times.trim().split(" ").map(Number), ends: ends.split(" ").map(Number)};
    }};
});
const modules = [["yes", "jelly-simd.wasm"], ["no", "jelly.wasm"]];
for (const [vectors, name] of modules)
    runners.push({name: "node " + process.versions.node.split(".")[0], vectors, libc: "musl", once: () => run(readFileSync(`${folder}/${name}`), calls)});
const {address, close} = await serve(folder), page = findChromium() ? await openPage(address + "index.html", {width: 64, height: 64}) : null;
if (page) {
    await page.evaluate("page.worker.terminate()"); // it is measured alone
    const version = (await page.evaluate("navigator.userAgent")).match(/Chrome\/(\d+)/)[1];
    for (const [vectors, name] of modules)
        runners.push({name: "Chromium " + version, vectors, libc: "musl", once: () => page.evaluate(
            `fetch("${name}").then(response => response.arrayBuffer()).then(bytes => (${run})(bytes, ${JSON.stringify(calls)}))`)});
} else console.error("web: left out: no chromium");

for (const runner of runners) runner.rounds = [];
for (let round = 0; round < rounds; round++) for (const runner of runners) runner.rounds.push(await runner.once());
await page?.close();
close();

const mean = numbers => numbers.reduce((sum, x) => sum + x, 0) / numbers.length;
const least = (runner, of) => Math.min(...runner.rounds.map(({times}) => of(times.filter((_, i) => i % 2 === 0), times.filter((_, i) => i % 2 === 1))));
const first = least(runners[0], mean);
const rows = ["engine,vectors,step_ms,slowest_ms,skin_ms,ratio,frames_a_second,fragments,vertices,topology,bits"];
for (const runner of runners) {
    const step = least(runner, mean), frame = least(runner, (steps, frame) => mean(frame));
    rows.push([runner.name, runner.vectors, step.toFixed(2), least(runner, steps => Math.max(...steps)).toFixed(2), (frame - step).toFixed(2),
               (step / first).toFixed(2), (1000 / frame).toFixed(0), ...runner.rounds[0].ends].join());
}
writeFileSync(file, rows.join("\n") + "\n");
console.log(rows.join("\n"));
console.error(rows.map(row => row.split(",").map((entry, i) => entry.padStart([18, 8, 8, 11, 8, 6, 16, 10, 9, 11, 11][i])).join("")).join("\n"));
const ends = some => new Set(runners.flatMap(runner => runner.rounds.map(round => some(runner, round.ends)))).size;
if (ends((runner, end) => end[0]) > 1) {
    console.error("web: the numbers of fragments differ");
    process.exitCode = 1;
}
if (ends((runner, end) => `${runner.libc} ${end}`) > new Set(runners.map(runner => runner.libc)).size) {
    console.error("web: what has one C library ends in different bits");
    process.exitCode = 1;
}
