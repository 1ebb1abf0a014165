/* test_integrate.c - tests of gxfem_integrate.h.

       moments      ten integrals of cube, icosahedron, tetrahedron and boxes against analytic values; translation,
                    map, inertia
       monomials    random bodies of voxels (non-convex, tunnels, cavities), rotated, to degree 6 against
                    Gauss-Legendre; far from the origin; high degrees; translation
       surfaces     area and flux monomials against Gauss-Legendre and the divergence theorem
       elements     gradients, mass
       parts        slivers at a vertex, layers, random splits by planes, thin layers, noise, cut faces
       arguments    every refusal, with outputs unchanged

   GXFEM_DATA (environment): a folder with moments/cube, icosa, tetra and their *.volInt.out, compared if they are
   there. GXFEM_SEED: the first seed of the random tests (default 1). */
#define GXFEM_INTEGRATE_IMPLEMENTATION
#include "../gxfem_integrate.h"

#include "../bench/splitmix.h"
#include "runner.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- random numbers; the seed of the running case stands in every failure ---- */

static uint64_t case_seed, random_state;

static void seed_random(uint64_t seed) {
    case_seed = seed;
    random_state = seed * 0x9e3779b97f4a7c15u + 0x1234567u;
}

static double random_unit(void) { return (double)(splitmix64(&random_state) >> 11) / 9007199254740992.0; }

static double random_between(double a, double b) { return a + (b - a) * random_unit(); }

static uint64_t first_seed(void) {
    const char *text = getenv("GXFEM_SEED");
    return text ? strtoull(text, NULL, 10) : 1;
}

/* Only failures reach Check, which writes a message for every assertion that it sees. */
#define ASSERT_NEAR(value, expected, tolerance)                                                                        \
    do {                                                                                                               \
        double v_ = (double)(value), e_ = (double)(expected), t_ = (double)(tolerance);                                \
        if (!(fabs(v_ - e_) <= t_))                                                                                    \
            ck_abort_msg("%s = %.17g, expected %.17g within %.3g, is off by %.3g (seed %llu)", #value, v_, e_, t_,     \
                         fabs(v_ - e_), (unsigned long long)case_seed);                                                \
    } while (0)

#define ASSERT_RELATIVE(value, expected, tolerance) ASSERT_NEAR(value, expected, (tolerance)*fabs((double)(expected)))

/* ---- bodies ---- */

typedef struct mesh {
    double positions[3 * 128];
    uint32_t triangles[3 * 1024];
    size_t position_count, triangle_count;
} mesh;

static gxi_surface surface_of(const mesh *m) {
    gxi_surface s;
    s.positions = m->positions;
    s.position_count = m->position_count;
    s.triangles = m->triangles;
    s.triangle_count = m->triangle_count;
    return s;
}

static void add_position(mesh *m, double x, double y, double z) {
    double *p = m->positions + 3 * m->position_count++;
    ck_assert(m->position_count <= 128);
    p[0] = x;
    p[1] = y;
    p[2] = z;
}

static void add_triangle(mesh *m, size_t a, size_t b, size_t c) {
    uint32_t *t = m->triangles + 3 * m->triangle_count++;
    ck_assert(m->triangle_count <= 1024);
    t[0] = (uint32_t)a;
    t[1] = (uint32_t)b;
    t[2] = (uint32_t)c;
}

/* The boundary of a set of unit cells in a lattice of n^3 (n <= 3), cell x y z being bit x + n (y + n z). */
static mesh make_voxels(unsigned n, uint32_t cells) {
    mesh m = {{0}, {0}, 0, 0};
    unsigned x[3], axis, side, corner;
    for (x[2] = 0; x[2] <= n; x[2]++)
        for (x[1] = 0; x[1] <= n; x[1]++)
            for (x[0] = 0; x[0] <= n; x[0]++) add_position(&m, x[0], x[1], x[2]);
    for (x[2] = 0; x[2] < n; x[2]++)
        for (x[1] = 0; x[1] < n; x[1]++)
            for (x[0] = 0; x[0] < n; x[0]++) {
                if (!(cells >> (x[0] + n * (x[1] + n * x[2])) & 1)) continue;
                for (axis = 0; axis < 3; axis++)
                    for (side = 0; side < 2; side++) {
                        unsigned y[3] = {x[0], x[1], x[2]}, outside;
                        size_t quad[4];
                        y[axis] += side ? 1u : (unsigned)-1;
                        outside = y[axis] >= n;
                        if (!outside && (cells >> (y[0] + n * (y[1] + n * y[2])) & 1)) continue;
                        for (corner = 0; corner < 4; corner++) {
                            unsigned u = (axis + 1) % 3, v = (axis + 2) % 3, c[3] = {x[0], x[1], x[2]};
                            c[axis] += side;
                            c[u] += corner == 1 || corner == 2;
                            c[v] += corner >= 2;
                            quad[side ? corner : 3 - corner] = c[0] + (n + 1) * (c[1] + (n + 1) * (size_t)c[2]);
                        }
                        add_triangle(&m, quad[0], quad[1], quad[2]);
                        add_triangle(&m, quad[0], quad[2], quad[3]);
                    }
            }
    return m;
}

static mesh make_box(const double lower[3], const double upper[3]) {
    mesh m = make_voxels(1, 1);
    size_t i;
    for (i = 0; i < 24; i++) m.positions[i] = m.positions[i] > 0 ? upper[i % 3] : lower[i % 3];
    return m;
}

