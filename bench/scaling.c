/* scaling.c - what a cut and a step cost, against elements, number of cuts, and triangles of a cut: nothing should grow faster than what
   is touched.

   make bench-scaling builds and runs it; it prints CSV and writes it to build/bench/scaling.csv; make charts draws it.
   BENCH=--small: sizes that take seconds.

   A block of tetrahedra (block.h) is cut by planes or by gently curved sheets, all the way through.
       elements   the first cut of a block of so many elements (its arrays still have to grow), and the median of those after it
       cuts       the median of the last half of so many cuts in one block: parallel planes at random heights, or planes of random
                  direction through the middle, which cross each other
       triangles  one cut, curved, of so many triangles
   Columns: times in us and per touched element; the arrangement alone; step_ms, a step after the cuts (its multigrid made before);
   unknowns before and after; remeshed: the unknowns of a mesh whose elements end at the cuts, at least (its old nodes, doubled at
   cuts as ours are, and one for each corner of the cut faces on each side); peak_mb, of the body's memory. */
#define _POSIX_C_SOURCE 199309L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "block.h"
#include "clock.h"
#include "csv.h"

enum { MOST_CUTS = 1024, LATER_CUTS = 6 };

static void check(gx_result result)
{
    if (result == GX_OK) return;
    fprintf(stderr, "scaling: %s\n", gx_result_text(result));
    exit(1);
}

/* ---- memory ---- */

typedef struct meter { size_t now, peak; } meter;

static void *meter_allocate(void *user, size_t size)
{
    meter *m = (meter *)user;
    m->now += size;
    m->peak = m->now > m->peak ? m->now : m->peak;
    return malloc(size);
}

static void meter_release(void *user, void *memory, size_t size)
{
    ((meter *)user)->now -= size;
    free(memory);
}

/* ---- sheets ---- */

/* A square of side x side cells of two triangles, larger than the block */
typedef struct sheet {
    gx_surface surface;
    double *vertices;
    uint32_t *triangles;
} sheet;

static sheet sheet_make(uint32_t side)
{
    sheet s;
    uint32_t i, j, n = 0;
    memset(&s, 0, sizeof s);
    s.vertices = (double *)malloc((size_t)(side + 1) * (side + 1) * 3 * sizeof(double));
    s.triangles = (uint32_t *)malloc((size_t)side * side * 6 * sizeof(uint32_t));
    check(s.vertices && s.triangles ? GX_OK : GX_ERROR_MEMORY);
    for (j = 0; j < side; j++)
        for (i = 0; i < side; i++) {
            const uint32_t a = j * (side + 1) + i, b = a + side + 1, corners[6] = {a, a + 1, b + 1, a, b + 1, b};
            memcpy(s.triangles + n, corners, sizeof corners);
            n += 6;
        }
    s.surface.vertices = s.vertices; s.surface.vertex_count = (size_t)(side + 1) * (side + 1);
    s.surface.triangles = s.triangles; s.surface.triangle_count = (size_t)side * side * 2;
    return s;
}

static void sheet_free(sheet *s)
{
    free(s->vertices);
    free(s->triangles);
}

/* z = height + slope . (x - 1/2, y - 1/2) + wave, over -1/4 to 5/4 */
static void sheet_place(sheet *s, double height, const double slope[2], double wave)
{
    const uint32_t side = (uint32_t)(0.5 + sqrt((double)(s->surface.triangle_count / 2)));
    uint32_t i, j;
    for (j = 0; j <= side; j++)
        for (i = 0; i <= side; i++) {
            double *v = s->vertices + 3 * (size_t)(j * (side + 1) + i);
            v[0] = -0.25 + 1.5 * i / side;
            v[1] = -0.25 + 1.5 * j / side;
            v[2] = height + slope[0] * (v[0] - 0.5) + slope[1] * (v[1] - 0.5) + wave * sin(5 * v[0]) * cos(4 * v[1]);
        }
}

/* ---- rows ---- */

