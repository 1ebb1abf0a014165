/* front.c - the library beside local solvers that a game would take instead: XPBD and VBD (bench/local.h), on the same
   cut bodies, one thread.

   usage: front [FILE [--small]]; rows go to stdout and to FILE. To stderr it prints the least time by which each method
   reaches an error. --small: fewer scenes and settings; a minute.

   Scenes: bench/block.h's cubes, soft and stiff, uncut and cut to an accordion, of 1k to 23k unknowns; a thin slab in
   five slices. A scene moves from rest under gravity for 0.33 s, or comes to rest with a damping of its mass in 2 s.
       ms_per_second   processor time per simulated second
       error           difference from the reference in displacement, weighted by mass, as a share of the reference's
                       motion: root of the mean square over ten moments; at rest: at the end, from the balance
       worst           the largest difference of any copy as a share of the largest displacement of any, same moments
       energy_end, energy_most   kinetic, elastic and potential energy at the end, and the most of the moments, as a
                       share of the largest fall of potential energy. It starts at 0, and above 0 it was created. With
                       damping: below what is lost
       method          "midpoint quick": see gxs_step_desc.quick. "quality 0.1": the error asked for in place of an
   integrator (gxs_step_desc.quality) note            why there is no motion: "not finite or beyond 100 m"

   The reference is the implicit midpoint rule with small steps, each to balance. It has the method's own mass: lumped
   for XPBD, VBD, explicit and quick steps and steps by quality, consistent for the library's other integrators. What
   that changes of the motion is an error of the space. XPBD's material differs from the library's in large strain,
   which leaves it an error of 1e-3 on the accordion. Copies that follow others in the library (on the slab) move freely
   in XPBD and VBD. */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "block.h"
#include "csv.h"
#include "forms.h"
#include "local.h"
#include "progress.h"

#include <time.h>

enum { MOMENTS = 10 };

static const double frame = 0.033; /* s, the longest step */
static const double gravity[3] = {0, 0, -9.81};

typedef enum method_kind { METHOD_OURS, METHOD_XPBD, METHOD_VBD } method_kind;

/* A way of moving a body. dt: s. Zero: the library's own */
typedef struct setting {
    method_kind kind;
    const char *method;
    int parts; /* of a frame: steps */
    gxs_integrator integrator;
    double cg_tolerance;
    uint32_t newton;
    double newton_tolerance;
    int count; /* XPBD and GXS_EXPLICIT: substeps; VBD: iterations; other integrators: those of quick steps, 0: usual */
    double rho;
    int lumped;
    double quality; /* above 0: the error asked for, in place of all this */
} setting;

typedef struct scene_kind {
    const char *name;
    int cut;        /* BLOCK_UNCUT ...; below 0: the slab */
    uint32_t cells; /* along an edge of the block */
    double young;   /* Pa */
    double damping; /* 1/s; 0: it moves */
    int parts;      /* of a frame, for the reference */
    int small;      /* part of --small */
} scene_kind;

/* Dampings are about critical for the slowest motion. */
static const scene_kind scene_kinds[] = {{"accordion 1e6", BLOCK_ACCORDION, 19, 1e6, 0, 32, 0},
                                         {"uncut 1e6", BLOCK_UNCUT, 19, 1e6, 0, 64, 0},
                                         {"accordion 1e8", BLOCK_ACCORDION, 19, 1e8, 0, 32, 0},
                                         {"slab 3e7", -1, 0, 3e7, 0, 32, 0},
                                         {"accordion 1e6", BLOCK_ACCORDION, 6, 1e6, 0, 32, 1},
                                         {"accordion 1e6", BLOCK_ACCORDION, 9, 1e6, 0, 32, 0},
                                         {"accordion 1e6", BLOCK_ACCORDION, 13, 1e6, 0, 32, 0},
                                         {"uncut 1e6", BLOCK_UNCUT, 6, 1e6, 0, 64, 1},
                                         {"uncut 1e6", BLOCK_UNCUT, 9, 1e6, 0, 64, 0},
                                         {"uncut 1e6", BLOCK_UNCUT, 13, 1e6, 0, 64, 0},
                                         {"accordion 1e6", BLOCK_ACCORDION, 19, 1e6, 5, 1, 0},
                                         {"uncut 1e8", BLOCK_UNCUT, 19, 1e8, 500, 1, 0},
                                         {"slab 3e7", -1, 0, 3e7, 5, 1, 0},
                                         {"accordion 1e6", BLOCK_ACCORDION, 6, 1e6, 5, 1, 1}};

