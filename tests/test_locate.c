/* test_locate.c - points of space and rays beside slow and obvious answers. Which cells contain a point: by exact
   numbers, over all cells and by the facets of their leaves, where the library walks trees of boxes and planes. What is
   nearest: over all facets, by another method. What a ray meets: over all triangles of the skin. Bodies are random
   ones, deformed, inverted, collapsed, cut, moved apart and into each other, restored and read again. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include <float.h>
#include "body.h"
#include "rational.h"

enum { SEEDS = 40, MOST_SLOTS = 4096 };

/* ---- motions: of a body that may be cut ---- */

enum { AT_REST, DYADIC, CALM, VIOLENT, COLLAPSED, FAR, MOTIONS };

static void move_copy(const gx_view *view, const workload *w, uint32_t copy, int motion, const double shift[3]) {
    const double *rest = w->positions + 3 * (size_t)view->copy_node[copy];
    double *u = view->displacement + 3 * (size_t)copy;
    int k;
    for (k = 0; k < 3; k++) switch (motion) {
        case AT_REST: u[k] = 0; break;
        case DYADIC: u[k] = random_below(5) / 8.0 - 0.25 + shift[k]; break;
        case CALM: u[k] = random_real(-0.1, 0.1) + shift[k]; break;
        case VIOLENT: u[k] = random_real(-1, 1); break;                               /* turns many elements over */
        case COLLAPSED: u[k] = k == 2 ? 0.5 - rest[2] : random_below(3) / 8.0; break; /* into a plane, exactly */
        default: u[k] = random_real(-0.1, 0.1) + 1e6 * (k + 1) + shift[k]; break;
        }
}

/* Each fragment has a shift of its own, so that pieces lie over each other or far apart. */
static void move_body(gx_body *body, const workload *w, int motion) {
    const gx_view view = view_of(body);
    double shift[64][3];
    size_t i;
    int k, f;
    for (f = 0; f < 64; f++)
        for (k = 0; k < 3; k++) shift[f][k] = f == 0 || motion == AT_REST ? 0 : random_below(9) / 8.0 - 0.5;
    for (i = 0; i < view.cell_count; i++)
        for (k = 0; k < 4; k++)
            move_copy(&view, w, view.cell_copies[4 * i + (size_t)k], motion, shift[view.cell_fragment[i] % 64]);
}

static void corners_of(const gx_body *body, uint32_t slot, double x[4][3]) {
    const gxp_cell *cell = &body->cells.data[slot];
    int n, k;
    for (n = 0; n < 4; n++)
        for (k = 0; k < 3; k++)
            x[n][k] =
                body->mesh.positions[3 * gxb_complex_element_nodes(body->complex, cell->element)[n] + (uint32_t)k] +
                body->copies.displacement[3 * cell->copies[n] + (uint32_t)k];
}

/* ---- the exact oracle ---- */

/* D_i: the volume of the moved element with the point in the place of corner i; returns that of the element */
static big shares_of(double x[4][3], const double p[3], big share[4]) {
    int i;
    for (i = 0; i < 4; i++)
        share[i] = big_orient3d(i == 0 ? p : x[0], i == 1 ? p : x[1], i == 2 ? p : x[2], i == 3 ? p : x[3]);
    return big_orient3d(x[0], x[1], x[2], x[3]);
}

/* Given coordinates of points of the complex, in its frame */
static const double *frame_point(const gx_body *body, uint32_t point) {
    const gxb_cpoint *p = gxb_complex_point(body->complex, point);
    ck_assert(p->kind == GXB_EXPLICIT && !(p->ball.error > 0));
    return p->ball.x;
}

/* Sign of the material point sum D_i X_i / D against a plane of the complex, as the plane is defined */
static int side_of(const gx_body *body, uint32_t element, const big share[4], big whole, uint32_t plane) {
    const gxb_cplane *f = gxb_complex_plane(body->complex, plane);
    const double *p = frame_point(body, f->def[0]), *q = frame_point(body, f->def[1]);
    big u[3], v[3], n[3], x[3], sum = big_zero();
    int i;
    big_difference(q, p, u);
    if (f->along_axis)
        for (i = 0; i < 3; i++) v[i] = big_from_int(i == (int)f->def[2]);
    else
        big_difference(frame_point(body, f->def[2]), p, v);
    big_cross(u, v, n);
    for (i = 0; i < 4; i++) {
        big_difference(frame_point(body, gxb_complex_element_nodes(body->complex, element)[i]), p, x);
        sum = big_add(sum, big_mul(share[i], big_dot(n, x)));
    }
    return big_sign(sum) * big_sign(whole);
}

/* Is the material point in the closed leaf, by its facets? */
static int leaf_has(gx_body *body, uint32_t leaf, const big share[4], big whole) {
    const uint32_t element = gxb_complex_leaf(body->complex, leaf)->element;
    uint32_t first, count, i;
    ck_assert_int_eq(gxb_leaf_resolve_facets(body->complex, leaf, &first, &count), GX_OK);
    for (i = 0; i < count; i++) {
        const gxb_facet *f = gxb_complex_facet(body->complex, gxp_item(body->complex, first + i));
        if (side_of(body, element, share, whole, f->plane) * (f->leaf[0] == leaf ? 1 : -1) < 0) return 0;
    }
    return 1;
}

