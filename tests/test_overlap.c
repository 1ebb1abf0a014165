/* test_overlap.c - examples/gxoverlap.h: depths that are known, and boxes turned at random beside sampling. */
#include "../examples/gxoverlap.h"
#include "../bench/splitmix.h"
#include "runner.h"

enum { MOST_BOXES = 4 };

typedef struct boxes {
    double positions[MOST_BOXES * 8 * 3];
    uint32_t triangles[MOST_BOXES * 12 * 3], pieces[MOST_BOXES * 12];
    double pose[MOST_BOXES][12], half[MOST_BOXES][3];
    uint32_t count;
    gxoverlap_surface surface;
} boxes;

/* 0 ... 1 */
static double share(uint64_t *state) { return (double)(splitmix64(state) >> 11) / 9007199254740992.0; }

static void turn(double pose[12], int axis, double angle) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    int k;
    for (k = 0; k < 3; k++) { /* rows of R o: the rotation goes after */
        const double x = pose[4 * a + k], y = pose[4 * b + k];
        pose[4 * a + k] = cos(angle) * x - sin(angle) * y;
        pose[4 * b + k] = sin(angle) * x + cos(angle) * y;
    }
}

static void identity(double pose[12]) {
    int k;
    memset(pose, 0, 12 * sizeof *pose);
    for (k = 0; k < 3; k++) pose[5 * k] = 1;
}

static void add(boxes *all, const double pose[12], double x, double y, double z, uint32_t piece) {
    static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const double half[3] = {x, y, z};
    const uint32_t first = 8 * all->count;
    uint32_t c, f, t;
    int i, k;
    for (c = 0; c < 8; c++)
        for (k = 0; k < 3; k++) {
            double *to = &all->positions[3 * (first + c) + (uint32_t)k];
            for (*to = pose[4 * k + 3], i = 0; i < 3; i++) *to += pose[4 * k + i] * (c >> i & 1 ? half[i] : -half[i]);
        }
    for (f = 0; f < 6; f++)
        for (t = 0; t < 2; t++) {
            const uint32_t at = 12 * all->count + 2 * f + t;
            all->triangles[3 * at] = first + faces[f][0];
            all->triangles[3 * at + 1] = first + faces[f][1 + t];
            all->triangles[3 * at + 2] = first + faces[f][2 + t];
            all->pieces[at] = piece;
        }
    memcpy(all->pose[all->count], pose, 12 * sizeof *pose);
    memcpy(all->half[all->count], half, sizeof half);
    all->count++;
    all->surface.positions = all->positions;
    all->surface.triangles = all->triangles;
    all->surface.pieces = all->pieces;
    all->surface.triangle_count = 12 * all->count;
}

static void add_at(boxes *all, double x, double y, double z, const double half[3], uint32_t piece) {
    double pose[12];
    identity(pose);
    pose[3] = x;
    pose[7] = y;
    pose[11] = z;
    add(all, pose, half[0], half[1], half[2], piece);
}

static gxoverlap pieces_of(const boxes *all, double tolerance) {
    gxoverlap_forest forest;
    gxoverlap most;
    ck_assert(gxoverlap_make(&forest, &all->surface));
    most = gxoverlap_of_pieces(&forest, tolerance);
    gxoverlap_release(&forest);
    return most;
}

static double itself_of(const boxes *all) {
    gxoverlap_forest forest;
    gxoverlap most;
    ck_assert(gxoverlap_make(&forest, &all->surface));
    most = gxoverlap_of_itself(&forest);
    gxoverlap_release(&forest);
    return most.depth;
}

