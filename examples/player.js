/* player.js: draws frames of a cut body by WebGL2 and plays them. No package, no network.

   contents
     >>frames    GxFrames: reads the frames that a page carries
     >>colours   a colour for each fragment and each cut
     >>camera    GxCamera: orbit, pan, zoom
     >>viewer    GxViewer: draws one frame of arrays; a page with frames of its own needs this alone
     >>player    gxPlay: controls, keys, mouse and touch around a viewer

   A frame is an object:
     mesh        {triangles, fragments, surfaces}, Uint32Array each: three vertices per triangle, counter-clockwise from
                 outside; a number per triangle that its fragment keeps for life; 0: outer surface, else the cut's
                 number. An object that has been shown is not changed: a cut makes a new one
     positions   Float32Array, three per vertex
     normals     Float32Array, three per vertex, of any length
   These are the arrays of gx_body_skin and gx_body_skin_vertices.

   contents of a page, version 1: lines of text
     gxfem-frames 1
     title "TEXT"     a JSON string
     up X Y Z         which way is up
     mesh BASE64      of the frames that follow. 32-bit words: vertices, triangles; then, by triangle: three vertices;
                      by triangle: number of the fragment; by triangle: number of the surface
     frame BASE64     floats: time (s), lowest and highest coordinates (6, m); by vertex: three 16-bit shares of the way
                      from the lowest to the highest coordinate; by vertex: two signed bytes, the normal on the
                      octahedron |x| + |y| + |z| = 127, whose lower half is folded over the upper one
   All is little-endian. Later versions may add lines; unknown ones are passed over. */
"use strict";

/* -------------------------------------------------------------------------------------------------- >>frames */

