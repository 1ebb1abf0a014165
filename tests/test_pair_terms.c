/* test_pair_terms.c - pairs of gxfem_solve.h, which press two sides apart: beside slow formulas, in the multigrid, in
   scenes whose answers are known, asleep, and given wrongly. */
#define GXFEM_SOLVE_IMPLEMENTATION
#include "../gxfem_solve.h"

#include "block.h"
#include <pthread.h>

/* ---- two blocks, one on the other ---- */

enum { SPAN = 8 }; /* copies of a pair of the scenes; two of them have the weight 0 */

/* A stack of two blocks of equal meshes, the lower one's copies first, and pairs between the faces that meet */
typedef struct stack {
    scene s;
    size_t half; /* copies of one block */
    gxs_pair *pairs;
    size_t count;
    uint32_t *copies; /* count x SPAN */
    double *weights;  /* count x SPAN */
    double *slips, *forces;
} stack;

/* A sample of a triangle of the faces: 3 a triangle, each nearer to one of its corners. area: of the triangle */
static void add_pair(stack *t, const uint32_t *corner, int near, double area, const gxs_pair *like) {
    gxs_pair *pair = &t->pairs[t->count];
    uint32_t *copy = t->copies + SPAN * t->count;
    double *weight = t->weights + SPAN * t->count;
    int k;
    *pair = *like;
    for (k = 0; k < SPAN; k++) copy[k] = 0, weight[k] = 0;
    for (k = 0; k < 3; k++) {
        weight[k] = k == near ? 2.0 / 3 : 1.0 / 6;
        weight[3 + k] = -weight[k];
        copy[3 + k] = corner[k];
        copy[k] = corner[k];
    }
    pair->stiffness = like->stiffness * area / 3;
    pair->point.count = SPAN;
    pair->point.copies = copy;
    pair->point.weights = weight;
    t->count++;
}

/* n x n x n cubes each of edge size; like: stiffness per area, friction. gap: between them */
static stack stack_make(int n, double size, double gap, const gxs_pair *like) {
    stack t;
    size_t i, k, elements, layer = (size_t)((n + 1) * (n + 1)), most = (size_t)(6 * n * n);
    int x, y, half, near;
    const size_t copies = layer * (size_t)(n + 1);
    t.s = scene_block(n, n, n, size, 0, (size_t)(6 * n * n * n) + copies);
    t.half = t.s.model.copy_count;
    elements = t.s.model.element_count;
    for (i = 0; i < 3 * t.half; i++) t.s.rest[3 * t.half + i] = t.s.rest[i] + (i % 3 == 2 ? n * size + gap : 0);
    for (i = 0; i < elements; i++) {
        t.s.elements[elements + i] = t.s.elements[i];
        for (k = 0; k < 4; k++) t.s.elements[elements + i].copy[k] += (uint32_t)t.half;
    }
    t.s.model.copy_count *= 2;
    t.s.model.element_count *= 2;
    t.count = 0;
    t.pairs = (gxs_pair *)zeroed(most, sizeof *t.pairs);
    t.copies = (uint32_t *)zeroed(SPAN * most, sizeof *t.copies);
    t.weights = (double *)zeroed(SPAN * most, sizeof *t.weights);
    t.slips = (double *)zeroed(3 * most, sizeof *t.slips);
    t.forces = (double *)zeroed(3 * most, sizeof *t.forces);
    for (y = 0; y < n; y++)
        for (x = 0; x < n; x++)
            for (half = 0; half < 2; half++)
                for (near = 0; near < 3; near++) {
                    const uint32_t a = (uint32_t)(y * (n + 1) + x), row = (uint32_t)n + 1;
                    uint32_t corner[3];
                    gxs_pair one = *like;
                    one.point.position[2] = gap;
                    corner[0] = a, corner[1] = half ? a + row : a + 1, corner[2] = a + row + 1;
                    add_pair(&t, corner, near, 0.5 * size * size, &one);
                    for (k = 0; k < 3; k++) { /* above: the first layer of the second block; below: the last one */
                        t.copies[SPAN * (t.count - 1) + k] = corner[k] + (uint32_t)t.half;
                        t.copies[SPAN * (t.count - 1) + 3 + k] = corner[k] + (uint32_t)(layer * (size_t)n);
                    }
                }
    ck_assert_uint_eq(t.count, most);
    return t;
}

static void stack_free(stack *t) {
    free(t->pairs);
    free(t->copies);
    free(t->weights);
    free(t->slips);
    free(t->forces);
    scene_free(&t->s);
}

static gxs_pair pair_like(double stiffness_per_area, double friction) {
    gxs_pair pair;
    memset(&pair, 0, sizeof pair);
    pair.normal[2] = 1;
    pair.stiffness = stiffness_per_area;
    pair.friction = friction;
    return pair;
}

static void give_pairs(gxs_step_desc *step, const stack *t) {
    step->pairs = t->pairs;
    step->pair_count = t->count;
    step->pair_slips = t->slips;
    step->pair_forces = t->forces;
}

/* Mean velocity or displacement of the upper block along an axis */
static double mean_above(const stack *t, const double *x, size_t axis) {
    double sum = 0;
    size_t i;
    for (i = t->half; i < 2 * t->half; i++) sum += x[3 * i + axis];
    return sum / (double)t->half;
}

static double sum_of(const double *forces, size_t count, size_t axis) {
    double sum = 0;
    size_t i;
    for (i = 0; i < count; i++) sum += forces[3 * i + axis];
    return sum;
}

