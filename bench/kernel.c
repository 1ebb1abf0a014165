/* kernel.c - Booleans of closed surfaces: A minus B0 (minus B1 ...), doubles in to doubles out.

   make bench-kernel builds and runs it on generated workloads. make bench-kernel DATA=FOLDER adds the files of a
   folder: NAME_A.off, NAME_B0.off, NAME_B1.off ... (as in "W1_A.off"). It prints CSV and writes it to
   build/bench/kernel.csv, and a table to stderr.

       W1  a tetrahedron less a slab
       W3  a tetrahedron less a wavy slab of 1760 triangles
       W4  a cube less 5 + 5 crossing slabs
       S   a bumpy sphere of 8,000 triangles less a turned copy
       E   1000 turned cubes, united: one is taken out and one added elsewhere, the result retained; E anew: the cubes
           that are left, made from nothing
       chain_N  N of these cubes, united one by one, the result retained and read after each: the whole chain, in time
           of the processor
       +   after a name: evaluated after each operand
       ?   surfaces are not vouched for as simple; all others are
       2   on two threads; the rows of few triangles have none

   filter_share: the share of signs that the filter or the definitions decided. exact_share: the share that took
   exact arithmetic. Each call creates, adds, evaluates, gets the components, and destroys. surface_us: the median
   without components. SECONDS per workload and way, at least three calls.

   Memory that a call releases stays with the process, as for a program that calls often. Otherwise the C library
   returns it to the system or not, depending on earlier calls, and new pages from the system add a third to large
   workloads. */
#define _POSIX_C_SOURCE 200809L
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"
#include "../tests/operand.h"
#include "../tests/workloads.h"
#include "clock.h"
#include "csv.h"
#include "helper.h"
#include "progress.h"
#include "splitmix.h"
#include <dirent.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

enum { OPERANDS = 64, CALLS = 100000, NAMES = 512, NAME = 64, GENERATED = 6, MANY = 8192, CUBES = 10, EDITS = 200 };
static const double SECONDS = 0.3;

static size_t done, total; /* workloads */

static void stop_at(const char *what, gx_result result) {
    if (result == GX_OK) return;
    fprintf(stderr, "kernel: %s: error %d\n", what, (int)result);
    exit(1);
}

typedef struct figures {
    size_t triangles, components, peak;
    double volume;
    uint64_t filter, exact, allocations;
} figures;

static gxb_boolean_desc how; /* of Booleans: with a helper or without */

/* Of the latest result; ask: of its components, too */
static figures figures_of(const char *name, gxb_boolean *b, const gxb_boolean_result *r, int ask) {
    gxb_components c;
    gxb_statistics s;
    figures f;
    memset(&c, 0, sizeof c);
    memset(&s, 0, sizeof s);
    if (ask) stop_at(name, gxb_boolean_components(b, &c, NULL));
    stop_at(name, gxb_boolean_statistics(b, &s, NULL));
    f.triangles = r->triangle_count;
    f.components = c.count;
    f.volume = c.total_volume;
    f.filter = s.filter_calls;
    f.exact = s.exact_calls;
    f.allocations = s.allocations;
    f.peak = s.peak_bytes;
    return f;
}

static figures run(const char *name, const gxb_operand *operands, size_t count, int each, int ask) {
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    figures f;
    size_t i;
    memset(&r, 0, sizeof r);
    stop_at(name, gxb_boolean_create(&how, &b, NULL));
    for (i = 0; i < count; i++) {
        stop_at(name, gxb_boolean_add(b, &operands[i], NULL));
        if (i + 1 == count || (each && i > 0)) stop_at(name, gxb_boolean_evaluate(b, &r, NULL));
    }
    f = figures_of(name, b, &r, ask);
    gxb_boolean_destroy(b);
    return f;
}

/* ---- rows ---- */

typedef struct kept_row {
    char name[NAME + 2];
    double us, surface;
    figures f;
} kept_row;

static kept_row *rows;
static size_t row_count;

