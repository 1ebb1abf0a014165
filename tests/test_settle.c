/* test_settle.c - bodies that give back what removed material has held, at every cut or never: both are the same body.
   Saved, cloned, out of memory; thousands of strokes in little memory. */
#define GXFEM_IMPLEMENTATION
enum { NEVER, ALWAYS, IN_USE };
static int settles = IN_USE;
#undef GXBP_IS_SPARSE
#define GXBP_IS_SPARSE(sparse) (settles == IN_USE ? (sparse) : settles == ALWAYS)
#include "../gxfem.h"
#include "body.h"
#include "skin_check.h"
#include "../bench/strokes.h"

/* ---- comparison. Bodies number cells, copies and fragments differently where leaves have become one ---- */

enum { SURFACES = 64 };

static double rest_area(const gx_skin *skin, const uint32_t v[3]) {
    const double *a = skin->vertex_rest + 3 * (size_t)v[0], *b = skin->vertex_rest + 3 * (size_t)v[1],
                 *c = skin->vertex_rest + 3 * (size_t)v[2];
    double sum = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        sum += pow((b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]), 2);
    }
    return 0.5 * sqrt(sum);
}

/* Areas at rest by surface; edges and volume of the whole */
static skin_counts measure_skin(gx_body *body, double area[SURFACES], gx_skin *skin) {
    skin_counts counts;
    double *positions;
    size_t t;
    ck_assert_int_eq(gx_body_skin(body, NULL, skin, NULL), GX_OK);
    positions = (double *)malloc((3 * skin->vertex_count + 1) * sizeof *positions);
    ck_assert_int_eq(gx_body_skin_positions(body, positions, NULL), GX_OK);
    for (t = 0; t < SURFACES; t++) area[t] = 0;
    for (t = 0; t < skin->triangle_count; t++)
        area[skin->triangle_surface[t] % SURFACES] += rest_area(skin, skin->triangles + 3 * t);
    counts = skin_count(skin, UINT32_MAX, positions);
    free(positions);
    return counts;
}

/* A skin that was brought up to date beside that of a clone, which is made anew, and beside the other body's */
static void expect_same_skins(gx_body *p, gx_body *q, uint64_t seed) {
    double a[3][SURFACES];
    skin_counts n[3];
    gx_skin skin[3];
    gx_body *clone = NULL;
    int i, k;
    ck_assert_int_eq(gx_body_clone(p, &clone, NULL), GX_OK);
    n[0] = measure_skin(p, a[0], &skin[0]);
    n[1] = measure_skin(clone, a[1], &skin[1]);
    n[2] = measure_skin(q, a[2], &skin[2]);
    CHECK_SEED(skin[0].vertex_count == skin[1].vertex_count && n[0].triangles == n[1].triangles &&
                   n[0].edges == n[1].edges && n[0].vertices == n[1].vertices && n[0].open_edges == n[1].open_edges,
               seed);
    CHECK_SEED(n[0].triangles <= n[2].triangles && n[0].open_edges <= n[2].open_edges, seed);
    for (i = 1; i < 3; i++) {
        CHECK_SEED(fabs(n[i].volume - n[0].volume) <= 1e-12, seed);
        for (k = 0; k < SURFACES; k++) CHECK_SEED(fabs(a[i][k] - a[0][k]) <= 1e-11, seed);
    }
    gx_body_destroy(clone);
}

static void expect_same_settled(gx_body *p, gx_body *q, uint64_t seed) {
    const gx_view a = view_of(p), b = view_of(q);
    CHECK_SEED(fabs(a.volume - b.volume) <= 1e-12, seed);
    CHECK_SEED(a.slot_count == b.slot_count, seed);
    expect_same(p, q, 1, 4e-15, 1e-13 / a.volume, "settled", seed);
}

/* Bytes from anywhere are checked: what has been settled passes as what cuts have made. */
static gx_body *read_back(gx_body *body) {
    unsigned char *bytes;
    size_t size = 0;
    gx_body *read = NULL;
    gx_failure failure;
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = (unsigned char *)malloc(size);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_msg(gx_body_load(bytes, size, NULL, &read, &failure) == GX_OK, "load: %s at byte %zu",
                  gx_result_text(failure.result), failure.index);
    free(bytes);
    return read;
}

