/* test_holds.c - held regions of every kind. A copy is held if its node is in a region and one of its own cells has
   material there. The oracle for the latter: a clone from which the region is removed as a solid loses something of
   that cell. Nodes are compared with exact rationals. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"

static gx_body *clone_of(gx_body *body) {
    gx_body *clone = NULL;
    ck_assert_int_eq(gx_body_clone(body, &clone, NULL), GX_OK);
    return clone;
}

/* ---- the oracle ---- */

/* By row of cells: 1 if the solid would remove something of the cell */
static uint8_t *cells_in(gx_body *body, const gx_surface *solid) {
    gx_body *clone = clone_of(body);
    uint8_t *in = (uint8_t *)calloc(body->cells.count, 1);
    gx_surface s = *solid;
    gx_cut_desc cut;
    uint32_t leaf;
    memset(&cut, 0, sizeof cut);
    s.kind = GX_SURFACE_SOLID;
    cut.surfaces = &s;
    cut.surface_count = 1;
    clone->complex->settled = UINT64_MAX / 8; /* never again: leaves keep their numbers */
    ck_assert_int_eq(gx_body_cut(clone, &cut, NULL, NULL), GX_OK);
    for (leaf = 0; leaf < clone->leaves.count; leaf++) {
        uint32_t old = leaf;
        if (!gxb_complex_leaf(clone->complex, leaf)->removed) continue;
        while (old >= body->leaves.count) old = gxb_complex_leaf(clone->complex, old)->parent;
        if (gxp_is_kept(body, old)) in[body->leaves.data[old].cell] = 1;
    }
    gx_body_destroy(clone);
    return in;
}

static int in_ball(const double x[3], const double center[3], double radius) {
    const rat_mark mark = rat_arena_mark();
    big sum = big_mul(big_from_double(radius), big_from_double(radius));
    int k, inside;
    for (k = 0; k < 3; k++) {
        const big d = big_sub(big_from_double(x[k]), big_from_double(center[k]));
        sum = big_sub(sum, big_mul(d, d));
    }
    inside = big_sign(sum) > 0;
    rat_arena_release(mark);
    return inside;
}

/* Is the node in a convex polyhedron whose faces face outward? Exact */
static int in_polyhedron(const double x[3], const gx_surface *s) {
    const rat_mark mark = rat_arena_mark();
    size_t t;
    int inside = 1;
    for (t = 0; t < s->triangle_count && inside; t++) {
        const uint32_t *n = s->triangles + 3 * t;
        inside = big_sign(big_orient3d(s->vertices + 3 * n[0], s->vertices + 3 * n[1], s->vertices + 3 * n[2], x)) < 0;
    }
    rat_arena_release(mark);
    return inside;
}

