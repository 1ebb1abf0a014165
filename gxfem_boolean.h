/* gxfem_boolean.h - exact geometry for cutting: predicates, and the cell complex that cuts leave. Part of gxfem 0.1.
 *
 * A convex region (a tetrahedron, or a mesh of them) is divided by triangles, any number of them, lying and crossing as they
 * like. Every decision is the sign of a polynomial in the given coordinates and is exact, under any compiler flag.
 *
 * One minute:
 *
 *     #define GXFEM_BOOLEAN_IMPLEMENTATION
 *     #include "gxfem_boolean.h"
 *     #include <stdio.h>
 *     int main(void) {
 *         const double x[12] = {0,0,0, 1,0,0, 0,1,0, 0,0,1}, s[9] = {-9,-9,.25, 9,-9,.25, 0,9,.25};
 *         const uint32_t tet[4] = {0, 1, 2, 3};
 *         gxb_complex *cx = NULL;
 *         gxb_mesh mesh = {0};
 *         gxb_triangle cut = {{0, 0, 0}, 0, 0, {0, 0, 0}, 0, 1};
 *         mesh.positions = x; mesh.node_count = 4; mesh.elements = tet; mesh.element_count = 1;
 *         if (gxb_complex_create(&mesh, NULL, &cx, NULL)) return 1;
 *         gxb_complex_begin(cx);
 *         for (int i = 0; i < 3; i++) gxb_complex_add_point(cx, s + 3 * i, &cut.point[i]);
 *         gxb_complex_add_plane(cx, &cut);
 *         gxb_complex_insert(cx, &cut, 0, NULL, NULL);
 *         gxb_complex_commit(cx);
 *         printf("%u convex leaves\n", cx->leaf_count);
 *         gxb_complex_destroy(cx);
 *     }
 *
 * Contents (search for >>name):
 *     >>shared      result codes, allocator
 *     >>numbers     exact numbers: a double is an integer times a power of two, sums and products are too
 *     >>predicates  orient2d, orient3d, incircle, insphere, side of a plane, comparison, orientation in a plane, winding number
 *     >>complex     the cell complex: points, planes, edges, facets, leaves
 *     >>stream      a complex as bytes
 *     then, under GXFEM_BOOLEAN_IMPLEMENTATION, in this order: >>bits >>exact >>filter >>points >>memory >>topology
 *     >>split >>clip >>insert >>save >>check
 *
 * How the complex works. Each element of the mesh starts as one convex leaf, bounded by four facets, which it shares with its
 * neighbours. A triangle is clipped down the element's tree of planes (a binary space partition); each leaf whose inside it
 * meets is divided by the triangle's plane. The part of the dividing facet that the triangle covers is a wall, the rest is
 * open. So every leaf stays convex, and all that is ever asked is on which side of a plane a point lies. Points, edges and
 * facets are shared by all leaves around them: they are divided once, their neighbours see the pieces, and the complex
 * conforms at all times. Holes, dangling walls, detached walls and nested shells need no treatment of their own: what is
 * connected is what open facets join. See docs/ARCHITECTURE.md for the reasons.
 *
 * What it does not do (yet): Booleans of closed meshes.
 *
 * Guarantees and limits
 *     - Signs are exact for finite coordinates under every flag, rounding mode and flush-to-zero (but x87 set to 24 bits).
 *     - Coordinates in a complex: after subtraction of the mesh's origin and scaling by a power of two to its box they are 0 or
 *       of magnitude 2^-128 to 2^128, else GX_ERROR_RANGE. orient2d, orient3d, incircle and insphere take any
 *       finite double.
 *     - At most 2^31 - 1 points, planes, edges, facets and leaves.
 *     - No global state, no input or output, no heap traffic but the growth of the complex's own arrays.
 *
 * Configuration: GXB_LIMB32 uses 32-bit limbs also where 128-bit products exist (same results, slower).
 *
 * References: J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates (1997);
 *     M. Attene, Indirect predicates for geometric constructions (2020), for the term implicit point;
 *     Trettner, Nehring-Wirxel, Kobbelt, EMBER (2022), for planes as the only definers of points.
 */
#ifndef GXFEM_BOOLEAN_H
#define GXFEM_BOOLEAN_H

/* >>shared: this block is the same in every gxfem header; `make lint` compares the copies */
#ifndef GXFEM_SHARED_INCLUDED
#define GXFEM_SHARED_INCLUDED
#include <stddef.h>
#include <stdint.h>

/* GXFEM_STATIC makes every function private to the file that includes the headers */
#ifdef GXFEM_STATIC
#define GXFEM_API static inline
#else
#define GXFEM_API extern
#endif

/* What a function that can fail returns. On anything but GX_OK its inputs are as they were. */
typedef enum gx_result {
    GX_OK = 0,
    GX_ERROR_ARGUMENT,      /* a required pointer is NULL, a required field is zero or senseless */
    GX_ERROR_MEMORY,        /* the allocator returned NULL */
    GX_ERROR_NOT_FINITE,    /* a coordinate or parameter is NaN or infinite */
    GX_ERROR_RANGE,         /* a coordinate is too large or too small beside the others (see "limits") */
    GX_ERROR_INDEX,         /* an index points outside its array */
    GX_ERROR_EMPTY,         /* no elements, no nodes or no triangles */
    GX_ERROR_INVERTED,      /* an element has negative volume */
    GX_ERROR_FLAT,          /* an element has no volume */
    GX_ERROR_OVERLAP,       /* an element face is shared by more than two elements, or by two on one side */
    GX_ERROR_NOT_CLOSED,    /* a solid's surface has a boundary, or its triangles are not oriented alike */
    GX_ERROR_LIMIT,         /* more objects than 32-bit indices can name, or a caller's limit is reached */
    GX_ERROR_DIVERGED,      /* a time step found no finite state of lower energy */
    GX_ERROR_FREE,          /* a static balance is asked of a piece that nothing holds */
    GX_ERROR_FORMAT,        /* not a saved body, or one of another version or another kind of machine */
    GX_ERROR_DAMAGED        /* a saved body is cut short, or what it says cannot be */
} gx_result;

/* What went wrong, and where: index of the node, element, triangle or copy concerned. */
typedef struct gx_failure {
    gx_result result;
    size_t index;           /* SIZE_MAX: no single object is to blame */
    size_t surface;         /* of a cut: which of its surfaces; else SIZE_MAX */
} gx_failure;

/* Where memory comes from. Zero-initialised: malloc and free. */
typedef struct gx_allocator {
    void *(*allocate)(void *user, size_t size);             /* NULL when there is none; size is never 0 */
    void (*release)(void *user, void *memory, size_t size); /* size as it was allocated; memory is never NULL */
    void *user;
} gx_allocator;
/* How work is handed to the host's threads. Zero-initialised: the calling thread does it all. Results do not depend on it. */
typedef struct gx_jobs {
    /* Calls task(context, i) once for each i below count, on any threads, in any order, and returns when all have returned. */
    void (*parallel_for)(void *user, size_t count, void (*task)(void *context, size_t index), void *context);
    void *user;
} gx_jobs;
#endif /* GXFEM_SHARED_INCLUDED */
#ifdef __cplusplus
extern "C" {
#endif

/* >>numbers ---------------------------------------------------------------------------------------------------------- */

#if defined(__SIZEOF_INT128__) && !defined(GXB_LIMB32)
typedef uint64_t gxb_limb;
#define GXB_LIMB_BITS 64
#define GXB_NUM_LIMBS 168
#else
typedef uint32_t gxb_limb;
#define GXB_LIMB_BITS 32
#define GXB_NUM_LIMBS 336
#endif

/* sign * (d[0] + d[1] B + ... + d[n-1] B^(n-1)) * B^exp with B = 2^GXB_LIMB_BITS. Zero: sign 0, n 0. Neither end limb is 0.
   d points to room for GXB_NUM_LIMBS limbs: enough for polynomials of degree 20 in coordinates of 2^-128 ... 2^128. */
typedef struct gxb_num {
    int32_t sign, exp;
    uint32_t n;
    gxb_limb *d;
} gxb_num;

/* Declares a number x and its limbs on the stack. */
#define GXB_NUM(x) gxb_limb x##_limbs[GXB_NUM_LIMBS]; gxb_num x = {0, 0, 0, NULL}; x.d = x##_limbs

GXFEM_API void gxb_num_set(gxb_num *r, double value, int shift);                            /* r = value * 2^shift, exactly */
GXFEM_API void gxb_num_add(gxb_num *r, const gxb_num *a, const gxb_num *b);                 /* r = a + b; r is neither */
GXFEM_API void gxb_num_sub(gxb_num *r, const gxb_num *a, const gxb_num *b);                 /* r = a - b; r is neither */
GXFEM_API void gxb_num_mul(gxb_num *r, const gxb_num *a, const gxb_num *b);                 /* r = a * b; r is neither */
GXFEM_API double gxb_num_to_double(const gxb_num *a);                                       /* within one unit in the last place */
GXFEM_API double gxb_num_ratio(const gxb_num *a, const gxb_num *b);                         /* a / b, relative error below 2^-50 within 2^-1000 ... 2^1000 */

/* >>predicates ------------------------------------------------------------------------------------------------------- */

/* Sign of |a-c, b-c|: 1 where a, b, c turn counter-clockwise, 0 where they are collinear. */
GXFEM_API int gxb_orient2d(const double a[2], const double b[2], const double c[2]);
/* Sign of |a-d, b-d, c-d|: 1 where d lies below the plane in which a, b, c appear counter-clockwise from above. */
GXFEM_API int gxb_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);
/* 1 where d lies inside the circle through a, b, c, which turn counter-clockwise; -1 outside, 0 on it. */
GXFEM_API int gxb_incircle(const double a[2], const double b[2], const double c[2], const double d[2]);
/* 1 where e lies inside the sphere through a, b, c, d with gxb_orient3d(a, b, c, d) = 1; -1 outside, 0 on it. */
GXFEM_API int gxb_insphere(const double a[3], const double b[3], const double c[3], const double d[3], const double e[3]);

/* Coordinates for gxb_plane and gxb_point: 0 or of magnitude 2^-128 to 2^128. */

/* What the filter knows of a plane: n.(x - base) with proven errors (see >>filter). */
typedef struct gxb_plane_filter {
    double n[3];        /* approximate normal */
    double base[3];     /* a point of the plane, within base_error in each coordinate */
    double base_error;
    double error;       /* of each component of n */
    double norm;        /* largest |n[i]| */
} gxb_plane_filter;

/* A point within error of x in each coordinate; error >= 2^200: nothing is known. */
typedef struct gxb_ball { double x[3], error; } gxb_ball;

/* The plane of three points, not collinear; its normal is (q-p) x (r-p). The points must outlive it. */
typedef struct gxb_plane { gxb_plane_filter filter; const double *p, *q, *r; } gxb_plane;

/* A point given by coordinates (p), a line through p and q with a plane (plane[0]), or three planes. All must outlive it. */
typedef struct gxb_point { gxb_ball ball; const double *p, *q; const gxb_plane *plane[3]; } gxb_point;

GXFEM_API void gxb_plane_init(gxb_plane *plane, const double p[3], const double q[3], const double r[3]);
GXFEM_API void gxb_point_explicit(gxb_point *point, const double p[3]);
GXFEM_API void gxb_point_line_plane(gxb_point *point, const double p[3], const double q[3], const gxb_plane *plane);
GXFEM_API void gxb_point_three_planes(gxb_point *point, const gxb_plane *a, const gxb_plane *b, const gxb_plane *c);

/* 1 where the point lies on the side to which the plane's normal points, -1 on the other, 0 in the plane. */
GXFEM_API int gxb_side(const gxb_point *point, const gxb_plane *plane);
/* Sign of a[axis] - b[axis]. */
GXFEM_API int gxb_compare(const gxb_point *a, const gxb_point *b, int axis);
/* Orientation of three points of the plane, seen from the side to which its normal points. */
GXFEM_API int gxb_orient_in_plane(const gxb_point *a, const gxb_point *b, const gxb_point *c, const gxb_plane *plane);

/* How often a closed surface (vertices x 3, triangles x 3) winds around p, counted by exact ray crossings: 1 inside of a surface
   whose triangles are counter-clockwise from outside. *on_surface: p lies on a triangle, the number then means nothing. */
GXFEM_API int gxb_winding_number(const double *vertices, const uint32_t *triangles, size_t triangle_count, const double p[3],
                                 int *on_surface);

/* >>complex ---------------------------------------------------------------------------------------------------------- */

#define GXB_NONE UINT32_MAX

enum { GXB_EXPLICIT = 0, GXB_LINE_PLANE = 1, GXB_THREE_PLANES = 2 };

typedef struct gxb_cpoint {     /* a point of the complex */
    gxb_ball ball;              /* in the complex's frame: (x - origin) * 2^shift */
    uint32_t kind;              /* GXB_EXPLICIT ... */
    uint32_t def[3];            /* two points and a plane, or three planes */
    gxb_num *exact;             /* X Y Z W, or NULL until they were needed */
    uint32_t stamp[2];          /* when sign[i] was decided (complex.stamp[i]) */
    int32_t sign[2];
    uint32_t scratch;
    uint32_t wall;              /* 1: a triangle was made to separate here what meets in this node only */
    double parameter[2];        /* on a mesh edge: barycentric coordinates of its ends; negative until asked for */
} gxb_cpoint;

typedef struct gxb_cplane {     /* a plane: of three points, or through points 0 and 1 along coordinate axis def[2] */
    gxb_plane_filter filter;
    uint32_t along_axis;
    uint32_t def[3];
    gxb_num *exact;             /* n and d, or NULL until they were needed */
    uint32_t axis;              /* a component of the normal that is not 0 */
    int32_t axis_sign;          /* its sign */
} gxb_cplane;

typedef struct gxb_edge {
    uint32_t v[2];              /* points */
    uint32_t line[2];           /* two points (explicit_line) or two planes whose intersection carries the edge */
    uint32_t explicit_line;
    uint32_t child;             /* GXB_NONE, or the first of the two edges (child, child + 1) into which it was divided */
    uint32_t stamp;
    uint32_t wall;              /* 1: a triangle was made to separate here what meets in this edge only */
} gxb_edge;

typedef struct gxb_facet {      /* a convex polygon */
    uint32_t plane;
    uint32_t loop, loop_count;  /* in complex.pool: edge * 2 + (1 if walked backwards), counter-clockwise about the normal */
    uint32_t leaf[2];           /* in front (where the normal points), behind; GXB_NONE outside the mesh */
    uint32_t child;             /* GXB_NONE, or the first of the two facets (child, child + 1) into which it was divided */
    uint32_t labels;            /* in complex.labels, or GXB_NONE: triangles that cover it */
    uint32_t face;              /* the mesh face that it is part of, or GXB_NONE inside an element */
    uint32_t wall;              /* 1: material on its two sides is separated */
} gxb_facet;

typedef struct gxb_label { uint32_t triangle; int32_t orientation; uint32_t next; } gxb_label;

typedef struct gxb_leaf {       /* a convex piece of an element */
    uint32_t element;
    uint32_t facets, facet_count;   /* in complex.pool; count 0: an element that nothing has touched */
    uint32_t parent;            /* leaf from which it was split, GXB_NONE for an element's first */
    uint32_t removed;           /* set by the user of the complex */
} gxb_leaf;

typedef struct gxb_node {       /* of an element's tree of planes */
    uint32_t plane, child[2];   /* front, behind: leaf * 2 or node * 2 + 1 */
    uint32_t parent;            /* node, GXB_NONE: the element's root */
    uint32_t leaves;            /* below it */
} gxb_node;

typedef struct gxb_block { struct gxb_block *next; size_t size, used; } gxb_block;     /* of exact numbers; never moves */

/* A triangle to insert. Fill point and label, call gxb_complex_add_plane, insert. */
typedef struct gxb_triangle {
    uint32_t point[3];
    uint32_t plane;
    int32_t orientation;        /* 1, or -1 where the plane was made for a coplanar neighbour that faces the other way */
    uint32_t edge_plane[3];     /* through point[k], point[k+1]; made when needed */
    uint32_t label;             /* the caller's name for it */
    uint32_t wall;              /* 1: what it covers becomes a wall; 0: it only leaves its label */
} gxb_triangle;

typedef struct gxb_mesh {
    const double *positions;    /* node_count x 3 */
    size_t node_count;
    const uint32_t *elements;   /* element_count x 4, positive volume */
    size_t element_count;
} gxb_mesh;

typedef struct gxb_undo { uint32_t array, index; } gxb_undo;

/* All arrays belong to the complex and may be read; [i] is valid for i < count. Points 0 ... node_count-1 are the nodes, leaves
   0 ... element_count-1 the elements' first leaves. */
typedef struct gxb_complex {
    double origin[3]; int shift;
    uint32_t node_count, element_count, face_count, mesh_edge_count;
    uint32_t *elements;             /* the complex's copy, element_count x 4 */
    uint32_t *element_faces;        /* element_count x 4: face opposite to node k */
    uint32_t *element_edges;        /* element_count x 6: 01 02 03 12 13 23 */
    uint32_t *face_elements;        /* face_count x 2: GXB_NONE at the mesh's boundary */
    uint32_t *face_facet;           /* face_count: GXB_NONE until touched */
    uint32_t *mesh_edge;            /* mesh_edge_count: GXB_NONE until touched */
    uint32_t *root;                 /* element_count: tree reference */
    gxb_cpoint *points; uint32_t point_count, point_capacity;
    gxb_cplane *planes; uint32_t plane_count, plane_capacity;
    gxb_edge *edges; uint32_t edge_count, edge_capacity;
    gxb_facet *facets; uint32_t facet_count, facet_capacity;
    gxb_leaf *leaves; uint32_t leaf_count, leaf_capacity;
    gxb_node *nodes; uint32_t tree_count, tree_capacity;
    gxb_label *labels; uint32_t label_count, label_capacity;
    gxb_block *blocks;              /* exact coordinates, computed when first needed and kept */
    uint32_t *pool; uint32_t pool_count, pool_capacity, pool_live;
    uint32_t *walls; uint32_t wall_count, wall_capacity;    /* facets that became walls, or were labelled, since begin */
    gxb_undo *undo; uint32_t undo_count, undo_capacity;     /* what begin ... rollback restores, and the old contents */
    unsigned char *undo_bytes; uint32_t undo_byte_count, undo_byte_capacity;
    struct gxbp_corner *corners; uint32_t corner_count, corner_capacity;    /* stack of clipped polygons */
    struct gxbp_task *tasks; uint32_t task_count, task_capacity;
    uint32_t *scratch; uint32_t scratch_count, scratch_capacity;
    gxb_block *mark_block; size_t mark_used;    /* blocks at begin */
    uint32_t mark[8];               /* counts at begin: points planes edges facets leaves nodes labels pool */
    uint32_t stamp[2], edge_stamp, sign_plane;
    uint32_t height_element; double height[4];  /* see >>insert, barycentric coordinates */
    uint64_t filter_calls, exact_calls;
    gx_allocator allocator;
} gxb_complex;

/* The complex of a mesh. Errors: EMPTY, INDEX (element), NOT_FINITE and RANGE (node), INVERTED and FLAT (element), OVERLAP
   (element: one of its faces is shared by more than two elements, or by two on the same side), LIMIT, MEMORY. */
GXFEM_API gx_result gxb_complex_create(const gxb_mesh *mesh, const gx_allocator *allocator, gxb_complex **complex,
                                       gx_failure *failure);
GXFEM_API void gxb_complex_destroy(gxb_complex *complex);

/* What follows begin is kept by commit or undone by rollback. After an error only rollback may follow. */
GXFEM_API void gxb_complex_begin(gxb_complex *complex);
GXFEM_API void gxb_complex_commit(gxb_complex *complex);
GXFEM_API void gxb_complex_rollback(gxb_complex *complex);

/* Errors: NOT_FINITE, RANGE, MEMORY, LIMIT. */
GXFEM_API gx_result gxb_complex_add_point(gxb_complex *complex, const double x[3], uint32_t *point);
/* Sets plane and orientation from the points. GX_ERROR_FLAT: the triangle has no area. */
GXFEM_API gx_result gxb_complex_add_plane(gxb_complex *complex, gxb_triangle *triangle);
/* Divides the leaves of one element that the triangle meets, and labels the facets that it covers. allowed: leaves for which allowed(user, leaf) is 0 are left alone (NULL: none). */
GXFEM_API gx_result gxb_complex_insert(gxb_complex *complex, gxb_triangle *triangle, uint32_t element,
                                       int (*allowed)(void *user, uint32_t leaf), void *user);
/* Where elements meet in nothing but a mesh edge or a node: marks what the triangle covers of that edge (pieces of it get wall 1)
   or whether it covers the node. *covered is set to 1 if there is something, else left alone. */
GXFEM_API gx_result gxb_complex_cover_edge(gxb_complex *complex, gxb_triangle *triangle, uint32_t element, uint32_t local_edge,
                                           int *covered);
GXFEM_API gx_result gxb_complex_cover_node(gxb_complex *complex, gxb_triangle *triangle, uint32_t node, int *covered);
/* Makes a facet a wall. */
GXFEM_API gx_result gxb_complex_set_wall(gxb_complex *complex, uint32_t facet);
GXFEM_API gx_result gxb_complex_set_removed(gxb_complex *complex, uint32_t leaf);
/* Makes the four facets of an untouched element. */
GXFEM_API gx_result gxb_complex_open_element(gxb_complex *complex, uint32_t element);
/* The leaf's facets, as they are divided now (in complex.pool, until the next call that changes the complex). */
GXFEM_API gx_result gxb_leaf_facets(gxb_complex *complex, uint32_t leaf, uint32_t *first, uint32_t *count);
/* The facet's edges, as they are divided now. */
GXFEM_API gx_result gxb_facet_edges(gxb_complex *complex, uint32_t facet, uint32_t *first, uint32_t *count);

/* Sign of a point against a plane of the complex, exact. */
GXFEM_API int gxb_complex_side(gxb_complex *complex, uint32_t point, uint32_t plane);
/* Orientation of three points that lie in a plane of the complex, seen from the side to which its normal points, exact. */
GXFEM_API int gxb_complex_turn(gxb_complex *complex, uint32_t a, uint32_t b, uint32_t c, uint32_t plane);
/* Sign of point[axis] - value, exact. */
GXFEM_API int gxb_complex_compare(gxb_complex *complex, uint32_t point, int axis, double value);
/* gxb_winding_number around a point inside the convex hull of points of the complex: the sum of their homogeneous coordinates.
   Exact for hulls that no double lies in. The surface is in the given coordinates and must not pass through the hull's inside. */
GXFEM_API int gxb_complex_winding(gxb_complex *complex, const uint32_t *points, size_t point_count, const double *vertices,
                                  const uint32_t *triangles, size_t triangle_count);
/* Barycentric coordinates of a point in an element, each rounded on its own from its exact value (0 where it is 0), but one above
   0.2, which is 1 minus the others. */
GXFEM_API void gxb_complex_barycentric(gxb_complex *complex, uint32_t point, uint32_t element, double lambda[4]);
/* Bit k: its coordinate k is not 0 by the point's definition. Needs no arithmetic. */
GXFEM_API unsigned gxb_complex_support(const gxb_complex *complex, uint32_t point, uint32_t element);
/* The coordinates with a relative error below 2^-180. */
GXFEM_API void gxb_complex_barycentric_fine(gxb_complex *complex, uint32_t point, uint32_t element, gxb_num lambda[4]);

/* >>stream ----------------------------------------------------------------------------------------------------------- */

/* Bytes that are written, counted (out NULL) or read (in not NULL), in the machine's own order. The first error stays, and what is
   passed after it is not written, and read as 0. */
typedef struct gxb_stream {
    unsigned char *out;
    const unsigned char *in;
    size_t size, at;            /* room, or bytes there are; bytes passed */
    gx_result result;           /* GX_ERROR_LIMIT: no room; GX_ERROR_DAMAGED: no more bytes, or what they say cannot be */
} gxb_stream;
GXFEM_API void gxb_stream_pass(gxb_stream *stream, void *data, size_t count, size_t width);    /* count items of width bytes */
/* Reading: are there bytes for so many items? Else GX_ERROR_DAMAGED and 0, so that a count never asks for more memory than the bytes
   that it counts. */
GXFEM_API int gxb_stream_has(gxb_stream *stream, size_t count, size_t width);

/* What defines the complex, but for its mesh: no exact numbers, no signs, no lists that were replaced. Not within a transaction. */
GXFEM_API void gxb_complex_save(gxb_complex *complex, gxb_stream *stream);
/* Reads it into a complex just created of the same mesh. trusted 0: everything is checked that other functions rely on, exactly: in
   range, every tree a tree, facets convex polygons in their planes, leaves convex, closed and within their element's tree. After
   an error (that of the stream: DAMAGED, MEMORY, LIMIT) the complex can only be destroyed. */
GXFEM_API gx_result gxb_complex_load(gxb_complex *complex, gxb_stream *stream, int trusted);

#ifdef __cplusplus
}
#endif
#endif /* GXFEM_BOOLEAN_H: stop here for the interface */

#if defined(GXFEM_IMPLEMENTATION) && !defined(GXFEM_BOOLEAN_IMPLEMENTATION)
#define GXFEM_BOOLEAN_IMPLEMENTATION
#endif
#if defined(GXFEM_BOOLEAN_IMPLEMENTATION) && !defined(GXFEM_BOOLEAN_IMPLEMENTED)
#define GXFEM_BOOLEAN_IMPLEMENTED
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* >>bits: doubles taken apart and put together without floating-point arithmetic ---------------------------------------- */

static uint64_t gxbp_bits(double x) {
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}

static double gxbp_double(uint64_t b) {
    double x;
    memcpy(&x, &b, sizeof x);
    return x;
}

/* 2^e for -1022 <= e <= 1023 */
static double gxbp_power(int e) { return gxbp_double((uint64_t)(e + 1023) << 52); }

static int gxbp_exponent_bits(double x) { return (int)((gxbp_bits(x) >> 52) & 0x7ff); }
static int gxbp_is_finite(double x) { return gxbp_exponent_bits(x) != 0x7ff; }
static int gxbp_is_zero(double x) { return (gxbp_bits(x) << 1) == 0; }
static double gxbp_abs(double x) { return gxbp_double(gxbp_bits(x) & ~((uint64_t)1 << 63)); }

