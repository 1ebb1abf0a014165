/* Tests of gxfem_boolean.h: exact numbers, predicates against exact rationals, the cell complex against its own
   invariants. GXFEM_DATA: a data folder; the cases in its folder predicates/ are used where it is set. */
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"

#include "predicate_cases.h"

#include "runner.h"
#include "scarce.h"
#include <stdio.h>

static uint64_t current_seed;

#define assert_that(condition, ...)                                                                                    \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            printf("%s:%d: seed %lu: ", __FILE__, __LINE__, (unsigned long)current_seed);                              \
            printf(__VA_ARGS__);                                                                                       \
            printf("\n");                                                                                              \
            fflush(stdout);                                                                                            \
        }                                                                                                              \
        ck_assert_msg(condition, "%s", #condition);                                                                    \
    } while (0)

static pc_random seeded(uint64_t seed) {
    current_seed = seed;
    return pc_seeded(seed);
}

/* ==== numbers ==== */

/* A random sum of products of doubles, for the kernel and for the oracle */
static void random_number(pc_random *r, gxb_num *a, big *b) {
    GXB_NUM(p);
    GXB_NUM(q);
    GXB_NUM(t);
    GXB_NUM(s);
    int terms = 1 + (int)pc_below(r, 3), i;
    gxb_num_set(a, 0, 0);
    *b = big_zero();
    for (i = 0; i < terms; i++) {
        const double x = pc_below(r, 3) ? pc_any_double(r) : pc_uniform(r),
                     y = pc_below(r, 3) ? (double)pc_below(r, 100) : pc_uniform(r);
        gxb_num_set(&p, x, 0);
        gxb_num_set(&q, y, 0);
        gxb_num_mul(&t, &p, &q);
        gxb_num_add(&s, a, &t);
        gxbp_num_copy(a, &s, 1);
        *b = big_add(*b, big_mul(big_from_double(x), big_from_double(y)));
    }
}

static int same_number(const gxb_num *a, big b) {
    int64_t k;
    if (a->sign != b.sign) return 0;
    if (a->sign == 0) return a->n == 0;
    if (a->n == 0 || a->d[0] == 0 || a->d[a->n - 1] == 0) return 0; /* trimmed */
    for (k = 32 * (int64_t)rat_min(b.exponent, a->exp * (GXB_LIMB_BITS / 32)); k < 32 * (int64_t)(big_top(b) + 4);
         k += 32) {
        const int32_t word = (int32_t)(k / 32), limb = word >> (GXB_LIMB_BITS == 64),
                      high = GXB_LIMB_BITS == 64 ? word & 1 : 0;
        const uint64_t value = gxbp_num_limb(a, limb);
        if ((uint32_t)(value >> (high ? 32 : 0)) != big_limb(b, word)) return 0;
    }
    return 1;
}

/* limbs times 2^power */
static big big_of_limbs(const gxb_limb *limb, uint32_t count, int power) {
    big sum = big_zero();
    uint32_t i, half;
    for (i = 0; i < count; i++)
        for (half = 0; half < GXB_LIMB_BITS / 32; half++) {
            const double word = (double)(uint32_t)((uint64_t)limb[i] >> 32 * half);
            sum = big_add(sum, big_scale(big_from_double(word), power + (int)(i * GXB_LIMB_BITS + 32 * half)));
        }
    return sum;
}

START_TEST(numbers_are_exact) {
    pc_random r = seeded((uint64_t)_i + 1);
    int i;
    for (i = 0; i < 20000; i++) {
        const rat_mark mark = rat_arena_mark();
        GXB_NUM(a);
        GXB_NUM(b);
        GXB_NUM(c);
        big x, y;
        random_number(&r, &a, &x);
        random_number(&r, &b, &y);
        if (pc_below(&r, 8) == 0) {
            gxbp_num_copy(&b, &a, pc_below(&r, 2) ? 1 : -1);
            y = x;
            y.sign = b.sign;
        }
        assert_that(same_number(&a, x), "case %d", i);
        gxb_num_add(&c, &a, &b);
        assert_that(same_number(&c, big_add(x, y)), "sum, case %d", i);
        gxb_num_sub(&c, &a, &b);
        assert_that(same_number(&c, big_sub(x, y)), "difference, case %d", i);
        gxb_num_mul(&c, &a, &b);
        assert_that(same_number(&c, big_mul(x, y)), "product, case %d", i);
        rat_arena_release(mark);
    }
}
END_TEST

START_TEST(numbers_become_doubles) {
    pc_random r = seeded((uint64_t)_i + 1);
    int i, power_a, power_b;
    for (i = 0; i < 20000; i++) {
        const rat_mark mark = rat_arena_mark();
        GXB_NUM(a);
        GXB_NUM(b);
        big x, y, error;
        double d;
        random_number(&r, &a, &x);
        random_number(&r, &b, &y);
        big_frexp(x, &power_a);
        big_frexp(y, &power_b);
        if (x.sign != 0 && power_a > -1000 && power_a < 1000) {
            d = gxb_num_to_double(&a);
            error = big_sub(big_from_double(d), x);
            assert_that(big_compare_abs(error, big_scale(x, -52)) <= 0, "case %d: %a", i, d);
        }
        if (x.sign != 0 && y.sign != 0 && power_a - power_b > -990 && power_a - power_b < 990) {
            d = gxb_num_ratio(&a, &b);
            error = big_sub(big_mul(big_from_double(d), y), x);
            assert_that(big_compare_abs(error, big_scale(x, -50)) < 0, "case %d: ratio %a", i, d);
        }
        rat_arena_release(mark);
    }
}
END_TEST

/* A number from 0 to 1: any, 0, 1, or near one that is given */
static gxb_fixed random_fixed(pc_random *r, const gxb_fixed *near) {
    const uint32_t top = GXB_FIXED_LIMBS - 1, kind = pc_below(r, 8);
    gxb_fixed x;
    uint32_t i;
    memset(&x, 0, sizeof x);
    if (kind == 0) return x;
    x.d[top] = (gxb_limb)1 << (GXB_FIXED_BITS % GXB_LIMB_BITS);
    if (kind == 1) return x;
    if (kind < 5 && near != NULL) { /* with other low bits */
        x = *near;
        for (i = pc_below(r, GXB_FIXED_LIMBS); i < GXB_FIXED_LIMBS; i++) {
            x.d[0] ^= (gxb_limb)pc_below(r, 4);
            if (i < top) x.d[i] ^= (gxb_limb)pc_next(r);
        }
        return x;
    }
    for (i = 0; i <= top; i++) x.d[i] = (gxb_limb)pc_next(r);
    x.d[top] &= ((gxb_limb)1 << (GXB_FIXED_BITS % GXB_LIMB_BITS)) - 1;
    return x;
}

START_TEST(determinants_of_fixed_numbers) {
    pc_random r = seeded((uint64_t)_i + 1);
    int i;
    for (i = 0; i < 10000; i++) {
        const rat_mark mark = rat_arena_mark();
        gxb_fixed x[4][3];
        big v[4][3], cross[3], det;
        uint32_t n, k;
        double d;
        for (n = 0; n < 4; n++)
            for (k = 0; k < 3; k++) {
                x[n][k] = random_fixed(&r, n == 0 ? NULL : &x[pc_below(&r, n)][k]);
                v[n][k] = big_of_limbs(x[n][k].d, GXB_FIXED_LIMBS, -GXB_FIXED_BITS);
            }
        for (n = 1; n < 4; n++)
            for (k = 0; k < 3; k++) v[n][k] = big_sub(v[n][k], v[0][k]);
        big_cross(v[2], v[3], cross);
        det = big_dot(v[1], cross);
        d = gxb_fixed_determinant(x[0], x[1], x[2], x[3]);
        assert_that(big_compare_abs(big_sub(big_from_double(d), det), big_scale(det, -51)) <= 0, "case %d: %a", i, d);
        rat_arena_release(mark);
    }
}
END_TEST

/* 2^power */
static void power_of_two(gxb_num *a, int power) {
    GXB_NUM(b);
    GXB_NUM(c);
    gxb_num_set(&b, 1, power / 2);
    gxb_num_set(&c, 1, power - power / 2);
    gxb_num_mul(a, &b, &c);
}

/* What no double holds becomes 0 or infinity, a quotient 0 or a number as large. */
START_TEST(numbers_beyond_doubles) {
    const double infinity = pc_from_bits(UINT64_C(0x7ff0000000000000));
    GXB_NUM(a);
    GXB_NUM(b);
    GXB_NUM(c);
    power_of_two(&a, 1100);
    power_of_two(&b, -1100);
    gxb_num_set(&c, 0, 0);
    ck_assert(gxb_num_to_double(&a) == infinity && gxb_num_to_double(&b) == 0 && gxb_num_to_double(&c) == 0);
    ck_assert(gxb_num_ratio(&b, &a) == 0 && gxb_num_ratio(&c, &a) == 0);
    ck_assert(gxb_num_ratio(&a, &b) >= 0x1p1000 && gxb_num_ratio(&a, &b) < infinity);
    gxb_num_sub(&c, &b, &a);
    ck_assert(gxb_num_to_double(&c) == -infinity && gxb_num_ratio(&c, &b) <= -0x1p1000);
}
END_TEST

/* A coordinate of the frame with all the bits that it may have: 2^-180 to 2^129 */
static void widest_coordinate(pc_random *r, gxb_num *x) {
    GXB_NUM(high);
    GXB_NUM(low);
    gxb_num_set(&high, (pc_below(r, 2) ? 1 : -1) * (2 - ldexp((double)(1 + pc_below(r, 4)), -52)), 128);
    gxb_num_set(&low, 1 + ldexp((double)(1 + 2 * pc_below(r, 1000)), -52), -128);
    if (pc_below(r, 8) == 0) high.sign = 0, high.exp = 0, high.n = 0;
    gxb_num_add(x, &high, &low);
}

static void widest_point(pc_random *r, gxbp_vec *p) {
    int k;
    gxbp_vec_init(p);
    for (k = 0; k < 3; k++) widest_coordinate(r, &p->c[k]);
    gxb_num_set(&p->c[3], 1, 0);
}

/* Products have the limbs of their factors, sums one more than the longer summand, before zeros are trimmed off. */
static void check_room(const gxb_num *c, int count, size_t room, const char *what) {
    int k;
    for (k = 0; k < count; k++) assert_that(c[k].n + 1 <= room, "%s: %u limbs", what, c[k].n);
}

/* The longest numbers by which points and planes are made fit into their room. */
START_TEST(numbers_have_room) {
    pc_random r = seeded(1);
    gxbp_large plane[3], line, point, cross, side;
    const size_t room = sizeof((gxbp_vec *)0)->limbs[0] / sizeof(gxb_limb), large = GXB_NUM_LIMBS;
    int i, k;
    for (i = 0; i < 2000; i++) {
        gxbp_vec p[3], rounded;
        for (k = 0; k < 3; k++) {
            widest_point(&r, &p[0]);
            widest_point(&r, &p[1]);
            widest_point(&r, &p[2]);
            gxbp_large_init(&plane[k]);
            gxbp_exact_plane(plane[k].c, p[0].c, p[1].c, p[2].c);
            check_room(plane[k].c, 4, room, "a plane");
        }
        gxbp_large_init(&line);
        gxbp_exact_line_plane(line.c, p[0].c, p[1].c, plane[0].c);
        check_room(line.c, 4, room, "a line and a plane");
        gxbp_large_init(&cross);
        gxbp_num_cross(cross.c, plane[0].c, plane[1].c);
        check_room(cross.c, 3, room, "a line's direction");
        gxbp_large_init(&point);
        gxbp_exact_three_planes(point.c, plane[0].c, plane[1].c, plane[2].c);
        check_room(point.c, 4, room, "three planes");
        gxbp_large_init(&side);
        gxbp_exact_side(&side.c[0], point.c, plane[0].c);
        ck_assert_int_eq(side.c[0].sign, 0); /* it is in its plane */
        for (k = 0; k < 3; k++) widest_point(&r, &p[k]);
        gxbp_exact_plane(plane[0].c, p[0].c, p[1].c, p[2].c);
        gxbp_exact_side(&side.c[0], point.c, plane[0].c);
        check_room(side.c, 1, large, "a side");
        ck_assert_int_eq(gxbp_orient_exact(point.c, line.c, point.c, 0, 1), 0);
        gxbp_vec_init(&rounded);
        for (k = 0; k < 3; k++) gxbp_num_copy(&rounded.c[k], &point.c[k], 1);
        for (k = 0; k < 3; k++) {
            gxbp_num_divide(&side.c[k], &rounded.c[k], &point.c[3], 4);
            check_room(&rounded.c[k], 1, room, "a remainder");
            check_room(&side.c[k], 1, 32, "a quotient");
        }
    }
}
END_TEST

/* A quotient whose second digit lies far below the first has no more bits than others, and is as exact. */
START_TEST(quotients_are_short) {
    GXB_NUM(one);
    GXB_NUM(tiny);
    GXB_NUM(sum);
    GXB_NUM(three);
    GXB_NUM(quotient);
    int gap;
    gxb_num_set(&one, 1, 0);
    gxb_num_set(&three, 3, 0);
    for (gap = 10; gap < 900; gap += 10) {
        GXB_NUM(product);
        GXB_NUM(error);
        GXB_NUM(bound);
        gxb_num_set(&tiny, 1, -gap);
        gxb_num_add(&sum, &three, &tiny);
        gxb_num_add(&product, &three, &tiny);
        gxbp_num_divide(&quotient, &sum, &three, 4); /* 1 + 2^-gap / 3 */
        ck_assert_uint_le(quotient.n * GXB_LIMB_BITS, 250 + 2 * GXB_LIMB_BITS);
        gxb_num_mul(&sum, &quotient, &three);
        gxb_num_sub(&error, &sum, &product);
        gxb_num_set(&bound, 3, -180);
        assert_that(gxbp_num_compare_magnitude(&error, &bound) < 0 || error.sign == 0, "gap %d", gap);
    }
}
END_TEST

