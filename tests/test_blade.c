/* test_blade.c - blades: edges in space that are moved through bodies which move meanwhile. Scenes, given motions and
   known sheets are those of bench/blade.h. What must come of a pass: the fragments that a cut by the swept sheet gives,
   the volume of before, no link across the cut.

   Random tests print their seed; GXFEM_SEED=n runs seed n alone. GXFEM_PASSES=n runs n random passes in place of 200;
   CK_RUN_CASE=passes runs those alone. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "body.h"
#include "../bench/blade.h"
#include "../examples/gxshape.h"

enum { PASSES = 200 / FEWER, PASSES_AT_ONCE = 20 };

static void check_stage(const stage *s, uint64_t seed) {
    ck_assert_msg(stage_ok(s), "seed %llu: %s, field %s, index %zu", (unsigned long long)seed,
                  gx_result_text(s->failure.result), s->failure.field ? s->failure.field : "none", s->failure.index);
    ck_assert_msg(s->tally.volume <= 1e-12, "seed %llu: the volume is off by %g", (unsigned long long)seed,
                  s->tally.volume);
    ck_assert_msg(s->tally.link > 0, "seed %llu: a link has no area", (unsigned long long)seed);
}

static void check_fragments(const stage *s, size_t expected, uint64_t seed) {
    double least = HUGE_VAL;
    size_t i;
    check_stage(s, seed);
    for (i = 0; i < s->view.fragment_count; i++) least = fmin(least, s->view.fragment_volume[i]);
    ck_assert_msg(s->view.fragment_count == expected, "seed %llu: %zu fragments in place of %zu; the smallest of %g m3",
                  (unsigned long long)seed, s->view.fragment_count, expected, least);
}

static stage block_of(uint32_t n, uint64_t seed) {
    stage s;
    memset(&s, 0, sizeof s);
    s.cells[0] = s.cells[1] = s.cells[2] = n;
    s.random = seed * 7919;
    return s;
}

static stage open_block(uint32_t n, uint64_t seed) {
    stage s = block_of(n, seed);
    stage_open(&s, 1e3, 0, NULL);
    return s;
}

/* Are the fragments of two bodies of the same volumes? */
static double volume_difference(const gx_view *a, const gx_view *b) {
    double most = 0;
    size_t i, j;
    if (a->fragment_count != b->fragment_count) return HUGE_VAL;
    for (i = 0; i < a->fragment_count; i++) {
        double best = HUGE_VAL;
        for (j = 0; j < b->fragment_count; j++) best = fmin(best, fabs(a->fragment_volume[i] - b->fragment_volume[j]));
        most = fmax(most, best);
    }
    return most;
}

/* ---- scenes ---- */

/* Cubes along an edge, by scene of bench/blade.h */
static const uint32_t scene_sizes[STAGE_SCENES] = {6, 6, 8, 6, 6, 8, 6, 6, 6, 6, 6, 6, 6};

START_TEST(scenes) {
    const stage_scene *scene = &stage_scenes[_i];
    stage s;
    size_t i;
    memset(&s, 0, sizeof s);
    s.random = 1;
    stage_play(&s, scene, scene_sizes[_i], NULL);
    check_fragments(&s, scene->fragments, (uint64_t)_i);
    ck_assert_uint_gt(s.tally.triangles, 0);
    for (i = 0; i < s.view.fragment_count; i++) ck_assert(s.view.fragment_volume[i] > 0.5); /* none is a speck */
    if (strcmp(scene->name, "arms") == 0 || strcmp(scene->name, "over") == 0 || strcmp(scene->name, "slit") == 0)
        ck_assert_msg(s.overlap > 1, "pieces are %g cubes in each other", s.overlap);
    stage_close(&s);
}
END_TEST

/* Other sizes of scenes that once left bridges or specks */
static const struct {
    const char *name;
    uint32_t cells;
} scenes_of_other_sizes[] = {{"retreat", 8}, {"retreat", 4}, {"slow", 4}, {"slow", 7}, {"arms", 6},
                             {"slit", 5},    {"side", 8},    {"held", 6}, {"side", 4}, {"side", 5},
                             {"sawing", 8},  {"held", 7},    {"held", 9}, {"held", 10}};
enum { OTHER_SIZES = sizeof scenes_of_other_sizes / sizeof *scenes_of_other_sizes };

START_TEST(other_sizes) {
    size_t k;
    int i;
    for (i = 0; i < STAGE_SCENES; i++) {
        stage s;
        if (strcmp(stage_scenes[i].name, scenes_of_other_sizes[_i].name) != 0) continue;
        memset(&s, 0, sizeof s);
        s.random = 1;
        stage_play(&s, &stage_scenes[i], scenes_of_other_sizes[_i].cells, NULL);
        check_fragments(&s, stage_scenes[i].fragments, scenes_of_other_sizes[_i].cells);
        for (k = 0; k < s.view.fragment_count; k++) ck_assert(s.view.fragment_volume[k] > 0.5);
        stage_close(&s);
    }
}
END_TEST

/* The same as `held`, with the edge given from its other end */
static void hold_reversed(stage *s) {
    const double n = s->cells[0];
    int k;
    for (k = 0; k < 600 && s->view.fragment_count < 2; k++) {
        const double x = n + 0.8 - (k > 100 ? (k - 100) * 0.05 : 0);
        stage_step(s, 2 * s->swing * sin(0.05 * k), 0, -9.8);
        stage_move(s, x, n + STAGE_FAR, 0.3 * n + 0.5, x, -STAGE_FAR, 0.3 * n);
    }
}

START_TEST(held_from_the_other_end) {
    const stage_scene scene = {"held", hold_reversed, 2, 6};
    stage s;
    memset(&s, 0, sizeof s);
    stage_play(&s, &scene, 10, NULL);
    check_fragments(&s, 2, 10);
    stage_close(&s);
}
END_TEST

/* ---- at rest ---- */

typedef struct plane_pass {
    double point[3], along[3], way[3];
} plane_pass;

/* Moves a straight edge through a body at rest in the plane through `point`. */
static void pass_at_rest(gx_body *body, const plane_pass *p, double reach, int frames) {
    gx_blade *blade = NULL;
    gx_blade_report report;
    int i, k;
    ck_assert_int_eq(gx_blade_create(body, NULL, &blade, NULL), GX_OK);
    for (i = 0; i <= frames; i++) {
        const double t = reach * (2.0 * i / frames - 1);
        double edge[6];
        for (k = 0; k < 6; k++)
            edge[k] = p->point[k % 3] + t * p->way[k % 3] + (k < 3 ? -reach : reach) * p->along[k % 3];
        ck_assert_int_eq(gx_blade_move(blade, edge, 2, NULL, 0, &report, NULL), GX_OK);
        ck_assert(report.cut.min_link_ratio > 0);
    }
    ck_assert_int_eq(gx_blade_lift(blade, &report, NULL), GX_OK);
    gx_blade_destroy(blade);
}

static void check_at_rest(workload *w, const plane_pass *p, double reach, int frames, double tolerance) {
    gx_body *passed = body_of(w), *cut = body_of(w);
    double n[3];
    gx_view a, b;
    int k;
    for (k = 0; k < 3; k++)
        n[k] = p->along[(k + 1) % 3] * p->way[(k + 2) % 3] - p->along[(k + 2) % 3] * p->way[(k + 1) % 3];
    add_plane(w, p->point, n, reach);
    cut_by(cut, w, w->surface_count - 1, 1);
    pass_at_rest(passed, p, reach, frames);
    a = view_of(passed);
    b = view_of(cut);
    ck_assert_msg(volume_difference(&a, &b) <= tolerance * b.volume, "%zu fragments, %zu by the sheet, %g apart",
                  a.fragment_count, b.fragment_count, volume_difference(&a, &b));
    ck_assert(fabs(a.volume - b.volume) <= 1e-12 * b.volume);
    gx_body_destroy(passed);
    gx_body_destroy(cut);
}

