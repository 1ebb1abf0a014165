/* predicate_cases.h - near-degenerate input for the predicates of gxfem_boolean.h, and the right answers.

   Include after gxfem_boolean.h with its implementation: the filter's bounds are private functions. Exact answers
   come from rational.h, by other formulas than the kernel's (coordinates about a vertex, Cramer's rule by columns),
   in integers only, so that no compiler flag touches them. One case has all the input of the predicates: four
   planes, a line and a point that (nearly) meet in one place. */
#ifndef GXFEM_TESTS_PREDICATE_CASES_H
#define GXFEM_TESTS_PREDICATE_CASES_H

#include "rational.h"

/* ---- random numbers: xorshift*, the same everywhere ---- */
typedef struct pc_random {
    uint64_t state;
} pc_random;

static inline pc_random pc_seeded(uint64_t seed) {
    pc_random r;
    r.state = seed * UINT64_C(0x9e3779b97f4a7c15) + 1;
    if (r.state == 0) r.state = 1;
    return r;
}

static inline uint64_t pc_next(pc_random *r) {
    r->state ^= r->state >> 12;
    r->state ^= r->state << 25;
    r->state ^= r->state >> 27;
    return r->state * UINT64_C(2685821657736338717);
}

static inline uint32_t pc_below(pc_random *r, uint32_t n) { return (uint32_t)((pc_next(r) >> 33) % n); }
/* [-1, 1) */
static inline double pc_uniform(pc_random *r) { return (double)(int64_t)(pc_next(r) >> 11) / 4503599627370496.0 - 1; }

static inline double pc_from_bits(uint64_t b) {
    double x;
    memcpy(&x, &b, sizeof x);
    return x;
}

static inline uint64_t pc_bits(double x) {
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}

static inline double pc_power(int e) { return pc_from_bits((uint64_t)(e + 1023) << 52); }

/* x moved by this number of units of its last place; x stays if it is 0, or if it would change its sign or overflow */
static inline double pc_nudge(double x, int units) {
    const uint64_t b = pc_bits(x) + (uint64_t)(int64_t)units;
    return (pc_bits(x) << 1) == 0 || ((b ^ pc_bits(x)) >> 63) || ((b >> 52) & 0x7ff) == 0x7ff ? x : pc_from_bits(b);
}

/* any finite double: every exponent is equally likely, denormals and zero included */
static inline double pc_any_double(pc_random *r) {
    for (;;) {
        const uint64_t b = pc_next(r);
        if (pc_below(r, 64) == 0) return 0.0;
        if (pc_below(r, 16) == 0) return pc_from_bits(b & UINT64_C(0x800fffffffffffff));
        if (((b >> 52) & 0x7ff) != 0x7ff) return pc_from_bits(b);
    }
}

/* ---- cases ---- */
typedef struct pc_case {
    double plane[4][3][3]; /* three points of each plane */
    double line[2][3];
    double point[3];
    double circle[4][3]; /* (nearly) on a circle in x and y */
    double sphere[5][3];
} pc_case;

enum { PC_CASE_DOUBLES = sizeof(pc_case) / sizeof(double) };

/* multiples of 1/8, or uniform */
static inline void pc_vector(pc_random *r, int lattice, double v[3]) {
    int k;
    for (k = 0; k < 3; k++) v[k] = lattice ? ((double)pc_below(r, 17) - 8) / 8 : pc_uniform(r);
}

/* Three points whose plane passes through x along u and v up to rounding (on the lattice: exactly) */
static inline void pc_plane_through(pc_random *r, int lattice, const double x[3], const double u[3], const double v[3],
                                    double p[3][3]) {
    const double a = lattice ? 1 : 0.7 + 0.5 * pc_uniform(r), b = lattice ? 1 : 0.7 + 0.5 * pc_uniform(r);
    int k;
    for (k = 0; k < 3; k++) {
        p[0][k] = x[k] + u[k];
        p[1][k] = x[k] + v[k];
        p[2][k] = x[k] - (a * u[k] + b * v[k]);
    }
}

