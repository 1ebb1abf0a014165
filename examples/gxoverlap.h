/* gxoverlap.h: how deep pieces are in each other, in themselves and in convex bodies. A measure for reports, tests and
   scenes: it takes triangles, and knows nothing of how contact is found or kept apart. Plain arrays in and out;
   includes nothing of ours.

   contents
     >>surface     what is measured: closed surfaces, and trees over their triangles
     >>distance    of points from triangles; triangles that meet
     >>inside      how often a surface winds around a point
     >>pieces      how deep pieces are in others
     >>itself      how deep a piece is in itself
     >>convex      how deep pieces are in convex bodies

   Depth. A point on the surface of one piece that is inside of another one is as deep as it is far from that one's
   surface. Vertices alone do not tell the largest depth: two edges may cross. So triangles are divided until the
   largest depth is known within a tolerance. The distance from one facet is convex, so on a triangle it is at most what
   it is at a corner; a triangle that meets no facet of the other surface is inside or outside as a whole. */
#ifndef GXOVERLAP_H
#define GXOVERLAP_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------- >>surface */

/* Triangles, counterclockwise from outside, whose pieces are closed; vertices at one place count as one. */
typedef struct gxoverlap_surface {
    const double *positions;   /* x 3, m */
    const uint32_t *triangles; /* triangle_count x 3 */
    const uint32_t *pieces;    /* triangle_count */
    size_t triangle_count;
} gxoverlap_surface;

typedef struct gxoverlap {
    double depth;          /* m; 0: there is no overlap */
    double position[3];    /* where; 0 if nowhere */
    uint32_t piece, other; /* its surface is there; what it is in; both 0 if nowhere */
} gxoverlap;

typedef struct gxoverlap_box { /* in preorder */
    double low[3], high[3];
    uint32_t first, count; /* of a leaf: its triangles, in order; else count is 0 */
    uint32_t next;         /* the box after all that are in this one */
} gxoverlap_box;

typedef struct gxoverlap_key {
    double at;
    uint32_t triangle, piece;
} gxoverlap_key;

/* One tree for each piece */
typedef struct gxoverlap_forest {
    const gxoverlap_surface *surface;
    gxoverlap_key *keys;  /* triangle_count: triangles in order of the leaves */
    gxoverlap_box *boxes; /* box_count */
    uint32_t *roots;      /* root_count + 1, into boxes */
    uint32_t *pieces;     /* root_count */
    uint32_t box_count, root_count;
} gxoverlap_forest;

enum { GXOVERLAP_LEAF = 4 };

static inline const double *gxoverlap_corner(const gxoverlap_surface *s, size_t triangle, int corner) {
    return s->positions + 3 * (size_t)s->triangles[3 * triangle + (size_t)corner];
}

