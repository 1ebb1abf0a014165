/* test_oracle.c - the library against the exact oracle: cells of every element with their volumes, copies of every
   node, fragments, over random and degenerate cuts of small meshes; and the same answer in any order, at any scale.

   GXFEM_SEED=n runs scene n alone. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../bench/splitmix.h"
#include "workloads.h"
#include "runner.h"

enum { SCENES = 1600 / FEWER, PARTS = 10 };

/* ---- random numbers: splitmix64 ---- */
static uint64_t random_state;

static uint64_t random_bits(void) { return splitmix64(&random_state); }
static int random_below(int n) { return (int)(random_bits() % (uint64_t)n); }
static double random_real(double low, double high) {
    return low + (high - low) * ldexp((double)(random_bits() >> 11), -53);
}

/* ---- meshes ---- */

static void jitter(workload *w, double size, int dyadic) {
    size_t i;
    for (i = 0; i < 3 * w->node_count; i++)
        w->positions[i] +=
            dyadic ? ldexp(random_below(2 * (int)(size * 64) + 1) - (int)(size * 64), -6) : random_real(-size, size);
}

/* Two tets that share an edge (shared = 2) or a node (1); sometimes a third on a face of the first */
static workload non_manifold(int shared) {
    workload w = wl_empty();
    wl_add_node(&w, 0, 0, 0);
    wl_add_node(&w, 0, 0, 1);
    wl_add_node(&w, 1, 0, 0);
    wl_add_node(&w, 0, 1, 0);
    wl_add_node(&w, -1, 0, 0);
    wl_add_node(&w, 0, -1, 0);
    wl_add_element(&w, 0, 1, 2, 3);
    if (shared == 2)
        wl_add_element(&w, 0, 1, 4, 5);
    else
        wl_add_element(&w, 0, 4, 5, wl_add_node(&w, 0, 0, -1));
    if (random_below(2)) wl_add_element(&w, 1, 2, 3, wl_add_node(&w, 1, 1, 1));
    return w;
}

static int random_mesh(workload *w) {
    wl_frame axes = wl_axes();
    int kind = random_below(9);
    double size = 0.2;
    switch (kind) {
    case 0: *w = wl_tetrahedron(wl_corner_tetrahedron); break;
    case 1:
    case 2: *w = wl_grid(1, 1, 1, 5, &axes); break;
    case 3: *w = wl_grid(2, 1, 1, 5, &axes); break;
    case 4: *w = wl_grid(2, 1, 1, 6, &axes); break;
    case 5: *w = wl_grid(2, 2, 1, random_below(2) ? 5 : 6, &axes); break;
    case 6: *w = wl_tetrahedron(wl_unit_tetrahedron); break;
    case 7: *w = non_manifold(2); break;
    default:
        *w = non_manifold(1);
        size = 0.15;
        break;
    }
    switch (random_below(4)) {
    case 0: jitter(w, size, 0); break;
    case 1: jitter(w, size, 1); break;
    default: break;
    }
    return kind;
}

/* ---- cuts ---- */

static const double *random_node(const workload *w) {
    return w->positions + 3 * (size_t)random_below((int)w->node_count);
}

static void random_point(const workload *w, double x[3]) {
    const double *a = random_node(w), *b = random_node(w);
    double t = random_real(-0.1, 1.1);
    int k;
    for (k = 0; k < 3; k++) x[k] = a[k] + t * (b[k] - a[k]) + random_real(-0.3, 0.3);
}

/* A point that makes trouble: a node, the middle of an edge, a point of a face or of an element, a lattice point, or
   any point */
static void special_point(const workload *w, double x[3]) {
    const uint32_t *n = w->elements + 4 * (size_t)random_below((int)w->element_count);
    const double *p = w->positions;
    int kind = random_below(7), k;
    for (k = 0; k < 3; k++) {
        double a = p[3 * n[0] + (uint32_t)k], b = p[3 * n[1] + (uint32_t)k], c = p[3 * n[2] + (uint32_t)k],
               d = p[3 * n[3] + (uint32_t)k];
        switch (kind) {
        case 0:
        case 1: x[k] = a; break;
        case 2: x[k] = (b + c) / 2; break;
        case 3: x[k] = (2 * a + c + d) / 4; break;
        case 4: x[k] = (a + b + c + d) / 4; break;
        case 5: x[k] = random_below(9) / 4.0 - 0.5; break;
        default: break;
        }
    }
    if (kind == 6) random_point(w, x);
}

