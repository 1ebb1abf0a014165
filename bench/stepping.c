/* stepping.c - accuracy against speed: the error of a motion against its time, over everything that can be varied.

   make bench-stepping builds and runs it on the cut accordion and the slab in five slices (traces of the scenes,
   each blade's whole path cut at the start). It prints CSV and writes it to build/bench/stepping.csv. To stderr it
   prints where ours is on the front and where another method is the better choice. usage: stepping FILE [--small]
   SCENE=TRACE...; --small: a fifth of the time.

   Every run moves the body from rest for 0.33 s. Its error is the difference from the reference in displacement,
   weighted by mass, as a share of the reference's motion. The reference: thin cuts, exact integrals, the same space,
   implicit midpoint with steps of 0.033/32 s, Newton's method to 1e-8. The row "reference" bounds its own error:
   BDF2's difference from it with steps half as long. space.c measures the error of the space itself, under
   refinement.

   Varied are steps, integrators, lumped mass, Newton's method, CG, preconditioners; element duplication (VNA) and
   deletion; and the following, all by BDF2 with steps of 0.033/4 s and CG to 1e-6, so that nothing else differs:
       integrals   of divided elements, by points (bench/parts.h): "positive", degree; "adaptive", depth; "regular",
                   cells along an edge; "RXFEM", degree. A step then takes an elastic evaluation at each point, as
                   published; "one": one for each part, in which F is constant. RXFEM refuses cuts that cross, as the
                   accordion's do
       thickness   of cuts, in edges (their mean): "gxfem; solids", and "Algorithm 1" as published (bench/literal.h),
                   for all blades at once: one after the other, blades that cross leave parts stuck. Each part of the
                   thin cut moves as the largest part of the other body with its centre in it; if there is none, it
                   stays in place

   The scene "slab_in_five affine" is the same with affine copies (gx_body_desc.affine_below), which bend as they
   should: another space with a reference of its own, over a fifth of the time, with as many iterations of Newton's
   method as the library chooses where the series does not say 1. The row "linear elements" is how far their reference,
   of all the other rows, is off. In scenes whose parts are thicker than an element nothing is affine.

   Columns: series, and the value that was varied in it; dt; steps; ms_per_step: the mean, with evaluations of
   points; ms_per_second: of simulated time; error; of_exact: the difference from the same steps with thin cuts and
   exact integrals; integrals_ms: to integrate all divided elements, once; points: of the mean divided part; note:
   why there is no motion. */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "csv.h"
#include "progress.h"
#include "replay.h"
#include "method.h"
#include "part.h"
#include "sampling.h"
#include "parts.h"

static const double longest = 0.033; /* s, of a step */
static double duration = 0.33;       /* s, of a run */
static int small;

/* A way of taking steps; zero: the library's own */
typedef struct knobs {
    const char *series, *value;
    double dt;
    gxs_integrator integrator;
    uint32_t newton;
    double newton_tolerance, cg_tolerance;
    gxs_preconditioner preconditioner;
    gxs_matrix matrix;
    int lumped;
} knobs;

/* What is moved */
typedef struct mover {
    gxs_model model;
    const double *start; /* copy_count x 3 */
    /* x 4: copies that move the setting's parts, PARTS_NONE: the part is lost; NULL: the setting's own */
    uint32_t *corners;
    double integrals_ms; /* to integrate all divided elements */
    double evaluate_ms;  /* of all points, in a step */
    double points;       /* of the mean divided part; 0: no points */
} mover;

typedef struct setting {
    const char *name;
    replay scene; /* its cuts are each blade's whole path */
    double edge;  /* mean, m */
    method_body *body;
    parts_body parts;
    mover own;
    double *start; /* own.start */
    /* copy_count x 3: at the end; exact: by the steps with which integrals and thicknesses are compared */
    double *reference, *exact;
} setting;

/* ---- the table ---- */

typedef struct kept_row {
    char series[32], value[24];
    double ms_per_second, error;
    double of_exact; /* below 0: not compared with it */
    double run_ms;   /* of the whole run, integrals once */
} kept_row;

static kept_row *kept_rows;
static size_t kept_count, done, total;

static void keep_row(const mover *m, const knobs *k, double ms, double error, double of_exact) {
    kept_row *kept;
    kept_rows = (kept_row *)method_memory(kept_rows, kept_count + 1, sizeof *kept_rows);
    kept = &kept_rows[kept_count++];
    snprintf(kept->series, sizeof kept->series, "%s", k->series);
    snprintf(kept->value, sizeof kept->value, "%s", k->value);
    kept->ms_per_second = ms / k->dt;
    kept->error = error;
    kept->of_exact = of_exact;
    kept->run_ms = ms / k->dt * duration + m->integrals_ms;
}

