/* fuzz_blade_cases.h - bodies, displacements and places in space made from bytes, for fuzz_blade.c. Many lie on
   lattices, at nodes and on mesh edges, so that edges of blades pass through them. This file reads the files of
   tests/corpus_blade/, so new kinds must come after the old ones. Include after gxfem.h and fuzz.h. */
#ifndef GXFEM_TESTS_FUZZ_BLADE_CASES_H
#define GXFEM_TESTS_FUZZ_BLADE_CASES_H

#include <math.h>

enum { CASE_NODES = 256, CASE_ELEMENTS = 512 };

typedef struct case_mesh {
    double x[CASE_NODES][3];
    uint32_t t[CASE_ELEMENTS][4], nodes, elements;
    double cube; /* m: the lattice's step */
    int is_flat; /* elements are far thinner than wide */
    double low[3], high[3];
} case_mesh;

/* ---- numbers ---- */

/* From -1 to 1: of two bytes, or one of few values */
static inline double case_real(case_bytes *b) {
    static const double few[8] = {0, 1, -1, 0.5, -0.5, 0.25, 1e-9, 0.3333};
    const uint32_t v = case_take(b);
    return v < 8 ? few[v] : (v * 256.0 + case_take(b) - 33791.5) / 31743.5;
}

/* From -1 to 1, of its own for each of two numbers */
static inline double case_noise(uint32_t seed, size_t i, uint32_t k) {
    uint64_t z = ((uint64_t)seed << 40 ^ (uint64_t)i << 8 ^ k) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return ldexp((double)(int64_t)(z ^ z >> 31), -63);
}

/* Turns about an axis through a point */
static inline void case_turn(double x[3], const double about[3], uint32_t axis, double angle) {
    const uint32_t i = axis % 3, j = (axis + 1) % 3;
    const double c = cos(angle), s = sin(angle), u = x[i] - about[i], v = x[j] - about[j];
    x[i] = about[i] + c * u - s * v;
    x[j] = about[j] + s * u + c * v;
}

/* ---- meshes ---- */

static inline double case_volume(const case_mesh *m, const uint32_t *t) {
    double e[3][3];
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) e[i][k] = m->x[t[i + 1]][k] - m->x[t[0]][k];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static inline void case_element(case_mesh *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    uint32_t *t = m->t[m->elements];
    if (m->elements == CASE_ELEMENTS) return;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    t[3] = d;
    if (case_volume(m, t) < 0) {
        t[0] = b;
        t[1] = a;
    }
    m->elements++;
}

/* Cubes of five or six tetrahedra each, from a corner on. left_out: seed of elements that are left out, 0: none */
static inline void case_lattice(case_mesh *m, const uint32_t n[3], int tets, const double from[3], uint32_t left_out) {
    static const uint32_t five[5][4] = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}},
                          six[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                                       {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};
    const uint32_t first = m->nodes;
    uint32_t at[3], k, e;
    for (at[2] = 0; at[2] <= n[2]; at[2]++)
        for (at[1] = 0; at[1] <= n[1]; at[1]++)
            for (at[0] = 0; at[0] <= n[0]; at[0]++, m->nodes++)
                for (k = 0; k < 3; k++) m->x[m->nodes][k] = from[k] + at[k];
    for (at[2] = 0; at[2] < n[2]; at[2]++)
        for (at[1] = 0; at[1] < n[1]; at[1]++)
            for (at[0] = 0; at[0] < n[0]; at[0]++)
                for (e = 0; e < (uint32_t)tets; e++) {
                    const uint32_t flip = tets == 5 && (at[0] + at[1] + at[2]) % 2 ? 7 : 0;
                    uint32_t v[4];
                    for (k = 0; k < 4; k++) {
                        const uint32_t corner = tets == 5 ? five[e][k] ^ flip : six[e][k];
                        v[k] = first + at[0] + (corner & 1) +
                               (n[0] + 1) * (at[1] + (corner >> 1 & 1) + (n[1] + 1) * (at[2] + (corner >> 2)));
                    }
                    if (left_out != 0 && case_noise(left_out, m->elements + m->t[0][0], v[3] + v[1]) > 0.2) continue;
                    case_element(m, v[0], v[1], v[2], v[3]);
                }
}

