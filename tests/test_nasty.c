/* test_nasty.c - twenty generated models of the kinds that meshers fail on, as bodies: mass, centre and inertia of each
   material against the models' exact moments; area of the skin; pieces beside Booleans of the surfaces. Surfaces that
   cross themselves or have a hole. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include "pieces.h"
#include "cell_moments.h"

enum { NASTY = 20, NASTY_MATERIALS = 3 };

/* Surface n gives material n. The regions of material come out of moments of closed surfaces, added or taken away. */
typedef struct nasty {
    const char *name;
    workload w;
    workload parts;    /* solid: the material, + 16: what is taken away */
    double slack;      /* of lengths: far out, coordinates have fewer digits; else 0 */
    uint32_t cells;    /* 0: cubes of edge 1 */
    int pieces, inner; /* pieces: 0: not told here; inner 1: faces within the material are not in the skin */
} nasty;

enum { TAKEN = 16 };

static void add_part(nasty *n, const wl_surface *s, int material) {
    wl_surface *own = wl_add_surface(&n->parts, material);
    size_t i;
    for (i = 0; i < s->vertex_count; i++) wl_add_vertex(own, s->vertices + 3 * i);
    for (i = 0; i < s->triangle_count; i++)
        wl_add_triangle(own, s->triangles[3 * i], s->triangles[3 * i + 1], s->triangles[3 * i + 2]);
}

/* Each surface alone is the region of its material. */
static void parts_are_surfaces(nasty *n) {
    size_t i;
    for (i = 0; i < n->w.surface_count; i++) add_part(n, &n->w.surfaces[i], (int)i);
}

static void scale(wl_surface *s, double x, double y, double z) {
    size_t i;
    for (i = 0; i < s->vertex_count; i++) {
        s->vertices[3 * i] *= x;
        s->vertices[3 * i + 1] *= y;
        s->vertices[3 * i + 2] *= z;
    }
}

static void add_tetrahedron(wl_surface *s, const double x[4][3]) {
    const uint32_t first = (uint32_t)s->vertex_count;
    const int turned = gxb_orient3d(x[0], x[1], x[2], x[3]) > 0;
    int k;
    for (k = 0; k < 4; k++) wl_add_vertex(s, x[k]);
    for (k = 0; k < 4; k++) {
        const uint8_t *out = gxp_outward[k];
        wl_add_triangle(s, first + out[0], first + out[turned ? 2 : 1], first + out[turned ? 1 : 2]);
    }
}

static void add_needles(wl_surface *s, int count) {
    int i, j, k;
    for (i = 0; i < count; i++) {
        double x[4][3];
        for (k = 0; k < 3; k++) x[0][k] = random_real(-1, 1);
        for (j = 1; j < 4; j++)
            for (k = 0; k < 3; k++) x[j][k] = 3 * i + (j == k + 1 ? 1e-3 : 0) + (k == i % 3 ? 2 : 0);
        for (k = 0; k < 3; k++) x[0][k] += 3 * i;
        add_tetrahedron(s, (const double(*)[3])x);
    }
}

/* Cubes of a lattice, those for which it is so */
static void add_cubes(wl_surface *s, int n, double edge, int (*full)(int i, int j, int k)) {
    int i, j, k;
    for (k = 0; k < n; k++)
        for (j = 0; j < n; j++)
            for (i = 0; i < n; i++)
                if (full(i, j, k))
                    add_bar(s, i * edge, j * edge, k * edge, (i + 1) * edge, (j + 1) * edge, (k + 1) * edge);
}

static int is_checker(int i, int j, int k) { return (i + j + k) % 2 == 0; }
static int is_any(int i, int j, int k) { return i + j + k >= 0; }
static int is_menger(int i, int j, int k) {
    for (; i + j + k > 0; i /= 3, j /= 3, k /= 3)
        if ((i % 3 == 1) + (j % 3 == 1) + (k % 3 == 1) >= 2) return 0;
    return 1;
}