/* floor(log2 |x|) for finite x other than 0, also for denormals */
static int gxbp_exponent(double x) {
    const int e = gxbp_exponent_bits(x);
    uint64_t m = gxbp_bits(x) & (((uint64_t)1 << 52) - 1);
    int k = -1075;
    if (e != 0) return e - 1023;
    for (; m != 0; m >>= 1) k++;
    return k;
}

/* >>exact: sums and products of doubles as integers times powers of two -------------------------------------------------- */

#if GXB_LIMB_BITS == 64
__extension__ typedef unsigned __int128 gxbp_wide;
#else
typedef uint64_t gxbp_wide;
#endif

/* Takes zero limbs off both ends; a number without limbs is 0. */
static void gxbp_num_trim(gxb_num *r) {
    uint32_t low = 0;
    while (r->n > 0 && r->d[r->n - 1] == 0) r->n--;
    while (low < r->n && r->d[low] == 0) low++;
    if (low > 0) {
        r->n -= low;
        r->exp += (int32_t)low;
        memmove(r->d, r->d + low, r->n * sizeof *r->d);
    }
    if (r->n == 0) r->sign = r->exp = 0;
}

GXFEM_API void gxb_num_set(gxb_num *r, double value, int shift) {
    const uint64_t b = gxbp_bits(value), fraction = b & (((uint64_t)1 << 52) - 1);
    const int e = gxbp_exponent_bits(value);
    const uint64_t m = e == 0 ? fraction : fraction | (uint64_t)1 << 52;
    const int power = (e == 0 ? -1074 : e - 1075) + shift;              /* value * 2^shift = m * 2^power */
    const int off = (power % GXB_LIMB_BITS + GXB_LIMB_BITS) % GXB_LIMB_BITS;
    r->sign = m == 0 ? 0 : b >> 63 ? -1 : 1;
    r->exp = (power - off) / GXB_LIMB_BITS;
#if GXB_LIMB_BITS == 64
    r->n = 2;
    r->d[0] = m << off;
    r->d[1] = off == 0 ? 0 : m >> (64 - off);
#else
    r->n = 3;
    r->d[0] = (uint32_t)(m << off);
    r->d[1] = (uint32_t)(off == 0 ? m >> 32 : m >> (32 - off));
    r->d[2] = (uint32_t)(off == 0 ? 0 : m >> (64 - off));
#endif
    gxbp_num_trim(r);
}

static void gxbp_num_copy(gxb_num *r, const gxb_num *a, int sign) {
    uint32_t i;
    r->sign = a->sign * sign;
    r->exp = a->exp;
    r->n = a->n;
    for (i = 0; i < a->n; i++) r->d[i] = a->d[i];
}

/* The limb of a that stands for B^position. */
static gxb_limb gxbp_num_limb(const gxb_num *a, int32_t position) {
    return position < a->exp || position >= a->exp + (int32_t)a->n ? 0 : a->d[position - a->exp];
}

static int gxbp_num_compare_magnitude(const gxb_num *a, const gxb_num *b) {
    const int32_t top_a = a->exp + (int32_t)a->n, top_b = b->exp + (int32_t)b->n;
    const int32_t bottom = a->exp < b->exp ? a->exp : b->exp;
    int32_t k;
    if (top_a != top_b) return top_a > top_b ? 1 : -1;
    for (k = top_a - 1; k >= bottom; k--) {
        const gxb_limb x = gxbp_num_limb(a, k), y = gxbp_num_limb(b, k);
        if (x != y) return x > y ? 1 : -1;
    }
    return 0;
}

/* r = |a| with room for limbs from bottom to top - 1, zeros around it. */
static void gxbp_num_place(gxb_num *r, const gxb_num *a, int32_t bottom, int32_t top) {
    const uint32_t below = (uint32_t)(a->exp - bottom), above = (uint32_t)(top - a->exp) - a->n;
    uint32_t i;
    r->exp = bottom;
    r->n = (uint32_t)(top - bottom);
    for (i = 0; i < below; i++) r->d[i] = 0;        /* loops: a call for two or three limbs would cost more */
    for (i = 0; i < a->n; i++) r->d[below + i] = a->d[i];
    for (i = 0; i < above; i++) r->d[below + a->n + i] = 0;
}

/* r = |a| + |b|, worst length max of the tops minus min of the bottoms, plus 1 */
static void gxbp_num_add_magnitude(gxb_num *r, const gxb_num *a, const gxb_num *b) {
    const int32_t top_a = a->exp + (int32_t)a->n, top_b = b->exp + (int32_t)b->n;
    gxb_limb *d, carry = 0;
    uint32_t i;
    gxbp_num_place(r, a, a->exp < b->exp ? a->exp : b->exp, (top_a > top_b ? top_a : top_b) + 1);
    d = r->d + (b->exp - r->exp);
    for (i = 0; i < b->n; i++) {
        const gxbp_wide sum = (gxbp_wide)d[i] + b->d[i] + carry;
        d[i] = (gxb_limb)sum;
        carry = (gxb_limb)(sum >> GXB_LIMB_BITS);
    }
    for (; carry != 0; i++) carry = ++d[i] == 0;
}

/* r = |a| - |b| for |a| >= |b| */
static void gxbp_num_sub_magnitude(gxb_num *r, const gxb_num *a, const gxb_num *b) {
    gxb_limb *d, borrow = 0;
    uint32_t i;
    gxbp_num_place(r, a, a->exp < b->exp ? a->exp : b->exp, a->exp + (int32_t)a->n);
    d = r->d + (b->exp - r->exp);
    for (i = 0; i < b->n; i++) {
        const gxb_limb x = d[i], y = b->d[i], t = (gxb_limb)(x - y);
        d[i] = (gxb_limb)(t - borrow);
        borrow = (gxb_limb)((x < y) | (t < borrow));
    }
    for (; borrow != 0; i++) borrow = d[i]-- == 0;
}

static void gxbp_num_add_signed(gxb_num *r, const gxb_num *a, const gxb_num *b, int b_factor) {
    const int b_sign = b->sign * b_factor;
    int order;
    if (b_sign == 0) { gxbp_num_copy(r, a, 1); return; }
    if (a->sign == 0) { gxbp_num_copy(r, b, b_factor); return; }
    if (a->sign == b_sign) {
        gxbp_num_add_magnitude(r, a, b);
        r->sign = a->sign;
    } else {
        order = gxbp_num_compare_magnitude(a, b);
        if (order >= 0) gxbp_num_sub_magnitude(r, a, b);
        else gxbp_num_sub_magnitude(r, b, a);
        r->sign = order == 0 ? 0 : order > 0 ? a->sign : b_sign;
    }
    gxbp_num_trim(r);
}

GXFEM_API void gxb_num_add(gxb_num *r, const gxb_num *a, const gxb_num *b) { gxbp_num_add_signed(r, a, b, 1); }
GXFEM_API void gxb_num_sub(gxb_num *r, const gxb_num *a, const gxb_num *b) { gxbp_num_add_signed(r, a, b, -1); }

GXFEM_API void gxb_num_mul(gxb_num *r, const gxb_num *a, const gxb_num *b) {
    uint32_t i, j;
    r->sign = a->sign * b->sign;
    r->exp = a->exp + b->exp;
    r->n = r->sign == 0 ? 0 : a->n + b->n;
    for (i = 0; i < r->n; i++) r->d[i] = 0;
    for (i = 0; r->sign != 0 && i < a->n; i++) {
        const gxb_limb x = a->d[i];
        gxb_limb *d = r->d + i, carry = 0;
        for (j = 0; j < b->n; j++) {
            const gxbp_wide t = (gxbp_wide)x * b->d[j] + d[j] + carry;
            d[j] = (gxb_limb)t;
            carry = (gxb_limb)(t >> GXB_LIMB_BITS);
        }
        d[b->n] = carry;
    }
    gxbp_num_trim(r);
}

/* Bits of a limb other than 0, counted up to the highest that is set. */
static int gxbp_limb_bits(gxb_limb x) {
    int bits = 1, step;
    for (step = GXB_LIMB_BITS / 2; step > 0; step /= 2) if (x >> step != 0) { bits += step; x >>= step; }
    return bits;
}

/* |a| = m * 2^power with 2^52 <= m < 2^53, cut off below. a is not 0. */
static uint64_t gxbp_num_mantissa(const gxb_num *a, int *power) {
    uint64_t m = 0;
    int bits = 0, k = (int)a->n - 1, top = gxbp_limb_bits(a->d[k]);
    *power = (a->exp + k) * GXB_LIMB_BITS + top - 53;
    while (bits < 53) {
        const int take = top < 53 - bits ? top : 53 - bits;
        const uint64_t limb = k >= 0 ? a->d[k] : 0;
        m = m << take | ((limb >> (top - take)) & (((uint64_t)1 << take) - 1));
        bits += take;
        k--;
        top = GXB_LIMB_BITS;
    }
    return m;
}

/* m * 2^power; 0 below, infinity above the range of normal doubles */
static double gxbp_compose(uint64_t m, int power, int negative) {
    const int e = power + 52 + 1023;
    uint64_t b = e <= 0 ? 0 : e >= 0x7ff ? (uint64_t)0x7ff << 52 : (uint64_t)e << 52 | (m & (((uint64_t)1 << 52) - 1));
    if (negative) b |= (uint64_t)1 << 63;
    return gxbp_double(b);
}

GXFEM_API double gxb_num_to_double(const gxb_num *a) {
    int power;
    uint64_t m;
    if (a->sign == 0) return 0;
    m = gxbp_num_mantissa(a, &power);
    return gxbp_compose(m, power, a->sign < 0);
}

GXFEM_API double gxb_num_ratio(const gxb_num *a, const gxb_num *b) {
    int power_a, power_b;
    double q;
    if (a->sign == 0) return 0;
    q = (double)gxbp_num_mantissa(a, &power_a);         /* 2^52 <= q < 2^53, a double without rounding */
    q /= (double)gxbp_num_mantissa(b, &power_b);        /* 1/2 < q < 2 */
    power_a -= power_b;
    if (power_a < -1000) return 0;
    if (power_a > 1000) power_a = 1000;
    return (a->sign * b->sign < 0 ? -q : q) * gxbp_power(power_a);
}

/* r = a.b for vectors of three numbers; the worst length is that of one product plus 2 limbs */
static void gxbp_num_dot(gxb_num *r, const gxb_num a[3], const gxb_num b[3]) {
    GXB_NUM(t); GXB_NUM(s);
    GXB_NUM(u);
    gxb_num_mul(&s, &a[0], &b[0]);
    gxb_num_mul(&t, &a[1], &b[1]);
    gxb_num_add(&u, &s, &t);
    gxb_num_mul(&t, &a[2], &b[2]);
    gxb_num_add(r, &u, &t);
}

/* r = a*b - c*d */
static void gxbp_num_det2(gxb_num *r, const gxb_num *a, const gxb_num *b, const gxb_num *c, const gxb_num *d) {
    GXB_NUM(t); GXB_NUM(s);
    gxb_num_mul(&s, a, b);
    gxb_num_mul(&t, c, d);
    gxb_num_sub(r, &s, &t);
}

static void gxbp_num_cross(gxb_num r[3], const gxb_num a[3], const gxb_num b[3]) {
    gxbp_num_det2(&r[0], &a[1], &b[2], &a[2], &b[1]);
    gxbp_num_det2(&r[1], &a[2], &b[0], &a[0], &b[2]);
    gxbp_num_det2(&r[2], &a[0], &b[1], &a[1], &b[0]);
}

/* A vector of numbers with its limbs. */
typedef struct gxbp_vec { gxb_num c[4]; gxb_limb limbs[4][GXB_NUM_LIMBS]; } gxbp_vec;

static void gxbp_vec_init(gxbp_vec *v) {
    int k;
    memset(v->c, 0, sizeof v->c);
    for (k = 0; k < 4; k++) v->c[k].d = v->limbs[k];
}

static void gxbp_vec_set(gxbp_vec *v, const double x[3]) {
    int k;
    gxbp_vec_init(v);
    for (k = 0; k < 3; k++) gxb_num_set(&v->c[k], x[k], 0);
    gxb_num_set(&v->c[3], 1.0, 0);
}

static void gxbp_num_sub3(gxb_num r[3], const gxb_num a[3], const gxb_num b[3]) {
    int k;
    for (k = 0; k < 3; k++) gxb_num_sub(&r[k], &a[k], &b[k]);
}

/* Plane through p, q, r: c[0..2] = n = (q-p) x (r-p), degree 2; c[3] = d = n.p, degree 3. */
static void gxbp_exact_plane(gxb_num plane[4], const gxb_num p[3], const gxb_num q[3], const gxb_num r[3]) {
    gxbp_vec a, b;
    gxbp_vec_init(&a);
    gxbp_vec_init(&b);
    gxbp_num_sub3(a.c, q, p);
    gxbp_num_sub3(b.c, r, p);
    gxbp_num_cross(plane, a.c, b.c);
    gxbp_num_dot(&plane[3], plane, p);
}

/* r = n.X - d W for a homogeneous point: degree 9 for a point of three planes */
static void gxbp_exact_side(gxb_num *r, const gxb_num point[4], const gxb_num plane[4]) {
    GXB_NUM(t); GXB_NUM(s);
    gxbp_num_dot(&s, plane, point);
    gxb_num_mul(&t, &plane[3], &point[3]);
    gxb_num_sub(r, &s, &t);
}

static void gxbp_make_weight_positive(gxb_num point[4]) {
    int k;
    if (point[3].sign < 0) for (k = 0; k < 4; k++) point[k].sign = -point[k].sign;
}

/* Line through p and q with a plane: X = s_q p - s_p q, W = s_q - s_p with s = n.x - d; degrees 4 and 3. */
static void gxbp_exact_line_plane(gxb_num point[4], const gxb_num p[4], const gxb_num q[4], const gxb_num plane[4]) {
    GXB_NUM(sp); GXB_NUM(sq);
    int k;
    gxbp_exact_side(&sp, p, plane);
    gxbp_exact_side(&sq, q, plane);
    for (k = 0; k < 3; k++) gxbp_num_det2(&point[k], &sq, &p[k], &sp, &q[k]);
    gxb_num_sub(&point[3], &sq, &sp);
    gxbp_make_weight_positive(point);
}

/* Three planes by Cramer's rule: X = d1 n2 x n3 + d2 n3 x n1 + d3 n1 x n2, W = n1.(n2 x n3); degrees 7 and 6. */
static void gxbp_exact_three_planes(gxb_num point[4], const gxb_num a[4], const gxb_num b[4], const gxb_num c[4]) {
    gxbp_vec bc, ca, ab, row, d;
    int k;
    gxbp_vec_init(&bc); gxbp_vec_init(&ca); gxbp_vec_init(&ab); gxbp_vec_init(&row); gxbp_vec_init(&d);
    gxbp_num_cross(bc.c, b, c);
    gxbp_num_cross(ca.c, c, a);
    gxbp_num_cross(ab.c, a, b);
    gxbp_num_copy(&d.c[0], &a[3], 1); gxbp_num_copy(&d.c[1], &b[3], 1); gxbp_num_copy(&d.c[2], &c[3], 1);
    for (k = 0; k < 3; k++) {
        gxbp_num_copy(&row.c[0], &bc.c[k], 1); gxbp_num_copy(&row.c[1], &ca.c[k], 1); gxbp_num_copy(&row.c[2], &ab.c[k], 1);
        gxbp_num_dot(&point[k], row.c, d.c);
    }
    gxbp_num_dot(&point[3], a, bc.c);
    gxbp_make_weight_positive(point);
}

/* >>filter: doubles with error bounds that hold for any order of operations, contraction, excess precision, rounding mode ----
 *
 * u = 2^-52 bounds the relative error of one operation in every rounding mode. Underflow, flushed or not, adds at most 2^-1022
 * to a result; GXBP_TINY, far above every such error in the ranges of the complex, stands for it in every bound. Differences of
 * coordinates, normals and distances pass through gxbp_fence, so that a compiler that may reassociate can't multiply them out: bounds
 * rest on their size after cancellation. Everything after the fence is a sum of products; whatever its order, each elementary product suffers fewer
 * than eight roundings, so |error| <= 8u * (sum of |products|). Each bound below is at least that plus the inherited
 * errors to first order, times a factor of 2 or more that covers second-order terms and the rounding of the bound itself.
 */
#define GXBP_NO_BALL_EXPONENT 200
#define GXBP_U gxbp_power(-52)
#define GXBP_TINY gxbp_power(-600)
#define GXBP_NO_BALL gxbp_power(GXBP_NO_BALL_EXPONENT)

static double gxbp_fence(double x) {
    volatile double v = x;
    return v;
}

static double gxbp_max(double a, double b) { return a > b ? a : b; }
static double gxbp_max3(const double a[3]) { return gxbp_max(gxbp_abs(a[0]), gxbp_max(gxbp_abs(a[1]), gxbp_abs(a[2]))); }

/* r = a x b, errors: each component of a within ea, of b within eb. Returns the bound for each component of r:
   two products of sizes A B, inherited A eb + B ea + ea eb each, and 8u of 2 A B. */
static double gxbp_filter_cross(double r[3], const double a[3], double ea, const double b[3], double eb) {
    const double A = gxbp_max3(a), B = gxbp_max3(b);
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
    return 4 * (A * eb + B * ea + ea * eb) + 32 * GXBP_U * A * B + GXBP_TINY;
}

/* c = b - a with the bound for each component */
static double gxbp_filter_difference(double c[3], const gxb_ball *a, const gxb_ball *b) {
    int k;
    for (k = 0; k < 3; k++) c[k] = gxbp_fence(b->x[k] - a->x[k]);
    return 2 * (a->error + b->error) + 2 * GXBP_U * gxbp_max3(c) + GXBP_TINY;
}

static void gxbp_filter_plane(gxb_plane_filter *f, const gxb_ball *p, const double a[3], double ea, const double b[3], double eb) {
    int k;
    f->error = gxbp_filter_cross(f->n, a, ea, b, eb);
    for (k = 0; k < 3; k++) f->n[k] = gxbp_fence(f->n[k]);
    memcpy(f->base, p->x, sizeof f->base);
    f->base_error = p->error;
    f->norm = gxbp_max3(f->n);
}

/* n.(x - base); *bound: with D = |x - base|_1 and E the error of the difference,
   D * error + 3 (norm + error) E from the data and 8u * norm * D from rounding. */
static double gxbp_filter_side(const gxb_ball *x, const gxb_plane_filter *f, double *bound) {
    const double d0 = gxbp_fence(x->x[0] - f->base[0]), d1 = gxbp_fence(x->x[1] - f->base[1]);
    const double d2 = gxbp_fence(x->x[2] - f->base[2]);
    const double D = gxbp_abs(d0) + gxbp_abs(d1) + gxbp_abs(d2), E = x->error + f->base_error;
    *bound = 2 * D * (f->error + 12 * GXBP_U * f->norm) + 6 * E * (f->norm + f->error) + GXBP_TINY;
    return f->n[0] * d0 + f->n[1] * d1 + f->n[2] * d2;
}

/* 1 or -1 where certain, else 0 */
static int gxbp_filter_sign(double value, double bound) { return value > bound ? 1 : value < -bound ? -1 : 0; }

/* The plane cuts the line from p to q at t = s_p / (s_p - s_q). */
static void gxbp_filter_line_plane(gxb_ball *r, const gxb_ball *p, const gxb_ball *q, const gxb_plane_filter *f) {
    double ep, eq, l[3], t, et;
    const double sp = gxbp_filter_side(p, f, &ep), sq = gxbp_filter_side(q, f, &eq);
    const double den = gxbp_fence(sp - sq), size = gxbp_abs(den), el = gxbp_filter_difference(l, p, q);
    const double eden = ep + eq + 4 * GXBP_U * (gxbp_abs(sp) + gxbp_abs(sq));
    int k;
    r->error = GXBP_NO_BALL;
    if (!(size > 4 * eden) || p->error >= GXBP_NO_BALL || q->error >= GXBP_NO_BALL) {
        memcpy(r->x, p->x, sizeof r->x);
        return;
    }
    t = gxbp_fence(sp / den);
    et = 4 * (ep + gxbp_abs(t) * eden) / size + 8 * GXBP_U * gxbp_abs(t);
    for (k = 0; k < 3; k++) r->x[k] = gxbp_fence(p->x[k] + t * l[k]);
    r->error = 2 * (gxbp_max3(l) * et + (gxbp_abs(t) + et) * el + p->error) +
               8 * GXBP_U * (gxbp_max3(p->x) + gxbp_abs(t) * gxbp_max3(l) + gxbp_max3(r->x)) + GXBP_TINY;
}

/* Cramer's rule about the base b of plane 0: x = b + (r0 n1 x n2 + r1 n2 x n0 + r2 n0 x n1) / n0.(n1 x n2),
   r_i = n_i.(base_i - b). */
static void gxbp_filter_three_planes(gxb_ball *out, const gxb_plane_filter *const f[3]) {
    gxb_ball b;
    double r[3], er[3], c[3][3], ec[3], D = 0, eD, size;
    int i, k;
    memcpy(b.x, f[0]->base, sizeof b.x);
    b.error = 0;
    for (i = 0; i < 3; i++) r[i] = gxbp_fence(-gxbp_filter_side(&b, f[i], &er[i]));
    r[0] = 0;
    for (i = 0; i < 3; i++) {
        const gxb_plane_filter *g = f[(i + 1) % 3], *h = f[(i + 2) % 3];
        ec[i] = gxbp_filter_cross(c[i], g->n, g->error, h->n, h->error);
    }
    for (k = 0; k < 3; k++) D += f[0]->n[k] * c[0][k];
    eD = 6 * (f[0]->norm * ec[0] + f[0]->error * (gxbp_max3(c[0]) + ec[0])) + 48 * GXBP_U * f[0]->norm * gxbp_max3(c[0]) + GXBP_TINY;
    D = gxbp_fence(D);
    size = gxbp_abs(D);
    memcpy(out->x, b.x, sizeof out->x);
    out->error = GXBP_NO_BALL;
    if (!(size > 4 * eD)) return;
    {
        double e = 0, largest = 0;
        for (i = 0; i < 3; i++) {
            const double C = gxbp_max3(c[i]);
            e += 2 * (gxbp_abs(r[i]) * ec[i] + er[i] * (C + ec[i])) + 24 * GXBP_U * gxbp_abs(r[i]) * C;
        }
        for (k = 0; k < 3; k++) {
            const double step = gxbp_fence((r[0] * c[0][k] + r[1] * c[1][k] + r[2] * c[2][k]) / D);
            largest = gxbp_max(largest, gxbp_abs(step));
            out->x[k] = gxbp_fence(b.x[k] + step);
        }
        out->error = 4 * (e + largest * eD) / size + 16 * GXBP_U * (largest + gxbp_max3(out->x)) + GXBP_TINY;
    }
}

/* >>points: the predicates on their own ------------------------------------------------------------------------------ */

/* Do all differences and products of these coordinates keep away from overflow? (underflow: see GXBP_TINY) */
static int gxbp_filter_range(const double *x, int count) {
    for (; count > 0; count--, x++) if (gxbp_exponent_bits(*x) > 1023 + 128) return 0;
    return 1;
}

static int gxbp_orient2d_exact(const double a[2], const double b[2], const double c[2]) {
    GXB_NUM(r);
    gxbp_vec p, q, o, u, v;
    double x[3] = {0, 0, 0};
    x[0] = a[0]; x[1] = a[1]; gxbp_vec_set(&p, x);
    x[0] = b[0]; x[1] = b[1]; gxbp_vec_set(&q, x);
    x[0] = c[0]; x[1] = c[1]; gxbp_vec_set(&o, x);
    gxbp_vec_init(&u);
    gxbp_vec_init(&v);
    gxbp_num_sub3(u.c, p.c, o.c);
    gxbp_num_sub3(v.c, q.c, o.c);
    gxbp_num_det2(&r, &u.c[0], &v.c[1], &u.c[1], &v.c[0]);
    return r.sign;
}

GXFEM_API int gxb_orient2d(const double a[2], const double b[2], const double c[2]) {
    if (gxbp_filter_range(a, 2) && gxbp_filter_range(b, 2) && gxbp_filter_range(c, 2)) {
        const double ax = gxbp_fence(a[0] - c[0]), ay = gxbp_fence(a[1] - c[1]);
        const double bx = gxbp_fence(b[0] - c[0]), by = gxbp_fence(b[1] - c[1]);
        const double bound = 16 * GXBP_U * (gxbp_abs(ax * by) + gxbp_abs(ay * bx)) + GXBP_TINY;
        const int sign = gxbp_filter_sign(ax * by - ay * bx, bound);
        if (sign != 0) return sign;
    }
    return gxbp_orient2d_exact(a, b, c);
}

static int gxbp_orient3d_exact(const double a[3], const double b[3], const double c[3], const double d[3]) {
    GXB_NUM(r);
    gxbp_vec p, q, s, o, n;
    gxbp_vec_set(&p, a); gxbp_vec_set(&q, b); gxbp_vec_set(&s, c); gxbp_vec_set(&o, d);
    gxbp_vec_init(&n);
    gxbp_exact_plane(n.c, p.c, q.c, s.c);
    gxbp_exact_side(&r, o.c, n.c);
    return -r.sign;
}

GXFEM_API int gxb_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
    if (gxbp_filter_range(a, 3) && gxbp_filter_range(b, 3) && gxbp_filter_range(c, 3) && gxbp_filter_range(d, 3)) {
        gxb_plane plane;
        gxb_ball ball;
        double value, bound;
        int sign;
        gxb_plane_init(&plane, a, b, c);
        memcpy(ball.x, d, sizeof ball.x);
        ball.error = 0;
        value = gxbp_filter_side(&ball, &plane.filter, &bound);
        sign = gxbp_filter_sign(value, bound);
        if (sign != 0) return -sign;
    }
    return gxbp_orient3d_exact(a, b, c, d);
}

