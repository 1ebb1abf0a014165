/* quadrature.c - integrals over a part of a cut element: how exact they are and how long they take. RXFEM's Table 1
   and its surroundings.

   usage: quadrature [FILE [--small]]; rows go to stdout and to FILE, a table to stderr. --small: a tenth of the time
   for each.

   The unit tetrahedron is cut. Integrands are those of the table, over the part at the origin:
       plane    x + y + z <= 0.3 (RXFEM's, by its 560 of 50^3 samples)
       kink     z + |x - y - 1/16| <= 0.3 (chosen here: the paper does not give its own)
       sphere   octant of radius 0.5 about the origin (RXFEM's, by its 8219 samples), as triangles of a patch around
                it
       spheres  the same with more and more triangles

   truth: exact moments of the same triangles (bench/part.h; tests/test_baselines.c compares it with rationals). The
   distance of triangles from the round sphere is charted apart, as method "triangles". No method is charged with it.

   Columns and knobs:
       triangles   the number that meet the element
       gxfem       no knob: gx_body_cut; integrals are read off the part's mass block
       positive    degree of a rule with positive weights at inner points (bench/sampling.h), from the arrangement
       rxfem       degree of the volume rule; 2 as published. "clipped": interface points only inside the element
       adaptive    depth; 4 as published. One point or four, by the integrand's degree
       regular     cells along an edge; 50 as published
       published   the values of RXFEM's Table 1
       error       relative to truth; error_of_element: relative to the integral over the whole element
       points      of the rule, in the part
       geometry_us where the surface meets the element (gxfem: arrangement and enrichment; adaptive and regular: an
       index of the triangles)
       rule_us     what follows; for gxfem and rxfem both sides of the cut
       evaluate_us one elastic evaluation (St. Venant-Kirchhoff stress and nodal forces) at each point of the part;
       for gxfem and "rxfem one" one for the part, in which F is constant
       amortised_us  evaluate_us and the share of the rest in EVALUATIONS of them

   Times are the least of many calls: where the machine has other work, a median measures the other work. */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#define BENCH "quadrature"
#include "expect.h"
#include "clock.h"
#include "csv.h"
#include "part.h"
#include "progress.h"
#include "rxfem.h"
#include "sampling.h"

enum { INTEGRANDS = 4, EVALUATIONS = 1000, LARGEST = 32 };
static double patience = 0.3; /* s, for a method at a knob */
static const double PI = 3.14159265358979323846;

static const char *const integrand_name[INTEGRANDS] = {"1", "x+y+z", "yz+xz+xy", "xx+yy+zz"};
static const double whole[INTEGRANDS] = {1.0 / 6, 1.0 / 8, 1.0 / 40, 1.0 / 20}; /* over the unit tetrahedron */
static const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t element[4] = {0, 1, 2, 3};

typedef struct region {
    char name[16];
    double *vertices;
    uint32_t *triangles;
    size_t vertex_count, triangle_count;
    size_t met; /* triangles that meet the element */
    double truth[INTEGRANDS];
} region;

/* One call of a method, or the least times of many */
typedef struct run {
    const char *method;
    char knob[24];
    double value[INTEGRANDS];
    size_t points;
    double geometry, rule, evaluate; /* us */
} run;

/* ---- regions ---- */

static region region_make(const char *name, size_t vertices, size_t triangles) {
    region r;
    memset(&r, 0, sizeof r);
    snprintf(r.name, sizeof r.name, "%s", name);
    r.vertices = (double *)dense_memory(NULL, 3 * vertices, sizeof(double));
    r.triangles = (uint32_t *)dense_memory(NULL, 3 * triangles, sizeof(uint32_t));
    r.vertex_count = vertices;
    r.triangle_count = triangles;
    return r;
}

static void region_free(region *r) {
    free(r->vertices);
    free(r->triangles);
}

/* The four integrands from 1, x y z, xx xy xz yy yz zz */
static void integrands_of(const double m[10], double value[INTEGRANDS]) {
    value[0] = m[0];
    value[1] = m[1] + m[2] + m[3];
    value[2] = m[8] + m[6] + m[5];
    value[3] = m[4] + m[7] + m[9];
}

