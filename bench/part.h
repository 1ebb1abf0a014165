/* part.h - the part of a tetrahedron on one node's side of a surface, by the arrangement of gxfem_boolean.h: what truth
   is read off.

   part_moments are the integrals to degree 2 in barycentric coordinates, from boundary points whose coordinates have
   180 bits, summed in long double. Shapes are in doubles: tetrahedra and boundary, for rules and for moments of higher
   degree.

   Include after the implementation of gxfem_boolean.h. What fails ends the program. */
#ifndef BENCH_PART_H
#define BENCH_PART_H

#include "dense.h"

typedef struct part {
    gxb_complex *complex;
    uint32_t element; /* of the complex, whose barycentric coordinates points have */
    uint32_t *leaves; /* leaf_count: those that are joined with the first by facets that are not walls */
    size_t leaf_count;
    int fine; /* points in long double; 0: as doubles */
} part;

static inline void part_expect(gx_result result) {
    if (result == GX_OK) return;
    fprintf(stderr, "bench: the arrangement failed with %d\n", (int)result);
    exit(1);
}

/* Corner v of a facet */
static inline uint32_t part_corner(const gxb_complex *cx, uint32_t first, uint32_t v) {
    const uint32_t walk = cx->pool[first + v];
    return cx->edges[walk >> 1].v[walk & 1];
}

static inline int part_has_point(gxb_complex *cx, uint32_t leaf, uint32_t point) {
    uint32_t first, count, edges, n, i, v;
    part_expect(gxb_leaf_resolve_facets(cx, leaf, &first, &count));
    for (i = 0; i < count; i++) {
        part_expect(gxb_facet_resolve_edges(cx, cx->pool[first + i], &edges, &n));
        for (v = 0; v < n; v++)
            if (part_corner(cx, edges, v) == point) return 1;
    }
    return 0;
}

/* Floods from the leaf at the node. */
static inline void part_flood(part *p, uint32_t node) {
    gxb_complex *cx = p->complex;
    uint32_t leaf = 0, first, count, i;
    unsigned char *seen = (unsigned char *)dense_memory(NULL, cx->leaf_count, 1);
    size_t done;
    memset(seen, 0, cx->leaf_count);
    p->leaves = (uint32_t *)dense_memory(NULL, cx->leaf_count, sizeof(uint32_t));
    while (!part_has_point(cx, leaf, node)) ++leaf;
    seen[p->leaves[p->leaf_count++] = leaf] = 1;
    for (done = 0; done < p->leaf_count; done++) {
        part_expect(gxb_leaf_resolve_facets(cx, p->leaves[done], &first, &count));
        for (i = 0; i < count; i++) {
            const gxb_facet *f = &cx->facets[cx->pool[first + i]];
            const uint32_t other = f->leaf[f->leaf[0] == p->leaves[done]];
            if (f->wall || other == GXB_NONE || seen[other]) continue;
            seen[p->leaves[p->leaf_count++] = other] = 1;
        }
    }
    free(seen);
}

/* corners: 4 x 3, positive volume; the surface passes through no node */
static inline part part_create(const double *corners, const double *vertices, const uint32_t *triangles,
                               size_t triangle_count, uint32_t node) {
    static const uint32_t element[4] = {0, 1, 2, 3};
    gxb_mesh mesh;
    part p;
    size_t t;
    int v;
    memset(&p, 0, sizeof p);
    mesh.positions = corners;
    mesh.node_count = 4;
    mesh.elements = element;
    mesh.element_count = 1;
    part_expect(gxb_complex_create(&mesh, NULL, &p.complex, NULL));
    gxb_complex_begin(p.complex);
    part_expect(gxb_complex_open_element(p.complex, 0));
    for (t = 0; t < triangle_count; t++) {
        gxb_triangle cut;
        memset(&cut, 0, sizeof cut);
        cut.wall = 1;
        for (v = 0; v < 3; v++)
            part_expect(
                gxb_complex_add_point(p.complex, vertices + 3 * (size_t)triangles[3 * t + (size_t)v], &cut.point[v]));
        part_expect(gxb_complex_add_plane(p.complex, &cut));
        part_expect(gxb_complex_insert(p.complex, &cut, 0, NULL, NULL));
    }
    gxb_complex_commit(p.complex);
    part_flood(&p, node);
    return p;
}

