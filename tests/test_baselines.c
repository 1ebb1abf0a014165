/* test_baselines.c - the methods with which benches compare the library: bench/dense.h, part.h, rxfem.h and its
   parts, sampling.h, parts.h, local.h. Each must be as good as intended, otherwise the comparison means nothing.

   Truth: part.h against rationals and the oracle; then rules against part.h, enrichments against the library's copies,
   local solvers against its converged steps. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../bench/forms.h"
#include "../bench/part.h"
#include "../bench/rxfem_model.h"
#include "../bench/sampling.h"
#include "../bench/parts.h"
#include "../bench/local.h"
#include "body.h"
#include "oracle.h"

enum { SEEDS = 40 / FEWER };

static const double unit_corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t unit_element[4] = {0, 1, 2, 3};

static rx_rules *rules; /* as published */

static void make_rules(void) { rules = rx_rules_create(2, 0); }
static void free_rules(void) { rx_rules_destroy(rules); }

static rx_surface rx_surface_of(const wl_surface *s) {
    rx_surface r;
    r.vertices = s->vertices;
    r.vertex_count = s->vertex_count;
    r.triangles = s->triangles;
    r.triangle_count = s->triangle_count;
    return r;
}

static rx_body *rx_body_of(const workload *w) {
    return rx_body_create(rules, w->positions, w->node_count, w->elements, w->element_count);
}

static rx_result rx_cut_by(rx_body *b, const workload *w, size_t k) {
    const rx_surface s = rx_surface_of(&w->surfaces[k]);
    return rx_body_cut(b, &s);
}

/* ---- dense.h ---- */

static void fill_random(double *a, size_t n) {
    size_t i;
    for (i = 0; i < n; i++) a[i] = random_real(-1, 1);
}

/* c = a b, a: m x k, b: k x n */
static void multiply(const double *a, const double *b, size_t m, size_t k, size_t n, double *c) {
    size_t i, j, l;
    for (i = 0; i < m; i++)
        for (j = 0; j < n; j++)
            for (c[i * n + j] = 0, l = 0; l < k; l++) c[i * n + j] += a[i * k + l] * b[l * n + j];
}

/* A^T (A x - b) = 0 and x without a part in the null space: both are what x = A^+ b means. */
static void check_pseudo_inverse(pinv *p, size_t m, size_t n, size_t rank, uint64_t seed) {
    double a[400], left[400], right[400], b[20], x[20], back[20], again[20], gradient;
    size_t i, j;
    fill_random(left, m * rank);
    fill_random(right, rank * n);
    multiply(left, right, m, rank, n, a);
    fill_random(b, m);
    pinv_factor(p, a, m, n, 1e-10);
    pinv_solve(p, b, x);
    multiply(a, x, m, n, 1, back);
    for (j = 0; j < n; j++) {
        for (gradient = 0, i = 0; i < m; i++) gradient += a[i * n + j] * (back[i] - b[i]);
        CHECK_SEED(fabs(gradient) < 1e-10, seed);
    }
    pinv_solve(p, back, again); /* A^+ A x = x: x is orthogonal to the null space of A */
    for (j = 0; j < n; j++) CHECK_SEED(fabs(again[j] - x[j]) < 1e-9, seed);
    for (i = 0, j = 0; j < p->rank; j++) i += p->scale[j] > 0;
    CHECK_SEED(i == rank, seed);
}

START_TEST(pseudo_inverse) {
    pinv p;
    uint64_t seed;
    memset(&p, 0, sizeof p);
    for (seed = 1; seed <= SEEDS; seed++) {
        size_t m, n, least;
        random_seed(seed);
        m = 1 + (size_t)random_below(20);
        n = 1 + (size_t)random_below(20);
        least = m < n ? m : n;
        check_pseudo_inverse(&p, m, n, 1 + (size_t)random_below((int)least), seed);
    }
    pinv_free(&p);
}
END_TEST

/* ---- part.h ---- */

/* d0 / (d0 - d) for the distances of two corners from the plane of a triangle: where the plane meets their edge */
static rat edge_share(const double *t, const double *x0, const double *x) {
    const big a = big_orient3d(t, t + 3, t + 6, x0), b = big_orient3d(t, t + 3, t + 6, x);
    return rat_ratio(a, big_sub(a, b));
}

/* The moments of the corner that a plane cuts off at node 0: the simplex with the legs s_i has s1 s2 s3 / 6, times
   s_i / 4, times s_i s_j (1 + (i = j)) / 20 */
static void corner_moments(const double *t, const double *x, rat m[10]) {
    rat s[3], all;
    int i, j, at = 4;
    for (i = 0; i < 3; i++) s[i] = edge_share(t, x, x + 3 * (i + 1));
    all = rat_mul(rat_mul(s[0], s[1]), s[2]);
    m[0] = rat_div(all, rat_from_int(6));
    for (i = 0; i < 3; i++) m[1 + i] = rat_div(rat_mul(all, s[i]), rat_from_int(24));
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) m[at++] = rat_div(rat_mul(rat_mul(all, s[i]), s[j]), rat_from_int(i == j ? 60 : 120));
}

/* A triangle that cuts off corner 0 of the tetrahedron, and reaches far beyond it */
static void cut_corner(const double *x, double *t) {
    double legs[3], p[9];
    int i, a;
    for (i = 0; i < 3; i++) legs[i] = random_real(0.05, 0.95);
    for (i = 0; i < 9; i++) p[i] = x[i % 3] + legs[i / 3] * (x[3 + i] - x[i % 3]);
    for (i = 0; i < 3; i++)
        for (a = 0; a < 3; a++)
            t[3 * i + a] = p[3 * i + a] + 3 * (2 * p[3 * i + a] - p[(3 * i + 3) % 9 + a] - p[(3 * i + 6) % 9 + a]);
}

static void random_tetrahedron(double *x) {
    do fill_random(x, 12);
    while (gxi_tet_volume(x) < 0.05);
}

START_TEST(truth_against_rationals) {
    static const uint32_t triangle[3] = {0, 1, 2};
    uint64_t seed;
    for (seed = 1; seed <= SEEDS; seed++) {
        const rat_mark mark = rat_arena_mark();
        double x[12], t[9];
        long double m[10];
        rat exact[10];
        part p;
        int i;
        random_seed(seed);
        random_tetrahedron(x);
        cut_corner(x, t);
        corner_moments(t, x, exact);
        p = part_create(x, t, triangle, 1, 0);
        part_moments(&p, m);
        for (i = 0; i < 10; i++)
            CHECK_SEED(fabs((double)m[i] - rat_to_double(exact[i])) <= 1e-15 * rat_to_double(exact[i]), seed);
        part_free(&p);
        rat_arena_release(mark);
    }
}
END_TEST

/* Volumes of parts of a tetrahedron cut by a folded sheet, by the oracle that shares no idea with the library */
START_TEST(truth_against_oracle) {
    static const double fold[12] = {-0.9375, -1, 0.3, 2.0625, 2, 0.3, 2.0625, -1, -2.7, -0.9375, 2, -2.7};
    static const uint32_t triangles[6] = {0, 2, 1, 0, 1, 3};
    const oracle_mesh mesh = {unit_corners, 4, unit_element, 1, NULL};
    const oracle_surface surface = {fold, triangles, 2, 0};
    oracle *o = oracle_create(&mesh, &surface, 1);
    part p = part_create(unit_corners, fold, triangles, 2, 0);
    part_shape inside = part_tetrahedra(&p), boundary = part_boundary(&p);
    double volume = 0, cones = 0;
    long double m[10];
    size_t i;
    part_moments(&p, m);
    ck_assert_uint_eq(o->cell_count, 2);
    ck_assert_double_eq_tol(fmin(fabs((double)m[0] - o->cell_volume[0]), fabs((double)m[0] - o->cell_volume[1])), 0,
                            1e-17);
    for (i = 0; i < inside.count; i++) volume += sampling_volume(inside.corners + 12 * i);
    ck_assert_double_eq_tol(volume, (double)m[0], 1e-16);
    for (i = 0; i < boundary.count; i++) {
        double cone[12] = {0};
        memcpy(cone + 3, boundary.corners + 9 * i, 9 * sizeof(double));
        cones += sampling_volume(cone);
    }
    ck_assert_double_eq_tol(cones, (double)m[0], 1e-16);
    free(inside.corners);
    free(boundary.corners);
    part_free(&p);
    oracle_destroy(o);
}
END_TEST

/* ---- RXFEM's rules ---- */

/* Divergence-free: no flux out of the tetrahedron. Antiderivatives: the flux is the integral. By the rules of whole
 * faces. */