/* A strip that winds about an axis, thin: n quads along it on each of four sides, and two ends */
static void add_spiral(wl_surface *s, int n, double thickness) {
    const uint32_t first = (uint32_t)s->vertex_count;
    int i, c;
    for (i = 0; i <= n; i++)
        for (c = 0; c < 4; c++) {
            const double t = 12.0 * i / n, r = 0.2 + 0.06 * t + (c == 1 || c == 2 ? thickness : 0);
            const double x[3] = {r * cos(t), r * sin(t), c < 2 ? 0 : 0.3};
            wl_add_vertex(s, x);
        }
    for (i = 0; i < n; i++)
        for (c = 0; c < 4; c++) {
            const uint32_t a = first + 4 * (uint32_t)i + (uint32_t)c,
                           b = first + 4 * (uint32_t)i + (uint32_t)((c + 1) % 4);
            wl_add_triangle(s, a, b + 4, b);
            wl_add_triangle(s, a, a + 4, b + 4);
        }
    wl_add_triangle(s, first, first + 1, first + 2);
    wl_add_triangle(s, first, first + 2, first + 3);
    c = (int)first + 4 * n;
    wl_add_triangle(s, (uint32_t)c, (uint32_t)c + 2, (uint32_t)c + 1);
    wl_add_triangle(s, (uint32_t)c, (uint32_t)c + 3, (uint32_t)c + 2);
}

static const double middle[3] = {0, 0, 0};

/* Thin, sharp, small */
static void make_thin(nasty *n, int kind, wl_surface *s) {
    size_t i;
    int k, j;
    switch (kind) {
    case 0:
        n->name = "hedgehog";
        add_blob(s, middle, 0.5, 0, 0, 12, 0);
        for (i = 0; i < s->vertex_count; i += 5)
            for (k = 0; k < 3; k++) s->vertices[3 * i + (size_t)k] *= 3;
        break;
    case 1:
        n->name = "thin ears";
        add_blob(s, middle, 0.5, 0, 0, 10, 0);
        add_bar(s, 0.6, -0.0003, -0.2, 1.3, 0.0004, 0.2);
        add_bar(s, -1.3, -0.2, 0.00001, -0.6, 0.2, 0.00003);
        n->pieces = 3;
        break;
    case 2:
        n->name = "a shell";
        add_blob(s, middle, 1, 2, 0.1, 14, 0);
        add_blob(s, middle, 0.999, 2, 0.1, 14, 1);
        n->pieces = 1;
        break;
    case 3:
        n->name = "needles";
        add_needles(s, 12);
        n->cells = 30;
        n->pieces = 12;
        break;
    case 4:
        n->name = "slivers";
        add_blob(s, middle, 1, 0, 0, 4, 0);
        for (k = 0; k < 120; k++) {
            const double z = 0.03 * k,
                         x[4][3] = {{2, 0, z}, {3, 0, z + 0.001}, {2, 1e-4, z + 0.002}, {2.5, 1e-3, z + 0.01}};
            add_tetrahedron(s, x);
        }
        n->pieces = 121;
        break;
    case 5:
        n->name = "a spiral";
        add_spiral(s, 160, 0.002);
        n->pieces = 1;
        break;
    case 6:
        n->name = "flat";
        add_blob(s, middle, 1, 3, 0.2, 16, 0);
        scale(s, 1, 1e-3, 0.6);
        break;
    default:
        n->name = "thousands of components";
        for (i = 0; i < 2197; i++) {
            double x[4][3];
            for (j = 0; j < 4; j++)
                for (k = 0; k < 3; k++)
                    x[j][k] = 0.1 * (double)(k == 0 ? i % 13 : k == 1 ? i / 13 % 13 : i / 169) + random_real(0, 0.09);
            add_tetrahedron(s, (const double(*)[3])x);
        }
        n->pieces = 2197;
    }
    parts_are_surfaces(n);
}

