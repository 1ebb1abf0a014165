/* thin.c - slices thinner than their elements: how far they bend with affine copies (gx_body_desc.affine_below) and
   without, and what that costs.

   make bench-thin builds and runs it. It prints CSV and writes it to build/bench/thin.csv, and a table to stderr.
   usage: thin [FILE [--small]].

   A plate of 15 x 4 x 1 cubes of 1 m, five tetrahedra each, is held at x = 0 and cut; slices hang under gravity. Drops
   are those of the middle of the free end, beside elements of degree 4 and 3 for the slice alone (plate.h), which beam
   theory judges at Poisson's ratio 0.

   series, and what its columns mean:
       reference   thickness t; value: the reference / beam theory, nu = 0
       placement   t and nu; value: the least drop / reference over placements in the layer, most: the largest;
                   linear: without affine copies
       slices      the five slices of slab_in_five
       mesh        t = .1 in other meshes: tilted by 30 degrees about x and y, jittered, cubes of six, a body-centred
                   lattice
       frequency   first frequency of a clamped slice of t = .1, nu = 0, over beam theory's
       large       drop / length of a slice of t = .1, nu = 0, at loads q l^3 / (E I) of 2 and 10; linear: that of the
                   inextensible rod
       balance     CG iterations to 1e-2 of a slice in the plate, without inertia
       motion      the same of slices of 61 x 11 cubes in steps of slab_in_five; most: iterations of the aim
       cost        a slice of 8 x 2 cubes, t = .2, to an error: milliseconds of one static solve to 1e-3 by refinement
       newton      slab_in_five's slices flung: error of the motion by Newton iterations; see its table
       product     of the Hessian with a vector, as conjugate gradients have it: ns for each element with affine copies;
                   linear: for each of the same elements without; most: the ratio, of which aim is the aim */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../examples/gxio.h"
#define BENCH "thin"
#include "expect.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"

enum { TRIANGLES = 12, PLACEMENTS = 9, MESHES = 5, SLICES = 5, MOST_NEWTON = 5, STEPS = 120 };

static const double density = 1000;
static int small;
static size_t done, total;

#include "plate.h"

/* ---- bodies ---- */

/* A slice from the origin on along x and y, its lower face at z = low; m */
typedef struct slice {
    double length, width, low, thickness;
    int loose; /* no face of the mesh is at x = 0 */
} slice;

typedef struct probe {
    gx_body *body;
    gxio_mesh mesh;
    double young, poisson, load;
    gx_anchor tip;
    gxs_spring *springs; /* spring_count: of the clamp, where no region can hold */
    size_t spring_count;
    gx_step_report report;
} probe;

/* A mesh of nx x ny x nz cubes on a box from `low` on, of size; five or six tetrahedra each */
static gxio_mesh make_grid(const size_t n[3], const double low[3], const double size[3], int per_cube) {
    gxio_mesh mesh;
    gxio_error error;
    char spec[64];
    size_t i;
    snprintf(spec, sizeof spec, "grid:%lu,%lu,%lu,%d", (unsigned long)n[0], (unsigned long)n[1], (unsigned long)n[2],
             per_cube);
    expect(gxio_mesh_load(spec, &mesh, &error), "no grid");
    for (i = 0; i < 3 * mesh.node_count; i++)
        mesh.positions[i] = low[i % 3] + mesh.positions[i] * size[i % 3] / (double)n[i % 3];
    return mesh;
}

/* Turns a point about the x or the y axis. */
static void turn_point(int axis, double degrees, double x[3]) {
    const double c = cos(degrees * 3.14159265358979323846 / 180), s = sin(degrees * 3.14159265358979323846 / 180);
    const int a = axis == 0 ? 1 : 2, b = axis == 0 ? 2 : 0;
    const double p = x[a], q = x[b];
    x[a] = c * p - s * q;
    x[b] = s * p + c * q;
}

