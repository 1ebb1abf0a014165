/* test_explicit.c - explicit steps (GXS_EXPLICIT): their order and limit, energy, free fall, where steps are implicit
   instead, cuts, jobs and memory; and steps by the error asked for (gxs_step_desc.quality), which take them or implicit
   ones. Truth: converged implicit steps with the same lumped mass. */
#define GXFEM_SOLVE_IMPLEMENTATION
#include "../gxfem_solve.h"

#include "block.h"

/* A bar of cubes of 0.25 m, held on its left */
static scene hanging_bar(double young) {
    scene s;
    seed(7);
    s = scene_block(5, 2, 2, 0.25, 0.05, 0);
    s.material->young = young;
    s.model.lumped_mass = 1;
    scene_hold_left(&s);
    return s;
}

static gxs_step_desc explicit_step(double dt, uint32_t substeps) {
    gxs_step_desc step = step_make(dt, -9.81);
    step.integrator = GXS_EXPLICIT;
    step.substeps = substeps;
    return step;
}

/* Steps from the scene's state; returns how many were explicit. */
static int move(scene *s, const gxs_step_desc *step, int steps, gxs_step_report *last) {
    gxs_solver *solver = solver_make();
    gxs_step_report report;
    int i, count = 0;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s->model, NULL), GX_OK);
    for (i = 0; i < steps; i++) {
        ck_assert_int_eq(gxs_solver_step(solver, step, s->displacement, s->velocity, &report, NULL), GX_OK);
        count += report.substeps > 0;
    }
    if (last) *last = report;
    gxs_solver_destroy(solver);
    return count;
}

/* The largest difference of any copy as a share of the largest displacement */
static double difference(const scene *s, const double *u) {
    double worst = 0, largest = 0;
    size_t i;
    for (i = 0; i < 3 * s->model.copy_count; i++) {
        worst = fmax(worst, fabs(s->displacement[i] - u[i]));
        largest = fmax(largest, fabs(u[i]));
    }
    ck_assert(largest > 1e-3);
    return worst / largest;
}

/* Kinetic, elastic and potential energy with lumped mass, J */
static double energy_of(const scene *s) {
    const size_t count = 3 * s->model.copy_count;
    double sum = form_energy(&s->model, s->displacement), *mass = (double *)zeroed(count, sizeof(double));
    size_t i;
    for (i = 0; i < count; i++) s->forces[i] = 1;
    form_mass_product(&s->model, s->forces, mass);
    for (i = 0; i < count; i++) sum += 0.5 * mass[i] * s->velocity[i] * s->velocity[i];
    for (i = 2; i < count; i += 3) sum += 9.81 * mass[i] * s->displacement[i];
    free(mass);
    return sum;
}

/* The end of many substeps is that of converged midpoint steps but for the mass added; with fewer the error is of
   second order, with and without a filter. */
START_TEST(converges_with_order_two) {
    scene truth = hanging_bar(2e5), fine = hanging_bar(2e5);
    gxs_step_desc step = step_make(0.1 / 400, -9.81);
    gxs_step_report report;
    double error[4];
    int i;
    step.integrator = GXS_MIDPOINT;
    step.newton_iterations = 20;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-6;
    move(&truth, &step, 400, NULL);
    step = explicit_step(0.1, 1600);
    ck_assert_int_eq(move(&fine, &step, 1, &report), 1);
    ck_assert_uint_eq(report.substeps, 1600);
    ck_assert_uint_eq(report.newton_iterations, 0);
    error[0] = difference(&fine, truth.displacement);
    assert_that(error[0] < 5e-3, "%g", error[0]);
    for (i = 0; i < 4; i++) { /* from a filter of degree 4 or so to none */
        scene s = hanging_bar(2e5);
        step = explicit_step(0.1, 12u << i);
        ck_assert_int_eq(move(&s, &step, 1, &report), 1);
        error[i] = difference(&s, fine.displacement);
        scene_free(&s);
    }
    for (i = 1; i < 4; i++)
        assert_that(error[i] < error[i - 1] / 2.5, "%g %g %g %g", error[0], error[1], error[2], error[3]);
    assert_that(error[3] < 2e-3, "%g", error[3]);
    scene_free(&truth);
    scene_free(&fine);
}
END_TEST

