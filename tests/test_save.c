/* test_save.c - saved, loaded, cloned and restored bodies: no query tells them apart, later cuts give the same
   cells, later steps the same bits. Damaged and hostile bytes give an error, or a body that can be used, but never a
   crash; run this with make sanitize, too. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"

/* ---- scenes ---- */

static void shake(gx_body *body, double size) {
    gx_view v = view_of(body);
    size_t i;
    for (i = 0; i < 3 * v.copy_count; i++) {
        v.displacement[i] = random_real(-size, size);
        v.velocity[i] = random_real(-size, size);
    }
    for (i = 0; i < v.copy_count; i++) v.rest_time[i] = random_real(0, 1);
}

/* Texture coordinates for any mesh or surface, rounded, so that they are not exact numbers */
static const float *texture(void) {
    static float t[4096];
    size_t i;
    for (i = 0; i < 4096; i++) t[i] = (float)sin(0.37 * (double)i);
    return t;
}

static void cut_textured(gx_body *body, const workload *w, size_t surface, int textured) {
    gx_surface s = surface_of(&w->surfaces[surface]);
    gx_cut_desc cut;
    memset(&cut, 0, sizeof cut);
    ck_assert_uint_le(2 * s.vertex_count, 4096);
    s.texture = textured ? texture() : NULL;
    cut.surfaces = &s;
    cut.surface_count = 1;
    ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
}

/* A body cut by the first surfaces, some at once, some with textures, now and then with a view in between. The rest
   is spare. */
static gx_body *random_body(workload *w, int cuts, int spare) {
    gx_body_desc desc = desc_of(w);
    gx_body *body = NULL;
    size_t i;
    int k;
    desc.texture = random_below(2) ? texture() : NULL;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    for (k = 0; k < cuts + spare; k++) add_random_cut(w, 1);
    for (i = 0; i < (size_t)cuts; i++) {
        if (i + 1 < (size_t)cuts && random_below(3) == 0)
            cut_by(body, w, i++, 2);
        else
            cut_textured(body, w, i, random_below(2));
        if (random_below(2)) view_of(body);
    }
    return body;
}

static gx_result hold_low(gx_body *body, double value) {
    const gx_region region = gx_region_half_space(2, -1, value);
    return gx_body_hold(body, &region, 1, NULL);
}

/* Regions of all kinds, of which each but the first may hold nothing that the others do not. If one holds nothing at
   all, the first alone. */
static void hold_all(gx_body *body, double value) {
    static const double x[12] = {-1, -1, -1, 9, -1, -1, -1, 9, -1, -1, -1, 9}, middle[3] = {0.25, 0.25, 0.25};
    static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, nodes[3] = {3, 1, 3};
    const double low[3] = {-1, -0.5, -1}, high[3] = {value, 0.9, 5};
    gx_surface shell;
    gx_anchor anchor;
    gx_region regions[6];
    memset(&shell, 0, sizeof shell);
    memset(regions, 0, sizeof regions);
    shell.vertices = x;
    shell.vertex_count = 4;
    shell.triangles = triangles;
    shell.triangle_count = 4;
    regions[0] = gx_region_half_space(2, -1, value);
    regions[1] = gx_region_box(low, high);
    regions[2] = gx_region_sphere(low, 1.75);
    regions[3].kind = GX_REGION_SURFACE;
    regions[3].surface = &shell;
    regions[4].kind = GX_REGION_NODES;
    regions[4].nodes = nodes;
    regions[4].node_count = 3;
    regions[5].kind = GX_REGION_ANCHORS;
    regions[5].anchors = &anchor;
    regions[5].anchor_count = 1;
    if (gx_body_anchor(body, 0, middle, &anchor, NULL) != GX_OK || gx_body_hold(body, regions, 6, NULL) != GX_OK)
        ck_assert_int_eq(gx_body_hold(body, regions, 1, NULL), GX_OK);
}

/* ---- bytes ---- */

typedef struct bytes {
    unsigned char *data;
    size_t size;
} bytes;

static bytes saved(gx_body *body) {
    bytes b;
    size_t again = 0;
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &b.size, NULL), GX_OK);
    b.data = (unsigned char *)malloc(b.size);
    ck_assert_int_eq(gx_body_save(body, b.data, b.size, &again, NULL), GX_OK);
    ck_assert_uint_eq(again, b.size);
    return b;
}

static gx_body *loaded(bytes b) {
    gx_body *body = NULL;
    gx_failure failure;
    gx_result result = gx_body_load(b.data, b.size, NULL, &body, &failure);
    ck_assert_msg(result == GX_OK, "load: %s, byte %zu of %zu", gx_result_text(result), failure.index, b.size);
    ck_assert_int_eq(failure.result, GX_OK);
    return body;
}

static gx_body *clone_of(gx_body *body) {
    gx_body *clone = NULL;
    ck_assert_int_eq(gx_body_clone(body, &clone, NULL), GX_OK);
    return clone;
}

/* By way of bytes, or directly */
static gx_body *twin_of(gx_body *body, int by_bytes) {
    bytes b;
    gx_body *twin;
    if (!by_bytes) return clone_of(body);
    b = saved(body);
    twin = loaded(b);
    free(b.data);
    return twin;
}

/* ---- equality ---- */

#define SAME(a, b, count) CHECK_SEED((count) == 0 || memcmp(a, b, (count) * sizeof *(a)) == 0, seed)

static void expect_equal_views(gx_body *a, gx_body *b, uint64_t seed) {
    gx_view p = view_of(a), q = view_of(b);
    CHECK_SEED(p.cell_count == q.cell_count && p.copy_count == q.copy_count && p.fragment_count == q.fragment_count,
               seed);
    SAME(p.cell_element, q.cell_element, p.cell_count);
    SAME(p.cell_copies, q.cell_copies, 4 * p.cell_count);
    SAME(p.cell_volume, q.cell_volume, p.cell_count);
    SAME(p.cell_fragment, q.cell_fragment, p.cell_count);
    SAME(p.cell_slot, q.cell_slot, p.cell_count);
    CHECK_SEED(p.slot_count == q.slot_count, seed);
    SAME(p.slot_parent, q.slot_parent, p.slot_count);
    SAME(p.copy_node, q.copy_node, p.copy_count);
    SAME(p.copy_held, q.copy_held, p.copy_count);
    SAME(p.copy_region, q.copy_region, p.copy_count);
    SAME(p.displacement, q.displacement, 3 * p.copy_count);
    SAME(p.velocity, q.velocity, 3 * p.copy_count);
    SAME(p.rest_time, q.rest_time, p.copy_count);
    SAME(p.fragment_volume, q.fragment_volume, p.fragment_count);
    SAME(p.fragment_mass, q.fragment_mass, p.fragment_count);
    SAME(p.fragment_inertia, q.fragment_inertia, 6 * p.fragment_count);
    SAME(p.fragment_id, q.fragment_id, p.fragment_count);
    SAME(p.fragment_origin, q.fragment_origin, p.fragment_count);
    SAME(p.fragment_change, q.fragment_change, p.fragment_count);
    CHECK_SEED(p.removed_count == q.removed_count, seed);
    SAME(p.removed_ids, q.removed_ids, p.removed_count);
    CHECK_SEED(p.volume == q.volume && p.mass == q.mass, seed);
}

static void expect_equal_skins(gx_body *a, gx_body *b, uint64_t seed) {
    gx_skin p, q;
    ck_assert_int_eq(gx_body_skin(a, NULL, &p, NULL), GX_OK);
    ck_assert_int_eq(gx_body_skin(b, NULL, &q, NULL), GX_OK);
    CHECK_SEED(p.vertex_count == q.vertex_count && p.triangle_count == q.triangle_count, seed);
    SAME(p.vertex_copies, q.vertex_copies, 4 * p.vertex_count);
    SAME(p.vertex_weights, q.vertex_weights, 4 * p.vertex_count);
    SAME(p.triangles, q.triangles, 3 * p.triangle_count);
    SAME(p.triangle_surface, q.triangle_surface, p.triangle_count);
    SAME(p.triangle_fragment, q.triangle_fragment, p.triangle_count);
    SAME(p.vertex_rest, q.vertex_rest, 3 * p.vertex_count);
    SAME(p.vertex_normal, q.vertex_normal, 3 * p.vertex_count);
    SAME(p.vertex_texture, q.vertex_texture, 2 * p.vertex_count);
}

