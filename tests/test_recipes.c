/* test_recipes.c - the snippets of docs/RECIPES.md, as they stand there, do what the page says. `make` extracts them.
 */
#define _POSIX_C_SOURCE 200112L
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "recipes.h"
#include "../bench/block.h"
#include "runner.h"

#define OK(call) ck_assert_int_eq(call, GX_OK)

/* ---- scenes ---- */

static gx_body *make_body_by(gx_result (*make)(gx_body_desc, gx_body **), uint32_t cells, const gx_jobs *jobs) {
    gx_body_desc desc;
    block_mesh mesh;
    gx_body *body = NULL;
    OK(block_make_mesh(cells, 0.2, &mesh));
    memset(&desc, 0, sizeof desc);
    desc.positions = mesh.positions;
    desc.node_count = mesh.side * mesh.side * mesh.side;
    desc.elements = mesh.elements;
    desc.element_count = 5 * (size_t)cells * cells * cells;
    desc.young = 2e5;
    desc.poisson = 0.4;
    desc.density = 1000;
    if (jobs) desc.jobs = *jobs;
    OK(make(desc, &body));
    block_free_mesh(&mesh);
    return body;
}

static gx_result make_plain(gx_body_desc desc, gx_body **body) { return gx_body_create(&desc, body, NULL); }

static gx_body *make_body(uint32_t cells, const gx_jobs *jobs) { return make_body_by(make_plain, cells, jobs); }

static gx_body *make_hanging(uint32_t cells, const gx_jobs *jobs) {
    const gx_region top = gx_region_half_space(2, 1, 1 - 1e-9);
    gx_body *body = make_body(cells, jobs);
    OK(gx_body_hold(body, &top, 1, NULL));
    return body;
}

static gx_step_desc step_of(double dt) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[2] = -9.81;
    return step;
}

static void advance(gx_body *body, int steps) {
    const gx_step_desc step = step_of(1.0 / 60);
    while (steps-- > 0) OK(gx_body_step(body, &step, NULL, NULL));
}

static gx_view view_of(gx_body *body) {
    gx_view view;
    OK(gx_body_view(body, &view, NULL));
    return view;
}

static void cut_through(gx_body *body, uint32_t axis, double at) { OK(block_cut_rectangle(body, axis, at, -0.1, 1.1)); }

/* ---- Shape ---- */

/* A cube with a seam: the corners of its last face are vertices of their own. */
START_TEST(model) {
    static const uint32_t triangles[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5,  0, 5,  4,
                                           1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 8, 9, 10, 8, 10, 11};
    static const double x[36] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1,
                                 1, 1, 1, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 1, 1};
    float texture[24];
    double moved[36];
    gx_hit hits[12];
    gx_body *body = NULL;
    gx_failure failure;
    gx_skin skin;
    gx_view view;
    size_t i;
    int k;
    for (i = 0; i < 12; i++)
        for (k = 0; k < 2; k++) texture[2 * i + (size_t)k] = (float)(x[3 * i + (size_t)k + 1] + (i < 8 ? 0 : 10));
    OK(body_of_model(x, texture, 12, triangles, 12, 5, &body, &failure));
    view = view_of(body);
    ck_assert(fabs(view.volume - 1) < 1e-14);
    ck_assert_uint_eq(view.fragment_count, 1);
    OK(gx_body_skin(body, NULL, &skin, NULL));
    for (i = 0; i < skin.triangle_count; i++) ck_assert_uint_eq(skin.triangle_surface[i], 1);
    for (i = 0; i < skin.vertex_count; i++) /* y, z; on the face with the seam 10 more */
        if (fabs(skin.vertex_normal[3 * i] + 1) < 1e-6)
            for (k = 0; k < 2; k++)
                ck_assert(fabs((double)skin.vertex_texture[2 * i + (size_t)k] -
                               skin.vertex_rest[3 * i + (size_t)k + 1] - 10) < 1e-5);
    OK(find_vertices(body, x, 12, hits));
    advance(body, 3);
    OK(gx_body_skin(body, NULL, &skin, NULL));
    OK(move_vertices(body, x, 12, hits, moved));
    view = view_of(body);
    for (i = 0; i < 12; i++) { /* where the skin has them */
        size_t v, c, found = 0;
        for (v = 0; v < skin.vertex_count; v++) {
            const uint32_t *copies = skin.vertex_copies + v * skin.vertex_width;
            const double *weights = skin.vertex_weights + v * skin.vertex_width;
            if (memcmp(skin.vertex_rest + 3 * v, x + 3 * i, 3 * sizeof *x) != 0) continue;
            found++;
            for (k = 0; k < 3; k++) {
                double at = x[3 * i + (size_t)k];
                for (c = 0; c < skin.vertex_width; c++) at += weights[c] * view.displacement[3 * copies[c] + (size_t)k];
                ck_assert(fabs(moved[3 * i + (size_t)k] - at) < 1e-14);
            }
        }
        ck_assert(found > 0 && moved[3 * i + 2] < x[3 * i + 2]);
    }
    cut_through(body, 2, 0.4711);
    OK(gx_body_skin(body, NULL, &skin, NULL));
    for (i = k = 0; i < skin.triangle_count; i++) k += skin.triangle_surface[i] == 2;
    ck_assert_int_gt(k, 0);
    gx_body_destroy(body);
    ck_assert_int_eq(body_of_model(x, NULL, 12, triangles, 11, 5, &body, &failure), GX_ERROR_NOT_CLOSED);
    ck_assert_str_eq(failure.field, "shape.surfaces.triangles");
    ck_assert(failure.index < 11);
}
END_TEST