static gxs_solver *solver_of(gxs_preconditioner preconditioner, gxs_matrix matrix) {
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    memset(&desc, 0, sizeof desc);
    desc.preconditioner = preconditioner;
    desc.matrix = matrix;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    return solver;
}

/* ---- formulas ---- */

enum { COPIES = 12 };

/* A random pair of count copies, some of them the same */
typedef struct sample {
    gxs_pair pair;
    uint32_t copy[GXS_POINT_MOST];
    double weight[GXS_POINT_MOST], start[3 * COPIES], end[3 * COPIES], slip[3];
    gxs_step_desc step;
    gxsp_problem problem;
    gxsp_system system;
    gxsp_lasting lasting;
    gxsp_grip grip;
} sample;

static void sample_make(sample *a, uint32_t count) {
    double sum = 0, length;
    uint32_t k;
    int c;
    memset(a, 0, sizeof *a);
    for (k = 0; k < count; k++) {
        a->copy[k] = (uint32_t)(COPIES * (0.5 + 0.4999 * uniform()));
        a->weight[k] = k + 1 < count ? uniform() : -sum;
        sum += a->weight[k];
    }
    a->pair.point.count = count;
    a->pair.point.copies = a->copy;
    a->pair.point.weights = a->weight;
    for (c = 0; c < 3; c++) a->pair.normal[c] = uniform(), a->pair.point.position[c] = 0.1 * uniform();
    length = sqrt(gxsp_dot(a->pair.normal, a->pair.normal, 1));
    for (c = 0; c < 3; c++) a->pair.normal[c] /= length;
    a->pair.offset = uniform();
    a->pair.stiffness = 10 * (1 + uniform());
    a->pair.friction = uniform() > 0 ? 0.5 : 0;
    a->pair.sticking_speed = 1e-3;
    for (k = 0; k < 3 * COPIES; k++) a->start[k] = 0.3 * uniform(), a->end[k] = a->start[k] + 0.3 * uniform();
    for (c = 0; c < 3; c++) a->slip[c] = 0.1 * uniform();
    if (uniform() > 0) { /* one side, and the way of what is outside */
        a->pair.flags = GXS_PAIR_OUTSIDE;
        for (c = 0; c < 3; c++) a->pair.way[c] = 0.1 * uniform();
    }
    a->step = step_make(0.01, 0);
    a->step.pairs = &a->pair;
    a->step.pair_count = 1;
    a->step.pair_slips = a->slip;
    a->problem.step = &a->step;
    a->problem.given = a->start;
    a->problem.system = &a->system;
    a->system.lasting = &a->lasting;
    a->lasting.grip = &a->grip;
    gxsp_find_grips(&a->problem);
}

/* Energy by the header's formula, in long doubles */
static long double slow_energy(const sample *a, const double *u) {
    long double now[3], before[3], depth, was, way[3], along = 0, far = 0, load, reach, energy = 0;
    uint32_t k;
    int c;
    depth = was = a->pair.offset;
    for (c = 0; c < 3; c++) {
        now[c] = before[c] = a->pair.point.position[c];
        before[c] += a->pair.way[c];
        for (k = 0; k < a->pair.point.count; k++) {
            now[c] += (long double)a->weight[k] * u[3 * a->copy[k] + (uint32_t)c];
            before[c] += (long double)a->weight[k] * a->start[3 * a->copy[k] + (uint32_t)c];
        }
        depth -= a->pair.normal[c] * now[c];
        was -= a->pair.normal[c] * before[c];
        way[c] = a->slip[c] + now[c] - before[c];
        along += a->pair.normal[c] * way[c];
    }
    for (c = 0; c < 3; c++) far += (way[c] - along * a->pair.normal[c]) * (way[c] - along * a->pair.normal[c]);
    far = sqrtl(far);
    if (depth > 0) energy += 0.5L * a->pair.stiffness * depth * depth;
    if (!(was > 0) || !(a->pair.friction > 0)) return energy;
    load = a->pair.friction * a->pair.stiffness * was;
    reach = fmaxl(a->step.dt * a->pair.sticking_speed, a->pair.friction * was);
    return energy + load * (far > reach ? far - reach / 2 : far * far / (2 * reach));
}

/* Where a pair has not slid before, the Hessian of its friction is a bound: along the plane the energy is nowhere above
   what force and Hessian say. */
static void check_bound(sample *a, const gxsp_pull *pull) {
    int round, c;
    const long double there = slow_energy(a, a->end);
    for (round = 0; round < 8; round++) {
        double d[3], along = 0, model = 0, moved[3 * COPIES], scale = 0;
        gxsp_pull now;
        uint32_t k;
        for (c = 0; c < 3; c++) d[c] = 0.2 * uniform();
        for (c = 0; c < 3; c++) along += a->pair.normal[c] * d[c];
        for (c = 0; c < 3; c++) d[c] -= along * a->pair.normal[c];
        for (k = 0; k < a->pair.point.count; k++) scale += a->copy[k] == a->copy[0] ? a->weight[k] : 0;
        if (fabs(scale) < 1e-2) return;
        memcpy(moved, a->end, sizeof moved);
        for (c = 0; c < 3; c++) moved[3 * a->copy[0] + (uint32_t)c] += d[c] / scale;
        gxsp_pair_pull(&a->problem, 0, moved, &now);
        for (c = 0; c < 3; c++) model -= pull->force[c] * d[c];
        model +=
            0.5 * (pull->hessian[0] * d[0] * d[0] + pull->hessian[3] * d[1] * d[1] + pull->hessian[5] * d[2] * d[2]) +
            pull->hessian[1] * d[0] * d[1] + pull->hessian[2] * d[0] * d[2] + pull->hessian[4] * d[1] * d[2];
        assert_that((long double)now.energy <= there + (long double)model + 1e-9L, "%g %Lg %g", now.energy, there,
                    model);
    }
}

