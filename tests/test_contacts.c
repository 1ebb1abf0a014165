/* test_contacts.c - where the edge of a blade is in the material, beside a slow and obvious answer: over all cells, and
   all leaves of cut ones by their facets, in long doubles. Bodies are at rest, follow given motions, are cut meanwhile,
   moved into each other, turned inside out, flattened, restored and read again.

   Random tests print their seed; GXFEM_SEED=n runs seed n alone. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include "../bench/blade.h"

enum { MOST_PARTS = 2048, MOST = 256, SEEDS = 24 / FEWER };

/* ---- the oracle ---- */

typedef long double real;

typedef struct part { /* of a segment of the edge, in a cell */
    real low, high;   /* shares */
    uint32_t segment, slot, layer;
} part;
typedef struct answer {
    part parts[MOST_PARTS];
    size_t count;
} answer;

static void difference(const real *a, const real *b, real *r) {
    int k;
    for (k = 0; k < 3; k++) r[k] = a[k] - b[k];
}
static real inner(const real *a, const real *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static real triple(const real *a, const real *b, const real *c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* det(b - a, c - a, d - a) */
static real volume_of(const real *a, const real *b, const real *c, const real *d) {
    real u[3], v[3], w[3];
    difference(b, a, u);
    difference(c, a, v);
    difference(d, a, w);
    return triple(u, v, w);
}

/* Narrows a part to where a function that is linear along the segment, a at its beginning and b at its end, is not
   below 0. */
static void keep_positive(real a, real b, part *p) {
    if (a < 0 && b < 0) p->high = p->low - 1;
    if (a < 0 && b >= 0) p->low = fmaxl(p->low, a / (a - b));
    if (a >= 0 && b < 0) p->high = fminl(p->high, a / (a - b));
}

/* The element's barycentric coordinates of a point by moved corners; returns the volume, as a share of that at rest */
static real shares_of(const gx_body *body, uint32_t slot, const real *x, real share[4]) {
    const gxp_cell *cell = &body->cells.data[slot];
    const uint32_t *node = gxb_complex_element_nodes(body->complex, cell->element);
    real corner[4][3], rest[4][3], whole;
    const real *c[4];
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) {
            rest[i][k] = body->mesh.positions[3 * (size_t)node[i] + (size_t)k];
            corner[i][k] = rest[i][k] + (real)body->copies.displacement[3 * (size_t)cell->copies[i] + (size_t)k];
        }
    whole = volume_of(corner[0], corner[1], corner[2], corner[3]);
    for (i = 0; i < 4; i++) {
        for (k = 0; k < 4; k++) c[k] = k == i ? x : corner[k];
        share[i] = volume_of(c[0], c[1], c[2], c[3]) / whole;
    }
    return whole / volume_of(rest[0], rest[1], rest[2], rest[3]);
}

/* Given coordinates of a point of the complex */
static void given(const gx_body *body, uint32_t point, real x[3]) {
    const gxb_cpoint *p = gxb_complex_point(body->complex, point);
    int k;
    if (p->kind != GXB_EXPLICIT || p->ball.error > 0) ck_abort_msg("not a point as given");
    for (k = 0; k < 3; k++)
        x[k] = ldexpl(p->ball.x[k], -gxb_complex_shift(body->complex)) + (real)gxb_complex_origin(body->complex)[k];
}

/* A material point over a plane of the complex, as the plane is defined */
static real height_of(const gx_body *body, uint32_t plane, const real *x) {
    const gxb_cplane *f = gxb_complex_plane(body->complex, plane);
    real p[3], q[3], r[3];
    int k;
    given(body, f->def[0], p);
    given(body, f->def[1], q);
    if (f->along_axis)
        for (k = 0; k < 3; k++) r[k] = p[k] + (k == (int)f->def[2]);
    else
        given(body, f->def[2], r);
    return volume_of(p, q, r, x);
}

/* The material point of these coordinates */
static void material_of(const gx_body *body, uint32_t element, const real share[4], real x[3]) {
    const uint32_t *node = gxb_complex_element_nodes(body->complex, element);
    int i, k;
    for (k = 0; k < 3; k++) {
        x[k] = 0;
        for (i = 0; i < 4; i++) x[k] += share[i] * body->mesh.positions[3 * (size_t)node[i] + (size_t)k];
    }
}

static void add_part(answer *a, const part *p) {
    if (!(p->high > p->low)) return;
    if (a->count == MOST_PARTS) ck_abort_msg("more parts than there is room for");
    a->parts[a->count++] = *p;
}

/* The parts of a segment in a cell: in each of its leaves, by the facets around that */
static void meet_cell(gx_body *body, uint32_t slot, uint32_t segment, real ends[2][3], answer *a) {
    const uint32_t element = body->cells.data[slot].element;
    part whole = {0, 1, 0, 0, 0};
    real share[2][4], rest[2][3];
    uint32_t leaf, first, count, i;
    int k;
    whole.segment = segment;
    whole.slot = slot;
    if (fabsl(shares_of(body, slot, ends[0], share[0])) < 1e-9L) return; /* flat, or a speck of rounding */
    (void)shares_of(body, slot, ends[1], share[1]);
    for (k = 0; k < 4; k++) keep_positive(share[0][k], share[1][k], &whole);
    if (!(gxb_complex_root(body->complex, element) & 1)) {
        add_part(a, &whole);
        return;
    }
    for (k = 0; k < 2; k++) material_of(body, element, share[k], rest[k]);
    for (leaf = body->cells.data[slot].first_leaf; leaf != UINT32_MAX; leaf = body->leaves.data[leaf].next) {
        part own = whole;
        if (gxb_leaf_resolve_facets(body->complex, leaf, &first, &count) != GX_OK) ck_abort_msg("no facets");
        for (i = 0; i < count; i++) {
            const gxb_facet *f = gxb_complex_facet(body->complex, gxp_item(body->complex, first + i));
            const real side = f->leaf[0] == leaf ? 1 : -1;
            keep_positive(side * height_of(body, f->plane, rest[0]), side * height_of(body, f->plane, rest[1]), &own);
        }
        add_part(a, &own);
    }
}

static int share_a_copy(const gx_body *body, uint32_t a, uint32_t b) {
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 4; k++)
            if (body->cells.data[a].copies[i] == body->cells.data[b].copies[k]) return 1;
    return 0;
}

