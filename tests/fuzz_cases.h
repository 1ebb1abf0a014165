/* fuzz_cases.h - cases made from bytes: operands of Booleans, tetrahedra with the triangles that cut them.

   Shapes lie on a lattice of a few steps, so that points, edges and planes coincide. A style then moves them: by
   rounding, by units of the last place, by powers of two, far away. This file reads the files of tests/corpus/, so
   new kinds must come after the old ones. */
#ifndef GXFEM_TESTS_FUZZ_CASES_H
#define GXFEM_TESTS_FUZZ_CASES_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "case_bytes.h"

enum { CASE_BYTES = 96 }; /* of a random case */
enum { CASE_VERTICES = 160, CASE_TRIANGLES = 160, CASE_OPERANDS = 5, CASE_SHEETS = 8 };

typedef struct case_mesh {
    double x[CASE_VERTICES][3];
    uint32_t t[CASE_TRIANGLES][3], vertices, triangles;
} case_mesh;

typedef struct case_operand {
    case_mesh mesh;
    uint32_t operation, rule;
} case_operand;

enum {
    CHECK_VOLUMES,
    CHECK_SAMENESS,
    CHECK_RULES,
    CHECK_PROVENANCE,
    CHECK_AGAIN,
    CHECK_MENDING,
    CHECK_NOTHING,
    CHECK_MEMORY,
    CHECKS
};

typedef struct test_case {
    /* 1: operand[0].mesh is the boundary of the tetrahedra, the others are sheets */
    int complex;
    uint32_t number;               /* any, of the bytes */
    int style, fine, small, check; /* small: of tetrahedra; check: what else is checked, CHECK_VOLUMES ... */
    case_operand operand[CASE_OPERANDS + CASE_SHEETS];
    size_t operands;
    double nodes[8][3];
    uint32_t elements[6][4], node_count, element_count;
} test_case;

/* ---- meshes ---- */

static inline uint32_t case_vertex(case_mesh *m, double x, double y, double z) {
    double *p = m->x[m->vertices < CASE_VERTICES - 1 ? m->vertices : CASE_VERTICES - 1];
    p[0] = x;
    p[1] = y;
    p[2] = z;
    if (m->vertices < CASE_VERTICES - 1) m->vertices++;
    return m->vertices - 1;
}

static inline void case_triangle(case_mesh *m, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *t = m->t[m->triangles];
    if (m->triangles == CASE_TRIANGLES) return;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    m->triangles++;
}

/* The boundary of the tetrahedron, outward if abcd turns as 0, x, y, z do */
static inline void case_tetrahedron(case_mesh *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    case_triangle(m, b, c, d);
    case_triangle(m, a, d, c);
    case_triangle(m, a, b, d);
    case_triangle(m, a, c, b);
}

/* Twice the polygon (counter-clockwise from above), at two heights, with a wall between: the floors are fans around
 * their vertex 0 */
static inline void case_prism(case_mesh *m, const double (*xy)[2], uint32_t n, double low, double high) {
    const uint32_t first = m->vertices;
    uint32_t i;
    for (i = 0; i < n; i++) case_vertex(m, xy[i][0], xy[i][1], low);
    for (i = 0; i < n; i++) case_vertex(m, xy[i][0], xy[i][1], high);
    for (i = 2; i < n; i++) {
        case_triangle(m, first, first + i, first + i - 1);
        case_triangle(m, first + n, first + n + i - 1, first + n + i);
    }
    for (i = 0; i < n; i++) {
        const uint32_t a = first + i, b = first + (i + 1) % n;
        case_triangle(m, a, b, b + n);
        case_triangle(m, a, b + n, a + n);
    }
}

static inline void case_box(case_mesh *m, const double low[3], const double high[3]) {
    double xy[4][2];
    xy[0][0] = xy[3][0] = low[0];
    xy[1][0] = xy[2][0] = high[0];
    xy[0][1] = xy[1][1] = low[1];
    xy[2][1] = xy[3][1] = high[1];
    case_prism(m, (const double(*)[2])xy, 4, low[2], high[2]);
}

