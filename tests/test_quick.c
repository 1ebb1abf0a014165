/* test_quick.c - quick steps (gxs_step_desc.quick): their forces, Hessians and energies beside the material's own,
   their order, energy, momentum, what they leave to usual steps, cuts, jobs, memory and resuming. Truth: converged
   implicit steps with the same lumped mass. */
#define GXFEM_SOLVE_IMPLEMENTATION
#include "../gxfem_solve.h"

#include "block.h"

enum { FRAMES = 180 / FEWER };

/* ---- one block of elements ---- */

enum { LANES = sizeof(gxsp_singles) / sizeof(float) };

typedef struct lane_case {
    gxs_material material;
    double gradient[9], f[9], weight; /* of shape functions 1 ... 3, by rows, 1/m; F, by rows */
} lane_case;

/* Strains up to `most`; elements of about 0.1 m */
static lane_case random_lane(double most) {
    lane_case c;
    int k;
    memset(&c, 0, sizeof c);
    c.material.young = 1e5 * exp(3 * uniform());
    c.material.poisson = 0.245 + 0.24 * uniform();
    c.weight = 1e-4 * exp(2 * uniform());
    for (k = 0; k < 9; k++) {
        c.gradient[k] = 10 * ((k % 4 == 0 ? 1.5 : 0) + uniform());
        c.f[k] = (k % 4 == 0 ? 1 : 0) + most * uniform();
    }
    return c;
}

/* Displacements of the corners that give F, the first at 0: the columns of G times the edges, where edges^-1 are the
   gradients */
static void corners_of(const lane_case *c, const double *f, double *x) {
    const double *g = c->gradient;
    double inverse[9], det;
    int i, j, k;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            inverse[3 * j + i] = g[3 * i1 + j1] * g[3 * i2 + j2] - g[3 * i1 + j2] * g[3 * i2 + j1];
        }
    det = g[0] * inverse[0] + g[1] * inverse[3] + g[2] * inverse[6];
    memset(x, 0, 12 * sizeof *x);
    for (k = 0; k < 3; k++) /* u_k = G e_k, and e_k is column k of gradients^-1 */
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3; j++) x[3 + 3 * k + i] += (f[3 * i + j] - (i == j ? 1 : 0)) * inverse[3 * j + k] / det;
}

/* Forces on the corners, dU/du, of a stress */
static void forces_of(const lane_case *c, const double *stress, double *force) {
    int i, j, k;
    memset(force, 0, 12 * sizeof *force);
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3; j++) {
                const double part = c->weight * stress[3 * i + j] * c->gradient[3 * k + j];
                force[3 + 3 * k + i] += part;
                force[i] -= part;
            }
}

static void put_lane(const lane_case *c, gxsp_leap_block *block, int lane) {
    const gxsp_material own = gxsp_material_make(&c->material);
    int k;
    for (k = 0; k < 9; k++) block->gradient[k][lane] = (float)c->gradient[k];
    block->mu[lane] = (float)(c->weight * own.mu);
    block->lambda[lane] = (float)(c->weight * own.lambda);
}

/* Is what a lane has that of doubles, as a share of a scale? */
static void expect_lane(gxsp_singles *forces, int lane, const double *truth, double scale, double tolerance) {
    int k;
    for (k = 0; k < 12; k++)
        assert_that(fabs((double)forces[k][lane] - truth[k]) < tolerance * scale, "%d: %g, not %g, of %g", k,
                    (double)forces[k][lane], truth[k], scale);
}

/* The largest force that strains of about 1 would make */
static double scale_of(const lane_case *c) {
    return 40 * c->weight * c->material.young / (1 - 2 * c->material.poisson);
}

/* Forces, products by differences of stresses, and energies, at strains of 1e-4 to 0.7, elements turned inside out
   among them */