enum { SCENES = sizeof scene_kinds / sizeof scene_kinds[0] };

static const setting settings[] = {{METHOD_OURS, "BDF1", 1, GXS_BDF1, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "BDF1", 1, GXS_BDF1, 1e-1, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "BDF2", 1, GXS_BDF2, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "BDF2", 1, GXS_BDF2, 1e-1, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "BDF2", 1, GXS_BDF2, 0, 2, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "BDF2", 2, GXS_BDF2, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "BDF2", 4, GXS_BDF2, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "BDF2", 8, GXS_BDF2, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 1, GXS_MIDPOINT, 1e-1, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 1, GXS_MIDPOINT, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 2, GXS_MIDPOINT, 1e-2, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 2, GXS_MIDPOINT, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 4, GXS_MIDPOINT, 1e-2, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 4, GXS_MIDPOINT, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 8, GXS_MIDPOINT, 1e-2, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 8, GXS_MIDPOINT, 0, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "midpoint", 16, GXS_MIDPOINT, 1e-2, 0, 0, 0, 0, 0, 0},
                                   {METHOD_OURS, "quality 0.1", 1, GXS_BDF1, 0, 0, 0, 0, 0, 1, 0.1},
                                   {METHOD_OURS, "quality 0.03", 1, GXS_BDF1, 0, 0, 0, 0, 0, 1, 0.03},
                                   {METHOD_OURS, "quality 0.01", 1, GXS_BDF1, 0, 0, 0, 0, 0, 1, 0.01},
                                   {METHOD_OURS, "BDF2 quick", 1, GXS_BDF2, 0, 0, 0, 1, 0, 1, 0},
                                   {METHOD_OURS, "BDF2 quick", 1, GXS_BDF2, 0, 0, 0, 2, 0, 1, 0},
                                   {METHOD_OURS, "BDF2 quick", 2, GXS_BDF2, 0, 0, 0, 2, 0, 1, 0},
                                   {METHOD_OURS, "midpoint quick", 1, GXS_MIDPOINT, 0, 0, 0, 1, 0, 1, 0},
                                   {METHOD_OURS, "midpoint quick", 1, GXS_MIDPOINT, 0, 0, 0, 2, 0, 1, 0},
                                   {METHOD_OURS, "midpoint quick", 1, GXS_MIDPOINT, 0, 0, 0, 3, 0, 1, 0},
                                   {METHOD_OURS, "midpoint quick", 2, GXS_MIDPOINT, 0, 0, 0, 1, 0, 1, 0},
                                   {METHOD_OURS, "midpoint quick", 2, GXS_MIDPOINT, 0, 0, 0, 2, 0, 1, 0},
                                   {METHOD_OURS, "midpoint quick", 2, GXS_MIDPOINT, 0, 0, 0, 3, 0, 1, 0},
                                   {METHOD_OURS, "midpoint quick", 4, GXS_MIDPOINT, 0, 0, 0, 2, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 0, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 5, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 7, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 10, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 12, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 15, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 20, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 30, 0, 1, 0},
                                   {METHOD_OURS, "explicit", 1, GXS_EXPLICIT, 0, 0, 0, 50, 0, 1, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 2, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 5, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 8, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 10, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 15, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 20, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 30, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 50, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 100, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 200, 0, 0, 0},
                                   {METHOD_XPBD, "XPBD", 1, GXS_BDF1, 0, 0, 0, 500, 0, 0, 0},
                                   {METHOD_VBD, "VBD", 1, GXS_BDF1, 0, 0, 0, 5, 0, 0, 0},
                                   {METHOD_VBD, "VBD", 1, GXS_BDF1, 0, 0, 0, 20, 0, 0, 0},
                                   {METHOD_VBD, "VBD", 1, GXS_BDF1, 0, 0, 0, 100, 0, 0, 0},
                                   {METHOD_VBD, "VBD", 8, GXS_BDF1, 0, 0, 0, 1, 0, 0, 0},
                                   {METHOD_VBD, "VBD", 8, GXS_BDF1, 0, 0, 0, 5, 0, 0, 0},
                                   {METHOD_VBD, "VBD", 32, GXS_BDF1, 0, 0, 0, 1, 0, 0, 0},
                                   {METHOD_VBD, "VBD; Chebyshev", 1, GXS_BDF1, 0, 0, 0, 20, 0.9, 0, 0},
                                   {METHOD_VBD, "VBD; Chebyshev", 1, GXS_BDF1, 0, 0, 0, 100, 0.99, 0, 0},
                                   {METHOD_VBD, "VBD; Chebyshev", 2, GXS_BDF1, 0, 0, 0, 50, 0.99, 0, 0}};

