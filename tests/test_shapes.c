/* test_shapes.c - bodies of closed surfaces: all that these wind around, carved out of a grid. Volumes and moments are
   compared with the surfaces' own, by exact sums over their triangles; cells, copies and fragments with the oracle;
   cut pieces with Booleans of the surfaces. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include "pieces.h"

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
    case 3: add_plate(s, 5, 5, 0.2); break;
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

/* The whole skin is the first surface. */
static void expect_one_surface(gx_body *body) {
    gx_skin skin;
    size_t t;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    for (t = 0; t < skin.triangle_count; t++) ck_assert_uint_eq(skin.triangle_surface[t], 1);
}

START_TEST(volumes_and_skins) {
    static const uint32_t cells[3] = {1, 5, 9};
    workload w = some_shape(_i / 3);
    char what[40];
    gx_body *body;
    gx_view view;
    snprintf(what, sizeof what, "shape %d, %u cells", _i / 3, cells[_i % 3]);
    body = shaped(&w, cells[_i % 3]);
    view = view_of(body);
    expect_moments(&w, &view, 1000, what);
    if (_i / 3 != 9 && _i / 3 != 2) { /* faces that vanish have no skin; far out coordinates have fewer digits */
        const double area = area_of(&w.surfaces[0]), own = area_of_skin(body);
        expect_one_surface(body);
        ck_assert_msg(fabs(own - area) <= 1e-12 * area, "%s: skin %.17g, should be %.17g", what, own, area);
    }
    ck_assert_uint_eq(elements_without_cells(&view), 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- the grid and the oracle ---- */

/* The mesh of a body of a shape, and the surfaces as solids that keep */
static workload grid_of(const workload *shape, const gx_view *view) {
    workload w = wl_empty();
    size_t i, k;
    for (i = 0; i < view->node_count; i++)
        wl_add_node(&w, view->positions[3 * i], view->positions[3 * i + 1], view->positions[3 * i + 2]);
    w.elements = (uint32_t *)oracle_memory(NULL, 4 * view->element_count, sizeof *w.elements);
    memcpy(w.elements, view->elements, 4 * view->element_count * sizeof *w.elements);
    w.element_count = view->element_count;
    for (i = 0; i < shape->surface_count; i++) {
        wl_surface *s = wl_add_surface(&w, 2);
        for (k = 0; k < shape->surfaces[i].vertex_count; k++) wl_add_vertex(s, shape->surfaces[i].vertices + 3 * k);
        for (k = 0; k < shape->surfaces[i].triangle_count; k++)
            wl_add_triangle(s, shape->surfaces[i].triangles[3 * k], shape->surfaces[i].triangles[3 * k + 1],
                            shape->surfaces[i].triangles[3 * k + 2]);
    }
    return w;
}

START_TEST(the_grid_cut_by_hand) {
    workload w = some_shape(_i), g;
    gx_body *body = shaped(&w, 6), *other;
    const gx_view view = view_of(body);
    ck_assert(view.fragment_count > 0 && view.fragment_id[0] == 1 && view.removed_count == 0);
    ck_assert_uint_eq(view.fragment_change[0], GX_FRAGMENT_UNCHANGED);
    g = grid_of(&w, &view);
    other = cut_at_once(&g);
    expect_same(body, other, 1, 1e-12, 1e-16, "the grid, cut", (uint64_t)_i);
    gx_body_destroy(body);
    gx_body_destroy(other);
    wl_free(&w);
    wl_free(&g);
}
END_TEST

static const char *of_seed(const char *what, uint64_t seed) {
    static char text[64];
    snprintf(text, sizeof text, "seed %llu, %s", (unsigned long long)seed, what);
    return text;
}

/* Cells, copies and fragments as the oracle has them */
static void expect_truth(gx_body *body, const workload *g, uint64_t seed) {
    oracle *truth = wl_oracle(g);
    const gx_view view = view_of(body);
    double *own = (double *)oracle_memory(NULL, view.cell_count + view.fragment_count, sizeof *own);
    double *exact = (double *)oracle_memory(NULL, truth->cell_count + truth->fragment_count, sizeof *exact);
    size_t e, i, j, n;
    CHECK_SEED(view.cell_count == truth->cell_count, seed);
    CHECK_SEED(view.copy_count == truth->copy_count, seed);
    CHECK_SEED(view.fragment_count == truth->fragment_count, seed);
    for (e = 0; e < g->element_count; e++) {
        for (i = j = 0; i < view.cell_count; i++)
            if (view.cell_element[i] == e) own[j++] = view.cell_volume[i];
        for (i = n = 0; i < truth->cell_count; i++)
            if (truth->cell_element[i] == e) exact[n++] = truth->cell_volume[i];
        CHECK_SEED(j == n && j > 0, seed);
        expect_same_volumes(own, exact, n, view.volume, of_seed("cells", seed));
    }
    for (e = 0; e < g->node_count; e++) {
        for (i = j = 0; i < view.copy_count; i++) j += view.copy_node[i] == e;
        CHECK_SEED(j == truth->node_copies[e], seed);
    }
    memcpy(own, view.fragment_volume, view.fragment_count * sizeof *own);
    memcpy(exact, truth->fragment_volume, view.fragment_count * sizeof *exact);
    expect_same_volumes(own, exact, view.fragment_count, view.volume, of_seed("fragments", seed));
    free(own);
    free(exact);
    oracle_destroy(truth);
}

/* Tetrahedra and boxes, at random or with corners on a lattice, of which some cross, touch or nest */
static workload random_shape(void) {
    workload w = wl_empty();
    wl_surface *s = wl_add_surface(&w, 1);
    int parts = 1 + random_below(2), k, n;
    const int special = random_below(2);
    while (parts-- > 0) {
        double x[4][3];
        const uint32_t first = (uint32_t)s->vertex_count;
        for (n = 0; n < 4; n++)
            for (k = 0; k < 3; k++) x[n][k] = special ? random_below(4) : random_real(0, 3);
        if (random_below(2)) {
            for (k = 0; k < 3; k++) x[1][k] = x[0][k] + (special ? 1 + random_below(2) : random_real(0.1, 2));
            wl_add_aligned_box(s, x[0], x[1]);
            continue;
        }
        if (gxb_orient3d(x[0], x[1], x[2], x[3]) == 0) {
            parts++;
            continue;
        }
        n = gxb_orient3d(x[0], x[1], x[2], x[3]) > 0;
        for (k = 0; k < 4; k++) wl_add_vertex(s, x[k]);
        for (k = 0; k < 4; k++) {
            const uint8_t *out = gxp_outward[k];
            wl_add_triangle(s, first + out[0], first + out[n ? 1 : 2], first + out[n ? 2 : 1]);
        }
    }
    return w;
}

START_TEST(as_the_oracle_has_it) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w, g;
    gx_body *body;
    gx_view view;
    random_seed(seed);
    w = random_shape();
    body = shaped(&w, 1 + (uint32_t)random_below(2));
    view = view_of(body);
    g = grid_of(&w, &view);
    expect_truth(body, &g, seed);
    gx_body_destroy(body);
    wl_free(&w);
    wl_free(&g);
}
END_TEST

/* ---- cuts, beside Booleans of the surfaces ---- */

/* Several surfaces: their union, whatever the way in which each is turned */
START_TEST(surfaces_that_overlap) {
    static const double a[3] = {0, 0, 0}, b[3] = {0.7, 0.2, -0.1}, c[3] = {5, 0, 0}, d[3] = {0.1, 0.1, 0.1};
    workload w = wl_empty();
    gx_body *body;
    add_blob(wl_add_surface(&w, 1), a, 1, 2, 0.1, 9, _i & 1);
    add_blob(wl_add_surface(&w, 1), b, 0.8, 3, 0.2, 8, _i >> 1 & 1);
    add_blob(wl_add_surface(&w, 1), c, 0.4, 0, 0, 5, 0);
    add_blob(wl_add_surface(&w, 1), d, 0.2, 0, 0, 4, _i >> 2 & 1); /* inside of the first: changes nothing */
    body = shaped(&w, 14);
    expect_pieces(body, &w, NULL, of_seed("pieces", (uint64_t)_i));
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static gx_surface plane_at(workload *w, double reach) {
    double p[3], n[3];
    int k;
    for (k = 0; k < 3; k++) {
        p[k] = random_real(-reach, reach);
        n[k] = random_real(-1, 1);
    }
    add_plane(w, p, n, 9);
    return surface_of(&w->surfaces[w->surface_count - 1]);
}

static gx_result cut_surface(gx_body *body, const gx_surface *surface) {
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surface;
    desc.surface_count = 1;
    return gx_body_cut(body, &desc, NULL, NULL);
}

static void some_steps(gx_body *body, int count) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    while (count-- > 0) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
}

static gx_body *loaded(gx_body *body) {
    gx_body *other = NULL;
    size_t size = 0;
    void *bytes;
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = oracle_memory(NULL, size, 1);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &other, NULL), GX_OK);
    free(bytes);
    return other;
}

