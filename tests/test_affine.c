/* test_affine.c - tests of affine copies in gxfem_solve.h: the rule, modes, bending of a cut sheet, steps, bad input.
 */
#define GXFEM_SOLVE_IMPLEMENTATION
#include "../gxfem_solve.h"

#include "block.h"
#include "runner.h"

/* A block whose copies are all affine, and of whose elements only z0 <= z <= z0 + t is left */
typedef struct sheet {
    scene s;
    uint32_t *affine;
    size_t nodes;
} sheet;

/* Adds a tetrahedron of an element, by its corners' barycentric coordinates, to the element's weight and mass. */
static void add_tetrahedron(gxs_element *element, double part[4][4], double volume, double density) {
    double edge[3][3], sum[4] = {0, 0, 0, 0}, own;
    int i, j, k, e = 0;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) edge[i][k] = part[i + 1][k + 1] - part[0][k + 1];
    own = volume * fabs(determinant3((const double(*)[3])edge));
    for (k = 0; k < 4; k++)
        for (i = 0; i < 4; i++) sum[i] += part[k][i];
    element->weight += own;
    for (i = 0; i < 4; i++)
        for (j = i; j < 4; j++, e++) {
            double product = sum[i] * sum[j];
            for (k = 0; k < 4; k++) product += part[k][i] * part[k][j];
            element->mass[e] += density * own * product / 20;
        }
}

/* Clips a tetrahedron by side x (z - at) >= 0 into at most three. */
static int clip(double part[4][4], const double z[4], double at, double side, double to[3][4][4]) {
    double height[4], cut[2][3][4];
    int in[4], out[4], ins = 0, outs = 0, i, j, k;
    for (k = 0; k < 4; k++) {
        height[k] = 0;
        for (i = 0; i < 4; i++) height[k] += part[k][i] * z[i];
        height[k] = side * (height[k] - at);
        if (height[k] > 0)
            in[ins++] = k;
        else
            out[outs++] = k;
    }
    if (ins == 0) return 0;
    for (i = 0; i < ins; i++)
        for (j = 0; j < outs; j++)
            for (k = 0; k < 4; k++)
                cut[ins > 2 ? 0 : i][ins > 2 ? i : j][k] =
                    (height[in[i]] * part[out[j]][k] - height[out[j]] * part[in[i]][k]) /
                    (height[in[i]] - height[out[j]]);
    memset(to, 0, 3 * sizeof *to);
    if (ins == 4) memcpy(to[0], part, sizeof to[0]);
    if (ins == 4) return 1;
    if (ins == 1) {
        memcpy(to[0][0], part[in[0]], sizeof to[0][0]);
        memcpy(to[0][1], cut[0], sizeof cut[0]);
        return 1;
    }
    { /* a prism from three corners to three others */
        double low[3][4], high[3][4];
        for (k = 0; k < 3 && ins == 3; k++)
            memcpy(low[k], part[in[k]], sizeof low[k]), memcpy(high[k], cut[0][k], sizeof high[k]);
        for (k = 0; k < 3 && ins == 2; k++)
            memcpy(low[k], k == 0 ? part[in[0]] : cut[0][k - 1], sizeof low[k]),
                memcpy(high[k], k == 0 ? part[in[1]] : cut[1][k - 1], sizeof high[k]);
        for (i = 0; i < 3; i++)
            for (k = 0; k < 4; k++) memcpy(to[i][k], k < 3 - i ? low[i + k] : high[k - (3 - i)], sizeof to[i][k]);
    }
    return 3;
}

static void cut_element(gxs_element *element, const double z[4], double low, double high) {
    double whole[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, some[3][4][4], parts[3][4][4];
    const double volume = element->weight;
    int i, j, some_count = clip(whole, z, low, 1, some);
    element->weight = 0;
    memset(element->mass, 0, sizeof element->mass);
    for (i = 0; i < some_count; i++)
        for (j = clip(some[i], z, high, -1, parts); j-- > 0;) add_tetrahedron(element, parts[j], volume, 1000);
}

static sheet sheet_make(int nx, int ny, double z0, double t, double jitter, int kind) {
    const size_t nodes = (size_t)(nx + 1) * (size_t)(ny + 1) * 2;
    sheet made;
    size_t i, e;
    int k;
    made.nodes = nodes;
    made.s = scene_block(nx, ny, 1, 1, jitter, 3 * nodes);
    made.affine = (uint32_t *)zeroed(4 * nodes, sizeof(uint32_t));
    memset(made.affine, 0xff, 4 * nodes * sizeof(uint32_t));
    for (i = 0; i < nodes; i++) made.affine[i] = (uint32_t)(nodes + 3 * i);
    for (e = 0; e < made.s.model.element_count; e++) {
        double z[4];
        for (k = 0; k < 4; k++) z[k] = made.s.rest[3 * made.s.elements[e].copy[k] + 2];
        if (t < 1) cut_element(&made.s.elements[e], z, z0, z0 + t);
    }
    set_kind(made.s.material, kind);
    made.s.material->poisson = 0.3;
    made.s.model.copy_count = 4 * nodes;
    made.s.model.affine = made.affine;
    made.s.model.affine_length = 1;
    return made;
}

static void sheet_free(sheet *made) {
    free(made->affine);
    scene_free(&made->s);
}

static void hold_left(sheet *made) {
    size_t i;
    for (i = 0; i < made->nodes; i++)
        made->s.held[i] = made->s.held[made->nodes + 3 * i] = made->s.held[made->nodes + 3 * i + 1] =
            made->s.held[made->nodes + 3 * i + 2] = made->s.rest[3 * i] < 1e-9;
}

static double energy_of(const gxs_solver *solver, const double *u, double *force) {
    double sums[3];
    gxsp_evaluate_elements(solver->system, 0, u, NULL, 0, force);
    gxsp_sum_energies(solver->system, sums);
    return sums[0];
}

static gxs_solver *solver_of(const sheet *made) {
    gxs_solver *solver = solver_make();
    ck_assert_int_eq(gxs_solver_set_model(solver, &made->s.model, NULL), GX_OK);
    return solver;
}

START_TEST(four_points_integrate_quadratics) {
    static const int corner[10][2] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}};
    sheet made;
    size_t e;
    seed((uint64_t)_i);
    made = sheet_make(2, 2, 0.4, _i == 0 ? 0.3 : _i == 1 ? 0.02 : 2, _i == 2 ? 0.2 : 0, GXS_LINEAR);
    for (e = 0; e < made.s.model.element_count; e++) {
        const gxs_element *element = &made.s.elements[e];
        double shape[4][4];
        int k, p;
        if (!(element->weight > 0)) continue;
        gxsp_four_points(element, shape);
        for (k = 0; k < 10; k++) {
            double sum = 0;
            for (p = 0; p < 4; p++) sum += 250 * element->weight * shape[p][corner[k][0]] * shape[p][corner[k][1]];
            assert_that(fabs(sum - element->mass[k]) <= 1e-13 * 1000 * element->weight, "%g %g", sum, element->mass[k]);
        }
    }
    sheet_free(&made);
}
END_TEST