static void keep_row(const char *name, const char *mark, double us, double surface, const figures *f) {
    rows = (kept_row *)realloc(rows, (row_count + 1) * sizeof *rows);
    stop_at("rows", rows ? GX_OK : GX_ERROR_MEMORY);
    snprintf(rows[row_count].name, sizeof rows[row_count].name, "%s%s", name, mark);
    rows[row_count].us = us;
    rows[row_count].surface = surface;
    rows[row_count++].f = *f;
}

static double exact_share(const figures *f) { return f->filter == 0 ? 0 : (double)f->exact / (double)f->filter; }

static void print_table(void) {
    size_t i;
    fprintf(stderr, "%-24s %11s %12s %9s %10s %14s %11s %11s\n", "workload", "median, us", "surface only", "triangles",
            "components", "volume", "exact signs", "allocations");
    for (i = 0; i < row_count; i++) {
        const kept_row *r = &rows[i];
        fprintf(stderr, "%-24s %11.1f %12.1f %9lu %10lu %14.8g %9.2f %% %11lu\n", r->name, r->us, r->surface,
                (unsigned long)r->f.triangles, (unsigned long)r->f.components, r->f.volume, 100 * exact_share(&r->f),
                (unsigned long)r->f.allocations);
    }
    free(rows);
}

/* The medians of both ways' times, taken in turn, in microseconds; *least: the least of the way that gets components */
static figures time_ways(const char *name, const gxb_operand *operands, size_t count, int each, double middle[2],
                         double *least) {
    static double us[2][CALLS];
    const double start = seconds(NULL);
    figures f[2];
    size_t n;
    int ask;
    for (n = 0; n < CALLS && (n < 3 || seconds(NULL) - start < 2 * SECONDS); n++)
        for (ask = 0; ask < 2; ask++) {
            const double before = seconds(NULL);
            f[ask] = run(name, operands, count, each, ask);
            us[ask][n] = 1e6 * (seconds(NULL) - before);
        }
    for (ask = 0; ask < 2; ask++) middle[ask] = median(us[ask], n); /* Sorts them */
    *least = us[1][0];
    return f[1];
}

/* middle: medians without and with components */
static void write_row(const char *name, const char *mark, const double middle[2], double least, const figures *f) {
    csv_row("%s%s,%.1f,%.1f,%lu,%lu,%.17g,%.4f,%.4f,%lu,%lu,%.1f", name, mark, middle[1], least,
            (unsigned long)f->triangles, (unsigned long)f->components, f->volume, 1 - exact_share(f), exact_share(f),
            (unsigned long)f->allocations, (unsigned long)f->peak, middle[0]);
    keep_row(name, mark, middle[1], middle[0], f);
}

static void measure(const char *name, const char *mark, const gxb_operand *operands, size_t count, int each) {
    double middle[2], least;
    const figures f = time_ways(name, operands, count, each, middle, &least);
    write_row(name, mark, middle, least, &f);
}

static void measure_helped(const char *name, const gxb_operand *operands, size_t count) {
    size_t triangles = 0, i;
    helper h;
    for (i = 0; i < count; i++) triangles += operands[i].triangle_count;
    if (triangles < MANY) return;
    stop_at("threads", helper_start(&h) ? GX_OK : GX_ERROR_MEMORY);
    how.jobs.parallel_for = helper_parallel_for;
    how.jobs.user = &h;
    measure(name, "2", operands, count, 0);
    memset(&how, 0, sizeof how);
    helper_stop(&h);
}

static void measure_all(const char *name, gxb_operand *operands, size_t count) {
    size_t i;
    progress_draw("kernel", done++, total, name);
    for (i = 0; i < count; i++) {
        operands[i].operation = i == 0 ? GXB_UNION : GXB_DIFFERENCE;
        operands[i].simple = 1;
    }
    measure(name, "", operands, count, 0);
    if (count > 2) measure(name, "+", operands, count, 1);
    measure_helped(name, operands, count);
    for (i = 0; i < count; i++) operands[i].simple = 0;
    measure(name, "?", operands, count, 0);
}