static rx_rules *rules[RX_DEGREE_MAX + 1][2]; /* By degree and clipping: made once for all elements */

static rx_body *cut_rxfem(const region *r, rx_rules *by) {
    rx_body *body = rx_body_create(by, corners, 4, element, 1);
    rx_surface surface;
    surface.vertices = r->vertices;
    surface.vertex_count = r->vertex_count;
    surface.triangles = r->triangles;
    surface.triangle_count = r->triangle_count;
    body->clock = seconds;
    expect(rx_body_cut(body, &surface) == RX_OK && body->piece_count == 2, "rxfem refuses the cut");
    return body;
}

static void find_truth(region *r) {
    rx_body *counted = cut_rxfem(r, rules[2][0]);
    part p = part_create(corners, r->vertices, r->triangles, r->triangle_count, 0);
    long double m[10];
    double rounded[10];
    int i;
    part_moments(&p, m);
    for (i = 0; i < 10; i++) rounded[i] = (double)m[i];
    integrands_of(rounded, r->truth);
    r->met = counted->contact_count;
    part_free(&p);
    rx_body_destroy(counted);
}

/* 0.3 times powers of two, so that the triangle's corners are exactly in the plane of the double 0.3 */
static region make_plane(void) {
    static const double corner[9] = {4, -4, 1, 1, 4, -4, -4, 1, 4};
    region r = region_make("plane", 3, 1);
    uint32_t i;
    for (i = 0; i < 9; i++) r.vertices[i] = 0.3 * corner[i];
    for (i = 0; i < 3; i++) r.triangles[i] = i;
    find_truth(&r);
    return r;
}

/* Two triangles that meet along x - y = 1/16, z = 0.3 */
static region make_kink(void) {
    static const double corner[12] = {-0.9375, -1, 0.3, 2.0625, 2, 0.3, 2.0625, -1, 0.3 - 3, -0.9375, 2, 0.3 - 3};
    static const uint32_t triangles[6] = {0, 2, 1, 0, 1, 3};
    region r = region_make("kink", 4, 2);
    memcpy(r.vertices, corner, sizeof corner);
    memcpy(r.triangles, triangles, sizeof triangles);
    find_truth(&r);
    return r;
}

/* Directions around (1, 1, 1) by two angles, turned so that no edge lies along a face of the element. 1.2 rad
   reaches past the axes, which are 0.96 rad away. */
static void sphere_point(double u, double v, double radius, double x[3]) {
    const double turned[2] = {0.8 * tan(u) - 0.6 * tan(v), 0.6 * tan(u) + 0.8 * tan(v)};
    double length = radius / sqrt(1 + turned[0] * turned[0] + turned[1] * turned[1]);
    int a;
    for (a = 0; a < 3; a++) {
        static const double frame[3][3] = {{1, -1, 0}, {1, 1, -2}, {1, 1, 1}};
        x[a] = length * (turned[0] * frame[0][a] / sqrt(2) + turned[1] * frame[1][a] / sqrt(6) + frame[2][a] / sqrt(3));
    }
}

static region make_sphere(const char *name, uint32_t n) {
    region r = region_make(name, ((size_t)n + 1) * (n + 1), 2 * (size_t)n * n);
    uint32_t i, j, *t = r.triangles;
    for (i = 0; i <= n; i++)
        for (j = 0; j <= n; j++)
            sphere_point(-1.2 + 2.4 * i / n, -1.2 + 2.4 * j / n, 0.5, r.vertices + 3 * (i * ((size_t)n + 1) + j));
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++, t += 6) {
            const uint32_t a = i * (n + 1) + j, b = a + n + 1;
            t[0] = t[3] = a;
            t[1] = b;
            t[2] = t[4] = b + 1;
            t[5] = a + 1;
        }
    find_truth(&r);
    return r;
}

/* ---- evaluations ---- */

/* F of the same linear field, its St. Venant-Kirchhoff stress, and each point's contribution to the forces of
   corners 1, 2 and 3 */
