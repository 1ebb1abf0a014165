/* test_near.c - what a blade finds near it, beside a slow and obvious answer: every cell is asked by its own distance
   from every part of the strip, where the library walks through boxes that may be out of date. Bodies follow motions,
   jump, stand still, are cut by others, restored and read again between the moves.

   GXFEM_SEED=n runs seed n alone. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include "../bench/blade.h"

enum { SEEDS = 4, MOVES = 20 };

static const double slack = 0.75; /* GXP_NEAR_SLACK */

/* ---- the oracle ---- */

static double square_of(const double a[3]) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

static void between(const double *a, const double *b, double share, double x[3]) {
    int k;
    for (k = 0; k < 3; k++) x[k] = a[k] + share * (b[k] - a[k]);
}

/* The least of a convex function of a share from 0 to 1, by thirds */
static double least_along(double (*of)(const double *data, double share), const double *data) {
    double low = 0, high = 1;
    int i;
    for (i = 0; i < 32; i++) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (of(data, a) < of(data, b))
            high = b;
        else
            low = a;
    }
    return of(data, 0.5 * low + 0.5 * high);
}

/* data: a point, the ends of a segment */
static double to_place(const double *data, double share) {
    double x[3];
    int k;
    between(data + 3, data + 6, share, x);
    for (k = 0; k < 3; k++) x[k] -= data[k];
    return square_of(x);
}

/* data: a point, the corners of a triangle. The distance to the line across the triangle at a share of two sides */
static double to_line(const double *data, double share) {
    double segment[9];
    memcpy(segment, data, 3 * sizeof *data);
    between(data + 3, data + 6, share, segment + 3);
    between(data + 3, data + 9, share, segment + 6);
    return least_along(to_place, segment);
}

static double triangle_distance(const double p[3], const double *a, const double *b, const double *c) {
    double data[12];
    memcpy(data, p, 3 * sizeof *data);
    memcpy(data + 3, a, 3 * sizeof *data);
    memcpy(data + 6, b, 3 * sizeof *data);
    memcpy(data + 9, c, 3 * sizeof *data);
    return sqrt(least_along(to_line, data));
}

typedef struct ball {
    double low[3], high[3], middle[3], radius, size;
} ball;

static ball ball_of(const gx_body *body, uint32_t slot) {
    const gxp_cell *cell = &body->cells.data[slot];
    const uint32_t *node = gxb_complex_element_nodes(body->complex, cell->element);
    double rest[12], x[4][3];
    ball b;
    int n, k;
    memset(&b, 0, sizeof b);
    for (n = 0; n < 4; n++)
        for (k = 0; k < 3; k++) {
            rest[3 * n + k] = body->mesh.positions[3 * node[n] + (uint32_t)k];
            x[n][k] = rest[3 * n + k] + body->copies.displacement[3 * cell->copies[n] + (uint32_t)k];
            b.low[k] = n == 0 ? x[n][k] : fmin(b.low[k], x[n][k]);
            b.high[k] = n == 0 ? x[n][k] : fmax(b.high[k], x[n][k]);
            b.middle[k] += 0.25 * x[n][k];
        }
    for (n = 0; n < 4; n++) {
        double way[3];
        for (k = 0; k < 3; k++) way[k] = x[n][k] - b.middle[k];
        b.radius = fmax(b.radius, sqrt(square_of(way)));
    }
    b.size = cbrt(6 * gxi_tet_volume(rest));
    return b;
}

/* How far the cell is inside of what is near, m; below 0: it is not near */
static double nearness(const gx_blade *blade, const ball *b) {
    double most = -HUGE_VAL;
    uint32_t q;
    int k;
    for (q = 0; q < blade->quads.count; q += 4) {
        const double *x = blade->quads.data + 3 * (size_t)q;
        double in_box = HUGE_VAL, away;
        for (k = 0; k < 3; k++) {
            const double low = fmin(fmin(x[k], x[3 + k]), fmin(x[6 + k], x[9 + k])) - blade->largest,
                         high = fmax(fmax(x[k], x[3 + k]), fmax(x[6 + k], x[9 + k])) + blade->largest;
            in_box = fmin(in_box, fmin(b->high[k] - low, high - b->low[k]));
        }
        if (in_box < most) continue;
        if (most > 1e-6 * b->size) return most; /* it is near */
        away = fmin(triangle_distance(b->middle, x, x + 3, x + 6), triangle_distance(b->middle, x, x + 6, x + 9));
        most = fmax(most, fmin(in_box, b->radius + b->size - away));
    }
    return most;
}

