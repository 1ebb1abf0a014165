/* shapes.c - bodies of closed surfaces: how well a shape that is carved out of a grid bends and swings, beside meshes
   that fit it; what it costs to make and to step; how exact its masses are.

   make bench-shapes builds and runs it. It prints CSV and writes it to build/bench/shapes.csv, and a table to stderr.
   MODELS="a.off b.obj": these models too. usage: shapes [FILE [--small] [MODEL...]].

   The shape is an ellipsoid with half axes of 1, 0.6 and 0.45 m; of two materials: in it one of half the size, ten
   times as stiff and twice as dense. It is free. Linear elasticity, Poisson's ratio 0.3. deflection  the work of the
   force x^2 by mass along the third axis, less what moves the body as a whole frequency   of the lowest mode that
   deforms it, by iterating inversely Meshes that fit are cubes of six tetrahedra mapped to the ellipsoid, layer by
   layer: with two materials one layer ends where the inner one does. Of one material also: isosurface stuffing, as of
   the examples' shapes. The references are extrapolated from the two finest mapped meshes. The model has as much volume
   as the ellipsoid.

   series, and what its columns mean:
       one, two    of so many materials. mesh: carved, mapped, stuffed; kinked: carved, and what the interface goes
                   through has a kink there (kink.h); n: cells along the longest side, cubes along an edge; deflection
   and frequency as shares of the references, less 1; step_ms: a time step of the body, stable neo-Hookean, one end
   held, dt 1/60 s, the median of 60; iterations: of conjugate gradients in each cost        making bodies of a bumpy
   ellipsoid: seconds, the median of 5; megabytes held and at most model       a model: moments: the largest error of
   volume, centre and inertia beside exact sums over the triangles of its outline; area: that of the skin. One that is
   refused has neither. */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../examples/gxio.h"
#include "../examples/gxshape.h"
#include "../tests/models.h"
#include "../tests/cell_moments.h"
#define BENCH "shapes"
#include "expect.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"
#include "kink.h"

enum { CARVED, MAPPED, STUFFED, KINKED, STEPS = 12, PASSES = 5, MOST_ROWS = 20, MAKES = 5, ROUNDS = 4, LONG = 5 };

static const double half_axes[3] = {1, 0.6, 0.45}, core = 0.5, young[2] = {1e5, 1e6}, density[2] = {1000, 2000};
static const char *const mesh_names[4] = {"carved", "mapped", "stuffed", "kinked"};
static int small;

/* ---- bodies ---- */

/* Bytes that a body holds */
typedef struct heap {
    size_t held, most;
} heap;

static void *heap_allocate(void *user, size_t size) {
    heap *h = (heap *)user;
    h->held += size;
    if (h->held > h->most) h->most = h->held;
    return malloc(size);
}

static void heap_release(void *user, void *block, size_t size) {
    heap *h = (heap *)user;
    if (block != NULL) h->held -= size;
    free(block);
}

/* A description of one or two materials; the elements' or surfaces' materials are the caller's */
static gx_body_desc describe(gx_material materials[2], int count, gxs_material_kind kind) {
    gx_body_desc desc;
    int i;
    memset(&desc, 0, sizeof desc);
    memset(materials, 0, 2 * sizeof *materials);
    for (i = 0; i < 2; i++) {
        materials[i].elastic.kind = kind;
        materials[i].elastic.young = young[i];
        materials[i].elastic.poisson = 0.3;
        materials[i].density = density[i];
    }
    desc.materials = materials;
    desc.material_count = (size_t)count;
    desc.clock = seconds;
    return desc;
}

static gx_surface surface_of(const wl_surface *s, uint32_t material) {
    gx_surface surface;
    memset(&surface, 0, sizeof surface);
    surface.vertices = s->vertices;
    surface.vertex_count = s->vertex_count;
    surface.triangles = s->triangles;
    surface.triangle_count = s->triangle_count;
    surface.material = material;
    return surface;
}

/* An ellipsoid with the volume of the smooth one of that size */
static void add_ellipsoid(wl_surface *s, double size, uint32_t rings, double waves, double depth) {
    static const double middle[3] = {0, 0, 0};
    double factor;
    size_t i;
    add_blob(s, middle, 1, waves, depth, rings, 0);
    factor = depth > 0 ? 1 : cbrt(4 * 3.14159265358979323846 / 3 / moments_of_surfaces(s, 1, middle).volume);
    for (i = 0; i < 3 * s->vertex_count; i++) s->vertices[i] *= size * factor * half_axes[i % 3];
}

