/* local.h - XPBD and VBD, the local solvers that games use, on the copies and parts of elements of a gxs_model.

   Baselines of the bench, as published, in single precision, 16 constraints or copies of a colour side by side:
       XPBD  [Macklin and Mueller 2021, A Constraint-based Formulation of Stable Neo-Hookean Materials]: substeps of
             one pass over the elements. An element's deviatoric and hydrostatic constraints are solved together. Its
             energy is mu/2 (Ic - 3) - mu (J - 1) + lambda/2 (J - 1)^2: local_xpbd_energy
       VBD   [Chen, Liu, Yang, Yuksel 2024, Vertex Block Descent]: a Newton step for one copy after the other on
             backward Euler's potential with the library's energy; adaptive start; Chebyshev's method as published, or
             over sweeps forward and back, which have real eigenvalues
   Mass is lumped. Materials: GXS_STABLE_NEO_HOOKEAN without damping of its own. Copies that follow others in the
   library move freely here. Vectors are four floats a copy, the last one 0. Include after gxfem_solve.h. Out of memory
   ends the program. */
#ifndef GXFEM_BENCH_LOCAL_H
#define GXFEM_BENCH_LOCAL_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

#define LOCAL_LANES 16
/* Colours at most: 128 sets of elements or copies that share nothing */
#define LOCAL_COLORS 128

/* Passed by pointer only: by value they have another ABI with other instruction sets, of which gcc warns. */
typedef float local_lanes __attribute__((vector_size(4 * LOCAL_LANES)));

#define LOCAL_INLINE static inline __attribute__((always_inline))

/* What both methods know of a body. fixed: held, or without mass */
typedef struct local_body {
    size_t count;   /* of copies */
    double *mass;   /* count: row sums, kg */
    uint8_t *fixed; /* count */
    float *u, *v;   /* count x 4: displacement, m, and velocity, m/s */
    float *start;   /* count x 4: u before the step */
} local_body;

static inline void *local_memory(size_t count, size_t size) {
    const size_t bytes = (count * size + 63) / 64 * 64 + 64;
    char *raw = (char *)calloc(bytes + 64, 1);
    char *aligned;
    if (!raw) {
        fprintf(stderr, "local.h: out of memory\n");
        exit(1);
    }
    aligned = raw + (64 - (uintptr_t)raw % 64); /* 1 to 64 bytes on: room for the offset */
    aligned[-1] = (char)(aligned - raw);
    return aligned;
}

static inline void local_free(void *memory) {
    if (memory) free((char *)memory - ((const char *)memory)[-1]);
}

/* Lumped masses; held copies and copies without mass do not move. */
static inline void local_body_make(local_body *b, const gxs_model *model) {
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    size_t i;
    int c, j;
    b->count = model->copy_count;
    b->mass = (double *)local_memory(b->count, sizeof(double));
    b->fixed = (uint8_t *)local_memory(b->count, 1);
    b->u = (float *)local_memory(4 * b->count + 4, sizeof(float));
    b->v = (float *)local_memory(4 * b->count + 4, sizeof(float));
    b->start = (float *)local_memory(4 * b->count + 4, sizeof(float));
    for (i = 0; i < model->element_count; i++)
        for (c = 0; c < 4; c++)
            for (j = 0; j < 4; j++) b->mass[model->elements[i].copy[c]] += model->elements[i].mass[row[c][j]];
    for (i = 0; i < b->count; i++) b->fixed[i] = (model->held && model->held[i]) || !(b->mass[i] > 0);
}

static inline void local_body_free(local_body *b) {
    local_free(b->mass);
    local_free(b->fixed);
    local_free(b->u);
    local_free(b->v);
    local_free(b->start);
}

/* values: count x 3 */
static inline void local_read(const float *from, size_t count, double *values) {
    size_t i, k;
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) values[3 * i + k] = (double)from[4 * i + k];
}

static inline void local_write(const double *values, size_t count, float *to) {
    size_t i, k;
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) to[4 * i + k] = (float)values[3 * i + k];
}

/* Is every component finite and below the limit, m? */
static inline int local_is_bounded(const local_body *b, float limit) {
    size_t i;
    for (i = 0; i < 4 * b->count; i++)
        if (!(b->u[i] < limit && b->u[i] > -limit)) return 0;
    return 1;
}

static inline double local_shear(const gxs_material *m) { return m->young / (2 * (1 + m->poisson)); }

static inline double local_lame(const gxs_material *m) {
    return m->young * m->poisson / ((1 + m->poisson) * (1 - 2 * m->poisson));
}

/* Gradients of the four shape functions; the first is minus the sum of the others. */
static inline void local_gradients(const gxs_element *e, double g[4][3]) {
    int k, d;
    for (d = 0; d < 3; d++) {
        g[0][d] = -(e->gradient[1][d] + e->gradient[2][d] + e->gradient[3][d]);
        for (k = 1; k < 4; k++) g[k][d] = e->gradient[k][d];
    }
}