static gx_body *make_body(const gxio_mesh *mesh, gxs_material_kind kind, double young, double poisson, double affine) {
    gx_material material;
    gx_body_desc desc;
    gx_body *body;
    memset(&material, 0, sizeof material);
    memset(&desc, 0, sizeof desc);
    material.elastic.kind = kind;
    material.elastic.young = young;
    material.elastic.poisson = poisson;
    material.density = density;
    desc.positions = mesh->positions;
    desc.node_count = mesh->node_count;
    desc.elements = mesh->elements;
    desc.element_count = mesh->element_count;
    desc.materials = &material;
    desc.material_count = 1;
    desc.affine_below = affine;
    desc.clock = seconds;
    expect(gx_body_create(&desc, &body, NULL) == GX_OK, "no body");
    return body;
}

/* Keeps what is inside of the slice's box. */
static void keep_slice(gx_body *body, const slice *s) {
    static const uint32_t triangles[3 * TRIANGLES] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                                      1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    double vertices[24];
    gx_surface box;
    gx_cut_desc cut;
    int i;
    for (i = 0; i < 8; i++) {
        /* beyond the mesh where the slice ends with it, so that no face of the box lies on a face of the mesh */
        const double beyond = s->loose ? 0 : 0.5;
        double *x = vertices + 3 * i;
        x[0] = i == 1 || i == 2 || i == 5 || i == 6 ? s->length + beyond : -beyond;
        x[1] = i % 4 >= 2 ? s->width + beyond : -beyond;
        x[2] = i >= 4 ? s->low + s->thickness : s->low;
    }
    memset(&box, 0, sizeof box);
    memset(&cut, 0, sizeof cut);
    box.vertices = vertices;
    box.vertex_count = 8;
    box.triangles = triangles;
    box.triangle_count = TRIANGLES;
    box.kind = GX_SURFACE_KEEP;
    cut.surfaces = &box;
    cut.surface_count = 1;
    expect(gx_body_cut(body, &cut, NULL, NULL) == GX_OK, "the cut fails");
}

/* An anchor near the middle of the free end, found by a ray from above; then the clamp at x = 0: a region, or where
   nodes are not there, springs so stiff that they give way by less than a thousandth. */
static void hold_slice(probe *p, const slice *s) {
    const double origin[3] = {s->length * (1 - 1e-4), s->width / 2 + 1e-5, s->low + s->thickness + 1},
                 way[3] = {0, 0, -1};
    const gx_region wall = gx_region_half_space(0, -1, 1e-9);
    gx_skin skin;
    gx_hit hit;
    size_t i;
    expect(gx_body_skin(p->body, NULL, &skin, NULL) == GX_OK, "no skin");
    expect(gx_body_pick(p->body, origin, way, &hit, NULL) == GX_OK && hit.triangle != UINT32_MAX, "no tip");
    expect(gx_hit_anchor(p->body, &hit, &p->tip, NULL) == GX_OK, "no anchor");
    if (!s->loose) {
        expect(gx_body_hold(p->body, &wall, 1, NULL) == GX_OK, "nothing is held");
        return;
    }
    p->springs = (gxs_spring *)memory(skin.vertex_count, sizeof *p->springs);
    for (i = 0; i < skin.vertex_count; i++) {
        gxs_spring *spring = &p->springs[p->spring_count];
        if (skin.vertex_rest[3 * i] > 1e-6) continue;
        spring->point = gx_skin_point(&skin, (uint32_t)i);
        memcpy(spring->target, skin.vertex_rest + 3 * i, sizeof spring->target);
        spring->stiffness = 100 * p->young;
        p->spring_count++;
    }
    expect(p->spring_count > 0, "no clamp");
}

static void free_probe(probe *p) {
    free(p->springs);
    gx_body_destroy(p->body);
    gxio_mesh_release(&p->mesh);
}

/* The drop of the tip at balance, m. newton, tolerance: of each linear solve */
static double find_drop(probe *p, uint32_t newton, double tolerance) {
    gx_step_desc step;
    double before[3], after[3];
    memset(&step, 0, sizeof step);
    step.integrator = GXS_STATIC;
    step.gravity[2] = -p->load;
    step.newton_iterations = newton;
    step.newton_tolerance = 1e-10;
    step.cg_iterations = 20000;
    step.cg_tolerance = tolerance;
    step.springs = p->springs;
    step.spring_count = p->spring_count;
    step.clock = seconds;
    expect(gx_body_anchor_point(p->body, &p->tip, NULL, before, NULL) == GX_OK, "no tip");
    expect(gx_body_step(p->body, &step, &p->report, NULL) == GX_OK, "no balance");
    expect(gx_body_anchor_point(p->body, &p->tip, NULL, after, NULL) == GX_OK, "no tip");
    return before[2] - after[2];
}

