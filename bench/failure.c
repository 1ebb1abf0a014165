/* failure.c - hard cases by every method: right, wrong (how), refused (why), diverged, crashed, or still busy after
   half a minute.

   make bench-failure builds and runs it. It prints CSV and writes it to build/bench/failure.csv, and a table to
   stderr. usage: failure [FILE [--small]]; --small: three seconds of processor time for each run.

   bench/hard.h has the cases and their right outcomes. The methods are those of bench/method.h, element deletion,
   and ways of integration where a case is about integrals. "Algorithm 1 mended" has everything that its Boolean
   allows today, and also cuts a millionth as thick. "but for volume" allows for the volume that a cut's thickness
   takes away. Each run has a process of its own, and half a minute of processor time. */
#define _XOPEN_SOURCE 600
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "csv.h"
#include "progress.h"
#include "replay.h"
#include "method.h"
#include "hard.h"
#include "parts.h"
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { COLUMNS = METHOD_COUNT + 1 + HARD_INTEGRALS };

static unsigned most_seconds = 30;

/* ---- element deletion ---- */

/* Elements whose inside a cut meets are removed; the others are whole, on uncut nodes. */
typedef struct deletion {
    method_body *cut;   /* Says which elements are met */
    method_body *uncut; /* Moves */
    gxs_element *elements;
    size_t element_count;
    gxs_solver *solver;
    int changed;
} deletion;

static void *deletion_create(const replay *scene) {
    deletion *d = (deletion *)method_memory(NULL, 1, sizeof *d);
    memset(d, 0, sizeof *d);
    d->cut = (method_body *)method_body_create(scene);
    d->uncut = (method_body *)method_body_create(scene);
    d->elements = (gxs_element *)method_memory(NULL, scene->element_count, sizeof *d->elements);
    d->changed = 1;
    method_must(gxs_solver_create(NULL, &d->solver, NULL), "solver");
    return d;
}

static const char *deletion_cut(void *state, const replay_cut *cut, method_times *times) {
    deletion *d = (deletion *)state;
    d->changed = 1;
    return method_body_cut(d->cut, cut, times);
}

static void deletion_look(void *state, gxs_model *model, const double **displacement) {
    deletion *d = (deletion *)state;
    size_t i;
    method_library_look(d->uncut, model, displacement);
    for (d->element_count = i = 0; i < model->element_count; i++)
        if (!parts_is_met(d->cut->body, model->elements[i].group)) d->elements[d->element_count++] = model->elements[i];
    model->elements = d->elements;
    model->element_count = d->element_count;
}

/* Nothing moves where nothing is left. */
static const char *deletion_step(void *state, method_times *times) {
    deletion *d = (deletion *)state;
    const double start = seconds(NULL);
    const double *displacement;
    gxs_model model;
    gx_view view;
    deletion_look(d, &model, &displacement);
    if (model.element_count == 0) return NULL;
    method_must(gx_body_view(d->uncut->body, &view, NULL), "view");
    if (d->changed) method_must(gxs_solver_set_model(d->solver, &model, NULL), "model");
    d->changed = 0;
    return method_solve(d->solver, d->uncut->scene, view.displacement, view.velocity, start, times);
}

static size_t deletion_unknowns(void *state) { return method_body_unknowns(((deletion *)state)->uncut); }

static void deletion_destroy(void *state) {
    deletion *d = (deletion *)state;
    method_body_destroy(d->cut);
    method_body_destroy(d->uncut);
    gxs_solver_destroy(d->solver);
    free(d->elements);
    free(d);
}

static const method deletion_method = {"element deletion", deletion_create, deletion_cut,    deletion_step,
                                       deletion_unknowns,  deletion_look,   deletion_destroy};

/* ---- a case by a method ---- */

static const double THINNER = 1e-6;

/* NULL: a way of integration */
static const method *column_method(int column) {
    return column < METHOD_COUNT ? &methods[column] : column == METHOD_COUNT ? &deletion_method : NULL;
}

static const hard_integral_method *column_integral(int column) {
    return &hard_integral_methods[column - METHOD_COUNT - 1];
}