static int cell_has(gx_body *body, uint32_t slot, const double p[3]) {
    const gxp_cell *cell = &body->cells.data[slot];
    double x[4][3];
    big share[4], whole;
    uint32_t leaf;
    int i, k;
    if (!cell->kept) return 0;
    corners_of(body, slot, x);
    for (k = 0; k < 3; k++) { /* beside the box of its corners */
        if (p[k] < fmin(fmin(x[0][k], x[1][k]), fmin(x[2][k], x[3][k]))) return 0;
        if (p[k] > fmax(fmax(x[0][k], x[1][k]), fmax(x[2][k], x[3][k]))) return 0;
    }
    whole = shares_of(x, p, share);
    if (big_sign(whole) == 0) return 0;
    for (i = 0; i < 4; i++)
        if (big_sign(share[i]) * big_sign(whole) < 0) return 0;
    if (!(gxb_complex_root(body->complex, cell->element) & 1)) return 1;
    for (leaf = cell->first_leaf; leaf != UINT32_MAX; leaf = body->leaves.data[leaf].next)
        if (leaf_has(body, leaf, share, whole)) return 1;
    return 0;
}

/* All cells that contain the point, ascending */
static size_t cells_at(gx_body *body, const double p[3], uint32_t *slots) {
    const rat_mark mark = rat_arena_mark();
    size_t count = 0;
    uint32_t slot;
    for (slot = 0; slot < body->cells.count; slot++)
        if (cell_has(body, slot, p)) slots[count++] = slot;
    rat_arena_release(mark);
    return count;
}

/* |material - the exact one|, the largest component, in longest edges of the element at rest */
static double error_of(gx_body *body, const double p[3], const gx_hit *hit) {
    const rat_mark mark = rat_arena_mark();
    const uint32_t *node = gxb_complex_element_nodes(body->complex, hit->element);
    double x[4][3], error = 0, longest = 0;
    big share[4], whole;
    int i, j, k;
    corners_of(body, gxp_cell_of_slot(body, hit->slot), x);
    whole = shares_of(x, p, share);
    for (k = 0; k < 3; k++) {
        big sum = big_zero();
        for (i = 0; i < 4; i++)
            sum = big_add(sum, big_mul(share[i], big_from_double(body->mesh.positions[3 * node[i] + (uint32_t)k])));
        error = fmax(error, fabs(rat_to_double(rat_sub(rat_ratio(sum, whole), rat_from_double(hit->material[k])))));
    }
    for (i = 0; i < 4; i++)
        for (j = 0; j < i; j++) {
            const double *a = body->mesh.positions + 3 * node[i], *b = body->mesh.positions + 3 * node[j];
            longest = fmax(longest, sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2)));
        }
    rat_arena_release(mark);
    return error / longest;
}

/* ---- the nearest surface ---- */

/* The nearest point of a triangle, by the regions of its Voronoi diagram [Ericson, Real-Time Collision
 * Detection, 5.1.5]
 */
static double triangle_distance(const double *p, const double *a, const double *b, const double *c) {
    double ab[3], ac[3], ap[3], bp[3], cp[3], x[3], d1, d2, d3, d4, d5, d6, va, vb, vc, t, s, sum = 0;
    int k;
    for (k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ac[k] = c[k] - a[k];
        ap[k] = p[k] - a[k];
        bp[k] = p[k] - b[k];
        cp[k] = p[k] - c[k];
    }
    d1 = gxp_dot(ab, ap);
    d2 = gxp_dot(ac, ap);
    d3 = gxp_dot(ab, bp);
    d4 = gxp_dot(ac, bp);
    d5 = gxp_dot(ab, cp);
    d6 = gxp_dot(ac, cp);
    vc = d1 * d4 - d3 * d2;
    vb = d5 * d2 - d1 * d6;
    va = d3 * d6 - d5 * d4;
    t = s = 0;
    if (d1 <= 0 && d2 <= 0) {
    } else if (d3 >= 0 && d4 <= d3)
        t = 1;
    else if (d6 >= 0 && d5 <= d6)
        s = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        t = d1 / (d1 - d3);
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        s = d2 / (d2 - d6);
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        t = 1 - s;
    } else {
        t = vb / (va + vb + vc);
        s = vc / (va + vb + vc);
    }
    for (k = 0; k < 3; k++) x[k] = a[k] + t * ab[k] + s * ac[k] - p[k];
    for (k = 0; k < 3; k++) sum += x[k] * x[k];
    return sqrt(sum);
}

static double polygon_distance(const double *p, double (*x)[3], uint32_t count) {
    double least = HUGE_VAL;
    uint32_t i;
    for (i = 2; i < count; i++) least = fmin(least, triangle_distance(p, x[0], x[i - 1], x[i]));
    return least;
}

/* The distance of a cell's surface */
static double cell_distance(gx_body *body, uint32_t slot, const double p[3]) {
    static const uint8_t face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const gxp_cell *cell = &body->cells.data[slot];
    gxb_complex *cx = body->complex;
    double x[4][3], polygon[64][3], least = HUGE_VAL;
    uint32_t leaf, first, count, e0, en, i, j;
    int k, n;
    corners_of(body, slot, x);
    for (k = 0; k < 4 && !(gxb_complex_root(cx, cell->element) & 1); k++)
        least = fmin(least, triangle_distance(p, x[face[k][0]], x[face[k][1]], x[face[k][2]]));
    for (leaf = cell->first_leaf; leaf != UINT32_MAX && (gxb_complex_root(cx, cell->element) & 1);
         leaf = body->leaves.data[leaf].next) {
        ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
        for (i = 0; i < count; i++) {
            ck_assert_int_eq(gxb_facet_resolve_edges(cx, gxp_item(cx, first + i), &e0, &en), GX_OK);
            ck_assert_uint_le(en, 64);
            for (j = 0; j < en; j++) {
                double lambda[4];
                gxb_complex_barycentric(cx, gxb_complex_edge_start(cx, gxp_item(cx, e0 + j)), cell->element, lambda);
                for (k = 0; k < 3; k++)
                    for (polygon[j][k] = 0, n = 0; n < 4; n++) polygon[j][k] += lambda[n] * x[n][k];
            }
            least = fmin(least, polygon_distance(p, polygon, en));
        }
    }
    return least;
}

/* ---- hits ---- */

