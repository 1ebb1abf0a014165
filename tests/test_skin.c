/* test_skin.c - the visual surface: an updated skin equals one made from nothing, changes are reported, surfaces are
   watertight, normals, texture coordinates, rays. More on the skin: test_body.c.

   Random tests print their seed. GXFEM_SEED=n runs seed n alone. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "body.h"
#include "skin_check.h"

enum { SEEDS = 60 / FEWER };

static gx_skin skin_of(gx_body *body, const gx_skin_desc *desc) {
    gx_skin skin;
    gx_result result = gx_body_skin(body, desc, &skin, NULL);
    ck_assert_msg(result == GX_OK, "skin: %s", gx_result_text(result));
    return skin;
}

static gx_skin_desc random_desc(void) {
    gx_skin_desc desc;
    desc.crease_angle = random_below(2) ? random_real(0.1, 3) : 0;
    desc.smooth_cuts = random_below(2);
    return desc;
}

static double *positions_of(gx_body *body, const gx_skin *skin) {
    double *x = (double *)oracle_memory(NULL, 3 * skin->vertex_count + 1, sizeof *x);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    return x;
}

static void move_at_random(gx_body *body, double by) {
    gx_view view = view_of(body);
    size_t i;
    for (i = 0; i < 3 * view.copy_count; i++) view.displacement[i] = random_real(-by, by);
}

static double length_of(const float *n) {
    return sqrt((double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] + (double)n[2] * (double)n[2]);
}

/* ---- updates ---- */

/* A triangle by the data at its corners, the smallest first. Normals and texture coordinates are compared in coarse
   steps: their rounding depends on the order of sums. */
typedef struct named_corner {
    uint32_t point, copies[4];
    double weights[4];
    long normal[3], texture[2];
} named_corner;
typedef struct named_triangle {
    named_corner corner[3];
    uint32_t element, surface, fragment;
} named_triangle;

static void name_corner(const gx_skin *skin, uint32_t v, named_corner *c) {
    int i, j, k;
    c->point = skin->vertex_point[v];
    for (i = 0; i < 4; i++) {
        uint32_t copy =
            skin->vertex_weights[4 * v + (uint32_t)i] > 0 ? skin->vertex_copies[4 * v + (uint32_t)i] : UINT32_MAX;
        for (j = i; j > 0 && c->copies[j - 1] > copy; j--) {
            c->copies[j] = c->copies[j - 1];
            c->weights[j] = c->weights[j - 1];
        }
        c->copies[j] = copy;
        c->weights[j] = floor(skin->vertex_weights[4 * v + (uint32_t)i] * 1e9 + 0.5);
    }
    for (k = 0; k < 3; k++)
        c->normal[k] = (long)floor((double)skin->vertex_normal[3 * v + (uint32_t)k] * 1000 + 0.4999);
    for (k = 0; k < 2; k++)
        c->texture[k] = (long)floor((double)skin->vertex_texture[2 * v + (uint32_t)k] * 1000 + 0.4999);
}

static int by_corner(const named_corner *a, const named_corner *b) {
    int k;
    if (a->point != b->point) return a->point < b->point ? -1 : 1;
    for (k = 0; k < 4; k++)
        if (a->copies[k] != b->copies[k]) return a->copies[k] < b->copies[k] ? -1 : 1;
    return 0;
}

static int by_triangle(const void *p, const void *q) {
    const named_triangle *a = (const named_triangle *)p, *b = (const named_triangle *)q;
    int k, c;
    for (k = 0; k < 3; k++)
        if ((c = by_corner(&a->corner[k], &b->corner[k])) != 0) return c;
    if (a->element != b->element) return a->element < b->element ? -1 : 1;
    if (a->surface != b->surface) return a->surface < b->surface ? -1 : 1;
    return 0;
}

static named_triangle *names_of(const gx_skin *skin) {
    named_triangle *named = (named_triangle *)calloc(skin->triangle_count + 1, sizeof *named);
    size_t t;
    int k, first;
    for (t = 0; t < skin->triangle_count; t++) {
        named_corner c[3];
        memset(c, 0, sizeof c);
        for (k = 0; k < 3; k++) name_corner(skin, skin->triangles[3 * t + (size_t)k], &c[k]);
        for (first = 0, k = 1; k < 3; k++)
            if (by_corner(&c[k], &c[first]) < 0) first = k;
        for (k = 0; k < 3; k++) named[t].corner[k] = c[(first + k) % 3];
        named[t].element = skin->triangle_element[t];
        named[t].surface = skin->triangle_surface[t];
        named[t].fragment = skin->triangle_fragment[t];
    }
    qsort(named, skin->triangle_count, sizeof *named, by_triangle);
    return named;
}

static int same_corner(const named_corner *a, const named_corner *b) {
    int k;
    if (by_corner(a, b) != 0) return 0;
    for (k = 0; k < 4; k++)
        if (fabs(a->weights[k] - b->weights[k]) > 1) return 0;
    for (k = 0; k < 3; k++)
        if (labs(a->normal[k] - b->normal[k]) > 1) return 0;
    for (k = 0; k < 2; k++)
        if (labs(a->texture[k] - b->texture[k]) > 1) return 0;
    return 1;
}

