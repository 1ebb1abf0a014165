/* solver.c - the cost of a time step, by preconditioner and form of the matrix, beside a direct solver.

   make bench-solver [BENCH="--small --case NAME"] builds and runs it. It prints CSV and writes it to
   build/bench/solver.csv, and a table to stderr.
       --small      the smallest size only
       --case NAME  only the cases with NAME in their name: accordion, loose-jittered, 23k-1e8, ...
       --out DIR    where solver.csv and product.csv go; without it they are not written

   A case is a block (block.h) that is released from rest: backward Euler, 33 ms, one Newton iteration, linear
   systems to 1e-2. The direction of gravity sways by 0.05 rad, so that the block keeps swinging. Otherwise backward
   Euler would bring a stiff block to rest to the last digit before the measurement ends. It does not sway by more:
   one Newton iteration does not follow a stiff accordion that is shaken, and its linear systems get easier. Every
   method starts from the same cut body at rest and makes the same steps. The first four are not counted.

   Columns of solver.csv:
       setup_ms     gxs_solver_set_model: the structure, once per cut
       solve_ms     the numbers of the preconditioner (or of the assembled matrix) and conjugate gradients; median of
                    steps
       step_ms      all of gxs_solver_step; median of the steps
       iterations   of conjugate gradients, mean of the steps
       peak_bytes   the most memory that the solver had at any time, from its allocator
       residual     of the last step's report, after the one Newton iteration

   Rows of `cholmod` (SuiteSparse, as the system has it, with its BLAS) are for the linear system of a step that starts
   from rest in the last state of multigrid-free, in double precision:
       setup_ms     cholmod_analyze: ordering and symbolic factorisation, once per cut
       solve_ms     cholmod_factorize and cholmod_solve; median of three
       step_ms      the median step of multigrid-free with this solve_ms in place of its own, without filling the
                    matrix
       peak_bytes   CHOLMOD's own count of the matrix, factor and workspace
       residual     |b - A x| / |b| of the linear system: not comparable with the others

   product.csv has the time of conjugate gradients per element and iteration: one product and some vector work with
   block-Jacobi, three products with multigrid. It also has the time of a product alone, with inertia, matrix-free on
   one thread: of `single` vectors, as conjugate gradients use, and of `double` vectors, as callers use
   (gxs_solver_product); medians of batches.

   Contents:
       >>host      clock, memory, threads       >>direct    the linear system for CHOLMOD
       >>run       one method on one body       >>cases     what is run
       >>products  the operator alone           >>main      the command line
       >>rows      what is printed */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "block.h"
#include "clock.h"
#include "csv.h"
#include "helper.h"
#include "forms.h"
#include "progress.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Some distributions have it in a folder of its own. */
#if defined(__has_include)
#if __has_include(<suitesparse/cholmod.h>)
#include <suitesparse/cholmod.h>
#else
#include <cholmod.h>
#endif
#else
#include <cholmod.h>
#endif

/* Steps from rest that are not counted, and the most steps that are made */
enum { STEPS_SKIPPED = 4, STEPS = 20 };

/* A method whose counted steps have taken this many seconds ends after its current step: block-Jacobi on the largest
   blocks. */
static const double patience = 30.0;

/* High enough never to be reached: a limit would make slow methods look fast. */
static const uint32_t cg_limit = 20000;

/* Limits for CHOLMOD: bytes of the factor, operations of the factorisation (minutes with a slow BLAS) */
static const double direct_bytes = 2e9, direct_operations = 5e11;

/* A step to 1e-5 may differ from CHOLMOD's by this share of it. Stiff blocks differ by 1e-4. */
static const double same_system = 1e-2;

/* -------------------------------------------------------------------------------------------------- >>host */

/* malloc, counted; on the thread of the solver's calls only */
typedef struct meter {
    size_t now, peak; /* bytes */
} meter;

static void *meter_allocate(void *user, size_t size) {
    meter *m = (meter *)user;
    void *memory = malloc(size);
    if (!memory) return NULL;
    m->now += size;
    if (m->now > m->peak) m->peak = m->now;
    return memory;
}

static void meter_release(void *user, void *memory, size_t size) {
    ((meter *)user)->now -= size;
    free(memory);
}

/* --------------------------------------------------------------------------------------------------- >>run */

typedef struct method {
    const char *name;
    gxs_preconditioner preconditioner;
    gxs_matrix matrix;
    int threads; /* 1 or 2 */
} method;

/* volume-ratio differs from jacobi-free by its diagonal only. */
enum { MULTIGRID_FREE = 2, MULTIGRID_FREE_2 = 5, METHODS = 6 };
/* clang-format off */
static const method methods[METHODS] = {
    {"jacobi-free", GXS_BLOCK_JACOBI, GXS_MATRIX_FREE, 1},
    {"jacobi-assembled", GXS_BLOCK_JACOBI, GXS_MATRIX_ASSEMBLED, 1},
    {"multigrid-free", GXS_MULTIGRID, GXS_MATRIX_FREE, 1},
    {"multigrid-assembled", GXS_MULTIGRID, GXS_MATRIX_ASSEMBLED, 1},
    {"volume-ratio", GXS_VOLUME_RATIO, GXS_MATRIX_FREE, 1},
    {"multigrid-free-2", GXS_MULTIGRID, GXS_MATRIX_FREE, 2}};