static mesh make_tetrahedron(const double p[12]) {
    mesh m = {{0}, {0}, 0, 0};
    size_t i;
    for (i = 0; i < 4; i++) add_position(&m, p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    add_triangle(&m, 0, 2, 1);
    add_triangle(&m, 0, 1, 3);
    add_triangle(&m, 0, 3, 2);
    add_triangle(&m, 1, 2, 3);
    return m;
}

/* Twelve corners (0, +-1, +-phi) and cyclic, scaled to the unit sphere; faces are the triples at mutual distance 2. */
static mesh make_icosahedron(void) {
    mesh m = {{0}, {0}, 0, 0};
    double phi = (1 + sqrt(5.0)) / 2, r = sqrt(1 + phi * phi), n[3];
    size_t i, j, k;
    for (i = 0; i < 12; i++) {
        double p[3];
        p[i / 4] = 0;
        p[(i / 4 + 1) % 3] = (i & 1 ? 1 : -1) / r;
        p[(i / 4 + 2) % 3] = (i & 2 ? phi : -phi) / r;
        add_position(&m, p[0], p[1], p[2]);
    }
    for (i = 0; i < 12; i++)
        for (j = i + 1; j < 12; j++)
            for (k = j + 1; k < 12; k++) {
                const double *a = m.positions + 3 * i, *b = m.positions + 3 * j, *c = m.positions + 3 * k;
                double edge = 2 / r + 1e-9, ab[3], bc[3], ca[3];
                gxip_subtract(b, a, ab);
                gxip_subtract(c, b, bc);
                gxip_subtract(a, c, ca);
                if (gxip_length(ab) > edge || gxip_length(bc) > edge || gxip_length(ca) > edge) continue;
                gxip_cross(ab, bc, n);
                if (gxip_dot(n, a) > 0)
                    add_triangle(&m, i, j, k);
                else
                    add_triangle(&m, i, k, j);
            }
    ck_assert_uint_eq(m.triangle_count, 20);
    return m;
}

/* Random rotation matrix by rows, from a quaternion. */
static void random_rotation(double r[9]) {
    double q[4], n = 0;
    int i;
    do {
        n = 0;
        for (i = 0; i < 4; i++) {
            q[i] = random_between(-1, 1);
            n += q[i] * q[i];
        }
    } while (n > 1 || n < 0.01);
    for (i = 0; i < 4; i++) q[i] /= sqrt(n);
    r[0] = 1 - 2 * (q[2] * q[2] + q[3] * q[3]);
    r[1] = 2 * (q[1] * q[2] - q[0] * q[3]);
    r[2] = 2 * (q[1] * q[3] + q[0] * q[2]);
    r[3] = 2 * (q[1] * q[2] + q[0] * q[3]);
    r[4] = 1 - 2 * (q[1] * q[1] + q[3] * q[3]);
    r[5] = 2 * (q[2] * q[3] - q[0] * q[1]);
    r[6] = 2 * (q[1] * q[3] - q[0] * q[2]);
    r[7] = 2 * (q[2] * q[3] + q[0] * q[1]);
    r[8] = 1 - 2 * (q[1] * q[1] + q[2] * q[2]);
}

static void map_mesh(mesh *m, const double a[9], const double t[3]) {
    size_t i, d;
    for (i = 0; i < m->position_count; i++) {
        double p[3];
        memcpy(p, m->positions + 3 * i, sizeof p);
        for (d = 0; d < 3; d++) m->positions[3 * i + d] = gxip_dot(a + 3 * d, p) + t[d];
    }
}

/* ---- oracle: Gauss-Legendre in long double ---- */

#define GAUSS_COUNT 8                                          /* exact to degree 15 */
static long double gauss_x[GAUSS_COUNT], gauss_w[GAUSS_COUNT]; /* on 0 .. 1 */

static void make_gauss(void) {
    int i, k, n = GAUSS_COUNT;
    for (i = 0; i < n; i++) {
        long double x = cosl(3.14159265358979323846L * ((long double)i + 0.75L) / ((long double)n + 0.5L)), slope = 1;
        int step;
        for (step = 0; step < 50; step++) {
            long double p0 = 1, p1 = x;
            for (k = 2; k <= n; k++) {
                long double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = n * (x * p1 - p0) / (x * x - 1);
            x -= p1 / slope;
        }
        gauss_x[i] = (1 + x) / 2;
        gauss_w[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

static long double monomial(const long double p[3], unsigned i, unsigned j, unsigned k) {
    long double r = 1;
    while (i-- > 0) r *= p[0];
    while (j-- > 0) r *= p[1];
    while (k-- > 0) r *= p[2];
    return r;
}

/* Adds weight times all monomials at p, and of their absolute values. */
static void add_monomials(const long double p[3], long double weight, unsigned degree, long double *sum,
                          long double *size) {
    unsigned n, i, j;
    size_t at = 0;
    for (n = 0; n <= degree; n++)
        for (i = n + 1; i-- > 0;)
            for (j = n - i + 1; j-- > 0; at++) {
                long double value = monomial(p, i, j, n - i - j);
                if (at != gxi_monomial_index(i, j, n - i - j)) ck_abort_msg("index of %u %u %u", i, j, n - i - j);
                sum[at] += weight * value;
                size[at] += weight * fabsl(value);
            }
}

/* Integrals over the voxels mapped by x -> a x + t. */
static void voxel_oracle(unsigned n, uint32_t cells, const double a[9], const double t[3], unsigned degree,
                         long double *sum, long double *size) {
    long double det = (long double)a[0] * ((long double)a[4] * a[8] - (long double)a[5] * a[7]) -
                      (long double)a[1] * ((long double)a[3] * a[8] - (long double)a[5] * a[6]) +
                      (long double)a[2] * ((long double)a[3] * a[7] - (long double)a[4] * a[6]);
    unsigned cell, i, j, k, d;
    for (cell = 0; cell < n * n * n; cell++) {
        if (!(cells >> cell & 1)) continue;
        for (i = 0; i < GAUSS_COUNT; i++)
            for (j = 0; j < GAUSS_COUNT; j++)
                for (k = 0; k < GAUSS_COUNT; k++) {
                    long double x[3], p[3];
                    x[0] = cell % n + gauss_x[i];
                    x[1] = cell / n % n + gauss_x[j];
                    x[2] = cell / n / n + gauss_x[k];
                    for (d = 0; d < 3; d++) p[d] = a[3 * d] * x[0] + a[3 * d + 1] * x[1] + a[3 * d + 2] * x[2] + t[d];
                    add_monomials(p, det * gauss_w[i] * gauss_w[j] * gauss_w[k], degree, sum, size);
                }
    }
}

/* Integrals over a triangle with weight `area`, by Duffy's map of the square: p = a + u (b - a) + u v (c - b). */
static void triangle_oracle(const double *a, const double *b, const double *c, const double origin[3], long double area,
                            unsigned degree, long double *sum, long double *size) {
    unsigned i, j, d;
    for (i = 0; i < GAUSS_COUNT; i++)
        for (j = 0; j < GAUSS_COUNT; j++) {
            long double u = gauss_x[i], v = gauss_x[j], p[3];
            for (d = 0; d < 3; d++)
                p[d] = a[d] + u * ((long double)b[d] - a[d]) + u * v * ((long double)c[d] - b[d]) - origin[d];
            add_monomials(p, 2 * area * u * gauss_w[i] * gauss_w[j], degree, sum, size);
        }
}

/* ---- moments ---- */

static const double origin0[3] = {0, 0, 0};

static gxi_moments2 moments2_of(const mesh *m, const double *origin) {
    gxi_surface s = surface_of(m);
    gxi_moments2 r;
    ck_assert_int_eq(gxi_polyhedron_moments2(&s, origin, &r, NULL), GX_OK);
    return r;
}

static void assert_moments2(const gxi_moments2 *m, const gxi_moments2 *expected, double volume_tolerance,
                            double reach) {
    int i;
    ASSERT_NEAR(m->volume, expected->volume, volume_tolerance);
    for (i = 0; i < 3; i++) ASSERT_NEAR(m->first[i], expected->first[i], volume_tolerance * reach);
    for (i = 0; i < 6; i++) ASSERT_NEAR(m->second[i], expected->second[i], volume_tolerance * reach * reach);
}

START_TEST(ten_integrals_of_cube) {
    const double lower[3] = {-10, -10, -10}, upper[3] = {10, 10, 10};
    const gxi_moments2 expected = {8000, {0, 0, 0}, {800000.0 / 3, 0, 0, 800000.0 / 3, 0, 800000.0 / 3}};
    mesh m = make_box(lower, upper);
    gxi_moments2 r = moments2_of(&m, NULL);
    assert_moments2(&r, &expected, 1e-11, 10);
}
END_TEST

START_TEST(ten_integrals_of_tetrahedron) {
    const double p[12] = {0, 0, 0, 5, 0, 0, 0, 4, 0, 0, 0, 3};
    const gxi_moments2 expected = {10, {12.5, 10, 7.5}, {25, 10, 7.5, 16, 6, 9}};
    mesh m = make_tetrahedron(p);
    gxi_moments2 r = moments2_of(&m, NULL);
    assert_moments2(&r, &expected, 1e-14, 1);
}
END_TEST

/* Edge s = 1/sin(2 pi/5) at circumradius 1; volume 5 (3 + sqrt 5)/12 s^3; moment of inertia phi^2 s^2/10 of the mass.
 */
START_TEST(ten_integrals_of_icosahedron) {
    double s = 1 / sin(2 * acos(-1.0) / 5), phi = (1 + sqrt(5.0)) / 2, v = 5 * (3 + sqrt(5.0)) / 12 * s * s * s;
    double xx = v * phi * phi * s * s / 20, centre[3], inertia[6], rotation[9];
    const double shift[3] = {3, -4, 5};
    const gxi_moments2 expected = {v, {0, 0, 0}, {xx, 0, 0, xx, 0, xx}};
    mesh m = make_icosahedron();
    gxi_moments2 r = moments2_of(&m, NULL);
    int i;
    assert_moments2(&r, &expected, 1e-14, 1);
    seed_random(7);
    random_rotation(rotation);
    map_mesh(&m, rotation, shift);
    r = moments2_of(&m, NULL);
    gxi_moments2_inertia(&r, 2.5, centre, inertia);
    for (i = 0; i < 3; i++) ASSERT_NEAR(centre[i], shift[i], 1e-13);
    for (i = 0; i < 6; i++) ASSERT_NEAR(inertia[i], i == 0 || i == 3 || i == 5 ? 5 * xx : 0, 1e-12);
}
END_TEST

/* A box lower..upper: the integral of x^i y^j z^k is a product of (u^(i+1) - l^(i+1))/(i+1). */
static double box_monomial(const double lower[3], const double upper[3], const unsigned power[3], double *size) {
    double r = 1;
    int d;
    *size = 1;
    for (d = 0; d < 3; d++) {
        double n = power[d] + 1, u = pow(upper[d], n), l = pow(lower[d], n);
        r *= (u - l) / n;
        *size *= (fabs(u) + fabs(l)) / n;
    }
    return r;
}

START_TEST(boxes_to_degree_6) {
    double lower[3], upper[3], moments[84], work[84], size;
    mesh m;
    gxi_surface s;
    unsigned p[3], d;
    seed_random(first_seed() + (uint64_t)_i);
    for (d = 0; d < 3; d++) {
        lower[d] = random_between(-2, 1);
        upper[d] = lower[d] + random_between(0.1, 2);
    }
    m = make_box(lower, upper);
    s = surface_of(&m);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, 6, moments, work, NULL), GX_OK);
    for (p[0] = 0; p[0] <= 6; p[0]++)
        for (p[1] = 0; p[0] + p[1] <= 6; p[1]++)
            for (p[2] = 0; p[0] + p[1] + p[2] <= 6; p[2]++) {
                double expected = box_monomial(lower, upper, p, &size);
                ASSERT_NEAR(moments[gxi_monomial_index(p[0], p[1], p[2])], expected, 1e-13 * size);
            }
}
END_TEST

START_TEST(translation_and_map) {
    double a[9], shift[3], back[3], m20[10], work[10];
    mesh m = make_voxels(3, 0x5b7effdu), moved;
    gxi_moments2 r = moments2_of(&m, NULL), direct;
    gxi_surface s;
    int i;
    seed_random(first_seed() + (uint64_t)_i);
    for (i = 0; i < 9; i++) a[i] = random_between(-1, 1) + 2 * (i % 4 == 0);
    for (i = 0; i < 3; i++) shift[i] = random_between(-3, 3);
    moved = m;
    map_mesh(&moved, a, shift);
    direct = moments2_of(&moved, NULL);
    gxi_moments2_map(&r, a, shift);
    assert_moments2(&r, &direct, 1e-11, 10);
    for (i = 0; i < 3; i++) back[i] = -shift[i];
    gxi_moments2_translate(&r, back);
    direct = moments2_of(&moved, shift);
    assert_moments2(&r, &direct, 1e-11, 10);
    /* the general form in the same order */
    s = surface_of(&moved);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, shift, 2, m20, work, NULL), GX_OK);
    ASSERT_NEAR(m20[0], direct.volume, 1e-11);
    for (i = 0; i < 3; i++) ASSERT_NEAR(m20[1 + i], direct.first[i], 1e-10);
    for (i = 0; i < 6; i++) ASSERT_NEAR(m20[4 + i], direct.second[i], 1e-9);
}
END_TEST

START_TEST(disjoint_unions_add) {
    mesh a = make_voxels(3, 0x000002fu), b = make_voxels(3, 0x7fffc00u), both = make_voxels(3, 0x7fffc2fu);
    gxi_moments2 ma = moments2_of(&a, NULL), mb = moments2_of(&b, NULL), m = moments2_of(&both, NULL);
    gxi_moments2_add(&ma, &mb);
    assert_moments2(&ma, &m, 1e-12, 3);
}
END_TEST

/* ---- monomials ---- */

/* 27 voxels less the centre (cavity), less a row (tunnel), then random sets. */
static uint32_t voxel_case(int i) {
    if (i == 0) return 0x7ffffffu & ~(1u << 13);
    if (i == 1) return 0x7ffffffu & ~(1u << 4 | 1u << 13 | 1u << 22);
    return 1u | (uint32_t)random_between(0, 134217728.0);
}

START_TEST(voxel_bodies_to_degree_6) {
    long double sum[84] = {0}, size[84] = {0};
    double a[9], t[3], moments[84], work[84], one, scale;
    mesh m;
    gxi_surface s;
    uint32_t cells;
    unsigned i, j, k;
    seed_random(first_seed() + (uint64_t)_i);
    cells = voxel_case(_i);
    m = make_voxels(3, cells);
    random_rotation(a);
    scale = random_between(0.1, 0.5);
    for (i = 0; i < 9; i++) a[i] *= scale;
    for (i = 0; i < 3; i++) t[i] = random_between(-1, 0.5);
    map_mesh(&m, a, t);
    s = surface_of(&m);
    voxel_oracle(3, cells, a, t, 6, sum, size);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, 6, moments, work, NULL), GX_OK);
    for (i = 0; i <= 6; i++)
        for (j = 0; i + j <= 6; j++)
            for (k = 0; i + j + k <= 6; k++) {
                size_t at = gxi_monomial_index(i, j, k);
                double tolerance = 1e-13 * (pow(2, i + j + k) + (double)size[at]);
                ASSERT_NEAR(moments[at], sum[at], tolerance);
                if (_i > 2) continue;
                ck_assert_int_eq(gxi_polyhedron_monomial(&s, NULL, i, j, k, &one, NULL), GX_OK);
                ASSERT_NEAR(one, sum[at], tolerance);
            }
}
END_TEST