static void check_near(const gx_blade *blade, const gxp_words *scope, uint64_t seed, int move) {
    gx_body *body = blade->body;
    uint32_t slot, count = 0;
    for (slot = 0; slot < body->cells.count; slot++) {
        const uint32_t index = gxp_close_index(&blade->near, slot);
        double in;
        ball b;
        if (!body->cells.data[slot].kept || (scope && !scope->data[gxp_cell_fragment(body, slot)])) {
            ck_assert_uint_eq(index, GXB_NONE);
            continue;
        }
        b = ball_of(body, slot);
        in = nearness(blade, &b);
        count += index != GXB_NONE;
        if (fabs(in) < 1e-7 * b.size) continue; /* either will do */
        ck_assert_msg((index != GXB_NONE) == (in > 0), "seed %llu, move %d: slot %u is %sfound, and inside by %g",
                      (unsigned long long)seed, move, slot, index == GXB_NONE ? "not " : "", in);
    }
    ck_assert_uint_eq(count, blade->near.count);
}

/* Cells of one layer hang together through copies, those of two share none. */
static void check_layers(const gx_blade *blade, uint64_t seed) {
    const gxp_vicinity *near = &blade->near;
    const gx_body *body = blade->body;
    uint32_t *layer_of = (uint32_t *)malloc(body->copies.count * sizeof *layer_of), *group, i, j;
    int changed = 1, k;
    memset(layer_of, 0xff, body->copies.count * sizeof *layer_of);
    for (i = 0; i < near->count; i++)
        for (k = 0; k < 4; k++) {
            uint32_t *layer = &layer_of[body->cells.data[near->cells[i].cell].copies[k]];
            CHECK_SEED(*layer == UINT32_MAX || *layer == near->cells[i].layer, seed);
            *layer = near->cells[i].layer;
        }
    group = (uint32_t *)malloc((near->count + 1) * sizeof *group);
    for (i = 0; i < near->count; i++) group[i] = i;
    for (i = 0; i < body->copies.count; i++) layer_of[i] = UINT32_MAX; /* from here on: the least group */
    while (changed) {
        changed = 0;
        for (i = 0; i < near->count; i++)
            for (k = 0; k < 4; k++) {
                uint32_t *least = &layer_of[body->cells.data[near->cells[i].cell].copies[k]];
                if (*least < group[i]) group[i] = *least, changed = 1;
                if (*least > group[i]) *least = group[i], changed = 1;
            }
    }
    for (i = 0, j = 0; i < near->count; i++) j += group[i] == i;
    CHECK_SEED(j == near->layer_count, seed);
    for (i = 0; i < near->count; i++) CHECK_SEED(near->cells[i].layer == near->cells[group[i]].layer, seed);
    free(layer_of);
    free(group);
}

/* Looks around as a move does, and compares; then moves. */
static void move_and_check(stage *s, gx_blade *blade, const double *edge, uint32_t count, int scoped, uint64_t seed,
                           int move) {
    const uint32_t scope = (uint32_t)(s->view.fragment_count - 1);
    gx_blade_report report;
    const double *before;
    ck_assert_int_eq(gxp_refit_near(blade, slack, NULL), GX_OK);
    if (scoped) ck_assert_int_eq(gxp_flag_scope(blade, &scope, 1, NULL), GX_OK);
    before = blade->now.edge.count > 0 ? blade->now.edge.data : edge;
    ck_assert_int_eq(gxp_find_layers(blade, before, edge, count, scoped ? &blade->in_scope : NULL), GX_OK);
    check_near(blade, scoped ? &blade->in_scope : NULL, seed, move);
    check_layers(blade, seed);
    ck_assert_int_eq(gx_blade_move(blade, edge, count, &scope, (size_t)scoped, &report, &s->failure), GX_OK);
    stage_look(s);
}

static stage open_block(uint32_t n, uint64_t seed) {
    stage s;
    memset(&s, 0, sizeof s);
    s.cells[0] = n;
    s.cells[1] = n + 1;
    s.cells[2] = n;
    s.random = seed * 7919;
    s.scale = seed % 3 == 1 ? 0.01 : 1;
    s.origin[seed % 3] = seed % 3 == 2 ? 1000 : 0;
    stage_open(&s, 1e3, 0.2, NULL);
    return s;
}

static int only_seed(void) { return getenv("GXFEM_SEED") ? atoi(getenv("GXFEM_SEED")) : 0; }

/* ---- tests ---- */

/* Edges of 2 to 4 points go through a block that follows a motion; now and then the body stands still, jumps, is cut by
   a plane or becomes what it was, and the blade sees one fragment only. */