/* An octahedron, divided, with its corners at a distance from the centre */
static void make_ball(wl_surface *s, const double center[3], double radius, int rounds) {
    static const double axis[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const uint32_t faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    size_t t;
    int i, k;
    for (i = 0; i < 6; i++) wl_add_vertex(s, axis[i]);
    for (i = 0; i < 24; i += 3) wl_add_triangle(s, faces[i], faces[i + 1], faces[i + 2]);
    while (rounds-- > 0) {
        const size_t count = s->triangle_count;
        for (t = 0; t < count; t++) {
            uint32_t n[3], m[3];
            memcpy(n, s->triangles + 3 * t, sizeof n);
            for (i = 0; i < 3; i++) {
                double x[3], length = 0;
                for (k = 0; k < 3; k++)
                    x[k] = s->vertices[3 * n[i] + (uint32_t)k] + s->vertices[3 * n[(i + 1) % 3] + (uint32_t)k];
                for (k = 0; k < 3; k++) length += x[k] * x[k];
                for (k = 0; k < 3; k++) x[k] /= sqrt(length);
                for (m[i] = 0; m[i] < s->vertex_count; m[i]++)
                    if (memcmp(s->vertices + 3 * m[i], x, sizeof x) == 0) break;
                if (m[i] == s->vertex_count) wl_add_vertex(s, x);
            }
            wl_add_triangle(s, n[0], m[0], m[2]);
            wl_add_triangle(s, n[1], m[1], m[0]);
            wl_add_triangle(s, n[2], m[2], m[1]);
            memcpy(s->triangles + 3 * t, m, sizeof m);
        }
    }
    for (t = 0; t < 3 * s->vertex_count; t++) s->vertices[t] = center[t % 3] + radius * s->vertices[t];
}

/* What one region should hold, by copy: 1, 0, or 2 where the oracle can't tell */
static void expect_region(gx_body *body, const gx_region *r, const gx_view *view, uint8_t *expected) {
    workload w = wl_empty();
    wl_surface *shell = wl_add_surface(&w, 1), *outer = wl_add_surface(&w, 1);
    gx_surface solid;
    uint8_t *in = NULL, *near = NULL, *node = (uint8_t *)calloc(view->node_count, 1);
    size_t i, k;
    memset(expected, 0, view->copy_count);
    for (i = 0; i < view->node_count; i++) {
        const double *x = body->mesh.positions + 3 * i;
        switch (r->kind) {
        case GX_REGION_HALF_SPACE: node[i] = r->side < 0 ? x[r->axis] < r->value : x[r->axis] > r->value; break;
        case GX_REGION_BOX:
            for (k = 0, node[i] = 1; k < 3; k++) node[i] &= x[k] > r->low[k] && x[k] < r->high[k];
            break;
        case GX_REGION_SPHERE: node[i] = (uint8_t)in_ball(x, r->center, r->radius); break;
        case GX_REGION_SURFACE: node[i] = (uint8_t)in_polyhedron(x, r->surface); break;
        default:
            for (k = 0; k < r->node_count; k++) node[i] |= r->nodes[k] == i;
        }
    }
    if (r->kind == GX_REGION_HALF_SPACE) {
        double low[3] = {-64, -64, -64}, high[3] = {64, 64, 64};
        (r->side < 0 ? high : low)[r->axis] = r->value;
        wl_add_aligned_box(shell, low, high);
    }
    if (r->kind == GX_REGION_BOX) wl_add_aligned_box(shell, r->low, r->high);
    if (r->kind == GX_REGION_SPHERE) { /* a polyhedron in the ball, and one around it */
        make_ball(shell, r->center, 0.999 * r->radius, 3);
        make_ball(outer, r->center, 1.03 * r->radius, 3);
        solid = surface_of(outer);
        near = cells_in(body, &solid);
    }
    solid = r->kind == GX_REGION_SURFACE ? *r->surface : surface_of(shell);
    if (r->kind != GX_REGION_NODES) in = cells_in(body, &solid);
    for (i = 0; i < view->cell_count; i++)
        for (k = 0; k < 4; k++) {
            const uint32_t copy = view->cell_copies[4 * i + k], cell = gxp_cell_of_slot(body, view->cell_slot[i]);
            int corner = 0;
            if (!node[view->copy_node[copy]] || expected[copy] == 1) continue;
            if (in == NULL) ck_assert_int_eq(gxp_has_corner(body, cell, view->copy_node[copy], &corner), GX_OK);
            if (in != NULL ? in[cell] : corner)
                expected[copy] = 1;
            else if (near != NULL && near[cell])
                expected[copy] = 2;
        }
    free(node);
    free(in);
    free(near);
    wl_free(&w);
}

/* Compares all that is held; returns how many copies the oracle was sure about. */
static size_t check_held(gx_body *body, const gx_region *regions, size_t count, uint64_t seed) {
    const gx_view view = view_of(body);
    uint8_t *expected = (uint8_t *)calloc(view.copy_count + 1, 1);
    uint32_t *first = (uint32_t *)malloc((view.copy_count + 1) * sizeof *first);
    uint8_t *unsure = (uint8_t *)calloc(view.copy_count + 1, 1);
    size_t r, c, sure = 0;
    for (c = 0; c < view.copy_count; c++) first[c] = UINT32_MAX;
    for (r = 0; r < count; r++) {
        expect_region(body, &regions[r], &view, expected);
        for (c = 0; c < view.copy_count; c++) {
            if (expected[c] == 1 && first[c] == UINT32_MAX) first[c] = (uint32_t)r;
            if (expected[c] == 2 && first[c] == UINT32_MAX) unsure[c] = 1;
        }
    }
    for (c = 0; c < view.copy_count; c++) {
        if (unsure[c]) continue;
        sure++;
        ck_assert_msg(view.copy_region[c] == first[c] && view.copy_held[c] == (first[c] != UINT32_MAX),
                      "seed %llu: copy %zu of node %u is held by %d, should be by %d", (unsigned long long)seed, c,
                      view.copy_node[c], (int)view.copy_region[c], (int)first[c]);
    }
    free(expected);
    free(first);
    free(unsure);
    return sure;
}

/* ---- random regions ---- */

/* Arrays of the regions; a region refers to them. */
typedef struct stock {
    workload surfaces;
    gx_surface shell[4];
    uint32_t nodes[4][8];
    gx_region region[4];
} stock;

static void make_region(stock *s, size_t i, const workload *w) {
    double p[3], low[3], high[3];
    wl_frame f = wl_rotated();
    int k;
    random_point(w, p);
    for (k = 0; k < 3; k++) {
        low[k] = random_below(3) ? p[k] - random_real(0.05, 0.7) : random_below(5) / 4.0 - 0.25;
        high[k] = random_below(3) ? p[k] + random_real(0.05, 0.7) : random_below(5) / 4.0 + 0.5;
    }
    for (k = 0; k < 3; k++)
        if (high[k] <= low[k]) high[k] = low[k] + 0.5;
    switch (random_below(5)) {
    case 0:
        s->region[i] =
            gx_region_half_space((uint32_t)random_below(3), random_below(2) ? 1 : -1, random_below(2) ? 0.5 : p[0]);
        break;
    case 1: s->region[i] = gx_region_box(low, high); break;
    case 2: s->region[i] = gx_region_sphere(p, random_real(0.1, 0.9)); break;
    case 3: {
        wl_surface *shell = wl_add_surface(&s->surfaces, 1);
        memcpy(f.origin, p, sizeof p);
        if (random_below(2))
            wl_add_aligned_box(shell, low, high);
        else
            make_ball(shell, p, random_real(0.2, 0.8), random_below(2));
        s->shell[i] = surface_of(shell);
        memset(&s->region[i], 0, sizeof s->region[i]);
        s->region[i].kind = GX_REGION_SURFACE;
        s->region[i].surface = &s->shell[i];
        break;
    }
    default:
        memset(&s->region[i], 0, sizeof s->region[i]);
        s->region[i].kind = GX_REGION_NODES;
        s->region[i].nodes = s->nodes[i];
        for (k = 0; k < 8; k++) s->nodes[i][k] = (uint32_t)random_below((int)w->node_count);
        s->region[i].node_count = 1 + (size_t)random_below(8);
    }
}

/* Up to three regions that each hold something; those that do not are refused, and change nothing. */
static size_t hold_some(gx_body *body, stock *s, const workload *w, uint64_t seed) {
    const size_t wanted = 1 + (size_t)random_below(3);
    size_t count = 0;
    int tries;
    for (tries = 0; tries < 20 && count < wanted; tries++) {
        const uint64_t state = gx_body_state_hash(body);
        gx_failure failure;
        make_region(s, count, w);
        if (gx_body_hold(body, s->region, count + 1, &failure) == GX_OK) {
            count++;
            continue;
        }
        CHECK_SEED(failure.result == GX_ERROR_EMPTY && failure.index == count, seed);
        CHECK_SEED(gx_body_state_hash(body) == state, seed);
    }
    return count;
}

START_TEST(what_regions_hold) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w;
    gx_body *body;
    stock s;
    size_t count, sure = 0;
    int cut;
    random_seed(seed);
    memset(&s, 0, sizeof s);
    w = random_below(2) ? random_mesh() : grid(2, 2, 1, random_below(2) ? 5 : 6);
    body = body_of(&w);
    for (cut = random_below(2); cut > 0; cut--) {
        add_random_cut(&w, 0);
        cut_by(body, &w, w.surface_count - 1, 1);
    }
    count = hold_some(body, &s, &w, seed);
    sure += check_held(body, s.region, count, seed);
    for (cut = 0; cut < 5; cut++) {
        add_random_cut(&w, cut == 3);
        cut_by(body, &w, w.surface_count - 1, 1);
        sure += check_held(body, s.region, count, seed);
    }
    CHECK_SEED(sure > 0 || view_of(body).copy_count == 0, seed);
    gx_body_destroy(body);
    wl_free(&s.surfaces);
    wl_free(&w);
}
END_TEST

