/* test_anchors.c - points of the material that survive cuts. Each anchor is on its own side of every cut, and lost only
   with its material, as exact rationals say. GXFEM_ANCHORS=n tries n anchors in place of 2,000. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"

/* ---- the oracle ---- */

/* A triangle of a plane that goes beyond the body, or of a convex solid */
typedef struct plane {
    double x[3][3];
} plane;

static int side_of(const plane *p, const double x[3]) {
    const rat_mark mark = rat_arena_mark();
    const int side = big_sign(big_orient3d(p->x[0], p->x[1], p->x[2], x));
    rat_arena_release(mark);
    return side;
}

/* The side of an anchor; 0: the plane passes through position and toward */
static int side_of_anchor(const plane *p, const gx_anchor *a) {
    const int side = side_of(p, a->position);
    return side != 0 ? side : side_of(p, a->toward);
}

/* Sheets, and boxes: two triangles a face, which rounding may have put in different planes */
typedef struct cuts {
    plane sheet[64], solid[64][12];
    size_t sheet_count, solid_count;
} cuts;

/* Is the anchor's material inside a solid? -1: that is not decided */
static int is_removed(const cuts *c, const gx_anchor *a) {
    size_t i, k;
    int open = 0;
    for (i = 0; i < c->solid_count; i++) {
        int outside = 0, unsure = 0;
        for (k = 0; k < 12; k += 2) {
            const int p = side_of_anchor(&c->solid[i][k], a), q = side_of_anchor(&c->solid[i][k + 1], a);
            outside |= p > 0 && q > 0;
            unsure |= p >= 0 || q >= 0;
        }
        if (!outside && !unsure) return 1;
        open |= !outside;
    }
    return open ? -1 : 0;
}

/* Does a sheet or a solid's face part the two, exactly? 2: that is not decided. Outside of solids, what parts two
   points of an element are sheets, and the solids' faces where the way around a solid leaves the element. */
static int parts(const cuts *c, const gx_anchor *a, const gx_anchor *b) {
    int open = 0;
    size_t i;
    for (i = 0; i < c->sheet_count; i++) {
        const int p = side_of_anchor(&c->sheet[i], a), q = side_of_anchor(&c->sheet[i], b);
        if (p * q < 0) return 1;
        open |= p * q == 0;
    }
    return open || c->solid_count > 0 ? 2 : 0;
}

/* ---- scenes ---- */

/* A triangle that goes far beyond the body, in the plane of three points */
static void cut_plane(gx_body *body, cuts *c, const double p[3], const double u[3], const double v[3]) {
    workload w = wl_empty();
    wl_surface *s = wl_add_surface(&w, 0);
    plane *own = &c->sheet[c->sheet_count++];
    int i, k;
    for (k = 0; k < 3; k++) {
        own->x[0][k] = p[k] - 64 * u[k] - 64 * v[k];
        own->x[1][k] = p[k] + 128 * u[k] - 64 * v[k];
        own->x[2][k] = p[k] - 64 * u[k] + 128 * v[k];
    }
    for (i = 0; i < 3; i++) wl_add_vertex(s, own->x[i]);
    wl_add_triangle(s, 0, 1, 2);
    cut_by(body, &w, 0, 1);
    wl_free(&w);
}

/* Planes of all kinds: in general position, along axes through nodes and lattice planes, and exactly through two
   anchors' positions */
static void cut_random_plane(gx_body *body, cuts *c, const workload *w, const gx_anchor *anchors, size_t count) {
    double p[3], u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    const int axis = random_below(3);
    int k;
    random_point(w, p);
    for (k = 0; k < 3; k++) {
        u[k] = random_real(-1, 1);
        v[k] = random_real(-1, 1);
    }
    switch (random_below(4)) {
    case 0: break;
    case 1:
        memset(u, 0, sizeof u);
        memset(v, 0, sizeof v);
        p[axis] = random_below(9) / 8.0;
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
        break;
    default: /* a plane along an axis, at the coordinate of an anchor */
        if (count == 0) break;
        memset(u, 0, sizeof u);
        memset(v, 0, sizeof v);
        p[axis] = anchors[random_below((int)count)].position[axis];
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = random_below(2) ? 1 : -1;
        u[(axis + 2) % 3] = random_below(3) * 0.5;
        break;
    }
    cut_plane(body, c, p, u, v);
}

/* A solid box, aligned or not, with a face exactly through an anchor now and then; its faces point outward. */
static void cut_random_solid(gx_body *body, cuts *c, const workload *w, const gx_anchor *anchors, size_t count) {
    workload box = wl_empty();
    wl_surface *s;
    wl_frame f = wl_rotated();
    double low[3], high[3];
    int k, i;
    random_point(w, f.origin);
    s = wl_add_surface(&box, 1);
    if (random_below(3) == 0) {
        wl_add_box(s, &f, random_real(0.05, 0.2), 0.25, 0.125);
    } else {
        for (k = 0; k < 3; k++) {
            const double x = random_below(2) || count == 0 ? floor(8 * f.origin[k]) / 8
                                                           : anchors[random_below((int)count)].position[k];
            low[k] = random_below(2) ? x : x - 0.25;
            high[k] = x > low[k] ? x : x + 0.25;
        }
        wl_add_aligned_box(s, low, high);
    }
    for (k = 0; k < 12; k++)
        for (i = 0; i < 3; i++)
            memcpy(c->solid[c->solid_count][k].x[i], s->vertices + 3 * s->triangles[3 * k + i], 3 * sizeof(double));
    c->solid_count++;
    cut_by(body, &box, 0, 1);
    wl_free(&box);
}

/* A ray through the body */
static int random_hit(gx_body *body, const workload *w, gx_hit *hit) {
    double origin[3], direction[3];
    gx_skin skin;
    int k;
    random_point(w, origin);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    if (random_below(3) == 0) origin[random_below(3)] = random_below(9) / 8.0;
    memset(direction, 0, sizeof direction);
    if (random_below(2))
        direction[random_below(3)] = random_below(2) ? 1 : -1;
    else
        for (k = 0; k < 3; k++) direction[k] = random_real(-1, 1);
    ck_assert_int_eq(gx_body_pick(body, origin, direction, hit, NULL), GX_OK);
    return hit->triangle != UINT32_MAX;
}

/* A point of an element, in general position or at a corner, in the middle of an edge, on a lattice plane */
static void random_material(const workload *w, uint32_t element, double x[3]) {
    const uint32_t *n = w->elements + 4 * element;
    double weight[4], sum = 0;
    int i, k;
    for (i = 0; i < 4; i++) sum += weight[i] = random_below(4) == 0 ? 0 : random_below(2) ? random_real(0, 1) : 1;
    if (!(sum > 0)) sum = weight[random_below(4)] = 1;
    for (k = 0; k < 3; k++)
        for (i = 0, x[k] = 0; i < 4; i++) x[k] += weight[i] / sum * w->positions[3 * n[i] + (size_t)k];
}

static uint32_t slot_of(gx_body *body, const gx_anchor *a) {
    const uint32_t cell = gxp_anchor_cell(body, a);
    return cell == GXB_NONE ? GXB_NONE : body->cells.slot[cell];
}