typedef struct scene {
    gx_body *body;
    meter memory;
    uint32_t random;
    size_t unknowns;        /* before cuts */
    gx_cut_report report;   /* of the last cut */
} scene;

/* 0 to 1: Numerical Recipes' linear congruential generator, upper bits */
static double uniform(scene *s)
{
    s->random = s->random * 1664525u + 1013904223u;
    return (s->random >> 8) / 16777216.0;
}

static void scene_make(scene *s, uint32_t cells)
{
    block_desc desc;
    gx_view view;
    memset(s, 0, sizeof *s);
    memset(&desc, 0, sizeof desc);
    s->random = 1;
    desc.cells = cells;
    desc.jitter = 0.2;
    desc.young = 1e6;
    desc.allocator.allocate = meter_allocate;
    desc.allocator.release = meter_release;
    desc.allocator.user = &s->memory;
    desc.clock = seconds;
    check(block_create(&desc, &s->body));
    check(gx_body_view(s->body, &view));
    s->unknowns = 3 * view.copy_count;
}

/* Cuts by the sheet; microseconds */
static double cut(scene *s, const sheet *by)
{
    gx_cut_desc desc;
    double start;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &by->surface; desc.surface_count = 1;
    start = seconds(NULL);
    check(gx_body_cut(s->body, &desc, &s->report, NULL));
    return 1e6 * (seconds(NULL) - start);
}

/* Milliseconds of the last of three */
static double step(scene *s)
{
    gx_step_desc desc;
    double start = 0;
    int i;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.033;
    desc.gravity[2] = -9.81;
    for (i = 0; i < 3; i++) {
        start = seconds(NULL);
        check(gx_body_step(s->body, &desc, NULL, NULL));
    }
    return 1e3 * (seconds(NULL) - start);
}

/* A corner of the cut faces: a material point, and the copies that move it. */
typedef struct corner { uint32_t point, copies[4]; } corner;

static int corner_order(const void *a, const void *b) { return memcmp(a, b, sizeof(corner)); }

/* Corners of the cut faces that are not copies of nodes, each side counted */
static size_t cut_corners(const gx_skin *skin)
{
    corner *corners = (corner *)calloc(3 * skin->triangle_count + 1, sizeof *corners);
    size_t t, i, n = 0, distinct = 0;
    check(corners ? GX_OK : GX_ERROR_MEMORY);
    for (t = 0; t < 3 * skin->triangle_count; t++) {
        const uint32_t v = skin->triangles[t];
        if (skin->triangle_surface[t / 3] == GX_SKIN_OUTER || skin->vertex_weights[4 * (size_t)v + 1] == 0) continue;
        corners[n].point = skin->vertex_point[v];
        for (i = 0; i < 4; i++) corners[n].copies[i] = skin->vertex_weights[4 * (size_t)v + i] != 0 ? skin->vertex_copies[4 * (size_t)v + i] : 0;
        n++;
    }
    qsort(corners, n, sizeof *corners, corner_order);
    for (i = 0; i < n; i++) distinct += i == 0 || corner_order(&corners[i], &corners[i - 1]) != 0;
    free(corners);
    return distinct;
}

/* One row, of a scene as it is after its cuts: us of a cut, of which the arrangement */
static void row(scene *s, const char *sweep, const char *kind, size_t cuts, const sheet *by, double first, double us, double arrangement)
{
    const double touched = (double)s->report.touched_elements;
    gx_view view;
    gx_skin skin;
    check(gx_body_view(s->body, &view));
    check(gx_body_skin(s->body, NULL, &skin));
    csv_row("%s,%s,%lu,%lu,%lu,%.0f,%.0f,%.2f,%.2f,%.2f,%.1f,%lu,%lu,%lu,%.1f", sweep, kind, (unsigned long)view.element_count, (unsigned long)cuts,
            (unsigned long)by->surface.triangle_count, touched, us, first / touched, us / touched, arrangement / touched, step(s),
            (unsigned long)s->unknowns, (unsigned long)(3 * view.copy_count), (unsigned long)(3 * (view.copy_count + cut_corners(&skin))),
            (double)s->memory.peak / 1e6);
}