/* ---- shapes ---- */

static inline double case_lattice(case_bytes *b) { return (double)case_below(b, 5); }

/* Low corner and size of a box in two bytes and a half */
static inline void case_range(case_bytes *b, double *low, double *high) {
    const uint32_t v = case_take(b);
    *low = v % 4;
    *high = *low + 1 + v / 4 % 3;
}

static inline void case_random_box(case_bytes *b, case_mesh *m) {
    double low[3], high[3];
    int k;
    for (k = 0; k < 3; k++) case_range(b, &low[k], &high[k]);
    case_box(m, low, high);
}

static inline uint32_t case_random_vertex(case_bytes *b, case_mesh *m) {
    const uint32_t v = case_take(b);
    return case_vertex(m, v % 5, v / 5 % 5, v / 25 % 5);
}

static inline void case_random_tetrahedron(case_bytes *b, case_mesh *m) {
    uint32_t n[4], i;
    for (i = 0; i < 4; i++) n[i] = case_random_vertex(b, m);
    case_tetrahedron(m, n[0], n[1], n[2], n[3]);
}

/* Boundaries of tetrahedra between five or six points: they share corners, edges and triangles, wind forth and back,
 * may be flat */
static inline void case_random_pool(case_bytes *b, case_mesh *m) {
    const uint32_t head = case_take(b), points = 5 + head % 2, tets = 2 + head / 2 % 3;
    const uint32_t first = m->vertices;
    uint32_t i;
    for (i = 0; i < points; i++) case_random_vertex(b, m);
    for (i = 0; i < tets; i++) {
        const uint32_t v = case_take(b), w = case_take(b);
        case_tetrahedron(m, first + v % points, first + v / 16 % points, first + w % points, first + w / 16 % points);
    }
}

/* Two cones over an octagon in a plane; one apex may lie in it: a coplanar fan */
static inline void case_random_fan(case_bytes *b, case_mesh *m) {
    static const double octagon[8][2] = {{1, 0}, {3, 0}, {4, 1}, {4, 3}, {3, 4}, {1, 4}, {0, 3}, {0, 1}};
    const uint32_t head = case_take(b), place = case_take(b), first = m->vertices;
    uint32_t n = 0, i, up, down;
    for (i = 0; i < 8; i++)
        if (head >> i & 1 || n + 7 - i < 2) {
            case_vertex(m, octagon[i][0], octagon[i][1], place % 4);
            n++;
        }
    up = case_vertex(m, 1 + place / 4 % 3, 2, 4);
    down = case_vertex(m, 2, 1 + place / 16 % 3, place / 64 == 0 ? place % 4 : -(double)(place / 64));
    for (i = 0; i < n; i++) {
        case_triangle(m, first + i, first + (i + 1) % n, up);
        case_triangle(m, first + (i + 1) % n, first + i, down);
    }
}

/* An L: six walls, floors of four triangles that are not all convex together */
static inline void case_random_corner(case_bytes *b, case_mesh *m) {
    static const double corner[6][2] = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
    const uint32_t head = case_take(b);
    double xy[6][2], low, high;
    uint32_t i;
    case_range(b, &low, &high);
    for (i = 0; i < 6; i++) {
        xy[i][0] = corner[(i + 3) % 6][0] + head % 3;
        xy[i][1] = corner[(i + 3) % 6][1] + head / 4 % 3;
    }
    case_prism(m, (const double(*)[2])xy, 6, low, high); /* the fans begin at the inner corner */
}