enum { SETTINGS = sizeof settings / sizeof settings[0] };

typedef struct scene {
    const scene_kind *kind;
    gx_body *body;
    gxs_model model;
    double *mass;                  /* count: row sums */
    double *reference[2][MOMENTS]; /* count x 3; consistent and lumped mass; all but the last NULL at rest */
    size_t count, frames;
    double fall; /* J: the most that potential energy has fallen */
} scene;

/* What a run left */
typedef struct outcome {
    double ms; /* per simulated second */
    double error, worst, energy_end, energy_most;
    const char *note; /* not NULL: no motion */
} outcome;

static double processor(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void must(gx_result result, const char *what) {
    if (result == GX_OK) return;
    fprintf(stderr, "front: %s: %s\n", what, gx_result_text(result));
    exit(1);
}

static double *vector(const scene *s) { return (double *)local_memory(3 * s->count, sizeof(double)); }

/* ---- scenes ---- */

/* A plate of 0.61 x 0.11 x 0.01 m in five slices, the lowest of 1/15 of its thickness, held at one end */
static gx_body *slab(double young) {
    enum { X = 61, Y = 11, NODES = (X + 1) * (Y + 1) * 2, ELEMENTS = 5 * X * Y };
    static const unsigned corners[5][4] = {{0, 5, 3, 6}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 6, 5, 0}, {7, 5, 6, 3}};
    static const double edge = 0.01, levels[4] = {1.0 / 15, 3.0 / 15, 6.0 / 15, 10.0 / 15};
    static double positions[3 * NODES];
    static uint32_t elements[4 * ELEMENTS];
    const gx_region end = gx_region_half_space(0, -1, 1e-9);
    gx_body_desc desc;
    gx_body *body;
    size_t x, y, z, t, c, at = 0;
    for (z = 0; z < 2; z++)
        for (y = 0; y <= Y; y++)
            for (x = 0; x <= X; x++) {
                positions[at++] = (double)x * edge;
                positions[at++] = (double)y * edge;
                positions[at++] = (double)z * edge;
            }
    for (at = y = 0; y < Y; y++)
        for (x = 0; x < X; x++)
            for (t = 0; t < 5; t++)
                for (c = 0; c < 4; c++) {
                    const unsigned mirrored = (x + y) & 1,
                                   corner = corners[t][mirrored && c > 1 ? 5 - c : c] ^ mirrored;
                    elements[at++] =
                        (uint32_t)(((corner >> 2) * (Y + 1) + y + (corner >> 1 & 1)) * (X + 1) + x + (corner & 1));
                }
    memset(&desc, 0, sizeof desc);
    desc.positions = positions;
    desc.node_count = NODES;
    desc.elements = elements;
    desc.element_count = ELEMENTS;
    desc.young = young;
    desc.poisson = 0.4;
    desc.density = 1000;
    must(gx_body_create(&desc, &body, NULL), "slab");
    for (c = 0; c < 4; c++) must(block_cut_rectangle(body, 2, levels[c] * edge, -0.1, 1.1), "cut");
    must(gx_body_hold(body, &end, 1, NULL), "hold");
    return body;
}

static void scene_make(scene *s, const scene_kind *kind) {
    local_body masses;
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->frames = kind->damping > 0 ? 60 : 10;
    if (kind->cut < 0)
        s->body = slab(kind->young);
    else {
        block_desc block;
        memset(&block, 0, sizeof block);
        block.cells = kind->cells;
        block.young = kind->young;
        block.cut = kind->cut;
        must(block_create(&block, &s->body), "block");
    }
    must(gx_body_model(s->body, &s->model, NULL), "model");
    s->count = s->model.copy_count;
    local_body_make(&masses, &s->model);
    s->mass = masses.mass;
    masses.mass = NULL;
    local_body_free(&masses);
}