static inline int gxoverlap_compare(const void *a, const void *b) {
    const gxoverlap_key *x = (const gxoverlap_key *)a, *y = (const gxoverlap_key *)b;
    if (x->piece != y->piece) return x->piece < y->piece ? -1 : 1;
    if (x->at != y->at) return x->at < y->at ? -1 : 1;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static inline void gxoverlap_enclose(double low[3], double high[3], const double x[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = fmin(low[k], x[k]);
        high[k] = fmax(high[k], x[k]);
    }
}

static inline void gxoverlap_empty(double low[3], double high[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = HUGE_VAL;
        high[k] = -HUGE_VAL;
    }
}

/* Adds the boxes of keys[first ...]: halves along the longest side of the box around them. */
static inline void gxoverlap_grow(gxoverlap_forest *f, uint32_t first, uint32_t count) {
    const uint32_t own = f->box_count++;
    gxoverlap_box *box = &f->boxes[own];
    uint32_t i;
    int k, axis = 0;
    gxoverlap_empty(box->low, box->high);
    for (i = first; i < first + count; i++)
        for (k = 0; k < 3; k++)
            gxoverlap_enclose(box->low, box->high, gxoverlap_corner(f->surface, f->keys[i].triangle, k));
    box->first = first;
    box->count = count <= GXOVERLAP_LEAF ? count : 0;
    if (count > GXOVERLAP_LEAF) {
        for (k = 1; k < 3; k++)
            if (box->high[k] - box->low[k] > box->high[axis] - box->low[axis]) axis = k;
        for (i = first; i < first + count; i++)
            for (f->keys[i].at = 0, k = 0; k < 3; k++)
                f->keys[i].at += gxoverlap_corner(f->surface, f->keys[i].triangle, k)[axis];
        qsort(f->keys + first, count, sizeof *f->keys, gxoverlap_compare);
        gxoverlap_grow(f, first, count / 2);
        gxoverlap_grow(f, first + count / 2, count - count / 2);
    }
    f->boxes[own].next = f->box_count;
}

static inline void gxoverlap_release(gxoverlap_forest *f) {
    free(f->keys);
    free(f->boxes);
    free(f->roots);
    free(f->pieces);
    memset(f, 0, sizeof *f);
}

/* 0: no memory, or more than 2^30 triangles. gxoverlap_release frees it; the surface must stay as long. */
static inline int gxoverlap_make(gxoverlap_forest *f, const gxoverlap_surface *surface) {
    const size_t n = surface->triangle_count;
    size_t i, first;
    memset(f, 0, sizeof *f);
    f->surface = surface;
    if (n > (size_t)1 << 30) return 0;
    f->keys = (gxoverlap_key *)calloc(n + 1, sizeof *f->keys);
    f->boxes = (gxoverlap_box *)malloc((2 * n + 1) * sizeof *f->boxes);
    f->roots = (uint32_t *)malloc((n + 1) * sizeof *f->roots);
    f->pieces = (uint32_t *)malloc((n + 1) * sizeof *f->pieces);
    if (!f->keys || !f->boxes || !f->roots || !f->pieces) {
        gxoverlap_release(f);
        return 0;
    }
    for (i = 0; i < n; i++) {
        f->keys[i].triangle = (uint32_t)i;
        f->keys[i].piece = surface->pieces[i];
    }
    qsort(f->keys, n, sizeof *f->keys, gxoverlap_compare);
    for (first = 0; first < n; first = i) {
        for (i = first; i < n && f->keys[i].piece == f->keys[first].piece; i++) {}
        f->pieces[f->root_count] = f->keys[first].piece;
        f->roots[f->root_count++] = f->box_count;
        gxoverlap_grow(f, (uint32_t)first, (uint32_t)(i - first));
    }
    f->roots[f->root_count] = f->box_count;
    return 1;
}

/* --------------------------------------------------------------------------------------------- >>distance */

static inline double gxoverlap_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void gxoverlap_cross(const double a[3], const double b[3], double r[3]) {
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void gxoverlap_less(const double a[3], const double b[3], double r[3]) {
    int k;
    for (k = 0; k < 3; k++) r[k] = a[k] - b[k];
}

/* Twice the area of a triangle, along its normal */
static inline void gxoverlap_normal(const double *const c[3], double n[3]) {
    double u[3], v[3];
    gxoverlap_less(c[1], c[0], u);
    gxoverlap_less(c[2], c[0], v);
    gxoverlap_cross(u, v, n);
}

/* Squares of distances. */
static inline double gxoverlap_from_segment(const double p[3], const double a[3], const double b[3]) {
    double way[3], off[3], length, share;
    int k;
    gxoverlap_less(b, a, way);
    gxoverlap_less(p, a, off);
    length = gxoverlap_dot(way, way);
    share = length > 0 ? fmin(fmax(gxoverlap_dot(way, off) / length, 0.0), 1.0) : 0.0;
    for (k = 0; k < 3; k++) off[k] -= share * way[k];
    return gxoverlap_dot(off, off);
}

/* From the plane if the foot is inside, else from an edge */
static inline double gxoverlap_from_triangle(const double p[3], const double *const c[3]) {
    double n[3], off[3], edge[3], aside[3], height, square, best = HUGE_VAL;
    int i, inside = 1;
    gxoverlap_normal(c, n);
    square = gxoverlap_dot(n, n);
    for (i = 0; i < 3; i++) {
        gxoverlap_less(c[(i + 1) % 3], c[i], edge);
        gxoverlap_less(p, c[i], off);
        gxoverlap_cross(edge, off, aside);
        inside &= gxoverlap_dot(aside, n) >= 0;
    }
    height = gxoverlap_dot(off, n);
    if (inside && square > 0) return height * height / square;
    for (i = 0; i < 3; i++) best = fmin(best, gxoverlap_from_segment(p, c[i], c[(i + 1) % 3]));
    return best;
}

static inline double gxoverlap_from_box(const double p[3], const gxoverlap_box *box) {
    double square = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const double d = fmax(fmax(box->low[k] - p[k], p[k] - box->high[k]), 0.0);
        square += d * d;
    }
    return square;
}

static inline void gxoverlap_take(const gxoverlap_forest *f, uint32_t place, const double *c[3]) {
    int k;
    for (k = 0; k < 3; k++) c[k] = gxoverlap_corner(f->surface, f->keys[place].triangle, k);
}

/* The facet of a piece that is nearest to p; turned: only those whose normals are off it by 60 degrees or more; or
   NULL. place: a first guess and the answer, into keys. The distance; HUGE_VAL: there is none. */
static inline double gxoverlap_nearest(const gxoverlap_forest *f, uint32_t root, const double p[3],
                                       const double *turned, uint32_t *place) {
    double best = HUGE_VAL;
    const double *c[3];
    double n[3];
    uint32_t b, i;
    if (*place != UINT32_MAX) {
        gxoverlap_take(f, *place, c);
        best = gxoverlap_from_triangle(p, c);
    }
    for (b = f->roots[root]; b < f->roots[root + 1];) {
        const gxoverlap_box *box = &f->boxes[b];
        if (gxoverlap_from_box(p, box) >= best) {
            b = box->next;
            continue;
        }
        for (i = box->first; i < box->first + box->count; i++) {
            double square;
            gxoverlap_take(f, i, c);
            if (turned) {
                gxoverlap_normal(c, n);
                if (gxoverlap_dot(n, turned) > 0.5 * sqrt(gxoverlap_dot(n, n) * gxoverlap_dot(turned, turned)))
                    continue;
            }
            square = gxoverlap_from_triangle(p, c);
            if (square < best) {
                best = square;
                *place = i;
            }
        }
        b++;
    }
    return sqrt(best);
}

/* Does the segment from a to b go through the triangle, or touch it? Of those in one plane: no. */
static inline int gxoverlap_pierces(const double a[3], const double b[3], const double *const c[3]) {
    double n[3], to_a[3], to_b[3], way[3], edge[3], off[3], aside[3], from, to;
    int i, left = 0, right = 0;
    gxoverlap_normal(c, n);
    gxoverlap_less(a, c[0], to_a);
    gxoverlap_less(b, c[0], to_b);
    from = gxoverlap_dot(to_a, n);
    to = gxoverlap_dot(to_b, n);
    if ((from > 0 && to > 0) || (from < 0 && to < 0) || from == to) return 0;
    gxoverlap_less(b, a, way);
    for (i = 0; i < 3; i++) {
        gxoverlap_less(c[(i + 1) % 3], c[i], edge);
        gxoverlap_less(a, c[i], off);
        gxoverlap_cross(edge, off, aside);
        from = gxoverlap_dot(aside, way);
        left |= from < 0;
        right |= from > 0;
    }
    return !(left && right);
}

/* Does a triangle meet a facet of the piece? */
static inline int gxoverlap_meets(const gxoverlap_forest *f, uint32_t root, const double *const t[3]) {
    double low[3], high[3];
    const double *c[3];
    uint32_t b, i;
    int k, apart;
    gxoverlap_empty(low, high);
    for (k = 0; k < 3; k++) gxoverlap_enclose(low, high, t[k]);
    for (b = f->roots[root]; b < f->roots[root + 1];) {
        const gxoverlap_box *box = &f->boxes[b];
        for (k = 0, apart = 0; k < 3; k++) apart |= box->low[k] > high[k] || box->high[k] < low[k];
        if (apart) {
            b = box->next;
            continue;
        }
        for (i = box->first; i < box->first + box->count; i++) {
            gxoverlap_take(f, i, c);
            for (k = 0; k < 3; k++)
                if (gxoverlap_pierces(t[k], t[(k + 1) % 3], c) || gxoverlap_pierces(c[k], c[(k + 1) % 3], t)) return 1;
        }
        b++;
    }
    return 0;
}

/* ----------------------------------------------------------------------------------------------- >>inside */

/* Does the ray from p meet a triangle? 1: from inside out; -1: from outside in; 0: no; 2: too near its rim to tell. */
static inline int gxoverlap_crosses(const double p[3], const double ray[3], const double *const c[3]) {
    const double rim = 1e-10; /* of the triangle: beyond what rounding makes of its sides */
    double u[3], v[3], off[3], n[3], across[3], det, a, b, t;
    gxoverlap_less(c[1], c[0], u);
    gxoverlap_less(c[2], c[0], v);
    gxoverlap_less(p, c[0], off);
    gxoverlap_cross(u, v, n);
    det = -gxoverlap_dot(ray, n);
    gxoverlap_cross(off, ray, across);
    a = gxoverlap_dot(v, across);
    b = -gxoverlap_dot(u, across);
    t = gxoverlap_dot(off, n);
    if (det < 0) {
        a = -a;
        b = -b;
        t = -t;
    }
    {
        const double size = fabs(det), slack = rim * size;
        if (a < -slack || b < -slack || a + b > size + slack || t <= 0) return 0;
        if (a < slack || b < slack || a + b > size - slack) return 2;
    }
    return det < 0 ? 1 : -1;
}

/* Does the box lie on the ray? */
static inline int gxoverlap_hits_box(const double p[3], const double ray[3], const gxoverlap_box *box) {
    double from = 0, to = HUGE_VAL;
    int k;
    for (k = 0; k < 3; k++) {
        const double a = (box->low[k] - p[k]) / ray[k], b = (box->high[k] - p[k]) / ray[k];
        from = fmax(from, fmin(a, b));
        to = fmin(to, fmax(a, b));
    }
    return from <= to * (1 + 1e-12) + 1e-300;
}

/* How often the piece winds around p, by the crossings of a ray; skipped: a triangle that does not count, or
   UINT32_MAX; outward: the ray goes to that side; or NULL. A ray that passes a rim is replaced by another one. */
static inline int gxoverlap_winding(const gxoverlap_forest *f, uint32_t root, const double p[3], uint32_t skipped,
                                    const double *outward) {
    uint32_t seed = 12345, b, i;
    int winding = 0, tries, k, met;
    for (tries = 0; tries < 32; tries++) {
        double ray[3];
        const double *c[3];
        for (k = 0; k < 3; k++) {
            seed = seed * 1664525u + 1013904223u;
            ray[k] = ((double)(seed >> 8) + 0.5) / 8388608.0 - 1.0;
        }
        if (outward && gxoverlap_dot(ray, outward) < 0)
            for (k = 0; k < 3; k++) ray[k] = -ray[k];
        winding = met = 0;
        for (b = f->roots[root]; b < f->roots[root + 1] && met != 2;) {
            const gxoverlap_box *box = &f->boxes[b];
            if (!gxoverlap_hits_box(p, ray, box)) {
                b = box->next;
                continue;
            }
            for (i = box->first; i < box->first + box->count && met != 2; i++) {
                if (f->keys[i].triangle == skipped) continue;
                gxoverlap_take(f, i, c);
                met = gxoverlap_crosses(p, ray, c);
                winding += met;
            }
            b++;
        }
        if (met != 2) return winding;
    }
    return winding;
}

/* ----------------------------------------------------------------------------------------------- >>pieces */

static inline void gxoverlap_tell(gxoverlap *most, double depth, const double p[3], uint32_t piece, uint32_t other) {
    if (!(depth > most->depth)) return;
    most->depth = depth;
    memcpy(most->position, p, sizeof most->position);
    most->piece = piece;
    most->other = other;
}

/* One of the four parts of a triangle: a corner's, or, 3, the middle one */
static inline void gxoverlap_part(const double *const c[3], int part, double to[3][3]) {
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) to[i][k] = 0.5 * (part == 3 ? c[i][k] + c[(i + 1) % 3][k] : c[part][k] + c[i][k]);
}