/* The place in the view of the cell that has the anchor; SIZE_MAX: it is lost. Its copies move the anchor. */
static size_t cell_of(const gx_view *view, gx_body *body, const gx_anchor *a) {
    const uint32_t slot = slot_of(body, a);
    gxs_point point = {0, {0}, {0}, NULL, NULL, {0}, 0};
    const gx_result result = gx_body_anchor_point(body, a, &point, NULL, NULL);
    size_t i;
    uint32_t k, j, found;
    ck_assert_int_eq(result, slot == GXB_NONE ? GX_ERROR_EMPTY : GX_OK);
    for (i = 0; slot != GXB_NONE && view->cell_slot[i] != slot; i++) ck_assert_uint_lt(i, view->cell_count);
    if (slot == GXB_NONE) return SIZE_MAX;
    for (k = found = 0; k < point.count; k++)
        for (j = 0; j < 4; j++) found += view->cell_copies[4 * i + j] == point.copy[k];
    ck_assert_uint_eq(found, point.count);
    ck_assert_uint_eq(view->cell_element[i], a->element);
    return i;
}

/* Weights are those of the position in the element; copies those of one cell. */
static void expect_point(gx_body *body, const workload *w, const gx_anchor *a, uint64_t seed) {
    const gx_view view = view_of(body);
    gxs_point point;
    double x[3] = {0, 0, 0}, moved[3], sum = 0;
    uint32_t i, k;
    (void)w;
    memset(&point, 0, sizeof point);
    ck_assert_int_eq(gx_body_anchor_point(body, a, &point, moved, NULL), GX_OK);
    CHECK_SEED(point.count >= 1 && point.count <= 4 && point.epoch == view.epoch && point.copies == NULL, seed);
    for (k = 0; k < point.count; k++) {
        CHECK_SEED(point.copy[k] < view.copy_count && point.weight[k] > 0, seed);
        sum += point.weight[k];
        for (i = 0; i < 3; i++)
            x[i] += point.weight[k] *
                    (w->positions[3 * view.copy_node[point.copy[k]] + i] + view.displacement[3 * point.copy[k] + i]);
    }
    CHECK_SEED(fabs(sum - 1) < 1e-15, seed);
    for (i = 0; i < 3; i++) {
        CHECK_SEED(fabs(x[i] - moved[i]) < 1e-14, seed);
        CHECK_SEED(point.position[i] == a->position[i], seed);
    }
}

/* ---- random lives ---- */

/* The volume of the smallest part of the cell that was hit */
static double thinnest(gx_body *body, const gx_hit *hit) {
    double volume = 1;
    uint32_t cell;
    for (cell = hit->element; cell != GXB_NONE; cell = body->cells.data[cell].next)
        if (gxp_is_hit(body, cell, hit)) volume = fmin(volume, body->cells.data[cell].volume);
    return volume;
}

enum { ANCHORS = 400 };

/* Anchors are made between cuts: of hits, and of points in elements. In the end each is where the oracle says: lost if
   it is in a solid; apart from another one of its element if a sheet is between them. */
static size_t live(uint64_t seed, int solids, size_t *thin) {
    static gx_anchor anchors[ANCHORS];
    static cuts c;
    static size_t cell[ANCHORS];
    workload w;
    gx_body *body;
    gx_view view;
    size_t count = 0, i, j;
    int round;
    random_seed(seed);
    memset(&c, 0, sizeof c);
    w = random_below(2) ? random_mesh() : grid(2, 1, 1, random_below(2) ? 5 : 6);
    body = body_of(&w);
    for (round = 0; round < 8; round++) {
        for (i = 0; i < 50 && count < ANCHORS; i++) {
            gx_anchor *a = &anchors[count];
            gx_failure failure;
            gx_hit hit;
            double x[3];
            const uint32_t element = (uint32_t)random_below((int)w.element_count);
            if (random_below(2)) {
                if (!random_hit(body, &w, &hit)) continue;
                if (gx_hit_anchor(body, &hit, a, &failure) != GX_OK) { /* a slice without a double in it */
                    CHECK_SEED(failure.result == GX_ERROR_FLAT && thinnest(body, &hit) < 1e-15, seed);
                    (*thin)++;
                    continue;
                }
                CHECK_SEED(slot_of(body, a) == hit.slot, seed);
                for (j = 0; j < 3; j++) CHECK_SEED(fabs(a->position[j] - hit.material[j]) < 1e-12, seed);
            } else {
                random_material(&w, element, x);
                if (gx_body_anchor(body, element, x, a, &failure) != GX_OK) {
                    CHECK_SEED(failure.result == (solids ? GX_ERROR_EMPTY : GX_ERROR_FLAT), seed);
                    continue;
                }
                CHECK_SEED(a->element == element, seed);
                for (j = 0; j < 3; j++) CHECK_SEED(fabs(a->position[j] - x[j]) < 1e-6, seed);
            }
            expect_point(body, &w, a, seed);
            CHECK_SEED(is_removed(&c, a) <= 0, seed);
            count++;
        }
        if (solids && random_below(3) == 0)
            cut_random_solid(body, &c, &w, anchors, count);
        else
            cut_random_plane(body, &c, &w, anchors, count);
    }
    view = view_of(body);
    for (i = 0; i < count; i++) {
        const int removed = is_removed(&c, &anchors[i]);
        uint8_t lost = 2;
        cell[i] = cell_of(&view, body, &anchors[i]);
        ck_assert_int_eq(gx_body_lost_anchors(body, &anchors[i], 1, &lost, NULL), GX_OK);
        CHECK_SEED(removed < 0 || lost == removed, seed);
        CHECK_SEED(lost == (cell[i] == SIZE_MAX), seed);
    }
    for (i = 0; i < count; i++)
        for (j = 0; j < i; j++) {
            int apart;
            if (anchors[i].element != anchors[j].element || cell[i] == SIZE_MAX || cell[j] == SIZE_MAX) continue;
            apart = parts(&c, &anchors[i], &anchors[j]);
            CHECK_SEED(apart == 2 || apart == (cell[i] != cell[j]), seed);
        }
    gx_body_destroy(body);
    wl_free(&w);
    return count;
}

START_TEST(each_on_its_own_side) {
    const char *text = getenv("GXFEM_ANCHORS");
    const size_t wanted = text != NULL ? (size_t)strtoul(text, NULL, 10) : 2000 / FEWER;
    size_t done = 0, thin = 0;
    uint64_t seed;
    for (seed = 1; done < wanted; seed++) done += live(seed, seed % 2 == 0, &thin);
    ck_assert_uint_le(thin, done / 100);
}
END_TEST

/* ---- cases ---- */

