/* scaling.c - the cost of a cut and a step against elements, number of cuts, and triangles of a cut. Nothing should
   grow faster than what is touched.

   make bench-scaling builds and runs it. It prints CSV and writes it to build/bench/scaling.csv; make charts draws
   it. BENCH=--small: sizes that take seconds. MESH=FILE: also cuts through that body, in a format that
   examples/gxio.h reads.

   A block of tetrahedra (block.h) is cut by planes or by gently curved sheets, all the way through.
       elements   the first cut of a block of that size (its arrays still have to grow), and the median of later
                  ones; curved-pool: in memory that the host has used before, on pages of 2 MB
       cuts       the median of the last half of the cuts in one block: parallel planes at random heights, or planes
                  of random direction through the middle, which cross each other (up to 100: fragments grow with the
                  cube of their number)
       triangles  one curved cut of that many triangles
       mesh       as elements, through the body of the file, its longest side 1 m: across each of its axes, planes
                  and curved sheets of that many triangles

   Columns: created: cells that a cut makes (of the last cut, or the mean of the last half); times in us and per
   touched element; the arrangement alone; step_ms: a step after the cuts, with its multigrid already made; peak_mb:
   of the body's memory. Unknowns, three for each displacement:
       unknowns_before, unknowns   ours
       least      what separation demands: for each node, the sets into which the cells around it fall; counted in
                  doubles by bench/least.h, which knows nothing of the library
       vna        corners of the replicas of cut elements, counted once where links join them, from the same cells
                  and links
       remeshed   a mesh whose elements end at the cuts, at least: its old nodes, and each corner of the cut faces
                  (where the cut's triangles and their edges cross the elements' edges and faces, and the triangles'
                  corners inside) once for each part that it is on. Nodes that a mesher adds for the shape of its
                  elements are not counted

   It exits with 1 if ours are not the least. A table goes to stderr. It shows how costs grow: as a power of the
   swept quantity, by least squares over the upper half of its decades. A cut touches the cells that it makes and its
   triangles. */
#define _POSIX_C_SOURCE 200112L
#define _DEFAULT_SOURCE /* madvise */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../examples/gxio.h"
#include "block.h"
#include "clock.h"
#include "csv.h"
#include "least.h"
#include "progress.h"
#include <sys/mman.h>

enum { MOST_CUTS = 1024, LATER_CUTS = 6, MOST_ROWS = 64 };

static void check(gx_result result) {
    if (result == GX_OK) return;
    fprintf(stderr, "scaling: %s\n", gx_result_text(result));
    exit(1);
}

/* ---- memory ---- */

/* Memory of a host that has it before the scene begins: blocks of powers of two out of one area of large pages
   (where the system provides them on request), all touched before, and returned to the list of their size. */
typedef struct pool {
    unsigned char *memory;
    size_t size, used;
    void *spare[48];
} pool;

enum { LARGE_PAGE = 1 << 21, POOL_LEAST = 12 }; /* smaller blocks than 2^12 bytes are malloc's */

static int power_of(size_t size) {
    int power = POOL_LEAST;
    while ((size_t)1 << power < size) power++;
    return power;
}

static int pool_make(pool *p, size_t size) {
    void *memory;
    memset(p, 0, sizeof *p);
    if (posix_memalign(&memory, LARGE_PAGE, size) != 0) return 0;
#ifdef MADV_HUGEPAGE
    madvise(memory, size, MADV_HUGEPAGE);
#endif
    memset(memory, 0, size);
    p->memory = (unsigned char *)memory;
    p->size = size;
    return 1;
}

static void *pool_take(pool *p, size_t size) {
    const int power = power_of(size);
    void *memory = p->spare[power];
    if (memory)
        memcpy(&p->spare[power], memory, sizeof memory);
    else if (p->size - p->used >= (size_t)1 << power) {
        memory = p->memory + p->used;
        p->used += (size_t)1 << power;
    }
    return memory;
}

static void pool_give_back(pool *p, void *memory, size_t size) {
    void **list = &p->spare[power_of(size)];
    memcpy(memory, list, sizeof *list);
    *list = memory;
}

/* Memory of a body, counted; from the pool if there is one */
typedef struct meter {
    size_t now, peak;
    pool *pool;
} meter;

