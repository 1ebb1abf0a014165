/* test_forces.c - forces on bodies in gxfem_solve.h other than elasticity: constraints, springs, planes with
   friction, contact, statics, damping, sleep, time budgets, the assembled matrix; memory, and random mixtures of
   everything. */
#ifndef GXFEM_LINKED
#define GXFEM_SOLVE_IMPLEMENTATION
#endif
#include "../gxfem_solve.h"

#include "block.h"
#include "runner.h"
#include <stdio.h>

/* ---- scenes of several blocks ---- */

/* Every combination of preconditioner and matrix; the first is the plainest */
enum { SOLVERS = 6 };

static gxs_solver_desc solver_desc(int which) {
    static const gxs_preconditioner preconditioners[SOLVERS / 2] = {GXS_BLOCK_JACOBI, GXS_MULTIGRID, GXS_VOLUME_RATIO};
    gxs_solver_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.preconditioner = preconditioners[which / 2];
    desc.matrix = which % 2 ? GXS_MATRIX_ASSEMBLED : GXS_MATRIX_FREE;
    return desc;
}

static const char *solver_name(int which) {
    static const char *const names[SOLVERS] = {"block-Jacobi free", "block-Jacobi assembled",
                                               "multigrid free",    "multigrid assembled",
                                               "volume ratio free", "volume ratio assembled"};
    return names[which];
}

static gxs_solver *solver_of(int which) {
    gxs_solver_desc desc = solver_desc(which);
    gxs_solver *solver = NULL;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    return solver;
}

/* solved to (almost) all digits */
static gxs_step_desc step_tight(double dt, double gravity) {
    gxs_step_desc step = step_make(dt, gravity);
    step.newton_iterations = 60;
    step.newton_tolerance = 1e-11;
    step.cg_tolerance = 1e-4;
    step.cg_iterations = 5000;
    return step;
}

static void *longer(void *memory, size_t from, size_t to, size_t size) {
    char *moved = (char *)realloc(memory, to * size);
    ck_assert_ptr_nonnull(moved);
    memset(moved + from * size, 0, (to - from) * size);
    return moved;
}

/* Adds another block beside the first and consumes it. Its copies and elements follow those of s. Materials are
   those of s. */
static void scene_add(scene *s, scene *other, double x, double y, double z) {
    const size_t n = s->model.copy_count, more = other->model.copy_count, e = s->model.element_count,
                 last = e + other->model.element_count;
    const double shift[3] = {x, y, z};
    size_t i;
    int k;
    s->rest = (double *)longer(s->rest, 3 * n, 3 * (n + more), sizeof(double));
    s->displacement = (double *)longer(s->displacement, 3 * n, 3 * (n + more), sizeof(double));
    s->velocity = (double *)longer(s->velocity, 3 * n, 3 * (n + more), sizeof(double));
    s->forces = (double *)longer(s->forces, 3 * n, 3 * (n + more), sizeof(double));
    s->held = (uint8_t *)longer(s->held, n, n + more, 1);
    s->elements = (gxs_element *)longer(s->elements, e, last, sizeof(gxs_element));
    for (i = 0; i < 3 * more; i++) s->rest[3 * n + i] = other->rest[i] + shift[i % 3];
    for (i = e; i < last; i++) {
        s->elements[i] = other->elements[i - e];
        for (k = 0; k < 4; k++) s->elements[i].copy[k] += (uint32_t)n;
    }
    s->model.copy_count += more;
    s->model.element_count = last;
    s->model.positions = s->rest;
    s->model.elements = s->elements;
    s->model.held = s->held;
    scene_free(other);
}

/* The same block cut at x, a plane of nodes (without jitter), and tied there: elements on the right get copies of
   their own, which follow. Returns the constraints, which the caller frees. */
static gxs_constraint *scene_split(scene *s, double x) {
    const size_t n = s->model.copy_count;
    uint32_t *twin = (uint32_t *)zeroed(n, sizeof *twin), count = 0;
    gxs_constraint *ties = (gxs_constraint *)zeroed(n, sizeof *ties);
    size_t i, e;
    int k;
    for (i = 0; i < n; i++)
        if (fabs(s->rest[3 * i] - x) < 1e-9) {
            ties[count].copy = twin[i] = (uint32_t)n + count;
            ties[count].master[0] = (uint32_t)i;
            ties[count++].weight[0] = 1;
        }
    s->rest = (double *)longer(s->rest, 3 * n, 3 * (n + count), sizeof(double));
    s->displacement = (double *)longer(s->displacement, 3 * n, 3 * (n + count), sizeof(double));
    s->velocity = (double *)longer(s->velocity, 3 * n, 3 * (n + count), sizeof(double));
    s->forces = (double *)longer(s->forces, 3 * n, 3 * (n + count), sizeof(double));
    s->held = (uint8_t *)longer(s->held, n, n + count, 1);
    for (i = 0; i < n; i++)
        if (twin[i]) {
            memcpy(s->rest + 3 * twin[i], s->rest + 3 * i, 3 * sizeof(double));
            memcpy(s->displacement + 3 * twin[i], s->displacement + 3 * i, 3 * sizeof(double));
            memcpy(s->velocity + 3 * twin[i], s->velocity + 3 * i, 3 * sizeof(double));
        }
    for (e = 0; e < s->model.element_count; e++) {
        double centre = 0;
        for (k = 0; k < 4; k++) centre += 0.25 * s->rest[3 * s->elements[e].copy[k]];
        for (k = 0; k < 4 && centre > x; k++)
            if (twin[s->elements[e].copy[k]]) s->elements[e].copy[k] = twin[s->elements[e].copy[k]];
    }
    s->model.copy_count = n + count;
    s->model.positions = s->rest;
    s->model.held = s->held;
    s->model.constraints = ties;
    s->model.constraint_count = count;
    free(twin);
    return ties;
}

/* M x, of lumped models too */
static void mass_times(const scene *s, const double *x, double *y) {
    const size_t count = 3 * s->model.copy_count;
    size_t i;
    if (s->model.lumped_mass) {
        double *ones = (double *)zeroed(count, sizeof *ones);
        for (i = 0; i < count; i++) ones[i] = 1;
        form_mass_product(&s->model, ones, y);
        for (i = 0; i < count; i++) y[i] *= x[i];
        free(ones);
    } else
        form_mass_product(&s->model, x, y);
}

static double mass_of(const scene *s) {
    size_t e;
    int k;
    double sum = 0;
    for (e = 0; e < s->model.element_count; e++)
        for (k = 0; k < 10; k++) sum += s->elements[e].mass[k] * (k == 0 || k == 4 || k == 7 || k == 9 ? 1 : 2);
    return sum;
}

/* kinetic, elastic and gravity's, J */
static double total_energy(const scene *s, const double *gravity) {
    const size_t count = 3 * s->model.copy_count;
    double *y = (double *)zeroed(2 * count, sizeof *y), sum;
    size_t i;
    sum = form_energy(&s->model, s->displacement);
    mass_times(s, s->velocity, y);
    for (i = 0; i < count; i++) {
        sum += 0.5 * y[i] * s->velocity[i];
        y[count + i] = gravity[i % 3];
    }
    mass_times(s, y + count, y);
    for (i = 0; i < count; i++) sum -= y[i] * s->displacement[i];
    free(y);
    return sum;
}

/* sum of x cross M v, x where copies are now */
static void angular_momentum(const scene *s, double *sum) {
    double *mv = (double *)zeroed(3 * s->model.copy_count, sizeof *mv);
    size_t i, r;
    mass_times(s, s->velocity, mv);
    sum[0] = sum[1] = sum[2] = 0;
    for (i = 0; i < s->model.copy_count; i++) {
        double x[3];
        for (r = 0; r < 3; r++) x[r] = s->rest[3 * i + r] + s->displacement[3 * i + r];
        for (r = 0; r < 3; r++)
            sum[r] += x[(r + 1) % 3] * mv[3 * i + (r + 2) % 3] - x[(r + 2) % 3] * mv[3 * i + (r + 1) % 3];
    }
    free(mv);
}

static double distance(const double *a, const double *b, size_t count) {
    double most = 0;
    size_t i;
    for (i = 0; i < count; i++) most = fabs(a[i] - b[i]) > most ? fabs(a[i] - b[i]) : most;
    return most;
}

static void check_finite(const scene *s) {
    size_t i;
    for (i = 0; i < 3 * s->model.copy_count; i++)
        assert_that(finite_bits(s->displacement[i]) && finite_bits(s->velocity[i]), "copy %lu", (unsigned long)(i / 3));
}

/* ---- points ---- */

static gxs_point point_at(const scene *s, size_t copy) {
    gxs_point point;
    memset(&point, 0, sizeof point);
    point.count = 4;
    point.copy[0] = (uint32_t)copy;
    point.weight[0] = 1;
    memcpy(point.position, s->rest + 3 * copy, sizeof point.position);
    return point;
}

static gxs_point point_within(const scene *s, size_t element, const double *weights) {
    gxs_point point;
    int k, r;
    memset(&point, 0, sizeof point);
    point.count = 4;
    for (k = 0; k < 4; k++) {
        point.copy[k] = s->elements[element].copy[k];
        point.weight[k] = weights[k];
        for (r = 0; r < 3; r++) point.position[r] += weights[k] * s->rest[3 * point.copy[k] + (uint32_t)r];
    }
    return point;
}

static gxs_point random_point(const scene *s) {
    double w[4], sum = 0;
    int k;
    for (k = 0; k < 4; k++) sum += w[k] = 1.01 + uniform();
    for (k = 0; k < 4; k++) w[k] /= sum;
    return point_within(s, (size_t)((uniform() + 1) / 2 * (double)s->model.element_count), w);
}

static void point_now(const gxs_point *point, const double *displacement, double *x) {
    int k, r;
    for (r = 0; r < 3; r++) {
        x[r] = point->position[r];
        for (k = 0; k < 4; k++) x[r] += point->weight[k] * displacement[3 * point->copy[k] + (uint32_t)r];
    }
}

/* every copy of a block as a contact point */
static gxs_point *points_of(const scene *s, size_t first, size_t end) {
    gxs_point *points = (gxs_point *)zeroed(end - first, sizeof *points);
    size_t i;
    for (i = first; i < end; i++) points[i - first] = point_at(s, i);
    return points;
}

static gxs_spring spring_make(gxs_point point, double stiffness) {
    gxs_spring spring;
    spring.point = point;
    memcpy(spring.target, point.position, sizeof spring.target);
    spring.stiffness = stiffness;
    return spring;
}

static gxs_plane plane_make(double stiffness, double friction) {
    gxs_plane plane;
    memset(&plane, 0, sizeof plane);
    plane.normal[2] = 1;
    plane.stiffness = stiffness;
    plane.friction = friction;
    return plane;
}

static double plane_depth(const gxs_plane *plane, const double *x) {
    double depth = plane->offset - plane->normal[0] * x[0] - plane->normal[1] * x[1] - plane->normal[2] * x[2];
    return depth > 0 ? depth : 0;
}

/* Sum over points of the forces of a step's planes at displacement u, by the manual's formulas; u_n is the start; N.
   Returns the energy of contact, J. */
static double plane_forces(const gxs_step_desc *step, const double *un, const double *u, double *force) {
    double energy = 0;
    size_t i, p;
    int r;
    force[0] = force[1] = force[2] = 0;
    for (i = 0; i < step->point_count; i++)
        for (p = 0; p < step->plane_count; p++) {
            const gxs_plane *plane = &step->planes[p];
            const double reach = step->dt * (plane->sticking_speed > 0 ? plane->sticking_speed : 1e-3);
            double before[3], now[3], way[3], along = 0, length = 0, depth, hold;
            point_now(&step->points[i], un, before);
            point_now(&step->points[i], u, now);
            depth = plane_depth(plane, now);
            hold = plane->friction * plane->stiffness * plane_depth(plane, before);
            for (r = 0; r < 3; r++) along += plane->normal[r] * (now[r] - before[r]);
            for (r = 0; r < 3; r++) {
                way[r] = now[r] - before[r] - along * plane->normal[r];
                length += way[r] * way[r];
            }
            length = sqrt(length);
            for (r = 0; r < 3; r++)
                force[r] +=
                    plane->stiffness * depth * plane->normal[r] - hold * way[r] / (length > reach ? length : reach);
            energy += 0.5 * plane->stiffness * depth * depth;
        }
    return energy;
}

/* ---- constraints ---- */

/* Affine motion and some noise; followers move as their masters make them */
static void stir(scene *s, double affine, double noise) {
    double a[9];
    size_t i, r;
    for (i = 0; i < 9; i++) a[i] = affine * uniform();
    for (i = 0; i < s->model.copy_count; i++)
        for (r = 0; r < 3; r++)
            s->velocity[3 * i + r] = s->held[i] ? 0
                                                : a[3 * r] * s->rest[3 * i] + a[3 * r + 1] * s->rest[3 * i + 1] +
                                                      a[3 * r + 2] * s->rest[3 * i + 2] + noise * uniform();
}

static void set_block(scene *s, int kind, int lumped, int held) {
    set_kind(s->material, kind);
    s->material->young = 1e5;
    s->material->damping = lumped ? 1e-3 : 0;
    s->model.lumped_mass = (uint32_t)lumped;
    if (held) scene_hold_left(s);
}

/* A block whose halves are tied one to one moves as the whole block does. */
START_TEST(tied_blocks_move_as_one) {
    const int kind = _i / 4, lumped = _i / 2 % 2, held = _i % 2;
    gxs_step_desc step = step_tight(0.01, -9.81);
    double path[10][3 * 128];
    int which, frame;
    for (which = -1; which < SOLVERS; which++) { /* -1: the whole block */
        gxs_solver *solver = solver_of(which < 0 ? 0 : which);
        gxs_constraint *ties = NULL;
        gxs_step_report report;
        size_t i, n;
        scene s;
        seed((uint64_t)_i);
        s = scene_block(6, 2, 2, 0.25, 0, 0);
        n = s.model.copy_count;
        ck_assert_uint_le(n, 128);
        set_block(&s, kind, lumped, held);
        stir(&s, 1, 0.3);
        if (which >= 0) ties = scene_split(&s, 0.75);
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        for (frame = 0; frame < 10; frame++) {
            double off;
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
            assert_that(report.residual < 1e-10, "%s: residual %g", which < 0 ? "whole" : solver_name(which),
                        report.residual);
            if (which < 0) {
                memcpy(path[frame], s.displacement, 3 * n * sizeof(double));
                continue;
            }
            ck_assert_uint_eq(report.active_unknowns, 3 * (n - (held ? 9 : 0)));
            off = distance(path[frame], s.displacement, 3 * n);
            assert_that(off < 1e-8, "%s frame %d: %g m apart", solver_name(which), frame, off);
            for (i = 0; i < s.model.constraint_count; i++) {
                const size_t a = 3 * ties[i].copy, b = 3 * ties[i].master[0];
                assert_that(distance(s.displacement + a, s.displacement + b, 3) < 1e-13 &&
                                distance(s.velocity + a, s.velocity + b, 3) < 1e-10,
                            "tie %lu is open", (unsigned long)i);
            }
        }
        free(ties);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* Momentum of a tied free block is right to rounding too, at a CG tolerance of 1e-1. */
START_TEST(momentum_of_tied_blocks_is_balanced) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0.01, -9.81);
    gxs_constraint *ties;
    double before[3], after[3];
    int frame, r;
    scene s;
    seed((uint64_t)_i);
    s = scene_block(4, 2, 2, 0.25, 0, 0);
    stir(&s, 1, 5);
    ties = scene_split(&s, 0.5);
    step.cg_tolerance = 0.1;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 20; frame++) {
        momentum(&s, before);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        momentum(&s, after);
        for (r = 0; r < 3; r++)
            assert_that(fabs(after[r] - before[r] - step.dt * step.gravity[r] * mass_of(&s)) < 1e-10,
                        "frame %d axis %d: %g", frame, r,
                        after[r] - before[r] - step.dt * step.gravity[r] * mass_of(&s));
    }
    free(ties);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A cube below, eight cubes of half its edge above. Their nodes on its face follow its four nodes there. The space
   is continuous across the face, since the cube's diagonal is that of the small ones. */
static scene scene_hanging(gxs_constraint *ties) {
    scene s = scene_block(1, 1, 1, 1, 0, 0), above = scene_block(2, 2, 2, 0.5, 0, 0);
    uint32_t i, count = 0;
    int k;
    scene_add(&s, &above, 0, 0, 1);
    for (i = 8; i < s.model.copy_count; i++)
        if (s.rest[3 * i + 2] < 1 + 1e-9) {
            const double x = s.rest[3 * i], y = s.rest[3 * i + 1];
            gxs_constraint *tie = &ties[count++];
            memset(tie, 0, sizeof *tie);
            tie->copy = i;
            /* Copies 4 ... 7 have z = 1. The interpolation is linear on the triangles on both sides of the diagonal
               x = y. */
            for (k = 0; k < 4; k++) tie->master[k] = 4 + (uint32_t)k;
            tie->weight[0] = 1 - (x > y ? x : y);
            tie->weight[1] = x > y ? x - y : 0;
            tie->weight[2] = y > x ? y - x : 0;
            tie->weight[3] = x < y ? x : y;
        }
    ck_assert_uint_eq(count, 9);
    s.model.constraints = ties;
    s.model.constraint_count = count;
    return s;
}

/* The patch test: an affine displacement of the held copies is found everywhere, through the hanging nodes. Held
   copies follow targets. */