static gx_result try_to_carve(const workload *w, uint32_t cells, gxs_material_kind kind, heap *h, gx_body **body,
                              gx_failure *failure) {
    gx_material materials[2];
    gx_surface surfaces[2];
    gx_shape shape;
    gx_body_desc desc = describe(materials, (int)w->surface_count, kind);
    size_t i;
    for (i = 0; i < w->surface_count; i++) surfaces[i] = surface_of(&w->surfaces[i], (uint32_t)i);
    memset(&shape, 0, sizeof shape);
    shape.surfaces = surfaces;
    shape.surface_count = w->surface_count;
    shape.cells = cells;
    desc.shape = &shape;
    if (h != NULL) {
        desc.allocator.allocate = heap_allocate;
        desc.allocator.release = heap_release;
        desc.allocator.user = h;
    }
    return gx_body_create(&desc, body, failure);
}

static gx_body *carve(const workload *w, uint32_t cells, gxs_material_kind kind, heap *h) {
    gx_body *body = NULL;
    expect(try_to_carve(w, cells, kind, h, &body, NULL) == GX_OK, "no body");
    return body;
}

/* n x n x n cubes of six tetrahedra. Each concentric cube becomes an ellipsoid. */
static gx_body *map(size_t n, int materials_count, gxs_material_kind kind) {
    static const int orders[6][2] = {{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}};
    const size_t side = n + 1, stride[3] = {1, side, side * side};
    double *x = (double *)memory(3 * side * side * side, sizeof *x);
    uint32_t *e = (uint32_t *)memory(24 * n * n * n, sizeof *e), *of = (uint32_t *)memory(6 * n * n * n, sizeof *of);
    gx_material materials[2];
    gx_body_desc desc = describe(materials, materials_count, kind);
    gx_body *body;
    size_t i, k, count = 0;
    int t;
    for (i = 0; i < side * side * side; i++) {
        double most = 0, square = 0, p[3];
        for (k = 0; k < 3; k++) {
            p[k] = 2.0 * (double)(i / stride[k] % side) / (double)n - 1;
            most = fmax(most, fabs(p[k]));
            square += p[k] * p[k];
        }
        for (k = 0; k < 3; k++) x[3 * i + k] = most > 0 ? p[k] * half_axes[k] * most / sqrt(square) : 0;
    }
    for (i = 0; i < n * n * n; i++) {
        const size_t at[3] = {i % n, i / n % n, i / (n * n)};
        const size_t corner = at[0] + side * (at[1] + side * at[2]);
        double most = 0;
        size_t step[3];
        for (k = 0; k < 3; k++) { /* diagonals from the middle outwards */
            const double p = ((double)at[k] + 0.5) * 2 / (double)n - 1;
            most = fmax(most, fabs(p));
            step[k] = p > 0 ? stride[k] : (size_t)0 - stride[k];
        }
        for (t = 0; t < 6; t++, count++) {
            const size_t first = corner + (step[0] != 1 ? 1 : 0) + (step[1] != side ? side : 0) +
                                 (step[2] != side * side ? side * side : 0);
            const size_t node[4] = {first, first + step[orders[t][0]], first + step[orders[t][0]] + step[orders[t][1]],
                                    first + step[0] + step[1] + step[2]};
            const int turned = gxb_orient3d(x + 3 * node[0], x + 3 * node[1], x + 3 * node[2], x + 3 * node[3]) > 0;
            for (k = 0; k < 4; k++) e[4 * count + k] = (uint32_t)node[turned && k >= 2 ? 5 - k : k];
            of[count] = most < core;
        }
    }
    desc.positions = x;
    desc.node_count = side * side * side;
    desc.elements = e;
    desc.element_count = count;
    if (materials_count > 1) desc.element_materials = of;
    expect(gx_body_create(&desc, &body, NULL) == GX_OK, "no mapped body");
    free(x);
    free(e);
    free(of);
    return body;
}

