// A page in headless Chromium, by the DevTools protocol over a pipe. Needs node and Chromium, no package.
//
//     const page = await openPage("build/demo/demo.html", {width: 960, height: 640});
//     await page.evaluate("player.show(3)");
//     const picture = decodePng(await page.screenshot());
//     await page.close();
import {spawn} from "node:child_process";
import {accessSync, constants, mkdtempSync, rmSync} from "node:fs";
import {tmpdir} from "node:os";
import {delimiter, join, resolve} from "node:path";
import {pathToFileURL} from "node:url";
import {inflateSync} from "node:zlib";

function isProgram(path) {
    try {
        accessSync(path, constants.X_OK);
        return true;
    } catch {
        return false;
    }
}

// The browser of this machine, or undefined
export function findChromium() {
    const names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    return names.flatMap(name => process.env.PATH.split(delimiter).map(folder => join(folder, name)))
        .concat("/Applications/Chromium.app/Contents/MacOS/Chromium").find(isProgram);
}

// Messages to and from a browser: JSON, each ended by a zero byte
class Connection {
    constructor(browser) {
        this.input = browser.stdio[3];
        this.waiting = new Map(); // id: {resolve, reject}
        this.listeners = [];      // (method, params)
        this.last = 0;
        let rest = "";
        browser.stdio[4].setEncoding("utf8").on("data", text => {
            const messages = (rest + text).split("\0");
            rest = messages.pop();
            for (const message of messages) this.take(JSON.parse(message));
        });
        browser.on("exit", () => {
            for (const {reject} of this.waiting.values()) reject(new Error("the browser ended"));
        });
        this.input.on("error", () => {});
    }

    take({id, method, params, result, error}) {
        if (method) this.listeners.forEach(listener => listener(method, params));
        const caller = this.waiting.get(id);
        if (!caller) return;
        this.waiting.delete(id);
        if (error) caller.reject(new Error(error.message));
        else caller.resolve(result);
    }

    send(method, params = {}, sessionId = undefined) {
        const id = ++this.last;
        this.input.write(JSON.stringify({id, method, params, sessionId}) + "\0");
        return new Promise((resolve, reject) => this.waiting.set(id, {resolve, reject}));
    }
}

