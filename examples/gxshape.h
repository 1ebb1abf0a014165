/* gxshape.h: shapes given by a function, and tetrahedral meshes that fill them. Plain arrays in and out; includes
   nothing of ours.

   contents
     >>field       distances of balls, capsules, cones, ellipsoids, boxes, rings; their smooth union
     >>lattice     body-centred cubic lattice, signs at its nodes, points where the surface crosses its edges
     >>stuffing    the lattice's tetrahedra, cut off at the surface
     >>shapes      octopus, bunny, armadillo, plate with objects, ball, torus

   Meshes are made by isosurface stuffing: F. Labelle, J. R. Shewchuk: Isosurface Stuffing: Fast Tetrahedral Meshes with
   Good Dihedral Angles, 2007 (here LS), the variant with elements of one size. Its dihedral angles lie between 10.7 and
   164.8 degrees whatever the function is. Sharp edges of a shape come out blunt. The same call gives the same mesh. */
#ifndef GXSHAPE_H
#define GXSHAPE_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------ >>field */

/* A function of space: negative inside the shape, positive outside, continuous. */
typedef double (*gxshape_fn)(const void *shape, const double x[3]);

enum {
    GXSHAPE_CAPSULE,   /* round ends p and q with radii r[0] and r[1]; p = q: a ball */
    GXSHAPE_FRUSTUM,   /* flat ends about p and q with radii r[0] and r[1]: cylinder or blunt cone */
    GXSHAPE_ELLIPSOID, /* centre p, semi-axes q along x, y, z */
    GXSHAPE_BOX,       /* centre p, half edges q along x, y, z */
    /* torus: centre p, unit vector q along its axis, radii r[0] of the ring and r[1] of its tube */
    GXSHAPE_RING
};

typedef struct gxshape_part {
    int kind;
    double p[3], q[3], r[2]; /* m; by kind, see there */
    double blend;            /* m; it flows into the parts before it where both are about this near; 0: sharp */
} gxshape_part;

enum { GXSHAPE_PARTS = 96 };

/* Smooth union of parts, at least one, in a box that contains it. */
typedef struct gxshape_field {
    gxshape_part parts[GXSHAPE_PARTS];
    size_t part_count;
    double low[3], high[3];
} gxshape_field;

static inline double gxshape_length(const double d[3]) { return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]); }

/* The share of the way from p to q nearest to x, within `least` and `most`, and x's distance from there. 0 where p = q.
 */
static inline double gxshape_along(const double p[3], const double q[3], const double x[3], double least, double most,
                                   double *distance) {
    double along = 0.0, square = 0.0, t, d[3];
    int i;
    for (i = 0; i < 3; i++) {
        along += (q[i] - p[i]) * (x[i] - p[i]);
        square += (q[i] - p[i]) * (q[i] - p[i]);
    }
    t = square > 0.0 ? fmin(fmax(along / square, least), most) : 0.0;
    for (i = 0; i < 3; i++) d[i] = x[i] - (p[i] + t * (q[i] - p[i]));
    *distance = gxshape_length(d);
    return t;
}

/* Distance to the axis minus the radius there: the distance itself if the radii are equal, else a little more. */
static inline double gxshape_capsule(const gxshape_part *part, const double x[3]) {
    double distance;
    const double t = gxshape_along(part->p, part->q, x, 0.0, 1.0, &distance);
    return distance - ((1.0 - t) * part->r[0] + t * part->r[1]);
}

/* The largest of the distances to the mantle and to the planes of the ends: right inside, too small outside near the
 * rims. */
static inline double gxshape_frustum(const gxshape_part *part, const double x[3]) {
    const double slope = part->r[1] - part->r[0];
    double distance, height, d[3];
    const double t = gxshape_along(part->p, part->q, x, -DBL_MAX, DBL_MAX, &distance);
    int i;
    for (i = 0; i < 3; i++) d[i] = part->q[i] - part->p[i];
    height = gxshape_length(d);
    return fmax((distance - part->r[0] - t * slope) * height / sqrt(height * height + slope * slope),
                (fabs(t - 0.5) - 0.5) * height);
}

/* With g = |x / q| the surface is g = 1; (g - 1) / |grad g| is the distance to first order. At the centre: the shortest
 * semi-axis. */
static inline double gxshape_ellipsoid(const gxshape_part *part, const double x[3]) {
    double scaled[3], gradient[3], g;
    int i;
    for (i = 0; i < 3; i++) {
        scaled[i] = (x[i] - part->p[i]) / part->q[i];
        gradient[i] = scaled[i] / part->q[i];
    }
    g = gxshape_length(scaled);
    if (!(g > 0.0)) return -fmin(part->q[0], fmin(part->q[1], part->q[2]));
    return (g - 1.0) * g / gxshape_length(gradient);
}

static inline double gxshape_box(const gxshape_part *part, const double x[3]) {
    double outside[3], inside = -DBL_MAX;
    int i;
    for (i = 0; i < 3; i++) {
        const double d = fabs(x[i] - part->p[i]) - part->q[i];
        outside[i] = fmax(d, 0.0);
        inside = fmax(inside, d);
    }
    return inside < 0.0 ? inside : gxshape_length(outside);
}

static inline double gxshape_ring(const gxshape_part *part, const double x[3]) {
    double height = 0.0, square = 0.0, flat;
    int i;
    for (i = 0; i < 3; i++) height += (x[i] - part->p[i]) * part->q[i];
    for (i = 0; i < 3; i++) {
        const double d = x[i] - part->p[i] - height * part->q[i];
        square += d * d;
    }
    flat = sqrt(square) - part->r[0];
    return sqrt(flat * flat + height * height) - part->r[1];
}

static inline double gxshape_part_value(const gxshape_part *part, const double x[3]) {
    switch (part->kind) {
    case GXSHAPE_CAPSULE: return gxshape_capsule(part, x);
    case GXSHAPE_FRUSTUM: return gxshape_frustum(part, x);
    case GXSHAPE_ELLIPSOID: return gxshape_ellipsoid(part, x);
    case GXSHAPE_BOX: return gxshape_box(part, x);
    default: return gxshape_ring(part, x);
    }
}