static double evaluate(size_t points) {
    static const gxs_material material = {GXS_ST_VENANT_KIRCHHOFF, 1e6, 0.4, 0, NULL, NULL};
    double u[3][3] = {{0.1, 0.02, 0.03}, {0.01, -0.05, 0.02}, {0.04, 0.01, 0.07}}, force[9] = {0}, f[9], stress[9],
           sum = 0;
    size_t i, k;
    for (i = 0; i < points; i++) {
        for (k = 0; k < 9; k++) f[k] = (k % 4 == 0) + u[k % 3][k / 3];
        gxs_material_stress(&material, f, stress);
        for (k = 0; k < 9; k++) force[k] += 1e-3 * stress[k];
        u[0][0] = force[0] * 1e-12 + 0.1; /* makes the next point depend on this one, so that it is not optimised away
                                           */
    }
    for (k = 0; k < 9; k++) sum += force[k];
    return sum;
}

static volatile double kept;

static double evaluate_us(size_t points) {
    double least = HUGE_VAL;
    size_t i, repeats = 1 + 20000 / (points + 1), k;
    for (i = 0; i < 15; i++) {
        const double start = seconds(NULL);
        for (k = 0; k < repeats; k++) kept = evaluate(points);
        least = fmin(least, 1e6 * (seconds(NULL) - start) / (double)repeats);
    }
    return least;
}

/* ---- methods: one call ---- */

static void integrate(const double *points, size_t stride, const double *weights, size_t weight_stride, size_t count,
                      double value[INTEGRANDS]) {
    size_t i;
    memset(value, 0, INTEGRANDS * sizeof *value);
    for (i = 0; i < count; i++) {
        const double *x = points + stride * i, w = weights[weight_stride * i];
        value[0] += w;
        value[1] += w * (x[0] + x[1] + x[2]);
        value[2] += w * (x[1] * x[2] + x[0] * x[2] + x[0] * x[1]);
        value[3] += w * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    }
}

/* The mass is the integral of lambda_i lambda_j (density 1). lambda 1, 2, 3 are x, y, z, and the lambdas add up to
   1. */
static void integrate_mass(const double mass[10], double value[INTEGRANDS]) {
    static const int packed[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    int i, j;
    memset(value, 0, INTEGRANDS * sizeof *value);
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++) {
            value[0] += mass[packed[i][j]];
            if (i > 0) value[1] += mass[packed[i][j]];
        }
    value[2] = mass[5] + mass[6] + mass[8];
    value[3] = mass[4] + mass[7] + mass[9];
}

/* The part at node 0: it has the copy of that node with material at x < 1e-300. */
static void read_part(gx_body *body, double value[INTEGRANDS]) {
    const gx_region beside = gx_region_half_space(0, -1, 1e-300);
    gxs_model model;
    size_t i, at = 2;
    expect(gx_body_hold(body, &beside, 1, NULL) == GX_OK, "node 0 cannot be held");
    expect(gx_body_model(body, &model, NULL) == GX_OK && model.element_count == 2, "the cut does not make two parts");
    for (i = 0; i < 2; i++)
        if (model.held[model.elements[i].copy[0]]) at = i;
    expect(at < 2, "no part is at node 0");
    integrate_mass(model.elements[at].mass, value);
}

static void call_gxfem(const region *r, int knob, int option, run *out) {
    gx_body_desc desc;
    gx_surface sheet;
    gx_cut_desc cut;
    gx_cut_report report;
    gx_body *body = NULL;
    double start;
    (void)knob;
    (void)option;
    memset(&desc, 0, sizeof desc);
    memset(&sheet, 0, sizeof sheet);
    memset(&cut, 0, sizeof cut);
    desc.positions = corners;
    desc.node_count = 4;
    desc.elements = element;
    desc.element_count = 1;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1;
    desc.clock = seconds;
    sheet.vertices = r->vertices;
    sheet.vertex_count = r->vertex_count;
    sheet.triangles = r->triangles;
    sheet.triangle_count = r->triangle_count;
    cut.surfaces = &sheet;
    cut.surface_count = 1;
    expect(gx_body_create(&desc, &body, NULL) == GX_OK, "no body");
    start = seconds(NULL);
    expect(gx_body_cut(body, &cut, &report, NULL) == GX_OK, "the cut failed");
    start = seconds(NULL) - start;
    out->rule = 1e6 * report.seconds_integrals;
    out->geometry = 1e6 * start - out->rule;
    out->points = 1;
    read_part(body, out->value);
    gx_body_destroy(body);
}