START_TEST(fields_and_antiderivatives) {
    unsigned degree;
    for (degree = 1; degree <= RX_DEGREE_MAX; degree++) {
        rx_rules *r = rx_rules_create(degree, 0);
        const rx_fit *v = &r->volume, *f = &r->face;
        double flux[RX_FIELDS] = {0}, integral[RX_MONOMIALS] = {0}, moments[RX_MONOMIALS];
        size_t i, j;
        int k;
        for (i = 0; i < f->moment_count; i++)
            moments[i] = rx_simplex_integral(2, f->basis.exponent[i][0], f->basis.exponent[i][1], 0);
        for (k = 0; k < 4; k++)
            for (i = 0; i < f->point_count; i++) {
                const double w = dense_dot(f->weights[i], moments, f->moment_count);
                dense_add(flux, w, r->fluxes[k][i], v->field_count);
                dense_add(integral, w, r->antiderivatives[k][i], v->moment_count);
            }
        for (j = 0; j < v->field_count; j++) ck_assert_double_eq_tol(flux[j], 0, 1e-13);
        for (j = 0; j < v->moment_count; j++) {
            const unsigned char *e = v->basis.exponent[j];
            ck_assert_double_eq_tol(integral[j], rx_simplex_integral(3, e[0], e[1], e[2]), 1e-13);
        }
        rx_rules_destroy(r);
    }
}
END_TEST

/* The numbers of functions and points of the paper: 24, 19. Fields to degree 3 in space are 50, to 4 in the plane
   20. */
START_TEST(published_counts) {
    size_t i;
    double gauss = 0;
    ck_assert_uint_eq(rules->volume.point_count, 24);
    ck_assert_uint_eq(rules->face.point_count, 19);
    ck_assert_uint_eq(rules->volume.moment_count, 10);
    ck_assert_uint_eq(rules->face.moment_count, 10);
    ck_assert_uint_eq(rules->volume.field_count, 50);
    ck_assert_uint_eq(rules->face.field_count, 20);
    for (i = 0; i < RX_GAUSS; i++) {
        ck_assert_double_eq_tol(RX_GAUSS_AT[i], rx_gauss_point(RX_GAUSS, (int)i), 1e-15);
        gauss += RX_GAUSS_WEIGHT[i] * pow(RX_GAUSS_AT[i], 7);
    }
    ck_assert_double_eq_tol(gauss, 0.125, 1e-15);
}
END_TEST

/* The largest error of the piece's moments, relative to those of the whole reference element */
static double moments_error(const rx_body *b, const rx_piece *piece, const long double m[10]) {
    const rx_basis *basis = &b->rules->volume.basis;
    double worst = 0;
    size_t i;
    for (i = 0; i < 10; i++) {
        const unsigned char *e = basis->exponent[i];
        worst = fmax(worst, fabs(piece->moments[i] - (double)m[i]) / rx_simplex_integral(3, e[0], e[1], e[2]));
    }
    return worst;
}

/* The piece on corner 0's side */
static const rx_piece *piece_at_corner(const rx_body *b) {
    ck_assert_uint_eq(b->piece_count, 2);
    return &b->pieces[(b->pieces[0].plus & 1) == (b->patches[b->patch_list[0]].plus & 1) ? 0 : 1];
}

/* Cuts one tetrahedron; returns the error of both pieces, and checks that the weights at the points give the moments.
 */
static double one_cut_error(rx_rules *r, const double *x, const rx_surface *s) {
    rx_body *b = rx_body_create(r, x, 4, unit_element, 1);
    part p = part_create(x, s->vertices, s->triangles, s->triangle_count, 0);
    const rx_piece *piece;
    long double m[10], rest[10];
    double weights[RX_POINTS], values[RX_MONOMIALS], error;
    size_t i, j;
    ck_assert_int_eq(rx_body_cut(b, s), RX_OK);
    piece = piece_at_corner(b);
    part_moments(&p, m);
    for (i = 0; i < 10; i++) {
        const unsigned char *e = r->volume.basis.exponent[i];
        rest[i] = rx_simplex_integral(3, e[0], e[1], e[2]) - m[i];
    }
    error = fmax(moments_error(b, piece, m), moments_error(b, piece == b->pieces ? piece + 1 : b->pieces, rest));
    rx_weights(r, piece->moments, weights);
    for (i = 0; i < r->volume.moment_count; i++) {
        double sum = 0;
        for (j = 0; j < r->volume.point_count; j++) {
            rx_basis_values(&r->volume.basis, r->volume.points[j], values);
            sum += weights[j] * values[i];
        }
        ck_assert_double_eq_tol(sum, piece->moments[i], 1e-14);
    }
    part_free(&p);
    rx_body_destroy(b);
    return error;
}

/* Through a point near the middle of a random tetrahedron: a plane, or two triangles that meet in a ridge there */
static workload random_dihedral(uint64_t seed, int bent, double x[12]) {
    workload w;
    wl_surface *s;
    double share[4], middle[3] = {0, 0, 0}, ridge[3], wing[3], p[4][3], sum = 0;
    int k;
    random_seed(seed);
    random_tetrahedron(x);
    w = wl_tetrahedron((const double(*)[3])(const void *)unit_corners);
    memcpy(w.positions, x, 12 * sizeof(double));
    for (k = 0; k < 4; k++) sum += share[k] = random_real(0.5, 1);
    for (k = 0; k < 12; k++) middle[k % 3] += share[k / 3] / sum * x[k];
    do fill_random(ridge, 3);
    while (dense_dot(ridge, ridge, 3) < 0.2);
    do fill_random(wing, 3);
    while (dense_dot(wing, wing, 3) < 0.2 || fabs(dense_dot(wing, ridge, 3)) > 0.2);
    if (!bent) {
        add_plane(&w, middle, wing, 9);
        return w;
    }
    s = wl_add_surface(&w, 0);
    for (k = 0; k < 3; k++) {
        p[0][k] = middle[k] - 15 * ridge[k];
        p[1][k] = middle[k] + 15 * ridge[k];
        p[2][k] = middle[k] + 15 * wing[k];
        p[3][k] = middle[k] - 15 * wing[k] + random_real(-8, 8);
    }
    for (k = 0; k < 4; k++) wl_add_vertex(s, p[k]);
    wl_add_triangle(s, 0, 1, 2);
    wl_add_triangle(s, 1, 0, 3);
    return w;
}

/* Exact on planes, and on wedges too: the fields' normal components span all polynomials on two planes at once.
   Triangles here reach 10 to 100 elements far. Points on the whole triangles, unclipped, cost digits. */
START_TEST(rules_on_planes_and_wedges) {
    int clip, bent;
    for (clip = 0; clip < 2; clip++) {
        rx_rules *r = rx_rules_create(2, clip);
        uint64_t seed;
        for (bent = 0; bent < 2; bent++)
            for (seed = 1; seed <= SEEDS; seed++) {
                double x[12], error;
                workload w = random_dihedral(seed, bent, x);
                const rx_surface s = rx_surface_of(&w.surfaces[0]);
                error = one_cut_error(r, x, &s);
                ck_assert_msg(error < (clip ? 1e-11 : 1e-6), "seed %d, clip %d, bent %d: %.2e", (int)seed, clip, bent,
                              error);
                wl_free(&w);
            }
        rx_rules_destroy(r);
    }
}
END_TEST

/* On a wavy sheet the interface is fitted, not integrated: the error is that of the fit, however small the triangles
 * are. */
START_TEST(rules_on_waves) {
    static const double origin[3] = {0.05, 0.04, 0.31};
    double error[2];
    int i, k;
    for (i = 0; i < 2; i++) {
        workload w = corner_tet();
        wl_frame f = wl_axes();
        rx_surface s;
        for (k = 0; k < 3; k++) f.origin[k] = origin[k];
        wl_add_wave(wl_add_surface(&w, 0), &f, i == 0 ? 9 : 37, 1.9);
        s = rx_surface_of(&w.surfaces[0]);
        error[i] = one_cut_error(rules, w.positions, &s);
        wl_free(&w);
    }
    for (i = 0; i < 2; i++) {
        ck_assert_double_gt(error[i], 1e-6);
        ck_assert_double_lt(error[i], 2e-3);
    }
}
END_TEST

/* ---- RXFEM's enrichment ---- */

/* The values of the functions at each corner of each cell: rows are cell x 4 + corner, elements in order and their
   cells by volume */
typedef struct span {
    double *a;
    size_t rows, columns;
} span;

typedef struct sized {
    double volume;
    size_t index;
} sized;

static int by_volume(const void *a, const void *b) {
    const sized *x = (const sized *)a, *y = (const sized *)b;
    return (x->volume > y->volume) - (x->volume < y->volume);
}

/* Order of cells: by element, then by volume */
static size_t *order_cells(const uint32_t *element, const double *volume, size_t count) {
    size_t *order = (size_t *)dense_memory(NULL, count, sizeof *order), from, to, i;
    sized *list = (sized *)dense_memory(NULL, count, sizeof *list);
    for (i = 0; i < count; i++) {
        list[i].volume = volume[i];
        list[i].index = i;
    }
    for (from = 0; from < count; from = to) {
        for (to = from; to < count && element[to] == element[from]; to++) {}
        qsort(list + from, to - from, sizeof *list, by_volume);
    }
    for (i = 0; i < count; i++) order[i] = list[i].index;
    free(list);
    return order;
}

static span span_of_copies(const gx_view *v) {
    size_t *order = order_cells(v->cell_element, v->cell_volume, v->cell_count), i, k;
    span s;
    s.rows = 4 * v->cell_count;
    s.columns = v->copy_count;
    s.a = (double *)dense_memory(NULL, s.rows * s.columns, sizeof(double));
    for (i = 0; i < v->cell_count; i++)
        for (k = 0; k < 4; k++) s.a[(4 * i + k) * s.columns + v->cell_copies[4 * order[i] + k]] = 1;
    free(order);
    return s;
}