/* Touching, on the grid's planes, of many holes, far out */
static void make_touching(nasty *n, int kind, wl_surface *s) {
    int k;
    n->inner = 1;
    switch (kind) {
    case 8:
        n->name = "corners and edges that touch";
        add_cubes(s, 5, 0.2, is_checker);
        n->inner = 0;
        n->pieces = 63;
        break;
    case 9:
        n->name = "faces of one surface that coincide";
        add_cubes(s, 5, 0.17, is_any);
        n->pieces = 1;
        break;
    case 10:
        n->name = "a sponge";
        add_cubes(s, 9, 0.125, is_menger);
        n->pieces = 1;
        break;
    case 11:
        n->name = "genus 30";
        add_plate(s, 5, 6, 0.11);
        n->inner = 0;
        n->pieces = 1;
        break;
    case 12:
        n->name = "on the grid's planes and nodes";
        add_cubes(s, 4, 1, is_checker);
        add_bar(s, 0, 0, 8, 16, 16, 12);
        n->cells = 0;
        n->inner = 0;
        n->pieces = 33;
        break;
    case 13:
        n->name = "far out";
        add_blob(s, middle, 0.8, 4, 0.3, 14, 0);
        for (k = 0; k < (int)s->vertex_count; k++) s->vertices[3 * k] += 1e7;
        n->slack = 1e7;
        n->pieces = 1;
        break;
    default:
        n->name = "layers that touch";
        for (k = 0; k < 12; k++) add_bar(s, 0.3 * (k % 2), 0, 0.03 * k, 1 + 0.1 * k, 1, 0.03 * (k + 1));
        n->pieces = 1;
    }
    parts_are_surfaces(n);
}

/* Of several materials, or wound around twice */
static void make_several(nasty *n, int kind, wl_surface *s) {
    wl_surface *t;
    int k;
    n->pieces = 1;
    n->inner = 1;
    switch (kind) {
    case 15:
        n->name = "neighbours of two materials";
        t = wl_add_surface(&n->w, 1);
        s = &n->w.surfaces[0];
        for (k = 0; k < 27; k++) {
            const double x = 0.3 * (k % 3), y = 0.3 * (k / 3 % 3), z = 0.3 * (k / 9);
            add_bar(k % 2 ? t : s, x, y, z, 0.3 * (k % 3 + 1), 0.3 * (k / 3 % 3 + 1), 0.3 * (k / 9 + 1));
        }
        parts_are_surfaces(n);
        break;
    case 16:
        n->name = "bone in flesh, a skin on it";
        add_blob(s, middle, 1, 3, 0.1, 12, 0);
        add_blob(wl_add_surface(&n->w, 1), middle, 0.999, 3, 0.1, 12, 0);
        add_blob(wl_add_surface(&n->w, 1), middle, 0.5, 2, 0.3, 9, 0);
        parts_are_surfaces(n);
        add_part(n, &n->w.surfaces[1], 0 + TAKEN);
        add_part(n, &n->w.surfaces[2], 1 + TAKEN);
        break;
    case 17:
        n->name = "the same twice";
        add_blob(s, middle, 1, 3, 0.3, 10, 0);
        add_part(n, s, 0);
        add_blob(s, middle, 1, 3, 0.3, 10, 0);
        break;
    case 18:
        n->name = "a surface that crosses itself";
        add_bar(s, 0, 0, 0, 1, 1, 1);
        add_part(n, s, 0);
        add_bar(s, 0.25, 0.5, 0.75, 1.5, 1.5, 1.75);
        t = wl_add_surface(&n->parts, 0);
        add_bar(t, 0.25, 0.5, 0.75, 1.5, 1.5, 1.75);
        t = wl_add_surface(&n->parts, TAKEN);
        add_bar(t, 0.25, 0.5, 0.75, 1, 1, 1);
        break;
    default:
        n->name = "bars of three materials that overlap";
        add_bar(s, 0, 0, 0, 3, 1, 1);
        add_part(n, s, 0);
        add_bar(wl_add_surface(&n->w, 1), 1, -1, 0, 2, 2, 1);
        add_part(n, &n->w.surfaces[1], 1);
        add_bar(wl_add_surface(&n->w, 1), 1.25, 0.25, -1, 1.75, 0.75, 2);
        add_part(n, &n->w.surfaces[2], 2);
        add_bar(wl_add_surface(&n->parts, 0 + TAKEN), 1, 0, 0, 2, 1, 1);
        add_bar(wl_add_surface(&n->parts, 1 + TAKEN), 1.25, 0.25, 0, 1.75, 0.75, 1);
    }
}