/* clang-format on */

typedef struct state {
    size_t count; /* 3 x copies */
    double *displacement, *velocity;
    int steps; /* made from rest */
} state;

/* Times are in seconds. */
typedef struct outcome {
    double setup, solve, step; /* the last two: medians */
    double iterations;         /* per step */
    double iteration;          /* seconds of conjugate gradients per iteration */
    double residual;
    size_t peak_bytes;
} outcome;

typedef struct samples {
    double solve[STEPS], step[STEPS];
    double seconds, conjugate_gradients, iterations; /* sums */
    size_t count;
} samples;

static size_t runs, run_total; /* methods on cases */

static int complain(const char *what, gx_result result) {
    fprintf(stderr, "solver: %s: %s\n", what, gx_result_text(result));
    return 0;
}

static int state_begin(state *s, size_t copies) {
    s->steps = 0;
    s->count = 3 * copies;
    s->displacement = (double *)calloc(s->count, sizeof(double));
    s->velocity = (double *)calloc(s->count, sizeof(double));
    return s->displacement && s->velocity;
}

static void state_end(state *s) {
    free(s->displacement);
    free(s->velocity);
    memset(s, 0, sizeof *s);
}

/* The step with this number from rest; gravity sways once in 12 steps. */
static gxs_step_desc step_make(int number) {
    const double angle = 0.05 * sin(2.0 * 3.14159265358979 * number / 12.0);
    gxs_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = 0.033;
    step.gravity[0] = 9.81 * sin(angle);
    step.gravity[2] = -9.81 * cos(angle);
    step.newton_iterations = 1;
    step.cg_iterations = cg_limit;
    step.cg_tolerance = 1e-2;
    step.clock = seconds;
    return step;
}

static void take_sample(samples *s, const gxs_step_report *report, double step) {
    s->seconds += step;
    s->step[s->count] = step;
    s->solve[s->count++] = report->seconds_prepare + report->seconds_solve;
    s->conjugate_gradients += report->seconds_solve;
    s->iterations += report->cg_iterations;
}

static void summarise(samples *s, outcome *o) {
    o->solve = median(s->solve, s->count);
    o->step = median(s->step, s->count);
    o->iterations = s->count > 0 ? s->iterations / (double)s->count : 0.0;
    o->iteration = s->iterations > 0 ? s->conjugate_gradients / s->iterations : 0.0;
}

/* The state's next step. */
static gx_result step_on(gxs_solver *solver, state *s, samples *taken, outcome *o) {
    const gxs_step_desc step = step_make(s->steps);
    const double start = seconds(NULL);
    gxs_step_report report;
    const gx_result result = gxs_solver_step(solver, &step, s->displacement, s->velocity, &report, NULL);
    if (result != GX_OK) return result;
    if (s->steps++ >= STEPS_SKIPPED) take_sample(taken, &report, seconds(NULL) - start);
    o->residual = report.residual;
    return GX_OK;
}

static gx_result swing(gxs_solver *solver, int steps, state *s, outcome *o) {
    gx_result result = GX_OK;
    samples taken;
    memset(&taken, 0, sizeof taken);
    while (result == GX_OK && s->steps < steps && taken.seconds < patience) result = step_on(solver, s, &taken, o);
    summarise(&taken, o);
    return result;
}

static gx_result set_and_swing(const gxs_solver_desc *desc, const gxs_model *model, int steps, state *s, outcome *o) {
    gxs_solver *solver = NULL;
    gx_result result = gxs_solver_create(desc, &solver, NULL);
    const double start = seconds(NULL);
    if (result == GX_OK) result = gxs_solver_set_model(solver, model, NULL);
    o->setup = seconds(NULL) - start;
    if (result == GX_OK) result = swing(solver, steps, s, o);
    gxs_solver_destroy(solver);
    return result;
}

/* A method on a model at rest; s is its state at the end. */
static int run_method(const method *m, const gxs_model *model, int steps, state *s, outcome *o) {
    gxs_solver_desc desc;
    helper second;
    meter memory = {0, 0};
    gx_result result;
    memset(&desc, 0, sizeof desc);
    memset(o, 0, sizeof *o);
    desc.allocator.allocate = meter_allocate;
    desc.allocator.release = meter_release;
    desc.allocator.user = &memory;
    desc.preconditioner = m->preconditioner;
    desc.matrix = m->matrix;
    if (!state_begin(s, model->copy_count)) return complain(m->name, GX_ERROR_MEMORY);
    if (m->threads > 1) {
        if (!helper_start(&second)) return complain("no second thread", GX_ERROR_LIMIT);
        desc.jobs.parallel_for = helper_parallel_for;
        desc.jobs.user = &second;
    }
    result = set_and_swing(&desc, model, steps, s, o);
    if (m->threads > 1) helper_stop(&second);
    o->peak_bytes = memory.peak;
    return result == GX_OK || complain(m->name, result);
}

