/* accuracy.c - how close static solutions come to closed forms and published values, and with which order.

   usage: accuracy [FILE [--small]]; rows go to stdout and to FILE, a table to stderr. --small leaves out the finest
   meshes.

   Columns:
       value, reference  in the units that the case's comment gives
       order             log(error / error before) / log(h / h before) within a case
       imbalance         the largest force left on a free copy over the largest reaction or load. Where it is not
                         small the solve has not converged, whatever value says
       newton, cg        iterations

   Linear tetrahedra can represent homogeneous states, so these must come out to the tolerance of the solver. All
   other cases converge from the stiff side: the elements lock in bending, and coarse levels are off by tens of
   percent. The rows show it. Where the reference is a model (beams) or an extrapolation (Cook), its own error is the
   limit. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_SOLVE_IMPLEMENTATION
#include "../gxfem_solve.h"

#include "csv.h"
#include "forms.h"
#include "mesh.h"
#include "progress.h"
#include "averaged.h"

static const double pi = 3.14159265358979323846;

static const char *const kind_name[] = {"stable neo-Hookean", "St. Venant-Kirchhoff", "fixed corotated", "linear"};
enum { KINDS = 4, CASES = 10, MOST_SERIES = 40 };

static int small;
static size_t done; /* cases */

/* The finest mesh of a case: cells along an edge */
static size_t finest_of(size_t n) { return small ? n / 2 : n; }

/* ---- rows */

/* Of the last solve */
static double imbalance;
static gxs_step_report report;

/* A quantity under refinement; n: cells along an edge */
typedef struct series {
    char name[80];
    const char *quantity, *source;
    double n, error;
} series;

static series series_make(const char *name, const char *of, const char *quantity, const char *source) {
    series s;
    memset(&s, 0, sizeof s);
    snprintf(s.name, sizeof s.name, "%s%s%s", name, *of ? " " : "", of);
    s.quantity = quantity;
    s.source = source;
    return s;
}

/* For the table: the last row of each refined series; for the others, the worst row */
typedef struct last_row {
    series of;
    char order[32];
    size_t elements;
} last_row;

static last_row last_rows[MOST_SERIES];
static size_t last_count, single_count;
static double single_worst;

static void keep_single(double error) {
    single_count++;
    single_worst = fmax(single_worst, error);
}

static void keep_last(const series *s, size_t elements, const char *order) {
    size_t i = 0;
    while (i < last_count &&
           (strcmp(last_rows[i].of.name, s->name) != 0 || strcmp(last_rows[i].of.quantity, s->quantity) != 0))
        i++;
    expect(i < MOST_SERIES, "more series than there is room for");
    last_count = i == last_count ? i + 1 : last_count;
    last_rows[i].of = *s;
    last_rows[i].elements = elements;
    snprintf(last_rows[i].order, sizeof last_rows[i].order, "%s", order);
}

static void print_table(void) {
    size_t i;
    fprintf(stderr, "homogeneous states: %lu quantities, largest error %.1e\n", (unsigned long)single_count,
            single_worst);
    fprintf(stderr, "%-46s %-22s %9s %9s %6s\n", "case, its finest mesh", "quantity", "elements", "error", "order");
    for (i = 0; i < last_count; i++)
        fprintf(stderr, "%-46s %-22s %9lu %9.1e %6s\n", last_rows[i].of.name, last_rows[i].of.quantity,
                (unsigned long)last_rows[i].elements, last_rows[i].of.error, last_rows[i].order);
}

/* error relative to scale */
static void series_row_scaled(series *s, size_t elements, double n, double value, double reference, double scale) {
    double error = fabs(value - reference) / fabs(scale);
    char order[32] = "";
    if (s->n > 0 && s->error > 0 && error > 0)
        snprintf(order, sizeof order, "%.2f", log(s->error / error) / log(n / s->n));
    csv_row("%s,%s,%lu,%.10g,%.10g,%.3e,%s,%s,%.1e,%u,%u", s->name, s->quantity, (unsigned long)elements, value,
            reference, error, s->source, order, imbalance, (unsigned)report.newton_iterations,
            (unsigned)report.cg_iterations);
    s->n = n;
    s->error = error;
    if (n > 0)
        keep_last(s, elements, order);
    else
        keep_single(error);
}

static void series_row(series *s, size_t elements, double n, double value, double reference) {
    series_row_scaled(s, elements, n, value, reference, reference);
}

/* ---- static equilibrium */

/* The largest force on a free copy, found without the solver's own residual */
static double measure_imbalance(const scene *s) {
    double *g = (double *)memory(3 * s->model.copy_count, sizeof(double)), left = 0, largest = 0;
    size_t i;
    form_gradient(&s->model, s->displacement, g);
    for (i = 0; i < 3 * s->model.copy_count; i++) {
        largest = fmax(largest, fmax(s->held[i / 3] ? fabs(g[i]) : 0, fabs(s->forces[i])));
        left = fmax(left, s->held[i / 3] ? 0 : fabs(g[i] - s->forces[i]));
    }
    free(g);
    return left / largest;
}

/* Minimum of U(u) - f . u from the present displacement, held copies at their targets. */
static void solve(scene *s, const char *what) {
    gxs_step_desc step;
    progress_draw("accuracy", done, CASES, what);
    memset(&step, 0, sizeof step);
    step.integrator = GXS_STATIC;
    step.forces = s->forces;
    step.targets = s->targets;
    step.newton_iterations = 100;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-4;
    report = scene_step(s, &step);
    imbalance = measure_imbalance(s);
}

/* Holds the copies whose rest position has this coordinate. */
static void hold_plane(scene *s, size_t axis, double value) {
    size_t i;
    for (i = 0; i < s->model.copy_count; i++)
        if (fabs(s->rest[3 * i + axis] - value) < 1e-9) s->held[i] = 1;
}

static double energy(const scene *s) {
    double sum = 0;
    sum = form_energy(&s->model, s->displacement);
    return sum;
}

/* dU/du. On held copies it is the force that holds them; applied forces are subtracted. */
static double *reactions(const scene *s) {
    double *g = (double *)memory(3 * s->model.copy_count, sizeof(double));
    size_t i;
    form_gradient(&s->model, s->displacement, g);
    for (i = 0; i < s->model.copy_count; i++)
        if (!s->held[i]) g[3 * i] = g[3 * i + 1] = g[3 * i + 2] = 0;
    return g;
}

