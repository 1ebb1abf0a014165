/* test_workloads.c - the named workloads (workloads.h) as cuts of a body: fragments, kept volume, removed volume. An
   ignored cut shows, however thin it is. Truth: the exact oracle; for W3, of 1760 triangles, exact cones. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "workloads.h"
#include "skin_check.h"
#include "runner.h"

typedef struct answer {
    size_t fragments;
    double kept;    /* volume of the body after all cuts */
    double removed; /* as the reports say, all cuts together */
    double size;    /* volume of the body before */
    long euler;     /* vertices - edges + triangles of the skin, all fragments together: 2 for each ball */
    long open_edges;
} answer;

static gx_body *build(const workload *w) {
    gx_body_desc desc;
    gx_body *body = NULL;
    memset(&desc, 0, sizeof desc);
    desc.positions = w->positions;
    desc.node_count = w->node_count;
    desc.elements = w->elements;
    desc.element_count = w->element_count;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    return body;
}

static gx_surface surface_of(const wl_surface *s) {
    gx_surface surface;
    memset(&surface, 0, sizeof surface);
    surface.vertices = s->vertices;
    surface.vertex_count = s->vertex_count;
    surface.triangles = s->triangles;
    surface.triangle_count = s->triangle_count;
    surface.kind = s->solid ? GX_SURFACE_SOLID : GX_SURFACE_SHEET;
    return surface;
}

static void look_at_skin(gx_body *body, answer *a) {
    gx_skin skin;
    double *positions;
    skin_counts n;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    positions = (double *)malloc((3 * skin.vertex_count + 1) * sizeof *positions);
    ck_assert_int_eq(gx_body_skin_positions(body, positions, NULL), GX_OK);
    n = skin_count(&skin, UINT32_MAX, positions);
    a->euler = n.vertices - n.edges + n.triangles;
    a->open_edges = n.open_edges;
    free(positions);
}

static answer cut_body(const workload *w, int at_once) {
    gx_surface surfaces[WL_SURFACES];
    gx_body *body = build(w);
    gx_cut_desc desc;
    gx_cut_report report;
    gx_view view;
    answer a = {0, 0, 0, 0, 0, 0};
    size_t i;
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    a.size = view.volume;
    for (i = 0; i < w->surface_count; i++) surfaces[i] = surface_of(&w->surfaces[i]);
    for (i = 0; i < (at_once ? 1 : w->surface_count); i++) {
        memset(&desc, 0, sizeof desc);
        desc.surfaces = surfaces + i;
        desc.surface_count = at_once ? w->surface_count : 1;
        ck_assert_int_eq(gx_body_cut(body, &desc, &report, NULL), GX_OK);
        a.removed += report.removed_volume;
    }
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    a.fragments = view.fragment_count;
    a.kept = view.volume;
    look_at_skin(body, &a);
    gx_body_destroy(body);
    return a;
}

/* Every piece of every workload is a ball. */
static void check_answer(const char *name, const answer *a, size_t fragments, double kept, double removed) {
    ck_assert_msg(a->fragments == fragments, "%s: %zu fragments, should be %zu", name, a->fragments, fragments);
    ck_assert_msg(fabs(a->kept - kept) <= 1e-10 * kept, "%s: kept %.17g, should be %.17g", name, a->kept, kept);
    ck_assert_msg(fabs(a->removed - removed) <= 1e-10 * removed, "%s: removed %.17g, should be %.17g", name, a->removed,
                  removed);
    ck_assert_msg(a->open_edges == 0, "%s: %ld open edges", name, a->open_edges);
    ck_assert_msg(a->euler == 2 * (long)fragments, "%s: Euler characteristic %ld", name, a->euler);
    ck_assert_msg((a->removed > 0) == (removed > 0), "%s: removed %.17g, should be %.17g", name, a->removed, removed);
}

