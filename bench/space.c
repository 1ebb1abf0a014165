/* space.c - the error of the space: the same cuts in finer and finer meshes, beside fine meshes whose faces lie on
   the cuts.

   make bench-space builds and runs it. It prints CSV and writes it to build/bench/space.csv, and a table to stderr.
   usage: space [FILE [--small]].

   Strips of two scenes, one cube of 1 m wide, of linear elastic material, at rest under gravity. So there is no
   error of time steps, of large motion or of integrals. Since all is linear, drops have a meaning relative to each
   other only.
       slices      of slab_in_five: 6 x 1 x 1 cubes held at one end, four planes, slices of 1/15 to 5/15 of a cube;
                   the drop of each slice's end
       accordion   of accordion: 16 x 1 x 16 cubes held by the top, six cuts from both sides in turn, each through
                   7/8; the drop of the middle of the bottom

   Methods, by refinement (cubes along the edge of a cube):
       cut         the mesh, cut: the library's copies and integrals. RXFEM has the same space
       affine      the same with affine copies where material is thinner than an element (gx_body_desc.affine_below);
                   the accordion's folds are thicker, so it has none
       VNA         the same copies, each part with all of its element's mass and stiffness (vna.h)
       deletion    elements that cuts meet are removed (parts.h)
       conforming  nodes lie on the cuts. slices: cubes through the thickness of each; accordion: cubes of the mesh,
                   made less high

   truth: drops of conforming meshes are 1/d = 1/d0 + c h^2, a stiffness and the share of locking. d0 comes from the
   two finest meshes. In the row "truth", error is the distance of the d0 from one mesh coarser.

   Columns: scene; piece; method; refinement; thickness of the piece in elements; unknowns; drop, m; truth, m; error:
   |drop / truth - 1|. No drop: nothing of the piece is left. */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../examples/gxio.h"
#define BENCH "space"
#include "expect.h"
#include "csv.h"
#include "progress.h"
#include "part.h"
#include "rxfem_model.h"
#include "sampling.h"
#include "parts.h"
#include "vna.h"

enum {
    PIECES = 5,
    FOLDS = 6,
    LEVELS = 2 * FOLDS + 2,
    CORNERS = 4,
    CUT = 0,
    AFFINE,
    VNA,
    DELETION,
    CONFORMING,
    METHODS
};

static const char *const method_names[METHODS] = {"cut", "affine", "VNA", "deletion", "conforming"};
static const double density = 1000, young = 3e7, poisson = 0.4, gravity = -9.81;

/* ---- what is compared ---- */

/* A horizontal rectangle at z, from x[0] to x[1], wider than the strip */
typedef struct flat {
    double z, x[2];
} flat;

typedef struct strip {
    const char *name;
    uint32_t cubes[3]; /* of refinement 1; the edge is 1 m */
    gx_region held;
    flat cuts[FOLDS];
    size_t cut_count;
    size_t piece_count;
    double low[PIECES], high[PIECES]; /* z of each piece */
    double point[PIECES][3];          /* point of each at which its drop is measured */
    double truth[PIECES], trust[PIECES];
} strip;

static strip make_slices(uint32_t length) {
    static const double z[PIECES + 1] = {0, 1.0 / 15, 3.0 / 15, 6.0 / 15, 10.0 / 15, 1};
    const gx_region wall = gx_region_half_space(0, -1, 1e-9);
    strip s;
    size_t i;
    memset(&s, 0, sizeof s);
    s.name = "slices";
    s.cubes[0] = length;
    s.cubes[1] = s.cubes[2] = 1;
    s.held = wall;
    s.cut_count = PIECES - 1;
    s.piece_count = PIECES;
    for (i = 0; i < PIECES; i++) {
        const flat cut = {z[i + 1], {-9, 99}};
        if (i < s.cut_count) s.cuts[i] = cut;
        s.low[i] = z[i];
        s.high[i] = z[i + 1];
        s.point[i][0] = length;
        s.point[i][1] = 0.5;
        s.point[i][2] = 0.5 * (z[i] + z[i + 1]);
    }
    return s;
}