/* Parts in cells that hang together through copies of cells that the edge meets have one layer. */
static void number_parts(const gx_body *body, answer *a) {
    size_t i, j;
    int changed = 1;
    for (i = 0; i < a->count; i++) a->parts[i].layer = (uint32_t)i;
    while (changed)
        for (i = 0, changed = 0; i < a->count; i++)
            for (j = 0; j < a->count; j++)
                if (a->parts[j].layer < a->parts[i].layer && share_a_copy(body, a->parts[i].slot, a->parts[j].slot)) {
                    a->parts[i].layer = a->parts[j].layer;
                    changed = 1;
                }
}

static int compare_parts(const void *x, const void *y) {
    const part *a = (const part *)x, *b = (const part *)y;
    if (a->layer != b->layer) return a->layer < b->layer ? -1 : 1;
    if (a->segment != b->segment) return a->segment < b->segment ? -1 : 1;
    return a->low < b->low ? -1 : a->low > b->low;
}

/* All parts of the edge in the body, each layer's in order */
static void find_parts(gx_body *body, const double *edge, size_t count, answer *a) {
    uint32_t slot, i;
    int k;
    a->count = 0;
    for (i = 0; i + 1 < count; i++) {
        real ends[2][3];
        for (k = 0; k < 6; k++) ends[k / 3][k % 3] = edge[3 * i + (uint32_t)k];
        for (slot = 0; slot < body->cells.count; slot++)
            if (body->cells.data[slot].kept) meet_cell(body, slot, i, ends, a);
    }
    number_parts(body, a);
    qsort(a->parts, a->count, sizeof *a->parts, compare_parts);
}

/* The length of the edge in a fragment, each layer for itself; UINT32_MAX: in all */
static double length_in(const gx_body *body, const double *edge, const answer *a, const gx_view *view,
                        uint32_t fragment) {
    real sum = 0, reach = 0;
    size_t i, c;
    for (i = 0; i < a->count; i++) {
        const part *p = &a->parts[i];
        const double *x = edge + 3 * (size_t)p->segment;
        const real way[3] = {(real)x[3] - x[0], (real)x[4] - x[1], (real)x[5] - x[2]};
        if (i == 0 || p->layer != p[-1].layer || p->segment != p[-1].segment) reach = 0;
        for (c = 0; view->cell_slot[c] != body->cells.slot[p->slot];) c++;
        if (p->high > reach && (fragment == UINT32_MAX || view->cell_fragment[c] == fragment))
            sum += (p->high - fmaxl(p->low, reach)) * sqrtl(inner(way, way));
        reach = fmaxl(p->high, reach);
    }
    return (double)sum;
}

/* ---- checks ---- */

typedef struct contacts {
    gx_blade_contact at[MOST];
    size_t count;
} contacts;

static contacts found; /* by the last call */

static const contacts *contacts_of(gx_blade *blade) {
    gx_failure failure;
    memset(&found, 0, sizeof found);
    ck_assert_msg(gx_blade_contacts(blade, found.at, MOST, &found.count, &failure) == GX_OK, "%s",
                  gx_result_text(failure.result));
    ck_assert(failure.result == GX_OK && failure.field == NULL);
    return &found;
}

static double length_of(const contacts *c, uint32_t fragment) {
    double sum = 0;
    size_t i;
    for (i = 0; i < c->count; i++)
        if (fragment == UINT32_MAX || c->at[i].hit.fragment == fragment) sum += c->at[i].length;
    return sum;
}