/* A slice, cut out of a mesh, held. Takes the mesh over */
static probe make_probe(gxio_mesh mesh, const slice *s, gxs_material_kind kind, double poisson, double affine) {
    probe p;
    memset(&p, 0, sizeof p);
    p.mesh = mesh;
    p.young = 1e9;
    p.poisson = poisson;
    p.load = 1;
    p.body = make_body(&p.mesh, kind, p.young, poisson, affine);
    keep_slice(p.body, s);
    hold_slice(&p, s);
    return p;
}

/* The slice out of one layer of cubes, n along the edge of each */
static probe cut_probe(const slice *s, double poisson, double affine, size_t n) {
    const size_t count[3] = {(size_t)(s->length * (double)n + 0.5), (size_t)(s->width * (double)n + 0.5), n};
    const double low[3] = {0, 0, 0}, size[3] = {s->length, s->width, 1};
    return make_probe(make_grid(count, low, size, 5), s, GXS_LINEAR, poisson, affine);
}

static double drop_of(const slice *s, double poisson, double affine) {
    probe p = cut_probe(s, poisson, affine, 1);
    const double drop = find_drop(&p, 4, 1e-4);
    free_probe(&p);
    return drop;
}

/* Meshed on its own, in cubes as wide as `spacing`; layers: through the thickness. affine 0: linear elements */
static probe conforming_probe(const slice *s, double poisson, double spacing, size_t layers, double affine) {
    const size_t n[3] = {(size_t)ceil(s->length / spacing - 1e-9), (size_t)ceil(s->width / spacing - 1e-9), layers};
    const double low[3] = {0, 0, 0}, size[3] = {s->length, s->width, s->thickness};
    slice whole = *s;
    probe p;
    memset(&p, 0, sizeof p);
    whole.low = 0;
    p.mesh = make_grid(n, low, size, 5);
    p.young = 1e9;
    p.poisson = poisson;
    p.load = 1;
    p.body = make_body(&p.mesh, GXS_LINEAR, p.young, poisson, affine);
    hold_slice(&p, &whole);
    return p;
}

/* ---- references ---- */

static double reference(const slice *s, double poisson) {
    return plate_drop((int)s->length, (int)s->width, s->thickness, 1e9, poisson, density);
}

/* rho g l^4 / (8 E t^2 / 12) */
static double beam_drop(const slice *s) {
    return 1.5 * density * pow(s->length, 4) / (1e9 * s->thickness * s->thickness);
}

static slice make_slice(double length, double width, double low, double thickness) {
    slice s;
    memset(&s, 0, sizeof s);
    s.length = length;
    s.width = width;
    s.low = low;
    s.thickness = thickness;
    return s;
}

static void row(const char *series, const char *what, double t, double poisson, double value, double most,
                double linear, double aim) {
    char text[4][32];
    const double values[4] = {value, most, linear, aim};
    int i;
    for (i = 0; i < 4; i++) {
        text[i][0] = 0;
        if (isfinite(values[i])) snprintf(text[i], sizeof text[i], "%.6g", values[i]);
    }
    csv_row("%s,%s,%.4g,%.3g,%s,%s,%s,%s", series, what, t, poisson, text[0], text[1], text[2], text[3]);
    fprintf(stderr, "%-10s %-22s %7.4g %6.3g %12s %12s %12s %10s\n", series, what, t, poisson, text[0], text[1],
            text[2], text[3]);
}

/* ---- series ---- */

static double plate_length(void) { return small ? 6 : 15; }
static double plate_width(void) { return small ? 2 : 4; }