/* ---- colours ---- */

/* The first colour that is not in a set of LOCAL_COLORS bits */
static inline int local_free_color(const uint64_t used[2]) {
    int c = 0;
    while (c < LOCAL_COLORS && (used[c / 64] >> c % 64 & 1)) c++;
    if (c == LOCAL_COLORS) {
        fprintf(stderr, "local.h: more than %d colours\n", LOCAL_COLORS);
        exit(1);
    }
    return c;
}

/* Of elements: two that share a copy that moves differ. colors: element_count; returns how many there are. */
static inline int local_color_elements(const local_body *b, const gxs_model *model, int *colors) {
    uint64_t *used = (uint64_t *)local_memory(2 * b->count, sizeof *used);
    size_t e;
    int k, count = 0;
    for (e = 0; e < model->element_count; e++) {
        const uint32_t *copy = model->elements[e].copy;
        uint64_t around[2] = {0, 0};
        for (k = 0; k < 4; k++)
            if (!b->fixed[copy[k]]) {
                around[0] |= used[2 * (size_t)copy[k]];
                around[1] |= used[2 * (size_t)copy[k] + 1];
            }
        colors[e] = local_free_color(around);
        if (colors[e] >= count) count = colors[e] + 1;
        for (k = 0; k < 4; k++)
            if (!b->fixed[copy[k]]) used[2 * (size_t)copy[k] + (size_t)(colors[e] / 64)] |= 1ull << colors[e] % 64;
    }
    local_free(used);
    return count;
}

/* The corners around each copy: 4 x element + corner, first[i] to first[i + 1]. The caller frees both. */
static inline uint32_t *local_corners(const gxs_model *model, uint32_t **first) {
    const size_t n = model->copy_count;
    uint32_t *corners = (uint32_t *)local_memory(4 * model->element_count, sizeof *corners), *start;
    size_t i;
    start = *first = (uint32_t *)local_memory(n + 1, sizeof *start);
    for (i = 0; i < 4 * model->element_count; i++) start[model->elements[i / 4].copy[i % 4]]++;
    for (i = 1; i <= n; i++) start[i] += start[i - 1];
    for (i = 4 * model->element_count; i-- > 0;) corners[--start[model->elements[i / 4].copy[i % 4]]] = (uint32_t)i;
    start[n] = (uint32_t)(4 * model->element_count);
    return corners;
}

/* Of copies that move: two of one element differ. Fixed ones get LOCAL_COLORS. */
static inline void local_color_copies(const local_body *b, const gxs_model *model, const uint32_t *corners,
                                      const uint32_t *first, int *colors) {
    size_t i;
    uint32_t a;
    int k;
    for (i = 0; i < b->count; i++) colors[i] = LOCAL_COLORS;
    for (i = 0; i < b->count; i++) {
        uint64_t around[2] = {0, 0};
        if (b->fixed[i]) continue;
        for (a = first[i]; a < first[i + 1]; a++)
            for (k = 0; k < 4; k++) {
                const uint32_t j = model->elements[corners[a] / 4].copy[k];
                if (j != i && colors[j] < LOCAL_COLORS) around[colors[j] / 64] |= 1ull << colors[j] % 64;
            }
        colors[i] = local_free_color(around);
    }
}

/* ---- lanes ---- */

/* x: the three components at 16 places of u; at: 4 x copy */
LOCAL_INLINE void local_gather(const float *u, const int32_t *at, local_lanes x[3]) {
#ifdef __AVX512F__
    __m512 r[4], t[4];
    int k;
    for (k = 0; k < 4; k++) {
        r[k] = _mm512_castps128_ps512(_mm_load_ps(u + at[k]));
        r[k] = _mm512_insertf32x4(r[k], _mm_load_ps(u + at[k + 4]), 1);
        r[k] = _mm512_insertf32x4(r[k], _mm_load_ps(u + at[k + 8]), 2);
        r[k] = _mm512_insertf32x4(r[k], _mm_load_ps(u + at[k + 12]), 3);
    }
    t[0] = _mm512_unpacklo_ps(r[0], r[1]);
    t[1] = _mm512_unpacklo_ps(r[2], r[3]);
    t[2] = _mm512_unpackhi_ps(r[0], r[1]);
    t[3] = _mm512_unpackhi_ps(r[2], r[3]);
    x[0] = (local_lanes)_mm512_shuffle_ps(t[0], t[1], 0x44);
    x[1] = (local_lanes)_mm512_shuffle_ps(t[0], t[1], 0xEE);
    x[2] = (local_lanes)_mm512_shuffle_ps(t[2], t[3], 0x44);
#else
    int l, k;
    for (k = 0; k < 3; k++)
        for (l = 0; l < LOCAL_LANES; l++) x[k][l] = u[at[l] + k];
#endif
}

