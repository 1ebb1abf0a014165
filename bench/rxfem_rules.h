/* rxfem_rules.h - RXFEM's quadrature for one side of a patch in one element: hierarchical moment fitting (RXFEM section
   5). See bench/rxfem.h, which finds the patches, for what is chosen where the paper leaves something open.

   Everything is in the element's reference frame: corners 0 and the unit vectors. A rule is its moments (monomials to
   its degree) and a fixed matrix that makes weights at fixed points of them (Eq. 17). Moments come from the boundary:
   from rules on the faces, whose moments come from their own boundary, and an interface whose rule is fitted in a
   divergence-free basis (Eq. 20, 21).

   Sources of points: triangle 6 and 19: Dunavant (1985), tetrahedron 24: Keast (1986), which are those of Zhang, Cui,
   Liu (2009) that the paper takes. Other degrees (RXFEM has none) use products of Gauss points, collapsed. Out of
   memory ends the program. */
#ifndef BENCH_RXFEM_RULES_H
#define BENCH_RXFEM_RULES_H

#include "dense.h"

enum {
    RX_DEGREE_MAX = 4, /* of a volume rule */
    RX_MOMENTS = 35,   /* of a volume rule: monomials to its degree */
    RX_MONOMIALS = 84, /* in space, to degree RX_DEGREE_MAX + 2 */
    RX_FIELDS = 133,   /* divergence-free, in space, to degree RX_DEGREE_MAX + 1 */
    RX_POINTS = 125,   /* of a volume rule */
    RX_FACE_POINTS = 49,
    RX_GAUSS = 4,   /* points on a segment */
    RX_TRIANGLE = 6 /* points on a triangle of the interface */
};

static const double RX_CUTOFF = 1e-12; /* singular values below this share of the largest count as 0 */

/* ---- polynomials: in the plane (dimension 2) and in space (3) on the reference simplex, coordinates as corners 0 and
 * unit vectors ---- */

typedef struct rx_basis {
    int dimension;
    unsigned degree;
    size_t count;
    unsigned char exponent[RX_MONOMIALS][3];
} rx_basis;

static inline void rx_basis_init(rx_basis *b, int dimension, unsigned degree) {
    unsigned n, i, j;
    b->dimension = dimension;
    b->degree = degree;
    b->count = 0;
    for (n = 0; n <= degree; n++)
        for (i = n + 1; i-- > 0;)
            for (j = n - i + 1; j-- > 0;) {
                if (dimension == 2 && i + j < n) continue;
                b->exponent[b->count][0] = (unsigned char)i;
                b->exponent[b->count][1] = (unsigned char)j;
                b->exponent[b->count++][2] = (unsigned char)(n - i - j);
            }
}

static inline size_t rx_basis_index(const rx_basis *b, unsigned i, unsigned j, unsigned k) {
    const unsigned n = i + j + k, m = j + k;
    return b->dimension == 2 ? n * (n + 1) / 2 + j : n * (n + 1) * (n + 2) / 6 + m * (m + 1) / 2 + k;
}

static inline void rx_basis_values(const rx_basis *b, const double *x, double *values) {
    double power[3][RX_DEGREE_MAX + 3];
    size_t i;
    unsigned n;
    for (i = 0; i < 3; i++)
        for (power[i][0] = 1, n = 1; n <= b->degree; n++)
            power[i][n] = power[i][n - 1] * (i < (size_t)b->dimension ? x[i] : 0);
    for (i = 0; i < b->count; i++)
        values[i] = power[0][b->exponent[i][0]] * power[1][b->exponent[i][1]] * power[2][b->exponent[i][2]];
}

/* Over the reference simplex: i! j! k! / (i + j + k + dimension)! */
static inline double rx_simplex_integral(int dimension, unsigned i, unsigned j, unsigned k) {
    double value = 1;
    unsigned n, m = 0;
    const unsigned e[3] = {i, j, k};
    size_t a;
    for (a = 0; a < 3; a++)
        for (n = 1; n <= e[a]; n++) value *= (double)n / ++m;
    for (n = 1; n <= (unsigned)dimension; n++) value /= ++m;
    return value;
}

/* Divergence-free field: x^e along axis, and along the last axis what takes its divergence away: factor x^f [Mueller et
 * al. 2013] */
typedef struct rx_field {
    int axis;
    size_t monomial, rest;
    double factor;
} rx_field;