/* A contact is a place on the edge, and its hit the material there. near: m */
static void check_contact(gx_body *body, const gx_view *view, const double *edge, size_t count,
                          const gx_blade_contact *c, double near) {
    const gx_hit *hit = &c->hit;
    const size_t segment = c->along < (double)count - 2 ? (size_t)c->along : count - 2;
    const double share = c->along - (double)segment;
    double x[3], sum = 0;
    uint32_t i;
    int k;
    ck_assert(c->along >= 0 && share <= 1 && c->length > 0 && !(hit->distance > 0) && hit->triangle == UINT32_MAX);
    ck_assert_uint_lt(hit->cell, view->cell_count);
    ck_assert(view->cell_slot[hit->cell] == hit->slot && view->cell_element[hit->cell] == hit->element);
    ck_assert(view->cell_fragment[hit->cell] == hit->fragment && hit->epoch == view->epoch);
    for (k = 0; k < 3; k++) {
        const double *a = edge + 3 * segment;
        ck_assert(fabs(a[k] + share * (a[k + 3] - a[k]) - hit->position[k]) <= near);
        x[k] = 0;
    }
    ck_assert(hit->copy_count >= 1 && hit->copy_count <= 4);
    for (i = 0; i < hit->copy_count; i++) {
        const uint32_t copy = hit->copies[i];
        ck_assert(hit->weights[i] > 0);
        sum += hit->weights[i];
        for (k = 0; k < 3; k++)
            x[k] += hit->weights[i] * (body->mesh.positions[3 * (size_t)view->copy_node[copy] + (size_t)k] +
                                       view->displacement[3 * copy + (uint32_t)k]);
    }
    ck_assert(fabs(sum - 1) <= 1e-14);
    for (k = 0; k < 3; k++)
        ck_assert_msg(fabs(x[k] - hit->position[k]) <= near, "%g m off", fabs(x[k] - hit->position[k]));
    ck_assert_int_eq(gx_body_place(body, hit->slot, hit->material, x, NULL), GX_OK);
    for (k = 0; k < 3; k++) ck_assert(fabs(x[k] - hit->position[k]) <= near);
}

/* Compares what the blade is in with the oracle's answer, of all and of each fragment. near: m */
static void check_contacts(gx_blade *blade, const double *edge, size_t count, double near, uint64_t seed) {
    static answer a;
    gx_body *body = blade->body;
    const gx_view view = view_of(body);
    const uint64_t state = gx_body_state_hash(body);
    const contacts *c = contacts_of(blade);
    uint32_t f;
    size_t i;
    ck_assert(gx_body_state_hash(body) == state);
    for (i = 0; i < c->count; i++) check_contact(body, &view, edge, count, &c->at[i], near);
    find_parts(body, edge, count, &a);
    for (f = 0; f <= view.fragment_count; f++) {
        const uint32_t fragment = f < view.fragment_count ? f : UINT32_MAX;
        const double own = length_of(c, fragment), right = length_in(body, edge, &a, &view, fragment);
        ck_assert_msg(fabs(own - right) <= 1e4 * near, "seed %llu: %.12g m in place of %.12g in fragment %d",
                      (unsigned long long)seed, own, right, (int)fragment);
    }
}

/* ---- stages ---- */

/* scale: of a cube, m; origin: of the first node, m */
static stage block_at(uint32_t n, uint64_t seed, int starts_inside, double scale, const double origin[3]) {
    stage s;
    gx_blade_desc desc;
    memset(&s, 0, sizeof s);
    memset(&desc, 0, sizeof desc);
    s.cells[0] = s.cells[1] = s.cells[2] = n;
    s.random = seed * 7919;
    s.scale = scale;
    memcpy(s.origin, origin, sizeof s.origin);
    desc.starts_inside = starts_inside;
    stage_open(&s, 1e3, 0, &desc);
    return s;
}

static stage block(uint32_t n, uint64_t seed, int starts_inside) {
    static const double zero[3] = {0, 0, 0};
    return block_at(n, seed, starts_inside, 1, zero);
}

static void move_to(gx_blade *blade, const double *edge, size_t count) {
    gx_failure failure;
    ck_assert_msg(gx_blade_move(blade, edge, count, NULL, 0, NULL, &failure) == GX_OK, "%s, %s",
                  gx_result_text(failure.result), failure.field ? failure.field : "none");
}

static gx_body *cloned(gx_body *body) {
    gx_body *clone = NULL;
    ck_assert_int_eq(gx_body_clone(body, &clone, NULL), GX_OK);
    return clone;
}

static gx_body *saved_and_loaded(gx_body *body) {
    gx_body *loaded = NULL;
    void *bytes;
    size_t size = 0;
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = malloc(size);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &loaded, NULL), GX_OK);
    free(bytes);
    return loaded;
}

/* ---- at rest ---- */

typedef struct place {
    double ends[6];
    double length; /* in a block of 4 cubes */
    double first;  /* where that begins, on the edge */
} place;

