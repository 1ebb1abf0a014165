/* dense.h - small dense systems of the baselines: the Moore-Penrose pseudo-inverse by singular values.

   T, the taller of A and A^T (n x m), is divided by Householder reflections with column pivoting, T P = Q R. That
   gives the rank. The singular values of L = R^T (m x rank) come from one-sided Jacobi rotations of its columns
   [Drmac and Veselic 2008]: L V = W = U S. So A^+ is Q V S^-2 W^T P^T for A = T^T, and P W S^-2 V^T Q^T for A = T.
   Out of memory ends the program. */
#ifndef BENCH_DENSE_H
#define BENCH_DENSE_H

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Zero-initialised: empty. Keeps its memory from one matrix to the next. */
typedef struct pinv {
    size_t n, m, rank;
    int transposed; /* 1: T = A^T */
    double *qr;     /* m columns of n: R on and above the diagonal, reflectors below it */
    double *head;   /* m: first entry of each reflector, which is v with |v|^2 = 2 */
    double *w, *v;  /* rank columns of m, of m (rank in use) */
    /* m: squares of column norms; 1 / singular value^2, 0 where it is cut off. While T is divided: squares of norms as
     * they are now and as they were last summed */
    double *norm, *scale;
    double *work;            /* n */
    size_t *pivot;           /* m */
    size_t capacity, pivots; /* doubles in qr's block, indices in pivot's */
} pinv;

static inline void *dense_memory(void *old, size_t count, size_t size) {
    void *memory = old ? realloc(old, (count + 1) * size) : calloc(count + 1, size);
    if (memory) return memory;
    fprintf(stderr, "bench: no memory\n");
    exit(1);
}