/* Coordinates in 1/1024, offset 1e8: exactly representable, so the offset must not change the result. */
START_TEST(far_from_the_origin) {
    double a[9], zero[3] = {0, 0, 0}, far[3] = {1e8, -1e8, 3e8}, near_moments[84], far_moments[84], work[84], back[3];
    mesh m = make_voxels(3, 0x5b7effdu), moved;
    gxi_moments2 m2, expected;
    gxi_surface s;
    size_t i;
    seed_random(first_seed());
    random_rotation(a);
    map_mesh(&m, a, zero);
    for (i = 0; i < 3 * m.position_count; i++) m.positions[i] = floor(m.positions[i] * 1024) / 1024;
    moved = m;
    for (i = 0; i < 3 * m.position_count; i++) moved.positions[i] += far[i % 3];
    s = surface_of(&m);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, 6, near_moments, work, NULL), GX_OK);
    s = surface_of(&moved);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, far, 6, far_moments, work, NULL), GX_OK);
    for (i = 0; i < 84; i++) ASSERT_NEAR(far_moments[i], near_moments[i], 0);
    m2 = moments2_of(&moved, far);
    expected = moments2_of(&m, NULL);
    assert_moments2(&m2, &expected, 0, 0);
    /* To the far origin and back: what translation preserves */
    gxi_moments2_translate(&m2, far);
    ASSERT_RELATIVE(m2.first[2], expected.volume * far[2] + expected.first[2], 1e-15);
    ASSERT_RELATIVE(m2.second[5],
                    expected.volume * far[2] * far[2] + 2 * far[2] * expected.first[2] + expected.second[5], 1e-15);
    for (i = 0; i < 3; i++) back[i] = -far[i];
    gxi_moments2_translate(&m2, back);
    for (i = 0; i < 3; i++) ASSERT_NEAR(m2.first[i], expected.first[i], 1e-15 * 3e8 * expected.volume);
}
END_TEST

START_TEST(monomials_translate) {
    double shift[3], minus[3], here[84], there[84], work[84];
    mesh m = make_icosahedron();
    gxi_surface s = surface_of(&m);
    size_t i;
    seed_random(first_seed() + (uint64_t)_i);
    for (i = 0; i < 3; i++) {
        shift[i] = random_between(-1, 1);
        minus[i] = -shift[i];
    }
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, 6, here, work, NULL), GX_OK);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, minus, 6, there, work, NULL), GX_OK);
    ck_assert_int_eq(gxi_monomials_translate(6, shift, here, NULL), GX_OK);
    for (i = 0; i < 84; i++) ASSERT_NEAR(here[i], there[i], 1e-12);
}
END_TEST

/* Unit tetrahedron: i! j! k! / (i + j + k + 3)!, every value relatively exact, whatever the degree. */
START_TEST(high_degrees) {
    const double unit[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const unsigned degree = (unsigned)_i;
    mesh m = make_tetrahedron(unit);
    gxi_surface s = surface_of(&m);
    size_t count = gxi_monomial_count(degree);
    double *moments = (double *)malloc(2 * count * sizeof(double));
    unsigned i, j, k, step = degree > 20 ? degree / 5 : 1;
    ck_assert_ptr_nonnull(moments);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, degree, moments, moments + count, NULL), GX_OK);
    for (i = 0; i <= degree; i += step)
        for (j = 0; i + j <= degree; j += step)
            for (k = 0; i + j + k <= degree; k += step) {
                long double expected = 1, n = 0;
                double value = moments[gxi_monomial_index(i, j, k)];
                unsigned p;
                for (p = 1; p <= i; p++) expected *= p / ++n;
                for (p = 1; p <= j; p++) expected *= p / ++n;
                for (p = 1; p <= k; p++) expected *= p / ++n;
                expected /= (n + 1) * (n + 2) * (n + 3);
                ASSERT_RELATIVE(value, expected, 2e-13);
            }
    free(moments);
}
END_TEST

START_TEST(counts_and_indices) {
    ck_assert_uint_eq(gxi_monomial_count(0), 1);
    ck_assert_uint_eq(gxi_monomial_count(6), 84);
    ck_assert_uint_eq(gxi_monomial_count(GXI_DEGREE_MAX), 2862209);
    ck_assert_uint_eq(gxi_monomial_count(GXI_DEGREE_MAX + 1), 0);
    ck_assert_uint_eq(gxi_monomial_index(0, 0, GXI_DEGREE_MAX), 2862208);
    ck_assert_uint_eq(gxi_monomial_index(0, 0, 0), 0);
    ck_assert_uint_eq(gxi_monomial_index(0, 1, 1), 8);
}
END_TEST

/* ---- surfaces ---- */

START_TEST(open_surface_against_gauss) {
    long double sum[84] = {0}, size[84] = {0}, flux[3][84] = {{0}}, flux_size[3][84] = {{0}};
    double moments[84], flux_moments[3 * 84], work[84], origin[3];
    mesh m = {{0}, {0}, 0, 0};
    gxi_surface s;
    size_t i, t, d;
    seed_random(first_seed() + (uint64_t)_i);
    for (d = 0; d < 3; d++) origin[d] = random_between(-1, 1);
    for (i = 0; i < 10; i++) add_position(&m, random_between(-1, 1), random_between(-1, 1), random_between(-1, 1));
    for (t = 0; t < 8; t++) add_triangle(&m, t, t + 1, t + 2);
    s = surface_of(&m);
    for (t = 0; t < 8; t++) {
        const double *a = m.positions + 3 * t, *b = a + 3, *c = a + 6;
        long double n[3], area = 0;
        for (d = 0; d < 3; d++) {
            size_t e = (d + 1) % 3, f = (d + 2) % 3;
            n[d] = (((long double)b[e] - a[e]) * ((long double)c[f] - a[f]) -
                    ((long double)b[f] - a[f]) * ((long double)c[e] - a[e])) /
                   2;
            area += n[d] * n[d];
        }
        triangle_oracle(a, b, c, origin, sqrtl(area), 6, sum, size);
        for (d = 0; d < 3; d++) triangle_oracle(a, b, c, origin, n[d], 6, flux[d], flux_size[d]);
    }
    ck_assert_int_eq(gxi_surface_monomials(&s, origin, 6, moments, work, NULL), GX_OK);
    ck_assert_int_eq(gxi_surface_flux_monomials(&s, origin, 6, flux_moments, work, NULL), GX_OK);
    for (i = 0; i < 84; i++) {
        ASSERT_NEAR(moments[i], sum[i], 1e-14 * (1 + (double)size[i]));
        for (d = 0; d < 3; d++) ASSERT_NEAR(flux_moments[3 * i + d], flux[d][i], 1e-14 * (1 + (double)size[i]));
    }
}
END_TEST