START_TEST(numbers_take_a_shift) {
    pc_random r = seeded(1);
    int i;
    for (i = 0; i < 20000; i++) {
        const rat_mark mark = rat_arena_mark();
        const double x = pc_any_double(&r);
        const int shift = (int)pc_below(&r, 2001) - 1000;
        GXB_NUM(a);
        gxb_num_set(&a, x, shift);
        assert_that(same_number(&a, big_mul(big_from_double(x), big_from_double(pc_power(shift)))), "%a 2^%d", x,
                    shift);
        rat_arena_release(mark);
    }
}
END_TEST

/* ==== predicates ==== */

static void print_doubles(const double *x, int count) {
    int i;
    for (i = 0; i < count; i++) printf(" %a", x[i]);
    printf("\n");
}

START_TEST(predicates_have_the_right_sign) {
    pc_random r = seeded((uint64_t)_i + 1);
    double worst[PC_BOUNDS] = {0, 0, 0, 0};
    int i, kind;
    for (i = 0; i < 8000; i++) {
        const rat_mark mark = rat_arena_mark();
        pc_case c;
        pc_exact e;
        pc_objects k;
        do pc_generate(&r, &c);
        while (!pc_answer(&c, i % 3, &e));
        pc_build(&c, i % 3, &k);
        for (kind = 0; kind < PC_KINDS; kind++) {
            if (e.sign[kind] == PC_INVALID || pc_call(&k, kind) == e.sign[kind]) continue;
            print_doubles((const double *)&c, PC_CASE_DOUBLES);
            assert_that(0, "%s, axis %d: %d instead of %d", pc_kind_names[kind], i % 3, pc_call(&k, kind),
                        e.sign[kind]);
        }
        pc_bound_shares(&k, &e, worst);
        rat_arena_release(mark);
    }
    for (i = 0; i < PC_BOUNDS; i++)
        assert_that(worst[i] < 0.1, "%s: %g of the bound used", pc_bound_names[i], worst[i]);
}
END_TEST

/* ---- inherited errors: true values are moved to the corners of the filter's error boxes, to check that its bounds
   cover them ---- */

/* A multiple of 2^-20, so that adding errors of 2^-20 and more is exact. */
static double grid(pc_random *r) { return (double)((int32_t)pc_below(r, 1 << 21) - (1 << 20)) / 1048576; }
static double grid_error(pc_random *r) { return pc_below(r, 4) == 0 ? 0 : pc_power(-(int)pc_below(r, 15) - 6); }

/* x + a corner of the cube of that error */
static void true_vector(pc_random *r, const double x[3], double error, big out[3]) {
    int k;
    for (k = 0; k < 3; k++) out[k] = big_from_double(x[k] + error * ((int)pc_below(r, 3) - 1));
}

typedef struct true_plane {
    gxb_plane_filter f;
    big n[3], base[3];
} true_plane;

static void random_true_plane(pc_random *r, true_plane *p) {
    int k;
    for (k = 0; k < 3; k++) {
        p->f.n[k] = grid(r);
        p->f.base[k] = grid(r);
    }
    p->f.error = grid_error(r);
    p->f.base_error = grid_error(r);
    p->f.norm = gxbp_max3(p->f.n);
    true_vector(r, p->f.n, p->f.error, p->n);
    true_vector(r, p->f.base, p->f.base_error, p->base);
}

/* about the origin 0 */
static pc_plane as_exact_plane(const true_plane *p) {
    pc_plane e;
    memcpy(e.n, p->n, sizeof e.n);
    e.d = big_dot(p->n, p->base);
    return e;
}

static void random_true_ball(pc_random *r, gxb_ball *ball, big x[3]) {
    int k;
    for (k = 0; k < 3; k++) ball->x[k] = grid(r);
    ball->error = grid_error(r);
    true_vector(r, ball->x, ball->error, x);
}

enum { INHERIT_DIFFERENCE, INHERIT_CROSS, INHERIT_SIDE, INHERIT_LINE, INHERIT_PLANES, INHERITS };

static void inherited_shares(pc_random *r, double worst[INHERITS]) {
    static const double origin[3] = {0, 0, 0};
    true_plane p[3];
    const gxb_plane_filter *f[3];
    pc_plane e[3];
    gxb_ball a, b, ball;
    big xa[3], xb[3], c[3];
    pc_point point;
    double v[3], bound, value;
    int k;
    for (k = 0; k < 3; k++) {
        random_true_plane(r, &p[k]);
        f[k] = &p[k].f;
        e[k] = as_exact_plane(&p[k]);
    }
    random_true_ball(r, &a, xa);
    random_true_ball(r, &b, xb);
    bound = gxbp_filter_difference(v, &a, &b);
    for (k = 0; k < 3; k++)
        pc_worst(&worst[INHERIT_DIFFERENCE], pc_share(v[k], big_zero(), big_sub(xb[k], xa[k]), big_from_int(1), bound));
    bound = gxbp_filter_cross(v, p[0].f.n, p[0].f.error, p[1].f.n, p[1].f.error);
    big_cross(p[0].n, p[1].n, c);
    for (k = 0; k < 3; k++) pc_worst(&worst[INHERIT_CROSS], pc_share(v[k], big_zero(), c[k], big_from_int(1), bound));
    value = gxbp_filter_side(&a, f[0], &bound);
    pc_worst(&worst[INHERIT_SIDE], pc_share(value, big_zero(), pc_height(&e[0], xa), big_from_int(1), bound));
    gxbp_filter_line_plane(&ball, &a, &b, f[0]);
    for (k = 0; k < 3; k++)
        point.x[k] = big_sub(big_mul(pc_height(&e[0], xa), xb[k]), big_mul(pc_height(&e[0], xb), xa[k]));
    point.w = big_sub(pc_height(&e[0], xa), pc_height(&e[0], xb));
    pc_ball_share(&ball, &point, origin, &worst[INHERIT_LINE]);
    gxbp_filter_three_planes(&ball, f);
    point = pc_exact_planes(&e[0], &e[1], &e[2]);
    pc_ball_share(&ball, &point, origin, &worst[INHERIT_PLANES]);
}

/* Above 1 a bound is wrong. Far below the observed values (0.5, 0.5, 0.5, 0.07, 0.07) it would be slack, or this
   test blind. */
START_TEST(inherited_errors_stay_within_bounds) {
    pc_random r = seeded((uint64_t)_i + 1);
    double worst[INHERITS] = {0, 0, 0, 0, 0};
    int i;
    for (i = 0; i < 20000; i++) {
        const rat_mark mark = rat_arena_mark();
        inherited_shares(&r, worst);
        rat_arena_release(mark);
    }
    for (i = 0; i < INHERITS; i++) assert_that(worst[i] < 1 && worst[i] > 0.03, "bound %d: %g of it used", i, worst[i]);
    if (getenv("GXFEM_VERBOSE") != NULL)
        for (i = 0; i < INHERITS; i++) printf("bound %d: %.3f of it used\n", i, worst[i]);
}
END_TEST

/* Every pair and triple of kinds of points, in both orders. */
START_TEST(points_of_all_kinds_compare) {
    pc_random r = seeded((uint64_t)_i + 1);
    int n, i, j, k;
    for (n = 0; n < 500; n++) {
        const rat_mark mark = rat_arena_mark();
        pc_case c;
        pc_exact e;
        pc_objects o;
        const gxb_point *p[4];
        const pc_point *q[4];
        gxb_point corner;
        pc_point exact_corner;
        do pc_generate(&r, &c);
        while (!pc_answer(&c, 0, &e) || e.line.w.sign == 0 || e.planes.w.sign == 0 || e.other.w.sign == 0);
        pc_build(&c, 0, &o);
        gxb_point_explicit(&corner, c.plane[0][1]);
        exact_corner = pc_exact_explicit(c.plane[0][1], c.plane[0][0]);
        p[0] = &corner;
        p[1] = &o.line;
        p[2] = &o.planes;
        p[3] = &o.other;
        q[0] = &exact_corner;
        q[1] = &e.line;
        q[2] = &e.planes;
        q[3] = &e.other;
        for (i = 0; i < 4; i++)
            for (j = 0; j < 4; j++)
                for (k = 0; k < 3; k++)
                    assert_that(gxb_compare(p[i], p[j], k) == pc_exact_compare(q[i], q[j], k),
                                "case %d: points %d %d axis %d", n, i, j, k);
        for (i = 0; i < 4; i++)
            for (j = 0; j < 4; j++)
                for (k = 0; k < 4; k++)
                    assert_that(gxb_orient_in_plane(p[i], p[j], p[k], &o.plane[0]) ==
                                    pc_exact_orient(q[i], q[j], q[k], &e.plane[0]),
                                "case %d: points %d %d %d", n, i, j, k);
        for (i = 0; i < 4; i++)
            for (j = 0; j < 4; j++)
                assert_that(gxb_side(p[i], &o.plane[j]) == pc_exact_side(q[i], &e.plane[j]),
                            "case %d: point %d plane %d", n, i, j);
        rat_arena_release(mark);
    }
}
END_TEST

/* Collinear and coplanar up to the last bits, at any power of two that a double has, and doubles of any size side by
   side */
static void any_range_points(pc_random *r, double x[4][3], int n) {
    const int power = (int)pc_below(r, 2090) - 1080, style = (int)pc_below(r, 4);
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) x[i][k] = style == 0 ? pc_any_double(r) : pc_uniform(r);
    if (style == 0) return;
    if (style == 1)
        for (i = 0; i < 4; i++)
            for (k = 0; k < 3; k++) x[i][k] = (double)pc_below(r, 9) - 4;
    for (k = 0; k < 3; k++) {
        const double a = style == 1 ? 2 : 0.3, b = style == 1 ? -1 : 0.9;
        x[3][k] = n == 2 ? x[3][k] : x[0][k] + a * (x[1][k] - x[0][k]) + b * (x[2][k] - x[0][k]);
        if (n == 2) x[2][k] = x[0][k] + a * (x[1][k] - x[0][k]);
    }
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) {
            x[i][k] = ldexp(x[i][k], power);
            if (pc_below(r, 8) == 0 && fabs(x[i][k]) < 1e300) x[i][k] = pc_nudge(x[i][k], (int)pc_below(r, 5) - 2);
        }
}

START_TEST(orient_takes_any_double) {
    pc_random r = seeded((uint64_t)_i + 1);
    int i;
    for (i = 0; i < 10000; i++) {
        const rat_mark mark = rat_arena_mark();
        double x[4][3];
        any_range_points(&r, x, 2);
        if (gxb_orient2d(x[0], x[1], x[2]) != pc_exact_orient2d(x[0], x[1], x[2])) {
            print_doubles(x[0], 9);
            assert_that(0, "orient2d, case %d", i);
        }
        any_range_points(&r, x, 3);
        if (gxb_orient3d(x[0], x[1], x[2], x[3]) != pc_exact_orient3d(x[0], x[1], x[2], x[3])) {
            print_doubles(x[0], 12);
            assert_that(0, "orient3d, case %d", i);
        }
        rat_arena_release(mark);
    }
}
END_TEST

/* Circles and spheres far beyond the range of the filters */
START_TEST(circles_and_spheres_of_any_size) {
    static const double circle[6][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, 0.5}, {0, -1}, {0.5, -1}};
    static const double sphere[7][3] = {{1, 0, 0},     {0, 1, 0}, {-1, 0, 0}, {0, 0, -1},
                                        {0, 0.5, 0.5}, {0, 0, 1}, {0.5, 0, 1}};
    static const int powers[5] = {0, -300, -90, 90, 300};
    int p, i, k, sides[3] = {0, 0, 0};
    for (p = 0; p < 5; p++) {
        double x[7][3];
        for (i = 0; i < 7; i++)
            for (k = 0; k < 2 && i < 6; k++) x[i][k] = ldexp(circle[i][k], powers[p]);
        for (i = 0; i < 3; i++) ck_assert_int_eq(gxb_incircle(x[0], x[1], x[2], x[3 + i]), 1 - i);
        for (i = 0; i < 7; i++)
            for (k = 0; k < 3; k++) x[i][k] = ldexp(sphere[i][k], powers[p]);
        for (i = 0; i < 3; i++) {
            const int side = gxb_insphere(x[0], x[1], x[2], x[3], x[4 + i]);
            if (p == 0) sides[i] = side;
            ck_assert_int_eq(side, sides[i]);
        }
    }
    ck_assert(sides[0] != 0 && sides[1] == 0 && sides[2] == -sides[0]);
}
END_TEST

START_TEST(orientation_is_as_documented) {
    const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0}, above[3] = {0, 0, 1}, below[3] = {0, 0, -1};
    gxb_plane plane;
    gxb_point p;
    ck_assert_int_eq(gxb_orient2d(a, b, c), 1);
    ck_assert_int_eq(gxb_orient3d(a, b, c, below), 1);
    ck_assert_int_eq(gxb_orient3d(a, b, c, above), -1);
    ck_assert_int_eq(gxb_orient3d(a, b, c, c), 0);
    gxb_plane_init(&plane, a, b, c);
    gxb_point_explicit(&p, above);
    ck_assert_int_eq(gxb_side(&p, &plane), 1);
}
END_TEST