/* Mean first Piola-Kirchhoff stress, if all the boundary is held: sum of reactions times rest positions over the
   volume */
static void mean_stress(const scene *s, double volume, double stress[9]) {
    double *g = reactions(s);
    size_t i, r, c;
    memset(stress, 0, 9 * sizeof(double));
    for (i = 0; i < s->model.copy_count; i++)
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++) stress[3 * r + c] += g[3 * i + r] * s->rest[3 * i + c] / volume;
    free(g);
}

static size_t nearest(const scene *s, double x, double y, double z) {
    size_t i, best = 0;
    double least = HUGE_VAL;
    for (i = 0; i < s->model.copy_count; i++) {
        const double *p = s->rest + 3 * i, dx = p[0] - x, dy = p[1] - y, dz = p[2] - z, d = dx * dx + dy * dy + dz * dz;
        if (d < least) {
            least = d;
            best = i;
        }
    }
    expect(least < 1e-12 * (1 + x * x + y * y + z * z), "no node where one is looked for");
    return best;
}

/* traction, Pa, at a point of the rest surface */
typedef void (*traction_fn)(const double *user, const double x[3], double traction[3]);

/* int N_i traction over a triangle by six points, exact for traction up to cubic [Dunavant 1985] */
static void load_triangle(scene *s, const uint32_t copy[3], const double *x[3], traction_fn traction,
                          const double *user) {
    static const double at[2] = {0.445948490915965, 0.091576213509771},
                        weight[2] = {0.223381589678011, 0.109951743655322};
    double a[3], b[3], normal[3], area, point[3], t[3];
    size_t p, i, r;
    for (r = 0; r < 3; r++) {
        a[r] = x[1][r] - x[0][r];
        b[r] = x[2][r] - x[0][r];
    }
    for (r = 0; r < 3; r++) normal[r] = a[(r + 1) % 3] * b[(r + 2) % 3] - a[(r + 2) % 3] * b[(r + 1) % 3];
    area = 0.5 * sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (p = 0; p < 6; p++) {
        double share[3];
        share[0] = share[1] = share[2] = at[p / 3];
        share[p % 3] = 1 - 2 * at[p / 3];
        for (r = 0; r < 3; r++) point[r] = share[0] * x[0][r] + share[1] * x[1][r] + share[2] * x[2][r];
        traction(user, point, t);
        for (i = 0; i < 3; i++)
            for (r = 0; r < 3; r++) s->forces[3 * copy[i] + r] += area * weight[p / 3] * share[i] * t[r];
    }
}

/* Traction on the boundary faces of mesh m in the plane x[axis] = value. s was made from m. */
static void load_plane(scene *s, const mesh *m, size_t axis, double value, traction_fn traction, const double *user) {
    size_t e, c, k, i;
    for (e = 0; e < m->element_count; e++)
        for (c = 0; c < 4; c++) {
            const double *x[3];
            uint32_t copy[3];
            for (k = i = 0; k < 4; k++)
                if (k != c && fabs(m->positions[3 * m->elements[4 * e + k] + axis] - value) < 1e-9) {
                    x[i] = m->positions + 3 * m->elements[4 * e + k];
                    copy[i++] = m->elements[4 * e + k];
                }
            if (i == 3) load_triangle(s, copy, x, traction, user);
        }
}

static void traction_constant(const double *user, const double x[3], double traction[3]) {
    (void)x;
    memcpy(traction, user, 3 * sizeof(double));
}

/* ---- closed forms of the materials, independent of the library's */

static double determinant(const double f[9]) {
    return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
}

/* cof F = det F F^-T */
static void cofactor(const double f[9], double c[9]) {
    size_t i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            size_t a = (i + 1) % 3, b = (i + 2) % 3, k = (j + 1) % 3, l = (j + 2) % 3;
            c[3 * i + j] = f[3 * a + k] * f[3 * b + l] - f[3 * a + l] * f[3 * b + k];
        }
}

/* R of F = R S by Newton's iteration R <- (R + R^-T) / 2 [Higham 1986], det F above 0 */
static void rotation_of(const double f[9], double r[9]) {
    double c[9];
    int pass, k;
    memcpy(r, f, 9 * sizeof(double));
    for (pass = 0; pass < 60; pass++) {
        double det = determinant(r);
        cofactor(r, c);
        for (k = 0; k < 9; k++) r[k] = 0.5 * (r[k] + c[k] / det);
    }
}

/* St. Venant-Kirchhoff: psi = mu E:E + lambda/2 (tr E)^2, P = F (2 mu E + lambda tr E 1), E = (F^T F - 1) / 2; linear:
 * E the symmetric part of F - 1, P = 2 mu E + lambda tr E 1 */
static double closed_kirchhoff(int linear, double mu, double lambda, const double f[9], double p[9]) {
    double e[9], stress[9], trace = 0, square = 0;
    size_t i, j, k;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            double sum = linear ? f[3 * i + j] + f[3 * j + i] - (i == j) : 0;
            for (k = 0; !linear && k < 3; k++) sum += f[3 * k + i] * f[3 * k + j];
            e[3 * i + j] = 0.5 * (sum - (i == j));
            square += e[3 * i + j] * e[3 * i + j];
            trace += i == j ? e[3 * i + j] : 0;
        }
    for (i = 0; i < 9; i++) stress[i] = 2 * mu * e[i] + (i % 4 == 0 ? lambda * trace : 0);
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            p[3 * i + j] = linear ? stress[3 * i + j]
                                  : f[3 * i] * stress[j] + f[3 * i + 1] * stress[3 + j] + f[3 * i + 2] * stress[6 + j];
    return mu * square + 0.5 * lambda * trace * trace;
}

/* psi = mu/2 (Ic - 3) - mu/2 log(Ic + 1) + lambda/2 (J - alpha)^2 less its value at rest, alpha = 1 + 3/4 mu / lambda
 * [Smith 2018, Eq. 14], P = mu (1 - 1 / (Ic + 1)) F + lambda (J - alpha) cof F, with mu and lambda so that Hooke's law
 * is that of young and poisson [Smith 2018, 3.4] */