static void scene_free(scene *s) {
    int k;
    for (k = 0; k < 2 * MOMENTS; k++) local_free(s->reference[k / MOMENTS][k % MOMENTS]);
    local_free(s->mass);
    gx_body_destroy(s->body);
}

/* ---- measures ---- */

typedef struct sums {
    double off, moved, farthest, largest, energy_end, energy_most;
} sums;

static double energy_of(const scene *s, const double *u, const double *v, double *potential) {
    double sum = form_energy(&s->model, u);
    size_t i, k;
    for (*potential = 0, i = 0; i < s->count; i++)
        for (k = 0; k < 3; k++) {
            *potential -= s->mass[i] * gravity[k] * u[3 * i + k];
            sum += 0.5 * s->mass[i] * v[3 * i + k] * v[3 * i + k];
        }
    return sum + *potential;
}

static void add_moment(const scene *s, const double *u, const double *v, const double *truth, sums *to) {
    double potential;
    size_t i, k;
    for (i = 0; i < s->count; i++) {
        double off = 0, moved = 0;
        for (k = 0; k < 3; k++) {
            off += (u[3 * i + k] - truth[3 * i + k]) * (u[3 * i + k] - truth[3 * i + k]);
            moved += truth[3 * i + k] * truth[3 * i + k];
        }
        to->off += s->mass[i] * off;
        to->moved += s->mass[i] * moved;
        to->farthest = fmax(to->farthest, off);
        to->largest = fmax(to->largest, moved);
    }
    to->energy_end = energy_of(s, u, v, &potential) / s->fall;
    to->energy_most = fmax(to->energy_most, to->energy_end);
}

static outcome outcome_of(const sums *all, double seconds, double duration) {
    outcome o;
    memset(&o, 0, sizeof o);
    o.ms = 1e3 * seconds / duration;
    o.error = sqrt(all->off / all->moved);
    o.worst = sqrt(all->farthest / all->largest);
    o.energy_end = all->energy_end;
    o.energy_most = all->energy_most;
    return o;
}

/* ---- runs ---- */

/* One of the three methods with a body */
typedef struct mover {
    const scene *scene;
    const setting *how;
    double *u, *v;
    gxs_solver *solver;
    gxs_step_desc step;
    double *history; /* 4 x count x 3 */
    local_xpbd xpbd;
    local_vbd vbd;
} mover;

/* Are the masses of the method lumped? */
static int is_lumped(const setting *how) { return how->kind != METHOD_OURS || how->lumped; }

static void mover_make(mover *m, const scene *s, const setting *how) {
    gxs_model model = s->model;
    int k;
    memset(m, 0, sizeof *m);
    m->scene = s;
    m->how = how;
    m->u = vector(s);
    m->v = vector(s);
    if (how->kind == METHOD_XPBD) local_xpbd_make(&m->xpbd, &s->model);
    if (how->kind == METHOD_VBD) local_vbd_make(&m->vbd, &s->model);
    if (how->kind != METHOD_OURS) return;
    m->history = (double *)local_memory(12 * s->count, sizeof(double));
    must(gxs_solver_create(NULL, &m->solver, NULL), "solver");
    model.lumped_mass = (uint32_t)is_lumped(how);
    must(gxs_solver_set_model(m->solver, &model, NULL), "model");
    m->step.dt = frame / how->parts;
    memcpy(m->step.gravity, gravity, sizeof gravity);
    m->step.integrator = how->integrator;
    m->step.cg_tolerance = how->cg_tolerance;
    m->step.newton_iterations = how->newton;
    m->step.newton_tolerance = how->newton_tolerance;
    m->step.mass_damping = s->kind->damping;
    if (how->integrator == GXS_EXPLICIT)
        m->step.substeps = (uint32_t)how->count;
    else
        m->step.quick = (uint32_t)how->count;
    m->step.quality = how->quality;
    if (how->integrator == GXS_EXPLICIT || how->quality > 0 || how->count > 0) {
        /* they make what explicit and quick steps need of the model: once, as set_model does */
        const gxs_scene none = {{0, 0, 0}, 0, 0, 0};
        for (k = 0; k < 2; k++) must(gxs_solver_step(m->solver, &m->step, m->u, m->v, NULL, NULL), "step");
        gxs_solver_resume(m->solver, &none);
        memset(m->u, 0, 3 * s->count * sizeof *m->u);
        memset(m->v, 0, 3 * s->count * sizeof *m->v);
    }
}