/* In planes of nodes, along mesh edges, through nodes: exactly the sheet's pieces */
static const plane_pass rest_passes[] = {
    {{2, 2, 2}, {1, 0, 0}, {0, 1, 0}},   /* in a plane of nodes, along mesh edges */
    {{2, 2, 2}, {1, 1, 0}, {-1, 1, 0}},  /* ... along diagonals */
    {{2, 2, 2}, {0, 0, 1}, {1, 0, 0}},   /* ... another one */
    {{2, 2, 2}, {0, 0, 1}, {1, 1, 0}},   /* in a plane of diagonals */
    {{2, 2, 2}, {1, 1, 0}, {0, 0, 1}},   /* ... along diagonals */
    {{2, 2, 2}, {1, 0, 0}, {0, 1, 0.5}}, /* along mesh edges, through nodes */
    {{2, 2, 2.25}, {1, 0, 0}, {0, 1, 0}},
    /* up to the tolerance on the cut's area: fronts are thinned, and places in the air are brought nearer */
    {{2, 2, 2}, {1, 0.5, 0.25}, {0, 1, -0.5}},
    {{2.1, 1.7, 2.3}, {1, 0.3, 0.2}, {-0.2, 1, 0.3}},
};
enum { REST_PASSES = sizeof rest_passes / sizeof *rest_passes };

START_TEST(path_and_sheet) {
    static const int frames[4] = {1, 3, 16, 64};
    const double tolerance = _i + 2 < REST_PASSES ? 1e-12 : 0.01 * 16 / 64;
    workload six = grid(4, 4, 4, 6), five = grid(4, 4, 4, 5);
    int i;
    for (i = 0; i < 4; i++) {
        check_at_rest(&six, &rest_passes[_i], 8, frames[i], tolerance);
        check_at_rest(&five, &rest_passes[_i], 8, frames[i], tolerance);
    }
    wl_free(&six);
    wl_free(&five);
}
END_TEST

/* A mesh that is no lattice: nodes moved at random */
START_TEST(other_meshes) {
    static const plane_pass jittered = {{2.1, 1.7, 2.3}, {1, 0.3, 0.2}, {-0.2, 1, 0.3}};
    workload w = grid(4, 4, 4, _i == 0 ? 5 : 6);
    size_t i;
    random_seed((uint64_t)_i + 1);
    for (i = 0; i < 3 * w.node_count; i++) w.positions[i] += random_real(-0.15, 0.15);
    check_at_rest(&w, &jittered, 8, 30, 1e-3);
    wl_free(&w);
}
END_TEST

/* An octopus, whose arms are layers of their own until the edge comes to the head */
START_TEST(octopus) {
    static const double heights[4] = {-0.05, 0.08, 0.1, 0};
    plane_pass arms = {{0.01, -0.01, 0}, {1, 0.1, 0.05}, {-0.1, 1, 0}};
    workload w = wl_empty();
    gxshape_field field;
    gxshape_mesh mesh;
    memset(&field, 0, sizeof field);
    gxshape_octopus(&field);
    ck_assert_ptr_null(gxshape_fill(&field, 0.04, &mesh));
    w.positions = mesh.positions;
    w.node_count = mesh.node_count;
    w.elements = mesh.elements;
    w.element_count = mesh.element_count;
    arms.point[2] = heights[_i];
    check_at_rest(&w, &arms, 1, 30, 2e-3);
    check_at_rest(&w, &arms, 1, 60, 2e-3);
    wl_free(&w);
}
END_TEST

/* ---- relativity ---- */

/* The same pieces in both, and with 1, 2, 5 and 20 times as many frames, up to the blade's tolerance on the cut's
   area */
START_TEST(relativity) {
    static const int factors[4] = {1, 2, 5, 20};
    const uint32_t n = 5;
    stage first = open_block(n, 1);
    int i, body_moves;
    stage_pass_rigidly(&first, 0, 20);
    check_fragments(&first, 2, 0);
    for (i = 0; i < 4; i++)
        for (body_moves = 0; body_moves < 2; body_moves++) {
            stage s = open_block(n, 1);
            double off;
            stage_pass_rigidly(&s, body_moves, 20 * factors[i]);
            check_fragments(&s, 2, (uint64_t)factors[i]);
            off = volume_difference(&first.view, &s.view);
            /* 20 frames know less of the path than 400 */
            ck_assert_msg(off <= 0.02 * 2 * n * n, "%d frames, the %s moves: %g m3 apart", 20 * factors[i],
                          body_moves ? "body" : "blade", off);
            stage_close(&s);
        }
    stage_close(&first);
}
END_TEST

/* ---- known sheets ---- */

/* The edge follows a sheet of the material: two pieces, the sheet's own, and walls near it. Limits are loose; the bench
   has figures. */
START_TEST(known_sheets) {
    const uint64_t seed = (uint64_t)_i + 1;
    const int kind = _i % 3;
    const uint32_t n = 5;
    stage s = open_block(n, seed), cut = open_block(n, seed);
    const stage_sheet sheet = stage_random_sheet(&s);
    const stage_motion motion = stage_random_motion(&s, kind);
    double error, square;
    stage_follow_sheet(&s, &sheet, &motion, 40);
    check_fragments(&s, 2, seed);
    error = stage_wall_error(&s, &sheet, &square);
    check_stage(&s, seed);
    ck_assert_msg(error > 0 && error <= (kind == STAGE_CALM ? 0.04 : 0.08), "seed %d: walls are %g cubes off", _i + 1,
                  error);
    stage_cut_sheet(&cut, &sheet, 24);
    check_fragments(&cut, 2, seed);
    CHECK_SEED(volume_difference(&s.view, &cut.view) <= 0.01 * 2 * n * n, seed);
    stage_close(&s);
    stage_close(&cut);
}
END_TEST

/* With more frames the walls come no farther off, and the pieces stay. */
START_TEST(more_frames) {
    static const int factors[4] = {1, 2, 5, 20};
    const uint64_t seed = (uint64_t)_i + 1;
    int i;
    for (i = 0; i < 4; i++) {
        stage s = open_block(4, seed);
        const stage_sheet sheet = stage_random_sheet(&s);
        const stage_motion motion = stage_random_motion(&s, STAGE_CALM);
        double square;
        stage_follow_sheet(&s, &sheet, &motion, 20 * factors[i]);
        check_fragments(&s, 2, seed);
        CHECK_SEED(stage_wall_error(&s, &sheet, &square) <= 0.04, seed);
        stage_close(&s);
    }
}
END_TEST

/* ---- random passes ---- */

static void random_pass(stage *s, uint64_t seed, double noise, double squeeze) {
    stage_motion motion;
    *s = block_of(4, seed);
    s->noise = noise;
    stage_open(s, 1e3, 0, NULL);
    motion = stage_random_motion(s, STAGE_CALM);
    motion.squeeze[seed % 3] = squeeze;
    stage_random_pass(s, &motion, 40);
}

/* Straight edges through blocks that move, with noise of 0.02 cubes a node and frame: two pieces each */
START_TEST(passes) {
    const char *more = getenv("GXFEM_PASSES"), *only = getenv("GXFEM_SEED");
    const int count = (more ? atoi(more) : PASSES) / PASSES_AT_ONCE;
    const int first = only ? atoi(only) : 1 + _i * count, end = only ? first + (_i == 0) : first + count;
    int seed;
    for (seed = first; seed < end; seed++) {
        stage s;
        random_pass(&s, (uint64_t)seed, 0.02, 1);
        check_fragments(&s, 2, (uint64_t)seed);
        stage_close(&s);
    }
}
END_TEST

/* A block that swings as fast as the edge: this leaves its cut through the side, comes back to it and goes on at its
   rim. Pieces may be cut out on the way, but the block never hangs together, and the cut is where the edge was. */