START_TEST(hanging_nodes_pass_the_patch_test) {
    gxs_constraint ties[9];
    int which, r;
    for (which = 0; which < SOLVERS; which++) {
        gxs_solver *solver = solver_of(which);
        gxs_step_desc step = step_tight(0, 0);
        double a[9], *targets;
        size_t i, n;
        scene s;
        seed((uint64_t)_i);
        s = scene_hanging(ties);
        n = s.model.copy_count;
        targets = (double *)zeroed(3 * n, sizeof *targets);
        set_kind(s.material, _i);
        for (i = 0; i < 9; i++) a[i] = 0.05 * uniform();
        for (i = 0; i < n; i++) {
            const double *x = s.rest + 3 * i;
            const double inside = x[0] * (1 - x[0]) * x[1] * (1 - x[1]) * x[2] * (2 - x[2]);
            s.held[i] = _i == GXS_LINEAR ? x[2] < 1e-9 || x[2] > 2 - 1e-9 : inside < 1e-9;
            if (i >= 8 && fabs(x[2] - 1) < 1e-9) s.held[i] = 0;
            /* Of the linear material, whose sides are free: stretched by 1 %, narrower by Poisson's ratio */
            for (r = 0; r < 3; r++)
                targets[3 * i + (size_t)r] = _i == GXS_LINEAR
                                               ? (r == 2 ? 0.01 : -0.01 * s.material->poisson) * x[r]
                                               : a[3 * r] * x[0] + a[3 * r + 1] * x[1] + a[3 * r + 2] * x[2];
        }
        step.integrator = GXS_STATIC;
        step.targets = targets;
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        assert_that(distance(s.displacement, targets, 3 * n) < 1e-9, "%s: %g m off", solver_name(which),
                    distance(s.displacement, targets, 3 * n));
        free(targets);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* Followers are where their masters lead, in motion; also with weights whose sum is 1.5 or that are negative */
START_TEST(followers_change_by_their_masters_mean) {
    gxs_constraint ties[9];
    int which, frame, k;
    for (which = 0; which < SOLVERS; which++) {
        gxs_solver *solver = solver_of(which);
        gxs_step_desc step = step_make(0.01, -9.81);
        double *before;
        size_t i, r, n;
        scene s;
        seed((uint64_t)(10 * which + _i));
        s = scene_hanging(ties);
        n = s.model.copy_count;
        before = (double *)zeroed(3 * n, sizeof *before);
        stir(&s, 1, 1);
        if (_i == 1)
            ties[4].weight[0] = 1.5, ties[4].weight[3] = -0.5;
        else if (_i == 2)
            ties[4].weight[0] = 1.5, ties[4].weight[3] = 0;
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        for (frame = 0; frame < 20; frame++) {
            memcpy(before, s.displacement, 3 * n * sizeof *before);
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
            check_finite(&s);
            for (i = 0; i < 9; i++)
                for (r = 0; r < 3; r++) {
                    double way = 0, done = s.displacement[3 * ties[i].copy + r] - before[3 * ties[i].copy + r];
                    for (k = 0; k < 4; k++)
                        way += ties[i].weight[k] *
                               (s.displacement[3 * ties[i].master[k] + r] - before[3 * ties[i].master[k] + r]);
                    assert_that(fabs(way - done) < 1e-13, "%s: follower %lu went %.17g, its masters %.17g",
                                solver_name(which), (unsigned long)i, done, way);
                    assert_that(fabs(s.velocity[3 * ties[i].copy + r] - done / step.dt) < 1e-9, "velocity %g for %g",
                                s.velocity[3 * ties[i].copy + r], done / step.dt);
                }
        }
        free(before);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* A block tied by its left face to held copies that move behaves like one whose left face itself is moved,
   velocities included. (Lumped, so that the inertia of the moved face acts on nothing else.) */
START_TEST(followers_of_moving_targets_go_along) {
    static const gxs_integrator integrators[3] = {GXS_BDF1, GXS_BDF2, GXS_MIDPOINT};
    double path[30][2][3 * 64];
    int tied, frame;
    for (tied = 0; tied < 2; tied++) {
        gxs_solver *solver = solver_of(_i / 3);
        gxs_step_desc step = step_tight(0.01, 0);
        scene s;
        gxs_constraint ties[9];
        double targets[3 * 64], previous[2][3 * 64], now[2][3 * 64];
        size_t i, n, base;
        memset(ties, 0, sizeof ties);
        memset(targets, 0, sizeof targets);
        s = scene_block(3, 2, 2, 0.25, 0, 12);
        n = s.model.copy_count;
        base = n;
        s.material->young = 1e5;
        s.model.lumped_mass = 1;
        scene_hold_left(&s);
        if (tied) { /* nine copies of no element are held and moved; the left face follows */
            for (i = 0; i < base; i++)
                if (s.held[i]) {
                    ties[n - base].copy = (uint32_t)i;
                    ties[n - base].master[2] = (uint32_t)n;
                    ties[n - base].weight[2] = 1;
                    memcpy(s.rest + 3 * n, s.rest + 3 * i, 3 * sizeof(double));
                    s.held[n++] = 1;
                    s.held[i] = 0;
                }
            ck_assert_uint_eq(n, base + 9);
            s.model.copy_count = n;
            s.model.constraints = ties;
            s.model.constraint_count = 9;
        }
        ck_assert_uint_le(n, 64);
        step.integrator = integrators[_i % 3];
        step.targets = targets;
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        for (frame = 0; frame < 30; frame++) {
            gxs_step_report report;
            double off;
            for (i = 0; i < n; i++) targets[3 * i + 1] = frame < 15 ? 0.01 * (frame + 1) : 0.15;
            memcpy(now[0], s.displacement, 3 * n * sizeof(double));
            memcpy(now[1], s.velocity, 3 * n * sizeof(double));
            if (frame > 0 && step.integrator == GXS_BDF2)
                step.previous_displacement = previous[0], step.previous_velocity = previous[1],
                step.previous_dt = step.dt;
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
            memcpy(previous, now, sizeof now);
            ck_assert_uint_eq(report.active_unknowns, 3 * (base - 9));
            if (!tied) {
                memcpy(path[frame][0], s.displacement, 3 * base * sizeof(double));
                memcpy(path[frame][1], s.velocity, 3 * base * sizeof(double));
                continue;
            }
            off = distance(path[frame][0], s.displacement, 3 * base);
            assert_that(step.integrator != GXS_BDF1 || off < 1e-9, "frame %d: %g m apart", frame, off);
            for (i = 0; i < 9; i++) {
                const size_t a = 3 * ties[i].copy, b = 3 * ties[i].master[2];
                assert_that(distance(s.displacement + a, s.displacement + b, 3) < 1e-13, "frame %d: tie %lu is open",
                            frame, (unsigned long)i);
                if (step.integrator == GXS_BDF1)
                    assert_that(distance(s.velocity + a, s.velocity + b, 3) < 1e-10,
                                "frame %d: a follower has %g m/s, its master %g", frame, s.velocity[a + 1],
                                s.velocity[b + 1]);
            }
            off = distance(path[frame][1], s.velocity, 3 * base);
            assert_that(step.integrator != GXS_BDF1 || off < 1e-7, "frame %d: velocities %g m/s apart", frame, off);
        }
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* A step is a minimum of E over the free copies, also where targets move the others: its gradient there is 0, by the
   assembled forms. */
START_TEST(moved_copies_have_inertia) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_tight(0.01, -9.81);
    double *work, *targets, *un, *g, *my;
    size_t i, count;
    int frame;
    scene s = scene_block(3, 2, 2, 0.25, 0, 0);
    count = 3 * s.model.copy_count;
    work = (double *)zeroed(5 * count, sizeof *work);
    targets = work, un = work + count, g = work + 2 * count, my = work + 3 * count;
    s.material->young = 1e5;
    scene_hold_left(&s);
    step.targets = targets;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 6; frame++) {
        double worst = 0, size = 0, *y = work + 4 * count;
        for (i = 0; i < s.model.copy_count; i++) targets[3 * i + 1] = frame < 3 ? 0.01 * (frame + 1) : 0.03;
        memcpy(un, s.displacement, count * sizeof *un);
        for (i = 0; i < count; i++)
            y[i] = -s.displacement[i] - step.dt * s.velocity[i] - step.dt * step.dt * step.gravity[i % 3];
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        for (i = 0; i < count; i++) y[i] = (y[i] + s.displacement[i]) / (step.dt * step.dt);
        form_mass_product(&s.model, y, my);
        form_gradient(&s.model, s.displacement, g);
        for (i = 0; i < count; i++)
            if (!s.held[i / 3]) {
                worst = fabs(my[i] + g[i]) > worst ? fabs(my[i] + g[i]) : worst;
                size = fabs(g[i]) > size ? fabs(g[i]) : size;
            }
        assert_that(worst < 1e-7 * size, "frame %d: gradient of E %g N beside elastic forces of %g N", frame, worst,
                    size);
    }
    free(work);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* All copies are held or follow held ones: no unknowns, and yet everything moves. */
START_TEST(followers_alone_go_along) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0.01, -9.81);
    gxs_step_report report;
    gxs_constraint ties[4];
    double targets[3 * 8];
    size_t i;
    scene s = scene_block(1, 1, 1, 1, 0, 0);
    memset(ties, 0, sizeof ties);
    for (i = 0; i < 8; i++) {
        s.held[i] = i < 4;
        targets[3 * i] = targets[3 * i + 1] = 0, targets[3 * i + 2] = 0.25;
    }
    for (i = 0; i < 4; i++) ties[i].copy = (uint32_t)(4 + i), ties[i].master[0] = (uint32_t)i, ties[i].weight[0] = 1;
    s.model.constraints = ties;
    s.model.constraint_count = 4;
    step.targets = targets;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 0);
    for (i = 0; i < 8; i++)
        assert_that(s.displacement[3 * i + 2] == 0.25 && fabs(s.velocity[3 * i + 2] - 25) < 1e-9,
                    "copy %lu at %g with %g m/s", (unsigned long)i, s.displacement[3 * i + 2], s.velocity[3 * i + 2]);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Two ties of a free block, one of them wrong: the error is named, and the solver steps the model that it had, bit
   for bit. */
static void expect_constraints(const gxs_constraint *ties, size_t count, gx_result expected, const char *field,
                               size_t index) {
    gxs_step_desc step = step_make(0.033, -9.81);
    double first[3 * 12];
    int run;
    for (run = 0; run < 2; run++) {
        gxs_solver *solver = solver_make();
        gx_failure failure;
        scene s = scene_block(2, 1, 1, 0.5, 0, 0);
        scene_hold_left(&s);
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        s.model.constraints = ties;
        s.model.constraint_count = count;
        if (run == 1) {
            s.held[1] = 1; /* of the model that is refused */
            s.held[0] = 0;
            ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, &failure), expected);
            ck_assert_int_eq(failure.result, expected);
            ck_assert_pstr_eq(failure.field, field);
            ck_assert_uint_eq(failure.index, index);
        }
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        if (run == 0) memcpy(first, s.displacement, sizeof first);
        ck_assert_int_eq(memcmp(first, s.displacement, sizeof first), 0);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}

#define constraints_with(change, result, field, index)                                                                 \
    do {                                                                                                               \
        gxs_constraint ties[2];                                                                                        \
        memset(ties, 0, sizeof ties);                                                                                  \
        ties[0].copy = 4, ties[1].copy = 5;                                                                            \
        ties[0].master[0] = ties[1].master[0] = 2;                                                                     \
        ties[0].weight[0] = ties[1].weight[0] = 1;                                                                     \
        change;                                                                                                        \
        expect_constraints(ties, 2, result, field, index);                                                             \
    } while (0)

START_TEST(bad_constraints_are_named) {
    constraints_with(ties[0].copy = 12, GX_ERROR_INDEX, "constraints.copy", 0);
    constraints_with(ties[1].copy = UINT32_MAX, GX_ERROR_INDEX, "constraints.copy", 1);
    constraints_with(ties[1].master[0] = 12, GX_ERROR_INDEX, "constraints.master", 1);
    constraints_with(ties[1].master[3] = 12, GX_ERROR_INDEX, "constraints.master", 1); /* of weight 0 */
    constraints_with(ties[1].weight[2] = not_a_number(0), GX_ERROR_NOT_FINITE, "constraints.weight", 1);
    constraints_with(ties[0].weight[0] = not_a_number(1), GX_ERROR_NOT_FINITE, "constraints.weight", 0);
    constraints_with(ties[1].copy = 4, GX_ERROR_ARGUMENT, "constraints", 1);      /* the same copy twice */
    constraints_with(ties[1].master[0] = 4, GX_ERROR_ARGUMENT, "constraints", 1); /* a chain */
    constraints_with(ties[0].master[0] = 5, GX_ERROR_ARGUMENT, "constraints", 0); /* a chain backwards */
    constraints_with(ties[1].master[0] = 5, GX_ERROR_ARGUMENT, "constraints", 1); /* of itself */
    constraints_with(ties[0].master[0] = 5; ties[1].master[0] = 4, GX_ERROR_ARGUMENT, "constraints", 0);
    expect_constraints(NULL, 1, GX_ERROR_ARGUMENT, "constraints", SIZE_MAX);
}
END_TEST

/* A master of weight 0 that follows, and constraints of held copies, which follow nothing, are no chains. */
START_TEST(harmless_constraints_are_taken) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.033, -9.81);
    gxs_constraint ties[3];
    scene s = scene_block(2, 1, 1, 0.5, 0, 0);
    scene_hold_left(&s); /* copies 0, 3, 6, 9 */
    memset(ties, 0, sizeof ties);
    ties[0].copy = 4, ties[0].master[0] = 2, ties[0].weight[0] = 1, ties[0].master[1] = 5;
    ties[1].copy = 5, ties[1].master[0] = 3, ties[1].weight[0] = 1;
    ties[2].copy = 3, ties[2].master[0] = 8, ties[2].weight[0] = 1;
    s.model.constraints = ties;
    s.model.constraint_count = 3;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    ck_assert(s.displacement[3 * 3 + 2] == 0 && s.displacement[3 * 5 + 2] == 0 && s.displacement[3 * 2 + 2] < 0);
    ck_assert(s.displacement[3 * 4 + 2] == s.displacement[3 * 2 + 2]);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- springs ---- */

/* p(n+1) - p(n) = dt (M g + forces of the springs at the end) */
START_TEST(springs_balance_momentum) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_tight(0.01, -9.81);
    gxs_spring springs[6];
    double forces[18], before[3], after[3];
    int frame, k, r;
    scene s;
    seed((uint64_t)_i);
    s = scene_block(3, 2, 2, 0.25, 0.1, 0);
    stir(&s, 3, 1);
    for (k = 0; k < 6; k++) {
        springs[k] = spring_make(random_point(&s), k == 5 ? 1e6 : 1e4);
        for (r = 0; r < 3; r++) springs[k].target[r] += 0.2 * uniform();
    }
    step.springs = springs;
    step.spring_count = 6;
    step.spring_forces = forces;
    step.newton_tolerance = 1e-13;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 10; frame++) {
        gxs_step_report report;
        double scale = 0;
        momentum(&s, before);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        momentum(&s, after);
        for (r = 0; r < 3; r++) scale += fabs(before[r]) + fabs(after[r]);
        for (r = 0; r < 3; r++) {
            double impulse = step.dt * mass_of(&s) * step.gravity[r];
            for (k = 0; k < 6; k++) impulse += step.dt * forces[3 * k + r];
            assert_that(fabs(after[r] - before[r] - impulse) < 1e-10 * scale, "%s frame %d: %g of %g, residual %g",
                        solver_name(_i), frame, after[r] - before[r] - impulse, scale, report.residual);
        }
        for (k = 0; k < 6; k++) { /* and the forces are those of Hooke's law */
            double x[3];
            point_now(&springs[k].point, s.displacement, x);
            for (r = 0; r < 3; r++)
                assert_that(fabs(forces[3 * k + r] - springs[k].stiffness * (springs[k].target[r] - x[r])) <
                                1e-12 * springs[k].stiffness,
                            "spring %d", k);
        }
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A block hung on three springs of unequal stiffness inside elements: their forces are its weight, without torque
   about any point. */
START_TEST(springs_carry_a_weight) {
    const double weights[4] = {0.1, 0.2, 0.3, 0.4};
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_tight(0, -9.81);
    gxs_step_report report;
    gxs_spring springs[3];
    double forces[9], sum[3] = {0, 0, 0}, torque[3] = {0, 0, 0}, *mg, scale;
    size_t i;
    int k, r;
    scene s;
    seed((uint64_t)_i);
    s = scene_block(4, 2, 2, 0.25, 0.1, 0);
    mg = (double *)zeroed(6 * s.model.copy_count, sizeof *mg);
    springs[0] = spring_make(point_within(&s, 3, weights), 1e4);
    springs[1] = spring_make(point_within(&s, 60, weights), 3e4);
    springs[2] = spring_make(point_within(&s, 90, weights), 2e6);
    step.integrator = GXS_STATIC;
    step.springs = springs;
    step.spring_count = 3;
    step.spring_forces = forces;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    assert_that(report.residual < 1e-10, "%s: residual %g", solver_name(_i), report.residual);
    scale = 9.81 * mass_of(&s);
    for (k = 0; k < 3; k++) {
        double x[3];
        point_now(&springs[k].point, s.displacement, x);
        for (r = 0; r < 3; r++) {
            sum[r] += forces[3 * k + r];
            torque[r] += x[(r + 1) % 3] * forces[3 * k + (r + 2) % 3] - x[(r + 2) % 3] * forces[3 * k + (r + 1) % 3];
        }
    }
    for (i = 0; i < 3 * s.model.copy_count; i++) mg[i] = step.gravity[i % 3];
    form_mass_product(&s.model, mg, mg + 3 * s.model.copy_count);
    for (i = 0; i < 3 * s.model.copy_count; i += 3) {
        const double f = mg[3 * s.model.copy_count + i + 2];
        torque[0] += (s.rest[i + 1] + s.displacement[i + 1]) * f;
        torque[1] -= (s.rest[i] + s.displacement[i]) * f;
    }
    for (r = 0; r < 3; r++)
        assert_that(fabs(sum[r] - (r == 2 ? scale : 0)) < 1e-8 * scale && fabs(torque[r]) < 1e-7 * scale,
                    "axis %d: force %g torque %g", r, sum[r], torque[r]);
    for (i = 0; i < 3 * s.model.copy_count; i++) ck_assert(s.velocity[i] == 0);
    free(mg);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Springs without stiffness, and springs on held copies only, change nothing but spring_forces. */
START_TEST(idle_springs_change_nothing) {
    double first[3 * 64];
    int run, frame;
    for (run = 0; run < 3; run++) {
        gxs_solver *solver = solver_of(_i);
        gxs_step_desc step = step_make(0.033, -9.81);
        gxs_spring springs[4];
        double forces[12];
        size_t count;
        int k;
        scene s;
        seed(1);
        s = scene_block(3, 2, 2, 0.25, 0, 0);
        count = 3 * s.model.copy_count;
        scene_hold_left(&s);
        stir(&s, 1, 1);
        for (k = 0; k < 4; k++) {
            springs[k] = spring_make(run == 1 ? random_point(&s) : point_at(&s, (size_t)k * 4), run == 1 ? 0 : 1e5);
            springs[k].target[1] += 1;
        }
        step.springs = springs;
        step.spring_count = run > 0 ? 4 : 0;
        step.spring_forces = forces;
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        for (frame = 0; frame < 5; frame++)
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        for (k = 0; k < 4 && run > 0; k++) {
            if (run == 2) ck_assert(s.held[4 * k]);
            assert_that(fabs(forces[3 * k + 1] - (run == 1 ? 0 : 1e5)) < 1e-6 && forces[3 * k] == 0, "spring %d: %g", k,
                        forces[3 * k + 1]);
        }
        if (run == 0) memcpy(first, s.displacement, count * sizeof(double));
        assert_that(memcmp(first, s.displacement, count * sizeof(double)) == 0, "run %d: %g m apart", run,
                    distance(first, s.displacement, count));
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* A spring of 1e9 N/m leads a corner and an inner point: both follow it to within force / stiffness. */
START_TEST(stiff_springs_lead) {
    const double weights[4] = {0.25, 0.25, 0.25, 0.25};
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_tight(0.01, -9.81);
    gxs_spring springs[2];
    double start[2][3];
    int frame, k;
    scene s = scene_block(6, 3, 3, 0.25, 0, 0);
    springs[0] = spring_make(point_at(&s, s.model.copy_count - 1), 1e9);
    springs[1] = spring_make(point_within(&s, 40, weights), 1e9);
    for (k = 0; k < 2; k++) memcpy(start[k], springs[k].target, sizeof start[k]);
    step.newton_tolerance = 1e-8;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    /* one without them */
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    step.springs = springs;
    step.spring_count = 2;
    for (frame = 0; frame < 20; frame++) {
        gxs_step_report report;
        for (k = 0; k < 2; k++) {
            springs[k].target[0] = start[k][0] + 0.01 * frame;
            springs[k].target[1] = start[k][1] + 0.1 * sin(0.3 * frame);
        }
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(report.residual < 1e-7, "%s frame %d: residual %g after %u Newton, %u CG iterations",
                    solver_name(_i), frame, report.residual, (unsigned)report.newton_iterations,
                    (unsigned)report.cg_iterations);
        for (k = 0; k < 2; k++) {
            double x[3];
            point_now(&springs[k].point, s.displacement, x);
            assert_that(distance(x, springs[k].target, 3) < 1e-3, "%s frame %d: spring %d is %g m behind",
                        solver_name(_i), frame, k, distance(x, springs[k].target, 3));
        }
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Springs at the middle of many elements and faces, of 1e-3 to 1e9 N/m, after steps without them: a solver with
   other steps behind it solves as well as a new one. */
START_TEST(later_springs_converge_as_well) {
    static const double stiffnesses[3] = {1e3, 1e6, 1e9};
    gxs_step_desc step = step_make(0.033, -9.81);
    gxs_spring springs[200];
    uint32_t counts[2] = {0, 0};
    int late, k;
    for (late = 0; late < 2; late++) {
        gxs_solver *solver = solver_of(_i / 3);
        gxs_step_report report;
        scene s;
        seed(17);
        s = scene_block(6, 6, 6, 0.25, 0.1, 0);
        scene_hold_left(&s);
        for (k = 0; k < 200; k++) {
            const double inside[4] = {0.25, 0.25, 0.25, 0.25}, face[4] = {1.0 / 3, 1.0 / 3, 0, 1.0 / 3};
            springs[k] = spring_make(point_within(&s, 6 * (size_t)k + 2, k % 2 ? inside : face), stiffnesses[_i % 3]);
            springs[k].target[1] += 0.05;
        }
        step.springs = springs;
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        step.newton_iterations = 1;
        step.spring_count = 0;
        if (late) ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        memset(s.displacement, 0, 3 * s.model.copy_count * sizeof(double));
        memset(s.velocity, 0, 3 * s.model.copy_count * sizeof(double));
        step.spring_count = 200;
        step.newton_iterations = 30;
        step.newton_tolerance = 1e-6; /* 1e9 N/m x 5 cm leave not many more digits */
        step.cg_iterations = 3000;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(report.residual < 1e-6, "%s at %g N/m, %s: residual %g after %u Newton, %u CG iterations",
                    solver_name(_i / 3), stiffnesses[_i % 3], late ? "late" : "early", report.residual,
                    (unsigned)report.newton_iterations, (unsigned)report.cg_iterations);
        counts[late] = report.cg_iterations;
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
    assert_that(counts[1] <= 2 * counts[0] + 20, "%s at %g N/m: %u iterations, %u if they come late",
                solver_name(_i / 3), stiffnesses[_i % 3], (unsigned)counts[0], (unsigned)counts[1]);
}
END_TEST

/* ---- bad input of a step ---- */

typedef struct attempt {
    scene s;
    gxs_step_desc step;
    gxs_spring springs[3];
    gxs_point points[3];
    gxs_plane planes[2];
    double rest_times[12];
    gxs_solver *solver;
} attempt;

static double no_clock(void *user) {
    (void)user;
    return 0;
}

static double no_contact(void *user, size_t point, const double *position, double *force, double *hessian) {
    (void)user, (void)point, (void)position, (void)force, (void)hessian;
    return 0;
}

static void attempt_make(attempt *a) {
    int k;
    memset(a, 0, sizeof *a);
    a->s = scene_block(2, 1, 1, 0.5, 0, 0);
    a->step = step_make(0.033, -9.81);
    a->solver = solver_make();
    for (k = 0; k < 3; k++) {
        a->springs[k] = spring_make(point_at(&a->s, (size_t)k), 1e3);
        a->points[k] = point_at(&a->s, (size_t)k);
        a->planes[k % 2] = plane_make(1e4, 0.5);
    }
    a->step.springs = a->springs;
    a->step.points = a->points;
    a->step.planes = a->planes;
    a->step.spring_count = a->step.point_count = 3;
    a->step.plane_count = 2;
    a->step.rest_times = a->rest_times;
    a->step.clock = no_clock;
    a->step.contact = no_contact;
}

static void expect(attempt *a, gx_result result, const char *field, size_t index) {
    const size_t count = 3 * a->s.model.copy_count;
    gx_failure failure;
    size_t i;
    ck_assert_int_eq(advance(a->solver, &a->s.model, &a->step, a->s.displacement, a->s.velocity, NULL, &failure),
                     result);
    ck_assert_int_eq(failure.result, result);
    ck_assert_pstr_eq(failure.field, field);
    ck_assert_uint_eq(failure.index, index);
    for (i = 0; i < count && result != GX_OK; i++) ck_assert(a->s.displacement[i] == 0 && a->s.velocity[i] == 0);
    gxs_solver_destroy(a->solver);
    scene_free(&a->s);
}

#define attempt_with(change, result, field, index)                                                                     \
    do {                                                                                                               \
        attempt a;                                                                                                     \
        attempt_make(&a);                                                                                              \
        change;                                                                                                        \
        expect(&a, result, field, index);                                                                              \
    } while (0)

START_TEST(bad_input_is_named) {
    const double nan = not_a_number(0), infinity = not_a_number(1);
    attempt_with((void)a, GX_OK, NULL, SIZE_MAX);
    attempt_with(a.springs[1].point.copy[0] = 12, GX_ERROR_INDEX, "springs.point.copy", 1);
    attempt_with(a.springs[2].point.copy[3] = UINT32_MAX, GX_ERROR_INDEX, "springs.point.copy", 2); /* of weight 0 */
    attempt_with(a.springs[1].point.weight[3] = nan, GX_ERROR_NOT_FINITE, "springs.point.weight", 1);
    attempt_with(a.springs[1].point.position[0] = infinity, GX_ERROR_NOT_FINITE, "springs.point.position", 1);
    attempt_with(a.springs[2].target[1] = nan, GX_ERROR_NOT_FINITE, "springs.target", 2);
    attempt_with(a.springs[2].stiffness = nan, GX_ERROR_NOT_FINITE, "springs.stiffness", 2);
    attempt_with(a.springs[2].stiffness = infinity, GX_ERROR_NOT_FINITE, "springs.stiffness", 2);
    attempt_with(a.springs[2].stiffness = -1, GX_ERROR_ARGUMENT, "springs.stiffness", 2);
    attempt_with(a.step.springs = NULL, GX_ERROR_ARGUMENT, "springs", SIZE_MAX);
    attempt_with(a.points[2].copy[1] = 12, GX_ERROR_INDEX, "points.copy", 2);
    attempt_with(a.springs[1].point.epoch = 1, GX_ERROR_STALE, "springs.point.epoch", 1);
    attempt_with(a.points[2].epoch = 1; a.points[2].copy[1] = 12, GX_ERROR_STALE, "points.epoch", 2);
    attempt_with(a.s.model.epoch = 1; a.springs[0].point.epoch = 1, GX_ERROR_STALE, "springs.point.epoch", 1);
    attempt_with(a.s.model.epoch = 1; a.step.spring_count = 0, GX_ERROR_STALE, "points.epoch", 0);
    attempt_with(a.step.epoch = 1, GX_OK, NULL, SIZE_MAX);
    attempt_with(a.step.epoch = 1; a.step.forces = a.s.forces, GX_ERROR_STALE, "epoch", SIZE_MAX);
    attempt_with(a.step.epoch = 1; a.step.targets = a.s.forces, GX_ERROR_STALE, "epoch", SIZE_MAX);
    attempt_with(a.step.forces = a.step.targets = a.s.forces, GX_OK, NULL, SIZE_MAX);
    attempt_with(a.points[2].weight[0] = nan, GX_ERROR_NOT_FINITE, "points.weight", 2);
    attempt_with(a.points[0].position[2] = nan, GX_ERROR_NOT_FINITE, "points.position", 0);
    attempt_with(a.step.points = NULL, GX_ERROR_ARGUMENT, "points", SIZE_MAX);
    attempt_with(a.planes[1].normal[0] = nan, GX_ERROR_NOT_FINITE, "planes.normal", 1);
    attempt_with(a.planes[1].offset = infinity, GX_ERROR_NOT_FINITE, "planes.offset", 1);
    attempt_with(a.planes[0].stiffness = nan, GX_ERROR_NOT_FINITE, "planes.stiffness", 0);
    attempt_with(a.planes[0].friction = nan, GX_ERROR_NOT_FINITE, "planes.friction", 0);
    attempt_with(a.planes[0].sticking_speed = nan, GX_ERROR_NOT_FINITE, "planes.sticking_speed", 0);
    attempt_with(a.planes[1].normal[2] = 1.01, GX_ERROR_ARGUMENT, "planes.normal", 1);
    attempt_with(a.planes[1].normal[2] = 0, GX_ERROR_ARGUMENT, "planes.normal", 1);
    attempt_with(a.planes[1].stiffness = -1, GX_ERROR_ARGUMENT, "planes.stiffness", 1);
    attempt_with(a.planes[1].friction = -1, GX_ERROR_ARGUMENT, "planes.friction", 1);
    attempt_with(a.planes[1].sticking_speed = -1, GX_ERROR_ARGUMENT, "planes.sticking_speed", 1);
    attempt_with(a.step.planes = NULL, GX_ERROR_ARGUMENT, "planes", SIZE_MAX);
    attempt_with(a.step.sleep_speed = 1, GX_OK, NULL, SIZE_MAX);
    attempt_with(a.step.sleep_speed = 1; a.step.rest_times = NULL, GX_ERROR_ARGUMENT, "rest_times", SIZE_MAX);
    attempt_with(a.step.sleep_speed = -1, GX_ERROR_ARGUMENT, "sleep_speed", SIZE_MAX);
    attempt_with(a.step.sleep_speed = nan, GX_ERROR_NOT_FINITE, "sleep_speed", SIZE_MAX);
    attempt_with(a.step.sleep_time = -1, GX_ERROR_ARGUMENT, "sleep_time", SIZE_MAX);
    attempt_with(a.step.sleep_time = nan, GX_ERROR_NOT_FINITE, "sleep_time", SIZE_MAX);
    attempt_with(a.step.sleep_speed = 1; a.rest_times[7] = nan, GX_ERROR_NOT_FINITE, "rest_times", 7);
    attempt_with(a.step.budget_seconds = 1, GX_OK, NULL, SIZE_MAX);
    attempt_with(a.step.budget_seconds = 1; a.step.clock = NULL, GX_ERROR_ARGUMENT, "clock", SIZE_MAX);
    attempt_with(a.step.budget_seconds = -1, GX_ERROR_ARGUMENT, "budget_seconds", SIZE_MAX);
    attempt_with(a.step.budget_seconds = infinity, GX_ERROR_NOT_FINITE, "budget_seconds", SIZE_MAX);
    attempt_with(a.step.integrator = GXS_STATIC; a.step.dt = -1, GX_ERROR_ARGUMENT, "dt", SIZE_MAX);
}
END_TEST

/* ---- spans ---- */

/* The block with a spring and contact points, stepped five times. way: 0: each point has its four copies; 1: in
   arrays of the caller's; 2: each copy four times, first without weight, then with a third of it */
static void step_spans(int which, int way, double *end, size_t count, double *force) {
    gxs_solver *solver = solver_of(which);
    scene s;
    gxs_step_desc step = step_tight(0.01, -9.81);
    enum { POINTS = 20 };
    gxs_plane plane = plane_make(1e4, 0.4);
    gxs_spring spring;
    gxs_point points[POINTS + 1];
    uint32_t copies[POINTS + 1][16];
    double weights[POINTS + 1][16], at[4] = {0.1, 0.2, 0.3, 0.4};
    int i, frame;
    uint32_t k;
    seed(9);
    s = scene_block(4, 3, 3, 0.25, 0.1, 0);
    ck_assert_uint_eq(count, 3 * s.model.copy_count);
    for (i = 0; i <= POINTS; i++) {
        gxs_point *p = &points[i];
        *p = point_within(&s, (size_t)(7 * i) % s.model.element_count, at);
        if (way == 0) continue;
        for (k = 0; k < 16; k++) {
            copies[i][k] = p->copy[k % 4];
            weights[i][k] = way == 1 ? p->weight[k % 4] : k < 4 ? 0 : p->weight[k % 4] / 3;
        }
        for (k = 0; k < 4; k++) p->copy[k] = UINT32_MAX; /* is not read */
        p->count = way == 1 ? 4 : 16;
        p->copies = copies[i];
        p->weights = weights[i];
    }
    spring = spring_make(points[POINTS], 2e4);
    spring.target[0] += 0.2;
    spring.target[2] += 0.3;
    plane.offset = 0.2;
    step.springs = &spring;
    step.spring_count = 1;
    step.spring_forces = force;
    step.points = points;
    step.point_count = POINTS;
    step.planes = &plane;
    step.plane_count = 1;
    step.sleep_speed = 1e-6;
    step.rest_times = (double *)zeroed(s.model.copy_count, sizeof(double));
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 5; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    memcpy(end, s.displacement, count * sizeof *end);
    free(step.rest_times);
    gxs_solver_destroy(solver);
    scene_free(&s);
}

/* Where a point's copies stand is one; how often they are counted is one, but for rounding. */
START_TEST(points_are_spans) {
    enum { COUNT = 3 * 5 * 4 * 4 };
    static double end[3][COUNT];
    double force[3][3], most = 0;
    int way, i;
    for (way = 0; way < 3; way++) step_spans(_i, way, end[way], COUNT, force[way]);
    ck_assert_int_eq(memcmp(end[0], end[1], sizeof end[0]), 0);
    ck_assert_int_eq(memcmp(force[0], force[1], sizeof force[0]), 0);
    for (i = 0; i < COUNT; i++) most = fmax(most, fabs(end[0][i]));
    ck_assert(most > 1e-2);
    for (i = 0; i < COUNT; i++)
        assert_that(fabs(end[2][i] - end[0][i]) < 1e-8 * most, "%d: %.17g, not %.17g", i, end[2][i], end[0][i]);
}
END_TEST

/* The difference of two points is a point whose weights have the sum 0: it has the copies of both. A spring draws the
   two blocks together, and their common momentum stays. */
START_TEST(a_pair_is_one_span) {
    gxs_solver *solver = solver_of(_i);
    scene s = scene_block(2, 2, 2, 0.5, 0.1, 200), other = scene_block(2, 2, 2, 0.5, 0.1, 0);
    gxs_step_desc step = step_tight(0.01, 0);
    const size_t apart = s.model.copy_count;
    const size_t elements = s.model.element_count;
    uint32_t copies[GXS_POINT_MOST];
    double weights[GXS_POINT_MOST], force[3], momentum = 0, left = 0, at[4] = {0.25, 0.25, 0.25, 0.25};
    gxs_point a, b;
    gxs_spring spring;
    size_t i;
    int k, j;
    scene_add(&s, &other, 3, 0, 0);
    a = point_within(&s, 5, at);
    b = point_within(&s, elements + 5, at);
    memset(&spring, 0, sizeof spring);
    for (k = 0; k < GXS_POINT_MOST; k++) { /* each copy several times, as the most copies of a point */
        const gxs_point *side = k < GXS_POINT_MOST / 2 ? &a : &b;
        copies[k] = side->copy[k % 4];
        weights[k] = (side == &a ? 1 : -1) * side->weight[k % 4] / (GXS_POINT_MOST / 8);
    }
    for (k = 0; k < 3; k++) spring.point.position[k] = a.position[k] - b.position[k];
    spring.point.count = GXS_POINT_MOST;
    spring.point.copies = copies;
    spring.point.weights = weights;
    spring.stiffness = 1e4; /* its target is 0: no distance */
    step.springs = &spring;
    step.spring_count = 1;
    step.spring_forces = force;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    ck_assert_double_gt(force[0], 1e4); /* on a, towards b */
    for (i = 0; i < s.model.element_count; i++)
        for (k = 0; k < 4; k++)
            for (j = 0; j < 4; j++) {
                static const int rows[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
                const double p = s.elements[i].mass[rows[k][j]] * s.velocity[3 * s.elements[i].copy[j]];
                momentum += p;
                left += s.elements[i].copy[j] < apart ? p : 0;
            }
    assert_that(fabs(left - step.dt * force[0]) < 1e-5 * left, "%g, not %g", left, step.dt * force[0]);
    assert_that(fabs(momentum) < 1e-5 * left, "%g of %g", momentum, left);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

START_TEST(bad_spans_are_named) {
    static const uint32_t copies[GXS_POINT_MOST + 1] = {0, 1, 2, 3, 4, 5}, beyond[6] = {0, 1, 2, 3, 12, 0};
    static const double weights[GXS_POINT_MOST + 1] = {0.5, 0.5};
    double bad[6] = {0.5, 0.5, 0, 0, 0, 0};
    bad[5] = not_a_number(0);
#define SPAN(p, n, c, w)                                                                                               \
    (p).count = (n);                                                                                                   \
    (p).copies = (c);                                                                                                  \
    (p).weights = (w)
    attempt_with(SPAN(a.springs[1].point, 6, copies, weights), GX_OK, NULL, SIZE_MAX);
    attempt_with(SPAN(a.points[1], GXS_POINT_MOST, copies, weights), GX_OK, NULL, SIZE_MAX);
    attempt_with(a.springs[1].point.count = 0, GX_ERROR_ARGUMENT, "springs.point.count", 1);
    attempt_with(a.springs[1].point.count = 5, GX_ERROR_ARGUMENT, "springs.point.copies", 1);
    attempt_with(SPAN(a.springs[1].point, 4, NULL, weights), GX_ERROR_ARGUMENT, "springs.point.copies", 1);
    attempt_with(SPAN(a.springs[1].point, 6, copies, NULL), GX_ERROR_ARGUMENT, "springs.point.weights", 1);
    attempt_with(SPAN(a.springs[1].point, GXS_POINT_MOST + 1, copies, weights), GX_ERROR_LIMIT, "springs.point.count",
                 1);
    attempt_with(SPAN(a.springs[1].point, 6, beyond, weights), GX_ERROR_INDEX, "springs.point.copies", 1);
    attempt_with(SPAN(a.springs[1].point, 6, copies, bad), GX_ERROR_NOT_FINITE, "springs.point.weights", 1);
    attempt_with(a.points[2].count = 0, GX_ERROR_ARGUMENT, "points.count", 2);
    attempt_with(SPAN(a.points[2], GXS_POINT_MOST + 1, copies, weights), GX_ERROR_LIMIT, "points.count", 2);
    attempt_with(SPAN(a.points[2], 6, beyond, weights), GX_ERROR_INDEX, "points.copies", 2);
    attempt_with(SPAN(a.points[2], 6, copies, bad), GX_ERROR_NOT_FINITE, "points.weights", 2);
#undef SPAN
}
END_TEST

/* ---- planes and contact ---- */

/* A block dropped on the plane z = 0 comes to rest there. The contact force is its weight. */
START_TEST(dropped_block_comes_to_rest) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_tight(0.02, -9.81);
    gxs_plane plane = plane_make(1e5, 0.3);
    gxs_point *points;
    double force[3], speed = 0;
    size_t i;
    int frame;
    scene s;
    seed(5);
    s = scene_block(3, 2, 2, 0.25, 0.1, 0);
    s.material->damping = 0.01;
    points = points_of(&s, 0, s.model.copy_count);
    for (i = 0; i < s.model.copy_count; i++) s.displacement[3 * i + 2] = 0.3;
    step.points = points;
    step.point_count = s.model.copy_count;
    step.planes = &plane;
    step.plane_count = 1;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 90; frame++) {
        step.dt = frame < 50 ? 0.02 : 0.2;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    }
    for (i = 0; i < 3 * s.model.copy_count; i++) speed = fabs(s.velocity[i]) > speed ? fabs(s.velocity[i]) : speed;
    plane_forces(&step, s.displacement, s.displacement, force);
    assert_that(speed < 1e-5, "%s: still at %g m/s", solver_name(_i), speed);
    assert_that(fabs(force[2] / (9.81 * mass_of(&s)) - 1) < 1e-6, "%s: %g N for a weight of %g N", solver_name(_i),
                force[2], 9.81 * mass_of(&s));
    free(points);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A block that vibrates wildly at and above a plane, 40 times: the change of its momentum is due to the forces that
   the manual states at the end of the step, also where points touch in the course of the iteration but not at its
   end. */
static void vibrate(int which, double friction, double tolerance) {
    int trial, missed = 0, touched = 0, r;
    for (trial = 0; trial < 40; trial++) {
        gxs_solver *solver = solver_of(which);
        gxs_step_desc step = step_tight(0.01, -9.81);
        gxs_plane plane = plane_make(1e6, friction);
        gxs_step_report report;
        gxs_point *points;
        double before[3], after[3], force[3], *start, scale = 0;
        size_t i, n;
        scene s;
        seed((uint64_t)(100 * which + trial));
        s = scene_block(2, 2, 2, 0.25, 0.1, 0);
        n = s.model.copy_count;
        start = (double *)zeroed(3 * n, sizeof *start);
        for (i = 0; i < n; i++) {
            s.displacement[3 * i + 2] = 0.02 + 0.02 * uniform();
            for (r = 0; r < 3; r++) s.velocity[3 * i + (size_t)r] = (trial % 3 ? 5 : 2) * uniform();
        }
        memcpy(start, s.displacement, 3 * n * sizeof *start);
        points = points_of(&s, 0, n);
        step.points = points;
        step.point_count = n;
        step.planes = &plane;
        step.plane_count = 1;
        step.newton_iterations = 200;
        momentum(&s, before);
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        momentum(&s, after);
        plane_forces(&step, start, s.displacement, force);
        touched += force[2] > 0;
        missed += force[2] <= 0;
        for (r = 0; r < 3; r++) scale += fabs(before[r]) + fabs(after[r]) + step.dt * fabs(force[r]);
        for (r = 0; r < 3; r++)
            assert_that(
                fabs(after[r] - before[r] - step.dt * (force[r] + mass_of(&s) * step.gravity[r])) < tolerance * scale,
                "%s axis %d: %g of %g Ns, residual %g after %u iterations, stop %d, contact %g N", solver_name(which),
                r, after[r] - before[r] - step.dt * (force[r] + mass_of(&s) * step.gravity[r]), scale, report.residual,
                (unsigned)report.newton_iterations, (int)report.stop, force[2]);
        assert_that(report.residual < tolerance, "%s: residual %g after %u iterations, stop %d", solver_name(which),
                    report.residual, (unsigned)report.newton_iterations, (int)report.stop);
        free(points), free(start);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
    assert_that(missed > 3 && touched > 3, "%d touched, %d did not", touched, missed);
}

START_TEST(contact_balances_momentum) { vibrate(_i, 0, 1e-8); }
END_TEST

/* to fewer digits, within 200 iterations */
START_TEST(friction_balances_momentum) { vibrate(_i, 0.5, 1e-6); }
END_TEST

/* A block on a slope of angle a, after a second: below the critical angle it creeps slower than sticking_speed,
   above it slides with g (sin a - mu cos a). */
static double slide(int which, double angle, double friction, double sticking, double seconds, double *acceleration) {
    gxs_solver *solver = solver_of(which);
    gxs_step_desc step = step_make(0.005, -9.81);
    gxs_plane plane = plane_make(1e6, friction);
    gxs_point *points;
    double p[3], speed[2] = {0, 0}, mass;
    const int frames = (int)(seconds / step.dt + 0.5);
    int frame;
    scene s = scene_block(3, 2, 1, 0.25, 0, 0);
    s.material->young = 1e7;
    s.material->damping = 2e-3;
    mass = mass_of(&s);
    plane.sticking_speed = sticking;
    plane.normal[0] = -sin(angle), plane.normal[2] = cos(angle);
    {
        size_t i; /* turned to lie on the slope */
        for (i = 0; i < s.model.copy_count; i++) {
            const double x = s.rest[3 * i], z = s.rest[3 * i + 2];
            s.displacement[3 * i] = cos(angle) * x - sin(angle) * z - x;
            s.displacement[3 * i + 2] = sin(angle) * x + cos(angle) * z - z - 1e-5;
        }
    }
    points = points_of(&s, 0, s.model.copy_count);
    step.points = points;
    step.point_count = s.model.copy_count;
    step.planes = &plane;
    step.plane_count = 1;
    step.newton_iterations = 10;
    step.newton_tolerance = 1e-8;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 1; frame <= frames; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        momentum(&s, p);
        if (frame == frames / 2) speed[0] = -(p[0] * cos(angle) + p[2] * sin(angle)) / mass;
    }
    speed[1] = -(p[0] * cos(angle) + p[2] * sin(angle)) / mass;
    *acceleration = (speed[1] - speed[0]) / ((frames - frames / 2) * step.dt);
    free(points);
    gxs_solver_destroy(solver);
    scene_free(&s);
    return speed[1];
}

START_TEST(friction_holds_and_slides) {
    const double friction = 0.5, critical = atan(0.5);
    double acceleration, speed, angle;
    speed = slide(_i, 0.8 * critical, friction, 0, 1, &acceleration);
    assert_that(speed >= 0 && speed < 1e-3, "%s: creeps at %g m/s", solver_name(_i), speed);
    speed = slide(_i, 0.95 * critical, friction, 0.01, 1, &acceleration);
    assert_that(speed > 1e-3 && speed < 0.01, "%s: creeps at %g m/s", solver_name(_i), speed);
    angle = 1.5 * critical;
    speed = slide(_i, angle, friction, 0, 0.6, &acceleration);
    assert_that(fabs(acceleration / (9.81 * (sin(angle) - friction * cos(angle))) - 1) < 0.02,
                "%s: accelerates by %g, not %g m/s2", solver_name(_i), acceleration,
                9.81 * (sin(angle) - friction * cos(angle)));
    speed = slide(_i, angle, 0, 0, 0.6, &acceleration);
    assert_that(fabs(acceleration / (9.81 * sin(angle)) - 1) < 0.005,
                "%s without friction: accelerates by %g, not %g m/s2", solver_name(_i), acceleration,
                9.81 * sin(angle));
}
END_TEST

/* A body falls, bounces, tumbles: kinetic + elastic + gravity's + contact's energy never grows. */
START_TEST(bounces_gain_no_energy) {
    gxs_solver *solver = solver_of(_i % SOLVERS);
    gxs_step_desc step = step_tight(0.01, -9.81);
    gxs_plane planes[2];
    gxs_point *points;
    double energy, first = 0, least, force[3], hit = 0;
    int frame;
    size_t i;
    scene s;
    seed((uint64_t)_i);
    s = scene_block(2, 2, 2, 0.25, 0.1, 0);
    s.material->young = 1e5;
    points = points_of(&s, 0, s.model.copy_count);
    planes[0] = plane_make(1e5, _i / SOLVERS ? 0.4 : 0);
    planes[1] = plane_make(1e5, _i / SOLVERS ? 0.4 : 0);
    planes[1].normal[2] = 0, planes[1].normal[0] = -1, planes[1].offset = -0.8;
    for (i = 0; i < s.model.copy_count; i++) {
        s.displacement[3 * i + 2] = 0.2;
        s.velocity[3 * i] = 1 + s.rest[3 * i + 2];
        s.velocity[3 * i + 2] = -s.rest[3 * i];
    }
    step.points = points;
    step.point_count = s.model.copy_count;
    step.planes = planes;
    step.plane_count = 2;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    first = least = total_energy(&s, step.gravity) + plane_forces(&step, s.displacement, s.displacement, force);
    for (frame = 0; frame < 120; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        energy = total_energy(&s, step.gravity) + plane_forces(&step, s.displacement, s.displacement, force);
        hit = fabs(force[0]) + force[2] > hit ? fabs(force[0]) + force[2] : hit;
        assert_that(energy <= least + 1e-9 * fabs(first), "frame %d: %.17g J after %.17g J", frame, energy, least);
        least = energy;
    }
    ck_assert(hit > 100);
    free(points);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* the plane's penalty by the caller */
static double penalty(void *user, size_t point, const double *position, double *force, double *hessian) {
    const gxs_plane *plane = (const gxs_plane *)user;
    const double *n = plane->normal, depth = plane_depth(plane, position);
    int r;
    (void)point;
    for (r = 0; r < 3; r++) force[r] = plane->stiffness * depth * n[r];
    if (hessian)
        for (r = 0; r < 6; r++)
            hessian[r] = depth > 0 ? plane->stiffness *
                                         n[r < 3   ? 0
                                           : r < 5 ? 1
                                                   : 2] *
                                         n[r < 3   ? r
                                           : r < 5 ? r - 2
                                                   : 2]
                                   : 0;
    return 0.5 * plane->stiffness * depth * depth;
}

START_TEST(contact_by_callback_is_the_plane) {
    double path[60][3 * 27];
    int run, frame;
    for (run = 0; run < 2; run++) {
        gxs_solver *solver = solver_of(_i);
        gxs_step_desc step = step_tight(0.01, -9.81);
        gxs_plane plane = plane_make(1e5, 0);
        gxs_point *points;
        size_t i;
        scene s;
        seed(4);
        s = scene_block(2, 2, 2, 0.25, 0.1, 0);
        points = points_of(&s, 0, s.model.copy_count);
        plane.normal[0] = 0.28, plane.normal[2] = 0.96;
        for (i = 0; i < s.model.copy_count; i++) s.velocity[3 * i + 2] = -2, s.displacement[3 * i + 2] = 0.1;
        step.points = points;
        step.point_count = s.model.copy_count;
        step.planes = &plane;
        step.plane_count = run == 0;
        step.contact = run == 1 ? penalty : NULL;
        step.contact_user = &plane;
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        for (frame = 0; frame < 60; frame++) {
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
            if (run == 0) memcpy(path[frame], s.displacement, sizeof path[frame]);
            assert_that(distance(path[frame], s.displacement, 3 * 27) < 1e-12, "%s frame %d: %g m apart",
                        solver_name(_i), frame, distance(path[frame], s.displacement, 3 * 27));
        }
        free(points);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* the same force wherever the point is */
static double constant_push(void *user, size_t point, const double *position, double *force, double *hessian) {
    const double *push = (const double *)user;
    (void)point;
    memcpy(force, push, 3 * sizeof *force);
    if (hessian) memset(hessian, 0, 6 * sizeof *hessian);
    return -(push[0] * position[0] + push[1] * position[1] + push[2] * position[2]);
}

/* A constant force by the callback, without stiffness, gives a loose block the momentum of force x dt on each point. */
START_TEST(constant_contact_forces_give_their_momentum) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_tight(0.01, 0);
    double push[3] = {1000, -300, 200}, p[3];
    gxs_point *points;
    int frame, r;
    scene s = scene_block(2, 2, 2, 0.25, 0, 0);
    points = points_of(&s, 0, s.model.copy_count);
    step.points = points;
    step.point_count = s.model.copy_count;
    step.contact = constant_push;
    step.contact_user = push;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 1; frame <= 3; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        momentum(&s, p);
        for (r = 0; r < 3; r++) {
            const double expected = frame * step.dt * push[r] * (double)step.point_count;
            assert_that(fabs(p[r] - expected) < 1e-6 * fabs(expected), "%s frame %d axis %d: %g kg m/s, not %g",
                        solver_name(_i), frame, r, p[r], expected);
        }
    }
    free(points);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Friction opposes a point's motion since the step's start by friction x the normal force at that time, also at
   points on held copies, which targets carry sideways (0) or lift (1). Forces on free copies balance, by the
   assembled forms. */
START_TEST(friction_acts_on_points_that_targets_carry) {
    const int lifted = _i % 2;
    gxs_solver *solver = solver_of(_i / 2);
    gxs_step_desc step = step_tight(0.01, 0);
    gxs_plane plane = plane_make(1000, 0.5);
    gxs_point points[6];
    double *work, *targets, *un, *y, *my, *g;
    size_t i, k, count;
    int frame, r;
    scene s = scene_block(1, 1, 1, 1, 0, 0);
    count = 3 * s.model.copy_count;
    work = (double *)zeroed(5 * count, sizeof *work);
    targets = work, un = work + count, y = work + 2 * count, my = work + 3 * count, g = work + 4 * count;
    s.material->young = 1e4;
    scene_hold_left(&s);
    for (i = 0; i < 6; i++) {
        const double weights[4] = {0.25, 0.25, 0.25, 0.25};
        points[i] = point_within(&s, i, weights);
    }
    plane.offset = 1.1; /* all points are below */
    step.points = points;
    step.point_count = 6;
    step.planes = &plane;
    step.plane_count = 1;
    step.targets = targets;
    for (i = 0; i < s.model.copy_count; i++) s.velocity[3 * i] = lifted && !s.held[i] ? 5 : 0;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 3; frame++) {
        double worst = 0, friction = 0, push[3];
        for (i = 0; i < s.model.copy_count; i++) targets[3 * i + (lifted ? 2 : 1)] = 0.05 * (frame + 1);
        memcpy(un, s.displacement, count * sizeof *un);
        for (i = 0; i < count; i++) y[i] = -s.displacement[i] - step.dt * s.velocity[i];
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        for (i = 0; i < count; i++) y[i] = (y[i] + s.displacement[i]) / (step.dt * step.dt);
        form_mass_product(&s.model, y, my);
        form_gradient(&s.model, s.displacement, g);
        for (i = 0; i < 6; i++) {
            gxs_step_desc one = step;
            one.points = &points[i];
            one.point_count = 1;
            plane_forces(&one, un, s.displacement, push);
            friction += sqrt(push[0] * push[0] + push[1] * push[1]);
            for (k = 0; k < 4; k++)
                for (r = 0; r < 3; r++) g[3 * points[i].copy[k] + (uint32_t)r] -= points[i].weight[k] * push[r];
        }
        for (i = 0; i < count; i++) worst = !s.held[i / 3] && fabs(my[i] + g[i]) > worst ? fabs(my[i] + g[i]) : worst;
        assert_that(friction > 100 && worst < 1e-5 * friction,
                    "%s %s frame %d: off balance by %g N beside a friction of %g N", solver_name(_i / 2),
                    lifted ? "lifted" : "carried", frame, worst, friction);
    }
    free(work);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* momentum of the copies from first to end */
static void part_momentum(const scene *s, size_t first, size_t end, double *p) {
    double *mv = (double *)zeroed(3 * s->model.copy_count, sizeof *mv);
    size_t i;
    mass_times(s, s->velocity, mv);
    p[0] = p[1] = p[2] = 0;
    for (i = 3 * first; i < 3 * end; i++) p[i % 3] += mv[i];
    free(mv);
}

/* Beside a block that bounces and one on a spring, a third one flies. Its momentum is right to rounding, at a CG
   tolerance of 1e-1. */
START_TEST(pieces_in_flight_keep_their_momentum) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0.01, -9.81);
    gxs_plane plane = plane_make(1e5, 0.5);
    gxs_point *points;
    gxs_spring spring;
    double before[3], after[3];
    size_t i, a, b, n;
    int frame, r, hits = 0;
    scene s, other;
    seed((uint64_t)_i);
    s = scene_block(2, 2, 2, 0.25, 0.1, 0);
    a = s.model.copy_count;
    other = scene_block(2, 2, 2, 0.25, 0.1, 0);
    scene_add(&s, &other, 2, 0, 3);
    b = s.model.copy_count;
    other = scene_block(2, 2, 2, 0.25, 0.1, 0);
    scene_add(&s, &other, 4, 0, 10);
    n = s.model.copy_count;
    points = points_of(&s, 0, n);
    spring = spring_make(point_at(&s, a + 3), 1e5);
    for (i = 0; i < 3 * n; i++) s.velocity[i] = 3 * uniform() - (i % 3 == 2 ? 2 : 0);
    step.points = points;
    step.point_count = n;
    step.planes = &plane;
    step.plane_count = 1;
    step.springs = &spring;
    step.spring_count = 1;
    step.cg_tolerance = 0.1;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 60; frame++) {
        double force[3];
        part_momentum(&s, b, n, before);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        part_momentum(&s, b, n, after);
        plane_forces(&step, s.displacement, s.displacement, force);
        hits += force[2] > 0;
        { /* its own mass, of jittered elements: from M 1 */
            double *ones = (double *)zeroed(6 * n, sizeof *ones), mass = 0;
            for (i = 0; i < 3 * n; i++) ones[i] = 1;
            mass_times(&s, ones, ones + 3 * n);
            for (i = b; i < n; i++) mass += ones[3 * n + 3 * i];
            for (r = 0; r < 3; r++)
                assert_that(fabs(after[r] - before[r] - step.dt * step.gravity[r] * mass) < 1e-10,
                            "%s frame %d axis %d: %g", solver_name(_i), frame, r,
                            after[r] - before[r] - step.dt * step.gravity[r] * mass);
            free(ones);
        }
    }
    ck_assert_int_gt(hits, 5);
    free(points);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- components: the gain of one must not be the loss of another ---- */

enum { PIECES = 4 };

/* A large block, stretched, that falls; three smaller ones, of 1/5 to 1/1000 of its edges, the last held or falling
   too. All their nodes are displaced by up to two edges and move. first: PIECES + 1 indices of copies */
static scene scene_of_pieces(uint64_t from, int held, size_t *first) {
    static const double edges[PIECES] = {0.25, 0.05, 0.01, 0.00025};
    size_t i;
    int p;
    scene s, other;
    seed(from);
    s = scene_block(4, 2, 2, edges[0], 0.1, 0);
    first[0] = 0;
    for (p = 1; p < PIECES; p++) {
        first[p] = s.model.copy_count;
        other = scene_block(2, 1, 1, edges[p], 0.1, 0);
        scene_add(&s, &other, 2.0 * p, 0, 0);
    }
    first[PIECES] = s.model.copy_count;
    for (i = 0; i < 3 * first[1]; i++) {
        s.displacement[i] = s.rest[i];
        s.velocity[i] = i % 3 == 2 ? -10 : 0;
    }
    for (p = 1; p < PIECES; p++)
        for (i = 3 * first[p]; i < 3 * first[p + 1]; i++) {
            s.held[i / 3] = held && p == PIECES - 1 && i / 3 < first[p] + 2;
            s.displacement[i] = s.held[i / 3] ? 0 : 2 * edges[p] * uniform();
            s.velocity[i] = s.held[i / 3] ? 0 : 100 * edges[p] * uniform() - (i % 3 == 2 ? 10 : 0);
        }
    return s;
}

/* x on copies first to end - 1, 0 elsewhere */
static void part_of(const double *x, size_t first, size_t end, size_t n, double *part) {
    memset(part, 0, 3 * n * sizeof *part);
    memcpy(part + 3 * first, x + 3 * first, 3 * (end - first) * sizeof *part);
}

/* E(u) of the copies first to end - 1, a component, that were at un with velocities vn */
static double part_potential(const scene *s, const gxs_step_desc *step, size_t first, size_t end, const double *un,
                             const double *vn, const double *u) {
    const size_t n = s->model.copy_count;
    double *part = (double *)zeroed(9 * n, sizeof *part), *way = part + 3 * n, *product = way + 3 * n, sum;
    size_t i;
    part_of(u, first, end, n, part);
    sum = form_energy(&s->model, part);
    for (i = 3 * first; i < 3 * end; i++) way[i] = u[i] - un[i] - step->dt * vn[i];
    mass_times(s, way, product);
    for (i = 3 * first; i < 3 * end; i++) sum += 0.5 * way[i] * product[i] / (step->dt * step->dt);
    for (i = 3 * first; i < 3 * end; i++) way[i] = step->gravity[i % 3];
    mass_times(s, way, product);
    for (i = 3 * first; i < 3 * end; i++) sum -= product[i] * u[i];
    free(part);
    return sum;
}

/* Where a component would be if it only stayed or, if it is loose, kept falling: u_n + t, t by its momentum and
   weight */
static void part_stay(const scene *s, const gxs_step_desc *step, size_t first, size_t end, const double *un,
                      const double *vn, double *u) {
    const size_t n = s->model.copy_count;
    double *ones = (double *)zeroed(6 * n, sizeof *ones), *lumped = ones + 3 * n, mass = 0, moved[3] = {0, 0, 0};
    size_t i;
    int loose = 1;
    for (i = 3 * first; i < 3 * end; i++) ones[i] = 1;
    mass_times(s, ones, lumped);
    for (i = 3 * first; i < 3 * end; i++) {
        mass += lumped[i] / 3;
        moved[i % 3] += lumped[i] * step->dt * vn[i];
        loose &= !s->held[i / 3];
    }
    for (i = 3 * first; i < 3 * end; i++)
        u[i] = un[i] + (loose ? moved[i % 3] / mass + step->gravity[i % 3] * step->dt * step->dt : 0);
    free(ones);
}

/* E of no component ends above its value had the component only kept falling, though others gain a million times
   that. */
START_TEST(energy_falls_in_every_piece) {
    gxs_solver *solver = solver_of(_i % SOLVERS);
    const gxs_step_desc step = step_make(0.033, -9.81);
    size_t first[PIECES + 1], n;
    double *un, *vn, *stay;
    int frame, p;
    scene s = scene_of_pieces((uint64_t)_i, _i % 2, first);
    n = s.model.copy_count;
    s.model.lumped_mass = _i / SOLVERS % 2 != 0;
    un = (double *)zeroed(9 * n, sizeof *un), vn = un + 3 * n, stay = vn + 3 * n;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 30; frame++) {
        memcpy(un, s.displacement, 3 * n * sizeof *un);
        memcpy(vn, s.velocity, 3 * n * sizeof *vn);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        for (p = 0; p < PIECES; p++) {
            double ends, stays;
            part_stay(&s, &step, first[p], first[p + 1], un, vn, stay);
            ends = part_potential(&s, &step, first[p], first[p + 1], un, vn, s.displacement);
            stays = part_potential(&s, &step, first[p], first[p + 1], un, vn, stay);
            /* E of the small component, which hangs turned by its hinge, is a sum of terms 1e6 times as large. The
               solver takes 5e-9 of these for rounding. */
            assert_that(ends <= stays + 1e-8 * (fabs(stays) + fabs(ends)), "%s frame %d piece %d: %.17g above %.17g",
                        solver_name(_i % SOLVERS), frame, p, ends, stays);
        }
    }
    free(un);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A step of several components is a step of each by itself: none goes less far, or further, for another's sake. To 2
   % (single precision, most of all of block-Jacobi), and 2e-4 of the distance that all go: linear systems are solved
   to a share of the residual of all. */
START_TEST(pieces_step_as_if_alone) {
    gxs_solver *solver = solver_of(_i % 4);
    gxs_step_desc step = step_make(0.033, -9.81);
    size_t first[PIECES + 1], n, i;
    double *start, all = 0;
    int p;
    scene s = scene_of_pieces((uint64_t)(100 + 17 * _i), 1, first);
    n = s.model.copy_count;
    step.cg_tolerance = 1e-6; /* as far as single precision goes */
    start = (double *)zeroed(12 * n, sizeof *start);
    memcpy(start, s.displacement, 3 * n * sizeof *start);
    memcpy(start + 3 * n, s.velocity, 3 * n * sizeof *start);
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    for (i = 0; i < 3 * n; i++) all += (s.displacement[i] - start[i]) * (s.displacement[i] - start[i]);
    for (p = 0; p < PIECES; p++) {
        double *u = start + 6 * n, *v = u + 3 * n, way = 0, off = 0;
        uint8_t *held = (uint8_t *)zeroed(n, 1);
        gxs_model alone = s.model;
        memset(v, 0, 3 * n * sizeof *v);
        memset(held, 1, n); /* the others stay at rest */
        part_of(start, first[p], first[p + 1], n, u);
        part_of(start + 3 * n, first[p], first[p + 1], n, v);
        memcpy(held + first[p], s.held + first[p], first[p + 1] - first[p]);
        alone.held = held;
        ck_assert_int_eq(advance(solver, &alone, &step, u, v, NULL, NULL), GX_OK);
        for (i = 3 * first[p]; i < 3 * first[p + 1]; i++) {
            way += (u[i] - start[i]) * (u[i] - start[i]);
            off += (u[i] - s.displacement[i]) * (u[i] - s.displacement[i]);
        }
        assert_that(off <= 4e-4 * way + 4e-8 * all, "%s piece %d: %g m off, having gone %g m", solver_name(_i % 4), p,
                    sqrt(off), sqrt(way));
        free(held);
    }
    free(start);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Points that lie in several components join them: E is no sum over these any more, but falls in them together. */
START_TEST(energy_falls_in_joined_pieces) {
    gxs_solver *solver = solver_make();
    size_t first[PIECES + 1], n;
    uint32_t k;
    double *u, energy = 0;
    scene s = scene_of_pieces((uint64_t)(200 + _i), 0, first);
    gxs_spring springs[2];
    gxs_step_desc step = step_make(0.033, 0);
    int p;
    n = s.model.copy_count;
    for (p = 0; p < 2; p++) { /* the first to the last component, and that one to the second */
        gxs_point point = point_at(&s, first[p] + 3);
        point.copy[3] = (uint32_t)first[2] + 5;
        point.weight[0] = point.weight[3] = 0.5;
        springs[p] = spring_make(point, 1e6);
        springs[p].target[0] += 0.5;
    }
    step.springs = springs;
    step.spring_count = 2;
    u = (double *)zeroed(6 * n, sizeof *u);
    for (k = 1; k <= 15; k++) {
        gxs_step_report report;
        memcpy(u, s.displacement, 3 * n * sizeof *u);
        memset(u + 3 * n, 0, 3 * n * sizeof *u);
        step.newton_iterations = k;
        ck_assert_int_eq(advance(solver, &s.model, &step, u, u + 3 * n, &report, NULL), GX_OK);
        assert_that(k == 1 || report.energy <= energy + 1e-12 * fabs(energy), "iterate %u: %.17g after %.17g",
                    (unsigned)k, report.energy, energy);
        energy = report.energy;
        if (report.newton_iterations < k) break;
    }
    free(u);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- statics ---- */

/* The balance of a hanging bar, of every material, is the end of damped motion. */
START_TEST(static_balance_is_the_end_of_motion) {
    const int kind = _i / SOLVERS, which = _i % SOLVERS;
    gxs_solver *solver = solver_of(which);
    gxs_step_desc step = step_tight(0, -9.81);
    gxs_step_report report;
    double end[3 * 64];
    size_t count;
    int run, frame;
    for (run = 0; run < 2; run++) {
        scene s;
        seed((uint64_t)_i);
        s = scene_block(4, 2, 2, 0.25, 0, 0);
        count = 3 * s.model.copy_count;
        ck_assert_uint_le(count, 3 * 64);
        scene_hold_left(&s);
        set_kind(s.material, kind);
        s.material->young = 3e5;
        s.material->damping = 0.1;
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        step.integrator = run ? GXS_STATIC : GXS_BDF1;
        step.dt = run ? 0 : 5;
        for (frame = 0; frame < (run ? 1 : 12); frame++)
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(report.residual < 1e-10, "%s: residual %g", solver_name(which), report.residual);
        if (run == 0)
            memcpy(end, s.displacement, count * sizeof(double));
        else {
            size_t i;
            assert_that(distance(end, s.displacement, count) < 1e-8, "%s: %g m apart", solver_name(which),
                        distance(end, s.displacement, count));
            ck_assert(s.displacement[count - 1] < -1e-3);
            for (i = 0; i < count; i++) ck_assert(s.velocity[i] == 0);
        }
        scene_free(&s);
    }
    gxs_solver_destroy(solver);
}
END_TEST

/* A balance through ties: a bar of three blocks; only the first is held */
START_TEST(static_balance_reaches_through_ties) {
    double end[3 * 320];
    uint32_t iterations = 0;
    int tied;
    for (tied = 0; tied < 2; tied++) {
        gxs_solver *solver = solver_of(_i);
        gxs_step_desc step = step_tight(0, -9.81);
        gxs_step_report report;
        gxs_constraint *ties = NULL;
        size_t count;
        scene s = scene_block(12, 4, 4, 0.25, 0, 0);
        count = 3 * s.model.copy_count;
        ck_assert_uint_lt(count, 3 * 330);
        count = count < 3 * 320 ? count : 3 * 320;
        s.material->young = 1e7;
        if (tied) ties = scene_split(&s, 1);
        scene_hold_left(&s);
        step.integrator = GXS_STATIC;
        step.newton_tolerance = 1e-9;
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(report.residual < 1e-9, "%s%s: residual %g after %u Newton, %u CG iterations", solver_name(_i),
                    tied ? ", tied" : "", report.residual, (unsigned)report.newton_iterations,
                    (unsigned)report.cg_iterations);
        if (tied) {
            assert_that(distance(end, s.displacement, count) < 1e-7, "%s: %g m apart", solver_name(_i),
                        distance(end, s.displacement, count));
            assert_that(report.cg_iterations <= 4 * iterations, "%s: %u CG iterations, %u without ties",
                        solver_name(_i), (unsigned)report.cg_iterations, (unsigned)iterations);
        }
        iterations = report.cg_iterations;
        memcpy(end, s.displacement, count * sizeof(double));
        free(ties);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* A held block and a loose one: an error that names a copy of the loose one. A spring or a time step gives it a
   balance. */
START_TEST(static_balance_needs_a_hold) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_tight(0, -9.81);
    gxs_spring spring;
    gx_failure failure;
    gxs_step_report report;
    double *before;
    size_t i, first, count;
    scene s, other = scene_block(2, 2, 2, 0.25, 0, 0);
    seed((uint64_t)_i);
    s = scene_block(2, 2, 2, 0.25, 0, 0);
    first = s.model.copy_count;
    scene_hold_left(&s);
    scene_add(&s, &other, 2, 0, 0);
    count = 3 * s.model.copy_count;
    before = (double *)zeroed(2 * count, sizeof *before);
    for (i = 0; i < count; i++) {
        before[i] = s.displacement[i] = s.held[i / 3] ? 0 : 0.01 * uniform();
        before[count + i] = s.velocity[i] = uniform();
    }
    step.integrator = GXS_STATIC;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, &failure), GX_ERROR_FREE);
    ck_assert_int_eq(failure.result, GX_ERROR_FREE);
    assert_that(failure.index >= first && failure.index < s.model.copy_count, "copy %lu", (unsigned long)failure.index);
    ck_assert(memcmp(before, s.displacement, count * sizeof(double)) == 0 &&
              memcmp(before + count, s.velocity, count * sizeof(double)) == 0);
    spring = spring_make(point_at(&s, failure.index), 0); /* a spring of no stiffness holds nothing */
    step.springs = &spring;
    step.spring_count = 1;
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, &failure), GX_ERROR_FREE);
    spring = spring_make(point_at(&s, 1), 1e5); /* of the other component */
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, &failure), GX_ERROR_FREE);
    ck_assert(memcmp(before, s.displacement, count * sizeof(double)) == 0 &&
              memcmp(before + count, s.velocity, count * sizeof(double)) == 0);
    step.dt = 1;
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    assert_that(report.residual < 1e-10, "residual %g", report.residual);
    for (i = 0; i < count; i++) ck_assert(s.velocity[i] == 0);
    step.dt = 0;
    spring = spring_make(point_at(&s, s.model.copy_count - 1), 1e5); /* by a corner: it swings until it hangs */
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    check_finite(&s);
    step.spring_count = 0; /* that it was held once does not count */
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, &failure), GX_ERROR_FREE);
    free(before);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A tangled bar: E never rises from iterate to iterate, and the end is a balance. */
START_TEST(static_balance_is_found_from_afar) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0, -9.81);
    double energy = 0;
    size_t i;
    int frame;
    scene s;
    gxs_step_report report;
    seed((uint64_t)_i);
    s = scene_block(4, 2, 2, 0.25, 0, 0);
    scene_hold_left(&s);
    for (i = 0; i < 3 * s.model.copy_count; i++) s.displacement[i] = s.held[i / 3] ? 0 : 0.25 * uniform();
    step.integrator = GXS_STATIC;
    step.newton_tolerance = 1e-12;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 200; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(frame == 0 || report.energy <= energy + 1e-12 * fabs(energy), "frame %d: %.17g J after %.17g J",
                    frame, report.energy, energy);
        energy = report.energy;
    }
    assert_that(report.residual < 1e-10, "%s: residual %g", solver_name(_i), report.residual);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- stiffness damping ---- */

/* Longitudinal free vibration of a bar held at its left, in its first mode, by the midpoint rule: its energy after
   some periods. frequency: by its zero crossings, rad/s */
static double ring(int kind, double damping, double *frequency) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_tight(1.25e-4, 0); /* 1/320 of the period, which is 4 L sqrt(rho / E) */
    const double zero[3] = {0, 0, 0};
    double first, last = 0, amplitude = 0, crossing[2] = {0, 0};
    size_t i, crossings = 0;
    int frame;
    scene s = scene_block(8, 1, 1, 0.125, 0, 0);
    set_kind(s.material, kind);
    s.material->young = 1e7;
    s.material->poisson = 0;
    s.material->damping = damping;
    scene_hold_left(&s);
    for (i = 0; i < s.model.copy_count; i++) s.displacement[3 * i] = 1e-5 * sin(2 * atan(1.0) * s.rest[3 * i]);
    step.integrator = GXS_MIDPOINT;
    step.newton_tolerance = 1e-9;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    first = total_energy(&s, zero);
    for (frame = 1; frame <= 960; frame++) {
        double before = amplitude;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        amplitude = s.displacement[3 * s.model.copy_count - 3];
        if (before > 0 && amplitude <= 0) crossing[crossings++ > 0] = frame - amplitude / (amplitude - before);
        last = total_energy(&s, zero);
    }
    *frequency = 8 * atan(1.0) * (double)(crossings - 1) / ((crossing[1] - crossing[0]) * step.dt);
    gxs_solver_destroy(solver);
    scene_free(&s);
    return -log(last / first) / (960 * step.dt); /* of the energy, 1/s: twice that of the amplitude */
}

/* E falls by exp(-beta omega^2 t): a damping ratio of beta omega / 2 */
START_TEST(modes_decay_by_stiffness_damping) {
    double omega, damped, rate;
    rate = ring(_i, 0, &omega);
    assert_that(fabs(rate) < 1e-3, "undamped: %g 1/s", rate);
    assert_that(fabs(omega / (2 * atan(1.0) * 100) - 1) < 0.02, "omega %g", omega); /* pi/2 sqrt(E / rho) / L */
    rate = ring(_i, 2 * 0.03 / omega, &damped);                                     /* 3 % of critical */
    assert_that(fabs(rate / (2 * 0.03 * omega) - 1) < 0.02, "rate %g for %g", rate, 2 * 0.03 * omega);
}
END_TEST

START_TEST(damping_keeps_momentum) {
    static const gxs_integrator integrators[3] = {GXS_BDF1, GXS_BDF2, GXS_MIDPOINT};
    const int kind = _i / 3;
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.005, 0);
    double before[3], after[3], *previous[2], *now[2];
    size_t i, count;
    int frame, r;
    scene s;
    seed((uint64_t)_i);
    s = scene_block(3, 2, 2, 0.25, 0.1, 0);
    count = 3 * s.model.copy_count;
    set_kind(s.material, kind);
    s.material->damping = 0.02;
    for (i = 0; i < 2; i++)
        previous[i] = (double *)zeroed(count, sizeof(double)), now[i] = (double *)zeroed(count, sizeof(double));
    for (i = 0; i < count; i++) s.velocity[i] = 1 + uniform();
    step.integrator = integrators[_i % 3];
    step.cg_tolerance = 0.1;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    momentum(&s, before);
    for (frame = 0; frame < 20; frame++) {
        memcpy(now[0], s.displacement, count * sizeof(double));
        memcpy(now[1], s.velocity, count * sizeof(double));
        if (frame > 0)
            step.previous_displacement = previous[0], step.previous_velocity = previous[1], step.previous_dt = step.dt;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        memcpy(previous[0], now[0], count * sizeof(double));
        memcpy(previous[1], now[1], count * sizeof(double));
        momentum(&s, after);
        for (r = 0; r < 3; r++)
            assert_that(fabs(after[r] - before[r]) < 1e-10 * fabs(before[r]), "frame %d: %g of %g", frame,
                        after[r] - before[r], before[r]);
    }
    for (i = 0; i < 2; i++) free(previous[i]), free(now[i]);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Stiffness damping adds no noise: a hanging bar comes to rest to (almost) all digits. */
START_TEST(damped_bodies_come_to_rest) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_tight(0.02, -9.81);
    double speed = 0;
    size_t i;
    int frame;
    scene s = scene_block(3, 1, 1, 0.25, 0, 0);
    scene_hold_left(&s);
    set_kind(s.material, _i);
    s.material->damping = 0.02;
    step.mass_damping = 5;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 300; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    for (i = 0; i < 3 * s.model.copy_count; i++) speed = fabs(s.velocity[i]) > speed ? fabs(s.velocity[i]) : speed;
    assert_that(speed < 1e-12, "still at %g m/s", speed);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* The shares of a body's angular momentum and energy left after a revolution; it starts without stress */
static void revolve(int kind, double spin, double damping, double *left) {
    const double zero[3] = {0, 0, 0};
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_tight(0.0075 / spin, 0);
    double first[3], last[3], energy;
    size_t i;
    int frame;
    scene s = scene_block(4, 2, 2, 0.25, 0, 0);
    set_kind(s.material, kind);
    /* so that a step of the midpoint rule stretches little, compared with the rest */
    s.material->young = spin < 1 ? 1e4 : 1e6;
    s.material->damping = damping;
    for (i = 0; i < s.model.copy_count; i++) {
        s.velocity[3 * i] = -spin * (s.rest[3 * i + 1] - 0.25);
        s.velocity[3 * i + 1] = spin * (s.rest[3 * i] - 0.5);
    }
    step.integrator = GXS_MIDPOINT;
    step.newton_tolerance = 1e-9;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    angular_momentum(&s, first);
    energy = total_energy(&s, zero);
    for (frame = 0; frame < 838; frame++) /* 2 pi / 0.0075 */
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    angular_momentum(&s, last);
    left[0] = last[2] / first[2];
    left[1] = total_energy(&s, zero) / energy;
    gxs_solver_destroy(solver);
    scene_free(&s);
}

/* At 0.05/s, next to no stress, and at 3/s, where the body is stretched by 1e-3: stiffness damping changes neither. */
START_TEST(rotation_is_not_damped) {
    const double spin = _i % 2 ? 3 : 0.05;
    double free_of_it[2], damped[2];
    revolve(_i / 2, spin, 0, free_of_it);
    revolve(_i / 2, spin, 1e-3, damped);
    assert_that(fabs(free_of_it[0] - 1) < 1e-6 && fabs(free_of_it[1] - 1) < 5e-3,
                "undamped: angular momentum %.9g, energy %.9g of it left", free_of_it[0], free_of_it[1]);
    assert_that(fabs(damped[0] - 1) < 1e-3 && fabs(damped[1] - 1) < 5e-3,
                "damped: angular momentum %.9g, energy %.9g of it left", damped[0], damped[1]);
}
END_TEST

/* ---- the midpoint rule ---- */

/* A thin plate falls into its hold and swings. Nothing damps the errors of one Newton iteration and a coarse solve,
   and they would add up without end. The body must never have more energy than it began with. */
START_TEST(midpoint_gains_no_energy) {
    static const double gravity[3] = {0, 0, -9.81}, dts[2] = {0.001, 0.004};
    gxs_solver *solver = solver_of(_i / 2);
    gxs_step_desc step = step_make(dts[_i % 2], -9.81);
    double begin, most = 0, fall = 0;
    int frame;
    scene s = scene_block(12, 4, 1, 0.02, 0, 0);
    s.material->young = 1e6;
    scene_hold_left(&s);
    step.integrator = GXS_MIDPOINT;
    step.cg_tolerance = 0.05;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    begin = total_energy(&s, gravity);
    for (frame = 0; frame < 1200; frame++) {
        double energy;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        energy = total_energy(&s, gravity) - begin;
        most = energy > most ? energy : most;
        fall = fmin(fall, s.displacement[3 * s.model.copy_count - 1]);
    }
    assert_that(fall < -0.03 && most < -0.02 * gravity[2] * mass_of(&s) * -fall, "%g J gained, %g m fallen", most,
                fall);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* The point of a callback: the plane of a scene, by its caller */
static double energy_at_plane(const scene *s, const gxs_step_desc *step, const gxs_plane *plane,
                              const double *gravity) {
    double sum = total_energy(s, gravity);
    size_t i;
    int k;
    for (i = 0; i < step->point_count; i++) {
        double x[3];
        for (k = 0; k < 3; k++)
            x[k] = step->points[i].position[k] + s->displacement[3 * step->points[i].copy[0] + (size_t)k];
        sum += 0.5 * plane->stiffness * plane_depth(plane, x) * plane_depth(plane, x);
    }
    return sum;
}

/* A free block meets a plane, given as a plane or by a callback, anywhere within a step, also after its middle. The
   step gains no more than 1 % of the kinetic energy, however stiff the plane is. A block in flight beside it
   continues as it was. */
START_TEST(midpoint_gains_nothing_where_contact_begins) {
    static const double gravity[3] = {0, 0, 0}, stiffness[3] = {1e5, 1e7, 1e9};
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_tight(0.03, 0);
    gxs_plane plane = plane_make(stiffness[_i % 3], 0);
    gxs_point *points;
    double energy, hit = 0, first[3];
    int frame;
    size_t i, n;
    scene s = scene_block(1, 1, 1, 1, 0, 0), other = scene_block(1, 1, 1, 1, 0, 0);
    n = s.model.copy_count;
    scene_add(&s, &other, 3, 0, 0);
    s.material->young = 1e6;
    plane.offset = -0.02 * (1 + _i / 6);
    for (i = 0; i < s.model.copy_count; i++) s.velocity[3 * i + 2] = -5;
    points = points_of(&s, 0, n);
    step.integrator = GXS_MIDPOINT;
    step.points = points;
    step.point_count = n;
    step.planes = &plane;
    step.plane_count = _i / 3 % 2 ? 0 : 1;
    step.contact = _i / 3 % 2 ? penalty : NULL;
    step.contact_user = &plane;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    energy = energy_at_plane(&s, &step, &plane, gravity);
    memcpy(first, s.velocity + 3 * n, sizeof first);
    for (frame = 0; frame < 8; frame++) {
        const double before = energy;
        double *y = (double *)zeroed(3 * s.model.copy_count, sizeof *y), kinetic;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        mass_times(&s, s.velocity, y);
        for (i = 0, kinetic = 0; i < 3 * s.model.copy_count; i++) kinetic += 0.5 * y[i] * s.velocity[i];
        energy = energy_at_plane(&s, &step, &plane, gravity);
        hit = fmax(hit, energy - total_energy(&s, gravity));
        assert_that(energy <= before + 0.0101 * kinetic, "frame %d: %g J after %g J, of %g J kinetic", frame, energy,
                    before, kinetic);
        assert_that(fabs(s.velocity[3 * n + 2] - first[2]) < 1e-9, "frame %d: what flies has %g m/s", frame,
                    s.velocity[3 * n + 2]);
        free(y);
    }
    ck_assert(hit > 0);
    free(points);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- sleep ---- */

/* Two blocks: a bar that hangs from copies that targets hold, and a slab that lies on a plane. */
typedef struct bedroom {
    scene s;
    gxs_solver *solver;
    gxs_step_desc step;
    gxs_step_report report;
    gxs_plane plane;
    gxs_spring spring;
    gxs_point *points;
    double *rest_times, *targets;
    size_t first[3]; /* copies of either block, and the end */
} bedroom;

static void bedroom_make(bedroom *room, int which) {
    scene slab = scene_block(2, 2, 1, 0.25, 0, 0);
    size_t i, n;
    memset(room, 0, sizeof *room);
    room->s = scene_block(3, 1, 1, 0.25, 0, 0);
    room->first[1] = room->s.model.copy_count;
    scene_hold_left(&room->s);
    for (i = 0; i < room->first[1]; i++) /* above the plane */
        room->s.rest[3 * i + 2] += 2;
    scene_add(&room->s, &slab, 3, 0, 0);
    room->first[2] = n = room->s.model.copy_count;
    room->s.material->damping = 0.02;
    room->solver = solver_of(which);
    room->step = step_make(0.02, -9.81);
    room->step.mass_damping = 5;
    room->plane = plane_make(1e5, 0.5);
    room->points = points_of(&room->s, 0, n);
    room->step.points = room->points;
    room->step.point_count = n;
    room->step.planes = &room->plane;
    room->step.plane_count = 1;
    room->rest_times = (double *)zeroed(n, sizeof(double));
    room->targets = (double *)zeroed(3 * n, sizeof(double));
    room->step.targets = room->targets;
    room->step.forces = room->s.forces;
    room->step.sleep_speed = 1e-5;
    room->step.sleep_time = 0.1;
    room->step.rest_times = room->rest_times;
    ck_assert_int_eq(gxs_solver_set_model(room->solver, &room->s.model, NULL), GX_OK);
}

static void bedroom_free(bedroom *room) {
    free(room->points);
    free(room->rest_times);
    free(room->targets);
    gxs_solver_destroy(room->solver);
    scene_free(&room->s);
}

static void bedroom_step(bedroom *room) {
    ck_assert_int_eq(
        gxs_solver_step(room->solver, &room->step, room->s.displacement, room->s.velocity, &room->report, NULL), GX_OK);
}

static void settle(bedroom *room) {
    int frame;
    double speed = 0;
    size_t i;
    for (frame = 0; frame < 2000; frame++) {
        bedroom_step(room);
        if (room->report.active_unknowns == 0) return;
    }
    for (i = 0; i < 3 * room->first[2]; i++)
        speed = fabs(room->s.velocity[i]) > speed ? fabs(room->s.velocity[i]) : speed;
    assert_that(0, "not asleep after 2000 steps: %lu unknowns, %g m/s", (unsigned long)room->report.active_unknowns,
                speed);
}

/* unknowns of a block when it is awake */
static size_t unknowns_of(const bedroom *room, int block) {
    size_t i, count = 0;
    for (i = room->first[block]; i < room->first[block + 1]; i++) count += room->s.held[i] ? 0 : 3;
    return count;
}

/* The operator has what sleeps, too. */
static void check_operator(bedroom *room) {
    const size_t n = 3 * room->s.model.copy_count;
    double *x = (double *)zeroed(n, sizeof *x), *y = (double *)zeroed(n, sizeof *y),
           *expected = (double *)zeroed(n, sizeof *y), most = 0;
    size_t i;
    for (i = 0; i < n; i++) x[i] = room->s.held[i / 3] ? 0 : uniform();
    ck_assert_int_eq(gxs_solver_linearise(room->solver, room->s.displacement, 0, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(room->solver, x, y, NULL), GX_OK);
    form_hessian_product(&room->s.model, room->s.displacement, x, expected);
    for (i = 0; i < n; i++) most = fabs(expected[i]) > most ? fabs(expected[i]) : most;
    for (i = 0; i < n; i++)
        assert_that(fabs(y[i] - (room->s.held[i / 3] ? 0 : expected[i])) < 4e-6 * most, "%g %g", y[i], expected[i]);
    free(x), free(y), free(expected);
}

START_TEST(settled_blocks_sleep) {
    bedroom room;
    double *bits;
    size_t i, n;
    int frame;
    bedroom_make(&room, _i);
    n = room.first[2];
    bits = (double *)zeroed(3 * n, sizeof *bits);
    bedroom_step(&room);
    ck_assert_uint_eq(room.report.active_unknowns, unknowns_of(&room, 0) + unknowns_of(&room, 1));
    settle(&room);
    ck_assert_int_eq(room.report.stop, GXS_STOP_ASLEEP);
    ck_assert_uint_eq(room.report.newton_iterations, 0);
    memcpy(bits, room.s.displacement, 3 * n * sizeof *bits);
    for (frame = 0; frame < 20; frame++) {
        for (i = 0; i < 3 * n; i++) ck_assert(room.s.velocity[i] == 0);
        ck_assert(memcmp(bits, room.s.displacement, 3 * n * sizeof *bits) == 0);
        if (frame == 5) room.step.dt = 0.01;
        if (frame == 7) check_operator(&room);
        if (frame == 10) room.step.integrator = GXS_MIDPOINT;
        bedroom_step(&room);
        ck_assert_uint_eq(room.report.active_unknowns, 0);
        ck_assert_int_eq(room.report.stop, GXS_STOP_ASLEEP);
    }
    ck_assert(bits[3 * room.first[1] - 1] < -1e-5 && bits[3 * n - 1] < -1e-5); /* they hang and lie */
    free(bits);
    bedroom_free(&room);
}
END_TEST

enum { TOUCH_FORCE, TOUCH_VELOCITY, TOUCH_DISPLACEMENT, TOUCH_SPRING, TOUCH_REST_TIMES, TOUCH_TARGET, TOUCH_COUNT };

static void touch(bedroom *room, int how, size_t copy) {
    switch (how) {
    case TOUCH_FORCE: room->s.forces[3 * copy] += 1; break;
    case TOUCH_VELOCITY: room->s.velocity[3 * copy + 1] = 1e-9; break;
    case TOUCH_DISPLACEMENT: room->s.displacement[3 * copy + 1] += 1e-9; break;
    case TOUCH_REST_TIMES: room->rest_times[copy] = 0; break;
    case TOUCH_TARGET: room->targets[1] += 1e-6; break; /* of copy 0, which is held */
    default:
        room->spring = spring_make(point_at(&room->s, copy), 1e3);
        room->step.springs = &room->spring;
        room->step.spring_count = 1;
    }
}

/* Touching a block wakes it and no other. */
START_TEST(a_touch_wakes_one_block) {
    static const char *const names[TOUCH_COUNT] = {"force",  "velocity",  "displacement",
                                                   "spring", "rest time", "target"};
    bedroom room;
    double *bits;
    int how, block, frame;
    bedroom_make(&room, _i);
    bits = (double *)zeroed(3 * room.first[2], sizeof *bits);
    settle(&room);
    for (how = 0; how < TOUCH_COUNT; how++)
        for (block = 0; block < (how == TOUCH_TARGET ? 1 : 2); block++) {
            const int other = 1 - block;
            const size_t from = 3 * room.first[other], count = 3 * (room.first[other + 1] - room.first[other]);
            memcpy(bits, room.s.displacement, 3 * room.first[2] * sizeof *bits);
            touch(&room, how, room.first[block + 1] - 1);
            for (frame = 0; frame < 3; frame++) {
                size_t i;
                bedroom_step(&room);
                assert_that(room.report.active_unknowns == unknowns_of(&room, block),
                            "%s: a %s at block %d: %lu unknowns in frame %d, not %lu", solver_name(_i), names[how],
                            block, (unsigned long)room.report.active_unknowns, frame,
                            (unsigned long)unknowns_of(&room, block));
                ck_assert(memcmp(bits + from, room.s.displacement + from, count * sizeof *bits) == 0);
                for (i = 0; i < count; i++) ck_assert(room.s.velocity[from + i] == 0);
                room.step.spring_count = 0;
            }
            settle(&room);
        }
    free(bits);
    bedroom_free(&room);
}
END_TEST

/* NULL forces are no forces. When they come or go, only the copies on which they act are touched. */
START_TEST(forces_that_come_and_go_wake_one_block) {
    bedroom room;
    bedroom_make(&room, _i);
    room.step.forces = NULL;
    settle(&room);
    room.step.forces = room.s.forces;
    room.s.forces[3 * room.first[2] - 1] = -1;
    bedroom_step(&room);
    assert_that(room.report.active_unknowns == unknowns_of(&room, 1), "%lu unknowns awake when forces come, not %lu",
                (unsigned long)room.report.active_unknowns, (unsigned long)unknowns_of(&room, 1));
    settle(&room);
    room.step.forces = NULL;
    bedroom_step(&room);
    assert_that(room.report.active_unknowns == unknowns_of(&room, 1), "%lu unknowns awake when forces go, not %lu",
                (unsigned long)room.report.active_unknowns, (unsigned long)unknowns_of(&room, 1));
    bedroom_free(&room);
}
END_TEST

/* gravity, and every number of a plane */
START_TEST(changes_of_the_scene_wake_all) {
    bedroom room;
    int how;
    gxs_plane *plane = &room.plane, planes[2];
    bedroom_make(&room, _i);
    for (how = 0; how < 8; how++) {
        settle(&room);
        switch (how) {
        case 0: room.step.gravity[2] = -9; break;
        case 1: room.step.gravity[0] = 1e-3; break;
        case 2: plane->offset += 1e-4; break;
        case 3: plane->stiffness *= 1.1; break;
        case 4: plane->friction = 0.6; break;
        case 5: plane->sticking_speed = 2e-3; break;
        case 6: plane->normal[0] = 1e-4, plane->normal[2] = sqrt(1 - 1e-8); break;
        default:
            planes[0] = planes[1] = *plane;
            planes[1].offset = -10;
            room.step.planes = planes;
            room.step.plane_count = 2;
        }
        bedroom_step(&room);
        assert_that(room.report.active_unknowns == unknowns_of(&room, 0) + unknowns_of(&room, 1),
                    "change %d: %lu unknowns awake", how, (unsigned long)room.report.active_unknowns);
        bedroom_step(&room); /* and they stay awake for sleep_time */
        ck_assert_uint_eq(room.report.active_unknowns, unknowns_of(&room, 0) + unknowns_of(&room, 1));
    }
    bedroom_free(&room);
}
END_TEST

/* A step that fails changes nothing. So a change that it has seen still wakes in the next step. */
START_TEST(a_failed_step_swallows_no_touch) {
    bedroom room;
    int how;
    bedroom_make(&room, 0);
    for (how = 0; how < 4; how++) {
        const size_t last = 3 * room.first[2] - 1;
        settle(&room);
        switch (how) {
        case 0: room.step.gravity[2] = -9; break;
        case 1: room.plane.offset = 1e-4; break;
        case 2: room.s.forces[last] = -1; break;
        default: room.rest_times[last / 3] = 0;
        }
        room.s.velocity[3 * room.first[1] - 1] = 1e200;
        ck_assert_int_eq(gxs_solver_step(room.solver, &room.step, room.s.displacement, room.s.velocity, NULL, NULL),
                         GX_ERROR_DIVERGED);
        room.s.velocity[3 * room.first[1] - 1] = 0;
        bedroom_step(&room);
        assert_that(room.report.active_unknowns >= unknowns_of(&room, 1),
                    "change %d: %lu unknowns awake after a failed step", how,
                    (unsigned long)room.report.active_unknowns);
    }
    bedroom_free(&room);
}
END_TEST

/* A velocity below sleep_speed that is written to a sleeper moves it, also if a failing step comes before the one
   that succeeds. */
START_TEST(a_failed_step_swallows_no_slow_kick) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0.01, 0);
    gxs_step_report report;
    double *rest_times;
    size_t i, n;
    int frame;
    scene s = scene_block(1, 1, 1, 0.25, 0, 0);
    n = s.model.copy_count;
    rest_times = (double *)zeroed(n, sizeof *rest_times);
    step.sleep_speed = 1e-2;
    step.rest_times = rest_times;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 100; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 0);
    for (i = 0; i < n; i++) s.velocity[3 * i] = 5e-3;
    step.integrator = GXS_STATIC;
    step.dt = 0;
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_ERROR_FREE);
    step.integrator = GXS_BDF1;
    step.dt = 0.01;
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 3 * n);
    for (i = 0; i < n; i++)
        assert_that(fabs(s.displacement[3 * i] - 5e-5) < 1e-9 && fabs(s.velocity[3 * i] - 5e-3) < 1e-7,
                    "copy %lu at %g with %g m/s", (unsigned long)i, s.displacement[3 * i], s.velocity[3 * i]);
    free(rest_times);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* The same push moves a sleeping block as it moves one that was at rest awake. */
