/* strokes.c - what a body holds and what a stroke costs after thousands of strokes that take material from it
   (strokes.h), beside a body that is cut to the same shape at once.

   make bench-strokes builds it by -O2, as users do, and runs it. It prints CSV and writes it to
   build/bench/strokes.csv, and a table to stderr. usage: strokes [FILE [--small]]; --small: fewer strokes.

   Times are of the processor. kb, most_kb: held after the last stroke, and at most. leaves: kept ones. us: of a stroke,
   for each element whose cells it touches: of the first tenth of the strokes, of the last tenth, of 50 further ones on
   the body freshly cut. median_ms, worst_ms: of a stroke. settled: how often the body has given back what it no longer
   needs; settle_ms: the longest stroke among those. A carving refines its tools by elements, so that no body is like
   it. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"
#include "strokes.h"

typedef struct held {
    size_t now, most;
} held;

static void *take(void *user, size_t size) {
    held *h = (held *)user;
    h->now += size;
    if (h->now > h->most) h->most = h->now;
    return malloc(size);
}

static void give(void *user, void *memory, size_t size) {
    ((held *)user)->now -= size;
    free(memory);
}

static void *retake(void *user, void *memory, size_t size, size_t larger) {
    held *h = (held *)user;
    h->now += larger - size;
    if (h->now > h->most) h->most = h->now;
    return realloc(memory, larger);
}

typedef struct row {
    strokes scene;
    size_t bytes, most, fresh_bytes, leaves, fresh_leaves, settled;
    double first, last, other; /* us for each touched element */
    double median, worst, longest;
    int same; /* 1: both bodies have the same topology */
} row;

static void check(gx_result result, const char *what) {
    if (result == GX_OK) return;
    fprintf(stderr, "strokes: %s: %s\n", what, gx_result_text(result));
    exit(1);
}

static gx_body *open_body(const strokes *scene, held *h) {
    gx_allocator a;
    gx_body *body = NULL;
    a.allocate = take;
    a.release = give;
    a.reallocate = retake;
    a.user = h;
    check(strokes_body(scene->side, &a, NULL, &body), "opening");
    return body;
}

static size_t kept_leaves(const gx_body *body) {
    size_t count = 0;
    uint32_t i;
    for (i = 0; i < gxb_complex_leaf_count(body->complex); i++) count += !gxb_complex_leaf(body->complex, i)->removed;
    return count;
}

/* us for each element touched by strokes first ... end-1; times: of each, s */
static double wear(const strokes *scene, gx_body *body, uint32_t first, uint32_t end, double *times, row *r) {
    size_t touched = 0;
    double sum = 0;
    uint32_t i;
    for (i = first; i < end; i++) {
        const uint64_t settled = body->complex->settled;
        gx_cut_report report;
        const double start = processor_seconds(NULL);
        memset(&report, 0, sizeof report);
        check(strokes_apply(scene, body, i, &report), strokes_names[scene->kind]);
        times[i - first] = processor_seconds(NULL) - start;
        sum += times[i - first];
        touched += report.touched_elements;
        if (r != NULL && body->complex->settled != settled) {
            r->settled++;
            r->longest = fmax(r->longest, 1e3 * times[i - first]);
        }
        progress_draw(strokes_names[scene->kind], i + 1, scene->total, "");
    }
    return touched > 0 ? 1e6 * sum / (double)touched : 0;
}

static void measure(row *r) {
    const strokes *scene = &r->scene;
    const uint32_t n = scene->total, tenth = n / 10;
    double *times = (double *)malloc((n + 50) * sizeof *times);
    held worn = {0, 0}, other = {0, 0};
    gx_body *body = open_body(scene, &worn), *fresh = NULL;
    if (times == NULL) exit(1);
    r->first = wear(scene, body, 0, tenth, times, r);
    wear(scene, body, tenth, n - tenth, times + tenth, r);
    r->last = wear(scene, body, n - tenth, n, times + n - tenth, r);
    r->median = 1e3 * median(times, n);
    r->worst = 1e3 * times[n - 1];
    r->bytes = worn.now;
    r->most = worn.most;
    r->leaves = kept_leaves(body);
    if (scene->kind != STROKES_CARVE) {
        fresh = open_body(scene, &other);
        check(strokes_cut_fresh(scene, fresh), "cutting at once");
        r->fresh_bytes = other.now;
        r->fresh_leaves = kept_leaves(fresh);
        r->same = gx_body_topology_hash(body, NULL) == gx_body_topology_hash(fresh, NULL);
        r->other = wear(scene, fresh, n, n + 50, times, NULL);
    }
    gx_body_destroy(body);
    gx_body_destroy(fresh);
    free(times);
}

static void print_row(const row *r) {
    const char *name = strokes_names[r->scene.kind];
    csv_row("%s,%lu,%lu,%.0f,%.0f,%.0f,%lu,%lu,%d,%.1f,%.1f,%.1f,%.3f,%.3f,%lu,%.3f", name,
            (unsigned long)r->scene.side, (unsigned long)r->scene.total, (double)r->bytes / 1024,
            (double)r->most / 1024, (double)r->fresh_bytes / 1024, (unsigned long)r->leaves,
            (unsigned long)r->fresh_leaves, r->same, r->first, r->last, r->other, r->median, r->worst,
            (unsigned long)r->settled, r->longest);
    progress_clear();
    fprintf(
        stderr,
        "%-8s %6lu strokes: %7.0f kB (freshly cut %7.0f), %6lu leaves (%6lu), %6.1f us an element at first, %6.1f at "
        "last (%6.1f); %.2f ms a stroke, at most %.2f\n",
        name, (unsigned long)r->scene.total, (double)r->bytes / 1024, (double)r->fresh_bytes / 1024,
        (unsigned long)r->leaves, (unsigned long)r->fresh_leaves, r->first, r->last, r->other, r->median, r->worst);
}

int main(int argc, char **argv) {
    static const uint32_t total[STROKES_KINDS] = {10000, 1000, 2000, 10000, 1000};
    const char *path;
    int small, kind;
    path = csv_arguments(argc, argv, &small);
    csv_open("strokes", path,
             "scene,side,strokes,kb,most_kb,fresh_kb,leaves,fresh_leaves,same,us_first,us_last,us_fresh,median_ms,"
             "worst_ms,settled,settle_ms");
    for (kind = 0; kind < STROKES_KINDS; kind++) {
        row r;
        memset(&r, 0, sizeof r);
        r.scene.kind = kind;
        r.scene.side = small ? 4 : 8;
        r.scene.total = small ? total[kind] / 20 : total[kind];
        measure(&r);
        print_row(&r);
    }
    return csv_close();
}