/* The format of Shewchuk's published test cases: number, coordinates, sign. */
/* The number of points of the given dimension, and the sign of the predicate that takes them */
static void check_fixture(const char *name, int dimension, int points) {
    const char *folder = getenv("GXFEM_DATA");
    char path[1024];
    double x[5][3];
    int number, sign, i, k, lines = 0;
    FILE *file;
    if (folder == NULL) return;
    snprintf(path, sizeof path, "%s/predicates/%s", folder, name);
    file = fopen(path, "r");
    if (file == NULL) {
        printf("%s: not there\n", path);
        return;
    }
    while (fscanf(file, "%d", &number) == 1) {
        for (i = 0; i < points; i++)
            for (k = 0; k < dimension; k++) ck_assert_int_eq(fscanf(file, "%lf", &x[i][k]), 1);
        ck_assert_int_eq(fscanf(file, "%d", &sign), 1);
        i = points == 3    ? gxb_orient2d(x[0], x[1], x[2])
          : points == 5    ? gxb_insphere(x[0], x[1], x[2], x[3], x[4])
          : dimension == 2 ? gxb_incircle(x[0], x[1], x[2], x[3])
                           : gxb_orient3d(x[0], x[1], x[2], x[3]);
        assert_that(i == sign, "%s line %d: %d", name, number, i);
        lines++;
    }
    fclose(file);
    ck_assert_int_eq(lines, 1000);
}

START_TEST(published_cases) {
    check_fixture("orient2d.txt", 2, 3);
    check_fixture("orient3d.txt", 3, 4);
    check_fixture("incircle.txt", 2, 4);
    check_fixture("insphere.txt", 3, 5);
}
END_TEST

/* ---- winding numbers ---- */

enum { WINDING_TETS = 5 };

static const double unit_tet[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const uint32_t tet_faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}; /* outward */

/* How a tetrahedron winds around p: 0, or its sign inside. *touched: p lies on it. */
static int winding_of_tet(const double x[4][3], const double p[3], int *touched) {
    const int sign = big_sign(big_orient3d(x[0], x[1], x[2], x[3]));
    int k, inside = 1, zero = 0;
    for (k = 0; k < 4; k++) {
        const int s = sign * big_sign(big_orient3d(x[tet_faces[k][0]], x[tet_faces[k][1]], x[tet_faces[k][2]], p));
        if (s > 0) inside = 0;
        if (s == 0) zero = 1;
    }
    if (inside && zero) *touched = 1;
    return inside && !zero ? sign : 0;
}

START_TEST(winding_numbers_count) {
    pc_random r = seeded((uint64_t)_i + 1);
    int n, i, j, k;
    for (n = 0; n < 1500; n++) {
        const rat_mark mark = rat_arena_mark();
        const int lattice = pc_below(&r, 4) != 0;
        double x[WINDING_TETS][4][3], p[3];
        uint32_t triangles[WINDING_TETS][4][3];
        int want = 0, touched = 0, on_surface, got;
        for (i = 0; i < WINDING_TETS; i++) {
            do
                for (j = 0; j < 4; j++)
                    for (k = 0; k < 3; k++) x[i][j][k] = lattice ? (double)pc_below(&r, 5) : pc_uniform(&r);
            while (big_sign(big_orient3d(x[i][0], x[i][1], x[i][2], x[i][3])) == 0);
            for (j = 0; j < 4; j++)
                for (k = 0; k < 3; k++) triangles[i][j][k] = 4 * (uint32_t)i + tet_faces[j][k];
        }
        for (k = 0; k < 3; k++) p[k] = lattice ? (double)pc_below(&r, 9) / 2 : pc_uniform(&r);
        for (i = 0; i < WINDING_TETS; i++) want += winding_of_tet(x[i], p, &touched);
        got = gxb_winding_number(&x[0][0][0], &triangles[0][0][0], 4 * WINDING_TETS, p, &on_surface);
        assert_that((on_surface != 0) == touched, "case %d: on the surface %d instead of %d", n, on_surface, touched);
        assert_that(touched || got == want, "case %d: %d instead of %d", n, got, want);
        rat_arena_release(mark);
    }
}
END_TEST

START_TEST(triangles_without_area_have_no_outside) {
    const double segment[9] = {1, 0, 0, 2, 0, 0, 3, 0, 0}, before[3] = {0, 0, 0}, on[3] = {1.5, 0, 0},
                 after[3] = {4, 0, 0};
    static const uint32_t orders[3][3] = {{0, 1, 2}, {1, 0, 2}, {2, 1, 0}};
    int on_surface, i;
    for (i = 0; i < 3; i++) {
        gxb_winding_number(segment, orders[i], 1, on, &on_surface);
        ck_assert_int_ne(on_surface, 0);
        gxb_winding_number(segment, orders[i], 1, after, &on_surface);
        ck_assert_int_eq(on_surface, 0);
        gxb_winding_number(segment, orders[i], 1, before, &on_surface);
        ck_assert_int_eq(on_surface, 0);
    }
}
END_TEST

/* ==== the complex ==== */

enum { MAX_CUTS = 32, MAX_NODES = 16, MAX_ELEMENTS = 8 };

/* A mesh and the triangles that cut it. */
typedef struct scene {
    double nodes[MAX_NODES][3];
    uint32_t elements[MAX_ELEMENTS][4];
    size_t node_count, element_count;
    double cuts[MAX_CUTS][3][3];
    uint32_t cut_count;
} scene;

