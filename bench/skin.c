/* skin.c - the visual surface: what it costs to move it in each frame, and to rebuild it after a cut, beside the cut itself.

   make bench-skin builds and runs it; it prints CSV and writes it to build/bench/skin.csv.

   A block cut into loose pieces gives a skin of many vertices: positions_us and normals_us are gx_body_skin_vertices without and with
   normals, pick_us a ray. Then a block in which a cut goes one cell deeper, strip by strip: cut_ms is gx_body_cut, rebuild_ms gx_body_skin
   after it (which looks for fragments in all of the body), view_ms what gx_body_view still has to do then, all_ms a skin made anew.
   Medians. */
#define _POSIX_C_SOURCE 199309L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "block.h"
#include "clock.h"
#include "csv.h"

enum { CALLS = 51, MOST_STRIPS = 64 };

static void check(gx_result result)
{
    if (result == GX_OK) return;
    fprintf(stderr, "skin: %s\n", gx_result_text(result));
    exit(1);
}

static gx_body *make_block(uint32_t cells, int cut)
{
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

static void measure_frames(uint32_t cells)
{
    gx_body *body = make_block(cells, BLOCK_LOOSE);
    const gx_skin_desc desc = {0.5, 1};
    const double from[3] = {-1, 0.3, 0.4}, along[3] = {1, 0.1, 0.05};
    double times[3][CALLS];
    float *positions, *normals;
    gx_skin skin;
    gx_hit hit;
    int i;
    check(gx_body_skin(body, &desc, &skin));
    positions = (float *)malloc(3 * skin.vertex_count * sizeof *positions);
    normals = (float *)malloc(3 * skin.vertex_count * sizeof *normals);
    check(positions && normals ? GX_OK : GX_ERROR_MEMORY);
    for (i = 0; i < CALLS; i++) {
        const double start = 1e3 * seconds(NULL);
        check(gx_body_skin_vertices(body, NULL, positions, NULL));
        times[0][i] = 1e3 * seconds(NULL) - start;
        check(gx_body_skin_vertices(body, NULL, positions, normals));
        times[1][i] = 1e3 * seconds(NULL) - start - times[0][i];
        check(gx_body_pick(body, from, along, &hit));
        times[2][i] = 1e3 * seconds(NULL) - start - times[0][i] - times[1][i];
    }
    csv_row("frame,%u,%lu,%lu,%.0f,%.0f,%.0f,,,,,", cells, (unsigned long)skin.vertex_count, (unsigned long)skin.triangle_count,
            1e3 * median(times[0], CALLS), 1e3 * median(times[1], CALLS), 1e3 * median(times[2], CALLS));
    free(positions);
    free(normals);
    gx_body_destroy(body);
}

static void measure_cuts(uint32_t cells)
{
    gx_body *body = make_block(cells, BLOCK_UNCUT);
    const gx_skin_desc desc = {0.5, 1}, other = {0.6, 1};
    double cut[MOST_STRIPS], view[MOST_STRIPS], rebuild[MOST_STRIPS], share[MOST_STRIPS], start;
    const uint32_t strips = cells * 7 / 8;
    gx_skin skin;
    gx_view seen;
    uint32_t i;
    size_t r;
    check(gx_body_skin(body, &desc, &skin));
    for (i = 0; i < strips; i++) {
        start = 1e3 * seconds(NULL);
        check(block_cut_rectangle(body, 2, 0.4711, i == 0 ? -0.1 : (i + 0.37) / cells, (i + 1 + 0.37) / cells));
        cut[i] = 1e3 * seconds(NULL) - start;
        start = 1e3 * seconds(NULL);
        check(gx_body_skin(body, &desc, &skin));
        rebuild[i] = 1e3 * seconds(NULL) - start;
        start = 1e3 * seconds(NULL);
        check(gx_body_view(body, &seen));
        view[i] = 1e3 * seconds(NULL) - start;
        for (r = 0, share[i] = 0; r < skin.triangle_range_count; r++) share[i] += skin.triangle_ranges[r].count / (double)skin.triangle_count;
    }
    start = 1e3 * seconds(NULL);
    check(gx_body_skin(body, &other, &skin));
    start = 1e3 * seconds(NULL) - start;
    csv_row("cut,%u,%lu,%lu,,,,%.3f,%.3f,%.3f,%.2f,%.4f", cells, (unsigned long)skin.vertex_count, (unsigned long)skin.triangle_count,
            median(cut, strips), median(rebuild, strips), median(view, strips), start, median(share, strips));
    gx_body_destroy(body);
}

int main(int argc, char **argv)
{
    csv_open(argc, argv, "kind,cells,vertices,triangles,positions_us,normals_us,pick_us,cut_ms,rebuild_ms,view_ms,all_ms,changed_share");
    measure_frames(16);
    measure_frames(24);
    measure_cuts(16);
    measure_cuts(24);
    measure_cuts(40);
    return csv_close();
}