/* rank 24 = 48 - 18 gauge modes - 6 rigid ones */
START_TEST(an_element_has_no_hourglass_mode) {
    sheet made = sheet_make(1, 1, 0, 2, 0, GXS_STABLE_NEO_HOOKEAN);
    gxs_solver *solver = solver_make();
    double *x, *y, *a = (double *)zeroed(48 * 48, sizeof *a), *v = (double *)zeroed(48 * 48, sizeof *v), most = 0;
    uint32_t vector[16];
    int i, j, sweep, rank = 0;
    made.s.model.element_count = 1;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_linearise(solver, made.s.displacement, 0, 0, NULL), GX_OK);
    x = (double *)zeroed(3 * made.s.model.copy_count, sizeof *x),
    y = (double *)zeroed(3 * made.s.model.copy_count, sizeof *y);
    for (i = 0; i < 4; i++) vector[i] = made.s.elements[0].copy[i];
    for (i = 4; i < 16; i++) vector[i] = made.affine[made.s.elements[0].copy[(i - 4) / 3]] + (uint32_t)((i - 4) % 3);
    for (i = 0; i < 48; i++) {
        x[3 * vector[i / 3] + (uint32_t)(i % 3)] = 1;
        ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
        x[3 * vector[i / 3] + (uint32_t)(i % 3)] = 0;
        for (j = 0; j < 48; j++) a[48 * j + i] = y[3 * vector[j / 3] + (uint32_t)(j % 3)];
    }
    for (i = 0; i < 48; i++)
        for (j = 0; j < i; j++) a[48 * i + j] = a[48 * j + i] = 0.5 * (a[48 * i + j] + a[48 * j + i]);
    for (sweep = 0; sweep < 12; sweep++)
        for (i = 0; i < 48; i++)
            for (j = i + 1; j < 48; j++) gxsp_diagonalise(a, v, 48, i, j);
    for (i = 0; i < 48; i++) most = a[49 * i] > most ? a[49 * i] : most;
    for (i = 0; i < 48; i++) rank += a[49 * i] > 1e-5 * most;
    ck_assert_int_eq(rank, 24);
    free(a), free(v), free(x), free(y);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* A free sheet as a whole: 18 gauge modes and 6 rigid ones, and none besides. Of D^-1/2 K D^-1/2, D the diagonal */