/* The same triangles, corners and vertices, in any order? */
static void check_same(const gx_skin *a, const gx_skin *b, uint64_t seed, size_t cut) {
    named_triangle *p = names_of(a), *q = names_of(b);
    size_t t;
    int k;
    ck_assert_msg(a->triangle_count == b->triangle_count, "seed %llu, cut %zu: %zu triangles, made anew %zu",
                  (unsigned long long)seed, cut, a->triangle_count, b->triangle_count);
    ck_assert_msg(a->vertex_count == b->vertex_count, "seed %llu, cut %zu: %zu vertices, made anew %zu",
                  (unsigned long long)seed, cut, a->vertex_count, b->vertex_count);
    for (t = 0; t < a->triangle_count; t++) {
        ck_assert_msg(p[t].element == q[t].element && p[t].surface == q[t].surface && p[t].fragment == q[t].fragment,
                      "seed %llu, cut %zu: triangle %zu is of element %u, surface %u", (unsigned long long)seed, cut, t,
                      p[t].element, p[t].surface);
        for (k = 0; k < 3; k++)
            ck_assert_msg(
                same_corner(&p[t].corner[k], &q[t].corner[k]),
                "seed %llu, cut %zu: corner %d of triangle %zu differs: normal %ld %ld %ld, made anew %ld %ld %ld",
                (unsigned long long)seed, cut, k, t, p[t].corner[k].normal[0], p[t].corner[k].normal[1],
                p[t].corner[k].normal[2], q[t].corner[k].normal[0], q[t].corner[k].normal[1], q[t].corner[k].normal[2]);
    }
    free(p);
    free(q);
}

/* Watertight as a whole and per fragment; every vertex has a triangle; normals have length 1 and look outward. */
static void check_whole(gx_body *body, const gx_skin *skin, uint64_t seed) {
    gx_view view = view_of(body);
    double *x = positions_of(body, skin);
    uint8_t *used = (uint8_t *)calloc(skin->vertex_count + 1, 1);
    uint32_t f;
    size_t i;
    for (f = 0; f < view.fragment_count; f++) CHECK_SEED(skin_count(skin, f, x).open_edges == 0, seed);
    for (i = 0; i < 3 * skin->triangle_count; i++) used[skin->triangles[i]] = 1;
    for (i = 0; i < skin->vertex_count; i++) {
        CHECK_SEED(used[i], seed);
        CHECK_SEED(fabs(length_of(skin->vertex_normal + 3 * i) - 1) < 1e-6, seed);
    }
    free(used);
    free(x);
}

/* The user's own arrays, kept up to date by the reported ranges */
typedef struct mirror {
    uint32_t *copies, *triangles, *surface;
    float *normal;
    size_t vertices, count;
} mirror;

static void follow(mirror *m, const gx_skin *skin) {
    size_t r, i;
    m->copies = (uint32_t *)realloc(m->copies, (4 * skin->vertex_count + 1) * sizeof *m->copies);
    m->normal = (float *)realloc(m->normal, (3 * skin->vertex_count + 1) * sizeof *m->normal);
    m->triangles = (uint32_t *)realloc(m->triangles, (3 * skin->triangle_count + 1) * sizeof *m->triangles);
    m->surface = (uint32_t *)realloc(m->surface, (skin->triangle_count + 1) * sizeof *m->surface);
    for (r = 0; r < skin->vertex_range_count; r++) {
        const size_t first = skin->vertex_ranges[r].first, count = skin->vertex_ranges[r].count;
        ck_assert(first + count <= skin->vertex_count && count > 0);
        if (r > 0) ck_assert(first > skin->vertex_ranges[r - 1].first + skin->vertex_ranges[r - 1].count);
        memcpy(m->copies + 4 * first, skin->vertex_copies + 4 * first, 4 * count * sizeof *m->copies);
        memcpy(m->normal + 3 * first, skin->vertex_normal + 3 * first, 3 * count * sizeof *m->normal);
    }
    for (r = 0; r < skin->triangle_range_count; r++) {
        const size_t first = skin->triangle_ranges[r].first, count = skin->triangle_ranges[r].count;
        ck_assert(first + count <= skin->triangle_count && count > 0);
        memcpy(m->triangles + 3 * first, skin->triangles + 3 * first, 3 * count * sizeof *m->triangles);
        memcpy(m->surface + first, skin->triangle_surface + first, count * sizeof *m->surface);
    }
    for (i = 0; i < 4 * skin->vertex_count; i++) ck_assert_uint_eq(m->copies[i], skin->vertex_copies[i]);
    ck_assert(memcmp(m->normal, skin->vertex_normal, 3 * skin->vertex_count * sizeof *m->normal) == 0);
    for (i = 0; i < 3 * skin->triangle_count; i++) ck_assert_uint_eq(m->triangles[i], skin->triangles[i]);
    for (i = 0; i < skin->triangle_count; i++) ck_assert_uint_eq(m->surface[i], skin->triangle_surface[i]);
}

/* After each of some cuts: the updated skin, and one made from nothing */
START_TEST(follows_cuts) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 6, 1);
    gx_body *body = body_of(&w), *other = body_of(&w);
    gx_skin_desc desc = random_desc(), another = desc;
    mirror m;
    gx_skin skin, anew;
    size_t c;
    memset(&m, 0, sizeof m);
    another.crease_angle += 0.01;
    another.smooth_cuts = !desc.smooth_cuts;
    skin = skin_of(body, &desc);
    check_whole(body, &skin, seed);
    follow(&m, &skin);
    for (c = 0; c < w.surface_count; c++) {
        cut_by(body, &w, c, 1);
        cut_by(other, &w, c, 1);
        if (random_below(3) == 0) continue; /* several cuts before an update */
        skin = skin_of(body, &desc);
        skin_of(other, &another); /* with another description: nothing of it is kept */
        anew = skin_of(other, &desc);
        check_same(&skin, &anew, seed, c);
        move_at_random(body, 0.2);
        check_whole(body, &skin, seed);
        follow(&m, &skin);
        skin = skin_of(body, &desc); /* nothing has happened */
        ck_assert(skin.vertex_range_count == 0 && skin.triangle_range_count == 0);
    }
    free(m.copies);
    free(m.triangles);
    free(m.surface);
    free(m.normal);
    gx_body_destroy(body);
    gx_body_destroy(other);
    wl_free(&w);
}
END_TEST