static void check_fields(gx_body *body, const gx_hit *hit, uint64_t seed) {
    const gx_view view = view_of(body);
    const gxp_cell *cell = &body->cells.data[gxp_cell_of_slot(body, hit->slot)];
    double sum = 0, x[3] = {0, 0, 0};
    uint32_t i, n;
    int k;
    CHECK_SEED(hit->cell < view.cell_count && body->view.slot[hit->cell] == hit->slot, seed);
    CHECK_SEED(hit->element == cell->element && cell->kept, seed);
    CHECK_SEED(hit->fragment == view.cell_fragment[hit->cell] && hit->epoch == view.epoch, seed);
    CHECK_SEED(hit->copy_count >= 1 && hit->copy_count <= 4, seed);
    for (i = 0; i < hit->copy_count; i++) {
        for (n = 0; n < 4 && cell->copies[n] != hit->copies[i];) n++;
        CHECK_SEED(n < 4 && hit->weights[i] > 0, seed);
        sum += hit->weights[i];
        for (k = 0; k < 3; k++) x[k] += hit->weights[i] * view.displacement[3 * hit->copies[i] + (uint32_t)k];
    }
    CHECK_SEED(fabs(sum - 1) < 1e-14, seed);
    for (k = 0; k < 3; k++) {
        const double moved = fabs(hit->position[k]) + fabs(hit->material[k]);
        CHECK_SEED(fabs(hit->material[k] + x[k] - hit->position[k]) <= 1e-13 * (1 + moved), seed);
    }
}

/* The hit of a point beside the oracles */
static int check_hit(gx_body *body, const double p[3], const gx_hit *hit, double tolerance, uint64_t seed) {
    static uint32_t slots[MOST_SLOTS];
    gx_hit all[64];
    size_t count = cells_at(body, p, slots), found, i;
    double least = HUGE_VAL, own = HUGE_VAL, away = 0;
    uint32_t slot;
    int k;
    CHECK_SEED(hit->triangle == UINT32_MAX && hit->surface == 0, seed);
    check_fields(body, hit, seed);
    ck_assert_int_eq(gx_body_locate_all(body, p, all, 64, &found, NULL), GX_OK);
    CHECK_SEED(found == count, seed);
    for (i = 0; i < count; i++) {
        CHECK_SEED(all[i].slot == body->cells.slot[slots[i]] && !(all[i].distance > 0), seed);
        CHECK_SEED(error_of(body, p, &all[i]) <= tolerance, seed);
        CHECK_SEED(memcmp(all[i].position, p, 3 * sizeof *p) == 0, seed);
        check_fields(body, &all[i], seed);
    }
    if (count > 0) {
        CHECK_SEED(memcmp(hit, &all[0], sizeof *hit) == 0, seed);
        return 1;
    }
    for (slot = 0; slot < body->cells.count; slot++) {
        const double distance = body->cells.data[slot].kept ? cell_distance(body, slot, p) : HUGE_VAL;
        least = fmin(least, distance);
        if (body->cells.slot[slot] == hit->slot) own = distance;
    }
    for (k = 0; k < 3; k++) away += pow(hit->position[k] - p[k], 2);
    CHECK_SEED(hit->distance > 0, seed);
    CHECK_SEED(fabs(hit->distance - least) <= 1e-11 * (1 + fabs(p[0])), seed);
    CHECK_SEED(fabs(own - least) <= 1e-11 * (1 + fabs(p[0])), seed);
    CHECK_SEED(fabs(sqrt(away) - least) <= 1e-11 * (1 + fabs(p[0])), seed);
    return 0;
}

/* Random points in and beside the body's box; nodes, middles of edges and faces, points of walls: exactly where the
   motion is dyadic */
static void choose_point(gx_body *body, double p[3]) {
    const gx_view view = view_of(body);
    const uint32_t slot = body->view.cell[random_below((int)view.cell_count)],
                   other = body->view.cell[random_below((int)view.cell_count)];
    const int kind = random_below(8);
    double x[4][3], y[4][3], weight[4], sum = 0;
    int i, k;
    corners_of(body, slot, x);
    corners_of(body, other, y);
    for (i = 0; i < 4; i++) sum += weight[i] = kind < 2 ? random_real(0, 1) : (double)random_below(3);
    for (k = 0; k < 3; k++) {
        const double far = random_real(-0.5, 0.5);
        p[k] = 0;
        if (kind == 7) p[k] = x[0][k] + far; /* beside it */
        if (kind == 6) p[k] = random_below(5) / 4.0 + x[0][k] - fmod(x[0][k], 0.25);
        if (kind == 5) p[k] = 0.5 * (x[0][k] + y[1][k]);
        if (kind < 5) {
            for (i = 0; i < 4; i++) p[k] += weight[i] * x[i][k];
            p[k] = sum > 0 ? p[k] / sum : x[3][k];
        }
    }
}

/* Locates points together, and each alone; checks both. Returns how many are inside. */
static int check_points(gx_body *body, int count, double tolerance, uint64_t seed) {
    double p[64][3];
    gx_hit hits[64], hit;
    int i, inside = 0;
    for (i = 0; i < count; i++) choose_point(body, p[i]);
    memset(hits, 0x5a, sizeof hits);
    ck_assert_int_eq(gx_body_locate(body, p[0], (size_t)count, hits, NULL), GX_OK);
    for (i = 0; i < count; i++) {
        ck_assert_int_eq(gx_body_locate(body, p[i], 1, &hit, NULL), GX_OK);
        CHECK_SEED(memcmp(&hit, &hits[i], sizeof hit) == 0, seed);
        inside += check_hit(body, p[i], &hits[i], tolerance, seed);
    }
    return inside;
}

/* 2^-48; where elements are nearly flat or far out rounding leaves less, which check_hit's caller says */
#define CLOSE 3.5527136788005009e-15