/* The reverse; the last component becomes 0. */
LOCAL_INLINE void local_scatter(float *u, const int32_t *at, const local_lanes x[3]) {
#ifdef __AVX512F__
    const __m512 zero = _mm512_setzero_ps(), a = (__m512)x[0], b = (__m512)x[1], c = (__m512)x[2];
    const __m512 t0 = _mm512_unpacklo_ps(a, b), t1 = _mm512_unpacklo_ps(c, zero), t2 = _mm512_unpackhi_ps(a, b),
                 t3 = _mm512_unpackhi_ps(c, zero);
    __m512 r[4];
    int k;
    r[0] = _mm512_shuffle_ps(t0, t1, 0x44);
    r[1] = _mm512_shuffle_ps(t0, t1, 0xEE);
    r[2] = _mm512_shuffle_ps(t2, t3, 0x44);
    r[3] = _mm512_shuffle_ps(t2, t3, 0xEE);
    for (k = 0; k < 4; k++) {
        _mm_store_ps(u + at[k], _mm512_extractf32x4_ps(r[k], 0));
        _mm_store_ps(u + at[k + 4], _mm512_extractf32x4_ps(r[k], 1));
        _mm_store_ps(u + at[k + 8], _mm512_extractf32x4_ps(r[k], 2));
        _mm_store_ps(u + at[k + 12], _mm512_extractf32x4_ps(r[k], 3));
    }
#else
    int l, k;
    for (l = 0; l < LOCAL_LANES; l++)
        for (k = 0; k < 3; k++) u[at[l] + k] = x[k][l];
#endif
}

/* F = 1 + d. i = Ic - 3 and j = J - 1, without cancellation near rest */
typedef struct local_strain {
    local_lanes d[9], c[9]; /* displacement gradient by rows, its cofactors */
    local_lanes trace, i, j;
} local_strain;

/* edges: three differences of displacement, 3 lanes each; g: as many gradients of shape functions */
LOCAL_INLINE void local_strain_make(const local_lanes *edges, const local_lanes *g, local_strain *s) {
    local_lanes square;
    int r, k;
    for (r = 0; r < 3; r++)
        for (k = 0; k < 3; k++) s->d[3 * r + k] = edges[r] * g[k] + edges[3 + r] * g[3 + k] + edges[6 + r] * g[6 + k];
    for (r = 0; r < 3; r++)
        for (k = 0; k < 3; k++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            s->c[3 * r + k] = s->d[3 * r1 + k1] * s->d[3 * r2 + k2] - s->d[3 * r1 + k2] * s->d[3 * r2 + k1];
        }
    square = s->d[0] * s->d[0];
    for (k = 1; k < 9; k++) square += s->d[k] * s->d[k];
    s->trace = s->d[0] + s->d[4] + s->d[8];
    s->i = 2 * s->trace + square;
    s->j = s->trace + (s->c[0] + s->c[4] + s->c[8]) + s->d[0] * s->c[0] + s->d[1] * s->c[1] + s->d[2] * s->c[2];
}

/* Of one gradient: a = d g, b = d^T g, c = cof(d) g. So F g = g + a and cof(F) g = (1 + trace) g - b + c. */
LOCAL_INLINE void local_turn(const local_strain *s, const local_lanes *g, local_lanes a[3], local_lanes b[3],
                             local_lanes c[3]) {
    int r;
    for (r = 0; r < 3; r++) {
        a[r] = s->d[3 * r] * g[0] + s->d[3 * r + 1] * g[1] + s->d[3 * r + 2] * g[2];
        b[r] = s->d[r] * g[0] + s->d[3 + r] * g[1] + s->d[6 + r] * g[2];
        c[r] = s->c[3 * r] * g[0] + s->c[3 * r + 1] * g[1] + s->c[3 * r + 2] * g[2];
    }
}

/* ---- XPBD ---- */

/* Blocks of 16 elements of one colour; lanes without an element move the place behind the last copy, without weight. */
typedef struct local_xpbd {
    local_body body;
    size_t blocks;
    int colors;
    int32_t *at;      /* blocks x 4 corners x 16: 4 x copy */
    float *gradients; /* blocks x 9 x 16: of corners 1 to 3 */
    float *moduli;    /* blocks x 2 x 16: weight x mu, weight x lambda, J */
    float *inverse;   /* blocks x 4 x 16: 1 / mass of the corners, 0 where fixed */
} local_xpbd;

