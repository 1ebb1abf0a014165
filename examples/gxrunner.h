/* gxrunner.h: the program that the Open Boolean Benchmark runs: requests in, results out, by its "Runner I/O Contract"
   (kind boolean-benchmark, version 1). Include gxio.h, gxfem_boolean.h and gxfailure.h before.

   A run is a list of operations. Operation i makes the solid i: a file's, or the union, intersection or difference of
   solids before. Solids are exact: only what is written is rounded. So a solid is kept as an expression of files'
   surfaces. A chain starts with a surface and combines it with further surfaces one by one: one Boolean is kept for all
   of it, and computes what is new. Any other expression gets a Boolean of its surfaces, and is evaluated point by
   point.

   contents
     >>request    a run's operations out of the JSON
     >>solids     surfaces, chains, expressions
     >>running    operations one by one, their times
     >>report     the results as JSON */
#ifndef GXRUNNER_H
#define GXRUNNER_H

#include "gxjson.h"

typedef struct gxrunner_options {
    const char *request, *result;
    const char *ending; /* of written surfaces: ".off", ".obj" or ".stl" */
    uint32_t rule, triangulation;
    int fine, mend;
} gxrunner_options;

/* --------------------------------------------------------------------------------------------- >>request */

enum { GXRUNNER_LOAD = 5, GXRUNNER_UNKNOWN }; /* beside GXB_UNION, GXB_INTERSECTION, GXB_DIFFERENCE */

typedef struct gxrunner_solid {
    uint32_t operation;
    size_t *args;
    size_t arg_count;
    size_t last_use;      /* the last operation that takes this solid; its own index: none */
    size_t line;          /* in the request */
    size_t path;          /* of a file: its JSON value */
    size_t chain;         /* of a chain: the solid that it extends by the other arguments; its own index: none */
    int is_chain;         /* or a file */
    gxio_surface surface; /* of a file */
    gxb_boolean *boolean; /* of a chain that is extended later */
} gxrunner_solid;

typedef struct gxrunner_run {
    const gxrunner_options *options;
    const gxjson *json;
    char *folder;
    gxrunner_solid *solids;
    size_t count, room;
    /* of the expression that is being evaluated */
    size_t *leaves; /* solids of files, by operand */
    size_t leaf_count, expressed;
    unsigned char *needed, *inside; /* by solid */
    /* of the result that is being written: vertices that a triangle has */
    double *vertices;
    uint32_t *triangles, *number;
} gxrunner_run;

static inline void gxrunner_release(gxrunner_run *run) {
    size_t i;
    for (i = 0; i < run->count; i++) {
        free(run->solids[i].args);
        gxio_surface_release(&run->solids[i].surface);
        gxb_boolean_destroy(run->solids[i].boolean);
    }
    free(run->folder);
    free(run->solids);
    free(run->leaves);
    free(run->needed);
    free(run->inside);
    free(run->vertices);
    free(run->triangles);
    free(run->number);
}

static inline uint32_t gxrunner_operation(const gxjson *json, size_t name) {
    if (gxjson_equals(json, name, "load-mesh")) return GXRUNNER_LOAD;
    if (gxjson_equals(json, name, "boolean-union")) return GXB_UNION;
    if (gxjson_equals(json, name, "boolean-intersection")) return GXB_INTERSECTION;
    if (gxjson_equals(json, name, "boolean-difference")) return GXB_DIFFERENCE;
    return GXRUNNER_UNKNOWN;
}

/* Reads the arguments of solid i, all of them solids before it. */
static inline int gxrunner_read_args(gxrunner_run *run, size_t i, size_t list, gxio_error *error) {
    const gxjson *json = run->json;
    gxrunner_solid *s = &run->solids[i];
    size_t at;
    if (!gxjson_is(json, list, GXJSON_ARRAY) || json->values[list].next == list + 1)
        return gxio_fail(error, json->reader.path, s->line, "a Boolean needs a list \"args\" of solids");
    s->args = (size_t *)gxio_array(json->values[list].next - list, sizeof *s->args);
    if (!s->args) return gxio_fail(error, json->reader.path, s->line, "out of memory");
    for (at = list + 1; at < json->values[list].next; at = json->values[at].next) {
        if (!gxjson_index(json, at, i, &s->args[s->arg_count]))
            return gxio_fail(error, json->reader.path, json->values[at].line,
                             "an argument is not the index of an operation before");
        run->solids[s->args[s->arg_count++]].last_use = i;
    }
    return 1;
}