/* Closed surface: flux of f e_d = integral of df/dx_d, for every monomial f (GXFEM Eq. 21). */
START_TEST(divergence_theorem) {
    double volume[84], flux[3 * 84], work[84], a[9], t[3] = {0.1, -0.2, 0.3};
    mesh m;
    gxi_surface s;
    unsigned p[3], d;
    seed_random(first_seed() + (uint64_t)_i);
    m = make_voxels(3, voxel_case(_i));
    random_rotation(a);
    for (d = 0; d < 9; d++) a[d] /= 3;
    map_mesh(&m, a, t);
    s = surface_of(&m);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, 6, volume, work, NULL), GX_OK);
    ck_assert_int_eq(gxi_surface_flux_monomials(&s, NULL, 6, flux, work, NULL), GX_OK);
    for (p[0] = 0; p[0] <= 6; p[0]++)
        for (p[1] = 0; p[0] + p[1] <= 6; p[1]++)
            for (p[2] = 0; p[0] + p[1] + p[2] <= 6; p[2]++)
                for (d = 0; d < 3; d++) {
                    unsigned q[3] = {p[0], p[1], p[2]};
                    double expected = 0;
                    if (q[d]-- > 0) expected = p[d] * volume[gxi_monomial_index(q[0], q[1], q[2])];
                    ASSERT_NEAR(flux[3 * gxi_monomial_index(p[0], p[1], p[2]) + d], expected, 1e-12);
                }
}
END_TEST

START_TEST(areas) {
    const double lower[3] = {0, 0, 0}, upper[3] = {1, 2, 3};
    const double a[3] = {0, 0, 0}, b[3] = {1e-170, 0, 0}, c[3] = {0, 1e-130, 0};
    mesh m = make_box(lower, upper);
    gxi_surface s = surface_of(&m);
    double moments[4], work[4], n[3];
    ck_assert_int_eq(gxi_surface_monomials(&s, NULL, 1, moments, work, NULL), GX_OK);
    ASSERT_NEAR(moments[0], 22, 1e-14);
    ASSERT_NEAR(moments[1], 11, 1e-14);
    ASSERT_NEAR(moments[2], 22, 1e-14);
    ASSERT_NEAR(moments[3], 33, 1e-14);
    ASSERT_RELATIVE(gxi_triangle_area(a, b, c, n), 5e-301, 1e-14);
    ASSERT_RELATIVE(n[2], 5e-301, 1e-14);
}
END_TEST

/* ---- elements ---- */

static void random_element(double x[12]) {
    int i;
    do
        for (i = 0; i < 12; i++) x[i] = random_between(-1, 1);
    while (gxi_tet_volume(x) < 0.02);
}

START_TEST(gradients) {
    double x[12], g[12], volume;
    int i, j, d;
    seed_random(first_seed() + (uint64_t)_i);
    random_element(x);
    ck_assert_int_eq(gxi_tet_gradients(x, g, &volume), GX_OK);
    ASSERT_RELATIVE(volume, gxi_tet_volume(x), 1e-13);
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++) {
            double e[3];
            gxip_subtract(x + 3 * j, x, e);
            ASSERT_NEAR(gxip_dot(g + 3 * i, e), (i == j) - (i == 0), 1e-12);
        }
    for (d = 0; d < 3; d++) ASSERT_NEAR(g[d] + g[3 + d] + g[6 + d] + g[9 + d], 0, 1e-13);
    ck_assert_int_eq(gxi_tet_gradients(x, g, NULL), GX_OK);
}
END_TEST

/* The four faces of an element by vertex, outward. */
static const uint32_t faces[12] = {1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1};
static const double corners[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/* Moments of a part in the frame of a given vertex. */
static gxi_moments2 moments_at(const double *lambdas, const uint32_t *triangles, size_t triangle_count, unsigned k) {
    gxi_moments2 m = {0, {0}, {0}};
    double p[3][3];
    unsigned axes[3];
    size_t t, i, d;
    gxi_part_axes(k, axes);
    for (t = 0; t < triangle_count; t++) {
        for (i = 0; i < 3; i++)
            for (d = 0; d < 3; d++) p[i][d] = lambdas[4 * (size_t)triangles[3 * t + i] + axes[d]];
        gxi_moments2_add_triangle(&m, p[0], p[1], p[2]);
    }
    return m;
}

START_TEST(whole_element) {
    double mass[10], part[10], load[4];
    unsigned k, chosen;
    gxi_moments2 m;
    int i, j, at = 0;
    gxi_tet_mass(0.3, 1000, mass);
    for (i = 0; i < 4; i++)
        for (j = i; j < 4; j++) ASSERT_RELATIVE(mass[at++], i == j ? 30.0 : 15.0, 1e-15);
    for (k = 0; k < 4; k++) {
        m = moments_at(corners, faces, 4, k);
        ASSERT_RELATIVE(m.volume, 1.0 / 6, 1e-15);
        gxi_part_mass(&m, k, 0.3, 1000, part);
        for (i = 0; i < 10; i++) ASSERT_RELATIVE(part[i], mass[i], 3e-15);
        gxi_part_load(&m, k, 0.3, 1000, load);
        for (i = 0; i < 4; i++) ASSERT_RELATIVE(load[i], 75.0, 1e-15);
    }
    ck_assert_int_eq(gxi_part_moments(corners, 4, faces, 4, &chosen, &m), GX_OK);
    ASSERT_RELATIVE(m.volume, 1.0 / 6, 1e-15);
}
END_TEST

/* ---- parts ---- */

/* Corner cut off at vertex k: edges end at e[0], e[1], e[2] times their lengths. In the frame of k it is a tetrahedron.
 */
static void corner_part(unsigned k, const double e[3], double lambdas[16]) {
    unsigned axes[3], i;
    gxi_part_axes(k, axes);
    memset(lambdas, 0, 16 * sizeof *lambdas);
    lambdas[4 * k + k] = 1;
    for (i = 0; i < 3; i++) {
        lambdas[4 * axes[i] + k] = 1 - e[i];
        lambdas[4 * axes[i] + axes[i]] = e[i];
    }
}

START_TEST(slivers_at_a_vertex) {
    double e[3], lambdas[16], mass[10], load[4], v, sum, square;
    unsigned k, chosen, axes[3], i, j;
    gxi_moments2 m;
    seed_random(first_seed() + (uint64_t)_i);
    for (i = 0; i < 3; i++) e[i] = pow(10, random_between(_i % 2 ? -30 : -16, -1));
    v = 2.0 * 3.0 * e[0] * e[1] * e[2]; /* element volume 2, density 3 */
    sum = e[0] + e[1] + e[2];
    square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
    for (k = 0; k < 4; k++) {
        corner_part(k, e, lambdas);
        ck_assert_int_eq(gxi_part_moments(lambdas, 4, faces, 4, &chosen, &m), GX_OK);
        ck_assert_uint_eq(chosen, k);
        gxi_part_axes(k, axes);
        gxi_part_mass(&m, k, 2, 3, mass);
        gxi_part_load(&m, k, 2, 3, load);
        ASSERT_RELATIVE(load[k], v * (1 - sum / 4), 1e-13);
        ASSERT_RELATIVE(mass[gxip_packed4(k, k)], v * (1 - sum / 2 + (square + sum * sum) / 20), 1e-13);
        for (i = 0; i < 3; i++) {
            ASSERT_RELATIVE(load[axes[i]], v * e[i] / 4, 1e-13);
            ASSERT_RELATIVE(mass[gxip_packed4(k, axes[i])], v * (e[i] / 4 - e[i] * (e[i] + sum) / 20), 1e-13);
            for (j = 0; j < 3; j++)
                ASSERT_RELATIVE(mass[gxip_packed4(axes[i], axes[j])], v * e[i] * e[j] * (i == j ? 2 : 1) / 20, 1e-13);
        }
    }
}
END_TEST

/* A layer of relative thickness h upon face i: the element less the similar one with edges 1 - h. Its volume is
   V (1 - (1 - h)^3), the integral of lambda_i is V h^2 (6 - 8 h + 3 h^2)/4. */
START_TEST(layers_upon_a_face) {
    double h = pow(10, -_i), lambdas[24], load[4];
    uint32_t triangles[24];
    unsigned face, other[3], i, chosen;
    gxi_moments2 m;
    for (face = 0; face < 4; face++) {
        gxi_part_axes(face, other); /* outward order of the face opposite to `face` */
        memset(lambdas, 0, sizeof lambdas);
        for (i = 0; i < 3; i++) {
            uint32_t next = (i + 1) % 3, low = i, high = 3 + i;
            const uint32_t side[6] = {low, high, next, next, high, 3 + next};
            lambdas[4 * i + other[i]] = 1;
            lambdas[4 * (3 + i) + other[i]] = 1 - h;
            lambdas[4 * (3 + i) + face] = h;
            memcpy(triangles + 6 + 6 * i, side, sizeof side);
        }
        triangles[0] = 0;
        triangles[1] = 1;
        triangles[2] = 2;
        triangles[3] = 3;
        triangles[4] = 5;
        triangles[5] = 4;
        ck_assert_int_eq(gxi_part_moments(lambdas, 6, triangles, 8, &chosen, &m), GX_OK);
        ck_assert_uint_ne(chosen, face);
        gxi_part_load(&m, chosen, 1, 1, load);
        ASSERT_RELATIVE(6 * m.volume, h * (3 - 3 * h + h * h), 1e-13);
        ASSERT_RELATIVE(load[face], h * h * (6 - 8 * h + 3 * h * h) / 4, 1e-13);
    }
}
END_TEST

/* Convex cells with polygonal faces, corners in barycentric coordinates. */
#define CELL_FACES  32
#define FACE_POINTS 32

typedef struct cell {
    double points[CELL_FACES][FACE_POINTS][4];
    int point_count[CELL_FACES], face_count;
} cell;

static cell *whole_cell(void) {
    cell *c = (cell *)calloc(1, sizeof *c);
    int f, i;
    ck_assert_ptr_nonnull(c);
    c->face_count = 4;
    for (f = 0; f < 4; f++) {
        c->point_count[f] = 3;
        for (i = 0; i < 3; i++) c->points[f][i][faces[3 * f + i]] = 1;
    }
    return c;
}

static double height(const double plane[4], const double p[4]) {
    return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3] * p[3];
}