enum { GXOVERLAP_DIVISIONS = 24 }; /* of a triangle at most, each into halves: rounding is reached before */

/* The largest depth of a triangle of `piece` in the one of root */
static inline void gxoverlap_sink(const gxoverlap_forest *f, uint32_t root, const double *const c[3], uint32_t piece,
                                  double tolerance, uint32_t guess, int divisions, gxoverlap *most) {
    double middle[3], distance, bound = 0;
    const double *facet[3];
    double part[3][3];
    const double *parts[3];
    int i, k, inside;
    for (k = 0; k < 3; k++) middle[k] = (c[0][k] + c[1][k] + c[2][k]) / 3;
    distance = gxoverlap_nearest(f, root, middle, NULL, &guess);
    gxoverlap_take(f, guess, facet);
    for (i = 0; i < 3; i++) bound = fmax(bound, gxoverlap_from_triangle(c[i], facet));
    if (sqrt(bound) <= most->depth + tolerance) return;
    inside = gxoverlap_winding(f, root, middle, UINT32_MAX, NULL) > 0;
    if (inside) gxoverlap_tell(most, distance, middle, piece, f->pieces[root]);
    if (divisions == 0 || (!inside && !gxoverlap_meets(f, root, c))) return;
    for (i = 0; i < 4; i++) {
        gxoverlap_part(c, i, part);
        for (k = 0; k < 3; k++) parts[k] = part[k];
        gxoverlap_sink(f, root, parts, piece, tolerance, guess, divisions - 1, most);
    }
}