static const double cube_nodes[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                        {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
static const uint32_t cube_elements[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                             {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

/* The first `count` of the six tetrahedra around a cube's diagonal; coordinates are x * size + offset, jittered
   unless jitter is 0 */
static void make_mesh(scene *s, pc_random *r, size_t count, double size, double offset, double jitter) {
    size_t i, k;
    s->node_count = 8;
    s->element_count = count;
    for (i = 0; i < 8; i++)
        for (k = 0; k < 3; k++) s->nodes[i][k] = (cube_nodes[i][k] + jitter * pc_uniform(r)) * size + offset;
    memcpy(s->elements, cube_elements, count * sizeof cube_elements[0]);
}

static void make_cuts(scene *s, pc_random *r, uint32_t count, int style, double size, double offset) {
    uint32_t i, j;
    int k;
    s->cut_count = count;
    for (i = 0; i < count; i++) {
        for (j = 0; j < 3; j++)
            for (k = 0; k < 3; k++) {
                const double wide = 1.5 * pc_uniform(r) + 0.5, lattice = ((double)pc_below(r, 9) - 2) / 4;
                s->cuts[i][j][k] = (style == 0 ? wide : lattice) * size + offset;
            }
        /* beside an earlier triangle, or the same, or elsewhere in its plane */
        if (style == 2 && i > 0 && pc_below(r, 2)) {
            const uint32_t other = pc_below(r, i), how = pc_below(r, 3);
            for (j = 0; j < 3; j++)
                for (k = 0; k < 3; k++) {
                    const double *p = s->cuts[other][j], *q = s->cuts[other][(j + 1) % 3];
                    s->cuts[i][j][k] = how == 0 ? p[k]
                                     : how == 1 ? pc_nudge(p[k], (int)pc_below(r, 3) - 1)
                                                : p[k] + (q[k] - p[k]) / 2;
                }
        }
        if (style == 3)
            for (j = 0; j < 3; j++)
                memcpy(s->cuts[i][j], s->nodes[pc_below(r, (uint32_t)s->node_count)], sizeof s->cuts[i][j]);
        if (pc_exact_plane(s->cuts[i], s->cuts[i][0]).n[0].sign == 0 &&
            pc_exact_plane(s->cuts[i], s->cuts[i][0]).n[1].sign == 0 &&
            pc_exact_plane(s->cuts[i], s->cuts[i][0]).n[2].sign == 0)
            i--;
    }
}

static gxb_mesh mesh_of(const scene *s) {
    gxb_mesh mesh;
    mesh.positions = s->nodes[0];
    mesh.node_count = s->node_count;
    mesh.elements = s->elements[0];
    mesh.element_count = s->element_count;
    return mesh;
}

static gxb_complex *open_scene(const scene *s, const gx_allocator *allocator) {
    const gxb_mesh mesh = mesh_of(s);
    gxb_complex *cx = NULL;
    gx_failure failure;
    const gx_result result = gxb_complex_create(&mesh, allocator, &cx, &failure);
    assert_that(result == GX_OK, "create: %d at %lu", (int)result, (unsigned long)failure.index);
    return cx;
}

/* Point ids of the cuts' corners follow the nodes in order: cut c, corner j is point node_count + 3 c + j. */
static uint32_t corner_id(const scene *s, uint32_t cut, uint32_t j) {
    (void)s;
    return 3 * cut + j;
}

typedef struct inserted {
    gxb_triangle triangles[MAX_CUTS];
    uint32_t points[3 * MAX_CUTS];
} inserted;

/* Inserts cut c, as wall c, in every element. */
static gx_result insert_cut(gxb_complex *cx, const scene *s, inserted *in, uint32_t c) {
    gxb_triangle *t = &in->triangles[c];
    gx_result result = GX_OK;
    uint32_t j, e;
    memset(t, 0, sizeof *t);
    for (j = 0; j < 3 && result == GX_OK; j++) {
        result = gxb_complex_add_point(cx, s->cuts[c][j], &t->point[j]);
        in->points[corner_id(s, c, j)] = t->point[j];
    }
    t->label = c;
    t->wall = 1;
    if (result == GX_OK) result = gxb_complex_add_plane(cx, t);
    for (e = 0; e < s->element_count && result == GX_OK; e++) result = gxb_complex_insert(cx, t, e, NULL, NULL);
    gxb_complex_reserve(cx, 1 + c % 3); /* changes nothing, whether memory is left or not */
    return result;
}

static gx_result insert_all(gxb_complex *cx, const scene *s, inserted *in) {
    gx_result result = GX_OK;
    uint32_t c;
    for (c = 0; c < s->cut_count && result == GX_OK; c++) result = insert_cut(cx, s, in, c);
    return result;
}

/* ---- exact geometry of the complex by the oracle, about node 0 ---- */

typedef struct model {
    const scene *s;
    const inserted *in;
    gxb_complex *cx;
    pc_point *points;      /* point_count */
    pc_plane *planes;      /* plane_count */
    double (*position)[3]; /* point_count: rounded, relative to node 0 */
} model;

static const double *explicit_position(const model *m, uint32_t point) {
    uint32_t i;
    if (point < m->s->node_count) return m->s->nodes[point];
    for (i = 0; i < 3 * m->s->cut_count; i++)
        if (m->in->points[i] == point) return m->s->cuts[i / 3][i % 3];
    ck_abort_msg("an explicit point that nobody added");
    return NULL;
}

static pc_plane exact_cplane(const model *m, uint32_t plane) {
    const gxb_cplane *f = &m->cx->store.planes[plane];
    const double *o = m->s->nodes[0];
    double p[3][3];
    pc_plane e;
    int k;
    for (k = 0; k < 2; k++) memcpy(p[k], explicit_position(m, f->def[k]), sizeof p[k]);
    if (!f->along_axis) {
        memcpy(p[2], explicit_position(m, f->def[2]), sizeof p[2]);
        return pc_exact_plane(p, o);
    }
    {
        big a[3], b[3], c[3];
        big_difference(p[1], p[0], a);
        for (k = 0; k < 3; k++) b[k] = big_from_int(k == (int)f->def[2]);
        big_difference(p[0], o, c);
        big_cross(a, b, e.n);
        e.d = big_dot(e.n, c);
        return e;
    }
}

static pc_point exact_cpoint(const model *m, uint32_t point) {
    const gxb_cpoint *p = &m->cx->store.points[point];
    const double *o = m->s->nodes[0];
    double line[2][3];
    if (p->kind == GXB_EXPLICIT) return pc_exact_explicit(explicit_position(m, point), o);
    if (p->kind == GXB_THREE_PLANES)
        return pc_exact_planes(&m->planes[p->def[0]], &m->planes[p->def[1]], &m->planes[p->def[2]]);
    memcpy(line[0], explicit_position(m, p->def[0]), sizeof line[0]);
    memcpy(line[1], explicit_position(m, p->def[1]), sizeof line[1]);
    return pc_exact_line(line, &m->planes[p->def[2]], o);
}

static model open_model(gxb_complex *cx, const scene *s, const inserted *in) {
    model m;
    uint32_t i;
    int k;
    m.s = s;
    m.in = in;
    m.cx = cx;
    m.planes = (pc_plane *)malloc((cx->store.plane_count + 1) * sizeof *m.planes);
    m.points = (pc_point *)malloc((cx->store.point_count + 1) * sizeof *m.points);
    m.position = (double(*)[3])malloc((cx->store.point_count + 1) * sizeof *m.position);
    for (i = 0; i < cx->store.plane_count; i++) m.planes[i] = exact_cplane(&m, i);
    for (i = 0; i < cx->store.point_count; i++) {
        m.points[i] = exact_cpoint(&m, i);
        assert_that(m.points[i].w.sign != 0, "point %u is none", i);
        for (k = 0; k < 3; k++) m.position[i][k] = rat_to_double(rat_ratio(m.points[i].x[k], m.points[i].w));
    }
    return m;
}

static void close_model(model *m) {
    free(m->planes);
    free(m->points);
    free(m->position);
}

/* ---- the invariants ---- */

static uint32_t edge_start(const gxb_complex *cx, uint32_t e) { return cx->edges[e >> 1].v[e & 1]; }

static void add_fan(const model *m, const uint32_t *loop, uint32_t count, double area[3], double *six_volumes) {
    const double *a = m->position[edge_start(m->cx, loop[0])];
    uint32_t i;
    int k;
    for (k = 0; k < 3; k++) area[k] = 0;
    for (i = 1; i + 1 < count; i++) {
        const double *b = m->position[edge_start(m->cx, loop[i])], *c = m->position[edge_start(m->cx, loop[i + 1])];
        double n[3];
        for (k = 0; k < 3; k++) {
            const int p = (k + 1) % 3, q = (k + 2) % 3;
            n[k] = (b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]);
            area[k] += n[k] / 2;
        }
        *six_volumes += n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
    }
}

static double length3(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* A convex polygon in its plane, counter-clockwise about the normal, without divided edges. */
static void check_loop(const model *m, uint32_t facet, const uint32_t *loop, uint32_t count) {
    const gxb_facet *f = &m->cx->facets[facet];
    uint32_t i, turns = 0;
    assert_that(count >= 3, "facet %u has %u edges", facet, count);
    for (i = 0; i < count; i++) {
        const uint32_t e = loop[i], next = loop[(i + 1) % count], last = loop[(i + 2) % count];
        const uint32_t a = edge_start(m->cx, e), b = edge_start(m->cx, next), c = edge_start(m->cx, last);
        const gxb_edge *edge = &m->cx->edges[e >> 1];
        int turn;
        assert_that(edge->child == GXB_NONE, "facet %u: edge %u is divided", facet, e >> 1);
        assert_that(edge->v[1 - (e & 1)] == b, "facet %u is not closed", facet);
        assert_that(pc_exact_side(&m->points[a], &m->planes[f->plane]) == 0, "facet %u: point %u off its plane", facet,
                    a);
        turn = pc_exact_orient(&m->points[a], &m->points[b], &m->points[c], &m->planes[f->plane]);
        assert_that(turn >= 0, "facet %u is not convex", facet);
        assert_that(gxb_complex_turn(m->cx, a, b, c, f->plane) == turn, "facet %u: turn at point %u", facet, b);
        assert_that(gxb_complex_turn(m->cx, c, b, a, f->plane) == -turn, "facet %u: turn back at point %u", facet, b);
        turns += turn > 0;
    }
    assert_that(turns >= 3, "facet %u has %u corners", facet, turns);
}

typedef struct use {
    uint32_t edge, direction;
} use;

static int compare_uses(const void *a, const void *b) {
    const use *p = (const use *)a, *q = (const use *)b;
    if (p->edge != q->edge) return p->edge < q->edge ? -1 : 1;
    return p->direction < q->direction ? -1 : p->direction > q->direction;
}

/* Each edge walked once each way, V - E + F = 2. */
static void check_closed(const model *m, uint32_t leaf, use *uses, uint32_t count, uint32_t facets) {
    unsigned char *seen = (unsigned char *)calloc(m->cx->store.point_count, 1);
    uint32_t i, vertices = 0;
    qsort(uses, count, sizeof *uses, compare_uses);
    assert_that(count % 2 == 0, "leaf %u: %u edge uses", leaf, count);
    for (i = 0; i < count; i += 2) {
        int k;
        assert_that(uses[i].edge == uses[i + 1].edge && uses[i].direction + 1 == uses[i + 1].direction &&
                        (i + 2 >= count || uses[i + 2].edge != uses[i].edge),
                    "leaf %u: edge %u is not used once each way", leaf, uses[i].edge);
        for (k = 0; k < 2; k++) {
            const uint32_t v = m->cx->edges[uses[i].edge].v[k];
            vertices += !seen[v];
            seen[v] = 1;
        }
    }
    assert_that(vertices + facets == count / 2 + 2, "leaf %u: V %u E %u F %u", leaf, vertices, count / 2, facets);
    free(seen);
}

/* All points of the leaf lie behind or on each of its facets as seen from outside. */
static void check_convex(const model *m, uint32_t leaf, const uint32_t *facets, uint32_t count, const use *uses,
                         uint32_t use_count) {
    uint32_t i, j;
    for (i = 0; i < count; i++) {
        const gxb_facet *f = &m->cx->facets[facets[i]];
        const int inward = f->leaf[0] == leaf ? 1 : -1;
        int inside = 0;
        for (j = 0; j < use_count; j += 2) {
            const uint32_t v = m->cx->edges[uses[j].edge].v[0], w = m->cx->edges[uses[j].edge].v[1];
            const int a = inward * pc_exact_side(&m->points[v], &m->planes[f->plane]),
                      b = inward * pc_exact_side(&m->points[w], &m->planes[f->plane]);
            assert_that(a >= 0 && b >= 0, "leaf %u is not convex at facet %u", leaf, facets[i]);
            inside |= a > 0 || b > 0;
        }
        assert_that(inside, "leaf %u is flat", leaf);
    }
}

static uint32_t *copy_list(const gxb_complex *cx, uint32_t first, uint32_t count) {
    uint32_t *list = (uint32_t *)malloc((count + 1) * sizeof *list);
    memcpy(list, cx->pool + first, count * sizeof *list);
    return list;
}

/* Every check of one leaf; returns its volume. */
static double check_leaf(const model *m, uint32_t leaf) {
    gxb_complex *cx = m->cx;
    uint32_t first, count, i, j, uses_count = 0, edge_first, edge_count, *facets;
    use *uses = (use *)malloc(sizeof *uses);
    double six_volumes = 0;
    ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
    facets = copy_list(cx, first, count);
    for (i = 0; i < count; i++) {
        const gxb_facet *f = &cx->facets[facets[i]];
        const uint32_t outside_in = f->leaf[0] == leaf; /* the normal points into the leaf */
        uint32_t *loop;
        double area[3], volume = 0;
        assert_that(f->child == GXB_NONE && (f->leaf[0] == leaf) != (f->leaf[1] == leaf), "facet %u of leaf %u",
                    facets[i], leaf);
        ck_assert_int_eq(gxb_facet_resolve_edges(cx, facets[i], &edge_first, &edge_count), GX_OK);
        loop = copy_list(cx, edge_first, edge_count);
        check_loop(m, facets[i], loop, edge_count);
        uses = (use *)realloc(uses, (uses_count + edge_count + 1) * sizeof *uses);
        for (j = 0; j < edge_count; j++) {
            uses[uses_count].edge = loop[j] >> 1;
            uses[uses_count++].direction = (loop[j] & 1) ^ outside_in;
        }
        add_fan(m, loop, edge_count, area, &volume);
        six_volumes += outside_in ? -volume : volume;
        free(loop);
    }
    check_closed(m, leaf, uses, uses_count, count);
    check_convex(m, leaf, facets, count, uses, uses_count);
    free(facets);
    free(uses);
    return six_volumes / 6;
}

/* Both leaves of a facet list it. */
static void check_neighbours(const model *m) {
    gxb_complex *cx = m->cx;
    uint32_t *listed = (uint32_t *)calloc(cx->facet_count + 1, sizeof *listed), leaf, i, first, count;
    for (leaf = 0; leaf < cx->leaf_count; leaf++) {
        if (cx->leaves[leaf].facet_count == 0) continue;
        ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
        for (i = 0; i < count; i++) listed[cx->pool[first + i]]++;
    }
    for (i = 0; i < cx->facet_count; i++) {
        uint32_t want = 0, k;
        if (cx->facets[i].child != GXB_NONE) {
            ck_assert_uint_eq(listed[i], 0);
            continue;
        }
        for (k = 0; k < 2; k++) {
            leaf = cx->facets[i].leaf[k];
            want += leaf != GXB_NONE && cx->leaves[leaf].facet_count > 0;
            if (cx->facets[i].face != GXB_NONE && leaf != GXB_NONE)
                assert_that(cx->leaves[leaf].element == cx->face_elements[2 * cx->facets[i].face + k],
                            "facet %u: leaf %u", i, leaf);
        }
        assert_that(listed[i] == want, "facet %u is listed %u times instead of %u", i, listed[i], want);
    }
    free(listed);
}

/* Each leaf stands once in its element's tree, on the sides that the tree says. */
static void check_tree(const model *m, uint32_t element, uint32_t reference, uint32_t *seen) {
    const gxb_complex *cx = m->cx;
    if (reference & 1) {
        check_tree(m, element, cx->nodes[reference >> 1].child[0], seen);
        check_tree(m, element, cx->nodes[reference >> 1].child[1], seen);
    } else {
        ck_assert_uint_eq(cx->leaves[reference >> 1].element, element);
        seen[reference >> 1]++;
    }
}

static double element_volume(const model *m, uint32_t e) {
    const uint32_t *v = m->s->elements[e];
    return big_to_double(big_orient3d(m->s->nodes[v[0]], m->s->nodes[v[1]], m->s->nodes[v[2]], m->s->nodes[v[3]])) / 6;
}

/* ---- the area of a triangle in an element: clipped exactly, in homogeneous barycentric coordinates ---- */

typedef struct corner {
    big lambda[4];
} corner; /* times a positive factor of the corner's own */

static corner barycentric(const double nodes[4][3], const double p[3]) {
    const double *x[4];
    corner c;
    int k, j;
    for (k = 0; k < 4; k++) {
        for (j = 0; j < 4; j++) x[j] = j == k ? p : nodes[j];
        c.lambda[k] = big_orient3d(x[0], x[1], x[2], x[3]);
    }
    return c;
}

/* Where the edge from c to d, on different sides of face k, meets it: |d_k| c + |c_k| d, both factors positive. */
static corner cross_face(const corner *c, const corner *d, int k) {
    corner r;
    int j;
    for (j = 0; j < 4; j++)
        r.lambda[j] =
            big_add(big_mul(big_abs(d->lambda[k]), c->lambda[j]), big_mul(big_abs(c->lambda[k]), d->lambda[j]));
    return r;
}

static int clip_to_face(corner *a, int n, int k) {
    corner b[16];
    int i, count = 0;
    for (i = 0; i < n; i++) {
        const corner *c = &a[i], *d = &a[(i + 1) % n];
        if (c->lambda[k].sign >= 0) b[count++] = *c;
        if (c->lambda[k].sign * d->lambda[k].sign < 0) b[count++] = cross_face(c, d, k);
    }
    memcpy(a, b, (size_t)count * sizeof *a);
    return count;
}

/* Rounded once, relative to node 0. */
static void corner_position(const double nodes[4][3], const corner *c, double p[3]) {
    big weight = big_zero();
    int j, k;
    for (j = 0; j < 4; j++) weight = big_add(weight, c->lambda[j]);
    for (k = 0; k < 3; k++) {
        big sum = big_zero();
        for (j = 1; j < 4; j++)
            sum = big_add(sum,
                          big_mul(c->lambda[j], big_sub(big_from_double(nodes[j][k]), big_from_double(nodes[0][k]))));
        p[k] = rat_to_double(rat_ratio(sum, weight));
    }
}

static double area_in_element(const model *m, uint32_t cut, uint32_t element) {
    corner a[16];
    double nodes[4][3], area[3] = {0, 0, 0}, p[16][3];
    int n = 3, k, i;
    for (k = 0; k < 4; k++) memcpy(nodes[k], m->s->nodes[m->s->elements[element][k]], sizeof nodes[k]);
    for (k = 0; k < 3; k++) a[k] = barycentric(nodes, m->s->cuts[cut][k]);
    for (k = 0; k < 4 && n > 0; k++) n = clip_to_face(a, n, k);
    for (i = 0; i < n; i++) corner_position(nodes, &a[i], p[i]);
    for (i = 1; i + 1 < n; i++)
        for (k = 0; k < 3; k++) {
            const int q = (k + 1) % 3, r = (k + 2) % 3;
            area[k] +=
                ((p[i][q] - p[0][q]) * (p[i + 1][r] - p[0][r]) - (p[i][r] - p[0][r]) * (p[i + 1][q] - p[0][q])) / 2;
        }
    return length3(area);
}

static const gxb_label *find_label(const gxb_complex *cx, uint32_t facet, uint32_t triangle) {
    uint32_t l;
    for (l = cx->facets[facet].labels; l != GXB_NONE; l = cx->labels[l].next)
        if (cx->labels[l].triangle == triangle) return &cx->labels[l];
    return NULL;
}

/* The facets with the cut's label lie in its plane, face its way, are walls, and have its area in every element. */
static void check_walls(const model *m, uint32_t cut) {
    gxb_complex *cx = m->cx;
    const pc_plane own = pc_exact_plane(m->s->cuts[cut], m->s->nodes[0]);
    double found[MAX_ELEMENTS] = {0}, scale = 0;
    uint32_t i, k, e, first, count;
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_label *label = cx->facets[i].child == GXB_NONE ? find_label(cx, i, cut) : NULL;
        double area[3], volume = 0;
        uint32_t *loop, elements[2];
        if (label == NULL) continue;
        assert_that(cx->facets[i].wall == 1, "facet %u is no wall", i);
        assert_that(big_sign(big_dot(own.n, m->planes[cx->facets[i].plane].n)) == label->orientation,
                    "facet %u, cut %u: orientation", i, cut);
        ck_assert_int_eq(gxb_facet_resolve_edges(cx, i, &first, &count), GX_OK);
        loop = copy_list(cx, first, count);
        for (k = 0; k < count; k++)
            assert_that(pc_exact_side(&m->points[edge_start(cx, loop[k])], &own) == 0, "facet %u off cut %u", i, cut);
        add_fan(m, loop, count, area, &volume);
        for (k = 0; k < 2; k++)
            elements[k] = cx->facets[i].leaf[k] == GXB_NONE ? GXB_NONE : cx->leaves[cx->facets[i].leaf[k]].element;
        if (elements[0] != GXB_NONE) found[elements[0]] += length3(area);
        if (elements[1] != GXB_NONE && elements[1] != elements[0]) found[elements[1]] += length3(area);
        free(loop);
    }
    for (e = 0; e < m->s->element_count; e++) {
        const double volume = element_volume(m, e), want = area_in_element(m, cut, e);
        scale = pow(volume, 2.0 / 3);
        assert_that(fabs(found[e] - want) <= 1e-12 * scale, "cut %u in element %u: area %.17g instead of %.17g", cut, e,
                    found[e], want);
    }
}

/* Pairs of doubles tell the right side, or none. */
enum { UNTOLD = 2 }; /* as the header has it */
static void check_pair_side(const model *m, uint32_t point, uint32_t plane) {
    const gxb_cpoint *p = &m->cx->store.points[point];
    const int sign = p->kind == GXB_EXPLICIT   ? UNTOLD
                   : p->kind == GXB_LINE_PLANE ? gxbp_pair_line_side(m->cx, p->def, plane)
                                               : gxbp_pair_planes_side(m->cx, p->def, plane);
    assert_that(sign == UNTOLD || sign == pc_exact_side(&m->points[point], &m->planes[plane]),
                "by pairs: point %u plane %u", point, plane);
}

/* The kernel's signs of all points and planes against the oracle's. */
static void check_signs(const model *m, pc_random *r, int count) {
    int i;
    for (i = 0; i < count; i++) {
        const uint32_t point = pc_below(r, m->cx->store.point_count), plane = pc_below(r, m->cx->store.plane_count),
                       axis = pc_below(r, 3);
        const uint32_t node = pc_below(r, (uint32_t)m->s->node_count);
        const pc_point x = pc_exact_explicit(m->s->nodes[node], m->s->nodes[0]);
        assert_that(gxb_complex_side(m->cx, point, plane) == pc_exact_side(&m->points[point], &m->planes[plane]),
                    "point %u plane %u", point, plane);
        check_pair_side(m, point, plane);
        assert_that(gxb_complex_compare(m->cx, point, (int)axis, m->s->nodes[node][axis]) ==
                        pc_exact_compare(&m->points[point], &x, (int)axis),
                    "point %u against node %u on axis %u", point, node, axis);
    }
}

/* Barycentric coordinates of the points of an element's leaves. */
static void check_barycentric(const model *m, uint32_t element) {
    gxb_complex *cx = m->cx;
    const uint32_t *v = m->s->elements[element];
    uint32_t leaf, first, count, i, k, j;
    for (leaf = 0; leaf < cx->leaf_count; leaf++) {
        if (cx->leaves[leaf].element != element || cx->leaves[leaf].facet_count == 0) continue;
        ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
        for (i = 0; i < count; i++) {
            const uint32_t point = edge_start(cx, cx->pool[cx->facets[cx->pool[first + i]].loop]);
            double lambda[4];
            gxb_fixed fixed[4];
            gxbp_vec fine;
            gxbp_vec_init(&fine);
            gxb_complex_barycentric_fixed(cx, point, element, fixed);
            gxb_complex_barycentric(cx, point, element, lambda);
            gxb_complex_barycentric_fine(cx, point, element, fine.c);
            for (k = 0; k < 4; k++) {
                double face[3][3];
                pc_plane plane;
                big num, den, error, q;
                for (j = 0; j < 3; j++) memcpy(face[j], m->s->nodes[v[tet_faces[k][j]]], sizeof face[j]);
                plane = pc_exact_plane(face, m->s->nodes[0]);
                num = pc_scaled_height(&m->points[point], &plane);
                den = big_mul(pc_height(&plane, pc_exact_explicit(m->s->nodes[v[k]], m->s->nodes[0]).x),
                              m->points[point].w);
                error = big_sub(big_mul(big_from_double(lambda[k]), den), num);
                assert_that(big_compare_abs(error, big_scale(num, -49)) <= 0, "point %u element %u lambda %u = %a",
                            point, element, k, lambda[k]);
                q = big_of_limbs(fine.c[k].d, fine.c[k].n, fine.c[k].exp * GXB_LIMB_BITS);
                q.sign = q.sign == 0 ? 0 : fine.c[k].sign;
                error = big_sub(big_mul(q, den), num);
                assert_that(big_compare_abs(error, big_scale(num, -180)) <= 0, "point %u element %u: fine lambda %u",
                            point, element, k);
                q = big_of_limbs(fixed[k].d, GXB_FIXED_LIMBS, -GXB_FIXED_BITS);
                error = big_sub(big_mul(q, den), num);
                assert_that(big_compare_abs(error, big_scale(den, -179)) <= 0, "point %u element %u: fixed lambda %u",
                            point, element, k);
            }
        }
    }
}

/* All invariants of a complex, whatever was inserted */
static void check_complex(gxb_complex *cx, const scene *s, const inserted *in, pc_random *r) {
    const rat_mark mark = rat_arena_mark();
    model m = open_model(cx, s, in);
    double volume[MAX_ELEMENTS] = {0};
    uint32_t *seen = (uint32_t *)calloc(cx->leaf_count + 1, sizeof *seen), i, touched[MAX_ELEMENTS] = {0};
    for (i = 0; i < cx->leaf_count; i++) {
        const uint32_t e = cx->leaves[i].element;
        double v;
        if (cx->leaves[i].facet_count == 0) continue;
        v = check_leaf(&m, i);
        assert_that(v > -1e-14 * element_volume(&m, e), "leaf %u has volume %g", i, v);
        volume[e] += v;
        touched[e] = 1;
    }
    check_neighbours(&m);
    for (i = 0; i < s->element_count; i++) {
        const double want = element_volume(&m, i);
        check_tree(&m, i, cx->root[i], seen);
        if (!touched[i]) continue;
        assert_that(fabs(volume[i] - want) <= 1e-12 * want, "element %u: volume %.17g instead of %.17g", i, volume[i],
                    want);
    }
    for (i = 0; i < cx->leaf_count; i++) assert_that(seen[i] == 1, "leaf %u stands %u times in the tree", i, seen[i]);
    for (i = 0; i < s->cut_count; i++) check_walls(&m, i);
    check_signs(&m, r, 50);
    if (touched[0]) check_barycentric(&m, 0);
    free(seen);
    close_model(&m);
    rat_arena_release(mark);
}

static void run_scene(const scene *s, pc_random *r) {
    memory m = plenty();
    const gx_allocator allocator = allocator_of(&m);
    gxb_complex *cx;
    inserted in;
    gx_result result;
    cx = open_scene(s, &allocator);
    gxb_complex_begin(cx);
    result = insert_all(cx, s, &in);
    assert_that(result == GX_OK, "insert: %d", (int)result);
    gxb_complex_commit(cx);
    check_complex(cx, s, &in, r);
    gxb_complex_destroy(cx);
    ck_assert(is_whole(&m));
}

/* ---- tests of the complex ---- */

START_TEST(random_cuts_conform) {
    int round;
    for (round = 0; round < 6; round++) {
        pc_random r = seeded((uint64_t)(6 * _i + round) + 1);
        scene s;
        make_mesh(&s, &r, 1 + pc_below(&r, 6), 1, 0, 0.1);
        make_cuts(&s, &r, 1 + pc_below(&r, 8), 0, 1, 0);
        run_scene(&s, &r);
    }
}
END_TEST

/* style 1: lattice; 2: coincident, coplanar and one ulp apart; 3: through nodes, along edges and in faces of the mesh
 */
START_TEST(degenerate_cuts_conform) {
    int style;
    for (style = 1; style <= 3; style++) {
        int round;
        for (round = 0; round < 4; round++) {
            pc_random r = seeded((uint64_t)(100 * style + 4 * _i + round) + 1);
            scene s;
            make_mesh(&s, &r, 1 + pc_below(&r, 6), 1, 0, style == 3 && pc_below(&r, 2) ? 0.1 : 0);
            make_cuts(&s, &r, 1 + pc_below(&r, 10), style, 1, 0);
            run_scene(&s, &r);
        }
    }
}
END_TEST

/* Far from the origin, tiny and huge, and with corners whose difference from the origin is not a double */
START_TEST(far_and_scaled_meshes_conform) {
    static const double sizes[6] = {1, 0x1p-20, 0x1p20, 1e-3, 0x1p-100, 0x1p100},
                        offsets[6] = {1048576, 1, 1e8, -1e6, 0, 0};
    pc_random r = seeded((uint64_t)_i + 1);
    scene s;
    int k;
    make_mesh(&s, &r, 6, sizes[_i], offsets[_i], 0);
    make_cuts(&s, &r, 4, 2, sizes[_i], offsets[_i]);
    run_scene(&s, &r);
    make_mesh(&s, &r, 6, sizes[_i], offsets[_i], 0.1);
    make_cuts(&s, &r, 4, 0, sizes[_i], offsets[_i]);
    run_scene(&s, &r);
    for (k = 0; k < 3; k++) s.cuts[1][0][k] = sizes[_i] * 1e-25 * (k + 1);
    run_scene(&s, &r);
}
END_TEST

/* Seen from a mesh at 2^20, a corner at 1e-25 is not a double, and every sign depends on that rest. */
START_TEST(rests_below_the_last_bit_count) {
    pc_random r = seeded((uint64_t)_i + 1);
    const double tiny[6] = {0, 1e-25, -1e-25, 2e-25, 0x1p-90, -0x1p-90};
    scene s;
    inserted in;
    gxb_complex *cx;
    model m;
    const rat_mark mark = rat_arena_mark();
    uint32_t c, i, j, undecided = 0;
    make_mesh(&s, &r, 6, 1, 1048576, 0);
    s.cut_count = 4;
    for (c = 0; c < s.cut_count; c++) do
            for (i = 0; i < 3; i++) {
                for (j = 0; j < 3; j++) s.cuts[c][i][j] = (double)pc_below(&r, 3);
                s.cuts[c][i][c % 3] = tiny[pc_below(&r, 6)];
            }
        while (gxb_orient2d(s.cuts[c][0] + (c % 3 == 0), s.cuts[c][1] + (c % 3 == 0), s.cuts[c][2] + (c % 3 == 0)) ==
               0);
    cx = open_scene(&s, NULL);
    ck_assert_int_eq(insert_all(cx, &s, &in), GX_OK);
    m = open_model(cx, &s, &in);
    for (i = 0; i < cx->store.point_count; i++)
        for (j = 0; j < cx->store.plane_count; j++) {
            const int want = pc_exact_side(&m.points[i], &m.planes[j]);
            assert_that(gxb_complex_side(cx, i, j) == want, "point %u plane %u: not %d", i, j, want);
            undecided += want == 0;
        }
    for (c = 0; c < s.cut_count; c++)
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3; j++) {
                const double value = tiny[pc_below(&r, 6)], x = s.cuts[c][i][j];
                assert_that(gxb_complex_compare(cx, in.triangles[c].point[i], (int)j, value) ==
                                (x > value) - (x < value),
                            "cut %u corner %u", c, i);
            }
    ck_assert_uint_gt(undecided, 0);
    close_model(&m);
    gxb_complex_destroy(cx);
    rat_arena_release(mark);
}
END_TEST

/* Exact moves and scalings by powers of two leave the topology as it is. */
static uint64_t mix(uint64_t hash, uint64_t value) { return (hash ^ value) * UINT64_C(1099511628211) ^ (hash >> 29); }

/* Hash of everything that a transaction may change, except caches; geometry 0: only the topology */
static uint64_t hash_complex(const gxb_complex *cx, int geometry) {
    uint64_t h = 7;
    uint32_t i, j;
    h = mix(h, cx->store.point_count);
    h = mix(h, cx->store.plane_count);
    h = mix(h, cx->edge_count);
    h = mix(h, cx->facet_count);
    h = mix(h, cx->leaf_count);
    h = mix(h, cx->tree_count);
    h = mix(h, cx->label_count);
    for (i = 0; i < cx->store.point_count; i++) {
        const gxb_cpoint *p = &cx->store.points[i];
        h = mix(mix(h, p->kind), p->wall);
        for (j = 0; j < 3; j++) {
            h = mix(h, p->def[j]);
            if (geometry) h = mix(h, pc_bits(p->ball.x[j]));
        }
        if (geometry) h = mix(h, pc_bits(p->ball.error));
    }
    for (i = 0; i < cx->store.plane_count; i++) {
        const gxb_cplane *p = &cx->store.planes[i];
        h = mix(mix(mix(h, p->along_axis), p->axis), (uint32_t)p->axis_sign);
        for (j = 0; j < 3; j++) {
            h = mix(h, p->def[j]);
            if (geometry) h = mix(h, pc_bits(p->filter.n[j]));
        }
    }
    for (i = 0; i < cx->edge_count; i++) {
        const gxb_edge *e = &cx->edges[i];
        h = mix(mix(mix(mix(mix(mix(mix(h, e->v[0]), e->v[1]), e->line[0]), e->line[1]), e->explicit_line), e->child),
                e->wall);
    }
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        h = mix(mix(mix(mix(mix(mix(mix(h, f->plane), f->leaf[0]), f->leaf[1]), f->child), f->labels), f->face),
                f->wall);
        if (f->child == GXB_NONE)
            for (j = 0; j < f->loop_count; j++) h = mix(h, cx->pool[f->loop + j]);
        else if (f->face == GXB_NONE)
            h = mix(h, f->loop); /* the plane that divided it */
    }
    for (i = 0; i < cx->leaf_count; i++) {
        const gxb_leaf *l = &cx->leaves[i];
        h = mix(mix(mix(h, l->element), l->parent), l->removed);
        for (j = 0; j < l->facet_count; j++) h = mix(h, cx->pool[l->facets + j]);
    }
    for (i = 0; i < cx->tree_count; i++)
        h = mix(mix(mix(mix(h, cx->nodes[i].plane), cx->nodes[i].child[0]), cx->nodes[i].child[1]), cx->nodes[i].facet);
    for (i = 0; i < cx->label_count; i++)
        h = mix(mix(mix(h, cx->labels[i].triangle), (uint32_t)cx->labels[i].orientation), cx->labels[i].next);
    for (i = 0; i < cx->element_count; i++) h = mix(h, cx->root[i]);
    for (i = 0; i < cx->face_count; i++) h = mix(h, cx->face_facet[i]);
    for (i = 0; i < cx->mesh_edge_count; i++) h = mix(h, cx->mesh_edge[i]);
    return h;
}

static uint64_t topology_of(const scene *s) {
    inserted in;
    gxb_complex *cx = open_scene(s, NULL);
    uint64_t h;
    ck_assert_int_eq(insert_all(cx, s, &in), GX_OK);
    h = hash_complex(cx, 0);
    gxb_complex_destroy(cx);
    return h;
}

START_TEST(topology_is_the_same_moved_and_scaled) {
    static const double factors[5] = {1, 0x1p-40, 0x1p60, 0x1p-900, 0x1p500},
                        offsets[5] = {1048576, 0, 67108864, 0, -16777216};
    pc_random r = seeded((uint64_t)_i + 1);
    scene s;
    uint64_t first;
    int k;
    size_t i;
    make_mesh(&s, &r, 6, 1, 0, 0);
    make_cuts(&s, &r, 6, 1, 1, 0);
    first = topology_of(&s);
    for (k = 0; k < 5; k++) {
        scene t = s;
        for (i = 0; i < 3 * t.node_count; i++)
            t.nodes[i / 3][i % 3] = (t.nodes[i / 3][i % 3] + offsets[k]) * factors[k];
        for (i = 0; i < 9 * t.cut_count; i++)
            t.cuts[i / 9][i / 3 % 3][i % 3] = (t.cuts[i / 9][i / 3 % 3][i % 3] + offsets[k]) * factors[k];
        assert_that(topology_of(&t) == first, "factor %a offset %g", factors[k], offsets[k]);
    }
}
END_TEST

/* A mesh one unit of the last place wide, far from the origin, is divided as at the origin. */
START_TEST(one_unit_of_the_last_place) {
    pc_random r = seeded((uint64_t)_i + 1);
    scene s, far_away;
    size_t i;
    make_mesh(&s, &r, 6, 1, 0, 0);
    make_cuts(&s, &r, 4, 1, 4, 0); /* whole numbers */
    far_away = s;
    for (i = 0; i < 3 * s.node_count; i++) far_away.nodes[i / 3][i % 3] = 0x1p20 + s.nodes[i / 3][i % 3] * 0x1p-32;
    for (i = 0; i < 9 * s.cut_count; i++)
        far_away.cuts[i / 9][i / 3 % 3][i % 3] = 0x1p20 + s.cuts[i / 9][i / 3 % 3][i % 3] * 0x1p-32;
    ck_assert(topology_of(&s) == topology_of(&far_away));
    run_scene(&far_away, &r);
}
END_TEST

/* The coordinates of given points come back bit for bit, whatever the frame; also denormal ones. */
START_TEST(given_coordinates_come_back) {
    static const double sizes[4] = {1, 0x1p-100, 0x1p-960, 0x1p900}, offsets[4] = {0, 0, 0, 0x1p920};
    pc_random r = seeded((uint64_t)_i + 1);
    scene s;
    gxb_complex *cx;
    int i, k;
    make_mesh(&s, &r, 6, sizes[_i], offsets[_i], 0.1);
    cx = open_scene(&s, NULL);
    gxb_complex_begin(cx);
    for (i = 0; i < 200; i++) {
        double x[3], given[3];
        uint32_t point;
        for (k = 0; k < 3; k++) {
            x[k] = pc_uniform(&r) * sizes[_i];
            if (i % 2) x[k] *= pc_power(-(int)pc_below(&r, 115)); /* 2^-1074 is the least double */
        }
        ck_assert_int_eq(gxb_complex_add_point(cx, x, &point), GX_OK);
        gxbp_given(&cx->store, point, given);
        for (k = 0; k < 3; k++) assert_that(given[k] == x[k], "%a, not %a", given[k], x[k]);
    }
    gxb_complex_destroy(cx);
}
END_TEST

/* Stamps that have reached their last value begin again, and no stamp left at points and edges counts as new. */
START_TEST(stamps_begin_again) {
    pc_random r = seeded((uint64_t)_i + 1);
    scene s;
    inserted in;
    gxb_complex *cx;
    uint32_t c, before, turn;
    make_mesh(&s, &r, 6, 1, 0, 0);
    make_cuts(&s, &r, 6, 1, 1, 0);
    cx = open_scene(&s, NULL);
    gxb_complex_begin(cx);
    for (c = 0; c < s.cut_count / 2; c++) ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
    gxb_complex_commit(cx);
    for (before = 0; before < 2; before++) {
        for (turn = 0; turn < 2; turn++) { /* an undone turn has stamped what the next turn makes again */
            cx->store.stamp[0] = cx->store.stamp[1] = UINT32_MAX - before;
            cx->edge_stamp = 0x3fffffffu - before;
            gxb_complex_begin(cx);
            for (c = s.cut_count / 2; c < s.cut_count; c++) ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
            assert_that(cx->store.stamp[0] < 100 && cx->store.stamp[1] < 100000 && cx->edge_stamp < 100000,
                        "no stamp began again");
            assert_that(hash_complex(cx, 0) == topology_of(&s), "another topology, %lu before, turn %lu",
                        (unsigned long)before, (unsigned long)turn);
            gxb_complex_rollback(cx);
        }
    }
    gxb_complex_destroy(cx);
}
END_TEST

/* ---- the order of cuts does not change what walls separate ---- */

static uint32_t find_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Volumes of leaves joined by open facets, in ascending order, at most 256 */
static uint32_t piece_volumes(const scene *s, double volumes[256]) {
    const rat_mark mark = rat_arena_mark();
    inserted in;
    gxb_complex *cx = open_scene(s, NULL);
    uint32_t *parent, i, count = 0;
    double *sum;
    model m;
    ck_assert_int_eq(insert_all(cx, s, &in), GX_OK);
    for (i = 0; i < s->element_count; i++) ck_assert_int_eq(gxb_complex_open_element(cx, i), GX_OK);
    m = open_model(cx, s, &in);
    parent = (uint32_t *)malloc((cx->leaf_count + 1) * sizeof *parent);
    sum = (double *)calloc(cx->leaf_count + 1, sizeof *sum);
    for (i = 0; i < cx->leaf_count; i++) parent[i] = i;
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        if (f->child != GXB_NONE || f->wall || f->leaf[0] == GXB_NONE || f->leaf[1] == GXB_NONE) continue;
        parent[find_root(parent, f->leaf[0])] = find_root(parent, f->leaf[1]);
    }
    for (i = 0; i < cx->leaf_count; i++) sum[find_root(parent, i)] += check_leaf(&m, i);
    for (i = 0; i < cx->leaf_count; i++)
        if (parent[i] == i && count < 256) volumes[count++] = sum[i];
    qsort(volumes, count, sizeof *volumes, compare_doubles);
    free(parent);
    free(sum);
    close_model(&m);
    gxb_complex_destroy(cx);
    rat_arena_release(mark);
    return count;
}

