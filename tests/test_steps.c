/* test_steps.c - what a body adds to the solver's steps: materials by element, the model for other solvers, BDF2's
   history and rest times through cuts, copies without support, points of the skin, copies named as before a cut. The
   steps themselves: test_solve.c, test_forces.c. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../bench/forms.h"
#include "body.h"

static gx_step_desc step_of(double dt, double gravity) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[2] = gravity;
    return step;
}

static void hold_above(gx_body *body, double z) {
    const gx_region region = gx_region_half_space(2, 1, z);
    ck_assert_int_eq(gx_body_hold(body, &region, 1, NULL), GX_OK);
}

static gxs_step_report advance(gx_body *body, const gx_step_desc *step, int steps) {
    gxs_step_report report;
    gx_failure failure;
    while (steps-- > 0) {
        gx_result result = gx_body_step(body, step, &report, &failure);
        ck_assert_msg(result == GX_OK, "%s at %zu", gx_result_text(result), failure.index);
    }
    return report;
}

/* ---- materials ---- */

/* A column of two materials, hung by its top: stresses add up, so each part stretches by its own stiffness. */
START_TEST(materials_by_element) {
    workload w = grid(2, 2, 8, 5);
    gx_body_desc desc = desc_of(&w);
    gx_material materials[2];
    uint32_t *which = (uint32_t *)calloc(w.element_count, sizeof *which);
    gx_body *body = NULL;
    gx_step_desc step = step_of(0, -9.81);
    gx_view view;
    double low = 0, middle = 0, top, stretch[2];
    size_t i, k, counts[3] = {0, 0, 0};
    memset(materials, 0, sizeof materials);
    materials[0].elastic.kind = GXS_LINEAR;
    materials[0].elastic.young = 1e6;
    materials[0].density = 1000;
    materials[1] = materials[0];
    materials[1].elastic.young = 4e6;
    materials[1].density = 500;
    for (i = 0; i < w.element_count; i++) {
        double z = 0;
        for (k = 0; k < 4; k++) z += 0.25 * w.positions[3 * w.elements[4 * i + k] + 2];
        which[i] = z > 4;
    }
    desc.materials = materials;
    desc.material_count = 2;
    desc.element_materials = which;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    hold_above(body, 8 - 1e-9);
    view = view_of(body);
    ck_assert_double_eq_tol(view.mass, 1000 * 16 + 500 * 16, 1e-8);
    step.integrator = GXS_STATIC;
    step.newton_iterations = 20;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-8;
    ck_assert_int_eq(advance(body, &step, 1).stop, GXS_STOP_BALANCE);
    for (i = 0; i < view.copy_count; i++) {
        const double z = w.positions[3 * view.copy_node[i] + 2], u = view.displacement[3 * i + 2];
        if (z < 1e-9) {
            low += u;
            counts[0]++;
        }
        if (fabs(z - 4) < 1e-9) {
            middle += u;
            counts[1]++;
        }
    }
    low /= (double)counts[0];
    middle /= (double)counts[1];
    top = 0;
    stretch[0] = middle - low;
    stretch[1] = top - middle;
    /* Bars under their own weight and that below: rho g L^2 / (2 E), and the same with the lower part's weight */
    ck_assert_double_eq_tol(stretch[0], 1000 * 9.81 * 16 / 2e6, 0.03 * stretch[0]);
    ck_assert_double_eq_tol(stretch[1], (500 * 9.81 * 8 + 1000 * 9.81 * 16) / 4e6, 0.1 * stretch[1]);
    gx_body_destroy(body);
    free(which);
    wl_free(&w);
}
END_TEST