/* ---- two bodies that are cut alike ---- */

typedef struct twins {
    gx_body *body[2]; /* the first settles at most cuts, the second never */
    gx_blade *blade[2];
    uint64_t seed;
    int mode; /* of the first one */
} twins;

/* Every copy of a node moves alike. */
static void move_nodes(gx_body *body, double size) {
    const gx_view view = view_of(body);
    size_t i;
    int k;
    for (i = 0; i < view.copy_count; i++)
        for (k = 0; k < 3; k++) {
            const double *x = body->mesh.positions + 3 * (size_t)view.copy_node[i];
            view.displacement[3 * i + (size_t)k] = size * sin(2 * x[(k + 1) % 3] + 3 * x[(k + 2) % 3] + k);
        }
}

/* The slots of the cells that have some points */
static size_t slots_at(gx_body *body, const double *points, size_t count, uint32_t *slots) {
    gx_hit hits[8];
    size_t i;
    if (gx_body_locate(body, points, count, hits, NULL) != GX_OK) return 0;
    for (i = 0; i < count; i++) slots[i] = hits[i].slot;
    return count;
}

static void cut_twins(twins *t, const workload *w, size_t surface) {
    gx_cut_report report[2];
    double points[24];
    const int scoped = random_below(4) == 0;
    const double sever = random_below(4) == 0 ? 1e-3 : 0;
    int i;
    for (i = 0; i < 8; i++) random_point(w, points + 3 * i);
    for (i = 0; i < 2; i++) {
        gx_surface s = surface_of(&w->surfaces[surface]);
        gx_cut_desc desc;
        uint32_t slots[8];
        memset(&desc, 0, sizeof desc);
        desc.surfaces = &s;
        desc.surface_count = 1;
        desc.sever_below = sever;
        if (scoped) s.scope_slot_count = slots_at(t->body[i], points, 8, slots);
        if (s.scope_slot_count > 0) s.scope_slots = slots;
        settles = i == 0 ? t->mode : NEVER;
        ck_assert_int_eq(gx_body_cut(t->body[i], &desc, &report[i], NULL), GX_OK);
    }
    CHECK_SEED(
        report[0].touched_elements == report[1].touched_elements &&
            report[0].created_cells == report[1].created_cells && report[0].removed_cells == report[1].removed_cells &&
            report[0].created_copies == report[1].created_copies &&
            report[0].removed_copies == report[1].removed_copies && report[0].severed_links == report[1].severed_links,
        t->seed);
    CHECK_SEED(fabs(report[0].removed_volume - report[1].removed_volume) <= 1e-13, t->seed);
    CHECK_SEED(fabs(report[0].min_link_ratio - report[1].min_link_ratio) <= 1e-12, t->seed);
}

static void carve_twins(twins *t, const workload *w) {
    strokes s;
    strokes_tool tool;
    gx_surface surface;
    double at[3];
    int i;
    memset(&s, 0, sizeof s);
    s.random = random_bits();
    random_point(w, at);
    strokes_octahedron(&s, &tool, at, random_real(0.1, 0.5));
    surface = strokes_surface(&tool, GX_SURFACE_SOLID);
    for (i = 0; i < 2; i++) {
        const gx_view view = view_of(t->body[i]);
        settles = i == 0 ? t->mode : NEVER;
        if (view.cell_count > 0) ck_assert_int_eq(gx_body_carve(t->body[i], &surface, NULL, NULL), GX_OK);
    }
}