START_TEST(cells_around) {
    const uint64_t seed = (uint64_t)_i;
    stage s = open_block(3 + (uint32_t)seed % 3, seed);
    stage_motion m = stage_random_motion(&s, (int)(seed % 3));
    const uint32_t count = 2 + (uint32_t)seed % 3;
    const double n = s.cells[0];
    gx_body *before = NULL;
    gx_blade *blade = s.blade;
    int k, c;
    uint32_t i;
    for (k = 0; k <= MOVES; k++) {
        const double share = (double)k / MOVES, y = -2 + (n + 4) * share, bend = stage_uniform(&s);
        double edge[12];
        for (i = 0; i < count; i++) {
            edge[3 * i] = -n + 3 * n * i / (count - 1);
            edge[3 * i + 1] = y + 0.2 * i + (i % 2 ? 0.4 * bend : 0);
            edge[3 * i + 2] = 0.45 * n + 0.3 * i;
        }
        for (i = 0; i < 3 * count; i++) edge[i] = s.origin[i % 3] + s.scale * edge[i];
        if (k % 4 != 1) stage_pose(&s, &m, share);
        if (k % 9 == 8) /* a jump */
            for (i = 0; i < s.view.copy_count; i++)
                for (c = 0; c < 3; c++)
                    s.view.displacement[3 * i + (uint32_t)c] += s.scale * 1.3 * (c == (int)seed % 3);
        if (k == 7) ck_assert_int_eq(gx_body_clone(s.body, &before, NULL), GX_OK);
        if (k == 15) ck_assert_int_eq(gx_body_restore(s.body, before, NULL), GX_OK);
        if (k == 11 && s.scale > 0.5 && s.origin[0] + s.origin[1] + s.origin[2] < 1)
            stage_cut_plane(&s, 0.3 * n + 0.01);
        stage_look(&s);
        move_and_check(&s, blade, edge, count, k % 5 == 3, seed, k);
    }
    CHECK_SEED(stage_ok(&s), seed);
    gx_body_destroy(before);
    stage_close(&s);
}
END_TEST

/* Boxes are fitted again only when copies have come far, and are right in between. */
START_TEST(loose_boxes) {
    stage s = open_block(4, 3);
    const double edge[6] = {-4, 1.7, 1.8, 8, 1.9, 2.3};
    const double mean = s.body->mesh.mean_size;
    double loose = -1, shift[3] = {1, 1, 1};
    size_t i;
    ck_assert_int_eq(gxp_refit_near(s.blade, slack, NULL), GX_OK);
    ck_assert(s.blade->slack == 0);
    ck_assert(memcmp(s.body->copies.seen, s.view.displacement, 3 * s.view.copy_count * sizeof(double)) == 0);
    for (i = 0; i < 3 * s.view.copy_count; i++) s.view.displacement[i] = 0.7 * mean * (i % 2 ? 1 : -1);
    ck_assert_int_eq(gxp_refit_near(s.blade, slack, NULL), GX_OK);
    ck_assert(fabs(s.blade->slack - 0.7 * mean) < 1e-9 && s.body->copies.seen[0] == 0);
    ck_assert_int_eq(gxp_find_layers(s.blade, edge, edge, 2, NULL), GX_OK);
    check_near(s.blade, NULL, 0, 0);
    for (i = 0; i < s.view.copy_count; i++) s.view.displacement[3 * i] += 3 * mean; /* carried as a whole */
    ck_assert_int_eq(gxp_refit_near(s.blade, slack, NULL), GX_OK);
    ck_assert(fabs(s.blade->slack - 0.7 * mean) < 1e-9 && fabs(s.blade->shift[0] - 3 * mean) < 1e-9);
    ck_assert(s.body->copies.seen[0] == 0);
    ck_assert_int_eq(gxp_find_layers(s.blade, edge, edge, 2, NULL), GX_OK);
    check_near(s.blade, NULL, 0, 1);
    s.view.displacement[7] += 0.2 * mean;
    ck_assert_int_eq(gxp_refit_near(s.blade, slack, NULL), GX_OK);
    ck_assert(s.blade->slack == 0 && s.body->copies.seen[7] == s.view.displacement[7]);
    ck_assert_int_eq(gxp_find_layers(s.blade, edge, edge, 2, NULL), GX_OK);
    check_near(s.blade, NULL, 0, 2);
    s.view.displacement[8] += 0.01 * mean; /* others want exact boxes */
    ck_assert_int_eq(gxp_refit_loosely(s.body, 0, &loose, shift), GX_OK);
    ck_assert(loose == 0 && shift[1] == 0 && s.body->copies.seen[8] == s.view.displacement[8]);
    stage_close(&s);
}
END_TEST

