// open_manifold.mjs - manifold-3d (WebAssembly) as a runner of the Open Boolean Benchmark: unions, intersections and differences of
// two or more solids, .off in and out. Only solids that no later operation takes are written.
// usage: node open_manifold.mjs MODULE --request FILE --result FILE
//     MODULE  manifold.js of the npm package manifold-3d
import { readFileSync, writeFileSync } from 'node:fs'
import { pathToFileURL } from 'node:url'
import { resolve } from 'node:path'

const [module, , requestPath, , resultPath] = process.argv.slice(2)
const wasm = await (await import(pathToFileURL(resolve(module)))).default()
wasm.setup()
const { Manifold, Mesh } = wasm
const operations = { 'boolean-union': Manifold.union, 'boolean-intersection': Manifold.intersection, 'boolean-difference': Manifold.difference }

function readOff(path) {
    const numbers = readFileSync(path, 'latin1').slice(3).trim().split(/\s+/).map(Number)
    const [vertices, faces] = numbers
    const triVerts = new Uint32Array(3 * faces)
    for (let f = 0; f < faces; f++)
        for (let k = 0; k < 3; k++) triVerts[3 * f + k] = numbers[3 + 3 * vertices + 4 * f + 1 + k]
    return { numProp: 3, vertProperties: Float32Array.from(numbers.slice(3, 3 + 3 * vertices)), triVerts }
}

function writeOff(path, mesh) {
    const lines = ['OFF', `${mesh.vertProperties.length / 3} ${mesh.triVerts.length / 3} 0`]
    for (let v = 0; v < mesh.vertProperties.length; v += 3) lines.push(mesh.vertProperties.slice(v, v + 3).join(' '))
    for (let t = 0; t < mesh.triVerts.length; t += 3) lines.push(`3 ${mesh.triVerts.slice(t, t + 3).join(' ')}`)
    writeFileSync(path, lines.join('\n') + '\n')
}

// Does one operation; what is lazy is done by asking for the result's status.
function operate(run, operation, i, solids, last) {
    const start = performance.now()
    const outcome = { status: 'success' }
    if (operation.op === 'load-mesh') {
        const mesh = readOff(operation.path)
        const read = performance.now()
        outcome.io_ms = read - start
        solids[i] = new Manifold(new Mesh(mesh))
        solids[i].status()
        outcome.import_ms = performance.now() - read
    } else {
        solids[i] = operations[operation.op](operation.args.map((a) => solids[a]))
        solids[i].numTri()
        outcome.operation_ms = performance.now() - start
        for (const a of operation.args) if (last[a] === i) solids[a]?.delete(), solids[a] = undefined
    }
    outcome.file = ''
    if (last[i] === undefined) {
        const made = performance.now()
        const mesh = solids[i].getMesh()
        outcome.export_ms = performance.now() - made
        outcome.file = `${run.out_dir}/op_${i}.off`
        writeOff(outcome.file, mesh)
    }
    outcome.debug_total_ms = performance.now() - start
    return outcome
}

function execute(run) {
    const start = performance.now(), solids = [], ops = [], last = []
    run.operations.forEach((operation, i) => (operation.args ?? []).forEach((a) => (last[a] = i)))
    let status = 'success'
    for (const [i, operation] of run.operations.entries()) {
        try {
            ops.push(operate(run, operation, i, solids, last))
        } catch (error) {
            status = operation.op === 'load-mesh' ? 'invalid_input' : 'crash'
            ops.push({ status, debug_total_ms: 0, file: '', error: String(error.message ?? error) })
            break
        }
    }
    return { case_id: run.case_id, status, duration_ms: performance.now() - start, ops }
}

const request = JSON.parse(readFileSync(requestPath, 'utf8'))
const runs = request.runs.map(execute)
writeFileSync(resultPath, JSON.stringify({ kind: request.kind, version: request.version, id: request.id, runs }, null, 1))
process.exit(runs.every((run) => run.status === 'success') ? 0 : 1)