static inline size_t rx_fields(const rx_basis *b, rx_field *fields) {
    const int last = b->dimension - 1;
    size_t count = 0, m;
    int axis;
    for (axis = 0; axis <= last; axis++)
        for (m = 0; m < b->count; m++) {
            unsigned e[3] = {b->exponent[m][0], b->exponent[m][1], b->exponent[m][2]};
            rx_field *f = &fields[count];
            if (axis == last && e[last] > 0) continue;
            f->axis = axis;
            f->monomial = f->rest = m;
            f->factor = 0;
            if (axis < last && e[axis] > 0) {
                f->factor = -(double)e[axis] / (e[last] + 1);
                e[axis]--;
                e[last]++;
                f->rest = rx_basis_index(b, e[0], e[1], e[2]);
            }
            count++;
        }
    return count;
}

/* fields . n from the values of the monomials */
static inline void rx_field_fluxes(const rx_basis *b, const rx_field *fields, size_t count, const double *values,
                                   const double *n, double *flux) {
    size_t i;
    for (i = 0; i < count; i++)
        flux[i] = n[fields[i].axis] * values[fields[i].monomial] +
                  fields[i].factor * n[b->dimension - 1] * values[fields[i].rest];
}

/* flux[i] of the antiderivatives of the first `count` monomials: mean over the axes of n_a integral along a of x^e. b:
 * one degree more */
static inline void rx_antiderivatives(const rx_basis *b, size_t count, const double *values, const double *n,
                                      double *flux) {
    size_t i;
    int a;
    for (i = 0; i < count; i++)
        for (flux[i] = 0, a = 0; a < b->dimension; a++) {
            unsigned e[3] = {b->exponent[i][0], b->exponent[i][1], b->exponent[i][2]};
            e[a]++;
            flux[i] += n[a] * values[rx_basis_index(b, e[0], e[1], e[2])] / ((double)e[a] * b->dimension);
        }
}

/* From a symmetric Gram matrix (n x n) the triangular C that makes its functions orthonormal: C G C^T = 1
 * [Gram-Schmidt]. In place. */
static inline void rx_orthonormalise(double *g, size_t n) {
    size_t i, j, k;
    for (i = 0; i < n; i++) /* G = L L^T */
        for (j = 0; j <= i; j++) {
            double sum = g[i * n + j] - dense_dot(g + i * n, g + j * n, j);
            g[i * n + j] = i == j ? sqrt(sum) : sum / g[j * n + j];
        }
    for (j = 0; j < n; j++) { /* C = L^-1, column by column from the right of what is still L */
        g[j * n + j] = 1 / g[j * n + j];
        for (i = j + 1; i < n; i++) {
            double sum = 0;
            for (k = j; k < i; k++) sum += g[i * n + k] * g[k * n + j];
            g[i * n + j] = -sum / g[i * n + i];
        }
        for (i = 0; i < j; i++) g[i * n + j] = 0;
    }
}

/* ---- points ---- */

static const double RX_GAUSS_AT[RX_GAUSS] = {/* Gauss-Legendre on [0, 1] */
                                             0.069431844202973712, 0.33000947820757187, 0.66999052179242813,
                                             0.93056815579702629};
static const double RX_GAUSS_WEIGHT[RX_GAUSS] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                                 0.17392742256872693};

/* Barycentric coordinates that are permuted in all ways: two different (a, 1 - a in triples or pairs), or three (a, b,
 * the rest) */
typedef struct rx_orbit {
    int kind;
    double a, b;
} rx_orbit;
enum { RX_CENTRE = 1, RX_THREE = 3, RX_SIX = 6, RX_FOUR = 4, RX_TWELVE = 12 };

static const rx_orbit RX_TRIANGLE_6[] = {{RX_THREE, 0.44594849091596488, 0}, {RX_THREE, 0.091576213509770743, 0}};
/* clang-format off */
static const rx_orbit RX_TRIANGLE_19[] = {
    {RX_CENTRE, 0, 0}, {RX_THREE, 0.48968251919873762, 0}, {RX_THREE, 0.43708959149293663, 0}, {RX_THREE, 0.18820353561903273, 0},
    {RX_THREE, 0.044729513394452709, 0}, {RX_SIX, 0.22196298916076569, 0.036838412054736283}};
/* clang-format on */
/* clang-format off */
static const rx_orbit RX_TETRAHEDRON_24[] = {
    {RX_FOUR, 0.21460287125915203, 0}, {RX_FOUR, 0.040673958534611354, 0}, {RX_FOUR, 0.32233789014227551, 0},
    {RX_TWELVE, 0.063661001875017525, 0.26967233145831581}};
/* clang-format on */

