/* strokes.h - blocks of n^3 unit cubes, six tetrahedra each, that tools take material from, thousands of times. Each
   stroke is a function of its number, so that another body can be cut by the same ones at once.

   shave    boxes turned at random about z take thin shavings off the top
   scratch  thin boxes scrape one layer again and again, mostly where nothing is left
   punch    octahedra in random places, until little is left
   slice    a box without a lid cuts shavings off the top, and a solid removes what has come off
   carve    octahedra at the top, by gx_body_carve

   Include after gxfem.h. */
#ifndef GXFEM_BENCH_STROKES_H
#define GXFEM_BENCH_STROKES_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../examples/gxio.h"
#include "splitmix.h"

enum { STROKES_SHAVE, STROKES_SCRATCH, STROKES_PUNCH, STROKES_SLICE, STROKES_CARVE, STROKES_KINDS };
static const char *const strokes_names[STROKES_KINDS] = {"shave", "scratch", "punch", "slice", "carve"};

/* The closed surface of a tool: a box (8 corners, 12 triangles) or an octahedron (6, 8) */
typedef struct strokes_tool {
    double vertices[24];
    uint32_t triangles[36];
    size_t vertex_count, triangle_count;
} strokes_tool;

typedef struct strokes {
    int kind;
    uint32_t side;  /* cubes along an edge */
    uint32_t total; /* strokes that the scene is made for */
    uint64_t random;
} strokes;

/* From 0 to 1 */
static inline double strokes_uniform(strokes *s) { return ldexp((double)(splitmix64(&s->random) >> 11), -53); }

/* ---- tools ---- */

/* A box around (x, y): half its edges a and b, turned about z, from low to high */
static inline void strokes_box(strokes_tool *t, double x, double y, double a, double b, double turn, double low,
                               double high) {
    static const uint32_t faces[36] = {0, 2, 3, 0, 3, 1, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3,
                                       0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 4, 5, 7, 4, 7, 6};
    int c;
    t->vertex_count = 8;
    t->triangle_count = 12; /* the last two are the lid */
    memcpy(t->triangles, faces, sizeof faces);
    for (c = 0; c < 8; c++) {
        const double u = c & 1 ? a : -a, v = c & 2 ? b : -b;
        t->vertices[3 * c] = x + cos(turn) * u - sin(turn) * v;
        t->vertices[3 * c + 1] = y + sin(turn) * u + cos(turn) * v;
        t->vertices[3 * c + 2] = c & 4 ? high : low;
    }
}

static inline void strokes_octahedron(strokes *s, strokes_tool *t, const double centre[3], double radius) {
    static const uint32_t faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    double axis[3][3], length = 0, dot = 0;
    int c, k;
    t->vertex_count = 6;
    t->triangle_count = 8;
    memcpy(t->triangles, faces, sizeof faces);
    for (k = 0; k < 3; k++) axis[0][k] = strokes_uniform(s) - 0.5, axis[1][k] = strokes_uniform(s) - 0.5;
    for (k = 0; k < 3; k++) length += axis[0][k] * axis[0][k];
    for (k = 0; k < 3; k++) axis[0][k] /= sqrt(length), dot += axis[0][k] * axis[1][k];
    for (length = 0, k = 0; k < 3; k++) axis[1][k] -= dot * axis[0][k], length += axis[1][k] * axis[1][k];
    for (k = 0; k < 3; k++) axis[1][k] /= sqrt(length);
    for (k = 0; k < 3; k++)
        axis[2][k] = axis[0][(k + 1) % 3] * axis[1][(k + 2) % 3] - axis[0][(k + 2) % 3] * axis[1][(k + 1) % 3];
    for (c = 0; c < 6; c++)
        for (k = 0; k < 3; k++) t->vertices[3 * c + k] = centre[k] + (c & 1 ? -radius : radius) * axis[c / 2][k];
}

/* The tool of a stroke */
static inline void strokes_make(const strokes *scene, uint32_t stroke, strokes_tool *t) {
    strokes own = *scene, *s = &own;
    const double n = s->side, part = (stroke + 0.5) / s->total;
    double at[3];
    s->random = UINT64_C(0x632be59bd9b4e019) * (stroke + 1) + (uint64_t)s->kind;
    at[0] = n * strokes_uniform(s);
    at[1] = n * strokes_uniform(s);
    switch (s->kind) {
    case STROKES_SHAVE:
    case STROKES_SLICE:
        strokes_box(t, at[0], at[1], 1.1, 0.7, 3.1 * strokes_uniform(s),
                    n * (1 - 0.6 * part) - 0.02 * strokes_uniform(s), n + 1 + strokes_uniform(s));
        break;
    case STROKES_SCRATCH:
        strokes_box(t, at[0], at[1], 1.5, 0.05, 3.1 * strokes_uniform(s), n - 0.7 - 0.2 * strokes_uniform(s),
                    n + 1 + strokes_uniform(s));
        break;
    case STROKES_PUNCH:
        at[2] = n * strokes_uniform(s);
        strokes_octahedron(s, t, at, 0.3 + 0.3 * strokes_uniform(s));
        break;
    default:
        at[2] = n * (1 - 0.6 * part) + 0.3 * strokes_uniform(s);
        strokes_octahedron(s, t, at, 0.8 + 0.5 * strokes_uniform(s));
    }
}

