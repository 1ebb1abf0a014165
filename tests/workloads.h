/* workloads.h - meshes, cut surfaces and the named workloads of the tests, all generated.

   A workload is a mesh of tetrahedra and the surfaces that cut it. The numbers below are its defining parameters.
       W1   rotated tetrahedron with unit edges, a slab through it
       W2   the 24 tetrahedra around a node, a slab; W2f: 32 tetrahedra
       W3   the tetrahedron, a wavy sheet of 800 triangles made solid (1760 triangles)
       W4   cube of 5 tetrahedra, 5 + 5 crossing slabs; W4r: the same, rotated
       D*   slabs in a facet, through corners, between two ulps
       P*   a slab that ends inside, 1e-4 ... 1e-15 thick
       T*   a slab through, 1e-8 ... 1e-15 thick
       C*   a corner of size 1e-3 ... 1e-14 cut off */
#ifndef GXFEM_TESTS_WORKLOADS_H
#define GXFEM_TESTS_WORKLOADS_H

#include "oracle.h"

enum { WL_SURFACES = 32 };

typedef struct wl_surface {
    /* x 3 */
    double *vertices;
    size_t vertex_count;
    /* x 3 */
    uint32_t *triangles;
    size_t triangle_count;
    int solid; /* as of oracle_surface */
} wl_surface;

typedef struct workload {
    /* x 3 */
    double *positions;
    size_t node_count;
    /* x 4 */
    uint32_t *elements;
    size_t element_count;
    wl_surface surfaces[WL_SURFACES];
    size_t surface_count;
} workload;

typedef struct wl_frame { /* x -> origin + x0 u + x1 v + x2 w */
    double origin[3], u[3], v[3], w[3];
} wl_frame;

static inline workload wl_empty(void) {
    workload w;
    memset(&w, 0, sizeof w);
    return w;
}

static inline void wl_free(workload *w) {
    size_t i;
    for (i = 0; i < w->surface_count; i++) {
        free(w->surfaces[i].vertices);
        free(w->surfaces[i].triangles);
    }
    free(w->positions);
    free(w->elements);
    *w = wl_empty();
}

/* ---- meshes ---- */

static inline uint32_t wl_add_node(workload *w, double x, double y, double z) {
    double *p;
    w->positions = (double *)oracle_grow(w->positions, w->node_count, 3 * sizeof(double));
    p = w->positions + 3 * w->node_count;
    p[0] = x;
    p[1] = y;
    p[2] = z;
    return (uint32_t)w->node_count++;
}

/* Turned so that its volume is positive. */
static inline void wl_add_element(workload *w, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const double *x = w->positions;
    rat_mark mark = rat_arena_mark();
    int positive = big_sign(big_orient3d(x + 3 * a, x + 3 * b, x + 3 * c, x + 3 * d)) > 0;
    uint32_t *n;
    rat_arena_release(mark);
    w->elements = (uint32_t *)oracle_grow(w->elements, w->element_count, 4 * sizeof(uint32_t));
    n = w->elements + 4 * w->element_count++;
    n[0] = a;
    n[1] = positive ? b : c;
    n[2] = positive ? c : b;
    n[3] = d;
}

static inline void wl_place(const wl_frame *f, const double x[3], double result[3]) {
    int k;
    for (k = 0; k < 3; k++) result[k] = f->origin[k] + x[0] * f->u[k] + x[1] * f->v[k] + x[2] * f->w[k];
}

static inline wl_frame wl_axes(void) {
    wl_frame f = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return f;
}

/* A corner of cube (i, j, k) of the lattice; bit 0, 1, 2 of corner: step along axis 0, 1, 2 */
static inline uint32_t wl_corner(const size_t size[3], size_t i, size_t j, size_t k, unsigned corner) {
    i += corner & 1;
    j += corner >> 1 & 1;
    k += corner >> 2 & 1;
    return (uint32_t)(i + (size[0] + 1) * (j + (size[1] + 1) * k));
}