/* Energy beside the slow one; force and Hessian beside differences of energy and force, or, where friction has stuck
   so far, beside a bound; the Hessian is semi-definite; weights in single precision are exactly 0 in sum */
START_TEST(formulas_match_differences) {
    int round, k, c, m, touching = 0, sliding = 0, stuck = 0;
    for (round = 0; round < 4000 / FEWER; round++) {
        sample a;
        gxsp_pull pull;
        gxsp_system system;
        gxsp_share share[GXS_POINT_MOST];
        double gradient[3 * COPIES] = {0}, sum = 0, x[3], product;
        int sticks;
        seed((uint64_t)round);
        sample_make(&a, 2 + (uint32_t)round % (GXS_POINT_MOST - 1));
        gxsp_pair_pull(&a.problem, 0, a.end, &pull);
        sticks = a.pair.friction > 0 && a.grip.sticks;
        stuck += sticks && pull.energy > 0;
        if (sticks) check_bound(&a, &pull);
        assert_that(fabsl((long double)pull.energy - slow_energy(&a, a.end)) <= 1e-12L * (1 + slow_energy(&a, a.end)),
                    "%g %Lg", pull.energy, slow_energy(&a, a.end));
        assert_that(!pull.idle || (!(slow_energy(&a, a.end) > 0) && !(gxsp_dot(pull.force, pull.force, 1) > 0)),
                    "an idle pair has %g", pull.energy);
        touching += pull.energy > 0;
        sliding += pull.energy > 0 && a.pair.friction > 0;
        for (k = 0; k < (int)a.pair.point.count; k++)
            for (c = 0; c < 3; c++) gradient[3 * a.copy[k] + (uint32_t)c] -= a.weight[k] * pull.force[c];
        for (k = 0; k < 3 * COPIES; k++) {
            const double there = a.end[k];
            gxsp_pull up, down;
            long double difference;
            a.end[k] = there + 1e-6;
            difference = slow_energy(&a, a.end);
            gxsp_pair_pull(&a.problem, 0, a.end, &up);
            a.end[k] = there - 1e-6;
            difference -= slow_energy(&a, a.end);
            gxsp_pair_pull(&a.problem, 0, a.end, &down);
            a.end[k] = there;
            assert_that(fabsl(difference / 2e-6L - gradient[k]) < 1e-4L, "%Lg %g", difference / 2e-6L, gradient[k]);
            for (c = 0; c < 3; c++) { /* the way of r as copy k / 3 moves along k % 3 */
                double way = 0, expected;
                for (m = 0; m < (int)a.pair.point.count; m++) way += (int)a.copy[m] == k / 3 ? a.weight[m] : 0;
                expected = way * pull.hessian[gxsp_packed3(c < k % 3 ? c : k % 3, c < k % 3 ? k % 3 : c)];
                /* not across the ends of contact and of sticking, where the force has a kink */
                if (!sticks && slow_energy(&a, a.end) > 0 &&
                    fabs((down.force[c] + up.force[c]) / 2 - pull.force[c]) < 1e-9)
                    assert_that(fabs((down.force[c] - up.force[c]) / 2e-6 - expected) < 1e-3 * (1 + fabs(expected)),
                                "%g %g", (down.force[c] - up.force[c]) / 2e-6, expected);
            }
        }
        for (k = 0; k < 20; k++) {
            double y[3];
            for (c = 0; c < 3; c++) x[c] = uniform();
            y[0] = pull.hessian[0] * x[0] + pull.hessian[1] * x[1] + pull.hessian[2] * x[2];
            y[1] = pull.hessian[1] * x[0] + pull.hessian[3] * x[1] + pull.hessian[4] * x[2];
            y[2] = pull.hessian[2] * x[0] + pull.hessian[4] * x[1] + pull.hessian[5] * x[2];
            product = gxsp_dot(x, y, 1);
            assert_that(product >= -1e-12 * a.pair.stiffness, "%g", product);
        }
        memset(&system, 0, sizeof system);
        gxsp_balance_shares(&system, share, a.weight, a.pair.point.count);
        for (k = 0; k < (int)a.pair.point.count; k++) {
            sum += (double)share[k].weight;
            assert_that(fabs((double)share[k].weight - a.weight[k]) < 1e-4, "%g", a.weight[k]);
        }
        assert_that(sum == 0, "%g", sum);
    }
    ck_assert_int_gt(touching, 500 / FEWER);
    ck_assert_int_gt(sliding, 200 / FEWER);
    ck_assert_int_gt(stuck, 50 / FEWER);
}
END_TEST

