/* table2.c - GXFEM's Table 2: what a run of each scene costs, by method.

   make bench-table2 runs the scenes with the paper's numbers of frames, records them (--trace), and repeats them here by each method; it
   prints CSV and writes it to build/bench/table2.csv. usage: table2 FILE SCENE=TRACE...

   The columns are the paper's: EI, recomputing an element's integrals; MB, finding the pieces, per subdomain that was looked at (ours:
   element that was touched); dpsi, Hessians of the elastic energy, per step (the paper: energy derivatives); CG, the linear solve with its
   preconditioner; dt, a frame; C, sum over frames with a cut; C+U, over all. ended: the frame in which a method stopped, and why; its
   sums are of the frames before. Rows "paper" are the published ones, of another machine (Intel i9-13900K). */
#define _POSIX_C_SOURCE 199309L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "csv.h"
#include "replay.h"
#include "method.h"

/* Published in GXFEM's Table 2 */
typedef struct published {
    const char *scene, *method;
    double unknowns, integrals_ms, booleans_ms, derivatives_ms, solve_s, worst_s, mean_s, cut_s, all_s;    /* 0: not said */
} published;

static const published paper[] = {
    {"sticks", "RXFEM", 144, 2.48, 0, 5.6, 0.001, 0.032, 0.011, 0.097, 1.664},
    {"sticks", "GXFEM", 144, 0.36, 26.9, 0.0, 0.001, 0.278, 0.009, 0.898, 1.307},
    {"thin_slab", "RXFEM", 7200, 1.98, 0, 84.8, 0.306, 1.789, 0.6, 61.5, 270.0},
    {"thin_slab", "GXFEM", 7200, 0.289, 9.59, 3.875, 0.293, 3.355, 0.627, 123.3, 282.4},
    {"accordion", "RXFEM", 22800, 0.755, 0, 153.2, 4.909, 9.14, 5.764, 1036, 3112},
    {"accordion", "GXFEM", 22800, 0.061, 6.437, 8.796, 4.811, 9.203, 5.785, 1088, 3124},
    {"octopus", "RXFEM", 20800, 0.683, 0, 120.96, 2.26, 12.241, 2.092, 122.2, 1255},
    {"octopus", "GXFEM", 20800, 0.048, 9.332, 7.18, 2.382, 17.3, 2.05, 137.7, 1230}};

static void print_paper(const char *scene)
{
    size_t i;
    for (i = 0; i < sizeof paper / sizeof paper[0]; i++) {
        const published *p = &paper[i];
        if (strcmp(p->scene, scene) != 0) continue;
        csv_row("%s,%s (paper),,%.0f,%g,%g,%g,%g,%g,%g,%g,%g,", scene, p->method, p->unknowns, p->integrals_ms, p->booleans_ms, p->derivatives_ms,
                p->solve_s, p->worst_s, p->mean_s, p->cut_s, p->all_s);
    }
}

/* A method's run */
typedef struct run {
    double integrals, booleans, derivatives, solve, worst, cut, all;   /* s */
    size_t domains, frames;
    const char *why;            /* it ended early; NULL: it did not */
} run;

/* All cuts of a frame, and its step; NULL or why it could not be */
static const char *play_frame(const replay *scene, const method *m, void *state, size_t frame, size_t *next, method_times *times)
{
    const char *why = NULL;
    memset(times, 0, sizeof *times);
    for (; *next < scene->cut_count && scene->cuts[*next].frame == frame && !why; ++*next) why = m->cut(state, &scene->cuts[*next], times);
    return why ? why : m->step(state, times);
}

static void add_frame(run *r, const method_times *times)
{
    r->integrals += times->integrals;
    r->booleans += times->booleans;
    r->derivatives += times->derivatives;
    r->solve += times->solve;
    r->domains += times->domains;
    r->all += times->total;
    if (times->domains > 0) r->cut += times->total;
    if (times->total > r->worst) r->worst = times->total;
    r->frames++;
}

static void play(const char *name, const replay *scene, const method *m)
{
    void *state = m->create(scene);
    size_t next = 0;
    run r;
    memset(&r, 0, sizeof r);
    while (r.frames < scene->frames && !r.why) {
        method_times times;
        r.why = play_frame(scene, m, state, r.frames, &next, &times);
        if (!r.why) add_frame(&r, &times);
    }
    csv_row("%s,%s,%lu,%lu,%.4f,%.4f,%.3f,%.5f,%.5f,%.5f,%.4f,%.4f,%s", name, m->name, (unsigned long)r.frames, (unsigned long)m->unknowns(state),
            r.domains ? 1e3 * r.integrals / (double)r.domains : 0, r.domains ? 1e3 * r.booleans / (double)r.domains : 0,
            r.frames ? 1e3 * r.derivatives / (double)r.frames : 0, r.frames ? r.solve / (double)r.frames : 0, r.worst,
            r.frames ? r.all / (double)r.frames : 0, r.cut, r.all, r.why ? r.why : "");
    m->destroy(state);
}

int main(int argc, char **argv)
{
    int i, m;
    csv_open(argc > 2 ? 2 : argc, argv, "scene,method,frames,unknowns,EI_ms,MB_ms,dpsi_ms,CG_s,dt_max_s,dt_avg_s,total_C_s,total_CU_s,ended");
    for (i = 2; i < argc; i++) {
        char name[32];
        replay scene = replay_argument(argv[0], argv[i], name);
        print_paper(name);
        for (m = 0; m < METHOD_COUNT; m++) play(name, &scene, &methods[m]);
        replay_free(&scene);
    }
    return csv_close();
}
