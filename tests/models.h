/* models.h - closed surfaces for tests: balls with waves, boxes, plates with holes; their exact moments, their areas */
#ifndef GXFEM_TESTS_MODELS_H
#define GXFEM_TESTS_MODELS_H

#include "workloads.h"

/* A ball, whose radius varies with the direction, as rings of triangles between two poles, about a place */
static inline void add_blob(wl_surface *s, const double place[3], double radius, double waves, double depth,
                            uint32_t rings, int inward) {
    const uint32_t around = 2 * rings, first = (uint32_t)s->vertex_count;
    const uint32_t south = first + (rings - 1) * around, north = south + 1;
    uint32_t i, j;
    double x[3];
    for (i = 1; i < rings; i++)
        for (j = 0; j < around; j++) {
            const double t = 3.14159265358979 * i / rings, p = 6.28318530717959 * (j + 0.25) / around;
            const double r = radius * (1 + depth * sin(waves * t) * cos(waves * p));
            x[0] = place[0] + r * sin(t) * cos(p);
            x[1] = place[1] + r * sin(t) * sin(p);
            x[2] = place[2] - r * cos(t);
            wl_add_vertex(s, x);
        }
    for (i = 0; i < 2; i++) {
        memcpy(x, place, sizeof x);
        x[2] += i ? radius : -radius;
        wl_add_vertex(s, x);
    }
    for (i = 0; i < rings; i++)
        for (j = 0; j < around; j++) {
            const uint32_t k = (j + 1) % around;
            const uint32_t a = i == 0 ? south : first + (i - 1) * around + j;
            const uint32_t b = i == 0 ? south : first + (i - 1) * around + k;
            const uint32_t c = i + 1 == rings ? north : first + i * around + k;
            const uint32_t d = i + 1 == rings ? north : first + i * around + j;
            if (i > 0) wl_add_triangle(s, a, inward ? c : b, inward ? b : c);
            if (i + 1 < rings) wl_add_triangle(s, a, inward ? d : c, inward ? c : d);
        }
}

static inline void add_bar(wl_surface *s, double x0, double y0, double z0, double x1, double y1, double z1) {
    const double low[3] = {x0, y0, z0}, high[3] = {x1, y1, z1};
    wl_add_aligned_box(s, low, high);
}