/* The smaller of a and b, less (width - |a - b|)^2 / (4 width) where they differ by less than the width: once
 * differentiable. */
static inline double gxshape_smooth_min(double a, double b, double width) {
    const double overlap = width - fabs(a - b), least = fmin(a, b);
    return overlap > 0.0 ? least - overlap * overlap / (4.0 * width) : least;
}

/* gxshape_fn; shape: gxshape_field */
static inline double gxshape_field_value(const void *shape, const double x[3]) {
    const gxshape_field *field = (const gxshape_field *)shape;
    double value = gxshape_part_value(&field->parts[0], x);
    size_t i;
    for (i = 1; i < field->part_count; i++)
        value = gxshape_smooth_min(value, gxshape_part_value(&field->parts[i], x), field->parts[i].blend);
    return value;
}

/* ---------------------------------------------------------------------------------------------- >>lattice */

#define GXSHAPE_NONE UINT32_MAX

/* Where the surface crosses a lattice edge, between nodes of unlike sign. */
typedef struct gxshape_crossing {
    double x[3], t;  /* m; share of the edge from its node of lower number */
    uint32_t upper;  /* its node of higher number */
    uint32_t vertex; /* of the mesh; GXSHAPE_NONE: not in use */
} gxshape_crossing;

/* Nodes are named by even coordinates (2i, 2j, 2k), corners of cubes, or odd ones (2i+1, 2j+1, 2k+1), their centres, in
   units of half an edge from `first`, a corner at a multiple of the spacing. Corners are numbered first. */
typedef struct gxshape_lattice {
    double spacing, first[3]; /* edge of a cube; lowest corner */
    size_t n[3];              /* cubes along each axis */
    size_t corner_count, node_count;
    signed char *sign; /* node_count; 1: inside, 0: on the surface, -1: outside */
    uint32_t *vertex;  /* node_count; of the mesh; GXSHAPE_NONE: not in use */
    uint32_t *moved;   /* node_count; the crossing to which it was moved; GXSHAPE_NONE: at rest */
    /* node_count + 1; crossings of edges to higher nodes: start[node] ... start[node + 1] - 1 */
    uint32_t *start;
    gxshape_crossing *crossings;
    size_t crossing_count, crossing_room;
} gxshape_lattice;

static inline void gxshape_lattice_release(gxshape_lattice *lattice) {
    free(lattice->sign);
    free(lattice->vertex);
    free(lattice->moved);
    free(lattice->start);
    free(lattice->crossings);
}

/* The number of the node with coordinates c, GXSHAPE_NONE outside the lattice. */
static inline uint32_t gxshape_node(const gxshape_lattice *lattice, const int64_t c[3]) {
    const size_t odd = (size_t)(c[0] & 1);
    size_t number = 0;
    int i;
    for (i = 3; i-- > 0;) {
        const size_t count = lattice->n[i] + 1 - odd;
        if (c[i] < 0 || (size_t)c[i] / 2 >= count) return GXSHAPE_NONE;
        number = number * count + (size_t)c[i] / 2;
    }
    return (uint32_t)(number + (odd ? lattice->corner_count : 0));
}

static inline void gxshape_coordinates(const gxshape_lattice *lattice, uint32_t node, int64_t c[3]) {
    const size_t odd = node >= lattice->corner_count;
    size_t number = node - (odd ? lattice->corner_count : 0);
    int i;
    for (i = 0; i < 3; i++) {
        const size_t count = lattice->n[i] + 1 - odd;
        c[i] = (int64_t)(2 * (number % count) + odd);
        number /= count;
    }
}

/* Where the node lies before any is moved. */
static inline void gxshape_point(const gxshape_lattice *lattice, uint32_t node, double x[3]) {
    int64_t c[3];
    int i;
    gxshape_coordinates(lattice, node, c);
    for (i = 0; i < 3; i++) x[i] = lattice->first[i] + 0.5 * lattice->spacing * (double)c[i];
}

/* The neighbours at the ends of a node's edges: six long ones of the length spacing, eight short ones of sqrt(3)/2 of
 * it. */
enum { GXSHAPE_LONG_EDGES = 6, GXSHAPE_EDGES = 14 };

static inline uint32_t gxshape_neighbour(const gxshape_lattice *lattice, uint32_t node, int edge) {
    int64_t c[3];
    int i;
    gxshape_coordinates(lattice, node, c);
    if (edge < GXSHAPE_LONG_EDGES)
        c[edge / 2] += edge & 1 ? 2 : -2;
    else
        for (i = 0; i < 3; i++) c[i] += (edge - GXSHAPE_LONG_EDGES) >> i & 1 ? 1 : -1;
    return gxshape_node(lattice, c);
}

/* Corner with corner, centre with centre. */
static inline int gxshape_is_long(const gxshape_lattice *lattice, uint32_t a, uint32_t b) {
    return (a < lattice->corner_count) == (b < lattice->corner_count);
}

/* The crossing of the edge from a to b; there is one. */
static inline uint32_t gxshape_find_crossing(const gxshape_lattice *lattice, uint32_t a, uint32_t b) {
    uint32_t at = lattice->start[a < b ? a : b];
    while (lattice->crossings[at].upper != (a < b ? b : a)) at++;
    return at;
}