static void run_placements(void) {
    static const double t[6] = {1, 0.5, 0.2, 0.1, 0.05, 0.02}, nu[3] = {0, 0.3, 0.4},
                        aim[3][6] = {{NAN, NAN, NAN, NAN, NAN, NAN},
                                     {0.98, 0.97, 0.95, 0.93, 0.90, 0.86},
                                     {NAN, 0.94, 0.91, 0.86, 0.81, NAN}};
    /* shares of the room beside the slice: on a face of the layer, close to one, between */
    static const double place[PLACEMENTS] = {0, 0.01, 0.1, 0.25, 0.37, 0.5, 0.7, 0.99, 1};
    int i, j, k;
    for (j = 0; j < 3; j++)
        for (i = 0; i < (small ? 4 : 6); i++) {
            slice s = make_slice(plate_length(), plate_width(), 0, t[i]);
            double least = HUGE_VAL, most = 0, linear, truth;
            progress_draw("thin", done++, total, "placement");
            truth = reference(&s, nu[j]);
            if (j == 0) {
                row("reference", "beam", t[i], nu[j], truth / beam_drop(&s), NAN, NAN, NAN);
                continue;
            }
            for (k = 0; k < (t[i] < 1 ? PLACEMENTS : 1); k++) {
                double drop;
                s.low = place[k] * (1 - t[i]);
                drop = drop_of(&s, nu[j], 1) / truth;
                least = fmin(least, drop);
                most = fmax(most, drop);
            }
            s.low = 0.37 * (1 - t[i]);
            linear = drop_of(&s, nu[j], 0) / truth;
            row("placement", "cut", t[i], nu[j], least, most, linear, aim[j][i]);
        }
}

/* Slices of 1/15 to 5/15 of a slab of 61 x 2 cubes */
static void run_slices(void) {
    static const double z[SLICES + 1] = {0, 1. / 15, 3. / 15, 6. / 15, 10. / 15, 1};
    int i;
    for (i = 0; i < SLICES; i++) {
        const slice s = make_slice(small ? 15 : 61, 2, z[i], z[i + 1] - z[i]);
        const double truth = reference(&s, 0.3);
        char name[16];
        progress_draw("thin", done++, total, "slices");
        snprintf(name, sizeof name, "slice %d", i + 1);
        row("slices", name, s.thickness, 0.3, drop_of(&s, 0.3, 1) / truth, NAN, drop_of(&s, 0.3, 0) / truth, 0.98);
    }
}

/* Numbers from -1 to 1, the same everywhere */
static double uniform(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) / 8388608.0 - 1.0;
}

/* All nodes move by up to `jitter` of a cube along each axis. */
static void jitter_mesh(gxio_mesh *mesh, double jitter) {
    uint32_t state = 7;
    size_t i;
    for (i = 0; i < 3 * mesh->node_count; i++) mesh->positions[i] += jitter * uniform(&state);
}

static void turn_mesh(gxio_mesh *mesh, int axis, double degrees) {
    size_t i;
    for (i = 0; i < mesh->node_count; i++) turn_point(axis, degrees, mesh->positions + 3 * i);
}

/* A body-centred cubic lattice of n cells. For each face between two cells the octahedron of its corners and of the two
   centres is divided into four. */
static gxio_mesh make_centred(const size_t n[3], const double low[3]) {
    const size_t corner[3] = {n[0] + 1, n[1] + 1, n[2] + 1}, corners = corner[0] * corner[1] * corner[2],
                 centres = n[0] * n[1] * n[2], step[3] = {1, corner[0], corner[0] * corner[1]},
                 cell_step[3] = {1, n[0], n[0] * n[1]};
    gxio_mesh mesh;
    size_t i, j, k, cell;
    memset(&mesh, 0, sizeof mesh);
    mesh.node_count = corners + centres;
    mesh.positions = (double *)memory(3 * mesh.node_count, sizeof(double));
    mesh.elements = (uint32_t *)memory(4 * 12 * centres, sizeof(uint32_t));
    for (i = 0; i < mesh.node_count; i++) {
        const size_t *m = i < corners ? corner : n, at = i < corners ? i : i - corners;
        const double shift = i < corners ? 0 : 0.5;
        mesh.positions[3 * i] = low[0] + shift + (double)(at % m[0]);
        mesh.positions[3 * i + 1] = low[1] + shift + (double)(at / m[0] % m[1]);
        mesh.positions[3 * i + 2] = low[2] + shift + (double)(at / m[0] / m[1]);
    }
    for (cell = 0; cell < centres; cell++) {
        const size_t c[3] = {cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]};
        for (k = 0; k < 3; k++) {
            const size_t a = step[(k + 1) % 3], b = step[(k + 2) % 3],
                         first = c[0] + c[1] * step[1] + c[2] * step[2] + step[k];
            const size_t ring[5] = {first, first + a, first + a + b, first + b, first};
            for (j = 0; j < 4 && c[k] + 1 < n[k]; j++) {
                uint32_t *e = mesh.elements + 4 * mesh.element_count++;
                e[0] = (uint32_t)(corners + cell);
                e[1] = (uint32_t)ring[j];
                e[2] = (uint32_t)ring[j + 1];
                e[3] = (uint32_t)(corners + cell + cell_step[k]);
            }
        }
    }
    return mesh;
}