START_TEST(bad_materials_are_named) {
    workload w = grid(1, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_material materials[2];
    uint32_t which[5] = {0, 1, 0, 1, 0};
    gx_body *body = NULL;
    gx_failure failure;
    memset(materials, 0, sizeof materials);
    materials[0].elastic.young = 1e6;
    materials[0].density = 1000;
    materials[1] = materials[0];
    desc.materials = materials;
    desc.element_materials = which;
#define EXPECT(result, name, at)                                                                                       \
    do {                                                                                                               \
        ck_assert_int_eq(gx_body_create(&desc, &body, &failure), result);                                              \
        ck_assert_pstr_eq(failure.field, name);                                                                        \
        ck_assert_uint_eq(failure.index, at);                                                                          \
    } while (0)
    EXPECT(GX_ERROR_EMPTY, "material_count", SIZE_MAX);
    desc.material_count = 2;
    materials[1].density = 0;
    EXPECT(GX_ERROR_ARGUMENT, "materials.density", 1);
    materials[1].density = 1000;
    materials[0].elastic.young = NAN;
    EXPECT(GX_ERROR_NOT_FINITE, "materials.elastic.young", 0);
    materials[0].elastic.young = 1e6;
    materials[1].elastic.damping = -1;
    EXPECT(GX_ERROR_ARGUMENT, "materials.elastic.damping", 1);
    materials[1].elastic.damping = 0;
    materials[1].elastic.kind = GXS_CUSTOM;
    EXPECT(GX_ERROR_ARGUMENT, "materials.elastic.energy", 1);
    materials[1].elastic.kind = (gxs_material_kind)(GXS_CUSTOM + 1);
    EXPECT(GX_ERROR_ARGUMENT, "materials.elastic.kind", 1);
    materials[1].elastic.kind = GXS_LINEAR;
    materials[1].elastic.poisson = 0.5;
    EXPECT(GX_ERROR_ARGUMENT, "materials.elastic.poisson", 1);
    materials[1].elastic.poisson = 0;
    which[3] = 2;
    EXPECT(GX_ERROR_INDEX, "element_materials", 3);
    which[3] = 1;
    desc.materials = NULL; /* what is said of them would be passed over */
    EXPECT(GX_ERROR_ARGUMENT, "materials", SIZE_MAX);
    desc.material_count = 0;
    EXPECT(GX_ERROR_ARGUMENT, "materials", SIZE_MAX);
    desc.materials = materials;
    desc.material_count = 2;
    desc.support_below = -1;
    EXPECT(GX_ERROR_ARGUMENT, "support_below", SIZE_MAX);
    desc.support_below = 1;
    EXPECT(GX_ERROR_ARGUMENT, "support_below", SIZE_MAX);
    desc.support_below = NAN;
    EXPECT(GX_ERROR_NOT_FINITE, "support_below", SIZE_MAX);
    desc.support_below = 0;
    ck_assert_int_eq(gx_body_create(&desc, &body, &failure), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- the model ---- */

/* Whatever the cuts, the model has the body's volume and mass. A separate solver with this model moves as the body
   does. */
START_TEST(model_is_what_the_body_moves) {
    const uint64_t seed = (uint64_t)_i;
    workload w = grid(3, 3, 3, 5);
    gx_body *body;
    gx_view view;
    gxs_model model;
    gxs_solver *solver = NULL;
    const gx_step_desc step = step_of(0.02, -9.81);
    const gxs_step_desc own = solver_step(&step);
    double volume = 0, mass = 0, *u, *v;
    const double n[3] = {0.3, 1, 0.2}, p[3] = {1.5, 1.4, 1.6};
    size_t i, k, bytes;
    random_seed(seed);
    if (_i > 0) add_plane(&w, p, n, 10);
    body = cut_at_once(&w);
    hold_above(body, 3 - 1e-9);
    view = view_of(body);
    bytes = 3 * view.copy_count * sizeof *u;
    for (i = 0; i < 3 * view.copy_count; i++) view.velocity[i] = random_real(-1, 1);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert_uint_eq(model.copy_count, view.copy_count);
    for (i = 0; i < model.element_count; i++) {
        volume += model.elements[i].weight;
        for (k = 0; k < 10; k++) mass += model.elements[i].mass[k] * (k == 0 || k == 4 || k == 7 || k == 9 ? 1 : 2);
    }
    ck_assert_double_eq_tol(volume, view.volume, 1e-12 * volume);
    ck_assert_double_eq_tol(mass, view.mass, 1e-12 * mass);
    u = (double *)malloc(bytes);
    v = (double *)malloc(bytes);
    memcpy(u, view.displacement, bytes);
    memcpy(v, view.velocity, bytes);
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
    for (i = 0; i < 5; i++) {
        ck_assert_int_eq(gxs_solver_step(solver, &own, u, v, NULL, NULL), GX_OK);
        advance(body, &step, 1);
    }
    ck_assert(memcmp(u, view.displacement, bytes) == 0 && memcmp(v, view.velocity, bytes) == 0);
    ck_assert_int_eq(gx_body_model(NULL, &model, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gx_body_model(body, NULL, NULL), GX_ERROR_ARGUMENT);
    free(u);
    free(v);
    gxs_solver_destroy(solver);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static double pushes(void *user, size_t point, const double *position, double *force, double *hessian) {
    (void)point, (void)position;
    if (hessian) memset(hessian, 0, 6 * sizeof *hessian);
    force[0] = *(double *)user;
    return -force[0] * position[0];
}

/* All that a body's step says reaches the solver: the same step of the body's model ends in the same bits. */
START_TEST(every_field_of_a_step_counts) {
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    gx_view view;
    gxs_model model;
    gx_skin skin;
    gxs_solver *solver = NULL;
    gx_step_desc step = step_of(0.02, -9.81);
    gxs_step_desc own;
    gxs_spring spring;
    gxs_plane plane;
    gxs_point points[2];
    double *state, *vector, *rest, push = 30, forces[2][3];
    size_t n, i;
    hold_above(body, 2 - 1e-9);
    view = view_of(body);
    n = 3 * view.copy_count;
    state = (double *)calloc(4 * n, sizeof *state);
    vector = state + 2 * n;
    rest = state + 3 * n;
    random_seed(5);
    for (i = 0; i < n; i++) view.velocity[i] = state[n + i] = random_real(-1, 1);
    for (i = 0; i < n; i++) vector[i] = random_real(-0.02, 0.02);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    memset(&spring, 0, sizeof spring);
    spring.point = gx_skin_point(&skin, 7);
    spring.stiffness = 1e4;
    points[0] = gx_skin_point(&skin, 0);
    points[1] = gx_skin_point(&skin, 5);
    memset(&plane, 0, sizeof plane);
    plane.normal[2] = 1;
    plane.offset = 0.5;
    plane.stiffness = 1e4;
    step.gravity[0] = 2;
    step.integrator = GXS_BDF1;
    step.newton_iterations = 3;
    step.newton_tolerance = 1e-3;
    step.cg_iterations = 7;
    step.cg_tolerance = 1e-3;
    step.mass_damping = 3;
    step.forces = step.targets = vector;
    step.epoch = view.epoch;
    step.springs = &spring;
    step.spring_count = 1;
    step.spring_forces = forces[0];
    step.points = points;
    step.point_count = 2;
    step.planes = &plane;
    step.plane_count = 1;
    step.contact = pushes;
    step.contact_user = &push;
    step.sleep_speed = 0.01;
    step.sleep_time = 0.1;
    own = solver_step(&step);
    own.mass_damping = 3;
    own.forces = own.targets = vector;
    own.epoch = view.epoch;
    own.springs = &spring;
    own.spring_count = 1;
    own.spring_forces = forces[1];
    own.points = points;
    own.point_count = 2;
    own.planes = &plane;
    own.plane_count = 1;
    own.contact = pushes;
    own.contact_user = &push;
    own.sleep_speed = 0.01;
    own.sleep_time = 0.1;
    own.rest_times = rest;
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
    for (i = 0; i < 3; i++) {
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(solver, &own, state, state + n, NULL, NULL), GX_OK);
    }
    ck_assert_int_eq(memcmp(state, view.displacement, n * sizeof *state), 0);
    ck_assert_int_eq(memcmp(state + n, view.velocity, n * sizeof *state), 0);
    ck_assert_int_eq(memcmp(rest, view.rest_time, view.copy_count * sizeof *rest), 0);
    ck_assert_int_eq(memcmp(forces[0], forces[1], sizeof forces[0]), 0);
    step.budget_seconds = 1; /* and nothing to tell the time */
    ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_ERROR_ARGUMENT);
    free(state);
    gxs_solver_destroy(solver);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A hit or a skin of more copies than a point holds is referred to. */
START_TEST(points_hold_few_copies_or_refer) {
    uint32_t copies[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, k;
    double weights[12] = {0.125, 0.25}, rest[6] = {1, 2, 3, 4, 5, 6};
    gx_skin skin;
    gx_hit hit;
    gxs_point p;
    memset(&skin, 0, sizeof skin);
    memset(&hit, 0, sizeof hit);
    skin.vertex_width = 4;
    skin.vertex_copies = copies;
    skin.vertex_weights = weights;
    skin.vertex_rest = rest;
    skin.epoch = hit.epoch = 77;
    p = gx_skin_point(&skin, 1);
    ck_assert(p.count == 4 && p.copies == NULL && p.weights == NULL && p.epoch == 77 && p.position[2] == 6);
    for (k = 0; k < 4; k++) ck_assert(p.copy[k] == 4 + k);
    skin.vertex_width = 6;
    p = gx_skin_point(&skin, 1);
    ck_assert(p.count == 6 && p.copies == copies + 6 && p.weights == weights + 6 && p.position[0] == 4);
    hit.copy_count = 3;
    memcpy(hit.copies, copies, sizeof copies);
    hit.weights[1] = 1;
    hit.material[1] = 8;
    p = gx_hit_point(&hit);
    ck_assert(p.count == 3 && p.copies == NULL && p.weight[1] == 1 && p.position[1] == 8 && p.epoch == 77);
    hit.copy_count = 12;
    p = gx_hit_point(&hit);
    ck_assert(p.count == 12 && p.copies == hit.copies && p.weights == hit.weights);
}
END_TEST

/* ---- violent starts of cut bodies ---- */

enum { INVERTED, FLATTENED, COLLAPSED, STRETCHED, TANGLED, START_COUNT };

/* A displacement; edges are 1 m */
static double violent(int how, size_t axis, double rest) {
    switch (how) {
    case INVERTED: return axis == 2 ? -2 * rest : 0;
    case FLATTENED: return axis == 2 ? -rest : 0;
    case COLLAPSED: return -rest;
    case STRETCHED: return 2 * rest;
    default: return random_real(-1, 1);
    }
}

/* k Newton iterations from one start, k = 1, 2, ...: the results are the accepted iterates of the longest run. The
   body is cut across, part way, and 1e-9 beside the first cut. From any start, E falls with each iterate and all
   numbers are finite; a collapsed body opens. */
START_TEST(energy_of_cut_bodies_falls_from_violent_starts) {
    static const double dts[2] = {0.033, 1}, ratios[2] = {0.4, 0.4999};
    static const double n[3][3] = {{0.3, 1, 0.2}, {1, 0.1, 0}, {0.3, 1, 0.2}};
    static const double p[3][3] = {{1.5, 1.4, 1.6}, {1.7, 1.2, 1.1}, {1.5, 1.400000001, 1.6}};
    const int how = _i / 4;
    workload w = grid(3, 3, 3, 5);
    gx_body *body;
    gxs_model model;
    gxs_material material;
    gxs_solver *solver = NULL;
    gxs_step_report report;
    const gx_step_desc like = step_of(dts[_i % 2], 0);
    gxs_step_desc step = solver_step(&like);
    double *start, *u, *v, before;
    size_t i, count;
    uint32_t k;
    random_seed((uint64_t)_i);
    for (i = 0; i < 3; i++) add_plane(&w, p[i], n[i], i == 1 ? 1.2 : 10);
    body = cut_at_once(&w);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    material = model.materials[0];
    material.poisson = ratios[_i / 2 % 2];
    model.materials = &material;
    count = 3 * model.copy_count;
    start = (double *)malloc(3 * count * sizeof *start);
    u = start + count;
    v = u + count;
    for (i = 0; i < count; i++) start[i] = violent(how, i % 3, model.positions[i]);
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    before = form_energy(&model, start);
    for (k = 1; k <= 20; k++) {
        memcpy(u, start, count * sizeof *u);
        memset(v, 0, count * sizeof *v);
        step.newton_iterations = k;
        ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(solver, &step, u, v, &report, NULL), GX_OK);
        for (i = 0; i < count; i++) ck_assert(isfinite(u[i]) && isfinite(v[i]));
        ck_assert_msg(isfinite(report.residual) && report.energy <= before + 1e-12 * fabs(before),
                      "iterate %u: %.17g after %.17g", (unsigned)k, report.energy, before);
        before = report.energy;
        if (report.newton_iterations < k) break;
    }
    ck_assert(memcmp(u, start, count * sizeof *u) != 0);
    ck_assert(report.stop == GXS_STOP_BALANCE || report.stop == GXS_STOP_ITERATIONS ||
              report.stop == GXS_STOP_ROUNDING);
    ck_assert_msg(report.stop != GXS_STOP_ROUNDING || report.residual < 1e-6, "gives up at a residual of %g",
                  report.residual);
    ck_assert(report.stop != GXS_STOP_ITERATIONS || report.newton_iterations == step.newton_iterations);
    gxs_solver_destroy(solver);
    free(start);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- history ---- */

/* BDF2 on a body that falls: of second order, so exact from the second step on except for the first one's error. A
   cut in between does not show in the motion, so new copies have the history of the old. */
START_TEST(bdf2_goes_on_after_a_cut) {
    workload w = grid(2, 2, 2, 5);
    gx_body *cut = body_of(&w), *whole = body_of(&w);
    gx_step_desc step = step_of(0.01, -9.81);
    gx_view a, b;
    size_t i;
    int k;
    add_axis_plane(&w, 0, 0.7);
    step.integrator = GXS_BDF2;
    step.newton_tolerance = 1e-13;
    step.newton_iterations = 5;
    a = view_of(cut);
    b = view_of(whole);
    for (i = 0; i < a.copy_count; i++)
        for (k = 0; k < 3; k++) a.velocity[3 * i + (size_t)k] = b.velocity[3 * i + (size_t)k] = 0.1 * k;
    advance(cut, &step, 4);
    advance(whole, &step, 4);
    cut_by(cut, &w, 0, 1);
    advance(cut, &step, 6);
    advance(whole, &step, 6);
    a = view_of(cut);
    b = view_of(whole);
    ck_assert_uint_eq(a.fragment_count, 2);
    for (i = 0; i < a.copy_count; i++)
        for (k = 0; k < 3; k++) {
            ck_assert_double_eq_tol(a.displacement[3 * i + (size_t)k], b.displacement[(size_t)k], 1e-13);
            ck_assert_double_eq_tol(a.velocity[3 * i + (size_t)k], 0.1 * k - (k == 2) * 9.81 * 0.1, 1e-12);
        }
    /* After a step of another kind it begins again, by backward Euler. */
    step.integrator = GXS_BDF1;
    advance(whole, &step, 1);
    step.integrator = GXS_BDF2;
    b = view_of(whole);
    {
        const double before = b.displacement[2], speed = b.velocity[2];
        advance(whole, &step, 1);
        ck_assert_double_eq_tol(b.displacement[2] - before, 0.01 * (speed - 0.0981), 1e-13);
    }
    gx_body_destroy(cut);
    gx_body_destroy(whole);
    wl_free(&w);
}
END_TEST

/* ---- sleep ---- */

/* A block cut in two by its middle hangs on both sides and comes to rest. A cut wakes the side that it touches, not
   the other. */
START_TEST(cuts_wake_what_they_touch) {
    workload w = grid(4, 2, 2, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL;
    gx_material material;
    gx_step_desc step = step_of(0.033, -9.81);
    gxs_step_report report;
    gx_view view;
    double *before;
    size_t i, left = 0, all;
    int n;
    memset(&material, 0, sizeof material);
    material.elastic.young = 1e6;
    material.elastic.poisson = 0.4;
    material.density = 1000;
    desc.materials = &material;
    desc.material_count = 1;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    add_axis_plane(&w, 0, 2.25);
    add_box(&w, 0, -1, -1, 0.5, 1.75, 4, 0.75);
    cut_by(body, &w, 0, 1);
    hold_above(body, 2 - 1e-9);
    step.sleep_speed = 1e-3;
    step.mass_damping = 5;
    report = advance(body, &step, 1);
    for (n = 0; n < 400 && report.stop != GXS_STOP_ASLEEP; n++) report = advance(body, &step, 1);
    ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    ck_assert_uint_eq(report.active_unknowns, 0);
    cut_by(body, &w, 1, 1);
    view = view_of(body);
    before = (double *)malloc(3 * view.copy_count * sizeof *before);
    memcpy(before, view.displacement, 3 * view.copy_count * sizeof *before);
    for (i = all = 0; i < view.copy_count; i++) all += view.copy_held[i] ? 0 : 3;
    report = advance(body, &step, 1);
    ck_assert_msg(report.active_unknowns > 0 && report.active_unknowns < all, "%zu of %zu", report.active_unknowns,
                  all);
    report = advance(body, &step, 20);
    for (i = 0; i < view.copy_count; i++) {
        const int moved = memcmp(before + 3 * i, view.displacement + 3 * i, 3 * sizeof *before) != 0;
        left += moved;
        ck_assert(!moved || view.rest_time[i] < 1);
    }
    ck_assert(3 * left > 0 && 3 * left < all);
    free(before);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A block cut in two at x = 2.25 hangs by its top, asleep. */
static gx_body *hung_asleep(const workload *w, double support_below, const gx_step_desc *step) {
    gx_body_desc desc = desc_of(w);
    gx_body *body = NULL;
    int n;
    desc.support_below = support_below;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    cut_by(body, w, 0, 1);
    hold_above(body, 2 - 1e-9);
    for (n = 0; n < 400 && advance(body, step, 1).stop != GXS_STOP_ASLEEP; n++) continue;
    ck_assert_uint_eq(advance(body, step, 1).active_unknowns, 0);
    return body;
}

/* A sleeper that hangs falls when its hold is released. */
START_TEST(released_sleepers_fall) {
    workload w = grid(4, 2, 2, 5);
    gx_step_desc step = step_of(0.033, -9.81);
    gx_body *body;
    gx_view view;
    size_t i;
    add_axis_plane(&w, 0, 2.25);
    step.sleep_speed = 1e-3;
    step.mass_damping = 5;
    body = hung_asleep(&w, 0, &step);
    ck_assert_int_eq(gx_body_hold(body, NULL, 0, NULL), GX_OK);
    view = view_of(body);
    ck_assert_uint_eq(advance(body, &step, 1).active_unknowns, 3 * view.copy_count);
    advance(body, &step, 9);
    for (i = 0; i < view.copy_count; i++)
        ck_assert_msg(view.displacement[3 * i + 2] < -0.2, "copy %zu has fallen %g m", i,
                      -view.displacement[3 * i + 2]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

enum { HELD_AGAIN, CLONED, LOADED, CUT_ELSEWHERE, CUT_WITHOUT_SUPPORT, CHANGE_COUNT };

/* A free copy far right */
static size_t right_of(const gx_view *view, const workload *w) {
    size_t i = 0;
    while (view->copy_held[i] || w->positions[3 * view->copy_node[i]] < 3.5) i++;
    return i;
}

/* Writes a displacement to it, or a velocity below sleep_speed. */
static void write_right(gx_body *body, const workload *w, int velocity) {
    gx_view view = view_of(body);
    if (velocity)
        view.velocity[3 * right_of(&view, w)] = 5e-4;
    else
        view.displacement[3 * right_of(&view, w)] += 0.3;
}

/* Writing to a sleeper wakes it, and its clone and loaded copy alike, bit for bit, whatever happens to the body
   before the step: after the write (late 0) or before it (1). */
START_TEST(sleepers_see_what_is_written_through_changes) {
    const int change = _i / 4, velocity = _i / 2 % 2, late = _i % 2;
    workload w = grid(4, 2, 2, 5);
    gx_step_desc step = step_of(0.033, -9.81);
    gxs_step_report report, twins;
    gx_body *body, *twin = NULL;
    gx_view view, other;
    size_t at, size;
    double was;
    void *bytes;
    int n;
    add_axis_plane(&w, 0, 2.25);
    add_box(&w, 0, -1, -1, 0.5, 1.75, 4, 0.75);
    step.sleep_speed = 1e-3;
    step.mass_damping = 5;
    body = hung_asleep(&w, change == CUT_WITHOUT_SUPPORT ? 1e-4 : 0, &step);
    if (!late) write_right(body, &w, velocity);
    switch (change) {
    case HELD_AGAIN: hold_above(body, 2 - 1e-9); break;
    case CLONED: ck_assert_int_eq(gx_body_clone(body, &twin, NULL), GX_OK); break;
    case LOADED:
        ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
        bytes = malloc(size);
        ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
        ck_assert_int_eq(gx_body_load(bytes, size, NULL, &twin, NULL), GX_OK);
        free(bytes);
        break;
    default: cut_by(body, &w, 1, 1);
    }
    if (late) write_right(body, &w, velocity);
    if (late && twin) write_right(twin, &w, velocity);
    view = view_of(body);
    at = right_of(&view, &w);
    was = view.displacement[3 * at];
    for (n = 0; n < 20; n++) {
        report = advance(body, &step, 1);
        ck_assert_msg(n > 0 ||
                          (report.active_unknowns > 0 && view.displacement[3 * at] != was && view.rest_time[at] < 0.5),
                      "%zu unknowns awake, moved by %g m", report.active_unknowns, view.displacement[3 * at] - was);
        if (!twin) continue;
        twins = advance(twin, &step, 1);
        other = view_of(twin);
        ck_assert_uint_eq(report.active_unknowns, twins.active_unknowns);
        ck_assert_msg(memcmp(view.displacement, other.displacement, 3 * view.copy_count * sizeof was) == 0 &&
                          memcmp(view.velocity, other.velocity, 3 * view.copy_count * sizeof was) == 0,
                      "step %d", n);
    }
    if (!velocity) ck_assert(view.displacement[3 * at] < was - 0.2);
    gx_body_destroy(body);
    gx_body_destroy(twin);
    wl_free(&w);
}
END_TEST

/* ---- copies without support ---- */

/* A corner cut off so close to its node that it has 1e-12 ... 1e-3 of its element falls like the rest, as a point
   whether or not support_below says so. It never disturbs the body that it has left. */
START_TEST(tiny_corners_fall) {
    static const double sizes[3] = {1e-1, 1e-2, 1e-4};
    workload w = grid(1, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_step_desc step = step_of(0.033, -9.81);
    gxs_step_report report;
    const double size = sizes[_i / 2], n[3] = {1, 1, 1};
    double p[3];
    gx_body *body = NULL;
    gx_view view;
    gxs_model model;
    size_t i;
    int k;
    for (k = 0; k < 3; k++) p[k] = size / 3;
    add_plane(&w, p, n, 20);
    desc.support_below = _i % 2 ? 2e-3 : 0;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    cut_by(body, &w, 0, 1);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert_uint_eq(model.constraint_count, view.copy_count - 8 - 1); /* one leads */
    for (i = 0; i < 3 * view.copy_count; i++) view.velocity[i] = (double)(i % 3);
    report = advance(body, &step, 10);
    ck_assert(report.cg_iterations < 30);
    for (i = 0; i < view.copy_count; i++) {
        const double fallen = 9.81 * 0.033 * 0.033 * 55;
        ck_assert_double_eq_tol(view.displacement[3 * i + 2], 0.66 - fallen, 1e-9);
        ck_assert_double_eq_tol(view.displacement[3 * i + 1], 0.33, 1e-9);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A box that is cut out around a node is a speck if it reaches less than a quarter as far as the elements there: it
   moves as a point, though its parts are well above what else makes copies weak. A larger one moves by its copies. */
START_TEST(specks_are_told_by_their_reach) {
    const double half[2] = {0.07, 0.2}; /* of a cube's side */
    const gx_step_desc step = step_of(0.01, 0);
    workload w = grid(2, 2, 2, 5);
    gx_body *body;
    gx_view view;
    gxs_model model;
    uint8_t *in_box;
    double most = 0, apart = 0;
    size_t i, c, lead = SIZE_MAX, of_box = 0, follow = 0;
    add_box(&w, 0, 1 - half[_i], 1 - half[_i], 1 - half[_i], 1 + half[_i], 1 + half[_i], 1 + half[_i]);
    body = body_of(&w);
    cut_by(body, &w, 0, 1);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    in_box = (uint8_t *)calloc(view.copy_count, 1);
    for (c = 0; c < 4 * view.cell_count; c++) {
        if (view.fragment_volume[view.cell_fragment[c / 4]] > 1) continue;
        most = fmax(most, 6 * view.cell_volume[c / 4]);
        in_box[view.cell_copies[c]] = 1;
    }
    ck_assert_double_gt(most, 1.5e-3);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    for (c = 0; c < model.constraint_count; c++) follow += in_box[model.constraints[c].copy];
    for (i = 0; i < view.copy_count; i++) {
        if (!in_box[i]) continue;
        if (lead == SIZE_MAX) lead = i;
        of_box++;
        view.velocity[3 * i] = w.positions[3 * view.copy_node[i] + 1] - 1;
    }
    (void)advance(body, &step, 1);
    for (i = 0; i < view.copy_count; i++)
        if (in_box[i]) apart = fmax(apart, fabs(view.velocity[3 * i] - view.velocity[3 * lead]));
    if (_i == 0)
        ck_assert_msg(follow == of_box - 1 && !(apart > 0), "%zu of %zu follow, %g m/s apart", follow, of_box, apart);
    else
        ck_assert_msg(follow < of_box - 4 && apart > 0.1, "%zu of %zu follow, %g m/s apart", follow, of_box, apart);
    free(in_box);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Bodies most of whose copies have too little support of their own can be stepped. Copies that follow others do not
   follow followers. */
START_TEST(few_supports_are_enough) {
    const gx_step_desc step = step_of(0.01, -9.81);
    int n, i, k, j;
    random_seed((uint64_t)_i * 11 + 3);
    for (n = 0; n < 30; n++) {
        workload w = grid(1 + (size_t)random_below(2), 1 + (size_t)random_below(2), 1, 5);
        gx_body_desc desc = desc_of(&w);
        gx_body *body = NULL;
        gxs_model model;
        size_t c;
        uint8_t *follows;
        desc.support_below = n % 2 ? 0.3 : pow(10, random_real(-5, -0.5));
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        for (i = 0; i < 10; i++) {
            double point[3], normal[3];
            for (k = 0; k < 3; k++) {
                point[k] = random_real(0, 1);
                normal[k] = random_real(-1, 1);
            }
            add_plane(&w, point, normal, random_below(2) ? 40 : 0.7);
            cut_by(body, &w, (size_t)i, 1);
        }
        ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
        follows = (uint8_t *)calloc(model.copy_count, 1);
        for (c = 0; c < model.constraint_count; c++) follows[model.constraints[c].copy] = 1;
        for (c = 0; c < model.constraint_count; c++)
            for (j = 0; j < 4; j++)
                ck_assert(!(fabs(model.constraints[c].weight[j]) > 0) || !follows[model.constraints[c].master[j]]);
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        free(follows);
        gx_body_destroy(body);
        wl_free(&w);
    }
}
END_TEST

/* A body at rest is kicked, or moved, in one of the steps around the one in which it would fall asleep: it is awake
   then. */
START_TEST(the_step_of_falling_asleep_sees_what_is_written) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_step_desc step = step_of(0.02, 0);
    gxs_step_report report;
    gx_view view = view_of(body);
    size_t c;
    int n;
    step.sleep_speed = 1e-3;
    for (n = 0; n < 20 + _i / 2; n++) ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    if (_i % 2)
        view.displacement[0] += 0.3;
    else
        for (c = 0; c < view.copy_count; c++) view.velocity[3 * c] = 1;
    ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 3 * view.copy_count);
    if (_i % 2)
        ck_assert(view.displacement[0] < 0.29);
    else
        ck_assert_double_eq_tol(view.displacement[3], 0.02, 1e-9);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Six volumes of an element at rest */
static double six_volumes(const workload *w, uint32_t element) {
    const uint32_t *n = w->elements + 4 * (size_t)element;
    double d[3][3];
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++)
            d[i][k] = w->positions[3 * n[i + 1] + (uint32_t)k] - w->positions[3 * n[0] + (uint32_t)k];
    return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) + d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
           d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

/* Largest entry of a vector on copies that carry at least a hundredth of an element, or on all copies */
static double most_of(const workload *w, const gx_view *view, const double *vector, int all) {
    double most = 0;
    size_t i, k;
    for (i = 0; i < view->cell_count; i++)
        for (k = 0; k < 12 && (all || 6 * view->cell_volume[i] > 0.01 * six_volumes(w, view->cell_element[i])); k++)
            most = fmax(most, fabs(vector[3 * view->cell_copies[4 * i + k / 3] + k % 3]));
    return most;
}

/* A kicked block hangs by its top, with slivers of 1e-30 of an element at a node that three planes almost meet, or
   along layers of nodes, an ulp beside them. No copy moves further or faster than ten times the body, by any
   integrator and any support_below. */
START_TEST(kicked_slivers_stay_with_their_body) {
    static const uint64_t seeds[4] = {87, 93, 124, 7};
    static const gxs_integrator integrators[3] = {GXS_BDF1, GXS_BDF2, GXS_MIDPOINT};
    const gx_region top = gx_region_half_space(2, 1, 1.9);
    gx_step_desc step = step_of(1.0 / 60, -9.81);
    workload w;
    gx_body *body = NULL;
    gx_body_desc desc;
    gx_view view;
    size_t i, node;
    double moved = 1, speed = 1;
    int k;
    random_seed(3 * seeds[_i % 4] + 5);
    w = grid(1 + (size_t)random_below(2), 1, 2, 5);
    desc = desc_of(&w);
    desc.support_below = _i / 4 % 2 ? 1e-3 : 0;
    step.integrator = integrators[_i / 8];
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    ck_assert_int_eq(gx_body_hold(body, &top, 1, NULL), GX_OK);
    node = (size_t)random_below((int)w.node_count);
    for (k = 0; k < 3; k++) {
        const double normal[3] = {random_real(-1, 1), random_real(-1, 1), random_real(-1, 1)},
                     off = pow(10, -random_real(9, 16));
        double point[3];
        for (i = 0; i < 3; i++) point[i] = w.positions[3 * node + i] + off * random_real(-1, 1);
        add_plane(&w, point, normal, random_below(2) ? 0.8 : 40);
        cut_by(body, &w, (size_t)k, 1);
    }
    add_axis_plane(&w, 2, nextafter(1, 2));
    cut_by(body, &w, 3, 1);
    view = view_of(body);
    for (i = 0; i < 3 * view.copy_count; i++)
        if (!view.copy_held[i / 3]) view.velocity[i] = random_real(-1, 1);
    for (k = 0; k < 300; k++) {
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        moved = fmax(moved, most_of(&w, &view, view.displacement, 0));
        speed = fmax(speed, most_of(&w, &view, view.velocity, 0));
        ck_assert_msg(most_of(&w, &view, view.displacement, 1) < 10 * moved &&
                          most_of(&w, &view, view.velocity, 1) < 10 * speed,
                      "step %d: %g m where the body moves %g m, %g m/s where it has been at %g m/s", k,
                      most_of(&w, &view, view.displacement, 1), moved, most_of(&w, &view, view.velocity, 1), speed);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Displacement of a bar held at one end, in slices of 1/15 of an element and more, after 0.24 s of gravity */
static double *droop(gxs_integrator integrator, int steps, size_t *count) {
    const gx_region end = gx_region_half_space(0, -1, 0.1);
    gx_step_desc step = step_of(0.24 / steps, -9.81);
    workload w = grid(4, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL;
    gx_view view;
    double *moved;
    size_t i;
    step.integrator = integrator;
    step.newton_iterations = 20, step.newton_tolerance = 1e-9, step.cg_tolerance = 1e-6;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    ck_assert_int_eq(gx_body_hold(body, &end, 1, NULL), GX_OK);
    add_axis_plane(&w, 2, 1.0 / 15);
    add_axis_plane(&w, 2, 4.0 / 15);
    for (i = 0; i < 2; i++) cut_by(body, &w, i, 1);
    advance(body, &step, steps);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    *count = 3 * view.copy_count;
    moved = (double *)malloc(*count * sizeof *moved);
    ck_assert_ptr_nonnull(moved);
    memcpy(moved, view.displacement, *count * sizeof *moved);
    gx_body_destroy(body);
    wl_free(&w);
    return moved;
}

static double apart(const double *a, const double *b, size_t count) {
    double most = 0;
    size_t i;
    for (i = 0; i < count; i++) most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

/* A slice has copies with little of their elements' mass. Where steps resolve it, their motion is the slice's own:
   integrators of second order come to the same. */
START_TEST(motion_of_thin_slices_is_their_own) {
    size_t n;
    double *coarse = droop(GXS_MIDPOINT, 32, &n), *fine = droop(GXS_MIDPOINT, 64, &n),
           *other = droop(GXS_BDF2, 128, &n), *none = (double *)calloc(n, sizeof *none);
    const double most = apart(fine, none, n);
    ck_assert(most > 0.1);
    ck_assert_msg(apart(coarse, fine, n) < 0.005 * most && apart(other, fine, n) < 0.005 * most,
                  "of %g: steps twice as long differ by %g, BDF2 by %g", most, apart(coarse, fine, n),
                  apart(other, fine, n));
    free(coarse), free(fine), free(other), free(none);
}
END_TEST

/* A plane so close to a layer of nodes that the copies behind it have next to no support, in a block that hangs by
   them. They follow the field of the cells before the plane, and the block hangs like the uncut one below. */
START_TEST(copies_without_support_follow_their_fragment) {
    workload w = grid(2, 2, 4, 5);
    gx_body_desc desc = desc_of(&w);
    gx_step_desc step = step_of(0.033, -9.81);
    gx_body *body = NULL;
    gxs_model model;
    gx_view view;
    size_t i, k;
    double *before;
    add_box(&w, 0, -1, -1, 2 + 1e-7, 1.3, 4, 9);
    desc.support_below = 1e-4;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    cut_by(body, &w, 0, 1);
    hold_above(body, 4 - 1e-9);
    advance(body, &step, 3);
    view = view_of(body);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert_uint_gt(model.constraint_count, 0);
    before = (double *)malloc(3 * view.copy_count * sizeof *before);
    memcpy(before, view.displacement, 3 * view.copy_count * sizeof *before);
    advance(body, &step, 3);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    for (i = 0; i < model.constraint_count; i++) {
        const gxs_constraint *c = &model.constraints[i];
        double sum = 0;
        int r;
        for (k = 0; k < 4; k++) sum += c->weight[k];
        ck_assert_double_eq_tol(sum, 1, 1e-12);
        for (r = 0; r < 3; r++) {
            double moved = view.displacement[3 * c->copy + (uint32_t)r] - before[3 * c->copy + (uint32_t)r];
            for (k = 0; k < 4; k++)
                moved -= c->weight[k] *
                         (view.displacement[3 * c->master[k] + (uint32_t)r] - before[3 * c->master[k] + (uint32_t)r]);
            ck_assert(fabs(moved) < 1e-13);
        }
    }
    for (i = 0; i < 3 * view.copy_count; i++) ck_assert(fabs(view.displacement[i]) < 1);
    free(before);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- points of the skin ---- */

/* A corner of the skin of a cut body, pulled by a spring: the spring's force is the rate of change of momentum. */
START_TEST(springs_pull_points_of_the_skin) {
    workload w = grid(2, 2, 2, 5);
    gx_body *body;
    gx_step_desc step = step_of(0.01, 0);
    gxs_spring spring;
    gxs_model model;
    gx_skin skin;
    gx_view view;
    double force[3], speed = 0, mass, *x;
    size_t i, k;
    const double n[3] = {1, 0.2, 0.1}, p[3] = {1.1, 1, 1};
    gx_failure failure;
    add_plane(&w, p, n, 10);
    body = cut_at_once(&w);
    view = view_of(body);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    x = (double *)malloc(3 * skin.vertex_count * sizeof *x);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    memset(&spring, 0, sizeof spring);
    spring.point = gx_skin_point(&skin, 0);
    ck_assert(memcmp(spring.point.position, x, sizeof spring.point.position) == 0);
    memcpy(spring.target, x, sizeof spring.target);
    spring.target[1] += 1;
    spring.stiffness = 1000;
    step.springs = &spring;
    step.spring_count = 1;
    step.spring_forces = force;
    step.newton_iterations = 20;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-8;
    advance(body, &step, 1);
    mass = view.fragment_mass[skin.triangle_fragment[0]];
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    for (i = 0; i < model.element_count; i++)
        for (k = 0; k < 4; k++) {
            static const int rows[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
            int j;
            for (j = 0; j < 4; j++)
                speed += model.elements[i].mass[rows[k][j]] * view.velocity[3 * model.elements[i].copy[k] + 1];
        }
    ck_assert(mass > 0 && force[1] > 900 && force[1] <= 1000);
    /* The solver keeps centres of mass in single precision. */
    ck_assert_double_eq_tol(speed, 0.01 * force[1], 1e-7 * speed);
    spring.point.copy[2] = 100000;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_INDEX);
    ck_assert_uint_eq(failure.index, 0);
    free(x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- copies by the numbers from before a cut ---- */

/* Something of each kind that names copies; kind: the one that is given to the step */
enum { BY_SPRING, BY_POINT, BY_FORCES, BY_TARGETS, KINDS_OF_NAMES };
typedef struct naming {
    gxs_spring springs[2];
    gxs_point points[3];
    double *vector;
    gx_step_desc step;
} naming;

/* All are made again, from the first vertices of the skin. */
static void name_copies(naming *n, gx_body *body, int kind) {
    gx_view view = view_of(body);
    gx_skin skin;
    int i;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    free(n->vector);
    memset(n, 0, sizeof *n);
    n->vector = (double *)calloc(3 * view.copy_count + 1, sizeof *n->vector);
    n->step = step_of(0.01, -9.81);
    for (i = 0; i < 3; i++) {
        n->points[i].epoch = skin.epoch;
        if (skin.vertex_count == 0) continue;
        n->points[i] = gx_skin_point(&skin, (uint32_t)i);
    }
    for (i = 0; i < 2; i++) {
        n->springs[i].point = n->points[i];
        n->springs[i].stiffness = 1;
    }
    if (kind == BY_SPRING) {
        n->step.springs = n->springs;
        n->step.spring_count = 2;
    }
    if (kind == BY_POINT) {
        n->step.points = n->points;
        n->step.point_count = 3;
    }
    if (kind == BY_FORCES) n->step.forces = n->vector;
    if (kind == BY_TARGETS) n->step.targets = n->vector;
    if (kind == BY_FORCES || kind == BY_TARGETS) n->step.epoch = view.epoch;
}

/* The first ones have the present epoch, so that the last one is to blame. */
static void expect_stale(naming *n, gx_body *body, int kind) {
    const uint64_t epoch = view_of(body).epoch, state = gx_body_state_hash(body);
    gx_failure failure;
    n->springs[0].point.epoch = n->points[0].epoch = n->points[1].epoch = epoch;
    ck_assert_int_eq(gx_body_step(body, &n->step, NULL, &failure), GX_ERROR_STALE);
    ck_assert_int_eq(failure.result, GX_ERROR_STALE);
    ck_assert_uint_eq(failure.index, kind == BY_SPRING ? 1 : kind == BY_POINT ? 2 : SIZE_MAX);
    ck_assert(gx_body_state_hash(body) == state);
}

/* A cut that leaves all copies leaves their numbers valid. One that creates or removes copies makes them stale until
   they are made again; so it is in a body of which nothing is left. With support_below the solver gets each model
   whole, otherwise it may get changes. */
START_TEST(names_of_copies_go_stale) {
    const int kind = _i % KINDS_OF_NAMES;
    workload w = grid(2, 2, 2, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL;
    gx_cut_report report;
    wl_surface *part;
    naming n;
    uint64_t epoch;
    size_t i;
    const double corners[3][3] = {{0.2, 0.2, 0.3}, {0.3, 0.2, 0.3}, {0.2, 0.3, 0.3}};
    memset(&n, 0, sizeof n);
    desc.support_below = _i / KINDS_OF_NAMES ? 1e-3 : 0;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    hold_above(body, 2 - 1e-9);
    add_axis_plane(&w, 0, 40);
    part = wl_add_surface(&w, 0);
    for (i = 0; i < 3; i++) wl_add_vertex(part, corners[i]);
    wl_add_triangle(part, 0, 1, 2);
    add_axis_plane(&w, 0, 1.3);
    add_box(&w, 1, -1, -1, -1, 1.1, 3, 3);
    add_box(&w, 1, -1, -1, -1, 3, 3, 3);
    ck_assert(view_of(body).epoch == 0);
    name_copies(&n, body, kind);
    for (i = 0; i < 5; i++) {
        advance(body, &n.step, 1);
        epoch = view_of(body).epoch;
        report = cut_by(body, &w, i, 1);
        ck_assert((report.created_copies > 0) == (i == 2) && (report.removed_copies > 0) == (i > 2));
        ck_assert(report.touched_elements > 0 || i == 0);
        ck_assert((view_of(body).epoch == epoch) == (i < 2));
        if (i < 2) continue;
        ck_assert(view_of(body).epoch != 0);
        expect_stale(&n, body, kind);
        name_copies(&n, body, kind);
    }
    ck_assert_uint_eq(view_of(body).copy_count, 0);
    n.step.spring_count = n.step.point_count = 0; /* nothing is left that they could name */
    advance(body, &n.step, 1);
    free(n.vector);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A ray along mesh edges and faces meets corners and edges of triangles: what has no share is not in the hit. */
START_TEST(hits_at_corners_and_edges) {
    static const double up[3] = {0, 0, 1}, at[4][2] = {{1, 1}, {0.5, 1}, {1, 0.25}, {0.5, 0.5}};
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    gx_view view = view_of(body);
    gx_skin skin;
    size_t c;
    int i;
    for (c = 0; c < view.copy_count; c++) view.displacement[3 * c + 2] = 0.125; /* as a whole, upwards */
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    for (i = 0; i < 4; i++) {
        const double origin[3] = {at[i][0], at[i][1], -5};
        double sum = 0;
        gx_hit hit;
        uint32_t n;
        ck_assert_int_eq(gx_body_pick(body, origin, up, &hit, NULL), GX_OK);
        ck_assert_uint_ne(hit.triangle, UINT32_MAX);
        ck_assert(hit.position[0] == at[i][0] && hit.position[1] == at[i][1] && hit.position[2] == 0.125);
        ck_assert(hit.material[2] == 0);
        for (n = 0; n < hit.copy_count; n++) {
            ck_assert_double_gt(hit.weights[n], 0);
            sum += hit.weights[n];
        }
        ck_assert(sum == 1 && hit.copy_count <= 3);
        if (i == 0) ck_assert_uint_eq(hit.copy_count, 1);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* View, skin, hit and model of a cut body; a spring at the hit is fine. */
START_TEST(whoever_tells_copies_tells_the_epoch) {
    static const double origin[3] = {0.3, 0.4, -5}, up[3] = {0, 0, 1};
    workload w = grid(2, 2, 2, 5);
    gx_body *body;
    gx_step_desc step = step_of(0.01, 0);
    gxs_spring spring;
    gxs_model model;
    gx_view view;
    gx_skin skin;
    gx_hit hit;
    add_axis_plane(&w, 1, 0.8);
    body = cut_at_once(&w);
    view = view_of(body);
    ck_assert(view.epoch != 0);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    ck_assert_int_eq(gx_body_pick(body, origin, up, &hit, NULL), GX_OK);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert(skin.epoch == view.epoch && hit.epoch == view.epoch && model.epoch == view.epoch);
    memset(&spring, 0, sizeof spring);
    spring.point = gx_hit_point(&hit);
    spring.stiffness = 1;
    step.springs = &spring;
    step.spring_count = 1;
    advance(body, &step, 1);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static double ticks(void *user) { return *(double *)user += 1; }

/* All seconds of a report are those of the step's own clock, if it has one. The body has none here. */
START_TEST(a_step_has_its_own_clock) {
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    gx_step_desc step = step_of(0.01, -9.81);
    gxs_step_report report;
    double now = 0;
    hold_above(body, 2 - 1e-9);
    ck_assert(advance(body, &step, 1).seconds == 0);
    step.clock = ticks;
    step.clock_user = &now;
    report = advance(body, &step, 1);
    ck_assert(report.seconds == now - 1 && report.seconds > report.seconds_linearise + report.seconds_solve);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("steps");
    TCase *tests = tcase_create("steps");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, materials_by_element);
    tcase_add_test(tests, bad_materials_are_named);
    tcase_add_loop_test(tests, model_is_what_the_body_moves, 0, 4);
    tcase_add_test(tests, every_field_of_a_step_counts);
    tcase_add_test(tests, points_hold_few_copies_or_refer);
    tcase_add_test(tests, hits_at_corners_and_edges);
    ADD_SOME(tests, energy_of_cut_bodies_falls_from_violent_starts, 4 * START_COUNT);
    tcase_add_test(tests, bdf2_goes_on_after_a_cut);
    tcase_add_test(tests, cuts_wake_what_they_touch);
    tcase_add_test(tests, released_sleepers_fall);
    tcase_add_loop_test(tests, sleepers_see_what_is_written_through_changes, 0, 4 * CHANGE_COUNT);
    tcase_add_loop_test(tests, tiny_corners_fall, 0, 6);
    tcase_add_loop_test(tests, specks_are_told_by_their_reach, 0, 2);
    tcase_add_test(tests, copies_without_support_follow_their_fragment);
    tcase_add_loop_test(tests, few_supports_are_enough, 0, 4);
    tcase_add_loop_test(tests, kicked_slivers_stay_with_their_body, 0, 24);
    tcase_add_test(tests, motion_of_thin_slices_is_their_own);
    tcase_add_loop_test(tests, the_step_of_falling_asleep_sees_what_is_written, 0, 20);
    tcase_add_test(tests, springs_pull_points_of_the_skin);
    tcase_add_loop_test(tests, names_of_copies_go_stale, 0, 2 * KINDS_OF_NAMES);
    tcase_add_test(tests, whoever_tells_copies_tells_the_epoch);
    tcase_add_test(tests, a_step_has_its_own_clock);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