static int is_pooled(const meter *m, const void *memory) {
    const uintptr_t at = (uintptr_t)memory, from = m->pool ? (uintptr_t)m->pool->memory : 0;
    return m->pool && at >= from && at < from + m->pool->size;
}

static void count(meter *m, size_t more, size_t less) {
    m->now += more - less;
    m->peak = m->now > m->peak ? m->now : m->peak;
}

static void *meter_allocate(void *user, size_t size) {
    meter *m = (meter *)user;
    void *memory = m->pool && size >> POOL_LEAST > 0 ? pool_take(m->pool, size) : NULL;
    if (!memory) memory = malloc(size);
    if (memory) count(m, size, 0);
    return memory;
}

static void meter_release(void *user, void *memory, size_t size) {
    meter *m = (meter *)user;
    count(m, 0, size);
    if (is_pooled(m, memory))
        pool_give_back(m->pool, memory, size);
    else
        free(memory);
}

static void *meter_reallocate(void *user, void *memory, size_t size, size_t larger) {
    meter *m = (meter *)user;
    void *moved = memory;
    if (m->pool && (!is_pooled(m, memory) || power_of(size) != power_of(larger))) {
        if (!(moved = meter_allocate(user, larger))) return NULL;
        memcpy(moved, memory, size);
        meter_release(user, memory, size);
        return moved;
    }
    if (!m->pool && !(moved = realloc(memory, larger))) return NULL;
    count(m, larger, size);
    return moved;
}

/* ---- sheets ---- */

/* A square of side x side cells of two triangles, larger than the block */
typedef struct sheet {
    gx_surface surface;
    uint32_t side;
    double *x, *y; /* side + 1: of the grid's lines */
    double *vertices;
    uint32_t *triangles;
} sheet;

static void *memory_of(void *old, size_t count, size_t size) {
    void *memory = realloc(old, count * size);
    check(memory ? GX_OK : GX_ERROR_MEMORY);
    return memory;
}

/* From -1/4 to 5/4, and a little off: no line or diagonal of the grid meets a node of the block */
static sheet sheet_make(uint32_t side) {
    sheet s;
    uint32_t i, j, n = 0;
    memset(&s, 0, sizeof s);
    s.side = side;
    s.x = (double *)memory_of(NULL, side + 1, sizeof(double));
    s.y = (double *)memory_of(NULL, side + 1, sizeof(double));
    s.vertices = (double *)memory_of(NULL, (size_t)(side + 1) * (side + 1) * 3, sizeof(double));
    s.triangles = (uint32_t *)memory_of(NULL, (size_t)side * side * 6, sizeof(uint32_t));
    for (i = 0; i <= side; i++) {
        s.x[i] = -0.2513 + 1.5027 * i / side;
        s.y[i] = -0.2541 + 1.5027 * i / side;
    }
    for (j = 0; j < side; j++)
        for (i = 0; i < side; i++) {
            const uint32_t a = j * (side + 1) + i, b = a + side + 1, corners[6] = {a, a + 1, b + 1, a, b + 1, b};
            memcpy(s.triangles + n, corners, sizeof corners);
            n += 6;
        }
    s.surface.vertices = s.vertices;
    s.surface.vertex_count = (size_t)(side + 1) * (side + 1);
    s.surface.triangles = s.triangles;
    s.surface.triangle_count = (size_t)side * side * 2;
    return s;
}

static void sheet_free(sheet *s) {
    free(s->x);
    free(s->y);
    free(s->vertices);
    free(s->triangles);
}

/* z = height + slope . (x - 1/2, y - 1/2) + wave */
static void sheet_place(sheet *s, double height, const double slope[2], double wave) {
    uint32_t i, j;
    for (j = 0; j <= s->side; j++)
        for (i = 0; i <= s->side; i++) {
            double *v = s->vertices + 3 * (size_t)(j * (s->side + 1) + i);
            v[0] = s->x[i];
            v[1] = s->y[j];
            v[2] = height + slope[0] * (v[0] - 0.5) + slope[1] * (v[1] - 0.5) + wave * sin(5 * v[0]) * cos(4 * v[1]);
        }
}

/* ---- scenes ---- */

typedef struct scene {
    gx_body *body;
    least_mesh mesh;
    double top; /* z at the top; the body begins at 0, as in x and y */
    meter memory;
    uint32_t random;
    size_t unknowns; /* before cuts */
    double *heights; /* of all sheets so far: sheet_count x their points */
    size_t sheet_count;
    gx_cut_report report; /* of the last cut */
} scene;