/* Do the boxes of a triangle and of an element meet? */
static int boxes_meet(const wl_surface *s, size_t triangle, const gx_view *view, size_t element) {
    int i, k, beyond = 0;
    for (k = 0; k < 3; k++) {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (i = 0; i < 3; i++) {
            const double x = s->vertices[3 * s->triangles[3 * triangle + (size_t)i] + (size_t)k];
            low[0] = fmin(low[0], x);
            high[0] = fmax(high[0], x);
        }
        for (i = 0; i < 4; i++) {
            const double x = view->positions[3 * view->elements[4 * element + (size_t)i] + (size_t)k];
            low[1] = fmin(low[1], x);
            high[1] = fmax(high[1], x);
        }
        beyond |= low[0] > high[1] || low[1] > high[0];
    }
    return !beyond;
}

/* Are the cells of an element the same in two bodies, with their mass matrices, to the last bit? */
static int same_cells(const gx_body *a, const gx_body *b, uint32_t element) {
    uint32_t i = element, j = element;
    while (i != UINT32_MAX && j != UINT32_MAX) {
        const gxp_cell *p = &a->cells.data[i], *q = &b->cells.data[j];
        if (p->kept != q->kept || (p->kept && memcmp(p->mass, q->mass, sizeof p->mass) != 0)) return 0;
        i = p->next;
        j = q->next;
    }
    return i == j;
}