/* A triangle through three points, blown up eight times about its middle: exact where coordinates are short */
static void add_plane(workload *w, double p[3][3]) {
    wl_surface *s = wl_add_surface(w, 0);
    int i, k;
    for (i = 0; i < 3; i++) {
        double x[3];
        for (k = 0; k < 3; k++) x[k] = 8 * p[i][k] - 4 * p[(i + 1) % 3][k] - 3 * p[(i + 2) % 3][k];
        wl_add_vertex(s, x);
    }
    wl_add_triangle(s, 0, 1, 2);
}

static void add_axis_plane(workload *w, int axis, double value, double step) {
    double x[4][3];
    int i;
    wl_surface *s = wl_add_surface(w, 0);
    for (i = 0; i < 4; i++) {
        x[i][axis] = value + (i % 2 ? step : 0);
        x[i][(axis + 1) % 3] = i == 1 || i == 2 ? 4 : -3;
        x[i][(axis + 2) % 3] = i >= 2 ? 4 : -3;
    }
    wl_add_quad(s, x[0], x[1], x[2], x[3]);
}

/* Planes at i / parts along one axis or two */
static void add_axis_planes(workload *w, int count) {
    int parts = random_below(2) ? 6 : 8, axes = 1 + random_below(2), axis = random_below(3), i;
    for (i = 0; i < count; i++)
        add_axis_plane(w, (axis + i % axes) % 3, (1 + random_below(2 * parts)) / (double)parts, 0);
}

/* A copy of an earlier surface, shifted by an ulp along an axis (or not at all) */
static void add_again(workload *w, int shifted) {
    size_t from = (size_t)random_below((int)w->surface_count), i;
    const wl_surface *old;
    wl_surface *s = wl_add_surface(w, w->surfaces[from].solid);
    size_t axis = (size_t)random_below(3);
    old = &w->surfaces[from];
    for (i = 0; i < old->vertex_count; i++) {
        double x[3];
        memcpy(x, old->vertices + 3 * i, sizeof x);
        if (shifted) x[axis] = x[axis] == 0 ? ldexp(1, -60) : nextafter(x[axis], 10.0);
        wl_add_vertex(s, x);
    }
    for (i = 0; i < old->triangle_count; i++)
        wl_add_triangle(s, old->triangles[3 * i], old->triangles[3 * i + 1], old->triangles[3 * i + 2]);
}

static void add_triangles(workload *w, int count, int special) {
    wl_surface *s = wl_add_surface(w, 0);
    int i, j;
    for (i = 0; i < count; i++) {
        uint32_t n[3];
        for (j = 0; j < 3; j++) {
            double x[3];
            if (special)
                special_point(w, x);
            else
                random_point(w, x);
            n[j] = wl_add_vertex(s, x);
        }
        wl_add_triangle(s, n[0], n[1], n[2]);
    }
}

/* Triangles around one edge (or, open, around one point) */
static void add_fan(workload *w, int count, int around_edge) {
    wl_surface *s = wl_add_surface(w, 0);
    double x[3];
    int i;
    uint32_t last;
    special_point(w, x);
    wl_add_vertex(s, x);
    special_point(w, x);
    last = wl_add_vertex(s, x);
    for (i = 0; i < count; i++) {
        special_point(w, x);
        wl_add_triangle(s, 0, last, wl_add_vertex(s, x));
        if (!around_edge) last = (uint32_t)s->vertex_count - 1;
    }
}

/* A convex polygon in an axis plane, or in the plane x + y + z = const, as a fan: coordinates are sixteenths, so it is
 * flat */