/* ---------------------------------------------------------------------------------------------- >>products */

enum { PRODUCT_BATCHES = 15 };

/* The seconds that a batch takes */
static const double product_batch = 0.01;

typedef struct products {
    double single, doubles; /* seconds */
} products;

/* What a product works on: two vectors of either kind */
typedef struct operands {
    gxs_solver *solver;
    double rate, *direction, *product;
    gxsp_vector4 *single_direction, *single_product;
} operands;

static int operands_begin(operands *o, size_t copies, double rate) {
    uint32_t random = 1;
    size_t i;
    o->rate = rate;
    o->direction = (double *)calloc(3 * copies, sizeof *o->direction);
    o->product = (double *)calloc(3 * copies, sizeof *o->product);
    o->single_direction = (gxsp_vector4 *)calloc(copies, sizeof *o->single_direction);
    o->single_product = (gxsp_vector4 *)calloc(copies, sizeof *o->single_product);
    if (!o->direction || !o->product || !o->single_direction || !o->single_product) return 0;
    for (i = 0; i < 3 * copies; i++) {
        random = random * 1664525u + 1013904223u;
        o->direction[i] = (random >> 8) / 8388608.0 - 1.0;
        o->single_direction[i / 3][i % 3] = (float)o->direction[i];
    }
    return 1;
}

static void operands_end(operands *o) {
    gxs_solver_destroy(o->solver);
    free(o->direction);
    free(o->product);
    free(o->single_direction);
    free(o->single_product);
}

static gx_result multiply_single(operands *o) {
    gxsp_product(o->solver->system, o->rate, o->single_direction, o->single_product);
    return GX_OK;
}

static gx_result multiply_doubles(operands *o) { return gxs_solver_product(o->solver, o->direction, o->product, NULL); }

/* A batch: seconds of a product. count: the products in it; 0 in the first batch, which finds the number */
static gx_result time_batch(operands *o, gx_result (*multiply)(operands *), int *count, double *sample) {
    const double start = seconds(NULL);
    gx_result result = multiply(o);
    int i;
    for (i = 1; result == GX_OK && (*count > 0 ? i < *count : seconds(NULL) - start < product_batch); i++)
        result = multiply(o);
    *sample = (seconds(NULL) - start) / i;
    *count = i;
    return result;
}

/* Medians. Batches of either kind in turn, since the clock of the machine changes */
static gx_result time_products(operands *o, products *p) {
    double single[PRODUCT_BATCHES], doubles[PRODUCT_BATCHES];
    int batch, single_count = 0, doubles_count = 0;
    gx_result result = GX_OK;
    for (batch = 0; batch < PRODUCT_BATCHES; batch++) {
        if (result == GX_OK) result = time_batch(o, multiply_single, &single_count, &single[batch]);
        if (result == GX_OK) result = time_batch(o, multiply_doubles, &doubles_count, &doubles[batch]);
    }
    if (result != GX_OK) return result;
    p->single = median(single, PRODUCT_BATCHES);
    p->doubles = median(doubles, PRODUCT_BATCHES);
    return result;
}

/* At the state s, with the inertia of the steps that led there */
static int run_products(const gxs_model *model, const state *s, double rate, products *p) {
    operands o;
    gx_result result;
    memset(&o, 0, sizeof o);
    result = operands_begin(&o, model->copy_count, rate) ? gxs_solver_create(NULL, &o.solver, NULL) : GX_ERROR_MEMORY;
    if (result == GX_OK) result = gxs_solver_set_model(o.solver, model, NULL);
    if (result == GX_OK) result = gxs_solver_linearise(o.solver, s->displacement, rate, 0, NULL);
    if (result == GX_OK) result = time_products(&o, p);
    operands_end(&o);
    return result == GX_OK || complain("products", result);
}

/* -------------------------------------------------------------------------------------------------- >>rows */

typedef struct kept_row {
    char name[40]; /* of the case */
    const char *method;
    size_t unknowns, elements;
    outcome found;
    products alone; /* with the first method of the case; else 0 */
} kept_row;

/* Sizes, cuts, jittered or not, soft or stiff; methods and cholmod */
enum { ROWS = 4 * BLOCK_CUTS * 4 * (METHODS + 1) };

static kept_row rows[ROWS];
static size_t row_count;

static void add_row(const char *name, const char *method_name, const gxs_model *model, const outcome *o) {
    kept_row *r = &rows[row_count++];
    snprintf(r->name, sizeof r->name, "%s", name);
    r->method = method_name;
    r->unknowns = 3 * model->copy_count;
    r->elements = model->element_count;
    r->found = *o;
    memset(&r->alone, 0, sizeof r->alone);
    csv_row("%s,%s,%lu,%.1f,%.3f,%.3f,%.3f,%lu,%.3e", name, method_name, (unsigned long)r->unknowns, o->iterations,
            1e3 * o->setup, 1e3 * o->solve, 1e3 * o->step, (unsigned long)o->peak_bytes, o->residual);
}