/* A vertex of the model is moved: cells in elements that its triangles do not come near stay as they were. Those that
   may have an edge in common with one near them are left out: planes of the triangles go on to that edge and divide it,
   so that sums have other terms. */
START_TEST(edited_elsewhere) {
    enum { MOVED = 700, CELLS = 14 };
    workload w = some_shape(1);
    wl_surface *s = &w.surfaces[0];
    gx_body *before, *after;
    gx_view was, is;
    size_t e, t, same = 0, other = 0;
    uint8_t *near, *node;
    int i, time;
    before = shaped(&w, CELLS);
    was = view_of(before);
    near = (uint8_t *)oracle_memory(NULL, was.element_count, 1);
    memset(near, 0, was.element_count);
    node = (uint8_t *)oracle_memory(NULL, was.node_count, 1);
    memset(node, 0, was.node_count);
    for (time = 0; time < 2; time++) {
        for (t = 0; t < s->triangle_count; t++) {
            const uint32_t *v = s->triangles + 3 * t;
            if (v[0] != MOVED && v[1] != MOVED && v[2] != MOVED) continue;
            for (e = 0; e < was.element_count; e++) near[e] |= (uint8_t)boxes_meet(s, t, &was, e);
        }
        for (i = 0; i < 3 && time == 0; i++) s->vertices[3 * MOVED + i] *= 0.97;
    }
    for (e = 0; e < 4 * was.element_count; e++) node[was.elements[e]] |= near[e / 4];
    after = shaped(&w, CELLS);
    is = view_of(after);
    ck_assert_uint_eq(was.element_count, is.element_count);
    ck_assert_mem_eq(was.elements, is.elements, 4 * was.element_count * sizeof *was.elements);
    ck_assert_mem_eq(was.positions, is.positions, 3 * was.node_count * sizeof *was.positions);
    for (e = 0; e < was.element_count; e++) {
        const uint32_t *of = was.elements + 4 * e;
        if (node[of[0]] + node[of[1]] + node[of[2]] + node[of[3]] >= 2)
            other += !same_cells(before, after, (uint32_t)e);
        else {
            ck_assert_msg(same_cells(before, after, (uint32_t)e), "element %zu", e);
            same++;
        }
    }
    ck_assert(other > 0 && same > was.element_count - 200);
    expect_moments(&w, &is, 1000, "edited");
    free(near);
    free(node);
    gx_body_destroy(before);
    gx_body_destroy(after);
    wl_free(&w);
}
END_TEST