/* ---- bodies ---- */

static inline gx_result strokes_body(uint32_t side, const gx_allocator *allocator, double (*clock)(void *user),
                                     gx_body **body) {
    size_t n[3];
    gxio_mesh mesh;
    gx_body_desc desc;
    gx_result result = GX_ERROR_MEMORY;
    memset(&mesh, 0, sizeof mesh);
    memset(&desc, 0, sizeof desc);
    n[0] = n[1] = n[2] = side;
    if (gxio_make_grid(&mesh, n, 6)) result = GX_OK;
    desc.positions = mesh.positions;
    desc.node_count = mesh.node_count;
    desc.elements = mesh.elements;
    desc.element_count = mesh.element_count;
    desc.young = 1e5;
    desc.poisson = 0.3;
    desc.density = 1000;
    desc.clock = clock;
    if (allocator != NULL) desc.allocator = *allocator;
    if (result == GX_OK) result = gx_body_create(&desc, body, NULL);
    gxio_mesh_release(&mesh);
    return result;
}

static inline gx_surface strokes_surface(const strokes_tool *t, uint32_t kind) {
    gx_surface surface;
    memset(&surface, 0, sizeof surface);
    surface.vertices = t->vertices;
    surface.vertex_count = t->vertex_count;
    surface.triangles = t->triangles;
    surface.triangle_count = t->triangle_count;
    surface.kind = kind;
    return surface;
}

static inline gx_result strokes_cut(gx_body *body, const gx_surface *surface, const uint32_t *fragments, size_t count,
                                    gx_cut_report *report) {
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surface;
    desc.surface_count = 1;
    desc.scope_fragments = fragments;
    desc.scope_fragment_count = count;
    return gx_body_cut(body, &desc, report, NULL);
}

/* Removes all fragments but the first. */
static inline gx_result strokes_remove(gx_body *body, uint32_t side, gx_cut_report *report) {
    strokes_tool all;
    gx_surface surface;
    gx_view view;
    uint32_t *others;
    uint32_t i, largest = 0, count = 0;
    gx_result result;
    memset(&view, 0, sizeof view);
    result = gx_body_view(body, &view, NULL);
    if (result != GX_OK || view.fragment_count < 2) return result;
    others = (uint32_t *)malloc(view.fragment_count * sizeof *others);
    if (others == NULL) return GX_ERROR_MEMORY;
    for (i = 1; i < view.fragment_count; i++)
        if (view.fragment_volume[i] > view.fragment_volume[largest]) largest = i;
    for (i = 0; i < view.fragment_count; i++)
        if (i != largest) others[count++] = i;
    strokes_box(&all, 0.5 * side, 0.5 * side, side, side, 0, -1, 3.0 * side);
    surface = strokes_surface(&all, GX_SURFACE_SOLID);
    result = strokes_cut(body, &surface, others, count, report);
    free(others);
    return result;
}

/* Cuts a body by a stroke. *report: of the cut that goes through the most elements */
static inline gx_result strokes_apply(const strokes *scene, gx_body *body, uint32_t stroke, gx_cut_report *report) {
    strokes_tool tool;
    gx_surface surface;
    gx_result result;
    strokes_make(scene, stroke, &tool);
    surface = strokes_surface(&tool, GX_SURFACE_SOLID);
    if (scene->kind == STROKES_CARVE) return gx_body_carve(body, &surface, report, NULL);
    if (scene->kind != STROKES_SLICE) return strokes_cut(body, &surface, NULL, 0, report);
    surface.kind = GX_SURFACE_SHEET;
    surface.triangle_count -= 2;
    result = strokes_cut(body, &surface, NULL, 0, report);
    return result == GX_OK ? strokes_remove(body, scene->side, NULL) : result;
}

/* ---- the same shape, cut at once ---- */

static inline int strokes_is_inside(const strokes_tool *t, const double x[3]) {
    size_t i;
    int k, inside = 1;
    for (i = 0; i < t->triangle_count && inside; i++) {
        const double *a = t->vertices + 3 * t->triangles[3 * i], *b = t->vertices + 3 * t->triangles[3 * i + 1],
                     *c = t->vertices + 3 * t->triangles[3 * i + 2];
        double height = 0;
        for (k = 0; k < 3; k++) {
            const int p = (k + 1) % 3, q = (k + 2) % 3;
            height += ((b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p])) * (x[k] - a[k]);
        }
        inside = height < -1e-9;
    }
    return inside;
}

/* Small cubes of the block: which of them has an earlier tool covered? Their corners are in the tool at work or not. */
typedef struct strokes_grid {
    uint8_t *covered, *corner;
    uint32_t n;
} strokes_grid;
enum { STROKES_PER_CUBE = 8 };

