/* least.h - the least number of displacements that separate a cut mesh, counted independently of the library, in
   doubles.

   Sheets are heights over one grid: z on (side + 1)^2 points, two triangles to a cell, divided from below left to
   above right. They may cross each other. Each element is clipped by the upright prisms over the triangles that it
   reaches into. The parts are clipped by the sheets' planes there. That leaves convex pieces. A piece's label says
   which sheets it is above. Pieces of one element are one cell if prisms separate them and no sheet does. Cells of
   neighbours are linked if pieces of one prism and one label reach a face that they share.
       least_result.least     for each node: sets of linked cells among those of the elements around it, flooded star
                              by star (GXFEM Eq. 18)
       least_result.replicas  virtual nodes: each cell is a whole element with corners of its own; linked cells share
                              those of the face between them [Sifakis, Der, Fedkiw 2007]

   Decisions are signs of doubles. So sheets must be in general position, as random ones are, and no line or diagonal
   of the grid may meet a node. */
#ifndef GXFEM_BENCH_LEAST_H
#define GXFEM_BENCH_LEAST_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEAST_CORNERS = 96 };
#define LEAST_NONE UINT32_MAX

typedef struct least_sheets {
    const double *x, *y; /* side + 1 each, ascending: the grid's lines; it covers the mesh */
    const double *z;     /* count x (side + 1)^2, by y, then x */
    uint32_t side;
    size_t count;
} least_sheets;

typedef struct least_mesh {
    /* x 3 */
    const double *positions;
    size_t node_count;
    /* x 4 */
    const uint32_t *elements;
    size_t element_count;
} least_mesh;

typedef struct least_result {
    size_t least, replicas, cells;
} least_result;

/* Planes: 0 to 3 are the element's faces, opposite to its corners; then walls of prisms, three for each grid point;
   then sheets */
typedef struct least_corner {
    double x[3];
    uint32_t plane[3];
} least_corner;

/* Convex: three planes meet in a corner, and an edge joins two corners that have two planes in common. */
typedef struct least_piece {
    least_corner corners[LEAST_CORNERS];
    uint32_t count, prism, cell;
    uint64_t label;
} least_piece;

/* A cell reaches a face in this prism. */
typedef struct least_reach {
    uint32_t element, face, prism, cell;
    uint64_t label;
} least_reach;

typedef struct least_count {
    const least_mesh *mesh;
    const least_sheets *sheets;
    uint64_t *names; /* of the sheets: a label is the sum of the names of those below */
    /* of the element at hand */
    least_piece *pieces;
    size_t piece_count, piece_capacity;
    /* by element, then face */
    least_reach *reaches;
    size_t reach_count, reach_capacity;
    size_t *first_reach;  /* element_count + 1 */
    uint32_t *first_cell; /* element_count + 1 */
    uint8_t *whole;       /* elements that no sheet is near: one cell, without pieces */
    uint32_t *neighbours; /* element_count x 4, across from corners; LEAST_NONE */
    /* cells */
    uint32_t (*links)[2];
    size_t link_count, link_capacity;
    uint32_t cell_count;
} least_count;

static inline void *least_memory(void *old, size_t count, size_t size) {
    void *memory = realloc(old, count * size + 1);
    if (memory) return memory;
    fputs("least: no memory\n", stderr);
    exit(1);
}

/* ---- clipping ---- */

/* The two planes that the corners have in common; 0: fewer */
static inline int least_edge(const least_corner *a, const least_corner *b, uint32_t common[2]) {
    int i, j, n = 0;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            if (a->plane[i] == b->plane[j] && n < 2) common[n++] = a->plane[i];
    return n == 2;
}

static inline least_corner *least_add_corner(least_piece *p) {
    if (p->count < LEAST_CORNERS) return &p->corners[p->count++];
    fputs("least: a piece with too many corners\n", stderr);
    exit(1);
}