static inline void pc_scale(pc_random *r, double *x) {
    const double factor = pc_power(pc_below(r, 2)   ? 0
                                   : pc_below(r, 2) ? (pc_below(r, 2) ? 100 : -100)
                                                    : (int)pc_below(r, 201) - 100);
    double offset[3] = {0, 0, 0};
    int i;
    if (pc_below(r, 8) == 0)
        for (i = 0; i < 3; i++) offset[i] = pc_uniform(r) * (pc_below(r, 2) ? 1e6 : 10);
    for (i = 0; i < PC_CASE_DOUBLES; i++) x[i] = (x[i] + offset[i % 3]) * factor;
}

/* Coordinates of 2^-120 ... 2^120 side by side, some of them shared. */
static inline void pc_wild(pc_random *r, double *x) {
    int i;
    for (i = 0; i < PC_CASE_DOUBLES; i++) {
        x[i] = pc_uniform(r) * pc_power((int)pc_below(r, 241) - 120);
        if (i >= 3 && pc_below(r, 2)) x[i] = x[i % 3 + 3 * (int)pc_below(r, (uint32_t)(i / 3))];
    }
}

/* x plus u's coordinates in any order with any signs: at the same distance from x up to rounding (on the lattice:
   exactly) */
static inline void pc_round_points(pc_random *r, const double x[3], const double u[3], pc_case *c) {
    uint32_t i, k;
    for (i = 0; i < 5; i++) {
        const uint32_t turn = pc_below(r, 3), swap = pc_below(r, 2);
        for (k = 0; k < 3; k++) {
            const double sign = pc_below(r, 2) ? 1 : -1;
            c->sphere[i][k] = x[k] + sign * u[(k * (1 + swap) + turn) % 3];
            if (i < 4) c->circle[i][k] = k == 2 ? 0 : x[k] + sign * u[k ^ swap];
        }
    }
}

/* Everything near one place, in one of many ways of nearly failing */
static inline void pc_generate(pc_random *r, pc_case *c) {
    const int lattice = pc_below(r, 8) < 3, shared = pc_below(r, 4) == 0, apart = pc_below(r, 2) == 0;
    const double thin = pc_below(r, 8) == 0 ? pc_power(-(int)pc_below(r, 45)) : 1;
    double *all = (double *)c, x[3], y[3], u[4][3], v[3], w[3];
    uint32_t i, noise = pc_below(r, 5);
    int k;
    if (pc_below(r, 16) == 0) {
        pc_wild(r, all);
        return;
    }
    pc_vector(r, lattice, x);
    for (i = 0; i < 4; i++) {
        pc_vector(r, lattice, u[i]);
        pc_vector(r, lattice, v);
        /* planes through one line */
        if ((i == 1 && (shared || apart)) || (i == 3 && shared)) memcpy(u[i], u[0], sizeof x);
        for (k = 0; k < 3; k++) {
            v[k] = u[i][k] * (1 - thin) + v[k] * thin;
            y[k] = i >= 2 && apart ? x[k] + (i == 2 ? 0.5 : -0.25) * u[0][k] : x[k]; /* elsewhere on that line */
        }
        pc_plane_through(r, lattice && thin >= 1, y, u[i], v, c->plane[i]);
    }
    pc_vector(r, lattice, w);
    /* the line (nearly) in plane 3 */
    if (pc_below(r, 8) == 0)
        for (k = 0; k < 3; k++) w[k] = u[3][k] + w[k] * thin;
    for (k = 0; k < 3; k++) {
        c->line[0][k] = x[k] + w[k];
        c->line[1][k] = x[k] - w[k] * (lattice ? 1 : 0.75);
        c->point[k] = x[k];
    }
    pc_round_points(r, x, u[0], c);
    if (noise == 1)
        for (i = 0; i < 12; i++) {
            double *d = all + pc_below(r, PC_CASE_DOUBLES);
            *d = pc_nudge(*d, (int)pc_below(r, 7) - 3);
        }
    if (noise == 2 || noise == 3)
        for (i = 27; i < PC_CASE_DOUBLES; i++) all[i] += pc_uniform(r) * (noise == 2 ? 1e-12 : 1e-7);
    pc_scale(r, all);
}

/* ---- the exact answers ---- */
typedef struct pc_plane {
    big n[3], d;
} pc_plane; /* n.x = d about the case's origin, its first vertex */
typedef struct pc_point {
    big x[3], w;
} pc_point; /* x / w */