static void add_polygon(workload *w) {
    static const int around[8][2] = {{2, 0}, {2, 1}, {1, 2}, {0, 2}, {-2, 1}, {-2, -1}, {-1, -2}, {1, -2}};
    wl_surface *s = wl_add_surface(w, 0);
    int axis = random_below(3), oblique = random_below(2), count = 3 + random_below(6), size = 1 + random_below(8), i;
    int c0 = random_below(17), c1 = random_below(17), c2 = random_below(17);
    for (i = 0; i < count; i++) {
        const int *step = around[i * 8 / count];
        double x[3];
        x[(axis + 1) % 3] = (c0 + size * step[0]) / 16.0;
        x[(axis + 2) % 3] = (c1 + size * step[1]) / 16.0;
        x[axis] = (c2 - (oblique ? size * (step[0] + step[1]) : 0)) / 16.0;
        wl_add_vertex(s, x);
    }
    for (i = 2; i < count; i++) wl_add_triangle(s, 0, (uint32_t)i - 1, (uint32_t)i);
}

/* One box, or two that may overlap, of one surface; aligned with the lattice or not */
static void add_solid(workload *w, int boxes) {
    wl_surface *s = wl_add_surface(w, 1);
    while (boxes-- > 0) {
        double low[3], high[3];
        int k;
        for (k = 0; k < 3; k++) {
            int lattice = random_below(3);
            low[k] = lattice ? random_below(8) / 4.0 - 0.5 : random_real(-0.5, 1);
            high[k] = low[k] + (lattice ? (1 + random_below(6)) / 4.0 : random_real(0.01, 1));
        }
        wl_add_aligned_box(s, low, high);
    }
}

static void add_rotated_solid(workload *w) {
    wl_frame f = wl_rotated();
    int k;
    for (k = 0; k < 3; k++) f.origin[k] = random_real(0, 1);
    wl_add_box(wl_add_surface(w, 1), &f, random_real(0.05, 0.6), random_real(0.05, 0.6),
               ldexp(1, -1 - random_below(30)));
}

static void add_random_cut(workload *w) {
    double p[3][3];
    int i, special = random_below(2);
    switch (random_below(12)) {
    case 0:
    case 1:
        for (i = 0; i < 3; i++)
            if (special)
                special_point(w, p[i]);
            else
                random_point(w, p[i]);
        add_plane(w, p);
        break;
    case 2: add_axis_planes(w, 1 + random_below(4)); break;
    case 3:
        if (w->surface_count > 0) {
            add_again(w, special);
            break;
        } /* fall through */
    case 4: add_triangles(w, 1 + random_below(2), special); break;
    case 5: add_fan(w, 2 + random_below(2), special); break;
    case 6:
    case 7: add_polygon(w); break;
    case 8: add_solid(w, 1 + special); break;
    case 9: add_rotated_solid(w); break;
    case 10: add_axis_plane(w, random_below(3), random_below(5) / 4.0, special ? ldexp(1, -50) : 0.25); break;
    default:
        for (i = 0; i < 3; i++) memcpy(p[i], random_node(w), sizeof p[i]);
        add_plane(w, p);
        break;
    }
}

/* The first solids keep what is inside of them. */
static void keep_solids(workload *w, size_t most) {
    size_t i;
    for (i = 0; i < w->surface_count && most > 0; i++)
        if (w->surfaces[i].solid) {
            w->surfaces[i].solid = 2;
            most--;
        }
}

static workload random_scene(uint64_t seed) {
    workload w;
    int cuts;
    random_state = seed * UINT64_C(0x2545f4914f6cdd1d) + 1;
    cuts = 1 + random_below(3);
    random_mesh(&w);
    while (cuts-- > 0) add_random_cut(&w);
    if (seed % 3 == 2) keep_solids(&w, seed % 9 == 2 ? w.surface_count : 1);
    return w;
}

/* ---- the library's answer ---- */

typedef struct ordering { /* how the scene is given to the library */
    int at_once;          /* all cuts in one call, or one after another */
    size_t surface[WL_SURFACES];
    size_t *element; /* element i of the body is element[i] of the scene */
    double scale;    /* a power of two */
} ordering;

static ordering plain_order(const workload *w, int at_once) {
    ordering o;
    size_t i;
    o.at_once = at_once;
    o.scale = 1;
    o.element = (size_t *)oracle_memory(NULL, w->element_count, sizeof *o.element);
    for (i = 0; i < w->element_count; i++) o.element[i] = i;
    for (i = 0; i < w->surface_count; i++) o.surface[i] = i;
    return o;
}