/* Cut at rest and in motion, saved, loaded and cloned on the way: all take the same steps and cuts. */
START_TEST(cut_saved_and_cloned) {
    static const int kinds[4] = {1, 3, 7, 0};
    const uint64_t seed = (uint64_t)_i + 1;
    workload w = some_shape(kinds[_i % 4]), planes = wl_empty();
    gx_body *body = shaped(&w, 9), *copies[2];
    gx_surface plane;
    int k;
    random_seed(seed);
    plane = plane_at(&planes, 0.3);
    ck_assert_int_eq(cut_surface(body, &plane), GX_OK);
    expect_pieces(body, &w, &plane, of_seed("pieces", seed));
    some_steps(body, 2);
    copies[0] = loaded(body);
    ck_assert_int_eq(gx_body_clone(body, &copies[1], NULL), GX_OK);
    plane = plane_at(&planes, 0.2);
    for (k = -1; k < 2; k++) {
        gx_body *one = k < 0 ? body : copies[k];
        some_steps(one, 2);
        ck_assert_int_eq(cut_surface(one, &plane), GX_OK);
        ck_assert(fabs(view_of(one).volume - moments_of(&w, plane.vertices).volume) <= 1e-12 * view_of(one).volume);
    }
    for (k = 0; k < 2; k++) {
        CHECK_SEED(gx_body_state_hash(copies[k]) == gx_body_state_hash(body), seed);
        CHECK_SEED(hash_of(copies[k]) == hash_of(body), seed);
        gx_body_destroy(copies[k]);
    }
    gx_body_destroy(body);
    wl_free(&w);
    wl_free(&planes);
}
END_TEST

/* A blade goes through the middle of a ball that falls: two halves. A drill takes a core out of what is left. */
START_TEST(blade_and_drill) {
    workload w = some_shape(0), tool = wl_empty();
    gx_body *body = shaped(&w, 7);
    const double volume = view_of(body).volume;
    gx_blade *blade = NULL;
    gx_surface drill;
    gx_cut_report report;
    double edge[6] = {0.013, -2, -3, 0.017, 2, -3};
    int i;
    ck_assert_int_eq(gx_blade_create(body, NULL, &blade, NULL), GX_OK);
    for (i = 0; i < 26; i++, edge[2] += 0.25, edge[5] += 0.25) {
        ck_assert_int_eq(gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL), GX_OK);
        if (i % 8 == 0) some_steps(body, 1);
    }
    ck_assert_int_eq(gx_blade_lift(blade, NULL, NULL), GX_OK);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert(fabs(view_of(body).fragment_volume[0] - volume / 2) < 0.05 * volume);
    ck_assert(fabs(view_of(body).volume - volume) <= 1e-12 * volume);
    add_box(&tool, 1, -0.2, -0.2, -9, 0.2, 0.2, 9);
    drill = surface_of(&tool.surfaces[0]);
    ck_assert_int_eq(gx_body_carve(body, &drill, &report, NULL), GX_OK);
    ck_assert(report.removed_volume > 0.1 && report.removed_volume < 0.4);
    ck_assert(fabs(view_of(body).volume + report.removed_volume - volume) <= 1e-12 * volume);
    some_steps(body, 2);
    gx_body_destroy(body);
    wl_free(&w);
    wl_free(&tool);
}
END_TEST