START_TEST(a_free_sheet_has_24_zero_modes) {
    sheet made = sheet_make(2, 1, 0.3, _i == 0 ? 0.5 : 0.3, 0, GXS_LINEAR);
    gxs_solver *solver = solver_of(&made);
    const int n = 3 * (int)made.s.model.copy_count;
    double *x = (double *)zeroed(3 * (size_t)n, sizeof *x), *y = x + n, *root = y + n;
    double *a = (double *)zeroed(2 * (size_t)(n * n), sizeof *a), *v = a + n * n;
    int i, j, sweep, zeros = 0;
    ck_assert_int_eq(gxs_solver_linearise(solver, made.s.displacement, 0, 0, NULL), GX_OK);
    for (i = 0; i < n; i++) {
        x[i] = 1;
        ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
        x[i] = 0;
        root[i] = sqrt(y[i]);
        for (j = 0; j < n; j++) a[n * j + i] = y[j];
    }
    for (i = 0; i < n; i++)
        for (j = 0; j <= i; j++)
            a[n * i + j] = a[n * j + i] = 0.5 * (a[n * i + j] + a[n * j + i]) / (root[i] * root[j]);
    for (sweep = 0; sweep < 12; sweep++)
        for (i = 0; i < n; i++)
            for (j = i + 1; j < n; j++) gxsp_diagonalise(a, v, n, i, j);
    for (i = 0; i < n; i++) zeros += a[(n + 1) * i] < 2e-6;
    ck_assert_int_eq(zeros, 24);
    free(x), free(a);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

static void random_motion(const sheet *made, double size, double *u) {
    size_t i;
    for (i = 0; i < 3 * made->s.model.copy_count; i++) u[i] = size * uniform();
}

/* E(R u) = E(u): a -> (R - 1) X + R a, A -> R - 1 + R A */
START_TEST(rotations_are_free) {
    const double c = cos(0.7), s = sin(0.7), rotation[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
    sheet made = sheet_make(2, 2, 0.4, 0.1, 0, _i);
    gxs_solver *solver = solver_of(&made);
    const size_t n = made.s.model.copy_count;
    double *u = (double *)zeroed(3 * n, sizeof *u), *force = (double *)zeroed(3 * n, sizeof *u), first, second;
    size_t i, r, k;
    seed((uint64_t)_i);
    random_motion(&made, 0.05, u);
    first = energy_of(solver, u, force);
    for (i = 0; i < n; i++) {
        double turned[3] = {0, 0, 0};
        for (r = 0; r < 3; r++)
            for (k = 0; k < 3; k++)
                turned[r] += rotation[3 * r + k] * u[3 * i + k] +
                             (i < made.nodes ? (rotation[3 * r + k] - (r == k ? 1 : 0)) * made.s.rest[3 * i + k] : 0);
        for (r = 0; r < 3 && i >= made.nodes; r++)
            turned[r] += rotation[3 * r + (i - made.nodes) % 3] - (r == (i - made.nodes) % 3 ? 1 : 0);
        memcpy(u + 3 * i, turned, sizeof turned);
    }
    second = energy_of(solver, u, force);
    assert_that(fabs(second - first) <= 1e-13 * first, "%.17g %.17g", first, second);
    free(u), free(force);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

START_TEST(forces_and_products_match_differences) {
    sheet made;
    gxs_solver *solver;
    double *u, *v, *force, *more, *less, *product, slope, size = 0, off = 0, work = 0;
    size_t n, i;
    seed((uint64_t)_i);
    made = sheet_make(2, 2, 0.3, 0.2, 0.05, _i);
    solver = solver_of(&made);
    n = made.s.model.copy_count;
    u = (double *)zeroed(18 * n, sizeof *u), v = u + 3 * n, force = v + 3 * n, more = force + 3 * n,
    less = more + 3 * n, product = less + 3 * n;
    random_motion(&made, 0.02, u);
    random_motion(&made, 1, v);
    (void)energy_of(solver, u, force);
    ck_assert_int_eq(gxs_solver_linearise(solver, u, 0, 1, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(solver, v, product, NULL), GX_OK);
    for (i = 0; i < 3 * n; i++) u[i] += 1e-6 * v[i];
    slope = energy_of(solver, u, more);
    for (i = 0; i < 3 * n; i++) u[i] -= 2e-6 * v[i];
    slope = (slope - energy_of(solver, u, less)) / 2e-6;
    for (i = 0; i < 3 * n; i++) {
        work += force[i] * v[i];
        off = fmax(off, fabs((more[i] - less[i]) / 2e-6 - product[i]));
        size = fmax(size, fabs(product[i]));
    }
    assert_that(fabs(slope - work) <= 1e-6 * fabs(work), "slope %g, work %g", slope, work);
    assert_that(off <= 1e-5 * size, "product off by %g of %g", off, size);
    free(u);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* Conjugate gradients' product, in single precision, is the other one. With and without inertia */
START_TEST(products_agree) {
    const double rate = _i % 2 == 0 ? 0 : 300;
    sheet made;
    gxs_solver *solver;
    gxsp_system *system;
    double *u, *v, *product, size = 0, off = 0;
    size_t n, i;
    seed((uint64_t)_i);
    made = sheet_make(9, 8, 0.3, 0.2, 0.05, _i / 2);
    for (i = 0; i < 20; i++) made.affine[i] = GXS_NOT_AFFINE; /* elements with some */
    solver = solver_of(&made);
    system = solver->system;
    n = made.s.model.copy_count;
    u = (double *)zeroed(9 * n, sizeof *u), v = u + 3 * n, product = v + 3 * n;
    random_motion(&made, 0.02, u);
    for (i = 0; i < 3 * n; i++) v[i] = (double)(float)uniform();
    ck_assert_int_eq(gxs_solver_linearise(solver, u, rate, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(solver, v, product, NULL), GX_OK);
    for (i = 0; i < 3 * n; i++) system->vectors.search[i / 3][i % 3] = system->state.still[i / 3] ? 0 : (float)v[i];
    (void)gxsp_product(system, rate, system->vectors.search, system->vectors.product);
    for (i = 0; i < 3 * n; i++) {
        if (system->state.still[i / 3]) continue;
        off = fmax(off, fabs((double)system->vectors.product[i / 3][i % 3] / system->model.scale - product[i]));
        size = fmax(size, fabs(product[i]));
    }
    assert_that(off <= 3e-6 * size, "off by %g of %g", off, size);
    free(u);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* u = (k x z + q y z, q x z, -k x^2/2 - q x y - nu/(1-nu) k z^2/2), z from the middle of the sheet: a_i = u(X_i) and
   A_i = grad u(X_i) / 2 reproduce it. Energy by exact integration; no force inside. */
START_TEST(a_cut_sheet_bends_and_twists_exactly) {
    static const double thickness[4] = {0.5, 0.2, 0.1, 0.02};
    const double t = thickness[_i], z0 = 0.37, k = 0.3, q = 0.2, c = 0.3 / 0.7, young = 1e6, nu = 0.3;
    sheet made = sheet_make(4, 4, z0, t, 0, GXS_LINEAR);
    gxs_solver *solver = solver_of(&made);
    const size_t n = made.s.model.copy_count;
    double *u = (double *)zeroed(6 * n, sizeof *u), *force = u + 3 * n, inner = 0, outer = 0, energy, exact;
    size_t i, r;
    for (i = 0; i < made.nodes; i++) {
        const double x = made.s.rest[3 * i], y = made.s.rest[3 * i + 1], z = made.s.rest[3 * i + 2] - (z0 + t / 2);
        const double value[3] = {k * x * z + q * y * z, q * x * z, -k * x * x / 2 - q * x * y - c * k * z * z / 2};
        const double gradient[9] = {k * z, q * z, k * x + q * y, q * z, 0, q * x, -k * x - q * y, -q * x, -c * k * z};
        for (r = 0; r < 9; r++) u[3 * (made.nodes + 3 * i + r % 3) + r / 3] = 0.5 * gradient[r];
        memcpy(u + 3 * i, value, sizeof value);
    }
    energy = energy_of(solver, u, force);
    /* plate: D/2 k^2 + D (1 - nu) q^2 per area */
    exact = 16 * young * t * t * t / (12 * (1 - nu * nu)) * (0.5 * k * k + (1 - nu) * q * q);
    assert_that(fabs(energy / exact - 1) <= 1e-8, "%.12g of %.12g", energy, exact);
    for (i = 0; i < made.nodes; i++) {
        const double x = made.s.rest[3 * i], y = made.s.rest[3 * i + 1],
                     size = sqrt(gxsp_dot(force + 3 * i, force + 3 * i, 1));
        if (x > 0.5 && x < 3.5 && y > 0.5 && y < 3.5)
            inner = fmax(inner, size);
        else
            outer = fmax(outer, size);
    }
    assert_that(inner <= 1e-9 * outer, "%g of %g", inner, outer);
    free(u);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* A clamped sheet under gravity goes down as a beam does, within 12 %, which linear elements miss by far. */
START_TEST(a_clamped_sheet_hangs_as_a_beam) {
    const double t = 0.1, length = 8;
    int affine;
    for (affine = 0; affine < 2; affine++) {
        sheet made = sheet_make(8, 2, 0.45, t, 0, GXS_LINEAR);
        gxs_solver *solver = solver_make();
        gxs_step_desc step = step_make(0, -1e-3);
        gxs_step_report report;
        double tip = 0, beam = 1000 * 1e-3 * t * pow(length, 4) / (8 * 1e6 * t * t * t / 12);
        size_t i;
        hold_left(&made);
        step.integrator = GXS_STATIC;
        step.newton_iterations = 3;
        step.cg_iterations = 20000;
        step.cg_tolerance = 1e-5;
        if (!affine) made.s.model.affine = NULL;
        ck_assert_int_eq(advance(solver, &made.s.model, &step, made.s.displacement, made.s.velocity, &report, NULL),
                         GX_OK);
        for (i = 0; i < made.nodes; i++) tip = fmax(tip, -made.s.displacement[3 * i + 2]);
        if (affine)
            assert_that(tip > 0.88 * beam && tip < 1.02 * beam, "%g of %g", tip, beam);
        else
            assert_that(tip < 0.1 * beam, "%g of %g", tip, beam);
        gxs_solver_destroy(solver);
        sheet_free(&made);
    }
}
END_TEST

/* Free sheets: every integrator and kind, damped; momentum is that of free fall. */
START_TEST(free_sheets_keep_their_momentum) {
    static const gxs_integrator integrators[4] = {GXS_BDF1, GXS_BDF2, GXS_MIDPOINT, GXS_EXPLICIT};
    sheet made;
    gxs_solver *solver;
    gxs_step_desc step = step_make(0.01, -10);
    double mass = 0, start[3] = {0, 0, 0}, end[3] = {0, 0, 0};
    size_t n, i, r;
    int round;
    seed((uint64_t)_i);
    made = sheet_make(3, 2, 0.4, 0.2, 0, _i % KINDS);
    made.s.material->damping = _i < 3 * KINDS ? 0.002 : 0; /* explicit: refused for the affine copies alone */
    solver = solver_of(&made);
    n = made.s.model.copy_count;
    step.integrator = integrators[_i / KINDS];
    for (i = 0; i < 3 * n; i++) made.s.velocity[i] = 0.1 * uniform();
    for (i = 0; i < n; i++)
        for (r = 0; r < 3; r++) {
            start[r] += solver->system->model.lumped[i] * made.s.velocity[3 * i + r];
            mass += r == 0 && i < made.nodes ? solver->system->model.lumped[i] : 0;
        }
    for (round = 0; round < 5; round++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, made.s.displacement, made.s.velocity, NULL, NULL), GX_OK);
    for (i = 0; i < n; i++)
        for (r = 0; r < 3; r++) end[r] += solver->system->model.lumped[i] * made.s.velocity[3 * i + r];
    for (r = 0; r < 3; r++)
        assert_that(fabs(end[r] - start[r] - (r == 2 ? -10 * 0.05 * mass : 0)) <= 2e-9 * mass, "%.9g %.9g of %g",
                    end[r], start[r], mass);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* Sheets that nothing holds take few iterations, too, step after step: some motions have several descriptions by
   affine copies, and none of these may grow. */
START_TEST(free_sheets_take_few_iterations) {
    static const double steps[3] = {0.002, 0.01, 0.05};
    sheet made = sheet_make(6, 4, 0.37, 0.2, 0, _i % 2 ? GXS_STABLE_NEO_HOOKEAN : GXS_LINEAR);
    gxs_solver *solver = solver_of(&made);
    gxs_step_desc step = step_make(steps[_i / 2], 0);
    gxs_step_report report;
    size_t i;
    int round;
    step.newton_iterations = 1;
    for (i = 0; i < made.nodes; i++) made.s.velocity[3 * i + 2] = 0.3 * sin(1.5 * made.s.rest[3 * i]);
    for (round = 0; round < 20; round++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, made.s.displacement, made.s.velocity, &report, NULL), GX_OK);
        assert_that(report.preconditioner == GXS_MULTIGRID && report.cg_iterations <= 15, "%u iterations",
                    report.cg_iterations);
    }
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* Without an affine copy, an array that says so changes no bit. */
START_TEST(none_is_none) {
    int given;
    double end[2];
    for (given = 0; given < 2; given++) {
        sheet made = sheet_make(4, 3, 0, 2, 0, GXS_STABLE_NEO_HOOKEAN);
        gxs_solver *solver = solver_make();
        gxs_step_desc step = step_make(0.02, -10);
        made.s.model.copy_count = made.nodes;
        memset(made.affine, 0xff, made.nodes * sizeof *made.affine);
        if (!given) made.s.model.affine = NULL;
        made.s.held[0] = made.s.held[1] = 1;
        ck_assert_int_eq(advance(solver, &made.s.model, &step, made.s.displacement, made.s.velocity, NULL, NULL),
                         GX_OK);
        end[given] = made.s.displacement[3 * made.nodes - 1];
        gxs_solver_destroy(solver);
        sheet_free(&made);
    }
    ck_assert(memcmp(&end[0], &end[1], sizeof end[0]) == 0);
}
END_TEST

/* What constraint `tie` makes of a field: a and A of its copy by the field of its masters, from what they move */
static void follow_field(const sheet *made, const gxs_constraint *tie, const double *u, double a[3], double A[3][3]) {
    int k, c, d;
    memset(a, 0, 3 * sizeof *a);
    memset(A, 0, 9 * sizeof(double));
    for (k = 0; k < 4; k++) {
        const uint32_t master = tie->master[k], first = made->affine[master];
        for (c = 0; c < 3; c++) {
            a[c] += tie->weight[k] * u[3 * master + (uint32_t)c];
            for (d = 0; d < 3 && first != GXS_NOT_AFFINE; d++) {
                const double column = u[3 * (first + (uint32_t)d) + (uint32_t)c] / made->s.model.affine_length;
                A[d][c] += tie->weight[k] * column;
                a[c] += tie->weight[k] * column *
                        (made->s.rest[3 * tie->copy + (uint32_t)d] - made->s.rest[3 * master + (uint32_t)d]);
            }
        }
    }
}

/* Copies at the end of a slab follow the field of an element: by all its four copies, or by one that is not affine too.
   Flung slabs keep their momentum, followers move as the field does. What hangs is in balance: forces on followers,
   given to the masters by the transpose of what they follow by, leave nothing. */
START_TEST(copies_follow_fields) {
    sheet made;
    gxs_solver *solver;
    gxs_step_desc step = step_make(_i % 2 ? 0 : 0.01, _i % 2 ? -1e-3 : 0);
    gxs_constraint ties[2];
    double *force, momentum[2][3] = {{0, 0, 0}, {0, 0, 0}}, off = 0, most = 0, left = 0, largest = 0;
    size_t i, t;
    int k, c, d, round;
    seed((uint64_t)_i);
    made = sheet_make(5, 2, 0.4, 0.3, 0, GXS_LINEAR);
    made.s.model.affine_length = 0.7;
    memset(ties, 0, sizeof ties);
    for (t = 0; t < 2; t++) { /* two copies of x = 5 by the element of the middle */
        const gxs_element *element = &made.s.elements[made.s.model.element_count / 2];
        double sum = 0;
        ties[t].copy = (uint32_t)(made.nodes - 1 - t * made.nodes / 2);
        ck_assert(made.s.rest[3 * ties[t].copy] > 4.9);
        for (k = 0; k < 4; k++) {
            ties[t].master[k] = element->copy[k];
            ck_assert(made.s.rest[3 * element->copy[k]] < 4.9);
            ties[t].weight[k] = k == 0 ? 0 : 0.2 + 0.7 * uniform();
            sum += ties[t].weight[k];
        }
        ties[t].weight[0] = 1 - sum;
    }
    if (_i >= 2) { /* one of the masters is not affine */
        const uint32_t plain = ties[0].master[2], first = made.affine[plain];
        made.affine[plain] = GXS_NOT_AFFINE;
        for (c = 0; c < 3; c++) made.s.held[first + (uint32_t)c] = 1; /* vectors of nobody */
    }
    made.s.model.constraints = ties;
    made.s.model.constraint_count = 2;
    if (_i % 2) {
        hold_left(&made);
        step.integrator = GXS_STATIC;
        step.newton_iterations = 8;
        step.newton_tolerance = 1e-10;
        step.cg_iterations = 20000;
        step.cg_tolerance = 1e-8;
    }
    solver = solver_of(&made);
    for (i = 0; i < made.nodes && _i % 2 == 0; i++)
        for (c = 0; c < 3; c++) made.s.velocity[3 * i + (size_t)c] = uniform();
    for (round = 0; round < (_i % 2 ? 1 : 5); round++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, made.s.displacement, made.s.velocity, NULL, NULL), GX_OK);
    for (i = 0; i < 3 * made.s.model.copy_count; i++) most = fmax(most, fabs(made.s.displacement[i]));
    for (t = 0; t < 2; t++) {
        double a[3], A[3][3];
        follow_field(&made, &ties[t], made.s.displacement, a, A);
        for (c = 0; c < 3; c++) {
            off = fmax(off, fabs(a[c] - made.s.displacement[3 * ties[t].copy + (uint32_t)c]));
            for (d = 0; d < 3; d++)
                off = fmax(off, fabs(made.s.model.affine_length * A[d][c] -
                                     made.s.displacement[3 * (made.affine[ties[t].copy] + (uint32_t)d) + (uint32_t)c]));
        }
    }
    assert_that(most > 1e-7 && off <= 1e-12 * most, "followers are off by %g of %g", off, most);
    force = (double *)zeroed(3 * made.s.model.copy_count, sizeof *force);
    (void)energy_of(solver, made.s.displacement, force);
    for (i = 0; i < made.s.model.copy_count; i++) {
        double *f = force + 3 * i;
        f[2] -= _i % 2 ? -1e-3 * solver->system->model.lumped[i] : 0;
        for (c = 0; c < 3; c++) largest = fmax(largest, fabs(f[c]));
    }
    for (i = 0; i < made.s.model.copy_count && _i % 2; i++)
        for (c = 0; c < 3 && !made.s.held[i]; c++) { /* the work of moving one number, and what follows it */
            double work = force[3 * i + (size_t)c], a[3], A[3][3];
            double *unit = (double *)zeroed(3 * made.s.model.copy_count, sizeof *unit);
            int follows = 0;
            unit[3 * i + (size_t)c] = 1;
            for (t = 0; t < 2; t++) {
                const uint32_t first = made.affine[ties[t].copy];
                follows |= i == ties[t].copy || (i >= first && i < first + 3);
                follow_field(&made, &ties[t], unit, a, A);
                for (k = 0; k < 3; k++) work += a[k] * force[3 * ties[t].copy + (uint32_t)k];
                for (d = 0; d < 3; d++)
                    for (k = 0; k < 3; k++)
                        work += made.s.model.affine_length * A[d][k] * force[3 * (first + (uint32_t)d) + (uint32_t)k];
            }
            left = fmax(left, follows ? 0 : fabs(work));
            free(unit);
        }
    assert_that(left <= 1e-5 * largest, "forces of %g are left of %g", left, largest);
    for (round = 0; round < 2 && _i % 2 == 0; round++) {
        for (i = 0; i < made.s.model.copy_count; i++)
            for (c = 0; c < 3; c++)
                momentum[round][c] += solver->system->model.lumped[i] * made.s.velocity[3 * i + (size_t)c];
        ck_assert_int_eq(gxs_solver_step(solver, &step, made.s.displacement, made.s.velocity, NULL, NULL), GX_OK);
    }
    for (c = 0; c < 3; c++)
        assert_that(fabs(momentum[1][c] - momentum[0][c]) <= 1e-9 * (1 + fabs(momentum[0][c])), "%g, %g",
                    momentum[0][c], momentum[1][c]);
    free(force);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

START_TEST(bad_input_is_named) {
    sheet made = sheet_make(2, 1, 0.4, 0.2, 0, GXS_LINEAR);
    gxs_solver *solver = solver_make();
    gx_failure failure;
    gxs_constraint constraint;
    const uint32_t first = made.affine[0];
    const double *positions;
    uint32_t corner;
    made.s.model.affine_length = 0;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "affine_length");
    made.s.model.affine_length = 1;
    made.affine[0] = (uint32_t)made.s.model.copy_count - 2;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_INDEX);
    made.affine[0] = made.affine[1];
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "affine");
    made.affine[0] = first;
    made.s.held[0] = 1;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "held");
    made.s.held[0] = 0;
    made.s.model.lumped_mass = 1;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "lumped_mass");
    made.s.model.lumped_mass = 0;
    made.s.model.affine_length = NAN;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_NOT_FINITE);
    ck_assert_str_eq(failure.field, "affine_length");
    made.s.model.affine_length = 1;
    made.affine[first] = first + 3; /* a vector of a group has one of its own */
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "affine");
    made.affine[first] = GXS_NOT_AFFINE;
    memset(&constraint, 0, sizeof constraint);
    constraint.copy = 1;
    constraint.master[0] = 5;
    constraint.master[1] = 2;
    constraint.master[2] = 3;
    constraint.master[3] = 4;
    constraint.weight[0] = 1;
    made.s.model.constraints = &constraint;
    made.s.model.constraint_count = 1;
    for (corner = 0; corner < 2; corner++) { /* a hidden vector follows, or leads */
        uint32_t *named = corner == 0 ? &constraint.copy : &constraint.master[2];
        const uint32_t before = *named;
        *named = first + 1;
        ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
        ck_assert_str_eq(failure.field, "constraints");
        *named = before;
    }
    positions = made.s.model.positions;
    made.s.model.positions = NULL; /* which the field of the masters needs */
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "positions");
    made.s.model.positions = positions;
    made.s.model.constraint_count = 0;
    corner = made.s.elements[0].copy[0];
    made.s.elements[0].copy[0] = first;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "elements.copy");
    made.s.elements[0].copy[0] = corner;
    for (corner = 0; corner < 2; corner++) { /* assembled, by volumes */
        gxs_solver_desc desc;
        gxs_solver *other = NULL;
        memset(&desc, 0, sizeof desc);
        if (corner == 0) desc.matrix = GXS_MATRIX_ASSEMBLED;
        if (corner == 1) desc.preconditioner = GXS_VOLUME_RATIO;
        ck_assert_int_eq(gxs_solver_create(&desc, &other, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_set_model(other, &made.s.model, &failure), GX_ERROR_ARGUMENT);
        ck_assert_str_eq(failure.field, corner == 0 ? "matrix" : "preconditioner");
        gxs_solver_destroy(other);
    }
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, &failure), GX_OK);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* Springs pull at groups of affine copies. By multigrid the sheet comes to rest where it does by the blocks alone. */
START_TEST(springs_pull_at_sheets) {
    static const gxs_preconditioner ways[2] = {GXS_MULTIGRID, GXS_BLOCK_JACOBI};
    double *found[2], most = 0, off = 0;
    size_t i, way, n = 0;
    for (way = 0; way < 2; way++) {
        sheet made = sheet_make(6, 2, 0.37, 0.2, 0, GXS_LINEAR);
        const uint32_t end = (uint32_t)made.nodes - 1, middle = end / 2, *affine = made.affine;
        const uint32_t copies[8] = {end,     affine[end],     affine[end] + 1, affine[end] + 2,
                                    end - 1, affine[end - 1], middle,          affine[middle] + 2};
        const double weights[8] = {0.5, 0.1, -0.05, 0.2, 0.4, 0.3, 0.1, 0.01};
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        gxs_step_desc step = step_make(0, -1);
        gxs_step_report report;
        gxs_spring springs[2];
        memset(&desc, 0, sizeof desc);
        desc.preconditioner = ways[way];
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        memset(springs, 0, sizeof springs);
        for (i = 0; i < 2; i++) {
            springs[i].point.count = 4 << i;
            springs[i].point.copies = copies;
            springs[i].point.weights = weights;
            springs[i].stiffness = 300;
            springs[i].target[i] = 0.02;
        }
        step.springs = springs;
        step.spring_count = 2;
        step.integrator = GXS_STATIC;
        step.cg_iterations = 20000;
        step.cg_tolerance = 1e-6;
        hold_left(&made);
        ck_assert_int_eq(advance(solver, &made.s.model, &step, made.s.displacement, made.s.velocity, &report, NULL),
                         GX_OK);
        ck_assert_int_eq(report.preconditioner, ways[way]);
        n = 3 * made.s.model.copy_count;
        found[way] = (double *)zeroed(n, sizeof(double));
        memcpy(found[way], made.s.displacement, n * sizeof(double));
        gxs_solver_destroy(solver);
        sheet_free(&made);
    }
    for (i = 0; i < n; i++) {
        most = fmax(most, fabs(found[1][i]));
        off = fmax(off, fabs(found[0][i] - found[1][i]));
    }
    assert_that(most > 1e-6 && off < 1e-3 * most, "off by %g of %g", off, most);
    free(found[0]);
    free(found[1]);
}
END_TEST