static double closed_neo_hookean(double shear, double lame, const double f[9], double p[9]) {
    double mu = 4.0 / 3 * shear, lambda = lame + 5.0 / 6 * shear, alpha = 1 + 0.75 * mu / lambda, c[9], square = 0;
    double j = determinant(f) - alpha;
    int k;
    cofactor(f, c);
    for (k = 0; k < 9; k++) square += f[k] * f[k];
    for (k = 0; k < 9; k++) p[k] = mu * (1 - 1 / (square + 1)) * f[k] + lambda * j * c[k];
    return 0.5 * mu * (square - 3 - log((square + 1) / 4)) + 0.5 * lambda * (j * j - (1 - alpha) * (1 - alpha));
}

/* psi = mu |F - R|^2 + lambda/2 (J - 1)^2, P = 2 mu (F - R) + lambda (J - 1) cof F [Stomakhin 2012] */
static double closed_corotated(double mu, double lambda, const double f[9], double p[9]) {
    double r[9], c[9], j = determinant(f) - 1, square = 0;
    int k;
    rotation_of(f, r);
    cofactor(f, c);
    for (k = 0; k < 9; k++) {
        square += (f[k] - r[k]) * (f[k] - r[k]);
        p[k] = 2 * mu * (f[k] - r[k]) + lambda * j * c[k];
    }
    return mu * square + 0.5 * lambda * j * j;
}

/* Energy density; P = d psi / dF */
static double closed_form(gxs_material_kind kind, double young, double poisson, const double f[9], double p[9]) {
    double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    if (kind == GXS_STABLE_NEO_HOOKEAN) return closed_neo_hookean(mu, lambda, f, p);
    if (kind == GXS_FIXED_COROTATED) return closed_corotated(mu, lambda, f, p);
    return closed_kirchhoff(kind == GXS_LINEAR, mu, lambda, f, p);
}

/* ---- homogeneous states: unit cube of 5-tetrahedra cubes, inner nodes moved at random, so that the mesh is irregular
 */

static double random_unit(void) {
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) / 9007199254740992.0 * 2 - 1;
}

static int on_unit_cube(const double x[3]) {
    size_t r;
    for (r = 0; r < 3; r++)
        if (x[r] < 1e-9 || x[r] > 1 - 1e-9) return 1;
    return 0;
}

static mesh irregular_cube(void) {
    static const size_t n[3] = {4, 4, 4};
    static const double size[3] = {1, 1, 1};
    mesh m = mesh_block(n, size, MESH_FIVE);
    size_t i, r;
    for (i = 0; i < m.node_count; i++)
        if (!on_unit_cube(m.positions + 3 * i))
            for (r = 0; r < 3; r++) m.positions[3 * i + r] += 0.15 / 4 * random_unit();
    return m;
}

/* displacement of x by F */
static void affine(const double f[9], const double x[3], double u[3]) {
    size_t r;
    for (r = 0; r < 3; r++) u[r] = f[3 * r] * x[0] + f[3 * r + 1] * x[1] + f[3 * r + 2] * x[2] - x[r];
}

/* largest distance of a displacement from that of F, over the largest displacement */
static double affine_distance(const scene *s, const double f[9]) {
    double worst = 0, largest = 0;
    size_t i, r;
    for (i = 0; i < s->model.copy_count; i++) {
        double u[3];
        affine(f, s->rest + 3 * i, u);
        for (r = 0; r < 3; r++) {
            worst = fmax(worst, fabs(u[r] - s->displacement[3 * i + r]));
            largest = fmax(largest, fabs(u[r]));
        }
    }
    return worst / largest;
}

/* All of the boundary is moved by F: energy (J), mean stress (Pa) and the inner nodes. */
static void homogeneous(gxs_material_kind kind, const char *name, const double f[9]) {
    static const char *const entry[9] = {"stress xx", "stress xy", "stress xz", "stress yx", "stress yy",
                                         "stress yz", "stress zx", "stress zy", "stress zz"};
    double young = 1e5, poisson = 0.35, p[9], psi = closed_form(kind, young, poisson, f, p), stress[9], largest = 0;
    mesh m = irregular_cube();
    scene *s = scene_make(&m, kind, young, poisson, 1000);
    series row = series_make(name, kind_name[kind], "energy", "closed form");
    size_t i, k;
    for (i = 0; i < s->model.copy_count; i++) {
        affine(f, s->rest + 3 * i, s->targets + 3 * i);
        s->held[i] = (uint8_t)on_unit_cube(s->rest + 3 * i);
    }
    solve(s, name);
    series_row(&row, m.element_count, 0, energy(s), psi);
    mean_stress(s, 1, stress);
    for (k = 0; k < 9; k++) largest = fmax(largest, fabs(p[k]));
    for (k = 0; k < 9; k++)
        if (fabs(p[k]) > 1e-3 * largest) {
            row.quantity = entry[k];
            series_row_scaled(&row, m.element_count, 0, stress[k], p[k], largest);
        }
    row.quantity = "largest error of displacement";
    series_row_scaled(&row, m.element_count, 0, affine_distance(s, f), 0, 1);
    scene_free(s);
    mesh_free(&m);
}

/* The b of F = diag(a, b, b) that leaves no lateral stress, by bisection to the last digit */
static double contraction(gxs_material_kind kind, double young, double poisson, double a) {
    double low = 0.5, high = 1.5, f[9] = {0}, p[9];
    int pass;
    f[0] = a;
    for (pass = 0; pass < 100; pass++) {
        double middle = 0.5 * (low + high);
        f[4] = f[8] = middle;
        closed_form(kind, young, poisson, f, p);
        if (p[4] > 0)
            high = middle;
        else
            low = middle;
    }
    return 0.5 * (low + high);
}

/* Traction on the face x = 1. Closed forms say that it stretches the cube by a. The face x = 0 is held where it then
   is, already contracted, since held copies have no free components. Gives stretch, lateral stretch, energy (J) and
   reaction (N). */