/* Slivers at the rim and thin ears follow: a body that hangs by its upper part stays within a fraction of its size. */
START_TEST(slivers_stay) {
    workload w = some_shape(_i == 0 ? 5 : _i == 1 ? 1 : 3);
    gx_body *body = shaped(&w, 6);
    const gx_region top = gx_region_half_space(2, 1, _i == 2 ? 0.15 : 0.3);
    gx_view view;
    size_t i;
    ck_assert_int_eq(gx_body_hold(body, &top, 1, NULL), GX_OK);
    some_steps(body, 40);
    view = view_of(body);
    for (i = 0; i < 3 * view.copy_count; i++) ck_assert(fabs(view.displacement[i]) < 0.7);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A plate thinner than its elements, held along one side: with affine copies it bends, without it hardly does. Its
   volume is the same. */
START_TEST(thin_shapes_bend) {
    workload w = wl_empty();
    gx_surface surfaces[WL_SURFACES];
    gx_shape shape;
    gx_body_desc desc;
    const gx_region side = gx_region_half_space(0, -1, 0.3);
    gx_step_desc rest;
    double sag[2];
    int k;
    memset(&rest, 0, sizeof rest);
    rest.integrator = GXS_STATIC;
    rest.gravity[2] = -9.81;
    rest.newton_iterations = 50;
    rest.cg_iterations = 5000;
    add_bar(wl_add_surface(&w, 1), 0, 0, 0.031, 2, 0.8, 0.081);
    shape = shape_of(surfaces, &w);
    shape.cells = 8;
    desc = desc_of_shape(&shape);
    desc.young = 5e8;
    for (k = 0; k < 2; k++) {
        gx_body *body = NULL;
        gx_view view;
        size_t i;
        desc.affine_below = k ? 0.5 : 0;
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        ck_assert_int_eq(gx_body_hold(body, &side, 1, NULL), GX_OK);
        ck_assert_int_eq(gx_body_step(body, &rest, NULL, NULL), GX_OK);
        view = view_of(body);
        ck_assert(fabs(view.volume - 0.08) < 1e-13);
        ck_assert((view.copy_affine != NULL) == (k == 1));
        for (i = 0, sag[k] = 0; i < view.copy_count; i++) sag[k] = fmin(sag[k], view.displacement[3 * i + 2]);
        gx_body_destroy(body);
    }
    ck_assert_msg(sag[0] < 0 && sag[1] < 1.5 * sag[0], "sags by %g and by %g", sag[0], sag[1]);
    wl_free(&w);
}
END_TEST

/* ---- resolution, refusals, memory ---- */

START_TEST(budgets_and_edges) {
    workload w = some_shape(1);
    gx_surface surfaces[WL_SURFACES];
    gx_shape shape = shape_of(surfaces, &w);
    gx_body_desc desc = desc_of_shape(&shape);
    size_t nodes[12], budget;
    gx_body *body = NULL;
    uint32_t c;
    for (c = 1; c < 12; c++) {
        body = shaped(&w, c);
        nodes[c] = view_of(body).node_count;
        gx_body_destroy(body);
        if (c > 1) ck_assert_uint_gt(nodes[c], nodes[c - 1]);
    }
    for (budget = 3 * nodes[1]; budget < 3 * nodes[11]; budget = 3 * budget + 1) {
        shape.unknowns = budget;
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        for (c = 1; c < 11 && 3 * nodes[c + 1] <= budget; c++) {}
        ck_assert_uint_eq(view_of(body).node_count, nodes[c]);
        gx_body_destroy(body);
    }
    shape.unknowns = 3 * nodes[1] - 1;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_ERROR_LIMIT);
    shape.unknowns = 0;
    shape.edge = 0.25;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    for (c = 0; c < 6; c++) { /* edges of the first element: two of the cube's, four from corners to middles */
        const gx_view view = view_of(body);
        const double *a = view.positions + 3 * view.elements[gxp_edge_nodes[c][0]];
        const double *b = view.positions + 3 * view.elements[gxp_edge_nodes[c][1]];
        const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]}, length = sqrt(gxp_dot(d, d));
        ck_assert(length == 0.25 || fabs(length - 0.25 * sqrt(0.75)) < 1e-15);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(refused_shapes) {
    workload w = some_shape(4);
    gx_surface surfaces[WL_SURFACES];
    gx_shape shape = shape_of(surfaces, &w), good;
    gx_body_desc desc = desc_of_shape(&shape);
    gx_surface *s = &surfaces[1];
    gx_body *body = NULL;
    gx_failure failure;
    double x[24];
    uint32_t t[36], one = 0;
    float texture[16] = {0};
    surfaces[1] = surfaces[0];
    memcpy(x, surfaces[0].vertices, sizeof x);
    memcpy(t, surfaces[0].triangles, sizeof t);
    s->vertices = x;
    s->triangles = t;
    s->texture = texture;
    shape.surface_count = 2;
    shape.cells = 4;
    good = shape;
#define REFUSED_SHAPE(change, expected, name, at, of)                                                                  \
    shape = good;                                                                                                      \
    change;                                                                                                            \
    ck_assert_int_eq(gx_body_create(&desc, &body, &failure), expected);                                                \
    ck_assert_int_eq(failure.result, expected);                                                                        \
    ck_assert_str_eq(failure.field, name);                                                                             \
    ck_assert(failure.index == (at) && failure.surface == (of) && body == NULL)
    REFUSED_SHAPE(shape.surfaces = NULL, GX_ERROR_ARGUMENT, "shape.surfaces", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.surface_count = 0, GX_ERROR_EMPTY, "shape.surface_count", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.cells = 0, GX_ERROR_ARGUMENT, "shape.cells", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.edge = 0.1, GX_ERROR_ARGUMENT, "shape.cells", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.unknowns = 9, GX_ERROR_ARGUMENT, "shape.cells", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.edge = -1, GX_ERROR_ARGUMENT, "shape.edge", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.edge = NAN, GX_ERROR_NOT_FINITE, "shape.edge", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.cells = 0; shape.unknowns = 20, GX_ERROR_LIMIT, "shape.unknowns", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.cells = 4000000, GX_ERROR_LIMIT, "shape", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(shape.cells = 0; shape.edge = 1e-9, GX_ERROR_LIMIT, "shape", SIZE_MAX, SIZE_MAX);
    REFUSED_SHAPE(s->vertex_count = 0, GX_ERROR_EMPTY, "shape.surfaces.vertex_count", SIZE_MAX, 1);
    s->vertex_count = 8;
    REFUSED_SHAPE(s->triangle_count = 0, GX_ERROR_EMPTY, "shape.surfaces.triangle_count", SIZE_MAX, 1);
    s->triangle_count = 12;
    REFUSED_SHAPE(s->vertices = NULL, GX_ERROR_ARGUMENT, "shape.surfaces.vertices", SIZE_MAX, 1);
    s->vertices = x;
    REFUSED_SHAPE(s->triangles = NULL, GX_ERROR_ARGUMENT, "shape.surfaces.triangles", SIZE_MAX, 1);
    s->triangles = t;
    REFUSED_SHAPE(t[7] = 8, GX_ERROR_INDEX, "shape.surfaces.triangles", 2, 1);
    t[7] = surfaces[0].triangles[7];
    REFUSED_SHAPE(x[4] = NAN, GX_ERROR_NOT_FINITE, "shape.surfaces.vertices", 1, 1);
    REFUSED_SHAPE(x[4] = 1e40, GX_ERROR_RANGE, "shape.surfaces.vertices", 1, 1);
    REFUSED_SHAPE(x[4] = 1e-70, GX_ERROR_RANGE, "shape.surfaces.vertices", 1, 1);
    x[4] = surfaces[0].vertices[4];
    REFUSED_SHAPE(texture[5] = INFINITY, GX_ERROR_NOT_FINITE, "shape.surfaces.texture", 2, 1);
    texture[5] = 0;
    REFUSED_SHAPE(s->triangle_count = 11, GX_ERROR_NOT_CLOSED, "shape.surfaces.triangles", failure.index, 1);
    ck_assert_uint_lt(failure.index, 11);
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_ERROR_NOT_CLOSED);
    s->triangle_count = 12;
    surfaces[0].vertex_count = 0;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_ERROR_EMPTY);
    REFUSED_SHAPE(s->triangle_count = 12, GX_ERROR_EMPTY, "shape.surfaces.vertex_count", SIZE_MAX, 0);
    surfaces[0].vertex_count = 8;
    REFUSED_SHAPE(desc.positions = x, GX_ERROR_ARGUMENT, "positions", SIZE_MAX, SIZE_MAX);
    desc.positions = NULL;
    REFUSED_SHAPE(desc.node_count = 1, GX_ERROR_ARGUMENT, "positions", SIZE_MAX, SIZE_MAX);
    desc.node_count = 0;
    REFUSED_SHAPE(desc.element_count = 1, GX_ERROR_ARGUMENT, "elements", SIZE_MAX, SIZE_MAX);
    desc.element_count = 0;
    REFUSED_SHAPE(desc.elements = t, GX_ERROR_ARGUMENT, "elements", SIZE_MAX, SIZE_MAX);
    desc.elements = NULL;
    REFUSED_SHAPE(desc.element_materials = &one, GX_ERROR_ARGUMENT, "element_materials", SIZE_MAX, SIZE_MAX);
    desc.element_materials = NULL;
    REFUSED_SHAPE(desc.texture = texture, GX_ERROR_ARGUMENT, "texture", SIZE_MAX, SIZE_MAX);
    desc.texture = NULL;
    shape.surface_count = 1; /* a surface without volume */
    shape.surfaces = s;
    memset(x, 0, sizeof x);
    for (one = 0; one < 8; one++) x[3 * one] = one;
    ck_assert_int_eq(gx_body_create(&desc, &body, &failure), GX_ERROR_EMPTY);
    ck_assert_str_eq(failure.field, "shape.surfaces");
    for (one = 0; one < 24; one++) x[one] = 1e9 + surfaces[0].vertices[one] * 1e-4; /* far out, the grid too fine */
    shape.cells = 3;
    ck_assert_int_eq(gx_body_create(&desc, &body, &failure), GX_ERROR_RANGE);
    ck_assert_str_eq(failure.field, "shape");
    for (one = 0; one < 24; one++) x[one] -= 1e9 - 1e6;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Whenever memory runs out, nothing is left behind. */