/* ms below 0: no motion, and note says why. of_exact below 0: not compared with exact; the row counts in the front */
static void print_row(const setting *s, const mover *m, const knobs *k, double ms, double error, double of_exact,
                      const char *note) {
    const unsigned long steps = (unsigned long)(duration / k->dt + 0.5);
    char head[128], compared[24] = "", integrals[24] = "", points[24] = "";
    snprintf(head, sizeof head, "%s,%s,%s,%g,%lu", s->name, k->series, k->value, k->dt, steps);
    if (of_exact >= 0) snprintf(compared, sizeof compared, "%.3e", of_exact);
    if (m && m->integrals_ms > 0) snprintf(integrals, sizeof integrals, "%.3f", m->integrals_ms);
    if (m && m->points > 0) snprintf(points, sizeof points, "%.1f", m->points);
    if (ms < 0)
        csv_row("%s,,,,,%s,%s,%s", head, integrals, points, note);
    else {
        csv_row("%s,%.3f,%.1f,%.3e,%s,%s,%s,%s", head, ms, ms / k->dt, error, compared, integrals, points, note);
        keep_row(m, k, ms, error, of_exact);
    }
    progress_draw("stepping", ++done, total, k->series);
}

static int cheaper(const void *a, const void *b) {
    const double x = ((const kept_row *)a)->ms_per_second, y = ((const kept_row *)b)->ms_per_second;
    return (x > y) - (x < y);
}

/* Is it by the library's own means? Its block-Jacobi and its assembled matrix count as such. */
static int is_ours(const kept_row *r) {
    return strncmp(r->series, "VNA", 3) != 0 && strncmp(r->series, "deletion", 8) != 0 &&
           strstr(r->value, "RXFEM") == NULL;
}

/* The cheapest row of ours that is as exact; NULL: there is none. Rows are in order of time. */
static const kept_row *cheapest_of_ours(double error) {
    size_t i;
    for (i = 0; i < kept_count; i++)
        if (kept_rows[i].of_exact < 0 && is_ours(&kept_rows[i]) && kept_rows[i].error <= error) return &kept_rows[i];
    return NULL;
}

static void print_choice(const kept_row *r) {
    const kept_row *ours = cheapest_of_ours(r->error);
    fprintf(stderr, "%-24s %-16s %14.3f %10.2e", r->series, r->value, 1e-3 * r->ms_per_second, r->error);
    if (is_ours(r))
        fprintf(stderr, "\n");
    else if (ours)
        fprintf(stderr, "  the better choice here: as exact, ours takes %.3f (%s, %s)\n", 1e-3 * ours->ms_per_second,
                ours->series, ours->value);
    else
        fprintf(stderr, "  the better choice here: ours is never as exact\n");
}

/* The front of a scene: rows that no cheaper row beats. Rows of integrals and thickness, all by the same steps, are
   left out. */
static void print_front(const char *scene) {
    double least = HUGE_VAL;
    size_t i, front = 0, ours = 0;
    progress_clear();
    qsort(kept_rows, kept_count, sizeof *kept_rows, cheaper);
    fprintf(stderr, "%s, from cheap to exact: what nothing cheaper beats\n%-24s %-16s %14s %10s\n", scene, "series",
            "value", "s per second", "error");
    for (i = 0; i < kept_count; i++) {
        const kept_row *r = &kept_rows[i];
        if (r->of_exact >= 0 || r->error >= least) continue;
        least = r->error;
        front++;
        ours += (size_t)is_ours(r);
        print_choice(r);
    }
    fprintf(stderr, "of this front %lu of %lu are ours\n", (unsigned long)ours, (unsigned long)front);
}

/* Integrals by other means, with the same steps. They are the better choice where the whole run, with making them,
   takes less time by more than noise, and the motion is off by less than the steps' own error. */
static void print_integrals(void) {
    static const double noise = 0.15;
    const kept_row *exact = NULL;
    size_t i, better = 0;
    for (i = 0; i < kept_count; i++)
        if (strcmp(kept_rows[i].series, "exact") == 0) exact = &kept_rows[i];
    method_must(exact ? GX_OK : GX_ERROR_ARGUMENT, "exact");
    for (i = 0; i < kept_count; i++) {
        const kept_row *r = &kept_rows[i];
        if (r->of_exact < 0 || r->of_exact >= exact->error || r->run_ms >= (1 - noise) * exact->run_ms) continue;
        better++;
        fprintf(stderr,
                "integrals by \"%s\", %s, are the better choice: the run takes %.0f ms, beside %.0f, and is off by "
                "%.1e, the steps by %.1e\n",
                r->series, r->value, r->run_ms, exact->run_ms, r->of_exact, exact->error);
    }
    if (better == 0)
        fprintf(stderr,
                "exact integrals of thin cuts: nothing that is off by less than the steps (%.1e) takes less time\n",
                exact->error);
}

