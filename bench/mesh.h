/* mesh.h - meshes and scenes of the benches: blocks of cubes of five or six tetrahedra, discs extruded to cylinders,
   and the solver's view of them. Include after the implementation of gxfem_solve.h. A bench that runs out of memory,
   or whose mesh is refused, ends there. */
#ifndef BENCH_MESH_H
#define BENCH_MESH_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "expect.h"

/* Nodes may be moved before a scene is made of it. */
typedef struct mesh {
    double *positions;  /* node_count x 3, m */
    uint32_t *elements; /* element_count x 4 */
    size_t node_count, element_count;
} mesh;

enum { MESH_FIVE, MESH_SIX }; /* tetrahedra of a cube */

/* A model and its state; arrays of model are the scene's own. */
typedef struct scene {
    gxs_model model;
    gxs_material material;
    gxs_element *elements;
    uint8_t *held;
    double *rest, *displacement, *velocity, *forces, *targets; /* copy_count x 3 */
    gxs_solver *solver;
} scene;

static mesh mesh_make(size_t node_count, size_t element_count) {
    mesh m;
    m.positions = (double *)memory(3 * node_count, sizeof(double));
    m.elements = (uint32_t *)memory(4 * element_count, sizeof(uint32_t));
    m.node_count = node_count;
    m.element_count = element_count;
    return m;
}

static void mesh_free(mesh *m) {
    free(m->positions);
    free(m->elements);
}

/* The cube's corners are numbered by bits: x 1, y 2, z 4. Five: the inner tetrahedron has the corners of one parity;
   cubes of odd parity are mirrored so that diagonals meet. Six: along the cube's diagonal [Kuhn]. */
static size_t mesh_cube(int kind, int odd, const uint32_t corner[8], uint32_t (*element)[4]) {
    static const uint8_t five[5][4] = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
    static const uint8_t six[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                                      {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};
    const uint8_t(*from)[4] = kind == MESH_FIVE ? five : six;
    size_t count = kind == MESH_FIVE ? 5 : 6, t, k;
    for (t = 0; t < count; t++)
        for (k = 0; k < 4; k++) element[t][k] = corner[from[t][k] ^ (kind == MESH_FIVE && odd ? 1 : 0)];
    return count;
}

/* n[0] x n[1] x n[2] cubes that fill [0, size[0]] x [0, size[1]] x [0, size[2]] */
static mesh mesh_block(const size_t n[3], const double size[3], int kind) {
    mesh m = mesh_make((n[0] + 1) * (n[1] + 1) * (n[2] + 1), n[0] * n[1] * n[2] * (kind == MESH_FIVE ? 5 : 6));
    size_t x, y, z, k, node = 0, e = 0;
    for (z = 0; z <= n[2]; z++)
        for (y = 0; y <= n[1]; y++)
            for (x = 0; x <= n[0]; x++, node++) {
                m.positions[3 * node] = size[0] * (double)x / (double)n[0];
                m.positions[3 * node + 1] = size[1] * (double)y / (double)n[1];
                m.positions[3 * node + 2] = size[2] * (double)z / (double)n[2];
            }
    for (z = 0; z < n[2]; z++)
        for (y = 0; y < n[1]; y++)
            for (x = 0; x < n[0]; x++) {
                uint32_t corner[8];
                for (k = 0; k < 8; k++)
                    corner[k] =
                        (uint32_t)(((z + (k >> 2)) * (n[1] + 1) + y + ((k >> 1) & 1)) * (n[0] + 1) + x + (k & 1));
                e += mesh_cube(kind, (int)((x + y + z) & 1), corner, (uint32_t(*)[4])(m.elements + 4 * e));
            }
    return m;
}

/* Swaps two corners of each element that is turned inside out; returns six times its volume. */
static double mesh_orient(const double *positions, uint32_t element[4], double edge[3][3]) {
    double volume;
    size_t i, r;
    uint32_t kept = element[2];
    for (i = 0; i < 3; i++)
        for (r = 0; r < 3; r++) edge[i][r] = positions[3 * element[i + 1] + r] - positions[3 * element[0] + r];
    volume = edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) -
             edge[0][1] * (edge[1][0] * edge[2][2] - edge[1][2] * edge[2][0]) +
             edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
    if (volume >= 0) return volume;
    element[2] = element[3];
    element[3] = kept;
    return mesh_orient(positions, element, edge);
}

