/* oracle.h - the true result of cutting a mesh, computed slowly and exactly.

   It shares no idea with the library. Every element is divided by *all* planes of the input, extended to infinity:
   the plane of every cut triangle, and one crossing plane through every edge at which a cut surface ends or bends.
   The pieces are convex, and no face of a piece straddles the boundary of a cut surface. Then
       regions     pieces joined across faces that lie in no cut triangle; each has one winding number: solids remove
                   them
       materials   of a piece: that of the last surface of material that winds around it, else of its element
       cells       pieces of one element and one material joined across faces that lie in no sheet
       links       cells of two elements whose pieces share a part of their common face (edge, node) that no sheet
                   covers; cells of one element and two materials whose pieces share a face that no sheet covers
       copies      per node: components of the cells of the elements around it
       fragments   components of all cells

   All decisions are signs of exact numbers (rational.h). A volume is a sum of positive exact volumes, each rounded
   once. The work grows with the cube of the number of planes: a dozen is quick, a hundred is not.

       oracle *truth = oracle_create(&mesh, surfaces, surface_count);
       ... truth->cell_count, truth->node_copies[i] ...
       oracle_destroy(truth);      // in reverse order of creation: numbers live in rational.h's arena */
#ifndef GXFEM_TESTS_ORACLE_H
#define GXFEM_TESTS_ORACLE_H

#include "rational.h"

enum {
    ORACLE_WORDS = 4,
    ORACLE_FACE = 64 * ORACLE_WORDS - 4, /* first of the element's own four planes, face k opposite to its node k */
    ORACLE_NONE = -1,
    /* Where two elements meet in an edge or a node only. 0: they separate where a wall touches that part of the
       edge, or that node: a part of a sheet inside an element or on a face. 1: also where a sheet touches it from
       outside of the body and nowhere else (Omega minus Gamma, the limit of a thin solid). */
    ORACLE_TOUCH_FROM_OUTSIDE = 1
};

/* ---- input ---- */
typedef struct oracle_mesh {
    const double *positions; /* node_count x 3 */
    size_t node_count;
    const uint32_t *elements; /* element_count x 4, positive volume */
    size_t element_count;
    const uint32_t *materials; /* element_count, or NULL: all 0 */
} oracle_mesh;

typedef struct oracle_surface {
    const double *vertices;    /* x 3 */
    const uint32_t *triangles; /* triangle_count x 3 */
    size_t triangle_count;
    int solid; /* 1: removes where its winding number is not 0; 2: where it is 0; 0: a sheet; 3 + m: gives material m */
} oracle_surface;

/* ---- sets of planes ---- */
typedef struct oracle_set {
    uint64_t word[ORACLE_WORDS];
} oracle_set;

static inline oracle_set oracle_set_empty(void) {
    oracle_set s;
    memset(&s, 0, sizeof s);
    return s;
}
static inline void oracle_set_add(oracle_set *s, int k) { s->word[k / 64] |= UINT64_C(1) << k % 64; }
static inline int oracle_set_has(const oracle_set *s, int k) { return (int)(s->word[k / 64] >> k % 64 & 1); }
static inline int oracle_set_equal(const oracle_set *a, const oracle_set *b) { return memcmp(a, b, sizeof *a) == 0; }

static inline oracle_set oracle_set_and(const oracle_set *a, const oracle_set *b) {
    oracle_set s;
    int i;
    for (i = 0; i < ORACLE_WORDS; i++) s.word[i] = a->word[i] & b->word[i];
    return s;
}
static inline oracle_set oracle_set_or(const oracle_set *a, const oracle_set *b) {
    oracle_set s;
    int i;
    for (i = 0; i < ORACLE_WORDS; i++) s.word[i] = a->word[i] | b->word[i];
    return s;
}
static inline int oracle_set_contains(const oracle_set *a, const oracle_set *b) {
    int i;
    for (i = 0; i < ORACLE_WORDS; i++)
        if (b->word[i] & ~a->word[i]) return 0;
    return 1;
}
static inline int oracle_set_first(const oracle_set *s) {
    int k;
    for (k = 0; k < 64 * ORACLE_WORDS; k++)
        if (oracle_set_has(s, k)) break;
    return k;
}
/* The only plane in which a and b differ; ORACLE_NONE if they differ in none or several. */
static inline int oracle_set_difference(const oracle_set *a, const oracle_set *b) {
    int i, k, found = ORACLE_NONE;
    for (i = 0; i < ORACLE_WORDS; i++) {
        uint64_t d = a->word[i] ^ b->word[i];
        if (d == 0) continue;
        if (found != ORACLE_NONE || (d & (d - 1)) != 0) return ORACLE_NONE;
        for (k = 0; !(d >> k & 1); k++) {}
        found = 64 * i + k;
    }
    return found;
}

/* ---- geometry ---- */
typedef struct oracle_plane {
    big h[4];
} oracle_plane; /* h0 x + h1 y + h2 z + h3 = 0 */

typedef struct oracle_triangle {
    double corner[3][3];
    size_t surface;
    int solid, plane; /* plane: index, ORACLE_NONE where the mesh lies strictly on one side */
    int axis;         /* a direction in which the triangle can be projected */
} oracle_triangle;

typedef struct oracle_point {
    big h[4];              /* homogeneous: x = h0 / h3, ..., h3 > 0 */
    oracle_set zero, plus; /* planes that it lies on, or on the positive side of */
} oracle_point;