static inline int gxrunner_is_file(const gxrunner_run *run, size_t i) {
    return run->solids[i].operation == GXRUNNER_LOAD;
}

/* Does solid i extend a chain by files? Unions and intersections may take the chain as any of their arguments: it comes
   to stand first. */
static inline void gxrunner_find_chain(gxrunner_run *run, size_t i) {
    gxrunner_solid *s = &run->solids[i];
    size_t k, others = 0, at = 0;
    s->chain = i;
    for (k = 0; k < s->arg_count; k++)
        if (!gxrunner_is_file(run, s->args[k])) {
            others++;
            at = k;
        }
    if (others > 1 || (at > 0 && s->operation == GXB_DIFFERENCE)) return;
    if (!run->solids[s->args[at]].is_chain) return;
    k = s->args[at];
    s->args[at] = s->args[0];
    s->args[0] = k;
    s->is_chain = 1;
    s->chain = k;
}

static inline int gxrunner_read_operation(gxrunner_run *run, size_t value, gxio_error *error) {
    const gxjson *json = run->json;
    const size_t i = run->count;
    gxrunner_solid *s = &run->solids[run->count++];
    memset(s, 0, sizeof *s);
    s->last_use = s->chain = i;
    s->line = json->values[value].line;
    s->operation = gxrunner_operation(json, gxjson_find(json, value, "op"));
    if (s->operation == GXRUNNER_UNKNOWN) return 1;
    if (s->operation != GXRUNNER_LOAD) {
        if (!gxrunner_read_args(run, i, gxjson_find(json, value, "args"), error)) return 0;
        gxrunner_find_chain(run, i);
        return 1;
    }
    s->is_chain = 1;
    s->path = gxjson_find(json, value, "path");
    return gxjson_is(json, s->path, GXJSON_STRING)
             ? 1
             : gxio_fail(error, json->reader.path, s->line, "load-mesh needs a string \"path\"");
}

/* On failure, too, the run has to be released. */
static inline int gxrunner_read_run(gxrunner_run *run, size_t value, gxio_error *error) {
    const gxjson *json = run->json;
    const size_t list = gxjson_find(json, value, "operations"), folder = gxjson_find(json, value, "out_dir");
    size_t at, count = 0;
    if (!gxjson_is(json, gxjson_find(json, value, "case_id"), GXJSON_STRING) || !gxjson_is(json, list, GXJSON_ARRAY) ||
        !gxjson_is(json, folder, GXJSON_STRING))
        return gxio_fail(error, json->reader.path, json->values[value].line,
                         "a run needs strings \"case_id\" and \"out_dir\" and a list \"operations\"");
    for (at = list + 1; at < json->values[list].next; at = json->values[at].next) count++;
    run->folder = gxjson_text(json, folder);
    run->solids = (gxrunner_solid *)gxio_array(count + 1, sizeof *run->solids);
    run->leaves = (size_t *)gxio_array(count + 1, sizeof *run->leaves);
    run->needed = (unsigned char *)malloc(count + 1);
    run->inside = (unsigned char *)malloc(count + 1);
    if (!run->folder || !run->solids || !run->leaves || !run->needed || !run->inside)
        return gxio_fail(error, json->reader.path, 0, "out of memory");
    for (at = list + 1; at < json->values[list].next; at = json->values[at].next)
        if (!gxrunner_read_operation(run, at, error)) return 0;
    return 1;
}

/* ---------------------------------------------------------------------------------------------- >>solids */

static inline gx_result gxrunner_create(const gxrunner_run *run, const gxb_boolean_desc *desc, gxb_boolean **boolean,
                                        gx_failure *failure) {
    gx_result result = gxb_boolean_create(desc, boolean, failure);
    if (result == GX_OK) result = gxb_boolean_set_triangulation(*boolean, run->options->triangulation, failure);
    if (result == GX_OK) result = gxb_boolean_set_fine(*boolean, run->options->fine, failure);
    return result == GX_OK ? gxb_boolean_set_mend(*boolean, run->options->mend, failure) : result;
}