static nasty some_nasty(int kind) {
    nasty n;
    wl_surface *s;
    memset(&n, 0, sizeof n);
    n.w = wl_empty();
    n.parts = wl_empty();
    n.cells = 9;
    random_seed(77);
    s = wl_add_surface(&n.w, 1);
    if (kind < 8)
        make_thin(&n, kind, s);
    else if (kind < 15)
        make_touching(&n, kind, s);
    else
        make_several(&n, kind, s);
    return n;
}

static void nasty_free(nasty *n) {
    wl_free(&n->w);
    wl_free(&n->parts);
}

/* ---- bodies ---- */

static const double densities[NASTY_MATERIALS] = {1000, 1700, 850};

static gx_result make_body(const workload *w, uint32_t cells, gx_body **body, gx_failure *failure) {
    gx_surface surfaces[WL_SURFACES];
    gx_material materials[NASTY_MATERIALS];
    gx_shape shape;
    gx_body_desc desc;
    size_t i;
    memset(&desc, 0, sizeof desc);
    memset(&shape, 0, sizeof shape);
    memset(materials, 0, sizeof materials);
    for (i = 0; i < NASTY_MATERIALS; i++) {
        materials[i].elastic.young = 1e5;
        materials[i].elastic.poisson = 0.4;
        materials[i].density = densities[i];
    }
    for (i = 0; i < w->surface_count; i++) {
        surfaces[i] = surface_of(&w->surfaces[i]);
        surfaces[i].material = (uint32_t)i;
    }
    shape.surfaces = surfaces;
    shape.surface_count = w->surface_count;
    shape.cells = cells;
    shape.edge = cells == 0 ? 1 : 0;
    desc.shape = &shape;
    desc.materials = materials;
    desc.material_count = NASTY_MATERIALS;
    return gx_body_create(&desc, body, failure);
}

/* The same of the model's regions, exactly, without the density */
static exact_moments moments_of_parts(const nasty *n, uint32_t material, const double about[3]) {
    exact_moments sum;
    size_t i, k;
    memset(&sum, 0, sizeof sum);
    for (i = 0; i < n->parts.surface_count; i++) {
        const int of = n->parts.surfaces[i].solid, sign = of >= TAKEN ? -1 : 1;
        exact_moments m;
        if ((uint32_t)of % TAKEN != material) continue;
        m = moments_of_surfaces(&n->parts.surfaces[i], 1, about);
        sum.volume += sign * m.volume;
        for (k = 0; k < 3; k++) sum.first[k] += sign * m.first[k];
        for (k = 0; k < 6; k++) sum.second[k] += sign * m.second[k];
    }
    return sum;
}

/* Returns the largest error, as a share of what moments are about the material's own centre. */
static double expect_moments(const nasty *n, const gx_body *body, uint32_t material) {
    double about[3], worst, size;
    const exact_moments first = moments_of_parts(n, material, middle);
    exact_moments own, exact;
    int k;
    for (k = 0; k < 3; k++) about[k] = first.volume > 0 ? first.first[k] / first.volume : 0;
    own = moments_of_cells(body, material, about);
    exact = moments_of_parts(n, material, about);
    if (exact.volume <= 0) {
        ck_assert(own.volume == 0);
        return 0;
    }
    size = sqrt((exact.second[0] + exact.second[3] + exact.second[5]) / exact.volume);
    worst = fabs(own.volume / densities[material] / exact.volume - 1);
    for (k = 0; k < 3; k++)
        worst = fmax(worst, fabs(own.first[k] / densities[material] - exact.first[k]) / (exact.volume * size));
    for (k = 0; k < 6; k++)
        worst = fmax(worst, fabs(own.second[k] / densities[material] - exact.second[k]) / (exact.volume * size * size));
    ck_assert_msg(worst <= 1e-13 + 1e-15 * n->slack / size, "%s, material %u: moments are off by %.2g", n->name,
                  material, worst);
    return worst;
}