static gx_body *stuff(size_t n, gxs_material_kind kind) {
    const gxshape_part part = {GXSHAPE_ELLIPSOID, {0, 0, 0}, {half_axes[0], half_axes[1], half_axes[2]}, {0, 0}, 0};
    const double low[3] = {-1.2, -0.8, -0.6}, high[3] = {1.2, 0.8, 0.6};
    gx_material materials[2];
    gx_body_desc desc = describe(materials, 1, kind);
    gxshape_field field;
    gxshape_mesh mesh;
    gx_body *body;
    memset(&field, 0, sizeof field);
    gxshape_add(&field, &part, 1);
    expect(gxshape_stuff(gxshape_field_value, &field, low, high, 2 / (double)n, &mesh) == NULL, "nothing is stuffed");
    desc.positions = mesh.positions;
    desc.node_count = mesh.node_count;
    desc.elements = mesh.elements;
    desc.element_count = mesh.element_count;
    expect(gx_body_create(&desc, &body, NULL) == GX_OK, "no stuffed body");
    gxshape_mesh_release(&mesh);
    return body;
}

/* ---- statics of a free body ---- */

/* The body's model in a solver of its own */
typedef struct problem {
    gxs_model model;
    kinked kinks; /* if it has such */
    gxs_solver *solver;
    size_t count;          /* 3 x copies */
    double *rigid[6];      /* fields that move the body as a whole, orthonormal by mass */
    double *force, *given; /* N; a field by mass */
} problem;

/* out = M u */
static void times_mass(const gxs_model *model, const double *u, double *out) {
    size_t e;
    int i, j, k;
    memset(out, 0, 3 * model->copy_count * sizeof *out);
    for (e = 0; e < model->element_count; e++) {
        const gxs_element *element = &model->elements[e];
        int entry = 0;
        for (i = 0; i < 4; i++)
            for (j = i; j < 4; j++, entry++)
                for (k = 0; k < 3; k++) {
                    const size_t a = 3 * (size_t)element->copy[i] + (size_t)k,
                                 b = 3 * (size_t)element->copy[j] + (size_t)k;
                    out[a] += element->mass[entry] * u[b];
                    if (i != j) out[b] += element->mass[entry] * u[a];
                }
    }
}