/* Energy density at F and, unless NULL, stress and Hessian: a gxs_energy_fn. user: the gxs_material */
static inline double local_xpbd_energy(void *user, const double *f, double *stress, double *hessian) {
    const gxs_material *m = (const gxs_material *)user;
    const double mu = local_shear(m), lambda = local_lame(m) + mu;
    double c[9], j, ic = 0;
    int r, k, p, q;
    for (r = 0; r < 3; r++)
        for (k = 0; k < 3; k++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            c[3 * r + k] = f[3 * r1 + k1] * f[3 * r2 + k2] - f[3 * r1 + k2] * f[3 * r2 + k1];
            ic += f[3 * r + k] * f[3 * r + k];
        }
    j = f[0] * c[0] + f[1] * c[1] + f[2] * c[2] - 1;
    for (k = 0; k < 9 && stress; k++) stress[k] = mu * (f[k] - c[k]) + lambda * j * c[k];
    for (p = 0; p < 9 && hessian; p++)
        for (q = 0; q < 9; q++) {
            /* d cof_p / d F_q is plus or minus the entry of F in the third row and column, 0 if they share one */
            const int r3 = 3 - p / 3 - q / 3, k3 = 3 - p % 3 - q % 3;
            double second = 0;
            if (p / 3 != q / 3 && p % 3 != q % 3)
                second = ((q / 3 - p / 3 + 3) % 3 == (q % 3 - p % 3 + 3) % 3 ? 1 : -1) * f[3 * r3 + k3];
            hessian[9 * p + q] = (p == q ? mu : 0) + (lambda * j - mu) * second + lambda * c[p] * c[q];
        }
    return mu / 2 * (ic - 3) - mu * j + lambda / 2 * j * j;
}

static inline void local_xpbd_place(local_xpbd *x, const gxs_model *model, size_t e, size_t at) {
    const size_t block = at / LOCAL_LANES, lane = at % LOCAL_LANES;
    const gxs_element *element = &model->elements[e];
    const gxs_material *material = &model->materials[element->material];
    const double mu = local_shear(material);
    size_t k, d;
    for (k = 0; k < 4; k++) {
        const uint32_t copy = element->copy[k];
        x->at[(4 * block + k) * LOCAL_LANES + lane] = (int32_t)(4 * copy);
        x->inverse[(4 * block + k) * LOCAL_LANES + lane] = x->body.fixed[copy] ? 0 : (float)(1 / x->body.mass[copy]);
    }
    for (k = 0; k < 3; k++)
        for (d = 0; d < 3; d++)
            x->gradients[(9 * block + 3 * k + d) * LOCAL_LANES + lane] = (float)element->gradient[k + 1][d];
    x->moduli[2 * block * LOCAL_LANES + lane] = (float)(element->weight * mu);
    x->moduli[(2 * block + 1) * LOCAL_LANES + lane] = (float)(element->weight * (local_lame(material) + mu));
}

static inline void local_xpbd_make(local_xpbd *x, const gxs_model *model) {
    int *colors = (int *)local_memory(model->element_count, sizeof *colors), c;
    size_t counts[LOCAL_COLORS] = {0}, first[LOCAL_COLORS], lanes = 0, i;
    memset(x, 0, sizeof *x);
    local_body_make(&x->body, model);
    x->colors = local_color_elements(&x->body, model, colors);
    for (i = 0; i < model->element_count; i++) counts[colors[i]]++;
    for (c = 0; c < x->colors; c++) {
        first[c] = lanes;
        lanes += (counts[c] + LOCAL_LANES - 1) / LOCAL_LANES * LOCAL_LANES;
    }
    x->blocks = lanes / LOCAL_LANES;
    x->at = (int32_t *)local_memory(4 * lanes, sizeof(int32_t));
    x->gradients = (float *)local_memory(9 * lanes, sizeof(float));
    x->moduli = (float *)local_memory(2 * lanes, sizeof(float));
    x->inverse = (float *)local_memory(4 * lanes, sizeof(float));
    for (i = 0; i < 4 * lanes; i++) x->at[i] = (int32_t)(4 * x->body.count);
    for (i = 0; i < model->element_count; i++) local_xpbd_place(x, model, i, first[colors[i]]++);
    local_free(colors);
}

static inline void local_xpbd_free(local_xpbd *x) {
    local_body_free(&x->body);
    local_free(x->at);
    local_free(x->gradients);
    local_free(x->moduli);
    local_free(x->inverse);
}

/* Both constraints of a block of elements, multipliers from 0: with the forces p of both and the constraints'
   gradients D and H, the corrections W (p + D e1 + H e2) solve the linearised pair exactly. square: h^2 */