START_TEST(swinging_passes) {
    const int first = 71 + 8 * _i;
    int seed;
    for (seed = first; seed < first + 8; seed++) {
        stage s = block_of(4, (uint64_t)seed);
        stage_motion motion;
        s.noise = 0.02;
        stage_open(&s, 1e3, 0, NULL);
        motion = stage_random_motion(&s, STAGE_SWINGING);
        stage_random_pass(&s, &motion, 40);
        check_stage(&s, (uint64_t)seed);
        CHECK_SEED(s.view.fragment_count >= 2, (uint64_t)seed);
        CHECK_SEED(s.tally.deviation <= 0.01, (uint64_t)seed);
        stage_close(&s);
    }
}
END_TEST

/* The volume of all fragments but the two largest */
static double specks(const gx_view *view) {
    double first = 0, second = 0, sum = 0;
    size_t i;
    for (i = 0; i < view->fragment_count; i++) {
        const double v = view->fragment_volume[i];
        sum += v;
        if (v > first)
            second = first, first = v;
        else if (v > second)
            second = v;
    }
    return sum - first - second;
}

/* The volume of the second largest piece, 0: there is none */
static double second_volume(const gx_view *v) {
    double first = 0, second = 0;
    size_t i;
    for (i = 0; i < v->fragment_count; i++) {
        second = fmax(second, fmin(first, v->fragment_volume[i]));
        first = fmax(first, v->fragment_volume[i]);
    }
    return second;
}

/* Much noise, without and with elements that it turns inside out: two pieces, and next to nothing beside them */
START_TEST(noise) {
    static const uint64_t once_bridged[] = {48, 107, 123, 161};
    const int inverted = _i, count = 30 + 4 * inverted;
    size_t seen = 0;
    int i;
    for (i = 0; i < count; i++) {
        const uint64_t seed = i < 30 ? (uint64_t)i + 1 : once_bridged[i - 30];
        stage s;
        random_pass(&s, seed, 0.1, inverted ? 0.2 : 1);
        check_stage(&s, seed);
        seen += s.tally.inverted;
        ck_assert_msg(second_volume(&s.view) > 1, "seed %d: one piece is left", (int)seed);
        ck_assert_msg(specks(&s.view) <= (inverted ? 1 : 1e-3) / 6, "seed %d: %zu fragments, %g m3 beside two",
                      (int)seed, s.view.fragment_count, specks(&s.view));
        stage_close(&s);
    }
    ck_assert_int_eq(seen > 0, inverted);
}
END_TEST

/* ---- strokes ---- */

/* An edge across x at a place y and height z of a block */
static void move_at(stage *s, double y, double z) {
    const double middle = 0.5 * s->cells[0];
    stage_move(s, middle - STAGE_FAR, y, z, middle + STAGE_FAR, y + 0.4, z + 0.3);
}

static void move_between(stage *s, double from, double to, double z) {
    const int frames = (int)(fabs(to - from) / 0.3) + 1;
    int k;
    for (k = 0; k <= frames; k++) move_at(s, from + (to - from) * k / frames, z);
}

static stage open_for_stab(uint32_t n) {
    stage s = block_of(n, 1);
    gx_blade_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.starts_inside = 1;
    stage_open(&s, 1e3, 0, &desc);
    return s;
}

/* The same exactly in a plane of the material */
static void move_in_plane(stage *s, double from, double to) {
    int k;
    for (k = 0; k <= 10; k++) {
        const double y = from + (to - from) * k / 10, edge[6] = {-9, y, 2.25, 15, y, 2.25};
        stage_move_edge(s, edge, 2);
    }
    stage_lift(s);
}

/* A stab into the middle and out on one side; another one, a little before it, out on the other side */
START_TEST(stab) {
    stage s = open_for_stab(5);
    move_in_plane(&s, 2.5, -2);
    check_fragments(&s, 1, 0);
    ck_assert_uint_gt(s.tally.divided, 20);
    move_in_plane(&s, _i == 0 ? 2.5 : 2.25, 7);
    check_fragments(&s, 2, 0);
    stage_close(&s);
}
END_TEST

/* The blade is lifted in the middle; it begins anew where it was, or a little behind. */
START_TEST(lift_in_the_middle) {
    stage s = open_for_stab(5);
    move_in_plane(&s, -2, 2.75);
    check_fragments(&s, 1, 0);
    move_in_plane(&s, _i == 0 ? 2.75 : 2.5, 7);
    check_fragments(&s, 2, 0);
    stage_close(&s);
}
END_TEST

/* A stroke that ends in the block, and another one from outside along the same path: the second goes through the cut of
   the first. */
START_TEST(second_stroke) {
    stage s = open_block(5, 1);
    move_between(&s, -2, 2.6, 2.2);
    stage_lift(&s);
    move_between(&s, -2, 7, 2.2);
    stage_lift(&s);
    check_stage(&s, 0);
    ck_assert_uint_ge(s.view.fragment_count, 2);
    ck_assert(specks(&s.view) <= 1e-2);
    stage_close(&s);
}
END_TEST

/* Five strokes of one blade: six slices */
START_TEST(several_strokes) {
    stage s = open_block(5, 1);
    int i;
    for (i = 0; i < 5; i++) {
        if (i % 2 == 0)
            move_between(&s, -2, 7, 0.4 + 0.83 * i);
        else
            move_between(&s, 7, -2, 0.4 + 0.83 * i);
        stage_lift(&s);
        check_fragments(&s, (size_t)i + 2, (uint64_t)i);
    }
    stage_close(&s);
}
END_TEST

/* What waits is cut when the blade is lifted; a second lift does nothing. */
START_TEST(lift_cuts_what_waits) {
    gx_blade_desc desc;
    gx_blade_report report;
    stage s = block_of(3, 1);
    uint64_t state;
    memset(&desc, 0, sizeof desc);
    desc.min_advance = 100;
    stage_open(&s, 1e3, 0, &desc);
    move_at(&s, -1, 1.3);
    move_at(&s, 3.4, 1.3);
    check_fragments(&s, 1, 0);
    ck_assert_uint_eq(s.tally.triangles, 0);
    stage_lift(&s);
    check_fragments(&s, 2, 0);
    state = gx_body_state_hash(s.body);
    memset(&report, 1, sizeof report);
    ck_assert_int_eq(gx_blade_lift(s.blade, &report, &s.failure), GX_OK);
    ck_assert(report.triangle_count == 0 && report.layer_count == 0 && report.cut.touched_elements == 0);
    ck_assert(report.deviation == 0 && report.cut.min_link_ratio == 1);
    ck_assert(gx_body_state_hash(s.body) == state);
    stage_close(&s);
}
END_TEST

/* A corner of less than a thousandth of an element comes off by a surface, and stays with a blade. */
START_TEST(specks_stay) {
    const double off = _i == 0 ? 0.05 : 0.3; /* cubes: of the corner */
    stage s = open_block(2, 1), cut = open_block(2, 1);
    const double v[9] = {off, 0, 0, 0, off, 0, 0, 0, off}, middle[3] = {off / 3, off / 3, off / 3};
    double corners[9];
    static const uint32_t triangle[3] = {0, 1, 2};
    gx_surface sheet;
    gx_cut_desc desc;
    int i, k;
    for (i = 0; i < 9; i++) corners[i] = middle[i % 3] + 20 * (v[i] - middle[i % 3]);
    memset(&sheet, 0, sizeof sheet);
    memset(&desc, 0, sizeof desc);
    sheet.vertices = corners;
    sheet.vertex_count = 3;
    sheet.triangles = triangle;
    sheet.triangle_count = 1;
    desc.surfaces = &sheet;
    desc.surface_count = 1;
    ck_assert_int_eq(gx_body_cut(cut.body, &desc, NULL, NULL), GX_OK);
    stage_look(&cut);
    ck_assert_uint_eq(cut.view.fragment_count, 2);
    for (k = 0; k <= 40; k++) { /* the edge goes along the plane, parallel to a side of the triangle */
        const double share = 4.0 * k / 40 - 2;
        double edge[6];
        for (i = 0; i < 6; i++)
            edge[i] = middle[i % 3] + share * (v[6 + i % 3] - middle[i % 3]) / off +
                      (i < 3 ? -3 : 3) * (v[3 + i % 3] - v[i % 3]) / off;
        stage_move_edge(&s, edge, 2);
    }
    stage_lift(&s);
    check_stage(&s, (uint64_t)_i);
    ck_assert_uint_eq(s.view.fragment_count, _i == 0 ? 1 : 2);
    stage_close(&s);
    stage_close(&cut);
}
END_TEST