/* Unit cubes of five tets: one in the middle, four at corners; every other cube is mirrored, so that diagonals meet. */
static inline void wl_add_five(workload *w, const size_t size[3], size_t i, size_t j, size_t k) {
    static const unsigned tets[5][4] = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
    unsigned flip = (i + j + k) % 2 ? 7 : 0;
    int t;
    for (t = 0; t < 5; t++)
        wl_add_element(w, wl_corner(size, i, j, k, tets[t][0] ^ flip), wl_corner(size, i, j, k, tets[t][1] ^ flip),
                       wl_corner(size, i, j, k, tets[t][2] ^ flip), wl_corner(size, i, j, k, tets[t][3] ^ flip));
}

/* Unit cubes of six tets around the diagonal from corner 0 to corner 7 */
static inline void wl_add_six(workload *w, const size_t size[3], size_t i, size_t j, size_t k) {
    static const unsigned paths[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
    int t;
    for (t = 0; t < 6; t++)
        wl_add_element(w, wl_corner(size, i, j, k, 0), wl_corner(size, i, j, k, paths[t][0]),
                       wl_corner(size, i, j, k, paths[t][1]), wl_corner(size, i, j, k, 7));
}

static inline workload wl_grid(size_t nx, size_t ny, size_t nz, int tets, const wl_frame *frame) {
    workload w = wl_empty();
    size_t size[3], i, j, k;
    double x[3], y[3];
    size[0] = nx;
    size[1] = ny;
    size[2] = nz;
    for (k = 0; k <= nz; k++)
        for (j = 0; j <= ny; j++)
            for (i = 0; i <= nx; i++) {
                x[0] = (double)i;
                x[1] = (double)j;
                x[2] = (double)k;
                wl_place(frame, x, y);
                wl_add_node(&w, y[0], y[1], y[2]);
            }
    for (k = 0; k < nz; k++)
        for (j = 0; j < ny; j++)
            for (i = 0; i < nx; i++)
                if (tets == 5)
                    wl_add_five(&w, size, i, j, k);
                else
                    wl_add_six(&w, size, i, j, k);
    return w;
}

/* The elements around one node, nodes renumbered */
static inline workload wl_ring(const workload *grid, uint32_t node) {
    workload w = wl_empty();
    uint32_t *number = (uint32_t *)oracle_memory(NULL, grid->node_count, sizeof *number), n[4];
    size_t e;
    int k;
    for (e = 0; e < grid->node_count; e++) number[e] = UINT32_MAX;
    for (e = 0; e < grid->element_count; e++) {
        const uint32_t *a = grid->elements + 4 * e;
        if (a[0] != node && a[1] != node && a[2] != node && a[3] != node) continue;
        for (k = 0; k < 4; k++) {
            const double *x = grid->positions + 3 * a[k];
            if (number[a[k]] == UINT32_MAX) number[a[k]] = wl_add_node(&w, x[0], x[1], x[2]);
            n[k] = number[a[k]];
        }
        wl_add_element(&w, n[0], n[1], n[2], n[3]);
    }
    free(number);
    return w;
}

static inline workload wl_tetrahedron(const double x[4][3]) {
    workload w = wl_empty();
    int k;
    for (k = 0; k < 4; k++) wl_add_node(&w, x[k][0], x[k][1], x[k][2]);
    wl_add_element(&w, 0, 1, 2, 3);
    return w;
}

/* ---- surfaces ---- */

static inline wl_surface *wl_add_surface(workload *w, int solid) {
    wl_surface *s;
    if (w->surface_count == WL_SURFACES) rat_stop("workload: too many surfaces");
    s = &w->surfaces[w->surface_count++];
    memset(s, 0, sizeof *s);
    s->solid = solid;
    return s;
}

static inline uint32_t wl_add_vertex(wl_surface *s, const double x[3]) {
    s->vertices = (double *)oracle_grow(s->vertices, s->vertex_count, 3 * sizeof(double));
    memcpy(s->vertices + 3 * s->vertex_count, x, 3 * sizeof(double));
    return (uint32_t)s->vertex_count++;
}

static inline void wl_add_triangle(wl_surface *s, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *t;
    s->triangles = (uint32_t *)oracle_grow(s->triangles, s->triangle_count, 3 * sizeof(uint32_t));
    t = s->triangles + 3 * s->triangle_count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* A quadrilateral as two triangles that share the diagonal from a to c */
static inline void wl_add_quad(wl_surface *s, const double a[3], const double b[3], const double c[3],
                               const double d[3]) {
    uint32_t i = wl_add_vertex(s, a), j = wl_add_vertex(s, b), k = wl_add_vertex(s, c), l = wl_add_vertex(s, d);
    wl_add_triangle(s, i, j, k);
    wl_add_triangle(s, i, k, l);
}

/* The box |x0|, |x1|, |x2| <= half of a frame: twelve triangles, corners 0-3 below (counter-clockwise seen from above),
 * 4-7 above */
static inline void wl_add_box(wl_surface *s, const wl_frame *frame, double half0, double half1, double half2) {
    static const int corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                     {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
    static const uint32_t triangle[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                             {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    uint32_t first = (uint32_t)s->vertex_count;
    double x[3], y[3];
    int i;
    for (i = 0; i < 8; i++) {
        x[0] = corner[i][0] * half0;
        x[1] = corner[i][1] * half1;
        x[2] = corner[i][2] * half2;
        wl_place(frame, x, y);
        wl_add_vertex(s, y);
    }
    for (i = 0; i < 12; i++) wl_add_triangle(s, first + triangle[i][0], first + triangle[i][1], first + triangle[i][2]);
}

/* The box low <= x <= high, its coordinates exactly those */
static inline void wl_add_aligned_box(wl_surface *s, const double low[3], const double high[3]) {
    wl_frame axes = wl_axes();
    uint32_t first = (uint32_t)s->vertex_count;
    size_t i;
    int k;
    wl_add_box(s, &axes, 1, 1, 1);
    for (i = first; i < s->vertex_count; i++)
        for (k = 0; k < 3; k++) s->vertices[3 * i + (size_t)k] = s->vertices[3 * i + (size_t)k] < 0 ? low[k] : high[k];
}

/* Height of the wavy sheet above its plane */
static inline double wl_wave(double x, double y) {
    return 0.06 * sin(9.1 * x + 0.4) + 0.05 * cos(7.7 * y - 0.3) + 0.02 * sin(5.3 * (x + y));
}

/* n x n squares of two triangles over [-half, half]^2 of a frame */
static inline void wl_add_wave(wl_surface *s, const wl_frame *frame, uint32_t n, double half) {
    uint32_t i, j;
    double x[3], y[3];
    for (j = 0; j <= n; j++)
        for (i = 0; i <= n; i++) {
            x[0] = half * (2.0 * i / n - 1);
            x[1] = half * (2.0 * j / n - 1);
            x[2] = wl_wave(x[0], x[1]);
            wl_place(frame, x, y);
            wl_add_vertex(s, y);
        }
    for (j = 0; j < n; j++)
        for (i = 0; i < n; i++) {
            uint32_t a = i + (n + 1) * j, b = a + 1, c = a + n + 2, d = a + n + 1;
            wl_add_triangle(s, a, b, c);
            wl_add_triangle(s, a, c, d);
        }
}

/* Unit vertex normals: the triangles' area vectors, summed */
static inline double *wl_normals(const wl_surface *s) {
    double *normal = (double *)oracle_memory(NULL, 3 * s->vertex_count, sizeof *normal);
    size_t t, i;
    int k;
    for (i = 0; i < 3 * s->vertex_count; i++) normal[i] = 0;
    for (t = 0; t < s->triangle_count; t++) {
        const uint32_t *n = s->triangles + 3 * t;
        const double *a = s->vertices + 3 * n[0], *b = s->vertices + 3 * n[1], *c = s->vertices + 3 * n[2];
        for (k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            double area = (b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]);
            for (i = 0; i < 3; i++) normal[3 * n[i] + (uint32_t)k] += area;
        }
    }
    for (i = 0; i < s->vertex_count; i++) {
        double *n = normal + 3 * i, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (k = 0; k < 3; k++) n[k] /= length;
    }
    return normal;
}

static inline int wl_has_edge(const wl_surface *s, size_t triangles, uint32_t a, uint32_t b) {
    size_t t;
    int k;
    for (t = 0; t < triangles; t++)
        for (k = 0; k < 3; k++)
            if (s->triangles[3 * t + (size_t)k] == a && s->triangles[3 * t + (size_t)(k + 1) % 3] == b) return 1;
    return 0;
}

/* Makes a sheet solid: moved by thickness / 2 to both sides along its normals, the rim closed. */
static inline void wl_solidify(wl_surface *s, double thickness) {
    size_t vertices = s->vertex_count, triangles = s->triangle_count, i;
    double *normal = wl_normals(s), x[3];
    int k;
    for (i = 0; i < vertices; i++) {
        for (k = 0; k < 3; k++) x[k] = s->vertices[3 * i + (size_t)k] + thickness / 2 * normal[3 * i + (size_t)k];
        wl_add_vertex(s, x);
        for (k = 0; k < 3; k++) s->vertices[3 * i + (size_t)k] -= thickness / 2 * normal[3 * i + (size_t)k];
    }
    for (i = 0; i < triangles; i++) {
        uint32_t n[3], up = (uint32_t)vertices;
        memcpy(n, s->triangles + 3 * i, sizeof n);
        wl_add_triangle(s, up + n[0], up + n[1], up + n[2]);
        for (k = 0; k < 3; k++) {
            uint32_t a = n[k], b = n[(k + 1) % 3];
            if (wl_has_edge(s, triangles, b, a)) continue;
            wl_add_triangle(s, a, b, up + b);
            wl_add_triangle(s, a, up + b, up + a);
        }
    }
    for (i = 0; i < triangles; i++) { /* the lower side faces down */
        uint32_t *n = s->triangles + 3 * i, b = n[1];
        n[1] = n[2];
        n[2] = b;
    }
    s->solid = 1;
    free(normal);
}

/* ---- the named workloads ---- */

/* Edges of length 1, centre (0.137, 0.291, 0.411) */
/* clang-format off */
static const double wl_unit_tetrahedron[4][3] = {
    { 0.64786552220043225, 0.62086559042189648, 0.48314645162787434 },
    { -0.0042362341859477348, 0.26094956773026806, -0.18410444265975229 },
    { -0.32236503929088078, 0.55662888096509877, 0.71665512963880862 },
    { 0.22673575127639625, -0.27444403911726339, 0.62830286139306923 } };
/* clang-format on */

static const double wl_corner_tetrahedron[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/* The frame of W1, P and T */
static inline wl_frame wl_slab_frame(double x, double y, double z) {
    wl_frame f = {{0, 0, 0},
                  {-0.70571947429741855, -0.53398657311357711, 0.46563758797136795},
                  {0.58049767698491084, -0.81259523158098901, -0.052071456931421685},
                  {0.40618034247425208, 0.23355369692268883, 0.88344224488149058}};
    f.origin[0] = x;
    f.origin[1] = y;
    f.origin[2] = z;
    return f;
}

/* T: through, 4.2 x 3.8 x thickness; W1 is T with 1e-4 */
static inline workload wl_through(double thickness) {
    workload w = wl_tetrahedron(wl_unit_tetrahedron);
    wl_frame f = wl_slab_frame(0.15, 0.27, 0.428);
    wl_add_box(wl_add_surface(&w, 1), &f, 2.1, 1.9, thickness / 2);
    return w;
}

/* P: 1 x 3.8 x thickness, ends inside */
static inline workload wl_partial(double thickness) {
    workload w = wl_tetrahedron(wl_unit_tetrahedron);
    wl_frame f = wl_slab_frame(0.65, 0.27, 0.194);
    wl_add_box(wl_add_surface(&w, 1), &f, 0.5, 1.9, thickness / 2);
    return w;
}

/* C: across the line from corner 0 to the middle of the opposite face, `size` away from the corner, a tenth of that
   thick */
static inline workload wl_corner_cut(double size) {
    workload w = wl_tetrahedron(wl_unit_tetrahedron);
    wl_frame f = {{0, 0, 0},
                  {-0.34784311850643829, 0.67989984790028424, -0.64555508032458875},
                  {0.42784219853359684, -0.49756678899099221, -0.75457162923551002},
                  {-0.83423990438101856, -0.53866825349037, -0.1178146621604512}};
    int k;
    for (k = 0; k < 3; k++) f.origin[k] = wl_unit_tetrahedron[0][k] + size * f.w[k];
    wl_add_box(wl_add_surface(&w, 1), &f, 2.1, 1.9, size / 20);
    return w;
}

/* W2 (tets = 6): 24 elements around a node. W2f (tets = 5): 32. */
static inline workload wl_ring_cut(int tets) {
    static const wl_frame body = {{0, 0, 0},
                                  {0.53290725853969334, 0.76809651690135483, 0.35501773831699607},
                                  {0.018396932754306039, -0.42997447333051564, 0.90265359089153319},
                                  {0.84597364418812837, -0.4744994130746133, -0.24326713779486442}};
    static const wl_frame slab = {{0.241, -0.113, 0.327},
                                  {-0.58430671718606542, -0.80770608577949887, 0.078718099862763832},
                                  {0.63131898977400003, -0.5133576739740342, -0.58129186449038261},
                                  {0.50992351720820003, -0.28995650978504999, 0.80987852733067}};
    static const double center[3] = {0.21, -0.13, 0.37}, middle[3] = {2, 1, 1};
    wl_frame f = body;
    workload grid, w;
    double x[3];
    int k;
    wl_place(&f, middle, x);
    for (k = 0; k < 3; k++) f.origin[k] = center[k] - x[k];
    grid = wl_grid(3, 2, 2, tets, &f);
    /* node (2, 1, 1): in the lattice of fives, four tets of each cube around it meet here */
    w = wl_ring(&grid, 18);
    wl_free(&grid);
    wl_add_box(wl_add_surface(&w, 1), &slab, 5.3, 4.9, 0.5e-4);
    return w;
}

/* W3: the sheet is 1.66 x 1.66, 1e-3 thick when solid */
static inline workload wl_wavy(int solid) {
    static const wl_frame f = {{0.148, 0.298, 0.398},
                               {0.75278436, 0.6578863, -0.0001333},
                               {-0.59643, 0.682601, 0.4216083},
                               {0.27760544822042, -0.31746769283768, 0.90672458835231}};
    workload w = wl_tetrahedron(wl_unit_tetrahedron);
    wl_surface *s = wl_add_surface(&w, 0);
    wl_add_wave(s, &f, 20, 0.83);
    if (solid) wl_solidify(s, 1e-3);
    return w;
}

/* W4: slabs of thickness 1e-3 across axis 0, then across axis 1 of the unit cube, in a frame (W4r: a rotated one) */
static inline workload wl_sticks(const wl_frame *frame) {
    static const double middle[2][5] = {{0.1542, 0.3416, 0.5028, 0.6796, 0.8418},
                                        {0.1716, 0.3294, 0.5182, 0.6648, 0.8334}};
    workload w = wl_grid(1, 1, 1, 5, frame);
    int a, i;
    size_t k;
    for (a = 0; a < 2; a++)
        for (i = 0; i < 5; i++) {
            wl_surface *s = wl_add_surface(&w, 1);
            double low[3] = {-0.2, -0.2, -0.2}, high[3] = {1.2, 1.2, 1.2};
            for (k = 0; k < 3; k++) {
                low[k] -= 0.013 * i;
                high[k] += 0.013 * i;
            }
            low[a] = middle[a][i] - 0.0005;
            high[a] = middle[a][i] + 0.0005;
            wl_add_aligned_box(s, low, high);
            for (k = 0; k < s->vertex_count; k++) {
                double x[3];
                memcpy(x, s->vertices + 3 * k, sizeof x);
                wl_place(frame, x, s->vertices + 3 * k);
            }
        }
    return w;
}

static inline wl_frame wl_rotated(void) {
    wl_frame f = {{0.17, 0.23, -0.41},
                  {0.47523587899288111, -0.25733487792712967, -0.84138553583960118},
                  {0.45209269603286439, 0.89180121216348063, -0.017400924615736224},
                  {0.75482650557038566, -0.37211471159573328, 0.54015515169479278}};
    return f;
}

/* D1: z in [0, 2^-13], its lower side in a facet. D1b: just below it; nothing is removed. */
static inline workload wl_facet_slab(int below) {
    workload w = wl_tetrahedron(wl_corner_tetrahedron);
    double low[3] = {-1.1, -1.2, 0}, high[3] = {2.1, 2.3, 0.0001220703125};
    if (below) {
        low[2] = -high[2];
        high[2] = 0;
    }
    wl_add_aligned_box(wl_add_surface(&w, 1), low, high);
    return w;
}

/* D1c: a prism with one side in the oblique facet x + y + z = 1 and the other 2^-13 further in along each axis */
static inline workload wl_oblique_slab(void) {
    static const double top[3][3] = {{4, -2, -1}, {-2, 4, -1}, {-2, -2, 5}};
    static const uint32_t triangle[8][3] = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                            {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
    workload w = wl_tetrahedron(wl_corner_tetrahedron);
    wl_surface *s = wl_add_surface(&w, 1);
    double x[3];
    int i, k;
    for (i = 0; i < 3; i++) {
        for (k = 0; k < 3; k++) x[k] = top[i][k] - 0.0001220703125;
        wl_add_vertex(s, x);
    }
    for (i = 0; i < 3; i++) wl_add_vertex(s, top[i]);
    for (i = 0; i < 8; i++) wl_add_triangle(s, triangle[i][0], triangle[i][1], triangle[i][2]);
    return w;
}

/* D2: one side is the plane x = y, through two corners of the tetrahedron */
static inline workload wl_corner_slab(void) {
    workload w = wl_tetrahedron(wl_corner_tetrahedron);
    wl_surface *s = wl_add_surface(&w, 1);
    wl_frame axes = wl_axes();
    double h = 0.0001220703125;
    size_t i;
    static const double below[4][3] = {{-2, -2, -2}, {2, 2, -2}, {2, 2, 2}, {-2, -2, 2}};
    wl_add_box(s, &axes, 1, 1, 1);
    for (i = 0; i < 8; i++) {
        memcpy(s->vertices + 3 * i, below[i % 4], 3 * sizeof(double));
        if (i >= 4) {
            s->vertices[3 * i] += h;
            s->vertices[3 * i + 1] -= h;
        }
    }
    return w;
}

/* Two elements of the 5-tet cube that share a face */
static inline workload wl_pair(void) {
    workload w = wl_empty();
    wl_add_node(&w, 0, 0, 0);
    wl_add_node(&w, 0, 1, 1);
    wl_add_node(&w, 1, 1, 0);
    wl_add_node(&w, 1, 0, 1);
    wl_add_node(&w, 1, 0, 0);
    wl_add_element(&w, 0, 1, 2, 3);
    wl_add_element(&w, 4, 0, 2, 3);
    return w;
}

/* D3: x in [0.4375, 0.437500000000001]. D3g: a slab in general position, 1e-15 thick. */
static inline workload wl_ulp_slab(int general) {
    static const wl_frame f = {{0.47, 0.43, 0.52},
                               {0.09456622884350338, -0.93254661946173545, 0.34844516195924891},
                               {0.63092723871580725, -0.21460198900724967, -0.74557146254438877},
                               {0.77005717177932, 0.29034942542499, 0.56807496278802}};
    static const double low[3] = {0.4375, -1.3, -1.2}, high[3] = {0.437500000000001, 2.1, 2.2};
    workload w = wl_pair();
    wl_surface *s = wl_add_surface(&w, 1);
    if (general)
        wl_add_box(s, &f, 1.9, 2.1, 0.5e-15);
    else
        wl_add_aligned_box(s, low, high);
    return w;
}

/* ---- views of a workload ---- */

/* The hard slabs and corners by name: D coplanar and through nodes, P ends inside, T through and thin, C cuts off a
   corner. pieces: the number that is left */
enum { WL_HARD = 17 };
static inline workload wl_hard(int i, const char **name, size_t *pieces) {
    static const char *const names[WL_HARD] = {"D1",  "D1b", "D1c", "D2",  "D3", "D3g", "P4", "P9", "P12",
                                               "P15", "T8",  "T12", "T15", "C3", "C6",  "C9", "C14"};
    static const double size[WL_HARD] = {0,     0,    0,     0,     0,    0,    1e-4, 1e-9, 1e-12,
                                         1e-15, 1e-8, 1e-12, 1e-15, 1e-3, 1e-6, 1e-9, 1e-14};
    *name = names[i];
    *pieces = i < 3 || names[i][0] == 'P' ? 1 : 2;
    switch (names[i][0]) {
    case 'P': return wl_partial(size[i]);
    case 'T': return wl_through(size[i]);
    case 'C': return wl_corner_cut(size[i]);
    default:
        return i < 2 ? wl_facet_slab(i) : i == 2 ? wl_oblique_slab() : i == 3 ? wl_corner_slab() : wl_ulp_slab(i - 4);
    }
}

static inline oracle *wl_oracle(const workload *w) {
    oracle_mesh mesh;
    oracle_surface surfaces[WL_SURFACES];
    size_t i;
    memset(&mesh, 0, sizeof mesh);
    mesh.positions = w->positions;
    mesh.node_count = w->node_count;
    mesh.elements = w->elements;
    mesh.element_count = w->element_count;
    for (i = 0; i < w->surface_count; i++) {
        surfaces[i].vertices = w->surfaces[i].vertices;
        surfaces[i].triangles = w->surfaces[i].triangles;
        surfaces[i].triangle_count = w->surfaces[i].triangle_count;
        surfaces[i].solid = w->surfaces[i].solid;
    }
    return oracle_create(&mesh, surfaces, w->surface_count);
}

static inline double wl_removed_volume(const oracle *o) {
    double volume = 0;
    size_t i;
    for (i = 0; i < o->piece_count; i++)
        if (o->pieces[i].removed) volume += oracle_piece_volume(o, &o->pieces[i]);
    return volume;
}

/* Volume of a tetrahedron inside a closed surface of winding numbers 0 and 1, of any number of triangles: the cones
   from a point to all triangles, each intersected with the tetrahedron, with the triangle's sign. Right to 1e-14 of
   their sum. */
static inline double wl_inside_volume(const double tet[4][3], const wl_surface *s, const double apex[3]) {
    static const uint32_t faces[12] = {1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1}, nodes[4] = {0, 1, 2, 3};
    oracle_surface outside = {NULL, faces, 4, 1};
    double volume = 0;
    size_t t;
    outside.vertices = &tet[0][0];
    for (t = 0; t < s->triangle_count; t++) {
        double cone[4][3];
        oracle_mesh mesh = {NULL, 4, nodes, 1, NULL};
        oracle *o;
        int k, sign;
        for (k = 0; k < 3; k++) memcpy(cone[k], s->vertices + 3 * s->triangles[3 * t + (size_t)k], sizeof cone[k]);
        memcpy(cone[3], apex, sizeof cone[3]);
        mesh.positions = &cone[0][0];
        sign = -big_sign(big_orient3d(cone[0], cone[1], cone[2], cone[3]));
        if (sign == 0) continue;
        o = oracle_create(&mesh, &outside, 1);
        volume += sign * wl_removed_volume(o);
        oracle_destroy(o);
    }
    return volume;
}

#endif /* GXFEM_TESTS_WORKLOADS_H */