/* Rows are the points less the last, with their squared lengths; the determinant along the column of squares. An elementary product of
   the filter has four fenced differences, three products and is one of twelve: at most 4 + 3 + 11 roundings whatever the order; in 3D
   five, four, one of 72: 80. Ranges as for gxb_orient3d keep all products from overflow and errors of underflow below GXBP_TINY. */
static int gxbp_filter_incircle(const double a[2], const double b[2], const double c[2], const double d[2]) {
    const double *p[3];
    double x[3], y[3], value = 0, size = 0;
    int i;
    p[0] = a; p[1] = b; p[2] = c;
    for (i = 0; i < 3; i++) { x[i] = gxbp_fence(p[i][0] - d[0]); y[i] = gxbp_fence(p[i][1] - d[1]); }
    for (i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double lift = x[i] * x[i] + y[i] * y[i];
        value += lift * (x[j] * y[k] - x[k] * y[j]);
        size += lift * (gxbp_abs(x[j] * y[k]) + gxbp_abs(x[k] * y[j]));
    }
    return gxbp_filter_sign(value, 48 * GXBP_U * size + GXBP_TINY);
}

static int gxbp_filter_insphere(const double a[3], const double b[3], const double c[3], const double d[3], const double e[3]) {
    const double *p[4];
    double x[4][3], lift[4], value = 0, size = 0;
    int i, k;
    p[0] = a; p[1] = b; p[2] = c; p[3] = d;
    for (i = 0; i < 4; i++) {
        for (k = 0; k < 3; k++) x[i][k] = gxbp_fence(p[i][k] - e[k]);
        lift[i] = x[i][0] * x[i][0] + x[i][1] * x[i][1] + x[i][2] * x[i][2];
    }
    for (i = 0; i < 4; i++) {
        const double *u = x[i == 0], *v = x[i <= 1 ? 2 : 1], *w = x[i <= 2 ? 3 : 2];
        const double sign = i % 2 == 0 ? -1 : 1;
        for (k = 0; k < 3; k++) {
            const int m = (k + 1) % 3, n = (k + 2) % 3;
            value += sign * lift[i] * u[k] * (v[m] * w[n] - v[n] * w[m]);
            size += lift[i] * gxbp_abs(u[k]) * (gxbp_abs(v[m] * w[n]) + gxbp_abs(v[n] * w[m]));
        }
    }
    return gxbp_filter_sign(value, 128 * GXBP_U * size + GXBP_TINY);
}

/* p - o as exact numbers; c[3] = its squared length */
static void gxbp_exact_lifted(gxbp_vec *v, const double p[3], const double o[3]) {
    gxbp_vec x, y;
    gxbp_vec_set(&x, p); gxbp_vec_set(&y, o);
    gxbp_vec_init(v);
    gxbp_num_sub3(v->c, x.c, y.c);
    gxbp_num_dot(&v->c[3], v->c, v->c);
}

/* Degree 4: 140 limbs of 64 bits for any finite doubles. */
static int gxbp_incircle_exact(const double a[2], const double b[2], const double c[2], const double d[2]) {
    const double *p[4];
    double x[4][3];
    gxbp_vec row[3], minor, lift;
    GXB_NUM(r);
    int i;
    p[0] = a; p[1] = b; p[2] = c; p[3] = d;
    for (i = 0; i < 4; i++) { x[i][0] = p[i][0]; x[i][1] = p[i][1]; x[i][2] = 0; }
    gxbp_vec_init(&minor); gxbp_vec_init(&lift);
    for (i = 0; i < 3; i++) gxbp_exact_lifted(&row[i], x[i], x[3]);
    for (i = 0; i < 3; i++) {
        const gxbp_vec *u = &row[(i + 1) % 3], *v = &row[(i + 2) % 3];
        gxbp_num_det2(&minor.c[i], &u->c[0], &v->c[1], &v->c[0], &u->c[1]);
        gxbp_num_copy(&lift.c[i], &row[i].c[3], 1);
    }
    gxbp_num_dot(&r, lift.c, minor.c);
    return r.sign;
}

/* Degree 5: a difference of any finite doubles has 34 limbs of 64 bits, its square 67, a minor 100, their product and the sum of four 167. */
static int gxbp_insphere_exact(const double a[3], const double b[3], const double c[3], const double d[3], const double e[3]) {
    gxbp_vec row[4], normal;
    GXB_NUM(minor); GXB_NUM(term); GXB_NUM(sum); GXB_NUM(next);
    int i;
    gxbp_exact_lifted(&row[0], a, e); gxbp_exact_lifted(&row[1], b, e); gxbp_exact_lifted(&row[2], c, e); gxbp_exact_lifted(&row[3], d, e);
    for (i = 0; i < 4; i++) {
        gxbp_vec_init(&normal);
        gxbp_num_cross(normal.c, row[i <= 1 ? 2 : 1].c, row[i <= 2 ? 3 : 2].c);
        gxbp_num_dot(&minor, row[i == 0].c, normal.c);
        gxb_num_mul(&term, &row[i].c[3], &minor);
        if (i % 2 == 0) term.sign = -term.sign;
        gxb_num_add(&next, &sum, &term);
        gxbp_num_copy(&sum, &next, 1);
    }
    return sum.sign;
}

GXFEM_API int gxb_incircle(const double a[2], const double b[2], const double c[2], const double d[2]) {
    if (gxbp_filter_range(a, 2) && gxbp_filter_range(b, 2) && gxbp_filter_range(c, 2) && gxbp_filter_range(d, 2)) {
        const int sign = gxbp_filter_incircle(a, b, c, d);
        if (sign != 0) return sign;
    }
    return gxbp_incircle_exact(a, b, c, d);
}

GXFEM_API int gxb_insphere(const double a[3], const double b[3], const double c[3], const double d[3], const double e[3]) {
    if (gxbp_filter_range(a, 3) && gxbp_filter_range(b, 3) && gxbp_filter_range(c, 3) && gxbp_filter_range(d, 3) && gxbp_filter_range(e, 3)) {
        const int sign = gxbp_filter_insphere(a, b, c, d, e);
        if (sign != 0) return sign;
    }
    return gxbp_insphere_exact(a, b, c, d, e);
}

static void gxbp_ball_explicit(gxb_ball *ball, const double p[3]) {
    memcpy(ball->x, p, sizeof ball->x);
    ball->error = 0;
}

GXFEM_API void gxb_plane_init(gxb_plane *plane, const double p[3], const double q[3], const double r[3]) {
    gxb_ball b[3];
    double a[3], c[3], ea, ec;
    gxbp_ball_explicit(&b[0], p); gxbp_ball_explicit(&b[1], q); gxbp_ball_explicit(&b[2], r);
    ea = gxbp_filter_difference(a, &b[0], &b[1]);
    ec = gxbp_filter_difference(c, &b[0], &b[2]);
    gxbp_filter_plane(&plane->filter, &b[0], a, ea, c, ec);
    plane->p = p; plane->q = q; plane->r = r;
}

static void gxbp_point_reset(gxb_point *point) {
    point->p = point->q = NULL;
    point->plane[0] = point->plane[1] = point->plane[2] = NULL;
}

GXFEM_API void gxb_point_explicit(gxb_point *point, const double p[3]) {
    gxbp_point_reset(point);
    gxbp_ball_explicit(&point->ball, p);
    point->p = p;
}

GXFEM_API void gxb_point_line_plane(gxb_point *point, const double p[3], const double q[3], const gxb_plane *plane) {
    gxb_ball a, b;
    gxbp_point_reset(point);
    gxbp_ball_explicit(&a, p);
    gxbp_ball_explicit(&b, q);
    gxbp_filter_line_plane(&point->ball, &a, &b, &plane->filter);
    point->p = p; point->q = q; point->plane[0] = plane;
}

GXFEM_API void gxb_point_three_planes(gxb_point *point, const gxb_plane *a, const gxb_plane *b, const gxb_plane *c) {
    const gxb_plane_filter *f[3];
    gxbp_point_reset(point);
    f[0] = &a->filter; f[1] = &b->filter; f[2] = &c->filter;
    gxbp_filter_three_planes(&point->ball, f);
    point->plane[0] = a; point->plane[1] = b; point->plane[2] = c;
}

static void gxbp_plane_exact(gxbp_vec *v, const gxb_plane *plane) {
    gxbp_vec p, q, r;
    gxbp_vec_set(&p, plane->p); gxbp_vec_set(&q, plane->q); gxbp_vec_set(&r, plane->r);
    gxbp_vec_init(v);
    gxbp_exact_plane(v->c, p.c, q.c, r.c);
}

static void gxbp_point_exact(gxbp_vec *v, const gxb_point *point) {
    gxbp_vec a, b, c;
    if (point->plane[0] == NULL) { gxbp_vec_set(v, point->p); return; }
    gxbp_vec_init(v);
    gxbp_plane_exact(&a, point->plane[0]);
    if (point->plane[1] == NULL) {
        gxbp_vec_set(&b, point->p);
        gxbp_vec_set(&c, point->q);
        gxbp_exact_line_plane(v->c, b.c, c.c, a.c);
    } else {
        gxbp_plane_exact(&b, point->plane[1]);
        gxbp_plane_exact(&c, point->plane[2]);
        gxbp_exact_three_planes(v->c, a.c, b.c, c.c);
    }
}

GXFEM_API int gxb_side(const gxb_point *point, const gxb_plane *plane) {
    if (plane == point->plane[0] || plane == point->plane[1] || plane == point->plane[2]) return 0;
    if (point->ball.error < GXBP_NO_BALL) {
        double bound;
        const double value = gxbp_filter_side(&point->ball, &plane->filter, &bound);
        const int sign = gxbp_filter_sign(value, bound);
        if (sign != 0) return sign;
    }
    {
        GXB_NUM(r);
        gxbp_vec x, n;
        gxbp_point_exact(&x, point);
        gxbp_plane_exact(&n, plane);
        gxbp_exact_side(&r, x.c, n.c);
        return r.sign;
    }
}

GXFEM_API int gxb_compare(const gxb_point *a, const gxb_point *b, int axis) {
    const double difference = gxbp_fence(a->ball.x[axis] - b->ball.x[axis]);
    const double bound = 2 * (a->ball.error + b->ball.error) + 2 * GXBP_U * gxbp_abs(difference) + GXBP_TINY;
    const int sign = gxbp_filter_sign(difference, bound);
    if (sign != 0) return sign;
    {
        GXB_NUM(r);
        gxbp_vec p, q;
        gxbp_point_exact(&p, a);
        gxbp_point_exact(&q, b);
        gxbp_num_det2(&r, &p.c[axis], &q.c[3], &q.c[axis], &p.c[3]);
        return r.sign;
    }
}

/* |a b c| of the homogeneous coordinates i and j: degree 20 for three points of three planes */
static int gxbp_orient_exact(const gxb_num a[4], const gxb_num b[4], const gxb_num c[4], int i, int j) {
    gxbp_vec row, cofactor;
    GXB_NUM(r);
    gxbp_vec_init(&row);
    gxbp_vec_init(&cofactor);
    gxbp_num_det2(&cofactor.c[0], &b[j], &c[3], &c[j], &b[3]);
    gxbp_num_det2(&cofactor.c[1], &c[i], &b[3], &b[i], &c[3]);
    gxbp_num_det2(&cofactor.c[2], &b[i], &c[j], &c[i], &b[j]);
    gxbp_num_copy(&row.c[0], &a[i], 1); gxbp_num_copy(&row.c[1], &a[j], 1); gxbp_num_copy(&row.c[2], &a[3], 1);
    gxbp_num_dot(&r, row.c, cofactor.c);
    return r.sign;
}

/* Orientation of three points in the plane of coordinates i and j; 0: not certain. Bounds as for one component of a cross product. */
static int gxbp_filter_turn(const gxb_ball *a, const gxb_ball *b, const gxb_ball *c, int i, int j) {
    double u[3], v[3];
    const double eu = gxbp_filter_difference(u, a, b), ev = gxbp_filter_difference(v, a, c);
    const double U = gxbp_max(gxbp_abs(u[i]), gxbp_abs(u[j])), V = gxbp_max(gxbp_abs(v[i]), gxbp_abs(v[j]));
    const double bound = 4 * (U * ev + V * eu + eu * ev) + 32 * GXBP_U * U * V + GXBP_TINY;
    return gxbp_filter_sign(u[i] * v[j] - u[j] * v[i], bound);
}

GXFEM_API int gxb_orient_in_plane(const gxb_point *a, const gxb_point *b, const gxb_point *c, const gxb_plane *plane) {
    const double *n = plane->filter.n;
    gxbp_vec exact_n, x[3];
    int axis, sign, k;
    for (axis = 0; axis < 3 && gxbp_abs(n[axis]) < plane->filter.norm; axis++) {}
    axis %= 3;
    sign = gxbp_filter_sign(n[axis], plane->filter.error);
    if (sign == 0) {
        gxbp_plane_exact(&exact_n, plane);
        for (k = 0; k < 3 && exact_n.c[axis].sign == 0; k++) axis = k;
        sign = exact_n.c[axis].sign;
    }
    {
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const int turn = gxbp_filter_turn(&a->ball, &b->ball, &c->ball, i, j);
        if (turn != 0) return turn * sign;
        gxbp_point_exact(&x[0], a); gxbp_point_exact(&x[1], b); gxbp_point_exact(&x[2], c);
        return gxbp_orient_exact(x[0].c, x[1].c, x[2].c, i, j) * sign;
    }
}

/* Order of two finite doubles by their bits: flush-to-zero can't make them equal. */
static int gxbp_compare_doubles(double a, double b) {
    const int na = (int)(gxbp_bits(a) >> 63), nb = (int)(gxbp_bits(b) >> 63);
    const uint64_t ma = gxbp_bits(a) << 1, mb = gxbp_bits(b) << 1;
    if (ma == 0 && mb == 0) return 0;
    if (na != nb) return na ? -1 : 1;
    return ma == mb ? 0 : (ma > mb) != na ? 1 : -1;
}

/* Is p in the box of the triangle, prolonged to -x? */
static int gxbp_ray_reaches(const double a[3], const double b[3], const double c[3], const double p[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        const int sa = gxbp_compare_doubles(a[k], p[k]), sb = gxbp_compare_doubles(b[k], p[k]);
        const int sc = gxbp_compare_doubles(c[k], p[k]);
        if (sa < 0 && sb < 0 && sc < 0) return 0;
        if (k > 0 && sa > 0 && sb > 0 && sc > 0) return 0;
    }
    return 1;
}

/* In a triangle's plane a point lies in the triangle where no projection to a coordinate plane sees it on both sides of edges. A
   triangle without area, all of whose projections are flat, contains what of its line is in its box. p is in the box prolonged to -x. */
static int gxbp_point_in_triangle(const double a[3], const double b[3], const double c[3], const double p[3]) {
    int k, flat = 1;
    if (gxb_orient3d(a, b, c, p) != 0) return 0;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        double pa[2], pb[2], pc[2], pp[2];
        int s, t, r;
        pa[0] = a[i]; pa[1] = a[j]; pb[0] = b[i]; pb[1] = b[j];
        pc[0] = c[i]; pc[1] = c[j]; pp[0] = p[i]; pp[1] = p[j];
        s = gxb_orient2d(pa, pb, pp); t = gxb_orient2d(pb, pc, pp); r = gxb_orient2d(pc, pa, pp);
        if ((s > 0 || t > 0 || r > 0) && (s < 0 || t < 0 || r < 0)) return 0;
        flat = flat && gxb_orient2d(pa, pb, pc) == 0;
    }
    return !flat || gxbp_compare_doubles(a[0], p[0]) <= 0 || gxbp_compare_doubles(b[0], p[0]) <= 0 || gxbp_compare_doubles(c[0], p[0]) <= 0;
}

/* Does the ray from p along +x cross the triangle? In the projection to y, z the ray is moved by (h, h^2), h -> 0, so that it
   meets no edge; the sign of its side of edge a b is then that of the first term of the expansion in h which is not 0. */
static int gxbp_ray_side(const double a[3], const double b[3], const double p[3]) {
    int sign = gxb_orient2d(a + 1, b + 1, p + 1);
    if (sign != 0) return sign;
    sign = gxbp_compare_doubles(a[2], b[2]);            /* d/dy of the orientation is a_z - b_z */
    return sign != 0 ? sign : gxbp_compare_doubles(b[1], a[1]);     /* d/dz is b_y - a_y */
}

GXFEM_API int gxb_winding_number(const double *vertices, const uint32_t *triangles, size_t triangle_count, const double p[3],
                                 int *on_surface) {
    int winding = 0;
    size_t t;
    *on_surface = 0;
    for (t = 0; t < triangle_count; t++) {
        const double *a = vertices + 3 * (size_t)triangles[3 * t], *b = vertices + 3 * (size_t)triangles[3 * t + 1];
        const double *c = vertices + 3 * (size_t)triangles[3 * t + 2];
        int ab, side;
        if (!gxbp_ray_reaches(a, b, c, p)) continue;
        if (gxbp_point_in_triangle(a, b, c, p)) *on_surface = 1;
        ab = gxbp_ray_side(a, b, p);
        if (ab == 0 || gxbp_ray_side(b, c, p) != ab || gxbp_ray_side(c, a, p) != ab) continue;
        side = gxb_orient3d(a, b, c, p);                /* 1: p is behind the triangle, the ray leaves through it if ab > 0 */
        if (side == ab) winding += ab;
    }
    return winding;
}

/* >>memory: growing arrays, transactions --------------------------------------------------------------------------------- */

static void *gxbp_allocate(const gx_allocator *a, size_t size) { return a->allocate ? a->allocate(a->user, size) : malloc(size); }

static void gxbp_release(const gx_allocator *a, void *memory, size_t size) {
    if (memory == NULL) return;
    if (a->release) a->release(a->user, memory, size);
    else free(memory);
}

/* Makes room for count + extra items of the given size. */
static gx_result gxbp_reserve(gxb_complex *cx, void *array, size_t item, uint32_t count, uint32_t *capacity, size_t extra) {
    const size_t need = (size_t)count + extra, room = need + need / 2 + 16;
    void *old, *memory;
    if (need <= *capacity) return GX_OK;
    if (room > INT32_MAX || room > SIZE_MAX / item) return GX_ERROR_LIMIT;
    memory = gxbp_allocate(&cx->allocator, room * item);
    if (memory == NULL) return GX_ERROR_MEMORY;
    memcpy(&old, array, sizeof old);
    if (count > 0) memcpy(memory, old, count * item);
    gxbp_release(&cx->allocator, old, (size_t)*capacity * item);
    memcpy(array, &memory, sizeof memory);
    *capacity = (uint32_t)room;
    return GX_OK;
}