typedef struct oracle_piece { /* convex hull of some points of its element */
    size_t element;
    size_t points, point_count; /* into oracle.corners */
    oracle_set plus;            /* planes on whose positive side it lies */
    size_t region, cell;
    int removed;
    uint32_t material;
} oracle_piece;

typedef struct oracle_link {
    size_t piece[2];
} oracle_link;

typedef struct oracle {
    oracle_mesh mesh;
    oracle_plane *planes;
    size_t plane_count;
    oracle_triangle *triangles;
    size_t triangle_count;
    oracle_point *points;
    size_t point_count;
    /* of the pieces: indices of points */
    size_t *corners;
    size_t corner_count;
    oracle_piece *pieces;
    size_t piece_count;
    size_t *element_pieces; /* element_count + 1: where each element's pieces start */
    /* between pieces of different elements or materials */
    oracle_link *links;
    size_t link_count;
    size_t cell_count;
    size_t *cell_element; /* cell_count, ascending */
    double *cell_volume;
    uint32_t *cell_material;
    size_t *cell_fragment;
    size_t *node_copies; /* node_count */
    size_t copy_count;
    size_t fragment_count;
    double *fragment_volume;
    double volume;
    rat_mark mark;
} oracle;

static inline void *oracle_memory(void *old, size_t count, size_t size) {
    void *memory = realloc(old, (count + 1) * size);
    if (memory == NULL) rat_stop("oracle: out of memory");
    return memory;
}

/* Room for one more, doubling when the count reaches a power of two. */
static inline void *oracle_grow(void *old, size_t count, size_t size) {
    return (count & (count - 1)) == 0 ? oracle_memory(old, 2 * count + 1, size) : old;
}

static inline big oracle_value(const oracle_plane *p, const big h[4]) {
    return big_add(big_dot(p->h, h), big_mul(p->h[3], h[3]));
}

static inline int oracle_side(const oracle_plane *p, const big h[4]) {
    rat_mark mark = rat_arena_mark();
    int sign = big_sign(oracle_value(p, h));
    rat_arena_release(mark);
    return sign;
}

static inline void oracle_homogeneous(const double x[3], big h[4]) {
    big_vector(x, h);
    h[3] = big_from_int(1);
}

static inline int oracle_side_of(const oracle_plane *p, const double x[3]) {
    big h[4];
    oracle_homogeneous(x, h);
    return oracle_side(p, h);
}

static inline oracle_plane oracle_plane_through(const double x[3], const big normal[3]) {
    oracle_plane p;
    big h[3];
    int k;
    big_vector(x, h);
    for (k = 0; k < 3; k++) p.h[k] = normal[k];
    p.h[3] = big_neg(big_dot(normal, h));
    return p;
}

/* The plane of a triangle, normal (b - a) x (c - a); returns 0 where it has no area */
static inline int oracle_plane_of(const double a[3], const double b[3], const double c[3], oracle_plane *p) {
    big u[3], v[3], n[3];
    big_difference(b, a, u);
    big_difference(c, a, v);
    big_cross(u, v, n);
    *p = oracle_plane_through(a, n);
    return n[0].sign != 0 || n[1].sign != 0 || n[2].sign != 0;
}

/* Same set of points: all 2 x 2 minors vanish. */
static inline int oracle_plane_equal(const oracle_plane *p, const oracle_plane *q) {
    int i, j;
    for (i = 0; i < 4; i++)
        for (j = i + 1; j < 4; j++)
            if (big_det2(p->h[i], p->h[j], q->h[i], q->h[j]).sign != 0) return 0;
    return 1;
}

/* ---- the planes ---- */

/* Does the plane leave all nodes strictly on one side? Then it divides and touches nothing. */
static inline int oracle_plane_misses(const oracle *o, const oracle_plane *p) {
    size_t i;
    int first = oracle_side_of(p, o->mesh.positions);
    for (i = 0; i < o->mesh.node_count; i++)
        if (first == 0 || oracle_side_of(p, o->mesh.positions + 3 * i) != first) return 0;
    return 1;
}

static inline int oracle_plane_add(oracle *o, const oracle_plane *p) {
    size_t i;
    if (oracle_plane_misses(o, p)) return ORACLE_NONE;
    for (i = 0; i < o->plane_count; i++)
        if (oracle_plane_equal(&o->planes[i], p)) return (int)i;
    if (o->plane_count == ORACLE_FACE) rat_stop("oracle: too many planes");
    o->planes = (oracle_plane *)oracle_grow(o->planes, o->plane_count, sizeof *o->planes);
    o->planes[o->plane_count] = *p;
    return (int)o->plane_count++;
}

static inline void oracle_add_triangle(oracle *o, const oracle_surface *surface, size_t index, size_t triangle) {
    oracle_triangle t;
    oracle_plane p;
    int i;
    for (i = 0; i < 3; i++)
        memcpy(t.corner[i], surface->vertices + 3 * surface->triangles[3 * triangle + (size_t)i], sizeof t.corner[i]);
    if (!oracle_plane_of(t.corner[0], t.corner[1], t.corner[2], &p)) return;
    for (t.axis = 0, i = 1; i < 3; i++)
        if (big_compare_abs(p.h[i], p.h[t.axis]) > 0) t.axis = i;
    t.surface = index;
    t.solid = surface->solid;
    t.plane = oracle_plane_add(o, &p);
    o->triangles = (oracle_triangle *)oracle_grow(o->triangles, o->triangle_count, sizeof t);
    o->triangles[o->triangle_count++] = t;
}

