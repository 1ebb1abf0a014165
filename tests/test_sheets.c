/* test_sheets.c - tests of bodies with affine copies (gx_body_desc.affine_below): which copies become affine, that
   nothing moves when they do, that thin pieces bend, motions, points, saving, memory, refusals. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"

#include "body.h"

static gx_body *sheet_body_in(memory *m, const workload *w, double affine_below) {
    gx_body_desc desc = desc_of(w);
    gx_body *body = NULL;
    gx_result result;
    desc.affine_below = affine_below;
    desc.poisson = 0.3;
    if (m != NULL) desc.allocator = allocator_of(m);
    result = gx_body_create(&desc, &body, NULL);
    ck_assert_msg(result == GX_OK || m != NULL, "create: %s", gx_result_text(result));
    return body;
}

static gx_body *sheet_body(const workload *w, double affine_below) { return sheet_body_in(NULL, w, affine_below); }

static size_t affine_count(gx_body *body) {
    const gx_view view = view_of(body);
    size_t i, count = 0;
    for (i = 0; i < view.copy_count && view.copy_affine != NULL; i++) count += view.copy_affine[i];
    return count;
}

/* Flings the body and writes random numbers to its state, those of affine copies included. */
static void shake(gx_body *body, double size) {
    const gx_view view = view_of(body);
    size_t i;
    for (i = 0; i < 3 * view.copy_count; i++) {
        view.displacement[i] = random_real(-size, size);
        view.velocity[i] = random_real(-1, 1);
    }
    for (i = 0; i < 9 * view.copy_count && view.affine != NULL; i++)
        if (view.copy_affine[i / 9]) {
            body->copies.linear[i] = random_real(-size, size);
            body->copies.linear_rate[i] = random_real(-1, 1);
        }
}

static gx_step_desc step_of(double dt, double gravity) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[2] = gravity;
    return step;
}

static void advance(gx_body *body, const gx_step_desc *step) {
    gx_failure failure;
    const gx_result result = gx_body_step(body, step, NULL, &failure);
    ck_assert_msg(result == GX_OK, "step: %s, %s %zu", gx_result_text(result), failure.field ? failure.field : "",
                  failure.index);
}

static void hold_left(gx_body *body) {
    const gx_region left = gx_region_half_space(0, -1, 1e-9);
    ck_assert_int_eq(gx_body_hold(body, &left, 1, NULL), GX_OK);
}

/* ---- which copies ---- */

/* A plane through a thick body leaves two thick bodies. */
START_TEST(a_thick_body_has_none) {
    int round;
    random_seed((uint64_t)_i);
    for (round = 0; round < 4; round++) {
        workload w = grid(6, 6, 6, round % 2 ? 6 : 5);
        gx_body *body = sheet_body(&w, 1);
        double p[3], n[3];
        int k;
        ck_assert_uint_eq(affine_count(body), 0);
        for (k = 0; k < 3; k++) {
            p[k] = random_real(2.5, 3.5);
            n[k] = k == _i % 3 ? 1 : random_real(-0.1, 0.1);
        }
        if (_i < 3) {
            add_axis_plane(&w, _i, 2 + round / 2 + (round % 2 ? 1e-3 : -0.05));
        } else
            add_plane(&w, p, n, 40);
        cut_by(body, &w, 0, 1);
        ck_assert_msg(affine_count(body) == 0, "%d.%d: %zu", _i, round, affine_count(body));
        gx_body_destroy(body);
        wl_free(&w);
    }
}
END_TEST