static inline pc_plane pc_exact_plane(const double p[3][3], const double o[3]) {
    pc_plane e;
    big a[3], b[3], c[3];
    big_difference(p[1], p[0], a);
    big_difference(p[2], p[0], b);
    big_difference(p[0], o, c);
    big_cross(a, b, e.n);
    e.d = big_dot(e.n, c);
    return e;
}

static inline big pc_height(const pc_plane *e, const big x[3]) { return big_sub(big_dot(e->n, x), e->d); }

static inline pc_point pc_exact_explicit(const double p[3], const double o[3]) {
    pc_point e;
    big_difference(p, o, e.x);
    e.w = big_from_int(1);
    return e;
}

static inline pc_point pc_exact_line(const double line[2][3], const pc_plane *plane, const double o[3]) {
    pc_point e;
    big p[3], q[3], hp, hq;
    int k;
    big_difference(line[0], o, p);
    big_difference(line[1], o, q);
    hp = pc_height(plane, p);
    hq = pc_height(plane, q);
    for (k = 0; k < 3; k++) e.x[k] = big_sub(big_mul(hp, q[k]), big_mul(hq, p[k]));
    e.w = big_sub(hp, hq);
    return e;
}

static inline pc_point pc_exact_planes(const pc_plane *a, const pc_plane *b, const pc_plane *c) {
    pc_point e;
    int k;
    e.w = big_det3(a->n, b->n, c->n);
    for (k = 0; k < 3; k++) {
        pc_plane u = *a, v = *b, w = *c;
        u.n[k] = a->d;
        v.n[k] = b->d;
        w.n[k] = c->d;
        e.x[k] = big_det3(u.n, v.n, w.n);
    }
    return e;
}

static inline big pc_scaled_height(const pc_point *x, const pc_plane *plane) {
    return big_sub(big_dot(plane->n, x->x), big_mul(plane->d, x->w));
}

static inline int pc_exact_side(const pc_point *x, const pc_plane *plane) {
    return big_sign(pc_scaled_height(x, plane)) * x->w.sign;
}

static inline int pc_exact_compare(const pc_point *a, const pc_point *b, int axis) {
    return big_sign(big_sub(big_mul(a->x[axis], b->w), big_mul(b->x[axis], a->w))) * a->w.sign * b->w.sign;
}

static inline int pc_exact_orient(const pc_point *a, const pc_point *b, const pc_point *c, const pc_plane *plane) {
    big r[3][3];
    const pc_point *p[3];
    int i, axis = 0;
    p[0] = a;
    p[1] = b;
    p[2] = c;
    while (axis < 2 && plane->n[axis].sign == 0) axis++;
    for (i = 0; i < 3; i++) {
        r[i][0] = p[i]->x[(axis + 1) % 3];
        r[i][1] = p[i]->x[(axis + 2) % 3];
        r[i][2] = p[i]->w;
    }
    return big_sign(big_det3(r[0], r[1], r[2])) * a->w.sign * b->w.sign * c->w.sign * plane->n[axis].sign;
}

enum {
    PC_ORIENT2D,
    PC_ORIENT3D,
    PC_SIDE_EXPLICIT,
    PC_SIDE_LINE,
    PC_SIDE_PLANES,
    PC_COMPARE,
    PC_ORIENT_IN_PLANE,
    PC_INCIRCLE,
    PC_INSPHERE,
    PC_KINDS
};
static const char *const pc_kind_names[PC_KINDS] = {
    "orient2d",        "orient3d", "side of point", "side of line-plane", "side of three planes", "compare",
    "orient in plane", "incircle", "insphere"};
enum { PC_INVALID = 9 }; /* no answer: parallel planes and the like */

typedef struct pc_exact {
    pc_plane plane[4];
    pc_point point, line, planes, other; /* other: planes 0, 1 and 3 */
    int sign[PC_KINDS];
} pc_exact;

static inline int pc_exact_orient2d(const double a[2], const double b[2], const double c[2]) {
    return big_sign(big_orient2d(a, b, c));
}
static inline int pc_exact_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
    return -big_sign(big_orient3d(a, b, c, d));
}

/* By the lifting to a paraboloid about the first point: determinant of the other points' differences and their squared
 * lengths. */
