/* violent.c - starts from which Newton's method is known to fail. Does the energy fall, does the step end, does the
   body find its shape?

   make bench-violent builds and runs it. It prints CSV and writes it to build/bench/violent.csv, and a table to
   stderr. usage: violent [FILE [--small]]; --small: the uncut block only.

   The block of block.h, 4^3 cells, E = 1e6 Pa, no gravity, not held: uncut, accordion, loose. Displaced at the
   start:
       random      each node along each axis by up to one edge
       stretched   by 3 along all axes
       inverted    turned inside out: mirrored along z
       flattened   into a plane
       collapsed   to a point, where all forces vanish

   One step to balance: k = 1, 2, ... Newton iterations, each from the start, at most 40. So the results are the
   iterates that the longest run accepted.
       rises       iterates whose E is above the one before by more than 1e-12 of it
       not_finite  numbers of all states that are not finite
       stop        of the last: balance, iterations (the budget is used up), rounding
       residual    of the last; energy: E of the start and of the last, J

   Then frames of one Newton iteration each, as in a scene, up to 300:
       frames      until kinetic and elastic energy together are below 1e-6 of the start's; for a collapsed body, of
                   the elastic energy of its compression
       left        that share after the last frame */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "block.h"
#include "csv.h"
#include "forms.h"
#include "progress.h"

#include <math.h>
#include <stdio.h>

enum {
    CELLS = 4,
    MOST_ITERATIONS = 40,
    MOST_FRAMES = 300,
    RANDOM = 0,
    STRETCHED,
    INVERTED,
    FLATTENED,
    COLLAPSED,
    STARTS
};

static const char *const start_names[STARTS] = {"random", "stretched", "inverted", "flattened", "collapsed"};
static const char *const stop_names[] = {"balance", "iterations", "seconds", "rounding", "asleep"};
static const double steps[2] = {0.033, 1}, ratios[2] = {0.4, 0.4999}; /* s; of Poisson */

typedef struct problem {
    gx_body *body;
    gxs_model model;
    gxs_material material;
    gxs_solver *solver;
    double *start, *displacement, *velocity, *momentum; /* 3 copy_count */
    size_t count;                                       /* of unknowns */
    double energy;                                      /* of the start, J */
} problem;

typedef struct outcome {
    uint32_t iterations, frames; /* frames 0: not in MOST_FRAMES */
    size_t rises, not_finite;
    gxs_step_report last;
    double left;
} outcome;

static void check(gx_result result) {
    if (result == GX_OK) return;
    fprintf(stderr, "violent: %s\n", gx_result_text(result));
    exit(1);
}

/* From -1 to 1: the same numbers on every machine (Numerical Recipes' linear congruential generator, upper bits) */
static double uniform(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) / 8388608.0 - 1.0;
}

static double displaced(int how, size_t axis, double rest, uint32_t *state) {
    switch (how) {
    case RANDOM: return uniform(state) / CELLS;
    case STRETCHED: return 2 * rest;
    case INVERTED: return axis == 2 ? -2 * rest : 0;
    case FLATTENED: return axis == 2 ? -rest : 0;
    default: return -rest;
    }
}

static void make(problem *p, int cut, int how, double ratio) {
    block_desc desc;
    uint32_t state = 1;
    size_t i;
    memset(p, 0, sizeof *p);
    memset(&desc, 0, sizeof desc);
    desc.cells = CELLS;
    desc.cut = cut;
    desc.young = 1e6;
    check(block_create(&desc, &p->body));
    check(gx_body_model(p->body, &p->model, NULL));
    p->material = p->model.materials[0];
    p->material.poisson = ratio;
    p->model.materials = &p->material;
    p->model.held = NULL;
    p->count = 3 * p->model.copy_count;
    p->start = (double *)malloc(4 * p->count * sizeof(double));
    check(p->start ? gxs_solver_create(NULL, &p->solver, NULL) : GX_ERROR_MEMORY);
    p->displacement = p->start + p->count;
    p->velocity = p->start + 2 * p->count;
    p->momentum = p->start + 3 * p->count;
    for (i = 0; i < p->count; i++) p->start[i] = displaced(how, i % 3, p->model.positions[i], &state);
    p->energy = form_energy(&p->model, p->start);
}

static void destroy(problem *p) {
    gxs_solver_destroy(p->solver);
    free(p->start);
    gx_body_destroy(p->body);
}

static void rewind_to_start(problem *p) {
    memcpy(p->displacement, p->start, p->count * sizeof(double));
    memset(p->velocity, 0, p->count * sizeof(double));
    check(gxs_solver_set_model(p->solver, &p->model, NULL));
}