static span span_of_enrichments(const rx_body *b) {
    uint32_t *element = (uint32_t *)dense_memory(NULL, b->piece_count, sizeof *element), functions[64];
    double *volume = (double *)dense_memory(NULL, b->piece_count, sizeof *volume);
    size_t *order, i, j, count;
    int psi[64], k;
    span s;
    for (i = 0; i < b->piece_count; i++) {
        element[i] = b->pieces[i].element;
        volume[i] = b->pieces[i].moments[0];
    }
    order = order_cells(element, volume, b->piece_count);
    s.rows = 4 * b->piece_count;
    s.columns = b->node_count + b->enrichment_count;
    s.a = (double *)dense_memory(NULL, s.rows * s.columns, sizeof(double));
    for (i = 0; i < b->piece_count; i++)
        for (k = 0; k < 4; k++) {
            double *row = s.a + (4 * i + (size_t)k) * s.columns;
            row[b->elements[4 * element[order[i]] + (uint32_t)k]] = 1;
            count = rx_piece_functions(b, &b->pieces[order[i]], k, functions, psi);
            for (j = 0; j < count; j++) row[b->node_count + functions[j]] = psi[j];
        }
    free(element);
    free(volume);
    free(order);
    return s;
}

static size_t rank_of(const span *s) {
    pinv p;
    size_t rank = 0, i;
    memset(&p, 0, sizeof p);
    pinv_factor(&p, s->a, s->rows, s->columns, 1e-8);
    for (i = 0; i < p.rank; i++) rank += p.scale[i] > 0;
    pinv_free(&p);
    return rank;
}

static span side_by_side(const span *s, const span *t) {
    span both;
    size_t i;
    both.rows = s->rows;
    both.columns = s->columns + t->columns;
    both.a = (double *)dense_memory(NULL, both.rows * both.columns, sizeof(double));
    for (i = 0; i < s->rows; i++) {
        memcpy(both.a + i * both.columns, s->a + i * s->columns, s->columns * sizeof(double));
        memcpy(both.a + i * both.columns + s->columns, t->a + i * t->columns, t->columns * sizeof(double));
    }
    return both;
}

/* Cuts by both, in sequence: the same number of unknowns, and the same space. Returns the number of enrichments. */
static size_t check_same_space(const workload *w) {
    gx_body *body = cut_in_sequence(w);
    rx_body *b = rx_body_of(w);
    const gx_view view = view_of(body);
    span copies, enrichments, both;
    size_t i, count;
    for (i = 0; i < w->surface_count; i++) ck_assert_int_eq(rx_cut_by(b, w, i), RX_OK);
    ck_assert_uint_eq(b->piece_count, view.cell_count);
    ck_assert_uint_eq(b->node_count + b->enrichment_count, view.copy_count);
    copies = span_of_copies(&view);
    enrichments = span_of_enrichments(b);
    both = side_by_side(&copies, &enrichments);
    ck_assert_uint_eq(rank_of(&copies), view.copy_count);
    ck_assert_uint_eq(rank_of(&enrichments), view.copy_count);
    ck_assert_uint_eq(rank_of(&both), view.copy_count);
    free(copies.a);
    free(enrichments.a);
    free(both.a);
    count = b->enrichment_count;
    rx_body_destroy(b);
    gx_body_destroy(body);
    return count;
}

START_TEST(same_space_as_copies) {
    uint64_t seed;
    for (seed = 1; seed <= SEEDS / 2; seed++) {
        workload w;
        double p[3], n[3];
        random_seed(seed);
        w = seed % 2 ? grid(2, 2, 1, 5) : grid(1, 2, 1, 6);
        random_point(&w, p);
        fill_random(n, 3);
        add_plane(&w, p, n, seed % 3 ? 9 : 0.8); /* through, or it ends inside */
        if (seed % 2) {                          /* a parallel one beside it */
            int k;
            for (k = 0; k < 3; k++) p[k] += 0.11 * n[k];
            add_plane(&w, p, n, 9);
        }
        check_same_space(&w);
        wl_free(&w);
    }
}
END_TEST

/* Bumpy sheets, through and ending inside, on jittered meshes: as many pieces and unknowns as in the exact topology */
START_TEST(complete_where_cells_are) {
    uint64_t seed;
    for (seed = 1; seed <= SEEDS / 4; seed++) {
        workload w = grid(2, 2, 2, seed % 2 ? 5 : 6);
        wl_frame f = wl_rotated();
        gx_body *body;
        rx_body *b;
        gx_view view;
        size_t i;
        random_seed(seed);
        for (i = 0; i < 3 * w.node_count; i++) w.positions[i] += random_real(-0.1, 0.1);
        for (i = 0; i < 3; i++) f.origin[i] = random_real(0.5, 1.5);
        wl_add_wave(wl_add_surface(&w, 0), &f, 9, seed % 3 ? 3 : random_real(0.3, 1));
        body = cut_in_sequence(&w);
        view = view_of(body);
        b = rx_body_of(&w);
        CHECK_SEED(rx_cut_by(b, &w, 0) == RX_OK, seed);
        CHECK_SEED(b->piece_count == view.cell_count, seed);
        CHECK_SEED(b->node_count + b->enrichment_count == view.copy_count, seed);
        rx_body_destroy(b);
        gx_body_destroy(body);
        wl_free(&w);
    }
}
END_TEST

/* A sheet bent into a narrow U passes through one-rings twice: each passage is a cut of its own (RXFEM Fig. 4). */
START_TEST(patches_of_one_surface) {
    workload w = grid(2, 2, 2, 5);
    wl_surface *s = wl_add_surface(&w, 0);
    /* x, z: up, over the body, down */
    static const double profile[4][2] = {{0.9, -5}, {0.93, 5}, {1.13, 5.2}, {1.17, -5}};
    size_t single;
    uint32_t i;
    for (i = 0; i < 4; i++) {
        double x[3];
        x[0] = profile[i][0];
        x[1] = -9;
        x[2] = profile[i][1];
        wl_add_vertex(s, x);
        x[1] = 9;
        wl_add_vertex(s, x);
    }
    for (i = 0; i < 6; i += 2) {
        wl_add_triangle(s, i, i + 1, i + 3);
        wl_add_triangle(s, i, i + 3, i + 2);
    }
    single = check_same_space(&w);
    /* the plane alone enriches at most the nodes of one layer on either side and those of the middle */
    ck_assert_uint_gt(single, 18);
    wl_free(&w);
}
END_TEST

/* ---- complete and partial ---- */

static size_t pieces_of_cut(const double *vertices, uint32_t triangle_count, const uint32_t *triangles,
                            uint32_t vertex_count, size_t *enriched) {
    rx_body *b = rx_body_create(rules, unit_corners, 4, unit_element, 1);
    rx_surface s;
    size_t count;
    s.vertices = vertices;
    s.vertex_count = vertex_count;
    s.triangles = triangles;
    s.triangle_count = triangle_count;
    ck_assert_int_eq(rx_body_cut(b, &s), RX_OK);
    count = b->piece_count;
    *enriched = b->enrichment_count;
    rx_body_destroy(b);
    return count;
}

START_TEST(complete_cuts) {
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    static const double through[9] = {3.1, -0.9, 0.31, -0.9, 3.1, 0.32, -0.9, -0.9, 0.33};
    static const double partial[9] = {1.1, -0.9, 0.31, -0.9, 1.1, 0.32, -0.9, -0.9, 0.33}; /* ends inside */
    static const double within[9] = {0.2, 0.2, 0.2, 0.3, 0.2, 0.21, 0.2, 0.3, 0.22};       /* meets no face */
    /* a tent through one face */
    static const double dent[12] = {0.25, 0.25, 0.1, 0.35, 0.2, -0.1, 0.25, 0.4, -0.1, 0.1, 0.2, -0.1};
    static const uint32_t tent[9] = {0, 1, 2, 0, 2, 3, 0, 3, 1};
    size_t enriched;
    ck_assert_uint_eq(pieces_of_cut(through, 1, triangles, 3, &enriched), 2);
    ck_assert_uint_eq(enriched, 4);
    ck_assert_uint_eq(pieces_of_cut(partial, 1, triangles, 3, &enriched), 1);
    ck_assert_uint_eq(enriched, 0);
    ck_assert_uint_eq(pieces_of_cut(within, 1, triangles, 3, &enriched), 1);
    ck_assert_uint_eq(enriched, 0);
    ck_assert_uint_eq(pieces_of_cut(dent, 3, tent, 4, &enriched), 2);
    ck_assert_uint_eq(enriched, 4);
}
END_TEST

/* The tent's inside is a pyramid that contains no corner: its volume by the rule against the exact one */
START_TEST(sides_without_an_edge) {
    static const double vertices[12] = {0.25, 0.25, 0.1, 0.35, 0.2, -0.1, 0.25, 0.4, -0.1, 0.1, 0.2, -0.1};
    static const uint32_t tent[9] = {0, 1, 2, 0, 2, 3, 0, 3, 1};
    rx_surface s;
    double error;
    s.vertices = vertices;
    s.vertex_count = 4;
    s.triangles = tent;
    s.triangle_count = 3;
    error = one_cut_error(rules, unit_corners, &s);
    ck_assert_msg(error < 0.01, "%.3e", error);
}
END_TEST

