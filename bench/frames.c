/* frames.c - frames with a cut beside frames without one.

   make bench-frames builds it by -O2, as users do, and runs it. It prints CSV and writes it to build/bench/frames.csv,
   and a table to stderr. usage: frames [FILE [--small]]; --small: the smallest block only.

   A block hangs by its top and swings. After every fourth frame a horizontal cut goes one cell deeper, in strips
   that share their edges exactly, until it has crossed 7/8 of the block. A cut frame is the cut, the update of the
   solver's model and the step.

   Columns: medians in ms. worst: the slowest cut frame. ratio: cut frame to mean frame, cut frames included.
   unknowns: at the end. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "block.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"

enum { FRAMES_BETWEEN = 4, MOST_FRAMES = 1024, BLOCKS = 12 };

static const uint32_t block_cells[BLOCKS / 2] = {4, 8, 12, 19, 24, 40};

typedef struct row {
    char block[24];
    size_t elements, unknowns;
    double plain, cut, frame, worst, ratio; /* ms */
} row;

static void check(gx_result result) {
    if (result == GX_OK) return;
    fprintf(stderr, "frames: %s\n", gx_result_text(result));
    exit(1);
}

/* Times of a scene, ms */
typedef struct times {
    double plain[MOST_FRAMES], frame[MOST_FRAMES], cut[MOST_FRAMES], sum, worst;
    size_t plain_count, frame_count, frames;
} times;

static double step(gx_body *body, double time) {
    const double start = seconds(NULL);
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.033;
    desc.gravity[0] = 9.81 * sin(0.05 * sin(5 * time));
    desc.gravity[2] = -9.81 * cos(0.05 * sin(5 * time));
    check(gx_body_step(body, &desc, NULL, NULL));
    return 1e3 * (seconds(NULL) - start);
}

static void plain_frame(gx_body *body, times *t) {
    const double ms = step(body, 0.033 * (double)t->frames++);
    t->plain[t->plain_count++] = ms;
    t->sum += ms;
}

/* The next strip of the cut, from x = low to high, and the step after it */
static void cut_frame(gx_body *body, times *t, double low, double high) {
    const double start = seconds(NULL);
    double cut, ms;
    check(block_cut_rectangle(body, 2, 0.4711, low, high));
    cut = 1e3 * (seconds(NULL) - start);
    ms = cut + step(body, 0.033 * (double)t->frames++);
    t->cut[t->frame_count] = cut;
    t->frame[t->frame_count++] = ms;
    t->sum += ms;
    t->worst = ms > t->worst ? ms : t->worst;
}

static row run(uint32_t cells, double jitter) {
    const uint32_t strips = cells * 7 / 8;
    block_desc desc;
    gx_body *body = NULL;
    gx_view view;
    times *t = (times *)calloc(1, sizeof *t);
    uint32_t i, k;
    row r;
    memset(&desc, 0, sizeof desc);
    desc.cells = cells;
    desc.jitter = jitter;
    desc.young = 1e6;
    check(t ? block_create(&desc, &body) : GX_ERROR_MEMORY);
    for (k = 0; k < 8; k++) step(body, 0.033 * k);
    for (i = 0; i < strips; i++) {
        cut_frame(body, t, i == 0 ? -0.1 : (i + 0.37) / cells, (i + 1 + 0.37) / cells);
        for (k = 1; k < FRAMES_BETWEEN; k++) plain_frame(body, t);
    }
    check(gx_body_view(body, &view, NULL));
    snprintf(r.block, sizeof r.block, "%s-%u", jitter > 0 ? "jittered" : "lattice", (unsigned)cells);
    r.elements = view.element_count;
    r.unknowns = 3 * view.copy_count;
    r.plain = median(t->plain, t->plain_count);
    r.cut = median(t->cut, t->frame_count);
    r.frame = median(t->frame, t->frame_count);
    r.worst = t->worst;
    r.ratio = r.frame / (t->sum / (double)t->frames);
    csv_row("%s,%lu,%lu,%.2f,%.2f,%.2f,%.2f,%.2f", r.block, (unsigned long)r.elements, (unsigned long)r.unknowns,
            r.plain, r.cut, r.frame, r.worst, r.ratio);
    gx_body_destroy(body);
    free(t);
    return r;
}

static void print_table(const row *rows, size_t count) {
    size_t i;
    fprintf(stderr, "%-12s %9s %9s %12s %9s %14s %9s %7s\n", "block", "elements", "unknowns", "no cut, ms", "cut, ms",
            "cut frame, ms", "worst, ms", "ratio");
    for (i = 0; i < count; i++)
        fprintf(stderr, "%-12s %9lu %9lu %12.2f %9.2f %14.2f %9.2f %7.2f\n", rows[i].block,
                (unsigned long)rows[i].elements, (unsigned long)rows[i].unknowns, rows[i].plain, rows[i].cut,
                rows[i].frame, rows[i].worst, rows[i].ratio);
}

int main(int argc, char **argv) {
    int small;
    const char *path = csv_arguments(argc, argv, &small);
    const size_t count = small ? 2 : BLOCKS;
    row rows[BLOCKS];
    size_t i;
    csv_open(argv[0], path, "block,elements,unknowns,plain_ms,cut_ms,cut_frame_ms,worst_ms,ratio");
    for (i = 0; i < count; i++) {
        progress_draw("frames", i, count, "");
        rows[i] = run(block_cells[i / 2], i % 2 ? 0.2 : 0);
    }
    progress_draw("frames", count, count, "");
    print_table(rows, count);
    return csv_close();
}