#define GXBP_RESERVE(cx, array, counter, extra) \
    gxbp_reserve(cx, &(cx)->array, sizeof *(cx)->array, (cx)->counter##_count, &(cx)->counter##_capacity, extra)

enum { GXBP_EDGES, GXBP_FACETS, GXBP_LEAVES, GXBP_NODES, GXBP_POINTS, GXBP_ROOTS, GXBP_FACES, GXBP_MESH_EDGES };

static void *gxbp_item(gxb_complex *cx, uint32_t array, uint32_t index, size_t *size) {
    switch (array) {
    case GXBP_EDGES: *size = sizeof *cx->edges; return cx->edges + index;
    case GXBP_FACETS: *size = sizeof *cx->facets; return cx->facets + index;
    case GXBP_LEAVES: *size = sizeof *cx->leaves; return cx->leaves + index;
    case GXBP_NODES: *size = sizeof *cx->nodes; return cx->nodes + index;
    case GXBP_POINTS: *size = sizeof *cx->points; return cx->points + index;
    case GXBP_ROOTS: *size = sizeof *cx->root; return cx->root + index;
    case GXBP_FACES: *size = sizeof *cx->face_facet; return cx->face_facet + index;
    default: *size = sizeof *cx->mesh_edge; return cx->mesh_edge + index;
    }
}

/* Items older than the transaction. */
static uint32_t gxbp_item_mark(const gxb_complex *cx, uint32_t array) {
    static const uint32_t which[5] = {2, 3, 4, 5, 0};
    return array <= GXBP_POINTS ? cx->mark[which[array]] : UINT32_MAX;
}

#define GXBP_UNDO_ITEM 128   /* no item that is saved is larger */

static gx_result gxbp_reserve_undo(gxb_complex *cx, size_t items) {
    gx_result result = GXBP_RESERVE(cx, undo, undo, items);
    if (result == GX_OK) result = GXBP_RESERVE(cx, undo_bytes, undo_byte, items * GXBP_UNDO_ITEM);
    return result;
}

/* Saves an item that is about to change. Room was reserved. */
static void gxbp_save(gxb_complex *cx, uint32_t array, uint32_t index) {
    size_t size;
    const void *item = gxbp_item(cx, array, index, &size);
    if (index >= gxbp_item_mark(cx, array)) return;
    memcpy(cx->undo_bytes + cx->undo_byte_count, item, size);
    cx->undo_byte_count += (uint32_t)size;
    cx->undo[cx->undo_count].array = array;
    cx->undo[cx->undo_count++].index = index;
}

/* Copies a list of the pool behind those already copied. */
static void gxbp_move_list(const gxb_complex *cx, uint32_t *pool, uint32_t *used, uint32_t *list, uint32_t count) {
    if (count > 0) memcpy(pool + *used, cx->pool + *list, count * sizeof *pool);
    *list = *used;
    *used += count;
}

/* Lists that were replaced by longer ones stay in the pool; once they outweigh the others, the pool is renewed. Without memory for
   that it stays as it is. */
static void gxbp_compact_pool(gxb_complex *cx) {
    uint32_t *pool, used = 0, i;
    if (cx->pool_count / 2 < cx->pool_live + 4096) return;
    pool = (uint32_t *)gxbp_allocate(&cx->allocator, (size_t)cx->pool_capacity * sizeof *pool);
    if (pool == NULL) return;
    for (i = 0; i < cx->facet_count; i++) {
        gxb_facet *f = &cx->facets[i];
        if (f->child != GXB_NONE) f->loop_count = 0;    /* its children have loops of their own */
        gxbp_move_list(cx, pool, &used, &f->loop, f->loop_count);
    }
    for (i = 0; i < cx->leaf_count; i++) gxbp_move_list(cx, pool, &used, &cx->leaves[i].facets, cx->leaves[i].facet_count);
    gxbp_release(&cx->allocator, cx->pool, (size_t)cx->pool_capacity * sizeof *cx->pool);
    cx->pool = pool;
    cx->pool_count = cx->pool_live = used;
}

static void gxbp_set_marks(gxb_complex *cx) {
    cx->mark[0] = cx->point_count; cx->mark[1] = cx->plane_count; cx->mark[2] = cx->edge_count; cx->mark[3] = cx->facet_count;
    cx->mark[4] = cx->leaf_count; cx->mark[5] = cx->tree_count; cx->mark[6] = cx->label_count; cx->mark[7] = cx->pool_count;
    cx->mark_block = cx->blocks;
    cx->mark_used = cx->blocks != NULL ? cx->blocks->used : 0;
    cx->undo_count = cx->undo_byte_count = cx->wall_count = cx->corner_count = cx->task_count = 0;
}

GXFEM_API void gxb_complex_begin(gxb_complex *cx) {
    gxbp_compact_pool(cx);
    gxbp_set_marks(cx);
}

GXFEM_API void gxb_complex_commit(gxb_complex *cx) { gxbp_set_marks(cx); }

/* Was this memory taken since begin? */
static int gxbp_is_recent(const gxb_complex *cx, const void *memory) {
    const unsigned char *m = (const unsigned char *)memory;
    const gxb_block *block;
    for (block = cx->blocks; block != cx->mark_block; block = block->next)
        if (m >= (const unsigned char *)block && m < (const unsigned char *)block + block->size) return 1;
    return block != NULL && m >= (const unsigned char *)block + cx->mark_used && m < (const unsigned char *)block + block->size;
}

/* Gives back exact numbers kept since begin; those of older points and planes are computed again when needed. */
static void gxbp_drop_recent_numbers(gxb_complex *cx) {
    uint32_t i;
    for (i = 0; i < cx->mark[0]; i++) if (cx->points[i].exact != NULL && gxbp_is_recent(cx, cx->points[i].exact)) cx->points[i].exact = NULL;
    for (i = 0; i < cx->mark[1]; i++) if (cx->planes[i].exact != NULL && gxbp_is_recent(cx, cx->planes[i].exact)) cx->planes[i].exact = NULL;
    while (cx->blocks != cx->mark_block) {
        gxb_block *next = cx->blocks->next;
        gxbp_release(&cx->allocator, cx->blocks, cx->blocks->size);
        cx->blocks = next;
    }
    if (cx->blocks != NULL) cx->blocks->used = cx->mark_used;
}

GXFEM_API void gxb_complex_rollback(gxb_complex *cx) {
    while (cx->undo_count > 0) {
        const gxb_undo *undo = &cx->undo[--cx->undo_count];
        size_t size;
        void *item = gxbp_item(cx, undo->array, undo->index, &size);
        cx->undo_byte_count -= (uint32_t)size;
        memcpy(item, cx->undo_bytes + cx->undo_byte_count, size);
    }
    gxbp_drop_recent_numbers(cx);
    cx->point_count = cx->mark[0]; cx->plane_count = cx->mark[1]; cx->edge_count = cx->mark[2]; cx->facet_count = cx->mark[3];
    cx->leaf_count = cx->mark[4]; cx->tree_count = cx->mark[5]; cx->label_count = cx->mark[6]; cx->pool_count = cx->mark[7];
    cx->stamp[0]++; cx->stamp[1]++; cx->edge_stamp++;
    cx->height_element = GXB_NONE;
    gxbp_set_marks(cx);
}

/* >>topology: the complex of a mesh --------------------------------------------------------------------------------------- */

static gx_result gxbp_new_point(gxb_complex *cx, uint32_t *id) {
    const gx_result result = GXBP_RESERVE(cx, points, point, 1);
    if (result != GX_OK) return result;
    *id = cx->point_count++;
    memset(&cx->points[*id], 0, sizeof cx->points[*id]);
    cx->points[*id].parameter[0] = -1;
    return GX_OK;
}

/* Memory for exact numbers, in blocks that stay where they are until the complex is destroyed. NULL: there is none. */
static void *gxbp_block_take(gxb_complex *cx, size_t size) {
    const size_t head = (sizeof(gxb_block) + 15) & ~(size_t)15, room = cx->blocks == NULL ? 16384 : 262144;
    gxb_block *block = cx->blocks;
    size = (size + 15) & ~(size_t)15;
    if (block == NULL || block->size - block->used < size) {
        block = (gxb_block *)gxbp_allocate(&cx->allocator, head + room);
        if (block == NULL) return NULL;
        block->next = cx->blocks; block->size = head + room; block->used = head;
        cx->blocks = block;
    }
    block->used += size;
    return (unsigned char *)block + block->used - size;
}

/* A copy of four numbers that stays. NULL: no memory; the numbers are a cache, so that most callers may go on without. */
static gxb_num *gxbp_keep_exact(gxb_complex *cx, const gxb_num c[4]) {
    size_t total = 0;
    gxb_num *copy;
    gxb_limb *d;
    int k;
    for (k = 0; k < 4; k++) total += c[k].n;
    copy = (gxb_num *)gxbp_block_take(cx, 4 * sizeof *copy + total * sizeof *d);
    if (copy == NULL) return NULL;
    d = (gxb_limb *)(void *)(copy + 4);
    for (k = 0; k < 4; k++) {
        copy[k] = c[k];
        copy[k].d = d;
        memcpy(d, c[k].d, c[k].n * sizeof *d);
        d += c[k].n;
    }
    return copy;
}

/* (x - origin) * 2^shift, exact; GX_ERROR_RANGE outside of 2^-128 ... 2^128 */
static gx_result gxbp_frame_exact(const gxb_complex *cx, const double x[3], gxbp_vec *v) {
    int k;
    GXB_NUM(a); GXB_NUM(b);
    gxbp_vec_init(v);
    gxb_num_set(&v->c[3], 1.0, 0);
    for (k = 0; k < 3; k++) {
        int power;
        gxb_num_set(&a, x[k], cx->shift);
        gxb_num_set(&b, cx->origin[k], cx->shift);
        if ((a.sign != 0 && (gxbp_num_mantissa(&a, &power), power + 52 < -128)) || (a.sign != 0 && power + 52 > 128)) return GX_ERROR_RANGE;
        gxb_num_sub(&v->c[k], &a, &b);
        if (v->c[k].sign != 0 && (gxbp_num_mantissa(&v->c[k], &power), power + 52 > 128)) return GX_ERROR_RANGE;
    }
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_add_point(gxb_complex *cx, const double x[3], uint32_t *point) {
    gxbp_vec v;
    gx_result result;
    gxb_num *exact = NULL;
    uint32_t id;
    double ball[3], error = 0;
    int k;
    for (k = 0; k < 3; k++) if (!gxbp_is_finite(x[k])) return GX_ERROR_NOT_FINITE;
    result = gxbp_frame_exact(cx, x, &v);
    if (result != GX_OK) return result;
    for (k = 0; k < 3; k++) {
        GXB_NUM(back); GXB_NUM(rest);
        ball[k] = gxb_num_to_double(&v.c[k]);
        gxb_num_set(&back, ball[k], 0);
        gxb_num_sub(&rest, &v.c[k], &back);
        if (rest.sign != 0) error = gxbp_max(error, 2 * GXBP_U * gxbp_abs(ball[k]));
    }
    if (error > 0 && (exact = gxbp_keep_exact(cx, v.c)) == NULL) return GX_ERROR_MEMORY;
    result = gxbp_new_point(cx, &id);
    if (result != GX_OK) return result;
    memcpy(cx->points[id].ball.x, ball, sizeof ball);
    cx->points[id].ball.error = error;
    cx->points[id].kind = GXB_EXPLICIT;
    cx->points[id].exact = exact;
    *point = id;
    return GX_OK;
}

/* Exact homogeneous coordinates of a point of the complex given by its definition. */
static void gxbp_exact_definition(gxb_complex *cx, uint32_t kind, const uint32_t def[3], gxb_num out[4]);

/* The point's exact coordinates: kept, or in store where they need not or cannot be kept. */
static const gxb_num *gxbp_exact_cpoint(gxb_complex *cx, uint32_t point, gxbp_vec *store) {
    gxb_cpoint *p = &cx->points[point];
    if (p->exact != NULL) return p->exact;
    if (p->kind == GXB_EXPLICIT) {
        gxbp_vec_set(store, p->ball.x);
        return store->c;
    }
    gxbp_vec_init(store);
    gxbp_exact_definition(cx, p->kind, p->def, store->c);
    p->exact = gxbp_keep_exact(cx, store->c);
    return p->exact != NULL ? p->exact : store->c;
}

/* n = (q - p) x e_axis, d = n.p */
static void gxbp_exact_axis_plane(gxb_num plane[4], const gxb_num p[3], const gxb_num q[3], uint32_t axis) {
    gxbp_vec a;
    const uint32_t i = (axis + 1) % 3, j = (axis + 2) % 3;
    gxbp_vec_init(&a);
    gxbp_num_sub3(a.c, q, p);
    plane[axis].sign = 0; plane[axis].exp = 0; plane[axis].n = 0;
    gxbp_num_copy(&plane[i], &a.c[j], 1);       /* (a x e_k)_i = a_j, (a x e_k)_j = -a_i for i, j, k cyclic */
    gxbp_num_copy(&plane[j], &a.c[i], -1);
    gxbp_num_dot(&plane[3], plane, p);
}

static const gxb_num *gxbp_exact_cplane(gxb_complex *cx, uint32_t plane, gxbp_vec *store) {
    gxb_cplane *f = &cx->planes[plane];
    gxbp_vec s[3];
    const gxb_num *p, *q;
    if (f->exact != NULL) return f->exact;
    gxbp_vec_init(store);
    p = gxbp_exact_cpoint(cx, f->def[0], &s[0]);
    q = gxbp_exact_cpoint(cx, f->def[1], &s[1]);
    if (f->along_axis) gxbp_exact_axis_plane(store->c, p, q, f->def[2]);
    else gxbp_exact_plane(store->c, p, q, gxbp_exact_cpoint(cx, f->def[2], &s[2]));
    f->exact = gxbp_keep_exact(cx, store->c);
    return f->exact != NULL ? f->exact : store->c;
}

static void gxbp_exact_definition(gxb_complex *cx, uint32_t kind, const uint32_t def[3], gxb_num out[4]) {
    gxbp_vec s[3];
    const gxb_num *c = gxbp_exact_cplane(cx, def[2], &s[2]);
    if (kind == GXB_LINE_PLANE) {
        const gxb_num *p = gxbp_exact_cpoint(cx, def[0], &s[0]);
        gxbp_exact_line_plane(out, p, gxbp_exact_cpoint(cx, def[1], &s[1]), c);
    } else {
        const gxb_num *a = gxbp_exact_cplane(cx, def[0], &s[0]);
        gxbp_exact_three_planes(out, a, gxbp_exact_cplane(cx, def[1], &s[1]), c);
    }
}

/* The ball of a point given by its definition. */
static void gxbp_definition_ball(const gxb_complex *cx, uint32_t kind, const uint32_t def[3], gxb_ball *ball) {
    if (kind == GXB_LINE_PLANE) {
        gxbp_filter_line_plane(ball, &cx->points[def[0]].ball, &cx->points[def[1]].ball, &cx->planes[def[2]].filter);
    } else {
        const gxb_plane_filter *f[3];
        f[0] = &cx->planes[def[0]].filter; f[1] = &cx->planes[def[1]].filter; f[2] = &cx->planes[def[2]].filter;
        gxbp_filter_three_planes(ball, f);
    }
}

/* Is the point in the plane by the way in which either is defined? */
static int gxbp_incident(const gxb_complex *cx, uint32_t kind, const uint32_t def[3], uint32_t point, uint32_t plane) {
    const gxb_cplane *f = &cx->planes[plane];
    const uint32_t third = f->along_axis ? f->def[0] : f->def[2];
    if (kind == GXB_EXPLICIT) return point == f->def[0] || point == f->def[1] || point == third;
    if (def[2] == plane) return 1;
    if (kind == GXB_THREE_PLANES) return def[0] == plane || def[1] == plane;
    return (def[0] == f->def[0] || def[0] == f->def[1] || def[0] == third) &&
           (def[1] == f->def[0] || def[1] == f->def[1] || def[1] == third);
}

/* Does the plane contain both points by its definition? */
static int gxbp_plane_has_line(const gxb_cplane *f, uint32_t p, uint32_t q) {
    const uint32_t third = f->along_axis ? f->def[0] : f->def[2];
    return (p == f->def[0] || p == f->def[1] || p == third) && (q == f->def[0] || q == f->def[1] || q == third);
}

/* Is the point in the plane because two of its own planes meet in a line that the plane contains too? So it is where a sheet's
   triangles meet in their common edge: what a filter never settles, and exact arithmetic need not. */
static int gxbp_incident_by_line(const gxb_complex *cx, const uint32_t def[3], uint32_t plane) {
    const gxb_cplane *f = &cx->planes[plane];
    const uint32_t line_count = f->along_axis ? 1u : 3u;
    uint32_t k, i;
    for (k = 0; k < line_count; k++) {
        int count = 0;
        for (i = 0; i < 3; i++) count += gxbp_plane_has_line(&cx->planes[def[i]], f->def[k], f->def[(k + 1) % 3]);
        if (count >= 2) return 1;
    }
    return 0;
}

/* Sign of the exact value of n.X - d W for a point of the complex, or (point GXB_NONE) for one that only has a definition. */
static int gxbp_exact_sign(gxb_complex *cx, uint32_t kind, const uint32_t def[3], uint32_t point, uint32_t plane) {
    GXB_NUM(r);
    gxbp_vec sx, sn;
    const gxb_num *n = gxbp_exact_cplane(cx, plane, &sn), *x = sx.c;
    cx->exact_calls++;
    if (point != GXB_NONE) x = gxbp_exact_cpoint(cx, point, &sx);
    else {
        gxbp_vec_init(&sx);
        gxbp_exact_definition(cx, kind, def, sx.c);
    }
    gxbp_exact_side(&r, x, n);
    return r.sign;
}

static int gxbp_side_of(gxb_complex *cx, const gxb_ball *ball, uint32_t kind, const uint32_t def[3], uint32_t point, uint32_t plane) {
    double bound, value;
    int sign;
    if (gxbp_incident(cx, kind, def, point, plane)) return 0;
    cx->filter_calls++;
    if (ball->error < GXBP_NO_BALL) {
        value = gxbp_filter_side(ball, &cx->planes[plane].filter, &bound);
        sign = gxbp_filter_sign(value, bound);
        if (sign != 0) return sign;
    }
    if (kind == GXB_THREE_PLANES && gxbp_incident_by_line(cx, def, plane)) return 0;
    return gxbp_exact_sign(cx, kind, def, point, plane);
}

GXFEM_API int gxb_complex_side(gxb_complex *cx, uint32_t point, uint32_t plane) {
    const gxb_cpoint p = cx->points[point];
    return gxbp_side_of(cx, &p.ball, p.kind, p.def, point, plane);
}

/* The side with a memory: slot 0 for the triangle being inserted, slot 1 for its edges' planes. */
static int gxbp_sign(gxb_complex *cx, uint32_t point, uint32_t plane, int slot) {
    if (cx->points[point].stamp[slot] != cx->stamp[slot]) {
        const int sign = gxb_complex_side(cx, point, plane);
        cx->points[point].sign[slot] = sign;
        cx->points[point].stamp[slot] = cx->stamp[slot];
    }
    return cx->points[point].sign[slot];
}

GXFEM_API int gxb_complex_turn(gxb_complex *cx, uint32_t a, uint32_t b, uint32_t c, uint32_t plane) {
    const gxb_cplane *f = &cx->planes[plane];
    const int i = (int)(f->axis + 1) % 3, j = (int)(f->axis + 2) % 3;
    int turn = 0;
    if (cx->points[a].ball.error < GXBP_NO_BALL && cx->points[b].ball.error < GXBP_NO_BALL && cx->points[c].ball.error < GXBP_NO_BALL)
        turn = gxbp_filter_turn(&cx->points[a].ball, &cx->points[b].ball, &cx->points[c].ball, i, j);
    if (turn == 0) {
        gxbp_vec s[3];
        const gxb_num *x = gxbp_exact_cpoint(cx, a, &s[0]), *y = gxbp_exact_cpoint(cx, b, &s[1]), *z = gxbp_exact_cpoint(cx, c, &s[2]);
        turn = gxbp_orient_exact(x, y, z, i, j);
    }
    return turn * f->axis_sign;
}

GXFEM_API int gxb_complex_compare(gxb_complex *cx, uint32_t point, int axis, double value) {
    GXB_NUM(a); GXB_NUM(b); GXB_NUM(c);
    gxbp_vec store;
    const gxb_num *x = gxbp_exact_cpoint(cx, point, &store);
    gxb_num_set(&a, value, cx->shift);
    gxb_num_set(&b, cx->origin[axis], cx->shift);
    gxb_num_sub(&c, &a, &b);
    gxb_num_mul(&a, &c, &x[3]);
    gxb_num_sub(&b, &x[axis], &a);
    return b.sign;
}

/* A plane through three points, or (axis < 3) through two along a coordinate axis. */
static gx_result gxbp_new_plane(gxb_complex *cx, uint32_t p, uint32_t q, uint32_t r, int along_axis, uint32_t *id) {
    gx_result result = GXBP_RESERVE(cx, planes, plane, 1);
    gxb_cplane *f;
    double a[3], b[3] = {0, 0, 0}, ea, eb = 0;
    if (result != GX_OK) return result;
    *id = cx->plane_count++;
    f = &cx->planes[*id];
    memset(f, 0, sizeof *f);
    f->def[0] = p; f->def[1] = q; f->def[2] = r;
    f->along_axis = (uint32_t)along_axis;
    ea = gxbp_filter_difference(a, &cx->points[p].ball, &cx->points[q].ball);
    if (along_axis) b[r] = 1;
    else eb = gxbp_filter_difference(b, &cx->points[p].ball, &cx->points[r].ball);
    gxbp_filter_plane(&f->filter, &cx->points[p].ball, a, ea, b, eb);
    return GX_OK;
}

/* Sign of one component of a plane's normal. */
static int gxbp_normal_sign(gxb_complex *cx, uint32_t plane, uint32_t axis) {
    const gxb_plane_filter *f = &cx->planes[plane].filter;
    const int sign = gxbp_filter_sign(f->n[axis], f->error);
    gxbp_vec store;
    return sign != 0 ? sign : gxbp_exact_cplane(cx, plane, &store)[axis].sign;
}

/* Finds a component of the normal that is not 0, the largest where the filter can tell. 0: there is none. */
static int gxbp_plane_axis(gxb_complex *cx, uint32_t plane) {
    const double *n = cx->planes[plane].filter.n;
    uint32_t axis = gxbp_abs(n[0]) >= gxbp_abs(n[1]) ? 0u : 1u, k;
    int sign;
    if (gxbp_abs(n[2]) > gxbp_abs(n[axis])) axis = 2;
    sign = gxbp_normal_sign(cx, plane, axis);
    for (k = 0; k < 3 && sign == 0; k++) {
        axis = k;
        sign = gxbp_normal_sign(cx, plane, axis);
    }
    cx->planes[plane].axis = axis;
    cx->planes[plane].axis_sign = sign;
    return sign != 0;
}

GXFEM_API gx_result gxb_complex_add_plane(gxb_complex *cx, gxb_triangle *t) {
    const gx_result result = gxbp_new_plane(cx, t->point[0], t->point[1], t->point[2], 0, &t->plane);
    if (result != GX_OK) return result;
    t->orientation = 1;
    t->edge_plane[0] = t->edge_plane[1] = t->edge_plane[2] = GXB_NONE;
    return gxbp_plane_axis(cx, t->plane) ? GX_OK : GX_ERROR_FLAT;
}

/* --- faces and edges of the mesh by sorting --- */

typedef struct gxbp_key { uint32_t node[3], element, local; } gxbp_key;

static int gxbp_compare_keys(const void *a, const void *b) {
    const gxbp_key *p = (const gxbp_key *)a, *q = (const gxbp_key *)b;
    int k;
    for (k = 0; k < 3; k++) if (p->node[k] != q->node[k]) return p->node[k] < q->node[k] ? -1 : 1;
    if (p->element != q->element) return p->element < q->element ? -1 : 1;
    return 0;
}

static const uint8_t gxbp_face_nodes[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};     /* outward, opposite to node k */
static const uint8_t gxbp_edge_nodes[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static void gxbp_sort3(uint32_t a[3]) {
    uint32_t t;
    if (a[0] > a[1]) { t = a[0]; a[0] = a[1]; a[1] = t; }
    if (a[1] > a[2]) { t = a[1]; a[1] = a[2]; a[2] = t; }
    if (a[0] > a[1]) { t = a[0]; a[0] = a[1]; a[1] = t; }
}

static int gxbp_same_nodes(const gxbp_key *a, const gxbp_key *b) { return memcmp(a->node, b->node, sizeof a->node) == 0; }

/* 1 where the outward order of the element's face is an even permutation of the sorted nodes */
static int gxbp_face_is_even(const uint32_t *element, uint32_t face) {
    const uint32_t a = element[gxbp_face_nodes[face][0]], b = element[gxbp_face_nodes[face][1]], c = element[gxbp_face_nodes[face][2]];
    return (a < b) == ((b < c) == (a < c));
}

/* Numbers the faces in the order of their sorted nodes. */
static gx_result gxbp_number_faces(gxb_complex *cx, gxbp_key *keys, size_t *bad) {
    const size_t count = (size_t)cx->element_count * 4;
    size_t i;
    uint32_t e, k, j;
    for (e = 0, i = 0; e < cx->element_count; e++) for (k = 0; k < 4; k++, i++) {
        for (j = 0; j < 3; j++) keys[i].node[j] = cx->elements[4 * e + gxbp_face_nodes[k][j]];
        gxbp_sort3(keys[i].node);
        keys[i].element = e; keys[i].local = k;
    }
    qsort(keys, count, sizeof *keys, gxbp_compare_keys);
    cx->face_count = 0;
    for (i = 0; i < count; i++) {
        const int again = i > 0 && gxbp_same_nodes(&keys[i], &keys[i - 1]);
        const int side = gxbp_face_is_even(cx->elements + 4 * keys[i].element, keys[i].local);  /* behind the sorted normal */
        if (!again) {
            cx->face_elements[2 * cx->face_count] = cx->face_elements[2 * cx->face_count + 1] = GXB_NONE;
            cx->face_count++;
        }
        if (cx->face_elements[2 * (cx->face_count - 1) + (uint32_t)side] != GXB_NONE) { *bad = keys[i].element; return GX_ERROR_OVERLAP; }
        cx->face_elements[2 * (cx->face_count - 1) + (uint32_t)side] = keys[i].element;
        cx->element_faces[4 * keys[i].element + keys[i].local] = cx->face_count - 1;
    }
    return GX_OK;
}

static void gxbp_number_edges(gxb_complex *cx, gxbp_key *keys) {
    const size_t count = (size_t)cx->element_count * 6;
    size_t i;
    uint32_t e, k;
    for (e = 0, i = 0; e < cx->element_count; e++) for (k = 0; k < 6; k++, i++) {
        const uint32_t a = cx->elements[4 * e + gxbp_edge_nodes[k][0]], b = cx->elements[4 * e + gxbp_edge_nodes[k][1]];
        keys[i].node[0] = a < b ? a : b; keys[i].node[1] = a < b ? b : a; keys[i].node[2] = 0;
        keys[i].element = e; keys[i].local = k;
    }
    qsort(keys, count, sizeof *keys, gxbp_compare_keys);
    for (i = 0, cx->mesh_edge_count = 0; i < count; i++) {
        if (i == 0 || !gxbp_same_nodes(&keys[i], &keys[i - 1])) cx->mesh_edge_count++;
        cx->element_edges[6 * keys[i].element + keys[i].local] = cx->mesh_edge_count - 1;
    }
}

/* floor(log2(high - low)), whatever the mode of the floating-point unit; -2000 where they are equal */
static int gxbp_difference_exponent(double high, double low) {
    GXB_NUM(a); GXB_NUM(b); GXB_NUM(d);
    int power;
    gxb_num_set(&a, high, 0);
    gxb_num_set(&b, low, 0);
    gxb_num_sub(&d, &a, &b);
    if (d.sign == 0) return -2000;
    gxbp_num_mantissa(&d, &power);
    return power + 52;
}

/* Frame: the origin is the mesh's lower corner rounded to few bits where the mesh lies far from 0 (so that the shift adds no
   bits to its coordinates), else 0; the scale brings the box to size 1. */
static gx_result gxbp_choose_frame(gxb_complex *cx, const gxb_mesh *mesh, size_t *bad) {
    int axis, largest = -2000;
    for (axis = 0; axis < 3; axis++) {
        double low = 0, high = 0;
        int size;
        size_t i;
        for (i = 0; i < mesh->node_count; i++) {
            const double x = mesh->positions[3 * i + (size_t)axis];
            if (!gxbp_is_finite(x)) { *bad = i; return GX_ERROR_NOT_FINITE; }
            if (gxbp_exponent_bits(x) > 2000) { *bad = i; return GX_ERROR_RANGE; }
            if (i == 0 || gxbp_compare_doubles(x, low) < 0) low = x;
            if (i == 0 || gxbp_compare_doubles(x, high) > 0) high = x;
        }
        size = gxbp_difference_exponent(high, low);
        if (size == -2000) size = gxbp_is_zero(low) ? -2000 : gxbp_exponent(low);
        if (size > largest) largest = size;
        if (size > -2000 && !gxbp_is_zero(low) && gxbp_exponent(low) > size + 3) {
            const int drop = gxbp_exponent(low) - size;                 /* keep so many leading bits */
            if (drop < 52) cx->origin[axis] = gxbp_double(gxbp_bits(low) & ~((((uint64_t)1) << (52 - drop)) - 1));
            else cx->origin[axis] = low;
        }
    }
    cx->shift = largest == -2000 ? 0 : -largest - 1;
    return GX_OK;
}

static gx_result gxbp_add_nodes(gxb_complex *cx, const gxb_mesh *mesh, size_t *bad) {
    size_t i;
    gx_result result = GXBP_RESERVE(cx, points, point, mesh->node_count);
    for (i = 0; i < mesh->node_count && result == GX_OK; i++) {
        uint32_t id;
        result = gxb_complex_add_point(cx, mesh->positions + 3 * i, &id);
        if (result != GX_OK && result != GX_ERROR_MEMORY) *bad = i;
    }
    return result;
}

static gx_result gxbp_check_elements(gxb_complex *cx, const gxb_mesh *mesh, size_t *bad) {
    uint32_t e;
    int k;
    for (e = 0; e < cx->element_count; e++) {
        const double *x[4];
        int sign;
        *bad = e;
        for (k = 0; k < 4; k++) {
            if (cx->elements[4 * e + (uint32_t)k] >= mesh->node_count) return GX_ERROR_INDEX;
            x[k] = mesh->positions + 3 * (size_t)cx->elements[4 * e + (uint32_t)k];
        }
        sign = gxb_orient3d(x[1], x[2], x[3], x[0]);    /* node 0 lies behind face 123 as seen from outside: below it */
        if (sign == 0) return GX_ERROR_FLAT;
        if (sign < 0) return GX_ERROR_INVERTED;
    }
    *bad = SIZE_MAX;
    return GX_OK;
}

static gx_result gxbp_make_leaves(gxb_complex *cx) {
    uint32_t e;
    const gx_result result = GXBP_RESERVE(cx, leaves, leaf, cx->element_count);
    if (result != GX_OK) return result;
    memset(cx->leaves, 0, cx->element_count * sizeof *cx->leaves);
    for (e = 0; e < cx->element_count; e++) {
        cx->leaves[e].element = e;
        cx->leaves[e].parent = GXB_NONE;
        cx->root[e] = 2 * e;
    }
    cx->leaf_count = cx->element_count;
    memset(cx->face_facet, 0xff, cx->face_count * sizeof *cx->face_facet);
    memset(cx->mesh_edge, 0xff, cx->mesh_edge_count * sizeof *cx->mesh_edge);
    return GX_OK;
}

/* One block for the tables of fixed size. */
static size_t gxbp_table_words(size_t elements) { return elements * (4 + 4 + 6 + 8 + 4 + 6 + 1); }

static gx_result gxbp_fill_complex(gxb_complex *cx, const gxb_mesh *mesh, uint32_t *table, size_t *bad) {
    const size_t n = mesh->element_count;
    const size_t key_bytes = n * 6 * sizeof(gxbp_key);
    gx_result result = gxbp_choose_frame(cx, mesh, bad);
    gxbp_key *keys;
    memcpy(table, mesh->elements, n * 4 * sizeof *table);
    cx->elements = table;
    cx->element_faces = table + 4 * n; cx->element_edges = table + 8 * n; cx->face_elements = table + 14 * n;
    cx->face_facet = table + 22 * n; cx->mesh_edge = table + 26 * n; cx->root = table + 32 * n;
    if (result == GX_OK) result = gxbp_check_elements(cx, mesh, bad);
    if (result == GX_OK) result = gxbp_add_nodes(cx, mesh, bad);
    if (result != GX_OK) return result;
    keys = (gxbp_key *)gxbp_allocate(&cx->allocator, key_bytes);
    if (keys == NULL) return GX_ERROR_MEMORY;
    result = gxbp_number_faces(cx, keys, bad);
    if (result == GX_OK) gxbp_number_edges(cx, keys);
    gxbp_release(&cx->allocator, keys, key_bytes);
    return result == GX_OK ? gxbp_make_leaves(cx) : result;
}

static gx_result gxbp_fail(gx_failure *failure, gx_result result, size_t index) {
    if (failure != NULL) { failure->result = result; failure->index = index; failure->surface = SIZE_MAX; }
    return result;
}

GXFEM_API gx_result gxb_complex_create(const gxb_mesh *mesh, const gx_allocator *allocator, gxb_complex **complex,
                                       gx_failure *failure) {
    gx_allocator none;
    gxb_complex *cx;
    uint32_t *table;
    size_t bad = SIZE_MAX;
    gx_result result;
    memset(&none, 0, sizeof none);
    if (allocator == NULL) allocator = &none;
    if (mesh == NULL || complex == NULL) return gxbp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    if (mesh->node_count == 0 || mesh->element_count == 0) return gxbp_fail(failure, GX_ERROR_EMPTY, SIZE_MAX);
    if (mesh->positions == NULL || mesh->elements == NULL) return gxbp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    if (mesh->element_count > INT32_MAX / 8 || mesh->element_count > SIZE_MAX / 256 || mesh->node_count > INT32_MAX) return gxbp_fail(failure, GX_ERROR_LIMIT, SIZE_MAX);
    cx = (gxb_complex *)gxbp_allocate(allocator, sizeof *cx);
    if (cx == NULL) return gxbp_fail(failure, GX_ERROR_MEMORY, SIZE_MAX);
    memset(cx, 0, sizeof *cx);
    cx->allocator = *allocator;
    cx->node_count = (uint32_t)mesh->node_count;
    cx->element_count = (uint32_t)mesh->element_count;
    table = (uint32_t *)gxbp_allocate(allocator, gxbp_table_words(mesh->element_count) * sizeof *table);
    cx->elements = table;
    result = table == NULL ? GX_ERROR_MEMORY : gxbp_fill_complex(cx, mesh, table, &bad);
    if (result != GX_OK) {
        gxb_complex_destroy(cx);
        return gxbp_fail(failure, result, bad);
    }
    cx->stamp[0] = cx->stamp[1] = cx->edge_stamp = 1;
    cx->height_element = GXB_NONE;
    gxb_complex_begin(cx);
    *complex = cx;
    return gxbp_fail(failure, GX_OK, SIZE_MAX);
}

#define GXBP_FREE(array, counter) gxbp_release(&a, cx->array, (size_t)cx->counter##_capacity * sizeof *cx->array)

typedef struct gxbp_corner {    /* of a clipped polygon: its point, and what carries the edge to the next corner */
    gxb_ball ball;
    uint32_t kind, def[3], point;
    uint32_t carrier;           /* a plane, or GXBP_TRIANGLE_EDGE + k */
    int32_t sign;
} gxbp_corner;

typedef struct gxbp_task { uint32_t parent, side, first, count, coplanar; } gxbp_task;

#define GXBP_TRIANGLE_EDGE 0x80000000u
#define GXBP_IN_ROOT GXB_NONE   /* task.parent: the reference is the element's root */

GXFEM_API void gxb_complex_destroy(gxb_complex *cx) {
    gx_allocator a;
    if (cx == NULL) return;
    a = cx->allocator;
    while (cx->blocks != NULL) {
        gxb_block *next = cx->blocks->next;
        gxbp_release(&a, cx->blocks, cx->blocks->size);
        cx->blocks = next;
    }
    GXBP_FREE(points, point); GXBP_FREE(planes, plane); GXBP_FREE(edges, edge); GXBP_FREE(facets, facet);
    GXBP_FREE(leaves, leaf); GXBP_FREE(nodes, tree); GXBP_FREE(labels, label);
    GXBP_FREE(pool, pool); GXBP_FREE(walls, wall); GXBP_FREE(undo, undo);
    GXBP_FREE(undo_bytes, undo_byte); GXBP_FREE(corners, corner); GXBP_FREE(tasks, task); GXBP_FREE(scratch, scratch);
    gxbp_release(&a, cx->elements, gxbp_table_words(cx->element_count) * sizeof *cx->elements);
    gxbp_release(&a, cx, sizeof *cx);
}

/* >>split: dividing edges, facets and leaves by a plane --------------------------------------------------------------------
 *
 * Every function here that can run out of memory reserves room first and then changes the complex without a way to fail.
 */

/* The facets (edges) into which one was divided stand behind it as a binary tree; walks its leaves in order. */
static uint32_t gxbp_count_facets(const gxb_complex *cx, uint32_t facet) {
    const uint32_t child = cx->facets[facet].child;
    return child == GXB_NONE ? 1 : gxbp_count_facets(cx, child) + gxbp_count_facets(cx, child + 1);
}

static void gxbp_push_facets(gxb_complex *cx, uint32_t facet) {
    const uint32_t child = cx->facets[facet].child;
    if (child == GXB_NONE) cx->pool[cx->pool_count++] = facet;
    else {
        gxbp_push_facets(cx, child);
        gxbp_push_facets(cx, child + 1);
    }
}

static uint32_t gxbp_count_edges(const gxb_complex *cx, uint32_t edge) {
    const uint32_t child = cx->edges[edge].child;
    return child == GXB_NONE ? 1 : gxbp_count_edges(cx, child) + gxbp_count_edges(cx, child + 1);
}

static void gxbp_push_edges(gxb_complex *cx, uint32_t signed_edge) {
    const uint32_t child = cx->edges[signed_edge >> 1].child, back = signed_edge & 1;
    if (child == GXB_NONE) cx->pool[cx->pool_count++] = signed_edge;
    else {
        gxbp_push_edges(cx, (child + back) << 1 | back);
        gxbp_push_edges(cx, (child + 1 - back) << 1 | back);
    }
}

GXFEM_API gx_result gxb_facet_edges(gxb_complex *cx, uint32_t facet, uint32_t *first, uint32_t *count) {
    gxb_facet *f = &cx->facets[facet];
    uint32_t i, total = 0;
    for (i = 0; i < f->loop_count; i++) total += gxbp_count_edges(cx, cx->pool[f->loop + i] >> 1);
    if (total != f->loop_count) {
        const uint32_t start = cx->pool_count;
        gx_result result = GXBP_RESERVE(cx, pool, pool, total);
        if (result == GX_OK) result = gxbp_reserve_undo(cx, 1);
        if (result != GX_OK) return result;
        gxbp_save(cx, GXBP_FACETS, facet);
        for (i = 0; i < f->loop_count; i++) gxbp_push_edges(cx, cx->pool[f->loop + i]);
        f->loop = start;
        f->loop_count = total;
    }
    *first = f->loop;
    *count = f->loop_count;
    return GX_OK;
}

GXFEM_API gx_result gxb_leaf_facets(gxb_complex *cx, uint32_t leaf, uint32_t *first, uint32_t *count) {
    gxb_leaf *l = &cx->leaves[leaf];
    uint32_t i, total = 0;
    for (i = 0; i < l->facet_count; i++) total += gxbp_count_facets(cx, cx->pool[l->facets + i]);
    if (total != l->facet_count) {
        const uint32_t start = cx->pool_count;
        gx_result result = GXBP_RESERVE(cx, pool, pool, total);
        if (result == GX_OK) result = gxbp_reserve_undo(cx, 1);
        if (result != GX_OK) return result;
        gxbp_save(cx, GXBP_LEAVES, leaf);
        for (i = 0; i < l->facet_count; i++) gxbp_push_facets(cx, cx->pool[l->facets + i]);
        l->facets = start;
        l->facet_count = total;
    }
    *first = l->facets;
    *count = l->facet_count;
    return GX_OK;
}

static uint32_t gxbp_edge_start(const gxb_complex *cx, uint32_t signed_edge) { return cx->edges[signed_edge >> 1].v[signed_edge & 1]; }

/* The cutting plane, and (explicit_line) the line in which the facets to be divided meet it, where that is a triangle's edge. */
typedef struct gxbp_knife { uint32_t plane, line[2]; int explicit_line, slot; } gxbp_knife;

/* Room for dividing facets with so many edges in all. */
static gx_result gxbp_reserve_split(gxb_complex *cx, size_t facets, size_t edges) {
    gx_result result = GXBP_RESERVE(cx, points, point, edges + 2);
    if (result == GX_OK) result = GXBP_RESERVE(cx, edges, edge, 2 * edges + facets + 4);
    if (result == GX_OK) result = GXBP_RESERVE(cx, facets, facet, 2 * facets + 2);
    if (result == GX_OK) result = GXBP_RESERVE(cx, leaves, leaf, 1);
    if (result == GX_OK) result = GXBP_RESERVE(cx, nodes, tree, 1);
    if (result == GX_OK) result = GXBP_RESERVE(cx, pool, pool, 8 * (edges + facets) + 64);
    if (result == GX_OK) result = GXBP_RESERVE(cx, scratch, scratch, 4 * (edges + facets) + 64);
    return result == GX_OK ? gxbp_reserve_undo(cx, edges + 3 * facets + 8) : result;
}

static uint32_t gxbp_new_edge(gxb_complex *cx, uint32_t a, uint32_t b, const uint32_t line[2], uint32_t explicit_line) {
    gxb_edge *e = &cx->edges[cx->edge_count];
    memset(e, 0, sizeof *e);
    e->v[0] = a; e->v[1] = b;
    e->line[0] = line[0]; e->line[1] = line[1];
    e->explicit_line = explicit_line;
    e->child = GXB_NONE;
    return cx->edge_count++;
}

/* Divides the edge where the plane crosses it; its ends lie strictly on either side. */
static void gxbp_split_edge(gxb_complex *cx, uint32_t edge, const gxbp_knife *knife) {
    const gxb_edge e = cx->edges[edge];
    const uint32_t id = cx->point_count++;
    gxb_cpoint *p = &cx->points[id];
    memset(p, 0, sizeof *p);
    p->parameter[0] = -1;
    p->kind = e.explicit_line ? GXB_LINE_PLANE : GXB_THREE_PLANES;
    p->def[0] = e.line[0]; p->def[1] = e.line[1]; p->def[2] = knife->plane;
    gxbp_definition_ball(cx, p->kind, p->def, &p->ball);
    p->stamp[knife->slot] = cx->stamp[knife->slot];
    p->sign[knife->slot] = 0;
    gxbp_save(cx, GXBP_EDGES, edge);
    cx->edges[edge].child = cx->edge_count;
    gxbp_new_edge(cx, e.v[0], id, e.line, e.explicit_line);
    gxbp_new_edge(cx, id, e.v[1], e.line, e.explicit_line);
    cx->edges[cx->edge_count - 2].wall = cx->edges[cx->edge_count - 1].wall = e.wall;
}

/* Divides the edges of a facet that the plane crosses and renews its loop. Room was reserved. */
static void gxbp_split_facet_edges(gxb_complex *cx, uint32_t facet, const gxbp_knife *knife) {
    gxb_facet *f = &cx->facets[facet];
    const uint32_t start = cx->pool_count, loop = f->loop, count = f->loop_count;
    uint32_t i;
    for (i = 0; i < count; i++) {
        const uint32_t e = cx->pool[loop + i] >> 1;
        if (cx->edges[e].child == GXB_NONE &&
            gxbp_sign(cx, cx->edges[e].v[0], knife->plane, knife->slot) * gxbp_sign(cx, cx->edges[e].v[1], knife->plane, knife->slot) < 0)
            gxbp_split_edge(cx, e, knife);
    }
    for (i = 0; i < count; i++) gxbp_push_edges(cx, cx->pool[loop + i]);
    if (cx->pool_count - start == count) { cx->pool_count = start; return; }
    gxbp_save(cx, GXBP_FACETS, facet);
    f->loop = start;
    f->loop_count = cx->pool_count - start;
}

/* Bit 1: the facet has points in front of the plane, bit 2: behind it. */
static int gxbp_facet_sides(gxb_complex *cx, uint32_t facet, const gxbp_knife *knife) {
    const gxb_facet *f = &cx->facets[facet];
    int sides = 0;
    uint32_t i;
    for (i = 0; i < f->loop_count; i++) {
        const int sign = gxbp_sign(cx, gxbp_edge_start(cx, cx->pool[f->loop + i]), knife->plane, knife->slot);
        sides |= sign > 0 ? 1 : sign < 0 ? 2 : 0;
    }
    return sides;
}

static void gxbp_copy_arc(gxb_complex *cx, const gxb_facet *f, uint32_t from, uint32_t to, uint32_t closing, gxb_facet *child) {
    uint32_t i;
    child->loop = cx->pool_count;
    for (i = from; i != to; i = (i + 1) % f->loop_count) cx->pool[cx->pool_count++] = cx->pool[f->loop + i];
    cx->pool[cx->pool_count++] = closing;
    child->loop_count = cx->pool_count - child->loop;
}

/* Divides a facet that has points on both sides of the plane. Its children are child (in front) and child + 1. Returns the new edge,
   signed as the front child walks it. */
static uint32_t gxbp_split_facet(gxb_complex *cx, uint32_t facet, const gxbp_knife *knife) {
    const uint32_t child = cx->facet_count;
    uint32_t line[2], zero[2] = {0, 0}, zeros = 0, i, edge, front;
    gxb_facet f;
    gxbp_split_facet_edges(cx, facet, knife);
    f = cx->facets[facet];
    for (i = 0; i < f.loop_count && zeros < 2; i++) {
        if (gxbp_sign(cx, gxbp_edge_start(cx, cx->pool[f.loop + i]), knife->plane, knife->slot) == 0) zero[zeros++] = i;
    }
    line[0] = knife->explicit_line ? knife->line[0] : f.plane;
    line[1] = knife->explicit_line ? knife->line[1] : knife->plane;
    edge = gxbp_new_edge(cx, gxbp_edge_start(cx, cx->pool[f.loop + zero[0]]), gxbp_edge_start(cx, cx->pool[f.loop + zero[1]]), line,
                         (uint32_t)knife->explicit_line);
    front = gxbp_sign(cx, gxbp_edge_start(cx, cx->pool[f.loop + zero[0] + 1]), knife->plane, knife->slot) > 0 ? 0u : 1u;
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->facets[facet].child = child;
    cx->facets[child] = f;
    cx->facets[child + 1] = f;
    /* arc 0 runs from zero[0] to zero[1] and is closed backwards along the edge, arc 1 is the rest, closed forwards */
    gxbp_copy_arc(cx, &f, zero[front], zero[1 - front], edge << 1 | (1u - front), &cx->facets[child]);
    gxbp_copy_arc(cx, &f, zero[1 - front], zero[front], edge << 1 | front, &cx->facets[child + 1]);
    cx->facet_count += 2;
    return edge << 1 | (1u - front);
}

/* --- dividing a leaf: its facets, then the facet between the two halves, then the tree --- */

typedef struct gxbp_rim { uint32_t first, count; } gxbp_rim;    /* signed edges in complex.scratch */

static void gxbp_add_rim(gxb_complex *cx, gxbp_rim *rim, uint32_t signed_edge) {
    gxb_edge *e = &cx->edges[signed_edge >> 1];
    if (e->stamp == cx->edge_stamp) return;
    e->stamp = cx->edge_stamp;
    cx->scratch[rim->first + rim->count++] = signed_edge;
}

/* Edges of an undivided facet that lie in the plane belong to the rim: walked against the outside's view of the half in front. */
static void gxbp_add_flat_edges(gxb_complex *cx, gxbp_rim *rim, uint32_t facet, uint32_t flip, const gxbp_knife *knife) {
    const gxb_facet *f = &cx->facets[facet];
    uint32_t i;
    for (i = 0; i < f->loop_count; i++) {
        const uint32_t e = cx->pool[f->loop + i];
        if (gxbp_sign(cx, cx->edges[e >> 1].v[0], knife->plane, knife->slot) == 0 &&
            gxbp_sign(cx, cx->edges[e >> 1].v[1], knife->plane, knife->slot) == 0) gxbp_add_rim(cx, rim, e ^ flip);
    }
}

/* Chains the rim's edges into the loop of a new facet of the plane. */
static uint32_t gxbp_close_rim(gxb_complex *cx, const gxbp_rim *rim, const gxbp_knife *knife) {
    gxb_facet *f = &cx->facets[cx->facet_count];
    uint32_t i, e = cx->scratch[rim->first];
    for (i = 0; i < rim->count; i++) {
        const uint32_t signed_edge = cx->scratch[rim->first + i];
        cx->points[gxbp_edge_start(cx, signed_edge)].scratch = signed_edge;
    }
    memset(f, 0, sizeof *f);
    f->plane = knife->plane;
    f->loop = cx->pool_count;
    f->loop_count = rim->count;
    f->child = f->labels = f->face = GXB_NONE;
    for (i = 0; i < rim->count; i++) {
        cx->pool[cx->pool_count++] = e;
        e = cx->points[cx->edges[e >> 1].v[1 - (e & 1)]].scratch;
    }
    return cx->facet_count++;
}

static void gxbp_move_facet(gxb_complex *cx, uint32_t facet, uint32_t from, uint32_t to) {
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->facets[facet].leaf[cx->facets[facet].leaf[0] == from ? 0 : 1] = to;
}

/* Divides a leaf whose inside the plane meets; its facets are resolved and room is reserved. The leaf becomes the half in front, the
   new one lies behind. Returns the facet between them. */
static uint32_t gxbp_split_leaf(gxb_complex *cx, uint32_t leaf, const gxbp_knife *knife) {
    const uint32_t behind = cx->leaf_count++, first = cx->leaves[leaf].facets, count = cx->leaves[leaf].facet_count;
    gxbp_rim rim;
    uint32_t *front_list, *behind_list, fronts = 0, behinds = 0, i, middle;
    rim.first = 0; rim.count = 0;
    cx->edge_stamp++;
    front_list = cx->scratch + cx->scratch_capacity - 2 * count - 2;
    behind_list = cx->scratch + cx->scratch_capacity - count - 1;
    for (i = 0; i < count; i++) {
        const uint32_t facet = cx->pool[first + i];
        const uint32_t inward = cx->facets[facet].leaf[0] == leaf ? 1u : 0u;     /* its normal points into the leaf */
        const int sides = gxbp_facet_sides(cx, facet, knife);
        if (sides == 3) {
            const uint32_t edge = gxbp_split_facet(cx, facet, knife), child = cx->facets[facet].child;
            gxbp_add_rim(cx, &rim, edge ^ inward);
            gxbp_move_facet(cx, child + 1, leaf, behind);
            front_list[fronts++] = child;
            behind_list[behinds++] = child + 1;
        } else {
            gxbp_add_flat_edges(cx, &rim, facet, inward ^ (sides == 1 ? 0u : 1u), knife);
            if (sides == 1) front_list[fronts++] = facet;
            else {
                gxbp_move_facet(cx, facet, leaf, behind);
                behind_list[behinds++] = facet;
            }
        }
    }
    middle = gxbp_close_rim(cx, &rim, knife);
    cx->facets[middle].leaf[0] = leaf;
    cx->facets[middle].leaf[1] = behind;
    front_list[fronts++] = middle;
    behind_list[behinds++] = middle;
    gxbp_save(cx, GXBP_LEAVES, leaf);
    cx->leaves[behind] = cx->leaves[leaf];
    cx->leaves[behind].parent = leaf;
    cx->leaves[leaf].facets = cx->pool_count;
    cx->leaves[leaf].facet_count = fronts;
    for (i = 0; i < fronts; i++) cx->pool[cx->pool_count++] = front_list[i];
    cx->leaves[behind].facets = cx->pool_count;
    cx->leaves[behind].facet_count = behinds;
    for (i = 0; i < behinds; i++) cx->pool[cx->pool_count++] = behind_list[i];
    return middle;
}

/* --- elements are opened when they are first touched --- */

static uint32_t gxbp_open_edge(gxb_complex *cx, uint32_t mesh_edge, uint32_t a, uint32_t b) {
    uint32_t line[2];
    if (cx->mesh_edge[mesh_edge] == GXB_NONE) {
        line[0] = a < b ? a : b; line[1] = a < b ? b : a;
        gxbp_save(cx, GXBP_MESH_EDGES, mesh_edge);
        cx->mesh_edge[mesh_edge] = gxbp_new_edge(cx, line[0], line[1], line, 1);
    }
    return cx->mesh_edge[mesh_edge] << 1 | (a < b ? 0u : 1u);
}

/* The mesh edge between local nodes i and j of an element. */
static uint32_t gxbp_local_edge(uint32_t i, uint32_t j) {
    static const uint8_t table[4][4] = {{0, 0, 1, 2}, {0, 0, 3, 4}, {1, 3, 0, 5}, {2, 4, 5, 0}};
    return table[i][j];
}

/* The facet of an element's face: its plane through the nodes in ascending order, so that both elements make the same. */
static gx_result gxbp_open_face(gxb_complex *cx, uint32_t element, uint32_t k) {
    const uint32_t face = cx->element_faces[4 * element + k], *node = cx->elements + 4 * (size_t)element;
    uint32_t local[3], j, t, plane;
    gxb_facet *f;
    gx_result result;
    if (cx->face_facet[face] != GXB_NONE) return GX_OK;
    for (j = 0; j < 3; j++) local[j] = gxbp_face_nodes[k][j];
    for (j = 0; j < 3; j++) {       /* sort by node: three steps of a bubble */
        const uint32_t i = j % 2;
        if (node[local[i]] > node[local[i + 1]]) { t = local[i]; local[i] = local[i + 1]; local[i + 1] = t; }
    }
    result = gxbp_new_plane(cx, node[local[0]], node[local[1]], node[local[2]], 0, &plane);
    if (result == GX_OK) result = gxbp_reserve_split(cx, 1, 3);
    if (result != GX_OK) return result;
    gxbp_plane_axis(cx, plane);
    f = &cx->facets[cx->facet_count];
    memset(f, 0, sizeof *f);
    f->plane = plane;
    f->loop = cx->pool_count;
    f->loop_count = 3;
    f->child = f->labels = GXB_NONE;
    f->face = face;
    f->leaf[0] = cx->face_elements[2 * face];       /* the first leaf of an element has the element's number */
    f->leaf[1] = cx->face_elements[2 * face + 1];
    for (j = 0; j < 3; j++) {
        const uint32_t a = local[j], b = local[(j + 1) % 3];
        cx->pool[cx->pool_count++] = gxbp_open_edge(cx, cx->element_edges[6 * element + gxbp_local_edge(a, b)], node[a], node[b]);
    }
    gxbp_save(cx, GXBP_FACES, face);
    cx->face_facet[face] = cx->facet_count++;
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_open_element(gxb_complex *cx, uint32_t element) {
    uint32_t k, list;
    gx_result result;
    if (cx->leaves[element].facet_count > 0) return GX_OK;
    for (k = 0; k < 4; k++) {
        result = gxbp_open_face(cx, element, k);
        if (result != GX_OK) return result;
    }
    result = GXBP_RESERVE(cx, pool, pool, 4);
    if (result == GX_OK) result = gxbp_reserve_undo(cx, 1);
    if (result != GX_OK) return result;
    list = cx->pool_count;
    for (k = 0; k < 4; k++) cx->pool[cx->pool_count++] = cx->face_facet[cx->element_faces[4 * element + k]];
    gxbp_save(cx, GXBP_LEAVES, element);
    cx->leaves[element].facets = list;
    cx->leaves[element].facet_count = 4;
    return GX_OK;
}

/* >>clip: a triangle against the tree of an element ------------------------------------------------------------------------ */

static int gxbp_corner_sign(gxb_complex *cx, const gxbp_corner *c, uint32_t plane) {
    return gxbp_side_of(cx, &c->ball, c->kind, c->def, c->point, plane);
}

/* The point in which the edge that leaves corner c meets the plane. */
static void gxbp_clip_corner(gxb_complex *cx, const gxb_triangle *t, const gxbp_corner *c, uint32_t plane, gxbp_corner *r) {
    if (c->carrier >= GXBP_TRIANGLE_EDGE) {
        const uint32_t k = c->carrier - GXBP_TRIANGLE_EDGE;
        r->kind = GXB_LINE_PLANE;
        r->def[0] = t->point[k]; r->def[1] = t->point[(k + 1) % 3];
    } else {
        r->kind = GXB_THREE_PLANES;
        r->def[0] = t->plane; r->def[1] = c->carrier;
    }
    r->def[2] = plane;
    r->point = GXB_NONE;
    r->sign = 0;
    gxbp_definition_ball(cx, r->kind, r->def, &r->ball);
}

/* Appends to the corner stack what of corners first ... first+count-1 (signs known) lies on one side of the plane. Returns the number
   of corners, 0 where that part has no area. */
static uint32_t gxbp_clip(gxb_complex *cx, const gxb_triangle *t, uint32_t first, uint32_t count, uint32_t plane, int side) {
    const uint32_t start = cx->corner_count;
    uint32_t i;
    int inside = 0;
    for (i = 0; i < count; i++) {
        const gxbp_corner *c = &cx->corners[first + i], *next = &cx->corners[first + (i + 1) % count];
        const int s = c->sign * side, n = next->sign * side;
        gxbp_corner *r;
        if (s > 0) inside = 1;
        if (s >= 0) {
            r = &cx->corners[cx->corner_count++];
            *r = *c;
            if (s == 0 && n < 0) r->carrier = plane;
        }
        if (s * n < 0) {
            r = &cx->corners[cx->corner_count++];
            gxbp_clip_corner(cx, t, c, plane, r);
            r->carrier = s > 0 ? plane : c->carrier;
        }
    }
    if (!inside) cx->corner_count = start;
    return cx->corner_count - start;
}

/* Signs of the corners against the plane: bit 1 in front, bit 2 behind, 0 all in the plane. */
static int gxbp_corner_sides(gxb_complex *cx, uint32_t first, uint32_t count, uint32_t plane) {
    int sides = 0;
    uint32_t i;
    for (i = first; i < first + count; i++) {
        const int sign = gxbp_corner_sign(cx, &cx->corners[i], plane);
        cx->corners[i].sign = sign;
        sides |= sign > 0 ? 1 : sign < 0 ? 2 : 0;
    }
    return sides;
}

/* >>insert -------------------------------------------------------------------------------------------------------------- */

/* The plane through edge k of the triangle, along the axis that is closest to its normal: the triangle lies in front of it where
   *front is 1, behind it where it is -1. */
static gx_result gxbp_edge_plane(gxb_complex *cx, gxb_triangle *t, uint32_t k, int *front) {
    const uint32_t axis = cx->planes[t->plane].axis;
    gx_result result = GX_OK;
    if (t->edge_plane[k] == GXB_NONE)
        result = gxbp_new_plane(cx, t->point[k], t->point[(k + 1) % 3], axis, 1, &t->edge_plane[k]);
    if (result != GX_OK) return result;
    /* ((q - p) x e).(r - p) = -e.((q - p) x (r - p)): opposite to the sign of the triangle's normal along the axis */
    *front = -cx->planes[t->plane].axis_sign * t->orientation;
    return GX_OK;
}

/* Does the facet's normal point to the triangle's own front? They lie in one plane. */
static int32_t gxbp_relative_orientation(gxb_complex *cx, const gxb_triangle *t, uint32_t plane) {
    const gxb_cplane *f = &cx->planes[t->plane];
    const int own = f->axis_sign * t->orientation;
    return plane == t->plane ? t->orientation : own * gxbp_normal_sign(cx, plane, f->axis);
}

static gx_result gxbp_add_label(gxb_complex *cx, const gxb_triangle *t, uint32_t facet) {
    uint32_t l;
    gx_result result = GXBP_RESERVE(cx, labels, label, 1);
    for (l = cx->facets[facet].labels; l != GXB_NONE; l = cx->labels[l].next) if (cx->labels[l].triangle == t->label) return GX_OK;
    if (result == GX_OK) result = GXBP_RESERVE(cx, walls, wall, 1);
    if (result == GX_OK) result = gxbp_reserve_undo(cx, 1);
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->labels[cx->label_count].triangle = t->label;
    cx->labels[cx->label_count].orientation = gxbp_relative_orientation(cx, t, cx->facets[facet].plane);
    cx->labels[cx->label_count].next = cx->facets[facet].labels;
    cx->facets[facet].labels = cx->label_count++;
    if (t->wall) cx->facets[facet].wall = 1;
    cx->walls[cx->wall_count++] = facet;
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_set_wall(gxb_complex *cx, uint32_t facet) {
    gx_result result = GXBP_RESERVE(cx, walls, wall, 1);
    if (result == GX_OK) result = gxbp_reserve_undo(cx, 1);
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->facets[facet].wall = 1;
    cx->walls[cx->wall_count++] = facet;
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_set_removed(gxb_complex *cx, uint32_t leaf) {
    const gx_result result = gxbp_reserve_undo(cx, 1);
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_LEAVES, leaf);
    cx->leaves[leaf].removed = 1;
    return GX_OK;
}

/* The knife along edge k of the triangle, whose plane has been made. */
static void gxbp_set_knife(const gxb_triangle *t, uint32_t k, gxbp_knife *knife) {
    knife->plane = t->edge_plane[k];
    knife->line[0] = t->point[k]; knife->line[1] = t->point[(k + 1) % 3];
    knife->explicit_line = 1;
    knife->slot = 1;
}

/* Labels the part of a facet, in the triangle's plane, that the triangle covers; edges: bit k where edge k may bound that part. */
static gx_result gxbp_cover_facet(gxb_complex *cx, gxb_triangle *t, uint32_t facet, uint32_t edges) {
    uint32_t k, first, count;
    for (k = 0; k < 3; k++) {
        gxbp_knife knife;
        gx_result result;
        int front, sides;
        if (!(edges >> k & 1)) continue;
        result = gxbp_edge_plane(cx, t, k, &front);
        if (result == GX_OK) result = gxb_facet_edges(cx, facet, &first, &count);
        if (result == GX_OK) result = gxbp_reserve_split(cx, 1, count);
        if (result != GX_OK) return result;
        gxbp_set_knife(t, k, &knife);
        cx->stamp[1]++;
        sides = gxbp_facet_sides(cx, facet, &knife);
        if (sides == 3) {
            gxbp_split_facet(cx, facet, &knife);
            facet = cx->facets[facet].child + (front > 0 ? 0u : 1u);
        } else if (sides != (front > 0 ? 1 : 2)) return GX_OK;      /* outside of the triangle */
    }
    return gxbp_add_label(cx, t, facet);
}

/* --- pinched edges and nodes --- */

/* Divides the piece of an edge in the triangle's plane by the planes of the triangle's edges k, k+1 ... and marks what is inside. */
static gx_result gxbp_cover_edge(gxb_complex *cx, gxb_triangle *t, uint32_t edge, uint32_t k, int *covered) {
    gx_result result = gxbp_reserve_split(cx, 0, 1);
    for (; k < 3 && result == GX_OK; k++) {
        gxbp_knife knife;
        int front, a, b;
        result = gxbp_edge_plane(cx, t, k, &front);
        if (result != GX_OK) return result;
        gxbp_set_knife(t, k, &knife);
        a = front * gxb_complex_side(cx, cx->edges[edge].v[0], knife.plane);
        b = front * gxb_complex_side(cx, cx->edges[edge].v[1], knife.plane);
        if (a * b < 0) {
            gxbp_split_edge(cx, edge, &knife);
            return gxbp_cover_edge(cx, t, cx->edges[edge].child + (a > 0 ? 0u : 1u), k + 1, covered);
        }
        if (a < 0 || b < 0) return GX_OK;
    }
    if (result != GX_OK || cx->edges[edge].wall) return result;
    gxbp_save(cx, GXBP_EDGES, edge);
    cx->edges[edge].wall = 1;
    *covered = 1;
    return GX_OK;
}

static gx_result gxbp_cover_edges(gxb_complex *cx, gxb_triangle *t, uint32_t edge, int *covered) {
    const uint32_t child = cx->edges[edge].child;
    gx_result result;
    if (child == GXB_NONE) return gxbp_cover_edge(cx, t, edge, 0, covered);
    result = gxbp_cover_edges(cx, t, child, covered);
    return result == GX_OK ? gxbp_cover_edges(cx, t, child + 1, covered) : result;
}

GXFEM_API gx_result gxb_complex_cover_edge(gxb_complex *cx, gxb_triangle *t, uint32_t element, uint32_t local_edge, int *covered) {
    const uint32_t edge = cx->element_edges[6 * element + local_edge];
    const uint32_t a = cx->elements[4 * element + gxbp_edge_nodes[local_edge][0]], b = cx->elements[4 * element + gxbp_edge_nodes[local_edge][1]];
    gx_result result;
    if (gxb_complex_side(cx, a, t->plane) != 0 || gxb_complex_side(cx, b, t->plane) != 0) return GX_OK;
    result = gxb_complex_open_element(cx, element);
    return result == GX_OK ? gxbp_cover_edges(cx, t, cx->mesh_edge[edge], covered) : result;
}

GXFEM_API gx_result gxb_complex_cover_node(gxb_complex *cx, gxb_triangle *t, uint32_t node, int *covered) {
    uint32_t k;
    int front;
    gx_result result = gxbp_reserve_undo(cx, 1);
    if (cx->points[node].wall || gxb_complex_side(cx, node, t->plane) != 0) return result;
    for (k = 0; k < 3 && result == GX_OK; k++) {
        result = gxbp_edge_plane(cx, t, k, &front);
        if (result == GX_OK && gxb_complex_side(cx, node, t->edge_plane[k]) * front < 0) return GX_OK;
    }
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_POINTS, node);
    cx->points[node].wall = 1;
    *covered = 1;
    return GX_OK;
}

/* The triangle lies in the plane of some of the leaf's facets. */
static gx_result gxbp_cover_leaf(gxb_complex *cx, gxb_triangle *t, uint32_t leaf) {
    gxbp_knife knife;
    uint32_t first, count, i, j, edge_first, edge_count;
    gx_result result = gxb_leaf_facets(cx, leaf, &first, &count);
    memset(&knife, 0, sizeof knife);
    knife.plane = t->plane;
    for (i = 0; i < count && result == GX_OK; i++) {
        uint32_t facet = cx->pool[first + i];
        for (j = 0; j < cx->facets[facet].loop_count; j++) {
            if (gxbp_sign(cx, gxbp_edge_start(cx, cx->pool[cx->facets[facet].loop + j]), t->plane, 0) != 0) break;
        }
        if (j < cx->facets[facet].loop_count) continue;
        result = gxb_facet_edges(cx, facet, &edge_first, &edge_count);
        if (result == GX_OK) result = gxbp_cover_facet(cx, t, facet, 7);
    }
    return result;
}

/* --- balance: planes that come in order, as in parallel cuts, would make chains of nodes. A chain is a list of nodes, each with what hangs
   off it; where one node's plane has all that hangs off those above it on one side or the other, that node can stand above them,
   and nodes with nothing on a side are not needed there. No leaf changes. --- */

typedef struct gxbp_rung { uint32_t node, side, off; } gxbp_rung;   /* the chain goes on at child[side]; off: what hangs at the other one */
typedef struct gxbp_step { uint32_t node, child[2]; } gxbp_step;
typedef struct gxbp_plan { gxbp_step *step; uint32_t count; gxbp_rung *spare; } gxbp_plan;    /* what shall hang where, from below */

/* Is the tree far from what a balanced one of so many leaves has? Looked at eight times while it doubles. */
static int gxbp_is_slack(uint32_t height, uint32_t leaves) {
    uint32_t bits = 0;
    while (leaves >> bits > 1) bits++;
    return height > 2 * bits + 4 && (leaves & ((1u << bits >> 3) - 1)) == 0;
}

static uint32_t gxbp_depth(const gxb_complex *cx, uint32_t node) {
    uint32_t depth = 0;
    for (; node != GXB_NONE; node = cx->nodes[node].parent) depth++;
    return depth;
}

static uint32_t gxbp_leaves_below(const gxb_complex *cx, uint32_t reference) { return reference & 1 ? cx->nodes[reference >> 1].leaves : 1; }

/* On which sides of the plane (slot 1's, for its present stamp) the leaf has points: bit 1 in front, bit 2 behind. 3 also where memory
   fails. */
static int gxbp_leaf_sides(gxb_complex *cx, uint32_t leaf, uint32_t plane) {
    uint32_t first, count, i, j, e0, en;
    int sides = 0;
    if (gxb_leaf_facets(cx, leaf, &first, &count) != GX_OK) return 3;
    for (i = 0; i < count && sides != 3; i++) {
        if (gxb_facet_edges(cx, cx->pool[first + i], &e0, &en) != GX_OK) return 3;
        for (j = 0; j < en && sides != 3; j++) {
            const int sign = gxbp_sign(cx, gxbp_edge_start(cx, cx->pool[e0 + j]), plane, 1);
            sides |= sign > 0 ? 1 : sign < 0 ? 2 : 0;
        }
    }
    return sides;
}

static int gxbp_sides_below(gxb_complex *cx, uint32_t reference, uint32_t plane) {
    int sides;
    if (!(reference & 1)) return gxbp_leaf_sides(cx, reference >> 1, plane);
    sides = gxbp_sides_below(cx, cx->nodes[reference >> 1].child[0], plane);
    return sides == 3 ? 3 : sides | gxbp_sides_below(cx, cx->nodes[reference >> 1].child[1], plane);
}

static uint32_t gxbp_plan_node(gxbp_plan *plan, uint32_t node, uint32_t side, uint32_t on, uint32_t off) {
    plan->step[plan->count].node = node;
    plan->step[plan->count].child[side] = on;
    plan->step[plan->count++].child[1 - side] = off;
    return 2 * node + 1;
}

/* The chain as it is, above end */
static uint32_t gxbp_plan_chain(gxbp_plan *plan, const gxbp_rung *rung, uint32_t count, uint32_t end) {
    while (count-- > 0) end = gxbp_plan_node(plan, rung[count].node, rung[count].side, end, rung[count].off);
    return end;
}

/* Sorts what hangs above rung middle by its side of that plane: those on the chain's own side last. Their number is *own. 0: the plane
   passes through one of them. spare: middle rungs */
static int gxbp_part_chain(gxb_complex *cx, gxbp_rung *rung, uint32_t middle, gxbp_rung *spare, uint32_t *own) {
    const uint32_t plane = cx->nodes[rung[middle].node].plane, side = rung[middle].side;
    uint32_t i, n = 0;
    cx->stamp[1]++;
    *own = 0;
    for (i = 0; i < middle; i++) {
        const int sides = gxbp_sides_below(cx, rung[i].off, plane);
        if (sides == 3) return 0;
        if ((sides == 1) == (side == 0)) spare[(*own)++] = rung[i];
        else spare[middle - ++n] = rung[i];
    }
    for (i = 0; i < n; i++) rung[i] = spare[middle - 1 - i];
    memcpy(rung + n, spare, *own * sizeof *rung);
    return 1;
}

/* A balanced tree of the chain above end: the rung in the middle, by leaves, is made its root. */
static uint32_t gxbp_balance_chain(gxb_complex *cx, gxbp_plan *plan, gxbp_rung *rung, uint32_t count, uint32_t end) {
    uint32_t total = gxbp_leaves_below(cx, end), sum = 0, middle = 0, own, i, on, off;
    gxbp_rung root;
    if (count < 4) return gxbp_plan_chain(plan, rung, count, end);
    for (i = 0; i < count; i++) total += gxbp_leaves_below(cx, rung[i].off);
    for (; middle + 1 < count && 2 * sum < total; middle++) sum += gxbp_leaves_below(cx, rung[middle].off);
    if (!gxbp_part_chain(cx, rung, middle, plan->spare, &own)) return gxbp_plan_chain(plan, rung, count, end);
    root = rung[middle];
    memmove(rung + middle, rung + middle + 1, (count - middle - 1) * sizeof *rung);
    off = gxbp_balance_chain(cx, plan, rung, middle - own, root.off);
    on = gxbp_balance_chain(cx, plan, rung + middle - own, own + count - middle - 1, end);
    return gxbp_plan_node(plan, root.node, root.side, on, off);
}

/* Hangs everything where the plan says, from below, and the whole where top was. */
static gx_result gxbp_follow_plan(gxb_complex *cx, const gxbp_plan *plan, uint32_t tree, uint32_t top, uint32_t element) {
    const uint32_t above = cx->nodes[top].parent;
    uint32_t i, k;
    gx_result result = gxbp_reserve_undo(cx, 3 * (size_t)plan->count + 1);
    if (result != GX_OK) return result;
    for (i = 0; i < plan->count; i++) {
        gxb_node *n = &cx->nodes[plan->step[i].node];
        gxbp_save(cx, GXBP_NODES, plan->step[i].node);
        n->leaves = 0;
        for (k = 0; k < 2; k++) {
            const uint32_t child = n->child[k] = plan->step[i].child[k];
            n->leaves += gxbp_leaves_below(cx, child);
            if (child & 1) { gxbp_save(cx, GXBP_NODES, child >> 1); cx->nodes[child >> 1].parent = plan->step[i].node; }
        }
    }
    cx->nodes[tree >> 1].parent = above;    /* it has been saved */
    if (above == GXB_NONE) { gxbp_save(cx, GXBP_ROOTS, element); cx->root[element] = tree; return GX_OK; }
    gxbp_save(cx, GXBP_NODES, above);
    cx->nodes[above].child[cx->nodes[above].child[1] == 2 * top + 1] = tree;
    return GX_OK;
}

/* Balances the tree below top along the path to a node. */
static gx_result gxbp_balance(gxb_complex *cx, uint32_t top, uint32_t node, uint32_t element) {
    const uint32_t count = gxbp_depth(cx, node) - gxbp_depth(cx, cx->nodes[top].parent);
    const size_t size = count * (2 * sizeof(gxbp_rung) + sizeof(gxbp_step));
    gxbp_rung *rung = (gxbp_rung *)gxbp_allocate(&cx->allocator, size);
    gxbp_plan plan;
    uint32_t i, n, tree, below = cx->nodes[node].child[0];
    gx_result result;
    if (rung == NULL) return GX_ERROR_MEMORY;
    for (i = count, n = node; i-- > 0; n = cx->nodes[n].parent) {
        rung[i].node = n;
        rung[i].side = cx->nodes[n].child[1] == below;
        rung[i].off = cx->nodes[n].child[1 - rung[i].side];
        below = 2 * n + 1;
    }
    plan.spare = rung + count; plan.step = (gxbp_step *)(void *)(rung + 2 * (size_t)count); plan.count = 0;
    tree = gxbp_balance_chain(cx, &plan, rung, count, cx->nodes[node].child[0]);
    result = gxbp_follow_plan(cx, &plan, tree, top, element);
    gxbp_release(&cx->allocator, rung, size);
    return result;
}

/* A leaf has become a node with two. Balances the lowest tree around it that has become too high. */
static gx_result gxbp_grow_tree(gxb_complex *cx, uint32_t node, uint32_t element) {
    uint32_t n, height = 0, slack = GXB_NONE;
    gx_result result = gxbp_reserve_undo(cx, gxbp_depth(cx, node));
    for (n = node; n != GXB_NONE && result == GX_OK; n = cx->nodes[n].parent) {
        gxbp_save(cx, GXBP_NODES, n);
        cx->nodes[n].leaves++;
        if (slack == GXB_NONE && gxbp_is_slack(++height, cx->nodes[n].leaves)) slack = n;
    }
    return slack != GXB_NONE ? gxbp_balance(cx, slack, node, element) : result;
}

static uint32_t *gxbp_reference(gxb_complex *cx, const gxbp_task *task, uint32_t element) {
    return task->parent == GXBP_IN_ROOT ? &cx->root[element] : &cx->nodes[task->parent].child[task->side];
}

/* The triangle's part in the leaf is the polygon: divide the leaf and label what the triangle covers of the facet between. */
static gx_result gxbp_divide_leaf(gxb_complex *cx, gxb_triangle *t, uint32_t leaf, const gxbp_task *task) {
    gxbp_knife knife;
    uint32_t first, count, i, e0, en, edges = 0, middle, node;
    size_t total = 0;
    gx_result result = gxb_leaf_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        result = gxb_facet_edges(cx, cx->pool[first + i], &e0, &en);
        total += en;
    }
    if (result == GX_OK) result = gxbp_reserve_split(cx, count, total);
    if (result != GX_OK) return result;
    for (i = 0; i < task->count; i++) {
        const uint32_t carrier = cx->corners[task->first + i].carrier;
        if (carrier >= GXBP_TRIANGLE_EDGE) edges |= 1u << (carrier - GXBP_TRIANGLE_EDGE);
    }
    memset(&knife, 0, sizeof knife);
    knife.plane = t->plane;
    middle = gxbp_split_leaf(cx, leaf, &knife);
    node = cx->tree_count++;
    cx->nodes[node].plane = t->plane;
    cx->nodes[node].child[0] = 2 * leaf;
    cx->nodes[node].child[1] = 2 * (cx->leaf_count - 1);
    cx->nodes[node].parent = task->parent;
    cx->nodes[node].leaves = 1;
    if (task->parent == GXBP_IN_ROOT) gxbp_save(cx, GXBP_ROOTS, cx->leaves[leaf].element);
    else gxbp_save(cx, GXBP_NODES, task->parent);
    *gxbp_reference(cx, task, cx->leaves[leaf].element) = 2 * node + 1;
    result = gxbp_cover_facet(cx, t, middle, edges);
    return result == GX_OK ? gxbp_grow_tree(cx, node, cx->leaves[leaf].element) : result;
}

static void gxbp_push_task(gxb_complex *cx, uint32_t parent, uint32_t side, uint32_t first, uint32_t count, uint32_t coplanar) {
    gxbp_task *task = &cx->tasks[cx->task_count++];
    task->parent = parent; task->side = side; task->first = first; task->count = count; task->coplanar = coplanar;
}

/* Sends the polygon of the task down the tree by one node. */
static gx_result gxbp_descend(gxb_complex *cx, gxb_triangle *t, const gxbp_task *task, uint32_t node) {
    const uint32_t plane = cx->nodes[node].plane;
    gx_result result = GXBP_RESERVE(cx, corners, corner, 2 * (size_t)task->count + 8);
    int sides;
    if (result == GX_OK) result = GXBP_RESERVE(cx, tasks, task, 2);
    if (result != GX_OK) return result;
    sides = plane == t->plane ? 0 : gxbp_corner_sides(cx, task->first, task->count, plane);
    if (sides == 0 || sides == 1) gxbp_push_task(cx, node, 0, task->first, task->count, task->coplanar | (sides == 0));
    if (sides == 0 || sides == 2) gxbp_push_task(cx, node, 1, task->first, task->count, task->coplanar | (sides == 0));
    if (sides == 3) {
        uint32_t first = cx->corner_count, count = gxbp_clip(cx, t, task->first, task->count, plane, 1);
        if (count > 0) gxbp_push_task(cx, node, 0, first, count, task->coplanar);
        first = cx->corner_count;
        count = gxbp_clip(cx, t, task->first, task->count, plane, -1);
        if (count > 0) gxbp_push_task(cx, node, 1, first, count, task->coplanar);
    }
    return GX_OK;
}

/* Clips the triangle by the faces of the element. *count 0: nothing of it lies in the element. */
static gx_result gxbp_clip_to_element(gxb_complex *cx, gxb_triangle *t, uint32_t element, gxbp_task *task) {
    uint32_t k;
    gx_result result = GXBP_RESERVE(cx, corners, corner, 40);
    if (result != GX_OK) return result;
    cx->corner_count = cx->task_count = 0;
    for (k = 0; k < 3; k++) {
        gxbp_corner *c = &cx->corners[cx->corner_count++];
        memset(c, 0, sizeof *c);
        c->ball = cx->points[t->point[k]].ball;
        c->kind = GXB_EXPLICIT;
        c->point = t->point[k];
        c->carrier = GXBP_TRIANGLE_EDGE + k;
    }
    task->parent = GXBP_IN_ROOT; task->side = 0; task->first = 0; task->count = 3; task->coplanar = 0;
    for (k = 0; k < 4 && task->count > 0; k++) {
        const uint32_t face = cx->element_faces[4 * element + k];
        const int inside = cx->face_elements[2 * face] == element ? 1 : -1;
        uint32_t plane, first;
        int sides;
        result = gxbp_open_face(cx, element, k);
        if (result != GX_OK) return result;
        plane = cx->facets[cx->face_facet[face]].plane;
        sides = gxbp_corner_sides(cx, task->first, task->count, plane);
        if (sides == 0) task->coplanar = 1;
        if (sides == 0 || sides == (inside > 0 ? 1 : 2)) continue;
        first = cx->corner_count;
        task->count = gxbp_clip(cx, t, task->first, task->count, plane, inside);
        task->first = first;
    }
    return GX_OK;
}

/* Do all nodes of the element lie strictly on one side of the triangle's plane? */
static int gxbp_misses_plane(gxb_complex *cx, const gxb_triangle *t, uint32_t element) {
    int sides = 0, k;
    for (k = 0; k < 4; k++) {
        const int sign = gxbp_sign(cx, cx->elements[4 * element + (uint32_t)k], t->plane, 0);
        sides |= sign > 0 ? 1 : sign < 0 ? 2 : 3;
    }
    return sides != 3;
}

GXFEM_API gx_result gxb_complex_insert(gxb_complex *cx, gxb_triangle *t, uint32_t element,
                                       int (*allowed)(void *user, uint32_t leaf), void *user) {
    gxbp_task task;
    gx_result result;
    if (cx->sign_plane != t->plane) {
        cx->sign_plane = t->plane;
        cx->stamp[0]++;
    }
    if (gxbp_misses_plane(cx, t, element)) return GX_OK;
    result = gxbp_clip_to_element(cx, t, element, &task);
    if (result != GX_OK || task.count == 0) return result;
    result = gxb_complex_open_element(cx, element);
    if (result == GX_OK) result = GXBP_RESERVE(cx, tasks, task, 1);
    if (result != GX_OK) return result;
    cx->tasks[cx->task_count++] = task;
    while (cx->task_count > 0 && result == GX_OK) {
        uint32_t reference;
        task = cx->tasks[--cx->task_count];
        reference = *gxbp_reference(cx, &task, element);
        if (reference & 1) result = gxbp_descend(cx, t, &task, reference >> 1);
        else if (cx->leaves[reference >> 1].removed || (allowed != NULL && !allowed(user, reference >> 1))) continue;
        else if (task.coplanar) result = gxbp_cover_leaf(cx, t, reference >> 1);
        else result = gxbp_divide_leaf(cx, t, reference >> 1, &task);
    }
    return result;
}

/* --- winding number around a point that is not a double --- */

/* A point in the given coordinates times 2^shift: homogeneous, and roughly. */
typedef struct gxbp_probe { gxbp_vec exact; double rough[3]; int shift; } gxbp_probe;

static void gxbp_probe_init(gxb_complex *cx, const uint32_t *points, size_t count, gxbp_probe *probe) {
    size_t i;
    int k;
    gxbp_vec_init(&probe->exact);
    probe->shift = cx->shift;
    for (i = 0; i < count; i++) {
        gxbp_vec store;
        const gxb_num *x = gxbp_exact_cpoint(cx, points[i], &store);
        for (k = 0; k < 4; k++) {
            GXB_NUM(sum);
            gxb_num_add(&sum, &probe->exact.c[k], &x[k]);
            gxbp_num_copy(&probe->exact.c[k], &sum, 1);
        }
    }
    for (k = 0; k < 3; k++) {
        GXB_NUM(origin); GXB_NUM(t); GXB_NUM(sum);
        gxb_num_set(&origin, cx->origin[k], cx->shift);
        gxb_num_mul(&t, &origin, &probe->exact.c[3]);
        gxb_num_add(&sum, &probe->exact.c[k], &t);
        gxbp_num_copy(&probe->exact.c[k], &sum, 1);
        probe->rough[k] = gxb_num_ratio(&probe->exact.c[k], &probe->exact.c[3]);
    }
}

/* Is the probe certainly beyond the triangle's box along y or z, or past it along x? The margin is far above the rounding. */
static int gxbp_probe_misses(const gxbp_probe *probe, const double *const x[3]) {
    int k, c;
    for (k = 0; k < 3; k++) {
        int below = 1, above = k > 0;
        for (c = 0; c < 3; c++) {
            GXB_NUM(n);
            double v, margin;
            gxb_num_set(&n, x[c][k], probe->shift);
            v = gxb_num_to_double(&n);
            margin = 1e-12 * (gxbp_abs(v) + gxbp_abs(probe->rough[k])) + GXBP_TINY;
            if (v > probe->rough[k] - margin) below = 0;
            if (v < probe->rough[k] + margin) above = 0;
        }
        if (below || above) return 1;
    }
    return 0;
}

/* gxbp_ray_side for a probe: W (a_y b_z - a_z b_y) + Y (a_z - b_z) + Z (b_y - a_y) */
static int gxbp_probe_side(const gxbp_probe *probe, const double a[3], const double b[3]) {
    gxbp_vec p, q, row;
    GXB_NUM(r);
    int k, sign;
    gxbp_vec_init(&p); gxbp_vec_init(&q); gxbp_vec_init(&row);
    for (k = 1; k < 3; k++) {
        gxb_num_set(&p.c[k], a[k], probe->shift);
        gxb_num_set(&q.c[k], b[k], probe->shift);
    }
    gxbp_num_det2(&row.c[2], &p.c[1], &q.c[2], &p.c[2], &q.c[1]);
    gxb_num_sub(&row.c[0], &p.c[2], &q.c[2]);
    gxb_num_sub(&row.c[1], &q.c[1], &p.c[1]);
    gxbp_num_dot(&r, row.c, probe->exact.c + 1);
    if (r.sign != 0) return r.sign;
    sign = gxbp_compare_doubles(a[2], b[2]);
    return sign != 0 ? sign : gxbp_compare_doubles(b[1], a[1]);
}

/* gxb_orient3d(a, b, c, probe) */
static int gxbp_probe_orient(const gxbp_probe *probe, const double *const x[3]) {
    gxbp_vec p[3], n;
    GXB_NUM(r);
    int k, c;
    for (c = 0; c < 3; c++) {
        gxbp_vec_init(&p[c]);
        for (k = 0; k < 3; k++) gxb_num_set(&p[c].c[k], x[c][k], probe->shift);
    }
    gxbp_vec_init(&n);
    gxbp_exact_plane(n.c, p[0].c, p[1].c, p[2].c);
    gxbp_exact_side(&r, probe->exact.c, n.c);
    return -r.sign;
}

GXFEM_API int gxb_complex_winding(gxb_complex *cx, const uint32_t *points, size_t point_count, const double *vertices,
                                  const uint32_t *triangles, size_t triangle_count) {
    gxbp_probe probe;
    int winding = 0, c;
    size_t t;
    gxbp_probe_init(cx, points, point_count, &probe);
    for (t = 0; t < triangle_count; t++) {
        const double *x[3];
        int side;
        for (c = 0; c < 3; c++) x[c] = vertices + 3 * (size_t)triangles[3 * t + (size_t)c];
        if (gxbp_probe_misses(&probe, x)) continue;
        side = gxbp_probe_side(&probe, x[0], x[1]);
        if (side == 0 || gxbp_probe_side(&probe, x[1], x[2]) != side || gxbp_probe_side(&probe, x[2], x[0]) != side) continue;
        if (gxbp_probe_orient(&probe, x) == side) winding += side;
    }
    return winding;
}

/* --- barycentric coordinates --- */

/* Exact distance of a point from a plane, times |n| and the point's weight W, which goes to *weight (may be NULL). */
static void gxbp_distance(gxb_complex *cx, uint32_t point, uint32_t plane, gxb_num *distance, gxb_num *weight) {
    gxbp_vec sn, sx;
    const gxb_num *n = gxbp_exact_cplane(cx, plane, &sn), *x = gxbp_exact_cpoint(cx, point, &sx);
    gxbp_exact_side(distance, x, n);
    if (weight != NULL) gxbp_num_copy(weight, &x[3], 1);
}

static uint32_t gxbp_face_plane(const gxb_complex *cx, uint32_t element, uint32_t k) {
    return cx->facets[cx->face_facet[cx->element_faces[4 * element + k]]].plane;
}

/* Distances of the element's nodes from their opposite faces, times |n|: kept for the element last asked for. */
static const double *gxbp_heights(gxb_complex *cx, uint32_t element) {
    uint32_t k;
    if (cx->height_element == element) return cx->height;
    for (k = 0; k < 4; k++) {
        GXB_NUM(d);
        gxbp_distance(cx, cx->elements[4 * element + k], gxbp_face_plane(cx, element, k), &d, NULL);
        cx->height[k] = gxb_num_to_double(&d);
    }
    cx->height_element = element;
    return cx->height;
}

/* Where on the mesh edge from node def[0] to node def[1] the point lies: 0 ... 1. Asked for by every element around the edge, so kept. */
static double gxbp_edge_parameter(gxb_complex *cx, uint32_t point, int from_end) {
    gxb_cpoint *p = &cx->points[point];
    if (p->parameter[0] < 0) {
        GXB_NUM(a); GXB_NUM(b); GXB_NUM(d);
        gxbp_distance(cx, p->def[0], p->def[2], &a, NULL);
        gxbp_distance(cx, p->def[1], p->def[2], &b, NULL);
        gxb_num_sub(&d, &b, &a);
        p->parameter[0] = gxb_num_ratio(&b, &d);                /* the share of def[0] */
        p->parameter[1] = -gxb_num_ratio(&a, &d);
    }
    return p->parameter[from_end];
}

/* What is known of lambda[k] without arithmetic: 1 or 0 at nodes, 0 on a face by definition; -1: nothing. */
static int gxbp_known_lambda(const gxb_complex *cx, uint32_t point, uint32_t element, uint32_t k) {
    const gxb_cpoint *p = &cx->points[point];
    const uint32_t face = cx->element_faces[4 * element + k];
    if (point < cx->node_count) return point == cx->elements[4 * element + k];
    return gxbp_incident(cx, p->kind, p->def, point, cx->facets[cx->face_facet[face]].plane) ? 0 : -1;
}

/* Of the coordinates that are not known, the one that seems largest: 1 minus the others gives it to rounding. 4: can't tell. */
static uint32_t gxbp_largest_lambda(const gxb_complex *cx, uint32_t point, uint32_t element, const double height[4], const double lambda[4]) {
    uint32_t k, largest = 4;
    double most = 0, bound;
    for (k = 0; k < 4 && cx->points[point].ball.error < GXBP_NO_BALL; k++) {
        const double value = gxbp_filter_side(&cx->points[point].ball, &cx->planes[gxbp_face_plane(cx, element, k)].filter, &bound) / height[k];
        if (lambda[k] >= 0 || value < most || gxbp_abs(bound / height[k]) > 0.01) continue;
        largest = k;
        most = value;
    }
    return most > 0.2 ? largest : 4;
}

static int gxbp_has_node(const gxb_complex *cx, uint32_t element, uint32_t node) {
    const uint32_t *n = cx->elements + 4 * (size_t)element;
    return n[0] == node || n[1] == node || n[2] == node || n[3] == node;
}

/* Does the point divide an edge of the element? */
static int gxbp_divides_edge(const gxb_complex *cx, uint32_t point, uint32_t element) {
    const gxb_cpoint *p = &cx->points[point];
    return p->kind == GXB_LINE_PLANE && gxbp_has_node(cx, element, p->def[0]) && gxbp_has_node(cx, element, p->def[1]);
}

GXFEM_API unsigned gxb_complex_support(const gxb_complex *cx, uint32_t point, uint32_t element) {
    const gxb_cpoint *p = &cx->points[point];
    const int on_edge = gxbp_divides_edge(cx, point, element);
    unsigned support = 0;
    uint32_t k;
    for (k = 0; k < 4; k++) {
        const uint32_t node = cx->elements[4 * element + k];
        if (on_edge ? node == p->def[0] || node == p->def[1] : gxbp_known_lambda(cx, point, element, k) != 0) support |= 1u << k;
    }
    return support;
}

GXFEM_API void gxb_complex_barycentric(gxb_complex *cx, uint32_t point, uint32_t element, double lambda[4]) {
    const gxb_cpoint *p = &cx->points[point];
    const int on_edge = gxbp_divides_edge(cx, point, element);
    const double *height = point < cx->node_count || on_edge ? NULL : gxbp_heights(cx, element);
    uint32_t k, largest = 4;
    double rest = 1;
    for (k = 0; k < 4; k++) lambda[k] = gxbp_known_lambda(cx, point, element, k);
    if (height != NULL) largest = gxbp_largest_lambda(cx, point, element, height, lambda);
    for (k = 0; k < 4; k++) {
        const uint32_t node = cx->elements[4 * element + k];
        if (lambda[k] >= 0 || k == largest) continue;
        if (on_edge) {
            lambda[k] = node == p->def[0] ? gxbp_edge_parameter(cx, point, 0) : node == p->def[1] ? gxbp_edge_parameter(cx, point, 1) : 0;
        } else {
            GXB_NUM(d); GXB_NUM(w);
            gxbp_distance(cx, point, gxbp_face_plane(cx, element, k), &d, &w);
            lambda[k] = gxb_num_ratio(&d, &w) / height[k];
        }
        rest -= lambda[k];
    }
    if (largest < 4) lambda[largest] = rest;
}

/* Each step adds the quotient of what is left: 50 bits, so that four leave less than 2^-180 of the value. */
GXFEM_API void gxb_complex_barycentric_fine(gxb_complex *cx, uint32_t point, uint32_t element, gxb_num lambda[4]) {
    uint32_t k;
    int step;
    for (k = 0; k < 4; k++) {
        const int known = gxbp_known_lambda(cx, point, element, k);
        GXB_NUM(num); GXB_NUM(den); GXB_NUM(q); GXB_NUM(t); GXB_NUM(s);
        gxb_num_set(&lambda[k], known > 0 ? 1.0 : 0.0, 0);
        if (known >= 0) continue;
        gxbp_distance(cx, point, gxbp_face_plane(cx, element, k), &num, &q);
        gxbp_distance(cx, cx->elements[4 * element + k], gxbp_face_plane(cx, element, k), &t, NULL);
        gxb_num_mul(&den, &q, &t);
        for (step = 0; step < 4 && num.sign != 0; step++) {
            gxb_num_set(&q, gxb_num_ratio(&num, &den), 0);
            gxb_num_add(&s, &lambda[k], &q);
            gxbp_num_copy(&lambda[k], &s, 1);
            gxb_num_mul(&t, &q, &den);
            gxb_num_sub(&s, &num, &t);
            gxbp_num_copy(&num, &s, 1);
        }
    }
}

/* >>save: points by their definitions, the rest by indices ------------------------------------------------------------------ */

GXFEM_API int gxb_stream_has(gxb_stream *stream, size_t count, size_t width) {
    if (stream->result == GX_OK && count > (stream->size - stream->at) / width) stream->result = GX_ERROR_DAMAGED;
    return stream->result == GX_OK;
}

GXFEM_API void gxb_stream_pass(gxb_stream *stream, void *data, size_t count, size_t width) {
    const size_t bytes = count * width;
    if (stream->in != NULL && !gxb_stream_has(stream, count, width)) {
        if (bytes > 0) memset(data, 0, bytes);
        return;
    }
    if (stream->in == NULL && stream->out != NULL && bytes > stream->size - stream->at) stream->result = GX_ERROR_LIMIT;
    if (stream->result != GX_OK || bytes == 0) return;
    if (stream->in != NULL) memcpy(data, stream->in + stream->at, bytes);
    else if (stream->out != NULL) memcpy(stream->out + stream->at, data, bytes);
    stream->at += bytes;
}

static void gxbp_pass_word(gxb_stream *s, uint32_t *word) { gxb_stream_pass(s, word, 1, sizeof *word); }

static void gxbp_require(gxb_stream *s, gx_result result) { if (s->result == GX_OK) s->result = result; }
static void gxbp_require_true(gxb_stream *s, int holds) { if (!holds) gxbp_require(s, GX_ERROR_DAMAGED); }

/* The given coordinates of an explicit point: what came into the frame by a shift and a scale, exactly, goes back. */
static void gxbp_given(gxb_complex *cx, uint32_t point, double x[3]) {
    gxbp_vec store;
    const gxb_num *c = gxbp_exact_cpoint(cx, point, &store);
    int k;
    for (k = 0; k < 3; k++) {
        GXB_NUM(scale); GXB_NUM(given); GXB_NUM(origin); GXB_NUM(sum);
        uint64_t m;
        int power;
        gxb_num_set(&scale, 1.0, -cx->shift);
        gxb_num_mul(&given, &c[k], &scale);
        gxb_num_set(&origin, cx->origin[k], 0);
        gxb_num_add(&sum, &given, &origin);
        x[k] = 0;
        if (sum.sign == 0) continue;
        m = gxbp_num_mantissa(&sum, &power);
        if (power >= -1074) x[k] = gxbp_compose(m, power, sum.sign < 0);
        else x[k] = gxbp_double((m >> (-1074 - power)) | (sum.sign < 0 ? (uint64_t)1 << 63 : 0));    /* a denormal: no bit is lost */
    }
}

static void gxbp_save_points(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->point_count; i++) {
        gxb_cpoint *p = &cx->points[i];
        uint32_t head = p->kind | p->wall << 2;
        double x[3];
        gxbp_pass_word(s, &head);
        if (i < cx->node_count) continue;
        if (p->kind != GXB_EXPLICIT) { gxb_stream_pass(s, p->def, 3, sizeof *p->def); continue; }
        if (s->out != NULL) gxbp_given(cx, i, x);
        gxb_stream_pass(s, x, 3, sizeof *x);
    }
}

/* Points by definition have no ball yet: it needs the planes. */
static void gxbp_load_points(gxb_complex *cx, gxb_stream *s, uint32_t count) {
    uint32_t i;
    for (i = 0; i < count && s->result == GX_OK; i++) {
        uint32_t head, id = i, def[3];
        double x[3];
        gxbp_pass_word(s, &head);
        gxbp_require_true(s, head < 8 && (head & 3) <= (i < cx->node_count ? 0u : 2u));
        if (i < cx->node_count) { cx->points[i].wall = head >> 2; continue; }
        if ((head & 3) == GXB_EXPLICIT) gxb_stream_pass(s, x, 3, sizeof *x);
        else gxb_stream_pass(s, def, 3, sizeof *def);
        if (s->result != GX_OK) return;
        if ((head & 3) == GXB_EXPLICIT) {
            const gx_result result = gxb_complex_add_point(cx, x, &id);
            if (result != GX_OK) gxbp_require(s, result == GX_ERROR_MEMORY || result == GX_ERROR_LIMIT ? result : GX_ERROR_DAMAGED);
        } else {
            gxbp_require(s, gxbp_new_point(cx, &id));
            if (s->result == GX_OK) memcpy(cx->points[id].def, def, sizeof def);
        }
        if (s->result != GX_OK) return;
        cx->points[id].kind = head & 3;
        cx->points[id].wall = head >> 2;
    }
}

static int gxbp_is_explicit(const gxb_complex *cx, uint32_t point) { return point < cx->point_count && cx->points[point].kind == GXB_EXPLICIT; }

static void gxbp_save_planes(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->plane_count; i++) {
        gxb_stream_pass(s, cx->planes[i].def, 3, sizeof *cx->planes[i].def);
        gxbp_pass_word(s, &cx->planes[i].along_axis);
    }
}

/* Planes must have a normal. */
static void gxbp_load_planes(gxb_complex *cx, gxb_stream *s, uint32_t count) {
    uint32_t i, k;
    for (i = 0; i < count && s->result == GX_OK; i++) {
        uint32_t def[3], along_axis, id = 0;
        int normal = 0;
        gxb_stream_pass(s, def, 3, sizeof *def);
        gxbp_pass_word(s, &along_axis);
        gxbp_require_true(s, along_axis <= 1 && gxbp_is_explicit(cx, def[0]) && gxbp_is_explicit(cx, def[1]) &&
                             (along_axis ? def[2] < 3 : gxbp_is_explicit(cx, def[2])));
        if (s->result == GX_OK) gxbp_require(s, gxbp_new_plane(cx, def[0], def[1], def[2], (int)along_axis, &id));
        if (s->result != GX_OK) return;
        if (along_axis) for (k = 0; k < 3 && !normal; k++) normal = gxbp_normal_sign(cx, id, k) != 0;
        else normal = gxbp_plane_axis(cx, id);
        gxbp_require_true(s, normal);
    }
}

/* Points by definition must be points: a filter that is certain of their place proves it, else their exact weight. */
static void gxbp_place_points(gxb_complex *cx, gxb_stream *s) {
    uint32_t i, k;
    for (i = cx->node_count; i < cx->point_count && s->result == GX_OK; i++) {
        gxb_cpoint *p = &cx->points[i];
        if (p->kind == GXB_EXPLICIT) continue;
        for (k = 0; k < 3; k++)
            gxbp_require_true(s, k < 2 && p->kind == GXB_LINE_PLANE ? gxbp_is_explicit(cx, p->def[k]) : p->def[k] < cx->plane_count);
        if (s->result != GX_OK) return;
        gxbp_definition_ball(cx, p->kind, p->def, &p->ball);
        if (p->ball.error >= GXBP_NO_BALL) {
            gxbp_vec store;
            gxbp_require_true(s, gxbp_exact_cpoint(cx, i, &store)[3].sign != 0);
        }
    }
}

/* A list of the pool; reading appends it. */
static void gxbp_pass_list(gxb_complex *cx, gxb_stream *s, uint32_t *first, uint32_t *count) {
    gxbp_pass_word(s, count);
    if (s->in != NULL) {
        if (!gxb_stream_has(s, *count, sizeof *cx->pool)) { *count = 0; return; }
        gxbp_require(s, GXBP_RESERVE(cx, pool, pool, *count));
        if (s->result != GX_OK) { *count = 0; return; }
        *first = cx->pool_count;
        cx->pool_count += *count;
    }
    if (*count > 0) gxb_stream_pass(s, cx->pool + *first, *count, sizeof *cx->pool);
}

static void gxbp_pass_edges(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->edge_count; i++) {
        gxb_edge *e = &cx->edges[i];
        gxb_stream_pass(s, e->v, 2, sizeof *e->v);
        gxb_stream_pass(s, e->line, 2, sizeof *e->line);
        gxbp_pass_word(s, &e->explicit_line);
        gxbp_pass_word(s, &e->child);
        gxbp_pass_word(s, &e->wall);
    }
}