/* ---- refusals ---- */

/* Cuts by surface 0. Then surface 1 must be refused with this result, and nothing may change. */
static void check_refused(const workload *w, rx_result expected) {
    rx_body *b = rx_body_of(w);
    size_t pieces, enrichments, i;
    rx_result result;
    for (i = 0; i + 1 < w->surface_count; i++) ck_assert_int_eq(rx_cut_by(b, w, i), RX_OK);
    pieces = b->piece_count;
    enrichments = b->enrichment_count;
    result = rx_cut_by(b, w, i);
    ck_assert_int_eq(result, expected);
    ck_assert_uint_eq(b->piece_count, pieces);
    ck_assert_uint_eq(b->enrichment_count, enrichments);
    rx_body_destroy(b);
}

static void drop_surface(workload *w) {
    wl_surface *last = &w->surfaces[--w->surface_count];
    free(last->vertices);
    free(last->triangles);
    memset(last, 0, sizeof *last);
}

START_TEST(crossing_cuts_are_refused) {
    static const double p[3] = {0.5, 0.52, 0.47}, beside[3] = {0.5, 0.52, 0.9}, along[3] = {0.1, 0.05, 1},
                        across[3] = {1, 0.1, 0.07};
    /* Its lower edge lies just below the first surface. */
    static const double ends[9] = {0.51, -3, 0.4, 0.52, 3, 0.41, 0.53, 0.1, 4};
    workload w = grid(1, 1, 1, 5);
    wl_surface *s;
    uint32_t i;
    add_plane(&w, p, along, 9);
    add_plane(&w, p, across, 9);
    check_refused(&w, RX_ERROR_CROSSING); /* two planes that cross */
    drop_surface(&w);
    add_plane(&w, p, along, 9);
    check_refused(&w, RX_ERROR_CROSSING); /* the same plane again */
    drop_surface(&w);
    s = wl_add_surface(&w, 0);
    for (i = 0; i < 3; i++) wl_add_vertex(s, ends + 3 * i);
    wl_add_triangle(s, 0, 1, 2);
    check_refused(&w, RX_ERROR_CROSSING); /* a T */
    drop_surface(&w);
    add_plane(&w, beside, along, 9);
    ck_assert_uint_gt(check_same_space(&w), 0); /* but not a parallel one */
    wl_free(&w);
}
END_TEST

/* A surface that crosses itself; three triangles at an edge; two triangles with opposite orientations */
START_TEST(bad_surfaces_are_refused) {
    static const double x[5][3] = {{0.5, -9, 0.3}, {0.5, 9, 0.31}, {-9, 0, 0.32}, {9, 0, 0.33}, {0.4, 0, 9}};
    static const uint32_t three[9] = {0, 1, 2, 1, 0, 3, 0, 1, 4}, against[6] = {0, 1, 2, 0, 1, 3};
    const uint32_t *lists[2];
    int k;
    uint32_t i;
    lists[0] = three;
    lists[1] = against;
    for (k = 0; k < 2; k++) {
        workload w = grid(1, 1, 1, 5);
        wl_surface *s = wl_add_surface(&w, 0);
        for (i = 0; i < 5; i++) wl_add_vertex(s, x[i]);
        for (i = 0; i < (k == 0 ? 3u : 2u); i++)
            wl_add_triangle(s, lists[k][3 * i], lists[k][3 * i + 1], lists[k][3 * i + 2]);
        check_refused(&w, RX_ERROR_MANIFOLD);
        wl_free(&w);
    }
}
END_TEST

START_TEST(self_crossing_is_refused) {
    static const double p[3] = {0.5, 0.52, 0.47}, along[3] = {0.1, 0.05, 1}, across[3] = {1, 0.1, 0.07};
    workload w = grid(1, 1, 1, 5);
    wl_surface *s;
    uint32_t i;
    add_plane(&w, p, along, 9);
    add_plane(&w, p, across, 9);
    s = &w.surfaces[0];
    for (i = 0; i < 3; i++) wl_add_vertex(s, w.surfaces[1].vertices + 3 * i);
    wl_add_triangle(s, 3, 4, 5);
    drop_surface(&w);
    check_refused(&w, RX_ERROR_CROSSING);
    wl_free(&w);
}
END_TEST

/* ---- section 6 ---- */

/* Through nodes, along edges and facets: vertices are moved by a little, and the result is off by as little. */
START_TEST(perturbation) {
    workload w = grid(2, 2, 2, 5);
    rx_body *b;
    double low = 0;
    size_t i;
    add_axis_plane(&w, 0, 1);
    b = rx_body_of(&w);
    ck_assert_int_eq(rx_cut_by(b, &w, 0), RX_OK);
    ck_assert_uint_gt(b->perturbed, 0);
    ck_assert_uint_gt(b->enrichment_count, 0);
    for (i = 0; i < b->piece_count; i++) {
        const rx_piece *piece = &b->pieces[i];
        const double share = 6 * piece->moments[0];
        ck_assert_double_gt(share, -1e-6);
        ck_assert_double_lt(share, 1 + 1e-6);
        low += rx_element_volume(b, piece->element) * share;
    }
    ck_assert_double_eq_tol(low, 8, 1e-11);
    rx_body_destroy(b);
    wl_free(&w);
}
END_TEST

/* A corner with legs s: the corner's own function is zero on it, the other three are nonzero on it alone. */
START_TEST(shares_of_support) {
    static const uint32_t triangle[3] = {0, 1, 2};
    static const double legs[4] = {0.5, 0.1, 0.002, 0.0005};
    size_t i, k;
    for (k = 0; k < 4; k++) {
        const double s = legs[k];
        const double vertices[9] = {4 * s, -4 * s, s, s, 4 * s, -4 * s, -4 * s, s, 4 * s};
        rx_body *b = rx_body_create(rules, unit_corners, 4, unit_element, 1);
        rx_surface surface;
        double share[4];
        surface.vertices = vertices;
        surface.vertex_count = 3;
        surface.triangles = triangle;
        surface.triangle_count = 1;
        ck_assert_int_eq(rx_body_cut(b, &surface), RX_OK);
        ck_assert_uint_eq(b->enrichment_count, 4);
        rx_shares(b, share);
        for (i = 0; i < 4; i++) {
            const double expected = b->enrichments[i].node == 0 ? 1 - s * s * s : s * s * s;
            ck_assert_double_eq_tol(share[i], expected, 1e-13);
            ck_assert_int_eq(share[i] < RX_SUPPORT, b->enrichments[i].node != 0 && k == 3);
        }
        rx_body_destroy(b);
    }
}
END_TEST

/* On a sheet of 1e-10 of the cube's edge, only functions of its outer nodes have support. The others follow them, by
   weights that reproduce points in the sheet's plane. */
START_TEST(constrained_functions) {
    workload w = grid(1, 1, 1, 5);
    rx_body *b = rx_body_of(&w);
    rx_model *m;
    size_t i, k;
    static const double normal[3] = {1, 1e-12, 2e-12}, p[3] = {1 - 1e-10, 0.5, 0.5};
    add_plane(&w, p, normal, 9);
    ck_assert_int_eq(rx_cut_by(b, &w, 0), RX_OK);
    m = rx_model_create(b, 1000);
    ck_assert_uint_gt(m->model.constraint_count, 0);
    for (i = 0; i < m->model.constraint_count; i++) {
        const gxs_constraint *c = &m->model.constraints[i];
        const double *x = m->positions + 3 * (size_t)c->copy;
        double sum = 0, y = 0, z = 0;
        ck_assert_double_lt(x[0], 0.5); /* a node of the far side, in the sheet */
        for (k = 0; k < 4; k++) {
            const double *master = m->positions + 3 * (size_t)c->master[k];
            sum += c->weight[k];
            y += c->weight[k] * master[1];
            z += c->weight[k] * master[2];
            ck_assert(!(fabs(c->weight[k]) > 0) || master[0] > 0.5);
        }
        ck_assert_double_eq_tol(sum, 1, 1e-12);
        ck_assert_msg(fabs(y - x[1]) < 1e-9 && fabs(z - x[2]) < 1e-9, "%g %g follows %g %g", x[1], x[2], y, z);
    }
    rx_model_destroy(m);
    rx_body_destroy(b);
    wl_free(&w);
}
END_TEST

/* ---- rxfem_model.h ---- */

typedef struct swing {
    gx_body *body;
    rx_body *b;
    rx_model *m;
    gxs_solver *solver;
    double *displacement, *velocity;
    uint8_t *held;
} swing;