static gxb_operand operand_of(const wl_surface *s) {
    return operand_from(s->vertices, s->vertex_count, s->triangles, s->triangle_count, GXB_UNION);
}

/* ---- generated ---- */

static void measure_workload(const char *name, const wl_surface *body, workload w) {
    gxb_operand operands[WL_SURFACES + 1];
    size_t i;
    operands[0] = operand_of(body);
    for (i = 0; i < w.surface_count; i++) operands[i + 1] = operand_of(&w.surfaces[i]);
    measure_all(name, operands, w.surface_count + 1);
    wl_free(&w);
}

/* An octahedron whose faces are divided n x n, blown up to a sphere with bumps, in a rotated frame */
static wl_surface bumpy_sphere(uint32_t n, const wl_frame *frame) {
    wl_surface s;
    uint32_t face, i, j;
    memset(&s, 0, sizeof s);
    for (face = 0; face < 8; face++) {
        const uint32_t first = (uint32_t)s.vertex_count, outward = (face ^ face >> 1 ^ face >> 2) & 1;
        for (j = 0; j <= n; j++)
            for (i = 0; i + j <= n; i++) {
                double x[3], y[3], length;
                int k;
                x[0] = (double)i / n;
                x[1] = (double)j / n;
                x[2] = (double)(n - i - j) / n;
                length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
                for (k = 0; k < 3; k++) x[k] *= (face >> k & 1 ? -1 : 1) / length;
                length = 1 + 0.07 * sin(9 * x[0]) * sin(8 * x[1]) * sin(7 * x[2]);
                for (k = 0; k < 3; k++) x[k] *= length;
                wl_place(frame, x, y);
                wl_add_vertex(&s, y);
            }
        for (j = 0; j < n; j++)
            for (i = 0; i + j < n; i++) {
                const uint32_t row = first + j * (n + 1) - j * (j - 1) / 2, a = row + i, b = a + 1, c = a + n + 1 - j;
                if (outward)
                    wl_add_triangle(&s, a, c, b);
                else
                    wl_add_triangle(&s, a, b, c);
                if (i + j + 1 == n) continue;
                if (outward)
                    wl_add_triangle(&s, b, c, c + 1);
                else
                    wl_add_triangle(&s, b, c + 1, c);
            }
    }
    return s;
}

static void measure_spheres(void) {
    wl_frame axes = wl_axes(), turned = wl_rotated();
    wl_surface s[2];
    gxb_operand operands[2];
    int i;
    memset(turned.origin, 0, sizeof turned.origin);
    s[0] = bumpy_sphere(32, &axes);
    s[1] = bumpy_sphere(32, &turned);
    for (i = 0; i < 2; i++) operands[i] = operand_of(&s[i]);
    measure_all("S", operands, 2);
    for (i = 0; i < 2; i++) {
        free(s[i].vertices);
        free(s[i].triangles);
    }
}

static double uniform(uint64_t *state) { return ldexp((double)(splitmix64(state) >> 11), -53); }

/* A turned unit cube about 0.9 from its neighbours, or (apart 0) anywhere among them */
static wl_surface turned_cube(size_t i, int apart, uint64_t *state) {
    wl_frame frame = wl_rotated();
    wl_surface s;
    int k;
    memset(&s, 0, sizeof s);
    for (k = 0; k < 3; k++, i /= CUBES)
        frame.origin[k] = apart ? 0.9 * (double)(i % CUBES) + 0.05 * uniform(state) : 0.9 * CUBES * uniform(state);
    wl_add_box(&s, &frame, 0.5, 0.5, 0.5);
    return s;
}