static inline gx_result gxrunner_add(const gxrunner_run *run, gxb_boolean *boolean, size_t file, uint32_t operation,
                                     gx_failure *failure) {
    const gxio_surface *surface = &run->solids[file].surface;
    gxb_operand operand;
    memset(&operand, 0, sizeof operand);
    operand.vertices = surface->vertices;
    operand.vertex_count = surface->vertex_count;
    operand.triangles = surface->triangles;
    operand.triangle_count = surface->triangle_count;
    operand.operation = operation;
    operand.rule = run->options->rule;
    return gxb_boolean_add(boolean, &operand, failure);
}

/* Adds what solid i adds to its chain. */
static inline gx_result gxrunner_extend(const gxrunner_run *run, gxb_boolean *boolean, size_t i, gx_failure *failure) {
    const gxrunner_solid *s = &run->solids[i];
    gx_result result = GX_OK;
    size_t k;
    if (gxrunner_is_file(run, i)) return gxrunner_add(run, boolean, i, GXB_UNION, failure);
    for (k = 1; k < s->arg_count && result == GX_OK; k++)
        result = gxrunner_add(run, boolean, s->args[k], s->operation, failure);
    return result;
}

/* The Boolean of a chain: the one that its solid before has left, or one of all its surfaces */
static inline gx_result gxrunner_open_chain(gxrunner_run *run, size_t i, gxb_boolean **boolean, gx_failure *failure) {
    gxrunner_solid *s = &run->solids[i], *before = &run->solids[s->chain];
    gx_result result;
    size_t at, count = 0;
    *boolean = before->boolean;
    if (before->boolean) { /* solids that need it later start anew */
        before->boolean = NULL;
        return gxrunner_extend(run, *boolean, i, failure);
    }
    for (at = i; !gxrunner_is_file(run, at); at = run->solids[at].chain) run->leaves[count++] = at;
    run->leaves[count++] = at;
    result = gxrunner_create(run, NULL, boolean, failure);
    if (result == GX_OK && s->last_use > i) result = gxb_boolean_set_retained(*boolean, 1, failure);
    while (count > 0 && result == GX_OK) result = gxrunner_extend(run, *boolean, run->leaves[--count], failure);
    return result;
}

/* Is a point with these winding numbers inside the expressed solid? */
static int gxrunner_is_inside(void *user, const int32_t *winding, size_t operand_count) {
    gxrunner_run *run = (gxrunner_run *)user;
    size_t i, k;
    for (i = 0; i < operand_count; i++) {
        const int32_t w = winding[i];
        const uint32_t rule = run->options->rule;
        run->inside[run->leaves[i]] = rule == GXB_POSITIVE ? w > 0
                                    : rule == GXB_NEGATIVE ? w < 0
                                    : rule == GXB_ODD      ? w & 1
                                                           : w != 0;
    }
    for (i = 0; i <= run->expressed; i++) {
        const gxrunner_solid *s = &run->solids[i];
        int inside;
        if (!run->needed[i] || gxrunner_is_file(run, i)) continue;
        inside = run->inside[s->args[0]];
        for (k = 1; k < s->arg_count; k++) {
            const int other = run->inside[s->args[k]];
            inside =
                s->operation == GXB_UNION ? inside || other : inside && (s->operation == GXB_INTERSECTION) == other;
        }
        run->inside[i] = (unsigned char)inside;
    }
    return run->inside[run->expressed];
}

static inline gx_result gxrunner_open_expression(gxrunner_run *run, size_t i, gxb_boolean **boolean,
                                                 gx_failure *failure) {
    gxb_boolean_desc desc;
    gx_result result;
    size_t at, k;
    memset(run->needed, 0, run->count);
    run->needed[i] = 1;
    run->leaf_count = 0;
    for (at = i + 1; at-- > 0;) {
        if (!run->needed[at]) continue;
        if (gxrunner_is_file(run, at)) run->leaves[run->leaf_count++] = at;
        for (k = 0; k < run->solids[at].arg_count; k++) run->needed[run->solids[at].args[k]] = 1;
    }
    run->expressed = i;
    memset(&desc, 0, sizeof desc);
    desc.inside = gxrunner_is_inside;
    desc.user = run;
    result = gxrunner_create(run, &desc, boolean, failure);
    for (k = 0; k < run->leaf_count && result == GX_OK; k++)
        result = gxrunner_add(run, *boolean, run->leaves[k], GXB_UNION, failure);
    return result;
}