static inline int pc_exact_incircle(const double (*p)[3]) {
    big row[3][3];
    int i;
    for (i = 0; i < 3; i++) {
        big d[3];
        big_difference(p[i + 1], p[0], d);
        row[i][0] = d[0];
        row[i][1] = d[1];
        row[i][2] = big_add(big_mul(d[0], d[0]), big_mul(d[1], d[1]));
    }
    return -big_sign(big_det3(row[0], row[1], row[2]));
}

static inline int pc_exact_insphere(const double (*p)[3]) {
    big d[4][3], lift[4], sum = big_zero();
    int i;
    for (i = 0; i < 4; i++) {
        big_difference(p[i + 1], p[0], d[i]);
        lift[i] = big_dot(d[i], d[i]);
    }
    for (i = 0; i < 4; i++) {
        const big minor = big_det3(d[i == 0], d[i <= 1 ? 2 : 1], d[i <= 2 ? 3 : 2]);
        sum = i % 2 == 1 ? big_add(sum, big_mul(lift[i], minor)) : big_sub(sum, big_mul(lift[i], minor));
    }
    return big_sign(sum);
}

/* 0: one of the three has no plane. The numbers live until the arena is released. */
static inline int pc_answer(const pc_case *c, int axis, pc_exact *e) {
    const double *o = c->plane[0][0];
    int i;
    for (i = 0; i < 4; i++) {
        e->plane[i] = pc_exact_plane(c->plane[i], o);
        if (e->plane[i].n[0].sign == 0 && e->plane[i].n[1].sign == 0 && e->plane[i].n[2].sign == 0) return 0;
    }
    e->point = pc_exact_explicit(c->point, o);
    e->line = pc_exact_line(c->line, &e->plane[0], o);
    e->planes = pc_exact_planes(&e->plane[0], &e->plane[1], &e->plane[2]);
    e->other = pc_exact_planes(&e->plane[0], &e->plane[1], &e->plane[3]);
    for (i = 0; i < PC_KINDS; i++) e->sign[i] = PC_INVALID;
    e->sign[PC_ORIENT2D] = pc_exact_orient2d(c->point, c->line[0], c->line[1]);
    e->sign[PC_ORIENT3D] = pc_exact_orient3d(c->plane[3][0], c->plane[3][1], c->plane[3][2], c->point);
    e->sign[PC_SIDE_EXPLICIT] = pc_exact_side(&e->point, &e->plane[3]);
    if (e->line.w.sign != 0) e->sign[PC_SIDE_LINE] = pc_exact_side(&e->line, &e->plane[3]);
    if (e->planes.w.sign != 0) e->sign[PC_SIDE_PLANES] = pc_exact_side(&e->planes, &e->plane[3]);
    e->sign[PC_INCIRCLE] = pc_exact_incircle(c->circle);
    e->sign[PC_INSPHERE] = pc_exact_insphere(c->sphere);
    if (e->planes.w.sign != 0 && e->line.w.sign != 0) {
        e->sign[PC_COMPARE] = pc_exact_compare(&e->line, &e->planes, axis);
        if (e->other.w.sign != 0)
            e->sign[PC_ORIENT_IN_PLANE] = pc_exact_orient(&e->line, &e->planes, &e->other, &e->plane[0]);
    }
    return 1;
}

/* ---- the kernel's answers ---- */
typedef struct pc_objects {
    const pc_case *input;
    int axis;
    gxb_plane plane[4];
    gxb_point point, line, planes, other;
} pc_objects;

static inline void pc_build(const pc_case *c, int axis, pc_objects *k) {
    int i;
    k->input = c;
    k->axis = axis;
    for (i = 0; i < 4; i++) gxb_plane_init(&k->plane[i], c->plane[i][0], c->plane[i][1], c->plane[i][2]);
    gxb_point_explicit(&k->point, c->point);
    gxb_point_line_plane(&k->line, c->line[0], c->line[1], &k->plane[0]);
    gxb_point_three_planes(&k->planes, &k->plane[0], &k->plane[1], &k->plane[2]);
    gxb_point_three_planes(&k->other, &k->plane[0], &k->plane[1], &k->plane[3]);
}

