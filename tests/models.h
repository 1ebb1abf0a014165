/* models.h - closed surfaces for tests: balls with waves, boxes, plates with holes; their exact moments,
   their areas, the pieces that Booleans make of them */
#ifndef GXFEM_TESTS_MODELS_H
#define GXFEM_TESTS_MODELS_H

#include "body.h"

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

static inline double area_of_skin(gx_body *body) {
    gx_skin skin;
    memset(&skin, 0, sizeof skin);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    return area_of_triangles(skin.vertex_rest, skin.triangles, skin.triangle_count);
}

/* ---- pieces, beside Booleans of the surfaces ---- */

static inline int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts both. whole: the volume of all */
static inline void expect_same_volumes(double *own, double *exact, size_t count, double whole, const char *what) {
    size_t i;
    qsort(own, count, sizeof *own, ascending);
    qsort(exact, count, sizeof *exact, ascending);
    for (i = 0; i < count; i++)
        ck_assert_msg(fabs(own[i] - exact[i]) <= 1e-10 * exact[i] + 1e-13 * whole, "%s: volume %.17g, should be %.17g",
                      what, own[i], exact[i]);
}

/* Volumes of the components of the union of all surfaces, split by a sheet or NULL. Returns their number. */
static inline size_t boolean_volumes(const workload *w, const gx_surface *sheet, double *volumes, size_t most) {
    gxb_boolean *b = NULL;
    gxb_boolean_result result;
    gxb_components components;
    size_t i;
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_fine(b, 1, NULL), GX_OK);
    for (i = 0; i < w->surface_count + (sheet != NULL); i++) {
        const gx_surface s = i < w->surface_count ? surface_of(&w->surfaces[i]) : *sheet;
        gxb_operand operand;
        memset(&operand, 0, sizeof operand);
        operand.vertices = s.vertices;
        operand.vertex_count = s.vertex_count;
        operand.triangles = s.triangles;
        operand.triangle_count = s.triangle_count;
        operand.operation = i < w->surface_count ? GXB_UNION : GXB_SPLIT;
        ck_assert_int_eq(gxb_boolean_add(b, &operand, NULL), GX_OK);
    }
    ck_assert_int_eq(gxb_boolean_evaluate(b, &result, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_components(b, &components, NULL), GX_OK);
    ck_assert_uint_le(components.count, most);
    memcpy(volumes, components.volume, components.count * sizeof *volumes);
    i = components.count;
    gxb_boolean_destroy(b);
    return i;
}

/* Fragments of a body of the surfaces that a sheet, or NULL, has cut: as many as of the Boolean, of the same volumes */
static inline void expect_pieces(gx_body *body, const workload *w, const gx_surface *sheet, const char *what) {
    enum { MOST_PIECES = 4096 };
    static double own[MOST_PIECES], exact[MOST_PIECES];
    const gx_view view = view_of(body);
    const size_t count = boolean_volumes(w, sheet, exact, MOST_PIECES);
    ck_assert_msg(view.fragment_count == count, "%s: %zu fragments, should be %zu", what, view.fragment_count, count);
    memcpy(own, view.fragment_volume, count * sizeof *own);
    expect_same_volumes(own, exact, count, view.volume, what);
}

#endif /* GXFEM_TESTS_MODELS_H */
