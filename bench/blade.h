/* blade.h - scenes of gx_blade: lattices of unit cubes, six tetrahedra each, that swing by steps or follow a given
   motion, and edges that are moved through them. A scene says how many fragments must come of it. test_blade.c and
   blade.c of the benches run them.

   Lengths are in cubes; a stage can be of another size and elsewhere. Include after gxfem.h. */
#ifndef GXFEM_BENCH_BLADE_H
#define GXFEM_BENCH_BLADE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "splitmix.h"

/* What a stage's moves have been */
typedef struct stage_tally {
    size_t moves, triangles, divided; /* elements that strips have touched, each as often as it was */
    size_t layers;                    /* the most */
    size_t inverted;                  /* cells inside out when the edge was moved, summed over the moves */
    double deviation;                 /* the largest, m */
    double link;                      /* the smallest min_link_ratio */
    double volume;                    /* the largest relative error of the body's volume */
    double seconds, slowest;          /* of the moves; 0 without a clock */
    double cutting;                   /* s: the part of it in which the body was cut */
} stage_tally;

typedef struct stage {
    gx_body *body;
    gx_view view;
    gx_blade *blade;
    double *rest; /* node_count x 3, cubes */
    uint32_t cells[3];
    double scale, origin[3]; /* of a cube, m; of the lattice's first node, m */
    double swing;            /* m/s2: the force of the scenes that step */
    double noise;            /* cubes: added to each displacement after a step or a pose */
    uint64_t random;
    double volume;               /* of the body, m3 */
    double overlap;              /* cubes: how far pieces had come into each other before they were cut */
    double (*clock)(void *user); /* or NULL */
    gx_failure failure;          /* of the first call that failed; the calls after it do nothing */
    stage_tally tally;
} stage;

/* ---- random numbers ---- */

/* From -1 to 1 */
static inline double stage_uniform(stage *s) { return ldexp((double)(splitmix64(&s->random) >> 11), -52) - 1; }

/* ---- the body ---- */

static inline int stage_ok(const stage *s) { return s->failure.result == GX_OK; }

static inline double stage_time(const stage *s) { return s->clock ? s->clock(NULL) : 0; }

static inline void stage_look(stage *s) {
    if (stage_ok(s)) gx_body_view(s->body, &s->view, &s->failure);
    if (stage_ok(s)) s->tally.volume = fmax(s->tally.volume, fabs(s->view.volume / s->volume - 1));
}

static inline void stage_clear_tally(stage *s) {
    memset(&s->tally, 0, sizeof s->tally);
    s->tally.link = 1;
}