/* A hit on a face of a cut in general position rounds to either side of it. */
START_TEST(hits_on_faces_of_cuts) {
    const uint64_t seed = (uint64_t)_i + 1;
    static cuts c;
    workload w = grid(1, 1, 1, 6);
    gx_body *body = body_of(&w);
    gx_skin skin = {0};
    double *x;
    int trial, made = 0;
    random_seed(seed);
    memset(&c, 0, sizeof c);
    while (view_of(body).fragment_count < 2) cut_random_plane(body, &c, &w, NULL, 0);
    {
        const gx_view view = view_of(body); /* opens a gap */
        size_t i;
        for (i = 0; i < view.copy_count; i++)
            if (gxp_find(body->view.copy_fragment.data, (uint32_t)i) != gxp_find(body->view.copy_fragment.data, 0))
                view.displacement[3 * i] = view.displacement[3 * i + 1] = 3;
    }
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    x = (double *)calloc(3 * skin.vertex_count, sizeof *x);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (trial = 0; trial < 300; trial++) { /* straight at a point of a face */
        const uint32_t *t = skin.triangles + 3 * random_below((int)skin.triangle_count);
        const gx_view view = view_of(body);
        double origin[3], direction[3], normal[3], share[3], sum = 0;
        gx_anchor a;
        gx_hit hit;
        int i, k;
        gxp_triangle_normal(x, t, normal);
        for (i = 0; i < 3; i++) sum += share[i] = random_real(0, 1);
        for (k = 0; k < 3; k++) {
            origin[k] = normal[k];
            direction[k] = -normal[k];
            for (i = 0; i < 3; i++) origin[k] += share[i] / sum * x[3 * t[i] + (uint32_t)k];
        }
        ck_assert_int_eq(gx_body_pick(body, origin, direction, &hit, NULL), GX_OK);
        if (hit.triangle == UINT32_MAX) continue;
        ck_assert_int_eq(gx_hit_anchor(body, &hit, &a, NULL), GX_OK);
        CHECK_SEED(view.cell_fragment[cell_of(&view, body, &a)] == hit.fragment, seed);
        made += hit.surface != GX_SKIN_OUTER;
    }
    free(x);
    ck_assert_int_gt(made, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Two cells of an element on the sides of a sheet that ends just beyond it share all copies. Both are found at a point
   of the sheet, and each anchor belongs to its own. */
START_TEST(hits_beside_a_slit) {
    const double slit[3][3] = {{1.5, 0.9, 0.95}, {1.5, 1.55, 0.95}, {1.5, 1.55, 1.6}}, point[3] = {1.5, 1.375, 1.125};
    workload w = grid(3, 3, 3, 6);
    gx_body *body = body_of(&w);
    wl_surface *s = wl_add_surface(&w, 0);
    gx_hit hits[8];
    size_t count = 0, i;
    for (i = 0; i < 3; i++) wl_add_vertex(s, slit[i]);
    wl_add_triangle(s, 0, 1, 2);
    cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(view_of(body).copy_count, w.node_count);
    ck_assert_int_eq(gx_body_locate_all(body, point, hits, 8, &count, NULL), GX_OK);
    ck_assert_uint_eq(count, 2);
    ck_assert(hits[0].element == hits[1].element && hits[0].slot != hits[1].slot);
    for (i = 0; i < 2; i++) {
        gx_anchor anchor;
        ck_assert_int_eq(gx_hit_anchor(body, &hits[i], &anchor, NULL), GX_OK);
        ck_assert_uint_eq(slot_of(body, &anchor), hits[i].slot);
        ck_assert(anchor.position[0] == 1.5);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Cuts that keep the copies divide the cell that was hit, and then remove a part of it. Older hits belong to the part
   where they are, and then to what is left of the cell. Of a cell that is gone there is nothing. */
START_TEST(hits_of_divided_cells) {
    enum { POINTS = 200 };
    static gx_hit hits[POINTS];
    workload w = grid(3, 3, 3, 6);
    gx_body *body = body_of(&w);
    const uint64_t epoch = view_of(body).epoch;
    const double p[3] = {1.5, 1.4, 1.3}, n[3] = {1, 0.2, -0.3};
    gx_surface surfaces[2];
    gx_cut_desc cut;
    gx_hit middle, now;
    uint32_t part = UINT32_MAX;
    size_t i, in_part = 0;
    random_seed(3);
    memset(&cut, 0, sizeof cut);
    ck_assert_int_eq(gx_body_locate(body, p, 1, &middle, NULL), GX_OK);
    for (i = 0; i < POINTS;) {
        const double x[3] = {random_real(1, 2), random_real(1, 2), random_real(1, 2)};
        ck_assert_int_eq(gx_body_locate(body, x, 1, &hits[i], NULL), GX_OK);
        i += hits[i].slot == middle.slot;
    }
    add_plane(&w, p, n, 9);
    add_box(&w, 1, 0.5, 0.5, 0.5, 2.5, 2.5, 2.5);
    for (i = 0; i < 2; i++) {
        surfaces[i] = surface_of(&w.surfaces[i]);
        surfaces[i].scope_slots = i == 0 ? &middle.slot : &part;
        surfaces[i].scope_slot_count = 1;
    }
    cut.surfaces = surfaces;
    cut.surface_count = 1;
    ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
    for (i = 0; i < POINTS; i++) {
        gx_anchor anchor;
        ck_assert_int_eq(gx_body_locate(body, hits[i].position, 1, &now, NULL), GX_OK);
        ck_assert(now.element == middle.element && now.epoch == epoch);
        ck_assert_int_eq(gx_hit_anchor(body, &hits[i], &anchor, NULL), GX_OK);
        ck_assert_uint_eq(slot_of(body, &anchor), now.slot);
        if (now.slot != middle.slot) part = now.slot, in_part++;
    }
    ck_assert(in_part > 20 && in_part < POINTS - 20);
    ck_assert_int_eq(gx_body_locate(body, p, 1, &middle, NULL), GX_OK);
    cut.surfaces = &surfaces[1];
    ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
    ck_assert(view_of(body).epoch == epoch);
    for (i = 0; i < POINTS; i++) {
        gx_anchor anchor;
        ck_assert_int_eq(gx_hit_anchor(body, &hits[i], &anchor, NULL), GX_OK); /* what is left of the cell */
        ck_assert_uint_eq(slot_of(body, &anchor), hits[i].slot);
    }
    now = hits[0];
    now.slot = part;
    now.slot_count = middle.slot_count; /* a hit of the part, before it was removed */
    {
        gx_anchor anchor;
        gx_failure failure;
        ck_assert_int_eq(gx_hit_anchor(body, &now, &anchor, &failure), GX_ERROR_EMPTY);
        ck_assert_str_eq(failure.field, "hit.slot");
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A cut through position and toward: the part in front of the triangle's plane. Through position only: towards toward.
 */
START_TEST(cuts_through_an_anchor) {
    static const double p[3] = {0.25, 0.25, 0.25}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    int turned, kind;
    for (turned = 0; turned < 2; turned++)
        for (kind = 0; kind < 3; kind++) {
            static cuts c;
            workload w = corner_tet();
            gx_body *body = body_of(&w);
            gx_anchor a = {0, {0.25, 0.25, 0.25}, {0.3, 0.25, 0.25}};
            const int above = kind == 0 ? !turned : kind == 1;
            uint32_t leaf;
            memset(&c, 0, sizeof c);
            if (kind > 0) a.toward[2] += kind == 1 ? 1e-9 : -1e-9;
            cut_plane(body, &c, p, turned ? y : x, turned ? x : y);
            ck_assert_int_eq(gxp_leaf_at(body, 0, a.position, a.toward, &leaf), GX_OK);
            ck_assert_int_eq(gxp_collect_leaf_points(body, leaf), GX_OK);
            {
                uint32_t i;
                double top = 0;
                for (i = 0; i < body->scratch.leaf_points.count; i++) {
                    double lambda[4];
                    gxb_complex_barycentric(body->complex, body->scratch.leaf_points.data[i], 0, lambda);
                    top = fmax(top, lambda[3]);
                }
                ck_assert_int_eq(top > 0.5, above);
            }
            gx_body_destroy(body);
            wl_free(&w);
        }
}
END_TEST

static gx_step_desc step_of(double dt) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.newton_iterations = 8;
    return step;
}

/* A point is picked at y = .45 and the body cut at y = .46: the spring pulls the lower piece only, its twin the upper
   one, and each comes to its target. */
START_TEST(a_pick_keeps_to_its_side) {
    static const double along[3] = {1, 0, 0}, up[3] = {0, 0, 1}, p[3] = {0, 0.46, 0};
    static const double origin[2][3] = {{0.5, 0.45, 3}, {0.5, 0.47, 3}}, down[3] = {0, 0, -1};
    static cuts c;
    workload w = grid(2, 2, 2, 6);
    gx_body *body;
    gx_anchor anchors[2];
    gxs_spring springs[2];
    double forces[6], before[2][3], at[3];
    gx_step_desc step = step_of(0.02);
    gx_motion motions[2];
    gx_view view;
    gx_skin skin;
    gx_hit hit;
    size_t i;
    int k, frame;
    for (i = 0; i < 3 * w.node_count; i++) w.positions[i] *= 0.5;
    body = body_of(&w);
    memset(&c, 0, sizeof c);
    memset(springs, 0, sizeof springs);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    for (i = 0; i < 2; i++) {
        ck_assert_int_eq(gx_body_pick(body, origin[i], down, &hit, NULL), GX_OK);
        ck_assert_int_eq(gx_hit_anchor(body, &hit, &anchors[i], NULL), GX_OK);
        memcpy(springs[i].target, hit.position, sizeof hit.position);
        springs[i].target[1] += i == 0 ? -2 : 2;
        springs[i].stiffness = 1e5;
        springs[i].point.count = 77; /* not read */
    }
    cut_plane(body, &c, p, along, up);
    step.springs = springs;
    step.spring_count = 2;
    step.spring_anchors = anchors;
    step.spring_forces = forces;
    for (i = 0; i < 2; i++) ck_assert_int_eq(gx_body_anchor_point(body, &anchors[i], NULL, before[i], NULL), GX_OK);
    for (frame = 0; frame < 60; frame++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    for (i = 0; i < 2; i++) {
        ck_assert_int_eq(gx_body_anchor_point(body, &anchors[i], NULL, at, NULL), GX_OK);
        ck_assert(fabs(at[1] - springs[i].target[1]) < 0.3);
        ck_assert(fabs(before[i][1] - (i == 0 ? 0.45 : 0.47)) < 1e-12);
        for (k = 0; k < 3; k++)
            ck_assert(fabs(forces[3 * i + (size_t)k] - 1e5 * (springs[i].target[k] - at[k])) < 1e-3);
    }
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    ck_assert_int_eq(gx_body_motion(body, motions, 2, NULL), GX_OK);
    for (i = 0; i < 2; i++) {
        const double y = view.fragment_center[3 * i + 1];
        ck_assert(y < 0.46 ? motions[i].center[1] < y - 1 : motions[i].center[1] > y + 1);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Steps with anchors are steps with their points, bit for bit. */
START_TEST(steps_by_anchors) {
    workload w = grid(2, 2, 1, 5);
    gx_body *by_anchors, *by_copies = NULL;
    gx_anchor anchors[6];
    gxs_spring springs[2], of_points[2];
    gxs_point points[2], point = {0};
    gxs_plane ground;
    gx_step_desc step = step_of(0.01), other;
    gx_view view;
    double push[6] = {10, 0, 0, 0, 20, 30}, *forces, *own;
    size_t i;
    uint32_t j, k;
    random_seed(5);
    add_axis_plane(&w, 0, 0.75);
    by_anchors = cut_at_once(&w);
    for (i = 0; i < 6; i++) {
        const uint32_t element = (uint32_t)(3 * i);
        double x[3];
        random_material(&w, element, x);
        ck_assert_int_eq(gx_body_anchor(by_anchors, element, x, &anchors[i], NULL), GX_OK);
    }
    ck_assert_int_eq(gx_body_clone(by_anchors, &by_copies, NULL), GX_OK);
    view = view_of(by_anchors);
    view = view_of(by_copies);
    memset(springs, 0, sizeof springs);
    for (i = 0; i < 2; i++) {
        springs[i].target[i] = 2;
        springs[i].stiffness = 100;
        of_points[i] = springs[i];
        ck_assert_int_eq(gx_body_anchor_point(by_copies, &anchors[i], &of_points[i].point, NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_body_anchor_point(by_copies, &anchors[2 + i], &points[i], NULL, NULL), GX_OK);
    }
    memset(&ground, 0, sizeof ground);
    ground.normal[2] = 1;
    ground.offset = 0.4;
    ground.stiffness = 1000;
    forces = (double *)calloc(3 * view.copy_count, sizeof *forces);
    own = (double *)calloc(3 * view.copy_count, sizeof *own);
    for (i = 0; i < 3 * view.copy_count; i++) own[i] = forces[i] = random_real(-1, 1);
    for (i = 0; i < 2; i++) {
        ck_assert_int_eq(gx_body_anchor_point(by_copies, &anchors[4 + i], &point, NULL, NULL), GX_OK);
        for (j = 0; j < point.count; j++)
            for (k = 0; k < 3; k++) forces[3 * point.copy[j] + k] += point.weight[j] * push[3 * i + k];
    }
    step.gravity[2] = -9.81;
    step.planes = &ground;
    step.plane_count = 1;
    step.spring_count = step.point_count = 2;
    step.epoch = view.epoch;
    other = step;
    step.springs = springs;
    step.spring_anchors = anchors;
    step.point_anchors = anchors + 2;
    step.force_anchors = anchors + 4;
    step.anchor_forces = push;
    step.force_count = 2;
    step.forces = own;
    other.springs = of_points;
    other.points = points;
    other.forces = forces;
    for (i = 0; i < 20; i++) {
        ck_assert_int_eq(gx_body_step(by_anchors, &step, NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_body_step(by_copies, &other, NULL, NULL), GX_OK);
        ck_assert(gx_body_state_hash(by_anchors) == gx_body_state_hash(by_copies));
        if (i == 10) step.forces = other.forces = NULL;
        if (i == 10) step.force_count = 0;
    }
    free(forces);
    free(own);
    gx_body_destroy(by_anchors);
    gx_body_destroy(by_copies);
    wl_free(&w);
}
END_TEST

/* A lost anchor holds nothing and disturbs nothing: steps are those without it. */
START_TEST(lost_anchors_do_nothing) {
    workload w = grid(2, 1, 1, 5);
    gx_body *with = body_of(&w), *without = NULL;
    gx_anchor anchors[2];
    gxs_spring springs[2];
    gxs_plane ground;
    double forces[6], push[3] = {0, 0, 1e6};
    const double x[2][3] = {{0.25, 0.25, 0.25}, {1.75, 0.25, 0.25}};
    gx_step_desc step = step_of(0.01), other;
    gx_failure failure;
    uint8_t lost[2];
    size_t i, j;
    for (i = 0; i < 2; i++) {
        for (j = 0; j < w.element_count && gx_body_anchor(with, (uint32_t)j, x[i], &anchors[i], NULL) != GX_OK; j++) {}
        ck_assert_uint_lt(j, w.element_count);
    }
    add_box(&w, 1, -1, -1, -1, 0.5, 2, 2);
    cut_by(with, &w, 0, 1);
    ck_assert_int_eq(gx_body_clone(with, &without, NULL), GX_OK);
    ck_assert_int_eq(gx_body_lost_anchors(with, anchors, 2, lost, NULL), GX_OK);
    ck_assert(lost[0] && !lost[1]);
    ck_assert_int_eq(gx_body_anchor_point(with, &anchors[0], NULL, NULL, &failure), GX_ERROR_EMPTY);
    ck_assert_str_eq(failure.field, "anchor");
    memset(springs, 0, sizeof springs);
    springs[0].stiffness = springs[1].stiffness = 1000;
    springs[0].target[0] = -5;
    springs[1].target[0] = 3;
    memset(&ground, 0, sizeof ground);
    ground.normal[2] = 1;
    ground.offset = 0.4;
    ground.stiffness = 1000;
    step.planes = &ground;
    step.plane_count = 1;
    step.springs = springs;
    step.spring_anchors = anchors;
    step.spring_count = 2;
    step.spring_forces = forces;
    step.point_anchors = anchors;
    step.point_count = 2;
    step.force_anchors = anchors;
    step.anchor_forces = push;
    step.force_count = 1;
    other = step;
    other.springs = springs + 1;
    other.spring_anchors = other.point_anchors = anchors + 1;
    other.spring_count = other.point_count = 1;
    other.spring_forces = NULL;
    other.force_count = 0;
    for (i = 0; i < 20; i++) {
        const gx_view view = view_of(with);
        ck_assert_int_eq(gx_body_step(with, &step, NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_body_step(without, &other, NULL, NULL), GX_OK);
        for (j = 0; j < 3 * view.copy_count; j++)
            ck_assert(fabs(view.displacement[j] - view_of(without).displacement[j]) < 1e-12);
        ck_assert(forces[0] == 0 && forces[1] == 0 && forces[2] == 0 && forces[3] != 0);
    }
    add_box(&w, 1, -1, -1, -1, 3, 3, 3); /* all goes */
    cut_by(with, &w, 1, 1);
    memset(forces, 1, sizeof forces);
    ck_assert_int_eq(gx_body_step(with, &step, NULL, NULL), GX_OK);
    for (i = 0; i < 6; i++) ck_assert(forces[i] == 0);
    springs[1].stiffness = -1; /* refused as of any body */
    ck_assert_int_eq(gx_body_step(with, &step, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "springs.stiffness");
    gx_body_destroy(with);
    gx_body_destroy(without);
    wl_free(&w);
}
END_TEST

/* Anchors know no body: they are as good in a copy, and after going back. */
START_TEST(copies_and_going_back) {
    const uint64_t seed = (uint64_t)_i + 1;
    static cuts c;
    workload w = grid(2, 1, 1, 6);
    gx_body *body = body_of(&w), *clone = NULL, *read = NULL;
    gx_anchor anchors[50];
    gxs_point before[50], point;
    unsigned char *bytes;
    size_t size = 0, i;
    random_seed(seed);
    memset(&c, 0, sizeof c);
    for (i = 0; i < 50; i++) {
        double x[3];
        const uint32_t element = (uint32_t)random_below((int)w.element_count);
        if (i == 20 || i == 30) cut_random_plane(body, &c, &w, anchors, i);
        random_material(&w, element, x);
        ck_assert_int_eq(gx_body_anchor(body, element, x, &anchors[i], NULL), GX_OK);
    }
    ck_assert_int_eq(gx_body_clone(body, &clone, NULL), GX_OK);
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = (unsigned char *)malloc(size);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &read, NULL), GX_OK);
    for (i = 0; i < 50; i++) {
        ck_assert_int_eq(gx_body_anchor_point(body, &anchors[i], &before[i], NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_body_anchor_point(read, &anchors[i], &point, NULL, NULL), GX_OK);
        CHECK_SEED(memcmp(&point, &before[i], sizeof point) == 0, seed);
    }
    cut_random_plane(body, &c, &w, anchors, 50);
    cut_random_solid(body, &c, &w, anchors, 50);
    ck_assert_int_eq(gx_body_restore(body, clone, NULL), GX_OK);
    for (i = 0; i < 50; i++) {
        ck_assert_int_eq(gx_body_anchor_point(body, &anchors[i], &point, NULL, NULL), GX_OK);
        CHECK_SEED(memcmp(&point, &before[i], sizeof point) == 0, seed);
    }
    free(bytes);
    gx_body_destroy(body);
    gx_body_destroy(clone);
    gx_body_destroy(read);
    wl_free(&w);
}
END_TEST

/* Turns a point about two axes, so that no axis stays one. */
static void turn(double x[3]) {
    const double y = 0.8 * x[1] - 0.6 * x[2], z = 0.6 * x[1] + 0.8 * x[2], first = x[0];
    x[0] = (5 * first - 12 * z) / 13;
    x[1] = y;
    x[2] = (12 * first + 5 * z) / 13;
}

/* Far from the origin, and of any size; an element as flat as a sheet of paper, along the axes and across them, where
   the terms of its volume cancel. */
START_TEST(far_small_and_flat) {
    static const double sizes[7] = {1, 1e-6, 1e6, 1e-29, 1e29, 1, 1}, offsets[7] = {1e8, 0.3, 12345678.9, 0, 0, 0, 0};
    const double h = sizes[_i], o = offsets[_i];
    static cuts c;
    workload w = grid(2, 2, 1, 5);
    gx_body *body;
    size_t i;
    int trial;
    random_seed((uint64_t)_i);
    memset(&c, 0, sizeof c);
    for (i = 0; i < w.node_count; i++) {
        int k;
        if (_i == 5) w.positions[3 * i + 2] *= 1e-9;
        if (_i == 6) w.positions[3 * i + 2] *= 1e-7;
        if (_i == 6) turn(w.positions + 3 * i);
        for (k = 0; k < 3; k++) w.positions[3 * i + (size_t)k] = o + h * w.positions[3 * i + (size_t)k];
    }
    body = body_of(&w);
    for (trial = 0; trial < 3; trial++) {
        double p[3], u[3], v[3];
        int k;
        random_point(&w, p);
        for (k = 0; k < 3; k++) {
            u[k] = h * random_real(-1, 1) * (_i == 5 && k == 2 ? 1e-9 : 1);
            v[k] = h * random_real(-1, 1) * (_i == 5 && k == 2 ? 1e-9 : 1);
        }
        cut_plane(body, &c, p, u, v);
    }
    for (trial = 0; trial < 300; trial++) {
        const uint32_t element = (uint32_t)random_below((int)w.element_count);
        const gx_view view = view_of(body);
        gxs_point point;
        gx_anchor a;
        double x[3], back[3] = {0, 0, 0};
        uint32_t j;
        int k;
        memset(&point, 0, sizeof point);
        random_material(&w, element, x);
        ck_assert_int_eq(gx_body_anchor(body, element, x, &a, NULL), GX_OK);
        ck_assert_int_eq(gx_body_anchor_point(body, &a, &point, NULL, NULL), GX_OK);
        for (j = 0; j < point.count; j++)
            for (k = 0; k < 3; k++)
                back[k] += point.weight[j] * w.positions[3 * view.copy_node[point.copy[j]] + (size_t)k];
        for (k = 0; k < 3; k++) {
            ck_assert(fabs(a.position[k] - x[k]) <= 2e-6 * h);
            ck_assert(fabs(back[k] - a.position[k]) <= 1e-11 * h + 1e-15 * fabs(o));
        }
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- refusals ---- */

static void expect(gx_body *body, uint64_t state, const gx_failure *failure, gx_result result, gx_result expected,
                   const char *field, size_t index, int line) {
    ck_assert_msg(result == expected && failure->result == expected, "line %d: %s, should be: %s", line,
                  gx_result_text(result), gx_result_text(expected));
    ck_assert_msg(failure->field != NULL && strcmp(failure->field, field) == 0, "line %d: field %s", line,
                  failure->field != NULL ? failure->field : "NULL");
    ck_assert_msg(failure->index == index, "line %d: index %zu", line, failure->index);
    ck_assert_msg(gx_body_state_hash(body) == state, "line %d: the body has changed", line);
}

#define REFUSED(call, expected, field, index) expect(body, state, &failure, call, expected, field, index, __LINE__)

START_TEST(refused_anchors) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    const double inside[3] = {0.5, 0.5, 0.5}, outside[3] = {0.9, 0.9, 0.9}, nan[3] = {0.5, NAN, 0.5},
                 far[3] = {0.5, 1e60, 0.5};
    gx_anchor a, bad;
    gx_failure failure;
    gx_hit hit, wrong;
    gx_skin skin;
    uint8_t lost;
    uint64_t state;
    uint32_t element = 0;
    gx_anchor two[2];
    while (gx_body_anchor(body, element, inside, &a, NULL) != GX_OK) element++;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    {
        const double origin[3] = {0.4, 0.3, 3}, down[3] = {0, 0, -1};
        ck_assert_int_eq(gx_body_pick(body, origin, down, &hit, NULL), GX_OK);
    }
    state = gx_body_state_hash(body);
    REFUSED(gx_body_anchor(NULL, element, inside, &a, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    REFUSED(gx_body_anchor(body, element, NULL, &a, &failure), GX_ERROR_ARGUMENT, "material", SIZE_MAX);
    REFUSED(gx_body_anchor(body, element, inside, NULL, &failure), GX_ERROR_ARGUMENT, "anchor", SIZE_MAX);
    REFUSED(gx_body_anchor(body, 5, inside, &a, &failure), GX_ERROR_INDEX, "element", 5);
    REFUSED(gx_body_anchor(body, element, nan, &a, &failure), GX_ERROR_NOT_FINITE, "material", SIZE_MAX);
    REFUSED(gx_body_anchor(body, element, far, &a, &failure), GX_ERROR_RANGE, "material", SIZE_MAX);
    REFUSED(gx_body_anchor(body, element, outside, &a, &failure), GX_ERROR_EMPTY, "material", SIZE_MAX);
    REFUSED(gx_hit_anchor(NULL, &hit, &a, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    REFUSED(gx_hit_anchor(body, NULL, &a, &failure), GX_ERROR_ARGUMENT, "hit", SIZE_MAX);
    REFUSED(gx_hit_anchor(body, &hit, NULL, &failure), GX_ERROR_ARGUMENT, "anchor", SIZE_MAX);
    memset(&wrong, 0, sizeof wrong);
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_EMPTY, "hit", SIZE_MAX);
    wrong = hit;
    wrong.epoch = 77;
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_STALE, "hit.epoch", SIZE_MAX);
    wrong = hit;
    wrong.element = 5;
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_INDEX, "hit.element", SIZE_MAX);
    wrong = hit;
    wrong.slot = 77;
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_INDEX, "hit.slot", SIZE_MAX);
    wrong.slot = (hit.element + 1) % 5; /* of another element */
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_INDEX, "hit.slot", SIZE_MAX);
    wrong = hit;
    wrong.slot_count = hit.slot;
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_INDEX, "hit.slot", SIZE_MAX);
    wrong = hit;
    wrong.material[0] = INFINITY;
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_NOT_FINITE, "hit.material", SIZE_MAX);
    wrong.material[0] = 1e60;
    REFUSED(gx_hit_anchor(body, &wrong, &a, &failure), GX_ERROR_RANGE, "hit.material", SIZE_MAX);
    REFUSED(gx_body_anchor_point(NULL, &a, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    REFUSED(gx_body_anchor_point(body, NULL, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "anchor", SIZE_MAX);
    bad = a;
    bad.element = 5;
    REFUSED(gx_body_anchor_point(body, &bad, NULL, NULL, &failure), GX_ERROR_INDEX, "anchor.element", SIZE_MAX);
    bad = a;
    bad.position[2] = NAN;
    REFUSED(gx_body_anchor_point(body, &bad, NULL, NULL, &failure), GX_ERROR_NOT_FINITE, "anchor.position", SIZE_MAX);
    bad.position[2] = 1e60;
    REFUSED(gx_body_anchor_point(body, &bad, NULL, NULL, &failure), GX_ERROR_RANGE, "anchor.position", SIZE_MAX);
    bad.position[2] = 1.5;
    REFUSED(gx_body_anchor_point(body, &bad, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "anchor.position", SIZE_MAX);
    bad = a;
    bad.toward[0] = INFINITY;
    REFUSED(gx_body_anchor_point(body, &bad, NULL, NULL, &failure), GX_ERROR_NOT_FINITE, "anchor.toward", SIZE_MAX);
    bad.toward[0] = -1e60;
    REFUSED(gx_body_anchor_point(body, &bad, NULL, NULL, &failure), GX_ERROR_RANGE, "anchor.toward", SIZE_MAX);
    two[0] = a;
    two[1] = bad;
    REFUSED(gx_body_lost_anchors(NULL, &a, 1, &lost, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    REFUSED(gx_body_lost_anchors(body, NULL, 1, &lost, &failure), GX_ERROR_ARGUMENT, "anchors", SIZE_MAX);
    REFUSED(gx_body_lost_anchors(body, &a, 1, NULL, &failure), GX_ERROR_ARGUMENT, "lost", SIZE_MAX);
    {
        uint8_t both[2];
        REFUSED(gx_body_lost_anchors(body, two, 2, both, &failure), GX_ERROR_RANGE, "anchors.toward", 1);
    }
    ck_assert_int_eq(gx_body_lost_anchors(body, NULL, 0, NULL, &failure), GX_OK);
    add_box(&w, 1, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75);
    add_axis_plane(&w, 0, 0.5);
    cut_by(body, &w, 0, 2);
    state = gx_body_state_hash(body);
    REFUSED(gx_body_anchor(body, element, inside, &a, &failure), GX_ERROR_EMPTY, "material", SIZE_MAX);
    REFUSED(gx_hit_anchor(body, &hit, &a, &failure), GX_ERROR_STALE, "hit.epoch", SIZE_MAX);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* An element between two planes with no double between them: nothing can stand inside it. */
START_TEST(nowhere_to_stand) {
    static double positions[12] = {0, 0, 1, 1, 0, 1, 0, 1, 1, 0.25, 0.25, 1 + 2.220446049250313e-16};
    static uint32_t elements[4] = {0, 1, 2, 3};
    static const double x[3] = {0.25, 0.25, 1};
    workload w = wl_empty();
    gx_body *body;
    gx_anchor a;
    gx_failure failure;
    gx_hit hit;
    uint64_t state;
    w.positions = positions;
    w.elements = elements;
    w.node_count = 4;
    w.element_count = 1;
    body = body_of(&w);
    state = gx_body_state_hash(body);
    REFUSED(gx_body_anchor(body, 0, x, &a, &failure), GX_ERROR_FLAT, "material", SIZE_MAX);
    ck_assert_int_eq(gx_body_locate(body, x, 1, &hit, NULL), GX_OK);
    ck_assert_uint_eq(hit.element, 0);
    REFUSED(gx_hit_anchor(body, &hit, &a, &failure), GX_ERROR_FLAT, "hit.material", SIZE_MAX);
    gx_body_destroy(body);
}
END_TEST

START_TEST(refused_steps) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    const double inside[3] = {0.5, 0.5, 0.5};
    gx_anchor good, bad[2];
    gxs_spring springs[2];
    gxs_pair pair;
    gx_step_desc step = step_of(0.01), with;
    double push[6] = {1, 2, 3, 4, 5, 6}, forces[3 * 64];
    gx_failure failure;
    uint64_t state;
    uint32_t element = 0;
    add_axis_plane(&w, 0, 0.75);
    body = cut_at_once(&w);
    while (gx_body_anchor(body, element, inside, &good, NULL) != GX_OK) element++;
    memset(springs, 0, sizeof springs);
    memset(forces, 0, sizeof forces);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK); /* so that there is a model */
    state = gx_body_state_hash(body);
    bad[0] = bad[1] = good;
    bad[1].element = 5;
    with = step;
    with.spring_anchors = bad;
    with.spring_count = 2;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "springs", SIZE_MAX);
    with.springs = springs;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_INDEX, "spring_anchors.element", 1);
    bad[1] = good;
    bad[1].position[0] = 4;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "spring_anchors.position", 1);
    bad[1] = good;
    bad[1].toward[0] = NAN;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_NOT_FINITE, "spring_anchors.toward", 1);
    bad[1] = good;
    springs[1].stiffness = -1;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "springs.stiffness", 1);
    springs[1].stiffness = 0;
    with.spring_count = (size_t)1 << 40;
    if (sizeof(size_t) > 4)
        REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_LIMIT, "spring_count", SIZE_MAX);
    with = step;
    with.point_anchors = bad;
    with.point_count = 2;
    bad[1].element = 5;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_INDEX, "point_anchors.element", 1);
    bad[1] = good;
    bad[1].position[1] = INFINITY;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_NOT_FINITE, "point_anchors.position", 1);
    with = step;
    with.pair_anchors = bad;
    with.pair_count = 1;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "pairs", SIZE_MAX);
    memset(&pair, 0, sizeof pair);
    with.pairs = &pair;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_NOT_FINITE, "pair_anchors.position", 1);
    bad[0].element = 5;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_INDEX, "pair_anchors.element", 0);
    bad[0] = bad[1] = good;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "pairs.normal", 0);
    pair.normal[1] = 1;
    pair.stiffness = -1;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "pairs.stiffness", 0);
    with.pair_count = (size_t)1 << 40;
    if (sizeof(size_t) > 4) REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_LIMIT, "pair_count", SIZE_MAX);
    pair.stiffness = 0;
    with.pair_count = 1;
    with.integrator = GXS_MIDPOINT;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "pairs", SIZE_MAX);
    bad[1].position[1] = INFINITY;
    with = step;
    with.force_count = 2;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "force_anchors", SIZE_MAX);
    with.force_anchors = bad;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_ARGUMENT, "anchor_forces", SIZE_MAX);
    with.anchor_forces = push;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_NOT_FINITE, "force_anchors.position", 1);
    bad[1] = good;
    push[4] = NAN;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_NOT_FINITE, "anchor_forces", 1);
    push[4] = 0;
    with.forces = forces;
    REFUSED(gx_body_step(body, &with, NULL, &failure), GX_ERROR_STALE, "epoch", SIZE_MAX);
    with.epoch = view_of(body).epoch;
    ck_assert_int_eq(gx_body_step(body, &with, NULL, &failure), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- pairs ---- */

enum { MOST_PAIRS = 96 };

/* Pairs between the two faces of the plane z = 1, on which faces of a mesh of cubes lie */
typedef struct closed {
    gxs_pair pairs[MOST_PAIRS];
    gx_anchor anchors[2 * MOST_PAIRS]; /* above, below */
    double slips[3 * MOST_PAIRS], forces[3 * MOST_PAIRS];
    size_t count;
} closed;

/* The corners of an element on the plane, where there are three; returns the side of the fourth, 0: there are not */
static int face_of(const workload *w, size_t element, uint32_t corner[3]) {
    int k, count = 0, side = 0;
    for (k = 0; k < 4; k++) {
        const uint32_t node = w->elements[4 * element + (size_t)k];
        const double z = w->positions[3 * (size_t)node + 2];
        if (z > 1) side++;
        if (z < 1) side--;
        if (z > 1 || z < 1) continue;
        if (count < 3) corner[count] = node;
        count++;
    }
    return count == 3 ? side : 0;
}

/* Three samples for each triangle, each nearer to a corner: they give each corner a third of the triangle's load. */
static void add_pairs(gx_body *body, const workload *w, size_t above, double stiffness, closed *all) {
    uint32_t corner[3], own[3];
    size_t below;
    int near, k, c;
    if (face_of(w, above, corner) <= 0) return;
    for (near = 0; near < 3; near++) {
        double x[3] = {0, 0, 0};
        gxs_pair *pair = &all->pairs[all->count];
        int found = 0;
        ck_assert_uint_lt(all->count, MOST_PAIRS);
        for (k = 0; k < 3; k++)
            for (c = 0; c < 3; c++)
                x[c] += w->positions[3 * (size_t)corner[k] + (size_t)c] * (k == near ? 2.0 / 3 : 1.0 / 6);
        x[2] = 1;
        memset(pair, 0, sizeof *pair);
        pair->normal[2] = 1;
        pair->stiffness = stiffness / 6;
        pair->friction = 0.5;
        ck_assert_int_eq(gx_body_anchor(body, (uint32_t)above, x, &all->anchors[2 * all->count], NULL), GX_OK);
        for (below = 0; below < w->element_count && !found; below++)
            found = face_of(w, below, own) < 0 &&
                    gx_body_anchor(body, (uint32_t)below, x, &all->anchors[2 * all->count + 1], NULL) == GX_OK;
        ck_assert(found);
        all->count++;
    }
}

/* A bar of 2 x 2 x 2 cubes, cut at z = 1, with its ends held */
static gx_body *closed_bar(memory *m, workload *w, double stiffness, closed *all) {
    gx_region ends[2];
    gx_material material;
    gx_body_desc desc;
    gx_body *body = NULL;
    size_t i;
    *w = grid(2, 2, 2, 6);
    add_axis_plane(w, 2, 1);
    desc = desc_of(w);
    memset(&material, 0, sizeof material);
    material.elastic.kind = GXS_LINEAR;
    material.elastic.young = desc.young;
    material.density = desc.density;
    desc.materials = &material;
    desc.material_count = 1;
    if (m != NULL) desc.allocator = allocator_of(m);
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    cut_by(body, w, 0, 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ends[0] = gx_region_half_space(2, -1, 0.5);
    ends[1] = gx_region_half_space(2, 1, 1.5);
    ck_assert_int_eq(gx_body_hold(body, ends, 2, NULL), GX_OK);
    memset(all, 0, sizeof *all);
    for (i = 0; i < w->element_count; i++) add_pairs(body, w, i, stiffness, all);
    ck_assert_uint_eq(all->count, 24);
    return body;
}

/* At rest, with the upper end pushed down */
static gx_step_desc press(closed *all, double poses[24], double pushed) {
    static const double stay[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    gx_step_desc step = step_of(0);
    memcpy(poses, stay, sizeof stay);
    memcpy(poses + 12, stay, sizeof stay);
    poses[23] = -pushed;
    step.integrator = GXS_STATIC;
    step.region_poses = poses;
    step.newton_iterations = 50;
    step.newton_tolerance = 1e-9;
    step.cg_tolerance = 1e-4;
    step.cg_iterations = 5000;
    step.pairs = all->pairs;
    step.pair_count = all->count;
    step.pair_anchors = all->anchors;
    step.pair_slips = all->slips;
    step.pair_forces = all->forces;
    return step;
}

static double pressing(const closed *all) {
    double sum = 0;
    size_t i;
    for (i = 0; i < all->count; i++) sum += all->forces[3 * i + 2];
    return sum;
}

/* A closed cut carries load in series with its pairs: 1 / (1 + h / (c L)) of the uncut bar's, for a stiffness per area
   of c E / h. Anchors and points give the same bits; anchors outlive a further cut, points do not. */
START_TEST(pairs_close_a_cut) {
    static const double factors[3] = {1, 10, 100};
    const double young = 1e6, pushed = 1e-5, whole = young * 4 * pushed / 2, c = factors[_i];
    workload w;
    closed *all = (closed *)oracle_memory(NULL, 2, sizeof *all), *twin = all + 1;
    gx_body *body = closed_bar(NULL, &w, c * young, all), *other = NULL;
    double poses[24];
    uint32_t copies[MOST_PAIRS][8];
    double weights[MOST_PAIRS][8];
    gx_step_desc step, by_points;
    gx_failure failure;
    size_t i;
    uint64_t rest;
    ck_assert_int_eq(gx_body_clone(body, &other, NULL), GX_OK);
    step = press(all, poses, 0);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK); /* nothing presses: a cut at rest stays so */
    for (i = 0; i < 3 * view_of(body).copy_count; i++) ck_assert(view_of(body).displacement[i] == 0);
    ck_assert(pressing(all) == 0);
    *twin = *all;
    step = press(all, poses, pushed);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    ck_assert_msg(fabs(pressing(all) / whole * (1 + 1 / (c * 2)) - 1) < 2e-4, "c = %g: %g of %g", c, pressing(all),
                  whole);
    for (i = 0; i < twin->count; i++) {
        gxs_point side[2], *point = &twin->pairs[i].point;
        uint32_t s, k;
        memset(point, 0, sizeof *point);
        for (s = 0; s < 2; s++) {
            ck_assert_int_eq(gx_body_anchor_point(other, &all->anchors[2 * i + s], &side[s], NULL, NULL), GX_OK);
            for (k = 0; k < side[s].count; k++) {
                copies[i][point->count] = side[s].copy[k];
                weights[i][point->count++] = s == 0 ? side[s].weight[k] : -side[s].weight[k];
            }
        }
        point->copies = copies[i];
        point->weights = weights[i];
        point->epoch = side[0].epoch;
    }
    by_points = press(twin, poses, pushed);
    by_points.pair_anchors = NULL;
    ck_assert_int_eq(gx_body_step(other, &by_points, NULL, NULL), GX_OK);
    ck_assert(gx_body_state_hash(body) == gx_body_state_hash(other));
    ck_assert(memcmp(all->forces, twin->forces, sizeof all->forces) == 0);
    add_axis_plane(&w, 0, 0.3); /* through the pairs, from end to end */
    cut_by(body, &w, 1, 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 4);
    rest = gx_body_state_hash(body);
    by_points.pair_slips = NULL;
    ck_assert_int_eq(gx_body_step(body, &by_points, NULL, &failure), GX_ERROR_STALE);
    ck_assert_str_eq(failure.field, "pairs.point.epoch");
    ck_assert(gx_body_state_hash(body) == rest);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    ck_assert_msg(fabs(pressing(all) / whole * (1 + 1 / (c * 2)) - 1) < 0.01, "cut: %g of %g", pressing(all), whole);
    memcpy(twin->slips, all->slips, sizeof all->slips);
    add_box(&w, 1, -1, -1, 0.9, 3, 3, 1.4); /* the upper faces go */
    cut_by(body, &w, 2, 1);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    for (i = 0; i < 3 * all->count; i++) ck_assert(all->forces[i] == 0);
    ck_assert(memcmp(all->slips, twin->slips, sizeof all->slips) == 0);
    add_box(&w, 1, -1, -1, -1, 3, 3, 3); /* all goes */
    cut_by(body, &w, 3, 1);
    memset(all->forces, 1, sizeof all->forces);
    step.region_poses = NULL;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    for (i = 0; i < 3 * all->count; i++) ck_assert(all->forces[i] == 0);
    ck_assert(memcmp(all->slips, twin->slips, sizeof all->slips) == 0);
    gx_body_destroy(body);
    gx_body_destroy(other);
    free(all);
    wl_free(&w);
}
END_TEST

/* A step with pairs that runs out of memory leaves the body as it was, and may be taken again. */
START_TEST(pairs_without_memory) {
    workload w;
    memory m = plenty();
    closed all, before;
    double poses[24];
    gx_step_desc step;
    gx_result result = GX_ERROR_MEMORY;
    gx_body *body = closed_bar(&m, &w, 1e7, &all);
    const uint64_t state = gx_body_state_hash(body);
    size_t n;
    step = press(&all, poses, 1e-5);
    before = all;
    for (n = 0; result != GX_OK; n++) {
        ck_assert_uint_lt(n, 10000);
        fail_from(&m, n, _i);
        result = gx_body_step(body, &step, NULL, NULL);
        ck_assert(result == GX_OK ? !m.failed || _i == 0 : result == GX_ERROR_MEMORY);
        if (result == GX_OK) break;
        never_fail(&m);
        ck_assert(gx_body_state_hash(body) == state);
        ck_assert(memcmp(before.slips, all.slips, sizeof all.slips) == 0);
    }
    ck_assert_uint_gt(n, 2);
    never_fail(&m);
    gx_body_destroy(body);
    ck_assert(is_whole(&m));
    wl_free(&w);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("anchors");
    TCase *tests = tcase_create("anchors");
    tcase_set_timeout(tests, getenv("GXFEM_ANCHORS") != NULL ? 7200 : 300);
    tcase_add_test(tests, each_on_its_own_side);
    ADD_SOME(tests, hits_on_faces_of_cuts, 10);
    tcase_add_test(tests, hits_beside_a_slit);
    tcase_add_test(tests, hits_of_divided_cells);
    tcase_add_test(tests, cuts_through_an_anchor);
    tcase_add_test(tests, a_pick_keeps_to_its_side);
    tcase_add_test(tests, steps_by_anchors);
    tcase_add_test(tests, lost_anchors_do_nothing);
    ADD_SOME(tests, copies_and_going_back, 10);
    tcase_add_loop_test(tests, far_small_and_flat, 0, 7);
    tcase_add_test(tests, refused_anchors);
    tcase_add_test(tests, nowhere_to_stand);
    tcase_add_test(tests, refused_steps);
    tcase_add_loop_test(tests, pairs_close_a_cut, 0, 3);
    tcase_add_loop_test(tests, pairs_without_memory, 0, 2);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) { return run_suite(suite()); }