/* A bar that swings for three seconds: steps stay explicit, no energy is created, little is lost. */
START_TEST(energy_is_not_created) {
    scene s = hanging_bar(2e5);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = explicit_step(1.0 / 60, (uint32_t)_i);
    double most = -1e300, size = 0, energy = 0;
    int frame, implicit = 0;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 180; frame++) {
        gxs_step_report report;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        implicit += report.substeps == 0;
        energy = energy_of(&s);
        most = fmax(most, energy);
        size = fmax(size, form_energy(&s.model, s.displacement));
    }
    assert_that(implicit == 0, "%d implicit", implicit);
    assert_that(most < 5e-3 * size, "%g of %g", most, size);
    assert_that(energy > -0.1 * size, "%g of %g", energy, size);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A free body falls by g t^2 / 2, far from where it was at rest, and does not deform. Damped, it approaches g / alpha.
 */
START_TEST(free_fall) {
    scene s = hanging_bar(2e5);
    gxs_step_desc step = explicit_step(0.1, 0);
    size_t i;
    memset(s.held, 0, s.model.copy_count);
    for (i = 0; i < s.model.copy_count; i++) s.displacement[3 * i] = 1e4, s.velocity[3 * i + 1] = 3;
    ck_assert_int_eq(move(&s, &step, 10, NULL), 10);
    for (i = 0; i < s.model.copy_count; i++) {
        ck_assert(fabs(s.displacement[3 * i] - 1e4) < 1e-5);
        ck_assert(fabs(s.displacement[3 * i + 1] - 3) < 1e-5);
        ck_assert(fabs(s.displacement[3 * i + 2] + 0.5 * 9.81) < 1e-5);
        ck_assert(fabs(s.velocity[3 * i + 2] + 9.81) < 1e-5);
    }
    step.mass_damping = 5;
    ck_assert_int_eq(move(&s, &step, 40, NULL), 40);
    for (i = 0; i < s.model.copy_count; i++) ck_assert(fabs(s.velocity[3 * i + 2] + 9.81 / 5) < 1e-5);
    scene_free(&s);
}
END_TEST

/* A spinning free body keeps its spin: the energy that it has, and the mean velocity of its copies */
START_TEST(spin_is_kept) {
    scene s = hanging_bar(2e5);
    gxs_step_desc step = explicit_step(1.0 / 60, 0);
    double *mass = (double *)zeroed(3 * s.model.copy_count, sizeof(double)), spin[2] = {0, 0};
    size_t i;
    int k;
    step.gravity[2] = 0;
    memset(s.held, 0, s.model.copy_count);
    for (i = 0; i < s.model.copy_count; i++) {
        s.velocity[3 * i] = -2 * (s.rest[3 * i + 1] - 0.25);
        s.velocity[3 * i + 1] = 2 * (s.rest[3 * i] - 0.625);
    }
    for (k = 0; k < 2; k++) {
        form_mass_product(&s.model, s.velocity, mass);
        for (i = 0; i < s.model.copy_count; i++)
            spin[k] += (s.rest[3 * i] + s.displacement[3 * i]) * mass[3 * i + 1] -
                       (s.rest[3 * i + 1] + s.displacement[3 * i + 1]) * mass[3 * i];
        if (k == 0) ck_assert_int_eq(move(&s, &step, 60, NULL), 60);
    }
    assert_that(fabs(spin[1] - spin[0]) < 0.02 * spin[0], "%g %g", spin[0], spin[1]);
    free(mass);
    scene_free(&s);
}
END_TEST

/* What a step of GXS_EXPLICIT that must be implicit is made of, one thing at a time */
typedef struct obstacle {
    scene s;
    gxs_step_desc step;
    gxs_constraint constraint;
    gxs_spring spring;
    double *targets;
} obstacle;

enum { STIFF, KIND, DAMPED, FOLLOWING, PULLED, TARGETED, OBSTACLES };

static void obstacle_make(obstacle *o, int kind) {
    memset(o, 0, sizeof *o);
    o->s = hanging_bar(kind == STIFF ? 1e12 : 2e5);
    o->step = explicit_step(0.02, 0);
    if (kind == KIND) o->s.material->kind = GXS_FIXED_COROTATED;
    if (kind == DAMPED) o->s.material->damping = 0.01;
    o->constraint.copy = (uint32_t)o->s.model.copy_count - 1;
    o->constraint.master[0] = o->constraint.copy - 1;
    o->constraint.weight[0] = 1;
    if (kind == FOLLOWING) o->s.model.constraints = &o->constraint, o->s.model.constraint_count = 1;
    o->spring.point.count = 1;
    o->spring.point.copy[0] = 20;
    o->spring.point.weight[0] = 1;
    o->spring.stiffness = 10;
    if (kind == PULLED) o->step.springs = &o->spring, o->step.spring_count = 1;
    o->targets = (double *)zeroed(3 * o->s.model.copy_count, sizeof(double));
    if (kind == TARGETED) o->step.targets = o->targets;
}

