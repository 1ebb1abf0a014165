/* skin.c - the visual surface: the cost of moving it in each frame, and of updating it after a cut, beside the cut
   itself.

   make bench-skin builds and runs it. It prints CSV and writes it to build/bench/skin.csv, and a table to stderr.
   usage: skin [FILE [--small]]; --small: the same; it takes seconds.

   A block cut into loose fragments gives a skin of many vertices: positions_us and normals_us are
   gx_body_skin_vertices without and with normals, pick_us a ray. Then a cut goes one cell deeper in a block, strip
   by strip: cut_ms is gx_body_cut; rebuild_ms is gx_body_skin after it (which numbers the fragments of the whole
   body); view_ms is the rest of the work of gx_body_view; all_ms is a skin made from nothing. Medians. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "block.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"

enum { CALLS = 51, MOST_STRIPS = 64, FRAMES = 2, CUTS = 3 };

typedef struct row {
    uint32_t cells;
    size_t vertices, triangles;
    double positions, normals, pick;         /* us */
    double cut, rebuild, view, all, changed; /* ms; the last a share */
} row;

static void check(gx_result result) {
    if (result == GX_OK) return;
    fprintf(stderr, "skin: %s\n", gx_result_text(result));
    exit(1);
}

static gx_body *make_block(uint32_t cells, int cut) {
    block_desc desc;
    gx_body *body = NULL;
    memset(&desc, 0, sizeof desc);
    desc.cells = cells;
    desc.cut = cut;
    desc.jitter = 0.2;
    desc.young = 1e6;
    check(block_create(&desc, &body));
    return body;
}

static row measure_frames(uint32_t cells) {
    gx_body *body = make_block(cells, BLOCK_LOOSE);
    const gx_skin_desc desc = {0.5, 1};
    const double from[3] = {-1, 0.3, 0.4}, along[3] = {1, 0.1, 0.05};
    double times[3][CALLS];
    float *positions, *normals;
    gx_skin skin;
    gx_hit hit;
    row r;
    int i;
    memset(&r, 0, sizeof r);
    check(gx_body_skin(body, &desc, &skin, NULL));
    positions = (float *)malloc(3 * skin.vertex_count * sizeof *positions);
    normals = (float *)malloc(3 * skin.vertex_count * sizeof *normals);
    check(positions && normals ? GX_OK : GX_ERROR_MEMORY);
    for (i = 0; i < CALLS; i++) {
        const double start = 1e3 * seconds(NULL);
        check(gx_body_skin_vertices(body, NULL, positions, NULL, NULL));
        times[0][i] = 1e3 * seconds(NULL) - start;
        check(gx_body_skin_vertices(body, NULL, positions, normals, NULL));
        times[1][i] = 1e3 * seconds(NULL) - start - times[0][i];
        check(gx_body_pick(body, from, along, &hit, NULL));
        times[2][i] = 1e3 * seconds(NULL) - start - times[0][i] - times[1][i];
    }
    r.cells = cells;
    r.vertices = skin.vertex_count;
    r.triangles = skin.triangle_count;
    r.positions = 1e3 * median(times[0], CALLS);
    r.normals = 1e3 * median(times[1], CALLS);
    r.pick = 1e3 * median(times[2], CALLS);
    csv_row("frame,%u,%lu,%lu,%.0f,%.0f,%.0f,,,,,", (unsigned)cells, (unsigned long)r.vertices,
            (unsigned long)r.triangles, r.positions, r.normals, r.pick);
    free(positions);
    free(normals);
    gx_body_destroy(body);
    return r;
}