/* A body restored to its state before a cut shows the same as then, and follows later cuts from there. */
START_TEST(follows_restores) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 3, 1);
    gx_body *body = body_of(&w), *old;
    gx_skin_desc desc = random_desc();
    gx_skin skin, truth;
    cut_by(body, &w, 0, 1);
    skin_of(body, &desc);
    ck_assert_int_eq(gx_body_clone(body, &old, NULL), GX_OK);
    cut_by(body, &w, 1, 1);
    if (random_below(2)) skin_of(body, &desc);
    ck_assert_int_eq(gx_body_restore(body, old, NULL), GX_OK);
    skin = skin_of(body, &desc);
    truth = skin_of(old, &desc);
    check_same(&skin, &truth, seed, 1);
    cut_by(body, &w, 2, 1);
    cut_by(old, &w, 2, 1);
    skin = skin_of(body, &desc);
    truth = skin_of(old, &desc);
    check_same(&skin, &truth, seed, 2);
    gx_body_destroy(body);
    gx_body_destroy(old);
    wl_free(&w);
}
END_TEST

/* A small cut in a large body changes little of its skin. */
/* Elements that an edge joins until half of it is cut, and then the element beside it: the updated skin is closed
   and equals one made from nothing. */
START_TEST(follows_cuts_at_a_pinch) {
    static const double x[8][3] = {{0, 0, 0},      {0, 0, 1},       {1, -0.5, 0.5}, {1, 0.5, 0.5},
                                   {-1, 0.5, 0.5}, {-1, -0.5, 0.5}, {1, 0, -2},     {0.2, 1.5, 0.5}};
    static const double through[3][3] = {{0, -1, 0.5}, {0, 1, 0.3}, {0, 1, 0.7}};
    workload w = wl_empty();
    wl_surface *s = wl_add_surface(&w, 0);
    gx_body *body, *copy;
    gx_skin skin, whole;
    int i;
    for (i = 0; i < 8; i++) wl_add_node(&w, x[i][0], x[i][1], x[i][2]);
    wl_add_element(&w, 0, 1, 2, 3);
    wl_add_element(&w, 0, 1, 4, 5);
    wl_add_element(&w, 0, 2, 3, 6);
    wl_add_element(&w, 0, 1, 3, 7);
    for (i = 0; i < 3; i++) wl_add_vertex(s, through[i]);
    wl_add_triangle(s, 0, 1, 2);
    add_axis_plane(&w, 2, -1.5);
    body = body_of(&w);
    skin_of(body, NULL);
    hash_of(body);
    for (i = 0; i < 2; i++) {
        cut_by(body, &w, (size_t)i, 1);
        skin = skin_of(body, NULL);
        ck_assert_int_eq(gx_body_clone(body, &copy, NULL), GX_OK);
        whole = skin_of(copy, NULL);
        check_whole(copy, &whole, 0);
        check_whole(body, &skin, 0);
        if (i == 1) check_same(&skin, &whole, 0, 1);
        gx_body_destroy(copy);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(changes_are_local) {
    workload w = grid(12, 12, 12, 5);
    gx_body *body = body_of(&w);
    gx_skin skin = skin_of(body, NULL);
    size_t before = skin.triangle_count, changed = 0, r;
    const double p[3] = {0.3, 0.4, 6}, n[3] = {0.1, 1, 0.2};
    ck_assert_uint_eq(skin.triangle_range_count, 1);
    ck_assert_uint_eq(skin.triangle_ranges[0].count, before);
    add_plane(&w, p, n, 1.5);
    cut_by(body, &w, 0, 1);
    skin = skin_of(body, NULL);
    ck_assert_uint_gt(skin.triangle_count, before);
    for (r = 0; r < skin.triangle_range_count; r++) changed += skin.triangle_ranges[r].count;
    ck_assert_uint_gt(changed, skin.triangle_count - before);
    ck_assert_uint_lt(changed, skin.triangle_count / 6);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A sheet that ends in the first element that it enters shows nothing. It leaves no gap where it divides the outer
   surface's edges. */
START_TEST(partial_cuts_show_nothing) {
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    gx_skin skin = skin_of(body, NULL);
    size_t t;
    wl_surface *s = wl_add_surface(&w, 0);
    const double a[3] = {0.45, -1, -1}, b[3] = {0.5, -1, 1}, c[3] = {0.5, 0.2, 0.2};
    wl_add_vertex(s, a);
    wl_add_vertex(s, b);
    wl_add_vertex(s, c);
    wl_add_triangle(s, 0, 1, 2);
    cut_by(body, &w, 0, 1);
    ck_assert_uint_eq(view_of(body).copy_count, 27);
    skin = skin_of(body, NULL);
    for (t = 0; t < skin.triangle_count; t++) ck_assert_uint_eq(skin.triangle_surface[t], GX_SKIN_OUTER);
    check_whole(body, &skin, 0);
    add_axis_plane(&w, 0, 0.5);
    cut_by(body, &w, 1, 1);
    skin = skin_of(body, NULL);
    for (t = 0; t < skin.triangle_count && skin.triangle_surface[t] != 2; t++) {}
    ck_assert_uint_lt(t, skin.triangle_count);
    check_whole(body, &skin, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- normals ---- */

static double agreement(const float *n, const double *m) {
    return ((double)n[0] * m[0] + (double)n[1] * m[1] + (double)n[2] * m[2]) /
           sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
}

static void normal_of(const double *x, const uint32_t *t, double n[3]) {
    const double *a = x + 3 * t[0], *b = x + 3 * t[1], *c = x + 3 * t[2];
    int k;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
    }
}

/* Flat: each corner has its triangle's normal, at rest and turned. Creases below a right angle give the same on a
   block. */
START_TEST(flat_normals) {
    workload w = grid(2, 2, 1, 5);
    gx_body *body;
    gx_view view;
    gx_skin_desc desc;
    gx_skin skin;
    float *x, *n;
    double *y, m[3];
    size_t i, k;
    memset(&desc, 0, sizeof desc);
    if (_i) desc.crease_angle = 1.5;
    {
        const double p[3] = {0.93, 1.07, 0.55}, q[3] = {1, 0.3, 0.2}, r[3] = {0.1, 1, 0.4};
        add_plane(&w, p, q, 40);
        add_plane(&w, p, r, 40);
    }
    body = cut_in_sequence(&w);
    view = view_of(body);
    skin = skin_of(body, &desc);
    x = (float *)malloc(3 * skin.vertex_count * sizeof *x);
    n = (float *)malloc(3 * skin.vertex_count * sizeof *n);
    for (i = 0; i < skin.triangle_count; i++)
        for (k = 0; k < 3; k++) {
            normal_of(skin.vertex_rest, skin.triangles + 3 * i, m);
            ck_assert_double_ge(agreement(skin.vertex_normal + 3 * skin.triangles[3 * i + k], m), 1 - 1e-6);
        }
    for (i = 0; i < view.copy_count; i++) { /* x -> (-y, x, z) + 7 */
        const double *X = w.positions + 3 * view.copy_node[i];
        view.displacement[3 * i] = -X[1] - X[0] + 7;
        view.displacement[3 * i + 1] = X[0] - X[1] + 7;
        view.displacement[3 * i + 2] = 7;
    }
    ck_assert_int_eq(gx_body_skin_vertices(body, NULL, x, n, NULL), GX_OK);
    y = positions_of(body, &skin);
    for (i = 0; i < skin.vertex_count; i++) {
        for (k = 0; k < 3; k++) ck_assert_double_eq_tol((double)x[3 * i + k], y[3 * i + k], 1e-6 * 10);
        m[0] = -(double)skin.vertex_normal[3 * i + 1];
        m[1] = (double)skin.vertex_normal[3 * i];
        m[2] = (double)skin.vertex_normal[3 * i + 2];
        ck_assert_double_ge(agreement(n + 3 * i, m), 1 - 1e-6);
    }
    {
        const double origin[3] = {7, 7, 7};
        ck_assert_int_eq(gx_body_skin_vertices(body, origin, x, NULL, NULL), GX_OK);
    }
    for (i = 0; i < 3 * skin.vertex_count; i++) ck_assert_double_eq_tol((double)x[i], y[i] - 7, 1e-6);
    free(x);
    free(n);
    free(y);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A body as small or as large as the limits allow, whose squared areas are no floats, has the same normals as at 1
   m. */
START_TEST(normals_at_any_size) {
    const double p[3] = {0.93, 1.07, 0.55}, q[3] = {1, 0.3, 0.2}, r[3] = {0.1, 1, 0.4};
    static const int powers[4] = {0, -100, 98, 50};
    float *normals[4], *x;
    size_t vertices = 0, i, k;
    gx_skin_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.smooth_cuts = _i % 2;
    desc.crease_angle = _i / 2 ? 1.5 : 0;
    for (i = 0; i < 4; i++) {
        workload w = grid(2, 2, 1, 5);
        gx_body *body;
        gx_skin skin;
        add_plane(&w, p, q, 40);
        add_plane(&w, p, r, 40);
        for (k = 0; k < 3 * w.node_count; k++) w.positions[k] = ldexp(w.positions[k], powers[i]);
        for (k = 0; k < 3 * w.surfaces[0].vertex_count; k++)
            w.surfaces[0].vertices[k] = ldexp(w.surfaces[0].vertices[k], powers[i]);
        for (k = 0; k < 3 * w.surfaces[1].vertex_count; k++)
            w.surfaces[1].vertices[k] = ldexp(w.surfaces[1].vertices[k], powers[i]);
        body = cut_in_sequence(&w);
        skin = skin_of(body, &desc);
        normals[i] = (float *)malloc(6 * skin.vertex_count * sizeof **normals);
        x = (float *)malloc(3 * skin.vertex_count * sizeof *x);
        memcpy(normals[i], skin.vertex_normal, 3 * skin.vertex_count * sizeof **normals);
        ck_assert_int_eq(gx_body_skin_vertices(body, NULL, x, normals[i] + 3 * skin.vertex_count, NULL), GX_OK);
        free(x);
        ck_assert(i == 0 || skin.vertex_count == vertices);
        vertices = skin.vertex_count;
        for (k = 0; k < 6 * vertices; k++)
            ck_assert_msg(fabsf(normals[i][k] - normals[0][k]) < 1e-6f, "2^%d: %g, not %g", powers[i],
                          (double)normals[i][k], (double)normals[0][k]);
        gx_body_destroy(body);
        wl_free(&w);
    }
    for (i = 0; i < 4; i++) free(normals[i]);
}
END_TEST

/* Smooth everywhere: a block has one vertex per outer node; its corner's normal is the mean by area of three faces.
   A cut leaves the rest normals of the outer surface alone and stays sharp against it. */
START_TEST(smooth_normals) {
    workload w = grid(3, 3, 3, 5);
    gx_body *body = body_of(&w);
    gx_skin_desc desc;
    gx_skin skin;
    float old[64][3];
    size_t i, sharp = 0;
    const double p[3] = {1.4, 1.5, 1.6}, q[3] = {1, 0.1, 0.2};
    desc.crease_angle = 3;
    desc.smooth_cuts = 1;
    skin = skin_of(body, &desc);
    ck_assert_uint_eq(skin.vertex_count, 64 - 8);
    for (i = 0; i < skin.vertex_count; i++) {
        const double *x = skin.vertex_rest + 3 * i;
        memcpy(old[skin.vertex_point[i]], skin.vertex_normal + 3 * i, sizeof old[0]);
        if (x[0] == 1 && x[1] == 1 && x[2] == 0)
            ck_assert_double_eq_tol((double)skin.vertex_normal[3 * i + 2], -1, 1e-6);
        if (x[0] == 1 && x[1] == 0 && x[2] == 0)
            ck_assert_double_eq_tol((double)skin.vertex_normal[3 * i + 0], 0, 1e-6);
    }
    add_plane(&w, p, q, 40);
    cut_by(body, &w, 0, 1);
    skin = skin_of(body, &desc);
    for (i = 0; i < skin.triangle_count; i++) {
        const uint32_t v = skin.triangles[3 * i];
        if (skin.triangle_surface[i] == GX_SKIN_OUTER && skin.vertex_point[v] < 64)
            ck_assert(memcmp(old[skin.vertex_point[v]], skin.vertex_normal + 3 * v, sizeof old[0]) == 0);
        if (skin.triangle_surface[i] == 1) {
            ck_assert_double_ge(fabs(agreement(skin.vertex_normal + 3 * v, q)), 1 - 1e-6);
            sharp++;
        }
    }
    ck_assert_uint_gt(sharp, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A wave's faces: smooth ones have one vertex for each side of a point, flat ones one per plane. */
START_TEST(smooth_cuts) {
    workload w = grid(3, 3, 3, 5);
    wl_frame f = wl_axes();
    gx_body *body;
    gx_skin_desc desc;
    size_t flat;
    gx_skin skin;
    size_t i;
    memset(&desc, 0, sizeof desc);
    for (i = 0; i < 3; i++) f.origin[i] = 1.37;
    wl_add_wave(wl_add_surface(&w, 0), &f, 16, 5);
    body = cut_in_sequence(&w);
    skin = skin_of(body, &desc);
    flat = skin.vertex_count;
    desc.smooth_cuts = 1;
    skin = skin_of(body, &desc);
    ck_assert_uint_lt(skin.vertex_count, flat);
    for (i = 0; i < skin.triangle_count; i++) {
        double m[3];
        if (skin.triangle_surface[i] != 1) continue;
        normal_of(skin.vertex_rest, skin.triangles + 3 * i, m);
        /* the wave is not steep */
        ck_assert_double_gt(agreement(skin.vertex_normal + 3 * skin.triangles[3 * i], m), 0.3);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Corners of a hole within an element are weighed by all four of its copies. At rest, their normals are those of the
   skin. */
START_TEST(corners_within_an_element) {
    static const double low[3] = {0.45, 0.45, 0.45}, high[3] = {0.55, 0.55, 0.55};
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_skin_desc desc;
    gx_skin skin;
    float *x, *normals;
    size_t i, within = 0;
    int k;
    memset(&desc, 0, sizeof desc);
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    body = cut_in_sequence(&w);
    skin = skin_of(body, &desc);
    x = (float *)malloc(3 * skin.vertex_count * sizeof *x);
    normals = (float *)malloc(3 * skin.vertex_count * sizeof *normals);
    ck_assert_int_eq(gx_body_skin_vertices(body, NULL, x, normals, NULL), GX_OK);
    for (i = 0; i < skin.vertex_count; i++) within += skin.vertex_weights[4 * i + 3] > 0;
    ck_assert_uint_ge(within, 8);
    for (i = 0; i < skin.vertex_count; i++)
        for (k = 0; k < 3; k++) {
            const size_t at = 3 * i + (size_t)k;
            ck_assert_msg(fabsf(normals[at] - skin.vertex_normal[at]) < 1e-6f, "vertex %zu: %g, not %g", i,
                          (double)normals[at], (double)skin.vertex_normal[at]);
        }
    free(x);
    free(normals);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A link that is severed has no surface to be smooth with: its faces are flat. */
START_TEST(severed_walls_are_flat) {
    workload w = wl_pair();
    gx_body *body = body_of(&w);
    gx_surface surfaces[2];
    gx_cut_desc cut;
    gx_cut_report report;
    gx_skin_desc desc;
    gx_skin skin;
    size_t i, severed = 0;
    int k;
    for (k = 0; k < 2; k++) { /* on both sides of the face x = y + z, but for a strip beside it */
        const double y = k ? 0.25 + 1e-6 : 0.25, far = k ? -4 : 4, p[3] = {y - 4, y, -4}, q[3] = {y + 4, y, 4},
                     r[3] = {4 * far, y, -far};
        wl_surface *half = wl_add_surface(&w, 0);
        wl_add_vertex(half, p);
        wl_add_vertex(half, q);
        wl_add_vertex(half, r);
        wl_add_triangle(half, 0, 1, 2);
        surfaces[k] = surface_of(half);
    }
    memset(&cut, 0, sizeof cut);
    memset(&desc, 0, sizeof desc);
    cut.surfaces = surfaces;
    cut.surface_count = 2;
    cut.sever_below = 0.01;
    ck_assert_int_eq(gx_body_cut(body, &cut, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.severed_links, 1);
    desc.smooth_cuts = 1;
    skin = skin_of(body, &desc);
    for (i = 0; i < skin.triangle_count; i++) {
        double m[3];
        if (skin.triangle_surface[i] != GX_SKIN_SEVERED) continue;
        severed++;
        normal_of(skin.vertex_rest, skin.triangles + 3 * i, m);
        for (k = 0; k < 3; k++)
            ck_assert_double_gt(agreement(skin.vertex_normal + 3 * skin.triangles[3 * i + (size_t)k], m), 0.999);
    }
    ck_assert_uint_gt(severed, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- texture coordinates ---- */

static float linear(const double *x, int k) {
    return (float)(k ? 0.5 * x[0] - 0.25 * x[1] + x[2] : x[0] + 2 * x[1] - 0.125 * x[2] + 3);
}

/* Texture coordinates that are linear in the material coordinates on nodes and on the cut's vertices are so
   everywhere. A surface without them: 0. */
START_TEST(texture) {
    workload w = random_scene((uint64_t)_i, 2, 1);
    gx_body_desc desc = desc_of(&w);
    gx_body *body;
    gx_surface surface;
    gx_cut_desc cut;
    gx_skin skin;
    float *outer = (float *)malloc(2 * w.node_count * sizeof *outer), *inner;
    size_t i, c;
    int k;
    for (i = 0; i < w.node_count; i++)
        for (k = 0; k < 2; k++) outer[2 * i + (size_t)k] = linear(w.positions + 3 * i, k);
    desc.texture = outer;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    free(outer);
    for (c = 0; c < w.surface_count; c++) {
        surface = surface_of(&w.surfaces[c]);
        inner = (float *)malloc(2 * surface.vertex_count * sizeof *inner);
        for (i = 0; i < surface.vertex_count; i++)
            for (k = 0; k < 2; k++) inner[2 * i + (size_t)k] = linear(surface.vertices + 3 * i, k);
        if (c == 0) surface.texture = inner;
        memset(&cut, 0, sizeof cut);
        cut.surfaces = &surface;
        cut.surface_count = 1;
        ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
        free(inner);
    }
    skin = skin_of(body, NULL);
    for (i = 0; i < 3 * skin.triangle_count; i++) {
        const uint32_t v = skin.triangles[i], s = skin.triangle_surface[i / 3];
        for (k = 0; k < 2 && s < 2; k++)
            ck_assert_double_eq_tol((double)skin.vertex_texture[2 * v + (uint32_t)k],
                                    (double)linear(skin.vertex_rest + 3 * v, k), 1e-4);
        for (k = 0; k < 2 && s >= 2; k++) ck_assert(skin.vertex_texture[2 * v + (uint32_t)k] == 0);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Area of a triangle of the skin at rest */
static double rest_area(const gx_skin *skin, size_t t) {
    const uint32_t *v = skin->triangles + 3 * t;
    const double *p = skin->vertex_rest + 3 * (size_t)v[0], *q = skin->vertex_rest + 3 * (size_t)v[1],
                 *r = skin->vertex_rest + 3 * (size_t)v[2];
    double sum = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double n = (q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i]);
        sum += n * n;
    }
    return 0.5 * sqrt(sum);
}

/* Triangles without area among others have no map to their texture, and change nothing. */
START_TEST(texture_of_flat_triangles) {
    enum { SIDE = 10, QUADS = SIDE * SIDE };
    double x[3 * (SIDE + 1) * (SIDE + 1)];
    float map[2 * (SIDE + 1) * (SIDE + 1)];
    uint32_t triangles[9 * QUADS];
    workload w = grid(2, 2, 2, 5);
    gx_surface surface;
    gx_cut_desc cut;
    double area[2] = {0, 0};
    size_t count[2], i;
    int way, k;
    memset(&surface, 0, sizeof surface);
    memset(&cut, 0, sizeof cut);
    for (i = 0; i < (SIDE + 1) * (SIDE + 1); i++) {
        x[3 * i] = 0.3 * (double)(i % (SIDE + 1)) - 0.5;
        x[3 * i + 1] = 0.3 * (double)(i / (SIDE + 1)) - 0.5;
        x[3 * i + 2] = 0.9;
        for (k = 0; k < 2; k++) map[2 * i + (size_t)k] = linear(x + 3 * i, k);
    }
    for (i = 0; i < QUADS; i++) {
        const uint32_t v = (uint32_t)(i / SIDE * (SIDE + 1) + i % SIDE);
        const uint32_t corners[9] = {v, v + 1, v + SIDE + 2, v, v + SIDE + 2, v + SIDE + 1, v, v + 1, v};
        memcpy(triangles + 9 * i, corners, sizeof corners);
    }
    surface.vertices = x;
    surface.vertex_count = (SIDE + 1) * (SIDE + 1);
    surface.triangles = triangles;
    surface.texture = map;
    cut.surfaces = &surface;
    cut.surface_count = 1;
    for (way = 0; way < 2; way++) { /* all triangles, then those with area only */
        gx_body *body = body_of(&w);
        gx_skin skin;
        surface.triangle_count = (way ? 2 : 3) * QUADS;
        for (i = 0; way && i < 6 * QUADS; i++) triangles[i] = triangles[i / 6 * 9 + i % 6];
        ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
        skin = skin_of(body, NULL);
        count[way] = skin.triangle_count;
        for (i = 0; i < skin.triangle_count; i++)
            if (skin.triangle_surface[i] == 1) area[way] += rest_area(&skin, i);
        for (i = 0; i < 3 * skin.triangle_count; i++) {
            const uint32_t v = skin.triangles[i];
            for (k = 0; k < 2 && skin.triangle_surface[i / 3] == 1; k++)
                ck_assert_double_eq_tol((double)skin.vertex_texture[2 * v + (uint32_t)k],
                                        (double)linear(skin.vertex_rest + 3 * v, k), 1e-4);
        }
        gx_body_destroy(body);
    }
    ck_assert_uint_eq(count[0], count[1]);
    ck_assert_double_eq_tol(area[0], 8, 1e-12); /* both faces of the cut */
    ck_assert_double_eq_tol(area[1], 8, 1e-12);
    wl_free(&w);
}
END_TEST

/* ---- rays ---- */

/* Moeller and Trumbore's test, with a margin: -1 misses, 1 hits, 0 too close to an edge to tell */
static int meets(const double *o, const double *d, const double *a, const double *b, const double *c, double *t) {
    double e[3], f[3], p[3], q[3], s[3], det = 0, u = 0, v = 0, along = 0;
    int k;
    for (k = 0; k < 3; k++) {
        e[k] = b[k] - a[k];
        f[k] = c[k] - a[k];
        s[k] = o[k] - a[k];
    }
    for (k = 0; k < 3; k++) {
        p[k] = d[(k + 1) % 3] * f[(k + 2) % 3] - d[(k + 2) % 3] * f[(k + 1) % 3];
        q[k] = s[(k + 1) % 3] * e[(k + 2) % 3] - s[(k + 2) % 3] * e[(k + 1) % 3];
    }
    for (k = 0; k < 3; k++) {
        det += e[k] * p[k];
        u += s[k] * p[k];
        v += d[k] * q[k];
        along += f[k] * q[k];
    }
    if (fabs(det) < 1e-12) return -1; /* seen from the side, or almost */
    u /= det;
    v /= det;
    *t = along / det;
    if (u < -1e-9 || v < -1e-9 || u + v > 1 + 1e-9 || *t < -1e-9) return -1;
    return u > 1e-9 && v > 1e-9 && u + v < 1 - 1e-9 && *t > 1e-9 ? 1 : 0;
}

START_TEST(picks_what_a_ray_meets) {
    uint64_t seed = (uint64_t)_i;
    workload w = random_scene(seed, 3, 1);
    gx_body *body = cut_in_sequence(&w);
    gx_skin skin = skin_of(body, NULL);
    double *x;
    int ray, k, hits = 0;
    move_at_random(body, 0.05);
    x = positions_of(body, &skin);
    for (ray = 0; ray < 50 && skin.triangle_count > 0; ray++) {
        double o[3], d[3], t, nearest = HUGE_VAL;
        size_t i, best = 0;
        int unsure = 0;
        gx_hit hit;
        const double *target = x + 3 * skin.triangles[random_below((int)(3 * skin.triangle_count))];
        for (k = 0; k < 3; k++) {
            o[k] = random_real(-1, 2);
            d[k] = target[k] + random_real(-0.1, 0.1) - o[k];
        }
        for (i = 0; i < skin.triangle_count; i++) {
            const uint32_t *v = skin.triangles + 3 * i;
            int m = meets(o, d, x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], &t);
            unsure |= m == 0;
            if (m == 1 && t < nearest) {
                nearest = t;
                best = i;
            }
        }
        ck_assert_int_eq(gx_body_pick(body, o, d, &hit, NULL), GX_OK);
        if (unsure) continue;
        CHECK_SEED((hit.triangle == UINT32_MAX) == !(nearest < HUGE_VAL), seed);
        if (hit.triangle == UINT32_MAX) continue;
        hits++;
        CHECK_SEED(fabs(hit.distance - nearest) <= 1e-9 * (1 + nearest), seed);
        CHECK_SEED(hit.triangle == best || fabs(hit.distance - nearest) < 1e-12, seed);
        CHECK_SEED(hit.fragment == skin.triangle_fragment[hit.triangle] &&
                       hit.element == skin.triangle_element[hit.triangle] &&
                       hit.surface == skin.triangle_surface[hit.triangle],
                   seed);
        for (k = 0; k < 3; k++) { /* on the ray, and where copies and weights say */
            double y = 0, material = 0;
            int n;
            for (n = 0; n < (int)hit.copy_count; n++) {
                const double rest = w.positions[3 * view_of(body).copy_node[hit.copies[n]] + (uint32_t)k];
                material += hit.weights[n] * rest;
                y += hit.weights[n] * (rest + view_of(body).displacement[3 * hit.copies[n] + (uint32_t)k]);
            }
            CHECK_SEED(fabs(hit.position[k] - (o[k] + hit.distance * d[k])) < 1e-9, seed);
            CHECK_SEED(fabs(hit.position[k] - y) < 1e-9 && fabs(hit.material[k] - material) < 1e-9, seed);
        }
    }
    CHECK_SEED(hits > 0 || skin.triangle_count == 0, seed);
    free(x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Rays at nodes and middles of edges from outside meet the surface: none slips through between triangles. */
START_TEST(no_ray_slips_through) {
    workload w = grid(3, 3, 3, 5);
    gx_body *body = body_of(&w);
    gx_skin skin = skin_of(body, NULL);
    double *x;
    size_t i;
    int k;
    random_seed((uint64_t)_i);
    move_at_random(body, 0.1);
    x = positions_of(body, &skin);
    for (i = 0; i < 3 * skin.triangle_count; i++) {
        const double *a = x + 3 * skin.triangles[i], *b = x + 3 * skin.triangles[i - i % 3 + (i + 1) % 3];
        const double s = i % 2 ? 0.5 : 0;
        double o[3], d[3];
        gx_hit hit;
        /* from the middle: every ray leaves the body */
        for (k = 0; k < 3; k++) {
            o[k] = 1.5;
            d[k] = a[k] + s * (b[k] - a[k]) - o[k];
        }
        ck_assert_int_eq(gx_body_pick(body, o, d, &hit, NULL), GX_OK);
        ck_assert_uint_ne(hit.triangle, UINT32_MAX);
        ck_assert_double_eq_tol(hit.distance, 1, 1e-9);
    }
    free(x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- errors ---- */

/* The skin of a body of which nothing is left has no vertices. */
START_TEST(nothing_is_left_to_draw) {
    static const double low[3] = {-1, -1, -1}, high[3] = {2, 2, 2};
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    float x = 7, n = 7;
    gx_skin skin;
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    cut_by(body, &w, 0, 1);
    skin = skin_of(body, NULL);
    ck_assert(skin.vertex_count == 0 && skin.triangle_count == 0);
    ck_assert_int_eq(gx_body_skin_vertices(body, NULL, &x, &n, NULL), GX_OK);
    ck_assert(x == 7 && n == 7);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(errors) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_skin_desc desc;
    gx_skin skin;
    gx_hit hit;
    double x[3 * 64], o[3] = {0, 0, 0}, d[3] = {0, 0, 1}, zero[3] = {0, 0, 0};
    float y[3 * 64];
    gx_surface bad;
    gx_cut_desc cut;
    memset(&desc, 0, sizeof desc);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_ERROR_SEQUENCE); /* there is none yet */
    ck_assert_int_eq(gx_body_skin_vertices(body, NULL, y, NULL, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gx_body_pick(body, o, d, &hit, NULL), GX_ERROR_SEQUENCE);
    desc.crease_angle = -1;
    ck_assert_int_eq(gx_body_skin(body, &desc, &skin, NULL), GX_ERROR_ARGUMENT);
    desc.crease_angle = NAN;
    ck_assert_int_eq(gx_body_skin(body, &desc, &skin, NULL), GX_ERROR_NOT_FINITE);
    skin_of(body, NULL);
    ck_assert_int_eq(gx_body_skin_positions(NULL, x, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_skin_positions(body, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_skin_vertices(NULL, NULL, y, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_skin_vertices(body, NULL, NULL, y, NULL), GX_OK);
    ck_assert_int_eq(gx_body_pick(body, o, zero, &hit, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_pick(body, NULL, d, &hit, NULL), GX_ERROR_ARGUMENT);
    d[1] = INFINITY;
    ck_assert_int_eq(gx_body_pick(body, o, d, &hit, NULL), GX_ERROR_NOT_FINITE);
    d[1] = 0;
    o[0] = 5;
    ck_assert_int_eq(gx_body_pick(body, o, d, &hit, NULL), GX_OK);
    ck_assert_uint_eq(hit.triangle, UINT32_MAX);
    add_axis_plane(&w, 0, 0.5);
    bad = surface_of(&w.surfaces[0]);
    /* not closed: found in the middle of the cut */
    bad.kind = GX_SURFACE_SOLID;
    memset(&cut, 0, sizeof cut);
    cut.surfaces = &bad;
    cut.surface_count = 1;
    ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_ERROR_NOT_CLOSED);
    /* a failed cut leaves the skin as it was */
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    cut_by(body, &w, 0, 1);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gx_body_pick(body, o, d, &hit, NULL), GX_ERROR_SEQUENCE);
    skin_of(body, NULL);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("skin");
    TCase *tests = tcase_create("skin");
    const char *only = getenv("GXFEM_SEED");
    int first = only ? atoi(only) : 0, last = only ? first + 1 : SEEDS;
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, follows_cuts, first, last);
    tcase_add_loop_test(tests, follows_restores, first, last);
    tcase_add_test(tests, follows_cuts_at_a_pinch);
    tcase_add_test(tests, changes_are_local);
    tcase_add_test(tests, partial_cuts_show_nothing);
    tcase_add_loop_test(tests, flat_normals, 0, 2);
    tcase_add_loop_test(tests, normals_at_any_size, 0, 4);
    tcase_add_test(tests, smooth_normals);
    tcase_add_test(tests, smooth_cuts);
    tcase_add_test(tests, corners_within_an_element);
    tcase_add_test(tests, severed_walls_are_flat);
    tcase_add_loop_test(tests, texture, first, last);
    tcase_add_test(tests, texture_of_flat_triangles);
    tcase_add_loop_test(tests, picks_what_a_ray_meets, first, last);
    tcase_add_loop_test(tests, no_ray_slips_through, 0, 3);
    tcase_add_test(tests, nothing_is_left_to_draw);
    tcase_add_test(tests, errors);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