/* Where the scene's cuts lie, in cubes. Ends are on planes of nodes. */
static strip make_accordion(uint32_t cubes, size_t folds) {
    const gx_region top = gx_region_half_space(2, 1, cubes - 1e-9);
    strip s;
    size_t i;
    memset(&s, 0, sizeof s);
    s.name = "accordion";
    s.cubes[0] = s.cubes[2] = cubes;
    s.cubes[1] = 1;
    s.held = top;
    s.cut_count = folds;
    for (i = 0; i < folds; i++) {
        s.cuts[i].z = 2.2711 + 2.5137 * (double)i;
        s.cuts[i].x[0] = -9;
        s.cuts[i].x[1] = 99;
        s.cuts[i].x[i % 2 == 0] = i % 2 ? cubes / 8 : cubes - cubes / 8;
    }
    s.piece_count = 1;
    s.high[0] = s.cuts[0].z;
    s.point[0][0] = 0.5 * cubes;
    s.point[0][1] = 0.5;
    return s;
}

/* ---- meshes and bodies ---- */

/* n cubes along each axis of a box that begins at the origin */
static gxio_mesh make_grid(const size_t n[3], const double size[3]) {
    gxio_mesh mesh;
    gxio_error error;
    char spec[64];
    size_t i;
    snprintf(spec, sizeof spec, "grid:%lu,%lu,%lu", (unsigned long)n[0], (unsigned long)n[1], (unsigned long)n[2]);
    expect(gxio_mesh_load(spec, &mesh, &error), "no grid");
    for (i = 0; i < 3 * mesh.node_count; i++) mesh.positions[i] *= size[i % 3] / (double)n[i % 3];
    return mesh;
}

/* Cubes of the mesh's width whose layers end on the cuts. Each band has the number of layers that comes closest to
   cubes. */
static gxio_mesh make_layers(const strip *s, uint32_t refinement) {
    const double top = s->cubes[2];
    double levels[1024];
    size_t n[3], i, k, count = 0;
    double size[3], low = 0;
    gxio_mesh mesh;
    for (i = 0; i <= s->cut_count; i++) {
        const double high = i < s->cut_count ? s->cuts[i].z : top;
        const size_t layers =
            (size_t)((high - low) * refinement + 0.5) > 0 ? (size_t)((high - low) * refinement + 0.5) : 1;
        for (k = 0; k < layers; k++) levels[count++] = low + (high - low) * (double)k / (double)layers;
        low = high;
    }
    expect(count < sizeof levels / sizeof levels[0], "too many layers");
    levels[count] = top;
    for (i = 0; i < 3; i++) {
        n[i] = (size_t)s->cubes[i] * refinement;
        size[i] = s->cubes[i];
    }
    n[2] = count;
    size[2] = (double)count;
    mesh = make_grid(n, size);
    for (i = 0; i < mesh.node_count; i++) mesh.positions[3 * i + 2] = levels[(size_t)(mesh.positions[3 * i + 2] + 0.5)];
    return mesh;
}

/* affine_below: as gx_body_desc */
static gx_body *make_body(const gxio_mesh *mesh, const gx_region *held, double affine_below) {
    gx_material material;
    gx_body_desc desc;
    gx_body *body;
    memset(&material, 0, sizeof material);
    memset(&desc, 0, sizeof desc);
    material.elastic.kind = GXS_LINEAR;
    material.elastic.young = young;
    material.elastic.poisson = poisson;
    material.density = density;
    desc.positions = mesh->positions;
    desc.node_count = mesh->node_count;
    desc.elements = mesh->elements;
    desc.element_count = mesh->element_count;
    desc.materials = &material;
    desc.material_count = 1;
    desc.affine_below = affine_below;
    expect(gx_body_create(&desc, &body, NULL) == GX_OK, "no body");
    expect(gx_body_hold(body, held, 1, NULL) == GX_OK, "nothing is held");
    return body;
}

static void cut_body(gx_body *body, const strip *s) {
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    double vertices[FOLDS][12];
    gx_surface sheets[FOLDS];
    gx_cut_desc desc;
    size_t i;
    int k;
    memset(sheets, 0, sizeof sheets);
    memset(&desc, 0, sizeof desc);
    for (i = 0; i < s->cut_count; i++) {
        for (k = 0; k < CORNERS; k++) {
            vertices[i][3 * k] = s->cuts[i].x[k == 1 || k == 2];
            vertices[i][3 * k + 1] = k < 2 ? -9 : 9;
            vertices[i][3 * k + 2] = s->cuts[i].z;
        }
        sheets[i].vertices = vertices[i];
        sheets[i].vertex_count = CORNERS;
        sheets[i].triangles = triangles;
        sheets[i].triangle_count = 2;
    }
    desc.surfaces = sheets;
    desc.surface_count = s->cut_count;
    expect(gx_body_cut(body, &desc, NULL, NULL) == GX_OK, "a cut fails");
}

