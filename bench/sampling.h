/* sampling.h - quadrature over parts of the unit tetrahedron by points: three other ways than RXFEM's
   (bench/rxfem.h).

   A sampling_region tells which part contains a point. The region of one surface has one part, on or under the
   surface: the points from which a ray upward (along z) meets its triangles an odd number of times.
       sampling_regular    n^3 cells of the tetrahedron's bounding box, a point in the middle of each: RXFEM's Table
                           1 with n = 50
       sampling_adaptive   the tetrahedron in eight, and again those that the surface meets, to a depth; points in
                           the part. RXFEM's Table 1 has this after Mueller et al. (2012) with depth 4. By its counts
                           there is one point in each tetrahedron for integrands of degree 1, and there are four for
                           degree 2. The surface meets a tetrahedron with corners or middles of edges in several
                           parts
       sampling_positive   positive weights at inner points, no more points than monomials, from exact moments: a
                           positive rule on tetrahedra that make up the part. Its points enter a basis of the moments
                           one by one, each in place of one that leaves (Caratheodory; Tchakaloff's theorem). Then
                           the least change of weights that gives the exact moments

   Include after the implementation of gxfem_boolean.h. Out of memory ends the program. */
#ifndef BENCH_SAMPLING_H
#define BENCH_SAMPLING_H

#include "dense.h"

#include <stdint.h>

static const double SAMPLING_PIVOT = 1e-7, SAMPLING_SLACK = 1e-12;

enum { SAMPLING_COLUMNS = 64, SAMPLING_DEGREE_MAX = 4, SAMPLING_MONOMIALS = 35 };

typedef struct sampling_rule {
    double *points; /* count x 4: x y z and weight */
    int *parts;     /* count: of the region; sampling_positive's: 0 */
    size_t count, capacity;
} sampling_rule;

/* The number of the part that contains x; SAMPLING_OUTSIDE: none of those wanted */
typedef struct sampling_region {
    int (*part_of)(const void *user, const double *x);
    const void *user;
} sampling_region;

enum { SAMPLING_OUTSIDE = -1 };

static inline void sampling_add(sampling_rule *r, double x, double y, double z, double weight) {
    double *p;
    if (r->count == r->capacity) {
        r->capacity = 2 * r->capacity + 64;
        r->points = (double *)dense_memory(r->points, 4 * r->capacity, sizeof(double));
        r->parts = (int *)dense_memory(r->parts, r->capacity, sizeof(int));
    }
    r->parts[r->count] = 0;
    p = r->points + 4 * r->count++;
    p[0] = x;
    p[1] = y;
    p[2] = z;
    p[3] = weight;
}

static inline void sampling_free(sampling_rule *r) {
    free(r->points);
    free(r->parts);
    memset(r, 0, sizeof *r);
}

/* ---- inside ---- */

/* Triangles by the columns over the unit square that they meet; borrowed */
typedef struct sampling_surface {
    const double *vertices;
    const uint32_t *triangles;
    uint32_t *first, *items; /* SAMPLING_COLUMNS^2 + 1; triangles */
} sampling_surface;

static inline void sampling_columns(const sampling_surface *s, size_t triangle, int low[2], int high[2]) {
    int a, v;
    for (a = 0; a < 2; a++) {
        double least = 2, most = -1;
        for (v = 0; v < 3; v++) {
            const double x = s->vertices[3 * (size_t)s->triangles[3 * triangle + (size_t)v] + (size_t)a];
            least = fmin(least, x);
            most = fmax(most, x);
        }
        low[a] = (int)fmax(0, fmin(SAMPLING_COLUMNS, floor(least * SAMPLING_COLUMNS)));
        high[a] = (int)fmax(-1, fmin(SAMPLING_COLUMNS - 1, floor(most * SAMPLING_COLUMNS)));
    }
}