/* Lays the lattice around the box, a cube wider on each side. Returns NULL, or what is wrong. */
static inline const char *gxshape_lattice_make(gxshape_lattice *lattice, const double low[3], const double high[3],
                                               double spacing) {
    double nodes = 2.0;
    size_t i;
    memset(lattice, 0, sizeof *lattice);
    lattice->spacing = spacing;
    for (i = 0; i < 3; i++) {
        const double first = floor(low[i] / spacing) - 1.0, cubes = ceil(high[i] / spacing) + 1.0 - first;
        lattice->first[i] = first * spacing;
        nodes *= cubes + 1.0;
        if (!(nodes < 1e8)) return "has so small a spacing that its lattice has more than 10^8 nodes";
        lattice->n[i] = (size_t)cubes;
    }
    lattice->corner_count = (lattice->n[0] + 1) * (lattice->n[1] + 1) * (lattice->n[2] + 1);
    lattice->node_count = lattice->corner_count + lattice->n[0] * lattice->n[1] * lattice->n[2];
    lattice->sign = (signed char *)malloc(lattice->node_count);
    lattice->vertex = (uint32_t *)malloc(lattice->node_count * sizeof(uint32_t));
    lattice->moved = (uint32_t *)malloc(lattice->node_count * sizeof(uint32_t));
    lattice->start = (uint32_t *)malloc((lattice->node_count + 1) * sizeof(uint32_t));
    if (!lattice->sign || !lattice->vertex || !lattice->moved || !lattice->start) return "out of memory";
    for (i = 0; i < lattice->node_count; i++) lattice->vertex[i] = lattice->moved[i] = GXSHAPE_NONE;
    return NULL;
}

/* Corners on the lattice's border, and centres of the cubes there. */
static inline int gxshape_on_border(const gxshape_lattice *lattice, uint32_t node) {
    int64_t c[3];
    int i;
    gxshape_coordinates(lattice, node, c);
    for (i = 0; i < 3; i++)
        if (c[i] <= 1 || (size_t)c[i] + 1 >= 2 * lattice->n[i]) return 1;
    return 0;
}

static inline const char *gxshape_lattice_signs(gxshape_lattice *lattice, gxshape_fn field, const void *shape) {
    size_t inside = 0;
    uint32_t node;
    for (node = 0; node < lattice->node_count; node++) {
        double x[3], value;
        gxshape_point(lattice, node, x);
        value = field(shape, x);
        lattice->sign[node] = (signed char)(value < 0.0 ? 1 : value > 0.0 ? -1 : 0);
        if (lattice->sign[node] >= 0 && gxshape_on_border(lattice, node)) return "reaches beyond its box";
        inside += value < 0.0;
    }
    return inside ? NULL : "is smaller than its spacing: no node of the lattice lies inside";
}

/* The share t of the way from a to b at which the field is 0, to 1e-12, by the false position method, where an end that
   stays counts half (Illinois). a and b are of unlike sign. */
static inline double gxshape_root(gxshape_fn field, const void *shape, const double a[3], const double b[3]) {
    double t[2] = {0.0, 1.0}, value[2], middle = 0.5;
    int step, i, last = -1;
    value[0] = field(shape, a);
    value[1] = field(shape, b);
    for (step = 0; step < 100 && t[1] - t[0] > 1e-12; step++) {
        double x[3], f;
        int side;
        middle = t[0] + (t[1] - t[0]) * (value[0] / (value[0] - value[1]));
        for (i = 0; i < 3; i++) x[i] = a[i] + middle * (b[i] - a[i]);
        f = field(shape, x);
        if (f == 0.0 || middle <= t[0] || middle >= t[1]) break;
        side = (f < 0.0) == (value[0] < 0.0) ? 0 : 1;
        t[side] = middle;
        value[side] = f;
        if (side == last) value[1 - side] *= 0.5;
        last = side;
    }
    return middle;
}

static inline int gxshape_add_crossing(gxshape_lattice *lattice, uint32_t a, uint32_t b, gxshape_fn field,
                                       const void *shape) {
    double from[3], to[3];
    gxshape_crossing *crossing;
    int i;
    if (lattice->crossing_count == lattice->crossing_room) {
        const size_t room = lattice->crossing_room ? 2 * lattice->crossing_room : 1024;
        gxshape_crossing *grown = (gxshape_crossing *)realloc(lattice->crossings, room * sizeof *grown);
        if (!grown) return 0;
        lattice->crossings = grown;
        lattice->crossing_room = room;
    }
    gxshape_point(lattice, a, from);
    gxshape_point(lattice, b, to);
    crossing = lattice->crossings + lattice->crossing_count++;
    crossing->t = gxshape_root(field, shape, from, to);
    for (i = 0; i < 3; i++) crossing->x[i] = from[i] + crossing->t * (to[i] - from[i]);
    crossing->upper = b;
    crossing->vertex = GXSHAPE_NONE;
    return 1;
}

static inline const char *gxshape_lattice_cross(gxshape_lattice *lattice, gxshape_fn field, const void *shape) {
    uint32_t node;
    int edge;
    for (node = 0; node < lattice->node_count; node++) {
        lattice->start[node] = (uint32_t)lattice->crossing_count;
        for (edge = 0; edge < GXSHAPE_EDGES && lattice->sign[node]; edge++) {
            const uint32_t other = gxshape_neighbour(lattice, node, edge);
            if (other == GXSHAPE_NONE || other < node || lattice->sign[other] != -lattice->sign[node]) continue;
            if (!gxshape_add_crossing(lattice, node, other, field, shape)) return "out of memory";
        }
    }
    lattice->start[lattice->node_count] = (uint32_t)lattice->crossing_count;
    return NULL;
}

/* A node that a crossing comes too close to is moved onto the nearest one and is then on the surface; the crossings of
   all its edges are void. The shares of an edge are those for which LS prove 10.7 to 164.8 degrees. */
static inline void gxshape_lattice_warp(gxshape_lattice *lattice) {
    const double too_close_long = 0.24999, too_close_short = 0.41189, short_length = 0.8660254037844386;
    uint32_t node;
    int edge;
    for (node = 0; node < lattice->node_count; node++) {
        double least = DBL_MAX;
        for (edge = 0; edge < GXSHAPE_EDGES && lattice->sign[node]; edge++) {
            const uint32_t other = gxshape_neighbour(lattice, node, edge);
            uint32_t crossing;
            double share, distance;
            if (other == GXSHAPE_NONE || lattice->sign[other] != -lattice->sign[node]) continue;
            crossing = gxshape_find_crossing(lattice, node, other);
            share = node < other ? lattice->crossings[crossing].t : 1.0 - lattice->crossings[crossing].t;
            distance = edge < GXSHAPE_LONG_EDGES ? share : short_length * share;
            if (share >= (edge < GXSHAPE_LONG_EDGES ? too_close_long : too_close_short) || distance >= least) continue;
            least = distance;
            lattice->moved[node] = crossing;
        }
        if (lattice->moved[node] != GXSHAPE_NONE) lattice->sign[node] = 0;
    }
}