/* 0 to 1: Numerical Recipes' linear congruential generator, upper bits */
static double uniform(scene *s) {
    s->random = s->random * 1664525u + 1013904223u;
    return (s->random >> 8) / 16777216.0;
}

/* The mesh stays the caller's until scene_free. held: z from which on the body is held */
static void scene_make(scene *s, const least_mesh *mesh, double top, double held, pool *p) {
    const gx_region region = gx_region_half_space(2, 1, held);
    gx_body_desc desc;
    gx_view view;
    memset(s, 0, sizeof *s);
    memset(&desc, 0, sizeof desc);
    s->mesh = *mesh;
    s->top = top;
    s->random = 1;
    s->memory.pool = p;
    desc.positions = mesh->positions;
    desc.node_count = mesh->node_count;
    desc.elements = mesh->elements;
    desc.element_count = mesh->element_count;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    desc.allocator.allocate = meter_allocate;
    desc.allocator.release = meter_release;
    desc.allocator.reallocate = meter_reallocate;
    desc.allocator.user = &s->memory;
    desc.clock = seconds;
    check(gx_body_create(&desc, &s->body, NULL));
    check(gx_body_hold(s->body, &region, 1, NULL));
    check(gx_body_view(s->body, &view, NULL));
    s->unknowns = 3 * view.copy_count;
}

static void scene_free(scene *s) {
    gx_body_destroy(s->body);
    free(s->heights);
}

/* A block of cells^3 x 5 elements */
static least_mesh block_of(uint32_t cells, block_mesh *block) {
    least_mesh mesh;
    check(block_make_mesh(cells, 0.2, block));
    mesh.positions = block->positions;
    mesh.node_count = block->side * block->side * block->side;
    mesh.elements = block->elements;
    mesh.element_count = 5 * (size_t)cells * cells * cells;
    return mesh;
}

static void scene_make_block(scene *s, uint32_t cells, block_mesh *block, pool *p) {
    const least_mesh mesh = block_of(cells, block);
    scene_make(s, &mesh, 1, 1 - 1e-9, p);
}

/* Cuts by the sheet; microseconds */
static double cut(scene *s, const sheet *by) {
    const size_t points = by->surface.vertex_count;
    gx_cut_desc desc;
    double start;
    size_t i;
    s->heights = (double *)memory_of(s->heights, ++s->sheet_count * points, sizeof(double));
    for (i = 0; i < points; i++) s->heights[(s->sheet_count - 1) * points + i] = by->vertices[3 * i + 2];
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &by->surface;
    desc.surface_count = 1;
    start = seconds(NULL);
    check(gx_body_cut(s->body, &desc, &s->report, NULL));
    return 1e6 * (seconds(NULL) - start);
}