/* Nanoseconds per element */
static double per_element(const kept_row *r, double time) { return 1e9 * time / (double)r->elements; }

/* Nanoseconds of conjugate gradients per element and iteration; 0: there are none */
static double iteration_of(const kept_row *r) { return per_element(r, r->found.iteration); }

/* Iterations / milliseconds of a step; cholmod: milliseconds. iteration: that of jacobi-free, which has one product
   in it */
static void print_table(void) {
    const kept_row *first = rows; /* of the case */
    size_t i;
    int m;
    fprintf(stderr, "iterations / ms of a step; ns per element: iteration of jacobi-free; product of single and of "
                    "double vectors\n");
    fprintf(stderr, "%-28s %8s", "case", "unknowns");
    for (m = 0; m < METHODS; m++) fprintf(stderr, " %19s", methods[m].name);
    fprintf(stderr, " %9s %9s %9s %9s", "cholmod", "iteration", "single", "double");
    for (i = 0; i < row_count; i++) {
        const kept_row *r = &rows[i];
        if (i == 0 || strcmp(r->name, r[-1].name) != 0) {
            first = r;
            fprintf(stderr, "\n%-28s %8lu", r->name, (unsigned long)r->unknowns);
        }
        if (strcmp(r->method, "cholmod") == 0)
            fprintf(stderr, " %9.2f", 1e3 * r->found.step);
        else
            fprintf(stderr, " %8.1f / %8.2f", r->found.iterations, 1e3 * r->found.step);
        if (i + 1 < row_count && strcmp(r->name, r[1].name) == 0) continue;
        fprintf(stderr, "%*s %9.2f %9.2f %9.2f", strcmp(r->method, "cholmod") == 0 ? 0 : 10, "", iteration_of(first),
                per_element(first, first->alone.single), per_element(first, first->alone.doubles));
    }
    fprintf(stderr, "\n");
}

static void write_product(const kept_row *r, const char *method_name, double time) {
    if (time > 0) csv_row("%s,%s,%lu,%.2f", r->name, method_name, (unsigned long)r->elements, per_element(r, time));
}

static int write_products(const char *path) {
    size_t i;
    csv_open_second("solver", path, "case,method,elements,ns_per_element");
    for (i = 0; i < row_count; i++) {
        write_product(&rows[i], rows[i].method, rows[i].found.iteration);
        write_product(&rows[i], "single", rows[i].alone.single);
        write_product(&rows[i], "double", rows[i].alone.doubles);
    }
    return csv_close();
}

/* A line beside the progress bar */
static void say(const char *format, ...) {
    va_list values;
    progress_clear();
    va_start(values, format);
    vfprintf(stderr, format, values);
    va_end(values);
}

/* ------------------------------------------------------------------------------------------------ >>direct */

/* (K + rate M) x = b, its lower triangle by columns as CHOLMOD wants it, without held copies and copies without an
   element. A copy's three unknowns make a block. Blocks of a column are sorted by rows, so that the diagonal one is
   the first. Masses are consistent and no copy follows others; the bodies of block.h are like that. */
typedef struct direct {
    const gxs_model *model;
    uint32_t *row; /* copy_count: number of the copy's row of blocks; NO_ROW */
    size_t rows;
    uint64_t *blocks; /* block_count: column << 32 | row, sorted */
    size_t block_count;
    size_t *column; /* rows + 1: index of each column's first block */
    cholmod_common common;
    cholmod_sparse *matrix;
    cholmod_dense *load, *solution;
    cholmod_factor *factor;
} direct;

static const uint32_t NO_ROW = UINT32_MAX;

static void direct_number(direct *d) {
    const gxs_model *model = d->model;
    size_t i;
    for (i = 0; i < model->copy_count; i++) d->row[i] = NO_ROW;
    for (i = 0; i < 4 * model->element_count; i++) {
        const gxs_element *element = &model->elements[i / 4];
        const uint32_t copy = element->copy[i % 4];
        if (element->weight > 0 && d->row[copy] == NO_ROW && !(model->held && model->held[copy]))
            d->row[copy] = (uint32_t)d->rows++;
    }
}

/* The lower block of corners i and j; 0: it has none, because it is the other order's, or because one of them is
   held */
static int direct_block(const direct *d, const gxs_element *element, int i, int j, uint64_t *block) {
    const uint32_t row = d->row[element->copy[i]], column = d->row[element->copy[j]];
    *block = (uint64_t)column << 32 | row;
    return element->weight > 0 && row != NO_ROW && column != NO_ROW && row >= column;
}