/* ---- sweeps ---- */

static void against_elements(uint32_t cells, double wave, uint32_t side)
{
    const double slope[2] = {0.05, 0.03};
    double us[LATER_CUTS], arrangement[LATER_CUTS], first;
    sheet by = sheet_make(side);
    scene s;
    int i;
    scene_make(&s, cells);
    sheet_place(&by, 0.5171, slope, wave);
    first = cut(&s, &by);
    for (i = 0; i < LATER_CUTS; i++) {
        sheet_place(&by, 0.22 + 0.0911 * i, slope, wave);
        us[i] = cut(&s, &by);
        arrangement[i] = 1e6 * s.report.seconds_arrangement;
    }
    row(&s, "elements", wave > 0 ? "curved" : "plane", 1 + LATER_CUTS, &by, first, median(us, LATER_CUTS), median(arrangement, LATER_CUTS));
    gx_body_destroy(s.body);
    sheet_free(&by);
}

static void next_plane(scene *s, sheet *by, int crossing)
{
    const double u = uniform(s), v = uniform(s), w = uniform(s), slope[2] = {crossing ? 2 * v - 1 : 0, crossing ? 2 * w - 1 : 0};
    sheet_place(by, crossing ? 0.4 + 0.2 * u : 0.01 + 0.98 * u, slope, 0);
}

static void against_cuts(uint32_t cells, size_t count, int crossing)
{
    static double us[MOST_CUTS], arrangement[MOST_CUTS];
    double touched = 0;
    sheet by = sheet_make(1);
    size_t i, from;
    scene s;
    scene_make(&s, cells);
    for (i = 0; i < count; i++) {
        next_plane(&s, &by, crossing);
        us[i] = cut(&s, &by);
        arrangement[i] = 1e6 * s.report.seconds_arrangement;
        if (i + 1 > count / 2) touched += (double)s.report.touched_elements;
    }
    from = count / 2;
    s.report.touched_elements = (size_t)(touched / (double)(count - from));
    row(&s, "cuts", crossing ? "crossing" : "parallel", count, &by, us[0], median(us + from, count - from), median(arrangement + from, count - from));
    gx_body_destroy(s.body);
    sheet_free(&by);
}

static void against_triangles(uint32_t cells, uint32_t side)
{
    const double slope[2] = {0.05, 0.03};
    sheet by = sheet_make(side);
    scene s;
    double us;
    scene_make(&s, cells);
    sheet_place(&by, 0.5171, slope, 0.05);
    us = cut(&s, &by);
    row(&s, "triangles", "curved", 1, &by, us, us, 1e6 * s.report.seconds_arrangement);
    gx_body_destroy(s.body);
    sheet_free(&by);
}

int main(int argc, char **argv)
{
    static const uint32_t cells[] = {6, 9, 13, 18, 27, 38, 58}, sides[] = {1, 3, 7, 22, 70, 224};
    static const size_t cuts[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
    const int small = argc > 2 && strcmp(argv[2], "--small") == 0;
    const uint32_t block = small ? 6 : 20;
    int i;
    csv_open(argc > 2 ? 2 : argc, argv, "sweep,kind,elements,cuts,triangles,touched,cut_us,first_us_per_touched,us_per_touched,"
             "arrangement_us_per_touched,step_ms,unknowns_before,unknowns,remeshed,peak_mb");
    for (i = 0; i < (small ? 2 : 7); i++) against_elements(cells[i], 0, 1);
    for (i = 0; i < (small ? 2 : 7); i++) against_elements(cells[i], 0.05, cells[i]);
    for (i = 0; i < (small ? 4 : 10); i++) against_cuts(block, cuts[i], 0);
    for (i = 0; i < (small ? 4 : 7); i++) against_cuts(block, cuts[i], 1);
    for (i = 0; i < (small ? 3 : 6); i++) against_triangles(block, sides[i]);
    return csv_close();
}