START_TEST(a_woken_block_moves_as_before) {
    double path[40][3 * 64];
    int sleeps, frame;
    for (sleeps = 0; sleeps < 2; sleeps++) {
        bedroom room;
        bedroom_make(&room, _i);
        room.step.newton_iterations = 20;
        room.step.newton_tolerance = 1e-11;
        room.step.cg_tolerance = 1e-4;
        room.step.sleep_speed = sleeps ? 1e-9 : 0;
        for (frame = 0; frame < 400; frame++) bedroom_step(&room);
        assert_that(!sleeps || room.report.active_unknowns == 0, "%lu unknowns awake, ends at %g and %g m/s",
                    (unsigned long)room.report.active_unknowns, room.s.velocity[3 * room.first[1] - 1],
                    room.s.velocity[3 * room.first[2] - 1]);
        room.s.forces[3 * room.first[1] - 1] = 300;
        room.s.forces[3 * room.first[2] - 3] = -300;
        for (frame = 0; frame < 40; frame++) {
            bedroom_step(&room);
            if (!sleeps) memcpy(path[frame], room.s.displacement, 3 * room.first[2] * sizeof(double));
            assert_that(distance(path[frame], room.s.displacement, 3 * room.first[2]) < 1e-7, "frame %d: %g m apart",
                        frame, distance(path[frame], room.s.displacement, 3 * room.first[2]));
        }
        bedroom_free(&room);
    }
}
END_TEST