/* A pass of the blade, which may end within the body */
static void slice_twins(twins *t) {
    const int axis = random_below(3), frames = 1 + random_below(6), lifts = random_below(2);
    const double height = random_real(0, 1), slope = random_real(-0.3, 0.3);
    double edge[2][6];
    int frame, i, k;
    for (frame = -1; frame <= frames; frame++)
        for (i = 0; i < 2; i++) {
            for (k = 0; k < 2; k++) {
                edge[0][3 * k + axis] = k ? 5 : -4;
                edge[0][3 * k + (axis + 1) % 3] = -0.6 + 0.5 * (frame + 1);
                edge[0][3 * k + (axis + 2) % 3] = height + slope * k;
            }
            settles = i == 0 ? t->mode : NEVER;
            ck_assert_int_eq(gx_blade_move(t->blade[i], edge[0], 2, NULL, 0, NULL, NULL), GX_OK);
        }
    for (i = 0; i < 2 && lifts; i++) {
        settles = i == 0 ? t->mode : NEVER;
        ck_assert_int_eq(gx_blade_lift(t->blade[i], NULL, NULL), GX_OK);
    }
}

enum { ANCHORS = 40 };

static size_t make_anchors(const twins *t, gx_anchor *anchors) {
    size_t i, count = 0;
    for (i = 0; i < ANCHORS; i++) {
        const uint32_t element = (uint32_t)random_below((int)t->body[0]->mesh.element_count),
                       *node = gxb_complex_element_nodes(t->body[0]->complex, element);
        double weight[4], sum = 0, x[3] = {0, 0, 0};
        int n, k;
        for (n = 0; n < 4; n++) sum += weight[n] = random_below(4) ? random_real(0, 1) : 0.25 * random_below(4);
        for (n = 0; n < 4 && sum > 0; n++)
            for (k = 0; k < 3; k++) x[k] += weight[n] / sum * t->body[0]->mesh.positions[3 * node[n] + (uint32_t)k];
        if (sum > 0 && gx_body_anchor(t->body[0], element, x, &anchors[count], NULL) == GX_OK) count++;
    }
    return count;
}

static void expect_same_anchors(const twins *t, const gx_anchor *anchors, size_t count) {
    uint8_t lost[2][ANCHORS];
    size_t i;
    int k;
    for (k = 0; k < 2; k++) ck_assert_int_eq(gx_body_lost_anchors(t->body[k], anchors, count, lost[k], NULL), GX_OK);
    for (i = 0; i < count; i++) {
        double x[2][3];
        CHECK_SEED(lost[0][i] == lost[1][i], t->seed);
        if (lost[0][i]) continue;
        for (k = 0; k < 2; k++)
            ck_assert_int_eq(gx_body_anchor_point(t->body[k], &anchors[i], NULL, x[k], NULL), GX_OK);
        for (k = 0; k < 3; k++) CHECK_SEED(fabs(x[0][k] - x[1][k]) <= 1e-12, t->seed);
    }
}

/* Where elements meet in an edge or a node only */
static workload pinched_mesh(int node) {
    static const double x[8][3] = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                   {-1, 0, 0}, {0, -1, 0}, {0, -1, 1}, {-1, 0, 1}};
    workload w = wl_empty();
    int i;
    for (i = 0; i < 8; i++) wl_add_node(&w, x[i][0], x[i][1], x[i][2]);
    wl_add_element(&w, 0, 1, 2, 3);
    wl_add_element(&w, 0, 4, 5, node ? 6u : 3u);
    return w;
}

static workload twins_mesh(void) {
    switch (random_below(5)) {
    case 0: return pinched_mesh(random_below(2));
    case 1: return grid(2, 2, 2, 6);
    case 2: return grid(2, 1, 2, 5);
    default: return random_mesh();
    }
}