/* Points (x 3) of an orbit; lambda[0] is the coordinate that is not stored */
static inline size_t rx_orbit_points(const rx_orbit *o, double (*points)[3]) {
    const int corners = o->kind == RX_FOUR || o->kind == RX_TWELVE ? 4 : 3;
    const int pair = o->kind == RX_SIX || o->kind == RX_TWELVE;
    const double odd = 1 - (pair ? o->b + (corners - 2) * o->a : (corners - 1) * o->a);
    size_t count = 0;
    int i, j, k;
    for (i = 0; i < corners; i++)
        for (j = 0; j < (pair ? corners : 1); j++) {
            double lambda[4] = {0, 0, 0, 0};
            if (pair && i == j) continue;
            for (k = 0; k < corners; k++)
                lambda[k] = o->kind == RX_CENTRE ? 1.0 / 3 : k == i ? odd : pair && k == j ? o->b : o->a;
            memcpy(points[count++], lambda + 1, 3 * sizeof(double));
            if (o->kind == RX_CENTRE) return count;
        }
    return count;
}

static inline size_t rx_orbits_points(const rx_orbit *orbits, size_t orbit_count, double (*points)[3]) {
    size_t count = 0, i;
    for (i = 0; i < orbit_count; i++) count += rx_orbit_points(&orbits[i], points + count);
    return count;
}

/* The k-th of n Gauss-Legendre points on [0, 1]: Newton on the Legendre polynomial */
static inline double rx_gauss_point(int n, int k) {
    double x = cos(3.14159265358979323846 * (k + 0.75) / (n + 0.5));
    int i, j;
    for (i = 0; i < 50; i++) {
        double p = 1, before = 0;
        for (j = 1; j <= n; j++) {
            const double next = ((2 * j - 1) * x * p - (j - 1) * before) / j;
            before = p;
            p = next;
        }
        x -= p * (x * x - 1) / (n * (x * p - before));
    }
    return 0.5 - 0.5 * x;
}

/* Gauss points in the cube, collapsed to the simplex: at least `least` of them */
static inline size_t rx_collapsed_points(int dimension, size_t least, double (*points)[3]) {
    size_t count = 0;
    int n = 1, i, j, k;
    while ((size_t)(dimension == 2 ? n * n : n * n * n) < least) ++n;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++)
            for (k = 0; k < (dimension == 2 ? 1 : n); k++) {
                const double x = rx_gauss_point(n, i), y = (1 - x) * rx_gauss_point(n, j);
                points[count][0] = x;
                points[count][1] = y;
                points[count++][2] = dimension == 2 ? 0 : (1 - x - y) * rx_gauss_point(n, k);
            }
    return count;
}

/* ---- a moment-fitted rule on the reference simplex of two or three dimensions ---- */

typedef struct rx_fit {
    rx_basis basis;      /* one degree more than the rule: antiderivatives and fields */
    size_t moment_count; /* monomials to the rule's degree */
    size_t field_count;
    rx_field fields[RX_FIELDS];
    double transform[RX_FIELDS * RX_FIELDS]; /* of the fields to orthonormal ones, triangular */
    size_t point_count;
    double points[RX_POINTS][3];
    double weights[RX_POINTS][RX_MONOMIALS]; /* weights = weights x moments: the pseudo-inverse of Eq. 17 */
    /* of the domain at hand */
    double moments[RX_MONOMIALS];
    double boundary[RX_FIELDS]; /* flux of the fields through the known part of its boundary */
    size_t interface_count, interface_capacity;
    double *fluxes;          /* interface_capacity x field_count */
    double *antiderivatives; /* interface_capacity x moment_count */
    double *matrix, *omega;
    pinv inverse;
} rx_fit;

static inline double rx_monomial_product(const rx_basis *b, size_t i, size_t j) {
    const unsigned char *e = b->exponent[i], *f = b->exponent[j];
    return rx_simplex_integral(b->dimension, (unsigned)e[0] + f[0], (unsigned)e[1] + f[1], (unsigned)e[2] + f[2]);
}

/* Integral of the scalar product of two fields */
static inline double rx_field_product(const rx_basis *b, const rx_field *f, const rx_field *g) {
    const int last = b->dimension - 1;
    double sum = f->axis == g->axis ? rx_monomial_product(b, f->monomial, g->monomial) : 0;
    if (f->axis == last) sum += g->factor * rx_monomial_product(b, f->monomial, g->rest);
    if (g->axis == last) sum += f->factor * rx_monomial_product(b, f->rest, g->monomial);
    return sum + f->factor * g->factor * rx_monomial_product(b, f->rest, g->rest);
}