/* ---- pairs ---- */

enum { SIDE = 16, SPAN = 2 * SIDE }; /* vectors of a side: four copies and their hidden ones */

/* Two equal sheets, one above the other, and pairs between them: one for each element and the same of the other sheet
 */
typedef struct sandwich {
    gxs_model model;
    double *rest, *displacement, *velocity, *weights, *slips;
    gxs_element *elements;
    uint32_t *affine, *copies;
    uint8_t *held;
    gxs_pair *pairs;
    size_t plain; /* copies of both */
} sandwich;

/* The point of an element at a height, in the sheet's own coordinates: all that moves it, times sign. Returns its
 * place. */
static void side_of(const sandwich *two, const gxs_element *element, double height, double sign, uint32_t *copies,
                    double *weights, double *place) {
    double part[4];
    int k, r, above = 0;
    memset(place, 0, 3 * sizeof *place);
    for (k = 0; k < 4; k++) above += fmod(two->rest[3 * element->copy[k] + 2], 10) > 0.5;
    for (k = 0; k < 4; k++) {
        const double *x = two->rest + 3 * element->copy[k];
        part[k] = fmod(x[2], 10) > 0.5 ? height / above : (1 - height) / (4 - above);
        for (r = 0; r < 3; r++) place[r] += part[k] * x[r];
    }
    for (k = 0; k < 4; k++) {
        copies[4 * k] = element->copy[k];
        weights[4 * k] = sign * part[k];
        for (r = 0; r < 3; r++) {
            copies[4 * k + 1 + r] = two->affine[element->copy[k]] + (uint32_t)r;
            weights[4 * k + 1 + r] = sign * part[k] * (place[r] - two->rest[3 * element->copy[k] + (size_t)r]);
        }
    }
}