static void uniaxial(gxs_material_kind kind, const char *name, double a) {
    double young = 1e5, poisson = 0.35, f[9] = {0}, p[9], psi, traction[3] = {0}, sum = 0, *g;
    mesh m = irregular_cube();
    scene *s = scene_make(&m, kind, young, poisson, 1000);
    series row = series_make(name, kind_name[kind], "stretch", "scalar equation solved to 1e-16");
    size_t i, corner;
    f[0] = a;
    f[4] = f[8] = contraction(kind, young, poisson, a);
    psi = closed_form(kind, young, poisson, f, p);
    traction[0] = p[0];
    hold_plane(s, 0, 0);
    for (i = 0; i < s->model.copy_count; i++) affine(f, s->rest + 3 * i, s->targets + 3 * i);
    load_plane(s, &m, 0, 1, traction_constant, traction);
    solve(s, name);
    corner = nearest(s, 1, 1, 1);
    g = reactions(s);
    for (i = 0; i < s->model.copy_count; i++) sum += g[3 * i];
    free(g);
    series_row(&row, m.element_count, 0, 1 + s->displacement[3 * corner], a);
    row.quantity = "lateral stretch";
    series_row(&row, m.element_count, 0, 1 + s->displacement[3 * corner + 1], f[4]);
    row.quantity = "energy";
    series_row(&row, m.element_count, 0, energy(s), psi);
    row.quantity = "reaction";
    series_row(&row, m.element_count, 0, sum, -p[0]);
    scene_free(s);
    mesh_free(&m);
}

static void homogeneous_states(void) {
    static const double stretched[9] = {1.3, 0, 0, 0, 0.9, 0, 0, 0, 1.1}, sheared[9] = {1, 0.5, 0, 0, 1, 0, 0, 0, 1},
                        /* turned by 45 degrees and more */
        general[9] = {0.8, -0.7, 0.1, 0.9, 0.8, 0.2, -0.1, 0.3, 1.2};
    int kind;
    for (kind = 0; kind < KINDS; kind++) {
        homogeneous((gxs_material_kind)kind, "stretched cube", stretched);
        homogeneous((gxs_material_kind)kind, "sheared cube", sheared);
        homogeneous((gxs_material_kind)kind, "turned and sheared cube", general);
        uniaxial((gxs_material_kind)kind, "bar in tension", 1.5);
        uniaxial((gxs_material_kind)kind, "bar in compression", 0.9);
    }
}

/* ---- cantilevers along x, bent in y; lengths in m */

typedef struct beam {
    double length, depth, width, young, poisson;
    double load; /* N, downwards at the end */
} beam;

static double second_moment(const beam *b) { return b->width * b->depth * b->depth * b->depth / 12; }

/* Cubes, n over the depth; y is 0 on the axis. */
static mesh beam_mesh(const beam *b, size_t n) {
    size_t cells[3], i;
    double size[3];
    mesh m;
    size[0] = b->length;
    size[1] = b->depth;
    size[2] = b->width;
    for (i = 0; i < 3; i++) cells[i] = (size_t)(size[i] / b->depth * (double)n + 0.5);
    m = mesh_block(cells, size, MESH_SIX);
    for (i = 0; i < m.node_count; i++) m.positions[3 * i + 1] -= 0.5 * b->depth;
    return m;
}

/* Exact displacement of a plane cantilever with parabolic shear at its end [Timoshenko and Goodier, Theory of
 * Elasticity, art. 21, as written by Augarde and Deeks 2008, Eq. 12-13]. With poisson 0 it is exact in three dimensions
 * too. */
static void beam_exact(const beam *b, const double x[3], double u[3]) {
    double scale = b->load / (6 * b->young * second_moment(b)), nu = b->poisson, d = b->depth, l = b->length, y = x[1];
    u[0] = scale * y * ((6 * l - 3 * x[0]) * x[0] + (2 + nu) * (y * y - d * d / 4));
    u[1] = -scale * (3 * nu * y * y * (l - x[0]) + (4 + 5 * nu) * d * d * x[0] / 4 + (3 * l - x[0]) * x[0] * x[0]);
    u[2] = 0;
}

static void traction_parabola(const double *user, const double x[3], double traction[3]) {
    traction[0] = traction[2] = 0;
    traction[1] = -user[0] * (user[1] - x[1] * x[1]);
}

/* The root is held at the exact displacement, the end has the exact traction. Gives the deflection of the axis's end
   (m). */
static void cantilever_exact(void) {
    static const beam b = {4, 1, 0.5, 1e6, 0, 100};
    series row = series_make("cantilever with parabolic end load", "linear", "end deflection",
                             "Timoshenko and Goodier art. 21; exact for poisson 0");
    size_t n;
    for (n = 2; n <= finest_of(16); n *= 2) {
        mesh m = beam_mesh(&b, n);
        scene *s = scene_make(&m, GXS_LINEAR, b.young, b.poisson, 1000);
        double user[2], exact[3], end[3] = {0};
        size_t i;
        user[0] = b.load / (2 * second_moment(&b));
        user[1] = b.depth * b.depth / 4;
        for (i = 0; i < s->model.copy_count; i++) beam_exact(&b, s->rest + 3 * i, s->targets + 3 * i);
        hold_plane(s, 0, 0);
        load_plane(s, &m, 0, b.length, traction_parabola, user);
        solve(s, "parabolic end load");
        end[0] = b.length;
        beam_exact(&b, end, exact);
        series_row(&row, m.element_count, (double)n, -s->displacement[3 * nearest(s, b.length, 0, 0) + 1], -exact[1]);
        scene_free(s);
        mesh_free(&m);
    }
}

/* Clamped root, own weight as forces; w: weight per length, N/m.

       deflection w L^4 / (8 E I) + w L^2 / (2 kappa G A), kappa = 10 (1 + nu) / (12 + 11 nu) [Cowper 1966]

   A beam's clamp lets the root contract; the clamp here does not. So the last percent is the model's. */
static void cantilever_weight(gxs_material_kind kind) {
    static const beam b = {10, 1, 1, 1e6, 0.3, 0};
    double weight = 0.05, area = b.depth * b.width, shear = b.young / (2 * (1 + b.poisson)), l = b.length;
    double kappa = 10 * (1 + b.poisson) / (12 + 11 * b.poisson);
    double expected =
        weight * l * l * l * l / (8 * b.young * second_moment(&b)) + weight * l * l / (2 * kappa * shear * area);
    series row = series_make("cantilever under its weight", kind_name[kind], "end deflection",
                             "Timoshenko beam (shear factor of Cowper 1966); model error about 1e-2");
    size_t n;
    for (n = 1; n <= finest_of(8); n *= 2) {
        mesh m = beam_mesh(&b, n);
        scene *s = scene_make(&m, kind, b.young, b.poisson, 1000);
        size_t e, k;
        for (e = 0; e < m.element_count; e++)
            for (k = 0; k < 4; k++)
                s->forces[3 * s->elements[e].copy[k] + 1] -= weight / area * s->elements[e].weight / 4;
        hold_plane(s, 0, 0);
        solve(s, "own weight");
        series_row(&row, m.element_count, (double)n, -s->displacement[3 * nearest(s, l, n == 1 ? -0.5 : 0, 0) + 1],
                   expected);
        scene_free(s);
        mesh_free(&m);
    }
}

