/* What a call that is refused says: its result, the field, the index. No refusal changes the body; a call that succeeds
   says so too. Other files have the refusals of gx_body_create and gx_body_cut (test_body.c), of models, changes and
   steps (test_solve.c, test_updates.c, test_forces.c), of points of space (test_locate.c). */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../gxfem_boolean.h"
#include "../gxfem_integrate.h"
#include <check.h>
#include <float.h>
#include <math.h>
#include "../examples/gxfailure.h"
#include "body.h"

/* What no call writes */
static const char unset[] = "unset";
static gx_failure failure;

static void expect(gx_result result, gx_result expected, const char *field, size_t index, int line) {
    ck_assert_msg(result == expected && failure.result == expected, "line %d: %s, should be: %s", line,
                  gx_result_text(result), gx_result_text(expected));
    ck_assert_msg(field == NULL ? failure.field == NULL : failure.field != NULL && strcmp(failure.field, field) == 0,
                  "line %d: field %s, should be %s", line, failure.field ? failure.field : "NULL",
                  field ? field : "NULL");
    ck_assert_msg(failure.index == index && failure.surface == SIZE_MAX, "line %d: index %zu, should be %zu", line,
                  failure.index, index);
    failure.field = unset;
    failure.index = failure.surface = 77;
}

/* The call is given &failure. */
#define REFUSED(call, expected, field, index) expect(call, expected, field, index, __LINE__)
#define DONE(call)                            expect(call, GX_OK, NULL, SIZE_MAX, __LINE__)

/* ... and leaves the body alone */
#define KEEPS(body, call, expected, field, index)                                                                      \
    do {                                                                                                               \
        const uint64_t state_ = gx_body_state_hash(body);                                                              \
        REFUSED(call, expected, field, index);                                                                         \
        ck_assert(gx_body_state_hash(body) == state_);                                                                 \
    } while (0)