static const char *column_name(int column) {
    return column_method(column) ? column_method(column)->name : column_integral(column)->name;
}

static void judge_column(const hard_case *row, int column, char text[HARD_TEXT]) {
    hard_trial t;
    hard_trial_make(&t, row);
    if (strcmp(column_name(column), "Algorithm 1 mended") == 0) t.scene.thickness *= THINNER;
    if (column_method(column))
        hard_judge(&t, column_method(column), text);
    else
        hard_integral_judge(&t, column_integral(column), text);
    hard_trial_free(&t);
}

/* The same in a process of its own */
static void judge_apart(const hard_case *row, int column, char text[HARD_TEXT]) {
    const struct rlimit limit = {most_seconds, most_seconds + 1};
    int pipes[2], status = 0;
    ssize_t length;
    pid_t child;
    method_must(pipe(pipes) == 0 ? GX_OK : GX_ERROR_LIMIT, "pipe");
    fflush(NULL);
    child = fork();
    method_must(child >= 0 ? GX_OK : GX_ERROR_MEMORY, "fork");
    if (child == 0) {
        setrlimit(RLIMIT_CPU, &limit);
        judge_column(row, column, text);
        _exit(write(pipes[1], text, strlen(text)) < 0);
    }
    close(pipes[1]);
    length = read(pipes[0], text, HARD_TEXT - 1);
    text[length > 0 ? length : 0] = 0;
    close(pipes[0]);
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        snprintf(text, HARD_TEXT, "busy after %u s", most_seconds);
    else if (WIFSIGNALED(status))
        snprintf(text, HARD_TEXT, "crashed: signal %d", WTERMSIG(status));
    else if (WEXITSTATUS(status) != 0)
        snprintf(text, HARD_TEXT, "crashed: exit %d", WEXITSTATUS(status));
}

/* ---- the table ---- */

enum { RIGHT, BUT_FOR_VOLUME, WRONG, REFUSED, DIVERGED, CRASHED, BUSY, OUTCOMES };

static const char *const outcomes[OUTCOMES] = {
    "right", "right but for volume", "wrong", "refused", "diverged", "crashed", "busy"};

static int outcome_of(const char *text) {
    int i;
    if (strcmp(text, outcomes[RIGHT]) == 0) return RIGHT;
    for (i = BUT_FOR_VOLUME; i + 1 < OUTCOMES; i++)
        if (strncmp(text, outcomes[i], strlen(outcomes[i])) == 0) return i;
    return BUSY;
}

static void print_table(size_t counts[COLUMNS][OUTCOMES]) {
    int c, i;
    fprintf(stderr, "%-20s", "cases");
    for (i = 0; i < OUTCOMES; i++) fprintf(stderr, " %s", outcomes[i]);
    fprintf(stderr, "\n");
    for (c = 0; c < COLUMNS; c++) {
        fprintf(stderr, "%-20s", column_name(c));
        for (i = 0; i < OUTCOMES; i++) fprintf(stderr, " %*lu", (int)strlen(outcomes[i]), (unsigned long)counts[c][i]);
        fprintf(stderr, "\n");
    }
}

int main(int argc, char **argv) {
    static size_t counts[COLUMNS][OUTCOMES];
    int r, c, small;
    const char *path = csv_arguments(argc, argv, &small);
    if (small) most_seconds = 3;
    csv_open(argv[0], path, "case,method,verdict");
    for (r = 0; r < HARD_CASES; r++)
        for (c = 0; c < COLUMNS; c++) {
            char text[HARD_TEXT];
            progress_draw("failure", (size_t)(r * COLUMNS + c), HARD_CASES * COLUMNS, hard_cases[r].name);
            judge_apart(&hard_cases[r], c, text);
            if (text[0] == 0) continue;
            csv_row("%s,%s,%s", hard_cases[r].name, column_name(c), text);
            counts[c][outcome_of(text)]++;
        }
    progress_draw("failure", HARD_CASES * COLUMNS, HARD_CASES * COLUMNS, "");
    print_table(counts);
    return csv_close() | (counts[0][RIGHT] < HARD_CASES);
}