/* Without gravity a body at rest in mid-air sleeps in its place, beside one that keeps flying awake. */
START_TEST(bodies_sleep_in_mid_air) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0.02, 0);
    gxs_step_report report;
    double *rest_times;
    size_t i, first, n;
    int frame;
    scene s = scene_block(2, 2, 2, 0.25, 0, 0), other = scene_block(2, 2, 2, 0.25, 0, 0);
    first = s.model.copy_count;
    scene_add(&s, &other, 2, 0, 0);
    n = s.model.copy_count;
    rest_times = (double *)zeroed(n, sizeof *rest_times);
    for (i = first; i < n; i++) s.velocity[3 * i] = 1;
    step.sleep_speed = 1e-3; /* sleep_time 0: half a second */
    step.rest_times = rest_times;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 1; frame <= 60; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(frame < 25   ? report.active_unknowns == 3 * n
                    : frame > 28 ? report.active_unknowns == 3 * (n - first)
                                 : 1,
                    "frame %d: %lu unknowns", frame, (unsigned long)report.active_unknowns);
    }
    for (i = 0; i < 3 * n; i++)
        assert_that(fabs(s.displacement[i] - (i >= 3 * first && i % 3 == 0 ? 1.2 : 0)) < 1e-9 &&
                        fabs(s.velocity[i] - (i >= 3 * first && i % 3 == 0 ? 1 : 0)) < 1e-9,
                    "%g %g", s.displacement[i], s.velocity[i]);
    free(rest_times);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* With the caller's rest times sleep continues over a new model of the same copies; zeroed rest times wake. */