START_TEST(pieces_do_not_depend_on_the_order) {
    pc_random r = seeded((uint64_t)_i + 1);
    double a[256], b[256];
    scene s;
    uint32_t count, i;
    int round;
    make_mesh(&s, &r, 6, 1, 0, 0);
    make_cuts(&s, &r, 6, 1 + _i % 2, 4, -1.5);
    count = piece_volumes(&s, a);
    for (round = 0; round < 3; round++) {
        for (i = s.cut_count; i > 1; i--) {
            const uint32_t j = pc_below(&r, i);
            double t[3][3];
            memcpy(t, s.cuts[j], sizeof t);
            memcpy(s.cuts[j], s.cuts[i - 1], sizeof t);
            memcpy(s.cuts[i - 1], t, sizeof t);
        }
        ck_assert_uint_eq(piece_volumes(&s, b), count);
        for (i = 0; i < count; i++) assert_that(fabs(a[i] - b[i]) < 1e-13, "piece %u: %.17g, %.17g", i, a[i], b[i]);
    }
}
END_TEST

START_TEST(coincident_cuts_share_their_facets) {
    pc_random r = seeded((uint64_t)_i + 1);
    scene s;
    inserted in;
    gxb_complex *cx;
    uint32_t i, found = 0;
    make_mesh(&s, &r, 6, 1, 0, 0);
    make_cuts(&s, &r, 3, 1, 1, 0);
    memcpy(s.cuts[1], s.cuts[0], sizeof s.cuts[0]);
    memcpy(s.cuts[2][0], s.cuts[0][1], sizeof s.cuts[2][0]); /* turned round */
    memcpy(s.cuts[2][1], s.cuts[0][0], sizeof s.cuts[2][1]);
    memcpy(s.cuts[2][2], s.cuts[0][2], sizeof s.cuts[2][2]);
    cx = open_scene(&s, NULL);
    ck_assert_int_eq(insert_all(cx, &s, &in), GX_OK);
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_label *l[3];
        if (cx->facets[i].child != GXB_NONE) continue;
        l[0] = find_label(cx, i, 0);
        l[1] = find_label(cx, i, 1);
        l[2] = find_label(cx, i, 2);
        assert_that((l[0] == NULL) == (l[1] == NULL) && (l[0] == NULL) == (l[2] == NULL), "facet %u", i);
        if (l[0] == NULL) continue;
        found++;
        ck_assert_int_eq(l[0]->orientation, l[1]->orientation);
        ck_assert_int_eq(l[0]->orientation, -l[2]->orientation);
    }
    ck_assert_uint_gt(found + 1, area_in_element(&(model){&s, &in, cx, NULL, NULL, NULL}, 0, 0) > 0 ? 1 : 0);
    check_complex(cx, &s, &in, &r);
    gxb_complex_destroy(cx);
}
END_TEST