/* Keeps the elements around a node. */
static inline void case_keep_star(case_mesh *m, uint32_t node) {
    uint32_t i, n = 0;
    for (i = 0; i < m->elements; i++) {
        const uint32_t *t = m->t[i];
        if (t[0] != node && t[1] != node && t[2] != node && t[3] != node) continue;
        memmove(m->t[n++], t, sizeof m->t[0]);
    }
    m->elements = n;
}

/* Another size, another place, another direction */
static inline void case_change_mesh(case_mesh *m, uint32_t how, uint32_t seed) {
    static const double sizes[8] = {1, 1, 1, 1, 1048576, 0.00000095367431640625, 1e6, 1e-6}, zero[3] = {0, 0, 0};
    const double size = sizes[how % 8], far = how / 8 % 8 == 0 ? 1e6 : 0;
    uint32_t i, k;
    for (i = 0; i < m->nodes; i++) {
        double *x = m->x[i];
        switch (how / 64) {
        case 1:
            for (k = 0; k < 3; k++) x[k] += 0.12 * case_noise(seed, i, k);
            break;
        case 2: case_turn(x, zero, seed, 0.1 + 0.02 * seed); break;
        case 3: x[seed % 3] *= seed % 5 == 0 ? 1e-3 : seed % 5 == 1 ? 1e-6 : 0.5 + 0.2 * x[seed % 3]; break;
        default: break;
        }
        for (k = 0; k < 3; k++) {
            x[k] = size * (x[k] + far * (k + 1));
            m->low[k] = i == 0 || x[k] < m->low[k] ? x[k] : m->low[k];
            m->high[k] = i == 0 || x[k] > m->high[k] ? x[k] : m->high[k];
        }
    }
    m->cube = size;
    m->is_flat = how / 64 == 3 && seed % 5 < 2;
}

static inline void case_make_mesh(case_bytes *b, case_mesh *m) {
    static const double zero[3] = {0, 0, 0};
    const uint32_t kind = case_take(b), sizes = case_take(b), how = case_take(b), seed = case_take(b);
    const int tets = kind / 8 % 2 ? 5 : 6;
    uint32_t n[3], k;
    double beside[3] = {0, 0, 0};
    for (k = 0; k < 3; k++) n[k] = 1 + (sizes >> (2 * k) & 3);
    m->nodes = m->elements = 0;
    switch (kind % 8) {
    case 0: /* one tetrahedron */
        n[0] = n[1] = n[2] = 1;
        case_lattice(m, n, tets, zero, 0);
        m->elements = 1;
        break;
    case 1: /* around a node */
        n[0] = n[1] = n[2] = 2;
        case_lattice(m, n, tets, zero, 0);
        case_keep_star(m, 13);
        break;
    case 2: case_lattice(m, n, tets, zero, 1 + seed); break;
    case 3: /* two blocks, beside or in each other */
        n[2] = 1;
        case_lattice(m, n, tets, zero, 0);
        beside[seed % 3] = seed / 3 % 4 == 0 ? 0.37 : n[seed % 3] + (seed / 3 % 4 == 1 ? 0 : 0.3);
        case_lattice(m, n, tets, beside, 0);
        break;
    default: case_lattice(m, n, tets, zero, 0); break;
    }
    case_change_mesh(m, how, seed);
}

/* ---- displacements ---- */

typedef struct case_pose {
    uint32_t kind, seed;
    double strength, way[3]; /* 0 ... 1; each -1 ... 1 */
} case_pose;

static inline case_pose case_make_pose(case_bytes *b) {
    case_pose p;
    int k;
    p.kind = case_take(b);
    p.seed = case_take(b);
    p.strength = fabs(case_real(b));
    for (k = 0; k < 3; k++) p.way[k] = p.kind / 32 % 2 ? case_real(b) : case_noise(p.seed, 7, (uint32_t)k);
    return p;
}