/* ---- scopes, other blades, other cuts ---- */

/* A vertical plane makes two pieces, of which the blade cuts one. */
/* A second pass beside the cut of the first: what is thinner than the tolerance stays, a slice that is not comes off.
   Across both a plane leaves as many pieces on each side of it. */
START_TEST(flakes_stay) {
    static const double off[4] = {0.001, 0.004, 0.03, 0.1};
    const size_t pieces = _i < 2 ? 2 : 3;
    stage s = open_block(4, 1);
    move_between(&s, -2, 6, 1.8);
    stage_lift(&s);
    check_fragments(&s, 2, 0);
    move_between(&s, -2, 6, 1.8 + off[_i]);
    stage_lift(&s);
    check_fragments(&s, pieces, 0);
    stage_cut_plane(&s, 2.31);
    stage_look(&s);
    check_fragments(&s, 2 * pieces, 0);
    stage_close(&s);
}
END_TEST

START_TEST(scope) {
    stage s = open_block(5, 1);
    gx_blade_report report;
    int k;
    stage_cut_plane(&s, 2.41);
    stage_look(&s);
    for (k = 0; k <= 30; k++) {
        const double y = -2 + 0.3 * k, edge[6] = {-9, y, 2.2, 15, y + 0.4, 2.5};
        uint32_t left = 0;
        while (s.view.fragment_center[3 * left] > 2.4) left++;
        ck_assert_int_eq(gx_blade_move(s.blade, edge, 2, &left, 1, &report, &s.failure), GX_OK);
        stage_look(&s);
        if (s.view.fragment_count > 2) break; /* what has come off is not in the scope of one fragment */
    }
    check_fragments(&s, 3, 0);
    stage_close(&s);
}
END_TEST

/* Two blades cross in a block, move by move in turn; then one is destroyed, and the other goes on. Their ways go from
   low to high; they are about at `place`, and the other at last at `last`. */
static void cross_blades(int cubes, int moves, double low, double high, double place, double last) {
    stage s = open_block(cubes, 1);
    gx_blade *other = NULL;
    int k;
    ck_assert_int_eq(gx_blade_create(s.body, NULL, &other, NULL), GX_OK);
    for (k = 0; k <= moves; k++) {
        const double way = low + (high - low) * k / moves, edge[6] = {place + 0.1, -9, way, place + 0.4, 15, way + 0.2};
        move_at(&s, way, place);
        ck_assert_int_eq(gx_blade_move(other, edge, 2, NULL, 0, NULL, &s.failure), GX_OK);
        stage_look(&s);
    }
    stage_lift(&s);
    ck_assert_int_eq(gx_blade_lift(other, NULL, NULL), GX_OK);
    stage_look(&s);
    check_fragments(&s, 4, 0);
    gx_blade_destroy(s.blade);
    for (k = 0; k <= moves; k++) {
        const double way = low + (high - low) * k / moves, edge[6] = {-9, way, last, 15, way + 0.3, last + 0.1};
        ck_assert_int_eq(gx_blade_move(other, edge, 2, NULL, 0, NULL, &s.failure), GX_OK);
    }
    stage_look(&s);
    check_fragments(&s, 6, 0);
    stage_close(&s); /* the body destroys the blade that is left */
}

START_TEST(two_blades) { cross_blades(5, 40, -2, 7, 2.2, 1.1); }
END_TEST

/* While the blade is in the middle, a plane cuts the body across it. */
START_TEST(cut_between_moves) {
    stage s = open_block(5, 1);
    move_between(&s, -2, 2.6, 2.2);
    stage_cut_plane(&s, 2.41);
    stage_look(&s);
    check_fragments(&s, 2, 0);
    move_between(&s, 2.7, 7, 2.2);
    stage_lift(&s);
    check_fragments(&s, 4, 0);
    stage_close(&s);
}
END_TEST

static void remove_box(stage *s, const double low[3], const double high[3]) {
    workload w = wl_empty();
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    cut_by(s->body, &w, 0, 1);
    ck_assert_int_eq(gx_body_view(s->body, &s->view, NULL), GX_OK);
    s->volume = s->view.volume;
    wl_free(&w);
}

/* While the blade is in the middle, material is taken away: where it is, ahead of it, or all of it. */
START_TEST(removal_between_moves) {
    static const double low[3][3] = {{-1, 1.9, 1.4}, {1.3, 3.6, -1}, {-1, -1, -1}},
                        high[3][3] = {{3.1, 3.4, 3.3}, {3.2, 4.2, 6}, {6, 6, 6}};
    stage s = open_block(5, 1);
    move_between(&s, -2, 2.6, 2.2);
    remove_box(&s, low[_i], high[_i]);
    check_fragments(&s, _i == 2 ? 0 : 1, (uint64_t)_i);
    if (_i < 2) {
        move_between(&s, 2.7, 7, 2.2);
        stage_lift(&s);
        check_fragments(&s, 2, (uint64_t)_i);
    } else {
        gx_blade_report report;
        const double edge[6] = {-9, 2.7, 2.2, 15, 3, 2.3};
        ck_assert_int_eq(gx_blade_move(s.blade, edge, 2, NULL, 0, &report, NULL), GX_OK);
        ck_assert_uint_eq(report.triangle_count, 0);
        ck_assert_int_eq(gx_blade_lift(s.blade, &report, NULL), GX_OK);
    }
    stage_close(&s);
}
END_TEST

/* The body goes back to what it was before the stroke, or becomes a clone that is cut otherwise: its blade is lifted,
   or where the clone's is. The blade goes on. */
START_TEST(restored_between_moves) {
    stage s = open_for_stab(4);
    gx_body *before = NULL;
    ck_assert_int_eq(gx_body_clone(s.body, &before, NULL), GX_OK);
    move_between(&s, -2, 2, 1.8);
    if (_i == 1) {
        workload w = wl_empty();
        add_axis_plane(&w, 0, 1.7);
        cut_by(before, &w, 0, 1);
        wl_free(&w);
    }
    ck_assert_int_eq(gx_body_restore(s.body, before, NULL), GX_OK);
    ck_assert(gx_body_state_hash(s.body) == gx_body_state_hash(before));
    stage_look(&s);
    check_fragments(&s, _i == 0 ? 1 : 2, 0);
    ck_assert_ptr_eq(gx_body_blade(s.body, 0), s.blade);
    move_between(&s, -2, 6, 1.8);
    stage_lift(&s);
    check_fragments(&s, _i == 0 ? 2 : 4, 0);
    gx_body_destroy(before);
    stage_close(&s);
}
END_TEST

static gx_body *saved_and_loaded(gx_body *body) {
    gx_body *loaded = NULL;
    void *bytes;
    size_t size;
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = malloc(size);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &loaded, NULL), GX_OK);
    free(bytes);
    return loaded;
}