/* ---- rest ---- */

/* The first of a copy's hidden vectors, or GXS_NOT_AFFINE */
static uint32_t hidden_of(const gxs_model *m, uint32_t copy) { return m->affine ? m->affine[copy] : GXS_NOT_AFFINE; }

/* Displacements at rest, with hidden vectors; copies on no element are held. unknowns: of the others */
static double *find_rest(const gxs_model *given, size_t *unknowns) {
    const size_t count = given->copy_count;
    double *displacement = (double *)memory(3 * count, sizeof(double)),
           *velocity = (double *)memory(3 * count, sizeof(double));
    uint8_t *used = (uint8_t *)memory(count, 1), *held = (uint8_t *)memory(count, 1);
    gxs_model model = *given;
    gxs_step_desc step;
    gxs_solver *solver;
    size_t i;
    for (i = 0; i < 4 * model.element_count; i++) {
        const uint32_t copy = model.elements[i / 4].copy[i % 4], hidden = hidden_of(&model, copy);
        used[copy] = 1;
        if (hidden != GXS_NOT_AFFINE) memset(used + hidden, 1, 3);
    }
    for (*unknowns = i = 0; i < count; i++) {
        held[i] = !used[i] || given->held[i];
        *unknowns += 3 * (size_t)used[i];
    }
    model.held = held;
    memset(&step, 0, sizeof step);
    step.integrator = GXS_STATIC;
    step.gravity[2] = gravity;
    step.newton_iterations = 1000;
    step.newton_tolerance = 1e-7;
    step.cg_tolerance = 1e-4;
    expect(gxs_solver_create(NULL, &solver, NULL) == GX_OK && gxs_solver_set_model(solver, &model, NULL) == GX_OK,
           "no model");
    expect(gxs_solver_step(solver, &step, displacement, velocity, NULL, NULL) == GX_OK, "no rest is found");
    gxs_solver_destroy(solver);
    free(velocity);
    free(used);
    free(held);
    return displacement;
}

/* Barycentric coordinates */
static void locate(const gxs_model *m, const gxs_element *e, const double x[3], double at[4]) {
    const double *origin = m->positions + 3 * (size_t)e->copy[0];
    int i, k;
    for (i = 0; i < 4; i++)
        for (at[i] = i == 0, k = 0; k < 3; k++) at[i] += e->gradient[i][k] * (x[k] - origin[k]);
}

/* The displacement along z of a material point of an element, at its barycentric coordinates */
static double displacement_at(const gxs_model *m, const gxs_element *e, const double x[3], const double at[4],
                              const double *displacement) {
    double sum = 0;
    int i, k;
    for (i = 0; i < 4; i++) {
        const uint32_t copy = e->copy[i], hidden = hidden_of(m, copy);
        sum += at[i] * displacement[3 * (size_t)copy + 2];
        for (k = 0; k < 3 && hidden != GXS_NOT_AFFINE; k++)
            sum += at[i] * (x[k] - m->positions[3 * (size_t)copy + (size_t)k]) / m->affine_length *
                   displacement[3 * ((size_t)hidden + (size_t)k) + 2];
    }
    return sum;
}

/* z of the part's centre of mass */
static double height(const gxs_model *m, const gxs_element *e) {
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    double z = 0, mass = 0;
    int i, j;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++) {
            z += e->mass[row[i][j]] * m->positions[3 * (size_t)e->copy[i] + 2];
            mass += e->mass[row[i][j]];
        }
    return z / mass;
}

/* The drop of the piece's point, by the part of the piece that contains it or is closest to it; 0: no part is left.
   pieces: the model whose parts say which piece each element belongs to */
static double drop_of(const strip *s, size_t piece, const gxs_model *m, const gxs_element *pieces,
                      const double *displacement) {
    double best = -HUGE_VAL, drop = 0;
    size_t i;
    for (i = 0; i < m->element_count; i++) {
        const gxs_element *e = &m->elements[i];
        const double z = height(m, &pieces[i]);
        double at[4], least;
        if (z < s->low[piece] || z > s->high[piece]) continue;
        locate(m, e, s->point[piece], at);
        least = fmin(fmin(at[0], at[1]), fmin(at[2], at[3]));
        if (least <= best) continue;
        best = least;
        drop = -displacement_at(m, e, s->point[piece], at, displacement);
    }
    return drop;
}