/* The point of the edge p q on the plane; the same bits for q p. */
static void crossing(const double plane[4], const double *p, const double *q, double out[4]) {
    double hp, hq;
    int i;
    if (memcmp(p, q, 4 * sizeof *p) > 0) {
        const double *swap = p;
        p = q;
        q = swap;
    }
    hp = height(plane, p);
    hq = height(plane, q);
    for (i = 0; i < 4; i++) out[i] = hp / (hp - hq) * q[i] + -hq / (hp - hq) * p[i];
}

/* The part of c where the plane's height is negative (side -1) or positive (side 1); NULL if there is none. */
static cell *clip(const cell *c, const double plane[4], double side) {
    cell *r = (cell *)calloc(1, sizeof *r);
    double from[FACE_POINTS][4], to[FACE_POINTS][4]; /* edges of the new face */
    int f, i, j, n, edges = 0;
    ck_assert_ptr_nonnull(r);
    for (f = 0; f < c->face_count; f++) {
        double enter[4] = {0}, leave[4] = {0};
        int crossed = 0;
        n = 0;
        for (i = 0; i < c->point_count[f]; i++) {
            const double *p = c->points[f][i], *q = c->points[f][(i + 1) % c->point_count[f]];
            int p_inside = side * height(plane, p) > 0, q_inside = side * height(plane, q) > 0;
            if (n + 2 >= FACE_POINTS) ck_abort_msg("too many corners (seed %llu)", (unsigned long long)case_seed);
            if (p_inside) memcpy(r->points[r->face_count][n++], p, 4 * sizeof *p);
            if (p_inside == q_inside) continue;
            crossed = 1;
            crossing(plane, p, q, r->points[r->face_count][n]);
            memcpy(p_inside ? leave : enter, r->points[r->face_count][n++], sizeof enter);
        }
        if (crossed) {
            memcpy(from[edges], enter, sizeof enter);
            memcpy(to[edges++], leave, sizeof leave);
        }
        r->point_count[r->face_count] = n;
        if (n > 2) r->face_count++;
    }
    ck_assert(r->face_count < CELL_FACES);
    if (r->face_count == 0) {
        free(r);
        return NULL;
    }
    for (n = 0, j = 0; edges > 0 && n < edges; n++) { /* chain the edges, run backwards along the old faces */
        memcpy(r->points[r->face_count][n], from[j], sizeof from[j]);
        for (i = 0; i < edges && memcmp(from[i], to[j], sizeof to[j]) != 0; i++) {}
        ck_assert_msg(i < edges, "the cap is not closed (seed %llu)", (unsigned long long)case_seed);
        j = i;
    }
    r->point_count[r->face_count] = edges;
    if (edges > 0) r->face_count++;
    return r;
}

/* lambdas and triangles (fans) of a cell; returns the number of triangles. */
static size_t triangulate(const cell *c, double *lambdas, uint32_t *triangles) {
    size_t t = 0, at = 0;
    int f, i;
    for (f = 0; f < c->face_count; f++) {
        for (i = 0; i < c->point_count[f]; i++)
            memcpy(lambdas + 4 * (at + (size_t)i), c->points[f][i], 4 * sizeof *lambdas);
        for (i = 2; i < c->point_count[f]; i++, t++) {
            triangles[3 * t] = (uint32_t)at;
            triangles[3 * t + 1] = (uint32_t)at + (uint32_t)i - 1;
            triangles[3 * t + 2] = (uint32_t)at + (uint32_t)i;
        }
        at += (size_t)c->point_count[f];
    }
    return t;
}

/* Mass block by long double tetrahedra about the mean of all corners: density 1, element volume 1. */
static void cell_oracle(const double *lambdas, const uint32_t *triangles, size_t triangle_count, long double mass[10]) {
    long double centre[4] = {0}, v[4][4], det;
    size_t t, i, j, d;
    memset(mass, 0, 10 * sizeof *mass);
    for (i = 0; i < 3 * triangle_count; i++)
        for (d = 0; d < 4; d++)
            centre[d] += lambdas[4 * (size_t)triangles[i] + d] / (3.0L * (long double)triangle_count);
    for (t = 0; t < triangle_count; t++) {
        long double e[3][3];
        size_t at = 0;
        memcpy(v[3], centre, sizeof centre);
        for (i = 0; i < 3; i++)
            for (d = 0; d < 4; d++) v[i][d] = lambdas[4 * (size_t)triangles[3 * t + i] + d];
        for (i = 0; i < 3; i++)
            for (d = 0; d < 3; d++) e[i][d] = v[i][d + 1] - centre[d + 1];
        det = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
              e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
        for (i = 0; i < 4; i++)
            for (j = i; j < 4; j++) {
                long double si = 0, sj = 0, both = 0;
                for (d = 0; d < 4; d++) {
                    si += v[d][i];
                    sj += v[d][j];
                    both += v[d][i] * v[d][j];
                }
                mass[at++] += det / 20 * (both + si * sj);
            }
    }
}

/* Smallest eigenvalue of a symmetric 4 x 4 block, by Jacobi rotations. */
static double smallest_eigenvalue(const double block[10]) {
    double a[4][4], least;
    size_t i, j, k, sweep;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++) a[i][j] = block[gxip_packed4(i, j)];
    for (sweep = 0; sweep < 30; sweep++)
        for (i = 0; i < 4; i++)
            for (j = i + 1; j < 4; j++) {
                double theta, t, c, s;
                if (!(fabs(a[i][j]) > 0)) continue;
                theta = (a[j][j] - a[i][i]) / (2 * a[i][j]);
                t = (theta < 0 ? -1 : 1) / (fabs(theta) + hypot(theta, 1));
                c = 1 / hypot(t, 1);
                s = t * c;
                for (k = 0; k < 4; k++) {
                    double x = a[k][i], y = a[k][j];
                    a[k][i] = c * x - s * y;
                    a[k][j] = s * x + c * y;
                }
                for (k = 0; k < 4; k++) {
                    double x = a[i][k], y = a[j][k];
                    a[i][k] = c * x - s * y;
                    a[j][k] = s * x + c * y;
                }
            }
    least = a[0][0];
    for (i = 1; i < 4; i++)
        if (a[i][i] < least) least = a[i][i];
    return least;
}

static void assert_semidefinite(const double mass[10]) {
    double trace = mass[0] + mass[4] + mass[7] + mass[9], least = smallest_eigenvalue(mass);
    ck_assert_msg(trace >= 0 && least >= -2e-14 * trace, "eigenvalue %g of a mass block of trace %g (seed %llu)", least,
                  trace, (unsigned long long)case_seed);
}

/* Mass of a cell for element volume 1 and density 1. */
static void cell_mass(const cell *c, double mass[10], double load[4], long double oracle[10]) {
    static double lambdas[4 * CELL_FACES * FACE_POINTS];
    static uint32_t triangles[3 * CELL_FACES * FACE_POINTS];
    size_t count = triangulate(c, lambdas, triangles);
    unsigned k;
    gxi_moments2 m;
    ck_assert_int_eq(gxi_part_moments(lambdas, CELL_FACES * FACE_POINTS, triangles, count, &k, &m), GX_OK);
    gxi_part_mass(&m, k, 1, 1, mass);
    gxi_part_load(&m, k, 1, 1, load);
    cell_oracle(lambdas, triangles, count, oracle);
}

/* The same about vertex k, without the triangles in the element's faces through it; returns their number */
static size_t cell_mass_at(const cell *c, unsigned k, double mass[10]) {
    static double lambdas[4 * CELL_FACES * FACE_POINTS];
    static uint32_t triangles[3 * CELL_FACES * FACE_POINTS];
    size_t count = triangulate(c, lambdas, triangles), kept = 0, t;
    gxi_moments2 m;
    for (t = 0; t < count; t++) {
        const double *p[3];
        unsigned i;
        int beside = 0;
        for (i = 0; i < 3; i++) p[i] = lambdas + 4 * (size_t)triangles[3 * t + i];
        for (i = 0; i < 4; i++) beside |= i != k && !(p[0][i] > 0 || p[1][i] > 0 || p[2][i] > 0);
        if (!beside) memcpy(triangles + 3 * kept++, triangles + 3 * t, 3 * sizeof *triangles);
    }
    ck_assert_int_eq(gxi_part_moments_at(lambdas, CELL_FACES * FACE_POINTS, triangles, kept, k, &m), GX_OK);
    gxi_part_mass(&m, k, 1, 1, mass);
    return count - kept;
}

#define CELLS 256