/* Bodies of one layer are thin from the start, of cubes or flat; those of more layers are not. */
START_TEST(layers_are_thin) {
    static const double height[4] = {1, 0.2, 1, 0.2};
    workload w = grid(6, 6, _i < 2 ? 1 : 3, 5);
    gx_body *body;
    size_t i;
    for (i = 0; i < w.node_count; i++) w.positions[3 * i + 2] *= height[_i];
    body = sheet_body(&w, 1);
    ck_assert_uint_eq(affine_count(body), _i < 2 ? w.node_count : 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Slices of a body: all of their copies, in any placement, and none of the rest. */
START_TEST(slices_are_thin) {
    const double low = 2.3 + 0.1 * _i, thick = _i % 2 ? 0.5 : 0.1;
    workload w = grid(8, 8, 6, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_view view;
    uint32_t sheet = 0;
    size_t i;
    int k;
    add_axis_plane(&w, 2, low);
    add_axis_plane(&w, 2, low + thick);
    cut_by(body, &w, 0, 2);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    while (!(fabs(view.fragment_volume[sheet] - 64 * thick) < 1e-6)) sheet++;
    for (i = 0; i < view.cell_count; i++)
        for (k = 0; k < 4; k++)
            ck_assert_msg(view.copy_affine[view.cell_copies[4 * i + (size_t)k]] == (view.cell_fragment[i] == sheet),
                          "cell %zu of %u", i, view.cell_fragment[i]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- nothing moves ---- */

/* Where material points of a body are: every cell's centre of its element's nodes, nudged, by slot */
static void place_all(gx_body *body, double *positions) {
    const gx_view view = view_of(body);
    size_t i;
    int n, k;
    for (i = 0; i < view.cell_count; i++) {
        const uint32_t *node = gxb_complex_element_nodes(body->complex, view.cell_element[i]);
        double x[3] = {0, 0, 0};
        for (n = 0; n < 4; n++)
            for (k = 0; k < 3; k++)
                x[k] += (0.1 + 0.3 * (n == 1) + 0.2 * (n == 2) + 0.1 * (n == 3)) *
                        body->mesh.positions[3 * (size_t)node[n] + (size_t)k];
        ck_assert_int_eq(gx_body_place(body, view.cell_slot[i], x, positions + 3 * view.cell_slot[i], NULL), GX_OK);
    }
}

/* Copies become affine, and affine copies are divided: material points stay where they are, bit by bit, and so do
   centres, momenta and energies, but for rounding. */
START_TEST(nothing_moves) {
    workload w = grid(5, 4, 3, 5);
    gx_body *body;
    gx_motion before[64], after[64];
    double *then, *now, sum[2][7];
    gx_view view;
    size_t slots, i, f;
    int cut, k;
    random_seed((uint64_t)_i);
    body = sheet_body(&w, 1);
    add_axis_plane(&w, 2, 1.4);
    add_axis_plane(&w, 2, 1.7);
    add_axis_plane(&w, 1, 1.7);
    add_random_plane(&w, 40);
    add_random_plane(&w, 40);
    for (cut = 0; cut < 4; cut++) {
        shake(body, 0.3);
        view = view_of(body);
        slots = view.slot_count;
        then = (double *)oracle_memory(NULL, 3 * slots, sizeof *then);
        place_all(body, then);
        ck_assert_int_eq(gx_body_motion(body, before, 64, NULL), GX_OK);
        memset(sum, 0, sizeof sum);
        for (f = 0; f < view.fragment_count; f++)
            for (k = 0; k < 3; k++) {
                sum[0][k] += before[f].mass * before[f].center[k];
                sum[0][3 + k] += before[f].mass * before[f].velocity[k];
            }
        cut_by(body, &w, cut == 0 ? 0 : (size_t)cut + 1, cut == 0 ? 2 : 1);
        view = view_of(body);
        ck_assert(view.fragment_count <= 64);
        now = (double *)oracle_memory(NULL, 3 * view.slot_count, sizeof *now);
        place_all(body, now);
        for (i = 0; i < view.cell_count; i++)
            if (view.cell_slot[i] < slots)
                ck_assert(memcmp(then + 3 * view.cell_slot[i], now + 3 * view.cell_slot[i], 3 * sizeof *now) == 0);
        ck_assert_int_eq(gx_body_motion(body, after, 64, NULL), GX_OK);
        for (f = 0; f < view.fragment_count; f++)
            for (k = 0; k < 3; k++) {
                sum[1][k] += after[f].mass * after[f].center[k];
                sum[1][3 + k] += after[f].mass * after[f].velocity[k];
            }
        for (k = 0; k < 6; k++)
            ck_assert_msg(fabs(sum[1][k] - sum[0][k]) < 1e-9 * view.mass, "seed %d cut %d: %.17g %.17g", _i, cut,
                          sum[0][k], sum[1][k]);
        ck_assert(affine_count(body) > 0);
        free(then);
        free(now);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* The skin and the motions of random cut bodies by the slow oracle: the definition of the field, and integrals by the
   mass blocks, since x - X_i = sum_j N_j (X_j - X_i). */
START_TEST(fields_are_as_defined) {
    workload w = grid(4, 3, 3, _i % 2 ? 6 : 5);
    gx_body *body;
    gx_view view;
    gx_skin skin;
    gx_motion *motions;
    double *positions, *sums;
    size_t i;
    int cut, j, k, n, a;
    random_seed((uint64_t)_i);
    body = sheet_body(&w, 1);
    for (cut = 0; cut < 4; cut++) {
        if (cut == 1)
            add_axis_plane(&w, 2, 1.1 + 0.1 * (_i % 5));
        else
            add_random_cut(&w, 1);
        cut_by(body, &w, w.surface_count - 1, 1);
    }
    shake(body, 0.2);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    positions = (double *)oracle_memory(NULL, 3 * skin.vertex_count + 1, sizeof *positions);
    ck_assert_int_eq(gx_body_skin_positions(body, positions, NULL), GX_OK);
    view = view_of(body);
    for (i = 0; i < skin.vertex_count; i++) {
        const double *x = skin.vertex_rest + 3 * i;
        for (k = 0; k < 3; k++) {
            double at = x[k];
            for (n = 0; n < 4; n++) {
                const size_t c = skin.vertex_copies[4 * i + (size_t)n];
                const double *node = body->mesh.positions + 3 * (size_t)view.copy_node[c],
                             weight = skin.vertex_weights[4 * i + (size_t)n];
                at += weight * view.displacement[3 * c + (size_t)k];
                for (a = 0; a < 3; a++) at += weight * view.affine[9 * c + 3 * (size_t)a + (size_t)k] * (x[a] - node[a]);
            }
            ck_assert_msg(fabs(at - positions[3 * i + (size_t)k]) < 1e-12, "seed %d", _i);
        }
    }
    motions = (gx_motion *)oracle_memory(NULL, view.fragment_count + 1, sizeof *motions);
    sums = (double *)oracle_memory(NULL, 6 * view.fragment_count + 1, sizeof *sums);
    memset(sums, 0, 6 * view.fragment_count * sizeof *sums);
    ck_assert_int_eq(gx_body_motion(body, motions, view.fragment_count, NULL), GX_OK);
    for (i = 0; i < view.cell_count; i++) {
        const gxp_cell *cell = &body->cells.data[body->view.cell[i]];
        for (n = 0; n < 4; n++)
            for (j = 0; j < 4; j++) {
                const size_t c = view.cell_copies[4 * i + (size_t)n], d = view.cell_copies[4 * i + (size_t)j];
                const double *p = body->mesh.positions + 3 * (size_t)view.copy_node[c],
                             *q = body->mesh.positions + 3 * (size_t)view.copy_node[d],
                             mass = cell->mass[gxp_mass_at[n][j]];
                for (k = 0; k < 3; k++) {
                    double *sum = sums + 6 * (size_t)view.cell_fragment[i] + k;
                    sum[0] += mass * (p[k] + view.displacement[3 * c + (size_t)k]);
                    sum[3] += mass * view.velocity[3 * c + (size_t)k];
                    for (a = 0; a < 3; a++) {
                        sum[0] += mass * view.affine[9 * c + 3 * (size_t)a + (size_t)k] * (q[a] - p[a]);
                        sum[3] += mass * view.affine_rate[9 * c + 3 * (size_t)a + (size_t)k] * (q[a] - p[a]);
                    }
                }
            }
    }
    for (i = 0; i < view.fragment_count; i++)
        for (k = 0; k < 3; k++) {
            const double mass = view.fragment_mass[i];
            ck_assert_msg(fabs(motions[i].mass - mass) <= 1e-12 * mass, "seed %d", _i);
            ck_assert_msg(fabs(motions[i].center[k] - sums[6 * i + (size_t)k] / mass) < 1e-9, "seed %d: %g", _i, mass);
            ck_assert_msg(fabs(motions[i].velocity[k] - sums[6 * i + 3 + (size_t)k] / mass) < 1e-9, "seed %d: %g", _i,
                          mass);
        }
    free(motions);
    free(sums);
    free(positions);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A sheet that turns as a rigid body does: velocity, spin, inertia and energy in closed form. */
START_TEST(rigid_motions_are_exact) {
    const double spin[3] = {0.3, -0.5, 0.7}, go[3] = {1, 2, -1}, c = cos(0.7), s = sin(0.7);
    const double turn[3][3] = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
    workload w = grid(4, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_view view = view_of(body);
    gx_motion m;
    double inertia[3] = {0, 0, 0}, energy = 0;
    size_t i;
    int k, a;
    ck_assert_uint_eq(affine_count(body), view.copy_count);
    for (i = 0; i < view.copy_count; i++) {
        const double *x = body->mesh.positions + 3 * (size_t)view.copy_node[i];
        double y[3];
        for (k = 0; k < 3; k++) {
            y[k] = turn[k][0] * x[0] + turn[k][1] * x[1] + turn[k][2] * x[2];
            view.displacement[3 * i + (size_t)k] = y[k] - x[k];
            for (a = 0; a < 3; a++) body->copies.linear[9 * i + (size_t)(3 * a + k)] = turn[k][a] - (a == k);
        }
        for (k = 0; k < 3; k++) {
            const int p = (k + 1) % 3, q = (k + 2) % 3;
            view.velocity[3 * i + (size_t)k] = go[k] + spin[p] * y[q] - spin[q] * y[p];
            for (a = 0; a < 3; a++)
                body->copies.linear_rate[9 * i + (size_t)(3 * a + k)] = spin[p] * turn[q][a] - spin[q] * turn[p][a];
        }
    }
    ck_assert_int_eq(gx_body_motion(body, &m, 1, NULL), GX_OK);
    for (k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        const double v = go[k] + spin[p] * m.center[q] - spin[q] * m.center[p];
        ck_assert(fabs(m.velocity[k] - v) < 1e-12);
        ck_assert(fabs(m.angular_velocity[k] - spin[k]) < 1e-12);
        energy += 0.5 * m.mass * v * v;
    }
    inertia[0] = m.mass * (9 + 1) / 12.0; /* of the box at rest: 4 x 3 x 1 */
    inertia[1] = m.mass * (16 + 1) / 12.0;
    inertia[2] = m.mass * (16 + 9) / 12.0;
    for (k = 0; k < 3; k++) {
        const double w0 = turn[0][k] * spin[0] + turn[1][k] * spin[1] + turn[2][k] * spin[2];
        energy += 0.5 * inertia[k] * w0 * w0;
    }
    ck_assert_msg(fabs(m.inertia[3] - inertia[1]) < 1e-9 * inertia[1], "%g %g", m.inertia[3], inertia[1]);
    ck_assert_msg(fabs(m.energy - energy) < 1e-9 * energy, "%g %g", m.energy, energy);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("sheets");
    TCase *tcase = tcase_create("which");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, a_thick_body_has_none, 0, 9);
    tcase_add_loop_test(tcase, layers_are_thin, 0, 4);
    tcase_add_loop_test(tcase, slices_are_thin, 0, 8);
    tcase_add_loop_test(tcase, nothing_moves, 0, 4);
    tcase_add_loop_test(tcase, fields_are_as_defined, 0, 12);
    tcase_add_test(tcase, rigid_motions_are_exact);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