/* Slices inside of blocks, in which neither the slice nor its clamp is parallel to anything */
static void run_meshes(void) {
    static const char *const names[MESHES] = {"tilted about x", "tilted about y", "jittered", "six a cube",
                                              "body-centred"};
    const slice s = {plate_length(), plate_width(), 0.03, 0.1, 1};
    const double truth = reference(&s, 0.3);
    int i, affine;
    for (i = 0; i < (small ? 1 : MESHES); i++) {
        const double tall = i == 1 ? 0.6 * s.length : 0.5 * s.width, low[3] = {-2.37, -3.41, -tall - 3.63};
        const size_t n[3] = {(size_t)s.length + 5, (size_t)s.width + 7, (size_t)(2 * tall) + 7};
        const double size[3] = {(double)n[0], (double)n[1], (double)n[2]};
        double drop[2];
        progress_draw("thin", done++, total, names[i]);
        for (affine = 0; affine < 2; affine++) {
            gxio_mesh mesh = i == 4 ? make_centred(n, low) : make_grid(n, low, size, i == 3 ? 6 : 5);
            probe p;
            if (i == 2 || i == 3) jitter_mesh(&mesh, 0.12);
            turn_mesh(&mesh, i == 1, i < 2 ? 30 : 17);
            p = make_probe(mesh, &s, GXS_LINEAR, 0.3, affine);
            drop[affine] = find_drop(&p, 6, 1e-4);
            free_probe(&p);
        }
        row("mesh", names[i], s.thickness, 0.3, drop[1] / truth, NAN, drop[0] / truth, 0.9);
    }
}

/* w1 of a clamped slice that is let go from its balance: six half periods by the midpoint rule, 200 steps each two */
static void run_frequency(void) {
    const slice s = {plate_length(), plate_width(), 0.37, 0.1, 0};
    const double beam = 3.51602 * s.thickness / (s.length * s.length) * sqrt(1e9 / (12 * density)),
                 dt = 2 * 3.14159265358979323846 / beam / 200;
    probe p = cut_probe(&s, 0, 1, 1);
    gx_step_desc step;
    double rest[3], at[3], last = 0, first_time = 0, end_time = 0, now;
    int crossings = 0;
    progress_draw("thin", done++, total, "frequency");
    expect(gx_body_anchor_point(p.body, &p.tip, NULL, rest, NULL) == GX_OK, "no tip");
    find_drop(&p, 4, 1e-4);
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.integrator = GXS_MIDPOINT;
    step.newton_iterations = 2;
    for (now = 0; crossings < 7; now += dt) {
        expect(gx_body_anchor_point(p.body, &p.tip, NULL, at, NULL) == GX_OK, "no tip");
        if ((at[2] - rest[2]) * last < 0) {
            end_time = now - dt * (at[2] - rest[2]) / (at[2] - rest[2] - last);
            if (crossings++ == 0) first_time = end_time;
        }
        last = at[2] - rest[2];
        expect(gx_body_step(p.body, &step, NULL, NULL) == GX_OK, "a step fails");
    }
    row("frequency", "over beam theory's", s.thickness, 0, 6 * 3.14159265358979323846 / (end_time - first_time) / beam,
        NAN, NAN, 1.05);
    free_probe(&p);
}

/* Drop over length of an inextensible clamped rod under its weight: angle'' = -k (1 - s) cos angle, angle(0) = 0,
   angle'(1) = 0, by the curvature at the clamp that does it */