static inline void rx_fit_place(rx_fit *f, unsigned degree) {
    if (f->basis.dimension == 3 && degree == 2)
        f->point_count = rx_orbits_points(RX_TETRAHEDRON_24, 4, f->points);
    else if (f->basis.dimension == 2 && degree == 3)
        f->point_count = rx_orbits_points(RX_TRIANGLE_19, 6, f->points);
    else
        f->point_count = rx_collapsed_points(f->basis.dimension, 2 * f->moment_count, f->points);
}

/* weights: the pseudo-inverse for a basis that is orthonormal on the simplex, times that basis in monomials */
static inline void rx_fit_invert(rx_fit *f) {
    const size_t m = f->moment_count, n = f->point_count;
    double *c = (double *)dense_memory(NULL, m * m, sizeof(double)),
           *a = (double *)dense_memory(NULL, m * n, sizeof(double));
    double values[RX_MONOMIALS], column[RX_POINTS];
    size_t i, j;
    for (i = 0; i < m; i++)
        for (j = 0; j < m; j++) c[i * m + j] = rx_monomial_product(&f->basis, i, j);
    rx_orthonormalise(c, m);
    for (j = 0; j < n; j++) {
        rx_basis_values(&f->basis, f->points[j], values);
        for (i = 0; i < m; i++) a[i * n + j] = dense_dot(c + i * m, values, i + 1);
    }
    pinv_factor(&f->inverse, a, m, n, RX_CUTOFF);
    for (i = 0; i < m; i++) {
        for (j = 0; j < m; j++) values[j] = c[j * m + i];
        pinv_solve(&f->inverse, values, column);
        for (j = 0; j < n; j++) f->weights[j][i] = column[j];
    }
    free(c);
    free(a);
}

static inline void rx_fit_init(rx_fit *f, int dimension, unsigned degree) {
    rx_basis own;
    size_t i, j;
    memset(f, 0, sizeof *f);
    rx_basis_init(&own, dimension, degree);
    rx_basis_init(&f->basis, dimension, degree + 1);
    f->moment_count = own.count;
    f->field_count = rx_fields(&f->basis, f->fields);
    for (i = 0; i < f->field_count; i++)
        for (j = 0; j < f->field_count; j++)
            f->transform[i * f->field_count + j] = rx_field_product(&f->basis, &f->fields[i], &f->fields[j]);
    rx_orthonormalise(f->transform, f->field_count);
    rx_fit_place(f, degree);
    rx_fit_invert(f);
}

static inline void rx_fit_free(rx_fit *f) {
    free(f->fluxes);
    free(f->antiderivatives);
    free(f->matrix);
    free(f->omega);
    pinv_free(&f->inverse);
}

static inline void rx_fit_begin(rx_fit *f) {
    memset(f->moments, 0, sizeof f->moments);
    memset(f->boundary, 0, sizeof f->boundary);
    f->interface_count = 0;
}

/* A point of the known boundary; n: outward, as long as its weight */
static inline void rx_fit_boundary(rx_fit *f, const double *x, const double *n) {
    double values[RX_MONOMIALS], flux[RX_FIELDS];
    rx_basis_values(&f->basis, x, values);
    rx_field_fluxes(&f->basis, f->fields, f->field_count, values, n, flux);
    dense_add(f->boundary, 1, flux, f->field_count);
    rx_antiderivatives(&f->basis, f->moment_count, values, n, flux);
    dense_add(f->moments, 1, flux, f->moment_count);
}

/* A point of the interface; n: outward, of length 1 */
static inline void rx_fit_interface(rx_fit *f, const double *x, const double *n) {
    double values[RX_MONOMIALS];
    const size_t i = f->interface_count++;
    if (f->interface_count > f->interface_capacity) {
        f->interface_capacity = 2 * f->interface_count + 64;
        f->fluxes = (double *)dense_memory(f->fluxes, f->interface_capacity * f->field_count, sizeof(double));
        f->antiderivatives =
            (double *)dense_memory(f->antiderivatives, f->interface_capacity * f->moment_count, sizeof(double));
        f->matrix = (double *)dense_memory(f->matrix, f->interface_capacity * f->field_count, sizeof(double));
        f->omega = (double *)dense_memory(f->omega, f->interface_capacity, sizeof(double));
    }
    rx_basis_values(&f->basis, x, values);
    rx_field_fluxes(&f->basis, f->fields, f->field_count, values, n, f->fluxes + i * f->field_count);
    rx_antiderivatives(&f->basis, f->moment_count, values, n, f->antiderivatives + i * f->moment_count);
}