START_TEST(memory_runs_out) {
    workload w = some_shape(_i == 0 ? 4 : 8);
    gx_surface surfaces[WL_SURFACES];
    gx_shape shape = shape_of(surfaces, &w);
    gx_body_desc desc = desc_of_shape(&shape);
    size_t n;
    shape.cells = _i == 0 ? 2 : 0;
    shape.unknowns = _i == 0 ? 0 : 300;
    for (n = 0;; n += n < 40 ? 1 : 2 * FEWER + 1) { /* the first are those of the grid */
        memory m = plenty();
        gx_failure failure;
        gx_body *body = NULL;
        gx_result result;
        desc.allocator = allocator_of(&m);
        fail_from(&m, n, (int)(n & 1));
        result = gx_body_create(&desc, &body, &failure);
        ck_assert_int_eq(failure.result, result);
        ck_assert_int_eq(result, m.failed ? result : GX_OK);
        if (result == GX_OK)
            gx_body_destroy(body);
        else
            ck_assert(result == GX_ERROR_MEMORY && body == NULL);
        ck_assert(m.blocks == NULL && !m.wrong && !m.overrun);
        if (!m.failed) break;
    }
    wl_free(&w);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("shapes");
    TCase *tests = tcase_create("shapes");
    tcase_set_timeout(tests, 300);
    ADD_SOME(tests, volumes_and_skins, 3 * SHAPES);
    ADD_SOME(tests, the_grid_cut_by_hand, SHAPES);
    ADD_SOME(tests, as_the_oracle_has_it, 40);
    ADD_SOME(tests, surfaces_that_overlap, 8);
    ADD_SOME(tests, cut_saved_and_cloned, 8);
    tcase_add_test(tests, edited_elsewhere);
    tcase_add_test(tests, blade_and_drill);
    tcase_add_loop_test(tests, slivers_stay, 0, 3);
    tcase_add_test(tests, thin_shapes_bend);
    tcase_add_test(tests, budgets_and_edges);
    tcase_add_test(tests, refused_shapes);
    tcase_add_loop_test(tests, memory_runs_out, 0, 2);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) {
    const int result = run_suite(suite());
    rat_arena_free();
    return result;
}