/* Sheets of z0 to z0 + t; the second one's coordinates are 10 higher, and it touches the first. */
static sandwich sandwich_make(int nx, int ny, double z0, double t, double stiffness, double friction) {
    sheet one = sheet_make(nx, ny, z0, t, 0, GXS_STABLE_NEO_HOOKEAN);
    const size_t half = one.nodes, elements = one.s.model.element_count, n = 8 * half;
    sandwich two;
    size_t i, e;
    int k;
    memset(&two, 0, sizeof two);
    two.plain = 2 * half;
    two.rest = (double *)zeroed(3 * n, sizeof(double));
    two.displacement = (double *)zeroed(3 * n, sizeof(double));
    two.velocity = (double *)zeroed(3 * n, sizeof(double));
    two.held = (uint8_t *)zeroed(n, 1);
    two.affine = (uint32_t *)zeroed(n, sizeof(uint32_t));
    two.elements = (gxs_element *)zeroed(2 * elements, sizeof *two.elements);
    two.pairs = (gxs_pair *)zeroed(elements, sizeof *two.pairs);
    two.copies = (uint32_t *)zeroed(SPAN * elements, sizeof(uint32_t));
    two.weights = (double *)zeroed(SPAN * elements, sizeof(double));
    two.slips = (double *)zeroed(3 * elements, sizeof(double));
    memset(two.affine, 0xff, n * sizeof(uint32_t));
    for (i = 0; i < 2 * half; i++) {
        two.affine[i] = (uint32_t)(2 * half + 3 * i);
        memcpy(two.rest + 3 * i, one.s.rest + 3 * (i % half), 3 * sizeof(double));
        two.rest[3 * i + 2] += i < half ? 0 : 10;
    }
    for (e = 0; e < 2 * elements; e++) {
        two.elements[e] = one.s.elements[e % elements];
        for (k = 0; k < 4 && e >= elements; k++) two.elements[e].copy[k] += (uint32_t)half;
    }
    for (e = 0; e < elements; e++) {
        gxs_pair *pair = &two.pairs[e];
        double above[3], below[3];
        side_of(&two, &two.elements[elements + e], z0, 1, two.copies + SPAN * e, two.weights + SPAN * e, above);
        side_of(&two, &two.elements[e], z0 + t, -1, two.copies + SPAN * e + SIDE, two.weights + SPAN * e + SIDE, below);
        pair->point.count = SPAN;
        pair->point.copies = two.copies + SPAN * e;
        pair->point.weights = two.weights + SPAN * e;
        for (k = 0; k < 2; k++) pair->point.position[k] = above[k] - below[k];
        pair->normal[2] = 1; /* position: they touch */
        pair->stiffness = stiffness / 6;
        pair->friction = friction;
    }
    two.model = one.s.model;
    two.model.materials = (gxs_material *)zeroed(1, sizeof(gxs_material));
    *(gxs_material *)two.model.materials = *one.s.material;
    two.model.copy_count = n;
    two.model.positions = two.rest;
    two.model.elements = two.elements;
    two.model.element_count = 2 * elements;
    two.model.held = two.held;
    two.model.affine = two.affine;
    sheet_free(&one);
    return two;
}

