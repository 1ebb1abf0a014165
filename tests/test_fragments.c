/* test_fragments.c - what the library reports about fragments: ids that last, changes by cuts, inertia, motion. The
   oracle for ids is the displacement field, which no cut changes: each fragment is moved by a number of its own, and
   its parts show it. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "body.h"

/* ---- an oracle of changes ---- */

enum { MOST = 4096 };

/* volumes: a sum that tells lists of cells apart */
typedef struct piece {
    uint32_t id, cells;
    double mass, volumes;
} piece;

typedef struct record { /* of the last snapshot */
    piece pieces[MOST];
    size_t count;
    uint32_t largest; /* id so far */
} record;

static piece piece_of(const gx_view *v, size_t fragment) {
    piece p;
    size_t i;
    p.id = v->fragment_id[fragment];
    p.cells = 0;
    p.mass = v->fragment_mass[fragment];
    p.volumes = 0;
    for (i = 0; i < v->cell_count; i++) {
        if (v->cell_fragment[i] != fragment) continue;
        p.cells++;
        p.volumes += v->cell_volume[i] * (double)(1 + v->cell_element[i] * 31 % 17);
    }
    return p;
}

/* Remembers the fragments and moves each by its index. */
static void remember(record *m, const gx_view *v) {
    size_t i, k;
    ck_assert_uint_lt(v->fragment_count, MOST);
    m->count = v->fragment_count;
    for (i = 0; i < v->fragment_count; i++) {
        m->pieces[i] = piece_of(v, i);
        if (v->fragment_id[i] > m->largest) m->largest = v->fragment_id[i];
    }
    for (i = 0; i < v->cell_count; i++)
        for (k = 0; k < 4; k++) {
            double *u = v->displacement + 3 * v->cell_copies[4 * i + k];
            u[0] = u[1] = u[2] = (double)v->cell_fragment[i];
        }
}

/* Index, in the last snapshot, of the fragment of which this one was a part */
static size_t origin_of(const gx_view *v, size_t fragment, uint64_t seed) {
    size_t i, k, origin = SIZE_MAX;
    for (i = 0; i < v->cell_count; i++)
        for (k = 0; k < 4; k++) {
            const double *u = v->displacement + 3 * v->cell_copies[4 * i + k];
            if (v->cell_fragment[i] != fragment) continue;
            CHECK_SEED(origin == SIZE_MAX || (double)origin == u[0], seed);
            origin = (size_t)u[0];
        }
    return origin;
}

static int is_listed(const gx_view *v, uint32_t id) {
    size_t i;
    int count = 0;
    for (i = 0; i < v->removed_count; i++) count += v->removed_ids[i] == id;
    return count;
}

static void check_change(const record *m, const gx_view *v, int touched, uint64_t seed) {
    static size_t origin[MOST], heaviest[MOST], pieces[MOST];
    uint32_t largest = m->largest;
    size_t i;
    for (i = 0; i < m->count; i++) {
        heaviest[i] = SIZE_MAX;
        pieces[i] = 0;
    }
    for (i = 0; i < v->fragment_count; i++) {
        size_t *best = &heaviest[origin[i] = origin_of(v, i, seed)];
        if (*best == SIZE_MAX || v->fragment_mass[i] > v->fragment_mass[*best]) *best = i;
        pieces[origin[i]]++;
    }
    for (i = 0; i < v->fragment_count; i++) {
        const piece *old = &m->pieces[origin[i]], now = piece_of(v, i);
        const int same = now.cells == old->cells && now.mass == old->mass && now.volumes == old->volumes;
        CHECK_SEED(v->fragment_origin[i] == old->id, seed);
        if (heaviest[origin[i]] != i) {
            CHECK_SEED(v->fragment_change[i] == GX_FRAGMENT_CREATED && v->fragment_id[i] > largest, seed);
            largest = v->fragment_id[i];
            continue;
        }
        CHECK_SEED(v->fragment_id[i] == old->id, seed);
        if (pieces[origin[i]] > 1)
            CHECK_SEED(v->fragment_change[i] == GX_FRAGMENT_SPLIT, seed);
        else if (!same)
            CHECK_SEED(v->fragment_change[i] == GX_FRAGMENT_TOUCHED, seed);
        else
            CHECK_SEED(v->fragment_change[i] == GX_FRAGMENT_UNCHANGED ||
                           (v->fragment_change[i] == GX_FRAGMENT_TOUCHED && touched),
                       seed);
    }
    for (i = 0; i < m->count; i++) CHECK_SEED(is_listed(v, m->pieces[i].id) == (heaviest[i] == SIZE_MAX), seed);
}