/* State first, since views and hashes open elements, and a view reports changes */
static void expect_equal_cells(gx_body *a, gx_body *b, uint64_t seed) {
    CHECK_SEED(gx_body_state_hash(a) == gx_body_state_hash(b), seed);
    expect_equal_views(a, b, seed);
    CHECK_SEED(hash_of(a) == hash_of(b), seed);
    CHECK_SEED(gx_body_state_hash(a) == gx_body_state_hash(b), seed);
}

/* Also skins, of bodies that have been drawn at the same times: a skin's order depends on earlier times. */
static void expect_equal(gx_body *a, gx_body *b, uint64_t seed) {
    expect_equal_cells(a, b, seed);
    expect_equal_skins(a, b, seed);
    CHECK_SEED(gx_body_state_hash(a) == gx_body_state_hash(b), seed);
}

/* ---- a loaded body is the saved one ---- */

START_TEST(random_bodies) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w;
    gx_body *body, *copy;
    bytes b, again;
    size_t k;
    random_seed(seed);
    w = random_below(2) ? random_mesh() : grid(2, 2, 1 + (size_t)random_below(2), random_below(2) ? 5 : 6);
    body = random_body(&w, 1 + random_below(5), 3);
    if (random_below(2)) shake(body, 0.05);
    if (random_below(2)) hold_all(body, random_real(0.1, 1));
    b = saved(body);
    copy = _i % 2 ? clone_of(body) : loaded(b);
    again = saved(copy);
    CHECK_SEED(again.size == b.size && memcmp(again.data, b.data, b.size) == 0, seed);
    expect_equal(body, copy, seed);
    for (k = 0; k < 3; k++) { /* further cuts */
        cut_textured(body, &w, w.surface_count - 1 - k, k == 0);
        cut_textured(copy, &w, w.surface_count - 1 - k, k == 0);
        if (k != 1) expect_equal(body, copy, seed); /* once without a view */
    }
    free(b.data);
    free(again.data);
    gx_body_destroy(body);
    gx_body_destroy(copy);
    wl_free(&w);
}
END_TEST

/* Free planes, through points made for them, near and far from the origin; further cuts */
START_TEST(many_triangles_in_an_element) {
    static const double sizes[3] = {1, 1e-3, 1e6}, offsets[3] = {0, 12345678.9, -3e7};
    workload w = grid(1, 1, 1, 5);
    gx_body *body, *copy;
    size_t i, k;
    add_cap(&w, 12, 0);
    add_cap(&w, 6, 1);
    add_axis_plane(&w, 2, 0.4);
    for (i = 0; i < 3 * w.node_count; i++) w.positions[i] = offsets[_i] + sizes[_i] * w.positions[i];
    for (k = 0; k < w.surface_count; k++)
        for (i = 0; i < 3 * w.surfaces[k].vertex_count; i++)
            w.surfaces[k].vertices[i] = offsets[_i] + sizes[_i] * w.surfaces[k].vertices[i];
    body = body_of(&w);
    cut_by(body, &w, 0, 1);
    ck_assert_uint_gt(free_planes(body), 2);
    copy = twin_of(body, 1);
    expect_equal(body, copy, (uint64_t)_i);
    for (k = 1; k < 3; k++) {
        cut_by(body, &w, k, 1);
        cut_by(copy, &w, k, 1);
        expect_equal(body, copy, (uint64_t)_i);
    }
    gx_body_destroy(body);
    gx_body_destroy(copy);
    wl_free(&w);
}
END_TEST

