/* rxfem.h - RXFEM, a baseline: Koschier, Bender, Thuerey, Robust eXtended Finite Elements for Complex Cutting of
   Deformables (2017).

   Oriented, manifold triangle surfaces cut a tetrahedral mesh. The intersection path tells which elements and
   one-rings they cut completely (section 4.3). Nodes get a shifted sign enrichment for each patch that separates
   their one-ring (Eq. 10). Each side of a cut element gets a quadrature rule by hierarchical moment fitting (section
   5): Gauss rules on the parts of edges, from these rules on faces, from these rules on the volume, each over an
   interface rule in a divergence-free basis. Section 6: perturbation, constrained functions, preconditioner.

   It refuses what it cannot do: surfaces that cross within an element, T-junctions, and surfaces that are not
   manifold or not oriented alike (the paper's limitations). An element that is cut partly stays whole.

   Choices made here where the paper leaves something open:
       signs            exact (gxb_orient3d), as section 6 suggests. If one is 0, its vertices are moved at random by
                        RX_PERTURBATION of the mesh's box, and the cut is tried again
       degrees          2 in the volume (the highest in Eq. 11, 12) on 24 points; so 3 on faces (19 points; their
                        antiderivatives are the flux of volume moments) and for the interface in the volume, 4 for
                        the interface in a face. Points: at least twice as many as functions; otherwise the largest
                        segments and triangles are halved
       antiderivatives  the mean over the axes of the integrals along each, so that their divergence is the
                        polynomial
       clipping         rx_rules.clip 0: points lie on whole triangles and segments, as in the paper's last paragraph
                        of section 5; 1: only on their parts inside the element
       signed distance  only its sign is used: counted along the element's edges, from where they cross the surface
                        and in which direction

   Include after the implementation of gxfem_boolean.h. Out of memory ends the program. */
#ifndef BENCH_RXFEM_H
#define BENCH_RXFEM_H

#include "rxfem_rules.h"
#include "splitmix.h"

#include <stdint.h>

enum { RX_NONE = -1 };

static const double RX_PERTURBATION = 1e-10; /* of the mesh's box */

typedef enum rx_result {
    RX_OK = 0,
    RX_ERROR_CROSSING,   /* surfaces cross, touch or end on each other within an element */
    RX_ERROR_MANIFOLD,   /* three triangles at an edge, or two that are not oriented alike */
    RX_ERROR_DEGENERATE, /* signs stay 0 or contradict each other after all perturbations */
    RX_ERROR_LIMIT       /* more patches in one element than there are bits */
} rx_result;

/* ---- a cut mesh ---- */

/* Counter-clockwise triangles are seen from the plus side. */
typedef struct rx_surface {
    /* x 3 */
    const double *vertices;
    size_t vertex_count;
    /* x 3 */
    const uint32_t *triangles;
    size_t triangle_count;
} rx_surface;

/* A triangle meets an element. Bits, all from exact signs: */
typedef struct rx_contact {
    uint32_t element, triangle;
    unsigned outside; /* 4 v + k: vertex v is outside of face k */
    unsigned pierced; /* 4 v + k: triangle edge v, v + 1 pierces face k */
    unsigned edges;   /* e: element edge e pierces the triangle */
    unsigned front;   /* i: corner i is in front of the triangle's plane */
    uint32_t patch;
} rx_contact;

/* Triangles that are connected within an element */
typedef struct rx_patch {
    uint32_t element, cut;
    size_t first, count;        /* in rx_body.members: contacts */
    unsigned faces;             /* bit k: it meets face k */
    unsigned open;              /* bit k: a rim edge of the surface pierces face k: the intersection path ends there */
    unsigned plus;              /* bit i: corner i is on the plus side */
    int enrichment[4];          /* of each corner; RX_NONE */
    double point[3];            /* one of its own, in the element */
    double moments[RX_MOMENTS]; /* of its plus side in the reference frame */
} rx_patch;

/* A complete patch divides its element: its path is closed. */
static inline int rx_patch_is_complete(const rx_patch *p) { return p->faces != 0 && p->open == 0; }

/* plus: the side that its node is on */
typedef struct rx_enrichment {
    uint32_t node, cut;
    int plus;
} rx_enrichment;

/* A part of an element after all cuts; bit p of plus: it is on the plus side of the element's p-th complete patch */
typedef struct rx_piece {
    uint32_t element;
    uint64_t plus;
    double moments[RX_MOMENTS];
} rx_piece;

typedef struct rx_body {
    rx_rules *rules;             /* borrowed */
    double (*clock)(void *user); /* NULL: times stay 0 */
    size_t node_count, element_count;
    double *positions;           /* x 3 */
    uint32_t *elements;          /* x 4 */
    uint32_t *neighbours;        /* x 4: element across face k; UINT32_MAX */
    uint32_t *ring_first, *ring; /* node_count + 1; elements around each node */
    /* of all cuts, as perturbed */
    double *vertices;
    size_t vertex_count;
    uint32_t *triangles, *triangle_neighbours, *triangle_cut; /* x 3: across edge v, v + 1; UINT32_MAX at the rim */
    size_t triangle_count;
    /* of each cut by element, then triangle */
    rx_contact *contacts;
    size_t contact_count;
    size_t *members;    /* contact_count: by patch */
    size_t *by_element; /* contacts of earlier cuts, for the search for crossings */
    rx_patch *patches;
    size_t patch_count;
    uint32_t *patch_first; /* element_count + 1: complete patches of each element, in patch_list */
    uint32_t *patch_list;
    rx_enrichment *enrichments;
    size_t enrichment_count;
    rx_piece *pieces;
    size_t piece_count;
    uint32_t *piece_first; /* element_count + 1 */
    uint32_t cut_count;
    size_t perturbed;                   /* vertices that were moved */
    double seconds_path, seconds_rules; /* of all cuts */
} rx_body;

static inline const double *rx_corner(const rx_body *b, uint32_t element, int k) {
    return b->positions + 3 * (size_t)b->elements[4 * element + (uint32_t)k];
}

static inline const double *rx_vertex(const rx_body *b, uint32_t triangle, int v) {
    return b->vertices + 3 * (size_t)b->triangles[3 * triangle + (uint32_t)v];
}

static inline double rx_now(const rx_body *b) { return b->clock ? b->clock(NULL) : 0; }

static int rx_compare_words(const void *a, const void *b) {
    const uint32_t *x = (const uint32_t *)a, *y = (const uint32_t *)b;
    int i;
    for (i = 0; i < 3; i++)
        if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
    return 0;
}

/* Pairs elements by the sorted nodes of their faces. */
static inline void rx_find_neighbours(rx_body *b) {
    const size_t count = 4 * b->element_count;
    uint32_t(*faces)[4] = (uint32_t(*)[4])dense_memory(NULL, count, sizeof *faces);
    size_t i;
    int k, v;
    for (i = 0; i < count; i++) {
        uint32_t *f = faces[i];
        for (v = 0, k = 0; k < 4; k++) {
            if ((size_t)k == i % 4) continue;
            f[v++] = b->elements[i - i % 4 + (size_t)k];
        }
        for (v = 0; v < 3; v++)
            if (f[v % 2] > f[v % 2 + 1]) {
                const uint32_t kept = f[v % 2];
                f[v % 2] = f[v % 2 + 1];
                f[v % 2 + 1] = kept;
            }
        f[3] = (uint32_t)i;
        b->neighbours[i] = UINT32_MAX;
    }
    qsort(faces, count, sizeof *faces, rx_compare_words);
    for (i = 0; i + 1 < count; i++)
        if (rx_compare_words(faces[i], faces[i + 1]) == 0) {
            b->neighbours[faces[i][3]] = faces[i + 1][3] / 4;
            b->neighbours[faces[i + 1][3]] = faces[i][3] / 4;
        }
    free(faces);
}

