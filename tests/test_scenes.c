/* test_scenes.c - the scenes' own claims against the exact oracle. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../examples/cheese.h"
#include "oracle.h"
#include "runner.h"

static const double cheese_positions[12] = {0, 0, 0, CHEESE_EDGE, 0, 0, 0, CHEESE_EDGE, 0, 0, 0, CHEESE_EDGE};
static const uint32_t cheese_element[4] = {0, 1, 2, 3};

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static oracle *cheese_truth(const cheese_surface *surfaces) {
    oracle_surface input[CHEESE_SURFACES];
    oracle_mesh mesh;
    int i;
    memset(&mesh, 0, sizeof mesh);
    mesh.positions = cheese_positions;
    mesh.node_count = 4;
    mesh.elements = cheese_element;
    mesh.element_count = 1;
    for (i = 0; i < CHEESE_SURFACES; i++) {
        input[i].vertices = surfaces[i].vertices;
        input[i].triangles = surfaces[i].triangles;
        input[i].triangle_count = surfaces[i].triangle_count;
        input[i].solid = 0;
    }
    return oracle_create(&mesh, input, CHEESE_SURFACES);
}

/* One cut after the other, as in the scene */
static gx_body *cheese_body(const cheese_surface *surfaces) {
    gx_body_desc desc;
    gx_cut_desc cut;
    gx_surface surface;
    gx_body *body;
    int i;
    memset(&desc, 0, sizeof desc);
    memset(&cut, 0, sizeof cut);
    memset(&surface, 0, sizeof surface);
    desc.positions = cheese_positions;
    desc.node_count = 4;
    desc.elements = cheese_element;
    desc.element_count = 1;
    desc.young = desc.density = 1;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    cut.surfaces = &surface;
    cut.surface_count = 1;
    for (i = 0; i < CHEESE_SURFACES; i++) {
        surface.vertices = surfaces[i].vertices;
        surface.vertex_count = surfaces[i].vertex_count;
        surface.triangles = surfaces[i].triangles;
        surface.triangle_count = surfaces[i].triangle_count;
        ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
    }
    return body;
}

static void compare_volumes(const oracle *truth, const gx_view *view) {
    double *ours = (double *)malloc(view->cell_count * sizeof *ours),
           *exact = (double *)malloc(view->cell_count * sizeof *exact);
    size_t i;
    memcpy(ours, view->cell_volume, view->cell_count * sizeof *ours);
    memcpy(exact, truth->cell_volume, view->cell_count * sizeof *exact);
    qsort(ours, view->cell_count, sizeof *ours, ascending);
    qsort(exact, view->cell_count, sizeof *exact, ascending);
    for (i = 0; i < view->cell_count; i++) ck_assert_double_eq_tol(ours[i], exact[i], 1e-14 * view->volume);
    free(ours);
    free(exact);
}

/* The counts that swiss_cheese --small checks are the oracle's, and so are the volumes of cells. */
START_TEST(cheese_is_the_oracles) {
    cheese_surface *surfaces = (cheese_surface *)calloc(CHEESE_SURFACES, sizeof *surfaces);
    oracle *truth;
    gx_body *body;
    gx_view view;
    size_t node, copies[4] = {0, 0, 0, 0}, i;
    cheese_fill(surfaces, CHEESE_COARSE);
    truth = cheese_truth(surfaces);
    body = cheese_body(surfaces);
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    ck_assert_uint_eq(truth->cell_count, CHEESE_CELLS);
    ck_assert_uint_eq(truth->copy_count, CHEESE_COPIES);
    ck_assert_uint_eq(view.cell_count, truth->cell_count);
    ck_assert_uint_eq(view.fragment_count, truth->fragment_count);
    for (i = 0; i < view.copy_count; i++) copies[view.copy_node[i]]++;
    for (node = 0; node < 4; node++) ck_assert_uint_eq(copies[node], truth->node_copies[node]);
    compare_volumes(truth, &view);
    gx_body_destroy(body);
    oracle_destroy(truth);
    free(surfaces);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("scenes");
    TCase *tests = tcase_create("scenes");
    int result;
    tcase_set_timeout(tests, 300);
    tcase_add_test(tests, cheese_is_the_oracles);
    suite_add_tcase(suite, tests);
    result = run_suite(suite);
    rat_arena_free();
    return result;
}