/* --------------------------------------------------------------------------------------------- >>stuffing */

typedef struct gxshape_mesh {
    double *positions; /* node_count x 3 */
    size_t node_count, node_room;
    uint32_t *elements; /* element_count x 4, positive volume */
    size_t element_count, element_room;
} gxshape_mesh;

static inline void gxshape_mesh_release(gxshape_mesh *mesh) {
    free(mesh->positions);
    free(mesh->elements);
    memset(mesh, 0, sizeof *mesh);
}

/* A mesh that grows out of a lattice. */
typedef struct gxshape_stuffer {
    gxshape_lattice *lattice;
    gxshape_mesh *mesh;
    int out_of_memory;
} gxshape_stuffer;

static inline uint32_t gxshape_add_vertex(gxshape_stuffer *stuffer, const double x[3]) {
    gxshape_mesh *mesh = stuffer->mesh;
    if (mesh->node_count == mesh->node_room) {
        const size_t room = mesh->node_room ? 2 * mesh->node_room : 1024;
        double *grown = (double *)realloc(mesh->positions, room * 3 * sizeof(double));
        if (!grown) {
            stuffer->out_of_memory = 1;
            return GXSHAPE_NONE;
        }
        mesh->positions = grown;
        mesh->node_room = room;
    }
    memcpy(mesh->positions + 3 * mesh->node_count, x, 3 * sizeof(double));
    return (uint32_t)mesh->node_count++;
}

/* The mesh's vertex at a node of the lattice. */
static inline uint32_t gxshape_at_node(gxshape_stuffer *stuffer, uint32_t node) {
    gxshape_lattice *lattice = stuffer->lattice;
    if (lattice->vertex[node] == GXSHAPE_NONE) {
        double x[3];
        if (lattice->moved[node] == GXSHAPE_NONE)
            gxshape_point(lattice, node, x);
        else
            memcpy(x, lattice->crossings[lattice->moved[node]].x, sizeof x);
        lattice->vertex[node] = gxshape_add_vertex(stuffer, x);
    }
    return lattice->vertex[node];
}

/* The mesh's vertex where the surface crosses the edge from a to b. */
static inline uint32_t gxshape_at_crossing(gxshape_stuffer *stuffer, uint32_t a, uint32_t b) {
    gxshape_crossing *crossing = stuffer->lattice->crossings + gxshape_find_crossing(stuffer->lattice, a, b);
    if (crossing->vertex == GXSHAPE_NONE) crossing->vertex = gxshape_add_vertex(stuffer, crossing->x);
    return crossing->vertex;
}

/* A tetrahedron of the lattice with its nodes sorted: inside, on the surface, outside. */
typedef struct gxshape_cell {
    uint32_t node[4];
    int inside, outside; /* how many */
    int mirrored;        /* 1: in this order its volume is negative */
} gxshape_cell;

static inline void gxshape_add_element(gxshape_stuffer *stuffer, int mirrored, uint32_t a, uint32_t b, uint32_t c,
                                       uint32_t d) {
    gxshape_mesh *mesh = stuffer->mesh;
    uint32_t *corner;
    if (mesh->element_count == mesh->element_room) {
        const size_t room = mesh->element_room ? 2 * mesh->element_room : 4096;
        uint32_t *grown = (uint32_t *)realloc(mesh->elements, room * 4 * sizeof(uint32_t));
        if (!grown) {
            stuffer->out_of_memory = 1;
            return;
        }
        mesh->elements = grown;
        mesh->element_room = room;
    }
    corner = mesh->elements + 4 * mesh->element_count++;
    corner[0] = a;
    corner[1] = b;
    corner[2] = mirrored ? d : c;
    corner[3] = mirrored ? c : d;
}

/* Of a lattice triangle with a and b inside and c outside, the quadrilateral a, b, and the crossings towards c is left.
   Its diagonal starts at a (1) or b (0): it ends in the crossing of the long edge; if both cross short edges, it starts
   at the one of a and b whose coordinates, counted in cubes, have an even sum (LS's parity rule). So both tetrahedra at
   the triangle agree. */
static inline int gxshape_diagonal_from_first(const gxshape_lattice *lattice, uint32_t a, uint32_t b, uint32_t c) {
    int64_t at[3];
    if (!gxshape_is_long(lattice, a, b)) return gxshape_is_long(lattice, b, c);
    gxshape_coordinates(lattice, a, at);
    return ((at[0] >> 1) + (at[1] >> 1) + (at[2] >> 1)) % 2 == 0;
}

/* A prism between the triangles p and q as three tetrahedra. from[i]: the diagonal of the quadrilateral opposite to
   corner i, whose corners are j = i + 1 and k = i + 2 of p and q, runs from p[j] to q[k] (1) or from p[k] to q[j] (0);
   not all alike. Sorted such that all diagonals start at an earlier corner of p, it is p0 p1 p2 q2, p0 p1 q2 q1, p0 q1
   q2 q0 up to their sense. */
static inline void gxshape_add_prism(gxshape_stuffer *stuffer, int mirrored, const uint32_t p[3], const uint32_t q[3],
                                     const int from[3]) {
    int order[3] = {0, 0, 0}, i, a, b, c;
    for (i = 0; i < 3; i++) {
        const int starts = from[(i + 2) % 3] + !from[(i + 1) % 3]; /* diagonals that start at p[i] */
        order[2 - starts] = i;
    }
    a = order[0];
    b = order[1];
    c = order[2];
    if (b != (a + 1) % 3) mirrored = !mirrored;
    gxshape_add_element(stuffer, mirrored, p[a], p[b], p[c], q[c]);
    gxshape_add_element(stuffer, mirrored, p[a], p[b], q[c], q[b]);
    gxshape_add_element(stuffer, mirrored, p[a], q[b], q[c], q[a]);
}