static row measure_cuts(uint32_t cells) {
    gx_body *body = make_block(cells, BLOCK_UNCUT);
    const gx_skin_desc desc = {0.5, 1}, other = {0.6, 1};
    double cut[MOST_STRIPS], view[MOST_STRIPS], rebuild[MOST_STRIPS], share[MOST_STRIPS], start;
    const uint32_t strips = cells * 7 / 8;
    gx_skin skin;
    gx_view seen;
    row r;
    uint32_t i;
    size_t k;
    memset(&r, 0, sizeof r);
    check(gx_body_skin(body, &desc, &skin, NULL));
    for (i = 0; i < strips; i++) {
        start = 1e3 * seconds(NULL);
        check(block_cut_rectangle(body, 2, 0.4711, i == 0 ? -0.1 : (i + 0.37) / cells, (i + 1 + 0.37) / cells));
        cut[i] = 1e3 * seconds(NULL) - start;
        start = 1e3 * seconds(NULL);
        check(gx_body_skin(body, &desc, &skin, NULL));
        rebuild[i] = 1e3 * seconds(NULL) - start;
        start = 1e3 * seconds(NULL);
        check(gx_body_view(body, &seen, NULL));
        view[i] = 1e3 * seconds(NULL) - start;
        for (k = 0, share[i] = 0; k < skin.triangle_range_count; k++)
            share[i] += skin.triangle_ranges[k].count / (double)skin.triangle_count;
    }
    start = 1e3 * seconds(NULL);
    check(gx_body_skin(body, &other, &skin, NULL));
    start = 1e3 * seconds(NULL) - start;
    r.cells = cells;
    r.vertices = skin.vertex_count;
    r.triangles = skin.triangle_count;
    r.cut = median(cut, strips);
    r.rebuild = median(rebuild, strips);
    r.view = median(view, strips);
    r.all = start;
    r.changed = median(share, strips);
    csv_row("cut,%u,%lu,%lu,,,,%.3f,%.3f,%.3f,%.2f,%.4f", (unsigned)cells, (unsigned long)r.vertices,
            (unsigned long)r.triangles, r.cut, r.rebuild, r.view, r.all, r.changed);
    gx_body_destroy(body);
    return r;
}

static void print_table(const row *frames, const row *cuts) {
    int i;
    fprintf(stderr, "%-6s %9s %9s %13s %12s %8s\n", "cells", "vertices", "triangles", "positions, us", "normals, us",
            "pick, us");
    for (i = 0; i < FRAMES; i++)
        fprintf(stderr, "%-6u %9lu %9lu %13.0f %12.0f %8.0f\n", (unsigned)frames[i].cells,
                (unsigned long)frames[i].vertices, (unsigned long)frames[i].triangles, frames[i].positions,
                frames[i].normals, frames[i].pick);
    fprintf(stderr, "%-6s %9s %9s %13s %12s %8s %14s %8s\n", "cells", "vertices", "triangles", "cut, ms", "rebuild, ms",
            "view, ms", "made anew, ms", "changed");
    for (i = 0; i < CUTS; i++)
        fprintf(stderr, "%-6u %9lu %9lu %13.3f %12.3f %8.3f %14.2f %8.4f\n", (unsigned)cuts[i].cells,
                (unsigned long)cuts[i].vertices, (unsigned long)cuts[i].triangles, cuts[i].cut, cuts[i].rebuild,
                cuts[i].view, cuts[i].all, cuts[i].changed);
}

int main(int argc, char **argv) {
    static const uint32_t frame_cells[FRAMES] = {16, 24}, cut_cells[CUTS] = {16, 24, 40};
    row frames[FRAMES], cuts[CUTS];
    int small;
    const char *path = csv_arguments(argc, argv, &small);
    size_t i;
    csv_open(
        argv[0], path,
        "kind,cells,vertices,triangles,positions_us,normals_us,pick_us,cut_ms,rebuild_ms,view_ms,all_ms,changed_share");
    for (i = 0; i < FRAMES + CUTS; i++) {
        progress_draw("skin", i, FRAMES + CUTS, i < FRAMES ? "frames" : "cuts");
        if (i < FRAMES)
            frames[i] = measure_frames(frame_cells[i]);
        else
            cuts[i - FRAMES] = measure_cuts(cut_cells[i - FRAMES]);
    }
    progress_draw("skin", FRAMES + CUTS, FRAMES + CUTS, "");
    print_table(frames, cuts);
    return csv_close();
}