static int refuse(void *user, uint32_t leaf) {
    (void)leaf;
    (*(int *)user)++;
    return 0;
}

START_TEST(refused_and_removed_leaves_stay_whole) {
    pc_random r = seeded(1);
    const double across[3][3] = {{-9, -9, 0.25}, {9, -9, 0.25}, {0, 9, 0.25}},
                 along[3][3] = {{0.2, -9, -9}, {0.2, 9, -9}, {0.2, 0, 9}};
    scene s;
    inserted in;
    gxb_complex *cx;
    int asked = 0;
    uint32_t leaves;
    make_mesh(&s, &r, 1, 1, 0, 0);
    memcpy(s.nodes, unit_tet, sizeof unit_tet);
    s.elements[0][0] = 0;
    s.elements[0][1] = 1;
    s.elements[0][2] = 2;
    s.elements[0][3] = 3;
    s.node_count = 4;
    memcpy(s.cuts[0], across, sizeof across);
    memcpy(s.cuts[1], along, sizeof along);
    s.cut_count = 2;
    cx = open_scene(&s, NULL);
    gxb_complex_begin(cx);
    ck_assert_int_eq(insert_cut(cx, &s, &in, 0), GX_OK);
    ck_assert_uint_eq(cx->leaf_count, 2);
    ck_assert_int_eq(gxb_complex_set_removed(cx, 0), GX_OK);
    leaves = cx->leaf_count;
    ck_assert_int_eq(insert_cut(cx, &s, &in, 1), GX_OK);
    ck_assert_uint_eq(cx->leaf_count, leaves + 1);
    ck_assert_int_eq(gxb_complex_insert(cx, &in.triangles[1], 0, refuse, &asked), GX_OK);
    ck_assert_uint_eq(cx->leaf_count, leaves + 1);
    gxb_complex_rollback(cx);
    ck_assert_uint_eq(cx->leaf_count, 1);
    ck_assert_uint_eq(cx->leaves[0].removed, 0);
    gxb_complex_begin(cx);
    ck_assert_int_eq(gxb_complex_add_point(cx, s.cuts[0][0], &in.triangles[0].point[0]), GX_OK);
    ck_assert_int_eq(gxb_complex_add_point(cx, s.cuts[0][1], &in.triangles[0].point[1]), GX_OK);
    ck_assert_int_eq(gxb_complex_add_point(cx, s.cuts[0][2], &in.triangles[0].point[2]), GX_OK);
    ck_assert_int_eq(gxb_complex_add_plane(cx, &in.triangles[0]), GX_OK);
    asked = 0;
    ck_assert_int_eq(gxb_complex_insert(cx, &in.triangles[0], 0, refuse, &asked), GX_OK);
    ck_assert_int_eq(asked, 1);
    ck_assert_uint_eq(cx->leaf_count, 1);
    gxb_complex_destroy(cx);
}
END_TEST