START_TEST(sleep_outlasts_a_new_model) {
    bedroom room;
    double *bits;
    size_t i, n;
    bedroom_make(&room, _i / 2);
    n = room.first[2];
    if (_i % 2) room.step.forces = NULL;
    bits = (double *)zeroed(3 * n, sizeof *bits);
    settle(&room);
    memcpy(bits, room.s.displacement, 3 * n * sizeof *bits);
    ck_assert_int_eq(gxs_solver_set_model(room.solver, &room.s.model, NULL), GX_OK);
    bedroom_step(&room);
    assert_that(room.report.active_unknowns == 0, "%s: %lu unknowns awake after a new model",
                _i % 2 ? "no forces" : "forces", (unsigned long)room.report.active_unknowns);
    bedroom_step(&room);
    ck_assert_uint_eq(room.report.active_unknowns, 0);
    ck_assert(memcmp(bits, room.s.displacement, 3 * n * sizeof *bits) == 0);
    ck_assert_int_eq(gxs_solver_set_model(room.solver, &room.s.model, NULL), GX_OK);
    for (i = room.first[1]; i < n; i++) /* as after a cut of the slab */
        room.rest_times[i] = 0;
    bedroom_step(&room);
    ck_assert_uint_eq(room.report.active_unknowns, unknowns_of(&room, 1));
    free(bits);
    bedroom_free(&room);
}
END_TEST

