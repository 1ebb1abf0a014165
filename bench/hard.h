/* hard.h - the hard cases: each is a scene, its right outcome, and a judgement of what a method makes of it.

   A cube of 2 x 2 x 2 cells of five tetrahedra (or one tetrahedron) is cut and moves for twenty steps. Nothing holds
   it, or its top is held. An outcome is right if all of these hold:
       pieces    as many as the cuts leave, found by hand for each case; parts that share no copy are apart
       volume    the volume that is left, and that of the smallest piece, to 1 % (for "but for volume": to 50 %,
                 since thick cuts take some away)
       motion    only finite numbers, and nothing faster than ten times a fall
       fall      where nothing is held, each piece falls as a point does, to 1 %

   Cases about integrals also have a part of the unit tetrahedron under planes, for ways of integration that are no
   method of cutting.

   Include after method.h. */
#ifndef GXFEM_BENCH_HARD_H
#define GXFEM_BENCH_HARD_H

#include "part.h"
#include "sampling.h"

enum { HARD_STEPS = 20, HARD_TEXT = 120 };

/* ---- scenes ---- */

typedef struct hard_trial {
    replay scene;
    size_t pieces;    /* expected */
    double volume;    /* of the mesh, m3 */
    double removed;   /* by solids, m3 */
    double tolerance; /* of volumes, as a share of the mesh's: what a solid's thickness takes away */
    double smallest;  /* of the pieces, m3; 0: not given */
    int held;         /* 1: the top is */
    /* Cases about integrals: parts of the unit tetrahedron under the planes z = levels, ascending, and between them;
       or one part under x + y + z = corner */
    double *levels;
    size_t level_count;
    double corner; /* 0: none */
} hard_trial;

static uint32_t hard_add_node(replay *r, double x, double y, double z) {
    const double p[3] = {x, y, z};
    r->positions = (double *)replay_array(r, r->positions, 3 * (r->node_count + 1), sizeof(double));
    memcpy(r->positions + 3 * r->node_count, p, sizeof p);
    return (uint32_t)r->node_count++;
}

static void hard_add_element(replay *r, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const double *x = r->positions;
    const double tet[12] = {x[3 * a], x[3 * a + 1], x[3 * a + 2], x[3 * b], x[3 * b + 1], x[3 * b + 2],
                            x[3 * c], x[3 * c + 1], x[3 * c + 2], x[3 * d], x[3 * d + 1], x[3 * d + 2]};
    const int turned = gxi_tet_volume(tet) < 0;
    const uint32_t nodes[4] = {a, b, turned ? d : c, turned ? c : d};
    r->elements = (uint32_t *)replay_array(r, r->elements, 4 * (r->element_count + 1), sizeof(uint32_t));
    memcpy(r->elements + 4 * r->element_count++, nodes, sizeof nodes);
}

static void hard_make_cube(replay *r) {
    static const uint32_t five[5][4] = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
    uint32_t x, y, z, t, k, n[4];
    for (z = 0; z < 3; z++)
        for (y = 0; y < 3; y++)
            for (x = 0; x < 3; x++) hard_add_node(r, 0.5 * x, 0.5 * y, 0.5 * z);
    for (z = 0; z < 2; z++)
        for (y = 0; y < 2; y++)
            for (x = 0; x < 2; x++)
                for (t = 0; t < 5; t++) {
                    for (k = 0; k < 4; k++) {
                        const uint32_t c = five[t][k] ^ ((x + y + z) & 1 ? 7u : 0u);
                        n[k] = 9 * (z + (c >> 2)) + 3 * (y + (c >> 1 & 1)) + x + (c & 1);
                    }
                    hard_add_element(r, n[0], n[1], n[2], n[3]);
                }
}

static void hard_make_tetrahedron(replay *r) {
    hard_add_node(r, 0, 0, 0);
    hard_add_node(r, 1, 0, 0);
    hard_add_node(r, 0, 1, 0);
    hard_add_node(r, 0, 0, 1);
    hard_add_element(r, 0, 1, 2, 3);
}

/* ---- cuts ---- */

static gx_surface *hard_add_cut(replay *r, size_t frame, uint32_t kind) {
    r->cuts = (replay_cut *)replay_array(r, r->cuts, r->cut_count + 1, sizeof *r->cuts);
    memset(&r->cuts[r->cut_count], 0, sizeof *r->cuts);
    r->cuts[r->cut_count].frame = frame;
    r->cuts[r->cut_count].path.kind = kind;
    return &r->cuts[r->cut_count++].path;
}

static uint32_t hard_add_vertex(const replay *r, gx_surface *s, double x, double y, double z) {
    const double p[3] = {x, y, z};
    double *grown =
        (double *)replay_array(r, (void *)(uintptr_t)s->vertices, 3 * (s->vertex_count + 1), sizeof(double));
    memcpy(grown + 3 * s->vertex_count, p, sizeof p);
    s->vertices = grown;
    return (uint32_t)s->vertex_count++;
}