/* Faces, corners, one in another, and bodies that only touch: of one vertex in common, in one plane */
START_TEST(known_depths) {
    const double unit[3] = {0.5, 0.5, 0.5}, small[3] = {0.1, 0.1, 0.1};
    const double shifts[6][4] = {{0.9, 0, 0, 0.1}, {0.97, 0.2, -0.3, 0.03}, {0.8, 0.9, 0.95, 0.05},
                                 {1, 0, 0, 0},     {1, 0.3, 0.2, 0},        {1.5, 0, 0, 0}};
    boxes all;
    gxoverlap most;
    int i;
    for (i = 0; i < 6; i++) {
        memset(&all, 0, sizeof all);
        add_at(&all, 0, 0, 0, unit, 7);
        add_at(&all, shifts[i][0], shifts[i][1], shifts[i][2], unit, 3);
        most = pieces_of(&all, 1e-4);
        ck_assert_msg(fabs(most.depth - shifts[i][3]) < 2e-4, "%d: %g (%g)", i, most.depth, shifts[i][3]);
        ck_assert(most.depth > 0 ? most.piece + most.other == 10 : most.piece == 0 && most.other == 0);
        ck_assert_double_le(itself_of(&all), 0);
    }
    memset(&all, 0, sizeof all);
    add_at(&all, 0, 0, 0, unit, 0);
    add_at(&all, 0.1, 0.2, 0.05, small, 1); /* its far corner is 0.5 - 0.1 + 0.2 ... from the nearest face */
    most = pieces_of(&all, 1e-4);
    ck_assert_double_eq_tol(most.depth, 0.4, 2e-4);
    ck_assert_uint_eq(most.piece, 1);
    memset(&all, 0, sizeof all);
    ck_assert_double_le(pieces_of(&all, 1e-4).depth, 0);
}
END_TEST

/* No vertex is in the other one: two ridges cross. */
START_TEST(edges_cross) {
    const double overlap = 0.01, quarter = atan(1.0);
    double pose[12];
    boxes all;
    memset(&all, 0, sizeof all);
    identity(pose);
    turn(pose, 0, quarter);
    add(&all, pose, 2, 0.5, 0.5, 0);
    identity(pose);
    turn(pose, 1, quarter);
    pose[3] = 0.123;
    pose[7] = 0.077;
    pose[11] = 2 * sqrt(0.5) - overlap;
    add(&all, pose, 0.5, 2, 0.5, 1);
    ck_assert_double_eq_tol(pieces_of(&all, 1e-5).depth, overlap * sqrt(0.5), 1e-5);
}
END_TEST

static double depth_in_box(const boxes *all, uint32_t box, const double p[3]) {
    double gradient[3];
    gxoverlap_round round;
    memcpy(round.pose, all->pose[box], sizeof round.pose);
    memcpy(round.half, all->half[box], sizeof round.half);
    round.radius = 0;
    return -gxoverlap_from_round(&round, p, gradient);
}

/* The largest depth of samples of box a in box b, and how far it may be below the truth */
static double sampled(const boxes *all, uint32_t a, uint32_t b, double *off) {
    enum { N = 48 };
    double most = 0;
    uint32_t t;
    int i, j, k;
    for (t = 12 * a; t < 12 * a + 12; t++)
        for (i = 0; i <= N; i++)
            for (j = 0; i + j <= N; j++) {
                double p[3];
                for (k = 0; k < 3; k++)
                    p[k] = (i * all->positions[3 * all->triangles[3 * t] + (uint32_t)k] +
                            j * all->positions[3 * all->triangles[3 * t + 1] + (uint32_t)k] +
                            (N - i - j) * all->positions[3 * all->triangles[3 * t + 2] + (uint32_t)k]) /
                           N;
                most = fmax(most, depth_in_box(all, b, p));
            }
    *off = 2 * sqrt(2.0) * 0.8 / N; /* the longest side of a triangle, of the largest box */
    return most;
}

