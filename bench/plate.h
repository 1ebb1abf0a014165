/* plate.h - the drop of a clamped plate under its weight by elements of high order: a reference that shares nothing
   with the library.

   Hexahedra of 1 x 1 x thickness in one layer, linear elastic, with Lagrange polynomials on Lobatto points: of degree
   4 along the plate and 3 through it. Integrals are products of one-dimensional ones by Gauss points. The banded matrix
   is factored by Cholesky's method, node after node along x.

   Include after memory() and expect() of the bench. */
#ifndef BENCH_PLATE_H
#define BENCH_PLATE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLATE_MOST = 8, PLATE_ALONG = 4, PLATE_THROUGH = 3 };

/* Legendre's polynomial of degree p and its derivative, |x| < 1 */
static void plate_legendre(int p, double x, double *value, double *slope) {
    double last = 1, now = x, next;
    int k;
    for (k = 1; k < p; k++) {
        next = ((2 * k + 1) * x * now - k * last) / (k + 1);
        last = now;
        now = next;
    }
    *value = now;
    *slope = p * (last - x * now) / (1 - x * x);
}

/* Points and weights of Gauss's rule of n points, by Newton's method from Chebyshev's points */
static void plate_gauss(int n, double *x, double *weight) {
    int i, round;
    for (i = 0; i < n; i++) {
        double value, slope;
        x[i] = -cos(3.14159265358979323846 * (i + 0.75) / (n + 0.5));
        for (round = 0; round < 50; round++) {
            plate_legendre(n, x[i], &value, &slope);
            x[i] -= value / slope;
        }
        weight[i] = 2 / ((1 - x[i] * x[i]) * slope * slope);
    }
}

/* p + 1 points: the ends and the roots of the slope of Legendre's polynomial of degree p */
static void plate_lobatto(int p, double *x) {
    int i, round;
    x[0] = -1;
    x[p] = 1;
    for (i = 1; i < p; i++) {
        x[i] = -cos(3.14159265358979323846 * i / p);
        for (round = 0; round < 50; round++) {
            double value, slope;
            plate_legendre(p, x[i], &value, &slope);
            x[i] -= slope * (1 - x[i] * x[i]) / (2 * x[i] * slope - p * (p + 1) * value);
        }
    }
}

/* Integrals over -1 ... 1 of two of the p + 1 polynomials: values, value and slope, slopes; and of each alone */
typedef struct plate_line {
    int count;
    double value[PLATE_MOST][PLATE_MOST], mixed[PLATE_MOST][PLATE_MOST], slope[PLATE_MOST][PLATE_MOST],
        alone[PLATE_MOST];
} plate_line;

static plate_line plate_make_line(int p) {
    double node[PLATE_MOST], x[PLATE_MOST], weight[PLATE_MOST];
    plate_line line;
    int q, i, j, k, m;
    memset(&line, 0, sizeof line);
    line.count = p + 1;
    plate_lobatto(p, node);
    plate_gauss(p + 1, x, weight);
    for (q = 0; q <= p; q++) {
        double value[PLATE_MOST], slope[PLATE_MOST];
        for (i = 0; i <= p; i++) {
            value[i] = 1;
            slope[i] = 0;
            for (k = 0; k <= p; k++) {
                double product = 1;
                if (k == i) continue;
                value[i] *= (x[q] - node[k]) / (node[i] - node[k]);
                for (m = 0; m <= p; m++)
                    if (m != i && m != k) product *= (x[q] - node[m]) / (node[i] - node[m]);
                slope[i] += product / (node[i] - node[k]);
            }
        }
        for (i = 0; i <= p; i++) {
            line.alone[i] += weight[q] * value[i];
            for (j = 0; j <= p; j++) {
                line.value[i][j] += weight[q] * value[i] * value[j];
                line.mixed[i][j] += weight[q] * value[i] * slope[j];
                line.slope[i][j] += weight[q] * slope[i] * slope[j];
            }
        }
    }
    return line;
}

/* int d_r a d_s b over an element of half edges `half`; a, b: numbers of a polynomial along each axis */
static double plate_entry(const plate_line line[3], const double half[3], const int a[3], const int b[3], int r,
                          int s) {
    double product = 1;
    int k;
    for (k = 0; k < 3; k++) {
        const plate_line *l = &line[k];
        if (k == r && k == s)
            product *= l->slope[a[k]][b[k]] / half[k];
        else if (k == r)
            product *= l->mixed[b[k]][a[k]];
        else if (k == s)
            product *= l->mixed[a[k]][b[k]];
        else
            product *= l->value[a[k]][b[k]] * half[k];
    }
    return product;
}

