/* test_updates.c - a cut changes the solver's model instead of making it again (gxs_solver_update). The motion is
   the same as with a model that is set whole after each cut, with no more iterations, the same bits in any order of
   jobs and after a save. Sleepers wake. Bad changes, memory that runs out. The size of solvers. Coarse functions of
   small components. The same for models with affine copies. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"

enum { BLOCK = 6 }; /* cells along an edge: enough copies for multigrid */

static void hold_top(gx_body *body) {
    const gx_region top = gx_region_half_space(2, 1, BLOCK - 1e-9);
    ck_assert_int_eq(gx_body_hold(body, &top, 1, NULL), GX_OK);
}

static gx_step_desc step_of(double dt) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[0] = 1;
    step.gravity[2] = -9.81;
    return step;
}

/* Steps to balance, so that two ways to the same step end alike */
static gx_step_desc exact_step(double dt) {
    gx_step_desc step = step_of(dt);
    step.newton_iterations = 60;
    step.newton_tolerance = 1e-11;
    step.cg_tolerance = 1e-4;
    return step;
}

static uint32_t advance(gx_body *body, const gx_step_desc *step, int steps) {
    gxs_step_report report;
    gx_failure failure;
    uint32_t iterations = 0;
    while (steps-- > 0) {
        gx_result result = gx_body_step(body, step, &report, &failure);
        ck_assert_msg(result == GX_OK, "%s at %zu", gx_result_text(result), failure.index);
        iterations += report.cg_iterations;
    }
    return iterations;
}

/* Difference of displacements relative to these, both by the mass. The place of a copy of 1e-60 of its element's
   mass is beyond doubles. */
static double apart(gx_body *a, gx_body *b) {
    const gx_view of = view_of(a), to = view_of(b);
    const double *mass = a->solver->system->model.lumped;
    double most = 0, gap = 0;
    size_t i;
    ck_assert_uint_eq(of.copy_count, to.copy_count);
    for (i = 0; i < 3 * of.copy_count; i++) {
        const double d = of.displacement[i] - to.displacement[i];
        most += mass[i / 3] * of.displacement[i] * of.displacement[i];
        gap += mass[i / 3] * d * d;
    }
    return sqrt(gap / most);
}

static int same_bits(gx_body *a, gx_body *b) {
    const gx_view of = view_of(a), to = view_of(b);
    return of.copy_count == to.copy_count &&
           memcmp(of.displacement, to.displacement, 3 * of.copy_count * sizeof(double)) == 0 &&
           memcmp(of.velocity, to.velocity, 3 * of.copy_count * sizeof(double)) == 0;
}

/* A quad across z, in x from low to high */
static void add_strip(workload *w, double z, double low, double high) {
    const double a[3] = {low, -1, z}, b[3] = {high, -1, z}, c[3] = {high, BLOCK + 1, z}, d[3] = {low, BLOCK + 1, z};
    wl_add_quad(wl_add_surface(w, 0), a, b, c, d);
}

/* Cuts of a block: strips that grow together, sheets that end inside and cross, holes, planes that divide it, a cut
   through nodes */
static void add_cuts(workload *w) {
    const double p[3] = {3.1, 2.9, 3.3}, n[3] = {1, 0.3, 0.2}, q[3] = {2.13, 4.21, 1.93}, m[3] = {0.1, 1, 0.4};
    int i;
    for (i = 0; i < 4; i++) add_strip(w, 2.37, i - 0.63, i + 0.37);
    add_plane(w, p, n, 1.2);
    add_plane(w, q, m, 0.7);
    add_box(w, 1, 1.2, 1.3, 3.1, 2.6, 2.2, 4.4);
    add_strip(w, 2.37, 3.37, 8);
    add_plane(w, q, n, 20);
    add_axis_plane(w, 1, 3);
    add_random_plane(w, 2);
    add_random_plane(w, 2);
}

static workload block_with_cuts(uint64_t seed) {
    workload w = grid(BLOCK, BLOCK, BLOCK, seed % 2 ? 6 : 5);
    random_seed(seed);
    add_cuts(&w);
    return w;
}

/* The operator of a changed model equals that of one set whole, to the precision that single precision leaves to
   other orders */