/* One node inside: its corner of the tetrahedron. */
static inline void gxshape_fill_corner(gxshape_stuffer *stuffer, const gxshape_cell *cell) {
    uint32_t v[4];
    int i;
    for (i = 0; i < 4; i++)
        v[i] = i < 4 - cell->outside ? gxshape_at_node(stuffer, cell->node[i])
                                     : gxshape_at_crossing(stuffer, cell->node[0], cell->node[i]);
    gxshape_add_element(stuffer, cell->mirrored, v[0], v[1], v[2], v[3]);
}

/* Two inside, one on the surface, one outside: a pyramid over a quadrilateral. */
static inline void gxshape_fill_pyramid(gxshape_stuffer *stuffer, const gxshape_cell *cell) {
    const uint32_t *node = cell->node;
    const uint32_t a = gxshape_at_node(stuffer, node[0]), a_cut = gxshape_at_crossing(stuffer, node[0], node[3]);
    const uint32_t b = gxshape_at_node(stuffer, node[1]), b_cut = gxshape_at_crossing(stuffer, node[1], node[3]);
    const uint32_t top = gxshape_at_node(stuffer, node[2]);
    if (gxshape_diagonal_from_first(stuffer->lattice, node[0], node[1], node[3])) {
        gxshape_add_element(stuffer, cell->mirrored, a, b, top, b_cut);
        gxshape_add_element(stuffer, cell->mirrored, a, b_cut, top, a_cut);
    } else {
        gxshape_add_element(stuffer, cell->mirrored, a, b, top, a_cut);
        gxshape_add_element(stuffer, cell->mirrored, a_cut, b, top, b_cut);
    }
}

static inline double gxshape_distance(const gxshape_mesh *mesh, uint32_t a, uint32_t b) {
    double d[3];
    int i;
    for (i = 0; i < 3; i++)
        d[i] = mesh->positions[3 * (size_t)a + (size_t)i] - mesh->positions[3 * (size_t)b + (size_t)i];
    return gxshape_length(d);
}

/* Two inside, two outside: a prism whose triangles are a corner at each node inside. The quadrilateral on the surface
   takes the diagonal that the other two leave, or the shorter if they leave both. */
static inline void gxshape_fill_wedge(gxshape_stuffer *stuffer, const gxshape_cell *cell) {
    const uint32_t *node = cell->node;
    uint32_t p[3], q[3];
    int from[3], i;
    p[0] = gxshape_at_node(stuffer, node[0]);
    q[0] = gxshape_at_node(stuffer, node[1]);
    for (i = 1; i < 3; i++) {
        p[i] = gxshape_at_crossing(stuffer, node[0], node[i + 1]);
        q[i] = gxshape_at_crossing(stuffer, node[1], node[i + 1]);
    }
    if (stuffer->out_of_memory) return;
    from[2] = gxshape_diagonal_from_first(stuffer->lattice, node[0], node[1], node[2]);
    from[1] = !gxshape_diagonal_from_first(stuffer->lattice, node[0], node[1], node[3]);
    if (from[1] == from[2])
        from[0] = !from[1];
    else
        from[0] = gxshape_distance(stuffer->mesh, p[1], q[2]) <= gxshape_distance(stuffer->mesh, p[2], q[1]);
    gxshape_add_prism(stuffer, cell->mirrored, p, q, from);
}

/* Three inside, one outside: the tetrahedron without that corner. */
static inline void gxshape_fill_stump(gxshape_stuffer *stuffer, const gxshape_cell *cell) {
    const uint32_t *node = cell->node;
    uint32_t p[3], q[3];
    int from[3], i;
    for (i = 0; i < 3; i++) {
        p[i] = gxshape_at_node(stuffer, node[i]);
        q[i] = gxshape_at_crossing(stuffer, node[i], node[3]);
        from[i] = gxshape_diagonal_from_first(stuffer->lattice, node[(i + 1) % 3], node[(i + 2) % 3], node[3]);
    }
    gxshape_add_prism(stuffer, cell->mirrored, p, q, from);
}

/* Sorts the nodes of a tetrahedron of positive volume by sign; each exchange mirrors it. */
static inline gxshape_cell gxshape_cell_make(const gxshape_lattice *lattice, const uint32_t node[4]) {
    gxshape_cell cell;
    int i, j;
    memcpy(cell.node, node, sizeof cell.node);
    cell.inside = cell.outside = cell.mirrored = 0;
    for (i = 0; i < 4; i++) {
        cell.inside += lattice->sign[node[i]] > 0;
        cell.outside += lattice->sign[node[i]] < 0;
        for (j = i; j > 0 && lattice->sign[cell.node[j - 1]] < lattice->sign[cell.node[j]]; j--) {
            const uint32_t swap = cell.node[j];
            cell.node[j] = cell.node[j - 1];
            cell.node[j - 1] = swap;
            cell.mirrored = !cell.mirrored;
        }
    }
    return cell;
}

/* What of a lattice tetrahedron lies inside: LS's stencils. */
static inline void gxshape_fill_cell(gxshape_stuffer *stuffer, const uint32_t node[4]) {
    const gxshape_cell cell = gxshape_cell_make(stuffer->lattice, node);
    if (!cell.inside) return;
    if (cell.inside == 1 || !cell.outside)
        gxshape_fill_corner(stuffer, &cell);
    else if (cell.inside == 3)
        gxshape_fill_stump(stuffer, &cell);
    else if (cell.outside == 2)
        gxshape_fill_wedge(stuffer, &cell);
    else
        gxshape_fill_pyramid(stuffer, &cell);
}

/* The four tetrahedra around the long edge from a centre to the next along an axis: the edge with each side of the
   square between the two cubes. */