static inline void part_free(part *p) {
    gxb_complex_destroy(p->complex);
    free(p->leaves);
    memset(p, 0, sizeof *p);
}

static inline long double part_long(const gxb_num *a) {
    GXB_NUM(high);
    GXB_NUM(rest);
    const double rounded = gxb_num_to_double(a);
    gxb_num_set(&high, rounded, 0);
    gxb_num_sub(&rest, a, &high);
    return (long double)rounded + (long double)gxb_num_to_double(&rest);
}

static inline void part_fine_point(part *p, uint32_t point, long double x[3]) {
    gxb_limb limbs[4][GXB_NUM_LIMBS];
    gxb_num lambda[4];
    int k;
    for (k = 0; k < 4; k++) {
        memset(&lambda[k], 0, sizeof lambda[k]);
        lambda[k].d = limbs[k];
    }
    gxb_complex_barycentric_fine(p->complex, point, p->element, lambda);
    for (k = 0; k < 3; k++) x[k] = part_long(&lambda[k + 1]);
}

/* lambda 1, 2, 3 of a point */
static inline void part_point(part *p, uint32_t point, long double x[3]) {
    double lambda[4];
    int k;
    if (p->fine) {
        part_fine_point(p, point, x);
        return;
    }
    gxb_complex_barycentric(p->complex, point, p->element, lambda);
    for (k = 0; k < 3; k++) x[k] = lambda[k + 1];
}

/* Adds the cone from the origin to a triangle, as gxi_moments2_add_triangle does: 1, x y z, xx xy xz yy yz zz */
static inline void part_add_cone(long double m[10], long double x[3][3]) {
    const long double *a = x[0], *b = x[1], *c = x[2];
    const long double det =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    long double s[3];
    size_t at = 4, i, j;
    m[0] += det / 6;
    for (i = 0; i < 3; i++) {
        s[i] = a[i] + b[i] + c[i];
        m[1 + i] += det / 24 * s[i];
    }
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) m[at++] += det / 120 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
}

/* Calls visit with the corners (in lambda 1, 2, 3) of each triangle of a leaf's facets, outward. Facets between leaves
   that are flagged in own are left out: their two sides cancel. own NULL: all. */
typedef void (*part_visit)(void *user, long double x[3][3]);

static inline void part_walk_leaf(part *p, uint32_t leaf, const unsigned char *own, part_visit visit, void *user) {
    gxb_complex *cx = p->complex;
    uint32_t first, count, edges, n, i, v;
    part_expect(gxb_leaf_resolve_facets(cx, leaf, &first, &count));
    for (i = 0; i < count; i++) {
        const gxb_facet f = cx->facets[cx->pool[first + i]];
        const uint32_t other = f.leaf[f.leaf[0] == leaf];
        long double x[3][3], kept[3];
        if (own && other != GXB_NONE && own[other] && !f.wall) continue;
        part_expect(gxb_facet_resolve_edges(cx, cx->pool[first + i], &edges, &n));
        part_point(p, part_corner(cx, edges, 0), x[0]);
        part_point(p, part_corner(cx, edges, 1), kept);
        for (v = 2; v < n; v++) {
            long double *near = x[f.leaf[0] == leaf ? 2 : 1], *far = x[f.leaf[0] == leaf ? 1 : 2];
            memcpy(near, kept, sizeof kept);
            part_point(p, part_corner(cx, edges, v), kept);
            memcpy(far, kept, sizeof kept);
            visit(user, x);
        }
    }
}