/* The six tetrahedra around the diagonal from corner 0 to corner 7 of a cube; bits 0, 1, 2 of a corner are its steps */
static inline void stage_fill_cube(const stage *s, const uint32_t at[3], uint32_t *elements) {
    static const uint32_t corners[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                           {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    int t, c;
    for (t = 0; t < 6; t++)
        for (c = 0; c < 4; c++) {
            const uint32_t corner = corners[t][c], x = at[0] + (corner & 1), y = at[1] + (corner >> 1 & 1),
                           z = at[2] + (corner >> 2);
            elements[4 * t + c] = x + (s->cells[0] + 1) * (y + (s->cells[1] + 1) * z);
        }
}

static inline void stage_fill(stage *s, double *positions, uint32_t *elements, double jitter) {
    const uint32_t *n = s->cells;
    uint32_t at[3];
    double *x = s->rest;
    int k, inner;
    for (at[2] = 0; at[2] <= n[2]; at[2]++)
        for (at[1] = 0; at[1] <= n[1]; at[1]++)
            for (at[0] = 0; at[0] <= n[0]; at[0]++) {
                for (k = 0, inner = 1; k < 3; k++) inner = inner && at[k] > 0 && at[k] < n[k];
                for (k = 0; k < 3; k++, x++, positions++) {
                    *x = at[k] + (inner ? jitter * stage_uniform(s) : 0);
                    *positions = s->origin[k] + s->scale * *x;
                }
                if (at[0] == n[0] || at[1] == n[1] || at[2] == n[2]) continue;
                stage_fill_cube(s, at, elements);
                elements += 24;
            }
}

/* Makes the body, held at its top, and a blade. Set what is not zero before: cells, scale, origin, swing, noise,
   random, clock. young: Pa. jitter: of inner nodes, cubes. */
static inline void stage_open(stage *s, double young, double jitter, const gx_blade_desc *blade) {
    const uint32_t *n = s->cells;
    const size_t nodes = (size_t)(n[0] + 1) * (n[1] + 1) * (n[2] + 1), elements = (size_t)n[0] * n[1] * n[2] * 6;
    double *positions = (double *)malloc(nodes * 3 * sizeof *positions);
    uint32_t *corners = (uint32_t *)malloc(elements * 4 * sizeof *corners);
    gx_body_desc desc;
    gx_region top = gx_region_half_space(2, 1, 0);
    memset(&desc, 0, sizeof desc);
    memset(&s->failure, 0, sizeof s->failure);
    stage_clear_tally(s);
    s->body = NULL;
    s->blade = NULL;
    s->overlap = 0;
    if (!(s->scale > 0)) s->scale = 1;
    s->volume = (double)n[0] * n[1] * n[2] * s->scale * s->scale * s->scale;
    s->rest = (double *)malloc(nodes * 3 * sizeof *s->rest);
    if (!positions || !corners || !s->rest) abort();
    stage_fill(s, positions, corners, jitter);
    desc.positions = positions;
    desc.node_count = nodes;
    desc.elements = corners;
    desc.element_count = elements;
    desc.young = young;
    desc.poisson = 0.4;
    desc.density = 1;
    desc.clock = s->clock;
    gx_body_create(&desc, &s->body, &s->failure);
    top.value = s->origin[2] + s->scale * (n[2] - 0.01);
    if (stage_ok(s)) gx_body_hold(s->body, &top, 1, &s->failure);
    if (stage_ok(s)) gx_blade_create(s->body, blade, &s->blade, &s->failure);
    stage_look(s);
    free(positions);
    free(corners);
}

static inline void stage_close(stage *s) {
    gx_body_destroy(s->body);
    free(s->rest);
    s->body = NULL;
    s->rest = NULL;
}

static inline void stage_add_noise(stage *s) {
    size_t i;
    if (!(s->noise > 0)) return;
    for (i = 0; i < 3 * s->view.copy_count; i++)
        if (!s->view.copy_held[i / 3]) s->view.displacement[i] += s->scale * s->noise * stage_uniform(s);
}

/* A step under gravity, m/s2 */
static inline void stage_step(stage *s, double x, double y, double z) {
    gx_step_desc step;
    if (!stage_ok(s)) return;
    memset(&step, 0, sizeof step);
    step.dt = 0.02;
    step.gravity[0] = x;
    step.gravity[1] = y;
    step.gravity[2] = z;
    gx_body_step(s->body, &step, NULL, &s->failure);
    stage_look(s);
    if (stage_ok(s)) stage_add_noise(s);
}

/* ---- the blade ---- */

/* Cells that are turned inside out now */
static inline size_t stage_inverted(const stage *s) {
    const gx_view *v = &s->view;
    size_t i, count = 0;
    for (i = 0; i < v->cell_count; i++) {
        const uint32_t *c = v->cell_copies + 4 * i;
        double e[3][3];
        int j, k;
        for (j = 0; j < 3; j++)
            for (k = 0; k < 3; k++) {
                const double *a = s->rest + 3 * v->copy_node[c[j + 1]], *b = s->rest + 3 * v->copy_node[c[0]];
                e[j][k] = s->scale * (a[k] - b[k]) + v->displacement[3 * c[j + 1] + (uint32_t)k] -
                          v->displacement[3 * c[0] + (uint32_t)k];
            }
        count += e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                     e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]) <
                 0;
    }
    return count;
}

static inline void stage_count_move(stage *s, const gx_blade_report *r, double time) {
    stage_tally *t = &s->tally;
    if (!stage_ok(s)) return;
    t->moves++;
    t->triangles += r->triangle_count;
    t->divided += r->cut.touched_elements;
    if (r->layer_count > t->layers) t->layers = r->layer_count;
    t->deviation = fmax(t->deviation, r->deviation);
    t->link = fmin(t->link, r->cut.min_link_ratio);
    t->seconds += time;
    t->cutting += r->cut.seconds_arrangement + r->cut.seconds_enrichment + r->cut.seconds_integrals;
    t->slowest = fmax(t->slowest, time);
    stage_look(s);
}

/* edge: count x 3, m */
static inline void stage_move_edge(stage *s, const double *edge, size_t count) {
    gx_blade_report report;
    double start;
    if (!stage_ok(s)) return;
    s->tally.inverted += stage_inverted(s);
    start = stage_time(s);
    gx_blade_move(s->blade, edge, count, NULL, 0, &report, &s->failure);
    stage_count_move(s, &report, stage_time(s) - start);
}

/* A straight edge, cubes, a ten-millionth of one aside: paths in planes of nodes have tests of their own */
static inline void stage_move(stage *s, double ax, double ay, double az, double bx, double by, double bz) {
    double edge[6];
    int i;
    edge[0] = ax;
    edge[1] = ay;
    edge[2] = az;
    edge[3] = bx;
    edge[4] = by;
    edge[5] = bz;
    for (i = 0; i < 6; i++) edge[i] = s->origin[i % 3] + s->scale * (edge[i] + 5e-8 * stage_uniform(s));
    stage_move_edge(s, edge, 2);
}

