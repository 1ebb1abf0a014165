/* gxrunner.h: the frame of a program that the Open Boolean Benchmark runs: requests in, results out, by its "Runner I/O
   Contract" (kind boolean-benchmark, version 1). An engine computes; gxboolean.c has ours. Include gxio.h before.

   A run is a list of operations. Operation i makes the solid i: a file's, or the union, intersection or difference of
   solids before.

   contents
     >>request    a run's operations out of the JSON; what an engine has to do
     >>running    operations one by one, their times
     >>report     the results as JSON */
#ifndef GXRUNNER_H
#define GXRUNNER_H

#include "gxjson.h"

typedef struct gxrunner_options {
    const char *request, *result;
    const char *ending; /* of written surfaces: ".off", ".obj" or ".stl" */
    int last_only;      /* writes no solid that a later operation takes; the contract wants all */
} gxrunner_options;

/* --------------------------------------------------------------------------------------------- >>request */

enum { GXRUNNER_UNION = 0, GXRUNNER_INTERSECTION, GXRUNNER_DIFFERENCE, GXRUNNER_LOAD, GXRUNNER_UNKNOWN };

typedef struct gxrunner_solid {
    uint32_t operation;
    size_t *args; /* of a Boolean: solids before, at least one */
    size_t arg_count;
    size_t last_use;      /* the last operation that takes this solid; its own index: none */
    size_t line;          /* in the request */
    size_t path;          /* of a file: its JSON value */
    gxio_surface surface; /* of a file */
} gxrunner_solid;

/* What there is to say of an operation */
typedef struct gxrunner_outcome {
    const char *status; /* the contract's words: success, invalid_input, unsupported, crash, ... */
    double total, io, loading, operation, output; /* s */
    char file[GXIO_PATH_ROOM];
    gxio_error error;
} gxrunner_outcome;

typedef struct gxrunner_engine gxrunner_engine;

typedef struct gxrunner_run {
    const gxrunner_options *options;
    const gxrunner_engine *engine;
    void *native; /* the engine's own, of this run */
    const gxjson *json;
    char *folder;
    gxrunner_solid *solids;
    size_t count;
} gxrunner_run;

/* All return 0 on failure, with the outcome's status and error. The frame takes the times. */
struct gxrunner_engine {
    void *settings;
    /* The run is read: makes its own data. NULL: it has none */
    int (*start)(gxrunner_run *run, gxrunner_outcome *outcome);
    void (*stop)(gxrunner_run *run);
    /* Makes solid i of its surface. NULL: that is its own form */
    int (*load)(gxrunner_run *run, size_t i, gxrunner_outcome *outcome);
    /* Makes solid i of its arguments. */
    int (*combine)(gxrunner_run *run, size_t i, gxrunner_outcome *outcome);
    /* The surface of solid i, valid until the next call */
    int (*output)(gxrunner_run *run, size_t i, gxio_shell *shell, gxrunner_outcome *outcome);
};

static inline void gxrunner_release(gxrunner_run *run) {
    size_t i;
    if (run->native) run->engine->stop(run);
    for (i = 0; i < run->count; i++) {
        free(run->solids[i].args);
        gxio_surface_release(&run->solids[i].surface);
    }
    free(run->folder);
    free(run->solids);
}