static double rod_drop(double k) {
    enum { PIECES = 20000 };
    double least = 0, most = k, drop = 0;
    int round, i;
    for (round = 0; round < 60; round++) {
        double angle = 0, rate = 0.5 * (least + most), middle, middle_rate;
        const double h = 1.0 / PIECES;
        for (i = 0, drop = 0; i < PIECES; i++) { /* the midpoint rule */
            const double s = i * h;
            middle = angle + 0.5 * h * rate;
            middle_rate = rate - 0.5 * h * k * (1 - s) * cos(angle);
            drop += h * sin(middle);
            rate -= h * k * (1 - s - 0.5 * h) * cos(middle);
            angle += h * middle_rate;
        }
        *(rate > 0 ? &most : &least) = 0.5 * (least + most);
    }
    return drop;
}

static void run_large(void) {
    static const double loads[2] = {1.8198, 10.903}, aim[2] = {0.213, 0.66};
    const slice s = {plate_length(), plate_width(), 0.37, 0.1, 0};
    const double low[3] = {0, 0, 0}, size[3] = {s.length, s.width, 1};
    const size_t n[3] = {(size_t)s.length, (size_t)s.width, 1};
    int i;
    for (i = 0; i < 2; i++) {
        probe p = make_probe(make_grid(n, low, size, 5), &s, GXS_STABLE_NEO_HOOKEAN, 0, 1);
        char name[32];
        progress_draw("thin", done++, total, "large");
        p.load = loads[i] * p.young * s.thickness * s.thickness / (12 * density * pow(s.length, 3));
        snprintf(name, sizeof name, "load %g", loads[i]);
        row("large", name, s.thickness, 0, find_drop(&p, 400, 1e-4) / s.length, NAN, rod_drop(loads[i]), aim[i]);
        free_probe(&p);
    }
}

/* Iterations of conjugate gradients to 1e-2 */
static void run_balance(void) {
    static const double t[3] = {0.2, 0.1, 0.05}, aim[3] = {12, 18, 35};
    int i;
    for (i = 0; i < 3; i++) {
        const slice s = {plate_length(), plate_width(), 0.37, t[i], 0};
        probe p = cut_probe(&s, 0.3, 1, 1);
        progress_draw("thin", done++, total, "balance");
        find_drop(&p, 1, 1e-2);
        row("balance", "iterations", t[i], 0.3, p.report.cg_iterations, NAN, NAN, aim[i]);
        free_probe(&p);
    }
}

/* slab_in_five: cubes of 1 cm, 30 MPa, St. Venant-Kirchhoff, one of its slices */
static probe make_part(const slice *s, uint32_t length, uint32_t width) {
    const size_t n[3] = {length, width, 1};
    const double low[3] = {0, 0, 0}, size[3] = {length * 0.01, width * 0.01, 0.01};
    probe p;
    memset(&p, 0, sizeof p);
    p.mesh = make_grid(n, low, size, 5);
    p.young = 3e7;
    p.poisson = 0.4;
    p.load = 9.81;
    p.body = make_body(&p.mesh, GXS_ST_VENANT_KIRCHHOFF, p.young, p.poisson, 1);
    keep_slice(p.body, s);
    hold_slice(&p, s);
    return p;
}

static gx_step_desc make_step(const probe *p, double dt, uint32_t newton) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[2] = -p->load;
    step.newton_iterations = newton;
    step.clock = seconds;
    return step;
}

static void run_motion(void) {
    static const double t[3] = {1. / 5, 2. / 15, 1. / 15}, aim[3] = {12, 18, 25};
    int i;
    for (i = 0; i < 3; i++) {
        const uint32_t length = small ? 15 : 61, width = small ? 3 : 11;
        const slice s = {length * 0.01, width * 0.01, 0.0037, t[i] * 0.01, 0};
        probe p = make_part(&s, length, width);
        const gx_step_desc step = make_step(&p, 0.005, 1);
        progress_draw("thin", done++, total, "motion");
        expect(gx_body_step(p.body, &step, &p.report, NULL) == GX_OK, "a step fails");
        row("motion", "iterations", t[i], 0.4, p.report.cg_iterations, NAN, NAN, aim[i]);
        free_probe(&p);
    }
}