LOCAL_INLINE void local_xpbd_block(local_xpbd *x, size_t block, float square) {
    const int32_t *at = x->at + 4 * block * LOCAL_LANES;
    const local_lanes *g = (const local_lanes *)(const void *)(x->gradients + 9 * block * LOCAL_LANES);
    const local_lanes *w = (const local_lanes *)(const void *)(x->inverse + 4 * block * LOCAL_LANES);
    const local_lanes *moduli = (const local_lanes *)(const void *)(x->moduli + 2 * block * LOCAL_LANES);
    const local_lanes mu = square * moduli[0], lambda = square * moduli[1];
    local_lanes place[12], edges[9], p[12], d[12], h[12];
    local_lanes k1, m11, m12, m22, r1, r2, e1, e2, scale;
    local_lanes dd = {0}, dh = {0}, hh = {0}, dp = {0}, hp = {0};
    local_strain s;
    int a, r;
    for (a = 0; a < 4; a++) local_gather(x->body.u, at + a * LOCAL_LANES, place + 3 * a);
    for (a = 0; a < 3; a++)
        for (r = 0; r < 3; r++) edges[3 * a + r] = place[3 * a + 3 + r] - place[r];
    local_strain_make(edges, g, &s);
    for (r = 0; r < 3; r++) p[r] = d[r] = h[r] = 0 * mu;
    for (a = 1; a < 4; a++) {
        const local_lanes *ga = g + 3 * (a - 1);
        local_lanes f[3], t[3], c[3];
        local_turn(&s, ga, f, t, c);
        for (r = 0; r < 3; r++) {
            const int i = 3 * a + r;
            h[i] = (1 + s.trace) * ga[r] - t[r] + c[r];
            d[i] = f[r] + ga[r];
            p[i] = -(mu * (f[r] + t[r] - s.trace * ga[r] - c[r]) + lambda * s.j * h[i]);
            h[r] -= h[i], d[r] -= d[i], p[r] -= p[i];
        }
    }
    for (a = 0; a < 4; a++)
        for (r = 3 * a; r < 3 * a + 3; r++) {
            dd += w[a] * d[r] * d[r];
            dh += w[a] * d[r] * h[r];
            hh += w[a] * h[r] * h[r];
            dp += w[a] * d[r] * p[r];
            hp += w[a] * h[r] * p[r];
        }
    k1 = mu / (3 + s.i);
    m11 = 1 + k1 * dd, m12 = k1 * dh, m22 = 1 + lambda * hh;
    r1 = -k1 * dp, r2 = -lambda * hp;
    scale = 1 / (m11 * m22 - m12 * lambda * dh);
    e1 = scale * (m22 * r1 - m12 * r2);
    e2 = scale * (m11 * r2 - lambda * dh * r1);
    for (a = 0; a < 4; a++) {
        for (r = 3 * a; r < 3 * a + 3; r++) place[r] += w[a] * (p[r] + e1 * d[r] + e2 * h[r]);
        local_scatter(x->body.u, at + a * LOCAL_LANES, place + 3 * a);
    }
}

/* A step of dt in equal substeps. damping: of mass, 1/s */
static inline void local_xpbd_step(local_xpbd *x, double dt, const double gravity[3], double damping, int substeps) {
    local_body *b = &x->body;
    const float h = (float)(dt / substeps), slower = 1 / (1 + h * (float)damping), inverse = 1 / h;
    const float push[4] = {h * (float)gravity[0], h * (float)gravity[1], h * (float)gravity[2], 0};
    size_t i, k;
    int s;
    for (s = 0; s < substeps; s++) {
        memcpy(b->start, b->u, 4 * b->count * sizeof(float));
        for (i = 0; i < b->count; i++)
            for (k = 0; k < 4 && !b->fixed[i]; k++) b->u[4 * i + k] += h * slower * (b->v[4 * i + k] + push[k]);
        for (i = 0; i < x->blocks; i++) local_xpbd_block(x, i, h * h * slower);
        for (i = 0; i < 4 * b->count; i++) b->v[i] = (b->u[i] - b->start[i]) * inverse;
    }
}

/* ---- VBD ---- */

/* Up to 16 copies of one colour, and a row for each element around the one that has the most */
typedef struct local_group {
    size_t first; /* row */
    uint32_t rows, count;
    int32_t at[LOCAL_LANES]; /* 4 x copy; places behind count repeat the first */
    float mass[LOCAL_LANES]; /* kg */
} local_group;

typedef struct local_vbd {
    local_body body;
    size_t groups;
    local_group *group;
    int32_t *at;          /* rows x 3 x 16: 4 x copy of the other corners */
    float *gradients;     /* rows x 9 x 16: of the other corners */
    float *moduli;        /* rows x 2 x 16: weight x mu, weight x lambda, J; 0: no element */
    float *target;        /* count x 4: where inertia and gravity alone would lead */
    float *faster;        /* count x 4: velocity before the last step */
    float *last, *before; /* count x 4: Chebyshev's last two iterates */
    int stepped;          /* faster is known */
} local_vbd;