static inline void rx_find_rings(rx_body *b) {
    size_t i;
    memset(b->ring_first, 0, (b->node_count + 1) * sizeof *b->ring_first);
    for (i = 0; i < 4 * b->element_count; i++) b->ring_first[b->elements[i]]++;
    for (i = 1; i <= b->node_count; i++) b->ring_first[i] += b->ring_first[i - 1];
    for (i = 4 * b->element_count; i-- > 0;) b->ring[--b->ring_first[b->elements[i]]] = (uint32_t)(i / 4);
}

static inline void rx_divide(rx_body *b);

/* Copies the mesh; elements have positive volume. rules outlive the body. */
static inline rx_body *rx_body_create(rx_rules *rules, const double *positions, size_t node_count,
                                      const uint32_t *elements, size_t element_count) {
    rx_body *b = (rx_body *)dense_memory(NULL, 1, sizeof *b);
    memset(b, 0, sizeof *b);
    b->rules = rules;
    b->node_count = node_count;
    b->element_count = element_count;
    b->positions = (double *)dense_memory(NULL, 3 * node_count, sizeof(double));
    b->elements = (uint32_t *)dense_memory(NULL, 4 * element_count, sizeof(uint32_t));
    b->neighbours = (uint32_t *)dense_memory(NULL, 4 * element_count, sizeof(uint32_t));
    b->ring = (uint32_t *)dense_memory(NULL, 4 * element_count, sizeof(uint32_t));
    b->ring_first = (uint32_t *)dense_memory(NULL, node_count + 1, sizeof(uint32_t));
    b->patch_first = (uint32_t *)dense_memory(NULL, element_count + 1, sizeof(uint32_t));
    b->piece_first = (uint32_t *)dense_memory(NULL, element_count + 1, sizeof(uint32_t));
    memcpy(b->positions, positions, 3 * node_count * sizeof(double));
    memcpy(b->elements, elements, 4 * element_count * sizeof(uint32_t));
    rx_find_neighbours(b);
    rx_find_rings(b);
    rx_divide(b);
    return b;
}

static inline void rx_body_destroy(rx_body *b) {
    if (!b) return;
    free(b->positions);
    free(b->elements);
    free(b->neighbours);
    free(b->ring);
    free(b->ring_first);
    free(b->vertices);
    free(b->triangles);
    free(b->triangle_neighbours);
    free(b->triangle_cut);
    free(b->contacts);
    free(b->members);
    free(b->by_element);
    free(b->patches);
    free(b->patch_first);
    free(b->patch_list);
    free(b->enrichments);
    free(b->pieces);
    free(b->piece_first);
    free(b);
}

/* ---- the surface ---- */

/* Pairs triangles by their edges. The two must pass the edge in opposite directions. */
static inline rx_result rx_pair_triangles(rx_body *b, size_t first) {
    const size_t count = 3 * (b->triangle_count - first);
    uint32_t(*edges)[4] = (uint32_t(*)[4])dense_memory(NULL, count, sizeof *edges);
    rx_result result = RX_OK;
    size_t i;
    for (i = 0; i < count; i++) {
        const uint32_t p = b->triangles[3 * first + i], q = b->triangles[3 * first + i - i % 3 + (i + 1) % 3];
        edges[i][0] = p < q ? p : q;
        edges[i][1] = p < q ? q : p;
        edges[i][2] = p < q;
        edges[i][3] = (uint32_t)(3 * first + i);
        b->triangle_neighbours[3 * first + i] = UINT32_MAX;
    }
    qsort(edges, count, sizeof *edges, rx_compare_words);
    for (i = 0; i + 1 < count; i++) {
        if (edges[i][0] != edges[i + 1][0] || edges[i][1] != edges[i + 1][1]) continue;
        if (edges[i][2] == edges[i + 1][2]) result = RX_ERROR_MANIFOLD;
        if (i > 0 && edges[i][0] == edges[i - 1][0] && edges[i][1] == edges[i - 1][1]) result = RX_ERROR_MANIFOLD;
        b->triangle_neighbours[edges[i][3]] = edges[i + 1][3] / 3;
        b->triangle_neighbours[edges[i + 1][3]] = edges[i][3] / 3;
    }
    free(edges);
    return result;
}

static inline rx_result rx_add_surface(rx_body *b, const rx_surface *s) {
    const size_t first = b->triangle_count, total = first + s->triangle_count;
    size_t i;
    b->vertices = (double *)dense_memory(b->vertices, 3 * (b->vertex_count + s->vertex_count), sizeof(double));
    b->triangles = (uint32_t *)dense_memory(b->triangles, 3 * total, sizeof(uint32_t));
    b->triangle_neighbours = (uint32_t *)dense_memory(b->triangle_neighbours, 3 * total, sizeof(uint32_t));
    b->triangle_cut = (uint32_t *)dense_memory(b->triangle_cut, total, sizeof(uint32_t));
    memcpy(b->vertices + 3 * b->vertex_count, s->vertices, 3 * s->vertex_count * sizeof(double));
    for (i = 0; i < 3 * s->triangle_count; i++)
        b->triangles[3 * first + i] = s->triangles[i] + (uint32_t)b->vertex_count;
    for (i = first; i < total; i++) b->triangle_cut[i] = b->cut_count;
    b->vertex_count += s->vertex_count;
    b->triangle_count = total;
    return rx_pair_triangles(b, first);
}

/* ---- 4.3: the intersection path ---- */

/* 1: x is in front of the triangle, from where it is counter-clockwise; -1 behind, 0 in its plane */
static inline int rx_side(const double *p, const double *q, const double *r, const double *x) {
    return -gxb_orient3d(p, q, r, x);
}

static inline int rx_boxes_apart(const double *const *a, int m, const double *const *b, int n) {
    int axis, i;
    for (axis = 0; axis < 3; axis++) {
        double low[2], high[2];
        low[0] = high[0] = a[0][axis];
        low[1] = high[1] = b[0][axis];
        for (i = 1; i < m; i++) {
            low[0] = fmin(low[0], a[i][axis]);
            high[0] = fmax(high[0], a[i][axis]);
        }
        for (i = 1; i < n; i++) {
            low[1] = fmin(low[1], b[i][axis]);
            high[1] = fmax(high[1], b[i][axis]);
        }
        if (high[0] < low[1] || high[1] < low[0]) return 1;
    }
    return 0;
}

/* Does the segment a b, whose ends are on the sides sa, sb of the triangle's plane, pass through the triangle?
 *degenerate is set if it may touch the boundary, or if an end lies in the plane. */
static inline int rx_pierces(const double *a, const double *b, int sa, int sb, const double *const t[3],
                             int *degenerate) {
    const double *segment[2];
    int i, turn[3];
    if (sa * sb > 0) return 0;
    segment[0] = a;
    segment[1] = b;
    if (rx_boxes_apart(segment, 2, t, 3)) return 0;
    for (i = 0; i < 3; i++) turn[i] = gxb_orient3d(a, b, t[i], t[(i + 1) % 3]);
    for (i = 0; i < 3; i++)
        if (turn[i] * turn[(i + 1) % 3] < 0 || turn[i] * turn[(i + 2) % 3] < 0) return 0;
    if (sa == 0 || sb == 0 || turn[0] == 0 || turn[1] == 0 || turn[2] == 0) *degenerate = 1;
    return 1;
}