static inline int oracle_same_position(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Sign of the area of p, q, x after dropping a coordinate, x homogeneous */
static inline int oracle_turn(const double p[3], const double q[3], const big x[4], int axis) {
    int i = (axis + 1) % 3, j = (axis + 2) % 3, sign;
    rat_mark mark = rat_arena_mark();
    big pi = big_from_double(p[i]), pj = big_from_double(p[j]);
    big ui = big_sub(big_from_double(q[i]), pi), uj = big_sub(big_from_double(q[j]), pj);
    big vi = big_sub(x[i], big_mul(pi, x[3])), vj = big_sub(x[j], big_mul(pj, x[3]));
    sign = big_sign(big_det2(ui, uj, vi, vj));
    rat_arena_release(mark);
    return sign;
}

/* Does the surface continue straight ahead beyond edge k of triangle t, so that nothing ends there? */
static inline int oracle_edge_covered(const oracle *o, const oracle_triangle *t, int k) {
    const double *p = t->corner[k], *q = t->corner[(k + 1) % 3];
    size_t i;
    int j;
    big h[4];
    oracle_homogeneous(t->corner[(k + 2) % 3], h);
    for (i = 0; i < o->triangle_count; i++) {
        const oracle_triangle *s = &o->triangles[i];
        if (s->plane != t->plane || s->solid != t->solid) continue;
        for (j = 0; j < 3; j++) {
            const double *a = s->corner[j], *b = s->corner[(j + 1) % 3];
            big g[4];
            if (!(oracle_same_position(a, p) && oracle_same_position(b, q)) &&
                !(oracle_same_position(a, q) && oracle_same_position(b, p)))
                continue;
            oracle_homogeneous(s->corner[(j + 2) % 3], g);
            if (oracle_turn(p, q, g, t->axis) * oracle_turn(p, q, h, t->axis) < 0) return 1;
        }
    }
    return 0;
}

/* Does a plane other than t's own run through edge k of t? */
static inline int oracle_edge_crossed(const oracle *o, const oracle_triangle *t, int k) {
    size_t i;
    for (i = 0; i < o->plane_count; i++)
        if ((int)i != t->plane && oracle_side_of(&o->planes[i], t->corner[k]) == 0 &&
            oracle_side_of(&o->planes[i], t->corner[(k + 1) % 3]) == 0)
            return 1;
    return 0;
}

/* Through edge k of t and an axis that is not in t's plane: 2 coordinate products less than an orthogonal plane */
static inline oracle_plane oracle_edge_plane(const oracle_triangle *t, int k) {
    const double *p = t->corner[k], *q = t->corner[(k + 1) % 3];
    int i = (t->axis + 1) % 3, j = (t->axis + 2) % 3;
    big u[3], n[3];
    big_difference(q, p, u);
    n[t->axis] = big_zero();
    n[i] = u[j];
    n[j] = big_neg(u[i]);
    return oracle_plane_through(p, n);
}

static inline void oracle_find_planes(oracle *o, const oracle_surface *surfaces, size_t surface_count) {
    size_t s, i;
    int k;
    for (s = 0; s < surface_count; s++)
        for (i = 0; i < surfaces[s].triangle_count; i++) oracle_add_triangle(o, &surfaces[s], s, i);
    for (i = 0; i < o->triangle_count; i++)
        for (k = 0; k < 3; k++) {
            const oracle_triangle *t = &o->triangles[i];
            oracle_plane p;
            if (t->plane == ORACLE_NONE || oracle_edge_covered(o, t, k) || oracle_edge_crossed(o, t, k)) continue;
            p = oracle_edge_plane(t, k);
            oracle_plane_add(o, &p);
        }
}

/* ---- the pieces of one element ---- */

static inline size_t oracle_add_point(oracle *o, const big h[4], const oracle_set *zero) {
    oracle_point p;
    size_t i;
    memcpy(p.h, h, sizeof p.h);
    p.zero = *zero;
    p.plus = oracle_set_empty();
    for (i = 0; i < o->plane_count; i++) {
        int side = oracle_side(&o->planes[i], h);
        if (side == 0) oracle_set_add(&p.zero, (int)i);
        if (side > 0) oracle_set_add(&p.plus, (int)i);
    }
    o->points = (oracle_point *)oracle_grow(o->points, o->point_count, sizeof p);
    o->points[o->point_count] = p;
    return o->point_count++;
}

static inline void oracle_add_piece(oracle *o, size_t element, const size_t *points, size_t count) {
    oracle_piece *p;
    size_t i;
    o->pieces = (oracle_piece *)oracle_grow(o->pieces, o->piece_count, sizeof *p);
    p = &o->pieces[o->piece_count++];
    memset(p, 0, sizeof *p);
    p->element = element;
    p->points = o->corner_count;
    p->point_count = count;
    for (i = 0; i < count; i++) {
        o->corners = (size_t *)oracle_grow(o->corners, o->corner_count, sizeof *o->corners);
        o->corners[o->corner_count++] = points[i];
    }
}

static inline const oracle_point *oracle_corner(const oracle *o, const oracle_piece *p, size_t i) {
    return &o->points[o->corners[p->points + i]];
}

/* The planes before k and the element's faces: pieces lie on one side of each of these when it is k's turn. */
static inline oracle_set oracle_done(size_t k) {
    oracle_set s = oracle_set_empty();
    int i;
    for (i = 0; i < (int)k; i++) oracle_set_add(&s, i);
    for (i = 0; i < 4; i++) oracle_set_add(&s, ORACLE_FACE + i);
    return s;
}

/* Two corners span an edge of a convex piece if no other corner lies on all the planes on which both lie. Only
   planes that leave the piece on one side count. */
static inline int oracle_adjacent(const oracle *o, const oracle_piece *p, size_t a, size_t b, const oracle_set *done) {
    oracle_set common = oracle_set_and(&oracle_corner(o, p, a)->zero, &oracle_corner(o, p, b)->zero);
    size_t i;
    common = oracle_set_and(&common, done);
    for (i = 0; i < p->point_count; i++)
        if (i != a && i != b && oracle_set_contains(&oracle_corner(o, p, i)->zero, &common)) return 0;
    return 1;
}

/* The point where three planes meet; returns 0 if they don't meet in one point */
static inline int oracle_meet(const oracle_plane *p, const oracle_plane *q, const oracle_plane *r, big h[4]) {
    big qr[3], rp[3], pq[3];
    int k;
    big_cross(q->h, r->h, qr);
    big_cross(r->h, p->h, rp);
    big_cross(p->h, q->h, pq);
    h[3] = big_dot(p->h, qr);
    if (h[3].sign == 0) return 0;
    for (k = 0; k < 3; k++)
        h[k] = big_neg(big_add(big_add(big_mul(p->h[3], qr[k]), big_mul(q->h[3], rp[k])), big_mul(r->h[3], pq[k])));
    if (h[3].sign < 0)
        for (k = 0; k < 4; k++) h[k] = big_neg(h[k]);
    return 1;
}

static inline const oracle_plane *oracle_plane_at(const oracle *o, const oracle_plane faces[4], int k) {
    return k >= ORACLE_FACE ? &faces[k - ORACLE_FACE] : &o->planes[k];
}

/* Where plane k crosses the edge between points a and b: the meeting point of k and two planes that hold the edge */
static inline size_t oracle_cross_edge(oracle *o, const oracle_plane faces[4], size_t first, size_t a, size_t b,
                                       int k) {
    oracle_set common = oracle_set_and(&o->points[a].zero, &o->points[b].zero), zero, all = common;
    size_t found;
    int i, j, m;
    oracle_set_add(&all, k);
    for (found = first; found < o->point_count; found++)
        if (oracle_set_contains(&o->points[found].zero, &all)) return found;
    for (i = 0; i < ORACLE_FACE + 4; i++)
        for (j = i + 1; j < ORACLE_FACE + 4; j++) {
            big h[4];
            if (!oracle_set_has(&common, i) || !oracle_set_has(&common, j)) continue;
            if (!oracle_meet(oracle_plane_at(o, faces, i), oracle_plane_at(o, faces, j), &o->planes[k], h)) continue;
            zero = oracle_set_empty();
            for (m = 0; m < 4; m++)
                if (oracle_side(&faces[m], h) == 0) oracle_set_add(&zero, ORACLE_FACE + m);
            return oracle_add_point(o, h, &zero);
        }
    rat_stop("oracle: an edge without planes");
    return 0;
}

/* Divides piece p by plane k: its positive side takes its place, the negative side is appended. */
static inline void oracle_split(oracle *o, const oracle_plane faces[4], size_t first, size_t index, int k) {
    oracle_piece p = o->pieces[index];
    size_t *plus = (size_t *)oracle_memory(NULL, p.point_count * p.point_count, sizeof *plus);
    size_t *minus = (size_t *)oracle_memory(NULL, p.point_count * p.point_count, sizeof *minus);
    size_t plus_count = 0, minus_count = 0, a, b;
    oracle_set done = oracle_done((size_t)k);
    int above = 0, below = 0;
    for (a = 0; a < p.point_count; a++) {
        const oracle_point *x = oracle_corner(o, &p, a);
        int on = oracle_set_has(&x->zero, k), up = oracle_set_has(&x->plus, k);
        if (on || up) plus[plus_count++] = o->corners[p.points + a];
        if (on || !up) minus[minus_count++] = o->corners[p.points + a];
        above |= up;
        below |= !on && !up;
    }
    if (above && below) {
        for (a = 0; a < p.point_count; a++)
            for (b = 0; b < p.point_count; b++) {
                size_t x = o->corners[p.points + a], y = o->corners[p.points + b];
                if (!oracle_set_has(&o->points[x].plus, k)) continue;
                if (oracle_set_has(&o->points[y].plus, k) || oracle_set_has(&o->points[y].zero, k)) continue;
                if (!oracle_adjacent(o, &p, a, b, &done)) continue;
                plus[plus_count++] = minus[minus_count++] = oracle_cross_edge(o, faces, first, x, y, k);
            }
        oracle_add_piece(o, p.element, plus, plus_count);
        o->pieces[index] = o->pieces[o->piece_count - 1];
        o->piece_count--;
        oracle_add_piece(o, p.element, minus, minus_count);
    }
    free(plus);
    free(minus);
}

static inline const double *oracle_node(const oracle *o, size_t element, int k) {
    return o->mesh.positions + 3 * o->mesh.elements[4 * element + (size_t)k];
}

static inline void oracle_divide_element(oracle *o, size_t element) {
    oracle_plane faces[4];
    size_t first = o->point_count, start = o->piece_count, corner[4], i, k;
    int a, b;
    for (a = 0; a < 4; a++)
        oracle_plane_of(oracle_node(o, element, (a + 1) % 4), oracle_node(o, element, (a + 2) % 4),
                        oracle_node(o, element, (a + 3) % 4), &faces[a]);
    for (a = 0; a < 4; a++) {
        oracle_set zero = oracle_set_empty();
        big h[4];
        for (b = 0; b < 4; b++)
            if (b != a) oracle_set_add(&zero, ORACLE_FACE + b);
        oracle_homogeneous(oracle_node(o, element, a), h);
        corner[a] = oracle_add_point(o, h, &zero);
    }
    oracle_add_piece(o, element, corner, 4);
    for (k = 0; k < o->plane_count; k++) {
        size_t count = o->piece_count;
        for (i = start; i < count; i++) oracle_split(o, faces, first, i, (int)k);
    }
    for (i = start; i < o->piece_count; i++) {
        oracle_piece *p = &o->pieces[i];
        p->plus = oracle_set_empty();
        for (k = 0; k < p->point_count; k++) p->plus = oracle_set_or(&p->plus, &oracle_corner(o, p, k)->plus);
    }
    o->element_pieces[element + 1] = o->piece_count;
}

/* ---- volume: tetrahedra from one corner to the fans of the facets it is not on ---- */

static inline rat oracle_tetrahedron(const big a[4], const big b[4], const big c[4], const big d[4]) {
    big u[3], v[3], w[3], den;
    int k;
    for (k = 0; k < 3; k++) {
        u[k] = big_det2(a[3], a[k], b[3], b[k]);
        v[k] = big_det2(a[3], a[k], c[3], c[k]);
        w[k] = big_det2(a[3], a[k], d[3], d[k]);
    }
    den = big_mul(big_mul(b[3], c[3]), big_mul(d[3], big_mul(a[3], big_mul(a[3], a[3]))));
    return rat_abs(rat_ratio(big_det3(u, v, w), big_mul(big_from_int(6), den)));
}

/* Calls visit for every tetrahedron of the piece. */
static inline void oracle_visit_tetrahedra(const oracle *o, const oracle_piece *p,
                                           void (*visit)(void *user, rat volume), void *user) {
    const oracle_point *apex = oracle_corner(o, p, 0);
    oracle_set done = oracle_done(o->plane_count);
    int k;
    for (k = 0; k < ORACLE_FACE + 4; k++) {
        size_t a, b, fan = p->point_count, on = 0;
        oracle_set common;
        if (k == (int)o->plane_count) k = ORACLE_FACE;
        if (oracle_set_has(&apex->zero, k)) continue;
        memset(&common, 0xff, sizeof common);
        for (a = p->point_count; a-- > 0;) {
            const oracle_point *x = oracle_corner(o, p, a);
            if (!oracle_set_has(&x->zero, k)) continue;
            common = oracle_set_and(&common, &x->zero);
            fan = a;
            on++;
        }
        if (on < 3 || oracle_set_first(&common) < k) continue; /* a cut in an element's face: once */
        for (a = 0; a < p->point_count; a++)
            for (b = a + 1; b < p->point_count; b++) {
                const oracle_point *x = oracle_corner(o, p, a), *y = oracle_corner(o, p, b);
                if (a == fan || b == fan || !oracle_set_has(&x->zero, k) || !oracle_set_has(&y->zero, k)) continue;
                if (!oracle_adjacent(o, p, a, b, &done)) continue;
                visit(user, oracle_tetrahedron(apex->h, oracle_corner(o, p, fan)->h, x->h, y->h));
            }
    }
}

static inline void oracle_add_rounded(void *sum, rat volume) { *(double *)sum += rat_to_double(volume); }
static inline void oracle_add_exact(void *sum, rat volume) { *(rat *)sum = rat_add(*(rat *)sum, volume); }

/* Right to 1e-14 of itself. */
static inline double oracle_piece_volume(const oracle *o, const oracle_piece *p) {
    rat_mark mark = rat_arena_mark();
    double volume = 0;
    oracle_visit_tetrahedra(o, p, oracle_add_rounded, &volume);
    rat_arena_release(mark);
    return volume;
}

/* Exact; its length grows with every piece added. */
static inline rat oracle_add_piece_volume(const oracle *o, const oracle_piece *p, rat sum) {
    oracle_visit_tetrahedra(o, p, oracle_add_exact, &sum);
    return sum;
}

static inline rat oracle_element_volume(const oracle_mesh *mesh, size_t element) {
    const double *x = mesh->positions;
    const uint32_t *n = mesh->elements + 4 * element;
    return rat_ratio(big_orient3d(x + 3 * n[0], x + 3 * n[1], x + 3 * n[2], x + 3 * n[3]), big_from_int(6));
}

/* ---- contacts: where a piece meets a face, an edge or a node of its element, or a plane ---- */
typedef struct oracle_contact {
    size_t count;          /* corners there */
    oracle_set zero, plus; /* the planes that it lies in, and on whose positive side: its name */
    big center[4];         /* a point in its relative interior */
} oracle_contact;

static inline oracle_contact oracle_contact_of(const oracle *o, const oracle_piece *p, const oracle_set *on) {
    oracle_contact c;
    size_t i;
    int k;
    memset(&c, 0, sizeof c);
    memset(&c.zero, 0xff, sizeof c.zero);
    for (i = 0; i < p->point_count; i++) {
        const oracle_point *x = oracle_corner(o, p, i);
        if (!oracle_set_contains(&x->zero, on)) continue;
        c.count++;
        c.zero = oracle_set_and(&c.zero, &x->zero);
        c.plus = oracle_set_or(&c.plus, &x->plus);
        for (k = 0; k < 4; k++) c.center[k] = big_add(c.center[k], x->h[k]);
    }
    c.zero.word[ORACLE_WORDS - 1] &= ~(UINT64_C(15) << 60); /* faces have other names in other elements */
    return c;
}

static inline int oracle_in_triangle(const oracle_triangle *t, const big x[4]) {
    int k, plus = 0, minus = 0;
    for (k = 0; k < 3; k++) {
        int turn = oracle_turn(t->corner[k], t->corner[(k + 1) % 3], x, t->axis);
        plus |= turn > 0;
        minus |= turn < 0;
    }
    return !(plus && minus);
}

/* Does the contact lie in a triangle of a sheet (or, with solids, of any surface)? */
static inline int oracle_covered(const oracle *o, const oracle_contact *c, int solids) {
    size_t i;
    for (i = 0; i < o->triangle_count; i++) {
        const oracle_triangle *t = &o->triangles[i];
        if (t->plane == ORACLE_NONE || (t->solid && !solids)) continue;
        if (oracle_set_has(&c->zero, t->plane) && oracle_in_triangle(t, c->center)) return 1;
    }
    return 0;
}

/* ---- union-find ---- */
static inline size_t oracle_root(size_t *parent, size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}
static inline void oracle_join(size_t *parent, size_t i, size_t j) {
    i = oracle_root(parent, i);
    j = oracle_root(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}
static inline size_t *oracle_singles(size_t count) {
    size_t *parent = (size_t *)oracle_memory(NULL, count, sizeof *parent), i;
    for (i = 0; i < count; i++) parent[i] = i;
    return parent;
}
/* Numbers the sets in the order of their first members: parent[i] becomes the number of i's set. Returns the number
   of sets. */
static inline size_t oracle_number(size_t *parent, size_t count) {
    size_t *number = (size_t *)oracle_memory(NULL, count, sizeof *number), sets = 0, i;
    for (i = 0; i < count; i++) {
        size_t root = oracle_root(parent, i); /* the smallest member */
        number[i] = root == i ? sets++ : number[root];
    }
    memcpy(parent, number, count * sizeof *number);
    free(number);
    return sets;
}

/* ---- regions, winding numbers, cells ---- */

static inline void oracle_add_link(oracle *o, size_t piece, size_t other) {
    o->links = (oracle_link *)oracle_grow(o->links, o->link_count, sizeof *o->links);
    o->links[o->link_count].piece[0] = piece;
    o->links[o->link_count++].piece[1] = other;
}

/* Joins the pieces of each element across faces that no sheet (solids: no surface) covers; those of different materials
   are linked. Two pieces of one element share a face when they lie on different sides of exactly one plane. */
static inline void oracle_join_inside(oracle *o, size_t *parent, int solids) {
    size_t e, i, j;
    for (e = 0; e < o->mesh.element_count; e++)
        for (i = o->element_pieces[e]; i < o->element_pieces[e + 1]; i++)
            for (j = i + 1; j < o->element_pieces[e + 1]; j++) {
                const oracle_piece *p = &o->pieces[i], *q = &o->pieces[j];
                int k = oracle_set_difference(&p->plus, &q->plus);
                rat_mark mark = rat_arena_mark();
                oracle_set on = oracle_set_empty();
                oracle_contact c;
                if (k == ORACLE_NONE || p->removed || q->removed || oracle_root(parent, i) == oracle_root(parent, j))
                    continue;
                oracle_set_add(&on, k);
                c = oracle_contact_of(o, p, &on);
                if (!oracle_covered(o, &c, solids)) {
                    if (solids || p->material == q->material)
                        oracle_join(parent, i, j);
                    else
                        oracle_add_link(o, i, j);
                }
                rat_arena_release(mark);
            }
}

/* +1, -1: the ray from x along d passes through the triangle from behind, from the front; 0: it misses. *generic = 0
   where it runs through an edge or a corner. */
static inline int oracle_ray_crossing(const oracle_triangle *t, const big x[4], const big d[3], int *generic) {
    big v[3][3];
    int side[3], i, k, ahead, area;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) v[i][k] = big_sub(big_mul(big_from_double(t->corner[i][k]), x[3]), x[k]);
    for (i = 0; i < 3; i++) side[i] = big_sign(big_det3(d, v[i], v[(i + 1) % 3]));
    area = side[0] != 0 ? side[0] : side[1] != 0 ? side[1] : side[2];
    for (i = 0; i < 3; i++)
        if (side[i] != 0 && side[i] != area) return 0;
    ahead = big_sign(big_det3(v[0], v[1], v[2]));
    if (area == 0 || ahead != area) return 0; /* along the triangle's plane, or behind x */
    for (i = 0; i < 3; i++)
        if (side[i] == 0) *generic = 0;
    return area;
}

/* Winding number of a surface around x: crossings of the first direction that meets no edge */
static inline int oracle_winding(const oracle *o, size_t surface, const big x[4]) {
    int attempt, winding = 0, generic = 0, k;
    for (attempt = 0; !generic; attempt++) {
        size_t i;
        rat_mark mark = rat_arena_mark();
        big d[3];
        winding = 0;
        generic = 1;
        for (k = 0; k < 3; k++)
            d[k] = big_from_int((attempt * attempt * (k + 3) + 7 * attempt + 11 * k * k + 13) % 101 - 50);
        for (i = 0; i < o->triangle_count && generic; i++)
            if (o->triangles[i].surface == surface) winding += oracle_ray_crossing(&o->triangles[i], x, d, &generic);
        rat_arena_release(mark);
    }
    return winding;
}

static inline void oracle_remove(oracle *o, const oracle_surface *surfaces, size_t surface_count) {
    size_t *region = oracle_singles(o->piece_count), i, s;
    oracle_join_inside(o, region, 1);
    for (i = 0; i < o->piece_count; i++) {
        oracle_piece *p = &o->pieces[i];
        rat_mark mark = rat_arena_mark();
        oracle_set nothing = oracle_set_empty();
        oracle_contact inside;
        p->region = oracle_root(region, i);
        p->removed = o->pieces[p->region].removed;
        p->material = o->pieces[p->region].material;
        if (p->region != i) continue;
        if (o->mesh.materials != NULL) p->material = o->mesh.materials[p->element];
        inside = oracle_contact_of(o, p, &nothing);
        for (s = 0; s < surface_count && !p->removed; s++) {
            const int kind = surfaces[s].solid, winds = kind != 0 && oracle_winding(o, s, inside.center) != 0;
            if (kind == 1 || kind == 2) p->removed = winds == (kind == 1);
            if (kind >= 3 && winds) p->material = (uint32_t)(kind - 3);
        }
        rat_arena_release(mark);
    }
    free(region);
}

static inline void oracle_find_cells(oracle *o) {
    size_t *cell = oracle_singles(o->piece_count), *name = oracle_singles(o->piece_count), i;
    oracle_join_inside(o, cell, 0);
    for (i = 0; i < o->piece_count; i++) {
        oracle_piece *p = &o->pieces[i];
        size_t root = oracle_root(cell, i);
        if (p->removed) continue;
        if (root == i) {
            o->cell_element = (size_t *)oracle_memory(o->cell_element, o->cell_count, sizeof *o->cell_element);
            o->cell_volume = (double *)oracle_memory(o->cell_volume, o->cell_count, sizeof *o->cell_volume);
            o->cell_material = (uint32_t *)oracle_memory(o->cell_material, o->cell_count, sizeof *o->cell_material);
            o->cell_element[o->cell_count] = p->element;
            o->cell_material[o->cell_count] = p->material;
            o->cell_volume[o->cell_count] = 0;
            name[i] = o->cell_count++;
        }
        p->cell = name[root];
        o->cell_volume[p->cell] += oracle_piece_volume(o, p);
    }
    free(cell);
    free(name);
}

/* ---- links ---- */

/* The nodes that elements e and f share, as sets of faces of e and of f that meet there; returns their number */
static inline size_t oracle_shared(const oracle *o, size_t e, size_t f, oracle_set *in_e, oracle_set *in_f) {
    const uint32_t *a = o->mesh.elements + 4 * e, *b = o->mesh.elements + 4 * f;
    size_t count = 0;
    int i, j;
    *in_e = *in_f = oracle_set_empty();
    for (i = 0; i < 4; i++) { /* face i holds all nodes but node i */
        int e_only = 1, f_only = 1;
        for (j = 0; j < 4; j++) {
            if (a[i] == b[j]) {
                e_only = 0;
                count++;
            }
            if (b[i] == a[j]) f_only = 0;
        }
        if (e_only) oracle_set_add(in_e, ORACLE_FACE + i);
        if (f_only) oracle_set_add(in_f, ORACLE_FACE + i);
    }
    return count;
}

static inline int oracle_same_contact(const oracle_contact *a, const oracle_contact *b) {
    return oracle_set_equal(&a->zero, &b->zero) && oracle_set_equal(&a->plus, &b->plus);
}

/* The faces of element g that meet in the nodes shared by e and f; returns 0 if g lacks one of these nodes */
static inline int oracle_faces_at(const oracle *o, size_t e, size_t f, size_t g, size_t shared, oracle_set *on) {
    const uint32_t *a = o->mesh.elements + 4 * e, *b = o->mesh.elements + 4 * f, *d = o->mesh.elements + 4 * g;
    size_t found = 0;
    int i, k;
    *on = oracle_set_empty();
    for (i = 0; i < 4; i++) {
        int in_a = 0, in_b = 0;
        for (k = 0; k < 4; k++) {
            in_a |= d[i] == a[k];
            in_b |= d[i] == b[k];
        }
        if (in_a && in_b)
            found++;
        else
            oracle_set_add(on, ORACLE_FACE + i);
    }
    return found == shared;
}

/* Does a wall touch the contact c, at faces `on` of element e? Then c is on the rim of a covered facet of a piece of
   e. */
static inline int oracle_touches_wall_in(const oracle *o, size_t e, const oracle_set *on, size_t shared,
                                         const oracle_contact *c) {
    size_t i;
    int k;
    for (i = o->element_pieces[e]; i < o->element_pieces[e + 1]; i++)
        for (k = 0; k < (int)o->plane_count; k++) {
            oracle_set facet = oracle_set_empty(), rim = *on;
            oracle_contact f, r;
            if (!oracle_set_has(&c->zero, k)) continue;
            oracle_set_add(&facet, k);
            oracle_set_add(&rim, k);
            f = oracle_contact_of(o, &o->pieces[i], &facet);
            r = oracle_contact_of(o, &o->pieces[i], &rim);
            if (f.count >= 3 && r.count >= shared && oracle_same_contact(c, &r) && oracle_covered(o, &f, 0)) return 1;
        }
    return 0;
}

/* Is the contact c of elements e and f unable to join them, because something removed touches it, or a sheet does?
   All elements with the shared nodes are examined. */
static inline int oracle_severed(const oracle *o, size_t e, size_t f, size_t shared, const oracle_contact *c) {
    size_t g, i;
    if (shared == 3) return oracle_covered(o, c, 0);
    if (ORACLE_TOUCH_FROM_OUTSIDE && oracle_covered(o, c, 0)) return 1;
    for (g = 0; g < o->mesh.element_count; g++) {
        oracle_set on;
        if (!oracle_faces_at(o, e, f, g, shared, &on)) continue;
        if (oracle_touches_wall_in(o, g, &on, shared, c)) return 1;
        for (i = o->element_pieces[g]; i < o->element_pieces[g + 1]; i++) {
            oracle_contact r;
            if (!o->pieces[i].removed) continue;
            r = oracle_contact_of(o, &o->pieces[i], &on);
            if (r.count >= shared && oracle_same_contact(c, &r)) return 1;
        }
    }
    return 0;
}

/* Joins the common parts of two elements: parts of a face, of an edge, or a node (shared = 3, 2, 1 nodes; a part of
   it has at least as many corners there). */
static inline void oracle_link_elements(oracle *o, size_t e, size_t f) {
    oracle_set in_e, in_f;
    size_t shared = oracle_shared(o, e, f, &in_e, &in_f), i, j;
    if (shared == 0 || shared == 4) return;
    for (i = o->element_pieces[e]; i < o->element_pieces[e + 1]; i++) {
        rat_mark mark = rat_arena_mark();
        oracle_contact c = oracle_contact_of(o, &o->pieces[i], &in_e);
        if (!o->pieces[i].removed && c.count >= shared && !oracle_severed(o, e, f, shared, &c))
            for (j = o->element_pieces[f]; j < o->element_pieces[f + 1]; j++) {
                oracle_contact d = oracle_contact_of(o, &o->pieces[j], &in_f);
                if (o->pieces[j].removed || d.count < shared || !oracle_same_contact(&c, &d)) continue;
                oracle_add_link(o, i, j);
            }
        rat_arena_release(mark);
    }
}

/* ---- copies and fragments ---- */

static inline int oracle_has_node(const oracle *o, size_t element, size_t node) {
    const uint32_t *n = o->mesh.elements + 4 * element;
    return n[0] == node || n[1] == node || n[2] == node || n[3] == node;
}

static inline size_t oracle_count_copies(const oracle *o, size_t node) {
    size_t *parent = oracle_singles(o->cell_count), count = 0, i;
    for (i = 0; i < o->link_count; i++) {
        const oracle_piece *p = &o->pieces[o->links[i].piece[0]], *q = &o->pieces[o->links[i].piece[1]];
        if (oracle_has_node(o, p->element, node) && oracle_has_node(o, q->element, node))
            oracle_join(parent, p->cell, q->cell);
    }
    for (i = 0; i < o->cell_count; i++)
        count += oracle_has_node(o, o->cell_element[i], node) && oracle_root(parent, i) == i;
    free(parent);
    return count;
}

static inline void oracle_find_fragments(oracle *o) {
    size_t i;
    o->cell_fragment = oracle_singles(o->cell_count);
    for (i = 0; i < o->link_count; i++)
        oracle_join(o->cell_fragment, o->pieces[o->links[i].piece[0]].cell, o->pieces[o->links[i].piece[1]].cell);
    o->fragment_count = oracle_number(o->cell_fragment, o->cell_count);
    o->fragment_volume = (double *)oracle_memory(NULL, o->fragment_count, sizeof *o->fragment_volume);
    for (i = 0; i < o->fragment_count; i++) o->fragment_volume[i] = 0;
    for (i = 0; i < o->cell_count; i++) {
        o->fragment_volume[o->cell_fragment[i]] += o->cell_volume[i];
        o->volume += o->cell_volume[i];
    }
}

static inline oracle *oracle_create(const oracle_mesh *mesh, const oracle_surface *surfaces, size_t surface_count) {
    oracle *o = (oracle *)oracle_memory(NULL, 0, sizeof *o);
    size_t e, f;
    memset(o, 0, sizeof *o);
    o->mark = rat_arena_mark();
    o->mesh = *mesh;
    o->element_pieces = (size_t *)oracle_memory(NULL, mesh->element_count, sizeof *o->element_pieces);
    o->element_pieces[0] = 0;
    oracle_find_planes(o, surfaces, surface_count);
    for (e = 0; e < mesh->element_count; e++) oracle_divide_element(o, e);
    oracle_remove(o, surfaces, surface_count);
    oracle_find_cells(o);
    for (e = 0; e < mesh->element_count; e++)
        for (f = e + 1; f < mesh->element_count; f++) oracle_link_elements(o, e, f);
    o->node_copies = (size_t *)oracle_memory(NULL, mesh->node_count, sizeof *o->node_copies);
    for (e = 0; e < mesh->node_count; e++) o->copy_count += o->node_copies[e] = oracle_count_copies(o, e);
    oracle_find_fragments(o);
    return o;
}

static inline void oracle_destroy(oracle *o) {
    rat_arena_release(o->mark);
    free(o->planes);
    free(o->triangles);
    free(o->points);
    free(o->corners);
    free(o->pieces);
    free(o->element_pieces);
    free(o->links);
    free(o->cell_element);
    free(o->cell_volume);
    free(o->cell_material);
    free(o->cell_fragment);
    free(o->node_copies);
    free(o->fragment_volume);
    free(o);
}

#endif /* GXFEM_TESTS_ORACLE_H */