/* Springs that do not change let a block sleep; one that does wakes it. */
START_TEST(blocks_on_constant_springs_sleep) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0.02, -9.81);
    gxs_step_report report;
    gxs_spring springs[3];
    double *rest_times;
    int frame, k;
    size_t n;
    scene s = scene_block(2, 2, 1, 0.25, 0, 0);
    n = s.model.copy_count;
    rest_times = (double *)zeroed(n, sizeof *rest_times);
    for (k = 0; k < 3; k++) springs[k] = spring_make(point_at(&s, k == 0 ? 0 : k == 1 ? 2 : 7), 1e5);
    step.mass_damping = 5;
    step.sleep_speed = 1e-5;
    step.sleep_time = 0.1;
    step.rest_times = rest_times;
    step.springs = springs;
    step.spring_count = 3;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 1000; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        if (report.active_unknowns == 0) break;
    }
    assert_that(report.active_unknowns == 0, "awake on springs after 20 s at %g m/s", s.velocity[3 * n - 1]);
    for (k = 0; k < 3; k++) {
        springs[k].target[k] += 1e-4;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert_uint_eq(report.active_unknowns, 3 * n);
    }
    free(rest_times);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A block that contact held is awake when its points are gone, and falls. */
START_TEST(points_that_go_wake_what_they_held) {
    bedroom room;
    double before;
    int frame;
    bedroom_make(&room, _i);
    settle(&room);
    before = room.s.displacement[3 * room.first[2] - 1];
    room.step.point_count = room.first[1]; /* those of the block that hangs are still there */
    for (frame = 0; frame < 20; frame++) {
        bedroom_step(&room);
        ck_assert_uint_eq(room.report.active_unknowns, unknowns_of(&room, 1));
    }
    ck_assert(room.s.displacement[3 * room.first[2] - 1] < before - 0.1);
    bedroom_free(&room);
}
END_TEST