/* Random cuts, now and then several between snapshots. Skins, hashes and failed cuts in between assign no ids and
   change nothing. */
START_TEST(random_cuts) {
    const uint64_t seed = (uint64_t)_i + 1;
    static record m;
    workload w;
    gx_body *body;
    int k, touched = 0;
    random_seed(seed);
    w = grid(3, 3, 3, random_below(2) ? 5 : 6);
    body = body_of(&w);
    memset(&m, 0, sizeof m);
    if (random_below(2)) {
        gx_view v = view_of(body);
        ck_assert(v.fragment_count == 1 && v.fragment_id[0] == 1 && v.fragment_origin[0] == 1 &&
                  v.fragment_change[0] == GX_FRAGMENT_UNCHANGED);
        ck_assert_uint_eq(v.removed_count, 0);
    }
    m.count = m.largest = 1;
    m.pieces[0].id = 1; /* the body as it was created; all its other cells differ */
    for (k = 0; k < 9; k++) {
        gx_skin skin;
        gx_view v;
        add_random_cut(&w, 1);
        touched |= cut_by(body, &w, (size_t)k, 1).touched_elements > 0;
        if (random_below(3) == 0) ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
        if (random_below(3) == 0) hash_of(body);
        if (random_below(3) == 0) continue;
        v = view_of(body);
        if (k == 0 && !touched) continue;
        check_change(&m, &v, touched, seed);
        v = view_of(body); /* the same again */
        check_change(&m, &v, touched, seed);
        remember(&m, &v);
        touched = 0;
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static gx_result bad_cut(gx_body *body) {
    static const double x[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t t[3] = {0, 1, 9};
    gx_surface surface;
    gx_cut_desc cut;
    memset(&cut, 0, sizeof cut);
    memset(&surface, 0, sizeof surface);
    surface.vertices = x;
    surface.vertex_count = 3;
    surface.triangles = t;
    surface.triangle_count = 1;
    surface.kind = GX_SURFACE_SHEET;
    cut.surfaces = &surface;
    cut.surface_count = 1;
    return gx_body_cut(body, &cut, NULL, NULL);
}

static gx_result cut_scoped(gx_body *body, const workload *w, size_t surface, uint32_t fragment) {
    gx_surface s = surface_of(&w->surfaces[surface]);
    gx_cut_desc cut;
    memset(&cut, 0, sizeof cut);
    cut.surfaces = &s;
    cut.surface_count = 1;
    cut.scope_fragments = &fragment;
    cut.scope_fragment_count = 1;
    return gx_body_cut(body, &cut, NULL, NULL);
}

/* One by one: a split, a scoped split, a partial cut, a piece carved, a piece removed, a miss. */
START_TEST(every_change) {
    workload w = grid(3, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_view v;
    wl_surface *s;
    double x[3] = {2.3, 0.2, 0.2};
    add_axis_plane(&w, 0, 2.0);
    add_axis_plane(&w, 1, 0.375);
    s = wl_add_surface(&w, 0);
    wl_add_vertex(s, x);
    x[1] = 0.3;
    wl_add_vertex(s, x);
    x[2] = 0.3;
    wl_add_vertex(s, x);
    wl_add_triangle(s, 0, 1, 2);
    add_box(&w, 1, 2.9, -1, -1, 4, 4, 4);
    add_box(&w, 1, -1, -1, -1, 1.99, 0.37, 2);
    add_box(&w, 1, -1, -1, -1, 2, 0.375, 2);
    add_axis_plane(&w, 0, 7.0);
    cut_by(body, &w, 0, 1); /* [0, 2] keeps id 1, [2, 3] gets 2 */
    v = view_of(body);
    ck_assert(v.fragment_count == 2 && v.fragment_id[0] == 1 && v.fragment_id[1] == 2 && v.fragment_origin[1] == 1);
    ck_assert(v.fragment_change[0] == GX_FRAGMENT_SPLIT && v.fragment_change[1] == GX_FRAGMENT_CREATED &&
              v.removed_count == 0);
    ck_assert_int_eq(bad_cut(body), GX_ERROR_INDEX);
    v = view_of(body);
    ck_assert(v.fragment_change[0] == GX_FRAGMENT_SPLIT && v.fragment_change[1] == GX_FRAGMENT_CREATED);
    ck_assert_int_eq(cut_scoped(body, &w, 1, 0), GX_OK); /* y < 0.375 of [0, 2] gets 3 */
    v = view_of(body);
    ck_assert_uint_eq(v.fragment_count, 3);
    for (size_t i = 0; i < 3; i++) {
        const int low = v.fragment_center[3 * i + 1]<0.375, right = v.fragment_center[3 * i]> 2;
        ck_assert_uint_eq(v.fragment_id[i], right ? 2 : low ? 3 : 1);
        ck_assert_uint_eq(v.fragment_origin[i], right ? 2 : 1);
        ck_assert_uint_eq(v.fragment_change[i], right ? GX_FRAGMENT_UNCHANGED
                                                : low ? GX_FRAGMENT_CREATED
                                                      : GX_FRAGMENT_SPLIT);
    }
    cut_by(body, &w, 2, 1); /* ends inside of 2 */
    v = view_of(body);
    for (size_t i = 0; i < 3; i++)
        ck_assert_uint_eq(v.fragment_change[i], v.fragment_id[i] == 2 ? GX_FRAGMENT_TOUCHED : GX_FRAGMENT_UNCHANGED);
    cut_by(body, &w, 3, 1); /* carves 2 */
    v = view_of(body);
    for (size_t i = 0; i < 3; i++)
        ck_assert_uint_eq(v.fragment_change[i], v.fragment_id[i] == 2 ? GX_FRAGMENT_TOUCHED : GX_FRAGMENT_UNCHANGED);
    cut_by(body, &w, 4, 1); /* most of 3, then */
    cut_by(body, &w, 5, 1); /* all of it */
    v = view_of(body);
    ck_assert(v.fragment_count == 2 && v.removed_count == 1 && v.removed_ids[0] == 3);
    for (size_t i = 0; i < 2; i++) ck_assert(v.fragment_id[i] != 3 && v.fragment_origin[i] == v.fragment_id[i]);
    cut_by(body, &w, 6, 1); /* misses the body */
    v = view_of(body);
    ck_assert(v.fragment_count == 2 && v.removed_count == 0);
    for (size_t i = 0; i < 2; i++) ck_assert_uint_eq(v.fragment_change[i], GX_FRAGMENT_UNCHANGED);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A snapshot changes ids but not states: halves of equal mass, the first keeps the id. */
START_TEST(equal_halves) {
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_view v;
    add_axis_plane(&w, 0, 1.0);
    cut_by(body, &w, 0, 1);
    v = view_of(body);
    ck_assert(v.fragment_count == 2 && v.fragment_mass[0] == v.fragment_mass[1]);
    ck_assert(v.fragment_id[0] == 1 && v.fragment_id[1] == 2);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A mesh of several fragments has ids of its own from the start. A body that a solid removes completely has none
   left. */
START_TEST(many_meshes_and_nothing) {
    workload w = wl_empty();
    gx_body *body;
    gx_view v;
    gx_motion none;
    uint32_t i;
    for (i = 0; i < 5; i++) {
        const double x = 3.0 * i;
        const uint32_t n = (uint32_t)w.node_count;
        wl_add_node(&w, x, 0, 0);
        wl_add_node(&w, x + 1, 0, 0);
        wl_add_node(&w, x, 1, 0);
        wl_add_node(&w, x, 0, 1);
        wl_add_element(&w, n, n + 1, n + 2, n + 3);
    }
    add_box(&w, 1, -1, -1, -1, 2, 2, 2);
    add_box(&w, 1, 5, -1, -1, 20, 2, 2);
    add_box(&w, 1, -9, -9, -9, 99, 9, 9);
    body = body_of(&w);
    cut_by(body, &w, 0, 2);
    v = view_of(body);
    ck_assert(v.fragment_count == 1 && v.fragment_id[0] == 2 && v.fragment_change[0] == GX_FRAGMENT_UNCHANGED);
    ck_assert(v.removed_count == 4 && v.removed_ids[0] == 1 && v.removed_ids[1] == 3 && v.removed_ids[3] == 5);
    cut_by(body, &w, 2, 1);
    v = view_of(body);
    ck_assert(v.fragment_count == 0 && v.removed_count == 1 && v.removed_ids[0] == 2 && v.mass == 0);
    ck_assert_int_eq(gx_body_motion(body, &none, 1, NULL), GX_OK);
    ck_assert_int_eq(gx_body_motion(body, NULL, 0, NULL), GX_OK);
    cut_by(body, &w, 2, 1);
    v = view_of(body);
    ck_assert(v.fragment_count == 0 && v.removed_count == 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Elements that meet in an edge only: a sheet through the edge that enters neither splits them. Removing one leaves
   a fragment that lost material, although nothing of the other is cut. */
START_TEST(pinched_fragments) {
    static const double x[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}};
    static const double n[3] = {1, 1, 0};
    workload w = wl_empty();
    gx_body *body;
    gx_view v;
    int i;
    for (i = 0; i < 6; i++) wl_add_node(&w, x[i][0], x[i][1], x[i][2]);
    wl_add_element(&w, 0, 1, 2, 3);
    wl_add_element(&w, 0, 4, 5, 3);
    if (_i == 0)
        add_plane(&w, x[0], n, 2);
    else
        add_box(&w, 1, 0, 0, 0, 2, 2, 2);
    body = body_of(&w);
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    cut_by(body, &w, 0, 1);
    v = view_of(body);
    ck_assert_uint_eq(v.fragment_count, _i == 0 ? 2 : 1);
    ck_assert(v.fragment_id[0] == 1 && v.fragment_change[0] == (_i == 0 ? GX_FRAGMENT_SPLIT : GX_FRAGMENT_TOUCHED) &&
              v.removed_count == 0);
    if (_i == 0)
        ck_assert(v.fragment_id[1] == 2 && v.fragment_change[1] == GX_FRAGMENT_CREATED && v.fragment_origin[1] == 1);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A cut of one fragment alone, through the node that joins the elements of another: the other stays whole. */
START_TEST(scope_beside_a_pinch) {
    static const double x[7][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    static const double through[3][3] = {{-60, 30, 30}, {30, -60, 30}, {30, 30, -60}};
    workload w = wl_empty();
    wl_surface *s;
    gx_body *body;
    gx_surface surface;
    gx_cut_desc cut;
    gx_view v;
    uint32_t tip, cell = 0;
    int i;
    for (i = 0; i < 7; i++) wl_add_node(&w, x[i][0], x[i][1], x[i][2]);
    wl_add_element(&w, 0, 1, 2, 3);
    wl_add_element(&w, 0, 4, 5, 6);
    add_axis_plane(&w, 0, 0.5);
    s = wl_add_surface(&w, 0);
    for (i = 0; i < 3; i++) wl_add_vertex(s, through[i]);
    wl_add_triangle(s, 0, 1, 2);
    body = body_of(&w);
    cut_by(body, &w, 0, 1);
    v = view_of(body);
    ck_assert_uint_eq(v.fragment_count, 2);
    tip = v.fragment_center[3] > v.fragment_center[0];
    while (v.cell_fragment[cell] != tip) cell++;
    surface = surface_of(s);
    memset(&cut, 0, sizeof cut);
    cut.surfaces = &surface;
    cut.surface_count = 1;
    if (_i == 0) {
        cut.scope_fragments = &tip;
        cut.scope_fragment_count = 1;
    } else {
        cut.scope_cells = &cell;
        cut.scope_cell_count = 1;
    }
    ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
    v = view_of(body);
    ck_assert_uint_eq(v.fragment_count, 2);
    for (i = 0; i < 2; i++) ck_assert(v.fragment_center[3 * i] > 0.5 || v.fragment_change[i] == GX_FRAGMENT_UNCHANGED);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A sheet in the face between two fragments, again and of one of them alone: a thin link inside the other is not
   severed. */
START_TEST(scope_of_severing) {
    static const double x[6][3] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0.25, 0.25}, {1, 0, 0}, {1, 1, 1}};
    /* of the face 1 2 4 */
    static const double most[3][3] = {{0.125, 2.4375, -1.5625}, {0.125, -1.5625, 2.4375}, {3, -1, -1}};
    workload w = wl_empty();
    wl_surface *s;
    gx_body *body;
    gx_surface surface;
    gx_cut_desc cut;
    gx_cut_report report;
    uint32_t left;
    int i;
    for (i = 0; i < 6; i++) wl_add_node(&w, x[i][0], x[i][1], x[i][2]);
    wl_add_element(&w, 0, 1, 2, 3);
    wl_add_element(&w, 0, 1, 2, 4);
    wl_add_element(&w, 1, 2, 4, 5);
    add_axis_plane(&w, 0, 0);
    s = wl_add_surface(&w, 0);
    for (i = 0; i < 3; i++) wl_add_vertex(s, most[i]);
    wl_add_triangle(s, 0, 1, 2);
    body = body_of(&w);
    cut_by(body, &w, 0, 1);
    report = cut_by(body, &w, 1, 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    left = view_of(body).fragment_center[0] > 0;
    surface = surface_of(&w.surfaces[0]);
    memset(&cut, 0, sizeof cut);
    cut.surfaces = &surface;
    cut.surface_count = 1;
    cut.scope_fragments = &left;
    cut.scope_fragment_count = 1;
    cut.sever_below = 2 * report.min_link_ratio;
    ck_assert_int_eq(gx_body_cut(body, &cut, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.severed_links, 0);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- inertia ---- */

/* The unit cube at an offset, cut across x: boxes of length a and 1 - a */
START_TEST(inertia_of_boxes) {
    static const double offsets[3] = {0, 1000, 1e6};
    const double a = 0.25, x0 = offsets[_i];
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_view v;
    size_t i, k;
    for (i = 0; i < 3 * w.node_count; i++) w.positions[i] += x0;
    add_box(&w, 0, x0 + a, x0 - 1, x0 - 1, x0 + 5, x0 + 5, x0 + 5);
    body = cut_at_once(&w);
    v = view_of(body);
    ck_assert_uint_eq(v.fragment_count, 2);
    for (i = 0; i < 2; i++) {
        const int left = v.fragment_center[3 * i] < x0 + 0.2;
        const double l = left ? a : 1 - a, m = 1000 * l;
        const double truth[6] = {m / 6, 0, 0, m * (l * l + 1) / 12, 0, m * (l * l + 1) / 12};
        ck_assert_double_eq_tol(v.fragment_mass[i], m, 1e-11 * m);
        ck_assert_double_eq_tol(v.fragment_center[3 * i], x0 + (left ? a / 2 : (1 + a) / 2), 1e-14 * (1 + x0));
        for (k = 0; k < 6; k++)
            ck_assert_msg(fabs(v.fragment_inertia[6 * i + k] - truth[k]) <= 1e-12 * m + 1e-9 * m * (_i == 2),
                          "entry %zu: %.17g, should be %.17g", k, v.fragment_inertia[6 * i + k], truth[k]);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* inertia += m (|d|^2 1 - d d^T) */
static void move_inertia(double inertia[6], double m, const double d[3]) {
    const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    inertia[0] += m * (square - d[0] * d[0]);
    inertia[3] += m * (square - d[1] * d[1]);
    inertia[5] += m * (square - d[2] * d[2]);
    inertia[1] -= m * d[0] * d[1];
    inertia[2] -= m * d[0] * d[2];
    inertia[4] -= m * d[1] * d[2];
}

/* Steiner: the fragments' inertia about the body's centre adds up to the body's. */
START_TEST(inertia_adds_up) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w = grid(3, 3, 3, 5);
    gx_body *body = body_of(&w);
    gx_view v = view_of(body);
    double whole[6], center[3], sum[6] = {0, 0, 0, 0, 0, 0};
    size_t i, k;
    random_seed(seed);
    memcpy(whole, v.fragment_inertia, sizeof whole);
    memcpy(center, v.fragment_center, sizeof center);
    for (i = 0; i < 4; i++) {
        double p[3], n[3];
        for (k = 0; k < 3; k++) {
            p[k] = random_real(0.5, 2.5);
            n[k] = random_real(-1, 1);
        }
        add_plane(&w, p, n, 12);
        cut_by(body, &w, i, 1);
    }
    v = view_of(body);
    CHECK_SEED(v.fragment_count > 4, seed);
    for (i = 0; i < v.fragment_count; i++) {
        double d[3];
        for (k = 0; k < 3; k++) d[k] = v.fragment_center[3 * i + k] - center[k];
        for (k = 0; k < 6; k++) sum[k] += v.fragment_inertia[6 * i + k];
        move_inertia(sum, v.fragment_mass[i], d);
    }
    for (k = 0; k < 6; k++) CHECK_SEED(fabs(sum[k] - whole[k]) < 1e-11 * whole[0], seed);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- motion ---- */

static void cross(const double a[3], const double b[3], double r[3]) {
    int k;
    for (k = 0; k < 3; k++) r[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Rotation by an angle about a unit axis */
static void turn(const double axis[3], double angle, const double x[3], double r[3]) {
    double c[3], dot = axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
    int k;
    cross(axis, x, c);
    for (k = 0; k < 3; k++) r[k] = x[k] * cos(angle) + c[k] * sin(angle) + axis[k] * dot * (1 - cos(angle));
}

/* x = R X + t, v = v0 + spin x (x - t), each number exact to rounding */
static void move_rigidly(const workload *w, const gx_view *v, const double axis[3], double angle, const double t[3],
                         const double v0[3], const double spin[3]) {
    size_t i, k;
    for (i = 0; i < v->copy_count; i++) {
        const double *rest = w->positions + 3 * (size_t)v->copy_node[i];
        double x[3], s[3];
        turn(axis, angle, rest, x);
        cross(spin, x, s);
        for (k = 0; k < 3; k++) {
            v->displacement[3 * i + k] = x[k] + t[k] - rest[k];
            v->velocity[3 * i + k] = v0[k] + s[k];
        }
    }
}

START_TEST(rigid_motion) {
    const uint64_t seed = (uint64_t)_i + 1;
    static gx_motion motions[MOST];
    workload w = grid(2, 3, 2, 5);
    gx_body *body = body_of(&w);
    gx_view v;
    double axis[3], t[3], v0[3], spin[3], angle, length = 0;
    size_t i, k;
    random_seed(seed);
    for (k = 0; k < 3; k++) {
        axis[k] = random_real(-1, 1);
        t[k] = random_real(-5, 5);
        v0[k] = random_real(-9, 9);
        spin[k] = random_real(-20, 20);
        length += axis[k] * axis[k];
    }
    for (k = 0; k < 3; k++) axis[k] /= sqrt(length);
    angle = random_real(-3, 3);
    for (i = 0; i < 4; i++) {
        add_random_cut(&w, 1);
        cut_by(body, &w, i, 1);
    }
    v = view_of(body);
    move_rigidly(&w, &v, axis, angle, t, v0, spin);
    ck_assert_uint_lt(v.fragment_count, MOST);
    ck_assert_int_eq(gx_body_motion(body, motions, MOST, NULL), GX_OK);
    for (i = 0; i < v.fragment_count; i++) {
        const gx_motion *m = &motions[i];
        const double *in = m->inertia, *c = v.fragment_center + 3 * i;
        double moved[3], s[3], energy,
            size = in[0] + in[3] + in[5],
            rest = v.fragment_inertia[6 * i] + v.fragment_inertia[6 * i + 3] + v.fragment_inertia[6 * i + 5];
        turn(axis, angle, c, moved);
        cross(spin, moved, s);
        CHECK_SEED(fabs(m->mass - v.fragment_mass[i]) <= 1e-13 * m->mass, seed);
        CHECK_SEED(fabs(size - rest) <= 1e-10 * rest + 1e-13 * m->mass, seed);
        energy = spin[0] * spin[0] * in[0] + spin[1] * spin[1] * in[3] + spin[2] * spin[2] * in[5] +
                 2 * (spin[0] * spin[1] * in[1] + spin[0] * spin[2] * in[2] + spin[1] * spin[2] * in[4]);
        for (k = 0; k < 3; k++) {
            CHECK_SEED(fabs(m->center[k] - (moved[k] + t[k])) <= 1e-13 * 10, seed);
            CHECK_SEED(fabs(m->velocity[k] - (v0[k] + s[k])) <= 1e-13 * 100, seed);
            if (size > 1e-4 * m->mass) CHECK_SEED(fabs(m->angular_velocity[k] - spin[k]) <= 1e-9 * 20, seed);
            energy += m->mass * m->velocity[k] * m->velocity[k];
        }
        CHECK_SEED(fabs(m->energy - 0.5 * energy) <= 1e-10 * energy, seed);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A free body thrown and spun: it falls as a point does, and its angular momentum stays. */
START_TEST(thrown_body) {
    workload w = grid(3, 1, 1, 6);
    gx_body *body = body_of(&w);
    gx_view v = view_of(body);
    gx_step_desc step;
    gx_motion before, after;
    const double axis[3] = {0, 0, 1}, zero[3] = {0, 0, 0}, v0[3] = {1, 2, 3}, spin[3] = {0, 0, 2};
    int i, k;
    move_rigidly(&w, &v, axis, 0.3, zero, v0, spin);
    ck_assert_int_eq(gx_body_motion(body, &before, 1, NULL), GX_OK);
    memset(&step, 0, sizeof step);
    step.dt = 0.002;
    step.gravity[2] = -10;
    step.integrator = GXS_MIDPOINT;
    step.newton_iterations = 4;
    for (i = 0; i < 100; i++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    ck_assert_int_eq(gx_body_motion(body, &after, 1, NULL), GX_OK);
    for (k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(after.velocity[k], before.velocity[k] - (k == 2 ? 2.0 : 0), 1e-10);
        ck_assert_double_eq_tol(after.center[k], before.center[k] + 0.2 * before.velocity[k] - (k == 2 ? 0.2 : 0),
                                1e-10);
    }
    ck_assert_double_eq_tol(after.inertia[5] * after.angular_velocity[2],
                            before.inertia[5] * before.angular_velocity[2],
                            1e-3 * before.inertia[5] * before.angular_velocity[2]);
    ck_assert_double_eq_tol(after.angular_velocity[2], 2, 0.05);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A body pressed to a plane, to a line, to a point: rotations without inertia are left out, everything else is
   unchanged. */
START_TEST(without_inertia) {
    const int gone = _i + 1; /* axes along which nothing is left */
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    gx_view v = view_of(body);
    gx_motion m;
    const double spin[3] = {3, 5, 7};
    size_t i, k;
    for (i = 0; i < v.copy_count; i++) {
        const double *rest = w.positions + 3 * (size_t)v.copy_node[i];
        double x[3];
        for (k = 0; k < 3; k++) {
            x[k] = (int)k < gone ? 0 : rest[k];
            v.displacement[3 * i + k] = x[k] - rest[k];
        }
        cross(spin, x, v.velocity + 3 * i);
    }
    ck_assert_int_eq(gx_body_motion(body, &m, 1, NULL), GX_OK);
    for (k = 0; k < 3; k++) {
        const int turns = gone == 1 || (gone == 2 && k < 2);
        ck_assert(m.angular_velocity[k] - m.angular_velocity[k] == 0);
        ck_assert_double_eq_tol(m.angular_velocity[k], turns ? spin[k] : 0, 1e-12);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(motion_arguments) {
    workload w = wl_through(0.1);
    gx_body *body = cut_at_once(&w);
    gx_motion motions[2];
    memset(motions, 0x5a, sizeof motions);
    ck_assert_int_eq(gx_body_motion(NULL, motions, 2, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_motion(body, NULL, 2, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_motion(body, motions, 1, NULL), GX_ERROR_CAPACITY);
    ck_assert_int_eq(gx_body_motion(body, NULL, 0, NULL), GX_ERROR_CAPACITY);
    ck_assert_int_eq(((unsigned char *)motions)[0], 0x5a);
    ck_assert_int_eq(gx_body_motion(body, motions, 2, NULL), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("fragments");
    TCase *tests = tcase_create("fragments");
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, random_cuts, 0, 60);
    tcase_add_test(tests, every_change);
    tcase_add_test(tests, equal_halves);
    tcase_add_test(tests, many_meshes_and_nothing);
    tcase_add_loop_test(tests, pinched_fragments, 0, 2);
    tcase_add_loop_test(tests, scope_beside_a_pinch, 0, 2);
    tcase_add_test(tests, scope_of_severing);
    tcase_add_loop_test(tests, inertia_of_boxes, 0, 3);
    tcase_add_loop_test(tests, inertia_adds_up, 0, 10);
    tcase_add_loop_test(tests, rigid_motion, 0, 20);
    tcase_add_test(tests, thrown_body);
    tcase_add_loop_test(tests, without_inertia, 0, 3);
    tcase_add_test(tests, motion_arguments);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