/* ---- Materials ---- */

START_TEST(tumour) {
    static const uint32_t triangles[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                           1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    static const double x[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    double inner[24], volume = 0;
    gx_surface surfaces[2];
    gx_material materials[2];
    gx_body *body = NULL;
    gx_cut_report report;
    gx_view view;
    size_t i;
    memset(surfaces, 0, sizeof surfaces);
    memset(materials, 0, sizeof materials);
    for (i = 0; i < 24; i++) inner[i] = 0.3 + 0.5 * x[i];
    for (i = 0; i < 2; i++) {
        surfaces[i].vertices = i ? inner : x;
        surfaces[i].vertex_count = 8;
        surfaces[i].triangles = triangles;
        surfaces[i].triangle_count = 12;
        materials[i].elastic.young = i ? 1e6 : 1e5;
        materials[i].elastic.poisson = 0.4;
        materials[i].density = i ? 2000 : 1000;
    }
    OK(body_with_tumour(&surfaces[0], &surfaces[1], materials, 4, &body, NULL));
    view = view_of(body);
    for (i = 0; i < view.cell_count; i++) volume += view.cell_material[i] == 1 ? view.cell_volume[i] : 0;
    ck_assert(fabs(volume - 0.125) < 1e-13 && fabs(view.mass - 1125) < 1e-9);
    ck_assert_uint_eq(view.fragment_count, 1);
    advance(body, 2);
    OK(release_tumour(body, &report));
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    ck_assert(fabs(view.fragment_mass[1] - 250) < 1e-9 || fabs(view.fragment_mass[0] - 250) < 1e-9);
    advance(body, 2);
    gx_body_destroy(body);
}
END_TEST

/* ---- Draw ---- */

static unsigned char *buffers[4];
static size_t buffer_sizes[4], uploaded;

void upload(int buffer, size_t offset, const void *data, size_t size) {
    if (offset + size > buffer_sizes[buffer]) {
        buffers[buffer] = (unsigned char *)realloc(buffers[buffer], offset + size);
        buffer_sizes[buffer] = offset + size;
    }
    memcpy(buffers[buffer] + offset, data, size);
    uploaded += size;
}

START_TEST(draw) {
    gx_body *body = make_hanging(6, NULL);
    gx_skin skin;
    int cut;
    for (cut = 0; cut < 4; cut++) {
        size_t v;
        int k;
        if (cut > 0) OK(block_cut_rectangle(body, 2, 0.2 * cut + 0.013, -0.1, 0.45));
        uploaded = 0;
        OK(draw_changes(body, &skin));
        /* the first time all, later less than half */
        if (cut > 0) ck_assert_uint_lt(uploaded, (skin.vertex_count * 8 + skin.triangle_count * 12) / 2);
        ck_assert(memcmp(buffers[TEXTURE], skin.vertex_texture, skin.vertex_count * 2 * sizeof(float)) == 0);
        ck_assert(memcmp(buffers[TRIANGLES], skin.triangles, skin.triangle_count * 3 * sizeof(uint32_t)) == 0);
        advance(body, 5);
        {
            float *positions = (float *)malloc(skin.vertex_count * 3 * sizeof *positions);
            float *normals = (float *)malloc(skin.vertex_count * 3 * sizeof *normals);
            double *exact = (double *)malloc(skin.vertex_count * 3 * sizeof *exact);
            OK(draw_frame(body, &skin, positions, normals));
            OK(gx_body_skin_positions(body, exact, NULL));
            memcpy(positions, buffers[POSITIONS], skin.vertex_count * 3 * sizeof *positions);
            for (v = 0; v < skin.vertex_count; v++)
                for (k = 0; k < 3; k++) ck_assert(fabs(positions[3 * v + k] - exact[3 * v + k]) < 1e-6);
            free(positions);
            free(normals);
            free(exact);
        }
    }
    gx_body_destroy(body);
}
END_TEST

/* ---- Mark ---- */

START_TEST(marks) {
    gx_body *body = make_hanging(4, NULL);
    const double points[12] = {0.5, 0.5, 0.2, 0.3, 0.6, -0.01, 0.4, 0.4, 0.9, 0.5, 0.5, -3};
    mark made[4];
    double x[3], y[3];
    size_t count, i;
    int k;
    OK(put_marks(body, points, 4, 0.02, made, &count));
    ck_assert_uint_eq(count, 3); /* the last one is far away */
    ck_assert(fabs(made[1].material[2]) < 1e-15);
    for (i = 0; i < count; i++) {
        OK(find_mark(body, &made[i], x));
        for (k = 0; k < 3; k++) ck_assert(fabs(x[k] - made[i].material[k]) < 1e-15); /* at rest */
    }
    advance(body, 20);
    OK(find_mark(body, &made[0], x));
    OK(find_mark(body, &made[2], y));
    ck_assert(x[2] < points[2] && x[2] - points[2] < y[2] - points[8]); /* it hangs: below it gives more */
    gx_body_destroy(body);
}
END_TEST

/* ---- Drag ---- */

static const double below[3] = {0.47, 0.53, -5}, up[3] = {0, 0, 1};

static double height_of(gx_body *body) {
    gx_hit hit;
    OK(gx_body_pick(body, below, up, &hit, NULL));
    ck_assert(hit.triangle != UINT32_MAX);
    return hit.position[2];
}

/* Removes all below a height. */
static void cut_away_below(gx_body *body, double height) {
    static const uint32_t triangles[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                           1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    const double x[24] = {-9, -9, -9,     9, -9, -9,     9, 9, -9,     -9, 9, -9,
                          -9, -9, height, 9, -9, height, 9, 9, height, -9, 9, height};
    gx_surface box;
    gx_cut_desc cut;
    memset(&box, 0, sizeof box);
    memset(&cut, 0, sizeof cut);
    box.vertices = x;
    box.vertex_count = 8;
    box.triangles = triangles;
    box.triangle_count = 12;
    box.kind = GX_SURFACE_SOLID;
    cut.surfaces = &box;
    cut.surface_count = 1;
    OK(gx_body_cut(body, &cut, NULL, NULL));
}

START_TEST(drag) {
    gx_body *body = make_hanging(4, NULL);
    const gx_step_desc step = step_of(1.0 / 60);
    gx_skin skin;
    grip g;
    double before;
    int i;
    OK(gx_body_skin(body, NULL, &skin, NULL));
    before = height_of(body);
    OK(grab(body, below, up, 2e5, &g));
    ck_assert(g.holds);
    g.spring.target[2] -= 0.3;
    for (i = 0; i < 60; i++) OK(drag_step(body, step, &g));
    ck_assert(height_of(body) < before - 0.1);
    ck_assert(g.force[2] < 0); /* it is pulled down */
    cut_through(body, 2, 0.4711);
    OK(keep_hold(body, &g));
    ck_assert(g.holds);
    for (i = 0; i < 60; i++) OK(drag_step(body, step, &g)); /* what was cut off hangs on the spring alone */
    {
        double held[3];
        OK(gx_body_anchor_point(body, &g.anchor, NULL, held, NULL));
        ck_assert(fabs(held[2] - g.spring.target[2]) < 0.05);
    }
    cut_away_below(body, 0.4);
    OK(keep_hold(body, &g));
    ck_assert(!g.holds);
    OK(drag_step(body, step, &g)); /* nothing is held: a step as any */
    OK(gx_body_skin(body, NULL, &skin, NULL));
    {
        const double beside[3] = {9, 9, -5};
        OK(grab(body, beside, up, 1e4, &g));
        ck_assert(!g.holds);
        OK(drag_step(body, step, &g)); /* nothing is held: a step as any */
    }
    gx_body_destroy(body);
}
END_TEST

/* ---- Blade ---- */

/* The block is pushed aside by gravity, so that it swings. Returns how often it was cut. */
static int pass_through(gx_body *body, gx_blade *blade, int frames, double edge_at(int frame, double edge[6])) {
    gx_step_desc step = step_of(1.0 / 60);
    uint64_t topology = gx_body_topology_hash(body, NULL);
    int frame, cuts = 0, changed;
    step.gravity[0] = 5;
    for (frame = 0; frame <= frames; frame++) { /* the last one lifts */
        double edge[6];
        uint64_t hash;
        edge_at(frame, edge);
        OK(blade_frame(body, blade, &step, frame < frames ? edge : NULL, 2, &changed));
        hash = gx_body_topology_hash(body, NULL);
        if (!changed) ck_assert(hash == topology);
        topology = hash;
        cuts += changed;
    }
    return cuts;
}

static double across_edge(int frame, double edge[6]) {
    const double x = -0.5 + frame / 20.0, across[6] = {x, -0.5, 0.5, x, 1.5, 0.4};
    memcpy(edge, across, sizeof across);
    return x;
}

static double mouse_at(int frame, double edge[6]) {
    const double eye[3] = {0.5, -3, 0.5}, direction[3] = {-0.5 + frame / 20.0, 1, 0.02};
    mouse_edge(eye, direction, 6, edge);
    return direction[0];
}

START_TEST(blade_in_space) {
    gx_body *body = make_hanging(6, NULL);
    gx_blade *blade = NULL;
    OK(gx_blade_create(body, NULL, &blade, NULL));
    ck_assert_int_gt(_i == 0 ? pass_through(body, blade, 60, across_edge) : pass_through(body, blade, 21, mouse_at), 3);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert(fabs(view_of(body).volume - 1) < 1e-12);
    gx_body_destroy(body);
}
END_TEST

START_TEST(blade_begins_outside) {
    const double edge[6] = {0.5, -1, 0.5, 0.5, 0.5, 0.5}, beside[6] = {9, -1, 0.5, 9, 2, 0.5};
    gx_body *body = make_hanging(4, NULL);
    gx_step_desc step = step_of(1.0 / 60);
    gx_blade_desc stab;
    gx_blade *blade = NULL;
    gx_failure failure;
    int changed;
    OK(gx_blade_create(body, NULL, &blade, NULL));
    ck_assert_int_eq(gx_blade_move(blade, edge, 2, NULL, 0, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert_uint_eq(failure.index, 1);
    ck_assert_int_eq(blade_frame(body, blade, &step, edge, 2, &changed), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(changed, 0);
    OK(blade_frame(body, blade, &step, beside, 2, &changed));
    ck_assert_int_eq(gx_blade_move(blade, edge, 1, NULL, 0, NULL, NULL), GX_ERROR_ARGUMENT);
    memset(&stab, 0, sizeof stab);
    stab.starts_inside = 1;
    OK(gx_blade_create(body, &stab, &blade, NULL));
    OK(blade_frame(body, blade, &step, edge, 2, &changed));
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    gx_body_destroy(body);
}
END_TEST

/* ---- Drill ---- */

/* Along each axis, and askew. At rest the hole is the prism, to the last digits; through a body that swings it goes
 * too.
 */
START_TEST(remove_a_piece) {
    static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    gx_body *body = make_body(5, NULL);
    gx_view view;
    uint32_t ids[2], small;
    double volume;
    cut_through(body, 2, 0.13);
    OK(gx_body_view(body, &view, NULL));
    ck_assert_uint_eq(view.fragment_count, 2);
    small = view.fragment_volume[1] < view.fragment_volume[0];
    volume = view.fragment_volume[1 - small];
    ids[0] = view.fragment_id[small];
    ids[1] = view.fragment_id[1 - small];
    OK(remove_piece(body, small, low, high));
    OK(gx_body_view(body, &view, NULL));
    ck_assert_uint_eq(view.fragment_count, 1);
    ck_assert_uint_eq(view.fragment_id[0], ids[1]);
    ck_assert_uint_eq(view.removed_count, 1);
    ck_assert_uint_eq(view.removed_ids[0], ids[0]);
    ck_assert(fabs(view.volume - volume) <= 1e-12 * volume);
    gx_body_destroy(body);
}
END_TEST

START_TEST(drill_a_hole) {
    static const double axes[4][3] = {{0, 0, -1}, {0, 1, 0}, {-1, 0, 0}, {0.48, -0.6, 0.64}};
    const double *axis = axes[_i], radius = 0.1, middle[3] = {0.52, 0.47, 0.51},
                 back[3] = {-axis[0], -axis[1], -axis[2]};
    double removed, sum = 0, tip[3], start[3];
    gx_body *body = make_hanging(5, NULL);
    gx_skin skin;
    gx_hit hit;
    int frame, k;
    for (frame = 0; frame <= 10; frame++) {
        for (k = 0; k < 3; k++) tip[k] = middle[k] + (1.2 - 0.1 * frame) * axis[k];
        OK(drill(body, tip, axis, radius, 0.15, &removed));
        ck_assert(frame == 0 ? !(removed > 0) : removed >= 0);
        sum += removed;
    }
    ck_assert(fabs(view_of(body).volume + sum - 1) < 1e-12);
    for (k = 0; k < 3; k++)
        if (fabs(axis[k]) > 0.9) ck_assert(fabs(sum - fabs((axis[k] > 0) - tip[k]) * 3 * radius * radius) < 1e-12);
    OK(drill(body, tip, axis, radius, 0.15, &removed));
    ck_assert(removed < 1e-40); /* what rounding leaves */
    for (frame = 0; frame < 16; frame++) {
        advance(body, 1);
        for (k = 0; k < 3; k++) tip[k] = middle[k] + (0.2 - 0.1 * frame) * axis[k];
        OK(drill(body, tip, axis, radius, 0.15, &removed));
        sum += removed;
    }
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    ck_assert(fabs(view_of(body).volume + sum - 1) < 1e-12);
    for (k = 0; k < 3; k++) start[k] = middle[k] + 3 * axis[k];
    OK(gx_body_skin(body, NULL, &skin, NULL));
    OK(gx_body_pick(body, start, back, &hit, NULL));
    ck_assert_uint_eq(hit.copy_count, 0); /* one sees through it */
    gx_body_destroy(body);
}
END_TEST

/* ---- Feel ---- */

/* A blade goes along y through the block, which hangs: while it is in the material, that is pushed on and the hand
   back, by no more than the resistance. */
START_TEST(feel_the_blade) {
    gx_body *body = make_hanging(6, NULL);
    gx_blade *blade = NULL;
    gx_step_desc step = step_of(1.0 / 60);
    blade_feel feel;
    double most = 0, longest = 0;
    int frame, felt = 0;
    memset(&feel, 0, sizeof feel);
    feel.stiffness = 2e4;
    feel.resistance = 40;
    step.gravity[2] = 0;
    OK(gx_blade_create(body, NULL, &blade, NULL));
    for (frame = 0; frame <= 60; frame++) {
        const double y = -0.3 + 0.03 * frame, edge[9] = {-0.5, y, 0.45, 0.4, y, 0.47, 1.5, y, 0.45};
        OK(feel_frame(body, blade, step, edge, 3, &feel));
        most = fmax(most, -feel.force[1]);
        longest = fmax(longest, feel.length);
        felt += feel.length > 0;
        ck_assert(fabs(feel.force[1]) <= 1.05 * feel.resistance * feel.length);
        if (y < -0.02) ck_assert(!(feel.length > 0) && !(fabs(feel.force[1]) > 0));
        ck_assert(feel.length < 1.3);
    }
    ck_assert_int_gt(felt, 20);
    ck_assert_int_lt(felt, 50);
    ck_assert_msg(most > 10 && longest > 0.9, "%g N, %g m", most, longest);
    ck_assert(!(feel.length > 0));
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
}
END_TEST

/* ---- Hold ---- */

START_TEST(hold) {
    enum { CELLS = 4, NODES = 125 };
    const double joint[3] = {0, 0, 0}, shift[3] = {0, 0.05, -0.02};
    gx_body *body = make_body(CELLS, NULL);
    const gx_step_desc step = step_of(1.0 / 60);
    uint32_t nodes[NODES];
    block_mesh mesh;
    gx_view view;
    size_t i, k, count = 0, held[2] = {0, 0};
    OK(block_make_mesh(CELLS, 0.2, &mesh));
    for (i = 0; i < NODES; i++)
        if (mesh.positions[3 * i + 2] > 0.999 && mesh.positions[3 * i] < 0.6) nodes[count++] = (uint32_t)i;
    ck_assert_uint_eq(count, 15);
    OK(hold_parts(body, nodes, count, joint, 0.3));
    for (i = 0; i < 20; i++) {
        const double now[3] = {0, 0.05 * (double)(i + 1) / 20, -0.02 * (double)(i + 1) / 20};
        OK(pose_step(body, step, joint, 0.2 * (double)(i + 1) / 20, now));
    }
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) {
        const double *x = mesh.positions + 3 * view.copy_node[i], *u = view.displacement + 3 * i;
        if (view.copy_region[i] == UINT32_MAX) continue;
        held[view.copy_region[i]]++;
        if (view.copy_region[i] == 0)
            for (k = 0; k < 3; k++) ck_assert(fabs(u[k]) < 1e-15);
        else {
            ck_assert(fabs(x[0] + u[0] - (cos(0.2) * x[0] - sin(0.2) * x[1] + shift[0])) < 1e-12);
            ck_assert(fabs(x[1] + u[1] - (sin(0.2) * x[0] + cos(0.2) * x[1] + shift[1])) < 1e-12);
            ck_assert(fabs(u[2] - shift[2]) < 1e-12);
        }
    }
    ck_assert_uint_eq(held[0], 15);
    ck_assert_uint_gt(held[1], 3);
    ck_assert_int_eq(hold_parts(body, nodes, count, mesh.positions, 1e-6), GX_OK); /* one node */
    ck_assert_int_eq(hold_parts(body, nodes, count, shift, 1e-6), GX_ERROR_EMPTY);
    block_free_mesh(&mesh);
    gx_body_destroy(body);
}
END_TEST

/* ---- Thin slices ---- */

/* How far the end of a slice of a tenth of an element sags, of which the other end is held */
static double sag(gx_result (*make)(gx_body_desc, gx_body **)) {
    const gx_region left = gx_region_half_space(0, -1, 0.05);
    gx_body *body = make_body_by(make, 4, NULL);
    gx_step_desc step = step_of(0);
    gx_anchor end;
    double place[3], material[3] = {0.97, 0.5, 0.4125};
    uint32_t element = 0;
    ck_assert_uint_eq(view_of(body).copy_affine ? view_of(body).copy_affine[0] : 0, 0); /* thick as yet */
    cut_through(body, 2, 0.4);
    cut_through(body, 2, 0.425);
    OK(gx_body_hold(body, &left, 1, NULL));
    while (gx_body_anchor(body, element, material, &end, NULL) != GX_OK) element++;
    step.integrator = GXS_STATIC;
    step.gravity[2] = -0.01; /* small: the slice stays nearly straight */
    step.newton_iterations = 40;
    step.cg_iterations = 20000;
    step.cg_tolerance = 1e-6;
    OK(gx_body_step(body, &step, NULL, NULL));
    OK(gx_body_anchor_point(body, &end, NULL, place, NULL));
    gx_body_destroy(body);
    return material[2] - place[2];
}

START_TEST(thin_slices) {
    const double stiff = sag(make_plain), bends = sag(make_sliceable);
    ck_assert_msg(stiff > 0 && bends > 30 * stiff, "%g, %g", stiff, bends);
}
END_TEST

/* ---- Ground ---- */

/* Two seconds on the ground, which slopes. Returns the mean height of what was lowest. */
static double land(gx_body *body, double slope, size_t *count, size_t *unmerged) {
    gx_step_desc step = step_of(1.0 / 60);
    gx_skin skin;
    gxs_point *points;
    double low = 0, *x;
    size_t v, bottom = 0;
    int i;
    step.gravity[0] = 9.81 * slope;
    OK(gx_body_skin(body, NULL, &skin, NULL));
    points = (gxs_point *)malloc(skin.vertex_count * sizeof *points);
    x = (double *)malloc(skin.vertex_count * 3 * sizeof *x);
    OK(contact_points(&skin, points, count));
    *unmerged = skin.vertex_count;
    for (i = 0; i < 120; i++) OK(ground_step(body, step, points, *count));
    OK(gx_body_skin_positions(body, x, NULL));
    for (v = 0; v < skin.vertex_count; v++)
        if (skin.vertex_rest[3 * v + 2] < 1e-9) {
            low += x[3 * v + 2];
            bottom++;
        }
    free(points);
    free(x);
    return low / (double)bottom;
}

START_TEST(ground) {
    gx_body *body = make_body(4, NULL);
    const double sinks = 1000 * 9.81 / (25 * 1e4);
    size_t count, unmerged;
    const double low = land(body, 0, &count, &unmerged);
    gx_motion before, after;
    ck_assert_uint_eq(count, 98); /* nodes on the outside of 4 x 4 x 4 cells */
    ck_assert_msg(fabs(low + sinks) < 0.2 * sinks, "sinks by %g, not by %g", -low, sinks);
    OK(gx_body_motion(body, &before, 1, NULL));
    land(body, 0.1, &count, &unmerged);
    OK(gx_body_motion(body, &after, 1, NULL));
    ck_assert_msg(fabs(after.center[0] - before.center[0]) < 0.1, "slides by %g m", after.center[0] - before.center[0]);
    gx_body_destroy(body);
}
END_TEST

START_TEST(ground_after_cuts) {
    gx_body *body = make_body(4, NULL);
    size_t count, unmerged, c;
    double low;
    gx_view view;
    for (c = 0; c < 3; c++) cut_through(body, (uint32_t)c, 0.4711);
    view = view_of(body);
    for (c = 0; c < view.copy_count; c++) view.displacement[3 * c + 2] = 0.2; /* dropped from there */
    low = land(body, 0, &count, &unmerged);
    ck_assert_msg(low < 0.01 && low > -0.2, "%g", low);
    ck_assert_uint_lt(2 * count, unmerged);
    gx_body_destroy(body);
}
END_TEST

/* ---- Threads ---- */

static size_t calls;

static void counted_for(void *user, size_t count, void (*task)(void *context, size_t index), void *context) {
    calls++;
    pool_for(user, count, task, context);
}

/* What lies on a body that is held stays there. */
START_TEST(contact) {
    const gx_region bottom = gx_region_half_space(2, -1, 1e-9);
    gx_body *body = make_body(4, NULL);
    gx_motion before[2], after[2];
    size_t count, i;
    OK(gx_body_hold(body, &bottom, 1, NULL));
    OK(let_pieces_touch(body));
    cut_through(body, 2, 0.53);
    OK(gx_body_motion(body, before, 2, NULL));
    advance(body, 60);
    OK(gx_body_motion(body, after, 2, NULL));
    ck_assert_int_eq(gx_body_contacts(body, NULL, 0, &count, NULL), GX_ERROR_CAPACITY);
    ck_assert_uint_gt(count, 10);
    for (i = 0; i < 2; i++) ck_assert_double_lt(fabs(after[i].center[2] - before[i].center[2]), 0.05);
    gx_body_destroy(body);
}
END_TEST

/* A body falls on another one, which is held, and lies there until a spring pulls it off. */
START_TEST(one_body_on_another) {
    const gx_region bottom = gx_region_half_space(2, -1, 1e-9);
    const double top[3] = {0.5, 0.5, 0.9};
    gx_body *lower = make_body(3, NULL), *upper = make_body(3, NULL);
    gx_group *group = NULL;
    gxs_spring spring;
    gx_anchor at;
    gx_hit hit;
    gx_motion motion;
    gx_view view = view_of(upper);
    size_t i;
    OK(gx_body_hold(lower, &bottom, 1, NULL));
    OK(gx_body_locate(upper, top, 1, &hit, NULL));
    OK(gx_body_anchor(upper, hit.element, hit.material, &at, NULL));
    for (i = 0; i < view.copy_count; i++) view.displacement[3 * i + 2] = 1.05;
    OK(let_bodies_touch(lower, upper, &group));
    memset(&spring, 0, sizeof spring);
    spring.target[0] = spring.target[1] = 0.5;
    spring.target[2] = 4;
    for (i = 0; i < 60; i++) OK(step_both(group, 1.0 / 60, &spring, &at));
    OK(gx_body_motion(upper, &motion, 1, NULL));
    ck_assert_msg(motion.center[2] > 1.2 && motion.center[2] < 1.55, "%g", motion.center[2]);
    spring.stiffness = 10 * motion.mass;
    for (i = 0; i < 30; i++) OK(step_both(group, 1.0 / 60, &spring, &at));
    OK(gx_body_motion(upper, &motion, 1, NULL));
    ck_assert_msg(motion.center[2] > 2, "%g", motion.center[2]);
    gx_group_destroy(group);
    gx_body_destroy(lower);
    gx_body_destroy(upper);
}
END_TEST

/* A body on the ground, which feels its weight, is pushed by a ball, which feels that. */
START_TEST(contact_with_ball) {
    gx_body *body = make_body(3, NULL);
    gx_collider_load feels[2];
    gx_step_desc step;
    gx_motion before, after;
    double center[3] = {-0.27, 0.5, 0.5};
    const double still[3] = {0, 0, 0}, velocity[3] = {0.5, 0, 0};
    int frame;
    memset(&step, 0, sizeof step);
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    OK(let_pieces_touch(body));
    for (frame = 0; frame < 120; frame++) OK(step_with_ball(body, step, 0.25, center, still, feels));
    OK(gx_body_motion(body, &before, 1, NULL));
    ck_assert_double_lt(fabs(feels[0].force[2] + 9.81 * before.mass), 0.01 * 9.81 * before.mass);
    ck_assert_uint_eq(feels[1].contacts, 0);
    for (frame = 0; frame < 60; frame++) {
        OK(step_with_ball(body, step, 0.25, center, velocity, feels));
        center[0] += step.dt * velocity[0];
    }
    OK(gx_body_motion(body, &after, 1, NULL));
    ck_assert_double_gt(after.center[0] - before.center[0], 0.2);
    ck_assert_double_lt(feels[1].force[0], 0);
    gx_body_destroy(body);
}
END_TEST

START_TEST(threads) {
    gx_body *alone = make_hanging(12, NULL), *together;
    pool p;
    gx_jobs jobs = {NULL, NULL};
    enum { STEPS = 10 };
    jobs.parallel_for = counted_for;
    jobs.user = &p;
    ck_assert(pool_start(&p));
    together = make_hanging(12, &jobs);
    cut_through(alone, 2, 0.4711);
    cut_through(together, 2, 0.4711);
    ck_assert(gx_body_state_hash(alone) == gx_body_state_hash(together));
    calls = 0; /* of cuts: large ones use jobs, too */
    advance(alone, STEPS);
    advance(together, STEPS);
    ck_assert(gx_body_state_hash(alone) == gx_body_state_hash(together));
    ck_assert_msg(calls > 24 * STEPS && calls < 160 * STEPS, "%g calls a step", (double)calls / STEPS);
    gx_body_destroy(alone);
    gx_body_destroy(together);
    pool_stop(&p);
}
END_TEST

/* ---- Undo and save ---- */

START_TEST(undo_and_save) {
    static const char path[] = RECIPES_FOLDER "/test_recipes.saved"; /* the Makefile says where */
    gx_body *body = make_hanging(4, NULL), *before = NULL, *loaded = NULL;
    uint64_t hash, topology;
    int i;
    for (i = 0; i < 2; i++) {
        advance(body, 5);
        hash = gx_body_state_hash(body);
        OK(remember(body, &before));
        cut_through(body, 0, 0.3 + 0.2 * i);
        advance(body, 5);
        ck_assert(gx_body_state_hash(body) != hash);
        OK(undo(body, before));
        ck_assert(gx_body_state_hash(body) == hash);
    }
    cut_through(body, 1, 0.37);
    topology = gx_body_topology_hash(body, NULL);
    OK(save_file(body, path));
    OK(load_file(path, NULL, &loaded));
    ck_assert(gx_body_topology_hash(loaded, NULL) == topology);
    advance(body, 3);
    advance(loaded, 3);
    cut_through(body, 0, 0.61);
    cut_through(loaded, 0, 0.61);
    ck_assert(gx_body_state_hash(body) == gx_body_state_hash(loaded));
    ck_assert_int_ne(load_file("build/there-is-none", NULL, &loaded), GX_OK);
    remove(path);
    gx_body_destroy(body);
    gx_body_destroy(before);
    gx_body_destroy(loaded);
}
END_TEST

/* ---- Integrator ---- */

/* A block of 0.6 m, turned by 45 degrees, held by its upper edge */
static gx_body *make_pendulum(void) {
    const double size = 0.6, half = sqrt(0.5), edge = 2 * size * half;
    gx_region top = gx_region_half_space(2, 1, 0);
    gx_step_desc rest = step_of(0);
    gx_body_desc desc;
    block_mesh mesh;
    gx_body *body = NULL;
    size_t i;
    OK(block_make_mesh(3, 0, &mesh));
    for (i = 0; i < 64; i++) {
        double *x = mesh.positions + 3 * i;
        const double along = x[0], z = x[2];
        x[0] = size * half * (along - z);
        x[1] *= size;
        x[2] = size * half * (along + z);
    }
    memset(&desc, 0, sizeof desc);
    desc.positions = mesh.positions;
    desc.node_count = 64;
    desc.elements = mesh.elements;
    desc.element_count = 135;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    OK(gx_body_create(&desc, &body, NULL));
    top.value = edge - 1e-6;
    OK(gx_body_hold(body, &top, 1, NULL));
    rest.integrator = GXS_STATIC;
    rest.newton_iterations = 20;
    OK(gx_body_step(body, &rest, NULL, NULL));
    {
        gx_view view = view_of(body);
        for (i = 0; i < view.copy_count; i++) { /* one radian per second about the edge */
            const double *x = mesh.positions + 3 * (size_t)view.copy_node[i];
            view.velocity[3 * i] = x[2] - edge;
            view.velocity[3 * i + 2] = -x[0];
        }
    }
    block_free_mesh(&mesh);
    return body;
}

/* What is left of the swing after five seconds: how far its centre moves sideways, there and back */
static double swing_left(gxs_integrator integrator) {
    enum { FRAMES = 96, LATER = 300 }; /* more than a period; 5 s */
    gx_body *body = make_pendulum();
    double low[2] = {1, 1}, high[2] = {-1, -1};
    int frame;
    for (frame = 0; frame < LATER + FRAMES; frame++) {
        const int half = frame >= LATER;
        gx_step_desc step = step_of(1.0 / 60);
        gx_motion motion;
        step.integrator = integrator;
        OK(integrator == GXS_BDF2 ? lively_step(body, step, frame == 0) : gx_body_step(body, &step, NULL, NULL));
        if (frame >= FRAMES && !half) continue;
        OK(gx_body_motion(body, &motion, 1, NULL));
        low[half] = fmin(low[half], motion.center[0]);
        high[half] = fmax(high[half], motion.center[0]);
    }
    gx_body_destroy(body);
    return (high[1] - low[1]) / (high[0] - low[0]);
}

/* The number in the page's row of an integrator */
static double page_says(const char *integrator) {
    FILE *file = fopen("docs/RECIPES.md", "r");
    char line[512], row[64];
    double value = -1;
    snprintf(row, sizeof row, "| `%s` |", integrator);
    ck_assert_ptr_nonnull(file);
    while (fgets(line, sizeof line, file))
        if (strncmp(line, row, strlen(row)) == 0) value = strtod(line + strlen(row), NULL);
    fclose(file);
    return value;
}

START_TEST(integrator) {
    static const char *const names[] = {"GXS_BDF1", "GXS_BDF2", "GXS_MIDPOINT"};
    static const gxs_integrator integrators[] = {GXS_BDF1, GXS_BDF2, GXS_MIDPOINT};
    const double left = swing_left(integrators[_i]), said = page_says(names[_i]);
    ck_assert_msg(fabs(left - said) < 0.01, "%s: %.3f of the swing are left, the page says %g", names[_i], left, said);
}
END_TEST

/* ---- Budget ---- */

START_TEST(budget) {
    gx_body *body = make_hanging(8, NULL);
    gx_step_report report;
    const gx_step_desc step = step_of(1.0 / 60);
    OK(frame_in_time(body, step, NULL, now(NULL), 100, &report));
    ck_assert_int_ne(report.stop, GXS_STOP_SECONDS);
    ck_assert_uint_gt(report.newton_iterations, 1);
    OK(frame_in_time(body, step, NULL, now(NULL) - 1, 0.016, &report));
    ck_assert_int_eq(report.stop, GXS_STOP_SECONDS);
    gx_body_destroy(body);
}
END_TEST

/* ---- Haptics ---- */

static double distance(const double a[3], const double b[3]) {
    return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

START_TEST(haptics) {
    gx_body *body = make_hanging(6, NULL), *ghost = NULL, *beside = NULL;
    const gx_step_desc step = step_of(1.0 / 60);
    const double reach = 0.002, moved[3] = {0.0011, -0.0008, 0.0013}; /* 100 mm/s and more */
    const double stiffness = 2e4;
    double *state, worst = 0, bare = 0;
    gx_skin skin;
    grip g;
    int i, k;
    OK(block_cut_rectangle(body, 2, 0.4711, -0.1, 0.6));
    OK(gx_body_skin(body, NULL, &skin, NULL));
    OK(grab(body, below, up, stiffness, &g));
    OK(gx_body_clone(body, &ghost, NULL));
    OK(gx_body_clone(body, &beside, NULL));
    state = (double *)malloc(6 * view_of(body).copy_count * sizeof *state);
    for (i = 0; i < 40; i++) {
        haptic_model model;
        double tool[3], predicted[3], change[3], actual[3];
        grip other;
        g.spring.target[2] -= 0.002;
        g.spring.target[0] += 0.001 * sin(0.3 * i);
        if (i % 8 == 7) OK(gx_body_restore(beside, body, NULL));
        OK(haptic_step(body, ghost, step, &g, state, reach, &model));
        if (i % 8 != 7) continue;
        /* the step that the same body takes with the tool elsewhere */
        other = g;
        for (k = 0; k < 3; k++) other.spring.target[k] = tool[k] = model.tool[k] + moved[k];
        OK(drag_step(beside, step, &other));
        haptic_force(&model, tool, predicted);
        for (k = 0; k < 3; k++) {
            actual[k] = -other.force[k];
            change[k] = -model.force[k] - stiffness * moved[k];
        }
        worst = fmax(worst, distance(predicted, actual) / (stiffness * distance(tool, model.tool)));
        bare = fmax(bare, distance(change, actual) / (stiffness * distance(tool, model.tool)));
    }
    ck_assert_msg(worst < 0.01, "the model's force is off by %g, the bare spring's by %g", worst, bare);
    ck_assert_msg(bare > 0.15 && bare < 0.25, "the model's force is off by %g, the bare spring's by %g", worst, bare);
    cut_through(body, 0, 0.777);
    {
        haptic_model model;
        ck_assert_int_eq(haptic_step(body, ghost, step, &g, state, reach, &model), GX_ERROR_STALE);
    }
    free(state);
    gx_body_destroy(body);
    gx_body_destroy(ghost);
    gx_body_destroy(beside);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("recipes");
    TCase *tc = tcase_create("snippets of docs/RECIPES.md");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, model);
    tcase_add_test(tc, tumour);
    tcase_add_test(tc, draw);
    tcase_add_test(tc, marks);
    tcase_add_test(tc, drag);
    tcase_add_loop_test(tc, blade_in_space, 0, 2);
    tcase_add_test(tc, blade_begins_outside);
    tcase_add_test(tc, remove_a_piece);
    tcase_add_loop_test(tc, drill_a_hole, 0, 4);
    tcase_add_test(tc, feel_the_blade);
    tcase_add_test(tc, hold);
    tcase_add_test(tc, thin_slices);
    tcase_add_test(tc, ground);
    tcase_add_test(tc, ground_after_cuts);
    tcase_add_test(tc, contact);
    tcase_add_test(tc, contact_with_ball);
    tcase_add_test(tc, one_body_on_another);
    tcase_add_test(tc, threads);
    tcase_add_test(tc, undo_and_save);
    tcase_add_loop_test(tc, integrator, 0, 3);
    tcase_add_test(tc, budget);
    tcase_add_test(tc, haptics);
    suite_add_tcase(suite, tc);
    return run_suite(suite);
}