/* ---- the cut body ---- */

/* Does a later cut continue this one? */
static int is_continued(const replay *scene, size_t cut) {
    const gx_surface *path = &scene->cuts[cut].path;
    size_t i;
    for (i = cut + 1; i < scene->cut_count; i++) {
        const replay_cut *later = &scene->cuts[i];
        if (later->first == path->triangle_count && later->path.vertex_count >= path->vertex_count &&
            memcmp(later->path.vertices, path->vertices, 3 * path->vertex_count * sizeof(double)) == 0)
            return 1;
    }
    return 0;
}

/* The scene with one cut for each blade: its whole path. Arrays other than the cuts are borrowed. */
static replay whole_blades(const replay *scene) {
    replay r = *scene;
    size_t i;
    r.cuts = (replay_cut *)method_memory(NULL, scene->cut_count, sizeof *r.cuts);
    for (r.cut_count = i = 0; i < scene->cut_count; i++) {
        if (is_continued(scene, i)) continue;
        r.cuts[r.cut_count] = scene->cuts[i];
        r.cuts[r.cut_count++].first = 0;
    }
    return r;
}

static double mean_edge(const replay *scene) {
    static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    double sum = 0;
    size_t e, i, k;
    for (e = 0; e < scene->element_count; e++)
        for (i = 0; i < 6; i++) {
            const double *a = scene->positions + 3 * (size_t)scene->elements[4 * e + (size_t)ends[i][0]];
            const double *b = scene->positions + 3 * (size_t)scene->elements[4 * e + (size_t)ends[i][1]];
            double square = 0;
            for (k = 0; k < 3; k++) square += (a[k] - b[k]) * (a[k] - b[k]);
            sum += sqrt(square);
        }
    return sum / (6 * (double)scene->element_count);
}

/* The library's body with all cuts made */
static method_body *cut_body(const replay *scene, method_times *times) {
    method_body *body = (method_body *)method_body_create(scene);
    size_t i;
    memset(times, 0, sizeof *times);
    for (i = 0; i < scene->cut_count; i++)
        method_must(method_body_cut(body, &scene->cuts[i], times) ? GX_ERROR_ARGUMENT : GX_OK, "cut");
    return body;
}

static void setting_make(setting *s, const char *name, const replay *scene) {
    const double *displacement;
    method_times times;
    gx_view view;
    memset(s, 0, sizeof *s);
    s->name = name;
    s->scene = whole_blades(scene);
    s->edge = mean_edge(scene);
    s->body = cut_body(&s->scene, &times);
    method_library_look(s->body, &s->own.model, &displacement);
    method_must(gx_body_view(s->body->body, &view, NULL), "view");
    s->start = (double *)calloc(3 * s->own.model.copy_count, sizeof(double)); /* hidden vectors begin with 0 */
    method_must(s->start ? GX_OK : GX_ERROR_MEMORY, "start");
    memcpy(s->start, displacement, 3 * view.copy_count * sizeof(double));
    s->own.start = s->start;
    s->own.integrals_ms = 1e3 * times.integrals;
    s->parts = parts_create(s->body->body);
    s->reference = (double *)method_memory(NULL, 3 * s->own.model.copy_count, sizeof(double));
    s->exact = (double *)method_memory(NULL, 3 * s->own.model.copy_count, sizeof(double));
}

static void setting_free(setting *s) {
    parts_free(&s->parts);
    method_body_destroy(s->body);
    free(s->scene.cuts);
    free(s->start);
    free(s->reference);
    free(s->exact);
}

/* ---- a run ---- */

static gxs_solver *make_solver(const mover *m, const knobs *k) {
    gxs_solver_desc desc;
    gxs_solver *solver;
    gxs_model model = m->model;
    memset(&desc, 0, sizeof desc);
    desc.preconditioner = k->preconditioner;
    desc.matrix = k->matrix;
    model.lumped_mass = (uint32_t)k->lumped;
    method_must(gxs_solver_create(&desc, &solver, NULL), "solver");
    method_must(gxs_solver_set_model(solver, &model, NULL), "model");
    return solver;
}

/* One step. history: the state before the last step and before this one, u and v of each, `size` numbers each. BDF2
   needs the former. */
