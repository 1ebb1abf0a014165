/* soak.c - bodies that are cut again and again while they swing, fall, bounce and are kicked (soak.h), for 100,000
   steps.

   make bench-soak builds and runs it. It prints CSV and writes it to build/bench/soak.csv, and a table to stderr.

       usage: soak [FILE [--small]]            --small: 600 steps
              soak --life INTEGRATOR SEED      one life, step by step

   Columns: the worst of all lives of an integrator. strayed, hurried: lives in which a copy has been further, or
   once faster, than ten times the rest. iterations: mean of a step. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"
#include "soak.h"

typedef struct tally {
    size_t strayed, hurried;
} tally;

static void count(const row *life, tally *lives) {
    lives->strayed += life->reach > 10;
    lives->hurried += life->speed > 10;
}

static void print_row(int integrator, const row *r, const tally *lives) {
    csv_row("%s,%lu,%lu,%lu,%lu,%lu,%lu,%.3g,%.3g,%.2g,%.1f,%lu", integrator_names[integrator], (unsigned long)r->lives,
            (unsigned long)lives->strayed, (unsigned long)lives->hurried, (unsigned long)r->steps,
            (unsigned long)r->cuts, (unsigned long)r->cells, r->reach, r->speed, r->gain,
            r->iterations / (double)r->steps, (unsigned long)r->errors);
    fprintf(stderr,
            "%-9s %6lu steps, %5lu cuts, %lu lives: %lu strayed (reach %.3g), %lu hurried (speed %.3g); gain %.2g, "
            "%.1f iterations, "
            "%lu errors\n",
            integrator_names[integrator], (unsigned long)r->steps, (unsigned long)r->cuts, (unsigned long)r->lives,
            (unsigned long)lives->strayed, r->reach, (unsigned long)lives->hurried, r->speed, r->gain,
            r->iterations / (double)r->steps, (unsigned long)r->errors);
}

int main(int argc, char **argv) {
    const char *path;
    size_t steps;
    int small, integrator, bad = 0;
    if (argc == 4 && strcmp(argv[1], "--life") == 0) {
        row r;
        tally lives = {0, 0};
        memset(&r, 0, sizeof r);
        run_life(atoi(argv[2]) % INTEGRATORS, strtoull(argv[3], NULL, 10), 1, &r);
        count(&r, &lives);
        print_row(atoi(argv[2]) % INTEGRATORS, &r, &lives);
        return 0;
    }
    path = csv_arguments(argc, argv, &small);
    steps = small ? 200 : 34000;
    csv_open("soak", path, "integrator,lives,strayed,hurried,steps,cuts,most_cells,reach,speed,gain,iterations,errors");
    for (integrator = 0; integrator < INTEGRATORS; integrator++) {
        row r;
        tally lives = {0, 0};
        uint64_t seed;
        memset(&r, 0, sizeof r);
        for (seed = 0; r.steps < steps; seed++) {
            row one = r;
            one.reach = one.speed = one.gain = 0;
            run_life(integrator, seed, 0, &one);
            count(&one, &lives);
            one.reach = fmax(one.reach, r.reach), one.speed = fmax(one.speed, r.speed),
            one.gain = fmax(one.gain, r.gain);
            r = one;
            progress_draw("soak", (size_t)integrator * steps + (r.steps < steps ? r.steps : steps), INTEGRATORS * steps,
                          integrator_names[integrator]);
        }
        print_row(integrator, &r, &lives);
        bad += r.errors > 0;
    }
    return csv_close() || bad;
}