static void positive_rule(part *p, unsigned degree, sampling_rule *rule) {
    double moments[SAMPLING_MONOMIALS], work[SAMPLING_MONOMIALS];
    part_shape inside = part_tetrahedra(p), boundary = part_boundary(p);
    uint32_t *index = (uint32_t *)dense_memory(NULL, 3 * boundary.count, sizeof(uint32_t)), i;
    gxi_surface surface;
    for (i = 0; i < 3 * boundary.count; i++) index[i] = i;
    surface.positions = boundary.corners;
    surface.position_count = 3 * boundary.count;
    surface.triangles = index;
    surface.triangle_count = boundary.count;
    expect(gxi_polyhedron_monomials(&surface, NULL, degree, moments, work, NULL) == GX_OK, "no moments");
    sampling_positive(inside.corners, inside.count, degree, moments, rule);
    free(index);
    free(inside.corners);
    free(boundary.corners);
}

static void call_positive(const region *r, int knob, int option, run *out) {
    sampling_rule rule;
    double start = seconds(NULL);
    part p = part_create(corners, r->vertices, r->triangles, r->triangle_count, 0);
    (void)option;
    memset(&rule, 0, sizeof rule);
    out->geometry = 1e6 * (seconds(NULL) - start);
    start = seconds(NULL);
    positive_rule(&p, (unsigned)knob, &rule);
    out->rule = 1e6 * (seconds(NULL) - start);
    out->points = rule.count;
    integrate(rule.points, 4, rule.points + 3, 4, rule.count, out->value);
    sampling_free(&rule);
    part_free(&p);
}

/* The surface's front is outside: the part is RXFEM's piece on the minus side. */
static void call_rxfem(const region *r, int knob, int option, run *out) {
    rx_body *body = cut_rxfem(r, rules[knob][option & 1]);
    double weights[2][RX_POINTS], start;
    size_t i, minus;
    start = seconds(NULL);
    for (i = 0; i < 2; i++) rx_weights(body->rules, body->pieces[i].moments, weights[i]);
    out->rule = 1e6 * (body->seconds_rules + seconds(NULL) - start);
    out->geometry = 1e6 * body->seconds_path;
    minus = body->pieces[0].plus ? 1 : 0;
    out->points = option & 2 ? 1 : body->rules->volume.point_count;
    integrate(body->rules->volume.points[0], 3, weights[minus], 1, body->rules->volume.point_count, out->value);
    rx_body_destroy(body);
}

/* Degree 1 for the first two integrands, 2 for the others; times are those of degree 2 */
static void call_adaptive(const region *r, int knob, int option, run *out) {
    double start = seconds(NULL), value[INTEGRANDS];
    sampling_surface surface = sampling_surface_create(r->vertices, r->triangles, r->triangle_count);
    const sampling_region under = sampling_under(&surface);
    sampling_rule rule;
    (void)option;
    memset(&rule, 0, sizeof rule);
    out->geometry = 1e6 * (seconds(NULL) - start);
    sampling_adaptive(&under, 1, knob, &rule);
    integrate(rule.points, 4, rule.points + 3, 4, rule.count, value);
    start = seconds(NULL);
    sampling_adaptive(&under, 2, knob, &rule);
    out->rule = 1e6 * (seconds(NULL) - start);
    out->points = rule.count;
    integrate(rule.points, 4, rule.points + 3, 4, rule.count, out->value);
    memcpy(out->value, value, 2 * sizeof(double));
    sampling_free(&rule);
    sampling_surface_free(&surface);
}