/* At every move of a stroke a copy is made. Each goes on as the body does, to the same bits. */
START_TEST(copies_go_on) {
    enum { MOVES = 16 };
    gx_body *copies[MOVES];
    stage s = open_block(4, 5);
    stage_motion motion = stage_random_motion(&s, STAGE_CALM);
    double edges[MOVES][6];
    int i, k, c;
    for (k = 0; k < MOVES; k++) {
        const double share = k / (MOVES - 1.0), y = -1.5 + 7 * share, edge[6] = {-9, y, 1.7, 13, y + 0.4, 2.2};
        memcpy(edges[k], edge, sizeof edge);
        if (_i == 0)
            ck_assert_int_eq(gx_body_clone(s.body, &copies[k], NULL), GX_OK);
        else
            copies[k] = saved_and_loaded(s.body);
        ck_assert(gx_body_state_hash(copies[k]) == gx_body_state_hash(s.body));
        stage_pose(&s, &motion, share);
        stage_move_edge(&s, edges[k], 2);
        for (i = 0; i <= k; i++) { /* the others follow */
            stage other = s;
            other.body = copies[i];
            other.view = view_of(copies[i]);
            other.blade = gx_body_blade(copies[i], 0);
            ck_assert_ptr_nonnull(other.blade);
            ck_assert_ptr_null(gx_body_blade(copies[i], 1));
            stage_pose(&other, &motion, share);
            stage_move_edge(&other, edges[k], 2);
            ck_assert_msg(gx_body_state_hash(copies[i]) == gx_body_state_hash(s.body), "copy %d differs at move %d", i,
                          k);
        }
    }
    check_fragments(&s, 2, 0);
    for (c = 0; c < MOVES; c++) gx_body_destroy(copies[c]);
    stage_close(&s);
}
END_TEST

/* ---- moves that are left out: each goes less far than what waits ---- */

static void move_finely(stage *s, double from, double to, double z) {
    const int frames = (int)(fabs(to - from) / 0.01);
    int k;
    for (k = 0; k <= frames; k++) move_at(s, from + (to - from) * k / frames, z);
}

/* How many pieces come of a plane across y: two behind the edge's way, and one where it has not been */
static void check_way(stage *s, double y, size_t expected) {
    workload w = wl_empty();
    add_axis_plane(&w, 1, y);
    cut_by(s->body, &w, 0, 1);
    wl_free(&w);
    stage_look(s);
    check_fragments(s, expected, 0);
}

/* The edge is lifted, or drawn back at once, or to where it came from and in again: as far as it has been all is cut,
   and no farther. In the block the edge is at y + 0.15 to y + 0.25. */
START_TEST(fine_thrusts) {
    const double y = 2.4137;
    stage s = open_block(4, 1);
    move_finely(&s, -1, y, 1.8);
    if (_i / 2 == 1) move_at(&s, -2, 1.8);
    if (_i / 2 == 2) {
        move_finely(&s, y, 2.1, 1.8);
        move_finely(&s, 2.1, 2.3, 1.8);
    }
    stage_lift(&s);
    check_fragments(&s, 1, 0);
    check_way(&s, y + (_i % 2 == 0 ? 0.13 : 0.27), _i % 2 == 0 ? 3 : 2);
    stage_close(&s);
}
END_TEST

/* The move after one that has cut may be left out: a small thrust there counts too, be it lifted or drawn back at once.
 */
START_TEST(thrusts_after_cuts) {
    const double y = 2.4137;
    stage s = open_block(4, 1);
    size_t triangles = 0;
    int k;
    for (k = 0; k <= 6; k++) {
        triangles = s.tally.triangles;
        move_at(&s, y - 0.3 - 0.6 * (6 - k), 1.8);
    }
    ck_assert_uint_gt(s.tally.triangles, triangles);
    triangles = s.tally.triangles;
    move_at(&s, y, 1.8);
    ck_assert_uint_eq(s.tally.triangles, triangles);
    if (_i / 2 == 1) move_at(&s, -2, 1.8);
    stage_lift(&s);
    check_fragments(&s, 1, 0);
    check_way(&s, y + (_i % 2 == 0 ? 0.13 : 0.27), _i % 2 == 0 ? 3 : 2);
    stage_close(&s);
}
END_TEST

/* Copies that are made while moves are left out, and the body gone back to one of them, go on to the same bits. */
START_TEST(fine_copies) {
    enum { FROM = 60, COPIES = 9, TO = 110 };
    gx_body *copies[COPIES];
    stage s = open_block(3, 5);
    stage_motion motion = stage_random_motion(&s, STAGE_CALM);
    int i, k, made = 0;
    for (k = 0; k <= TO; k++) {
        const double share = k / 200.0, y = -1.5 + 6 * share, edge[6] = {-9, y, 1.2, 12, y + 0.4, 1.7};
        if (k >= FROM && made < COPIES) {
            copies[made] = NULL;
            if (made % 2 == 0)
                ck_assert_int_eq(gx_body_clone(s.body, &copies[made], NULL), GX_OK);
            else
                copies[made] = saved_and_loaded(s.body);
            ck_assert(gx_body_state_hash(copies[made]) == gx_body_state_hash(s.body));
            made++;
        }
        stage_pose(&s, &motion, share);
        stage_move_edge(&s, edge, 2);
        for (i = 0; i < made; i++) {
            stage other = s;
            other.body = copies[i];
            other.view = view_of(copies[i]);
            other.blade = gx_body_blade(copies[i], 0);
            stage_pose(&other, &motion, share);
            stage_move_edge(&other, edge, 2);
            ck_assert_msg(gx_body_state_hash(copies[i]) == gx_body_state_hash(s.body), "copy %d differs at move %d", i,
                          k);
        }
        if (k == FROM + COPIES + 4) { /* the body itself is another one's copy from here on */
            ck_assert_int_eq(gx_body_restore(s.body, copies[3], NULL), GX_OK);
            ck_assert(gx_body_state_hash(s.body) == gx_body_state_hash(copies[3]));
            stage_look(&s);
        }
    }
    check_stage(&s, 5);
    for (i = 0; i < COPIES; i++) gx_body_destroy(copies[i]);
    stage_close(&s);
}
END_TEST

/* While moves are left out another cut comes: across the edge's way, or material on it is removed, or all. What the
   blade remembers can be saved then, and loaded. */
START_TEST(fine_cut_between) {
    static const double low[2][3] = {{-1, 1.9, 1.4}, {-1, -1, -1}}, high[2][3] = {{3.1, 3.4, 3.3}, {6, 6, 6}};
    stage s = open_block(5, 1);
    int k;
    move_finely(&s, -1, 2.6, 2.2);
    if (_i == 0)
        stage_cut_plane(&s, 2.41);
    else
        remove_box(&s, low[_i - 1], high[_i - 1]);
    gx_body_destroy(saved_and_loaded(s.body));
    if (_i == 2) {
        const double edge[6] = {-9, 2.6, 2.2, 15, 2.9, 2.3};
        for (k = 0; k < 3; k++) {
            ck_assert_int_eq(gx_blade_move(s.blade, edge, 2, NULL, 0, NULL, NULL), GX_OK);
            gx_body_destroy(saved_and_loaded(s.body));
        }
        ck_assert_uint_eq(s.view.fragment_count, 0);
    } else {
        stage_look(&s);
        check_fragments(&s, _i == 0 ? 2 : 1, 0);
        move_finely(&s, 2.61, 6, 2.2);
        stage_lift(&s);
        check_fragments(&s, _i == 0 ? 4 : 2, 0);
    }
    stage_close(&s);
}
END_TEST

/* In fine moves one blade at a time leaves out moves. */
START_TEST(fine_blades) { cross_blades(3, 300, -1, 4, 1.2, 2.1); }
END_TEST