static inline void stage_lift(stage *s) {
    const double start = stage_time(s);
    gx_blade_report report;
    if (!stage_ok(s)) return;
    gx_blade_lift(s->blade, &report, &s->failure);
    stage_count_move(s, &report, stage_time(s) - start);
}

/* ---- scenes that step ---- */

enum { STAGE_FAR = 20 }; /* half the length of edges, cubes */

static inline void stage_settle(stage *s, int steps, double x) {
    int i;
    for (i = 0; i < steps; i++) stage_step(s, x, 0, -9.8);
}

/* The force swings on two axes; share: of the pass */
static inline void stage_swing(stage *s, double strength, double share, double z) {
    stage_step(s, strength * s->swing * cos(12 * share), strength * s->swing * sin(7.8 * share), z);
}

/* An oblique edge from one side to the other, along y */
static inline void stage_pass_along(stage *s, int frames, double strength, double height) {
    const double nx = s->cells[0], ny = s->cells[1];
    int k;
    for (k = 0; k <= frames; k++) {
        const double share = (double)k / frames, y = -3 + (ny + 6) * share;
        stage_swing(s, strength, share, -9.8);
        stage_move(s, nx / 2 - STAGE_FAR, y, height - 0.4, nx / 2 + STAGE_FAR, y + 0.7, height + 1.1);
    }
}

static inline void scene_swing(stage *s) {
    stage_settle(s, 20, s->swing);
    stage_pass_along(s, 60, 1, 0.45 * s->cells[2]);
}

/* A second pass, down through the upper piece; the lower one has fallen out of its reach. */
static inline void scene_cross(stage *s) {
    const double nx = s->cells[0], nz = s->cells[2];
    int k;
    scene_swing(s);
    stage_lift(s);
    stage_settle(s, 60, 0);
    for (k = 0; k <= 60; k++) {
        const double z = nz + 2 - (nz + 4) * k / 60;
        stage_swing(s, 1, k / 60.0, -3);
        stage_move(s, nx / 2 - 0.3, -STAGE_FAR, z, nx / 2 + 0.6, nx + STAGE_FAR, z + 0.5);
    }
}

/* The blade is held while the body swings through it, then pushed on until there are two pieces. */
static inline void scene_held(stage *s) {
    const double n = s->cells[0];
    int k;
    for (k = 0; k < 600 && s->view.fragment_count < 2; k++) {
        const double x = n + 0.8 - (k > 100 ? (k - 100) * 0.05 : 0);
        stage_step(s, 2 * s->swing * sin(0.05 * k), 0, -9.8);
        stage_move(s, x, -STAGE_FAR, 0.3 * n, x, n + STAGE_FAR, 0.3 * n + 0.5);
    }
}

/* Far below an element's size a frame: most moves wait. */
static inline void scene_slow(stage *s) {
    const double n = s->cells[0];
    const int frames = 40 * (int)s->cells[0];
    int k;
    stage_settle(s, 20, s->swing);
    for (k = 0; k <= frames; k++) {
        const double y = -1 + (n + 2) * k / frames;
        stage_swing(s, 1, (double)k / frames, -9.8);
        stage_move(s, -STAGE_FAR, y, 0.45 * n, STAGE_FAR, y + 0.7, 0.45 * n + 1.1);
    }
}

static inline void stage_cut_plane(stage *s, double x) {
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    const double v[12] = {x, -99, -99, x + 0.01, 99, -99, x, 99, 99, x - 0.01, -99, 99};
    gx_surface sheet;
    gx_cut_desc desc;
    memset(&sheet, 0, sizeof sheet);
    memset(&desc, 0, sizeof desc);
    sheet.vertices = v;
    sheet.vertex_count = 4;
    sheet.triangles = triangles;
    sheet.triangle_count = 2;
    desc.surfaces = &sheet;
    desc.surface_count = 1;
    if (stage_ok(s)) gx_body_cut(s->body, &desc, NULL, &s->failure);
}

/* Nine slices, the inner ones 0.1 cubes thick */
static inline void scene_slices(stage *s) {
    int i;
    for (i = 0; i < 8; i++) stage_cut_plane(s, 0.5 * s->cells[0] + 0.05 + 0.1 * i);
    stage_look(s);
    stage_settle(s, 20, 0.3 * s->swing);
    stage_pass_along(s, 60, 0.3, 0.4 * s->cells[2]);
}