static const place places[] = {
    {{-3, 1.3, 2.6, 7, 1.3, 2.6}, 4, 3},                               /* through */
    {{1.25, 1.3, 2.6, 2.5, 1.3, 2.6}, 1.25, 0},                        /* within */
    {{-1, 2, 2, 9, 2, 2}, 4, 1},                                       /* along mesh edges */
    {{-1, -1, 1.5, 5, 5, 1.5}, 5.656854249492381, 1.4142135623730951}, /* in a plane of faces */
    {{-2, -2, -2, 6, 6, 6}, 6.928203230275509, 3.4641016151377544},    /* along diagonals */
    {{-2, 1.2, 4, 6, 1.2, 4}, 4, 2},                                   /* in the surface */
    {{-2, 4, 4, 6, 4, 4}, 4, 2},                                       /* along an edge of the block */
    {{-2, 1.2, 4.000001, 6, 1.2, 4.000001}, 0, 0},                     /* beside it */
    {{-1, 9, 0, 9, -1, 0}, 0, 0},                                      /* through no corner of it */
    {{-2, 6, 1.3, 6, -2, 1.3}, 5.656854249492381, 2.8284271247461903},
    {{0.5, 7.5, 1.3, 7.5, 0.5, 1.3}, 0, 0}, /* through a point of its edge */
    {{1, 1, 1, 1, 1, 1}, 0, 0},             /* a point */
};
enum { PLACES = sizeof places / sizeof *places };

/* Lengths in a block at rest are known; contacts have equal ones and lie in their middles. An edge of 1001 points, some
   of them equal, has the contacts of that of two. */
START_TEST(at_rest) {
    enum { MANY = 1001 };
    static double edge[3 * MANY];
    static contacts two;
    const place *p = &places[_i];
    stage s = block(4, 1, 1);
    gx_blade *many = NULL;
    gx_blade_desc desc;
    double way[3], length = 0;
    size_t i;
    int k;
    memset(&desc, 0, sizeof desc);
    desc.starts_inside = 1;
    for (k = 0; k < 3; k++) way[k] = p->ends[3 + k] - p->ends[k];
    length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    move_to(s.blade, p->ends, 2);
    two = *contacts_of(s.blade);
    ck_assert_msg(fabs(length_of(&two, UINT32_MAX) - p->length) <= 1e-8, "%.12g m", length_of(&two, UINT32_MAX));
    ck_assert(two.count >= 1.2 * p->length && two.count <= 3 * p->length + 1); /* half a cube apart */
    for (i = 0; i < two.count; i++) {
        const double share = (p->first + p->length * ((double)i + 0.5) / (double)two.count) / length;
        ck_assert(fabs(two.at[i].along - share) <= 1e-9);
        ck_assert(fabs(two.at[i].length - p->length / (double)two.count) <= 1e-9);
        check_contact(s.body, &s.view, p->ends, 2, &two.at[i], 1e-9);
    }
    if (_i < 2) check_contacts(s.blade, p->ends, 2, 1e-12, 0);
    ck_assert_int_eq(gx_blade_create(s.body, &desc, &many, NULL), GX_OK);
    for (i = 0; i < MANY; i++)
        for (k = 0; k < 3; k++)
            edge[3 * i + (size_t)k] = i == MANY - 1 ? p->ends[3 + k] : p->ends[k] + way[k] * (double)(i / 2 * 2) / MANY;
    move_to(many, edge, MANY);
    (void)contacts_of(many);
    ck_assert_uint_eq(found.count, two.count);
    for (i = 0; i < two.count; i++) {
        check_contact(s.body, &s.view, edge, MANY, &found.at[i], 1e-9);
        for (k = 0; k < 3; k++) ck_assert(fabs(found.at[i].hit.position[k] - two.at[i].hit.position[k]) <= 1e-7);
    }
    stage_close(&s);
}
END_TEST

/* An edge that leaves a block and comes back, within a segment, at the next one, or after one in the air */
START_TEST(bent_edges) {
    const double edge[18] = {1.1, 1.2, -1, 1.3, 1.2, 5, 1.8, 1.3, -1, 2.2, 1.1, -1, 2.3, 1.4, 2.2, 3.1, 7.3, 2.3};
    stage s = block(4, 1, 1);
    size_t i, back = 0;
    move_to(s.blade, edge, 6);
    check_contacts(s.blade, edge, 6, 1e-11, 0);
    for (i = 0; i < found.count; i++) {
        ck_assert(i == 0 || found.at[i].along > found.at[i - 1].along);
        ck_assert((size_t)found.at[i].along != 2);
        back += i > 0 && found.at[i].length < found.at[i - 1].length;
    }
    ck_assert_uint_gt(back, 0); /* each run is divided by itself */
    stage_close(&s);
}
END_TEST

/* Presses a body along z, turns it, so that nothing is where doubles are exact, and puts a point of it at a place. */
static void turn_and_put(stage *s, double press, const double axis[3], double angle, const double point[3],
                         const double place[3]) {
    double middle[3];
    size_t c;
    int k;
    memcpy(middle, point, sizeof middle);
    middle[2] *= press;
    stage_turn(axis, angle, middle);
    for (c = 0; c < s->view.copy_count; c++) {
        const double *rest = s->rest + 3 * s->view.copy_node[c];
        double x[3];
        memcpy(x, rest, sizeof x);
        x[2] *= press;
        stage_turn(axis, angle, x);
        for (k = 0; k < 3; k++)
            s->view.displacement[3 * c + (size_t)k] = x[k] - middle[k] + place[k] - rest[k] - s->origin[k];
    }
}

/* An edge along mesh edges, in faces, in walls inside elements or in faces, and along the line where two walls cross
   has its whole length in each piece, however the body lies and however short the edge is. */