START_TEST(split_by_planes) {
    cell *cells[CELLS] = {NULL};
    double total[10] = {0}, load_total[4] = {0}, mass[10], load[4], whole[10];
    long double oracle[10];
    size_t left_out = 0;
    unsigned k;
    int count = 1, planes = 2 + _i % 5, p, i, j;
    seed_random(first_seed() + (uint64_t)_i);
    cells[0] = whole_cell();
    for (p = 0; p < planes; p++) {
        double plane[4];
        int n = count;
        for (i = 0; i < 4; i++) plane[i] = random_between(-1, 1) * (_i % 3 ? 1 : pow(10, random_between(-6, 0)));
        for (i = 0; i < n; i++) {
            cell *below = clip(cells[i], plane, -1), *above = clip(cells[i], plane, 1);
            free(cells[i]);
            cells[i] = below ? below : above;
            if (below && above) cells[count++] = above;
            ck_assert(count < CELLS);
        }
    }
    for (i = 0; i < count; i++) {
        double row = 0;
        cell_mass(cells[i], mass, load, oracle);
        assert_semidefinite(mass);
        for (j = 0; j < 10; j++) {
            ASSERT_NEAR(mass[j], oracle[j], 2e-15);
            total[j] += mass[j];
        }
        for (j = 0; j < 4; j++) {
            load_total[j] += load[j];
            row += mass[gxip_packed4(0, (size_t)j)];
        }
        ASSERT_NEAR(row, load[0], 2e-15); /* shape functions add up to 1 */
        for (k = 0; k < 4; k++) {
            left_out += cell_mass_at(cells[i], k, mass);
            assert_semidefinite(mass);
            for (j = 0; j < 10; j++) ASSERT_NEAR(mass[j], oracle[j], 4e-15);
        }
        free(cells[i]);
    }
    ck_assert_uint_ge(left_out, 12); /* a whole element has 3 for each of its vertices */
    gxi_tet_mass(1, 1, whole);
    for (j = 0; j < 10; j++) ASSERT_NEAR(total[j], whole[j], 2e-15);
    for (j = 0; j < 4; j++) ASSERT_NEAR(load_total[j], 0.25, 4e-15);
}
END_TEST

/* The layer between two parallel planes that cross the same edges of the element, of thickness h in the planes' height:
   a prism upon the cap of the half above the lower plane. NULL if a vertex of the element lies between the planes. */
static cell *make_layer(const double plane[4], double h) {
    cell *whole = whole_cell(), *half = clip(whole, plane, 1), *layer = (cell *)calloc(1, sizeof *layer);
    double upper[4], bottom[4][4], top[4][4];
    int i, j, n, cap, same = 1;
    ck_assert(half && layer);
    for (i = 0; i < 4; i++) {
        upper[i] = plane[i] - h;
        same &= (plane[i] > 0) == (upper[i] > 0);
    }
    cap = half->face_count - 1;
    n = half->point_count[cap];
    ck_assert(n == 3 || n == 4);
    for (i = 0; i < n && same; i++) { /* each on an edge: two lambdas are not 0 */
        const double *p = half->points[cap][i], *end[2] = {NULL, NULL};
        for (j = 0; j < 4; j++)
            if (p[j] > 0) end[end[0] != NULL] = corners + 4 * j;
        ck_assert(end[0] && end[1]);
        crossing(plane, end[0], end[1], bottom[i]);
        crossing(upper, end[0], end[1], top[i]);
    }
    for (i = 0; i < n && same; i++) {
        int next = (i + 1) % n;
        memcpy(layer->points[0][i], bottom[i], sizeof bottom[i]);
        memcpy(layer->points[1][n - 1 - i], top[i], sizeof top[i]);
        memcpy(layer->points[2 + i][0], bottom[next], sizeof bottom[i]);
        memcpy(layer->points[2 + i][1], bottom[i], sizeof bottom[i]);
        memcpy(layer->points[2 + i][2], top[i], sizeof top[i]);
        memcpy(layer->points[2 + i][3], top[next], sizeof top[i]);
        layer->point_count[2 + i] = 4;
    }
    layer->point_count[0] = layer->point_count[1] = n;
    layer->face_count = 2 + n;
    free(whole);
    free(half);
    if (same) return layer;
    free(layer);
    return NULL;
}

/* Layers in general position, 1e-2 ... 1e-18 thick; below 1e-16 only rounding is left. */
START_TEST(thin_layers_are_semidefinite) {
    double h = pow(10, -_i), plane[4], mass[10], load[4];
    long double oracle[10];
    int trial, i, above, tested = 0;
    for (trial = 0; trial < 100; trial++) {
        cell *layer;
        seed_random(first_seed() + (uint64_t)(1000 * _i + trial));
        do
            for (i = 0, above = 0; i < 4; i++) {
                plane[i] = random_between(-1, 1);
                above += plane[i] > 0;
            }
        while (above == 0 || above == 4);
        layer = make_layer(plane, h);
        if (!layer) continue;
        tested++;
        cell_mass(layer, mass, load, oracle);
        assert_semidefinite(mass);
        for (i = 0; i < 10; i++) ASSERT_NEAR(mass[i], oracle[i], 4e-15);
        for (i = 0; i < 4; i++) ck_assert(load[i] >= -4e-15 * (load[0] + load[1] + load[2] + load[3]));
        free(layer);
    }
    ck_assert_int_gt(tested, 80);
}
END_TEST

/* Prisms as thick as the last bits of their corners, in both orientations: any sum becomes a mass among the corners. */
START_TEST(parts_of_noise) {
    const uint32_t prism[24] = {0, 1, 2, 3, 5, 4, 0, 3, 1, 1, 3, 4, 1, 4, 2, 2, 4, 5, 2, 5, 0, 0, 5, 3};
    double lambdas[24], load[4], mass[10], sum;
    int trial, i, j, empty = 0;
    for (trial = 0; trial < 2000; trial++) {
        unsigned k;
        gxi_moments2 m;
        seed_random(first_seed() + (uint64_t)(10000 * _i + trial));
        for (i = 0; i < 3; i++) {
            for (j = 0, sum = 0; j < 4; j++) sum += lambdas[4 * i + j] = random_unit() < 0.3 ? 0 : random_unit();
            for (j = 0; j < 4; j++) {
                if (!(sum > 0))
                    lambdas[4 * i + j] = sum = j == i;
                else
                    lambdas[4 * i + j] /= sum;
                lambdas[4 * (i + 3) + j] = lambdas[4 * i + j] * (1 + random_between(-1, 1) * pow(10, -14 - _i));
            }
        }
        ck_assert_int_eq(gxi_part_moments(lambdas, 6, prism, 8, &k, &m), GX_OK);
        gxi_part_mass(&m, k, 1, 1, mass);
        gxi_part_load(&m, k, 1, 1, load);
        assert_semidefinite(mass);
        sum = load[0] + load[1] + load[2] + load[3];
        empty += !(sum > 0);
        for (j = 0; j < 4; j++) {
            double low = 1;
            for (i = 0; i < 6; i++)
                if (lambdas[4 * i + j] < low) low = lambdas[4 * i + j];
            if (!(load[j] >= (low - 1e-14) * sum))
                ck_abort_msg("load %d of %g is %g (seed %llu)", j, sum, load[j], (unsigned long long)case_seed);
        }
    }
    ck_assert(empty > 100 && empty < 1900);
}
END_TEST

/* Moments made of noise become those of some mass in the box; right moments do not change. */
START_TEST(repair) {
    double lower[3], upper[3], mass[10];
    const double small[3] = {0.4, 0.4, 0.4}, noise[] = {1e-300, 1e-30, 1e-16, 1e-3, 1};
    gxi_moments2 m, before;
    size_t i;
    seed_random(first_seed() + (uint64_t)_i);
    memset(&m, 0, sizeof m);
    m.volume = noise[_i % 5] * random_between(-0.1, 1);
    for (i = 0; i < 3; i++) {
        lower[i] = random_between(0, 0.3);
        upper[i] = lower[i] + (_i % 7 == 0 ? 0 : 0.03 * random_unit());
        m.first[i] = random_between(-1, 1) * noise[_i / 5 % 5];
    }
    for (i = 0; i < 6; i++) m.second[i] = random_between(-1, 1) * noise[_i / 25 % 5];
    ck_assert_int_eq(gxi_moments2_repair(&m, lower, upper), 1);
    gxi_part_mass(&m, (unsigned)_i % 4, 1, 1, mass);
    assert_semidefinite(mass);
    before = m;
    gxi_moments2_repair(&m, lower, upper); /* again: no more than rounding */
    assert_moments2(&m, &before, 1e-14 * m.volume, 1);
    memset(&m, 0, sizeof m);
    ck_assert_int_eq(gxi_moments2_repair(&m, lower, upper), 0);
    {
        mesh box = make_box(lower, small);
        before = m = moments2_of(&box, NULL);
        ck_assert_int_eq(gxi_moments2_repair(&m, lower, small), 0);
        ck_assert_mem_eq(&m, &before, sizeof m);
    }
}
END_TEST

/* A part of a cut face in an element in space: integrals of lambda_i and lambda_i lambda_j against the surface
   monomials, lambda_i = lambda_i(origin) + g_i . (x - origin) */