/* Puts the body back to rest. */
static void reset(gx_body *body) {
    gx_view view;
    expect(gx_body_view(body, &view, NULL) == GX_OK, "no view");
    memset(view.displacement, 0, 3 * view.copy_count * sizeof(double));
    memset(view.velocity, 0, 3 * view.copy_count * sizeof(double));
    if (view.affine) memset(body->copies.linear, 0, 9 * view.copy_count * sizeof(double));
    if (view.affine) memset(body->copies.linear_rate, 0, 9 * view.copy_count * sizeof(double));
}

static void time_drop(const char *method, size_t n, probe *p, const slice *s, double truth) {
    enum { RUNS = 5 };
    double ms[RUNS], drop = find_drop(p, 2, 1e-2);
    char name[48];
    gx_view view;
    size_t i, unknowns;
    int run;
    for (run = 0; run < RUNS; run++) {
        reset(p->body);
        drop = find_drop(p, 2, 1e-2);
        ms[run] = 1e3 * p->report.seconds;
    }
    expect(gx_body_view(p->body, &view, NULL) == GX_OK, "no view");
    for (i = 0, unknowns = 3 * view.copy_count; view.copy_affine && i < view.copy_count; i++)
        unknowns += 9 * view.copy_affine[i];
    snprintf(name, sizeof name, "%s x %lu", method, (unsigned long)n);
    row("cost", name, s->thickness, 0.3, fabs(drop / truth - 1), median(ms, RUNS), (double)unknowns, NAN);
    free_probe(p);
}

/* The time to an error: one balance, two of Newton's iterations to 1e-2 each; median of five */
static void run_costs(void) {
    const slice s = {8, 2, 0.37, 0.2, 0};
    const double truth = reference(&s, 0.3);
    size_t n;
    probe p;
    for (n = 1; n <= (small ? 1 : 2); n *= 2) {
        progress_draw("thin", done++, total, "cost");
        p = cut_probe(&s, 0.3, 1, n);
        time_drop("affine", n, &p, &s, truth);
    }
    for (n = 1; n <= (small ? 2 : 16); n *= 2) {
        progress_draw("thin", done++, total, "cost");
        p = cut_probe(&s, 0.3, 0, n);
        time_drop("linear", n, &p, &s, truth);
    }
    for (n = 1; n <= (small ? 1 : 4); n *= 2) {
        progress_draw("thin", done++, total, "cost");
        p = conforming_probe(&s, 0.3, s.thickness / (double)n, n, 0);
        time_drop("meshed", n, &p, &s, truth);
    }
}

static size_t iterations; /* of Newton's method in the last run of fling() */

/* Places of the tip over a run, x 3; the mean time of a step, ms */
static double fling(const slice *s, uint32_t length, double dt, size_t steps, uint32_t newton, double *at) {
    probe p = make_part(s, length, 2);
    gx_step_desc step = make_step(&p, dt, newton);
    double sum = 0;
    size_t i;
    iterations = 0;
    if (newton > MOST_NEWTON) {
        step.newton_tolerance = 1e-7;
        step.cg_tolerance = 1e-4;
    }
    for (i = 0; i < steps; i++) {
        expect(gx_body_step(p.body, &step, &p.report, NULL) == GX_OK, "a step fails");
        expect(gx_body_anchor_point(p.body, &p.tip, NULL, at + 3 * i, NULL) == GX_OK, "no tip");
        sum += p.report.seconds;
        iterations += p.report.newton_iterations;
    }
    free_probe(&p);
    return 1e3 * sum / (double)steps;
}

/* Slices of slab_in_five let go from rest: rms of the tip's distance from that of converged steps, over the run, by the
   largest displacement */