static inline double dense_dot(const double *a, const double *b, size_t n) {
    double sum = 0;
    size_t i;
    for (i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static inline void dense_add(double *a, double factor, const double *b, size_t n) {
    size_t i;
    for (i = 0; i < n; i++) a[i] += factor * b[i];
}

static inline void pinv_reserve(pinv *p, size_t n, size_t m) {
    const size_t size = n * m + 2 * m * m + 3 * m + n;
    if (p->capacity < size) p->qr = (double *)dense_memory(p->qr, p->capacity = size, sizeof(double));
    if (p->pivots < m) p->pivot = (size_t *)dense_memory(p->pivot, p->pivots = m, sizeof(size_t));
    p->n = n;
    p->m = m;
    p->w = p->qr + n * m;
    p->v = p->w + m * m;
    p->head = p->v + m * m;
    p->norm = p->head + m;
    p->scale = p->norm + m;
    p->work = p->scale + m;
}

static inline void pinv_free(pinv *p) {
    free(p->qr);
    free(p->pivot);
    memset(p, 0, sizeof *p);
}

static inline double pinv_rest(const pinv *p, size_t j, size_t k) {
    const double *rest = p->qr + j * p->n + k;
    return dense_dot(rest, rest, p->n - k);
}

/* Brings the column of largest norm among k ... m - 1 to k; returns its square, summed. */
static inline double pinv_pivot(pinv *p, size_t k) {
    size_t j, best = k, i;
    for (j = k; j < p->m; j++)
        if (p->norm[j] > p->norm[best]) best = j;
    for (i = 0; best != k && i < p->n; i++) {
        const double kept = p->qr[k * p->n + i];
        p->qr[k * p->n + i] = p->qr[best * p->n + i];
        p->qr[best * p->n + i] = kept;
    }
    i = p->pivot[k];
    p->pivot[k] = p->pivot[best];
    p->pivot[best] = i;
    p->norm[best] = p->norm[k];
    p->scale[best] = p->scale[k];
    return pinv_rest(p, k, k);
}

/* Squares of norms below row k lose the row's entry. Where little is left of their last sum, they are summed again. */
static inline void pinv_shorten(pinv *p, size_t j, size_t k) {
    const double entry = p->qr[j * p->n + k];
    p->norm[j] -= entry * entry;
    if (p->norm[j] < 1e-3 * p->scale[j]) p->norm[j] = p->scale[j] = pinv_rest(p, j, k + 1);
}

/* x -= v (v . x), the k-th reflection; v starts at row k with head[k] */
static inline void pinv_reflect(const pinv *p, size_t k, double *x) {
    const double *tail = p->qr + k * p->n + k + 1;
    const size_t rest = p->n - k - 1;
    const double along = p->head[k] * x[k] + dense_dot(tail, x + k + 1, rest);
    x[k] -= along * p->head[k];
    dense_add(x + k + 1, -along, tail, rest);
}

/* Reflects column k onto -sign(a_k) |a| e_k by v = (a + sign(a_k) |a| e_k), scaled to |v|^2 = 2. */
static inline void pinv_eliminate(pinv *p, size_t k, double square) {
    double *column = p->qr + k * p->n, length = sqrt(square), scale;
    size_t i, j;
    if (column[k] < 0) length = -length;
    scale = 1 / sqrt(length * (length + column[k]));
    p->head[k] = (column[k] + length) * scale;
    for (i = k + 1; i < p->n; i++) column[i] *= scale;
    column[k] = -length;
    for (j = k + 1; j < p->m; j++) {
        pinv_reflect(p, k, p->qr + j * p->n);
        pinv_shorten(p, j, k);
    }
}

/* Columns below `noise` times the first are not divided further. */
static inline void pinv_triangulate(pinv *p, double noise) {
    double first = 0;
    size_t k;
    for (k = 0; k < p->m; k++) {
        p->pivot[k] = k;
        p->norm[k] = p->scale[k] = pinv_rest(p, k, 0);
    }
    for (p->rank = 0; p->rank < p->m; p->rank++) {
        const double square = pinv_pivot(p, p->rank);
        if (p->rank == 0) first = square;
        if (!(square > first * noise * noise)) return;
        pinv_eliminate(p, p->rank, square);
    }
}

/* Makes columns i, j of W orthogonal; 0 if they were. */
static inline int pinv_rotate(pinv *p, size_t i, size_t j) {
    double *x = p->w + i * p->m, *y = p->w + j * p->m, zeta, t, cosine, sine;
    const double g = dense_dot(x, y, p->m);
    size_t k, side;
    if (fabs(g) <= 4 * DBL_EPSILON * sqrt(p->norm[i] * p->norm[j])) return 0;
    zeta = (p->norm[j] - p->norm[i]) / (2 * g);
    t = (zeta > 0 ? 1 : -1) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    cosine = 1 / sqrt(1 + t * t);
    sine = cosine * t;
    for (side = 0; side < 2; side++) {
        for (k = 0; k < (side == 0 ? p->m : p->rank); k++) {
            const double a = x[k], b = y[k];
            x[k] = cosine * a - sine * b;
            y[k] = sine * a + cosine * b;
        }
        x = p->v + i * p->m;
        y = p->v + j * p->m;
    }
    p->norm[i] -= t * g;
    p->norm[j] += t * g;
    return 1;
}

static inline void pinv_diagonalise(pinv *p) {
    size_t i, j;
    int turned = 1, sweep;
    memset(p->w, 0, p->m * p->m * sizeof(double));
    memset(p->v, 0, p->m * p->m * sizeof(double));
    for (i = 0; i < p->rank; i++) {
        p->v[i * p->m + i] = 1;
        for (j = i; j < p->m; j++) p->w[i * p->m + j] = p->qr[j * p->n + i];
    }
    for (sweep = 0; sweep < 40 && turned; sweep++) {
        for (i = 0; i < p->rank; i++) p->norm[i] = dense_dot(p->w + i * p->m, p->w + i * p->m, p->m);
        for (turned = 0, i = 0; i < p->rank; i++)
            for (j = i + 1; j < p->rank; j++) turned |= pinv_rotate(p, i, j);
    }
}

/* The pseudo-inverse of A (rows x columns, by rows). Singular values below cutoff times the largest count as 0. */
static inline void pinv_factor(pinv *p, const double *a, size_t rows, size_t columns, double cutoff) {
    size_t i, j;
    double largest = 0;
    p->transposed = rows < columns;
    pinv_reserve(p, p->transposed ? columns : rows, p->transposed ? rows : columns);
    for (i = 0; i < rows; i++)
        for (j = 0; j < columns; j++) p->qr[p->transposed ? i * p->n + j : j * p->n + i] = a[i * columns + j];
    pinv_triangulate(p, fmax(DBL_EPSILON, cutoff / 64));
    pinv_diagonalise(p);
    for (i = 0; i < p->rank; i++) {
        p->norm[i] = dense_dot(p->w + i * p->m, p->w + i * p->m, p->m);
        largest = fmax(largest, p->norm[i]);
    }
    for (i = 0; i < p->rank; i++) p->scale[i] = p->norm[i] > cutoff * cutoff * largest ? 1 / p->norm[i] : 0;
}

/* x = A^+ b: the shortest of all x that come nearest to A x = b */
static inline void pinv_solve(pinv *p, const double *b, double *x) {
    double *y = p->work, *part;
    size_t i, k;
    if (p->transposed) { /* x = Q V S^-2 W^T P^T b */
        for (i = 0; i < p->m; i++) y[i] = b[p->pivot[i]];
        memset(x, 0, p->n * sizeof(double));
        for (k = 0; k < p->rank; k++)
            dense_add(x, p->scale[k] * dense_dot(p->w + k * p->m, y, p->m), p->v + k * p->m, p->rank);
        for (k = p->rank; k-- > 0;) pinv_reflect(p, k, x);
        return;
    }
    memcpy(y, b, p->n * sizeof(double)); /* x = P W S^-2 V^T Q^T b */
    for (k = 0; k < p->rank; k++) pinv_reflect(p, k, y);
    part = p->norm;
    for (k = 0; k < p->rank; k++) part[k] = p->scale[k] * dense_dot(p->v + k * p->m, y, p->rank);
    memset(y, 0, p->m * sizeof(double));
    for (k = 0; k < p->rank; k++) dense_add(y, part[k], p->w + k * p->m, p->m);
    for (i = 0; i < p->m; i++) x[p->pivot[i]] = y[i];
}

#endif