static void mover_free(mover *m) {
    local_free(m->u);
    local_free(m->v);
    local_free(m->history);
    gxs_solver_destroy(m->solver);
    if (m->how->kind == METHOD_XPBD) local_xpbd_free(&m->xpbd);
    if (m->how->kind == METHOD_VBD) local_vbd_free(&m->vbd);
}

static int move_ours(mover *m) {
    const size_t size = 3 * m->scene->count;
    double *before = m->history, *now = m->history + 2 * size;
    gx_result result;
    memcpy(now, m->u, size * sizeof(double));
    memcpy(now + size, m->v, size * sizeof(double));
    result = gxs_solver_step(m->solver, &m->step, m->u, m->v, NULL, NULL);
    memcpy(before, now, 2 * size * sizeof(double));
    m->step.previous_displacement = before;
    m->step.previous_velocity = before + size;
    m->step.previous_dt = m->step.dt;
    return result == GX_OK;
}

/* A frame; 0: it failed. */
static int move_frame(mover *m) {
    const scene *s = m->scene;
    local_vbd_desc desc;
    int i;
    if (m->how->kind == METHOD_OURS) {
        for (i = 0; i < m->how->parts; i++)
            if (!move_ours(m)) return 0;
        return 1;
    }
    if (m->how->kind == METHOD_XPBD) {
        local_xpbd_step(&m->xpbd, frame, gravity, s->kind->damping, m->how->count);
        return local_is_bounded(&m->xpbd.body, 100);
    }
    memset(&desc, 0, sizeof desc);
    desc.dt = frame / m->how->parts;
    memcpy(desc.gravity, gravity, sizeof gravity);
    desc.damping = s->kind->damping;
    desc.iterations = m->how->count;
    desc.rho = m->how->rho;
    desc.symmetric = desc.rho > 0;
    for (i = 0; i < m->how->parts; i++) local_vbd_step(&m->vbd, &desc);
    return local_is_bounded(&m->vbd.body, 100);
}

static void mover_read(mover *m) {
    const local_body *b = m->how->kind == METHOD_XPBD ? &m->xpbd.body : &m->vbd.body;
    if (m->how->kind == METHOD_OURS) return;
    local_read(b->u, b->count, m->u);
    local_read(b->v, b->count, m->v);
}

/* The least of as many runs, of which each does the same */
static outcome run(const scene *s, const setting *how, int repeats) {
    outcome best;
    int k;
    memset(&best, 0, sizeof best);
    for (k = 0; k < repeats; k++) {
        sums all;
        outcome o;
        mover m;
        double spent = 0;
        size_t i;
        memset(&all, 0, sizeof all);
        mover_make(&m, s, how);
        for (i = 0; i < s->frames; i++) {
            const double begin = processor();
            const int moved = move_frame(&m);
            spent += processor() - begin;
            if (!moved) {
                best.note = "not finite or beyond 100 m";
                break;
            }
            mover_read(&m);
            if (s->kind->damping > 0 ? i + 1 == s->frames : 1)
                add_moment(s, m.u, m.v, s->reference[is_lumped(how)][s->kind->damping > 0 ? MOMENTS - 1 : i], &all);
        }
        mover_free(&m);
        if (best.note) return best;
        o = outcome_of(&all, spent, (double)s->frames * frame);
        if (k == 0 || o.ms < best.ms) best = o;
    }
    return best;
}