static inline sampling_surface sampling_surface_create(const double *vertices, const uint32_t *triangles,
                                                       size_t triangle_count) {
    enum { CELLS = SAMPLING_COLUMNS * SAMPLING_COLUMNS };
    sampling_surface s;
    size_t t, c;
    int low[2], high[2], i, j, pass;
    s.vertices = vertices;
    s.triangles = triangles;
    s.items = NULL;
    s.first = (uint32_t *)dense_memory(NULL, CELLS + 1, sizeof(uint32_t));
    memset(s.first, 0, (CELLS + 1) * sizeof(uint32_t));
    for (pass = 0; pass < 2; pass++) {
        for (t = 0; t < triangle_count; t++) {
            sampling_columns(&s, t, low, high);
            for (i = low[0]; i <= high[0]; i++)
                for (j = low[1]; j <= high[1]; j++) {
                    if (pass == 0)
                        s.first[i * SAMPLING_COLUMNS + j]++;
                    else
                        s.items[--s.first[i * SAMPLING_COLUMNS + j]] = (uint32_t)t;
                }
        }
        for (c = 1; pass == 0 && c <= CELLS; c++) s.first[c] += s.first[c - 1];
        if (pass == 0) s.items = (uint32_t *)dense_memory(NULL, s.first[CELLS], sizeof(uint32_t));
    }
    return s;
}

static inline void sampling_surface_free(sampling_surface *s) {
    free(s->first);
    free(s->items);
}

/* Is x strictly to the left of the line from vertex a to b in the plane? The same answer for both triangles at an
   edge */
static inline int sampling_left(const sampling_surface *s, uint32_t a, uint32_t b, const double *x) {
    if (a < b) return gxb_orient2d(s->vertices + 3 * (size_t)a, s->vertices + 3 * (size_t)b, x) > 0;
    return gxb_orient2d(s->vertices + 3 * (size_t)b, s->vertices + 3 * (size_t)a, x) <= 0;
}

/* Does the ray upward from x meet the triangle? */
static inline int sampling_meets(const sampling_surface *s, uint32_t triangle, const double *x) {
    const uint32_t *t = s->triangles + 3 * (size_t)triangle;
    const double *a = s->vertices + 3 * (size_t)t[0], *b = s->vertices + 3 * (size_t)t[1],
                 *c = s->vertices + 3 * (size_t)t[2];
    const int left = sampling_left(s, t[0], t[1], x);
    if (sampling_left(s, t[1], t[2], x) != left || sampling_left(s, t[2], t[0], x) != left) return 0;
    return left ? gxb_orient3d(a, b, c, x) >= 0 : gxb_orient3d(a, b, c, x) <= 0;
}

static inline int sampling_inside(const sampling_surface *s, const double *x) {
    const int i = (int)fmax(0, fmin(SAMPLING_COLUMNS - 1, floor(x[0] * SAMPLING_COLUMNS)));
    const int j = (int)fmax(0, fmin(SAMPLING_COLUMNS - 1, floor(x[1] * SAMPLING_COLUMNS)));
    const int column = i * SAMPLING_COLUMNS + j;
    uint32_t k;
    int odd = 0;
    for (k = s->first[column]; k < s->first[column + 1]; k++) odd ^= sampling_meets(s, s->items[k], x);
    return odd;
}

static inline int sampling_part_under(const void *surface, const double *x) {
    return sampling_inside((const sampling_surface *)surface, x) ? 0 : SAMPLING_OUTSIDE;
}

static inline sampling_region sampling_under(const sampling_surface *s) {
    sampling_region region;
    region.part_of = sampling_part_under;
    region.user = s;
    return region;
}

/* ---- regular ---- */

static inline void sampling_regular(const sampling_region *region, int n, sampling_rule *r) {
    const double weight = 1.0 / n / n / n;
    double x[3];
    int i, j, k, found;
    r->count = 0;
    for (i = 0; i < n; i++)
        for (j = 0; i + j + 1.5 <= n; j++)
            for (k = 0; i + j + k + 1.5 <= n; k++) {
                x[0] = (i + 0.5) / n;
                x[1] = (j + 0.5) / n;
                x[2] = (k + 0.5) / n;
                found = region->part_of(region->user, x);
                if (found == SAMPLING_OUTSIDE) continue;
                sampling_add(r, x[0], x[1], x[2], weight);
                r->parts[r->count - 1] = found;
            }
}

/* ---- adaptive ---- */

/* A rule of the degree on a tetrahedron (corners x 3), positive: its middle, four points, or a product of Gauss points,
 * collapsed */
static inline void sampling_tetrahedron(const double *p, unsigned degree, sampling_rule *r);

/* Corners and middles of edges: 0 1 2 3, 01 02 03 12 13 23 */
typedef struct sampling_cell {
    double x[10][3];
    int part[10];
} sampling_cell;