START_TEST(in_faces_and_walls) {
    const double z = _i % 8 < 4 ? 2.25 : 2, y = _i % 8 < 4 ? 1.75 : 2;
    const double lines[4][6] = {
        {-2, 3, 3, 6, 3, 3}, {-2, -2, 1, 6, 6, 1}, {-2, 1.3, z, 6, 1.5, z}, {-2, y, z, 6, y, z}};
    static const int pieces[4] = {1, 1, 2, 4};
    static const double places[4] = {0, 10, 1e3, 1e7}, homes[3] = {0, 1e3, 1e7}, shares[3] = {1, 1e-3, 1e-4},
                        up[3] = {0, 0, 1}, aside[3] = {0, 1, 0};
    const double turn = 0.3 + _i, press = _i / 8 % 2 == 0 ? 1 : 1e-4, away = places[_i % 4], home = homes[_i / 16],
                 at[3] = {away, -2 * away, away}, origin[3] = {home, home, -home}, cuts[3] = {home, home + y, z - home};
    stage s = block_at(4, (uint64_t)_i + 1, 1, 1, origin);
    workload w = wl_empty();
    double axis[3];
    int i, j, k;
    stage_unit(&s, axis);
    add_plane(&w, cuts, up, 30);
    add_plane(&w, cuts, aside, 30);
    cut_by(s.body, &w, 0, 2);
    s.view = view_of(s.body);
    ck_assert_uint_eq(s.view.fragment_count, 4);
    for (i = 0; i < 4; i++) {
        const double *line = lines[i];
        double middle[3], way[3], length = 0;
        for (k = 0; k < 3; k++) {
            middle[k] = 0.5 * line[k] + 0.5 * line[3 + k];
            way[k] = 0.5 * line[3 + k] - 0.5 * line[k];
            length += way[k] * way[k];
        }
        length = sqrt(length);
        turn_and_put(&s, press, axis, turn, middle, at);
        stage_turn(axis, turn, way);
        for (j = 0; j < 3; j++) {
            const double expected = pieces[i] * length * fmin(2 * shares[j], 1); /* half of the line is in the block */
            double edge[6], sum;
            for (k = 0; k < 6; k++) edge[k] = at[k % 3] + (k < 3 ? -shares[j] : shares[j]) * way[k % 3];
            move_to(s.blade, edge, 2);
            sum = length_of(contacts_of(s.blade), UINT32_MAX);
            ck_assert_msg(fabs(sum - expected) < (1e-8 + 1e-12 * (away + home)) / press,
                          "line %d, a share of %g of it: %.9g m in place of %.9g", i, shares[j], sum, expected);
            ck_assert_uint_lt(found.count, 20 * (size_t)pieces[i]);
            ck_assert_int_eq(gx_blade_lift(s.blade, NULL, NULL), GX_OK);
        }
    }
    wl_free(&w);
    stage_close(&s);
}
END_TEST

/* ---- while body and blade move ---- */

/* A pass through a moving body: after each move, after the pose of the next frame, and where the body has fallen apart
   meanwhile. Of some bodies pieces overlap, of some elements are inside out. */
START_TEST(passes) {
    const uint64_t seed = (uint64_t)_i + 1;
    stage s = block(4, seed, 1);
    stage_motion motion = stage_random_motion(&s, STAGE_SWINGING);
    double along[3], way[3];
    int frame, k;
    if (_i % 4 == 1) s.noise = 0.05;
    if (_i % 4 == 3) {
        s.noise = 0.1;
        motion.squeeze[_i % 3] = 0.2;
    }
    stage_unit(&s, along);
    stage_unit(&s, way);
    for (frame = 0; frame <= 24; frame++) {
        double edge[9], at[3];
        for (k = 0; k < 3; k++) {
            at[k] = 2 + way[k] * 5 * (frame / 12.0 - 1);
            edge[k] = at[k] - 9 * along[k];
            edge[3 + k] = at[k] + 0.2 * way[k];
            edge[6 + k] = at[k] + 9 * along[k];
        }
        stage_pose(&s, &motion, frame / 24.0);
        stage_move_edge(&s, edge, 3);
        ck_assert_int_eq(s.failure.result, GX_OK);
        check_contacts(s.blade, edge, 3, 1e-11, seed);
        stage_pose(&s, &motion, (frame + 0.5) / 24.0);
        check_contacts(s.blade, edge, 3, 1e-11, seed);
        if (frame == 8 && _i % 2 == 0) {
            stage_cut_plane(&s, 2.3);
            stage_look(&s);
        }
        if (s.view.fragment_count > 1) { /* drives the pieces into each other, until the next pose */
            size_t c;
            for (c = 0; c < 4 * s.view.cell_count; c++)
                if (s.view.cell_fragment[c / 4] == 1) s.view.displacement[3 * s.view.cell_copies[c]] -= 0.03;
            check_contacts(s.blade, edge, 3, 1e-11, seed);
        }
    }
    stage_close(&s);
}
END_TEST

/* ---- pieces that overlap, elements that are inside out or flat ---- */