static void sandwich_free(sandwich *two) {
    free((void *)two->model.materials);
    free(two->rest);
    free(two->displacement);
    free(two->velocity);
    free(two->held);
    free(two->affine);
    free(two->elements);
    free(two->pairs);
    free(two->copies);
    free(two->weights);
    free(two->slips);
}

/* The deepest overlap of the pairs, m */
static double overlap_of(const sandwich *two, const gxs_step_desc *step) {
    double most = 0;
    size_t i;
    uint32_t k;
    for (i = 0; i < step->pair_count; i++) {
        double z = 0;
        for (k = 0; k < SPAN; k++)
            z += two->weights[SPAN * i + k] * two->displacement[3 * (size_t)two->copies[SPAN * i + k] + 2];
        most = fmax(most, -z);
    }
    return most;
}

/* A sheet falls flat or tilted onto another in free fall: they part again, momentum is kept, no energy is won. */
START_TEST(pairs_press_sheets) {
    sandwich two = sandwich_make(4, 3, 0.37, 0.2, 1e6, _i % 2 ? 0.5 : 0);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.002, 0);
    gxs_step_report report;
    double before[3] = {0, 0, 0}, after[3] = {0, 0, 0}, mass = 0, first = 0, deepest = 0;
    size_t i, r;
    int round;
    ck_assert_int_eq(gxs_solver_set_model(solver, &two.model, NULL), GX_OK);
    step.pairs = two.pairs;
    step.pair_count = two.model.element_count / 2;
    step.pair_slips = two.slips;
    step.newton_iterations = 4;
    for (i = 0; i < two.plain; i++) {
        const int upper = i >= two.plain / 2;
        mass += solver->system->model.lumped[i];
        two.displacement[3 * i + 2] = upper ? 0.05 + (_i < 2 ? 0 : 0.05 * two.rest[3 * i]) : 0;
        two.velocity[3 * i + 2] = upper ? -2 : 0;
        two.velocity[3 * i] = upper ? 0.5 : 0;
        if (upper && _i >= 2) two.displacement[3 * ((size_t)two.affine[i]) + 2] = 0.05;
    }
    for (i = 0; i < two.model.copy_count; i++)
        for (r = 0; r < 3; r++) before[r] += solver->system->model.lumped[i] * two.velocity[3 * i + r];
    for (round = 0; round < 80; round++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, two.displacement, two.velocity, &report, NULL), GX_OK);
        deepest = fmax(deepest, overlap_of(&two, &step));
        first = round == 0 ? report.energy : first;
        assert_that(report.cg_iterations <= 72, "%u iterations", report.cg_iterations);
    }
    for (i = 0; i < two.model.copy_count; i++)
        for (r = 0; r < 3; r++) after[r] += solver->system->model.lumped[i] * two.velocity[3 * i + r];
    for (r = 0; r < 3; r++)
        assert_that(fabs(after[r] - before[r]) <= 1e-8 * mass, "%g, %g of %g", before[r], after[r] - before[r], mass);
    assert_that(deepest > 1e-4 && deepest < 0.05, "overlap %g", deepest);
    assert_that(overlap_of(&two, &step) < 1e-9, "they do not part: %g", overlap_of(&two, &step));
    gxs_solver_destroy(solver);
    sandwich_free(&two);
}
END_TEST