/* One step of Runge and Kutta of the elastica theta'' = -alpha cos theta, x' = cos theta, y' = sin theta; state: theta,
 * theta', x, y over arc length 1 */
static void elastica_rate(double alpha, const double s[4], double rate[4]) {
    rate[0] = s[1];
    rate[1] = -alpha * cos(s[0]);
    rate[2] = cos(s[0]);
    rate[3] = sin(s[0]);
}

static void elastica_run(double alpha, double curvature, double state[4]) {
    const int steps = 2000;
    const double h = 1.0 / steps;
    int i, k;
    memset(state, 0, 4 * sizeof(double));
    state[1] = curvature;
    for (i = 0; i < steps; i++) {
        double a[4], b[4], c[4], d[4], t[4];
        elastica_rate(alpha, state, a);
        for (k = 0; k < 4; k++) t[k] = state[k] + 0.5 * h * a[k];
        elastica_rate(alpha, t, b);
        for (k = 0; k < 4; k++) t[k] = state[k] + 0.5 * h * b[k];
        elastica_rate(alpha, t, c);
        for (k = 0; k < 4; k++) t[k] = state[k] + h * c[k];
        elastica_rate(alpha, t, d);
        for (k = 0; k < 4; k++) state[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
    }
}

/* End of the elastica with alpha = P L^2 / (E I), in units of its length. The curvature at the root is the one for
   which the curvature at the end is 0. */
static void elastica_end(double alpha, double *x, double *y) {
    double low = 0, high = alpha, state[4];
    int pass;
    for (pass = 0; pass < 100; pass++) {
        elastica_run(alpha, 0.5 * (low + high), state);
        if (state[1] > 0)
            high = 0.5 * (low + high);
        else
            low = 0.5 * (low + high);
    }
    *x = state[2];
    *y = state[3];
}

/* Large rotations: slender clamped beam with a dead load at its end, P L^2 / (E I) = 3. Gives end deflection and
   shortening (m). The elastica neither stretches nor shears, so the last few 1e-3 are the model's. */
static void cantilever_large(gxs_material_kind kind, size_t finest) {
    static const beam b = {20, 1, 1, 1e6, 0, 0};
    double alpha = 3, load = alpha * b.young * second_moment(&b) / (b.length * b.length), x, y, traction[3] = {0};
    const char *source =
        "elastica by Runge-Kutta (0.60325 L and 0.25442 L as in Mattiasson 1981); model error some 1e-3";
    series down = series_make("large deflection", kind_name[kind], "end deflection", source);
    series back = series_make("large deflection", kind_name[kind], "end shortening", source);
    size_t n;
    elastica_end(alpha, &x, &y);
    traction[1] = -load / (b.depth * b.width);
    for (n = 1; n <= finest_of(finest); n *= 2) {
        mesh m = beam_mesh(&b, n);
        scene *s = scene_make(&m, kind, b.young, b.poisson, 1000);
        const double *u;
        hold_plane(s, 0, 0);
        load_plane(s, &m, 0, b.length, traction_constant, traction);
        solve(s, "large deflection");
        u = s->displacement + 3 * nearest(s, b.length, n == 1 ? -0.5 : 0, 0);
        series_row(&down, m.element_count, (double)n, -u[1], b.length * y);
        series_row(&back, m.element_count, (double)n, -u[0], b.length * (1 - x));
        scene_free(s);
        mesh_free(&m);
    }
}

/* ---- Cook's membrane: corners (0,0) (48,44) (48,60) (0,44), clamped on the left, shear traction on the right.

   Plane strain without constraints on components: in one layer the upper nodes follow the copies of the lower ones.
   An element's four corners then follow three copies. The field is the same at every height, elements are linear
   triangles in effect, and nothing drives it out of the plane. With two layers no copy is at two corners of an
   element; the solution is the same. */
enum { LAYERS = 1 };

static mesh cook_mesh(size_t n) {
    size_t cells[3], i;
    double size[3] = {48, 44, 0};
    mesh m;
    cells[0] = cells[1] = n;
    cells[2] = LAYERS;
    size[2] = LAYERS * 48 / (double)n;
    m = mesh_block(cells, size, MESH_SIX);
    for (i = 0; i < m.node_count; i++) {
        double *p = m.positions + 3 * i;
        p[1] += p[0] / 48 * (44 - p[1] / 44 * 28);
    }
    return m;
}

/* Nodes from `copies` on follow those below, and their forces act there too. */
static void make_periodic(scene *s, uint32_t copies) {
    size_t e, i, k;
    for (e = 0; e < s->model.element_count; e++)
        for (k = 0; k < 4; k++) s->elements[e].copy[k] %= copies;
    for (i = copies; i < s->model.copy_count; i++)
        for (k = 0; k < 3; k++) {
            s->forces[3 * (i % copies) + k] += s->forces[3 * i + k];
            s->forces[3 * i + k] = 0;
        }
    s->model.copy_count = copies;
}

typedef struct cook {
    const char *name, *source;
    double young, poisson, traction, at, reference; /* at: y of the point on the right edge, whose u_y is reference */
    size_t finest;
} cook;

static void cook_membrane(const cook *c) {
    series row = series_make(c->name, "", "vertical displacement", c->source);
    size_t n;
    for (n = 4; n <= finest_of(c->finest); n *= 2) {
        mesh m = cook_mesh(n);
        scene *s = scene_make(&m, GXS_LINEAR, c->young, c->poisson, 1000);
        double traction[3] = {0};
        traction[1] = c->traction;
        hold_plane(s, 0, 0);
        load_plane(s, &m, 0, 48, traction_constant, traction);
        make_periodic(s, (uint32_t)(LAYERS * (n + 1) * (n + 1)));
        solve(s, c->name);
        series_row(&row, m.element_count, (double)n, s->displacement[3 * nearest(s, 48, c->at, 0) + 1], c->reference);
        scene_free(s);
        mesh_free(&m);
    }
}

/* A trial that is not in the library (averaged.h): volumes averaged over the cells of each node, and each element by
   itself, by the same plain solver. The columns of iterations tell its own. */
static void cook_averaged(const cook *c) {
    static const char *const names[2] = {"by itself, plain solver", "volumes averaged at nodes"};
    int on;
    for (on = 0; on < 2; on++) {
        series row = series_make(c->name, names[on], "vertical displacement", c->source);
        size_t n;
        for (n = 4; n <= finest_of(c->finest); n *= 2) {
            mesh m = cook_mesh(n);
            scene *s = scene_make(&m, GXS_LINEAR, c->young, c->poisson, 1000);
            double traction[3] = {0};
            averaged a;
            memset(&a, 0, sizeof a);
            traction[1] = c->traction;
            hold_plane(s, 0, 0);
            load_plane(s, &m, 0, 48, traction_constant, traction);
            make_periodic(s, (uint32_t)(LAYERS * (n + 1) * (n + 1)));
            a.model = &s->model;
            a.held = s->held;
            a.mu = c->young / (2 * (1 + c->poisson));
            a.lambda = c->young * c->poisson / ((1 + c->poisson) * (1 - 2 * c->poisson));
            a.on = on;
            a.volume = (double *)memory(2 * s->model.copy_count, sizeof(double));
            a.change = a.volume + s->model.copy_count;
            memset(&report, 0, sizeof report);
            imbalance = 1e-8;
            report.cg_iterations = (uint32_t)averaged_solve(&a, s->forces, s->displacement);
            series_row(&row, m.element_count, (double)n, s->displacement[3 * nearest(s, 48, c->at, 0) + 1],
                       c->reference);
            free(a.volume);
            scene_free(s);
            mesh_free(&m);
        }
    }
}

/* Plane stress of E = 1, nu = 1/3 is plane strain of nu / (1 + nu) = 1/4 and E (1 - (1/4)^2) = 15/16. */
static void cook_membranes(void) {
    /* clang-format off */
    static const cook cases[] = {
        {"Cook's membrane in plane stress", "Krysl: FinEtools tutorial Cook-plane-stress",
         0.9375, 0.25, 1.0 / 16, 52, 23.97, 128},
        {"Cook's membrane in plane strain", "CoFEA benchmark 002 results for poisson 0.33: Calculix very fine quadratic",
         70, 1.0 / 3, 6.25, 60, 32.27, 128},
        {"Cook's membrane nearly incompressible", "Krysl: FinEALE Cook_3D_strain_T10 (lambda = 7500; G = 0.375)",
         0.375 * (3 * 7500 + 2 * 0.375) / 7500.375, 0.5 * 7500 / 7500.375, 1.0 / 16, 52, 16.432584376299037, 32},
    };
    /* clang-format on */
    size_t i;
    for (i = 0; i < sizeof cases / sizeof cases[0]; i++) cook_membrane(&cases[i]);
    cook_averaged(&cases[2]);
}

/* ---- torsion of a square column, |x|, |y| <= 1/2, along z: exact with Saint-Venant's solution and its warping at both
 * ends */

/* Warping of twist 1: xy - 8 / pi^3 sum (-1)^k / n^3 sin(n pi x) sinh(n pi y) / cosh(n pi / 2), n = 2 k + 1
   [Timoshenko and Goodier, art. 109]. The quotient is written with exponentials that do not overflow. */
static double warping(double x, double y) {
    double sum = 0;
    int k;
    for (k = 0; k < 200; k++) {
        double n = (2 * k + 1) * pi, quotient = (exp(n * (y - 0.5)) - exp(n * (-y - 0.5))) / (1 + exp(-n));
        sum += (k % 2 ? -1 : 1) * sin(n * x) * quotient / ((2 * k + 1.0) * (2 * k + 1.0) * (2 * k + 1.0));
    }
    return x * y - 8 / (pi * pi * pi) * sum;
}

/* J / a^4 = 1/3 - 64 / pi^5 sum tanh(n pi / 2) / n^5 = 0.1406 */
static double torsion_constant(void) {
    double sum = 0;
    int n;
    for (n = 1; n < 400; n += 2) sum += tanh(n * pi / 2) / (pow(n, 5) * pow(pi, 5));
    return 1.0 / 3 - 64 * sum;
}

/* Moment about z of the reactions of the end z = length, at the deformed positions; for the linear material, at the
   rest positions */
static double end_torque(const scene *s, double length) {
    double *g = reactions(s), sum = 0;
    size_t i, moved = s->material.kind != GXS_LINEAR;
    for (i = 0; i < s->model.copy_count; i++)
        if (fabs(s->rest[3 * i + 2] - length) < 1e-9) {
            double x = s->rest[3 * i] + (moved ? s->displacement[3 * i] : 0);
            double y = s->rest[3 * i + 1] + (moved ? s->displacement[3 * i + 1] : 0);
            sum += x * g[3 * i + 1] - y * g[3 * i];
        }
    free(g);
    return sum;
}

/* Torque (Nm) and energy (J) */
static void torsion_square(gxs_material_kind kind, double twist) {
    double young = 1e6, poisson = 0.3, shear = young / (2 * (1 + poisson)), torque = shear * torsion_constant() * twist;
    const char *source = "Saint-Venant with exact warping; J = 0.1406 a^4";
    series row = series_make("twisted square column", kind_name[kind], "torque", source);
    series stored = series_make("twisted square column", kind_name[kind], "energy", source);
    size_t n, i, cells[3];
    const double size[3] = {1, 1, 1};
    for (n = 3; n <= finest_of(24); n *= 2) {
        mesh m;
        scene *s;
        cells[0] = cells[1] = cells[2] = n;
        m = mesh_block(cells, size, MESH_SIX);
        for (i = 0; i < 3 * m.node_count; i++) m.positions[i] -= i % 3 == 2 ? 0 : 0.5;
        s = scene_make(&m, kind, young, poisson, 1000);
        hold_plane(s, 2, 0);
        hold_plane(s, 2, 1);
        for (i = 0; i < s->model.copy_count; i++) {
            const double *x = s->rest + 3 * i;
            s->targets[3 * i] = -twist * x[2] * x[1];
            s->targets[3 * i + 1] = twist * x[2] * x[0];
            s->targets[3 * i + 2] = s->held[i] ? twist * warping(x[0], x[1]) : 0;
        }
        solve(s, "square column");
        series_row(&row, m.element_count, (double)n, end_torque(s, 1), torque);
        series_row(&stored, m.element_count, (double)n, energy(s), 0.5 * torque * twist);
        scene_free(s);
        mesh_free(&m);
    }
}

/* ---- finite twist of a solid cylinder of radius and length 1

   Torsion with free sides has the form r = f(R), angle = Theta + tau Z, z = Z for every isotropic material. In the
   frames of cylindrical coordinates F = [f' 0 0; 0 f/R tau f; 0 0 1]. So f minimises W = 2 pi int psi(F) R dR, a
   problem of one variable: f = R (1 + c_0 + c_1 R^2 + ...) is odd and analytic. Torque = dW / dtau. */
enum { TERMS = 8, POINTS = 24 };

typedef struct cylinder {
    gxs_material_kind kind;
    double young, poisson, twist;
    double c[TERMS];
    double at[POINTS], weight[POINTS]; /* Gauss-Legendre on [0, 1] */
    double energy, torque, force;      /* per length: J/m, Nm, N along z */
} cylinder;

static void gauss_legendre(double *at, double *weight) {
    int i, k, pass;
    for (i = 0; i < POINTS; i++) {
        double x = cos(pi * (i + 0.75) / (POINTS + 0.5)), slope = 1;
        for (pass = 0; pass < 50; pass++) {
            double p = 1, before = 0;
            for (k = 0; k < POINTS; k++) {
                double next = ((2 * k + 1) * x * p - k * before) / (k + 1);
                before = p;
                p = next;
            }
            slope = POINTS * (x * p - before) / (x * x - 1);
            x -= p / slope;
        }
        at[i] = 0.5 * (1 + x);
        weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

static double radius_of(const cylinder *c, double at) {
    double sum = 1, power = 1;
    int k;
    for (k = 0; k < TERMS; k++, power *= at * at) sum += c->c[k] * power;
    return at * sum;
}

/* dW/dc; also energy, torque and axial force */
static void cylinder_gradient(cylinder *c, double gradient[TERMS]) {
    int i, k;
    memset(gradient, 0, TERMS * sizeof(double));
    c->energy = c->torque = c->force = 0;
    for (i = 0; i < POINTS; i++) {
        double at = c->at[i], area = 2 * pi * at * c->weight[i], f[9] = {0}, p[9], power = 1;
        f[0] = 1;
        for (k = 0; k < TERMS; k++, power *= at * at) f[0] += (2 * k + 1) * c->c[k] * power;
        f[4] = radius_of(c, at) / at;
        f[5] = c->twist * radius_of(c, at);
        f[8] = 1;
        c->energy += area * closed_form(c->kind, c->young, c->poisson, f, p);
        c->torque += area * p[5] * radius_of(c, at);
        c->force += area * p[8];
        for (k = 0, power = 1; k < TERMS; k++, power *= at * at)
            gradient[k] += area * power * ((2 * k + 1) * p[0] + p[4] + c->twist * at * p[5]);
    }
}

/* x = A^-1 b by Gauss with pivots; A and b are destroyed */
static void solve_dense(double a[TERMS][TERMS], double b[TERMS]) {
    int i, j, k;
    for (k = 0; k < TERMS; k++) {
        int pivot = k;
        for (i = k; i < TERMS; i++) pivot = fabs(a[i][k]) > fabs(a[pivot][k]) ? i : pivot;
        for (j = 0; j <= TERMS; j++) {
            double *x = j < TERMS ? &a[k][j] : &b[k], *y = j < TERMS ? &a[pivot][j] : &b[pivot], kept = *x;
            *x = *y;
            *y = kept;
        }
        for (i = k + 1; i < TERMS; i++) {
            double share = a[i][k] / a[k][k];
            for (j = k; j < TERMS; j++) a[i][j] -= share * a[k][j];
            b[i] -= share * b[k];
        }
    }
    for (k = TERMS - 1; k >= 0; k--) {
        for (j = k + 1; j < TERMS; j++) b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
}

/* Newton's method, the Hessian by differences */
static void cylinder_solve(cylinder *c) {
    double g[TERMS], low[TERMS], high[TERMS], h[TERMS][TERMS];
    const double step = 1e-6;
    int pass, i, k;
    gauss_legendre(c->at, c->weight);
    for (pass = 0; pass < 40; pass++) {
        for (k = 0; k < TERMS; k++) {
            double kept = c->c[k];
            c->c[k] = kept - step;
            cylinder_gradient(c, low);
            c->c[k] = kept + step;
            cylinder_gradient(c, high);
            c->c[k] = kept;
            for (i = 0; i < TERMS; i++) h[i][k] = (high[i] - low[i]) / (2 * step);
        }
        cylinder_gradient(c, g);
        solve_dense(h, g);
        for (k = 0; k < TERMS; k++) c->c[k] -= g[k];
    }
    cylinder_gradient(c, g);
    for (k = 0; k < TERMS; k++) expect(fabs(g[k]) < 1e-9 * c->energy, "the cylinder's equation is not solved");
}

/* Node i of ring k of a disc of rings of 6 k nodes */
static size_t disc_node(size_t k, size_t i) { return k == 0 ? 0 : 1 + 3 * k * (k - 1) + i % (6 * k); }

/* Triangles between rings k - 1 and k: on each of six sides k outside and k - 1 inside */
static size_t disc_ring(size_t k, uint32_t (*triangle)[3]) {
    size_t side, i, count = 0;
    for (side = 0; side < 6; side++)
        for (i = 0; i < k; i++) {
            triangle[count][0] = (uint32_t)disc_node(k, side * k + i);
            triangle[count][1] = (uint32_t)disc_node(k, side * k + i + 1);
            triangle[count++][2] = (uint32_t)disc_node(k - 1, side * (k - 1) + i);
            if (i == 0) continue;
            triangle[count][0] = (uint32_t)disc_node(k, side * k + i);
            triangle[count][1] = (uint32_t)disc_node(k - 1, side * (k - 1) + i);
            triangle[count++][2] = (uint32_t)disc_node(k - 1, side * (k - 1) + i - 1);
        }
    return count;
}

/* Prism on a triangle of ascending nodes a < b < c, as three tetrahedra. Neighbours choose the same diagonal. */
static void mesh_prism(const uint32_t triangle[3], uint32_t below, uint32_t above, uint32_t (*element)[4]) {
    uint32_t v[3], kept;
    int i, j;
    memcpy(v, triangle, sizeof v);
    for (i = 0; i < 2; i++)
        for (j = 0; j < 2 - i; j++)
            if (v[j] > v[j + 1]) {
                kept = v[j];
                v[j] = v[j + 1];
                v[j + 1] = kept;
            }
    for (i = 0; i < 3; i++)
        for (j = 0; j < 4; j++) element[i][j] = j <= i ? below + v[j] : above + v[j - 1];
}

static mesh mesh_cylinder(size_t n) {
    size_t disc = 1 + 3 * n * (n + 1), triangles = 6 * n * n, layer, k, i, count = 0;
    uint32_t(*triangle)[3] = (uint32_t(*)[3])memory(triangles, sizeof *triangle);
    mesh m = mesh_make(disc * (n + 1), 3 * triangles * n);
    for (layer = 0; layer <= n; layer++)
        for (k = 0; k <= n; k++)
            for (i = 0; i < (k ? 6 * k : 1); i++) {
                double *p = m.positions + 3 * (layer * disc + disc_node(k, i)),
                       angle = k ? pi * (double)i / (3 * (double)k) : 0;
                p[0] = (double)k / (double)n * cos(angle);
                p[1] = (double)k / (double)n * sin(angle);
                p[2] = (double)layer / (double)n;
            }
    for (k = 1; k <= n; k++) count += disc_ring(k, triangle + count);
    for (layer = 0; layer < n; layer++)
        for (i = 0; i < triangles; i++)
            mesh_prism(triangle[i], (uint32_t)(layer * disc), (uint32_t)((layer + 1) * disc),
                       (uint32_t(*)[4])(m.elements + 12 * (layer * triangles + i)));
    free(triangle);
    return m;
}

/* Where the solution of one variable takes a point */
static void cylinder_target(const cylinder *c, const double x[3], double u[3]) {
    double radius = sqrt(x[0] * x[0] + x[1] * x[1]), ratio = radius > 0 ? radius_of(c, radius) / radius : 1;
    double cosine = cos(c->twist * x[2]), sine = sin(c->twist * x[2]);
    u[0] = ratio * (cosine * x[0] - sine * x[1]) - x[0];
    u[1] = ratio * (sine * x[0] + cosine * x[1]) - x[1];
    u[2] = 0;
}

static double end_force(const scene *s, double length) {
    double *g = reactions(s), sum = 0;
    size_t i;
    for (i = 0; i < s->model.copy_count; i++)
        if (fabs(s->rest[3 * i + 2] - length) < 1e-9) sum += g[3 * i + 2];
    free(g);
    return sum;
}

/* Torque (Nm), axial force (N) and energy (J) of a twist by 1 rad; both ends are held where the exact solution has
   them */
static void torsion_cylinder(gxs_material_kind kind, double twist) {
    const char *source = "minimum of one variable to 1e-9 (see accuracy.c)";
    series torque = series_make("twisted cylinder", kind_name[kind], "torque", source);
    series force = series_make("twisted cylinder", kind_name[kind], "axial force", source);
    series stored = series_make("twisted cylinder", kind_name[kind], "energy", source);
    cylinder c;
    size_t n, i;
    memset(&c, 0, sizeof c);
    c.kind = kind;
    c.young = 1e6;
    c.poisson = 0.3;
    c.twist = twist;
    cylinder_solve(&c);
    for (n = 2; n <= finest_of(16); n *= 2) {
        mesh m = mesh_cylinder(n);
        scene *s = scene_make(&m, kind, c.young, c.poisson, 1000);
        hold_plane(s, 2, 0);
        hold_plane(s, 2, 1);
        for (i = 0; i < s->model.copy_count; i++) cylinder_target(&c, s->rest + 3 * i, s->targets + 3 * i);
        solve(s, "twisted cylinder");
        series_row(&torque, m.element_count, (double)n, end_torque(s, 1), c.torque);
        series_row(&force, m.element_count, (double)n, end_force(s, 1), c.force);
        series_row(&stored, m.element_count, (double)n, energy(s), c.energy);
        scene_free(s);
        mesh_free(&m);
    }
}

static void cantilever_weight_linear(void) { cantilever_weight(GXS_LINEAR); }
static void cantilever_large_neo_hookean(void) { cantilever_large(GXS_STABLE_NEO_HOOKEAN, 8); }
static void cantilever_large_corotated(void) { cantilever_large(GXS_FIXED_COROTATED, 4); }
static void torsion_square_linear(void) { torsion_square(GXS_LINEAR, 0.1); }
static void torsion_cylinder_neo_hookean(void) { torsion_cylinder(GXS_STABLE_NEO_HOOKEAN, 1); }
/* At twist 1 a minimum with crumpled elements is lower: the material allows it. */
static void torsion_cylinder_kirchhoff(void) { torsion_cylinder(GXS_ST_VENANT_KIRCHHOFF, 0.5); }
static void torsion_cylinder_corotated(void) { torsion_cylinder(GXS_FIXED_COROTATED, 1); }

int main(int argc, char **argv) {
    static void (*const cases[CASES])(void) = {homogeneous_states,         cantilever_exact,
                                               cantilever_weight_linear,   cantilever_large_neo_hookean,
                                               cantilever_large_corotated, cook_membranes,
                                               torsion_square_linear,      torsion_cylinder_neo_hookean,
                                               torsion_cylinder_kirchhoff, torsion_cylinder_corotated};
    const char *path = csv_arguments(argc, argv, &small);
    csv_open(argv[0], path, "case,quantity,elements,value,reference,relative_error,source,order,imbalance,newton,cg");
    for (done = 0; done < CASES; done++) cases[done]();
    progress_draw("accuracy", done, CASES, "");
    print_table();
    return csv_close();
}