static inline void part_add_moments(void *user, long double x[3][3]) { part_add_cone((long double *)user, x); }

/* Visits the part's boundary. */
static inline void part_walk(part *p, part_visit visit, void *user) {
    unsigned char *own = (unsigned char *)dense_memory(NULL, p->complex->leaf_count, 1);
    size_t i;
    memset(own, 0, p->complex->leaf_count);
    for (i = 0; i < p->leaf_count; i++) own[p->leaves[i]] = 1;
    for (i = 0; i < p->leaf_count; i++) part_walk_leaf(p, p->leaves[i], own, visit, user);
    free(own);
}

/* The part's integrals in the reference frame: 1, x y z, xx xy xz yy yz zz */
static inline void part_moments(part *p, long double m[10]) {
    int i;
    for (i = 0; i < 10; i++) m[i] = 0;
    p->fine = 1;
    part_walk(p, part_add_moments, m);
    p->fine = 0;
}

/* ---- tetrahedra and boundary triangles, as doubles ---- */

typedef struct part_shape {
    double *corners; /* count x width */
    size_t count, capacity, width;
    double apex[3]; /* of the leaf at hand */
    size_t points;  /* that its mean is of */
} part_shape;

static inline double *part_shape_add(part_shape *s) {
    if (s->count == s->capacity) {
        s->capacity = 2 * s->capacity + 64;
        s->corners = (double *)dense_memory(s->corners, s->capacity * s->width, sizeof(double));
    }
    return s->corners + s->width * s->count++;
}

static inline void part_sum(void *user, long double x[3][3]) {
    part_shape *s = (part_shape *)user;
    int i;
    for (i = 0; i < 9; i++) s->apex[i % 3] += (double)x[i / 3][i % 3];
    s->points += 3;
}

/* The tetrahedron from a triangle to the leaf's middle, unless it is flat */
static inline void part_add_tetrahedron(void *user, long double x[3][3]) {
    part_shape *s = (part_shape *)user;
    double p[12], volume;
    int i;
    for (i = 0; i < 12; i++) p[i] = i < 3 ? s->apex[i] : (double)x[i / 3 - 1][i % 3];
    volume = (p[3] - p[0]) * ((p[7] - p[1]) * (p[11] - p[2]) - (p[8] - p[2]) * (p[10] - p[1])) +
             (p[4] - p[1]) * ((p[8] - p[2]) * (p[9] - p[0]) - (p[6] - p[0]) * (p[11] - p[2])) +
             (p[5] - p[2]) * ((p[6] - p[0]) * (p[10] - p[1]) - (p[7] - p[1]) * (p[9] - p[0]));
    if (volume > 0) memcpy(part_shape_add(s), p, sizeof p);
}

static inline void part_add_triangle(void *user, long double x[3][3]) {
    double *corners = part_shape_add((part_shape *)user);
    int i;
    for (i = 0; i < 9; i++) corners[i] = (double)x[i / 3][i % 3];
}

/* The boundary, outward. The caller frees corners. */
static inline part_shape part_boundary(part *p) {
    part_shape s;
    memset(&s, 0, sizeof s);
    s.width = 9;
    part_walk(p, part_add_triangle, &s);
    return s;
}

/* Leaves are convex: fans around their middles. The caller frees corners. */
static inline part_shape part_tetrahedra(part *p) {
    part_shape s;
    size_t i;
    int a;
    memset(&s, 0, sizeof s);
    s.width = 12;
    for (i = 0; i < p->leaf_count; i++) {
        memset(s.apex, 0, sizeof s.apex);
        s.points = 0;
        part_walk_leaf(p, p->leaves[i], NULL, part_sum, &s);
        for (a = 0; a < 3; a++) s.apex[a] /= (double)s.points;
        part_walk_leaf(p, p->leaves[i], NULL, part_add_tetrahedron, &s);
    }
    return s;
}

#endif
