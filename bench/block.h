/* block.h - the benches' scenes: a cube that hangs by its top, cut in several ways.

   Edge 1 m, n^3 cells of 5 tetrahedra, every other cell mirrored so that diagonals meet. Cuts are placed in units of
   cells, at fractions of a cell that differ from cut to cut and stay clear of lattice planes. So a scene is of the
   same kind at any size: the same number of cells between two cuts, elements divided as unevenly.
       uncut       one fragment
       accordion   horizontal cuts 2.5 cells apart, from the left and from the right in turn, each through 87 % of
                   the block: one fragment, which hangs together in a zigzag
       loose       planes 2.5 cells apart across each axis: fragments without a link; the top ones are held, the
                   others fall

   Include after gxfem.h. */
#ifndef GXFEM_BENCH_BLOCK_H
#define GXFEM_BENCH_BLOCK_H

#include <stdlib.h>
#include <string.h>

enum { BLOCK_UNCUT, BLOCK_ACCORDION, BLOCK_LOOSE, BLOCK_CUTS };

typedef struct block_desc {
    uint32_t cells;              /* along an edge */
    double jitter;               /* inner nodes move by up to this many cells along each axis */
    int cut;                     /* BLOCK_UNCUT ... */
    double young;                /* Pa */
    gx_allocator allocator;      /* of the body; zero: malloc, free */
    double (*clock)(void *user); /* of the body's reports; NULL: none */
} block_desc;

static const char *const block_cut_names[BLOCK_CUTS] = {"uncut", "accordion", "loose"};

/* A little more than 2.5, so that the fraction of a cell at which cuts lie drifts. In the largest block it is still
   0.1 away from a lattice plane. */
static const double block_spacing = 2.5137;

/* Of the first cut of the accordion, and of the first plane across each axis; cells. */
static const double block_offset[3] = {2.2711, 2.2371, 2.2137};

/* ---- mesh ---- */

typedef struct block_mesh {
    size_t side;        /* nodes along an edge */
    double *positions;  /* side^3 x 3, m */
    uint32_t *elements; /* 5 (side - 1)^3 x 4 */
    uint32_t random;    /* state of the generator */
} block_mesh;

/* From -1 to 1: the same numbers on every machine (Numerical Recipes' linear congruential generator, upper bits). */
static double block_uniform(block_mesh *mesh) {
    mesh->random = mesh->random * 1664525u + 1013904223u;
    return (mesh->random >> 8) / 8388608.0 - 1.0;
}

static size_t block_node(const block_mesh *mesh, const size_t at[3]) {
    return (at[2] * mesh->side + at[1]) * mesh->side + at[0];
}

static int block_is_inner(const block_mesh *mesh, const size_t at[3]) {
    int k, inner = 1;
    for (k = 0; k < 3; k++) inner = inner && at[k] > 0 && at[k] + 1 < mesh->side;
    return inner;
}

static void block_place_node(block_mesh *mesh, const size_t at[3], double jitter) {
    double *x = mesh->positions + 3 * block_node(mesh, at);
    int k;
    for (k = 0; k < 3; k++) {
        const double moved = block_is_inner(mesh, at) ? jitter * block_uniform(mesh) : 0.0;
        x[k] = ((double)at[k] + moved) / (double)(mesh->side - 1);
    }
}

/* The five tetrahedra of a cell; bits 0, 1, 2 of a corner are its steps along the axes. A mirror image has its last
   two corners exchanged, so that its volume is positive again. */
static void block_fill_cell(block_mesh *mesh, const size_t at[3]) {
    static const unsigned corners[5][4] = {{0, 5, 3, 6}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 6, 5, 0}, {7, 5, 6, 3}};
    const size_t cells = mesh->side - 1, cell = (at[2] * cells + at[1]) * cells + at[0];
    const unsigned mirrored = (at[0] + at[1] + at[2]) & 1;
    unsigned t, c;
    for (t = 0; t < 5; t++)
        for (c = 0; c < 4; c++) {
            const unsigned corner = corners[t][mirrored && c > 1 ? 5 - c : c] ^ mirrored;
            const size_t node[3] = {at[0] + (corner & 1), at[1] + (corner >> 1 & 1), at[2] + (corner >> 2)};
            mesh->elements[4 * (5 * cell + t) + c] = (uint32_t)block_node(mesh, node);
        }
}

static void block_fill(block_mesh *mesh, double jitter) {
    const size_t cells = mesh->side - 1;
    size_t at[3];
    for (at[2] = 0; at[2] <= cells; at[2]++)
        for (at[1] = 0; at[1] <= cells; at[1]++)
            for (at[0] = 0; at[0] <= cells; at[0]++) {
                block_place_node(mesh, at, jitter);
                if (at[0] < cells && at[1] < cells && at[2] < cells) block_fill_cell(mesh, at);
            }
}