static inline int pc_call(const pc_objects *k, int kind) {
    const pc_case *c = k->input;
    switch (kind) {
    case PC_ORIENT2D: return gxb_orient2d(c->point, c->line[0], c->line[1]);
    case PC_ORIENT3D: return gxb_orient3d(c->plane[3][0], c->plane[3][1], c->plane[3][2], c->point);
    case PC_SIDE_EXPLICIT: return gxb_side(&k->point, &k->plane[3]);
    case PC_SIDE_LINE: return gxb_side(&k->line, &k->plane[3]);
    case PC_SIDE_PLANES: return gxb_side(&k->planes, &k->plane[3]);
    case PC_INCIRCLE: return gxb_incircle(c->circle[0], c->circle[1], c->circle[2], c->circle[3]);
    case PC_INSPHERE: return gxb_insphere(c->sphere[0], c->sphere[1], c->sphere[2], c->sphere[3], c->sphere[4]);
    case PC_COMPARE: return gxb_compare(&k->line, &k->planes, k->axis);
    default: return gxb_orient_in_plane(&k->line, &k->planes, &k->other, &k->plane[0]);
    }
}

/* ---- the filter's bounds against the true errors: a bound that is too small shows here long before it costs a sign
   ---- */

/* |value - num / den| as a share of the bound; above 1 the bound is wrong. */
static inline double pc_share(double value, big offset, big num, big den, double bound) {
    const big v = big_sub(big_from_double(value), offset);
    const rat error = rat_ratio(big_abs(big_sub(big_mul(v, den), num)), big_abs(big_mul(den, big_from_double(bound))));
    return rat_to_double(error);
}

static inline void pc_worst(double *worst, double share) {
    if (share > *worst) *worst = share;
}

#define PC_NO_BALL gxbp_power(200) /* the error of a point that has no ball, as in the kernel */
enum { PC_BOUND_NORMAL, PC_BOUND_LINE, PC_BOUND_PLANES, PC_BOUND_SIDE, PC_BOUNDS };
static const char *const pc_bound_names[PC_BOUNDS] = {"normal", "line-plane ball", "three-plane ball", "side"};

static inline void pc_ball_share(const gxb_ball *ball, const pc_point *x, const double o[3], double *worst) {
    int k;
    if (x->w.sign == 0 || !(ball->error < PC_NO_BALL)) return;
    for (k = 0; k < 3; k++) pc_worst(worst, pc_share(ball->x[k], big_from_double(o[k]), x->x[k], x->w, ball->error));
}

static inline void pc_side_share(const gxb_ball *ball, const pc_point *x, const gxb_plane *f, const pc_plane *plane,
                                 double *worst) {
    double value, bound;
    if (x->w.sign == 0 || !(ball->error < PC_NO_BALL)) return;
    value = gxbp_filter_side(ball, &f->filter, &bound);
    pc_worst(worst, pc_share(value, big_zero(), pc_scaled_height(x, plane), x->w, bound));
}

/* Largest shares over one case. */
static inline void pc_bound_shares(const pc_objects *k, const pc_exact *e, double worst[PC_BOUNDS]) {
    const double *o = k->input->plane[0][0];
    int i, j;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 3; j++)
            pc_worst(&worst[PC_BOUND_NORMAL], pc_share(k->plane[i].filter.n[j], big_zero(), e->plane[i].n[j],
                                                       big_from_int(1), k->plane[i].filter.error));
    pc_ball_share(&k->line.ball, &e->line, o, &worst[PC_BOUND_LINE]);
    pc_ball_share(&k->planes.ball, &e->planes, o, &worst[PC_BOUND_PLANES]);
    pc_ball_share(&k->other.ball, &e->other, o, &worst[PC_BOUND_PLANES]);
    pc_side_share(&k->point.ball, &e->point, &k->plane[3], &e->plane[3], &worst[PC_BOUND_SIDE]);
    pc_side_share(&k->line.ball, &e->line, &k->plane[3], &e->plane[3], &worst[PC_BOUND_SIDE]);
    pc_side_share(&k->planes.ball, &e->planes, &k->plane[3], &e->plane[3], &worst[PC_BOUND_SIDE]);
}

#endif /* GXFEM_TESTS_PREDICATE_CASES_H */
