/* open_cgal.cc - CGAL's corefinement as a runner of the Open Boolean Benchmark, in the frame that ours has (gxrunner.h).
   Its kernel constructs points exactly and lazily: "Corefine (EPEC)" of the benchmark. Unions, intersections and
   differences of two solids.

       open_cgal --request FILE --result FILE */
#include "open_runner.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Surface_mesh.h>
#include <exception>
#include <vector>

typedef CGAL::Exact_predicates_exact_constructions_kernel Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> Mesh;

struct Meshes {
    std::vector<Mesh> solids;
    std::vector<double> vertices;
    std::vector<uint32_t> triangles;
};

static Meshes &meshes_of(const gxrunner_run *run) { return *static_cast<Meshes *>(run->native); }

static int fail(gxrunner_outcome *o, const char *status, const char *why) {
    o->status = status;
    return gxio_fail(&o->error, "CGAL", 0, "%s", why);
}

static int start(gxrunner_run *run, gxrunner_outcome *) {
    Meshes *meshes = new Meshes;
    meshes->solids.resize(run->count);
    run->native = meshes;
    return 1;
}

static void stop(gxrunner_run *run) { delete &meshes_of(run); }

static int load(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    const gxio_surface &s = run->solids[i].surface;
    Mesh &mesh = meshes_of(run).solids[i];
    std::vector<Mesh::Vertex_index> vertex;
    for (size_t v = 0; v < s.vertex_count; v++)
        vertex.push_back(mesh.add_vertex(Kernel::Point_3(s.vertices[3 * v], s.vertices[3 * v + 1], s.vertices[3 * v + 2])));
    for (size_t t = 0; t < s.triangle_count; t++) {
        const uint32_t *n = s.triangles + 3 * t;
        if (mesh.add_face(vertex[n[0]], vertex[n[1]], vertex[n[2]]) == Mesh::null_face())
            return fail(o, "invalid_input", "the surface is no manifold");
    }
    return CGAL::is_closed(mesh) ? 1 : fail(o, "invalid_input", "the surface is not closed");
}

/* A solid to be changed: itself, if no later operation takes it */
static Mesh take(gxrunner_run *run, size_t solid, size_t i) {
    Mesh &mesh = meshes_of(run).solids[solid];
    return run->solids[solid].last_use > i ? mesh : std::move(mesh);
}

static int combine(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    namespace PMP = CGAL::Polygon_mesh_processing;
    const gxrunner_solid &s = run->solids[i];
    Mesh &result = meshes_of(run).solids[i];
    if (s.arg_count != 2 || s.args[0] == s.args[1]) return fail(o, "unsupported", "takes two solids only");
    try {
        Mesh a = take(run, s.args[0], i), b = take(run, s.args[1], i);
        bool good;
        switch (s.operation) {
        case GXRUNNER_UNION: good = PMP::corefine_and_compute_union(a, b, result); break;
        case GXRUNNER_INTERSECTION: good = PMP::corefine_and_compute_intersection(a, b, result); break;
        default: good = PMP::corefine_and_compute_difference(a, b, result);
        }
        return good ? 1 : fail(o, "invalid_output", "the result is no manifold");
    } catch (const std::exception &e) {
        return fail(o, "crash", e.what());
    }
}

static int output(gxrunner_run *run, size_t i, gxio_shell *shell, gxrunner_outcome *) {
    Meshes &meshes = meshes_of(run);
    Mesh &mesh = meshes.solids[i];
    mesh.collect_garbage();
    meshes.vertices.clear();
    meshes.triangles.clear();
    for (Mesh::Vertex_index v : mesh.vertices())
        for (int k = 0; k < 3; k++) meshes.vertices.push_back(CGAL::to_double(mesh.point(v)[k]));
    for (Mesh::Face_index f : mesh.faces())
        for (Mesh::Vertex_index v : CGAL::vertices_around_face(mesh.halfedge(f), mesh))
            meshes.triangles.push_back(static_cast<uint32_t>(v));
    shell->vertices = meshes.vertices.data();
    shell->vertex_count = meshes.vertices.size() / 3;
    shell->triangles = meshes.triangles.data();
    shell->triangle_count = meshes.triangles.size() / 3;
    return 1;
}

int main(int argc, char **argv) {
    const gxrunner_engine engine = {NULL, start, stop, load, combine, output};
    return open_run("open_cgal", &engine, argc, argv);
}