/* A box with a hole through it */
static inline void case_random_ring(case_bytes *b, case_mesh *m) {
    const uint32_t head = case_take(b), first = m->vertices;
    const double size = 3 + head % 3, in = 1 + head / 4 % 2 * 0.5, out = size - 1;
    double low, high;
    uint32_t i, k;
    case_range(b, &low, &high);
    for (k = 0; k < 4; k++)
        for (i = 0; i < 4; i++) { /* outer low, outer high, inner low, inner high */
            const double p = k < 2 ? 0 : in, q = k < 2 ? size : out;
            case_vertex(m, i == 0 || i == 3 ? p : q, i < 2 ? p : q, k % 2 == 0 ? low : high);
        }
    for (i = 0; i < 4; i++) {
        const uint32_t a = first + i, j = first + (i + 1) % 4;
        /* outside */
        case_triangle(m, a, j, j + 4);
        case_triangle(m, a, j + 4, a + 4);
        /* in the hole */
        case_triangle(m, j + 8, a + 8, a + 12);
        case_triangle(m, j + 8, a + 12, j + 12);
        /* above */
        case_triangle(m, a + 4, j + 4, j + 12);
        case_triangle(m, a + 4, j + 12, a + 12);
        /* below */
        case_triangle(m, j, a, a + 8);
        case_triangle(m, j, a + 8, j + 8);
    }
}

/* A slab of thickness 2^-10 ... 2^-52 through the lattice */
static inline void case_random_slab(case_bytes *b, case_mesh *m) {
    const uint32_t head = case_take(b), axis = head % 3;
    double low[3], high[3];
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = -1 + (double)(head >> 6 & 1);
        high[k] = 5 - (double)(head >> 7);
    }
    low[axis] = case_lattice(b);
    high[axis] = low[axis] + ldexp(1, -10 - (int)(head / 3 % 7) * 7);
    case_box(m, low, high);
}

/* Triangles of lattice points, one or several that share corners: a sheet */
static inline void case_random_sheet(case_bytes *b, case_mesh *m) {
    const uint32_t head = case_take(b), points = 3 + head % 4, triangles = 1 + head / 4 % 4, first = m->vertices;
    uint32_t i;
    for (i = 0; i < points; i++) case_random_vertex(b, m);
    for (i = 0; i < triangles; i++) {
        const uint32_t v = i == 0 ? 0x21 * 16 : case_take(b) * 16 + case_take(b);
        case_triangle(m, first + v % 16 % points, first + v / 16 % 16 % points, first + v / 256 % 16 % points);
    }
}