START_TEST(rollback_restores_everything) {
    pc_random r = seeded((uint64_t)_i + 1);
    scene s;
    inserted in, twice;
    gxb_complex *cx;
    uint64_t before, after;
    uint32_t c, half;
    make_mesh(&s, &r, 6, 1, 0, _i % 8 == 0 ? 0.05 : 0);
    make_cuts(&s, &r, 8, _i % 4, 1, 0);
    half = s.cut_count / 2;
    cx = open_scene(&s, NULL);
    gxb_complex_begin(cx);
    for (c = 0; c < half; c++) ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
    gxb_complex_commit(cx);
    before = hash_complex(cx, 1);
    gxb_complex_begin(cx);
    for (c = half; c < s.cut_count; c++) ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
    ck_assert_int_eq(gxb_complex_set_wall(cx, 0), GX_OK);
    ck_assert_int_eq(gxb_complex_set_removed(cx, 0), GX_OK);
    gxb_complex_rollback(cx);
    assert_that(hash_complex(cx, 1) == before, "rollback");
    gxb_complex_begin(cx);
    for (c = half; c < s.cut_count; c++) ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
    gxb_complex_commit(cx);
    after = hash_complex(cx, 1);
    check_complex(cx, &s, &in, &r);
    gxb_complex_destroy(cx);
    cx = open_scene(&s, NULL);
    ck_assert_int_eq(insert_all(cx, &s, &twice), GX_OK);
    assert_that(hash_complex(cx, 1) == after, "a rolled back cut left a trace");
    gxb_complex_destroy(cx);
}
END_TEST

/* Triangles in few planes, a lattice in each: many share a plane, overlap, touch or are the same. */
static void make_coplanar_cuts(scene *s, pc_random *r) {
    static const int normals[3][3] = {{0, 0, 1}, {1, 1, 1}, {1, -1, 0}};
    uint32_t c, j, k;
    s->cut_count = MAX_CUTS;
    for (c = 0; c < s->cut_count; c++) {
        const uint32_t plane = pc_below(r, 3);
        const int *n = normals[plane];
        int x[3][3], u[3], v[3];
        for (j = 0; j < 3; j++) {
            x[j][0] = (int)pc_below(r, 16);
            x[j][1] = (int)pc_below(r, 16);
            x[j][2] = n[2] == 0 ? (int)pc_below(r, 16) : 0;
            if (plane == 1) x[j][2] = 20 - x[j][0] - x[j][1];
            if (plane == 0) x[j][2] = 5;
            if (plane == 2) x[j][1] = x[j][0] + 1;
        }
        for (k = 0; k < 3; k++) {
            u[k] = x[1][k] - x[0][k];
            v[k] = x[2][k] - x[0][k];
            for (j = 0; j < 3; j++) s->cuts[c][j][k] = x[j][k] / 16.0;
        }
        if (u[0] * v[1] == u[1] * v[0] && u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2]) c--;
    }
}

/* The complex again, from what is saved of it; the bytes are not trusted. */
static gxb_complex *saved_and_loaded(gxb_complex *cx, const scene *s) {
    static unsigned char bytes[1 << 20];
    gxb_complex *copy = open_scene(s, NULL);
    gxb_stream out, in;
    memset(&out, 0, sizeof out);
    out.out = bytes;
    out.size = sizeof bytes;
    gxb_complex_save(cx, &out);
    ck_assert_int_eq(out.result, GX_OK);
    memset(&in, 0, sizeof in);
    in.in = bytes;
    in.size = out.at;
    ck_assert_int_eq(gxb_complex_load(copy, &in, 0), GX_OK);
    ck_assert_uint_eq(in.at, out.at);
    gxb_complex_commit(copy);
    return copy;
}

/* The same cuts in one commit or in several, with some that are taken back in between, and with what was saved and
   loaded in between: the same complex. */
START_TEST(groups_of_cuts_leave_no_trace) {
    pc_random r = seeded((uint64_t)_i + 1);
    scene s;
    inserted in, once;
    gxb_complex *cx, *copy;
    uint64_t whole, before;
    uint32_t c, i, end, past;
    make_mesh(&s, &r, _i % 2 ? 6 : 1, 1, 0, _i % 4 == 3 ? 0.05 : 0);
    make_coplanar_cuts(&s, &r);
    cx = open_scene(&s, NULL);
    ck_assert_int_eq(insert_all(cx, &s, &once), GX_OK);
    whole = hash_complex(cx, 1);
    if (_i < 4) check_complex(cx, &s, &once, &r);
    gxb_complex_destroy(cx);
    cx = open_scene(&s, NULL);
    for (c = 0; c < s.cut_count; c = end) {
        end = c + 1 + pc_below(&r, 8);
        if (end > s.cut_count) end = s.cut_count;
        before = hash_complex(cx, 1);
        gxb_complex_begin(cx);
        past = pc_below(&r, 2) ? c + pc_below(&r, s.cut_count - c) : c;
        for (i = past; i-- > c;) ck_assert_int_eq(insert_cut(cx, &s, &in, i), GX_OK);
        gxb_complex_rollback(cx);
        assert_that(hash_complex(cx, 1) == before, "rollback, cut %u", c);
        if (pc_below(&r, 3) == 0) {
            copy = saved_and_loaded(cx, &s);
            gxb_complex_destroy(cx);
            cx = copy;
        }
        gxb_complex_begin(cx);
        for (i = c; i < end; i++) ck_assert_int_eq(insert_cut(cx, &s, &in, i), GX_OK);
        gxb_complex_commit(cx);
    }
    assert_that(hash_complex(cx, 1) == whole, "another complex");
    gxb_complex_destroy(cx);
}
END_TEST

/* Every allocation in turn fails, once or from then on: an error, an unchanged complex after rollback, and the same
   result at the next attempt */
START_TEST(every_allocation_may_fail) {
    pc_random r = seeded((uint64_t)_i / 2 + 1);
    memory m = plenty();
    const gx_allocator allocator = allocator_of(&m);
    scene s;
    inserted in;
    size_t n, failures = 0;
    uint64_t good = 0;
    make_mesh(&s, &r, 6, 1, _i / 2 == 1 ? 1e6 : 0, 0.05);
    make_cuts(&s, &r, 6, 2, 1, _i / 2 == 1 ? 1e6 : 0);
    for (n = 0;; n++) {
        const gxb_mesh mesh = mesh_of(&s);
        gxb_complex *cx = NULL;
        gx_failure failure;
        uint64_t before;
        gx_result result;
        /* n = 0: none fails */
        fail_from(&m, n - 1, _i % 2 && n > 0);
        result = gxb_complex_create(&mesh, &allocator, &cx, &failure);
        if (result != GX_OK) {
            ck_assert_int_eq(result, GX_ERROR_MEMORY);
            ck_assert_ptr_null(cx);
            assert_that(is_whole(&m), "create leaks where allocation %lu fails", (unsigned long)n);
            failures++;
            continue;
        }
        before = hash_complex(cx, 1);
        gxb_complex_begin(cx);
        result = insert_all(cx, &s, &in);
        if (n > 0 && m.calls < n) {
            gxb_complex_destroy(cx);
            break;
        } /* all have failed */
        if (result != GX_OK) {
            ck_assert_int_eq(result, GX_ERROR_MEMORY);
            failures++;
            gxb_complex_rollback(cx);
            assert_that(hash_complex(cx, 1) == before, "allocation %lu", (unsigned long)n);
            never_fail(&m);
            gxb_complex_begin(cx);
            result = insert_all(cx, &s, &in);
        }
        assert_that(result == GX_OK, "allocation %lu: %d", (unsigned long)n, (int)result);
        gxb_complex_commit(cx);
        never_fail(&m);
        if (n == 0) good = hash_complex(cx, 1);
        assert_that(hash_complex(cx, 1) == good, "allocation %lu: another result", (unsigned long)n);
        if (n % 16 == 1) check_complex(cx, &s, &in, &r);
        gxb_complex_destroy(cx);
        assert_that(is_whole(&m), "allocation %lu: a leak", (unsigned long)n);
    }
    ck_assert(is_whole(&m));
    ck_assert_uint_gt(failures, 10);
}
END_TEST

/* Reads every list, so that all are resolved. */
static void read_lists(gxb_complex *cx) {
    uint32_t leaf, first, count, edge_first, edge_count, i;
    for (leaf = 0; leaf < cx->leaf_count; leaf++) {
        ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
        for (i = 0; i < count; i++)
            ck_assert_int_eq(gxb_facet_resolve_edges(cx, cx->pool[first + i], &edge_first, &edge_count), GX_OK);
    }
}

/* Many transactions on one complex: the pool is compacted, nothing else changes. */
START_TEST(many_transactions_conform) {
    pc_random r = seeded(1);
    scene s;
    inserted in;
    gxb_complex *cx;
    uint32_t c, k, compactions = 0;
    make_mesh(&s, &r, 6, 1, 0, 0.05);
    make_cuts(&s, &r, MAX_CUTS, 0, 1, 0);
    cx = open_scene(&s, NULL);
    for (c = 0; c < s.cut_count; c++) {
        for (k = 0; k < 4; k++) { /* undone three times, then kept */
            const uint64_t before = hash_complex(cx, 1);
            const uint32_t pool_count = cx->pool_count;
            gxb_complex_begin(cx);
            compactions += cx->pool_count < pool_count;
            assert_that(hash_complex(cx, 1) == before, "begin, cut %u", c);
            ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
            read_lists(cx);
            if (k < 3) {
                gxb_complex_rollback(cx);
                assert_that(hash_complex(cx, 1) == before, "cut %u", c);
            } else
                gxb_complex_commit(cx);
        }
    }
    ck_assert_uint_gt(compactions, 0);
    check_complex(cx, &s, &in, &r);
    gxb_complex_destroy(cx);
}
END_TEST

/* ---- giving back what nothing needs ---- */

typedef struct extent {
    double *volume; /* of each leaf */
    double wall[MAX_CUTS];
} extent;

/* Checks all leaves that have facets. Volumes of those that are kept, and the area of their labelled facets by label */
static extent measure_kept(const model *m) {
    gxb_complex *cx = m->cx;
    extent x;
    uint32_t leaf, first, count, i, edge_first, edge_count, l;
    memset(&x, 0, sizeof x);
    x.volume = (double *)calloc(cx->leaf_count, sizeof *x.volume);
    for (leaf = 0; leaf < cx->leaf_count; leaf++) {
        uint32_t *facets;
        if (cx->leaves[leaf].facet_count == 0) continue;
        x.volume[leaf] = check_leaf(m, leaf);
        if (cx->leaves[leaf].removed) x.volume[leaf] = 0;
        ck_assert_int_eq(gxb_leaf_resolve_facets(cx, leaf, &first, &count), GX_OK);
        facets = copy_list(cx, first, count);
        for (i = 0; i < count && !cx->leaves[leaf].removed; i++) {
            double area[3] = {0, 0, 0}, volume = 0;
            ck_assert_int_eq(gxb_facet_resolve_edges(cx, facets[i], &edge_first, &edge_count), GX_OK);
            add_fan(m, cx->pool + edge_first, edge_count, area, &volume);
            for (l = cx->facets[facets[i]].labels; l != GXB_NONE; l = cx->labels[l].next)
                x.wall[cx->labels[l].triangle] += length3(area);
        }
        free(facets);
    }
    return x;
}

/* Each kept leaf hangs once in its element's tree. */
static void check_kept_trees(const model *m) {
    const gxb_complex *cx = m->cx;
    uint32_t *seen = (uint32_t *)calloc(cx->leaf_count, sizeof *seen), i;
    for (i = 0; i < cx->element_count; i++) check_tree(m, i, cx->root[i], seen);
    for (i = 0; i < cx->leaf_count; i++)
        assert_that(cx->leaves[i].removed ? seen[i] > 0 : seen[i] == 1, "leaf %u hangs %u times", i, seen[i]);
    free(seen);
}

/* Given points are found again by their names. */
static void find_points_again(const gxb_complex *cx, const scene *s, const uint32_t *names, inserted *in) {
    uint32_t i, j;
    for (i = 0; i < 3 * s->cut_count; i++) {
        in->points[i] = GXB_NONE;
        for (j = (uint32_t)s->node_count; j < cx->store.point_count; j++)
            if (cx->store.points[j].name == names[i]) in->points[i] = j;
    }
}

/* Compacts at the end of a transaction, after every failure that there may be and a survey in vain. Volumes and walls
   of what is kept stay. */
static void compact_and_compare(gxb_complex *cx, memory *own, const scene *s, inserted *in, const uint8_t *pinned) {
    const rat_mark mark = rat_arena_mark();
    model m = open_model(cx, s, in);
    const extent old = measure_kept(&m);
    const uint64_t hash = hash_complex(cx, 1);
    extent now;
    gxb_renumbering r;
    double *sum;
    uint32_t names[3 * MAX_CUTS], i, k, failures = 0;
    size_t n;
    int failed = 1;
    close_model(&m);
    for (n = 0; failed; n++) {
        gx_result result;
        fail_from(own, n, 0);
        result = gxb_complex_survey(cx, pinned, NULL, &r);
        failed = own->failed;
        failures += result != GX_OK;
        assert_that(result == GX_OK || (failed && result == GX_ERROR_MEMORY && r.memory == NULL), "allocation %lu: %d",
                    (unsigned long)n, (int)result);
        gxb_complex_forget(cx, &r);
        assert_that(hash_complex(cx, 1) == hash, "a survey changes something");
    }
    never_fail(own);
    ck_assert_uint_ge(failures, 4);
    ck_assert_int_eq(gxb_complex_survey(cx, pinned, NULL, &r), GX_OK);
    gxb_complex_commit(cx);
    for (i = 0; i < 3 * s->cut_count; i++)
        names[i] = in->points[i] < cx->store.point_count ? cx->store.points[in->points[i]].name : GXB_NONE;
    sum = (double *)calloc(cx->leaf_count, sizeof *sum);
    gxb_complex_compact(cx, &r);
    find_points_again(cx, s, names, in);
    m = open_model(cx, s, in);
    now = measure_kept(&m);
    check_neighbours(&m);
    check_kept_trees(&m);
    for (i = 0; i < r.leaf_count; i++) {
        ck_assert_uint_lt(r.leaves[i], cx->leaf_count);
        assert_that(r.leaf_of[i] == i || r.leaves[i] == r.leaves[r.leaf_of[i]], "leaf %u", i);
        sum[r.leaves[i]] += old.volume[i];
        for (k = 0; k < 4 && pinned != NULL; k++)
            assert_that(!pinned[cx->elements[4 * (size_t)cx->leaves[r.leaves[i]].element + k]] || r.leaf_of[i] == i,
                        "pinned leaf %u", i);
    }
    for (i = 0; i < cx->leaf_count; i++)
        assert_that(fabs(sum[i] - now.volume[i]) < 1e-14, "leaf %u: %g, not %g", i, now.volume[i], sum[i]);
    for (i = 0; i < s->cut_count; i++)
        assert_that(fabs(old.wall[i] - now.wall[i]) < 1e-13, "wall %u: %g, not %g", i, now.wall[i], old.wall[i]);
    gxb_complex_forget(cx, &r);
    close_model(&m);
    rat_arena_release(mark);
    free(old.volume);
    free(now.volume);
    free(sum);
}