START_TEST(strains_agree_with_the_material) {
    lane_case lanes[LANES];
    gxsp_leap_block block;
    gxsp_strain strain;
    gxsp_singles x[12], direction[12], force[12], product[12];
    gxsp_lanes energy;
    const double most = exp(-9 + 0.043 * _i), scale = 0.25, tiny = 1e-5;
    double along[LANES][9];
    int l, k;
    seed((uint64_t)_i);
    memset(force, 0, sizeof force);
    memset(product, 0, sizeof product);
    for (l = 0; l < LANES; l++) {
        double corners[12];
        lanes[l] = random_lane(most);
        put_lane(&lanes[l], &block, l);
        corners_of(&lanes[l], lanes[l].f, corners);
        for (k = 0; k < 12; k++) x[k][l] = (float)corners[k];
        for (k = 0; k < 9; k++) along[l][k] = (k % 4 == 0 ? 1 : 0) + uniform();
        corners_of(&lanes[l], along[l], corners);
        for (k = 0; k < 12; k++) direction[k][l] = (float)corners[k];
    }
    gxsp_leap_force(&block, x, force, NULL, 1, (float)scale, &strain);
    gxsp_strain_product(&block, &strain, direction, product);
    gxsp_strain_energy(&block, x, energy);
    for (l = 0; l < LANES; l++) {
        const lane_case *c = &lanes[l];
        double stress[9], truth[12], next[9], last[9], f[9], density;
        gxs_material_stress(&c->material, c->f, stress);
        forces_of(c, stress, truth);
        expect_lane(force, l, truth, most * scale_of(c), 3e-5);
        for (k = 0; k < 9; k++) f[k] = c->f[k] + tiny * (along[l][k] - (k % 4 == 0 ? 1 : 0));
        gxs_material_stress(&c->material, f, next);
        for (k = 0; k < 9; k++) f[k] = c->f[k] - tiny * (along[l][k] - (k % 4 == 0 ? 1 : 0));
        gxs_material_stress(&c->material, f, last);
        for (k = 0; k < 9; k++) stress[k] = scale * (next[k] - last[k]) / (2 * tiny);
        forces_of(c, stress, truth);
        expect_lane(product, l, truth, scale_of(c), 3e-5);
        density = gxs_material_energy(&c->material, c->f);
        assert_that(fabs(energy[l] - c->weight * density) < 1e-5 * most * most * scale_of(c), "%g %g", energy[l],
                    c->weight * density);
    }
}
END_TEST

/* ---- steps ---- */

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

static gxs_step_desc quick_step(double dt, uint32_t iterations) {
    gxs_step_desc step = step_make(dt, -9.81);
    step.integrator = GXS_MIDPOINT;
    step.quick = iterations;
    return step;
}