/* Sheets that lie on each other, clamped at one side, press each other apart and bend under their weight: by
   multigrid as by the blocks alone */
START_TEST(pairs_carry_sheets) {
    static const gxs_preconditioner ways[2] = {GXS_MULTIGRID, GXS_BLOCK_JACOBI};
    double *found[2], most = 0, off = 0, deepest = 0;
    unsigned iterations[2];
    size_t i, way, n = 0;
    for (way = 0; way < 2; way++) {
        sandwich two = sandwich_make(6, 2, 0.37, 0.2, 1e5, 0);
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        gxs_step_desc step = step_make(0, -0.1);
        gxs_step_report report;
        memset(&desc, 0, sizeof desc);
        desc.preconditioner = ways[way];
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        for (i = 0; i < two.plain; i++)
            two.held[i] = two.held[two.affine[i]] = two.held[two.affine[i] + 1] = two.held[two.affine[i] + 2] =
                two.rest[3 * i] < 1e-9;
        for (i = 0; i < two.model.element_count / 2; i++) two.pairs[i].offset = 0.01; /* they press each other apart */
        step.pairs = two.pairs;
        step.pair_count = two.model.element_count / 2;
        step.integrator = GXS_STATIC;
        step.newton_iterations = 12;
        step.newton_tolerance = 1e-7;
        step.cg_iterations = 20000;
        step.cg_tolerance = 1e-6;
        ck_assert_int_eq(advance(solver, &two.model, &step, two.displacement, two.velocity, &report, NULL), GX_OK);
        iterations[way] = report.cg_iterations / (report.newton_iterations + (report.newton_iterations == 0));
        deepest = fmax(deepest,
                       fabs(two.displacement[3 * (two.plain - 1) + 2] - two.displacement[3 * (two.plain / 2 - 1) + 2]));
        n = 3 * two.model.copy_count;
        found[way] = (double *)zeroed(n, sizeof(double));
        memcpy(found[way], two.displacement, n * sizeof(double));
        gxs_solver_destroy(solver);
        sandwich_free(&two);
    }
    for (i = 0; i < n; i++) {
        most = fmax(most, fabs(found[1][i]));
        off = fmax(off, fabs(found[0][i] - found[1][i]));
    }
    assert_that(most > 1e-5 && off < 1e-3 * most && deepest > 1e-4, "off by %g of %g, apart %g", off, most, deepest);
    assert_that(3 * iterations[0] < iterations[1], "%u iterations, blocks alone %u", iterations[0], iterations[1]);
    free(found[0]);
    free(found[1]);
}
END_TEST

/* A slab of 15 x 4 cubes, clamped, without inertia: iterations to 1e-2. By the blocks alone they are 700 and more. The
   error's energy is compared with that of the answer by four solves to 1e-5. */
START_TEST(multigrid_bends_with_sheets) {
    static const double thickness[3] = {0.2, 0.1, 0.05};
    static const unsigned most[3] = {12, 18, 35};
    sheet made = sheet_make(15, 4, 0.37, thickness[_i], 0, GXS_LINEAR);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0, -1e-3);
    gxs_step_report report;
    const size_t n = 3 * made.s.model.copy_count;
    double *u = (double *)zeroed(2 * n, sizeof *u), *force = u + n, all;
    size_t i;
    hold_left(&made);
    step.integrator = GXS_STATIC;
    ck_assert_int_eq(advance(solver, &made.s.model, &step, made.s.displacement, made.s.velocity, &report, NULL), GX_OK);
    ck_assert_int_eq(report.preconditioner, GXS_MULTIGRID);
    assert_that(report.cg_iterations <= most[_i], "%u iterations", report.cg_iterations);
    memcpy(u, made.s.displacement, n * sizeof *u);
    step.newton_iterations = 4;
    step.cg_tolerance = 1e-5;
    ck_assert_int_eq(gxs_solver_step(solver, &step, made.s.displacement, made.s.velocity, NULL, NULL), GX_OK);
    all = energy_of(solver, made.s.displacement, force);
    for (i = 0; i < n; i++) u[i] -= made.s.displacement[i];
    assert_that(energy_of(solver, u, force) <= 1.5e-4 * all, "off by %g", sqrt(energy_of(solver, u, force) / all));
    free(u);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* The slices of slab_in_five in motion. Its step, cubes of 1 cm and 30 MPa are as soft as a step of 2.7 s here. */