/* A tool far larger than the body takes all of it, also where its surface is far away. */
START_TEST(tool_around_all) {
    static const double low[3] = {-9, -8, -7}, high[3] = {12, 11, 13};
    workload w = grid(3, 3, 3, 5);
    gx_body *body = body_of(&w);
    gx_surface tool;
    gx_cut_report report;
    gx_view view = view_of(body);
    size_t i;
    for (i = 0; i < 3 * view.copy_count; i++) view.displacement[i] = 0.25;
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    tool = surface_of(&w.surfaces[0]);
    ck_assert_int_eq(gx_body_carve(body, &tool, &report, NULL), GX_OK);
    ck_assert_double_eq_tol(report.removed_volume, 27, 1e-12);
    view = view_of(body);
    ck_assert_uint_eq(view.copy_count, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Down two arms of coarse elements into the root that they share: layers flow into one anywhere in an element. A crack
   of rounding's width between the strips of the layers and those of the one that they become leaves an element whole.
 */
START_TEST(layers_become_one) {
    static const double slit[9] = {0.45, -9, 2.1, 0.47, 9, 2.1, 0.46, 0.5, 99};
    const double stride = (_i / 8 + 1) * 0.25, begin = 7.1 + 0.1 * (_i % 8);
    workload w = grid(1, 1, 7, 5);
    gx_body *body;
    gx_blade *blade = NULL;
    gx_blade_desc desc;
    wl_surface *sheet = wl_add_surface(&w, 0);
    gx_view view;
    int way, i;
    for (i = 0; i < 3; i++) wl_add_vertex(sheet, slit + 3 * i);
    wl_add_triangle(sheet, 0, 1, 2);
    memset(&desc, 0, sizeof desc);
    desc.min_advance = _i % 2 ? 0.7 : 0;
    for (way = 0; way < 2; way++) { /* and up out of the root */
        body = body_of(&w);
        cut_by(body, &w, 0, 1);
        ck_assert_int_eq(gx_blade_create(body, &desc, &blade, NULL), GX_OK);
        for (i = 0; stride * i < 9; i++) {
            const double down = begin - stride * i, z = way ? 7 - down : down,
                         edge[6] = {-9, 0.5, z, 9, 0.53, z + 0.05};
            ck_assert_int_eq(gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL), GX_OK);
        }
        ck_assert_int_eq(gx_blade_lift(blade, NULL, NULL), GX_OK);
        view = view_of(body);
        ck_assert_msg(view.fragment_count == 2, "%g from %g, way %d: %zu fragments", stride, begin, way,
                      view.fragment_count);
        ck_assert(fabs(view.volume - 7) < 1e-12 && view.fragment_volume[0] > 3);
        gx_body_destroy(body);
    }
    wl_free(&w);
}
END_TEST

/* Blades by index: in the order of their creation */
START_TEST(blades_of_a_body) {
    stage s = open_block(2, 1);
    gx_blade *second = NULL, *third = NULL;
    ck_assert_int_eq(gx_blade_create(s.body, NULL, &second, NULL), GX_OK);
    ck_assert_int_eq(gx_blade_create(s.body, NULL, &third, NULL), GX_OK);
    ck_assert(gx_body_blade(s.body, 0) == s.blade && gx_body_blade(s.body, 1) == second);
    ck_assert(gx_body_blade(s.body, 2) == third && gx_body_blade(s.body, 3) == NULL);
    ck_assert_ptr_null(gx_body_blade(NULL, 0));
    gx_blade_destroy(second);
    ck_assert(gx_body_blade(s.body, 0) == s.blade && gx_body_blade(s.body, 1) == third);
    stage_close(&s);
}
END_TEST

/* ---- carving ---- */

/* A closed box in space, its edges along the axes; m */
static gx_result carve_box(gx_body *body, const double low[3], const double high[3], gx_cut_report *report) {
    workload w = wl_empty();
    gx_surface tool;
    gx_result result;
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    tool = surface_of(&w.surfaces[0]);
    result = gx_body_carve(body, &tool, report, NULL);
    wl_free(&w);
    return result;
}

/* At rest a tool removes what the same solid cuts out; in a body that is shifted, what lies there then. */
START_TEST(carving) {
    static const double low[3] = {-1, 0.6, 1.3}, high[3] = {2.6, 2.3, 2.9}, shift[3] = {0.7, -0.3, 0.45};
    const double expected = 2.6 * 1.7 * 1.6;
    stage s = open_block(4, 1);
    gx_cut_report report;
    double from[3], to[3];
    size_t i;
    int k;
    for (i = 0; i < 3 * s.view.copy_count && _i == 1; i++) s.view.displacement[i] = shift[i % 3];
    for (k = 0; k < 3; k++) {
        from[k] = low[k] + (_i == 1 ? shift[k] : 0);
        to[k] = high[k] + (_i == 1 ? shift[k] : 0);
    }
    ck_assert_int_eq(carve_box(s.body, from, to, &report), GX_OK);
    ck_assert_msg(fabs(report.removed_volume - expected) <= 1e-9, "%g m3 in place of %g", report.removed_volume,
                  expected);
    ck_assert(fabs(view_of(s.body).volume - (64 - expected)) <= 1e-9);
    ck_assert_uint_eq(view_of(s.body).fragment_count, 1);
    stage_close(&s);
}
END_TEST

/* In a body that is bent and turned, the volume that a small tool removes is what it covers in space, piece by piece:
   within a share of it, since edges of the tool are straight in space and not in the material. What is left is at its
   place: no vertex of the skin is inside the tool. */
START_TEST(carving_what_moves) {
    static const double low[3] = {1.1, 0.9, 1.2}, high[3] = {2.7, 2.8, 2.6};
    stage s = open_block(4, (uint64_t)_i + 1);
    const stage_motion motion = stage_random_motion(&s, STAGE_CALM);
    const double covered = 1.6 * 1.9 * 1.4;
    gx_cut_report report;
    gx_skin skin;
    double *x;
    size_t i;
    stage_pose(&s, &motion, 0.3);
    ck_assert_int_eq(carve_box(s.body, low, high, &report), GX_OK);
    CHECK_SEED(fabs(report.removed_volume / covered - 1) <= 0.35, _i + 1); /* waves stretch by up to a third */
    ck_assert_int_eq(gx_body_skin(s.body, NULL, &skin, NULL), GX_OK);
    x = (double *)malloc(3 * skin.vertex_count * sizeof *x);
    ck_assert_int_eq(gx_body_skin_positions(s.body, x, NULL), GX_OK);
    for (i = 0; i < skin.vertex_count; i++) {
        double depth = HUGE_VAL;
        int k;
        for (k = 0; k < 3; k++)
            depth = fmin(depth, fmin(x[3 * i + (size_t)k] - low[k], high[k] - x[3 * i + (size_t)k]));
        ck_assert_msg(depth <= 0.05, "seed %d: a vertex is %g m inside the tool", _i + 1, depth);
    }
    free(x);
    stage_close(&s);
}
END_TEST

/* ---- other sizes and places ---- */

/* Small, large, and far from the origin: pieces as at home. Of another size by a power of two: the same cells. */
START_TEST(sizes_and_places) {
    static const double scales[5] = {1048576, 1.0 / 1048576, 1e6, 1e-6, 1},
                        places[5][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1e6, -3e6, 2e6}};
    stage home = open_block(4, 1), s = block_of(4, 1);
    stage_sheet sheet;
    stage_motion motion;
    gx_view view;
    size_t i;
    s.scale = scales[_i];
    memcpy(s.origin, places[_i], sizeof s.origin);
    stage_open(&s, 1e3, 0, NULL);
    sheet = stage_random_sheet(&home);
    motion = stage_random_motion(&home, STAGE_CALM);
    stage_follow_sheet(&home, &sheet, &motion, 30);
    stage_follow_sheet(&s, &sheet, &motion, 30);
    check_fragments(&home, 2, 0);
    ck_assert_int_eq(s.failure.result, GX_OK);
    ck_assert_uint_eq(s.view.fragment_count, 2);
    if (_i < 2) ck_assert(hash_of(home.body) == hash_of(s.body));
    view = s.view;
    ck_assert(fabs(view.volume / pow(s.scale, 3) - home.view.volume) <= 1e-9 * home.view.volume);
    for (i = 0; i < 2; i++) {
        const double v = view.fragment_volume[i] / pow(s.scale, 3);
        /* a strip may begin a move earlier or later: within the tolerance of 0.01 cubes of the section */
        const double near = _i < 2 ? 1e-4 : 0.01 * 16;
        ck_assert(fabs(v - home.view.fragment_volume[0]) < near || fabs(v - home.view.fragment_volume[1]) < near);
    }
    stage_close(&home);
    stage_close(&s);
}
END_TEST