/* --------------------------------------------------------------------------------------------- >>running */

/* What there is to say of an operation */
typedef struct gxrunner_outcome {
    const char *status;                          /* the contract's words */
    double total, reading, operating, exporting; /* s */
    char file[GXIO_PATH_ROOM];
    gxio_error error;
} gxrunner_outcome;

static inline const char *gxrunner_status(gx_result result) {
    switch (result) {
    case GX_ERROR_NOT_CLOSED:
    case GX_ERROR_NOT_FINITE:
    case GX_ERROR_RANGE:
    case GX_ERROR_EMPTY: return "invalid_input";
    case GX_ERROR_LIMIT: return "unsupported";
    default: return "crash";
    }
}

static inline int gxrunner_load(gxrunner_run *run, size_t i, gxio_shell *shell, gxrunner_outcome *o) {
    gxrunner_solid *s = &run->solids[i];
    char *path = gxjson_text(run->json, s->path);
    const double start = gxio_seconds(NULL);
    const int good =
        path ? gxio_surface_read(path, &s->surface, &o->error) : gxio_fail(&o->error, "path", 0, "out of memory");
    o->reading = gxio_seconds(NULL) - start;
    free(path);
    if (!good) {
        o->status = "invalid_input";
        return 0;
    }
    shell->vertices = s->surface.vertices;
    shell->vertex_count = s->surface.vertex_count;
    shell->triangles = s->surface.triangles;
    shell->triangle_count = s->surface.triangle_count;
    return 1;
}

/* The shell of a result. A retained result may have vertices that no triangle has; the shell has none of them. */
static inline int gxrunner_export(gxrunner_run *run, const gxb_boolean_result *found, gxio_shell *shell) {
    const size_t corners = 3 * found->triangle_count;
    size_t i, count = 0;
    free(run->vertices);
    free(run->triangles);
    free(run->number);
    run->vertices = (double *)gxio_array(found->vertex_count + 1, 3 * sizeof(double));
    run->triangles = (uint32_t *)gxio_array(corners + 1, sizeof(uint32_t));
    run->number = (uint32_t *)gxio_array(found->vertex_count + 1, sizeof(uint32_t));
    if (!run->vertices || !run->triangles || !run->number) return 0;
    memset(run->number, 0, found->vertex_count * sizeof *run->number);
    for (i = 0; i < corners; i++) run->number[found->triangles[i]] = 1;
    for (i = 0; i < found->vertex_count; i++) {
        if (!run->number[i]) continue;
        memcpy(run->vertices + 3 * count, found->vertices + 3 * i, 3 * sizeof(double));
        run->number[i] = (uint32_t)count++;
    }
    for (i = 0; i < corners; i++) run->triangles[i] = run->number[found->triangles[i]];
    shell->vertices = run->vertices;
    shell->vertex_count = count;
    shell->triangles = run->triangles;
    shell->triangle_count = found->triangle_count;
    return 1;
}

/* The Boolean whose result the shell is, in *boolean, also on failure; NULL if there is none */
static inline int gxrunner_combine(gxrunner_run *run, size_t i, gxio_shell *shell, gxb_boolean **boolean,
                                   gxrunner_outcome *o) {
    const double start = gxio_seconds(NULL);
    double operated;
    int good;
    gxb_boolean_result found;
    gx_failure failure;
    gx_result result = run->solids[i].is_chain ? gxrunner_open_chain(run, i, boolean, &failure)
                                               : gxrunner_open_expression(run, i, boolean, &failure);
    if (result == GX_OK) result = gxb_boolean_evaluate(*boolean, &found, &failure);
    operated = gxio_seconds(NULL);
    o->operating = operated - start;
    if (result != GX_OK) {
        o->status = gxrunner_status(result);
        return gxio_fail(&o->error, "Boolean", 0, "%s", gxfailure_say(&failure, gxfailure_of_surfaces(result)).text);
    }
    good = gxrunner_export(run, &found, shell);
    o->exporting = gxio_seconds(NULL) - operated;
    if (good) return 1;
    o->status = "crash";
    return gxio_fail(&o->error, "result", 0, "out of memory");
}