/* A ball whose square is no double holds all, one whose square is next to nothing the node that it is around. */
START_TEST(balls_beyond_doubles) {
    static const double at[3] = {0, 0, 0}, radius[2] = {1e200, 1e-145};
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w);
    const gx_region ball = gx_region_sphere(at, radius[_i]);
    gx_view view;
    size_t i;
    ck_assert_int_eq(gx_body_hold(body, &ball, 1, NULL), GX_OK);
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) ck_assert_uint_eq(view.copy_held[i], _i == 0 || view.copy_node[i] == 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Boxes that end exactly in walls: what lies beyond is free. */
START_TEST(boxes_beside_walls) {
    const double low[3] = {-0.25, -0.25, -0.25}, high[3] = {0.25, 1.25, 1.25};
    const gx_region box = gx_region_box(low, high);
    workload w = grid(1, 1, 1, _i ? 5 : 6);
    gx_body *body = body_of(&w);
    gx_view view;
    size_t c, held = 0, i;
    add_axis_plane(&w, 0, 0.25);
    ck_assert_int_eq(gx_body_hold(body, &box, 1, NULL), GX_OK);
    cut_by(body, &w, 0, 1);
    check_held(body, &box, 1, 0);
    view = view_of(body);
    for (i = 0; i < view.cell_count; i++) {
        const int beyond = view.fragment_center[3 * view.cell_fragment[i]] > 0.25;
        for (c = 0; c < 4; c++) {
            const uint32_t copy = view.cell_copies[4 * i + c];
            ck_assert(!beyond || !view.copy_held[copy]);
            held += view.copy_held[copy];
        }
    }
    ck_assert_uint_gt(held, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Anchors: what they name does not move, whatever is cut; lost ones hold nothing. */
START_TEST(anchors_that_hold) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w = grid(2, 1, 1, 6);
    gx_body *body = body_of(&w);
    gx_anchor anchors[6];
    gx_region region;
    gx_step_desc step;
    double before[6][3], after[3];
    uint8_t lost[6], still[64 * 8];
    size_t i, c;
    uint32_t k;
    int cut;
    random_seed(seed);
    memset(&step, 0, sizeof step);
    step.dt = 0.02;
    step.gravity[2] = -9.81;
    for (i = 0; i < 6; i++) {
        const uint32_t element = (uint32_t)random_below((int)w.element_count), *n = w.elements + 4 * element;
        double x[3] = {0, 0, 0}, weight[4], sum = 0;
        for (k = 0; k < 4; k++) sum += weight[k] = random_below(3) ? random_real(0.1, 1) : 0;
        if (!(sum > 0)) sum = weight[0] = 1;
        for (k = 0; k < 12; k++) x[k % 3] += weight[k / 3] / sum * w.positions[3 * n[k / 3] + k % 3];
        ck_assert_int_eq(gx_body_anchor(body, element, x, &anchors[i], NULL), GX_OK);
    }
    memset(&region, 0, sizeof region);
    region.kind = GX_REGION_ANCHORS;
    region.anchors = anchors;
    region.anchor_count = 6;
    ck_assert_int_eq(gx_body_hold(body, &region, 1, NULL), GX_OK);
    for (cut = 0; cut < 4; cut++) {
        gx_view view;
        add_random_cut(&w, cut == 2);
        cut_by(body, &w, w.surface_count - 1, 1);
        view = view_of(body);
        ck_assert_uint_le(view.copy_count, sizeof still);
        memset(still, 0, sizeof still);
        ck_assert_int_eq(gx_body_lost_anchors(body, anchors, 6, lost, NULL), GX_OK);
        for (i = 0; i < 6; i++) {
            gxs_point point;
            if (lost[i]) continue;
            ck_assert_int_eq(gx_body_anchor_point(body, &anchors[i], &point, before[i], NULL), GX_OK);
            for (k = 0; k < point.count; k++) still[point.copy[k]] = 1;
        }
        for (c = 0; c < view.copy_count; c++) CHECK_SEED(view.copy_held[c] == still[c], seed);
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        for (i = 0; i < 6; i++) {
            if (lost[i]) continue;
            ck_assert_int_eq(gx_body_anchor_point(body, &anchors[i], NULL, after, NULL), GX_OK);
            for (k = 0; k < 3; k++) CHECK_SEED(fabs(after[k] - before[i][k]) < 1e-14, seed);
        }
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- poses ---- */

static void turn(double angle, double shift, double pose[12]) { /* about z, then along x */
    memset(pose, 0, 12 * sizeof *pose);
    pose[0] = pose[5] = cos(angle);
    pose[1] = -sin(angle);
    pose[4] = sin(angle);
    pose[10] = 1;
    pose[3] = shift;
}

/* The first region that holds a copy moves it; one without a pose leaves its copies their targets, or where they are.
 */
START_TEST(poses_move_what_is_held) {
    const double low[3] = {-1, -1, -1}, high[3] = {0.5, 2, 2}, center[3] = {0, 0, 0};
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_region regions[3] = {gx_region_sphere(center, 0.5), gx_region_box(low, high), gx_region_half_space(0, 1, 1.5)};
    gx_step_desc step;
    double poses[36], *targets;
    gx_view view;
    size_t c, k;
    int i;
    add_axis_plane(&w, 2, 0.5);
    ck_assert_int_eq(gx_body_hold(body, regions, 3, NULL), GX_OK);
    memset(&step, 0, sizeof step);
    memset(poses, 0, sizeof poses);
    step.dt = 0.01;
    step.region_poses = poses;
    for (i = 0; i < 6; i++) {
        if (i == 3) cut_by(body, &w, 0, 1);
        turn(0.1 * i, 0.05 * i, poses);
        turn(-0.05 * i, -0.02 * i, poses + 12);
        view = view_of(body);
        targets = (double *)malloc(3 * view.copy_count * sizeof *targets);
        for (k = 0; k < 3 * view.copy_count; k++) targets[k] = i % 2 ? 0.01 * i : view.displacement[k];
        step.targets = i % 2 ? targets : NULL;
        step.epoch = view.epoch;
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        for (c = 0; c < view.copy_count; c++) {
            const double *x = w.positions + 3 * view.copy_node[c], *pose;
            if (!view.copy_held[c]) continue;
            ck_assert_uint_lt(view.copy_region[c], 3);
            pose = poses + 12 * view.copy_region[c];
            if (view.copy_region[c] == 0) ck_assert_uint_eq(view.copy_node[c], 0);
            for (k = 0; k < 3; k++) {
                const double there = view.copy_region[c] == 2 ? targets[3 * c + k]
                                                              : pose[4 * k] * x[0] + pose[4 * k + 1] * x[1] +
                                                                    pose[4 * k + 2] * x[2] + pose[4 * k + 3] - x[k];
                ck_assert(fabs(view.displacement[3 * c + k] - there) < 1e-15);
            }
        }
        free(targets);
    }
    ck_assert_uint_gt(view.copy_count, w.node_count);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Steps by poses are steps by targets, bit for bit. */
START_TEST(poses_are_targets) {
    workload w = grid(2, 2, 1, 6);
    gx_body *by_poses = body_of(&w), *by_targets = NULL;
    const gx_region left = gx_region_half_space(0, -1, 0.5);
    gx_step_desc step, other;
    double pose[12], *targets;
    gx_view view;
    size_t c, k;
    int i;
    add_plane(&w, w.positions + 3 * 5, w.positions + 3 * 17, 3);
    cut_by(by_poses, &w, 0, 1);
    ck_assert_int_eq(gx_body_hold(by_poses, &left, 1, NULL), GX_OK);
    view = view_of(by_poses);
    by_targets = clone_of(by_poses);
    view = view_of(by_targets);
    targets = (double *)calloc(3 * view.copy_count, sizeof *targets);
    memset(&step, 0, sizeof step);
    step.dt = 0.02;
    step.gravity[1] = -9.81;
    other = step;
    step.region_poses = pose;
    other.targets = targets;
    other.epoch = view.epoch;
    for (i = 0; i < 10; i++) {
        turn(0.02 * i, 0.01 * i, pose);
        for (c = 0; c < view.copy_count; c++)
            for (k = 0; k < 3 && view.copy_held[c]; k++) {
                const double *x = w.positions + 3 * view.copy_node[c], *row = pose + 4 * k;
                targets[3 * c + k] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3] - x[k];
            }
        ck_assert_int_eq(gx_body_step(by_poses, &step, NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_body_step(by_targets, &other, NULL, NULL), GX_OK);
        ck_assert(gx_body_state_hash(by_poses) == gx_body_state_hash(by_targets));
    }
    free(targets);
    gx_body_destroy(by_poses);
    gx_body_destroy(by_targets);
    wl_free(&w);
}
END_TEST

/* ---- copies, cost, refusals ---- */

/* Regions go with a body: the caller's arrays may go. */
START_TEST(regions_of_copies) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w = grid(2, 1, 1, 5);
    gx_body *body, *clone, *read = NULL, *bare;
    unsigned char *bytes;
    size_t size = 0, count;
    stock s;
    gx_view p, q;
    random_seed(seed);
    memset(&s, 0, sizeof s);
    add_random_plane(&w, 40);
    add_random_plane(&w, 40);
    body = body_of(&w);
    bare = clone_of(body);
    count = hold_some(body, &s, &w, seed);
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = (unsigned char *)malloc(size);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &read, NULL), GX_OK);
    clone = clone_of(body);
    CHECK_SEED(gx_body_state_hash(read) == gx_body_state_hash(body), seed);
    CHECK_SEED(gx_body_state_hash(clone) == gx_body_state_hash(body), seed);
    cut_by(body, &w, 0, 2);
    cut_by(read, &w, 0, 2);
    cut_by(clone, &w, 0, 2);
    check_held(body, s.region, count, seed);
    p = view_of(body);
    q = view_of(read);
    CHECK_SEED(memcmp(p.copy_region, q.copy_region, p.copy_count * sizeof *p.copy_region) == 0, seed);
    q = view_of(clone);
    CHECK_SEED(memcmp(p.copy_region, q.copy_region, p.copy_count * sizeof *p.copy_region) == 0, seed);
    ck_assert_int_eq(gx_body_restore(body, bare, NULL), GX_OK); /* cut otherwise: a new body */
    check_held(body, NULL, 0, seed);
    ck_assert_int_eq(gx_body_hold(clone, NULL, 0, NULL), GX_OK);
    ck_assert_int_eq(gx_body_restore(clone, read, NULL), GX_OK); /* cut alike: the state alone */
    check_held(clone, s.region, count, seed);
    ck_assert_int_eq(gx_body_restore(read, bare, NULL), GX_OK);
    ck_assert_int_eq(gx_body_restore(bare, clone, NULL), GX_OK);
    check_held(bare, s.region, count, seed);
    free(bytes);
    gx_body_destroy(body);
    gx_body_destroy(clone);
    gx_body_destroy(read);
    gx_body_destroy(bare);
    wl_free(&s.surfaces);
    wl_free(&w);
}
END_TEST

/* Nodes far from a region are not asked about, after a cut neither. */
START_TEST(cost_is_that_of_the_region) {
    const double center[3] = {1, 1, 1}, low[3] = {0.5, 0.5, 0.5}, high[3] = {1.5, 1.5, 1.5};
    const gx_region regions[2] = {gx_region_sphere(center, 1.1), gx_region_box(low, high)};
    workload w = grid(16, 16, 16, 5);
    gx_body *body = body_of(&w);
    int i;
    add_axis_plane(&w, 0, 1.25);
    for (i = 0; i < 2; i++) {
        ck_assert_int_eq(gx_body_hold(body, &regions[i], 1, NULL), GX_OK);
        ck_assert_uint_eq(body->holds.nodes.count, i == 0 ? 7 : 1);
        ck_assert_uint_lt(body->holds.near_nodes.count, 300);
    }
    body->holds.near_nodes.count = 77;
    cut_by(body, &w, 0, 1);
    (void)view_of(body);
    ck_assert_uint_eq(body->holds.near_nodes.count, 77); /* the lists stay */
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static void expect(gx_body *body, uint64_t state, const gx_failure *failure, gx_result result, gx_result expected,
                   const char *field, int line) {
    ck_assert_msg(result == expected && failure->result == expected, "line %d: %s, should be: %s", line,
                  gx_result_text(result), gx_result_text(expected));
    ck_assert_msg(failure->field != NULL && strcmp(failure->field, field) == 0, "line %d: field %s", line,
                  failure->field != NULL ? failure->field : "NULL");
    ck_assert_msg(failure->index == 1, "line %d: index %zu", line, failure->index);
    ck_assert_msg(gx_body_state_hash(body) == state, "line %d: the body has changed", line);
}

#define REFUSED(expected, field)                                                                                       \
    expect(body, state, &failure, gx_body_hold(body, regions, 2, &failure), expected, field, __LINE__)

START_TEST(refused_regions) {
    static const double x[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, far[12] = {0, 0, 0, 1e60, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t closed[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3},
                          wrong[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 4};
    static const uint32_t nodes[3] = {1, 2, 8};
    const double low[3] = {-1, -1, -1}, high[3] = {0.5, 2, 2};
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_region regions[2];
    gx_surface shell;
    gx_anchor anchor;
    gx_failure failure;
    uint64_t state;
    const double inside[3] = {0.5, 0.5, 0.5};
    uint32_t element = 0;
    while (gx_body_anchor(body, element, inside, &anchor, NULL) != GX_OK) element++;
    regions[0] = regions[1] = gx_region_box(low, high);
    ck_assert_int_eq(gx_body_hold(body, regions, 1, NULL), GX_OK);
    state = gx_body_state_hash(body);
    regions[1].kind = 6;
    REFUSED(GX_ERROR_ARGUMENT, "regions.kind");
    regions[1] = regions[0];
    regions[1].low[1] = NAN;
    REFUSED(GX_ERROR_NOT_FINITE, "regions.low");
    regions[1].low[1] = -1e60;
    REFUSED(GX_ERROR_RANGE, "regions.low");
    regions[1] = regions[0];
    regions[1].high[2] = INFINITY;
    REFUSED(GX_ERROR_NOT_FINITE, "regions.high");
    regions[1].high[2] = 1e60;
    REFUSED(GX_ERROR_RANGE, "regions.high");
    regions[1].high[2] = -1;
    REFUSED(GX_ERROR_ARGUMENT, "regions.high");
    regions[1] = gx_region_box(low, high);
    regions[1].high[0] = -0.5;
    REFUSED(GX_ERROR_EMPTY, "regions");
    regions[1] = gx_region_sphere(inside, 0.5);
    REFUSED(GX_ERROR_EMPTY, "regions");
    regions[1].radius = 0;
    REFUSED(GX_ERROR_ARGUMENT, "regions.radius");
    regions[1].radius = INFINITY;
    REFUSED(GX_ERROR_NOT_FINITE, "regions.radius");
    regions[1].center[0] = NAN;
    REFUSED(GX_ERROR_NOT_FINITE, "regions.center");
    regions[1].center[0] = 1e60;
    REFUSED(GX_ERROR_RANGE, "regions.center");
    memset(&regions[1], 0, sizeof regions[1]);
    regions[1].kind = GX_REGION_SURFACE;
    REFUSED(GX_ERROR_ARGUMENT, "regions.surface");
    memset(&shell, 0, sizeof shell);
    regions[1].surface = &shell;
    REFUSED(GX_ERROR_EMPTY, "regions.surface.vertex_count");
    shell.vertex_count = 4;
    REFUSED(GX_ERROR_EMPTY, "regions.surface.triangle_count");
    shell.triangle_count = 4;
    REFUSED(GX_ERROR_ARGUMENT, "regions.surface.vertices");
    shell.vertices = far;
    REFUSED(GX_ERROR_ARGUMENT, "regions.surface.triangles");
    shell.triangles = closed;
    REFUSED(GX_ERROR_RANGE, "regions.surface.vertices");
    shell.vertices = x;
    shell.triangles = wrong;
    REFUSED(GX_ERROR_INDEX, "regions.surface.triangles");
    shell.triangles = closed;
    REFUSED(GX_ERROR_EMPTY, "regions"); /* all its nodes are on its boundary */
    shell.triangle_count = 3;
    REFUSED(GX_ERROR_NOT_CLOSED, "regions.surface.triangles");
    shell.vertex_count = INT32_MAX;
    REFUSED(GX_ERROR_LIMIT, "regions.surface.vertex_count");
    shell.vertex_count = 4;
    shell.triangle_count = INT32_MAX;
    REFUSED(GX_ERROR_LIMIT, "regions.surface.triangle_count");
    regions[1].kind = GX_REGION_NODES;
    REFUSED(GX_ERROR_EMPTY, "regions.node_count");
    regions[1].node_count = 3;
    REFUSED(GX_ERROR_ARGUMENT, "regions.nodes");
    regions[1].nodes = nodes;
    REFUSED(GX_ERROR_INDEX, "regions.nodes");
    regions[1].node_count = INT32_MAX;
    REFUSED(GX_ERROR_LIMIT, "regions.node_count");
    regions[1].kind = GX_REGION_ANCHORS;
    REFUSED(GX_ERROR_EMPTY, "regions.anchor_count");
    regions[1].anchor_count = 1;
    REFUSED(GX_ERROR_ARGUMENT, "regions.anchors");
    regions[1].anchors = &anchor;
    anchor.element = 5;
    REFUSED(GX_ERROR_INDEX, "regions.anchors.element");
    anchor.element = element;
    anchor.position[0] = 7;
    REFUSED(GX_ERROR_ARGUMENT, "regions.anchors.position");
    anchor.position[0] = NAN;
    REFUSED(GX_ERROR_NOT_FINITE, "regions.anchors.position");
    anchor.position[0] = 0.5;
    anchor.toward[0] = INFINITY;
    REFUSED(GX_ERROR_NOT_FINITE, "regions.anchors.toward");
    anchor.toward[0] = 0.5;
    regions[1].anchor_count = INT32_MAX;
    REFUSED(GX_ERROR_LIMIT, "regions.anchor_count");
    regions[1].anchor_count = 1;
    add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75);
    cut_by(body, &w, 0, 1);
    state = gx_body_state_hash(body);
    REFUSED(GX_ERROR_EMPTY, "regions"); /* the anchor is lost */
    ck_assert_int_eq(gx_body_hold(body, regions, (size_t)INT32_MAX, &failure), GX_ERROR_LIMIT);
    ck_assert(strcmp(failure.field, "region_count") == 0 && failure.index == SIZE_MAX);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(refused_poses) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    const gx_region regions[2] = {gx_region_half_space(0, -1, 0.25), gx_region_half_space(0, 1, 0.75)};
    gx_step_desc step;
    gx_failure failure;
    double poses[24], targets[3 * 64];
    uint64_t state;
    add_axis_plane(&w, 1, 0.5);
    body = cut_at_once(&w);
    memset(&step, 0, sizeof step);
    memset(poses, 0, sizeof poses);
    memset(targets, 0, sizeof targets);
    step.dt = 0.01;
    step.region_poses = poses; /* of no region: not read */
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    ck_assert_int_eq(gx_body_hold(body, regions, 2, NULL), GX_OK);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    state = gx_body_state_hash(body);
    poses[13] = NAN;
    expect(body, state, &failure, gx_body_step(body, &step, NULL, &failure), GX_ERROR_NOT_FINITE, "region_poses",
           __LINE__);
    poses[13] = 0;
    step.targets = targets;
    step.epoch = 77;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_STALE);
    ck_assert_str_eq(failure.field, "epoch");
    step.targets = NULL; /* poses name no copies */
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("holds");
    TCase *tests = tcase_create("holds");
    tcase_set_timeout(tests, 300);
    ADD_SOME(tests, what_regions_hold, 150);
    tcase_add_loop_test(tests, balls_beyond_doubles, 0, 2);
    tcase_add_loop_test(tests, boxes_beside_walls, 0, 2);
    ADD_SOME(tests, anchors_that_hold, 30);
    tcase_add_test(tests, poses_move_what_is_held);
    tcase_add_test(tests, poses_are_targets);
    ADD_SOME(tests, regions_of_copies, 30);
    tcase_add_test(tests, cost_is_that_of_the_region);
    tcase_add_test(tests, refused_regions);
    tcase_add_test(tests, refused_poses);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) { return run_suite(suite()); }