/* Milliseconds of the last of three steps */
static double step(scene *s) {
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
typedef struct corner {
    uint32_t point, copies[4];
} corner;

static int corner_order(const void *a, const void *b) { return memcmp(a, b, sizeof(corner)); }

/* Corners of the cut faces that are not nodes, once for each part that they are on */
static size_t cut_corners(const gx_skin *skin) {
    corner *corners = (corner *)calloc(3 * skin->triangle_count + 1, sizeof *corners);
    size_t t, i, n = 0, distinct = 0;
    check(corners ? GX_OK : GX_ERROR_MEMORY);
    for (t = 0; t < 3 * skin->triangle_count; t++) {
        const uint32_t v = skin->triangles[t];
        if (skin->triangle_surface[t / 3] == GX_SKIN_OUTER || skin->vertex_weights[4 * (size_t)v + 1] == 0) continue;
        corners[n].point = skin->vertex_point[v];
        for (i = 0; i < 4; i++)
            corners[n].copies[i] =
                skin->vertex_weights[4 * (size_t)v + i] != 0 ? skin->vertex_copies[4 * (size_t)v + i] : 0;
        n++;
    }
    qsort(corners, n, sizeof *corners, corner_order);
    for (i = 0; i < n; i++) distinct += i == 0 || corner_order(&corners[i], &corners[i - 1]) != 0;
    free(corners);
    return distinct;
}

/* ---- rows ---- */

typedef struct line {
    const char *sweep, *kind;
    size_t elements, cuts, triangles;
    /* us: of a cut; first, arrangement: of a touched element */
    double touched, created, us, first, arrangement, step_ms, megabytes;
    size_t unknowns_before, unknowns, least, vna, remeshed;
} line;

static line lines[MOST_ROWS];
static size_t line_count, line_total;

static void count_unknowns(scene *s, const sheet *by, line *l) {
    least_sheets sheets;
    least_result counted;
    gx_view view;
    gx_skin skin;
    check(gx_body_view(s->body, &view, NULL));
    check(gx_body_skin(s->body, NULL, &skin, NULL));
    sheets.x = by->x;
    sheets.y = by->y;
    sheets.z = s->heights;
    sheets.side = by->side;
    sheets.count = s->sheet_count;
    counted = least_of(&s->mesh, &sheets);
    l->unknowns_before = s->unknowns;
    l->unknowns = 3 * view.copy_count;
    l->least = 3 * counted.least;
    l->vna = 3 * counted.replicas;
    l->remeshed = 3 * (view.node_count + cut_corners(&skin));
}

/* One row, for a scene after its cuts. us: of a cut, of which `arrangement` is a part */
static void row(scene *s, const char *sweep, const char *kind, size_t cuts, const sheet *by, double first, double us,
                double arrangement) {
    const double touched = (double)s->report.touched_elements, peak = (double)s->memory.peak;
    line *l = &lines[line_count++];
    l->sweep = sweep;
    l->kind = kind;
    l->elements = s->mesh.element_count;
    l->cuts = cuts;
    l->triangles = by->surface.triangle_count;
    l->touched = touched;
    l->created = (double)s->report.created_cells;
    l->us = us;
    l->first = first / touched;
    l->arrangement = arrangement / touched;
    l->megabytes = peak / 1e6;
    l->step_ms = step(s);
    count_unknowns(s, by, l);
    csv_row("%s,%s,%lu,%lu,%lu,%.0f,%.0f,%.0f,%.2f,%.2f,%.2f,%.1f,%lu,%lu,%lu,%lu,%lu,%.1f", sweep, kind,
            (unsigned long)l->elements, (unsigned long)cuts, (unsigned long)l->triangles, touched, l->created, us,
            l->first, us / touched, l->arrangement, l->step_ms, (unsigned long)l->unknowns_before,
            (unsigned long)l->unknowns, (unsigned long)l->least, (unsigned long)l->vna, (unsigned long)l->remeshed,
            l->megabytes);
    progress_draw("scaling", line_count, line_total, sweep);
}

/* ---- the table ---- */

static double swept(const line *l) {
    return (double)(strcmp(l->sweep, "elements") == 0 ? l->elements
                    : strcmp(l->sweep, "cuts") == 0   ? l->cuts
                                                      : l->triangles);
}

/* Exponent of the cost of a touched element, or of memory, as a power of the swept quantity: over the rows from
   `from` to `to` in the upper half of its decades */
static double exponent(size_t from, size_t to, double (*cost)(const line *l)) {
    const double middle = 0.5 * (log(swept(&lines[from])) + log(swept(&lines[to - 1])));
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    size_t i;
    for (i = from; i < to; i++) {
        const double a = log(swept(&lines[i])), b = log(cost(&lines[i]));
        if (a < middle) continue;
        n++;
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
    }
    return n > 1 ? (n * xy - x * y) / (n * xx - x * x) : 0;
}

static double cost_of_cut(const line *l) { return l->us / l->touched; }
static double cost_of_touched(const line *l) { return l->us / (l->created + (double)l->triangles); }
static double cost_of_unknown(const line *l) { return l->step_ms / (double)l->unknowns; }

/* Returns how many rows have more or fewer unknowns than the least. */
static int print_table(void) {
    size_t i, from = 0;
    int wrong = 0;
    fprintf(stderr, "%-9s %-11s %9s %5s %9s %11s %10s %9s %9s %9s %9s %8s\n", "sweep", "kind", "elements", "cuts",
            "triangles", "us/touched", "step, ms", "unknowns", "least", "VNA", "remeshed", "MB");
    for (i = 0; i < line_count; i++) {
        const line *l = &lines[i];
        const int off = l->unknowns != l->least;
        fprintf(stderr, "%-9s %-11s %9lu %5lu %9lu %11.1f %10.1f %9lu %9lu %9lu %9lu %8.1f%s\n", l->sweep, l->kind,
                (unsigned long)l->elements, (unsigned long)l->cuts, (unsigned long)l->triangles, cost_of_cut(l),
                l->step_ms, (unsigned long)l->unknowns, (unsigned long)l->least, (unsigned long)l->vna,
                (unsigned long)l->remeshed, l->megabytes, off ? "  NOT THE LEAST" : "");
        wrong += off;
        if (i + 1 < line_count && strcmp(l->sweep, l[1].sweep) == 0 && strcmp(l->kind, l[1].kind) == 0) continue;
        if (i - from > 2)
            fprintf(stderr,
                    "%s, %s: a cut, by cells made and triangles, costs as %s^%.2f, by touched elements as %s^%.2f, an "
                    "unknown's step as %s^%.2f\n",
                    l->sweep, l->kind, l->sweep, exponent(from, i + 1, cost_of_touched), l->sweep,
                    exponent(from, i + 1, cost_of_cut), l->sweep, exponent(from, i + 1, cost_of_unknown));
        from = i + 1;
    }
    return wrong;
}

/* ---- sweeps ---- */

/* Cuts across z at that share of the height. Returns microseconds for each touched element; *arrangement: the part
   of these */
static double cut_at(scene *s, sheet *by, double height, double wave, double *arrangement) {
    const double slope[2] = {0.05, 0.03};
    double us;
    sheet_place(by, height * s->top, slope, wave);
    us = cut(s, by) / (double)s->report.touched_elements;
    *arrangement = 1e6 * s->report.seconds_arrangement / (double)s->report.touched_elements;
    return us;
}

/* The first cut of the scene, and later ones. The cost of a touched element does not depend on how many each of them
   touches. */
static void cut_across(scene *s, const char *sweep, const char *kind, double wave, uint32_t side) {
    double us[LATER_CUTS], arrangement[LATER_CUTS], first, touched;
    sheet by = sheet_make(side);
    int i;
    first = cut_at(s, &by, 0.5171, wave, &arrangement[0]);
    for (i = 0; i < LATER_CUTS; i++) us[i] = cut_at(s, &by, 0.22 + 0.0911 * i, wave, &arrangement[i]);
    touched = (double)s->report.touched_elements;
    row(s, sweep, kind, 1 + LATER_CUTS, &by, first * touched, median(us, LATER_CUTS) * touched,
        median(arrangement, LATER_CUTS) * touched);
    sheet_free(&by);
}

static void against_elements(uint32_t cells, double wave, uint32_t side, pool *p) {
    block_mesh block;
    scene s;
    scene_make_block(&s, cells, &block, p);
    cut_across(&s, "elements", p ? "curved-pool" : wave > 0 ? "curved" : "plane", wave, side);
    scene_free(&s);
    block_free_mesh(&block);
}

/* The mesh from 0 on, its longest side 1 m, its axes exchanged in turn so that the given one is z. Returns its
   height. */
static double turn_mesh(gxio_mesh *mesh, int axis) {
    double low[3], high[3], size = 0;
    size_t i;
    int k;
    gxio_mesh_bounds(mesh, low, high);
    for (k = 0; k < 3; k++) size = high[k] - low[k] > size ? high[k] - low[k] : size;
    for (i = 0; i < mesh->node_count; i++) {
        double at[3];
        for (k = 0; k < 3; k++)
            at[k] = (mesh->positions[3 * i + (size_t)((axis + 1 + k) % 3)] - low[(axis + 1 + k) % 3]) / size;
        memcpy(mesh->positions + 3 * i, at, sizeof at);
    }
    return (high[axis] - low[axis]) / size;
}

static void through_mesh(const char *path, int axis, double wave, uint32_t side) {
    static const char *const kinds[2][3] = {{"plane-x", "plane-y", "plane-z"}, {"curved-x", "curved-y", "curved-z"}};
    least_mesh mesh;
    gxio_mesh file;
    gxio_error error;
    scene s;
    double top;
    if (!gxio_mesh_load(path, &file, &error)) {
        fprintf(stderr, "scaling: %s\n", error.text);
        exit(1);
    }
    top = turn_mesh(&file, axis);
    mesh.positions = file.positions;
    mesh.node_count = file.node_count;
    mesh.elements = file.elements;
    mesh.element_count = file.element_count;
    scene_make(&s, &mesh, top, 0.95 * top, NULL);
    cut_across(&s, "mesh", kinds[wave > 0][axis], wave, side);
    scene_free(&s);
    gxio_mesh_release(&file);
}

static void next_plane(scene *s, sheet *by, int crossing) {
    const double u = uniform(s), v = uniform(s), w = uniform(s),
                 slope[2] = {crossing ? 2 * v - 1 : 0, crossing ? 2 * w - 1 : 0};
    sheet_place(by, crossing ? 0.4 + 0.2 * u : 0.01 + 0.98 * u, slope, 0);
}

static void against_cuts(uint32_t cells, size_t count, int crossing) {
    static double us[MOST_CUTS], arrangement[MOST_CUTS];
    size_t touched = 0, created = 0, i;
    const size_t from = count / 2;
    sheet by = sheet_make(1);
    block_mesh block;
    scene s;
    scene_make_block(&s, cells, &block, NULL);
    for (i = 0; i < count; i++) {
        next_plane(&s, &by, crossing);
        us[i] = cut(&s, &by);
        arrangement[i] = 1e6 * s.report.seconds_arrangement;
        touched += i < from ? 0 : s.report.touched_elements;
        created += i < from ? 0 : s.report.created_cells;
    }
    s.report.touched_elements = touched / (count - from);
    s.report.created_cells = created / (count - from);
    row(&s, "cuts", crossing ? "crossing" : "parallel", count, &by, us[0], median(us + from, count - from),
        median(arrangement + from, count - from));
    scene_free(&s);
    block_free_mesh(&block);
    sheet_free(&by);
}

static void against_triangles(uint32_t cells, uint32_t side) {
    const double slope[2] = {0.05, 0.03};
    sheet by = sheet_make(side);
    block_mesh block;
    scene s;
    double us;
    scene_make_block(&s, cells, &block, NULL);
    sheet_place(&by, 0.5171, slope, 0.05);
    us = cut(&s, &by);
    row(&s, "triangles", "curved", 1, &by, us, us, 1e6 * s.report.seconds_arrangement);
    scene_free(&s);
    block_free_mesh(&block);
    sheet_free(&by);
}

int main(int argc, char **argv) {
    static const uint32_t cells[] = {6, 9, 13, 18, 27, 38, 59}, sides[] = {1, 3, 7, 22, 70, 224};
    static const size_t cuts[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
    const char *mesh = argc > 2 && argv[argc - 1][0] != '-' ? argv[argc - 1] : NULL;
    int small;
    const char *path = csv_arguments(argc - (mesh != NULL), argv, &small);
    const int blocks = small ? 2 : 7, parallel = small ? 4 : 10, crossing = small ? 4 : 7, curved = small ? 3 : 6;
    const uint32_t block = small ? 6 : 20;
    int i, wrong;
    csv_open(argv[0], path,
             "sweep,kind,elements,cuts,triangles,touched,created,cut_us,first_us_per_touched,us_per_touched,"
             "arrangement_us_per_touched,step_ms,unknowns_before,unknowns,least,vna,remeshed,peak_mb");
    line_total = (size_t)(3 * blocks + parallel + crossing + curved + (mesh ? 12 : 0));
    for (i = 0; i < blocks; i++) against_elements(cells[i], 0, 1, NULL);
    for (i = 0; i < blocks; i++) against_elements(cells[i], 0.05, cells[i], NULL);
    for (i = 0; i < blocks; i++) {
        pool p; /* more than cuts take; steps may fall back on malloc */
        if (!pool_make(&p, (size_t)64 * LARGE_PAGE + (size_t)12500 * cells[i] * cells[i] * cells[i]))
            check(GX_ERROR_MEMORY);
        against_elements(cells[i], 0.05, cells[i], &p);
        free(p.memory);
    }
    for (i = 0; i < parallel; i++) against_cuts(block, cuts[i], 0);
    for (i = 0; i < crossing; i++) against_cuts(block, cuts[i], 1);
    for (i = 0; i < curved; i++) against_triangles(block, sides[i]);
    for (i = 0; mesh && i < 3; i++) through_mesh(mesh, i, 0, 1);
    for (i = 0; mesh && i < 9; i++) through_mesh(mesh, i / 3, 0.05, 8u << i % 3);
    wrong = print_table();
    return csv_close() | (wrong > 0);
}