static inline void gxshape_fill_edge(gxshape_stuffer *stuffer, uint32_t center, int axis) {
    static const int ring[5][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1}};
    const uint32_t next = gxshape_neighbour(stuffer->lattice, center, 2 * axis + 1);
    uint32_t corner[5], node[4];
    int64_t c[3];
    int i;
    if (next == GXSHAPE_NONE) return;
    for (i = 0; i < 5; i++) {
        gxshape_coordinates(stuffer->lattice, center, c);
        c[axis] += 1;
        c[(axis + 1) % 3] += ring[i][0];
        c[(axis + 2) % 3] += ring[i][1];
        corner[i] = gxshape_node(stuffer->lattice, c);
    }
    for (i = 0; i < 4; i++) {
        node[0] = center;
        node[1] = next;
        node[2] = corner[i];
        node[3] = corner[i + 1];
        gxshape_fill_cell(stuffer, node);
    }
}

static inline const char *gxshape_lattice_fill(gxshape_lattice *lattice, gxshape_mesh *mesh) {
    gxshape_stuffer stuffer;
    size_t center;
    int axis;
    stuffer.lattice = lattice;
    stuffer.mesh = mesh;
    stuffer.out_of_memory = 0;
    for (center = lattice->corner_count; center < lattice->node_count; center++)
        for (axis = 0; axis < 3; axis++) gxshape_fill_edge(&stuffer, (uint32_t)center, axis);
    if (stuffer.out_of_memory) return "out of memory";
    return mesh->element_count ? NULL : "is smaller than its spacing: it has no element";
}

/* Fills the part of the box in which the field is negative, which must not reach the box's faces, by tetrahedra with
   edges about as long as the spacing (> 0); the mesh's boundary points lie where the field is 0. What is thinner than 2
   GXSHAPE_THINNEST spacings may be missing or in pieces, and across a narrower gap the boundary may touch itself.
   Returns NULL, or what is wrong; the mesh is then empty. The mesh's arrays are the caller's, see gxshape_mesh_release.
 */
static inline const char *gxshape_stuff(gxshape_fn field, const void *shape, const double low[3], const double high[3],
                                        double spacing, gxshape_mesh *mesh) {
    gxshape_lattice lattice;
    const char *wrong = gxshape_lattice_make(&lattice, low, high, spacing);
    memset(mesh, 0, sizeof *mesh);
    if (!wrong) wrong = gxshape_lattice_signs(&lattice, field, shape);
    if (!wrong) wrong = gxshape_lattice_cross(&lattice, field, shape);
    if (!wrong) {
        gxshape_lattice_warp(&lattice);
        wrong = gxshape_lattice_fill(&lattice, mesh);
    }
    gxshape_lattice_release(&lattice);
    if (wrong) gxshape_mesh_release(mesh);
    return wrong;
}

/* ----------------------------------------------------------------------------------------------- >>shapes */

/* The least radius of a tube, in spacings, that certainly comes out in one piece: the line along it passes through
   cells of the lattice (of nearest nodes, all within sqrt(5)/4) that meet in faces, so their nodes are joined by edges;
   and none of them is moved onto the surface, which is 0.41189 sqrt(3)/2 away at least. */
#define GXSHAPE_THINNEST 0.92

static inline void gxshape_add(gxshape_field *field, const gxshape_part *parts, size_t count) {
    memcpy(field->parts + field->part_count, parts, count * sizeof *parts);
    field->part_count += count;
}

/* Parts and their mirror images in x = 0. */
static inline void gxshape_add_pairs(gxshape_field *field, const gxshape_part *parts, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        gxshape_part image = parts[i];
        image.p[0] = -image.p[0];
        if (image.kind == GXSHAPE_CAPSULE) image.q[0] = -image.q[0];
        gxshape_add(field, parts + i, 1);
        gxshape_add(field, &image, 1);
    }
}

/* An arm along the parabola (Bezier curve) from root to tip that leaves towards the elbow, thinner towards the tip. */
static inline void gxshape_add_arm(gxshape_field *field, const double root[3], const double elbow[3],
                                   const double tip[3]) {
    const int pieces = 8;
    const double thick = 0.035, thin = 0.011; /* radii, m */
    int piece, i;
    for (piece = 0; piece < pieces; piece++) {
        gxshape_part part;
        const double t = (double)piece / pieces, s = (double)(piece + 1) / pieces;
        part.kind = GXSHAPE_CAPSULE;
        for (i = 0; i < 3; i++) {
            part.p[i] = (1 - t) * (1 - t) * root[i] + 2 * t * (1 - t) * elbow[i] + t * t * tip[i];
            part.q[i] = (1 - s) * (1 - s) * root[i] + 2 * s * (1 - s) * elbow[i] + s * s * tip[i];
        }
        part.r[0] = thick + t * (thin - thick);
        part.r[1] = thick + s * (thin - thick);
        part.blend = piece < 2 ? 0.03 : 0.0; /* a web between the roots */
        gxshape_add(field, &part, 1);
    }
}

/* Head towards -z, eight arms in a ring about the z axis; about 1 m across. */
static inline void gxshape_octopus(gxshape_field *field) {
    /* clang-format off */
    static const gxshape_part head[4] = {
        {GXSHAPE_ELLIPSOID, {0.005, -0.065, -0.075}, {0.095, 0.095, 0.110}, {0, 0}, 0},
        {GXSHAPE_CAPSULE, {0.010, -0.060, 0.000}, {0.010, -0.055, 0.055}, {0.070, 0.055}, 0.04},
        {GXSHAPE_CAPSULE, {-0.045, 0.010, -0.055}, {-0.045, 0.010, -0.055}, {0.024, 0.024}, 0.015},
        {GXSHAPE_CAPSULE, {0.055, 0.010, -0.055}, {0.055, 0.010, -0.055}, {0.024, 0.024}, 0.015}};
    /* clang-format on */
    static const double root[3] = {0.010, -0.055, 0.060};
    /* clang-format off */
    static const double arm[8][2][3] = {                /* elbow, tip */
        {{0.300, -0.150, 0.080}, {0.515, -0.020, 0.045}},
        {{0.260, 0.160, 0.160}, {0.330, 0.240, -0.130}},
        {{0.020, 0.230, 0.160}, {0.070, 0.404, -0.100}},
        {{-0.200, 0.160, 0.140}, {-0.220, 0.240, -0.178}},
        {{-0.300, -0.020, 0.080}, {-0.448, 0.060, -0.020}},
        {{-0.240, -0.200, -0.060}, {-0.220, -0.180, 0.343}},
        {{-0.010, -0.280, -0.060}, {0.060, -0.306, 0.200}},
        {{0.210, -0.200, 0.020}, {0.200, -0.280, 0.270}}};
    /* clang-format on */
    int i;
    gxshape_add(field, head, 4);
    for (i = 0; i < 8; i++) gxshape_add_arm(field, root, arm[i][0], arm[i][1]);
}