static inline void sampling_middles(const sampling_region *region, sampling_cell *c) {
    static const int edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    int e, a, k;
    for (e = 0; e < 6; e++)
        for (a = 0; a < 3; a++) c->x[4 + e][a] = 0.5 * (c->x[edge[e][0]][a] + c->x[edge[e][1]][a]);
    for (k = 0; k < 10; k++) c->part[k] = region->part_of(region->user, c->x[k]);
}

static inline void sampling_leaf(const sampling_region *region, const sampling_cell *c, unsigned degree,
                                 sampling_rule *r) {
    const size_t before = r->count;
    size_t i, kept = before;
    sampling_tetrahedron(c->x[0], degree, r);
    for (i = before; i < r->count; i++) {
        const int found = region->part_of(region->user, r->points + 4 * i);
        if (found == SAMPLING_OUTSIDE) continue;
        r->parts[kept] = found;
        memmove(r->points + 4 * kept++, r->points + 4 * i, 4 * sizeof(double));
    }
    r->count = kept;
}

static inline void sampling_refine(const sampling_region *region, sampling_cell *c, unsigned degree, int depth,
                                   sampling_rule *r) {
    static const int child[8][4] = {{0, 4, 5, 6},
                                    {4, 1, 7, 8},
                                    {5, 7, 2, 9},
                                    {6, 8, 9, 3}, /* at the corners */
                                    /* around the diagonal 02, 13 */
                                    {4, 5, 6, 8},
                                    {4, 7, 5, 8},
                                    {5, 9, 6, 8},
                                    {5, 7, 9, 8}};
    int i, k, same = 1;
    sampling_middles(region, c);
    for (k = 1; k < 10; k++) same &= c->part[k] == c->part[0];
    if (depth == 0 || same) {
        sampling_leaf(region, c, degree, r);
        return;
    }
    for (i = 0; i < 8; i++) {
        sampling_cell inner;
        for (k = 0; k < 4; k++) memcpy(inner.x[k], c->x[child[i][k]], sizeof inner.x[k]);
        sampling_refine(region, &inner, degree, depth - 1, r);
    }
}

/* degree: of the rule in each tetrahedron */
static inline void sampling_adaptive(const sampling_region *region, unsigned degree, int depth, sampling_rule *r) {
    sampling_cell c;
    int k;
    memset(&c, 0, sizeof c);
    for (k = 0; k < 3; k++) c.x[k + 1][k] = 1;
    r->count = 0;
    sampling_refine(region, &c, degree, depth, r);
}

/* ---- positive ---- */

static inline double sampling_volume(const double *p) {
    double u[3], v[3], w[3];
    int a;
    for (a = 0; a < 3; a++) {
        u[a] = p[3 + a] - p[a];
        v[a] = p[6 + a] - p[a];
        w[a] = p[9 + a] - p[a];
    }
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
            u[2] * (v[0] * w[1] - v[1] * w[0])) /
           6;
}

/* At barycentric coordinates of corners 1, 2, 3 */
static inline void sampling_add_at(const double *p, const double *lambda, double weight, sampling_rule *r) {
    double x[3];
    int a, k;
    for (a = 0; a < 3; a++)
        for (x[a] = p[a], k = 0; k < 3; k++) x[a] += lambda[k] * (p[3 * (k + 1) + a] - p[a]);
    sampling_add(r, x[0], x[1], x[2], weight);
}

/* Gauss-Legendre with 4 points, exact to degree 7: two for the collapse, so to degree 5 */
static inline void sampling_collapsed(const double *p, double volume, sampling_rule *r) {
    static const double at[4] = {0.069431844202973712, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
    static const double weight[4] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                     0.17392742256872693};
    double lambda[3];
    int i, j, k;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++)
            for (k = 0; k < 4; k++) {
                const double rest = 1 - at[i], last = rest * (1 - at[j]);
                lambda[0] = at[i];
                lambda[1] = rest * at[j];
                lambda[2] = last * at[k];
                sampling_add_at(p, lambda, 6 * volume * weight[i] * weight[j] * weight[k] * rest * last, r);
            }
}