/* What level 1 of the multigrid gets for a pair is not below the pair: x . added x >= x . P^T H P x. */
START_TEST(coarse_pairs_bound_the_pair) {
    const gxs_pair like = pair_like(1e6, 0);
    stack t = stack_make(8, 0.125, 0, &like);
    gxs_solver *solver = solver_of(GXS_MULTIGRID, GXS_MATRIX_FREE);
    gxsp_system *system;
    gxsp_level *next;
    int round;
    size_t i, p;
    gxsp_term *own;
    gxsp_share *shares;
    gxsp_term term;
    gxsp_share share[SPAN];
    ck_assert_int_eq(gxs_solver_set_model(solver, &t.s.model, NULL), GX_OK);
    system = solver->system;
    ck_assert(gxsp_fit_levels(system, NULL));
    ck_assert_uint_gt(system->multigrid.level_count, 1);
    own = system->lasting->term, shares = system->lasting->share;
    next = &system->multigrid.levels[1];
    for (round = 0; round < 300 / FEWER; round++) {
        double *x = (double *)zeroed(3 * next->n, sizeof *x), at[3] = {0, 0, 0}, added = 0, wanted, y[3];
        const size_t entries = next->start[next->n];
        uint32_t j, k, c, r;
        seed((uint64_t)round);
        memset(&term, 0, sizeof term);
        term.count = SPAN;
        for (k = 0; k < SPAN; k++) { /* copies of the faces, or, in every third round, any */
            share[k].copy = round % 3 ? t.copies[SPAN * ((size_t)round % t.count) + k]
                                      : (uint32_t)((double)t.half * (1 + 0.9999 * uniform()));
            share[k].weight = (float)t.weights[SPAN * ((size_t)round % t.count) + k];
            term.spread += fabsf(share[k].weight);
        }
        term.hessian[0] = 2, term.hessian[3] = 1, term.hessian[5] = 3, term.hessian[1] = 0.5f;
        system->lasting->share = share;
        memset(next->block, 0, 9 * entries * sizeof *next->block);
        gxsp_coarse_term(system, &term);
        for (i = 0; i < 3 * next->n; i++) x[i] = uniform();
        for (k = 0; k < SPAN; k++)
            for (p = 0; p < 4; p++) {
                const uint32_t node = system->multigrid.levels[0].parent[share[k].copy][p];
                for (c = 0; c < 3 && node != UINT32_MAX; c++)
                    at[c] += (double)share[k].weight * (double)system->multigrid.levels[0].weight[share[k].copy][p] *
                             x[3 * node + c];
            }
        y[0] = 2 * at[0] + 0.5 * at[1], y[1] = 0.5 * at[0] + at[1], y[2] = 3 * at[2];
        wanted = gxsp_dot(at, y, 1);
        for (i = 0; i < next->n; i++)
            for (j = next->start[i]; j < next->start[i + 1]; j++)
                for (r = 0; r < 3; r++)
                    for (c = 0; c < 3; c++)
                        added += (next->column[j] == i ? 1 : 2) * x[3 * i + r] *
                                 (double)next->block[9 * (size_t)j + 3 * r + c] * x[3 * next->column[j] + c];
        assert_that(added >= wanted - 1e-5 * (1 + wanted), "%g %g", added, wanted);
        assert_that(added <= 64 * (wanted + 30), "%g %g", added, wanted);
        free(x);
    }
    system->lasting->term = own, system->lasting->share = shares;
    gxs_solver_destroy(solver);
    stack_free(&t);
}
END_TEST

/* ---- scenes ---- */

/* Two blocks with a layer of pairs between are a column with another spring in it: reaction / that of the whole column
   = 1 / (1 + h / (c L)) for pairs of c E / h per area. Free of strain across the column, so that meshes are exact. */
START_TEST(closed_cut_carries_load) {
    static const double factors[3] = {1, 10, 100};
    static const gxs_preconditioner kinds[3] = {GXS_BLOCK_JACOBI, GXS_MULTIGRID, GXS_AUTOMATIC};
    const double h = 0.25, length = 2, young = 1e6, pushed = 1e-5;
    int which;
    for (which = 0; which < 9; which++) {
        const double c = factors[which % 3], expected = 1 / (1 + h / (c * length));
        const gxs_pair like = pair_like(c * young / h, 0);
        stack t = stack_make(4, h, 0, &like);
        gxs_solver *solver = solver_of(kinds[which / 3], which == 4 ? GXS_MATRIX_ASSEMBLED : GXS_MATRIX_FREE);
        gxs_step_desc step = step_make(1, 0);
        gxs_step_report report;
        double *targets = (double *)zeroed(6 * t.half, sizeof *targets), reaction;
        size_t i;
        t.s.material->kind = GXS_LINEAR;
        t.s.material->young = young;
        t.s.material->poisson = 0;
        for (i = 0; i < 2 * t.half; i++) {
            t.s.held[i] = t.s.rest[3 * i + 2] < 1e-9 || t.s.rest[3 * i + 2] > length - 1e-9;
            targets[3 * i + 2] = t.s.rest[3 * i + 2] > length - 1e-9 ? -pushed : 0;
        }
        step.integrator = GXS_STATIC;
        step.dt = 0;
        step.targets = targets;
        step.newton_iterations = 50;
        step.newton_tolerance = 1e-9;
        step.cg_tolerance = 1e-4;
        step.cg_iterations = 5000;
        give_pairs(&step, &t);
        ck_assert_int_eq(advance(solver, &t.s.model, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
        reaction = sum_of(t.forces, t.count, 2) / (young * pushed / length);
        assert_that(fabs(reaction / expected - 1) < 2e-4, "%g, not %g; residual %g", reaction, expected,
                    report.residual);
        gxs_solver_destroy(solver);
        free(targets);
        stack_free(&t);
    }
}
END_TEST

/* Two free blocks collide at 3 m/s: momentum to rounding whatever the tolerances, energy never above that of the start,
   no block through the other; they part again. */
START_TEST(collision_keeps_momentum) {
    const gxs_pair like = pair_like(1e8, _i ? 0.3 : 0);
    stack t = stack_make(3, 0.1, 0.02, &like);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.002, 0);
    double before[3], after[3], least = 1, start = 0;
    int frame, touched = 0;
    size_t i;
    for (i = 0; i < 2 * t.half; i++) t.s.velocity[3 * i + 2] = i < t.half ? 1.5 : -1.5;
    for (i = 0; i < 2 * t.half; i++) t.s.velocity[3 * i] = _i && i < t.half ? 1 : 0;
    give_pairs(&step, &t);
    step.newton_iterations = 2;
    step.cg_tolerance = 0.1;
    momentum(&t.s, before);
    ck_assert_int_eq(gxs_solver_set_model(solver, &t.s.model, NULL), GX_OK);
    for (frame = 0; frame < 60; frame++) {
        double energy = 0, *mv = (double *)zeroed(6 * t.half, sizeof *mv);
        ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, NULL, NULL), GX_OK);
        momentum(&t.s, after);
        for (i = 0; i < 3; i++) assert_that(fabs(after[i] - before[i]) < 1e-10, "%d: %g", frame, after[i] - before[i]);
        form_mass_product(&t.s.model, t.s.velocity, mv);
        for (i = 0; i < 6 * t.half; i++) energy += 0.5 * mv[i] * t.s.velocity[i];
        energy += form_energy(&t.s.model, t.s.displacement);
        free(mv);
        if (frame == 0) start = energy;
        assert_that(energy <= start * (1 + 1e-9), "%d: %g %g", frame, energy, start);
        touched += sum_of(t.forces, t.count, 2) > 0;
        least = fmin(least, mean_above(&t, t.s.displacement, 2) + 0.02);
    }
    ck_assert_int_gt(touched, 0);
    ck_assert_int_lt(touched, 55);
    ck_assert(mean_above(&t, t.s.velocity, 2) > 0.3);
    gxs_solver_destroy(solver);
    stack_free(&t);
}
END_TEST