/* Random cuts, tools, blades: the body that settles every time beside the one that never does */
START_TEST(settled_bodies_are_the_same) {
    twins t;
    gx_anchor anchors[ANCHORS];
    gx_blade_desc desc;
    size_t count, k;
    int i, round;
    workload w;
    memset(&t, 0, sizeof t);
    memset(&desc, 0, sizeof desc);
    desc.starts_inside = 1;
    t.seed = (uint64_t)_i + 1;
    random_seed(t.seed);
    w = twins_mesh();
    for (i = 0; i < 2; i++) {
        t.body[i] = body_of(&w);
        ck_assert_int_eq(gx_blade_create(t.body[i], &desc, &t.blade[i], NULL), GX_OK);
    }
    count = make_anchors(&t, anchors);
    for (round = 0; round < 6; round++) {
        const int kind = random_below(8), moves = random_below(3) == 0;
        const double size = moves ? random_real(0, 0.05) : 0;
        if (view_of(t.body[1]).cell_count == 0) break;
        t.mode = random_below(3) ? ALWAYS : NEVER;
        for (i = 0; i < 2; i++) move_nodes(t.body[i], size);
        if (kind == 0)
            carve_twins(&t, &w);
        else if (kind == 1)
            slice_twins(&t);
        else {
            add_random_cut(&w, kind > 3);
            cut_twins(&t, &w, w.surface_count - 1);
        }
        expect_same_settled(t.body[0], t.body[1], t.seed);
        expect_same_anchors(&t, anchors, count);
        if (random_below(2)) expect_same_skins(t.body[0], t.body[1], t.seed);
        if (random_below(3) == 0) {
            gx_body *read = read_back(t.body[0]);
            CHECK_SEED(gx_body_state_hash(read) == gx_body_state_hash(t.body[0]), t.seed);
            gx_body_destroy(read);
        }
    }
    for (k = 0; k < 2; k++) gx_body_destroy(t.body[k]);
    wl_free(&w);
}
END_TEST

/* A clone, a body that was read, and one that was gone back to go on with the same bits. */
START_TEST(copies_go_on) {
    const uint64_t seed = (uint64_t)_i + 1;
    gx_body *body[4], *back = NULL;
    gx_step_desc step;
    workload w;
    int i, round;
    size_t k;
    settles = ALWAYS;
    random_seed(seed * 77);
    w = _i % 2 ? grid(2, 2, 2, 6) : twins_mesh();
    body[0] = body_of(&w);
    for (i = 0; i < 3; i++) {
        add_random_cut(&w, 1);
        cut_by(body[0], &w, w.surface_count - 1, 1);
    }
    move_nodes(body[0], 0.01);
    ck_assert_int_eq(gx_body_clone(body[0], &body[1], NULL), GX_OK);
    body[2] = read_back(body[0]);
    body[3] = body_of(&w);
    ck_assert_int_eq(gx_body_clone(body[0], &back, NULL), GX_OK);
    add_random_cut(&w, 1);
    cut_by(body[3], &w, w.surface_count - 1, 1);
    ck_assert_int_eq(gx_body_restore(body[3], back, NULL), GX_OK);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -9.81;
    for (round = 0; round < 3; round++) {
        add_random_cut(&w, 1);
        for (i = 0; i < 4; i++) {
            cut_by(body[i], &w, w.surface_count - 1, 1);
            if (view_of(body[i]).cell_count > 0) ck_assert_int_eq(gx_body_step(body[i], &step, NULL, NULL), GX_OK);
            CHECK_SEED(gx_body_state_hash(body[i]) == gx_body_state_hash(body[0]), seed);
        }
    }
    for (k = 0; k < 4; k++) gx_body_destroy(body[k]);
    gx_body_destroy(back);
    wl_free(&w);
}
END_TEST

/* ---- blades mid-stroke ---- */

enum { CONTACTS = 512, HITS = 16, FRAMES = 12 };

/* Bodies on which blades, tools and cuts act alike, while their pieces move */
typedef struct crew {
    gx_body *body[3]; /* the first settles at every cut, the second never; the third is made of the first mid-stroke */
    int count;
    uint64_t seed;
    /* places in space that were hit before the last cut */
    gx_hit hits[3][HITS];
    size_t still_there;
} crew;

static void act_as(int body) { settles = body == 1 ? NEVER : ALWAYS; }

/* Each fragment moves away from the middle, by the same bits in all bodies: by multiples of 2^-10. */
static void tear_apart(crew *c, double by) {
    int b, n, k;
    for (b = 0; b < c->count; b++) {
        const gx_view view = view_of(c->body[b]);
        size_t i;
        for (i = 0; i < view.cell_count; i++)
            for (n = 0; n < 4; n++)
                for (k = 0; k < 3; k++) {
                    const double away = by * (view.fragment_center[3 * (size_t)view.cell_fragment[i] + (size_t)k] - 1);
                    view.displacement[3 * (size_t)view.cell_copies[4 * i + (size_t)n] + (size_t)k] =
                        floor(1024 * away) / 1024;
                }
    }
}