/* Faces -x, ears up (y), sits on y = 0.033; 0.16 m long. */
static inline void gxshape_bunny(gxshape_field *field) {
    /* clang-format off */
    static const gxshape_part part[] = {
        {GXSHAPE_ELLIPSOID, {0.006, 0.085, 0.010}, {0.048, 0.046, 0.042}, {0, 0}, 0},                       /* back */
        {GXSHAPE_ELLIPSOID, {-0.050, 0.085, 0.010}, {0.036, 0.036, 0.033}, {0, 0}, 0.030},                  /* chest */
        {GXSHAPE_ELLIPSOID, {-0.064, 0.132, 0.018}, {0.025, 0.023, 0.022}, {0, 0}, 0.015},                  /* head */
        {GXSHAPE_CAPSULE, {-0.080, 0.125, 0.022}, {-0.080, 0.125, 0.022}, {0.014, 0.014}, 0.015},           /* nose */
        {GXSHAPE_CAPSULE, {-0.056, 0.146, 0.010}, {-0.032, 0.163, -0.006}, {0.008, 0.0105}, 0.006},         /* ears */
        {GXSHAPE_CAPSULE, {-0.032, 0.163, -0.006}, {-0.010, 0.179, -0.024}, {0.0105, 0.008}, 0},
        {GXSHAPE_CAPSULE, {-0.066, 0.150, 0.006}, {-0.067, 0.166, -0.020}, {0.008, 0.0105}, 0.006},
        {GXSHAPE_CAPSULE, {-0.067, 0.166, -0.020}, {-0.067, 0.174, -0.053}, {0.0105, 0.008}, 0},
        {GXSHAPE_CAPSULE, {0.048, 0.056, 0.011}, {0.048, 0.056, 0.011}, {0.0135, 0.0135}, 0.004},           /* tail */
        {GXSHAPE_ELLIPSOID, {0.016, 0.071, 0.043}, {0.030, 0.032, 0.016}, {0, 0}, 0.006},                   /* thighs */
        {GXSHAPE_ELLIPSOID, {0.016, 0.071, -0.031}, {0.030, 0.032, 0.016}, {0, 0}, 0.006},
        /* hind feet */
        {GXSHAPE_CAPSULE, {0.026, 0.045, 0.044}, {-0.018, 0.044, 0.046}, {0.011, 0.010}, 0.006},
        {GXSHAPE_CAPSULE, {0.026, 0.045, -0.034}, {-0.018, 0.044, -0.036}, {0.011, 0.010}, 0.006},
        /* fore legs */
        {GXSHAPE_CAPSULE, {-0.050, 0.066, 0.024}, {-0.054, 0.044, 0.026}, {0.012, 0.010}, 0.010},
        {GXSHAPE_CAPSULE, {-0.050, 0.066, -0.004}, {-0.054, 0.044, -0.006}, {0.012, 0.010}, 0.010},
        {GXSHAPE_CAPSULE, {-0.054, 0.042, 0.026}, {-0.068, 0.042, 0.026}, {0.009, 0.009}, 0.004},           /* paws */
        {GXSHAPE_CAPSULE, {-0.054, 0.042, -0.006}, {-0.068, 0.042, -0.006}, {0.009, 0.009}, 0.004},
        {GXSHAPE_BOX, {-0.012, 0.0480, 0.005}, {0.040, 0.0125, 0.034}, {0, 0}, 0.008}};                     /* belly */
    /* clang-format on */
    gxshape_add(field, part, sizeof part / sizeof *part);
}

/* Faces -z, stands up along y, symmetric in x; 151 units tall. */
static inline void gxshape_armadillo(gxshape_field *field) {
    /* clang-format off */
    static const gxshape_part middle[] = {
        {GXSHAPE_ELLIPSOID, {0, 61, 8}, {27, 27, 27}, {0, 0}, 0},                       /* shell */
        {GXSHAPE_ELLIPSOID, {0, 28, 2}, {21, 24, 18}, {0, 0}, 8},                       /* belly */
        {GXSHAPE_CAPSULE, {0, 74, -18}, {0, 72, -28}, {15, 12}, 6},                     /* head */
        {GXSHAPE_CAPSULE, {0, 70, -30}, {0, 62, -44}, {9, 5}, 4},                       /* snout */
        {GXSHAPE_CAPSULE, {0, 12, 14}, {0, 6, 34}, {8, 6}, 5},                          /* tail */
        {GXSHAPE_CAPSULE, {0, 6, 34}, {0, -8, 54}, {6, 3.5}, 0}};
    /* clang-format on */
    /* clang-format off */
    static const gxshape_part side[] = {
        {GXSHAPE_CAPSULE, {9, 84, -20}, {19, 93, -22}, {5, 4}, 3},                      /* ear */
        {GXSHAPE_CAPSULE, {23, 58, 0}, {50, 53, -9}, {11, 9}, 6},                       /* upper arm */
        {GXSHAPE_CAPSULE, {50, 53, -9}, {55, 68, -32}, {9, 7}, 3},                      /* forearm */
        {GXSHAPE_CAPSULE, {55, 68, -32}, {50, 80, -46}, {6, 4}, 4},                     /* fingers */
        {GXSHAPE_CAPSULE, {55, 68, -32}, {56, 83, -46}, {6, 4}, 4},
        {GXSHAPE_CAPSULE, {55, 68, -32}, {59.5, 77, -53.5}, {6, 4}, 4},
        {GXSHAPE_CAPSULE, {15, 14, 0}, {26, -13, -2}, {16, 12}, 8},                     /* thigh */
        {GXSHAPE_CAPSULE, {26, -13, -2}, {27, -42, 14}, {12, 9}, 3},                    /* shin */
        {GXSHAPE_CAPSULE, {27, -46, 16}, {30, -48, -1}, {8, 6}, 4},                     /* foot */
        {GXSHAPE_CAPSULE, {30, -48, -1}, {36, -50, -6}, {5, 4}, 2}};                    /* toe */
    /* clang-format on */
    gxshape_add(field, middle, sizeof middle / sizeof *middle);
    gxshape_add_pairs(field, side, sizeof side / sizeof *side);
}