/* Where the edge between a (at) and b (below) crosses the plane */
static inline void least_cross(const least_corner *a, const least_corner *b, const uint32_t common[2], double at,
                               double below, uint32_t plane, least_piece *to) {
    least_corner *c = least_add_corner(to);
    int k;
    for (k = 0; k < 3; k++) c->x[k] = a->x[k] + (b->x[k] - a->x[k]) * (at / (at - below));
    c->plane[0] = common[0];
    c->plane[1] = common[1];
    c->plane[2] = plane;
}

/* The parts of the piece above and below the plane; values: at its corners. Either part may be empty. */
static inline void least_split(const least_piece *p, const double *values, uint32_t plane, least_piece *above,
                               least_piece *below) {
    uint32_t i, j, common[2];
    above->count = below->count = 0;
    above->prism = below->prism = p->prism;
    above->label = below->label = p->label;
    for (i = 0; i < p->count; i++) *least_add_corner(values[i] >= 0 ? above : below) = p->corners[i];
    if (above->count == 0 || below->count == 0) return;
    for (i = 0; i < p->count; i++)
        for (j = 0; j < p->count; j++)
            if (values[i] >= 0 && values[j] < 0 && least_edge(&p->corners[i], &p->corners[j], common)) {
                least_cross(&p->corners[i], &p->corners[j], common, values[i], values[j], plane, above);
                least_cross(&p->corners[i], &p->corners[j], common, values[i], values[j], plane, below);
            }
}

/* ---- prisms ---- */

static inline uint32_t least_point(const least_sheets *s, uint32_t i, uint32_t j) { return j * (s->side + 1) + i; }

/* The wall's plane along x (0), along y (1), or along the diagonal (2) from a grid point */
static inline uint32_t least_wall(const least_sheets *s, uint32_t i, uint32_t j, uint32_t along) {
    return 4 + 3 * least_point(s, i, j) + along;
}

static inline uint32_t least_sheet_plane(const least_sheets *s, size_t sheet) {
    return 4 + 3 * least_point(s, 0, s->side + 1) + (uint32_t)sheet;
}

/* Height of the point over the sheet's plane in its prism: 2 * cell is the triangle below the diagonal, 2 * cell + 1
   the one above */
static inline double least_height(const least_sheets *s, size_t sheet, uint32_t prism, const double *x) {
    const uint32_t i = prism / 2 % s->side, j = prism / 2 / s->side;
    const double *z = s->z + sheet * (s->side + 1) * (s->side + 1) + least_point(s, i, j), *next = z + s->side + 1;
    const double u = (x[0] - s->x[i]) / (s->x[i + 1] - s->x[i]), v = (x[1] - s->y[j]) / (s->y[j + 1] - s->y[j]);
    return x[2] - (prism & 1 ? z[0] + v * (next[0] - z[0]) + u * (next[1] - next[0])
                             : z[0] + u * (z[1] - z[0]) + v * (next[1] - z[1]));
}

/* Keeps the part on the inner side of a wall of the prism: 0 the diagonal, 1 the wall along x, 2 the one along y.
   Returns 0 if nothing is there. */
static inline int least_clip(least_piece *p, const least_sheets *s, int wall) {
    static least_piece above, below;
    const uint32_t i = p->prism / 2 % s->side, j = p->prism / 2 / s->side, up = p->prism & 1;
    const double dx = s->x[i + 1] - s->x[i], dy = s->y[j + 1] - s->y[j];
    double values[LEAST_CORNERS];
    uint32_t c, plane;
    int inner;
    for (c = 0; c < p->count; c++) {
        const double *x = p->corners[c].x;
        values[c] = wall == 0 ? (x[1] - s->y[j]) * dx - (x[0] - s->x[i]) * dy
                  : wall == 1 ? x[1] - s->y[j + up]
                              : x[0] - s->x[i + 1 - up];
    }
    plane = wall == 0 ? least_wall(s, i, j, 2)
          : wall == 1 ? least_wall(s, i, j + up, 0)
                      : least_wall(s, i + 1 - up, j, 1);
    inner = wall == 1 ? !up : (int)up; /* is it above? */
    least_split(p, values, plane, &above, &below);
    *p = inner ? above : below;
    return p->count > 0;
}