static void call_regular(const region *r, int knob, int option, run *out) {
    double start = seconds(NULL);
    sampling_surface surface = sampling_surface_create(r->vertices, r->triangles, r->triangle_count);
    const sampling_region under = sampling_under(&surface);
    sampling_rule rule;
    (void)option;
    memset(&rule, 0, sizeof rule);
    out->geometry = 1e6 * (seconds(NULL) - start);
    start = seconds(NULL);
    sampling_regular(&under, knob, &rule);
    out->rule = 1e6 * (seconds(NULL) - start);
    out->points = rule.count;
    integrate(rule.points, 4, rule.points + 3, 4, rule.count, out->value);
    sampling_free(&rule);
    sampling_surface_free(&surface);
}

/* ---- runs ---- */

typedef void (*call_fn)(const region *r, int knob, int option, run *out);
/* Knobs end with 0 */
typedef struct method {
    const char *name;
    call_fn call;
    int option;
    int knobs[8];
} method;

/* clang-format off */
static const method methods[] = {
    {"gxfem", call_gxfem, 0, {1, 0}},
    {"positive", call_positive, 0, {1, 2, 3, 4, 0}},
    {"rxfem", call_rxfem, 0, {1, 2, 3, 4, 0}},
    {"rxfem one", call_rxfem, 2, {1, 2, 3, 4, 0}},
    {"rxfem clipped", call_rxfem, 1, {1, 2, 3, 4, 0}},
    {"adaptive", call_adaptive, 0, {1, 2, 3, 4, 5, 6, 0}},
    {"regular", call_regular, 0, {5, 10, 25, 50, 100, 0}}};
/* clang-format on */
enum { METHODS = sizeof methods / sizeof methods[0] };

static run measure(const region *r, const method *m, int knob) {
    const double start = seconds(NULL);
    double geometry = HUGE_VAL, rule = HUGE_VAL;
    size_t n = 0;
    run out;
    memset(&out, 0, sizeof out);
    do {
        m->call(r, knob, m->option, &out);
        geometry = fmin(geometry, out.geometry);
        rule = fmin(rule, out.rule);
    } while (++n < 3 || seconds(NULL) - start < patience);
    out.method = m->name;
    if (m->call == call_gxfem)
        snprintf(out.knob, sizeof out.knob, "-");
    else
        snprintf(out.knob, sizeof out.knob, "%d", knob);
    out.geometry = geometry;
    out.rule = rule;
    out.evaluate = evaluate_us(out.points);
    return out;
}

static double error_of_element(const region *r, const run *m, int i) {
    return fabs(m->value[i] - r->truth[i]) / whole[i];
}

static void print_run(const region *r, const run *m) {
    int i;
    for (i = 0; i < INTEGRANDS; i++)
        csv_row("%s,%lu,%s,%s,%s,%.17g,%.17g,%.3e,%.3e,%lu,%.3f,%.3f,%.4f,%.4f", r->name, (unsigned long)r->met,
                m->method, m->knob, integrand_name[i], m->value[i], r->truth[i], fabs(m->value[i] / r->truth[i] - 1),
                error_of_element(r, m, i), (unsigned long)m->points, m->geometry, m->rule, m->evaluate,
                m->evaluate + (m->geometry + m->rule) / EVALUATIONS);
}

/* The error of the triangles against the round octant. Its integrals are pi r^3 / 6, 3 pi r^4 / 16, r^5 / 5, pi r^5
   / 10. */
static void print_triangles(const region *r) {
    const double round[INTEGRANDS] = {PI / 48, 3 * PI / 256, 1.0 / 160, PI / 320};
    int i;
    for (i = 0; i < INTEGRANDS; i++)
        csv_row("%s,%lu,triangles,-,%s,%.17g,%.17g,%.3e,%.3e,,,,,", r->name, (unsigned long)r->met, integrand_name[i],
                r->truth[i], round[i], fabs(r->truth[i] / round[i] - 1), fabs(r->truth[i] - round[i]) / whole[i]);
}

/* ---- RXFEM's Table 1: relative errors against the analytic integrals, and contributing points (for adaptive: those
   of degree 2) ---- */

