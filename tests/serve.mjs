// A plain file server of one folder, for pages that run in a test or are recorded
import {readFileSync} from "node:fs";
import {createServer} from "node:http";
import {extname, join, normalize} from "node:path";

const types = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm"};

// {address, close()}: at a port of this machine that is free
export async function serve(folder) {
    const server = createServer((request, response) => {
        const path = normalize(request.url.split("?")[0]).replace(/\/$/, "/index.html");
        try {
            const bytes = readFileSync(join(folder, path));
            response.writeHead(200, {"Content-Type": types[extname(path)] ?? "application/octet-stream"}).end(bytes);
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise(done => server.listen(0, "127.0.0.1", done));
    return {address: `http://127.0.0.1:${server.address().port}/`, close: () => server.close()};
}