/* Whole and in two: moments by material, pieces, the skin. GXFEM_PRINT=1 tells the errors. */
START_TEST(models_that_meshers_fail_on) {
    nasty n = some_nasty(_i);
    workload plane = wl_empty();
    const double normal[3] = {0.31, 0.83, -0.47};
    gx_surface sheet;
    gx_cut_desc cut;
    gx_body *body = NULL;
    gx_failure failure;
    double worst = 0, area = 0, own, place[3];
    exact_moments all;
    size_t i;
    uint32_t m;
    gx_result result = make_body(&n.w, n.cells, &body, &failure);
    ck_assert_msg(result == GX_OK, "%s: %s, %s %zu", n.name, gx_result_text(result), failure.field ? failure.field : "",
                  failure.index);
    for (m = 0; m < NASTY_MATERIALS; m++) worst = fmax(worst, expect_moments(&n, body, m));
    if (n.pieces > 0) ck_assert_uint_eq(view_of(body).fragment_count, (size_t)n.pieces);
    expect_pieces(body, &n.w, NULL, n.name);
    own = area_of_skin(body);
    for (i = 0; i < n.w.surface_count; i++) area += area_of(&n.w.surfaces[i]);
    if (!n.inner)
        ck_assert_msg(fabs(own - area) <= (1e-12 + 1e-15 * n.slack) * area, "%s: the skin is off by %.2g", n.name,
                      own / area - 1);
    if (getenv("GXFEM_PRINT") != NULL)
        printf("%-38s %6zu triangles %6zu elements %6zu cells, moments %.1e, skin %.1e\n", n.name,
               n.w.surfaces[0].triangle_count, view_of(body).element_count, view_of(body).cell_count, worst,
               n.inner ? 0 : fabs(own / area - 1));
    all = moments_of_parts(&n, 0, middle);
    for (i = 0; i < 3; i++) place[i] = all.first[i] / all.volume + 0.0123;
    add_plane(&plane, place, normal, 200);
    sheet = surface_of(&plane.surfaces[0]);
    memset(&cut, 0, sizeof cut);
    cut.surfaces = &sheet;
    cut.surface_count = 1;
    ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
    for (m = 0; m < NASTY_MATERIALS; m++) expect_moments(&n, body, m);
    expect_pieces(body, &n.w, &sheet, n.name);
    gx_body_destroy(body);
    nasty_free(&n);
    wl_free(&plane);
}
END_TEST

/* ---- surfaces that cross themselves ---- */

/* Balls whose radius changes its sign, tubes through themselves, a heap of tetrahedra turned either way */
static workload crossing(int kind) {
    workload w = wl_empty();
    wl_surface *s = wl_add_surface(&w, 1);
    size_t i;
    int k, j;
    random_seed(5 + (uint64_t)kind);
    switch (kind) {
    case 0: add_blob(s, middle, 0.7, 3, 1.6, 10, 0); break;
    case 1: add_blob(s, middle, 0.7, 5, 2.5, 12, 1); break;
    case 2: /* walls as thick as the way around: each turn reaches into the next */ add_spiral(s, 60, 0.4); break;
    case 3: /* vertices moved at random, far more than the triangles are long */
        add_blob(s, middle, 0.7, 0, 0, 7, 0);
        for (i = 0; i < 3 * s->vertex_count; i++) s->vertices[i] += random_real(-0.4, 0.4);
        break;
    default:
        for (k = 0; k < 24; k++) {
            double x[4][3];
            uint32_t *t, swap;
            for (i = 0; i < 4; i++)
                for (j = 0; j < 3; j++) x[i][j] = random_real(-1, 1);
            add_tetrahedron(s, (const double(*)[3])x);
            for (i = 0; i < 4 && k % 2; i++) { /* inside out: nothing is wound around both */
                t = s->triangles + 3 * (s->triangle_count - 4 + i);
                swap = t[1];
                t[1] = t[2];
                t[2] = swap;
            }
        }
    }
    return w;
}