/* The same of all triangles of a piece that are within the box around another one */
static inline void gxoverlap_of_pair(const gxoverlap_forest *f, uint32_t own, uint32_t other, double tolerance,
                                     gxoverlap *most) {
    const gxoverlap_box *around = &f->boxes[f->roots[other]];
    uint32_t b, i;
    int k, apart;
    for (b = f->roots[own]; b < f->roots[own + 1];) {
        const gxoverlap_box *box = &f->boxes[b];
        for (k = 0, apart = 0; k < 3; k++) apart |= around->low[k] > box->high[k] || around->high[k] < box->low[k];
        if (apart) {
            b = box->next;
            continue;
        }
        for (i = box->first; i < box->first + box->count; i++) {
            const double *c[3];
            gxoverlap_take(f, i, c);
            gxoverlap_sink(f, other, c, f->pieces[own], tolerance, UINT32_MAX, GXOVERLAP_DIVISIONS, most);
        }
        b++;
    }
}

/* The largest depth of a piece in another one, within a tolerance, m, above 0. It is found coarsely first: what is not
   deeper needs no division then. */
static inline gxoverlap gxoverlap_of_pieces(const gxoverlap_forest *f, double tolerance) {
    gxoverlap most;
    uint32_t own, other;
    int round;
    memset(&most, 0, sizeof most);
    for (round = 6; round >= 0; round--)
        for (own = 0; own < f->root_count; own++)
            for (other = 0; other < f->root_count; other++)
                if (own != other) gxoverlap_of_pair(f, own, other, ldexp(tolerance, 2 * round), &most);
    return most;
}