/* The frame of the complex shifts and scales. Given coordinates must come back unchanged. */
START_TEST(far_and_small_bodies) {
    static const double sizes[6] = {1, 1e-6, 1e6, 1e-30, 4e-31, 6e29}, offsets[6] = {1e8, 0.3, 12345678.9, 0, 0, 0};
    size_t i, k;
    workload w = grid(2, 2, 1, 5);
    gx_body *body, *copy;
    double p[3] = {0.9, 1.1, 0.4}, n[3] = {0.3, 1, 0.2};
    const double h = sizes[_i], x0 = offsets[_i];
    add_plane(&w, p, n, 2);
    p[0] = 1.3;
    n[2] = -3;
    add_plane(&w, p, n, 2);
    for (i = 0; i < 3 * w.node_count; i++) w.positions[i] = x0 + h * w.positions[i];
    for (k = 0; k < w.surface_count; k++)
        for (i = 0; i < 3 * w.surfaces[k].vertex_count; i++)
            w.surfaces[k].vertices[i] = x0 + h * w.surfaces[k].vertices[i];
    body = body_of(&w);
    cut_by(body, &w, 0, 1);
    copy = twin_of(body, 1);
    expect_equal_cells(body, copy, (uint64_t)_i);
    cut_by(body, &w, 1, 1);
    cut_by(copy, &w, 1, 1);
    expect_equal_cells(body, copy, (uint64_t)_i);
    ck_assert_uint_gt(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    gx_body_destroy(copy);
    wl_free(&w);
}
END_TEST

/* Where elements meet in an edge or a node only, walls of edges and nodes are part of the complex. */
START_TEST(pinched_bodies) {
    static const double x[8][3] = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                   {-1, 0, 0}, {0, -1, 0}, {0, -1, 1}, {-1, 0, 1}};
    workload w = wl_empty();
    gx_body *body, *copy;
    int i;
    for (i = 0; i < 8; i++) wl_add_node(&w, x[i][0], x[i][1], x[i][2]);
    wl_add_element(&w, 0, 1, 2, 3);
    if (_i == 0)
        wl_add_element(&w, 0, 4, 5, 3); /* the edge 03 */
    else
        wl_add_element(&w, 0, 4, 5, 6); /* the node 0 */
    add_plane(&w, x[0], x[1], 0.5);
    add_axis_plane(&w, 2, 0.25);
    body = body_of(&w);
    for (i = 0; i < 2; i++) {
        cut_by(body, &w, (size_t)i, 1);
        copy = twin_of(body, 1);
        expect_equal_cells(body, copy, (uint64_t)_i);
        if (i == 0) {
            cut_by(copy, &w, 1, 1);
            ck_assert_uint_gt(view_of(copy).fragment_count, 1);
        }
        gx_body_destroy(copy);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- steps ---- */

typedef struct custom {
    double stiffness;
    int calls;
} custom;

/* stiffness/2 |F - 1|^2 */
static double custom_energy(void *user, const double *f, double *stress, double *hessian) {
    custom *c = (custom *)user;
    double energy = 0;
    int i;
    c->calls++;
    for (i = 0; i < 9; i++) {
        const double d = f[i] - (i % 4 == 0);
        energy += 0.5 * c->stiffness * d * d;
        if (stress) stress[i] = c->stiffness * d;
        if (hessian) {
            memset(hessian + 9 * i, 0, 9 * sizeof *hessian);
            hessian[10 * i] = c->stiffness;
        }
    }
    return energy;
}

/* The same by another name */
static double other_energy(void *user, const double *f, double *stress, double *hessian) {
    return custom_energy(user, f, stress, hessian);
}

static void expect_same_steps(gx_body *a, gx_body *b, const gx_step_desc *step, int count, uint64_t seed) {
    int i;
    for (i = 0; i < count; i++) {
        gx_step_report p, q;
        ck_assert_int_eq(gx_body_step(a, step, &p, NULL), GX_OK);
        ck_assert_int_eq(gx_body_step(b, step, &q, NULL), GX_OK);
        CHECK_SEED(p.cg_iterations == q.cg_iterations && p.newton_iterations == q.newton_iterations && p.stop == q.stop,
                   seed);
        CHECK_SEED(p.energy == q.energy, seed);
        CHECK_SEED(gx_body_state_hash(a) == gx_body_state_hash(b), seed);
    }
}

/* Integrators, quality, materials, springs, contact, at a size for which multigrid is used. Some steps, a save or a
   clone in the middle, a cut and more steps. */
START_TEST(steps_go_on) {
    static const gxs_integrator integrators[4] = {GXS_BDF1, GXS_BDF2, GXS_MIDPOINT, GXS_STATIC};
    const uint64_t seed = (uint64_t)_i;
    const int by_quality = _i >= 16, variant = by_quality ? 1 : _i % 4, by_bytes = by_quality ? _i % 2 : _i / 4 % 2,
              custom_material = by_quality ? 0 : _i / 8;
    custom user = {1e5, 0};
    gx_material materials[2];
    workload w = grid(5, 5, 6, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL, *copy = NULL;
    gx_step_desc step;
    gxs_spring spring;
    gxs_plane plane;
    gxs_point point;
    uint32_t *of;
    size_t i;
    int k;
    random_seed(seed + 77);
    memset(materials, 0, sizeof materials);
    materials[0].elastic.young = 2e5;
    materials[0].elastic.poisson = 0.45;
    materials[0].density = 1000;
    materials[0].elastic.damping = 1e-3;
    materials[1] = materials[0];
    if (custom_material) {
        materials[1].elastic.kind = GXS_CUSTOM;
        materials[1].elastic.energy = custom_energy;
        materials[1].elastic.user = &user;
    }
    of = (uint32_t *)calloc(w.element_count, sizeof *of);
    for (i = 0; i < w.element_count; i++) of[i] = i % 7 == 0;
    desc.materials = materials;
    desc.material_count = 2;
    desc.element_materials = of;
    desc.support_below = 0.01;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    add_axis_plane(&w, 0, 2.4);
    add_axis_plane(&w, 1, 2.995);
    cut_by(body, &w, 0, 1);
    ck_assert_int_eq(hold_low(body, 0.5), GX_OK);
    shake(body, 0.02);
    memset(&step, 0, sizeof step);
    memset(&spring, 0, sizeof spring);
    memset(&plane, 0, sizeof plane);
    memset(&point, 0, sizeof point);
    step.dt = 0.01;
    step.gravity[0] = 3;
    step.gravity[2] = -9.81;
    step.integrator = integrators[variant];
    if (variant == 3) step.dt = 0;
    if (by_quality) step.quality = 0.03;
    spring.point.count = point.count = 4;
    for (k = 0; k < 4; k++) {
        spring.point.copy[k] = point.copy[k] = (uint32_t)(200 + k);
        spring.point.weight[k] = point.weight[k] = 0.25;
    }
    spring.point.epoch = point.epoch = view_of(body).epoch;
    spring.target[0] = 2;
    spring.target[1] = 1;
    spring.target[2] = 4;
    spring.stiffness = 1e3;
    plane.normal[2] = 1;
    plane.offset = -1;
    plane.stiffness = 1e4;
    plane.friction = 0.3;
    step.springs = &spring;
    step.spring_count = 1;
    step.planes = &plane;
    step.plane_count = 1;
    step.points = &point;
    step.point_count = 1;
    for (k = 0; k < 3; k++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    if (by_bytes) {
        bytes b = saved(body);
        if (custom_material) {
            gx_body_desc few = desc;
            gx_failure failure;
            ck_assert_int_eq(gx_body_load(b.data, b.size, NULL, &copy, &failure), GX_ERROR_ARGUMENT);
            ck_assert_pstr_eq(failure.field, "materials.elastic.energy");
            ck_assert_uint_eq(failure.index, 1);
            few.material_count = 1;
            ck_assert_int_eq(gx_body_load(b.data, b.size, &few, &copy, &failure), GX_ERROR_ARGUMENT);
            ck_assert_pstr_eq(failure.field, "materials.elastic.energy");
            few.material_count = 2;
            materials[1].elastic.energy = NULL;
            ck_assert_int_eq(gx_body_load(b.data, b.size, &few, &copy, &failure), GX_ERROR_ARGUMENT);
            ck_assert_pstr_eq(failure.field, "materials.elastic.energy");
            materials[1].elastic.energy = custom_energy;
            ck_assert_ptr_null(copy);
        }
        ck_assert_int_eq(gx_body_load(b.data, b.size, &desc, &copy, NULL), GX_OK);
        free(b.data);
    } else
        copy = clone_of(body);
    ck_assert(gx_body_state_hash(body) == gx_body_state_hash(copy));
    expect_same_steps(body, copy, &step, 4, seed);
    step.dt = variant == 3 ? 0 : 0.007;
    step.spring_count = 0;
    expect_same_steps(body, copy, &step, 3, seed);
    cut_by(body, &w, 1, 1);
    cut_by(copy, &w, 1, 1);
    step.spring_count = 1;
    spring.stiffness = 1e6;
    spring.point.epoch = point.epoch = view_of(body).epoch;
    ck_assert(view_of(copy).epoch == point.epoch);
    step.integrator = GXS_BDF1;
    step.dt = 0.01;
    expect_same_steps(body, copy, &step, 2, seed);
    ck_assert_int_eq(user.calls > 0, custom_material);
    free(of);
    gx_body_destroy(body);
    gx_body_destroy(copy);
    wl_free(&w);
}
END_TEST

/* Quick steps: some, a clone or a save in the middle, more, a usual step, a cut, and more. */
START_TEST(quick_steps_go_on) {
    workload w = grid(5, 5, 6, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL, *copy = NULL;
    gx_step_desc step;
    gx_step_report report;
    int k;
    random_seed((uint64_t)_i + 177);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -9.81;
    desc.young = 2e5;
    desc.support_below = 1e-9; /* no copy follows others */
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    add_axis_plane(&w, 0, 2.4);
    add_axis_plane(&w, 1, 2.6);
    cut_by(body, &w, 0, 1);
    ck_assert_int_eq(hold_low(body, 0.5), GX_OK);
    shake(body, 0.02);
    step.integrator = _i % 2 ? GXS_BDF2 : GXS_MIDPOINT;
    step.quick = 2;
    for (k = 0; k < 3; k++) ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.quick, 1);
    copy = twin_of(body, _i / 2);
    expect_same_steps(body, copy, &step, 4, (uint64_t)_i);
    step.quick = 0;
    expect_same_steps(body, copy, &step, 1, (uint64_t)_i);
    step.quick = 2;
    cut_by(body, &w, 1, 1);
    cut_by(copy, &w, 1, 1);
    expect_same_steps(body, copy, &step, 2, (uint64_t)_i);
    ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.quick, 1);
    gx_body_destroy(body);
    gx_body_destroy(copy);
    wl_free(&w);
}
END_TEST

/* A cut that no step has seen when the body is saved, or one between saving and the next step: what is loaded makes the
   solver's model anew, and so does the body. */
START_TEST(cut_beside_saving) {
    const int by_bytes = _i % 2, earlier = _i / 2 % 2, later = _i / 4;
    workload w = grid(4, 4, 4, 6);
    gx_body *body, *copy;
    gx_step_desc step;
    random_seed((uint64_t)_i + 5);
    body = body_of(&w);
    add_axis_plane(&w, 0, 2.4);
    add_axis_plane(&w, 1, 1.7);
    if (earlier) cut_by(body, &w, 0, 1);
    ck_assert_int_eq(hold_low(body, 0.5), GX_OK);
    shake(body, 0.02);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -9.81;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    if (!later) cut_by(body, &w, 1, 1);
    copy = twin_of(body, by_bytes);
    if (later) {
        cut_by(body, &w, 1, 1);
        cut_by(copy, &w, 1, 1);
    }
    expect_same_steps(body, copy, &step, 3, (uint64_t)_i);
    gx_body_destroy(body);
    gx_body_destroy(copy);
    wl_free(&w);
}
END_TEST

/* Saving, cloning or restoring wakes neither a body at rest nor its copy. */
START_TEST(sleepers_sleep_on) {
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w), *copy, *clone;
    gx_step_desc step;
    gx_step_report report;
    int i;
    ck_assert_int_eq(hold_low(body, 0.5), GX_OK);
    memset(&step, 0, sizeof step);
    step.dt = 0.1;
    step.gravity[2] = -9.81;
    step.sleep_speed = 1e-3;
    step.sleep_time = 0.3;
    memset(&report, 0, sizeof report);
    for (i = 0; i < 300 && report.stop != GXS_STOP_ASLEEP; i++)
        ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    copy = twin_of(body, 1);
    clone = clone_of(body);
    ck_assert_int_eq(gx_body_restore(clone, body, NULL), GX_OK);
    expect_same_steps(clone, copy, &step, 1, 0);
    ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    { /* the state of a sleeping copy is written: it wakes */
        gx_body *written = clone_of(body);
        gx_view view = view_of(written);
        view.velocity[3 * (view.copy_count - 1)] = 0.5;
        ck_assert_int_eq(gx_body_step(written, &step, &report, NULL), GX_OK);
        ck_assert_int_ne(report.stop, GXS_STOP_ASLEEP);
        gx_body_destroy(written);
    }
    step.gravity[0] = 1;
    ck_assert_int_eq(gx_body_step(copy, &step, &report, NULL), GX_OK);
    ck_assert_int_ne(report.stop, GXS_STOP_ASLEEP);
    gx_body_destroy(body);
    gx_body_destroy(copy);
    gx_body_destroy(clone);
    wl_free(&w);
}
END_TEST

/* ---- clones and restoring ---- */

/* Back to a clone after steps (the state alone), after cuts (everything), and after another hold; then the same
   steps as before */
START_TEST(rollback) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w = grid(3, 3, 3, 6);
    gx_body *body, *snapshot;
    gx_step_desc step;
    uint64_t before, after;
    int i, way;
    random_seed(seed);
    body = random_body(&w, 2, 1);
    ck_assert_int_eq(hold_low(body, 0.5), GX_OK);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -9.81;
    step.integrator = _i % 2 ? GXS_BDF2 : GXS_BDF1;
    for (i = 0; i < 2; i++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    view_of(body); /* what one has viewed is state, too */
    snapshot = clone_of(body);
    before = gx_body_state_hash(snapshot);
    CHECK_SEED(gx_body_state_hash(body) == before, seed);
    for (i = 0; i < 4; i++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    after = gx_body_state_hash(body);
    CHECK_SEED(after != before && gx_body_state_hash(snapshot) == before, seed);
    for (way = 0; way < 4; way++) {
        if (way == 1) cut_by(body, &w, w.surface_count - 1, 1);
        if (way == 2) ck_assert_int_eq(gx_body_hold(body, NULL, 0, NULL), GX_OK);
        if (way == 3) shake(body, 1);
        if (way == 1) view_of(body);
        ck_assert_int_eq(gx_body_restore(body, snapshot, NULL), GX_OK);
        CHECK_SEED(gx_body_state_hash(body) == before, seed);
        expect_equal_views(body, snapshot, seed);
        for (i = 0; i < 4; i++) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        ck_assert_msg(gx_body_state_hash(body) == after, "seed %llu, way %d: another end", (unsigned long long)seed,
                      way);
    }
    ck_assert_int_eq(gx_body_restore(snapshot, body, NULL), GX_OK); /* brought up to date: both continue alike */
    CHECK_SEED(gx_body_state_hash(snapshot) == after, seed);
    expect_same_steps(body, snapshot, &step, 3, seed);
    ck_assert_int_eq(gx_body_restore(body, body, NULL), GX_OK);
    expect_equal(body, snapshot, seed);
    gx_body_destroy(body);
    gx_body_destroy(snapshot);
    wl_free(&w);
}
END_TEST

/* Bodies of other meshes, materials or cuts with the same counts are not taken for the same. */
START_TEST(restoring_from_strangers) {
    workload w = grid(2, 1, 1, 5), v = grid(2, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *a, *b, *c = NULL;
    double p[3] = {0.5, 0.5, 0.5}, n[3] = {1, 0.1, 0.2};
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -1;
    add_plane(&w, p, n, 4);
    p[0] += 1e-9;
    add_plane(&v, p, n, 4);
    a = cut_at_once(&w);
    b = cut_at_once(&v);
    desc.young *= 2;
    ck_assert_int_eq(gx_body_create(&desc, &c, NULL), GX_OK);
    cut_by(c, &w, 0, 1);
    ck_assert(hash_of(a) == hash_of(b) && hash_of(a) == hash_of(c));
    shake(b, 0.1);
    shake(c, 0.1);
    ck_assert_int_eq(gx_body_restore(a, b, NULL), GX_OK);
    expect_equal(a, b, 0);
    expect_same_steps(a, b, &step, 2, 0);
    ck_assert_int_eq(gx_body_restore(a, c, NULL), GX_OK);
    expect_equal(a, c, 0);
    expect_same_steps(a, c, &step, 2, 1);
    gx_body_destroy(a);
    gx_body_destroy(b);
    gx_body_destroy(c);
    wl_free(&w);
    wl_free(&v);
}
END_TEST

/* ... nor bodies of which one number of one material, or one held region, is another: their own state is restored,
   and they move as before. */
START_TEST(restoring_from_near_strangers) {
    enum { OTHERS = 13 };
    custom user = {1e5, 0}, other_user = {1e5, 0};
    workload w = grid(2, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_material materials[2];
    gx_region regions[2] = {gx_region_half_space(2, -1, 0.5), gx_region_half_space(0, -1, 0.5)};
    gx_body *bodies[OTHERS + 1];
    gx_step_desc step;
    uint32_t of[16];
    int i, j;
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -1;
    for (i = 0; i < 16; i++) of[i] = (uint32_t)i % 2;
    for (i = 0; i <= OTHERS; i++) {
        gx_body *body = NULL;
        memset(materials, 0, sizeof materials);
        for (j = 0; j < 2; j++) {
            materials[j].elastic.young = 1e5;
            materials[j].elastic.poisson = 0.25;
            materials[j].density = 1000;
        }
        materials[0].elastic.kind = GXS_CUSTOM;
        materials[0].elastic.energy = custom_energy;
        materials[0].elastic.user = i == 11 ? &other_user : &user;
        if (i == 1) materials[1].elastic.kind = GXS_LINEAR;
        if (i == 2) materials[1].elastic.young *= 2;
        if (i == 3) materials[1].elastic.poisson *= 1.5;
        if (i == 4) materials[1].elastic.damping = 1e-3;
        if (i == 5) materials[1].density *= 2;
        if (i == 6) materials[0].elastic.young *= 2;
        if (i == 12) materials[0].elastic.energy = other_energy;
        regions[0].value = i == 13 ? 0.75 : 0.5;
        regions[1].axis = i == 7 ? 1 : 0;
        regions[1].side = i == 8 ? 1 : -1;
        regions[1].value = i == 9 ? 1.5 : 0.5;
        desc.materials = materials;
        desc.material_count = i == 10 ? 1 : 2;
        desc.element_materials = i == 10 ? NULL : of;
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        ck_assert_int_eq(gx_body_hold(body, regions, i == 10 ? 1 : 2, NULL), GX_OK);
        bodies[i] = body;
    }
    for (i = 1; i <= OTHERS; i++) {
        gx_body *clone = clone_of(bodies[0]);
        shake(bodies[i], 0.01);
        ck_assert_int_eq(gx_body_step(clone, &step, NULL, NULL), GX_OK); /* with a solver of its own materials */
        ck_assert_int_eq(gx_body_restore(clone, bodies[i], NULL), GX_OK);
        expect_equal(clone, bodies[i], (uint64_t)i);
        expect_same_steps(clone, bodies[i], &step, 2, (uint64_t)i);
        gx_body_destroy(clone);
    }
    ck_assert(user.calls > 0 && other_user.calls > 0);
    for (i = 0; i <= OTHERS; i++) gx_body_destroy(bodies[i]);
    wl_free(&w);
}
END_TEST

/* Between bodies that hold other regions, nodes or anchors, of the same counts and of others: their own are held. */
START_TEST(restoring_what_is_held) {
    enum { SETS = 8 };
    static const uint32_t nodes[3][2] = {{0, 1}, {0, 2}, {1, 2}}, three[3] = {0, 1, 2};
    workload w = grid(2, 1, 1, 6);
    gx_body *bodies[SETS];
    gx_step_desc step;
    int i, j;
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -1;
    for (i = 0; i < SETS; i++) {
        gx_region regions[2] = {gx_region_half_space(2, -1, 0.5), gx_region_half_space(0, -1, 0.5)};
        gx_anchor anchors[2];
        bodies[i] = body_of(&w);
        for (j = 0; j < 2; j++) { /* near a node of the first element */
            double x[3] = {0, 0, 0};
            int n, k;
            for (n = 0; n < 4; n++)
                for (k = 0; k < 3; k++)
                    x[k] += w.positions[3 * w.elements[n] + (size_t)k] * (n == (j == 0 ? 0 : i % 2 + 1) ? 0.7 : 0.1);
            ck_assert_int_eq(gx_body_anchor(bodies[i], 0, x, &anchors[j], NULL), GX_OK);
        }
        if (i >= 2) memset(regions, 0, sizeof regions);
        if (i >= 2) regions[0].kind = i < 5 ? GX_REGION_NODES : GX_REGION_ANCHORS;
        if (i >= 2 && i < 5) {
            regions[0].nodes = i == 4 ? three : nodes[i - 2];
            regions[0].node_count = i == 4 ? 3 : 2;
        } else if (i >= 5) {
            regions[0].anchors = anchors;
            regions[0].anchor_count = 2;
        }
        ck_assert_int_eq(gx_body_hold(bodies[i], regions, i == 7 ? 0 : i == 1 ? 2 : 1, NULL), GX_OK);
        shake(bodies[i], 0.01);
    }
    for (i = 0; i < SETS; i++)
        for (j = 0; j < SETS; j++) {
            gx_body *clone = clone_of(bodies[i]), *goal = clone_of(bodies[j]);
            shake(clone, 0.01);
            ck_assert_int_eq(gx_body_step(clone, &step, NULL, NULL), GX_OK);
            ck_assert_int_eq(gx_body_restore(clone, goal, NULL), GX_OK);
            expect_equal(clone, goal, (uint64_t)(SETS * i + j));
            expect_same_steps(clone, goal, &step, 2, (uint64_t)(SETS * i + j));
            gx_body_destroy(clone);
            gx_body_destroy(goal);
        }
    for (i = 0; i < SETS; i++) gx_body_destroy(bodies[i]);
    wl_free(&w);
}
END_TEST

/* The fragments that a view has reported as removed, and what it said of the others, go with the body. */
START_TEST(removed_fragments_are_kept) {
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w), *twin;
    gx_view view;
    uint32_t gone;
    int by_bytes;
    add_axis_plane(&w, 0, 0.7);
    {
        static const double low[3] = {-1, -1, -1}, high[3] = {0.8, 2, 2};
        wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    }
    cut_by(body, &w, 0, 1);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    gone = view.fragment_id[view.fragment_center[0] < view.fragment_center[3] ? 0 : 1];
    cut_by(body, &w, 1, 1);
    view = view_of(body);
    ck_assert(view.fragment_count == 1 && view.removed_count == 1 && view.removed_ids[0] == gone);
    for (by_bytes = 0; by_bytes < 2; by_bytes++) {
        twin = twin_of(body, by_bytes);
        ck_assert_uint_eq(twin->snapshot.removed.count, 1);
        ck_assert_uint_eq(twin->snapshot.removed.data[0], gone);
        expect_equal(body, twin, 0);
        gx_body_destroy(twin);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Bodies with the same cuts have the same epoch, whatever their history; others have others. */
START_TEST(epochs_go_with_the_copies) {
    workload w = grid(2, 2, 1, 5);
    gx_body *body = body_of(&w), *twin, *clone;
    uint64_t first, second;
    int by_bytes;
    add_axis_plane(&w, 0, 0.7);
    add_axis_plane(&w, 1, 1.3);
    add_axis_plane(&w, 0, 40);
    for (by_bytes = 0; by_bytes < 2; by_bytes++) {
        twin = twin_of(body, by_bytes);
        ck_assert(view_of(twin).epoch == 0);
        gx_body_destroy(twin);
    }
    cut_by(body, &w, 0, 1);
    cut_by(body, &w, 2, 1); /* the epoch is not that of the last cut */
    first = view_of(body).epoch;
    ck_assert(first != 0 && first != body->cuts.hash);
    clone = clone_of(body);
    for (by_bytes = 0; by_bytes < 2; by_bytes++) {
        twin = twin_of(body, by_bytes);
        ck_assert(view_of(twin).epoch == first);
        cut_by(twin, &w, 1, 1);
        cut_by(body, &w, 1, 1);
        second = view_of(body).epoch;
        ck_assert(second != first && view_of(twin).epoch == second);
        ck_assert_int_eq(gx_body_restore(twin, clone, NULL), GX_OK);
        ck_assert(view_of(twin).epoch == first);
        cut_by(twin, &w, 0, 1); /* nothing new: the same place again */
        ck_assert(view_of(twin).epoch == first);
        gx_body_destroy(twin);
        ck_assert_int_eq(gx_body_restore(body, clone, NULL), GX_OK);
    }
    twin = body_of(&w);
    cut_by(twin, &w, 1, 1);
    ck_assert(view_of(twin).copy_count != 0 && view_of(twin).epoch != first);
    gx_body_destroy(twin);
    gx_body_destroy(clone);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A copy shares nothing with the body and outlives it. */
START_TEST(copies_stand_alone) {
    workload w = grid(2, 2, 1, 5);
    gx_body *body, *copy, *clone;
    random_seed(5);
    body = random_body(&w, 3, 1);
    copy = twin_of(body, 1);
    clone = clone_of(body);
    gx_body_destroy(body);
    expect_equal(copy, clone, 5);
    cut_by(copy, &w, w.surface_count - 1, 1);
    cut_by(clone, &w, w.surface_count - 1, 1);
    expect_equal(copy, clone, 5);
    gx_body_destroy(copy);
    gx_body_destroy(clone);
    wl_free(&w);
}
END_TEST

/* ---- errors ---- */

START_TEST(arguments) {
    workload w = wl_through(0.1);
    gx_body *body = cut_at_once(&w), *other = NULL;
    bytes b = saved(body);
    gx_body_desc desc;
    gx_failure failure;
    size_t size = 0;
    const uint64_t state = gx_body_state_hash(body);
    ck_assert_int_eq(gx_body_save(NULL, NULL, 0, &size, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_save(body, b.data, b.size, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_save(body, b.data, b.size - 1, &size, NULL), GX_ERROR_CAPACITY);
    ck_assert_uint_eq(size, b.size);
    ck_assert_int_eq(gx_body_load(NULL, b.size, NULL, &other, &failure), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(failure.result, GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_load(b.data, b.size, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    memset(&desc, 0, sizeof desc);
    desc.allocator.allocate = (void *(*)(void *, size_t))(size_t)1;
    ck_assert_int_eq(gx_body_load(b.data, b.size, &desc, &other, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_clone(NULL, &other, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_clone(body, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_restore(NULL, body, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_restore(body, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_ptr_null(other);
    ck_assert(gx_body_state_hash(body) == state);
    free(b.data);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Magic, version, byte order, kind of double: not a body's bytes. */
START_TEST(foreign_bytes) {
    workload w = wl_through(0.1);
    gx_body *body = cut_at_once(&w), *other = NULL;
    bytes b = saved(body);
    size_t i;
    for (i = 0; i < 24; i++) {
        b.data[i] ^= 0x55;
        ck_assert_int_eq(gx_body_load(b.data, b.size, NULL, &other, NULL), GX_ERROR_FORMAT);
        b.data[i] ^= 0x55;
    }
    { /* older versions, and one yet to come */
        uint32_t version, now;
        memcpy(&now, b.data + 8, sizeof now);
        ck_assert_uint_eq(now, 13);
        for (version = 0; version <= now; version++) {
            const uint32_t wrong = version < now ? version : now + 1;
            memcpy(b.data + 8, &wrong, sizeof wrong);
            ck_assert_int_eq(gx_body_load(b.data, b.size, NULL, &other, NULL), GX_ERROR_FORMAT);
        }
    }
    memset(b.data, 0, b.size);
    ck_assert_int_eq(gx_body_load(b.data, b.size, NULL, &other, NULL), GX_ERROR_FORMAT);
    ck_assert_ptr_null(other);
    free(b.data);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- damage ---- */

enum { HEAD_BYTES = 40, AT_SIZE = 24, AT_CHECKSUM = 32 };

/* changes have been viewed; elements share only an edge, part of which is a wall */
enum { SEEN = 1, PINCHED = 2 };

/* A small body with a bit of everything: sheets, a partial one, a solid, held copies, history */
static gx_body *small_body(workload *w, int variant) {
    gx_body *body;
    gx_step_desc step;
    double p[3] = {0.2, 0.2, 0.2}, n[3] = {1, 0.3, 0.2};
    wl_surface *s;
    *w = wl_empty();
    wl_add_node(w, 0, 0, 0);
    wl_add_node(w, 1, 0, 0);
    wl_add_node(w, 0, 1, 0);
    wl_add_node(w, 0, 0, 1);
    wl_add_node(w, 1, 1, 1);
    wl_add_element(w, 0, 1, 2, 3);
    if (variant & PINCHED) {
        wl_add_node(w, 1.2, 1, 0.2);
        wl_add_element(w, 1, 2, 4, 5);
    } else
        wl_add_element(w, 4, 1, 2, 3);
    add_plane(w, p, n, 3);
    s = wl_add_surface(w, 0);
    p[0] = 0.5;
    p[1] = 0.1;
    p[2] = 0.1;
    wl_add_vertex(s, p);
    p[1] = 0.3;
    wl_add_vertex(s, p);
    p[2] = 0.4;
    p[0] = 0.4;
    wl_add_vertex(s, p);
    wl_add_triangle(s, 0, 1, 2);
    add_box(w, 1, -1, -1, 0.6, 0.3, 0.3, 2);
    n[0] = -0.2;
    p[0] = p[1] = p[2] = 0.4;
    add_plane(w, p, n, 3);
    s = wl_add_surface(w, 0);
    p[0] = 0.7;
    p[1] = 0.3;
    p[2] = -1;
    wl_add_vertex(s, p);
    p[0] = 0.3;
    p[1] = 0.7;
    wl_add_vertex(s, p);
    p[0] = p[1] = 0.5;
    p[2] = 1;
    wl_add_vertex(s, p);
    wl_add_triangle(s, 0, 1, 2);
    body = body_of(w);
    cut_textured(body, w, 0, 1);
    cut_by(body, w, 4, 1);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.gravity[2] = -9.81;
    step.integrator = GXS_BDF2;
    hold_all(body, 0.1);
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
    view_of(body);
    cut_by(body, w, 1, 2);
    if (variant & SEEN) view_of(body);
    return body;
}

/* Damage with a checksum that fits */
static void seal(bytes b) {
    const uint64_t size = b.size, checksum = gxp_hash_bytes(0, b.data + HEAD_BYTES, b.size - HEAD_BYTES);
    memcpy(b.data + AT_SIZE, &size, sizeof size);
    memcpy(b.data + AT_CHECKSUM, &checksum, sizeof checksum);
}

/* A loaded body is used in every way; errors are fine. */
static void use(gx_body *body, const workload *w) {
    const gx_region region = gx_region_half_space(0, 1, 0.3);
    static const double origin[3] = {0.2, 0.2, -3}, direction[3] = {0, 0.01, 1};
    gx_surface surface = surface_of(&w->surfaces[3]);
    gx_cut_desc cut;
    gx_step_desc step;
    gx_view view;
    gx_skin skin;
    gx_hit hit;
    gx_motion motions[64];
    gx_body *clone = NULL;
    size_t size;
    memset(&cut, 0, sizeof cut);
    memset(&step, 0, sizeof step);
    step.dt = 0.01;
    step.integrator = GXS_BDF2;
    step.cg_iterations = 20;
    step.sleep_speed = 1e-3;
    cut.surfaces = &surface;
    cut.surface_count = 1;
    cut.sever_below = 1e-3;
    (void)gx_body_view(body, &view, NULL);
    (void)gx_body_step(body, &step, NULL, NULL);
    (void)gx_body_topology_hash(body, NULL);
    (void)gx_body_cut(body, &cut, NULL, NULL);
    surface = surface_of(&w->surfaces[2]);
    (void)gx_body_cut(body, &cut, NULL, NULL);
    (void)gx_body_hold(body, &region, 1, NULL);
    if (gx_body_view(body, &view, NULL) == GX_OK && view.fragment_count > 0)
        ck_assert_uint_lt(view.cell_fragment[view.cell_count - 1], view.fragment_count);
    (void)gx_body_skin(body, NULL, &skin, NULL);
    (void)gx_body_pick(body, origin, direction, &hit, NULL);
    (void)gx_body_motion(body, motions, 64, NULL);
    (void)gx_body_step(body, &step, NULL, NULL);
    (void)gx_body_save(body, NULL, 0, &size, NULL);
    if (gx_body_clone(body, &clone, NULL) == GX_OK) gx_body_destroy(clone);
}

/* Loads; returns whether that succeeded. */
static int try_bytes(bytes b, const workload *w, const char *what, size_t at) {
    gx_body *body = NULL;
    gx_failure failure;
    const gx_result result = gx_body_load(b.data, b.size, NULL, &body, &failure);
    ck_assert_msg(result == GX_OK || result == GX_ERROR_FORMAT || result == GX_ERROR_DAMAGED ||
                      result == GX_ERROR_LIMIT || result == GX_ERROR_ARGUMENT,
                  "%s at %zu: %s", what, at, gx_result_text(result));
    ck_assert_msg((result == GX_OK) == (body != NULL) && failure.result == result, "%s at %zu", what, at);
    if (body != NULL) use(body, w);
    gx_body_destroy(body);
    return result == GX_OK;
}

/* Every byte changed, every length: with the old checksum nothing passes. */
START_TEST(damage_is_seen) {
    workload w;
    gx_body *body = small_body(&w, SEEN);
    bytes b = saved(body), part;
    size_t i;
    for (i = 0; i < b.size; i++) {
        b.data[i] ^= (unsigned char)(1u << i % 8);
        ck_assert_msg(!try_bytes(b, &w, "a flipped bit", i), "a flipped bit at %zu is not seen", i);
        b.data[i] ^= (unsigned char)(1u << i % 8);
    }
    for (i = 0; i < b.size; i++) {
        part.data = (unsigned char *)malloc(i + 1); /* so that a sanitizer sees reads beyond it */
        part.size = i;
        memcpy(part.data, b.data, i);
        ck_assert_msg(!try_bytes(part, &w, "cut short", i), "that it is cut short at %zu is not seen", i);
        if (i >= HEAD_BYTES) {
            seal(part);
            ck_assert_msg(!try_bytes(part, &w, "cut short and sealed", i), "that it is cut short at %zu is not seen",
                          i);
        }
        free(part.data);
    }
    ck_assert(try_bytes(b, &w, "as it was", 0));
    free(b.data);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Impossible bodies are damage: a density that makes elements too heavy, a cell larger than its element. */
START_TEST(damage_beyond_the_range) {
    workload w;
    gx_body *body = small_body(&w, SEEN), *other = NULL;
    bytes b = saved(body);
    double right[3], wrong[3] = {1e300, 1e308, 1e308};
    size_t i, k, found[3] = {0, 0, 0};
    right[0] = body->mesh.materials[0].density;
    right[1] = body->cells.data[0].volume;
    right[2] = body->cells.data[0].mass[0];
    for (i = HEAD_BYTES; i + 8 <= b.size; i++)
        for (k = 0; k < 3; k++) {
            if (memcmp(b.data + i, &right[k], 8) != 0) continue;
            memcpy(b.data + i, &wrong[k], 8);
            seal(b);
            ck_assert_int_eq(gx_body_load(b.data, b.size, NULL, &other, NULL), GX_ERROR_DAMAGED);
            memcpy(b.data + i, &right[k], 8);
            found[k]++;
        }
    for (k = 0; k < 3; k++) ck_assert_uint_eq(found[k], 1);
    seal(b);
    ck_assert(try_bytes(b, &w, "as it was", 0));
    free(b.data);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A bit of every third byte is flipped, each time another one, and the checksum is corrected: an error, or a body that
   can be used. */
START_TEST(hostile_bits) {
    workload w;
    gx_body *body = small_body(&w, _i % 4);
    bytes b = saved(body);
    size_t i, passed = 0;
    for (i = HEAD_BYTES + (size_t)_i % 3; i < b.size; i += 3 * FEWER * FEWER) {
        const unsigned char flip = (unsigned char)(1u << (3 * i + 2 * (size_t)_i) % 8);
        b.data[i] ^= flip;
        seal(b);
        passed += (size_t)try_bytes(b, &w, "a bit", i);
        b.data[i] ^= flip;
    }
    ck_assert_uint_gt(passed, 0); /* coordinates, velocities */
    ck_assert_uint_lt(passed, b.size - HEAD_BYTES);
    free(b.data);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Every other word is replaced by typical indices and counts. */
START_TEST(hostile_words) {
    static const uint32_t values[6] = {0, 1, UINT32_MAX, 0x7fffffff, 0x80000000u, 3};
    workload w;
    gx_body *body = small_body(&w, _i % 2 ? PINCHED : SEEN);
    bytes b = saved(body);
    size_t i;
    for (i = HEAD_BYTES + 4 * ((size_t)_i / 2 % 2); i + 4 <= b.size; i += 8 * FEWER) {
        uint32_t word, changed;
        memcpy(&word, b.data + i, 4);
        changed = _i / 2 < 6 ? values[_i / 2] : _i / 2 == 6 ? word + 1 : word - 1;
        memcpy(b.data + i, &changed, 4);
        seal(b);
        (void)try_bytes(b, &w, "a word", i);
        memcpy(b.data + i, &word, 4);
    }
    free(b.data);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Words swapped, copied over each other and drawn from small numbers, a few at once */
START_TEST(hostile_mixtures) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w;
    gx_body *body = small_body(&w, _i % 4);
    bytes b = saved(body), m;
    int round, k;
    random_seed(seed);
    m.data = (unsigned char *)malloc(b.size);
    m.size = b.size;
    for (round = 0; round < 1000 / FEWER; round++) {
        const int words = (int)((b.size - HEAD_BYTES) / 4);
        memcpy(m.data, b.data, b.size);
        for (k = 1 + random_below(3); k > 0; k--) {
            const size_t from = HEAD_BYTES + 4 * (size_t)random_below(words),
                         to = HEAD_BYTES + 4 * (size_t)random_below(words);
            uint32_t p, q, small = (uint32_t)random_below(40);
            memcpy(&p, m.data + from, 4);
            memcpy(&q, m.data + to, 4);
            if (random_below(2)) {
                memcpy(m.data + from, &small, 4);
                continue;
            }
            memcpy(m.data + to, &p, 4);
            if (random_below(2)) memcpy(m.data + from, &q, 4);
        }
        seal(m);
        (void)try_bytes(m, &w, "a mixture", (size_t)round);
    }
    free(b.data);
    free(m.data);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- blades ---- */

static gx_result move_across(gx_blade *blade, double y) {
    const double edge[6] = {-9, y, 0.2, 9, y + 0.1, 0.25};
    return gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL);
}

/* A body with a blade that has cut a part of it; behind that, what waits to be cut */
static gx_body *body_with_blade(workload *w) {
    gx_body *body = small_body(w, SEEN);
    gx_blade_desc desc;
    gx_blade *blade = NULL;
    int i;
    memset(&desc, 0, sizeof desc);
    desc.min_advance = 0.1;
    ck_assert_int_eq(gx_blade_create(body, &desc, &blade, NULL), GX_OK);
    for (i = 0; i < 12; i++) ck_assert_int_eq(move_across(blade, -0.3 + 0.06 * i), GX_OK);
    ck_assert(blade->now.vertices.count > 0 && blade->now.points.count > 0 && blade->now.members.count > 1);
    ck_assert(blade->now.layers.count > 0 && blade->now.layers.data[0].front_count > 0);
    return body;
}

/* Saves the body as it is, with a number that cannot be; puts it right again. */
static void expect_damage(gx_body *body, void *at, const void *wrong, size_t size, const char *what) {
    unsigned char right[16];
    bytes b;
    gx_body *other = NULL;
    gx_result result;
    memcpy(right, at, size);
    memcpy(at, wrong, size);
    b = saved(body);
    memcpy(at, right, size);
    result = gx_body_load(b.data, b.size, NULL, &other, NULL);
    ck_assert_msg(result == GX_ERROR_DAMAGED && other == NULL, "%s: %s", what, gx_result_text(result));
    free(b.data);
}
static void expect_bad_number(gx_body *body, double *at, double wrong, const char *what) {
    expect_damage(body, at, &wrong, sizeof wrong, what);
}
static void expect_bad_word(gx_body *body, uint32_t *at, uint32_t wrong, const char *what) {
    expect_damage(body, at, &wrong, sizeof wrong, what);
}

/* What leads from a node of the division tree to the parts of its facet is checked. */
START_TEST(damaged_facets) {
    workload w = wl_through(0.1);
    gx_body *body = cut_at_once(&w);
    gxb_complex *cx = body->complex;
    uint32_t i, parted = 0;
    for (i = 0; i < cx->tree_count && parted < 8; i++) {
        gxb_node *n = &cx->nodes[i];
        gxb_facet *f = &cx->facets[n->facet];
        ck_assert_uint_lt(n->facet, cx->facet_count);
        ck_assert_uint_eq(f->plane, n->plane);
        if (f->child == GXB_NONE) continue;
        parted++;
        expect_bad_word(body, &n->facet, cx->facet_count, "a facet that is not");
        expect_bad_word(body, &n->facet, f->child, "a part for the whole");
        expect_bad_word(body, &n->facet, cx->nodes[i == 0 ? 1 : 0].facet, "another node's facet");
        expect_bad_word(body, &n->facet, cx->face_facet[cx->element_faces[4 * (size_t)cx->leaves[f->leaf[0]].element]],
                        "a facet of a face");
        expect_bad_word(body, &f->loop, cx->store.plane_count, "a plane that is not");
        expect_bad_word(body, &f->loop, f->plane, "a plane that divides nothing");
        expect_bad_word(body, &f->loop, cx->facets[cx->face_facet[0]].plane, "a plane that did not divide it");
    }
    ck_assert_uint_gt(parted, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Each number that a move relies on is checked when a blade is loaded. */
START_TEST(damaged_blades) {
    workload w;
    gx_body *body = body_with_blade(&w), *twin;
    gx_blade *blade = body->blades;
    gxp_blade_state *now = &blade->now;
    gxp_front_vertex *v = &now->vertices.data[now->vertices.count / 2];
    gxp_layer *layer = &now->layers.data[0];
    double *const places[6] = {v->rest, v->extended, v->position, v->foot, v->foot_at, v->ahead};
    double *const sizes[3] = {&v->along, &v->distance, &v->size}, *const lengths[2] = {&blade->tolerance,
                                                                                       &blade->min_advance};
    uint32_t *const counts[5] = {&layer->front_count, &layer->latest_count, &layer->seen_count, &layer->path_count,
                                 &layer->sheet_count},
                    *const firsts[5] = {&layer->front, &layer->latest, &layer->seen, &layer->path, &layer->sheet};
    uint64_t key;
    int i, k;
    for (i = 0; i < 6; i++)
        for (k = 0; k < 3; k++) expect_bad_number(body, places[i] + k, k == 1 ? NAN : HUGE_VAL, "a place");
    for (i = 0; i < 3; i++) expect_bad_number(body, sizes[i], -1, "a place's size");
    for (i = 0; i < 3; i++) expect_bad_number(body, sizes[i], NAN, "a place's size");
    expect_bad_number(body, &v->along, 1e10, "a place on the edge");
    expect_bad_number(body, &v->size, HUGE_VAL, "a place's size");
    expect_bad_word(body, &v->element, body->mesh.element_count, "an element");
    for (i = 0; i < 2; i++)
        for (k = 0; k < 4; k++)
            expect_bad_number(body, lengths[i], k == 0 ? 0 : k == 1 ? -1 : k == 2 ? NAN : HUGE_VAL, "a length");
    expect_bad_number(body, &now->points.data[4], NAN, "a point");
    expect_bad_number(body, &now->edge.data[2], HUGE_VAL, "the edge");
    for (i = 0; i < 5; i++) {
        const uint32_t all = i < 3 ? now->vertices.count : now->points.count;
        expect_bad_word(body, firsts[i], all + 1, "a list's begin");
        expect_bad_word(body, counts[i], all - *firsts[i] + 1, "a list's length");
        expect_bad_word(body, counts[i], UINT32_MAX, "a list's length");
        if (i < 2) expect_bad_word(body, counts[i], 1, "a front of one place");
    }
    expect_bad_word(body, &now->edge.count, 1, "an edge of one point");
    expect_bad_word(body, &now->slot_count, body->slots.count + 1, "slots");
    key = now->members.data[1];
    expect_damage(body, &now->members.data[0], &key, sizeof key, "cells in two layers");
    key = (uint64_t)now->slot_count << 32;
    expect_damage(body, &now->members.data[now->members.count - 1], &key, sizeof key, "a cell that is not");
    key = now->members.data[0] | UINT32_MAX;
    expect_damage(body, &now->members.data[0], &key, sizeof key, "a layer that is not");
    twin = twin_of(body, 1); /* all is right again */
    for (i = 0; i < 16; i++) {
        ck_assert_int_eq(move_across(blade, 0.4 + 0.06 * i), GX_OK);
        ck_assert_int_eq(move_across(twin->blades, 0.4 + 0.06 * i), GX_OK);
        ck_assert(gx_body_state_hash(body) == gx_body_state_hash(twin));
    }
    gx_body_destroy(body);
    gx_body_destroy(twin);
    wl_free(&w);
}
END_TEST

/* So is what it needs to leave out moves. */
START_TEST(damaged_glances) {
    workload w;
    gx_body *body = body_with_blade(&w);
    gx_blade *blade = body->blades, *second = NULL;
    gxp_glance *g = &blade->now.glance;
    gx_blade_desc desc;
    double *const lengths[3] = {&g->travelled, &g->room, &g->course};
    int i, k;
    for (i = 0; i < 40 && !(g->ready && g->edge.count > 0 && g->beads.count > 0); i++)
        ck_assert_int_eq(move_across(blade, 0.36 + 1e-4 * i), GX_OK);
    ck_assert(g->ready && g->edge.count > 0 && g->beads.count > 0 && g->cut == body->cuts.hash);
    expect_bad_word(body, &g->ready, 2, "neither ready nor not");
    expect_bad_word(body, &g->ready, 0, "an edge of a blade that is not ready");
    expect_bad_word(body, &g->edge.count, g->edge.count - 1, "an edge with a point less");
    expect_bad_number(body, &g->edge.data[1], NAN, "an edge");
    for (i = 0; i < 3; i++)
        for (k = 0; k < 2; k++) expect_bad_number(body, lengths[i], k == 0 ? -1 : NAN, "a length");
    expect_bad_number(body, &g->beads.data[0].along, -1, "a bead on the edge");
    expect_bad_number(body, &g->beads.data[0].along, 1e10, "a bead on the edge");
    expect_bad_word(body, &g->beads.data[0].cell, body->cells.count, "a bead's cell");
    memset(&desc, 0, sizeof desc);
    ck_assert_int_eq(gx_blade_create(body, &desc, &second, NULL), GX_OK);
    expect_bad_word(body, &second->now.glance.ready, 1, "two blades that are ready");
    gx_blade_destroy(blade);
    expect_bad_word(body, &second->now.glance.ready, 1, "a lifted blade that is ready");
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Bits and words of what a blade remembers are changed at random: an error, or a blade that can be moved and lifted. */
START_TEST(hostile_blades) {
    workload w;
    gx_body *body = body_with_blade(&w), *without;
    bytes b = saved(body), shorter;
    size_t first, passed = 0;
    int round;
    random_seed((uint64_t)_i + 1);
    without = twin_of(body, 1);
    gx_blade_destroy(without->blades);
    shorter = saved(without);
    first = shorter.size; /* blades come last */
    ck_assert_uint_lt(first, b.size);
    for (round = 0; round < 600 / FEWER; round++) {
        const size_t at = first + 4 * (size_t)random_below((int)((b.size - first) / 4));
        uint32_t word, changed;
        gx_body *other = NULL;
        gx_result result;
        memcpy(&word, b.data + at, 4);
        changed = random_below(2) ? word ^ 1u << random_below(32) : (uint32_t)random_below(40);
        memcpy(b.data + at, &changed, 4);
        seal(b);
        result = gx_body_load(b.data, b.size, NULL, &other, NULL);
        ck_assert_msg(result == GX_OK || result == GX_ERROR_DAMAGED, "a word at %zu: %s", at, gx_result_text(result));
        if (result == GX_OK) {
            gx_blade *blade = gx_body_blade(other, 0);
            gx_blade_contact contacts[8];
            size_t count;
            passed++;
            (void)gx_blade_contacts(blade, contacts, 8, &count, NULL);
            (void)move_across(blade, 0.4);
            (void)move_across(blade, 0.5);
            (void)gx_blade_lift(blade, NULL, NULL);
        }
        gx_body_destroy(other);
        memcpy(b.data + at, &word, 4);
    }
    ck_assert_uint_gt(passed, 0);
    free(b.data);
    free(shorter.data);
    gx_body_destroy(body);
    gx_body_destroy(without);
    wl_free(&w);
}
END_TEST

/* A body has as many blades as the one that it becomes, or more: those are lifted. */
START_TEST(restoring_blades) {
    workload w;
    gx_body *body = body_with_blade(&w), *bare = NULL, *two;
    gx_blade *blade = NULL, *second = NULL;
    const uint64_t state = gx_body_state_hash(body);
    int i;
    bare = twin_of(body, 1);
    gx_blade_destroy(gx_body_blade(bare, 0));
    two = clone_of(bare);
    ck_assert_int_eq(gx_blade_create(two, NULL, &blade, NULL), GX_OK);
    ck_assert_int_eq(gx_blade_create(two, NULL, &second, NULL), GX_OK);
    for (i = 0; i < 4; i++) ck_assert_int_eq(move_across(second, -0.3 + 0.2 * i), GX_OK);
    ck_assert_int_eq(gx_body_restore(bare, body, NULL), GX_OK);
    ck_assert(gx_body_blade(bare, 0) != NULL && gx_body_blade(bare, 1) == NULL);
    ck_assert(gx_body_state_hash(bare) == state);
    ck_assert_int_eq(gx_body_restore(two, body, NULL), GX_OK);
    ck_assert(gx_body_blade(two, 0) == blade && gx_body_blade(two, 1) == second);
    for (i = 0; i < 16; i++) {
        const double y = 0.4 + 0.06 * i;
        ck_assert_int_eq(move_across(gx_body_blade(body, 0), y), GX_OK);
        ck_assert_int_eq(move_across(gx_body_blade(bare, 0), y), GX_OK);
        ck_assert_int_eq(move_across(blade, y), GX_OK);
        ck_assert(hash_of(bare) == hash_of(body) && hash_of(two) == hash_of(body));
        ck_assert(gx_body_state_hash(bare) == gx_body_state_hash(body));
    }
    ck_assert_uint_eq(second->now.edge.count, 0);
    ck_assert_int_eq(move_across(second, -0.3), GX_OK); /* begins anew: cuts nothing on the way */
    ck_assert(hash_of(two) == hash_of(body));
    gx_body_destroy(body);
    gx_body_destroy(bare);
    gx_body_destroy(two);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("save");
    TCase *tests = tcase_create("save"), *blades = tcase_create("blades");
    tcase_set_timeout(tests, 240);
    tcase_set_timeout(blades, 240);
    tcase_add_loop_test(tests, random_bodies, 0, 80 / FEWER);
    tcase_add_loop_test(tests, many_triangles_in_an_element, 0, 3);
    tcase_add_loop_test(tests, far_and_small_bodies, 0, 6);
    tcase_add_loop_test(tests, pinched_bodies, 0, 2);
    tcase_add_loop_test(tests, steps_go_on, 0, 18);
    tcase_add_loop_test(tests, quick_steps_go_on, 0, 4);
    tcase_add_loop_test(tests, cut_beside_saving, 0, 8);
    tcase_add_test(tests, sleepers_sleep_on);
    tcase_add_loop_test(tests, rollback, 0, 4);
    tcase_add_test(tests, restoring_from_strangers);
    tcase_add_test(tests, restoring_from_near_strangers);
    tcase_add_test(tests, restoring_what_is_held);
    tcase_add_test(tests, removed_fragments_are_kept);
    tcase_add_test(tests, epochs_go_with_the_copies);
    tcase_add_test(tests, copies_stand_alone);
    tcase_add_test(tests, arguments);
    tcase_add_test(tests, foreign_bytes);
    tcase_add_test(tests, damage_is_seen);
    tcase_add_test(tests, damage_beyond_the_range);
    tcase_add_loop_test(tests, hostile_bits, 0, 4);
    ADD_SOME(tests, hostile_words, 16);
    tcase_add_loop_test(tests, hostile_mixtures, 0, 4);
    tcase_add_test(tests, damaged_facets);
    tcase_add_test(blades, damaged_blades);
    tcase_add_test(blades, damaged_glances);
    tcase_add_loop_test(blades, hostile_blades, 0, 2);
    tcase_add_test(blades, restoring_blades);
    suite_add_tcase(suite, tests);
    suite_add_tcase(suite, blades);
    return run_suite(suite);
}