/* gradient i of the shape functions is the product of the other two edges from corner 0 over six volumes */
static void scene_element(gxs_element *element, const double *positions, double density) {
    static const double mass[10] = {2, 1, 1, 1, 2, 1, 1, 2, 1, 2};
    double edge[3][3], volume = mesh_orient(positions, element->copy, edge);
    size_t i, r;
    expect(volume > 0, "flat element");
    for (i = 0; i < 3; i++)
        for (r = 0; r < 3; r++) {
            const double *a = edge[(i + 1) % 3], *b = edge[(i + 2) % 3];
            element->gradient[i + 1][r] = (a[(r + 1) % 3] * b[(r + 2) % 3] - a[(r + 2) % 3] * b[(r + 1) % 3]) / volume;
        }
    for (r = 0; r < 3; r++)
        element->gradient[0][r] = -(element->gradient[1][r] + element->gradient[2][r] + element->gradient[3][r]);
    element->weight = volume / 6;
    for (i = 0; i < 10; i++) element->mass[i] = density * volume / 120 * mass[i];
}

/* Everything at rest, nothing held; the solver gets the model at the first step. */
static scene *scene_make(const mesh *m, gxs_material_kind kind, double young, double poisson, double density) {
    scene *s = (scene *)memory(1, sizeof *s);
    size_t e, n = m->node_count;
    s->elements = (gxs_element *)memory(m->element_count, sizeof *s->elements);
    s->held = (uint8_t *)memory(n, 1);
    s->rest = (double *)memory(3 * n, sizeof(double));
    s->displacement = (double *)memory(3 * n, sizeof(double));
    s->velocity = (double *)memory(3 * n, sizeof(double));
    s->forces = (double *)memory(3 * n, sizeof(double));
    s->targets = (double *)memory(3 * n, sizeof(double));
    memcpy(s->rest, m->positions, 3 * n * sizeof(double));
    for (e = 0; e < m->element_count; e++) {
        memcpy(s->elements[e].copy, m->elements + 4 * e, sizeof s->elements[e].copy);
        scene_element(&s->elements[e], s->rest, density);
    }
    s->material.kind = kind;
    s->material.young = young;
    s->material.poisson = poisson;
    s->model.copy_count = n;
    s->model.positions = s->rest;
    s->model.elements = s->elements;
    s->model.element_count = m->element_count;
    s->model.materials = &s->material;
    s->model.material_count = 1;
    s->model.held = s->held;
    return s;
}

static void scene_free(scene *s) {
    gxs_solver_destroy(s->solver);
    free(s->elements);
    free(s->held);
    free(s->rest);
    free(s->displacement);
    free(s->velocity);
    free(s->forces);
    free(s->targets);
    free(s);
}

static gxs_step_report scene_step(scene *s, const gxs_step_desc *step) {
    gxs_step_report report;
    gx_result result = GX_OK;
    if (!s->solver) {
        result = gxs_solver_create(NULL, &s->solver, NULL);
        if (result == GX_OK) result = gxs_solver_set_model(s->solver, &s->model, NULL);
    }
    expect(result == GX_OK, "the model is refused");
    memset(&report, 0, sizeof report);
    result = gxs_solver_step(s->solver, step, s->displacement, s->velocity, &report, NULL);
    if (result != GX_OK) fprintf(stderr, "bench: step ends with result %d\n", (int)result);
    expect(result == GX_OK, "a step failed");
    return report;
}

#endif