/* A block on a held one under gravity that leans by 20 degrees. Below the angle of friction it slides with the
   acceleration of Coulomb's law; above it sticks, if slips are kept, and creeps if not. */
static double lean(double friction, int frames, int kept, double *middle, double *speed) {
    const double angle = 20 * 3.14159265358979 / 180;
    const gxs_pair like = pair_like(1e8, friction);
    stack t = stack_make(2, 0.1, 0, &like);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.005, -9.81 * cos(angle));
    double end;
    int frame;
    size_t i;
    for (i = 0; i < t.half; i++) t.s.held[i] = 1;
    step.gravity[0] = 9.81 * sin(angle);
    step.newton_iterations = 8;
    step.cg_tolerance = 1e-3;
    give_pairs(&step, &t);
    if (!kept) step.pair_slips = NULL;
    ck_assert_int_eq(gxs_solver_set_model(solver, &t.s.model, NULL), GX_OK);
    for (frame = 0; frame < frames; frame++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, NULL, NULL), GX_OK);
        if (2 * (frame + 1) == frames) {
            *middle = mean_above(&t, t.s.displacement, 0);
            *speed = mean_above(&t, t.s.velocity, 0);
        }
    }
    end = mean_above(&t, t.s.displacement, 0) - *middle;
    *speed = mean_above(&t, t.s.velocity, 0) - *speed;
    gxs_solver_destroy(solver);
    stack_free(&t);
    return end;
}

START_TEST(blocks_slide_and_stick) {
    const double angle = 20 * 3.14159265358979 / 180, expected = 9.81 * (sin(angle) - 0.2 * cos(angle));
    double middle, gained, way;
    (void)lean(0.2, 80, 1, &middle, &gained);
    assert_that(fabs(gained / (40 * 0.005) / expected - 1) < 0.01, "%g %g", gained / (40 * 0.005), expected);
    way = lean(1.05 * tan(angle), 160, 1, &middle, &gained);
    assert_that(fabs(way) < 1e-6, "%g", way);
    way = lean(1.05 * tan(angle), 160, 0, &middle, &gained);
    assert_that(way > 1e-4, "%g", way);
}
END_TEST

/* What a caller keeps of a sticking contact: a new solver goes on with the same forces, bit by bit with one that was
   resumed in the same scene; without the slips the block gives way. */