/* Steps from the scene's state with multigrid; returns how many were quick. */
static int move(scene *s, const gxs_step_desc *desc, int steps, gxs_step_report *last) {
    const size_t count = 3 * s->model.copy_count;
    double *history = (double *)zeroed(4 * count, sizeof(double));
    gxs_step_desc step = *desc;
    gxs_solver_desc kind;
    gxs_solver *solver = NULL;
    gxs_step_report report;
    int i, quick = 0;
    memset(&kind, 0, sizeof kind);
    kind.preconditioner = GXS_MULTIGRID;
    ck_assert_int_eq(gxs_solver_create(&kind, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s->model, NULL), GX_OK);
    for (i = 0; i < steps; i++) {
        memcpy(history + 2 * count, s->displacement, count * sizeof(double));
        memcpy(history + 3 * count, s->velocity, count * sizeof(double));
        ck_assert_int_eq(gxs_solver_step(solver, &step, s->displacement, s->velocity, &report, NULL), GX_OK);
        memcpy(history, history + 2 * count, 2 * count * sizeof(double));
        step.previous_displacement = history;
        step.previous_velocity = history + count;
        step.previous_dt = step.dt;
        ck_assert_uint_le(report.quick, 1);
        if (report.quick) {
            ck_assert_uint_le(report.cg_iterations, step.quick);
            ck_assert_uint_eq(report.newton_iterations, 0);
        }
        quick += report.quick != 0;
    }
    if (last) *last = report;
    gxs_solver_destroy(solver);
    free(history);
    return quick;
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

static gxs_step_desc converged_step(double dt, gxs_integrator integrator) {
    gxs_step_desc step = step_make(dt, -9.81);
    step.integrator = integrator;
    step.newton_iterations = 20;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-6;
    return step;
}

/* With many iterations a quick step is a converged one of the same integrator, but for what one Newton iteration
   leaves: that falls with a higher power of the step than the step's own error. */
START_TEST(many_iterations_are_a_converged_step) {
    const gxs_integrator integrator = (gxs_integrator)_i;
    double error[3];
    int i;
    for (i = 0; i < 3; i++) {
        scene truth = hanging_bar(2e5), s = hanging_bar(2e5);
        const int steps = 8 << i;
        gxs_step_desc step = converged_step(0.16 / steps, integrator);
        move(&truth, &step, steps, NULL);
        step = quick_step(0.16 / steps, 100);
        step.integrator = integrator;
        step.cg_tolerance = 1e-5;
        ck_assert_int_eq(move(&s, &step, steps, NULL), steps);
        error[i] = difference(&s, truth.displacement);
        scene_free(&truth);
        scene_free(&s);
    }
    assert_that(error[0] < 3e-2, "%g %g %g", error[0], error[1], error[2]);
    assert_that(error[2] < 2e-3 && error[2] < error[0] / 6, "%g %g %g", error[0], error[1], error[2]);
}
END_TEST

/* Three iterations of the midpoint rule: the error beside the exact motion is of second order. */
START_TEST(midpoint_is_of_order_two) {
    scene truth = hanging_bar(2e5);
    gxs_step_desc step = converged_step(0.2 / 400, GXS_MIDPOINT);
    double error[3];
    int i;
    move(&truth, &step, 400, NULL);
    for (i = 0; i < 3; i++) {
        scene s = hanging_bar(2e5);
        step = quick_step(0.2 / (8 << i), 3);
        ck_assert_int_eq(move(&s, &step, 8 << i, NULL), 8 << i);
        error[i] = difference(&s, truth.displacement);
        scene_free(&s);
    }
    assert_that(error[0] < 0.1 && error[1] < error[0] / 2.5 && error[2] < error[1] / 2.5, "%g %g %g", error[0],
                error[1], error[2]);
    scene_free(&truth);
}
END_TEST

/* A bar that swings for seconds, however few the iterations: energy never rises above what it was at the start, and
   with three iterations the midpoint rule keeps most of it. One iteration of block-Jacobi's gains too much now and
   then: such a step is a usual one. */
START_TEST(energy_is_not_created) {
    const uint32_t iterations = (uint32_t)(_i % 3) + 1;
    scene s = hanging_bar(2e5);
    gxs_solver_desc kind;
    gxs_solver *solver = NULL;
    gxs_step_desc step = quick_step(1.0 / 60, iterations);
    double most = -1e300, size = 0, energy = 0, *history = (double *)zeroed(12 * s.model.copy_count, sizeof(double));
    const size_t count = 3 * s.model.copy_count;
    int frame, usual = 0;
    step.integrator = (gxs_integrator)(_i / 3);
    memset(&kind, 0, sizeof kind);
    kind.preconditioner = _i % 3 ? GXS_MULTIGRID : GXS_BLOCK_JACOBI;
    ck_assert_int_eq(gxs_solver_create(&kind, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < FRAMES; frame++) {
        gxs_step_report report;
        memcpy(history + 2 * count, s.displacement, count * sizeof(double));
        memcpy(history + 3 * count, s.velocity, count * sizeof(double));
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        memcpy(history, history + 2 * count, 2 * count * sizeof(double));
        step.previous_displacement = history;
        step.previous_velocity = history + count;
        step.previous_dt = step.dt;
        usual += !report.quick;
        energy = energy_of(&s);
        if (report.quick)
            assert_that(fabs(report.energy - energy) < 1e-3 * size + 1e-3, "%g %g", report.energy, energy);
        most = fmax(most, energy);
        size = fmax(size, form_energy(&s.model, s.displacement));
    }
    assert_that(usual <= (kind.preconditioner == GXS_BLOCK_JACOBI ? FRAMES / 6 : 0), "%d usual", usual);
    assert_that(most < 5e-3 * size, "%g of %g", most, size);
    if (step.integrator == GXS_MIDPOINT && iterations == 3)
        assert_that(energy > -0.25 * size, "%g of %g", energy, size);
    gxs_solver_destroy(solver);
    free(history);
    scene_free(&s);
}
END_TEST

/* A free body falls by g t^2 / 2, far from where it was at rest, and does not deform. */
START_TEST(free_fall) {
    scene s = hanging_bar(2e5);
    gxs_step_desc step = quick_step(0.1, 2);
    size_t i;
    memset(s.held, 0, s.model.copy_count);
    for (i = 0; i < s.model.copy_count; i++) s.displacement[3 * i] = 1e4, s.velocity[3 * i + 1] = 3;
    ck_assert_int_eq(move(&s, &step, 10, NULL), 10);
    for (i = 0; i < s.model.copy_count; i++) {
        ck_assert(fabs(s.displacement[3 * i] - 1e4) < 1e-5);
        ck_assert(fabs(s.displacement[3 * i + 1] - 3) < 1e-5);
        assert_that(fabs(s.displacement[3 * i + 2] + 0.5 * 9.81) < 1e-5, "%g", s.displacement[3 * i + 2]);
        ck_assert(fabs(s.velocity[3 * i + 2] + 9.81) < 1e-5);
    }
    scene_free(&s);
}
END_TEST

/* What a step that cannot be quick is made of, one thing at a time */
enum { KIND, DAMPED, FOLLOWING, PULLED, TARGETED, STATIC, EXPLICIT, OBSTACLES };

/* Then the step is a usual one, bit by bit. */
START_TEST(other_steps_are_usual) {
    gxs_constraint constraint;
    gxs_spring spring;
    double *ends[2];
    size_t count = 0;
    int run;
    memset(&constraint, 0, sizeof constraint);
    memset(&spring, 0, sizeof spring);
    for (run = 0; run < 2; run++) {
        scene s = hanging_bar(2e5);
        gxs_step_desc step = quick_step(0.02, run ? 2 : 0);
        gxs_step_report report;
        double *targets = (double *)zeroed(3 * s.model.copy_count, sizeof(double));
        if (_i == KIND) s.material->kind = GXS_FIXED_COROTATED;
        if (_i == DAMPED) s.material->damping = 0.01;
        constraint.copy = (uint32_t)s.model.copy_count - 1;
        constraint.master[0] = constraint.copy - 1;
        constraint.weight[0] = 1;
        if (_i == FOLLOWING) s.model.constraints = &constraint, s.model.constraint_count = 1;
        spring.point.count = 1;
        spring.point.copy[0] = 20;
        spring.point.weight[0] = 1;
        spring.stiffness = 10;
        if (_i == PULLED) step.springs = &spring, step.spring_count = 1;
        if (_i == TARGETED) step.targets = targets;
        if (_i == STATIC) step.integrator = GXS_STATIC;
        if (_i == EXPLICIT) step.integrator = GXS_EXPLICIT;
        ck_assert_int_eq(move(&s, &step, 3, &report), 0);
        ck_assert(_i == EXPLICIT ? report.substeps > 0 : report.newton_iterations > 0);
        count = 3 * s.model.copy_count;
        ends[run] = (double *)zeroed(2 * count, sizeof(double));
        memcpy(ends[run], s.displacement, count * sizeof(double));
        memcpy(ends[run] + count, s.velocity, count * sizeof(double));
        free(targets);
        scene_free(&s);
    }
    ck_assert_mem_eq(ends[0], ends[1], 2 * count * sizeof(double));
    free(ends[0]);
    free(ends[1]);
}
END_TEST

/* From any start all stays finite, and energy does not rise, but for what the usual steps in between do. */
START_TEST(violent_starts_do_not_blow_up) {
    scene s = hanging_bar(_i % 2 ? 2e5 : 2e3);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quick_step(0.033, 1 + (uint32_t)_i % 3);
    double start, energy, size;
    size_t i;
    int frame;
    seed((uint64_t)_i);
    step.integrator = _i % 5 < 2 ? GXS_BDF1 : GXS_MIDPOINT;
    for (i = 0; i < 3 * s.model.copy_count; i++)
        if (!s.held[i / 3]) {
            s.displacement[i] = _i % 4 == 0 && i % 3 == 2 ? -2 * s.rest[i] : _i % 7 == 6 ? -s.rest[i] : 0.4 * uniform();
            s.velocity[i] = 20 * uniform();
        }
    start = energy_of(&s);
    size = fabs(start) + form_energy(&s.model, s.displacement);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 60; frame++) {
        gxs_step_report report;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        for (i = 0; i < 3 * s.model.copy_count; i++)
            ck_assert(finite_bits(s.displacement[i]) && finite_bits(s.velocity[i]));
        energy = energy_of(&s);
        assert_that(energy < start + (report.quick ? 1e-4 : 0.6) * size, "frame %d: %g of %g", frame, energy, start);
        if (!report.quick) start = energy;
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Collapsed elements have no force, and no finite number may be lost on the way: such steps are usual ones, and fail
   where those do. */
START_TEST(hopeless_steps_are_usual) {
    scene s = hanging_bar(2e5);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quick_step(0.033, 2);
    gxs_step_report report;
    size_t i;
    step.gravity[2] = 0;
    for (i = 0; i < 3 * s.model.copy_count; i++) {
        if (_i == 0 && !s.held[i / 3]) s.displacement[i] = 1 - s.rest[i];
        if (_i == 1 && !s.held[i / 3]) s.velocity[i] = i % 2 ? 1e300 : -1e300;
        if (_i == 2 && !s.held[i / 3]) s.velocity[i] = i % 2 ? 1e30 : -1e30;
    }
    if (_i == 1) step.dt = 1e10;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL),
                     _i == 0 ? GX_OK : GX_ERROR_DIVERGED);
    if (_i == 0) ck_assert(report.quick == 0 && report.newton_iterations == 1);
    if (_i == 1) ck_assert(fabs(s.velocity[3 * s.model.copy_count - 1]) > 9e299);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

static double ticking(void *user) { return *(double *)user += 0.4; }

/* No iteration begins when the time is over. */
START_TEST(budgets_are_kept) {
    scene s = hanging_bar(2e5);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quick_step(1.0 / 60, 50);
    gxs_step_report report;
    double now = 0;
    step.clock = ticking;
    step.clock_user = &now;
    step.budget_seconds = 1e-3;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.quick, 1);
    ck_assert_uint_eq(report.cg_iterations, 1);
    ck_assert_int_eq(report.stop, GXS_STOP_SECONDS);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Pieces that hang together with nothing have limits of their own: one at rest keeps its balance beside one that
   bursts, and momentum of free ones is kept to rounding. */
START_TEST(pieces_do_not_share_energy) {
    scene s = hanging_bar(2e5);
    gxs_step_desc step = quick_step(1.0 / 60, 2);
    double before[3] = {0, 0, 0}, after[3] = {0, 0, 0},
           *mass = (double *)zeroed(3 * s.model.copy_count, sizeof(double));
    size_t i;
    int k;
    memset(s.held, 0, s.model.copy_count);
    step.gravity[2] = 0;
    for (i = 0; i < 3 * s.model.copy_count; i++) s.velocity[i] = 5 * uniform();
    form_mass_product(&s.model, s.velocity, mass);
    for (i = 0; i < 3 * s.model.copy_count; i++) before[i % 3] += mass[i];
    for (k = 0; k < 20; k++) move(&s, &step, 1, NULL);
    form_mass_product(&s.model, s.velocity, mass);
    for (i = 0; i < 3 * s.model.copy_count; i++) after[i % 3] += mass[i];
    for (k = 0; k < 3; k++) assert_that(fabs(after[k] - before[k]) < 1e-6 * 625 * 5, "%g %g", before[k], after[k]);
    free(mass);
    scene_free(&s);
}
END_TEST

/* After a usual step and back each step is that of the same state in a fresh solver, up to the tolerance of solves. The
   mass is consistent in usual steps. */
START_TEST(steps_mix) {
    scene s = hanging_bar(2e5), fresh = hanging_bar(2e5);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quick_step(1.0 / 60, 60);
    const size_t bytes = 3 * s.model.copy_count * sizeof(double);
    int i;
    s.model.lumped_mass = fresh.model.lumped_mass = 0;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (i = 0; i < 12; i++) {
        gxs_step_report report;
        step.quick = i % 3 == 1 ? 0 : 60;
        step.newton_iterations = 10;
        step.cg_tolerance = 1e-5;
        memcpy(fresh.displacement, s.displacement, bytes);
        memcpy(fresh.velocity, s.velocity, bytes);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert_uint_eq(report.quick, step.quick > 0);
        move(&fresh, &step, 1, NULL);
        assert_that(difference(&s, fresh.displacement) < 1e-4, "%d: %g", i, difference(&s, fresh.displacement));
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
    scene_free(&fresh);
}
END_TEST

/* Elements are taken away: the changed model takes the same quick steps as the model set anew, up to the tolerance of
   solves. */
START_TEST(updates_are_followed) {
    scene s = hanging_bar(2e5), other = hanging_bar(2e5);
    gxs_solver *solvers[2];
    gxs_step_desc step = quick_step(1.0 / 60, 60);
    gxs_change change;
    uint32_t *origins = (uint32_t *)zeroed(s.model.copy_count, sizeof *origins), groups[5] = {3, 17, 40, 41, 60};
    gxs_solver_desc kind;
    size_t i, k, left = 0;
    int frame;
    step.cg_tolerance = 1e-5;
    for (i = 0; i < s.model.element_count; i++) s.elements[i].group = (uint32_t)i;
    s.model.lumped_mass = other.model.lumped_mass = 0; /* else it is set anew anyway */
    memset(&kind, 0, sizeof kind);
    kind.preconditioner = GXS_MULTIGRID;
    for (k = 0; k < 2; k++) ck_assert_int_eq(gxs_solver_create(&kind, &solvers[k], NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solvers[0], &s.model, NULL), GX_OK);
    for (i = 0; i < 3; i++)
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
        ck_assert_uint_eq(report.quick, 1);
        ck_assert_int_eq(gxs_solver_step(solvers[1], &step, other.displacement, other.velocity, NULL, NULL), GX_OK);
        assert_that(difference(&s, other.displacement) < 1e-4, "%g", difference(&s, other.displacement));
    }
    for (k = 0; k < 2; k++) gxs_solver_destroy(solvers[k]);
    free(origins);
    scene_free(&s);
    scene_free(&other);
}
END_TEST

/* A component that wakes gets a diagonal: it moves as in a fresh solver. */
START_TEST(sleepers_wake) {
    scene s = hanging_bar(2e5);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = quick_step(1.0 / 60, 3);
    gxs_step_report report;
    double *rest = (double *)zeroed(s.model.copy_count, sizeof(double));
    size_t i;
    int k;
    step.gravity[2] = 0;
    step.sleep_speed = 1e-3;
    step.sleep_time = 0.1;
    step.rest_times = rest;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (k = 0; k < 12; k++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 0);
    ck_assert_uint_eq(report.quick, 0);
    step.gravity[2] = -9.81;
    for (k = 0; k < 3; k++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.quick, 1);
    for (i = 0; i < s.model.copy_count; i++)
        if (!s.held[i]) ck_assert(s.displacement[3 * i + 2] < -1e-5);
    gxs_solver_destroy(solver);
    free(rest);
    scene_free(&s);
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
        gxs_step_desc step = quick_step(1.0 / 60, 2);
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
            ck_assert_uint_eq(report.quick, 1);
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

/* Resumed, a solver takes the steps of a fresh one, bit by bit. */
START_TEST(resumes) {
    scene a = hanging_bar(2e5), b = hanging_bar(2e5);
    const size_t bytes = 3 * a.model.copy_count * sizeof(double);
    gxs_solver *solver = solver_make(), *other = solver_make();
    gxs_step_desc step = quick_step(0.02, 2);
    gxs_scene none;
    int i;
    memset(&none, 0, sizeof none);
    ck_assert_int_eq(gxs_solver_set_model(solver, &a.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(other, &b.model, NULL), GX_OK);
    for (i = 0; i < 6; i++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, a.displacement, a.velocity, NULL, NULL), GX_OK);
    memcpy(b.displacement, a.displacement, bytes);
    memcpy(b.velocity, a.velocity, bytes);
    gxs_solver_resume(solver, &none);
    for (i = 0; i < 4; i++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, a.displacement, a.velocity, NULL, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(other, &step, b.displacement, b.velocity, NULL, NULL), GX_OK);
    }
    ck_assert_mem_eq(a.displacement, b.displacement, bytes);
    ck_assert_mem_eq(a.velocity, b.velocity, bytes);
    gxs_solver_destroy(solver);
    gxs_solver_destroy(other);
    scene_free(&a);
    scene_free(&b);
}
END_TEST

/* A step that fails for want of memory leaves the state alone; the solver is still good. Later ones allocate nothing.
 */
static int run_with(memory *m, int which) {
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gxs_step_desc step = quick_step(0.01, 2);
    scene s = hanging_bar(2e5);
    gx_result result;
    size_t i, calls;
    (void)which;
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator_of(m);
    result = gxs_solver_create(&desc, &solver, NULL);
    if (result == GX_OK) result = gxs_solver_set_model(solver, &s.model, NULL);
    if (result == GX_OK) {
        result = gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL);
        for (i = 0; i < 3 * s.model.copy_count && result != GX_OK; i++)
            ck_assert(s.displacement[i] == 0 && s.velocity[i] == 0);
        if (result == GX_ERROR_MEMORY && !m->from_then_on)
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        calls = m->calls;
        if (result == GX_OK || !m->from_then_on) {
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
            ck_assert_uint_eq(m->calls, calls);
        }
    }
    if (result != GX_OK) ck_assert_int_eq(result, GX_ERROR_MEMORY);
    gxs_solver_destroy(solver);
    scene_free(&s);
    return result != GX_OK;
}

START_TEST(every_allocation_may_fail) { sweep_allocations(run_with, _i); }
END_TEST

int main(void) {
    Suite *suite = suite_create("quick");
    TCase *list = tcase_create("quick");
    tcase_set_timeout(list, 60);
    tcase_add_loop_test(list, strains_agree_with_the_material, 0, 200);
    tcase_add_loop_test(list, many_iterations_are_a_converged_step, 0, 3);
    tcase_add_test(list, midpoint_is_of_order_two);
    tcase_add_loop_test(list, energy_is_not_created, 0, 9);
    tcase_add_test(list, free_fall);
    tcase_add_loop_test(list, other_steps_are_usual, 0, OBSTACLES);
    tcase_add_loop_test(list, violent_starts_do_not_blow_up, 0, 21);
    tcase_add_loop_test(list, hopeless_steps_are_usual, 0, 3);
    tcase_add_test(list, budgets_are_kept);
    tcase_add_test(list, pieces_do_not_share_energy);
    tcase_add_test(list, steps_mix);
    tcase_add_test(list, updates_are_followed);
    tcase_add_test(list, sleepers_wake);
    tcase_add_test(list, jobs_do_not_change_bits);
    tcase_add_test(list, resumes);
    tcase_add_loop_test(list, every_allocation_may_fail, 0, 2);
    suite_add_tcase(suite, list);
    return run_suite(suite);
}
