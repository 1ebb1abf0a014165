/* stepping.c - accuracy against speed: the error of a motion against the time that it takes, over what can be turned.

   make bench-stepping builds and runs it on the cut accordion and the slab in five slices (traces of the scenes, all their cuts made at
   the start); it prints CSV and writes it to build/bench/stepping.csv. usage: stepping FILE SCENE=TRACE...

   Every run moves the same copies from rest for 0.33 s. Its error is the difference from the reference in displacement, weighted by mass,
   as a share of how far the reference moves. The reference: implicit midpoint with steps of 0.033/32 s, Newton to 1e-8. How far off it may be
   itself is in the row "reference": BDF2's difference from it with steps half as long. The space is the same in all runs: its own error,
   under refinement, is in docs/SCENES.md (locking).
   Columns: series and what was turned in it; dt; steps; ms_per_step, the mean; ms_per_second, of simulated time; error. */
#define _POSIX_C_SOURCE 199309L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "csv.h"
#include "replay.h"
#include "method.h"

static const double duration = 0.33, longest = 0.033;     /* s */

/* A way of taking steps; zero: the library's own */
typedef struct knobs {
    const char *series, *value;
    double dt;
    gxs_integrator integrator;
    uint32_t newton;
    double newton_tolerance, cg_tolerance;
    gxs_preconditioner preconditioner;
    gxs_matrix matrix;
    int lumped, replicas;
} knobs;

typedef struct setting {
    const char *name;
    const replay *scene;
    method_body *body;
    gxs_model model;
    gxs_element *replicas;
    double *start, *reference;      /* copy_count x 3 */
    double *mass;                   /* copy_count, row sums, kg */
} setting;

/* ---- the cut body ---- */

static void sum_masses(setting *s)
{
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    size_t e;
    int i, j;
    memset(s->mass, 0, s->model.copy_count * sizeof *s->mass);
    for (e = 0; e < s->model.element_count; e++)
        for (i = 0; i < 4; i++) for (j = 0; j < 4; j++) s->mass[s->model.elements[e].copy[i]] += s->model.elements[e].mass[row[i][j]];
}

static void setting_make(setting *s, const char *name, const replay *scene)
{
    const double *u;
    method_times times;
    size_t i;
    memset(s, 0, sizeof *s);
    memset(&times, 0, sizeof times);
    s->name = name;
    s->scene = scene;
    s->body = (method_body *)method_body_create(scene);
    for (i = 0; i < scene->cut_count; i++) {
        const char *why = method_body_cut(s->body, &scene->cuts[i], &times);
        method_must(why ? GX_ERROR_ARGUMENT : GX_OK, "cut");
    }
    method_library_look(s->body, &s->model, &u);
    s->start = (double *)method_memory(NULL, 3 * s->model.copy_count, sizeof(double));
    s->reference = (double *)method_memory(NULL, 3 * s->model.copy_count, sizeof(double));
    s->mass = (double *)method_memory(NULL, s->model.copy_count, sizeof(double));
    s->replicas = (gxs_element *)method_memory(NULL, s->model.element_count, sizeof *s->replicas);
    memcpy(s->start, u, 3 * s->model.copy_count * sizeof(double));
    vna_replicate(s->model.elements, s->model.element_count, &scene->density, s->replicas);
    sum_masses(s);
}

static void setting_free(setting *s)
{
    method_body_destroy(s->body);
    free(s->start);
    free(s->reference);
    free(s->mass);
    free(s->replicas);
}

/* ---- a run ---- */

static gxs_solver *make_solver(const setting *s, const knobs *k)
{
    gxs_solver_desc desc;
    gxs_solver *solver;
    gxs_model model = s->model;
    memset(&desc, 0, sizeof desc);
    desc.preconditioner = k->preconditioner;
    desc.matrix = k->matrix;
    model.lumped_mass = (uint32_t)k->lumped;
    if (k->replicas) model.elements = s->replicas;
    method_must(gxs_solver_create(&desc, &solver), "solver");
    method_must(gxs_solver_set_model(solver, &model, NULL), "model");
    return solver;
}

/* One step; history: state before the last step and before this one, u and v of each, size numbers each. BDF2 needs the former. */
static gx_result advance(gxs_solver *solver, gxs_step_desc *desc, double *u, double *v, double *history, size_t size)
{
    double *before = history, *now = history + 2 * size;
    gx_result result;
    memcpy(now, u, size * sizeof(double));
    memcpy(now + size, v, size * sizeof(double));
    result = gxs_solver_step(solver, desc, u, v, NULL, NULL);
    memcpy(before, now, 2 * size * sizeof(double));
    desc->previous_displacement = before;
    desc->previous_velocity = before + size;
    desc->previous_dt = desc->dt;
    return result;
}

/* Moves u (copy_count x 3) from the start to the end; returns milliseconds per step, or a negative number where a step fails. */
static double run(const setting *s, const knobs *k, double *u)
{
    const size_t size = 3 * s->model.copy_count, steps = (size_t)(duration / k->dt + 0.5);
    double *v = (double *)calloc(size, sizeof(double)), *history = (double *)method_memory(NULL, 4 * size, sizeof(double)), begin;
    gxs_solver *solver = make_solver(s, k);
    gxs_step_desc desc;
    gx_result result = GX_OK;
    size_t i;
    method_must(v ? GX_OK : GX_ERROR_MEMORY, "run");
    memset(&desc, 0, sizeof desc);
    desc.dt = k->dt;
    memcpy(desc.gravity, s->scene->gravity, sizeof desc.gravity);
    desc.integrator = k->integrator;
    desc.newton_iterations = k->newton;
    desc.newton_tolerance = k->newton_tolerance;
    desc.cg_tolerance = k->cg_tolerance;
    memcpy(u, s->start, size * sizeof(double));
    begin = seconds(NULL);
    for (i = 0; i < steps && result == GX_OK; i++) result = advance(solver, &desc, u, v, history, size);
    begin = 1e3 * (seconds(NULL) - begin) / (double)steps;
    gxs_solver_destroy(solver);
    free(v);
    free(history);
    return result == GX_OK ? begin : -1;
}