static gx_result advance(gxs_solver *solver, gxs_step_desc *desc, double *u, double *v, double *history, size_t size) {
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

/* Moves u (copy_count x 3) from the start to the end; *ms: per step. */
static gx_result run(const setting *s, const mover *m, const knobs *k, double *u, double *ms) {
    const size_t size = 3 * m->model.copy_count, steps = (size_t)(duration / k->dt + 0.5);
    double *v = (double *)calloc(size, sizeof(double)),
           *history = (double *)method_memory(NULL, 4 * size, sizeof(double)), begin;
    gxs_solver *solver = make_solver(m, k);
    gxs_step_desc desc;
    gx_result result = GX_OK;
    size_t i;
    method_must(v ? GX_OK : GX_ERROR_MEMORY, "run");
    memset(&desc, 0, sizeof desc);
    desc.dt = k->dt;
    memcpy(desc.gravity, s->scene.gravity, sizeof desc.gravity);
    desc.integrator = k->integrator;
    desc.newton_iterations = k->newton;
    desc.newton_tolerance = k->newton_tolerance;
    desc.cg_tolerance = k->cg_tolerance;
    memcpy(u, m->start, size * sizeof(double));
    begin = seconds(NULL);
    for (i = 0; i < steps && result == GX_OK; i++) result = advance(solver, &desc, u, v, history, size);
    *ms = 1e3 * (seconds(NULL) - begin) / (double)steps;
    gxs_solver_destroy(solver);
    free(v);
    free(history);
    return result;
}

/* The distance from `truth` (the setting's copies) over the setting's parts, each corner with its row of the mass,
   as a share of the reference's motion */
static double error_of(const setting *s, const mover *m, const double *u, const double *truth) {
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    double off = 0, moved = 0;
    size_t i, c, j, k;
    for (i = 0; i < s->own.model.element_count; i++)
        for (c = 0; c < 4; c++) {
            const gxs_element *e = &s->own.model.elements[i];
            const size_t copy = e->copy[c];
            const uint32_t other = m->corners ? m->corners[4 * i + c] : e->copy[c];
            double mass = 0;
            for (j = 0; j < 4; j++) mass += e->mass[row[c][j]];
            for (k = 0; k < 3; k++) {
                const double start = s->own.start[3 * copy + k],
                             at = other == PARTS_NONE ? start : u[3 * (size_t)other + k];
                off += mass * (at - truth[3 * copy + k]) * (at - truth[3 * copy + k]);
                moved += mass * (s->reference[3 * copy + k] - start) * (s->reference[3 * copy + k] - start);
            }
        }
    return sqrt(off / moved);
}

/* Runs and prints; "SERIES one" beside it if the mover has points: one evaluation for each part. compare: with the
   exact run of the same steps */
static void row(const setting *s, const mover *m, const knobs *k, int compare) {
    double *u = (double *)method_memory(NULL, 3 * m->model.copy_count, sizeof(double)), ms, error, of_exact;
    const gx_result result = run(s, m, k, u, &ms);
    error = result == GX_OK ? error_of(s, m, u, s->reference) : 0;
    of_exact = result == GX_OK && compare ? error_of(s, m, u, s->exact) : -1;
    if (result != GX_OK) ms = -1;
    print_row(s, m, k, ms < 0 ? ms : ms + m->evaluate_ms, error, of_exact,
              result == GX_OK ? "" : gx_result_text(result));
    if (m->points > 0) {
        char series[32];
        knobs one = *k;
        snprintf(series, sizeof series, "%s one", k->series);
        one.series = series;
        print_row(s, m, &one, ms, error, of_exact, result == GX_OK ? "" : gx_result_text(result));
    }
    free(u);
}

static knobs knobs_of(const char *series, const char *value, double dt, gxs_integrator integrator) {
    knobs k;
    memset(&k, 0, sizeof k);
    k.series = series;
    k.value = value;
    k.dt = dt;
    k.integrator = integrator;
    return k;
}

/* ---- other movers ---- */

/* The copies of another body that stand for the corners of the setting's parts. owners: the mesh element of each of
   the model's elements */
static uint32_t *match(const setting *s, const gxs_model *model, const uint32_t *owners) {
    const size_t count = s->own.model.element_count;
    uint32_t *corners = (uint32_t *)method_memory(NULL, 4 * count, sizeof *corners);
    double *largest = (double *)calloc(count + 1, sizeof *largest);
    size_t i;
    method_must(largest ? GX_OK : GX_ERROR_MEMORY, "match");
    memset(corners, 255, 4 * count * sizeof *corners);
    for (i = 0; i < model->element_count; i++) {
        const uint32_t element = owners ? owners[i] : model->elements[i].group;
        uint32_t at;
        double x[3];
        if (!parts_center(&s->parts, &model->elements[i], element, x)) continue;
        at = parts_find(&s->parts, element, x);
        if (at == PARTS_NONE || model->elements[i].weight <= largest[at]) continue;
        largest[at] = model->elements[i].weight;
        memcpy(corners + 4 * (size_t)at, model->elements[i].copy, 4 * sizeof *corners);
    }
    free(largest);
    return corners;
}

/* Milliseconds of forces and tangents of St. Venant-Kirchhoff at the points of divided parts, one by one as in
   RXFEM; counted from the first MEASURED */
static double evaluate_ms(const setting *s, const gxs_element *elements, const size_t *counts, double *points) {
    enum { MEASURED = 200000 };
    static const double lame[2] = {1e6, 1e6};
    double force[12] = {0}, tangent[144] = {0}, f[9], all = 0, seen = 0, parts_seen = 0, begin = seconds(NULL),
           took = 0;
    size_t i, j;
    for (i = 0; i < s->own.model.element_count; i++) {
        const uint32_t e = elements[i].group;
        if (s->parts.first[e + 1] - s->parts.first[e] < 2) continue;
        parts_seen++;
        all += (double)counts[i];
        if (seen >= MEASURED) continue;
        for (j = 0; j < counts[i]; j++) {
            rx_deformation(&elements[i], s->own.start, f);
            rx_add_point(lame, &elements[i], f, elements[i].weight, force, tangent);
        }
        seen += (double)counts[i];
        took = seconds(NULL) - begin;
    }
    method_must(tangent[0] >= 0 ? GX_OK : GX_ERROR_DIVERGED, "evaluation"); /* is used, so that it is not optimised away
                                                                             */
    *points = all / parts_seen;
    return seen > 0 ? 1e3 * took * all / seen : 0;
}

/* ---- variations: steps and solvers ---- */

/* By the midpoint rule with so many steps in the longest one */
static knobs reference_knobs(const char *series, const char *value, int steps) {
    knobs k = knobs_of(series, value, longest / steps, GXS_MIDPOINT);
    k.newton = 30;
    k.newton_tolerance = 1e-8;
    k.cg_tolerance = 1e-4;
    return k;
}

static void find_reference(setting *s) {
    knobs k = reference_knobs("reference", "BDF2", 32);
    double ms;
    progress_draw("stepping", done, total, "reference");
    method_must(run(s, &s->own, &k, s->reference, &ms), "reference");
    k.integrator = GXS_BDF2;
    k.dt = longest / 64;
    row(s, &s->own, &k, 0);
}

enum { STEPS = 5, SWEEPS = 6, TOLERANCES = 4, NEWTONS = 4, SOLVERS = 3 };

typedef struct sweep {
    const char *series;
    gxs_integrator integrator;
    uint32_t newton;
    int lumped;
} sweep;

/* clang-format off */
static const sweep sweeps[SWEEPS] = {
    {"BDF1", GXS_BDF1, 1, 0}, {"BDF2", GXS_BDF2, 1, 0}, {"midpoint", GXS_MIDPOINT, 1, 0}, {"midpoint; 2 Newton", GXS_MIDPOINT, 2, 0},
    {"BDF1; lumped", GXS_BDF1, 1, 1}, {"BDF2; lumped", GXS_BDF2, 1, 1}};
/* clang-format on */

/* The first so many of the step lengths */
static void turn_steps(const setting *s, const mover *m, const sweep *w, int steps) {
    static const int divisors[STEPS] = {1, 2, 4, 8, 16};
    int i;
    for (i = 0; i < steps; i++) {
        char text[32];
        knobs k = knobs_of(w->series, text, longest / divisors[i], w->integrator);
        snprintf(text, sizeof text, "dt/%d", divisors[i]);
        k.newton = w->newton;
        k.lumped = w->lumped;
        row(s, m, &k, 0);
    }
}

static void turn_solver(const setting *s) {
    static const double tolerances[TOLERANCES] = {1e-1, 1e-2, 1e-4, 1e-6};
    static const uint32_t newtons[NEWTONS] = {1, 2, 4, 16};
    char text[32];
    knobs k = knobs_of("CG tolerance", text, longest / 4, GXS_BDF1);
    int i;
    for (i = 0; i < TOLERANCES; i++) {
        k.cg_tolerance = tolerances[i];
        snprintf(text, sizeof text, "%g", tolerances[i]);
        row(s, &s->own, &k, 0);
    }
    k = knobs_of("Newton iterations", text, longest / 4, GXS_BDF1);
    for (i = 0; i < NEWTONS; i++) {
        k.newton = newtons[i];
        snprintf(text, sizeof text, "%u", newtons[i]);
        row(s, &s->own, &k, 0);
    }
    k = knobs_of("solver", "multigrid assembled", longest / 4, GXS_BDF1);
    k.matrix = GXS_MATRIX_ASSEMBLED;
    row(s, &s->own, &k, 0);
    k = knobs_of("solver", "block-Jacobi", longest / 4, GXS_BDF1);
    k.preconditioner = GXS_BLOCK_JACOBI;
    row(s, &s->own, &k, 0);
    k = knobs_of("solver", "volume ratio (RXFEM)", longest / 4, GXS_BDF1);
    k.preconditioner = GXS_VOLUME_RATIO;
    row(s, &s->own, &k, 0);
}

/* ---- duplication and deletion of elements ---- */

static void turn_duplication(const setting *s) {
    static const sweep w = {"VNA; BDF2", GXS_BDF2, 1, 0};
    mover m = s->own;
    gxs_element *replicas = (gxs_element *)method_memory(NULL, m.model.element_count, sizeof *replicas);
    vna_replicate(m.model.elements, m.model.element_count, &s->scene.density, replicas);
    m.model.elements = replicas;
    m.integrals_ms = 0;
    turn_steps(s, &m, &w, STEPS);
    free(replicas);
}

static void turn_deletion(const setting *s) {
    static const sweep w = {"deletion; BDF2", GXS_BDF2, 1, 0};
    method_body *uncut = (method_body *)method_body_create(&s->scene);
    gxs_element *elements = (gxs_element *)method_memory(NULL, s->scene.element_count, sizeof *elements);
    mover m;
    memset(&m, 0, sizeof m);
    method_library_look(uncut, &m.model, &m.start);
    m.model.element_count = parts_delete(&s->parts, &m.model, elements);
    m.model.elements = elements;
    m.corners = match(s, &m.model, NULL);
    if (m.model.element_count > 0)
        turn_steps(s, &m, &w, STEPS);
    else {
        const knobs k = knobs_of(w.series, "", longest, w.integrator);
        print_row(s, &m, &k, -1, 0, -1, "no element is left");
        done += STEPS - 1;
    }
    free(m.corners);
    free(elements);
    method_body_destroy(uncut);
}

/* ---- affine copies ---- */

/* Adds the displacement of an element's centre of mass, times a factor. */
static void add_center(const gxs_model *m, const gxs_element *e, const double *u, double factor, double sum[3]) {
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    double at[4], mass = 0, x[3] = {0, 0, 0};
    size_t i, j, k;
    for (i = 0; i < 4; i++) {
        for (at[i] = 0, j = 0; j < 4; j++) at[i] += e->mass[row[i][j]];
        mass += at[i];
    }
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) x[k] += at[i] / mass * m->positions[3 * (size_t)e->copy[i] + k];
    for (i = 0; i < 4; i++) {
        const uint32_t hidden = m->affine ? m->affine[e->copy[i]] : GXS_NOT_AFFINE;
        const double share = factor * at[i] / mass;
        for (k = 0; k < 3; k++) sum[k] += share * u[3 * (size_t)e->copy[i] + k];
        for (j = 0; j < 3 && hidden != GXS_NOT_AFFINE; j++)
            for (k = 0; k < 3; k++)
                sum[k] += share * (x[j] - m->positions[3 * (size_t)e->copy[i] + j]) / m->affine_length *
                          u[3 * ((size_t)hidden + j) + k];
    }
}