static void measure_edits(void) {
    static wl_surface cubes[CUBES * CUBES * CUBES];
    static gxb_operand operands[CUBES * CUBES * CUBES];
    static uint32_t index[CUBES * CUBES * CUBES]; /* of the operand that is there now */
    static double us[EDITS];
    const size_t count = sizeof cubes / sizeof *cubes;
    const char *name = "E";
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    uint64_t state = 1;
    double middle[2];
    figures f;
    size_t i;
    progress_draw("kernel", done++, total, name);
    stop_at(name, gxb_boolean_create(NULL, &b, NULL));
    stop_at(name, gxb_boolean_set_retained(b, 1, NULL));
    for (i = 0; i < count; i++) {
        cubes[i] = turned_cube(i, 1, &state);
        operands[i] = operand_of(&cubes[i]);
        operands[i].simple = 1;
        index[i] = (uint32_t)i;
        stop_at(name, gxb_boolean_add(b, &operands[i], NULL));
    }
    stop_at(name, gxb_boolean_evaluate(b, &r, NULL));
    for (i = 0; i < EDITS; i++) {
        const size_t n = (size_t)(uniform(&state) * (double)count);
        const wl_surface cube = turned_cube(0, 0, &state);
        double before;
        free(cubes[n].vertices);
        free(cubes[n].triangles);
        cubes[n] = cube;
        operands[n].vertices = cube.vertices;
        operands[n].triangles = cube.triangles;
        before = seconds(NULL);
        stop_at(name, gxb_boolean_remove(b, index[n], NULL));
        stop_at(name, gxb_boolean_add(b, &operands[n], NULL));
        stop_at(name, gxb_boolean_evaluate(b, &r, NULL));
        us[i] = 1e6 * (seconds(NULL) - before);
        index[n] = (uint32_t)(count + i);
    }
    f = figures_of(name, b, &r, 1);
    middle[0] = middle[1] = median(us, EDITS);
    write_row(name, "", middle, us[0], &f);
    gxb_boolean_destroy(b);
    measure("E anew", "", operands, count, 0);
    for (i = 0; i < count; i++) {
        free(cubes[i].vertices);
        free(cubes[i].triangles);
    }
}

/* Rows at these lengths of one chain; the second figure is the last step's. */
static void measure_chain(void) {
    static const size_t lengths[] = {10, 30, 100, 300, 1000};
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    uint64_t state = 1;
    double all = 0;
    size_t i, row = 0;
    progress_draw("kernel", done++, total, "chain");
    stop_at("chain", gxb_boolean_create(NULL, &b, NULL));
    stop_at("chain", gxb_boolean_set_retained(b, 1, NULL));
    for (i = 0; row < sizeof lengths / sizeof *lengths; i++) {
        wl_surface cube = turned_cube(i, 1, &state);
        gxb_operand operand = operand_of(&cube);
        double before = processor_seconds(NULL), took[2], step;
        operand.simple = 1;
        stop_at("chain", gxb_boolean_add(b, &operand, NULL));
        stop_at("chain", gxb_boolean_evaluate(b, &r, NULL));
        step = processor_seconds(NULL) - before;
        all += step;
        free(cube.vertices);
        free(cube.triangles);
        if (i + 1 == lengths[row]) {
            const figures f = figures_of("chain", b, &r, 1);
            char name[NAME];
            snprintf(name, sizeof name, "chain_%lu", (unsigned long)lengths[row++]);
            took[0] = took[1] = 1e6 * all;
            write_row(name, "", took, 1e6 * step, &f);
        }
    }
    gxb_boolean_destroy(b);
}

static void measure_generated(void) {
    static const uint32_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    wl_frame axes = wl_axes();
    wl_surface tetrahedron, cube;
    int i;
    memset(&tetrahedron, 0, sizeof tetrahedron);
    memset(&cube, 0, sizeof cube);
    for (i = 0; i < 4; i++) wl_add_vertex(&tetrahedron, wl_unit_tetrahedron[i]);
    for (i = 0; i < 4; i++) wl_add_triangle(&tetrahedron, faces[i][0], faces[i][2], faces[i][1]);
    if (gxb_orient3d(wl_unit_tetrahedron[1], wl_unit_tetrahedron[2], wl_unit_tetrahedron[3], wl_unit_tetrahedron[0]) >
        0)
        for (i = 0; i < 4; i++) memcpy(tetrahedron.triangles + 3 * i, faces[i], sizeof faces[i]);
    wl_add_aligned_box(&cube, low, high);
    measure_workload("W1 generated", &tetrahedron, wl_through(1e-4));
    measure_workload("W3 generated", &tetrahedron, wl_wavy(1));
    measure_workload("W4 generated", &cube, wl_sticks(&axes));
    measure_spheres();
    measure_edits();
    measure_chain();
    free(tetrahedron.vertices);
    free(tetrahedron.triangles);
    free(cube.vertices);
    free(cube.triangles);
}