static void gxbp_pass_facets(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->facet_count; i++) {
        gxb_facet *f = &cx->facets[i];
        uint32_t none = 0;
        gxbp_pass_word(s, &f->plane);
        gxb_stream_pass(s, f->leaf, 2, sizeof *f->leaf);
        gxbp_pass_word(s, &f->child);
        gxbp_pass_word(s, &f->labels);
        gxbp_pass_word(s, &f->face);
        gxbp_pass_word(s, &f->wall);
        gxbp_pass_list(cx, s, &f->loop, f->child == GXB_NONE ? &f->loop_count : &none);    /* children have loops of their own */
    }
}

static void gxbp_pass_leaves(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->leaf_count; i++) {
        gxb_leaf *l = &cx->leaves[i];
        gxbp_pass_word(s, &l->element);
        gxbp_pass_word(s, &l->parent);
        gxbp_pass_word(s, &l->removed);
        gxbp_pass_list(cx, s, &l->facets, &l->facet_count);
    }
}

static void gxbp_pass_rest(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    gxb_stream_pass(s, cx->face_facet, cx->face_count, sizeof *cx->face_facet);
    gxb_stream_pass(s, cx->mesh_edge, cx->mesh_edge_count, sizeof *cx->mesh_edge);
    gxb_stream_pass(s, cx->root, cx->element_count, sizeof *cx->root);
    for (i = 0; i < cx->tree_count; i++) {
        gxbp_pass_word(s, &cx->nodes[i].plane);
        gxb_stream_pass(s, cx->nodes[i].child, 2, sizeof *cx->nodes[i].child);
    }
    for (i = 0; i < cx->label_count; i++) {
        gxbp_pass_word(s, &cx->labels[i].triangle);
        gxb_stream_pass(s, &cx->labels[i].orientation, 1, sizeof cx->labels[i].orientation);
        gxbp_pass_word(s, &cx->labels[i].next);
    }
}

