/* test_hard.c - the benches' hard cases (bench/hard.h): the judge tells right from wrong, by the library and by the
   others; and the count of the unknowns that separation demands (bench/least.h). */
#define _POSIX_C_SOURCE 199309L
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../gxfem_boolean.h"
#include "../gxfem_integrate.h"
#include "../bench/replay.h"
#include "../bench/method.h"
#include "../bench/hard.h"
#include "../bench/block.h"
#include "../bench/least.h"
#include "body.h"

static TCase *add_case(Suite *suite, const char *name) {
    TCase *list = tcase_create(name);
    tcase_set_timeout(list, 60);
    suite_add_tcase(suite, list);
    return list;
}

static const hard_case *row_named(const char *name) {
    int i = 0;
    while (strcmp(hard_cases[i].name, name) != 0) i++;
    return &hard_cases[i];
}

/* ---- judgement ---- */

/* All cases that take less than seconds */
START_TEST(right_by_the_library) {
    int i;
    for (i = 0; i < HARD_CASES; i++) {
        char text[HARD_TEXT];
        hard_trial t;
        if (hard_cases[i].tetrahedron) continue;
        hard_trial_make(&t, &hard_cases[i]);
        hard_judge(&t, &methods[0], text);
        ck_assert_msg(strcmp(text, "right") == 0, "%s: %s", hard_cases[i].name, text);
        hard_trial_free(&t);
    }
}

/* A case with another expectation; the outcome ends with these texts */
static void check_text(hard_trial *t, const char *method_name, const char *expected) {
    char text[HARD_TEXT];
    hard_judge(t, &methods[method_index(method_name)], text);
    ck_assert_msg(strncmp(text, expected, strlen(expected)) == 0, "%s: %s, not %s", method_name, text, expected);
    hard_trial_free(t);
}

START_TEST(wrong_is_told) {
    hard_trial t;
    hard_trial_make(&t, row_named("slice of 1e-3"));
    t.pieces = 3;
    check_text(&t, "gxfem", "wrong: 2 of 3 pieces");
    hard_trial_make(&t, row_named("slice of 1e-3"));
    t.volume *= 0.9;
    check_text(&t, "gxfem", "wrong: volume +");
    hard_trial_make(&t, row_named("slice of 1e-3"));
    t.smallest *= 1.02;
    check_text(&t, "gxfem", "right but for volume");
    hard_trial_make(&t, row_named("slice of 1e-3"));
    t.smallest *= 3;
    check_text(&t, "gxfem", "wrong: smallest piece -");
    hard_trial_make(&t, row_named("slice of 1e-3"));
    t.scene.newton_iterations = 0;
    t.scene.dt = -1;
    check_text(&t, "gxfem", "diverged: ");
    hard_trial_make(&t, row_named("slice of 1e-3"));
    hard_add_triangle(&t.scene, &t.scene.cuts[0].path, 0, 1, 99);
    check_text(&t, "gxfem", "refused: ");
}

START_TEST(others_as_they_are) {
    hard_trial t;
    hard_trial_make(&t, row_named("through a node"));
    check_text(&t, "VNA", "wrong: volume +");
    hard_trial_make(&t, row_named("through a node"));
    check_text(&t, "Algorithm 1", "right but for volume");
    hard_trial_make(&t, row_named("through a node"));
    check_text(&t, "RXFEM", "right");
    hard_trial_make(&t, row_named("three through a line"));
    check_text(&t, "RXFEM", "refused: cuts cross");
    hard_trial_make(&t, row_named("slice of 1e-8"));
    check_text(&t, "Algorithm 1", "wrong: 1 of 2 pieces");
    hard_trial_make(&t, row_named("ends on another"));
    check_text(&t, "RXFEM", "wrong: 2 of 3 pieces");
}