START_TEST(cut_faces) {
    double x[12], g[12], lambda[3][4], load[4] = {0}, mass[10] = {0}, n[3], area, moments[10], work[10];
    mesh m = {{0}, {0}, 0, 0};
    gxi_surface s;
    size_t i, j, d, e, at = 0;
    seed_random(first_seed() + (uint64_t)_i);
    random_element(x);
    ck_assert_int_eq(gxi_tet_gradients(x, g, NULL), GX_OK);
    for (i = 0; i < 3; i++) {
        double sum = 0, p[3] = {0, 0, 0};
        for (j = 0; j < 4; j++) sum += lambda[i][j] = random_unit();
        for (j = 0; j < 4; j++) lambda[i][j] /= sum;
        for (j = 0; j < 4; j++)
            for (d = 0; d < 3; d++) p[d] += lambda[i][j] * x[3 * j + d];
        add_position(&m, p[0], p[1], p[2]);
    }
    add_triangle(&m, 0, 1, 2);
    s = surface_of(&m);
    area = gxi_triangle_area(m.positions, m.positions + 3, m.positions + 6, n);
    ASSERT_RELATIVE(gxip_length(n), area, 1e-14);
    gxi_face_load_add(lambda[0], lambda[1], lambda[2], area, load);
    gxi_face_mass_add(lambda[0], lambda[1], lambda[2], area, mass);
    ck_assert_int_eq(gxi_surface_monomials(&s, x, 2, moments, work, NULL), GX_OK); /* about vertex 0: lambda_0 = 1 there
                                                                                    */
    for (i = 0; i < 4; i++) ASSERT_NEAR(load[i], (i == 0) * moments[0] + gxip_dot(g + 3 * i, moments + 1), 1e-12);
    for (i = 0; i < 4; i++)
        for (j = i; j < 4; j++, at++) {
            double expected = (i == 0 && j == 0) * moments[0];
            if (i == 0) expected += gxip_dot(g + 3 * j, moments + 1);
            if (j == 0) expected += gxip_dot(g + 3 * i, moments + 1);
            for (d = 0; d < 3; d++)
                for (e = 0; e < 3; e++) expected += g[3 * i + d] * g[3 * j + e] * moments[4 + gxip_packed3(d, e)];
            ASSERT_NEAR(mass[at], expected, 1e-11);
        }
    assert_semidefinite(mass);
}
END_TEST

/* The two ways to a part's volume, in its frame times 6 V and by its triangles in space, agree with their
   orientation for every k. */
START_TEST(frames_and_space_agree) {
    double x[12], e[3], lambdas[16], matrix[9], positions[12] = {0};
    unsigned k, axes[3], i, j, d;
    gxi_moments2 m, space;
    mesh part;
    seed_random(first_seed() + (uint64_t)_i);
    random_element(x);
    k = (unsigned)_i % 4;
    for (i = 0; i < 3; i++) e[i] = random_between(0.1, 0.9);
    corner_part(k, e, lambdas);
    m = moments_at(lambdas, faces, 4, k);
    gxi_part_axes(k, axes);
    for (i = 0; i < 3; i++)
        for (d = 0; d < 3; d++) matrix[3 * d + i] = x[3 * axes[i] + d] - x[3 * k + d];
    gxi_moments2_map(&m, matrix, x + 3 * k);
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++)
            for (d = 0; d < 3; d++) positions[3 * i + d] += lambdas[4 * i + j] * x[3 * j + d];
    part = make_tetrahedron(positions);
    space = moments2_of(&part, NULL);
    ASSERT_RELATIVE(space.volume, gxi_tet_volume(x) * e[0] * e[1] * e[2], 1e-12);
    assert_moments2(&m, &space, 1e-14, 2);
}
END_TEST

/* ---- arguments ---- */

static gx_result moments2_result(const double *positions, size_t position_count, const uint32_t *triangles,
                                 size_t triangle_count, const double *origin) {
    gxi_surface s;
    gxi_moments2 m, before;
    double moments[30], work[30], one = 42;
    gx_result result;
    size_t i;
    s.positions = positions;
    s.position_count = position_count;
    s.triangles = triangles;
    s.triangle_count = triangle_count;
    memset(&m, 0x2a, sizeof m);
    before = m;
    result = gxi_polyhedron_moments2(&s, origin, &m, NULL);
    for (i = 0; i < 30; i++) moments[i] = work[i] = 42;
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, origin, 2, moments, work, NULL), result);
    ck_assert_int_eq(gxi_surface_monomials(&s, origin, 2, moments, work, NULL), result);
    ck_assert_int_eq(gxi_surface_flux_monomials(&s, origin, 2, moments, work, NULL), result);
    ck_assert_int_eq(gxi_polyhedron_monomial(&s, origin, 0, 2, 0, &one, NULL), result);
    if (result == GX_OK) return result;
    ck_assert_mem_eq(&m, &before, sizeof m);
    for (i = 0; i < 30; i++) ck_assert(moments[i] == 42 && work[i] == 42);
    ck_assert(one == 42);
    return result;
}