enum { GXBP_COUNTS = 7 };

GXFEM_API void gxb_complex_save(gxb_complex *cx, gxb_stream *stream) {
    uint32_t counts[GXBP_COUNTS];
    counts[0] = cx->point_count; counts[1] = cx->plane_count; counts[2] = cx->edge_count; counts[3] = cx->facet_count;
    counts[4] = cx->leaf_count; counts[5] = cx->tree_count; counts[6] = cx->label_count;
    gxb_stream_pass(stream, counts, GXBP_COUNTS, sizeof *counts);
    gxbp_save_points(cx, stream);
    gxbp_save_planes(cx, stream);
    gxbp_pass_edges(cx, stream);
    gxbp_pass_facets(cx, stream);
    gxbp_pass_leaves(cx, stream);
    gxbp_pass_rest(cx, stream);
}

/* Items of 4 bytes at least each; all of them zero until they are read. */
static void gxbp_load_room(gxb_stream *s, gxb_complex *cx, const uint32_t counts[GXBP_COUNTS]) {
    static const size_t least[GXBP_COUNTS] = {4, 16, 28, 32, 16, 12, 12};
    int i;
    for (i = 0; i < GXBP_COUNTS; i++) {
        gxb_stream_has(s, counts[i], least[i]);
        gxbp_require_true(s, counts[i] <= INT32_MAX);
    }
    gxbp_require_true(s, counts[0] >= cx->node_count && counts[4] >= cx->element_count);
    if (s->result != GX_OK) return;
    gxbp_require(s, GXBP_RESERVE(cx, edges, edge, counts[2]));
    gxbp_require(s, GXBP_RESERVE(cx, facets, facet, counts[3]));
    gxbp_require(s, GXBP_RESERVE(cx, leaves, leaf, counts[4] - cx->leaf_count));
    gxbp_require(s, GXBP_RESERVE(cx, nodes, tree, counts[5]));
    gxbp_require(s, GXBP_RESERVE(cx, labels, label, counts[6]));
    if (s->result != GX_OK) return;
    cx->edge_count = counts[2]; cx->facet_count = counts[3]; cx->leaf_count = counts[4]; cx->tree_count = counts[5]; cx->label_count = counts[6];
    if (counts[2] > 0) memset(cx->edges, 0, counts[2] * sizeof *cx->edges);
    if (counts[3] > 0) memset(cx->facets, 0, counts[3] * sizeof *cx->facets);
    memset(cx->leaves, 0, counts[4] * sizeof *cx->leaves);
}