/* A spring between two blocks ties them: neither sleeps while the other is awake. */
START_TEST(a_spring_between_blocks_wakes_both) {
    bedroom room;
    size_t i;
    bedroom_make(&room, _i);
    room.spring = spring_make(point_at(&room.s, room.first[1] - 1), 10);
    room.spring.point.copy[1] = (uint32_t)room.first[1];
    room.spring.point.weight[0] = room.spring.point.weight[1] = 0.5;
    for (i = 0; i < 3; i++) {
        room.spring.point.position[i] =
            0.5 * (room.s.rest[3 * (room.first[1] - 1) + i] + room.s.rest[3 * room.first[1] + i]);
        room.spring.target[i] = room.spring.point.position[i];
    }
    room.step.springs = &room.spring;
    room.step.spring_count = 1;
    settle(&room);
    touch(&room, TOUCH_VELOCITY, room.first[2] - 1);
    bedroom_step(&room);
    ck_assert_uint_eq(room.report.active_unknowns, unknowns_of(&room, 0) + unknowns_of(&room, 1));
    bedroom_free(&room);
}
END_TEST

/* Tied blocks are one component: they fall asleep and wake together. */
START_TEST(tied_blocks_sleep_together) {
    gxs_solver *solver = solver_of(_i);
    gxs_step_desc step = step_make(0.02, -9.81);
    gxs_step_report report;
    gxs_constraint *ties;
    double *rest_times, *bits;
    size_t n, active;
    int frame;
    scene s = scene_block(4, 1, 1, 0.25, 0, 0);
    ties = scene_split(&s, 0.5);
    scene_hold_left(&s);
    n = s.model.copy_count;
    active = 3 * (n - 4 - 4);
    rest_times = (double *)zeroed(n, sizeof *rest_times);
    bits = (double *)zeroed(3 * n, sizeof *bits);
    step.mass_damping = 5;
    step.sleep_speed = 1e-6;
    step.rest_times = rest_times;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 2000; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert(report.active_unknowns == active || report.active_unknowns == 0);
        if (report.active_unknowns == 0) break;
    }
    ck_assert_uint_eq(report.active_unknowns, 0);
    memcpy(bits, s.displacement, 3 * n * sizeof *bits);
    for (frame = 0; frame < 5; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert(memcmp(bits, s.displacement, 3 * n * sizeof *bits) == 0);
    s.velocity[3 * n - 1] = 1e-3; /* of a follower */
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, active);
    free(ties), free(rest_times), free(bits);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- time budgets ---- */

static double ticks(void *user) { return *(double *)user += 1; }

/* E of the manual with springs and planes; no friction */
static double potential(const scene *s, const gxs_step_desc *step, const double *un, const double *vn,
                        const double *u) {
    double sum = incremental_potential(s, step, un, vn, u), force[3];
    size_t i;
    int r;
    for (i = 0; i < step->spring_count; i++) {
        double x[3];
        point_now(&step->springs[i].point, u, x);
        for (r = 0; r < 3; r++)
            sum += 0.5 * step->springs[i].stiffness * (step->springs[i].target[r] - x[r]) *
                   (step->springs[i].target[r] - x[r]);
    }
    return sum + plane_forces(step, un, u, force);
}

/* Violent starts with springs and planes, however early the time is over: a finite state, no higher than the start */
START_TEST(budgets_end_in_good_states) {
    gxs_solver *solver = solver_of(_i);
    double budget, *un, *vn;
    int how, out_of_time = 0, in_time = 0;
    for (how = 0; how < 4; how++)
        for (budget = 0.5; budget < 5000; budget *= budget < 20 ? 1.15 : 1.6) {
            gxs_step_desc step = step_make(0.03, -9.81);
            gxs_step_report report;
            gxs_spring spring;
            gxs_plane plane = plane_make(1e6, 0);
            gxs_point *points;
            double now = 0, before, after;
            size_t i, count;
            scene s;
            seed((uint64_t)(4 * _i + how));
            s = scene_block(3, 2, 2, 0.5, 0.1, 0);
            count = 3 * s.model.copy_count;
            un = (double *)zeroed(count, sizeof *un), vn = (double *)zeroed(count, sizeof *vn);
            points = points_of(&s, 0, s.model.copy_count);
            for (i = 0; i < count; i++) {
                s.displacement[i] = how == 0 ? 0.5 * uniform()
                                  : how == 1 ? (i % 3 == 2 ? -2 * s.rest[i] : 0)
                                             : 0.01 * uniform();
                s.velocity[i] = how == 2 ? 50 * uniform() : uniform();
            }
            memcpy(un, s.displacement, count * sizeof *un);
            memcpy(vn, s.velocity, count * sizeof *vn);
            spring = spring_make(points[5], 1e5);
            spring.target[0] += 1;
            step.springs = &spring, step.spring_count = 1;
            step.points = points, step.point_count = s.model.copy_count;
            step.planes = &plane, step.plane_count = 1;
            step.newton_iterations = 8;
            step.newton_tolerance = how == 3 ? 1e-3 : 1e-8;
            step.cg_tolerance = 1e-3;
            step.clock = ticks, step.clock_user = &now;
            step.budget_seconds = budget;
            ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
            check_finite(&s);
            before = potential(&s, &step, un, vn, un);
            after = potential(&s, &step, un, vn, s.displacement);
            assert_that(after <= before + 1e-11 * fabs(before), "start %d, budget %g: %.17g J after %.17g J", how,
                        budget, after, before);
            assert_that(fabs(report.energy - after) < 1e-9 * (fabs(after) + fabs(before)),
                        "reported %.17g J, not %.17g", report.energy, after);
            assert_that(distance(s.displacement, un, count) < 1e3, "far away");
            for (i = 0; i < count; i++)
                assert_that(fabs(s.velocity[i] - (s.displacement[i] - un[i]) / step.dt) <
                                1e-9 * (1 + fabs(s.velocity[i])),
                            "velocity");
            /* a few reads of the clock before the end */
            assert_that(now <= budget + 12, "start %d, budget %g: went on until %g", how, budget, now);
            assert_that(report.seconds_linearise >= 0 && report.seconds_prepare >= 0 && report.seconds_solve >= 0 &&
                            report.seconds_linearise + report.seconds_prepare + report.seconds_solve <= now,
                        "seconds %g + %g + %g of %g", report.seconds_linearise, report.seconds_prepare,
                        report.seconds_solve, now);
            out_of_time += report.stop == GXS_STOP_SECONDS;
            in_time += report.stop != GXS_STOP_SECONDS;
            free(un), free(vn), free(points);
            scene_free(&s);
        }
    assert_that(out_of_time > 10 && in_time > 3, "%d out of time, %d in time", out_of_time, in_time);
    gxs_solver_destroy(solver);
}
END_TEST