/* ---- from files ---- */

/* An OFF file's polygons as fans. 0: there is no file of this name. */
static int read_off(const char *path, wl_surface *s) {
    FILE *file = fopen(path, "r");
    unsigned long vertices, faces, edges, i;
    unsigned count, k, n[3];
    double x[3];
    char magic[8];
    memset(s, 0, sizeof *s);
    if (!file) return 0;
    if (fscanf(file, "%7s %lu %lu %lu", magic, &vertices, &faces, &edges) != 4 || strcmp(magic, "OFF") != 0) goto bad;
    for (i = 0; i < vertices; i++) {
        if (fscanf(file, "%lf %lf %lf", &x[0], &x[1], &x[2]) != 3) goto bad;
        wl_add_vertex(s, x);
    }
    for (i = 0; i < faces; i++) {
        if (fscanf(file, "%u %u %u", &count, &n[0], &n[1]) != 3) goto bad;
        for (k = 2; k < count; k++) {
            if (fscanf(file, "%u", &n[2]) != 1) goto bad;
            wl_add_triangle(s, n[0], n[1], n[2]);
            n[1] = n[2];
        }
    }
    fclose(file);
    return 1;
bad:
    fprintf(stderr, "kernel: %s: not an OFF file, or cut short\n", path);
    exit(1);
}

static void measure_files(const char *folder, const char *name) {
    wl_surface s[OPERANDS];
    gxb_operand operands[OPERANDS];
    char path[1024];
    size_t count = 0, i;
    snprintf(path, sizeof path, "%s/%s_A.off", folder, name);
    while (count < OPERANDS && read_off(path, &s[count])) {
        operands[count] = operand_of(&s[count]);
        snprintf(path, sizeof path, "%s/%s_B%lu.off", folder, name, (unsigned long)count++);
    }
    if (count > 1) measure_all(name, operands, count);
    for (i = 0; i < count; i++) {
        free(s[i].vertices);
        free(s[i].triangles);
    }
}

static int by_name(const void *a, const void *b) { return strcmp((const char *)a, (const char *)b); }

/* Names of the workloads in a folder, in order */
static size_t list_folder(const char *folder, char (*names)[NAME]) {
    DIR *directory = opendir(folder);
    const struct dirent *entry;
    size_t count = 0;
    if (!directory) {
        fprintf(stderr, "kernel: %s: no such folder\n", folder);
        exit(1);
    }
    while (count < NAMES && (entry = readdir(directory)) != NULL) {
        const size_t length = strlen(entry->d_name);
        if (length < 7 || length - 6 >= NAME || strcmp(entry->d_name + length - 6, "_A.off") != 0) continue;
        memcpy(names[count], entry->d_name, length - 6);
        names[count++][length - 6] = '\0';
    }
    closedir(directory);
    qsort(names, count, sizeof *names, by_name);
    return count;
}

/* usage: kernel [FILE [FOLDER]] */
int main(int argc, char **argv) {
    static char names[NAMES][NAME];
    const size_t count = argc > 2 ? list_folder(argv[2], names) : 0;
    size_t i;
#if defined(__GLIBC__)
    mallopt(M_MMAP_THRESHOLD, 1 << 25);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
    csv_open(argv[0], argc > 1 ? argv[1] : NULL,
             "workload,median_us,min_us,triangles,components,volume,filter_share,exact_share,allocations,peak_bytes,"
             "surface_us");
    total = GENERATED + count;
    measure_generated();
    for (i = 0; i < count; i++) measure_files(argv[2], names[i]);
    progress_draw("kernel", total, total, "");
    print_table();
    return csv_close();
}