/* ---- cuts ---- */

/* A rectangle across an axis, at a distance from the origin. It covers low to high of the next axis and all of the
   third. */
static gx_result block_cut_rectangle(gx_body *body, uint32_t axis, double distance, double low, double high) {
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    const double along[4] = {low, high, high, low}, across[4] = {-0.1, -0.1, 1.1, 1.1};
    double vertices[12];
    gx_surface sheet;
    gx_cut_desc desc;
    unsigned c;
    memset(&sheet, 0, sizeof sheet);
    memset(&desc, 0, sizeof desc);
    for (c = 0; c < 4; c++) {
        vertices[3 * c + axis] = distance;
        vertices[3 * c + (axis + 1) % 3] = along[c];
        vertices[3 * c + (axis + 2) % 3] = across[c];
    }
    sheet.vertices = vertices;
    sheet.vertex_count = 4;
    sheet.triangles = triangles;
    sheet.triangle_count = 2;
    desc.surfaces = &sheet;
    desc.surface_count = 1;
    return gx_body_cut(body, &desc, NULL, NULL);
}

/* Cuts across an axis as long as a cell is left beyond the last one; from either side in turn, or all the way
   through */
static gx_result block_cut_axis(gx_body *body, const block_desc *desc, uint32_t axis, int through) {
    gx_result result = GX_OK;
    double at = block_offset[axis];
    int left = 1;
    for (; at <= desc->cells - 1.0 && result == GX_OK; at += block_spacing, left = !left)
        result = block_cut_rectangle(body, axis, at / desc->cells, through || left ? -0.1 : 0.13,
                                     through || !left ? 1.1 : 0.87);
    return result;
}

static gx_result block_cut(gx_body *body, const block_desc *desc) {
    gx_result result = GX_OK;
    uint32_t axis;
    if (desc->cut == BLOCK_ACCORDION) return block_cut_axis(body, desc, 2, 0);
    for (axis = 0; axis < 3 && desc->cut == BLOCK_LOOSE && result == GX_OK; axis++)
        result = block_cut_axis(body, desc, axis, 1);
    return result;
}

/* ---- body ---- */

static gx_result block_make_body(const block_mesh *mesh, const block_desc *block, gx_body **body) {
    const size_t side = mesh->side, cells = side - 1;
    gx_body_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.positions = mesh->positions;
    desc.node_count = side * side * side;
    desc.elements = mesh->elements;
    desc.element_count = 5 * cells * cells * cells;
    desc.young = block->young;
    desc.poisson = 0.4;
    desc.density = 1000.0;
    desc.allocator = block->allocator;
    desc.clock = block->clock;
    return gx_body_create(&desc, body, NULL);
}

/* jitter: see block_desc. The caller frees it. */
static gx_result block_make_mesh(uint32_t cell_count, double jitter, block_mesh *mesh) {
    const size_t side = (size_t)cell_count + 1, cells = cell_count;
    mesh->side = side;
    mesh->random = 1;
    mesh->positions = (double *)malloc(side * side * side * 3 * sizeof(double));
    mesh->elements = (uint32_t *)malloc(cells * cells * cells * 20 * sizeof(uint32_t));
    if (!mesh->positions || !mesh->elements) return GX_ERROR_MEMORY;
    block_fill(mesh, jitter);
    return GX_OK;
}

static void block_free_mesh(block_mesh *mesh) {
    free(mesh->positions);
    free(mesh->elements);
}

static gx_result block_make_mesh_and_body(const block_desc *desc, gx_body **body) {
    block_mesh mesh;
    gx_result result = block_make_mesh(desc->cells, desc->jitter, &mesh);
    if (result == GX_OK) result = block_make_body(&mesh, desc, body);
    block_free_mesh(&mesh);
    return result;
}

/* The scene: made, cut and held at z = 1. GX_ERROR_INVERTED if the jitter turned an element inside out. */
static inline gx_result block_create(const block_desc *desc, gx_body **body) {
    const gx_region top = gx_region_half_space(2, 1, 1.0 - 1e-9);
    gx_result result = block_make_mesh_and_body(desc, body);
    if (result != GX_OK) return result;
    result = block_cut(*body, desc);
    if (result == GX_OK) result = gx_body_hold(*body, &top, 1, NULL);
    if (result == GX_OK) return GX_OK;
    gx_body_destroy(*body);
    *body = NULL;
    return result;
}

#endif /* GXFEM_BENCH_BLOCK_H */