static inline void sampling_tetrahedron(const double *p, unsigned degree, sampling_rule *r) {
    /* (5 -+ sqrt 5) / 20 and the rest */
    const double volume = sampling_volume(p), inner = 0.13819660112501052, outer = 0.58541019662496845;
    double lambda[3];
    int i, k;
    if (degree > 2) sampling_collapsed(p, volume, r);
    for (i = 0; i < 4 && degree <= 2; i++) {
        for (k = 0; k < 3; k++) lambda[k] = degree < 2 ? 0.25 : k + 1 == i ? outer : inner;
        sampling_add_at(p, lambda, degree < 2 ? volume : volume / 4, r);
        if (degree < 2) return;
    }
}

/* Monomials to the degree, in the order of gxfem_integrate.h; returns how many */
static inline size_t sampling_monomials(unsigned degree, const double *x, double *values) {
    size_t count = 0;
    unsigned n, m, k;
    for (n = 0; n <= degree; n++)
        for (m = 0; m <= n; m++)
            for (k = 0; k <= m; k++) {
                double value = 1;
                unsigned e;
                for (e = 0; e < n - m; e++) value *= x[0];
                for (e = 0; e < m - k; e++) value *= x[1];
                for (e = 0; e < k; e++) value *= x[2];
                values[count++] = value;
            }
    return count;
}

/* A rule with as many points as monomials. inverse: of the matrix whose columns are the points' monomials; a column
   that is still that of a unit matrix belongs to no point and has weight 0. */
typedef struct sampling_basis {
    size_t count;
    double total; /* of all weights that have entered */
    int taken[SAMPLING_MONOMIALS];
    double point[SAMPLING_MONOMIALS][3], weight[SAMPLING_MONOMIALS];
    double inverse[SAMPLING_MONOMIALS][SAMPLING_MONOMIALS];
} sampling_basis;

/* Replaces column `leaves` by one that is B y: its row of the inverse is divided by y there, and multiples of it are
   subtracted from the others. */
static inline void sampling_exchange(sampling_basis *b, size_t leaves, const double *y) {
    double *row = b->inverse[leaves];
    size_t i, k;
    for (k = 0; k < b->count; k++) row[k] /= y[leaves];
    for (i = 0; i < b->count; i++)
        if (i != leaves) dense_add(b->inverse[i], -y[i], row, b->count);
}

/* The column that a new one, B y, replaces, and how much of its weight w goes to the others first. An unused column
   is replaced at once. Else it is one of those whose weights reach 0 first as they change by y, within
   SAMPLING_SLACK of all weight: the one with the largest y [Harris 1973]. count: none. y below SAMPLING_PIVOT is a
   rounding error. */
static inline size_t sampling_leaving(const sampling_basis *b, const double *y, double w, double *moved) {
    const double slack = SAMPLING_SLACK * b->total;
    double most = SAMPLING_PIVOT, limit = w;
    size_t i, leaves = b->count;
    *moved = 0;
    for (i = 0; i < b->count; i++)
        if (!b->taken[i] && fabs(y[i]) > most) {
            most = fabs(y[i]);
            leaves = i;
        }
    if (leaves < b->count) return leaves;
    for (i = 0; i < b->count; i++)
        if (b->taken[i] && y[i] < -SAMPLING_PIVOT && b->weight[i] + slack < -y[i] * limit)
            limit = -(b->weight[i] + slack) / y[i];
    for (i = 0; i < b->count && limit < w; i++)
        if (b->taken[i] && y[i] < -most && b->weight[i] <= -y[i] * limit) {
            most = -y[i];
            leaves = i;
        }
    *moved = leaves < b->count ? fmin(w, -b->weight[leaves] / y[leaves]) : w;
    return leaves;
}

/* Adds a point (x y z weight) without a change of moments, in O(count^2). */
static inline void sampling_enter(sampling_basis *b, const double *p, unsigned degree, const double scale[4]) {
    double values[SAMPLING_MONOMIALS], y[SAMPLING_MONOMIALS], x[3], moved;
    size_t i, leaves;
    int a;
    for (a = 0; a < 3; a++) x[a] = (p[a] - scale[a]) * scale[3];
    sampling_monomials(degree, x, values);
    for (i = 0; i < b->count; i++) y[i] = dense_dot(b->inverse[i], values, b->count);
    b->total += p[3];
    leaves = sampling_leaving(b, y, p[3], &moved);
    for (i = 0; i < b->count; i++)
        if (b->taken[i]) b->weight[i] = fmax(0, b->weight[i] + moved * y[i]);
    if (leaves == b->count) return;
    sampling_exchange(b, leaves, y);
    memcpy(b->point[leaves], p, sizeof b->point[leaves]);
    b->weight[leaves] = p[3] - moved;
    b->taken[leaves] = 1;
}