/* A plate of 4 x 2 x 0.22 m, its middle plane z = 0, with balls, posts, cones and rings on it. */
static inline void gxshape_objects(gxshape_field *field) {
    /* clang-format off */
    static const gxshape_part part[] = {
        {GXSHAPE_BOX, {0, 0, 0}, {2, 1, 0.11}, {0, 0}, 0},                               /* plate */
        {GXSHAPE_CAPSULE, {-1.5, 0.5, 0.30}, {-1.5, 0.5, 0.30}, {0.32, 0.32}, 0.1},     /* balls */
        {GXSHAPE_CAPSULE, {0.2, -0.6, 0.22}, {0.2, -0.6, 0.22}, {0.22, 0.22}, 0.1},
        {GXSHAPE_CAPSULE, {1.6, 0.6, 0.25}, {1.6, 0.6, 0.25}, {0.25, 0.25}, 0.1},
        {GXSHAPE_FRUSTUM, {-1.5, -0.5, 0}, {-1.5, -0.5, 0.80}, {0.15, 0.15}, 0.1},      /* posts */
        {GXSHAPE_FRUSTUM, {-0.8, -0.5, 0}, {-0.8, -0.5, 0.65}, {0.12, 0.12}, 0.1},
        {GXSHAPE_FRUSTUM, {1.1, 0.3, 0}, {1.1, 0.3, 0.85}, {0.12, 0.12}, 0.1},
        {GXSHAPE_FRUSTUM, {0.45, 0.5, 0}, {0.45, 0.5, 0.85}, {0.36, 0.06}, 0.1},          /* cones */
        {GXSHAPE_FRUSTUM, {1.65, -0.1, 0}, {1.65, -0.1, 0.60}, {0.24, 0.06}, 0.1},
        {GXSHAPE_RING, {-0.7, 0.4, 0.40}, {0, 1, 0}, {0.32, 0.10}, 0.1},                /* rings: upright, lying */
        {GXSHAPE_RING, {1.0, -0.5, 0.14}, {0, 0, 1}, {0.30, 0.10}, 0.1}};
    /* clang-format on */
    gxshape_add(field, part, sizeof part / sizeof *part);
}

typedef struct gxshape_named {
    const char *name;
    void (*make)(gxshape_field *field);
    double spacing, coarsest; /* m; where none is given; the largest at which the shape is still itself */
} gxshape_named;

/* The shape whose name is the first `length` characters of `name`, or NULL. */
static inline const gxshape_named *gxshape_find(const char *name, size_t length) {
    /* clang-format off */
    static const gxshape_named named[] = {
        {"octopus", gxshape_octopus, 0.0188, 0.05},
        {"bunny", gxshape_bunny, 0.0085, 0.02},
        {"armadillo", gxshape_armadillo, 3.9, 10},
        {"objects", gxshape_objects, 0.058, 0.1},
        {NULL, NULL, 0, 0}};
    /* clang-format on */
    const gxshape_named *at;
    for (at = named; at->name; at++)
        if (strlen(at->name) == length && strncmp(at->name, name, length) == 0) return at;
    return NULL;
}

/* No part is thinner than the lattice can hold. */
static inline void gxshape_thicken(gxshape_field *field, double radius) {
    size_t i;
    int j;
    for (i = 0; i < field->part_count; i++) {
        gxshape_part *part = &field->parts[i];
        const int extents = part->kind == GXSHAPE_ELLIPSOID || part->kind == GXSHAPE_BOX;
        for (j = 0; j < 3 && extents; j++) part->q[j] = fmax(part->q[j], radius);
        for (j = 0; j < 2 && !extents; j++) part->r[j] = fmax(part->r[j], radius);
    }
}

/* The box around all parts, wider by the widest blend: one blend bulges by a quarter of that at most. */
static inline void gxshape_bound(gxshape_field *field) {
    double blend = 0.0;
    size_t i;
    int j;
    for (j = 0; j < 3; j++) {
        field->low[j] = DBL_MAX;
        field->high[j] = -DBL_MAX;
    }
    for (i = 0; i < field->part_count; i++) {
        const gxshape_part *part = &field->parts[i];
        const int two_ends = part->kind == GXSHAPE_CAPSULE || part->kind == GXSHAPE_FRUSTUM;
        for (j = 0; j < 3; j++) {
            const double reach = two_ends                   ? part->r[0]
                               : part->kind == GXSHAPE_RING ? part->r[0] + part->r[1]
                                                            : part->q[j];
            const double other = two_ends ? part->q[j] : part->p[j], other_reach = two_ends ? part->r[1] : reach;
            field->low[j] = fmin(field->low[j], fmin(part->p[j] - reach, other - other_reach));
            field->high[j] = fmax(field->high[j], fmax(part->p[j] + reach, other + other_reach));
        }
        blend = fmax(blend, part->blend);
    }
    for (j = 0; j < 3; j++) {
        field->low[j] -= blend;
        field->high[j] += blend;
    }
}

/* Fills a shape of parts, each at least so thick that the lattice can hold it. Returns as gxshape_stuff. */
static inline const char *gxshape_fill(gxshape_field *field, double spacing, gxshape_mesh *mesh) {
    gxshape_thicken(field, GXSHAPE_THINNEST * spacing);
    gxshape_bound(field);
    return gxshape_stuff(gxshape_field_value, field, field->low, field->high, spacing, mesh);
}
#endif /* GXSHAPE_H */