/* A motion by the library, then one with a piece that falls too far, then one with a piece that is nowhere */
START_TEST(motion_is_judged) {
    hard_trial t;
    void *state;
    method_times times;
    gxs_model model;
    const double *u;
    double *moved;
    hard_pieces p;
    char text[HARD_TEXT];
    size_t i;
    hard_trial_make(&t, row_named("slice of 1e-3"));
    state = methods[0].create(&t.scene);
    memset(&times, 0, sizeof times);
    ck_assert_ptr_null(methods[0].cut(state, &t.scene.cuts[0], &times));
    methods[0].look(state, &model, &u);
    moved = (double *)calloc(3 * model.copy_count, sizeof(double));
    p = hard_pieces_of(&t, &model, moved);
    hard_judge_pieces(&t, &p, moved, text);
    ck_assert_str_eq(text, "wrong: falls 100 % off");
    hard_pieces_free(&p);
    for (i = 0; i < model.copy_count; i++) moved[3 * i + 2] = hard_fall_of(&t);
    p = hard_pieces_of(&t, &model, moved);
    hard_judge_pieces(&t, &p, moved, text);
    ck_assert_str_eq(text, "right");
    for (i = 0; i < model.copy_count; i++)
        if (p.of[i] == p.of[model.copy_count - 1]) moved[3 * i + 2] *= 1.05;
    hard_pieces_free(&p);
    p = hard_pieces_of(&t, &model, moved);
    hard_judge_pieces(&t, &p, moved, text);
    ck_assert_str_eq(text, "wrong: falls 5 % off");
    moved[0] = 1e30;
    hard_judge_pieces(&t, &p, moved, text);
    ck_assert_str_eq(text, "diverged: flies apart");
    hard_pieces_free(&p);
    free(moved);
    methods[0].destroy(state);
    hard_trial_free(&t);
}

/* ---- integrals ---- */

START_TEST(volumes_of_regions) {
    double vertices[9];
    ck_assert_double_eq_tol(hard_volume_between(0, 1), 1.0 / 6, 1e-16);
    ck_assert_double_eq_tol(hard_volume_between(0.25, 0.5), (0.75 * 0.75 * 0.75 - 0.125) / 6, 1e-16);
    hard_region_plane(0.25, 0, vertices);
    ck_assert_double_eq_tol(hard_integral_positive(vertices), hard_volume_between(0, 0.25), 1e-15);
    ck_assert_double_eq_tol(hard_integral_regular(vertices), hard_volume_between(0, 0.25), 5e-3);
    ck_assert_double_eq_tol(hard_integral_adaptive(vertices), hard_volume_between(0, 0.25), 5e-3);
    hard_region_plane(0.25, 1, vertices);
    ck_assert_double_eq_tol(hard_integral_positive(vertices), 0.25 * 0.25 * 0.25 / 6, 1e-16);
    ck_assert_double_eq_tol(hard_integral_regular(vertices), 0.25 * 0.25 * 0.25 / 6, 5e-4);
}

START_TEST(integrals_are_judged) {
    char text[HARD_TEXT];
    hard_trial t;
    hard_trial_make(&t, row_named("slice of 1e-8"));
    hard_integral_judge(&t, &hard_integral_methods[0], text);
    ck_assert_str_eq(text, "right");
    hard_integral_judge(&t, &hard_integral_methods[2], text);
    ck_assert_str_eq(text, "wrong: no volume in 1 of 1");
    hard_add_region_level(&t, 0.5);
    hard_integral_judge(&t, &hard_integral_methods[2], text);
    ck_assert_str_eq(text, "wrong: no volume in 1 of 2");
    t.levels[0] = 0.4999;
    hard_integral_judge(&t, &hard_integral_methods[0], text);
    ck_assert_str_eq(text, "right");
    hard_trial_free(&t);
    hard_trial_make(&t, row_named("fold"));
    hard_integral_judge(&t, &hard_integral_methods[0], text);
    ck_assert_str_eq(text, "");
    hard_trial_free(&t);
}