/* ---- an element ---- */

static inline const double *least_position(const least_mesh *m, size_t element, int k) {
    return m->positions + 3 * (size_t)m->elements[4 * element + (size_t)k];
}

/* Cells of the grid that the element's box reaches into: from, to (inclusive) along each axis */
static inline void least_range(const least_count *l, size_t element, uint32_t from[2], uint32_t to[2]) {
    const least_sheets *s = l->sheets;
    int k, a;
    for (a = 0; a < 2; a++) {
        const double *lines = a ? s->y : s->x, spacing = (lines[s->side] - lines[0]) / s->side;
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (k = 0; k < 4; k++) {
            low = fmin(low, least_position(l->mesh, element, k)[a]);
            high = fmax(high, least_position(l->mesh, element, k)[a]);
        }
        from[a] = (uint32_t)fmax(0, fmin(s->side - 1, floor((low - lines[0]) / spacing - 1e-9)));
        to[a] = (uint32_t)fmax(0, fmin(s->side - 1, floor((high - lines[0]) / spacing + 1e-9)));
    }
}

/* -1, 1: the element is below or above the sheet; 0: it may meet it */
static inline int least_side(const least_count *l, size_t element, size_t sheet, const uint32_t from[2],
                             const uint32_t to[2]) {
    const least_sheets *s = l->sheets;
    const double *z = s->z + sheet * (s->side + 1) * (s->side + 1);
    double low = HUGE_VAL, high = -HUGE_VAL, least = HUGE_VAL, most = -HUGE_VAL;
    uint32_t i, j;
    int k;
    for (k = 0; k < 4; k++) {
        low = fmin(low, least_position(l->mesh, element, k)[2]);
        high = fmax(high, least_position(l->mesh, element, k)[2]);
    }
    if (s->side == 1) { /* the box decides little */
        int above = 0;
        for (k = 0; k < 8; k++)
            above += least_height(s, sheet, (uint32_t)(k & 1), least_position(l->mesh, element, k / 2)) >= 0;
        return above == 8 ? 1 : above == 0 ? -1 : 0;
    }
    for (j = from[1]; j <= to[1] + 1; j++)
        for (i = from[0]; i <= to[0] + 1; i++) {
            least = fmin(least, z[least_point(s, i, j)]);
            most = fmax(most, z[least_point(s, i, j)]);
        }
    return low > most ? 1 : high < least ? -1 : 0;
}

static inline least_piece *least_add_piece(least_count *l) {
    if (l->piece_count == l->piece_capacity) {
        l->piece_capacity = 2 * l->piece_capacity + 16;
        l->pieces = (least_piece *)least_memory(l->pieces, l->piece_capacity, sizeof *l->pieces);
    }
    return &l->pieces[l->piece_count++];
}

static inline void least_add_prism(least_count *l, size_t element, uint32_t prism, uint64_t label) {
    least_piece *p = least_add_piece(l);
    int k, w, d, there = 1;
    p->count = 4;
    p->prism = prism;
    p->label = label;
    for (k = 0; k < 4; k++) {
        memcpy(p->corners[k].x, least_position(l->mesh, element, k), 3 * sizeof(double));
        for (d = 0; d < 3; d++) p->corners[k].plane[d] = (uint32_t)((k + 1 + d) % 4);
    }
    for (w = 0; w < 3 && there; w++) there = least_clip(p, l->sheets, w);
    if (!there) l->piece_count--;
}

