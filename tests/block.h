/* block.h - shared by the tests of gxfem_solve.h: random numbers, blocks of cubes as scenes, a material of the
   caller's own, what fails without memory. Include after gxfem_solve.h. */
#ifndef BLOCK_H
#define BLOCK_H
#include "runner.h"
#include "scarce.h"
#include "../bench/forms.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Random numbers: 64-bit xorshift*, the same everywhere. Failures print the seed of the test. */
static uint64_t random_state;
static uint64_t random_seed;

static inline void seed(uint64_t value) {
    random_seed = value;
    random_state = value * 2654435769u + 1;
}

/* uniform in [-1, 1) */
static inline double uniform(void) {
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return (double)((random_state * 2685821657736338717u) >> 11) / 4503599627370496.0 - 1;
}

static inline int finite_bits(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return ((bits >> 52) & 2047) != 2047;
}

/* NaN and infinity from bits, for -ffast-math */
static inline double not_a_number(int infinite) {
    uint64_t bits = infinite ? (uint64_t)0x7ff << 52 : (uint64_t)0xfff << 51;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Prints the finding and the seed, all in Check's message: a test's process ends without writing out its stdout. */
#define assert_that(condition, ...)                                                                                    \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            char found[400];                                                                                           \
            snprintf(found, sizeof found, __VA_ARGS__);                                                                \
            ck_abort_msg("%s; seed %lu: %s", #condition, (unsigned long)random_seed, found);                           \
        }                                                                                                              \
    } while (0)

/* A block of unit cubes times size, six tetrahedra each, and its state. */
typedef struct scene {
    gxs_model model;
    gxs_material *material;
    gxs_element *elements;
    uint8_t *held;
    double *rest, *displacement, *velocity, *forces; /* copy_count x 3 */
} scene;

static inline double determinant3(const double a[3][3]) {
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/* Gradients, volume and mass of an uncut tetrahedron. Swaps two corners if it is turned inside out. */
static inline void make_element(gxs_element *element, const double *rest, double density) {
    static const double identity_mass[10] = {2, 1, 1, 1, 2, 1, 1, 2, 1, 2};
    double edge[3][3], volume;
    int i, r;
    for (i = 0; i < 3; i++)
        for (r = 0; r < 3; r++)
            edge[i][r] = rest[3 * element->copy[i + 1] + (uint32_t)r] - rest[3 * element->copy[0] + (uint32_t)r];
    volume = determinant3((const double(*)[3])edge) / 6;
    if (volume < 0) {
        uint32_t first = element->copy[2];
        element->copy[2] = element->copy[3];
        element->copy[3] = first;
        make_element(element, rest, density);
        return;
    }
    for (i = 0; i < 3; i++) {
        const double *a = edge[(i + 1) % 3], *b = edge[(i + 2) % 3];
        for (r = 0; r < 3; r++)
            element->gradient[i + 1][r] =
                (a[(r + 1) % 3] * b[(r + 2) % 3] - a[(r + 2) % 3] * b[(r + 1) % 3]) / (6 * volume);
    }
    for (r = 0; r < 3; r++)
        element->gradient[0][r] = -(element->gradient[1][r] + element->gradient[2][r] + element->gradient[3][r]);
    element->weight = volume;
    for (i = 0; i < 10; i++) element->mass[i] = density * volume / 20 * identity_mass[i];
}

static inline void *zeroed(size_t count, size_t size) {
    void *memory = calloc(count, size);
    ck_assert_ptr_nonnull(memory);
    return memory;
}

/* nx x ny x nz cubes of edge `size`; inner and outer nodes are moved by jitter x size; room for `extra` more copies
   and elements */
static inline scene scene_block(int nx, int ny, int nz, double size, double jitter, size_t extra) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    size_t copies = (size_t)((nx + 1) * (ny + 1) * (nz + 1)), elements = (size_t)(6 * nx * ny * nz), e = 0, i = 0;
    scene s;
    int x, y, z, t, k;
    s.rest = (double *)zeroed(3 * (copies + extra), sizeof(double));
    s.displacement = (double *)zeroed(3 * (copies + extra), sizeof(double));
    s.velocity = (double *)zeroed(3 * (copies + extra), sizeof(double));
    s.forces = (double *)zeroed(3 * (copies + extra), sizeof(double));
    s.held = (uint8_t *)zeroed(copies + extra, 1);
    s.elements = (gxs_element *)zeroed(elements + extra, sizeof(gxs_element));
    for (z = 0; z <= nz; z++)
        for (y = 0; y <= ny; y++)
            for (x = 0; x <= nx; x++) {
                s.rest[i++] = size * (x + jitter * uniform());
                s.rest[i++] = size * (y + jitter * uniform());
                s.rest[i++] = size * (z + jitter * uniform());
            }
    for (z = 0; z < nz; z++)
        for (y = 0; y < ny; y++)
            for (x = 0; x < nx; x++)
                for (t = 0; t < 6; t++, e++) {
                    int at[3];
                    at[0] = x, at[1] = y, at[2] = z;
                    for (k = 0; k < 4; k++) {
                        s.elements[e].copy[k] = (uint32_t)((at[2] * (ny + 1) + at[1]) * (nx + 1) + at[0]);
                        if (k < 3) at[order[t][k]]++;
                    }
                    make_element(&s.elements[e], s.rest, 1000);
                }
    s.material = (gxs_material *)zeroed(1, sizeof(gxs_material));
    s.material->young = 1e6;
    s.material->poisson = 0.4;
    memset(&s.model, 0, sizeof s.model);
    s.model.copy_count = copies;
    s.model.positions = s.rest;
    s.model.elements = s.elements;
    s.model.element_count = elements;
    s.model.materials = s.material;
    s.model.material_count = 1;
    s.model.held = s.held;
    return s;
}