static inline int gxrunner_operate(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    const double start = gxio_seconds(NULL);
    gxrunner_solid *s = &run->solids[i];
    gxb_boolean *boolean = NULL;
    gxio_shell shell;
    int good = 0, length;
    memset(&shell, 0, sizeof shell);
    memset(o, 0, sizeof *o);
    o->status = "success";
    if (s->operation == GXRUNNER_UNKNOWN) {
        o->status = "unsupported";
        gxio_fail(&o->error, run->json->reader.path, s->line, "an unknown operation");
    } else
        good = s->operation == GXRUNNER_LOAD ? gxrunner_load(run, i, &shell, o)
                                             : gxrunner_combine(run, i, &shell, &boolean, o);
    length = snprintf(o->file, sizeof o->file, "%s/op_%lu%s", run->folder, (unsigned long)i, run->options->ending);
    if (good && ((size_t)length >= sizeof o->file || !gxio_write_surface(o->file, &shell, &o->error))) {
        if ((size_t)length >= sizeof o->file) gxio_fail(&o->error, "out_dir", 0, "the path is too long");
        o->status = "invalid_output";
        good = 0;
    }
    if (good && s->is_chain && s->last_use > i)
        s->boolean = boolean;
    else
        gxb_boolean_destroy(boolean);
    o->total = gxio_seconds(NULL) - start;
    return good;
}

/* ---------------------------------------------------------------------------------------------- >>report */

/* Text that grows. failed: there was no memory */
typedef struct gxrunner_text {
    char *text;
    size_t length, room;
    int failed;
} gxrunner_text;

static inline void gxrunner_put(gxrunner_text *t, const char *text, size_t length) {
    if (t->length + length > t->room) {
        const size_t room = 2 * (t->length + length) + 4096;
        char *grown = (char *)realloc(t->text, room);
        if (!grown) {
            t->failed = 1;
            return;
        }
        t->text = grown;
        t->room = room;
    }
    memcpy(t->text + t->length, text, length);
    t->length += length;
}

static inline void gxrunner_say(gxrunner_text *t, const char *text) { gxrunner_put(t, text, strlen(text)); }

static inline void gxrunner_say_string(gxrunner_text *t, const char *text) {
    char code[8];
    gxrunner_say(t, "\"");
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') gxrunner_say(t, "\\");
        if ((unsigned char)*text < 0x20) {
            snprintf(code, sizeof code, "\\u%04x", (unsigned)(unsigned char)*text);
            gxrunner_say(t, code);
        } else
            gxrunner_put(t, text, 1);
    }
    gxrunner_say(t, "\"");
}

static inline void gxrunner_say_time(gxrunner_text *t, const char *name, double seconds) {
    char line[64];
    snprintf(line, sizeof line, ", \"%s\": %.6f", name, 1e3 * seconds);
    gxrunner_say(t, line);
}

/* A value of the request as it stands there; "null" if it has none */
static inline void gxrunner_echo(gxrunner_text *t, const gxjson *json, size_t value) {
    if (value > 0)
        gxrunner_put(t, json->values[value].text, json->values[value].length);
    else
        gxrunner_say(t, "null");
}

static inline void gxrunner_say_outcome(gxrunner_text *t, const gxrunner_outcome *o, uint32_t operation) {
    gxrunner_say(t, "        {\"status\": ");
    gxrunner_say_string(t, o->status);
    gxrunner_say_time(t, "debug_total_ms", o->total);
    if (operation == GXRUNNER_LOAD)
        gxrunner_say_time(t, "io_ms", o->reading);
    else {
        gxrunner_say_time(t, "operation_ms", o->operating);
        gxrunner_say_time(t, "export_ms", o->exporting);
    }
    gxrunner_say(t, ", \"file\": ");
    gxrunner_say_string(t, strcmp(o->status, "success") == 0 ? o->file : "");
    if (*o->error.text) {
        gxrunner_say(t, ", \"error\": ");
        gxrunner_say_string(t, o->error.text);
    }
    gxrunner_say(t, "}");
}

/* Runs one entry of "runs" and says how it went. 1: all its operations succeeded. An entry that makes no sense has no
   operations that did. */