START_TEST(slips_continue) {
    const gxs_pair like = pair_like(1e8, 0.5);
    stack t = stack_make(2, 0.1, 0, &like);
    gxs_step_desc step = step_make(0.005, -9.81);
    gxs_scene scene_before;
    double *states[3], held, gave;
    const size_t count = 6 * t.half;
    gxs_solver *solver = solver_make();
    int frame, run;
    size_t i;
    for (i = 0; i < t.half; i++) t.s.held[i] = 1;
    step.gravity[0] = 3;
    step.newton_iterations = 10;
    give_pairs(&step, &t);
    ck_assert_int_eq(gxs_solver_set_model(solver, &t.s.model, NULL), GX_OK);
    for (frame = 0; frame < 100; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, NULL, NULL), GX_OK);
    held = sum_of(t.forces, t.count, 0);
    assert_that(fabs(held / (-3 * 1000 * 0.008) - 1) < 1e-3, "%g", held);
    gxs_solver_scene(solver, &scene_before);
    gxs_solver_resume(solver, &scene_before);
    for (run = 0; run < 3; run++) {
        gxs_solver *other = run == 0 ? solver : solver_make();
        double *slips = (double *)zeroed(3 * t.count, sizeof *slips);
        states[run] = (double *)zeroed(2 * count, sizeof(double));
        memcpy(states[run], t.s.displacement, count * sizeof(double));
        memcpy(states[run] + count, t.s.velocity, count * sizeof(double));
        if (run < 2) memcpy(slips, t.slips, 3 * t.count * sizeof *slips);
        step.pair_slips = slips;
        if (run > 0) {
            ck_assert_int_eq(gxs_solver_set_model(other, &t.s.model, NULL), GX_OK);
            gxs_solver_resume(other, &scene_before);
        }
        ck_assert_int_eq(gxs_solver_step(other, &step, states[run], states[run] + count, NULL, NULL), GX_OK);
        for (i = t.half, gave = 0; i < t.half + 9; i++) /* at the upper block's foot */
            gave += (states[run][3 * i] - t.s.displacement[3 * i]) / 9;
        assert_that(fabs(sum_of(t.forces, t.count, 0) / held - 1) < (run < 2 ? 1e-3 : 0.2), "%g",
                    sum_of(t.forces, t.count, 0));
        assert_that(run < 2 ? fabs(gave) < 1e-8 : fabs(gave / (-held / (like.stiffness * 0.04)) - 1) < 0.2, "%g", gave);
        free(slips);
        if (run > 0) gxs_solver_destroy(other);
    }
    ck_assert_int_eq(memcmp(states[0], states[1], 2 * count * sizeof(double)), 0);
    ck_assert_int_ne(memcmp(states[0], states[2], 2 * count * sizeof(double)), 0);
    for (run = 0; run < 3; run++) free(states[run]);
    gxs_solver_destroy(solver);
    stack_free(&t);
}
END_TEST