START_TEST(bad_surfaces) {
    double p[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, bad_origin[3] = {0, 0, 0}, m[1], w[1];
    const double far[3] = {-DBL_MAX, 0, 0};
    uint32_t t[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    gxi_surface s = {p, 4, t, 4};
    ck_assert_int_eq(moments2_result(p, 4, t, 4, NULL), GX_OK);
    ck_assert_int_eq(moments2_result(NULL, 4, t, 4, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(moments2_result(p, 4, NULL, 4, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(moments2_result(p, 4, t, 0, NULL), GX_ERROR_EMPTY);
    ck_assert_int_eq(moments2_result(p, 0, t, 4, NULL), GX_ERROR_EMPTY);
    ck_assert_int_eq(moments2_result(p, 3, t, 4, NULL), GX_ERROR_INDEX);
    bad_origin[1] = (double)NAN;
    ck_assert_int_eq(moments2_result(p, 4, t, 4, bad_origin), GX_ERROR_NOT_FINITE);
    p[7] = (double)NAN;
    ck_assert_int_eq(moments2_result(p, 4, t, 4, NULL), GX_ERROR_NOT_FINITE);
    p[7] = -(double)INFINITY;
    ck_assert_int_eq(moments2_result(p, 4, t, 4, NULL), GX_ERROR_NOT_FINITE);
    p[7] = 1e100;
    ck_assert_int_eq(moments2_result(p, 4, t, 4, NULL), GX_ERROR_RANGE);
    p[7] = DBL_MAX;
    ck_assert_int_eq(moments2_result(p, 4, t, 4, far), GX_ERROR_RANGE);
    p[7] = 0;
    ck_assert_int_eq(moments2_result(p, 4, t, 4, far), GX_ERROR_RANGE);
    p[7] = 1;
    ck_assert_int_eq(gxi_polyhedron_moments2(NULL, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_polyhedron_moments2(&s, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_polyhedron_monomials(NULL, NULL, 0, m, w, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, 0, NULL, w, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, 0, m, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_polyhedron_monomials(&s, NULL, GXI_DEGREE_MAX + 1, m, w, NULL), GX_ERROR_RANGE);
    ck_assert_int_eq(gxi_polyhedron_monomial(&s, NULL, 0, 0, 0, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_polyhedron_monomial(&s, NULL, (unsigned)-1, 1, 1, m, NULL), GX_ERROR_RANGE);
    ck_assert_int_eq(gxi_polyhedron_monomial(&s, NULL, 200, 200, 200, m, NULL), GX_ERROR_RANGE);
    ck_assert_int_eq(gxi_monomials_translate(0, NULL, m, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_monomials_translate(0, origin0, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_monomials_translate(0, bad_origin, m, NULL), GX_ERROR_NOT_FINITE);
    ck_assert_int_eq(gxi_monomials_translate(GXI_DEGREE_MAX + 1, origin0, m, NULL), GX_ERROR_RANGE);
}
END_TEST

/* The largest accepted coordinates give finite results at every degree. */
START_TEST(accepted_means_finite) {
    double p[12] = {0}, moments[1771], work[1771];
    const unsigned degree = (unsigned)_i;
    uint32_t t[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    gxi_surface s = {p, 4, t, 4};
    gx_result result;
    size_t i;
    int e, accepted = 0, finite = 1;
    for (e = -1000; e < 1020; e += 3) {
        for (i = 0; i < 12; i++) p[i] = ldexp(i % 4 == 0 ? 1 : -0.9, e) * (i % 5 == 2 ? -1 : 1);
        result = gxi_polyhedron_monomials(&s, NULL, degree, moments, work, NULL);
        if (result != GX_OK) break;
        accepted = e;
        for (i = 0; i < gxi_monomial_count(degree); i++)
            finite &= gxip_is_finite(moments[i]) && gxip_is_finite(work[i]);
        ck_assert(finite);
        ck_assert_int_eq(gxi_surface_flux_monomials(&s, NULL, 0, moments, work, NULL), GX_OK);
    }
    ck_assert_int_eq(result, GX_ERROR_RANGE);
    ck_assert_int_ge(accepted + 3, 900 / ((int)degree + 3)); /* not refused without need */
}
END_TEST

START_TEST(bad_elements) {
    const double flat[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, inverted[12] = {0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1};
    double x[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, g[12], before[12], volume = 42;
    int i;
    for (i = 0; i < 12; i++) g[i] = before[i] = 42;
    ck_assert_int_eq(gxi_tet_gradients(NULL, g, &volume), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_tet_gradients(x, NULL, &volume), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_tet_gradients(flat, g, &volume), GX_ERROR_FLAT);
    ck_assert_int_eq(gxi_tet_gradients(inverted, g, &volume), GX_ERROR_INVERTED);
    x[11] = (double)NAN;
    ck_assert_int_eq(gxi_tet_gradients(x, g, &volume), GX_ERROR_NOT_FINITE);
    x[11] = 1e305;
    ck_assert_int_eq(gxi_tet_gradients(x, g, &volume), GX_ERROR_RANGE);
    ck_assert_mem_eq(g, before, sizeof g);
    ck_assert(volume == 42);
    for (i = 0; i < 12; i++) x[i] = (i == 3 || i == 7 || i == 11) ? 1e-120 : 0; /* underflows */
    ck_assert_int_eq(gxi_tet_gradients(x, g, &volume), GX_ERROR_FLAT);
    x[3] = x[7] = ldexp(1, 100);
    x[11] = ldexp(1, -1030); /* whose inverse is no double */
    ck_assert_int_eq(gxi_tet_gradients(x, g, &volume), GX_ERROR_FLAT);
    ck_assert_mem_eq(g, before, sizeof g);
}
END_TEST

START_TEST(bad_parts) {
    double lambdas[16];
    uint32_t triangles[12];
    gxi_moments2 m, before;
    unsigned k = 42;
    size_t i;
    memcpy(lambdas, corners, sizeof corners);
    memcpy(triangles, faces, sizeof faces);
    memset(&m, 0x2a, sizeof m);
    before = m;
    ck_assert_int_eq(gxi_part_moments(NULL, 4, triangles, 4, &k, &m), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, NULL, 4, &k, &m), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 4, NULL, &m), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 4, &k, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments_at(NULL, 4, triangles, 4, 0, &m), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments_at(lambdas, 4, NULL, 4, 0, &m), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments_at(lambdas, 4, triangles, 4, 4, &m), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments_at(lambdas, 4, triangles, 4, 0, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxi_part_moments_at(lambdas, 4, triangles, 0, 0, &m), GX_ERROR_EMPTY);
    ck_assert_int_eq(gxi_part_moments_at(lambdas, 0, triangles, 4, 0, &m), GX_ERROR_EMPTY);
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 0, &k, &m), GX_ERROR_EMPTY);
    ck_assert_int_eq(gxi_part_moments(lambdas, 0, triangles, 4, &k, &m), GX_ERROR_EMPTY);
    triangles[11] = 4;
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 4, &k, &m), GX_ERROR_INDEX);
    triangles[11] = 1;
    lambdas[3] = (double)NAN;
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 4, &k, &m), GX_ERROR_NOT_FINITE);
    lambdas[3] = 1e6;
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 4, &k, &m), GX_ERROR_RANGE);
    ck_assert_int_eq(gxi_part_moments_at(lambdas, 4, triangles, 4, 0, &m), GX_ERROR_RANGE);
    lambdas[3] = 0;
    for (i = 0; i < 16; i++) {
        const double good = lambdas[i];
        lambdas[i] = -1e6;
        ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 4, &k, &m), GX_ERROR_RANGE);
        lambdas[i] = (double)INFINITY;
        ck_assert_int_eq(gxi_part_moments_at(lambdas, 4, triangles, 4, 0, &m), GX_ERROR_NOT_FINITE);
        lambdas[i] = good;
    }
    {
        /* more corners than are counted once each: the third triangle has a bad one, so the fourth is not looked at */
        double many[4 * 100];
        for (i = 0; i < 100; i++) memcpy(many + 4 * i, corners + i % 4 * 4, 4 * sizeof *many);
        ck_assert_int_eq(gxi_part_moments_at(many, 100, triangles, 0, 0, &m), GX_ERROR_EMPTY);
        many[4 * triangles[3] + 2] = (double)NAN;
        ck_assert_int_eq(gxi_part_moments_at(many, 100, triangles, 4, 0, &m), GX_ERROR_NOT_FINITE);
    }
    ck_assert_mem_eq(&m, &before, sizeof m);
    ck_assert_uint_eq(k, 42);
    lambdas[3] = 0; /* inside out: no mass */
    triangles[0] = 2;
    triangles[1] = 1;
    ck_assert_int_eq(gxi_part_moments(lambdas, 4, triangles, 1, &k, &m), GX_OK);
    ck_assert(m.volume >= 0);
}
END_TEST

/* ---- published values, if they are there ---- */

/* Format: vertex count, vertices, face count, faces (count, indices: clockwise from inside). */
static int read_polyhedron(const char *path, mesh *m) {
    FILE *file = fopen(path, "r");
    unsigned vertices, polygons, n, v[16], i, j;
    memset(m, 0, sizeof *m);
    if (!file) return 0;
    ck_assert_int_eq(fscanf(file, "%u", &vertices), 1);
    for (i = 0; i < vertices; i++) {
        double p[3];
        ck_assert_int_eq(fscanf(file, "%lf %lf %lf", &p[0], &p[1], &p[2]), 3);
        add_position(m, p[0], p[1], p[2]);
    }
    ck_assert_int_eq(fscanf(file, "%u", &polygons), 1);
    for (i = 0; i < polygons; i++) {
        ck_assert(fscanf(file, "%u", &n) == 1 && n >= 3 && n <= 16);
        for (j = 0; j < n; j++) ck_assert_int_eq(fscanf(file, "%u", &v[j]), 1);
        for (j = 2; j < n; j++) add_triangle(m, v[0], v[j - 1], v[j]);
    }
    fclose(file);
    return 1;
}

/* The number after "NAME =" in a listing. */
static double listed(const char *text, const char *name) {
    const char *at = strstr(text, name);
    ck_assert_msg(at != NULL, "no %s", name);
    return strtod(strchr(at, '=') + 1, NULL);
}

START_TEST(published_integrals) {
    static const char *const names[3] = {"cube", "icosa", "tetra"};
    static const char *const seconds[6] = {"Txx =", "Txy =", "Tzx =", "Tyy =", "Tyz =", "Tzz ="};
    static const char *const firsts[3] = {"Tx =", "Ty =", "Tz ="};
    const char *data = getenv("GXFEM_DATA");
    char path[1024], text[4096];
    gxi_moments2 r;
    mesh m;
    FILE *file;
    size_t n;
    int i;
    if (!data || strlen(data) > 900) return;
    sprintf(path, "%s/moments/%s", data, names[_i]);
    if (!read_polyhedron(path, &m)) return;
    strcat(path, ".volInt.out");
    file = fopen(path, "r");
    if (!file) return;
    n = fread(text, 1, sizeof text - 1, file);
    text[n] = 0;
    fclose(file);
    r = moments2_of(&m, NULL);
    ASSERT_NEAR(r.volume, listed(text, "T1 ="), 1e-6); /* six decimals are printed */
    for (i = 0; i < 3; i++) ASSERT_NEAR(r.first[i], listed(text, firsts[i]), 1e-6);
    for (i = 0; i < 6; i++) ASSERT_NEAR(r.second[i], listed(text, seconds[i]), 1e-6);
}
END_TEST

static Suite *integrate_suite(void) {
    Suite *suite = suite_create("gxfem_integrate");
    TCase *moments = tcase_create("moments"), *monomials = tcase_create("monomials"),
          *surfaces = tcase_create("surfaces");
    TCase *elements = tcase_create("elements"), *parts = tcase_create("parts"), *arguments = tcase_create("arguments");
    tcase_add_test(moments, ten_integrals_of_cube);
    tcase_add_test(moments, ten_integrals_of_tetrahedron);
    tcase_add_test(moments, ten_integrals_of_icosahedron);
    tcase_add_loop_test(moments, boxes_to_degree_6, 0, 20);
    tcase_add_loop_test(moments, translation_and_map, 0, 20);
    tcase_add_test(moments, disjoint_unions_add);
    tcase_add_loop_test(moments, published_integrals, 0, 3);
    tcase_add_loop_test(monomials, voxel_bodies_to_degree_6, 0, 12);
    tcase_add_test(monomials, far_from_the_origin);
    tcase_add_loop_test(monomials, monomials_translate, 0, 10);
    tcase_add_loop_test(monomials, high_degrees, 0, 25);
    tcase_add_loop_test(monomials, high_degrees, 100, 101);
    tcase_add_loop_test(monomials, high_degrees, GXI_DEGREE_MAX, GXI_DEGREE_MAX + 1);
    tcase_add_test(monomials, counts_and_indices);
    tcase_add_loop_test(surfaces, open_surface_against_gauss, 0, 20);
    tcase_add_loop_test(surfaces, divergence_theorem, 0, 20);
    tcase_add_test(surfaces, areas);
    tcase_add_loop_test(elements, gradients, 0, 50);
    tcase_add_test(elements, whole_element);
    tcase_add_loop_test(parts, slivers_at_a_vertex, 0, 100);
    tcase_add_loop_test(parts, layers_upon_a_face, 1, 19);
    tcase_add_loop_test(parts, split_by_planes, 0, 100);
    tcase_add_loop_test(parts, thin_layers_are_semidefinite, 2, 19);
    tcase_add_loop_test(parts, parts_of_noise, 0, 3);
    tcase_add_loop_test(parts, repair, 0, 125);
    tcase_add_loop_test(parts, cut_faces, 0, 20);
    tcase_add_loop_test(parts, frames_and_space_agree, 0, 40);
    tcase_add_test(arguments, bad_surfaces);
    tcase_add_loop_test(arguments, accepted_means_finite, 0, 21);
    tcase_add_test(arguments, bad_elements);
    tcase_add_test(arguments, bad_parts);
    tcase_set_timeout(monomials, 60);
    suite_add_tcase(suite, moments);
    suite_add_tcase(suite, monomials);
    suite_add_tcase(suite, surfaces);
    suite_add_tcase(suite, elements);
    suite_add_tcase(suite, parts);
    suite_add_tcase(suite, arguments);
    return suite;
}

int main(void) {
    make_gauss();
    return run_suite(integrate_suite());
}