/* Divides the element's pieces by a sheet and records for each whether it is above. */
static inline void least_divide(least_count *l, size_t sheet) {
    static least_piece above, below;
    const size_t count = l->piece_count;
    double values[LEAST_CORNERS];
    size_t i;
    uint32_t c;
    for (i = 0; i < count; i++) {
        least_piece *p = &l->pieces[i];
        for (c = 0; c < p->count; c++) values[c] = least_height(l->sheets, sheet, p->prism, p->corners[c].x);
        least_split(p, values, least_sheet_plane(l->sheets, sheet), &above, &below);
        above.label += l->names[sheet];
        if (below.count > 0)
            *p = below;
        else
            *p = above;
        if (below.count > 0 && above.count > 0) *least_add_piece(l) = above;
    }
}

static inline int least_reaches(const least_piece *p, uint32_t plane) {
    uint32_t c;
    for (c = 0; c < p->count; c++)
        if (p->corners[c].plane[0] == plane || p->corners[c].plane[1] == plane || p->corners[c].plane[2] == plane)
            return 1;
    return 0;
}

/* Do pieces of one label lie on both sides of a prism's wall? */
static inline int least_join(const least_sheets *s, const least_piece *p, const least_piece *q) {
    const uint32_t i = p->prism / 2 % s->side, j = p->prism / 2 / s->side, a = q->prism / 2 % s->side,
                   b = q->prism / 2 / s->side;
    uint32_t wall;
    if (p->label != q->label || p->prism % 2 == q->prism % 2) return 0;
    if (p->prism % 2) return least_join(s, q, p);
    if (a == i && b == j)
        wall = least_wall(s, i, j, 2); /* p below the diagonal, q above it */
    else if (a == i && b + 1 == j)
        wall = least_wall(s, i, j, 0);
    else if (a == i + 1 && b == j)
        wall = least_wall(s, i + 1, j, 1);
    else
        return 0;
    return least_reaches(p, wall) && least_reaches(q, wall);
}

static inline uint32_t least_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Numbers the element's cells. */
static inline void least_find_cells(least_count *l) {
    const uint32_t n = (uint32_t)l->piece_count;
    uint32_t *parent = (uint32_t *)least_memory(NULL, n, sizeof *parent), i, j;
    for (i = 0; i < n; i++) parent[i] = i;
    for (i = 0; i < n; i++)
        for (j = 0; j < i; j++)
            if (least_join(l->sheets, &l->pieces[i], &l->pieces[j]))
                parent[least_root(parent, i)] = least_root(parent, j);
    for (i = 0; i < n; i++)
        if (least_root(parent, i) == i) l->pieces[i].cell = l->cell_count++;
    for (i = 0; i < n; i++) l->pieces[i].cell = l->pieces[least_root(parent, i)].cell;
    free(parent);
}

static int least_reach_order(const void *a, const void *b) {
    const least_reach *x = (const least_reach *)a, *y = (const least_reach *)b;
    if (x->face != y->face) return x->face < y->face ? -1 : 1;
    if (x->prism != y->prism) return x->prism < y->prism ? -1 : 1;
    return (x->label > y->label) - (x->label < y->label);
}

static inline void least_note_reaches(least_count *l, size_t element) {
    const size_t before = l->reach_count;
    size_t i;
    uint32_t f;
    for (i = 0; i < l->piece_count; i++)
        for (f = 0; f < 4; f++) {
            const least_piece *p = &l->pieces[i];
            least_reach *r;
            if (!least_reaches(p, f)) continue;
            if (l->reach_count == l->reach_capacity) {
                l->reach_capacity = 2 * l->reach_capacity + 1024;
                l->reaches = (least_reach *)least_memory(l->reaches, l->reach_capacity, sizeof *l->reaches);
            }
            r = &l->reaches[l->reach_count++];
            r->element = (uint32_t)element;
            r->face = f;
            r->prism = p->prism;
            r->cell = p->cell;
            r->label = p->label;
        }
    qsort(l->reaches + before, l->reach_count - before, sizeof *l->reaches, least_reach_order);
}