static inline int gxrunner_run_one(const gxrunner_options *options, const gxjson *json, size_t value,
                                   gxrunner_text *t) {
    const double start = gxio_seconds(NULL);
    gxrunner_text operations;
    gxrunner_outcome outcome;
    gxrunner_run run;
    size_t i;
    int good;
    memset(&operations, 0, sizeof operations);
    memset(&run, 0, sizeof run);
    memset(&outcome, 0, sizeof outcome);
    outcome.status = "invalid_input";
    run.options = options;
    run.json = json;
    good = gxrunner_read_run(&run, value, &outcome.error);
    if (!good) gxrunner_say_outcome(&operations, &outcome, GXRUNNER_UNKNOWN);
    for (i = 0; i < run.count && good; i++) {
        good = gxrunner_operate(&run, i, &outcome);
        if (i > 0) gxrunner_say(&operations, ",\n");
        gxrunner_say_outcome(&operations, &outcome, run.solids[i].operation);
    }
    gxrunner_say(t, "    {\"case_id\": ");
    gxrunner_echo(t, json, gxjson_find(json, value, "case_id"));
    gxrunner_say(t, ", \"status\": ");
    gxrunner_say_string(t, good ? "success" : outcome.status);
    gxrunner_say_time(t, "duration_ms", gxio_seconds(NULL) - start);
    gxrunner_say(t, ", \"ops\": [\n");
    if (operations.length > 0) gxrunner_put(t, operations.text, operations.length);
    gxrunner_say(t, "\n    ]}");
    t->failed |= operations.failed;
    free(operations.text);
    gxrunner_release(&run);
    return good;
}

/* Writes what is known so far. The file is always whole. */
static inline int gxrunner_write(const gxrunner_options *options, const gxjson *json, const gxrunner_text *runs,
                                 gxio_error *error) {
    gxrunner_text whole;
    gxio_writer writer;
    int good = !runs->failed;
    memset(&whole, 0, sizeof whole);
    gxrunner_say(&whole, "{\n  \"kind\": \"boolean-benchmark\",\n  \"version\": 1,\n  \"id\": ");
    gxrunner_echo(&whole, json, gxjson_find(json, 0, "id"));
    gxrunner_say(&whole, ",\n  \"runs\": [\n");
    if (runs->length > 0) gxrunner_put(&whole, runs->text, runs->length);
    gxrunner_say(&whole, "\n  ]\n}\n");
    if (!good || whole.failed)
        good = gxio_fail(error, options->result, 0, "out of memory");
    else if ((good = gxio_writer_open(&writer, options->result, error)) != 0) {
        fwrite(whole.text, 1, whole.length, writer.stream);
        good = gxio_writer_close(&writer, 1, error);
    }
    free(whole.text);
    return good;
}

enum { GXRUNNER_DONE = 0, GXRUNNER_FAILED, GXRUNNER_MISUSED };

/* Runs a request. GXRUNNER_FAILED: an operation failed, and the result says which. GXRUNNER_MISUSED: the request cannot
   be read, or the result not written; error says why. */
static inline int gxrunner_serve(const gxrunner_options *options, gxio_error *error) {
    const double flush = 10; /* s between partial results */
    double flushed = gxio_seconds(NULL);
    gxrunner_text said;
    gxjson json;
    size_t runs, at;
    int failed = 0, good;
    if (!gxjson_read(&json, options->request, error)) return GXRUNNER_MISUSED;
    memset(&said, 0, sizeof said);
    runs = gxjson_find(&json, 0, "runs");
    good = gxjson_equals(&json, gxjson_find(&json, 0, "kind"), "boolean-benchmark") &&
           gxjson_is(&json, runs, GXJSON_ARRAY);
    if (!good)
        gxio_fail(error, options->request, 0, "is no request of kind \"boolean-benchmark\" with a list \"runs\"");
    for (at = runs + 1; good && at < json.values[runs].next; at = json.values[at].next) {
        if (said.length > 0) gxrunner_say(&said, ",\n");
        if (!gxrunner_run_one(options, &json, at, &said)) failed = 1;
        if (gxio_seconds(NULL) - flushed < flush) continue;
        good = gxrunner_write(options, &json, &said, error);
        flushed = gxio_seconds(NULL);
    }
    good = good && gxrunner_write(options, &json, &said, error);
    free(said.text);
    gxjson_release(&json);
    return !good ? GXRUNNER_MISUSED : failed ? GXRUNNER_FAILED : GXRUNNER_DONE;
}

#endif /* GXRUNNER_H */