typedef struct local_vbd_desc {
    double dt, gravity[3];
    double damping; /* of mass, 1/s */
    int iterations; /* sweeps */
    double rho;     /* Chebyshev's estimate of the spectral radius, below 1; 0: none */
    int symmetric;  /* sweeps go forward and back in turn, and Chebyshev's method takes two for one */
} local_vbd_desc;

static inline void local_vbd_fill_lane(local_vbd *v, const gxs_model *model, const local_group *g, size_t lane,
                                       const uint32_t *corners, size_t count) {
    size_t r, k, d;
    for (r = 0; r < g->rows; r++) {
        const size_t row = g->first + r;
        int32_t *at = v->at + 3 * row * LOCAL_LANES + lane;
        const gxs_element *element;
        const gxs_material *material;
        double gradients[4][3];
        size_t place = 0;
        for (k = 0; k < 3; k++) at[k * LOCAL_LANES] = g->at[lane];
        if (r >= count) continue;
        element = &model->elements[corners[r] / 4];
        material = &model->materials[element->material];
        local_gradients(element, gradients);
        for (k = 0; k < 4; k++) {
            if (k == corners[r] % 4) continue;
            at[place * LOCAL_LANES] = (int32_t)(4 * element->copy[k]);
            for (d = 0; d < 3; d++)
                v->gradients[(9 * row + 3 * place + d) * LOCAL_LANES + lane] = (float)gradients[k][d];
            place++;
        }
        v->moduli[2 * row * LOCAL_LANES + lane] = (float)(element->weight * 4 / 3 * local_shear(material));
        v->moduli[(2 * row + 1) * LOCAL_LANES + lane] =
            (float)(element->weight * (local_lame(material) + 5.0 / 6 * local_shear(material)));
    }
}

/* A copy in the order of sweeps: colours, then falling numbers of elements, so that lanes of a group are alike */
typedef struct local_rank {
    int color;
    uint32_t elements, copy;
} local_rank;

static inline int local_compare_ranks(const void *a, const void *b) {
    const local_rank *x = (const local_rank *)a, *y = (const local_rank *)b;
    if (x->color != y->color) return x->color < y->color ? -1 : 1;
    if (x->elements != y->elements) return x->elements > y->elements ? -1 : 1;
    return (x->copy > y->copy) - (x->copy < y->copy);
}

/* Copies that move, in order; *count of them. The caller frees it. */
static inline local_rank *local_vbd_order(const local_vbd *v, const gxs_model *model, const uint32_t *corners,
                                          const uint32_t *first, size_t *count) {
    int *colors = (int *)local_memory(v->body.count, sizeof *colors);
    local_rank *order = (local_rank *)local_memory(v->body.count, sizeof *order);
    size_t i;
    local_color_copies(&v->body, model, corners, first, colors);
    for (*count = i = 0; i < v->body.count; i++) {
        if (v->body.fixed[i]) continue;
        order[*count].color = colors[i];
        order[*count].elements = first[i + 1] - first[i];
        order[(*count)++].copy = (uint32_t)i;
    }
    qsort(order, *count, sizeof *order, local_compare_ranks);
    local_free(colors);
    return order;
}

/* Groups of up to 16 copies of a colour, from the order; returns the number of rows */
static inline size_t local_vbd_group(local_vbd *v, const local_rank *order, size_t count) {
    size_t i, lane, rows = 0;
    v->group = (local_group *)local_memory(count + 1, sizeof *v->group);
    for (i = 0; i < count; i += v->group[v->groups++].count) {
        local_group *g = &v->group[v->groups];
        g->first = rows;
        g->rows = order[i].elements;
        for (lane = 0; lane < LOCAL_LANES; lane++) {
            const int is_own = i + lane < count && order[i + lane].color == order[i].color;
            const uint32_t copy = order[is_own ? i + lane : i].copy;
            g->at[lane] = (int32_t)(4 * copy);
            g->mass[lane] = (float)v->body.mass[copy];
            g->count += (uint32_t)is_own;
        }
        rows += g->rows;
    }
    return rows;
}

