/* exchange.c - bodies that are saved on one machine and go on on another. platforms.sh runs it on both.

       exchange write FILE   cuts a block, moves it, saves it
       exchange read FILE    loads it, cuts it again, and prints hashes of what came; then moves it, and prints where
   to, to four digits: each machine adds in its own order */
#include "../gxfem.h"
#include "../bench/block.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(const char *what, gx_result result) {
    fprintf(stderr, "exchange: %s: %s\n", what, gx_result_text(result));
    return 1;
}

/* A plane through the middle of the block, across one axis, leaning */
static gx_result cut(gx_body *body, int axis) {
    double vertices[9];
    static const uint32_t triangle[3] = {0, 1, 2};
    static const double corners[3][2] = {{-9, -9}, {9, -9}, {0.3, 9}};
    gx_surface surface;
    gx_cut_desc desc;
    int i;
    for (i = 0; i < 3; i++) {
        vertices[3 * i + axis] = 0.45 + 0.125 * corners[i][0];
        vertices[3 * i + (axis + 1) % 3] = corners[i][0];
        vertices[3 * i + (axis + 2) % 3] = corners[i][1];
    }
    memset(&surface, 0, sizeof surface);
    surface.vertices = vertices;
    surface.vertex_count = 3;
    surface.triangles = triangle;
    surface.triangle_count = 1;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &surface;
    desc.surface_count = 1;
    return gx_body_cut(body, &desc, NULL, NULL);
}

static gx_result make(gx_body **body) {
    gx_body_desc desc;
    block_mesh mesh;
    gx_result result;
    if (block_make_mesh(3, 0.2, &mesh) != GX_OK) return GX_ERROR_MEMORY;
    memset(&desc, 0, sizeof desc);
    desc.positions = mesh.positions;
    desc.node_count = mesh.side * mesh.side * mesh.side;
    desc.elements = mesh.elements;
    desc.element_count = 5 * 27;
    desc.young = 2e5;
    desc.poisson = 0.4;
    desc.density = 1000;
    result = gx_body_create(&desc, body, NULL);
    block_free_mesh(&mesh);
    return result;
}

static int write_file(const char *path) {
    gx_body *body = NULL;
    gx_step_desc step;
    gx_result result = make(&body);
    void *bytes = NULL;
    size_t size = 0;
    FILE *file;
    int good;
    memset(&step, 0, sizeof step);
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    if (result == GX_OK) result = cut(body, 0);
    if (result == GX_OK) result = gx_body_step(body, &step, NULL, NULL);
    if (result == GX_OK) result = gx_body_save(body, NULL, 0, &size, NULL);
    if (result != GX_OK && result != GX_ERROR_CAPACITY) return fail("a body", result);
    bytes = malloc(size);
    result = gx_body_save(body, bytes, size, &size, NULL);
    if (result != GX_OK) return fail("saving", result);
    file = fopen(path, "wb");
    good = file != NULL && fwrite(bytes, 1, size, file) == size;
    if (file == NULL || fclose(file) != 0 || !good) return fail(path, GX_ERROR_CAPACITY);
    free(bytes);
    gx_body_destroy(body);
    return 0;
}

static void print_hash(const char *name, uint64_t hash) {
    printf("%s %08lx%08lx\n", name, (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffff));
}

/* Hangs by a side for a third of a second */
static gx_result swing(gx_body *body) {
    const gx_region side = gx_region_half_space(0, -1, 0.1);
    gx_step_desc step;
    gx_view view;
    gx_result result = gx_body_hold(body, &side, 1, NULL);
    double sum[3] = {0, 0, 0};
    size_t i;
    int k;
    memset(&step, 0, sizeof step);
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    step.newton_iterations = 20;
    for (k = 0; k < 20 && result == GX_OK; k++) result = gx_body_step(body, &step, NULL, NULL);
    if (result == GX_OK) result = gx_body_view(body, &view, NULL);
    if (result != GX_OK) return result;
    for (i = 0; i < view.copy_count; i++)
        for (k = 0; k < 3; k++) sum[k] += view.displacement[3 * i + (size_t)k] * view.displacement[3 * i + (size_t)k];
    printf("moved %.4g %.4g %.4g\n", sum[0], sum[1], sum[2]);
    return GX_OK;
}

static int read_file(const char *path) {
    static unsigned char bytes[1 << 22];
    gx_body *body = NULL;
    FILE *file = fopen(path, "rb");
    size_t size;
    gx_result result;
    if (file == NULL) return fail(path, GX_ERROR_ARGUMENT);
    size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    result = gx_body_load(bytes, size, NULL, &body, NULL);
    if (result != GX_OK) return fail("loading", result);
    print_hash("state", gx_body_state_hash(body));
    print_hash("loaded", gx_body_topology_hash(body, NULL));
    result = cut(body, 1);
    if (result != GX_OK) return fail("a cut", result);
    print_hash("cut", gx_body_topology_hash(body, NULL));
    result = swing(body);
    if (result != GX_OK) return fail("steps", result);
    gx_body_destroy(body);
    return 0;
}

int main(int argc, char **argv) {
    if (argc == 3 && strcmp(argv[1], "write") == 0) return write_file(argv[2]);
    if (argc == 3 && strcmp(argv[1], "read") == 0) return read_file(argv[2]);
    fprintf(stderr, "usage: exchange write|read FILE\n");
    return 2;
}