/* The upper half of a block comes down into the lower one, in which the edge is. A wall shut tight has both sides. */
START_TEST(overlapping_pieces) {
    static const double downs[4] = {0.75, 1.9, 4, 0}, lengths[4][2] = {{4, 4}, {4, 4}, {4, 0}, {4, 4}};
    const double z = _i == 3 ? 2 : 1.6, edge[6] = {-3, 1.3, z, 7, 1.4, z}, slant = sqrt(100.01) / 10;
    stage s = block(4, 1, 1);
    workload w = wl_empty();
    uint32_t low;
    size_t i;
    int k;
    add_axis_plane(&w, 2, 2);
    cut_by(s.body, &w, 0, 1);
    s.view = view_of(s.body);
    ck_assert_uint_eq(s.view.fragment_count, 2);
    low = s.view.fragment_center[2] > 2;
    for (i = 0; i < 4 * s.view.cell_count; i++)
        if (s.view.cell_fragment[i / 4] != low) s.view.displacement[3 * s.view.cell_copies[i] + 2] = -downs[_i];
    move_to(s.blade, edge, 2);
    (void)contacts_of(s.blade);
    for (k = 0; k < 2; k++) {
        const double own = length_of(&found, k == 0 ? low : 1 - low);
        ck_assert_msg(fabs(own - slant * lengths[_i][k]) <= 1e-8, "%g m in piece %d", own, k);
    }
    for (i = 1; i < found.count; i++) /* piece by piece, along the edge in each */
        ck_assert(found.at[i].hit.fragment != found.at[i - 1].hit.fragment ||
                  found.at[i].along > found.at[i - 1].along);
    if (_i < 3) check_contacts(s.blade, edge, 2, 1e-10, 0);
    wl_free(&w);
    stage_close(&s);
}
END_TEST

/* Two arms of one piece, swung into each other: where they overlap there are contacts in both. */
START_TEST(arms_of_a_piece) {
    const double edge[6] = {-9, 2.3, 0.6, 15, 2.9, 0.9};
    stage s = block(6, 1, 1);
    size_t i;
    double alone;
    stage_cut_arms(&s, 2, 4, 4.5);
    ck_assert_uint_eq(s.view.fragment_count, 1);
    move_to(s.blade, edge, 2);
    check_contacts(s.blade, edge, 2, 1e-10, 0);
    alone = length_of(&found, UINT32_MAX);
    for (i = 0; i < s.view.copy_count; i++) {
        const double *x = s.rest + 3 * s.view.copy_node[i];
        s.view.displacement[3 * i] = x[2] > 4 ? 0 : (x[0] < 3 ? 0.5 : -0.5) * (4 - x[2]);
    }
    check_contacts(s.blade, edge, 2, 1e-10, 0);
    ck_assert_msg(fabs(length_of(&found, UINT32_MAX) - alone) < 0.1, "%g m, %g before", length_of(&found, UINT32_MAX),
                  alone); /* without what is covered twice: 1.2 less */
    stage_close(&s);
}
END_TEST

/* A body that is pressed: nearly flat, it has contacts where the edge crosses it; flat, or a point, it has none. Turned
   inside out it has those of its mirror image. */
START_TEST(pressed_bodies) {
    static const double factors[6] = {1e-3, 1e-7, 1e-11, 0, -1, -1e-3};
    const double f = factors[_i], edge[6] = {1.3, 1.4, -7, 1.3, 1.4, 7.5};
    stage s = block(3, 1, 1);
    size_t i;
    for (i = 0; i < s.view.copy_count; i++) {
        const double z = s.rest[3 * s.view.copy_node[i] + 2];
        s.view.displacement[3 * i + 2] = f * z - z;
    }
    move_to(s.blade, edge, 2);
    (void)contacts_of(s.blade);
    ck_assert(fabs(length_of(&found, UINT32_MAX) - 3 * fabs(f)) <= 1e-6);
    ck_assert_int_eq(found.count > 0, fabs(f) >= 1e-5); /* through less the edge only passes by */
    for (i = 0; i < found.count; i++) check_contact(s.body, &s.view, edge, 2, &found.at[i], 1e-9);
    for (i = 0; i < 3 * s.view.copy_count; i++)
        s.view.displacement[i] = 1.3 + (i % 3 == 1) * 0.1 - s.rest[3 * s.view.copy_node[i / 3] + i % 3];
    ck_assert_uint_eq(contacts_of(s.blade)->count, 0);
    stage_close(&s);
}
END_TEST

/* ---- the life of a blade ---- */

/* Asking changes nothing: a blade that is asked at each move cuts as one that is not, and its copies, cloned or read
   again, give the same answers. */