/* Both are held where x is near 0, on each side of the cuts, and have the same material. */
static swing swing_begin(const workload *w, gxs_material *material) {
    const gx_region root = gx_region_half_space(0, -1, 1e-6);
    swing s;
    size_t i;
    memset(&s, 0, sizeof s);
    memset(material, 0, sizeof *material);
    material->kind = GXS_STABLE_NEO_HOOKEAN;
    material->young = 1e6;
    material->poisson = 0.4;
    s.body = cut_in_sequence(w);
    s.b = rx_body_of(w);
    for (i = 0; i < w->surface_count; i++) ck_assert_int_eq(rx_cut_by(s.b, w, i), RX_OK);
    s.m = rx_model_create(s.b, 1000);
    ck_assert_int_eq(gx_body_hold(s.body, &root, 1, NULL), GX_OK);
    s.displacement = (double *)dense_memory(NULL, 3 * s.m->value_count, sizeof(double));
    s.velocity = (double *)dense_memory(NULL, 3 * s.m->value_count, sizeof(double));
    s.held = (uint8_t *)dense_memory(NULL, s.m->value_count, 1);
    for (i = 0; i < s.m->value_count; i++) s.held[i] = s.m->positions[3 * i] < 1e-6;
    s.m->model.materials = material;
    s.m->model.material_count = 1;
    s.m->model.held = s.held;
    ck_assert_int_eq(gxs_solver_create(NULL, &s.solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(s.solver, &s.m->model, NULL), GX_OK);
    return s;
}

static void swing_end(swing *s) {
    gxs_solver_destroy(s->solver);
    rx_model_destroy(s->m);
    rx_body_destroy(s->b);
    gx_body_destroy(s->body);
    free(s->displacement);
    free(s->velocity);
    free(s->held);
}

/* The largest difference between the displacements of corners of the same cells */
static double swing_difference(const swing *s, double *largest) {
    const gx_view view = view_of(s->body);
    uint32_t *element = (uint32_t *)dense_memory(NULL, s->b->piece_count, sizeof *element);
    double *volume = (double *)dense_memory(NULL, s->b->piece_count, sizeof *volume), worst = 0;
    size_t *cells, *pieces, i, k, a;
    for (i = 0; i < s->b->piece_count; i++) {
        element[i] = s->b->pieces[i].element;
        volume[i] = s->b->pieces[i].moments[0];
    }
    cells = order_cells(view.cell_element, view.cell_volume, view.cell_count);
    pieces = order_cells(element, volume, s->b->piece_count);
    ck_assert_uint_eq(view.cell_count, s->b->piece_count);
    for (*largest = 0, i = 0; i < view.cell_count; i++)
        for (k = 0; k < 4; k++)
            for (a = 0; a < 3; a++) {
                const double x = view.displacement[3 * view.cell_copies[4 * cells[i] + k] + a];
                const double y = s->displacement[3 * s->m->corners[4 * pieces[i] + k] + a];
                worst = fmax(worst, fabs(x - y));
                *largest = fmax(*largest, fabs(x));
            }
    free(element);
    free(volume);
    free(cells);
    free(pieces);
    return worst;
}

/* On planes RXFEM's integrals are exact and its space is the library's: the same motion */
START_TEST(same_motion_on_planes) {
    static const double p[3] = {0.9, 0.52, 0.47}, normal[3] = {0.1, 0.05, 1}, beside[3] = {0.9, 0.52, 0.71};
    workload w = grid(2, 1, 1, 5);
    gxs_material material;
    gx_step_desc step;
    gxs_step_desc own;
    swing s;
    double largest, worst;
    int i;
    add_plane(&w, p, normal, 9);
    add_plane(&w, beside, normal, 9);
    s = swing_begin(&w, &material);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -9.81;
    step.newton_iterations = 50;
    step.newton_tolerance = 1e-9;
    step.cg_tolerance = 1e-6;
    own = solver_step(&step);
    for (i = 0; i < 5; i++) {
        ck_assert_int_eq(gxs_solver_step(s.solver, &own, s.displacement, s.velocity, NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_body_step(s.body, &step, NULL, NULL), GX_OK);
    }
    worst = swing_difference(&s, &largest);
    ck_assert_double_gt(largest, 1e-3);
    ck_assert_msg(worst < 1e-6 * largest, "%.2e of %.2e", worst, largest);
    swing_end(&s);
    wl_free(&w);
}
END_TEST

/* RXFEM's derivatives at the rule's points equal those once for each piece; energy and forces equal those of the
   library's model. */
START_TEST(elastic_derivatives) {
    static const double p[3] = {0.9, 0.52, 0.47}, normal[3] = {0.1, 0.05, 1};
    workload w = grid(2, 1, 1, 5);
    gxs_material material;
    swing s;
    size_t n, i;
    double *unknowns, *forces[2], *stiffness[2], *gradient, *spread, energy[2], whole, scale = 0;
    add_plane(&w, p, normal, 9);
    s = swing_begin(&w, &material);
    material.kind = GXS_ST_VENANT_KIRCHHOFF;
    n = 3 * (s.b->node_count + s.b->enrichment_count);
    ck_assert_uint_eq(n, 3 * s.m->value_count);
    unknowns = (double *)dense_memory(NULL, n, sizeof(double));
    gradient = (double *)dense_memory(NULL, n, sizeof(double));
    spread = (double *)dense_memory(NULL, n, sizeof(double));
    random_seed(7);
    for (i = 0; i < n; i++) unknowns[i] = random_real(-0.1, 0.1);
    for (i = 0; i < 2; i++) {
        forces[i] = (double *)dense_memory(NULL, n, sizeof(double));
        stiffness[i] = (double *)dense_memory(NULL, 144 * s.b->piece_count, sizeof(double));
        energy[i] = rx_elastic(s.b, s.m, 1e6, 0.4, unknowns, i == 0, forces[i], stiffness[i]);
    }
    rx_values_of(s.b, s.m, unknowns, s.displacement);
    whole = form_energy(&s.m->model, s.displacement);
    form_gradient(&s.m->model, s.displacement, gradient);
    for (i = 0; i < s.m->value_count; i++) rx_spread(s.b, s.m, (uint32_t)i, gradient + 3 * i, spread);
    for (i = 0; i < n; i++) scale = fmax(scale, fabs(spread[i]));
    for (i = 0; i < 2; i++) ck_assert_double_eq_tol(energy[i], whole, 1e-10 * whole);
    for (i = 0; i < n; i++) {
        ck_assert_double_eq_tol(forces[0][i], spread[i], 1e-9 * scale);
        ck_assert_double_eq_tol(forces[1][i], spread[i], 1e-9 * scale);
    }
    for (scale = 0, i = 0; i < 144 * s.b->piece_count; i++) scale = fmax(scale, fabs(stiffness[1][i]));
    for (i = 0; i < 144 * s.b->piece_count; i++)
        ck_assert_double_eq_tol(stiffness[0][i], stiffness[1][i], 1e-9 * scale);
    free(unknowns);
    free(gradient);
    free(spread);
    for (i = 0; i < 2; i++) {
        free(forces[i]);
        free(stiffness[i]);
    }
    swing_end(&s);
    wl_free(&w);
}
END_TEST

/* Tangents against differences of forces */
START_TEST(elastic_tangent) {
    static const double lame[2] = {3, 2};
    gxs_element e;
    double corners[12], gradients[12], force[2][12], stiffness[144], dropped[144] = {0}, values[12], f[9];
    const double step = 1e-5;
    size_t j, k, side;
    random_seed(3);
    random_tetrahedron(corners);
    memset(&e, 0, sizeof e);
    for (k = 0; k < 4; k++) e.copy[k] = (uint32_t)k;
    ck_assert_int_eq(gxi_tet_gradients(corners, gradients, NULL), GX_OK);
    memcpy(e.gradient, gradients, sizeof gradients);
    for (k = 0; k < 12; k++) values[k] = random_real(-0.3, 0.3);
    memset(stiffness, 0, sizeof stiffness);
    memset(force, 0, sizeof force);
    rx_deformation(&e, values, f);
    rx_add_point(lame, &e, f, 0.7, force[0], stiffness);
    for (j = 0; j < 12; j++) {
        memset(force, 0, sizeof force);
        for (side = 0; side < 2; side++) {
            values[j] += side ? step : -step;
            rx_deformation(&e, values, f);
            rx_add_point(lame, &e, f, 0.7, force[side], dropped);
            values[j] -= side ? step : -step;
        }
        for (k = 0; k < 12; k++) {
            const double difference = (force[1][k] - force[0][k]) / (2 * step);
            ck_assert_msg(fabs(stiffness[12 * j + k] - difference) < 1e-6, "%g, %g", stiffness[12 * j + k], difference);
        }
    }
}
END_TEST

/* ---- sampling.h ---- */

/* The numbers of points of RXFEM's Table 1 for these regions. The plane's agree exactly. The adaptive ones depend on
   how a cell is found to be crossed. */
START_TEST(published_samples) {
    static const double plane[9] = {1.2, -1.2, 0.3, 0.3, 1.2, -1.2, -1.2, 0.3, 1.2};
    static const uint32_t triangle[3] = {0, 1, 2};
    sampling_surface s = sampling_surface_create(plane, triangle, 1);
    const sampling_region under = sampling_under(&s);
    sampling_rule r;
    memset(&r, 0, sizeof r);
    sampling_regular(&under, 50, &r);
    ck_assert_uint_eq(r.count, 560);
    ck_assert_double_eq_tol(560 / 125000.0 / (0.027 / 6), 1 - 4.44e-3, 1e-5);
    sampling_adaptive(&under, 1, 4, &r);
    ck_assert_uint_ge(r.count, 45);
    ck_assert_uint_le(r.count, 60);
    sampling_adaptive(&under, 2, 4, &r);
    ck_assert_uint_ge(r.count, 160);
    ck_assert_uint_le(r.count, 200);
    sampling_free(&r);
    sampling_surface_free(&s);
}
END_TEST

/* Parity of crossings against the side of a plane. Every sample of a bumpy sheet is once above and once below the
   sheet's turned-over copy. */
START_TEST(inside_by_parity) {
    uint64_t seed;
    for (seed = 1; seed <= SEEDS; seed++) {
        workload w = corner_tet();
        sampling_surface s;
        double p[3], n[3], x[3];
        int i, k;
        random_seed(seed);
        random_point(&w, p);
        fill_random(n, 3);
        if (fabs(n[2]) < 0.3) n[2] = 1;
        add_plane(&w, p, n, 20);
        s = sampling_surface_create(w.surfaces[0].vertices, w.surfaces[0].triangles, 1);
        for (i = 0; i < 200; i++) {
            double height = 0;
            for (k = 0; k < 3; k++) x[k] = random_real(0, 1);
            for (k = 0; k < 3; k++) height += n[k] * (p[k] - x[k]) / n[2];
            if (fabs(height) > 1e-12) CHECK_SEED(sampling_inside(&s, x) == (height > 0), seed);
        }
        sampling_surface_free(&s);
        wl_free(&w);
    }
}
END_TEST

/* An element without a surface above or below it is integrated as a whole. Errors fall with depth and with the
   number of cells. */
START_TEST(sampling_converges) {
    static const double high[9] = {-9, -9, 3, 9, -9, 3, 0, 9, 3},
                        plane[9] = {1.2, -1.2, 0.3, 0.3, 1.2, -1.2, -1.2, 0.3, 1.2};
    static const uint32_t triangle[3] = {0, 1, 2};
    sampling_surface whole = sampling_surface_create(high, triangle, 1),
                     s = sampling_surface_create(plane, triangle, 1);
    const sampling_region under_high = sampling_under(&whole), under = sampling_under(&s);
    sampling_rule r;
    double square = 0, volume[2] = {0, 0};
    size_t i;
    memset(&r, 0, sizeof r);
    sampling_adaptive(&under_high, 2, 4, &r);
    ck_assert_uint_eq(r.count, 4);
    for (i = 0; i < r.count; i++) square += r.points[4 * i + 3] * r.points[4 * i] * r.points[4 * i];
    ck_assert_double_eq_tol(square, 1.0 / 60, 1e-16);
    sampling_adaptive(&under, 2, 5, &r);
    for (i = 0; i < r.count; i++) volume[0] += r.points[4 * i + 3];
    sampling_regular(&under, 100, &r);
    for (i = 0; i < r.count; i++) volume[1] += r.points[4 * i + 3];
    ck_assert_double_eq_tol(volume[0], 0.0045, 0.0045 * 0.02);
    ck_assert_double_eq_tol(volume[1], 0.0045, 0.0045 * 0.002);
    sampling_free(&r);
    sampling_surface_free(&whole);
    sampling_surface_free(&s);
}
END_TEST

/* Moments of the boundary, to any degree, by the library */
static void boundary_moments(part *p, unsigned degree, double *moments) {
    part_shape boundary = part_boundary(p);
    uint32_t *index = (uint32_t *)dense_memory(NULL, 3 * boundary.count, sizeof(uint32_t)), i;
    double work[SAMPLING_MONOMIALS];
    gxi_surface surface;
    for (i = 0; i < 3 * boundary.count; i++) index[i] = i;
    surface.positions = boundary.corners;
    surface.position_count = 3 * boundary.count;
    surface.triangles = index;
    surface.triangle_count = boundary.count;
    ck_assert_int_eq(gxi_polyhedron_monomials(&surface, NULL, degree, moments, work, NULL), GX_OK);
    free(index);
    free(boundary.corners);
}

/* Positive weights, no more points than monomials, all in the part, moments to rounding */
static void check_positive(part *p, const sampling_surface *s, int odd, unsigned degree, uint64_t seed) {
    double moments[SAMPLING_MONOMIALS], values[SAMPLING_MONOMIALS], sums[SAMPLING_MONOMIALS] = {0};
    part_shape inside = part_tetrahedra(p);
    const size_t m = gxi_monomial_count(degree);
    sampling_rule r;
    size_t i;
    memset(&r, 0, sizeof r);
    boundary_moments(p, degree, moments);
    sampling_positive(inside.corners, inside.count, degree, moments, &r);
    CHECK_SEED(r.count > 0 && r.count <= m, seed);
    for (i = 0; i < r.count; i++) {
        const double *x = r.points + 4 * i;
        CHECK_SEED(x[0] > 0 && x[1] > 0 && x[2] > 0 && x[0] + x[1] + x[2] < 1 && x[3] > 0, seed);
        CHECK_SEED(sampling_inside(s, x) == odd, seed);
        sampling_monomials(degree, x, values);
        dense_add(sums, x[3], values, m);
    }
    for (i = 0; i < m; i++)
        ck_assert_msg(fabs(sums[i] - moments[i]) < 1e-14, "seed %d, degree %u, %d: %.2e", (int)seed, degree, (int)i,
                      sums[i] - moments[i]);
    sampling_free(&r);
    free(inside.corners);
}

START_TEST(positive_rules) {
    uint64_t seed;
    for (seed = 1; seed <= SEEDS; seed++) {
        workload w = corner_tet();
        wl_frame f = wl_axes();
        sampling_surface s;
        const wl_surface *cut;
        part p;
        unsigned degree;
        int k, odd;
        random_seed(seed);
        for (k = 0; k < 3; k++) f.origin[k] = random_real(0.1, 0.4);
        wl_add_wave(wl_add_surface(&w, 0), &f, 1 + (uint32_t)random_below(6), 2.3);
        cut = &w.surfaces[0];
        s = sampling_surface_create(cut->vertices, cut->triangles, cut->triangle_count);
        p = part_create(w.positions, cut->vertices, cut->triangles, cut->triangle_count, 0);
        odd = sampling_inside(&s, unit_corners);
        for (degree = 1; degree <= SAMPLING_DEGREE_MAX; degree++) check_positive(&p, &s, odd, degree, seed);
        part_free(&p);
        sampling_surface_free(&s);
        wl_free(&w);
    }
}
END_TEST

/* ---- parts.h ---- */

static const double part_points[3][3] = {{0.9, 0.52, 0.47}, {0.9, 0.52, 0.71}, {0.83, 0.61, 0.5}};
static const double part_normals[3][3] = {{0.1, 0.05, 1}, {0.1, 0.05, 1}, {1, 0.2, 0.3}};

/* A block cut by this many planes: two beside each other, a third across both */
static workload cut_block(size_t planes) {
    workload w = grid(2, 1, 1, 5);
    size_t i;
    for (i = 0; i < planes; i++) add_plane(&w, part_points[i], part_normals[i], 9);
    return w;
}

/* Largest difference of volumes and masses from the library's, relative to those of the largest element */
static double worst_integral(const parts_body *p, const gxs_element *elements) {
    double worst = 0, volume = 0, mass = 0;
    size_t i, k;
    for (i = 0; i < p->model.element_count; i++) {
        volume = fmax(volume, p->model.elements[i].weight);
        mass = fmax(mass, p->model.elements[i].mass[0]);
    }
    for (i = 0; i < p->model.element_count; i++) {
        const gxs_element *e = &p->model.elements[i];
        worst = fmax(worst, fabs(elements[i].weight - e->weight) / volume);
        for (k = 0; k < 10; k++) worst = fmax(worst, fabs(elements[i].mass[k] - e->mass[k]) / mass);
        ck_assert(memcmp(elements[i].copy, e->copy, sizeof e->copy) == 0);
    }
    return worst;
}

/* By crossing planes. Parts are convex, so each contains its centre, and no two parts of an element contain points
   with the same sides. */
START_TEST(points_of_parts) {
    workload w = cut_block(3);
    gx_body *body = cut_in_sequence(&w);
    parts_body p = parts_create(body);
    size_t i, k;
    int n;
    random_seed(5);
    for (i = 0; i < p.model.element_count; i++) {
        double x[3];
        ck_assert(parts_center(&p, &p.model.elements[i], p.model.elements[i].group, x));
        ck_assert_uint_eq(parts_find(&p, p.model.elements[i].group, x), i);
    }
    for (n = 0; n < 2000; n++) {
        const uint32_t e = (uint32_t)random_below((int)w.element_count);
        double x[2][3], at[3];
        unsigned side[2] = {0, 0};
        uint32_t part[2];
        int q;
        for (q = 0; q < 2; q++) {
            for (k = 0; k < 3; k++) at[k] = random_real(0, 1.0 / 3);
            parts_material_point(&p, e, at, x[q]);
            part[q] = parts_find(&p, e, x[q]);
            ck_assert_uint_ge(part[q], p.first[e]);
            ck_assert_uint_lt(part[q], p.first[e + 1]);
            for (k = 0; k < 3; k++)
                side[q] |=
                    (unsigned)(dense_dot(part_normals[k], x[q], 3) > dense_dot(part_normals[k], part_points[k], 3))
                    << k;
        }
        if (side[0] == side[1]) ck_assert_uint_eq(part[0], part[1]);
        if (p.first[e + 1] - p.first[e] == 8 && side[0] != side[1]) ck_assert_uint_ne(part[0], part[1]);
    }
    parts_free(&p);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Rules with positive weights reproduce the moments that they are made of. Others converge with more points. Uncut
   elements do not change. */
START_TEST(rules_in_parts) {
    static const struct {
        parts_rule_fn make;
        int knob;
        double within;
    } rules_of[5] = {{parts_positive, 2, 1e-13},
                     {parts_regular, 10, 0.1},
                     {parts_regular, 40, 0.01},
                     {parts_adaptive, 3, 0.05},
                     {parts_adaptive, 5, 0.01}};
    workload w = cut_block(3);
    gx_body *body = cut_in_sequence(&w);
    parts_body p = parts_create(body);
    gxs_element *elements = (gxs_element *)dense_memory(NULL, p.model.element_count, sizeof *elements);
    size_t *counts = (size_t *)dense_memory(NULL, p.model.element_count, sizeof *counts), i;
    int k;
    for (k = 0; k < 5; k++) {
        double worst;
        parts_integrate(&p, rules_of[k].make, rules_of[k].knob, 1000, elements, counts);
        worst = worst_integral(&p, elements);
        ck_assert_msg(worst < rules_of[k].within && (k == 0 || worst > 1e-9), "rule %d: %.2e", k, worst);
        for (i = 0; i < p.model.element_count; i++) {
            const uint32_t e = elements[i].group;
            if (p.first[e + 1] - p.first[e] == 1)
                ck_assert_uint_eq(counts[i], 1);
            else if (k == 0)
                ck_assert(counts[i] > 0 && counts[i] <= 10);
        }
    }
    free(elements);
    free(counts);
    parts_free(&p);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* On planes that do not cross RXFEM's moments are the library's, part by part. */
START_TEST(rxfem_in_parts) {
    workload w = cut_block(2);
    gx_body *body = cut_in_sequence(&w);
    rx_body *b = rx_body_of(&w);
    parts_body p = parts_create(body);
    gxs_element *elements = (gxs_element *)dense_memory(NULL, p.model.element_count, sizeof *elements);
    size_t *counts = (size_t *)dense_memory(NULL, p.model.element_count, sizeof *counts), i, cut = 0;
    double worst;
    for (i = 0; i < 2; i++) ck_assert_int_eq(rx_cut_by(b, &w, i), RX_OK);
    parts_rxfem(&p, b, 1000, elements, counts);
    worst = worst_integral(&p, elements);
    ck_assert_msg(worst < 1e-8, "%.2e", worst);
    for (i = 0; i < p.model.element_count; i++) cut += counts[i] == 24;
    ck_assert_uint_gt(cut, 10);
    free(elements);
    free(counts);
    parts_free(&p);
    rx_body_destroy(b);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Deletion removes exactly the elements that a plane passes through: elements with nodes on both sides; of a plane
   that ends inside, also those that it does not divide; of a plane in faces, none. */
START_TEST(deleted_elements) {
    static const double level[3] = {0.52, 0.5, 0.4};
    int k;
    for (k = 0; k < 3; k++) {
        workload w = grid(2, 2, 2, 5);
        gx_body *body, *uncut = body_of(&w);
        gxs_model model;
        gxs_element *left;
        parts_body p;
        size_t i, count, expected = 0;
        if (k == 1)
            add_axis_plane(&w, 2, 1);
        else {
            const double x[4][3] = {{-1, -1, level[k]},
                                    {k == 0 ? 3 : 1.3, -1, level[k]},
                                    {k == 0 ? 3 : 1.3, 3, level[k]},
                                    {-1, 3, level[k]}};
            wl_add_quad(wl_add_surface(&w, 0), x[0], x[1], x[2], x[3]);
        }
        body = cut_in_sequence(&w);
        p = parts_create(body);
        ck_assert_int_eq(gx_body_model(uncut, &model, NULL), GX_OK);
        left = (gxs_element *)dense_memory(NULL, model.element_count, sizeof *left);
        count = parts_delete(&p, &model, left);
        for (i = 0; i < w.element_count; i++) {
            int below = 0, above = 0, n;
            for (n = 0; n < 4; n++) {
                const double z = w.positions[3 * w.elements[4 * i + n] + 2];
                below |= z < level[k];
                above |= z > level[k];
            }
            expected += k == 1 || !(below && above);
            if (!(below && above)) ck_assert(!parts_is_met(p.body, (uint32_t)i));
        }
        if (k < 2)
            ck_assert_uint_eq(count, expected);
        else {
            size_t divided = 0;
            for (i = 0; i < w.element_count; i++) divided += p.first[i + 1] - p.first[i] > 1;
            ck_assert_uint_gt(count, expected);
            ck_assert_uint_lt(count, w.element_count - divided);
        }
        free(left);
        parts_free(&p);
        gx_body_destroy(body);
        gx_body_destroy(uncut);
        wl_free(&w);
    }
}
END_TEST

/* ---- local.h ---- */

static const double swing_gravity[3] = {2, 1, -9.81};

/* A cut bar, held where x is near 0: the model that the library's steps and the local methods move */
static gx_body *hanging_bar(gxs_model *model) {
    static const double p[3] = {0.9, 0.52, 0.47}, normal[3] = {0.1, 0.05, 1}, beside[3] = {0.9, 0.52, 0.71};
    const gx_region root = gx_region_half_space(0, -1, 1e-6);
    workload w = grid(3, 2, 1, 5);
    gx_body *body;
    add_plane(&w, p, normal, 9);
    add_plane(&w, beside, normal, 9);
    body = cut_in_sequence(&w);
    ck_assert_int_eq(gx_body_hold(body, &root, 1, NULL), GX_OK);
    ck_assert_int_eq(gx_body_model(body, model, NULL), GX_OK);
    model->lumped_mass = 1;
    wl_free(&w);
    return body;
}

/* Converged steps of the library with a material; u: copy_count x 3, from rest */
static void converged(const gxs_model *given, const gxs_material *material, gxs_integrator integrator, double dt,
                      size_t steps, double *u) {
    gxs_material *materials = (gxs_material *)dense_memory(NULL, given->material_count, sizeof *materials);
    double *v = (double *)dense_memory(NULL, 3 * given->copy_count, sizeof(double));
    gxs_model model = *given;
    gxs_solver *solver;
    gxs_step_desc step;
    size_t i;
    for (i = 0; i < model.material_count; i++) materials[i] = material ? *material : given->materials[i];
    model.materials = materials;
    memset(&step, 0, sizeof step);
    memset(u, 0, 3 * model.copy_count * sizeof *u);
    memset(v, 0, 3 * model.copy_count * sizeof *v);
    step.dt = dt;
    memcpy(step.gravity, swing_gravity, sizeof step.gravity);
    step.integrator = integrator;
    step.newton_iterations = 50;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-6;
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
    for (i = 0; i < steps; i++) ck_assert_int_eq(gxs_solver_step(solver, &step, u, v, NULL, NULL), GX_OK);
    gxs_solver_destroy(solver);
    free(materials);
    free(v);
}

/* The largest difference of any copy as a share of the largest displacement */
static double local_difference(const local_body *b, const double *u) {
    double worst = 0, largest = 0;
    size_t i, k;
    for (i = 0; i < b->count; i++)
        for (k = 0; k < 3; k++) {
            worst = fmax(worst, fabs((double)b->u[4 * i + k] - u[3 * i + k]));
            largest = fmax(largest, fabs(u[3 * i + k]));
        }
    ck_assert_double_gt(largest, 1e-3);
    return worst / largest;
}

/* Young's modulus and Poisson's ratio of the bar, with XPBD's energy */
static gxs_material xpbd_material(const gxs_model *model) {
    gxs_material m = model->materials[0];
    m.kind = GXS_CUSTOM;
    m.energy = local_xpbd_energy;
    m.user = (void *)(uintptr_t)&model->materials[0];
    return m;
}

/* XPBD's energy: derivatives against differences; near rest it is the library's material. */
START_TEST(local_energies) {
    gxs_material m;
    uint64_t seed;
    memset(&m, 0, sizeof m);
    m.young = 1;
    m.poisson = 0.4;
    for (seed = 1; seed <= SEEDS; seed++) {
        double f[9], stress[9], hessian[81], above[9], below[9], up, down, energy;
        const double h = 1e-5;
        int p, q;
        random_seed(seed);
        fill_random(f, 9);
        local_xpbd_energy(&m, f, stress, hessian);
        for (p = 0; p < 9; p++) {
            const double kept = f[p];
            f[p] = kept + h, up = local_xpbd_energy(&m, f, above, NULL);
            f[p] = kept - h, down = local_xpbd_energy(&m, f, below, NULL);
            f[p] = kept;
            CHECK_SEED(fabs((up - down) / (2 * h) - stress[p]) < 1e-8, seed);
            for (q = 0; q < 9; q++) CHECK_SEED(fabs((above[q] - below[q]) / (2 * h) - hessian[9 * p + q]) < 1e-8, seed);
        }
        for (p = 0; p < 9; p++) f[p] = (p % 4 == 0) + 1e-4 * f[p];
        energy = gxs_material_energy(&m, f);
        CHECK_SEED(fabs(local_xpbd_energy(&m, f, NULL, NULL) - energy) < 1e-3 * energy, seed);
    }
}
END_TEST

/* No two elements of a block share a copy that moves; no two copies of a group share an element. */
START_TEST(local_colors) {
    gxs_model model;
    gx_body *body = hanging_bar(&model);
    local_xpbd x;
    local_vbd v;
    size_t *seen = (size_t *)dense_memory(NULL, model.copy_count, sizeof *seen), i, k, moved = 0, swept = 0;
    local_xpbd_make(&x, &model);
    local_vbd_make(&v, &model);
    memset(seen, 0, model.copy_count * sizeof *seen);
    for (i = 0; i < x.blocks; i++)
        for (k = 0; k < 4 * LOCAL_LANES; k++) {
            const size_t copy = (size_t)x.at[4 * LOCAL_LANES * i + k] / 4;
            if (copy == model.copy_count || x.body.fixed[copy]) continue;
            ck_assert_uint_ne(seen[copy], i + 1);
            seen[copy] = i + 1;
            moved++;
        }
    for (i = 0; i < model.element_count; i++)
        for (k = 0; k < 4; k++) moved -= !x.body.fixed[model.elements[i].copy[k]];
    ck_assert_uint_eq(moved, 0);
    memset(seen, 0, model.copy_count * sizeof *seen);
    for (i = 0; i < v.groups; i++)
        for (k = 0; k < v.group[i].count; k++) seen[v.group[i].at[k] / 4] = i + 1;
    for (i = 0; i < model.copy_count; i++) swept += seen[i] > 0, swept -= !v.body.fixed[i];
    ck_assert_uint_eq(swept, 0);
    for (i = 0; i < model.element_count; i++)
        for (k = 0; k < 16; k++) {
            const uint32_t a = model.elements[i].copy[k / 4], b = model.elements[i].copy[k % 4];
            if (a != b && seen[a] > 0) ck_assert_uint_ne(seen[a], seen[b]);
        }
    local_xpbd_free(&x);
    local_vbd_free(&v);
    free(seen);
    gx_body_destroy(body);
}
END_TEST

/* The difference of five steps of VBD from the library's backward Euler, as converged() made it */
static double vbd_difference(const gxs_model *model, double dt, int iterations, double rho, int symmetric,
                             const double *u) {
    local_vbd_desc desc;
    local_vbd v;
    double worst;
    int k;
    memset(&desc, 0, sizeof desc);
    desc.dt = dt;
    memcpy(desc.gravity, swing_gravity, sizeof desc.gravity);
    desc.iterations = iterations;
    desc.rho = rho;
    desc.symmetric = symmetric;
    local_vbd_make(&v, model);
    for (k = 0; k < 5; k++) local_vbd_step(&v, &desc);
    worst = local_difference(&v.body, u);
    local_vbd_free(&v);
    return worst;
}

/* VBD to the end is the library's backward Euler to the end, with and without Chebyshev's method. Where sweeps converge
   slowly, that is nearer after as many sweeps forward and back. */
START_TEST(vbd_converges) {
    gxs_model model;
    gx_body *body = hanging_bar(&model);
    double *u = (double *)dense_memory(NULL, 3 * model.copy_count, sizeof(double)), plain, fast;
    converged(&model, NULL, GXS_BDF1, 0.01, 5, u);
    ck_assert_double_lt(vbd_difference(&model, 0.01, 400, 0, 0, u), 1e-5);
    ck_assert_double_lt(vbd_difference(&model, 0.01, 400, 0, 1, u), 1e-5);
    ck_assert_double_lt(vbd_difference(&model, 0.01, 400, 0.7, 0, u), 1e-5);
    ck_assert_double_lt(vbd_difference(&model, 0.01, 400, 0.7, 1, u), 1e-5);
    converged(&model, NULL, GXS_BDF1, 0.05, 5, u);
    plain = vbd_difference(&model, 0.05, 100, 0, 1, u);
    fast = vbd_difference(&model, 0.05, 100, 0.98, 1, u);
    ck_assert_msg(fast < plain / 3 && plain > 1e-4, "%.2e, by Chebyshev %.2e", plain, fast);
    free(u);
    gx_body_destroy(body);
}
END_TEST

/* XPBD's motion goes to that of its energy in proportion to its substeps. */
START_TEST(xpbd_converges) {
    gxs_model model;
    gx_body *body = hanging_bar(&model);
    const gxs_material material = xpbd_material(&model);
    double *u = (double *)dense_memory(NULL, 3 * model.copy_count, sizeof(double)), error[3];
    int i;
    converged(&model, &material, GXS_MIDPOINT, 0.05 / 400, 400, u);
    for (i = 0; i < 3; i++) {
        local_xpbd x;
        local_xpbd_make(&x, &model);
        local_xpbd_step(&x, 0.05, swing_gravity, 0, 25 << 2 * i);
        error[i] = local_difference(&x.body, u);
        local_xpbd_free(&x);
    }
    ck_assert_msg(error[1] < error[0] / 3 && error[2] < error[1] / 3 && error[2] < 5e-3, "%.2e %.2e %.2e", error[0],
                  error[1], error[2]);
    free(u);
    gx_body_destroy(body);
}
END_TEST

/* With damping of the mass both come to rest in the balance of their energy. */
START_TEST(local_balance) {
    gxs_model model;
    gx_body *body = hanging_bar(&model);
    const gxs_material material = xpbd_material(&model);
    double *u = (double *)dense_memory(NULL, 3 * model.copy_count, sizeof(double)), worst;
    local_vbd_desc desc;
    local_xpbd x;
    local_vbd v;
    int i;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.02;
    memcpy(desc.gravity, swing_gravity, sizeof desc.gravity);
    desc.damping = 4;
    desc.iterations = 50;
    local_xpbd_make(&x, &model);
    local_vbd_make(&v, &model);
    for (i = 0; i < 400; i++) {
        local_xpbd_step(&x, desc.dt, desc.gravity, desc.damping, 20);
        local_vbd_step(&v, &desc);
    }
    converged(&model, &material, GXS_STATIC, 0, 1, u);
    worst = local_difference(&x.body, u);
    ck_assert_msg(worst < 3e-3, "XPBD: %.2e", worst); /* single precision: more substeps are worse */
    converged(&model, NULL, GXS_STATIC, 0, 1, u);
    worst = local_difference(&v.body, u);
    ck_assert_msg(worst < 1e-3, "VBD: %.2e", worst);
    local_xpbd_free(&x);
    local_vbd_free(&v);
    free(u);
    gx_body_destroy(body);
}
END_TEST

static TCase *add_case(Suite *suite, const char *name) {
    TCase *list = tcase_create(name);
    tcase_add_checked_fixture(list, make_rules, free_rules);
    tcase_set_timeout(list, 60);
    suite_add_tcase(suite, list);
    return list;
}

int main(void) {
    Suite *suite = suite_create("baselines");
    TCase *list;
    list = add_case(suite, "dense");
    tcase_add_test(list, pseudo_inverse);
    list = add_case(suite, "truth");
    tcase_add_test(list, truth_against_rationals);
    tcase_add_test(list, truth_against_oracle);
    list = add_case(suite, "rules");
    tcase_add_test(list, fields_and_antiderivatives);
    tcase_add_test(list, published_counts);
    tcase_add_test(list, rules_on_planes_and_wedges);
    tcase_add_test(list, rules_on_waves);
    list = add_case(suite, "enrichment");
    tcase_add_test(list, same_space_as_copies);
    tcase_add_test(list, complete_where_cells_are);
    tcase_add_test(list, patches_of_one_surface);
    tcase_add_test(list, complete_cuts);
    tcase_add_test(list, sides_without_an_edge);
    list = add_case(suite, "refused");
    tcase_add_test(list, crossing_cuts_are_refused);
    tcase_add_test(list, bad_surfaces_are_refused);
    tcase_add_test(list, self_crossing_is_refused);
    list = add_case(suite, "section 6");
    tcase_add_test(list, perturbation);
    tcase_add_test(list, shares_of_support);
    tcase_add_test(list, constrained_functions);
    list = add_case(suite, "model");
    tcase_add_test(list, same_motion_on_planes);
    tcase_add_test(list, elastic_derivatives);
    tcase_add_test(list, elastic_tangent);
    list = add_case(suite, "sampling");
    tcase_add_test(list, published_samples);
    tcase_add_test(list, inside_by_parity);
    tcase_add_test(list, sampling_converges);
    tcase_add_test(list, positive_rules);
    list = add_case(suite, "parts");
    tcase_add_test(list, points_of_parts);
    tcase_add_test(list, rules_in_parts);
    tcase_add_test(list, rxfem_in_parts);
    tcase_add_test(list, deleted_elements);
    list = add_case(suite, "local");
    tcase_add_test(list, local_energies);
    tcase_add_test(list, local_colors);
    tcase_add_test(list, vbd_converges);
    tcase_add_test(list, xpbd_converges);
    tcase_add_test(list, local_balance);
    return run_suite(suite);
}
