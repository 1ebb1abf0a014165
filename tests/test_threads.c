/* test_threads.c - Booleans on the host's threads give the bits that they give without: results, components, defects
   and failures, by any number of threads and in any order of tasks. Parts are small here, so that small operands have
   many. Operands are those of the fuzzer, and larger ones: smooth, crowded, aligned. Memory runs out at each
   allocation. */
#define GXBP_PART 32u
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"
#include "fuzz_cases.h"
#include "operand.h"
#include "runner.h"
#include "workloads.h"

#include "pool.h"
#include "scarce.h"

#include <math.h>

enum { CASES = 600 };

static int same_bits(const void *a, const void *b, size_t size) { return size == 0 || memcmp(a, b, size) == 0; }

static gxb_operand operand_of(const wl_surface *s, uint32_t operation) {
    return operand_from(s->vertices, s->vertex_count, s->triangles, s->triangle_count, operation);
}

/* ---- the same bits ---- */

static void check_failures(gx_result a, const gx_failure *f, gx_result b, const gx_failure *g) {
    ck_assert_int_eq(a, b);
    ck_assert_uint_eq(f->index, g->index);
    ck_assert((f->field == NULL) == (g->field == NULL));
    if (f->field != NULL) ck_assert_str_eq(f->field, g->field);
}

static void check_results(const gxb_boolean_result *r, const gxb_boolean_result *s) {
    ck_assert_uint_eq(r->vertex_count, s->vertex_count);
    ck_assert_uint_eq(r->triangle_count, s->triangle_count);
    ck_assert(same_bits(r->vertices, s->vertices, 3 * r->vertex_count * sizeof *r->vertices));
    ck_assert(same_bits(r->vertex_origin, s->vertex_origin, r->vertex_count * sizeof *r->vertex_origin));
    ck_assert(same_bits(r->triangles, s->triangles, 3 * r->triangle_count * sizeof *r->triangles));
    ck_assert(same_bits(r->triangle_operand, s->triangle_operand, r->triangle_count * sizeof *r->triangle_operand));
    ck_assert(same_bits(r->triangle_source, s->triangle_source, r->triangle_count * sizeof *r->triangle_source));
    ck_assert(same_bits(r->triangle_reversed, s->triangle_reversed, r->triangle_count));
}