/* The edge of the first blade is along y, that of the second along z. Both advance along x. */
static void move_blade(crew *c, size_t blade, double x, double height) {
    const int axis = blade == 0 ? 1 : 2;
    double edge[6];
    int b, k;
    for (k = 0; k < 2; k++) {
        edge[3 * k] = x + 0.1 * k;
        edge[3 * k + axis] = k ? 6 : -4;
        edge[3 * k + 3 - axis] = height + 0.2 * k;
    }
    for (b = 0; b < c->count; b++) {
        act_as(b);
        ck_assert_int_eq(gx_blade_move(gx_body_blade(c->body[b], blade), edge, 2, NULL, 0, NULL, NULL), GX_OK);
    }
}

/* Removes what a random surface encloses (kind 0), or an octahedron in material coordinates (1) or in space. */
static void remove_some(crew *c, workload *w, int kind) {
    const double at[3] = {random_real(0, 2), random_real(0, 2), random_real(0, 2)};
    strokes s;
    strokes_tool tool;
    gx_surface surface;
    int b;
    memset(&s, 0, sizeof s);
    s.random = random_bits();
    strokes_octahedron(&s, &tool, at, random_real(0.2, 0.7));
    surface = strokes_surface(&tool, GX_SURFACE_SOLID);
    if (kind == 0) add_random_cut(w, 1);
    for (b = 0; b < c->count; b++) {
        act_as(b);
        if (kind == 0)
            cut_by(c->body[b], w, w->surface_count - 1, 1);
        else if (kind == 1)
            ck_assert_int_eq(strokes_cut(c->body[b], &surface, NULL, 0, NULL), GX_OK);
        else
            ck_assert_int_eq(gx_body_carve(c->body[b], &surface, NULL, NULL), GX_OK);
    }
}

/* How many contacts a blade has, how long they are, where they are on the edge and in the material */
static void sum_contacts(gx_body *body, size_t blade, double sum[6]) {
    gx_blade_contact contacts[CONTACTS];
    const gx_view view = view_of(body);
    size_t count = 0, i;
    int k;
    ck_assert_int_eq(gx_blade_contacts(gx_body_blade(body, blade), contacts, CONTACTS, &count, NULL), GX_OK);
    memset(sum, 0, 6 * sizeof *sum);
    for (i = 0; i < count; i++) {
        const gx_hit *hit = &contacts[i].hit;
        double x[3];
        sum[0]++;
        sum[1] += contacts[i].length;
        sum[2] += contacts[i].along * contacts[i].length;
        for (k = 0; k < 3; k++) sum[3 + k] += hit->material[k] * contacts[i].length;
        ck_assert(hit->slot == view.cell_slot[hit->cell] && hit->element == view.cell_element[hit->cell]);
        ck_assert_int_eq(gx_body_place(body, hit->slot, hit->material, x, NULL), GX_OK);
        for (k = 0; k < 3; k++) ck_assert(fabs(x[k] - hit->position[k]) < 1e-9);
    }
}

static void hit_places(crew *c) {
    double at[3 * HITS];
    int b, i;
    for (i = 0; i < 3 * HITS; i++) at[i] = random_real(0, 2);
    for (b = 0; b < c->count; b++) ck_assert_int_eq(gx_body_locate(c->body[b], at, HITS, c->hits[b], NULL), GX_OK);
}

/* What has been hit is there or gone in all bodies alike. */
static void expect_same_hits(crew *c) {
    int b, i, k;
    for (i = 0; i < HITS; i++) {
        gx_anchor anchor;
        double x[3][3];
        const gx_result result = gx_hit_anchor(c->body[1], &c->hits[1][i], &anchor, NULL);
        c->still_there += result == GX_OK;
        for (b = 0; b < c->count; b += 2) {
            CHECK_SEED(gx_hit_anchor(c->body[b], &c->hits[b][i], &anchor, NULL) == result, c->seed);
            if (result == GX_OK) ck_assert_int_eq(gx_body_anchor_point(c->body[b], &anchor, NULL, x[b], NULL), GX_OK);
        }
        for (k = 0; k < 3 && result == GX_OK && c->count == 3; k++)
            CHECK_SEED(!(x[2][k] < x[0][k]) && !(x[2][k] > x[0][k]), c->seed);
    }
}