static void shuffle(size_t *list, size_t count) {
    size_t i;
    for (i = count; i > 1; i--) {
        size_t j = (size_t)random_below((int)i), old = list[i - 1];
        list[i - 1] = list[j];
        list[j] = old;
    }
}

static double *scaled(const double *values, size_t count, double scale) {
    double *copy = (double *)oracle_memory(NULL, count, sizeof *copy);
    size_t i;
    for (i = 0; i < count; i++) copy[i] = scale * values[i];
    return copy;
}

static gx_body *build(const workload *w, const ordering *o, uint64_t seed) {
    double *positions = scaled(w->positions, 3 * w->node_count, o->scale);
    uint32_t *elements = (uint32_t *)oracle_memory(NULL, 4 * w->element_count, sizeof *elements);
    gx_body_desc desc;
    gx_body *body = NULL;
    gx_result result;
    size_t i;
    for (i = 0; i < w->element_count; i++)
        memcpy(elements + 4 * i, w->elements + 4 * o->element[i], 4 * sizeof *elements);
    memset(&desc, 0, sizeof desc);
    desc.positions = positions;
    desc.node_count = w->node_count;
    desc.elements = elements;
    desc.element_count = w->element_count;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    result = gx_body_create(&desc, &body, NULL);
    ck_assert_msg(result == GX_OK, "scene %llu: create: %s", (unsigned long long)seed, gx_result_text(result));
    free(positions);
    free(elements);
    return body;
}

static void cut(gx_body *body, const workload *w, const ordering *o, uint64_t seed) {
    gx_surface surfaces[WL_SURFACES];
    double *vertices[WL_SURFACES];
    size_t i, calls = w->surface_count == 0 ? 0 : o->at_once ? 1 : w->surface_count;
    memset(surfaces, 0, sizeof surfaces);
    for (i = 0; i < w->surface_count; i++) {
        const wl_surface *s = &w->surfaces[o->surface[i]];
        vertices[i] = scaled(s->vertices, 3 * s->vertex_count, o->scale);
        surfaces[i].vertices = vertices[i];
        surfaces[i].vertex_count = s->vertex_count;
        surfaces[i].triangles = s->triangles;
        surfaces[i].triangle_count = s->triangle_count;
        surfaces[i].kind = s->solid == 0 ? GX_SURFACE_SHEET : s->solid == 1 ? GX_SURFACE_SOLID : GX_SURFACE_KEEP;
    }
    for (i = 0; i < calls; i++) {
        gx_cut_desc desc;
        gx_result result;
        memset(&desc, 0, sizeof desc);
        desc.surfaces = surfaces + i;
        desc.surface_count = o->at_once ? w->surface_count : 1;
        result = gx_body_cut(body, &desc, NULL, NULL);
        ck_assert_msg(result == GX_OK, "scene %llu: cut %zu: %s", (unsigned long long)seed, i, gx_result_text(result));
    }
    for (i = 0; i < w->surface_count; i++) free(vertices[i]);
}

/* ---- comparison ---- */

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The volumes, sorted and compared one by one: within 1e-10 of themselves or 1e-14 of the whole */
static int same_volumes(double *a, double *b, size_t count, double whole) {
    size_t i;
    qsort(a, count, sizeof *a, ascending);
    qsort(b, count, sizeof *b, ascending);
    for (i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= 1e-10 * b[i] + 1e-14 * whole)) return 0;
    return 1;
}

static void compare_cells(const workload *w, const oracle *truth, const gx_view *view, const ordering *o,
                          const char *how, uint64_t seed) {
    double *ours = (double *)oracle_memory(NULL, view->cell_count, sizeof *ours), *exact;
    size_t e, i, total = 0;
    exact = (double *)oracle_memory(NULL, truth->cell_count, sizeof *exact);
    for (e = 0; e < w->element_count; e++) {
        size_t ours_count = 0, exact_count = 0;
        rat_mark mark = rat_arena_mark();
        double whole = rat_to_double(oracle_element_volume(&truth->mesh, o->element[e]));
        rat_arena_release(mark);
        for (i = 0; i < view->cell_count; i++)
            if (view->cell_element[i] == e)
                ours[ours_count++] = view->cell_volume[i] / (o->scale * o->scale * o->scale);
        for (i = 0; i < truth->cell_count; i++)
            if (truth->cell_element[i] == o->element[e]) exact[exact_count++] = truth->cell_volume[i];
        ck_assert_msg(ours_count == exact_count, "scene %llu, %s: element %zu has %zu cells, should have %zu",
                      (unsigned long long)seed, how, o->element[e], ours_count, exact_count);
        ck_assert_msg(same_volumes(ours, exact, exact_count, whole),
                      "scene %llu, %s: volumes of element %zu (%zu cells)", (unsigned long long)seed, how,
                      o->element[e], exact_count);
        total += ours_count;
    }
    ck_assert_uint_eq(total, view->cell_count);
    free(ours);
    free(exact);
}