/* Sets the contact's bits; 0: triangle and element do not meet */
static inline int rx_meet(const rx_body *b, rx_contact *c, int *degenerate) {
    const double *x[4], *t[3], *face[3];
    int side[4], out[3][4], e, k, v, all = 0, touches = 0;
    unsigned inside;
    for (k = 0; k < 4; k++) x[k] = rx_corner(b, c->element, k);
    for (v = 0; v < 3; v++) t[v] = rx_vertex(b, c->triangle, v);
    if (rx_boxes_apart(x, 4, t, 3)) return 0;
    for (k = 0; k < 4; k++) {
        side[k] = rx_side(t[0], t[1], t[2], x[k]);
        all += side[k];
        if (side[k] > 0) c->front |= 1u << k;
    }
    if (all == 4 || all == -4) return 0;
    for (k = 0; k < 4; k++) {
        for (v = 0; v < 3; v++) face[v] = x[RX_FACE[k][v]];
        for (all = 0, v = 0; v < 3; v++) {
            out[v][k] = rx_side(face[0], face[1], face[2], t[v]);
            all += out[v][k];
            if (out[v][k] > 0) c->outside |= 1u << (4 * v + k);
        }
        if (all == 3) return 0;
    }
    for (v = 0; v < 3; v++) {
        inside = !(c->outside >> (4 * v) & 15);
        touches |= inside != 0;
        if (inside && (out[v][0] == 0 || out[v][1] == 0 || out[v][2] == 0 || out[v][3] == 0)) *degenerate = 1;
    }
    for (e = 0; e < 6; e++)
        if (rx_pierces(x[RX_EDGE[e][0]], x[RX_EDGE[e][1]], side[RX_EDGE[e][0]], side[RX_EDGE[e][1]], t, degenerate))
            c->edges |= 1u << e;
    for (k = 0; k < 4; k++) {
        for (v = 0; v < 3; v++) face[v] = x[RX_FACE[k][v]];
        for (v = 0; v < 3; v++)
            if (rx_pierces(t[v], t[(v + 1) % 3], out[v][k], out[(v + 1) % 3][k], face, degenerate))
                c->pierced |= 1u << (4 * v + k);
    }
    return touches || c->edges || c->pierced;
}

/* Faces on which the triangle leaves a segment of the path: its edges pierce them, or an edge of theirs pierces it */
static inline unsigned rx_contact_faces(const rx_contact *c) {
    unsigned faces = (c->pierced | c->pierced >> 4 | c->pierced >> 8) & 15;
    int e;
    for (e = 0; e < 6; e++)
        if (c->edges >> e & 1) faces |= 15u & ~(1u << RX_EDGE[e][0] | 1u << RX_EDGE[e][1]);
    return faces;
}

/* Does the surface continue across edge v within the element? */
static inline int rx_goes_on(const rx_contact *c, int v) {
    return (c->pierced >> (4 * v) & 15) != 0 || (c->outside >> (4 * v) & 15) == 0;
}

/* A lattice of boxes, each with the elements whose own boxes meet it */
typedef struct rx_grid {
    double low[3], size;
    uint32_t n[3], *first, *items;
} rx_grid;

static inline void rx_range(const rx_grid *g, const double *const *points, int count, uint32_t low[3],
                            uint32_t high[3]) {
    int a, i;
    for (a = 0; a < 3; a++) {
        double least = points[0][a], most = points[0][a];
        for (i = 1; i < count; i++) {
            least = fmin(least, points[i][a]);
            most = fmax(most, points[i][a]);
        }
        least = (least - g->low[a]) / g->size;
        most = (most - g->low[a]) / g->size;
        low[a] = least > 0 ? least < g->n[a] - 1 ? (uint32_t)least : g->n[a] - 1 : 0;
        high[a] = most > 0 ? most < g->n[a] - 1 ? (uint32_t)most : g->n[a] - 1 : 0;
    }
}

static inline void rx_grid_size(const rx_body *b, rx_grid *g) {
    double high[3], volume = 1;
    size_t i;
    int a;
    for (a = 0; a < 3; a++) {
        g->low[a] = high[a] = b->positions[a];
        for (i = 1; i < b->node_count; i++) {
            g->low[a] = fmin(g->low[a], b->positions[3 * i + (size_t)a]);
            high[a] = fmax(high[a], b->positions[3 * i + (size_t)a]);
        }
        volume *= high[a] - g->low[a];
    }
    g->size = cbrt(volume / (double)b->element_count);
    for (a = 0; a < 3; a++) g->n[a] = 1 + (uint32_t)fmin(1000, (high[a] - g->low[a]) / g->size);
}

/* Counts, then fills: first[] ends in its final form. */
static inline rx_grid rx_grid_create(const rx_body *b) {
    rx_grid g;
    size_t cells, i;
    int pass, k;
    rx_grid_size(b, &g);
    cells = (size_t)g.n[0] * g.n[1] * g.n[2];
    g.first = (uint32_t *)dense_memory(NULL, cells + 1, sizeof(uint32_t));
    g.items = NULL;
    memset(g.first, 0, (cells + 1) * sizeof(uint32_t));
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < b->element_count; i++) {
            const double *x[4];
            uint32_t low[3], high[3], u, v, w;
            for (k = 0; k < 4; k++) x[k] = rx_corner(b, (uint32_t)i, k);
            rx_range(&g, x, 4, low, high);
            for (u = low[0]; u <= high[0]; u++)
                for (v = low[1]; v <= high[1]; v++)
                    for (w = low[2]; w <= high[2]; w++) {
                        uint32_t *at = &g.first[((size_t)u * g.n[1] + v) * g.n[2] + w];
                        if (pass == 0)
                            (*at)++;
                        else
                            g.items[--*at] = (uint32_t)i;
                    }
        }
        for (i = 1; pass == 0 && i <= cells; i++) g.first[i] += g.first[i - 1];
        if (pass == 0) g.items = (uint32_t *)dense_memory(NULL, g.first[cells], sizeof(uint32_t));
    }
    return g;
}