/* The distance of the linear elements' motion from the reference, over the parts' centres, as a share of the
   reference's motion. Copies have the same numbers. */
static double error_of_linear(const setting *s, const double *linear) {
    gxs_model stiff = s->own.model;
    double off = 0, moved = 0;
    size_t i, k;
    stiff.affine = NULL;
    for (i = 0; i < s->own.model.element_count; i++) {
        const gxs_element *e = &s->own.model.elements[i];
        double motion[3] = {0, 0, 0}, miss[3] = {0, 0, 0};
        add_center(&s->own.model, e, s->reference, 1, motion);
        add_center(&s->own.model, e, s->start, -1, motion);
        add_center(&s->own.model, e, s->reference, -1, miss);
        add_center(&stiff, e, linear, 1, miss);
        for (k = 0; k < 3; k++) {
            moved += e->weight * motion[k] * motion[k];
            off += e->weight * miss[k] * miss[k];
        }
    }
    return sqrt(off / moved);
}

/* The same scene in the space with affine copies, if there are any */
static void turn_affine(const setting *linear, const replay *scene) {
    enum { BENT_SWEEPS = 3, BENT_STEPS = 3 };
    static const sweep bent_sweeps[BENT_SWEEPS] = {
        {"BDF2", GXS_BDF2, 0, 0}, {"midpoint", GXS_MIDPOINT, 0, 0}, {"BDF2; 1 Newton", GXS_BDF2, 1, 0}};
    const double whole = duration;
    replay bent = *scene;
    setting s;
    char name[48];
    int i;
    bent.affine_below = 1;
    snprintf(name, sizeof name, "%s affine", linear->name);
    setting_make(&s, name, &bent);
    if (s.own.model.affine) {
        const knobs k = reference_knobs("linear elements", "reference", 8);
        double *u = (double *)method_memory(NULL, 3 * linear->own.model.copy_count, sizeof(double)), ms;
        duration /= small ? 1 : 5;
        method_must(run(&s, &s.own, &k, s.reference, &ms), "reference");
        method_must(run(linear, &linear->own, &k, u, &ms), "linear elements");
        print_row(&s, &s.own, &k, ms, error_of_linear(&s, u), -1, "");
        for (i = 0; i < BENT_SWEEPS; i++) turn_steps(&s, &s.own, &bent_sweeps[i], BENT_STEPS);
        print_front(name);
        free(u);
        duration = whole;
    }
    kept_count = 0;
    setting_free(&s);
}

