/* open_manifold.cc - manifold as a runner of the Open Boolean Benchmark, natively, in the frame that ours has (gxrunner.h).
   Where it is not installed, open_manifold.mjs runs its WebAssembly build.

       open_manifold --request FILE --result FILE */
#include "open_runner.h"

#include <manifold/manifold.h>
#include <vector>

struct Solids {
    std::vector<manifold::Manifold> solids;
    manifold::MeshGL64 mesh;
    std::vector<uint32_t> triangles;
};

static Solids &solids_of(const gxrunner_run *run) { return *static_cast<Solids *>(run->native); }

static int start(gxrunner_run *run, gxrunner_outcome *) {
    Solids *solids = new Solids;
    solids->solids.resize(run->count);
    run->native = solids;
    return 1;
}

static void stop(gxrunner_run *run) { delete &solids_of(run); }

/* Makes it, since it is lazy. */
static int check(const manifold::Manifold &solid, const char *status, gxrunner_outcome *o) {
    if (solid.Status() == manifold::Manifold::Error::NoError) return 1;
    o->status = status;
    return gxio_fail(&o->error, "manifold", 0, "error %d", static_cast<int>(solid.Status()));
}

static int load(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    const gxio_surface &s = run->solids[i].surface;
    manifold::Manifold &solid = solids_of(run).solids[i];
    manifold::MeshGL64 mesh;
    mesh.numProp = 3;
    mesh.vertProperties.assign(s.vertices, s.vertices + 3 * s.vertex_count);
    mesh.triVerts.assign(s.triangles, s.triangles + 3 * s.triangle_count);
    solid = manifold::Manifold(mesh);
    return check(solid, "invalid_input", o);
}

static int combine(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    static const manifold::OpType kinds[] = {manifold::OpType::Add, manifold::OpType::Intersect, manifold::OpType::Subtract};
    const gxrunner_solid &s = run->solids[i];
    std::vector<manifold::Manifold> &solids = solids_of(run).solids;
    solids[i] = solids[s.args[0]];
    for (size_t k = 1; k < s.arg_count; k++) solids[i] = solids[i].Boolean(solids[s.args[k]], kinds[s.operation]);
    if (!check(solids[i], "crash", o)) return 0;
    for (size_t k = 0; k < s.arg_count; k++)
        if (run->solids[s.args[k]].last_use == i) solids[s.args[k]] = manifold::Manifold();
    return 1;
}

static int output(gxrunner_run *run, size_t i, gxio_shell *shell, gxrunner_outcome *) {
    Solids &solids = solids_of(run);
    solids.mesh = solids.solids[i].GetMeshGL64();
    solids.triangles.assign(solids.mesh.triVerts.begin(), solids.mesh.triVerts.end());
    shell->vertices = solids.mesh.vertProperties.data();
    shell->vertex_count = solids.mesh.vertProperties.size() / 3;
    shell->triangles = solids.triangles.data();
    shell->triangle_count = solids.triangles.size() / 3;
    return 1;
}

int main(int argc, char **argv) {
    const gxrunner_engine engine = {NULL, start, stop, load, combine, output};
    return open_run("open_manifold", &engine, argc, argv);
}