/* Cells of cut bodies in all motions are those of the oracle, and so is the nearest surface. */
START_TEST(locates_in_all_motions) {
    const uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, random_below(4), 1);
    gx_body *body = cut_in_sequence(&w);
    int motion, inside[MOTIONS];
    for (motion = 0; motion < MOTIONS && view_of(body).cell_count > 0; motion++) {
        move_body(body, &w, motion);
        inside[motion] = check_points(body, 40 / FEWER, CLOSE, seed);
        CHECK_SEED(motion == COLLAPSED || FEWER > 1 || inside[motion] > 0, seed); /* of 10 points none may be inside */
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* One body whose tree lives through motions, cuts, removal and restores: it answers as a body that is read anew. */
START_TEST(boxes_follow_cuts) {
    const uint64_t seed = 1000 + (uint64_t)_i;
    workload w;
    gx_body *body, *fresh, *kept = NULL;
    size_t i;
    int k;
    random_seed(seed);
    w = grid(3, 2, 3, _i % 2 ? 5 : 6);
    for (i = 0; i < 5; i++) add_random_cut(&w, 1);
    body = body_of(&w);
    ck_assert(body->tree.cluster_count == 0 && body->copies.seen == NULL); /* nobody has asked */
    for (i = 0; i < w.surface_count; i++) {
        double p[24][3];
        gx_hit hits[24], again[24];
        gx_result result;
        if (i == 2) ck_assert_int_eq(gx_body_clone(body, &kept, NULL), GX_OK);
        if (i % 2) move_body(body, &w, CALM); /* some cuts come before the boxes are refitted */
        cut_by(body, &w, i, 1);
        if (view_of(body).cell_count == 0) break;
        if (random_below(2)) move_body(body, &w, random_below(2) ? CALM : VIOLENT);
        for (k = 0; k < 24; k++) choose_point(body, p[k]);
        result = gx_body_locate(body, p[0], 24, hits, NULL);
        ck_assert_int_eq(result, GX_OK);
        ck_assert_int_eq(gx_body_clone(body, &fresh, NULL), GX_OK);
        ck_assert_uint_eq(fresh->tree.cluster_count, 0);
        ck_assert_int_eq(gx_body_locate(fresh, p[0], 24, again, NULL), GX_OK);
        CHECK_SEED(memcmp(hits, again, sizeof hits) == 0, seed);
        for (k = 0; k < 24; k += 4) check_hit(body, p[k], &hits[k], CLOSE, seed);
        if (i == 3) ck_assert_int_eq(gx_body_restore(fresh, kept, NULL), GX_OK); /* to other cells */
        move_body(fresh, &w, CALM);
        if (i == 3) check_points(fresh, 12, CLOSE, seed);
        ck_assert_int_eq(gx_body_restore(fresh, body, NULL), GX_OK); /* of the same cells, unless i is 3 */
        ck_assert_int_eq(gx_body_locate(fresh, p[0], 24, again, NULL), GX_OK);
        CHECK_SEED(memcmp(hits, again, sizeof hits) == 0, seed);
        gx_body_destroy(fresh);
    }
    gx_body_destroy(kept);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Bodies of several clusters. A twist moves all copies, a pinch few. */
START_TEST(large_bodies) {
    const uint64_t seed = 2000 + (uint64_t)_i;
    workload w = grid(7, 6, 5, _i ? 5 : 6);
    gx_body *body = body_of(&w);
    gx_view view = view_of(body);
    size_t i;
    int round;
    random_seed(seed);
    for (i = 0; i < view.copy_count; i++) {
        const double *x = w.positions + 3 * (size_t)view.copy_node[i], angle = 0.9 * x[2];
        double *u = view.displacement + 3 * i;
        u[0] = cos(angle) * x[0] - sin(angle) * x[1] - x[0] + random_real(-0.02, 0.02);
        u[1] = sin(angle) * x[0] + cos(angle) * x[1] - x[1] + random_real(-0.02, 0.02);
        u[2] = random_real(-0.02, 0.02);
    }
    ck_assert_uint_gt(w.element_count, 2 * 64);
    for (round = 0; round < 4; round++) {
        check_points(body, 24, CLOSE, seed);
        ck_assert_uint_gt(body->tree.cluster_count, 4);
        if (round == 1) {
            add_axis_plane(&w, 0, 0.55);
            cut_by(body, &w, 0, 1);
            view = view_of(body);
        }
        for (i = 0; i < 3; i++) /* a few copies, far */
            view.displacement[3 * (uint32_t)random_below((int)view.copy_count) + i] += random_real(-3, 3);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A body at rest: material points are the points, bit by bit, also outside. */
START_TEST(material_is_the_point_at_rest) {
    workload w = random_scene((uint64_t)_i + 77, 2, 1);
    gx_body *body = cut_in_sequence(&w);
    uint32_t slot;
    int i, k;
    for (slot = 0; slot < body->cells.count; slot++) {
        if (!body->cells.data[slot].kept) continue;
        for (i = 0; i < 5; i++) {
            double p[3], weights[4], material[3], back[3];
            for (k = 0; k < 3; k++) p[k] = random_real(-1, 2);
            ck_assert(gxp_pull_back(body, slot, p, weights, material));
            ck_assert(memcmp(p, material, sizeof p) == 0);
            gxp_image(body, slot, material, back);
            ck_assert(memcmp(p, back, sizeof p) == 0);
            ck_assert_double_eq_tol(gxp_stretch(body, slot), 1, 1e-14);
        }
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Placing is the inverse of locating, in each cell where pieces overlap. */
START_TEST(placing_is_the_inverse) {
    const uint64_t seed = 3000 + (uint64_t)_i;
    workload w = random_scene(seed, 2, 1);
    gx_body *body = cut_in_sequence(&w);
    int i, k;
    for (i = 0; i < 40 && view_of(body).cell_count > 0; i++) {
        gx_hit hits[32];
        size_t count, j;
        double p[3], back[3];
        if (i % 10 == 0) move_body(body, &w, i % 20 ? VIOLENT : CALM);
        choose_point(body, p);
        ck_assert_int_eq(gx_body_locate_all(body, p, hits, 32, &count, NULL), GX_OK);
        if (count == 0) {
            ck_assert_int_eq(gx_body_locate(body, p, 1, hits, NULL), GX_OK);
            count = 1;
        }
        for (j = 0; j < count; j++) {
            ck_assert_int_eq(gx_body_place(body, hits[j].slot, hits[j].material, back, NULL), GX_OK);
            for (k = 0; k < 3; k++) CHECK_SEED(fabs(back[k] - hits[j].position[k]) < 1e-12, seed);
        }
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* What is extended beyond an element is its affine map: midpoints go to midpoints. */
START_TEST(places_beyond_elements) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    const double a[3] = {-3, 0.25, 4}, b[3] = {5, 0.75, -2}, middle[3] = {1, 0.5, 1}, in_plane[3] = {0.5, 0.6, 0.5};
    gx_hit hit;
    double x[3], y[3], z[3], weights[4], material[3];
    int k;
    move_body(body, &w, CALM);
    ck_assert_int_eq(gx_body_place(body, 2, a, x, NULL), GX_OK);
    ck_assert_int_eq(gx_body_place(body, 2, b, y, NULL), GX_OK);
    ck_assert_int_eq(gx_body_place(body, 2, middle, z, NULL), GX_OK);
    for (k = 0; k < 3; k++) ck_assert_double_eq_tol(0.5 * (x[k] + y[k]), z[k], 1e-13);
    ck_assert(gxp_pull_back(body, 2, x, weights, material));
    for (k = 0; k < 3; k++) ck_assert_double_eq_tol(material[k], a[k], 1e-12);
    ck_assert_double_eq_tol(weights[0] + weights[1] + weights[2] + weights[3], 1, 1e-13);
    move_body(body, &w, COLLAPSED);
    ck_assert(!gxp_pull_back(body, 2, x, weights, material)); /* flat */
    ck_assert_double_eq_tol(gxp_stretch(body, 2), 0, 1e-15);
    ck_assert_int_eq(gx_body_locate(body, in_plane, 1, &hit, NULL), GX_OK); /* flat elements contain nothing */
    ck_assert(hit.distance > 0 && hit.distance < 1e-15);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- what other sections use ---- */

static gx_result collect(gx_body *body, void *user, uint32_t slot) {
    (void)body;
    ((uint8_t *)user)[slot]++;
    return GX_OK;
}

static int is_odd(void *user, uint32_t slot) {
    (void)user;
    return slot % 2;
}

START_TEST(walks_for_other_sections) {
    const uint64_t seed = 4000 + (uint64_t)_i;
    static uint32_t slots[MOST_SLOTS];
    workload w;
    gx_body *body;
    uint32_t slot;
    int i, k, n;
    random_seed(seed);
    w = grid(3, 3, 2, 6);
    add_axis_plane(&w, 1, 0.4);
    add_random_cut(&w, 1);
    body = cut_in_sequence(&w);
    for (i = 0; i < 12; i++) {
        uint8_t *met = (uint8_t *)calloc(body->cells.count, 1);
        gxp_bounds box;
        gxp_near near;
        double p[3], least = HUGE_VAL;
        size_t count;
        int inside;
        move_body(body, &w, i % 2 ? CALM : VIOLENT);
        ck_assert_int_eq(gxp_refit_tree(body), GX_OK);
        for (k = 0; k < 3; k++) {
            p[k] = box.low[k] = random_real(-1, 2);
            box.high[k] = box.low[k] + random_real(0, 0.5);
        }
        ck_assert_int_eq(gxp_walk_box(body, &box, collect, met), GX_OK);
        ck_assert_int_eq(gxp_find_nearest(body, p, 0, is_odd, NULL, &near), GX_OK);
        for (slot = 0; slot < body->cells.count; slot++) {
            double x[4][3];
            int meets = body->cells.data[slot].kept != 0;
            if (!meets) continue;
            corners_of(body, slot, x);
            for (k = 0; k < 3; k++) {
                double low = x[0][k], high = x[0][k];
                for (n = 1; n < 4; n++) {
                    low = fmin(low, x[n][k]);
                    high = fmax(high, x[n][k]);
                }
                meets = meets && low <= box.high[k] && high >= box.low[k];
            }
            CHECK_SEED(met[slot] == meets, seed);
            if (slot % 2) least = fmin(least, cell_distance(body, slot, p));
        }
        count = cells_at(body, p, slots);
        for (inside = 0; count > 0; count--) inside |= slots[count - 1] % 2 != 0;
        CHECK_SEED(inside || (near.cell % 2 == 1 && fabs(sqrt(near.square) - least) < 1e-11), seed);
        free(met);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- rays ---- */

/* gx_body_pick without boxes: all vertices are moved and sheared, all triangles tested. */
static void pick_slowly(gx_body *body, const gx_skin *skin, const double o[3], const double d[3], gx_hit *hit) {
    static const double ray[2] = {0, 0};
    double *x = (double *)malloc((3 * skin->vertex_count + 1) * sizeof *x), best[3] = {0, 0, 0};
    int axis = 0, k, i;
    size_t v, t;
    for (k = 1; k < 3; k++)
        if (fabs(d[k]) > fabs(d[axis])) axis = k;
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (v = 0; v < skin->vertex_count; v++) {
        double *y = x + 3 * v;
        const double along = (y[axis] - o[axis]) / d[axis];
        const double p = y[(axis + 1) % 3] - o[(axis + 1) % 3], q = y[(axis + 2) % 3] - o[(axis + 2) % 3];
        y[0] = p - along * d[(axis + 1) % 3];
        y[1] = q - along * d[(axis + 2) % 3];
        y[2] = along;
    }
    memset(hit, 0, sizeof *hit);
    hit->triangle = UINT32_MAX;
    for (t = 0; t < skin->triangle_count; t++) {
        const double *p[3];
        double share[3], sum = 0, distance = 0;
        int positive = 0, negative = 0, beside = 0;
        for (k = 0; k < 3; k++) p[k] = x + 3 * (size_t)skin->triangles[3 * t + (size_t)k];
        for (k = 0; k < 2; k++)
            beside |= !(fmin(p[0][k], fmin(p[1][k], p[2][k])) <= 0 && fmax(p[0][k], fmax(p[1][k], p[2][k])) >= 0);
        for (k = 0; k < 3; k++) {
            const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
            const int side = gxb_orient2d(ray, a, b);
            positive |= side > 0;
            negative |= side < 0;
            share[k] = fabs(a[0] * b[1] - a[1] * b[0]);
            sum += share[k];
        }
        if (beside || positive == negative || !(sum > 0)) continue;
        for (k = 0; k < 3; k++) {
            share[k] /= sum;
            distance += share[k] * p[k][2];
        }
        if (!(distance >= 0) || (hit->triangle != UINT32_MAX && distance >= hit->distance)) continue;
        hit->triangle = (uint32_t)t;
        hit->distance = distance;
        memcpy(best, share, sizeof best);
    }
    free(x);
    if (hit->triangle == UINT32_MAX) return;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++)
            hit->material[k] +=
                best[i] * skin->vertex_rest[3 * skin->triangles[3 * hit->triangle + (uint32_t)i] + (uint32_t)k];
}

static void check_ray(gx_body *body, const gx_skin *skin, const double o[3], const double d[3], uint64_t seed) {
    gx_hit hit, slow;
    ck_assert_int_eq(gx_body_pick(body, o, d, &hit, NULL), GX_OK);
    pick_slowly(body, skin, o, d, &slow);
    CHECK_SEED(hit.triangle == slow.triangle, seed);
    CHECK_SEED(memcmp(&hit.distance, &slow.distance, sizeof hit.distance) == 0, seed);
    CHECK_SEED(memcmp(hit.material, slow.material, sizeof hit.material) == 0, seed);
    if (hit.triangle == UINT32_MAX) return;
    check_fields(body, &hit, seed);
    CHECK_SEED(hit.fragment == skin->triangle_fragment[hit.triangle], seed);
    CHECK_SEED(hit.element == skin->triangle_element[hit.triangle], seed);
    CHECK_SEED(hit.surface == skin->triangle_surface[hit.triangle], seed);
}

/* Rays at vertices, middles of edges and anywhere, through gaps, from inside, from far away, of any length */
static void check_rays(gx_body *body, const gx_skin *skin, int count, uint64_t seed) {
    double *x = (double *)malloc((3 * skin->vertex_count + 1) * sizeof *x);
    int i, k;
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (i = 0; i < count && skin->vertex_count > 0; i++) {
        const double *a = x + 3 * (size_t)random_below((int)skin->vertex_count),
                     *b = x + 3 * (size_t)random_below((int)skin->vertex_count);
        const double far = i % 5 ? 1 : 1e7, length = i % 7 ? 1 : ldexp(1, random_below(1000) - 500);
        double o[3], d[3];
        for (k = 0; k < 3; k++) {
            o[k] = far * random_real(-1, 2);
            if (i % 3 == 0) o[k] = 0.25 * random_below(5);
            d[k] = (i % 2 ? a[k] : 0.5 * (a[k] + b[k])) - o[k];
            if (i % 11 == 0) d[k] = k == i % 3 ? 1 : 0;
            d[k] *= length;
        }
        if (fabs(d[0]) + fabs(d[1]) + fabs(d[2]) > 0 && isfinite(d[0] + d[1] + d[2])) check_ray(body, skin, o, d, seed);
    }
    free(x);
}

START_TEST(picks_as_without_boxes) {
    const uint64_t seed = 5000 + (uint64_t)_i;
    workload w;
    gx_body *body;
    gx_skin skin;
    size_t i;
    int motion;
    random_seed(seed);
    w = _i % 4 ? random_mesh() : grid(4, 3, 3, 6);
    for (i = 0; i < 3; i++) add_random_cut(&w, 1);
    body = body_of(&w);
    for (i = 0; i <= w.surface_count; i++) {
        ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
        for (motion = 0; motion < MOTIONS; motion++) {
            move_body(body, &w, motion);
            check_rays(body, &skin, 12, seed);
        }
        if (i < w.surface_count) cut_by(body, &w, i, 1);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Displacements that are not finite, or huge, hide no other triangle. */
START_TEST(picks_beside_what_is_not_finite) {
    const uint64_t seed = 6000 + (uint64_t)_i;
    static const double bad[4] = {NAN, INFINITY, -INFINITY, 1e300};
    workload w = grid(3, 3, 3, 6);
    gx_body *body = body_of(&w);
    gx_view view = view_of(body);
    gx_skin skin;
    memset(&skin, 0, sizeof skin);
    random_seed(seed);
    move_body(body, &w, CALM);
    view.displacement[random_below((int)(3 * view.copy_count))] = bad[_i % 4];
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    check_rays(body, &skin, 30, seed);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- refusals ---- */

static gx_failure failure;
static const char unset[] = "unset";

static void expect(gx_body *body, uint64_t state, gx_result result, gx_result expected, const char *field, size_t index,
                   int line) {
    ck_assert_msg(result == expected && failure.result == expected, "line %d: %s, should be: %s", line,
                  gx_result_text(result), gx_result_text(expected));
    ck_assert_msg(field == NULL ? failure.field == NULL : failure.field != NULL && strcmp(failure.field, field) == 0,
                  "line %d: field %s", line, failure.field ? failure.field : "NULL");
    ck_assert_msg(failure.index == index && failure.surface == SIZE_MAX, "line %d: index %zu", line, failure.index);
    ck_assert_msg(gx_body_state_hash(body) == state, "line %d: the body changed", line);
    failure.field = unset;
    failure.index = failure.surface = 77;
}

#define KEEPS(call, expected, field, index)                                                                            \
    do {                                                                                                               \
        const uint64_t state_ = gx_body_state_hash(body);                                                              \
        expect(body, state_, call, expected, field, index, __LINE__);                                                  \
    } while (0)

START_TEST(refusals) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    double p[6] = {0.25, 0.25, 0.25, 0.5, 0.5, 0.5}, x[3];
    const double huge = ldexp(1, 128);
    double *u = view_of(body).displacement;
    gx_hit hits[16];
    size_t count = 7;
    KEEPS(gx_body_locate(NULL, p, 2, hits, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(gx_body_locate(body, NULL, 2, hits, &failure), GX_ERROR_ARGUMENT, "points", SIZE_MAX);
    KEEPS(gx_body_locate(body, p, 2, NULL, &failure), GX_ERROR_ARGUMENT, "hits", SIZE_MAX);
    KEEPS(gx_body_locate(body, p, (size_t)INT32_MAX / 4 + 1, hits, &failure), GX_ERROR_LIMIT, "count", SIZE_MAX);
    KEEPS(gx_body_locate(body, NULL, 0, NULL, &failure), GX_OK, NULL, SIZE_MAX);
    KEEPS(gx_body_locate_all(NULL, p, hits, 16, &count, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(gx_body_locate_all(body, NULL, hits, 16, &count, &failure), GX_ERROR_ARGUMENT, "point", SIZE_MAX);
    KEEPS(gx_body_locate_all(body, p, NULL, 16, &count, &failure), GX_ERROR_ARGUMENT, "hits", SIZE_MAX);
    KEEPS(gx_body_locate_all(body, p, hits, 16, NULL, &failure), GX_ERROR_ARGUMENT, "count", SIZE_MAX);
    KEEPS(gx_body_place(NULL, 0, p, x, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(gx_body_place(body, 0, NULL, x, &failure), GX_ERROR_ARGUMENT, "material", SIZE_MAX);
    KEEPS(gx_body_place(body, 0, p, NULL, &failure), GX_ERROR_ARGUMENT, "position", SIZE_MAX);
    KEEPS(gx_body_place(body, 5, p, x, &failure), GX_ERROR_INDEX, "slot", SIZE_MAX);
    p[4] = NAN;
    KEEPS(gx_body_locate(body, p, 2, hits, &failure), GX_ERROR_NOT_FINITE, "points", 1);
    KEEPS(gx_body_locate_all(body, p + 3, hits, 16, &count, &failure), GX_ERROR_NOT_FINITE, "point", SIZE_MAX);
    KEEPS(gx_body_place(body, 0, p + 3, x, &failure), GX_ERROR_NOT_FINITE, "material", SIZE_MAX);
    p[4] = -huge;
    KEEPS(gx_body_locate(body, p, 2, hits, &failure), GX_ERROR_RANGE, "points", 1);
    KEEPS(gx_body_locate_all(body, p + 3, hits, 16, &count, &failure), GX_ERROR_RANGE, "point", SIZE_MAX);
    KEEPS(gx_body_place(body, 0, p + 3, x, &failure), GX_ERROR_RANGE, "material", SIZE_MAX);
    p[4] = huge / 2;
    KEEPS(gx_body_locate(body, p, 2, hits, &failure), GX_OK, NULL, SIZE_MAX);
    ck_assert_double_eq_tol(hits[1].distance / (huge / 2), 1, 1e-12);
    p[4] = 0.5;
    ck_assert_uint_eq(count, 7);
    /* a node of the middle element is in all five; too few places say how many there must be */
    memcpy(x, w.positions + 9, sizeof x);
    KEEPS(gx_body_locate_all(body, x, NULL, 0, &count, &failure), GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    ck_assert_uint_ge(count, 2);
    KEEPS(gx_body_locate_all(body, x, hits, count - 1, &count, &failure), GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    KEEPS(gx_body_locate_all(body, x, hits, count, &count, &failure), GX_OK, NULL, SIZE_MAX);
    x[0] = 9;
    KEEPS(gx_body_locate_all(body, x, NULL, 0, &count, &failure), GX_OK, NULL, SIZE_MAX);
    ck_assert_uint_eq(count, 0);
    /* states that are not finite or too large, and a return from them */
    u[3 * 6 + 1] = NAN;
    KEEPS(gx_body_locate(body, p, 2, hits, &failure), GX_ERROR_NOT_FINITE, "displacement", 6);
    KEEPS(gx_body_locate_all(body, p, hits, 16, &count, &failure), GX_ERROR_NOT_FINITE, "displacement", 6);
    u[3 * 6 + 1] = huge;
    KEEPS(gx_body_locate(body, p, 2, hits, &failure), GX_ERROR_RANGE, "displacement", 6);
    KEEPS(gx_body_locate_all(body, p, hits, 16, &count, &failure), GX_ERROR_RANGE, "displacement", 6);
    KEEPS(gx_body_place(body, body->view.slot[4], p, x, &failure), GX_ERROR_RANGE, "displacement", 6);
    u[3 * 6 + 1] = -INFINITY;
    KEEPS(gx_body_place(body, body->view.slot[4], p, x, &failure), GX_ERROR_NOT_FINITE, "displacement", 6);
    u[3 * 6 + 1] = 0;
    KEEPS(gx_body_locate(body, p, 2, hits, &failure), GX_OK, NULL, SIZE_MAX);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(nothing_is_left) {
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w);
    const double p[3] = {0.2, 0.3, 0.4}, up[3] = {0, 0, 1};
    double x[3];
    gx_hit hit;
    gx_skin skin;
    size_t count = 7;
    add_box(&w, 1, -1, -1, -1, 1, 2, 2);
    add_box(&w, 1, -1, -1, -1, 3, 2, 2);
    ck_assert_int_eq(gx_body_locate(body, p, 1, &hit, NULL), GX_OK);
    ck_assert(!(hit.distance > 0));
    cut_by(body, &w, 0, 1);
    KEEPS(gx_body_place(body, hit.slot, hit.material, x, &failure), GX_ERROR_EMPTY, "slot", SIZE_MAX);
    ck_assert_int_eq(gx_body_locate(body, p, 1, &hit, NULL), GX_OK);
    ck_assert_double_eq_tol(hit.distance, 0.8, 1e-15);
    cut_by(body, &w, 1, 1);
    KEEPS(gx_body_locate(body, p, 1, &hit, &failure), GX_ERROR_EMPTY, "body", SIZE_MAX);
    KEEPS(gx_body_locate_all(body, p, &hit, 1, &count, &failure), GX_ERROR_EMPTY, "body", SIZE_MAX);
    ck_assert_uint_eq(count, 7);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    KEEPS(gx_body_pick(body, p, up, &hit, &failure), GX_OK, NULL, SIZE_MAX);
    ck_assert_uint_eq(hit.triangle, UINT32_MAX);
    gx_body_destroy(body);
    body = body_of(&w); /* nothing is left before the first boxes are made */
    cut_by(body, &w, 1, 1);
    KEEPS(gx_body_locate(body, p, 1, &hit, &failure), GX_ERROR_EMPTY, "body", SIZE_MAX);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A displacement that is not finite goes with the material that a cut removes. */
START_TEST(a_cut_removes_what_is_not_finite) {
    static const double bad[4] = {NAN, INFINITY, -INFINITY, 1e300};
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w);
    const gx_view view = view_of(body);
    const double p[3] = {0.2, 0.3, 0.4};
    gx_hit hit;
    add_box(&w, 1, -1, -1, -1, 1.25, 2, 2);
    view.displacement[0] = bad[_i];
    KEEPS(gx_body_locate(body, p, 1, &hit, &failure), _i < 3 ? GX_ERROR_NOT_FINITE : GX_ERROR_RANGE, "displacement", 0);
    cut_by(body, &w, 0, 1);
    ck_assert_int_eq(gx_body_locate(body, p, 1, &hit, NULL), GX_OK);
    ck_assert_double_eq_tol(hit.distance, 1.05, 1e-15);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Where more elements lie over each other than a group of points lists, each point looks for itself. */
START_TEST(points_in_a_crowd) {
    enum { POINTS = 40 };
    workload w = grid(6, 5, 5, 5);
    gx_body *body = body_of(&w);
    const gx_view view = view_of(body);
    double points[3 * POINTS];
    gx_hit together[POINTS], alone;
    uint32_t i, k;
    random_seed(11);
    for (i = 0; i < view.copy_count; i++)
        for (k = 0; k < 3; k++) {
            const double rest = w.positions[3 * (size_t)view.copy_node[i] + k];
            view.displacement[3 * i + k] = 0.01 * (rest + random_real(-3, 3)) - rest;
        }
    for (i = 0; i < 3 * POINTS; i++) points[i] = random_real(-0.02, 0.07);
    memset(together, 0, sizeof together);
    memset(&alone, 0, sizeof alone);
    ck_assert_int_eq(gx_body_locate(body, points, POINTS, together, NULL), GX_OK);
    for (i = 0; i < POINTS; i++) {
        ck_assert_int_eq(gx_body_locate(body, points + 3 * i, 1, &alone, NULL), GX_OK);
        ck_assert_msg(memcmp(&alone, &together[i], sizeof alone) == 0, "point %u differs", i);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A point of a hit is one that springs take: it moves with the material. */
START_TEST(hits_make_points) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    const double p[3] = {0.5, 0.45, 0.55};
    gxs_point point;
    gx_hit hit;
    double sum = 0;
    uint32_t i;
    ck_assert_int_eq(gx_body_locate(body, p, 1, &hit, NULL), GX_OK);
    point = gx_hit_point(&hit);
    ck_assert_uint_eq(point.count, hit.copy_count);
    for (i = 0; i < point.count; i++) sum += point.weight[i];
    ck_assert_double_eq_tol(sum, 1, 1e-15);
    ck_assert(memcmp(point.position, hit.material, sizeof hit.material) == 0);
    ck_assert(point.epoch == view_of(body).epoch);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("locate");
    TCase *tests = tcase_create("locate");
    const char *only = getenv("GXFEM_SEED");
    const int first = only ? atoi(only) : 0, last = only ? first + 1 : SEEDS / FEWER;
    tcase_set_timeout(tests, 240);
    tcase_add_loop_test(tests, locates_in_all_motions, first, last);
    tcase_add_loop_test(tests, boxes_follow_cuts, 0, 12 / FEWER);
    tcase_add_loop_test(tests, large_bodies, 0, 2);
    tcase_add_loop_test(tests, material_is_the_point_at_rest, 0, 5);
    tcase_add_loop_test(tests, placing_is_the_inverse, 0, 10);
    tcase_add_test(tests, places_beyond_elements);
    tcase_add_loop_test(tests, walks_for_other_sections, 0, 6);
    tcase_add_loop_test(tests, picks_as_without_boxes, first, last);
    tcase_add_loop_test(tests, picks_beside_what_is_not_finite, 0, 8);
    tcase_add_test(tests, refusals);
    tcase_add_test(tests, nothing_is_left);
    tcase_add_loop_test(tests, a_cut_removes_what_is_not_finite, 0, 4);
    tcase_add_test(tests, points_in_a_crowd);
    tcase_add_test(tests, hits_make_points);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