function gxBytes(base64) {
    const text = atob(base64), bytes = new Uint8Array(text.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
    return new DataView(bytes.buffer);
}

/* Frames are decoded when they are needed: a page holds them as text. Positions are relative to the middle of the
   first frame, so that floats hold them well. */
class GxFrames {
    constructor(text) {
        this.title = "";
        this.up = [0, 0, 1];
        this.frames = []; /* {mesh: text, text, time, low, high} */
        const lines = text.trim().split("\n"), version = lines.shift();
        if (version !== "gxfem-frames 1") throw new Error("no frames that this player knows: '" + version + "'");
        let mesh = "";
        for (const line of lines) {
            const end = line.indexOf(" "), rest = line.slice(end + 1);
            switch (line.slice(0, end)) {
            case "title": this.title = JSON.parse(rest); break;
            case "up": this.up = rest.split(" ").map(Number); break;
            case "mesh": mesh = rest; break;
            case "frame": this.frames.push(this.head(mesh, rest)); break;
            }
        }
        this.meshText = this.mesh = null; /* the mesh decoded last */
        const first = this.frames[0];
        this.origin = first ? first.low.map((x, k) => 0.5 * (x + first.high[k])) : [0, 0, 0];
    }

    get count() { return this.frames.length; }

    head(mesh, text) {
        const view = gxBytes(text.slice(0, 40)), number = i => view.getFloat32(4 * i, true);
        return {mesh, text, time: number(0), low: [1, 2, 3].map(number), high: [4, 5, 6].map(number)};
    }

    /* Lowest and highest corner of a frame, relative to the origin */
    box(i) {
        const {low, high} = this.frames[i];
        return [low, high].map(corner => corner.map((x, k) => x - this.origin[k]));
    }

    readMesh(text) {
        if (text === this.meshText) return this.mesh;
        const view = gxBytes(text), n = view.getUint32(4, true);
        let at = 8;
        const take = count => Uint32Array.from({length: count}, () => view.getUint32((at += 4) - 4, true));
        this.meshText = text;
        return this.mesh = {vertexCount: view.getUint32(0, true), triangles: take(3 * n), fragments: take(n),
                            surfaces: take(n)};
    }

    frame(i) {
        const {mesh: text, text: data, time, low, high} = this.frames[i];
        const mesh = this.readMesh(text), n = mesh.vertexCount, view = gxBytes(data);
        const positions = new Float32Array(3 * n), normals = new Float32Array(3 * n);
        const step = low.map((x, k) => (high[k] - x) / 65535), start = low.map((x, k) => x - this.origin[k]);
        for (let v = 0, at = 28; v < n; v++)
            for (let k = 0; k < 3; k++, at += 2) positions[3 * v + k] = start[k] + step[k] * view.getUint16(at, true);
        for (let v = 0, at = 28 + 6 * n; v < n; v++, at += 2) {
            const x = view.getInt8(at), y = view.getInt8(at + 1), z = 127 - Math.abs(x) - Math.abs(y);
            normals[3 * v] = z >= 0 ? x : (127 - Math.abs(y)) * (x < 0 ? -1 : 1);
            normals[3 * v + 1] = z >= 0 ? y : (127 - Math.abs(x)) * (y < 0 ? -1 : 1);
            normals[3 * v + 2] = z;
        }
        return {mesh, positions, normals, time};
    }
}

/* ------------------------------------------------------------------------------------------------- >>colours */

/* sRGB bytes of a colour by lightness, chroma and hue (degrees) [Ottosson, A perceptual color space, 2020] */
function gxColour(lightness, chroma, hue) {
    const a = chroma * Math.cos(hue * Math.PI / 180), b = chroma * Math.sin(hue * Math.PI / 180);
    const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3;
    const linear = [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                    -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s];
    return linear.map(x => Math.round(255 * (x < 0.0031308 ? 12.92 * Math.max(x, 0)
                                                           : Math.min(1.055 * x ** (1 / 2.4) - 0.055, 1))));
}

/* The n-th of any number of colours. Hues step by an angle, lightness by four levels, so that those of neighbouring
   numbers are far apart; any two of the first 36 differ by 30 in bytes. */
function gxNthColour(n, pale) {
    const hue = 215 + 147 * n, level = n % 4;
    return pale ? gxColour([0.91, 0.85, 0.93, 0.88][level], 0.045, hue)
                : gxColour([0.72, 0.56, 0.80, 0.64][level], 0.130, hue);
}

/* By fragment: its own colour, and a pale one on its cut faces */
function gxFragmentColour(fragment, surface) { return gxNthColour(Math.max(fragment - 1, 0), surface !== 0); }

/* By surface: grey outside, a colour for each cut */
function gxSurfaceColour(fragment, surface) {
    return surface === 0 ? gxColour(0.72, 0.015, 250) : gxNthColour((surface % 4096) + 1, false);
}

/* -------------------------------------------------------------------------------------------------- >>camera */

const gxDot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const gxCross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const gxMix = (a, x, b, y) => [a[0] * x + b[0] * y, a[1] * x + b[1] * y, a[2] * x + b[2] * y];
const gxScaled = (a, x) => [a[0] * x, a[1] * x, a[2] * x];
const gxUnit = a => gxScaled(a, 1 / (Math.hypot(...a) || 1));

/* Looks at a target from a distance; turns about the axis that is up. */
class GxCamera {
    constructor(up) {
        const axis = [0, 0, 0];
        this.up = gxUnit(up);
        axis[(up.map(Math.abs).indexOf(Math.max(...up.map(Math.abs))) + 1) % 3] = 1;
        this.side = gxUnit(gxMix(axis, 1, this.up, -gxDot(axis, this.up)));
        this.front = gxCross(this.up, this.side);
        this.slope = Math.tan(16 * Math.PI / 180); /* half the height of the view at distance 1 */
        this.fit([-1, -1, -1], [1, 1, 1]);
    }

    /* The whole of a box is in view, from a little above. */
    fit(low, high) {
        this.target = gxMix(low, 0.5, high, 0.5);
        this.radius = 0.5 * Math.hypot(...gxMix(high, 1, low, -1)) || 1;
        this.yaw = -55 * Math.PI / 180;
        this.pitch = 24 * Math.PI / 180;
        this.zoom = 1;
    }

    /* Distance at which a box of this radius about fills the narrower side of the view */
    distance(aspect) { return 0.88 * this.radius / this.zoom / Math.min(aspect, 1) / Math.sin(Math.atan(this.slope)); }

    axes() {
        const level = gxMix(this.side, Math.cos(this.yaw), this.front, Math.sin(this.yaw));
        const back = gxMix(level, Math.cos(this.pitch), this.up, Math.sin(this.pitch));
        const right = gxUnit(gxCross(this.up, level));
        return {right, above: gxCross(back, right), back};
    }

    turn(yaw, pitch) {
        const limit = 0.499 * Math.PI;
        this.yaw += yaw;
        this.pitch = Math.min(Math.max(this.pitch + pitch, -limit), limit);
    }

    /* By shares of the view's height */
    pan(x, y, aspect) {
        const {right, above} = this.axes(), size = 2 * this.slope * this.distance(aspect);
        this.target = gxMix(this.target, 1, gxMix(right, -x * size, above, y * size), 1);
    }

    magnify(factor) { this.zoom = Math.min(Math.max(this.zoom * factor, 0.05), 200); }

    /* Columns of the matrix from the world to clip space */
    matrix(aspect) {
        const {right, above, back} = this.axes(), distance = this.distance(aspect);
        const eye = gxMix(this.target, 1, back, distance), far = distance + 60 * this.radius, near = 0.02 * distance;
        const x = 1 / (this.slope * aspect), y = 1 / this.slope, z = (near + far) / (near - far);
        const shift = 2 * near * far / (near - far), columns = [];
        for (let k = 0; k < 3; k++) columns.push(right[k] * x, above[k] * y, back[k] * z, -back[k]);
        columns.push(-gxDot(right, eye) * x, -gxDot(above, eye) * y, shift - gxDot(back, eye) * z, gxDot(back, eye));
        return new Float32Array(columns);
    }
}

/* -------------------------------------------------------------------------------------------------- >>viewer */

const gxVertexShader = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 colour;
uniform mat4 matrix;
uniform mat3 axes; /* columns: right, above, back */
uniform float lift; /* towards the camera, so that lines lie on their faces */
uniform vec4 ground; /* up, and how high it is */
uniform bool shadow; /* straight below each point, on the ground */
out vec3 n;
out vec3 p;
out vec4 c;
void main() {
    p = shadow ? position - ground.xyz * (dot(ground.xyz, position) - ground.w) : position;
    gl_Position = matrix * vec4(p, 1.0);
    gl_Position.z -= lift * gl_Position.w;
    n = normalize(normal) * axes;
    c = colour;
}`;

/* A lamp over the camera's shoulder, a weak one from the other side, light from all around. Colours are multiplied as
   powers of light, not as bytes. */
const gxFragmentShader = `#version 300 es
precision highp float;
in vec3 n;
in vec3 p;
in vec4 c;
uniform vec4 line; /* alpha 0: faces; else all is of this colour */
uniform vec4 fade; /* where it is of full strength, and how far from there it has none; 0: it never fades */
uniform bool flatly;
out vec4 pixel;
void main() {
    if (line.a > 0.0) {
        float left = fade.w > 0.0 ? max(1.0 - length(p - fade.xyz) / fade.w, 0.0) : 1.0;
        pixel = vec4(line.rgb, line.a * left);
        return;
    }
    if (flatly) { pixel = vec4(c.rgb, 1.0); return; }
    vec3 m = normalize(gl_FrontFacing ? n : -n);
    float lamp = max(dot(m, normalize(vec3(-0.35, 0.55, 0.76))), 0.0), fill = max(dot(m, vec3(0.8, 0.0, 0.6)), 0.0);
    float shine = pow(max(dot(m, normalize(vec3(-0.19, 0.30, 0.93))), 0.0), 60.0);
    vec3 light = pow(c.rgb, vec3(2.2)) * (0.20 + 0.10 * m.y + 0.80 * lamp + 0.16 * fill) + 0.05 * shine;
    pixel = vec4(pow(min(light, 1.0), vec3(1.0 / 2.2)), 1.0);
}`;

const gxLines = ["none", "edges", "triangles"];

class GxViewer {
    /* Throws where the browser has no WebGL2. */
    constructor(canvas, up = [0, 0, 1]) {
        this.canvas = canvas;
        this.camera = new GxCamera(up);
        this.colourOf = gxFragmentColour; /* (fragment, surface) => three bytes */
        this.lines = "edges";
        this.flat = false;
        this.background = [1, 1, 1, 1];
        this.ground = null; /* or {height, size, colour}: along up; of its grid, m; of the grid and shadows, RGB to 1 */
        this.gl = canvas.getContext("webgl2", {antialias: true, stencil: true});
        if (!this.gl) throw new Error("WebGL2 is missing");
        this.start();
        canvas.addEventListener("webglcontextlost", event => event.preventDefault());
        canvas.addEventListener("webglcontextrestored", () => {
            this.start();
            if (this.frame) this.show(this.frame);
        });
    }

    /* Everything that lives on the graphics card */
    start() {
        const gl = this.gl, program = gl.createProgram();
        for (const [kind, text] of [[gl.VERTEX_SHADER, gxVertexShader], [gl.FRAGMENT_SHADER, gxFragmentShader]]) {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            gl.attachShader(program, shader);
        }
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
            throw new Error("WebGL2: " + gl.getProgramInfoLog(program));
        gl.useProgram(program);
        this.at = name => gl.getUniformLocation(program, name);
        this.buffers = ["position", "normal", "colour"].map((name, i) => {
            const buffer = gl.createBuffer(), bytes = name === "colour";
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.enableVertexAttribArray(i);
            gl.vertexAttribPointer(i, bytes ? 4 : 3, bytes ? gl.UNSIGNED_BYTE : gl.FLOAT, bytes, 0, 0);
            return buffer;
        });
        this.indices = {};
        for (const name of ["faces", "edges", "triangles"]) this.indices[name] = {buffer: gl.createBuffer(), count: 0};
        this.plain = gl.createVertexArray(); /* of positions alone: the ground's grid */
        gl.bindVertexArray(this.plain);
        this.grid = {buffer: gl.createBuffer(), of: null, count: 0};
        gl.bindBuffer(gl.ARRAY_BUFFER, this.grid.buffer);
        gl.enableVertexAttribArray(0);
        gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
        gl.bindVertexArray(null);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LEQUAL);
        gl.stencilFunc(gl.EQUAL, 0, 255); /* shadows do not add up */
        gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
        gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        this.mesh = this.coloured = null;
    }

    /* A vertex between faces of different colours is drawn once for each: `source` has its vertex. */
    takeMesh(mesh) {
        const {triangles, fragments, surfaces} = mesh, corners = triangles.length;
        const first = new Map(), source = [], drawn = new Uint32Array(corners), owner = [];
        for (let i = 0; i < corners; i++) {
            const t = (i / 3) | 0, key = triangles[i] + "," + fragments[t] + "," + surfaces[t];
            let v = first.get(key);
            if (v === undefined) {
                first.set(key, v = source.length);
                source.push(triangles[i]);
                owner.push(t);
            }
            drawn[i] = v;
        }
        this.mesh = mesh;
        this.source = source;
        this.owner = owner; /* of each drawn vertex: one of its triangles */
        this.arrays = [0, 1].map(() => new Float32Array(3 * source.length));
        this.fill("faces", drawn);
        this.takeLines(triangles, drawn);
        this.coloured = null;
    }

    /* Lines of all triangles; edges are those that only one triangle has: vertices are not shared across creases. */
    takeLines(triangles, drawn) {
        const sides = new Map();
        for (let i = 0; i < drawn.length; i++) {
            const next = i % 3 === 2 ? i - 2 : i + 1, a = triangles[i], b = triangles[next];
            const key = Math.min(a, b) * 4294967296 + Math.max(a, b), side = sides.get(key);
            if (side) side.count++;
            else sides.set(key, {ends: [drawn[i], drawn[next]], count: 1});
        }
        const all = [...sides.values()], ends = list => Uint32Array.from(list.flatMap(side => side.ends));
        this.fill("edges", ends(all.filter(side => side.count === 1)));
        this.fill("triangles", ends(all));
    }

    fill(name, array) {
        const gl = this.gl, indices = this.indices[name];
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices.buffer);
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, array, gl.STATIC_DRAW);
        indices.count = array.length;
    }

    takeColours() {
        const {fragments, surfaces} = this.mesh, bytes = new Uint8Array(4 * this.source.length), known = new Map();
        this.owner.forEach((t, v) => {
            const key = fragments[t] + "," + surfaces[t];
            if (!known.has(key)) known.set(key, this.colourOf(fragments[t], surfaces[t]));
            bytes.set(known.get(key), 4 * v);
        });
        this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffers[2]);
        this.gl.bufferData(this.gl.ARRAY_BUFFER, bytes, this.gl.STATIC_DRAW);
        this.coloured = this.colourOf;
    }

    /* Takes a frame (see above); draw() draws it. */
    show(frame) {
        const gl = this.gl;
        this.frame = frame;
        if (frame.mesh !== this.mesh) this.takeMesh(frame.mesh);
        [frame.positions, frame.normals].forEach((values, i) => {
            const array = this.arrays[i];
            this.source.forEach((v, at) => {
                for (let k = 0; k < 3; k++) array[3 * at + k] = values[3 * v + k];
            });
            gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[i]);
            gl.bufferData(gl.ARRAY_BUFFER, array, gl.DYNAMIC_DRAW);
        });
    }

    drawList(name, kind) {
        const gl = this.gl, {buffer, count} = this.indices[name];
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
        gl.drawElements(kind, count, gl.UNSIGNED_INT, 0);
    }

    /* Lines across and along, ten a size each way */
    takeGrid() {
        const {height, size} = this.ground, {up, side, front} = this.camera, ends = [];
        const point = (a, b) => gxMix(gxMix(up, height, side, a * size), 1, front, b * size);
        for (let i = -10; i <= 10; i++)
            ends.push(...point(i / 10, -1), ...point(i / 10, 1), ...point(-1, i / 10), ...point(1, i / 10));
        this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.grid.buffer);
        this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(ends), this.gl.STATIC_DRAW);
        this.grid.of = this.ground;
        this.grid.count = ends.length / 3;
    }

    /* The ground: shadows and a grid that fades. It is under all, so it hides nothing. */
    drawGround() {
        const gl = this.gl, {height, size, colour} = this.ground, {up} = this.camera;
        if (this.grid.of !== this.ground) this.takeGrid();
        gl.enable(gl.BLEND);
        gl.depthMask(false);
        gl.uniform4f(this.at("ground"), ...up, height);
        gl.uniform4f(this.at("line"), ...colour, 0.2);
        gl.uniform1i(this.at("shadow"), true);
        gl.enable(gl.STENCIL_TEST);
        this.drawList("faces", gl.TRIANGLES);
        gl.disable(gl.STENCIL_TEST);
        gl.uniform1i(this.at("shadow"), false);
        gl.uniform4f(this.at("line"), ...colour, 0.35);
        gl.uniform4f(this.at("fade"), ...gxScaled(up, height), size);
        gl.bindVertexArray(this.plain);
        gl.drawArrays(gl.LINES, 0, this.grid.count);
        gl.bindVertexArray(null);
        gl.uniform4f(this.at("fade"), 0, 0, 0, 0);
        gl.depthMask(true);
    }

    draw() {
        const gl = this.gl, scale = window.devicePixelRatio || 1;
        const width = Math.round(this.canvas.clientWidth * scale) || 1;
        const height = Math.round(this.canvas.clientHeight * scale) || 1;
        if (this.canvas.width !== width) this.canvas.width = width;
        if (this.canvas.height !== height) this.canvas.height = height;
        gl.viewport(0, 0, width, height);
        gl.clearColor(...this.background);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
        if (!this.frame) return;
        if (this.coloured !== this.colourOf) this.takeColours();
        const {right, above, back} = this.camera.axes();
        gl.uniformMatrix4fv(this.at("matrix"), false, this.camera.matrix(width / height));
        gl.uniformMatrix3fv(this.at("axes"), false, new Float32Array([...right, ...above, ...back]));
        gl.uniform1i(this.at("flatly"), this.flat);
        gl.uniform1f(this.at("lift"), 0);
        if (this.ground && !this.flat) this.drawGround();
        gl.uniform4f(this.at("line"), 0, 0, 0, 0);
        gl.disable(gl.BLEND);
        this.drawList("faces", gl.TRIANGLES);
        if (this.lines === "none" || this.flat) return;
        gl.enable(gl.BLEND);
        gl.uniform1f(this.at("lift"), 1e-4);
        gl.uniform4f(this.at("line"), 0.04, 0.06, 0.09, this.lines === "edges" ? 0.55 : 0.4);
        this.drawList(this.lines, gl.LINES);
    }
}

/* -------------------------------------------------------------------------------------------------- >>player */

/* The box to look at: that of the first frame, grown by those of the others up to twice its size. `follow`: all of the
   body leaves the first frame's box, so the camera goes with it. */
function gxStage(frames) {
    const [low, high] = frames.box(0), size = Math.hypot(...gxMix(high, 1, low, -1));
    const all = [low.slice(), high.slice()];
    let follow = false;
    for (let i = 1; i < frames.count; i++) {
        const [a, b] = frames.box(i);
        follow = follow || a.some((x, k) => x > high[k] || b[k] < low[k]);
        for (let k = 0; k < 3; k++) {
            all[0][k] = Math.min(all[0][k], Math.max(a[k], low[k] - 0.5 * size));
            all[1][k] = Math.max(all[1][k], Math.min(b[k], high[k] + 0.5 * size));
        }
    }
    return follow ? {low, high, follow} : {low: all[0], high: all[1], follow};
}

/* Turns, pans and zooms by mouse, pen and fingers. */
function gxSteer(canvas, camera, changed) {
    const pointers = new Map();
    const spread = () => {
        const [a, b] = [...pointers.values()];
        return {x: 0.5 * (a.x + b.x), y: 0.5 * (a.y + b.y), size: Math.hypot(a.x - b.x, a.y - b.y) || 1};
    };
    const aspect = () => canvas.clientWidth / canvas.clientHeight;
    const pan = (x, y) => camera.pan(x / canvas.clientHeight, y / canvas.clientHeight, aspect());
    canvas.addEventListener("pointerdown", event => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    });
    canvas.addEventListener("pointermove", event => {
        const last = pointers.get(event.pointerId), now = {x: event.clientX, y: event.clientY};
        if (!last) return;
        const before = pointers.size > 1 ? spread() : null;
        pointers.set(event.pointerId, now);
        if (before) {
            const after = spread();
            pan(after.x - before.x, after.y - before.y);
            camera.magnify(after.size / before.size);
        } else if (event.shiftKey || event.buttons & 6) {
            pan(now.x - last.x, now.y - last.y);
        } else {
            camera.turn(-0.008 * (now.x - last.x), 0.008 * (now.y - last.y));
        }
        changed();
    });
    for (const name of ["pointerup", "pointercancel"])
        canvas.addEventListener(name, event => pointers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener("wheel", event => {
        event.preventDefault();
        camera.magnify(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
        changed();
    }, {passive: false});
}

/* Plays frames (GxFrames, or an object with the same members) with the controls of player.html. Returns the state: what
   a script may read and turn. */
function gxPlay(frames) {
    const find = id => document.getElementById(id), canvas = find("view");
    const viewer = new GxViewer(canvas, frames.up), camera = viewer.camera, stage = gxStage(frames);
    const player = {frames, viewer, at: -1, playing: false, rate: 30, reset, show, play, draw};
    let due = 0, waiting = false;

    function paint() {
        const [red, green, blue, alpha = 1] = getComputedStyle(document.body).backgroundColor.match(/[\d.]+/g);
        viewer.background = [red / 255, green / 255, blue / 255, Number(alpha)];
        viewer.draw();
    }

    /* Draws at the browser's next turn. */
    function draw() {
        if (!waiting) requestAnimationFrame(tick);
        waiting = true;
    }

    function tick(now) {
        waiting = false;
        if (player.playing) {
            if (now >= due) {
                const last = player.at + 1 >= frames.count - 1;
                show((player.at + 1) % frames.count);
                due = Math.max(due + 1000 / player.rate, now - 500) + (last ? 600 : 0); /* rests on the last */
            }
            draw();
        }
        paint();
    }

    function show(i) {
        const frame = frames.frame(i), mesh = frame.mesh;
        if (stage.follow) {
            const [low, high] = frames.box(i), middle = gxMix(low, 0.5, high, 0.5);
            if (player.middle) camera.target = gxMix(camera.target, 1, gxMix(middle, 1, player.middle, -1), 1);
            player.middle = middle;
        }
        if (mesh !== viewer.mesh) {
            const count = new Set(mesh.fragments).size, n = mesh.triangles.length / 3;
            find("counts").textContent = count + (count === 1 ? " fragment" : " fragments") + ", " +
                                         n.toLocaleString("en") + " triangles";
        }
        viewer.show(frame);
        player.at = i;
        find("scrub").value = i;
        find("number").textContent = (i + 1) + " / " + frames.count;
        find("time").textContent = frame.time.toPrecision(3) + " s";
        draw();
    }

    function play(on) {
        player.playing = on && frames.count > 1;
        find("play").setAttribute("aria-label", player.playing ? "Pause" : "Play");
        document.body.classList.toggle("playing", player.playing);
        due = performance.now();
        draw();
    }

    function stepBy(n) {
        play(false);
        show((player.at + n + frames.count) % frames.count);
    }

    function reset() {
        camera.fit(stage.low, stage.high);
        player.middle = null;
        if (player.at >= 0) show(player.at);
    }

    /* The next choice of a select element */
    function next(id) {
        const select = find(id);
        select.selectedIndex = (select.selectedIndex + 1) % select.length;
        select.dispatchEvent(new Event("change"));
    }

    const keys = {
        " ": () => play(!player.playing), ArrowLeft: () => stepBy(-1), ArrowRight: () => stepBy(1),
        Home: () => stepBy(-player.at), End: () => stepBy(frames.count - 1 - player.at),
        c: () => next("colours"), l: () => next("lines"), r: reset, f: () => { viewer.flat = !viewer.flat; },
        "+": () => camera.magnify(1.25), "-": () => camera.magnify(0.8)
    };
    addEventListener("keydown", event => {
        const key = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
        if (!key || event.ctrlKey || event.metaKey || event.altKey) return;
        if (event.target.tagName === "SELECT" && event.key.length > 1) return;
        event.preventDefault();
        key();
        draw();
    });
    find("play").addEventListener("click", () => play(!player.playing));
    find("scrub").addEventListener("input", event => {
        play(false);
        show(Number(event.target.value));
    });
    find("colours").addEventListener("change", event => {
        viewer.colourOf = event.target.value === "fragment" ? gxFragmentColour : gxSurfaceColour;
        draw();
    });
    find("lines").addEventListener("change", event => {
        viewer.lines = event.target.value;
        draw();
    });
    find("speed").addEventListener("change", event => { player.rate = 30 * Number(event.target.value); });
    find("reset").addEventListener("click", reset);
    addEventListener("resize", draw);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
    gxSteer(canvas, camera, draw);
    find("title").textContent = document.title = frames.title;
    find("scrub").max = frames.count - 1;
    camera.fit(stage.low, stage.high);
    show(0);
    play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    return player;
}