/* ---- integrals ---- */

enum { RULES = 3, KNOBS = 4 };

static const struct {
    const char *series;
    parts_rule_fn make;
    int knobs[KNOBS];
} rules[RULES] = {{"positive", parts_positive, {1, 2, 0, 0}},
                  {"adaptive", parts_adaptive, {1, 2, 3, 4}},
                  {"regular", parts_regular, {5, 10, 20, 50}}};

static knobs compared_knobs(const char *series, const char *value) {
    knobs k = knobs_of(series, value, longest / 4, GXS_BDF2);
    k.cg_tolerance = 1e-6;
    return k;
}

/* Cuts by all blades; NULL, or why RXFEM refuses */
static const char *cut_rxfem(const setting *s, rx_body *b) {
    size_t i;
    for (i = 0; i < s->scene.cut_count; i++) {
        const gx_surface *path = &s->scene.cuts[i].path;
        rx_surface surface;
        rx_result result;
        surface.vertices = path->vertices;
        surface.vertex_count = path->vertex_count;
        surface.triangles = path->triangles;
        surface.triangle_count = path->triangle_count;
        result = rx_body_cut(b, &surface);
        if (result != RX_OK) return method_rxfem_text(result);
    }
    return NULL;
}

static void turn_rxfem(const setting *s, mover *m, gxs_element *elements, size_t *counts) {
    rx_rules *fitted = rx_rules_create(2, 0);
    rx_body *b =
        rx_body_create(fitted, s->scene.positions, s->scene.node_count, s->scene.elements, s->scene.element_count);
    knobs k = compared_knobs("RXFEM", "2");
    const char *why;
    b->clock = seconds;
    why = cut_rxfem(s, b);
    if (why) {
        print_row(s, NULL, &k, -1, 0, -1, why);
        k.series = "RXFEM one";
        print_row(s, NULL, &k, -1, 0, -1, why);
    } else {
        parts_rxfem(&s->parts, b, s->scene.density, elements, counts);
        m->integrals_ms = 1e3 * b->seconds_rules;
        m->evaluate_ms = evaluate_ms(s, elements, counts, &m->points);
        row(s, m, &k, 1);
    }
    rx_body_destroy(b);
    rx_rules_destroy(fitted);
}