// Opens a file, or a page by its address (http:).
//     options      width, height; scale: pixels of the screen for one of the page; dark: the user prefers dark;
//                  before: a script that runs before those of the page
//     page.errors  what went wrong on the page so far
//     page.requests  addresses that it asked for
export async function openPage(path, {width = 960, height = 640, scale = 1, dark = false, before = ""} = {}) {
    const profile = mkdtempSync(join(tmpdir(), "chromium-"));
    const flags = ["--headless=new", "--remote-debugging-pipe", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                   "--no-first-run", "--disable-background-networking", "--user-data-dir=" + profile];
    if (process.getuid?.() === 0) flags.push("--no-sandbox");
    const browser = spawn(findChromium(), flags, {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
    const ended = new Promise(done => browser.on("exit", done).on("error", done));
    const connection = new Connection(browser);
    const {targetId} = await connection.send("Target.createTarget", {url: "about:blank"});
    const {sessionId} = await connection.send("Target.attachToTarget", {targetId, flatten: true});
    const send = (method, params) => connection.send(method, params, sessionId);
    const page = {errors: [], requests: [], send};

    connection.listeners.push((method, params) => {
        if (method === "Runtime.exceptionThrown") page.errors.push(params.exceptionDetails.exception?.description);
        if (method === "Runtime.consoleAPICalled" && params.type === "error")
            page.errors.push(params.args.map(argument => argument.value ?? argument.description).join(" "));
        if (method === "Log.entryAdded" && params.entry.level === "error") page.errors.push(params.entry.text);
        if (method === "Network.requestWillBeSent") page.requests.push(params.request.url);
    });

    // The value of an expression, awaited if it is a promise
    page.evaluate = async expression => {
        const options = {expression, awaitPromise: true, returnByValue: true};
        const {result, exceptionDetails} = await send("Runtime.evaluate", options);
        if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        return result.value;
    };

    // PNG of what is seen. transparent: without the page's background
    page.screenshot = async ({transparent = false} = {}) => {
        const color = {r: 0, g: 0, b: 0, a: 0};
        await send("Emulation.setDefaultBackgroundColorOverride", transparent ? {color} : {});
        return Buffer.from((await send("Page.captureScreenshot", {format: "png"})).data, "base64");
    };

    page.mouse = (type, x, y, more = {}) => send("Input.dispatchMouseEvent", {type, x, y, ...more});

    page.drag = async (from, to, more = {}) => {
        const button = {button: "left", buttons: 1, clickCount: 1, ...more};
        await page.mouse("mousePressed", ...from, button);
        for (let i = 1; i <= 4; i++)
            await page.mouse("mouseMoved", ...from.map((x, k) => x + (to[k] - x) * i / 4), button);
        await page.mouse("mouseReleased", ...to, button);
    };

    page.touch = (type, points) =>
        send("Input.dispatchTouchEvent", {type, touchPoints: points.map(([x, y]) => ({x, y}))});

    // Controls know keys that have a name by their codes.
    const codes = {Tab: 9, Enter: 13, " ": 32, End: 35, Home: 36, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40};
    page.key = async (key, text = undefined, more = {}) => {
        const event = {key, windowsVirtualKeyCode: codes[key], ...more};
        await send("Input.dispatchKeyEvent", {type: "keyDown", text, ...event});
        await send("Input.dispatchKeyEvent", {type: "keyUp", ...event});
    };

    page.close = async () => {
        await connection.send("Browser.close").catch(() => {});
        await ended;
        rmSync(profile, {recursive: true, force: true, maxRetries: 5});
    };

    await Promise.all(["Page", "Runtime", "Log", "Network"].map(domain => send(domain + ".enable")));
    await send("Emulation.setDeviceMetricsOverride", {width, height, deviceScaleFactor: scale, mobile: false});
    const scheme = {name: "prefers-color-scheme", value: dark ? "dark" : "light"};
    await send("Emulation.setEmulatedMedia", {features: [scheme]});
    if (before) await send("Page.addScriptToEvaluateOnNewDocument", {source: before});
    const loaded = new Promise(done => connection.listeners.push(method => method === "Page.loadEventFired" && done()));
    await send("Page.navigate", {url: /^https?:/.test(path) ? path : pathToFileURL(resolve(path)).href});
    await loaded;
    return page;
}

// {width, height, pixel(x, y)}: bytes of red, green, blue. Of PNG files with 8 bits a channel, not interlaced
export function decodePng(bytes) {
    const chunks = [];
    let at = 8, width = 0, height = 0, size = 0;
    for (let length; at < bytes.length; at += length + 12) {
        const data = bytes.subarray(at + 8, at + 8 + (length = bytes.readUInt32BE(at)));
        switch (bytes.toString("latin1", at + 4, at + 8)) {
        case "IHDR":
            [width, height, size] = [data.readUInt32BE(0), data.readUInt32BE(4), data[9] === 6 ? 4 : 3];
            break;
        case "IDAT": chunks.push(data); break;
        }
    }
    const raw = inflateSync(Buffer.concat(chunks)), row = width * size, out = Buffer.alloc(row * height);
    for (let y = 0, i = 0; y < height; y++) {
        const filter = raw[y * (row + 1)];
        for (let x = 0; x < row; x++, i++) {
            const a = x < size ? 0 : out[i - size], b = y ? out[i - row] : 0;
            const c = x < size || !y ? 0 : out[i - row - size];
            const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
            const paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
            out[i] = raw[y * (row + 1) + 1 + x] + [0, a, b, (a + b) >> 1, paeth][filter];
        }
    }
    return {width, height, pixel: (x, y) => [0, 1, 2].map(k => out[(y * width + x) * size + k])};
}