static void obstacle_free(obstacle *o) {
    free(o->targets);
    scene_free(&o->s);
}

/* Then the step is backward Euler's, bit by bit. */
START_TEST(other_steps_are_backward_euler) {
    obstacle a, b;
    gxs_step_report report;
    obstacle_make(&a, _i);
    obstacle_make(&b, _i);
    b.step.integrator = GXS_BDF1;
    ck_assert_int_eq(move(&a.s, &a.step, 3, &report), 0);
    ck_assert_uint_eq(report.substeps, 0);
    ck_assert_uint_gt(report.newton_iterations, 0);
    move(&b.s, &b.step, 3, NULL);
    ck_assert_mem_eq(a.s.displacement, b.s.displacement, 3 * a.s.model.copy_count * sizeof(double));
    ck_assert_mem_eq(a.s.velocity, b.s.velocity, 3 * a.s.model.copy_count * sizeof(double));
    obstacle_free(&a);
    obstacle_free(&b);
}
END_TEST

/* A violent start: displaced by up to most, or turned inside out, and as fast as 20 m/s */
static void fling(scene *s, int inside_out, double most) {
    size_t i;
    for (i = 0; i < 3 * s->model.copy_count; i++)
        if (!s->held[i / 3]) {
            s->displacement[i] = inside_out && i % 3 == 2 ? -2 * s->rest[i] : most * uniform();
            s->velocity[i] = 20 * uniform();
        }
}

/* From any start, with any number of substeps: an explicit step creates next to no energy, an implicit one not much,
   and all is finite. */
