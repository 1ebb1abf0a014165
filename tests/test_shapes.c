/* test_shapes.c - bodies of closed surfaces: all that these wind around, carved out of a grid. Volumes and moments are
   compared with the surfaces' own, by exact sums over their triangles; cells, copies and fragments with the oracle;
   cut pieces with Booleans of the surfaces. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"

/* ---- surfaces ---- */

static gx_shape shape_of(gx_surface *surfaces, const workload *w) {
    gx_shape shape;
    size_t i;
    memset(&shape, 0, sizeof shape);
    for (i = 0; i < w->surface_count; i++) surfaces[i] = surface_of(&w->surfaces[i]);
    shape.surfaces = surfaces;
    shape.surface_count = w->surface_count;
    return shape;
}

static gx_body_desc desc_of_shape(const gx_shape *shape) {
    gx_body_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.shape = shape;
    desc.young = 1e5;
    desc.poisson = 0.4;
    desc.density = 1000;
    return desc;
}

static gx_body *shaped(const workload *w, uint32_t cells) {
    gx_surface surfaces[WL_SURFACES];
    gx_shape shape = shape_of(surfaces, w);
    gx_body_desc desc;
    gx_failure failure;
    gx_body *body = NULL;
    gx_result result;
    shape.cells = cells;
    desc = desc_of_shape(&shape);
    result = gx_body_create(&desc, &body, &failure);
    ck_assert_msg(result == GX_OK, "create: %s, %s %zu", gx_result_text(result), failure.field ? failure.field : "",
                  failure.index);
    return body;
}