static inline void least_cut_element(least_count *l, size_t element) {
    uint32_t from[2], to[2], i, j;
    uint64_t label = 0;
    size_t k, met = 0, *near = (size_t *)least_memory(NULL, l->sheets->count, sizeof *near);
    least_range(l, element, from, to);
    for (k = 0; k < l->sheets->count; k++) {
        const int side = least_side(l, element, k, from, to);
        if (side == 0) near[met++] = k;
        if (side > 0) label += l->names[k];
    }
    l->whole[element] = met == 0;
    l->piece_count = 0;
    for (j = from[1]; j <= to[1] && met > 0; j++)
        for (i = from[0]; i <= to[0]; i++) {
            least_add_prism(l, element, 2 * (j * l->sheets->side + i), label);
            least_add_prism(l, element, 2 * (j * l->sheets->side + i) + 1, label);
        }
    for (k = 0; k < met; k++) least_divide(l, near[k]);
    if (met == 0)
        l->cell_count++;
    else
        least_find_cells(l);
    least_note_reaches(l, element);
    free(near);
}

/* ---- links ---- */

typedef struct least_face {
    uint32_t nodes[3], element, across;
} least_face;

static int least_face_order(const void *a, const void *b) { return memcmp(a, b, sizeof((least_face *)0)->nodes); }

static inline void least_find_neighbours(least_count *l) {
    const size_t n = 4 * l->mesh->element_count;
    least_face *faces = (least_face *)least_memory(NULL, n, sizeof *faces);
    size_t i;
    int a, b;
    l->neighbours = (uint32_t *)least_memory(NULL, n, sizeof *l->neighbours);
    for (i = 0; i < n; i++) {
        least_face *f = &faces[i];
        f->element = (uint32_t)(i / 4);
        f->across = (uint32_t)(i % 4);
        for (a = 0; a < 3; a++) f->nodes[a] = l->mesh->elements[i / 4 * 4 + (i % 4 + 1 + (size_t)a) % 4];
        for (a = 0; a < 2; a++)
            for (b = 0; b < 2 - a; b++)
                if (f->nodes[b] > f->nodes[b + 1]) {
                    const uint32_t t = f->nodes[b];
                    f->nodes[b] = f->nodes[b + 1];
                    f->nodes[b + 1] = t;
                }
        l->neighbours[i] = LEAST_NONE;
    }
    qsort(faces, n, sizeof *faces, least_face_order);
    for (i = 1; i < n; i++) {
        const least_face *f = &faces[i - 1], *g = &faces[i];
        if (least_face_order(f, g) != 0) continue;
        l->neighbours[4 * (size_t)f->element + f->across] = g->element;
        l->neighbours[4 * (size_t)g->element + g->across] = f->element;
    }
    free(faces);
}

static inline void least_add_link(least_count *l, uint32_t a, uint32_t b) {
    if (l->link_count > 0 && l->links[l->link_count - 1][0] == a && l->links[l->link_count - 1][1] == b) return;
    if (l->link_count == l->link_capacity) {
        l->link_capacity = 2 * l->link_capacity + 1024;
        l->links = (uint32_t(*)[2])least_memory(l->links, l->link_capacity, sizeof *l->links);
    }
    l->links[l->link_count][0] = a;
    l->links[l->link_count++][1] = b;
}

/* Reaches of an element at its face across from corner k */
static inline const least_reach *least_reaches_of(const least_count *l, size_t element, uint32_t k, size_t *count) {
    size_t from = l->first_reach[element], to;
    while (from < l->first_reach[element + 1] && l->reaches[from].face < k) from++;
    for (to = from; to < l->first_reach[element + 1] && l->reaches[to].face == k; to++) continue;
    *count = to - from;
    return l->reaches + from;
}