/* Eq. 20 and 21: the flux through the interface is minus that through the rest. Adds the interface's part to the
 * moments. */
static inline void rx_fit_finish(rx_fit *f) {
    const size_t k = f->field_count, n = f->interface_count;
    double right[RX_FIELDS];
    size_t i, j;
    if (n == 0) return;
    for (i = 0; i < k; i++) {
        const double *row = f->transform + i * k;
        right[i] = -dense_dot(row, f->boundary, i + 1);
        for (j = 0; j < n; j++) f->matrix[i * n + j] = dense_dot(row, f->fluxes + j * k, i + 1);
    }
    pinv_factor(&f->inverse, f->matrix, k, n, RX_CUTOFF);
    pinv_solve(&f->inverse, right, f->omega);
    for (j = 0; j < n; j++)
        dense_add(f->moments, f->omega[j], f->antiderivatives + j * f->moment_count, f->moment_count);
}

/* ---- the rule of one side of a patch in one element, in its reference frame ---- */

/* Corner numbers of face k, which is opposite to corner k, counter-clockwise from outside; of edges */
static const int RX_FACE[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
static const int RX_EDGE[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
static const double RX_CORNER[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

typedef struct rx_rules {
    int clip;
    rx_fit face, volume;
    double axes[4][2][3]; /* face k is corner + s axes[0] + t axes[1] */
    double normal[4][3];  /* their product: outward, as long as the face is large in s, t */
    /* of the volume's fields and antiderivatives at the faces' points */
    double fluxes[4][RX_FACE_POINTS][RX_FIELDS];
    double antiderivatives[4][RX_FACE_POINTS][RX_MONOMIALS];
} rx_rules;

/* A patch in an element: triangles whose front is the plus side */
typedef struct rx_section {
    size_t count;
    const double *triangles; /* count x 3 corners x 3, in the reference frame */
    const unsigned *below;   /* count: bit 4 v + k: corner v of the triangle is outside of face k, exactly */
    const unsigned *crosses; /* count: bit k: the triangle meets face k */
    int plus[4];             /* is the element's corner on the plus side */
    /* where the patch crosses edges, ascending from the first corner (0) to the second (1) */
    const double *crossing[6];
    size_t crossing_count[6];
} rx_section;

static inline void rx_face_point(const rx_rules *r, int k, const double *at, double *x) {
    int a;
    for (a = 0; a < 3; a++) x[a] = RX_CORNER[RX_FACE[k][0]][a] + at[0] * r->axes[k][0][a] + at[1] * r->axes[k][1][a];
}

static inline void rx_cross(const double *a, const double *b, double *n) {
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
}

static inline rx_rules *rx_rules_create(unsigned degree, int clip) {
    rx_rules *r = (rx_rules *)dense_memory(NULL, 1, sizeof *r);
    double x[3], values[RX_MONOMIALS];
    size_t i;
    int k, a;
    r->clip = clip;
    rx_fit_init(&r->face, 2, degree + 1);
    rx_fit_init(&r->volume, 3, degree);
    for (k = 0; k < 4; k++) {
        for (a = 0; a < 6; a++)
            r->axes[k][a / 3][a % 3] = RX_CORNER[RX_FACE[k][1 + a / 3]][a % 3] - RX_CORNER[RX_FACE[k][0]][a % 3];
        rx_cross(r->axes[k][0], r->axes[k][1], r->normal[k]);
        for (i = 0; i < r->face.point_count; i++) {
            rx_face_point(r, k, r->face.points[i], x);
            rx_basis_values(&r->volume.basis, x, values);
            rx_field_fluxes(&r->volume.basis, r->volume.fields, r->volume.field_count, values, r->normal[k],
                            r->fluxes[k][i]);
            rx_antiderivatives(&r->volume.basis, r->volume.moment_count, values, r->normal[k],
                               r->antiderivatives[k][i]);
        }
    }
    return r;
}

static inline void rx_rules_destroy(rx_rules *r) {
    if (!r) return;
    rx_fit_free(&r->face);
    rx_fit_free(&r->volume);
    free(r);
}

/* ---- 5.1: edges of a face ---- */

/* A piece of the edge from a to b, in s and t; outward is to the right */
static inline void rx_add_piece(rx_fit *f, const double *a, const double *b, double from, double to) {
    double x[2], n[2];
    int g;
    for (g = 0; g < RX_GAUSS; g++) {
        const double at = from + (to - from) * RX_GAUSS_AT[g], weight = (to - from) * RX_GAUSS_WEIGHT[g];
        x[0] = a[0] + at * (b[0] - a[0]);
        x[1] = a[1] + at * (b[1] - a[1]);
        n[0] = weight * (b[1] - a[1]);
        n[1] = -weight * (b[0] - a[0]);
        rx_fit_boundary(f, x, n);
    }
}

/* The number of the edge between two corners; *turned: it starts at the second */
static inline int rx_edge_of(int a, int b, int *turned) {
    int e = 0;
    *turned = a > b;
    while (RX_EDGE[e][*turned] != a || RX_EDGE[e][!*turned] != b) ++e;
    return e;
}

/* The pieces of face k's edges on the plus side: sides change at each crossing */
static inline void rx_add_edges(rx_fit *f, const rx_section *s, int k) {
    static const double at[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    size_t i;
    int j, turned;
    for (j = 0; j < 3; j++) {
        const int e = rx_edge_of(RX_FACE[k][j], RX_FACE[k][(j + 1) % 3], &turned);
        const double *a = at[turned ? (j + 1) % 3 : j], *b = at[turned ? j : (j + 1) % 3];
        const size_t count = s->crossing_count[e];
        int plus = s->plus[RX_EDGE[e][0]];
        for (i = 0; i <= count; i++, plus = !plus) {
            const double from = i == 0 ? 0 : s->crossing[e][i - 1], to = i == count ? 1 : s->crossing[e][i];
            if (!plus) continue;
            if (turned)
                rx_add_piece(f, b, a, 1 - to, 1 - from);
            else
                rx_add_piece(f, a, b, from, to);
        }
    }
}

/* ---- 5.2, d = 2: a face ---- */

enum { RX_SEGMENT = 6 }; /* doubles of a segment: ends, outward normal */

/* of pieces of the interface */
typedef struct rx_list {
    double *data;
    size_t count, capacity;
} rx_list;

static inline double *rx_list_add(rx_list *list, size_t width) {
    if (list->count == list->capacity) {
        list->capacity = 2 * list->capacity + 16;
        list->data = (double *)dense_memory(list->data, list->capacity * width, sizeof(double));
    }
    return list->data + width * list->count++;
}

/* Where the triangle meets the plane of face k: from the edge that leaves to the one that enters, in s and t. The side
   comes from exact signs; the point by the distances, which may be rounded to the other side. */
static inline void rx_face_segment(const rx_rules *r, const rx_section *s, size_t triangle, int k, double ends[4]) {
    const double *p = s->triangles + 9 * triangle;
    const unsigned below = s->below[triangle];
    int v, a, count = 0;
    for (v = 0; v < 3; v++) {
        const double *x = p + 3 * v, *y = p + 3 * ((v + 1) % 3);
        const double *c = RX_CORNER[RX_FACE[k][0]];
        double dx = 0, dy = 0, at, local[3];
        if ((below >> (4 * v + k) & 1) == (below >> (4 * ((v + 1) % 3) + k) & 1)) continue;
        for (a = 0; a < 3; a++) {
            dx += r->normal[k][a] * (x[a] - c[a]);
            dy += r->normal[k][a] * (y[a] - c[a]);
        }
        at = fabs(dx) + fabs(dy) > 0 ? fabs(dx) / (fabs(dx) + fabs(dy)) : 0.5;
        for (a = 0; a < 3; a++) local[a] = x[a] + at * (y[a] - x[a]) - c[a];
        /* axes are (-1, 1, 0) and (-1, 0, 1) */
        if (k == 0) {
            ends[2 * count] = local[1];
            ends[2 * count + 1] = local[2];
        } else {
            ends[2 * count] = dense_dot(local, r->axes[k][0], 3);
            ends[2 * count + 1] = dense_dot(local, r->axes[k][1], 3);
        }
        count++;
    }
}

/* Clips a segment to s >= 0, t >= 0, s + t <= 1 [Liang and Barsky]; 0: nothing is left */
static inline int rx_clip_segment(double ends[4]) {
    double from = 0, to = 1, x[2];
    int side, a;
    for (side = 0; side < 3; side++) {
        const double u = side == 2 ? 1 - ends[0] - ends[1] : ends[side],
                     v = side == 2 ? 1 - ends[2] - ends[3] : ends[2 + side];
        if (u < 0 && v < 0) return 0;
        if (u < 0) from = fmax(from, u / (u - v));
        if (v < 0) to = fmin(to, u / (u - v));
    }
    if (!(from < to)) return 0;
    for (a = 0; a < 2; a++) {
        x[a] = ends[a];
        ends[a] = x[a] + from * (ends[2 + a] - x[a]);
        ends[2 + a] = x[a] + to * (ends[2 + a] - x[a]);
    }
    return 1;
}

static inline void rx_triangle_normal(const double *p, double *n) {
    double u[3], v[3];
    int a;
    for (a = 0; a < 3; a++) {
        u[a] = p[3 + a] - p[a];
        v[a] = p[6 + a] - p[a];
    }
    rx_cross(u, v, n);
}

/* The section's segments in face k. Out of the plus side is against the triangle's normal, as it shows in s and t. */
static inline void rx_face_segments(const rx_rules *r, const rx_section *s, int k, rx_list *segments) {
    size_t i;
    for (i = 0; i < s->count; i++) {
        double ends[4], n[3], u, v, length, *segment;
        if (!(s->crosses[i] >> k & 1)) continue;
        rx_face_segment(r, s, i, k, ends);
        if (r->clip && !rx_clip_segment(ends)) continue;
        rx_triangle_normal(s->triangles + 9 * i, n);
        u = -dense_dot(n, r->axes[k][0], 3);
        v = -dense_dot(n, r->axes[k][1], 3);
        length = sqrt(u * u + v * v);
        if (!(length > 0)) continue;
        segment = rx_list_add(segments, RX_SEGMENT);
        memcpy(segment, ends, sizeof ends);
        segment[4] = u / length;
        segment[5] = v / length;
    }
}

/* Halves the longest until there are enough. */
static inline void rx_halve_segments(rx_list *list, size_t least) {
    while (list->count > 0 && list->count < least) {
        double longest = -1, *half = rx_list_add(list, RX_SEGMENT), *whole = list->data;
        size_t i;
        for (i = 0; i + 1 < list->count; i++) {
            const double *p = list->data + RX_SEGMENT * i, length = hypot(p[2] - p[0], p[3] - p[1]);
            if (length > longest) {
                longest = length;
                whole = list->data + RX_SEGMENT * i;
            }
        }
        memcpy(half, whole, RX_SEGMENT * sizeof(double));
        half[0] = whole[2] = 0.5 * (whole[0] + whole[2]);
        half[1] = whole[3] = 0.5 * (whole[1] + whole[3]);
    }
}

/* Moments of the plus side of face k in s and t */
static inline void rx_face_moments(rx_rules *r, const rx_section *s, int k, rx_list *segments) {
    rx_fit *f = &r->face;
    size_t i;
    int g;
    rx_fit_begin(f);
    rx_add_edges(f, s, k);
    segments->count = 0;
    rx_face_segments(r, s, k, segments);
    rx_halve_segments(segments, (2 * f->field_count + RX_GAUSS - 1) / RX_GAUSS);
    for (i = 0; i < segments->count; i++)
        for (g = 0; g < RX_GAUSS; g++) {
            const double *p = segments->data + RX_SEGMENT * i;
            double x[2];
            x[0] = p[0] + RX_GAUSS_AT[g] * (p[2] - p[0]);
            x[1] = p[1] + RX_GAUSS_AT[g] * (p[3] - p[1]);
            rx_fit_interface(f, x, p + 4);
        }
    rx_fit_finish(f);
}

/* ---- 5.2, d = 3 ---- */

/* doubles of a triangle: corners, outward normal; corners of a clipped triangle at most */
enum { RX_FACET = 12, RX_CORNERS = 10 };

static inline double rx_face_distance(const double *x, int k) { return k == 0 ? 1 - x[0] - x[1] - x[2] : x[k - 1]; }

/* Clips a polygon of n corners to the reference element; returns how many corners are left. */
static inline size_t rx_clip_polygon(double (*p)[3], size_t n) {
    double q[RX_CORNERS][3];
    int k, a;
    for (k = 0; k < 4; k++) {
        size_t i, count = 0;
        for (i = 0; i < n; i++) {
            const double *x = p[i], *y = p[(i + 1) % n], u = rx_face_distance(x, k), v = rx_face_distance(y, k);
            if (u >= 0) memcpy(q[count++], x, 3 * sizeof(double));
            if ((u < 0) == (v < 0)) continue;
            for (a = 0; a < 3; a++) q[count][a] = x[a] + u / (u - v) * (y[a] - x[a]);
            count++;
        }
        n = count;
        memcpy(p, q, n * sizeof *q);
    }
    return n < 3 ? 0 : n;
}

static inline void rx_add_facet(rx_list *facets, const double *a, const double *b, const double *c,
                                const double *normal) {
    double *facet = rx_list_add(facets, RX_FACET);
    memcpy(facet, a, 3 * sizeof(double));
    memcpy(facet + 3, b, 3 * sizeof(double));
    memcpy(facet + 6, c, 3 * sizeof(double));
    memcpy(facet + 9, normal, 3 * sizeof(double));
}

static inline void rx_facets(const rx_rules *r, const rx_section *s, rx_list *facets) {
    size_t i, j, n;
    int a;
    for (i = 0; i < s->count; i++) {
        double p[RX_CORNERS][3], normal[3], length;
        rx_triangle_normal(s->triangles + 9 * i, normal);
        length = sqrt(dense_dot(normal, normal, 3));
        if (!(length > 0)) continue;
        for (a = 0; a < 3; a++) normal[a] /= -length;
        memcpy(p, s->triangles + 9 * i, 9 * sizeof(double));
        n = r->clip ? rx_clip_polygon(p, 3) : 3;
        for (j = 2; j < n; j++) rx_add_facet(facets, p[0], p[j - 1], p[j], normal);
    }
}

/* Halves the largest across its longest edge until there are enough. */
static inline void rx_halve_facets(rx_list *list, size_t least) {
    while (list->count > 0 && list->count < least) {
        double largest = -1, longest = -1, *half = rx_list_add(list, RX_FACET), *whole = list->data;
        size_t i;
        int v, a, from = 0;
        for (i = 0; i + 1 < list->count; i++) {
            double n[3], size;
            rx_triangle_normal(list->data + RX_FACET * i, n);
            size = dense_dot(n, n, 3);
            if (size > largest) {
                largest = size;
                whole = list->data + RX_FACET * i;
            }
        }
        for (v = 0; v < 3; v++) {
            double square = 0;
            for (a = 0; a < 3; a++)
                square += (whole[3 * ((v + 1) % 3) + a] - whole[3 * v + a]) *
                          (whole[3 * ((v + 1) % 3) + a] - whole[3 * v + a]);
            if (square > longest) {
                longest = square;
                from = v;
            }
        }
        memcpy(half, whole, RX_FACET * sizeof(double));
        for (a = 0; a < 3; a++) {
            const int to = 3 * ((from + 1) % 3) + a;
            half[3 * from + a] = whole[to] = 0.5 * (whole[3 * from + a] + whole[to]);
        }
    }
}

/* Flux of fields and antiderivatives through the plus side of face k, by the rule that its moments give */
static inline void rx_add_face(rx_rules *r, const rx_section *s, int k, rx_list *segments) {
    const rx_fit *f = &r->face;
    size_t i;
    rx_face_moments(r, s, k, segments);
    for (i = 0; i < f->point_count; i++) {
        const double weight = dense_dot(f->weights[i], f->moments, f->moment_count);
        dense_add(r->volume.boundary, weight, r->fluxes[k][i], r->volume.field_count);
        dense_add(r->volume.moments, weight, r->antiderivatives[k][i], r->volume.moment_count);
    }
}

/* Moments of the section's plus side in the reference frame, to the rules' degree: r->volume.moments */
static inline void rx_section_moments(rx_rules *r, const rx_section *s) {
    rx_list pieces = {NULL, 0, 0};
    rx_fit *f = &r->volume;
    size_t i, j;
    int k, a, v;
    double corner[RX_TRIANGLE][3];
    rx_fit_begin(f);
    for (k = 0; k < 4; k++) rx_add_face(r, s, k, &pieces);
    free(pieces.data);
    memset(&pieces, 0, sizeof pieces);
    rx_facets(r, s, &pieces);
    rx_halve_facets(&pieces, (2 * f->field_count + RX_TRIANGLE - 1) / RX_TRIANGLE);
    rx_orbits_points(RX_TRIANGLE_6, 2, corner);
    for (i = 0; i < pieces.count; i++)
        for (j = 0; j < RX_TRIANGLE; j++) {
            const double *p = pieces.data + RX_FACET * i;
            double x[3];
            for (a = 0; a < 3; a++)
                for (x[a] = p[a], v = 1; v < 3; v++) x[a] += corner[j][v - 1] * (p[3 * v + a] - p[a]);
            rx_fit_interface(f, x, p + 9);
        }
    free(pieces.data);
    rx_fit_finish(f);
}

/* Weights at the volume's points from moments: Eq. 17 */
static inline void rx_weights(const rx_rules *r, const double *moments, double *weights) {
    size_t i;
    for (i = 0; i < r->volume.point_count; i++)
        weights[i] = dense_dot(r->volume.weights[i], moments, r->volume.moment_count);
}

#endif