/* Cuts, removals and compactions in turn: what is kept stays what it is, and later cuts divide it as before. */
START_TEST(worn_complexes_conform) {
    pc_random r = seeded((uint64_t)_i + 1);
    const uint8_t pinned[MAX_NODES] = {0, 1};
    memory m = plenty();
    const gx_allocator allocator = allocator_of(&m);
    scene s, all;
    inserted in;
    gxb_complex *cx;
    uint32_t c, i, leaves, fewer = 0;
    make_mesh(&all, &r, 6, 1, 0, 0.05);
    make_cuts(&all, &r, 12, _i % 3, 1, 0);
    s = all;
    cx = open_scene(&s, &allocator);
    for (s.cut_count = 4; s.cut_count <= all.cut_count; s.cut_count += 4) {
        const uint64_t before = hash_complex(cx, 1);
        gxb_complex_begin(cx);
        for (c = s.cut_count - 4; c < s.cut_count; c++) ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
        gxb_complex_rollback(cx);
        assert_that(hash_complex(cx, 1) == before, "rollback");
        gxb_complex_begin(cx);
        for (c = s.cut_count - 4; c < s.cut_count; c++) ck_assert_int_eq(insert_cut(cx, &s, &in, c), GX_OK);
        for (i = 0; i < cx->leaf_count; i++)
            if (pc_below(&r, 3) == 0) ck_assert_int_eq(gxb_complex_set_removed(cx, i), GX_OK);
        leaves = cx->leaf_count;
        compact_and_compare(cx, &m, &s, &in, _i % 4 == 3 ? pinned : NULL);
        fewer += cx->leaf_count < leaves;
    }
    ck_assert_uint_gt(fewer, 0);
    gxb_complex_destroy(cx);
    ck_assert(is_whole(&m));
}
END_TEST

/* ---- bad input ---- */

static void expect_mesh(const scene *s, gx_result want, size_t index) {
    const gxb_mesh mesh = mesh_of(s);
    gxb_complex *cx = NULL;
    gx_failure failure;
    memory m = plenty();
    const gx_allocator allocator = allocator_of(&m);
    gx_result result;
    result = gxb_complex_create(&mesh, &allocator, &cx, &failure);
    assert_that(result == want && failure.result == want, "result %d instead of %d", (int)result, (int)want);
    assert_that(want == GX_OK || cx == NULL, "a complex in spite of error %d", (int)want);
    assert_that(failure.index == index, "error %d: index %lu instead of %lu", (int)want, (unsigned long)failure.index,
                (unsigned long)index);
    gxb_complex_destroy(cx);
    ck_assert(is_whole(&m));
}

START_TEST(bad_meshes_are_named) {
    pc_random r = seeded(1);
    const double infinity = pc_from_bits(UINT64_C(0x7ff0000000000000)),
                 nan = pc_from_bits(UINT64_C(0x7ff8000000000001));
    scene good, s;
    gxb_mesh none;
    gx_allocator half;
    gxb_complex *cx = NULL;
    gx_failure failure;
    size_t i;
    make_mesh(&good, &r, 6, 1, 0, 0);
    expect_mesh(&good, GX_OK, SIZE_MAX);
    s = good;
    s.nodes[5][1] = nan;
    expect_mesh(&s, GX_ERROR_NOT_FINITE, 5);
    s = good;
    s.nodes[2][0] = infinity;
    expect_mesh(&s, GX_ERROR_NOT_FINITE, 2);
    s = good;
    s.nodes[2][0] = -infinity;
    expect_mesh(&s, GX_ERROR_NOT_FINITE, 2);
    s = good;
    s.elements[3][2] = 8;
    expect_mesh(&s, GX_ERROR_INDEX, 3);
    s = good;
    s.elements[3][2] = UINT32_MAX;
    expect_mesh(&s, GX_ERROR_INDEX, 3);
    s = good;
    s.elements[4][0] = good.elements[4][1];
    s.elements[4][1] = good.elements[4][0];
    expect_mesh(&s, GX_ERROR_INVERTED, 4);
    s = good;
    s.elements[4][0] = s.elements[4][1];
    expect_mesh(&s, GX_ERROR_FLAT, 4);
    s = good;
    s.element_count = 1;
    memcpy(s.nodes[7], s.nodes[2], sizeof s.nodes[7]);
    expect_mesh(&s, GX_ERROR_FLAT, 0);
    s = good;
    for (i = 0; i < s.node_count; i++) s.nodes[i][2] = 0;
    expect_mesh(&s, GX_ERROR_FLAT, 0);
    for (i = 0; i < s.node_count; i++) s.nodes[i][2] = 3;
    expect_mesh(&s, GX_ERROR_FLAT, 0);
    memset(s.nodes, 0, sizeof s.nodes);
    expect_mesh(&s, GX_ERROR_FLAT, 0);
    s = good;
    s.element_count = 7;
    memcpy(s.elements[6], s.elements[0], sizeof s.elements[6]);
    expect_mesh(&s, GX_ERROR_OVERLAP, 6);
    s = good;
    s.nodes[1][1] = 1e-60;
    expect_mesh(&s, GX_ERROR_RANGE, 1);
    s = good;
    s.node_count = 0;
    expect_mesh(&s, GX_ERROR_EMPTY, SIZE_MAX);
    s = good;
    s.element_count = 0;
    expect_mesh(&s, GX_ERROR_EMPTY, SIZE_MAX);
    none = mesh_of(&good);
    none.positions = NULL;
    ck_assert_int_eq(gxb_complex_create(&none, NULL, &cx, &failure), GX_ERROR_ARGUMENT);
    none = mesh_of(&good);
    none.elements = NULL;
    ck_assert_int_eq(gxb_complex_create(&none, NULL, &cx, &failure), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_complex_create(NULL, NULL, &cx, NULL), GX_ERROR_ARGUMENT);
    none = mesh_of(&good);
    ck_assert_int_eq(gxb_complex_create(&none, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    memset(&half, 0, sizeof half);
    half.allocate = (void *(*)(void *, size_t))1;
    ck_assert_int_eq(gxb_complex_create(&none, &half, &cx, NULL), GX_ERROR_ARGUMENT);
    gxb_complex_destroy(NULL);
}
END_TEST

/* Coordinates too large for any frame are reported with their node, as the header promises. */
START_TEST(huge_meshes_name_the_node) {
    pc_random r = seeded(1);
    scene s;
    make_mesh(&s, &r, 6, 1, 0, 0);
    s.nodes[7][2] = 1e300;
    expect_mesh(&s, GX_ERROR_RANGE, 7);
}
END_TEST

START_TEST(bad_triangles_are_named) {
    pc_random r = seeded(1);
    const double nan = pc_from_bits(UINT64_C(0x7ff8000000000001));
    const double line[3][3] = {{0, 0, 0}, {0.1, 0.1, 0.1}, {0.3, 0.3, 0.3}};
    double x[3] = {0, 0, 0};
    scene s;
    inserted in;
    gxb_complex *cx;
    gxb_triangle t;
    uint64_t before;
    uint32_t j, point;
    make_mesh(&s, &r, 6, 1, 0, 0);
    cx = open_scene(&s, NULL);
    before = hash_complex(cx, 1);
    gxb_complex_begin(cx);
    x[1] = nan;
    ck_assert_int_eq(gxb_complex_add_point(cx, x, &point), GX_ERROR_NOT_FINITE);
    x[1] = 1e60;
    ck_assert_int_eq(gxb_complex_add_point(cx, x, &point), GX_ERROR_RANGE);
    x[1] = 1e-60;
    ck_assert_int_eq(gxb_complex_add_point(cx, x, &point), GX_ERROR_RANGE);
    x[1] = 1e38;
    ck_assert_int_eq(gxb_complex_add_point(cx, x, &point), GX_OK);
    memset(&t, 0, sizeof t);
    for (j = 0; j < 3; j++) ck_assert_int_eq(gxb_complex_add_point(cx, line[0], &t.point[j]), GX_OK);
    ck_assert_int_eq(gxb_complex_add_plane(cx, &t), GX_ERROR_FLAT);
    gxb_complex_rollback(cx);
    memcpy(s.cuts[0], line, sizeof line);
    s.cuts[0][2][0] = s.cuts[0][2][1] = s.cuts[0][2][2] = 3 * 0.0625;
    s.cuts[0][1][0] = s.cuts[0][1][1] = s.cuts[0][1][2] = 0.0625;
    s.cut_count = 1;
    gxb_complex_begin(cx);
    ck_assert_int_eq(insert_cut(cx, &s, &in, 0), GX_ERROR_FLAT);
    gxb_complex_rollback(cx);
    assert_that(hash_complex(cx, 1) == before, "rollback");
    s.cuts[0][2][2] = pc_nudge(s.cuts[0][2][2], 1); /* one ulp of area */
    gxb_complex_begin(cx);
    ck_assert_int_eq(insert_cut(cx, &s, &in, 0), GX_OK);
    check_complex(cx, &s, &in, &r);
    gxb_complex_destroy(cx);
}
END_TEST

/* ==== the suite ==== */

static Suite *boolean_suite(void) {
    Suite *suite = suite_create("gxfem_boolean");
    TCase *numbers = tcase_create("numbers"), *predicates = tcase_create("predicates"),
          *complex = tcase_create("complex");
    TCase *input = tcase_create("input");
    tcase_add_loop_test(numbers, numbers_are_exact, 0, 2);
    tcase_add_loop_test(numbers, numbers_become_doubles, 0, 2);
    tcase_add_test(numbers, numbers_beyond_doubles);
    tcase_add_loop_test(numbers, determinants_of_fixed_numbers, 0, 2);
    tcase_add_test(numbers, numbers_take_a_shift);
    tcase_add_test(numbers, numbers_have_room);
    tcase_add_test(numbers, quotients_are_short);
    tcase_add_test(predicates, orientation_is_as_documented);
    tcase_add_loop_test(predicates, predicates_have_the_right_sign, 0, 4);
    tcase_add_loop_test(predicates, inherited_errors_stay_within_bounds, 0, 2);
    tcase_add_loop_test(predicates, points_of_all_kinds_compare, 0, 2);
    tcase_add_loop_test(predicates, orient_takes_any_double, 0, 3);
    tcase_add_test(predicates, circles_and_spheres_of_any_size);
    tcase_add_test(predicates, published_cases);
    tcase_add_loop_test(predicates, winding_numbers_count, 0, 2);
    tcase_add_test(predicates, triangles_without_area_have_no_outside);
    tcase_add_loop_test(complex, random_cuts_conform, 0, 10);
    tcase_add_loop_test(complex, degenerate_cuts_conform, 0, 8);
    tcase_add_loop_test(complex, far_and_scaled_meshes_conform, 0, 6);
    tcase_add_loop_test(complex, rests_below_the_last_bit_count, 0, 8);
    tcase_add_loop_test(complex, topology_is_the_same_moved_and_scaled, 0, 4);
    tcase_add_loop_test(complex, one_unit_of_the_last_place, 0, 4);
    tcase_add_loop_test(complex, given_coordinates_come_back, 0, 4);
    tcase_add_loop_test(complex, stamps_begin_again, 0, 4);
    tcase_add_loop_test(complex, pieces_do_not_depend_on_the_order, 0, 6);
    tcase_add_loop_test(complex, coincident_cuts_share_their_facets, 0, 4);
    tcase_add_test(complex, refused_and_removed_leaves_stay_whole);
    tcase_add_loop_test(complex, rollback_restores_everything, 0, 24);
    tcase_add_loop_test(complex, groups_of_cuts_leave_no_trace, 0, 12);
    tcase_add_loop_test(complex, every_allocation_may_fail, 0, 4);
    tcase_add_test(complex, many_transactions_conform);
    tcase_add_loop_test(complex, worn_complexes_conform, 0, 24);
    tcase_add_test(input, bad_meshes_are_named);
    tcase_add_test(input, huge_meshes_name_the_node);
    tcase_add_test(input, bad_triangles_are_named);
    tcase_set_timeout(numbers, 120);
    tcase_set_timeout(predicates, 120);
    tcase_set_timeout(complex, 120);
    suite_add_tcase(suite, numbers);
    suite_add_tcase(suite, predicates);
    suite_add_tcase(suite, complex);
    suite_add_tcase(suite, input);
    return suite;
}

int main(void) { return run_suite(boolean_suite()); }