static size_t not_finite(const problem *p) {
    size_t i, n = 0;
    for (i = 0; i < p->count; i++) n += !(fabs(p->displacement[i]) < HUGE_VAL) || !(fabs(p->velocity[i]) < HUGE_VAL);
    return n;
}

static void step_to_balance(problem *p, double dt, outcome *o) {
    double before = p->energy;
    gxs_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    do {
        step.newton_iterations = ++o->iterations;
        rewind_to_start(p);
        check(gxs_solver_step(p->solver, &step, p->displacement, p->velocity, &o->last, NULL));
        o->rises += !(o->last.energy <= before + 1e-12 * fabs(before));
        o->not_finite += not_finite(p);
        before = o->last.energy;
    } while (o->iterations < MOST_ITERATIONS && o->last.newton_iterations == o->iterations &&
             o->last.stop == GXS_STOP_ITERATIONS);
}

/* Kinetic and elastic, J */
static double total_energy(problem *p) {
    double energy;
    size_t i;
    energy = form_energy(&p->model, p->displacement);
    form_mass_product(&p->model, p->velocity, p->momentum);
    for (i = 0; i < p->count; i++) energy += 0.5 * p->velocity[i] * p->momentum[i];
    return energy;
}

static void play(problem *p, double dt, outcome *o) {
    uint32_t frame;
    gxs_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    rewind_to_start(p);
    for (frame = 1; frame <= MOST_FRAMES && !o->frames; frame++) {
        check(gxs_solver_step(p->solver, &step, p->displacement, p->velocity, NULL, NULL));
        o->not_finite += not_finite(p);
        o->left = total_energy(p) / p->energy;
        if (o->left < 1e-6) o->frames = frame;
    }
}

static outcome run(int cut, int how, double dt, double ratio) {
    problem p;
    outcome o;
    memset(&o, 0, sizeof o);
    make(&p, cut, how, ratio);
    step_to_balance(&p, dt, &o);
    play(&p, dt, &o);
    csv_row("%s,%s,%lu,%g,%g,%u,%u,%s,%.2e,%.6e,%.6e,%lu,%lu,%u,%.1e", block_cut_names[cut], start_names[how],
            (unsigned long)p.count, ratio, dt, (unsigned)o.last.newton_iterations, (unsigned)o.last.cg_iterations,
            stop_names[o.last.stop], o.last.residual, p.energy, o.last.energy, (unsigned long)o.rises,
            (unsigned long)o.not_finite, (unsigned)o.frames, o.left);
    destroy(&p);
    return o;
}

/* For each body and start, over both steps and ratios */
static void print_line(const char *body, const char *start, const outcome *o, size_t count) {
    uint32_t most = 0, frames = 0;
    size_t i, rises = 0, bad = 0, balanced = 0, rested = 0;
    for (i = 0; i < count; i++) {
        most = o[i].last.newton_iterations > most ? o[i].last.newton_iterations : most;
        frames = o[i].frames > frames ? o[i].frames : frames;
        rises += o[i].rises;
        bad += o[i].not_finite;
        balanced += o[i].last.stop != GXS_STOP_ITERATIONS;
        rested += o[i].frames > 0;
    }
    fprintf(stderr, "%-10s %-10s %6lu of %lu %11u %6lu %11lu %7lu of %lu %7u\n", body, start, (unsigned long)balanced,
            (unsigned long)count, (unsigned)most, (unsigned long)rises, (unsigned long)bad, (unsigned long)rested,
            (unsigned long)count, (unsigned)frames);
}

int main(int argc, char **argv) {
    int small, cut, how, i;
    const char *path = csv_arguments(argc, argv, &small);
    const int cuts = small ? 1 : BLOCK_CUTS;
    outcome all[BLOCK_CUTS][STARTS][4];
    csv_open(argv[0], path,
             "body,start,unknowns,poisson,dt_s,newton_iterations,cg_iterations,stop,residual,energy_before,energy_"
             "after,rises,not_finite,frames,left");
    for (cut = 0; cut < cuts; cut++)
        for (how = 0; how < STARTS; how++)
            for (i = 0; i < 4; i++) {
                progress_draw("violent", (size_t)(4 * (STARTS * cut + how) + i), (size_t)(4 * STARTS * cuts),
                              start_names[how]);
                all[cut][how][i] = run(cut, how, steps[i % 2], ratios[i / 2]);
            }
    progress_draw("violent", 1, 1, "");
    fprintf(stderr, "%-10s %-10s %11s %11s %6s %11s %12s %7s\n", "body", "start", "balanced", "iterations", "rises",
            "not finite", "at rest", "frames");
    for (cut = 0; cut < cuts; cut++)
        for (how = 0; how < STARTS; how++) print_line(block_cut_names[cut], start_names[how], all[cut][how], 4);
    return csv_close();
}