/* Links of the cells of neighbours e and f; their common face is opposite to corners j and k. */
static inline void least_link(least_count *l, size_t e, uint32_t j, size_t f, uint32_t k) {
    size_t m, n, a = 0, b = 0;
    const least_reach *p = least_reaches_of(l, e, j, &m), *q = least_reaches_of(l, f, k, &n);
    if (l->whole[e] && l->whole[f]) least_add_link(l, l->first_cell[e], l->first_cell[f]);
    for (; l->whole[e] && b < n; b++) least_add_link(l, l->first_cell[e], q[b].cell);
    for (; l->whole[f] && a < m; a++) least_add_link(l, p[a].cell, l->first_cell[f]);
    while (a < m && b < n) {
        least_reach x = p[a], y = q[b];
        int order;
        x.face = y.face = 0;
        order = least_reach_order(&x, &y);
        if (order == 0) least_add_link(l, x.cell, y.cell);
        a += order <= 0;
        b += order >= 0;
    }
}

static inline void least_find_links(least_count *l) {
    size_t i, f;
    uint32_t k;
    for (i = 0; i < 4 * l->mesh->element_count; i++) {
        f = l->neighbours[i];
        if (f == LEAST_NONE || f < i / 4) continue;
        for (k = 0; l->neighbours[4 * f + k] != i / 4; k++) continue;
        least_link(l, i / 4, (uint32_t)(i % 4), f, k);
    }
}

/* ---- counts ---- */

/* Element of each cell */
static inline uint32_t *least_cell_elements(const least_count *l) {
    uint32_t *element = (uint32_t *)least_memory(NULL, l->cell_count, sizeof *element), c;
    size_t e;
    for (e = 0; e < l->mesh->element_count; e++)
        for (c = l->first_cell[e]; c < l->first_cell[e + 1]; c++) element[c] = (uint32_t)e;
    return element;
}

static inline int least_has_node(const least_mesh *m, size_t element, uint32_t node) {
    const uint32_t *n = m->elements + 4 * element;
    return n[0] == node || n[1] == node || n[2] == node || n[3] == node;
}

/* The corners of all cells, joined where links make them one */
static inline size_t least_count_replicas(const least_count *l, const uint32_t *element) {
    const uint32_t n = 4 * l->cell_count;
    uint32_t *parent = (uint32_t *)least_memory(NULL, n, sizeof *parent), i;
    size_t k, count = 0;
    int a, b;
    for (i = 0; i < n; i++) parent[i] = i;
    for (k = 0; k < l->link_count; k++)
        for (a = 0; a < 4; a++)
            for (b = 0; b < 4; b++) {
                const uint32_t p = l->links[k][0], q = l->links[k][1];
                if (l->mesh->elements[4 * (size_t)element[p] + (size_t)a] !=
                    l->mesh->elements[4 * (size_t)element[q] + (size_t)b])
                    continue;
                parent[least_root(parent, 4 * p + (uint32_t)a)] = least_root(parent, 4 * q + (uint32_t)b);
            }
    for (i = 0; i < n; i++) count += least_root(parent, i) == i;
    free(parent);
    return count;
}

/* Neighbours of each cell: those of c are to[first[c]] to to[first[c + 1] - 1]. */
static inline void least_list_links(const least_count *l, size_t **first, uint32_t **to) {
    size_t i, n = l->cell_count;
    *first = (size_t *)least_memory(NULL, n + 2, sizeof **first);
    *to = (uint32_t *)least_memory(NULL, 2 * l->link_count, sizeof **to);
    memset(*first, 0, (n + 2) * sizeof **first);
    for (i = 0; i < 2 * l->link_count; i++) (*first)[l->links[i / 2][i % 2] + 2]++;
    for (i = 2; i < n + 2; i++) (*first)[i] += (*first)[i - 1];
    for (i = 0; i < 2 * l->link_count; i++) (*to)[(*first)[l->links[i / 2][i % 2] + 1]++] = l->links[i / 2][1 - i % 2];
}