/* The preconditioner that the solver chooses for the second step of two blocks */
static gxs_preconditioner choice(double young, int paired) {
    const gxs_pair like = pair_like(10 * young / 0.1, 0.3);
    stack t = stack_make(8, 0.1, -1e-5, &like);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(1.0 / 60, -9.81);
    gxs_step_report report;
    size_t i;
    t.s.material->young = young;
    for (i = 0; i < 81; i++) t.s.held[i] = 1, t.s.held[t.half + i] = !paired;
    if (paired) give_pairs(&step, &t);
    ck_assert_int_eq(gxs_solver_set_model(solver, &t.s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, NULL, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
    ck_assert(!paired || sum_of(t.forces, t.count, 2) > 0);
    gxs_solver_destroy(solver);
    stack_free(&t);
    return report.preconditioner;
}

/* Coarse levels do little for pairs, so block-Jacobi serves longer. */
START_TEST(pairs_choose_the_preconditioner) {
    ck_assert_int_eq(choice(1e6, 0), GXS_MULTIGRID);
    ck_assert_int_eq(choice(1e6, 1), GXS_BLOCK_JACOBI);
    ck_assert_int_eq(choice(1e8, 1), GXS_MULTIGRID);
}
END_TEST

/* ---- sleep ---- */

/* A block on another one falls asleep though its pairs come and go from step to step. A knock wakes both; so does the
   loss of all pairs. */
START_TEST(stacks_sleep) {
    const gxs_pair like = pair_like(1e8, 0.3);
    stack t = stack_make(2, 0.1, 0, &like);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.01, -9.81);
    gxs_step_report report;
    double *rests = (double *)zeroed(2 * t.half, sizeof *rests), height;
    int frame;
    size_t i;
    for (i = 0; i < 9; i++) t.s.held[i] = 1; /* the ground's layer */
    step.newton_iterations = 5;
    step.sleep_speed = 0.01;
    step.rest_times = rests;
    give_pairs(&step, &t);
    memset(&report, 0, sizeof report);
    ck_assert_int_eq(gxs_solver_set_model(solver, &t.s.model, NULL), GX_OK);
    for (frame = 0; frame < 300 && report.stop != GXS_STOP_ASLEEP; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
    assert_that(frame < 200, "%d", frame);
    height = mean_above(&t, t.s.displacement, 2);
    for (frame = 0; frame < 10; frame++) { /* other pairs wake nothing */
        step.pair_count = t.count - (size_t)frame;
        ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
        ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
        assert_that(fabs(sum_of(t.forces, t.count, 2) / (9.81 * 8) - 1) < 0.02, "%g", sum_of(t.forces, t.count, 2));
    }
    step.pair_count = t.count;
    for (i = t.half; i < 2 * t.half; i++) t.s.velocity[3 * i] = 0.2;
    ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 3 * (2 * t.half - 9));
    for (frame = 0; frame < 300 && report.stop != GXS_STOP_ASLEEP; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
    ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    step.pair_count = 0;
    for (frame = 0; frame < 5; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
    assert_that(mean_above(&t, t.s.displacement, 2) < height - 0.005, "%g", mean_above(&t, t.s.displacement, 2));
    gxs_solver_destroy(solver);
    free(rests);
    stack_free(&t);
}
END_TEST

/* ---- jobs, memory ---- */

typedef struct worker {
    void (*task)(void *, size_t);
    void *context;
    size_t begin, end, step;
} worker;

static void *work(void *argument) {
    worker *w = (worker *)argument;
    size_t i;
    for (i = w->begin; i < w->end; i += w->step) w->task(w->context, i);
    return NULL;
}

static void threads(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    size_t workers = *(const size_t *)user, k;
    worker w[3];
    pthread_t id[3];
    for (k = 0; k < workers; k++) {
        w[k].task = task, w[k].context = context, w[k].begin = k, w[k].end = count, w[k].step = workers;
        ck_assert_int_eq(pthread_create(&id[k], NULL, work, &w[k]), 0);
    }
    for (k = 0; k < workers; k++) ck_assert_int_eq(pthread_join(id[k], NULL), 0);
}

START_TEST(workers_do_not_change_results) {
    double *first = NULL;
    size_t workers;
    for (workers = 1; workers <= 3; workers++) {
        const gxs_pair like = pair_like(1e8, 0.3);
        stack t = stack_make(6, 0.1, 0.001, &like);
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        gxs_step_desc step = step_make(0.01, -9.81);
        const size_t count = 6 * t.half;
        int frame;
        size_t i;
        memset(&desc, 0, sizeof desc);
        desc.jobs.parallel_for = threads;
        desc.jobs.user = &workers;
        desc.preconditioner = _i ? GXS_MULTIGRID : GXS_AUTOMATIC;
        for (i = 0; i < 49; i++) t.s.held[i] = 1;
        for (i = t.half; i < 2 * t.half; i++) t.s.velocity[3 * i] = 0.3;
        give_pairs(&step, &t);
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_set_model(solver, &t.s.model, NULL), GX_OK);
        for (frame = 0; frame < 10; frame++)
            ck_assert_int_eq(gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, NULL, NULL), GX_OK);
        ck_assert(sum_of(t.forces, t.count, 2) > 0);
        if (!first) {
            first = (double *)zeroed(count + 3 * t.count, sizeof *first);
            memcpy(first, t.s.displacement, count * sizeof *first);
            memcpy(first + count, t.slips, 3 * t.count * sizeof *first);
        }
        ck_assert_int_eq(memcmp(first, t.s.displacement, count * sizeof *first), 0);
        ck_assert_int_eq(memcmp(first + count, t.slips, 3 * t.count * sizeof *first), 0);
        gxs_solver_destroy(solver);
        stack_free(&t);
    }
    free(first);
}
END_TEST

/* Explicit steps know no pairs: they are backward Euler, bit by bit. */
START_TEST(explicit_steps_with_pairs_are_implicit) {
    const gxs_pair like = pair_like(1e8, 0.3);
    double *first = NULL;
    int run;
    for (run = 0; run < 2; run++) {
        stack t = stack_make(2, 0.1, -0.001, &like);
        gxs_solver *solver = solver_make();
        gxs_step_desc step = step_make(0.001, -9.81);
        gxs_step_report report;
        give_pairs(&step, &t);
        step.integrator = run ? GXS_EXPLICIT : GXS_BDF1;
        ck_assert_int_eq(advance(solver, &t.s.model, &step, t.s.displacement, t.s.velocity, &report, NULL), GX_OK);
        ck_assert_uint_eq(report.substeps, 0);
        ck_assert(sum_of(t.forces, t.count, 2) > 0);
        if (!first) {
            first = (double *)zeroed(6 * t.half, sizeof *first);
            memcpy(first, t.s.displacement, 6 * t.half * sizeof *first);
        }
        ck_assert_int_eq(memcmp(first, t.s.displacement, 6 * t.half * sizeof *first), 0);
        gxs_solver_destroy(solver);
        stack_free(&t);
    }
    free(first);
}
END_TEST

/* A step with more pairs than before. Returns whether an allocation failed; state, slips and forces are as before
   then. */
static int run_with(memory *m, int which) {
    const gxs_pair like = pair_like(1e8, 0.3);
    stack t = stack_make(1, 0.1, -0.001, &like);
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gxs_step_desc step = step_make(0.01, -9.81);
    gx_result result;
    (void)which;
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator_of(m);
    give_pairs(&step, &t);
    t.slips[0] = 1e-6;
    result = gxs_solver_create(&desc, &solver, NULL);
    if (result == GX_OK) result = gxs_solver_set_model(solver, &t.s.model, NULL);
    if (result == GX_OK) result = gxs_solver_step(solver, &step, t.s.displacement, t.s.velocity, NULL, NULL);
    ck_assert(result == GX_OK || result == GX_ERROR_MEMORY);
    if (result != GX_OK) ck_assert(t.s.displacement[2] == 0 && t.slips[0] == 1e-6 && t.forces[2] == 0);
    if (solver) gxs_solver_destroy(solver);
    stack_free(&t);
    return result != GX_OK;
}

START_TEST(every_allocation_may_fail) { sweep_allocations(run_with, 0); }
END_TEST

/* ---- input ---- */

static void expect(void (*change)(stack *, gxs_step_desc *), gx_result result, const char *field, size_t index) {
    const gxs_pair like = pair_like(1e6, 0.3);
    stack t = stack_make(1, 0.1, 0, &like);
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.01, -9.81);
    gx_failure failure;
    give_pairs(&step, &t);
    change(&t, &step);
    ck_assert_int_eq(advance(solver, &t.s.model, &step, t.s.displacement, t.s.velocity, NULL, &failure), result);
    if (result != GX_OK) {
        ck_assert_pstr_eq(failure.field, field);
        ck_assert_uint_eq(failure.index, index);
        ck_assert(t.s.displacement[2] == 0 && t.s.velocity[2] == 0);
    }
    gxs_solver_destroy(solver);
    stack_free(&t);
}

static double nan_value(void) { return not_a_number(0); }

/* A function of a stack t and a step that does one thing */
#define CHANGE(name, what)                                                                                             \
    static void name(stack *t, gxs_step_desc *step) {                                                                  \
        (void)t, (void)step;                                                                                           \
        what;                                                                                                          \
    }