/* The sides of a cube, each a square of two triangles with its own diagonal */
static inline void case_random_cube(case_bytes *b, case_mesh *m) {
    static const uint32_t side[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const uint32_t head = case_take(b), first = m->vertices;
    double low[3], high[3];
    uint32_t i, k;
    for (k = 0; k < 3; k++) case_range(b, &low[k], &high[k]);
    for (i = 0; i < 8; i++)
        case_vertex(m, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
    for (i = 0; i < 6; i++) {
        const uint32_t turn = head >> i & 1;
        case_triangle(m, first + side[i][turn], first + side[i][turn + 1], first + side[i][turn + 2]);
        case_triangle(m, first + side[i][turn], first + side[i][turn + 2], first + side[i][(turn + 3) % 4]);
    }
}

static inline void case_reverse(case_mesh *m) {
    uint32_t i, t;
    for (i = 0; i < m->triangles; i++) {
        t = m->t[i][1];
        m->t[i][1] = m->t[i][2];
        m->t[i][2] = t;
    }
}

/* All triangles once more, reversed or not */
static inline void case_double(case_mesh *m, uint32_t n, int reversed) {
    uint32_t i;
    if (m->triangles + n > CASE_TRIANGLES) return;
    for (i = 0; i < n; i++)
        if (reversed)
            case_triangle(m, m->t[i][0], m->t[i][2], m->t[i][1]);
        else
            case_triangle(m, m->t[i][1], m->t[i][2], m->t[i][0]);
}

/* Each triangle gets vertices of its own. */
static inline void case_explode(case_mesh *m) {
    const uint32_t old = m->vertices;
    uint32_t i, k;
    if (old + 3 * m->triangles >= CASE_VERTICES) return;
    for (i = 0; i < m->triangles; i++)
        for (k = 0; k < 3; k++) {
            const double *x = m->x[m->t[i][k]];
            m->t[i][k] = case_vertex(m, x[0], x[1], x[2]);
        }
}

/* A flap without thickness, or a triangle without area and its reverse */
static inline void case_flap(case_bytes *b, case_mesh *m) {
    const uint32_t head = case_take(b), i = case_random_vertex(b, m), j = case_random_vertex(b, m),
                   k = head & 1 ? i : case_random_vertex(b, m);
    case_triangle(m, i, j, k);
    case_triangle(m, i, k, j);
}

/* Boxes within boxes, every other one inside out: shells in cavities; one may be left out, two may touch */
static inline void case_random_nest(case_bytes *b, case_mesh *m) {
    const uint32_t head = case_take(b), boxes = 3 + head % 4;
    double low[3], high[3];
    uint32_t i, k, n, swap;
    for (i = 0; i < boxes; i++) {
        if (i > 0 && head / 4 % 8 == i) continue;
        for (k = 0; k < 3; k++) {
            low[k] = 0.25 * i + (head >> 5 == i ? 0.25 : 0);
            high[k] = 4 - 0.25 * i - (head >> 6 == i ? 0.25 : 0);
        }
        n = m->triangles;
        case_box(m, low, high);
        for (; i % 2 == 1 && n < m->triangles; n++) {
            swap = m->t[n][1];
            m->t[n][1] = m->t[n][2];
            m->t[n][2] = swap;
        }
    }
}

static inline void case_shape(case_bytes *b, case_mesh *m, uint32_t kind) {
    switch (kind % 13) {
    case 0: case_random_box(b, m); break;
    case 1: case_random_tetrahedron(b, m); break;
    case 2: case_random_pool(b, m); break;
    case 3: case_random_fan(b, m); break;
    case 4: case_random_corner(b, m); break;
    case 5: case_random_ring(b, m); break;
    case 6: case_random_slab(b, m); break;
    case 7:
        case_random_box(b, m);
        case_random_box(b, m);
        break;
    case 8:
        case_random_tetrahedron(b, m);
        case_random_tetrahedron(b, m);
        break;
    case 9:
        case_random_box(b, m);
        case_random_tetrahedron(b, m);
        break;
    case 10: case_random_cube(b, m); break;
    case 11: case_random_nest(b, m); break;
    default:
        case_random_tetrahedron(b, m);
        case_flap(b, m);
        break;
    }
}

/* ---- styles: changes of coordinates ---- */

enum { CASE_STYLES = 12 };

/* A random number of its own kind for each coordinate, the same for equal coordinates of one vertex index */
static inline double case_noise(uint32_t seed, uint32_t i, uint32_t k) {
    uint64_t z = ((uint64_t)seed << 40 ^ (uint64_t)i << 8 ^ k) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)(int64_t)(z ^ z >> 31) * 0x1p-63;
}

static inline void case_rotate(double x[3]) {
    /* clang-format off */
    static const double u[3][3] = { { 0.47523587899288111, -0.25733487792712967, -0.84138553583960118 },
                                    { 0.45209269603286439, 0.89180121216348063, -0.017400924615736224 },
                                    { 0.75482650557038566, -0.37211471159573328, 0.54015515169479278 } };
    /* clang-format on */
    double y[3];
    int k;
    for (k = 0; k < 3; k++) y[k] = u[k][0] * x[0] + u[k][1] * x[1] + u[k][2] * x[2] + 0.17 * k;
    for (k = 0; k < 3; k++) x[k] = y[k];
}

static inline void case_move(double x[3], int style, uint32_t seed, uint32_t i) {
    int k;
    switch (style) {
    case 1:
    case 2: case_rotate(x); break;
    case 3:
        for (k = 0; k < 3; k++) x[k] *= 1 + floor(2.99 * case_noise(seed, i, (uint32_t)k)) * 0x1p-52;
        break;
    case 4:
        case_rotate(x);
        for (k = 0; k < 3; k++) x[k] += case_noise(seed, i, (uint32_t)k) * 0x1p-40;
        break;
    case 5:
        for (k = 0; k < 3; k++) x[k] += case_noise(seed, i, (uint32_t)k);
        break;
    case 6:
        x[0] *= 0x1p-40;
        x[2] *= 0x1p30;
        break;
    case 7:
        for (k = 0; k < 3; k++) x[k] = (x[k] - 2) * 0.3;
        break;
    case 8:
        for (k = 0; k < 3; k++) x[k] = ldexp(x[k], -100);
        break;
    case 9:
        for (k = 0; k < 3; k++) x[k] = ldexp(x[k] + case_noise(seed, i, (uint32_t)k) * 0x1p-50, 110);
        break;
    case 10:
        case_rotate(x);
        for (k = 0; k < 3; k++) x[k] += 0x1p40;
        break;
    case 11:
        x[0] += 0.1 * x[1];
        x[1] += 0.3 * x[2];
        break;
    default: break;
    }
}

static inline void case_style(case_mesh *m, int style, uint32_t seed) {
    uint32_t i;
    for (i = 0; i < m->vertices; i++) case_move(m->x[i], style, seed, i);
}

/* ---- whole cases ---- */

/* Bad input, now and then, for which an operand must be refused */
static inline void case_spoil(case_bytes *b, case_mesh *m) {
    const uint32_t what = case_take(b), i = case_take(b);
    if (m->vertices == 0 || m->triangles == 0) return;
    switch (what % 8) {
    case 0: m->x[i % m->vertices][i % 3] = NAN; break;
    case 1: m->x[i % m->vertices][i % 3] = -INFINITY; break;
    case 2: m->x[i % m->vertices][i % 3] = 1e300; break;
    case 3: m->x[i % m->vertices][i % 3] = 4e-320; break;
    case 4: m->t[i % m->triangles][i % 3] = m->vertices + i; break;
    case 5: m->triangles--; break;
    case 6: case_triangle(m, m->t[i % m->triangles][0], m->t[i % m->triangles][2], m->t[i % m->triangles][1]); break;
    default: m->triangles = 0; break;
    }
}

static inline void case_operand_of(case_bytes *b, test_case *c) {
    case_operand *o = &c->operand[c->operands];
    const uint32_t head = case_take(b), more = case_take(b);
    const size_t i = c->operands++;
    uint32_t n;
    memset(&o->mesh, 0, sizeof o->mesh);
    o->operation = i == 0 ? (uint32_t)(head / 16 % 16 == 15 ? 4 : 0) : head / 16 % 16 < 15 ? head / 16 % 5 : 0;
    o->rule = more % 8 < 5 ? 0 : more % 8 - 4;
    /* like an earlier operand: the same, turned inside out, or a little beside it */
    if (head % 16 >= 14 && i > 0) {
        o->mesh = c->operand[more / 8 % i].mesh;
        if (head % 16 == 15) {
            const uint32_t seed = case_take(b);
            case_style(&o->mesh, seed & 1 ? 3 : 4, seed);
        }
        if (more & 128) case_reverse(&o->mesh);
        return;
    }
    if (o->operation == 4 && head % 2 == 0)
        case_random_sheet(b, &o->mesh);
    else
        case_shape(b, &o->mesh, c->small ? 1 + (head % 16) / 8 : head % 16);
    n = o->mesh.triangles;
    switch (more / 8 % 16) {
    case 0: case_reverse(&o->mesh); break;
    case 1: case_double(&o->mesh, n, 0); break;
    case 2:
        case_double(&o->mesh, n / 2, 1);
        case_double(&o->mesh, n / 2, 0);
        break;
    case 3: case_explode(&o->mesh); break;
    case 4: case_shape(b, &o->mesh, case_take(b)); break;
    case 5:
        if (case_below(b, 4) == 0) case_spoil(b, &o->mesh);
        break;
    default: break;
    }
    case_style(&o->mesh, c->style, more / 128 + 2 * (uint32_t)i);
}

static inline double case_volume(const test_case *c, const uint32_t *n) {
    double u[3][3];
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) u[i][k] = c->nodes[n[i + 1]][k] - c->nodes[n[0]][k];
    return u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) - u[0][1] * (u[1][0] * u[2][2] - u[1][2] * u[2][0]) +
           u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]);
}