static inline void local_vbd_make(local_vbd *v, const gxs_model *model) {
    uint32_t *first, *corners;
    local_rank *order;
    float **vectors[4];
    size_t count, rows, g, lane, k;
    memset(v, 0, sizeof *v);
    local_body_make(&v->body, model);
    corners = local_corners(model, &first);
    order = local_vbd_order(v, model, corners, first, &count);
    rows = local_vbd_group(v, order, count);
    v->at = (int32_t *)local_memory(3 * rows * LOCAL_LANES, sizeof(int32_t));
    v->gradients = (float *)local_memory(9 * rows * LOCAL_LANES, sizeof(float));
    v->moduli = (float *)local_memory(2 * rows * LOCAL_LANES, sizeof(float));
    for (g = 0; g < v->groups; g++)
        for (lane = 0; lane < LOCAL_LANES; lane++) {
            const size_t copy = (size_t)v->group[g].at[lane] / 4;
            local_vbd_fill_lane(v, model, &v->group[g], lane, corners + first[copy], first[copy + 1] - first[copy]);
        }
    vectors[0] = &v->target, vectors[1] = &v->faster, vectors[2] = &v->last, vectors[3] = &v->before;
    for (k = 0; k < 4; k++) *vectors[k] = (float *)local_memory(4 * v->body.count, sizeof(float));
    local_free(order);
    local_free(corners);
    local_free(first);
}

static inline void local_vbd_free(local_vbd *v) {
    local_body_free(&v->body);
    local_free(v->group);
    local_free(v->at);
    local_free(v->gradients);
    local_free(v->moduli);
    local_free(v->target);
    local_free(v->faster);
    local_free(v->last);
    local_free(v->before);
}

/* Adds the force on a group's copies from a row of elements to force, and their Hessian blocks (00 01 02 11 12 22),
   without the term that can be indefinite, to hessian. own: the copies' places. The stress is
   mu (1 - 1 / (Ic + 1)) F + (lambda (J - 1) - 3/4 mu) cof F, written so that nothing cancels near rest. */
LOCAL_INLINE void local_vbd_row(const local_vbd *v, size_t row, const local_lanes own[3], local_lanes force[3],
                                local_lanes hessian[6]) {
    const int32_t *at = v->at + 3 * row * LOCAL_LANES;
    const local_lanes *g = (const local_lanes *)(const void *)(v->gradients + 9 * row * LOCAL_LANES);
    const local_lanes *moduli = (const local_lanes *)(const void *)(v->moduli + 2 * row * LOCAL_LANES);
    const local_lanes mu = moduli[0], lambda = moduli[1];
    local_lanes edges[9], mine[3], a[3], b[3], c[3], q[3], inverse, growth, pressure, round, stretch, norm;
    local_strain s;
    int k, r;
    for (k = 0; k < 3; k++) {
        local_gather(v->body.u, at + k * LOCAL_LANES, edges + 3 * k);
        for (r = 0; r < 3; r++) edges[3 * k + r] -= own[r];
    }
    local_strain_make(edges, g, &s);
    for (r = 0; r < 3; r++) mine[r] = -(g[r] + g[3 + r] + g[6 + r]);
    local_turn(&s, mine, a, b, c);
    inverse = 1 / (s.i + 4);
    growth = 0.25f * mu * s.i * inverse;
    pressure = lambda * s.j;
    norm = mine[0] * mine[0] + mine[1] * mine[1] + mine[2] * mine[2];
    round = mu * (3 + s.i) * inverse * norm;
    stretch = 2 * mu * inverse * inverse;
    for (r = 0; r < 3; r++) {
        q[r] = (1 + s.trace) * mine[r] - b[r] + c[r];
        force[r] -= 0.75f * mu * (a[r] + b[r] - c[r] - s.trace * mine[r]) + growth * (a[r] + mine[r]) + pressure * q[r];
        a[r] += mine[r];
    }
    hessian[0] += round + stretch * a[0] * a[0] + lambda * q[0] * q[0];
    hessian[1] += stretch * a[0] * a[1] + lambda * q[0] * q[1];
    hessian[2] += stretch * a[0] * a[2] + lambda * q[0] * q[2];
    hessian[3] += round + stretch * a[1] * a[1] + lambda * q[1] * q[1];
    hessian[4] += stretch * a[1] * a[2] + lambda * q[1] * q[2];
    hessian[5] += round + stretch * a[2] * a[2] + lambda * q[2] * q[2];
}

/* own += H^-1 f; the block is scaled by its trace, so that no product leaves single precision. */
LOCAL_INLINE void local_vbd_solve(local_lanes own[3], local_lanes f[3], local_lanes h[6]) {
    const local_lanes scale = 1 / (h[0] + h[3] + h[5]);
    local_lanes c[6], inverse;
    int k;
    for (k = 0; k < 6; k++) h[k] *= scale;
    for (k = 0; k < 3; k++) f[k] *= scale;
    c[0] = h[3] * h[5] - h[4] * h[4];
    c[1] = h[2] * h[4] - h[1] * h[5];
    c[2] = h[1] * h[4] - h[2] * h[3];
    c[3] = h[0] * h[5] - h[2] * h[2];
    c[4] = h[1] * h[2] - h[0] * h[4];
    c[5] = h[0] * h[3] - h[1] * h[1];
    inverse = 1 / (h[0] * c[0] + h[1] * c[1] + h[2] * c[2]);
    own[0] += inverse * (c[0] * f[0] + c[1] * f[1] + c[2] * f[2]);
    own[1] += inverse * (c[1] * f[0] + c[3] * f[1] + c[4] * f[2]);
    own[2] += inverse * (c[2] * f[0] + c[4] * f[1] + c[5] * f[2]);
}

