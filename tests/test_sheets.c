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
                for (a = 0; a < 3; a++)
                    at += weight * view.affine[9 * c + 3 * (size_t)a + (size_t)k] * (x[a] - node[a]);
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

/* ---- steps ---- */

/* The farthest way along z of material points at x = length, by fragment. way: -1 downwards, 1 upwards */
static void find_tips(gx_body *body, double length, double way, double *tips) {
    gx_skin skin;
    double *x;
    size_t i;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    x = (double *)oracle_memory(NULL, 3 * skin.vertex_count + 1, sizeof *x);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (i = 0; i < 3 * skin.triangle_count; i++) {
        const uint32_t v = skin.triangles[i], f = skin.triangle_fragment[i / 3];
        if (skin.vertex_rest[3 * (size_t)v] < length - 1e-9) continue;
        tips[f] = fmax(tips[f], way * (x[3 * (size_t)v + 2] - skin.vertex_rest[3 * (size_t)v + 2]));
    }
    free(x);
}

/* How far a slice of a plate of 8 x 2 cubes hangs under gravity, upwards if that is positive */
static double drop_of(int affine, double low, double thick, double young, double gravity) {
    workload w = grid(8, 2, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL;
    gx_step_desc step = step_of(0, gravity);
    gx_view view;
    double tips[4] = {0, 0, 0, 0};
    size_t f;
    desc.affine_below = affine;
    desc.young = young;
    desc.poisson = 0;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    add_axis_plane(&w, 2, low);
    add_axis_plane(&w, 2, low + thick);
    cut_by(body, &w, 0, 2);
    hold_left(body);
    step.integrator = GXS_STATIC;
    step.newton_iterations = 200;
    step.newton_tolerance = 1e-9;
    step.cg_tolerance = 1e-6;
    step.cg_iterations = 20000;
    advance(body, &step);
    view = view_of(body);
    find_tips(body, 8, gravity < 0 ? -1 : 1, tips);
    for (f = 0; !(fabs(view.fragment_volume[f] - 16 * thick) < 1e-9); f++) {}
    gx_body_destroy(body);
    wl_free(&w);
    return tips[f];
}

/* A slice cut out of a body hangs as a beam does, wherever in the layer it lies; without affine copies it is stiff. */
START_TEST(slices_hang_as_beams) {
    static const double thick[3] = {0.5, 0.2, 0.1}, least[3] = {0.95, 0.93, 0.9};
    const double t = thick[_i % 3], low = _i < 3 ? 0.45 : _i < 6 ? 0.07 : 0.83 - t;
    const double beam = 1000 * 1e-3 * t * pow(8, 4) / (8 * 1e6 * t * t * t / 12);
    const double stiffer = beam / 0.1; /* so stiff that it drops by a tenth of a unit, and theory holds */
    const double with = drop_of(1, low, t, 1e6 * stiffer, -1e-3) * stiffer;
    ck_assert_msg(with > least[_i % 3] * beam && with < 1.03 * beam, "%d: %g of %g", _i, with / beam, beam);
    if (_i == 1)
        ck_assert_msg(drop_of(0, low, t, 1e6 * stiffer, -1e-3) * stiffer < 0.1 * beam, "it is not stiff without");
}
END_TEST

/* Slices that gravity bends by 0.4 of their length, downwards and upwards: as an inextensible rod, nearly, and both
   ways alike. k: load q l^3 / (E I) */
START_TEST(slices_bend_both_ways_alike) {
    static const double low[3] = {0.37, 0.07, 0.73};
    const double t = 0.1, k = 4, rod = 0.42516 * 8, young = 12 * 1000 * 1e-3 * pow(8, 3) / (k * t * t);
    const double down = drop_of(1, low[_i], t, young, -1e-3), up = drop_of(1, low[_i], t, young, 1e-3);
    ck_assert_msg(fabs(down - up) < 0.1 * rod, "%d: %g down, %g up", _i, down / 8, up / 8);
    ck_assert_msg(fmin(down, up) > 0.87 * rod && fmax(down, up) < 1.01 * rod, "%d: %g, %g", _i, down / rod, up / rod);
}
END_TEST

/* Free sheets under gravity, each integrator: momenta are those of free fall. */
START_TEST(flung_sheets_keep_their_momentum) {
    static const gxs_integrator integrators[4] = {GXS_BDF1, GXS_BDF2, GXS_MIDPOINT, GXS_EXPLICIT};
    workload w = grid(4, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gx_motion before[4], after[4];
    gx_view view;
    uint32_t f;
    int round, k;
    random_seed((uint64_t)_i);
    add_axis_plane(&w, 2, 0.37);
    add_axis_plane(&w, 2, 0.6);
    cut_by(body, &w, 0, 2);
    step.integrator = integrators[_i];
    step.newton_iterations = 3;
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    shake(body, 0.02);
    ck_assert_int_eq(gx_body_motion(body, before, 4, NULL), GX_OK);
    for (round = 0; round < 5; round++) advance(body, &step);
    ck_assert_int_eq(gx_body_motion(body, after, 4, NULL), GX_OK);
    for (f = 0; f < 3; f++)
        for (k = 0; k < 3; k++)
            ck_assert_msg(fabs(after[f].velocity[k] - before[f].velocity[k] + (k == 2 ? 0.5 : 0)) < 1e-6,
                          "%d: %.12g %.12g", _i, after[f].velocity[k], before[f].velocity[k]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A stiff spring takes its point to the target, at an anchor and at a vertex of the skin; a pushed anchor moves as one
   that springs pull with that force. So points of affine copies are where gx_body_anchor_point has them. */
START_TEST(points_move_with_affine_copies) {
    workload w = grid(4, 2, 1, 5);
    gx_body *body = sheet_body(&w, 1), *pushed;
    gx_step_desc step = step_of(0, 0);
    const double material[3] = {3.3, 1.2, 0.45};
    gx_anchor anchor;
    gxs_spring springs[2];
    gx_anchor anchors[2];
    gx_skin skin;
    gx_view view;
    double force[6], at[3], rest[3], *x;
    uint32_t element = 0, vertex = 0;
    int k, round;
    add_axis_plane(&w, 2, 0.37);
    add_axis_plane(&w, 2, 0.6);
    cut_by(body, &w, 0, 2);
    hold_left(body);
    while (gx_body_anchor(body, element, material, &anchor, NULL) != GX_OK) element++;
    ck_assert_int_eq(gx_body_clone(body, &pushed, NULL), GX_OK);
    ck_assert_int_eq(gx_body_anchor_point(body, &anchor, NULL, rest, NULL), GX_OK);
    memset(springs, 0, sizeof springs);
    for (k = 0; k < 3; k++) springs[0].target[k] = rest[k] + (k == 2 ? 0.3 : 0.1);
    springs[0].stiffness = 1e9;
    anchors[0] = anchor;
    step.integrator = GXS_STATIC;
    step.newton_iterations = 100;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-6;
    step.cg_iterations = 20000;
    step.springs = springs;
    step.spring_count = 1;
    step.spring_anchors = anchors;
    step.spring_forces = force;
    advance(body, &step);
    ck_assert_int_eq(gx_body_anchor_point(body, &anchor, NULL, at, NULL), GX_OK);
    for (k = 0; k < 3; k++) {
        ck_assert_msg(fabs(at[k] - springs[0].target[k]) < 1e-4, "%g %g", at[k], springs[0].target[k]);
        ck_assert(fabs(force[k] - 1e9 * (springs[0].target[k] - at[k])) <= 1e-5 * (1 + fabs(force[2])));
    }
    step.spring_count = 0;
    step.force_anchors = &anchor;
    step.anchor_forces = force;
    step.force_count = 1;
    advance(pushed, &step);
    ck_assert_int_eq(gx_body_anchor_point(pushed, &anchor, NULL, at, NULL), GX_OK);
    for (k = 0; k < 3; k++)
        ck_assert_msg(fabs(at[k] - springs[0].target[k]) < 1e-3, "%g %g", at[k], springs[0].target[k]);
    step.force_count = 0;
    step.spring_anchors = NULL;
    for (round = 0; round < 2; round++) {
        ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
        x = (double *)oracle_memory(NULL, 3 * skin.vertex_count, sizeof *x);
        if (round == 0) { /* a vertex within an element: several affine copies move it */
            view = view_of(body);
            for (vertex = 0; !(skin.vertex_weights[4 * vertex] < 0.8 && skin.vertex_rest[3 * vertex] > 2 &&
                               view.copy_affine[skin.vertex_copies[4 * vertex]]);
                 vertex++)
                ck_assert_uint_lt(vertex, skin.vertex_count);
            springs[0].point = gx_skin_point(&skin, vertex);
            for (k = 0; k < 3; k++) springs[0].target[k] = skin.vertex_rest[3 * vertex + (uint32_t)k] + 0.2;
            step.spring_count = 1;
            advance(body, &step);
        } else {
            ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
            for (k = 0; k < 3; k++)
                ck_assert_msg(fabs(x[3 * vertex + (uint32_t)k] - springs[0].target[k]) < 1e-4, "%g",
                              x[3 * vertex + (uint32_t)k]);
        }
        free(x);
    }
    gx_body_destroy(body);
    gx_body_destroy(pushed);
    wl_free(&w);
}
END_TEST

/* A plane stops a falling sheet at the positions of the skin. */
START_TEST(planes_stop_sheets) {
    workload w = grid(4, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gxs_plane plane;
    gxs_point *points;
    gx_skin skin;
    double *x, lowest = 1;
    size_t i;
    int frame;
    add_axis_plane(&w, 2, 0.37);
    cut_by(body, &w, 0, 1);
    memset(&plane, 0, sizeof plane);
    plane.normal[2] = 1;
    plane.offset = -0.2;
    plane.stiffness = 1e6;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    points = (gxs_point *)oracle_memory(NULL, skin.vertex_count, sizeof *points);
    x = (double *)oracle_memory(NULL, 3 * skin.vertex_count, sizeof *x);
    for (i = 0; i < skin.vertex_count; i++) points[i] = gx_skin_point(&skin, (uint32_t)i);
    step.points = points;
    step.point_count = skin.vertex_count;
    step.planes = &plane;
    step.plane_count = 1;
    step.newton_iterations = 3;
    for (frame = 0; frame < 40; frame++) advance(body, &step);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (i = 0; i < skin.vertex_count; i++) lowest = fmin(lowest, x[3 * i + 2]);
    ck_assert_msg(lowest > -0.25 && lowest < -0.1, "%g", lowest);
    free(points);
    free(x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* What a region holds goes where its pose puts it, as a rigid body; where it has none it stays. */
START_TEST(poses_turn_affine_copies) {
    const double c = cos(0.4), s = sin(0.4);
    const double pose[12] = {c, 0, s, 0.3, 0, 1, 0, -0.1, -s, 0, c, 0.2};
    workload w = grid(3, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    const gx_region ends[2] = {gx_region_half_space(0, -1, 1e-9), gx_region_half_space(0, 1, 3 - 1e-9)};
    gx_step_desc step = step_of(0.05, -10);
    double poses[24];
    gx_view view;
    size_t i;
    int k, a, frame, seen = 0;
    ck_assert_int_eq(gx_body_hold(body, ends, 2, NULL), GX_OK);
    memcpy(poses, pose, sizeof pose);
    memset(poses + 12, 0, sizeof pose); /* none */
    for (frame = 0; frame < 2; frame++) {
        step.region_poses = frame == 0 ? poses : NULL;
        advance(body, &step);
        view = view_of(body);
        for (i = 0; i < view.copy_count; i++)
            for (k = 0; k < 9 && view.copy_held[i]; k++) {
                const int left = body->mesh.positions[3 * (size_t)view.copy_node[i]] < 1;
                a = k / 3;
                ck_assert(fabs(view.affine[9 * i + (size_t)k] - left * (pose[4 * (k % 3) + a] - (a == k % 3))) < 1e-12);
                seen++;
            }
    }
    ck_assert_int_eq(seen, 2 * 16 * 9);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Forces and targets by copy are those of anchors at its node, and of a region's pose. */
START_TEST(arrays_reach_affine_copies) {
    workload w = grid(4, 2, 1, 5);
    gx_body *bodies[2];
    double arrays[2][90], force[3] = {300, -200, 500}, half[3] = {150, -100, 250}, pose[12];
    gx_anchor anchor;
    int way, k;
    size_t i;
    memset(pose, 0, sizeof pose);
    for (k = 0; k < 3; k++) pose[5 * k] = 1, pose[4 * k + 3] = 0.1 * (k + 1);
    for (way = 0; way < 2; way++) {
        gx_step_desc step = step_of(0.05, -1);
        gx_view view;
        uint32_t element = 0;
        size_t corner = 0;
        gx_body *body = bodies[way] = sheet_body(&w, 1);
        view = view_of(body);
        ck_assert_uint_eq(view.copy_count, 30);
        hold_left(body);
        while (w.positions[3 * view.copy_node[corner]] < 4 || w.positions[3 * view.copy_node[corner] + 1] < 2) corner++;
        while (gx_body_anchor(body, element, w.positions + 3 * view.copy_node[corner], &anchor, NULL) != GX_OK)
            element++;
        memset(arrays, 0, sizeof arrays);
        memcpy(arrays[0] + 3 * corner, way == 0 ? half : force, sizeof force);
        for (i = 0; i < 90; i++) arrays[1][i] = 0.1 * (double)(i % 3 + 1);
        step.forces = way == 0 ? arrays[0] : NULL;
        step.targets = way == 1 ? arrays[1] : NULL;
        step.region_poses = way == 0 ? pose : NULL;
        step.epoch = view.epoch;
        step.force_anchors = &anchor;
        step.anchor_forces = way == 0 ? half : force;
        step.force_count = 1;
        advance(body, &step);
        step.force_count = 0;
        memcpy(arrays[0] + 3 * corner, force, sizeof force);
        step.forces = arrays[0];
        advance(body, &step);
    }
    for (i = 0; i < 90; i++) {
        const double *u[2];
        for (way = 0; way < 2; way++) u[way] = view_of(bodies[way]).displacement + i;
        ck_assert_msg(fabs(*u[0] - *u[1]) < 1e-9 && fabs(*u[0]) > 1e-4, "%zu: %g %g", i, *u[0], *u[1]);
    }
    for (way = 0; way < 2; way++) gx_body_destroy(bodies[way]);
    wl_free(&w);
}
END_TEST

/* A cut body of which some copies are affine. flap: a slice hangs together with the rest at its end, in elements of
   which some copies are affine */
static gx_body *partly_affine(workload *w, int flap) {
    gx_body *body;
    int i;
    *w = grid(5, 4, 3, 5);
    body = sheet_body(w, 1);
    for (i = 0; i < 2; i++) {
        const double z = i == 0 ? 1.37 : 1.6, x = flap ? 1.3 : -64;
        const double a[3] = {x, -64, z}, b[3] = {64, -64, z}, c[3] = {64, 64, z}, d[3] = {x, 64, z};
        wl_add_quad(wl_add_surface(w, 0), a, b, c, d);
    }
    add_axis_plane(w, 0, flap ? 9 : 2.31);
    cut_by(body, w, 0, 3);
    ck_assert_uint_gt(affine_count(body), 0);
    ck_assert_uint_lt(affine_count(body), view_of(body).copy_count);
    return body;
}

/* The vertex of the skin with four copies, of which the first is affine or not */
static uint32_t find_vertex(gx_body *body, const gx_skin *skin, int affine) {
    const gx_view view = view_of(body);
    uint32_t v;
    for (v = 0; v < skin->vertex_count; v++)
        if (skin->vertex_weights[4 * v + 3] > 0.05 && skin->vertex_rest[3 * v] > 1 &&
            view.copy_affine[skin->vertex_copies[4 * v]] == affine)
            return v;
    ck_abort_msg("no vertex is like that");
    return 0;
}

/* Springs at points in one's own words: copies in the point, a span, the same copies twice. All move the body alike,
   also one whose point has no affine copy. What is wrong is refused as in other bodies, hidden vectors are no copies.
 */
START_TEST(points_are_told_in_many_ways) {
    enum { WAYS = 3 };
    uint32_t copies[64], v[2];
    double weights[64], *end[WAYS], off = 0, most = 0;
    size_t n = 0, i;
    int way, k, s;
    gx_failure failure;
    for (way = 0; way < WAYS; way++) {
        workload w;
        gx_body *body = partly_affine(&w, 0);
        gx_step_desc step = step_of(0.05, 0);
        gxs_spring springs[2], bad;
        gx_skin skin;
        uint64_t hash;
        hold_left(body);
        memset(springs, 0, sizeof springs);
        memset(copies, 0, sizeof copies);
        memset(weights, 0, sizeof weights);
        ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
        for (s = 0; s < 2; s++) {
            gxs_point *point = &springs[s].point;
            v[s] = find_vertex(body, &skin, s);
            *point = gx_skin_point(&skin, v[s]);
            ck_assert_uint_eq(point->count, 4);
            springs[s].stiffness = 1e5;
            for (k = 0; k < 3; k++) springs[s].target[k] = skin.vertex_rest[3 * v[s] + (uint32_t)k] + 0.1;
            for (k = 0; k < 8 && way > 0; k++) {
                copies[8 * s + k] = point->copy[k % 4];
                weights[8 * s + k] = point->weight[k % 4] / way;
            }
            if (way == 0) continue;
            point->copies = copies + 8 * s;
            point->weights = weights + 8 * s;
            point->count = way == 1 ? 4 : 8;
        }
        step.springs = springs;
        step.spring_count = 2;
        step.cg_tolerance = 1e-8;
        step.cg_iterations = 20000;
        step.newton_iterations = 20;
        step.newton_tolerance = 1e-10;
        advance(body, &step);
        n = 3 * view_of(body).copy_count;
        end[way] = (double *)oracle_memory(NULL, n, sizeof(double));
        memcpy(end[way], view_of(body).displacement, n * sizeof(double));
        hash = gx_body_state_hash(body);
        for (k = 0; k < 12 && way == 1; k++) {
            static const char *const fields[12] = {"springs",
                                                   "points",
                                                   "spring_count",
                                                   "point_count",
                                                   "springs.point.weights",
                                                   "springs.point.copies",
                                                   "springs.point.copies",
                                                   "springs.point.count",
                                                   "springs.point.copies",
                                                   "springs.point.copies",
                                                   "epoch",
                                                   "points.copies"};
            const gx_result results[12] = {GX_ERROR_ARGUMENT, GX_ERROR_ARGUMENT, GX_ERROR_LIMIT,    GX_ERROR_LIMIT,
                                           GX_ERROR_ARGUMENT, GX_ERROR_ARGUMENT, GX_ERROR_ARGUMENT, GX_ERROR_LIMIT,
                                           GX_ERROR_INDEX,    GX_ERROR_INDEX,    GX_ERROR_STALE,    GX_ERROR_INDEX};
            bad = springs[1];
            step.springs = k == 0 ? NULL : &bad;
            step.spring_count = k == 2 ? SIZE_MAX : 1;
            step.points = k == 3 || k == 11 ? &bad.point : NULL;
            step.point_count = k == 1 || k == 11 ? 1 : k == 3 ? SIZE_MAX : 0;
            if (k == 4) bad.point.weights = NULL;
            if (k == 5) bad.point.copies = NULL;
            if (k == 6) bad.point.copies = NULL, bad.point.weights = NULL, bad.point.count = 5;
            if (k == 7) bad.point.count = GXS_POINT_MOST + 1;
            copies[8] = k == 8 ? (uint32_t)(n / 3) : k == 9 ? UINT32_MAX : springs[1].point.copy[0];
            if (k == 10) bad.point.epoch--;
            if (k == 11) copies[16] = (uint32_t)(n / 3), bad.point.copies = copies + 16, step.spring_count = 0;
            ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), results[k]);
            ck_assert_msg(failure.field != NULL && strstr(failure.field, fields[k]) != NULL, "%d: %s", k,
                          failure.field ? failure.field : "");
            ck_assert_uint_eq(gx_body_state_hash(body), hash);
        }
        gx_body_destroy(body);
        wl_free(&w);
    }
    ck_assert_mem_eq(end[0], end[1], n * sizeof(double));
    for (i = 0; i < n; i++) {
        off = fmax(off, fabs(end[2][i] - end[0][i]));
        most = fmax(most, fabs(end[0][i]));
    }
    ck_assert_msg(off < 1e-9 * most && most > 0.01, "%g of %g", off, most);
    for (way = 0; way < WAYS; way++) free(end[way]);
}
END_TEST

/* Numbers that are not finite are told by the copy, whichever of its vectors has them. */
START_TEST(failures_name_copies) {
    static const char *const fields[6] = {"displacement", "velocity", "displacement", "velocity", "forces", NULL};
    workload w = grid(3, 2, 1, 5);
    int which;
    for (which = 0; which < 6; which++) {
        gx_body *body = sheet_body(&w, 1);
        gx_step_desc step = step_of(0.01, -10);
        const gx_view view = view_of(body);
        double forces[72], *arrays[5];
        gx_failure failure;
        memset(forces, 0, sizeof forces);
        ck_assert_uint_eq(view.copy_count, 24);
        arrays[0] = view.displacement + 3 * 5;
        arrays[1] = view.velocity + 3 * 5;
        arrays[2] = body->copies.linear + 9 * 5 + 4;
        arrays[3] = body->copies.linear_rate + 9 * 5 + 4;
        arrays[4] = forces + 3 * 5;
        if (which < 5) *arrays[which] = HUGE_VAL;
        if (which == 4) step.forces = forces, step.epoch = view.epoch;
        if (which == 5) step.integrator = GXS_STATIC, step.dt = 0;
        ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), which < 5 ? GX_ERROR_NOT_FINITE : GX_ERROR_FREE);
        ck_assert(which == 5 ? failure.field == NULL : strcmp(failure.field, fields[which]) == 0);
        ck_assert_msg(failure.index == (which < 5 ? 5 : 0), "%d: %zu", which, failure.index);
        gx_body_destroy(body);
    }
    wl_free(&w);
}
END_TEST

/* A film that is cut out is a speck: it moves as a point, although its copies are affine: what is left of their turning
 * is dropped. */
START_TEST(specks_do_not_turn) {
    workload w = grid(3, 3, 6, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gx_view view;
    size_t i, affine = 0;
    hold_left(body);
    add_axis_plane(&w, 2, 3.3);
    add_axis_plane(&w, 2, 3.3 + 1e-10);
    cut_by(body, &w, 0, 2);
    shake(body, 0.01);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    advance(body, &step);
    ck_assert_uint_eq(body->hidden.copies.count, 0);
    for (i = 0; i < 9 * view.copy_count; i++) {
        affine += view.copy_affine[i / 9] != 0;
        ck_assert(view.affine_rate[i] == 0);
    }
    ck_assert_uint_gt(affine, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A plate that is taken away whole: its affine copies go, too, and steps and cuts of nothing are nothing. */
START_TEST(nothing_is_left) {
    workload w = grid(3, 2, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gx_step_report report;
    gx_surface tool;
    hold_left(body);
    advance(body, &step);
    add_box(&w, 1, -1, -1, -1, 4, 3, 2);
    tool = surface_of(&w.surfaces[0]);
    ck_assert_int_eq(gx_body_carve(body, &tool, NULL, NULL), GX_OK);
    add_axis_plane(&w, 0, 1.2);
    cut_by(body, &w, 1, 1);
    ck_assert_uint_eq(view_of(body).copy_count, 0);
    ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
    ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- states ---- */

static void cut_into_sheets(gx_body *body, workload *w) {
    add_axis_plane(w, 2, 0.37);
    add_axis_plane(w, 2, 0.6);
    cut_by(body, w, w->surface_count - 2, 2);
}

static void expect_same_motion(gx_body *a, gx_body *b) {
    const gx_view p = view_of(a), q = view_of(b);
    ck_assert_uint_eq(p.copy_count, q.copy_count);
    ck_assert(memcmp(p.displacement, q.displacement, 3 * p.copy_count * sizeof(double)) == 0);
    ck_assert(memcmp(p.velocity, q.velocity, 3 * p.copy_count * sizeof(double)) == 0);
    ck_assert(memcmp(p.affine, q.affine, 9 * p.copy_count * sizeof(double)) == 0);
    ck_assert(memcmp(p.affine_rate, q.affine_rate, 9 * p.copy_count * sizeof(double)) == 0);
    ck_assert(memcmp(p.copy_affine, q.copy_affine, p.copy_count) == 0);
    ck_assert_uint_eq(gx_body_state_hash(a), gx_body_state_hash(b));
}

/* A saved, a cloned and a restored body go on as the first does, bit by bit, also through a cut of affine copies. */
START_TEST(copies_go_on_alike) {
    static const gxs_integrator integrators[2] = {GXS_BDF1, GXS_BDF2};
    workload w = grid(5, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1), *loaded, *cloned, *restored, *other;
    gx_body_desc none;
    gx_step_desc step = step_of(0.01, -10);
    void *memory;
    size_t size;
    int round;
    memset(&none, 0, sizeof none);
    step.integrator = integrators[_i];
    hold_left(body);
    cut_into_sheets(body, &w);
    restored = sheet_body(&w, 1);
    cut_by(restored, &w, 0, 2);
    other = sheet_body(&w, 0);
    for (round = 0; round < 3; round++) advance(body, &step);
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    memory = oracle_memory(NULL, size, 1);
    ck_assert_int_eq(gx_body_save(body, memory, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(memory, size, &none, &loaded, NULL), GX_OK);
    ck_assert_int_eq(gx_body_clone(body, &cloned, NULL), GX_OK);
    ck_assert_int_eq(gx_body_restore(restored, body, NULL), GX_OK);
    ck_assert_int_eq(gx_body_restore(other, body, NULL), GX_OK);
    add_axis_plane(&w, 1, 1.3);
    for (round = 0; round < 4; round++) {
        gx_body *bodies[5];
        int i;
        bodies[0] = body;
        bodies[1] = loaded;
        bodies[2] = cloned;
        bodies[3] = restored;
        bodies[4] = other;
        for (i = 0; i < 5; i++) {
            if (round == 2) cut_by(bodies[i], &w, 2, 1);
            advance(bodies[i], &step);
            expect_same_motion(bodies[0], bodies[i]);
        }
    }
    ck_assert_int_eq(gx_body_restore(body, loaded, NULL), GX_OK);
    expect_same_motion(body, loaded);
    free(memory);
    gx_body_destroy(body);
    gx_body_destroy(loaded);
    gx_body_destroy(cloned);
    gx_body_destroy(restored);
    gx_body_destroy(other);
    wl_free(&w);
}
END_TEST

/* What is neither affine nor not is no saved body. */
START_TEST(damaged_flags_are_refused) {
    workload w = grid(2, 1, 1, 5);
    gx_body *body = sheet_body(&w, 1), *loaded = NULL;
    uint8_t flag;
    for (flag = 0; flag < 3; flag++) {
        size_t size;
        void *memory;
        body->copies.affine[1] = flag;
        ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
        memory = oracle_memory(NULL, size, 1);
        ck_assert_int_eq(gx_body_save(body, memory, size, &size, NULL), GX_OK);
        ck_assert_int_eq(gx_body_load(memory, size, NULL, &loaded, NULL), flag < 2 ? GX_OK : GX_ERROR_DAMAGED);
        if (flag < 2) gx_body_destroy(loaded);
        free(memory);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Where no copy becomes affine, steps are those of a body without the feature, bit by bit. */
START_TEST(none_is_none) {
    workload w = grid(4, 4, 4, 5);
    gx_body *off = sheet_body(&w, 0), *on = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gx_view p, q;
    int round;
    add_axis_plane(&w, 2, 2.02);
    cut_by(off, &w, 0, 1);
    cut_by(on, &w, 0, 1);
    for (round = 0; round < 3; round++) {
        advance(off, &step);
        advance(on, &step);
    }
    p = view_of(off);
    q = view_of(on);
    ck_assert_uint_eq(affine_count(on), 0);
    ck_assert(p.copy_affine == NULL && p.affine == NULL && p.affine_rate == NULL && q.copy_affine != NULL);
    ck_assert(memcmp(p.displacement, q.displacement, 3 * p.copy_count * sizeof(double)) == 0);
    ck_assert(memcmp(p.velocity, q.velocity, 3 * p.copy_count * sizeof(double)) == 0);
    gx_body_destroy(off);
    gx_body_destroy(on);
    wl_free(&w);
}
END_TEST

/* Random cuts of sheets that move, with slivers, chips and specks of them: steps end, nothing runs away. */
START_TEST(cut_sheets_stay_together) {
    workload w = grid(5, 3, 1, _i % 2 ? 6 : 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gx_motion *motions;
    gx_view view;
    double energy = 0, most = 0, volume = 0;
    size_t f;
    int round;
    random_seed((uint64_t)_i);
    step.newton_iterations = 2;
    hold_left(body);
    for (round = 0; round < 12; round++) {
        if (round % 2 == 0) {
            add_random_cut(&w, 1);
            cut_by(body, &w, w.surface_count - 1, 1);
        }
        advance(body, &step);
    }
    view = view_of(body);
    motions = (gx_motion *)oracle_memory(NULL, view.fragment_count + 1, sizeof *motions);
    ck_assert_int_eq(gx_body_motion(body, motions, view.fragment_count, NULL), GX_OK);
    for (f = 0; f < view.fragment_count; f++) {
        energy += motions[f].energy;
        most = fmax(most, fabs(motions[f].center[2]));
        volume += view.fragment_volume[f];
    }
    ck_assert(affine_count(body) > 0);
    ck_assert(fabs(volume - view.volume) < 1e-9);
    /* free fall for 0.12 s: 0.072 m, 1.2 m/s */
    ck_assert_msg(most < 1.2, "seed %d: %g", _i, most);
    ck_assert_msg(energy < 0.55 * view.mass * 1.2 * 1.2, "seed %d: %g of %g", _i, energy, view.mass);
    free(motions);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- failure ---- */

/* Creates, holds, cuts, steps, looks, saves. Returns 1 if memory ran out, and then body and hash are as before. */
static int work(memory *m, const workload *w, int which) {
    gx_body *body = sheet_body_in(m, w, 1), *other = NULL;
    const gx_region left = gx_region_half_space(0, -1, 1e-9);
    gx_step_desc step = step_of(0.01, -10);
    gx_surface surfaces[2];
    gx_cut_desc cut;
    gx_motion motions[8];
    gxs_point point;
    gxs_spring spring;
    gx_anchor anchor;
    const double material[3] = {1.6, 0.3, 0.5};
    uint64_t hash;
    gx_result result = body == NULL ? GX_ERROR_MEMORY : GX_OK;
    int stage;
    memset(&cut, 0, sizeof cut);
    memset(&spring, 0, sizeof spring);
    surfaces[0] = surface_of(&w->surfaces[0]);
    surfaces[1] = surface_of(&w->surfaces[1]);
    cut.surfaces = surfaces;
    cut.surface_count = 2;
    step.integrator = which ? GXS_BDF2 : GXS_BDF1;
    for (stage = 0; stage < 8 && result == GX_OK; stage++) {
        hash = gx_body_state_hash(body);
        switch (stage) {
        case 0: result = gx_body_hold(body, &left, 1, NULL); break;
        case 1: result = gx_body_cut(body, &cut, NULL, NULL); break;
        case 2: result = gx_body_motion(body, motions, 8, NULL); break;
        case 3: {
            uint32_t e = 0;
            while (result == GX_OK && gx_body_anchor(body, e, material, &anchor, NULL) == GX_ERROR_EMPTY) e++;
            result = gx_body_anchor(body, e, material, &anchor, NULL);
            if (result == GX_OK) result = gx_body_anchor_point(body, &anchor, &point, NULL, NULL);
            break;
        }
        case 4:
        case 5:
            spring.point = point;
            spring.stiffness = 10;
            step.springs = &spring;
            step.spring_count = 1;
            step.force_anchors = &anchor;
            step.anchor_forces = material;
            step.force_count = 1;
            result = gx_body_step(body, &step, NULL, NULL);
            break;
        case 6: result = gx_body_clone(body, &other, NULL); break;
        default: gx_body_destroy(other); other = NULL;
        }
        if (result != GX_OK) {
            ck_assert_int_eq(result, GX_ERROR_MEMORY);
            ck_assert_uint_eq(gx_body_state_hash(body), hash);
        }
    }
    gx_body_destroy(other);
    gx_body_destroy(body);
    return result != GX_OK;
}

START_TEST(every_allocation_may_fail) {
    workload w = grid(2, 1, 1, 5);
    int from_then_on;
    size_t n;
    add_axis_plane(&w, 2, 0.37);
    add_axis_plane(&w, 2, 0.6);
    for (from_then_on = 0; from_then_on < 2; from_then_on++)
        for (n = 0;; n++) {
            memory m = plenty();
            int failed;
            fail_from(&m, n, from_then_on);
            failed = work(&m, &w, _i);
            ck_assert(is_whole(&m));
            if (!failed) break;
            ck_assert_uint_lt(n, 3000);
        }
    wl_free(&w);
}
END_TEST

/* ---- picking and locating ---- */

/* Such a body, bent at random. size: of displacements and slopes */
static gx_body *bent_body(workload *w, double size, int flap) {
    gx_body *body = partly_affine(w, flap);
    shake(body, size);
    return body;
}

/* A ray meets the nearest triangle of the skin as it is drawn. */
START_TEST(rays_meet_what_is_drawn) {
    workload w;
    gx_body *body = bent_body(&w, 0.2, 0);
    gx_skin skin;
    double *x;
    int round, met = 0;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    x = (double *)oracle_memory(NULL, 3 * skin.vertex_count, sizeof *x);
    for (round = 0; round < 600 / FEWER; round++) {
        double origin[3], way[3], nearest = HUGE_VAL;
        gx_hit hit;
        size_t t;
        int k, j;
        if (round % 10 == 0) {
            const gx_view view = view_of(body);
            shake(body, 2);
            for (k = 0; round % 20 == 0 && k < (int)(3 * view.copy_count); k++) view.displacement[k] *= 0.01;
        }
        ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
        for (k = 0; k < 3; k++) origin[k] = random_real(-3, 8), way[k] = random_real(-1, 6) - origin[k];
        for (t = 0; t < skin.triangle_count; t++) { /* by Cramer's rule: origin + s way = a + p e + q f */
            const uint32_t *v = skin.triangles + 3 * t;
            double e[3], f[3], o[3], n[3], c[3], det, p, q, s;
            for (j = 0; j < 3; j++) {
                e[j] = x[3 * v[1] + j] - x[3 * v[0] + j];
                f[j] = x[3 * v[2] + j] - x[3 * v[0] + j];
                o[j] = origin[j] - x[3 * v[0] + j];
            }
            gxp_cross(n, e, f);
            det = gxp_dot(n, way);
            gxp_cross(c, o, way);
            p = -gxp_dot(c, f) / det;
            q = gxp_dot(c, e) / det;
            s = -gxp_dot(n, o) / det;
            if (p > 1e-9 && q > 1e-9 && p + q < 1 - 1e-9 && s >= 0 && s < nearest) nearest = s;
        }
        ck_assert_int_eq(gx_body_pick(body, origin, way, &hit, NULL), GX_OK);
        if (hit.triangle == UINT32_MAX) {
            ck_assert(nearest == HUGE_VAL);
            continue;
        }
        met++;
        ck_assert_msg(hit.distance <= nearest + 1e-9, "%g, %g", hit.distance, nearest);
        ck_assert(hit.distance > nearest - 1e-6 || nearest == HUGE_VAL);
    }
    ck_assert_int_gt(met, 10);
    free(x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Where the body places a material point of a cell, it is located again: the cell is found, and the point to rounding.
 */
START_TEST(located_points_are_placed_there) {
    const double size = _i % 2 ? 0.05 : 0.2;
    workload w;
    gx_body *body = bent_body(&w, size, _i / 2);
    gx_view view = view_of(body);
    int round, found = 0;
    random_seed((uint64_t)_i + 5);
    for (round = 0; round < 400 / FEWER; round++) {
        const uint32_t i = (uint32_t)random_below((int)view.cell_count), element = view.cell_element[i];
        const uint32_t *node = gxb_complex_element_nodes(body->complex, element);
        double share[4], material[3] = {0, 0, 0}, at[3], sum = 0;
        gx_hit hits[64], one;
        gx_anchor anchor;
        size_t count, j;
        int n, k, has = 0;
        for (n = 0; n < 4; n++) sum += share[n] = random_real(0.05, 1);
        for (n = 0; n < 4; n++)
            for (k = 0; k < 3; k++) material[k] += share[n] / sum * w.positions[3 * node[n] + k];
        ck_assert_int_eq(gx_body_anchor(body, element, material, &anchor, NULL), GX_OK);
        ck_assert_int_eq(gx_body_anchor_point(body, &anchor, NULL, at, NULL), GX_OK);
        ck_assert_int_eq(gx_body_locate_all(body, at, hits, 64, &count, NULL), GX_OK);
        for (j = 0; j < count; j++) {
            double back[3];
            ck_assert_int_eq(gx_body_place(body, hits[j].slot, hits[j].material, back, NULL), GX_OK);
            for (k = 0; k < 3; k++) ck_assert_msg(fabs(back[k] - at[k]) < 1e-12, "%g", back[k] - at[k]);
            ck_assert(hits[j].distance == 0);
            if (hits[j].element != element) continue;
            for (k = 0, n = 1; k < 3; k++) n &= fabs(hits[j].material[k] - material[k]) < 1e-9;
            has |= n;
        }
        ck_assert_int_eq(gx_body_locate(body, at, 1, &one, NULL), GX_OK);
        ck_assert(count == 0 || one.slot == hits[0].slot);
        if (has)
            found++;
        else
            ck_assert_msg(size > 0.1, "cell %u is not found", i); /* folded: Newton's method found another place */
    }
    ck_assert_msg(found >= 390 / FEWER, "%d", found);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Copies that turn and stay: what they move is located anew. In a plate crushed to a point nothing is. */
START_TEST(what_turns_is_located_anew) {
    workload w = grid(3, 2, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    const gx_view view = view_of(body);
    const double material[3] = {1.3, 0.6, 0.4}, nowhere[3] = {0, 0, 0};
    double at[3];
    uint32_t element = 0;
    gx_anchor anchor;
    gx_hit hit;
    size_t i;
    int turn, k;
    while (gx_body_anchor(body, element, material, &anchor, NULL) != GX_OK) element++;
    for (turn = 0; turn < 3; turn++) {
        for (i = 0; i < view.copy_count; i++) body->copies.linear[9 * i + 3] = 0.4 * turn; /* x by y - Y */
        ck_assert_int_eq(gx_body_anchor_point(body, &anchor, NULL, at, NULL), GX_OK);
        ck_assert_int_eq(gx_body_locate(body, at, 1, &hit, NULL), GX_OK);
        ck_assert(hit.distance == 0);
        for (k = 0; k < 3; k++) ck_assert(fabs(hit.material[k] - material[k]) < 1e-9);
    }
    at[2] = 1.5; /* above: the top is where it was */
    ck_assert_int_eq(gx_body_locate(body, at, 1, &hit, NULL), GX_OK);
    ck_assert_msg(fabs(hit.distance - 0.5) < 1e-9, "%g", hit.distance);
    for (i = 0; i < view.copy_count; i++)
        for (k = 0; k < 9; k++) {
            body->copies.linear[9 * i + (size_t)k] = k % 4 == 0 ? -1 : 0;
            view.displacement[3 * i + (size_t)k % 3] = -w.positions[3 * view.copy_node[i] + (size_t)k % 3];
        }
    ck_assert_int_eq(gx_body_locate_all(body, nowhere, NULL, 0, &i, NULL), GX_OK);
    ck_assert_uint_eq(i, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Outside of all cells: the nearest point of the surface that is drawn. */
START_TEST(nearest_points_of_bent_bodies) {
    workload w;
    gx_body *body = bent_body(&w, 0.05, 0);
    gx_skin skin;
    double *x;
    int round, outside = 0;
    random_seed((uint64_t)_i + 9);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    x = (double *)oracle_memory(NULL, 3 * skin.vertex_count, sizeof *x);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (round = 0; round < 100 / FEWER; round++) {
        double point[3], nearest = HUGE_VAL;
        gx_hit hit;
        size_t t;
        int k;
        for (k = 0; k < 3; k++) point[k] = random_real(-1, 6);
        for (t = 0; t < skin.triangle_count; t++) {
            const uint32_t *v = skin.triangles + 3 * t;
            double on[3];
            const double square = gxp_onto_triangle(point, x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], on);
            nearest = fmin(nearest, sqrt(square));
        }
        ck_assert_int_eq(gx_body_locate(body, point, 1, &hit, NULL), GX_OK);
        if (hit.distance == 0) continue;
        outside++;
        /* cells may have their facets in other triangles than the skin has: as far apart as faces are curved */
        ck_assert_msg(fabs(hit.distance - nearest) < 0.03, "%g, %g", hit.distance, nearest);
    }
    ck_assert_int_gt(outside, 20 / FEWER);
    free(x);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- blades ---- */

/* What a bent cell's map does with a place, also outside of its element, it undoes. */
START_TEST(maps_are_undone) {
    const double size = _i % 2 ? 0.05 : 0.15;
    workload w;
    gx_body *body = bent_body(&w, size, 0);
    int round, undone = 0, all = 0;
    random_seed((uint64_t)_i + 3);
    for (round = 0; round < 2000 / FEWER; round++) {
        const gxp_cell *c = &body->cells.data[random_below((int)body->cells.count)];
        double weights[4], back[4], x[3], again[3], off = 0, far = 0;
        int n, k;
        for (weights[0] = 1, n = 1; n < 4; n++) weights[0] -= weights[n] = random_real(-0.5, 1);
        if (!gxp_is_bent(body, c)) continue;
        all++;
        gxp_image_of_bent(body, c, weights, x);
        ck_assert(gxp_place_in_bent(body, c, x, back));
        gxp_image_of_bent(body, c, back, again);
        for (k = 0; k < 3; k++) off = fmax(off, fabs(again[k] - x[k]));
        for (n = 0; n < 4; n++) far = fmax(far, fabs(back[n] - weights[n]));
        undone += off < 1e-12 * (1 + far);
        if (size < 0.1) ck_assert_msg(off < 1e-12 && far < 1e-10, "%g, %g", off, far); /* no folds */
    }
    ck_assert_msg(undone > 0.97 * all && all > 100 / FEWER, "%d of %d", undone, all); /* folded: other places, or none
                                                                                       */
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A plate is rolled up and twisted: where a material point is, and the derivative there by its coordinates */
static void roll(double time, const double x[3], double at[3], double slope[3][3]) {
    const double turn = 0.35 * time, twist = 0.12 * time, angle = turn * x[0], r = 1 / turn - (x[2] - 0.5),
                 bend[3] = {r * sin(angle), x[1], 1 / turn - r * cos(angle)},
                 by[3][3] = {{r * turn * cos(angle), 0, r * turn * sin(angle)},
                             {0, 1, 0},
                             {-sin(angle), 0, cos(angle)}},
                 c = cos(twist * bend[1]), s = sin(twist * bend[1]);
    int j;
    at[0] = c * bend[0] + s * bend[2];
    at[1] = bend[1];
    at[2] = c * bend[2] - s * bend[0];
    for (j = 0; j < 3; j++) {
        slope[j][0] = c * by[j][0] + s * by[j][2] + twist * at[2] * by[j][1];
        slope[j][1] = by[j][1];
        slope[j][2] = c * by[j][2] - s * by[j][0] - twist * at[0] * by[j][1];
    }
}

/* All copies follow the roll. */
static void follow_roll(gx_body *body, double time) {
    const gx_view view = view_of(body);
    size_t i;
    int j, k;
    for (i = 0; i < view.copy_count; i++) {
        const double *x = body->mesh.positions + 3 * (size_t)view.copy_node[i];
        double at[3], slope[3][3];
        roll(time, x, at, slope);
        for (k = 0; k < 3; k++) view.displacement[3 * i + (size_t)k] = at[k] - x[k];
        for (j = 0; j < 3 && view.copy_affine[i]; j++)
            for (k = 0; k < 3; k++) body->copies.linear[9 * i + 3 * (size_t)j + (size_t)k] = slope[j][k] - (j == k);
    }
}

enum { ROLL_POINTS = 7 };
static double cut_place(double y) { return 2.9 + 0.5 * sin(0.9 * y); } /* of the sheet, x by y */

/* Where an uncut plate of 6 x 3 x 1 has a material point, also outside of it */
static void place_rolled(gx_body *twin, const double rest[3], double x[3]) {
    static const double origin[3] = {0, 0, 0}, size[3] = {6, 3, 1};
    double inside[3], corners[4][3], weights[4];
    uint32_t cell;
    int k;
    for (k = 0; k < 3; k++) inside[k] = fmin(fmax(rest[k], 1e-3), size[k] - 1e-3);
    ck_assert_int_eq(gxp_find_rest_cell(twin, inside, &cell), GX_OK);
    ck_assert_uint_ne(cell, UINT32_MAX);
    gxp_cell_corners(twin, &twin->cells.data[cell], 0, origin, corners);
    gxp_tet_weights(corners, rest, weights);
    gxp_image_of_bent(twin, &twin->cells.data[cell], weights, x);
}

/* The edge of a blade at a material line of the sheet, as the cells of an uncut body in the same motion have it */
static void roll_edge(gx_body *twin, double y, double edge[3 * ROLL_POINTS]) {
    static const double height[ROLL_POINTS] = {-0.5, 0, 0.25, 0.5, 0.75, 1, 1.5};
    int i;
    for (i = 0; i < ROLL_POINTS; i++) {
        const double rest[3] = {cut_place(y), y, height[i]};
        place_rolled(twin, rest, edge + 3 * i);
    }
}

/* How far the walls in the skin are from the sheet, and how many of their vertices there are */
static double wall_error(gx_body *body, size_t *vertices) {
    double error = 0;
    gx_skin skin;
    size_t t;
    int n;
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    *vertices = 0;
    for (t = 0; t < skin.triangle_count; t++)
        for (n = 0; n < 3 && skin.triangle_surface[t] != GX_SKIN_OUTER; n++) {
            const double *x = skin.vertex_rest + 3 * (size_t)skin.triangles[3 * t + (size_t)n];
            error = fmax(error, fabs(x[0] - cut_place(x[1])));
            *vertices += 1;
        }
    return error;
}

/* A blade follows a known sheet through a plate that is rolled up meanwhile: two pieces, their wall is the sheet. */
START_TEST(blades_cut_rolled_plates) {
    workload w = grid(6, 3, 1, _i % 2 ? 5 : 6);
    gx_body *body = sheet_body(&w, 1), *twin = sheet_body(&w, 1);
    const int frames = 20 + 10 * (_i % 3);
    double edge[3 * ROLL_POINTS], error;
    gx_blade *blade;
    gx_view view;
    size_t vertices;
    int i;
    ck_assert_uint_eq(affine_count(body), w.node_count);
    ck_assert_int_eq(gx_blade_create(body, NULL, &blade, NULL), GX_OK);
    for (i = 0; i <= frames; i++) {
        const double time = 0.1 + (double)i / frames;
        follow_roll(body, time);
        follow_roll(twin, time);
        roll_edge(twin, -0.5 + 4.0 * i / frames, edge);
        ck_assert_int_eq(gx_blade_move(blade, edge, ROLL_POINTS, NULL, 0, NULL, NULL), GX_OK);
    }
    ck_assert_int_eq(gx_blade_lift(blade, NULL, NULL), GX_OK);
    view = view_of(body);
    ck_assert_msg(view.fragment_count == 2, "%u", (unsigned)view.fragment_count);
    error = wall_error(body, &vertices);
    ck_assert_msg(error < 0.03 && vertices > 20, "%g, %zu", error, vertices);
    gx_body_destroy(body);
    gx_body_destroy(twin);
    wl_free(&w);
}
END_TEST

/* Soft plates are flung, and a straight edge passes through them. GXFEM_PASSES: how many */
START_TEST(blades_pass_through_flung_plates) {
    workload w = grid(6, 3, 1, _i % 2 ? 5 : 6);
    gx_step_desc step = step_of(0.02, -2);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL;
    gx_blade *blade = NULL;
    gx_view view;
    double phase, fast, twist, at, tilt;
    size_t i;
    int k;
    random_seed((uint64_t)_i + 1);
    phase = random_real(0, 6);
    fast = random_real(1, 3);
    twist = random_real(-1, 1);
    at = random_real(1.5, 4.5);
    tilt = random_real(-0.5, 0.5);
    desc.affine_below = 1;
    desc.young = 3e4;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) {
        const double *x = body->mesh.positions + 3 * (size_t)view.copy_node[i];
        view.velocity[3 * i + 2] = fast * sin(0.8 * x[0] + phase) + twist * (x[1] - 1.5);
    }
    ck_assert_int_eq(gx_blade_create(body, NULL, &blade, NULL), GX_OK);
    for (k = 0; k <= 24; k++) {
        const double y = -0.6 + 4.2 * k / 24, edge[6] = {at - 4 * tilt, y, -4, at + 4 * tilt, y + 0.3, 5};
        advance(body, &step);
        ck_assert_int_eq(gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL), GX_OK);
    }
    ck_assert_int_eq(gx_blade_lift(blade, NULL, NULL), GX_OK);
    view = view_of(body);
    ck_assert_msg(view.fragment_count == 2, "seed %d: %u", _i + 1, (unsigned)view.fragment_count);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* The material that a drill covers goes from a rolled plate: a box at rest, of which the plate's motion makes the tool.
 */
START_TEST(rolled_plates_are_carved) {
    enum { ALONG = 8 };
    workload w = grid(6, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1), *twin = sheet_body(&w, 1);
    static const double low[3] = {2.2, 0.8, -0.3}, high[3] = {3.7, 2.1, 1.3};
    double vertices[6 * (ALONG + 1) * (ALONG + 1)][3];
    uint32_t triangles[12 * ALONG * ALONG][3], same[6 * (ALONG + 1) * (ALONG + 1)], count = 0, n = 0;
    gx_cut_report report;
    gx_surface tool;
    int face, i, j;
    follow_roll(body, 0.8);
    follow_roll(twin, 0.8);
    for (face = 0; face < 6; face++) {
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (i = 0; i <= ALONG; i++)
            for (j = 0; j <= ALONG; j++, n++) {
                double rest[3];
                rest[axis] = face % 2 ? high[axis] : low[axis];
                rest[u] = i == ALONG ? high[u] : low[u] + (high[u] - low[u]) * i / ALONG;
                rest[v] = j == ALONG ? high[v] : low[v] + (high[v] - low[v]) * j / ALONG;
                place_rolled(twin, rest, vertices[n]);
                for (same[n] = 0; memcmp(vertices[same[n]], vertices[n], sizeof vertices[n]) != 0;) same[n]++;
                if (i < ALONG && j < ALONG) {
                    const uint32_t other = n + 1, next = n + ALONG + 1, last = n + ALONG + 2;
                    const uint32_t t[2][2][3] = {{{n, last, next}, {n, other, last}},
                                                 {{n, next, last}, {n, last, other}}};
                    memcpy(triangles[count], t[face % 2], sizeof t[0]);
                    count += 2;
                }
            }
    }
    memset(&tool, 0, sizeof tool);
    for (n = 0; n < count; n++)
        for (i = 0; i < 3; i++) triangles[n][i] = same[triangles[n][i]]; /* faces share their rims */
    tool.vertices = vertices[0];
    tool.vertex_count = 6 * (ALONG + 1) * (ALONG + 1);
    tool.triangles = triangles[0];
    tool.triangle_count = count;
    ck_assert_int_eq(gx_body_carve(body, &tool, &report, NULL), GX_OK);
    ck_assert_msg(fabs(report.removed_volume - 1.5 * 1.3) < 0.02, "%g", report.removed_volume);
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    gx_body_destroy(body);
    gx_body_destroy(twin);
    wl_free(&w);
}
END_TEST

/* Contacts of an edge in a bent body: as long as what of the edge is in the body, each where its material is */
START_TEST(contacts_in_bent_bodies) {
    workload w;
    gx_body *body = bent_body(&w, 0.05, 0);
    gx_blade_desc desc;
    gx_blade *blade = NULL;
    int round, met = 0;
    random_seed((uint64_t)_i + 21);
    memset(&desc, 0, sizeof desc);
    desc.starts_inside = 1;
    ck_assert_int_eq(gx_blade_create(body, &desc, &blade, NULL), GX_OK);
    for (round = 0; round < 40 / FEWER; round++) {
        enum { SAMPLES = 2000, ROOM = 256 };
        static gx_blade_contact contacts[ROOM];
        double edge[6], sum = 0, length = 0;
        size_t count, i, inside = 0;
        int k;
        for (k = 0; k < 3; k++) {
            edge[k] = random_real(-4, -2);
            edge[3 + k] = random_real(6, 8);
            length += (edge[3 + k] - edge[k]) * (edge[3 + k] - edge[k]);
        }
        ck_assert_int_eq(gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL), GX_OK);
        ck_assert_int_eq(gx_blade_contacts(blade, contacts, ROOM, &count, NULL), GX_OK);
        for (i = 0; i < SAMPLES; i++) {
            gx_hit hits[16];
            double x[3];
            size_t all;
            for (k = 0; k < 3; k++) x[k] = edge[k] + (edge[3 + k] - edge[k]) * ((double)i + 0.5) / SAMPLES;
            ck_assert_int_eq(gx_body_locate_all(body, x, hits, 16, &all, NULL), GX_OK);
            inside += all; /* pieces overlap: each is met */
        }
        for (i = 0; i < count; i++) {
            double back[3];
            const gx_hit *hit = &contacts[i].hit;
            ck_assert_int_eq(gx_body_place(body, hit->slot, hit->material, back, NULL), GX_OK);
            for (k = 0; k < 3; k++) ck_assert(fabs(back[k] - hit->position[k]) < 1e-4);
            sum += contacts[i].length;
        }
        met += inside > 0;
        ck_assert_msg(fabs(sum - sqrt(length) * (double)inside / SAMPLES) < 0.05 + 0.02 * sum, "%g, %g", sum,
                      sqrt(length) * (double)inside / SAMPLES);
        ck_assert_int_eq(gx_blade_lift(blade, NULL, NULL), GX_OK);
        if (round == 0) ck_assert_uint_gt(count, 3);
    }
    ck_assert_int_gt(met, 4);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Cells that motion has made flat hold nothing: blades pass them and points miss them. */
START_TEST(flat_cells_hold_nothing) {
    workload w;
    gx_body *body = partly_affine(&w, _i);
    const gx_view view = view_of(body);
    const double edges[2][6] = {{-9, -0.4, -0.1, 9, -0.3, 0.1}, {-9, 5.3, -0.1, 9, 5.4, 0.1}};
    double x[3] = {2.5, 2.1, 0}, back[3];
    gx_blade *blade = NULL;
    gx_blade_report report;
    gx_hit hits[16];
    size_t i, count;
    for (i = 0; i < view.copy_count; i++) {
        view.displacement[3 * i + 2] = -w.positions[3 * view.copy_node[i] + 2];
        if (view.copy_affine[i]) body->copies.linear[9 * i + 8] = -1;
    }
    ck_assert_int_eq(gx_body_locate_all(body, x, hits, 16, &count, NULL), GX_OK);
    for (i = 0; i < count; i++) {
        ck_assert_int_eq(gx_body_place(body, hits[i].slot, hits[i].material, back, NULL), GX_OK);
        ck_assert_double_lt(fabs(back[0] - x[0]) + fabs(back[1] - x[1]) + fabs(back[2]), 1e-6);
    }
    ck_assert_int_eq(gx_blade_create(body, NULL, &blade, NULL), GX_OK);
    for (i = 0; i < 2; i++) ck_assert_int_eq(gx_blade_move(blade, edges[i], 2, NULL, 0, &report, NULL), GX_OK);
    ck_assert_int_eq(gx_blade_lift(blade, NULL, NULL), GX_OK);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Blades that may leave out moves: the cut that one of them makes, or another cut, leaves thin slices. Moves count. */
START_TEST(moves_before_slices) {
    workload w = grid(3, 2, 2, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, 0);
    gx_blade_desc desc;
    gx_blade *blade = NULL;
    int i;
    memset(&desc, 0, sizeof desc);
    desc.min_advance = _i == 0 ? 0.3 : 0;
    add_axis_plane(&w, 2, 0.75);
    add_axis_plane(&w, 2, 1.25);
    ck_assert_uint_eq(affine_count(body), 0);
    ck_assert_int_eq(gx_blade_create(body, &desc, &blade, NULL), GX_OK);
    for (i = 0; i <= 60; i++) {
        const double y = -0.3 + 0.045 * i, z = _i == 3 ? 0.5 : 1.02, edge[6] = {-9, y, z, 9, y + 0.01, z + 0.01};
        if (i == 30 && _i < 3) cut_by(body, &w, 0, _i < 2 ? 2 : 1);
        ck_assert_int_eq(gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL), GX_OK);
        advance(body, &step);
    }
    ck_assert_int_eq(gx_blade_lift(blade, NULL, NULL), GX_OK);
    ck_assert_uint_gt(affine_count(body), 0);
    ck_assert_uint_eq(view_of(body).fragment_count, _i < 2 ? 4 : _i == 2 ? 3 : 2);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- contact ---- */

/* Contact, and a plane at z = 0 in the step. ground, load: as long as steps are taken */
static void lay_on_ground(gx_body *body, gx_step_desc *step, gx_collider *ground, gx_collider_load *load,
                          double friction) {
    gx_contact_desc contact;
    memset(&contact, 0, sizeof contact);
    memset(ground, 0, sizeof *ground);
    contact.friction = ground->friction = friction;
    ground->kind = GX_COLLIDER_PLANE;
    ground->pose[0] = ground->pose[5] = ground->pose[10] = 1;
    step->colliders = ground;
    step->collider_count = 1;
    step->collider_loads = load;
    ck_assert_int_eq(gx_body_contact(body, &contact, NULL), GX_OK);
}

/* A body of which some copies are affine falls on a plane that carries it. */
START_TEST(partly_affine_bodies_lie) {
    workload w;
    gx_body *body = partly_affine(&w, 1);
    gx_step_desc step = step_of(0.02, -10);
    gx_collider plane;
    gx_collider_load load;
    gx_motion motions[8];
    double mass = view_of(body).mass;
    int i;
    lay_on_ground(body, &step, &plane, &load, 0);
    plane.pose[11] = -0.01;
    for (i = 0; i < 60; i++) advance(body, &step);
    ck_assert_int_eq(gx_body_motion(body, motions, 8, NULL), GX_OK);
    ck_assert_double_lt(fabs(motions[0].velocity[2]), 0.3);
    ck_assert_double_lt(fabs(load.force[2] + 10 * mass), 0.5 * 10 * mass);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A step by quality does not read the integrator. */
START_TEST(quality_chooses_the_integrator) {
    uint64_t hash[2];
    int which, i;
    for (which = 0; which < 2; which++) {
        workload w;
        gx_body *body = partly_affine(&w, 0);
        gx_step_desc step = step_of(0.02, -10);
        step.quality = 0.05;
        step.integrator = which ? GXS_BDF2 : GXS_BDF1;
        hold_left(body);
        for (i = 0; i < 3; i++) advance(body, &step);
        hash[which] = gx_body_state_hash(body);
        gx_body_destroy(body);
        wl_free(&w);
    }
    ck_assert(hash[0] == hash[1]);
}
END_TEST

/* A plate of one layer of cubes, cut into slices that all lie on the ground, one on the other: each carries those above
   it, and hardly anything moves. Bent slices: cells have affine copies. */
START_TEST(slices_lie_on_each_other) {
    workload w = grid(4, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gx_collider ground;
    gx_collider_load load;
    gx_view view;
    double force = 0, mean[3] = {0, 0, 0};
    static gx_contact contacts[2000];
    size_t count, i;
    uint32_t f;
    int round;
    cut_into_sheets(body, &w);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    ck_assert_uint_gt(affine_count(body), view.copy_count / 2);
    lay_on_ground(body, &step, &ground, &load, 0.5);
    step.mass_damping = 2;
    for (round = 0; round < 150; round++) {
        advance(body, &step);
        if (round >= 130) force += load.force[2] / 20;
        ck_assert_int_eq(gx_body_contacts(body, contacts, 2000, &count, NULL), GX_OK);
        for (i = 0; i < count; i++) {
            ck_assert_msg(contacts[i].depth < 0.02, "round %d: depth %g", round, contacts[i].depth);
            if (round >= 130 && contacts[i].collider == UINT32_MAX)
                mean[contacts[i].fragment] += contacts[i].force[2] / 20,
                    mean[contacts[i].other] -= contacts[i].force[2] / 20;
        }
    }
    view = view_of(body);
    ck_assert_msg(fabs(force / (-10 * view.mass) - 1) < 0.03, "ground carries %g of %g", force, -10 * view.mass);
    for (f = 0; f < 3; f++) { /* what presses from below less what presses from above is a slice's weight, or the
                                 ground's */
        const double weight = 10 * view.fragment_mass[f],
                     ground_share = view.fragment_center[3 * f + 2] < 0.3 ? -force : 0;
        ck_assert_msg(fabs(mean[f] + ground_share - weight) < 0.03 * 10 * view.mass, "slice %u: %g + %g of %g", f,
                      mean[f], ground_share, weight);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A plate lies on the ground, and beneath it a slice of a twentieth of an element: tips of it have next to no volume.
   A of no copy grows, though fields have many descriptions by affine copies, and contact presses tips. */
START_TEST(pressed_slices_rest) {
    workload w = grid(4, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.01, -10);
    gx_collider ground;
    gx_collider_load load;
    double most = 0, speed = 0;
    int round;
    add_axis_plane(&w, 2, 0.05);
    cut_by(body, &w, 0, 1);
    lay_on_ground(body, &step, &ground, &load, 0.3);
    step.mass_damping = 2;
    for (round = 0; round < 120; round++) {
        const gx_view view = view_of(body);
        size_t i;
        advance(body, &step);
        for (i = 0; i < 9 * view.copy_count; i++) most = fmax(most, fabs(view.affine[i]));
        for (i = 0; i < 3 * view.copy_count && round == 119; i++) speed = fmax(speed, fabs(view.velocity[i]));
    }
    ck_assert_msg(most < 3, "A grows to %g", most); /* 28 by step 40 if tips followed nothing, 60 without calm starts */
    ck_assert_msg(speed < 0.2, "%g m/s", speed);
    ck_assert_msg(fabs(load.force[2] / (-10 * view_of(body).mass) - 1) < 0.02, "ground carries %g", load.force[2]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Two planes that cross in the middle of a plate, but for some noise */
static void add_wedge(workload *w, uint64_t seed) {
    int i;
    random_seed(seed);
    for (i = 0; i < 2; i++) {
        const double p[3] = {2.5 + random_real(-0.3, 0.3), 2.5 + random_real(-0.3, 0.3), 1.5},
                     n[3] = {1, (i ? 0.3 : -0.3) + random_real(-0.1, 0.1), random_real(-0.05, 0.05)};
        add_plane(w, p, n, 10);
    }
}

/* Two planes that cross leave wedges: at their sharp edges, parts of all sizes are affine. What next to nothing holds
   there follows the material, and is not flung away. */
START_TEST(edges_of_wedges_stay) {
    workload w = grid(5, 5, 3, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(1.0 / 60, -10);
    const gx_region back = gx_region_half_space(1, 1, 3.9);
    double fastest = 0;
    size_t i;
    int round;
    add_wedge(&w, (uint64_t)_i);
    ck_assert_int_eq(gx_body_hold(body, &back, 1, NULL), GX_OK);
    cut_by(body, &w, 0, 2);
    shake(body, 0.02);
    for (round = 0; round < 40; round++) {
        const gx_view view = view_of(body);
        advance(body, &step);
        for (i = 0; i < 3 * view.copy_count; i++) fastest = fmax(fastest, fabs(view.velocity[i]));
    }
    ck_assert_msg(fastest < 10, "%g m/s", fastest); /* a free fall makes 6.7, 14 to 48 where none follows */
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A support that the caller gives decides alone what follows, at sharp edges of affine copies, too. */
START_TEST(given_supports_decide_alone) {
    size_t counts[2];
    int given;
    for (given = 0; given < 2; given++) {
        workload w = grid(5, 5, 3, 5);
        gx_body_desc desc = desc_of(&w);
        gx_body *body = NULL;
        gxs_model model;
        add_wedge(&w, 1);
        desc.affine_below = 1;
        desc.support_below = given ? 1e-3 : 0; /* it is the default of the share that holds other copies */
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        cut_by(body, &w, 0, 2);
        ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
        counts[given] = model.constraint_count;
        gx_body_destroy(body);
        wl_free(&w);
    }
    ck_assert_msg(counts[1] > 0 && counts[1] < counts[0], "%zu of %zu follow", counts[1], counts[0]);
}
END_TEST

/* The lower half of a plate is held at one side, the upper one falls on its free end with a spin, and slides off: no
   energy is won, nothing goes through, out of memory nothing changes. */
START_TEST(slices_fall_on_each_other) {
    workload w = grid(4, 3, 1, 5);
    gx_body *body = sheet_body(&w, 1);
    gx_step_desc step = step_of(0.005, -10);
    gx_step_report report;
    gx_contact_desc contact;
    static const double low[3] = {-1, -1, -1}, high[3] = {0.2, 4, 0.45};
    const gx_region held = gx_region_box(low, high);
    gx_view view;
    double deepest = 0;
    static gx_contact contacts[2000];
    size_t count, i;
    int round, touched = 0;
    add_axis_plane(&w, 2, 0.5);
    cut_by(body, &w, w.surface_count - 1, 1);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    memset(&contact, 0, sizeof contact);
    contact.friction = _i % 2 ? 0.3 : 0;
    ck_assert_int_eq(gx_body_contact(body, &contact, NULL), GX_OK);
    for (i = 0; i < view.cell_count; i++) { /* the upper one is 0.3 higher, and turns */
        const uint32_t upper = view.fragment_center[3 * view.cell_fragment[i] + 2] > 0.5;
        int k;
        for (k = 0; k < 4 && upper; k++) {
            const uint32_t copy = view.cell_copies[4 * i + (size_t)k];
            const double *x = body->mesh.positions + 3 * (size_t)view.copy_node[copy];
            view.displacement[3 * copy + 2] = 0.3;
            view.velocity[3 * copy + 2] = 0.5 * (x[0] - 2);
        }
    }
    ck_assert_int_eq(gx_body_hold(body, &held, 1, NULL), GX_OK);
    for (round = 0; round < 120; round++) {
        ck_assert_int_eq(gx_body_step(body, &step, &report, NULL), GX_OK);
        ck_assert_int_eq(gx_body_contacts(body, contacts, 2000, &count, NULL), GX_OK);
        touched += count > 0;
        for (i = 0; i < count; i++) deepest = fmax(deepest, contacts[i].depth);
        ck_assert_msg(report.cg_iterations < 400, "round %d: %u iterations", round, report.cg_iterations);
    }
    { /* saved and cloned in contact, all go on with the same bits */
        gx_body *others[2];
        gx_body_desc none;
        void *memory;
        size_t size;
        memset(&none, 0, sizeof none);
        ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
        memory = oracle_memory(NULL, size, 1);
        ck_assert_int_eq(gx_body_save(body, memory, size, &size, NULL), GX_OK);
        ck_assert_int_eq(gx_body_load(memory, size, &none, &others[0], NULL), GX_OK);
        ck_assert_int_eq(gx_body_clone(body, &others[1], NULL), GX_OK);
        for (round = 0; round < 10; round++) {
            advance(body, &step);
            for (i = 0; i < 2; i++) advance(others[i], &step);
        }
        for (i = 0; i < 2; i++) {
            expect_same_motion(body, others[i]);
            gx_body_destroy(others[i]);
        }
        free(memory);
    }
    ck_assert_int_gt(touched, 10);
    ck_assert_msg(deepest < 0.1, "depth %g", deepest); /* 0.03 and 0.06 of an element, in flight */
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A pair with anchors between slices is moved by what moves the material there: its force is stiffness times how deep
   that is in reality. Without anchors it is refused, as its sides are not known. */
START_TEST(anchored_pairs_know_their_sides) {
    workload w;
    gx_body *body = bent_body(&w, 0.02, 0);
    gx_step_desc step = step_of(1e-9, 0);
    gxs_pair pair;
    gx_failure failure;
    double force[3];
    int round;
    random_seed((uint64_t)_i + 5);
    memset(&pair, 0, sizeof pair);
    pair.normal[2] = 1;
    pair.stiffness = 1e-3;
    pair.point.count = 2;
    pair.point.copy[1] = 1;
    pair.point.weight[0] = 1;
    pair.point.weight[1] = -1;
    pair.point.epoch = view_of(body).epoch;
    step.pairs = &pair;
    step.pair_count = 1;
    step.pair_forces = force;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "pairs");
    for (round = 0; round < 40; round++) {
        gx_anchor anchors[2];
        double at[2][3], depth;
        int i, k;
        for (i = 0; i < 2; i++) {
            const gx_view view = view_of(body);
            const size_t cell = (size_t)random_below((int)view.cell_count);
            const double *x = body->mesh.positions;
            double material[3] = {0, 0, 0}, part[4], sum = 0;
            for (k = 0; k < 4; k++) sum += part[k] = random_real(0.1, 1);
            for (k = 0; k < 12; k++)
                material[k % 3] += part[k / 3] / sum *
                                   x[3 * (size_t)view.elements[4 * (size_t)view.cell_element[cell] + (size_t)(k / 3)] +
                                     (size_t)(k % 3)];
            ck_assert_int_eq(gx_body_anchor(body, view.cell_element[cell], material, &anchors[i], NULL), GX_OK);
            ck_assert_int_eq(gx_body_anchor_point(body, &anchors[i], NULL, at[i], NULL), GX_OK);
        }
        depth = 10 - (at[0][2] - at[1][2]);
        pair.offset = 10;
        step.pair_anchors = anchors;
        ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
        ck_assert_msg(fabs(force[2] - pair.stiffness * depth) < 1e-6 * pair.stiffness * depth, "%g, depth %g", force[2],
                      depth);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Bad thicknesses are named. */
START_TEST(refusals_are_named) {
    static const double bad[3] = {-1, 1e9, HUGE_VAL};
    workload w = grid(2, 2, 1, 5);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = sheet_body(&w, 1);
    gx_failure failure;
    int i;
    for (i = 0; i < 3; i++) {
        gx_body *none;
        desc.affine_below = bad[i];
        ck_assert_int_eq(gx_body_create(&desc, &none, &failure), i < 2 ? GX_ERROR_ARGUMENT : GX_ERROR_NOT_FINITE);
        ck_assert_str_eq(failure.field, "affine_below");
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

int main(void) {
    const char *passes = getenv("GXFEM_PASSES");
    Suite *suite = suite_create("sheets");
    TCase *tcase = tcase_create("which");
    tcase_set_timeout(tcase, 300);
    ADD_SOME(tcase, a_thick_body_has_none, 9);
    tcase_add_loop_test(tcase, layers_are_thin, 0, 4);
    ADD_SOME(tcase, slices_are_thin, 8);
    tcase_add_loop_test(tcase, nothing_moves, 0, 4);
    ADD_SOME(tcase, fields_are_as_defined, 12);
    tcase_add_test(tcase, rigid_motions_are_exact);
    ADD_SOME(tcase, slices_hang_as_beams, 9);
    ADD_SOME(tcase, slices_bend_both_ways_alike, 3);
    ADD_SOME(tcase, flung_sheets_keep_their_momentum, 4);
    tcase_add_test(tcase, points_move_with_affine_copies);
    tcase_add_test(tcase, planes_stop_sheets);
    tcase_add_test(tcase, poses_turn_affine_copies);
    tcase_add_test(tcase, arrays_reach_affine_copies);
    tcase_add_test(tcase, points_are_told_in_many_ways);
    tcase_add_test(tcase, failures_name_copies);
    tcase_add_test(tcase, specks_do_not_turn);
    tcase_add_test(tcase, nothing_is_left);
    tcase_add_loop_test(tcase, copies_go_on_alike, 0, 2);
    tcase_add_test(tcase, damaged_flags_are_refused);
    tcase_add_test(tcase, none_is_none);
    ADD_SOME(tcase, cut_sheets_stay_together, 12);
    tcase_add_loop_test(tcase, every_allocation_may_fail, 0, 2);
    tcase_add_test(tcase, rays_meet_what_is_drawn);
    ADD_SOME(tcase, located_points_are_placed_there, 4);
    tcase_add_test(tcase, what_turns_is_located_anew);
    tcase_add_loop_test(tcase, nearest_points_of_bent_bodies, 0, 2);
    tcase_add_test(tcase, refusals_are_named);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("blades");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, maps_are_undone, 0, 2);
    tcase_add_loop_test(tcase, blades_cut_rolled_plates, 0, 6);
    tcase_add_test(tcase, rolled_plates_are_carved);
    tcase_add_loop_test(tcase, contacts_in_bent_bodies, 0, FEWER > 1 ? 1 : 2);
    tcase_add_loop_test(tcase, flat_cells_hold_nothing, 0, 1);
    tcase_add_loop_test(tcase, moves_before_slices, 0, 4);
    tcase_add_test(tcase, partly_affine_bodies_lie);
    tcase_add_test(tcase, quality_chooses_the_integrator);
    tcase_add_loop_test(tcase, blades_pass_through_flung_plates, 0, passes != NULL ? atoi(passes) : 14 / FEWER);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("contact");
    tcase_set_timeout(tcase, 300);
    if (FEWER == 1) tcase_add_test(tcase, slices_lie_on_each_other);
    tcase_add_test(tcase, pressed_slices_rest);
    ADD_SOME(tcase, edges_of_wedges_stay, 12);
    tcase_add_test(tcase, given_supports_decide_alone);
    tcase_add_loop_test(tcase, slices_fall_on_each_other, 0, FEWER > 1 ? 1 : 2);
    tcase_add_loop_test(tcase, anchored_pairs_know_their_sides, 0, FEWER > 1 ? 1 : 2);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