static void turn_integrals(setting *s) {
    mover m = s->own;
    const size_t count = m.model.element_count;
    gxs_element *elements = (gxs_element *)method_memory(NULL, count, sizeof *elements);
    size_t *counts = (size_t *)method_memory(NULL, count, sizeof *counts);
    knobs k = compared_knobs("exact", "-");
    double ms;
    int i, j;
    method_must(run(s, &s->own, &k, s->exact, &ms), "exact");
    row(s, &s->own, &k, 1);
    m.model.elements = elements;
    turn_rxfem(s, &m, elements, counts);
    for (i = 0; i < RULES; i++)
        for (j = 0; j < KNOBS && rules[i].knobs[j]; j++) {
            char text[16];
            const double begin = seconds(NULL);
            parts_integrate(&s->parts, rules[i].make, rules[i].knobs[j], s->scene.density, elements, counts);
            m.integrals_ms = 1e3 * (seconds(NULL) - begin);
            m.evaluate_ms = evaluate_ms(s, elements, counts, &m.points);
            snprintf(text, sizeof text, "%d", rules[i].knobs[j]);
            k = compared_knobs(rules[i].series, text);
            row(s, &m, &k, 1);
        }
    free(elements);
    free(counts);
}

/* ---- thickness ---- */

enum { THICKNESSES = 5 };

/* Of all blades; the caller frees it */
static gx_surface *make_solids(const setting *s, double thickness) {
    gx_surface *solids = (gx_surface *)method_memory(NULL, s->scene.cut_count, sizeof *solids);
    size_t i;
    for (i = 0; i < s->scene.cut_count; i++) solids[i] = method_solidify(&s->scene.cuts[i].path, thickness);
    return solids;
}