static double product(const double *a, const double *b, size_t count) {
    double sum = 0;
    size_t i;
    for (i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

/* Takes from a field what moves the body as a whole in the first `count` ways. force: scratch */
static void take_rigid(problem *p, double *u, int count) {
    size_t i;
    int r, again;
    for (again = 0; again < 2; again++)
        for (r = 0; r < count; r++) {
            double share;
            times_mass(&p->model, p->rigid[r], p->force);
            share = product(p->force, u, p->count);
            for (i = 0; i < p->count; i++) u[i] -= share * p->rigid[r][i];
        }
}

/* Scales a field so that its product with itself by mass is 1. */
static void normalise(problem *p, double *u) {
    double length;
    size_t i;
    times_mass(&p->model, u, p->force);
    length = sqrt(product(p->force, u, p->count));
    for (i = 0; i < p->count; i++) u[i] /= length;
}

static void open_problem(problem *p, gx_body *body, int with_kinks) {
    size_t i;
    int r, k;
    memset(p, 0, sizeof *p);
    expect(gx_body_model(body, &p->model, NULL) == GX_OK, "no model");
    if (with_kinks) kink_add(&p->kinks, body, &p->model);
    p->count = 3 * p->model.copy_count;
    p->force = (double *)memory(p->count, sizeof(double));
    p->given = (double *)memory(p->count, sizeof(double));
    expect(gxs_solver_create(NULL, &p->solver, NULL) == GX_OK, "no solver");
    expect(gxs_solver_set_model(p->solver, &p->model, NULL) == GX_OK, "the model is refused");
    for (r = 0; r < 6; r++) {
        p->rigid[r] = (double *)memory(p->count, sizeof(double));
        for (i = 0; i < p->count; i++) {
            const double *x = p->model.positions + i / 3 * 3;
            k = (int)(i % 3);
            p->rigid[r][i] = r < 3            ? k == r
                           : k == (r + 1) % 3 ? -x[(r + 2) % 3]
                           : k == (r + 2) % 3 ? x[(r + 1) % 3]
                                              : 0;
        }
        take_rigid(p, p->rigid[r], r);
        normalise(p, p->rigid[r]);
    }
}

static void close_problem(problem *p) {
    int r;
    for (r = 0; r < 6; r++) free(p->rigid[r]);
    free(p->force);
    free(p->given);
    kink_free(&p->kinks);
    gxs_solver_destroy(p->solver);
}

/* u = what the force M given does to the body at rest, without what moves it as a whole: a step of LONG seconds, in
   which inertia adds M / LONG^2 to the stiffness, a few parts in 10,000. Without it the system would be singular.
   Returns the work of that force. */
static double solve_static(problem *p, double *u) {
    double *velocity = (double *)memory(p->count, sizeof(double)), *force = (double *)memory(p->count, sizeof(double));
    gxs_step_desc step;
    double work;
    take_rigid(p, p->given, 6);
    times_mass(&p->model, p->given, force);
    memset(u, 0, p->count * sizeof *u);
    memset(&step, 0, sizeof step);
    step.dt = LONG;
    step.forces = force;
    step.epoch = p->model.epoch;
    step.cg_tolerance = 1e-6;
    step.cg_iterations = 4000;
    expect(gxs_solver_step(p->solver, &step, u, velocity, NULL, NULL) == GX_OK, "no balance");
    take_rigid(p, u, 6);
    work = product(u, force, p->count);
    free(velocity);
    free(force);
    return work;
}

/* Work of the bending force, per its square; then the lowest frequency, Hz, from that field on */
static void measure(gx_body *body, int with_kinks, double *deflection, double *frequency) {
    double *u, square = 0;
    problem p;
    size_t i;
    int round;
    open_problem(&p, body, with_kinks);
    u = (double *)memory(p.count, sizeof *u);
    for (i = 0; i < p.model.copy_count; i++) p.given[3 * i + 2] = p.model.positions[3 * i] * p.model.positions[3 * i];
    *deflection = solve_static(&p, u);
    for (round = 0; round < ROUNDS; round++) { /* the eigenvalue is right to the square of the field's error */
        memcpy(p.given, u, p.count * sizeof *u);
        normalise(&p, p.given);
        square = 1 / solve_static(&p, u) - 1.0 / (LONG * LONG);
    }
    *frequency = sqrt(square) / (2 * 3.14159265358979323846);
    free(u);
    close_problem(&p);
}

/* ---- series ---- */

typedef struct row {
    const char *series, *mesh;
    size_t n, triangles, elements, unknowns;
    double deflection, frequency, step_ms, iterations, seconds, held_mb, most_mb, moments, area; /* NAN: not measured */
} row;

static row empty_row(const char *series, const char *mesh, size_t n) {
    row r;
    memset(&r, 0, sizeof r);
    r.series = series;
    r.mesh = mesh;
    r.n = n;
    r.deflection = r.frequency = r.step_ms = r.iterations = r.seconds = r.held_mb = r.most_mb = r.moments = r.area =
        NAN;
    return r;
}

static void print_row(const row *r) {
    const double values[9] = {r->deflection, r->frequency, r->step_ms, r->iterations, r->seconds,
                              r->held_mb,    r->most_mb,   r->moments, r->area};
    char text[9][24];
    int i;
    for (i = 0; i < 9; i++) {
        text[i][0] = 0;
        if (isfinite(values[i])) snprintf(text[i], sizeof text[i], "%.4g", values[i]);
    }
    csv_row("%s,%s,%lu,%lu,%lu,%lu,%s,%s,%s,%s,%s,%s,%s,%s,%s", r->series, r->mesh, (unsigned long)r->n,
            (unsigned long)r->triangles, (unsigned long)r->elements, (unsigned long)r->unknowns, text[0], text[1],
            text[2], text[3], text[4], text[5], text[6], text[7], text[8]);
    fprintf(stderr, "%-6s %-20s %4lu %8lu %8lu %8lu %10s %10s %8s %6s %8s %7s %7s %9s %9s\n", r->series, r->mesh,
            (unsigned long)r->n, (unsigned long)r->triangles, (unsigned long)r->elements, (unsigned long)r->unknowns,
            text[0], text[1], text[2], text[3], text[4], text[5], text[6], text[7], text[8]);
}

static void count_body(row *r, gx_body *body) {
    gx_view view;
    expect(gx_body_view(body, &view, NULL) == GX_OK, "no view");
    r->elements = view.element_count;
    r->unknowns = 3 * view.copy_count;
}

static gx_body *make_body(int kind, size_t n, const workload *w, gxs_material_kind material) {
    return kind == MAPPED  ? map(n, (int)w->surface_count, material)
         : kind == STUFFED ? stuff(n, material)
                           : carve(w, (uint32_t)n, material, NULL);
}

/* ---- time steps ---- */

/* Bodies in motion: one end is held, the rest falls and swings. */
typedef struct motion {
    gx_body *body;
    double times[PASSES * STEPS], iterations;
    size_t count;
} motion;

static void begin_motion(motion *m, gx_body *body) {
    const gx_region end = gx_region_half_space(0, -1, -0.7);
    memset(m, 0, sizeof *m);
    m->body = body;
    expect(gx_body_hold(body, &end, 1, NULL) == GX_OK, "nothing is held");
}

static void go_on(motion *m) {
    gx_step_desc step;
    gx_step_report report;
    int i;
    memset(&step, 0, sizeof step);
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    step.clock = processor_seconds;
    for (i = 0; i < STEPS; i++) {
        expect(gx_body_step(m->body, &step, &report, NULL) == GX_OK, "a step fails");
        m->times[m->count++] = 1e3 * report.seconds;
        m->iterations += report.cg_iterations;
    }
}

/* All in turn, several times. Notes the median of a step's time, ms, and its mean iterations in the rows. */
static void take_steps(motion *motions, row *rows, size_t count) {
    size_t i, pass;
    for (pass = 0; pass < PASSES; pass++)
        for (i = 0; i < count; i++) {
            progress_draw("shapes", pass * count + i, PASSES * count, "steps");
            go_on(&motions[i]);
        }
    for (i = 0; i < count; i++) {
        rows[i].iterations = motions[i].iterations / (double)motions[i].count;
        rows[i].step_ms = median(motions[i].times, motions[i].count);
        gx_body_destroy(motions[i].body);
    }
}

/* ---- stiffness, costs ---- */

/* Carved and fitted bodies of one or two materials */
static void run_stiffness(int materials) {
    static const size_t sizes[4][8] = {
        {6, 8, 12, 16, 24, 32, 0}, {4, 6, 8, 12, 16, 20, 24, 0}, {6, 8, 12, 16, 24, 32, 0}, {6, 8, 12, 16, 24, 32, 0}};
    const size_t finest[2] = {small ? 8 : 28, small ? 12 : 44};
    const char *series = materials == 1 ? "one" : "two";
    workload w = wl_empty();
    motion *motions = (motion *)memory(MOST_ROWS, sizeof *motions);
    row rows[MOST_ROWS];
    size_t count = 0, moving = 0;
    double value[2][2], truth[2];
    int kind, i;
    for (i = 0; i < materials; i++)
        add_ellipsoid(wl_add_surface(&w, 1), i == 0 ? 1 : core, (small ? 12u : 56u) >> i, 0, 0);
    for (i = 0; i < 2; i++) {
        gx_body *body = map(finest[i], materials, GXS_LINEAR);
        progress_draw("shapes", (size_t)i, 2, "reference");
        measure(body, 0, &value[i][0], &value[i][1]);
        gx_body_destroy(body);
    }
    for (i = 0; i < 2; i++) { /* the error of linear elements is as the square of their size */
        const double ratio = pow((double)finest[1] / (double)finest[0], 2);
        truth[i] = value[1][i] + (value[1][i] - value[0][i]) / (ratio - 1);
    }
    for (kind = 0; kind < 4; kind++) {
        if (kind == (materials == 1 ? KINKED : STUFFED)) continue;
        for (i = 0; sizes[kind][i] > 0 && sizes[kind][i] <= (small ? 8 : 99); i++) {
            row *r = &rows[count];
            gx_body *body;
            if (materials > 1 && kind == MAPPED && sizes[kind][i] % 4 != 0) continue; /* no layer ends at the core */
            *r = empty_row(series, mesh_names[kind], sizes[kind][i]);
            progress_draw("shapes", (size_t)i, 7, mesh_names[kind]);
            body = make_body(kind, r->n, &w, GXS_LINEAR);
            measure(body, kind == KINKED, &r->deflection, &r->frequency);
            r->deflection = r->deflection / truth[0] - 1;
            r->frequency = r->frequency / truth[1] - 1;
            r->triangles = kind == CARVED || kind == KINKED ? w.surfaces[0].triangle_count : 0;
            count_body(r, body);
            gx_body_destroy(body);
            if (kind != KINKED) begin_motion(&motions[moving++], make_body(kind, r->n, &w, GXS_STABLE_NEO_HOOKEAN));
            count++;
        }
    }
    take_steps(motions, rows, moving); /* kinked ones come last */
    for (i = 0; i < (int)count; i++) print_row(&rows[i]);
    free(motions);
    wl_free(&w);
}

/* Making bodies */
static void run_costs(void) {
    static const uint32_t sizes[6][2] = {{112, 21}, {25, 21}, {50, 21}, {112, 10}, {112, 42}, {158, 21}};
    int i, n;
    for (i = 0; i < (small ? 1 : 6); i++) {
        row r = empty_row("cost", "carved", small ? 6 : sizes[i][1]);
        workload w = wl_empty();
        double times[MAKES];
        heap h;
        add_ellipsoid(wl_add_surface(&w, 1), 1, small ? 20 : sizes[i][0], 5, 0.05);
        r.triangles = w.surfaces[0].triangle_count;
        for (n = 0; n < (small ? 1 : MAKES); n++) {
            double start;
            gx_body *body;
            progress_draw("shapes", (size_t)(MAKES * i + n), 6 * MAKES, "cost");
            memset(&h, 0, sizeof h);
            start = processor_seconds(NULL);
            body = carve(&w, (uint32_t)r.n, GXS_STABLE_NEO_HOOKEAN, &h);
            times[n] = processor_seconds(NULL) - start;
            r.held_mb = 1e-6 * (double)h.held;
            count_body(&r, body);
            gx_body_destroy(body);
        }
        r.seconds = median(times, small ? 1 : MAKES);
        r.most_mb = 1e-6 * (double)h.most;
        print_row(&r);
        wl_free(&w);
    }
}

/* ---- models ---- */

/* The outline of all that a surface winds around, by a Boolean: the surface itself unless it crosses itself, covers
   itself or is turned inside out. Returns what a body of it must return, too. */
static gx_result find_outline(const wl_surface *s, wl_surface *outline) {
    gxb_boolean *boolean = NULL;
    gxb_boolean_result found;
    gxb_operand operand;
    gx_result result;
    size_t i;
    memset(&operand, 0, sizeof operand);
    operand.vertices = s->vertices;
    operand.vertex_count = s->vertex_count;
    operand.triangles = s->triangles;
    operand.triangle_count = s->triangle_count;
    operand.operation = GXB_UNION;
    expect(gxb_boolean_create(NULL, &boolean, NULL) == GX_OK && gxb_boolean_set_fine(boolean, 1, NULL) == GX_OK,
           "no Boolean");
    result = gxb_boolean_add(boolean, &operand, NULL);
    if (result == GX_OK) {
        expect(gxb_boolean_evaluate(boolean, &found, NULL) == GX_OK, "no outline");
        for (i = 0; i < found.vertex_count; i++) wl_add_vertex(outline, found.vertices + 3 * i);
        for (i = 0; i < found.triangle_count; i++)
            wl_add_triangle(outline, found.triangles[3 * i], found.triangles[3 * i + 1], found.triangles[3 * i + 2]);
        if (found.triangle_count == 0) result = GX_ERROR_EMPTY;
    }
    gxb_boolean_destroy(boolean);
    return result;
}

/* The largest error of a body's moments beside those of its outline, as shares of moments about the centre */
static double moments_error(const gx_body *body, const wl_surface *outline) {
    static const double origin[3] = {0, 0, 0};
    exact_moments exact = moments_of_surfaces(outline, 1, origin), own;
    double about[3], size, worst;
    int k;
    for (k = 0; k < 3; k++) about[k] = exact.first[k] / exact.volume;
    exact = moments_of_surfaces(outline, 1, about);
    own = moments_of_cells(body, 0, about);
    size = sqrt((exact.second[0] + exact.second[3] + exact.second[5]) / exact.volume);
    worst = fabs(own.volume / (density[0] * exact.volume) - 1);
    for (k = 0; k < 3; k++)
        worst = fmax(worst, fabs(own.first[k] / density[0] - exact.first[k]) / (exact.volume * size));
    for (k = 0; k < 6; k++)
        worst = fmax(worst, fabs(own.second[k] / density[0] - exact.second[k]) / (exact.volume * size * size));
    return worst;
}

static double area_error(gx_body *body, const wl_surface *outline) {
    gx_skin skin;
    double area = 0;
    size_t t;
    expect(gx_body_skin(body, NULL, &skin, NULL) == GX_OK, "no skin");
    for (t = 0; t < skin.triangle_count; t++)
        area += triangle_area(skin.vertex_rest + 3 * skin.triangles[3 * t],
                              skin.vertex_rest + 3 * skin.triangles[3 * t + 1],
                              skin.vertex_rest + 3 * skin.triangles[3 * t + 2]);
    return fabs(area / area_of(outline) - 1);
}

/* w: the model's surface alone. A model that is not closed, encloses nothing or is too large has no body: its row has
   no figures, and a line to stderr says why, and where. */
static void run_model(const char *name, const workload *w, size_t cells) {
    row r = empty_row("model", name, cells);
    workload outlines = wl_empty();
    wl_surface *outline = wl_add_surface(&outlines, 1);
    const gx_result expected = find_outline(&w->surfaces[0], outline);
    const double start = processor_seconds(NULL);
    gx_body *body = NULL;
    gx_failure failure;
    const gx_result result = try_to_carve(w, (uint32_t)cells, GXS_STABLE_NEO_HOOKEAN, NULL, &body, &failure);
    r.seconds = processor_seconds(NULL) - start;
    r.triangles = w->surfaces[0].triangle_count;
    expect(result == expected || result == GX_ERROR_RANGE, name);
    if (result == GX_OK) {
        r.moments = moments_error(body, outline);
        r.area = area_error(body, outline);
        count_body(&r, body);
    }
    print_row(&r);
    if (result != GX_OK) {
        fprintf(stderr, "%-27s %s: %s", "", failure.field, gx_result_text(result));
        fprintf(stderr, failure.index != SIZE_MAX ? ", number %lu\n" : "\n", (unsigned long)failure.index);
    }
    gx_body_destroy(body);
    wl_free(&outlines);
}

static void load_model(const char *path, wl_surface *s) {
    gxio_surface file;
    gxio_error error;
    size_t n;
    expect(gxio_surface_load(path, NULL, &file, &error), path);
    for (n = 0; n < file.vertex_count; n++) wl_add_vertex(s, file.vertices + 3 * n);
    for (n = 0; n < file.triangle_count; n++)
        wl_add_triangle(s, file.triangles[3 * n], file.triangles[3 * n + 1], file.triangles[3 * n + 2]);
    gxio_surface_release(&file);
}

/* The caller's models, and two that are generated */
static void run_models(int count, char **paths) {
    static const size_t cells[2] = {8, 20};
    int i, k;
    for (i = 0; i < 2 + count; i++) {
        workload w = wl_empty();
        wl_surface *s = wl_add_surface(&w, 1);
        const char *name = i == 0 ? "bumpy ellipsoid" : i == 1 ? "genus 30" : strrchr(paths[i - 2], '/');
        if (i >= 2) name = name != NULL ? name + 1 : paths[i - 2];
        if (i == 0) add_ellipsoid(s, 1, small ? 12 : 60, 5, 0.2);
        if (i == 1) add_plate(s, 5, 6, 0.11);
        if (i >= 2) load_model(paths[i - 2], s);
        for (k = 0; k < (small ? 1 : 2); k++) run_model(name, &w, cells[k]);
        wl_free(&w);
    }
}

int main(int argc, char **argv) {
    const int models = argc > 2 ? argc - 2 - (strcmp(argv[2], "--small") == 0) : 0;
    const char *path = csv_arguments(argc - models, argv, &small);
    csv_open(
        argv[0], path,
        "series,mesh,n,triangles,elements,unknowns,deflection,frequency,step_ms,iterations,seconds,held_mb,most_mb,"
        "moments,area");
    fprintf(stderr, "%-6s %-20s %4s %8s %8s %8s %10s %10s %8s %6s %8s %7s %7s %9s %9s\n", "series", "mesh", "n",
            "triangles", "elements", "unknowns", "deflection", "frequency", "step, ms", "iter.", "seconds", "MB",
            "at most", "moments", "area");
    run_stiffness(1);
    run_stiffness(2);
    run_costs();
    run_models(models, argv + argc - models);
    rat_arena_free();
    return csv_close();
}