/* inertia: (1 + h damping) / h^2 */
static inline void local_vbd_sweep(local_vbd *v, float inertia, int back) {
    size_t i;
    for (i = 0; i < v->groups; i++) {
        const local_group *g = &v->group[back ? v->groups - 1 - i : i];
        local_lanes own[3], target[3], force[3], hessian[6], mass;
        uint32_t r, lane;
        int k;
        memcpy(&mass, g->mass, sizeof mass);
        mass *= inertia;
        local_gather(v->body.u, g->at, own);
        local_gather(v->target, g->at, target);
        for (k = 0; k < 3; k++) force[k] = mass * (target[k] - own[k]);
        for (k = 0; k < 6; k++) hessian[k] = k == 0 || k == 3 || k == 5 ? mass : 0 * mass;
        for (r = 0; r < g->rows; r++) local_vbd_row(v, g->first + r, own, force, hessian);
        local_vbd_solve(own, force, hessian);
        for (lane = 0; lane < g->count; lane++)
            for (k = 0; k < 3; k++) v->body.u[g->at[lane] + k] = own[k][lane];
    }
}

/* Where inertia leads, and the start: as far along gravity as the last step's acceleration went */
static inline void local_vbd_begin(local_vbd *v, const local_vbd_desc *desc) {
    local_body *b = &v->body;
    const float h = (float)desc->dt, slower = 1 / (1 + h * (float)desc->damping);
    const float g[3] = {(float)desc->gravity[0], (float)desc->gravity[1], (float)desc->gravity[2]};
    const float size = sqrtf(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    size_t i, k;
    memcpy(b->start, b->u, 4 * b->count * sizeof(float));
    for (i = 0; i < b->count; i++) {
        float *u = b->u + 4 * i, *speed = b->v + 4 * i, along = 0;
        if (b->fixed[i]) continue;
        for (k = 0; k < 3 && size > 0; k++) along += (speed[k] - v->faster[4 * i + k]) / h * g[k] / (size * size);
        along = !v->stepped || along > 1 ? 1 : along < 0 ? 0 : along;
        for (k = 0; k < 3; k++) {
            v->target[4 * i + k] = u[k] + h * slower * (speed[k] + h * g[k]);
            u[k] += h * slower * (speed[k] + h * along * g[k]);
        }
    }
    memcpy(v->last, b->u, 4 * b->count * sizeof(float));
}

/* Chebyshev's method after the iterate of number n, 0 the first. As published it extrapolates iterates of a radius
   rho. Sweeps forward and back have eigenvalues of the error from 0 to rho: those are shifted first. Returns omega. */
static inline float local_vbd_extrapolate(local_vbd *v, const local_vbd_desc *desc, int n, float omega) {
    const float rho = (float)desc->rho, radius = desc->symmetric ? rho / (2 - rho) : rho;
    const float shift = desc->symmetric ? 2 / (2 - rho) : 1;
    float *u = v->body.u, *last = v->last, *before = v->before;
    size_t i;
    omega = n == 0 ? 1 : n == 1 ? 2 / (2 - radius * radius) : 4 / (4 - radius * radius * omega);
    for (i = 0; i < 4 * v->body.count; i++) {
        const float next = shift * (u[i] - last[i]) + last[i];
        u[i] = n == 0 ? next : omega * (next - before[i]) + before[i];
    }
    v->before = last;
    v->last = before;
    memcpy(v->last, u, 4 * v->body.count * sizeof(float));
    return omega;
}

static inline void local_vbd_step(local_vbd *v, const local_vbd_desc *desc) {
    local_body *b = &v->body;
    const float h = (float)desc->dt, inertia = (1 + h * (float)desc->damping) / (h * h);
    float omega = 1;
    size_t i;
    int k;
    local_vbd_begin(v, desc);
    for (k = 0; k < desc->iterations; k++) {
        local_vbd_sweep(v, inertia, desc->symmetric && k % 2 == 1);
        if (desc->rho > 0 && !desc->symmetric) omega = local_vbd_extrapolate(v, desc, k, omega);
        if (desc->rho > 0 && desc->symmetric && k % 2 == 1) omega = local_vbd_extrapolate(v, desc, k / 2, omega);
    }
    for (i = 0; i < 4 * b->count; i++) {
        v->faster[i] = b->v[i];
        b->v[i] = (b->u[i] - b->start[i]) / h;
    }
    v->stepped = 1;
}

#endif /* GXFEM_BENCH_LOCAL_H */