static void free_solids(const setting *s, gx_surface *solids) {
    size_t i;
    for (i = 0; i < s->scene.cut_count; i++) {
        free((void *)(uintptr_t)solids[i].vertices);
        free((void *)(uintptr_t)solids[i].triangles);
    }
    free(solids);
}

static void row_solids(const setting *s, const gx_surface *solids, const knobs *k) {
    replay scene = s->scene;
    method_times times;
    method_body *body;
    mover m;
    size_t i;
    memset(&m, 0, sizeof m);
    scene.cuts = (replay_cut *)method_memory(NULL, scene.cut_count, sizeof *scene.cuts);
    for (i = 0; i < scene.cut_count; i++) {
        scene.cuts[i] = s->scene.cuts[i];
        scene.cuts[i].path = solids[i];
    }
    body = cut_body(&scene, &times);
    method_library_look(body, &m.model, &m.start);
    m.integrals_ms = 1e3 * times.integrals;
    m.corners = match(s, &m.model, NULL);
    row(s, &m, k, 1);
    free(m.corners);
    method_body_destroy(body);
    free(scene.cuts);
}

/* The element of each of Algorithm 1's parts */
static uint32_t *literal_owners(const literal *l) {
    uint32_t *owners = (uint32_t *)method_memory(NULL, l->element.count, sizeof *owners), e, at;
    for (e = 0; e < l->desc.element_count; e++)
        for (at = l->element.first[e]; at != LITERAL_NONE; at = l->element.domains[at].next) owners[at] = e;
    return owners;
}

static void row_literal(const setting *s, const gx_surface *solids, const knobs *k) {
    method_literal *body = (method_literal *)method_literal_create(&s->scene);
    method_times times;
    uint32_t *owners;
    mover m;
    memset(&m, 0, sizeof m);
    memset(&times, 0, sizeof times);
    literal_cut(body->cutter, solids, s->scene.cut_count, NULL);
    owners = literal_owners(body->cutter);
    method_literal_renew(body, &times);
    method_literal_look(body, &m.model, &m.start);
    m.model.held = body->held;
    m.model.materials = &body->material;
    m.model.material_count = 1;
    m.integrals_ms = 1e3 * times.integrals;
    m.corners = match(s, &m.model, owners);
    if (body->cutter->report.failures == 0)
        row(s, &m, k, 1);
    else
        print_row(s, &m, k, -1, 0, -1, "a Boolean of rounded subdomains is refused");
    free(m.corners);
    free(owners);
    method_literal_destroy(body);
}

static void turn_thickness(const setting *s) {
    static const double thicknesses[THICKNESSES] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}; /* edges */
    int i;
    for (i = 0; i < THICKNESSES; i++) {
        char text[16];
        gx_surface *solids = make_solids(s, thicknesses[i] * s->edge);
        knobs k = compared_knobs("gxfem; solids", text);
        snprintf(text, sizeof text, "%g", thicknesses[i]);
        row_solids(s, solids, &k);
        k.series = "Algorithm 1";
        row_literal(s, solids, &k);
        free_solids(s, solids);
    }
}

/* ---- */

static size_t rows_of_scene(void) {
    size_t rows = 1 + STEPS * (SWEEPS + 2) + TOLERANCES + NEWTONS + SOLVERS + 1 + 2 + 2 * THICKNESSES;
    int i, j;
    for (i = 0; i < RULES; i++)
        for (j = 0; j < KNOBS && rules[i].knobs[j]; j++) rows += 2;
    return rows;
}

int main(int argc, char **argv) {
    int i, j;
    small = argc > 2 && strcmp(argv[2], "--small") == 0;
    if (argc < 3 + small) {
        fprintf(stderr, "usage: %s FILE [--small] SCENE=TRACE...\n", argv[0]);
        return 2;
    }
    if (small) duration /= 5;
    csv_open(argv[0], argv[1],
             "scene,series,value,dt,steps,ms_per_step,ms_per_second,error,of_exact,integrals_ms,points,note");
    total = (size_t)(argc - 2 - small) * rows_of_scene();
    for (i = 2 + small; i < argc; i++) {
        char name[32];
        replay scene = replay_argument(argv[0], argv[i], name);
        setting s;
        setting_make(&s, name, &scene);
        find_reference(&s);
        for (j = 0; j < SWEEPS; j++) turn_steps(&s, &s.own, &sweeps[j], STEPS);
        turn_duplication(&s);
        turn_deletion(&s);
        turn_solver(&s);
        turn_integrals(&s);
        turn_thickness(&s);
        print_front(name);
        print_integrals();
        kept_count = 0;
        turn_affine(&s, &scene);
        setting_free(&s);
        replay_free(&scene);
    }
    free(kept_rows);
    return csv_close();
}