static inline uint32_t gxrunner_operation(const gxjson *json, size_t name) {
    if (gxjson_equals(json, name, "load-mesh")) return GXRUNNER_LOAD;
    if (gxjson_equals(json, name, "boolean-union")) return GXRUNNER_UNION;
    if (gxjson_equals(json, name, "boolean-intersection")) return GXRUNNER_INTERSECTION;
    if (gxjson_equals(json, name, "boolean-difference")) return GXRUNNER_DIFFERENCE;
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

static inline int gxrunner_read_operation(gxrunner_run *run, size_t value, gxio_error *error) {
    const gxjson *json = run->json;
    const size_t i = run->count;
    gxrunner_solid *s = &run->solids[run->count++];
    memset(s, 0, sizeof *s);
    s->last_use = i;
    s->line = json->values[value].line;
    s->operation = gxrunner_operation(json, gxjson_find(json, value, "op"));
    if (s->operation == GXRUNNER_UNKNOWN) return 1;
    if (s->operation != GXRUNNER_LOAD) return gxrunner_read_args(run, i, gxjson_find(json, value, "args"), error);
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
    if (!run->folder || !run->solids) return gxio_fail(error, json->reader.path, 0, "out of memory");
    for (at = list + 1; at < json->values[list].next; at = json->values[at].next)
        if (!gxrunner_read_operation(run, at, error)) return 0;
    return 1;
}

/* --------------------------------------------------------------------------------------------- >>running */

static inline int gxrunner_load(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    gxrunner_solid *s = &run->solids[i];
    char *path = gxjson_text(run->json, s->path);
    double start = gxio_seconds(NULL);
    int good =
        path ? gxio_surface_read(path, &s->surface, &o->error) : gxio_fail(&o->error, "path", 0, "out of memory");
    o->io = gxio_seconds(NULL) - start;
    free(path);
    if (!good) {
        o->status = "invalid_input";
        return 0;
    }
    start = gxio_seconds(NULL);
    good = !run->engine->load || run->engine->load(run, i, o);
    o->loading = gxio_seconds(NULL) - start;
    return good;
}

static inline int gxrunner_make(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    const double start = gxio_seconds(NULL);
    int good;
    switch (run->solids[i].operation) {
    case GXRUNNER_LOAD: return gxrunner_load(run, i, o);
    case GXRUNNER_UNKNOWN:
        o->status = "unsupported";
        return gxio_fail(&o->error, run->json->reader.path, run->solids[i].line, "an unknown operation");
    default:
        good = run->engine->combine(run, i, o);
        o->operation = gxio_seconds(NULL) - start;
        return good;
    }
}

/* Writes the surface of solid i. */
static inline int gxrunner_write_solid(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    const gxrunner_solid *s = &run->solids[i];
    const double start = gxio_seconds(NULL);
    const int length =
        snprintf(o->file, sizeof o->file, "%s/op_%lu%s", run->folder, (unsigned long)i, run->options->ending);
    gxio_shell shell;
    memset(&shell, 0, sizeof shell);
    if (s->operation == GXRUNNER_LOAD) {
        shell.vertices = s->surface.vertices;
        shell.vertex_count = s->surface.vertex_count;
        shell.triangles = s->surface.triangles;
        shell.triangle_count = s->surface.triangle_count;
    } else {
        if (!run->engine->output(run, i, &shell, o)) return 0;
        o->output = gxio_seconds(NULL) - start;
    }
    o->status = "invalid_output";
    if (length < 0 || (size_t)length >= sizeof o->file)
        return gxio_fail(&o->error, "out_dir", 0, "the path is too long");
    if (!gxio_write_surface(o->file, &shell, &o->error)) return 0;
    o->status = "success";
    return 1;
}

static inline int gxrunner_operate(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    const double start = gxio_seconds(NULL);
    int good;
    memset(o, 0, sizeof *o);
    o->status = "success";
    good = gxrunner_make(run, i, o);
    if (good && !(run->options->last_only && run->solids[i].last_use > i)) good = gxrunner_write_solid(run, i, o);
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
    if (operation == GXRUNNER_LOAD) {
        gxrunner_say_time(t, "io_ms", o->io);
        gxrunner_say_time(t, "import_ms", o->loading);
    } else {
        gxrunner_say_time(t, "operation_ms", o->operation);
        gxrunner_say_time(t, "export_ms", o->output);
    }
    gxrunner_say(t, ", \"file\": ");
    gxrunner_say_string(t, *o->error.text ? "" : o->file);
    if (*o->error.text) {
        gxrunner_say(t, ", \"error\": ");
        gxrunner_say_string(t, o->error.text);
    }
    gxrunner_say(t, "}");
}

/* Runs one entry of "runs" and says how it went. 1: all its operations succeeded. An entry that makes no sense has no
   operations that did. */
static inline int gxrunner_run_one(const gxrunner_options *options, const gxrunner_engine *engine, const gxjson *json,
                                   size_t value, gxrunner_text *t) {
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
    run.engine = engine;
    run.json = json;
    good = gxrunner_read_run(&run, value, &outcome.error) && (!engine->start || engine->start(&run, &outcome));
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
static inline int gxrunner_serve(const gxrunner_options *options, const gxrunner_engine *engine, gxio_error *error) {
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
        if (!gxrunner_run_one(options, engine, &json, at, &said)) failed = 1;
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