/* Solves a banded system in place: rows of the lower triangle, `band` entries before the diagonal. */
static void plate_solve(double *a, double *x, size_t n, size_t band) {
    size_t i, j, k;
    for (i = 0; i < n; i++) {
        double *row = a + i * (band + 1);
        const size_t first = i > band ? i - band : 0;
        for (j = first; j <= i; j++) {
            const double *other = a + j * (band + 1);
            const size_t from = j > band && j - band > first ? j - band : first;
            double sum = row[band - (i - j)];
            for (k = from; k < j; k++) sum -= row[band - (i - k)] * other[band - (j - k)];
            row[band - (i - j)] = j < i ? sum / other[band] : sqrt(sum);
        }
        for (j = first; j < i; j++) x[i] -= row[band - (i - j)] * x[j];
        x[i] /= row[band];
    }
    for (i = n; i-- > 0;) {
        const double *row = a + i * (band + 1);
        const size_t first = i > band ? i - band : 0;
        x[i] /= row[band];
        for (j = first; j < i; j++) x[j] -= row[band - (i - j)] * x[i];
    }
}

/* The drop of the middle of the free end's upper edge, m. length, width: in elements of 1 m; width: even. load: density
   times gravity, N/m3 */
static double plate_drop(int length, int width, double thickness, double young, double poisson, double load) {
    const double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
                 half[3] = {0.5, 0.5, 0.5 * thickness};
    const plate_line line[3] = {plate_make_line(PLATE_ALONG), plate_make_line(PLATE_ALONG),
                                plate_make_line(PLATE_THROUGH)};
    const size_t ny = (size_t)width * PLATE_ALONG + 1, nz = PLATE_THROUGH + 1, slab = 3 * ny * nz,
                 n = slab * (size_t)length * PLATE_ALONG, band = slab * PLATE_ALONG + 3 * nz * PLATE_ALONG + 3 * nz;
    const int nodes = (PLATE_ALONG + 1) * (PLATE_ALONG + 1) * (PLATE_THROUGH + 1);
    double *a = (double *)memory(n * (band + 1), sizeof(double)), *x = (double *)memory(n, sizeof(double)), drop;
    int i, j, r, s, k, ex, ey;
    for (i = 0; i < nodes; i++)
        for (j = 0; j < nodes; j++) {
            const int p[3] = {i / 20, i / 4 % 5, i % 4}, q[3] = {j / 20, j / 4 % 5, j % 4};
            double same = 0;
            for (k = 0; k < 3; k++) same += mu * plate_entry(line, half, p, q, k, k);
            for (r = 0; r < 3; r++)
                for (s = 0; s < 3; s++) {
                    const double value = lambda * plate_entry(line, half, p, q, r, s) +
                                         mu * plate_entry(line, half, p, q, s, r) + (r == s ? same : 0);
                    for (ex = 0; ex < length; ex++)
                        for (ey = 0; ey < width; ey++) {
                            const size_t at = 3 * (((size_t)(ex * PLATE_ALONG + p[0]) * ny +
                                                    (size_t)(ey * PLATE_ALONG + p[1])) *
                                                       nz +
                                                   (size_t)p[2]) +
                                              (size_t)r,
                                         to = 3 * (((size_t)(ex * PLATE_ALONG + q[0]) * ny +
                                                    (size_t)(ey * PLATE_ALONG + q[1])) *
                                                       nz +
                                                   (size_t)q[2]) +
                                              (size_t)s;
                            if (at < slab || to < slab || to > at) continue; /* the first nodes along x are held */
                            a[(at - slab) * (band + 1) + band - (at - to)] += value;
                        }
                }
            if (j > 0) continue;
            for (ex = 0; ex < length; ex++)
                for (ey = 0; ey < width; ey++) {
                    const size_t at =
                        3 * (((size_t)(ex * PLATE_ALONG + p[0]) * ny + (size_t)(ey * PLATE_ALONG + p[1])) * nz +
                             (size_t)p[2]) +
                        2;
                    if (at >= slab)
                        x[at - slab] += load * line[0].alone[p[0]] * half[0] * line[1].alone[p[1]] * half[1] *
                                        line[2].alone[p[2]] * half[2];
                }
        }
    plate_solve(a, x, n, band);
    drop = x[n - slab + 3 * (ny / 2 * nz + nz - 1) + 2];
    free(a);
    free(x);
    return drop;
}

#endif