static void expect_same_crew(crew *c) {
    double sum[3][6];
    size_t blade;
    int b, k;
    expect_same_settled(c->body[0], c->body[1], c->seed);
    if (c->count == 3) {
        (void)view_of(c->body[2]); /* as of the others: it gives fragments their ids */
        CHECK_SEED(gx_body_state_hash(c->body[2]) == gx_body_state_hash(c->body[0]), c->seed);
    }
    for (blade = 0; blade < 2; blade++) {
        for (b = 0; b < c->count; b++) sum_contacts(c->body[b], blade, sum[b]);
        for (k = 0; k < 6; k++) {
            CHECK_SEED(fabs(sum[1][k] - sum[0][k]) < 1e-9, c->seed);
            if (c->count == 3) CHECK_SEED(!(sum[2][k] < sum[0][k]) && !(sum[2][k] > sum[0][k]), c->seed);
        }
    }
}

/* Two blades go through bodies whose pieces move apart, while tools take material at their fronts. Each cut moves the
   rows of cells, leaves and points that blades, hits and contacts are about. Copies that are made mid-stroke go on. */
START_TEST(blades_go_on) {
    crew c;
    workload w;
    int b, frame;
    memset(&c, 0, sizeof c);
    c.seed = (uint64_t)_i + 1;
    c.count = 2;
    random_seed(c.seed * 1009);
    w = grid(2, 2, 2, _i % 2 ? 6 : 5);
    for (b = 0; b < 2; b++) {
        gx_blade *blade;
        c.body[b] = body_of(&w);
        ck_assert_int_eq(gx_blade_create(c.body[b], NULL, &blade, NULL), GX_OK);
        ck_assert_int_eq(gx_blade_create(c.body[b], NULL, &blade, NULL), GX_OK);
    }
    for (frame = 0; frame < FRAMES; frame++) {
        hit_places(&c);
        move_blade(&c, 0, -0.3 + 0.22 * frame, 0.93);
        if (frame > 2) move_blade(&c, 1, -1 + 0.22 * frame, 0.87);
        if (frame == 1 || random_below(2)) remove_some(&c, &w, frame == 1 ? 1 : random_below(3));
        expect_same_hits(&c);
        if (view_of(c.body[1]).cell_count == 0) break;
        if (random_below(2)) tear_apart(&c, random_real(0, 0.15));
        if (frame == 4) {
            if (_i % 3)
                c.body[2] = read_back(c.body[0]);
            else
                ck_assert_int_eq(gx_body_clone(c.body[0], &c.body[2], NULL), GX_OK);
            c.count = 3;
        }
        expect_same_crew(&c);
        gx_body_destroy(read_back(c.body[0]));
    }
    CHECK_SEED(c.body[0]->leaves.count <= c.body[1]->leaves.count, c.seed);
    CHECK_SEED(c.still_there > 0, c.seed);
    for (b = 0; b < c.count; b++) gx_body_destroy(c.body[b]);
    wl_free(&w);
}
END_TEST

/* ---- memory ---- */

static gx_body *worn_body(memory *m, strokes *s, uint32_t count) {
    const gx_allocator a = allocator_of(m);
    gx_body *body = NULL;
    gx_skin skin;
    uint32_t i;
    memset(s, 0, sizeof *s);
    s->side = 2;
    s->total = 20;
    never_fail(m);
    ck_assert_int_eq(strokes_body(s->side, &a, NULL, &body), GX_OK);
    for (i = 0; i < count; i++) {
        ck_assert_int_eq(strokes_apply(s, body, i, NULL), GX_OK);
        ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    }
    return body;
}

/* Memory may run out wherever a cut asks for it, also for the compaction. Then the cut fails and nothing has changed;
   or it succeeds, and the body is what it should be. */