/* A plate of squares, with a hole in every other square of every other row: genus across x along */
static inline void add_plate(wl_surface *s, int across, int along, double height) {
    const int n[2] = {2 * across + 1, 2 * along + 1};
    int i, j, level, k;
    const uint32_t first = (uint32_t)s->vertex_count;
#define PLATE_AT(i, j, l) (first + (uint32_t)(((l) * (n[1] + 1) + (j)) * (n[0] + 1) + (i)))
#define PLATE_FULL(i, j)  ((i) >= 0 && (j) >= 0 && (i) < n[0] && (j) < n[1] && !((i) % 2 == 1 && (j) % 2 == 1))
    for (level = 0; level < 2; level++)
        for (j = 0; j <= n[1]; j++)
            for (i = 0; i <= n[0]; i++) {
                const double x[3] = {0.37 * i, 0.37 * j, level * height};
                wl_add_vertex(s, x);
            }
    for (j = 0; j < n[1]; j++)
        for (i = 0; i < n[0]; i++) {
            static const int step[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
            static const int side[4][4] = {{0, 0, 1, 0}, {1, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 0}};
            if (!PLATE_FULL(i, j)) continue;
            wl_add_triangle(s, PLATE_AT(i, j, 0), PLATE_AT(i, j + 1, 0), PLATE_AT(i + 1, j + 1, 0));
            wl_add_triangle(s, PLATE_AT(i, j, 0), PLATE_AT(i + 1, j + 1, 0), PLATE_AT(i + 1, j, 0));
            wl_add_triangle(s, PLATE_AT(i, j, 1), PLATE_AT(i + 1, j + 1, 1), PLATE_AT(i, j + 1, 1));
            wl_add_triangle(s, PLATE_AT(i, j, 1), PLATE_AT(i + 1, j, 1), PLATE_AT(i + 1, j + 1, 1));
            for (k = 0; k < 4; k++) {
                const int *e = side[k];
                if (PLATE_FULL(i + step[k][0], j + step[k][1])) continue;
                wl_add_triangle(s, PLATE_AT(i + e[0], j + e[1], 0), PLATE_AT(i + e[2], j + e[3], 0),
                                PLATE_AT(i + e[2], j + e[3], 1));
                wl_add_triangle(s, PLATE_AT(i + e[0], j + e[1], 0), PLATE_AT(i + e[2], j + e[3], 1),
                                PLATE_AT(i + e[0], j + e[1], 1));
            }
        }
#undef PLATE_AT
#undef PLATE_FULL
}

/* ---- exact moments of a surface, by the divergence theorem ---- */

typedef struct exact_moments {
    double volume, first[3], second[6]; /* integrals of 1, x, x x: 00 01 02 11 12 22, about a place */
} exact_moments;

/* Sums over cones from the place to the triangles: D / 6, D s / 24 and D (s s + aa + bb + cc) / 120, where D =
   det(a, b, c), s = a + b + c */
static inline exact_moments moments_of_surfaces(const wl_surface *s, size_t count, const double about[3]) {
    const rat_mark mark = rat_arena_mark();
    exact_moments m;
    big sum[10];
    size_t i, t;
    int j, k, n;
    for (k = 0; k < 10; k++) sum[k] = big_zero();
    for (i = 0; i < count; i++)
        for (t = 0; t < s[i].triangle_count; t++) {
            big p[3][3], c[3], d;
            for (n = 0; n < 3; n++) big_difference(s[i].vertices + 3 * s[i].triangles[3 * t + (size_t)n], about, p[n]);
            d = big_det3(p[0], p[1], p[2]);
            sum[0] = big_add(sum[0], d);
            for (k = 0; k < 3; k++) {
                c[k] = big_add(big_add(p[0][k], p[1][k]), p[2][k]);
                sum[1 + k] = big_add(sum[1 + k], big_mul(d, c[k]));
            }
            for (j = 0, n = 4; j < 3; j++)
                for (k = j; k < 3; k++, n++) {
                    big q = big_mul(c[j], c[k]);
                    int corner;
                    for (corner = 0; corner < 3; corner++) q = big_add(q, big_mul(p[corner][j], p[corner][k]));
                    sum[n] = big_add(sum[n], big_mul(d, q));
                }
        }
    m.volume = rat_to_double(rat_div(rat_from_big(sum[0]), rat_from_int(6)));
    for (k = 0; k < 3; k++) m.first[k] = rat_to_double(rat_div(rat_from_big(sum[1 + k]), rat_from_int(24)));
    for (k = 0; k < 6; k++) m.second[k] = rat_to_double(rat_div(rat_from_big(sum[4 + k]), rat_from_int(120)));
    rat_arena_release(mark);
    return m;
}

static inline exact_moments moments_of(const workload *w, const double about[3]) {
    return moments_of_surfaces(w->surfaces, w->surface_count, about);
}

static inline double triangle_area(const double *a, const double *b, const double *c) {
    double u[3], v[3], n[3];
    int k;
    for (k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    for (k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static inline double area_of_triangles(const double *vertices, const uint32_t *triangles, size_t count) {
    double area = 0;
    size_t t;
    for (t = 0; t < count; t++)
        area += triangle_area(vertices + 3 * triangles[3 * t], vertices + 3 * triangles[3 * t + 1],
                              vertices + 3 * triangles[3 * t + 2]);
    return area;
}

static inline double area_of(const wl_surface *s) {
    return area_of_triangles(s->vertices, s->triangles, s->triangle_count);
}

#endif /* GXFEM_TESTS_MODELS_H */