/* Displacements that are not finite, or too large, are refused by moves, lifts and tools, and when they are mended all
   goes on. */
START_TEST(wild_copies) {
    static const double wild[4] = {NAN, INFINITY, -INFINITY, 1e300};
    const gx_result result = _i < 3 ? GX_ERROR_NOT_FINITE : GX_ERROR_RANGE;
    stage s = open_block(3, 3), plain = open_block(3, 3);
    const double low[3] = {0.5, 0.5, 0.5}, high[3] = {1.5, 1.5, 1.5};
    workload w = wl_empty();
    gx_surface tool;
    gx_failure failure;
    int k;
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    tool = surface_of(&w.surfaces[0]);
    for (k = 0; k <= 12; k++) {
        const double y = -1 + 0.5 * k, edge[6] = {-9, y, 1.1, 9, y + 0.2, 1.4};
        const uint64_t state = gx_body_state_hash(s.body);
        const size_t at = 3 * (s.view.copy_count - 1 - (size_t)k) + (size_t)k % 3;
        const double right = s.view.displacement[at];
        s.view.displacement[at] = wild[_i];
        ck_assert_int_eq(gx_blade_move(s.blade, edge, 2, NULL, 0, NULL, &failure), result);
        ck_assert_str_eq(failure.field, "displacement");
        ck_assert_uint_eq(failure.index, at / 3);
        if (k > 0) ck_assert_int_eq(gx_blade_lift(s.blade, NULL, &failure), result);
        ck_assert_int_eq(gx_body_carve(s.body, &tool, NULL, &failure), result);
        ck_assert_str_eq(failure.field, "displacement");
        s.view.displacement[at] = right;
        ck_assert(gx_body_state_hash(s.body) == state);
        ck_assert_int_eq(gx_blade_move(s.blade, edge, 2, NULL, 0, NULL, &s.failure), GX_OK);
        ck_assert_int_eq(gx_blade_move(plain.blade, edge, 2, NULL, 0, NULL, &plain.failure), GX_OK);
        stage_look(&s);
        stage_look(&plain);
        ck_assert(gx_body_state_hash(s.body) == gx_body_state_hash(plain.body));
    }
    ck_assert_uint_eq(s.view.fragment_count, 2);
    wl_free(&w);
    stage_close(&s);
    stage_close(&plain);
}
END_TEST

/* Fronts that a deformed body has taken beyond doubles, or out of range, blame how it is deformed; nothing is cut. */
START_TEST(wild_fronts) {
    static const double wild[2] = {NAN, 1e300};
    static const uint32_t starts[2] = {0, 0};
    stage s = open_block(2, 3);
    const uint64_t state = gx_body_state_hash(s.body);
    gx_blade_report report;
    gx_failure failure;
    int k;
    memset(&report, 0, sizeof report);
    for (k = 0; k < 3; k++) {
        const double corner[3] = {k == 1 ? wild[_i] : 1, 0.7 * k, 1.3};
        ck_assert_int_eq(gxp_push_point(s.body, &s.blade->corners, corner), GX_OK);
    }
    for (k = 0; k < 2; k++) ck_assert_int_eq(gxp_push(s.body, &s.blade->surface_starts, starts[k]), GX_OK);
    for (k = 0; k < 4; k++) ck_assert_int_eq(gxp_push(s.body, &s.blade->scope, (uint32_t)k), GX_OK);
    ck_assert_int_eq(gxp_cut_surfaces(s.blade, GX_SURFACE_SHEET, &report, &failure),
                     _i == 0 ? GX_ERROR_NOT_FINITE : GX_ERROR_RANGE);
    ck_assert_str_eq(failure.field, "displacement");
    ck_assert(failure.index == SIZE_MAX && failure.surface == SIZE_MAX);
    ck_assert(gx_body_state_hash(s.body) == state);
    stage_close(&s);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("near");
    TCase *tests = tcase_create("near");
    const int only = only_seed();
    tcase_set_timeout(tests, 120);
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, cells_around, only ? only : 0, only ? only + 1 : FEWER > 1 ? 2 : SEEDS);
    tcase_add_test(tests, loose_boxes);
    tcase_add_loop_test(tests, wild_copies, 0, 4);
    tcase_add_loop_test(tests, wild_fronts, 0, 2);
    return run_suite(suite);
}