START_TEST(views_and_motions) {
    workload w = wl_through(0.1);
    gx_body *body = cut_at_once(&w);
    gx_motion motions[2];
    gxs_model model;
    gx_view view;
    double *number;
    REFUSED(gx_body_view(NULL, &view, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_view(body, NULL, &failure), GX_ERROR_ARGUMENT, "view", SIZE_MAX);
    DONE(gx_body_view(body, &view, &failure));
    REFUSED(gx_body_model(NULL, &model, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_model(body, NULL, &failure), GX_ERROR_ARGUMENT, "model", SIZE_MAX);
    DONE(gx_body_model(body, &model, &failure));
    REFUSED(gx_body_motion(NULL, motions, 2, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_motion(body, NULL, 2, &failure), GX_ERROR_ARGUMENT, "motions", SIZE_MAX);
    KEEPS(body, gx_body_motion(body, motions, 1, &failure), GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    KEEPS(body, gx_body_motion(body, NULL, 0, &failure), GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    number = &view.displacement[3 * 4 + 1];
    *number = NAN;
    KEEPS(body, gx_body_motion(body, motions, 2, &failure), GX_ERROR_NOT_FINITE, "displacement", 4);
    *number = 0;
    number = &view.velocity[3 * 5 + 2];
    *number = INFINITY;
    KEEPS(body, gx_body_motion(body, motions, 2, &failure), GX_ERROR_NOT_FINITE, "velocity", 5);
    *number = 1e300;
    KEEPS(body, gx_body_motion(body, motions, 2, &failure), GX_ERROR_RANGE, NULL, SIZE_MAX);
    *number = 0;
    DONE(gx_body_motion(body, motions, 2, &failure));
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A region that holds nothing is refused, and what was held stays held; one that a cut leaves without a copy is not. */
START_TEST(regions) {
    workload w = grid(2, 1, 1, 5); /* x from 0 to 2 */
    gx_body *body = body_of(&w);
    gx_region good[2] = {gx_region_half_space(0, -1, 0.5), gx_region_half_space(0, 1, 1.5)}, bad[2];
    gx_view view;
    size_t i, held = 0;
    bad[0] = good[0];
    DONE(gx_body_hold(body, good, 1, &failure));
    DONE(gx_body_view(body, &view, &failure));
    for (i = 0; i < view.copy_count; i++) held += view.copy_held[i];
    ck_assert_uint_eq(held, 4);
    REFUSED(gx_body_hold(NULL, good, 1, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_hold(body, NULL, 1, &failure), GX_ERROR_ARGUMENT, "regions", SIZE_MAX);
    bad[1] = good[1];
    bad[1].axis = 3;
    KEEPS(body, gx_body_hold(body, bad, 2, &failure), GX_ERROR_ARGUMENT, "regions.axis", 1);
    bad[1] = good[1];
    bad[1].side = 0;
    KEEPS(body, gx_body_hold(body, bad, 2, &failure), GX_ERROR_ARGUMENT, "regions.side", 1);
    bad[1] = good[1];
    bad[1].value = NAN;
    KEEPS(body, gx_body_hold(body, bad, 2, &failure), GX_ERROR_NOT_FINITE, "regions.value", 1);
    bad[1].value = 2; /* strictly above: no node */
    KEEPS(body, gx_body_hold(body, bad, 2, &failure), GX_ERROR_EMPTY, "regions", 1);
    bad[1].value = 1.99;
    DONE(gx_body_hold(body, bad, 2, &failure));
    bad[0].value = 0;
    KEEPS(body, gx_body_hold(body, bad, 2, &failure), GX_ERROR_EMPTY, "regions", 0);
    DONE(gx_body_view(body, &view, &failure));
    for (i = held = 0; i < view.copy_count; i++) held += view.copy_held[i];
    ck_assert_uint_eq(held, 8); /* those of the last call that succeeded */
    DONE(gx_body_hold(body, NULL, 0, &failure));
    DONE(gx_body_view(body, &view, &failure));
    for (i = 0; i < view.copy_count; i++) ck_assert(!view.copy_held[i]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A solid removes what a region held. The region stays; it holds nothing any more, and cannot be asked for again. */
START_TEST(regions_that_a_cut_empties) {
    static const double low[3] = {1.25, -1, -1}, high[3] = {3, 2, 2};
    const gx_region end = gx_region_half_space(0, 1, 1.5);
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w), *copy = NULL;
    gx_view view;
    size_t i;
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    DONE(gx_body_hold(body, &end, 1, &failure));
    cut_by(body, &w, 0, 1);
    DONE(gx_body_view(body, &view, &failure));
    for (i = 0; i < view.copy_count; i++) ck_assert(!view.copy_held[i]);
    KEEPS(body, gx_body_hold(body, &end, 1, &failure), GX_ERROR_EMPTY, "regions", 0);
    DONE(gx_body_clone(body, &copy, &failure)); /* a body with such a region is a body like others */
    ck_assert(gx_body_state_hash(copy) == gx_body_state_hash(body));
    gx_body_destroy(copy);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(skins_and_rays) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    const double o[3] = {0.3, 0.4, -1}, d[3] = {0, 0, 1}, none[3] = {0, 0, 0}, bad[3] = {0, INFINITY, 1};
    double x[3 * 64];
    float y[3 * 64];
    gx_skin_desc desc;
    gx_skin skin;
    gx_hit hit;
    int k;
    memset(&desc, 0, sizeof desc);
    add_axis_plane(&w, 0, 0.5);
    /* before there is a skin */
    KEEPS(body, gx_body_skin_positions(body, x, &failure), GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    KEEPS(body, gx_body_skin_vertices(body, NULL, y, NULL, &failure), GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    KEEPS(body, gx_body_pick(body, o, d, &hit, &failure), GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    REFUSED(gx_body_skin(NULL, NULL, &skin, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_skin(body, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "skin", SIZE_MAX);
    desc.crease_angle = -1;
    KEEPS(body, gx_body_skin(body, &desc, &skin, &failure), GX_ERROR_ARGUMENT, "crease_angle", SIZE_MAX);
    desc.crease_angle = NAN;
    KEEPS(body, gx_body_skin(body, &desc, &skin, &failure), GX_ERROR_NOT_FINITE, "crease_angle", SIZE_MAX);
    DONE(gx_body_skin(body, NULL, &skin, &failure));
    REFUSED(gx_body_skin_positions(NULL, x, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_skin_positions(body, NULL, &failure), GX_ERROR_ARGUMENT, "positions", SIZE_MAX);
    DONE(gx_body_skin_positions(body, x, &failure));
    REFUSED(gx_body_skin_vertices(NULL, NULL, y, NULL, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_skin_vertices(body, bad, y, NULL, &failure), GX_ERROR_NOT_FINITE, "origin", SIZE_MAX);
    DONE(gx_body_skin_vertices(body, NULL, NULL, y, &failure));
    REFUSED(gx_body_pick(NULL, o, d, &hit, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_pick(body, NULL, d, &hit, &failure), GX_ERROR_ARGUMENT, "origin", SIZE_MAX);
    KEEPS(body, gx_body_pick(body, o, NULL, &hit, &failure), GX_ERROR_ARGUMENT, "direction", SIZE_MAX);
    KEEPS(body, gx_body_pick(body, o, d, NULL, &failure), GX_ERROR_ARGUMENT, "hit", SIZE_MAX);
    for (k = 0; k < 3; k++) {
        double one[3] = {0, 0, 0};
        one[k] = (double)INFINITY;
        KEEPS(body, gx_body_pick(body, one, d, &hit, &failure), GX_ERROR_NOT_FINITE, "origin", SIZE_MAX);
    }
    KEEPS(body, gx_body_pick(body, o, bad, &hit, &failure), GX_ERROR_NOT_FINITE, "direction", SIZE_MAX);
    KEEPS(body, gx_body_pick(body, o, none, &hit, &failure), GX_ERROR_ARGUMENT, "direction", SIZE_MAX);
    DONE(gx_body_pick(body, o, d, &hit, &failure));
    /* after a cut */
    cut_by(body, &w, 0, 1);
    KEEPS(body, gx_body_skin_positions(body, x, &failure), GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    KEEPS(body, gx_body_skin_vertices(body, NULL, y, NULL, &failure), GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    KEEPS(body, gx_body_pick(body, o, d, &hit, &failure), GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    DONE(gx_body_skin(body, NULL, &skin, &failure));
    DONE(gx_body_pick(body, o, d, &hit, &failure));
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(scopes) {
    static const uint32_t fragments[2] = {0, 2}, cells[2] = {0, 1000};
    workload w = wl_through(0.1);
    gx_body *body = cut_at_once(&w);
    const gx_surface solid = surface_of(&w.surfaces[0]);
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &solid;
    desc.surface_count = 1;
    REFUSED(gx_body_cut(NULL, &desc, NULL, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_cut(body, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "desc", SIZE_MAX);
    desc.scope_fragment_count = 2;
    KEEPS(body, gx_body_cut(body, &desc, NULL, &failure), GX_ERROR_ARGUMENT, "scope_fragments", SIZE_MAX);
    desc.scope_fragments = fragments;
    KEEPS(body, gx_body_cut(body, &desc, NULL, &failure), GX_ERROR_INDEX, "scope_fragments", 1);
    desc.scope_fragment_count = 0;
    desc.scope_cell_count = 2;
    KEEPS(body, gx_body_cut(body, &desc, NULL, &failure), GX_ERROR_ARGUMENT, "scope_cells", SIZE_MAX);
    desc.scope_cells = cells;
    KEEPS(body, gx_body_cut(body, &desc, NULL, &failure), GX_ERROR_INDEX, "scope_cells", 1);
    desc.scope_cell_count = 1;
    desc.sever_below = 1;
    DONE(gx_body_cut(body, &desc, NULL, &failure));
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(thick_sheets) {
    double x[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, y[18];
    uint32_t n[3] = {0, 1, 2}, t[24];
    size_t nv, nt;
    gx_surface s;
    gx_allocator half;
    memset(&s, 0, sizeof s);
    memset(&half, 0, sizeof half);
    half.allocate = (void *(*)(void *, size_t))1;
    s.vertices = x;
    s.vertex_count = 3;
    s.triangles = n;
    s.triangle_count = 1;
#define SOLIDIFY(thickness) gx_surface_solidify(&s, thickness, y, &nv, t, &nt, NULL, &failure)
    DONE(SOLIDIFY(0.1));
    REFUSED(gx_surface_solidify(NULL, 1, y, &nv, t, &nt, NULL, &failure), GX_ERROR_ARGUMENT, "sheet", SIZE_MAX);
    REFUSED(gx_surface_solidify(&s, 1, NULL, &nv, t, &nt, NULL, &failure), GX_ERROR_ARGUMENT, "solid_vertices",
            SIZE_MAX);
    REFUSED(gx_surface_solidify(&s, 1, y, NULL, t, &nt, NULL, &failure), GX_ERROR_ARGUMENT, "solid_vertex_count",
            SIZE_MAX);
    REFUSED(gx_surface_solidify(&s, 1, y, &nv, NULL, &nt, NULL, &failure), GX_ERROR_ARGUMENT, "solid_triangles",
            SIZE_MAX);
    REFUSED(gx_surface_solidify(&s, 1, y, &nv, t, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "solid_triangle_count",
            SIZE_MAX);
    REFUSED(gx_surface_solidify(&s, 1, y, &nv, t, &nt, &half, &failure), GX_ERROR_ARGUMENT, "allocator", SIZE_MAX);
    REFUSED(SOLIDIFY(0), GX_ERROR_ARGUMENT, "thickness", SIZE_MAX);
    REFUSED(SOLIDIFY(-1), GX_ERROR_ARGUMENT, "thickness", SIZE_MAX);
    REFUSED(SOLIDIFY(NAN), GX_ERROR_NOT_FINITE, "thickness", SIZE_MAX);
    s.vertices = NULL;
    REFUSED(SOLIDIFY(1), GX_ERROR_ARGUMENT, "vertices", SIZE_MAX);
    s.vertices = x;
    s.triangles = NULL;
    REFUSED(SOLIDIFY(1), GX_ERROR_ARGUMENT, "triangles", SIZE_MAX);
    s.triangles = n;
    s.vertex_count = 0;
    REFUSED(SOLIDIFY(1), GX_ERROR_EMPTY, "vertex_count", SIZE_MAX);
    s.vertex_count = SIZE_MAX / 8;
    REFUSED(SOLIDIFY(1), GX_ERROR_LIMIT, "vertex_count", SIZE_MAX);
    s.vertex_count = 3;
    s.triangle_count = 0;
    REFUSED(SOLIDIFY(1), GX_ERROR_EMPTY, "triangle_count", SIZE_MAX);
    s.triangle_count = SIZE_MAX / 8;
    REFUSED(SOLIDIFY(1), GX_ERROR_LIMIT, "triangle_count", SIZE_MAX);
    s.triangle_count = 1;
    n[1] = 3;
    REFUSED(SOLIDIFY(1), GX_ERROR_INDEX, "triangles", 0);
    n[1] = 1;
    x[7] = NAN;
    REFUSED(SOLIDIFY(1), GX_ERROR_NOT_FINITE, "vertices", 2);
    x[7] = 1;
    x[2] = x[5] = x[8] = DBL_MAX;
    REFUSED(SOLIDIFY(1e300), GX_ERROR_RANGE, "vertices", 0);
    x[2] = x[5] = x[8] = 0; /* an edge longer than a double */
    x[0] = -DBL_MAX;
    x[3] = DBL_MAX;
    REFUSED(SOLIDIFY(1), GX_ERROR_RANGE, "vertices", 0);
#undef SOLIDIFY
}
END_TEST

START_TEST(saving) {
    workload w = wl_through(0.1);
    gx_body *body = cut_at_once(&w), *other = NULL;
    gx_body_desc desc;
    unsigned char *bytes;
    size_t size = 0;
    memset(&desc, 0, sizeof desc);
    REFUSED(gx_body_save(NULL, NULL, 0, &size, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_save(body, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "size", SIZE_MAX);
    DONE(gx_body_save(body, NULL, 0, &size, &failure));
    bytes = (unsigned char *)malloc(size);
    KEEPS(body, gx_body_save(body, bytes, size - 1, &size, &failure), GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    KEEPS(body, gx_body_save(body, bytes, 0, &size, &failure), GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    DONE(gx_body_save(body, bytes, size, &size, &failure));
    REFUSED(gx_body_load(NULL, size, NULL, &other, &failure), GX_ERROR_ARGUMENT, "memory", SIZE_MAX);
    REFUSED(gx_body_load(bytes, size, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    desc.allocator.release = (void (*)(void *, void *, size_t))1;
    REFUSED(gx_body_load(bytes, size, &desc, &other, &failure), GX_ERROR_ARGUMENT, "allocator", SIZE_MAX);
    REFUSED(gx_body_load(bytes, size - 1, NULL, &other, &failure), GX_ERROR_DAMAGED, "memory", 40);
    bytes[8]--; /* another version */
    REFUSED(gx_body_load(bytes, size, NULL, &other, &failure), GX_ERROR_FORMAT, "memory", 40);
    bytes[8]++;
    ck_assert(other == NULL);
    DONE(gx_body_load(bytes, size, NULL, &other, &failure));
    REFUSED(gx_body_clone(NULL, &other, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_clone(body, NULL, &failure), GX_ERROR_ARGUMENT, "clone", SIZE_MAX);
    REFUSED(gx_body_restore(NULL, body, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_restore(body, NULL, &failure), GX_ERROR_ARGUMENT, "from", SIZE_MAX);
    DONE(gx_body_restore(body, body, &failure));
    DONE(gx_body_restore(body, other, &failure));
    gx_body_topology_hash(NULL, &failure);
    REFUSED(failure.result, GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    ck_assert(gx_body_topology_hash(body, &failure) != 0);
    DONE(failure.result);
    free(bytes);
    gx_body_destroy(other);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A body's material, its table of materials, and what else a description says */
START_TEST(descriptions) {
    workload w = grid(1, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL;
    gx_material m;
    uint32_t of[5] = {0, 0, 0, 0, 0};
    const gx_body_desc good = desc;
    memset(&m, 0, sizeof m);
    m.elastic.young = m.density = 1;
#define CREATED(change, expected, field, index)                                                                        \
    desc = good;                                                                                                       \
    change;                                                                                                            \
    REFUSED(gx_body_create(&desc, &body, &failure), expected, field, index)
    CREATED(desc.support_below = -0.1, GX_ERROR_ARGUMENT, "support_below", SIZE_MAX);
    CREATED(desc.support_below = 1, GX_ERROR_ARGUMENT, "support_below", SIZE_MAX);
    CREATED(desc.support_below = NAN, GX_ERROR_NOT_FINITE, "support_below", SIZE_MAX);
    CREATED(desc.element_materials = of, GX_ERROR_ARGUMENT, "materials", SIZE_MAX);
    CREATED(desc.material_count = 1, GX_ERROR_ARGUMENT, "materials", SIZE_MAX);
    CREATED(desc.materials = &m, GX_ERROR_EMPTY, "material_count", SIZE_MAX);
    CREATED(desc.materials = &m; desc.material_count = INT32_MAX, GX_ERROR_LIMIT, "material_count", SIZE_MAX);
    CREATED(desc.element_count = INT32_MAX, GX_ERROR_LIMIT, "element_count", SIZE_MAX);
#undef CREATED
    desc = good;
    desc.materials = &m;
    desc.material_count = 1;
#define CREATED(change, undo, expected, field)                                                                         \
    change;                                                                                                            \
    REFUSED(gx_body_create(&desc, &body, &failure), expected, field, 0);                                               \
    undo
    CREATED(m.elastic.kind = (gxs_material_kind)(GXS_CUSTOM + 1), m.elastic.kind = GXS_STABLE_NEO_HOOKEAN,
            GX_ERROR_ARGUMENT, "materials.elastic.kind");
    CREATED(m.elastic.kind = GXS_CUSTOM, m.elastic.kind = GXS_STABLE_NEO_HOOKEAN, GX_ERROR_ARGUMENT,
            "materials.elastic.energy");
    CREATED(m.elastic.damping = -1, m.elastic.damping = 0, GX_ERROR_ARGUMENT, "materials.elastic.damping");
    CREATED(m.elastic.damping = NAN, m.elastic.damping = 0, GX_ERROR_NOT_FINITE, "materials.elastic.damping");
#undef CREATED
    ck_assert(body == NULL);
    DONE(gx_body_create(&desc, &body, &failure));
    {
        static const double x[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        static const uint32_t t[3] = {0, 1, 2};
        gx_surface s;
        gx_cut_desc cut;
        memset(&s, 0, sizeof s);
        memset(&cut, 0, sizeof cut);
        cut.surfaces = &s;
        cut.surface_count = 1;
        s.vertices = x;
        s.triangles = t;
        s.vertex_count = 3;
        s.triangle_count = INT32_MAX;
        ck_assert_int_eq(gx_body_cut(body, &cut, NULL, &failure), GX_ERROR_LIMIT);
        ck_assert(strcmp(failure.field, "surfaces.triangle_count") == 0 && failure.surface == 0);
        ck_assert(view_of(body).cell_count == 5);
    }
    {
        const gxs_constraint *none = (const gxs_constraint *)&m; /* not read */
        gxs_solver *solver = NULL;
        gxs_change change;
        gxs_model model;
        uint32_t origins[8] = {0};
        DONE(gx_body_model(body, &model, &failure));
        DONE(gxs_solver_create(NULL, &solver, &failure));
        model.constraints = none;
        model.constraint_count = model.copy_count + 1;
        REFUSED(gxs_solver_set_model(solver, &model, &failure), GX_ERROR_LIMIT, "constraint_count", SIZE_MAX);
        model.constraint_count = 0;
        DONE(gxs_solver_set_model(solver, &model, &failure));
        memset(&change, 0, sizeof change);
        change.origins = origins;
        change.copy_count = 8;
        change.elements = model.elements;
        change.element_count = UINT32_MAX / 4;
        REFUSED(gxs_solver_update(solver, &change, &failure), GX_ERROR_LIMIT, "element_count", SIZE_MAX);
        gxs_solver_destroy(solver);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A step names the fields of its description; a solver without a model says that something else comes first. */
START_TEST(steps_and_solvers) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gxs_change change;
    gx_step_desc step;
    gxs_step_desc own;
    double u[24], v[24];
    memset(&desc, 0, sizeof desc);
    memset(&step, 0, sizeof step);
    memset(&change, 0, sizeof change);
    memset(u, 0, sizeof u);
    memset(v, 0, sizeof v);
    REFUSED(gx_body_step(NULL, &step, NULL, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_step(body, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "desc", SIZE_MAX);
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT, "dt", SIZE_MAX);
    step.dt = 0.01;
    step.gravity[1] = NAN;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_NOT_FINITE, "gravity", SIZE_MAX);
    step.gravity[1] = 0;
    step.sleep_speed = -1;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT, "sleep_speed", SIZE_MAX);
    step.sleep_speed = 0;
    step.spring_count = 1;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT, "springs", SIZE_MAX);
    step.spring_count = 0;
    step.integrator = GXS_STATIC; /* nothing is held */
    step.dt = 0;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_FREE, NULL, 0);
    step.integrator = GXS_BDF1;
    step.dt = 0.01;
    DONE(gx_body_step(body, &step, NULL, &failure));
    own = solver_step(&step);
    REFUSED(gxs_solver_create(NULL, NULL, &failure), GX_ERROR_ARGUMENT, "solver", SIZE_MAX);
    desc.allocator.allocate = (void *(*)(void *, size_t))1;
    REFUSED(gxs_solver_create(&desc, &solver, &failure), GX_ERROR_ARGUMENT, "allocator", SIZE_MAX);
    desc.allocator.allocate = NULL;
    desc.preconditioner = (gxs_preconditioner)(GXS_VOLUME_RATIO + 1);
    REFUSED(gxs_solver_create(&desc, &solver, &failure), GX_ERROR_ARGUMENT, "preconditioner", SIZE_MAX);
    desc.preconditioner = GXS_AUTOMATIC;
    desc.matrix = (gxs_matrix)(GXS_MATRIX_ASSEMBLED + 1);
    REFUSED(gxs_solver_create(&desc, &solver, &failure), GX_ERROR_ARGUMENT, "matrix", SIZE_MAX);
    desc.matrix = GXS_MATRIX_FREE;
    DONE(gxs_solver_create(&desc, &solver, &failure));
    REFUSED(gxs_solver_set_model(solver, NULL, &failure), GX_ERROR_ARGUMENT, "model", SIZE_MAX);
    REFUSED(gxs_solver_step(NULL, &own, u, v, NULL, &failure), GX_ERROR_ARGUMENT, "solver", SIZE_MAX);
    REFUSED(gxs_solver_step(solver, &own, u, v, NULL, &failure), GX_ERROR_SEQUENCE, "gxs_solver_set_model", SIZE_MAX);
    REFUSED(gxs_solver_update(solver, &change, &failure), GX_ERROR_SEQUENCE, "gxs_solver_set_model", SIZE_MAX);
    REFUSED(gxs_solver_linearise(solver, u, 0, 0, &failure), GX_ERROR_SEQUENCE, "gxs_solver_set_model", SIZE_MAX);
    REFUSED(gxs_solver_product(solver, u, v, &failure), GX_ERROR_SEQUENCE, "gxs_solver_linearise", SIZE_MAX);
    REFUSED(gxs_solver_product(solver, NULL, v, &failure), GX_ERROR_ARGUMENT, "direction", SIZE_MAX);
    REFUSED(gxs_solver_product(solver, u, NULL, &failure), GX_ERROR_ARGUMENT, "product", SIZE_MAX);
    {
        gxs_model model;
        DONE(gx_body_model(body, &model, &failure));
        DONE(gxs_solver_set_model(solver, &model, &failure));
    }
    REFUSED(gxs_solver_step(solver, NULL, u, v, NULL, &failure), GX_ERROR_ARGUMENT, "step", SIZE_MAX);
    REFUSED(gxs_solver_step(solver, &own, NULL, v, NULL, &failure), GX_ERROR_ARGUMENT, "displacement", SIZE_MAX);
    REFUSED(gxs_solver_step(solver, &own, u, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "velocity", SIZE_MAX);
    REFUSED(gxs_solver_product(solver, u, v, &failure), GX_ERROR_SEQUENCE, "gxs_solver_linearise", SIZE_MAX);
    own.integrator = (gxs_integrator)(GXS_EXPLICIT + 1);
    REFUSED(gxs_solver_step(solver, &own, u, v, NULL, &failure), GX_ERROR_ARGUMENT, "integrator", SIZE_MAX);
    own.integrator = GXS_BDF1;
    own.previous_dt = NAN;
    REFUSED(gxs_solver_step(solver, &own, u, v, NULL, &failure), GX_ERROR_NOT_FINITE, "previous_dt", SIZE_MAX);
    ck_assert_int_eq(gxs_step_check(&own, 4, 0, NULL), GX_ERROR_NOT_FINITE);
    own.previous_dt = 0;
    ck_assert_int_eq(gxs_step_check(&own, 4, 0, NULL), GX_OK);
    REFUSED(gxs_solver_linearise(solver, u, -1, 0, &failure), GX_ERROR_ARGUMENT, "rate", SIZE_MAX);
    DONE(gxs_solver_linearise(solver, u, 1, 0, &failure));
    DONE(gxs_solver_product(solver, u, v, &failure));
    DONE(gxs_solver_step(solver, &own, u, v, NULL, &failure));
    gxs_solver_destroy(solver);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(booleans) {
    double x[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    uint32_t n[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    gxb_boolean_desc desc;
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_components components;
    gxb_statistics statistics;
    gxb_defects defects;
    gxb_operand o;
    memset(&desc, 0, sizeof desc);
    memset(&o, 0, sizeof o);
    o.vertices = x;
    o.vertex_count = 4;
    o.triangles = n;
    o.triangle_count = 4;
    REFUSED(gxb_boolean_create(NULL, NULL, &failure), GX_ERROR_ARGUMENT, "boolean", SIZE_MAX);
    desc.allocator.allocate = (void *(*)(void *, size_t))1;
    REFUSED(gxb_boolean_create(&desc, &b, &failure), GX_ERROR_ARGUMENT, "allocator", SIZE_MAX);
    desc.allocator.allocate = NULL;
    desc.memory_limit = 1;
    REFUSED(gxb_boolean_create(&desc, &b, &failure), GX_ERROR_LIMIT, "memory_limit", SIZE_MAX);
    DONE(gxb_boolean_create(NULL, &b, &failure));
    REFUSED(gxb_boolean_evaluate(b, &r, &failure), GX_ERROR_SEQUENCE, "gxb_boolean_add", SIZE_MAX);
    REFUSED(gxb_boolean_components(b, &components, &failure), GX_ERROR_SEQUENCE, "gxb_boolean_evaluate", SIZE_MAX);
    REFUSED(gxb_boolean_defects(b, &defects, &failure), GX_ERROR_SEQUENCE, "gxb_boolean_evaluate", SIZE_MAX);
    REFUSED(gxb_boolean_set_triangulation(b, 3, &failure), GX_ERROR_ARGUMENT, "triangulation", SIZE_MAX);
    REFUSED(gxb_boolean_set_fine(NULL, 1, &failure), GX_ERROR_ARGUMENT, "boolean", SIZE_MAX);
    REFUSED(gxb_boolean_set_mend(NULL, 1, &failure), GX_ERROR_ARGUMENT, "boolean", SIZE_MAX);
    DONE(gxb_boolean_set_triangulation(b, GXB_DIVIDED, &failure));
    DONE(gxb_boolean_set_fine(b, 0, &failure));
    DONE(gxb_boolean_set_mend(b, 0, &failure));
    REFUSED(gxb_boolean_add(NULL, &o, &failure), GX_ERROR_ARGUMENT, "boolean", SIZE_MAX);
    REFUSED(gxb_boolean_add(b, NULL, &failure), GX_ERROR_ARGUMENT, "operand", SIZE_MAX);
#define ADDED_WITH(change, undo, expected, field, index)                                                               \
    change;                                                                                                            \
    REFUSED(gxb_boolean_add(b, &o, &failure), expected, field, index);                                                 \
    undo
    ADDED_WITH(o.operation = 99, o.operation = GXB_UNION, GX_ERROR_ARGUMENT, "operation", SIZE_MAX);
    ADDED_WITH(o.rule = 99, o.rule = GXB_NONZERO, GX_ERROR_ARGUMENT, "rule", SIZE_MAX);
    ADDED_WITH(o.vertices = NULL, o.vertices = x, GX_ERROR_ARGUMENT, "vertices", SIZE_MAX);
    ADDED_WITH(o.triangles = NULL, o.triangles = n, GX_ERROR_ARGUMENT, "triangles", SIZE_MAX);
    ADDED_WITH(o.vertex_count = 0, o.vertex_count = 4, GX_ERROR_EMPTY, "vertex_count", SIZE_MAX);
    ADDED_WITH(o.triangle_count = 0, o.triangle_count = 4, GX_ERROR_EMPTY, "triangle_count", SIZE_MAX);
    ADDED_WITH(o.vertex_count = INT32_MAX, o.vertex_count = 4, GX_ERROR_LIMIT, "vertex_count", SIZE_MAX);
    ADDED_WITH(o.triangle_count = INT32_MAX, o.triangle_count = 4, GX_ERROR_LIMIT, "triangle_count", SIZE_MAX);
    ADDED_WITH(n[7] = 4, n[7] = 3, GX_ERROR_INDEX, "triangles", 2);
    ADDED_WITH(x[10] = NAN, x[10] = 0, GX_ERROR_NOT_FINITE, "vertices", 3);
    ADDED_WITH(x[3] = 1e300, x[3] = 1, GX_ERROR_RANGE, "vertices", 1);
    ADDED_WITH(o.triangle_count = 3, o.triangle_count = 4, GX_ERROR_NOT_CLOSED, "triangles", 0);
#undef ADDED_WITH
    DONE(gxb_boolean_add(b, &o, &failure));
    REFUSED(gxb_boolean_evaluate(NULL, &r, &failure), GX_ERROR_ARGUMENT, "boolean", SIZE_MAX);
    REFUSED(gxb_boolean_evaluate(b, NULL, &failure), GX_ERROR_ARGUMENT, "result", SIZE_MAX);
    DONE(gxb_boolean_evaluate(b, &r, &failure));
    REFUSED(gxb_boolean_components(b, NULL, &failure), GX_ERROR_ARGUMENT, "components", SIZE_MAX);
    REFUSED(gxb_boolean_defects(b, NULL, &failure), GX_ERROR_ARGUMENT, "defects", SIZE_MAX);
    REFUSED(gxb_boolean_statistics(b, NULL, &failure), GX_ERROR_ARGUMENT, "statistics", SIZE_MAX);
    DONE(gxb_boolean_components(b, &components, &failure));
    DONE(gxb_boolean_defects(b, &defects, &failure));
    DONE(gxb_boolean_statistics(b, &statistics, &failure));
    gxb_boolean_destroy(b);
}
END_TEST

START_TEST(integrals) {
    double x[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, m[20], work[20];
    uint32_t n[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const double bad[3] = {0, NAN, 0}, origin[3] = {0, 0, 0};
    gxi_surface s = {NULL, 4, NULL, 4};
    gxi_moments2 moments;
    s.positions = x;
    s.triangles = n;
    REFUSED(gxi_polyhedron_moments2(NULL, origin, &moments, &failure), GX_ERROR_ARGUMENT, "surface", SIZE_MAX);
    REFUSED(gxi_polyhedron_moments2(&s, origin, NULL, &failure), GX_ERROR_ARGUMENT, "m", SIZE_MAX);
    REFUSED(gxi_polyhedron_moments2(&s, bad, &moments, &failure), GX_ERROR_NOT_FINITE, "origin", SIZE_MAX);
    DONE(gxi_polyhedron_moments2(&s, origin, &moments, &failure));
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, NULL, work, &failure), GX_ERROR_ARGUMENT, "moments", SIZE_MAX);
    REFUSED(gxi_surface_monomials(&s, NULL, 2, m, NULL, &failure), GX_ERROR_ARGUMENT, "work", SIZE_MAX);
    REFUSED(gxi_surface_flux_monomials(&s, NULL, GXI_DEGREE_MAX + 1, m, work, &failure), GX_ERROR_RANGE, "degree",
            SIZE_MAX);
    s.positions = NULL;
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, m, work, &failure), GX_ERROR_ARGUMENT, "positions", SIZE_MAX);
    s.positions = x;
    s.triangles = NULL;
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, m, work, &failure), GX_ERROR_ARGUMENT, "triangles", SIZE_MAX);
    s.triangles = n;
    s.position_count = 0;
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, m, work, &failure), GX_ERROR_EMPTY, "position_count", SIZE_MAX);
    s.position_count = 3;
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, m, work, &failure), GX_ERROR_INDEX, "triangles", 1);
    s.position_count = 4;
    s.triangle_count = 0;
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, m, work, &failure), GX_ERROR_EMPTY, "triangle_count", SIZE_MAX);
    s.triangle_count = 4;
    x[7] = INFINITY;
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, m, work, &failure), GX_ERROR_NOT_FINITE, "positions", 2);
    x[7] = 1e300;
    REFUSED(gxi_polyhedron_monomials(&s, NULL, 2, m, work, &failure), GX_ERROR_RANGE, "positions", SIZE_MAX);
    x[7] = 1;
    DONE(gxi_polyhedron_monomials(&s, NULL, 3, m, work, &failure));
    REFUSED(gxi_polyhedron_monomial(&s, NULL, 0, 0, 0, NULL, &failure), GX_ERROR_ARGUMENT, "moment", SIZE_MAX);
    REFUSED(gxi_polyhedron_monomial(&s, NULL, 1, GXI_DEGREE_MAX, 1, m, &failure), GX_ERROR_RANGE, "j", SIZE_MAX);
    REFUSED(gxi_polyhedron_monomial(&s, NULL, GXI_DEGREE_MAX + 1, 0, 0, m, &failure), GX_ERROR_RANGE, "i", SIZE_MAX);
    REFUSED(gxi_polyhedron_monomial(&s, NULL, 0, GXI_DEGREE_MAX + 1, 0, m, &failure), GX_ERROR_RANGE, "j", SIZE_MAX);
    REFUSED(gxi_polyhedron_monomial(&s, NULL, 0, 0, GXI_DEGREE_MAX + 1, m, &failure), GX_ERROR_RANGE, "k", SIZE_MAX);
    REFUSED(gxi_polyhedron_monomial(&s, NULL, 2, 1, GXI_DEGREE_MAX, m, &failure), GX_ERROR_RANGE, "k", SIZE_MAX);
    DONE(gxi_polyhedron_monomial(&s, NULL, 1, 1, 1, m, &failure));
    REFUSED(gxi_monomials_translate(1, NULL, m, &failure), GX_ERROR_ARGUMENT, "shift", SIZE_MAX);
    REFUSED(gxi_monomials_translate(1, origin, NULL, &failure), GX_ERROR_ARGUMENT, "moments", SIZE_MAX);
    REFUSED(gxi_monomials_translate(1, bad, m, &failure), GX_ERROR_NOT_FINITE, "shift", SIZE_MAX);
    REFUSED(gxi_monomials_translate(GXI_DEGREE_MAX + 1, origin, m, &failure), GX_ERROR_RANGE, "degree", SIZE_MAX);
    DONE(gxi_monomials_translate(1, origin, m, &failure));
}
END_TEST

/* Every code has words of its own. */
START_TEST(texts) {
    const char *unknown = gx_result_text((gx_result)(GX_ERROR_CAPACITY + 1));
    int i, j;
    for (i = 0; i <= (int)GX_ERROR_CAPACITY; i++) {
        ck_assert_str_ne(gx_result_text((gx_result)i), unknown);
        for (j = 0; j < i; j++) ck_assert_str_ne(gx_result_text((gx_result)i), gx_result_text((gx_result)j));
    }
}
END_TEST

/* A body of which nothing is left has no copies that a spring, point or plane could be wrong about in silence. */
START_TEST(steps_of_nothing) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    gx_step_desc step;
    gxs_spring spring;
    gxs_point point;
    gxs_plane plane;
    add_box(&w, 1, -9, -9, -9, 9, 9, 9);
    body = cut_at_once(&w);
    ck_assert_uint_eq(view_of(body).copy_count, 0);
    memset(&step, 0, sizeof step);
    memset(&spring, 0, sizeof spring);
    memset(&point, 0, sizeof point);
    memset(&plane, 0, sizeof plane);
    step.dt = 0.01;
    spring.point.epoch = point.epoch = view_of(body).epoch;
    step.springs = &spring;
    step.spring_count = 1;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT, "springs.point.count", 0);
    spring.point.count = 1;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_INDEX, "springs.point.copy", 0);
    step.spring_count = 0;
    step.points = &point;
    step.point_count = 1;
    point.count = 1;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_INDEX, "points.copy", 0);
    point.epoch++;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_STALE, "points.epoch", 0);
    step.point_count = 0;
    step.planes = &plane;
    step.plane_count = 1;
    KEEPS(body, gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT, "planes.normal", 0);
    step.plane_count = 0;
    DONE(gx_body_step(body, &step, NULL, &failure));
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A refused move leaves body and blade as they were: the moves after it succeed. */
START_TEST(blades) {
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    const double edge[6] = {-9, -1, 1, 9, -1, 1}, inside[9] = {-9, 1.1, 1, 0.5, 1.1, 1, 1, 1.3, 1};
    double bad[6];
    const uint32_t scope[2] = {0, 1};
    gx_blade_desc desc;
    gx_blade *blade = NULL;
    size_t count = 0;
    memset(&desc, 0, sizeof desc);
    REFUSED(gx_blade_create(NULL, NULL, &blade, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_blade_create(body, NULL, NULL, &failure), GX_ERROR_ARGUMENT, "blade", SIZE_MAX);
    desc.tolerance = NAN;
    KEEPS(body, gx_blade_create(body, &desc, &blade, &failure), GX_ERROR_NOT_FINITE, "tolerance", SIZE_MAX);
    desc.tolerance = -1e-9;
    KEEPS(body, gx_blade_create(body, &desc, &blade, &failure), GX_ERROR_ARGUMENT, "tolerance", SIZE_MAX);
    desc.tolerance = 0;
    desc.min_advance = INFINITY;
    KEEPS(body, gx_blade_create(body, &desc, &blade, &failure), GX_ERROR_NOT_FINITE, "min_advance", SIZE_MAX);
    desc.min_advance = -1;
    KEEPS(body, gx_blade_create(body, &desc, &blade, &failure), GX_ERROR_ARGUMENT, "min_advance", SIZE_MAX);
    ck_assert_ptr_null(blade);
    desc.min_advance = 0.1;
    DONE(gx_blade_create(body, &desc, &blade, &failure));
    REFUSED(gx_blade_move(NULL, edge, 2, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "blade", SIZE_MAX);
    REFUSED(gx_blade_lift(NULL, NULL, &failure), GX_ERROR_ARGUMENT, "blade", SIZE_MAX);
    REFUSED(gx_blade_contacts(NULL, NULL, 0, &count, &failure), GX_ERROR_ARGUMENT, "blade", SIZE_MAX);
    KEEPS(body, gx_blade_contacts(blade, NULL, 1, &count, &failure), GX_ERROR_ARGUMENT, "contacts", SIZE_MAX);
    KEEPS(body, gx_blade_contacts(blade, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "count", SIZE_MAX);
    KEEPS(body, gx_blade_move(blade, NULL, 2, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "edge", SIZE_MAX);
    KEEPS(body, gx_blade_move(blade, edge, 1, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "point_count", SIZE_MAX);
    KEEPS(body, gx_blade_move(blade, edge, 0, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "point_count", SIZE_MAX);
    KEEPS(body, gx_blade_move(blade, edge, UINT32_MAX, NULL, 0, NULL, &failure), GX_ERROR_LIMIT, "point_count",
          SIZE_MAX);
    KEEPS(body, gx_blade_move(blade, inside, 3, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "starts_inside", 1);
    DONE(gx_blade_lift(blade, NULL, &failure)); /* nothing waits */
    DONE(gx_blade_move(blade, edge, 2, NULL, 0, NULL, &failure));
    KEEPS(body, gx_blade_move(blade, inside, 3, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT, "point_count", SIZE_MAX);
    memcpy(bad, edge, sizeof bad);
    bad[4] = NAN;
    KEEPS(body, gx_blade_move(blade, bad, 2, NULL, 0, NULL, &failure), GX_ERROR_NOT_FINITE, "edge", 1);
    bad[4] = -INFINITY;
    KEEPS(body, gx_blade_move(blade, bad, 2, NULL, 0, NULL, &failure), GX_ERROR_NOT_FINITE, "edge", 1);
    bad[4] = 1;
    bad[0] = -DBL_MAX;
    KEEPS(body, gx_blade_move(blade, bad, 2, NULL, 0, NULL, &failure), GX_ERROR_RANGE, "edge", 0);
    view_of(body).displacement[3 * 7 + 1] = NAN;
    KEEPS(body, gx_blade_move(blade, edge, 2, NULL, 0, NULL, &failure), GX_ERROR_NOT_FINITE, "displacement", 7);
    KEEPS(body, gx_blade_lift(blade, NULL, &failure), GX_ERROR_NOT_FINITE, "displacement", 7);
    view_of(body).displacement[3 * 7 + 1] = 1e39;
    KEEPS(body, gx_blade_move(blade, edge, 2, NULL, 0, NULL, &failure), GX_ERROR_RANGE, "displacement", 7);
    KEEPS(body, gx_blade_lift(blade, NULL, &failure), GX_ERROR_RANGE, "displacement", 7);
    view_of(body).displacement[3 * 7 + 1] = 0;
    KEEPS(body, gx_blade_move(blade, edge, 2, NULL, 1, NULL, &failure), GX_ERROR_ARGUMENT, "scope_fragments", SIZE_MAX);
    KEEPS(body, gx_blade_move(blade, edge, 2, scope, 2, NULL, &failure), GX_ERROR_INDEX, "scope_fragments", 1);
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    bad[0] = -9;
    bad[1] = bad[4] = 1;
    DONE(gx_blade_move(blade, bad, 2, scope, 1, NULL, &failure));
    KEEPS(body, gx_blade_contacts(blade, NULL, 0, &count, &failure), GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    ck_assert_uint_gt(count, 2);
    view_of(body).displacement[13] = NAN;
    KEEPS(body, gx_blade_contacts(blade, NULL, 0, &count, &failure), GX_ERROR_NOT_FINITE, "displacement", 4);
    view_of(body).displacement[13] = 1e39;
    KEEPS(body, gx_blade_contacts(blade, NULL, 0, &count, &failure), GX_ERROR_RANGE, "displacement", 4);
    view_of(body).displacement[13] = 0;
    bad[1] = bad[4] = 3;
    DONE(gx_blade_move(blade, bad, 2, scope, 1, NULL, &failure));
    DONE(gx_blade_lift(blade, NULL, &failure));
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_blade_destroy(blade);
    gx_blade_destroy(NULL);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Tools that cannot be carved with */
START_TEST(tools) {
    static const double low[3] = {0.5, 0.5, 0.5}, high[3] = {1.5, 1.5, 1.5};
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    gx_cut_report report;
    gx_surface tool;
    double *x;
    uint32_t *t, first;
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    tool = surface_of(&w.surfaces[0]);
    x = w.surfaces[0].vertices;
    t = w.surfaces[0].triangles;
    REFUSED(gx_body_carve(NULL, &tool, &report, &failure), GX_ERROR_ARGUMENT, "body", SIZE_MAX);
    KEEPS(body, gx_body_carve(body, NULL, &report, &failure), GX_ERROR_ARGUMENT, "tool", SIZE_MAX);
    tool.vertices = NULL;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_ARGUMENT, "tool.vertices", SIZE_MAX);
    tool.vertices = x;
    tool.triangles = NULL;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_ARGUMENT, "tool.triangles", SIZE_MAX);
    tool.triangles = t;
    tool.vertex_count = 0;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_EMPTY, "tool.vertex_count", SIZE_MAX);
    tool.vertex_count = UINT32_MAX;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_LIMIT, "tool.vertex_count", SIZE_MAX);
    tool.vertex_count = 8;
    tool.triangle_count = 0;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_EMPTY, "tool.triangle_count", SIZE_MAX);
    tool.triangle_count = UINT32_MAX;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_LIMIT, "tool.triangle_count", SIZE_MAX);
    tool.triangle_count = 12;
    x[3 * 5] = NAN;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_NOT_FINITE, "tool.vertices", 5);
    x[3 * 5] = 1e300;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_RANGE, "tool.vertices", 5);
    x[3 * 5] = 1.5;
    first = t[3 * 7];
    t[3 * 7] = 8;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_INDEX, "tool.triangles", 7);
    t[3 * 7] = first;
    view_of(body).displacement[3 * 9] = -INFINITY;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_NOT_FINITE, "displacement", 9);
    view_of(body).displacement[3 * 9] = -1e39;
    KEEPS(body, gx_body_carve(body, &tool, &report, &failure), GX_ERROR_RANGE, "displacement", 9);
    view_of(body).displacement[3 * 9] = 0;
    tool.triangle_count = 11;
    {
        const uint64_t state = gx_body_state_hash(body);
        ck_assert_int_eq(gx_body_carve(body, &tool, &report, &failure), GX_ERROR_NOT_CLOSED);
        ck_assert_str_eq(failure.field, "tool.triangles");
        ck_assert_uint_lt(failure.index, 11);
        ck_assert_uint_eq(failure.surface, SIZE_MAX);
        ck_assert(gx_body_state_hash(body) == state);
        failure.field = unset;
    }
    tool.triangle_count = 12;
    DONE(gx_body_carve(body, &tool, &report, &failure));
    ck_assert(fabs(report.removed_volume - 1) < 1e-12);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A failure in a sentence, with what it names and nothing else */
START_TEST(sentences) {
    gx_failure f = {GX_ERROR_NOT_FINITE, "surfaces.vertices", 7, 2};
    ck_assert_str_eq(gxfailure_say(&f, "cause").text, "surfaces.vertices 7 of surface 2: cause");
    f.index = SIZE_MAX;
    ck_assert_str_eq(gxfailure_say(&f, "cause").text, "surfaces.vertices of surface 2: cause");
    f.surface = SIZE_MAX;
    ck_assert_str_eq(gxfailure_say(&f, "cause").text, "surfaces.vertices: cause");
    f.index = 7;
    ck_assert_str_eq(gxfailure_say(&f, "cause").text, "surfaces.vertices 7: cause");
    f.field = NULL;
    ck_assert_str_eq(gxfailure_say(&f, "cause").text, "index 7: cause");
    f.index = SIZE_MAX;
    ck_assert_str_eq(gxfailure_say(&f, "cause").text, "cause");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("failures");
    TCase *tests = tcase_create("failures");
    tcase_add_test(tests, views_and_motions);
    tcase_add_test(tests, regions);
    tcase_add_test(tests, regions_that_a_cut_empties);
    tcase_add_test(tests, skins_and_rays);
    tcase_add_test(tests, scopes);
    tcase_add_test(tests, thick_sheets);
    tcase_add_test(tests, saving);
    tcase_add_test(tests, descriptions);
    tcase_add_test(tests, steps_and_solvers);
    tcase_add_test(tests, booleans);
    tcase_add_test(tests, integrals);
    tcase_add_test(tests, texts);
    tcase_add_test(tests, steps_of_nothing);
    tcase_add_test(tests, blades);
    tcase_add_test(tests, tools);
    tcase_add_test(tests, sentences);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