static int rx_compare_contacts(const void *a, const void *b) {
    const rx_contact *x = (const rx_contact *)a, *y = (const rx_contact *)b;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static inline void rx_add_contact(rx_body *b, uint32_t element, uint32_t triangle, unsigned char *degenerate) {
    rx_contact c;
    int touched = 0;
    memset(&c, 0, sizeof c);
    c.element = element;
    c.triangle = triangle;
    if (!rx_meet(b, &c, &touched)) return;
    degenerate[triangle] |= (unsigned char)touched;
    if ((b->contact_count & (b->contact_count - 1)) == 0)
        b->contacts = (rx_contact *)dense_memory(b->contacts, 2 * b->contact_count + 1, sizeof c);
    b->contacts[b->contact_count++] = c;
}

/* Contacts of the triangles from `first` on, after those of earlier cuts; returns whether some are degenerate. */
static inline int rx_find_contacts(rx_body *b, const rx_grid *g, uint32_t first, unsigned char *degenerate) {
    uint32_t *seen = (uint32_t *)dense_memory(NULL, b->element_count, sizeof(uint32_t)), t;
    const size_t before = b->contact_count;
    int any = 0, v;
    memset(seen, 255, b->element_count * sizeof(uint32_t));
    for (t = first; t < b->triangle_count; t++) {
        const double *p[3];
        uint32_t low[3], high[3], i, j, k, at;
        for (v = 0; v < 3; v++) p[v] = rx_vertex(b, t, v);
        rx_range(g, p, 3, low, high);
        for (i = low[0]; i <= high[0]; i++)
            for (j = low[1]; j <= high[1]; j++)
                for (k = low[2]; k <= high[2]; k++) {
                    const size_t cell = ((size_t)i * g->n[1] + j) * g->n[2] + k;
                    for (at = g->first[cell]; at < g->first[cell + 1]; at++) {
                        if (seen[g->items[at]] == t) continue;
                        seen[g->items[at]] = t;
                        rx_add_contact(b, g->items[at], t, degenerate);
                    }
                }
        any |= degenerate[t];
    }
    free(seen);
    qsort(b->contacts + before, b->contact_count - before, sizeof *b->contacts, rx_compare_contacts);
    return any;
}

/* From -1 to 1 */
static inline double rx_random(uint64_t *state) { return (double)(splitmix64(state) >> 11) / 4503599627370496.0 - 1; }

/* Section 6, step 1: moves the vertices of degenerate triangles. */
static inline void rx_perturb(rx_body *b, const rx_grid *g, uint32_t first, const unsigned char *degenerate,
                              uint64_t *random) {
    const double reach = RX_PERTURBATION * g->size * fmax(g->n[0], fmax(g->n[1], g->n[2]));
    unsigned char *moved = (unsigned char *)dense_memory(NULL, b->vertex_count, 1);
    uint32_t t, a, v;
    memset(moved, 0, b->vertex_count);
    for (t = first; t < b->triangle_count; t++)
        for (v = 0; v < 3 && degenerate[t]; v++) {
            const uint32_t vertex = b->triangles[3 * t + v];
            if (moved[vertex]) continue;
            moved[vertex] = 1;
            b->perturbed++;
            for (a = 0; a < 3; a++) b->vertices[3 * (size_t)vertex + a] += reach * rx_random(random);
        }
    free(moved);
}

/* Contacts of a new surface in general position */
static inline rx_result rx_trace(rx_body *b, uint32_t first) {
    rx_grid grid = rx_grid_create(b);
    unsigned char *degenerate = (unsigned char *)dense_memory(NULL, b->triangle_count, 1);
    const size_t before = b->contact_count;
    uint64_t random = 1;
    int attempt, again = 1;
    for (attempt = 0; attempt < 8 && again; attempt++) {
        if (attempt > 0) rx_perturb(b, &grid, first, degenerate, &random);
        memset(degenerate, 0, b->triangle_count);
        b->contact_count = before;
        again = rx_find_contacts(b, &grid, first, degenerate);
    }
    free(degenerate);
    free(grid.first);
    free(grid.items);
    return again ? RX_ERROR_DEGENERATE : RX_OK;
}

/* ---- refusals ---- */

static inline int rx_share_vertex(const rx_body *b, uint32_t s, uint32_t t) {
    int i;
    for (i = 0; i < 9; i++)
        if (b->triangles[3 * s + (uint32_t)i / 3] == b->triangles[3 * t + (uint32_t)i % 3]) return 1;
    return 0;
}

/* Adds where edges of triangle s pierce triangle t; returns how many. */
static inline int rx_piercings(const double *const s[3], const double *const t[3], double (*at)[3]) {
    int side[3], v, a, count = 0, touched = 0;
    for (v = 0; v < 3; v++) side[v] = rx_side(t[0], t[1], t[2], s[v]);
    for (v = 0; v < 3; v++) {
        const double *x = s[v], *y = s[(v + 1) % 3];
        double n[3], u[3][3], dx, dy, share;
        if (!rx_pierces(x, y, side[v], side[(v + 1) % 3], t, &touched)) continue;
        for (a = 0; a < 9; a++) u[a / 3][a % 3] = t[a / 3][a % 3];
        rx_triangle_normal(u[0], n);
        for (dx = dy = 0, a = 0; a < 3; a++) {
            dx += n[a] * (x[a] - t[0][a]);
            dy += n[a] * (y[a] - t[0][a]);
        }
        share = fabs(dx) + fabs(dy) > 0 ? fabs(dx) / (fabs(dx) + fabs(dy)) : 0.5;
        for (a = 0; a < 3; a++) at[count][a] = x[a] + share * (y[a] - x[a]);
        count++;
    }
    return count;
}

/* The frame of an element: xi = frame (x - x0) */
static inline void rx_frame(const rx_body *b, uint32_t element, double frame[3][3]) {
    const double *x0 = rx_corner(b, element, 0);
    double edge[3][3], volume;
    int i, a;
    for (i = 0; i < 3; i++)
        for (a = 0; a < 3; a++) edge[i][a] = rx_corner(b, element, i + 1)[a] - x0[a];
    for (i = 0; i < 3; i++) rx_cross(edge[(i + 1) % 3], edge[(i + 2) % 3], frame[i]);
    volume = dense_dot(frame[0], edge[0], 3);
    for (i = 0; i < 9; i++) frame[i / 3][i % 3] /= volume;
}

static inline void rx_to_frame(const rx_body *b, uint32_t element, double frame[3][3], const double *x, double *xi) {
    double local[3];
    int a;
    for (a = 0; a < 3; a++) local[a] = x[a] - rx_corner(b, element, 0)[a];
    for (a = 0; a < 3; a++) xi[a] = dense_dot(frame[a], local, 3);
}

/* Does a part of the segment lie in the element? */
static inline int rx_segment_inside(const rx_body *b, uint32_t element, const double *p, const double *q) {
    double frame[3][3], x[3], y[3], from = 0, to = 1;
    int k;
    rx_frame(b, element, frame);
    rx_to_frame(b, element, frame, p, x);
    rx_to_frame(b, element, frame, q, y);
    for (k = 0; k < 4; k++) {
        const double u = rx_face_distance(x, k), v = rx_face_distance(y, k);
        if (u < 0 && v < 0) return 0;
        if (u < 0) from = fmax(from, u / (u - v));
        if (v < 0) to = fmin(to, u / (u - v));
    }
    return from <= to;
}

/* Triangles of one plane overlap in more than their boundaries unless the other triangle lies beyond one of their
   edges. */
static inline int rx_overlap_in_plane(const double *const s[3], const double *const t[3]) {
    const double *const *of[2];
    double n[3], corner[9], x[3][2];
    int axis, i, v, a;
    of[0] = s;
    of[1] = t;
    for (v = 0; v < 9; v++) corner[v] = s[v / 3][v % 3];
    rx_triangle_normal(corner, n);
    axis = fabs(n[0]) > fabs(n[1]) ? 0 : 1;
    axis = fabs(n[2]) > fabs(n[axis]) ? 2 : axis;
    for (i = 0; i < 6; i++) {
        const double *const *p = of[i / 3], *const *q = of[1 - i / 3];
        int turn, beyond = 1;
        for (v = 0; v < 3; v++)
            for (a = 0; a < 2; a++) x[v][a] = p[(i + v) % 3][(axis + 1 + a) % 3];
        turn = gxb_orient2d(x[0], x[1], x[2]);
        for (v = 0; v < 3; v++) {
            for (a = 0; a < 2; a++) x[2][a] = q[v][(axis + 1 + a) % 3];
            if (gxb_orient2d(x[0], x[1], x[2]) * turn > 0) beyond = 0;
        }
        if (beyond) return 0;
    }
    return 1;
}

static inline int rx_is_coplanar(const double *const s[3], const double *const t[3]) {
    int v;
    for (v = 0; v < 3; v++)
        if (rx_side(t[0], t[1], t[2], s[v]) != 0) return 0;
    return 1;
}

static inline int rx_cross_within(const rx_body *b, uint32_t element, uint32_t s, uint32_t t) {
    const double *p[3], *q[3];
    double at[6][3];
    int v, count;
    for (v = 0; v < 3; v++) {
        p[v] = rx_vertex(b, s, v);
        q[v] = rx_vertex(b, t, v);
    }
    if (rx_boxes_apart(p, 3, q, 3)) return 0;
    if (rx_is_coplanar(p, q)) return rx_overlap_in_plane(p, q);
    count = rx_piercings(p, q, at);
    count += rx_piercings(q, p, at + count);
    return count > 0 && rx_segment_inside(b, element, at[0], at[count - 1]);
}

static inline size_t rx_contact_range(const rx_body *b, size_t from, size_t end) {
    size_t to = from;
    while (to < end && b->contacts[to].element == b->contacts[from].element) to++;
    return to;
}

/* The new contacts of an element against each other and against those of complete and partial patches of earlier cuts
 */
static inline rx_result rx_check_crossings(const rx_body *b, size_t before, const size_t *old_first) {
    size_t from, to, i, j;
    for (from = before; from < b->contact_count; from = to) {
        const uint32_t element = b->contacts[from].element;
        to = rx_contact_range(b, from, b->contact_count);
        for (i = from; i < to; i++) {
            for (j = from; j < i; j++)
                if (!rx_share_vertex(b, b->contacts[i].triangle, b->contacts[j].triangle) &&
                    rx_cross_within(b, element, b->contacts[i].triangle, b->contacts[j].triangle))
                    return RX_ERROR_CROSSING;
            for (j = old_first[element]; j < old_first[element + 1]; j++)
                if (rx_cross_within(b, element, b->contacts[i].triangle, b->contacts[b->by_element[j]].triangle))
                    return RX_ERROR_CROSSING;
        }
    }
    return RX_OK;
}

/* ---- patches ---- */

static inline size_t rx_root(size_t *parent, size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

static inline const rx_contact *rx_find_contact(const rx_contact *from, const rx_contact *to, uint32_t triangle) {
    while (from < to) {
        const rx_contact *middle = from + (to - from) / 2;
        if (middle->triangle == triangle) return middle;
        if (middle->triangle < triangle)
            from = middle + 1;
        else
            to = middle;
    }
    return NULL;
}

/* Joins the contacts of one element across the edges that pass through it. */
static inline void rx_join_contacts(const rx_body *b, size_t from, size_t to, size_t *parent) {
    size_t i;
    int v;
    for (i = from; i < to; i++) parent[i - from] = i - from;
    for (i = from; i < to; i++)
        for (v = 0; v < 3; v++) {
            const uint32_t other = b->triangle_neighbours[3 * b->contacts[i].triangle + (uint32_t)v];
            const rx_contact *c = NULL;
            if (other != UINT32_MAX && rx_goes_on(&b->contacts[i], v))
                c = rx_find_contact(b->contacts + from, b->contacts + to, other);
            if (c) parent[rx_root(parent, i - from)] = rx_root(parent, (size_t)(c - b->contacts) - from);
        }
}

static inline void rx_describe_patch(const rx_body *b, rx_patch *p) {
    size_t i;
    int v;
    for (i = p->first; i < p->first + p->count; i++) {
        const rx_contact *c = &b->contacts[b->members[i]];
        p->faces |= rx_contact_faces(c);
        for (v = 0; v < 3; v++)
            if (b->triangle_neighbours[3 * c->triangle + (uint32_t)v] == UINT32_MAX)
                p->open |= c->pierced >> (4 * v) & 15;
    }
}

static inline rx_patch *rx_add_patch(rx_body *b, uint32_t element) {
    rx_patch *p;
    if ((b->patch_count & (b->patch_count - 1)) == 0)
        b->patches = (rx_patch *)dense_memory(b->patches, 2 * b->patch_count + 1, sizeof *p);
    p = &b->patches[b->patch_count++];
    memset(p, 0, sizeof *p);
    p->element = element;
    p->cut = b->cut_count;
    for (element = 0; element < 4; element++) p->enrichment[element] = RX_NONE;
    return p;
}

/* Sorts the new contacts of an element into patches. */
static inline void rx_group_contacts(rx_body *b, size_t from, size_t to, size_t *parent) {
    size_t i, j, filled = from;
    rx_join_contacts(b, from, to, parent);
    for (i = from; i < to; i++) {
        rx_patch *p;
        if (rx_root(parent, i - from) != i - from) continue;
        p = rx_add_patch(b, b->contacts[from].element);
        p->first = filled;
        for (j = from; j < to; j++)
            if (rx_root(parent, j - from) == i - from) {
                b->contacts[j].patch = (uint32_t)(b->patch_count - 1);
                b->members[filled++] = j;
            }
        p->count = filled - p->first;
        rx_describe_patch(b, p);
    }
}

static inline void rx_make_patches(rx_body *b, size_t before) {
    size_t *parent = (size_t *)dense_memory(NULL, b->contact_count - before, sizeof *parent), from, to;
    b->members = (size_t *)dense_memory(b->members, b->contact_count, sizeof *b->members);
    for (from = before; from < b->contact_count; from = to) {
        to = rx_contact_range(b, from, b->contact_count);
        rx_group_contacts(b, from, to, parent);
    }
    free(parent);
}

/* ---- the section of an element by a patch ---- */

/* front: the edge's first corner is in front of the triangle */
typedef struct rx_crossing {
    double at;
    int front;
} rx_crossing;

static int rx_compare_crossings(const void *a, const void *b) {
    const rx_crossing *x = (const rx_crossing *)a, *y = (const rx_crossing *)b;
    return (x->at > y->at) - (x->at < y->at);
}

typedef struct rx_sketch { /* references of a section */
    rx_section section;
    rx_crossing *found; /* of the edge at hand */
    double *memory;
    unsigned *bits;
    int first_front[6], last_front[6];
} rx_sketch;

/* The patch's crossings of edge e by their share of the edge; 0: they do not change sides in turn */
static inline int rx_find_crossings(const rx_body *b, const rx_patch *p, int e, rx_sketch *s, double *at) {
    size_t i, count = 0;
    for (i = 0; i < p->count; i++) {
        const rx_contact *c = &b->contacts[b->members[p->first + i]];
        const double *t = s->section.triangles + 9 * i, *x = RX_CORNER[RX_EDGE[e][0]], *y = RX_CORNER[RX_EDGE[e][1]];
        double n[3], dx = 0, dy = 0;
        int a;
        if (!(c->edges >> e & 1)) continue;
        rx_triangle_normal(t, n);
        for (a = 0; a < 3; a++) {
            dx += n[a] * (x[a] - t[a]);
            dy += n[a] * (y[a] - t[a]);
        }
        s->found[count].front = (int)(c->front >> RX_EDGE[e][0] & 1);
        s->found[count++].at = fabs(dx) + fabs(dy) > 0 ? fabs(dx) / (fabs(dx) + fabs(dy)) : 0.5;
    }
    qsort(s->found, count, sizeof *s->found, rx_compare_crossings);
    for (i = 0; i < count; i++) {
        at[i] = s->found[i].at;
        if (i > 0 && s->found[i].front == s->found[i - 1].front) return 0;
    }
    s->section.crossing[e] = at;
    s->section.crossing_count[e] = count;
    s->first_front[e] = count > 0 && s->found[0].front;
    s->last_front[e] = count > 0 && s->found[count - 1].front;
    return 1;
}

/* A patch that crosses no edge leaves all corners on one side, outside of its loops in the faces. With n out of the
   plus side, the sum of x . n over a loop is twice its area if that side is plus. */
static inline int rx_corners_off_loops(const rx_rules *r, const rx_section *s) {
    rx_list segments = {NULL, 0, 0};
    double sum = 0;
    size_t i;
    int k;
    for (k = 0; k < 4; k++) {
        segments.count = 0;
        rx_face_segments(r, s, k, &segments);
        for (i = 0; i < segments.count; i++) {
            const double *p = segments.data + RX_SEGMENT * i;
            sum += hypot(p[2] - p[0], p[3] - p[1]) * 0.5 * ((p[0] + p[2]) * p[4] + (p[1] + p[3]) * p[5]);
        }
    }
    free(segments.data);
    return sum < 0;
}

/* Sides of the corners from the crossings of the edges; 0: they contradict each other */
static inline int rx_find_sides(const rx_rules *r, rx_sketch *s) {
    int known[4] = {0, 0, 0, 0}, *plus = s->section.plus, e, k, pass, any = 0;
    for (pass = 0; pass < 4; pass++)
        for (e = 0; e < 6; e++) {
            const int i = RX_EDGE[e][0], j = RX_EDGE[e][1], crossed = s->section.crossing_count[e] > 0;
            const int side_i = crossed ? s->first_front[e] : known[j] ? plus[j] : plus[i];
            const int side_j = crossed ? !s->last_front[e] : known[i] ? plus[i] : plus[j];
            if (!crossed && !known[i] && !known[j]) continue;
            if ((known[i] && plus[i] != side_i) || (known[j] && plus[j] != side_j)) return 0;
            plus[i] = side_i;
            plus[j] = side_j;
            known[i] = known[j] = any = 1;
        }
    if (any) return known[0] && known[1] && known[2] && known[3];
    for (plus[0] = rx_corners_off_loops(r, &s->section), k = 1; k < 4; k++) plus[k] = plus[0];
    return 1;
}

static inline void rx_sketch_free(rx_sketch *s) {
    free(s->memory);
    free(s->bits);
    free(s->found);
}

/* The patch in the frame of its element */
static inline rx_result rx_sketch_patch(const rx_body *b, rx_patch *p, rx_sketch *s) {
    const size_t n = p->count;
    double frame[3][3], *crossings;
    size_t i;
    int v, e;
    memset(s, 0, sizeof *s);
    s->memory = (double *)dense_memory(NULL, 15 * n, sizeof(double));
    s->bits = (unsigned *)dense_memory(NULL, 2 * n, sizeof(unsigned));
    s->found = (rx_crossing *)dense_memory(NULL, n, sizeof *s->found);
    crossings = s->memory + 9 * n;
    rx_frame(b, p->element, frame);
    for (i = 0; i < n; i++) {
        const rx_contact *c = &b->contacts[b->members[p->first + i]];
        for (v = 0; v < 3; v++)
            rx_to_frame(b, p->element, frame, rx_vertex(b, c->triangle, v), s->memory + 9 * i + 3 * v);
        s->bits[i] = c->outside;
        s->bits[n + i] = rx_contact_faces(c);
    }
    s->section.count = n;
    s->section.triangles = s->memory;
    s->section.below = s->bits;
    s->section.crosses = s->bits + n;
    for (e = 0; e < 6; e++)
        if (!rx_find_crossings(b, p, e, s, crossings + (size_t)e * n)) return RX_ERROR_DEGENERATE;
    if (!rx_find_sides(b->rules, s)) return RX_ERROR_DEGENERATE;
    for (v = 0; v < 4; v++)
        if (s->section.plus[v]) p->plus |= 1u << v;
    return RX_OK;
}

/* A point of the patch within the element: the middle of a clipped triangle, in material coordinates */
static inline void rx_patch_point(const rx_body *b, rx_patch *p, const rx_section *s) {
    double corner[RX_CORNERS][3], best = -1;
    size_t i, j;
    int a, k;
    for (i = 0; i < s->count; i++) {
        double middle[3] = {0, 0, 0}, least = 2;
        size_t n;
        memcpy(corner, s->triangles + 9 * i, 9 * sizeof(double));
        n = rx_clip_polygon(corner, 3);
        for (j = 0; j < n; j++) dense_add(middle, 1.0 / (double)n, corner[j], 3);
        for (k = 0; k < 4; k++) least = fmin(least, rx_face_distance(middle, k));
        if (n == 0 || least <= best) continue;
        best = least;
        for (a = 0; a < 3; a++) {
            const double *x0 = rx_corner(b, p->element, 0);
            for (p->point[a] = x0[a], k = 0; k < 3; k++)
                p->point[a] += middle[k] * (rx_corner(b, p->element, k + 1)[a] - x0[a]);
        }
    }
}

/* Sides and the rule's moments of all complete patches from `first` on */
static inline rx_result rx_fit_patches(rx_body *b, size_t first) {
    rx_result result = RX_OK;
    size_t i;
    for (i = first; i < b->patch_count && result == RX_OK; i++) {
        rx_patch *p = &b->patches[i];
        rx_sketch s;
        double start = rx_now(b);
        if (!rx_patch_is_complete(p)) continue;
        result = rx_sketch_patch(b, p, &s);
        b->seconds_path += rx_now(b) - start;
        if (result == RX_OK) {
            rx_patch_point(b, p, &s.section);
            start = rx_now(b);
            rx_section_moments(b->rules, &s.section);
            memcpy(p->moments, b->rules->volume.moments, b->rules->volume.moment_count * sizeof(double));
            b->seconds_rules += rx_now(b) - start;
        }
        rx_sketch_free(&s);
    }
    return result;
}

/* ---- 4.3: enrichment ---- */

/* Patches of two elements that share a piece of the path on the face between them */
typedef struct rx_link {
    uint32_t patch, face, other;
} rx_link;

static inline size_t rx_link_patches(const rx_body *b, size_t before, size_t first, rx_link **links,
                                     uint32_t *link_first) {
    const rx_contact *end = b->contacts + b->contact_count;
    size_t count = 0, i, j;
    uint32_t k;
    *links = NULL;
    for (i = first; i < b->patch_count; i++) {
        const rx_patch *p = &b->patches[i];
        link_first[i - first] = (uint32_t)count;
        for (j = p->first; j < p->first + p->count; j++) {
            const rx_contact *c = &b->contacts[b->members[j]], *from, *to;
            const unsigned faces = rx_contact_faces(c);
            for (k = 0; k < 4; k++) {
                rx_contact wanted;
                const uint32_t other = b->neighbours[4 * p->element + k];
                if (!(faces >> k & 1) || other == UINT32_MAX) continue;
                wanted.element = other;
                wanted.triangle = c->triangle;
                from = b->contacts + before;
                for (to = end; from < to;) { /* contacts are sorted */
                    const rx_contact *middle = from + (to - from) / 2;
                    if (rx_compare_contacts(middle, &wanted) < 0)
                        from = middle + 1;
                    else
                        to = middle;
                }
                if (from == end || rx_compare_contacts(from, &wanted) != 0) continue;
                if ((count & (count - 1)) == 0) *links = (rx_link *)dense_memory(*links, 2 * count + 1, sizeof **links);
                (*links)[count].patch = (uint32_t)i;
                (*links)[count].face = k;
                (*links)[count++].other = from->patch;
            }
        }
    }
    link_first[b->patch_count - first] = (uint32_t)count;
    return count;
}

static inline int rx_corner_of(const rx_body *b, uint32_t element, uint32_t node) {
    int k = 0;
    while (b->elements[4 * element + (uint32_t)k] != node) k++;
    return k;
}

/* Where the path of a patch ends on the boundary of the one-ring around corner k: in the opposite face, and on the
   mesh's boundary */
static inline int rx_is_open_for(const rx_body *b, const rx_patch *p, int k) {
    unsigned rim = 1u << k, f;
    for (f = 0; f < 4; f++)
        if (b->neighbours[4 * p->element + f] == UINT32_MAX) rim |= 1u << f;
    return (p->open & rim) != 0;
}

typedef struct rx_walk {
    uint32_t *queue, *stamp, stamped;
    const rx_link *links;
    const uint32_t *link_first;
    size_t first;
} rx_walk;

/* Collects the patches around the node that are connected with one of them; returns their number. */
static inline size_t rx_walk_patches(const rx_body *b, rx_walk *w, uint32_t node, uint32_t patch) {
    size_t count = 1, done;
    uint32_t i;
    w->queue[0] = patch;
    w->stamp[patch - w->first] = w->stamped;
    for (done = 0; done < count; done++) {
        const size_t at = w->queue[done] - w->first;
        for (i = w->link_first[at]; i < w->link_first[at + 1]; i++) {
            const rx_link *l = &w->links[i];
            const uint32_t *corners = b->elements + 4 * (size_t)b->patches[l->other].element;
            if (w->stamp[l->other - w->first] == w->stamped) continue;
            if (corners[0] != node && corners[1] != node && corners[2] != node && corners[3] != node) continue;
            w->stamp[l->other - w->first] = w->stamped;
            w->queue[count++] = l->other;
        }
    }
    return count;
}

/* One more function for the node if the collected patches separate its one-ring: then their path there is closed. */
static inline void rx_enrich(rx_body *b, const rx_walk *w, size_t count, uint32_t node) {
    rx_enrichment *e;
    size_t i;
    int complete = 0, plus = 0;
    for (i = 0; i < count; i++) {
        const rx_patch *p = &b->patches[w->queue[i]];
        const int k = rx_corner_of(b, p->element, node);
        if (rx_is_open_for(b, p, k)) return;
        if (!complete && rx_patch_is_complete(p)) {
            complete = 1;
            plus = (int)(p->plus >> k & 1);
        }
    }
    if (!complete) return;
    if ((b->enrichment_count & (b->enrichment_count - 1)) == 0)
        b->enrichments = (rx_enrichment *)dense_memory(b->enrichments, 2 * b->enrichment_count + 1, sizeof *e);
    e = &b->enrichments[b->enrichment_count++];
    e->node = node;
    e->cut = b->cut_count;
    e->plus = plus;
    for (i = 0; i < count; i++) {
        rx_patch *p = &b->patches[w->queue[i]];
        if (rx_patch_is_complete(p)) p->enrichment[rx_corner_of(b, p->element, node)] = (int)b->enrichment_count - 1;
    }
}

/* Each patch that separates a one-ring is a cut of its own (the multi-patch case). */
static inline void rx_enrich_nodes(rx_body *b, size_t before, size_t first) {
    const size_t count = b->patch_count - first;
    uint32_t *memory = (uint32_t *)dense_memory(NULL, 3 * count + 1, sizeof(uint32_t));
    rx_link *links;
    rx_walk w;
    size_t i;
    uint32_t k;
    w.queue = memory;
    w.stamp = memory + count;
    w.link_first = memory + 2 * count;
    w.stamped = 0;
    w.first = first;
    rx_link_patches(b, before, first, &links, memory + 2 * count);
    w.links = links;
    memset(w.stamp, 0, count * sizeof(uint32_t));
    for (i = first; i < b->patch_count; i++)
        for (k = 0; k < 4; k++) {
            const uint32_t node = b->elements[4 * (size_t)b->patches[i].element + k];
            if (!rx_patch_is_complete(&b->patches[i]) || b->patches[i].enrichment[k] != RX_NONE) continue;
            w.stamped++;
            rx_enrich(b, &w, rx_walk_patches(b, &w, node, (uint32_t)i), node);
        }
    free(links);
    free(memory);
}

/* ---- pieces of elements ---- */

/* The side of a patch on which a point of its element lies: crossings of the way from corner 0 */
static inline int rx_side_of_patch(const rx_body *b, const rx_patch *p, const double *x) {
    const double *x0 = rx_corner(b, p->element, 0);
    int plus = (int)(p->plus & 1), v, touched = 0;
    size_t i;
    for (i = p->first; i < p->first + p->count; i++) {
        const rx_contact *c = &b->contacts[b->members[i]];
        const double *t[3];
        for (v = 0; v < 3; v++) t[v] = rx_vertex(b, c->triangle, v);
        if (rx_pierces(x0, x, c->front & 1 ? 1 : -1, rx_side(t[0], t[1], t[2], x), t, &touched)) plus = !plus;
    }
    return plus;
}

static inline void rx_add_piece_once(rx_body *b, uint32_t element, uint64_t plus) {
    size_t i;
    for (i = b->piece_first[element]; i < b->piece_count; i++)
        if (b->pieces[i].plus == plus) return;
    if ((b->piece_count & (b->piece_count - 1)) == 0)
        b->pieces = (rx_piece *)dense_memory(b->pieces, 2 * b->piece_count + 1, sizeof *b->pieces);
    b->pieces[b->piece_count].element = element;
    b->pieces[b->piece_count++].plus = plus;
}

/* K patches make K + 1 pieces: one on either side of each, placed among the others. */
static inline void rx_list_pieces(rx_body *b, uint32_t element) {
    const uint32_t *list = b->patch_list + b->patch_first[element];
    const uint32_t count = b->patch_first[element + 1] - b->patch_first[element];
    uint32_t p, q;
    if (count == 0) rx_add_piece_once(b, element, 0);
    for (p = 0; p < count; p++) {
        uint64_t beside = 0;
        for (q = 0; q < count; q++)
            if (q != p && rx_side_of_patch(b, &b->patches[list[q]], b->patches[list[p]].point))
                beside |= UINT64_C(1) << q;
        rx_add_piece_once(b, element, beside | UINT64_C(1) << p);
        rx_add_piece_once(b, element, beside);
    }
}

/* The piece of the element that contains the point */
static inline size_t rx_piece_at(const rx_body *b, uint32_t element, const double *x) {
    uint64_t plus = 0;
    uint32_t p, i;
    for (p = b->patch_first[element]; p < b->patch_first[element + 1]; p++)
        if (rx_side_of_patch(b, &b->patches[b->patch_list[p]], x) > 0)
            plus |= UINT64_C(1) << (p - b->patch_first[element]);
    for (i = b->piece_first[element]; i + 1 < b->piece_first[element + 1]; i++)
        if (b->pieces[i].plus == plus) break;
    return i;
}

/* The whole element less everything beyond each patch that bounds the piece, that is, whose other side is a piece
   too */
static inline void rx_piece_moments(const rx_body *b, rx_piece *piece) {
    const rx_fit *f = &b->rules->volume;
    const uint32_t *list = b->patch_list + b->patch_first[piece->element];
    const uint32_t count = b->patch_first[piece->element + 1] - b->patch_first[piece->element];
    double whole[RX_MOMENTS];
    size_t i, m;
    uint32_t p;
    for (m = 0; m < f->moment_count; m++)
        whole[m] = piece->moments[m] =
            rx_simplex_integral(3, f->basis.exponent[m][0], f->basis.exponent[m][1], f->basis.exponent[m][2]);
    for (p = 0; p < count; p++)
        for (i = b->piece_first[piece->element]; i < b->piece_first[piece->element + 1]; i++) {
            const double *plus = b->patches[list[p]].moments;
            const int on_plus = (int)(piece->plus >> p & 1);
            if ((b->pieces[i].plus ^ piece->plus) != UINT64_C(1) << p) continue;
            for (m = 0; m < f->moment_count; m++) piece->moments[m] -= on_plus ? whole[m] - plus[m] : plus[m];
        }
}

/* Lists the complete patches and the pieces of all elements. */
static inline void rx_divide(rx_body *b) {
    size_t i, count = 0;
    uint32_t e;
    memset(b->patch_first, 0, (b->element_count + 1) * sizeof(uint32_t));
    for (i = 0; i < b->patch_count; i++)
        if (rx_patch_is_complete(&b->patches[i])) {
            b->patch_first[b->patches[i].element]++;
            count++;
        }
    for (i = 1; i <= b->element_count; i++) b->patch_first[i] += b->patch_first[i - 1];
    b->patch_list = (uint32_t *)dense_memory(b->patch_list, count, sizeof(uint32_t));
    for (i = b->patch_count; i-- > 0;)
        if (rx_patch_is_complete(&b->patches[i])) b->patch_list[--b->patch_first[b->patches[i].element]] = (uint32_t)i;
    b->piece_count = 0;
    for (e = 0; e < b->element_count; e++) {
        b->piece_first[e] = (uint32_t)b->piece_count;
        rx_list_pieces(b, e);
    }
    b->piece_first[b->element_count] = (uint32_t)b->piece_count;
    for (i = 0; i < b->piece_count; i++) rx_piece_moments(b, &b->pieces[i]);
}

/* Functions, besides the standard one, that are not 0 at a corner of a piece: psi (Eq. 10) is 1 or -1 if an odd
   number of the patches of its enrichment lies between the corner and the piece. Returns their number, at most one
   for each patch. */
static inline size_t rx_piece_functions(const rx_body *b, const rx_piece *piece, int corner, uint32_t *enrichment,
                                        int *psi) {
    const uint32_t *list = b->patch_list + b->patch_first[piece->element];
    const uint32_t patches = b->patch_first[piece->element + 1] - b->patch_first[piece->element];
    size_t count = 0, i;
    uint32_t p;
    for (p = 0; p < patches; p++) {
        const rx_patch *patch = &b->patches[list[p]];
        const int e = patch->enrichment[corner];
        if (e == RX_NONE || (patch->plus >> corner & 1) == (piece->plus >> p & 1)) continue;
        for (i = 0; i < count && enrichment[i] != (uint32_t)e; i++) {}
        if (i < count)
            enrichment[i] = enrichment[--count];
        else
            enrichment[count++] = (uint32_t)e;
    }
    for (i = 0; i < count; i++) psi[i] = b->enrichments[enrichment[i]].plus ? -1 : 1;
    return count;
}

/* ---- the cut ---- */

static inline rx_result rx_check_counts(const rx_body *b, size_t first) {
    uint32_t run = 0;
    size_t i;
    for (i = first; i < b->patch_count; i++) {
        const uint32_t e = b->patches[i].element;
        run = i > first && e == b->patches[i - 1].element ? run + 1 : 1;
        if (run + b->patch_first[e + 1] - b->patch_first[e] > 64) return RX_ERROR_LIMIT;
    }
    return RX_OK;
}

/* Sorts the contacts of earlier cuts by element: by_element; returns where each element's begin. */
static inline size_t *rx_old_contacts(rx_body *b, size_t before) {
    size_t *first = (size_t *)dense_memory(NULL, b->element_count + 1, sizeof *first), i;
    memset(first, 0, (b->element_count + 1) * sizeof *first);
    for (i = 0; i < before; i++) first[b->contacts[i].element]++;
    for (i = 1; i <= b->element_count; i++) first[i] += first[i - 1];
    b->by_element = (size_t *)dense_memory(b->by_element, before, sizeof *b->by_element);
    for (i = before; i-- > 0;) b->by_element[--first[b->contacts[i].element]] = i;
    return first;
}

static inline rx_result rx_cut_steps(rx_body *b, const rx_surface *surface, size_t before, size_t patches) {
    const uint32_t first = (uint32_t)b->triangle_count;
    const double start = rx_now(b);
    size_t *old = NULL;
    rx_result result = rx_add_surface(b, surface);
    if (result == RX_OK) result = rx_trace(b, first);
    if (result == RX_OK) {
        old = rx_old_contacts(b, before);
        result = rx_check_crossings(b, before, old);
    }
    free(old);
    if (result != RX_OK) return result;
    rx_make_patches(b, before);
    b->seconds_path += rx_now(b) - start;
    result = rx_check_counts(b, patches);
    return result == RX_OK ? rx_fit_patches(b, patches) : result;
}

/* Cuts the mesh. On any result other than RX_OK it is as it was. */
static inline rx_result rx_body_cut(rx_body *b, const rx_surface *surface) {
    const size_t contacts = b->contact_count, patches = b->patch_count, triangles = b->triangle_count,
                 vertices = b->vertex_count;
    const rx_result result = rx_cut_steps(b, surface, contacts, patches);
    if (result != RX_OK) {
        b->contact_count = contacts;
        b->patch_count = patches;
        b->triangle_count = triangles;
        b->vertex_count = vertices;
        return result;
    }
    rx_enrich_nodes(b, contacts, patches);
    b->cut_count++;
    rx_divide(b);
    return RX_OK;
}

/* ---- section 6 ---- */

static const double RX_SUPPORT = 1e-9; /* Eq. 22 */

static inline double rx_element_volume(const rx_body *b, uint32_t element) {
    double edge[3][3], n[3];
    int i;
    for (i = 0; i < 9; i++)
        edge[i / 3][i % 3] = rx_corner(b, element, i / 3 + 1)[i % 3] - rx_corner(b, element, 0)[i % 3];
    rx_cross(edge[0], edge[1], n);
    return dense_dot(n, edge[2], 3) / 6;
}

/* Eq. 27: for each enrichment the volume on which it is not 0, over the volume of its node's one-ring. Both are sums
   of the rules' weights, that is, their moments of degree 0. Below RX_SUPPORT it is to be constrained. Its
   preconditioner is 1 / sqrt(share) (Eq. 26); that of a standard function is 1. */
static inline void rx_shares(const rx_body *b, double *share) {
    double *ring = (double *)dense_memory(NULL, b->node_count, sizeof(double));
    uint32_t functions[64];
    int psi[64], k;
    size_t i, j, count;
    memset(ring, 0, b->node_count * sizeof(double));
    memset(share, 0, b->enrichment_count * sizeof(double));
    for (i = 0; i < b->piece_count; i++) {
        const rx_piece *piece = &b->pieces[i];
        const double volume = 6 * rx_element_volume(b, piece->element) * piece->moments[0];
        for (k = 0; k < 4; k++) {
            ring[b->elements[4 * piece->element + (uint32_t)k]] += volume;
            count = rx_piece_functions(b, piece, k, functions, psi);
            for (j = 0; j < count; j++) share[functions[j]] += volume;
        }
    }
    for (i = 0; i < b->enrichment_count; i++) share[i] /= ring[b->enrichments[i].node];
    free(ring);
}

#endif