/* ---- edges ---- */

/* The same straight edge of two points and of many, evenly or not, some of them equal */
START_TEST(many_points) {
    enum { MANY = 1001 };
    static double edge[3 * MANY];
    stage two = open_block(4, 1), many = open_block(4, 1);
    int k, i, c;
    for (k = 0; k <= 30; k++) {
        const double y = -2 + 0.27 * k, ends[6] = {-9, y, 1.8, 13, y + 0.3, 2.1};
        for (i = 0; i < MANY; i++) {
            const double even = (double)i / (MANY - 1), share = _i == 0 ? even : _i == 1 ? even * even : i / 100 / 10.0;
            for (c = 0; c < 3; c++)
                edge[3 * i + c] = i == MANY - 1 ? ends[3 + c] : ends[c] + share * (ends[3 + c] - ends[c]);
        }
        stage_move_edge(&two, ends, 2);
        stage_move_edge(&many, edge, MANY);
    }
    stage_lift(&two);
    stage_lift(&many);
    check_fragments(&two, 2, 0);
    check_fragments(&many, 2, 0);
    ck_assert(volume_difference(&two.view, &many.view) <= 0.01 * 32);
    stage_close(&two);
    stage_close(&many);
}
END_TEST

/* A bent edge, and one that is a closed line: what it goes around comes out as a plug. */
START_TEST(bent_edges) {
    enum { POINTS = 41 };
    stage s = open_block(5, 1);
    double edge[3 * POINTS];
    int k, i;
    for (k = 0; k <= 40; k++) {
        const double z = 7 - 0.23 * k;
        for (i = 0; i < POINTS; i++) {
            const double angle = 6.283185307179586 * i / (POINTS - 1), u = (i - 20) / 2.0;
            edge[3 * i] = _i == 0 ? 2.5 + u : 2.47 + (i == POINTS - 1 ? 1.6 : 1.6 * cos(angle));
            edge[3 * i + 1] = _i == 0 ? 1.6 + 0.1 * u * u : 2.52 + (i == POINTS - 1 ? 0 : 1.6 * sin(angle));
            edge[3 * i + 2] = z;
        }
        stage_move_edge(&s, edge, POINTS);
    }
    stage_lift(&s);
    check_stage(&s, 0);
    if (_i == 0)
        check_fragments(&s, 2, 0);
    else /* the ends are two places of one point: no more is asked of them than this */
        ck_assert_uint_ge(s.view.fragment_count, 1);
    stage_close(&s);
}
END_TEST

/* Edges that are one point, edges that do not move, edges that move along themselves: nothing comes off, nothing
   fails. */
START_TEST(degenerate_edges) {
    stage s = open_block(3, 1);
    int k;
    for (k = 0; k <= 20; k++) {
        const double y = -2 + 0.35 * k, point[9] = {1.4, y, 1.3, 1.4, y, 1.3, 1.4, y, 1.3},
                     still[9] = {-9, -1, 1.3, 0, -1, 1.3, 9, -1, 1.3},
                     along[9] = {-9 - y, 1.2, 1.3, -8 - y, 1.2, 1.3, 12 + y, 1.2, 1.3};
        if (_i == 2 && k == 0) { /* the edge comes to lie in the block at the first two moves */
            const double outside[9] = {-9, -1, 1.3, 0, -1, 1.3, 9, -1, 1.3};
            stage_move_edge(&s, outside, 3);
        }
        stage_move_edge(&s, _i == 0 ? point : _i == 1 ? still : along, 3);
    }
    stage_lift(&s);
    check_fragments(&s, 1, 0);
    stage_close(&s);
}
END_TEST

/* Edges whose ends are far away. Where rounding moves places between them by more than an element the blade misses the
   body. */
START_TEST(far_ends) {
    stage s = open_block(3, 1);
    const double far = _i == 0 ? 1e12 : _i == 1 ? 1e20 : 1e30;
    int k;
    for (k = 0; k <= 20; k++) {
        const double y = -2 + 0.35 * k, edge[9] = {-far, y, 1.3, 1.4, y, 1.3, far, y, 1.3};
        stage_move_edge(&s, edge, 3);
    }
    stage_lift(&s);
    check_fragments(&s, _i == 0 ? 2 : 1, 0);
    stage_close(&s);
}
END_TEST

/* After a step that went wrong copies may be anywhere. The moves end soon, cut hardly anything, and keep the volume. */
START_TEST(huge_displacements) {
    stage s = open_block(3, 1);
    const double sizes[3] = {1e6, 1e20, 1e30}, size = sizes[_i];
    size_t most = 0, c;
    int k;
    for (k = 0; k < 6; k++) {
        const double edge[6] = {-9, -2 + 0.4 * k, 1.3, 12, -2 + 0.5 * k, 1.4}, far[6] = {-9, k * size, 1.3, 9, 0.6, 1};
        const size_t before = s.tally.triangles;
        for (c = 0; c < 3 * s.view.copy_count && k >= 2; c++) s.view.displacement[c] = size * (stage_uniform(&s));
        stage_move_edge(&s, k < 4 ? edge : far, 2);
        if (s.tally.triangles - before > most) most = s.tally.triangles - before;
    }
    stage_lift(&s);
    check_stage(&s, (uint64_t)_i);
    ck_assert_msg(most < 300, "a move made %zu triangles", most);
    stage_close(&s);
}
END_TEST

/* A body that is thrown over the place where the edge was a move ago, and stays beside the edge: nothing has passed
   through it. After that the edge passes as always. */
START_TEST(thrown_bodies) {
    stage s = open_block(3, 1);
    uint64_t topology;
    size_t i;
    int k;
    move_at(&s, -2.5, 1.3);
    for (i = 0; i < s.view.copy_count; i++) s.view.displacement[3 * i + 1] -= 3.5;
    topology = hash_of(s.body);
    move_at(&s, -5.2, 1.3);
    check_stage(&s, 0);
    ck_assert(hash_of(s.body) == topology && s.tally.triangles == 0);
    for (k = 0; k < 30; k++) move_at(&s, -5.2 + 0.2 * k, 1.3);
    stage_lift(&s);
    check_fragments(&s, 2, 0);
    stage_close(&s);
}
END_TEST

/* Far from the body nothing happens. */
START_TEST(nothing_near) {
    stage s = open_block(3, 1);
    const uint64_t topology = hash_of(s.body);
    gx_blade_report report;
    int k;
    for (k = 0; k < 5; k++) {
        const double edge[6] = {-9, 20.0 + k, 1, 9, 20.0 + k, 1};
        memset(&report, 1, sizeof report);
        ck_assert_int_eq(gx_blade_move(s.blade, edge, 2, NULL, 0, &report, &s.failure), GX_OK);
        ck_assert(report.layer_count == 0 && report.triangle_count == 0 && report.deviation == 0);
        ck_assert(report.cut.touched_elements == 0 && report.cut.min_link_ratio == 1);
        ck_assert_ptr_null(s.failure.field);
        ck_assert_uint_eq(s.failure.index, SIZE_MAX);
    }
    ck_assert(hash_of(s.body) == topology);
    stage_close(&s);
}
END_TEST

/* ---- refusals and memory ---- */