/* 0 without a clock; with one, the number of its linearisations. Reading a clock changes no bits. */
START_TEST(seconds_need_a_clock) {
    double first[3 * 64];
    int timed;
    for (timed = 0; timed < 2; timed++) {
        gxs_solver *solver = solver_of(_i);
        gxs_step_desc step = step_make(0.033, -9.81);
        gxs_step_report report;
        double now = 0;
        scene s = scene_block(3, 2, 2, 0.25, 0, 0);
        scene_hold_left(&s);
        step.newton_iterations = 3;
        if (timed) step.clock = ticks, step.clock_user = &now;
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        if (!timed) {
            ck_assert(report.seconds_linearise == 0 && report.seconds_prepare == 0 && report.seconds_solve == 0);
            memcpy(first, s.displacement, 3 * s.model.copy_count * sizeof(double));
        } else {
            assert_that(report.seconds_linearise >= 3 && report.seconds_prepare >= 3 && report.seconds_solve >= 3,
                        "%g %g %g", report.seconds_linearise, report.seconds_prepare, report.seconds_solve);
            ck_assert(report.seconds_linearise + report.seconds_prepare + report.seconds_solve <= now);
        }
        ck_assert(memcmp(first, s.displacement, 3 * s.model.copy_count * sizeof(double)) == 0);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* ---- all matrices and preconditioners ---- */

/* A tied bar with springs on a plane: every solver makes the same step; assembled multigrid takes few more
   iterations. */
START_TEST(solvers_agree) {
    double first[3 * 512], size = 0;
    uint32_t iterations[SOLVERS] = {0};
    int which, k;
    for (which = 0; which < SOLVERS; which++) {
        gxs_solver *solver = solver_of(which);
        gxs_step_desc step = step_make(0.02, -9.81);
        gxs_step_report report;
        gxs_plane plane = plane_make(1e6, 0);
        gxs_spring springs[12];
        gxs_constraint *ties = NULL;
        gxs_point *points;
        size_t i, count;
        scene s;
        seed(23);
        s = scene_block(10, 5, 5, 0.2, 0, 0);
        set_kind(s.material, _i / 4);
        s.model.lumped_mass = (uint32_t)(_i % 2);
        stir(&s, 0.5, 0.5);
        if (_i / 2 % 2) ties = scene_split(&s, 1);
        scene_hold_left(&s);
        count = 3 * s.model.copy_count;
        ck_assert_uint_le(count, 3 * 512);
        for (i = 0; i < count; i++)
            s.displacement[i] = s.held[i / 3] ? 0 : s.displacement[i] - (i % 3 == 2 ? 1e-3 * s.rest[i - 2] : 0);
        for (k = 0; k < 12; k++) {
            springs[k] = spring_make(random_point(&s), k % 3 ? 1e4 : 1e7);
            springs[k].target[1] += 0.02 * uniform();
        }
        points = points_of(&s, 0, s.model.copy_count);
        step.springs = springs, step.spring_count = 12;
        step.points = points, step.point_count = s.model.copy_count;
        step.planes = &plane, step.plane_count = 1;
        step.newton_iterations = 60;
        step.newton_tolerance = 1e-9;
        step.cg_tolerance = 1e-3;
        step.cg_iterations = 5000;
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(report.residual < 1e-9, "%s: residual %g after %u Newton, %u CG iterations", solver_name(which),
                    report.residual, (unsigned)report.newton_iterations, (unsigned)report.cg_iterations);
        iterations[which] = report.cg_iterations;
        if (which == 0) {
            memcpy(first, s.displacement, count * sizeof(double));
            for (i = 0; i < count; i++) size = fabs(first[i]) > size ? fabs(first[i]) : size;
        }
        assert_that(distance(first, s.displacement, count) < 1e-6 * size, "%s: %g m of %g apart", solver_name(which),
                    distance(first, s.displacement, count), size);
        free(ties), free(points);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
    assert_that(iterations[3] <= iterations[2] + iterations[2] / 2, "multigrid: %u iterations, assembled %u",
                (unsigned)iterations[2], (unsigned)iterations[3]);
    assert_that(iterations[2] <= iterations[0] && iterations[3] <= iterations[1], "block-Jacobi %u %u, multigrid %u %u",
                (unsigned)iterations[0], (unsigned)iterations[1], (unsigned)iterations[2], (unsigned)iterations[3]);
}
END_TEST

/* ... also where half of the body is held, whose elements no matrix has, and to all digits there are */
START_TEST(solvers_agree_on_held_halves) {
    double first[3 * 512];
    int which;
    for (which = 0; which < SOLVERS; which++) {
        gxs_solver *solver = solver_of(which);
        gxs_step_desc step = step_tight(0.02, -9.81);
        gxs_step_report report;
        size_t i, count;
        scene s;
        seed(24);
        s = scene_block(10, 5, 5, 0.2, 0, 0);
        count = 3 * s.model.copy_count;
        ck_assert_uint_le(count, 3 * 512);
        for (i = 0; i < s.model.copy_count; i++) s.held[i] = s.rest[3 * i] < 1.1;
        step.newton_tolerance = 1e-30; /* less than rounding leaves */
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert(report.stop == GXS_STOP_BALANCE || report.stop == GXS_STOP_ROUNDING);
        assert_that(report.residual < 1e-9, "%s: residual %g", solver_name(which), report.residual);
        if (which == 0) memcpy(first, s.displacement, count * sizeof(double));
        for (i = 0; i < count; i++) ck_assert(!s.held[i / 3] || (s.displacement[i] >= 0 && s.displacement[i] <= 0));
        assert_that(distance(first, s.displacement, count) < 1e-9, "%s: %g m apart", solver_name(which),
                    distance(first, s.displacement, count));
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

/* ---- memory ---- */

/* Creates a solver, then sets models with ties that grow, with steps of more and more springs and points. Returns
   whether an allocation failed. */
static int run_with(memory *m, int which) {
    gxs_solver_desc desc = solver_desc(which);
    gxs_solver *solver = NULL;
    int size, failed = 0;
    desc.allocator = allocator_of(m);
    if (gxs_solver_create(&desc, &solver, NULL) != GX_OK) {
        ck_assert_ptr_null(solver);
        return 1;
    }
    for (size = 1; size <= 2; size++) {
        gxs_step_desc step = step_make(0.033, -9.81);
        gxs_constraint *ties;
        gxs_spring springs[3];
        gxs_point *points;
        gxs_plane plane = plane_make(1e5, 0.5);
        scene s = scene_block(2 * size, size, size, 0.5, 0, 0);
        gx_result result;
        size_t i;
        int k, part;
        ties = scene_split(&s, 0.5 * size);
        set_kind(s.material, size == 2 ? GXS_CUSTOM : GXS_STABLE_NEO_HOOKEAN);
        points = points_of(&s, 0, s.model.copy_count);
        for (k = 0; k < 3; k++) springs[k] = spring_make(points[k], 1e4);
        for (part = 0; part < 4; part++) { /* the model, then steps */
            int again = 0;
            step.springs = springs, step.spring_count = part >= 2 ? 3 : 0;
            step.points = points, step.point_count = part == 3 ? s.model.copy_count : 0;
            step.planes = &plane, step.plane_count = 1;
            do {
                gx_failure failure;
                double *before = (double *)zeroed(3 * s.model.copy_count, 2 * sizeof(double));
                memcpy(before, s.displacement, 3 * s.model.copy_count * sizeof(double));
                memcpy(before + 3 * s.model.copy_count, s.velocity, 3 * s.model.copy_count * sizeof(double));
                result = part == 0 ? gxs_solver_set_model(solver, &s.model, &failure)
                                   : gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, &failure);
                if (result == GX_ERROR_MEMORY) {
                    ck_assert_int_eq(failure.result, GX_ERROR_MEMORY);
                    ck_assert(memcmp(before, s.displacement, 3 * s.model.copy_count * sizeof(double)) == 0 &&
                              memcmp(before + 3 * s.model.copy_count, s.velocity,
                                     3 * s.model.copy_count * sizeof(double)) == 0);
                    failed = 1;
                } else
                    ck_assert_int_eq(result, GX_OK);
                free(before);
            } while (result == GX_ERROR_MEMORY && !m->from_then_on && again++ == 0); /* the solver is still good */
            ck_assert(m->from_then_on || result == GX_OK);
            if (result != GX_OK && part == 0) break;
        }
        for (i = 0; i < 3 * s.model.copy_count; i++)
            ck_assert(finite_bits(s.displacement[i]) && finite_bits(s.velocity[i]));
        free(ties), free(points);
        scene_free(&s);
    }
    gxs_solver_destroy(solver);
    return failed;
}

START_TEST(every_allocation_may_fail) { sweep_allocations(run_with, _i); }
END_TEST

/* Steps of no more springs and points than before allocate nothing. */
START_TEST(steps_allocate_for_more_points_only) {
    gxs_solver_desc desc = solver_desc(_i);
    memory m = plenty();
    gxs_solver *solver = NULL;
    gxs_step_desc step = step_make(0.033, -9.81);
    gxs_plane plane = plane_make(1e5, 0.5);
    gxs_point *points;
    size_t calls;
    int frame;
    scene s = scene_block(4, 4, 4, 0.5, 0, 0);
    points = points_of(&s, 0, s.model.copy_count);
    desc.allocator = allocator_of(&m);
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    step.points = points;
    step.planes = &plane;
    step.plane_count = 1;
    step.point_count = s.model.copy_count;
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    calls = m.calls;
    for (frame = 0; frame < 5; frame++) {
        step.point_count = s.model.copy_count - (size_t)(frame % 2 * 10);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    }
    ck_assert_uint_eq(m.calls, calls);
    gxs_solver_destroy(solver);
    ck_assert(is_whole(&m));
    free(points);
    scene_free(&s);
}
END_TEST

/* ---- absurd input ---- */

/* *user says what is wrong with the answer: force, energy, off-diagonal or diagonal of the Hessian, or a Hessian far
   from semi-definite */
static double bad_contact(void *user, size_t point, const double *position, double *force, double *hessian) {
    const int fault = *(const int *)user;
    const double nan = not_a_number(0);
    (void)point, (void)position;
    if (hessian) hessian[0] = hessian[3] = hessian[5] = 1e3;
    force[0] = fault == 0 ? nan : fault == 1 ? not_a_number(1) : 1;
    if (hessian && fault >= 3) hessian[fault == 3 ? 1 : 0] = fault == 5 ? -1e12 : nan;
    return fault == 2 ? nan : 0;
}

/* an energy that is not a number where the element is stretched by a tenth */
static double bad_energy(void *user, const double *f, double *stress, double *hessian) {
    int i;
    (void)user;
    for (i = 0; i < 9 && stress; i++) stress[i] = 1e6 * (f[i] - (i % 4 == 0));
    for (i = 0; i < 81 && hessian; i++) hessian[i] = i % 10 == 0 ? 1e6 : 0;
    return f[0] > 1.1 ? not_a_number(0) : 5e5 * (f[0] - 1) * (f[0] - 1);
}

enum {
    ABSURD_SPRING,
    ABSURD_PLANE,
    ABSURD_SHORT,
    ABSURD_LONG,
    ABSURD_HELD,
    ABSURD_MASSLESS,
    ABSURD_TIED,
    ABSURD_TARGETS,
    ABSURD_FORCES,
    ABSURD_ENERGY,
    ABSURD_CONTACT,
    ABSURD_COUNT = ABSURD_CONTACT + 6
};

typedef struct absurdity {
    scene s;
    gxs_step_desc step;
    gxs_spring springs[2];
    gxs_plane plane;
    gxs_point *points;
    gxs_constraint *ties;
    double *targets;
    int fault;
} absurdity;

static void absurdity_make(absurdity *a, int which) {
    size_t i, n;
    memset(a, 0, sizeof *a);
    seed(7);
    a->s = scene_block(3, 2, 2, 0.25, 0.1, 0);
    n = a->s.model.copy_count;
    a->step = step_make(which == ABSURD_SHORT ? 1e-12 : which == ABSURD_LONG ? 1e6 : 0.033, -9.81);
    a->step.newton_iterations = 3;
    a->points = points_of(&a->s, 0, n);
    a->ties = (gxs_constraint *)zeroed(n, sizeof *a->ties);
    a->targets = (double *)zeroed(3 * n, sizeof(double));
    a->plane = plane_make(1e20, 0.5);
    a->fault = which - ABSURD_CONTACT;
    for (i = 0; i < 2; i++) {
        a->springs[i] = spring_make(point_at(&a->s, n - 1), 1e20);
        a->springs[i].target[0] += 0.3 * (double)i; /* the two contradict each other */
    }
    for (i = 0; i < 3 * n; i++) {
        a->s.displacement[i] = 0.02 * uniform(), a->s.velocity[i] = uniform();
        a->s.forces[i] = 1e30 * uniform(), a->targets[i] = 1e6 * uniform();
    }
    if (which != ABSURD_TIED) scene_hold_left(&a->s);
    for (i = 0; i < n && which == ABSURD_HELD; i++) a->s.held[i] = 1;
    for (i = 0; i < a->s.model.element_count && which == ABSURD_MASSLESS; i++)
        memset(a->s.elements[i].mass, 0, sizeof a->s.elements[i].mass);
    for (i = 1; i < n; i++) a->ties[i - 1].copy = (uint32_t)i, a->ties[i - 1].weight[0] = 1;
}

/* the step's own error; an energy that is not a number is the model's */
static void absurdity_apply(absurdity *a, int which) {
    if (which == ABSURD_SPRING) a->step.springs = a->springs, a->step.spring_count = 2;
    if (which == ABSURD_PLANE || which >= ABSURD_CONTACT)
        a->step.points = a->points, a->step.point_count = a->s.model.copy_count;
    if (which == ABSURD_PLANE) a->step.planes = &a->plane, a->step.plane_count = 1;
    if (which >= ABSURD_CONTACT) a->step.contact = bad_contact, a->step.contact_user = &a->fault;
    if (which == ABSURD_TIED) a->s.model.constraints = a->ties, a->s.model.constraint_count = a->s.model.copy_count - 1;
    if (which == ABSURD_TARGETS) a->step.targets = a->targets;
    if (which == ABSURD_FORCES) a->step.forces = a->s.forces;
    if (which == ABSURD_ENERGY) a->s.material->kind = GXS_CUSTOM, a->s.material->energy = bad_energy;
}

static void absurdity_free(absurdity *a) {
    free(a->points), free(a->ties), free(a->targets);
    scene_free(&a->s);
}

/* Whatever the request, a step ends in finite numbers, or says that it has diverged and leaves the state alone. */
START_TEST(absurd_steps_lose_nothing) {
    const int which = _i / 4;
    int solver_index, frame;
    for (solver_index = 0; solver_index < SOLVERS; solver_index++) {
        gxs_solver *solver = solver_of(solver_index);
        gx_result result = GX_OK;
        absurdity a;
        double *before;
        size_t bytes;
        absurdity_make(&a, which);
        absurdity_apply(&a, which);
        a.step.integrator = (gxs_integrator)(_i % 4);
        bytes = 3 * a.s.model.copy_count * sizeof(double);
        before = (double *)zeroed(2, bytes);
        ck_assert_int_eq(gxs_solver_set_model(solver, &a.s.model, NULL), GX_OK);
        for (frame = 0; frame < 8 && result == GX_OK; frame++) {
            gxs_step_report report;
            gx_failure failure;
            memcpy(before, a.s.displacement, bytes), memcpy((char *)before + bytes, a.s.velocity, bytes);
            result = gxs_solver_step(solver, &a.step, a.s.displacement, a.s.velocity, &report, &failure);
            assert_that(result == GX_OK || (result == GX_ERROR_DIVERGED && failure.result == result), "result %d",
                        (int)result);
            check_finite(&a.s);
            assert_that(result != GX_OK || (finite_bits(report.energy) && finite_bits(report.residual)),
                        "frame %d: report", frame);
        }
        assert_that(result == GX_OK || (memcmp(before, a.s.displacement, bytes) == 0 &&
                                        memcmp((char *)before + bytes, a.s.velocity, bytes) == 0),
                    "a failed step has changed the state");
        free(before);
        gxs_solver_destroy(solver);
        absurdity_free(&a);
    }
}
END_TEST

/* ---- all at once ---- */

static int dice(int sides) {
    int face = (int)((uniform() + 1) / 2 * sides);
    return face < sides ? face : sides - 1;
}

enum { SOAK_STEPS = 150, SOAK_SPRINGS = 8 };

typedef struct soak {
    scene s;
    gxs_material materials[3];
    gxs_constraint *ties;
    gxs_plane planes[2];
    gxs_spring springs[SOAK_SPRINGS];
    gxs_point *points;
    double *rest_times, *targets, *previous[2], *now[2];
    double time, previous_dt;
    gxs_solver *solver;
    gxs_step_desc step;
} soak;

static void soak_make(soak *k, uint64_t start) {
    size_t i, n, count = 0;
    int block;
    memset(k, 0, sizeof *k);
    seed(start);
    k->s = scene_block(1 + dice(4), 1 + dice(3), 1 + dice(3), 0.25, 0.1, 0);
    for (block = dice(3); block > 0; block--) {
        scene other = scene_block(1 + dice(3), 1 + dice(3), 1 + dice(2), 0.25, 0.1, 0);
        scene_add(&k->s, &other, 1.5 * block, 0.3 * uniform(), 0.3 + 0.3 * uniform());
    }
    n = k->s.model.copy_count;
    for (i = 0; i < 3; i++) {
        set_kind(&k->materials[i], dice(KINDS));
        k->materials[i].young = pow(10, 4 + 3 * (uniform() + 1) / 2);
        k->materials[i].poisson = 0.49 * (uniform() + 1) / 2;
        k->materials[i].damping = dice(2) ? 0 : 0.01 * (uniform() + 1);
    }
    for (i = 0; i < k->s.model.element_count; i++) k->s.elements[i].material = (uint32_t)dice(3);
    k->s.model.materials = k->materials;
    k->s.model.material_count = 3;
    k->s.model.lumped_mass = (uint32_t)dice(2);
    if (dice(2))
        for (i = 0; i < n; i++) k->s.held[i] = dice(12) == 0;
    k->ties = (gxs_constraint *)zeroed(n, sizeof *k->ties);
    if (dice(2))
        for (i = n / 2; i < n; i++) /* the upper half may follow the lower */
            if (dice(8) == 0) {
                k->ties[count].copy = (uint32_t)i;
                for (block = 0; block < 4; block++) k->ties[count].master[block] = (uint32_t)dice((int)(n / 2));
                k->ties[count].weight[0] = 0.5;
                k->ties[count].weight[1] = dice(4) ? 0.5 : 0.3;
                count++;
            }
    k->s.model.constraints = k->ties;
    k->s.model.constraint_count = count;
    k->points = points_of(&k->s, 0, n);
    k->rest_times = (double *)zeroed(n, sizeof(double));
    k->targets = (double *)zeroed(3 * n, sizeof(double));
    for (i = 0; i < 2; i++)
        k->previous[i] = (double *)zeroed(3 * n, sizeof(double)), k->now[i] = (double *)zeroed(3 * n, sizeof(double));
    for (i = 0; i < 3 * n; i++) k->s.velocity[i] = uniform();
    k->solver = solver_of(dice(SOLVERS));
    ck_assert_int_eq(gxs_solver_set_model(k->solver, &k->s.model, NULL), GX_OK);
    k->step = step_make(0.02, -9.81);
    k->step.clock_user = &k->time;
    k->step.contact_user = &k->planes[0];
    k->planes[0] = plane_make(1e4, 0.5);
    k->planes[1] = plane_make(1e6, 0.2);
    k->planes[1].normal[2] = 0, k->planes[1].normal[0] = -1, k->planes[1].offset = -3;
}

static void soak_free(soak *k) {
    size_t i;
    for (i = 0; i < 2; i++) free(k->previous[i]), free(k->now[i]);
    free(k->ties), free(k->points), free(k->rest_times), free(k->targets);
    gxs_solver_destroy(k->solver);
    scene_free(&k->s);
}

/* Changes that happen now and then between steps */
static void soak_change(soak *k, int frame) {
    static const double dts[4] = {0.001, 0.01, 0.02, 0.033};
    gxs_step_desc *step = &k->step;
    const size_t n = k->s.model.copy_count;
    size_t i;
    int r;
    if (dice(10) == 0) step->dt = dts[dice(4)];
    if (dice(20) == 0) step->integrator = (gxs_integrator)dice(4);
    if (dice(10) == 0) step->gravity[dice(3)] = 9.81 * uniform();
    if (dice(10) == 0) step->mass_damping = dice(2) * 3 * (uniform() + 1);
    if (dice(6) == 0) {
        step->spring_count = (size_t)dice(SOAK_SPRINGS + 1);
        for (i = 0; i < SOAK_SPRINGS; i++)
            k->springs[i] = spring_make(random_point(&k->s), dice(5) ? pow(10, 4 + 3 * uniform()) : 1e9);
        step->springs = k->springs;
    }
    for (i = 0; i < step->spring_count; i++)
        for (r = 0; r < 3; r++) k->springs[i].target[r] += 0.01 * uniform();
    if (dice(10) == 0) {
        step->points = k->points;
        step->point_count = dice(2) ? n : 0;
        step->planes = k->planes;
        step->plane_count = (size_t)dice(3);
        step->contact = dice(3) ? NULL : penalty;
    }
    if (dice(10) == 0) step->forces = dice(2) ? k->s.forces : NULL;
    if (dice(10) == 0)
        for (i = 0; i < 3 * n; i++) k->s.forces[i] = dice(2) ? uniform() : k->s.forces[i];
    if (dice(10) == 0) step->targets = dice(2) ? k->targets : NULL;
    for (i = 0; i < 3 * n; i++) k->targets[i] = k->s.displacement[i] + (frame % 40 < 20 ? 0.002 * uniform() : 0);
    if (dice(10) == 0) {
        step->sleep_speed = dice(2) ? 0.2 : 0;
        step->sleep_time = 0.05;
        step->rest_times = k->rest_times;
    }
    if (dice(10) == 0) {
        step->clock = dice(2) ? ticks : NULL;
        step->budget_seconds = step->clock ? dice(30) : 0;
    }
    if (dice(25) == 0) k->s.velocity[dice((int)(3 * n))] += 5 * uniform();
    if (dice(40) == 0) ck_assert_int_eq(gxs_solver_set_model(k->solver, &k->s.model, NULL), GX_OK);
    step->previous_displacement = step->previous_velocity = NULL;
    if (frame > 0 && dice(2)) {
        step->previous_displacement = k->previous[0];
        step->previous_velocity = k->previous[1];
        step->previous_dt = k->previous_dt;
    }
}

START_TEST(anything_goes) {
    soak k;
    int frame, j, r;
    size_t i, n;
    soak_make(&k, 1000 + (uint64_t)_i);
    n = k.s.model.copy_count;
    for (frame = 0; frame < SOAK_STEPS; frame++) {
        gxs_step_report report;
        gx_failure failure;
        gx_result result;
        double forces[3 * SOAK_SPRINGS];
        soak_change(&k, frame);
        k.step.spring_forces = forces;
        memcpy(k.now[0], k.s.displacement, 3 * n * sizeof(double));
        memcpy(k.now[1], k.s.velocity, 3 * n * sizeof(double));
        result = gxs_solver_step(k.solver, &k.step, k.s.displacement, k.s.velocity, &report, &failure);
        assert_that(result == GX_OK, "frame %d: result %d, copy %lu", frame, (int)result, (unsigned long)failure.index);
        check_finite(&k.s);
        assert_that(finite_bits(report.energy) && finite_bits(report.residual) && report.residual >= 0,
                    "frame %d: report", frame);
        for (i = 0; i < 3 * k.step.spring_count; i++)
            assert_that(finite_bits(forces[i]), "frame %d: spring force", frame);
        for (i = 0; i < n; i++) {
            assert_that(finite_bits(k.rest_times[i]) && k.rest_times[i] >= 0, "frame %d: rest time %g", frame,
                        k.rest_times[i]);
            for (r = 0; r < 3 && k.s.held[i]; r++) {
                const double want = k.step.targets ? k.targets[3 * i + (size_t)r] : k.now[0][3 * i + (size_t)r];
                assert_that(fabs(k.s.displacement[3 * i + (size_t)r] - want) < 1e-12 * (1 + fabs(want)),
                            "frame %d: held copy %lu", frame, (unsigned long)i);
            }
        }
        for (i = 0; i < k.s.model.constraint_count; i++)
            for (r = 0; r < 3 && !k.s.held[k.ties[i].copy]; r++) {
                const size_t at = 3 * k.ties[i].copy + (size_t)r;
                double way = 0, size = 1 + fabs(k.s.displacement[at]);
                for (j = 0; j < 4; j++) {
                    const size_t master = 3 * k.ties[i].master[j] + (size_t)r;
                    way += k.ties[i].weight[j] * (k.s.displacement[master] - k.now[0][master]);
                    size += fabs(k.s.displacement[master]);
                }
                assert_that(fabs(way - (k.s.displacement[at] - k.now[0][at])) < 1e-12 * size,
                            "frame %d: follower %lu went %g, its masters %g", frame, (unsigned long)i,
                            k.s.displacement[at] - k.now[0][at], way);
            }
        memcpy(k.previous[0], k.now[0], 3 * n * sizeof(double));
        memcpy(k.previous[1], k.now[1], 3 * n * sizeof(double));
        k.previous_dt = k.step.dt;
    }
    soak_free(&k);
}
END_TEST

static Suite *forces_suite(void) {
    Suite *suite = suite_create("gxfem_solve: forces");
    TCase *constraints = tcase_create("constraints"), *springs = tcase_create("springs"),
          *input = tcase_create("input");
    TCase *contact = tcase_create("contact"), *statics = tcase_create("statics"), *damping = tcase_create("damping");
    TCase *sleep = tcase_create("sleep"), *budget = tcase_create("budget"), *solvers = tcase_create("solvers"),
          *all = tcase_create("all");
    TCase *midpoint = tcase_create("midpoint"), *cases[11];
    int i;
    cases[0] = constraints, cases[1] = springs, cases[2] = input, cases[3] = contact, cases[4] = statics,
    cases[5] = damping;
    cases[6] = sleep, cases[7] = budget, cases[8] = solvers, cases[9] = all, cases[10] = midpoint;
    ADD_SOME(constraints, tied_blocks_move_as_one, 4 * KINDS);
    tcase_add_loop_test(constraints, momentum_of_tied_blocks_is_balanced, 0, SOLVERS);
    tcase_add_loop_test(constraints, hanging_nodes_pass_the_patch_test, 0, KINDS);
    tcase_add_loop_test(constraints, followers_change_by_their_masters_mean, 0, 3);
    tcase_add_loop_test(constraints, followers_of_moving_targets_go_along, 0, 3 * SOLVERS);
    tcase_add_loop_test(constraints, moved_copies_have_inertia, 0, SOLVERS);
    tcase_add_loop_test(constraints, followers_alone_go_along, 0, SOLVERS);
    tcase_add_test(constraints, bad_constraints_are_named);
    tcase_add_test(constraints, harmless_constraints_are_taken);
    tcase_add_loop_test(springs, springs_balance_momentum, 0, SOLVERS);
    tcase_add_loop_test(springs, springs_carry_a_weight, 0, SOLVERS);
    tcase_add_loop_test(springs, idle_springs_change_nothing, 0, SOLVERS);
    tcase_add_loop_test(springs, stiff_springs_lead, 0, SOLVERS);
    ADD_SOME(springs, later_springs_converge_as_well, 3 * 4); /* not by volume ratio, which is for comparison */
    tcase_add_test(input, bad_input_is_named);
    tcase_add_test(input, bad_spans_are_named);
    tcase_add_loop_test(input, points_are_spans, 0, SOLVERS);
    tcase_add_loop_test(input, a_pair_is_one_span, 0, SOLVERS);
    ADD_SOME(contact, dropped_block_comes_to_rest, SOLVERS);
    tcase_add_loop_test(contact, contact_balances_momentum, 0, SOLVERS);
    tcase_add_loop_test(contact, friction_balances_momentum, 0, 4); /* not by volume ratio */
    tcase_add_loop_test(contact, friction_holds_and_slides, 0, SOLVERS);
    ADD_SOME(contact, bounces_gain_no_energy, 2 * SOLVERS);
    tcase_add_loop_test(contact, contact_by_callback_is_the_plane, 0, SOLVERS);
    tcase_add_loop_test(contact, constant_contact_forces_give_their_momentum, 0, SOLVERS);
    tcase_add_loop_test(contact, friction_acts_on_points_that_targets_carry, 0, 2 * SOLVERS);
    tcase_add_loop_test(contact, pieces_in_flight_keep_their_momentum, 0, SOLVERS);
    ADD_SOME(contact, energy_falls_in_every_piece, 4 * SOLVERS);
    ADD_SOME(contact, pieces_step_as_if_alone, 16);
    ADD_SOME(contact, energy_falls_in_joined_pieces, 10);
    ADD_SOME(statics, static_balance_is_the_end_of_motion, KINDS * SOLVERS);
    tcase_add_loop_test(statics, static_balance_reaches_through_ties, 0, 4);
    tcase_add_loop_test(statics, static_balance_needs_a_hold, 0, SOLVERS);
    tcase_add_loop_test(statics, static_balance_is_found_from_afar, 0, SOLVERS);
    ADD_SOME(midpoint, midpoint_gains_no_energy, 2 * SOLVERS);
    ADD_SOME(midpoint, midpoint_gains_nothing_where_contact_begins, 24);
    ADD_SOME(damping, modes_decay_by_stiffness_damping, KINDS);
    tcase_add_loop_test(damping, damping_keeps_momentum, 0, 3 * KINDS);
    tcase_add_loop_test(damping, damped_bodies_come_to_rest, 0, KINDS);
    ADD_SOME(damping, rotation_is_not_damped, 2 * GXS_LINEAR);
    tcase_add_loop_test(sleep, settled_blocks_sleep, 0, SOLVERS);
    tcase_add_loop_test(sleep, a_touch_wakes_one_block, 0, SOLVERS);
    tcase_add_test(sleep, forces_that_come_and_go_wake_one_block);
    tcase_add_loop_test(sleep, changes_of_the_scene_wake_all, 0, 2);
    tcase_add_test(sleep, a_failed_step_swallows_no_touch);
    tcase_add_loop_test(sleep, a_failed_step_swallows_no_slow_kick, 0, SOLVERS);
    ADD_SOME(sleep, a_woken_block_moves_as_before, SOLVERS);
    tcase_add_loop_test(sleep, bodies_sleep_in_mid_air, 0, SOLVERS);
    tcase_add_loop_test(sleep, sleep_outlasts_a_new_model, 0, 4);
    tcase_add_test(sleep, blocks_on_constant_springs_sleep);
    tcase_add_loop_test(sleep, points_that_go_wake_what_they_held, 0, SOLVERS);
    tcase_add_loop_test(sleep, a_spring_between_blocks_wakes_both, 0, SOLVERS);
    tcase_add_loop_test(sleep, tied_blocks_sleep_together, 0, SOLVERS);
    tcase_add_loop_test(budget, budgets_end_in_good_states, 0, SOLVERS);
    tcase_add_loop_test(budget, seconds_need_a_clock, 0, SOLVERS);
    ADD_SOME(solvers, solvers_agree, 4 * KINDS);
    tcase_add_test(solvers, solvers_agree_on_held_halves);
    tcase_add_loop_test(all, every_allocation_may_fail, 0, SOLVERS);
    tcase_add_loop_test(all, steps_allocate_for_more_points_only, 0, SOLVERS);
    ADD_SOME(input, absurd_steps_lose_nothing, 4 * ABSURD_COUNT);
    ADD_SOME(all, anything_goes, 40);
    for (i = 0; i < 11; i++) {
        tcase_set_timeout(cases[i], 120);
        suite_add_tcase(suite, cases[i]);
    }
    return suite;
}

int main(void) { return run_suite(forces_suite()); }