/* A solid takes out the middle below a height, so that two arms hang down. */
static inline void stage_cut_arms(stage *s, double low, double high, double top) {
    static const uint32_t triangles[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                           2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    double v[24];
    gx_surface solid;
    gx_cut_desc desc;
    int i;
    for (i = 0; i < 8; i++) {
        v[3 * i] = i & 1 ? high : low;
        v[3 * i + 1] = i & 2 ? s->cells[1] + 5.0 : -5;
        v[3 * i + 2] = i & 4 ? top : -5;
    }
    memset(&solid, 0, sizeof solid);
    memset(&desc, 0, sizeof desc);
    solid.vertices = v;
    solid.vertex_count = 8;
    solid.triangles = triangles;
    solid.triangle_count = 12;
    solid.kind = GX_SURFACE_SOLID;
    desc.surfaces = &solid;
    desc.surface_count = 1;
    if (stage_ok(s)) gx_body_cut(s->body, &desc, NULL, &s->failure);
    if (stage_ok(s)) gx_body_view(s->body, &s->view, &s->failure);
    if (stage_ok(s)) s->volume = s->view.volume;
}

/* How far the arms have come into each other at the bottom, cubes */
static inline double stage_arms_overlap(const stage *s) {
    const gx_view *v = &s->view;
    const double middle = 0.5 * s->cells[0];
    double left = -HUGE_VAL, right = HUGE_VAL;
    size_t i;
    for (i = 0; i < v->copy_count; i++) {
        const double *x = s->rest + 3 * v->copy_node[i], at = x[0] + v->displacement[3 * i];
        if (x[2] > 0) continue;
        if (x[0] < middle) left = fmax(left, at);
        if (x[0] > middle) right = fmin(right, at);
    }
    return left - right;
}

/* Two arms of one piece, swung into each other, and a pass through both */
static inline void scene_arms(stage *s) {
    const double n = s->cells[0], top = 0.75 * n;
    size_t i;
    int k;
    stage_cut_arms(s, 0.42 * n, 0.58 * n, top);
    for (k = 0; k < 15 && stage_ok(s); k++) {
        for (i = 0; i < s->view.copy_count; i++) {
            const double *x = s->rest + 3 * s->view.copy_node[i];
            if (x[2] < top) s->view.velocity[3 * i] += (x[0] < n / 2 ? 1 : -1) * (1 - x[2] / top) * n / 8;
        }
        stage_step(s, 0, 0, -2);
    }
    s->overlap = stage_arms_overlap(s);
    for (k = 0; k <= 60; k++) {
        const double y = -4 + (n + 8) * k / 60;
        stage_step(s, 0, s->swing * sin(0.13 * k), -2);
        stage_move(s, -STAGE_FAR, y, 0.3 * n, STAGE_FAR + n, y + 0.7, 0.3 * n + 1.1);
    }
}

/* A pass along x at rest, over a share of the block */
static inline void stage_slit(stage *s, double share) {
    const double n = s->cells[0];
    int k;
    for (k = 0; k <= 60; k++) {
        const double x = -2 + (n * share + (share < 1 ? 2 : 4)) * k / 60;
        stage_step(s, 0, 0, 0);
        stage_move(s, x, -STAGE_FAR, n * 0.55, x + 0.2, n + STAGE_FAR, n * 0.55 + 0.3);
    }
    stage_lift(s);
}

/* How far the two sides of the slit have come into each other: copies of one node are displaced by both */
static inline double stage_sides_overlap(const stage *s) {
    const gx_view *v = &s->view;
    double most = 0;
    size_t i, j;
    for (i = 0; i < v->copy_count; i++)
        for (j = 0; j < i; j++)
            if (v->copy_node[i] == v->copy_node[j])
                most = fmax(most, fabs(v->displacement[3 * i + 2] - v->displacement[3 * j + 2]));
    return most;
}

/* The lower half is driven up into the upper one, and a pass goes down through both. */
static inline void scene_over(stage *s) {
    const double n = s->cells[0];
    int k;
    stage_slit(s, 1);
    for (k = 0; k < 40; k++) stage_step(s, 1, 0.5, 6);
    s->overlap = stage_sides_overlap(s);
    for (k = 0; k <= 60; k++) {
        const double y = -4 + (n + 10) * k / 60;
        stage_step(s, -1, 0, 0);
        stage_move(s, 0.4 * n, y, -8, 0.4 * n + 2, y + 0.6, n + 8);
    }
}

/* A slit that ends in the block, whose lower side is driven up through the upper one */
static inline void scene_slit(stage *s) {
    const double n = s->cells[0];
    int k;
    stage_slit(s, 0.9);
    for (k = 0; k < 60; k++) stage_step(s, 0.13 * s->swing, 0, 0.5 * s->swing);
    s->overlap = stage_sides_overlap(s);
    for (k = 0; k <= 60; k++) {
        const double y = -3 + (n + 6) * k / 60;
        stage_step(s, 0.13 * s->swing, 0, 0.5 * s->swing);
        stage_move(s, 0.4 * n, y, -STAGE_FAR, 0.4 * n + 0.4, y + 0.6, n + STAGE_FAR);
    }
}

/* ---- edges that do not go straight on: state of a path, per frame ---- */

typedef struct stage_path {
    double x, y, z, twist;
    int phase;
} stage_path;

/* The next place of a path; 1: it is at its end */
typedef int (*stage_next)(const stage *s, stage_path *p, int frame);

static inline void stage_follow(stage *s, stage_next next) {
    const double n = s->cells[0];
    stage_path p = {0, -3, 0, 0, 0};
    int k;
    p.z = 0.45 * n;
    stage_settle(s, 20, s->swing);
    for (k = 0; k < 400 && stage_ok(s); k++) {
        stage_swing(s, 1, k / 60.0, -9.8);
        if (next(s, &p, k)) break;
        stage_move(s, n / 2 - STAGE_FAR + p.x, p.y - p.twist, p.z, n / 2 + STAGE_FAR + p.x, p.y + 0.3 + p.twist,
                   p.z + 0.5);
    }
    stage_lift(s);
}

/* Back through its own cut, forth, and back */
static inline int next_retreat(const stage *s, stage_path *p, int frame) {
    static const double turns[5] = {0.5, 0.2, 0.7, 0.6, 1};
    const double to = turns[p->phase] * s->cells[1] + (p->phase == 4 ? 6 : 0), way = to > p->y ? 0.3 : -0.3;
    (void)frame;
    p->y += way;
    if (fabs(p->y - to) < 0.3) p->phase++;
    return p->phase == 5;
}

static inline int next_saw(const stage *s, stage_path *p, int frame) {
    p->y += 0.08;
    p->x = 3 * sin(0.7 * frame);
    return p->y > s->cells[1] + 3;
}

/* In, up, and out again on the side that it came from */
static inline int next_uturn(const stage *s, stage_path *p, int frame) {
    (void)frame;
    if (p->phase == 1)
        p->z += 0.3;
    else
        p->y += p->phase == 0 ? 0.3 : -0.3;
    if (p->phase == 0 && p->y > 0.6 * s->cells[1]) p->phase = 1;
    if (p->phase == 1 && p->z > 0.45 * s->cells[2] + 3) p->phase = 2;
    return p->y < -5;
}

/* In, a way back in its cut, and out through the cut's side */
static inline int next_side(const stage *s, stage_path *p, int frame) {
    (void)frame;
    if (p->phase == 2)
        p->z += 0.3;
    else
        p->y += p->phase == 0 ? 0.3 : -0.3;
    if (p->phase == 0 && p->y > 0.6 * s->cells[1]) p->phase = 1;
    if (p->phase == 1 && p->y < 0.25 * s->cells[1]) p->phase = 2;
    return p->z > s->cells[2] + 6;
}

static inline int next_twist(const stage *s, stage_path *p, int frame) {
    p->y += 0.3;
    p->twist = 4 * sin(0.3 * frame);
    return p->y > s->cells[1] + 5;
}

static inline void scene_retreat(stage *s) { stage_follow(s, next_retreat); }
static inline void scene_saw(stage *s) { stage_follow(s, next_saw); }
static inline void scene_uturn(stage *s) { stage_follow(s, next_uturn); }
static inline void scene_side(stage *s) { stage_follow(s, next_side); }
static inline void scene_twist(stage *s) { stage_follow(s, next_twist); }

typedef struct stage_scene {
    const char *name;
    void (*run)(stage *s);
    size_t fragments;
    double swing; /* m/s2 */
} stage_scene;

enum { STAGE_SCENES = 13 };

static const stage_scene stage_scenes[STAGE_SCENES] = {
    {"pass", scene_swing, 2, 6},  {"crossing", scene_cross, 3, 6}, {"held", scene_held, 2, 6},
    {"slow", scene_slow, 2, 6},   {"slices", scene_slices, 18, 6}, {"arms", scene_arms, 3, 6},
    {"over", scene_over, 4, 6},   {"slit", scene_slit, 3, 6},      {"retreat", scene_retreat, 2, 1},
    {"sawing", scene_saw, 2, 6},  {"U-turn", scene_uturn, 2, 6},   {"side", scene_side, 2, 1},
    {"twist", scene_twist, 2, 6},
};

/* Runs a scene on n^3 cubes. The stiffness is such that it is bent alike at any size. */
static inline void stage_play(stage *s, const stage_scene *scene, uint32_t n, const gx_blade_desc *blade) {
    s->cells[0] = s->cells[1] = s->cells[2] = n;
    s->swing = scene->swing;
    stage_open(s, 250.0 * n, 0, blade);
    if (stage_ok(s)) scene->run(s);
}

/* ---- given motions ---- */

/* A motion of all space: x = c + shift + R squeeze (X + wave - c), over a time from 0 to 1 */
typedef struct stage_motion {
    double squeeze[3];           /* factors along the axes, 1: none */
    double axis[3], turn;        /* of R: a unit vector, rad */
    double shift[3];             /* cubes */
    double wave[3], number[3];   /* cubes; rad per cube */
    double rate[3], phase[3][3]; /* of turn, shift and wave: rad in all; rad */
} stage_motion;

enum { STAGE_CALM, STAGE_SWINGING, STAGE_VIOLENT, STAGE_STILL };

static inline void stage_unit(stage *s, double x[3]) {
    double square;
    int k;
    do {
        for (k = 0; k < 3; k++) x[k] = stage_uniform(s);
        square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    } while (square > 1 || square < 0.01);
    for (k = 0; k < 3; k++) x[k] /= sqrt(square);
}

/* Calm: displacements of some tenths of a cube, one swing. Swinging: of a cube, two. Violent: of some cubes, five. */
static inline stage_motion stage_random_motion(stage *s, int kind) {
    const double n = fmax(s->cells[0], fmax(s->cells[1], s->cells[2])), turns[4] = {0.15, 0.3, 0.6, 0},
                 shifts[4] = {0.4, 1, 2, 0}, waves[4] = {0.2, 0.3, 0.4, 0}, rates[4] = {7, 12, 31, 1};
    stage_motion m;
    int i, k;
    stage_unit(s, m.axis);
    m.turn = turns[kind];
    for (k = 0; k < 3; k++) {
        m.squeeze[k] = 1;
        m.shift[k] = shifts[kind] * stage_uniform(s);
        m.wave[k] = waves[kind] * stage_uniform(s);
        m.number[k] = 4 / n * stage_uniform(s);
        m.rate[k] = rates[kind] * (1 + 0.2 * stage_uniform(s));
        for (i = 0; i < 3; i++) m.phase[i][k] = 3 * stage_uniform(s);
    }
    return m;
}

static inline void stage_turn(const double axis[3], double angle, double x[3]) {
    const double c = cos(angle), q = sin(angle), along = axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
    const double y[3] = {x[0], x[1], x[2]};
    int k;
    for (k = 0; k < 3; k++)
        x[k] = c * y[k] + (1 - c) * along * axis[k] +
               q * (axis[(k + 1) % 3] * y[(k + 2) % 3] - axis[(k + 2) % 3] * y[(k + 1) % 3]);
}

/* Where the motion puts a point, cubes */
static inline void stage_place(const stage *s, const stage_motion *m, double time, const double rest[3], double x[3]) {
    double along = 0;
    int k;
    for (k = 0; k < 3; k++) along += m->number[k] * rest[k];
    for (k = 0; k < 3; k++)
        x[k] = m->squeeze[k] *
               (rest[k] - 0.5 * s->cells[k] + m->wave[k] * sin(along + m->rate[2] * time + m->phase[2][k]));
    stage_turn(m->axis, m->turn * sin(m->rate[0] * time + m->phase[0][0]), x);
    for (k = 0; k < 3; k++) x[k] += 0.5 * s->cells[k] + m->shift[k] * sin(m->rate[1] * time + m->phase[1][k]);
}

/* The same, interpolated between the nodes of the lattice, as the body does it; beyond it by more nodes */
static inline void stage_interpolate(const stage *s, const stage_motion *m, double time, const double rest[3],
                                     double x[3]) {
    double node[3], part[3], at[3], last = 1;
    int order[3] = {0, 1, 2}, i, k;
    for (k = 0; k < 3; k++) {
        node[k] = floor(rest[k]);
        part[k] = rest[k] - node[k];
    }
    for (i = 0; i < 2; i++)
        for (k = 0; k < 2; k++)
            if (part[order[k]] < part[order[k + 1]]) {
                const int first = order[k];
                order[k] = order[k + 1];
                order[k + 1] = first;
            }
    x[0] = x[1] = x[2] = 0;
    for (i = 0; i < 4; i++) {
        const double next = i < 3 ? part[order[i]] : 0;
        stage_place(s, m, time, node, at);
        for (k = 0; k < 3; k++) x[k] += (last - next) * at[k];
        if (i < 3) node[order[i]] += 1;
        last = next;
    }
}

/* Displaces all copies as the motion does, held ones too. */
static inline void stage_pose(stage *s, const stage_motion *m, double time) {
    size_t i;
    int k;
    for (i = 0; i < s->view.copy_count && stage_ok(s); i++) {
        const double *rest = s->rest + 3 * s->view.copy_node[i];
        double x[3];
        stage_place(s, m, time, rest, x);
        for (k = 0; k < 3; k++)
            s->view.displacement[3 * i + (size_t)k] =
                s->scale * (x[k] - rest[k] + (s->noise > 0 ? s->noise * stage_uniform(s) : 0));
    }
}

/* ---- a known sheet ---- */

/* x[up] = height + slope along the others + a wave; the edge lies along x[up + 1] and goes along x[up + 2]. */
typedef struct stage_sheet {
    int up;
    double height, slope[2], wave, number[2], phase; /* cubes; cubes; rad per cube; rad */
} stage_sheet;

static inline stage_sheet stage_random_sheet(stage *s) {
    stage_sheet sheet;
    double n;
    sheet.up = (int)(splitmix64(&s->random) % 3);
    n = s->cells[sheet.up];
    sheet.height = n * (0.5 + 0.08 * stage_uniform(s));
    sheet.slope[0] = 0.15 * stage_uniform(s);
    sheet.slope[1] = 0.15 * stage_uniform(s);
    sheet.wave = 0.06 * n * stage_uniform(s);
    sheet.number[0] = 4 / n * stage_uniform(s);
    sheet.number[1] = 4 / n * stage_uniform(s);
    sheet.phase = 3 * stage_uniform(s);
    return sheet;
}

/* The sheet's height over a place, and how steep it is there */
static inline double stage_height(const stage *s, const stage_sheet *sheet, double u, double v, double *steep) {
    const double *c = sheet->number, a = c[0] * u + c[1] * v + sheet->phase,
                 p = sheet->slope[0] + sheet->wave * c[0] * cos(a), q = sheet->slope[1] + sheet->wave * c[1] * cos(a);
    const double cu = 0.5 * s->cells[(sheet->up + 1) % 3], cv = 0.5 * s->cells[(sheet->up + 2) % 3];
    *steep = sqrt(1 + p * p + q * q);
    return sheet->height + sheet->slope[0] * (u - cu) + sheet->slope[1] * (v - cv) + sheet->wave * sin(a);
}

static inline void stage_on_sheet(const stage *s, const stage_sheet *sheet, double u, double v, double x[3]) {
    double steep;
    x[sheet->up] = stage_height(s, sheet, u, v, &steep);
    x[(sheet->up + 1) % 3] = u;
    x[(sheet->up + 2) % 3] = v;
}

enum { STAGE_EDGE = 129 }; /* points of an edge that follows a sheet */

/* The sheet's line at a time from 0 to 1, 2 cubes beyond the block on each side, m */
static inline void stage_edge_on_sheet(const stage *s, const stage_sheet *sheet, const stage_motion *m, double time,
                                       double *edge) {
    const double nu = s->cells[(sheet->up + 1) % 3], nv = s->cells[(sheet->up + 2) % 3];
    int i, k;
    for (i = 0; i < STAGE_EDGE; i++) {
        double rest[3], x[3];
        stage_on_sheet(s, sheet, -2 + (nu + 4) * i / (STAGE_EDGE - 1), -2 + (nv + 4) * time, rest);
        stage_interpolate(s, m, time, rest, x);
        for (k = 0; k < 3; k++) edge[3 * i + k] = s->origin[k] + s->scale * x[k];
    }
}

static inline void stage_follow_sheet(stage *s, const stage_sheet *sheet, const stage_motion *m, int frames) {
    double edge[3 * STAGE_EDGE];
    int k;
    for (k = 0; k <= frames; k++) {
        stage_pose(s, m, (double)k / frames);
        stage_edge_on_sheet(s, sheet, m, (double)k / frames, edge);
        stage_move_edge(s, edge, STAGE_EDGE);
    }
    stage_lift(s);
}

/* Distances of the cut's walls from the sheet: vertices of their triangles in the skin, cubes */
static inline double stage_wall_error(stage *s, const stage_sheet *sheet, double *mean_square) {
    double most = 0, sum = 0;
    size_t i, count = 0;
    gx_skin skin;
    *mean_square = 0;
    if (stage_ok(s)) gx_body_skin(s->body, NULL, &skin, &s->failure);
    for (i = 0; stage_ok(s) && i < 3 * skin.triangle_count; i++) {
        const double *rest = skin.vertex_rest + 3 * (size_t)skin.triangles[i];
        double x[3], steep, off;
        int k;
        if (skin.triangle_surface[i / 3] == GX_SKIN_OUTER) continue;
        for (k = 0; k < 3; k++) x[k] = (rest[k] - s->origin[k]) / s->scale;
        off = x[sheet->up] - stage_height(s, sheet, x[(sheet->up + 1) % 3], x[(sheet->up + 2) % 3], &steep);
        most = fmax(most, fabs(off) / steep);
        sum += off * off / (steep * steep);
        count++;
    }
    if (count > 0) *mean_square = sum / (double)count;
    return most;
}

/* Cuts by the sheet itself: squares of two triangles, n along each axis. */
static inline void stage_cut_sheet(stage *s, const stage_sheet *sheet, uint32_t n) {
    const double nu = s->cells[(sheet->up + 1) % 3], nv = s->cells[(sheet->up + 2) % 3];
    double *vertices = (double *)malloc(3 * (size_t)(n + 1) * (n + 1) * sizeof *vertices);
    uint32_t *triangles = (uint32_t *)malloc(6 * (size_t)n * n * sizeof *triangles), *t = triangles, i, j;
    gx_surface surface;
    gx_cut_desc desc;
    int k;
    if (!vertices || !triangles) abort();
    for (j = 0; j <= n; j++)
        for (i = 0; i <= n; i++) {
            double *x = vertices + 3 * (size_t)(j * (n + 1) + i);
            stage_on_sheet(s, sheet, -2.01 + (nu + 4) * i / n, -2.02 + (nv + 4) * j / n, x);
            for (k = 0; k < 3; k++) x[k] = s->origin[k] + s->scale * x[k];
        }
    for (j = 0; j < n; j++)
        for (i = 0; i < n; i++, t += 6) {
            const uint32_t a = j * (n + 1) + i, b = a + n + 1, corners[6] = {a, a + 1, b + 1, a, b + 1, b};
            memcpy(t, corners, sizeof corners);
        }
    memset(&surface, 0, sizeof surface);
    memset(&desc, 0, sizeof desc);
    surface.vertices = vertices;
    surface.vertex_count = (size_t)(n + 1) * (n + 1);
    surface.triangles = triangles;
    surface.triangle_count = 2 * (size_t)n * n;
    desc.surfaces = &surface;
    desc.surface_count = 1;
    if (stage_ok(s)) gx_body_cut(s->body, &desc, NULL, &s->failure);
    stage_look(s);
    free(vertices);
    free(triangles);
}

/* ---- rigid motions ---- */

/* Of an edge through a block: turned about the block's middle, then shifted; back: the other way round */
static inline void stage_place_rigidly(const stage *s, double time, int back, const double from[3], double to[3]) {
    static const double axis[3] = {0.6, 0, 0.8};
    const double angle = 0.7 * sin(2 * time), middle = 0.5 * s->cells[0],
                 shift[3] = {0.5 * sin(5 * time), (s->cells[0] + 6.0) * time, 0.4 * sin(4 * time)};
    int k;
    for (k = 0; k < 3; k++) to[k] = from[k] - middle - (back ? shift[k] : 0);
    stage_turn(axis, back ? -angle : angle, to);
    for (k = 0; k < 3; k++) to[k] += middle + (back ? 0 : shift[k]);
}

/* The blade through the still body, or the body through the still blade: the same path. Two pieces come of it. */
static inline void stage_pass_rigidly(stage *s, int body_moves, int frames) {
    const double middle = 0.5 * s->cells[0],
                 still[6] = {middle - STAGE_FAR, -3, middle - 0.4, middle + STAGE_FAR, -2.6, middle + 0.3};
    double edge[6];
    size_t c;
    int i, k;
    for (i = 0; i <= frames; i++) {
        const double time = (double)i / frames;
        memcpy(edge, still, sizeof edge);
        if (!body_moves) {
            stage_place_rigidly(s, time, 0, still, edge);
            stage_place_rigidly(s, time, 0, still + 3, edge + 3);
        }
        for (c = 0; c < s->view.copy_count && body_moves; c++) {
            const double *rest = s->rest + 3 * s->view.copy_node[c];
            double x[3];
            stage_place_rigidly(s, time, 1, rest, x);
            for (k = 0; k < 3; k++) s->view.displacement[3 * c + (size_t)k] = x[k] - rest[k];
        }
        stage_move_edge(s, edge, 2);
    }
    stage_lift(s);
}

/* ---- random passes ---- */

/* A straight edge through the middle of a block that follows a random motion. Two pieces come of it. */
static inline void stage_random_pass(stage *s, const stage_motion *m, int frames) {
    const double far = 3 + 0.87 * fmax(s->cells[0], fmax(s->cells[1], s->cells[2]));
    double along[3], other[3], way[3], length;
    int i, k;
    do {
        stage_unit(s, along);
        stage_unit(s, other);
        for (k = 0; k < 3; k++)
            way[k] = along[(k + 1) % 3] * other[(k + 2) % 3] - along[(k + 2) % 3] * other[(k + 1) % 3];
        length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    } while (length < 0.1);
    for (i = 0; i <= frames && stage_ok(s); i++) {
        double edge[6];
        for (k = 0; k < 6; k++)
            edge[k] = s->origin[k % 3] +
                      s->scale * (0.5 * s->cells[k % 3] + way[k % 3] / length * far * (2.0 * i / frames - 1) +
                                  (k < 3 ? -STAGE_FAR : STAGE_FAR) * along[k % 3]);
        stage_pose(s, m, (double)i / frames);
        stage_move_edge(s, edge, 2);
    }
    stage_lift(s);
}

#endif /* GXFEM_BENCH_BLADE_H */