/* Moves that are refused between those that are not leave no trace. (test_failures.c has the fields.) */
START_TEST(refused_moves) {
    stage plain = open_block(4, 1), tried = open_block(4, 1);
    const double bad[6] = {-9, NAN, 1, 9, 1, 1}, three[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    const uint32_t nowhere = 99;
    int k;
    for (k = 0; k <= 20; k++) {
        const double y = -2 + 0.4 * k;
        move_at(&plain, y, 1.8);
        if (k > 0) {
            const uint64_t state = gx_body_state_hash(tried.body);
            ck_assert_int_eq(gx_blade_move(tried.blade, bad, 2, NULL, 0, NULL, NULL), GX_ERROR_NOT_FINITE);
            ck_assert_int_eq(gx_blade_move(tried.blade, three, 3, NULL, 0, NULL, NULL), GX_ERROR_ARGUMENT);
            ck_assert_int_eq(gx_blade_move(tried.blade, three, 2, &nowhere, 1, NULL, NULL), GX_ERROR_INDEX);
            ck_assert(gx_body_state_hash(tried.body) == state);
        }
        move_at(&tried, y, 1.8);
    }
    check_fragments(&plain, 2, 0);
    check_fragments(&tried, 2, 0);
    ck_assert(hash_of(plain.body) == hash_of(tried.body));
    ck_assert(gx_body_state_hash(plain.body) == gx_body_state_hash(tried.body));
    stage_close(&plain);
    stage_close(&tried);
}
END_TEST

static gx_result move_far(gx_blade *blade, int k, int of) {
    const double y = -1.6 + 4.8 * k / of, edge[6] = {-9, y, 0.9, 11, y + 0.3, 1.2};
    return gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL);
}

/* At each move of a stroke, every allocation fails in turn: the body is as it was, and the blade goes on as if nothing
   had been. Few moves that cut, or more, of which most are left out */
START_TEST(memory_runs_out) {
    const int count = _i / 2 == 0 ? 6 : 60 / FEWER;
    workload w = grid(2, 2, 2, 5);
    memory own, other;
    gx_body *body = body_in(&own, &w), *plain = body_in(&other, &w);
    gx_blade *blade = NULL, *plain_blade = NULL;
    size_t failures = 0;
    int k;
    ck_assert_int_eq(gx_blade_create(body, NULL, &blade, NULL), GX_OK);
    ck_assert_int_eq(gx_blade_create(plain, NULL, &plain_blade, NULL), GX_OK);
    for (k = 0; k <= count; k++) {
        gx_result result = GX_ERROR_MEMORY;
        const uint64_t state = gx_body_state_hash(body);
        size_t n;
        for (n = 0; result != GX_OK; n++) {
            fail_from(&own, n, _i % 2);
            result = k < count ? move_far(blade, k, count) : gx_blade_lift(blade, NULL, NULL);
            if (result == GX_OK) break;
            failures++;
            ck_assert_int_eq(result, GX_ERROR_MEMORY);
            ck_assert_msg(gx_body_state_hash(body) == state, "move %d, allocation %zu: the body has changed", k, n);
        }
        never_fail(&own);
        ck_assert_int_eq(k < count ? move_far(plain_blade, k, count) : gx_blade_lift(plain_blade, NULL, NULL), GX_OK);
        ck_assert_msg(hash_of(body) == hash_of(plain), "move %d: other cells", k);
        ck_assert_msg(gx_body_state_hash(body) == gx_body_state_hash(plain), "move %d: another state", k);
    }
    ck_assert_uint_gt(failures, 50);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    gx_body_destroy(plain);
    ck_assert(is_whole(&own));
    wl_free(&w);
}
END_TEST

/* The same moves give the same bits. */
START_TEST(same_bits) {
    stage a = open_block(4, 3), b = open_block(4, 3);
    const stage_motion m = stage_random_motion(&a, STAGE_SWINGING);
    b.random = a.random;
    stage_random_pass(&a, &m, 40);
    stage_random_pass(&b, &m, 40);
    check_stage(&a, 3);
    ck_assert(hash_of(a.body) == hash_of(b.body));
    ck_assert(gx_body_state_hash(a.body) == gx_body_state_hash(b.body));
    stage_close(&a);
    stage_close(&b);
}
END_TEST

static TCase *add_case(Suite *suite, const char *name, double timeout) {
    TCase *tests = tcase_create(name);
    tcase_set_timeout(tests, timeout);
    suite_add_tcase(suite, tests);
    return tests;
}

int main(void) {
    Suite *suite = suite_create("blade");
    TCase *tests = add_case(suite, "blade", 120), *some = add_case(suite, "passes", 36000);
    const char *only = getenv("GXFEM_SEED");
    const int first = only ? atoi(only) - 1 : 0;
    tcase_add_loop_test(tests, scenes, 0, STAGE_SCENES);
    tcase_add_test(tests, held_from_the_other_end);
    tcase_add_loop_test(tests, other_sizes, 0, FEWER > 1 ? OTHER_SIZES / 2 : OTHER_SIZES);
    tcase_add_loop_test(tests, swinging_passes, 0, FEWER > 1 ? 2 : 16);
    tcase_add_loop_test(tests, octopus, 0, 4);
    tcase_add_loop_test(tests, path_and_sheet, 0, REST_PASSES);
    tcase_add_loop_test(tests, other_meshes, 0, 2);
    tcase_add_test(tests, relativity);
    tcase_add_loop_test(tests, known_sheets, first, only ? first + 1 : 18 / FEWER);
    tcase_add_loop_test(tests, more_frames, first, only ? first + 1 : 2);
    tcase_add_loop_test(tests, noise, 0, 2);
    tcase_add_loop_test(tests, stab, 0, 2);
    tcase_add_loop_test(tests, lift_in_the_middle, 0, 2);
    tcase_add_test(tests, second_stroke);
    tcase_add_test(tests, several_strokes);
    tcase_add_test(tests, lift_cuts_what_waits);
    tcase_add_loop_test(tests, specks_stay, 0, 2);
    tcase_add_loop_test(tests, flakes_stay, 0, 4);
    tcase_add_test(tests, scope);
    tcase_add_test(tests, two_blades);
    tcase_add_test(tests, cut_between_moves);
    tcase_add_loop_test(tests, removal_between_moves, 0, 3);
    tcase_add_loop_test(tests, restored_between_moves, 0, 2);
    tcase_add_loop_test(tests, copies_go_on, 0, 2);
    tcase_add_loop_test(tests, fine_thrusts, 0, 6);
    tcase_add_loop_test(tests, thrusts_after_cuts, 0, 4);
    tcase_add_test(tests, fine_copies);
    tcase_add_loop_test(tests, fine_cut_between, 0, 3);
    tcase_add_test(tests, fine_blades);
    tcase_add_loop_test(tests, layers_become_one, 0, 40);
    tcase_add_test(tests, blades_of_a_body);
    tcase_add_test(tests, tool_around_all);
    tcase_add_loop_test(tests, carving, 0, 2);
    tcase_add_loop_test(tests, carving_what_moves, first, only ? first + 1 : 6);
    tcase_add_loop_test(tests, sizes_and_places, 0, 5);
    tcase_add_loop_test(tests, many_points, 0, FEWER > 1 ? 1 : 3);
    tcase_add_loop_test(tests, bent_edges, 0, 2);
    tcase_add_loop_test(tests, degenerate_edges, 0, 3);
    tcase_add_loop_test(tests, far_ends, 0, 3);
    tcase_add_loop_test(tests, huge_displacements, 0, 3);
    tcase_add_test(tests, thrown_bodies);
    tcase_add_test(tests, nothing_near);
    tcase_add_test(tests, refused_moves);
    tcase_add_loop_test(tests, memory_runs_out, 0, 4);
    tcase_add_test(tests, same_bits);
    tcase_add_loop_test(some, passes, 0, PASSES_AT_ONCE);
    return run_suite(suite);
}