typedef struct published {
    const char *region, *method, *knob;
    double error[INTEGRANDS];
    size_t points;
} published;

/* clang-format off */
static const published table_1[] = {
    {"plane", "rxfem", "2", {3.32e-5, 4.43e-5, 5.54e-5, 5.54e-5}, 24},
    {"plane", "regular", "50", {4.44e-3, 4.44e-3, 9.78e-1, 5.00e-1}, 560},
    {"plane", "adaptive", "4", {5.79e-2, 8.19e-2, 9.25e-1, 4.94e-1}, 181},
    {"its kink", "rxfem", "2", {2.99e-6, 6.50e-6, 1.26e-5, 1.38e-5}, 24},
    {"its kink", "regular", "50", {4.94e-4, 4.89e-4, 2.50e-3, 1.10e-4}, 3795},
    {"its kink", "adaptive", "4", {1.54e-2, 2.16e-2, 1.86e-2, 1.72e-2}, 2512},
    {"sphere", "rxfem", "2", {3.88e-4, 5.15e-4, 6.43e-4, 6.46e-4}, 24},
    {"sphere", "regular", "50", {4.62e-3, 6.23e-3, 7.60e-3, 7.71e-3}, 8219},
    {"sphere", "adaptive", "4", {1.21e-2, 1.65e-2, 1.30e-3, 1.79e-4}, 3073}};
/* clang-format on */

static void print_published(void) {
    size_t i, k;
    for (i = 0; i < sizeof table_1 / sizeof table_1[0]; i++) {
        const published *p = &table_1[i];
        for (k = 0; k < INTEGRANDS; k++)
            csv_row("%s,,published %s,%s,%s,,,%.2e,,%lu,,,,", p->region, p->method, p->knob, integrand_name[k],
                    p->error[k], (unsigned long)p->points);
        fprintf(stderr, "%-9s %9s %-14s %-4s %9.2e %9.2e %9.2e %9.2e %9s %7lu   in RXFEM's Table 1\n", p->region, "",
                p->method, p->knob, p->error[0], p->error[1], p->error[2], p->error[3], "", (unsigned long)p->points);
    }
}

/* ---- the table ---- */

enum { ROWS = 128 };
typedef struct row {
    char region[16];
    size_t triangles;
    run run;
    double error[INTEGRANDS], of_element;
} row;
static row rows[ROWS];
static size_t row_count;

static void keep_row(const region *r, const run *m) {
    row *at = &rows[row_count++];
    int i;
    expect(row_count <= ROWS, "more rows than there is room for");
    memcpy(at->region, r->name, sizeof at->region);
    at->triangles = r->met;
    at->run = *m;
    at->of_element = 0;
    for (i = 0; i < INTEGRANDS; i++) {
        at->error[i] = fabs(m->value[i] / r->truth[i] - 1);
        at->of_element = fmax(at->of_element, error_of_element(r, m, i));
    }
}

static void print_table(void) {
    size_t i;
    fprintf(stderr, "%-9s %9s %-14s %-4s %9s %9s %9s %9s %9s %7s %10s %10s %10s\n", "region", "triangles", "method",
            "knob", "1", "x+y+z", "yz+xz+xy", "xx+yy+zz", "of elem.", "points", "geometry us", "rule us",
            "evaluate us");
    for (i = 0; i < row_count; i++) {
        const row *r = &rows[i];
        fprintf(stderr, "%-9s %9lu %-14s %-4s %9.2e %9.2e %9.2e %9.2e %9.2e %7lu %10.2f %10.2f %10.3f\n", r->region,
                (unsigned long)r->triangles, r->run.method, r->run.knob, r->error[0], r->error[1], r->error[2],
                r->error[3], r->of_element, (unsigned long)r->run.points, r->run.geometry, r->run.rule,
                r->run.evaluate);
    }
}

/* The row of RXFEM's published rule on the region of row i; NULL: there is none */
static const row *published_row(size_t i) {
    size_t j;
    for (j = i + 1; j < row_count; j++)
        if (strcmp(rows[j].run.method, "rxfem") == 0 && strcmp(rows[j].run.knob, "2") == 0) return &rows[j];
    return NULL;
}