static inline void scene_free(scene *s) {
    free(s->rest);
    free(s->displacement);
    free(s->velocity);
    free(s->forces);
    free(s->held);
    free(s->elements);
    free(s->material);
}

static inline void scene_hold_left(scene *s) {
    size_t i;
    for (i = 0; i < s->model.copy_count; i++) s->held[i] = s->rest[3 * i] < 1e-9;
}

static inline gxs_step_desc step_make(double dt, double gravity) {
    gxs_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[2] = gravity;
    return step;
}

static inline gxs_solver *solver_make(void) {
    gxs_solver *solver = NULL;
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    return solver;
}

/* a model and one step of it */
static inline gx_result advance(gxs_solver *solver, const gxs_model *model, const gxs_step_desc *step,
                                double *displacement, double *velocity, gxs_step_report *report, gx_failure *failure) {
    gx_result result = gxs_solver_set_model(solver, model, failure);
    return result == GX_OK ? gxs_solver_step(solver, step, displacement, velocity, report, failure) : result;
}

/* E(u) of the header's manual from the assembled forms, displacement u after a step from u_n, v_n; no held copies */
static inline double incremental_potential(const scene *s, const gxs_step_desc *step, const double *un,
                                           const double *vn, const double *u) {
    size_t n = s->model.copy_count, i;
    double *y = (double *)zeroed(3 * n, sizeof(double)), *my = (double *)zeroed(3 * n, sizeof(double)), sum = 0;
    sum = form_energy(&s->model, u);
    for (i = 0; i < 3 * n; i++) y[i] = u[i] - un[i] - step->dt * vn[i];
    form_mass_product(&s->model, y, my);
    for (i = 0; i < 3 * n; i++)
        sum += 0.5 * y[i] * my[i] / (step->dt * step->dt) - (step->forces ? step->forces[i] * u[i] : 0);
    for (i = 0; i < 3 * n; i++) y[i] = step->gravity[i % 3];
    form_mass_product(&s->model, y, my);
    for (i = 0; i < 3 * n; i++) sum -= my[i] * u[i];
    free(y);
    free(my);
    return sum;
}