static int compare_blocks(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Every block that an element has, once; blocks has room for ten of each element. */
static void direct_list_blocks(direct *d) {
    size_t e, count = 0, i;
    int pair;
    for (e = 0; e < d->model->element_count; e++)
        for (pair = 0; pair < 16; pair++)
            if (direct_block(d, &d->model->elements[e], pair / 4, pair % 4, &d->blocks[count])) count++;
    qsort(d->blocks, count, sizeof *d->blocks, compare_blocks);
    for (i = 0; i < count; i++)
        if (i == 0 || d->blocks[i] != d->blocks[d->block_count - 1]) d->blocks[d->block_count++] = d->blocks[i];
    for (i = 0; i < d->block_count; i++) d->column[(d->blocks[i] >> 32) + 1] = i + 1;
}

/* The place of entry (r, s) of a block in the matrix. A column of n blocks has 3 n, 3 n - 1 and 3 n - 2 entries in
   its three columns, since the diagonal block is a triangle. */
static size_t direct_entry(const direct *d, size_t block, size_t r, size_t s) {
    const size_t column = d->blocks[block] >> 32, first = d->column[column], blocks = d->column[column + 1] - first;
    return 9 * first - 3 * column + s * 3 * blocks - s * (s + 1) / 2 + 3 * (block - first) + r;
}

/* The rows and columns of the matrix's entries. */
static void direct_shape(direct *d) {
    int *column = (int *)d->matrix->p, *row = (int *)d->matrix->i;
    size_t block, r, s;
    for (block = 0; block < d->block_count; block++) {
        const size_t i = (uint32_t)d->blocks[block], j = d->blocks[block] >> 32;
        for (s = 0; s < 3; s++) {
            if (i == j) column[3 * j + s] = (int)direct_entry(d, block, s, s);
            for (r = i == j ? s : 0; r < 3; r++) row[direct_entry(d, block, r, s)] = (int)(3 * i + r);
        }
    }
    column[3 * d->rows] = (int)d->matrix->nzmax;
}

/* dP/dF of an element at a displacement, 9x9, by the rows of F: made from nine products, symmetric up to rounding */
static void direct_tangent(const gxs_material *material, double gradient[4][3], const gxs_element *element,
                           const double *displacement, double tangent[9][9]) {
    double deformation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, direction[9];
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 9; k++)
            deformation[k] += displacement[3 * (size_t)element->copy[i] + (size_t)k / 3] * gradient[i][k % 3];
    for (k = 0; k < 9; k++) {
        memset(direction, 0, sizeof direction);
        direction[k] = 1;
        gxs_material_product(material, deformation, direction, tangent[k]);
    }
}