CHANGE(nothing, (void)0)
CHANGE(no_array, step->pairs = NULL)
CHANGE(midpoint, step->integrator = GXS_MIDPOINT)
CHANGE(count_0, t->pairs[2].point.count = 0)
CHANGE(count_33, t->pairs[2].point.count = GXS_POINT_MOST + 1)
CHANGE(no_weights, t->pairs[2].point.weights = NULL)
CHANGE(bad_copy, t->copies[SPAN + 1] = (uint32_t)(2 * t->half))
CHANGE(bad_sum, t->weights[SPAN * 3] += 1e-9)
CHANGE(rounded_sum, t->weights[SPAN * 3] += 1e-15)
CHANGE(bad_weight, t->weights[SPAN * 3] = nan_value())
CHANGE(huge_weights, t->weights[0] = 1e200; t->weights[3] = -1e200)
CHANGE(bad_position, t->pairs[1].point.position[0] = nan_value())
CHANGE(stale, t->pairs[1].point.epoch = 1)
CHANGE(long_normal, t->pairs[4].normal[1] = 0.1)
CHANGE(bad_normal, t->pairs[4].normal[1] = nan_value())
CHANGE(bad_offset, t->pairs[5].offset = nan_value())
CHANGE(negative_stiffness, t->pairs[5].stiffness = -1)
CHANGE(bad_stiffness, t->pairs[5].stiffness = nan_value())
CHANGE(negative_friction, t->pairs[0].friction = -0.1)
CHANGE(negative_speed, t->pairs[0].sticking_speed = -0.1)
CHANGE(bad_slip, t->slips[4] = nan_value())
CHANGE(wrong_flags, t->pairs[2].flags = 4)
CHANGE(bad_way, t->pairs[1].way[2] = nan_value())
CHANGE(two_sides, t->pairs[3].flags = GXS_PAIR_OUTSIDE)
CHANGE(one_side, t->pairs[3].flags = GXS_PAIR_OUTSIDE | GXS_PAIR_WAKES; t->pairs[3].point.count = 3)
CHANGE(zero_weights, memset(t->weights, 0, SPAN * sizeof *t->weights))

START_TEST(bad_input_is_named) {
    expect(nothing, GX_OK, NULL, 0);
    expect(rounded_sum, GX_OK, NULL, 0);
    expect(zero_weights, GX_OK, NULL, 0);
    expect(no_array, GX_ERROR_ARGUMENT, "pairs", SIZE_MAX);
    expect(midpoint, GX_ERROR_ARGUMENT, "pairs", SIZE_MAX);
    expect(count_0, GX_ERROR_ARGUMENT, "pairs.point.count", 2);
    expect(count_33, GX_ERROR_LIMIT, "pairs.point.count", 2);
    expect(no_weights, GX_ERROR_ARGUMENT, "pairs.point.weights", 2);
    expect(bad_copy, GX_ERROR_INDEX, "pairs.point.copies", 1);
    expect(bad_sum, GX_ERROR_ARGUMENT, "pairs.point.weights", 3);
    expect(bad_weight, GX_ERROR_NOT_FINITE, "pairs.point.weights", 3);
    expect(huge_weights, GX_ERROR_RANGE, "pairs.point.weights", 0);
    expect(bad_position, GX_ERROR_NOT_FINITE, "pairs.point.position", 1);
    expect(stale, GX_ERROR_STALE, "pairs.point.epoch", 1);
    expect(long_normal, GX_ERROR_ARGUMENT, "pairs.normal", 4);
    expect(bad_normal, GX_ERROR_NOT_FINITE, "pairs.normal", 4);
    expect(bad_offset, GX_ERROR_NOT_FINITE, "pairs.offset", 5);
    expect(negative_stiffness, GX_ERROR_ARGUMENT, "pairs.stiffness", 5);
    expect(bad_stiffness, GX_ERROR_NOT_FINITE, "pairs.stiffness", 5);
    expect(negative_friction, GX_ERROR_ARGUMENT, "pairs.friction", 0);
    expect(negative_speed, GX_ERROR_ARGUMENT, "pairs.sticking_speed", 0);
    expect(wrong_flags, GX_ERROR_ARGUMENT, "pairs.flags", 2);
    expect(bad_way, GX_ERROR_NOT_FINITE, "pairs.way", 1);
    expect(two_sides, GX_ERROR_ARGUMENT, "pairs.point.weights", 3);
    expect(one_side, GX_OK, NULL, 0);
    expect(bad_slip, GX_ERROR_NOT_FINITE, "pair_slips", 1);
}
END_TEST

static Suite *pair_suite(void) {
    Suite *suite = suite_create("pair_terms");
    TCase *pairs = tcase_create("pairs");
    tcase_add_test(pairs, formulas_match_differences);
    tcase_add_test(pairs, coarse_pairs_bound_the_pair);
    tcase_add_test(pairs, closed_cut_carries_load);
    tcase_add_loop_test(pairs, collision_keeps_momentum, 0, 2);
    tcase_add_test(pairs, blocks_slide_and_stick);
    tcase_add_test(pairs, slips_continue);
    tcase_add_test(pairs, pairs_choose_the_preconditioner);
    tcase_add_test(pairs, stacks_sleep);
    tcase_add_loop_test(pairs, workers_do_not_change_results, 0, 2);
    tcase_add_test(pairs, explicit_steps_with_pairs_are_implicit);
    tcase_add_test(pairs, every_allocation_may_fail);
    tcase_add_test(pairs, bad_input_is_named);
    tcase_set_timeout(pairs, 120);
    suite_add_tcase(suite, pairs);
    return suite;
}

int main(void) { return run_suite(pair_suite()); }