START_TEST(multigrid_moves_sheets) {
    static const double thickness[3] = {1. / 5, 2. / 15, 1. / 15};
    static const unsigned most[3] = {12, 18, 25};
    sheet made = sheet_make(61, 11, 0.37, thickness[_i], 0, GXS_LINEAR);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(sqrt(7.5), -1e-3);
    gxs_step_report report;
    hold_left(&made);
    step.newton_iterations = 1;
    made.s.material->poisson = 0.4;
    ck_assert_int_eq(advance(solver, &made.s.model, &step, made.s.displacement, made.s.velocity, &report, NULL), GX_OK);
    ck_assert_int_eq(report.preconditioner, GXS_MULTIGRID);
    assert_that(report.cg_iterations <= most[_i], "%u iterations", report.cg_iterations);
    gxs_solver_destroy(solver);
    sheet_free(&made);
}
END_TEST

/* A slice that is let go in steps of 33 ms, as those of slab_in_five: where the free end is, x 3. newton: iterations;
   60: to balance. Returns how many there were. */
static uint32_t fling(uint32_t newton, double quality, size_t steps, double *at) {
    sheet made = sheet_make(20, 1, 0.37, 0.2, 0, GXS_ST_VENANT_KIRCHHOFF);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(18.3, -3.27e-3);
    gxs_step_report report;
    uint32_t sum = 0;
    size_t i, end = 0;
    hold_left(&made);
    step.newton_iterations = newton;
    step.newton_tolerance = newton == 60 ? 1e-7 : 0;
    step.cg_tolerance = newton == 60 ? 1e-4 : 0;
    step.quality = quality;
    for (i = 0; i < made.nodes; i++)
        if (made.s.rest[3 * i] > made.s.rest[3 * end]) end = i;
    ck_assert_int_eq(gxs_solver_set_model(solver, &made.s.model, NULL), GX_OK);
    for (i = 0; i < steps; i++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, made.s.displacement, made.s.velocity, &report, NULL), GX_OK);
        memcpy(at + 3 * i, made.s.displacement + 3 * end, 3 * sizeof *at);
        sum += report.newton_iterations;
    }
    gxs_solver_destroy(solver);
    sheet_free(&made);
    return sum;
}

/* Without a number Newton's method goes on until flung sheets move within 5 % of converged steps. One iteration lags.
 */
START_TEST(flung_sheets_settle) {
    enum { STEPS = 15 };
    static const uint32_t newton[2] = {1, 0};
    double truth[3 * STEPS], at[3 * STEPS], error[2], most = 0;
    uint32_t count[3];
    size_t i, run;
    count[2] = fling(60, 0, STEPS, truth);
    for (i = 0; i < STEPS; i++) most = fmax(most, sqrt(gxsp_dot(truth + 3 * i, truth + 3 * i, 1)));
    for (run = 0; run < 2; run++) {
        double sum = 0;
        count[run] = fling(newton[run], 0, STEPS, at);
        for (i = 0; i < 3 * STEPS; i++) sum += (at[i] - truth[i]) * (at[i] - truth[i]);
        error[run] = sqrt(sum / STEPS) / most;
    }
    assert_that(most > 10, "it moves by %g", most);
    assert_that(error[0] > 0.2, "one iteration is off by %g", error[0]);
    assert_that(error[1] < 0.05, "off by %g", error[1]);
    ck_assert_uint_eq(count[0], STEPS);
    assert_that(count[1] > 2 * STEPS && count[1] < count[2], "%u and %u iterations", count[1], count[2]);
    assert_that(fling(0, 0.1, 2, at) > 2 * 2, "one iteration each by quality"); /* its parts settle, too */
}
END_TEST

static int set_and_step(memory *m, int which) {
    sheet made = sheet_make(2, 1, 0.4, 0.2, 0, which);
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gxs_step_desc step = step_make(0.01, -10);
    gx_result result;
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator_of(m);
    result = gxs_solver_create(&desc, &solver, NULL);
    if (result == GX_OK)
        result = advance(solver, &made.s.model, &step, made.s.displacement, made.s.velocity, NULL, NULL);
    ck_assert(result == GX_OK || result == GX_ERROR_MEMORY);
    gxs_solver_destroy(solver);
    sheet_free(&made);
    return result != GX_OK;
}

START_TEST(every_allocation_may_fail) { sweep_allocations(set_and_step, _i); }
END_TEST

int main(void) {
    Suite *suite = suite_create("affine copies");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, four_points_integrate_quadratics, 0, 3);
    tcase_add_test(all, an_element_has_no_hourglass_mode);
    tcase_add_loop_test(all, a_free_sheet_has_24_zero_modes, 0, 2);
    tcase_add_test(all, a_clamped_sheet_hangs_as_a_beam);
    tcase_add_loop_test(all, rotations_are_free, 0, GXS_LINEAR);
    tcase_add_loop_test(all, forces_and_products_match_differences, 0, KINDS);
    tcase_add_loop_test(all, products_agree, 0, 2 * KINDS);
    tcase_add_loop_test(all, a_cut_sheet_bends_and_twists_exactly, 0, 4);
    tcase_add_loop_test(all, free_sheets_keep_their_momentum, 0, 4 * KINDS);
    tcase_add_loop_test(all, multigrid_bends_with_sheets, 0, 3);
    tcase_add_loop_test(all, multigrid_moves_sheets, 0, 3);
    tcase_add_test(all, flung_sheets_settle);
    tcase_add_test(all, none_is_none);
    tcase_add_loop_test(all, copies_follow_fields, 0, 4);
    tcase_add_test(all, bad_input_is_named);
    tcase_add_test(all, springs_pull_at_sheets);
    tcase_add_loop_test(all, free_sheets_take_few_iterations, 0, 6);
    tcase_add_loop_test(all, pairs_press_sheets, FEWER > 1 ? 3 : 0, 4);
    tcase_add_test(all, pairs_carry_sheets);
    tcase_add_loop_test(all, every_allocation_may_fail, 0, KINDS);
    tcase_set_timeout(all, 120);
    suite_add_tcase(suite, all);
    return run_suite(suite);
}