static void run_newton(void) {
    static const double t[2] = {1. / 15, 1. / 5}, dts[3] = {0.005, 1. / 60, 1. / 30};
    const uint32_t length = small ? 15 : 30;
    double *truth = (double *)memory(3 * STEPS, sizeof(double)), *at = (double *)memory(3 * STEPS, sizeof(double));
    int i, d;
    uint32_t newton;
    for (i = 0; i < (small ? 1 : 2); i++)
        for (d = small ? 2 : 0; d < 3; d++) {
            const slice s = {length * 0.01, 0.02, 0.0037, t[i] * 0.01, 0};
            const size_t steps = small ? 6 : (size_t)fmin(STEPS, 0.6 / dts[d] + 0.5);
            const double full = fling(&s, length, dts[d], steps, 60, truth);
            const double start[3] = {s.length, s.width / 2, s.low + s.thickness};
            for (newton = 0; newton <= MOST_NEWTON; newton++) {
                const double ms = fling(&s, length, dts[d], steps, newton, at);
                double sum = 0, most = 0;
                char name[48];
                size_t k;
                progress_draw("thin", done++, total, "newton");
                for (k = 0; k < steps; k++) {
                    const double *a = at + 3 * k, *b = truth + 3 * k,
                                 u[3] = {b[0] - start[0], b[1] - start[1], b[2] - start[2]};
                    sum += pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2);
                    most = fmax(most, sqrt(gxp_dot(u, u)));
                }
                if (newton > 0)
                    snprintf(name, sizeof name, "%lu in %.3g ms", (unsigned long)newton, 1e3 * dts[d]);
                else
                    snprintf(name, sizeof name, "default (%.1f) in %.3g ms", (double)iterations / (double)steps,
                             1e3 * dts[d]);
                row("newton", name, t[i], 0.4, sqrt(sum / (double)steps) / most, ms, full, 0.05);
            }
        }
    free(truth);
    free(at);
}

/* ns that a product takes for each element of a slice, the least of several short runs; affine: as
 * gx_body_desc.affine_below */
static double time_product(const slice *s, double affine, size_t *elements) {
    enum { RUNS = 25, MOST = 20000 };
    probe p = cut_probe(s, 0.3, affine, 1);
    const gx_step_desc step = make_step(&p, 0.005, 1);
    gxsp_system *system;
    gxs_model model;
    double least = HUGE_VAL;
    size_t i, k, count;
    int run;
    expect(gx_body_step(p.body, &step, NULL, NULL) == GX_OK, "a step fails");
    expect(gx_body_model(p.body, &model, NULL) == GX_OK, "no model");
    *elements = model.element_count;
    count = MOST / model.element_count + 1;
    system = p.body->solver->system;
    for (i = 0; i < system->model.n; i++)
        for (k = 0; k < 3; k++) system->vectors.search[i][k] = (float)((i * 7 + k * 3) % 11) - 5;
    for (run = 0; run < RUNS; run++) {
        const double start = seconds(NULL);
        for (i = 0; i < count; i++) gxsp_product(system, 1e4, system->vectors.search, system->vectors.product);
        least = fmin(least, 1e9 * (seconds(NULL) - start) / (double)(count * model.element_count));
    }
    free_probe(&p);
    return least;
}

static void run_product(void) {
    static const double widths[2] = {4, 40};
    int i;
    for (i = 0; i < (small ? 1 : 2); i++) {
        const slice s = make_slice(15 * (i + 1), widths[i], 0.37, 0.2);
        size_t elements;
        const double bent = time_product(&s, 1, &elements), linear = time_product(&s, 0, &elements);
        char name[32];
        progress_draw("thin", done++, total, "product");
        snprintf(name, sizeof name, "%lu", (unsigned long)elements);
        row("product", name, s.thickness, 0.3, bent, bent / linear, linear, 8);
    }
}

int main(int argc, char **argv) {
    const char *path = csv_arguments(argc, argv, &small);
    const char *only = getenv("THIN");
    static void (*const series[])(void) = {run_placements, run_slices, run_meshes, run_frequency, run_large,
                                           run_balance,    run_motion, run_costs,  run_newton,    run_product};
    size_t i;
    csv_open(argv[0], path, "series,case,thickness,poisson,value,most,linear,aim");
    total = small ? 65 : 92;
    fprintf(stderr, "%-10s %-22s %7s %6s %12s %12s %12s %10s\n", "series", "case", "t", "nu", "value", "most", "linear",
            "aim");
    for (i = 0; i < sizeof series / sizeof series[0]; i++)
        if (!only || strchr(only, '0' + (int)i)) series[i]();
    progress_draw("thin", total, total, "");
    return csv_close();
}