START_TEST(violent_starts_do_not_blow_up) {
    static const uint32_t substeps[3] = {0, 3, 40};
    scene s = hanging_bar(_i % 2 ? 2e5 : 2e3);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = explicit_step(0.033, substeps[_i % 3]);
    double start, energy, size;
    size_t i;
    int frame;
    seed((uint64_t)_i);
    fling(&s, _i % 4 == 0, 0.4);
    start = energy_of(&s);
    size = fabs(start) + form_energy(&s.model, s.displacement);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 60; frame++) {
        gxs_step_report report;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        for (i = 0; i < 3 * s.model.copy_count; i++)
            ck_assert(finite_bits(s.displacement[i]) && finite_bits(s.velocity[i]));
        energy = energy_of(&s);
        assert_that(energy < start + (report.substeps > 0 ? 0.05 : 0.6) * size, "frame %d: %g of %g", frame, energy,
                    start);
        if (report.substeps == 0) start = energy;
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* After a change of integrator and back each step is that of the same state in a fresh solver, to rounding. */
START_TEST(steps_mix) {
    scene s = hanging_bar(2e5), fresh = hanging_bar(2e5);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = explicit_step(1.0 / 60, 8);
    const size_t bytes = 3 * s.model.copy_count * sizeof(double);
    int i;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (i = 0; i < 12; i++) {
        step.integrator = i % 3 == 1 ? GXS_BDF1 : GXS_EXPLICIT;
        step.newton_iterations = 10;
        step.cg_tolerance = 1e-5;
        memcpy(fresh.displacement, s.displacement, bytes);
        memcpy(fresh.velocity, s.velocity, bytes);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        move(&fresh, &step, 1, NULL);
        ck_assert(difference(&s, fresh.displacement) < 1e-6);
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
    scene_free(&fresh);
}
END_TEST

/* Elements are taken away: the changed model takes the same explicit steps as the model set anew, to rounding. */
START_TEST(updates_are_followed) {
    scene s = hanging_bar(2e5), other = hanging_bar(2e5);
    gxs_solver *solvers[2];
    gxs_step_desc step = explicit_step(1.0 / 60, 8);
    gxs_change change;
    uint32_t *origins = (uint32_t *)zeroed(s.model.copy_count, sizeof *origins), groups[5] = {3, 17, 40, 41, 60};
    size_t i, k, left = 0;
    int frame;
    for (i = 0; i < s.model.element_count; i++) s.elements[i].group = (uint32_t)i;
    s.model.lumped_mass = other.model.lumped_mass = 0; /* else it is set anew anyway */
    for (k = 0; k < 2; k++) solvers[k] = solver_make();
    ck_assert_int_eq(gxs_solver_set_model(solvers[0], &s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solvers[0], &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    memcpy(other.displacement, s.displacement, 3 * s.model.copy_count * sizeof(double));
    memcpy(other.velocity, s.velocity, 3 * s.model.copy_count * sizeof(double));
    for (i = 0; i < s.model.copy_count; i++) origins[i] = 2 * (uint32_t)i;
    memset(&change, 0, sizeof change);
    change.copy_count = s.model.copy_count;
    change.origins = origins;
    change.held = s.held;
    change.groups = groups;
    change.group_count = 5;
    ck_assert_int_eq(gxs_solver_update(solvers[0], &change, NULL), GX_OK);
    for (i = 0; i < s.model.element_count; i++) {
        for (k = 0; k < 5 && groups[k] != i; k++) {}
        if (k == 5) other.elements[left++] = s.elements[i];
    }
    other.model.element_count = left;
    ck_assert_int_eq(gxs_solver_set_model(solvers[1], &other.model, NULL), GX_OK);
    for (frame = 0; frame < 20; frame++) {
        gxs_step_report report;
        ck_assert_int_eq(gxs_solver_step(solvers[0], &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert_uint_eq(report.substeps, 8);
        ck_assert_int_eq(gxs_solver_step(solvers[1], &step, other.displacement, other.velocity, NULL, NULL), GX_OK);
        assert_that(difference(&s, other.displacement) < 1e-4, "%g", difference(&s, other.displacement));
    }
    for (k = 0; k < 2; k++) gxs_solver_destroy(solvers[k]);
    free(origins);
    scene_free(&s);
    scene_free(&other);
}
END_TEST

static void backwards(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    (void)user;
    while (count-- > 0) task(context, count);
}

START_TEST(jobs_do_not_change_bits) {
    double *end[2];
    size_t count = 0;
    int run;
    for (run = 0; run < 2; run++) {
        scene s;
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        gxs_step_desc step = explicit_step(1.0 / 60, 0);
        int i;
        seed(3);
        s = scene_block(12, 8, 8, 0.1, 0.1, 0); /* several chunks and ranges */
        scene_hold_left(&s);
        for (i = 0; i < (int)s.model.copy_count; i++) s.velocity[3 * i + 1] = s.rest[3 * i];
        memset(&desc, 0, sizeof desc);
        if (run) desc.jobs.parallel_for = backwards;
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        for (i = 0; i < 5; i++) {
            gxs_step_report report;
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
            ck_assert_uint_gt(report.substeps, 0);
        }
        count = 3 * s.model.copy_count;
        end[run] = (double *)zeroed(count, sizeof(double));
        memcpy(end[run], s.displacement, count * sizeof(double));
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
    ck_assert_mem_eq(end[0], end[1], count * sizeof(double));
    free(end[0]);
    free(end[1]);
}
END_TEST

/* ---- steps by the error asked for ---- */

static gxs_step_desc quality_step(double dt, double error) {
    gxs_step_desc step = step_make(dt, -9.81);
    step.quality = error;
    return step;
}

/* Softer and stiffer bars reach the error asked for within a factor of three; less error takes no fewer parts or
   substeps. Truth: converged midpoint steps. */
START_TEST(quality_is_reached) {
    static const double errors[3] = {0.1, 0.03, 0.01}, young[3] = {2e5, 2e7, 2e8};
    scene truth = hanging_bar(young[_i]);
    gxs_step_desc step = step_make(0.33 / 2560, -9.81);
    uint32_t before = 0;
    int k;
    truth.model.lumped_mass = 1;
    step.integrator = GXS_MIDPOINT;
    step.newton_iterations = 20;
    step.newton_tolerance = 1e-9;
    step.cg_tolerance = 1e-6;
    move(&truth, &step, 2560, NULL);
    for (k = 0; k < 3; k++) {
        scene s = hanging_bar(young[_i]);
        gxs_step_report report;
        double error;
        step = quality_step(0.033, errors[k]);
        move(&s, &step, 10, &report);
        error = difference(&s, truth.displacement);
        assert_that(error < 3 * errors[k], "%g: %g with %u %u, estimated %g", errors[k], error, report.parts,
                    report.substeps, report.error);
        ck_assert(report.error > 0);
        ck_assert_uint_ge(report.parts * 1000 + report.substeps, before);
        before = report.parts * 1000 + report.substeps;
        scene_free(&s);
    }
    scene_free(&truth);
}
END_TEST

/* From violent starts, stiff or soft, coarse or fine, with a budget or not: all is finite, and no more energy is
   created than the midpoint rule may. */
START_TEST(quality_does_not_blow_up) {
    static const double young[4] = {2e3, 2e5, 2e8, 2e11};
    scene s = hanging_bar(young[_i % 4]);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quality_step(0.033, _i % 3 ? 0.03 : 1);
    double start, energy, size;
    size_t i;
    int frame;
    seed((uint64_t)_i);
    fling(&s, _i % 4 == 0, 0.2);
    start = energy_of(&s);
    size = fabs(start) + form_energy(&s.model, s.displacement);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 30; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        for (i = 0; i < 3 * s.model.copy_count; i++)
            ck_assert(finite_bits(s.displacement[i]) && finite_bits(s.velocity[i]));
        energy = energy_of(&s);
        assert_that(energy < start + 0.6 * size, "frame %d: %g of %g", frame, energy, start);
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A damped bar that has come to rest takes one part. */
START_TEST(quality_at_rest_takes_one_step) {
    scene s = hanging_bar(2e9);
    gxs_step_desc step = quality_step(1.0 / 60, 0.03);
    gxs_step_report report;
    step.mass_damping = 20;
    move(&s, &step, 120, &report);
    ck_assert_uint_eq(report.parts, 1);
    ck_assert_uint_eq(report.substeps, 0);
    ck_assert(report.error < 0.03);
    scene_free(&s);
}
END_TEST

/* Held copies end at their targets, and go there along a straight line: a translated bar does not deform much. */
START_TEST(quality_moves_held_copies) {
    scene s = hanging_bar(2e7);
    double *targets = (double *)zeroed(3 * s.model.copy_count, sizeof(double));
    gxs_step_desc step = quality_step(0.033, 0.01);
    gxs_step_report report;
    size_t i;
    step.gravity[2] = 0;
    for (i = 0; i < s.model.copy_count; i++) targets[3 * i] = 0.033;
    for (i = 0; i < 3 * s.model.copy_count; i++) s.velocity[i] = i % 3 == 0 ? 1 : 0;
    step.targets = targets;
    move(&s, &step, 1, &report);
    ck_assert_uint_gt(report.parts, 1);
    for (i = 0; i < 3 * s.model.copy_count; i++) {
        if (s.held[i / 3]) ck_assert(fabs(s.displacement[i] - targets[i]) < 1e-15);
        ck_assert(fabs(s.displacement[i] - targets[i]) < 1e-4);
        ck_assert(fabs(s.velocity[i] - (i % 3 == 0 ? 1 : 0)) < 0.05);
    }
    free(targets);
    scene_free(&s);
}
END_TEST

/* A budget makes steps coarser. The clock runs by a millisecond a call. */
static double ticking(void *user) { return *(double *)user += 1e-3; }

START_TEST(quality_keeps_to_a_budget) {
    const double seconds = _i ? 1e-9 : 0.02; /* without any hope: one step that damps */
    scene s = hanging_bar(_i == 1 ? 2e6 : 2e9);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quality_step(0.033, 1e-3);
    gxs_step_report report;
    double now = 0;
    int i, unlimited = 0;
    if (_i == 1) set_kind(s.material, GXS_FIXED_COROTATED);
    step.clock = ticking;
    step.clock_user = &now;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (i = 0; i < 12; i++) {
        if (i == 6) step.budget_seconds = seconds;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        if (i == 5) unlimited = (int)report.parts;
        if (i > 6) ck_assert(report.error >= 1e-3 || report.parts == 1);
    }
    ck_assert_int_gt(unlimited, _i == 1 ? 3 : 4);
    ck_assert_int_lt((int)report.parts, unlimited);
    if (_i) ck_assert(report.parts == 1 && report.integrator == GXS_BDF1);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Two copies of the free end push each other apart: no part is the midpoint rule's, which would be refused, and the gap
   opens. */
START_TEST(quality_takes_pairs) {
    scene s = hanging_bar(2e7);
    gxs_step_desc step = quality_step(0.02, _i ? 1 : 0.03);
    gxs_step_report report;
    gxs_pair pair;
    double force[3], gap;
    const uint32_t last = (uint32_t)s.model.copy_count - 1;
    int k;
    memset(&pair, 0, sizeof pair);
    pair.point.count = 2;
    pair.point.copy[0] = last;
    pair.point.copy[1] = last - 1;
    pair.point.weight[0] = 1;
    pair.point.weight[1] = -1;
    for (k = 0; k < 3; k++) pair.point.position[k] = s.rest[3 * last + k] - s.rest[3 * (last - 1) + k];
    pair.normal[0] = 1;
    pair.offset = pair.point.position[0] + 0.05;
    pair.stiffness = 1e6;
    step.pairs = &pair;
    step.pair_count = 1;
    step.pair_forces = force;
    step.integrator = GXS_MIDPOINT;
    move(&s, &step, 10, &report);
    if (_i) ck_assert_uint_eq(report.parts, 1);
    ck_assert_int_ne(report.integrator, GXS_MIDPOINT);
    ck_assert_uint_eq(report.substeps, 0);
    gap = s.displacement[3 * last] - s.displacement[3 * (last - 1)];
    assert_that(gap > 1e-3 && gap < 0.051, "%g", gap);
    ck_assert(fabs(force[0] - 1e6 * (0.05 - gap)) < 1e-6 * 1e5);
    scene_free(&s);
}
END_TEST

/* Materials that explicit steps do not know: parts in their place, which agree with finer ones. */
START_TEST(quality_of_other_materials) {
    scene fine = hanging_bar(2e5), s = hanging_bar(2e5);
    gxs_step_desc step = quality_step(0.033, 1e-3);
    gxs_step_report report;
    set_kind(fine.material, GXS_FIXED_COROTATED);
    set_kind(s.material, GXS_FIXED_COROTATED);
    move(&fine, &step, 6, NULL);
    step.quality = 0.03;
    move(&s, &step, 6, &report);
    ck_assert_uint_eq(report.substeps, 0);
    ck_assert(report.error > 0);
    assert_that(difference(&s, fine.displacement) < 0.1, "%g", difference(&s, fine.displacement));
    scene_free(&fine);
    scene_free(&s);
}
END_TEST

/* A block falls through honey: one implicit step at a time, at the speed where damping bears the weight. */
START_TEST(quality_is_damped) {
    scene s = scene_block(2, 1, 1, 0.25, 0, 0);
    gxs_step_desc step = quality_step(0.02, 0.03);
    gxs_step_report report;
    size_t i;
    s.material->young = 2e5;
    s.model.lumped_mass = 1;
    step.mass_damping = 125;
    move(&s, &step, 30, &report);
    ck_assert_int_eq(report.integrator, GXS_BDF1);
    ck_assert_uint_eq(report.parts, 1);
    for (i = 2; i < 3 * s.model.copy_count; i += 3)
        assert_that(fabs(s.velocity[i] + 9.81 / 125) < 1e-6, "%g", s.velocity[i]);
    scene_free(&s);
}
END_TEST

/* Of a block so fast that twice its energy is beyond doubles nothing is learnt: later steps measure as ever. */
START_TEST(quality_of_what_is_too_fast_is_not_known) {
    const double fast = 2.8e153;
    scene s = scene_block(2, 1, 1, 0.25, 0, 0);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quality_step(0.02, 0.03);
    gxs_step_report report;
    size_t i;
    int frame;
    step.gravity[2] = 0;
    s.model.lumped_mass = 1;
    for (i = 0; i < 3 * s.model.copy_count; i += 3) s.velocity[i] = fast;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 5; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert(report.error == 0);
    }
    for (i = 0; i < 3 * s.model.copy_count; i++)
        ck_assert(fabs(s.displacement[i] - (i % 3 == 0 ? 0.1 * fast : 0)) < 1e-6 * fast);
    memset(s.displacement, 0, 3 * s.model.copy_count * sizeof(double));
    memset(s.velocity, 0, 3 * s.model.copy_count * sizeof(double));
    for (i = 0; i < s.model.copy_count; i++) s.velocity[3 * i] = s.rest[3 * i]; /* it swings */
    for (frame = 0; frame < 3; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert(report.error > 0);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A material that breaks after so many evaluations; user: the scene's material, then their number */
typedef struct fuse {
    gxs_material material;
    int left; /* below 0: it does not break */
} fuse;

static double fused_energy(void *user, const double *f, double *stress, double *hessian) {
    fuse *own = (fuse *)user;
    const double energy = fibre_energy(&own->material, f, stress, hessian);
    if (own->left > 0) own->left--;
    return own->left == 0 ? not_a_number(0) : energy;
}

/* A step that breaks in one of its later parts leaves all as it was: state, times of rest, slips of pairs. */
START_TEST(quality_that_fails_changes_nothing) {
    enum { COPIES = 54, NUMBERS = 7 * COPIES + 3 };
    scene s = hanging_bar(2e7);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quality_step(0.02, 0.003);
    gxs_step_report report;
    gxs_pair pair;
    fuse own;
    double numbers[NUMBERS], before[NUMBERS], *u = numbers, *v = u + 3 * COPIES;
    const uint32_t last = COPIES - 1;
    int frame, failed = 0;
    ck_assert_uint_eq(s.model.copy_count, COPIES);
    own.material = *s.material;
    own.left = -1;
    s.material->kind = GXS_CUSTOM;
    s.material->energy = fused_energy;
    s.material->user = &own;
    memset(numbers, 0, sizeof numbers);
    memset(&pair, 0, sizeof pair);
    pair.point.count = 2;
    pair.point.copy[0] = last;
    pair.point.copy[1] = last - 1;
    pair.point.weight[0] = 1;
    pair.point.weight[1] = -1;
    pair.normal[2] = 1;
    pair.offset = 0.001;
    pair.stiffness = 1e4;
    pair.friction = 0.5;
    pair.sticking_speed = 1e-3;
    step.pairs = &pair;
    step.pair_count = 1;
    step.pair_slips = v + 3 * COPIES;
    step.rest_times = step.pair_slips + 3;
    step.sleep_speed = 0.2;
    step.sleep_time = 10;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 5; frame++) ck_assert_int_eq(gxs_solver_step(solver, &step, u, v, &report, NULL), GX_OK);
    ck_assert_uint_gt(report.parts, 2);
    memcpy(before, numbers, sizeof before);
    for (own.left = 1; own.left > 0 && failed < 100; failed++) { /* until no part breaks any more */
        const int left = own.left;
        if (gxs_solver_step(solver, &step, u, v, &report, NULL) == GX_OK) break;
        ck_assert_mem_eq(numbers, before, sizeof before);
        own.left = left + left / 2 + 100;
    }
    ck_assert_int_gt(failed, 8);
    ck_assert(memcmp(v + 3 * COPIES, before + 6 * COPIES, 3 * sizeof *v) != 0); /* slips */
    ck_assert(memcmp(u, before, 3 * COPIES * sizeof *u) != 0);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* What sleeps stays as it is and does not count as a step that could not be explicit: awake, it takes such steps. */
START_TEST(quality_of_what_sleeps) {
    scene s = scene_block(2, 1, 1, 0.25, 0, 0);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quality_step(0.02, 0.03);
    gxs_step_report report;
    double *rest_times = (double *)zeroed(s.model.copy_count, sizeof(double));
    size_t i;
    int frame;
    s.material->young = 2e3;
    s.model.lumped_mass = 1;
    step.gravity[2] = 0;
    step.sleep_speed = 1e-3;
    step.sleep_time = 0.05;
    step.rest_times = rest_times;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 10; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 0);
    ck_assert_uint_eq(report.substeps, 0);
    for (i = 0; i < s.model.copy_count; i++) s.velocity[3 * i] = s.rest[3 * i];
    memset(rest_times, 0, s.model.copy_count * sizeof *rest_times);
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_gt(report.active_unknowns, 0);
    ck_assert_uint_gt(report.substeps, 0);
    gxs_solver_destroy(solver);
    free(rest_times);
    scene_free(&s);
}
END_TEST

/* What is not read does not matter; what is wrong is refused. */
START_TEST(quality_stands_in_place_of_other_numbers) {
    scene a = hanging_bar(2e7), b = hanging_bar(2e7);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quality_step(0.02, 0.03);
    gx_failure failure;
    move(&a, &step, 5, NULL);
    step.integrator = GXS_BDF1;
    step.substeps = 7;
    step.newton_iterations = 9;
    step.cg_tolerance = 0.5;
    move(&b, &step, 5, NULL);
    ck_assert_mem_eq(a.displacement, b.displacement, 3 * a.model.copy_count * sizeof(double));
    ck_assert_int_eq(gxs_solver_set_model(solver, &a.model, NULL), GX_OK);
    step.quality = -1;
    ck_assert_int_eq(gxs_solver_step(solver, &step, a.displacement, a.velocity, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "quality");
    step.quality = 0.1;
    step.integrator = GXS_STATIC;
    ck_assert_int_eq(gxs_solver_step(solver, &step, a.displacement, a.velocity, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "quality");
    gxs_solver_destroy(solver);
    scene_free(&a);
    scene_free(&b);
}
END_TEST

/* Resumed, a solver takes the steps of a fresh one, bit by bit. */
START_TEST(quality_resumes) {
    scene a = hanging_bar(2e7), b = hanging_bar(2e7);
    const size_t bytes = 3 * a.model.copy_count * sizeof(double);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quality_step(0.02, 0.03);
    gxs_scene none;
    int i;
    memset(&none, 0, sizeof none);
    ck_assert_int_eq(gxs_solver_set_model(solver, &a.model, NULL), GX_OK);
    for (i = 0; i < 6; i++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, a.displacement, a.velocity, NULL, NULL), GX_OK);
    memcpy(b.displacement, a.displacement, bytes);
    memcpy(b.velocity, a.velocity, bytes);
    gxs_solver_resume(solver, &none);
    for (i = 0; i < 4; i++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, a.displacement, a.velocity, NULL, NULL), GX_OK);
    move(&b, &step, 4, NULL);
    ck_assert_mem_eq(a.displacement, b.displacement, bytes);
    ck_assert_mem_eq(a.velocity, b.velocity, bytes);
    gxs_solver_destroy(solver);
    scene_free(&a);
    scene_free(&b);
}
END_TEST

/* A step that fails for want of memory leaves the state alone; the solver is still good. Later ones allocate nothing:
   `which` says after how many more, as the second step by quality makes what explicit ones need. */
static int run_with(memory *m, int which) {
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gxs_step_desc step = which ? quality_step(0.01, 0.03) : explicit_step(0.01, 0);
    scene s = hanging_bar(2e5);
    gx_result result;
    size_t i, calls;
    int failed = 0, k;
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator_of(m);
    result = gxs_solver_create(&desc, &solver, NULL);
    if (result == GX_OK) result = gxs_solver_set_model(solver, &s.model, NULL);
    if (result == GX_OK) {
        result = gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL);
        for (i = 0; i < 3 * s.model.copy_count && result != GX_OK; i++)
            ck_assert(s.displacement[i] == 0 && s.velocity[i] == 0);
        for (k = 0; k < which && result == GX_OK; k++) {
            double *kept = (double *)zeroed(3 * s.model.copy_count, sizeof(double));
            memcpy(kept, s.displacement, 3 * s.model.copy_count * sizeof(double));
            result = gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL);
            if (result != GX_OK) ck_assert_mem_eq(kept, s.displacement, 3 * s.model.copy_count * sizeof(double));
            free(kept);
        }
        for (k = 0; k < 1 + which && result == GX_ERROR_MEMORY && !m->from_then_on; k++)
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        calls = m->calls;
        if (result == GX_OK || !m->from_then_on) {
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
            ck_assert_uint_eq(m->calls, calls);
        }
    }
    if (result != GX_OK) {
        ck_assert_int_eq(result, GX_ERROR_MEMORY);
        failed = 1;
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
    return failed;
}

START_TEST(every_allocation_may_fail) { sweep_allocations(run_with, _i); }
END_TEST

int main(void) {
    Suite *suite = suite_create("explicit");
    TCase *list = tcase_create("explicit");
    tcase_set_timeout(list, 60);
    tcase_add_test(list, converges_with_order_two);
    tcase_add_loop_test(list, energy_is_not_created, 4, 9);
    tcase_add_test(list, free_fall);
    tcase_add_test(list, spin_is_kept);
    tcase_add_loop_test(list, other_steps_are_backward_euler, 0, OBSTACLES);
    tcase_add_loop_test(list, violent_starts_do_not_blow_up, 0, 12);
    tcase_add_test(list, steps_mix);
    tcase_add_test(list, updates_are_followed);
    tcase_add_test(list, jobs_do_not_change_bits);
    tcase_add_loop_test(list, quality_is_reached, 0, 3);
    tcase_add_loop_test(list, quality_does_not_blow_up, 0, 12);
    tcase_add_test(list, quality_at_rest_takes_one_step);
    tcase_add_test(list, quality_moves_held_copies);
    tcase_add_loop_test(list, quality_keeps_to_a_budget, 0, 3);
    tcase_add_loop_test(list, quality_takes_pairs, 0, 2);
    tcase_add_test(list, quality_of_other_materials);
    tcase_add_test(list, quality_is_damped);
    tcase_add_test(list, quality_of_what_is_too_fast_is_not_known);
    tcase_add_test(list, quality_that_fails_changes_nothing);
    tcase_add_test(list, quality_of_what_sleeps);
    tcase_add_test(list, quality_stands_in_place_of_other_numbers);
    tcase_add_test(list, quality_resumes);
    tcase_add_loop_test(list, every_allocation_may_fail, 0, 2);
    suite_add_tcase(suite, list);
    return run_suite(suite);
}