static void compare_copies(const workload *w, const oracle *truth, const gx_view *view, const char *how,
                           uint64_t seed) {
    size_t node, i;
    for (node = 0; node < w->node_count; node++) {
        size_t count = 0;
        for (i = 0; i < view->copy_count; i++) count += view->copy_node[i] == node;
        ck_assert_msg(count == truth->node_copies[node], "scene %llu, %s: node %zu has %zu copies, should have %zu",
                      (unsigned long long)seed, how, node, count, truth->node_copies[node]);
    }
}

static void compare_fragments(const oracle *truth, const gx_view *view, double scale, const char *how, uint64_t seed) {
    double *ours, *exact;
    ck_assert_msg(view->fragment_count == truth->fragment_count, "scene %llu, %s: %zu fragments, should be %zu",
                  (unsigned long long)seed, how, view->fragment_count, truth->fragment_count);
    ours = scaled(view->fragment_volume, view->fragment_count, 1 / (scale * scale * scale));
    exact = scaled(truth->fragment_volume, truth->fragment_count, 1);
    ck_assert_msg(same_volumes(ours, exact, truth->fragment_count, truth->volume),
                  "scene %llu, %s: volumes of fragments", (unsigned long long)seed, how);
    ck_assert_msg(fabs(view->volume / (scale * scale * scale) - truth->volume) <= 1e-12 * truth->volume,
                  "scene %llu, %s: volume %.17g, should be %.17g", (unsigned long long)seed, how,
                  view->volume / (scale * scale * scale), truth->volume);
    free(ours);
    free(exact);
}

static void hold_against(const workload *w, const oracle *truth, const ordering *o, const char *how, uint64_t seed) {
    gx_body *body = build(w, o, seed);
    gx_view view;
    cut(body, w, o, seed);
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    compare_cells(w, truth, &view, o, how, seed);
    compare_copies(w, truth, &view, how, seed);
    compare_fragments(truth, &view, o->scale, how, seed);
    gx_body_destroy(body);
}

/* The oracle's pieces, kept and removed, fill every element. */
static void check_oracle(const oracle *truth, uint64_t seed) {
    size_t e, i;
    for (e = 0; e < truth->mesh.element_count; e++) {
        rat_mark mark = rat_arena_mark();
        double whole = rat_to_double(oracle_element_volume(&truth->mesh, e)), sum = 0;
        rat_arena_release(mark);
        for (i = truth->element_pieces[e]; i < truth->element_pieces[e + 1]; i++)
            sum += oracle_piece_volume(truth, &truth->pieces[i]);
        ck_assert_msg(fabs(sum - whole) <= 1e-13 * whole, "scene %llu: the oracle's pieces of element %zu",
                      (unsigned long long)seed, e);
    }
}

static void check_scene(workload *w, uint64_t seed) {
    oracle *truth = wl_oracle(w);
    ordering o = plain_order(w, 1);
    check_oracle(truth, seed);
    hold_against(w, truth, &o, "all at once", seed);
    o.at_once = 0;
    if (w->surface_count > 1) hold_against(w, truth, &o, "one after another", seed);
    shuffle(o.surface, w->surface_count);
    shuffle(o.element, w->element_count);
    o.scale = ldexp(1, random_below(41) - 20);
    hold_against(w, truth, &o, "shuffled and scaled, one after another", seed);
    o.at_once = 1;
    if (w->surface_count > 1) hold_against(w, truth, &o, "shuffled and scaled, all at once", seed);
    free(o.element);
    oracle_destroy(truth);
}

/* ---- the oracle by itself ---- */