/* Beyond what bodies may be moved, now and then */
static inline double case_wild(uint32_t seed) {
    return seed % 4 == 0 ? NAN : seed % 4 == 1 ? -INFINITY : seed % 4 == 2 ? 1e39 : 1e300;
}

/* u: the displacement of copy i, of a node at x, in fragment f; it has the one before. */
static inline void case_displace(const case_mesh *m, const case_pose *p, const double *x, size_t i, uint32_t f,
                                 const double *fragment_center, double *u) {
    static const double factors[6] = {0, 1e-4, 1e-9, -1, 3, 0.2};
    const double s = p->strength * m->cube;
    double middle[3], to[3];
    uint32_t k;
    for (k = 0; k < 3; k++) middle[k] = 0.5 * (m->low[k] + m->high[k]);
    memcpy(to, x, sizeof to);
    switch (p->kind % 16) {
    case 0: break; /* at rest */
    case 1:        /* waves, calm to violent */
        for (k = 0; k < 3; k++)
            to[k] += s * (p->seed % 2 ? 2 : 0.3) * p->way[k] * sin(2 * (x[0] + x[1] + x[2]) / m->cube + p->seed);
        break;
    case 2:
        for (k = 0; k < 3; k++) to[k] += 3 * s * p->way[k];
        break;
    case 3: case_turn(to, middle, p->seed, 7 * p->strength); break;
    case 4: /* noise */
        for (k = 0; k < 3; k++) to[k] += s * (p->seed % 4 ? 0.1 : 2) * case_noise(p->seed, i, k);
        break;
    case 5: to[p->seed % 3] = middle[p->seed % 3] - (x[p->seed % 3] - middle[p->seed % 3]); break; /* inside out */
    case 6: /* flat, or squeezed */
        for (k = 0; k < 3; k++)
            if (p->seed >> k & 1) to[k] = middle[k] + factors[p->seed / 8 % 6] * (x[k] - middle[k]);
        break;
    case 7: /* huge */
        for (k = 0; k < 3; k++)
            to[k] += (p->seed % 3 == 0   ? 1e30
                      : p->seed % 3 == 1 ? 1e10
                                         : 1e20) *
                     m->cube * p->way[k] * (p->seed & 8 ? 1 : case_noise(p->seed, i, k));
        break;
    case 8: /* fragments over each other */
        for (k = 0; k < 3; k++) to[k] += middle[k] - fragment_center[k] + 0.1 * s * p->way[k];
        break;
    case 9: /* by a step of the lattice */
        if (f % 2) to[p->seed % 3] += m->cube;
        break;
    case 10: /* folded */
        k = p->seed % 3;
        to[k] = middle[k] + fabs(x[k] - middle[k]) + 0.1 * s * (x[(k + 1) % 3] - middle[(k + 1) % 3]) / m->cube;
        break;
    case 11: /* on from where it is */
        for (k = 0; k < 3; k++) to[k] = x[k] + u[k] + 0.3 * s * p->way[k];
        break;
    case 12: /* one copy only */
        for (k = 0; k < 3; k++) to[k] = x[k] + u[k] + (i == p->seed ? s * p->way[k] : 0);
        break;
    case 13:
        if (p->seed % 8 == 0) to[0] = i % 16 == p->seed / 8 % 16 ? case_wild(p->seed / 64) : x[0];
        break;
    default: /* swings and noise */
        for (k = 0; k < 3; k++)
            to[k] +=
                s * p->way[k] * sin(x[(k + 1) % 3] / m->cube + p->seed) + 0.02 * m->cube * case_noise(p->seed, i, k);
        break;
    }
    for (k = 0; k < 3; k++) u[k] = to[k] - x[k];
}

#endif /* GXFEM_TESTS_FUZZ_BLADE_CASES_H */