/* Does a tool reach small cubes that are not covered? Covers those that it contains. */
static inline int strokes_cover(strokes_grid *g, const strokes_tool *t) {
    uint32_t low[3], high[3], x, y, z, k;
    size_t c;
    int reaches = 0;
    for (k = 0; k < 3; k++) {
        double least = g->n, most = 0;
        for (c = 0; c < t->vertex_count; c++) {
            least = fmin(least, STROKES_PER_CUBE * t->vertices[3 * c + k]);
            most = fmax(most, STROKES_PER_CUBE * t->vertices[3 * c + k]);
        }
        low[k] = (uint32_t)fmax(0, floor(least));
        high[k] = (uint32_t)fmin(g->n, ceil(most));
    }
    for (z = low[2]; z <= high[2]; z++)
        for (y = low[1]; y <= high[1]; y++)
            for (x = low[0]; x <= high[0]; x++) {
                double p[3];
                p[0] = (double)x / STROKES_PER_CUBE;
                p[1] = (double)y / STROKES_PER_CUBE;
                p[2] = (double)z / STROKES_PER_CUBE;
                g->corner[((size_t)z * (g->n + 1) + y) * (g->n + 1) + x] = (uint8_t)strokes_is_inside(t, p);
            }
    for (z = low[2]; z < high[2]; z++)
        for (y = low[1]; y < high[1]; y++)
            for (x = low[0]; x < high[0]; x++) {
                uint8_t *covered = &g->covered[((size_t)z * g->n + y) * g->n + x], all = 1;
                for (k = 0; k < 8; k++)
                    all &=
                        g->corner[((size_t)(z + (k >> 2)) * (g->n + 1) + y + (k >> 1 & 1)) * (g->n + 1) + x + (k & 1)];
                reaches |= !*covered;
                *covered |= all;
            }
    return reaches;
}

/* The strokes whose tools later ones do not certainly hide. Returns their number. */
static inline uint32_t strokes_seen(const strokes *scene, uint32_t *list) {
    strokes_grid g;
    uint32_t i, count = 0;
    g.n = STROKES_PER_CUBE * scene->side;
    g.covered = (uint8_t *)calloc((size_t)g.n * g.n * g.n, 1);
    g.corner = (uint8_t *)malloc((size_t)(g.n + 1) * (g.n + 1) * (g.n + 1));
    for (i = scene->total; i-- > 0 && g.covered != NULL && g.corner != NULL;) {
        strokes_tool tool;
        strokes_make(scene, i, &tool);
        if (strokes_cover(&g, &tool)) list[count++] = i;
    }
    free(g.covered);
    free(g.corner);
    return count;
}

/* Cuts a body by the union of all tools of the scene at once. */
static inline gx_result strokes_cut_fresh(const strokes *scene, gx_body *body) {
    uint32_t *list = (uint32_t *)malloc(scene->total * sizeof *list), count = strokes_seen(scene, list), i, k;
    double *vertices = (double *)malloc((size_t)count * 24 * sizeof *vertices);
    uint32_t *triangles = (uint32_t *)malloc((size_t)count * 36 * sizeof *triangles);
    gxb_operand operand;
    gxb_boolean_result all;
    gxb_boolean *boolean = NULL;
    gx_surface surface;
    gx_result result;
    memset(&operand, 0, sizeof operand);
    for (i = count; i-- > 0;) {
        strokes_tool tool;
        strokes_make(scene, list[i], &tool);
        memcpy(vertices + 3 * operand.vertex_count, tool.vertices, 3 * tool.vertex_count * sizeof *vertices);
        for (k = 0; k < 3 * tool.triangle_count; k++)
            triangles[3 * operand.triangle_count + k] = tool.triangles[k] + (uint32_t)operand.vertex_count;
        operand.vertex_count += tool.vertex_count;
        operand.triangle_count += tool.triangle_count;
    }
    operand.vertices = vertices;
    operand.triangles = triangles;
    result = gxb_boolean_create(NULL, &boolean, NULL);
    if (result == GX_OK) result = gxb_boolean_set_triangulation(boolean, GXB_MERGED, NULL);
    if (result == GX_OK) result = gxb_boolean_set_fine(boolean, 1, NULL);
    if (result == GX_OK) result = gxb_boolean_add(boolean, &operand, NULL);
    if (result == GX_OK) result = gxb_boolean_evaluate(boolean, &all, NULL);
    if (result == GX_OK) {
        memset(&surface, 0, sizeof surface);
        surface.vertices = all.vertices;
        surface.vertex_count = all.vertex_count;
        surface.triangles = all.triangles;
        surface.triangle_count = all.triangle_count;
        surface.kind = GX_SURFACE_SOLID;
        result = strokes_cut(body, &surface, NULL, 0, NULL);
    }
    if (result == GX_OK && scene->kind == STROKES_SLICE) result = strokes_remove(body, scene->side, NULL);
    gxb_boolean_destroy(boolean);
    free(vertices);
    free(triangles);
    free(list);
    return result;
}

#endif