static double error_of(const setting *s, const double *u)
{
    double off = 0, moved = 0;
    size_t i, k;
    for (i = 0; i < s->model.copy_count; i++)
        for (k = 0; k < 3; k++) {
            const double d = u[3 * i + k] - s->reference[3 * i + k], m = s->reference[3 * i + k] - s->start[3 * i + k];
            off += s->mass[i] * d * d;
            moved += s->mass[i] * m * m;
        }
    return sqrt(off / moved);
}

static void row(const setting *s, const knobs *k)
{
    double *u = (double *)method_memory(NULL, 3 * s->model.copy_count, sizeof(double));
    const double ms = run(s, k, u);
    if (ms < 0) csv_row("%s,%s,%s,%g,%lu,,,", s->name, k->series, k->value, k->dt, (unsigned long)(duration / k->dt + 0.5));
    else csv_row("%s,%s,%s,%g,%lu,%.3f,%.1f,%.3e", s->name, k->series, k->value, k->dt, (unsigned long)(duration / k->dt + 0.5), ms, ms / k->dt, error_of(s, u));
    free(u);
}

/* ---- what is turned ---- */

static void find_reference(setting *s)
{
    knobs k;
    memset(&k, 0, sizeof k);
    k.dt = longest / 32;
    k.integrator = GXS_MIDPOINT;
    k.newton = 30;
    k.newton_tolerance = 1e-8;
    k.cg_tolerance = 1e-4;
    method_must(run(s, &k, s->reference) < 0 ? GX_ERROR_DIVERGED : GX_OK, "reference");
    k.series = "reference";
    k.value = "BDF2";
    k.integrator = GXS_BDF2;
    k.dt = longest / 64;
    row(s, &k);
}

static void turn_steps(const setting *s, const char *series, gxs_integrator integrator, uint32_t newton, int lumped, int replicas)
{
    static const int parts[5] = {1, 2, 4, 8, 16};
    int i;
    for (i = 0; i < 5; i++) {
        knobs k;
        char text[32];
        memset(&k, 0, sizeof k);
        snprintf(text, sizeof text, "dt/%d", parts[i]);
        k.series = series;
        k.value = text;
        k.dt = longest / parts[i];
        k.integrator = integrator;
        k.newton = newton;
        k.lumped = lumped;
        k.replicas = replicas;
        row(s, &k);
    }
}

static void turn_solver(const setting *s)
{
    static const double tolerances[4] = {1e-1, 1e-2, 1e-4, 1e-6};
    static const uint32_t newtons[4] = {1, 2, 4, 16};
    knobs k;
    char text[32];
    int i;
    for (i = 0; i < 8; i++) {
        memset(&k, 0, sizeof k);
        k.dt = longest / 4;
        if (i < 4) k.cg_tolerance = tolerances[i];
        else k.newton = newtons[i - 4];
        if (i < 4) snprintf(text, sizeof text, "%g", tolerances[i]);
        else snprintf(text, sizeof text, "%u", newtons[i - 4]);
        k.series = i < 4 ? "CG tolerance" : "Newton iterations";
        k.value = text;
        row(s, &k);
    }
    memset(&k, 0, sizeof k);
    k.dt = longest / 4;
    k.series = "solver";
    k.value = "multigrid assembled";
    k.matrix = GXS_MATRIX_ASSEMBLED;
    row(s, &k);
    k.value = "block-Jacobi";
    k.matrix = GXS_MATRIX_FREE;
    k.preconditioner = GXS_BLOCK_JACOBI;
    row(s, &k);
    k.value = "volume ratio (RXFEM)";
    k.preconditioner = GXS_VOLUME_RATIO;
    row(s, &k);
}

int main(int argc, char **argv)
{
    int i;
    csv_open(argc > 2 ? 2 : argc, argv, "scene,series,value,dt,steps,ms_per_step,ms_per_second,error");
    for (i = 2; i < argc; i++) {
        char name[32];
        replay scene = replay_argument(argv[0], argv[i], name);
        setting s;
        setting_make(&s, name, &scene);
        find_reference(&s);
        turn_steps(&s, "BDF1", GXS_BDF1, 1, 0, 0);
        turn_steps(&s, "BDF2", GXS_BDF2, 1, 0, 0);
        turn_steps(&s, "midpoint", GXS_MIDPOINT, 1, 0, 0);
        turn_steps(&s, "midpoint; 2 Newton", GXS_MIDPOINT, 2, 0, 0);
        turn_steps(&s, "BDF1; lumped", GXS_BDF1, 1, 1, 0);
        turn_steps(&s, "BDF2; lumped", GXS_BDF2, 1, 1, 0);
        turn_steps(&s, "VNA; BDF2", GXS_BDF2, 1, 0, 1);
        turn_solver(&s);
        setting_free(&s);
        replay_free(&scene);
    }
    return csv_close();
}