START_TEST(asking_changes_nothing) {
    static contacts first;
    stage asked = block(4, 3, 0), plain = block(4, 3, 0);
    const stage_motion motion = stage_random_motion(&asked, STAGE_SWINGING);
    int k, i;
    for (k = 0; k <= 30; k++) {
        const double y = -2 + 0.27 * k, edge[6] = {-9, y, 1.7, 13, y + 0.4, 2.2};
        stage_pose(&asked, &motion, k / 30.0);
        stage_pose(&plain, &motion, k / 30.0);
        move_to(asked.blade, edge, 2);
        move_to(plain.blade, edge, 2);
        first = *contacts_of(asked.blade);
        if (k > 10 && k < 20) ck_assert_uint_gt(first.count, 6);
        ck_assert(gx_body_state_hash(asked.body) == gx_body_state_hash(plain.body));
        (void)contacts_of(asked.blade);
        ck_assert(memcmp(&found, &first, sizeof found) == 0);
        asked.view = view_of(asked.body);
        plain.view = view_of(plain.body);
        for (i = 0; i < 2 && k % 5 == 0; i++) {
            gx_body *copy = i == 0 ? cloned(asked.body) : saved_and_loaded(asked.body);
            ck_assert_ptr_nonnull(gx_body_blade(copy, 0));
            (void)contacts_of(gx_body_blade(copy, 0));
            ck_assert_msg(memcmp(&found, &first, sizeof found) == 0, "copy %d differs at move %d", i, k);
            gx_body_destroy(copy);
        }
    }
    ck_assert_uint_eq(asked.view.fragment_count, 2);
    ck_assert(hash_of(asked.body) == hash_of(plain.body));
    stage_close(&asked);
    stage_close(&plain);
}
END_TEST

/* None before the first move, after the blade is lifted, and where the material is gone. A move that is refused leaves
   the edge where it was. Where the body goes back, so does the blade. */
START_TEST(beginning_and_end) {
    static const double low[3] = {-1, -1, -1}, middle[3] = {2.2, 5, 5}, high[3] = {5, 5, 5};
    const double edge[6] = {-3, 1.3, 1.6, 7, 1.3, 1.6}, bad[6] = {0, NAN, 0, 1, 1, 1};
    stage s = block(4, 1, 1);
    gx_body *before = cloned(s.body), *inside;
    workload w = wl_empty();
    wl_add_aligned_box(wl_add_surface(&w, 1), low, middle);
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    ck_assert_uint_eq(contacts_of(s.blade)->count, 0);
    move_to(s.blade, edge, 2);
    ck_assert(fabs(length_of(contacts_of(s.blade), UINT32_MAX) - 4) <= 1e-8);
    ck_assert_int_eq(gx_blade_move(s.blade, bad, 2, NULL, 0, NULL, NULL), GX_ERROR_NOT_FINITE);
    ck_assert(fabs(length_of(contacts_of(s.blade), UINT32_MAX) - 4) <= 1e-8);
    inside = cloned(s.body);
    cut_by(s.body, &w, 0, 1);
    ck_assert(fabs(length_of(contacts_of(s.blade), UINT32_MAX) - 1.8) <= 1e-8);
    check_contacts(s.blade, edge, 2, 1e-11, 0);
    cut_by(s.body, &w, 1, 1);
    ck_assert_uint_eq(view_of(s.body).cell_count, 0);
    ck_assert_uint_eq(contacts_of(s.blade)->count, 0);
    ck_assert_int_eq(gx_body_restore(s.body, inside, NULL), GX_OK);
    ck_assert(fabs(length_of(contacts_of(s.blade), UINT32_MAX) - 4) <= 1e-8);
    ck_assert_int_eq(gx_body_restore(s.body, before, NULL), GX_OK);
    ck_assert_uint_eq(contacts_of(s.blade)->count, 0);
    move_to(s.blade, edge, 2);
    ck_assert_uint_gt(contacts_of(s.blade)->count, 0);
    ck_assert_int_eq(gx_blade_lift(s.blade, NULL, NULL), GX_OK);
    ck_assert_uint_eq(contacts_of(s.blade)->count, 0);
    gx_body_destroy(before);
    gx_body_destroy(inside);
    wl_free(&w);
    stage_close(&s);
}
END_TEST

/* Small, large, and far from the origin: contacts as at home. */
START_TEST(sizes_and_places) {
    static const double scales[5] = {1048576, 1.0 / 1048576, 1e6, 1e-6, 1},
                        places[5][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1e6, -3e6, 2e6}};
    static contacts own;
    const double ends[6] = {-3, 1, 2, 7.1, 1, 2}, other[6] = {-3, 1.1, -1.7, 7.1, 4.6, 6.3};
    stage home = block(4, 1, 1), s = block_at(4, 1, 1, scales[_i], places[_i]);
    size_t i;
    int k, turn;
    for (turn = 0; turn < 2; turn++) {
        double edge[6];
        for (k = 0; k < 6; k++) edge[k] = s.origin[k % 3] + s.scale * (turn ? other : ends)[k];
        move_to(home.blade, turn ? other : ends, 2);
        own = *contacts_of(home.blade);
        move_to(s.blade, edge, 2);
        ck_assert_uint_eq(contacts_of(s.blade)->count, own.count);
        ck_assert_uint_gt(own.count, 6);
        for (i = 0; i < own.count; i++) {
            ck_assert(fabs(found.at[i].along - own.at[i].along) <= 1e-7);
            ck_assert(fabs(found.at[i].length / s.scale - own.at[i].length) <= 1e-7);
        }
        ck_assert_int_eq(gx_blade_lift(s.blade, NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_blade_lift(home.blade, NULL, NULL), GX_OK);
    }
    stage_close(&home);
    stage_close(&s);
}
END_TEST

