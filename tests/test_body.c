/* test_body.c - bodies that are cut: what a cut must not change, degenerate and partial cuts, solids, scopes, held
   regions, steps, far and long coordinates, bad input, the skin. Cells, copies and fragments of random cuts:
   test_oracle.c.

   Random tests print their seed. GXFEM_SEED=n runs seed n alone. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include <float.h>

enum { SEEDS = 40 / FEWER };

/* Cuts at once, counts and destroys: cells, copies, fragments */
static void expect_counts(workload w, size_t cells, size_t copies, size_t fragments, int line) {
    int at_once;
    for (at_once = 0; at_once < 2; at_once++) {
        gx_body *body = at_once ? cut_at_once(&w) : cut_in_sequence(&w);
        gx_view view = view_of(body);
        ck_assert_msg(view.cell_count == cells && view.copy_count == copies && view.fragment_count == fragments,
                      "line %d: %zu cells, %zu copies, %zu fragments; should be %zu, %zu, %zu", line, view.cell_count,
                      view.copy_count, view.fragment_count, cells, copies, fragments);
        gx_body_destroy(body);
    }
    wl_free(&w);
}
#define EXPECT_COUNTS(w, cells, copies, fragments) expect_counts(w, cells, copies, fragments, __LINE__)

/* ---- scenes ---- */

/* The triangle a, b, c, blown up 16 times about its middle: exact where coordinates are short */
static void add_plane_through(workload *w, const double a[3], const double b[3], const double c[3]) {
    wl_surface *s = wl_add_surface(w, 0);
    double x[3];
    int i, k;
    for (i = 0; i < 3; i++) {
        const double *p = i == 0 ? a
                        : i == 1 ? b
                                 : c,
                     *q = i == 0 ? b
                        : i == 1 ? c
                                 : a,
                     *r = i == 0 ? c
                        : i == 1 ? a
                                 : b;
        for (k = 0; k < 3; k++) x[k] = 32 * p[k] - 16 * q[k] - 15 * r[k];
        wl_add_vertex(s, x);
    }
    wl_add_triangle(s, 0, 1, 2);
}

/* The rectangle [x0, x1] x [z0, z1] in the plane y = value */
static wl_surface *add_rectangle(workload *w, double value, double x0, double z0, double x1, double z1) {
    wl_surface *s = wl_add_surface(w, 0);
    double p[4][3];
    int i;
    for (i = 0; i < 4; i++) {
        p[i][0] = i == 1 || i == 2 ? x1 : x0;
        p[i][1] = value;
        p[i][2] = i >= 2 ? z1 : z0;
    }
    wl_add_quad(s, p[0], p[1], p[2], p[3]);
    return s;
}

/* Every point of mesh and surfaces: scaled, its axes turned by `turn` thirds of the cycle x y z, moved */
static void transform(workload *w, double scale, int turn, const double offset[3]) {
    size_t i, j, n;
    for (j = 0; j <= w->surface_count; j++) {
        double *x = j == w->surface_count ? w->positions : w->surfaces[j].vertices;
        n = j == w->surface_count ? w->node_count : w->surfaces[j].vertex_count;
        for (i = 0; i < n; i++) {
            double old[3];
            int k;
            memcpy(old, x + 3 * i, sizeof old);
            for (k = 0; k < 3; k++) x[3 * i + (size_t)k] = scale * old[(k + turn) % 3] + (offset ? offset[k] : 0);
        }
    }
}

/* A quarter turn about axis 2: (x, y) -> (-y, x) */
static void quarter_turn(workload *w) {
    size_t i, j, n;
    for (j = 0; j <= w->surface_count; j++) {
        double *x = j == w->surface_count ? w->positions : w->surfaces[j].vertices;
        n = j == w->surface_count ? w->node_count : w->surfaces[j].vertex_count;
        for (i = 0; i < n; i++) {
            double t = x[3 * i];
            x[3 * i] = -x[3 * i + 1];
            x[3 * i + 1] = t;
        }
    }
}

/* ---- the field at material points ---- */

/* Is x strictly inside a leaf? Exact; adds a point to the complex. */
static int is_inside(gxb_complex *cx, uint32_t leaf, const double x[3]) {
    uint32_t point, first, count, i;
    ck_assert_int_eq(gxb_complex_add_point(cx, x, &point), GX_OK);
    ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
    for (i = 0; i < count; i++) {
        const gxb_facet *f = &cx->facets[cx->pool[first + i]];
        if (gxb_complex_side(cx, point, f->plane) != (f->leaf[0] == leaf ? 1 : -1)) return 0;
    }
    return 1;
}

static uint32_t slot_at(gx_body *body, uint32_t element, const double x[3]) {
    uint32_t cell, leaf, found = UINT32_MAX;
    gxb_complex_begin(body->complex);
    for (cell = element; cell != UINT32_MAX && found == UINT32_MAX; cell = body->cells.data[cell].next) {
        if (!body->cells.data[cell].kept) continue;
        for (leaf = body->cells.data[cell].first_leaf; leaf != UINT32_MAX && found == UINT32_MAX;
             leaf = body->leaves.data[leaf].next) {
            if (body->complex->leaves[leaf].facet_count == 0 || is_inside(body->complex, leaf, x)) found = cell;
        }
    }
    gxb_complex_rollback(body->complex);
    return found;
}

/* Displacement and velocity at a point of an element; 0 where there is no material (or the point is on a wall). */
static int field_at(gx_body *body, uint32_t element, const double lambda[4], double u[3], double v[3]) {
    double x[3] = {0, 0, 0};
    uint32_t cell;
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++)
            x[k] +=
                lambda[i] * body->mesh.positions[3 * body->complex->elements[4 * element + (uint32_t)i] + (uint32_t)k];
    cell = slot_at(body, element, x);
    if (cell == UINT32_MAX) return 0;
    for (k = 0; k < 3; k++) {
        u[k] = v[k] = 0;
        for (i = 0; i < 4; i++) {
            u[k] += lambda[i] * body->copies.displacement[3 * body->cells.data[cell].copies[i] + (uint32_t)k];
            v[k] += lambda[i] * body->copies.velocity[3 * body->cells.data[cell].copies[i] + (uint32_t)k];
        }
    }
    return 1;
}

static void random_lambda(double lambda[4]) {
    double sum = 0;
    int i;
    for (i = 0; i < 4; i++) sum += lambda[i] = random_real(0.001, 1);
    for (i = 0; i < 4; i++) lambda[i] /= sum;
}

static void set_random_state(gx_body *body) {
    gx_view view = view_of(body);
    size_t i;
    for (i = 0; i < 3 * view.copy_count; i++) {
        view.displacement[i] = random_real(-1, 1);
        view.velocity[i] = random_real(-1, 1);
    }
}

enum { PROBES = 60 };

/* Before and after each of several cuts, at the same material points: bit by bit the same. */
START_TEST(field_is_unchanged_by_cuts) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 4, 1);
    gx_body *body = body_of(&w);
    double lambda[PROBES][4], u[PROBES][3], v[PROBES][3], a[3], b[3];
    uint32_t element[PROBES];
    int there[PROBES], i, seen = 0;
    size_t c;
    for (i = 0; i < PROBES; i++) {
        random_lambda(lambda[i]);
        element[i] = (uint32_t)random_below((int)w.element_count);
    }
    for (c = 0; c < w.surface_count; c++) {
        set_random_state(body);
        for (i = 0; i < PROBES; i++) there[i] = field_at(body, element[i], lambda[i], u[i], v[i]);
        cut_by(body, &w, c, 1);
        for (i = 0; i < PROBES; i++) {
            if (!field_at(body, element[i], lambda[i], a, b)) continue;
            CHECK_SEED(there[i], seed);
            CHECK_SEED(memcmp(a, u[i], sizeof a) == 0 && memcmp(b, v[i], sizeof b) == 0, seed);
            seen++;
        }
    }
    CHECK_SEED(seen > 0, seed);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* u = A X + b on every copy: after any cuts each vertex of the skin is where the affine map takes it. */
START_TEST(skin_follows_the_field) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 3, 1);
    gx_body *body = body_of(&w);
    gx_view view = view_of(body);
    gx_skin skin;
    double map[3][4], *material, *moved;
    size_t i, zero = 0;
    int k, j;
    for (k = 0; k < 3; k++)
        for (j = 0; j < 4; j++) map[k][j] = random_real(-1, 1);
    for (i = 0; i < view.copy_count; i++)
        for (k = 0; k < 3; k++) {
            const double *x = w.positions + 3 * view.copy_node[i];
            view.displacement[3 * i + (size_t)k] = map[k][0] * x[0] + map[k][1] * x[1] + map[k][2] * x[2] + map[k][3];
        }
    for (i = 0; i < w.surface_count; i++) cut_by(body, &w, i, 1);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    view = view_of(body);
    moved = (double *)oracle_memory(NULL, 3 * skin.vertex_count + 1, sizeof *moved);
    material = (double *)oracle_memory(NULL, 3 * skin.vertex_count + 1, sizeof *material);
    ck_assert_int_eq(gx_body_skin_positions(body, moved, NULL), GX_OK);
    for (i = 0; i < 3 * view.copy_count; i++) view.displacement[i] = 0;
    ck_assert_int_eq(gx_body_skin_positions(body, material, NULL), GX_OK);
    for (i = 0; i < skin.vertex_count; i++)
        for (k = 0; k < 3; k++) {
            const double *x = material + 3 * i;
            double y = x[k] + map[k][0] * x[0] + map[k][1] * x[1] + map[k][2] * x[2] + map[k][3];
            CHECK_SEED(fabs(moved[3 * i + (size_t)k] - y) <= 1e-13 * (1 + fabs(y)) * 4, seed);
            zero += skin.vertex_weights[4 * i + (size_t)k] < 0;
        }
    CHECK_SEED(zero == 0, seed);
    free(moved);
    free(material);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- what sheets conserve; order, scale, rotation ---- */

START_TEST(sheets_conserve_mass_and_volume) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 6, 0);
    gx_body *body = body_of(&w);
    double volume = view_of(body).volume, mass = view_of(body).mass;
    size_t c, i;
    for (c = 0; c < w.surface_count; c++) {
        gx_cut_report report = cut_by(body, &w, c, 1);
        gx_view view = view_of(body);
        double cells = 0, fragments = 0;
        for (i = 0; i < view.cell_count; i++) {
            cells += view.cell_volume[i];
            CHECK_SEED(view.cell_volume[i] > 0, seed);
        }
        for (i = 0; i < view.fragment_count; i++) fragments += view.fragment_mass[i];
        CHECK_SEED(report.removed_volume == 0 && report.removed_cells == 0 && report.removed_copies == 0, seed);
        CHECK_SEED(fabs(view.volume - volume) <= 1e-12 * volume && fabs(cells - volume) <= 1e-12 * volume, seed);
        CHECK_SEED(fabs(view.mass - mass) <= 1e-12 * mass && fabs(fragments - mass) <= 1e-12 * mass, seed);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(solids_remove_what_they_report) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 5, 1);
    gx_body *body = body_of(&w);
    size_t c;
    for (c = 0; c < w.surface_count; c++) {
        double before = view_of(body).volume, left;
        size_t copies = view_of(body).copy_count, cells = view_of(body).cell_count;
        gx_cut_report report = cut_by(body, &w, c, 1);
        left = view_of(body).volume;
        CHECK_SEED(fabs(before - left - report.removed_volume) <= 1e-12 * view_of(body).volume + 1e-14, seed);
        CHECK_SEED(view_of(body).copy_count == copies + report.created_copies - report.removed_copies, seed);
        CHECK_SEED(view_of(body).cell_count == cells + report.created_cells - report.removed_cells, seed);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(sequence_equals_at_once) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 4, 1);
    gx_body *a = cut_at_once(&w), *b = cut_in_sequence(&w);
    expect_same(a, b, 1, 1e-9, 1e-14, "in sequence", seed);
    gx_body_destroy(a);
    gx_body_destroy(b);
    wl_free(&w);
}
END_TEST

static void shuffle_surface(wl_surface *s) {
    size_t i, k;
    for (i = s->triangle_count; i > 1; i--) {
        size_t j = (size_t)random_below((int)i);
        uint32_t t[3], turned[3];
        memcpy(t, s->triangles + 3 * (i - 1), sizeof t);
        memcpy(s->triangles + 3 * (i - 1), s->triangles + 3 * j, sizeof t);
        for (k = 0; k < 3; k++) turned[k] = t[(k + 1) % 3];
        memcpy(s->triangles + 3 * j, turned, sizeof turned);
    }
}

START_TEST(order_does_not_matter) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 4, 1);
    gx_body *a = cut_at_once(&w), *b;
    size_t i;
    for (i = w.surface_count; i > 1; i--) {
        size_t j = (size_t)random_below((int)i);
        wl_surface s = w.surfaces[i - 1];
        w.surfaces[i - 1] = w.surfaces[j];
        w.surfaces[j] = s;
    }
    for (i = 0; i < w.surface_count; i++) shuffle_surface(&w.surfaces[i]);
    b = cut_at_once(&w);
    expect_same(a, b, 1, 1e-9, 1e-14, "permuted, at once", seed);
    gx_body_destroy(b);
    b = cut_in_sequence(&w);
    expect_same(a, b, 1, 1e-9, 1e-14, "permuted, in sequence", seed);
    gx_body_destroy(a);
    gx_body_destroy(b);
    wl_free(&w);
}
END_TEST

START_TEST(scale_and_rotation_do_not_matter) {
    /* 2^-20 20 -90 90 */
    static const double scales[4] = {1.0 / 1048576, 1048576, 8.077935669463161e-28, 1.2379400392853803e27};
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 3, 1);
    gx_body *a = cut_at_once(&w), *b;
    int i;
    for (i = 0; i < 4; i++) {
        transform(&w, scales[i], 0, NULL);
        b = cut_at_once(&w);
        expect_same(a, b, scales[i], 1e-9, 1e-14, "scaled", seed);
        gx_body_destroy(b);
        transform(&w, 1 / scales[i], 0, NULL);
    }
    for (i = 0; i < 3; i++) {
        transform(&w, 1, 1, NULL);
        if (i == 2) quarter_turn(&w);
        b = cut_at_once(&w);
        expect_same(a, b, 1, 1e-9, 1e-14, "rotated", seed);
        gx_body_destroy(b);
    }
    gx_body_destroy(a);
    wl_free(&w);
}
END_TEST

/* ---- again, and an ulp beside ---- */