static workload cube_cut(int first, int second, double parts) {
    wl_frame axes = wl_axes();
    workload w = wl_grid(1, 1, 1, 5, &axes);
    int i;
    for (i = 1; i <= first; i++) add_axis_plane(&w, 0, i / parts, 0);
    for (i = 1; i <= second; i++) add_axis_plane(&w, 1, i / parts, 0);
    return w;
}

/* GXFEM Table 2: 48 copies, 6 pieces; the pieces of each element add up to it exactly */
START_TEST(oracle_knows_the_paper) {
    workload w = cube_cut(5, 0, 6);
    oracle *o = wl_oracle(&w);
    size_t e, i;
    ck_assert_uint_eq(o->copy_count, 48);
    ck_assert_uint_eq(o->fragment_count, 6);
    for (e = 0; e < w.element_count; e++) {
        rat sum = rat_from_int(0);
        for (i = o->element_pieces[e]; i < o->element_pieces[e + 1]; i++)
            sum = oracle_add_piece_volume(o, &o->pieces[i], sum);
        ck_assert_int_eq(rat_compare(sum, oracle_element_volume(&o->mesh, e)), 0);
    }
    oracle_destroy(o);
    wl_free(&w);
    for (i = 6; i <= 8; i += 2) {
        w = cube_cut(5, 5, (double)i);
        o = wl_oracle(&w);
        ck_assert_uint_eq(o->fragment_count, 36);
        ck_assert_double_eq_tol(o->volume, 1, 1e-14);
        oracle_destroy(o);
        wl_free(&w);
    }
}
END_TEST

/* An uncut node has one copy on any mesh. A wall that reaches the shared edge or node separates the two elements. */
START_TEST(oracle_knows_shared_edges_and_nodes) {
    double outside[3][3] = {{0, 0, 0}, {0, 0, 1}, {1, -1, 0}}, facet[3][3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    int shared;
    for (shared = 1; shared <= 2; shared++) {
        workload w;
        oracle *o;
        random_state = 2;
        do {
            random_bits();
            w = non_manifold(shared);
        } while (w.element_count > 2 && (wl_free(&w), 1));
        o = wl_oracle(&w);
        ck_assert_uint_eq(o->copy_count, w.node_count);
        ck_assert_uint_eq(o->fragment_count, 1);
        oracle_destroy(o);
        add_plane(&w, outside); /* touches both elements in the shared edge or node, and nowhere else */
        o = wl_oracle(&w);
        ck_assert_uint_eq(o->fragment_count, 1 + ORACLE_TOUCH_FROM_OUTSIDE);
        oracle_destroy(o);
        add_plane(&w, facet);
        o = wl_oracle(&w);
        ck_assert_uint_eq(o->fragment_count, 2);
        ck_assert_uint_eq(o->copy_count, 8);
        oracle_destroy(o);
        wl_free(&w);
    }
}
END_TEST

/* ---- the library ---- */

START_TEST(cube_of_sticks) {
    int i;
    for (i = 6; i <= 8; i += 2) {
        workload one = cube_cut(5, 0, i), two = cube_cut(5, 5, i);
        random_state = 7;
        check_scene(&one, 0);
        check_scene(&two, 0);
        wl_free(&one);
        wl_free(&two);
    }
}
END_TEST

START_TEST(random_scenes) {
    uint64_t seed = 1 + (uint64_t)_i * (SCENES / PARTS), last = seed + SCENES / PARTS;
    const char *only = getenv("GXFEM_SEED");
    if (only != NULL) {
        seed = strtoull(only, NULL, 10);
        last = seed + (_i == 0);
    }
    for (; seed < last; seed++) {
        workload w = random_scene(seed);
        check_scene(&w, seed);
        wl_free(&w);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("oracle");
    TCase *tests = tcase_create("oracle");
    int result;
    tcase_set_timeout(tests, 300);
    tcase_add_test(tests, oracle_knows_the_paper);
    tcase_add_test(tests, oracle_knows_shared_edges_and_nodes);
    tcase_add_test(tests, cube_of_sticks);
    tcase_add_loop_test(tests, random_scenes, 0, PARTS);
    suite_add_tcase(suite, tests);
    result = run_suite(suite);
    rat_arena_free();
    return result;
}