/* Material is where the winding number is not 0: at points taken at random, and in volume and pieces by Booleans. */
START_TEST(surfaces_that_cross_themselves) {
    workload w = crossing(_i);
    const wl_surface *s = &w.surfaces[0];
    gx_body *body = NULL;
    size_t i, inside = 0;
    ck_assert_int_eq(make_body(&w, 7, &body, NULL), GX_OK);
    for (i = 0; i < 400; i++) {
        const double x[3] = {random_real(-1.2, 1.2), random_real(-1.2, 1.2), random_real(-1.2, 1.2)};
        int on;
        size_t count = 0;
        gx_hit hits[8];
        const int winding = gxb_winding_number(s->vertices, s->triangles, s->triangle_count, x, &on);
        ck_assert_int_eq(gx_body_locate_all(body, x, hits, 8, &count, NULL), GX_OK);
        ck_assert_msg((winding != 0) == (count > 0), "kind %d: winding number %d, %zu cells", _i, winding, count);
        inside += winding != 0;
    }
    ck_assert(inside > 10);
    expect_pieces(body, &w, NULL, "a surface that crosses itself");
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- surfaces that are not closed ---- */

/* Does the triangle have an edge with two of the corners? */
static int has_edge_of(const uint32_t *triangle, const uint32_t *hole) {
    int i, j, count = 0;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) count += triangle[i] == hole[j];
    return count >= 2;
}

/* Any one triangle left out, turned over or there twice: refused, and the triangle that is named is at the place. */
START_TEST(surfaces_with_a_hole) {
    workload w = wl_empty();
    wl_surface *s;
    gx_body *body = NULL;
    gx_failure failure;
    uint32_t hole[3], swap;
    size_t t;
    add_blob(wl_add_surface(&w, 1), middle, 2, 0, 0, 5, 0);
    s = wl_add_surface(&w, 1);
    add_blob(s, middle, 1, 2, 0.2, 4, 0);
    for (t = 0; t < s->triangle_count; t++) {
        uint32_t *own = s->triangles + 3 * t, *last = s->triangles + 3 * (s->triangle_count - 1);
        memcpy(hole, own, sizeof hole);
        memcpy(own, last, sizeof hole);
        s->triangle_count--;
        ck_assert_int_eq(make_body(&w, 4, &body, &failure), GX_ERROR_NOT_CLOSED);
        ck_assert(body == NULL && failure.surface == 1 && failure.index < s->triangle_count);
        ck_assert_str_eq(failure.field, "shape.surfaces.triangles");
        ck_assert(has_edge_of(s->triangles + 3 * failure.index, hole));
        s->triangle_count++;
        memcpy(last, own, sizeof hole);
        memcpy(own, hole, sizeof hole);
        swap = own[1];
        own[1] = own[2];
        own[2] = swap;
        ck_assert_int_eq(make_body(&w, 4, &body, &failure), GX_ERROR_NOT_CLOSED);
        ck_assert(failure.surface == 1 && has_edge_of(s->triangles + 3 * failure.index, hole));
        memcpy(own, hole, sizeof hole);
        wl_add_triangle(s, hole[0], hole[1], hole[2]);
        ck_assert_int_eq(make_body(&w, 4, &body, &failure), GX_ERROR_NOT_CLOSED);
        ck_assert(failure.surface == 1 && has_edge_of(s->triangles + 3 * failure.index, hole));
        s->triangle_count--;
    }
    ck_assert_int_eq(make_body(&w, 4, &body, &failure), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("nasty");
    TCase *tests = tcase_create("nasty");
    tcase_set_timeout(tests, 300);
    ADD_SOME(tests, models_that_meshers_fail_on, NASTY);
    ADD_SOME(tests, surfaces_that_cross_themselves, 5);
    tcase_add_test(tests, surfaces_with_a_hole);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) {
    const int result = run_suite(suite());
    rat_arena_free();
    return result;
}