static void hard_add_triangle(const replay *r, gx_surface *s, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t t[3] = {a, b, c};
    uint32_t *grown =
        (uint32_t *)replay_array(r, (void *)(uintptr_t)s->triangles, 3 * (s->triangle_count + 1), sizeof(uint32_t));
    memcpy(grown + 3 * s->triangle_count++, t, sizeof t);
    s->triangles = grown;
}

/* Parallelogram p + a u + b v, 0 <= a, b <= 1 */
static gx_surface *hard_add_quad(replay *r, size_t frame, const double p[3], const double u[3], const double v[3]) {
    gx_surface *s = hard_add_cut(r, frame, GX_SURFACE_SHEET);
    hard_add_vertex(r, s, p[0], p[1], p[2]);
    hard_add_vertex(r, s, p[0] + u[0], p[1] + u[1], p[2] + u[2]);
    hard_add_vertex(r, s, p[0] + u[0] + v[0], p[1] + u[1] + v[1], p[2] + u[2] + v[2]);
    hard_add_vertex(r, s, p[0] + v[0], p[1] + v[1], p[2] + v[2]);
    hard_add_triangle(r, s, 0, 1, 2);
    hard_add_triangle(r, s, 0, 2, 3);
    return s;
}

/* z = at + a (x - 1/2) + b (y - 1/2), over -1 to 2 */
static void hard_add_level(replay *r, size_t frame, double at, double a, double b) {
    const double p[3] = {-1, -1, at - 1.5 * a - 1.5 * b}, u[3] = {3, 0, 3 * a}, v[3] = {0, 3, 3 * b};
    hard_add_quad(r, frame, p, u, v);
}

/* The plane through c with the normal n, 3 to each side */
static void hard_add_plane(replay *r, size_t frame, const double c[3], const double n[3]) {
    const int k = fabs(n[0]) <= fabs(n[1]) && fabs(n[0]) <= fabs(n[2]) ? 0 : fabs(n[1]) <= fabs(n[2]) ? 1 : 2;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    double u[3], v[3], p[3], length = 0;
    int d;
    u[k] = 0;
    u[i] = -n[j];
    u[j] = n[i];
    for (d = 0; d < 3; d++) v[d] = n[(d + 1) % 3] * u[(d + 2) % 3] - n[(d + 2) % 3] * u[(d + 1) % 3];
    for (d = 0; d < 3; d++) length += v[d] * v[d];
    for (d = 0; d < 3; d++) {
        v[d] *= 6 / sqrt(length);
        u[d] *= 6 / sqrt(u[i] * u[i] + u[j] * u[j] > 0 ? length : 1);
    }
    for (d = 0; d < 3; d++) p[d] = c[d] - 0.5 * u[d] - 0.5 * v[d];
    hard_add_quad(r, frame, p, u, v);
}

/* The strip over a polyline in the x-z plane, extended along y */
static void hard_add_strip(replay *r, const double (*at)[2], uint32_t count) {
    gx_surface *s = hard_add_cut(r, 0, GX_SURFACE_SHEET);
    uint32_t i;
    for (i = 0; i < count; i++) {
        hard_add_vertex(r, s, at[i][0], -0.2, at[i][1]);
        hard_add_vertex(r, s, at[i][0], 1.2, at[i][1]);
    }
    for (i = 0; i + 1 < count; i++) {
        hard_add_triangle(r, s, 2 * i, 2 * i + 1, 2 * i + 3);
        hard_add_triangle(r, s, 2 * i, 2 * i + 3, 2 * i + 2);
    }
}