/* At once and in sequence; frees the workload. */
static void check_workload(const char *name, workload w, size_t fragments) {
    oracle *truth = wl_oracle(&w);
    double removed = wl_removed_volume(truth);
    answer once = cut_body(&w, 1), sequence = cut_body(&w, 0);
    ck_assert_msg(truth->fragment_count == fragments, "%s: the oracle has %zu fragments", name, truth->fragment_count);
    check_answer(name, &once, fragments, truth->volume, removed);
    check_answer(name, &sequence, fragments, truth->volume, removed);
    oracle_destroy(truth);
    wl_free(&w);
}

START_TEST(w1_tetrahedron_slab) { check_workload("W1", wl_through(1e-4), 2); }
END_TEST

START_TEST(w2_ring_slab) {
    check_workload("W2", wl_ring_cut(6), 2);
    check_workload("W2f", wl_ring_cut(5), 2);
}
END_TEST

static const double w3_apex[3] = {0.148, 0.298, 0.398}; /* any point; near the sheet, cones are small */

/* A wavy sheet: nothing is lost. */
START_TEST(w3_sheet) {
    workload w = wl_wavy(0);
    answer a = cut_body(&w, 1);
    check_answer("W3 as a sheet", &a, 2, a.size, 0);
    wl_free(&w);
}
END_TEST

START_TEST(w3_solid) {
    workload w = wl_wavy(1);
    double removed = wl_inside_volume(wl_unit_tetrahedron, &w.surfaces[0], w3_apex);
    answer a = cut_body(&w, 1);
    ck_assert_uint_eq(w.surfaces[0].triangle_count, 1760);
    check_answer("W3", &a, 2, a.size - removed, removed);
    wl_free(&w);
}
END_TEST

/* The library's own solid sheet */
START_TEST(w3_solidified_by_the_library) {
    workload w = wl_wavy(0);
    wl_surface *s = &w.surfaces[0];
    gx_surface sheet = surface_of(s);
    double *vertices = (double *)oracle_memory(NULL, 6 * s->vertex_count, sizeof *vertices), removed;
    uint32_t *triangles = (uint32_t *)oracle_memory(NULL, 24 * s->triangle_count, sizeof *triangles);
    answer a;
    ck_assert_int_eq(
        gx_surface_solidify(&sheet, 1e-3, vertices, &s->vertex_count, triangles, &s->triangle_count, NULL, NULL),
        GX_OK);
    ck_assert_uint_eq(s->triangle_count, 1760);
    free(s->vertices);
    free(s->triangles);
    s->vertices = vertices;
    s->triangles = triangles;
    s->solid = 1;
    removed = wl_inside_volume(wl_unit_tetrahedron, s, w3_apex);
    a = cut_body(&w, 1);
    check_answer("W3 by gx_surface_solidify", &a, 2, a.size - removed, removed);
    wl_free(&w);
}
END_TEST

/* 36 sticks; for the aligned cube the volume is (1 - 5 x 1e-3)^2 */
START_TEST(w4_sticks) {
    wl_frame axes = wl_axes();
    workload w = wl_sticks(&axes);
    answer a = cut_body(&w, 0);
    check_answer("W4", &a, 36, 0.995 * 0.995, 1 - 0.995 * 0.995);
    wl_free(&w);
    check_workload("W4", wl_sticks(&axes), 36);
}
END_TEST

START_TEST(w4_sticks_rotated) {
    wl_frame rotated = wl_rotated();
    check_workload("W4r", wl_sticks(&rotated), 36);
}
END_TEST

START_TEST(hard_slabs_and_corners) {
    const char *name;
    size_t pieces;
    workload w = wl_hard(_i, &name, &pieces);
    check_workload(name, w, pieces);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("workloads");
    TCase *tests = tcase_create("workloads");
    int result;
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, w1_tetrahedron_slab);
    tcase_add_test(tests, w2_ring_slab);
    tcase_add_test(tests, w3_sheet);
    tcase_add_test(tests, w3_solid);
    tcase_add_test(tests, w3_solidified_by_the_library);
    tcase_add_test(tests, w4_sticks);
    tcase_add_test(tests, w4_sticks_rotated);
    tcase_add_loop_test(tests, hard_slabs_and_corners, 0, WL_HARD);
    suite_add_tcase(suite, tests);
    result = run_suite(suite);
    rat_arena_free();
    return result;
}