static void gxbp_check(gxb_complex *cx, gxb_stream *s);     /* see >>check */

/* Parents of nodes and numbers of leaves, which are not saved */
static void gxbp_link_trees(gxb_complex *cx) {
    uint32_t i, k, n;
    for (i = 0; i < cx->tree_count; i++) { cx->nodes[i].parent = GXB_NONE; cx->nodes[i].leaves = 0; }
    for (i = 0; i < cx->tree_count; i++) for (k = 0; k < 2; k++)
        if (cx->nodes[i].child[k] & 1) cx->nodes[cx->nodes[i].child[k] >> 1].parent = i;
    for (i = 0; i < cx->tree_count; i++) for (k = 0; k < 2; k++)
        for (n = cx->nodes[i].child[k] & 1 ? GXB_NONE : i; n != GXB_NONE; n = cx->nodes[n].parent) cx->nodes[n].leaves++;
}

GXFEM_API gx_result gxb_complex_load(gxb_complex *cx, gxb_stream *s, int trusted) {
    uint32_t counts[GXBP_COUNTS];
    gxb_stream_pass(s, counts, GXBP_COUNTS, sizeof *counts);
    gxbp_load_room(s, cx, counts);
    if (s->result == GX_OK) gxbp_load_points(cx, s, counts[0]);
    if (s->result == GX_OK) gxbp_load_planes(cx, s, counts[1]);
    if (s->result == GX_OK) gxbp_place_points(cx, s);
    if (s->result == GX_OK) gxbp_pass_edges(cx, s);
    if (s->result == GX_OK) gxbp_pass_facets(cx, s);
    if (s->result == GX_OK) gxbp_pass_leaves(cx, s);
    if (s->result == GX_OK) gxbp_pass_rest(cx, s);
    if (s->result == GX_OK && !trusted) gxbp_check(cx, s);
    if (s->result != GX_OK) return s->result;
    gxbp_link_trees(cx);
    cx->pool_live = cx->pool_count;
    gxb_complex_begin(cx);
    return GX_OK;
}

/* >>check: is what was read a complex? ---------------------------------------------------------------------------------------
 *
 * First every index, then that trees are trees, then geometry, by the exact predicates: each facet is a convex polygon in its
 * plane; each leaf is closed and lies on one side of its facets' planes, which are those of its element's faces and of the nodes
 * above it in the tree. So each leaf is all of its part of the tree, and a triangle that the tree sends to a leaf divides it.
 */

#define GXBP_DEPTH 10000    /* of a tree of edges, facets or leaves: functions that walk them call themselves */

/* Trees of items that were divided into (child, child + 1): each child comes behind its one parent. child: of item i at
   first + i * size. depth: count. */
static void gxbp_check_trees(gxb_stream *s, const uint32_t *first, size_t size, uint32_t count, uint32_t *depth) {
    uint32_t i, child;
    if (count > 0) memset(depth, 0, count * sizeof *depth);
    for (i = 0; i < count && s->result == GX_OK; i++) {
        memcpy(&child, (const unsigned char *)first + i * size, sizeof child);
        if (child == GXB_NONE) continue;
        gxbp_require_true(s, child > i && child < count - 1 && depth[child] == 0 && depth[child + 1] == 0);
        if (s->result != GX_OK) return;
        depth[child] = depth[child + 1] = depth[i] + 1;
        if (depth[child] > GXBP_DEPTH) gxbp_require(s, GX_ERROR_LIMIT);
    }
}

static int gxbp_below(uint32_t index, uint32_t count) { return index == GXB_NONE || index < count; }

