/* soak.c - bodies that are cut again and again while they swing, fall, bounce and are kicked (soak.h), for 100,000 steps.

   make bench-soak builds and runs it; it prints CSV and writes it to build/bench/soak.csv, a table to stderr.
   usage: soak [FILE [--small]]     --small: 600 steps
          soak --life INTEGRATOR SEED     one life, step by step

   Columns: the worst of all lives of an integrator; strayed: lives in which a copy has been further or faster than ten times the rest;
   iterations: mean of a step. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"
#include "soak.h"

static void print_row(int integrator, const row *r, size_t strayed)
{
    csv_row("%s,%lu,%lu,%lu,%lu,%lu,%.3g,%.3g,%.2g,%.1f,%lu", integrator_names[integrator], (unsigned long)r->lives, (unsigned long)strayed, (unsigned long)r->steps,
            (unsigned long)r->cuts, (unsigned long)r->cells, r->reach, r->speed, r->gain, r->iterations / (double)r->steps,
            (unsigned long)r->errors);
    fprintf(stderr, "%-9s %6lu steps, %5lu cuts, %lu of %lu lives strayed: reach %.3g, speed %.3g, gain %.2g, %.1f iterations, %lu errors\n", integrator_names[integrator],
            (unsigned long)r->steps, (unsigned long)r->cuts, (unsigned long)strayed, (unsigned long)r->lives, r->reach, r->speed, r->gain,
            r->iterations / (double)r->steps, (unsigned long)r->errors);
}

int main(int argc, char **argv)
{
    const char *path;
    size_t steps;
    int small, integrator, bad = 0;
    if (argc == 4 && strcmp(argv[1], "--life") == 0) {
        row r;
        memset(&r, 0, sizeof r);
        run_life(atoi(argv[2]) % INTEGRATORS, strtoull(argv[3], NULL, 10), 1, &r);
        print_row(atoi(argv[2]) % INTEGRATORS, &r, r.reach > 10 || r.speed > 10);
        return 0;
    }
    path = csv_arguments(argc, argv, &small);
    steps = small ? 200 : 34000;
    csv_open("soak", path, "integrator,lives,strayed,steps,cuts,most_cells,reach,speed,gain,iterations,errors");
    for (integrator = 0; integrator < INTEGRATORS; ++integrator) {
        row r;
        uint64_t seed;
        size_t strayed = 0;
        memset(&r, 0, sizeof r);
        for (seed = 0; r.steps < steps; ++seed) {
            row one = r;
            one.reach = one.speed = one.gain = 0;
            run_life(integrator, seed, 0, &one);
            strayed += one.reach > 10 || one.speed > 10;
            one.reach = fmax(one.reach, r.reach), one.speed = fmax(one.speed, r.speed), one.gain = fmax(one.gain, r.gain);
            r = one;
            progress_draw("soak", (size_t)integrator * steps + (r.steps < steps ? r.steps : steps), INTEGRATORS * steps, integrator_names[integrator]);
        }
        print_row(integrator, &r, strayed);
        bad += r.errors > 0;
    }
    return csv_close() || bad;
}