static void hard_add_box(replay *r, const double low[3], const double high[3]) {
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    gx_surface *s = hard_add_cut(r, 0, GX_SURFACE_SOLID);
    uint32_t i;
    for (i = 0; i < 8; i++)
        hard_add_vertex(r, s, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
    for (i = 0; i < 6; i++) {
        hard_add_triangle(r, s, quads[i][0], quads[i][1], quads[i][2]);
        hard_add_triangle(r, s, quads[i][0], quads[i][2], quads[i][3]);
    }
}

/* ---- the catalogue ---- */

static void hard_add_region_level(hard_trial *t, double at) {
    t->levels = (double *)replay_array(&t->scene, t->levels, t->level_count + 1, sizeof(double));
    t->levels[t->level_count++] = at;
}

static void hard_through_node(hard_trial *t) {
    const double c[3] = {0.5, 0.5, 0.5}, n[3] = {4, 1, 2};
    hard_add_plane(&t->scene, 0, c, n);
}

static void hard_along_edge(hard_trial *t) {
    /* through x = y = 1/2, where edges are */
    const double p[3] = {-0.5, 0, -1}, u[3] = {2, 1, 0}, v[3] = {0, 0, 3};
    hard_add_quad(&t->scene, 0, p, u, v);
}

static void hard_in_facets(hard_trial *t) { hard_add_level(&t->scene, 0, 0.5, 0, 0); }

static void hard_tangent_face(hard_trial *t) {
    hard_add_level(&t->scene, 0, 1, 0, 0);
    t->pieces = 1;
}

static void hard_tangent_corner(hard_trial *t) {
    hard_add_level(&t->scene, 0, 2, -1, -1); /* x + y + z = 3 */
    t->pieces = 1;
}

static void hard_tangent_edge(hard_trial *t) {
    hard_add_level(&t->scene, 0, 1.5, -1, 0); /* x + z = 2 */
    t->pieces = 1;
}

static void hard_three_in_a_line(hard_trial *t) {
    const double c[3] = {0.5625, 0.4375, 0.5}, n[3][3] = {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    int i;
    for (i = 0; i < 3; i++) hard_add_plane(&t->scene, (size_t)i, c, n[i]);
    t->pieces = 6;
}

static void hard_four_through_a_point(hard_trial *t) {
    const double c[3] = {0.4375, 0.5625, 0.53125}, n[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 2, 4}};
    int i;
    for (i = 0; i < 4; i++) hard_add_plane(&t->scene, (size_t)i, c, n[i]);
    t->pieces = 14;
}

static void hard_apart_1e15(hard_trial *t) {
    const double low = 0.3, high = 0.3 + 1e-15;
    hard_add_level(&t->scene, 0, low, 0, 0);
    hard_add_level(&t->scene, 1, high, 0, 0);
    t->pieces = 3;
    t->smallest = high - low;
}

static void hard_missing_by_a_rounding(hard_trial *t) {
    const double middle = 0.3, next = 0.3 + 5.6e-17; /* one unit in the last place */
    const double p[3] = {-1, -1, 0.4}, u[3] = {1 + middle, 0, 0}, q[3] = {next, -1, 0.4}, w[3] = {2, 0, 0},
                 v[3] = {0, 3, 0};
    hard_add_quad(&t->scene, 0, p, u, v);
    hard_add_quad(&t->scene, 1, q, w, v);
    t->scene.sever_below = 1e-9;
}

/* Three planes a unit in the last place beside the layers of nodes. Every node is kicked. */
static void hard_beside_nodes(hard_trial *t) {
    const double beside = nextafter(0.5, 1);
    uint32_t random = 1;
    size_t i;
    for (i = 0; i < 3; i++) {
        double c[3] = {0, 0, 0}, n[3] = {0, 0, 0};
        c[i] = beside;
        n[i] = 1;
        hard_add_plane(&t->scene, 0, c, n);
    }
    for (i = 0; i < 3 * t->scene.node_count; i++) {
        random = random * 1664525u + 1013904223u;
        t->scene.velocity[i] = 5 * ((random >> 8) / 8388608.0 - 1.0);
    }
    t->pieces = 8;
    t->held = 1;
}

static void hard_same_cut_twice(hard_trial *t) {
    hard_add_level(&t->scene, 0, 0.37, 0.1, 0.2);
    hard_add_level(&t->scene, 1, 0.37, 0.1, 0.2);
}

static void hard_slab(hard_trial *t, double thickness) {
    const double low[3] = {-1, -1, 0.375}, high[3] = {2, 2, 0.375 + thickness};
    hard_add_box(&t->scene, low, high);
    t->removed = high[2] - low[2];
}

static void hard_slab_1e12(hard_trial *t) { hard_slab(t, 1e-12); }
/* Below the cube's top; in the tetrahedron: at its base */
static void hard_slice(hard_trial *t, double thickness) {
    const double at = 1 - thickness;
    hard_add_level(&t->scene, 0, at, 0, 0);
    hard_add_region_level(t, thickness);
    t->smallest = 1 - at;
}

static void hard_slice_1e3(hard_trial *t) { hard_slice(t, 1e-3); }
static void hard_slice_1e8(hard_trial *t) { hard_slice(t, 1e-8); }
static void hard_slice_1e15(hard_trial *t) { hard_slice(t, 1e-15); }

/* x + y + z = 3 - 2 size. The far corner has a piece with edges of that length. `size` is a multiple of 2^-53. */
static void hard_corner(hard_trial *t, double size) {
    hard_add_level(&t->scene, 0, 2 - size, -1, -1);
    t->corner = size;
    t->smallest = size * size * size / 6;
}

static void hard_corner_1e9(hard_trial *t) { hard_corner(t, 1e-3); }
static void hard_corner_1e15(hard_trial *t) { hard_corner(t, 1e-5); }

/* A small closed tetrahedron inside an element: it meets no face, and no copy of the inner piece has support to
   speak of. */
static void hard_bubble(hard_trial *t) {
    static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const double size = 0.0078125;
    gx_surface *s = hard_add_cut(&t->scene, 0, GX_SURFACE_SHEET);
    int i;
    for (i = 0; i < 4; i++)
        hard_add_vertex(&t->scene, s, 0.25 + (i == 1) * size, 0.25 + (i == 2) * size, 0.25 + (i == 3) * size);
    for (i = 0; i < 4; i++) hard_add_triangle(&t->scene, s, faces[i][0], faces[i][1], faces[i][2]);
    t->smallest = size * size * size / 6;
}

static void hard_fold(hard_trial *t) {
    static const double at[4][2] = {{-0.2, 0.3}, {0.7, 0.35}, {0.4, 0.5}, {1.2, 0.55}};
    hard_add_strip(&t->scene, at, 4);
}

static void hard_self_crossing(hard_trial *t) {
    static const double at[5][2] = {{-0.2, 0.3}, {0.8, 0.35}, {0.6, 0.7}, {0.4, 0.1}, {1.2, 0.2}};
    hard_add_strip(&t->scene, at, 5);
    t->pieces = 3; /* above, below, and a loop */
}

static void hard_hole(hard_trial *t) {
    gx_surface *s = hard_add_cut(&t->scene, 0, GX_SURFACE_SHEET);
    uint32_t i;
    for (i = 0; i < 4; i++) hard_add_vertex(&t->scene, s, i == 1 || i == 2 ? 2 : -1, i >= 2 ? 2 : -1, 0.4);
    for (i = 0; i < 4; i++) hard_add_vertex(&t->scene, s, i == 1 || i == 2 ? 0.7 : 0.3, i >= 2 ? 0.7 : 0.3, 0.4);
    for (i = 0; i < 4; i++) {
        hard_add_triangle(&t->scene, s, i, (i + 1) % 4, 4 + (i + 1) % 4);
        hard_add_triangle(&t->scene, s, i, 4 + (i + 1) % 4, 4 + i);
    }
    t->pieces = 1;
}

/* A vertex in the middle of an edge of its neighbour */
static void hard_t_junction(hard_trial *t) {
    gx_surface *s = hard_add_cut(&t->scene, 0, GX_SURFACE_SHEET);
    hard_add_vertex(&t->scene, s, -1, -1, 0.375);
    hard_add_vertex(&t->scene, s, 2, -1, 0.375);
    hard_add_vertex(&t->scene, s, 2, 2, 0.375);
    hard_add_vertex(&t->scene, s, -1, 2, 0.375);
    hard_add_vertex(&t->scene, s, 0.5, 0.5, 0.375);
    hard_add_triangle(&t->scene, s, 0, 1, 2);
    hard_add_triangle(&t->scene, s, 0, 4, 3);
    hard_add_triangle(&t->scene, s, 4, 2, 3);
}

static void hard_ends_on_another(hard_trial *t) {
    const double p[3] = {0.5625, -1, 0.4375}, u[3] = {0, 3, 0}, v[3] = {0, 0, 2};
    hard_add_level(&t->scene, 0, 0.4375, 0, 0);
    hard_add_quad(&t->scene, 1, p, u, v);
    t->pieces = 3;
}

static void hard_duplicate_triangle(hard_trial *t) {
    gx_surface *s;
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    s = &t->scene.cuts[0].path;
    hard_add_triangle(&t->scene, s, 0, 1, 2);
}

static void hard_flat_triangle(hard_trial *t) {
    gx_surface *s;
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    s = &t->scene.cuts[0].path;
    hard_add_triangle(&t->scene, s, 0, 1, 1);
    hard_add_vertex(&t->scene, s, 0.5, 0.5, 0.4);
}

static void hard_open_end(hard_trial *t) {
    const double p[3] = {-1, -1, 0.4}, u[3] = {1.6, 0, 0.05}, v[3] = {0, 3, 0.03};
    hard_add_quad(&t->scene, 0, p, u, v);
    t->pieces = 1;
}

static void hard_thousand_parallel(hard_trial *t) {
    gx_surface *s = hard_add_cut(&t->scene, 0, GX_SURFACE_SHEET);
    uint32_t i;
    for (i = 0; i < 1000; i++) {
        const double z = (i + 0.5) / 1001;
        hard_add_vertex(&t->scene, s, -1, -1, z);
        hard_add_vertex(&t->scene, s, 3, -1, z);
        hard_add_vertex(&t->scene, s, -1, 3, z);
        hard_add_triangle(&t->scene, s, 3 * i, 3 * i + 1, 3 * i + 2);
        hard_add_region_level(t, z);
    }
    t->pieces = 1001;
    t->tolerance = 0.3;
}

/* Part of a corner of space: boxes between planes, those that reach into x + y + z < 1 */
static void hard_crossing_3_20(hard_trial *t) {
    double at[22];
    int i, j, k;
    for (i = 0; i < 20; i++) at[i + 1] = (i + 0.53) / 20.5;
    at[0] = 0;
    for (i = 0; i < 3; i++)
        for (j = 1; j <= 20; j++) {
            double c[3] = {0, 0, 0}, n[3] = {0, 0, 0};
            c[i] = at[j];
            n[i] = 1;
            hard_add_plane(&t->scene, 0, c, n);
        }
    t->pieces = 0;
    for (i = 0; i <= 20; i++)
        for (j = 0; j <= 20; j++)
            for (k = 0; k <= 20; k++) t->pieces += at[i] + at[j] + at[k] < 1;
    t->tolerance = 0.05;
}

static void hard_scale(hard_trial *t, const double factor[3], double offset) {
    size_t i, c;
    for (c = 0; c <= t->scene.cut_count; c++) {
        double *x = c < t->scene.cut_count ? (double *)(uintptr_t)t->scene.cuts[c].path.vertices : t->scene.positions;
        const size_t count = c < t->scene.cut_count ? t->scene.cuts[c].path.vertex_count : t->scene.node_count;
        for (i = 0; i < 3 * count; i++) x[i] = x[i] * factor[i % 3] + offset;
    }
    t->scene.thickness *= fmin(factor[0], fmin(factor[1], factor[2]));
}

static void hard_aspect_1e4(hard_trial *t) {
    const double factor[3] = {1, 1, 1e-4};
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    hard_scale(t, factor, 0);
}

static void hard_size_1e6(hard_trial *t) {
    const double factor[3] = {1e-6, 1e-6, 1e-6};
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    hard_scale(t, factor, 0);
}

static void hard_offset_1e8(hard_trial *t) {
    const double factor[3] = {1e6, 1e6, 1e6};
    hard_add_level(&t->scene, 0, 0.4, 0.125, 0.25);
    hard_scale(t, factor, 1e8);
}

static void hard_shaken(hard_trial *t) {
    uint32_t random = 1;
    size_t i;
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    for (i = 0; i < 3 * t->scene.node_count; i++) {
        random = random * 1664525u + 1013904223u;
        t->scene.displacement[i] = 0.5 * ((random >> 8) / 8388608.0 - 1.0);
    }
}

/* Turned inside out through its middle */
static void hard_inverted(hard_trial *t) {
    size_t i;
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    for (i = 0; i < 3 * t->scene.node_count; i++) t->scene.displacement[i] = 1 - 2 * t->scene.positions[i];
}

static void hard_collapsed(hard_trial *t) {
    size_t i;
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    for (i = 0; i < 3 * t->scene.node_count; i++) t->scene.displacement[i] = 0.5 - t->scene.positions[i];
}

static void hard_one_second(hard_trial *t) {
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    t->scene.dt = 1;
}

static void hard_incompressible(hard_trial *t) {
    hard_add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    t->scene.poisson = 0.4999;
}

/* The lower part hangs on the upper one by a bridge 1e-3 wide. */
static void hard_bridge(hard_trial *t) {
    const double p[3] = {-1, -1, 0.4}, u[3] = {1.3, 0, 0}, q[3] = {0.301, -1, 0.4}, w[3] = {2, 0, 0}, v[3] = {0, 3, 0};
    hard_add_quad(&t->scene, 0, p, u, v);
    hard_add_quad(&t->scene, 1, q, w, v);
    t->pieces = 1;
    t->held = 1;
}

/* One cell of the cube is cut free along its facets except for a strip of 1e-3 of the facet above it. */
static void hard_face_piece(hard_trial *t) {
    const double p[4][3] = {{-1, -1, 0.5}, {0.301, -1, 0.5}, {0.5, -1, -1}, {-1, 0.5, -1}};
    const double u[4][3] = {{1.3, 0, 0}, {0.199, 0, 0}, {0, 1.5, 0}, {1.5, 0, 0}},
                 v[4][3] = {{0, 1.5, 0}, {0, 1.5, 0}, {0, 0, 1.5}, {0, 0, 1.5}};
    int i;
    for (i = 0; i < 4; i++) hard_add_quad(&t->scene, 0, p[i], u[i], v[i]);
    t->pieces = 1;
    t->held = 1;
}

typedef struct hard_case {
    const char *name;
    void (*make)(hard_trial *t);
    int tetrahedron; /* 1: of one tetrahedron; 0: of the cube */
} hard_case;

/* clang-format off */
static const hard_case hard_cases[] = {
    {"through a node", hard_through_node, 0}, {"along an edge", hard_along_edge, 0}, {"in facets", hard_in_facets, 0},
    {"tangent to a face", hard_tangent_face, 0}, {"tangent to an edge", hard_tangent_edge, 0},
    {"tangent to a corner", hard_tangent_corner, 0}, {"three through a line", hard_three_in_a_line, 0},
    {"four through a point", hard_four_through_a_point, 0}, {"two 1e-15 apart", hard_apart_1e15, 0},
    {"two sheets miss by a rounding", hard_missing_by_a_rounding, 0},
    {"an ulp beside nodes and kicked", hard_beside_nodes, 0}, {"the same cut twice", hard_same_cut_twice, 0},
    {"solid 1e-12 thick", hard_slab_1e12, 0}, {"slice of 1e-3", hard_slice_1e3, 0}, {"slice of 1e-8", hard_slice_1e8, 0},
    {"slice of 1e-15", hard_slice_1e15, 0}, {"corner of 1e-9", hard_corner_1e9, 0}, {"corner of 1e-15", hard_corner_1e15, 0},
    {"piece inside an element", hard_bubble, 0}, {"fold", hard_fold, 0}, {"self-crossing", hard_self_crossing, 0}, {"hole", hard_hole, 0},
    {"T-junction", hard_t_junction, 0}, {"ends on another", hard_ends_on_another, 0}, {"duplicate triangle", hard_duplicate_triangle, 0},
    {"triangle without area", hard_flat_triangle, 0}, {"ends inside", hard_open_end, 0},
    {"1000 parallel in one element", hard_thousand_parallel, 1}, {"3 x 20 crossing in one element", hard_crossing_3_20, 1},
    {"aspect ratio 1e4", hard_aspect_1e4, 0}, {"size of 1e-6", hard_size_1e6, 0}, {"size of 1e6 at 1e8", hard_offset_1e8, 0},
    {"starts shaken by an edge length", hard_shaken, 0}, {"starts inside out", hard_inverted, 0},
    {"starts in one point", hard_collapsed, 0}, {"steps of 1 s", hard_one_second, 0}, {"Poisson's ratio 0.4999", hard_incompressible, 0},
    {"hangs by 1e-3", hard_bridge, 0}, {"a cell hangs by a face piece", hard_face_piece, 0}};
/* clang-format on */

enum { HARD_CASES = sizeof hard_cases / sizeof hard_cases[0] };

static void hard_trial_make(hard_trial *t, const hard_case *row) {
    const gx_region top = gx_region_half_space(2, 1, 0.999);
    size_t e, k;
    memset(t, 0, sizeof *t);
    t->scene.name = row->name;
    t->scene.young = 1e6;
    t->scene.poisson = 0.4;
    t->scene.density = 1000;
    t->scene.dt = 0.033;
    t->scene.gravity[2] = -9.81;
    t->scene.newton_iterations = 1;
    t->scene.regions = (gx_region *)replay_array(&t->scene, NULL, 1, sizeof(gx_region));
    t->scene.thickness = REPLAY_THICKNESS;
    t->pieces = 2;
    t->tolerance = 2e-3;
    if (row->tetrahedron)
        hard_make_tetrahedron(&t->scene);
    else
        hard_make_cube(&t->scene);
    t->scene.displacement = (double *)calloc(3 * t->scene.node_count, sizeof(double));
    t->scene.velocity = (double *)calloc(3 * t->scene.node_count, sizeof(double));
    method_must(t->scene.displacement && t->scene.velocity ? GX_OK : GX_ERROR_MEMORY, "bench");
    row->make(t);
    t->scene.regions[0] = top;
    t->scene.region_count = t->held ? 1 : 0;
    for (e = 0; e < t->scene.element_count; e++) {
        double x[12];
        for (k = 0; k < 4; k++)
            memcpy(x + 3 * k, t->scene.positions + 3 * (size_t)t->scene.elements[4 * e + k], 3 * sizeof(double));
        t->volume += gxi_tet_volume(x);
    }
}

static void hard_trial_free(hard_trial *t) {
    free(t->levels);
    replay_free(&t->scene);
}

/* ---- judgement ---- */

static uint32_t hard_root_of(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Pieces: sets of parts that share copies, by the copy that stands for each */
typedef struct hard_pieces {
    gxs_model model;
    uint32_t *of;         /* copy_count: the copy that stands for its piece */
    uint8_t *used;        /* copy_count */
    double *volume;       /* copy_count, at those that stand for a piece, m3 */
    double *mass, *moved; /* kg; mass times displacement along z, less that at the start */
    size_t count;
    double total, smallest; /* volumes */
} hard_pieces;

static void hard_pieces_free(hard_pieces *p) {
    free(p->of);
    free(p->used);
    free(p->volume);
    free(p->mass);
    free(p->moved);
}

static double *hard_zeros(size_t count) {
    double *x = (double *)calloc(count + 1, sizeof(double));
    method_must(x ? GX_OK : GX_ERROR_MEMORY, "bench");
    return x;
}

/* The displacement along z with which the node at the place started */
static double hard_start_of(const hard_trial *t, const double *place) {
    size_t i;
    for (i = 0; i < t->scene.node_count; i++)
        if (memcmp(t->scene.positions + 3 * i, place, 3 * sizeof(double)) == 0) return t->scene.displacement[3 * i + 2];
    return 0;
}

static void hard_add_part(const hard_trial *t, hard_pieces *p, const gxs_element *element, const double *u) {
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    const uint32_t piece = p->of[element->copy[0]];
    int i, j;
    p->volume[piece] += element->weight;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++) {
            const uint32_t copy = element->copy[i];
            p->mass[piece] += element->mass[row[i][j]];
            p->moved[piece] += element->mass[row[i][j]] *
                               (u[3 * (size_t)copy + 2] - hard_start_of(t, p->model.positions + 3 * (size_t)copy));
        }
}

static hard_pieces hard_pieces_of(const hard_trial *t, const gxs_model *m, const double *u) {
    const size_t n = m->copy_count;
    hard_pieces p;
    size_t e;
    uint32_t i;
    int k;
    memset(&p, 0, sizeof p);
    p.model = *m;
    p.of = (uint32_t *)method_memory(NULL, n, sizeof *p.of);
    p.used = (uint8_t *)method_memory(NULL, n, 1);
    p.volume = hard_zeros(n);
    p.mass = hard_zeros(n);
    p.moved = hard_zeros(n);
    memset(p.used, 0, n);
    for (i = 0; i < n; i++) p.of[i] = i;
    for (e = 0; e < m->element_count; e++)
        for (k = 0; k < 4; k++) {
            p.used[m->elements[e].copy[k]] = 1;
            p.of[hard_root_of(p.of, m->elements[e].copy[k])] = hard_root_of(p.of, m->elements[e].copy[0]);
        }
    for (i = 0; i < n; i++) p.of[i] = hard_root_of(p.of, i);
    for (e = 0; e < m->element_count; e++) hard_add_part(t, &p, &m->elements[e], u);
    p.smallest = HUGE_VAL;
    for (i = 0; i < n; i++) {
        if (!p.used[i] || p.of[i] != i) continue;
        p.count++;
        p.total += p.volume[i];
        p.smallest = fmin(p.smallest, p.volume[i]);
    }
    return p;
}

/* Of a point, by backward Euler: after n steps from rest it has fallen n (n + 1) / 2 dt^2 g. */
static double hard_fall_of(const hard_trial *t) {
    return 0.5 * HARD_STEPS * (HARD_STEPS + 1) * t->scene.dt * t->scene.dt * t->scene.gravity[2];
}

/* The largest distance of a piece with mass from where a point would have fallen, as a share of the fall */
static double hard_fall_error(const hard_trial *t, const hard_pieces *p) {
    const double fall = hard_fall_of(t);
    double worst = 0;
    size_t i;
    for (i = 0; i < p->model.copy_count; i++)
        if (p->used[i] && p->of[i] == i && p->mass[i] > 0)
            worst = fmax(worst, fabs(p->moved[i] / p->mass[i] / fall - 1));
    return worst;
}

static int hard_flies_apart(const hard_trial *t, const hard_pieces *p, const double *u) {
    double most = 4 + 2 * fabs(hard_fall_of(t));
    size_t i;
    for (i = 0; i < 3 * t->scene.node_count; i++)
        most = fmax(most, 4 * fabs(t->scene.positions[i]) * (fabs(t->scene.displacement[i]) > 0));
    for (i = 0; i < 3 * p->model.copy_count; i++)
        if (!(fabs(u[i]) < 10 * most)) return 1;
    return 0;
}

/* Share of the expected */
static double hard_smallest_error(const hard_trial *t, const hard_pieces *p) {
    return t->smallest > 0 ? p->smallest / t->smallest - 1 : 0;
}

static void hard_judge_pieces(const hard_trial *t, const hard_pieces *p, const double *u, char text[HARD_TEXT]) {
    const double volume = (p->total + t->removed - t->volume) / t->volume, small = hard_smallest_error(t, p);
    const double fall = t->held ? 0 : hard_fall_error(t, p);
    if (hard_flies_apart(t, p, u))
        snprintf(text, HARD_TEXT, "diverged: flies apart");
    else if (p->count != t->pieces)
        snprintf(text, HARD_TEXT, "wrong: %lu of %lu pieces", (unsigned long)p->count, (unsigned long)t->pieces);
    else if (fabs(volume) > t->tolerance)
        snprintf(text, HARD_TEXT, "wrong: volume %+.0f %%", 100 * volume);
    else if (fabs(small) > 0.5)
        snprintf(text, HARD_TEXT, "wrong: smallest piece %+.0f %%", 100 * small);
    else if (fall > 0.01)
        snprintf(text, HARD_TEXT, "wrong: falls %.0f %% off", 100 * fall);
    else
        snprintf(text, HARD_TEXT, "right%s", fabs(volume) > 1e-9 || fabs(small) > 0.01 ? " but for volume" : "");
}

/* Cuts and steps. The outcome in one line */
static void hard_judge(const hard_trial *t, const method *m, char text[HARD_TEXT]) {
    void *state = m->create(&t->scene);
    const char *cut_fails = NULL, *step_fails = NULL;
    size_t frame, next = 0;
    for (frame = 0; frame < HARD_STEPS && !cut_fails && !step_fails; frame++) {
        method_times times;
        memset(&times, 0, sizeof times);
        for (; next < t->scene.cut_count && t->scene.cuts[next].frame == frame && !cut_fails; next++)
            cut_fails = m->cut(state, &t->scene.cuts[next], &times);
        if (!cut_fails) step_fails = m->step(state, &times);
    }
    if (cut_fails)
        snprintf(text, HARD_TEXT, "refused: %s", cut_fails);
    else if (step_fails)
        snprintf(text, HARD_TEXT, "diverged: %s", step_fails);
    else {
        gxs_model model;
        const double *u;
        hard_pieces p;
        m->look(state, &model, &u);
        p = hard_pieces_of(t, &model, u);
        hard_judge_pieces(t, &p, u, text);
        hard_pieces_free(&p);
    }
    m->destroy(state);
}

/* ---- integrals ---- */

/* Volume of the unit tetrahedron's part under a plane: z = at, or x + y + z = at. Negative: it cannot be had. */
typedef double (*hard_integral_fn)(const double vertices[9]);

static void hard_region_plane(double at, int across, double vertices[9]) {
    static const double level[9] = {-4, -4, 0, 8, -4, 0, -4, 8, 0}, corner_plane[9] = {-3, -3, 6, 6, -3, -3, -3, 6, -3};
    int i;
    for (i = 0; i < 9; i++) vertices[i] = across ? corner_plane[i] : level[i];
    for (i = 2; i < 9; i += 3) vertices[i] += at;
}

static double hard_sum_of(const sampling_rule *rule) {
    double sum = 0;
    size_t i;
    for (i = 0; i < rule->count; i++) sum += rule->points[4 * i + 3];
    return sum;
}

static const uint32_t hard_region_triangle[3] = {0, 1, 2};

/* By points: adaptive to a depth; depth 0: 50 cells along an edge */
static double hard_integral_by_points(const double vertices[9], int depth) {
    sampling_surface surface = sampling_surface_create(vertices, hard_region_triangle, 1);
    const sampling_region under = sampling_under(&surface);
    sampling_rule rule;
    double volume;
    memset(&rule, 0, sizeof rule);
    if (depth > 0)
        sampling_adaptive(&under, 2, depth, &rule);
    else
        sampling_regular(&under, 50, &rule);
    volume = hard_sum_of(&rule);
    sampling_free(&rule);
    sampling_surface_free(&surface);
    return volume;
}

static double hard_integral_regular(const double vertices[9]) { return hard_integral_by_points(vertices, 0); }
static double hard_integral_adaptive(const double vertices[9]) { return hard_integral_by_points(vertices, 4); }

/* The part's boundary as a surface of its own; the caller frees index. */
static gxi_surface hard_boundary_surface(const part_shape *boundary, uint32_t **index) {
    gxi_surface surface;
    uint32_t i;
    *index = (uint32_t *)dense_memory(NULL, 3 * boundary->count, sizeof(uint32_t));
    for (i = 0; i < 3 * boundary->count; i++) (*index)[i] = i;
    surface.positions = boundary->corners;
    surface.position_count = 3 * boundary->count;
    surface.triangles = *index;
    surface.triangle_count = boundary->count;
    return surface;
}

static double hard_integral_positive(const double vertices[9]) {
    static const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    double moments[SAMPLING_MONOMIALS], work[SAMPLING_MONOMIALS], volume;
    part p = part_create(corners, vertices, hard_region_triangle, 1, 0);
    part_shape inside = part_tetrahedra(&p), boundary = part_boundary(&p);
    uint32_t *index;
    const gxi_surface surface = hard_boundary_surface(&boundary, &index);
    sampling_rule rule;
    memset(&rule, 0, sizeof rule);
    method_must(gxi_polyhedron_monomials(&surface, NULL, 2, moments, work, NULL), "moments");
    sampling_positive(inside.corners, inside.count, 2, moments, &rule);
    volume = hard_sum_of(&rule);
    sampling_free(&rule);
    part_free(&p);
    free(index);
    free(inside.corners);
    free(boundary.corners);
    return volume;
}

typedef struct hard_integral_method {
    const char *name;
    hard_integral_fn volume;
} hard_integral_method;

static const hard_integral_method hard_integral_methods[] = {{"positive rule", hard_integral_positive},
                                                             {"adaptive to depth 4", hard_integral_adaptive},
                                                             {"regular 50^3", hard_integral_regular}};

enum { HARD_INTEGRALS = sizeof hard_integral_methods / sizeof hard_integral_methods[0] };

/* Of the unit tetrahedron's part from z = low to z = high: without cancellation */
static double hard_volume_between(double low, double high) {
    const double a = 1 - low, b = 1 - high;
    return (high - low) * (a * a + a * b + b * b) / 6;
}

/* The part under the corner's plane, or those between a level and the one before it; otherwise as hard_judge. It
   gives nothing if the case is not about integrals. */
static void hard_integral_judge(const hard_trial *t, const hard_integral_method *m, char text[HARD_TEXT]) {
    const size_t count = t->corner > 0 ? 1 : t->level_count;
    double vertices[9], below = 0, from = 0, worst = 0;
    size_t i, lost = 0;
    text[0] = 0;
    for (i = 0; i < count; i++) {
        const double at = t->corner > 0 ? t->corner : t->levels[i],
                     truth = t->corner > 0 ? at * at * at / 6 : hard_volume_between(from, at);
        double volume, off;
        hard_region_plane(at, t->corner > 0, vertices);
        volume = m->volume(vertices);
        off = (volume - below) / truth - 1;
        lost += volume <= below;
        if (fabs(off) > fabs(worst)) worst = off;
        below = volume;
        from = at;
    }
    if (lost > 0)
        snprintf(text, HARD_TEXT, "wrong: no volume in %lu of %lu", (unsigned long)lost, (unsigned long)count);
    else if (fabs(worst) > 0.5)
        snprintf(text, HARD_TEXT, "wrong: a piece %+.0f %%", 100 * worst);
    else if (count > 0)
        snprintf(text, HARD_TEXT, "right%s", fabs(worst) > 0.01 ? " but for volume" : "");
}

#endif