/* For each region: is gxfem within 1e-14 of the element, and its whole cut cheaper than making RXFEM's rule alone? */
static void print_verdict(void) {
    size_t i, within = 0, regions = 0, dearer = 0;
    for (i = 0; i < row_count; i++) {
        const row *r = &rows[i], *by = strcmp(r->run.method, "gxfem") == 0 ? published_row(i) : NULL;
        const double cut = r->run.geometry + r->run.rule;
        if (!by) continue;
        regions++;
        within += r->of_element <= 1e-14;
        dearer += cut > by->run.rule;
        fprintf(stderr,
                "%s, %lu triangles: gxfem %s 1e-14 of the element (%.1e); cut %.1f us, RXFEM's rule %.1f us (%.2f "
                "x%s), its path %.1f us\n",
                r->region, (unsigned long)r->triangles, r->of_element <= 1e-14 ? "within" : "BEYOND", r->of_element,
                cut, by->run.rule, by->run.rule / cut, cut > by->run.rule ? ": RXFEM IS CHEAPER" : "",
                by->run.geometry);
    }
    fprintf(stderr,
            "gxfem: all four integrals within 1e-14 of the element in %lu of %lu regions, cheaper than RXFEM's rule in "
            "%lu\n",
            (unsigned long)within, (unsigned long)regions, (unsigned long)(regions - dearer));
    if (dearer > 0)
        fprintf(stderr, "where not: the cut divides the element by each of its triangles, exactly; the rule fits the "
                        "same few functions however many "
                        "triangles there are, and is off by what that leaves\n");
}

/* ---- */

static size_t done, total;

static void run_method(const region *r, const method *m, int knob) {
    run out;
    progress_draw("quadrature", done++, total, m->name);
    out = measure(r, m, knob);
    print_run(r, &out);
    keep_row(r, &out);
}

static void run_region(region *r) {
    size_t i, k;
    for (i = 0; i < METHODS; i++)
        for (k = 0; methods[i].knobs[k]; k++) run_method(r, &methods[i], methods[i].knobs[k]);
    region_free(r);
}

/* gxfem, rxfem and rxfem clipped on finer and finer triangles */
static void run_spheres(void) {
    uint32_t n;
    for (n = 2; n <= LARGEST; n *= 2) {
        region r = make_sphere("spheres", n);
        print_triangles(&r);
        run_method(&r, &methods[0], methods[0].knobs[0]);
        run_method(&r, &methods[2], 2);
        run_method(&r, &methods[4], 2);
        region_free(&r);
    }
}

static size_t count_runs(void) {
    size_t i, k, count = 0;
    uint32_t n;
    for (i = 0; i < METHODS; i++)
        for (k = 0; methods[i].knobs[k]; k++) count += 3;
    for (n = 2; n <= LARGEST; n *= 2) count += 3;
    return count;
}

int main(int argc, char **argv) {
    region made;
    int degree, clip, small;
    const char *path = csv_arguments(argc, argv, &small);
    if (small) patience /= 10;
    csv_open(argv[0], path,
             "region,triangles,method,knob,integrand,value,truth,error,error_of_element,points,geometry_us,rule_us,"
             "evaluate_us,"
             "amortised_us");
    for (degree = 1; degree <= RX_DEGREE_MAX; degree++)
        for (clip = 0; clip < 2; clip++) rules[degree][clip] = rx_rules_create((unsigned)degree, clip);
    total = count_runs();
    made = make_plane();
    run_region(&made);
    made = make_kink();
    run_region(&made);
    made = make_sphere("sphere", 8);
    run_region(&made);
    run_spheres();
    progress_draw("quadrature", done, total, "");
    print_table();
    print_published();
    print_verdict();
    for (degree = 1; degree <= RX_DEGREE_MAX; degree++)
        for (clip = 0; clip < 2; clip++) rx_rules_destroy(rules[degree][clip]);
    return csv_close();
}