/* Centre and 1 / size of the box around points: monomials in its frame are about 1. */
static inline void sampling_scale(const double *points, size_t count, double scale[4]) {
    size_t i;
    int a;
    scale[3] = 0;
    for (a = 0; a < 3; a++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (i = 0; i < count; i++) {
            low = fmin(low, points[3 * i + (size_t)a]);
            high = fmax(high, points[3 * i + (size_t)a]);
        }
        scale[a] = 0.5 * (low + high);
        scale[3] = fmax(scale[3], 0.5 * (high - low));
    }
    scale[3] = 1 / scale[3];
}

/* The least change of weights, each in proportion to itself, that gives the exact moments. If a weight would become
   negative, the rule stays as it is. */
static inline void sampling_correct(sampling_rule *r, unsigned degree, const double *moments) {
    double a[SAMPLING_MONOMIALS * SAMPLING_MONOMIALS], values[SAMPLING_MONOMIALS], left[SAMPLING_MONOMIALS],
        change[SAMPLING_MONOMIALS];
    const size_t n = r->count, m = (degree + 1) * (degree + 2) * (degree + 3) / 6;
    size_t i, j;
    pinv inverse;
    int positive = 1;
    memset(&inverse, 0, sizeof inverse);
    memset(a, 0, sizeof a);
    for (j = 0; j < n; j++) {
        sampling_monomials(degree, r->points + 4 * j, values);
        for (i = 0; i < m; i++) a[i * n + j] = values[i] * r->points[4 * j + 3];
    }
    for (i = 0; i < m; i++)
        for (left[i] = moments[i], j = 0; j < n; j++) left[i] -= a[i * n + j];
    pinv_factor(&inverse, a, m, n, 1e-13);
    pinv_solve(&inverse, left, change);
    pinv_free(&inverse);
    for (j = 0; j < n; j++) positive &= change[j] > -1;
    for (j = 0; j < n && positive; j++) r->points[4 * j + 3] *= 1 + change[j];
}

typedef struct sampling_sized {
    double volume;
    const double *corners;
} sampling_sized;

static inline int sampling_larger(const void *a, const void *b) {
    const double x = ((const sampling_sized *)a)->volume, y = ((const sampling_sized *)b)->volume;
    return (x < y) - (x > y);
}

/* Largest first: a basis that begins in a sliver is nearly singular, and its inverse keeps the errors. */
static inline sampling_sized *sampling_sort(const double *tetrahedra, size_t count) {
    sampling_sized *list = (sampling_sized *)dense_memory(NULL, count, sizeof *list);
    size_t t;
    for (t = 0; t < count; t++) {
        list[t].corners = tetrahedra + 12 * t;
        list[t].volume = sampling_volume(list[t].corners);
    }
    qsort(list, count, sizeof *list, sampling_larger);
    return list;
}

/* tetrahedra: count x 4 corners x 3, of positive volume. moments: of the part that they make up, as
   gxi_polyhedron_monomials gives them */
static inline void sampling_positive(const double *tetrahedra, size_t count, unsigned degree, const double *moments,
                                     sampling_rule *r) {
    sampling_sized *list = sampling_sort(tetrahedra, count);
    sampling_basis b;
    sampling_rule one;
    double scale[4];
    size_t t, i;
    memset(&one, 0, sizeof one);
    memset(&b, 0, sizeof b);
    b.count = (degree + 1) * (degree + 2) * (degree + 3) / 6;
    for (i = 0; i < b.count; i++) b.inverse[i][i] = 1;
    sampling_scale(tetrahedra, 4 * count, scale);
    for (t = 0; t < count; t++) {
        one.count = 0;
        sampling_tetrahedron(list[t].corners, degree, &one);
        for (i = 0; i < one.count; i++) sampling_enter(&b, one.points + 4 * i, degree, scale);
    }
    sampling_free(&one);
    free(list);
    r->count = 0;
    for (i = 0; i < b.count; i++)
        if (b.taken[i] && b.weight[i] > 0) sampling_add(r, b.point[i][0], b.point[i][1], b.point[i][2], b.weight[i]);
    sampling_correct(r, degree, moments);
}

#endif