/* A tetrahedron, or the five or six of a cube, as a mesh and as its boundary */
static inline void case_body(case_bytes *b, test_case *c) {
    static const uint32_t five[5][4] = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
    static const uint32_t paths[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
    const uint32_t head = case_take(b), kind = head % 4;
    case_mesh *m = &c->operand[0].mesh;
    uint32_t i, k, swap;
    memset(m, 0, sizeof *m);
    c->operand[0].operation = c->operand[0].rule = 0;
    c->operands = 1;
    c->node_count = kind < 2 ? 4 : 8;
    for (i = 0; i < c->node_count; i++) {
        const uint32_t v = kind < 2 ? case_take(b) : 0;
        double *x = c->nodes[i];
        x[0] = kind < 2 ? v % 5 : 1 + 2.0 * (i & 1);
        x[1] = kind < 2 ? v / 5 % 5 : 1 + (i & 2);
        x[2] = kind < 2 ? v / 25 % 5 : 0.5 + 0.75 * (i & 4);
        case_move(x, c->style, head / 4, i);
        case_vertex(m, x[0], x[1], x[2]);
    }
    c->element_count = kind < 2 ? 1 : kind == 2 ? 5 : 6;
    for (i = 0; i < c->element_count; i++) {
        uint32_t *n = c->elements[i];
        for (k = 0; k < 4; k++)
            n[k] = kind < 2 ? k : kind == 2 ? five[i][k] : k == 0 ? 0 : k == 3 ? 7 : paths[i][k - 1];
        if (case_volume(c, n) < 0) {
            swap = n[0];
            n[0] = n[1];
            n[1] = swap;
        }
        case_tetrahedron(m, n[0], n[1], n[2], n[3]);
    }
}

/* The corners of the sheets' triangles, several of which may be the body's nodes or points of earlier triangles. */
static inline void case_cuts(case_bytes *b, test_case *c) {
    const uint32_t cuts = 1 + case_below(b, CASE_SHEETS);
    uint32_t i, k;
    for (i = 0; i < cuts; i++) {
        case_operand *o = &c->operand[c->operands++];
        memset(&o->mesh, 0, sizeof o->mesh);
        o->operation = 4;
        o->rule = 0;
        for (k = 0; k < 3; k++) {
            const uint32_t v = case_take(b), how = case_take(b);
            double x[3];
            x[0] = v % 5 * 1.5 - 1;
            x[1] = v / 5 % 5 * 1.5 - 1;
            x[2] = v / 25 % 5 * 1.5 - 1;
            case_move(x, c->style, i, k);
            if (how % 4 == 0) memcpy(x, c->nodes[how / 4 % c->node_count], sizeof x);
            if (how % 4 == 1 && i > 0) memcpy(x, c->operand[1 + how / 4 % i].mesh.x[k], sizeof x);
            case_vertex(&o->mesh, x[0], x[1], x[2]);
        }
        case_triangle(&o->mesh, 0, 1, 2);
    }
}

static inline void case_decode(const uint8_t *data, size_t size, test_case *c) {
    case_bytes b = {NULL, 0, 0};
    uint32_t head, operands, check;
    b.data = data;
    b.size = size;
    for (c->number = 0; b.at < size; b.at++) c->number = c->number * 31 + data[b.at];
    b.at = 0;
    head = case_take(&b);
    c->style = (int)case_below(&b, CASE_STYLES);
    check = case_take(&b);
    c->check = (int)(check % CHECKS);
    c->small = check / 8 % 4 != 0;
    c->fine = (head >> 3 & 3) == 0 && check / 128 == 0;
    c->complex = head % 8 == 7;
    c->operands = 0;
    if (c->complex) {
        case_body(&b, c);
        case_cuts(&b, c);
        return;
    }
    for (operands = 1 + (head / 32 < 6 ? 1 : head / 32 - 5 + (head >> 3 & 1)) + (head / 32 == 7); operands > 0;
         operands--)
        case_operand_of(&b, c);
}

#endif /* GXFEM_TESTS_FUZZ_CASES_H */