START_TEST(memory_runs_out) {
    memory m = plenty();
    strokes s;
    gx_body *body;
    gx_skin skin;
    uint64_t now, then;
    size_t n, failures = 0;
    uint32_t leaves;
    settles = ALWAYS;
    body = worn_body(&m, &s, 7);
    now = hash_of(body);
    leaves = body->leaves.count;
    ck_assert_int_eq(strokes_apply(&s, body, 7, NULL), GX_OK);
    then = hash_of(body);
    gx_body_destroy(body);
    ck_assert(is_whole(&m));
    for (n = 0;; n++) {
        uint64_t state;
        gx_result result;
        body = worn_body(&m, &s, 6);
        state = gx_body_state_hash(body);
        fail_from(&m, n, _i);
        result = strokes_apply(&s, body, 6, NULL);
        if (!m.failed) break;
        never_fail(&m);
        if (result != GX_OK) {
            failures++;
            ck_assert_int_eq(result, GX_ERROR_MEMORY);
            ck_assert(gx_body_state_hash(body) == state);
            ck_assert_int_eq(strokes_apply(&s, body, 6, NULL), GX_OK);
        }
        ck_assert_uint_eq(body->leaves.count, leaves);
        ck_assert(hash_of(body) == now);
        ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
        ck_assert_int_eq(strokes_apply(&s, body, 7, NULL), GX_OK);
        ck_assert(hash_of(body) == then);
        ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
        gx_body_destroy(body);
        ck_assert(is_whole(&m));
    }
    gx_body_destroy(body);
    ck_assert(is_whole(&m));
    ck_assert_uint_ge(failures, 5);
}
END_TEST

static size_t kept_leaves(const gx_body *body) {
    size_t count = 0;
    uint32_t i;
    for (i = 0; i < body->leaves.count; i++) count += !gxb_complex_leaf(body->complex, i)->removed;
    return count;
}

/* Hundreds of strokes: a body holds no more than twice what one does that is cut to the same shape at once, and each
   stroke goes through as few leaves. */
START_TEST(strokes_wear_nothing_out) {
    memory m = plenty(), other = plenty();
    const gx_allocator a = allocator_of(&m), b = allocator_of(&other);
    strokes s;
    gx_body *body = NULL, *fresh = NULL;
    size_t bytes = 0, most = 0, least;
    uint32_t i;
    memset(&s, 0, sizeof s);
    settles = IN_USE;
    s.kind = _i;
    s.side = 4;
    s.total = (_i == STROKES_CARVE ? 100 : 300) / (FEWER > 1 ? 2 : 1);
    ck_assert_int_eq(strokes_body(s.side, &a, NULL, &body), GX_OK);
    for (i = 0; i < s.total; i++) {
        ck_assert_int_eq(strokes_apply(&s, body, i, NULL), GX_OK);
        bytes = bytes_alive(&m);
        if (bytes > most) most = bytes;
    }
    if (_i != STROKES_CARVE) { /* which refines its tools */
        ck_assert_int_eq(strokes_body(s.side, &b, NULL, &fresh), GX_OK);
        ck_assert_int_eq(strokes_cut_fresh(&s, fresh), GX_OK);
        ck_assert(hash_of(body) == hash_of(fresh));
        least = bytes_alive(&other);
        ck_assert_msg(bytes <= 2 * least, "%zu bytes, freshly cut %zu", bytes, least);
        ck_assert_msg(most <= 3 * least, "at most %zu bytes, freshly cut %zu", most, least);
        ck_assert_uint_le(kept_leaves(body), 2 * kept_leaves(fresh));
        gx_body_destroy(fresh);
        ck_assert(is_whole(&other));
    }
    gx_body_destroy(read_back(body));
    gx_body_destroy(body);
    ck_assert(is_whole(&m));
}
END_TEST

/* ---- names, maps ---- */