/* ---- the literal Algorithm 1 ---- */

/* Mended results in few triangles of each source face are other triangles of the same pieces. */
START_TEST(mended_is_the_same) {
    size_t copies[2], triangles[2], i;
    int mended;
    for (mended = 0; mended < 2; mended++) {
        hard_trial t;
        method_literal *m;
        method_times times;
        hard_trial_make(&t, row_named("three through a line"));
        m = (method_literal *)method_literal_create(&t.scene);
        m->cutter->desc.mended = mended;
        memset(&times, 0, sizeof times);
        for (i = 0; i < t.scene.cut_count; i++) ck_assert_ptr_null(method_literal_cut(m, &t.scene.cuts[i], &times));
        copies[mended] = m->cutter->copy_count;
        for (triangles[mended] = i = 0; i < m->cutter->nodal.count; i++)
            triangles[mended] += m->cutter->nodal.domains[i].triangle_count;
        method_literal_destroy(m);
        hard_trial_free(&t);
    }
    ck_assert_uint_eq(copies[0], copies[1]);
    ck_assert_uint_ne(triangles[0], triangles[1]);
}

/* ---- the least number of copies ---- */

/* A block of 2^3 to 3^3 cells, cut by sheets over a grid */
typedef struct sheets_case {
    block_mesh block;
    least_mesh mesh;
    least_sheets sheets;
    double x[8], y[8], *heights;
    gx_body *body;
} sheets_case;

static void sheets_make(sheets_case *c, uint32_t cells, uint32_t side, size_t count) {
    block_desc desc;
    uint32_t i;
    memset(c, 0, sizeof *c);
    memset(&desc, 0, sizeof desc);
    desc.young = 1e6;
    ck_assert_int_eq(block_make_mesh(cells, 0.2, &c->block), GX_OK);
    ck_assert_int_eq(block_make_body(&c->block, &desc, &c->body), GX_OK);
    c->mesh.positions = c->block.positions;
    c->mesh.node_count = c->block.side * c->block.side * c->block.side;
    c->mesh.elements = c->block.elements;
    c->mesh.element_count = 5 * (size_t)cells * cells * cells;
    for (i = 0; i <= side; i++) {
        c->x[i] = -0.1371 + 1.2717 * i / side;
        c->y[i] = -0.1213 + 1.2717 * i / side;
    }
    c->heights = (double *)calloc(count * (side + 1) * (side + 1), sizeof(double));
    c->sheets.x = c->x;
    c->sheets.y = c->y;
    c->sheets.z = c->heights;
    c->sheets.side = side;
    c->sheets.count = count;
}

static void sheets_cut(sheets_case *c, size_t sheet) {
    const uint32_t side = c->sheets.side, n = side + 1;
    double *vertices = (double *)calloc(3 * (size_t)n * n, sizeof(double));
    uint32_t *triangles = (uint32_t *)calloc(6 * (size_t)side * side, sizeof(uint32_t)), i, j, k = 0;
    gx_surface s;
    gx_cut_desc desc;
    memset(&s, 0, sizeof s);
    memset(&desc, 0, sizeof desc);
    for (i = 0; i < n * n; i++) {
        vertices[3 * i] = c->x[i % n];
        vertices[3 * i + 1] = c->y[i / n];
        vertices[3 * i + 2] = c->heights[sheet * n * n + i];
    }
    for (j = 0; j < side; j++)
        for (i = 0; i < side; i++) {
            const uint32_t a = j * n + i, corners[6] = {a, a + 1, a + n + 1, a, a + n + 1, a + n};
            memcpy(triangles + 6 * k++, corners, sizeof corners);
        }
    s.vertices = vertices;
    s.vertex_count = (size_t)n * n;
    s.triangles = triangles;
    s.triangle_count = 2 * (size_t)side * side;
    desc.surfaces = &s;
    desc.surface_count = 1;
    ck_assert_int_eq(gx_body_cut(c->body, &desc, NULL, NULL), GX_OK);
    free(vertices);
    free(triangles);
}