/* Elements around each node, in the same form */
static inline void least_list_stars(const least_mesh *m, size_t **first, uint32_t **ring) {
    size_t i;
    *first = (size_t *)least_memory(NULL, m->node_count + 2, sizeof **first);
    *ring = (uint32_t *)least_memory(NULL, 4 * m->element_count, sizeof **ring);
    memset(*first, 0, (m->node_count + 2) * sizeof **first);
    for (i = 0; i < 4 * m->element_count; i++) (*first)[m->elements[i] + 2]++;
    for (i = 2; i < m->node_count + 2; i++) (*first)[i] += (*first)[i - 1];
    for (i = 0; i < 4 * m->element_count; i++) (*ring)[(*first)[m->elements[i] + 1]++] = (uint32_t)(i / 4);
}

/* Marks, with the node, the cells around it that are connected with this one. */
static inline void least_flood(const least_count *l, const uint32_t *element, const size_t *first, const uint32_t *to,
                               uint32_t node, uint32_t cell, uint32_t *mark, uint32_t *stack) {
    size_t depth = 0, i;
    mark[stack[depth++] = cell] = node;
    while (depth > 0) {
        const uint32_t c = stack[--depth];
        for (i = first[c]; i < first[c + 1]; i++) {
            if (mark[to[i]] == node || !least_has_node(l->mesh, element[to[i]], node)) continue;
            mark[stack[depth++] = to[i]] = node;
        }
    }
}

static inline size_t least_count_components(const least_count *l, const uint32_t *element) {
    size_t *first, *star, count = 0, i;
    uint32_t *to, *ring, node, c;
    uint32_t *mark = (uint32_t *)least_memory(NULL, l->cell_count, sizeof *mark),
             *stack = (uint32_t *)least_memory(NULL, l->cell_count, sizeof *stack);
    least_list_links(l, &first, &to);
    least_list_stars(l->mesh, &star, &ring);
    memset(mark, 255, l->cell_count * sizeof *mark);
    for (node = 0; node < l->mesh->node_count; node++)
        for (i = star[node]; i < star[node + 1]; i++)
            for (c = l->first_cell[ring[i]]; c < l->first_cell[ring[i] + 1]; c++) {
                if (mark[c] == node) continue;
                least_flood(l, element, first, to, node, c, mark, stack);
                count++;
            }
    free(first);
    free(to);
    free(star);
    free(ring);
    free(mark);
    free(stack);
    return count;
}

static inline least_result least_of(const least_mesh *mesh, const least_sheets *sheets) {
    least_result result;
    least_count l;
    uint32_t *element;
    uint64_t random = 1;
    size_t i;
    memset(&l, 0, sizeof l);
    l.mesh = mesh;
    l.sheets = sheets;
    l.names = (uint64_t *)least_memory(NULL, sheets->count, sizeof *l.names);
    /* Knuth's MMIX */
    for (i = 0; i < sheets->count; i++) l.names[i] = random = random * 6364136223846793005u + 1442695040888963407u;
    l.first_reach = (size_t *)least_memory(NULL, mesh->element_count + 1, sizeof *l.first_reach);
    l.first_cell = (uint32_t *)least_memory(NULL, mesh->element_count + 1, sizeof *l.first_cell);
    l.whole = (uint8_t *)least_memory(NULL, mesh->element_count, 1);
    l.reaches = (least_reach *)least_memory(NULL, 0, sizeof *l.reaches);
    for (i = 0; i < mesh->element_count; i++) {
        l.first_reach[i] = l.reach_count;
        l.first_cell[i] = l.cell_count;
        least_cut_element(&l, i);
    }
    l.first_reach[i] = l.reach_count;
    l.first_cell[i] = l.cell_count;
    least_find_neighbours(&l);
    least_find_links(&l);
    element = least_cell_elements(&l);
    result.cells = l.cell_count;
    result.replicas = least_count_replicas(&l, element);
    result.least = least_count_components(&l, element);
    free(element);
    free(l.names);
    free(l.pieces);
    free(l.reaches);
    free(l.first_reach);
    free(l.first_cell);
    free(l.whole);
    free(l.neighbours);
    free(l.links);
    return result;
}

#endif