/* ---- rows ---- */

static size_t done, total;

static void print_row(const strip *s, size_t piece, int method, uint32_t refinement, double thickness, size_t unknowns,
                      double drop) {
    char value[64] = ",", error[32] = "";
    if (drop > 0) {
        snprintf(value, sizeof value, "%.6g", drop);
        snprintf(error, sizeof error, "%.3e", fabs(drop / s->truth[piece] - 1));
    } else
        value[0] = 0;
    csv_row("%s,%lu,%s,%lu,%.4g,%lu,%s,%.6g,%s", s->name, (unsigned long)piece + 1, method_names[method],
            (unsigned long)refinement, thickness, (unsigned long)unknowns, value, s->truth[piece], error);
    fprintf(stderr, "%-10s %5lu %-11s %10lu %12.4g %9lu %12s %12s\n", s->name, (unsigned long)piece + 1,
            method_names[method], (unsigned long)refinement, thickness, (unsigned long)unknowns,
            drop > 0 ? value : "nothing left", error);
}

/* Thickness of a piece in cubes; of a fold: the distance between two cuts */
static double thickness_of(const strip *s, size_t piece) {
    return s->piece_count > 1 ? s->high[piece] - s->low[piece] : s->cuts[1].z - s->cuts[0].z;
}

/* Rows of one method in the cut body; affine: with affine copies; uncut: the same mesh */
static void run_method(const strip *s, const parts_body *p, const gxs_model *affine, const gxs_model *uncut, int method,
                       uint32_t refinement) {
    gxs_model m = method == AFFINE ? *affine : method == DELETION ? *uncut : p->model;
    gxs_element *elements = (gxs_element *)memory(m.element_count, sizeof *elements);
    const gxs_element *pieces = method == VNA ? m.elements : elements;
    double *rest = NULL;
    size_t unknowns = 0, i;
    progress_draw("space", done++, total, s->name);
    if (method == DELETION)
        m.element_count = parts_delete(p, uncut, elements);
    else if (method == VNA)
        vna_replicate(m.elements, m.element_count, &density, elements);
    else
        memcpy(elements, m.elements, m.element_count * sizeof *elements);
    m.elements = elements;
    if (m.element_count > 0) rest = find_rest(&m, &unknowns);
    for (i = 0; i < s->piece_count; i++)
        print_row(s, i, method, refinement, refinement * thickness_of(s, i), unknowns,
                  rest ? drop_of(s, i, &m, pieces, rest) : 0);
    free(rest);
    free(elements);
}

static void run_cut(const strip *s, uint32_t refinement) {
    size_t n[3], i;
    double size[3];
    gxio_mesh mesh;
    gx_body *body, *affine_body, *uncut_body;
    gxs_model affine, uncut;
    parts_body p;
    int method;
    for (i = 0; i < 3; i++) {
        n[i] = (size_t)s->cubes[i] * refinement;
        size[i] = s->cubes[i];
    }
    mesh = make_grid(n, size);
    body = make_body(&mesh, &s->held, 0);
    affine_body = make_body(&mesh, &s->held, 1);
    uncut_body = make_body(&mesh, &s->held, 0);
    cut_body(body, s);
    cut_body(affine_body, s);
    p = parts_create(body);
    expect(gx_body_model(affine_body, &affine, NULL) == GX_OK, "no model");
    expect(gx_body_model(uncut_body, &uncut, NULL) == GX_OK, "no model");
    for (method = CUT; method < CONFORMING; method++) run_method(s, &p, &affine, &uncut, method, refinement);
    parts_free(&p);
    gx_body_destroy(body);
    gx_body_destroy(affine_body);
    gx_body_destroy(uncut_body);
    gxio_mesh_release(&mesh);
}

/* A slice by itself, `refinement` cubes through its thickness, or the strip in layers that end on its cuts. Returns
   the drop. */