/* Far ends cost nothing of what is between them. */
START_TEST(far_ends) {
    const double far = _i == 0 ? 1e3 : 1e6, edge[6] = {-far, 1.3, 1.6, far, 1.3, 1.6};
    stage s = block(4, 1, 1);
    move_to(s.blade, edge, 2);
    check_contacts(s.blade, edge, 2, 1e-9, 0);
    ck_assert(found.count >= 6 && fabs(length_of(&found, UINT32_MAX) - 4) <= 1e-6);
    stage_close(&s);
}
END_TEST

/* ---- refusals and memory ---- */

/* Room for too few: *count tells how many, and what has no room is not written. (test_failures.c has the fields.) */
START_TEST(too_little_room) {
    static contacts all, some;
    const double edge[6] = {-3, 1.3, 1.6, 7, 1.3, 1.6};
    stage s = block(3, 1, 1);
    uint64_t state;
    size_t room, count, i;
    gx_failure failure;
    move_to(s.blade, edge, 2);
    all = *contacts_of(s.blade);
    state = gx_body_state_hash(s.body);
    for (room = 0; room <= all.count; room++) {
        const gx_result expected = room < all.count ? GX_ERROR_CAPACITY : GX_OK;
        memset(&some, 7, sizeof some);
        ck_assert_int_eq(gx_blade_contacts(s.blade, room ? some.at : NULL, room, &count, &failure), expected);
        ck_assert_uint_eq(count, all.count);
        ck_assert(failure.result == expected && (failure.field != NULL) == (expected != GX_OK));
        for (i = 0; i < room; i++) ck_assert(memcmp(&some.at[i], &all.at[i], sizeof all.at[i]) == 0);
        for (i = 0; i < sizeof some.at[room]; i++) ck_assert(((unsigned char *)&some.at[room])[i] == 7);
        ck_assert(gx_body_state_hash(s.body) == state);
    }
    stage_close(&s);
}
END_TEST

/* A call in a body that was just cloned, of which the n-th allocation fails. Returns 0 if there are less. */
static int fails_at(gx_body *body, memory *m, size_t n, int from_then_on, const contacts *expected) {
    static contacts own;
    gx_body *copy = cloned(body);
    gx_blade *blade = gx_body_blade(copy, 0);
    uint64_t state;
    gx_result result;
    int failed;
    (void)view_of(copy);
    state = gx_body_state_hash(copy);
    memset(&own, 0, sizeof own);
    fail_from(m, n, from_then_on);
    result = gx_blade_contacts(blade, own.at, MOST, &own.count, NULL);
    failed = m->failed;
    never_fail(m);
    ck_assert_int_eq(result, failed ? GX_ERROR_MEMORY : GX_OK);
    ck_assert(gx_body_state_hash(copy) == state);
    ck_assert(memcmp(contacts_of(blade), expected, sizeof *expected) == 0);
    if (!failed) ck_assert(memcmp(&own, expected, sizeof *expected) == 0);
    gx_body_destroy(copy);
    return failed;
}

/* Each allocation fails in turn: the body is as it was, and the next call gives what it should. */
START_TEST(memory_runs_out) {
    static contacts expected;
    workload w = grid(2, 2, 2, 5);
    memory m;
    gx_body *body = body_in(&m, &w);
    gx_blade *blade = NULL;
    int k;
    for (k = 0; k < 4; k++) add_axis_plane(&w, 0, 0.3 + 0.5 * k); /* every element is cut */
    cut_by(body, &w, 0, 4);
    ck_assert_int_eq(gx_blade_create(body, NULL, &blade, NULL), GX_OK);
    for (k = 0; k < 3; k++) {
        const double y = -0.6 + 0.8 * k, edge[9] = {-9, y, 0.9, 1, y + 0.1, 1, 11, y + 0.3, 1.2};
        size_t n = 0;
        move_to(blade, edge, 3);
        expected = *contacts_of(blade);
        while (fails_at(body, &m, n, _i, &expected)) n++;
        ck_assert_uint_ge(n, k == 0 ? 8 : 12);
    }
    ck_assert_uint_gt(expected.count, 2);
    gx_body_destroy(body);
    ck_assert(is_whole(&m));
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("contacts");
    TCase *tests = tcase_create("contacts");
    const char *only = getenv("GXFEM_SEED");
    const int first = only ? atoi(only) - 1 : 0;
    tcase_set_timeout(tests, 300);
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, at_rest, 0, PLACES);
    tcase_add_test(tests, bent_edges);
    tcase_add_loop_test(tests, in_faces_and_walls, 0, 48);
    tcase_add_loop_test(tests, passes, first, only ? first + 1 : SEEDS);
    tcase_add_loop_test(tests, overlapping_pieces, 0, 4);
    tcase_add_test(tests, arms_of_a_piece);
    tcase_add_loop_test(tests, pressed_bodies, 0, 6);
    tcase_add_test(tests, asking_changes_nothing);
    tcase_add_test(tests, beginning_and_end);
    tcase_add_loop_test(tests, sizes_and_places, 0, 5);
    tcase_add_loop_test(tests, far_ends, 0, 2);
    tcase_add_test(tests, too_little_room);
    tcase_add_loop_test(tests, memory_runs_out, 0, 2);
    return run_suite(suite);
}