/* ----------------------------------------------------------------------------------------------- >>itself */

/* The normal of a triangle; 0: its corners are in a line but for rounding, and do not tell where its front is. */
static inline int gxoverlap_has_front(const double *const c[3], double n[3]) {
    double edge[3], longest = 0;
    int i;
    for (i = 0; i < 3; i++) {
        gxoverlap_less(c[(i + 1) % 3], c[i], edge);
        longest = fmax(longest, gxoverlap_dot(edge, edge));
    }
    gxoverlap_normal(c, n);
    return sqrt(gxoverlap_dot(n, n)) > 1e-7 * longest;
}

/* The largest depth of a piece in itself, at four points of each triangle: what lies in front of one there is inside.
   It is as deep as the nearest surface is far that does not lie like the triangle: at most as the piece is thick, or
   as the next crease is far. */
static inline gxoverlap gxoverlap_of_itself(const gxoverlap_forest *f) {
    gxoverlap most;
    uint32_t root, i, place;
    int at, k;
    memset(&most, 0, sizeof most);
    for (root = 0; root < f->root_count; root++) {
        const gxoverlap_box *all = &f->boxes[f->roots[root]];
        const uint32_t first = all->first, last = root + 1 < f->root_count ? f->boxes[f->roots[root + 1]].first
                                                                           : (uint32_t)f->surface->triangle_count;
        for (i = first; i < last; i++)
            for (at = 0; at < 4; at++) {
                const double *c[3];
                double n[3], p[3];
                gxoverlap_take(f, i, c);
                if (!gxoverlap_has_front(c, n)) break;
                for (k = 0; k < 3; k++) {
                    p[k] = (c[0][k] + c[1][k] + c[2][k]) / 3;
                    if (at < 3) p[k] += 0.9 * (c[at][k] - p[k]);
                }
                if (gxoverlap_winding(f, root, p, f->keys[i].triangle, n) <= 0) continue;
                place = UINT32_MAX;
                gxoverlap_tell(&most, gxoverlap_nearest(f, root, p, n, &place), p, f->pieces[root], f->pieces[root]);
            }
    }
    return most;
}