/* Names of points come to their end: they begin anew, and the skin is made anew. */
START_TEST(names_begin_anew) {
    strokes s;
    gx_body *body = NULL;
    double area[2][SURFACES];
    skin_counts n[2];
    gx_skin skin[2];
    uint32_t i, most = 0;
    memset(&s, 0, sizeof s);
    s.side = 2;
    s.total = 20;
    settles = ALWAYS;
    ck_assert_int_eq(strokes_body(s.side, NULL, NULL, &body), GX_OK);
    for (i = 0; i < 5; i++) ck_assert_int_eq(strokes_apply(&s, body, i, NULL), GX_OK);
    n[0] = measure_skin(body, area[0], &skin[0]);
    body->complex->store.next_name = (uint32_t)INT32_MAX + 1;
    ck_assert_int_eq(strokes_apply(&s, body, 4, NULL), GX_OK); /* nothing is left there */
    ck_assert_uint_lt(body->complex->store.next_name, 100000);
    n[1] = measure_skin(body, area[1], &skin[1]);
    for (i = 0; i < skin[1].vertex_count; i++)
        if (skin[1].vertex_point[i] > most) most = skin[1].vertex_point[i];
    ck_assert_uint_lt(most, body->complex->store.point_count);
    ck_assert(fabs(n[1].volume - n[0].volume) < 1e-13 && n[0].open_edges == 0 && n[1].open_edges == 0);
    gx_body_destroy(body);
}
END_TEST

/* Texture maps of surfaces that are cut away go, others stay what they are. */
START_TEST(maps_go_with_their_surfaces) {
    twins t;
    strokes s;
    float texture[16];
    gx_skin skin[2];
    double sum[2] = {0, 0};
    uint32_t i;
    int b;
    memset(&t, 0, sizeof t);
    memset(&s, 0, sizeof s);
    s.side = 2;
    s.total = 40;
    for (b = 0; b < 2; b++) ck_assert_int_eq(strokes_body(s.side, NULL, NULL, &t.body[b]), GX_OK);
    for (i = 0; i < 40; i++) {
        strokes_tool tool;
        gx_surface surface;
        int k;
        strokes_make(&s, i, &tool);
        for (k = 0; k < 16; k++) texture[k] = (float)(0.1 * k + i);
        surface = strokes_surface(&tool, GX_SURFACE_SOLID);
        if (i % 3) surface.texture = texture;
        for (b = 0; b < 2; b++) {
            settles = b == 0 ? ALWAYS : NEVER;
            ck_assert_int_eq(strokes_cut(t.body[b], &surface, NULL, 0, NULL), GX_OK);
        }
    }
    for (b = 0; b < 2; b++) {
        size_t v, c;
        ck_assert_int_eq(gx_body_skin(t.body[b], NULL, &skin[b], NULL), GX_OK);
        for (v = 0; v < skin[b].triangle_count; v++) { /* area x texture does not depend on the triangulation */
            const uint32_t *n = skin[b].triangles + 3 * v;
            for (c = 0; c < 3; c++)
                sum[b] += rest_area(&skin[b], n) *
                          ((double)skin[b].vertex_texture[2 * n[c]] + 3 * (double)skin[b].vertex_texture[2 * n[c] + 1]);
        }
    }
    ck_assert_msg(fabs(sum[0] - sum[1]) <= 1e-4 * fabs(sum[1]), "%g, %g", sum[0], sum[1]);
    ck_assert_uint_lt(t.body[0]->cuts.map_count, t.body[1]->cuts.map_count);
    ck_assert_uint_gt(t.body[0]->cuts.map_count, 0);
    gx_body_destroy(read_back(t.body[0]));
    for (b = 0; b < 2; b++) gx_body_destroy(t.body[b]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("settle");
    TCase *tests = tcase_create("settle"), *blades = tcase_create("blades");
    tcase_set_timeout(tests, 240);
    tcase_set_timeout(blades, 240);
    tcase_add_loop_test(tests, settled_bodies_are_the_same, 0, 200 / FEWER);
    tcase_add_loop_test(tests, copies_go_on, 0, 20 / FEWER);
    tcase_add_loop_test(tests, memory_runs_out, 0, 2);
    tcase_add_loop_test(tests, strokes_wear_nothing_out, 0, STROKES_KINDS);
    tcase_add_test(tests, names_begin_anew);
    tcase_add_test(tests, maps_go_with_their_surfaces);
    tcase_add_loop_test(blades, blades_go_on, 0, 40 / FEWER);
    suite_add_tcase(suite, tests);
    suite_add_tcase(suite, blades);
    return run_suite(suite);
}