enum { KINDS = GXS_CUSTOM + 1 };

/* A caller's energy, stiffer along x at large strain: lambda/2 (tr E)^2 + mu E:E + young/8 E_xx^4, E = (F^T F - 1) / 2,
 * S = dpsi/dE; user: its material */
static inline double fibre_energy(void *user, const double *f, double *stress, double *hessian) {
    const gxs_material *material = (const gxs_material *)user;
    const double mu = material->young / (2 * (1 + material->poisson));
    const double lambda = 2 * mu * material->poisson / (1 - 2 * material->poisson);
    double e[9], s[9], trace, square = 0;
    int r, c, k, m;
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++)
            e[3 * r + c] = 0.5 * (f[r] * f[c] + f[3 + r] * f[3 + c] + f[6 + r] * f[6 + c] - (r == c ? 1 : 0));
    trace = e[0] + e[4] + e[8];
    for (k = 0; k < 9; k++) {
        square += e[k] * e[k];
        s[k] = 2 * mu * e[k] + (k % 4 == 0 ? lambda * trace : 0);
    }
    s[0] += 0.5 * material->young * e[0] * e[0] * e[0];
    for (k = 0; stress && k < 9; k++)
        stress[k] = f[k / 3 * 3] * s[k % 3] + f[k / 3 * 3 + 1] * s[3 + k % 3] + f[k / 3 * 3 + 2] * s[6 + k % 3];
    for (m = 0; hessian && m < 9; m++) { /* dF = unit m: dE = sym(F^T dF), dP = dF S + F dS */
        double de[9], ds[9], dtrace;
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++)
                de[3 * r + c] = 0.5 * ((m % 3 == c ? f[m / 3 * 3 + r] : 0) + (m % 3 == r ? f[m / 3 * 3 + c] : 0));
        dtrace = de[0] + de[4] + de[8];
        for (k = 0; k < 9; k++) ds[k] = 2 * mu * de[k] + (k % 4 == 0 ? lambda * dtrace : 0);
        ds[0] += 1.5 * material->young * e[0] * e[0] * de[0];
        for (k = 0; k < 9; k++)
            hessian[9 * k + m] = (k / 3 == m / 3 ? s[m % 3 * 3 + k % 3] : 0) + f[k / 3 * 3] * ds[k % 3] +
                                 f[k / 3 * 3 + 1] * ds[3 + k % 3] + f[k / 3 * 3 + 2] * ds[6 + k % 3];
    }
    return mu * square + 0.5 * lambda * trace * trace + 0.125 * material->young * e[0] * e[0] * e[0] * e[0];
}

static inline void set_kind(gxs_material *material, int kind) {
    material->kind = (gxs_material_kind)kind;
    material->energy = kind == GXS_CUSTOM ? fibre_energy : NULL;
    material->user = material;
}

/* sum of M v, kg m/s */
static inline void momentum(const scene *s, double *p) {
    double *mv = (double *)zeroed(3 * s->model.copy_count, sizeof *mv);
    size_t i;
    form_mass_product(&s->model, s->velocity, mv);
    p[0] = p[1] = p[2] = 0;
    for (i = 0; i < 3 * s->model.copy_count; i++) p[i % 3] += mv[i];
    free(mv);
}

/* run(m, which) allocates by m and returns whether a call failed for it. The n-th allocation fails, once and from then
   on, until none fails. */
static inline void sweep_allocations(int (*run)(memory *m, int which), int which) {
    int from_then_on;
    size_t n;
    for (from_then_on = 0; from_then_on < 2; from_then_on++)
        for (n = 0;; n++) {
            memory m = plenty();
            int failed;
            fail_from(&m, n, from_then_on);
            failed = run(&m, which);
            ck_assert(is_whole(&m));
            if (!failed) break;
            ck_assert_uint_lt(n, 1000);
        }
}

#endif