static void gxbp_check_indices(gxb_complex *cx, gxb_stream *s) {
    uint32_t i, j;
    int good = 1;
    for (i = 0; i < cx->edge_count; i++) {
        const gxb_edge *e = &cx->edges[i];
        good &= e->explicit_line <= 1 && e->wall <= 1 && e->v[0] < cx->point_count && e->v[1] < cx->point_count && e->v[0] != e->v[1];
        for (j = 0; j < 2; j++) good &= e->explicit_line == 1 ? gxbp_is_explicit(cx, e->line[j]) : e->line[j] < cx->plane_count;
    }
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        good &= f->plane < cx->plane_count && !cx->planes[f->plane < cx->plane_count ? f->plane : 0].along_axis && f->wall <= 1 &&
                gxbp_below(f->leaf[0], cx->leaf_count) && gxbp_below(f->leaf[1], cx->leaf_count) && f->leaf[0] != f->leaf[1] &&
                gxbp_below(f->labels, cx->label_count) && gxbp_below(f->face, cx->face_count);
        for (j = 0; j < f->loop_count; j++) good &= cx->pool[f->loop + j] >> 1 < cx->edge_count;
    }
    for (i = 0; i < cx->leaf_count; i++) {
        const gxb_leaf *l = &cx->leaves[i];
        good &= l->element < cx->element_count && l->removed <= 1;
        good &= i < cx->element_count ? l->element == i && l->parent == GXB_NONE : l->parent < i && cx->leaves[l->parent].element == l->element && l->facet_count > 0;
        for (j = 0; j < l->facet_count; j++) good &= cx->pool[l->facets + j] < cx->facet_count;
        if (!good) break;
    }
    for (i = 0; i < cx->label_count; i++)     /* lists share their ends, which are older */
        good &= (cx->labels[i].next == GXB_NONE || cx->labels[i].next < i) && cx->labels[i].orientation >= -1 && cx->labels[i].orientation <= 1;
    for (i = 0; i < cx->face_count; i++) good &= gxbp_below(cx->face_facet[i], cx->facet_count);
    for (i = 0; i < cx->mesh_edge_count; i++) good &= gxbp_below(cx->mesh_edge[i], cx->edge_count);
    gxbp_require_true(s, good);
}

/* --- edges: on their lines, divided between their ends --- */

static int gxbp_same_place(gxb_complex *cx, uint32_t a, uint32_t b) {
    gxbp_vec sa, sb;
    const gxb_num *p = gxbp_exact_cpoint(cx, a, &sa), *q = gxbp_exact_cpoint(cx, b, &sb);
    int k;
    for (k = 0; k < 3; k++) {
        GXB_NUM(d);
        gxbp_num_det2(&d, &p[k], &q[3], &q[k], &p[3]);
        if (d.sign != 0) return 0;
    }
    return 1;
}

/* Do the planes meet in a line? */
static int gxbp_planes_cross(gxb_complex *cx, uint32_t a, uint32_t b) {
    const gxb_plane_filter *f = &cx->planes[a].filter, *g = &cx->planes[b].filter;
    double r[3];
    const double bound = gxbp_filter_cross(r, f->n, f->error, g->n, g->error);
    gxbp_vec sa, sb, cross;
    if (gxbp_max3(r) > bound) return 1;
    gxbp_vec_init(&cross);
    gxbp_num_cross(cross.c, gxbp_exact_cplane(cx, a, &sa), gxbp_exact_cplane(cx, b, &sb));
    return cross.c[0].sign != 0 || cross.c[1].sign != 0 || cross.c[2].sign != 0;
}

static int gxbp_collinear(gxb_complex *cx, uint32_t a, uint32_t b, uint32_t c) {
    gxbp_vec sa, sb, sc;
    const gxb_num *p = gxbp_exact_cpoint(cx, a, &sa), *q = gxbp_exact_cpoint(cx, b, &sb), *r = gxbp_exact_cpoint(cx, c, &sc);
    return gxbp_orient_exact(p, q, r, 0, 1) == 0 && gxbp_orient_exact(p, q, r, 1, 2) == 0 && gxbp_orient_exact(p, q, r, 2, 0) == 0;
}

static int gxbp_on_line(gxb_complex *cx, uint32_t point, const gxb_edge *e) {
    const gxb_cpoint *p = &cx->points[point];
    int i, planes = 0;
    if (!e->explicit_line) return gxb_complex_side(cx, point, e->line[0]) == 0 && gxb_complex_side(cx, point, e->line[1]) == 0;
    if (point == e->line[0] || point == e->line[1]) return 1;
    if (p->kind == GXB_LINE_PLANE && p->def[0] == e->line[0] && p->def[1] == e->line[1]) return 1;
    for (i = 0; i < 3 && p->kind == GXB_THREE_PLANES; i++) planes += gxbp_plane_has_line(&cx->planes[p->def[i]], e->line[0], e->line[1]);
    return planes >= 2 || gxbp_collinear(cx, point, e->line[0], e->line[1]);
}

/* The halves of a divided edge: they meet in the point of its line and a plane between its ends. */
static int gxbp_edge_is_divided(gxb_complex *cx, const gxb_edge *e) {
    const gxb_edge *a = &cx->edges[e->child], *b = a + 1;
    const gxb_cpoint *p = &cx->points[a->v[1]];
    if (a->v[0] != e->v[0] || b->v[1] != e->v[1] || a->v[1] != b->v[0]) return 0;
    if (a->explicit_line != e->explicit_line || b->explicit_line != e->explicit_line) return 0;
    if (memcmp(a->line, e->line, sizeof e->line) != 0 || memcmp(b->line, e->line, sizeof e->line) != 0) return 0;
    if (p->kind != (e->explicit_line ? GXB_LINE_PLANE : GXB_THREE_PLANES) || p->def[0] != e->line[0] || p->def[1] != e->line[1]) return 0;
    return gxb_complex_side(cx, e->v[0], p->def[2]) * gxb_complex_side(cx, e->v[1], p->def[2]) < 0;
}

/* depth: of each edge in its tree */
static void gxbp_check_edges(gxb_complex *cx, gxb_stream *s, const uint32_t *depth) {
    uint32_t i;
    for (i = 0; i < cx->edge_count && s->result == GX_OK; i++) {
        const gxb_edge *e = &cx->edges[i];
        if (depth[i] == 0) {
            gxbp_require_true(s, e->explicit_line ? !gxbp_same_place(cx, e->line[0], e->line[1]) : gxbp_planes_cross(cx, e->line[0], e->line[1]));
            gxbp_require_true(s, gxbp_on_line(cx, e->v[0], e) && gxbp_on_line(cx, e->v[1], e));
        }
        if (e->child != GXB_NONE && s->result == GX_OK) gxbp_require_true(s, gxbp_edge_is_divided(cx, e));
    }
    for (i = 0; i < 6 * cx->element_count && s->result == GX_OK; i++) {
        const uint32_t edge = cx->mesh_edge[cx->element_edges[i]], *node = cx->elements + 4 * (size_t)(i / 6);
        const uint32_t a = node[gxbp_edge_nodes[i % 6][0]], b = node[gxbp_edge_nodes[i % 6][1]];
        const gxb_edge *e = &cx->edges[edge == GXB_NONE ? 0 : edge];
        if (edge == GXB_NONE) continue;
        gxbp_require_true(s, depth[edge] == 0 && e->explicit_line && e->line[0] == (a < b ? a : b) && e->line[1] == (a < b ? b : a) &&
                             memcmp(e->v, e->line, sizeof e->v) == 0);
    }
}

/* --- facets --- */

/* What the checks work with; one block of words */
typedef struct gxbp_checker {
    gxb_complex *cx;
    gxb_stream *s;
    uint32_t *edge_mark;        /* 2 x edge_count: round in which the edge was met, in this direction */
    uint32_t *border;           /* 2 x edge_count: round of the leaf or face at whose facets it was met */
    uint32_t *facet_mark;       /* 2 x facet_count: the leaf on this side has it */
    uint32_t *edge;             /* edge_count: of the facet at work, undivided and signed */
    uint32_t *corner;           /* edge_count: indices of those at which its line changes */
    uint32_t *facet;            /* facet_count: undivided ones of the leaf or face at work */
    uint32_t *point;            /* point_count: of the leaf at work */
    uint32_t *edge_depth, *facet_depth, *node_depth;
    uint32_t *queue, hung;      /* nodes that hang in a tree, each behind the one above it */
    uint32_t *node_up, *leaf_up;/* 2 x node above + side; GXB_NONE: it is a root */
    uint32_t *node_element;
    uint32_t count, corners, facets, points, round, loose;      /* loose: edges in border without their opposite */
} gxbp_checker;

/* Appends the pieces of a signed edge; none may come twice in a facet. */
static void gxbp_collect_edges(gxbp_checker *c, uint32_t signed_edge) {
    const uint32_t child = c->cx->edges[signed_edge >> 1].child, back = signed_edge & 1;
    if (c->s->result != GX_OK) return;
    if (child != GXB_NONE) {
        gxbp_collect_edges(c, (child + back) << 1 | back);
        gxbp_collect_edges(c, (child + 1 - back) << 1 | back);
        return;
    }
    gxbp_require_true(c->s, c->edge_mark[signed_edge] != c->round && c->edge_mark[signed_edge ^ 1] != c->round);
    c->edge_mark[signed_edge] = c->round;
    if (c->s->result == GX_OK) c->edge[c->count++] = signed_edge;
}

static void gxbp_collect_facet(gxbp_checker *c, uint32_t facet) {
    const gxb_facet *f = &c->cx->facets[facet];
    uint32_t i;
    c->count = 0;
    c->round++;
    for (i = 0; i < f->loop_count && c->s->result == GX_OK; i++) gxbp_collect_edges(c, c->cx->pool[f->loop + i]);
}

static int gxbp_same_carrier(const gxb_complex *cx, uint32_t a, uint32_t b) {
    const gxb_edge *e = &cx->edges[a >> 1], *f = &cx->edges[b >> 1];
    return e->explicit_line == f->explicit_line && memcmp(e->line, f->line, sizeof e->line) == 0;
}

/* Edges first ... end-1 (cyclic) have one line: the corners lie to its left or on it, one does not lie on it, and every edge goes
   the same way along it. */
static int gxbp_side_is_convex(gxbp_checker *c, uint32_t plane, uint32_t first, uint32_t end) {
    gxb_complex *cx = c->cx;
    uint32_t i, apex = GXB_NONE, a = gxbp_edge_start(cx, c->edge[first]), b = gxbp_edge_start(cx, c->edge[end]);
    for (i = 0; i < c->corners; i++) {
        const uint32_t point = gxbp_edge_start(cx, c->edge[c->corner[i]]);
        const int turn = point == a || point == b ? 0 : gxb_complex_turn(cx, a, b, point, plane);
        if (turn < 0) return 0;
        if (turn > 0) apex = point;
    }
    if (apex == GXB_NONE) return 0;
    for (i = first; i != end; i = (i + 1) % c->count) {
        a = gxbp_edge_start(cx, c->edge[i]); b = gxbp_edge_start(cx, c->edge[(i + 1) % c->count]);
        if (gxb_complex_turn(cx, a, b, apex, plane) <= 0) return 0;
    }
    return 1;
}

/* A convex polygon in its plane, counter-clockwise, each point once. */
static void gxbp_check_polygon(gxbp_checker *c, uint32_t facet) {
    gxb_complex *cx = c->cx;
    const uint32_t plane = cx->facets[facet].plane;
    uint32_t i;
    gxbp_collect_facet(c, facet);
    gxbp_require_true(c->s, c->count >= 3);
    if (c->s->result != GX_OK) return;
    c->corners = 0;
    for (i = 0; i < c->count; i++) {
        const uint32_t e = c->edge[i], next = c->edge[(i + 1) % c->count], start = gxbp_edge_start(cx, e);
        gxbp_require_true(c->s, cx->edges[e >> 1].v[1 - (e & 1)] == gxbp_edge_start(cx, next) && cx->points[start].scratch != c->round &&
                                gxb_complex_side(cx, start, plane) == 0);
        cx->points[start].scratch = c->round;
        if (!gxbp_same_carrier(cx, c->edge[(i + c->count - 1) % c->count], e)) c->corner[c->corners++] = i;
    }
    gxbp_require_true(c->s, c->corners >= 3);
    for (i = 0; i < c->corners && c->s->result == GX_OK; i++)
        gxbp_require_true(c->s, gxbp_side_is_convex(c, plane, c->corner[i], c->corner[(i + 1) % c->corners]));
}

/* A facet's leaves are one element's, or those of its face's two elements. */
static int gxbp_facet_is_between(const gxb_complex *cx, const gxb_facet *f) {
    int k;
    if (f->face == GXB_NONE)
        return f->leaf[0] != GXB_NONE && f->leaf[1] != GXB_NONE && cx->leaves[f->leaf[0]].element == cx->leaves[f->leaf[1]].element;
    for (k = 0; k < 2; k++) {
        const uint32_t element = cx->face_elements[2 * f->face + (uint32_t)k];
        if (element == GXB_NONE ? f->leaf[k] != GXB_NONE : f->leaf[k] == GXB_NONE || cx->leaves[f->leaf[k]].element != element) return 0;
    }
    return 1;
}

static void gxbp_check_facets(gxbp_checker *c) {
    gxb_complex *cx = c->cx;
    uint32_t i;
    for (i = 0; i < cx->facet_count && c->s->result == GX_OK; i++) {
        const gxb_facet *f = &cx->facets[i], *half = f->child == GXB_NONE ? f : &cx->facets[f->child];
        gxbp_require_true(c->s, half[0].plane == f->plane && half[0].face == f->face &&
                                (f->child == GXB_NONE || (half[1].plane == f->plane && half[1].face == f->face)));
        if (f->face != GXB_NONE && c->facet_depth[i] == 0) gxbp_require_true(c->s, cx->face_facet[f->face] == i);
        if (f->child != GXB_NONE || c->s->result != GX_OK) continue;
        gxbp_require_true(c->s, gxbp_facet_is_between(cx, f));
        if (c->s->result == GX_OK) gxbp_check_polygon(c, i);
    }
}

/* Collects the facets into which one was divided; those of a leaf's list must be its own, each listed once. */
static void gxbp_collect_facets(gxbp_checker *c, uint32_t facet, uint32_t leaf) {
    const gxb_facet *f = &c->cx->facets[facet];
    if (c->s->result != GX_OK) return;
    if (f->child != GXB_NONE) {
        gxbp_collect_facets(c, f->child, leaf);
        gxbp_collect_facets(c, f->child + 1, leaf);
        return;
    }
    if (leaf != GXB_NONE) {
        const uint32_t side = f->leaf[0] == leaf ? 0 : 1;
        gxbp_require_true(c->s, f->leaf[side] == leaf && !c->facet_mark[2 * facet + side]);
        c->facet_mark[2 * facet + side] = 1;
    }
    if (c->s->result == GX_OK) c->facet[c->facets++] = facet;
}

/* Adds a facet's edges (flip 1: walked backwards) to the border; no edge may come twice in one direction. */
static void gxbp_add_border(gxbp_checker *c, uint32_t facet, uint32_t flip, uint32_t round) {
    uint32_t i;
    gxbp_collect_facet(c, facet);
    for (i = 0; i < c->count && c->s->result == GX_OK; i++) {
        const uint32_t e = c->edge[i] ^ flip;
        gxbp_require_true(c->s, c->border[e] != round);
        c->border[e] = round;
        if (c->border[e ^ 1] == round) c->loose--;
        else c->loose++;
    }
}

/* --- mesh faces: their facets cover them once, up to the pieces of their mesh edges --- */

/* Are all pieces of the signed edge on the border? Returns how many there are. */
static uint32_t gxbp_border_pieces(gxbp_checker *c, uint32_t signed_edge, uint32_t round) {
    const uint32_t child = c->cx->edges[signed_edge >> 1].child, back = signed_edge & 1;
    if (child != GXB_NONE)
        return gxbp_border_pieces(c, child << 1 | back, round) + gxbp_border_pieces(c, (child + 1) << 1 | back, round);
    gxbp_require_true(c->s, c->border[signed_edge] == round && c->border[signed_edge ^ 1] != round);
    return 1;
}

/* Element's face k: nodes a < b < c are its plane, and its border runs from a to b to c. */
static void gxbp_check_face(gxbp_checker *c, uint32_t element, uint32_t k) {
    gxb_complex *cx = c->cx;
    const uint32_t *node = cx->elements + 4 * (size_t)element, root = cx->face_facet[cx->element_faces[4 * (size_t)element + k]];
    uint32_t local[3], n[3], i, j, pieces = 0, round;
    const gxb_cplane *plane;
    if (root == GXB_NONE) return;
    plane = &cx->planes[cx->facets[root].plane];
    for (j = 0; j < 3; j++) n[j] = node[gxbp_face_nodes[k][j]];
    gxbp_sort3(n);
    for (j = 0; j < 3; j++) for (i = 0; i < 4; i++) if (node[i] == n[j]) local[j] = i;
    gxbp_require_true(c->s, c->facet_depth[root] == 0 && cx->facets[root].face == cx->element_faces[4 * (size_t)element + k] &&
                            !plane->along_axis && memcmp(plane->def, n, sizeof n) == 0);
    c->facets = c->loose = 0;
    round = ++c->round;
    gxbp_collect_facets(c, root, GXB_NONE);
    for (i = 0; i < c->facets && c->s->result == GX_OK; i++) gxbp_add_border(c, c->facet[i], 0, round);
    for (j = 0; j < 3 && c->s->result == GX_OK; j++) {
        const uint32_t edge = cx->mesh_edge[cx->element_edges[6 * (size_t)element + gxbp_local_edge(local[j], local[(j + 1) % 3])]];
        gxbp_require_true(c->s, edge != GXB_NONE);
        if (c->s->result == GX_OK) pieces += gxbp_border_pieces(c, edge << 1 | (j == 2 ? 1u : 0u), round);
    }
    gxbp_require_true(c->s, pieces == c->loose);
}

/* --- the trees of the elements --- */

#define GXBP_UNSEEN (GXB_NONE - 1)

static void gxbp_hang(gxbp_checker *c, uint32_t reference, uint32_t up, uint32_t element, uint32_t depth) {
    const uint32_t index = reference >> 1, count = reference & 1 ? c->cx->tree_count : c->cx->leaf_count;
    uint32_t *from = reference & 1 ? c->node_up : c->leaf_up;
    gxbp_require_true(c->s, index < count && from[index < count ? index : 0] == GXBP_UNSEEN);
    if (c->s->result != GX_OK) return;
    from[index] = up;
    if (!(reference & 1)) { gxbp_require_true(c->s, c->cx->leaves[index].element == element); return; }
    c->queue[c->hung++] = index;
    c->node_element[index] = element;
    c->node_depth[index] = depth;
    if (depth > GXBP_DEPTH) gxbp_require(c->s, GX_ERROR_LIMIT);
}

/* From the roots down: every node and leaf hangs somewhere, once. */
static void gxbp_check_tree(gxbp_checker *c) {
    gxb_complex *cx = c->cx;
    uint32_t i, k;
    c->hung = 0;
    for (i = 0; i < cx->tree_count; i++) c->node_up[i] = GXBP_UNSEEN;
    for (i = 0; i < cx->leaf_count; i++) c->leaf_up[i] = GXBP_UNSEEN;
    for (i = 0; i < cx->element_count && c->s->result == GX_OK; i++) gxbp_hang(c, cx->root[i], GXB_NONE, i, 1);
    for (i = 0; i < c->hung && c->s->result == GX_OK; i++) {
        const uint32_t node = c->queue[i];
        const gxb_node *n = &cx->nodes[node];
        gxbp_require_true(c->s, n->plane < cx->plane_count && !cx->planes[n->plane].along_axis);
        for (k = 0; k < 2 && c->s->result == GX_OK; k++) gxbp_hang(c, n->child[k], 2 * node + k, c->node_element[node], c->node_depth[node] + 1);
    }
    gxbp_require_true(c->s, c->hung == cx->tree_count);
    for (i = 0; i < cx->leaf_count; i++) gxbp_require_true(c->s, c->leaf_up[i] != GXBP_UNSEEN);
}

/* --- leaves --- */

/* Do the leaf's points lie on one side of the plane (1: in front, -1: behind)? *off: one is not in it. */
static int gxbp_lies_beside(gxbp_checker *c, uint32_t plane, int side, int *off) {
    uint32_t i;
    *off = 0;
    c->cx->stamp[0]++;
    for (i = 0; i < c->points; i++) {
        const int sign = gxbp_sign(c->cx, c->point[i], plane, 0) * side;
        if (sign < 0) return 0;
        *off |= sign;
    }
    return 1;
}

/* Is the facet's plane that of a node above the leaf, which lies on its side as it does on the facet's? */
static int gxbp_is_above(const gxbp_checker *c, uint32_t leaf, const gxb_facet *f) {
    const uint32_t side = f->leaf[0] == leaf ? 0 : 1;
    uint32_t up;
    for (up = c->leaf_up[leaf]; up != GXB_NONE; up = c->node_up[up >> 1])
        if (c->cx->nodes[up >> 1].plane == f->plane && (up & 1) == side) return 1;
    return 0;
}

static void gxbp_collect_points(gxbp_checker *c, uint32_t round) {
    uint32_t i;
    for (i = 0; i < c->count; i++) {
        const uint32_t point = gxbp_edge_start(c->cx, c->edge[i]);
        if (c->cx->points[point].scratch == round) continue;
        c->cx->points[point].scratch = round;
        c->point[c->points++] = point;
    }
}

/* A leaf that has been opened: closed, convex, and all of what the nodes above it and its element's faces leave. */
static void gxbp_check_open_leaf(gxbp_checker *c, uint32_t leaf) {
    gxb_complex *cx = c->cx;
    const gxb_leaf l = cx->leaves[leaf];
    const uint32_t round = ++c->round;
    uint32_t i, up;
    int off;
    c->facets = c->loose = c->points = 0;
    for (i = 0; i < l.facet_count && c->s->result == GX_OK; i++) gxbp_collect_facets(c, cx->pool[l.facets + i], leaf);
    for (i = 0; i < c->facets && c->s->result == GX_OK; i++) {
        gxbp_add_border(c, c->facet[i], cx->facets[c->facet[i]].leaf[0] == leaf ? 1 : 0, round);
        gxbp_collect_points(c, round);
    }
    gxbp_require_true(c->s, c->loose == 0);
    for (i = 0; i < c->facets && c->s->result == GX_OK; i++) {
        const gxb_facet *f = &cx->facets[c->facet[i]];
        gxbp_require_true(c->s, gxbp_lies_beside(c, f->plane, f->leaf[0] == leaf ? 1 : -1, &off) && off);
        gxbp_require_true(c->s, f->face != GXB_NONE || gxbp_is_above(c, leaf, f));
    }
    for (i = 0; i < 4 && c->s->result == GX_OK; i++) {
        const uint32_t face = cx->element_faces[4 * (size_t)l.element + i];
        gxbp_require_true(c->s, cx->face_facet[face] != GXB_NONE);
        if (c->s->result == GX_OK)
            gxbp_require_true(c->s, gxbp_lies_beside(c, gxbp_face_plane(cx, l.element, i), cx->face_elements[2 * face] == l.element ? 1 : -1, &off));
    }
    for (up = c->leaf_up[leaf]; up != GXB_NONE && c->s->result == GX_OK; up = c->node_up[up >> 1])
        gxbp_require_true(c->s, gxbp_lies_beside(c, cx->nodes[up >> 1].plane, up & 1 ? -1 : 1, &off));
}

/* Both leaves of a facet list it, but for those of elements that nothing has opened. */
static void gxbp_check_leaves(gxbp_checker *c) {
    gxb_complex *cx = c->cx;
    uint32_t i, k;
    for (i = 0; i < cx->leaf_count && c->s->result == GX_OK; i++) {
        if (cx->leaves[i].facet_count > 0) gxbp_check_open_leaf(c, i);
        else gxbp_require_true(c->s, cx->root[i] == 2 * i);
    }
    for (i = 0; i < cx->facet_count && c->s->result == GX_OK; i++) for (k = 0; k < 2; k++) {
        const gxb_facet *f = &cx->facets[i];
        if (f->child != GXB_NONE || f->leaf[k] == GXB_NONE) continue;
        gxbp_require_true(c->s, cx->leaves[f->leaf[k]].facet_count > 0 ? c->facet_mark[2 * i + k] != 0 : f->face != GXB_NONE);
    }
}

static void gxbp_run_checks(gxbp_checker *c) {
    gxb_complex *cx = c->cx;
    uint32_t i;
    gxbp_check_indices(cx, c->s);
    gxbp_check_trees(c->s, cx->edge_count > 0 ? &cx->edges->child : NULL, sizeof *cx->edges, cx->edge_count, c->edge_depth);
    gxbp_check_trees(c->s, cx->facet_count > 0 ? &cx->facets->child : NULL, sizeof *cx->facets, cx->facet_count, c->facet_depth);
    if (c->s->result == GX_OK) gxbp_check_tree(c);
    if (c->s->result == GX_OK) gxbp_check_edges(cx, c->s, c->edge_depth);
    if (c->s->result == GX_OK) gxbp_check_facets(c);
    for (i = 0; i < 4 * cx->element_count && c->s->result == GX_OK; i++) gxbp_check_face(c, i / 4, i % 4);
    if (c->s->result == GX_OK) gxbp_check_leaves(c);
}

static void gxbp_check(gxb_complex *cx, gxb_stream *s) {
    const size_t e = cx->edge_count, f = cx->facet_count, n = cx->tree_count, l = cx->leaf_count;
    const size_t words = 7 * e + 4 * f + cx->point_count + 4 * n + l + 1;
    gxbp_checker c;
    uint32_t *block;
    memset(&c, 0, sizeof c);
    if (words > SIZE_MAX / sizeof *block) { gxbp_require(s, GX_ERROR_LIMIT); return; }
    block = (uint32_t *)gxbp_allocate(&cx->allocator, words * sizeof *block);
    if (block == NULL) { gxbp_require(s, GX_ERROR_MEMORY); return; }
    memset(block, 0, words * sizeof *block);
    c.cx = cx; c.s = s;
    c.edge_mark = block; c.border = c.edge_mark + 2 * e; c.edge = c.border + 2 * e; c.corner = c.edge + e; c.edge_depth = c.corner + e;
    c.facet_mark = c.edge_depth + e; c.facet = c.facet_mark + 2 * f; c.facet_depth = c.facet + f;
    c.node_depth = c.facet_depth + f; c.node_up = c.node_depth + n; c.node_element = c.node_up + n;
    c.leaf_up = c.node_element + n; c.point = c.leaf_up + l; c.queue = c.point + cx->point_count;
    gxbp_run_checks(&c);
    gxbp_release(&cx->allocator, block, words * sizeof *block);
}

#ifdef __cplusplus
}
#endif
#endif /* GXFEM_BOOLEAN_IMPLEMENTED */