static void check_more(gxb_boolean *a, gxb_boolean *b, size_t triangles, size_t operands) {
    gxb_components c, d;
    gxb_defects e, f;
    ck_assert_int_eq(gxb_boolean_components(a, &c, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_components(b, &d, NULL), GX_OK);
    ck_assert_uint_eq(c.count, d.count);
    ck_assert(same_bits(c.volume, d.volume, c.count * sizeof *c.volume));
    ck_assert(same_bits(c.euler, d.euler, c.count * sizeof *c.euler));
    ck_assert(same_bits(c.side, d.side, c.count * operands * sizeof *c.side));
    ck_assert(same_bits(c.triangle, d.triangle, triangles * sizeof *c.triangle));
    ck_assert_int_eq(gxb_boolean_defects(a, &e, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_defects(b, &f, NULL), GX_OK);
    ck_assert_uint_eq(e.count, f.count);
    ck_assert_uint_eq(e.mended_count, f.mended_count);
    ck_assert(same_bits(e.triangles, f.triangles, e.count * sizeof *e.triangles));
}

/* Evaluates both. Returns whether there is a result. */
static int check_evaluations(gxb_boolean *a, gxb_boolean *b, size_t operands) {
    gxb_boolean_result r, s;
    gx_failure f, g;
    const gx_result result = gxb_boolean_evaluate(a, &r, &f);
    check_failures(result, &f, gxb_boolean_evaluate(b, &s, &g), &g);
    if (result != GX_OK) return 0;
    check_results(&r, &s);
    check_more(a, b, r.triangle_count, operands);
    return 1;
}

typedef struct options {
    int fine, mend, retained, each; /* each: evaluated after each operand */
    uint32_t triangulation;
} options;

static gxb_boolean *start(const options *o, gx_jobs jobs, const gx_allocator *allocator) {
    gxb_boolean_desc desc;
    gxb_boolean *b = NULL;
    memset(&desc, 0, sizeof desc);
    desc.jobs = jobs;
    if (allocator != NULL) desc.allocator = *allocator;
    ck_assert_int_eq(gxb_boolean_create(&desc, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_fine(b, o->fine, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_mend(b, o->mend, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_retained(b, o->retained, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_triangulation(b, o->triangulation, NULL), GX_OK);
    return b;
}

/* A Boolean without threads and one with them, of the same operands */
static void check_operands(const gxb_operand *operands, size_t count, const options *o, gx_jobs jobs) {
    const gx_jobs none = {NULL, NULL};
    gxb_boolean *a = start(o, none, NULL), *b = start(o, jobs, NULL);
    gx_failure f, g;
    size_t i, added = 0;
    for (i = 0; i < count; i++) {
        const gx_result result = gxb_boolean_add(a, &operands[i], &f);
        check_failures(result, &f, gxb_boolean_add(b, &operands[i], &g), &g);
        added += result == GX_OK;
        if (added > 0 && (o->each || i + 1 == count)) (void)check_evaluations(a, b, added);
    }
    gxb_boolean_destroy(a);
    gxb_boolean_destroy(b);
}

/* ---- the fuzzer's operands ---- */

static void check_case(uint64_t seed, gx_jobs jobs) {
    static test_case c;
    gxb_operand operands[CASE_OPERANDS + CASE_SHEETS];
    uint8_t bytes[CASE_BYTES];
    options o;
    size_t i;
    case_fill(seed, bytes, sizeof bytes);
    bytes[0] = (uint8_t)(7 << 5 | (bytes[0] & 8)); /* Booleans */
    case_decode(bytes, sizeof bytes, &c);
    memset(&o, 0, sizeof o);
    o.fine = (int)(seed % 2);
    o.mend = seed % 7 == 0;
    o.each = seed % 3 == 0;
    o.retained = seed % 6 == 0;
    o.triangulation = seed % 5 == 0 ? GXB_COARSE : seed % 11 == 0 ? GXB_MERGED : GXB_DIVIDED;
    memset(operands, 0, sizeof operands);
    for (i = 0; i < c.operands; i++) {
        operands[i].vertices = &c.operand[i].mesh.x[0][0];
        operands[i].vertex_count = c.operand[i].mesh.vertices;
        operands[i].triangles = &c.operand[i].mesh.t[0][0];
        operands[i].triangle_count = c.operand[i].mesh.triangles;
        operands[i].operation = c.operand[i].operation;
        operands[i].rule = c.operand[i].rule;
    }
    check_operands(operands, c.operands, &o, jobs);
}

START_TEST(tasks_in_any_order) {
    uint64_t state = 77 + (uint64_t)_i;
    gx_jobs jobs;
    int i;
    jobs.parallel_for = shuffled_for;
    jobs.user = &state;
    for (i = 0; i < CASES / 10 / FEWER; i++) check_case((uint64_t)(CASES / 10 * _i + i), jobs);
}
END_TEST

START_TEST(tasks_on_threads) {
    static pool p;
    gx_jobs jobs;
    int i;
    pool_open(&p, 3);
    jobs.parallel_for = pool_for;
    jobs.user = &p;
    for (i = 0; i < CASES / 10 / FEWER; i++) check_case((uint64_t)(CASES + i), jobs);
    pool_close(&p);
}
END_TEST

/* ---- larger operands ---- */

enum { BALLS, TORI, RODS, GRIDS, SHEET, REPEATED, FOLDED, FAR_AWAY, SCENES };

/* A ball of 6 n x n squares. Vertices on the seams of the six stand there twice. */
static void add_ball(wl_surface *s, uint32_t n, double x, double y, double z) {
    uint32_t face, i, j;
    for (face = 0; face < 6; face++) {
        const uint32_t first = (uint32_t)s->vertex_count;
        for (i = 0; i <= n; i++)
            for (j = 0; j <= n; j++) {
                const double u = 2.0 * i / n - 1, v = 2.0 * j / n - 1, r = sqrt(1 + u * u + v * v);
                double p[3];
                p[face % 3] = (face < 3 ? 1 : -1) / r;
                p[(face + 1) % 3] = (face < 3 ? u : v) / r;
                p[(face + 2) % 3] = (face < 3 ? v : u) / r;
                p[0] += x;
                p[1] += y;
                p[2] += z;
                wl_add_vertex(s, p);
            }
        for (i = 0; i < n; i++)
            for (j = 0; j < n; j++) {
                const uint32_t a = first + i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
                wl_add_triangle(s, a, c, d);
                wl_add_triangle(s, a, d, b);
            }
    }
}

/* A torus of n x m quadrilaterals, turned about x. Nothing sees all of it from one side. radius above 1: it crosses
 * itself. */
static void add_torus(wl_surface *s, uint32_t n, uint32_t m, double radius, double turn) {
    uint32_t i, j;
    for (i = 0; i < n; i++)
        for (j = 0; j < m; j++) {
            const double u = 6.283185307179586 * i / n, v = 6.283185307179586 * j / m;
            const double r = radius * (1 + 0.1 * sin(3 * u + turn) * cos(5 * v));
            const double across = (1 + r * cos(v)) * sin(u), up = r * sin(v);
            double x[3];
            x[0] = (1 + r * cos(v)) * cos(u);
            x[1] = across * cos(turn) - up * sin(turn);
            x[2] = across * sin(turn) + up * cos(turn);
            wl_add_vertex(s, x);
        }
    for (i = 0; i < n; i++)
        for (j = 0; j < m; j++) {
            const uint32_t a = i * m + j, b = i * m + (j + 1) % m, c = (i + 1) % n * m + j,
                           d = (i + 1) % n * m + (j + 1) % m;
            wl_add_triangle(s, a, c, d);
            wl_add_triangle(s, a, d, b);
        }
}

/* Boxes of edges size along each axis, at the points of a lattice */
static void add_boxes(wl_surface *s, const uint32_t count[3], const double step[3], const double size[3],
                      double shift) {
    uint32_t i, j, k;
    for (i = 0; i < count[0]; i++)
        for (j = 0; j < count[1]; j++)
            for (k = 0; k < count[2]; k++) {
                double low[3], high[3];
                uint32_t c;
                low[0] = step[0] * i + shift;
                low[1] = step[1] * j;
                low[2] = step[2] * k;
                for (c = 0; c < 3; c++) high[c] = low[c] + size[c];
                wl_add_aligned_box(s, low, high);
            }
}

static void scale_surface(wl_surface *s, double scale) {
    size_t i;
    for (i = 0; i < 3 * s->vertex_count; i++) s->vertices[i] *= scale;
}

static void add_rods(workload *w) {
    const uint32_t four[3] = {4, 1, 1}, many[3] = {1, 14, 14};
    const double cubes[3] = {30, 1, 1}, cube[3] = {10, 10, 10}, rods[3] = {1, 0.7, 0.7}, rod[3] = {12, 0.3, 0.3};
    add_boxes(wl_add_surface(w, 1), four, cubes, cube, 0);
    add_boxes(wl_add_surface(w, 1), many, rods, rod, -1.1);
}

static void add_grids(workload *w) {
    const uint32_t count[3] = {3, 3, 3};
    const double step[3] = {0.5, 0.5, 0.5}, size[3] = {0.5, 0.75, 0.25};
    add_boxes(wl_add_surface(w, 1), count, step, size, 0);
    add_boxes(wl_add_surface(w, 1), count, step, size, 0.25);
}

static workload make_scene(int scene) {
    workload w = wl_empty();
    uint32_t i;
    switch (scene) {
    case BALLS:
    case FAR_AWAY:
        for (i = 0; i < 3; i++) add_ball(wl_add_surface(&w, 1), 12, 0.5 * i, 0.3 * i, -0.2 * i);
        for (i = 0; i < 3 && scene == FAR_AWAY; i++) scale_surface(&w.surfaces[i], 1e-30);
        break;
    case REPEATED:
        for (i = 0; i < 3; i++) add_ball(wl_add_surface(&w, 1), 8, 0, i == 2, 0);
        break;
    case TORI:
        for (i = 0; i < 2; i++) add_torus(wl_add_surface(&w, 1), 80, 60, 0.4, 0.8 * i);
        break;
    case FOLDED:
        for (i = 0; i < 2; i++) add_torus(wl_add_surface(&w, 1), 20, 14, 1.4, 0.8 * i);
        break;
    case RODS: add_rods(&w); break;
    case GRIDS: add_grids(&w); break;
    default:
        w = wl_wavy(0);
        add_ball(wl_add_surface(&w, 1), 10, 0.3, 0.3, 0.3);
        break;
    }
    return w;
}

/* The sheet is the first surface of its scene, and the second operand. */
static size_t list_operands(const workload *w, int scene, uint32_t simple, gxb_operand *operands) {
    size_t i;
    for (i = 0; i < w->surface_count; i++) {
        operands[i] = operand_of(&w->surfaces[scene == SHEET ? w->surface_count - 1 - i : i], GXB_DIFFERENCE);
        operands[i].simple = simple && (scene == BALLS || scene == TORI);
    }
    if (scene == SHEET) operands[1].operation = GXB_SPLIT;
    return w->surface_count;
}

START_TEST(scenes_on_threads) {
    const size_t workers[4] = {1, 2, 3, 8};
    static pool p;
    workload w = make_scene(_i);
    gxb_operand operands[WL_SURFACES];
    options o;
    gx_jobs jobs;
    uint64_t state = (uint64_t)_i;
    size_t count, k;
    memset(&o, 0, sizeof o);
    for (k = 0; k < 4; k++) {
        count = list_operands(&w, _i, k % 2 == 0, operands);
        ck_assert_uint_ge(count, 2);
        jobs.parallel_for = shuffled_for;
        jobs.user = &state;
        o.each = k == 1;
        o.retained = k == 3;
        o.fine = k == 2;
        check_operands(operands, count, &o, jobs);
        pool_open(&p, workers[k]);
        jobs.parallel_for = pool_for;
        jobs.user = &p;
        check_operands(operands, count, &o, jobs);
        ck_assert_uint_gt(p.calls, 0);
        pool_close(&p);
    }
    wl_free(&w);
}
END_TEST

/* Signs are counted alike by any number of threads. */
START_TEST(statistics_do_not_depend_on_threads) {
    static pool p;
    workload w = make_scene(TORI);
    gxb_operand operands[WL_SURFACES];
    gxb_statistics first, s;
    const options o = {0, 0, 0, 0, GXB_DIVIDED};
    size_t workers, i;
    memset(&first, 0, sizeof first);
    for (workers = 1; workers <= 4; workers++) {
        gx_jobs jobs;
        gxb_boolean *b;
        gxb_boolean_result r;
        pool_open(&p, workers);
        jobs.parallel_for = pool_for;
        jobs.user = &p;
        b = start(&o, jobs, NULL);
        for (i = 0; i < list_operands(&w, TORI, 0, operands); i++)
            ck_assert_int_eq(gxb_boolean_add(b, &operands[i], NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_statistics(b, &s, NULL), GX_OK);
        if (workers == 1) first = s;
        ck_assert(same_bits(&s, &first, sizeof s));
        gxb_boolean_destroy(b);
        pool_close(&p);
    }
    wl_free(&w);
}
END_TEST

/* Vertices and triangles that are refused, found by tasks: the first vertex, whatever else is wrong */
START_TEST(bad_operands_are_refused_alike) {
    workload w = make_scene(BALLS);
    const options o = {0, 0, 0, 0, GXB_DIVIDED};
    uint64_t state = 5;
    gx_jobs jobs;
    gxb_operand operands[2];
    size_t i, k;
    jobs.parallel_for = shuffled_for;
    jobs.user = &state;
    for (i = 0; i < 40; i++) {
        double kept[2];
        uint32_t corner;
        wl_surface *s = &w.surfaces[1];
        for (k = 0; k < 2; k++) operands[k] = operand_of(&w.surfaces[k], GXB_UNION);
        kept[0] = s->vertices[7 * i];
        kept[1] = s->vertices[11 * i + 900];
        corner = s->triangles[13 * i];
        if (i % 4 == 1) s->vertices[7 * i] = (double)INFINITY;
        if (i % 4 == 1) s->vertices[11 * i + 900] = (double)NAN;
        if (i % 4 == 2) s->vertices[11 * i + 900] = 1e80;
        if (i % 4 == 3) s->triangles[13 * i] = s->triangles[13 * i + 3];
        if (i % 8 == 5) operands[1].operation = GXB_SPLIT;
        check_operands(operands, 2, &o, jobs);
        s->vertices[11 * i + 900] = kept[1];
        s->vertices[7 * i] = kept[0];
        s->triangles[13 * i] = corner;
    }
    wl_free(&w);
}
END_TEST

/* Memory runs out at each allocation. The Boolean keeps its operands, and can be evaluated again. */
START_TEST(memory_runs_out_beside_threads) {
    const gx_jobs none = {NULL, NULL};
    workload w = make_scene(TORI);
    const options o = {0, 0, 0, 0, GXB_DIVIDED};
    uint64_t state = 9;
    gx_jobs jobs;
    gxb_operand operands[WL_SURFACES];
    gxb_boolean *a = start(&o, none, NULL);
    gxb_boolean_result r, s;
    const size_t count = list_operands(&w, TORI, 0, operands);
    size_t i, n, failed = 0;
    int enough;
    jobs.parallel_for = shuffled_for;
    jobs.user = &state;
    for (i = 0; i < count; i++) ck_assert_int_eq(gxb_boolean_add(a, &operands[i], NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_evaluate(a, &r, NULL), GX_OK);
    for (n = 0;; n++) {
        memory m = plenty();
        const gx_allocator allocator = allocator_of(&m);
        gxb_boolean *b = start(&o, jobs, &allocator);
        gx_result result = GX_OK;
        fail_from(&m, n, (int)(n % 2));
        for (i = 0; i < count; i++) {
            while ((result = gxb_boolean_add(b, &operands[i], NULL)) == GX_ERROR_MEMORY) never_fail(&m), failed++;
            ck_assert_int_eq(result, GX_OK);
        }
        while ((result = gxb_boolean_evaluate(b, &s, NULL)) == GX_ERROR_MEMORY) never_fail(&m), failed++;
        ck_assert_int_eq(result, GX_OK);
        enough = !m.failed && m.fail_at != SIZE_MAX;
        never_fail(&m);
        if (enough) {
            check_results(&r, &s);
            check_more(a, b, r.triangle_count, count);
            gxb_boolean_destroy(b);
            break;
        }
        ck_assert_uint_eq(r.triangle_count, s.triangle_count);
        gxb_boolean_destroy(b);
        ck_assert(m.blocks == NULL && !m.wrong && !m.overrun);
    }
    ck_assert_uint_gt(failed, 10);
    gxb_boolean_destroy(a);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("threads");
    TCase *tests = tcase_create("cases"), *scenes = tcase_create("scenes");
    tcase_set_timeout(tests, 300);
    tcase_set_timeout(scenes, 300);
    tcase_add_loop_test(tests, tasks_in_any_order, 0, 10);
    tcase_add_test(tests, tasks_on_threads);
    tcase_add_test(tests, bad_operands_are_refused_alike);
    tcase_add_test(tests, memory_runs_out_beside_threads);
    tcase_add_loop_test(scenes, scenes_on_threads, 0, SCENES);
    tcase_add_test(scenes, statistics_do_not_depend_on_threads);
    suite_add_tcase(suite, tests);
    suite_add_tcase(suite, scenes);
    return run_suite(suite);
}