START_TEST(turned_boxes) {
    uint64_t state = 77;
    int i, k, deep = 0;
    for (i = 0; i < 60; i++) {
        boxes all;
        double expected[2], off[2], found;
        gxoverlap_round round;
        gxoverlap in;
        int b;
        memset(&all, 0, sizeof all);
        for (b = 0; b < 2; b++) {
            double pose[12];
            identity(pose);
            for (k = 0; k < 3; k++) turn(pose, k, 6.3 * share(&state));
            for (k = 0; k < 3; k++) pose[4 * k + 3] = b ? 1.6 * share(&state) - 0.8 : 0;
            add(&all, pose, 0.3 + 0.5 * share(&state), 0.3 + 0.5 * share(&state), 0.3 + 0.5 * share(&state),
                (uint32_t)b);
        }
        expected[0] = sampled(&all, 0, 1, &off[0]);
        expected[1] = sampled(&all, 1, 0, &off[1]);
        found = pieces_of(&all, 1e-4).depth;
        ck_assert_msg(found >= fmax(expected[0], expected[1]) - 2e-4 &&
                          found <= fmax(expected[0], expected[1]) + off[0],
                      "boxes %d: %g, sampled %g %g", i, found, expected[0], expected[1]);
        deep += found > 0.05;
        /* the second as a convex body, with its own surface away from both */
        memcpy(round.pose, all.pose[1], sizeof round.pose);
        memcpy(round.half, all.half[1], sizeof round.half);
        round.radius = 0;
        all.surface.triangle_count = 12;
        in = gxoverlap_in_convex(&all.surface, gxoverlap_from_round, &round, 1e-4);
        ck_assert_msg(in.depth >= expected[0] - 2e-4 && in.depth <= expected[0] + off[0], "boxes %d: %g, sampled %g", i,
                      in.depth, expected[0]);
    }
    ck_assert_int_gt(deep, 20);
}
END_TEST

/* Two boxes that are one piece: a fold. The way out is across the overlap. */
START_TEST(folds) {
    const double flat[3] = {1, 1, 0.1};
    boxes all;
    memset(&all, 0, sizeof all);
    add_at(&all, 0, 0, 0, flat, 5);
    add_at(&all, 0.3, 0.2, 0.17, flat, 5);
    ck_assert_double_eq_tol(itself_of(&all), 0.03, 1e-12);
    ck_assert_double_le(pieces_of(&all, 1e-4).depth, 0);
    memset(&all, 0, sizeof all);
    add_at(&all, 0, 0, 0, flat, 5);
    add_at(&all, 0.3, 0.2, 0.2001, flat, 5);
    ck_assert_double_le(itself_of(&all), 0);
}
END_TEST

START_TEST(convex_bodies) {
    const double unit[3] = {0.5, 0.5, 0.5}, ground = -0.48;
    gxoverlap_round ball;
    boxes all;
    gxoverlap in;
    memset(&all, 0, sizeof all);
    add_at(&all, 0, 0, 0, unit, 9);
    in = gxoverlap_in_convex(&all.surface, gxoverlap_from_ground, &ground, 1e-6);
    ck_assert_double_eq_tol(in.depth, 0.02, 1e-12);
    ck_assert_uint_eq(in.piece, 9);
    memset(&ball, 0, sizeof ball); /* a ball that is above the middle of a face */
    identity(ball.pose);
    ball.pose[3] = 0.11;
    ball.pose[7] = 0.07;
    ball.pose[11] = 0.7;
    ball.radius = 0.21;
    in = gxoverlap_in_convex(&all.surface, gxoverlap_from_round, &ball, 1e-6);
    ck_assert_double_eq_tol(in.depth, 0.01, 2e-6);
    ck_assert_double_eq_tol(in.position[0], 0.11, 5e-3);
    ball.half[0] = 0.2; /* a capsule along an edge of the block, beside it */
    ball.pose[3] = 0;
    ball.pose[7] = 0.5 + 0.1;
    ball.pose[11] = 0.5 + 0.1;
    ball.radius = sqrt(2.0) * 0.1 + 0.02;
    in = gxoverlap_in_convex(&all.surface, gxoverlap_from_round, &ball, 1e-6);
    ck_assert_double_eq_tol(in.depth, 0.02, 2e-6);
    ball.radius -= 0.03;
    ck_assert_double_le(gxoverlap_in_convex(&all.surface, gxoverlap_from_round, &ball, 1e-6).depth, 0);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("overlap");
    TCase *tc = tcase_create("depths");
    tcase_add_test(tc, known_depths);
    tcase_add_test(tc, edges_cross);
    tcase_add_test(tc, turned_boxes);
    tcase_add_test(tc, folds);
    tcase_add_test(tc, convex_bodies);
    tcase_set_timeout(tc, 60);
    suite_add_tcase(s, tc);
    return s;
}

int main(void) { return run_suite(suite()); }