static void sheets_check(sheets_case *c, uint64_t seed) {
    const least_result counted = least_of(&c->mesh, &c->sheets);
    gx_view view;
    ck_assert_int_eq(gx_body_view(c->body, &view, NULL), GX_OK);
    ck_assert_msg(counted.least == view.copy_count && counted.replicas == view.copy_count,
                  "seed %lu: least %lu, replicas %lu, copies %lu", (unsigned long)seed, (unsigned long)counted.least,
                  (unsigned long)counted.replicas, (unsigned long)view.copy_count);
}

static void sheets_free(sheets_case *c) {
    gx_body_destroy(c->body);
    block_free_mesh(&c->block);
    free(c->heights);
}

START_TEST(least_by_hand) {
    static const double positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, lines[2] = {-1, 2},
                        flat[4] = {0.3, 0.3, 0.3, 0.3};
    static const double two[8] = {0.3, 0.3, 0.3, 0.3, 0.5, 0.5, 0.5, 0.5},
                        crossing[8] = {0.3, 0.3, 0.3, 0.3, -0.9, 1.65, -0.9, 1.65};
    static const uint32_t element[4] = {0, 1, 2, 3};
    least_mesh mesh = {positions, 4, element, 1};
    least_sheets sheets = {lines, lines, flat, 1, 0};
    least_result r = least_of(&mesh, &sheets);
    ck_assert(r.cells == 1 && r.least == 4 && r.replicas == 4);
    sheets.count = 1;
    r = least_of(&mesh, &sheets);
    ck_assert(r.cells == 2 && r.least == 8 && r.replicas == 8);
    sheets.count = 2;
    sheets.z = two;
    r = least_of(&mesh, &sheets);
    ck_assert(r.cells == 3 && r.least == 12 && r.replicas == 12);
    sheets.z = crossing;
    r = least_of(&mesh, &sheets);
    ck_assert(r.cells == 4 && r.least == 16 && r.replicas == 16);
}

/* Planes of random direction, or wavy sheets that cross each other */
START_TEST(least_is_what_bodies_have) {
    uint64_t seed;
    for (seed = 1; seed <= 24 / FEWER; seed++) {
        const uint32_t side = seed % 3 == 0 ? 1 : (uint32_t)(2 + seed % 4), n = side + 1;
        const size_t count = 1 + seed % 5;
        sheets_case c;
        size_t k;
        uint32_t i;
        random_seed(seed);
        sheets_make(&c, 2 + seed % 2, side, count);
        for (k = 0; k < count; k++) {
            const double height = random_real(0.2, 0.8), u = random_real(-1, 1), v = random_real(-1, 1),
                         wave = side > 1 ? 0.2 : 0;
            for (i = 0; i < n * n; i++)
                c.heights[k * n * n + i] =
                    height + u * (c.x[i % n] - 0.5) + v * (c.y[i / n] - 0.5) + wave * random_real(-1, 1);
            sheets_cut(&c, k);
            c.sheets.count = k + 1;
            sheets_check(&c, seed);
        }
        sheets_free(&c);
    }
}

int main(void) {
    Suite *suite = suite_create("hard");
    TCase *list;
    list = add_case(suite, "judgement");
    tcase_add_test(list, right_by_the_library);
    tcase_add_test(list, wrong_is_told);
    tcase_add_test(list, others_as_they_are);
    tcase_add_test(list, motion_is_judged);
    list = add_case(suite, "integrals");
    tcase_add_test(list, volumes_of_regions);
    tcase_add_test(list, integrals_are_judged);
    list = add_case(suite, "literal");
    tcase_add_test(list, mended_is_the_same);
    list = add_case(suite, "least");
    tcase_add_test(list, least_by_hand);
    tcase_add_test(list, least_is_what_bodies_have);
    return run_suite(suite);
}