/* ----------------------------------------------------------------------------------------------- >>convex */

/* Signed distance of a point from a convex body, m, below 0 inside; gradient: receives its gradient, of length 1. */
typedef double (*gxoverlap_fn)(const void *body, const double position[3], double gradient[3]);

/* body: a double, the height of the ground, m, which is all below */
static inline double gxoverlap_from_ground(const void *body, const double position[3], double gradient[3]) {
    gradient[0] = gradient[1] = 0;
    gradient[2] = 1;
    return position[2] - *(const double *)body;
}

/* All that is within a radius of a box: balls, capsules, boxes. x = R X + o takes its own frame to space. */
typedef struct gxoverlap_round {
    double pose[12];        /* three rows of R o */
    double half[3], radius; /* m: half the edges of the box */
} gxoverlap_round;
static inline double gxoverlap_from_round(const void *body, const double position[3], double gradient[3]) {
    const gxoverlap_round *round = (const gxoverlap_round *)body;
    double own[3], way[3], distance = 0, most = -HUGE_VAL;
    int i, k, side = 0;
    for (i = 0; i < 3; i++) {
        for (own[i] = 0, k = 0; k < 3; k++) own[i] += round->pose[4 * k + i] * (position[k] - round->pose[4 * k + 3]);
        way[i] = own[i] - fmin(fmax(own[i], -round->half[i]), round->half[i]);
        if (fabs(own[i]) - round->half[i] > most) {
            most = fabs(own[i]) - round->half[i];
            side = i;
        }
    }
    distance = sqrt(gxoverlap_dot(way, way));
    if (!(distance > 0)) { /* in the box: out by its nearest face */
        way[side] = own[side] < 0 ? -1 : 1;
        distance = most;
    }
    for (k = 0; k < 3; k++) gradient[k] = gxoverlap_dot(round->pose + 4 * k, way) / sqrt(gxoverlap_dot(way, way));
    return distance - round->radius;
}

/* The distance of a convex body is convex, so it is nowhere below its tangent: a triangle is at most as deep. */
static inline void gxoverlap_sink_convex(const double *const c[3], gxoverlap_fn distance, const void *body,
                                         uint32_t piece, double tolerance, int divisions, gxoverlap *most) {
    double middle[3], gradient[3], off[3], part[3][3], depth, bound = -HUGE_VAL;
    const double *parts[3];
    int i, k;
    for (i = 0; i < 3; i++) gxoverlap_tell(most, -distance(body, c[i], gradient), c[i], piece, 0);
    for (k = 0; k < 3; k++) middle[k] = (c[0][k] + c[1][k] + c[2][k]) / 3;
    depth = -distance(body, middle, gradient);
    for (i = 0; i < 3; i++) {
        gxoverlap_less(c[i], middle, off);
        bound = fmax(bound, depth - gxoverlap_dot(gradient, off));
    }
    if (bound <= most->depth + tolerance || divisions == 0) return;
    for (i = 0; i < 4; i++) {
        gxoverlap_part(c, i, part);
        for (k = 0; k < 3; k++) parts[k] = part[k];
        gxoverlap_sink_convex(parts, distance, body, piece, tolerance, divisions - 1, most);
    }
}

/* The largest depth of pieces in a convex body, within a tolerance, m, above 0; its `other` is 0. */
static inline gxoverlap gxoverlap_in_convex(const gxoverlap_surface *s, gxoverlap_fn distance, const void *body,
                                            double tolerance) {
    gxoverlap most;
    size_t t;
    memset(&most, 0, sizeof most);
    for (t = 0; t < s->triangle_count; t++) {
        const double *c[3];
        int k;
        for (k = 0; k < 3; k++) c[k] = gxoverlap_corner(s, t, k);
        gxoverlap_sink_convex(c, distance, body, s->pieces[t], tolerance, GXOVERLAP_DIVISIONS, &most);
    }
    return most;
}

#endif