static double run_conforming(const strip *s, size_t piece, uint32_t refinement, size_t *unknowns) {
    gxio_mesh mesh;
    gx_body *body;
    gxs_model model;
    double *rest, drop;
    progress_draw("space", done++, total, s->name);
    if (s->piece_count > 1) {
        const double t = thickness_of(s, piece), size[3] = {s->cubes[0], 1, t};
        const size_t n[3] = {(size_t)ceil(size[0] * refinement / t - 1e-9), (size_t)ceil(refinement / t - 1e-9),
                             refinement};
        size_t i;
        mesh = make_grid(n, size);
        for (i = 0; i < mesh.node_count; i++) mesh.positions[3 * i + 2] += s->low[piece];
    } else
        mesh = make_layers(s, refinement);
    body = make_body(&mesh, &s->held, 0);
    if (s->piece_count == 1) cut_body(body, s);
    expect(gx_body_model(body, &model, NULL) == GX_OK, "no model");
    rest = find_rest(&model, unknowns);
    drop = drop_of(s, piece, &model, model.elements, rest);
    free(rest);
    gx_body_destroy(body);
    gxio_mesh_release(&mesh);
    return drop;
}

/* 1/d = 1/d0 + c h^2 through two meshes, the second twice as fine */
static double extrapolate(double coarse, double fine) { return 3 / (4 / fine - 1 / coarse); }

/* Elements of a conforming mesh of refinement 1 */
static double conforming_size(const strip *s, size_t piece) {
    const double t = thickness_of(s, piece);
    return s->piece_count > 1 ? 5 * ceil(s->cubes[0] / t) * ceil(1 / t) : 5.0 * s->cubes[0] * s->cubes[2];
}

enum { MESHES = 8 };

static size_t count_conforming(const strip *s, size_t piece, double most_elements) {
    size_t n = 0;
    while (n < MESHES && conforming_size(s, piece) * pow(8, (double)n) <= most_elements) n++;
    return n;
}

static void run_piece(strip *s, size_t piece, double most_elements) {
    const size_t count = count_conforming(s, piece, most_elements);
    double drops[MESHES];
    size_t unknowns[MESHES], i;
    expect(count >= 2, "a conforming mesh is too large");
    for (i = 0; i < count; i++) drops[i] = run_conforming(s, piece, 1u << i, &unknowns[i]);
    s->truth[piece] = extrapolate(drops[count - 2], drops[count - 1]);
    if (count > 2) s->trust[piece] = fabs(extrapolate(drops[count - 3], drops[count - 2]) / s->truth[piece] - 1);
    for (i = 0; i < count; i++)
        print_row(s, piece, CONFORMING, 1u << i, (s->piece_count > 1 ? 1 : thickness_of(s, piece)) * (double)(1u << i),
                  unknowns[i], drops[i]);
    csv_row("%s,%lu,truth,,,,%.6g,%.6g,%.3e", s->name, (unsigned long)piece + 1, s->truth[piece], s->truth[piece],
            s->trust[piece]);
    fprintf(stderr, "%-10s %5lu %-11s %10s %12s %9s %12.6g %12.3e\n", s->name, (unsigned long)piece + 1, "truth", "",
            "", "", s->truth[piece], s->trust[piece]);
}

static size_t count_cut(const strip *s, double most_elements) {
    size_t n = 0;
    while (5.0 * s->cubes[0] * s->cubes[2] * pow(8, (double)n) <= most_elements) n++;
    return n;
}

static void run_strip(strip *s, double most_elements) {
    const size_t count = count_cut(s, most_elements);
    size_t i;
    for (i = 0; i < s->piece_count; i++) run_piece(s, i, most_elements);
    for (i = 0; i < count; i++) run_cut(s, 1u << i);
}

static size_t count_rows(const strip *s, double most_elements) {
    size_t n = CONFORMING * count_cut(s, most_elements), i;
    for (i = 0; i < s->piece_count; i++) n += count_conforming(s, i, most_elements);
    return n;
}

int main(int argc, char **argv) {
    int small;
    const char *path = csv_arguments(argc, argv, &small);
    const double most_elements = small ? 60000 : 700000;
    strip slices = make_slices(small ? 4 : 6), accordion = make_accordion(small ? 8 : 16, small ? 2 : FOLDS);
    csv_open(argv[0], path, "scene,piece,method,refinement,thickness,unknowns,drop,truth,error");
    total = count_rows(&slices, most_elements) + count_rows(&accordion, most_elements);
    fprintf(stderr, "%-10s %5s %-11s %10s %12s %9s %12s %12s\n", "scene", "piece", "method", "refinement",
            "t, elements", "unknowns", "drop, m", "error");
    run_strip(&slices, most_elements);
    run_strip(&accordion, most_elements);
    progress_draw("space", done, total, "");
    return csv_close();
}