/* Entry (r, s) of the block of corners i and j: weight g_i . (dP_r/dF_s g_j), and rate times the mass */
static double direct_value(const gxs_element *element, double gradient[4][3], double tangent[9][9], double rate, int i,
                           int j, int r, int s) {
    static const int packed[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    double sum = 0;
    int c, e;
    for (c = 0; c < 3; c++)
        for (e = 0; e < 3; e++)
            sum +=
                gradient[i][c] * gradient[j][e] * 0.5 * (tangent[3 * r + c][3 * s + e] + tangent[3 * s + e][3 * r + c]);
    return element->weight * sum + (r == s ? rate * element->mass[packed[i][j]] : 0.0);
}

static size_t direct_find(const direct *d, uint64_t block) {
    const uint64_t *found = (const uint64_t *)bsearch(&block, d->blocks, d->block_count, sizeof block, compare_blocks);
    return (size_t)(found - d->blocks);
}

static void direct_add_element(direct *d, const gxs_element *element, const double *displacement, double rate) {
    double gradient[4][3], tangent[9][9], *values = (double *)d->matrix->x;
    uint64_t block;
    int pair, r, s;
    memcpy(gradient, element->gradient, sizeof gradient);
    for (s = 0; s < 3; s++) gradient[0][s] = -(gradient[1][s] + gradient[2][s] + gradient[3][s]);
    direct_tangent(&d->model->materials[element->material], gradient, element, displacement, tangent);
    for (pair = 0; pair < 16; pair++) {
        const int i = pair / 4, j = pair % 4;
        size_t at;
        if (!direct_block(d, element, i, j, &block)) continue;
        at = direct_find(d, block);
        for (s = 0; s < 3; s++)
            for (r = i == j ? s : 0; r < 3; r++)
                values[direct_entry(d, at, (size_t)r, (size_t)s)] +=
                    direct_value(element, gradient, tangent, rate, i, j, r, s);
    }
}

/* Mass times gravity less the elastic force, at a displacement at which the inertia of a step is 0 */
static gx_result direct_make_load(direct *d, const double *displacement, const double gravity[3]) {
    const size_t count = 3 * d->model->copy_count;
    double *fall = (double *)malloc(count * sizeof *fall), *weight = (double *)malloc(count * sizeof *weight);
    double *elastic = (double *)malloc(count * sizeof *elastic), *load = (double *)d->load->x;
    gx_result result = fall && weight && elastic ? GX_OK : GX_ERROR_MEMORY;
    size_t i;
    for (i = 0; i < count && result == GX_OK; i++) fall[i] = gravity[i % 3];
    if (result == GX_OK) form_mass_product(d->model, fall, weight);
    if (result == GX_OK) form_gradient(d->model, displacement, elastic);
    for (i = 0; i < count && result == GX_OK; i++)
        if (d->row[i / 3] != NO_ROW) load[3 * (size_t)d->row[i / 3] + i % 3] = weight[i] - elastic[i];
    free(fall);
    free(weight);
    free(elastic);
    return result;
}

static int direct_allocate(direct *d) {
    const size_t copies = d->model->copy_count, elements = d->model->element_count;
    d->row = (uint32_t *)malloc(copies * sizeof *d->row);
    d->column = (size_t *)calloc(copies + 1, sizeof *d->column);
    d->blocks = (uint64_t *)malloc((10 * elements + 1) * sizeof *d->blocks);
    return d->row && d->column && d->blocks;
}

static gx_result direct_assemble(direct *d, const double *displacement, const gxs_step_desc *step) {
    size_t e, size;
    if (!direct_allocate(d)) return GX_ERROR_MEMORY;
    direct_number(d);
    direct_list_blocks(d);
    size = 3 * d->rows;
    d->matrix = cholmod_allocate_sparse(size, size, 9 * d->block_count - size, 1, 1, -1, CHOLMOD_REAL, &d->common);
    d->load = cholmod_zeros(size, 1, CHOLMOD_REAL, &d->common);
    if (!d->matrix || !d->load) return GX_ERROR_MEMORY;
    direct_shape(d);
    memset(d->matrix->x, 0, d->matrix->nzmax * sizeof(double));
    for (e = 0; e < d->model->element_count; e++)
        direct_add_element(d, &d->model->elements[e], displacement, 1.0 / (step->dt * step->dt));
    return direct_make_load(d, displacement, step->gravity);
}

static void direct_begin(direct *d, const gxs_model *model) {
    memset(d, 0, sizeof *d);
    d->model = model;
    cholmod_start(&d->common);
    d->common.print = 0;
}

static void direct_end(direct *d) {
    cholmod_free_sparse(&d->matrix, &d->common);
    cholmod_free_dense(&d->load, &d->common);
    cholmod_free_dense(&d->solution, &d->common);
    cholmod_free_factor(&d->factor, &d->common);
    cholmod_finish(&d->common);
    free(d->row);
    free(d->column);
    free(d->blocks);
}

/* |b - A x| / |b|; the load is used up. */
static double direct_residual(direct *d) {
    double one[2] = {1, 0}, minus[2] = {-1, 0};
    const double size = cholmod_norm_dense(d->load, 2, &d->common);
    cholmod_sdmult(d->matrix, 0, minus, one, d->solution, d->load, &d->common);
    return size > 0 ? cholmod_norm_dense(d->load, 2, &d->common) / size : 0.0;
}

/* Analyses. Returns whether the factorisation is affordable. */
static int direct_analyse(direct *d, outcome *o) {
    const double start = seconds(NULL);
    double bytes;
    d->factor = cholmod_analyze(d->matrix, &d->common);
    o->setup = seconds(NULL) - start;
    if (!d->factor) return complain("cholmod", GX_ERROR_MEMORY);
    bytes = d->factor->is_super ? 8.0 * (double)d->factor->xsize : 12.0 * d->common.lnz;
    if (bytes <= direct_bytes && d->common.fl <= direct_operations) return 1;
    say("    cholmod: left out: its factor would have %.1f GB and take %.0f Gflop\n", 1e-9 * bytes,
        1e-9 * d->common.fl);
    return 0;
}

/* Factorises and solves once; 0: it failed. factorised: seconds of the factorisation */
static int direct_solve_once(direct *d, double *factorised, double *total) {
    const double start = seconds(NULL);
    cholmod_free_dense(&d->solution, &d->common);
    cholmod_factorize(d->matrix, d->factor, &d->common);
    *factorised = seconds(NULL) - start;
    if (d->common.status != CHOLMOD_OK) {
        say("solver: cholmod: status %d\n", d->common.status);
        return 0;
    }
    d->solution = cholmod_solve(CHOLMOD_A, d->factor, d->load, &d->common);
    *total = seconds(NULL) - start;
    return d->solution || complain("cholmod", GX_ERROR_MEMORY);
}

/* Three times: the first also pays for memory that steps keep */
static int direct_solve(direct *d, outcome *o) {
    const double operations = d->common.fl;
    double factorised[3], total[3];
    size_t i;
    for (i = 0; i < 3; i++)
        if (!direct_solve_once(d, &factorised[i], &total[i])) return 0;
    o->solve = median(total, 3);
    o->peak_bytes = d->common.memory_usage;
    o->residual = direct_residual(d);
    /* For a large block 20 with a good BLAS */
    say("    cholmod: %.1f Gflop/s\n", 1e-9 * operations / median(factorised, 3));
    return 1;
}

/* sqrt(x . M x) */
static double mass_norm(const gxs_model *model, const double *x, double *scratch) {
    double sum = 0;
    size_t i;
    form_mass_product(model, x, scratch);
    for (i = 0; i < 3 * model->copy_count; i++) sum += x[i] * scratch[i];
    return sqrt(sum);
}

/* The distance between the end of a solver's step to a tight tolerance and the end that the solution predicts, by
   the mass, relative to the solution: it tells whether both solved the same system. It is the error of the linear
   solve if the line search took the whole step. */
static double direct_difference(direct *d, const double *start, const state *end) {
    double *scratch = (double *)malloc(end->count * sizeof *scratch),
           *moved = (double *)calloc(end->count, sizeof *moved);
    double *apart = (double *)calloc(end->count, sizeof *apart), difference = NAN;
    size_t i;
    if (scratch && moved && apart) {
        for (i = 0; i < end->count; i++) {
            if (d->row[i / 3] == NO_ROW) continue;
            moved[i] = ((const double *)d->solution->x)[3 * (size_t)d->row[i / 3] + i % 3];
            apart[i] = end->displacement[i] - start[i] - moved[i];
        }
        difference = mass_norm(d->model, apart, scratch) / mass_norm(d->model, moved, scratch);
    }
    free(scratch);
    free(moved);
    free(apart);
    return difference;
}

/* One step of multigrid-free to a tight tolerance */
static gx_result step_tightly(const gxs_model *model, const gxs_step_desc *loose, state *s, gxs_step_report *report) {
    gxs_step_desc step = *loose;
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gx_result result;
    memset(&desc, 0, sizeof desc);
    desc.preconditioner = GXS_MULTIGRID;
    desc.matrix = GXS_MATRIX_FREE;
    step.cg_tolerance = 1e-5;
    result = gxs_solver_create(&desc, &solver, NULL);
    if (result == GX_OK) result = gxs_solver_set_model(solver, model, NULL);
    if (result == GX_OK) result = gxs_solver_step(solver, &step, s->displacement, s->velocity, report, NULL);
    gxs_solver_destroy(solver);
    return result;
}

/* 0: it solved another system. A step that the line search shortened decides nothing. */
static int direct_check(direct *d, const gxs_step_desc *step, const double *start, state *s) {
    gxs_step_report report;
    const gx_result result = step_tightly(d->model, step, s, &report);
    double difference;
    int same;
    if (result != GX_OK) return complain("check of cholmod", result);
    difference = direct_difference(d, start, s);
    same = difference < same_system || report.line_search_steps > 1;
    say("    cholmod: a step of multigrid-free to 1e-5 differs by %.1e%s\n", difference,
        same ? "" : ": ANOTHER SYSTEM");
    return same;
}

/* The system of a step from the state at rest, as the solver has it. At rest light copies start where they are;
   otherwise they start where their neighbours' velocities lead (docs/ARCHITECTURE.md). 0: left out or failed */
static int run_direct(const gxs_model *model, state *s, outcome *o) {
    const gxs_step_desc step = step_make(s->steps);
    double *start = (double *)malloc(s->count * sizeof *start);
    gx_result result = start ? GX_OK : GX_ERROR_MEMORY;
    direct d;
    size_t i;
    int done = 0;
    memset(o, 0, sizeof *o);
    direct_begin(&d, model);
    for (i = 0; i < s->count && start; i++) start[i] = s->displacement[i], s->velocity[i] = 0;
    if (result == GX_OK) result = direct_assemble(&d, start, &step);
    if (result != GX_OK)
        complain("cholmod", result);
    else
        done = direct_analyse(&d, o) && direct_solve(&d, o);
    if (done) done = direct_check(&d, &step, start, s);
    direct_end(&d);
    free(start);
    return done;
}

/* ------------------------------------------------------------------------------------------------- >>cases */

/* Cells along an edge for about this many unknowns after cutting */
enum { SIZES = 4 };
static const char *const size_names[SIZES] = {"7k", "23k", "48k", "150k"};
static const uint32_t size_cells[BLOCK_CUTS][SIZES] = {{12, 19, 24, 36}, {11, 16, 21, 30}, {8, 11, 15, 21}};

/* The swing is followed for fewer steps where they take long. */
static const int size_steps[SIZES] = {STEPS, STEPS, 12, 8};

typedef struct scene {
    char name[40];
    block_desc block;
    int steps;
} scene;

static scene scene_make(int cut, int jittered, int size, int hard) {
    scene s;
    memset(&s, 0, sizeof s);
    snprintf(s.name, sizeof s.name, "%s-%s-%s-%s", block_cut_names[cut], jittered ? "jittered" : "lattice",
             size_names[size], hard ? "1e8" : "1e6");
    s.block.cells = size_cells[cut][size];
    s.block.jitter = jittered ? 0.2 : 0.0;
    s.block.cut = cut;
    s.block.young = hard ? 1e8 : 1e6;
    s.steps = size_steps[size];
    return s;
}

/* Two threads and one must give the same bits. Compared are runs of as many steps only. */
static int compare_threads(const state *one, const state *two) {
    int same;
    if (one->steps != two->steps) return 1;
    same = memcmp(one->displacement, two->displacement, one->count * sizeof(double)) == 0 &&
           memcmp(one->velocity, two->velocity, one->count * sizeof(double)) == 0;
    say("    2 threads: %s\n", same ? "the same bits" : "OTHER BITS");
    return same;
}

/* The methods of the library; 0: one failed */
static int run_methods(const scene *s, const gxs_model *model, outcome found[METHODS], state ends[METHODS]) {
    int m, ok = 1;
    for (m = 0; m < METHODS; m++) {
        progress_draw("solver", runs++, run_total, methods[m].name);
        if (!run_method(&methods[m], model, s->steps, &ends[m], &found[m])) {
            ok = 0;
            continue;
        }
        add_row(s->name, methods[m].name, model, &found[m]);
    }
    return ok && compare_threads(&ends[MULTIGRID_FREE], &ends[MULTIGRID_FREE_2]);
}

static int run_model(const scene *s, const gxs_model *model) {
    outcome found[METHODS], by_cholmod;
    state ends[METHODS];
    int m, ok;
    memset(ends, 0, sizeof ends);
    ok = run_methods(s, model, found, ends);
    if (ok)
        ok = run_products(model, &ends[0], 1.0 / (step_make(0).dt * step_make(0).dt), &rows[row_count - METHODS].alone);
    progress_draw("solver", runs++, run_total, "cholmod");
    if (ok && run_direct(model, &ends[MULTIGRID_FREE], &by_cholmod)) {
        by_cholmod.step = found[MULTIGRID_FREE].step - found[MULTIGRID_FREE].solve + by_cholmod.solve;
        add_row(s->name, "cholmod", model, &by_cholmod);
    }
    for (m = 0; m < METHODS; m++) state_end(&ends[m]);
    return ok;
}

static int run_scene(const scene *s) {
    gx_body *body = NULL;
    gxs_model model;
    gx_result result = block_create(&s->block, &body);
    int ok;
    if (result == GX_OK) result = gx_body_model(body, &model, NULL);
    if (result != GX_OK)
        ok = complain(s->name, result);
    else {
        say("%s: %lu unknowns, %lu elements\n", s->name, (unsigned long)(3 * model.copy_count),
            (unsigned long)model.element_count);
        ok = run_model(s, &model);
    }
    gx_body_destroy(body);
    return ok;
}

/* -------------------------------------------------------------------------------------------------- >>main */

typedef struct settings {
    const char *filter, *folder; /* --case, --out */
    int small;
} settings;

static int take_arguments(settings *set, int argc, char **argv) {
    int i;
    memset(set, 0, sizeof *set);
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--small") == 0)
            set->small = 1;
        else if (strcmp(argv[i], "--case") == 0 && i + 1 < argc)
            set->filter = argv[++i];
        else if (strcmp(argv[i], "--out") == 0 && i + 1 < argc)
            set->folder = argv[++i];
        else
            return 0;
    }
    return 1;
}