static void check_operator(gx_body *changed, gx_body *whole) {
    const gx_view view = view_of(changed);
    const size_t n = 3 * view.copy_count;
    double *x = (double *)calloc(3 * n, sizeof *x), *y = x + n, *z = x + 2 * n, most = 0;
    size_t i;
    for (i = 0; i < n; i++) x[i] = sin(0.37 * (double)(i * i % 1009));
    ck_assert_int_eq(gxs_solver_product(changed->solver, x, y, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gxs_solver_linearise(changed->solver, view.displacement, 100, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_linearise(whole->solver, view.displacement, 100, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(changed->solver, x, y, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(whole->solver, x, z, NULL), GX_OK);
    for (i = 0; i < n; i++) most = fabs(z[i]) > most ? fabs(z[i]) : most;
    for (i = 0; i < n; i++) ck_assert_msg(fabs(y[i] - z[i]) <= 1e-6 * most, "%g and %g", y[i], z[i]);
    free(x);
}

/* The flags of blocks are right: which corners differ from those of the block before, which lanes have no element.
   Returns how many corners of a block differ from those of the one before, on average. */
static double check_lanes(gx_body *body) {
    const gxsp_system *system = body->solver->system;
    const uint32_t lanes = (uint32_t)(sizeof(gxsp_singles) / sizeof(float));
    size_t blocks = 0, fresh = 0;
    uint32_t c, b, i, l;
    gxs_model model;
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert(memcmp(model.positions, system->model.positions, 3 * model.copy_count * sizeof(double)) == 0);
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const gxsp_chunk *chunk = &system->mesh.chunks[c];
        ck_assert_uint_eq(chunk->changed[chunk->block_count], 15);
        ck_assert_ptr_null(chunk->gradients); /* of no element of a body */
        blocks += chunk->block_count;
        for (b = 0; b < chunk->block_count; b++)
            for (i = 0; i < 4; i++) {
                const uint16_t *node = chunk->corners[b].node[i];
                const int differs = b == 0 || memcmp(node, chunk->corners[b - 1].node[i], lanes * sizeof *node) != 0;
                ck_assert_int_eq(chunk->changed[b] >> i & 1, differs);
                fresh += (size_t)differs;
                for (l = 0; l < lanes; l++) {
                    ck_assert_uint_lt(node[l], chunk->node_count);
                    ck_assert(chunk->groups[b * lanes + l] != UINT32_MAX || !(chunk->rest[b].weight[l] > 0));
                }
            }
    }
    return (double)fresh / (double)blocks;
}

/* ---- the same motion ---- */

START_TEST(cuts_change_the_model) {
    workload w = block_with_cuts((uint64_t)_i);
    gx_body *changed = body_of(&w), *whole = body_of(&w);
    gx_step_desc step = exact_step(0.02);
    size_t c, updates = 0, followers = 0;
    hold_top(changed);
    hold_top(whole);
    advance(changed, &step, 2);
    advance(whole, &step, 2);
    for (c = 0; c < w.surface_count; c++) {
        cut_by(changed, &w, c, 1);
        cut_by(whole, &w, c, 1);
        hold_top(whole);          /* so that its model is set whole */
        if (c % 3 == 1) continue; /* two cuts before a step */
        advance(changed, &step, 2);
        advance(whole, &step, 2);
        updates += changed->model.updated != 0;
        ck_assert(!whole->model.updated);
        ck_assert_uint_eq(changed->solver->system->model.follower_count, whole->solver->system->model.follower_count);
        ck_assert_uint_eq(changed->solver->system->model.light_count, whole->solver->system->model.light_count);
        followers += changed->model.updated ? changed->solver->system->model.follower_count : 0;
        ck_assert_msg(apart(changed, whole) < 1e-6, "after cut %zu: %g", c, apart(changed, whole));
        check_operator(changed, whole);
        check_lanes(changed);
        ck_assert_double_lt(check_lanes(whole), 2.5);
    }
    ck_assert_uint_gt(updates, 3);
    ck_assert_uint_gt(followers, 0);
    gx_body_destroy(changed);
    gx_body_destroy(whole);
    wl_free(&w);
}
END_TEST

/* BDF2, damping and a material other than the default: the model keeps data of several kinds. */
START_TEST(changed_models_are_of_any_kind) {
    static const gxs_material_kind kinds[4] = {GXS_ST_VENANT_KIRCHHOFF, GXS_FIXED_COROTATED, GXS_LINEAR,
                                               GXS_STABLE_NEO_HOOKEAN};
    workload w = block_with_cuts(2);
    gx_body_desc desc = desc_of(&w);
    gx_material materials[2];
    uint32_t *which = (uint32_t *)calloc(w.element_count, sizeof *which);
    gx_body *changed = NULL, *whole = NULL;
    gx_step_desc step = exact_step(0.01);
    size_t c;
    memset(materials, 0, sizeof materials);
    materials[0].elastic.kind = kinds[_i];
    materials[0].elastic.young = 2e6;
    materials[0].elastic.poisson = 0.3;
    materials[0].density = 1000;
    materials[0].elastic.damping = 1e-3;
    materials[1] = materials[0];
    materials[1].elastic.kind = GXS_STABLE_NEO_HOOKEAN;
    materials[1].elastic.young = 5e6;
    for (c = 0; c < w.element_count; c++) which[c] = c / 7 % 2;
    desc.materials = materials;
    desc.material_count = 2;
    desc.element_materials = which;
    step.integrator = GXS_BDF2;
    ck_assert_int_eq(gx_body_create(&desc, &changed, NULL), GX_OK);
    ck_assert_int_eq(gx_body_create(&desc, &whole, NULL), GX_OK);
    hold_top(changed);
    hold_top(whole);
    advance(changed, &step, 2);
    advance(whole, &step, 2);
    for (c = 0; c < 6; c++) {
        cut_by(changed, &w, c, 1);
        cut_by(whole, &w, c, 1);
        hold_top(whole);
        advance(changed, &step, 1);
        advance(whole, &step, 1);
        ck_assert(changed->model.updated);
        ck_assert_msg(apart(changed, whole) < 1e-6, "after cut %zu: %g", c, apart(changed, whole));
    }
    gx_body_destroy(changed);
    gx_body_destroy(whole);
    free(which);
    wl_free(&w);
}
END_TEST

/* Largest difference of the numbers of level 1, relative to the largest of both rows */
static double coarse_difference(const gxsp_level *level, const float *block) {
    uint32_t i, k;
    double most = 0;
    int m;
    for (i = 0; i < level->n; i++)
        for (k = level->start[i]; k < level->start[i + 1]; k++) {
            const float *own = block + 9 * (size_t)level->start[i],
                        *other = block + 9 * (size_t)level->start[level->column[k]];
            const double size = sqrt((double)(own[0] + own[4] + own[8]) * (double)(other[0] + other[4] + other[8]));
            for (m = 0; m < 9; m++)
                most = fmax(most,
                            fabs((double)(level->block[9 * (size_t)k + (size_t)m] - block[9 * (size_t)k + (size_t)m])) /
                                size);
        }
    return most;
}

/* A long beam, and three strips that cut its end */
static workload beam_with_cuts(uint32_t per_cell) {
    workload w = grid(40, 4, 4, per_cell);
    size_t c;
    for (c = 0; c < 3; c++) {
        const double x = 39 - (double)c - 0.37, a[3] = {x, -1, 2.23}, b[3] = {x + 1, -1, 2.23}, d[3] = {x + 1, 5, 2.23},
                     e[3] = {x, 5, 2.23};
        wl_add_quad(wl_add_surface(&w, 0), a, b, d, e);
    }
    return w;
}

static gx_body *held_beam(workload *w) {
    const gx_region left = gx_region_half_space(0, -1, 1e-9);
    gx_body *body = body_of(w);
    ck_assert_int_eq(gx_body_hold(body, &left, 1, NULL), GX_OK);
    return body;
}

/* A cut at one end of a long body: coarse numbers are made again there, at the state of those that stay. They equal
   the numbers of a model whose numbers are all made at that state. */
START_TEST(small_cuts_keep_coarse_numbers) {
    workload w = beam_with_cuts(5 + (uint32_t)(_i % 2));
    gx_step_desc step = step_of(0.2);
    gx_body *body = held_beam(&w);
    size_t c;
    advance(body, &step, 3);
    for (c = 0; c < w.surface_count; c++) {
        gxsp_system *system = body->solver->system;
        const double before[3] = {system->coarse.displacement[3], system->coarse.displacement[4],
                                  system->coarse.displacement[5]};
        const gxsp_level *level = &system->multigrid.levels[1];
        size_t bytes;
        float *block;
        int collapsed;
        ck_assert_uint_gt(system->multigrid.level_count, 1);
        cut_by(body, &w, c, 1);
        advance(body, &step, 1);
        ck_assert(body->model.updated);
        ck_assert(memcmp(before, system->coarse.displacement + 3, sizeof before) == 0); /* no step has made them */
        ck_assert(system->coarse.rate > 0);
        bytes = 9 * (size_t)level->start[level->n] * sizeof *block;
        block = (float *)malloc(bytes);
        memcpy(block, level->block, bytes);
        ck_assert(gxsp_linearise(system, system->coarse.rate, system->coarse.displacement, 0, &collapsed));
        ck_assert(gxsp_coarse_numbers(system, system->coarse.rate));
        ck_assert_msg(coarse_difference(level, block) < 3e-5, "cut %zu: %g", c, coarse_difference(level, block));
        free(block);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Steps that take block-Jacobi make no levels, and bring none up to date. The first solve that uses levels does, and
   has the bits that it has where that is done before the step. */
START_TEST(levels_are_made_where_they_serve) {
    workload w = beam_with_cuts(5 + (uint32_t)(_i % 2));
    const gx_step_desc fast = step_of(1e-4), slow = step_of(0.2);
    gx_body *body = held_beam(&w), *twin = held_beam(&w);
    const gxsp_multigrid *levels;
    gxs_step_report report;
    size_t c;
    ck_assert_int_eq(gx_body_step(body, &fast, &report, NULL), GX_OK);
    ck_assert_int_eq(report.preconditioner, GXS_BLOCK_JACOBI);
    levels = &body->solver->system->multigrid;
    ck_assert_uint_eq(levels->level_count, 0);
    advance(twin, &fast, 1);
    ck_assert(gxsp_fit_levels(twin->solver->system, NULL));
    for (c = 0; c < w.surface_count; c++) {
        gxsp_pool before;
        ck_assert_int_eq(gx_body_step(body, &slow, &report, NULL), GX_OK);
        ck_assert_int_eq(report.preconditioner, GXS_MULTIGRID);
        ck_assert(levels->level_count > 1 && levels->fits);
        advance(twin, &slow, 1);
        ck_assert(same_bits(body, twin));
        advance(body, &slow, 2);
        advance(twin, &slow, 2);
        before = levels->pool;
        cut_by(body, &w, c, 1);
        cut_by(twin, &w, c, 1);
        if (c == 1) { /* block-Jacobi right after the cut */
            ck_assert_int_eq(gx_body_step(body, &fast, &report, NULL), GX_OK);
            ck_assert_int_eq(report.preconditioner, GXS_BLOCK_JACOBI);
            ck_assert(!levels->fits && levels->pool.last == before.last);
        }
        ck_assert_int_eq(gxp_update_model(twin, NULL), GX_OK);
        ck_assert(gxsp_fit_levels(twin->solver->system, NULL));
        ck_assert(twin->solver->system->multigrid.fits && twin->model.updated);
        if (c == 1) advance(twin, &fast, 1);
        ck_assert(same_bits(body, twin));
    }
    gx_body_destroy(body);
    gx_body_destroy(twin);
    wl_free(&w);
}
END_TEST

/* One Newton iteration a step, as in a game: the kept preconditioner is worth as much as a new one. */
START_TEST(changed_models_take_no_more_iterations) {
    workload w = grid(12, 12, 12, 5);
    gx_body *changed, *whole;
    const gx_region top = gx_region_half_space(2, 1, 12 - 1e-9);
    gx_step_desc step = step_of(0.033);
    uint32_t by_change = 0, by_whole = 0;
    double x;
    size_t c;
    for (x = -0.63; x < 9; x += 1) {
        const double a[3] = {x, -1, 5.47}, b[3] = {x + 1, -1, 5.47}, d[3] = {x + 1, 13, 5.47}, e[3] = {x, 13, 5.47};
        wl_add_quad(wl_add_surface(&w, 0), a, b, d, e);
    }
    changed = body_of(&w);
    whole = body_of(&w);
    ck_assert_int_eq(gx_body_hold(changed, &top, 1, NULL), GX_OK);
    ck_assert_int_eq(gx_body_hold(whole, &top, 1, NULL), GX_OK);
    advance(changed, &step, 4);
    advance(whole, &step, 4);
    for (c = 0; c < w.surface_count; c++) {
        cut_by(changed, &w, c, 1);
        cut_by(whole, &w, c, 1);
        ck_assert_int_eq(gx_body_hold(whole, &top, 1, NULL), GX_OK);
        by_change += advance(changed, &step, 2);
        by_whole += advance(whole, &step, 2);
        ck_assert(changed->model.updated);
    }
    ck_assert_msg(by_change <= by_whole + by_whole / 10, "%u iterations, %u with models set whole", by_change,
                  by_whole);
    gx_body_destroy(changed);
    gx_body_destroy(whole);
    wl_free(&w);
}
END_TEST

/* ---- the same bits ---- */

static void backwards(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    (void)user;
    while (count-- > 0) task(context, count);
}

START_TEST(order_of_jobs_does_not_matter) {
    workload w = block_with_cuts(3);
    gx_body_desc desc = desc_of(&w);
    gx_body *one = NULL, *other = NULL;
    gx_step_desc step = step_of(0.02);
    size_t c;
    ck_assert_int_eq(gx_body_create(&desc, &one, NULL), GX_OK);
    desc.jobs.parallel_for = backwards;
    ck_assert_int_eq(gx_body_create(&desc, &other, NULL), GX_OK);
    hold_top(one);
    hold_top(other);
    advance(one, &step, 2);
    advance(other, &step, 2);
    for (c = 0; c < w.surface_count; c++) {
        cut_by(one, &w, c, 1);
        cut_by(other, &w, c, 1);
        advance(one, &step, 2);
        advance(other, &step, 2);
        ck_assert_msg(same_bits(one, other), "after cut %zu", c);
    }
    gx_body_destroy(one);
    gx_body_destroy(other);
    wl_free(&w);
}
END_TEST

/* A body saved when its model has been changed, or is yet to be changed, takes the same steps as its copy. */
START_TEST(saved_bodies_go_on_alike) {
    workload w = block_with_cuts(4);
    gx_body *body = body_of(&w), *copy = NULL, *before = NULL;
    gx_step_desc step = step_of(0.02);
    hold_top(body);
    advance(body, &step, 2);
    cut_by(body, &w, 0, 2);
    advance(body, &step, 2);
    ck_assert(body->model.updated);
    if (_i % 2) cut_by(body, &w, 2, 1);
    ck_assert_int_eq(gx_body_clone(body, &copy, NULL), GX_OK);
    ck_assert_int_eq(gx_body_clone(body, &before, NULL), GX_OK);
    advance(body, &step, 2);
    advance(copy, &step, 2);
    ck_assert(same_bits(body, copy));
    cut_by(body, &w, 3, 2);
    cut_by(copy, &w, 3, 2);
    advance(body, &step, 2);
    advance(copy, &step, 2);
    ck_assert(body->model.updated && same_bits(body, copy));
    ck_assert_int_eq(gx_body_restore(body, before, NULL), GX_OK);
    advance(body, &step, 2);
    advance(before, &step, 2);
    ck_assert(same_bits(body, before));
    gx_body_destroy(body);
    gx_body_destroy(copy);
    gx_body_destroy(before);
    wl_free(&w);
}
END_TEST

/* A state restored without a cut in between: the model has the same cells, but has been changed. */
START_TEST(restored_states_go_on_alike) {
    workload w = block_with_cuts(5);
    gx_body *body = body_of(&w), *mark = NULL;
    gx_step_desc step = step_of(0.02);
    hold_top(body);
    advance(body, &step, 2);
    cut_by(body, &w, 0, 2);
    advance(body, &step, 1);
    ck_assert(body->model.updated);
    ck_assert_int_eq(gx_body_clone(body, &mark, NULL), GX_OK);
    advance(body, &step, 3);
    /* the same cuts, so that restoring copies the state alone */
    cut_by(body, &w, 5, 1);
    cut_by(mark, &w, 5, 1);
    advance(body, &step, 1);
    ck_assert_int_eq(gx_body_restore(body, mark, NULL), GX_OK);
    advance(body, &step, 3);
    advance(mark, &step, 3);
    ck_assert(same_bits(body, mark));
    gx_body_destroy(body);
    gx_body_destroy(mark);
    wl_free(&w);
}
END_TEST

/* ---- sleep ---- */

/* Two halves hang asleep. One is cut; the caller writes a displacement to the other before the step. Both wake. */
START_TEST(what_is_written_between_cut_and_step_wakes) {
    workload w = grid(4, 2, 2, 5);
    gx_body *body;
    const gx_region top = gx_region_half_space(2, 1, 2 - 1e-9);
    gx_step_desc step = step_of(0.033);
    gxs_step_report report;
    gx_view view;
    size_t i, all = 0;
    int n;
    add_axis_plane(&w, 0, 2.25);
    add_box(&w, 0, -1, -1, 0.5, 1.75, 4, 0.75);
    body = body_of(&w);
    cut_by(body, &w, 0, 1);
    ck_assert_int_eq(gx_body_hold(body, &top, 1, NULL), GX_OK);
    step.sleep_speed = 1e-3;
    step.mass_damping = 5;
    for (n = 0, report.active_unknowns = 1; n < 400 && report.active_unknowns > 0; n++)
        ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert_uint_eq(report.active_unknowns, 0);
    cut_by(body, &w, 1, 1);
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) all += view.copy_held[i] ? 0 : 3;
    for (i = 0; i < view.copy_count && _i; i++)
        if (!view.copy_held[i] && w.positions[3 * view.copy_node[i]] > 3.5) {
            body->copies.displacement[3 * i + _i - 1] += 1e-3;
            break;
        }
    ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert(body->model.updated);
    if (_i)
        ck_assert_uint_eq(report.active_unknowns, all);
    else
        ck_assert(report.active_unknowns > 0 && report.active_unknowns < all);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- materials ---- */

static double spring_energy(void *user, const double *deformation, double *stress, double *hessian) {
    double energy = 0;
    int i;
    (void)user;
    for (i = 0; i < 9; i++) {
        const double d = deformation[i] - (i % 4 == 0 ? 1 : 0);
        energy += 5e5 * d * d;
        if (stress) stress[i] = 1e6 * d;
    }
    for (i = 0; i < 81 && hessian; i++) hessian[i] = i % 10 == 0 ? 1e6 : 0;
    return energy;
}

/* An element of the caller's own material is cut, beside others. Lanes that the change leaves empty call no energy
   of a material that has none. */
START_TEST(own_materials_are_cut) {
    workload w = grid(1, 1, 1, 5);
    gx_body_desc desc = desc_of(&w);
    const gx_material materials[2] = {{{GXS_STABLE_NEO_HOOKEAN, 1e6, 0.4, 0, NULL, NULL}, 1000},
                                      {{GXS_CUSTOM, 1e6, 0, 0, spring_energy, NULL}, 1000}};
    const uint32_t which[5] = {1, 0, 0, 0, 0};
    const gx_step_desc step = step_of(0.033);
    gx_body *body = NULL;
    desc.materials = materials;
    desc.material_count = 2;
    desc.element_materials = which;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    advance(body, &step, 1);
    add_axis_plane(&w, 0, 0.4);
    cut_by(body, &w, 0, 1);
    advance(body, &step, 2);
    ck_assert(body->model.updated);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- the solver alone ---- */

/* The block's model, from a body that is at rest */
static gxs_model model_of(gx_body *body) {
    gxs_model model;
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    return model;
}

static gxs_solver *solver_with(const gxs_model *model) {
    gxs_solver *solver = NULL;
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, model, NULL), GX_OK);
    return solver;
}

/* A solver with a model, and a change of two of its elements that is right */
typedef struct changing {
    workload w;
    gx_body *body;
    gxs_model model;
    gxs_solver *solver;
    uint32_t *origins, groups[2];
    gxs_element elements[2];
    gxs_constraint constraints[2];
    gxs_change change;
    gxs_step_desc step;
    double *u; /* 3 x copies x 3: displacement, velocity, forces */
} changing;

static void start_changing(changing *c) {
    size_t i;
    memset(c, 0, sizeof *c);
    c->w = grid(2, 2, 2, 5);
    c->body = body_of(&c->w);
    c->model = model_of(c->body);
    c->solver = solver_with(&c->model);
    c->origins = (uint32_t *)malloc(c->model.copy_count * sizeof *c->origins);
    c->u = (double *)calloc(9 * c->model.copy_count, sizeof *c->u);
    for (i = 0; i < c->model.copy_count; i++) c->origins[i] = 2 * (uint32_t)i;
    c->groups[0] = 3;
    c->groups[1] = 5;
    c->elements[0] = c->model.elements[3];
    c->elements[1] = c->model.elements[5];
    c->step.dt = 0.01;
    c->change.copy_count = c->model.copy_count;
    c->change.origins = c->origins;
    c->change.groups = c->groups;
    c->change.group_count = 2;
    c->change.elements = c->elements;
    c->change.element_count = 2;
    /* two copies follow copy 0; not yet in the change */
    c->constraints[0].copy = 1;
    c->constraints[1].copy = 2;
    c->constraints[0].weight[0] = c->constraints[1].weight[0] = 1;
}

static void stop_changing(changing *c) {
    gxs_solver_destroy(c->solver);
    free(c->origins);
    free(c->u);
    gx_body_destroy(c->body);
    wl_free(&c->w);
}

static void expect_change(changing *c, gx_result result, const char *field, size_t index) {
    gx_failure failure;
    ck_assert_int_eq(gxs_solver_update(c->solver, &c->change, &failure), result);
    ck_assert_pstr_eq(failure.field, field);
    ck_assert_uint_eq(failure.index, index);
}

static void expect_step(changing *c, gx_result result) {
    ck_assert_int_eq(gxs_solver_step(c->solver, &c->step, c->u, c->u + 3 * c->model.copy_count, NULL, NULL), result);
}

static void set_again(changing *c) { ck_assert_int_eq(gxs_solver_set_model(c->solver, &c->model, NULL), GX_OK); }

START_TEST(bad_changes_are_named) {
    changing c;
    gx_failure failure;
    start_changing(&c);
    ck_assert_int_eq(gxs_solver_update(NULL, &c.change, &failure), GX_ERROR_ARGUMENT);
    ck_assert_pstr_eq(failure.field, "solver");
    ck_assert_int_eq(gxs_solver_update(c.solver, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert_pstr_eq(failure.field, "change");
    c.change.origins = NULL;
    expect_change(&c, GX_ERROR_ARGUMENT, "origins", SIZE_MAX);
    c.change.origins = c.origins;
    c.change.groups = NULL;
    expect_change(&c, GX_ERROR_ARGUMENT, "groups", SIZE_MAX);
    c.change.groups = c.groups;
    c.change.elements = NULL;
    expect_change(&c, GX_ERROR_ARGUMENT, "elements", SIZE_MAX);
    c.change.elements = c.elements;
    c.change.copy_count = 0;
    expect_change(&c, GX_ERROR_EMPTY, "copy_count", SIZE_MAX);
    c.change.copy_count = c.model.copy_count;
    c.origins[4] = 2 * (uint32_t)c.model.copy_count;
    expect_change(&c, GX_ERROR_INDEX, "origins", 4);
    c.origins[4] = 8;
    c.groups[1] = 3;
    expect_change(&c, GX_ERROR_ARGUMENT, "groups", 1);
    c.groups[1] = 5;
    c.elements[0].group = 6;
    expect_change(&c, GX_ERROR_ARGUMENT, "elements.group", 1);
    c.elements[0].group = 3;
    c.elements[1].copy[2] = (uint32_t)c.model.copy_count;
    expect_change(&c, GX_ERROR_INDEX, "elements.copy", 1);
    c.elements[1].copy[2] = c.model.elements[5].copy[2];
    c.elements[1].material = 1;
    expect_change(&c, GX_ERROR_INDEX, "elements.material", 1);
    c.elements[1].material = 0;
    c.elements[0].weight = NAN;
    expect_change(&c, GX_ERROR_NOT_FINITE, "elements.weight", 0);
    c.elements[0].weight = -1;
    expect_change(&c, GX_ERROR_INVERTED, "elements.weight", 0);
    stop_changing(&c);
}
END_TEST

START_TEST(bad_constraints_are_named) {
    changing c;
    size_t i;
    start_changing(&c);
    c.change.constraint_count = 2;
    expect_change(&c, GX_ERROR_ARGUMENT, "constraints", SIZE_MAX);
    c.change.constraints = c.constraints;
    /* follows twice */
    c.constraints[1].copy = 1;
    expect_change(&c, GX_ERROR_ARGUMENT, "constraints", 1);
    c.constraints[1].copy = 2;
    /* follows a follower */
    c.constraints[1].master[0] = 1;
    expect_change(&c, GX_ERROR_ARGUMENT, "constraints", 1);
    c.constraints[1].master[0] = (uint32_t)c.model.copy_count;
    expect_change(&c, GX_ERROR_INDEX, "constraints.master", 1);
    c.constraints[1].master[0] = 0;
    c.constraints[0].weight[2] = NAN;
    expect_change(&c, GX_ERROR_NOT_FINITE, "constraints.weight", 0);
    c.constraints[0].weight[2] = 0;
    c.change.constraint_count = c.model.copy_count + 1;
    expect_change(&c, GX_ERROR_LIMIT, "constraint_count", SIZE_MAX);
    set_again(&c);
    c.change.constraint_count = 2;
    expect_change(&c, GX_OK, NULL, SIZE_MAX);
    c.u[5 + 3 * c.model.copy_count] = 1;
    expect_step(&c, GX_OK);
    for (i = 0; i < 6; i++) ck_assert_double_eq_tol(c.u[3 + i], c.u[i % 3], 1e-15); /* both follow copy 0 */
    c.change.constraints = NULL;
    c.change.constraint_count = 0;
    memset(c.u, 0, 9 * c.model.copy_count * sizeof *c.u);
    expect_step(&c, GX_OK); /* the model is still set */
    expect_change(&c, GX_OK, NULL, SIZE_MAX);
    expect_step(&c, GX_OK);
    stop_changing(&c);
}
END_TEST

START_TEST(lost_copies_are_named) {
    changing c;
    uint32_t *affine;
    start_changing(&c);
    /* A copy is lost that elements have. */
    c.change.copy_count--;
    expect_change(&c, GX_ERROR_LIMIT, NULL, SIZE_MAX);
    c.change.copy_count++;
    expect_change(&c, GX_ERROR_SEQUENCE, "gxs_solver_set_model", SIZE_MAX); /* no model is set any more */
    expect_step(&c, GX_ERROR_SEQUENCE);
    set_again(&c);
    /* affine copies: hidden vectors that are not there, or an element's; the first ones come */
    affine = (uint32_t *)malloc(c.model.copy_count * sizeof *affine);
    memset(affine, 0xff, c.model.copy_count * sizeof *affine);
    c.change.affine = affine;
    affine[0] = (uint32_t)c.model.copy_count - 2;
    expect_change(&c, GX_ERROR_INDEX, "affine", 0);
    affine[0] = c.elements[0].copy[0] / 3 * 3;
    expect_change(&c, GX_ERROR_ARGUMENT, affine[0] == 0 ? "affine" : "elements.copy", 0);
    affine[0] = GXS_NOT_AFFINE;
    expect_change(&c, GX_ERROR_LIMIT, NULL, SIZE_MAX);
    free(affine);
    c.change.affine = NULL;
    set_again(&c);
    /* two copies that are one */
    c.origins[7] = 6;
    expect_change(&c, GX_ERROR_LIMIT, NULL, SIZE_MAX);
    stop_changing(&c);
}
END_TEST

/* Steps say to which numbering of copies they belong. */
START_TEST(numberings_are_checked) {
    changing c;
    start_changing(&c);
    c.step.forces = c.u + 6 * c.model.copy_count;
    expect_step(&c, GX_OK);
    c.change.epoch = 9;
    expect_change(&c, GX_OK, NULL, SIZE_MAX);
    expect_step(&c, GX_ERROR_STALE);
    c.step.epoch = 9;
    expect_step(&c, GX_OK);
    c.model.epoch = 3;
    set_again(&c);
    expect_step(&c, GX_ERROR_STALE);
    c.step.epoch = 3;
    expect_step(&c, GX_OK);
    stop_changing(&c);
}
END_TEST

/* Elements replaced by themselves, copies renumbered: nothing changes but rounding. */
START_TEST(changes_of_nothing_change_nothing) {
    workload w = grid(BLOCK, BLOCK, BLOCK, 5);
    gx_body *body = body_of(&w);
    gxs_model model = model_of(body);
    const size_t n = model.copy_count;
    gxs_element *elements = (gxs_element *)malloc(model.element_count * sizeof *elements);
    uint32_t *origins = (uint32_t *)malloc(n * sizeof *origins),
             *groups = (uint32_t *)malloc(model.element_count * sizeof *groups);
    double *u = (double *)calloc(6 * n, sizeof *u), *other = (double *)calloc(6 * n, sizeof *other), most = 0;
    gxs_solver *plain = solver_with(&model), *changed = solver_with(&model);
    gxs_step_desc step;
    gxs_change change;
    size_t i, round;
    memset(&step, 0, sizeof step);
    memset(&change, 0, sizeof change);
    step.dt = 0.02;
    step.gravity[2] = -9.81;
    step.newton_iterations = 60;
    step.newton_tolerance = 1e-11;
    step.cg_tolerance = 1e-4;
    random_seed(7);
    for (i = 0; i < n; i++) {
        origins[i] = 2 * (uint32_t)i;
        u[3 * i] = other[3 * i] = 0.2 * sin(w.positions[3 * i + 2]);
    }
    for (round = 0; round < 6; round++) {
        change.copy_count = n;
        change.origins = origins;
        change.groups = groups;
        change.elements = elements;
        change.group_count = change.element_count = 0;
        for (i = 0; i < model.element_count; i++)
            if (random_below(8) == 0) {
                groups[change.group_count++] = (uint32_t)i;
                elements[change.element_count++] = model.elements[i];
            }
        ck_assert_int_eq(gxs_solver_update(changed, &change, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(plain, &step, u, u + 3 * n, NULL, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(changed, &step, other, other + 3 * n, NULL, NULL), GX_OK);
        for (i = 0, most = 0; i < 3 * n; i++) most = fmax(most, fabs(u[i] - other[i]));
        ck_assert_msg(most < 1e-8, "round %zu: %g", round, most);
    }
    gxs_solver_destroy(plain);
    gxs_solver_destroy(changed);
    free(elements);
    free(origins);
    free(groups);
    free(u);
    free(other);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Assembled matrices, volume ratios and lumped masses are not renewed: the update says so, and the model is set anew.
 */
START_TEST(some_solvers_take_no_changes) {
    workload w = grid(BLOCK, BLOCK, BLOCK, 5);
    gx_body *body = body_of(&w);
    gxs_model model = model_of(body);
    const size_t n = model.copy_count;
    uint32_t *origins = (uint32_t *)malloc(n * sizeof *origins);
    double *u = (double *)calloc(6 * n, sizeof *u);
    gxs_step_desc step;
    gxs_change change;
    size_t i;
    int kind;
    memset(&step, 0, sizeof step);
    memset(&change, 0, sizeof change);
    step.dt = 0.02;
    for (i = 0; i < n; i++) origins[i] = 2 * (uint32_t)i;
    change.copy_count = n;
    change.origins = origins;
    for (kind = 0; kind < 4; kind++) {
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        memset(&desc, 0, sizeof desc);
        desc.preconditioner = kind == 1 ? GXS_VOLUME_RATIO : GXS_MULTIGRID;
        desc.matrix = kind == 2 ? GXS_MATRIX_ASSEMBLED : GXS_MATRIX_FREE;
        model.lumped_mass = kind == 3;
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(solver, &step, u, u + 3 * n, NULL, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_update(solver, &change, NULL), kind == 0 ? GX_OK : GX_ERROR_LIMIT);
        if (kind > 0) {
            ck_assert_int_eq(gxs_solver_step(solver, &step, u, u + 3 * n, NULL, NULL), GX_ERROR_SEQUENCE);
            ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
        }
        ck_assert_int_eq(gxs_solver_step(solver, &step, u, u + 3 * n, NULL, NULL), GX_OK);
        gxs_solver_destroy(solver);
    }
    free(origins);
    free(u);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- affine copies ---- */

/* A block of some layers of elements, and cuts: two slices off it, a sheet that grows through it, others that end
   inside and cross, a plane through nodes */
static workload sheets_with_cuts(int seed, int layers) {
    workload w = grid(6, 3, (uint32_t)layers, seed % 2 ? 6 : 5);
    const double q[3] = {4.13, 2.21, 0.93}, m[3] = {0.1, 1, 0.2};
    int i;
    random_seed((uint64_t)seed);
    add_axis_plane(&w, 2, 0.37);
    add_axis_plane(&w, 2, 0.62);
    for (i = 0; i < 3; i++) {
        const double x = 2 * i - 0.63, z = 0.8, a[3] = {x, -1, z}, b[3] = {x + 2, -1, z}, c[3] = {x + 2, 5, z},
                     d[3] = {x, 5, z};
        wl_add_quad(wl_add_surface(&w, 0), a, b, c, d);
    }
    add_plane(&w, q, m, 1.7);
    add_plane(&w, q, m, 30);
    return w;
}

static gx_body *affine_body(const workload *w) {
    gx_body_desc desc = desc_of(w);
    gx_body *body = NULL;
    desc.affine_below = 1;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    return body;
}

/* As apart, of the columns of A */
static double bent_apart(gx_body *a, gx_body *b) {
    const gx_view of = view_of(a), to = view_of(b);
    const double *mass = a->solver->system->model.lumped;
    double most = 0, gap = 0;
    size_t i;
    for (i = 0; i < 9 * of.copy_count; i++) {
        const double d = of.affine[i] - to.affine[i];
        most += mass[i / 9] * of.affine[i] * of.affine[i];
        gap += mass[i / 9] * d * d;
    }
    return most > 0 ? sqrt(gap / most) : 0;
}

/* Operators of both models, at rest */
static void check_affine_operator(gx_body *changed, gx_body *whole) {
    const size_t n = changed->solver->system->model.n;
    double *x = (double *)calloc(12 * n, sizeof *x), *y = x + 3 * n, *z = y + 3 * n, *rest = z + 3 * n, most = 0;
    size_t i;
    ck_assert_uint_eq(n, whole->solver->system->model.n);
    for (i = 0; i < 3 * n; i++) x[i] = sin(0.37 * (double)(i * i % 1009));
    ck_assert_int_eq(gxs_solver_linearise(changed->solver, rest, 100, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_linearise(whole->solver, rest, 100, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(changed->solver, x, y, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(whole->solver, x, z, NULL), GX_OK);
    for (i = 0; i < 3 * n; i++) most = fmax(most, fabs(z[i]));
    for (i = 0; i < 3 * n; i++) ck_assert_msg(fabs(y[i] - z[i]) <= 1e-6 * most, "%g and %g", y[i], z[i]);
    free(x);
}

/* Numbers of level 1 that elements with affine copies add, largest difference relative to both diagonals */
static double bent_difference(const gxsp_level *level, const double *block, const double *other) {
    uint32_t i, k;
    double most = 0;
    int m;
    for (i = 0; i < level->n; i++)
        for (k = level->start[i]; k < level->start[i + 1]; k++) {
            const double *own = block + 9 * (size_t)level->start[i],
                         *to = block + 9 * (size_t)level->start[level->column[k]];
            const double size = sqrt((own[0] + own[4] + own[8]) * (to[0] + to[4] + to[8]));
            for (m = 0; m < 9; m++) {
                const size_t at = 9 * (size_t)k + (size_t)m;
                most = fmax(most, fabs(block[at] - other[at]) / (size + 1e-300));
            }
        }
    return most;
}

/* A cut at one end of a long plate: coarse numbers are made again there, and equal those made at the same state. */
START_TEST(small_cuts_of_sheets_keep_coarse_numbers) {
    workload w = grid(56, 3, 1 + _i, 5);
    const gx_region left = gx_region_half_space(0, -1, 1e-9);
    gx_step_desc step = step_of(0.02);
    gx_body *body;
    size_t c;
    if (_i) add_axis_plane(&w, 2, 1.7); /* a slice on a thick rest */
    for (c = 0; c < 3; c++) {
        const double x = 55 - (double)c - 0.37, z = _i ? 1.8 : 0.4, a[3] = {x, -1, z}, b[3] = {x + 1, -1, z},
                     d[3] = {x + 1, 5, z}, e[3] = {x, 5, z};
        wl_add_quad(wl_add_surface(&w, 0), a, b, d, e);
    }
    body = affine_body(&w);
    if (_i) cut_by(body, &w, 0, 1);
    ck_assert_int_eq(gx_body_hold(body, &left, 1, NULL), GX_OK);
    step.newton_iterations = 1;
    advance(body, &step, 3);
    for (c = (size_t)_i; c < w.surface_count; c++) {
        gxsp_system *system = body->solver->system;
        const double before[3] = {system->coarse.displacement[3], system->coarse.displacement[4],
                                  system->coarse.displacement[5]};
        const gxsp_level *level = &system->multigrid.levels[1];
        size_t bytes;
        double *block;
        int collapsed;
        system->coarse.worn = 0; /* whatever they have served */
        system->coarse.life = 1000;
        ck_assert_uint_eq(system->multigrid.level_count, 2);
        cut_by(body, &w, c, 1);
        advance(body, &step, 1);
        ck_assert(body->model.updated);
        ck_assert(memcmp(before, system->coarse.displacement + 3, sizeof before) == 0); /* no step has made them */
        ck_assert(system->coarse.rate > 0);
        bytes = 9 * (size_t)level->start[level->n] * sizeof *block;
        block = (double *)malloc(bytes);
        memcpy(block, system->affine.block, bytes);
        ck_assert(gxsp_linearise(system, system->coarse.rate, system->coarse.displacement, 0, &collapsed));
        ck_assert(gxsp_coarse_numbers(system, system->coarse.rate));
        ck_assert_msg(bent_difference(level, system->affine.block, block) < 3e-5, "cut %zu: %g", c,
                      bent_difference(level, system->affine.block, block));
        free(block);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Cuts of sheets change the model: the motion is that of a model set whole. */
START_TEST(cuts_of_sheets_change_the_model) {
    workload w = sheets_with_cuts(_i, 2 - _i);
    gx_body *changed = affine_body(&w), *whole = affine_body(&w);
    const gx_region left = gx_region_half_space(0, -1, 1e-9);
    gx_step_desc step = exact_step(0.02);
    size_t c, updates = 0;
    step.newton_iterations = 10;
    step.newton_tolerance = 1e-8;
    ck_assert_int_eq(gx_body_hold(changed, &left, 1, NULL), GX_OK);
    ck_assert_int_eq(gx_body_hold(whole, &left, 1, NULL), GX_OK);
    for (c = 0; c < w.surface_count; c++) {
        cut_by(changed, &w, c, 1);
        cut_by(whole, &w, c, 1);
        ck_assert_int_eq(gx_body_hold(whole, &left, 1, NULL), GX_OK);
        if (c % 4 == 2) continue; /* two cuts before a step */
        advance(changed, &step, 1);
        advance(whole, &step, 1);
        updates += changed->model.updated != 0;
        ck_assert(!whole->model.updated);
        ck_assert_uint_eq(changed->solver->system->affine.count, whole->solver->system->affine.count);
        ck_assert_uint_eq(changed->solver->system->affine.group_count, whole->solver->system->affine.group_count);
        ck_assert_uint_eq(changed->solver->system->model.light_count, whole->solver->system->model.light_count);
        check_affine_operator(changed, whole);
        ck_assert_msg(apart(changed, whole) < 1e-6, "after cut %zu: %g", c, apart(changed, whole));
        ck_assert_msg(bent_apart(changed, whole) < 1e-3, "after cut %zu: %g", c, bent_apart(changed, whole));
    }
    ck_assert_uint_gt(updates, 3);
    gx_body_destroy(changed);
    gx_body_destroy(whole);
    wl_free(&w);
}
END_TEST

/* ---- memory ---- */

/* The n-th allocation of the step after a cut fails, once or from then on: the body is as it was, and the step made
   again is as good. Without coarse levels and with them */
START_TEST(memory_may_run_out) {
    workload w = block_with_cuts(6);
    gx_body_desc desc = desc_of(&w);
    gx_step_desc step = exact_step(_i < 2 ? 0.02 : 0.3);
    gx_body *whole = body_of(&w);
    size_t n, failures = 0;
    hold_top(whole);
    advance(whole, &step, 1);
    cut_by(whole, &w, 0, 1);
    advance(whole, &step, 1);
    for (n = 0;; n += FEWER) {
        memory m = plenty();
        gx_body *body = NULL;
        gx_result result;
        uint64_t hash;
        desc.allocator = allocator_of(&m);
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        hold_top(body);
        advance(body, &step, 1);
        cut_by(body, &w, 0, 1);
        hash = gx_body_state_hash(body);
        fail_from(&m, n, _i % 2);
        result = gx_body_step(body, &step, NULL, NULL);
        failures += m.failed != 0;
        ck_assert_int_eq(result, m.failed ? GX_ERROR_MEMORY : GX_OK);
        ck_assert(!m.failed || gx_body_state_hash(body) == hash);
        never_fail(&m);
        if (result != GX_OK) advance(body, &step, 1);
        ck_assert_msg(apart(body, whole) < 1e-6, "allocation %zu: %g", n, apart(body, whole));
        gx_body_destroy(body);
        ck_assert(is_whole(&m));
        if (result == GX_OK) break;
    }
    ck_assert_uint_gt(failures, (_i < 2 ? 25 : 50) / FEWER);
    gx_body_destroy(whole);
    wl_free(&w);
}
END_TEST

/* The same where copies are affine */
START_TEST(memory_may_run_out_beside_sheets) {
    workload w = grid(4, 2, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_step_desc step = step_of(0.02);
    size_t n, failures = 0;
    add_axis_plane(&w, 2, 0.4);
    add_axis_plane(&w, 0, 2.3);
    desc.affine_below = 1;
    for (n = 0;; n += FEWER) {
        memory m = plenty();
        gx_body *body = NULL;
        gx_result result;
        uint64_t hash;
        desc.allocator = allocator_of(&m);
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        cut_by(body, &w, 0, 1);
        advance(body, &step, 1);
        cut_by(body, &w, 1, 1);
        hash = gx_body_state_hash(body);
        fail_from(&m, n, _i);
        result = gx_body_step(body, &step, NULL, NULL);
        failures += m.failed != 0;
        ck_assert_int_eq(result, m.failed ? GX_ERROR_MEMORY : GX_OK);
        ck_assert(!m.failed || gx_body_state_hash(body) == hash);
        never_fail(&m);
        if (result != GX_OK) advance(body, &step, 1);
        ck_assert(result != GX_OK || body->model.updated);
        gx_body_destroy(body);
        ck_assert(is_whole(&m));
        if (result == GX_OK) break;
    }
    ck_assert_uint_gt(failures, 50 / FEWER);
    wl_free(&w);
}
END_TEST

/* ---- memory per element ---- */

/* Bytes per element that a solver has after a step */
static double bytes_of(const gxs_model *model, gxs_preconditioner preconditioner) {
    double *state = (double *)calloc(6 * model->copy_count, sizeof *state);
    const gx_step_desc step = step_of(0.033);
    gxs_solver_desc desc;
    gxs_step_desc own;
    gxs_solver *solver;
    memory m = plenty();
    double each;
    memset(&desc, 0, sizeof desc);
    memset(&own, 0, sizeof own);
    own.dt = step.dt;
    own.gravity[2] = step.gravity[2];
    desc.preconditioner = preconditioner;
    desc.allocator = allocator_of(&m);
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &own, state, state + 3 * model->copy_count, NULL, NULL), GX_OK);
    each = (double)bytes_alive(&m) / (double)model->element_count;
    gxs_solver_destroy(solver);
    ck_assert(is_whole(&m));
    free(state);
    return each;
}

/* Whole, cut by strips that leave it connected, cut to small pieces of this many cells a side: at most 350 bytes for
   an element of the model, lists and multigrid included, with the solver's own choice and with multigrid forced. */
START_TEST(solvers_take_bounded_memory) {
    static const double sides[] = {0, 4, 2.53, 3.51, 4, 4.49, 5.51, 6.53};
    workload w = grid(_i < 2 ? 16 : 17, 16, 16, 6);
    gxs_model model;
    gx_body *body;
    double chosen, forced, z;
    int axis;
    for (z = 4.37; z < 15 && _i == 1; z += sides[_i]) {
        const int left = fmod(z, 8) < 4;
        const double low = left ? 2.3 : -1, high = left ? 17 : 13.7;
        const double a[3] = {low, -1, z}, b[3] = {high, -1, z}, c[3] = {high, 17, z}, d[3] = {low, 17, z};
        wl_add_quad(wl_add_surface(&w, 0), a, b, c, d);
    }
    for (axis = 0; axis < 3 && _i > 1; axis++)
        for (z = sides[_i] + 0.37; z < 15; z += sides[_i]) add_axis_plane(&w, axis, z);
    body = cut_at_once(&w);
    ck_assert(_i > 1 ? view_of(body).fragment_count >= 27 : view_of(body).fragment_count == 1);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    chosen = bytes_of(&model, GXS_AUTOMATIC);
    forced = bytes_of(&model, GXS_MULTIGRID);
    ck_assert_msg(chosen < 350 && forced < 350, "%g and %g bytes per element", chosen, forced);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- coarse functions of small components ---- */

/* Appends a bar of cells of one size, apart from the others */
static void add_beam(workload *w, double x, double size, uint32_t nx, uint32_t ny) {
    workload bar = grid(nx, ny, 1, 6);
    const size_t nodes = w->node_count, elements = w->element_count;
    size_t i;
    w->positions = (double *)realloc(w->positions, 3 * (nodes + bar.node_count) * sizeof *w->positions);
    w->elements = (uint32_t *)realloc(w->elements, 4 * (elements + bar.element_count) * sizeof *w->elements);
    for (i = 0; i < 3 * bar.node_count; i++)
        w->positions[3 * nodes + i] = (i % 3 == 0 ? x : 3) + size * bar.positions[i];
    for (i = 0; i < 4 * bar.element_count; i++) w->elements[4 * elements + i] = bar.elements[i] + (uint32_t)nodes;
    w->node_count += bar.node_count;
    w->element_count += bar.element_count;
    wl_free(&bar);
}

/* Fifty components with cells of a hundredth to a half of a large component's, beside it. Their coarse functions
   depend on their own size (13,000 iterations where they depended on the lattice's). */
START_TEST(small_pieces_beside_a_large_one) {
    workload w = grid(8, 8, 8, 6);
    gx_body *body;
    gxs_model model;
    gxs_solver_desc desc;
    gxs_solver *solver;
    gxs_step_desc step;
    gxs_step_report report;
    double *state;
    uint32_t i, iterations = 0;
    for (i = 0; i < 50; i++) add_beam(&w, 10 + i, 0.01 + 0.01 * i, 1 + i % 3, 1 + i % 2);
    body = body_of(&w);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    state = (double *)calloc(6 * model.copy_count, sizeof *state);
    random_seed(5);
    for (i = 0; i < 3 * model.copy_count; i++) state[3 * model.copy_count + i] = random_real(-0.05, 0.05);
    memset(&desc, 0, sizeof desc);
    memset(&step, 0, sizeof step);
    step.dt = 0.3;
    step.gravity[2] = -9.81;
    step.newton_iterations = 30;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-4;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
    for (i = 0; i < 3; i++) {
        ck_assert_int_eq(gxs_solver_step(solver, &step, state, state + 3 * model.copy_count, &report, NULL), GX_OK);
        iterations += report.cg_iterations;
    }
    ck_assert_uint_gt(solver->system->multigrid.level_count, 1);
    ck_assert_uint_lt(iterations, 3500);
    gxs_solver_destroy(solver);
    gx_body_destroy(body);
    free(state);
    wl_free(&w);
}
END_TEST

static Suite *updates_suite(void) {
    Suite *suite = suite_create("updates");
    TCase *tests = tcase_create("updates"), *sheets = tcase_create("sheets");
    tcase_set_timeout(tests, 120);
    tcase_set_timeout(sheets, 120);
    tcase_add_loop_test(sheets, cuts_of_sheets_change_the_model, 0, 2);
    tcase_add_loop_test(sheets, small_cuts_of_sheets_keep_coarse_numbers, 0, 2);
    tcase_add_loop_test(sheets, memory_may_run_out_beside_sheets, 0, 2);
    suite_add_tcase(suite, sheets);
    tcase_add_loop_test(tests, cuts_change_the_model, 0, 6 / FEWER);
    tcase_add_loop_test(tests, changed_models_are_of_any_kind, 0, 4);
    tcase_add_loop_test(tests, small_cuts_keep_coarse_numbers, 0, 2);
    tcase_add_loop_test(tests, levels_are_made_where_they_serve, 0, 2);
    tcase_add_test(tests, changed_models_take_no_more_iterations);
    tcase_add_test(tests, order_of_jobs_does_not_matter);
    tcase_add_loop_test(tests, saved_bodies_go_on_alike, 0, 2);
    tcase_add_test(tests, restored_states_go_on_alike);
    tcase_add_loop_test(tests, what_is_written_between_cut_and_step_wakes, 0, 4);
    tcase_add_test(tests, own_materials_are_cut);
    tcase_add_test(tests, bad_changes_are_named);
    tcase_add_test(tests, bad_constraints_are_named);
    tcase_add_test(tests, lost_copies_are_named);
    tcase_add_test(tests, numberings_are_checked);
    tcase_add_test(tests, changes_of_nothing_change_nothing);
    tcase_add_test(tests, some_solvers_take_no_changes);
    tcase_add_loop_test(tests, memory_may_run_out, 0, 4);
    ADD_SOME(tests, solvers_take_bounded_memory, 8);
    tcase_add_test(tests, small_pieces_beside_a_large_one);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void) { return run_suite(updates_suite()); }