START_TEST(same_cut_twice_changes_nothing) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 3, 1);
    gx_body *body = cut_at_once(&w);
    uint64_t hash = hash_of(body);
    double volume = view_of(body).volume;
    size_t i;
    for (i = 0; i < w.surface_count; i++) {
        gx_cut_report report = cut_by(body, &w, i, 1);
        CHECK_SEED(report.created_copies == 0 && report.removed_copies == 0, seed);
        CHECK_SEED(report.created_cells == 0 && report.removed_cells == 0 && report.removed_volume == 0, seed);
        CHECK_SEED(hash_of(body) == hash, seed);
        CHECK_SEED(fabs(view_of(body).volume - volume) <= 1e-13 * volume, seed);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* An element counts once, however many of its cells a cut touches: all five elements by each of six planes, and
   again by the same planes */
START_TEST(touched_elements_count_once) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    size_t i;
    for (i = 0; i < 6; i++) add_axis_plane(&w, (int)(i % 3), (double)(i + 2) / 10);
    for (i = 0; i < 6; i++) {
        const size_t touched = cut_by(body, &w, i, 1).touched_elements;
        ck_assert_msg(touched >= 4 && touched <= 5, "cut %zu touches %zu elements", i, touched);
    }
    ck_assert_uint_gt(view_of(body).cell_count, 70);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Planes at 1/3 and the next double: a slab one ulp thick, with its own volume. */
START_TEST(cuts_one_ulp_apart) {
    double x = 1.0 / 3, next = nextafter(x, 1), step = next - x;
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_view view;
    double thin = 1;
    size_t i;
    add_axis_plane(&w, 0, x);
    add_axis_plane(&w, 0, next);
    body = cut_at_once(&w);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    ck_assert_uint_eq(view.copy_count, 24);
    for (i = 0; i < 3; i++) thin = fmin(thin, view.fragment_volume[i]);
    ck_assert_msg(fabs(thin - step) <= 1e-9 * step, "%.17g, should be %.17g", thin, step);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- in faces, through nodes, along edges ---- */

START_TEST(cuts_in_element_faces) {
    static const double corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                        {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    static const int faces[4][3] = {{0, 3, 5}, {0, 3, 6}, {0, 5, 6}, {3, 5, 6}};
    workload w;
    int i, j;
    for (i = 1; i <= 4; i++) { /* each face of the middle tetrahedron frees the corner behind it */
        w = grid(1, 1, 1, 5);
        for (j = 0; j < i; j++) add_plane_through(&w, corner[faces[j][0]], corner[faces[j][1]], corner[faces[j][2]]);
        EXPECT_COUNTS(w, 5, (size_t)(8 + 3 * i), (size_t)(1 + i));
    }
    w = grid(2, 1, 1, 6);
    add_axis_plane(&w, 0, 1);
    EXPECT_COUNTS(w, 12, 16, 2);
    w = grid(3, 3, 3, 5);
    for (j = 0; j < 3; j++)
        for (i = 1; i < 3; i++) add_axis_plane(&w, j, i);
    EXPECT_COUNTS(w, 135, 216, 27);
}
END_TEST

START_TEST(cuts_through_nodes_and_edges) {
    static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, z[3] = {0, 0, 1}, xy[3] = {1, 1, 0},
                        face[3] = {0.5, 0.25, 0.25}, yz[3] = {0, 0.5, 0.5}, xz[3] = {0.5, 0, 0.5};
    workload w = corner_tet(); /* through an edge */
    add_plane_through(&w, o, x, yz);
    EXPECT_COUNTS(w, 2, 8, 2);
    w = corner_tet();
    add_plane_through(&w, z, face, o);
    EXPECT_COUNTS(w, 2, 8, 2);
    w = corner_tet(); /* through one node and two edges */
    add_plane_through(&w, o, xz, face);
    EXPECT_COUNTS(w, 2, 8, 2);
    w = grid(1, 1, 1, 6); /* through the diagonal that all six tets share: cells are whole elements */
    add_plane_through(&w, o, xy, z);
    EXPECT_COUNTS(w, 6, 12, 2);
    w = grid(1, 1, 1, 5); /* x = y cuts the middle tet and two corners; the others have a node of their own */
    add_plane_through(&w, o, xy, z);
    EXPECT_COUNTS(w, 8, 14, 2);
}
END_TEST

START_TEST(three_planes_through_a_line_and_a_point) {
    static const double c[3] = {0.25, 0.25, 0.25};
    double p[3], q[3];
    workload w = corner_tet();
    int i;
    for (i = 0; i < 3; i++) { /* the line through c along z */
        memcpy(p, c, sizeof p);
        p[2] = 0.5;
        memcpy(q, c, sizeof q);
        q[0] += i == 0 ? 0.5 : i == 1 ? 0 : 0.25;
        q[1] += i == 0 ? 0 : i == 1 ? 0.5 : 0.25;
        add_plane_through(&w, c, p, q);
    }
    EXPECT_COUNTS(w, 6, 24, 6);
    w = corner_tet();
    for (i = 0; i < 3; i++) add_axis_plane(&w, i, 0.25);
    EXPECT_COUNTS(w, 8, 32, 8);
    w = grid(2, 2, 2, 6); /* in faces, through the middle node */
    for (i = 0; i < 3; i++) add_axis_plane(&w, i, 1);
    EXPECT_COUNTS(w, 48, 64, 8);
    w = corner_tet(); /* four through one point: x, y, z = 1/8 and x + y + z = 3/8 */
    for (i = 0; i < 3; i++) add_axis_plane(&w, i, 0.125);
    {
        static const double a[3] = {0.375, 0, 0}, b[3] = {0, 0.375, 0}, d[3] = {0, 0, 0.375};
        add_plane_through(&w, a, b, d);
    }
    EXPECT_COUNTS(w, 14, 56, 14);
}
END_TEST

/* A surface that only touches the body cuts nothing: its faces, an edge, nodes. */
START_TEST(tangent_cuts_do_nothing) {
    static const double e[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, aside[3] = {1, -1, 0};
    workload w = corner_tet();
    gx_body *body = body_of(&w);
    uint64_t hash = hash_of(body);
    size_t i;
    for (i = 0; i < 3; i++) {
        add_axis_plane(&w, (int)i, 0);
        add_axis_plane(&w, (int)i, 1);
        add_axis_plane(&w, (int)i, -0.5);
    }
    add_plane_through(&w, e[1], e[2], e[3]);
    add_plane_through(&w, e[0], e[3], aside);
    for (i = 0; i < w.surface_count; i++) {
        gx_cut_report report = cut_by(body, &w, i, 1);
        ck_assert_uint_eq(report.created_copies + report.created_cells + report.removed_cells, 0);
    }
    ck_assert_uint_eq(view_of(body).copy_count, 4);
    ck_assert(hash_of(body) == hash);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- sheets that end ---- */

START_TEST(sheet_that_ends_inside_an_element) {
    workload w = corner_tet();
    gx_body *body = body_of(&w);
    gx_cut_report report;
    add_rectangle(&w, 0.25, -1, -1, 0.25, 2);  /* x < 1/4 */
    add_rectangle(&w, 0.25, 0.5, -1, 2, 2);    /* x > 1/2 */
    add_rectangle(&w, 0.25, 0.25, -1, 0.5, 2); /* the strip between */
    add_rectangle(&w, 0.25, -1, -1, 2, 2);     /* all of it again */
    report = cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(report.created_copies + report.created_cells, 0);
    report = cut_by(body, &w, 1, 1);
    ck_assert_uint_eq(report.created_copies + report.created_cells, 0);
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    report = cut_by(body, &w, 2, 1);
    ck_assert_uint_eq(report.created_cells, 1);
    ck_assert_uint_eq(report.created_copies, 4);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert_double_eq_tol(view_of(body).fragment_volume[0] + view_of(body).fragment_volume[1], 1.0 / 6, 1e-15);
    ck_assert_double_eq_tol(fmax(view_of(body).fragment_volume[0], view_of(body).fragment_volume[1]),
                            (1 - 0.421875) / 6, 1e-15);
    report = cut_by(body, &w, 3, 1);
    ck_assert_uint_eq(report.created_copies + report.created_cells, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* The quarter plane y = 1/4, on one side of the face x = y + z of wl_pair, or beside it by `shift` */
static void add_half(workload *w, double y, int side) {
    wl_surface *s = wl_add_surface(w, 0);
    double p[3] = {0, 0, 0};
    p[1] = y;
    p[2] = -4;
    p[0] = y + p[2];
    wl_add_vertex(s, p);
    p[2] = 4;
    p[0] = y + p[2];
    wl_add_vertex(s, p);
    p[2] = side > 0 ? -4 : 4;
    p[0] = side > 0 ? 16 : -16;
    wl_add_vertex(s, p);
    wl_add_triangle(s, 0, 1, 2);
}

/* The sheet cuts through one element of two and ends in their common face. Only the node beyond the face gets a
   further copy. */
START_TEST(sheet_that_ends_between_elements) {
    workload w = wl_pair();
    add_half(&w, 0.25, 1);
    EXPECT_COUNTS(w, 3, 6, 1);
    w = wl_pair();
    add_half(&w, 0.25, 1);
    add_half(&w, 0.25, -1);
    EXPECT_COUNTS(w, 4, 10, 2);
}
END_TEST

/* A triangle much larger than the body cuts as one that just covers it. */
START_TEST(sheets_may_reach_far) {
    static const double corners[2][9] = {{-9, -9, 0.7, 9, -9, 0.7, 0, 19, 0.7},
                                         {-1e14, -3e13, 0.7, 1e18, -1e15, 0.7, 0, 1e18, 0.7}};
    size_t cells[2], copies[2];
    int i, k;
    for (i = 0; i < 2; i++) {
        workload w = grid(2, 2, 2, 5);
        wl_surface *s = wl_add_surface(&w, 0);
        gx_body *body;
        gx_view view;
        for (k = 0; k < 3; k++) wl_add_vertex(s, corners[i] + 3 * k);
        wl_add_triangle(s, 0, 1, 2);
        body = cut_in_sequence(&w);
        view = view_of(body);
        cells[i] = view.cell_count;
        copies[i] = view.copy_count;
        ck_assert_uint_eq(view.fragment_count, 2);
        gx_body_destroy(body);
        wl_free(&w);
    }
    ck_assert(cells[0] == cells[1] && copies[0] == copies[1]);
}
END_TEST

START_TEST(severed_links) {
    double d = ldexp(1, -30), ratio = (0.75 * 0.75) - (0.75 - d) * (0.75 - d);
    workload w = wl_pair();
    gx_body *body = body_of(&w);
    gx_surface surfaces[2];
    gx_cut_desc desc;
    gx_cut_report report;
    uint64_t hash;
    add_half(&w, 0.25, 1);
    add_half(&w, 0.25 + d, -1);
    report = cut_by(body, &w, 0, 2);
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    ck_assert_uint_eq(report.severed_links, 0);
    ck_assert_msg(fabs(report.min_link_ratio - ratio) <= 1e-6 * ratio, "%.17g, should be %.17g", report.min_link_ratio,
                  ratio);
    gx_body_destroy(body);
    surfaces[0] = surface_of(&w.surfaces[0]);
    surfaces[1] = surface_of(&w.surfaces[1]);
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = 2;
    desc.sever_below = 1e-6;
    body = body_of(&w);
    ck_assert_int_eq(gx_body_cut(body, &desc, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.severed_links, 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert_uint_eq(view_of(body).copy_count, 10);
    hash = hash_of(body);
    ck_assert_int_eq(gx_body_cut(body, &desc, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.severed_links, 0);
    ck_assert(hash_of(body) == hash);
    gx_body_destroy(body);
    desc.surface_count = 1; /* the same, severed by the second of two cuts */
    body = body_of(&w);
    ck_assert_int_eq(gx_body_cut(body, &desc, &report, NULL), GX_OK);
    desc.surfaces = surfaces + 1;
    ck_assert_int_eq(gx_body_cut(body, &desc, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.severed_links, 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert(hash_of(body) == hash);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- closed sheets, holes, folds ---- */

static void add_octahedron(workload *w, int solid, const double c[3], double r) {
    static const double dir[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const uint32_t t[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    wl_surface *s = wl_add_surface(w, solid);
    double x[3];
    int i, k;
    for (i = 0; i < 6; i++) {
        for (k = 0; k < 3; k++) x[k] = c[k] + r * dir[i][k];
        wl_add_vertex(s, x);
    }
    for (i = 0; i < 8; i++) wl_add_triangle(s, t[i][0], t[i][1], t[i][2]);
}

START_TEST(closed_sheets_make_cells) {
    static const double c[3] = {0.25, 0.25, 0.25}, middle[3] = {1, 1, 1};
    workload w = corner_tet();
    gx_body *body;
    gx_view view;
    add_box(&w, 0, 0.125, 0.125, 0.125, 0.25, 0.25, 0.25);
    EXPECT_COUNTS(w, 2, 8, 2);
    w = corner_tet();
    add_octahedron(&w, 0, c, 0.125);
    EXPECT_COUNTS(w, 2, 8, 2);
    w = corner_tet(); /* nested, in any order */
    add_box(&w, 0, 0.125, 0.125, 0.125, 0.25, 0.25, 0.25);
    add_box(&w, 0, 0.0625, 0.0625, 0.0625, 0.28125, 0.28125, 0.28125);
    add_box(&w, 0, 0.15625, 0.15625, 0.15625, 0.21875, 0.21875, 0.21875);
    body = cut_at_once(&w);
    view = view_of(body);
    {
        sized_cell *s = sorted_cells(&view, 1);
        double a = 0.0625 * 0.0625 * 0.0625, b = 0.125 * 0.125 * 0.125, d = 0.21875 * 0.21875 * 0.21875;
        ck_assert_double_eq_tol(s[0].volume, a, 1e-12 * a);
        ck_assert_double_eq_tol(s[1].volume, b - a, 1e-12 * a);
        ck_assert_double_eq_tol(s[2].volume, d - b, 1e-12 * a);
        ck_assert_double_eq_tol(s[3].volume, 1.0 / 6 - d, 1e-15);
        free(s);
    }
    gx_body_destroy(body);
    EXPECT_COUNTS(w, 4, 16, 4);
    w = corner_tet(); /* two side by side in a face */
    add_box(&w, 0, 0.0625, 0.0625, 0.0625, 0.125, 0.125, 0.125);
    add_box(&w, 0, 0.125, 0.0625, 0.0625, 0.1875, 0.125, 0.125);
    EXPECT_COUNTS(w, 3, 12, 3);
    w = grid(2, 2, 2, 6); /* a bubble around a node: through many elements */
    add_octahedron(&w, 0, middle, 0.5);
    body = cut_at_once(&w);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    ck_assert_double_eq_tol(fmin(view.fragment_volume[0], view.fragment_volume[1]), 4.0 / 3 * 0.125, 1e-14);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A plane with a square hole separates nothing in one element; the patch completes it. */
START_TEST(sheet_with_a_hole) {
    workload w = corner_tet();
    wl_surface *s = wl_add_surface(&w, 0);
    double out[4][3], in[4][3], y = 0.25;
    int i;
    for (i = 0; i < 4; i++) {
        out[i][0] = in[i][0] = 0.25;
        out[i][1] = in[i][1] = y;
        out[i][2] = in[i][2] = 0.25;
        out[i][0] += i == 1 || i == 2 ? 4 : -4;
        out[i][2] += i >= 2 ? 4 : -4;
        in[i][0] += i == 1 || i == 2 ? 0.0625 : -0.0625;
        in[i][2] += i >= 2 ? 0.0625 : -0.0625;
    }
    for (i = 0; i < 4; i++) wl_add_quad(s, out[i], out[(i + 1) % 4], in[(i + 1) % 4], in[i]);
    EXPECT_COUNTS(w, 1, 4, 1);
    w = corner_tet();
    s = wl_add_surface(&w, 0);
    for (i = 0; i < 4; i++) wl_add_quad(s, out[i], out[(i + 1) % 4], in[(i + 1) % 4], in[i]);
    wl_add_quad(wl_add_surface(&w, 0), in[0], in[1], in[2], in[3]);
    EXPECT_COUNTS(w, 2, 8, 2);
}
END_TEST

START_TEST(self_crossing_folded_and_duplicate) {
    static const double a[4][3] = {{-8, 0.25, -8}, {8, 0.25, -8}, {8, 0.25, 8}, {-8, 0.25, 8}},
                        b[4][3] = {{0.25, -8, -8}, {0.25, 8, -8}, {0.25, 8, 8}, {0.25, -8, 8}};
    workload w = corner_tet();
    wl_surface *s = wl_add_surface(&w, 0);
    gx_body *body;
    gx_cut_report report;
    double x[3] = {0.1, 0.1, 0.1};
    uint32_t i;
    wl_add_quad(s, a[0], a[1], a[2], a[3]); /* one sheet that crosses itself */
    wl_add_quad(s, b[0], b[1], b[2], b[3]);
    wl_add_triangle(s, 0, 1, 2); /* duplicates, also reversed */
    wl_add_triangle(s, 2, 1, 0);
    wl_add_triangle(s, 1, 2, 3); /* overlapping in the plane */
    wl_add_triangle(s, 0, 0, 1); /* no area: an index twice, three points of a line, one point */
    i = wl_add_vertex(s, x);
    x[1] = 0.2;
    x[2] = 0.3;
    x[0] = 0.2;
    wl_add_triangle(s, i, wl_add_vertex(s, x), i);
    wl_add_triangle(s, i, i, i);
    x[0] = -8;
    x[1] = 0.25;
    x[2] = 0;
    wl_add_triangle(s, 0, 3, wl_add_vertex(s, x));
    body = body_of(&w);
    report = cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(report.ignored_triangles, 4);
    ck_assert_uint_eq(view_of(body).cell_count, 4);
    ck_assert_uint_eq(view_of(body).fragment_count, 4);
    ck_assert_uint_eq(view_of(body).copy_count, 16);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A surface of zero-area triangles only is a cut without effect. */
START_TEST(nothing_but_flat_triangles) {
    workload w = corner_tet();
    wl_surface *s = wl_add_surface(&w, 0);
    gx_body *body = body_of(&w);
    uint64_t hash = hash_of(body);
    gx_cut_report report;
    double x[3] = {0.1, 0.1, 0.1};
    wl_add_vertex(s, x);
    wl_add_triangle(s, 0, 0, 0);
    report = cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(report.ignored_triangles, 1);
    ck_assert(hash_of(body) == hash);
    s->solid = 1;
    report = cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(report.ignored_triangles, 1);
    ck_assert(hash_of(body) == hash);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- very many, very thin ---- */

/* Planes x = i / (n + 1) in one call, as one surface */
START_TEST(a_thousand_parallel_cuts) {
    const int n = 1000 / FEWER;
    workload w = corner_tet();
    wl_surface *s = wl_add_surface(&w, 0);
    gx_body *body;
    gx_view view;
    sized_cell *cells, *truth;
    double sum = 0;
    int i, k;
    for (i = 1; i <= n; i++) {
        double x[4][3];
        for (k = 0; k < 4; k++) {
            x[k][0] = i / (n + 1.0);
            x[k][1] = k == 1 || k == 2 ? 4 : -4;
            x[k][2] = k >= 2 ? 4 : -4;
        }
        wl_add_quad(s, x[0], x[1], x[2], x[3]);
    }
    body = cut_at_once(&w);
    view = view_of(body);
    ck_assert_uint_eq(view.cell_count, (size_t)n + 1);
    ck_assert_uint_eq(view.fragment_count, (size_t)n + 1);
    ck_assert_uint_eq(view.copy_count, 4 * ((size_t)n + 1));
    truth = (sized_cell *)oracle_memory(NULL, (size_t)n + 1, sizeof *truth);
    for (i = 0; i <= n; i++) {
        double a = 1 - i / (n + 1.0), b = i == n ? 0 : 1 - (i + 1) / (n + 1.0);
        truth[i].element = 0;
        truth[i].volume = (a - b) * (a * a + a * b + b * b) / 6;
    }
    qsort(truth, (size_t)n + 1, sizeof *truth, by_cell_size);
    cells = sorted_cells(&view, 1);
    for (i = 0; i <= n; i++) {
        ck_assert_msg(fabs(cells[i].volume - truth[i].volume) <= 1e-15, "%.17g, should be %.17g", cells[i].volume,
                      truth[i].volume);
        sum += cells[i].volume;
    }
    ck_assert_double_eq_tol(sum, 1.0 / 6, 1e-13);
    free(cells);
    free(truth);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* 3 x 20 planes x, y, z = 1 ... 20 in the tetrahedron x + y + z <= 21: a lattice of unit cubes, cut off at the oblique
 * face */
START_TEST(three_times_twenty_planes) {
    const int n = FEWER > 1 ? 10 : 20, m = n + 1;
    static const double unit[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double x[4][3], p[4][3];
    workload w;
    wl_surface *s;
    gx_body *body;
    gx_view view;
    size_t count[3] = {0, 0, 0}, i;
    int axis, j, k;
    for (j = 0; j < 4; j++)
        for (k = 0; k < 3; k++) x[j][k] = m * unit[j][k];
    w = wl_tetrahedron((const double(*)[3])x);
    s = wl_add_surface(&w, 0);
    for (axis = 0; axis < 3; axis++)
        for (j = 1; j <= n; j++) {
            for (k = 0; k < 4; k++) {
                p[k][axis] = j;
                p[k][(axis + 1) % 3] = k == 1 || k == 2 ? 64 : -64;
                p[k][(axis + 2) % 3] = k >= 2 ? 64 : -64;
            }
            wl_add_quad(s, p[0], p[1], p[2], p[3]);
        }
    body = cut_at_once(&w);
    view = view_of(body);
    for (i = 0; i < view.cell_count; i++) {
        double v = view.cell_volume[i];
        int kind = v < 0.3 ? 0 : v < 0.9 ? 1 : 2;
        ck_assert_double_eq_tol(v, kind == 0 ? 1.0 / 6 : kind == 1 ? 5.0 / 6 : 1, 1e-11);
        count[kind]++;
    }
    ck_assert_uint_eq(count[0], (size_t)(m * (m + 1) / 2));
    ck_assert_uint_eq(count[1], (size_t)(m * (m - 1) / 2));
    ck_assert_uint_eq(count[2], (size_t)(m * (m - 1) * (m - 2) / 6));
    ck_assert_uint_eq(view.fragment_count, view.cell_count);
    ck_assert_uint_eq(view.copy_count, 4 * view.cell_count);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Smallest eigenvalue of a symmetric 4 x 4 matrix, by Jacobi rotations */
static double smallest_eigenvalue(double a[4][4]) {
    int sweep, p, q, k;
    double low;
    for (sweep = 0; sweep < 30; sweep++)
        for (p = 0; p < 4; p++)
            for (q = p + 1; q < 4; q++) {
                double theta, t, c, s;
                if (fabs(a[p][q]) < 1e-300) continue;
                theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
                c = 1 / sqrt(t * t + 1);
                s = t * c;
                for (k = 0; k < 4; k++) {
                    double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (k = 0; k < 4; k++) {
                    double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                }
            }
    low = a[0][0];
    for (k = 1; k < 4; k++) low = fmin(low, a[k][k]);
    return low;
}

/* Every kept cell has a positive volume, and a mass block that is positive semi-definite, also when scaled to a unit
   diagonal. */
static void check_cells(gx_body *body, const char *what, uint64_t seed) {
    static const int at[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    uint32_t i;
    for (i = 0; i < body->cells.count; i++) {
        const gxp_cell *cell = &body->cells.data[i];
        double a[4][4], sum = 0, low;
        int p, q;
        if (!cell->kept) continue;
        ck_assert_msg(cell->volume > 0, "seed %llu, %s: volume %g", (unsigned long long)seed, what, cell->volume);
        for (p = 0; p < 4; p++)
            for (q = 0; q < 4; q++) sum += cell->mass[at[p][q]];
        ck_assert_msg(fabs(sum - 1000 * cell->volume) <= 1e-9 * sum, "seed %llu, %s: mass %.17g, volume %.17g",
                      (unsigned long long)seed, what, sum, cell->volume);
        for (p = 0; p < 4; p++) {
            ck_assert_msg(cell->mass[at[p][p]] > 0, "seed %llu, %s: diagonal of the mass", (unsigned long long)seed,
                          what);
            for (q = 0; q < 4; q++) a[p][q] = cell->mass[at[p][q]] / sqrt(cell->mass[at[p][p]] * cell->mass[at[q][q]]);
        }
        low = smallest_eigenvalue(a);
        ck_assert_msg(low >= -1e-13, "seed %llu, %s: eigenvalue %g of the scaled mass, volume %g",
                      (unsigned long long)seed, what, low, cell->volume);
    }
}

/* A slab of the element beside a node, of size 10^-k: its volume is right to 1e-10 of its true size in doubles. */
START_TEST(slivers) {
    int k, kind;
    for (k = 1; k <= 15; k++)
        for (kind = 0; kind < 3; kind++) {
            const double size = pow(10, -k);
            volatile double cut = 1 - size; /* volatile: no compiler may see through this rounding */
            double a, b, truth, thin;       /* the slab from a to b, distances from the tip */
            workload w = corner_tet();
            gx_body *body;
            gx_view view;
            if (kind == 0) { /* a layer on the face x = 0 */
                add_axis_plane(&w, 0, size);
                truth = size * (3 - 3 * size + size * size) / 6;
            } else if (kind == 1) { /* the tip at x = 1 */
                add_axis_plane(&w, 0, cut);
                b = 1 - cut;
                truth = b * b * b / 6;
            } else { /* a thin slab in the middle */
                cut = 0.25 + size;
                add_axis_plane(&w, 0, 0.25);
                add_axis_plane(&w, 0, cut);
                a = 0.75;
                b = 1 - cut;
                truth = (cut - 0.25) * (a * a + a * b + b * b) / 6;
            }
            body = cut_at_once(&w);
            view = view_of(body);
            ck_assert_uint_eq(view.fragment_count, kind == 2 ? 3 : 2);
            {
                sized_cell *s = sorted_cells(&view, 1);
                thin = s[0].volume;
                free(s);
            }
            ck_assert_msg(fabs(thin - truth) <= 1e-10 * truth, "kind %d, 1e-%d: %.17g, should be %.17g", kind, k, thin,
                          truth);
            check_cells(body, "sliver", (uint64_t)k);
            gx_body_destroy(body);
            wl_free(&w);
        }
}
END_TEST

/* The same in general position: layers beside random planes */
START_TEST(slivers_in_general_position) {
    uint64_t seed = (uint64_t)_i;
    workload w;
    gx_body *body;
    gx_cut_report report;
    wl_frame f = wl_rotated();
    double thickness;
    int k;
    random_seed(seed);
    w = random_mesh();
    for (k = 0; k < 3; k++) f.origin[k] = random_real(0.2, 0.8);
    thickness = pow(10, -random_real(3, 12));
    wl_add_box(wl_add_surface(&w, 0), &f, 5, 5, thickness / 2);
    add_random_plane(&w, 40);
    body = cut_at_once(&w);
    check_cells(body, "general position", seed);
    gx_body_destroy(body);
    w.surfaces[0].solid = 1;
    body = body_of(&w);
    report = cut_by(body, &w, 0, 1);
    CHECK_SEED(report.removed_volume > 0 || view_of(body).copy_count == w.node_count, seed);
    check_cells(body, "solid", seed);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static int by_number(const void *a, const void *b) {
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/* Thin wedges beside an edge of an element. Their cones have coordinates that are 0, and so terms much smaller than
   their rounding. Volumes must agree with exact numbers. */
START_TEST(wedges) {
    uint64_t seed = (uint64_t)_i;
    int trial, k;
    random_seed(seed);
    for (trial = 0; trial < 5; trial++) {
        workload w = corner_tet();
        const double share = random_real(0.2, 0.7), more = pow(10, -random_real(4, 14));
        double p[3];
        gx_body *body;
        oracle *truth;
        size_t i;
        gx_view view;
        for (i = 0; i < 12; i++) w.positions[i] += random_real(-0.1, 0.1);
        for (i = 0; i < 2; i++) {
            const double t = share + (i == 1 ? more : 0), *c = w.positions + 6, *d = w.positions + 9;
            for (k = 0; k < 3; k++) p[k] = c[k] + t * (d[k] - c[k]);
            add_plane_through(&w, w.positions, w.positions + 3, p);
        }
        truth = wl_oracle(&w);
        body = cut_at_once(&w);
        view = view_of(body);
        CHECK_SEED(view.cell_count == truth->cell_count, seed);
        qsort(truth->cell_volume, truth->cell_count, sizeof *truth->cell_volume, by_number);
        {
            sized_cell *cells = sorted_cells(&view, 1);
            for (i = 0; i < view.cell_count; i++)
                ck_assert_msg(fabs(cells[i].volume - truth->cell_volume[i]) <= 1e-11 * truth->cell_volume[i],
                              "seed %llu: cell of %.17g, should be %.17g", (unsigned long long)seed, cells[i].volume,
                              truth->cell_volume[i]);
            free(cells);
        }
        oracle_destroy(truth);
        gx_body_destroy(body);
        wl_free(&w);
    }
}
END_TEST

/* A solid 1e-12 thick cuts the cube in two and removes its thickness, as doubles represent it. */
START_TEST(thin_solid) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_cut_report report;
    double x = 0.3, y = 0.3 + 1e-12;
    add_box(&w, 1, x, -2, -3, y, 4, 5);
    report = cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert_uint_eq(view_of(body).copy_count, 16);
    ck_assert_msg(fabs(report.removed_volume - (y - x)) <= 1e-10 * (y - x), "%.17g, should be %.17g",
                  report.removed_volume, y - x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- scopes ---- */

static gx_result cut_in_scope(gx_body *body, const workload *w, size_t surface, const uint32_t *fragments,
                              size_t fragment_count, const uint32_t *cells, size_t cell_count, gx_failure *failure) {
    gx_surface s = surface_of(&w->surfaces[surface]);
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &s;
    desc.surface_count = 1;
    desc.scope_fragments = fragments;
    desc.scope_fragment_count = fragment_count;
    desc.scope_cells = cells;
    desc.scope_cell_count = cell_count;
    return gx_body_cut(body, &desc, NULL, failure);
}

/* A blade through both halves of a cube cuts one of them; by fragments and by cells; as sheet and as solid. */
START_TEST(scope_of_a_cut) {
    int by_cells, solid;
    for (by_cells = 0; by_cells < 2; by_cells++)
        for (solid = 0; solid < 2; solid++) {
            workload w = grid(1, 1, 1, 5);
            gx_body *body = body_of(&w);
            gx_view view;
            uint32_t cells[32], scope = 1;
            size_t i, count = 0;
            add_axis_plane(&w, 0, 0.5);
            if (solid)
                add_box(&w, 1, -1, 0.25, -1, 2, 0.75, 2);
            else
                add_axis_plane(&w, 1, 0.5);
            add_axis_plane(&w, 1, 0.5);
            cut_by(body, &w, 0, 1);
            view = view_of(body);
            ck_assert_uint_eq(view.fragment_count, 2);
            for (i = 0; i < view.cell_count; i++)
                if (view.cell_fragment[i] == scope) cells[count++] = (uint32_t)i;
            ck_assert_int_eq(cut_in_scope(body, &w, 1, by_cells ? NULL : &scope, !by_cells, by_cells ? cells : NULL,
                                          by_cells ? count : 0, NULL),
                             GX_OK);
            view = view_of(body);
            ck_assert_uint_eq(view.fragment_count, 3);
            ck_assert_double_eq_tol(view.volume, solid ? 0.75 : 1, 1e-14);
            for (i = 0; i < 3; i++)
                ck_assert(fabs(view.fragment_volume[i] - 0.5) < 1e-14 ||
                          fabs(view.fragment_volume[i] - (solid ? 0.125 : 0.25)) < 1e-14);
            cut_by(body, &w, 2, 1); /* the same blade, without a scope */
            ck_assert_uint_eq(view_of(body).fragment_count, 4);
            gx_body_destroy(body);
            wl_free(&w);
        }
}
END_TEST

/* Volumes of what is left of each element */
static double *left_of_elements(gx_body *body, const workload *w) {
    const gx_view view = view_of(body);
    double *left = (double *)oracle_memory(NULL, w->element_count, sizeof *left);
    size_t i;
    for (i = 0; i < w->element_count; i++) left[i] = 0;
    for (i = 0; i < view.cell_count; i++) left[view.cell_element[i]] += view.cell_volume[i];
    return left;
}

/* In elements in scope a solid removes the same as without a scope, in others nothing. Also where elements are
   missing, so that parts of the scope are connected only by elements out of it, by a node, or not at all. */
START_TEST(scope_of_a_solid) {
    uint64_t seed = (uint64_t)_i;
    int trial;
    random_seed(seed);
    for (trial = 0; trial < 10; trial++) {
        workload w = grid(3, 2, 2, random_below(2) ? 5 : 6);
        wl_frame f = random_below(2) ? wl_axes() : wl_rotated();
        const int missing = random_below(3);
        uint32_t cells[256];
        double *before, *all, *some;
        gx_body *body;
        size_t i, n = 0;
        int k;
        for (i = 0; i < w.element_count; i++)
            if (random_below(4) >= missing) memmove(w.elements + 4 * n++, w.elements + 4 * i, 4 * sizeof *w.elements);
        w.element_count = n;
        if (n == 0) {
            wl_free(&w);
            continue;
        }
        for (k = 0; k < 3; k++) f.origin[k] = random_real(0, 2);
        wl_add_box(wl_add_surface(&w, 1), &f, random_real(0.02, 1.5), random_real(0.02, 1.5), random_real(0.02, 1.5));
        body = body_of(&w);
        before = left_of_elements(body, &w);
        gx_body_destroy(body);
        body = cut_at_once(&w);
        all = left_of_elements(body, &w);
        gx_body_destroy(body);
        body = body_of(&w);
        for (i = n = 0; i < w.element_count; i++)
            if (random_below(2)) cells[n++] = (uint32_t)i;
        if (n > 0) ck_assert_int_eq(cut_in_scope(body, &w, 0, NULL, 0, cells, n, NULL), GX_OK);
        some = left_of_elements(body, &w);
        for (i = 0, k = 0; i < w.element_count; i++) {
            const int scoped = (size_t)k < n && cells[k] == i;
            const double should = scoped ? all[i] : before[i];
            k += scoped;
            ck_assert_msg(fabs(some[i] - should) <= 1e-12 * before[i],
                          "seed %llu: of element %zu %.17g is left, should be %.17g of %.17g", (unsigned long long)seed,
                          i, some[i], should, before[i]);
        }
        gx_body_destroy(body);
        free(before);
        free(all);
        free(some);
        wl_free(&w);
    }
}
END_TEST

/* A scope of both fragments is no scope; an index out of range is named. */
START_TEST(scope_of_everything_and_of_nothing) {
    static const uint32_t all[2] = {0, 1}, wrong[2] = {0, 2}, cells[2] = {3, 1000};
    workload w = grid(1, 1, 1, 5);
    gx_body *a, *b;
    gx_failure failure;
    uint64_t state;
    add_axis_plane(&w, 0, 0.5);
    add_axis_plane(&w, 1, 0.5);
    a = cut_in_sequence(&w);
    b = body_of(&w);
    cut_by(b, &w, 0, 1);
    state = gx_body_state_hash(b);
    ck_assert_int_eq(cut_in_scope(b, &w, 1, wrong, 2, NULL, 0, &failure), GX_ERROR_INDEX);
    ck_assert_uint_eq(failure.index, 1);
    ck_assert_int_eq(cut_in_scope(b, &w, 1, NULL, 0, cells, 2, &failure), GX_ERROR_INDEX);
    ck_assert_uint_eq(failure.index, 1);
    ck_assert_int_eq(cut_in_scope(b, &w, 1, NULL, 2, NULL, 0, &failure), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(cut_in_scope(b, &w, 1, NULL, 0, NULL, 2, &failure), GX_ERROR_ARGUMENT);
    ck_assert(gx_body_state_hash(b) == state);
    ck_assert_int_eq(cut_in_scope(b, &w, 1, all, 2, NULL, 0, NULL), GX_OK);
    expect_same(a, b, 1, 1e-13, 1e-14, "scope of all", 0);
    gx_body_destroy(a);
    gx_body_destroy(b);
    wl_free(&w);
}
END_TEST

/* ---- solids ---- */

static void expect_volumes(workload w, double kept, double removed, size_t fragments, int line) {
    int at_once;
    for (at_once = 0; at_once < 2; at_once++) {
        gx_body *body = body_of(&w);
        double sum = 0;
        size_t i;
        if (at_once)
            sum = cut_by(body, &w, 0, w.surface_count).removed_volume;
        else
            for (i = 0; i < w.surface_count; i++) sum += cut_by(body, &w, i, 1).removed_volume;
        ck_assert_msg(fabs(view_of(body).volume - kept) <= 1e-13 * kept, "line %d: kept %.17g, should be %.17g", line,
                      view_of(body).volume, kept);
        ck_assert_msg(fabs(sum - removed) <= 1e-12 * removed, "line %d: removed %.17g, should be %.17g", line, sum,
                      removed);
        ck_assert_msg(view_of(body).fragment_count == fragments, "line %d: %zu fragments", line,
                      view_of(body).fragment_count);
        gx_body_destroy(body);
    }
    wl_free(&w);
}
#define EXPECT_VOLUMES(w, kept, removed, fragments) expect_volumes(w, kept, removed, fragments, __LINE__)

static void turn_inside_out(wl_surface *s, size_t first) {
    size_t i;
    for (i = first; i < s->triangle_count; i++) {
        uint32_t t = s->triangles[3 * i];
        s->triangles[3 * i] = s->triangles[3 * i + 1];
        s->triangles[3 * i + 1] = t;
    }
}

START_TEST(solids_remove) {
    static const double low[3] = {0.375, 0.375, 0.375}, high[3] = {0.625, 0.625, 0.625}, c[3] = {0.5, 0.5, 0.5};
    workload w = grid(1, 1, 1, 5);
    wl_surface *s;
    add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75); /* a cavity */
    EXPECT_VOLUMES(w, 0.875, 0.125, 1);
    w = grid(1, 1, 1, 5);
    turn_inside_out(add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75), 0);
    EXPECT_VOLUMES(w, 0.875, 0.125, 1);
    w = grid(1, 1, 1, 6);
    add_octahedron(&w, 1, c, 0.25);
    EXPECT_VOLUMES(w, 1 - 1.0 / 48, 1.0 / 48, 1);
    w = grid(1, 1, 1, 5);
    add_box(&w, 1, -1, 0.25, -1, 2, 0.75, 2); /* a slab */
    EXPECT_VOLUMES(w, 0.5, 0.5, 2);
    /* a shell: its inside is turned, so what it encloses stays */
    w = grid(1, 1, 1, 5);
    s = add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75);
    wl_add_aligned_box(s, low, high);
    turn_inside_out(s, 12);
    EXPECT_VOLUMES(w, 0.890625, 0.109375, 2);
    w = grid(1, 1, 1, 5); /* not turned: it winds twice around the middle */
    s = add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75);
    wl_add_aligned_box(s, low, high);
    EXPECT_VOLUMES(w, 0.875, 0.125, 1);
    w = grid(2, 1, 1, 6); /* overlapping, as two solids */
    add_box(&w, 1, 0.25, -1, -1, 1, 2, 2);
    add_box(&w, 1, 0.5, -1, -1, 1.25, 2, 2);
    EXPECT_VOLUMES(w, 1, 1, 2);
}
END_TEST

START_TEST(solids_with_coincident_faces) {
    static const double corner[4][3] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};
    static const uint32_t face[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    workload w = grid(1, 1, 1, 5);
    wl_surface *s;
    int i, turned;
    add_box(&w, 1, 0, 0, 0, 1, 1, 0.5); /* five of its faces lie in the body's */
    EXPECT_VOLUMES(w, 0.5, 0.5, 1);
    for (turned = 0; turned < 2; turned++) { /* the solid is the middle tetrahedron */
        w = grid(1, 1, 1, 5);
        s = wl_add_surface(&w, 1);
        for (i = 0; i < 4; i++) wl_add_vertex(s, corner[i]);
        for (i = 0; i < 4; i++) wl_add_triangle(s, face[i][0], face[i][1], face[i][2]);
        if (turned) turn_inside_out(s, 0);
        EXPECT_VOLUMES(w, 2.0 / 3, 1.0 / 3, 4);
    }
    w = grid(1, 1, 1, 5); /* beside the body, with a common face */
    add_box(&w, 1, 1, 0, 0, 2, 1, 1);
    EXPECT_VOLUMES(w, 1, 0, 1);
    w = grid(1, 1, 1, 5); /* two that share a face, one surface */
    s = add_box(&w, 1, -1, -1, 0.25, 2, 2, 0.5);
    {
        static const double low[3] = {-1, -1, 0.5}, high[3] = {2, 2, 0.75};
        wl_add_aligned_box(s, low, high);
    }
    EXPECT_VOLUMES(w, 0.5, 0.5, 2);
    w = grid(1, 1, 1, 5); /* the same box in both directions cancels */
    s = add_box(&w, 1, 0.25, 0.25, 0.25, 0.5, 0.5, 0.5);
    {
        static const double low[3] = {0.25, 0.25, 0.25}, high[3] = {0.5, 0.5, 0.5};
        wl_add_aligned_box(s, low, high);
    }
    turn_inside_out(s, 12);
    EXPECT_VOLUMES(w, 1, 0, 1);
}
END_TEST

/* Two cubes that do not touch; the solid holds one of them, or both. */
START_TEST(solids_that_contain_everything) {
    workload w = grid(1, 1, 1, 5), other = grid(1, 1, 1, 5);
    gx_body *body;
    gx_view view;
    gx_skin skin;
    gx_step_desc step;
    size_t i;
    for (i = 0; i < 8; i++)
        wl_add_node(&w, other.positions[3 * i] + 2, other.positions[3 * i + 1], other.positions[3 * i + 2]);
    for (i = 0; i < 5; i++)
        wl_add_element(&w, 8 + other.elements[4 * i], 8 + other.elements[4 * i + 1], 8 + other.elements[4 * i + 2],
                       8 + other.elements[4 * i + 3]);
    wl_free(&other);
    body = body_of(&w);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    add_box(&w, 1, 1.5, -1, -1, 4, 2, 2);
    add_box(&w, 1, -3, -4, -5, 8, 9, 7);
    add_axis_plane(&w, 0, 0.5);
    ck_assert_double_eq_tol(cut_by(body, &w, 0, 1).removed_volume, 1, 1e-14);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 1);
    ck_assert_uint_eq(view.copy_count, 8);
    ck_assert_double_eq_tol(cut_by(body, &w, 1, 1).removed_volume, 1, 1e-14);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count + view.copy_count + view.cell_count, 0);
    ck_assert(view.volume == 0 && view.mass == 0);
    cut_by(body, &w, 2, 1); /* the rest can still be cut, viewed and moved */
    cut_by(body, &w, 1, 1);
    ck_assert_uint_eq(view_of(body).cell_count, 0);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    ck_assert_uint_eq(skin.triangle_count, 0);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A solid without volume: a rectangle and its reverse, alone and beside a box. Walls are only where something was
   removed. */
START_TEST(solids_without_volume_do_nothing) {
    workload w = grid(1, 1, 1, 5);
    wl_surface *s = add_rectangle(&w, 0.5, -2, -2, 3, 3), *t;
    gx_body *body;
    uint64_t hash;
    size_t i;
    s->solid = 1;
    for (i = 0; i < 2; i++) wl_add_triangle(s, s->triangles[3 * i + 1], s->triangles[3 * i], s->triangles[3 * i + 2]);
    t = add_box(&w, 1, 0.25, 0.625, 0.25, 0.5, 0.75, 0.5);
    {
        static const double low[3] = {0.25, 0.5, 0.25}, high[3] = {0.5, 0.5, 0.5};
        wl_add_aligned_box(t, low, high);
    }
    body = body_of(&w);
    hash = hash_of(body);
    {
        gx_cut_report report = cut_by(body, &w, 0, 1);
        ck_assert_uint_eq(report.created_copies + report.created_cells + report.removed_cells, 0);
        ck_assert(report.removed_volume == 0 && hash_of(body) == hash);
        report = cut_by(body, &w, 1, 1);
        ck_assert_double_eq_tol(report.removed_volume, 0.0078125, 1e-15);
        ck_assert_uint_eq(view_of(body).fragment_count, 1);
        ck_assert_uint_eq(view_of(body).copy_count, 8);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(open_solids_are_refused) {
    int kind;
    for (kind = 0; kind < 3; kind++) {
        workload w = grid(1, 1, 1, 5);
        wl_surface *s;
        gx_surface surfaces[2];
        gx_cut_desc desc;
        gx_failure failure;
        gx_body *body = body_of(&w);
        uint64_t state = gx_body_state_hash(body);
        add_axis_plane(&w, 0, 0.5);
        s = add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75);
        if (kind == 0) s->triangle_count--;    /* a triangle is missing */
        if (kind == 1) turn_inside_out(s, 11); /* one is turned */
        /* moved, with all its triangles: still closed */
        if (kind == 2) s->vertices[3 * 6] = nextafter(s->vertices[3 * 6], 1);
        surfaces[0] = surface_of(&w.surfaces[0]);
        surfaces[1] = surface_of(s);
        memset(&desc, 0, sizeof desc);
        desc.surfaces = surfaces;
        desc.surface_count = 2;
        if (kind == 2)
            ck_assert_int_eq(gx_body_cut(body, &desc, NULL, &failure), GX_OK);
        else {
            ck_assert_int_eq(gx_body_cut(body, &desc, NULL, &failure), GX_ERROR_NOT_CLOSED);
            ck_assert_int_eq(failure.result, GX_ERROR_NOT_CLOSED);
            ck_assert_uint_eq(failure.surface, 1);
            ck_assert_uint_lt(failure.index, s->triangle_count);
            ck_assert(gx_body_state_hash(body) == state);
            ck_assert_uint_eq(view_of(body).copy_count, 8);
        }
        gx_body_destroy(body);
        wl_free(&w);
    }
}
END_TEST

/* A closed surface whose triangles do not share vertices, only coordinates */
START_TEST(triangle_soup_can_be_closed) {
    workload w = grid(1, 1, 1, 5);
    wl_surface *box = add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75), *soup = wl_add_surface(&w, 1);
    gx_body *body = body_of(&w);
    size_t i;
    for (i = 0; i < 3 * box->triangle_count; i += 3) {
        uint32_t a = wl_add_vertex(soup, box->vertices + 3 * box->triangles[i]),
                 b = wl_add_vertex(soup, box->vertices + 3 * box->triangles[i + 1]);
        wl_add_triangle(soup, a, b, wl_add_vertex(soup, box->vertices + 3 * box->triangles[i + 2]));
    }
    ck_assert_double_eq_tol(cut_by(body, &w, 1, 1).removed_volume, 0.125, 1e-15);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static double signed_volume(const double *vertices, const uint32_t *triangles, size_t count) {
    double six = 0;
    size_t t;
    for (t = 0; t < count; t++) {
        const double *a = vertices + 3 * triangles[3 * t], *b = vertices + 3 * triangles[3 * t + 1],
                     *c = vertices + 3 * triangles[3 * t + 2];
        six += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return six / 6;
}

/* Makes surface `sheet` of the workload solid by the library, as its next surface; its volume. */
static double solidify(workload *w, size_t sheet, double thickness) {
    gx_surface s = surface_of(&w->surfaces[sheet]);
    wl_surface *solid = wl_add_surface(w, 1);
    solid->vertices = (double *)oracle_memory(NULL, 6 * s.vertex_count, sizeof(double));
    solid->triangles = (uint32_t *)oracle_memory(NULL, 24 * s.triangle_count, sizeof(uint32_t));
    ck_assert_int_eq(gx_surface_solidify(&s, thickness, solid->vertices, &solid->vertex_count, solid->triangles,
                                         &solid->triangle_count, NULL, NULL),
                     GX_OK);
    ck_assert_uint_le(solid->vertex_count, 2 * s.vertex_count);
    ck_assert_uint_le(solid->triangle_count, 8 * s.triangle_count);
    return signed_volume(solid->vertices, solid->triangles, solid->triangle_count);
}

START_TEST(solidified_sheets) {
    gx_allocator half;
    static const double c[3] = {0.5, 0.5, 0.5};
    workload w = grid(1, 1, 1, 5);
    wl_frame f = wl_rotated();
    gx_body *body;
    gx_surface sheet;
    double v, vertices[64];
    uint32_t triangles[64];
    size_t nv, nt;
    int e;
    add_rectangle(&w, 0.5, -0.5, -0.5, 1.5, 1.5); /* a plane: area times thickness; 1/16 of the cube goes */
    v = solidify(&w, 0, 0.0625);
    ck_assert_double_eq_tol(v, 4 * 0.0625, 1e-14);
    body = body_of(&w);
    ck_assert_double_eq_tol(cut_by(body, &w, 1, 1).removed_volume, 0.0625, 1e-15);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    wl_free(&w);
    w = grid(1, 1, 1, 5); /* an oblique rectangle */
    f.origin[0] = f.origin[1] = f.origin[2] = 0.5;
    {
        static const double q[4][3] = {{-3, -2, 0}, {3, -2, 0}, {3, 2, 0}, {-3, 2, 0}};
        double x[4][3];
        int i;
        for (i = 0; i < 4; i++) wl_place(&f, q[i], x[i]);
        wl_add_quad(wl_add_surface(&w, 0), x[0], x[1], x[2], x[3]);
    }
    v = solidify(&w, 0, 1e-3);
    ck_assert_double_eq_tol(v, 24 * 1e-3, 1e-12);
    body = body_of(&w);
    cut_by(body, &w, 1, 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    wl_free(&w);
    w = grid(1, 1, 1, 5); /* a wave: what is removed is what it holds in the body */
    wl_add_wave(wl_add_surface(&w, 0), &f, 8, 2);
    solidify(&w, 0, 1e-2);
    body = body_of(&w);
    ck_assert_double_gt(cut_by(body, &w, 1, 1).removed_volume, 0.5e-2);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    wl_free(&w);
    w = grid(1, 1, 1, 5); /* a closed sheet becomes a shell, and a bubble floats in it */
    add_octahedron(&w, 0, c, 0.25);
    v = solidify(&w, 0, 0.0625);
    body = body_of(&w);
    ck_assert_double_eq_tol(cut_by(body, &w, 1, 1).removed_volume, v, 1e-13);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    sheet = surface_of(&w.surfaces[0]);
    ck_assert_int_eq(gx_surface_solidify(&sheet, 0, vertices, &nv, triangles, &nt, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_surface_solidify(&sheet, -1, vertices, &nv, triangles, &nt, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_surface_solidify(&sheet, NAN, vertices, &nv, triangles, &nt, NULL, NULL), GX_ERROR_NOT_FINITE);
    ck_assert_int_eq(gx_surface_solidify(NULL, 1, vertices, &nv, triangles, &nt, NULL, NULL), GX_ERROR_ARGUMENT);
    memset(&half, 0, sizeof half);
    half.allocate = (void *(*)(void *, size_t))1;
    ck_assert_int_eq(gx_surface_solidify(&sheet, 1, vertices, &nv, triangles, &nt, &half, NULL), GX_ERROR_ARGUMENT);
    sheet.triangle_count = 0;
    ck_assert_int_eq(gx_surface_solidify(&sheet, 1, vertices, &nv, triangles, &nt, NULL, NULL), GX_ERROR_EMPTY);
    wl_free(&w);
    /* of any size, an eighth thick; a vertex that no triangle uses */
    for (e = -560; e <= 560; e += 280) {
        static const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
        static const uint32_t corner[3] = {0, 1, 2};
        double x[12], thick[3];
        int i;
        for (i = 0; i < 12; i++) x[i] = ldexp(corners[i], e);
        memset(&sheet, 0, sizeof sheet);
        sheet.vertices = x;
        sheet.vertex_count = 4;
        sheet.triangles = corner;
        sheet.triangle_count = 1;
        ck_assert_int_eq(gx_surface_solidify(&sheet, ldexp(0.125, e), vertices, &nv, triangles, &nt, NULL, NULL),
                         GX_OK);
        for (i = 0; i < 3; i++) thick[i] = ldexp(vertices[i] - vertices[12 + i], -e);
        ck_assert_double_eq_tol(thick[2], 0.125, 1e-15);
        x[10] = NAN;
        ck_assert_int_eq(gx_surface_solidify(&sheet, ldexp(0.125, e), vertices, &nv, triangles, &nt, NULL, NULL),
                         GX_ERROR_NOT_FINITE);
        for (i = 0; i < 24; i++) { /* coordinates beyond doubles are refused, on either side */
            x[i % 12] = i % 3 < 2 ? corners[i % 12] : i < 12 ? DBL_MAX : -DBL_MAX;
            if (i % 12 < 11) continue;
            ck_assert_int_eq(gx_surface_solidify(&sheet, 1, vertices, &nv, triangles, &nt, NULL, NULL), GX_OK);
            ck_assert_int_eq(gx_surface_solidify(&sheet, 1e300, vertices, &nv, triangles, &nt, NULL, NULL),
                             GX_ERROR_RANGE);
        }
        for (i = 0; i < 9; i++) x[i] = (2 * corners[i] - 1) * DBL_MAX;
        ck_assert_int_eq(gx_surface_solidify(&sheet, 1, vertices, &nv, triangles, &nt, NULL, NULL), GX_ERROR_RANGE);
    }
}
END_TEST

/* Random sheets, some of inconsistent orientation or with a vertex in no triangle: always closed, always accepted. */
/* Triangles of any size beside a large one, whose areas squared are no doubles: the thickness is exact across each. */
START_TEST(solidified_sheets_of_any_size) {
    static const double sides[4][2][3] = {
        {{0, 1, 0}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 0}}, {{1, 0, 0}, {0, 1, 0}}, {{0.125, 1, 0}, {2, 0, -1}}};
    static const int powers[3] = {0, -150, -260};
    static const uint32_t triangles[6] = {0, 1, 2, 3, 4, 5};
    int i, j, k, c;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 3; j++) {
            const double size = ldexp(1, powers[j]), thick = size / 4;
            double x[18] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 9, 9, 9, 8, 9, 9, 9, 8, 9}, solid[36];
            uint32_t faces[48];
            size_t vertex_count, triangle_count;
            gx_surface s;
            memset(&s, 0, sizeof s);
            for (c = 0; c < 2; c++)
                for (k = 0; k < 3; k++) x[3 * (c + 1) + k] = sides[i][c][k] * size;
            s.vertices = x;
            s.vertex_count = 6;
            s.triangles = triangles;
            s.triangle_count = 2;
            ck_assert_int_eq(gx_surface_solidify(&s, thick, solid, &vertex_count, faces, &triangle_count, NULL, NULL),
                             GX_OK);
            ck_assert(vertex_count == 12 && triangle_count == 16);
            for (c = 0; c < 3; c++) {
                double across[3], along[2] = {0, 0}, square = 0;
                for (k = 0; k < 3; k++) {
                    across[k] = (solid[3 * c + k] - solid[18 + 3 * c + k]) / thick;
                    square += across[k] * across[k];
                    along[0] += across[k] * sides[i][0][k];
                    along[1] += across[k] * sides[i][1][k];
                }
                ck_assert_double_eq_tol(square, 1, 1e-14);
                ck_assert_double_eq_tol(along[0], 0, 1e-14);
                ck_assert_double_eq_tol(along[1], 0, 1e-14);
            }
        }
}
END_TEST

START_TEST(solidified_sheets_are_closed) {
    uint64_t seed = (uint64_t)_i;
    workload w;
    wl_surface *s;
    gx_body *body;
    int i, n, k;
    random_seed(seed);
    w = grid(1, 1, 1, 5);
    s = wl_add_surface(&w, 0);
    n = 4 + random_below(5);
    for (i = 0; i < n; i++) {
        double x[3];
        for (k = 0; k < 3; k++) x[k] = random_real(-1, 2);
        wl_add_vertex(s, x);
    }
    for (i = 1 + random_below(6); i > 0; i--) {
        uint32_t a = (uint32_t)random_below(n), b = (a + 1 + (uint32_t)random_below(n - 1)) % (uint32_t)n, c = a;
        while (c == a || c == b) c = (uint32_t)random_below(n);
        wl_add_triangle(s, a, b, c);
    }
    solidify(&w, 0, 0.01);
    body = body_of(&w);
    cut_by(body, &w, 1, 1);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- meshes joined in an edge or a node only ---- */

/* Two tetrahedra that share an edge (shared = 2) or a node (1), on both sides of x + y = 0 */
static workload pinched(int shared) {
    workload w = wl_empty();
    wl_add_node(&w, 0, 0, 0);
    wl_add_node(&w, 0, 0, 1);
    wl_add_node(&w, 1, 0, 0);
    wl_add_node(&w, 0, 1, 0);
    wl_add_node(&w, -1, 0, 0);
    wl_add_node(&w, 0, -1, 0);
    wl_add_element(&w, 0, 1, 2, 3);
    if (shared == 2)
        wl_add_element(&w, 0, 1, 4, 5);
    else
        wl_add_element(&w, 0, 4, 5, wl_add_node(&w, 0, 0, -1));
    return w;
}

START_TEST(pinched_meshes) {
    static const double o[3] = {0, 0, 0}, z[3] = {0, 0, 1}, inside[3] = {1, 2, 0};
    workload w = pinched(2);
    EXPECT_COUNTS(w, 2, 6, 1);
    w = pinched(1);
    EXPECT_COUNTS(w, 2, 7, 1);
    /* through the common edge and both elements: four fragments, none of them joined */
    w = pinched(2);
    add_plane_through(&w, o, z, inside);
    EXPECT_COUNTS(w, 4, 16, 4);
    w = pinched(1);
    add_plane_through(&w, o, z, inside);
    EXPECT_COUNTS(w, 4, 16, 4);
    w = pinched(2); /* across the edge: two fragments, each held together by its half of the edge */
    add_axis_plane(&w, 2, 0.5);
    EXPECT_COUNTS(w, 4, 12, 2);
    w = pinched(1); /* beside the node: cuts the first tetrahedron only */
    add_axis_plane(&w, 2, 0.5);
    EXPECT_COUNTS(w, 3, 11, 2);
}
END_TEST

/* The cut meets the body in the common edge or node only. */
START_TEST(cuts_that_only_touch_a_pinch) {
    static const double o[3] = {0, 0, 0}, z[3] = {0, 0, 1}, across[3] = {1, -1, 0};
    static const double half[4][3] = {{2, -2, 0.5}, {-2, 2, 0.5}, {-2, 2, 4}, {2, -2, 4}};
    workload w = pinched(2);
    add_plane_through(&w, o, z, across);
    EXPECT_COUNTS(w, 2, 8, 2);
    w = pinched(1);
    add_plane_through(&w, o, z, across);
    EXPECT_COUNTS(w, 2, 8, 2);
    /* the upper half of the edge; the lower half still joins, also around the upper node */
    w = pinched(2);
    wl_add_quad(wl_add_surface(&w, 0), half[0], half[1], half[2], half[3]);
    EXPECT_COUNTS(w, 2, 6, 1);
}
END_TEST

/* A cut in scope lets go of a shared edge or node only if the scope has it: of the two elements, the first is divided
   by x + y = 1/4 into a corner without the edge and the rest that has it. */
START_TEST(scopes_at_a_pinch) {
    static const double o[3] = {0, 0, 0}, z[3] = {0, 0, 1}, inside[3] = {1, 2, 0}, p[3] = {0.25, 0, 0},
                        q[3] = {0, 0.25, 0}, r[3] = {0.25, 0, 1};
    int shared, with_the_joint, by_itself;
    for (shared = 1; shared <= 2; shared++)
        for (with_the_joint = 0; with_the_joint < 2; with_the_joint++)
            for (by_itself = 0; by_itself < 2; by_itself++) {
                workload w = pinched(shared);
                gx_body *body = body_of(&w);
                gx_view view;
                uint32_t cells[4], corner = UINT32_MAX;
                size_t i, n = 0;
                add_plane_through(&w, p, q, r);
                add_plane_through(&w, o, z, inside);
                cut_by(body, &w, 0, 1);
                view = view_of(body);
                ck_assert_uint_eq(view.cell_count, 3);
                ck_assert_uint_eq(view.fragment_count, 2);
                for (i = 0; i < 3; i++) /* the only cell of its fragment */
                    if (view.cell_fragment[i] != view.cell_fragment[(i + 1) % 3] &&
                        view.cell_fragment[i] != view.cell_fragment[(i + 2) % 3])
                        corner = (uint32_t)i;
                ck_assert_uint_lt(corner, 3);
                for (i = 0; i < 3; i++)
                    if ((i != corner) == with_the_joint && (!by_itself || view.cell_element[i] == 0))
                        cells[n++] = (uint32_t)i;
                ck_assert_int_eq(cut_in_scope(body, &w, 1, NULL, 0, cells, n, NULL), GX_OK);
                view = view_of(body);
                /* the corner in two; or both halves of the rest and the second element, or its halves, apart */
                ck_assert_uint_eq(view.fragment_count, !with_the_joint ? 3 : by_itself ? 4 : 5);
                gx_body_destroy(body);
                wl_free(&w);
            }
}
END_TEST

/* A solid removes the node or edge that joins two elements. */
START_TEST(solid_around_a_pinch) {
    workload w = pinched(1);
    gx_body *body;
    add_box(&w, 1, -0.125, -0.125, -0.125, 0.125, 0.125, 0.125);
    body = cut_at_once(&w);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert_uint_eq(view_of(body).copy_count, 8);
    gx_body_destroy(body);
    wl_free(&w);
    w = pinched(2);
    add_box(&w, 1, -0.125, -0.125, -1, 0.125, 0.125, 0.5);
    body = cut_at_once(&w);
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    gx_body_destroy(body);
    add_box(&w, 1, -0.125, -0.125, 0.5, 0.125, 0.125, 2);
    body = cut_in_sequence(&w);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert_uint_eq(view_of(body).copy_count, 8);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- held regions ---- */

/* How far a cell reaches into the region, by its rounded points: 1 some way, -1 not at all, 0 too near to tell */
static int cell_reaches(gx_body *body, uint32_t cell, const gx_region *r) {
    gxb_complex *cx = body->complex;
    double reach = -1e300;
    uint32_t leaf, i, j, first, count, e0, en;
    ck_assert_int_eq(gxb_complex_open_element(cx, body->cells.data[cell].element), GX_OK);
    for (leaf = body->cells.data[cell].first_leaf; leaf != UINT32_MAX; leaf = body->leaves.data[leaf].next) {
        ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
        for (i = 0; i < count; i++) {
            ck_assert_int_eq(gxb_facet_resolve_edges(cx, cx->pool[first + i], &e0, &en), GX_OK);
            for (j = 0; j < en; j++) {
                const uint32_t e = cx->pool[e0 + j];
                double lambda[4], x = 0;
                int k;
                gxb_complex_barycentric(cx, cx->edges[e >> 1].v[e & 1], body->cells.data[cell].element, lambda);
                for (k = 0; k < 4; k++)
                    x += lambda[k] *
                         body->mesh
                             .positions[3 * cx->elements[4 * body->cells.data[cell].element + (uint32_t)k] + r->axis];
                reach = fmax(reach, (x - r->value) * r->side);
            }
        }
    }
    return reach > 1e-9 ? 1 : reach < -1e-9 ? -1 : 0;
}

static void check_held(gx_body *body, const gx_region *regions, size_t count, uint64_t seed) {
    gx_view view = view_of(body);
    size_t c, r, i, k;
    for (c = 0; c < view.copy_count; c++) {
        int expected = -1;
        for (r = 0; r < count; r++) {
            double x = body->mesh.positions[3 * view.copy_node[c] + regions[r].axis];
            if (!((x - regions[r].value) * regions[r].side > 0)) continue;
            for (i = 0; i < view.cell_count; i++)
                for (k = 0; k < 4; k++)
                    if (view.cell_copies[4 * i + k] == c)
                        expected = (int)fmax(expected, cell_reaches(body, body->view.cell[i], &regions[r]));
        }
        if (expected != 0)
            ck_assert_msg((expected > 0) == (view.copy_held[c] == 1), "seed %llu: copy %zu of node %u: held %u",
                          (unsigned long long)seed, c, view.copy_node[c], view.copy_held[c]);
    }
}

START_TEST(held_copies) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 4, 1);
    gx_body *body = body_of(&w);
    gx_region regions[2];
    size_t c;
    int i;
    for (i = 0; i < 2; i++) {
        const uint32_t axis = (uint32_t)random_below(3);
        const int side = random_below(2) ? 1 : -1;
        regions[i] = gx_region_half_space(axis, side, random_real(0.05, 0.95));
    }
    ck_assert_int_eq(gx_body_hold(body, regions, 2, NULL), GX_OK);
    check_held(body, regions, 2, seed);
    for (c = 0; c < w.surface_count; c++) {
        cut_by(body, &w, c, 1);
        if (c == 2) {
            regions[0].value = 0.5;
            ck_assert_int_eq(gx_body_hold(body, regions, 1, NULL), GX_OK);
        }
        check_held(body, regions, c < 2 ? 2 : 1, seed);
    }
    ck_assert_int_eq(gx_body_hold(body, NULL, 0, NULL), GX_OK);
    check_held(body, NULL, 0, seed);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Layers: only the uppermost reaches the region, so only its copies of the upper nodes are held. A node on the
   border is not inside. */
START_TEST(pieces_outside_the_region_are_free) {
    workload w = grid(1, 1, 1, 5);
    gx_region region = gx_region_half_space(2, 1, 0.75);
    gx_body *body = body_of(&w);
    gx_view view;
    size_t i, held = 0;
    add_axis_plane(&w, 2, 0.25);
    add_axis_plane(&w, 2, 0.5);
    add_axis_plane(&w, 2, 0.75);
    ck_assert_int_eq(gx_body_hold(body, &region, 1, NULL), GX_OK);
    for (i = 0; i < 3; i++) {
        size_t j;
        cut_by(body, &w, i, 1);
        view = view_of(body);
        for (j = held = 0; j < view.copy_count; j++) {
            held += view.copy_held[j];
            ck_assert(!view.copy_held[j] || body->mesh.positions[3 * view.copy_node[j] + 2] == 1);
        }
        ck_assert_uint_eq(held, 4);
    }
    region.value = 1; /* strictly above: nothing is left there, and what is held stays */
    ck_assert_int_eq(gx_body_hold(body, &region, 1, NULL), GX_ERROR_EMPTY);
    view = view_of(body);
    for (i = held = 0; i < view.copy_count; i++) held += view.copy_held[i];
    ck_assert_uint_eq(held, 4);
    ck_assert_int_eq(gx_body_hold(body, NULL, 0, NULL), GX_OK);
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) ck_assert(!view.copy_held[i]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- time steps ---- */

static gx_step_desc still_step(void) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = 0.033;
    return step;
}

/* sum over parts of M v, and of |M v| for scale */
static double momentum(gx_body *body, double p[3]) {
    static const int at[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    double size = 0;
    uint32_t i;
    int a, b, k;
    p[0] = p[1] = p[2] = 0;
    for (i = 0; i < body->cells.count; i++)
        for (a = 0; a < 4 && body->cells.data[i].kept; a++)
            for (b = 0; b < 4; b++)
                for (k = 0; k < 3; k++) {
                    double x = body->cells.data[i].mass[at[a][b]] *
                               body->copies.velocity[3 * body->cells.data[i].copies[b] + (uint32_t)k];
                    p[k] += x;
                    size += fabs(x);
                }
    return size;
}

/* A body can be stepped after a solid has removed all of it since the last step, with small corners supported or
   not. */
START_TEST(nothing_is_left_to_step) {
    workload w = grid(1, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    const gx_step_desc step = still_step();
    gx_step_desc wrong = step;
    gx_body *body = NULL;
    int i;
    add_box(&w, 1, -1, -1, -1, 2, 2, 2);
    desc.support_below = 0.1 * _i;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    cut_by(body, &w, 0, 1);
    for (i = 0; i < 2; i++) {
        gx_step_report report;
        gx_result result = gx_body_step(body, &step, &report, NULL);
        ck_assert_msg(result == GX_OK, "step %d: %s", i, gx_result_text(result));
        ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    }
    wrong.dt = -1;
    ck_assert_int_eq(gx_body_step(body, &wrong, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_uint_eq(view_of(body).copy_count, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(free_bodies_keep_their_momentum) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 2, 0);
    gx_body *body = cut_at_once(&w);
    gx_view view = view_of(body);
    gx_step_desc step = still_step();
    double before[3], after[3], size;
    size_t i;
    int k, n;
    step.dt = 0.01;
    step.newton_iterations = 30;
    step.newton_tolerance = 1e-9;
    step.cg_tolerance = 1e-10;
    step.cg_iterations = 20000;
    for (i = 0; i < 3 * view.copy_count; i++) {
        view.velocity[i] = random_real(-0.1, 0.1);
        view.displacement[i] = random_real(-0.01, 0.01);
    }
    size = momentum(body, before);
    for (n = 0; n < 3; n++) {
        gx_result result = gx_body_step(body, &step, NULL, NULL);
        CHECK_SEED(result == GX_OK, seed);
    }
    momentum(body, after);
    for (k = 0; k < 3; k++)
        ck_assert_msg(fabs(after[k] - before[k]) <= 1e-6 * size, "seed %llu: momentum %.17g, was %.17g",
                      (unsigned long long)seed, after[k], before[k]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Backward Euler: after n steps every copy has fallen g dt^2 n (n + 1) / 2. */
START_TEST(fragments_fall) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_view view;
    gx_step_desc step = still_step();
    double fallen;
    size_t i;
    int n;
    for (i = 1; i <= 2; i++) {
        add_axis_plane(&w, 0, (double)i / 3);
        add_axis_plane(&w, 1, (double)i / 3);
    }
    body = cut_at_once(&w);
    step.gravity[2] = -9.81;
    step.cg_tolerance = 1e-10;
    for (n = 0; n < 10; n++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 9);
    fallen = 9.81 * step.dt * step.dt * 55;
    for (i = 0; i < view.copy_count; i++) {
        ck_assert_double_eq_tol(view.displacement[3 * i + 2], -fallen, 1e-6 * fallen);
        ck_assert_double_eq_tol(view.displacement[3 * i], 0, 1e-6 * fallen);
        ck_assert_double_eq_tol(view.velocity[3 * i + 2], -9.81 * step.dt * 10, 1e-6);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Held above and cut half through, it hangs near its place. Cut through, the lower half falls. */
START_TEST(held_body_hangs) {
    workload w = grid(1, 1, 2, 5);
    gx_body *body = body_of(&w);
    gx_region region = gx_region_half_space(2, 1, 1.5);
    gx_step_desc step = still_step();
    gx_view view;
    size_t i;
    int n, free_copies = 0;
    add_box(&w, 0, -1, -1, -1, 0.5, 3, 0.75);
    add_axis_plane(&w, 2, 0.75);
    ck_assert_int_eq(gx_body_hold(body, &region, 1, NULL), GX_OK);
    step.gravity[2] = -9.81;
    step.newton_iterations = 2;
    step.cg_tolerance = 1e-6;
    cut_by(body, &w, 0, 1);
    for (n = 0; n < 30; n++) {
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        view = view_of(body);
        for (i = 0; i < 3 * view.copy_count; i++) {
            if (view.copy_held[i / 3]) ck_assert(view.displacement[i] == 0);
        }
    }
    /* the held part sags by about rho g L^2 / E = 0.04 at most; the part that the box cut off has fallen 9.81 / 2 m */
    for (i = 0; i < view.copy_count; i++) {
        const double down = -view.displacement[3 * i + 2];
        ck_assert(down > -0.01 && (down < 0.3 || down > 3));
        free_copies += down > 3;
    }
    ck_assert_int_gt(free_copies, 0);
    cut_by(body, &w, 1, 1);
    for (n = 0; n < 30; n++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    for (i = 0; i < 4 * view.cell_count; i++) {
        const double down = -view.displacement[3 * view.cell_copies[i] + 2];
        ck_assert((down > 3) == (view.fragment_center[3 * view.cell_fragment[i / 4] + 2] < 0.75));
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static int is_finite_state(const gx_view *view) {
    size_t i;
    for (i = 0; i < 3 * view->copy_count; i++)
        if (!(fabs(view->displacement[i]) < 1e6) || !(fabs(view->velocity[i]) < 1e6)) return 0;
    return 1;
}

/* Centre of a fragment, deformed: mass-weighted */
static void deformed_center(gx_body *body, uint32_t fragment, double center[3]) {
    gx_view view = view_of(body);
    double mass = 0;
    size_t i;
    int a, k;
    center[0] = center[1] = center[2] = 0;
    for (i = 0; i < view.cell_count; i++) {
        const gxp_cell *cell = &body->cells.data[body->view.cell[i]];
        if (view.cell_fragment[i] != fragment) continue;
        for (a = 0; a < 4; a++) {
            const double m = gxp_mass_row(cell->mass, a);
            mass += m;
            for (k = 0; k < 3; k++)
                center[k] += m * (body->mesh.positions[3 * view.copy_node[cell->copies[a]] + (uint32_t)k] +
                                  view.displacement[3 * cell->copies[a] + (uint32_t)k]);
        }
    }
    for (k = 0; k < 3; k++) center[k] /= mass;
}

/* 36 sticks, thrown apart: v = 2 (X - middle) along x and y; each flies its own way. */
START_TEST(sticks_drift_apart) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_view view;
    gx_step_desc step = still_step();
    double(*rest)[3], center[3];
    size_t i, j;
    int n, k;
    for (n = 1; n <= 5; n++) {
        add_axis_plane(&w, 0, n / 6.0);
        add_axis_plane(&w, 1, n / 6.0);
    }
    body = cut_at_once(&w);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 36);
    rest = (double(*)[3])oracle_memory(NULL, view.fragment_count, sizeof *rest);
    memcpy(rest, view.fragment_center, view.fragment_count * sizeof *rest);
    for (i = 0; i < view.copy_count; i++)
        for (k = 0; k < 2; k++)
            view.velocity[3 * i + (size_t)k] = 2 * (body->mesh.positions[3 * view.copy_node[i] + (uint32_t)k] - 0.5);
    for (n = 0; n < 10; n++) {
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        view = view_of(body);
        ck_assert(is_finite_state(&view));
    }
    for (i = 0; i < view.fragment_count; i++) {
        deformed_center(body, (uint32_t)i, center);
        for (k = 0; k < 2; k++) ck_assert_double_eq_tol(center[k] - 0.5, 1.66 * (rest[i][k] - 0.5), 0.02);
        for (j = 0; j < i; j++) {
            double other[3], now = 0, then = 0;
            deformed_center(body, (uint32_t)j, other);
            for (k = 0; k < 2; k++) {
                now += (center[k] - other[k]) * (center[k] - other[k]);
                then += (rest[i][k] - rest[j][k]) * (rest[i][k] - rest[j][k]);
            }
            ck_assert_double_gt(now, 1.3 * 1.3 * then);
        }
    }
    free(rest);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Slivers beside sticks, a large step, a violent state: the result is finite, or the step fails and the state is as
   it was. */
START_TEST(violent_steps_stay_finite) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 3, 1);
    gx_body *body;
    gx_view view;
    gx_step_desc step = still_step();
    size_t i;
    int n;
    add_axis_plane(&w, 0, 1e-6);
    add_axis_plane(&w, 1, 1 - 1e-5);
    body = cut_at_once(&w);
    view = view_of(body);
    for (i = 0; i < 3 * view.copy_count; i++) {
        view.displacement[i] = random_real(-0.5, 0.5);
        view.velocity[i] = random_real(-10, 10);
    }
    step.dt = seed % 3 == 0 ? 1 : 0.033;
    step.gravity[2] = -9.81;
    for (n = 0; n < 5; n++) {
        uint64_t state = gx_body_state_hash(body);
        gx_result result = gx_body_step(body, &step, NULL, NULL);
        CHECK_SEED(result == GX_OK || (result == GX_ERROR_DIVERGED && gx_body_state_hash(body) == state), seed);
        view = view_of(body);
        CHECK_SEED(is_finite_state(&view), seed);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A force on one copy moves its fragment: momentum = force x time. */
START_TEST(forces_act_on_copies) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_view view;
    gx_step_desc step = still_step();
    double *forces, p[3];
    add_axis_plane(&w, 0, 0.5);
    body = cut_at_once(&w);
    view = view_of(body);
    forces = (double *)oracle_memory(NULL, 3 * view.copy_count, sizeof *forces);
    memset(forces, 0, 3 * view.copy_count * sizeof *forces);
    forces[3 * (view.copy_count - 1)] = 10;
    step.forces = forces;
    step.epoch = view.epoch;
    step.cg_tolerance = 1e-10;
    step.newton_iterations = 20;
    step.newton_tolerance = 1e-10;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    momentum(body, p);
    ck_assert_double_eq_tol(p[0], 10 * step.dt, 1e-7);
    ck_assert_double_eq_tol(p[1], 0, 1e-7);
    free(forces);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- far from the origin, small, large, long ---- */

/* Coordinates are multiples of 1/16: the far body and its cuts are exactly the near ones, moved. */
START_TEST(far_from_the_origin_exactly) {
    static const double offsets[3] = {1048576, 134217728, 17592186044416.0};
    static const double a[3] = {0.25, 0, 0}, b[3] = {1, 0.75, 0.5}, c[3] = {0, 0.5, 1};
    int i, k;
    for (i = 0; i < 3; i++) {
        workload w = grid(2, 1, 1, 5);
        gx_body *near_body, *far_body;
        double offset[3];
        for (k = 0; k < 3; k++) offset[k] = offsets[i] * (1 - k * 0.5);
        add_axis_plane(&w, 0, 0.5);
        add_axis_plane(&w, 1, 0.625);
        add_plane_through(&w, a, b, c);
        add_box(&w, 1, 1.25, 0.25, 0.25, 1.5, 2, 0.75);
        near_body = cut_at_once(&w);
        transform(&w, 1, 0, offset);
        far_body = cut_at_once(&w);
        expect_same(near_body, far_body, 1, 1e-12, 0, "moved exactly", (uint64_t)i);
        gx_body_destroy(near_body);
        gx_body_destroy(far_body);
        wl_free(&w);
    }
}
END_TEST

/* Rounded by the move: the same topology where nothing is degenerate; volumes to the precision of the rounded input. */
START_TEST(far_from_the_origin_rounded) {
    static const double offset[2][3] = {{1e6, -1e6, 0.7e6}, {1e8, 0.3e8, -1e8}};
    uint64_t seed = (uint64_t)_i;
    int i;
    for (i = 0; i < 2; i++) {
        workload w;
        gx_body *near_body, *far_body;
        double rounding = i == 0 ? 1e-9 : 1e-7;
        random_seed(seed + 77);
        w = grid(2, 1, 1, 5);
        add_random_plane(&w, 10);
        add_random_plane(&w, 10);
        add_random_plane(&w, 10);
        near_body = cut_at_once(&w);
        transform(&w, 1, 0, offset[i]);
        far_body = cut_at_once(&w);
        if (view_of(near_body).cell_count == view_of(far_body).cell_count) /* else a sliver of the rounding's size */
            expect_same(near_body, far_body, 1, 0, rounding, "moved", seed);
        else
            CHECK_SEED(i == 1, seed);
        check_cells(far_body, "far", seed);
        gx_body_destroy(near_body);
        gx_body_destroy(far_body);
        wl_free(&w);
    }
}
END_TEST

START_TEST(small_and_large_coordinates) {
    static const double scales[4] = {1e-6, 1e6, 1e-20, 1e20};
    uint64_t seed = (uint64_t)_i;
    int i;
    for (i = 0; i < 4; i++) {
        workload w;
        gx_body *a, *b;
        random_seed(seed + 5);
        w = grid(2, 1, 1, 5);
        add_random_plane(&w, 10);
        add_random_plane(&w, 10);
        add_random_plane(&w, 0.3);
        a = cut_at_once(&w);
        transform(&w, scales[i], 0, NULL);
        b = cut_at_once(&w);
        expect_same(a, b, scales[i], 1e-8, 1e-13, "scaled", seed);
        gx_body_destroy(a);
        gx_body_destroy(b);
        wl_free(&w);
    }
}
END_TEST

/* Elements 2^13 times as long as wide; the near body is the same, stretched. */
START_TEST(long_elements) {
    uint64_t seed = (uint64_t)_i;
    workload w;
    gx_body *a, *b;
    gx_view p, q;
    size_t i, j;
    random_seed(seed + 9);
    w = grid(2, 1, 1, 5);
    add_random_plane(&w, 10);
    add_random_plane(&w, 10);
    add_axis_plane(&w, 0, 0.5);
    a = cut_at_once(&w);
    for (j = 0; j <= w.surface_count; j++) {
        double *x = j == w.surface_count ? w.positions : w.surfaces[j].vertices;
        for (i = 0; i < (j == w.surface_count ? w.node_count : w.surfaces[j].vertex_count); i++) x[3 * i] *= 8192;
    }
    b = cut_at_once(&w);
    CHECK_SEED(hash_of(a) == hash_of(b), seed);
    p = view_of(a);
    q = view_of(b);
    CHECK_SEED(p.cell_count == q.cell_count, seed);
    for (i = 0; i < p.cell_count; i++)
        CHECK_SEED(fabs(q.cell_volume[i] - 8192 * p.cell_volume[i]) <= 1e-9 * q.cell_volume[i], seed);
    check_cells(b, "long", seed);
    gx_body_destroy(a);
    gx_body_destroy(b);
    wl_free(&w);
}
END_TEST

/* ---- many cuts ---- */

/* Cuts in an order of their own leave trees as shallow as cuts in any other order, and the same leaves. */
START_TEST(ordered_cuts_make_no_chains) {
    enum { CUTS = 600 };
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    const gxb_complex *cx = body->complex;
    uint32_t i, n, depth;
    size_t c, k;
    gx_view view;
    for (c = 0; c < CUTS; c++) {
        add_axis_plane(&w, 0, ((double)c + 0.5) / CUTS);
        cut_by(body, &w, 0, 1);
        wl_free(&w);
        w = grid(1, 1, 1, 5);
    }
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, CUTS + 1);
    ck_assert_uint_eq(view.cell_count, 5 * (CUTS + 1));
    for (i = 0; i < cx->tree_count; i++) {
        uint32_t leaves = 0;
        for (depth = 1, n = cx->nodes[i].parent; n != GXB_NONE; n = cx->nodes[n].parent) depth++;
        ck_assert_uint_le(depth, 2 * 10 + 5);
        for (k = 0; k < 2; k++) {
            const uint32_t child = cx->nodes[i].child[k];
            if (child & 1) ck_assert_uint_eq(cx->nodes[child >> 1].parent, i);
            leaves += child & 1 ? cx->nodes[child >> 1].leaves : 1;
        }
        ck_assert_uint_eq(cx->nodes[i].leaves, leaves);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- the skin ---- */

/* In each fragment the triangles enclose its volume, at rest and after an affine map. Outer triangles lie in the
   mesh's surface. */
static void check_skin(gx_body *body, uint64_t seed) {
    /* determinant 0.953125 */
    static const double map[3][3] = {{1.25, 0.25, 0}, {0, 0.75, 0.125}, {0.5, 0, 1}};
    gx_view view = view_of(body);
    gx_skin skin;
    double *positions, *volume, *old;
    size_t i, f;
    int k, j, pass;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    positions = (double *)oracle_memory(NULL, 3 * skin.vertex_count + 1, sizeof *positions);
    volume = (double *)oracle_memory(NULL, view.fragment_count + 1, sizeof *volume);
    old = (double *)oracle_memory(NULL, 3 * view.copy_count + 1, sizeof *old);
    memcpy(old, view.displacement, 3 * view.copy_count * sizeof *old);
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < view.copy_count; i++)
            for (k = 0; k < 3; k++) {
                const double *x = body->mesh.positions + 3 * (size_t)view.copy_node[i];
                view.displacement[3 * i + (size_t)k] = 0;
                for (j = 0; j < 3 && pass == 1; j++)
                    view.displacement[3 * i + (size_t)k] += (map[k][j] - (k == j)) * x[j];
            }
        ck_assert_int_eq(gx_body_skin_positions(body, positions, NULL), GX_OK);
        for (f = 0; f < view.fragment_count; f++) volume[f] = 0;
        for (i = 0; i < skin.triangle_count; i++) {
            CHECK_SEED(skin.triangle_fragment[i] < view.fragment_count &&
                           skin.triangle_surface[i] <= body->cuts.surface_count,
                       seed);
            volume[skin.triangle_fragment[i]] += signed_volume(positions, skin.triangles + 3 * i, 1);
        }
        for (f = 0; f < view.fragment_count; f++) {
            double truth = view.fragment_volume[f] * (pass ? 0.953125 : 1);
            ck_assert_msg(fabs(volume[f] - truth) <= 1e-10 * truth + 1e-14 * view.volume,
                          "seed %llu: fragment %zu of %zu: skin %.17g, volume %.17g", (unsigned long long)seed, f,
                          view.fragment_count, volume[f], truth);
        }
    }
    memcpy(view.displacement, old, 3 * view.copy_count * sizeof *old);
    free(old);
    free(volume);
    free(positions);
}

START_TEST(skin_encloses_the_volume) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 4, 1);
    gx_body *body = body_of(&w);
    gx_skin skin;
    size_t c;
    check_skin(body, seed);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    for (c = 0; c < skin.triangle_count; c++) CHECK_SEED(skin.triangle_surface[c] == GX_SKIN_OUTER, seed);
    for (c = 0; c < w.surface_count; c++) {
        cut_by(body, &w, c, 1);
        check_skin(body, seed);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Area of the skin, cut faces and outer surface apart */
START_TEST(skin_tells_cut_faces) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_skin skin;
    double *x, area[3] = {0, 0, 0};
    size_t i;
    add_axis_plane(&w, 0, 0.375);
    add_box(&w, 1, 0.5, 0.25, 0.25, 0.75, 0.5, 0.5);
    body = cut_at_once(&w);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    x = (double *)oracle_memory(NULL, 3 * skin.vertex_count, sizeof *x);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (i = 0; i < skin.triangle_count; i++) {
        const double *a = x + 3 * skin.triangles[3 * i], *b = x + 3 * skin.triangles[3 * i + 1],
                     *c = x + 3 * skin.triangles[3 * i + 2];
        double sum = 0;
        int k;
        for (k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            double n = (b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]);
            sum += n * n;
        }
        area[skin.triangle_surface[i]] += sqrt(sum) / 2;
    }
    ck_assert_double_eq_tol(area[0], 6, 1e-13);
    ck_assert_double_eq_tol(area[1], 2, 1e-13);
    ck_assert_double_eq_tol(area[2], 6 * 0.0625, 1e-13);
    free(x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- many triangles in one element: leaves are divided by free planes, and only the number of leaves may show it
   ---- */

/* A ball of 2 n (n - 1) triangles; returns its volume. */
static double add_ball(workload *w, int solid, uint32_t n, const double center[3], double radius) {
    wl_surface *s = wl_add_surface(w, solid);
    double volume = 0;
    uint32_t i, j;
    size_t t;
    for (j = 0; j <= n; j++)
        for (i = 0; i < (j % n == 0 ? 1 : n); i++) {
            const double up = 3.14159265358979 * j / n, round = 6.28318530717958 * i / n;
            double x[3];
            x[0] = center[0] + radius * sin(up) * cos(round);
            x[1] = center[1] + radius * sin(up) * sin(round);
            x[2] = center[2] - radius * cos(up);
            wl_add_vertex(s, x);
        }
    for (j = 0; j < n; j++)
        for (i = 0; i < n; i++) {
            const uint32_t next = (i + 1) % n, low = j == 0 ? 0 : 1 + (j - 1) * n, high = 1 + j * n;
            if (j < n - 1) wl_add_triangle(s, low + (j == 0 ? 0 : i), high + next, high + i);
            if (j > 0) wl_add_triangle(s, low + i, low + next, j == n - 1 ? high : high + next);
        }
    for (t = 0; t < s->triangle_count; t++) {
        const double *a = s->vertices + 3 * s->triangles[3 * t], *b = s->vertices + 3 * s->triangles[3 * t + 1],
                     *c = s->vertices + 3 * s->triangles[3 * t + 2];
        double p[3], q[3], r[3];
        int k;
        for (k = 0; k < 3; k++) {
            p[k] = a[k] - center[k];
            q[k] = b[k] - center[k];
            r[k] = c[k] - center[k];
        }
        volume += (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
                   p[2] * (q[0] * r[1] - q[1] * r[0])) /
                  6;
    }
    return volume;
}

/* The reference is a fine mesh with few triangles in each element. */
START_TEST(cap_in_large_and_small_elements) {
    workload large = grid(1, 1, 1, 5), small = grid(14, 14, 14, 5);
    gx_body *a, *b;
    gx_view p, q;
    size_t i;
    for (i = 0; i < 3 * small.node_count; i++) small.positions[i] /= 14;
    add_cap(&large, 28, _i);
    add_cap(&small, 28, _i);
    a = cut_at_once(&large);
    b = cut_at_once(&small);
    ck_assert_uint_gt(free_planes(a), 20);
    ck_assert_uint_eq(free_planes(b), 0);
    p = view_of(a);
    q = view_of(b);
    ck_assert_uint_eq(p.cell_count, 10);
    ck_assert_uint_eq(p.fragment_count, 2);
    ck_assert_uint_eq(q.fragment_count, 2);
    ck_assert_double_eq_tol(fmin(p.fragment_volume[0], p.fragment_volume[1]),
                            fmin(q.fragment_volume[0], q.fragment_volume[1]), 1e-13);
    ck_assert_double_eq_tol(fmax(p.fragment_volume[0], p.fragment_volume[1]),
                            fmax(q.fragment_volume[0], q.fragment_volume[1]), 1e-13);
    check_cells(a, "cap", (uint64_t)_i);
    check_skin(a, (uint64_t)_i);
    gx_body_destroy(a);
    gx_body_destroy(b);
    wl_free(&large);
    wl_free(&small);
}
END_TEST

/* A ball inside one element, as a sheet and as a solid, and the sheet cut again */
START_TEST(ball_in_one_element) {
    static const double center[3] = {0.2511, 0.2437, 0.2544};
    workload w = corner_tet();
    const double ball = add_ball(&w, 0, 24, center, 0.13), whole = 1.0 / 6;
    gx_body *body;
    gx_cut_report report;
    gx_view view;
    add_axis_plane(&w, 1, center[1]);
    body = body_of(&w);
    cut_by(body, &w, 0, 1);
    view = view_of(body);
    ck_assert_uint_gt(free_planes(body), 20);
    ck_assert_uint_eq(view.cell_count, 2);
    ck_assert_uint_eq(view.fragment_count, 2);
    ck_assert_double_eq_tol(fmin(view.cell_volume[0], view.cell_volume[1]), ball, 1e-14);
    ck_assert_double_eq_tol(view.volume, whole, 1e-14);
    check_cells(body, "ball", 0);
    cut_by(body, &w, 1, 1);
    view = view_of(body);
    ck_assert_uint_eq(view.cell_count, 4);
    ck_assert_double_eq_tol(view.volume, whole, 1e-14);
    gx_body_destroy(body);
    wl_free(&w);
    w = corner_tet();
    add_ball(&w, 1, 24, center, 0.13);
    body = body_of(&w);
    report = cut_by(body, &w, 0, 1);
    ck_assert_uint_gt(free_planes(body), 20);
    ck_assert_double_eq_tol(report.removed_volume, ball, 1e-14);
    ck_assert_double_eq_tol(view_of(body).volume, whole - ball, 1e-14);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Four times the triangles take hardly more than four times the signs. */
START_TEST(cost_of_many_triangles) {
    uint64_t calls[2];
    int i;
    for (i = 0; i < 2; i++) {
        workload w = corner_tet();
        gx_body *body;
        add_cap(&w, i == 0 ? 20 : 40, 2);
        body = cut_at_once(&w);
        calls[i] = body->complex->store.filter_calls;
        gx_body_destroy(body);
        wl_free(&w);
    }
    ck_assert_msg(calls[1] < 8 * calls[0], "%.0f and %.0f", (double)calls[0], (double)calls[1]);
}
END_TEST

/* A box whose sides are divided into n x n uneven squares of two triangles each: lattice points, so that each side is
   exactly flat */
static void add_divided_box(workload *w, int solid, uint32_t n) {
    wl_surface *s = wl_add_surface(w, solid);
    uint32_t side, i, j;
    for (side = 0; side < 6; side++) {
        const uint32_t axis = side % 3, top = side / 3, first = (uint32_t)s->vertex_count;
        for (j = 0; j <= n; j++)
            for (i = 0; i <= n; i++) {
                const int inner = i > 0 && j > 0 && i < n && j < n;
                double x[3];
                x[axis] = top ? 0.3125 : 0.0625;
                x[(axis + 1) % 3] = 0.0625 + 0.25 * (i + (inner ? (i * 5 + j * 3) % 8 / 16.0 : 0)) / n;
                x[(axis + 2) % 3] = 0.0625 + 0.25 * (j + (inner ? (i * 3 + j * 7) % 8 / 16.0 : 0)) / n;
                wl_add_vertex(s, x);
            }
        for (j = 0; j < n; j++)
            for (i = 0; i < n; i++) {
                const uint32_t a = first + j * (n + 1) + i, b = a + n + 1;
                wl_add_triangle(s, a, top ? a + 1 : b + 1, top ? b + 1 : a + 1);
                wl_add_triangle(s, a, top ? b + 1 : b, top ? b : b + 1);
            }
    }
}

/* Thousands of triangles in one plane: all of it is covered, in proportion to their number. */
START_TEST(many_triangles_in_one_plane) {
    static const double box = 1.0 / 64, whole = 1.0 / 6;
    uint64_t calls[2];
    int i, solid;
    for (solid = 0; solid < 2; solid++)
        for (i = 0; i < 2; i++) {
            workload w = corner_tet();
            gx_body *body = body_of(&w);
            gx_cut_report report;
            gx_view view;
            add_divided_box(&w, solid, i == 0 ? 6 : 12);
            report = cut_by(body, &w, 0, 1);
            calls[i] = body->complex->store.filter_calls;
            view = view_of(body);
            ck_assert_uint_eq(view.cell_count, solid ? 1 : 2);
            ck_assert_double_eq_tol(view.volume, solid ? whole - box : whole, 1e-14);
            ck_assert_double_eq_tol(report.removed_volume, solid ? box : 0, 1e-15);
            if (i == 0) check_skin(body, (uint64_t)solid);
            if (i == 0 && !solid) { /* again: all of it is there, in facets that are older than this cut */
                report = cut_by(body, &w, 0, 1);
                ck_assert_uint_eq(report.created_cells, 0);
                ck_assert_uint_eq(view_of(body).cell_count, 2);
            }
            gx_body_destroy(body);
            wl_free(&w);
            if (i == 1) ck_assert_msg(calls[1] < 8 * calls[0], "%.0f and %.0f", (double)calls[0], (double)calls[1]);
        }
}
END_TEST

/* ---- bad input ---- */

static void expect_no_body(gx_body_desc *desc, gx_result expected, const char *field, size_t index, int line) {
    gx_body *body = NULL;
    gx_failure failure;
    gx_result result = gx_body_create(desc, &body, &failure);
    ck_assert_msg(result == expected && failure.result == expected, "line %d: %s, should be: %s", line,
                  gx_result_text(result), gx_result_text(expected));
    ck_assert_msg(failure.index == index && strcmp(failure.field, field) == 0, "line %d: %s %zu, should be %s %zu",
                  line, failure.field, failure.index, field, index);
    ck_assert(body == NULL);
    ck_assert_int_eq(gx_body_create(desc, &body, NULL), (int)expected);
}
#define EXPECT_NO_BODY(desc, expected, field, index) expect_no_body(desc, expected, field, index, __LINE__)

START_TEST(bad_bodies) {
    workload w = grid(2, 1, 1, 5);
    gx_body_desc good = desc_of(&w), d;
    gx_body *body;
    float *texture = (float *)oracle_memory(NULL, 2 * w.node_count, sizeof *texture);
    uint32_t *e = (uint32_t *)oracle_memory(NULL, 4 * w.element_count + 4, sizeof *e);
    double *x = (double *)oracle_memory(NULL, 3 * w.node_count, sizeof *x), bad[3];
    int i;
    memset(texture, 0, 2 * w.node_count * sizeof *texture);
    texture[5] = NAN;
    ck_assert_int_eq(gx_body_create(NULL, &body, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_create(&good, NULL, NULL), GX_ERROR_ARGUMENT);
    d = good;
    d.positions = NULL;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "positions", SIZE_MAX);
    d = good;
    d.elements = NULL;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "elements", SIZE_MAX);
    d = good;
    d.node_count = 0;
    EXPECT_NO_BODY(&d, GX_ERROR_EMPTY, "node_count", SIZE_MAX);
    d = good;
    d.element_count = 0;
    EXPECT_NO_BODY(&d, GX_ERROR_EMPTY, "element_count", SIZE_MAX);
    d = good;
    d.young = 0;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "young", SIZE_MAX);
    d = good;
    d.young = -1;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "young", SIZE_MAX);
    d = good;
    d.young = NAN;
    EXPECT_NO_BODY(&d, GX_ERROR_NOT_FINITE, "young", SIZE_MAX);
    d = good;
    d.density = 0;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "density", SIZE_MAX);
    d = good;
    d.density = INFINITY;
    EXPECT_NO_BODY(&d, GX_ERROR_NOT_FINITE, "density", SIZE_MAX);
    d = good;
    d.poisson = 0.5;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "poisson", SIZE_MAX);
    d = good;
    d.poisson = -0.1;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "poisson", SIZE_MAX);
    d = good;
    d.material_count = 1;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "materials", SIZE_MAX);
    d = good;
    d.texture = texture;
    EXPECT_NO_BODY(&d, GX_ERROR_NOT_FINITE, "texture", 2);
    d = good;
    d.allocator.allocate = (void *(*)(void *, size_t))1;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "allocator", SIZE_MAX);
    d = good;
    d.allocator.reallocate = (void *(*)(void *, void *, size_t, size_t))1;
    EXPECT_NO_BODY(&d, GX_ERROR_ARGUMENT, "allocator", SIZE_MAX);
    memcpy(e, w.elements, 4 * w.element_count * sizeof *e);
    memcpy(x, w.positions, 3 * w.node_count * sizeof *x);
    d = good;
    d.elements = e;
    d.positions = x;
    e[4 * 3 + 2] = (uint32_t)w.node_count;
    EXPECT_NO_BODY(&d, GX_ERROR_INDEX, "elements", 3);
    e[4 * 3 + 2] = UINT32_MAX;
    EXPECT_NO_BODY(&d, GX_ERROR_INDEX, "elements", 3);
    memcpy(e, w.elements, 4 * w.element_count * sizeof *e);
    e[4 * 7] = w.elements[4 * 7 + 1];
    e[4 * 7 + 1] = w.elements[4 * 7];
    EXPECT_NO_BODY(&d, GX_ERROR_INVERTED, "elements", 7);
    e[4 * 7] = e[4 * 7 + 1];
    EXPECT_NO_BODY(&d, GX_ERROR_FLAT, "elements", 7);
    memcpy(e, w.elements, 4 * w.element_count * sizeof *e);
    bad[0] = NAN;
    bad[1] = INFINITY;
    bad[2] = -INFINITY;
    for (i = 0; i < 3; i++) {
        x[3 * 5 + i] = bad[i];
        EXPECT_NO_BODY(&d, GX_ERROR_NOT_FINITE, "positions", 5);
        x[3 * 5 + i] = w.positions[3 * 5 + i];
    }
    /* an element twice: its faces are shared by two on one side */
    memcpy(e, w.elements, 4 * w.element_count * sizeof *e);
    memcpy(e + 4 * w.element_count, e + 4 * 2, 4 * sizeof *e);
    d.element_count = w.element_count + 1;
    {
        gx_failure failure;
        ck_assert_int_eq(gx_body_create(&d, &body, &failure), GX_ERROR_OVERLAP);
        ck_assert(failure.index == 2 || failure.index == w.element_count);
    }
    free(e);
    free(x);
    free(texture);
    wl_free(&w);
    { /* four nodes in a plane */
        static const double flat[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
        static const uint32_t n[4] = {0, 1, 2, 3};
        d = good;
        d.positions = &flat[0][0];
        d.node_count = 4;
        d.elements = n;
        d.element_count = 1;
        EXPECT_NO_BODY(&d, GX_ERROR_FLAT, "elements", 0);
    }
    { /* a coordinate far too small beside the others */
        static const double tiny[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-60, 0, 1}};
        static const uint32_t n[4] = {0, 1, 2, 3};
        d = good;
        d.positions = &tiny[0][0];
        d.node_count = 4;
        d.elements = n;
        d.element_count = 1;
        EXPECT_NO_BODY(&d, GX_ERROR_RANGE, "positions", 3);
    }
}
END_TEST

/* Elements so flat that their volume, exactly positive, is negative in doubles. Such a body would have a negative
   mass, or could not be stepped. */
START_TEST(volumes_that_round_below_zero) {
    static const uint32_t n[4] = {0, 1, 2, 3};
    workload w = corner_tet();
    gx_body_desc d = desc_of(&w);
    int found = 0, i, k;
    gx_body *body;
    gxs_model model;
    gx_result result;
    d.elements = n;
    random_seed(11);
    for (i = 0; i < 2000; i++) {
        double x[12], s = random_real(0, 1), t = random_real(0, 1);
        for (k = 0; k < 9; k++) x[k] = random_real(0, 1);
        for (k = 0; k < 3; k++) x[9 + k] = x[k] + s * (x[3 + k] - x[k]) + t * (x[6 + k] - x[k]);
        if (gxb_orient3d(x, x + 3, x + 6, x + 9) >= 0) continue;
        d.positions = x;
        if (gxi_tet_volume(x) <= 0) {
            EXPECT_NO_BODY(&d, GX_ERROR_FLAT, "elements", 0);
            found++;
        }
        body = NULL;
        result = gx_body_create(&d, &body, NULL);
        ck_assert(result == GX_OK || result == GX_ERROR_FLAT);
        if (result == GX_OK) result = gx_body_model(body, &model, NULL);
        ck_assert_int_ne(result, GX_ERROR_INVERTED);
        gx_body_destroy(body);
    }
    ck_assert(found > 0 || FLT_EVAL_METHOD != 0);
    wl_free(&w);
}
END_TEST

/* ---- ranges ---- */

static int is_number(double x) { return isfinite(x) && (fabs(x) >= DBL_MIN || x == 0); }

/* All numbers that a body reports */
static void expect_numbers(gx_body *body) {
    gx_view view = view_of(body);
    gx_motion motions[4];
    gx_skin skin;
    float *drawn;
    size_t i, k;
    ck_assert(is_number(view.volume) && view.volume > 0 && is_number(view.mass) && view.mass > 0);
    for (i = 0; i < view.cell_count; i++) ck_assert(is_number(view.cell_volume[i]) && view.cell_volume[i] > 0);
    ck_assert_int_eq(gx_body_motion(body, motions, 4, NULL), GX_OK);
    for (i = 0; i < view.fragment_count; i++) {
        ck_assert(is_number(view.fragment_volume[i]) && is_number(view.fragment_mass[i]));
        for (k = 0; k < 3; k++) ck_assert(is_number(view.fragment_center[3 * i + k]));
        for (k = 0; k < 6; k++)
            ck_assert(is_number(view.fragment_inertia[6 * i + k]) && is_number(motions[i].inertia[k]));
        ck_assert(view.fragment_inertia[6 * i] > 0 && motions[i].mass > 0 && is_number(motions[i].mass));
    }
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    drawn = (float *)oracle_memory(NULL, 3 * skin.vertex_count, sizeof *drawn);
    ck_assert_int_eq(gx_body_skin_vertices(body, NULL, drawn, NULL, NULL), GX_OK);
    for (i = 0; i < 3 * skin.vertex_count; i++) {
        const double x = skin.vertex_rest[i];
        ck_assert(isfinite(drawn[i]) && fabs((double)drawn[i] - x) <= FLT_EPSILON * fabs(x));
    }
    free(drawn);
}

/* A body within the limits reports only finite numbers, at the smallest and largest masses. Others are refused. */
START_TEST(bodies_are_numbers_or_refused) {
    static const int powers[17] = {-1022, -600, -400, -350, -101, -100, -50, 0,   50,
                                   99,    100,  101,  333,  345,  400,  700, 1000};
    const int e = powers[_i];
    workload w = corner_tet();
    gx_body_desc desc;
    size_t i;
    int heavy;
    add_axis_plane(&w, 2, 0.25);
    for (i = 0; i < 3 * w.node_count; i++) w.positions[i] = ldexp(w.positions[i], e);
    for (i = 0; i < 3 * w.surfaces[0].vertex_count; i++)
        w.surfaces[0].vertices[i] = ldexp(w.surfaces[0].vertices[i], e);
    desc = desc_of(&w);
    if (e > 100) EXPECT_NO_BODY(&desc, GX_ERROR_RANGE, "positions", 1);
    if (e < -100) EXPECT_NO_BODY(&desc, GX_ERROR_RANGE, "positions", SIZE_MAX);
    for (heavy = -1; heavy <= 1 && e >= -100 && e <= 100; heavy++) {
        gx_body *body = NULL;
        desc.density = heavy == 0 ? 1000 : 6 * ldexp(1, 700 * heavy - 3 * e);
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        expect_numbers(body);
        cut_by(body, &w, 0, 1);
        ck_assert_uint_eq(view_of(body).fragment_count, 2);
        expect_numbers(body);
        gx_body_destroy(body);
        if (heavy == 0) continue;
        desc.density *= heavy > 0 ? 1.001 : 0.999;
        EXPECT_NO_BODY(&desc, GX_ERROR_RANGE, "elements", 0);
    }
    wl_free(&w);
}
END_TEST

/* The node that is too far out; the element that is too heavy or too light */
START_TEST(what_is_out_of_range_is_named) {
    workload w = grid(2, 1, 1, 5);
    gx_material materials[3];
    uint32_t of[10] = {0};
    gx_body_desc desc = desc_of(&w);
    int i;
    memset(materials, 0, sizeof materials);
    for (i = 0; i < 3; i++) {
        materials[i].elastic.young = 1;
        materials[i].density = i == 0 ? 1 : i == 1 ? 1e300 : 1e-300;
    }
    desc.materials = materials;
    desc.material_count = 3;
    desc.element_materials = of;
    for (i = 1; i < 3; i++) {
        of[7] = (uint32_t)i;
        EXPECT_NO_BODY(&desc, GX_ERROR_RANGE, "elements", 7);
        of[7] = 0;
    }
    wl_free(&w);
    w = corner_tet();
    desc = desc_of(&w);
    for (i = 0; i < 3; i++) {
        double *const x = w.positions + 3 * (i + 1) + i;
        *x = 0x1.000001p100;
        EXPECT_NO_BODY(&desc, GX_ERROR_RANGE, "positions", (size_t)i + 1);
        *x = 1;
    }
    wl_free(&w);
}
END_TEST

/* A displacement or velocity too large for the numbers of a motion. Each of these may overflow by itself. */
START_TEST(motions_are_numbers_or_refused) {
    static const double far[3] = {1e200, 1e308, 1e140};
    workload w = corner_tet();
    gx_body *body = body_of(&w);
    gx_view view = view_of(body);
    gx_motion motion;
    int i;
    for (i = 0; i < 3; i++) {
        view.displacement[3 * i] = far[i];
        ck_assert_int_eq(gx_body_motion(body, &motion, 1, NULL), i == 2 ? GX_OK : GX_ERROR_RANGE);
        view.displacement[3 * i] = 0;
        view.velocity[3 * i + 1] = -far[i];
        ck_assert_int_eq(gx_body_motion(body, &motion, 1, NULL), i == 2 ? GX_OK : GX_ERROR_RANGE);
        view.velocity[3 * i + 1] = i == 1 ? NAN : INFINITY;
        ck_assert_int_eq(gx_body_motion(body, &motion, 1, NULL), GX_ERROR_NOT_FINITE);
        view.velocity[3 * i + 1] = 0;
        ck_assert_int_eq(gx_body_motion(body, &motion, 1, NULL), GX_OK);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A node that no element uses has no copy. */
START_TEST(unused_nodes) {
    static const double x[6][3] = {{5, 5, 5}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-7, 0, 0}};
    static const uint32_t n[4] = {1, 2, 3, 4};
    workload w = corner_tet();
    gx_body_desc d = desc_of(&w);
    gx_body *body;
    gx_skin skin;
    gx_step_desc step = still_step();
    d.positions = &x[0][0];
    d.node_count = 6;
    d.elements = n;
    ck_assert_int_eq(gx_body_create(&d, &body, NULL), GX_OK);
    ck_assert_uint_eq(view_of(body).copy_count, 4);
    add_axis_plane(&w, 0, 0.25);
    cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(view_of(body).copy_count, 8);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    check_skin(body, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static void expect_no_cut(gx_body *body, const gx_cut_desc *desc, gx_result expected, const char *field, size_t index,
                          size_t surface, int line) {
    uint64_t state = gx_body_state_hash(body), hash = hash_of(body);
    gx_failure failure;
    gx_cut_report report, untouched;
    gx_result result;
    memset(&report, 0x55, sizeof report);
    untouched = report;
    result = gx_body_cut(body, desc, &report, &failure);
    ck_assert_msg(result == expected && failure.result == expected, "line %d: %s, should be: %s", line,
                  gx_result_text(result), gx_result_text(expected));
    ck_assert_msg(strcmp(failure.field, field) == 0, "line %d: %s, should be %s", line, failure.field, field);
    ck_assert_msg(failure.index == index && failure.surface == surface,
                  "line %d: index %zu of surface %zu, should be %zu of %zu", line, failure.index, failure.surface,
                  index, surface);
    ck_assert(gx_body_state_hash(body) == state && hash_of(body) == hash);
    ck_assert(memcmp(&report, &untouched, sizeof report) == 0);
}
#define EXPECT_NO_CUT(expected, field, index, surface)                                                                 \
    expect_no_cut(body, &desc, expected, field, index, surface, __LINE__)

START_TEST(bad_cuts) {
    static const double v[9] = {-4, -4, 0.25, 4, -4, 0.25, 0, 4, 0.25};
    static const uint32_t n[6] = {0, 1, 2, 0, 1, 2};
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_surface good, s[2];
    gx_cut_desc desc;
    double x[9], bad[3];
    float texture[6] = {0, 0, 0, 0, 0, 0};
    uint32_t t[6], i;
    add_axis_plane(&w, 0, 0.5);
    body = cut_at_once(&w);
    memset(&good, 0, sizeof good);
    good.vertices = v;
    good.vertex_count = 3;
    good.triangles = n;
    good.triangle_count = 2;
    s[0] = s[1] = good;
    memset(&desc, 0, sizeof desc);
    ck_assert_int_eq(gx_body_cut(NULL, &desc, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_cut(body, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    desc.surface_count = 2;
    EXPECT_NO_CUT(GX_ERROR_ARGUMENT, "surfaces", SIZE_MAX, SIZE_MAX);
    desc.surfaces = s;
    desc.surface_count = 0;
    EXPECT_NO_CUT(GX_ERROR_EMPTY, "surface_count", SIZE_MAX, SIZE_MAX);
    desc.surface_count = 2;
    desc.sever_below = NAN;
    EXPECT_NO_CUT(GX_ERROR_NOT_FINITE, "sever_below", SIZE_MAX, SIZE_MAX);
    desc.sever_below = -1e-300;
    EXPECT_NO_CUT(GX_ERROR_ARGUMENT, "sever_below", SIZE_MAX, SIZE_MAX);
    desc.sever_below = 1 + DBL_EPSILON;
    EXPECT_NO_CUT(GX_ERROR_ARGUMENT, "sever_below", SIZE_MAX, SIZE_MAX);
    desc.sever_below = 0;
    s[1] = good;
    s[1].kind = GX_SURFACE_MATERIAL + 1;
    EXPECT_NO_CUT(GX_ERROR_ARGUMENT, "surfaces.kind", SIZE_MAX, 1);
    s[1] = good;
    s[1].vertices = NULL;
    EXPECT_NO_CUT(GX_ERROR_ARGUMENT, "surfaces.vertices", SIZE_MAX, 1);
    s[1] = good;
    s[1].triangles = NULL;
    EXPECT_NO_CUT(GX_ERROR_ARGUMENT, "surfaces.triangles", SIZE_MAX, 1);
    s[1] = good;
    s[1].vertex_count = 0;
    EXPECT_NO_CUT(GX_ERROR_EMPTY, "surfaces.vertex_count", SIZE_MAX, 1);
    s[1] = good;
    s[1].triangle_count = 0;
    EXPECT_NO_CUT(GX_ERROR_EMPTY, "surfaces.triangle_count", SIZE_MAX, 1);
    s[1] = good;
    s[1].triangles = t;
    memcpy(t, n, sizeof t);
    t[4] = 3;
    EXPECT_NO_CUT(GX_ERROR_INDEX, "surfaces.triangles", 1, 1);
    s[1] = good;
    s[1].vertices = x;
    bad[0] = NAN;
    bad[1] = INFINITY;
    bad[2] = -INFINITY;
    for (i = 0; i < 3; i++) {
        memcpy(x, v, sizeof x);
        x[6 + i] = bad[i];
        EXPECT_NO_CUT(GX_ERROR_NOT_FINITE, "surfaces.vertices", 2, 1);
    }
    memcpy(x, v, sizeof x);
    x[2] = 1e-60;
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 0, 1);
    memcpy(x, v, sizeof x);
    x[3] = 1e60;
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 1, 1);
    memcpy(x, v, sizeof x);
    x[3] = 1e200;
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 1, 1);
    memcpy(x, v, sizeof x);
    x[3] = DBL_MAX;
    x[7] = DBL_MAX;
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 1, 1);
    for (i = 0; i < 9; i++) x[i] = v[i] + 40; /* far away, and used by no triangle */
    s[1].triangle_count = 1;
    x[2] = 1e-60;
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 0, 1);
    x[2] = 40;
    for (i = 0; i < 9; i++) x[i] *= 1e60;
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 0, 1);
    for (i = 0; i < 9; i++) x[i] = 1e300 + 1e299 * v[i];
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 0, 1);
    for (i = 0; i < 9; i++) x[i] = v[i] + 40;
    s[1].triangles = t;
    t[0] = t[1] = t[2] = 0;
    x[8] = -1e300;
    EXPECT_NO_CUT(GX_ERROR_RANGE, "surfaces.vertices", 2, 1);
    s[1] = good;
    s[1].texture = texture;
    for (i = 0; i < 6; i++) {
        texture[i] = (float)bad[i % 3];
        EXPECT_NO_CUT(GX_ERROR_NOT_FINITE, "surfaces.texture", i / 2, 1);
        texture[i] = 0;
    }
    s[1] = good;
    s[1].kind = GX_SURFACE_SOLID;
    EXPECT_NO_CUT(GX_ERROR_NOT_CLOSED, "surfaces.triangles", 0, 1);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(bad_arguments_elsewhere) {
    workload w = corner_tet();
    gx_body *body = body_of(&w);
    gx_region region = gx_region_half_space(0, 1, 0.5), bad;
    gx_step_desc step = still_step(), s;
    gx_view view = view_of(body);
    gx_skin skin;
    gx_failure failure;
    double forces[12];
    uint64_t state;
    memset(forces, 0, sizeof forces);
    ck_assert_int_eq(gx_body_hold(body, &region, 1, NULL), GX_OK);
    state = gx_body_state_hash(body);
    ck_assert_int_eq(gx_body_view(NULL, &view, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_view(body, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_skin(NULL, NULL, &skin, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_skin(body, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_hold(NULL, &region, 1, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_hold(body, NULL, 1, NULL), GX_ERROR_ARGUMENT);
    bad = region;
    bad.axis = 3;
    ck_assert_int_eq(gx_body_hold(body, &bad, 1, NULL), GX_ERROR_ARGUMENT);
    bad = region;
    bad.side = 0;
    ck_assert_int_eq(gx_body_hold(body, &bad, 1, NULL), GX_ERROR_ARGUMENT);
    bad = region;
    bad.value = NAN;
    ck_assert_int_eq(gx_body_hold(body, &bad, 1, NULL), GX_ERROR_NOT_FINITE);
    ck_assert_int_eq(gx_body_step(NULL, &step, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_step(body, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    s = step;
    s.dt = 0;
    ck_assert_int_eq(gx_body_step(body, &s, NULL, NULL), GX_ERROR_ARGUMENT);
    s = step;
    s.dt = -1;
    ck_assert_int_eq(gx_body_step(body, &s, NULL, NULL), GX_ERROR_ARGUMENT);
    s = step;
    s.dt = NAN;
    ck_assert_int_eq(gx_body_step(body, &s, NULL, NULL), GX_ERROR_NOT_FINITE);
    s = step;
    s.gravity[1] = INFINITY;
    ck_assert_int_eq(gx_body_step(body, &s, NULL, NULL), GX_ERROR_NOT_FINITE);
    s = step;
    s.forces = forces;
    forces[7] = NAN;
    ck_assert_int_eq(gx_body_step(body, &s, NULL, NULL), GX_ERROR_NOT_FINITE);
    ck_assert(gx_body_topology_hash(NULL, &failure) == 0);
    ck_assert_int_eq(failure.result, GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "body");
    ck_assert(gx_body_state_hash(body) == state);
    view.displacement[0] = NAN;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_ERROR_NOT_FINITE);
    view.displacement[0] = 0;
    ck_assert(gx_body_state_hash(body) == state);
    gx_body_destroy(body);
    gx_body_destroy(NULL);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("body");
    TCase *tests = tcase_create("body");
    const char *only = getenv("GXFEM_SEED");
    int first = only != NULL ? atoi(only) : 0, last = only != NULL ? first + 1 : SEEDS, result;
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, field_is_unchanged_by_cuts, first, last);
    tcase_add_loop_test(tests, skin_follows_the_field, first, last);
    tcase_add_loop_test(tests, sheets_conserve_mass_and_volume, first, last);
    tcase_add_loop_test(tests, solids_remove_what_they_report, first, last);
    tcase_add_loop_test(tests, sequence_equals_at_once, first, last);
    tcase_add_loop_test(tests, order_does_not_matter, first, last);
    tcase_add_loop_test(tests, scale_and_rotation_do_not_matter, first, last);
    tcase_add_loop_test(tests, same_cut_twice_changes_nothing, first, last);
    tcase_add_test(tests, touched_elements_count_once);
    tcase_add_test(tests, cuts_one_ulp_apart);
    tcase_add_test(tests, cuts_in_element_faces);
    tcase_add_test(tests, cuts_through_nodes_and_edges);
    tcase_add_test(tests, three_planes_through_a_line_and_a_point);
    tcase_add_test(tests, tangent_cuts_do_nothing);
    tcase_add_test(tests, sheet_that_ends_inside_an_element);
    tcase_add_test(tests, sheet_that_ends_between_elements);
    tcase_add_test(tests, sheets_may_reach_far);
    tcase_add_test(tests, severed_links);
    tcase_add_test(tests, closed_sheets_make_cells);
    tcase_add_test(tests, sheet_with_a_hole);
    tcase_add_test(tests, self_crossing_folded_and_duplicate);
    tcase_add_test(tests, nothing_but_flat_triangles);
    tcase_add_test(tests, a_thousand_parallel_cuts);
    tcase_add_test(tests, three_times_twenty_planes);
    tcase_add_test(tests, slivers);
    tcase_add_loop_test(tests, slivers_in_general_position, first, last);
    tcase_add_loop_test(tests, wedges, first, last);
    tcase_add_loop_test(tests, scope_of_a_solid, first, last);
    tcase_add_test(tests, thin_solid);
    tcase_add_test(tests, scope_of_a_cut);
    tcase_add_test(tests, scope_of_everything_and_of_nothing);
    tcase_add_test(tests, solids_remove);
    tcase_add_test(tests, solids_with_coincident_faces);
    tcase_add_test(tests, solids_that_contain_everything);
    tcase_add_test(tests, solids_without_volume_do_nothing);
    tcase_add_test(tests, open_solids_are_refused);
    tcase_add_test(tests, triangle_soup_can_be_closed);
    tcase_add_test(tests, solidified_sheets);
    tcase_add_loop_test(tests, solidified_sheets_are_closed, first, last);
    tcase_add_test(tests, solidified_sheets_of_any_size);
    tcase_add_test(tests, pinched_meshes);
    tcase_add_test(tests, cuts_that_only_touch_a_pinch);
    tcase_add_test(tests, scopes_at_a_pinch);
    tcase_add_test(tests, solid_around_a_pinch);
    tcase_add_loop_test(tests, held_copies, first, last);
    tcase_add_test(tests, pieces_outside_the_region_are_free);
    tcase_add_loop_test(tests, nothing_is_left_to_step, 0, 2);
    tcase_add_loop_test(tests, free_bodies_keep_their_momentum, first, last);
    tcase_add_test(tests, fragments_fall);
    tcase_add_test(tests, held_body_hangs);
    tcase_add_test(tests, sticks_drift_apart);
    tcase_add_loop_test(tests, violent_steps_stay_finite, first, last);
    tcase_add_test(tests, forces_act_on_copies);
    tcase_add_test(tests, far_from_the_origin_exactly);
    tcase_add_loop_test(tests, far_from_the_origin_rounded, first, last);
    tcase_add_loop_test(tests, small_and_large_coordinates, first, last);
    tcase_add_loop_test(tests, long_elements, first, last);
    tcase_add_test(tests, ordered_cuts_make_no_chains);
    tcase_add_loop_test(tests, cap_in_large_and_small_elements, 0, 3);
    tcase_add_test(tests, ball_in_one_element);
    tcase_add_test(tests, cost_of_many_triangles);
    tcase_add_test(tests, many_triangles_in_one_plane);
    tcase_add_loop_test(tests, skin_encloses_the_volume, first, last);
    tcase_add_test(tests, skin_tells_cut_faces);
    tcase_add_test(tests, bad_bodies);
    tcase_add_test(tests, volumes_that_round_below_zero);
    tcase_add_loop_test(tests, bodies_are_numbers_or_refused, 0, 17);
    tcase_add_test(tests, what_is_out_of_range_is_named);
    tcase_add_test(tests, motions_are_numbers_or_refused);
    tcase_add_test(tests, unused_nodes);
    tcase_add_test(tests, bad_cuts);
    tcase_add_test(tests, bad_arguments_elsewhere);
    suite_add_tcase(suite, tests);
    result = run_suite(suite);
    rat_arena_free();
    return result;
}