/* The cases that are requested; returns their number */
static size_t list_scenes(const settings *set, scene *list) {
    const int sizes = set->small ? 1 : SIZES;
    size_t count = 0;
    int i;
    for (i = 0; i < sizes * BLOCK_CUTS * 4; i++) {
        const scene s = scene_make(i / 4 % BLOCK_CUTS, i / 2 % 2, i / (4 * BLOCK_CUTS), i % 2);
        if (!set->filter || strstr(s.name, set->filter)) list[count++] = s;
    }
    return count;
}

static char *path_in(const settings *set, const char *file, char path[4096]) {
    snprintf(path, 4096, "%s/%s", set->folder, file);
    return path;
}

int main(int argc, char **argv) {
    static scene list[SIZES * BLOCK_CUTS * 4];
    char path[4096];
    settings set;
    size_t count, i;
    int ok = 1;
    if (!take_arguments(&set, argc, argv)) {
        fprintf(stderr, "usage: solver [--small] [--case NAME] [--out DIR]\n");
        return 2;
    }
    count = list_scenes(&set, list);
    if (count == 0) {
        fprintf(stderr, "solver: no case has '%s' in its name\n", set.filter);
        return 2;
    }
    csv_open(argv[0], set.folder ? path_in(&set, "solver.csv", path) : NULL,
             "case,method,unknowns,iterations,setup_ms,solve_ms,step_ms,peak_bytes,residual");
    run_total = count * (METHODS + 1);
    for (i = 0; i < count; i++) ok = run_scene(&list[i]) && ok;
    progress_draw("solver", run_total, run_total, "");
    print_table();
    if (csv_close() || (set.folder && write_products(path_in(&set, "product.csv", path)))) return 2;
    return !ok;
}