/* A ball, whose radius varies with the direction, as rings of triangles between two poles, about a place */
static void add_blob(wl_surface *s, const double place[3], double radius, double waves, double depth, uint32_t rings,
                     int inward) {
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

/* A plate of unit squares with a square hole in every other one of every other row: genus holes x holes */
static void add_plate(wl_surface *s, int holes, double height) {
    const int n = 2 * holes + 1;
    int i, j, level, k;
    const uint32_t first = (uint32_t)s->vertex_count;
#define PLATE_AT(i, j, l) (first + (uint32_t)(((l) * (n + 1) + (j)) * (n + 1) + (i)))
#define PLATE_FULL(i, j)  ((i) >= 0 && (j) >= 0 && (i) < n && (j) < n && !((i) % 2 == 1 && (j) % 2 == 1))
    for (level = 0; level < 2; level++)
        for (j = 0; j <= n; j++)
            for (i = 0; i <= n; i++) {
                const double x[3] = {0.37 * i, 0.37 * j, level * height};
                wl_add_vertex(s, x);
            }
    for (j = 0; j < n; j++)
        for (i = 0; i < n; i++) {
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

static void add_bar(wl_surface *s, double x0, double y0, double z0, double x1, double y1, double z1) {
    const double low[3] = {x0, y0, z0}, high[3] = {x1, y1, z1};
    wl_add_aligned_box(s, low, high);
}

enum { SHAPES = 12 };

/* Surfaces whose winding numbers are 0 and 1, so that their own moments are the body's */
static workload some_shape(int kind) {
    static const double middle[3] = {0, 0, 0}, far[3] = {1e6, -3e5, 2e6};
    workload w = wl_empty();
    wl_surface *s = wl_add_surface(&w, 1);
    int i;
    switch (kind) {
    case 0: add_blob(s, middle, 1, 0, 0, 12, 0); break;
    case 1: add_blob(s, middle, 0.8, 3, 0.35, 24, 0); break;
    case 2: add_blob(s, far, 0.8, 4, 0.3, 16, 0); break;
    case 3: add_plate(s, 5, 0.2); break;
    case 4: /* faces at the grid's own planes */ add_bar(s, 0, 0, 0, 1, 0.5, 0.25); break;
    case 5: /* thin ears */
        add_blob(s, middle, 0.5, 0, 0, 10, 0);
        for (i = 0; i < 3; i++) s->vertices[3 * 100 + i] *= 3.5; /* of single vertices */
        for (i = 0; i < 3; i++) s->vertices[3 * 64 + i] *= 2.5;
        break;
    case 6: /* many parts, some in one element */
        for (i = 0; i < 500; i++) {
            const double x = 0.09 * (i % 10), y = 0.11 * (i / 10 % 10), z = 0.3 * (i / 100);
            add_bar(s, x, y, z, x + 0.05, y + 0.06, z + 0.02);
        }
        break;
    case 7: /* hollow */
        add_blob(s, middle, 1, 0, 0, 12, 0);
        add_blob(s, middle, 0.6, 2, 0.2, 10, 1);
        break;
    case 8: /* boxes that share an edge and a corner */
        add_bar(s, 0, 0, 0, 1, 1, 1);
        add_bar(s, 1, 1, 0, 2, 2, 1);
        add_bar(s, 2, 2, 1, 2.5, 2.5, 2);
        break;
    case 9: /* boxes that share faces, which vanish */
        add_bar(s, 0, 0, 0, 1, 1, 1);
        add_bar(s, 1, 0.25, 0.25, 2, 0.75, 0.75);
        add_bar(s, -1, 0, 0, 0, 1, 1);
        break;
    case 10: /* a layer far thinner than elements */ add_bar(s, -1, -1.1, 0.031, 1.2, 0.9, 0.0317); break;
    default: /* a needle across the grid */
        wl_add_vertex(s, middle);
        for (i = 0; i < 3; i++) {
            double x[3] = {1, 0.7, 0.4};
            x[i] += 0.013;
            wl_add_vertex(s, x);
        }
        wl_add_triangle(s, 1, 2, 3);
        for (i = 0; i < 3; i++) wl_add_triangle(s, 0, 1 + (uint32_t)(i + 1) % 3, 1 + (uint32_t)i);
    }
    return w;
}

/* ---- exact moments of a surface, by the divergence theorem ---- */

typedef struct exact_moments {
    double volume, first[3], second[6]; /* integrals of 1, x, x x: 00 01 02 11 12 22, about a place */
} exact_moments;

/* Sums over cones from the place to the triangles: D / 6, D s / 24 and D (s s + aa + bb + cc) / 120, where D =
   det(a, b, c), s = a + b + c */
static exact_moments moments_of(const workload *w, const double about[3]) {
    const rat_mark mark = rat_arena_mark();
    exact_moments m;
    big sum[10];
    size_t i, t;
    int j, k, n;
    for (k = 0; k < 10; k++) sum[k] = big_zero();
    for (i = 0; i < w->surface_count; i++)
        for (t = 0; t < w->surfaces[i].triangle_count; t++) {
            big p[3][3], s[3], d;
            for (n = 0; n < 3; n++)
                big_difference(w->surfaces[i].vertices + 3 * w->surfaces[i].triangles[3 * t + (size_t)n], about, p[n]);
            d = big_det3(p[0], p[1], p[2]);
            sum[0] = big_add(sum[0], d);
            for (k = 0; k < 3; k++) {
                s[k] = big_add(big_add(p[0][k], p[1][k]), p[2][k]);
                sum[1 + k] = big_add(sum[1 + k], big_mul(d, s[k]));
            }
            for (j = 0, n = 4; j < 3; j++)
                for (k = j; k < 3; k++, n++) {
                    big q = big_mul(s[j], s[k]);
                    int c;
                    for (c = 0; c < 3; c++) q = big_add(q, big_mul(p[c][j], p[c][k]));
                    sum[n] = big_add(sum[n], big_mul(d, q));
                }
        }
    m.volume = rat_to_double(rat_div(rat_from_big(sum[0]), rat_from_int(6)));
    for (k = 0; k < 3; k++) m.first[k] = rat_to_double(rat_div(rat_from_big(sum[1 + k]), rat_from_int(24)));
    for (k = 0; k < 6; k++) m.second[k] = rat_to_double(rat_div(rat_from_big(sum[4 + k]), rat_from_int(120)));
    rat_arena_release(mark);
    return m;
}

static double triangle_area(const double *a, const double *b, const double *c) {
    double u[3], v[3], n[3];
    int k;
    for (k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    for (k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static double area_of(const wl_surface *s) {
    double area = 0;
    size_t t;
    for (t = 0; t < s->triangle_count; t++)
        area += triangle_area(s->vertices + 3 * s->triangles[3 * t], s->vertices + 3 * s->triangles[3 * t + 1],
                              s->vertices + 3 * s->triangles[3 * t + 2]);
    return area;
}

/* ---- bodies ---- */

static size_t elements_without_cells(const gx_view *view) {
    uint8_t *has = (uint8_t *)oracle_memory(NULL, view->element_count, 1);
    size_t i, count = 0;
    memset(has, 0, view->element_count);
    for (i = 0; i < view->cell_count; i++) has[view->cell_element[i]] = 1;
    for (i = 0; i < view->element_count; i++) count += !has[i];
    free(has);
    return count;
}

/* Volume and, of all fragments together, mass, centre and inertia, against the surface's own */
static void expect_moments(const workload *w, const gx_view *view, double density, const char *what) {
    double center[3] = {0, 0, 0}, inertia[6] = {0, 0, 0, 0, 0, 0}, volume = 0, size = 0;
    exact_moments m;
    size_t f, i;
    int j, k, n;
    for (i = 0; i < view->cell_count; i++) volume += view->cell_volume[i];
    for (f = 0; f < view->fragment_count; f++)
        for (k = 0; k < 3; k++)
            center[k] += view->fragment_mass[f] * view->fragment_center[3 * f + (size_t)k] / view->mass;
    m = moments_of(w, center);
    ck_assert_msg(fabs(volume - m.volume) <= 1e-13 * m.volume, "%s: volume %.17g, should be %.17g", what, volume,
                  m.volume);
    ck_assert_msg(fabs(view->volume - m.volume) <= 1e-12 * m.volume, "%s: sum %.17g", what, view->volume);
    ck_assert_msg(fabs(view->mass - density * m.volume) <= 1e-12 * view->mass, "%s: mass %.17g", what, view->mass);
    for (f = 0; f < view->fragment_count; f++) { /* Steiner's theorem: about the common centre */
        double d[3], square = 0;
        for (k = 0; k < 3; k++) {
            d[k] = view->fragment_center[3 * f + (size_t)k] - center[k];
            square += d[k] * d[k];
        }
        for (j = n = 0; j < 3; j++)
            for (k = j; k < 3; k++, n++)
                inertia[n] += view->fragment_inertia[6 * f + (size_t)n] +
                              view->fragment_mass[f] * ((j == k ? square : 0) - d[j] * d[k]);
    }
    size = m.second[0] + m.second[3] + m.second[5];
    for (k = 0; k < 3; k++)
        ck_assert_msg(fabs(m.first[k]) <= 1e-12 * sqrt(size * m.volume) + 1e-13 * fabs(center[k]) * m.volume,
                      "%s: the centre is off by %g", what, m.first[k] / m.volume);
    for (j = n = 0; j < 3; j++)
        for (k = j; k < 3; k++, n++)
            ck_assert_msg(fabs(inertia[n] - density * ((j == k ? size : 0) - m.second[n])) <=
                              (1e-12 + 1e-15 * fabs(center[j]) / sqrt(size / m.volume)) * density * size,
                          "%s: inertia %d: %.17g, should be %.17g", what, n, inertia[n],
                          density * ((j == k ? size : 0) - m.second[n]));
}

static double area_of_skin(gx_body *body) {
    gx_skin skin;
    double area = 0;
    size_t t;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    for (t = 0; t < skin.triangle_count; t++)
        area += triangle_area(skin.vertex_rest + 3 * skin.triangles[3 * t],
                              skin.vertex_rest + 3 * skin.triangles[3 * t + 1],
                              skin.vertex_rest + 3 * skin.triangles[3 * t + 2]);
    for (t = 0; t < skin.triangle_count; t++) ck_assert_uint_eq(skin.triangle_surface[t], 1);
    return area;
}

START_TEST(volumes_and_skins) {
    static const uint32_t cells[3] = {1, 5, 12};
    const workload w = some_shape(_i / 3);
    char what[40];
    gx_body *body;
    gx_view view;
    workload copy = w;
    snprintf(what, sizeof what, "shape %d, %u cells", _i / 3, cells[_i % 3]);
    body = shaped(&w, cells[_i % 3]);
    view = view_of(body);
    expect_moments(&w, &view, 1000, what);
    if (_i / 3 != 9 && _i / 3 != 2) { /* faces that vanish have no skin; far out coordinates have fewer digits */
        const double area = area_of(&w.surfaces[0]), own = area_of_skin(body);
        ck_assert_msg(fabs(own - area) <= 1e-12 * area, "%s: skin %.17g, should be %.17g", what, own, area);
    }
    ck_assert_uint_eq(elements_without_cells(&view), 0);
    gx_body_destroy(body);
    wl_free(&copy);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("shapes");
    TCase *tests = tcase_create("shapes");
    tcase_set_timeout(tests, 300);
    tcase_add_loop_test(tests, volumes_and_skins, 0, 3 * SHAPES);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) {
    const int result = run_suite(suite());
    rat_arena_free();
    return result;
}