/* The motion by small steps, or the balance; also the most that potential energy falls */
static void find_reference(scene *s, int lumped) {
    const int rests = s->kind->damping > 0;
    setting fine = {METHOD_OURS, "", 1, GXS_MIDPOINT, 1e-3, 20, 1e-7, 0, 0, 0, 0};
    mover m;
    double potential;
    int k;
    fine.lumped = lumped;
    fine.parts = s->kind->parts;
    if (rests) {
        fine.integrator = GXS_STATIC;
        fine.newton = 200;
        fine.newton_tolerance = 1e-9;
    }
    mover_make(&m, s, &fine);
    if (rests) m.step.dt = 0;
    for (k = rests ? MOMENTS - 1 : 0; k < MOMENTS; k++) {
        if (!move_frame(&m)) must(GX_ERROR_DIVERGED, "reference");
        s->reference[lumped][k] = vector(s);
        memcpy(s->reference[lumped][k], m.u, 3 * s->count * sizeof(double));
        energy_of(s, m.u, m.v, &potential);
        s->fall = fmax(s->fall, -potential);
    }
    mover_free(&m);
}

/* ---- rows ---- */

enum { LEVELS = 5, METHODS = 3 };

static const double levels[LEVELS] = {0.1, 0.05, 0.03, 0.01, 4e-3};

/* Least times by which methods reach the levels; 0: never */
static double least[METHODS][LEVELS];

static void print_row(const scene *s, const setting *how, const outcome *o) {
    const char *state = s->kind->damping > 0 ? "rest" : "motion";
    char head[128];
    snprintf(head, sizeof head, "%s,%s,%lu,%s,%.4g,%g,%d,%g", s->kind->name, state, (unsigned long)(3 * s->count),
             how->method, 1e3 * frame / how->parts, how->cg_tolerance,
             how->kind == METHOD_OURS && how->count == 0 ? (int)how->newton : how->count, how->rho);
    if (o->note)
        csv_row("%s,,,,,,%s", head, o->note);
    else
        csv_row("%s,%.2f,%.3e,%.3e,%.4f,%.4f,", head, o->ms, o->error, o->worst, o->energy_end, o->energy_most);
}

static void keep_least(const setting *how, const outcome *o) {
    int k;
    for (k = 0; k < LEVELS && !o->note; k++)
        if (o->error <= levels[k] && (least[how->kind][k] <= 0 || o->ms < least[how->kind][k]))
            least[how->kind][k] = o->ms;
}

static void print_least(const scene *s) {
    static const char *const names[METHODS] = {"gxfem", "XPBD", "VBD"};
    int i, k;
    progress_clear();
    fprintf(stderr, "%s, %s, %lu unknowns: ms per simulated second at errors of", s->kind->name,
            s->kind->damping > 0 ? "at rest" : "in motion", (unsigned long)(3 * s->count));
    for (k = 0; k < LEVELS; k++) fprintf(stderr, " %g", levels[k]);
    fprintf(stderr, "\n");
    for (i = 0; i < METHODS; i++) {
        fprintf(stderr, "  %-6s", names[i]);
        for (k = 0; k < LEVELS; k++)
            if (least[i][k] > 0)
                fprintf(stderr, " %9.1f", least[i][k]);
            else
                fprintf(stderr, " %9s", "-");
        fprintf(stderr, "\n");
    }
}

/* --small leaves out settings that take long. */
static int is_long(const setting *how) { return how->parts > 4 || how->count > 50; }

int main(int argc, char **argv) {
    int small;
    const char *path = csv_arguments(argc, argv, &small);
    size_t i, j;
    csv_open(argv[0], path,
             "scene,state,unknowns,method,dt_ms,cg_tolerance,iterations,rho,ms_per_second,error,worst,energy_end,"
             "energy_most,note");
    for (i = 0; i < SCENES; i++) {
        scene s;
        if (small && !scene_kinds[i].small) continue;
        progress_draw("front", i * SETTINGS, SCENES * SETTINGS, scene_kinds[i].name);
        scene_make(&s, &scene_kinds[i]);
        find_reference(&s, 0);
        find_reference(&s, 1);
        memset(least, 0, sizeof least);
        for (j = 0; j < SETTINGS; j++) {
            outcome o;
            if (small && is_long(&settings[j])) continue;
            o = run(&s, &settings[j], is_long(&settings[j]) ? 1 : 2);
            print_row(&s, &settings[j], &o);
            keep_least(&settings[j], &o);
            progress_draw("front", i * SETTINGS + j + 1, SCENES * SETTINGS, settings[j].method);
        }
        print_least(&s);
        scene_free(&s);
    }
    return csv_close();
}
