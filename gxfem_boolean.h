/* SPDX-License-Identifier: MIT */
/* gxfem_boolean.h - exact geometry for cutting: predicates, and the cell complex that cuts leave. Part of gxfem 0.2.0.
 *
 * A convex region (a tetrahedron, or a mesh of them) is divided by triangles, any number of them, lying and crossing as
 * they like. Every decision is the sign of a polynomial in the given coordinates and is exact, under any compiler flag.
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
 * Contents. Search for >>name. Only the first function of a family is listed with its prefix.
 *     >>shared      result codes, allocator, job hook
 *     >>numbers     exact numbers, integers times powers of two: gxb_num_set, add, sub, mul, to_double, ratio;
 *                   gxb_fixed_determinant
 *     >>predicates  of coordinates: gxb_orient2d, orient3d, incircle, insphere, winding_number
 *                   a plane: gxb_plane_init
 *                   points given, on a line and a plane, on three planes: gxb_point_explicit, line_plane, three_planes
 *                   predicates of these: gxb_side, compare, orient_in_plane
 *     >>complex     the cell complex (points, planes, edges, facets, leaves): gxb_complex_create, destroy
 *                   transactions: begin, commit, rollback, reserve
 *                   division: add_point, add_plane, insert, open_element, cover_edge, cover_node, set_wall, set_removed
 *                   lists: gxb_leaf_resolve_facets, gxb_facet_resolve_edges
 *                   giving back what nothing needs: is_sparse, survey, compact, forget
 *                   reading: gxb_complex_point and others
 *                   questions: gxb_complex_side, turn, compare, leaf_at, winding, barycentric, support,
 *                   prepare_points, barycentric_fine, barycentric_fixed
 *                   points of moved elements: gxb_pullback_misses, set, contains, orient, weights,
 *                   gxb_complex_pullback_side
 *     >>stream      a complex as bytes: gxb_stream_pass, has; gxb_complex_save, load
 *     >>boolean     exact, chainable Booleans of closed triangle surfaces: gxb_boolean_create, add, evaluate, destroy
 *                   options of a result: set_triangulation, set_fine, set_mend, set_retained
 *                   more about a result: components, defects, changes, statistics
 *
 * The implementation, under GXFEM_BOOLEAN_IMPLEMENTATION, from the bottom up. Of all:
 *     arithmetic      >>bits, >>exact (integers times powers of two), >>filter (doubles with bounds)
 *     predicates      >>points, >>trial (tests of the machine's arithmetic)
 * Of complexes:
 *     storage         >>memory (arrays), >>store (points, planes, exact numbers), >>transaction
 *     structure       >>topology (of the mesh), >>access (reading), >>places (which leaf is there), >>split (by a
 *                     plane), >>pairs (of doubles)
 *     a triangle      >>clip, >>walls, >>cover (what is there already), >>rebalance and >>crowds (trees), >>insert,
 *                     >>ahead (many triangles)
 *     questions       >>inside (winding numbers), >>barycentric, >>pullback (of points of space)
 *     less            >>census (what is needed), >>surround (boxes), >>unite (what becomes one), >>compact (the
 *                     rest goes)
 *     bytes           >>save, >>check (what was read), >>load
 *
 * Of Booleans, in the order of the work:
 *     the object      >>arrangement (its types and struct), >>arena (memory), >>parts (loops by threads), >>keys
 *                     (points by definition)
 *     an operand      >>boxes (a tree of boxes), >>operands (reading one), >>sides (planes of its triangles)
 *     intersection    >>meet (two triangles), >>encounters (all pairs), >>edges (points on edges in order)
 *     triangulation   >>triangulate (points), >>constrain (edges), >>divide (one source), >>flats (sources that overlap
 *                     in one plane), >>merge (equal points)
 *     the result      >>states (vectors of winding numbers), >>winding (one for each subtriangle), >>floods (by
 *                     threads), >>result (triangles and vertices), >>retained (one that keeps its place), >>coarse
 *                     (fewer triangles)
 *     more about it   >>components (shells), >>volumes, >>containers (which shell lies in which), >>mend (defects)
 *     functions       >>leaving (operands taken out), >>api
 *
 * How the complex works. Each element of the mesh starts as one convex leaf, bounded by four facets, which it shares
 * with its neighbours. A triangle is clipped down the element's tree of planes (a binary space partition); each leaf
 * whose inside it meets is divided by the triangle's plane. The part of the dividing facet that the triangle covers
 * becomes a wall; the rest stays open. So every leaf stays convex, and every decision is one predicate: on which side
 * of a plane does a point lie? All leaves around a point, edge or facet share it. It is divided once, its neighbours
 * see the parts, and the complex conforms at all times. What open facets join is connected. So holes, dangling walls,
 * detached walls and nested shells need no treatment of their own. A leaf with many facets is also divided by a plane
 * that belongs to no triangle; that plane makes no wall. docs/ARCHITECTURE.md gives the reasons.
 *
 * How Booleans work. Predicates of input points find where triangles of the operands meet. Each such triangle is
 * divided along the segments in which it meets others. Winding numbers spread from one of these subtriangles to the
 * next. The result is the subtriangles between inside and outside. Vertices are rounded at the output only, and more
 * operands may follow. See docs/KERNEL.md.
 *
 * What it does not do: guarantee that rounding turns no triangle of a result over. gxb_boolean_set_mend repairs what a
 * change within the rounding can repair.
 *
 * Guarantees and limits
 *     - Signs are exact for finite coordinates under every flag, rounding mode and flush-to-zero. What they require of
 *       doubles (>>numbers) is tested at the creation of every complex and Boolean. If it does not hold, as on x87 set
 *       to 24 bits, creation fails with GX_ERROR_CONFIGURATION.
 *     - Coordinates of a complex, scaled by a power of two to the size of the mesh's box, are 0 or of magnitude 2^-128
 *       to 2^128, and at most 2^128 after the origin is subtracted. Others give GX_ERROR_RANGE.
 *     - Coordinates of a Boolean are 0 or of magnitude 2^-128 to 2^128. If the largest of the first operand is outside
 *       2^-60 to 2^60, this range is relative to it. That largest one is 2^-200 to 2^200, so that volumes are finite.
 *       Others give GX_ERROR_RANGE.
 *     - orient2d, orient3d, incircle and insphere take any finite double.
 *     - A complex has fewer than 2^28 elements (2^24 where pointers have 32 bits) and about 1.4e9 points, planes,
 *       edges, facets or leaves. An operand of a Boolean has at most about 130 million triangles.
 *     - No global state, no input or output. Only the growth of its own arrays uses the heap.
 *
 * Configuration: GXB_LIMB32 uses 32-bit limbs also where 128-bit products exist (same results, slower). With
 * GXFEM_STATIC, the compiler leaves out functions that the program does not call.
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

/* cl has neither vectors nor integers of 128 bits of its own: it takes intrinsics, from the compiler's headers. */
#if defined(_MSC_VER) && !defined(__clang__) && !defined(GXFEM_NO_INTRINSICS) && !defined(GXFEM_INTRINSICS)
#define GXFEM_INTRINSICS
#endif

/* With -msimd128 clang before 16 moves a load that fills a vector behind stores to the same address: the headers'
   functions are compiled without vectors then (GXFEM_SCALAR), and not inlined where there are some. */
#if defined(__wasm_simd128__) && defined(__clang__) && __clang_major__ < 16
#define GXFEM_SCALAR
#define GXFEM_APART __attribute__((noinline))
#else
#define GXFEM_APART
#endif

/* The version of all headers. GXFEM_VERSION is one number that can be compared: 200 is 0.2.0. */
#define GXFEM_VERSION_MAJOR 0
#define GXFEM_VERSION_MINOR 2
#define GXFEM_VERSION_PATCH 0
#define GXFEM_VERSION       (GXFEM_VERSION_MAJOR * 10000 + GXFEM_VERSION_MINOR * 100 + GXFEM_VERSION_PATCH)

/* GXFEM_API stands before every public function. Define it before inclusion to build or use a shared library:
   __declspec(dllexport) in the file with the implementation and __declspec(dllimport) elsewhere, or
   __attribute__((visibility("default"))). On WebAssembly put GXFEM_APART in front of it.
   GXFEM_STATIC makes every function private to the file that includes the headers, unless GXFEM_API is defined. */
#ifndef GXFEM_API
#ifdef GXFEM_STATIC
#define GXFEM_API GXFEM_APART static inline
#else
#define GXFEM_API GXFEM_APART extern
#endif
#endif

/* What a function that can fail returns. On anything but GX_OK its inputs are as they were. */
typedef enum gx_result {
    GX_OK = 0,
    GX_ERROR_ARGUMENT,   /* a required pointer is NULL, a required field is zero or senseless */
    GX_ERROR_MEMORY,     /* the allocator returned NULL */
    GX_ERROR_NOT_FINITE, /* a coordinate or parameter is NaN or infinite */
    GX_ERROR_RANGE,      /* a coordinate, a mass or another number is too large or too small (see "limits") */
    GX_ERROR_INDEX,      /* an index points outside its array */
    GX_ERROR_EMPTY,      /* no elements, no nodes or no triangles; a region that holds no copy */
    GX_ERROR_INVERTED,   /* an element has negative volume */
    GX_ERROR_FLAT,       /* an element has no volume */
    GX_ERROR_OVERLAP,    /* an element face is shared by more than two elements, or by two on one side */
    GX_ERROR_NOT_CLOSED, /* a solid's surface has a boundary, or its triangles are not oriented alike */
    GX_ERROR_LIMIT,      /* more objects than 32-bit indices can name, or the caller's memory limit is reached */
    GX_ERROR_DIVERGED,   /* a time step found no finite state of lower energy */
    GX_ERROR_FREE,       /* a static balance is asked of a component, copies joined by elements, that nothing holds */
    GX_ERROR_FORMAT,     /* not a saved body, or one of another version or another kind of machine */
    GX_ERROR_DAMAGED,    /* a saved body is cut short, or what it says cannot be */
    GX_ERROR_STALE,      /* copies are named by a numbering that a cut has changed (see gxs_model.epoch) */
    GX_ERROR_CONFIGURATION, /* arithmetic is not what exact predicates need: see >>numbers in gxfem_boolean.h */
    GX_ERROR_SEQUENCE,      /* called too early, or too late: another call must come before */
    GX_ERROR_CAPACITY       /* the caller's array or memory is too small */
} gx_result;

/* What was refused, and where. A call that succeeds sets it too, to GX_OK. */
typedef struct gx_failure {
    gx_result result;
    /* The name of an argument, or of a member of the struct that an argument points to, with the members on the way:
       "positions", "dt", "surfaces.vertices", "springs.point.copy". GX_ERROR_SEQUENCE: the call that must come before,
       as "gx_body_skin". A string literal. NULL: nothing given is to blame */
    const char *field;
    size_t index;   /* of the node, element, triangle, copy ... concerned; SIZE_MAX: no single one is */
    size_t surface; /* of a cut: which of its surfaces; of a group: which of its bodies; else SIZE_MAX */
} gx_failure;

/* Where memory comes from. Zero-initialised: malloc, free and realloc. */
typedef struct gx_allocator {
    void *(*allocate)(void *user, size_t size);             /* NULL when there is none; size is never 0 */
    void (*release)(void *user, void *memory, size_t size); /* size as it was allocated; memory is never NULL */
    void *user;
    /* A larger block with the bytes of the old one, which is then gone; NULL when there is none, and the old one stays.
       NULL: memory that grows is allocated, copied and released. Only with the other two. */
    void *(*reallocate)(void *user, void *memory, size_t size, size_t larger);
} gx_allocator;
/* How work is handed to the host's threads. Zero-initialised: the calling thread does it all. Results do not depend on
 * it. */
typedef struct gx_jobs {
    /* Calls task(context, i) once for each i below count, on any threads, in any order, and returns when all have
     * returned. */
    void (*parallel_for)(void *user, size_t count, void (*task)(void *context, size_t index), void *context);
    void *user;
} gx_jobs;
#endif /* GXFEM_SHARED_INCLUDED */
#ifdef __cplusplus
extern "C" {
#endif

/* >>numbers -------------------------------------------------------------------------------------------------------- */

/* Exact predicates require three things. Doubles are those of IEEE 754: 53 digits, 11 bits of exponent. The relative
   error of an operation is at most 2^-52. The compiler does not see through gxbp_fence, and does not read a number
   after it is overwritten. A trial at creation (15 to 120 ns) tests this; GX_ERROR_CONFIGURATION says that it failed.
   Predicates of coordinates need no object and run without a trial. */

#if !defined(GXB_LIMB32) &&                                                                                            \
    (defined(__SIZEOF_INT128__) || (defined(GXFEM_INTRINSICS) && (defined(_M_X64) || defined(_M_ARM64))))
typedef uint64_t gxb_limb;
#define GXB_LIMB_BITS   64
#define GXB_NUM_LIMBS   168
#define GXB_FIXED_LIMBS 3
#else
typedef uint32_t gxb_limb;
#define GXB_LIMB_BITS   32
#define GXB_NUM_LIMBS   336
#define GXB_FIXED_LIMBS 6
#endif

/* sign * (d[0] + d[1] B + ... + d[n-1] B^(n-1)) * B^exp with B = 2^GXB_LIMB_BITS. Zero: sign 0, n 0. Neither end limb
   is 0. d points to room for GXB_NUM_LIMBS limbs: enough for polynomials of degree 20 in coordinates of 2^-128 ...
   2^128. */
typedef struct gxb_num {
    int32_t sign, exp;
    uint32_t n;
    gxb_limb *d;
} gxb_num;

/* Declares a number x and its limbs on the stack. */
#define GXB_NUM(x)                                                                                                     \
    gxb_limb x##_limbs[GXB_NUM_LIMBS];                                                                                 \
    gxb_num x = {0, 0, 0, NULL};                                                                                       \
    x.d = x##_limbs

/* r = value * 2^shift, exactly */
GXFEM_API void gxb_num_set(gxb_num *r, double value, int shift);
/* r = a + b; r is neither */
GXFEM_API void gxb_num_add(gxb_num *r, const gxb_num *a, const gxb_num *b);
/* r = a - b; r is neither */
GXFEM_API void gxb_num_sub(gxb_num *r, const gxb_num *a, const gxb_num *b);
/* r = a * b; r is neither */
GXFEM_API void gxb_num_mul(gxb_num *r, const gxb_num *a, const gxb_num *b);
/* a as a double, within one unit in the last place */
GXFEM_API double gxb_num_to_double(const gxb_num *a);
/* a / b, relative error below 2^-50 within 2^-1000 ... 2^1000 */
GXFEM_API double gxb_num_ratio(const gxb_num *a, const gxb_num *b);

/* A number from 0 to 1 as an integer times 2^-184, lowest limb first: a barycentric coordinate */
#define GXB_FIXED_BITS 184
typedef struct gxb_fixed {
    gxb_limb d[GXB_FIXED_LIMBS];
} gxb_fixed;
/* det(a - o, b - o, c - o) of vectors of three such numbers; exact but for the rounding of the result, 2^-51 of it */
GXFEM_API double gxb_fixed_determinant(const gxb_fixed o[3], const gxb_fixed a[3], const gxb_fixed b[3],
                                       const gxb_fixed c[3]);

/* >>predicates ----------------------------------------------------------------------------------------------------- */

/* Sign of |a-c, b-c|: 1 where a, b, c turn counter-clockwise, 0 where they are collinear. */
GXFEM_API int gxb_orient2d(const double a[2], const double b[2], const double c[2]);
/* Sign of |a-d, b-d, c-d|: 1 where d lies below the plane in which a, b, c appear counter-clockwise from above. */
GXFEM_API int gxb_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);
/* 1 where d lies inside the circle through a, b, c, which turn counter-clockwise; -1 outside, 0 on it. */
GXFEM_API int gxb_incircle(const double a[2], const double b[2], const double c[2], const double d[2]);
/* 1 where e lies inside the sphere through a, b, c, d with gxb_orient3d(a, b, c, d) = 1; -1 outside, 0 on it. */
GXFEM_API int gxb_insphere(const double a[3], const double b[3], const double c[3], const double d[3],
                           const double e[3]);

/* Coordinates for gxb_plane and gxb_point: 0 or of magnitude 2^-128 to 2^128. */

/* What the filter knows of a plane: n.(x - base) with proven errors (see >>filter). */
typedef struct gxb_plane_filter {
    double n[3];    /* approximate normal */
    double base[3]; /* a point of the plane, within base_error in each coordinate */
    double base_error;
    double error; /* of each component of n */
    double norm;  /* largest |n[i]| */
} gxb_plane_filter;

/* A point within error of x in each coordinate; error >= 2^200: nothing is known. */
typedef struct gxb_ball {
    double x[3], error;
} gxb_ball;

/* The plane of three points, not collinear; its normal is (q-p) x (r-p). The points must outlive it. */
typedef struct gxb_plane {
    gxb_plane_filter filter;
    const double *p, *q, *r;
} gxb_plane;

/* A point given by coordinates (p), a line through p and q with a plane (plane[0]), or three planes. All must outlive
 * it. */
typedef struct gxb_point {
    gxb_ball ball;
    const double *p, *q;
    const gxb_plane *plane[3];
} gxb_point;

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

/* How often a closed surface (vertices x 3, triangles x 3) winds around p, counted by exact ray crossings: 1 inside a
   surface whose triangles are counter-clockwise from outside. *on_surface becomes 1 if p lies on a triangle; the number
   then has no meaning. */
GXFEM_API int gxb_winding_number(const double *vertices, const uint32_t *triangles, size_t triangle_count,
                                 const double p[3], int *on_surface);

/* >>complex -------------------------------------------------------------------------------------------------------- */

#define GXB_NONE UINT32_MAX

enum { GXB_EXPLICIT = 0, GXB_LINE_PLANE = 1, GXB_THREE_PLANES = 2 };

typedef struct gxb_cpoint { /* a point of the complex */
    gxb_ball ball;          /* in the complex's frame: (x - origin) * 2^shift */
    uint32_t def[3];        /* two points and a plane, or three planes */
    uint8_t kind;           /* GXB_EXPLICIT ... */
    uint8_t wall;           /* 1: a triangle separates elements that meet in this node only */
    int8_t sign[2];
    uint32_t stamp[2]; /* when sign[i] was decided (gxb_store.stamp[i]) */
    gxb_num *exact;    /* X Y Z W, or NULL until they were needed */
    /* barycentric coordinates on a mesh edge (of its two ends) or in a mesh face (of its plane's three nodes); the
     * first is negative until they are computed */
    double parameter[3];
    uint32_t rim_edge; /* while the rim of a new facet is closed: the rim's edge that leaves the point */
    uint32_t name;     /* a number of its own, which it keeps when gxb_complex_compact gives it another index */
} gxb_cpoint;

typedef struct gxb_cplane { /* a plane: of three points, or through points 0 and 1 along coordinate axis def[2] */
    gxb_plane_filter filter;
    gxb_num *exact; /* n and d, or NULL until they were needed */
    uint32_t def[3];
    uint8_t along_axis;
    uint8_t axis;     /* a component of the normal that is not 0 */
    int8_t axis_sign; /* its sign */
} gxb_cplane;

/* The child of an edge or facet that is divided, but whose parts are no longer listed: see gxb_complex_compact */
#define GXB_UNLISTED (UINT32_MAX - 1)

typedef struct gxb_edge {
    uint32_t v[2];    /* points */
    uint32_t line[2]; /* two points (explicit_line) or two planes whose intersection carries the edge */
    /* GXB_NONE, or the first of the two edges (child, child + 1) into which it was divided; GXB_UNLISTED */
    uint32_t child;
    uint32_t explicit_line : 1;
    uint32_t wall : 1;   /* 1: a triangle separates elements that meet in this edge only */
    uint32_t stamp : 30; /* the complex.edge_stamp of the last rim to which it was added */
} gxb_edge;

typedef struct gxb_facet { /* a convex polygon */
    uint32_t plane;
    /* in complex.pool: edge * 2 + (1 if walked backwards), counter-clockwise about the normal; the count of a divided
     * facet is 0. One inside an element then has in loop the plane that divided it: the first child lies in front. */
    uint32_t loop, loop_count : 31;
    uint32_t wall : 1; /* 1: material on its two sides is separated */
    uint32_t leaf[2];  /* in front (where the normal points), behind; GXB_NONE outside the mesh */
    /* GXB_NONE, or the first of the two facets (child, child + 1) into which it was divided; GXB_UNLISTED */
    uint32_t child;
    uint32_t labels; /* in complex.labels, or GXB_NONE: triangles that cover it */
    uint32_t face;   /* the mesh face that it is part of, or GXB_NONE inside an element */
} gxb_facet;

typedef struct gxb_label {
    uint32_t triangle;
    int32_t orientation;
    uint32_t next;
} gxb_label;

typedef struct gxb_leaf { /* a convex subdomain of an element */
    uint32_t element;
    /* in complex.pool; count 0: no triangle has touched the element, or, of a removed leaf, it stands for all removed
     * ones of its element: see gxb_complex_compact */
    uint32_t facets, facet_count;
    uint32_t parent;  /* leaf from which it was split, GXB_NONE for an element's first */
    uint32_t removed; /* set by the user of the complex */
} gxb_leaf;

typedef struct gxb_node {     /* of an element's tree of planes */
    uint32_t plane, child[2]; /* front, behind: leaf * 2 or node * 2 + 1 */
    uint32_t parent;          /* node, GXB_NONE: the element's root */
    uint32_t leaves;          /* below it */
    uint32_t facet;           /* that its plane made, with its parts; GXB_NONE: see gxb_complex_compact */
} gxb_node;

/* Memory for exact numbers. A block never moves. */
typedef struct gxb_block {
    struct gxb_block *next;
    size_t size, used;
} gxb_block;

/* A triangle to insert. Fill point and label, call gxb_complex_add_plane, insert. */
typedef struct gxb_triangle {
    uint32_t point[3];
    uint32_t plane;
    /* 1, or -1 where the plane was made for a coplanar neighbour that faces the other way */
    int32_t orientation;
    uint32_t edge_plane[3]; /* through point[k], point[k+1]; made when needed */
    uint32_t label;         /* the caller's name for it */
    uint32_t wall;          /* 1: what it covers becomes a wall; 0: it only leaves its label */
} gxb_triangle;

typedef struct gxb_mesh {
    const double *positions; /* node_count x 3 */
    size_t node_count;
    const uint32_t *elements; /* element_count x 4, positive volume */
    size_t element_count;
} gxb_mesh;

typedef struct gxb_undo {
    uint32_t array, index;
} gxb_undo;

/* Points and planes, the frame of their coordinates, a cache of exact numbers, and a transaction. A complex and a
   Boolean have one each. */
typedef struct gxb_store {
    gxb_cpoint *points;
    uint32_t point_count, point_capacity;
    gxb_cplane *planes;
    uint32_t plane_count, plane_capacity;
    uint32_t stamp[2]; /* of the signs that points remember (gxb_cpoint.sign) */
    int shift;         /* the frame: (x - origin) * 2^shift */
    double origin[3];
    gxb_block *blocks; /* exact coordinates, computed when first needed and kept */
    /* the transaction: counts and the last block at its begin, items that changed since and their old contents */
    uint32_t mark[2];              /* points, planes */
    uint32_t next_name, mark_name; /* of the next point, now and at begin */
    gxb_block *mark_block;
    size_t mark_used;
    gxb_undo *undo;
    uint32_t undo_count, undo_capacity;
    unsigned char *undo_bytes;
    uint32_t undo_byte_count, undo_byte_capacity;
    uint64_t filter_calls, exact_calls; /* signs asked of the filter, signs that it left to exact arithmetic */
    gx_allocator allocator;
} gxb_store;

/* All arrays belong to the complex and may be read; [i] is valid for i < count. Points 0 ... node_count-1 are the
   nodes, leaves 0 ... element_count-1 the elements' first leaves. */
typedef struct gxb_complex { /* what is used most comes first: its addresses are short */
    gxb_store store;
    gxb_edge *edges;
    uint32_t edge_count, edge_capacity;
    gxb_facet *facets;
    uint32_t facet_count, facet_capacity;
    gxb_leaf *leaves;
    uint32_t leaf_count, leaf_capacity;
    gxb_node *nodes;
    uint32_t tree_count, tree_capacity;
    uint32_t *pool;
    uint32_t pool_count, pool_capacity;
    uint32_t *elements;      /* the complex's copy, element_count x 4 */
    uint32_t *element_faces; /* element_count x 4: face opposite to node k */
    uint32_t *element_edges; /* element_count x 6: 01 02 03 12 13 23 */
    uint32_t *face_elements; /* face_count x 2: GXB_NONE at the mesh's boundary */
    uint32_t *face_facet;    /* face_count: GXB_NONE until touched */
    uint32_t *mesh_edge;     /* mesh_edge_count: GXB_NONE until touched */
    uint32_t *root;          /* element_count: tree reference */
    uint32_t node_count, element_count, face_count, mesh_edge_count;
    uint32_t pool_live, mark_live;        /* words of lists in use, now and at begin */
    uint32_t removed_count, mark_removed; /* removed leaves, now and at begin */
    uint64_t settled;                     /* items when gxb_complex_compact was called last, or at first */
    gxb_label *labels;
    uint32_t label_count, label_capacity;
    /* marked facets, which were labelled or made walls since begin: 2 x facet, + 1 if this made it a wall */
    uint32_t *marked;
    uint32_t marked_count, marked_capacity;
    /* stack of clipped polygons */
    struct gxbp_corner *corners;
    uint32_t corner_count, corner_capacity;
    struct gxbp_task *tasks;
    uint32_t task_count, task_capacity;
    /* work arrays: the leaf to divide as resolved facets and their signs, in this order; the rim of the facet between
     * its halves, as signed edges; the facets of its halves; the loop of a facet to divide; the facets of a crowded
     * leaf inside its element */
    uint32_t *leaf_facets;
    uint32_t leaf_facet_count, leaf_facet_capacity;
    uint32_t *leaf_signs;
    uint32_t leaf_sign_count, leaf_sign_capacity;
    uint32_t *rim;
    uint32_t rim_count, rim_capacity;
    uint32_t *front_facets;
    uint32_t front_facet_count, front_facet_capacity;
    uint32_t *behind_facets;
    uint32_t behind_facet_count, behind_facet_capacity;
    uint32_t *loop;
    uint32_t loop_count, loop_capacity;
    uint32_t *inner_facets;
    uint32_t inner_facet_count, inner_facet_capacity;
    uint32_t mark[6]; /* counts at begin: edges facets leaves nodes labels pool */
    uint32_t edge_stamp;
    uint32_t sign_plane;      /* the plane whose signs points remember in slot 0 */
    struct gxbp_pairs *pairs; /* see >>pairs, >>barycentric */
} gxb_complex;

/* Are allocate and release both set or both NULL, and reallocate set only with them? */
GXFEM_API int gxb_is_allocator(const gx_allocator *allocator);

/* The complex of a mesh. Errors: ARGUMENT, EMPTY, INDEX (element), NOT_FINITE and RANGE (node), INVERTED and FLAT
   (element), OVERLAP (element: one of its faces is shared by more than two elements, or by two on the same side),
   LIMIT, MEMORY, CONFIGURATION. */
GXFEM_API gx_result gxb_complex_create(const gxb_mesh *mesh, const gx_allocator *allocator, gxb_complex **complex,
                                       gx_failure *failure);
GXFEM_API void gxb_complex_destroy(gxb_complex *complex);

/* What follows begin is kept by commit or undone by rollback. After an error only rollback may follow. */
GXFEM_API void gxb_complex_begin(gxb_complex *complex);
GXFEM_API void gxb_complex_commit(gxb_complex *complex);
GXFEM_API void gxb_complex_rollback(gxb_complex *complex);

/* Reserves room for `times` as many items of each kind as were made since begin. Early in a large transaction this
   saves arrays from moving many times. It has no other effect, and ignores a lack of memory. */
GXFEM_API void gxb_complex_reserve(gxb_complex *complex, uint32_t times);

/* Returns the error with which gxb_complex_add_point would refuse the point: NOT_FINITE or RANGE. */
GXFEM_API gx_result gxb_complex_check_point(const gxb_complex *complex, const double x[3]);
/* Errors: NOT_FINITE, RANGE, MEMORY, LIMIT. */
GXFEM_API gx_result gxb_complex_add_point(gxb_complex *complex, const double x[3], uint32_t *point);
/* Sets plane and orientation from the points. GX_ERROR_FLAT: the triangle has no area. */
GXFEM_API gx_result gxb_complex_add_plane(gxb_complex *complex, gxb_triangle *triangle);
/* Divides the leaves of one element that the triangle meets, and labels the facets that it covers. Leaves for which
 * allowed(user, leaf) is 0 are left alone; allowed NULL: all may be divided. */
GXFEM_API gx_result gxb_complex_insert(gxb_complex *complex, gxb_triangle *triangle, uint32_t element,
                                       int (*allowed)(void *user, uint32_t leaf), void *user);
/* Divides the leaves of an element by planes of no triangle, until fewer than `few` of the listed triangles begin in
   each, or no plane parts them well. For an element that many triangles are to meet, before they are inserted; a sample
   of them does. list: their indices, count of them and room for as many more; it comes back in another order. allowed:
   as for gxb_complex_insert */
GXFEM_API gx_result gxb_complex_part(gxb_complex *complex, uint32_t element, const double *vertices,
                                     const uint32_t *triangles, uint32_t *list, uint32_t count, uint32_t few,
                                     int (*allowed)(void *user, uint32_t leaf), void *user);
/* For elements that meet in a mesh edge or a node only. Marks the parts of that edge that the triangle covers (their
   wall becomes 1), or the node. *covered becomes 1 if anything is covered, and is left alone otherwise. */
GXFEM_API gx_result gxb_complex_cover_edge(gxb_complex *complex, gxb_triangle *triangle, uint32_t element,
                                           uint32_t local_edge, int *covered);
GXFEM_API gx_result gxb_complex_cover_node(gxb_complex *complex, gxb_triangle *triangle, uint32_t node, int *covered);
/* Makes a facet a wall. */
GXFEM_API gx_result gxb_complex_set_wall(gxb_complex *complex, uint32_t facet);
GXFEM_API gx_result gxb_complex_set_removed(gxb_complex *complex, uint32_t leaf);
/* Makes the four facets of an untouched element. A removed leaf leaves nothing to be made. */
GXFEM_API gx_result gxb_complex_open_element(gxb_complex *complex, uint32_t element);
/* Brings a leaf's list of facets, or a facet's loop of edges, up to date: divided items are replaced by their parts.
   The list is at gxb_complex_list(complex, *first), *count long. Calls for other leaves and facets leave it there. May
   append to the lists and to the undo log. Errors: MEMORY, LIMIT. */
GXFEM_API gx_result gxb_leaf_resolve_facets(gxb_complex *complex, uint32_t leaf, uint32_t *first, uint32_t *count);
GXFEM_API gx_result gxb_facet_resolve_edges(gxb_complex *complex, uint32_t facet, uint32_t *first, uint32_t *count);

/* How gxb_complex_compact numbers leaves and planes anew: new numbers by old ones; GXB_NONE: it is gone. Leaves
   that went have the number of the one that they are part of or, removed ones, that stands for them. */
typedef struct gxb_renumbering {
    const uint32_t *leaves, *planes;
    uint32_t leaf_count, plane_count; /* before */
    const uint32_t *leaf_of;          /* the old leaf that a leaf is part of, or that stands for it; itself: it stays */
    const uint32_t *changed;          /* element_count: 1: its leaves, facets or edges are not what they were */
    int renamed;                      /* 1: points have other names (gxb_cpoint.name) than before */
    void *memory;
    size_t size;
} gxb_renumbering;
/* Has so much been made since the last compaction, and something been removed, that another one pays? The answer
   depends on counts only, which are saved. */
GXFEM_API int gxb_complex_is_sparse(const gxb_complex *complex);
/* Gives back what nothing needs any more: removed leaves but one for each element, facets between removed leaves, edges
   and facets that are divided, points, planes, nodes of trees, labels and exact numbers that only these had. Leaves
   become one where open facets alone are between them, and no wall or removed leaf ends in the plane of these; so do
   facets between the same leaves, and edges. What stays gets new numbers in the same order. Facets of a mesh face
   between elements that triangles have touched, and edges of a mesh edge around such, are no longer listed as its
   parts. Nodes no longer lead to the parts of their facets: triangles in their planes then ask the facets of each leaf.
   gxb_complex_survey finds out what is to be done and takes the memory for it, also in a transaction, which it leaves
   as it was. gxb_complex_compact does it, and cannot fail: after the survey and a commit, with nothing in between.
   pinned: node_count; elements with a node that is not 0 here keep all they have; NULL: none. kinds: leaf_count; leaves
   with different ones stay apart, as if a wall were between them; NULL: all have the same. renumbering: to be released
   by gxb_complex_forget, whether it was carried out or not; after an error it holds nothing. Errors: MEMORY, LIMIT. */
GXFEM_API gx_result gxb_complex_survey(gxb_complex *complex, const uint8_t *pinned, const uint32_t *kinds,
                                       gxb_renumbering *renumbering);
GXFEM_API void gxb_complex_compact(gxb_complex *complex, gxb_renumbering *renumbering);
GXFEM_API void gxb_complex_forget(gxb_complex *complex, gxb_renumbering *renumbering);

/* Read access. Indices must be below the counts. Pointers are valid until the next call that changes or resolves. */
GXFEM_API const gxb_cpoint *gxb_complex_point(const gxb_complex *complex, uint32_t point);
GXFEM_API const gxb_cplane *gxb_complex_plane(const gxb_complex *complex, uint32_t plane);
GXFEM_API const gxb_edge *gxb_complex_edge(const gxb_complex *complex, uint32_t edge);
GXFEM_API const gxb_facet *gxb_complex_facet(const gxb_complex *complex, uint32_t facet);
GXFEM_API const gxb_leaf *gxb_complex_leaf(const gxb_complex *complex, uint32_t leaf);
GXFEM_API const gxb_node *gxb_complex_tree_node(const gxb_complex *complex, uint32_t node);
GXFEM_API const gxb_label *gxb_complex_label(const gxb_complex *complex, uint32_t label);
/* A list of facets, or a loop of signed edges (edge * 2, + 1 if walked backwards), from its first item on. */
GXFEM_API const uint32_t *gxb_complex_list(const gxb_complex *complex, uint32_t first);
/* The point from which a signed edge leaves. */
GXFEM_API uint32_t gxb_complex_edge_start(const gxb_complex *complex, uint32_t signed_edge);
GXFEM_API uint32_t gxb_complex_point_count(const gxb_complex *complex);
GXFEM_API uint32_t gxb_complex_facet_count(const gxb_complex *complex);
GXFEM_API uint32_t gxb_complex_leaf_count(const gxb_complex *complex);
GXFEM_API uint32_t gxb_complex_label_count(const gxb_complex *complex);
/* The marked facets: those that were labelled or made walls since begin. A facet is listed once for each mark. */
GXFEM_API uint32_t gxb_complex_marked_count(const gxb_complex *complex);
GXFEM_API uint32_t gxb_complex_marked_facet(const gxb_complex *complex, uint32_t index);
/* 1: this mark made a wall of an open facet. */
GXFEM_API int gxb_complex_marked_wall(const gxb_complex *complex, uint32_t index);

/* The mesh, which never changes. Rows of one kind lie in one array: the other elements' rows follow element 0's. */
GXFEM_API uint32_t gxb_complex_node_count(const gxb_complex *complex);
GXFEM_API uint32_t gxb_complex_element_count(const gxb_complex *complex);
GXFEM_API uint32_t gxb_complex_face_count(const gxb_complex *complex);
GXFEM_API uint32_t gxb_complex_mesh_edge_count(const gxb_complex *complex);
/* 4 nodes; 4 faces, opposite to node k; 6 mesh edges between nodes 01 02 03 12 13 23 */
GXFEM_API const uint32_t *gxb_complex_element_nodes(const gxb_complex *complex, uint32_t element);
GXFEM_API const uint32_t *gxb_complex_element_faces(const gxb_complex *complex, uint32_t element);
GXFEM_API const uint32_t *gxb_complex_element_edges(const gxb_complex *complex, uint32_t element);
/* The 2 elements at a face: GXB_NONE outside the mesh */
GXFEM_API const uint32_t *gxb_complex_face_elements(const gxb_complex *complex, uint32_t face);
/* The facet (edge) that a face (mesh edge) became, undivided; GXB_NONE until something touched it */
GXFEM_API uint32_t gxb_complex_face_facet(const gxb_complex *complex, uint32_t face);
GXFEM_API uint32_t gxb_complex_mesh_edge(const gxb_complex *complex, uint32_t mesh_edge);
/* The element's tree: leaf * 2, or node * 2 + 1 */
GXFEM_API uint32_t gxb_complex_root(const gxb_complex *complex, uint32_t element);
/* The frame of balls and plane filters: (x - origin) * 2^shift */
GXFEM_API const double *gxb_complex_origin(const gxb_complex *complex);
GXFEM_API int gxb_complex_shift(const gxb_complex *complex);
/* Prefetches the element's rows, root and first leaf. */
GXFEM_API void gxb_complex_prefetch_element(const gxb_complex *complex, uint32_t element);

/* Sign of a point against a plane of the complex, exact. */
GXFEM_API int gxb_complex_side(gxb_complex *complex, uint32_t point, uint32_t plane);
/* Orientation of three points that lie in a plane of the complex, seen from the side to which its normal points, exact.
 */
GXFEM_API int gxb_complex_turn(gxb_complex *complex, uint32_t a, uint32_t b, uint32_t c, uint32_t plane);
/* Sign of point[axis] - value, exact. */
GXFEM_API int gxb_complex_compare(gxb_complex *complex, uint32_t point, int axis, double value);
/* The leaf of an element, kept or removed, that has the point x, by its exact side of each plane on the way down the
   element's tree. Where x lies on a plane, the side of toward decides; where that lies on it too or is NULL, the front.
   So if x is in a closed leaf and toward inside it, the answer is that leaf. *on becomes 1 if x lies on one of these
   planes. gxb_complex_check_point must accept x and toward. Faces of the element are not asked: of an x outside, the
   answer is the leaf to which the planes lead. */
GXFEM_API uint32_t gxb_complex_leaf_at(gxb_complex *complex, uint32_t element, const double x[3],
                                       const double toward[3] /* or NULL */, int *on /* or NULL */);
/* gxb_winding_number around a point inside the convex hull of points of the complex: the sum of their homogeneous
   coordinates. Exact also for hulls that contain no double. The surface is in the given coordinates and must not pass
   through the hull's inside. */
GXFEM_API int gxb_complex_winding(gxb_complex *complex, const uint32_t *points, size_t point_count,
                                  const double *vertices, const uint32_t *triangles, size_t triangle_count);
/* Barycentric coordinates of a point in an element, each with a relative error below 2^-49 of its own (0 where it is
 * 0). */
GXFEM_API void gxb_complex_barycentric(gxb_complex *complex, uint32_t point, uint32_t element, double lambda[4]);
/* Finds where on their mesh edges and faces the points first ... end-1 lie, as gxb_complex_barycentric does when it
 * first needs that, as far as pairs of doubles tell. It then finds the same coordinates sooner. Threads may do this
 * side by side for different points, while nothing else is done with the complex. Takes 16 kB of stack. */
GXFEM_API void gxb_complex_prepare_points(gxb_complex *complex, uint32_t first, uint32_t end);
/* Bit k is set unless barycentric coordinate k is 0 by the point's definition. Needs no arithmetic. */
GXFEM_API unsigned gxb_complex_support(const gxb_complex *complex, uint32_t point, uint32_t element);
/* The coordinates with a relative error below 2^-180. */
GXFEM_API void gxb_complex_barycentric_fine(gxb_complex *complex, uint32_t point, uint32_t element, gxb_num lambda[4]);
/* The coordinates with an error below 2^-179 */
GXFEM_API void gxb_complex_barycentric_fixed(gxb_complex *complex, uint32_t point, uint32_t element,
                                             gxb_fixed lambda[4]);

/* A point p of space against an element whose corners have moved to x0 ... x3. The affine map that moves the corners
   takes a material point to p: the sum of D_i / D times corner i at rest. D = |x1-x0 x2-x0 x3-x0|, and D_i is the same
   with p in the place of x_i. Corners and p are finite doubles, taken as exact; x0 ... x3 may be inverted or flat. */
typedef struct gxb_pullback {
    const double *corners; /* x0 ... x3: 4 x 3; they and the point must outlive it */
    const double *point;   /* 3 */
    double d[4], error;    /* each D_i within error; error < 0: nothing is known */
    int8_t sign[4];        /* of D_i; 2: not certain yet */
    int8_t orientation;    /* sign of D; 2: not known yet */
} gxb_pullback;
/* 1 where the point certainly lies outside of the moved element: a quick test for many elements */
GXFEM_API int gxb_pullback_misses(const double corners[12], const double point[3]);
/* Sets all members, without exact arithmetic. */
GXFEM_API void gxb_pullback_set(gxb_pullback *back, const double corners[12], const double point[3]);
/* 1 where the point lies in the moved element or on its boundary, exactly. A flat one contains nothing. */
GXFEM_API int gxb_pullback_contains(gxb_pullback *back);
/* Sign of D, exact: 0 where the moved element is flat. */
GXFEM_API int gxb_pullback_orient(gxb_pullback *back);
/* The barycentric coordinates D_i / D, also outside of the element; D is not 0. Inside, none is below 0, and the point
   that they give at rest is within 2^-46 of the element's size of the exact one (2^-47 where sums are rounded to
   nearest; far below 2^-48 as a rule). */
GXFEM_API void gxb_pullback_weights(gxb_pullback *back, double lambda[4]);
/* Sign of the material point against a plane of the complex, exact; D is not 0. */
GXFEM_API int gxb_complex_pullback_side(gxb_complex *complex, gxb_pullback *back, uint32_t element, uint32_t plane);

/* >>stream --------------------------------------------------------------------------------------------------------- */

/* Writes bytes, counts them (out NULL) or reads them (in not NULL), in the machine's own order. The first error stays.
   After it nothing is written, and everything is read as 0. */
typedef struct gxb_stream {
    unsigned char *out;
    const unsigned char *in;
    size_t size, at; /* size: room, or bytes to read; at: bytes passed */
    /* GX_ERROR_CAPACITY: no room; GX_ERROR_DAMAGED: no more bytes, or impossible contents */
    gx_result result;
} gxb_stream;
/* count items of width bytes */
GXFEM_API void gxb_stream_pass(gxb_stream *stream, void *data, size_t count, size_t width);
/* Reading: are there bytes for `count` items? If not, returns 0 and sets GX_ERROR_DAMAGED. So no count that is read can
   request more memory than the stream has bytes for. */
GXFEM_API int gxb_stream_has(gxb_stream *stream, size_t count, size_t width);

/* Writes the definition of the complex without its mesh: no exact numbers, signs or replaced lists. No transaction may
 * be open. */
GXFEM_API void gxb_complex_save(gxb_complex *complex, gxb_stream *stream);
/* Reads it into a complex that was just created from the same mesh. trusted 0: checks everything that other functions
   rely on, by exact predicates. Indices are in range, trees are trees, facets are convex polygons in their planes,
   leaves are convex, closed and within their element's tree. After an error (that of the stream: DAMAGED, MEMORY,
   LIMIT) the complex can only be destroyed. */
GXFEM_API gx_result gxb_complex_load(gxb_complex *complex, gxb_stream *stream, int trusted);

/* >>boolean -------------------------------------------------------------------------------------------------------- */

/* Booleans of closed triangle meshes. A Boolean holds operands and the exact arrangement of their triangles. Evaluating
 * it computes the result. More operands may follow, and nothing is rounded in between (docs/KERNEL.md). */
typedef struct gxb_boolean gxb_boolean;

/* How an operand combines with the result of those before it. The first one combines with nothing. */
enum {
    GXB_UNION = 0,
    GXB_INTERSECTION,
    GXB_DIFFERENCE,
    GXB_SYMMETRIC_DIFFERENCE,
    /* an open or closed sheet: it removes nothing and separates the material on its two sides */
    GXB_SPLIT
};
/* Which winding numbers of an operand's surface count as inside. */
enum { GXB_NONZERO = 0, GXB_POSITIVE, GXB_NEGATIVE, GXB_ODD };

typedef struct gxb_operand {
    /* x 3 */
    const double *vertices;
    size_t vertex_count;
    /* x 3, counter-clockwise from outside */
    const uint32_t *triangles;
    size_t triangle_count;
    uint32_t operation; /* GXB_UNION ... */
    uint32_t rule;      /* GXB_NONZERO ...; a sheet has none */
    /* 1: the caller vouches that this surface meets itself in common vertices and edges only; the test is skipped */
    uint32_t simple;
} gxb_operand;

/* How a result is divided into triangles. */
enum {
    GXB_DIVIDED = 0, /* along the lines where the operands meet */
    /* each source face in as few triangles as its outline allows. A face has no vertex inside it, and none on a
       straight stretch of its outline unless another face ends there. Faces are not merged */
    GXB_COARSE,
    /* as GXB_COARSE, but adjacent source faces in one plane count as one face; a triangle names one of them */
    GXB_MERGED
};

typedef struct gxb_boolean_desc {
    gx_allocator allocator;
    size_t memory_limit; /* the most bytes that the Boolean holds at any time; 0: no limit */
    /* Replaces operations and rules: is a point with these winding numbers inside? NULL: operations and rules decide.
     */
    int (*inside)(void *user, const int32_t *winding, size_t operand_count);
    void *user;
    /* The host's threads; zero: none. Results are the same, to the last bit. Of two large operands, work takes 40
       bytes more for each triangle, and 800 kB. A task takes less than 16 kB of stack. */
    gx_jobs jobs;
} gxb_boolean_desc;

enum {
    GXB_FROM_VERTEX = 0, /* index[0]: vertex of operand[0] */
    /* index[0]: 3 t + k, edge from corner k to k + 1 of triangle t of operand[0]; index[1]: triangle of operand[1] */
    GXB_FROM_EDGE_TRIANGLE,
    GXB_FROM_EDGE_EDGE, /* both are 3 t + k */
    GXB_FROM_THREE_TRIANGLES
};
typedef struct gxb_origin {
    uint32_t kind, operand[3], index[3];
} gxb_origin;

/* The Boolean owns the arrays. They are valid until it is changed, evaluated again or destroyed. */
typedef struct gxb_boolean_result {
    /* x 3; an input vertex has the input's bits, others are rounded once */
    const double *vertices;
    size_t vertex_count;
    /* x 3; the exact surface is closed, oriented outward and does not cross itself */
    const uint32_t *triangles;
    size_t triangle_count;
    const gxb_origin *vertex_origin;                    /* vertex_count */
    const uint32_t *triangle_operand, *triangle_source; /* triangle_count: operand, and its triangle there */
    const uint8_t *triangle_reversed;                   /* triangle_count: 1 where it faces against that triangle */
} gxb_boolean_result;

/* count items from first on */
typedef struct gxb_range {
    size_t first, count;
} gxb_range;

/* Where a result differs from that of the evaluation before, in ascending order. */
typedef struct gxb_changes {
    const gxb_range *vertices;
    size_t vertex_range_count;
    const gxb_range *triangles;
    size_t triangle_range_count;
} gxb_changes;

/* The connected components of a result's interior. Arrays are valid as long as those of the result. */
typedef struct gxb_components {
    size_t count;
    const double *volume; /* count */
    /* count: vertices - edges + triangles of a component's boundary, which is separated where it only touches itself: 2
     * for a ball, 0 for a ring, 2 more for each cavity */
    const int32_t *euler;
    /* count x operands: 1: the component lies only in front of the sheet (where its normals point), -1: only behind, 0:
     * on both sides, or not at it */
    const int8_t *side;
    const uint32_t *triangle; /* component of each triangle of the result */
    double total_volume;
} gxb_components;

/* Triangles that rounding turned by a right angle or more from their source's plane, or left without area. The test is
 * exact. With gxb_boolean_set_mend: those that remain, and how many were removed. A mended triangle lies in its source
 * up to rounding. */
typedef struct gxb_defects {
    const uint32_t *triangles;
    size_t count, mended_count;
} gxb_defects;

/* Since creation */
typedef struct gxb_statistics {
    uint64_t filter_calls, exact_calls; /* signs requested, and how many of them took exact arithmetic */
    uint64_t allocations;
    size_t peak_bytes;
} gxb_statistics;

/* failure may be NULL in all of them. desc may be NULL. Errors: ARGUMENT, LIMIT, MEMORY, CONFIGURATION. */
GXFEM_API gx_result gxb_boolean_create(const gxb_boolean_desc *desc, gxb_boolean **boolean, gx_failure *failure);
GXFEM_API void gxb_boolean_destroy(gxb_boolean *boolean);
/* Options of the following evaluations. The exact surface is the same for all of them. Errors: ARGUMENT. */
/* GXB_DIVIDED (the default), GXB_COARSE or GXB_MERGED */
GXFEM_API gx_result gxb_boolean_set_triangulation(gxb_boolean *boolean, uint32_t triangulation, gx_failure *failure);
/* 1: vertices are the doubles nearest to the exact points, and volumes are right to their last digits. 0 (the default):
 * vertices are proven within 1e-10 of the largest coordinate, and volumes within 1e-7 of their size. Most errors are
 * far smaller. */
GXFEM_API gx_result gxb_boolean_set_fine(gxb_boolean *boolean, int fine, gx_failure *failure);
/* 1: vertices and volumes as with gxb_boolean_set_fine. Then defects are removed where a change within the rounding
 * does it: an edge is flipped, a vertex is merged with a neighbour at most 4 units in the last place away, or a vertex
 * moves by at most 2 such units. The surface stays closed, input vertices stay, and so do components and their Euler
 * characteristics. */
GXFEM_API gx_result gxb_boolean_set_mend(gxb_boolean *boolean, int mend, gx_failure *failure);
/* 1: a result changes that of the evaluation before. Triangles and vertices that both have stay where they are, except
 * that the last triangles take the places of those that have gone. There may be vertices that no triangle has. An
 * evaluation then takes time for what is new, not for all there is; gxb_boolean_changes says what differs. Coarse or
 * mended results, and those after a call of gxb_boolean_set_fine or an error, are made from nothing. 0 (the default):
 * a result does not depend on evaluations before it. */
GXFEM_API gx_result gxb_boolean_set_retained(gxb_boolean *boolean, int retained, gx_failure *failure);
/* Copies an operand. Errors: ARGUMENT, EMPTY, INDEX (triangle), NOT_FINITE and RANGE (vertex), NOT_CLOSED (triangle),
 * LIMIT, MEMORY. */
GXFEM_API gx_result gxb_boolean_add(gxb_boolean *boolean, const gxb_operand *operand, gx_failure *failure);
/* Takes an operand out, by its index in the order in which operands were added. The result is that of the other ones:
 * the same solid as that of a Boolean without it. Indices stay. An operand that moves is taken out and added anew, as
 * the last one. What it has divided stays divided at first, and vertices there may name it, unless the result is
 * coarse. An evaluation then looks only at what the box of the operand meets, or at all if it was the first one or an
 * intersection. Once a quarter of what is held is of operands that were taken out, an evaluation arranges those that
 * are left anew. So it takes the time of a new Boolean then, and gives memory back for what comes; all of a retained
 * result is new. Errors: ARGUMENT, INDEX (no such operand, or it is out already), MEMORY, LIMIT. */
GXFEM_API gx_result gxb_boolean_remove(gxb_boolean *boolean, uint32_t operand, gx_failure *failure);
/* The result of all operands so far. Errors: ARGUMENT, SEQUENCE (no operand), MEMORY, LIMIT, OVERLAP (a surface vouched
 * for as simple is not). After an error the Boolean keeps its operands and can be evaluated again. */
GXFEM_API gx_result gxb_boolean_evaluate(gxb_boolean *boolean, gxb_boolean_result *result, gx_failure *failure);
/* Components and defects of the latest result, computed on the first call. Errors: ARGUMENT, SEQUENCE (no result, or an
 * operand was added since), MEMORY, LIMIT. After an error the result is unchanged. */
GXFEM_API gx_result gxb_boolean_components(gxb_boolean *boolean, gxb_components *components, gx_failure *failure);
GXFEM_API gx_result gxb_boolean_defects(gxb_boolean *boolean, gxb_defects *defects, gx_failure *failure);
/* What the latest evaluation changed in a retained result; all of it, where it was made from nothing. Valid as long as
 * the result. Errors: ARGUMENT, SEQUENCE (no result, or an operand was added since), MEMORY, LIMIT. */
GXFEM_API gx_result gxb_boolean_changes(gxb_boolean *boolean, gxb_changes *changes, gx_failure *failure);
GXFEM_API gx_result gxb_boolean_statistics(const gxb_boolean *boolean, gxb_statistics *statistics, gx_failure *failure);

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
#if defined(GXFEM_INTRINSICS) && defined(_MSC_VER)
#include <intrin.h>
#endif

#ifdef __cplusplus
extern "C" {
#endif
#ifdef GXFEM_SCALAR
#pragma clang attribute push(__attribute__((target("no-simd128"))), apply_to = function)
#endif
#if defined(GXFEM_SMALL) && defined(__clang__)
#pragma clang attribute push(__attribute__((minsize)), apply_to = function)
#endif

/* COLD and RARE functions are seldom called, and compiled for size. A RARE one may be inlined: where it has one caller,
   or where it is public and GXFEM_STATIC makes it inline. APART functions stay out of line: those with many callers,
   and each stage of the work, since one large function compiles slower than its parts. */
#if defined(__GNUC__) || defined(__clang__)
#define GXBP_FETCH(address) __builtin_prefetch(address)
#define GXBP_COLD           __attribute__((cold, noinline))
#define GXBP_RARE           __attribute__((cold))
#define GXBP_APART          __attribute__((noinline))
#else
#define GXBP_FETCH(address) ((void)(address))
#if defined(_MSC_VER)
#define GXBP_COLD  __declspec(noinline)
#define GXBP_APART __declspec(noinline)
#else
#define GXBP_COLD
#define GXBP_APART
#endif
#define GXBP_RARE
#endif

/* >>bits: doubles taken apart and put together without floating-point arithmetic ----------------------------------- */
/* In: doubles. Out: their bits, integer parts and powers of two, and doubles made of these. Nothing here depends
   on rounding modes or flags. */

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

static double gxbp_abs(double x) {
#if defined(__GNUC__) || defined(__clang__)
    return __builtin_fabs(x); /* one instruction, where bits would leave the registers of doubles and come back */
#else
    return gxbp_double(gxbp_bits(x) & ~((uint64_t)1 << 63));
#endif
}

/* floor(log2 |x|) for finite x other than 0, also for denormals */
static int gxbp_exponent(double x) {
    const int e = gxbp_exponent_bits(x);
    uint64_t m = gxbp_bits(x) & (((uint64_t)1 << 52) - 1);
    int k = -1075;
    if (e != 0) return e - 1023;
    for (; m != 0; m >>= 1) k++;
    return k;
}

/* >>exact: sums and products of doubles as integers times powers of two -------------------------------------------- */
/* In: doubles and exact numbers. Out: exact numbers, their signs and roundings. Their limbs are in the caller's
   memory: nothing is allocated. */

/* GXBP_INT128: integers of 128 bits may be used anywhere; with GXFEM_INTRINSICS they only take cl's instruction's
 * place. */
#if defined(__SIZEOF_INT128__) && !defined(GXB_LIMB32)
__extension__ typedef unsigned __int128 gxbp_wide;
#if !defined(GXFEM_INTRINSICS)
#define GXBP_INT128
#endif
#endif

/* x y + a + b: returns the low limb, the high one to *high */
static inline gxb_limb gxbp_multiply(gxb_limb x, gxb_limb y, gxb_limb a, gxb_limb b, gxb_limb *high) {
#if defined(GXBP_INT128)
    const gxbp_wide t = (gxbp_wide)x * y + a + b;
    *high = (gxb_limb)(t >> 64);
    return (gxb_limb)t;
#elif GXB_LIMB_BITS == 64
    gxb_limb low, top;
#if defined(_M_X64)
    low = _umul128(x, y, &top);
#elif defined(_M_ARM64)
    low = x * y, top = __umulh(x, y);
#else
    low = x * y;
    top = (gxb_limb)((gxbp_wide)x * y >> 64);
#endif
    low += a, top += low < a;
    low += b, top += low < b;
    *high = top;
    return low;
#else
    const uint64_t t = (uint64_t)x * y + a + b;
    *high = (gxb_limb)(t >> 32);
    return (gxb_limb)t;
#endif
}

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
    const int power = (e == 0 ? -1074 : e - 1075) + shift; /* value * 2^shift = m * 2^power */
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
    for (i = 0; i < below; i++) r->d[i] = 0; /* loops: a call for two or three limbs would cost more */
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
        const gxb_limb x = (gxb_limb)(d[i] + carry), sum = (gxb_limb)(x + b->d[i]);
        carry = (gxb_limb)((x < carry) | (sum < x));
        d[i] = sum;
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
    if (b_sign == 0) {
        gxbp_num_copy(r, a, 1);
        return;
    }
    if (a->sign == 0) {
        gxbp_num_copy(r, b, b_factor);
        return;
    }
    if (a->sign == b_sign) {
        gxbp_num_add_magnitude(r, a, b);
        r->sign = a->sign;
    } else {
        order = gxbp_num_compare_magnitude(a, b);
        if (order >= 0)
            gxbp_num_sub_magnitude(r, a, b);
        else
            gxbp_num_sub_magnitude(r, b, a);
        r->sign = order == 0 ? 0 : order > 0 ? a->sign : b_sign;
    }
    if (r->d[0] == 0 || r->d[r->n - 1] == 0) gxbp_num_trim(r);
}

GXFEM_API void gxb_num_add(gxb_num *r, const gxb_num *a, const gxb_num *b) { gxbp_num_add_signed(r, a, b, 1); }
GXFEM_API void gxb_num_sub(gxb_num *r, const gxb_num *a, const gxb_num *b) { gxbp_num_add_signed(r, a, b, -1); }

static GXBP_APART void gxbp_num_product(gxb_num *r, const gxb_num *a, const gxb_num *b) {
    gxb_limb carry = 0;
    uint32_t i, j;
    r->sign = a->sign * b->sign;
    r->exp = a->exp + b->exp;
    r->n = r->sign == 0 ? 0 : a->n + b->n;
    if (r->n == 0) {
        r->exp = 0;
        return;
    }
    for (j = 0; j < b->n; j++) r->d[j] = gxbp_multiply(a->d[0], b->d[j], 0, carry, &carry);
    r->d[b->n] = carry;
    for (i = 1; i < a->n; i++) {
        const gxb_limb x = a->d[i];
        gxb_limb *d = r->d + i;
        carry = 0;
        for (j = 0; j < b->n; j++) d[j] = gxbp_multiply(x, b->d[j], d[j], carry, &carry);
        d[b->n] = carry;
    }
    if (r->d[0] == 0 || r->d[r->n - 1] == 0) gxbp_num_trim(r);
}

GXFEM_API void gxb_num_mul(gxb_num *r, const gxb_num *a, const gxb_num *b) { gxbp_num_product(r, a, b); }

/* Bits of a limb other than 0, counted up to the highest that is set. */
static int gxbp_limb_bits(gxb_limb x) {
    int bits = 1, step;
    for (step = GXB_LIMB_BITS / 2; step > 0; step /= 2)
        if (x >> step != 0) {
            bits += step;
            x >>= step;
        }
    return bits;
}

/* |a| = m * 2^power with 2^52 <= m < 2^53, cut off below. a is not 0. */
static uint64_t gxbp_num_mantissa(const gxb_num *a, int *power) {
    int k = (int)a->n - 1, bits = gxbp_limb_bits(a->d[k]);
    uint64_t m = (uint64_t)a->d[k] << (64 - bits);
    *power = (a->exp + k) * GXB_LIMB_BITS + bits - 53;
    for (; bits < 53 && k > 0; bits += GXB_LIMB_BITS) {
        const uint64_t limb = a->d[--k];
        const int shift = 64 - bits - GXB_LIMB_BITS;
        m |= shift >= 0 ? limb << shift : limb >> -shift;
    }
    return m >> 11;
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
    q = (double)gxbp_num_mantissa(a, &power_a);  /* 2^52 <= q < 2^53, a double without rounding */
    q /= (double)gxbp_num_mantissa(b, &power_b); /* 1/2 < q < 2 */
    power_a -= power_b;
    if (power_a < -1000) return 0;
    if (power_a > 1000) power_a = 1000;
    return (a->sign * b->sign < 0 ? -q : q) * gxbp_power(power_a);
}

/* r = |r| for a number of n limbs in two's complement. Returns 1 if it was negative. */
static int gxbp_fixed_absolute(gxb_limb *r, uint32_t n) {
    const int negative = (int)(r[n - 1] >> (GXB_LIMB_BITS - 1));
    gxb_limb carry = 1;
    uint32_t i;
    for (i = 0; negative && i < n; i++) {
        r[i] = (gxb_limb)(~r[i] + carry);
        carry = (gxb_limb)(carry & (r[i] == 0));
    }
    return negative;
}

/* r = |a - b|. Returns 1 if a < b. */
static int gxbp_fixed_difference(gxb_limb *r, const gxb_fixed *a, const gxb_fixed *b) {
    gxb_limb borrow = 0;
    uint32_t i;
    for (i = 0; i < GXB_FIXED_LIMBS; i++) {
        const gxb_limb x = a->d[i], t = (gxb_limb)(x - b->d[i]);
        r[i] = (gxb_limb)(t - borrow);
        borrow = (gxb_limb)((x < b->d[i]) | (t < borrow));
    }
    return gxbp_fixed_absolute(r, GXB_FIXED_LIMBS);
}

/* r += p q, or r -= p q, in two's complement; limbs: n of p, GXB_FIXED_LIMBS of q, as many as of both of r */
static void gxbp_fixed_add_product(gxb_limb *r, const gxb_limb *p, uint32_t n, const gxb_limb *q, int negative) {
    gxb_limb product[3 * GXB_FIXED_LIMBS], carry = 0;
    uint32_t i, j;
    for (i = 0; i < n; i++) product[i] = 0;
    for (j = 0; j < GXB_FIXED_LIMBS; j++) {
        carry = 0;
        for (i = 0; i < n; i++) product[i + j] = gxbp_multiply(p[i], q[j], product[i + j], carry, &carry);
        product[n + j] = carry;
    }
    carry = 0;
    for (i = 0; i < n + GXB_FIXED_LIMBS; i++) {
        const gxb_limb x = r[i], y = (gxb_limb)(product[i] + carry);
        const gxb_limb over = (gxb_limb)(y < carry);
        r[i] = (gxb_limb)(negative ? x - y : x + y);
        carry = (gxb_limb)(over | (negative ? x < y : r[i] < x));
    }
}

/* Differences are below 2^185, minors below 2^371 and the determinant below 2^558, which fit in 192, 384, 576 bits. */
GXFEM_API double gxb_fixed_determinant(const gxb_fixed o[3], const gxb_fixed a[3], const gxb_fixed b[3],
                                       const gxb_fixed c[3]) {
    gxb_limb d[3][3][GXB_FIXED_LIMBS], minor[2 * GXB_FIXED_LIMBS], total[3 * GXB_FIXED_LIMBS];
    int negative[3][3];
    uint32_t k;
    gxb_num r;
    for (k = 0; k < 3; k++) {
        negative[0][k] = gxbp_fixed_difference(d[0][k], &a[k], &o[k]);
        negative[1][k] = gxbp_fixed_difference(d[1][k], &b[k], &o[k]);
        negative[2][k] = gxbp_fixed_difference(d[2][k], &c[k], &o[k]);
    }
    memset(total, 0, sizeof total);
    for (k = 0; k < 3; k++) {
        const uint32_t i = (k + 1) % 3, j = (k + 2) % 3;
        int sign;
        memset(minor, 0, sizeof minor);
        gxbp_fixed_add_product(minor, d[1][i], GXB_FIXED_LIMBS, d[2][j], negative[1][i] ^ negative[2][j]);
        gxbp_fixed_add_product(minor, d[1][j], GXB_FIXED_LIMBS, d[2][i], 1 ^ negative[1][j] ^ negative[2][i]);
        sign = gxbp_fixed_absolute(minor, 2 * GXB_FIXED_LIMBS);
        gxbp_fixed_add_product(total, minor, 2 * GXB_FIXED_LIMBS, d[0][k], sign ^ negative[0][k]);
    }
    r.sign = gxbp_fixed_absolute(total, 3 * GXB_FIXED_LIMBS) ? -1 : 1;
    r.exp = 0;
    r.n = 3 * GXB_FIXED_LIMBS;
    r.d = total;
    gxbp_num_trim(&r);
    return gxb_num_to_double(&r) * gxbp_power(-3 * GXB_FIXED_BITS);
}

/* The number, which is from 0 to 1, cut off below 2^-184 */
static GXBP_COLD void gxbp_fixed_set(gxb_fixed *r, const gxb_num *a) {
    uint32_t i;
    memset(r, 0, sizeof *r);
    for (i = 0; i < a->n; i++) {
        /* the limb's lowest bit, counted from one limb below r's */
        const int bit = (a->exp + (int)i + 1) * GXB_LIMB_BITS + GXB_FIXED_BITS, word = bit / GXB_LIMB_BITS,
                  off = bit % GXB_LIMB_BITS;
        if (bit <= 0) continue;
        if (word > 0) r->d[word - 1] |= (gxb_limb)(a->d[i] << off);
        if (off > 0 && word < GXB_FIXED_LIMBS) r->d[word] |= (gxb_limb)(a->d[i] >> (GXB_LIMB_BITS - off));
    }
}

/* r += factor * a, for a factor of 1 or -1 */
static GXBP_COLD void gxbp_num_increase(gxb_num *r, const gxb_num *a, int factor) {
    GXB_NUM(sum);
    gxbp_num_add_signed(&sum, r, a, factor);
    gxbp_num_copy(r, &sum, 1);
}

/* r = num / den with a relative error below 2^(-45 steps), for at most 16 steps. Each adds the quotient of the
   remainder, 50 bits. A remainder below 2^(-48 steps) of num is left, so that r has at most 48 steps + 58 bits. num is
   overwritten, and becomes no longer than the longer of num and den with one limb more. */
static GXBP_COLD void gxbp_num_divide(gxb_num *r, gxb_num *num, const gxb_num *den, int steps) {
    GXB_NUM(q);
    GXB_NUM(t);
    int step, first = 0, power;
    gxb_num_set(r, 0, 0);
    for (step = 0; step < steps && num->sign != 0; step++) {
        gxb_num_set(&q, gxb_num_ratio(num, den), 0);
        if (q.sign == 0) return;
        (void)gxbp_num_mantissa(&q, &power);
        if (step == 0) first = power;
        if (power < first - 48 * steps) return;
        gxbp_num_increase(r, &q, 1);
        gxb_num_mul(&t, &q, den);
        gxbp_num_increase(num, &t, -1);
    }
}

/* r = a.b for vectors of three numbers; the worst length is that of one product plus 2 limbs */
static void gxbp_num_dot(gxb_num *r, const gxb_num a[3], const gxb_num b[3]) {
    GXB_NUM(t);
    GXB_NUM(s);
    GXB_NUM(u);
    gxb_num_mul(&s, &a[0], &b[0]);
    gxb_num_mul(&t, &a[1], &b[1]);
    gxb_num_add(&u, &s, &t);
    gxb_num_mul(&t, &a[2], &b[2]);
    gxb_num_add(r, &u, &t);
}

/* r = a*b - c*d */
static void gxbp_num_det2(gxb_num *r, const gxb_num *a, const gxb_num *b, const gxb_num *c, const gxb_num *d) {
    GXB_NUM(t);
    GXB_NUM(s);
    gxb_num_mul(&s, a, b);
    gxb_num_mul(&t, c, d);
    gxb_num_sub(r, &s, &t);
}

static GXBP_RARE void gxbp_num_cross(gxb_num r[3], const gxb_num a[3], const gxb_num b[3]) {
    gxbp_num_det2(&r[0], &a[1], &b[2], &a[2], &b[1]);
    gxbp_num_det2(&r[1], &a[2], &b[0], &a[0], &b[2]);
    gxbp_num_det2(&r[2], &a[0], &b[1], &a[1], &b[0]);
}

/* Room for polynomials of this degree in coordinates of the frame. These are integers times 2^-180, below 2^129. The
   polynomials here have coefficients below 2^2.2 for each degree, so below 2^(131.2 degree), and bits down to
   2^(-180 degree): 311.2 bits for each degree. A number may begin and end within a limb, and a sum or a product have a
   limb more until it is trimmed. */
#define GXBP_LIMBS(degree) ((5 * (degree) + 4) * (64 / GXB_LIMB_BITS))

/* Four numbers with their limbs: coordinates and weight of a point, at most of degree 7 (three planes), or normal and
   distance of a plane, degrees 2 and 3. Or differences of any finite doubles, 2099 bits. */
typedef struct gxbp_vec {
    gxb_num c[4];
    gxb_limb limbs[4][GXBP_LIMBS(7)];
} gxbp_vec;

static GXBP_APART void gxbp_vec_init(gxbp_vec *v) {
    int k;
    memset(v->c, 0, sizeof v->c);
    for (k = 0; k < 4; k++) v->c[k].d = v->limbs[k];
}

/* Four numbers of any length: products of differences of any finite doubles, or of a point's coordinates */
typedef struct gxbp_large {
    gxb_num c[4];
    gxb_limb limbs[4][GXB_NUM_LIMBS];
} gxbp_large;

static GXBP_APART void gxbp_large_init(gxbp_large *v) {
    int k;
    memset(v->c, 0, sizeof v->c);
    for (k = 0; k < 4; k++) v->c[k].d = v->limbs[k];
}

/* r = a.(b x c) */
static GXBP_COLD void gxbp_num_det3(gxb_num *r, const gxb_num a[3], const gxb_num b[3], const gxb_num c[3]) {
    gxbp_large normal;
    gxbp_large_init(&normal);
    gxbp_num_cross(normal.c, b, c);
    gxbp_num_dot(r, a, normal.c);
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
static GXBP_COLD void gxbp_exact_plane(gxb_num plane[4], const gxb_num p[3], const gxb_num q[3], const gxb_num r[3]) {
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
    GXB_NUM(t);
    GXB_NUM(s);
    gxbp_num_dot(&s, plane, point);
    gxb_num_mul(&t, &plane[3], &point[3]);
    gxb_num_sub(r, &s, &t);
}

static void gxbp_make_weight_positive(gxb_num point[4]) {
    int k;
    if (point[3].sign < 0)
        for (k = 0; k < 4; k++) point[k].sign = -point[k].sign;
}

/* Line through p and q with a plane: X = s_q p - s_p q, W = s_q - s_p with s = n.x - d; degrees 4 and 3. */
static GXBP_COLD void gxbp_exact_line_plane(gxb_num point[4], const gxb_num p[4], const gxb_num q[4],
                                            const gxb_num plane[4]) {
    GXB_NUM(sp);
    GXB_NUM(sq);
    int k;
    gxbp_exact_side(&sp, p, plane);
    gxbp_exact_side(&sq, q, plane);
    for (k = 0; k < 3; k++) gxbp_num_det2(&point[k], &sq, &p[k], &sp, &q[k]);
    gxb_num_sub(&point[3], &sq, &sp);
    gxbp_make_weight_positive(point);
}

/* Three planes by Cramer's rule: X = d1 n2 x n3 + d2 n3 x n1 + d3 n1 x n2, W = n1.(n2 x n3); degrees 7 and 6. */
static GXBP_COLD void gxbp_exact_three_planes(gxb_num point[4], const gxb_num a[4], const gxb_num b[4],
                                              const gxb_num c[4]) {
    gxbp_vec bc, ca, ab;
    gxb_num row[3], d[3]; /* have the limbs of others */
    int k;
    gxbp_vec_init(&bc);
    gxbp_vec_init(&ca);
    gxbp_vec_init(&ab);
    gxbp_num_cross(bc.c, b, c);
    gxbp_num_cross(ca.c, c, a);
    gxbp_num_cross(ab.c, a, b);
    d[0] = a[3];
    d[1] = b[3];
    d[2] = c[3];
    for (k = 0; k < 3; k++) {
        row[0] = bc.c[k];
        row[1] = ca.c[k];
        row[2] = ab.c[k];
        gxbp_num_dot(&point[k], row, d);
    }
    gxbp_num_dot(&point[3], a, bc.c);
    gxbp_make_weight_positive(point);
}

/* >>filter: signs and points in doubles, with proven error bounds -------------------------------------------------- */
/* In: doubles with errors. Out: values with bounds, and the signs that these leave certain. The bounds hold for any
 * order and contraction of the operations, with excess precision, in any rounding mode. The proof:
 *
 * u = 2^-52 bounds the relative error of one operation in every rounding mode. Underflow, flushed or not, adds at most
 * 2^-1022 to a result; GXBP_TINY, far above every such error in the ranges of the complex, stands for it in every
 * bound. Differences of coordinates, normals and distances pass through gxbp_fence. So a compiler that may reassociate
 * can't multiply them out, and bounds rest on their size after cancellation. Everything after the fence is a sum of
 * products. Whatever its order, each elementary product suffers fewer than eight roundings, so |error| <= 8u * (sum of
 * |products|). Each bound below is at least that plus the inherited errors to first order, times a factor of 2 or more
 * that covers second-order terms and the rounding of the bound itself.
 */
#define GXBP_NO_BALL_EXPONENT 200
#define GXBP_U                gxbp_power(-52)
#define GXBP_TINY             gxbp_power(-600)
#define GXBP_NO_BALL          gxbp_power(GXBP_NO_BALL_EXPONENT)

/* The assembler's constraint for a register that holds exactly a double. x87 has no such register, cl no such
   assembly. */
#if !defined(__GNUC__) && !defined(__clang__)
#elif defined(__SSE2_MATH__)
#define GXBP_REGISTER "+x"
#elif defined(__wasm__)
#define GXBP_REGISTER "+r"
#elif defined(__aarch64__) || (defined(__arm__) && defined(__ARM_FP) && (__ARM_FP & 8))
#define GXBP_REGISTER "+w"
#elif defined(__s390x__) || defined(__powerpc64__) || (defined(__riscv_flen) && __riscv_flen >= 64)
#define GXBP_REGISTER "+f"
#endif

/* x, hidden from the compiler. Costs no instruction where such a register exists. */
static double gxbp_fence(double x) {
#ifdef GXBP_REGISTER
    __asm__("" : GXBP_REGISTER(x));
    return x;
#else
    volatile double v = x;
    return v;
#endif
}

static double gxbp_max(double a, double b) { return a > b ? a : b; }
static double gxbp_min(double a, double b) { return a < b ? a : b; }
static double gxbp_max3(const double a[3]) {
    return gxbp_max(gxbp_abs(a[0]), gxbp_max(gxbp_abs(a[1]), gxbp_abs(a[2])));
}

static void gxbp_cross(double r[3], const double a[3], const double b[3]) {
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
}

/* The error bound of each component of a x b. A and B are sizes, ea and eb errors of the components of a and b. Two
   products of size A B inherit A eb + B ea + ea eb each; rounding adds 8u of 2 A B. */
static double gxbp_cross_error(double A, double ea, double B, double eb) {
    return 4 * (A * eb + B * ea + ea * eb) + 32 * GXBP_U * A * B + GXBP_TINY;
}

/* Component k of a x c, and the size of its products. A product of three fenced differences suffers three roundings in
   them, two in itself and at most five in the sum that makes an orientation of it: within 32u of the products' sizes.
 */
static double gxbp_cross_size(const double a[3], const double c[3], int i, int j, double *size) {
    *size = gxbp_abs(a[i] * c[j]) + gxbp_abs(a[j] * c[i]);
    return a[i] * c[j] - a[j] * c[i];
}

static void gxbp_cross_sizes(double m[3], double size[3], const double a[3], const double c[3]) {
    int k;
    for (k = 0; k < 3; k++) m[k] = gxbp_cross_size(a, c, (k + 1) % 3, (k + 2) % 3, &size[k]);
}

/* r = a x b, with errors ea and eb of the components of a and b. Returns the error bound of r's components. */
static inline double gxbp_filter_cross(double r[3], const double a[3], double ea, const double b[3], double eb) {
    gxbp_cross(r, a, b);
    return gxbp_cross_error(gxbp_max3(a), ea, gxbp_max3(b), eb);
}

static inline void gxbp_difference(double c[3], const gxb_ball *a, const gxb_ball *b) {
    int k;
    for (k = 0; k < 3; k++) c[k] = gxbp_fence(b->x[k] - a->x[k]);
}

/* c = b - a. Returns the error bound of each component. */
static double gxbp_filter_difference(double c[3], const gxb_ball *a, const gxb_ball *b) {
    gxbp_difference(c, a, b);
    return 2 * (a->error + b->error) + 2 * GXBP_U * gxbp_max3(c) + GXBP_TINY;
}

static void gxbp_filter_plane(gxb_plane_filter *f, const gxb_ball *p, const double a[3], double ea, const double b[3],
                              double eb) {
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
static int gxbp_filter_sign(double value, double bound) { return (value > bound) - (value < -bound); }

/* The plane cuts the line from p to q at t = s_p / (s_p - s_q). */
static void gxbp_filter_line_plane(gxb_ball *r, const gxb_ball *p, const gxb_ball *q, const gxb_plane_filter *f) {
    double ep, eq, l[3], t, et, inverse;
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
    inverse = 1 / size; /* while t is divided, too */
    et = 4 * (ep + gxbp_abs(t) * eden) * inverse + 8 * GXBP_U * gxbp_abs(t);
    for (k = 0; k < 3; k++) r->x[k] = gxbp_fence(p->x[k] + t * l[k]);
    r->error = 2 * (gxbp_max3(l) * et + (gxbp_abs(t) + et) * el + p->error) +
               8 * GXBP_U * (gxbp_max3(p->x) + gxbp_abs(t) * gxbp_max3(l) + gxbp_max3(r->x)) + GXBP_TINY;
}

/* Cramer's rule about the base b of plane 0: x = b + (r0 n1 x n2 + r1 n2 x n0 + r2 n0 x n1) / n0.(n1 x n2),
   r_i = n_i.(base_i - b). */
static void gxbp_filter_three_planes(gxb_ball *out, const gxb_plane_filter *const f[3]) {
    gxb_ball b;
    double r[3], er[3], c[3][3], ec[3], C[3], D = 0, eD, size;
    int i, k;
    memcpy(b.x, f[0]->base, sizeof b.x);
    b.error = 0;
    for (i = 0; i < 3; i++) r[i] = gxbp_fence(-gxbp_filter_side(&b, f[i], &er[i]));
    r[0] = 0;
    for (i = 0; i < 3; i++) {
        const gxb_plane_filter *g = f[(i + 1) % 3], *h = f[(i + 2) % 3];
        gxbp_cross(c[i], g->n, h->n);
        C[i] = gxbp_max3(c[i]);
        ec[i] = gxbp_cross_error(g->norm, g->error, h->norm, h->error);
    }
    for (k = 0; k < 3; k++) D += f[0]->n[k] * c[0][k];
    eD = 6 * (f[0]->norm * ec[0] + f[0]->error * (C[0] + ec[0])) + 48 * GXBP_U * f[0]->norm * C[0] + GXBP_TINY;
    D = gxbp_fence(D);
    size = gxbp_abs(D);
    memcpy(out->x, b.x, sizeof out->x);
    out->error = GXBP_NO_BALL;
    if (!(size > 4 * eD)) return;
    {
        double e = 0, largest = 0;
        for (i = 0; i < 3; i++)
            e += 2 * (gxbp_abs(r[i]) * ec[i] + er[i] * (C[i] + ec[i])) + 24 * GXBP_U * gxbp_abs(r[i]) * C[i];
        for (k = 0; k < 3; k++) {
            const double step = gxbp_fence((r[0] * c[0][k] + r[1] * c[1][k] + r[2] * c[2][k]) / D);
            largest = gxbp_max(largest, gxbp_abs(step));
            out->x[k] = gxbp_fence(b.x[k] + step);
        }
        out->error = 4 * (e + largest * eD) / size + 16 * GXBP_U * (largest + gxbp_max3(out->x)) + GXBP_TINY;
    }
}

/* >>points: the predicates on their own ---------------------------------------------------------------------------- */
/* In: coordinates, planes and points by definition. Out: signs. A filter in doubles decides most; exact numbers
   decide the rest. Touches nothing but its own stack. */

static void gxbp_ball_explicit(gxb_ball *ball, const double p[3]) {
    memcpy(ball->x, p, sizeof ball->x);
    ball->error = 0;
}

/* Are these points' coordinates so small that no difference and no product overflows? (underflow: see GXBP_TINY) */
static GXBP_APART int gxbp_filter_range(const double *const *x, int count, int dimension) {
    int i, k;
    for (i = 0; i < count; i++)
        for (k = 0; k < dimension; k++)
            if (gxbp_exponent_bits(x[i][k]) > 1023 + 128) return 0;
    return 1;
}

/* A short exact stage returns this where coordinates are too far apart for it. */
#define GXBP_UNKNOWN 2

#if defined(GXBP_INT128)
__extension__ typedef __int128 gxbp_signed_wide;

/* Writes the coordinates of count points as integers below 2^61 of one unit. 0: the smallest coordinate needs a finer
   unit, or is a denormal. A product by a power of two is exact unless it underflows; then it is no integer, or 0. */
static int gxbp_short_integers(const double *const *x, int count, int dimension, int64_t *out) {
    int top = 0, i, k;
    double scale;
    for (i = 0; i < count; i++)
        for (k = 0; k < dimension; k++) {
            const int e = gxbp_exponent_bits(x[i][k]);
            if (e > top) top = e;
        }
    if (top == 0x7ff || 60 - (top - 1023) > 1023) return 0;
    scale = gxbp_power(60 - (top - 1023));
    for (i = 0; i < count; i++)
        for (k = 0; k < dimension; k++) {
            const double y = gxbp_fence(x[i][k] * scale);
            const int64_t m = (int64_t)y;
            if (gxbp_bits((double)m) << 1 != gxbp_bits(y) << 1 || (m == 0 && !gxbp_is_zero(x[i][k]))) return 0;
            *out++ = m;
        }
    return 1;
}

static int gxbp_orient2d_short(const double *const x[3]) {
    int64_t v[6];
    gxbp_signed_wide s, t;
    if (!gxbp_short_integers(x, 3, 2, v)) return GXBP_UNKNOWN;
    s = (gxbp_signed_wide)(v[0] - v[4]) * (v[3] - v[5]);
    t = (gxbp_signed_wide)(v[1] - v[5]) * (v[2] - v[4]);
    return s > t ? 1 : s < t ? -1 : 0;
}

/* |a-d b-d c-d| for points abc (three, one after the other) and d, as the result * 2^64 + *rest. Differences are below
   2^62, minors below 2^125; each minor is taken apart at 2^64, so that products with its halves stay below 2^127. */
static gxbp_signed_wide gxbp_short_determinant(const int64_t *abc, const int64_t *d, uint64_t *rest) {
    int64_t v[9];
    gxbp_signed_wide high = 0;
    gxbp_wide low = 0;
    int k, m = 1, n = 2;
    for (k = 0; k < 3; k++) {
        v[k] = abc[k] - d[k];
        v[3 + k] = abc[3 + k] - d[k];
        v[6 + k] = abc[6 + k] - d[k];
    }
    for (k = 0; k < 3; m = n, n = k++) {
        const gxbp_signed_wide minor = (gxbp_signed_wide)v[3 + m] * v[6 + n] - (gxbp_signed_wide)v[3 + n] * v[6 + m];
        const gxbp_signed_wide part = (gxbp_signed_wide)(uint64_t)minor * v[k];
        high += (gxbp_signed_wide)(int64_t)(minor >> 64) * v[k] + (part >> 64);
        low += (uint64_t)part;
    }
    *rest = (uint64_t)low;
    return high + (gxbp_signed_wide)(low >> 64);
}

static int gxbp_orient3d_short(const double *const x[4]) {
    int64_t v[12];
    gxbp_signed_wide high;
    uint64_t rest;
    if (!gxbp_short_integers(x, 4, 3, v)) return GXBP_UNKNOWN;
    high = gxbp_short_determinant(v, v + 9, &rest);
    return high < 0 ? -1 : high > 0 || rest != 0;
}

/* Such a determinant's sign and size */
typedef struct gxbp_short {
    int sign;
    uint64_t d[3];
} gxbp_short;

static void gxbp_short_value(gxbp_short *r, const int64_t *abc, const int64_t *d) {
    uint64_t rest;
    gxbp_signed_wide high = gxbp_short_determinant(abc, d, &rest);
    r->sign = high < 0 ? -1 : high > 0 || rest != 0;
    if (high < 0) {
        rest = 0 - rest;
        high = -high - (rest != 0);
    }
    r->d[0] = rest;
    r->d[1] = (uint64_t)high;
    r->d[2] = (uint64_t)(high >> 64);
}

static int gxbp_compare_limbs(const uint64_t *x, const uint64_t *y, int count) {
    while (--count > 0 && x[count] == y[count]) {}
    return (x[count] > y[count]) - (x[count] < y[count]);
}

static void gxbp_short_product(uint64_t r[6], const gxbp_short *x, const gxbp_short *y) {
    int i, j;
    for (i = 0; i < 3; i++) r[i] = 0;
    for (i = 0; i < 3; i++) {
        uint64_t carry = 0;
        for (j = 0; j < 3; j++) {
            const gxbp_wide t = (gxbp_wide)x->d[i] * y->d[j] + r[i + j] + carry;
            r[i + j] = (uint64_t)t;
            carry = (uint64_t)(t >> 64);
        }
        r[i + 3] = carry;
    }
}

/* Sign of a b - c d */
static int gxbp_short_det2(const gxbp_short *a, const gxbp_short *b, const gxbp_short *c, const gxbp_short *d) {
    const int ab = a->sign * b->sign, cd = c->sign * d->sign;
    uint64_t x[6], y[6];
    if (ab != cd || ab == 0) return (ab > cd) - (ab < cd);
    gxbp_short_product(x, a, b);
    gxbp_short_product(y, c, d);
    return ab * gxbp_compare_limbs(x, y, 6);
}

/* The plane through x[3..5] cuts the line from x[6] to x[7] in a point. Returns this point's side of the plane through
   x[0..2]: the sign of (t u - s v) / (t - s), where s and t are the sides of x[6] and x[7] against x[3..5], u and v
   those against x[0..2]. Determinants are the negatives of sides. */
static int gxbp_line_side_short(const double *const x[8]) {
    gxbp_short s, t, u, v;
    int64_t i[24];
    int order;
    if (!gxbp_short_integers(x, 8, 3, i)) return GXBP_UNKNOWN;
    gxbp_short_value(&s, i + 9, i + 18);
    gxbp_short_value(&t, i + 9, i + 21);
    gxbp_short_value(&u, i, i + 18);
    gxbp_short_value(&v, i, i + 21);
    order = s.sign != t.sign ? (s.sign > t.sign) - (s.sign < t.sign) : s.sign * gxbp_compare_limbs(s.d, t.d, 3);
    return order == 0 ? GXBP_UNKNOWN : order * gxbp_short_det2(&t, &u, &s, &v);
}

/* Signs of (x[1] - x[0]) x (x[2] - x[0]) */
static int gxbp_normal_short(const double *const x[3], int sign[3]) {
    int64_t v[9];
    int k, m = 1, n = 2;
    if (!gxbp_short_integers(x, 3, 3, v)) return 0;
    for (k = 0; k < 3; k++) {
        v[3 + k] -= v[k];
        v[6 + k] -= v[k];
    }
    for (k = 0; k < 3; m = n, n = k++) {
        const gxbp_signed_wide y = (gxbp_signed_wide)v[3 + m] * v[6 + n], z = (gxbp_signed_wide)v[3 + n] * v[6 + m];
        sign[k] = (y > z) - (y < z);
    }
    return 1;
}
#else
static int gxbp_orient2d_short(const double *const x[3]) {
    (void)x;
    return GXBP_UNKNOWN;
}

static int gxbp_orient3d_short(const double *const x[4]) { return gxbp_orient2d_short(x); }
static int gxbp_line_side_short(const double *const x[8]) { return gxbp_orient2d_short(x); }

static int gxbp_normal_short(const double *const x[3], int sign[3]) {
    sign[0] = sign[1] = sign[2] = 0;
    return gxbp_orient2d_short(x) != GXBP_UNKNOWN;
}
#endif

/* p[i] - p[count - 1] for the points before the last, of two or three coordinates, as exact numbers */
static GXBP_COLD void gxbp_exact_differences(gxbp_vec *row, const double *const *p, int count, int dimension) {
    gxbp_vec last, x;
    double given[3] = {0, 0, 0};
    int i;
    for (i = count - 1; i >= 0; i--) {
        memcpy(given, p[i], (size_t)dimension * sizeof *given);
        gxbp_vec_set(i == count - 1 ? &last : &x, given);
        if (i == count - 1) continue;
        gxbp_vec_init(&row[i]);
        gxbp_num_sub3(row[i].c, x.c, last.c);
    }
}

static GXBP_COLD int gxbp_orient2d_exact(const double *const p[3]) {
    const int known = gxbp_orient2d_short(p);
    GXB_NUM(r);
    gxbp_vec row[2];
    if (known != GXBP_UNKNOWN) return known;
    gxbp_exact_differences(row, p, 3, 2);
    gxbp_num_det2(&r, &row[0].c[0], &row[1].c[1], &row[0].c[1], &row[1].c[0]);
    return r.sign;
}

GXFEM_API int gxb_orient2d(const double a[2], const double b[2], const double c[2]) {
    const double *p[3];
    p[0] = a;
    p[1] = b;
    p[2] = c;
    if (gxbp_filter_range(p, 3, 2)) {
        const double ax = gxbp_fence(a[0] - c[0]), ay = gxbp_fence(a[1] - c[1]);
        const double bx = gxbp_fence(b[0] - c[0]), by = gxbp_fence(b[1] - c[1]);
        const double bound = 16 * GXBP_U * (gxbp_abs(ax * by) + gxbp_abs(ay * bx)) + GXBP_TINY;
        const int sign = gxbp_filter_sign(ax * by - ay * bx, bound);
        if (sign != 0) return sign;
    }
    return gxbp_orient2d_exact(p);
}

static GXBP_APART int gxbp_orient3d_exact(const double *const p[4]) {
    const int known = gxbp_orient3d_short(p);
    GXB_NUM(r);
    gxbp_vec row[3];
    if (known != GXBP_UNKNOWN) return known;
    gxbp_exact_differences(row, p, 4, 3);
    gxbp_num_det3(&r, row[0].c, row[1].c, row[2].c);
    return r.sign;
}

GXFEM_API int gxb_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
    const double *p[4];
    p[0] = a;
    p[1] = b;
    p[2] = c;
    p[3] = d;
    if (gxbp_filter_range(p, 4, 3)) {
        gxb_plane plane;
        gxb_ball ball;
        double value, bound;
        int sign;
        gxb_plane_init(&plane, a, b, c);
        gxbp_ball_explicit(&ball, d);
        value = gxbp_filter_side(&ball, &plane.filter, &bound);
        sign = gxbp_filter_sign(value, bound);
        if (sign != 0) return -sign;
    }
    return gxbp_orient3d_exact(p);
}

/* Rows are the points minus the last one, with their squared lengths. The determinant is expanded along the column of
   squares. An elementary product has four fenced differences and three products, and is one of twelve: at most
   4 + 3 + 11 roundings in any order. In 3D it has five and four, and is one of 72: 80 roundings. In the ranges of
   gxb_orient3d no product overflows, and errors of underflow are below GXBP_TINY. */
static int gxbp_filter_incircle(const double *const p[4]) {
    double x[3], y[3], value = 0, size = 0;
    int i;
    for (i = 0; i < 3; i++) {
        x[i] = gxbp_fence(p[i][0] - p[3][0]);
        y[i] = gxbp_fence(p[i][1] - p[3][1]);
    }
    for (i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double lift = x[i] * x[i] + y[i] * y[i];
        value += lift * (x[j] * y[k] - x[k] * y[j]);
        size += lift * (gxbp_abs(x[j] * y[k]) + gxbp_abs(x[k] * y[j]));
    }
    return gxbp_filter_sign(value, 48 * GXBP_U * size + GXBP_TINY);
}

static int gxbp_filter_insphere(const double *const p[5]) {
    double x[4][3], lift[4], value = 0, size = 0;
    int i, k;
    for (i = 0; i < 4; i++) {
        for (k = 0; k < 3; k++) x[i][k] = gxbp_fence(p[i][k] - p[4][k]);
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

/* Degree 4: 140 limbs of 64 bits for any finite doubles. */
static GXBP_COLD int gxbp_incircle_exact(const double *const p[4]) {
    gxbp_vec row[3];
    gxbp_large square;
    GXB_NUM(r);
    int i;
    gxbp_exact_differences(row, p, 4, 2);
    gxbp_large_init(&square);
    for (i = 0; i < 3; i++) {
        gxbp_num_dot(&square.c[i], row[i].c, row[i].c);
        row[i].c[2] = square.c[i];
    }
    gxbp_num_det3(&r, row[0].c, row[1].c, row[2].c);
    return r.sign;
}

/* Degree 5: a difference of any finite doubles has 34 limbs of 64 bits, its square 67, a minor 100, their product and
 * the sum of four 167. */
static GXBP_COLD int gxbp_insphere_exact(const double *const p[5]) {
    gxbp_vec row[4];
    GXB_NUM(minor);
    GXB_NUM(square);
    GXB_NUM(term);
    GXB_NUM(sum);
    int i;
    gxbp_exact_differences(row, p, 5, 3);
    for (i = 0; i < 4; i++) {
        gxbp_num_det3(&minor, row[i == 0].c, row[i <= 1 ? 2 : 1].c, row[i <= 2 ? 3 : 2].c);
        gxbp_num_dot(&square, row[i].c, row[i].c);
        gxb_num_mul(&term, &square, &minor);
        gxbp_num_increase(&sum, &term, i % 2 == 0 ? -1 : 1);
    }
    return sum.sign;
}

GXFEM_API int gxb_incircle(const double a[2], const double b[2], const double c[2], const double d[2]) {
    const double *p[4];
    int sign;
    p[0] = a;
    p[1] = b;
    p[2] = c;
    p[3] = d;
    sign = gxbp_filter_range(p, 4, 2) ? gxbp_filter_incircle(p) : 0;
    return sign != 0 ? sign : gxbp_incircle_exact(p);
}

GXFEM_API int gxb_insphere(const double a[3], const double b[3], const double c[3], const double d[3],
                           const double e[3]) {
    const double *p[5];
    int sign;
    p[0] = a;
    p[1] = b;
    p[2] = c;
    p[3] = d;
    p[4] = e;
    sign = gxbp_filter_range(p, 5, 3) ? gxbp_filter_insphere(p) : 0;
    return sign != 0 ? sign : gxbp_insphere_exact(p);
}

GXFEM_API void gxb_plane_init(gxb_plane *plane, const double p[3], const double q[3], const double r[3]) {
    gxb_ball b[3];
    double a[3], c[3], ea, ec;
    gxbp_ball_explicit(&b[0], p);
    gxbp_ball_explicit(&b[1], q);
    gxbp_ball_explicit(&b[2], r);
    ea = gxbp_filter_difference(a, &b[0], &b[1]);
    ec = gxbp_filter_difference(c, &b[0], &b[2]);
    gxbp_filter_plane(&plane->filter, &b[0], a, ea, c, ec);
    plane->p = p;
    plane->q = q;
    plane->r = r;
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
    point->p = p;
    point->q = q;
    point->plane[0] = plane;
}

GXFEM_API void gxb_point_three_planes(gxb_point *point, const gxb_plane *a, const gxb_plane *b, const gxb_plane *c) {
    const gxb_plane_filter *f[3];
    gxbp_point_reset(point);
    f[0] = &a->filter;
    f[1] = &b->filter;
    f[2] = &c->filter;
    gxbp_filter_three_planes(&point->ball, f);
    point->plane[0] = a;
    point->plane[1] = b;
    point->plane[2] = c;
}

static GXBP_COLD void gxbp_plane_exact(gxb_num v[4], const gxb_plane *plane) {
    gxbp_vec p, q, r;
    gxbp_vec_set(&p, plane->p);
    gxbp_vec_set(&q, plane->q);
    gxbp_vec_set(&r, plane->r);
    gxbp_exact_plane(v, p.c, q.c, r.c);
}

static GXBP_COLD void gxbp_point_exact(gxbp_vec *v, const gxb_point *point) {
    gxbp_vec a, b, c;
    if (point->plane[0] == NULL) {
        gxbp_vec_set(v, point->p);
        return;
    }
    gxbp_vec_init(v);
    gxbp_vec_init(&a);
    gxbp_plane_exact(a.c, point->plane[0]);
    if (point->plane[1] == NULL) {
        gxbp_vec_set(&b, point->p);
        gxbp_vec_set(&c, point->q);
        gxbp_exact_line_plane(v->c, b.c, c.c, a.c);
    } else {
        gxbp_vec_init(&b);
        gxbp_vec_init(&c);
        gxbp_plane_exact(b.c, point->plane[1]);
        gxbp_plane_exact(c.c, point->plane[2]);
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
        gxbp_vec_init(&n);
        gxbp_plane_exact(n.c, plane);
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
static GXBP_COLD int gxbp_orient_exact(const gxb_num a[4], const gxb_num b[4], const gxb_num c[4], int i, int j) {
    gxbp_large cofactor;
    gxb_num row[3]; /* has the limbs of a */
    GXB_NUM(r);
    gxbp_large_init(&cofactor);
    gxbp_num_det2(&cofactor.c[0], &b[j], &c[3], &c[j], &b[3]);
    gxbp_num_det2(&cofactor.c[1], &c[i], &b[3], &b[i], &c[3]);
    gxbp_num_det2(&cofactor.c[2], &b[i], &c[j], &c[i], &b[j]);
    row[0] = a[i];
    row[1] = a[j];
    row[2] = a[3];
    gxbp_num_dot(&r, row, cofactor.c);
    return r.sign;
}

/* Orientation of three points in the plane of coordinates i and j; 0: not certain. Bounds as for one component of a
 * cross product. */
static int gxbp_filter_turn(const gxb_ball *a, const gxb_ball *b, const gxb_ball *c, int i, int j) {
    const double ui = gxbp_fence(b->x[i] - a->x[i]), uj = gxbp_fence(b->x[j] - a->x[j]);
    const double vi = gxbp_fence(c->x[i] - a->x[i]), vj = gxbp_fence(c->x[j] - a->x[j]);
    const double U = gxbp_max(gxbp_abs(ui), gxbp_abs(uj)), V = gxbp_max(gxbp_abs(vi), gxbp_abs(vj));
    const double eu = 2 * (a->error + b->error) + 2 * GXBP_U * U + GXBP_TINY,
                 ev = 2 * (a->error + c->error) + 2 * GXBP_U * V + GXBP_TINY;
    const double bound = 4 * (U * ev + V * eu + eu * ev) + 32 * GXBP_U * U * V + GXBP_TINY;
    return gxbp_filter_sign(ui * vj - uj * vi, bound);
}

GXFEM_API int gxb_orient_in_plane(const gxb_point *a, const gxb_point *b, const gxb_point *c, const gxb_plane *plane) {
    const double *n = plane->filter.n;
    gxbp_vec exact_n, x[3];
    int axis, sign, k;
    for (axis = 0; axis < 3 && gxbp_abs(n[axis]) < plane->filter.norm; axis++) {}
    axis %= 3;
    sign = gxbp_filter_sign(n[axis], plane->filter.error);
    if (sign == 0) {
        gxbp_vec_init(&exact_n);
        gxbp_plane_exact(exact_n.c, plane);
        for (k = 0; k < 3 && exact_n.c[axis].sign == 0; k++) axis = k;
        sign = exact_n.c[axis].sign;
    }
    {
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const int turn = gxbp_filter_turn(&a->ball, &b->ball, &c->ball, i, j);
        if (turn != 0) return turn * sign;
        gxbp_point_exact(&x[0], a);
        gxbp_point_exact(&x[1], b);
        gxbp_point_exact(&x[2], c);
        return gxbp_orient_exact(x[0].c, x[1].c, x[2].c, i, j) * sign;
    }
}

/* >>trial: tests of the machine's arithmetic ----------------------------------------------------------------------- */
/* In: nothing. Out: does arithmetic keep the rules that filters and exact numbers assume?
 *
 * If a processor's mode or a compiler breaks them, every creation fails with GX_ERROR_CONFIGURATION. The compiler knows
 * none of the numbers. Results are exact, so they are the same under every flag and in every mode that is allowed.
 * Where a result is rounded, each rounding of it passes.
 */

/* Distance of two numbers of one sign in units of the last place */
static uint64_t gxbp_units_between(double a, double b) {
    const uint64_t x = gxbp_bits(a), y = gxbp_bits(b);
    return x > y ? x - y : y - x;
}

/* 2^e, hidden from the compiler; zero is 0 */
static double gxbp_hidden_power(int e, int zero) { return gxbp_power(e + zero); }

/* Tests for 53 bits, for the range that bounds need, and for errors of sums that are computed as written */
static int gxbp_operations_hold(int zero) {
    const uint64_t one_bits = (uint64_t)1023 << 52;
    const double one = gxbp_hidden_power(0, zero), unit = gxbp_hidden_power(-52, zero);
    const double half = gxbp_hidden_power(-26, zero), small = gxbp_hidden_power(-60, zero);
    const double large = gxbp_hidden_power(500, zero), tiny = gxbp_fence(GXBP_TINY);
    const double above = gxbp_fence(one + half), below = gxbp_fence(one - half), product = gxbp_fence(above * below);
    const double sum = gxbp_fence(one + small), part = gxbp_fence(sum - one);
    const double low = gxbp_fence(gxbp_fence(one - gxbp_fence(sum - part)) + gxbp_fence(small - part));
    const double lost = gxbp_fence(low - small);
    if (sizeof(double) != 8 || gxbp_bits(gxbp_fence(1)) != one_bits || gxbp_bits(one) != one_bits) return 0;
    if (gxbp_bits(gxbp_fence(one + unit)) != one_bits + 1 || gxbp_bits(product) != one_bits - 2) return 0;
    if (gxbp_units_between(gxbp_fence(product / above), below) > 4) return 0; /* it may multiply by a reciprocal */
    if (gxbp_exponent(gxbp_fence(tiny * large)) != -100 || gxbp_exponent(gxbp_fence(large * large)) != 1000) return 0;
    if (gxbp_is_zero(lost)) return gxbp_bits(sum) == one_bits;
    return gxbp_bits(sum) == one_bits + 1 && gxbp_bits(lost) == gxbp_bits(-unit); /* rounded up */
}

/* Reads a number, then overwrites it. clang 14 and 15 get this wrong in vectors for WebAssembly (GXFEM_SCALAR). */
static GXBP_APART void gxbp_in_place(double x[3]) {
    const double a = 2 * x[2] + 1, b = 3 * x[2] + 5;
    x[2] = 7 * x[2];
    x[0] = a;
    x[1] = b;
}

/* A small slanted triangle, edges 2^-20 (3, 1, -2) and 2^-20 (-1, 4, 1), at (1, 1, 1); x[3] lies in its plane, x[4] and
   x[5] on a line through that. All differences and products are exact. */
typedef struct gxbp_trial {
    double x[6][3], step, unit;
    gxb_plane plane;
} gxbp_trial;

/* Tests the side of a point in the plane, and of points one unit in the last place below and above it. Multiplied out
   (n.x - n.b), the sums would not tell them apart. */
static int gxbp_sides_hold(gxbp_trial *t, int zero) {
    static const signed char offset[6][3] = {{0, 0, 0},    {3, 1, -2},   {-1, 4, 1},
                                             {9, -10, -7}, {18, -11, 6}, {-18, -7, -46}};
    const double one = gxbp_hidden_power(0, zero);
    gxb_ball ball;
    int i, k;
    t->step = gxbp_hidden_power(-20, zero);
    t->unit = gxbp_hidden_power(-52, zero);
    for (i = 0; i < 6; i++)
        for (k = 0; k < 3; k++) t->x[i][k] = gxbp_fence(one + t->step * offset[i][k]);
    gxb_plane_init(&t->plane, t->x[0], t->x[1], t->x[2]);
    for (i = -1; i <= 1; i++) {
        double value, bound;
        gxbp_ball_explicit(&ball, t->x[3]);
        ball.x[2] = gxbp_fence(ball.x[2] + t->unit * i);
        value = gxbp_filter_side(&ball, &t->plane.filter, &bound);
        if (gxbp_filter_sign(value, bound) != i) return 0;
    }
    return 1;
}

/* Tests the points in which the plane meets the line, and the planes of x and y: near x[3], and within their errors. */
static int gxbp_meetings_hold(const gxbp_trial *t) {
    const gxb_plane_filter *planes[3];
    gxb_plane upright[2];
    gxb_ball end[2], met[2];
    int i, k;
    for (i = 0; i < 2; i++) {
        double side[2][3];
        for (k = 0; k < 3; k++) side[0][k] = side[1][k] = t->x[3][k];
        side[0][1 - i] = gxbp_fence(side[0][1 - i] + t->step);
        side[1][2] = gxbp_fence(side[1][2] + t->step);
        gxb_plane_init(&upright[i], t->x[3], side[0], side[1]);
        planes[i + 1] = &upright[i].filter;
        gxbp_ball_explicit(&end[i], t->x[4 + i]);
    }
    planes[0] = &t->plane.filter;
    gxbp_filter_line_plane(&met[0], &end[0], &end[1], &t->plane.filter);
    gxbp_filter_three_planes(&met[1], planes);
    for (i = 0; i < 2; i++)
        for (k = 0; k < 3; k++)
            if (!(met[i].error < 256 * t->unit) || gxbp_abs(gxbp_fence(met[i].x[k] - t->x[3][k])) > met[i].error)
                return 0;
    return 1;
}

/* meetings: tests these points too, which takes twice as long as all the rest */
static GXBP_APART int gxbp_arithmetic_holds(int meetings) {
    const volatile int hidden = 0;
    const int zero = hidden;
    gxbp_trial t;
    double x[3] = {0, 0, 0};
    x[2] = gxbp_hidden_power(0, zero);
    gxbp_in_place(x);
    return x[0] == 3 && x[1] == 8 && x[2] == 7 && gxbp_operations_hold(zero) && gxbp_sides_hold(&t, zero) &&
           (!meetings || gxbp_meetings_hold(&t));
}

/* Order of two finite doubles by their bits: flush-to-zero can't make them equal. */
static GXBP_APART int gxbp_compare_doubles(double a, double b) {
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

/* p lies in the triangle's plane, and in its box prolonged to -x. It lies in the triangle if no projection to a
   coordinate plane has it on both sides of edges. All projections of a triangle without area are flat; it contains the
   part of its line that is in its box. */
static GXBP_COLD int gxbp_point_in_triangle(const double a[3], const double b[3], const double c[3],
                                            const double p[3]) {
    int k, flat = 1;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        double pa[2], pb[2], pc[2], pp[2];
        int s, t, r;
        pa[0] = a[i];
        pa[1] = a[j];
        pb[0] = b[i];
        pb[1] = b[j];
        pc[0] = c[i];
        pc[1] = c[j];
        pp[0] = p[i];
        pp[1] = p[j];
        s = gxb_orient2d(pa, pb, pp);
        t = gxb_orient2d(pb, pc, pp);
        r = gxb_orient2d(pc, pa, pp);
        if ((s > 0 || t > 0 || r > 0) && (s < 0 || t < 0 || r < 0)) return 0;
        flat = flat && gxb_orient2d(pa, pb, pc) == 0;
    }
    return !flat || gxbp_compare_doubles(a[0], p[0]) <= 0 || gxbp_compare_doubles(b[0], p[0]) <= 0 ||
           gxbp_compare_doubles(c[0], p[0]) <= 0;
}

/* Does the ray from p along +x cross the triangle? In the projection to y, z the ray is moved by (h, h^2), h -> 0, so
   that it meets no edge. Its side of edge a b is the sign of the first nonzero term of the expansion in h. */
static int gxbp_ray_side(const double a[3], const double b[3], const double p[3]) {
    int sign = gxb_orient2d(a + 1, b + 1, p + 1);
    if (sign != 0) return sign;
    sign = gxbp_compare_doubles(a[2], b[2]);                    /* d/dy of the orientation is a_z - b_z */
    return sign != 0 ? sign : gxbp_compare_doubles(b[1], a[1]); /* d/dz is b_y - a_y */
}

GXFEM_API int gxb_winding_number(const double *vertices, const uint32_t *triangles, size_t triangle_count,
                                 const double p[3], int *on_surface) {
    int winding = 0;
    size_t t;
    *on_surface = 0;
    for (t = 0; t < triangle_count; t++) {
        const double *a = vertices + 3 * (size_t)triangles[3 * t], *b = vertices + 3 * (size_t)triangles[3 * t + 1];
        const double *c = vertices + 3 * (size_t)triangles[3 * t + 2];
        int ab, side;
        if (!gxbp_ray_reaches(a, b, c, p)) continue;
        /* 1: p is behind the triangle, the ray leaves through it if ab > 0 */
        side = gxb_orient3d(a, b, c, p);
        if (side == 0 && gxbp_point_in_triangle(a, b, c, p)) *on_surface = 1;
        ab = gxbp_ray_side(a, b, p);
        if (ab != 0 && side == ab && gxbp_ray_side(b, c, p) == ab && gxbp_ray_side(c, a, p) == ab) winding += ab;
    }
    return winding;
}

/* >>memory: growing arrays ----------------------------------------------------------------------------------------- */
/* In: an allocator. Out: arrays that grow by one rule, gxbp_reserve. All sizes are checked for overflow. */

static GXBP_APART void *gxbp_allocate(const gx_allocator *a, size_t size) {
    return a->allocate ? a->allocate(a->user, size) : malloc(size);
}

static GXBP_APART void gxbp_release(const gx_allocator *a, void *memory, size_t size) {
    if (memory == NULL) return;
    if (a->release)
        a->release(a->user, memory, size);
    else
        free(memory);
}

/* Returns a larger block with the first `used` bytes of the old one, and releases that. NULL: there is no memory, and
 * the old block stays. */
static GXBP_RARE void *gxbp_reallocate(const gx_allocator *a, void *old, size_t old_size, size_t used, size_t size) {
    void *memory;
    /* moves the pages of large blocks, not their bytes */
    if (a->allocate == NULL) return realloc(old, size);
    if (a->reallocate != NULL && old != NULL) return a->reallocate(a->user, old, old_size, size);
    memory = gxbp_allocate(a, size);
    if (memory == NULL) return NULL;
    if (used > 0) memcpy(memory, old, used);
    gxbp_release(a, old, old_size);
    return memory;
}

/* Does an array have room? tests/test_tight.c says no and has no memory then: memory runs out wherever an array could
   grow. */
#ifndef GXBP_HAS_ROOM
#define GXBP_HAS_ROOM(allocator, need, capacity) ((need) <= (capacity))
#endif

/* Room beyond what is needed; none in tests/test_tight_boolean.c */
#ifndef GXBP_SPARE
#define GXBP_SPARE(need) ((need) / 2 + 16)
#endif

static size_t gxbp_room_for(size_t need) { return need + GXBP_SPARE(need); }

/* Makes room for `extra` items more in an array. array: the address of its pointer. The one way by which arrays grow.
 */
static GXBP_APART gx_result gxbp_reserve(const gx_allocator *a, void *array, uint32_t count, uint32_t *capacity,
                                         size_t item, size_t extra) {
    const size_t need = (size_t)count + extra, room = gxbp_room_for(need);
    void *old, *memory;
    if (GXBP_HAS_ROOM(a, need, *capacity)) return GX_OK;
    if (room > INT32_MAX || room > SIZE_MAX / item) return GX_ERROR_LIMIT;
    memcpy(&old, array, sizeof old);
    memory = gxbp_reallocate(a, old, (size_t)*capacity * item, count * item, room * item);
    if (memory == NULL) return GX_ERROR_MEMORY;
    memcpy(array, &memory, sizeof memory);
    *capacity = (uint32_t)room;
    return GX_OK;
}

/* The same for owner->array with owner->counter_count items. */
#define GXBP_RESERVE(allocator, owner, array, counter, extra)                                                          \
    (GXBP_HAS_ROOM(allocator, (size_t)(extra), (owner)->counter##_capacity - (owner)->counter##_count)                 \
         ? GX_OK                                                                                                       \
         : gxbp_reserve(allocator, &(owner)->array, (owner)->counter##_count, &(owner)->counter##_capacity,            \
                        sizeof *(owner)->array, extra))

/* An array of a structure: the offsets of its pointer, count and capacity; the size of an item */
typedef struct gxbp_array {
    uint16_t pointer, count, capacity, item;
} gxbp_array;
#define GXBP_ARRAY(type, array, counter)                                                                               \
    {                                                                                                                  \
        offsetof(type, array), offsetof(type, counter##_count), offsetof(type, counter##_capacity),                    \
            sizeof *((type *)NULL)->array                                                                              \
    }

static void *gxbp_field(void *owner, size_t offset) { return (unsigned char *)owner + offset; }

static uint32_t *gxbp_word(void *owner, size_t offset) { return (uint32_t *)gxbp_field(owner, offset); }

static GXBP_COLD void gxbp_drop_arrays(const gx_allocator *a, void *owner, const gxbp_array *array, size_t count) {
    for (; count > 0; count--, array++) {
        void *memory;
        memcpy(&memory, gxbp_field(owner, array->pointer), sizeof memory);
        gxbp_release(a, memory, (size_t)*gxbp_word(owner, array->capacity) * array->item);
    }
}

/* Records the counts of arrays at the begin of a transaction */
static void gxbp_mark_arrays(void *owner, const gxbp_array *array, uint32_t *mark, uint32_t count) {
    uint32_t k;
    for (k = 0; k < count; k++) mark[k] = *gxbp_word(owner, array[k].count);
}

static void gxbp_cut_arrays(void *owner, const gxbp_array *array, const uint32_t *mark, uint32_t count) {
    uint32_t k;
    for (k = 0; k < count; k++) *gxbp_word(owner, array[k].count) = mark[k];
}

/* An array grows to the expected size or by half, whichever is more: gxbp_reserve adds half of the request. */
static GXBP_RARE void gxbp_expect_arrays(const gx_allocator *a, void *owner, const gxbp_array *array,
                                         const uint32_t *mark, uint32_t arrays, uint32_t times) {
    uint32_t k;
    for (k = 0; k < arrays; k++) {
        uint32_t *capacity = gxbp_word(owner, array[k].capacity);
        const uint32_t count = *gxbp_word(owner, array[k].count);
        const size_t need = count + ((size_t)count - mark[k]) * times;
        const size_t ask = need / 3 * 2 > *capacity ? need / 3 * 2 : *capacity;
        if (need > *capacity)
            (void)gxbp_reserve(a, gxbp_field(owner, array[k].pointer), count, capacity, array[k].item, ask + 1 - count);
    }
}

/* >>store: points, planes, exact numbers, a transaction ------------------------------------------------------------ */
/* A complex and a Boolean share this. In: coordinates, or the points and planes that define a point or plane. Out:
   indices, balls, exact coordinates on request, exact signs of points against planes. Touches the store alone: nothing
   here knows edges, facets or triangles. Exact numbers are computed when a filter leaves a sign open, and kept. The
   undo log holds the old contents of items of any array. The array's owner names it and puts them back. */

static const gxbp_array gxbp_store_arrays[] = {
    GXBP_ARRAY(gxb_store, points, point), GXBP_ARRAY(gxb_store, planes, plane), /* these two have marks */
    GXBP_ARRAY(gxb_store, undo, undo), GXBP_ARRAY(gxb_store, undo_bytes, undo_byte)};

#define GXBP_UNDO_ITEM 128 /* no item that is logged is larger */

static gx_result gxbp_reserve_undo(gxb_store *store, size_t items) {
    gx_result result = GXBP_RESERVE(&store->allocator, store, undo, undo, items);
    if (result == GX_OK) result = GXBP_RESERVE(&store->allocator, store, undo_bytes, undo_byte, items * GXBP_UNDO_ITEM);
    return result;
}

/* Logs an item that is about to change. Room was reserved. */
static void gxbp_log(gxb_store *store, uint32_t array, uint32_t index, const void *item, size_t size) {
    memcpy(store->undo_bytes + store->undo_byte_count, item, size);
    store->undo_byte_count += (uint32_t)size;
    store->undo[store->undo_count].array = array;
    store->undo[store->undo_count++].index = index;
}

/* Puts the item that was logged last back, and forgets it. */
static void gxbp_put_back(gxb_store *store, void *item, size_t size) {
    store->undo_count--;
    store->undo_byte_count -= (uint32_t)size;
    memcpy(item, store->undo_bytes + store->undo_byte_count, size);
}

static void gxbp_store_begin(gxb_store *store) {
    gxbp_mark_arrays(store, gxbp_store_arrays, store->mark, 2);
    store->mark_name = store->next_name;
    store->mark_block = store->blocks;
    store->mark_used = store->blocks != NULL ? store->blocks->used : 0;
    store->undo_count = store->undo_byte_count = 0;
}

/* Was this memory taken since begin? */
static int gxbp_is_recent(const gxb_store *store, const void *memory) {
    const unsigned char *m = (const unsigned char *)memory;
    const gxb_block *block;
    for (block = store->blocks; block != store->mark_block; block = block->next)
        if (m >= (const unsigned char *)block && m < (const unsigned char *)block + block->size) return 1;
    return block != NULL && m >= (const unsigned char *)block + store->mark_used &&
           m < (const unsigned char *)block + block->size;
}

/* Releases the blocks of exact numbers that are newer than this one. */
static GXBP_COLD void gxbp_drop_numbers(gxb_store *store, const gxb_block *last) {
    while (store->blocks != last) {
        gxb_block *next = store->blocks->next;
        gxbp_release(&store->allocator, store->blocks, store->blocks->size);
        store->blocks = next;
    }
}

/* Releases exact numbers kept since begin. Those of older points and planes are computed again when needed. */
static GXBP_COLD void gxbp_drop_recent_numbers(gxb_store *store) {
    uint32_t i;
    if (store->blocks == store->mark_block && (store->blocks == NULL || store->blocks->used == store->mark_used))
        return;
    for (i = 0; i < store->mark[0]; i++)
        if (store->points[i].exact != NULL && gxbp_is_recent(store, store->points[i].exact))
            store->points[i].exact = NULL;
    for (i = 0; i < store->mark[1]; i++)
        if (store->planes[i].exact != NULL && gxbp_is_recent(store, store->planes[i].exact))
            store->planes[i].exact = NULL;
    gxbp_drop_numbers(store, store->mark_block);
    if (store->blocks != NULL) store->blocks->used = store->mark_used;
}

/* The slot is for another plane from now on: signs with an older stamp are not read. */
static void gxbp_forget_signs(gxb_store *store, int slot) {
    uint32_t i;
    if (store->stamp[slot]++ < UINT32_MAX) return;
    for (i = 0; i < store->point_count; i++) store->points[i].stamp[slot] = 0;
    store->stamp[slot] = 1;
}

/* Drops points and planes that were made since begin. The log must be empty. */
static GXBP_RARE void gxbp_store_rollback(gxb_store *store) {
    gxbp_drop_recent_numbers(store);
    gxbp_cut_arrays(store, gxbp_store_arrays, store->mark, 2);
    store->next_name = store->mark_name;
    gxbp_forget_signs(store, 0);
    gxbp_forget_signs(store, 1);
}

static GXBP_COLD void gxbp_store_destroy(gxb_store *store) {
    gxbp_drop_numbers(store, NULL);
    gxbp_drop_arrays(&store->allocator, store, gxbp_store_arrays, sizeof gxbp_store_arrays / sizeof *gxbp_store_arrays);
}

/* floor(log2(high - low)), whatever the mode of the floating-point unit; -2000 where they are equal */
static int gxbp_difference_exponent(double high, double low) {
    GXB_NUM(a);
    GXB_NUM(b);
    GXB_NUM(d);
    int power;
    gxb_num_set(&a, high, 0);
    gxb_num_set(&b, low, 0);
    gxb_num_sub(&d, &a, &b);
    if (d.sign == 0) return -2000;
    gxbp_num_mantissa(&d, &power);
    return power + 52;
}

/* Chooses the frame. The scale brings the box to size 1. The origin is 0, or, where the mesh lies far from 0, its lower
   corner rounded to few bits, so that subtracting it adds no bits to coordinates. */
static gx_result gxbp_choose_frame(gxb_store *store, const double *positions, size_t count, size_t *bad) {
    int axis, largest = -2000;
    for (axis = 0; axis < 3; axis++) {
        double low = 0, high = 0;
        int size;
        size_t i;
        for (i = 0; i < count; i++) {
            const double x = positions[3 * i + (size_t)axis];
            if (!gxbp_is_finite(x)) {
                *bad = i;
                return GX_ERROR_NOT_FINITE;
            }
            if (gxbp_exponent_bits(x) > 2000) {
                *bad = i;
                return GX_ERROR_RANGE;
            }
            if (i == 0 || gxbp_compare_doubles(x, low) < 0) low = x;
            if (i == 0 || gxbp_compare_doubles(x, high) > 0) high = x;
        }
        size = gxbp_difference_exponent(high, low);
        if (size == -2000) size = gxbp_is_zero(low) ? -2000 : gxbp_exponent(low);
        if (size > largest) largest = size;
        if (size > -2000 && !gxbp_is_zero(low) && gxbp_exponent(low) > size + 3) {
            const int kept = gxbp_exponent(low) - size; /* fraction bits of the lower corner */
            if (kept < 52)
                store->origin[axis] = gxbp_double(gxbp_bits(low) & ~((((uint64_t)1) << (52 - kept)) - 1));
            else
                store->origin[axis] = low;
        }
    }
    store->shift = largest == -2000 ? 0 : -largest - 1;
    return GX_OK;
}

static gx_result gxbp_new_point(gxb_store *store, uint32_t *id) {
    const gx_result result = GXBP_RESERVE(&store->allocator, store, points, point, 1);
    if (result != GX_OK) return result;
    *id = store->point_count++;
    memset(&store->points[*id], 0, sizeof store->points[*id]);
    store->points[*id].parameter[0] = -1;
    store->points[*id].name = store->next_name++;
    return GX_OK;
}

/* Memory for exact numbers, in blocks that stay where they are until the complex is destroyed. NULL: there is none. */
static void *gxbp_block_take(gxb_store *store, size_t size) {
    const size_t head = (sizeof(gxb_block) + 15) & ~(size_t)15, room = store->blocks == NULL ? 16384 : 262144;
    gxb_block *block = store->blocks;
    size = (size + 15) & ~(size_t)15;
    if (block == NULL || block->size - block->used < size) {
        block = (gxb_block *)gxbp_allocate(&store->allocator, head + room);
        if (block == NULL) return NULL;
        block->next = store->blocks;
        block->size = head + room;
        block->used = head;
        store->blocks = block;
    }
    block->used += size;
    return (unsigned char *)block + block->used - size;
}

/* Copies four numbers, with their limbs behind them. */
static gxb_num *gxbp_copy_exact(void *to, const gxb_num c[4]) {
    gxb_num *copy = (gxb_num *)to;
    gxb_limb *d = (gxb_limb *)(void *)(copy + 4);
    int k;
    for (k = 0; k < 4; k++) {
        copy[k] = c[k];
        copy[k].d = d;
        memcpy(d, c[k].d, c[k].n * sizeof *d);
        d += c[k].n;
    }
    return copy;
}

/* Keeps a copy of four numbers. NULL: no memory. The numbers are a cache, so most callers can go on without them. */
static gxb_num *gxbp_keep_exact(gxb_store *store, const gxb_num c[4]) {
    size_t total = 0;
    void *memory;
    int k;
    for (k = 0; k < 4; k++) total += c[k].n;
    memory = gxbp_block_take(store, 4 * sizeof *c + total * sizeof(gxb_limb));
    return memory != NULL ? gxbp_copy_exact(memory, c) : NULL;
}

/* (x - origin) * 2^shift, exact; GX_ERROR_RANGE outside of 2^-128 ... 2^128 */
static gx_result gxbp_frame_exact(const gxb_store *store, const double x[3], gxbp_vec *v) {
    int k;
    GXB_NUM(a);
    GXB_NUM(b);
    gxbp_vec_init(v);
    gxb_num_set(&v->c[3], 1.0, 0);
    for (k = 0; k < 3; k++) {
        int power;
        gxb_num_set(&a, x[k], store->shift);
        gxb_num_set(&b, store->origin[k], store->shift);
        if ((a.sign != 0 && (gxbp_num_mantissa(&a, &power), power + 52 < -128)) || (a.sign != 0 && power + 52 > 128))
            return GX_ERROR_RANGE;
        if (b.sign != 0 && (gxbp_num_mantissa(&b, &power), power + 52 > 129)) return GX_ERROR_RANGE; /* far from a */
        gxb_num_sub(&v->c[k], &a, &b);
        if (v->c[k].sign != 0 && (gxbp_num_mantissa(&v->c[k], &power), power + 52 > 128)) return GX_ERROR_RANGE;
    }
    return GX_OK;
}

/* Most points need no arithmetic. */
static gx_result gxbp_store_check_point(const gxb_store *store, const double x[3]) {
    gxbp_vec v;
    int k, plain = 1;
    for (k = 0; k < 3; k++) {
        const int bits = gxbp_exponent_bits(x[k]), e = bits - 1023 + store->shift;
        const int origin = gxbp_exponent_bits(store->origin[k]) - 1023 + store->shift;
        plain = plain && (gxbp_is_zero(x[k]) || (bits > 0 && e >= -128 && e < 127)) && origin < 127;
        if (!gxbp_is_finite(x[k])) return GX_ERROR_NOT_FINITE;
    }
    return plain ? GX_OK : gxbp_frame_exact(store, x, &v);
}

static gx_result gxbp_store_add_point(gxb_store *store, const double x[3], uint32_t *point) {
    gxbp_vec v;
    gx_result result;
    gxb_num *exact = NULL;
    uint32_t id;
    double ball[3], error = 0;
    int k;
    for (k = 0; k < 3; k++)
        if (!gxbp_is_finite(x[k])) return GX_ERROR_NOT_FINITE;
    result = gxbp_frame_exact(store, x, &v);
    if (result != GX_OK) return result;
    for (k = 0; k < 3; k++) {
        GXB_NUM(back);
        GXB_NUM(rest);
        ball[k] = gxb_num_to_double(&v.c[k]);
        gxb_num_set(&back, ball[k], 0);
        gxb_num_sub(&rest, &v.c[k], &back);
        if (rest.sign != 0) error = gxbp_max(error, 2 * GXBP_U * gxbp_abs(ball[k]));
    }
    if (error > 0 && (exact = gxbp_keep_exact(store, v.c)) == NULL) return GX_ERROR_MEMORY;
    result = gxbp_new_point(store, &id);
    if (result != GX_OK) return result;
    memcpy(store->points[id].ball.x, ball, sizeof ball);
    store->points[id].ball.error = error;
    store->points[id].kind = GXB_EXPLICIT;
    store->points[id].exact = exact;
    *point = id;
    return GX_OK;
}

/* Exact homogeneous coordinates of a point of the complex given by its definition. */
static void gxbp_exact_definition(gxb_store *store, uint32_t kind, const uint32_t def[3], gxb_num out[4]);

/* The point's exact coordinates: the kept ones, or those in *own where they need not or cannot be kept. */
static const gxb_num *gxbp_exact_cpoint(gxb_store *store, uint32_t point, gxbp_vec *own) {
    gxb_cpoint *p = &store->points[point];
    if (p->exact != NULL) return p->exact;
    if (p->kind == GXB_EXPLICIT) {
        gxbp_vec_set(own, p->ball.x);
        return own->c;
    }
    gxbp_vec_init(own);
    gxbp_exact_definition(store, p->kind, p->def, own->c);
    p->exact = gxbp_keep_exact(store, own->c);
    return p->exact != NULL ? p->exact : own->c;
}

/* The given coordinates of an explicit point. The shift and scale into the frame were exact, so they can be undone. */
static GXBP_COLD void gxbp_given(gxb_store *store, uint32_t point, double x[3]) {
    gxbp_vec own;
    const gxb_num *c = gxbp_exact_cpoint(store, point, &own);
    int k;
    for (k = 0; k < 3; k++) {
        GXB_NUM(scale);
        GXB_NUM(given);
        GXB_NUM(origin);
        GXB_NUM(sum);
        uint64_t m;
        int power;
        gxb_num_set(&scale, 1.0, -store->shift);
        gxb_num_mul(&given, &c[k], &scale);
        gxb_num_set(&origin, store->origin[k], 0);
        gxb_num_add(&sum, &given, &origin);
        x[k] = 0;
        if (sum.sign == 0) continue;
        m = gxbp_num_mantissa(&sum, &power);
        if (power >= -1074) x[k] = gxbp_compose(m, power, sum.sign < 0);
        /* a denormal: no bit is lost */
        else
            x[k] = gxbp_double((m >> (-1074 - power)) | (sum.sign < 0 ? (uint64_t)1 << 63 : 0));
    }
}

/* n = (q - p) x e_axis, d = n.p */
static GXBP_RARE void gxbp_exact_axis_plane(gxb_num plane[4], const gxb_num p[3], const gxb_num q[3], uint32_t axis) {
    gxbp_vec a;
    const uint32_t i = (axis + 1) % 3, j = (axis + 2) % 3;
    gxbp_vec_init(&a);
    gxbp_num_sub3(a.c, q, p);
    plane[axis].sign = 0;
    plane[axis].exp = 0;
    plane[axis].n = 0;
    gxbp_num_copy(&plane[i], &a.c[j], 1); /* (a x e_k)_i = a_j, (a x e_k)_j = -a_i for i, j, k cyclic */
    gxbp_num_copy(&plane[j], &a.c[i], -1);
    gxbp_num_dot(&plane[3], plane, p);
}

static GXBP_COLD const gxb_num *gxbp_exact_cplane(gxb_store *store, uint32_t plane, gxbp_vec *own) {
    gxb_cplane *f = &store->planes[plane];
    gxbp_vec s[3];
    const gxb_num *p, *q;
    if (f->exact != NULL) return f->exact;
    gxbp_vec_init(own);
    p = gxbp_exact_cpoint(store, f->def[0], &s[0]);
    q = gxbp_exact_cpoint(store, f->def[1], &s[1]);
    if (f->along_axis)
        gxbp_exact_axis_plane(own->c, p, q, f->def[2]);
    else
        gxbp_exact_plane(own->c, p, q, gxbp_exact_cpoint(store, f->def[2], &s[2]));
    f->exact = gxbp_keep_exact(store, own->c);
    return f->exact != NULL ? f->exact : own->c;
}

static void gxbp_exact_definition(gxb_store *store, uint32_t kind, const uint32_t def[3], gxb_num out[4]) {
    gxbp_vec s[3];
    const gxb_num *c = gxbp_exact_cplane(store, def[2], &s[2]);
    if (kind == GXB_LINE_PLANE) {
        const gxb_num *p = gxbp_exact_cpoint(store, def[0], &s[0]);
        gxbp_exact_line_plane(out, p, gxbp_exact_cpoint(store, def[1], &s[1]), c);
    } else {
        const gxb_num *a = gxbp_exact_cplane(store, def[0], &s[0]);
        gxbp_exact_three_planes(out, a, gxbp_exact_cplane(store, def[1], &s[1]), c);
    }
}

/* The ball of a point given by its definition. */
static void gxbp_definition_ball(const gxb_store *store, uint32_t kind, const uint32_t def[3], gxb_ball *ball) {
    if (kind == GXB_LINE_PLANE) {
        gxbp_filter_line_plane(ball, &store->points[def[0]].ball, &store->points[def[1]].ball,
                               &store->planes[def[2]].filter);
    } else {
        const gxb_plane_filter *f[3];
        f[0] = &store->planes[def[0]].filter;
        f[1] = &store->planes[def[1]].filter;
        f[2] = &store->planes[def[2]].filter;
        gxbp_filter_three_planes(ball, f);
    }
}

/* Is the point in the plane by the definition of either? */
static int gxbp_incident(const gxb_store *store, uint32_t kind, const uint32_t def[3], uint32_t point, uint32_t plane) {
    const gxb_cplane *f = &store->planes[plane];
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

/* Is the point in the plane because two of its own planes meet in a line that the plane contains too? This is the case
   where triangles of a sheet meet in their common edge. No filter settles it, and it needs no exact arithmetic. */
static GXBP_RARE int gxbp_incident_by_line(const gxb_store *store, const uint32_t def[3], uint32_t plane) {
    const gxb_cplane *f = &store->planes[plane];
    const uint32_t line_count = f->along_axis ? 1u : 3u;
    uint32_t k, i;
    for (k = 0; k < line_count; k++) {
        int count = 0;
        for (i = 0; i < 3; i++) count += gxbp_plane_has_line(&store->planes[def[i]], f->def[k], f->def[(k + 1) % 3]);
        if (count >= 2) return 1;
    }
    return 0;
}

/* Writes the coordinates of count points to x if all are given by doubles. Returns 0 otherwise. */
static GXBP_APART int gxbp_given_points(const gxb_store *store, const uint32_t *points, int count, const double **x) {
    int k;
    for (k = 0; k < count; k++) {
        const gxb_cpoint *p = &store->points[points[k]];
        if (p->kind != GXB_EXPLICIT || p->ball.error > 0) return 0;
        x[k] = p->ball.x;
    }
    return 1;
}

/* The side of a point given by doubles, or of one on a line and a plane given by doubles; the plane is given by
   doubles too. GXBP_UNKNOWN: it is another case */
static int gxbp_short_side(const gxb_store *store, uint32_t kind, const uint32_t def[3], uint32_t point,
                           uint32_t plane) {
    const gxb_cplane *f = &store->planes[plane], *g;
    const double *x[8];
    int turn;
    if (f->along_axis || !gxbp_given_points(store, f->def, 3, x)) return GXBP_UNKNOWN;
    if (kind == GXB_EXPLICIT) {
        if (!gxbp_given_points(store, &point, 1, x + 3)) return GXBP_UNKNOWN;
        turn = gxbp_orient3d_short(x);
        return turn == GXBP_UNKNOWN ? turn : -turn;
    }
    g = &store->planes[def[2]];
    if (kind != GXB_LINE_PLANE || g->along_axis || !gxbp_given_points(store, g->def, 3, x + 3) ||
        !gxbp_given_points(store, def, 2, x + 6))
        return GXBP_UNKNOWN;
    return gxbp_line_side_short(x);
}

/* Sign of the exact value of n.X - d W for a point of the complex, or (point GXB_NONE) for one that only has a
 * definition. */
static int gxbp_exact_sign(gxb_store *store, uint32_t kind, const uint32_t def[3], uint32_t point, uint32_t plane) {
    GXB_NUM(r);
    gxbp_vec sx, sn;
    const gxb_num *n, *x = sx.c;
    store->exact_calls++;
    if (point == GXB_NONE || store->points[point].exact == NULL) {
        const int known = gxbp_short_side(store, kind, def, point, plane);
        if (known != GXBP_UNKNOWN) return known;
    }
    n = gxbp_exact_cplane(store, plane, &sn);
    if (point != GXB_NONE)
        x = gxbp_exact_cpoint(store, point, &sx);
    else {
        gxbp_vec_init(&sx);
        gxbp_exact_definition(store, kind, def, sx.c);
    }
    gxbp_exact_side(&r, x, n);
    return r.sign;
}

/* GXBP_UNKNOWN: neither definitions nor doubles tell. */
static inline int gxbp_filtered_side(gxb_store *store, const gxb_ball *ball, uint32_t kind, const uint32_t def[3],
                                     uint32_t point, uint32_t plane) {
    double bound, value;
    int sign;
    if (gxbp_incident(store, kind, def, point, plane)) return 0;
    store->filter_calls++;
    if (ball->error < GXBP_NO_BALL) {
        value = gxbp_filter_side(ball, &store->planes[plane].filter, &bound);
        sign = gxbp_filter_sign(value, bound);
        if (sign != 0) return sign;
    }
    return kind == GXB_THREE_PLANES && gxbp_incident_by_line(store, def, plane) ? 0 : GXBP_UNKNOWN;
}

static int gxbp_side_of(gxb_store *store, const gxb_ball *ball, uint32_t kind, const uint32_t def[3], uint32_t point,
                        uint32_t plane) {
    const int sign = gxbp_filtered_side(store, ball, kind, def, point, plane);
    return sign == GXBP_UNKNOWN ? gxbp_exact_sign(store, kind, def, point, plane) : sign;
}

static int gxbp_store_side(gxb_store *store, uint32_t point, uint32_t plane) {
    const gxb_cpoint *p = &store->points[point];
    return gxbp_side_of(store, &p->ball, p->kind, p->def, point, plane);
}

static GXBP_APART int gxbp_new_sign(gxb_store *store, uint32_t point, uint32_t plane, int slot) {
    const int sign = gxbp_store_side(store, point, plane);
    store->points[point].sign[slot] = (int8_t)sign;
    store->points[point].stamp[slot] = store->stamp[slot];
    return sign;
}

/* The side, remembered with the point: slot 0 for the triangle being inserted, slot 1 for its edges' planes. */
static int gxbp_sign(gxb_store *store, uint32_t point, uint32_t plane, int slot) {
    const gxb_cpoint *p = &store->points[point];
    return p->stamp[slot] == store->stamp[slot] ? p->sign[slot] : gxbp_new_sign(store, point, plane, slot);
}

static int gxbp_store_turn(gxb_store *store, uint32_t a, uint32_t b, uint32_t c, uint32_t plane) {
    const gxb_cplane *f = &store->planes[plane];
    const int i = (int)(f->axis + 1) % 3, j = (int)(f->axis + 2) % 3;
    int turn = 0;
    if (store->points[a].ball.error < GXBP_NO_BALL && store->points[b].ball.error < GXBP_NO_BALL &&
        store->points[c].ball.error < GXBP_NO_BALL)
        turn = gxbp_filter_turn(&store->points[a].ball, &store->points[b].ball, &store->points[c].ball, i, j);
    if (turn == 0) {
        gxbp_vec s[3];
        const gxb_num *x = gxbp_exact_cpoint(store, a, &s[0]), *y = gxbp_exact_cpoint(store, b, &s[1]),
                      *z = gxbp_exact_cpoint(store, c, &s[2]);
        turn = gxbp_orient_exact(x, y, z, i, j);
    }
    return turn * f->axis_sign;
}

static int gxbp_store_compare(gxb_store *store, uint32_t point, int axis, double value) {
    GXB_NUM(a);
    GXB_NUM(b);
    GXB_NUM(c);
    gxbp_vec own;
    const gxb_num *x = gxbp_exact_cpoint(store, point, &own);
    gxb_num_set(&a, value, store->shift);
    gxb_num_set(&b, store->origin[axis], store->shift);
    gxb_num_sub(&c, &a, &b);
    gxb_num_mul(&a, &c, &x[3]);
    gxb_num_sub(&b, &x[axis], &a);
    return b.sign;
}

/* A plane through three points, or (axis < 3) through two along a coordinate axis. */
static gx_result gxbp_new_plane(gxb_store *store, uint32_t p, uint32_t q, uint32_t r, int along_axis, uint32_t *id) {
    gx_result result = GXBP_RESERVE(&store->allocator, store, planes, plane, 1);
    gxb_cplane *f;
    double a[3], b[3] = {0, 0, 0}, ea, eb = 0;
    if (result != GX_OK) return result;
    *id = store->plane_count++;
    f = &store->planes[*id];
    memset(f, 0, sizeof *f);
    f->def[0] = p;
    f->def[1] = q;
    f->def[2] = r;
    f->along_axis = (uint8_t)along_axis;
    ea = gxbp_filter_difference(a, &store->points[p].ball, &store->points[q].ball);
    if (along_axis)
        b[r] = 1;
    else
        eb = gxbp_filter_difference(b, &store->points[p].ball, &store->points[r].ball);
    gxbp_filter_plane(&f->filter, &store->points[p].ball, a, ea, b, eb);
    return GX_OK;
}

static GXBP_COLD int gxbp_exact_normal_sign(gxb_store *store, uint32_t plane, uint32_t axis) {
    const gxb_cplane *f = &store->planes[plane];
    const double *x[3];
    gxbp_vec own;
    int sign[3];
    if (!f->along_axis && gxbp_given_points(store, f->def, 3, x) && gxbp_normal_short(x, sign)) return sign[axis];
    return gxbp_exact_cplane(store, plane, &own)[axis].sign;
}

/* Sign of one component of a plane's normal. */
static GXBP_APART int gxbp_normal_sign(gxb_store *store, uint32_t plane, uint32_t axis) {
    const gxb_plane_filter *f = &store->planes[plane].filter;
    const int sign = gxbp_filter_sign(f->n[axis], f->error);
    return sign != 0 ? sign : gxbp_exact_normal_sign(store, plane, axis);
}

/* Finds a component of the normal that is not 0, the largest where the filter can tell. 0: there is none. */
static int gxbp_plane_axis(gxb_store *store, uint32_t plane) {
    const double *n = store->planes[plane].filter.n;
    uint32_t axis = gxbp_abs(n[0]) >= gxbp_abs(n[1]) ? 0u : 1u, k;
    int sign;
    if (gxbp_abs(n[2]) > gxbp_abs(n[axis])) axis = 2;
    sign = gxbp_normal_sign(store, plane, axis);
    for (k = 0; k < 3 && sign == 0; k++) {
        axis = k;
        sign = gxbp_normal_sign(store, plane, axis);
    }
    store->planes[plane].axis = (uint8_t)axis;
    store->planes[plane].axis_sign = (int8_t)sign;
    return sign != 0;
}

/* Do the planes meet in a line? */
static GXBP_COLD int gxbp_planes_cross(gxb_store *store, uint32_t a, uint32_t b) {
    const gxb_plane_filter *f = &store->planes[a].filter, *g = &store->planes[b].filter;
    double r[3];
    const double bound = gxbp_cross_error(f->norm, f->error, g->norm, g->error);
    gxbp_vec sa, sb, cross;
    gxbp_cross(r, f->n, g->n);
    if (gxbp_max3(r) > bound) return 1;
    gxbp_vec_init(&cross);
    gxbp_num_cross(cross.c, gxbp_exact_cplane(store, a, &sa), gxbp_exact_cplane(store, b, &sb));
    return cross.c[0].sign != 0 || cross.c[1].sign != 0 || cross.c[2].sign != 0;
}

/* >>transaction: what begin, commit and rollback of a complex do --------------------------------------------------- */
/* In: a complex. Out: after a rollback, the complex as it was at begin. Each item is logged once, before its first
   change. */

typedef struct gxbp_corner { /* of a clipped polygon: its point, and what carries the edge to the next corner */
    gxb_ball ball;
    uint32_t kind, def[3], point;
    uint32_t carrier; /* a plane, or GXBP_TRIANGLE_EDGE + k */
    int32_t sign;
} gxbp_corner;

typedef struct gxbp_task {
    uint32_t parent, side, first, count, coplanar;
} gxbp_task;

#define GXBP_TRIANGLE_EDGE 0x80000000u
#define GXBP_IN_ROOT       GXB_NONE /* task.parent: the reference is the element's root */

static const gxbp_array gxbp_complex_arrays[] = {/* those with marks come first, as in gxb_complex.mark */
                                                 GXBP_ARRAY(gxb_complex, edges, edge),
                                                 GXBP_ARRAY(gxb_complex, facets, facet),
                                                 GXBP_ARRAY(gxb_complex, leaves, leaf),
                                                 GXBP_ARRAY(gxb_complex, nodes, tree),
                                                 GXBP_ARRAY(gxb_complex, labels, label),
                                                 GXBP_ARRAY(gxb_complex, pool, pool),
                                                 GXBP_ARRAY(gxb_complex, marked, marked),
                                                 GXBP_ARRAY(gxb_complex, corners, corner),
                                                 GXBP_ARRAY(gxb_complex, tasks, task),
                                                 GXBP_ARRAY(gxb_complex, leaf_facets, leaf_facet),
                                                 GXBP_ARRAY(gxb_complex, leaf_signs, leaf_sign),
                                                 GXBP_ARRAY(gxb_complex, rim, rim),
                                                 GXBP_ARRAY(gxb_complex, front_facets, front_facet),
                                                 GXBP_ARRAY(gxb_complex, behind_facets, behind_facet),
                                                 GXBP_ARRAY(gxb_complex, loop, loop),
                                                 GXBP_ARRAY(gxb_complex, inner_facets, inner_facet)};

enum { GXBP_MARKS = 6 };

/* Arrays whose items are logged before they change. The first four are those of gxbp_complex_arrays. */
enum { GXBP_EDGES, GXBP_FACETS, GXBP_LEAVES, GXBP_NODES, GXBP_POINTS, GXBP_ROOTS, GXBP_FACES, GXBP_MESH_EDGES };

static void *gxbp_item(gxb_complex *cx, uint32_t array, uint32_t index, size_t *size) {
    static const uint16_t pointer[] = {offsetof(gxb_complex, edges),        offsetof(gxb_complex, facets),
                                       offsetof(gxb_complex, leaves),       offsetof(gxb_complex, nodes),
                                       offsetof(gxb_complex, store.points), offsetof(gxb_complex, root),
                                       offsetof(gxb_complex, face_facet),   offsetof(gxb_complex, mesh_edge)};
    static const uint16_t item[] = {sizeof(gxb_edge),   sizeof(gxb_facet), sizeof(gxb_leaf), sizeof(gxb_node),
                                    sizeof(gxb_cpoint), sizeof(uint32_t),  sizeof(uint32_t), sizeof(uint32_t)};
    unsigned char *items;
    memcpy(&items, gxbp_field(cx, pointer[array]), sizeof items);
    *size = item[array];
    return items + index * *size;
}

/* Items older than the transaction. */
static uint32_t gxbp_item_mark(const gxb_complex *cx, uint32_t array) {
    return array < GXBP_POINTS ? cx->mark[array] : array == GXBP_POINTS ? cx->store.mark[0] : UINT32_MAX;
}

/* Logs an item that is about to change, unless it is newer than the transaction. Room was reserved. */
static void gxbp_save(gxb_complex *cx, uint32_t array, uint32_t index) {
    size_t size;
    const void *item = gxbp_item(cx, array, index, &size);
    if (index < gxbp_item_mark(cx, array)) gxbp_log(&cx->store, array, index, item, size);
}

/* Copies a list of the pool behind those already copied. */
static void gxbp_move_list(const gxb_complex *cx, uint32_t *pool, uint32_t *used, uint32_t *list, uint32_t count) {
    memcpy(pool + *used, cx->pool + *list, count * sizeof *pool);
    *list = *used;
    *used += count;
}

/* Lists that were replaced by longer ones stay in the pool; once they outweigh the others, the pool is renewed. Without
   memory for that it stays as it is. */
static GXBP_COLD void gxbp_compact_pool(gxb_complex *cx) {
    uint32_t *pool, used = 0, i;
    pool = (uint32_t *)gxbp_allocate(&cx->store.allocator, (size_t)cx->pool_capacity * sizeof *pool);
    if (pool == NULL) return;
    for (i = 0; i < cx->facet_count; i++) {
        gxb_facet *f = &cx->facets[i];
        if (f->loop_count > 0) gxbp_move_list(cx, pool, &used, &f->loop, f->loop_count);
    }
    for (i = 0; i < cx->leaf_count; i++)
        gxbp_move_list(cx, pool, &used, &cx->leaves[i].facets, cx->leaves[i].facet_count);
    gxbp_release(&cx->store.allocator, cx->pool, (size_t)cx->pool_capacity * sizeof *cx->pool);
    cx->pool = pool;
    cx->pool_count = cx->pool_live = used;
}

static GXBP_APART void gxbp_set_marks(gxb_complex *cx) {
    gxbp_store_begin(&cx->store);
    gxbp_mark_arrays(cx, gxbp_complex_arrays, cx->mark, GXBP_MARKS);
    cx->mark_live = cx->pool_live;
    cx->mark_removed = cx->removed_count;
    cx->marked_count = cx->corner_count = cx->task_count = 0;
}

GXFEM_API void gxb_complex_begin(gxb_complex *cx) {
    if (cx->pool_count / 2 >= cx->pool_live + 1024) gxbp_compact_pool(cx);
    gxbp_set_marks(cx);
}

GXFEM_API void gxb_complex_commit(gxb_complex *cx) { gxbp_set_marks(cx); }

/* A cache of planes, sides and points of three planes in pairs of doubles (see >>barycentric). The remainder of an
 * index is its place. */
enum { GXBP_PAIR_NORMALS = 32, GXBP_PAIR_SIDES = 256, GXBP_PAIR_POINTS = 32 };
typedef struct gxbp_pair {
    double high, low, error;
} gxbp_pair; /* a number within error of high + low */
/* The point of three planes: the first point of the first plane, less away / weight */
typedef struct gxbp_pair_point {
    uint32_t def[3];
    gxbp_pair away[3], weight;
} gxbp_pair_point;
typedef struct gxbp_pairs {
    /* GXB_NONE: empty */
    uint32_t plane[GXBP_PAIR_NORMALS], side_plane[GXBP_PAIR_SIDES], side_point[GXBP_PAIR_SIDES];
    gxbp_pair normal[GXBP_PAIR_NORMALS][3], side[GXBP_PAIR_SIDES];
    gxbp_pair_point point[GXBP_PAIR_POINTS];
} gxbp_pairs;

static void gxbp_forget_pairs(gxb_complex *cx) {
    uint32_t i;
    memset(cx->pairs->plane, 0xff, sizeof cx->pairs->plane);
    memset(cx->pairs->side_plane, 0xff, sizeof cx->pairs->side_plane);
    for (i = 0; i < GXBP_PAIR_POINTS; i++) cx->pairs->point[i].def[0] = GXB_NONE;
}

#define GXBP_LAST_STAMP 0x3fffffffu /* of an edge */

/* Begins a rim: no edge is in it. */
static void gxbp_forget_rim(gxb_complex *cx) {
    uint32_t i;
    if (cx->edge_stamp++ < GXBP_LAST_STAMP) return;
    for (i = 0; i < cx->edge_count; i++) cx->edges[i].stamp = 0;
    cx->edge_stamp = 1;
}

GXFEM_API GXBP_RARE void gxb_complex_rollback(gxb_complex *cx) {
    while (cx->store.undo_count > 0) {
        const gxb_undo undo = cx->store.undo[cx->store.undo_count - 1];
        size_t size;
        void *item = gxbp_item(cx, undo.array, undo.index, &size);
        gxbp_put_back(&cx->store, item, size);
        if (undo.array == GXBP_EDGES) cx->edges[undo.index].stamp = 0; /* it may be from before stamps were restarted */
        if (undo.array == GXBP_POINTS)
            cx->store.points[undo.index].stamp[0] = cx->store.points[undo.index].stamp[1] = 0;
    }
    gxbp_store_rollback(&cx->store);
    gxbp_cut_arrays(cx, gxbp_complex_arrays, cx->mark, GXBP_MARKS);
    cx->pool_live = cx->mark_live;
    cx->removed_count = cx->mark_removed;
    gxbp_forget_rim(cx);
    gxbp_forget_pairs(cx);
    gxbp_set_marks(cx);
}

GXFEM_API GXBP_RARE void gxb_complex_reserve(gxb_complex *cx, uint32_t times) {
    gxbp_expect_arrays(&cx->store.allocator, &cx->store, gxbp_store_arrays, cx->store.mark, 2, times);
    gxbp_expect_arrays(&cx->store.allocator, cx, gxbp_complex_arrays, cx->mark, GXBP_MARKS, times);
}

/* --- the store's points and planes, asked through the complex --- */

GXFEM_API gx_result gxb_complex_check_point(const gxb_complex *cx, const double x[3]) {
    return gxbp_store_check_point(&cx->store, x);
}

GXFEM_API gx_result gxb_complex_add_point(gxb_complex *cx, const double x[3], uint32_t *point) {
    return gxbp_store_add_point(&cx->store, x, point);
}

GXFEM_API int gxb_complex_side(gxb_complex *cx, uint32_t point, uint32_t plane) {
    return gxbp_store_side(&cx->store, point, plane);
}

GXFEM_API int gxb_complex_turn(gxb_complex *cx, uint32_t a, uint32_t b, uint32_t c, uint32_t plane) {
    return gxbp_store_turn(&cx->store, a, b, c, plane);
}

GXFEM_API int gxb_complex_compare(gxb_complex *cx, uint32_t point, int axis, double value) {
    return gxbp_store_compare(&cx->store, point, axis, value);
}

/* >>topology: the complex of a mesh -------------------------------------------------------------------------------- */
/* In: nodes and elements. Out: a complex with one leaf for each element, four facets each, shared with its
   neighbours. */

GXFEM_API gx_result gxb_complex_add_plane(gxb_complex *cx, gxb_triangle *t) {
    const gx_result result = gxbp_new_plane(&cx->store, t->point[0], t->point[1], t->point[2], 0, &t->plane);
    if (result != GX_OK) return result;
    t->orientation = 1;
    t->edge_plane[0] = t->edge_plane[1] = t->edge_plane[2] = GXB_NONE;
    return gxbp_plane_axis(&cx->store, t->plane) ? GX_OK : GX_ERROR_FLAT;
}

/* --- faces and edges of the mesh, by sorting. Face 4 x element + k is opposite to node k; edge k is 6 x element + k */

/* outward, opposite to node k */
static const uint8_t gxbp_face_nodes[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
static const uint8_t gxbp_edge_nodes[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static GXBP_APART void gxbp_sort3(uint32_t a[3]) {
    uint32_t t;
    if (a[0] > a[1]) {
        t = a[0];
        a[0] = a[1];
        a[1] = t;
    }
    if (a[1] > a[2]) {
        t = a[1];
        a[1] = a[2];
        a[2] = t;
    }
    if (a[0] > a[1]) {
        t = a[0];
        a[0] = a[1];
        a[1] = t;
    }
}

/* 1 where the outward order of the element's face is an even permutation of the sorted nodes */
static int gxbp_face_is_even(const uint32_t *element, uint32_t face) {
    const uint32_t a = element[gxbp_face_nodes[face][0]], b = element[gxbp_face_nodes[face][1]],
                   c = element[gxbp_face_nodes[face][2]];
    return (a < b) == ((b < c) == (a < c));
}

/* Ascending nodes of an element's face (size 3) or edge (size 2) */
static void gxbp_nodes_of(const gxb_complex *cx, uint32_t which, int size, uint32_t node[3]) {
    if (size == 3) {
        const uint32_t *n = cx->elements + 4 * (which / 4);
        const uint8_t *face = gxbp_face_nodes[which % 4];
        const uint32_t a = n[face[0]], b = n[face[1]], c = n[face[2]], low = a < b ? a : b, high = a < b ? b : a;
        node[0] = c < low ? c : low;
        node[2] = c > high ? c : high;
        node[1] = a + b + c - node[0] - node[2];
    } else {
        const uint32_t *n = cx->elements + 4 * (which / 6);
        const uint32_t a = n[gxbp_edge_nodes[which % 6][0]], b = n[gxbp_edge_nodes[which % 6][1]];
        node[0] = a < b ? a : b;
        node[1] = a < b ? b : a;
        node[2] = 0;
    }
}

/* Sorts the faces (size 3) or edges (size 2) of all elements by their nodes: a stable sort by each node, the last one
   first [radix sort, Knuth vol. 3, 5.2.5]. to, other: room for all of them each; place: room for node_count + 1.
   Returns the one with the result. */
static uint32_t *gxbp_sort_parts(const gxb_complex *cx, int size, uint32_t *to, uint32_t *other, uint32_t *place) {
    const uint32_t count = cx->element_count * (size == 3 ? 4 : 6);
    uint32_t *from = NULL, node[3], i;
    int digit = size;
    while (digit-- > 0) {
        memset(place, 0, ((size_t)cx->node_count + 1) * sizeof *place);
        for (i = 0; i < count; i++) {
            gxbp_nodes_of(cx, i, size, node);
            place[node[digit] + 1]++;
        }
        for (i = 0; i < cx->node_count; i++) place[i + 1] += place[i];
        for (i = 0; i < count; i++) {
            const uint32_t which = from == NULL ? i : from[i];
            gxbp_nodes_of(cx, which, size, node);
            to[place[node[digit]]++] = which;
        }
        from = to;
        to = other;
        other = from;
    }
    return from;
}

/* Numbers the faces in the order of their sorted nodes. Sorts in tables that are filled later. */
static gx_result gxbp_number_faces(gxb_complex *cx, uint32_t *place, size_t *bad) {
    const uint32_t count = cx->element_count * 4,
                   *sorted = gxbp_sort_parts(cx, 3, cx->element_edges, cx->mesh_edge, place);
    uint32_t before[3] = {0, 0, 0}, node[3], i;
    cx->face_count = 0;
    for (i = 0; i < count; i++) {
        /* side 1: the element lies behind the face, whose normal is that of the sorted nodes */
        const uint32_t e = sorted[i] / 4, k = sorted[i] % 4,
                       side = (uint32_t)gxbp_face_is_even(cx->elements + 4 * e, k);
        uint32_t *sides;
        gxbp_nodes_of(cx, sorted[i], 3, node);
        if (memcmp(node, before, sizeof node) != 0) {
            memcpy(before, node, sizeof node);
            cx->face_elements[2 * cx->face_count] = cx->face_elements[2 * cx->face_count + 1] = GXB_NONE;
            cx->face_count++;
        }
        sides = cx->face_elements + 2 * (size_t)(cx->face_count - 1);
        if (sides[side] != GXB_NONE) {
            *bad = e;
            return GX_ERROR_OVERLAP;
        }
        sides[side] = e;
        cx->element_faces[sorted[i]] = cx->face_count - 1;
    }
    return GX_OK;
}

static void gxbp_number_edges(gxb_complex *cx, uint32_t *place) {
    const uint32_t count = cx->element_count * 6,
                   *sorted = gxbp_sort_parts(cx, 2, cx->element_edges, cx->mesh_edge, place);
    uint32_t before[3] = {0, 0, 0}, node[3], i;
    cx->mesh_edge_count = 0;
    for (i = 0; i < count; i++) {
        gxbp_nodes_of(cx, sorted[i], 2, node);
        if (memcmp(node, before, sizeof node) != 0) cx->mesh_edge_count++;
        memcpy(before, node, sizeof node);
        cx->element_edges[sorted[i]] = cx->mesh_edge_count - 1;
    }
}

static gx_result gxbp_add_nodes(gxb_complex *cx, const gxb_mesh *mesh, size_t *bad) {
    size_t i;
    gx_result result = GXBP_RESERVE(&cx->store.allocator, &cx->store, points, point, mesh->node_count);
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
        sign = gxb_orient3d(x[1], x[2], x[3], x[0]); /* node 0 lies behind face 123 as seen from outside: below it */
        if (sign == 0) return GX_ERROR_FLAT;
        if (sign < 0) return GX_ERROR_INVERTED;
    }
    *bad = SIZE_MAX;
    return GX_OK;
}

static gx_result gxbp_make_leaves(gxb_complex *cx) {
    uint32_t e;
    const gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, leaves, leaf, cx->element_count);
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
    const size_t place_bytes = (mesh->node_count + 1) * sizeof(uint32_t);
    gx_result result = gxbp_choose_frame(&cx->store, mesh->positions, mesh->node_count, bad);
    uint32_t *place;
    memcpy(table, mesh->elements, n * 4 * sizeof *table);
    cx->elements = table;
    cx->element_faces = table + 4 * n;
    cx->element_edges = table + 8 * n;
    cx->face_elements = table + 14 * n;
    cx->face_facet = table + 22 * n;
    cx->mesh_edge = table + 26 * n;
    cx->root = table + 32 * n;
    if (result == GX_OK) result = gxbp_check_elements(cx, mesh, bad);
    if (result == GX_OK) result = gxbp_add_nodes(cx, mesh, bad);
    if (result != GX_OK) return result;
    place = (uint32_t *)gxbp_allocate(&cx->store.allocator, place_bytes);
    if (place == NULL) return GX_ERROR_MEMORY;
    result = gxbp_number_faces(cx, place, bad);
    if (result == GX_OK) gxbp_number_edges(cx, place);
    gxbp_release(&cx->store.allocator, place, place_bytes);
    return result == GX_OK ? gxbp_make_leaves(cx) : result;
}

/* A result that blames nothing that was given: success, or a lack of memory */
static gx_result gxbp_end(gx_failure *failure, gx_result result) {
    if (failure != NULL) {
        failure->result = result;
        failure->field = NULL;
        failure->index = failure->surface = SIZE_MAX;
    }
    return result;
}

static GXBP_COLD gx_result gxbp_fail(gx_failure *failure, gx_result result, const char *field, size_t index) {
    gxbp_end(failure, result);
    if (failure != NULL) failure->field = field, failure->index = index;
    return result;
}

static GXBP_COLD gx_result gxbp_refuse(gx_failure *failure, const char *field) {
    return gxbp_fail(failure, GX_ERROR_ARGUMENT, field, SIZE_MAX);
}

/* The field to blame for what reading points, and elements or triangles of them, came to */
static const char *gxbp_blamed(gx_result result, const char *points, const char *polygons) {
    switch (result) {
    case GX_ERROR_NOT_FINITE:
    case GX_ERROR_RANGE: return points;
    case GX_ERROR_INDEX:
    case GX_ERROR_INVERTED:
    case GX_ERROR_FLAT:
    case GX_ERROR_OVERLAP:
    case GX_ERROR_NOT_CLOSED: return polygons;
    default: return NULL;
    }
}

/* allocate and release, or neither, and reallocate only with them */
GXFEM_API int gxb_is_allocator(const gx_allocator *a) {
    return a->allocate == NULL ? a->release == NULL && a->reallocate == NULL : a->release != NULL;
}

GXFEM_API GXBP_RARE void gxb_complex_destroy(gxb_complex *cx) {
    gx_allocator a;
    if (cx == NULL) return;
    a = cx->store.allocator;
    gxbp_store_destroy(&cx->store);
    gxbp_drop_arrays(&a, cx, gxbp_complex_arrays, sizeof gxbp_complex_arrays / sizeof *gxbp_complex_arrays);
    gxbp_release(&a, cx->elements, gxbp_table_words(cx->element_count) * sizeof *cx->elements);
    gxbp_release(&a, cx->pairs, sizeof *cx->pairs);
    gxbp_release(&a, cx, sizeof *cx);
}

static gx_result gxbp_check_mesh(const gxb_mesh *mesh, gx_failure *failure) {
    if (mesh->node_count == 0) return gxbp_fail(failure, GX_ERROR_EMPTY, "node_count", SIZE_MAX);
    if (mesh->element_count == 0) return gxbp_fail(failure, GX_ERROR_EMPTY, "element_count", SIZE_MAX);
    if (mesh->positions == NULL) return gxbp_refuse(failure, "positions");
    if (mesh->elements == NULL) return gxbp_refuse(failure, "elements");
    if (mesh->element_count > INT32_MAX / 8 || mesh->element_count > SIZE_MAX / 256)
        return gxbp_fail(failure, GX_ERROR_LIMIT, "element_count", SIZE_MAX);
    if (mesh->node_count > INT32_MAX) return gxbp_fail(failure, GX_ERROR_LIMIT, "node_count", SIZE_MAX);
    return GX_OK;
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
    if (mesh == NULL) return gxbp_refuse(failure, "mesh");
    if (complex == NULL) return gxbp_refuse(failure, "complex");
    if (!gxb_is_allocator(allocator)) return gxbp_refuse(failure, "allocator");
    result = gxbp_check_mesh(mesh, failure);
    if (result != GX_OK) return result;
    if (!gxbp_arithmetic_holds(1)) return gxbp_end(failure, GX_ERROR_CONFIGURATION);
    cx = (gxb_complex *)gxbp_allocate(allocator, sizeof *cx);
    if (cx == NULL) return gxbp_end(failure, GX_ERROR_MEMORY);
    memset(cx, 0, sizeof *cx);
    cx->store.allocator = *allocator;
    cx->node_count = (uint32_t)mesh->node_count;
    cx->element_count = (uint32_t)mesh->element_count;
    cx->settled = mesh->node_count;
    table = (uint32_t *)gxbp_allocate(allocator, gxbp_table_words(mesh->element_count) * sizeof *table);
    cx->elements = table;
    cx->pairs = (gxbp_pairs *)gxbp_allocate(allocator, sizeof *cx->pairs);
    result = table == NULL || cx->pairs == NULL ? GX_ERROR_MEMORY : gxbp_fill_complex(cx, mesh, table, &bad);
    if (result != GX_OK) {
        gxb_complex_destroy(cx);
        return gxbp_fail(failure, result, gxbp_blamed(result, "positions", "elements"), bad);
    }
    cx->store.stamp[0] = cx->store.stamp[1] = cx->edge_stamp = 1;
    gxbp_forget_pairs(cx);
    gxb_complex_begin(cx);
    *complex = cx;
    return gxbp_end(failure, GX_OK);
}

/* >>access: reading a complex ------------------------------------------------------------------------------------- */

/* In: a complex and an index. Out: the item. Nothing changes. gxfem.h reads the arrays by these functions only. They
   are small enough to be inlined. */

static uint32_t gxbp_edge_start(const gxb_complex *cx, uint32_t signed_edge) {
    return cx->edges[signed_edge >> 1].v[signed_edge & 1];
}

GXFEM_API const gxb_cpoint *gxb_complex_point(const gxb_complex *cx, uint32_t point) {
    return &cx->store.points[point];
}

GXFEM_API const gxb_cplane *gxb_complex_plane(const gxb_complex *cx, uint32_t plane) {
    return &cx->store.planes[plane];
}

GXFEM_API const gxb_edge *gxb_complex_edge(const gxb_complex *cx, uint32_t edge) { return &cx->edges[edge]; }

GXFEM_API const gxb_facet *gxb_complex_facet(const gxb_complex *cx, uint32_t facet) { return &cx->facets[facet]; }

GXFEM_API const gxb_leaf *gxb_complex_leaf(const gxb_complex *cx, uint32_t leaf) { return &cx->leaves[leaf]; }

GXFEM_API const gxb_node *gxb_complex_tree_node(const gxb_complex *cx, uint32_t node) { return &cx->nodes[node]; }

GXFEM_API const gxb_label *gxb_complex_label(const gxb_complex *cx, uint32_t label) { return &cx->labels[label]; }

GXFEM_API const uint32_t *gxb_complex_list(const gxb_complex *cx, uint32_t first) { return cx->pool + first; }

GXFEM_API uint32_t gxb_complex_edge_start(const gxb_complex *cx, uint32_t signed_edge) {
    return gxbp_edge_start(cx, signed_edge);
}

GXFEM_API uint32_t gxb_complex_point_count(const gxb_complex *cx) { return cx->store.point_count; }

GXFEM_API uint32_t gxb_complex_facet_count(const gxb_complex *cx) { return cx->facet_count; }

GXFEM_API uint32_t gxb_complex_leaf_count(const gxb_complex *cx) { return cx->leaf_count; }

GXFEM_API uint32_t gxb_complex_label_count(const gxb_complex *cx) { return cx->label_count; }

GXFEM_API uint32_t gxb_complex_marked_count(const gxb_complex *cx) { return cx->marked_count; }

GXFEM_API uint32_t gxb_complex_marked_facet(const gxb_complex *cx, uint32_t index) { return cx->marked[index] >> 1; }

GXFEM_API int gxb_complex_marked_wall(const gxb_complex *cx, uint32_t index) { return (int)(cx->marked[index] & 1); }

GXFEM_API uint32_t gxb_complex_node_count(const gxb_complex *cx) { return cx->node_count; }

GXFEM_API uint32_t gxb_complex_element_count(const gxb_complex *cx) { return cx->element_count; }

GXFEM_API uint32_t gxb_complex_face_count(const gxb_complex *cx) { return cx->face_count; }

GXFEM_API uint32_t gxb_complex_mesh_edge_count(const gxb_complex *cx) { return cx->mesh_edge_count; }

GXFEM_API const uint32_t *gxb_complex_element_nodes(const gxb_complex *cx, uint32_t element) {
    return cx->elements + 4 * (size_t)element;
}

GXFEM_API const uint32_t *gxb_complex_element_faces(const gxb_complex *cx, uint32_t element) {
    return cx->element_faces + 4 * (size_t)element;
}

GXFEM_API const uint32_t *gxb_complex_element_edges(const gxb_complex *cx, uint32_t element) {
    return cx->element_edges + 6 * (size_t)element;
}

GXFEM_API const uint32_t *gxb_complex_face_elements(const gxb_complex *cx, uint32_t face) {
    return cx->face_elements + 2 * (size_t)face;
}

GXFEM_API uint32_t gxb_complex_face_facet(const gxb_complex *cx, uint32_t face) { return cx->face_facet[face]; }

GXFEM_API uint32_t gxb_complex_mesh_edge(const gxb_complex *cx, uint32_t mesh_edge) { return cx->mesh_edge[mesh_edge]; }

GXFEM_API uint32_t gxb_complex_root(const gxb_complex *cx, uint32_t element) { return cx->root[element]; }

GXFEM_API const double *gxb_complex_origin(const gxb_complex *cx) { return cx->store.origin; }

GXFEM_API int gxb_complex_shift(const gxb_complex *cx) { return cx->store.shift; }

GXFEM_API void gxb_complex_prefetch_element(const gxb_complex *cx, uint32_t element) {
    GXBP_FETCH(&cx->leaves[element]);
    GXBP_FETCH(cx->element_faces + 4 * (size_t)element);
    GXBP_FETCH(cx->element_edges + 6 * (size_t)element);
    GXBP_FETCH(cx->root + element);
    (void)cx;
    (void)element;
}

/* >>places: the leaf at a point given by doubles ------------------------------------------------------------------- */
/* In: an element and a point that the complex need not have. Out: the leaf that has the point, exactly. Keeps exact
   numbers of planes; nothing else changes. */

typedef struct gxbp_place {
    const double *given;
    gxb_ball ball;
    gxbp_vec exact; /* in the frame */
    int is_exact;   /* exact is there */
} gxbp_place;

/* Where the origin is 0, scaling by a power of two is exact: the point is in range, so nothing under- or overflows. */
static void gxbp_place_init(const gxb_store *store, const double x[3], gxbp_place *place) {
    const int moved =
        !gxbp_is_zero(store->origin[0]) || !gxbp_is_zero(store->origin[1]) || !gxbp_is_zero(store->origin[2]);
    int k;
    place->given = x;
    place->is_exact = 0;
    place->ball.error = GXBP_NO_BALL;
    if (store->shift < -800 || store->shift > 800) return;
    for (k = 0; k < 3; k++)
        place->ball.x[k] = gxbp_fence(gxbp_fence(x[k] - store->origin[k]) * gxbp_power(store->shift));
    place->ball.error = moved ? 4 * GXBP_U * gxbp_max3(place->ball.x) + GXBP_TINY : 0;
}

static GXBP_COLD int gxbp_place_exact_side(gxb_store *store, gxbp_place *place, uint32_t plane) {
    const gxb_cplane *f = &store->planes[plane];
    const double *x[4];
    GXB_NUM(r);
    gxbp_vec own;
    store->exact_calls++;
    if (!(place->ball.error > 0) && !f->along_axis && gxbp_given_points(store, f->def, 3, x)) {
        int turn;
        x[3] = place->ball.x;
        turn = gxbp_orient3d_short(x);
        if (turn != GXBP_UNKNOWN) return -turn;
    }
    if (!place->is_exact) (void)gxbp_frame_exact(store, place->given, &place->exact);
    place->is_exact = 1;
    gxbp_exact_side(&r, place->exact.c, gxbp_exact_cplane(store, plane, &own));
    return r.sign;
}

static int gxbp_place_side(gxb_store *store, gxbp_place *place, uint32_t plane) {
    store->filter_calls++;
    if (place->ball.error < GXBP_NO_BALL) {
        double bound;
        const double value = gxbp_filter_side(&place->ball, &store->planes[plane].filter, &bound);
        const int sign = gxbp_filter_sign(value, bound);
        if (sign != 0) return sign;
    }
    return gxbp_place_exact_side(store, place, plane);
}

GXFEM_API uint32_t gxb_complex_leaf_at(gxb_complex *cx, uint32_t element, const double x[3], const double toward[3],
                                       int *on) {
    uint32_t reference = cx->root[element];
    gxbp_place at, then;
    gxbp_place_init(&cx->store, x, &at);
    then.given = NULL;
    if (on != NULL) *on = 0;
    while (reference & 1) {
        const gxb_node *node = &cx->nodes[reference >> 1];
        int side = gxbp_place_side(&cx->store, &at, node->plane);
        if (side == 0) {
            if (on != NULL) *on = 1;
            if (toward != NULL && then.given == NULL) gxbp_place_init(&cx->store, toward, &then);
            if (toward != NULL) side = gxbp_place_side(&cx->store, &then, node->plane);
        }
        reference = node->child[side < 0];
    }
    return reference >> 1;
}

/* >>split: dividing edges, facets and leaves by a plane ------------------------------------------------------------ */
/* In: a leaf and a splitting plane. Out: two leaves with the facet between them, and divided facets and edges. Every
   function here that can run out of memory reserves room first. It then changes the complex without a way to fail. */

static void gxbp_set_loop(gxb_facet *f, uint32_t first, uint32_t count) {
    f->loop = first;
    f->loop_count = count & INT32_MAX;
}

/* A divided facet (edge) is the root of a binary tree. These functions visit its undivided parts, in order. */
static GXBP_APART uint32_t gxbp_count_facets(const gxb_complex *cx, uint32_t facet) {
    const uint32_t child = cx->facets[facet].child;
    return child == GXB_NONE ? 1 : gxbp_count_facets(cx, child) + gxbp_count_facets(cx, child + 1);
}

/* Lists them. Returns the end of the list. */
static GXBP_APART uint32_t *gxbp_list_facets(const gxb_complex *cx, uint32_t facet, uint32_t *out) {
    const uint32_t child = cx->facets[facet].child;
    if (child != GXB_NONE) return gxbp_list_facets(cx, child + 1, gxbp_list_facets(cx, child, out));
    *out = facet;
    return out + 1;
}

/* How many facets a leaf has when they are resolved */
static uint32_t gxbp_count_list(const gxb_complex *cx, const gxb_leaf *l) {
    uint32_t i, count = 0;
    for (i = 0; i < l->facet_count; i++) {
        const gxb_facet *f = &cx->facets[cx->pool[l->facets + i]];
        if (f->child == GXB_NONE) GXBP_FETCH(cx->pool + f->loop);
        count += f->child == GXB_NONE ? 1 : gxbp_count_facets(cx, cx->pool[l->facets + i]);
    }
    return count;
}

static GXBP_APART uint32_t gxbp_count_edges(const gxb_complex *cx, uint32_t edge) {
    const uint32_t child = cx->edges[edge].child;
    return child == GXB_NONE ? 1 : gxbp_count_edges(cx, child) + gxbp_count_edges(cx, child + 1);
}

/* How many edges a facet's loop has when it is resolved */
static uint32_t gxbp_count_loop(const gxb_complex *cx, uint32_t facet) {
    const gxb_facet *f = &cx->facets[facet];
    uint32_t i, count = 0;
    for (i = 0; i < f->loop_count; i++) {
        const uint32_t edge = cx->pool[f->loop + i] >> 1;
        count += cx->edges[edge].child == GXB_NONE ? 1 : gxbp_count_edges(cx, edge);
    }
    return count;
}

static void gxbp_push_edges(gxb_complex *cx, uint32_t signed_edge) {
    const uint32_t child = cx->edges[signed_edge >> 1].child, back = signed_edge & 1;
    if (child == GXB_NONE)
        cx->pool[cx->pool_count++] = signed_edge;
    else {
        gxbp_push_edges(cx, (child + back) << 1 | back);
        gxbp_push_edges(cx, (child + 1 - back) << 1 | back);
    }
}

GXFEM_API gx_result gxb_facet_resolve_edges(gxb_complex *cx, uint32_t facet, uint32_t *first, uint32_t *count) {
    gxb_facet *f = &cx->facets[facet];
    const uint32_t total = gxbp_count_loop(cx, facet);
    if (total != f->loop_count) {
        const uint32_t start = cx->pool_count;
        uint32_t i;
        gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, pool, pool, total);
        if (result == GX_OK) result = gxbp_reserve_undo(&cx->store, 1);
        if (result != GX_OK) return result;
        gxbp_save(cx, GXBP_FACETS, facet);
        for (i = 0; i < f->loop_count; i++) gxbp_push_edges(cx, cx->pool[f->loop + i]);
        cx->pool_live += total - f->loop_count;
        gxbp_set_loop(f, start, total);
    }
    *first = f->loop;
    *count = f->loop_count;
    return GX_OK;
}

GXFEM_API gx_result gxb_leaf_resolve_facets(gxb_complex *cx, uint32_t leaf, uint32_t *first, uint32_t *count) {
    gxb_leaf *l = &cx->leaves[leaf];
    const uint32_t total = gxbp_count_list(cx, l);
    if (total != l->facet_count) {
        uint32_t i, *out;
        gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, pool, pool, total);
        if (result == GX_OK) result = gxbp_reserve_undo(&cx->store, 1);
        if (result != GX_OK) return result;
        gxbp_save(cx, GXBP_LEAVES, leaf);
        out = cx->pool + cx->pool_count;
        for (i = 0; i < l->facet_count; i++) out = gxbp_list_facets(cx, cx->pool[l->facets + i], out);
        cx->pool_live += total - l->facet_count;
        l->facets = cx->pool_count;
        l->facet_count = total;
        cx->pool_count += total;
    }
    *first = l->facets;
    *count = l->facet_count;
    return GX_OK;
}

/* The splitting plane. explicit_line: the facets to be divided meet it in a triangle's edge, the line through two
 * points. */
typedef struct gxbp_splitter {
    uint32_t plane, line[2];
    int explicit_line, slot;
} gxbp_splitter;

/* Reserves room to divide these numbers of facets and of their edges. */
static gx_result gxbp_reserve_split(gxb_complex *cx, size_t facets, size_t edges) {
    gx_result result = GXBP_RESERVE(&cx->store.allocator, &cx->store, points, point, edges + 2);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, edges, edge, 2 * edges + facets + 4);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, facets, facet, 2 * facets + 2);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, leaves, leaf, 1);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, nodes, tree, 1);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, pool, pool, 8 * (edges + facets) + 64);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, loop, loop, edges + 2); /* two are divided */
    return result == GX_OK ? gxbp_reserve_undo(&cx->store, edges + 3 * facets + 8) : result;
}

static uint32_t gxbp_new_edge(gxb_complex *cx, uint32_t a, uint32_t b, const uint32_t line[2], uint32_t explicit_line) {
    gxb_edge *e = &cx->edges[cx->edge_count];
    memset(e, 0, sizeof *e);
    e->v[0] = a;
    e->v[1] = b;
    e->line[0] = line[0];
    e->line[1] = line[1];
    e->explicit_line = explicit_line & 1;
    e->child = GXB_NONE;
    return cx->edge_count++;
}

/* A given point of the edge's line that is in the plane by definition, as where two edges of a triangle meet; GXB_NONE:
 * there is none. */
static uint32_t gxbp_given_crossing(const gxb_complex *cx, const gxb_edge *e, uint32_t plane) {
    uint32_t i;
    for (i = 0; i < 2 && e->explicit_line; i++)
        if (gxbp_incident(&cx->store, GXB_EXPLICIT, NULL, e->line[i], plane)) return e->line[i];
    return GXB_NONE;
}

/* The point in which the plane crosses an edge: a new one, unless it has been given. Room was reserved. */
static uint32_t gxbp_cross_edge(gxb_complex *cx, const gxb_edge *e, uint32_t plane) {
    uint32_t id = gxbp_given_crossing(cx, e, plane);
    gxb_cpoint *p;
    if (id != GXB_NONE) return id;
    id = cx->store.point_count++;
    p = &cx->store.points[id];
    memset(p, 0, sizeof *p);
    p->parameter[0] = -1;
    p->name = cx->store.next_name++;
    p->kind = e->explicit_line ? GXB_LINE_PLANE : GXB_THREE_PLANES;
    p->def[0] = e->line[0];
    p->def[1] = e->line[1];
    p->def[2] = plane;
    gxbp_definition_ball(&cx->store, p->kind, p->def, &p->ball);
    return id;
}

/* Divides the edge where the plane crosses it; its ends lie strictly on either side. */
static void gxbp_split_edge(gxb_complex *cx, uint32_t edge, const gxbp_splitter *splitter) {
    const gxb_edge e = cx->edges[edge];
    const uint32_t id = gxbp_cross_edge(cx, &e, splitter->plane);
    cx->store.points[id].stamp[splitter->slot] = cx->store.stamp[splitter->slot];
    cx->store.points[id].sign[splitter->slot] = 0;
    gxbp_save(cx, GXBP_EDGES, edge);
    cx->edges[edge].child = cx->edge_count;
    gxbp_new_edge(cx, e.v[0], id, e.line, e.explicit_line);
    gxbp_new_edge(cx, id, e.v[1], e.line, e.explicit_line);
    cx->edges[cx->edge_count - 2].wall = cx->edges[cx->edge_count - 1].wall = e.wall;
}

/* Signs of a facet's points. Bit 1: some lie in front of the plane. Bit 2: some lie behind it. The higher bits: how
   many lie in it. *edges: the length of its resolved loop */
static uint32_t gxbp_facet_signs(gxb_complex *cx, uint32_t facet, const gxbp_splitter *splitter, uint32_t *edges) {
    const uint32_t *loop = cx->pool + cx->facets[facet].loop, *end = loop + cx->facets[facet].loop_count;
    uint32_t signs = 0, count = 0;
    for (; loop < end; loop++) {
        static const uint8_t add[3] = {2, 4, 1};
        const gxb_edge *e = &cx->edges[*loop >> 1];
        const uint32_t one = add[1 + gxbp_sign(&cx->store, e->v[*loop & 1], splitter->plane, splitter->slot)];
        signs = one == 4 ? signs + 4 : signs | one;
        count += e->child == GXB_NONE ? 1 : gxbp_count_edges(cx, *loop >> 1);
    }
    *edges = count;
    return signs;
}

/* On which sides of the plane the facet has points: bit 1 in front, bit 2 behind */
static int gxbp_facet_sides(gxb_complex *cx, uint32_t facet, const gxbp_splitter *splitter) {
    const uint32_t *loop = cx->pool + cx->facets[facet].loop, *end = loop + cx->facets[facet].loop_count;
    int sides = 0;
    for (; loop < end && sides != 3; loop++) {
        const int sign = gxbp_sign(&cx->store, gxbp_edge_start(cx, *loop), splitter->plane, splitter->slot);
        sides |= sign > 0 ? 1 : sign < 0 ? 2 : 0;
    }
    return sides;
}

/* A facet's loop while it is divided, in complex.loop. zero: where the two points in the plane start edges. sign: the
   side that the next edge starts on */
typedef struct gxbp_parting {
    uint32_t *loop, count, zero[2], zeros;
    int sign;
} gxbp_parting;

/* Appends an edge that starts on the side parting->sign, or its parts. Divides it where the plane crosses it. */
static void gxbp_part_edge(gxb_complex *cx, uint32_t signed_edge, const gxbp_splitter *splitter,
                           gxbp_parting *parting) {
    const uint32_t back = signed_edge & 1;
    const gxb_edge *e = &cx->edges[signed_edge >> 1];
    uint32_t child = e->child;
    const int from = parting->sign;
    if (child != GXB_NONE) {
        gxbp_part_edge(cx, (child + back) << 1 | back, splitter, parting);
        gxbp_part_edge(cx, (child + 1 - back) << 1 | back, splitter, parting);
        return;
    }
    parting->sign = gxbp_sign(&cx->store, e->v[1 - back], splitter->plane, splitter->slot);
    if (from == 0 && parting->zeros < 2) parting->zero[parting->zeros++] = parting->count;
    if (from * parting->sign >= 0) {
        parting->loop[parting->count++] = signed_edge;
        return;
    }
    child = cx->edge_count;
    gxbp_split_edge(cx, signed_edge >> 1, splitter);
    parting->loop[parting->count++] = (child + back) << 1 | back;
    if (parting->zeros < 2) parting->zero[parting->zeros++] = parting->count;
    parting->loop[parting->count++] = (child + 1 - back) << 1 | back;
}

/* The room of a replaced list that no rollback needs. One of its replacements may take it. */
typedef struct gxbp_gap {
    uint32_t first, count;
} gxbp_gap;

static gxbp_gap gxbp_list_gap(const gxb_complex *cx, uint32_t first, uint32_t count) {
    gxbp_gap gap;
    gap.first = first;
    gap.count = first >= cx->mark[5] ? count : 0;
    return gap;
}

/* The place of a new list in the pool: in the gap if it fits, else behind all others */
static uint32_t gxbp_place_list(gxb_complex *cx, uint32_t count, gxbp_gap *gap) {
    const uint32_t end = cx->pool_count;
    if (count <= gap->count) {
        gap->count = 0;
        return gap->first;
    }
    cx->pool_count += count;
    return end;
}

static void gxbp_copy_arc(gxb_complex *cx, const gxbp_parting *parting, uint32_t from, uint32_t to, uint32_t closing,
                          gxbp_gap *gap, gxb_facet *child) {
    const uint32_t count = (to > from ? 0 : parting->count) + to - from + 1;
    uint32_t i, *out;
    gxbp_set_loop(child, gxbp_place_list(cx, count, gap), count);
    out = cx->pool + child->loop;
    for (i = from; i != to; i = i + 1 == parting->count ? 0 : i + 1) *out++ = parting->loop[i];
    *out = closing;
}

/* Divides a facet that has points on both sides of the plane. Its children are child (in front) and child + 1. Returns
   the new edge, signed as the front child walks it. */
static uint32_t gxbp_split_facet(gxb_complex *cx, uint32_t facet, const gxbp_splitter *splitter) {
    const gxb_facet f = cx->facets[facet];
    const uint32_t child = cx->facet_count, *zero;
    uint32_t line[2], edge, front, i;
    gxbp_gap gap = gxbp_list_gap(cx, f.loop, f.loop_count);
    gxbp_parting parting;
    memset(&parting, 0, sizeof parting);
    parting.loop = cx->loop;
    zero = parting.zero;
    parting.sign = gxbp_sign(&cx->store, gxbp_edge_start(cx, cx->pool[f.loop]), splitter->plane, splitter->slot);
    for (i = 0; i < f.loop_count; i++) gxbp_part_edge(cx, cx->pool[f.loop + i], splitter, &parting);
    line[0] = splitter->explicit_line ? splitter->line[0] : f.plane;
    line[1] = splitter->explicit_line ? splitter->line[1] : splitter->plane;
    edge = gxbp_new_edge(cx, gxbp_edge_start(cx, parting.loop[zero[0]]), gxbp_edge_start(cx, parting.loop[zero[1]]),
                         line, (uint32_t)splitter->explicit_line);
    front = gxbp_sign(&cx->store, gxbp_edge_start(cx, parting.loop[zero[0] + 1]), splitter->plane, splitter->slot) > 0
              ? 0u
              : 1u;
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->facets[facet].child = child;
    gxbp_set_loop(&cx->facets[facet], splitter->plane, 0);
    cx->facets[child] = f;
    cx->facets[child + 1] = f;
    /* arc 0 runs from zero[0] to zero[1] and is closed backwards along the edge, arc 1 is the rest, closed forwards */
    gxbp_copy_arc(cx, &parting, zero[front], zero[1 - front], edge << 1 | (1u - front), &gap, &cx->facets[child]);
    gxbp_copy_arc(cx, &parting, zero[1 - front], zero[front], edge << 1 | front, &gap, &cx->facets[child + 1]);
    cx->facet_count += 2;
    cx->pool_live += parting.count + 2 - f.loop_count;
    return edge << 1 | (1u - front);
}

/* --- dividing a leaf: its facets, then the facet between the two halves, then the tree --- */

/* Adds an edge to the rim, or its parts. */
static void gxbp_add_rim(gxb_complex *cx, uint32_t signed_edge) {
    gxb_edge *e = &cx->edges[signed_edge >> 1];
    if (e->child != GXB_NONE) {
        gxbp_add_rim(cx, e->child << 1 | (signed_edge & 1));
        gxbp_add_rim(cx, (e->child + 1) << 1 | (signed_edge & 1));
        return;
    }
    if (e->stamp == cx->edge_stamp) return;
    e->stamp = cx->edge_stamp & GXBP_LAST_STAMP;
    cx->rim[cx->rim_count++] = signed_edge;
}

/* Adds the edges of an undivided facet that lie in the plane. flip 1: the rim passes them against the facet's loop. */
static void gxbp_add_flat_edges(gxb_complex *cx, uint32_t facet, uint32_t flip, const gxbp_splitter *splitter) {
    const gxb_facet *f = &cx->facets[facet];
    uint32_t i;
    for (i = 0; i < f->loop_count; i++) {
        const uint32_t e = cx->pool[f->loop + i];
        if (gxbp_sign(&cx->store, cx->edges[e >> 1].v[0], splitter->plane, splitter->slot) == 0 &&
            gxbp_sign(&cx->store, cx->edges[e >> 1].v[1], splitter->plane, splitter->slot) == 0)
            gxbp_add_rim(cx, e ^ flip);
    }
}

/* Chains the rim's edges into the loop of a new facet of the plane. */
static uint32_t gxbp_close_rim(gxb_complex *cx, const gxbp_splitter *splitter) {
    gxb_facet *f = &cx->facets[cx->facet_count];
    const uint32_t count = cx->rim_count;
    uint32_t i, e = cx->rim[0];
    for (i = 0; i < count; i++) {
        const uint32_t signed_edge = cx->rim[i];
        cx->store.points[gxbp_edge_start(cx, signed_edge)].rim_edge = signed_edge;
    }
    memset(f, 0, sizeof *f);
    f->plane = splitter->plane;
    gxbp_set_loop(f, cx->pool_count, count);
    f->child = f->labels = f->face = GXB_NONE;
    for (i = 0; i < count; i++) {
        cx->pool[cx->pool_count++] = e;
        e = cx->store.points[cx->edges[e >> 1].v[1 - (e & 1)]].rim_edge;
    }
    cx->pool_live += count;
    cx->rim_count = 0;
    return cx->facet_count++;
}

static void gxbp_move_facet(gxb_complex *cx, uint32_t facet, uint32_t from, uint32_t to) {
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->facets[facet].leaf[cx->facets[facet].leaf[0] == from ? 0 : 1] = to;
}

static void gxbp_set_list(gxb_complex *cx, uint32_t leaf, const uint32_t *facets, uint32_t count, gxbp_gap *gap) {
    gxb_leaf *l = &cx->leaves[leaf];
    uint32_t i;
    l->facets = gxbp_place_list(cx, count, gap);
    l->facet_count = count;
    for (i = 0; i < count; i++) cx->pool[l->facets + i] = facets[i];
}

/* Divides a leaf whose inside the plane meets. gxbp_ready_leaf has listed its facets and their signs. The leaf becomes
   the half in front; a new leaf is the half behind. Returns the facet between them. */
static uint32_t gxbp_split_leaf(gxb_complex *cx, uint32_t leaf, const gxbp_splitter *splitter) {
    const uint32_t behind = cx->leaf_count++, listed = cx->leaves[leaf].facet_count, count = cx->leaf_facet_count;
    uint32_t *front_list = cx->front_facets, *behind_list = cx->behind_facets, fronts = 0, behinds = 0, i, middle;
    gxbp_gap gap;
    gxbp_forget_rim(cx);
    for (i = 0; i < count; i++) {
        const uint32_t facet = cx->leaf_facets[i], signs = cx->leaf_signs[i], sides = signs & 3;
        const uint32_t inward = cx->facets[facet].leaf[0] == leaf ? 1u : 0u; /* its normal points into the leaf */
        if (sides == 3) {
            const uint32_t edge = gxbp_split_facet(cx, facet, splitter), child = cx->facets[facet].child;
            gxbp_add_rim(cx, edge ^ inward);
            gxbp_move_facet(cx, child + 1, leaf, behind);
            front_list[fronts++] = child;
            behind_list[behinds++] = child + 1;
        } else {
            if (signs >= 8) gxbp_add_flat_edges(cx, facet, inward ^ (sides == 1 ? 0u : 1u), splitter);
            if (sides == 1)
                front_list[fronts++] = facet;
            else {
                gxbp_move_facet(cx, facet, leaf, behind);
                behind_list[behinds++] = facet;
            }
        }
    }
    middle = gxbp_close_rim(cx, splitter);
    cx->facets[middle].leaf[0] = leaf;
    cx->facets[middle].leaf[1] = behind;
    front_list[fronts++] = middle;
    behind_list[behinds++] = middle;
    gxbp_save(cx, GXBP_LEAVES, leaf);
    cx->leaves[behind] = cx->leaves[leaf];
    cx->leaves[behind].parent = leaf;
    gap = gxbp_list_gap(cx, cx->leaves[leaf].facets, listed);
    gxbp_set_list(cx, leaf, front_list, fronts, &gap);
    gxbp_set_list(cx, behind, behind_list, behinds, &gap);
    cx->pool_live += fronts + behinds - listed;
    cx->leaf_facet_count = 0;
    return middle;
}

/* --- elements are opened when they are first touched --- */

static uint32_t gxbp_open_edge(gxb_complex *cx, uint32_t mesh_edge, uint32_t a, uint32_t b) {
    uint32_t line[2];
    if (cx->mesh_edge[mesh_edge] == GXB_NONE) {
        line[0] = a < b ? a : b;
        line[1] = a < b ? b : a;
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

/* The facet of an element's face: its plane through the nodes in ascending order, so that both elements make the same.
 */
static GXBP_APART gx_result gxbp_open_face(gxb_complex *cx, uint32_t element, uint32_t k) {
    const uint32_t face = cx->element_faces[4 * element + k], *node = cx->elements + 4 * (size_t)element;
    uint32_t local[3], j, t, plane;
    gxb_facet *f;
    gx_result result;
    if (cx->face_facet[face] != GXB_NONE) return GX_OK;
    for (j = 0; j < 3; j++) local[j] = gxbp_face_nodes[k][j];
    for (j = 0; j < 3; j++) { /* three steps of a bubble sort by node */
        const uint32_t i = j % 2;
        if (node[local[i]] > node[local[i + 1]]) {
            t = local[i];
            local[i] = local[i + 1];
            local[i + 1] = t;
        }
    }
    result = gxbp_new_plane(&cx->store, node[local[0]], node[local[1]], node[local[2]], 0, &plane);
    if (result == GX_OK) result = gxbp_reserve_split(cx, 1, 3);
    if (result != GX_OK) return result;
    gxbp_plane_axis(&cx->store, plane);
    f = &cx->facets[cx->facet_count];
    memset(f, 0, sizeof *f);
    f->plane = plane;
    gxbp_set_loop(f, cx->pool_count, 3);
    f->child = f->labels = GXB_NONE;
    f->face = face;
    f->leaf[0] = cx->face_elements[2 * face]; /* the first leaf of an element has the element's number */
    f->leaf[1] = cx->face_elements[2 * face + 1];
    for (j = 0; j < 3; j++) {
        const uint32_t a = local[j], b = local[(j + 1) % 3];
        cx->pool[cx->pool_count++] =
            gxbp_open_edge(cx, cx->element_edges[6 * element + gxbp_local_edge(a, b)], node[a], node[b]);
    }
    cx->pool_live += 3;
    gxbp_save(cx, GXBP_FACES, face);
    cx->face_facet[face] = cx->facet_count++;
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_open_element(gxb_complex *cx, uint32_t element) {
    uint32_t k, list;
    gx_result result;
    if (cx->leaves[element].facet_count > 0 || cx->leaves[element].removed) return GX_OK;
    for (k = 0; k < 4; k++) {
        result = gxbp_open_face(cx, element, k);
        if (result != GX_OK) return result;
    }
    result = GXBP_RESERVE(&cx->store.allocator, cx, pool, pool, 4);
    if (result == GX_OK) result = gxbp_reserve_undo(&cx->store, 1);
    if (result != GX_OK) return result;
    list = cx->pool_count;
    for (k = 0; k < 4; k++) cx->pool[cx->pool_count++] = cx->face_facet[cx->element_faces[4 * element + k]];
    gxbp_save(cx, GXBP_LEAVES, element);
    cx->pool_live += 4;
    cx->leaves[element].facets = list;
    cx->leaves[element].facet_count = 4;
    return GX_OK;
}

/* >>pairs: numbers as sums of two doubles: about 100 bits, with bounds --------------------------------------------- */
/* In: doubles. Out: sums and products as pairs of doubles, with bounds that hold as those of >>filter do.
 *
 * The sum of two doubles is their rounded sum and its error, which the six operations of gxbp_pair_sum find but for
 * 2^-103 of the terms' sizes also where roundings are not to nearest [Boldo, Graillat, Muller, On the robustness of the
 * 2Sum and Fast2Sum algorithms (2017)]; a product is that of halves of 26 and 27 bits, taken apart by their bits. What
 * is left out or rounded in a sum or product of pairs is below 2^-100 of its terms' sizes; GXBP_PAIR_U has room for the
 * rounding of the bounds too. Coordinates are below 2^16, so numbers of degree 9 below 2^180, their errors below 2^600
 * even where nothing is known; GXBP_TINY stands for underflow.
 */
#define GXBP_PAIR_U     gxbp_power(-97)
#define GXBP_PAIR_RANGE 16

static gxbp_pair gxbp_pair_sum(double a, double b) {
    gxbp_pair r;
    double part;
    r.high = gxbp_fence(a + b);
    part = gxbp_fence(r.high - a);
    r.low = gxbp_fence(gxbp_fence(a - gxbp_fence(r.high - part)) + gxbp_fence(b - part));
    r.error = 0;
    return r;
}

/* a + b, or a - b where sign is -1 */
static gxbp_pair gxbp_pair_add(const gxbp_pair *a, const gxbp_pair *b, double sign) {
    gxbp_pair r = gxbp_pair_sum(a->high, sign * b->high);
    const double size = gxbp_abs(a->high) + gxbp_abs(b->high);
    r = gxbp_pair_sum(r.high, gxbp_fence(r.low + (a->low + sign * b->low)));
    r.error = a->error + b->error + GXBP_PAIR_U * size + GXBP_TINY;
    return r;
}

static gxbp_pair gxbp_pair_mul(const gxbp_pair *a, const gxbp_pair *b) {
    const double ah = gxbp_double(gxbp_bits(a->high) >> 27 << 27), al = gxbp_fence(a->high - ah);
    const double bh = gxbp_double(gxbp_bits(b->high) >> 27 << 27), bl = gxbp_fence(b->high - bh);
    const double p = gxbp_fence(a->high * b->high), size_a = gxbp_abs(a->high) + a->error;
    double rest = gxbp_fence(gxbp_fence(ah * bh) - p);
    gxbp_pair r;
    rest = gxbp_fence(rest + gxbp_fence(ah * bl));
    rest = gxbp_fence(rest + gxbp_fence(al * bh));
    r = gxbp_pair_sum(p, gxbp_fence(rest + (al * bl + (a->high * b->low + a->low * b->high))));
    r.error = size_a * b->error + gxbp_abs(b->high) * a->error + GXBP_PAIR_U * gxbp_abs(p) + GXBP_TINY;
    return r;
}

/* a b - c d */
static GXBP_APART gxbp_pair gxbp_pair_det2(const gxbp_pair *a, const gxbp_pair *b, const gxbp_pair *c,
                                           const gxbp_pair *d) {
    const gxbp_pair s = gxbp_pair_mul(a, b), t = gxbp_pair_mul(c, d);
    return gxbp_pair_add(&s, &t, -1);
}

static gxbp_pair gxbp_pair_dot(const gxbp_pair a[3], const gxbp_pair b[3]) {
    gxbp_pair r = gxbp_pair_mul(&a[0], &b[0]), t = gxbp_pair_mul(&a[1], &b[1]);
    r = gxbp_pair_add(&r, &t, 1);
    t = gxbp_pair_mul(&a[2], &b[2]);
    return gxbp_pair_add(&r, &t, 1);
}

/* a / b, if both are known to 2^-54 of their own values: with the roundings of the high parts and of the quotient the
   relative error is below 2^-50. */
static int gxbp_pair_ratio(const gxbp_pair *a, const gxbp_pair *b, double *ratio) {
    const double most = gxbp_power(-54);
    if (!(a->error < most * gxbp_abs(a->high)) || !(b->error < most * gxbp_abs(b->high))) return 0;
    *ratio = a->high / b->high;
    return 1;
}

/* q - p. Where a coordinate is no double, or large: 0, with an error that makes every ratio fail */
static void gxbp_pair_difference(gxbp_pair r[3], const gxb_ball *p, const gxb_ball *q) {
    const int good =
        p->error == 0 && q->error == 0 && gxbp_max(gxbp_max3(p->x), gxbp_max3(q->x)) < gxbp_power(GXBP_PAIR_RANGE);
    int k;
    for (k = 0; k < 3; k++) {
        r[k] = gxbp_pair_sum(good ? q->x[k] : 0, good ? -p->x[k] : 0);
        r[k].error = good ? GXBP_PAIR_U * (gxbp_abs(p->x[k]) + gxbp_abs(q->x[k])) : gxbp_power(4 * GXBP_PAIR_RANGE);
    }
}

static const gxbp_pair *gxbp_pair_normal(gxb_complex *cx, uint32_t plane) {
    const gxb_cplane *f = &cx->store.planes[plane];
    const uint32_t slot = plane % GXBP_PAIR_NORMALS;
    gxbp_pair *n = cx->pairs->normal[slot], a[3], b[3];
    int i;
    if (cx->pairs->plane[slot] == plane) return n;
    cx->pairs->plane[slot] = plane;
    gxbp_pair_difference(a, &cx->store.points[f->def[0]].ball, &cx->store.points[f->def[1]].ball);
    if (f->along_axis) { /* a x e */
        const uint32_t j = (f->def[2] + 1) % 3, k = (f->def[2] + 2) % 3;
        n[j] = a[k];
        n[k].high = -a[j].high;
        n[k].low = -a[j].low;
        n[k].error = a[j].error;
        n[f->def[2]] = gxbp_pair_sum(0, 0);
        return n;
    }
    gxbp_pair_difference(b, &cx->store.points[f->def[0]].ball, &cx->store.points[f->def[2]].ball);
    for (i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = gxbp_pair_det2(&a[j], &b[k], &a[k], &b[j]);
    }
    return n;
}

/* n.(x - base) for an explicit point */
static gxbp_pair gxbp_pair_side(gxb_complex *cx, uint32_t point, uint32_t plane) {
    const uint32_t slot = (plane * 31 + point) % GXBP_PAIR_SIDES;
    gxbp_pairs *pairs = cx->pairs;
    if (pairs->side_plane[slot] != plane || pairs->side_point[slot] != point) {
        const gxbp_pair *n = gxbp_pair_normal(cx, plane);
        const gxb_cplane *f = &cx->store.planes[plane];
        gxbp_pair d[3];
        gxbp_pair_difference(d, &cx->store.points[f->def[0]].ball, &cx->store.points[point].ball);
        if (f->along_axis) { /* its normal has no component along the axis */
            const uint32_t j = (f->def[2] + 1) % 3, k = (f->def[2] + 2) % 3;
            const gxbp_pair s = gxbp_pair_mul(&n[j], &d[j]), t = gxbp_pair_mul(&n[k], &d[k]);
            pairs->side[slot] = gxbp_pair_add(&s, &t, 1);
        } else
            pairs->side[slot] = gxbp_pair_dot(n, d);
        pairs->side_plane[slot] = plane;
        pairs->side_point[slot] = point;
    }
    return pairs->side[slot];
}

/* A side of a plane as pairs tell it, GXBP_UNKNOWN where they do not, of a point of two given points p, q and a plane,
   with sides s and t of the latter and of the plane in question. The point is (t p - s q) / (t - s) for its own plane.
 */
static int gxbp_pair_line_side(gxb_complex *cx, const uint32_t def[3], uint32_t plane) {
    const gxbp_pair p = gxbp_pair_side(cx, def[0], def[2]), q = gxbp_pair_side(cx, def[1], def[2]);
    const gxbp_pair s = gxbp_pair_side(cx, def[0], plane), t = gxbp_pair_side(cx, def[1], plane);
    const gxbp_pair value = gxbp_pair_det2(&q, &s, &p, &t), weight = gxbp_pair_add(&q, &p, -1);
    const int sign = gxbp_filter_sign(value.high, value.error) * gxbp_filter_sign(weight.high, weight.error);
    return sign == 0 ? GXBP_UNKNOWN : sign;
}

/* A point x of three planes. o, the first point of the first plane, has sides 0, s_1 and s_2 of the three. n_i.(x - o)
   is minus its side of each, so o - x = (s_1 n_2 x n_0 + s_2 n_0 x n_1) / n_1.(n_2 x n_0). */
static const gxbp_pair_point *gxbp_pair_point_of(gxb_complex *cx, const uint32_t def[3]) {
    gxbp_pair_point *p = &cx->pairs->point[(def[0] * 7 + def[1] * 31 + def[2]) % GXBP_PAIR_POINTS];
    const uint32_t o = cx->store.planes[def[0]].def[0];
    gxbp_pair n[3][3], cross[2][3], side[2];
    uint32_t i, k;
    if (memcmp(p->def, def, sizeof p->def) == 0) return p;
    memcpy(p->def, def, sizeof p->def);
    for (i = 0; i < 3; i++) memcpy(n[i], gxbp_pair_normal(cx, def[i]), sizeof n[i]);
    for (i = 0; i < 2; i++) {
        const gxbp_pair *a = n[(i + 2) % 3], *b = n[i];
        side[i] = gxbp_pair_side(cx, o, def[i + 1]);
        for (k = 0; k < 3; k++) {
            const uint32_t x = (k + 1) % 3, y = (k + 2) % 3;
            cross[i][k] = gxbp_pair_det2(&a[x], &b[y], &a[y], &b[x]);
        }
    }
    for (k = 0; k < 3; k++) {
        const gxbp_pair s = gxbp_pair_mul(&side[0], &cross[0][k]), t = gxbp_pair_mul(&side[1], &cross[1][k]);
        p->away[k] = gxbp_pair_add(&s, &t, 1);
    }
    p->weight = gxbp_pair_dot(n[1], cross[0]);
    return p;
}

/* The same side of a point x of three planes: n.(x - base) is o's side less n.(o - x). The corners of one triangle have
   one o. */
static int gxbp_pair_planes_side(gxb_complex *cx, const uint32_t def[3], uint32_t plane) {
    const gxbp_pair_point *p = gxbp_pair_point_of(cx, def);
    const gxbp_pair side = gxbp_pair_side(cx, cx->store.planes[def[0]].def[0], plane);
    const gxbp_pair s = gxbp_pair_mul(&p->weight, &side), t = gxbp_pair_dot(gxbp_pair_normal(cx, plane), p->away),
                    value = gxbp_pair_add(&s, &t, -1);
    const int sign = gxbp_filter_sign(value.high, value.error) * gxbp_filter_sign(p->weight.high, p->weight.error);
    return sign == 0 ? GXBP_UNKNOWN : sign;
}

/* >>clip: a triangle against the tree of an element ---------------------------------------------------------------- */
/* In: a triangle and an element. Out: the polygon of the triangle that reaches each leaf. Touches the stack of
   polygons only. */

static uint32_t gxbp_face_plane(const gxb_complex *cx, uint32_t element, uint32_t k) {
    return cx->facets[cx->face_facet[cx->element_faces[4 * element + k]]].plane;
}

/* Exact coordinates of a corner are not kept, so pairs are asked first. */
static int gxbp_corner_sign(gxb_complex *cx, const gxbp_corner *c, uint32_t plane) {
    int sign = gxbp_filtered_side(&cx->store, &c->ball, c->kind, c->def, c->point, plane);
    if (sign == GXBP_UNKNOWN && c->point == GXB_NONE)
        sign = c->kind == GXB_LINE_PLANE ? gxbp_pair_line_side(cx, c->def, plane)
                                         : gxbp_pair_planes_side(cx, c->def, plane);
    return sign == GXBP_UNKNOWN ? gxbp_exact_sign(&cx->store, c->kind, c->def, c->point, plane) : sign;
}

/* The point in which two carriers meet in the triangle's plane. */
static void gxbp_clip_corner(gxb_complex *cx, const gxb_triangle *t, uint32_t a, uint32_t b, gxbp_corner *r) {
    const uint32_t edge = a >= GXBP_TRIANGLE_EDGE ? a : b, k = edge - GXBP_TRIANGLE_EDGE,
                   other = a >= GXBP_TRIANGLE_EDGE ? b : a;
    r->sign = 0;
    r->point = GXB_NONE;
    r->def[2] = other;
    if (other >= GXBP_TRIANGLE_EDGE) {
        r->kind = GXB_EXPLICIT;
        r->point = t->point[other - GXBP_TRIANGLE_EDGE == (k + 1) % 3 ? (k + 1) % 3 : k];
        r->ball = cx->store.points[r->point].ball;
        return;
    }
    if (edge >= GXBP_TRIANGLE_EDGE) {
        r->kind = GXB_LINE_PLANE;
        r->def[0] = t->point[k];
        r->def[1] = t->point[(k + 1) % 3];
    } else {
        r->kind = GXB_THREE_PLANES;
        r->def[0] = t->plane;
        r->def[1] = edge;
    }
    gxbp_definition_ball(&cx->store, r->kind, r->def, &r->ball);
}

/* Clips the polygon of corners first ... first+count-1, whose signs are known, to one side of a carrier. Pushes the
   result on the corner stack. Returns the number of its corners, 0 if it has no area. */
static uint32_t gxbp_clip(gxb_complex *cx, const gxb_triangle *t, uint32_t first, uint32_t count, uint32_t carrier,
                          int side) {
    const uint32_t start = cx->corner_count;
    uint32_t i;
    int inside = 0;
    for (i = 0; i < count; i++) {
        const gxbp_corner *c = &cx->corners[first + i], *next = &cx->corners[first + (i + 1 < count ? i + 1 : 0)];
        const int s = c->sign * side, n = next->sign * side;
        gxbp_corner *r;
        if (s > 0) inside = 1;
        if (s >= 0) {
            r = &cx->corners[cx->corner_count++];
            *r = *c;
            if (s == 0 && n < 0) r->carrier = carrier;
        }
        if (s * n < 0) {
            r = &cx->corners[cx->corner_count++];
            gxbp_clip_corner(cx, t, c->carrier, carrier, r);
            r->carrier = s > 0 ? carrier : c->carrier;
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

/* >>walls: what a triangle marks: walls, labels, removed leaves ---------------------------------------------------- */
/* In: a triangle and a facet in its plane. Out: a wall or a label on what the triangle covers of the facet. A
   transaction is open. */

/* The plane through edge k of the triangle, along the axis that is closest to its normal. *front: 1 if the triangle
   lies in front of that plane, -1 if behind. */
static gx_result gxbp_edge_plane(gxb_complex *cx, gxb_triangle *t, uint32_t k, int *front) {
    const uint32_t axis = cx->store.planes[t->plane].axis;
    gx_result result = GX_OK;
    if (t->edge_plane[k] == GXB_NONE)
        result = gxbp_new_plane(&cx->store, t->point[k], t->point[(k + 1) % 3], axis, 1, &t->edge_plane[k]);
    if (result != GX_OK) return result;
    /* ((q - p) x e).(r - p) = -e.((q - p) x (r - p)): opposite to the sign of the triangle's normal along the axis */
    *front = -cx->store.planes[t->plane].axis_sign * t->orientation;
    return GX_OK;
}

/* 1: the facet's normal points to the triangle's own front; -1: to its back. They lie in one plane. */
static int32_t gxbp_relative_orientation(gxb_complex *cx, const gxb_triangle *t, uint32_t plane) {
    const gxb_cplane *f = &cx->store.planes[t->plane];
    const int own = f->axis_sign * t->orientation;
    return plane == t->plane ? t->orientation : own * gxbp_normal_sign(&cx->store, plane, f->axis);
}

static gx_result gxbp_add_label(gxb_complex *cx, const gxb_triangle *t, uint32_t facet) {
    uint32_t l;
    gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, labels, label, 1);
    for (l = cx->facets[facet].labels; l != GXB_NONE; l = cx->labels[l].next)
        if (cx->labels[l].triangle == t->label) return GX_OK;
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, marked, marked, 1);
    if (result == GX_OK) result = gxbp_reserve_undo(&cx->store, 1);
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->labels[cx->label_count].triangle = t->label;
    cx->labels[cx->label_count].orientation = gxbp_relative_orientation(cx, t, cx->facets[facet].plane);
    cx->labels[cx->label_count].next = cx->facets[facet].labels;
    cx->facets[facet].labels = cx->label_count++;
    cx->marked[cx->marked_count++] = facet << 1 | (t->wall && !cx->facets[facet].wall);
    if (t->wall) cx->facets[facet].wall = 1;
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_set_wall(gxb_complex *cx, uint32_t facet) {
    gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, marked, marked, 1);
    if (result == GX_OK) result = gxbp_reserve_undo(&cx->store, 1);
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_FACETS, facet);
    cx->marked[cx->marked_count++] = facet << 1 | !cx->facets[facet].wall;
    cx->facets[facet].wall = 1;
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_set_removed(gxb_complex *cx, uint32_t leaf) {
    const gx_result result = gxbp_reserve_undo(&cx->store, 1);
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_LEAVES, leaf);
    cx->removed_count += !cx->leaves[leaf].removed;
    cx->leaves[leaf].removed = 1;
    return GX_OK;
}

/* The splitter along edge k of the triangle, whose plane has been made. */
static void gxbp_set_splitter(const gxb_triangle *t, uint32_t k, gxbp_splitter *splitter) {
    splitter->plane = t->edge_plane[k];
    splitter->line[0] = t->point[k];
    splitter->line[1] = t->point[(k + 1) % 3];
    splitter->explicit_line = 1;
    splitter->slot = 1;
}

/* Labels the part of a facet, in the triangle's plane, that the triangle covers; edges: bit k where edge k may bound
 * that part. */
static gx_result gxbp_cover_facet(gxb_complex *cx, gxb_triangle *t, uint32_t facet, uint32_t edges) {
    uint32_t k;
    for (k = 0; k < 3; k++) {
        gxbp_splitter splitter;
        gx_result result;
        int front, sides;
        uint32_t count;
        if (!(edges >> k & 1)) continue;
        result = gxbp_edge_plane(cx, t, k, &front);
        if (result != GX_OK) return result;
        gxbp_set_splitter(t, k, &splitter);
        gxbp_forget_signs(&cx->store, 1);
        sides = (int)(gxbp_facet_signs(cx, facet, &splitter, &count) & 3);
        if (sides == 3) {
            result = gxbp_reserve_split(cx, 1, count);
            if (result != GX_OK) return result;
            gxbp_split_facet(cx, facet, &splitter);
            facet = cx->facets[facet].child + (front > 0 ? 0u : 1u);
        } else if (sides != (front > 0 ? 1 : 2))
            return GX_OK; /* outside of the triangle */
    }
    return gxbp_add_label(cx, t, facet);
}

/* >>cover: pinched edges and nodes, facets in the plane of a triangle ---------------------------------------------- */
/* In: a triangle through an edge, a node or a facet that is there already. Out: marks on what it covers. No leaf
   is divided. */

/* Divides an edge in the triangle's plane by the planes of the triangle's edges k, k+1 ... and marks the parts inside.
 */
static gx_result gxbp_cover_edge(gxb_complex *cx, gxb_triangle *t, uint32_t edge, uint32_t k, int *covered) {
    gx_result result = gxbp_reserve_split(cx, 0, 1);
    for (; k < 3 && result == GX_OK; k++) {
        gxbp_splitter splitter;
        int front, a, b;
        result = gxbp_edge_plane(cx, t, k, &front);
        if (result != GX_OK) return result;
        gxbp_set_splitter(t, k, &splitter);
        a = front * gxb_complex_side(cx, cx->edges[edge].v[0], splitter.plane);
        b = front * gxb_complex_side(cx, cx->edges[edge].v[1], splitter.plane);
        if (a * b < 0) {
            gxbp_split_edge(cx, edge, &splitter);
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

static GXBP_COLD gx_result gxbp_cover_edges(gxb_complex *cx, gxb_triangle *t, uint32_t edge, int *covered) {
    const uint32_t child = cx->edges[edge].child;
    gx_result result;
    if (child == GXB_NONE) return gxbp_cover_edge(cx, t, edge, 0, covered);
    result = gxbp_cover_edges(cx, t, child, covered);
    return result == GX_OK ? gxbp_cover_edges(cx, t, child + 1, covered) : result;
}

GXFEM_API GXBP_RARE gx_result gxb_complex_cover_edge(gxb_complex *cx, gxb_triangle *t, uint32_t element,
                                                     uint32_t local_edge, int *covered) {
    const uint32_t edge = cx->element_edges[6 * element + local_edge];
    const uint32_t a = cx->elements[4 * element + gxbp_edge_nodes[local_edge][0]],
                   b = cx->elements[4 * element + gxbp_edge_nodes[local_edge][1]];
    gx_result result;
    if (gxb_complex_side(cx, a, t->plane) != 0 || gxb_complex_side(cx, b, t->plane) != 0) return GX_OK;
    result = gxb_complex_open_element(cx, element);
    return result == GX_OK ? gxbp_cover_edges(cx, t, cx->mesh_edge[edge], covered) : result;
}

GXFEM_API GXBP_RARE gx_result gxb_complex_cover_node(gxb_complex *cx, gxb_triangle *t, uint32_t node, int *covered) {
    uint32_t k;
    int front;
    gx_result result = gxbp_reserve_undo(&cx->store, 1);
    if (cx->store.points[node].wall || gxb_complex_side(cx, node, t->plane) != 0) return result;
    for (k = 0; k < 3 && result == GX_OK; k++) {
        result = gxbp_edge_plane(cx, t, k, &front);
        if (result == GX_OK && gxb_complex_side(cx, node, t->edge_plane[k]) * front < 0) return GX_OK;
    }
    if (result != GX_OK) return result;
    gxbp_save(cx, GXBP_POINTS, node);
    cx->store.points[node].wall = 1;
    *covered = 1;
    return GX_OK;
}

/* The triangle lies in the plane of some of the leaf's facets. */
static gx_result gxbp_cover_leaf(gxb_complex *cx, gxb_triangle *t, uint32_t leaf) {
    uint32_t first, count, i, j;
    gx_result result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        uint32_t facet = cx->pool[first + i];
        for (j = 0; j < cx->facets[facet].loop_count; j++) {
            if (gxbp_sign(&cx->store, gxbp_edge_start(cx, cx->pool[cx->facets[facet].loop + j]), t->plane, 0) != 0)
                break;
        }
        if (j == cx->facets[facet].loop_count) result = gxbp_cover_facet(cx, t, facet, 7);
    }
    return result;
}

/* >>rebalance: trees that have become spines ----------------------------------------------------------------------- */
/* Planes in order, as of parallel cuts, make a spine: a path of nodes along which each plane leaves almost
   everything on one side. In: the tree of an element. Out: a shallower tree of the same leaves. A node can stand
   above others of its spine if its plane has all of their leaves on one side or the other. A node with nothing on
   one side is dropped. No leaf changes. */

/* The spine goes on at child[side]; off: the reference at the other child; sides: on which sides of the plane in
   question that has points */
typedef struct gxbp_spine_node {
    uint32_t node, side, off, sides;
} gxbp_spine_node;
typedef struct gxbp_step {
    uint32_t node, child[2];
} gxbp_step;
/* The tree to be made: each node with its children, bottom up */
typedef struct gxbp_plan {
    gxbp_step *step;
    uint32_t count;
    gxbp_spine_node *spare;
} gxbp_plan;

/* Is the tree far higher than a balanced one with as many leaves? While a tree doubles, this is checked eight times if
   most of it is a spine, else once; from 128 leaves on once while it grows by a factor of eight. Rebalancing seldom
   helps what is no spine, and goes through all leaves. */
static int gxbp_is_slack(uint32_t height, uint32_t leaves) {
    uint32_t bits = 0, checks;
    while (leaves >> bits > 1) bits++;
    checks = height > 2 * bits + leaves / 8 + 4 ? 3 : 0;
    return height > 2 * bits + 4 && (checks > 0 || bits < 7 || bits % 3 == 0) &&
           (leaves & ((1u << bits >> checks) - 1)) == 0;
}

static uint32_t gxbp_depth(const gxb_complex *cx, uint32_t node) {
    uint32_t depth = 0;
    for (; node != GXB_NONE; node = cx->nodes[node].parent) depth++;
    return depth;
}

static uint32_t gxbp_leaves_below(const gxb_complex *cx, uint32_t reference) {
    return reference & 1 ? cx->nodes[reference >> 1].leaves : 1;
}

/* gxbp_facet_sides of all parts of a divided facet */
static GXBP_APART int gxbp_all_facet_sides(gxb_complex *cx, uint32_t facet, const gxbp_splitter *splitter) {
    const uint32_t child = cx->facets[facet].child;
    if (child == GXB_NONE) return gxbp_facet_sides(cx, facet, splitter);
    return gxbp_all_facet_sides(cx, child, splitter) | gxbp_all_facet_sides(cx, child + 1, splitter);
}

/* On which sides of the plane (slot 1's, for its present stamp) the leaf has points: bit 1 in front, bit 2 behind.
   Edges need not be resolved: the points that divide them lie between their ends. */
static int gxbp_leaf_sides(gxb_complex *cx, uint32_t leaf, const gxbp_splitter *splitter) {
    const gxb_leaf *l = &cx->leaves[leaf];
    uint32_t i;
    int sides = l->facet_count > 0 ? 0 : 3; /* where one stands for all removed leaves, nobody knows */
    for (i = 0; i < l->facet_count && sides != 3; i++)
        sides |= gxbp_all_facet_sides(cx, cx->pool[l->facets + i], splitter);
    return sides;
}

static GXBP_COLD int gxbp_sides_below(gxb_complex *cx, uint32_t reference, const gxbp_splitter *splitter) {
    int sides;
    if (!(reference & 1)) return gxbp_leaf_sides(cx, reference >> 1, splitter);
    sides = gxbp_sides_below(cx, cx->nodes[reference >> 1].child[0], splitter);
    return sides == 3 ? 3 : sides | gxbp_sides_below(cx, cx->nodes[reference >> 1].child[1], splitter);
}

static uint32_t gxbp_plan_node(gxbp_plan *plan, uint32_t node, uint32_t side, uint32_t on, uint32_t off) {
    plan->step[plan->count].node = node;
    plan->step[plan->count].child[side] = on;
    plan->step[plan->count++].child[1 - side] = off;
    return 2 * node + 1;
}

/* The spine as it is, above end */
static uint32_t gxbp_plan_spine(gxbp_plan *plan, const gxbp_spine_node *spine, uint32_t count, uint32_t end) {
    while (count-- > 0) end = gxbp_plan_node(plan, spine[count].node, spine[count].side, end, spine[count].off);
    return end;
}

/* Finds on which side of the plane each tree off the spine lies. 0: the plane passes through one of them. Small trees
   are asked first: where the plane passes through many, as on a convex surface, one of them tells. */
static int gxbp_spine_sides(gxb_complex *cx, gxbp_spine_node *spine, uint32_t count, const gxbp_splitter *splitter) {
    uint64_t most = 1, largest = 1;
    uint32_t i;
    for (i = 0; i < count; i++) {
        const uint32_t leaves = gxbp_leaves_below(cx, spine[i].off);
        if (leaves > largest) largest = leaves;
        spine[i].sides = 0;
    }
    for (; most < 16 * largest; most *= 16)
        for (i = 0; i < count; i++) {
            if (spine[i].sides != 0 || gxbp_leaves_below(cx, spine[i].off) > most) continue;
            spine[i].sides = (uint32_t)gxbp_sides_below(cx, spine[i].off, splitter);
            if (spine[i].sides == 3) return 0;
        }
    return 1;
}

/* Sorts the nodes above spine[middle] by the side of its plane on which their leaves lie. Those on the spine's own side
   come last; *own is their number. 0: the plane passes through one of them. spare: room for middle nodes */
static int gxbp_part_spine(gxb_complex *cx, gxbp_spine_node *spine, uint32_t middle, gxbp_spine_node *spare,
                           uint32_t *own) {
    const uint32_t side = spine[middle].side;
    uint32_t i, n = 0;
    gxbp_splitter splitter;
    memset(&splitter, 0, sizeof splitter);
    splitter.plane = cx->nodes[spine[middle].node].plane;
    splitter.slot = 1;
    gxbp_forget_signs(&cx->store, 1);
    *own = 0;
    if (!gxbp_spine_sides(cx, spine, middle, &splitter)) return 0;
    for (i = 0; i < middle; i++)
        if ((spine[i].sides == 1) == (side == 0))
            spare[(*own)++] = spine[i];
        else
            spare[middle - ++n] = spine[i];
    for (i = 0; i < n; i++) spine[i] = spare[middle - 1 - i];
    memcpy(spine + n, spare, *own * sizeof *spine);
    return 1;
}

/* A balanced tree of the spine above end. Its root is the spine's middle node, by leaves. */
static GXBP_COLD uint32_t gxbp_rebalance_spine(gxb_complex *cx, gxbp_plan *plan, gxbp_spine_node *spine, uint32_t count,
                                               uint32_t end) {
    uint32_t total = gxbp_leaves_below(cx, end), sum = 0, middle = 0, own, i, on, off;
    gxbp_spine_node root;
    if (count < 4) return gxbp_plan_spine(plan, spine, count, end);
    for (i = 0; i < count; i++) total += gxbp_leaves_below(cx, spine[i].off);
    for (; middle + 1 < count && 2 * sum < total; middle++) sum += gxbp_leaves_below(cx, spine[middle].off);
    if (!gxbp_part_spine(cx, spine, middle, plan->spare, &own)) return gxbp_plan_spine(plan, spine, count, end);
    root = spine[middle];
    memmove(spine + middle, spine + middle + 1, (count - middle - 1) * sizeof *spine);
    off = gxbp_rebalance_spine(cx, plan, spine, middle - own, root.off);
    on = gxbp_rebalance_spine(cx, plan, spine + middle - own, own + count - middle - 1, end);
    return gxbp_plan_node(plan, root.node, root.side, on, off);
}

/* Builds the planned tree bottom up, and puts it in the place of top. */
static gx_result gxbp_follow_plan(gxb_complex *cx, const gxbp_plan *plan, uint32_t tree, uint32_t top,
                                  uint32_t element) {
    const uint32_t above = cx->nodes[top].parent;
    uint32_t i, k;
    gx_result result = gxbp_reserve_undo(&cx->store, 3 * (size_t)plan->count + 1);
    if (result != GX_OK) return result;
    for (i = 0; i < plan->count; i++) {
        gxb_node *n = &cx->nodes[plan->step[i].node];
        gxbp_save(cx, GXBP_NODES, plan->step[i].node);
        n->leaves = 0;
        for (k = 0; k < 2; k++) {
            const uint32_t child = n->child[k] = plan->step[i].child[k];
            n->leaves += gxbp_leaves_below(cx, child);
            if (child & 1) {
                gxbp_save(cx, GXBP_NODES, child >> 1);
                cx->nodes[child >> 1].parent = plan->step[i].node;
            }
        }
    }
    cx->nodes[tree >> 1].parent = above; /* it has been saved */
    if (above == GXB_NONE) {
        gxbp_save(cx, GXBP_ROOTS, element);
        cx->root[element] = tree;
        return GX_OK;
    }
    gxbp_save(cx, GXBP_NODES, above);
    cx->nodes[above].child[cx->nodes[above].child[1] == 2 * top + 1] = tree;
    return GX_OK;
}

/* Balances the tree below top along the path to a node. */
static GXBP_COLD gx_result gxbp_balance(gxb_complex *cx, uint32_t top, uint32_t node, uint32_t element) {
    const uint32_t count = gxbp_depth(cx, node) - gxbp_depth(cx, cx->nodes[top].parent);
    const size_t size = count * (2 * sizeof(gxbp_spine_node) + sizeof(gxbp_step));
    gxbp_spine_node *spine = (gxbp_spine_node *)gxbp_allocate(&cx->store.allocator, size);
    gxbp_plan plan;
    uint32_t i, n, tree, below = cx->nodes[node].child[0];
    gx_result result;
    if (spine == NULL) return GX_ERROR_MEMORY;
    for (i = count, n = node; i-- > 0; n = cx->nodes[n].parent) {
        spine[i].node = n;
        spine[i].side = cx->nodes[n].child[1] == below;
        spine[i].off = cx->nodes[n].child[1 - spine[i].side];
        below = 2 * n + 1;
    }
    plan.spare = spine + count;
    plan.step = (gxbp_step *)(void *)(spine + 2 * (size_t)count);
    plan.count = 0;
    tree = gxbp_rebalance_spine(cx, &plan, spine, count, cx->nodes[node].child[0]);
    result = gxbp_follow_plan(cx, &plan, tree, top, element);
    gxbp_release(&cx->store.allocator, spine, size);
    return result;
}

/* A leaf has become a node with two leaves. Balances the lowest tree around it that has become too high. */
static gx_result gxbp_grow_tree(gxb_complex *cx, uint32_t node, uint32_t element) {
    uint32_t n, height = 0, slack = GXB_NONE;
    gx_result result = gxbp_reserve_undo(&cx->store, gxbp_depth(cx, node));
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

/* Lists the leaf's facets and their signs, and reserves room to divide it. */
static gx_result gxbp_ready_leaf(gxb_complex *cx, uint32_t leaf, const gxbp_splitter *splitter) {
    const gx_allocator *a = &cx->store.allocator;
    const gxb_leaf *l = &cx->leaves[leaf];
    const uint32_t count = gxbp_count_list(cx, l);
    uint32_t *out, i;
    size_t edges = 0;
    gx_result result = GXBP_RESERVE(a, cx, leaf_facets, leaf_facet, count);
    if (result == GX_OK) result = GXBP_RESERVE(a, cx, leaf_signs, leaf_sign, count);
    if (result == GX_OK) result = GXBP_RESERVE(a, cx, front_facets, front_facet, count + 1); /* with the one between */
    if (result == GX_OK) result = GXBP_RESERVE(a, cx, behind_facets, behind_facet, count + 1);
    if (result != GX_OK) return result;
    out = cx->leaf_facets;
    for (i = 0; i < l->facet_count; i++) out = gxbp_list_facets(cx, cx->pool[l->facets + i], out);
    for (i = 0; i < count; i++) {
        uint32_t own;
        const uint32_t signs = cx->leaf_signs[i] = gxbp_facet_signs(cx, cx->leaf_facets[i], splitter, &own);
        if ((signs & 3) == 3 || signs >= 8) edges += own;
    }
    result = GXBP_RESERVE(a, cx, rim, rim, count + edges);
    if (result == GX_OK) result = gxbp_reserve_split(cx, count, edges);
    cx->leaf_facet_count = result == GX_OK ? count : 0;
    return result;
}

/* Divides a leaf that is ready and hangs at the task's place; *node takes that place. Returns the facet between the
 * halves. */
static uint32_t gxbp_part_leaf(gxb_complex *cx, uint32_t leaf, const gxbp_splitter *splitter, const gxbp_task *task,
                               uint32_t *node) {
    const uint32_t middle = gxbp_split_leaf(cx, leaf, splitter);
    gxb_node *n = &cx->nodes[ *node = cx->tree_count++];
    n->plane = splitter->plane;
    n->child[0] = 2 * leaf;
    n->child[1] = 2 * (cx->leaf_count - 1);
    n->parent = task->parent;
    n->leaves = 1;
    n->facet = middle;
    if (task->parent == GXBP_IN_ROOT)
        gxbp_save(cx, GXBP_ROOTS, cx->leaves[leaf].element);
    else
        gxbp_save(cx, GXBP_NODES, task->parent);
    *gxbp_reference(cx, task, cx->leaves[leaf].element) = 2 * *node + 1;
    return middle;
}

/* >>crowds: leaves with many facets -------------------------------------------------------------------------------- */
/* The triangles of a convex surface all divide the same leaf, in a time that grows with their number and its
   facets. In: a leaf with many facets inside its element. Out: the leaf divided by a free plane across them. A
   free plane belongs to no triangle and makes no wall: the facet between the halves is open, and they stay one
   cell. Given coordinates and exact signs alone decide which plane it is. */

/* from so many facets on, a leaf is crowded; from so many facets at most, medians are taken */
enum { GXBP_MANY_FACETS = 24, GXBP_SAMPLE = 32 };

/* A number from a to b > a with few bits */
static GXBP_COLD double gxbp_between(double a, double b) {
    const uint64_t x = gxbp_bits(a), y = gxbp_bits(b);
    int drop = 52;
    if (gxbp_compare_doubles(a, 0) < 0) return gxbp_compare_doubles(b, 0) < 0 ? -gxbp_between(-b, -a) : 0;
    if (x >> 52 == y >> 52)
        while (drop > 0 && x >> (drop - 1) == y >> (drop - 1)) drop--;
    return x >> 52 == y >> 52 && drop > 0 ? gxbp_double(y >> (drop - 1) << (drop - 1)) : gxbp_double(y >> 52 << 52);
}

/* Sorts the numbers. *median: a number between the two in the middle. Returns the exponent of the difference of the
 * last and the first, roughly. -2000: those in the middle are equal, and there is no median. */
static int gxbp_median(double *x, uint32_t count, double *median) {
    uint32_t i, j;
    for (i = 1; i < count; i++) {
        const double value = x[i];
        for (j = i; j > 0 && gxbp_compare_doubles(x[j - 1], value) > 0; j--) x[j] = x[j - 1];
        x[j] = value;
    }
    for (i = count / 2; i + 1 < count && gxbp_compare_doubles(x[i - 1], x[i]) == 0; i++) {}
    if (gxbp_compare_doubles(x[i - 1], x[i]) == 0) return -2000;
    *median = gxbp_between(x[i - 1], x[i]);
    return gxbp_difference_exponent(x[count - 1], x[0]);
}

/* Points of what is to be parted, by axis */
typedef struct gxbp_sample {
    double x[3][GXBP_SAMPLE];
    uint32_t count;
} gxbp_sample;

/* Every step-th of so many things gives a point. */
static uint32_t gxbp_sample_step(uint32_t count) { return (count + GXBP_SAMPLE - 1) / GXBP_SAMPLE; }

static void gxbp_add_to_sample(gxbp_sample *sample, const double x[3]) {
    int k;
    for (k = 0; k < 3; k++) sample->x[k][sample->count] = x[k];
    sample->count++;
}

/* median: for each axis, where a plane across it leaves about as many points on either side. rank: the axes, beginning
   with the one along which the points are furthest apart. Returns the number of axes along which they are apart at
   all. Sorts the points. */
static GXBP_COLD int gxbp_medians(gxbp_sample *sample, double median[3], int rank[3]) {
    int spread[3], k, j, ranks = 0;
    for (k = 0; k < 3; k++) {
        spread[k] = gxbp_median(sample->x[k], sample->count, &median[k]);
        if (spread[k] == -2000) continue;
        for (j = ranks++; j > 0 && spread[rank[j - 1]] < spread[k]; j--) rank[j] = rank[j - 1];
        rank[j] = k;
    }
    return ranks;
}

/* A plane across an axis: through points at the corners of the element's box. */
static GXBP_COLD gx_result gxbp_new_free_plane(gxb_complex *cx, uint32_t element, int axis, double position,
                                               uint32_t *plane) {
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, x[3];
    uint32_t point[3], i;
    int k;
    gx_result result = GX_OK;
    for (i = 0; i < 4; i++) {
        gxbp_given(&cx->store, cx->elements[4 * element + i], x);
        for (k = 0; k < 3; k++) {
            if (i == 0 || gxbp_compare_doubles(x[k], low[k]) < 0) low[k] = x[k];
            if (i == 0 || gxbp_compare_doubles(x[k], high[k]) > 0) high[k] = x[k];
        }
    }
    for (i = 0; i < 3 && result == GX_OK; i++) {
        memcpy(x, low, sizeof x);
        x[axis] = position;
        if (i > 0) x[(axis + (int)i) % 3] = high[(axis + (int)i) % 3];
        result = gxb_complex_add_point(cx, x, &point[i]);
    }
    if (result == GX_OK) result = gxbp_new_plane(&cx->store, point[0], point[1], point[2], 0, plane);
    if (result == GX_OK) gxbp_plane_axis(&cx->store, *plane);
    return result;
}

/* The points and planes that were made last go again. */
static void gxbp_drop_free_plane(gxb_complex *cx, uint32_t points, uint32_t planes) {
    cx->store.next_name -= cx->store.point_count - points;
    cx->store.point_count = points;
    cx->store.plane_count = planes;
}

/* Does a quarter of the facets at least lie in front of the plane, and a quarter behind it? */
static int gxbp_plane_parts(gxb_complex *cx, const uint32_t *facets, uint32_t count, const gxbp_splitter *splitter) {
    uint32_t front = 0, behind = 0, i;
    gxbp_forget_signs(&cx->store, 1);
    for (i = 0; i < count; i++) {
        const int sides = gxbp_facet_sides(cx, facets[i], splitter);
        front += sides == 1;
        behind += sides == 2;
    }
    return front >= count / 4 && behind >= count / 4;
}

/* Divides the leaf at the task's place, which a triangle has just made, by a free plane, if it has many facets and one
   parts them well. *node: the node that has taken its place, or left alone. Tried when the number of facets is a
   multiple of eight. */
static GXBP_COLD gx_result gxbp_divide_crowded(gxb_complex *cx, const gxbp_task *task, uint32_t *node) {
    const uint32_t leaf = cx->nodes[task->parent].child[task->side] >> 1, points = cx->store.point_count,
                   planes = cx->store.plane_count;
    const gxb_leaf l = cx->leaves[leaf];
    uint32_t i, n = 0, *inner;
    double median[3], given[3];
    int rank[3], ranks, k;
    gxbp_sample sample;
    gxbp_splitter splitter;
    gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, inner_facets, inner_facet, l.facet_count);
    if (result != GX_OK) return result;
    inner = cx->inner_facets;
    for (i = 0; i < l.facet_count; i++)
        if (cx->facets[cx->pool[l.facets + i]].face == GXB_NONE) inner[n++] = cx->pool[l.facets + i];
    if (n < GXBP_MANY_FACETS || n % 8 != 0) return GX_OK;
    memset(&splitter, 0, sizeof splitter);
    splitter.slot = 1;
    for (i = sample.count = 0; i < n; i += gxbp_sample_step(n)) {
        gxbp_given(&cx->store, cx->store.planes[cx->facets[inner[i]].plane].def[0], given);
        gxbp_add_to_sample(&sample, given);
    }
    ranks = gxbp_medians(&sample, median, rank);
    for (k = 0; k < ranks; k++) {
        result = gxbp_new_free_plane(cx, l.element, rank[k], median[rank[k]], &splitter.plane);
        if (result != GX_OK) return result;
        if (gxbp_plane_parts(cx, inner, n, &splitter)) break;
        gxbp_drop_free_plane(cx, points, planes);
    }
    if (k == ranks) return GX_OK;
    result = gxbp_ready_leaf(cx, leaf, &splitter);
    if (result == GX_OK) gxbp_part_leaf(cx, leaf, &splitter, task, node);
    return result;
}

/* >>insert: a triangle into the leaves that it meets --------------------------------------------------------------- */
/* In: a triangle with its plane. Out: leaves divided by its plane, walls and labels on what it covers. A
   transaction is open; after an error the complex must be rolled back. */

/* The polygon is the triangle's part in the leaf. Divides the leaf, and labels the part of the facet between the halves
 * that the triangle covers. */
static gx_result gxbp_divide_leaf(gxb_complex *cx, gxb_triangle *t, uint32_t leaf, const gxbp_task *task) {
    const uint32_t element = cx->leaves[leaf].element;
    gxbp_splitter splitter;
    gxbp_task half;
    uint32_t i, edges = 0, middle, node, freed[2] = {GXB_NONE, GXB_NONE};
    gx_result result;
    memset(&splitter, 0, sizeof splitter);
    splitter.plane = t->plane;
    result = gxbp_ready_leaf(cx, leaf, &splitter);
    if (result != GX_OK) return result;
    for (i = 0; i < task->count; i++) {
        const uint32_t carrier = cx->corners[task->first + i].carrier;
        if (carrier >= GXBP_TRIANGLE_EDGE) edges |= 1u << (carrier - GXBP_TRIANGLE_EDGE);
    }
    middle = gxbp_part_leaf(cx, leaf, &splitter, task, &node);
    result = gxbp_cover_facet(cx, t, middle, edges);
    half.parent = node;
    for (half.side = 0; half.side < 2 && result == GX_OK; half.side++)
        if (cx->leaves[cx->nodes[node].child[half.side] >> 1].facet_count >= GXBP_MANY_FACETS)
            result = gxbp_divide_crowded(cx, &half, &freed[half.side]);
    if (result == GX_OK) result = gxbp_grow_tree(cx, node, element);
    for (i = 0; i < 2 && result == GX_OK; i++)
        if (freed[i] != GXB_NONE) result = gxbp_grow_tree(cx, freed[i], element);
    return result;
}

static GXBP_APART void gxbp_push_task(gxb_complex *cx, uint32_t parent, uint32_t side, uint32_t first, uint32_t count,
                                      uint32_t coplanar) {
    gxbp_task *task = &cx->tasks[cx->task_count++];
    task->parent = parent;
    task->side = side;
    task->first = first;
    task->count = count;
    task->coplanar = coplanar;
}

/* Which leaves a triangle may reach; NULL: all */
typedef struct gxbp_permit {
    int (*allowed)(void *user, uint32_t leaf);
    void *user;
} gxbp_permit;

static int gxbp_may_reach(const gxb_complex *cx, const gxbp_permit *permit, uint32_t leaf) {
    return !cx->leaves[leaf].removed && (permit->allowed == NULL || permit->allowed(permit->user, leaf));
}

/* Covers the parts of a node's facet in the triangle's plane, down the tree of its parts. The polygon is the triangle's
   part there. Its way is short where a plane carries thousands of triangles. */
static gx_result gxbp_cover_parts(gxb_complex *cx, gxb_triangle *t, const gxbp_task *task, uint32_t facet,
                                  const gxbp_permit *permit) {
    const gxb_facet f = cx->facets[facet];
    gx_result result = GX_OK;
    int sides;
    if (f.child == GXB_NONE)
        return gxbp_may_reach(cx, permit, f.leaf[0]) || gxbp_may_reach(cx, permit, f.leaf[1])
                 ? gxbp_cover_facet(cx, t, facet, 7)
                 : GX_OK;
    sides = gxbp_corner_sides(cx, task->first, task->count, f.loop);
    if (sides & 1) result = gxbp_cover_parts(cx, t, task, f.child, permit);
    if (sides & 2 && result == GX_OK) result = gxbp_cover_parts(cx, t, task, f.child + 1, permit);
    return result;
}

/* Sends the polygon of the task down the tree by one node. Where it lies in the node's plane, the node's facet
   leads to all that it covers. */
static gx_result gxbp_descend(gxb_complex *cx, gxb_triangle *t, const gxbp_task *task, uint32_t node,
                              const gxbp_permit *permit) {
    const uint32_t plane = cx->nodes[node].plane;
    gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, corners, corner, 2 * (size_t)task->count + 8);
    int sides;
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, tasks, task, 2);
    if (result != GX_OK) return result;
    sides = plane == t->plane ? 0 : gxbp_corner_sides(cx, task->first, task->count, plane);
    if (sides == 0 && cx->nodes[node].facet != GXB_NONE)
        return gxbp_cover_parts(cx, t, task, cx->nodes[node].facet, permit);
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

/* The section of an element with the triangle's plane, which has nodes on both sides or contains three. It is a polygon
   of three corners where one node is alone on its side, else of four. A corner is a node or a point of the edge between
   two nodes. It starts a side that lies in the face opposite to a third node. */
static uint32_t gxbp_choose_section(const int sign[4], uint8_t corners[4][3]) {
    uint8_t node[2][4];
    uint32_t count[2] = {0, 0}, k, side;
    for (k = 0; k < 4; k++) {
        side = sign[k] > 0 ? 0u : 1u;
        if (sign[k] != 0) node[side][count[side]++] = (uint8_t)k;
    }
    if (count[0] == 2 && count[1] == 2) {
        for (k = 0; k < 4; k++) {
            corners[k][0] = node[0][k >> 1];
            corners[k][1] = node[1][(k + 1) >> 1 & 1];
            corners[k][2] = k & 1 ? node[1][k >> 1] : node[0][1 - (k >> 1)];
        }
        return 4;
    }
    side = count[0] == 1 ? 0u : 1u;
    for (k = 0; k < 3; k++) {
        const uint8_t *rest = gxbp_face_nodes[node[side][0]];
        corners[k][0] = node[side][0];
        corners[k][1] = rest[k];
        corners[k][2] = rest[(k + 2) % 3];
    }
    return 3;
}

/* The point that divided a mesh edge first, if this plane divided it there, for another element around the edge.
 * GXB_NONE: another plane did, or none. */
static uint32_t gxbp_made_crossing(const gxb_complex *cx, uint32_t mesh_edge, uint32_t plane) {
    const uint32_t child = cx->edges[cx->mesh_edge[mesh_edge]].child;
    const uint32_t point = child < GXB_UNLISTED ? cx->edges[child].v[1] : GXB_NONE;
    return point != GXB_NONE && cx->store.points[point].kind == GXB_LINE_PLANE &&
                   cx->store.points[point].def[2] == plane
             ? point
             : GXB_NONE;
}

/* Pushes a corner of an element's section: local node j, or the point of the edge between nodes i and j. */
static void gxbp_push_section_corner(gxb_complex *cx, const gxb_triangle *t, uint32_t element, uint32_t i, uint32_t j,
                                     int sign, uint32_t carrier) {
    const uint32_t *node = cx->elements + 4 * (size_t)element, p = node[i], q = node[j];
    gxbp_corner *c = &cx->corners[cx->corner_count++];
    memset(c, 0, sizeof *c);
    c->carrier = carrier;
    c->point = GXB_NONE;
    if (sign == 0) {
        c->kind = GXB_EXPLICIT;
        c->point = q;
        c->ball = cx->store.points[q].ball;
        return;
    }
    c->kind = GXB_LINE_PLANE;
    c->def[0] = p < q ? p : q;
    c->def[1] = p < q ? q : p;
    c->def[2] = t->plane;
    c->point = gxbp_made_crossing(cx, cx->element_edges[6 * element + gxbp_local_edge(i, j)], t->plane);
    if (c->point != GXB_NONE)
        c->ball = cx->store.points[c->point].ball;
    else
        gxbp_definition_ball(&cx->store, c->kind, c->def, &c->ball);
}

/* Signs of corners: 1 on the triangle's side of its edge k, -1 beyond. Bit 1 of *sides: some are on its side, bit 2:
 * some beyond. */
static gx_result gxbp_edge_sides(gxb_complex *cx, gxb_triangle *t, uint32_t k, uint32_t first, uint32_t count,
                                 int *sides) {
    const gxb_cplane *f = &cx->store.planes[t->plane];
    const gxb_ball *p = &cx->store.points[t->point[k]].ball, *q = &cx->store.points[t->point[(k + 1) % 3]].ball;
    const int x = (int)(f->axis + 1) % 3, y = (int)(f->axis + 2) % 3, turn = f->axis_sign * t->orientation;
    uint32_t i;
    *sides = 0;
    for (i = first; i < first + count; i++) {
        gxbp_corner *c = &cx->corners[i];
        c->sign = c->ball.error < GXBP_NO_BALL ? turn * gxbp_filter_turn(p, q, &c->ball, x, y) : 0;
        if (c->sign == 0) {
            int front;
            const gx_result result = gxbp_edge_plane(cx, t, k, &front);
            if (result != GX_OK) return result;
            c->sign = front * gxbp_corner_sign(cx, c, t->edge_plane[k]);
        }
        *sides |= c->sign > 0 ? 1 : c->sign < 0 ? 2 : 0;
    }
    return GX_OK;
}

/* Is the triangle inside the element, or at most on faces of it? */
static int gxbp_triangle_is_inside(gxb_complex *cx, const gxb_triangle *t, uint32_t element) {
    uint32_t k, i;
    for (k = 0; k < 4; k++) {
        const uint32_t face = cx->element_faces[4 * element + k], plane = cx->facets[cx->face_facet[face]].plane;
        const int inside = cx->face_elements[2 * face] == element ? 1 : -1;
        for (i = 0; i < 3; i++)
            if (inside * gxbp_store_side(&cx->store, t->point[i], plane) < 0) return 0;
    }
    return 1;
}

/* The triangle as a polygon. */
static void gxbp_push_triangle(gxb_complex *cx, const gxb_triangle *t) {
    uint32_t k;
    for (k = 0; k < 3; k++) {
        gxbp_corner *c = &cx->corners[cx->corner_count++];
        memset(c, 0, sizeof *c);
        c->ball = cx->store.points[t->point[k]].ball;
        c->kind = GXB_EXPLICIT;
        c->point = t->point[k];
        c->carrier = GXBP_TRIANGLE_EDGE + k;
    }
}

/* The part of the triangle in an element that has nodes on both sides of its plane, or three in it: the triangle
   itself, or the plane's section clipped by the triangle's edges. task->count 0: nothing. */
static gx_result gxbp_clip_to_element(gxb_complex *cx, gxb_triangle *t, uint32_t element, const int sign[4],
                                      gxbp_task *task) {
    uint8_t corners[4][3];
    uint32_t k, first;
    int sides;
    gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, corners, corner, 40);
    if (result != GX_OK) return result;
    cx->corner_count = cx->task_count = 0;
    task->parent = GXBP_IN_ROOT;
    task->side = 0;
    task->first = 0;
    task->count = 3;
    task->coplanar = (sign[0] == 0) + (sign[1] == 0) + (sign[2] == 0) + (sign[3] == 0) == 3;
    if (gxbp_triangle_is_inside(cx, t, element)) {
        gxbp_push_triangle(cx, t);
        return GX_OK;
    }
    task->count = gxbp_choose_section(sign, corners);
    for (k = 0; k < task->count; k++)
        gxbp_push_section_corner(cx, t, element, corners[k][0], corners[k][1], sign[corners[k][1]],
                                 gxbp_face_plane(cx, element, corners[k][2]));
    for (k = 0; k < 3 && task->count > 0; k++) {
        result = gxbp_edge_sides(cx, t, k, task->first, task->count, &sides);
        if (result != GX_OK) return result;
        if (sides == 1) continue;
        first = cx->corner_count;
        task->count = gxbp_clip(cx, t, task->first, task->count, GXBP_TRIANGLE_EDGE + k, 1);
        task->first = first;
    }
    return GX_OK;
}

/* Does the triangle's plane miss the element, or meet it in a node or an edge only? sign: the nodes against the plane
 */
static int gxbp_misses_plane(gxb_complex *cx, const gxb_triangle *t, uint32_t element, int sign[4]) {
    int sides = 0, zeros = 0, k;
    for (k = 0; k < 4; k++) {
        sign[k] = gxbp_sign(&cx->store, cx->elements[4 * element + (uint32_t)k], t->plane, 0);
        sides |= sign[k] > 0 ? 1 : sign[k] < 0 ? 2 : 0;
        zeros += sign[k] == 0;
    }
    return sides != 3 && zeros < 3;
}

GXFEM_API gx_result gxb_complex_insert(gxb_complex *cx, gxb_triangle *t, uint32_t element,
                                       int (*allowed)(void *user, uint32_t leaf), void *user) {
    gxbp_permit permit;
    gxbp_task task;
    gx_result result;
    int sign[4];
    permit.allowed = allowed;
    permit.user = user;
    if (cx->root[element] == 2 * element && cx->leaves[element].removed) return GX_OK;
    if (cx->sign_plane != t->plane) {
        cx->sign_plane = t->plane;
        gxbp_forget_signs(&cx->store, 0);
    }
    if (gxbp_misses_plane(cx, t, element, sign)) return GX_OK;
    result = gxb_complex_open_element(cx, element);
    if (result == GX_OK) result = gxbp_clip_to_element(cx, t, element, sign, &task);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, tasks, task, 1);
    if (result != GX_OK || task.count == 0) return result;
    cx->tasks[cx->task_count++] = task;
    while (cx->task_count > 0 && result == GX_OK) {
        uint32_t reference;
        task = cx->tasks[--cx->task_count];
        reference = *gxbp_reference(cx, &task, element);
        if (reference & 1)
            result = gxbp_descend(cx, t, &task, reference >> 1, &permit);
        else if (!gxbp_may_reach(cx, &permit, reference >> 1))
            continue;
        else if (task.coplanar)
            result = gxbp_cover_leaf(cx, t, reference >> 1);
        else
            result = gxbp_divide_leaf(cx, t, reference >> 1, &task);
    }
    return result;
}

/* >>ahead: an element that many triangles are about to meet -------------------------------------------------------- */
/* In: triangles that are to be inserted, or a sample of them. Out: leaves divided by free planes, until few triangles
   begin in each. Divided one triangle at a time, leaves are large before they are crowded, and their tree is a spine;
   here they have no facet of a triangle yet, and the tree is balanced. */

typedef struct gxbp_crowd {
    const double *vertices;    /* x 3 */
    const uint32_t *triangles; /* x 3 */
    uint32_t *list;            /* indices of triangles; as many words of room follow */
} gxbp_crowd;

static const double *gxbp_crowd_corner(const gxbp_crowd *crowd, uint32_t i, int k) {
    return crowd->vertices + 3 * (size_t)crowd->triangles[3 * (size_t)crowd->list[i] + (size_t)k];
}

/* Does a quarter of the task's triangles at least lie in front of a plane across an axis, and a quarter behind it? */
static int gxbp_position_parts(const gxbp_crowd *crowd, const gxbp_task *task, int axis, double position) {
    uint32_t front = 0, behind = 0, i;
    for (i = task->first; i < task->first + task->count; i++) {
        int sides = 0, k;
        for (k = 0; k < 3; k++)
            sides |= gxbp_compare_doubles(gxbp_crowd_corner(crowd, i, k)[axis], position) > 0 ? 1 : 2;
        front += sides == 1;
        behind += sides == 2;
    }
    return front >= task->count / 4 && behind >= task->count / 4;
}

/* Divides the leaf at the task's place by a free plane that parts the triangles well, if there is one. Then a node is
   in the leaf's place. */
static GXBP_COLD gx_result gxbp_part_crowd(gxb_complex *cx, const gxbp_crowd *crowd, const gxbp_task *task,
                                           uint32_t element) {
    const uint32_t leaf = *gxbp_reference(cx, task, element) >> 1, points = cx->store.point_count,
                   planes = cx->store.plane_count;
    uint32_t i, node;
    double median[3];
    int rank[3], ranks, k;
    gxbp_sample sample;
    gxbp_splitter splitter;
    gx_result result = GX_OK;
    for (i = sample.count = 0; i < task->count; i += gxbp_sample_step(task->count))
        gxbp_add_to_sample(&sample, gxbp_crowd_corner(crowd, task->first + i, 0));
    ranks = gxbp_medians(&sample, median, rank);
    memset(&splitter, 0, sizeof splitter);
    splitter.slot = 1;
    for (k = 0; k < ranks; k++) {
        if (!gxbp_position_parts(crowd, task, rank[k], median[rank[k]])) continue;
        result = gxbp_new_free_plane(cx, element, rank[k], median[rank[k]], &splitter.plane);
        if (result != GX_OK) return result;
        gxbp_forget_signs(&cx->store, 1);
        if (gxbp_leaf_sides(cx, leaf, &splitter) == 3) break;
        gxbp_drop_free_plane(cx, points, planes);
    }
    if (k == ranks) return GX_OK;
    result = gxbp_ready_leaf(cx, leaf, &splitter);
    if (result == GX_OK) gxbp_part_leaf(cx, leaf, &splitter, task, &node);
    return result;
}

/* Sends the triangles of the task down by one node, by their first corners. They keep their order. */
static gx_result gxbp_descend_crowd(gxb_complex *cx, const gxbp_crowd *crowd, const gxbp_task *task, uint32_t count,
                                    uint32_t node) {
    uint32_t *list = crowd->list, *spare = crowd->list + count;
    uint32_t i, front = 0, behind = 0;
    const gx_result result = GXBP_RESERVE(&cx->store.allocator, cx, tasks, task, 2);
    if (result != GX_OK) return result;
    for (i = task->first; i < task->first + task->count; i++) {
        gxbp_place place;
        gxbp_place_init(&cx->store, gxbp_crowd_corner(crowd, i, 0), &place);
        if (gxbp_place_side(&cx->store, &place, cx->nodes[node].plane) < 0)
            spare[behind++] = list[i];
        else
            list[task->first + front++] = list[i];
    }
    memcpy(list + task->first + front, spare, behind * sizeof *list);
    gxbp_push_task(cx, node, 0, task->first, front, 0);
    gxbp_push_task(cx, node, 1, task->first + front, behind, 0);
    return GX_OK;
}

GXFEM_API gx_result gxb_complex_part(gxb_complex *cx, uint32_t element, const double *vertices,
                                     const uint32_t *triangles, uint32_t *list, uint32_t count, uint32_t few,
                                     int (*allowed)(void *user, uint32_t leaf), void *user) {
    gxbp_crowd crowd;
    gxbp_permit permit;
    gxbp_task task;
    uint32_t made = cx->tree_count;
    gx_result result = gxb_complex_open_element(cx, element);
    if (result == GX_OK) result = GXBP_RESERVE(&cx->store.allocator, cx, tasks, task, 1);
    if (result != GX_OK) return result;
    crowd.vertices = vertices;
    crowd.triangles = triangles;
    crowd.list = list;
    permit.allowed = allowed;
    permit.user = user;
    cx->task_count = 0;
    gxbp_push_task(cx, GXBP_IN_ROOT, 0, 0, count, 0);
    while (cx->task_count > 0 && result == GX_OK) {
        uint32_t reference;
        task = cx->tasks[--cx->task_count];
        if (task.count < few || task.count < 2) continue;
        reference = *gxbp_reference(cx, &task, element);
        if (!(reference & 1) && gxbp_may_reach(cx, &permit, reference >> 1)) {
            result = gxbp_part_crowd(cx, &crowd, &task, element);
            reference = *gxbp_reference(cx, &task, element);
        }
        if ((reference & 1) && result == GX_OK) result = gxbp_descend_crowd(cx, &crowd, &task, count, reference >> 1);
    }
    for (; made < cx->tree_count && result == GX_OK; made++) result = gxbp_grow_tree(cx, made, element);
    return result;
}

/* >>inside: winding numbers around points that are no doubles ------------------------------------------------------ */
/* In: a leaf and a closed surface. Out: the exact winding number around a point inside the leaf. Changes nothing. */

/* A point in the given coordinates times 2^shift: homogeneous, and roughly. */
typedef struct gxbp_probe {
    gxbp_vec exact;
    double rough[3];
    int shift;
} gxbp_probe;

static GXBP_COLD void gxbp_probe_init(gxb_store *store, const uint32_t *points, size_t count, gxbp_probe *probe) {
    size_t i;
    int k;
    gxbp_vec_init(&probe->exact);
    probe->shift = store->shift;
    for (i = 0; i < count; i++) {
        gxbp_vec own;
        const gxb_num *x = gxbp_exact_cpoint(store, points[i], &own);
        for (k = 0; k < 4; k++) gxbp_num_increase(&probe->exact.c[k], &x[k], 1);
    }
    for (k = 0; k < 3; k++) {
        GXB_NUM(origin);
        GXB_NUM(t);
        gxb_num_set(&origin, store->origin[k], store->shift);
        gxb_num_mul(&t, &origin, &probe->exact.c[3]);
        gxbp_num_increase(&probe->exact.c[k], &t, 1);
        probe->rough[k] = gxb_num_ratio(&probe->exact.c[k], &probe->exact.c[3]);
    }
}

/* Is the probe certainly beyond the triangle's box along y or z, or past it along x? The margin is far above the
 * rounding. */
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
static GXBP_COLD int gxbp_probe_side(const gxbp_probe *probe, const double a[3], const double b[3]) {
    gxbp_vec p, q;
    gxbp_large row;
    GXB_NUM(r);
    int k, sign;
    gxbp_vec_init(&p);
    gxbp_vec_init(&q);
    gxbp_large_init(&row);
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
static GXBP_COLD int gxbp_probe_orient(const gxbp_probe *probe, const double *const x[3]) {
    gxbp_vec p[3];
    gxbp_large n;
    GXB_NUM(r);
    int k, c;
    for (c = 0; c < 3; c++) {
        gxbp_vec_init(&p[c]);
        for (k = 0; k < 3; k++) gxb_num_set(&p[c].c[k], x[c][k], probe->shift);
    }
    gxbp_large_init(&n);
    gxbp_exact_plane(n.c, p[0].c, p[1].c, p[2].c);
    gxbp_exact_side(&r, probe->exact.c, n.c);
    return -r.sign;
}

GXFEM_API int gxb_complex_winding(gxb_complex *cx, const uint32_t *points, size_t point_count, const double *vertices,
                                  const uint32_t *triangles, size_t triangle_count) {
    gxbp_probe probe;
    int winding = 0, c;
    size_t t;
    gxbp_probe_init(&cx->store, points, point_count, &probe);
    for (t = 0; t < triangle_count; t++) {
        const double *x[3];
        int side;
        for (c = 0; c < 3; c++) x[c] = vertices + 3 * (size_t)triangles[3 * t + (size_t)c];
        if (gxbp_probe_misses(&probe, x)) continue;
        side = gxbp_probe_side(&probe, x[0], x[1]);
        if (side == 0 || gxbp_probe_side(&probe, x[1], x[2]) != side || gxbp_probe_side(&probe, x[2], x[0]) != side)
            continue;
        if (gxbp_probe_orient(&probe, x) == side) winding += side;
    }
    return winding;
}

/* >>barycentric: barycentric coordinates of points in their elements ----------------------------------------------- */
/* In: a point of the complex and an element. Out: its barycentric coordinates, rounded once, or as pairs, or
   exactly. Changes nothing but the cache of exact numbers. */

/* Exact distance of a point from a plane, times |n| and the point's weight W, which goes to *weight (may be NULL). */
static void gxbp_distance(gxb_complex *cx, uint32_t point, uint32_t plane, gxb_num *distance, gxb_num *weight) {
    gxbp_vec sn, sx;
    const gxb_num *n = gxbp_exact_cplane(&cx->store, plane, &sn), *x = gxbp_exact_cpoint(&cx->store, point, &sx);
    gxbp_exact_side(distance, x, n);
    if (weight != NULL) gxbp_num_copy(weight, &x[3], 1);
}

static GXBP_COLD void gxbp_exact_edge_parameter(gxb_complex *cx, gxb_cpoint *p) {
    GXB_NUM(a);
    GXB_NUM(b);
    GXB_NUM(d);
    gxbp_distance(cx, p->def[0], p->def[2], &a, NULL);
    gxbp_distance(cx, p->def[1], p->def[2], &b, NULL);
    gxb_num_sub(&d, &b, &a);
    p->parameter[0] = gxb_num_ratio(&b, &d); /* the share of def[0] */
    p->parameter[1] = -gxb_num_ratio(&a, &d);
}

/* Finds by pairs where on the mesh edge the point lies. 0: they do not settle it */
static int gxbp_pair_on_edge(gxb_complex *cx, uint32_t point) {
    gxb_cpoint *p = &cx->store.points[point];
    const gxbp_pair a = gxbp_pair_side(cx, p->def[0], p->def[2]), b = gxbp_pair_side(cx, p->def[1], p->def[2]);
    const gxbp_pair d = gxbp_pair_add(&b, &a, -1), e = gxbp_pair_add(&a, &b, -1);
    double parameter[2];
    if (!gxbp_pair_ratio(&b, &d, &parameter[0]) || !gxbp_pair_ratio(&a, &e, &parameter[1])) return 0;
    memcpy(p->parameter, parameter, sizeof parameter);
    return 1;
}

/* Where on the mesh edge from node def[0] to node def[1] the point lies: 0 ... 1. Kept, since every element around the
 * edge needs it. */
static double gxbp_edge_parameter(gxb_complex *cx, uint32_t point, int from_end) {
    gxb_cpoint *p = &cx->store.points[point];
    if (p->parameter[0] < 0 && !gxbp_pair_on_edge(cx, point)) gxbp_exact_edge_parameter(cx, p);
    return p->parameter[from_end];
}

/* lambda[k] where no arithmetic is needed: 1 or 0 at nodes, 0 on a face by definition. Else -1 */
static int gxbp_known_lambda(const gxb_complex *cx, uint32_t point, uint32_t element, uint32_t k) {
    const gxb_cpoint *p = &cx->store.points[point];
    const uint32_t face = cx->element_faces[4 * element + k];
    if (point < cx->node_count) return point == cx->elements[4 * element + k];
    return gxbp_incident(&cx->store, p->kind, p->def, point, cx->facets[cx->face_facet[face]].plane) ? 0 : -1;
}

static int gxbp_has_node(const gxb_complex *cx, uint32_t element, uint32_t node) {
    const uint32_t *n = cx->elements + 4 * (size_t)element;
    return n[0] == node || n[1] == node || n[2] == node || n[3] == node;
}

/* Does the point divide an edge of the element? */
static int gxbp_divides_edge(const gxb_complex *cx, uint32_t point, uint32_t element) {
    const gxb_cpoint *p = &cx->store.points[point];
    return p->kind == GXB_LINE_PLANE && gxbp_has_node(cx, element, p->def[0]) && gxbp_has_node(cx, element, p->def[1]);
}

GXFEM_API unsigned gxb_complex_support(const gxb_complex *cx, uint32_t point, uint32_t element) {
    const gxb_cpoint *p = &cx->store.points[point];
    const int on_edge = gxbp_divides_edge(cx, point, element);
    unsigned support = 0;
    uint32_t k;
    for (k = 0; k < 4; k++) {
        const uint32_t node = cx->elements[4 * element + k];
        if (on_edge ? node == p->def[0] || node == p->def[1] : gxbp_known_lambda(cx, point, element, k) != 0)
            support |= 1u << k;
    }
    return support;
}

/* Shares of a given point: its sides of the faces */
static void gxbp_pair_point_shares(gxb_complex *cx, uint32_t point, uint32_t element, gxbp_pair share[4]) {
    uint32_t k;
    for (k = 0; k < 4; k++) {
        share[k] = gxbp_pair_side(cx, point, gxbp_face_plane(cx, element, k));
        if (cx->face_elements[2 * cx->element_faces[4 * element + k]] != element) {
            share[k].high = -share[k].high;
            share[k].low = -share[k].low;
        }
    }
}

/* Shares of a point on a line and a plane. The line's two points have sides a and b of the plane; it is b p - a q. */
static void gxbp_pair_line_shares(gxb_complex *cx, const uint32_t def[3], uint32_t element, const double lambda[4],
                                  gxbp_pair share[4]) {
    const gxbp_pair a = gxbp_pair_side(cx, def[0], def[2]), b = gxbp_pair_side(cx, def[1], def[2]);
    uint32_t k;
    for (k = 0; k < 4; k++)
        if (lambda[k] < 0) {
            const uint32_t face = gxbp_face_plane(cx, element, k);
            const gxbp_pair p = gxbp_pair_side(cx, def[0], face), q = gxbp_pair_side(cx, def[1], face);
            if (cx->face_elements[2 * cx->element_faces[4 * element + k]] == element)
                share[k] = gxbp_pair_det2(&p, &b, &q, &a);
            else
                share[k] = gxbp_pair_det2(&q, &a, &p, &b);
        }
}

/* Shares of a point of three planes, by the nodes' sides of these. For each plane, the sum of sides x coordinates is 0,
   so the coordinates are the minors of the sides. */
static void gxbp_pair_plane_shares(gxb_complex *cx, const uint32_t def[3], uint32_t element, const double lambda[4],
                                   gxbp_pair share[4]) {
    const uint32_t *node = cx->elements + 4 * (size_t)element;
    gxbp_pair side[3][4];
    uint32_t i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 4; k++) side[i][k] = gxbp_pair_side(cx, node[k], def[i]);
    for (k = 0; k < 4; k++)
        if (lambda[k] < 0) {
            const uint8_t *rest = gxbp_face_nodes[k]; /* k and these are an even permutation of 0 1 2 3 */
            gxbp_pair row[3], cofactor[3];
            for (i = 0; i < 3; i++) {
                const uint32_t j = rest[(i + 1) % 3], l = rest[(i + 2) % 3];
                cofactor[i] = gxbp_pair_det2(&side[0][j], &side[1][l], &side[0][l], &side[1][j]);
                row[i] = side[2][rest[i]];
            }
            share[k] = gxbp_pair_dot(row, cofactor);
        }
}

/* Is this the plane of a mesh face? Such are defined by nodes. */
static int gxbp_is_face_plane(const gxb_complex *cx, uint32_t plane) {
    const gxb_cplane *f = &cx->store.planes[plane];
    return f->def[0] < cx->node_count && f->def[1] < cx->node_count && f->def[2] < cx->node_count && !f->along_axis;
}

/* Coordinates of a point in a mesh face: the minors of the face's nodes' sides of its two other planes. 0: pairs do not
   settle them, or the point is in planes of two faces. */
static int gxbp_pair_in_face(gxb_complex *cx, uint32_t point, uint32_t face) {
    gxb_cpoint *p = &cx->store.points[point];
    const uint32_t *node = cx->store.planes[p->def[face]].def;
    gxbp_pair side[2][3], share[3], sum;
    double parameter[3];
    uint32_t i, k;
    for (i = 0; i < 2; i++) {
        const uint32_t plane = p->def[(face + 1 + i) % 3];
        if (gxbp_is_face_plane(cx, plane)) return 0;
        for (k = 0; k < 3; k++) side[i][k] = gxbp_pair_side(cx, node[k], plane);
    }
    for (k = 0; k < 3; k++) {
        const uint32_t j = (k + 1) % 3, l = (k + 2) % 3;
        share[k] = gxbp_pair_det2(&side[0][j], &side[1][l], &side[0][l], &side[1][j]);
    }
    sum = gxbp_pair_add(&share[0], &share[1], 1);
    sum = gxbp_pair_add(&sum, &share[2], 1);
    for (k = 0; k < 3; k++)
        if (!gxbp_pair_ratio(&share[k], &sum, &parameter[k])) return 0;
    memcpy(p->parameter, parameter, sizeof p->parameter);
    return 1;
}

/* Coordinates of a point of three planes, one of which is that of a mesh face of the element. They are kept, since both
   elements beside the face need them. 0: there is no such plane, or pairs do not settle them. */
static int gxbp_face_barycentric(gxb_complex *cx, uint32_t point, uint32_t element, double lambda[4]) {
    const gxb_cpoint *p = &cx->store.points[point];
    const uint32_t *n = cx->elements + 4 * (size_t)element, *node;
    uint32_t face = 0, found = 0, i, k;
    while (face < 3 && !gxbp_is_face_plane(cx, p->def[face])) face++;
    if (face == 3) return 0;
    node = cx->store.planes[p->def[face]].def;
    for (k = 0; k < 4; k++) found += n[k] == node[0] || n[k] == node[1] || n[k] == node[2];
    if (found < 3 || (p->parameter[0] < 0 && !gxbp_pair_in_face(cx, point, face))) return 0;
    for (k = 0; k < 4; k++) {
        lambda[k] = 0;
        for (i = 0; i < 3; i++)
            if (n[k] == node[i]) lambda[k] = p->parameter[i];
    }
    return 1;
}

/* Each task has a cache of pairs of its own. */
GXFEM_API void gxb_complex_prepare_points(gxb_complex *cx, uint32_t first, uint32_t end) {
    gxb_complex own = *cx;
    gxbp_pairs pairs;
    uint32_t face;
    own.pairs = &pairs;
    gxbp_forget_pairs(&own);
    for (; first < end; first++) {
        const gxb_cpoint *p = &own.store.points[first];
        if (p->kind == GXB_LINE_PLANE && p->def[1] < own.node_count) (void)gxbp_pair_on_edge(&own, first);
        for (face = 0; p->kind == GXB_THREE_PLANES && face < 3; face++) {
            if (!gxbp_is_face_plane(&own, p->def[face])) continue;
            (void)gxbp_pair_in_face(&own, first, face);
            break;
        }
    }
}

/* Computes by pairs the coordinates that are not known yet (-1). Those that pairs do not settle stay -1. */
static void gxbp_pair_barycentric(gxb_complex *cx, uint32_t point, uint32_t element, double lambda[4]) {
    const gxb_cpoint p = cx->store.points[point];
    gxbp_pair share[4], sum = gxbp_pair_sum(0, 0);
    uint32_t k;
    if (p.kind == GXB_EXPLICIT)
        gxbp_pair_point_shares(cx, point, element, share);
    else if (p.kind == GXB_LINE_PLANE)
        gxbp_pair_line_shares(cx, p.def, element, lambda, share);
    else
        gxbp_pair_plane_shares(cx, p.def, element, lambda, share);
    for (k = 0; k < 4; k++)
        if (lambda[k] < 0) sum = gxbp_pair_add(&sum, &share[k], 1);
    for (k = 0; k < 4; k++) {
        double ratio;
        if (lambda[k] < 0 && gxbp_pair_ratio(&share[k], &sum, &ratio)) lambda[k] = ratio;
    }
}

static GXBP_COLD double gxbp_exact_lambda(gxb_complex *cx, uint32_t point, uint32_t element, uint32_t k) {
    const uint32_t plane = gxbp_face_plane(cx, element, k);
    GXB_NUM(d);
    GXB_NUM(w);
    GXB_NUM(h);
    gxbp_distance(cx, cx->elements[4 * element + k], plane, &h, NULL);
    gxbp_distance(cx, point, plane, &d, &w);
    return gxb_num_ratio(&d, &w) / gxb_num_to_double(&h);
}

GXFEM_API void gxb_complex_barycentric(gxb_complex *cx, uint32_t point, uint32_t element, double lambda[4]) {
    const gxb_cpoint *p = &cx->store.points[point];
    const int on_edge = gxbp_divides_edge(cx, point, element);
    uint32_t k;
    if (p->kind == GXB_THREE_PLANES && gxbp_face_barycentric(cx, point, element, lambda)) return;
    for (k = 0; k < 4; k++) {
        const uint32_t node = cx->elements[4 * element + k];
        if (!on_edge)
            lambda[k] = gxbp_known_lambda(cx, point, element, k);
        else
            lambda[k] = node == p->def[0] ? gxbp_edge_parameter(cx, point, 0)
                      : node == p->def[1] ? gxbp_edge_parameter(cx, point, 1)
                                          : 0;
    }
    if (on_edge || point < cx->node_count) return;
    gxbp_pair_barycentric(cx, point, element, lambda);
    for (k = 0; k < 4; k++)
        if (lambda[k] < 0) lambda[k] = gxbp_exact_lambda(cx, point, element, k);
}

/* The four normals are cross products of two edges of their faces, so all nodes have the same distance from the
   opposite face, six times the element's volume: one denominator serves all. */
GXFEM_API GXBP_RARE void gxb_complex_barycentric_fine(gxb_complex *cx, uint32_t point, uint32_t element,
                                                      gxb_num lambda[4]) {
    GXB_NUM(num);
    GXB_NUM(den);
    GXB_NUM(weight);
    GXB_NUM(height);
    uint32_t k;
    gxbp_distance(cx, cx->elements[4 * element], gxbp_face_plane(cx, element, 0), &height, NULL);
    for (k = 0; k < 4; k++) {
        const int known = gxbp_known_lambda(cx, point, element, k);
        gxb_num_set(&lambda[k], known > 0 ? 1.0 : 0.0, 0);
        if (known >= 0) continue;
        gxbp_distance(cx, point, gxbp_face_plane(cx, element, k), &num, &weight);
        if (den.n == 0) gxb_num_mul(&den, &weight, &height);
        den.sign = num.sign;
        gxbp_num_divide(&lambda[k], &num, &den, 4);
    }
}

GXFEM_API GXBP_RARE void gxb_complex_barycentric_fixed(gxb_complex *cx, uint32_t point, uint32_t element,
                                                       gxb_fixed lambda[4]) {
    gxbp_vec fine;
    uint32_t k;
    gxbp_vec_init(&fine);
    gxb_complex_barycentric_fine(cx, point, element, fine.c);
    for (k = 0; k < 4; k++) gxbp_fixed_set(&lambda[k], &fine.c[k]);
}

/* >>pullback: points of space in moved elements -------------------------------------------------------------------- */
/* In: a point, the corners of an element where they have moved to, a plane of the complex. Out: exact signs and rounded
   barycentric coordinates of the point pulled back. Changes nothing but the cache of exact numbers.
 *
 * With e_i = x_i - p, D_0 = e1.(e2 x e3), D_1 = -e0.(e2 x e3), D_2 = (e0 x e1).e3, D_3 = -(e0 x e1).e2. Each is a sum
 * of six products of three fenced differences, within 10u of the sum of their sizes (see gxbp_cross_size). S is the sum
 * of these sums; GXBP_PULLBACK_ERROR times S is more than twice the error of each.
 */
#define GXBP_PULLBACK_ERROR (24 * GXBP_U)

/* Where S exceeds this multiple of |D|, coordinates come from exact numbers. Rounding to nearest has errors of 2^-53:
   those of the four D_i are below 10 * 2^-53 S together, so those of D_i / D below 40 * 2^-53; the sum, the quotients
   and their sum add 6 at most. All are below 2^-47. */
#define GXBP_PULLBACK_LOSS 4.0

static double gxbp_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* e = corner - point. Fences hide how these were computed: they are taken as the doubles that they are. */
static inline void gxbp_pullback_edge(double e[3], const double corner[3], const double point[3]) {
    e[0] = gxbp_fence(gxbp_fence(corner[0]) - point[0]);
    e[1] = gxbp_fence(gxbp_fence(corner[1]) - point[1]);
    e[2] = gxbp_fence(gxbp_fence(corner[2]) - point[2]);
}

/* The vectors e_i, without a loop, which some compilers would keep */
static inline void gxbp_pullback_edges(double e[4][3], const double corners[12], const double point[3]) {
    double p[3];
    p[0] = gxbp_fence(point[0]);
    p[1] = gxbp_fence(point[1]);
    p[2] = gxbp_fence(point[2]);
    gxbp_pullback_edge(e[0], corners, p);
    gxbp_pullback_edge(e[1], corners + 3, p);
    gxbp_pullback_edge(e[2], corners + 6, p);
    gxbp_pullback_edge(e[3], corners + 9, p);
}

static inline double gxbp_sum_of_sizes(const double a[3]) { return gxbp_abs(a[0]) + gxbp_abs(a[1]) + gxbp_abs(a[2]); }

/* Are the sizes of all products of a sum below 2^500, so that none overflows? */
static int gxbp_is_moderate(double size) { return gxbp_exponent_bits(size) < 1023 + 500; }

/* A product is not above the product of its vectors' sums of sizes. */
GXFEM_API int gxb_pullback_misses(const double corners[12], const double point[3]) {
    double e[4][3], c[3], n[4], d, g, bound;
    int positive, negative;
    gxbp_pullback_edges(e, corners, point);
    n[0] = gxbp_sum_of_sizes(e[0]);
    n[1] = gxbp_sum_of_sizes(e[1]);
    n[2] = gxbp_sum_of_sizes(e[2]);
    n[3] = gxbp_sum_of_sizes(e[3]);
    gxbp_cross(c, e[2], e[3]);
    d = gxbp_dot(e[1], c);
    g = gxbp_dot(e[0], c);
    bound = GXBP_PULLBACK_ERROR * gxbp_max(n[0], n[1]) * n[2] * n[3] + GXBP_TINY;
    if (!gxbp_is_moderate(bound)) return 0;
    positive = (d > bound) | (g < -bound);
    negative = (d < -bound) | (g > bound);
    if (positive & negative) return 1;
    gxbp_cross(c, e[0], e[1]);
    d = gxbp_dot(e[3], c);
    g = gxbp_dot(e[2], c);
    bound = GXBP_PULLBACK_ERROR * gxbp_max(n[2], n[3]) * n[0] * n[1] + GXBP_TINY;
    if (!gxbp_is_moderate(bound)) return 0;
    positive |= (d > bound) | (g < -bound);
    negative |= (d < -bound) | (g > bound);
    return positive & negative;
}

/* a.c, and the size of its products added to *size, where sizes are those of c's own */
static double gxbp_dot_sizes(const double a[3], const double c[3], const double sizes[3], double *size) {
    *size += gxbp_abs(a[0]) * sizes[0] + gxbp_abs(a[1]) * sizes[1] + gxbp_abs(a[2]) * sizes[2];
    return gxbp_dot(a, c);
}

GXFEM_API void gxb_pullback_set(gxb_pullback *back, const double corners[12], const double point[3]) {
    double e[4][3], c[3], sizes[3], size = 0;
    int i;
    back->corners = corners;
    back->point = point;
    back->error = -1;
    back->orientation = 2;
    for (i = 0; i < 4; i++) back->sign[i] = 2;
    gxbp_pullback_edges(e, corners, point);
    gxbp_cross_sizes(c, sizes, e[2], e[3]);
    back->d[0] = gxbp_dot_sizes(e[1], c, sizes, &size);
    back->d[1] = -gxbp_dot_sizes(e[0], c, sizes, &size);
    gxbp_cross_sizes(c, sizes, e[0], e[1]);
    back->d[2] = gxbp_dot_sizes(e[3], c, sizes, &size);
    back->d[3] = -gxbp_dot_sizes(e[2], c, sizes, &size);
    if (!gxbp_is_moderate(size)) return;
    back->error = GXBP_PULLBACK_ERROR * size + GXBP_TINY;
    for (i = 0; i < 4; i++) {
        const int sign = gxbp_filter_sign(back->d[i], back->error);
        if (sign != 0) back->sign[i] = (int8_t)sign;
    }
}

/* The points of which D_i is the determinant, and the point */
static void gxbp_pullback_face(const gxb_pullback *back, int i, const double *p[4]) {
    int j, n = 0;
    for (j = 0; j < 4; j++)
        if (j != i) p[n++] = back->corners + 3 * j;
    p[3] = back->point;
}

/* The sign of D_i; decides it where it is not certain. */
static int gxbp_pullback_sign(gxb_pullback *back, int i) {
    const double *p[4];
    int sign;
    if (back->sign[i] != 2) return back->sign[i];
    gxbp_pullback_face(back, i, p);
    sign = gxbp_orient3d_exact(p);
    back->sign[i] = (int8_t)(i % 2 == 0 ? sign : -sign);
    return back->sign[i];
}

GXFEM_API int gxb_pullback_contains(gxb_pullback *back) {
    int i, positive = 0, negative = 0;
    for (i = 0; i < 4; i++) {
        positive |= back->sign[i] == 1;
        negative |= back->sign[i] == -1;
    }
    for (i = 0; i < 4 && !(positive && negative); i++) {
        const int sign = gxbp_pullback_sign(back, i);
        positive |= sign > 0;
        negative |= sign < 0;
    }
    if (positive != negative) back->orientation = (int8_t)(positive ? 1 : -1); /* D is the sum of the D_i */
    return positive != negative;
}

GXFEM_API int gxb_pullback_orient(gxb_pullback *back) {
    const double *x = back->corners;
    if (back->orientation == 2) back->orientation = (int8_t)gxb_orient3d(x + 3, x + 6, x + 9, x);
    return back->orientation;
}

/* The exact D_i, and D after them */
typedef struct gxbp_shares {
    gxb_num d[5];
    gxb_limb limbs[5][GXB_NUM_LIMBS];
} gxbp_shares;

/* Degree 3 of any finite doubles: 100 limbs of 64 bits */
static GXBP_COLD void gxbp_exact_shares(const gxb_pullback *back, gxbp_shares *shares) {
    const double *p[5];
    gxbp_vec e[4];
    int i;
    for (i = 0; i < 4; i++) p[i] = back->corners + 3 * i;
    p[4] = back->point;
    gxbp_exact_differences(e, p, 5, 3);
    memset(shares->d, 0, sizeof shares->d);
    for (i = 0; i < 5; i++) shares->d[i].d = shares->limbs[i];
    for (i = 0; i < 4; i++) {
        gxbp_num_det3(&shares->d[i], e[i == 0].c, e[i <= 1 ? 2 : 1].c, e[i <= 2 ? 3 : 2].c);
        if (i % 2 != 0) shares->d[i].sign = -shares->d[i].sign;
        gxbp_num_increase(&shares->d[4], &shares->d[i], 1);
    }
}

static GXBP_COLD void gxbp_exact_weights(const gxb_pullback *back, double lambda[4]) {
    gxbp_shares shares;
    int i;
    gxbp_exact_shares(back, &shares);
    for (i = 0; i < 4; i++) lambda[i] = gxb_num_ratio(&shares.d[i], &shares.d[4]);
}

/* Outside, D is the sum of D_i that may cancel: then it is far below S. */
GXFEM_API void gxb_pullback_weights(gxb_pullback *back, double lambda[4]) {
    const double D = (back->d[0] + back->d[1]) + (back->d[2] + back->d[3]);
    double sum;
    int i, inside = 1;
    if (!(back->error >= 0) || !(back->error <= GXBP_PULLBACK_ERROR * GXBP_PULLBACK_LOSS * gxbp_abs(D)))
        gxbp_exact_weights(back, lambda);
    else {
        for (i = 0; i < 4; i++) lambda[i] = back->sign[i] == 0 ? 0 : back->d[i] / D;
        for (i = 0; i < 4; i++) inside = inside && back->sign[i] * back->orientation >= 0 && back->sign[i] != 2;
        for (i = 0; i < 4 && inside; i++) lambda[i] = gxbp_max(lambda[i], 0);
    }
    sum = (lambda[0] + lambda[1]) + (lambda[2] + lambda[3]);
    for (i = 0; i < 4; i++) lambda[i] /= sum;
}

/* The sides h_i of the corners at rest give that of the material point: D_i h_i, summed, over D. */
static GXBP_COLD int gxbp_exact_pullback_side(gxb_complex *cx, const gxb_pullback *back, uint32_t element,
                                              uint32_t plane) {
    gxbp_shares shares;
    gxbp_vec own, x;
    const gxb_num *n = gxbp_exact_cplane(&cx->store, plane, &own);
    int i;
    GXB_NUM(sum);
    gxbp_exact_shares(back, &shares);
    for (i = 0; i < 4; i++) {
        GXB_NUM(height);
        GXB_NUM(term);
        gxbp_exact_side(&height, gxbp_exact_cpoint(&cx->store, cx->elements[4 * (size_t)element + (uint32_t)i], &x), n);
        gxb_num_mul(&term, &shares.d[i], &height);
        gxbp_num_increase(&sum, &term, 1);
    }
    return sum.sign;
}

GXFEM_API int gxb_complex_pullback_side(gxb_complex *cx, gxb_pullback *back, uint32_t element, uint32_t plane) {
    const int orientation = gxb_pullback_orient(back);
    double value = 0, size = 0, bound = GXBP_TINY;
    int i, sign = 0;
    cx->store.filter_calls++;
    for (i = 0; i < 4 && back->error >= 0; i++) {
        const uint32_t node = cx->elements[4 * (size_t)element + (uint32_t)i];
        double error;
        const double height =
            gxbp_fence(gxbp_filter_side(&cx->store.points[node].ball, &cx->store.planes[plane].filter, &error));
        value += back->d[i] * height;
        size += gxbp_abs(back->d[i] * height);
        bound += 2 * (gxbp_abs(back->d[i]) * error + back->error * (gxbp_abs(height) + error));
    }
    if (back->error >= 0) sign = gxbp_filter_sign(value, bound + 16 * GXBP_U * size);
    if (sign == 0) {
        cx->store.exact_calls++;
        sign = gxbp_exact_pullback_side(cx, back, element, plane);
    }
    return sign * orientation;
}

/* >>census: what a complex still needs ----------------------------------------------------------------------------- */
/* In: a complex. Out: marks on all that leaves that stay have need of; the facets of these leaves
   with their resolved loops. Nothing of the complex changes. */

enum {                   /* of an element */
       GXBP_SOLID = 1,   /* some of it is left */
       GXBP_LISTED = 2,  /* parts of its faces and edges stay listed: nothing has touched it, or it is pinned */
       GXBP_PINNED = 4,  /* it keeps all it has */
       GXBP_CHANGED = 8, /* its leaves, facets or edges become others */
       GXBP_BOUND = 1,   /* of a node: its plane bounds a leaf below it that stays */
       GXBP_WALLED = 2,  /* and separates it from what lies behind */
       GXBP_MARKED = 0,  /* of an item: it stays */
       GXBP_ALIVE = 1    /* and is an undivided facet of a leaf that stays */
};

typedef struct gxbp_piece { /* a facet of a leaf; other: the leaf on its other side. Pieces that agree may be one */
    uint32_t plane, other, status, facet;
} gxbp_piece;

/* Each array has an entry for each item of its kind. What stays has a mark, later its new number; GXB_NONE: it goes */
typedef struct gxbp_census {
    gxb_complex *cx;
    uint32_t *points, *planes, *edges, *facets, *leaves, *labels;
    uint32_t *elements;   /* GXBP_SOLID ... */
    uint32_t *hollow;     /* of an element: its first removed leaf, which stands for all; GXB_NONE: there is none */
    uint32_t *mesh_edges; /* the states of the elements around it */
    uint32_t *face_first, *edge_first; /* of a mesh face, of a mesh edge: its first facet, its first edge */
    uint32_t *roots;                   /* of an element: what its tree becomes */
    uint32_t *leaf_of; /* the leaf that a leaf is part of, the first of these; of one that goes: what stands for it */
    uint32_t *leaf_up; /* the node above a leaf */
    uint32_t *bounds;  /* of a node: GXBP_BOUND ... */
    uint32_t *loop, *loop_count; /* of a facet: its edges, in loops */
    uint32_t *ends;              /* of an edge, 2: its points; before that, marks of its two directions */
    uint32_t *at;                /* of a point, 2: edges that end there, or that leave it along a border */
    uint32_t *owner;             /* of an edge, 2: the facet that has it in this direction */
    uint32_t *group, *facet_of;  /* of a facet: its group; the one of these that has taken it in, or itself */
    uint32_t *first_piece;       /* of a leaf: its facets, in order; one more at the end */
    uint32_t *order;             /* facets by leaf */
    /* the new trees: plane and two children each; of these, leaves have their old numbers */
    uint32_t *nodes, node_count;
    uint32_t *block;
    size_t words;
    /* made when their sizes are known */
    uint32_t *loops, loop_end, loop_room; /* with room to spare: facets that become one have a new loop */
    gxbp_piece *pieces;                   /* of one leaf */
    uint32_t piece_room, round, groups;
    /* trees at work, see >>unite: nodes of one element; pairs of what was united */
    uint32_t *plan, plan_count, plan_room, *pairs, pair_count, pair_room, steps;
    struct gxbp_surround *surrounds; /* of a leaf */
    uint32_t *list_count, *list_end; /* of a leaf: of its new list of facets */
    size_t pool, exact;              /* words of lists, bytes of exact numbers that stay */
    uint32_t *list;                  /* the new pool */
    gxb_block *numbers;              /* the new block of exact numbers, or NULL */
} gxbp_census;

static int gxbp_stays(const gxbp_census *c, uint32_t leaf) {
    const gxb_leaf *l = &c->cx->leaves[leaf];
    return !l->removed || (c->elements[l->element] & GXBP_PINNED);
}

static int gxbp_side_stays(const gxbp_census *c, const gxb_facet *f, uint32_t side) {
    return f->leaf[side] != GXB_NONE && gxbp_stays(c, f->leaf[side]);
}

/* The states of elements, and the leaves that stay */
static void gxbp_mark_leaves(gxbp_census *c, const uint8_t *pinned) {
    gxb_complex *cx = c->cx;
    uint32_t i, k;
    memset(c->elements, 0, cx->element_count * sizeof *c->elements);
    memset(c->mesh_edges, 0, cx->mesh_edge_count * sizeof *c->mesh_edges);
    for (i = 0; i < 4 * cx->element_count && pinned != NULL; i++)
        if (pinned[cx->elements[i]]) c->elements[i / 4] = GXBP_PINNED | GXBP_LISTED | GXBP_SOLID;
    for (i = 0; i < cx->leaf_count; i++) {
        const gxb_leaf *l = &cx->leaves[i];
        c->leaf_of[i] = i;
        if (gxbp_stays(c, i))
            c->elements[l->element] |= l->facet_count > 0 ? GXBP_SOLID : GXBP_SOLID | GXBP_LISTED;
        else if (c->hollow[l->element] == GXB_NONE)
            c->hollow[l->element] = i;
        else
            c->leaf_of[i] = c->hollow[l->element];
    }
    for (i = 0; i < cx->element_count; i++)
        for (k = 0; k < 6; k++) c->mesh_edges[cx->element_edges[6 * i + k]] |= c->elements[i];
}

/* Marks a facet itself. */
static void gxbp_mark_one(gxbp_census *c, uint32_t facet) {
    const gxb_facet *f = &c->cx->facets[facet];
    const int alive = f->child == GXB_NONE && (gxbp_side_stays(c, f, 0) || gxbp_side_stays(c, f, 1));
    c->facets[facet] = alive ? GXBP_ALIVE : GXBP_MARKED;
}

/* Marks an undivided facet with its labels. */
static void gxbp_mark_facet(gxbp_census *c, uint32_t facet) {
    const gxb_facet *f = &c->cx->facets[facet];
    uint32_t l = f->labels, i;
    if (c->facets[facet] != GXB_NONE) return;
    gxbp_mark_one(c, facet);
    for (i = 0; i < f->loop_count; i++) c->loop_room += gxbp_count_edges(c->cx, c->cx->pool[f->loop + i] >> 1);
    for (; l != GXB_NONE && c->labels[l] == GXB_NONE; l = c->cx->labels[l].next) c->labels[l] = 0;
}

/* Marks the parts of a facet; with all that it was divided into on the way, if its parts stay listed. */
static GXBP_COLD void gxbp_mark_facets(gxbp_census *c, uint32_t facet, int listed) {
    const uint32_t child = c->cx->facets[facet].child;
    if (child >= GXB_UNLISTED) {
        gxbp_mark_facet(c, facet);
        return;
    }
    if (listed) gxbp_mark_one(c, facet);
    gxbp_mark_facets(c, child, listed);
    gxbp_mark_facets(c, child + 1, listed);
}

/* Marks an edge with all that it was divided into. The points stay. */
static GXBP_COLD void gxbp_mark_edges(gxbp_census *c, uint32_t edge) {
    const gxb_edge *e = &c->cx->edges[edge];
    c->edges[edge] = c->points[e->v[0]] = c->points[e->v[1]] = 0;
    if (e->child >= GXB_UNLISTED) return;
    gxbp_mark_edges(c, e->child);
    gxbp_mark_edges(c, e->child + 1);
}

static uint32_t gxbp_face_state(const gxbp_census *c, uint32_t face) {
    const uint32_t *e = c->cx->face_elements + 2 * (size_t)face;
    return (e[0] != GXB_NONE ? c->elements[e[0]] : 0) | (e[1] != GXB_NONE ? c->elements[e[1]] : 0);
}

/* The facets of leaves that stay. Of faces and mesh edges either all parts or the first item alone, which still gives a
   face its plane. */
static void gxbp_mark_polygons(gxbp_census *c) {
    gxb_complex *cx = c->cx;
    uint32_t i, j;
    for (i = 0; i < cx->leaf_count; i++) {
        const gxb_leaf *l = &cx->leaves[i];
        for (j = 0; j < l->facet_count && gxbp_stays(c, i); j++) gxbp_mark_facets(c, cx->pool[l->facets + j], 0);
    }
    for (i = 0; i < cx->face_count; i++) {
        const uint32_t state = gxbp_face_state(c, i), root = cx->face_facet[i];
        if (root == GXB_NONE || state == 0) continue;
        if (state & GXBP_LISTED)
            gxbp_mark_facets(c, root, 1);
        else
            gxbp_mark_one(c, root);
    }
    for (i = 0; i < cx->mesh_edge_count; i++) {
        const uint32_t root = cx->mesh_edge[i];
        if (root == GXB_NONE || c->mesh_edges[i] == 0) continue;
        if (c->mesh_edges[i] & GXBP_LISTED)
            gxbp_mark_edges(c, root);
        else
            c->edges[root] = 0;
    }
}

static int gxbp_is_alive(const gxbp_census *c, uint32_t facet) { return c->facets[facet] == GXBP_ALIVE; }

static void gxbp_write_edges(gxbp_census *c, uint32_t signed_edge) {
    const uint32_t child = c->cx->edges[signed_edge >> 1].child, back = signed_edge & 1;
    if (child >= GXB_UNLISTED) {
        c->loops[c->loop_end++] = signed_edge;
        return;
    }
    gxbp_write_edges(c, (child + back) << 1 | back);
    gxbp_write_edges(c, (child + 1 - back) << 1 | back);
}

/* Writes the resolved loops of all facets that stay. */
static gx_result gxbp_write_loops(gxbp_census *c) {
    gxb_complex *cx = c->cx;
    uint32_t i, j;
    if (c->loop_room > INT32_MAX / 3) return GX_ERROR_LIMIT;
    c->loop_room = 3 * c->loop_room + 1;
    c->loops = (uint32_t *)gxbp_allocate(&cx->store.allocator, c->loop_room * sizeof *c->loops);
    if (c->loops == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        c->loop[i] = c->loop_end;
        for (j = 0; j < f->loop_count && gxbp_is_alive(c, i); j++) gxbp_write_edges(c, cx->pool[f->loop + j]);
        c->loop_count[i] = c->loop_end - c->loop[i];
    }
    return GX_OK;
}

/* The node above a leaf whose plane carries a facet that bounds the leaf; side: of the facet, on which the leaf lies.
   GXB_NONE: there is none. */
static uint32_t gxbp_bounding_node(const gxbp_census *c, uint32_t leaf, uint32_t plane, uint32_t side) {
    const gxb_node *nodes = c->cx->nodes;
    uint32_t below = 2 * leaf, up = c->leaf_up[leaf];
    for (; up != GXB_NONE && (nodes[up].plane != plane || nodes[up].child[side] != below); up = nodes[up].parent)
        below = 2 * up + 1;
    return up;
}

/* Does a facet inside an element separate what lies on its side from what lies behind? */
static int gxbp_separates(const gxbp_census *c, const gxb_facet *f, uint32_t side, const uint32_t *kinds) {
    if (f->wall || !gxbp_side_stays(c, f, 1 - side)) return 1;
    return kinds != NULL && kinds[f->leaf[0]] != kinds[f->leaf[1]];
}

/* The nodes whose planes bound what stays, and separate it from what lies behind */
static void gxbp_mark_bounds(gxbp_census *c, const uint32_t *kinds) {
    gxb_complex *cx = c->cx;
    uint32_t i, k;
    if (cx->tree_count > 0) memset(c->bounds, 0, cx->tree_count * sizeof *c->bounds);
    for (i = 0; i < cx->tree_count; i++)
        for (k = 0; k < 2; k++)
            if (!(cx->nodes[i].child[k] & 1)) c->leaf_up[cx->nodes[i].child[k] >> 1] = i;
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        if (!gxbp_is_alive(c, i) || f->face != GXB_NONE) continue;
        for (k = 0; k < 2; k++) {
            const uint32_t up = gxbp_side_stays(c, f, k) ? gxbp_bounding_node(c, f->leaf[k], f->plane, k) : GXB_NONE;
            if (up == GXB_NONE) continue;
            c->bounds[up] |= gxbp_separates(c, f, k, kinds) ? GXBP_BOUND | GXBP_WALLED : GXBP_BOUND;
        }
    }
}

static void gxbp_mark_line(gxbp_census *c, const uint32_t line[2], uint32_t explicit_line) {
    uint32_t *of = explicit_line ? c->points : c->planes;
    of[line[0]] = of[line[1]] = 0;
}

/* The points and planes of all that stays, and what these are defined by */
static void gxbp_mark_definitions(gxbp_census *c) {
    gxb_complex *cx = c->cx;
    uint32_t i;
    memset(c->points, 0, cx->node_count * sizeof *c->points);
    for (i = 0; i < cx->edge_count; i++) {
        if (c->edges[i] == GXB_NONE) continue;
        c->points[c->ends[2 * (size_t)i]] = c->points[c->ends[2 * (size_t)i + 1]] = 0;
        gxbp_mark_line(c, cx->edges[i].line, cx->edges[i].explicit_line);
    }
    for (i = 0; i < cx->facet_count; i++)
        if (c->facets[i] != GXB_NONE) c->planes[cx->facets[i].plane] = 0;
    for (i = 0; i < c->node_count; i++) c->planes[c->nodes[3 * (size_t)i]] = 0;
    for (i = cx->node_count; i < cx->store.point_count; i++) {
        const gxb_cpoint *p = &cx->store.points[i];
        if (c->points[i] == GXB_NONE || p->kind == GXB_EXPLICIT) continue;
        gxbp_mark_line(c, p->def, p->kind == GXB_LINE_PLANE);
        c->planes[p->def[2]] = 0;
    }
    for (i = 0; i < cx->store.plane_count; i++) {
        const gxb_cplane *f = &cx->store.planes[i];
        if (c->planes[i] == GXB_NONE) continue;
        c->points[f->def[0]] = c->points[f->def[1]] = 0;
        if (!f->along_axis) c->points[f->def[2]] = 0;
    }
}

static size_t gxbp_exact_size(const gxb_num *exact) {
    size_t size = 4 * sizeof *exact;
    int k;
    for (k = 0; k < 4 && exact != NULL; k++) size += exact[k].n * sizeof *exact->d;
    return exact == NULL ? 0 : (size + 15) & ~(size_t)15;
}

static void gxbp_count_exact(gxbp_census *c) {
    const gxb_store *store = &c->cx->store;
    uint32_t i;
    for (i = 0; i < store->point_count; i++)
        if (c->points[i] != GXB_NONE) c->exact += gxbp_exact_size(store->points[i].exact);
    for (i = 0; i < store->plane_count; i++)
        if (c->planes[i] != GXB_NONE) c->exact += gxbp_exact_size(store->planes[i].exact);
}

/* >>surround: boxes around leaves ---------------------------------------------------------------------------------- */
/* In: a leaf and a plane. Out: the side on which the leaf lies, where its box tells that. Each box is made once. The
   planes of a crowd of leaves are asked about thousands of others, and pass far away from nearly all. */

/* A box around a leaf: its middle and half its size. half[0] < 0: not made yet */
typedef struct gxbp_surround {
    double middle[3], half[3];
} gxbp_surround;

/* Widens the box to the balls of a facet's points, low in middle and high in half. Returns the largest of their errors
   and the one before. */
static GXBP_COLD double gxbp_widen_surround(const gxb_complex *cx, uint32_t facet, double error, gxbp_surround *box) {
    const gxb_facet *f = &cx->facets[facet];
    uint32_t i;
    int k;
    if (f->child != GXB_NONE)
        return gxbp_widen_surround(cx, f->child + 1, gxbp_widen_surround(cx, f->child, error, box), box);
    for (i = 0; i < f->loop_count; i++) {
        const gxb_ball *ball = &cx->store.points[gxbp_edge_start(cx, cx->pool[f->loop + i])].ball;
        if (ball->error > error) error = ball->error;
        for (k = 0; k < 3; k++) {
            if (ball->x[k] < box->middle[k]) box->middle[k] = ball->x[k];
            if (ball->x[k] > box->half[k]) box->half[k] = ball->x[k];
        }
    }
    return error;
}

static const gxbp_surround *gxbp_leaf_surround(gxbp_census *c, uint32_t leaf) {
    const gxb_complex *cx = c->cx;
    const gxb_leaf *l = &cx->leaves[leaf];
    gxbp_surround *box = &c->surrounds[leaf];
    double error = 0;
    uint32_t i;
    int k;
    if (!(box->half[0] < 0)) return box;
    for (k = 0; k < 3; k++) {
        box->middle[k] = GXBP_NO_BALL;
        box->half[k] = -GXBP_NO_BALL;
    }
    for (i = 0; i < l->facet_count; i++) error = gxbp_widen_surround(cx, cx->pool[l->facets + i], error, box);
    for (k = 0; k < 3; k++) {
        const double low = box->middle[k], high = box->half[k];
        box->middle[k] = gxbp_fence(0.5 * low + 0.5 * high);
        box->half[k] = 0.5 * (high - low) + 8 * GXBP_U * (gxbp_abs(low) + gxbp_abs(high)) + error + GXBP_TINY;
    }
    return box;
}

/* The side of a plane on which the leaf's box lies for certain: 1 in front, 2 behind; 3: none is certain */
static int gxbp_surround_sides(const gxbp_surround *box, const gxb_plane_filter *f) {
    gxb_ball middle;
    double bound, value, reach = 0;
    int k, sign;
    memcpy(middle.x, box->middle, sizeof middle.x);
    middle.error = 0;
    value = gxbp_filter_side(&middle, f, &bound);
    for (k = 0; k < 3; k++) reach += (gxbp_abs(f->n[k]) + f->error) * box->half[k];
    sign = gxbp_filter_sign(value, bound + reach * (1 + 16 * GXBP_U));
    return sign > 0 ? 1 : sign < 0 ? 2 : 3;
}

/* >>unite: leaves, facets and edges that are one without what has gone --------------------------------------------- */
/* Planes of cuts divide the material beyond what they cut, and outlast it. In: a census. Out: the trees without the
   planes that bound nothing any more, and which leaves, facets and edges become one. Leaves of one cell become one if
   together they are a part of their element's new tree; facets, if together they are a convex polygon; edges, if
   nothing else ends between them. The complex changes in nothing but signs and exact numbers that it keeps.
 *
 * A node goes if its plane bounds nothing and its two trees are one. They are merged plane by plane: the plane at the
 * root of one divides the other, without dividing leaves. Where leaf meets leaf, they lie on either side of the plane
 * that goes, which is open there, so they are parts of one cell and become one leaf. */

/* What a node of a tree becomes: nothing, removed, a set of leaves, a node of the plan; the rest is an index */
enum { GXBP_NOTHING, GXBP_REMOVED, GXBP_SET, GXBP_PLAN, GXBP_KINDS };
#define GXBP_FAILS GXB_NONE

static uint32_t gxbp_kind(uint32_t tree) { return tree % GXBP_KINDS; }

/* The old node (0), the front (1) or the back (2) of a node of the plan */
static uint32_t gxbp_plan_part(const gxbp_census *c, uint32_t tree, uint32_t k) {
    return c->plan[3 * (size_t)(tree / GXBP_KINDS) + k];
}

/* One of the two sets of a pair */
static uint32_t gxbp_set_part(const gxbp_census *c, uint32_t set, uint32_t k) {
    return c->pairs[2 * (size_t)(set - c->cx->leaf_count) + k];
}

/* A node in the place of an old one, or less if one of its trees is nothing, or removed and bounded by nothing */
static uint32_t gxbp_plan_tree(gxbp_census *c, uint32_t node, uint32_t front, uint32_t behind) {
    uint32_t *own = c->plan + 3 * (size_t)c->plan_count;
    if (front == GXBP_FAILS || behind == GXBP_FAILS) return GXBP_FAILS;
    if (front == GXBP_NOTHING || (front == GXBP_REMOVED && behind == GXBP_REMOVED)) return behind;
    if (behind == GXBP_NOTHING) return front;
    if (front == GXBP_REMOVED && !(c->bounds[node] & GXBP_BOUND)) return behind;
    if (behind == GXBP_REMOVED && !(c->bounds[node] & GXBP_BOUND)) return front;
    if (c->plan_count == c->plan_room) return GXBP_FAILS;
    own[0] = node;
    own[1] = front;
    own[2] = behind;
    return GXBP_KINDS * c->plan_count++ + GXBP_PLAN;
}

/* A set is a leaf or, from leaf_count on, a pair of sets. */
static uint32_t gxbp_pair_sets(gxbp_census *c, uint32_t a, uint32_t b) {
    uint32_t *own = c->pairs + 2 * (size_t)c->pair_count;
    if (c->pair_count == c->pair_room) return GXBP_FAILS;
    own[0] = a / GXBP_KINDS;
    own[1] = b / GXBP_KINDS;
    return GXBP_KINDS * (c->cx->leaf_count + c->pair_count++) + GXBP_SET;
}

/* On which sides of the splitter the leaves of a set lie; 3 if that takes too many steps */
static GXBP_COLD int gxbp_set_sides(gxbp_census *c, uint32_t set, const gxbp_splitter *splitter) {
    int sides;
    if (c->steps == 0) return 3;
    c->steps--;
    if (set < c->cx->leaf_count) {
        sides = gxbp_surround_sides(gxbp_leaf_surround(c, set), &c->cx->store.planes[splitter->plane].filter);
        return sides != 3 ? sides : gxbp_leaf_sides(c->cx, set, splitter);
    }
    sides = gxbp_set_sides(c, gxbp_set_part(c, set, 0), splitter);
    return sides == 3 ? 3 : sides | gxbp_set_sides(c, gxbp_set_part(c, set, 1), splitter);
}

/* Has a leaf of the set a facet inside the element that lies in the plane? 1 if that takes too many steps */
static GXBP_COLD int gxbp_set_touches(gxbp_census *c, uint32_t set, uint32_t plane) {
    const gxb_complex *cx = c->cx;
    uint32_t i;
    if (c->steps == 0) return 1;
    c->steps--;
    if (set >= cx->leaf_count)
        return gxbp_set_touches(c, gxbp_set_part(c, set, 0), plane) ||
               gxbp_set_touches(c, gxbp_set_part(c, set, 1), plane);
    for (i = 0; i < cx->leaves[set].facet_count; i++) {
        const gxb_facet *f = &cx->facets[cx->pool[cx->leaves[set].facets + i]];
        if (f->plane == plane && f->face == GXB_NONE) return 1;
    }
    return 0;
}

/* The parts of a tree in front of a plane and behind it. 0: the plane divides a leaf of it, or is another one again. */
static GXBP_COLD int gxbp_part_tree(gxbp_census *c, uint32_t tree, uint32_t plane, uint32_t part[2]) {
    uint32_t front[2], behind[2], node, k;
    gxbp_splitter splitter;
    int sides;
    part[0] = part[1] = tree;
    if (gxbp_kind(tree) == GXBP_NOTHING || gxbp_kind(tree) == GXBP_REMOVED) return 1;
    if (c->steps == 0) return 0;
    c->steps--;
    if (gxbp_kind(tree) == GXBP_SET) {
        memset(&splitter, 0, sizeof splitter);
        splitter.plane = plane;
        splitter.slot = 1;
        gxbp_forget_signs(&c->cx->store, 1);
        sides = gxbp_set_sides(c, tree / GXBP_KINDS, &splitter);
        part[sides == 1] = GXBP_NOTHING;
        return sides != 3;
    }
    node = gxbp_plan_part(c, tree, 0);
    if (c->cx->nodes[node].plane == plane) {
        for (k = 0; k < 2; k++) part[k] = gxbp_plan_part(c, tree, 1 + k);
        return 1;
    }
    if (!gxbp_part_tree(c, gxbp_plan_part(c, tree, 1), plane, front) ||
        !gxbp_part_tree(c, gxbp_plan_part(c, tree, 2), plane, behind))
        return 0;
    for (k = 0; k < 2; k++) {
        uint32_t rest = GXBP_NOTHING;
        if (front[k] == GXBP_NOTHING)
            rest = behind[k];
        else if (behind[k] == GXBP_NOTHING)
            rest = front[k];
        part[k] = gxbp_plan_tree(c, node, front[k], behind[k]);
        if (part[k] == GXBP_FAILS ||
            (gxbp_kind(rest) == GXBP_SET && gxbp_set_touches(c, rest / GXBP_KINDS, c->cx->nodes[node].plane)))
            return 0;
    }
    return 1;
}

static uint32_t gxbp_merge_trees(gxbp_census *c, uint32_t front, uint32_t behind, uint32_t plane);

/* Merges trees along the plane at the root of one of them: of the front one (first 0) or of the other. */
static GXBP_COLD uint32_t gxbp_merge_along(gxbp_census *c, uint32_t first, uint32_t front, uint32_t behind,
                                           uint32_t plane) {
    const uint32_t own = first ? behind : front, node = gxbp_plan_part(c, own, 0);
    uint32_t part[2], merged[2], k;
    if (!gxbp_part_tree(c, first ? front : behind, c->cx->nodes[node].plane, part)) return GXBP_FAILS;
    for (k = 0; k < 2; k++) {
        const uint32_t tree = gxbp_plan_part(c, own, 1 + k);
        merged[k] = first ? gxbp_merge_trees(c, part[k], tree, plane) : gxbp_merge_trees(c, tree, part[k], plane);
        if (merged[k] == GXBP_FAILS) return GXBP_FAILS;
    }
    return gxbp_plan_tree(c, node, merged[0], merged[1]);
}

/* One tree of those in front of a plane that goes and behind it, or GXBP_FAILS. Something removed lies beside nothing
   else if that does not reach the plane: it would have a facet there. */
static GXBP_COLD uint32_t gxbp_merge_trees(gxbp_census *c, uint32_t front, uint32_t behind, uint32_t plane) {
    const uint32_t kinds[2] = {gxbp_kind(front), gxbp_kind(behind)};
    uint32_t k, merged = GXBP_FAILS;
    if (c->steps == 0) return GXBP_FAILS;
    c->steps--;
    if (kinds[0] == GXBP_NOTHING || (kinds[0] == GXBP_REMOVED && kinds[1] == GXBP_REMOVED)) return behind;
    if (kinds[1] == GXBP_NOTHING) return front;
    if (kinds[0] == GXBP_SET && kinds[1] == GXBP_SET) return gxbp_pair_sets(c, front, behind);
    if (kinds[0] == GXBP_REMOVED && kinds[1] == GXBP_SET)
        return gxbp_set_touches(c, behind / GXBP_KINDS, plane) ? GXBP_FAILS : behind;
    if (kinds[0] == GXBP_SET && kinds[1] == GXBP_REMOVED)
        return gxbp_set_touches(c, front / GXBP_KINDS, plane) ? GXBP_FAILS : front;
    for (k = 0; k < 2 && merged == GXBP_FAILS; k++)
        if (kinds[k] == GXBP_PLAN) merged = gxbp_merge_along(c, k, front, behind, plane);
    return merged;
}

/* What a part of an element's tree becomes. merge 0: leaves stay as they are. */
static GXBP_COLD uint32_t gxbp_simplify(gxbp_census *c, uint32_t reference, int merge) {
    const uint32_t index = reference >> 1;
    uint32_t part[2], k, tree, plans, pairs;
    if (!(reference & 1)) return gxbp_stays(c, index) ? GXBP_KINDS * index + GXBP_SET : (uint32_t)GXBP_REMOVED;
    for (k = 0; k < 2; k++) part[k] = gxbp_simplify(c, c->cx->nodes[index].child[k], merge);
    if (part[0] == GXBP_FAILS || part[1] == GXBP_FAILS) return GXBP_FAILS;
    plans = c->plan_count;
    pairs = c->pair_count;
    if (merge && !(c->bounds[index] & GXBP_WALLED)) {
        c->steps = 16 + 8 * c->cx->nodes[index].leaves;
        tree = gxbp_merge_trees(c, part[0], part[1], c->cx->nodes[index].plane);
        if (tree != GXBP_FAILS) return tree;
    }
    c->plan_count = plans;
    c->pair_count = pairs;
    return gxbp_plan_tree(c, index, part[0], part[1]);
}

static GXBP_COLD uint32_t gxbp_count_plan(const gxbp_census *c, uint32_t tree) {
    if (gxbp_kind(tree) != GXBP_PLAN) return 0;
    return 1 + gxbp_count_plan(c, gxbp_plan_part(c, tree, 1)) + gxbp_count_plan(c, gxbp_plan_part(c, tree, 2));
}

static GXBP_COLD uint32_t gxbp_first_leaf(const gxbp_census *c, uint32_t set) {
    uint32_t a, b;
    if (set < c->cx->leaf_count) return set;
    a = gxbp_first_leaf(c, gxbp_set_part(c, set, 0));
    b = gxbp_first_leaf(c, gxbp_set_part(c, set, 1));
    return a < b ? a : b;
}

static GXBP_COLD void gxbp_give_set(gxbp_census *c, uint32_t set, uint32_t leaf) {
    if (set < c->cx->leaf_count) {
        c->leaf_of[set] = leaf;
        return;
    }
    gxbp_give_set(c, gxbp_set_part(c, set, 0), leaf);
    gxbp_give_set(c, gxbp_set_part(c, set, 1), leaf);
}

/* Writes a planned tree to the new trees. Returns its reference. */
static GXBP_COLD uint32_t gxbp_write_tree(gxbp_census *c, uint32_t tree, uint32_t element) {
    const uint32_t index = tree / GXBP_KINDS, n = c->node_count;
    uint32_t *node = c->nodes + 3 * (size_t)n;
    if (gxbp_kind(tree) == GXBP_SET) {
        const uint32_t leaf = gxbp_first_leaf(c, index);
        if (index >= c->cx->leaf_count) c->elements[element] |= GXBP_CHANGED;
        gxbp_give_set(c, index, leaf);
        return 2 * leaf;
    }
    if (gxbp_kind(tree) != GXBP_PLAN) return 2 * c->hollow[element];
    c->node_count++;
    node[0] = c->cx->nodes[gxbp_plan_part(c, tree, 0)].plane;
    node[1] = gxbp_write_tree(c, gxbp_plan_part(c, tree, 1), element);
    node[2] = gxbp_write_tree(c, gxbp_plan_part(c, tree, 2), element);
    return 2 * n + 1;
}

/* The way down a planned tree: a node, and the side on which it goes on */
typedef struct gxbp_descent {
    const struct gxbp_descent *up;
    uint32_t plane, side;
} gxbp_descent;

/* Is a part of the facet between leaves that do not become one? *side: of the facet, on which the leaf lies */
static GXBP_COLD int gxbp_is_border(const gxbp_census *c, uint32_t facet, uint32_t leaf, uint32_t *side) {
    const gxb_facet *f = &c->cx->facets[facet];
    if (f->child < GXB_UNLISTED)
        return gxbp_is_border(c, f->child, leaf, side) || gxbp_is_border(c, f->child + 1, leaf, side);
    *side = f->leaf[0] == leaf ? 0 : 1;
    return f->face == GXB_NONE && c->leaf_of[f->leaf[0]] != c->leaf_of[f->leaf[1]];
}

/* Does each facet on the border of the set lie in the plane of a node above, on its side? */
static GXBP_COLD int gxbp_set_is_bounded(const gxbp_census *c, uint32_t set, const gxbp_descent *above) {
    const gxb_complex *cx = c->cx;
    uint32_t i, side;
    if (set >= cx->leaf_count)
        return gxbp_set_is_bounded(c, gxbp_set_part(c, set, 0), above) &&
               gxbp_set_is_bounded(c, gxbp_set_part(c, set, 1), above);
    for (i = 0; i < cx->leaves[set].facet_count; i++) {
        const uint32_t facet = cx->pool[cx->leaves[set].facets + i];
        const gxbp_descent *d = above;
        if (!gxbp_is_border(c, facet, set, &side)) continue;
        while (d != NULL && (d->plane != cx->facets[facet].plane || d->side != side)) d = d->up;
        if (d == NULL) return 0;
    }
    return 1;
}

/* Planes may be equal and have different numbers. Then a facet may be left without a node of its plane above it. */
static GXBP_COLD int gxbp_plan_is_sound(const gxbp_census *c, uint32_t tree, const gxbp_descent *up) {
    gxbp_descent below;
    if (gxbp_kind(tree) == GXBP_SET) return gxbp_set_is_bounded(c, tree / GXBP_KINDS, up);
    if (gxbp_kind(tree) != GXBP_PLAN) return 1;
    below.up = up;
    below.plane = c->cx->nodes[gxbp_plan_part(c, tree, 0)].plane;
    for (below.side = 0; below.side < 2; below.side++)
        if (!gxbp_plan_is_sound(c, gxbp_plan_part(c, tree, 1 + below.side), &below)) return 0;
    return 1;
}

/* The new tree of an element. It has no more nodes than the old one. merge 0: leaves stay as they are. Returns 0 if
   that does not do. */
static int gxbp_renew_tree(gxbp_census *c, uint32_t element, int merge) {
    const gxb_complex *cx = c->cx;
    const uint32_t root = cx->root[element], leaves = root & 1 ? cx->nodes[root >> 1].leaves : 1, nodes = c->node_count,
                   state = c->elements[element];
    uint32_t tree;
    c->plan_count = c->pair_count = 0;
    tree = gxbp_simplify(c, root, merge);
    if (tree == GXBP_FAILS || gxbp_count_plan(c, tree) >= leaves) return 0;
    c->roots[element] = gxbp_write_tree(c, tree, element);
    if (!merge || gxbp_plan_is_sound(c, tree, NULL)) return 1;
    c->node_count = nodes;
    c->elements[element] = state;
    return 0;
}

static gx_result gxbp_renew_trees(gxbp_census *c) {
    const gx_allocator *a = &c->cx->store.allocator;
    const size_t size = c->cx->leaf_count * sizeof *c->surrounds;
    uint32_t i;
    c->surrounds = (gxbp_surround *)gxbp_allocate(a, size);
    if (c->surrounds == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < c->cx->leaf_count; i++) c->surrounds[i].half[0] = -1;
    for (i = 0; i < c->cx->element_count; i++)
        if ((c->elements[i] & GXBP_PINNED) || !gxbp_renew_tree(c, i, 1)) gxbp_renew_tree(c, i, 0);
    gxbp_release(a, c->surrounds, size);
    return GX_OK;
}

/* --- facets --- */

/* May the facet become one with others? Not where parts of a face stay listed, or an element keeps all it has. */
static int gxbp_may_unite(const gxbp_census *c, uint32_t facet) {
    const gxb_facet *f = &c->cx->facets[facet];
    const uint32_t leaf = f->leaf[0] != GXB_NONE ? f->leaf[0] : f->leaf[1];
    if (f->face != GXB_NONE) return !(gxbp_face_state(c, f->face) & GXBP_LISTED);
    return !(c->elements[c->cx->leaves[leaf].element] & GXBP_PINNED);
}

/* Notes that what is on both sides of a facet changes. */
static void gxbp_note_changed(gxbp_census *c, uint32_t facet) {
    const gxb_facet *f = &c->cx->facets[facet];
    uint32_t k;
    for (k = 0; k < 2; k++)
        if (f->leaf[k] != GXB_NONE) c->elements[c->cx->leaves[f->leaf[k]].element] |= GXBP_CHANGED;
}

/* A number for the labels of a facet, equal for equal ones; its last bit tells walls */
static uint32_t gxbp_facet_status(const gxbp_census *c, const gxb_facet *f) {
    uint32_t l = f->labels, sum = 0;
    for (; l != GXB_NONE; l = c->cx->labels[l].next)
        sum = 31 * sum + 2 * c->cx->labels[l].triangle + (c->cx->labels[l].orientation < 0);
    return sum << 1 | f->wall;
}

static int gxbp_same_labels(const gxb_complex *cx, uint32_t a, uint32_t b) {
    while (a != b && a != GXB_NONE && b != GXB_NONE && cx->labels[a].triangle == cx->labels[b].triangle &&
           cx->labels[a].orientation == cx->labels[b].orientation) {
        a = cx->labels[a].next;
        b = cx->labels[b].next;
    }
    return a == b;
}

static int gxbp_compare_pieces(const void *a, const void *b) {
    const gxbp_piece *p = (const gxbp_piece *)a, *q = (const gxbp_piece *)b;
    if (p->plane != q->plane) return p->plane < q->plane ? -1 : 1;
    if (p->other != q->other) return p->other < q->other ? -1 : 1;
    if (p->status != q->status) return p->status < q->status ? -1 : 1;
    return p->facet < q->facet ? -1 : 1;
}

/* Finds the border of some facets: the edges that only one of them has, each noted at the point that it leaves.
   Returns their number; *start: a point on it. */
static uint32_t gxbp_find_border(gxbp_census *c, const gxbp_piece *piece, uint32_t count, uint32_t *start) {
    uint32_t i, j, n = 0;
    c->round++;
    for (i = 0; i < count; i++)
        for (j = 0; j < c->loop_count[piece[i].facet]; j++) c->ends[c->loops[c->loop[piece[i].facet] + j]] = c->round;
    for (i = 0; i < count; i++)
        for (j = 0; j < c->loop_count[piece[i].facet]; j++) {
            const uint32_t e = c->loops[c->loop[piece[i].facet] + j];
            if (c->ends[e ^ 1] == c->round) continue;
            *start = gxbp_edge_start(c->cx, e);
            c->at[2 * (size_t)*start] = e;
            n++;
        }
    return n;
}

/* Does the loop turn to the left only? Then it is a convex polygon. */
static int gxbp_is_convex(gxbp_census *c, const uint32_t *loop, uint32_t count, uint32_t plane) {
    gxb_complex *cx = c->cx;
    uint32_t i;
    for (i = 0; i < count; i++) {
        const uint32_t e = loop[i], next = loop[i + 1 < count ? i + 1 : 0];
        const gxb_edge *a = &cx->edges[e >> 1], *b = &cx->edges[next >> 1];
        if (a->explicit_line == b->explicit_line && memcmp(a->line, b->line, sizeof a->line) == 0) continue;
        if (gxbp_store_turn(&cx->store, gxbp_edge_start(cx, e), gxbp_edge_start(cx, next), b->v[1 - (next & 1)],
                            plane) < 0)
            return 0;
    }
    return 1;
}

/* Makes the first of some facets, which have the same leaves, all of them if together they are convex. */
static int gxbp_unite_facets(gxbp_census *c, const gxbp_piece *piece, uint32_t count) {
    const uint32_t first = c->loop_end;
    uint32_t point = 0, n = gxbp_find_border(c, piece, count, &point), i;
    const uint32_t start = point;
    if (n < 3 || n > c->loop_room - first) return 0;
    for (i = 0; i < n && (i == 0 || point != start); i++) {
        const uint32_t e = c->loops[first + i] = c->at[2 * (size_t)point];
        point = c->cx->edges[e >> 1].v[1 - (e & 1)];
    }
    if (i < n || point != start || !gxbp_is_convex(c, c->loops + first, n, piece->plane)) return 0;
    c->loop_end += n;
    c->loop[piece->facet] = first;
    c->loop_count[piece->facet] = n;
    for (i = 1; i < count; i++) {
        c->facets[piece[i].facet] = GXB_NONE;
        c->loop_count[piece[i].facet] = 0;
        c->facet_of[piece[i].facet] = piece->facet;
    }
    gxbp_note_changed(c, piece->facet);
    return 1;
}

/* Unites a facet with another one of the present group along one of its edges. 0: with none */
static int gxbp_unite_along(gxbp_census *c, const gxbp_piece *piece) {
    gxbp_piece pair[2];
    uint32_t j;
    pair[0] = pair[1] = *piece;
    for (j = 0; j < c->loop_count[piece->facet]; j++) {
        uint32_t other = c->owner[c->loops[c->loop[piece->facet] + j] ^ 1];
        if (other == GXB_NONE || c->group[other] != c->groups) continue;
        while (c->facet_of[other] != other) other = c->facet_of[other];
        pair[1].facet = other;
        if (other != piece->facet && gxbp_unite_facets(c, pair, 2)) return 1;
    }
    return 0;
}

/* Facets that have the same leaves, but together are not convex: unites them two by two, as far as that goes. */
static void gxbp_unite_group(gxbp_census *c, const gxbp_piece *piece, uint32_t count) {
    uint32_t i, j;
    c->groups++;
    for (i = 0; i < count; i++) {
        const uint32_t facet = piece[i].facet;
        c->group[facet] = c->groups;
        c->facet_of[facet] = facet;
        for (j = 0; j < c->loop_count[facet]; j++) c->owner[c->loops[c->loop[facet] + j]] = facet;
    }
    for (i = 0; i < count; i++)
        while (c->facets[piece[i].facet] != GXB_NONE && gxbp_unite_along(c, &piece[i])) {}
}

/* Unites facets among those of one leaf. */
static void gxbp_unite_of_leaf(gxbp_census *c, uint32_t count) {
    const gxb_facet *facets = c->cx->facets;
    uint32_t i, end;
    qsort(c->pieces, count, sizeof *c->pieces, gxbp_compare_pieces);
    for (i = 0; i < count; i = end) {
        const gxbp_piece *p = &c->pieces[i];
        for (end = i + 1; end < count && c->pieces[end].plane == p->plane && c->pieces[end].other == p->other &&
                          c->pieces[end].status == p->status &&
                          gxbp_same_labels(c->cx, facets[c->pieces[end].facet].labels, facets[p->facet].labels);
             end++) {}
        if (end > i + 1 && !gxbp_unite_facets(c, p, end - i) && end > i + 2) gxbp_unite_group(c, p, end - i);
    }
}

/* The leaf among whose facets one is united with others: the first one of its sides that stays */
static uint32_t gxbp_piece_leaf(const gxbp_census *c, const gxb_facet *f) {
    return c->leaf_of[f->leaf[gxbp_side_stays(c, f, 0) ? 0 : 1]];
}

/* Drops the facets inside of leaves that have become one, and sorts the others by leaf. */
static void gxbp_sort_pieces(gxbp_census *c) {
    const gxb_complex *cx = c->cx;
    uint32_t i, n = 0;
    memset(c->first_piece, 0, (cx->leaf_count + (size_t)1) * sizeof *c->first_piece);
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        if (!gxbp_is_alive(c, i)) continue;
        if (f->face == GXB_NONE && c->leaf_of[f->leaf[0]] == c->leaf_of[f->leaf[1]]) {
            c->facets[i] = GXB_NONE;
            c->loop_count[i] = 0;
        } else if (gxbp_may_unite(c, i))
            c->first_piece[gxbp_piece_leaf(c, f)]++;
    }
    for (i = 0; i < cx->leaf_count; i++) {
        if (c->first_piece[i] > c->piece_room) c->piece_room = c->first_piece[i];
        c->first_piece[i] = n += c->first_piece[i];
    }
    c->first_piece[cx->leaf_count] = n;
    for (i = cx->facet_count; i-- > 0;)
        if (gxbp_is_alive(c, i) && gxbp_may_unite(c, i))
            c->order[--c->first_piece[gxbp_piece_leaf(c, &cx->facets[i])]] = i;
}

/* Facets between the same two leaves become one. */
static gx_result gxbp_unite_polygons(gxbp_census *c) {
    const gxb_complex *cx = c->cx;
    uint32_t i, j;
    gxbp_sort_pieces(c);
    c->pieces = (gxbp_piece *)gxbp_allocate(&cx->store.allocator, (c->piece_room + (size_t)1) * sizeof *c->pieces);
    if (c->pieces == NULL) return GX_ERROR_MEMORY;
    memset(c->ends, 0, 2 * (size_t)cx->edge_count * sizeof *c->ends);
    for (i = 0; i < cx->leaf_count; i++) {
        const uint32_t first = c->first_piece[i], count = c->first_piece[i + 1] - first;
        for (j = 0; j < count; j++) {
            gxbp_piece *p = &c->pieces[j];
            const gxb_facet *f = &cx->facets[c->order[first + j]];
            const uint32_t other = f->leaf[gxbp_side_stays(c, f, 0) ? 1 : 0];
            p->facet = c->order[first + j];
            p->plane = f->plane;
            p->other = other == GXB_NONE ? GXB_NONE : c->leaf_of[other];
            p->status = gxbp_facet_status(c, f);
        }
        if (count > 1) gxbp_unite_of_leaf(c, count);
    }
    return GX_OK;
}

/* --- edges --- */

/* Notes the edges at each point: up to two, the second GXB_NONE - 1 if there are more. */
static void gxbp_find_ends(gxbp_census *c) {
    const gxb_complex *cx = c->cx;
    uint32_t i, j, k;
    memset(c->at, 0xff, 2 * (size_t)cx->store.point_count * sizeof *c->at);
    for (i = 0; i < cx->facet_count; i++)
        for (j = 0; j < c->loop_count[i]; j++) c->edges[c->loops[c->loop[i] + j] >> 1] = 0;
    for (i = 0; i < cx->edge_count; i++)
        for (k = 0; k < 2; k++) {
            uint32_t *at = c->at + 2 * (size_t)cx->edges[i].v[k];
            c->ends[2 * (size_t)i + k] = cx->edges[i].v[k];
            if (c->edges[i] == GXB_NONE || cx->edges[i].child != GXB_NONE) continue;
            if (at[0] == GXB_NONE)
                at[0] = i;
            else
                at[1] = at[1] == GXB_NONE ? i : GXB_NONE - 1;
        }
}

/* The edge that goes on at a point behind another one of the same line, if nothing else ends there. GXB_NONE: there is
   none. Points that stay anyway end edges. */
static uint32_t gxbp_edge_beyond(const gxbp_census *c, uint32_t edge, uint32_t point) {
    const gxb_edge *e = &c->cx->edges[edge], *f;
    const uint32_t *at = c->at + 2 * (size_t)point, other = at[0] == edge ? at[1] : at[0];
    if (at[1] >= GXB_NONE - 1 || point < c->cx->node_count || c->points[point] != GXB_NONE) return GXB_NONE;
    f = &c->cx->edges[other];
    return e->explicit_line == f->explicit_line && memcmp(e->line, f->line, sizeof e->line) == 0 && e->wall == f->wall
             ? other
             : GXB_NONE;
}

/* Gives an edge all that goes on behind its end. Edges that it takes in go. */
static void gxbp_extend_edge(gxbp_census *c, uint32_t edge, uint32_t end) {
    uint32_t at = edge, point = c->cx->edges[edge].v[end], next;
    while ((next = gxbp_edge_beyond(c, at, point)) != GXB_NONE && next != edge) {
        point = c->cx->edges[next].v[c->cx->edges[next].v[0] == point];
        c->edges[next] = GXB_NONE;
        at = next;
    }
    c->ends[2 * (size_t)edge + end] = point;
}

/* Edges on one line become one where nothing else ends between them: a loop with one of them has all of them. */
static void gxbp_unite_edges(gxbp_census *c) {
    const gxb_complex *cx = c->cx;
    uint32_t i, j, n;
    gxbp_find_ends(c);
    for (i = 0; i < cx->edge_count; i++) {
        if (c->edges[i] == GXB_NONE || cx->edges[i].child != GXB_NONE) continue;
        gxbp_extend_edge(c, i, 0);
        gxbp_extend_edge(c, i, 1);
    }
    for (i = 0; i < cx->facet_count; i++) {
        uint32_t *loop = c->loops + c->loop[i];
        for (j = n = 0; j < c->loop_count[i]; j++)
            if (c->edges[loop[j] >> 1] != GXB_NONE) loop[n++] = loop[j];
        if (n < c->loop_count[i]) gxbp_note_changed(c, i);
        c->loop_count[i] = n;
    }
}

/* --- faces and mesh edges that are whole again --- */

/* The mesh edge of an element between two nodes, or GXB_NONE */
static uint32_t gxbp_mesh_edge_between(const gxb_complex *cx, uint32_t element, const uint32_t ends[2]) {
    const uint32_t *node = cx->elements + 4 * (size_t)element;
    uint32_t k;
    for (k = 0; k < 6; k++) {
        const uint32_t a = node[gxbp_edge_nodes[k][0]], b = node[gxbp_edge_nodes[k][1]];
        if ((a == ends[0] && b == ends[1]) || (a == ends[1] && b == ends[0])) return cx->element_edges[6 * element + k];
    }
    return GXB_NONE;
}

/* Puts an item in the place of the first one of its face or mesh edge, of which it has become all. */
static void gxbp_restore_item(uint32_t *first, uint32_t item, uint32_t state, uint32_t *number) {
    if (*first == item || (state & GXBP_LISTED)) return;
    number[*first] = GXB_NONE;
    *first = item;
}

/* A face (mesh edge) of which one facet (edge) is all has that as its first one, as if it had not been divided. */
static void gxbp_restore_whole(gxbp_census *c) {
    const gxb_complex *cx = c->cx;
    uint32_t i, j;
    if (cx->face_count > 0) memcpy(c->face_first, cx->face_facet, cx->face_count * sizeof *c->face_first);
    if (cx->mesh_edge_count > 0) memcpy(c->edge_first, cx->mesh_edge, cx->mesh_edge_count * sizeof *c->edge_first);
    for (i = 0; i < cx->facet_count; i++) {
        const uint32_t face = cx->facets[i].face, *sides;
        uint32_t whole = 0;
        if (!gxbp_is_alive(c, i) || face == GXB_NONE) continue;
        sides = cx->face_elements + 2 * (size_t)face;
        for (j = 0; j < c->loop_count[i]; j++) {
            const uint32_t edge = c->loops[c->loop[i] + j] >> 1, *ends = c->ends + 2 * (size_t)edge;
            const gxb_edge *e = &cx->edges[edge];
            uint32_t mesh_edge = GXB_NONE;
            whole += e->explicit_line && e->line[0] < cx->node_count && e->line[1] < cx->node_count;
            if (ends[0] < cx->node_count && ends[1] < cx->node_count && e->explicit_line)
                mesh_edge = gxbp_mesh_edge_between(cx, sides[0] != GXB_NONE ? sides[0] : sides[1], ends);
            if (mesh_edge != GXB_NONE)
                gxbp_restore_item(&c->edge_first[mesh_edge], edge, c->mesh_edges[mesh_edge], c->edges);
        }
        if (whole == c->loop_count[i]) gxbp_restore_item(&c->face_first[face], i, gxbp_face_state(c, face), c->facets);
    }
}

/* >>compact: giving back what nothing needs any more --------------------------------------------------------------- */
/* In: a complex. Out: the same complex without the leaves that were removed and what only they, or edges and facets
   that are divided, had need of. Items keep their order. First a census is taken, and all memory; then nothing can
   fail. */

/* Numbers what stays. */
static uint32_t gxbp_number(uint32_t *number, uint32_t count) {
    uint32_t i, n = 0;
    for (i = 0; i < count; i++)
        if (number[i] != GXB_NONE) number[i] = n++;
    return n;
}

/* Leaves that go have the number of the one that they are part of or that stands for them, which comes before them. */
static uint32_t gxbp_number_leaves(gxbp_census *c) {
    uint32_t i, n = 0;
    for (i = 0; i < c->cx->leaf_count; i++) c->leaves[i] = c->leaf_of[i] == i ? n++ : c->leaves[c->leaf_of[i]];
    return n;
}

/* How many facets each leaf will have, and how long all lists will be */
static void gxbp_count_lists(gxbp_census *c) {
    const gxb_complex *cx = c->cx;
    uint32_t i, k;
    memset(c->list_count, 0, cx->leaf_count * sizeof *c->list_count);
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        if (!gxbp_is_alive(c, i)) continue;
        c->pool += c->loop_count[i];
        for (k = 0; k < 2; k++)
            if (gxbp_side_stays(c, f, k) && cx->leaves[f->leaf[k]].facet_count > 0) {
                c->list_count[c->leaf_of[f->leaf[k]]]++;
                c->pool++;
            }
    }
}

/* Memory for lists and exact numbers of what stays */
static gx_result gxbp_take_room(gxbp_census *c) {
    const gx_allocator *a = &c->cx->store.allocator;
    const size_t head = (sizeof(gxb_block) + 15) & ~(size_t)15;
    c->pool = gxbp_room_for(c->pool) + 1;
    if (c->pool > INT32_MAX) return GX_ERROR_LIMIT;
    c->list = (uint32_t *)gxbp_allocate(a, c->pool * sizeof *c->list);
    if (c->list == NULL) return GX_ERROR_MEMORY;
    if (c->exact == 0) return GX_OK;
    c->numbers = (gxb_block *)gxbp_allocate(a, head + c->exact);
    if (c->numbers == NULL) return GX_ERROR_MEMORY;
    c->numbers->next = NULL;
    c->numbers->size = head + c->exact;
    c->numbers->used = head;
    return GX_OK;
}

/* --- from here on nothing fails --- */

/* Appends the parts of a facet to the list of a leaf. */
static GXBP_COLD void gxbp_keep_facets(gxbp_census *c, uint32_t facet, uint32_t *end) {
    const uint32_t child = c->cx->facets[facet].child;
    if (child >= GXB_UNLISTED) {
        if (c->facets[facet] != GXB_NONE) c->list[(*end)++] = c->facets[facet];
        return;
    }
    gxbp_keep_facets(c, child, end);
    gxbp_keep_facets(c, child + 1, end);
}

/* Writes the lists of what stays to the new pool. The list of a leaf has those of its parts, one after the other. */
static void gxbp_keep_lists(gxbp_census *c) {
    gxb_complex *cx = c->cx;
    uint32_t i, j, n = 0;
    for (i = 0; i < cx->facet_count; i++) {
        const uint32_t first = n;
        for (j = 0; j < c->loop_count[i]; j++) {
            const uint32_t e = c->loops[c->loop[i] + j];
            c->list[n++] = c->edges[e >> 1] << 1 | (e & 1);
        }
        gxbp_set_loop(&cx->facets[i], first, n - first);
    }
    for (i = 0; i < cx->leaf_count; i++) {
        c->list_end[i] = n;
        n += c->list_count[i];
    }
    for (i = 0; i < cx->leaf_count; i++)
        for (j = 0; j < cx->leaves[i].facet_count && gxbp_stays(c, i); j++)
            gxbp_keep_facets(c, cx->pool[cx->leaves[i].facets + j], &c->list_end[c->leaf_of[i]]);
    for (i = 0; i < cx->leaf_count; i++) {
        cx->leaves[i].facets = c->list_end[i] - c->list_count[i];
        cx->leaves[i].facet_count = c->list_count[i];
    }
    gxbp_release(&cx->store.allocator, cx->pool, (size_t)cx->pool_capacity * sizeof *cx->pool);
    cx->pool = c->list;
    cx->pool_count = cx->pool_live = n;
    cx->pool_capacity = (uint32_t)c->pool;
}

/* Moves exact numbers to the new block. */
static gxb_num *gxbp_move_exact(gxbp_census *c, const gxb_num *exact) {
    const size_t used = exact != NULL ? c->numbers->used : 0;
    if (exact == NULL) return NULL;
    c->numbers->used += gxbp_exact_size(exact);
    return gxbp_copy_exact((unsigned char *)c->numbers + used, exact);
}

static void gxbp_move_line(const gxbp_census *c, uint32_t line[2], uint32_t explicit_line) {
    const uint32_t *of = explicit_line ? c->points : c->planes;
    line[0] = of[line[0]];
    line[1] = of[line[1]];
}

static void gxbp_keep_store(gxbp_census *c, uint32_t points, uint32_t planes) {
    gxb_store *store = &c->cx->store;
    uint32_t i;
    for (i = 0; i < store->point_count; i++) {
        gxb_cpoint *p = &store->points[i];
        if (c->points[i] == GXB_NONE) continue;
        p->exact = gxbp_move_exact(c, p->exact);
        if (p->kind != GXB_EXPLICIT) {
            gxbp_move_line(c, p->def, p->kind == GXB_LINE_PLANE);
            p->def[2] = c->planes[p->def[2]];
        }
        store->points[c->points[i]] = *p;
    }
    for (i = 0; i < store->plane_count; i++) {
        gxb_cplane *f = &store->planes[i];
        if (c->planes[i] == GXB_NONE) continue;
        f->exact = gxbp_move_exact(c, f->exact);
        gxbp_move_line(c, f->def, 1);
        if (!f->along_axis) f->def[2] = c->points[f->def[2]];
        store->planes[c->planes[i]] = *f;
    }
    store->point_count = points;
    store->plane_count = planes;
    gxbp_drop_numbers(store, NULL);
    store->blocks = c->numbers;
}

/* Takes the parts of faces and mesh edges from the lists of what they were divided into, unless these stay. */
static void gxbp_unlist(gxbp_census *c) {
    gxb_complex *cx = c->cx;
    uint32_t i, first;
    for (i = 0; i < cx->face_count; i++) {
        first = c->face_first[i];
        if (first == GXB_NONE) continue;
        if (!(gxbp_face_state(c, i) & GXBP_LISTED) && cx->facets[first].child < GXB_UNLISTED)
            cx->facets[first].child = GXB_UNLISTED;
        cx->face_facet[i] = c->facets[first];
    }
    for (i = 0; i < cx->mesh_edge_count; i++) {
        first = c->edge_first[i];
        if (first == GXB_NONE) continue;
        if (!(c->mesh_edges[i] & GXBP_LISTED) && cx->edges[first].child < GXB_UNLISTED)
            cx->edges[first].child = GXB_UNLISTED;
        cx->mesh_edge[i] = c->edges[first];
    }
}

static void gxbp_keep_polygons(gxbp_census *c, uint32_t edges, uint32_t facets) {
    gxb_complex *cx = c->cx;
    uint32_t i, k;
    for (i = 0; i < cx->edge_count; i++) {
        gxb_edge *e = &cx->edges[i];
        if (c->edges[i] == GXB_NONE) continue;
        for (k = 0; k < 2; k++) e->v[k] = c->points[c->ends[2 * (size_t)i + k]];
        gxbp_move_line(c, e->line, e->explicit_line);
        if (e->child < GXB_UNLISTED) e->child = c->edges[e->child];
        cx->edges[c->edges[i]] = *e;
    }
    for (i = 0; i < cx->facet_count; i++) {
        gxb_facet *f = &cx->facets[i];
        if (c->facets[i] == GXB_NONE) continue;
        f->plane = c->planes[f->plane];
        f->labels = f->loop_count > 0 && f->labels != GXB_NONE ? c->labels[f->labels] : GXB_NONE;
        if (f->child < GXB_UNLISTED) f->child = c->facets[f->child];
        for (k = 0; k < 2; k++)
            if (f->leaf[k] != GXB_NONE) f->leaf[k] = c->leaves[f->leaf[k]];
        cx->facets[c->facets[i]] = *f;
    }
    cx->edge_count = edges;
    cx->facet_count = facets;
}

static void gxbp_keep_labels(gxbp_census *c, uint32_t labels) {
    gxb_complex *cx = c->cx;
    uint32_t i;
    for (i = 0; i < cx->label_count; i++) {
        gxb_label *l = &cx->labels[i];
        if (c->labels[i] == GXB_NONE) continue;
        if (l->next != GXB_NONE) l->next = c->labels[l->next];
        cx->labels[c->labels[i]] = *l;
    }
    cx->label_count = labels;
}

/* Parents of nodes and numbers of leaves, from the nodes' children */
static void gxbp_link_trees(gxb_complex *cx) {
    uint32_t i, k, n;
    for (i = 0; i < cx->tree_count; i++) {
        cx->nodes[i].parent = GXB_NONE;
        cx->nodes[i].leaves = 0;
    }
    for (i = 0; i < cx->tree_count; i++)
        for (k = 0; k < 2; k++)
            if (cx->nodes[i].child[k] & 1) cx->nodes[cx->nodes[i].child[k] >> 1].parent = i;
    for (i = 0; i < cx->tree_count; i++)
        for (k = 0; k < 2; k++)
            for (n = cx->nodes[i].child[k] & 1 ? GXB_NONE : i; n != GXB_NONE; n = cx->nodes[n].parent)
                cx->nodes[n].leaves++;
}

static uint32_t gxbp_new_reference(const gxbp_census *c, uint32_t reference) {
    return reference & 1 ? reference : c->leaves[reference >> 1] << 1;
}

static void gxbp_keep_trees(gxbp_census *c, uint32_t leaves) {
    gxb_complex *cx = c->cx;
    uint32_t i, k, next = 0;
    cx->removed_count = 0;
    cx->tree_count = c->node_count;
    for (i = 0; i < cx->tree_count; i++) {
        const uint32_t *n = c->nodes + 3 * (size_t)i;
        cx->nodes[i].plane = c->planes[n[0]];
        cx->nodes[i].facet = GXB_NONE;
        for (k = 0; k < 2; k++) cx->nodes[i].child[k] = gxbp_new_reference(c, n[1 + k]);
    }
    for (i = 0; i < cx->element_count; i++) cx->root[i] = gxbp_new_reference(c, c->roots[i]);
    for (i = 0; i < cx->leaf_count; i++) {
        if (c->leaf_of[i] != i) continue;
        cx->leaves[next] = cx->leaves[i];
        if (next >= cx->element_count) cx->leaves[next].parent = cx->leaves[next].element;
        cx->removed_count += cx->leaves[next++].removed;
    }
    cx->leaf_count = leaves;
    gxbp_link_trees(cx);
}

/* --- the whole of it --- */

static uint32_t *gxbp_take_words(uint32_t **block, size_t count) {
    uint32_t *words = *block;
    *block += count;
    return words;
}

/* The most leaves in one element's tree */
static uint32_t gxbp_most_leaves(const gxb_complex *cx) {
    uint32_t i, most = 1;
    for (i = 0; i < cx->element_count; i++)
        if ((cx->root[i] & 1) && cx->nodes[cx->root[i] >> 1].leaves > most) most = cx->nodes[cx->root[i] >> 1].leaves;
    return most;
}

/* Room to plan an element's tree, for each of its leaves */
#define GXBP_PLANS 32u

/* The census itself is at the head of its block. */
#define GXBP_CENSUS_WORDS ((sizeof(gxbp_census) + 15) / 16 * 4)

static gx_result gxbp_open_census(gxbp_census *c, gxb_complex *cx) {
    const size_t elements = cx->element_count, leaves = cx->leaf_count, trees = cx->tree_count, edges = cx->edge_count,
                 facets = cx->facet_count, points = cx->store.point_count, plans = GXBP_PLANS * gxbp_most_leaves(cx);
    uint32_t *next;
    memset(c, 0, sizeof *c);
    c->cx = cx;
    c->words = GXBP_CENSUS_WORDS + 3 * points + cx->store.plane_count + 5 * edges + 6 * facets + 6 * leaves + 1 +
               cx->label_count + 3 * elements + 2 * (size_t)cx->mesh_edge_count + cx->face_count + 4 * trees +
               5 * plans;
    if (c->words > SIZE_MAX / sizeof *next || leaves + plans > UINT32_MAX / GXBP_KINDS) return GX_ERROR_LIMIT;
    c->block = (uint32_t *)gxbp_allocate(&cx->store.allocator, c->words * sizeof *next);
    if (c->block == NULL) return GX_ERROR_MEMORY;
    next = c->block + GXBP_CENSUS_WORDS;
    c->leaf_up = gxbp_take_words(&next, leaves);
    c->planes = gxbp_take_words(&next, cx->store.plane_count);
    c->points = gxbp_take_words(&next, points);
    c->edges = gxbp_take_words(&next, edges);
    c->owner = gxbp_take_words(&next, 2 * edges);
    c->facets = gxbp_take_words(&next, facets);
    c->group = gxbp_take_words(&next, facets);
    c->labels = gxbp_take_words(&next, cx->label_count);
    c->hollow = gxbp_take_words(&next, elements);
    /* The others are written before they are read. */
    memset(c->block, 0xff, (size_t)(next - c->block) * sizeof *next);
    c->leaves = gxbp_take_words(&next, leaves);
    c->leaf_of = gxbp_take_words(&next, leaves);
    c->list_count = gxbp_take_words(&next, leaves);
    c->list_end = gxbp_take_words(&next, leaves);
    c->first_piece = gxbp_take_words(&next, leaves + 1);
    c->at = gxbp_take_words(&next, 2 * points);
    c->ends = gxbp_take_words(&next, 2 * edges);
    c->loop = gxbp_take_words(&next, facets);
    c->loop_count = gxbp_take_words(&next, facets);
    c->order = gxbp_take_words(&next, facets);
    c->facet_of = gxbp_take_words(&next, facets);
    c->elements = gxbp_take_words(&next, elements);
    c->roots = gxbp_take_words(&next, elements);
    c->mesh_edges = gxbp_take_words(&next, cx->mesh_edge_count);
    c->edge_first = gxbp_take_words(&next, cx->mesh_edge_count);
    c->face_first = gxbp_take_words(&next, cx->face_count);
    c->bounds = gxbp_take_words(&next, trees);
    c->nodes = gxbp_take_words(&next, 3 * trees);
    c->plan = gxbp_take_words(&next, 3 * plans);
    c->pairs = gxbp_take_words(&next, 2 * plans);
    c->plan_room = c->pair_room = (uint32_t)plans;
    return GX_OK;
}

static gx_result gxbp_take_census(gxbp_census *c, const uint8_t *pinned, const uint32_t *kinds) {
    gx_result result;
    gxbp_mark_leaves(c, pinned);
    gxbp_mark_polygons(c);
    result = gxbp_write_loops(c);
    if (result != GX_OK) return result;
    gxbp_mark_bounds(c, kinds);
    result = gxbp_renew_trees(c);
    if (result == GX_OK) result = gxbp_unite_polygons(c);
    if (result != GX_OK) return result;
    gxbp_unite_edges(c);
    gxbp_restore_whole(c);
    gxbp_mark_definitions(c);
    gxbp_count_exact(c);
    gxbp_count_lists(c);
    return gxbp_take_room(c);
}

/* Releases what the census has, but for its block: lists and numbers too, unless they have become the complex's. */
static void gxbp_close_census(gxbp_census *c) {
    const gx_allocator *a = &c->cx->store.allocator;
    gxbp_release(a, c->loops, c->loop_room * sizeof *c->loops);
    gxbp_release(a, c->pieces, (c->piece_room + (size_t)1) * sizeof *c->pieces);
    gxbp_release(a, c->list, c->pool * sizeof *c->list);
    if (c->numbers != NULL) gxbp_release(a, c->numbers, c->numbers->size);
    c->loops = c->list = NULL;
    c->pieces = NULL;
    c->numbers = NULL;
}

/* An array whose room is several times what it holds becomes smaller. Without memory for that it stays as it is. A
   caller's reallocate need not know how to make a block smaller. */
static void gxbp_shrink(gx_allocator a, void *owner, const gxbp_array *array) {
    const uint32_t count = *gxbp_word(owner, array->count);
    uint32_t *capacity = gxbp_word(owner, array->capacity);
    const size_t room = gxbp_room_for(2 * (size_t)count);
    void *old, *memory;
    if (*capacity <= room) return;
    memcpy(&old, gxbp_field(owner, array->pointer), sizeof old);
    a.reallocate = NULL;
    memory = gxbp_reallocate(&a, old, (size_t)*capacity * array->item, (size_t)count * array->item, room * array->item);
    if (memory == NULL) return;
    memcpy(gxbp_field(owner, array->pointer), &memory, sizeof memory);
    *capacity = (uint32_t)room;
}

static uint64_t gxbp_count_items(const gxb_complex *cx) {
    return (uint64_t)cx->store.point_count + cx->store.plane_count + cx->edge_count + cx->facet_count + cx->leaf_count;
}

/* Numbers stay what they were as long as names are far from their end: arrays are shorter than that. */
static int gxbp_rename(gxb_store *store) {
    uint32_t i;
    if (store->next_name <= INT32_MAX) return 0;
    for (i = 0; i < store->point_count; i++) store->points[i].name = i;
    store->next_name = store->point_count;
    return 1;
}

static void gxbp_settle(gxbp_census *c) {
    gxb_complex *cx = c->cx;
    const uint32_t points = gxbp_number(c->points, cx->store.point_count),
                   planes = gxbp_number(c->planes, cx->store.plane_count),
                   edges = gxbp_number(c->edges, cx->edge_count), facets = gxbp_number(c->facets, cx->facet_count),
                   leaves = gxbp_number_leaves(c), labels = gxbp_number(c->labels, cx->label_count);
    uint32_t i;
    gxbp_keep_lists(c);
    gxbp_unlist(c);
    gxbp_keep_polygons(c, edges, facets);
    gxbp_keep_labels(c, labels);
    gxbp_keep_trees(c, leaves);
    gxbp_keep_store(c, points, planes);
    for (i = 0; i < 2; i++) gxbp_forget_signs(&cx->store, (int)i);
    cx->sign_plane = GXB_NONE;
    gxbp_forget_pairs(cx);
    for (i = 0; i < 2; i++) gxbp_shrink(cx->store.allocator, &cx->store, &gxbp_store_arrays[i]);
    for (i = 0; i < GXBP_MARKS; i++) gxbp_shrink(cx->store.allocator, cx, &gxbp_complex_arrays[i]);
    cx->settled = gxbp_count_items(cx);
    gxbp_set_marks(cx);
}

/* Tests compact at every opportunity. */
#ifndef GXBP_IS_SPARSE
#define GXBP_IS_SPARSE(sparse) (sparse)
#endif

/* Compacting twice as many items as after the last time takes a tenth of the time in which they were made, where a
   third of all leaves is removed. Where less is, most items stay, and it waits for four times as many. */
GXFEM_API int gxb_complex_is_sparse(const gxb_complex *cx) {
    const uint64_t items = gxbp_count_items(cx), removed = cx->removed_count;
    return GXBP_IS_SPARSE(removed > 0 && items > (3 * removed > cx->leaf_count ? 2 : 4) * cx->settled + 16384);
}

GXFEM_API gx_result gxb_complex_survey(gxb_complex *cx, const uint8_t *pinned, const uint32_t *kinds,
                                       gxb_renumbering *r) {
    gxbp_census c;
    gx_result result = gxbp_open_census(&c, cx);
    memset(r, 0, sizeof *r);
    if (result != GX_OK) return result;
    result = gxbp_take_census(&c, pinned, kinds);
    if (result != GX_OK) {
        gxbp_close_census(&c);
        gxbp_release(&cx->store.allocator, c.block, c.words * sizeof *c.block);
        return result;
    }
    memcpy(c.block, &c, sizeof c);
    r->leaf_count = cx->leaf_count;
    r->plane_count = cx->store.plane_count;
    r->leaves = c.leaves;
    r->leaf_of = c.leaf_of;
    r->planes = c.planes;
    r->changed = c.elements;
    r->memory = c.block;
    r->size = c.words * sizeof *c.block;
    return GX_OK;
}

GXFEM_API void gxb_complex_compact(gxb_complex *cx, gxb_renumbering *r) {
    gxbp_census *c = (gxbp_census *)r->memory;
    uint32_t i;
    gxbp_settle(c);
    c->list = NULL; /* the complex has them */
    c->numbers = NULL;
    for (i = 0; i < cx->element_count; i++) c->elements[i] = (c->elements[i] & GXBP_CHANGED) != 0;
    r->renamed = gxbp_rename(&cx->store);
}

GXFEM_API void gxb_complex_forget(gxb_complex *cx, gxb_renumbering *r) {
    if (r->memory != NULL) gxbp_close_census((gxbp_census *)r->memory);
    gxbp_release(&cx->store.allocator, r->memory, r->size);
    memset(r, 0, sizeof *r);
}

/* >>save: points by their definitions, the rest by indices --------------------------------------------------------- */
/* In: a complex, or bytes. Out: bytes, or a complex that has been checked. Reading trusts nothing. */

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
    if (stream->in == NULL && stream->out != NULL && bytes > stream->size - stream->at)
        stream->result = GX_ERROR_CAPACITY;
    if (stream->result != GX_OK || bytes == 0) return;
    if (stream->in != NULL)
        memcpy(data, stream->in + stream->at, bytes);
    else if (stream->out != NULL)
        memcpy(stream->out + stream->at, data, bytes);
    stream->at += bytes;
}

static GXBP_APART void gxbp_pass_word(gxb_stream *s, uint32_t *word) { gxb_stream_pass(s, word, 1, sizeof *word); }

static void gxbp_require(gxb_stream *s, gx_result result) {
    if (s->result == GX_OK) s->result = result;
}
static void gxbp_require_true(gxb_stream *s, int holds) {
    if (!holds) gxbp_require(s, GX_ERROR_DAMAGED);
}

/* A word that is 0 or 1 */
static uint32_t gxbp_pass_bit(gxb_stream *s, uint32_t bit) {
    gxbp_pass_word(s, &bit);
    gxbp_require_true(s, bit <= 1);
    return bit;
}

static GXBP_COLD void gxbp_save_points(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->store.point_count; i++) {
        gxb_cpoint *p = &cx->store.points[i];
        uint32_t head = (uint32_t)p->kind | (uint32_t)p->wall << 2;
        double x[3];
        gxbp_pass_word(s, &head);
        if (i < cx->node_count) continue;
        if (p->kind != GXB_EXPLICIT) {
            gxb_stream_pass(s, p->def, 3, sizeof *p->def);
            continue;
        }
        if (s->out != NULL) gxbp_given(&cx->store, i, x);
        gxb_stream_pass(s, x, 3, sizeof *x);
    }
}

/* Points by definition get no ball yet: it needs the planes. */
static GXBP_COLD void gxbp_load_points(gxb_complex *cx, gxb_stream *s, uint32_t count) {
    uint32_t i;
    for (i = 0; i < count && s->result == GX_OK; i++) {
        uint32_t head, id = i, def[3];
        double x[3];
        gxbp_pass_word(s, &head);
        gxbp_require_true(s, head < 8 && (head & 3) <= (i < cx->node_count ? 0u : 2u));
        if (i < cx->node_count) {
            cx->store.points[i].wall = (uint8_t)(head >> 2);
            continue;
        }
        if ((head & 3) == GXB_EXPLICIT)
            gxb_stream_pass(s, x, 3, sizeof *x);
        else
            gxb_stream_pass(s, def, 3, sizeof *def);
        if (s->result != GX_OK) return;
        if ((head & 3) == GXB_EXPLICIT) {
            const gx_result result = gxb_complex_add_point(cx, x, &id);
            if (result != GX_OK)
                gxbp_require(s, result == GX_ERROR_MEMORY || result == GX_ERROR_LIMIT ? result : GX_ERROR_DAMAGED);
        } else {
            gxbp_require(s, gxbp_new_point(&cx->store, &id));
            if (s->result == GX_OK) memcpy(cx->store.points[id].def, def, sizeof def);
        }
        if (s->result != GX_OK) return;
        cx->store.points[id].kind = (uint8_t)(head & 3);
        cx->store.points[id].wall = (uint8_t)(head >> 2);
    }
}

static int gxbp_is_explicit(const gxb_store *store, uint32_t point) {
    return point < store->point_count && store->points[point].kind == GXB_EXPLICIT;
}

static GXBP_COLD void gxbp_save_planes(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->store.plane_count; i++) {
        gxb_stream_pass(s, cx->store.planes[i].def, 3, sizeof *cx->store.planes[i].def);
        gxbp_pass_bit(s, cx->store.planes[i].along_axis);
    }
}

/* Planes must have a normal. */
static GXBP_COLD void gxbp_load_planes(gxb_complex *cx, gxb_stream *s, uint32_t count) {
    uint32_t i, k;
    for (i = 0; i < count && s->result == GX_OK; i++) {
        uint32_t def[3], along_axis, id = 0;
        int normal = 0;
        gxb_stream_pass(s, def, 3, sizeof *def);
        along_axis = gxbp_pass_bit(s, 0);
        gxbp_require_true(s, gxbp_is_explicit(&cx->store, def[0]) && gxbp_is_explicit(&cx->store, def[1]) &&
                                 (along_axis ? def[2] < 3 : gxbp_is_explicit(&cx->store, def[2])));
        if (s->result == GX_OK)
            gxbp_require(s, gxbp_new_plane(&cx->store, def[0], def[1], def[2], (int)along_axis, &id));
        if (s->result != GX_OK) return;
        if (along_axis)
            for (k = 0; k < 3 && !normal; k++) normal = gxbp_normal_sign(&cx->store, id, k) != 0;
        else
            normal = gxbp_plane_axis(&cx->store, id);
        gxbp_require_true(s, normal);
    }
}

/* Points by definition must be points: a filter that is certain of their place proves it, else their exact weight. */
static GXBP_COLD void gxbp_place_points(gxb_complex *cx, gxb_stream *s) {
    uint32_t i, k;
    for (i = cx->node_count; i < cx->store.point_count && s->result == GX_OK; i++) {
        gxb_cpoint *p = &cx->store.points[i];
        if (p->kind == GXB_EXPLICIT) continue;
        for (k = 0; k < 3; k++)
            gxbp_require_true(s, k < 2 && p->kind == GXB_LINE_PLANE ? gxbp_is_explicit(&cx->store, p->def[k])
                                                                    : p->def[k] < cx->store.plane_count);
        if (s->result != GX_OK) return;
        gxbp_definition_ball(&cx->store, p->kind, p->def, &p->ball);
        if (p->ball.error >= GXBP_NO_BALL) {
            gxbp_vec store;
            gxbp_require_true(s, gxbp_exact_cpoint(&cx->store, i, &store)[3].sign != 0);
        }
    }
}

/* A list of the pool; reading appends it. */
static void gxbp_pass_list(gxb_complex *cx, gxb_stream *s, uint32_t *first, uint32_t *count) {
    gxbp_pass_word(s, count);
    if (s->in != NULL) {
        if (!gxb_stream_has(s, *count, sizeof *cx->pool)) {
            *count = 0;
            return;
        }
        gxbp_require(s, GXBP_RESERVE(&cx->store.allocator, cx, pool, pool, *count));
        if (s->result != GX_OK) {
            *count = 0;
            return;
        }
        *first = cx->pool_count;
        cx->pool_count += *count;
    }
    if (*count > 0) gxb_stream_pass(s, cx->pool + *first, *count, sizeof *cx->pool);
}

static GXBP_COLD void gxbp_pass_edges(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->edge_count; i++) {
        gxb_edge *e = &cx->edges[i];
        gxb_stream_pass(s, e->v, 2, sizeof *e->v);
        gxb_stream_pass(s, e->line, 2, sizeof *e->line);
        e->explicit_line = gxbp_pass_bit(s, e->explicit_line) & 1;
        gxbp_pass_word(s, &e->child);
        e->wall = gxbp_pass_bit(s, e->wall) & 1;
    }
}

/* Is it a facet inside an element that was divided? Then it knows the plane that did it. */
static int gxbp_is_parted(const gxb_facet *f) { return f->child < GXB_UNLISTED && f->face == GXB_NONE; }

static GXBP_COLD void gxbp_pass_facets(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->facet_count; i++) {
        gxb_facet *f = &cx->facets[i];
        uint32_t first = f->loop, count = f->loop_count;
        gxbp_pass_word(s, &f->plane);
        gxb_stream_pass(s, f->leaf, 2, sizeof *f->leaf);
        gxbp_pass_word(s, &f->child);
        gxbp_pass_word(s, &f->labels);
        gxbp_pass_word(s, &f->face);
        f->wall = gxbp_pass_bit(s, f->wall) & 1;
        gxbp_pass_list(cx, s, &first, &count);
        if (count == 0 && gxbp_is_parted(f)) gxbp_pass_word(s, &first);
        gxbp_set_loop(f, first, count);
    }
}

static GXBP_COLD void gxbp_pass_leaves(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    for (i = 0; i < cx->leaf_count; i++) {
        gxb_leaf *l = &cx->leaves[i];
        gxbp_pass_word(s, &l->element);
        gxbp_pass_word(s, &l->parent);
        gxbp_pass_word(s, &l->removed);
        gxbp_pass_list(cx, s, &l->facets, &l->facet_count);
    }
}

static GXBP_COLD void gxbp_pass_rest(gxb_complex *cx, gxb_stream *s) {
    uint32_t i;
    gxb_stream_pass(s, cx->face_facet, cx->face_count, sizeof *cx->face_facet);
    gxb_stream_pass(s, cx->mesh_edge, cx->mesh_edge_count, sizeof *cx->mesh_edge);
    gxb_stream_pass(s, cx->root, cx->element_count, sizeof *cx->root);
    gxb_stream_pass(s, &cx->settled, 1, sizeof cx->settled);
    gxbp_require_true(s, cx->settled <= (uint64_t)5 * INT32_MAX);
    for (i = 0; i < cx->tree_count; i++) {
        gxbp_pass_word(s, &cx->nodes[i].plane);
        gxb_stream_pass(s, cx->nodes[i].child, 2, sizeof *cx->nodes[i].child);
        gxbp_pass_word(s, &cx->nodes[i].facet);
    }
    for (i = 0; i < cx->label_count; i++) {
        gxbp_pass_word(s, &cx->labels[i].triangle);
        gxb_stream_pass(s, &cx->labels[i].orientation, 1, sizeof cx->labels[i].orientation);
        gxbp_pass_word(s, &cx->labels[i].next);
    }
}

/* The arrays that are saved, in this order; the fewest bytes that an item takes. Points and planes are appended as they
   are read; the items of the others are zero until they are read. */
typedef struct gxbp_saved {
    gxbp_array array;
    uint16_t least;
    uint8_t appended;
} gxbp_saved;
static const gxbp_saved gxbp_saved_arrays[] = {/* the first begins with the nodes, the fifth with the first leaves */
                                               {GXBP_ARRAY(gxb_complex, store.points, store.point), 4, 1},
                                               {GXBP_ARRAY(gxb_complex, store.planes, store.plane), 16, 1},
                                               {GXBP_ARRAY(gxb_complex, edges, edge), 28, 0},
                                               {GXBP_ARRAY(gxb_complex, facets, facet), 32, 0},
                                               {GXBP_ARRAY(gxb_complex, leaves, leaf), 16, 0},
                                               {GXBP_ARRAY(gxb_complex, nodes, tree), 16, 0},
                                               {GXBP_ARRAY(gxb_complex, labels, label), 12, 0}};
enum { GXBP_COUNTS = sizeof gxbp_saved_arrays / sizeof *gxbp_saved_arrays };

/* Reading: gives an array so many items, all zero. */
static void gxbp_load_items(gxb_stream *s, gxb_complex *cx, const gxbp_array *array, uint32_t count) {
    uint32_t *present = gxbp_word(cx, array->count);
    void *items;
    gxbp_require(s, gxbp_reserve(&cx->store.allocator, gxbp_field(cx, array->pointer), 0,
                                 gxbp_word(cx, array->capacity), array->item, count));
    if (s->result != GX_OK) return;
    *present = count;
    memcpy(&items, gxbp_field(cx, array->pointer), sizeof items);
    if (count > 0) memset(items, 0, (size_t)count * array->item);
}

/* Passes the counts of all arrays. Reading: checks them, and makes room. */
static void gxbp_pass_counts(gxb_complex *cx, gxb_stream *s, uint32_t counts[GXBP_COUNTS]) {
    uint32_t i;
    for (i = 0; i < GXBP_COUNTS; i++) counts[i] = *gxbp_word(cx, gxbp_saved_arrays[i].array.count);
    gxb_stream_pass(s, counts, GXBP_COUNTS, sizeof *counts);
    if (s->in == NULL) return;
    for (i = 0; i < GXBP_COUNTS; i++) {
        gxb_stream_has(s, counts[i], gxbp_saved_arrays[i].least);
        gxbp_require_true(s, counts[i] <= INT32_MAX);
    }
    gxbp_require_true(s, counts[0] >= cx->node_count && counts[4] >= cx->element_count);
    for (i = 0; i < GXBP_COUNTS && s->result == GX_OK; i++)
        if (!gxbp_saved_arrays[i].appended) gxbp_load_items(s, cx, &gxbp_saved_arrays[i].array, counts[i]);
}

/* Passes the arrays behind points and planes. */
static void gxbp_pass_arrays(gxb_complex *cx, gxb_stream *s) {
    if (s->result == GX_OK) gxbp_pass_edges(cx, s);
    if (s->result == GX_OK) gxbp_pass_facets(cx, s);
    if (s->result == GX_OK) gxbp_pass_leaves(cx, s);
    if (s->result == GX_OK) gxbp_pass_rest(cx, s);
}

GXFEM_API GXBP_RARE void gxb_complex_save(gxb_complex *cx, gxb_stream *stream) {
    uint32_t counts[GXBP_COUNTS];
    gxbp_pass_counts(cx, stream, counts);
    gxbp_save_points(cx, stream);
    gxbp_save_planes(cx, stream);
    gxbp_pass_arrays(cx, stream);
}

/* >>check: is what was read a complex? ----------------------------------------------------------------------------- */
/* In: what was read. Out: the stream's error if it is no complex. First every index is checked, then that trees are
   trees, then geometry, by the exact predicates. Each facet is a convex polygon in its plane. Each leaf is closed and
   lies on one side of its facets' planes, which are those of its element's faces and of the nodes above it in the tree.
   So each leaf is all of its part of the tree, and a triangle that the tree sends to a leaf divides it. */

#define GXBP_DEPTH 10000 /* of a tree of edges, facets or leaves: functions that walk them call themselves */

/* Trees of items that were divided into (child, child + 1): each child comes behind its one parent. child: of item i at
   first + i * size. depth: count. Items whose parts are not listed are checked elsewhere. */
static void gxbp_check_trees(gxb_stream *s, const uint32_t *first, size_t size, uint32_t count, uint32_t *depth) {
    uint32_t i, child;
    if (count > 0) memset(depth, 0, count * sizeof *depth);
    for (i = 0; i < count && s->result == GX_OK; i++) {
        memcpy(&child, (const unsigned char *)first + i * size, sizeof child);
        if (child >= GXB_UNLISTED) continue;
        gxbp_require_true(s, child > i && child < count - 1 && depth[child] == 0 && depth[child + 1] == 0);
        if (s->result != GX_OK) return;
        depth[child] = depth[child + 1] = depth[i] + 1;
        if (depth[child] > GXBP_DEPTH) gxbp_require(s, GX_ERROR_LIMIT);
    }
}

static int gxbp_below(uint32_t index, uint32_t count) { return index == GXB_NONE || index < count; }

/* Does the leaf stand for all removed leaves of its element? It has no facets, and may hang in several places. */
static int gxbp_is_hollow(const gxb_complex *cx, uint32_t leaf) {
    return leaf != GXB_NONE && cx->leaves[leaf].removed && cx->leaves[leaf].facet_count == 0;
}

/* Is it an element that nothing has touched? When it is opened, it takes all parts of its faces and edges. */
static int gxbp_is_closed(const gxb_complex *cx, uint32_t element) {
    return element != GXB_NONE && !cx->leaves[element].removed && cx->leaves[element].facet_count == 0;
}

static void gxbp_check_indices(gxb_complex *cx, gxb_stream *s) {
    uint32_t i, j;
    int good = 1;
    for (i = 0; i < cx->edge_count; i++) {
        const gxb_edge *e = &cx->edges[i];
        good &= e->v[0] < cx->store.point_count && e->v[1] < cx->store.point_count && e->v[0] != e->v[1];
        for (j = 0; j < 2; j++)
            good &=
                e->explicit_line == 1 ? gxbp_is_explicit(&cx->store, e->line[j]) : e->line[j] < cx->store.plane_count;
    }
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        good &= f->plane < cx->store.plane_count &&
                !cx->store.planes[f->plane < cx->store.plane_count ? f->plane : 0].along_axis &&
                gxbp_below(f->leaf[0], cx->leaf_count) && gxbp_below(f->leaf[1], cx->leaf_count) &&
                f->leaf[0] != f->leaf[1] && gxbp_below(f->labels, cx->label_count) &&
                gxbp_below(f->face, cx->face_count);
        for (j = 0; j < f->loop_count; j++) good &= cx->pool[f->loop + j] >> 1 < cx->edge_count;
        if (gxbp_is_parted(f)) good &= f->loop_count == 0 && f->loop < cx->store.plane_count;
    }
    for (i = 0; i < cx->leaf_count; i++) {
        const gxb_leaf *l = &cx->leaves[i];
        good &= l->element < cx->element_count && l->removed <= 1;
        good &= i < cx->element_count ? l->element == i && l->parent == GXB_NONE
                                      : l->parent < i && cx->leaves[l->parent].element == l->element &&
                                            (l->facet_count > 0 || l->removed == 1);
        for (j = 0; j < l->facet_count; j++) good &= cx->pool[l->facets + j] < cx->facet_count;
        if (!good) break;
    }
    for (i = 0; i < cx->label_count; i++) /* lists share their ends, which are older */
        good &= (cx->labels[i].next == GXB_NONE || cx->labels[i].next < i) && cx->labels[i].orientation >= -1 &&
                cx->labels[i].orientation <= 1;
    for (i = 0; i < cx->face_count; i++) good &= gxbp_below(cx->face_facet[i], cx->facet_count);
    for (i = 0; i < cx->mesh_edge_count; i++) good &= gxbp_below(cx->mesh_edge[i], cx->edge_count);
    gxbp_require_true(s, good);
}

/* --- edges: on their lines, divided between their ends --- */

static int gxbp_same_place(gxb_store *store, uint32_t a, uint32_t b) {
    gxbp_vec sa, sb;
    const gxb_num *p = gxbp_exact_cpoint(store, a, &sa), *q = gxbp_exact_cpoint(store, b, &sb);
    int k;
    for (k = 0; k < 3; k++) {
        GXB_NUM(d);
        gxbp_num_det2(&d, &p[k], &q[3], &q[k], &p[3]);
        if (d.sign != 0) return 0;
    }
    return 1;
}

static int gxbp_collinear(gxb_store *store, uint32_t a, uint32_t b, uint32_t c) {
    gxbp_vec sa, sb, sc;
    const gxb_num *p = gxbp_exact_cpoint(store, a, &sa), *q = gxbp_exact_cpoint(store, b, &sb),
                  *r = gxbp_exact_cpoint(store, c, &sc);
    return gxbp_orient_exact(p, q, r, 0, 1) == 0 && gxbp_orient_exact(p, q, r, 1, 2) == 0 &&
           gxbp_orient_exact(p, q, r, 2, 0) == 0;
}

static int gxbp_on_line(gxb_complex *cx, uint32_t point, const gxb_edge *e) {
    const gxb_cpoint *p = &cx->store.points[point];
    int i, planes = 0;
    if (!e->explicit_line)
        return gxb_complex_side(cx, point, e->line[0]) == 0 && gxb_complex_side(cx, point, e->line[1]) == 0;
    if (point == e->line[0] || point == e->line[1]) return 1;
    if (p->kind == GXB_LINE_PLANE && p->def[0] == e->line[0] && p->def[1] == e->line[1]) return 1;
    for (i = 0; i < 3 && p->kind == GXB_THREE_PLANES; i++)
        planes += gxbp_plane_has_line(&cx->store.planes[p->def[i]], e->line[0], e->line[1]);
    return planes >= 2 || gxbp_collinear(&cx->store, point, e->line[0], e->line[1]);
}

/* Does a given point lie between the ends of an edge whose line it defines? */
static int gxbp_given_divides(gxb_complex *cx, const gxb_edge *e, uint32_t point) {
    double x[3];
    int k, divides = 0;
    if (!e->explicit_line || (point != e->line[0] && point != e->line[1])) return 0;
    gxbp_given(&cx->store, point, x);
    for (k = 0; k < 3; k++)
        divides |= gxb_complex_compare(cx, e->v[0], k, x[k]) * gxb_complex_compare(cx, e->v[1], k, x[k]) < 0;
    return divides;
}

/* The halves of a divided edge: they meet in the point of its line and a plane between its ends, or in a given point of
 * it. */
static int gxbp_edge_is_divided(gxb_complex *cx, const gxb_edge *e) {
    const gxb_edge *a = &cx->edges[e->child], *b = a + 1;
    const gxb_cpoint *p = &cx->store.points[a->v[1]];
    if (a->v[0] != e->v[0] || b->v[1] != e->v[1] || a->v[1] != b->v[0]) return 0;
    if (a->explicit_line != e->explicit_line || b->explicit_line != e->explicit_line) return 0;
    if (memcmp(a->line, e->line, sizeof e->line) != 0 || memcmp(b->line, e->line, sizeof e->line) != 0) return 0;
    if (p->kind == GXB_EXPLICIT) return gxbp_given_divides(cx, e, a->v[1]);
    if (p->kind != (e->explicit_line ? GXB_LINE_PLANE : GXB_THREE_PLANES) || p->def[0] != e->line[0] ||
        p->def[1] != e->line[1])
        return 0;
    return gxb_complex_side(cx, e->v[0], p->def[2]) * gxb_complex_side(cx, e->v[1], p->def[2]) < 0;
}

/* depth: of each edge in its tree */
static void gxbp_check_edges(gxb_complex *cx, gxb_stream *s, const uint32_t *depth) {
    uint32_t i;
    for (i = 0; i < cx->edge_count && s->result == GX_OK; i++) {
        const gxb_edge *e = &cx->edges[i];
        if (depth[i] == 0) {
            gxbp_require_true(s, e->explicit_line ? !gxbp_same_place(&cx->store, e->line[0], e->line[1])
                                                  : gxbp_planes_cross(&cx->store, e->line[0], e->line[1]));
            gxbp_require_true(s, gxbp_on_line(cx, e->v[0], e) && gxbp_on_line(cx, e->v[1], e));
        }
        if (e->child < GXB_UNLISTED && s->result == GX_OK) gxbp_require_true(s, gxbp_edge_is_divided(cx, e));
    }
    for (i = 0; i < 6 * cx->element_count && s->result == GX_OK; i++) {
        const uint32_t edge = cx->mesh_edge[cx->element_edges[i]], *node = cx->elements + 4 * (size_t)(i / 6);
        const uint32_t a = node[gxbp_edge_nodes[i % 6][0]], b = node[gxbp_edge_nodes[i % 6][1]];
        const gxb_edge *e;
        if (edge == GXB_NONE) continue;
        e = &cx->edges[edge];
        gxbp_require_true(s, e->child != GXB_UNLISTED || !gxbp_is_closed(cx, i / 6));
        gxbp_require_true(s, depth[edge] == 0 && e->explicit_line && e->line[0] == (a < b ? a : b) &&
                                 e->line[1] == (a < b ? b : a) && memcmp(e->v, e->line, sizeof e->v) == 0);
    }
}

/* --- facets --- */

/* What the checks work with; one block of words */
typedef struct gxbp_checker {
    gxb_complex *cx;
    gxb_stream *s;
    uint32_t *edge_mark;  /* 2 x edge_count: round in which the edge was met, in this direction */
    uint32_t *border;     /* 2 x edge_count: round of the leaf or face at whose facets it was met */
    uint32_t *facet_mark; /* 2 x facet_count: the leaf on this side has it */
    uint32_t *edge;       /* edge_count: of the facet at work, undivided and signed */
    uint32_t *corner;     /* edge_count: indices of those at which its line changes */
    uint32_t *facet;      /* facet_count: undivided ones of the leaf or face at work */
    uint32_t *point;      /* point_count: of the leaf at work */
    uint32_t *point_mark; /* point_count: round in which the point was met */
    uint32_t *edge_depth, *facet_depth, *node_depth;
    uint32_t *facet_up, *facet_root; /* what it is half of (GXB_NONE: nothing), and the first of these */
    uint32_t *queue, hung;           /* nodes that hang in a tree, each behind the one above it */
    uint32_t *node_up, *leaf_up;     /* 2 x node above + side; GXB_NONE: it is a root */
    uint32_t *node_element;
    uint32_t count, corners, facets, points, round, loose; /* loose: edges in border without their opposite */
} gxbp_checker;

/* Appends the parts of a signed edge; none may come twice in a facet. */
static GXBP_COLD void gxbp_collect_edges(gxbp_checker *c, uint32_t signed_edge) {
    const uint32_t child = c->cx->edges[signed_edge >> 1].child, back = signed_edge & 1;
    gxbp_require_true(c->s, child != GXB_UNLISTED);
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

/* Edges first ... end-1 (cyclic) have one line. Do all corners lie to its left or on it, one of them not on it, and do
   all these edges go the same way along it? */
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
        a = gxbp_edge_start(cx, c->edge[i]);
        b = gxbp_edge_start(cx, c->edge[(i + 1) % c->count]);
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
        gxbp_require_true(c->s, cx->edges[e >> 1].v[1 - (e & 1)] == gxbp_edge_start(cx, next) &&
                                    c->point_mark[start] != c->round && gxb_complex_side(cx, start, plane) == 0);
        c->point_mark[start] = c->round;
        if (!gxbp_same_carrier(cx, c->edge[(i + c->count - 1) % c->count], e)) c->corner[c->corners++] = i;
    }
    gxbp_require_true(c->s, c->corners >= 3);
    for (i = 0; i < c->corners && c->s->result == GX_OK; i++)
        gxbp_require_true(c->s, gxbp_side_is_convex(c, plane, c->corner[i], c->corner[(i + 1) % c->corners]));
}

/* Is it the first facet of a mesh face, and nothing is left at the face? */
static int gxbp_is_spent(const gxb_complex *cx, uint32_t facet) {
    const gxb_facet *f = &cx->facets[facet];
    return f->child == GXB_NONE && f->face != GXB_NONE && cx->face_facet[f->face] == facet &&
           (f->leaf[0] == GXB_NONE || gxbp_is_hollow(cx, f->leaf[0])) &&
           (f->leaf[1] == GXB_NONE || gxbp_is_hollow(cx, f->leaf[1]));
}

/* A facet of a mesh face is its first one, or a part of that, or that does not list its parts. */
static int gxbp_is_in_face(const gxbp_checker *c, uint32_t facet) {
    const uint32_t root = c->cx->face_facet[c->cx->facets[facet].face];
    if (root == facet && c->facet_depth[facet] == 0) return 1;
    if (c->cx->facets[facet].child == GXB_UNLISTED) return 0;
    return c->facet_depth[facet] > 0 || (root != GXB_NONE && c->cx->facets[root].child == GXB_UNLISTED);
}

/* A facet's leaves are one element's, or those of its face's two elements. */
static int gxbp_facet_is_between(const gxb_complex *cx, const gxb_facet *f) {
    int k;
    if (f->face == GXB_NONE)
        return f->leaf[0] != GXB_NONE && f->leaf[1] != GXB_NONE &&
               cx->leaves[f->leaf[0]].element == cx->leaves[f->leaf[1]].element;
    for (k = 0; k < 2; k++) {
        const uint32_t element = cx->face_elements[2 * f->face + (uint32_t)k];
        if (element == GXB_NONE ? f->leaf[k] != GXB_NONE
                                : f->leaf[k] == GXB_NONE || cx->leaves[f->leaf[k]].element != element)
            return 0;
    }
    return 1;
}

/* Do the facet's points lie on its sides of all planes that divided what it is part of? */
static void gxbp_check_parting(gxbp_checker *c, uint32_t facet) {
    gxb_complex *cx = c->cx;
    uint32_t i, part = facet, up = c->facet_up[facet];
    for (; up != GXB_NONE && c->s->result == GX_OK; part = up, up = c->facet_up[up]) {
        const gxb_facet *f = &cx->facets[up];
        const int side = part == f->child ? 1 : -1;
        int off = 0;
        for (i = 0; i < c->count; i++) {
            const int sign = gxb_complex_side(cx, gxbp_edge_start(cx, c->edge[i]), f->loop) * side;
            gxbp_require_true(c->s, sign >= 0);
            off |= sign;
        }
        gxbp_require_true(c->s, off);
    }
}

/* Of each facet, what it is a part of */
static void gxbp_trace_facets(gxbp_checker *c) {
    uint32_t i, k;
    for (i = 0; i < c->cx->facet_count; i++) {
        c->facet_up[i] = GXB_NONE;
        c->facet_root[i] = i;
    }
    for (i = 0; i < c->cx->facet_count; i++) /* parts come behind what they are parts of */
        for (k = 0; k < 2 && c->cx->facets[i].child < GXB_UNLISTED; k++) {
            c->facet_up[c->cx->facets[i].child + k] = i;
            c->facet_root[c->cx->facets[i].child + k] = c->facet_root[i];
        }
}

static void gxbp_check_facets(gxbp_checker *c) {
    gxb_complex *cx = c->cx;
    uint32_t i;
    for (i = 0; i < cx->facet_count && c->s->result == GX_OK; i++) {
        const gxb_facet *f = &cx->facets[i], *half = f->child < GXB_UNLISTED ? &cx->facets[f->child] : f;
        gxbp_require_true(c->s, half[0].plane == f->plane && half[0].face == f->face &&
                                    (half == f || (half[1].plane == f->plane && half[1].face == f->face)));
        gxbp_require_true(c->s, f->face != GXB_NONE ? gxbp_is_in_face(c, i) : f->child != GXB_UNLISTED);
        if (f->child != GXB_NONE || c->s->result != GX_OK) continue;
        gxbp_require_true(c->s, gxbp_facet_is_between(cx, f));
        if (c->s->result == GX_OK && (f->loop_count > 0 || !gxbp_is_spent(cx, i))) gxbp_check_polygon(c, i);
        if (c->s->result == GX_OK && f->face == GXB_NONE) gxbp_check_parting(c, i);
    }
}

/* Collects the facets into which one was divided; those of a leaf's list must be its own, each listed once. */
static GXBP_COLD void gxbp_collect_facets(gxbp_checker *c, uint32_t facet, uint32_t leaf) {
    const gxb_facet *f = &c->cx->facets[facet];
    gxbp_require_true(c->s, f->child != GXB_UNLISTED);
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
        if (c->border[e ^ 1] == round)
            c->loose--;
        else
            c->loose++;
    }
}

/* --- mesh faces: their facets, if they are listed, cover them once, up to the parts of their mesh edges --- */

/* Are all parts of the signed edge on the border? Returns how many there are. */
static GXBP_COLD uint32_t gxbp_count_border(gxbp_checker *c, uint32_t signed_edge, uint32_t round) {
    const uint32_t child = c->cx->edges[signed_edge >> 1].child, back = signed_edge & 1;
    if (child < GXB_UNLISTED)
        return gxbp_count_border(c, child << 1 | back, round) + gxbp_count_border(c, (child + 1) << 1 | back, round);
    gxbp_require_true(c->s, c->border[signed_edge] == round && c->border[signed_edge ^ 1] != round);
    return 1;
}

/* Are all parts of the face and of its edges listed? They must be where an element is closed. */
static int gxbp_face_is_listed(gxbp_checker *c, uint32_t face, const uint32_t edges[3]) {
    const gxb_complex *cx = c->cx;
    const uint32_t root = cx->face_facet[face];
    int listed =
        cx->facets[root].child != GXB_UNLISTED && (cx->facets[root].loop_count > 0 || !gxbp_is_spent(cx, root));
    uint32_t j;
    for (j = 0; j < 3; j++)
        listed =
            listed && (cx->mesh_edge[edges[j]] == GXB_NONE || cx->edges[cx->mesh_edge[edges[j]]].child != GXB_UNLISTED);
    gxbp_require_true(c->s, listed || !(gxbp_is_closed(cx, cx->face_elements[2 * face]) ||
                                        gxbp_is_closed(cx, cx->face_elements[2 * face + 1])));
    return listed;
}

/* Element's face k: nodes a < b < c are its plane, and its border runs from a to b to c. */
static void gxbp_check_face(gxbp_checker *c, uint32_t element, uint32_t k) {
    gxb_complex *cx = c->cx;
    const uint32_t *node = cx->elements + 4 * (size_t)element, face = cx->element_faces[4 * (size_t)element + k],
                   root = cx->face_facet[face];
    uint32_t local[3], n[3], edge[3], i, j, parts = 0, round;
    const gxb_cplane *plane;
    if (root == GXB_NONE) return;
    plane = &cx->store.planes[cx->facets[root].plane];
    for (j = 0; j < 3; j++) n[j] = node[gxbp_face_nodes[k][j]];
    gxbp_sort3(n);
    for (j = 0; j < 3; j++)
        for (i = 0; i < 4; i++)
            if (node[i] == n[j]) local[j] = i;
    for (j = 0; j < 3; j++)
        edge[j] = cx->element_edges[6 * (size_t)element + gxbp_local_edge(local[j], local[(j + 1) % 3])];
    gxbp_require_true(c->s, c->facet_depth[root] == 0 && cx->facets[root].face == face && !plane->along_axis &&
                                memcmp(plane->def, n, sizeof n) == 0);
    if (!gxbp_face_is_listed(c, face, edge)) return;
    c->facets = c->loose = 0;
    round = ++c->round;
    gxbp_collect_facets(c, root, GXB_NONE);
    for (i = 0; i < c->facets && c->s->result == GX_OK; i++) gxbp_add_border(c, c->facet[i], 0, round);
    for (j = 0; j < 3 && c->s->result == GX_OK; j++) {
        const uint32_t first = cx->mesh_edge[edge[j]];
        gxbp_require_true(c->s, first != GXB_NONE);
        if (c->s->result == GX_OK) parts += gxbp_count_border(c, first << 1 | (j == 2 ? 1u : 0u), round);
    }
    gxbp_require_true(c->s, parts == c->loose);
}

/* --- the trees of the elements --- */

#define GXBP_UNSEEN (GXB_NONE - 1)

static void gxbp_hang(gxbp_checker *c, uint32_t reference, uint32_t up, uint32_t element, uint32_t depth) {
    const uint32_t index = reference >> 1, count = reference & 1 ? c->cx->tree_count : c->cx->leaf_count;
    uint32_t *from = reference & 1 ? c->node_up : c->leaf_up;
    gxbp_require_true(c->s, index < count && (from[index < count ? index : 0] == GXBP_UNSEEN ||
                                              (!(reference & 1) && gxbp_is_hollow(c->cx, index))));
    if (c->s->result != GX_OK) return;
    from[index] = up;
    if (!(reference & 1)) {
        gxbp_require_true(c->s, c->cx->leaves[index].element == element);
        return;
    }
    c->queue[c->hung++] = index;
    c->node_element[index] = element;
    c->node_depth[index] = depth;
    if (depth > GXBP_DEPTH) gxbp_require(c->s, GX_ERROR_LIMIT);
}

/* From the roots down: every node and leaf hangs somewhere, once unless it stands for several. */
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
        gxbp_require_true(c->s, n->plane < cx->store.plane_count && !cx->store.planes[n->plane].along_axis &&
                                    gxbp_below(n->facet, cx->facet_count));
        if (c->s->result == GX_OK && n->facet != GXB_NONE)
            gxbp_require_true(c->s, c->facet_depth[n->facet] == 0 && cx->facets[n->facet].face == GXB_NONE &&
                                        cx->facets[n->facet].plane == n->plane);
        for (k = 0; k < 2 && c->s->result == GX_OK; k++)
            gxbp_hang(c, n->child[k], 2 * node + k, c->node_element[node], c->node_depth[node] + 1);
    }
    gxbp_require_true(c->s, c->hung == cx->tree_count);
    for (i = 0; i < cx->leaf_count; i++) gxbp_require_true(c->s, c->leaf_up[i] != GXBP_UNSEEN);
}

/* --- leaves --- */

/* Do the leaf's points lie on one side of the plane (1: in front, -1: behind)? *off: one is not in it. */
static int gxbp_lies_beside(gxbp_checker *c, uint32_t plane, int side, int *off) {
    uint32_t i;
    *off = 0;
    gxbp_forget_signs(&c->cx->store, 0);
    for (i = 0; i < c->points; i++) {
        const int sign = gxbp_sign(&c->cx->store, c->point[i], plane, 0) * side;
        if (sign < 0) return 0;
        *off |= sign;
    }
    return 1;
}

/* Is the facet's plane that of a node above the leaf, which lies on its side as it does on the facet's? Is it a part of
   the node's facet, if that is known? */
static int gxbp_is_above(const gxbp_checker *c, uint32_t leaf, uint32_t facet) {
    const gxb_facet *f = &c->cx->facets[facet];
    const uint32_t side = f->leaf[0] == leaf ? 0 : 1;
    uint32_t up;
    for (up = c->leaf_up[leaf]; up != GXB_NONE; up = c->node_up[up >> 1]) {
        const gxb_node *n = &c->cx->nodes[up >> 1];
        if (n->plane == f->plane && (up & 1) == side) return n->facet == GXB_NONE || n->facet == c->facet_root[facet];
    }
    return 0;
}

static void gxbp_collect_points(gxbp_checker *c, uint32_t round) {
    uint32_t i;
    for (i = 0; i < c->count; i++) {
        const uint32_t point = gxbp_edge_start(c->cx, c->edge[i]);
        if (c->point_mark[point] == round) continue;
        c->point_mark[point] = round;
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
        gxbp_require_true(c->s, f->face != GXB_NONE || gxbp_is_above(c, leaf, c->facet[i]));
    }
    for (i = 0; i < 6; i++)
        gxbp_require_true(c->s, cx->mesh_edge[cx->element_edges[6 * (size_t)l.element + i]] != GXB_NONE);
    for (i = 0; i < 4 && c->s->result == GX_OK; i++) {
        const uint32_t face = cx->element_faces[4 * (size_t)l.element + i];
        gxbp_require_true(c->s, cx->face_facet[face] != GXB_NONE);
        if (c->s->result == GX_OK)
            gxbp_require_true(c->s, gxbp_lies_beside(c, gxbp_face_plane(cx, l.element, i),
                                                     cx->face_elements[2 * face] == l.element ? 1 : -1, &off));
    }
    for (up = c->leaf_up[leaf]; up != GXB_NONE && c->s->result == GX_OK; up = c->node_up[up >> 1])
        gxbp_require_true(c->s, gxbp_lies_beside(c, cx->nodes[up >> 1].plane, up & 1 ? -1 : 1, &off));
}

/* Both leaves of a facet list it, but for those of elements that nothing has opened. */
static void gxbp_check_leaves(gxbp_checker *c) {
    gxb_complex *cx = c->cx;
    uint32_t i, k;
    for (i = 0; i < cx->leaf_count && c->s->result == GX_OK; i++) {
        if (cx->leaves[i].facet_count > 0)
            gxbp_check_open_leaf(c, i);
        else if (!gxbp_is_hollow(cx, i))
            gxbp_require_true(c->s, cx->root[i] == 2 * i);
    }
    for (i = 0; i < cx->facet_count && c->s->result == GX_OK; i++)
        for (k = 0; k < 2; k++) {
            const gxb_facet *f = &cx->facets[i];
            if (f->child != GXB_NONE || f->leaf[k] == GXB_NONE || gxbp_is_hollow(cx, f->leaf[k])) continue;
            gxbp_require_true(c->s, cx->leaves[f->leaf[k]].facet_count > 0 ? c->facet_mark[2 * i + k] != 0
                                                                           : f->face != GXB_NONE);
        }
}

static void gxbp_run_checks(gxbp_checker *c) {
    gxb_complex *cx = c->cx;
    uint32_t i;
    gxbp_check_indices(cx, c->s);
    gxbp_check_trees(c->s, cx->edge_count > 0 ? &cx->edges->child : NULL, sizeof *cx->edges, cx->edge_count,
                     c->edge_depth);
    gxbp_check_trees(c->s, cx->facet_count > 0 ? &cx->facets->child : NULL, sizeof *cx->facets, cx->facet_count,
                     c->facet_depth);
    if (c->s->result == GX_OK) gxbp_trace_facets(c);
    if (c->s->result == GX_OK) gxbp_check_tree(c);
    if (c->s->result == GX_OK) gxbp_check_edges(cx, c->s, c->edge_depth);
    if (c->s->result == GX_OK) gxbp_check_facets(c);
    for (i = 0; i < 4 * cx->element_count && c->s->result == GX_OK; i++) gxbp_check_face(c, i / 4, i % 4);
    if (c->s->result == GX_OK) gxbp_check_leaves(c);
}

static GXBP_COLD void gxbp_check(gxb_complex *cx, gxb_stream *s) {
    const size_t e = cx->edge_count, f = cx->facet_count, n = cx->tree_count, l = cx->leaf_count;
    const size_t words = 7 * e + 6 * f + 2 * (size_t)cx->store.point_count + 4 * n + l + 1;
    gxbp_checker c;
    uint32_t *block;
    memset(&c, 0, sizeof c);
    if (words > SIZE_MAX / sizeof *block) {
        gxbp_require(s, GX_ERROR_LIMIT);
        return;
    }
    block = (uint32_t *)gxbp_allocate(&cx->store.allocator, words * sizeof *block);
    if (block == NULL) {
        gxbp_require(s, GX_ERROR_MEMORY);
        return;
    }
    memset(block, 0, words * sizeof *block);
    c.cx = cx;
    c.s = s;
    c.edge_mark = block;
    c.border = c.edge_mark + 2 * e;
    c.edge = c.border + 2 * e;
    c.corner = c.edge + e;
    c.edge_depth = c.corner + e;
    c.facet_mark = c.edge_depth + e;
    c.facet = c.facet_mark + 2 * f;
    c.facet_depth = c.facet + f;
    c.facet_up = c.facet_depth + f;
    c.facet_root = c.facet_up + f;
    c.node_depth = c.facet_root + f;
    c.node_up = c.node_depth + n;
    c.node_element = c.node_up + n;
    c.leaf_up = c.node_element + n;
    c.point = c.leaf_up + l;
    c.point_mark = c.point + cx->store.point_count;
    c.queue = c.point_mark + cx->store.point_count;
    gxbp_run_checks(&c);
    gxbp_release(&cx->store.allocator, block, words * sizeof *block);
}

/* >>load: a complex from bytes ------------------------------------------------------------------------------------- */
/* In: bytes. Out: a complex, checked unless the caller vouches for the bytes, in a transaction of its own. */

GXFEM_API GXBP_RARE gx_result gxb_complex_load(gxb_complex *cx, gxb_stream *s, int trusted) {
    uint32_t counts[GXBP_COUNTS], i;
    gxbp_pass_counts(cx, s, counts);
    if (s->result == GX_OK) gxbp_load_points(cx, s, counts[0]);
    if (s->result == GX_OK) gxbp_load_planes(cx, s, counts[1]);
    if (s->result == GX_OK) gxbp_place_points(cx, s);
    gxbp_pass_arrays(cx, s);
    if (s->result == GX_OK && !trusted) gxbp_check(cx, s);
    if (s->result != GX_OK) return s->result;
    gxbp_link_trees(cx);
    cx->pool_live = cx->pool_count;
    for (i = 0; i < cx->leaf_count; i++) cx->removed_count += cx->leaves[i].removed;
    gxb_complex_begin(cx);
    return GX_OK;
}

/* >>arrangement: what a Boolean holds ------------------------------------------------------------------------------ */
/* The types and the one struct of a Boolean. A source is an input triangle. Its triangulation consists of subtriangles.
   Everything below works on these arrays. See docs/KERNEL.md for the method. */

/* Labels of a subtriangle's edge form a list: the sources that meet the subtriangle's plane along it, and in flats also
 * edges of sources (half-edge | GXBP_EDGE_LABEL). */
#define GXBP_EDGE_LABEL ((uint32_t)1 << 31)
#define GXBP_LOOSE      UINT32_MAX       /* not constrained: no labels, may be replaced */
#define GXBP_BARE       (UINT32_MAX - 1) /* the end of a list of labels: a constrained edge */

enum { GXBP_LEAF = 8 }; /* triangles in a leaf of a box tree */

typedef struct gxbp_source { /* an input triangle */
    uint32_t point[3];
    /* the half-edge 3 s + k on the other side of edge k, GXB_NONE where there is not exactly one */
    uint32_t twin[3];
    uint32_t edge[3]; /* in crossings.edges; GXB_NONE: the edge has no record, so no inner points */
    uint32_t plane;   /* GXB_NONE until needed */
    uint32_t operand;
    uint32_t subtriangle; /* first of its subtriangles; of a flat: its root has them all */
    uint32_t segments;    /* list */
    uint32_t root, next;  /* flat: union-find parent, next member */
    uint32_t flags;
} gxbp_source;
enum {
    GXBP_DEGENERATE = 1,
    GXBP_DIRTY = 2,
    GXBP_DIVIDED = 4,
    GXBP_FLAT = 8,
    GXBP_REACHED = 16
};                       /* one of its subtriangles has a state: all have, or will soon */
enum { GXBP_FOLDS = 8 }; /* two bits of the flags for each edge from this one on, see gxbp_fold_beyond_filter */

typedef struct gxbp_subtriangle { /* a triangle of a source's triangulation; edge k from v[k] to v[k + 1] */
    uint32_t v[3], near[3], labels[3];
    uint32_t source; /* root of the flat; GXB_NONE: no longer in use */
    uint32_t next;
    uint32_t covers; /* in a flat: list of the sources that cover it */
    /* the state (winding numbers) in front of it; GXB_NONE: not known. Kept between evaluations */
    uint32_t state;
} gxbp_subtriangle;

typedef struct gxbp_vertex {   /* beside each point of the complex */
    uint32_t key[4];           /* kind and what defines it, see gxb_origin; half-edges and sources */
    uint32_t same;             /* union-find: points found to be equal */
    uint32_t stamp, hint;      /* a subtriangle around it in the triangulation at work */
    uint32_t head, head_stamp; /* see gxbp_chain_segments */
    uint32_t rim_place;        /* 3 i + k: point i of edge k of the source at work; GXB_NONE: it is none */
} gxbp_vertex;

typedef struct gxbp_link {
    uint32_t value, next;
} gxbp_link;
/* left: the sign of the label's plane to the left of p q, seen from the side to which the source's normal points; 0:
 * not known */
typedef struct gxbp_segment {
    uint32_t p, q, label, next;
    int32_t left;
} gxbp_segment;
/* The record of a surface's edge that something crosses or that borders on a divided source. first, count: its inner
   points in edge_points, in the half-edge's direction. rim: if the sources on its two sides are divided, the edges
   3 f + k of their subtriangles at its start, that on the half-edge's side first. */
typedef struct gxbp_surface_edge {
    uint32_t half_edge, first, count, rim[2];
} gxbp_surface_edge;
typedef struct gxbp_hit {
    uint32_t edge, point;
} gxbp_hit;
typedef struct gxbp_rim_vertex {
    uint32_t vertex, near, labels, made, dangling;
} gxbp_rim_vertex;
/* Coordinates / 16, rounded outward: see gxbp_float_below */
typedef struct gxbp_box {
    float low[3], high[3];
} gxbp_box;

/* Boxes of a leaf's triangles, by columns. An unused box meets nothing. */
typedef struct gxbp_leaf_boxes {
    float low[3][GXBP_LEAF], high[3][GXBP_LEAF];
} gxbp_leaf_boxes;

typedef struct gxbp_tree {  /* boxes over groups of GXBP_LEAF sources, then over pairs of boxes, up to one */
    uint32_t first, levels; /* of its boxes in gxb_boolean.boxes */
    uint32_t level[28];     /* first box of each level, from first */
    uint32_t size[28];
} gxbp_tree;

typedef struct gxbp_operand {
    uint32_t operation, rule;
    uint32_t simple;   /* vouched for, or found */
    uint32_t reached;  /* a subtriangle has got a state */
    uint32_t narrowed; /* the last intersection up to this operand, the first operand aside; 0: there is none */
    uint32_t removed;  /* it takes no part in results; 1 + the operands that were arranged when it was taken out */
    uint32_t source, source_count; /* none: it was taken out, and the arrangement was made anew without it */
    uint32_t bounds;               /* of its leaves in gxb_boolean.bounds */
    uint32_t *order;               /* sources in the order of the tree's leaves, in memory of its own */
    gxbp_tree tree;
} gxbp_operand;

/* The state that differs from another by one in an operand's winding number */
typedef struct gxbp_state_step {
    uint32_t from, operand, to;
    int32_t change;
} gxbp_state_step;
enum { GXBP_STEPS = 64 };

/* What the caller added: operands, their triangles and boxes. All of it lives as long as the Boolean. */
typedef struct gxbp_input {
    gxbp_source *sources;
    uint32_t source_count, source_capacity;
    gxbp_operand *operands;
    uint32_t operand_count, operand_capacity;
    uint32_t first; /* operand that is not removed; operand_count: there is none */
    /* of each operand's sources, in its tree's order */
    gxbp_leaf_boxes *bounds;
    uint32_t bound_count, bound_capacity;
    /* of trees */
    gxbp_box *boxes;
    uint32_t box_count, box_capacity;
    /* a box for each operand; a box for each of these leaves */
    gxbp_leaf_boxes *leaves, *groups;
    uint32_t leaf_count, leaf_capacity, group_count, group_capacity;
} gxbp_input;

/* How points are found again: by coordinates, by definition, by equality. Lives as long as the Boolean. */
typedef struct gxbp_points {
    gxbp_vertex *vertices; /* one beside each point of the store */
    uint32_t vertex_count, vertex_capacity;
    /* hash of points by coordinates or key */
    uint32_t *table;
    uint32_t table_size, table_used;
    uint32_t merged_count; /* points before it are old: earlier evaluations compared them with each other */
    /* the computed ones of these: runs, each in order along a direction. run: where each ends */
    struct gxbp_projected *projected;
    uint32_t projected_count, projected_capacity;
    uint32_t run[32], run_count;
    double reach; /* the largest of their errors */
    /* united 1: points were united since the last evaluation; renamed 1: an input vertex ever got another name */
    uint32_t united, renamed;
    /* old points and input vertices that got another name or definition since the last evaluation */
    uint32_t *dropped;
    uint32_t dropped_count, dropped_capacity;
} gxbp_points;

/* Where sources meet. Lives until an evaluation fails; hits and dirty sources are used up by each evaluation. Once the
 * dirty ones are divided, they are those that this evaluation divided, each flat by its root. */
typedef struct gxbp_crossings {
    gxbp_segment *segments;
    uint32_t segment_count, segment_capacity;
    gxbp_surface_edge *edges;
    uint32_t edge_count, edge_capacity;
    uint32_t *edge_points;
    uint32_t edge_point_count, edge_point_capacity;
    gxbp_hit *hits;
    uint32_t hit_count, hit_capacity;
    uint32_t *dirty;
    uint32_t dirty_count, dirty_capacity;
    uint32_t marks;        /* how often a source was found to meet something */
    uint32_t arranged;     /* operands that are in the arrangement */
    uint32_t segment_mark; /* segments before it are in the triangulations */
    uint32_t dead;         /* sources of operands that were taken out, and segments of these and by these */
} gxbp_crossings;

/* The triangulations of all sources. Lives until an evaluation fails. */
typedef struct gxbp_mesh {
    gxbp_subtriangle *subtriangles;
    uint32_t subtriangle_count, subtriangle_capacity;
    gxbp_link *links;
    uint32_t link_count, link_capacity;
    uint32_t stated; /* subtriangles before it have states, if they need one */
    /* subtriangles of the last evaluation that this one divided, removed or gave another state */
    uint32_t *changed;
    uint32_t changed_count, changed_capacity;
} gxbp_mesh;

/* A winding number that is not 0 */
typedef struct gxbp_operand_number {
    uint32_t operand;
    int32_t winding;
} gxbp_operand_number;
/* first, count: its numbers, by ascending operands. known: of how many operands inside takes account */
typedef struct gxbp_state {
    uint32_t first, count, hash, inside, known;
} gxbp_state;

/* States: vectors of winding numbers, of which most are 0. They live until an evaluation fails. */
typedef struct gxbp_winding {
    /* of all states; behind them the draft, a vector at work */
    gxbp_operand_number *numbers;
    uint32_t number_count, number_capacity, draft_count;
    gxbp_state *states;
    uint32_t state_count, state_capacity;
    /* hash of states; listed: how many are in it */
    uint32_t *table;
    uint32_t table_size, listed;
    /* for the caller's function: a vector with its zeros, which is 0 between calls */
    int32_t *vector;
    uint32_t vector_count, vector_capacity;
    gxbp_state_step steps[GXBP_STEPS]; /* the latest ones */
    uint32_t stated;                   /* operands that states count; 0: subtriangles have no states */
    uint32_t unreached;                /* operands of which no subtriangle has a state yet */
} gxbp_winding;

/* The result, its components and its defects. Each evaluation makes it anew. */
typedef struct gxbp_output {
    double *vertices; /* x 3 */
    uint32_t vertex_count, vertex_capacity;
    gxb_origin *origins;
    uint32_t origin_count, origin_capacity;
    uint32_t *points; /* of each vertex: its point */
    uint32_t point_count, point_capacity;
    uint32_t *triangles; /* x 3: vertices */
    uint32_t corner_count, corner_capacity;
    /* of each triangle */
    uint32_t *operands;
    uint32_t operand_count, operand_capacity;
    uint32_t *sources;
    uint32_t triangle_count, triangle_capacity;
    uint32_t *components;
    uint32_t component_count, component_capacity;
    uint32_t *subtriangles; /* 2 x subtriangle, + 1 where the triangle faces against its plane */
    uint32_t subtriangle_count, subtriangle_capacity;
    uint8_t *reversed;
    uint32_t reversed_count, reversed_capacity;
    /* of each component; sides: x operand */
    int8_t *sides;
    uint32_t side_count, side_capacity;
    double *volumes;
    uint32_t volume_count, volume_capacity;
    int32_t *eulers;
    uint32_t euler_count, euler_capacity;
    /* triangles */
    uint32_t *defects;
    uint32_t defect_count, defect_capacity;
    /* of half-edges, to mend: the surface is taken apart where it only touches itself */
    uint32_t *twins;
    uint32_t twin_count, twin_capacity;
    /* of each subtriangle before shown_count, what the last evaluation judged: see gxbp_judge_subtriangle */
    uint8_t *shown;
    uint32_t shown_count, shown_capacity;
    uint32_t judged;                   /* operands of that evaluation */
    int evaluated, measured, examined; /* 1: there is a result; its components, its defects are known */
    uint32_t mended_count;             /* defects that mending removed */
} gxbp_output;

/* What keeps a result in its place, see >>retained. Lives until an evaluation fails. */
typedef struct gxbp_kept {
    int valid; /* 1: the result is that of the evaluation before, with its triangles in the places below */
    int fine;  /* of its vertices */
    /* of 2 x subtriangle, + 1 where it faces against its plane: its triangle; GXB_NONE: there is none */
    uint32_t *places;
    uint32_t place_count, place_capacity;
    /* of each point: its vertex, or GXB_NONE */
    uint32_t *vertices;
    uint32_t vertex_count, vertex_capacity;
    /* of each vertex: corners of triangles there */
    uint32_t *uses;
    uint32_t use_count, use_capacity;
    /* vertices that no triangle has; triangles that have gone */
    uint32_t *spare;
    uint32_t spare_count, spare_capacity;
    uint32_t *holes;
    uint32_t hole_count, hole_capacity;
    /* vertices and triangles that the evaluation wrote, some repeatedly; as ranges, when requested */
    uint32_t *new_vertices, *new_triangles;
    uint32_t new_vertex_count, new_vertex_capacity, new_triangle_count, new_triangle_capacity;
    gxb_range *vertex_ranges, *triangle_ranges;
    uint32_t vertex_range_count, vertex_range_capacity, triangle_range_count, triangle_range_capacity;
} gxbp_kept;

/* What the caller chose. coarsen, mend and patch are NULL unless requested: only the setters name these functions. */
typedef struct gxbp_options {
    uint32_t fine, triangulation;
    void (*coarsen)(gxb_boolean *b), (*mend)(gxb_boolean *b), (*patch)(gxb_boolean *b);
    int (*inside)(void *user, const int32_t *winding, size_t operand_count);
    void *user;
    gx_jobs jobs;
} gxbp_options;

/* Memory: where it comes from, and how much of it there is. */
typedef struct gxbp_budget {
    gx_allocator outer; /* the caller's */
    size_t limit, used, peak;
    unsigned char *arena; /* behind the struct: small cases need nothing else */
    size_t arena_size, arena_used;
    uint64_t allocations;
    int over_limit;
} gxbp_budget;

/* Scratch. No array keeps anything from one step to the next; each has one meaning. */
typedef struct gxbp_work {
    /* subtriangles to visit, in a flat or while states spread */
    uint32_t *visits;
    uint32_t visit_count, visit_capacity;
    /* subtriangles that a constrained edge crosses, to be replaced */
    uint32_t *crossed;
    uint32_t crossed_count, crossed_capacity;
    /* operands whose boxes meet a box */
    uint32_t *found;
    uint32_t found_count, found_capacity;
    /* subtriangles that got a state, or lost one: neighbours are still to come */
    uint32_t *pending;
    uint32_t pending_count, pending_capacity;
    /* memory that gxbp_borrow lends */
    uint32_t *room;
    uint32_t room_count, room_capacity;
    /* points of the edge at work */
    uint32_t *ordered;
    uint32_t ordered_count, ordered_capacity;
    /* new segments of the source at work, x 3, see gxbp_chain_segments */
    uint32_t *segment_ends;
    uint32_t segment_end_count, segment_end_capacity;
    /* rims of the crossed subtriangles, to the right and to the left of the edge */
    gxbp_rim_vertex *rights;
    uint32_t right_count, right_capacity;
    gxbp_rim_vertex *lefts;
    uint32_t left_count, left_capacity;
    /* >>coarse: the polygon of a fan, and the fan's triangles, to be replaced */
    struct gxbp_fan_vertex *fan_vertices;
    uint32_t fan_vertex_count, fan_vertex_capacity;
    uint32_t *fan_triangles;
    uint32_t fan_triangle_count, fan_triangle_capacity;
    /* >>encounters: pairs of boxes, x 2; pairs of sources */
    uint32_t *box_pairs;
    uint32_t box_pair_count, box_pair_capacity;
    struct gxbp_encounter *encounters;
    uint32_t encounter_count, encounter_capacity;
    uint32_t plane;             /* of the triangulation at work */
    uint32_t stamp, head_stamp; /* of vertices in the triangulation at work, of those with heads */
} gxbp_work;

struct gxb_boolean { /* what is used most comes first: its addresses are short */
    gxbp_input in;
    gxbp_mesh mesh;
    gxbp_points points;
    gx_result error; /* the first one of the call at work */
    gxb_store store; /* points, planes and exact numbers */
    gxbp_budget budget;
    gxbp_options options;
    gxbp_crossings crossings;
    gxbp_work work;
    gxbp_winding winding;
    gxbp_output out;
    gxbp_kept kept;
};

/* >>arena: memory of a Boolean ------------------------------------------------------------------------------------- */
/* In: sizes. Out: memory, counted against the limit; small amounts come from the arena behind the struct. Touches the
   budget, the growing arrays and the first error of an evaluation. */

#define GXBP_ARENA ((size_t)1 << 16)

static size_t gxbp_whole_words(size_t size) { return (size + 15) & ~(size_t)15; }

/* From the arena; NULL: it has no such room. */
static void *gxbp_take(gxb_boolean *b, size_t size) {
    unsigned char *memory = b->budget.arena + b->budget.arena_used;
    if (size > b->budget.arena_size - b->budget.arena_used) return NULL;
    b->budget.arena_used += gxbp_whole_words(size);
    return memory;
}

static void *gxbp_count_allocate(void *user, size_t size) {
    gxb_boolean *b = (gxb_boolean *)user;
    void *memory = gxbp_take(b, size);
    if (memory != NULL) return memory;
    if (b->budget.limit != 0 && (size > b->budget.limit || b->budget.used > b->budget.limit - size)) {
        b->budget.over_limit = 1;
        return NULL;
    }
    memory = gxbp_allocate(&b->budget.outer, size);
    if (memory == NULL) return NULL;
    b->budget.allocations++;
    b->budget.used += size;
    if (b->budget.used > b->budget.peak) b->budget.peak = b->budget.used;
    return memory;
}

static void gxbp_count_release(void *user, void *memory, size_t size) {
    gxb_boolean *b = (gxb_boolean *)user;
    const unsigned char *m = (const unsigned char *)memory;
    if (m >= b->budget.arena && m < b->budget.arena + b->budget.arena_size) {
        const size_t from = (size_t)(m - b->budget.arena);
        /* other memory of the arena is not reused */
        if (from + gxbp_whole_words(size) == b->budget.arena_used) b->budget.arena_used = from;
        return;
    }
    b->budget.used -= size;
    gxbp_release(&b->budget.outer, memory, size);
}

/* Memory that the caller's allocator can grow. A block of the arena is copied instead. */
static void *gxbp_count_reallocate(void *user, void *old, size_t size, size_t larger) {
    gxb_boolean *b = (gxb_boolean *)user;
    const unsigned char *m = (const unsigned char *)old;
    const int in_arena = m >= b->budget.arena && m < b->budget.arena + b->budget.arena_size;
    const size_t more = larger - size;
    void *memory;
    if (!in_arena && b->budget.limit != 0 && (more > b->budget.limit || b->budget.used > b->budget.limit - more)) {
        b->budget.over_limit = 1;
        return NULL;
    }
    memory = in_arena ? gxbp_count_allocate(user, larger) : gxbp_reallocate(&b->budget.outer, old, size, size, larger);
    if (memory == NULL) return NULL;
    if (in_arena) {
        memcpy(memory, old, size);
        gxbp_count_release(user, old, size);
        return memory;
    }
    b->budget.allocations++;
    b->budget.used += more;
    if (b->budget.used > b->budget.peak) b->budget.peak = b->budget.used;
    return memory;
}

/* The first error of an evaluation stays in b->error; later steps see it and do nothing. */
static GXBP_COLD int gxbp_stop(gxb_boolean *b, gx_result result) {
    if (b->error == GX_OK) b->error = result == GX_ERROR_MEMORY && b->budget.over_limit ? GX_ERROR_LIMIT : result;
    return 0;
}

/* The first items of an array come from the arena, so that small cases allocate nothing. */
static GXBP_APART int gxbp_room(gxb_boolean *b, void *array, uint32_t count, uint32_t *capacity, size_t item,
                                size_t extra) {
    const size_t first = GXBP_SPARE((size_t)0), least = *capacity == 0 && extra < first ? first : extra,
                 room = gxbp_room_for(least);
    void *memory = *capacity == 0 && least < GXBP_ARENA ? gxbp_take(b, room * item) : NULL;
    gx_result result;
    if (memory != NULL) {
        memcpy(array, &memory, sizeof memory);
        *capacity = (uint32_t)room;
        return 1;
    }
    result = gxbp_reserve(&b->store.allocator, array, count, capacity, item, least);
    return result == GX_OK ? 1 : gxbp_stop(b, result);
}

#define GXBP_ROOM(b, array, counter, extra)                                                                            \
    ((b)->counter##_count + (size_t)(extra) <= (b)->counter##_capacity ||                                              \
     gxbp_room(b, &(b)->array, (b)->counter##_count, &(b)->counter##_capacity, sizeof *(b)->array, extra))

/* Memory that is valid until the next call of this function; NULL: there is none. It is kept, so that the next borrower
 * gets pages that have been touched. */
static GXBP_APART void *gxbp_borrow(gxb_boolean *b, size_t bytes) {
    b->work.room_count = 0;
    return GXBP_ROOM(b, work.room, work.room, bytes / sizeof *b->work.room + 1) ? b->work.room : NULL;
}

static void gxbp_push_visit(gxb_boolean *b, uint32_t f) {
    if (GXBP_ROOM(b, work.visits, work.visit, 1)) b->work.visits[b->work.visit_count++] = f;
}

static uint32_t gxbp_new_link(gxb_boolean *b, uint32_t value, uint32_t next) {
    if (!GXBP_ROOM(b, mesh.links, mesh.link, 1)) return next;
    b->mesh.links[b->mesh.link_count].value = value;
    b->mesh.links[b->mesh.link_count].next = next;
    return b->mesh.link_count++;
}

/* >>parts: loops whose parts may run on the host's threads --------------------------------------------------------- */
/* In: a loop, cut into parts whose number does not depend on threads, and a task for each part. Out: all tasks done. A
   task writes only what no other task of the loop reads or writes. It allocates nothing and keeps nothing in caches, so
   it decides by filters only; what they leave open is done after the loop, by the caller, in the loop's order. */

#ifndef GXBP_PART
#define GXBP_PART 2048u /* items of a part: some ten microseconds; fewer in tests/test_threads.c */
#endif

static int gxbp_has_jobs(const gxb_boolean *b) { return b->options.jobs.parallel_for != NULL; }

static size_t gxbp_part_count(size_t items) { return (items + GXBP_PART - 1) / GXBP_PART; }

/* Items from first to before *end: those of a part */
static uint32_t gxbp_part_first(size_t part, uint32_t items, uint32_t *end) {
    const uint32_t first = (uint32_t)(part * GXBP_PART);
    *end = items - first < GXBP_PART ? items : first + GXBP_PART;
    return first;
}

static void gxbp_each_part(const gxb_boolean *b, size_t count, void (*task)(void *context, size_t part),
                           void *context) {
    size_t i;
    if (gxbp_has_jobs(b) && count > 1)
        b->options.jobs.parallel_for(b->options.jobs.user, count, task, context);
    else
        for (i = 0; i < count; i++) task(context, i);
}

/* >>keys: points found by coordinates or by definition ------------------------------------------------------------- */
/* In: coordinates of an input vertex, or the kind and the objects that define a point. Out: the point, new or known.
   Touches the points, their hash table and the union-find of points found to be equal. */

static uint32_t gxbp_mix(uint32_t hash, uint64_t value) {
    uint64_t x = (value ^ hash * UINT64_C(0xff51afd7ed558ccd)) * UINT64_C(0x9e3779b97f4a7c15);
    return (uint32_t)(x >> 32) ^ (uint32_t)x;
}

static GXBP_APART uint32_t gxbp_hash_key(const uint32_t key[4]) {
    return gxbp_mix(gxbp_mix(key[0], (uint64_t)key[1] << 32 | key[2]), key[3]);
}

static GXBP_APART uint32_t gxbp_hash_place(const double x[3]) {
    return gxbp_mix(gxbp_mix(gxbp_mix(0, gxbp_bits(x[0])), gxbp_bits(x[1])), gxbp_bits(x[2]));
}

static uint32_t gxbp_hash_point(const gxb_boolean *b, uint32_t point) {
    const uint32_t *key = b->points.vertices[point].key;
    return key[0] == GXB_FROM_VERTEX ? gxbp_hash_place(b->store.points[point].ball.x) : gxbp_hash_key(key);
}

/* Replaces a table by a larger one. The caller enters its items again. */
static GXBP_COLD int gxbp_renew_table(gxb_boolean *b, uint32_t **table, uint32_t *size, uint32_t larger) {
    uint32_t *renewed = (uint32_t *)gxbp_allocate(&b->store.allocator, (size_t)larger * sizeof **table);
    if (renewed == NULL) return gxbp_stop(b, GX_ERROR_MEMORY);
    gxbp_release(&b->store.allocator, *table, (size_t)*size * sizeof **table);
    *table = renewed;
    *size = larger;
    return 1;
}

enum { GXBP_AHEAD = 8 }; /* points whose places in the table are fetched while others are entered; a power of two */

/* Enters the first count points, except those of frames, in the table. */
static GXBP_RARE void gxbp_list_points(gxb_boolean *b, uint32_t count) {
    const uint32_t last = b->points.table_size - 1;
    uint32_t places[GXBP_AHEAD], i, k, ahead = 0;
    memset(b->points.table, 0xff, (size_t)b->points.table_size * sizeof *b->points.table);
    for (i = b->points.table_used = 0; i < count; i++) {
        for (; ahead < count && ahead < i + GXBP_AHEAD; ahead++) {
            places[ahead % GXBP_AHEAD] = gxbp_hash_point(b, ahead) & last;
            GXBP_FETCH(&b->points.table[places[ahead % GXBP_AHEAD]]);
        }
        if (b->points.vertices[i].key[0] == GXB_FROM_VERTEX && b->points.vertices[i].key[1] == GXB_NONE) continue;
        for (k = places[i % GXBP_AHEAD]; b->points.table[k] != GXB_NONE; k = (k + 1) & last) {}
        b->points.table[k] = i;
        b->points.table_used++;
    }
}

static GXBP_COLD int gxbp_grow_table(gxb_boolean *b, uint32_t extra) {
    uint32_t size = b->points.table_size == 0 ? 64 : b->points.table_size;
    while ((uint64_t)size < ((uint64_t)b->points.table_used + extra) * 3 && size < (uint32_t)1 << 31) size *= 2;
    if (!gxbp_renew_table(b, &b->points.table, &b->points.table_size, size)) return 0;
    gxbp_list_points(b, b->points.vertex_count);
    return 1;
}

/* Makes room in the table for extra points. */
static int gxbp_table_room(gxb_boolean *b, uint32_t extra) {
    return ((uint64_t)b->points.table_used + extra) * 2 <= b->points.table_size || gxbp_grow_table(b, extra);
}

/* A point without coordinates yet. */
static inline uint32_t gxbp_new_vertex(gxb_boolean *b, uint32_t kind, uint32_t p, uint32_t q, uint32_t r) {
    uint32_t id;
    gx_result result;
    gxbp_vertex *v;
    if (!GXBP_ROOM(b, points.vertices, points.vertex, 1)) return GXB_NONE;
    result = gxbp_new_point(&b->store, &id);
    if (result != GX_OK) {
        gxbp_stop(b, result);
        return GXB_NONE;
    }
    v = &b->points.vertices[b->points.vertex_count++];
    memset(v, 0, sizeof *v);
    v->key[0] = kind;
    v->key[1] = p;
    v->key[2] = q;
    v->key[3] = r;
    v->same = id;
    return id;
}

/* Follows names to the last one, and halves the path for later calls. */
static GXBP_APART uint32_t gxbp_find_same(gxbp_vertex *v, uint32_t point) {
    while (v[point].same != point) {
        v[point].same = v[v[point].same].same;
        point = v[point].same;
    }
    return point;
}

static uint32_t gxbp_same(gxb_boolean *b, uint32_t point) {
    return b->points.vertices[point].same == point ? point : gxbp_find_same(b->points.vertices, point);
}

/* Two names of one point: the first stays. It takes the second's definition if that is an input vertex. */
static GXBP_RARE void gxbp_unite(gxb_boolean *b, uint32_t keep, uint32_t drop) {
    gxb_cpoint *p = &b->store.points[keep];
    const gxb_cpoint *q = &b->store.points[drop];
    if (keep == drop) return;
    b->points.vertices[drop].same = keep;
    b->points.united = 1;
    if (q->kind == GXB_EXPLICIT && q->def[0] == drop) b->points.renamed = 1;
    if ((drop < b->points.merged_count || (q->kind == GXB_EXPLICIT && q->def[0] == drop)) &&
        GXBP_ROOM(b, points.dropped, points.dropped, 1))
        b->points.dropped[b->points.dropped_count++] = drop;
    if (p->kind == GXB_EXPLICIT || q->kind != GXB_EXPLICIT) return;
    p->kind = GXB_EXPLICIT;
    p->ball = q->ball;
    p->exact = NULL;
    p->def[0] = q->def[0];
    if (keep < b->points.merged_count && GXBP_ROOM(b, points.dropped, points.dropped, 1))
        b->points.dropped[b->points.dropped_count++] = keep;
}

/* Defines a point as the intersection of a line and a plane or of three planes. A ball that is too large to filter by
 * is replaced by one from exact coordinates, whose ratio has a relative error below 2^-50. */
static void gxbp_place_point(gxb_boolean *b, uint32_t point, uint32_t kind, uint32_t p, uint32_t q, uint32_t r) {
    gxb_cpoint *c = &b->store.points[point];
    c->kind = (uint8_t)kind;
    c->def[0] = p;
    c->def[1] = q;
    c->def[2] = r;
    gxbp_definition_ball(&b->store, kind, c->def, &c->ball);
    if (c->ball.error > gxbp_power(-30) * gxbp_max3(c->ball.x)) {
        gxbp_vec store;
        const gxb_num *x = gxbp_exact_cpoint(&b->store, point, &store);
        double error = 0;
        int k;
        b->store.exact_calls++;
        for (k = 0; k < 3; k++) {
            c->ball.x[k] = gxb_num_ratio(&x[k], &x[3]);
            error = gxbp_max(error, gxbp_abs(c->ball.x[k]));
        }
        c->ball.error = error * gxbp_power(-49) + GXBP_TINY;
    }
}

/* Finds or makes the entry of a point with this key. *is_new: it is new and has no place yet. */
static uint32_t gxbp_keyed_point(gxb_boolean *b, uint32_t kind, uint32_t p, uint32_t q, uint32_t r, int *is_new) {
    uint32_t key[4], k, id;
    *is_new = 0;
    if (!gxbp_table_room(b, 1)) return GXB_NONE;
    key[0] = kind;
    key[1] = p;
    key[2] = q;
    key[3] = r;
    for (k = gxbp_hash_key(key) & (b->points.table_size - 1); b->points.table[k] != GXB_NONE;
         k = (k + 1) & (b->points.table_size - 1))
        if (memcmp(b->points.vertices[b->points.table[k]].key, key, sizeof key) == 0)
            return gxbp_same(b, b->points.table[k]);
    id = gxbp_new_vertex(b, kind, p, q, r);
    if (id == GXB_NONE) return GXB_NONE;
    b->points.table[k] = id;
    b->points.table_used++;
    *is_new = 1;
    return id;
}

/* >>boxes: a tree of boxes for each operand ------------------------------------------------------------------------ */
/* In: the corners of an operand's sources. Out: the sources along a Z-order curve, and boxes around groups of them.
   Every box contains its triangles. Touches the boxes and leaf boxes only. */

static const double *gxbp_corner_of(const gxb_boolean *b, uint32_t s, int k) {
    return b->store.points[b->in.sources[s].point[k]].ball.x;
}

/* Coordinates are below 2^128 and a float can't hold all of these, a sixteenth it can. A float's relative error is at
   most 2^-23; what is flushed to zero is far below 2^-120. */
static float gxbp_float_below(double x) {
    return (float)(x * 0.0625 - (gxbp_abs(x) * gxbp_power(-26) + gxbp_power(-120)));
}
static float gxbp_float_above(double x) {
    return (float)(x * 0.0625 + (gxbp_abs(x) * gxbp_power(-26) + gxbp_power(-120)));
}

static void gxbp_box_join(gxbp_box *a, const gxbp_box *c) {
    int k;
    for (k = 0; k < 3; k++) {
        a->low[k] = c->low[k] < a->low[k] ? c->low[k] : a->low[k];
        a->high[k] = c->high[k] > a->high[k] ? c->high[k] : a->high[k];
    }
}

static void gxbp_extent(const gxb_boolean *b, uint32_t s, double low[3], double high[3]) {
    const double *p = gxbp_corner_of(b, s, 0), *q = gxbp_corner_of(b, s, 1), *r = gxbp_corner_of(b, s, 2);
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = gxbp_min(gxbp_min(p[k], q[k]), r[k]);
        high[k] = gxbp_max(gxbp_max(p[k], q[k]), r[k]);
    }
}

/* An operand as the caller gave it, of which nothing is checked but its indices; scale takes it into the frame. */
typedef struct gxbp_raw {
    const gxb_operand *operand;
    double scale;
} gxbp_raw;

/* Corner k of triangle t. The scale is a power of two: exact, as in gxbp_scale, but for the sign of a zero. */
static inline void gxbp_given_corner(const gxbp_raw *given, size_t t, size_t k, double x[3]) {
    const double *p = given->operand->vertices + 3 * (size_t)given->operand->triangles[3 * t + k];
    x[0] = p[0] * given->scale;
    x[1] = p[1] * given->scale;
    x[2] = p[2] * given->scale;
}

static inline gxbp_box gxbp_box_of(const gxbp_raw *given, size_t t) {
    gxbp_box box;
    double p[3], q[3], r[3];
    int k;
    gxbp_given_corner(given, t, 0, p);
    gxbp_given_corner(given, t, 1, q);
    gxbp_given_corner(given, t, 2, r);
    for (k = 0; k < 3; k++) {
        box.low[k] = gxbp_float_below(gxbp_min(gxbp_min(p[k], q[k]), r[k]));
        box.high[k] = gxbp_float_above(gxbp_max(gxbp_max(p[k], q[k]), r[k]));
    }
    return box;
}

static int gxbp_box_meets(const gxbp_box *a, const gxbp_box *c) {
    return (a->low[0] <= c->high[0]) & (c->low[0] <= a->high[0]) & (a->low[1] <= c->high[1]) &
           (c->low[1] <= a->high[1]) & (a->low[2] <= c->high[2]) &
           (c->low[2] <= a->high[2]); /* without branches, which would be mispredicted */
}

/* Ten bits with two zeros after each */
static uint32_t gxbp_spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

static uint32_t gxbp_lattice(double t) { return t > 0 ? t < 1023 ? (uint32_t)t : 1023 : 0; }

/* Sorts the sources along a Z-order curve by their first corners; work: two words of 64 bits each. */
static GXBP_APART void gxbp_sort_sources(const gxbp_operand *o, const gxbp_raw *given, uint64_t *work) {
    uint64_t *from = work, *to = work + o->source_count, *swap;
    double low[3], high[3], scale[3], x[3];
    uint32_t i, pass, k;
    gxbp_given_corner(given, 0, 0, low);
    memcpy(high, low, sizeof high);
    for (i = 1; i < o->source_count; i++) {
        gxbp_given_corner(given, i, 0, x);
        for (k = 0; k < 3; k++) {
            low[k] = gxbp_min(x[k], low[k]);
            high[k] = gxbp_max(x[k], high[k]);
        }
    }
    for (k = 0; k < 3; k++) scale[k] = high[k] > low[k] ? 1023 / (high[k] - low[k]) : 0;
    for (i = 0; i < o->source_count; i++) {
        uint32_t key = 0;
        gxbp_given_corner(given, i, 0, x);
        for (k = 0; k < 3; k++) key |= gxbp_spread(gxbp_lattice((x[k] - low[k]) * scale[k])) << k;
        from[i] = (uint64_t)key << 32 | (o->source + i);
    }
    for (pass = 32; pass < 62; pass += 10) {
        uint32_t count[1025];
        memset(count, 0, sizeof count);
        for (i = 0; i < o->source_count; i++) count[1 + (from[i] >> pass & 1023)]++;
        for (i = 1; i < 1025; i++) count[i] += count[i - 1];
        for (i = 0; i < o->source_count; i++) to[count[from[i] >> pass & 1023]++] = from[i];
        swap = from;
        from = to;
        to = swap;
    }
    for (i = 0; i < o->source_count; i++) o->order[i] = (uint32_t)from[i];
}

static void gxbp_clear_leaf(gxbp_leaf_boxes *leaf) {
    uint32_t x, k;
    for (x = 0; x < GXBP_LEAF; x++)
        for (k = 0; k < 3; k++) {
            leaf->low[k][x] = (float)gxbp_power(126);
            leaf->high[k][x] = -leaf->low[k][x];
        }
}

/* Widens box x of a leaf. */
static void gxbp_widen_leaf(gxbp_leaf_boxes *leaf, uint32_t x, const gxbp_box *box) {
    uint32_t k;
    for (k = 0; k < 3; k++) {
        if (box->low[k] < leaf->low[k][x]) leaf->low[k][x] = box->low[k];
        if (box->high[k] > leaf->high[k][x]) leaf->high[k][x] = box->high[k];
    }
}

/* Boxes of leaf i's sources, and around them */
static void gxbp_fill_leaf(gxb_boolean *b, const gxbp_operand *o, const gxbp_raw *given, uint32_t i) {
    gxbp_leaf_boxes *leaf = &b->in.bounds[o->bounds + i];
    gxbp_box *around = &b->in.boxes[o->tree.first + i];
    uint32_t x, k;
    for (x = 0; x < GXBP_LEAF; x++) {
        gxbp_box box;
        if (i * GXBP_LEAF + x < o->source_count) {
            box = gxbp_box_of(given, o->order[i * GXBP_LEAF + x] - o->source);
            if (x == 0)
                *around = box;
            else
                gxbp_box_join(around, &box);
        } else
            for (k = 0; k < 3; k++) {
                box.low[k] = (float)gxbp_power(126);
                box.high[k] = -box.low[k];
            }
        for (k = 0; k < 3; k++) {
            leaf->low[k][x] = box.low[k];
            leaf->high[k][x] = box.high[k];
        }
    }
}

/* Fills the tree. keys: two words of 64 bits for each source */
static GXBP_APART void gxbp_fill_tree(gxb_boolean *b, const gxbp_operand *o, const gxbp_raw *given, uint64_t *keys) {
    const gxbp_tree *t = &o->tree;
    uint32_t i, l;
    if (o->source_count > 4 * GXBP_LEAF)
        gxbp_sort_sources(o, given, keys);
    else
        for (i = 0; i < o->source_count; i++) o->order[i] = o->source + i;
    for (i = 0; i < t->size[0]; i++) gxbp_fill_leaf(b, o, given, i);
    for (l = 1; l < t->levels; l++)
        for (i = 0; i < t->size[l - 1]; i++) {
            gxbp_box *box = &b->in.boxes[t->first + t->level[l] + i / 2];
            const gxbp_box *child = &b->in.boxes[t->first + t->level[l - 1] + i];
            if (i % 2 == 0)
                *box = *child;
            else
                gxbp_box_join(box, child);
        }
}

/* A tree without boxes yet. Room for the leaves' is there. */
static gx_result gxbp_make_tree(gxb_boolean *b, gxbp_operand *o) {
    gxbp_tree *t = &o->tree;
    uint32_t size = (o->source_count + GXBP_LEAF - 1) / GXBP_LEAF, total = 0;
    o->order = (uint32_t *)gxbp_allocate(&b->store.allocator, o->source_count * sizeof *o->order);
    if (o->order == NULL) return GX_ERROR_MEMORY;
    o->bounds = b->in.bound_count;
    b->in.bound_count += size;
    for (t->levels = 0;; size = (size + 1) / 2) {
        t->level[t->levels] = total;
        t->size[t->levels++] = size;
        total += size;
        if (size == 1) break;
    }
    t->first = b->in.box_count;
    if (!GXBP_ROOM(b, in.boxes, in.box, total)) return b->error;
    b->in.box_count += total;
    return GX_OK;
}

static const gxbp_box *gxbp_operand_box(const gxb_boolean *b, uint32_t i) {
    const gxbp_tree *t = &b->in.operands[i].tree;
    return &b->in.boxes[t->first + t->level[t->levels - 1]];
}

/* Room for the boxes of one more operand */
static int gxbp_operand_box_room(gxb_boolean *b) {
    return GXBP_ROOM(b, in.leaves, in.leaf, 1) && GXBP_ROOM(b, in.groups, in.group, 1);
}

/* Lists the box of operand i, the last one. */
static void gxbp_list_operand_box(gxb_boolean *b, uint32_t i) {
    const uint32_t leaf = i / GXBP_LEAF;
    if (i % GXBP_LEAF == 0) gxbp_clear_leaf(&b->in.leaves[b->in.leaf_count++]);
    if (i % (GXBP_LEAF * GXBP_LEAF) == 0) gxbp_clear_leaf(&b->in.groups[b->in.group_count++]);
    gxbp_widen_leaf(&b->in.leaves[leaf], i % GXBP_LEAF, gxbp_operand_box(b, i));
    gxbp_widen_leaf(&b->in.groups[leaf / GXBP_LEAF], leaf % GXBP_LEAF, gxbp_operand_box(b, i));
}

/* Tests which boxes of a leaf meet a box, without branches, so that compilers vectorise it. Returns 0 if none does.
 */
static uint32_t gxbp_test_leaf(const gxbp_leaf_boxes *leaf, const gxbp_box *box, uint32_t meets[GXBP_LEAF]) {
    uint32_t x, any = 0;
    for (x = 0; x < GXBP_LEAF; x++)
        meets[x] = (uint32_t)((leaf->low[0][x] <= box->high[0]) & (box->low[0] <= leaf->high[0][x]) &
                              (leaf->low[1][x] <= box->high[1]) & (box->low[1] <= leaf->high[1][x]) &
                              (leaf->low[2][x] <= box->high[2]) & (box->low[2] <= leaf->high[2][x]));
    for (x = 0; x < GXBP_LEAF; x++) any |= meets[x];
    return any;
}

static gxbp_box gxbp_leaf_box(const gxbp_leaf_boxes *leaf, uint32_t x) {
    gxbp_box box;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        box.low[k] = leaf->low[k][x];
        box.high[k] = leaf->high[k][x];
    }
    return box;
}

/* Lists the operands from first to before end whose boxes meet a box in b->work.found, in ascending order. */
static GXBP_APART void gxbp_find_operands(gxb_boolean *b, const gxbp_box *box, uint32_t first, uint32_t end) {
    uint32_t i, j, x, y, groups[GXBP_LEAF], leaf[GXBP_LEAF];
    b->work.found_count = 0;
    if (!GXBP_ROOM(b, work.found, work.found, end)) return;
    for (i = first / (GXBP_LEAF * GXBP_LEAF); i * GXBP_LEAF * GXBP_LEAF < end; i++) {
        if (!gxbp_test_leaf(&b->in.groups[i], box, groups)) continue;
        for (x = 0; x < GXBP_LEAF && (i * GXBP_LEAF + x) * GXBP_LEAF < end; x++) {
            if (!groups[x] || !gxbp_test_leaf(&b->in.leaves[i * GXBP_LEAF + x], box, leaf)) continue;
            for (y = 0; y < GXBP_LEAF; y++) {
                j = (i * GXBP_LEAF + x) * GXBP_LEAF + y;
                if (leaf[y] && j >= first && j < end) b->work.found[b->work.found_count++] = j;
            }
        }
    }
}

static int gxbp_boxes_meet(const gxb_boolean *b, const gxbp_tree *s, uint32_t l, uint32_t i, const gxbp_tree *t,
                           uint32_t m, uint32_t j) {
    return gxbp_box_meets(&b->in.boxes[s->first + s->level[l] + i], &b->in.boxes[t->first + t->level[m] + j]);
}

/* >>operands: reading an operand ----------------------------------------------------------------------------------- */
/* In: a caller's surface, checked. Out: its points, sources with their neighbours across edges, one subtriangle for
   each source, and the box tree. On an error the caller shortens the arrays again. */

/* The input's coordinates in the frame: multiplied by 2^shift, exact. */
static gx_result gxbp_scale(const gxb_boolean *b, const double x[3], double y[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        const int e = gxbp_exponent_bits(x[k]);
        if (e == 0x7ff) return GX_ERROR_NOT_FINITE;
        y[k] = 0;
        if (gxbp_is_zero(x[k])) continue;
        if (e == 0 || e - 1023 + b->store.shift < -128 || e - 1023 + b->store.shift > 127) return GX_ERROR_RANGE;
        y[k] = gxbp_double(gxbp_bits(x[k]) + ((uint64_t)(int64_t)b->store.shift << 52));
    }
    return GX_OK;
}

#define GXBP_LARGEST 200 /* the first operand's largest coordinate is 2^+-this: cubes of 2^128 times it are finite */

/* Scenes of ordinary size keep their scale. *bad: the vertex with the largest coordinate if that is out of range. */
static gx_result gxbp_choose_scale(gxb_boolean *b, const gxb_operand *operand, size_t *bad) {
    int largest = -2000;
    size_t i, vertex = 0;
    for (i = 0; i < 3 * operand->vertex_count; i++) {
        const int e = gxbp_exponent_bits(operand->vertices[i]) - 1023;
        if (e > largest && e < 1024 && !gxbp_is_zero(operand->vertices[i])) {
            largest = e;
            vertex = i / 3;
        }
    }
    b->store.shift = largest == -2000 || (largest >= -60 && largest <= 60) ? 0 : -largest;
    if (largest == -2000 || (largest >= -GXBP_LARGEST && largest <= GXBP_LARGEST)) return GX_OK;
    *bad = vertex;
    return GX_ERROR_RANGE;
}

/* hash: of its place */
static uint32_t gxbp_input_point(gxb_boolean *b, const double y[3], uint32_t hash, uint32_t operand, uint32_t index) {
    uint32_t k, id;
    for (k = hash & (b->points.table_size - 1); b->points.table[k] != GXB_NONE;
         k = (k + 1) & (b->points.table_size - 1)) {
        const uint32_t p = b->points.table[k];
        if (b->points.vertices[p].key[0] == GXB_FROM_VERTEX && memcmp(b->store.points[p].ball.x, y, 3 * sizeof *y) == 0)
            return p;
    }
    id = gxbp_new_vertex(b, GXB_FROM_VERTEX, operand, index, 0);
    if (id == GXB_NONE) return GXB_NONE;
    gxbp_ball_explicit(&b->store.points[id].ball, y);
    b->store.points[id].def[0] = id;
    b->points.table[k] = id;
    b->points.table_used++;
    return id;
}

static uint32_t gxbp_next_edge(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static uint32_t gxbp_last_edge(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/* An edge from vertex p to a later vertex, stored with the later one: how often half-edges pass it forth (from p) and
 * back, and the last ones that do. next: the later end of another edge of p. first: list of the half-edges between the
 * vertex itself and later ones. */
typedef struct gxbp_passage {
    uint32_t first, p, next, forth, back, there, home;
} gxbp_passage;

/* Half-edges in lists of their earlier vertices, in ascending order; next: of each half-edge. */
static void gxbp_list_half_edges(const uint32_t *triangles, uint32_t count, gxbp_passage *passages, uint32_t *next) {
    uint32_t h, k, i;
    for (h = 3 * count; h > 0;) {
        h -= 3;
        for (k = 0, i = 2; k < 3; i = k++) {
            const uint32_t p = triangles[h + i], q = triangles[h + k];
            gxbp_passage *list = &passages[p < q ? p : q];
            next[h + i] = p == q ? GXB_NONE : list->first;
            if (p != q) list->first = h + i;
        }
    }
}

/* Turns the half-edges in p's list into passages of its edges. Returns the later end of the last edge. */
static uint32_t gxbp_take_passages(const uint32_t *triangles, gxbp_passage *passages, uint32_t p, uint32_t *twin) {
    uint32_t h, next, last = GXB_NONE;
    for (h = passages[p].first; h != GXB_NONE; h = next) {
        const uint32_t from = triangles[h], q = from == p ? triangles[gxbp_next_edge(h)] : from;
        gxbp_passage *e = &passages[q];
        next = twin[h];
        twin[h] = GXB_NONE;
        if (e->p != p) {
            e->p = p;
            e->forth = e->back = 0;
            e->next = last;
            last = q;
        }
        if (from == p) {
            e->forth++;
            e->there = h;
        } else {
            e->back++;
            e->home = h;
        }
    }
    return last;
}

/* the most vertices for a table of all pairs; the most triangles whose half-edges fit a byte */
enum { GXBP_FEW = 32, GXBP_FEW_TRIANGLES = 80 };

/* Twins for few vertices. 0: some edge has not exactly one half-edge in each direction. */
static int gxbp_find_few_twins(const uint32_t *triangles, uint32_t count, uint32_t vertex_count, uint32_t *twin) {
    uint8_t half_edge[GXBP_FEW * GXBP_FEW];
    uint32_t h, k, i, alone = 3 * count;
    memset(half_edge, 0xff, (size_t)vertex_count * vertex_count);
    for (h = 0; h < 3 * count; h += 3)
        for (k = 0, i = 2; k < 3; i = k++) {
            const uint32_t p = triangles[h + i], q = triangles[h + k], back = half_edge[q * vertex_count + p];
            if (p == q || half_edge[p * vertex_count + q] != 0xff) return 0;
            half_edge[p * vertex_count + q] = (uint8_t)(h + i);
            if (back == 0xff) continue;
            twin[h + i] = back;
            twin[back] = h + i;
            alone -= 2;
        }
    return alone == 0;
}

/* Words of room that gxbp_find_twins works in */
static size_t gxbp_twin_room(size_t vertex_count) { return vertex_count * (sizeof(gxbp_passage) / sizeof(uint32_t)); }

/* Finds the twin of each half-edge; GXB_NONE where an edge has not exactly one half-edge in each direction. *open: a
 * half-edge whose edge is passed more often in its direction than in the other; GXB_NONE: the surface is closed. */
static void gxbp_find_twins(const uint32_t *triangles, size_t count, uint32_t vertex_count, uint32_t *twin,
                            uint32_t *open, uint32_t *room) {
    gxbp_passage *passages = (gxbp_passage *)(void *)room;
    uint32_t p, q, odd;
    *open = GXB_NONE;
    if (vertex_count <= GXBP_FEW && count <= GXBP_FEW_TRIANGLES &&
        gxbp_find_few_twins(triangles, (uint32_t)count, vertex_count, twin))
        return;
    for (p = 0; p < vertex_count; p++) passages[p].first = passages[p].p = GXB_NONE;
    gxbp_list_half_edges(triangles, (uint32_t)count, passages, twin);
    for (p = 0; p < vertex_count; p++) {
        odd = GXB_NONE;
        for (q = gxbp_take_passages(triangles, passages, p, twin); q != GXB_NONE; q = passages[q].next) {
            const gxbp_passage *e = &passages[q];
            if (e->forth == 1 && e->back == 1) {
                twin[e->there] = e->home;
                twin[e->home] = e->there;
            } else if (e->forth != e->back)
                odd = e->forth > e->back ? e->there : e->home;
        }
        if (*open == GXB_NONE) *open = odd;
    }
}

/* Half-edges listed by the vertex that they leave, with the vertex in which they end. */
typedef struct gxbp_exit {
    uint32_t half_edge, to;
} gxbp_exit;
typedef struct gxbp_exits {
    gxbp_exit *list;
    uint32_t *first;
    size_t bytes;
} gxbp_exits;

static GXBP_COLD int gxbp_list_exits(gxb_boolean *b, const uint32_t *triangles, size_t count, uint32_t vertex_count,
                                     gxbp_exits *exits) {
    uint32_t h;
    exits->bytes = 3 * count * sizeof *exits->list + ((size_t)vertex_count + 1) * sizeof *exits->first;
    exits->list = (gxbp_exit *)gxbp_allocate(&b->store.allocator, exits->bytes);
    if (exits->list == NULL) return gxbp_stop(b, GX_ERROR_MEMORY);
    exits->first = (uint32_t *)(void *)(exits->list + 3 * count);
    memset(exits->first, 0, ((size_t)vertex_count + 1) * sizeof *exits->first);
    for (h = 0; h < 3 * count; h++) exits->first[triangles[h]]++;
    for (h = 1; h <= vertex_count; h++) exits->first[h] += exits->first[h - 1];
    for (h = (uint32_t)(3 * count); h > 0;) {
        gxbp_exit *e = &exits->list[--exits->first[triangles[--h]]];
        e->half_edge = h;
        e->to = triangles[gxbp_next_edge(h)];
    }
    return 1;
}

static void gxbp_drop_exits(gxb_boolean *b, gxbp_exits *exits) {
    gxbp_release(&b->store.allocator, exits->list, exits->bytes);
}

static GXBP_COLD int gxbp_has_area_exactly(const double *p, const double *q, const double *r) {
    const double *x[3];
    gxb_plane plane;
    gxbp_large n;
    int sign[3];
    x[0] = p;
    x[1] = q;
    x[2] = r;
    if (gxbp_normal_short(x, sign)) return sign[0] != 0 || sign[1] != 0 || sign[2] != 0;
    gxb_plane_init(&plane, p, q, r);
    gxbp_large_init(&n);
    gxbp_plane_exact(n.c, &plane);
    return n.c[0].sign != 0 || n.c[1].sign != 0 || n.c[2].sign != 0;
}

/* Errors of the components: see gxbp_cross_size. */
static int gxbp_has_area(const double *p, const double *q, const double *r) {
    double a[3], c[3], m, size;
    int k, i = 1, j = 2;
    for (k = 0; k < 3; k++) {
        a[k] = gxbp_fence(q[k] - p[k]);
        c[k] = gxbp_fence(r[k] - p[k]);
    }
    for (k = 0; k < 3; i = j, j = k++) {
        m = gxbp_cross_size(a, c, i, j, &size);
        if (gxbp_abs(m) > 32 * GXBP_U * size + GXBP_TINY) return 1;
    }
    return gxbp_has_area_exactly(p, q, r);
}

/* Makes a source of one subtriangle, number first. */
static inline void gxbp_make_whole(gxb_boolean *b, uint32_t s, uint32_t first) {
    gxbp_source *t = &b->in.sources[s];
    gxbp_subtriangle *f = &b->mesh.subtriangles[first];
    int k;
    for (k = 0; k < 3; k++) {
        t->edge[k] = GXB_NONE;
        f->v[k] = b->points.renamed ? gxbp_same(b, t->point[k]) : t->point[k];
        f->near[k] = GXB_NONE;
        f->labels[k] = GXBP_BARE;
    }
    t->segments = t->next = GXB_NONE;
    t->root = s;
    f->source = t->flags & GXBP_DEGENERATE ? GXB_NONE : s;
    f->next = f->covers = f->state = GXB_NONE;
    t->subtriangle = first;
}

/* A triangle without area is nobody's neighbour: those of a part. */
static GXBP_RARE void gxbp_forget_degenerate(gxb_boolean *b, gxbp_operand *o, size_t part) {
    uint32_t end, i = gxbp_part_first(part, o->source_count, &end), k;
    for (; i < end; i++) {
        gxbp_source *t = &b->in.sources[o->source + i];
        if (!(t->flags & GXBP_DEGENERATE)) continue;
        for (k = 0; k < 3; k++) {
            if (t->twin[k] != GXB_NONE) b->in.sources[t->twin[k] / 3].twin[t->twin[k] % 3] = GXB_NONE;
            t->twin[k] = GXB_NONE;
        }
        o->simple = 0;
    }
}

/* points and local: room for vertex_count; local triangles and twins: 3 per triangle. *distinct: no two vertices are at
 * one place, local is i. */
static gx_result gxbp_read_points(gxb_boolean *b, const gxb_operand *o, uint32_t *points, uint32_t *local,
                                  int *distinct, size_t *bad) {
    double places[GXBP_AHEAD][3];
    uint32_t hashes[GXBP_AHEAD];
    size_t i, ahead = 0;
    *distinct = 1;
    for (i = 0; i < o->vertex_count; i++) {
        gxbp_vertex *v;
        for (; ahead < o->vertex_count && ahead < i + GXBP_AHEAD; ahead++) { /* fetched while others are entered */
            const gx_result result = gxbp_scale(b, o->vertices + 3 * ahead, places[ahead % GXBP_AHEAD]);
            if (result != GX_OK) {
                *bad = ahead;
                return result;
            }
            hashes[ahead % GXBP_AHEAD] = gxbp_hash_place(places[ahead % GXBP_AHEAD]);
            GXBP_FETCH(&b->points.table[hashes[ahead % GXBP_AHEAD] & (b->points.table_size - 1)]);
        }
        points[i] =
            gxbp_input_point(b, places[i % GXBP_AHEAD], hashes[i % GXBP_AHEAD], b->in.operand_count, (uint32_t)i);
        if (points[i] == GXB_NONE) return b->error;
        v = &b->points.vertices[points[i]]; /* vertices at one place are one: the first of them */
        if (v->head >= i || points[v->head] != points[i]) v->head = (uint32_t)i;
        local[i] = v->head;
        *distinct &= v->head == i;
    }
    return GX_OK;
}

/* An operand that is being read, and the memory of its stages */
typedef struct gxbp_reading {
    gxb_boolean *b;
    gxbp_raw given;
    gxbp_operand *added;
    uint64_t *keys;                 /* two for each triangle, to sort them */
    uint32_t *points, *local;       /* of each vertex, see gxbp_read_points */
    uint32_t *joined, *twin, *room; /* 3 words for each triangle; the same; gxbp_twin_room. Once twins are found,
                                       joined has the number of triangles without area in each part */
    uint32_t subtriangle, open;     /* the first subtriangle; a half-edge at the rim, or GXB_NONE */
    int distinct;
    gx_result result;
    size_t bad;
} gxbp_reading;

/* The sources of one part, each with one subtriangle. Twins have been found, so joined is free. */
static void gxbp_fill_sources(void *context, size_t part) {
    const gxbp_reading *r = (const gxbp_reading *)context;
    gxb_boolean *b = r->b;
    const gxb_cpoint *x = b->store.points;
    uint32_t end, h = gxbp_part_first(part, r->added->source_count, &end), degenerate = 0, k;
    for (; h < end; h++) {
        const uint32_t s = r->added->source + h;
        gxbp_source *t = &b->in.sources[s];
        for (k = 0; k < 3; k++) {
            const uint32_t twin = r->twin[3 * h + k];
            t->point[k] = r->points[r->given.operand->triangles[3 * h + k]];
            t->twin[k] = twin == GXB_NONE ? GXB_NONE : twin + 3 * r->added->source;
        }
        t->plane = GXB_NONE;
        t->operand = b->in.operand_count;
        t->flags = gxbp_has_area(x[t->point[0]].ball.x, x[t->point[1]].ball.x, x[t->point[2]].ball.x)
                     ? 0
                     : (uint32_t)GXBP_DEGENERATE;
        degenerate += t->flags != 0;
        gxbp_make_whole(b, s, r->subtriangle + h);
    }
    r->joined[part] = degenerate;
}

static void gxbp_pair_half_edges(gxbp_reading *r, const uint32_t *triangles) {
    const gxb_operand *o = r->given.operand;
    gxbp_find_twins(triangles, o->triangle_count, (uint32_t)o->vertex_count, r->twin, &r->open, r->room);
}

/* Stages that need nothing of each other: the tree, which takes as long as the others together, so it comes first;
   points; half-edges, as if no two vertices were at one place. What is wrong with a vertex is found by the second. */
enum { GXBP_READ_TREE, GXBP_READ_POINTS, GXBP_READ_HALF_EDGES, GXBP_READ_STAGES };

static void gxbp_read_stage(void *context, size_t stage) {
    gxbp_reading *r = (gxbp_reading *)context;
    if (stage == GXBP_READ_TREE)
        gxbp_fill_tree(r->b, r->added, &r->given, r->keys);
    else if (stage == GXBP_READ_POINTS)
        r->result = gxbp_read_points(r->b, r->given.operand, r->points, r->local, &r->distinct, &r->bad);
    else
        gxbp_pair_half_edges(r, r->given.operand->triangles);
}

static GXBP_APART gx_result gxbp_read_triangles(gxbp_reading *r) {
    gxb_boolean *b = r->b;
    const gxb_operand *o = r->given.operand;
    const size_t parts = gxbp_part_count(o->triangle_count);
    const int together = gxbp_has_jobs(b) && parts > 1;
    size_t h;
    if (together)
        gxbp_each_part(b, GXBP_READ_STAGES, gxbp_read_stage, r);
    else
        gxbp_read_stage(r, GXBP_READ_POINTS);
    if (r->result != GX_OK) return r->result;
    if (!r->distinct) {
        for (h = 0; h < 3 * o->triangle_count; h++) r->joined[h] = r->local[o->triangles[h]];
        gxbp_pair_half_edges(r, r->joined);
    } else if (!together)
        gxbp_read_stage(r, GXBP_READ_HALF_EDGES);
    if (r->open != GXB_NONE && o->operation != GXB_SPLIT) {
        r->bad = r->open / 3;
        return GX_ERROR_NOT_CLOSED;
    }
    if (b->points.renamed) /* points' names are looked up, which shortens the ways to them */
        for (h = 0; h < parts; h++) gxbp_fill_sources(r, h);
    else
        gxbp_each_part(b, parts, gxbp_fill_sources, r);
    b->in.source_count += (uint32_t)o->triangle_count;
    b->mesh.subtriangle_count += (uint32_t)o->triangle_count;
    for (h = 0; h < parts; h++)
        if (r->joined[h] > 0) gxbp_forget_degenerate(b, r->added, h);
    if (!together) gxbp_read_stage(r, GXBP_READ_TREE);
    return GX_OK;
}

/* Lends memory to the stages. The keys come last if stages follow each other, where twins are no longer needed. */
static gx_result gxbp_begin_reading(gxb_boolean *b, const gxb_operand *o, gxbp_operand *added, gxbp_reading *r) {
    const size_t triangles = o->triangle_count, vertices = o->vertex_count,
                 apart = gxbp_has_jobs(b) && gxbp_part_count(triangles) > 1 ? 4 * triangles : 0;
    uint32_t *work =
        (uint32_t *)gxbp_borrow(b, (apart + 2 * vertices + 6 * triangles + gxbp_twin_room(vertices)) * sizeof *work);
    if (work == NULL) return b->error;
    memset(r, 0, sizeof *r);
    r->b = b;
    r->given.operand = o;
    r->given.scale = gxbp_power(b->store.shift);
    r->added = added;
    r->keys = (uint64_t *)(void *)work;
    r->points = work + apart;
    r->local = r->points + vertices;
    r->joined = r->local + vertices;
    r->twin = r->joined + 3 * triangles;
    r->room = r->twin + 3 * triangles;
    r->subtriangle = b->mesh.subtriangle_count;
    r->bad = SIZE_MAX;
    return GX_OK;
}

/* The first operand also reserves room for a second one of its size: with some thirds more requested, gxbp_reserve adds
 * half of the request. The second one then moves no large array. Unused room is never touched. */
static size_t gxbp_presize(const gxb_boolean *b, size_t count, size_t thirds) {
    return b->in.operand_count > 0 ? count : count + thirds * count / 3;
}

static gx_result gxbp_operand_room(gxb_boolean *b, const gxb_operand *o) {
    const size_t sources = gxbp_presize(b, o->triangle_count, 1), subtriangles = gxbp_presize(b, o->triangle_count, 3),
                 points = gxbp_presize(b, o->vertex_count, 3);
    const size_t leaves = gxbp_presize(b, (o->triangle_count + GXBP_LEAF - 1) / GXBP_LEAF, 1);
    if (!GXBP_ROOM(b, in.operands, in.operand, 1) || !gxbp_operand_box_room(b) ||
        !GXBP_ROOM(b, in.sources, in.source, sources) || !GXBP_ROOM(b, in.bounds, in.bound, leaves) ||
        !GXBP_ROOM(b, mesh.subtriangles, mesh.subtriangle, subtriangles) ||
        !GXBP_ROOM(b, points.vertices, points.vertex, points) ||
        !gxbp_table_room(b, (uint32_t)gxbp_presize(b, o->vertex_count, 1)))
        return b->error;
    return GXBP_RESERVE(&b->store.allocator, &b->store, points, point, points);
}

static GXBP_APART gx_result gxbp_append_operand(gxb_boolean *b, const gxb_operand *o, size_t *bad) {
    gxbp_operand *added;
    gxbp_reading reading;
    gx_result result = gxbp_operand_room(b, o);
    if (result != GX_OK) return result;
    reading.bad = SIZE_MAX;
    added = &b->in.operands[b->in.operand_count];
    memset(added, 0, sizeof *added);
    added->operation = o->operation;
    added->rule = o->rule;
    added->simple = o->simple;
    added->source = b->in.source_count;
    added->source_count = (uint32_t)o->triangle_count;
    result = gxbp_begin_reading(b, o, added, &reading);
    if (result == GX_OK) result = gxbp_make_tree(b, added);
    if (result == GX_OK) result = gxbp_read_triangles(&reading);
    if (result != GX_OK) {
        *bad = reading.bad;
        gxbp_release(&b->store.allocator, added->order, o->triangle_count * sizeof *added->order);
        return result;
    }
    gxbp_list_operand_box(b, b->in.operand_count++);
    return GX_OK;
}

/* >>sides: planes of sources; records of where they meet ----------------------------------------------------------- */
/* In: sources and points. Out: sides of planes and folds, decided by the filter, by definition or exactly; planes, made
   when needed; segments, and points on edges. Touches planes, segments, edges, hits and the list of dirty sources. */

/* Decides what the filter leaves open: first by definition, then by exact arithmetic. */
static GXBP_APART int gxbp_point_side_beyond_filter(gxb_boolean *b, uint32_t point, uint32_t plane) {
    gxb_store *store = &b->store;
    const gxb_cpoint *p = &store->points[point];
    uint32_t def[3];
    memcpy(def, p->def, sizeof def);
    if (p->kind == GXB_EXPLICIT) point = def[0];
    if (gxbp_incident(store, p->kind, def, point, plane)) return 0;
    if (p->kind == GXB_THREE_PLANES && gxbp_incident_by_line(store, def, plane)) return 0;
    return gxbp_exact_sign(store, p->kind, def, point, plane);
}

/* The side of a plane */
static int gxbp_point_side(gxb_boolean *b, uint32_t point, uint32_t plane) {
    double bound;
    const double value = gxbp_filter_side(&b->store.points[point].ball, &b->store.planes[plane].filter, &bound);
    b->store.filter_calls++;
    if (value > bound) return 1;
    return value < -bound ? -1 : gxbp_point_side_beyond_filter(b, point, plane);
}

/* Orientation of three input points in a triangle's plane. */
static int gxbp_flat_turn(const gxb_boolean *b, uint32_t plane, const double *p, const double *q, const double *r) {
    const gxb_cplane *f = &b->store.planes[plane];
    const uint32_t i = (f->axis + 1u) % 3, j = (f->axis + 2u) % 3;
    double a[2], c[2], d[2];
    a[0] = p[i];
    a[1] = p[j];
    c[0] = q[i];
    c[1] = q[j];
    d[0] = r[i];
    d[1] = r[j];
    return gxb_orient2d(a, c, d) * f->axis_sign;
}

/* A fold that the filter leaves open is stored with both triangles at the edge, since both need it. */
static GXBP_APART int gxbp_fold_beyond_filter(gxb_boolean *b, uint32_t half_edge, uint32_t twin) {
    gxbp_source *s = &b->in.sources[half_edge / 3], *t = &b->in.sources[twin / 3];
    const uint32_t mine = GXBP_FOLDS + 2 * (half_edge % 3), other = GXBP_FOLDS + 2 * (twin % 3);
    uint32_t fold = s->flags >> mine & 3; /* 0: not known, else 2 more than it is */
    if (fold == 0) {
        fold = (uint32_t)(gxbp_point_side_beyond_filter(b, t->point[(twin % 3 + 2) % 3], s->plane) + 2);
        s->flags |= fold << mine;
        t->flags |= fold << other;
    }
    return (int)fold - 2;
}

/* The fold of the surface at a half-edge, whose triangle has a plane, and its twin, edge k of s. 1: towards the front;
   each triangle's far corner lies in front of the other. -1: towards the back. */
static inline int gxbp_fold(gxb_boolean *b, uint32_t half_edge, uint32_t s, uint32_t k) {
    const uint32_t plane = b->in.sources[half_edge / 3].plane, corner = b->in.sources[s].point[k == 0 ? 2 : k - 1];
    double bound, value;
    if (b->in.sources[s].plane == plane) return 0;
    value = gxbp_filter_side(&b->store.points[corner].ball, &b->store.planes[plane].filter, &bound);
    b->store.filter_calls++;
    if (value > bound) return 1;
    return value < -bound ? -1 : gxbp_fold_beyond_filter(b, half_edge, 3 * s + k);
}

/* A triangle that lies in the plane of a neighbour and faces the same way shares its plane. Points on both are then
 * known to be in it. */
static int gxbp_share_plane(gxb_boolean *b, uint32_t s) {
    uint32_t k;
    for (k = 0; k < 3; k++) {
        const uint32_t twin = b->in.sources[s].twin[k],
                       plane = twin == GXB_NONE ? GXB_NONE : b->in.sources[twin / 3].plane;
        if (plane == GXB_NONE || gxbp_fold(b, twin, s, k) != 0 ||
            gxbp_flat_turn(b, plane, gxbp_corner_of(b, s, 0), gxbp_corner_of(b, s, 1), gxbp_corner_of(b, s, 2)) <= 0)
            continue;
        b->in.sources[s].plane = plane;
        return 1;
    }
    return 0;
}

static GXBP_APART int gxbp_find_plane(gxb_boolean *b, uint32_t s) {
    gxbp_source *t = &b->in.sources[s];
    gx_result result;
    if (gxbp_share_plane(b, s)) return 1;
    result = gxbp_new_plane(&b->store, t->point[0], t->point[1], t->point[2], 0, &t->plane);
    if (result != GX_OK) {
        t->plane = GXB_NONE;
        return gxbp_stop(b, result);
    }
    gxbp_plane_axis(&b->store, t->plane);
    return 1;
}

static int gxbp_need_plane(gxb_boolean *b, uint32_t s) {
    return b->in.sources[s].plane != GXB_NONE || gxbp_find_plane(b, s);
}

static GXBP_APART void gxbp_list_dirty(gxb_boolean *b, uint32_t s) {
    if (!GXBP_ROOM(b, crossings.dirty, crossings.dirty, 1)) return;
    b->in.sources[s].flags |= GXBP_DIRTY;
    b->crossings.dirty[b->crossings.dirty_count++] = s;
}

static void gxbp_mark_dirty(gxb_boolean *b, uint32_t s) {
    b->crossings.marks++;
    if (!(b->in.sources[s].flags & GXBP_DIRTY)) gxbp_list_dirty(b, s);
}

/* A segment (a point, if p is q) in which a triangle (label) meets a source. */
static void gxbp_add_segment(gxb_boolean *b, uint32_t s, uint32_t p, uint32_t q, uint32_t label, int left) {
    gxbp_segment *segment;
    if (!GXBP_ROOM(b, crossings.segments, crossings.segment, 1)) return;
    segment = &b->crossings.segments[b->crossings.segment_count];
    segment->p = p;
    segment->q = q;
    segment->label = label;
    segment->next = b->in.sources[s].segments;
    segment->left = left;
    b->in.sources[s].segments = b->crossings.segment_count++;
    gxbp_mark_dirty(b, s);
}

/* The half-edge by which an edge is named: the lower of the two. */
static uint32_t gxbp_edge_name(const gxb_boolean *b, uint32_t s, int k) {
    const uint32_t h = 3 * s + (uint32_t)k, twin = b->in.sources[s].twin[k];
    return twin < h ? twin : h;
}

static GXBP_APART uint32_t gxbp_new_surface_edge(gxb_boolean *b, uint32_t s, int k) {
    const uint32_t twin = b->in.sources[s].twin[k];
    gxbp_surface_edge *e;
    if (!GXBP_ROOM(b, crossings.edges, crossings.edge, 1)) return GXB_NONE;
    e = &b->crossings.edges[b->crossings.edge_count];
    e->half_edge = gxbp_edge_name(b, s, k);
    e->first = e->count = 0;
    e->rim[0] = e->rim[1] = GXB_NONE;
    b->in.sources[s].edge[k] = b->crossings.edge_count;
    if (twin != GXB_NONE) b->in.sources[twin / 3].edge[twin % 3] = b->crossings.edge_count;
    return b->crossings.edge_count++;
}

/* The record of an edge; GXB_NONE: no memory */
static inline uint32_t gxbp_need_surface_edge(gxb_boolean *b, uint32_t s, int k) {
    return b->in.sources[s].edge[k] != GXB_NONE ? b->in.sources[s].edge[k] : gxbp_new_surface_edge(b, s, k);
}

/* A point inside an edge. */
static void gxbp_hit_edge(gxb_boolean *b, uint32_t s, int k, uint32_t point) {
    const uint32_t twin = b->in.sources[s].twin[k], edge = gxbp_need_surface_edge(b, s, k);
    if (edge == GXB_NONE || !GXBP_ROOM(b, crossings.hits, crossings.hit, 1)) return;
    b->crossings.hits[b->crossings.hit_count].edge = edge;
    b->crossings.hits[b->crossings.hit_count++].point = point;
    gxbp_mark_dirty(b, s);
    if (twin != GXB_NONE) gxbp_mark_dirty(b, twin / 3);
}

/* The side of a source's corner. Each point caches two answers; slot selects the one to use. */
static int gxbp_corner_side(gxb_boolean *b, uint32_t s, int k, uint32_t plane, int slot) {
    const uint32_t point = b->in.sources[s].point[k];
    gxb_cpoint *p = &b->store.points[point];
    if (p->stamp[slot] != plane + 1) {
        p->sign[slot] = (int8_t)(b->in.sources[s].plane == plane ? 0 : gxbp_point_side(b, point, plane));
        p->stamp[slot] = plane + 1;
    }
    return p->sign[slot];
}

static void gxbp_sides(gxb_boolean *b, uint32_t s, uint32_t plane, int slot, int side[3]) {
    int k;
    for (k = 0; k < 3; k++) side[k] = gxbp_corner_side(b, s, k, plane, slot);
}

static int gxbp_all_on_one_side(const int side[3]) { return side[0] != 0 && side[0] == side[1] && side[0] == side[2]; }

/* >>meet: where two triangles meet --------------------------------------------------------------------------------- */
/* In: pairs of sources whose boxes overlap. Out: the points, segments and flats in which they meet. Every decision is a
   predicate of input points. Touches what >>keys and >>sides offer, and the lists of flats. */

/* Where a point of a triangle's plane lies against the triangle: outside, at a corner, inside an edge (the other of the
   two is -1), or inside (both are -1). */
typedef struct gxbp_placement {
    int outside, edge, corner;
} gxbp_placement;

/* By the point's sides of the three edges, positive inside. */
static gxbp_placement gxbp_locate_by_signs(const int sign[3]) {
    gxbp_placement place = {0, -1, -1};
    int k;
    for (k = 0; k < 3; k++)
        if (sign[k] < 0) place.outside = 1;
    for (k = 0; k < 3 && !place.outside; k++) {
        if (sign[k] != 0) continue;
        if (sign[(k + 1) % 3] == 0)
            place.corner = (k + 1) % 3;
        else if (sign[(k + 2) % 3] != 0)
            place.edge = k;
    }
    return place;
}

static gxbp_placement gxbp_locate_corner(const gxb_boolean *b, const double *x, uint32_t s) {
    int sign[3], k;
    for (k = 0; k < 3; k++)
        sign[k] =
            gxbp_flat_turn(b, b->in.sources[s].plane, gxbp_corner_of(b, s, k), gxbp_corner_of(b, s, (k + 1) % 3), x);
    return gxbp_locate_by_signs(sign);
}

/* Where the line from p to q crosses the triangle's plane. side: p's side of it; q is on the other. The signs are those
   of gxb_orient3d of an edge with p and q, with the same bounds. Edges share differences and products. */
static GXBP_COLD gxbp_placement gxbp_locate_crossing(gxb_boolean *b, const double *p, const double *q, int side,
                                                     uint32_t s) {
    const double *x[4];
    double d[3], c[3][3], m[3][3], size[3][3];
    int sign[3], k, i;
    for (i = 0; i < 3; i++) d[i] = gxbp_fence(p[i] - q[i]);
    for (k = 0; k < 3; k++) {
        x[0] = gxbp_corner_of(b, s, k);
        for (i = 0; i < 3; i++) c[k][i] = gxbp_fence(x[0][i] - q[i]);
        gxbp_cross_sizes(m[k], size[k], c[k], d);
    }
    for (k = 0; k < 3; k++) {
        const double *a = c[k], *n = m[(k + 1) % 3], *z = size[(k + 1) % 3];
        const double bound =
            32 * GXBP_U * (gxbp_abs(a[0]) * z[0] + gxbp_abs(a[1]) * z[1] + gxbp_abs(a[2]) * z[2]) + GXBP_TINY;
        sign[k] = side * gxbp_filter_sign(a[0] * n[0] + a[1] * n[1] + a[2] * n[2], bound);
        b->store.filter_calls++;
        if (sign[k] == 0) {
            b->store.exact_calls++;
            x[0] = gxbp_corner_of(b, s, k);
            x[1] = gxbp_corner_of(b, s, (k + 1) % 3);
            x[2] = p;
            x[3] = q;
            sign[k] = side * gxbp_orient3d_exact(x);
        }
        if (sign[k] < 0) break;
    }
    for (k++; k < 3; k++) sign[k] = 1;
    return gxbp_locate_by_signs(sign);
}

/* The points in which two triangles meet, as they are found; at most two are different. left: gxbp_segment.left of the
 * first triangle, from point 0 to 1. */
typedef struct gxbp_meeting {
    uint32_t point[8];
    int count, left;
} gxbp_meeting;

static void gxbp_found(gxb_boolean *b, gxbp_meeting *m, uint32_t point) {
    int i;
    if (point == GXB_NONE) return;
    point = gxbp_same(b, point);
    for (i = 0; i < m->count; i++)
        if (m->point[i] == point) return;
    if (m->count < 8) m->point[m->count++] = point;
}

static uint32_t gxbp_edge_triangle_point(gxb_boolean *b, uint32_t s, int k, uint32_t t) {
    const uint32_t name = gxbp_edge_name(b, s, k);
    int is_new;
    const uint32_t point = gxbp_keyed_point(b, GXB_FROM_EDGE_TRIANGLE, name, t, 0, &is_new);
    if (is_new)
        gxbp_place_point(b, point, GXB_LINE_PLANE, b->in.sources[s].point[k], b->in.sources[s].point[(k + 1) % 3],
                         b->in.sources[t].plane);
    return point;
}

/* Edge k of s crosses edge j of t in plane: that of t, or GXB_NONE if both triangles lie in one plane. In that case a
 * plane through edge j is made. */
static GXBP_COLD uint32_t gxbp_edge_edge_point(gxb_boolean *b, uint32_t s, int k, uint32_t t, int j, uint32_t plane) {
    const uint32_t e = gxbp_edge_name(b, s, k), f = gxbp_edge_name(b, t, j);
    /* first, so that a point without a place never stays */
    const gx_result room = GXBP_RESERVE(&b->store.allocator, &b->store, planes, plane, 1);
    int is_new;
    uint32_t point;
    if (room != GX_OK) {
        gxbp_stop(b, room);
        return GXB_NONE;
    }
    point = gxbp_keyed_point(b, GXB_FROM_EDGE_EDGE, e < f ? e : f, e < f ? f : e, 0, &is_new);
    if (!is_new) return point;
    if (plane == GXB_NONE) {
        gxbp_new_plane(&b->store, b->in.sources[t].point[j], b->in.sources[t].point[(j + 1) % 3],
                       b->store.planes[b->in.sources[t].plane].axis, 1, &plane);
        gxbp_plane_axis(&b->store, plane);
    }
    gxbp_place_point(b, point, GXB_LINE_PLANE, b->in.sources[s].point[k], b->in.sources[s].point[(k + 1) % 3], plane);
    return point;
}

/* Finds corners of s that lie in t, and points in which edges of s cross t. side: of the corners of s against t's
 * plane. */
static GXBP_COLD void gxbp_meet_one_way(gxb_boolean *b, uint32_t s, uint32_t t, const int side[3], gxbp_meeting *m) {
    int k;
    for (k = 0; k < 3; k++) {
        const int j = (k + 1) % 3;
        if (side[k] == 0) {
            const uint32_t point = b->in.sources[s].point[k];
            const gxbp_placement place = gxbp_locate_corner(b, gxbp_corner_of(b, s, k), t);
            if (place.outside) continue;
            if (place.edge >= 0) gxbp_hit_edge(b, t, place.edge, point);
            gxbp_found(b, m, point);
        } else if (side[k] * side[j] < 0) {
            const gxbp_placement place =
                gxbp_locate_crossing(b, gxbp_corner_of(b, s, k), gxbp_corner_of(b, s, j), side[k], t);
            uint32_t point;
            if (place.outside) continue;
            if (place.corner >= 0)
                point = b->in.sources[t].point[place.corner];
            else if (place.edge >= 0)
                point = gxbp_edge_edge_point(b, s, k, t, place.edge, b->in.sources[t].plane);
            else
                point = gxbp_edge_triangle_point(b, s, k, t);
            if (point == GXB_NONE) return;
            gxbp_hit_edge(b, s, k, point);
            if (place.edge >= 0) gxbp_hit_edge(b, t, place.edge, point);
            gxbp_found(b, m, point);
        }
    }
}

/* Edge k of s crosses t. y: its sides of the two edges of t that cross s's plane, y[0] of edge j, y[1] of edge j + 2.
   Neither is negative; 0: it crosses that edge. */
static inline void gxbp_record_crossing(gxb_boolean *b, uint32_t s, int k, uint32_t t, int j, const int y[2],
                                        gxbp_meeting *m) {
    const int edge = y[0] == 0 ? j : (j + 2) % 3;
    uint32_t point;
    if (y[0] > 0 && y[1] > 0)
        point = gxbp_edge_triangle_point(b, s, k, t);
    else
        point = gxbp_edge_edge_point(b, s, k, t, edge, b->in.sources[t].plane);
    if (point == GXB_NONE) return;
    gxbp_hit_edge(b, s, k, point);
    if (y[0] == 0 || y[1] == 0) gxbp_hit_edge(b, t, edge, point);
    gxbp_found(b, m, point);
}

/* sign[x][y]: orientation of (p[0], p[y + 1], q[x + 1], q[0]); 0: the filter leaves it open. The differences and
 * products are shared: see gxbp_cross_size for the bound. Returns 1 if none is left open. */
static int gxbp_orient_pairs_by_filter(const double *const q[3], const double *const p[3], int sign[2][2]) {
    double w[3], u[2][3], v[3], m[3], size[3];
    int x, y, k;
    for (k = 0; k < 3; k++) {
        w[k] = gxbp_fence(p[0][k] - q[0][k]);
        for (x = 0; x < 2; x++) u[x][k] = gxbp_fence(q[x + 1][k] - q[0][k]);
    }
    for (y = 0; y < 2; y++) {
        for (k = 0; k < 3; k++) v[k] = gxbp_fence(p[y + 1][k] - q[0][k]);
        gxbp_cross_sizes(m, size, w, v);
        for (x = 0; x < 2; x++) {
            const double *a = u[x];
            const double bound =
                32 * GXBP_U * (gxbp_abs(a[0]) * size[0] + gxbp_abs(a[1]) * size[1] + gxbp_abs(a[2]) * size[2]) +
                GXBP_TINY;
            sign[x][y] = gxbp_filter_sign(a[0] * m[0] + a[1] * m[1] + a[2] * m[2], bound);
        }
    }
    return sign[0][0] * sign[0][1] * sign[1][0] * sign[1][1] != 0;
}

static void gxbp_orient_pairs(gxb_boolean *b, const double *const q[3], const double *const p[3], int sign[2][2]) {
    const double *corner[4];
    int x, y;
    b->store.filter_calls += 4;
    if (gxbp_orient_pairs_by_filter(q, p, sign)) return;
    for (y = 0; y < 2; y++)
        for (x = 0; x < 2; x++) {
            if (sign[x][y] != 0) continue;
            b->store.exact_calls++;
            corner[0] = p[0];
            corner[1] = p[y + 1];
            corner[2] = q[x + 1];
            corner[3] = q[0];
            sign[x][y] = gxbp_orient3d_exact(corner);
        }
}

/* The lone corner: the one that is alone on its side */
static int gxbp_lone_corner(const int side[3]) { return side[1] == side[2] ? 0 : side[0] == side[2] ? 1 : 2; }

/* Corners of two triangles from their lone corners i and j on */
static void gxbp_list_corners(const gxb_boolean *b, uint32_t s, int i, uint32_t t, int j, const double *q[3],
                              const double *p[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        q[k] = gxbp_corner_of(b, s, (i + k) % 3);
        p[k] = gxbp_corner_of(b, t, (j + k) % 3);
    }
}

/* The points in which two triangles meet that lie across each other's planes: no corner lies in the other's plane.
   sign: see gxbp_orient_pairs, of corners in the order of gxbp_list_corners. Two edges of each triangle cross that
   plane, those at its lone corner. Where one crosses follows from its orientations with the two edges of the other
   triangle. Four orientations serve both triangles. The common segment's direction u in s leads from the edge that
   leaves the lone corner to the one that comes back. The lone corner is to its left, so the corner's side_s is the sign
   of |n_t n_s u|. For t's direction w its side_t is the sign of |n_s n_t w|. So u and w agree where the lone corners'
   sides differ. One end of the common segment is the start of both. */
static void gxbp_meet_across(gxb_boolean *b, uint32_t s, uint32_t t, const int side_s[3], const int side_t[3],
                             int sign[2][2], gxbp_meeting *m) {
    const int i = gxbp_lone_corner(side_s), j = gxbp_lone_corner(side_t);
    int y[2], k, x;
    for (k = 0; k < 3; k++) {
        if (k == (i + 1) % 3) continue;
        x = k != i;
        y[0] = -side_s[i] * sign[x][0];
        y[1] = side_s[i] * sign[x][1];
        if (y[0] < 0 || y[1] < 0) continue;
        gxbp_record_crossing(b, s, k, t, j, y, m);
        if (m->count == 1 && m->left == 0) m->left = x == 0 ? side_s[i] : -side_s[i];
    }
    for (k = 0; k < 3; k++) {
        if (k == (j + 1) % 3) continue;
        x = k != j;
        y[0] = -side_t[j] * sign[0][x];
        y[1] = side_t[j] * sign[1][x];
        if (y[0] < 0 || y[1] < 0) continue;
        gxbp_record_crossing(b, t, k, s, i, y, m);
        if (m->count == 1 && m->left == 0) m->left = x == 0 ? -side_t[j] : side_t[j];
    }
}

static int gxbp_is_corner(gxb_boolean *b, uint32_t s, uint32_t point) {
    const uint32_t *p = b->in.sources[s].point, same = gxbp_same(b, point);
    return same == gxbp_same(b, p[0]) || same == gxbp_same(b, p[1]) || same == gxbp_same(b, p[2]);
}

static void gxbp_record_meeting(gxb_boolean *b, uint32_t s, uint32_t t, const gxbp_meeting *m) {
    if (b->error != GX_OK || m->count == 0) return;
    if (m->count == 1) {
        if (!gxbp_is_corner(b, s, m->point[0])) gxbp_add_segment(b, s, m->point[0], m->point[0], t, 0);
        if (!gxbp_is_corner(b, t, m->point[0])) gxbp_add_segment(b, t, m->point[0], m->point[0], s, 0);
        return;
    }
    gxbp_add_segment(b, s, m->point[0], m->point[1], t, m->left);
    gxbp_add_segment(b, t, m->point[0], m->point[1], s, -m->left);
}

static uint32_t gxbp_root(gxb_boolean *b, uint32_t s) {
    while (b->in.sources[s].root != s) {
        b->in.sources[s].root = b->in.sources[b->in.sources[s].root].root;
        s = b->in.sources[s].root;
    }
    return s;
}

/* Two triangles that overlap in one plane are divided together. */
static GXBP_RARE void gxbp_join_flats(gxb_boolean *b, uint32_t s, uint32_t t) {
    uint32_t r = gxbp_root(b, s), q = gxbp_root(b, t), last;
    gxbp_mark_dirty(b, s);
    gxbp_mark_dirty(b, t);
    if (r == q) return;
    if (q < r) {
        const uint32_t swap = r;
        r = q;
        q = swap;
    }
    for (last = q; b->in.sources[last].next != GXB_NONE; last = b->in.sources[last].next) {} /* mostly alone */
    b->in.sources[last].next = b->in.sources[r].next;
    b->in.sources[r].next = q;
    b->in.sources[q].root = r;
    b->in.sources[r].flags |= GXBP_FLAT;
}

/* 1: no edge of s has all of t on its outer side. turn[k][j]: corner j of t against edge k of s */
static int gxbp_no_edge_separates(int turn[3][3], int orientation) {
    int k;
    for (k = 0; k < 3; k++)
        if (turn[k][0] * orientation <= 0 && turn[k][1] * orientation <= 0 && turn[k][2] * orientation <= 0) return 0;
    return 1;
}

/* Finds corner k of s if it lies in t. turn[j][k]: the corner against t's edge j */
static GXBP_COLD void gxbp_meet_corner(gxb_boolean *b, uint32_t s, int k, uint32_t t, int turn[3][3], int orientation,
                                       gxbp_meeting *m) {
    int sign[3], j;
    gxbp_placement place;
    for (j = 0; j < 3; j++) sign[j] = turn[j][k] * orientation;
    place = gxbp_locate_by_signs(sign);
    if (place.outside) return;
    gxbp_found(b, m, b->in.sources[s].point[k]);
    if (place.edge >= 0) gxbp_hit_edge(b, t, place.edge, b->in.sources[s].point[k]);
}

static GXBP_COLD void gxbp_meet_in_plane(gxb_boolean *b, uint32_t s, uint32_t t) {
    const uint32_t plane = b->in.sources[s].plane;
    int turn_s[3][3], turn_t[3][3], k, j, facing;
    gxbp_meeting m;
    m.count = m.left = 0;
    for (k = 0; k < 3; k++)
        for (j = 0; j < 3; j++) {
            turn_s[k][j] = gxbp_flat_turn(b, plane, gxbp_corner_of(b, s, k), gxbp_corner_of(b, s, (k + 1) % 3),
                                          gxbp_corner_of(b, t, j));
            turn_t[k][j] = gxbp_flat_turn(b, plane, gxbp_corner_of(b, t, k), gxbp_corner_of(b, t, (k + 1) % 3),
                                          gxbp_corner_of(b, s, j));
        }
    facing = gxbp_flat_turn(b, plane, gxbp_corner_of(b, t, 0), gxbp_corner_of(b, t, 1), gxbp_corner_of(b, t, 2));
    for (k = 0; k < 3; k++) {
        gxbp_meet_corner(b, s, k, t, turn_t, facing, &m);
        gxbp_meet_corner(b, t, k, s, turn_s, 1, &m);
    }
    for (k = 0; k < 3; k++)
        for (j = 0; j < 3; j++) {
            uint32_t point;
            if (turn_s[k][j] * turn_s[k][(j + 1) % 3] >= 0 || turn_t[j][k] * turn_t[j][(k + 1) % 3] >= 0) continue;
            point = gxbp_edge_edge_point(b, s, k, t, j, GXB_NONE);
            if (point == GXB_NONE) return;
            gxbp_hit_edge(b, s, k, point);
            gxbp_hit_edge(b, t, j, point);
        }
    if (gxbp_no_edge_separates(turn_s, 1) && gxbp_no_edge_separates(turn_t, facing))
        gxbp_join_flats(b, s, t);
    else
        gxbp_record_meeting(b, s, t, &m);
}

/* Do they share an edge of their surface? Then they share nothing else, unless they lie in one plane. */
static int gxbp_are_neighbours(const gxb_boolean *b, uint32_t s, uint32_t t) {
    const uint32_t *twin = b->in.sources[s].twin;
    int k;
    for (k = 0; k < 3; k++)
        if (twin[k] != GXB_NONE && twin[k] / 3 == t) return 1;
    return 0;
}

/* Do two neighbours in one plane lie on different sides of their common edge? */
static GXBP_RARE int gxbp_flat_apart(const gxb_boolean *b, uint32_t s, uint32_t t) {
    int k, j;
    for (k = 0; k < 3; k++) {
        const double *p = gxbp_corner_of(b, s, k), *q = gxbp_corner_of(b, s, (k + 1) % 3);
        if (b->in.sources[s].twin[k] == GXB_NONE || b->in.sources[s].twin[k] / 3 != t) continue;
        j = (int)(b->in.sources[s].twin[k] % 3);
        return gxbp_flat_turn(b, b->in.sources[s].plane, p, q, gxbp_corner_of(b, t, (j + 2) % 3)) < 0;
    }
    return 0;
}

/* One corner in the plane, the others on one side of it */
static int gxbp_touches_by_corner(const int side[3]) {
    return side[0] + side[1] + side[2] == 2 || side[0] + side[1] + side[2] == -2;
}

/* A triangle's corners are in its plane. Others that share them need not ask. */
static void gxbp_note_corners(gxb_boolean *b, uint32_t s, int slot) {
    const uint32_t stamp = b->in.sources[s].plane + 1;
    int k;
    for (k = 0; k < 3; k++) {
        gxb_cpoint *p = &b->store.points[b->in.sources[s].point[k]];
        p->stamp[slot] = stamp;
        p->sign[slot] = 0;
    }
}

static int gxbp_share_one_corner(gxb_boolean *b, uint32_t s, uint32_t t) {
    int k, common = 0;
    for (k = 0; k < 3; k++) common += gxbp_is_corner(b, t, b->in.sources[s].point[k]);
    return common == 1;
}

static void gxbp_meet(gxb_boolean *b, uint32_t s, uint32_t t) {
    int side_t[3], side_s[3];
    gxbp_meeting m;
    const int together = b->in.sources[s].operand == b->in.sources[t].operand;
    int neighbours, flat;
    if (b->error != GX_OK || !gxbp_need_plane(b, s)) return;
    if (together) gxbp_note_corners(b, s, 0);
    gxbp_sides(b, t, b->in.sources[s].plane, 0, side_t);
    if (gxbp_all_on_one_side(side_t) || !gxbp_need_plane(b, t)) return;
    flat = side_t[0] == 0 && side_t[1] == 0 && side_t[2] == 0;
    neighbours = together && gxbp_are_neighbours(b, s, t);
    if (neighbours && !flat) return;
    if (flat) {
        if (!neighbours || !gxbp_flat_apart(b, s, t)) gxbp_meet_in_plane(b, s, t);
        return;
    }
    if (gxbp_touches_by_corner(side_t) && gxbp_share_one_corner(b, s, t)) return;
    if (together) gxbp_note_corners(b, t, 1);
    gxbp_sides(b, s, b->in.sources[t].plane, 1, side_s);
    if (gxbp_all_on_one_side(side_s)) return;
    m.count = m.left = 0;
    if (side_s[0] * side_s[1] * side_s[2] != 0 && side_t[0] * side_t[1] * side_t[2] != 0) {
        const double *q[3], *p[3];
        int sign[2][2];
        gxbp_list_corners(b, s, gxbp_lone_corner(side_s), t, gxbp_lone_corner(side_t), q, p);
        gxbp_orient_pairs(b, q, p, sign);
        gxbp_meet_across(b, s, t, side_s, side_t, sign, &m);
    } else {
        if (gxbp_touches_by_corner(side_s) && gxbp_share_one_corner(b, s, t)) return;
        gxbp_meet_one_way(b, s, t, side_s, &m);
        gxbp_meet_one_way(b, t, s, side_t, &m);
    }
    gxbp_record_meeting(b, s, t, &m);
}

/* --- surfaces of which a point sees all cannot cross themselves --- */

/* The mean of a surface's first corners; numbers that predicates could not take are 0. Any point would do. */
static void gxbp_middle_of(const gxb_boolean *b, const gxbp_operand *o, double middle[3]) {
    double largest = 0;
    uint32_t s, k;
    middle[0] = middle[1] = middle[2] = 0;
    for (s = o->source; s < o->source + o->source_count; s++) {
        const double *x = gxbp_corner_of(b, s, 0);
        for (k = 0; k < 3; k++) middle[k] += x[k];
        largest = gxbp_max(largest, gxbp_max3(x));
    }
    for (k = 0; k < 3; k++) {
        middle[k] /= o->source_count;
        if (gxbp_abs(middle[k]) < largest * gxbp_power(-40) || gxbp_abs(middle[k]) < gxbp_power(-127)) middle[k] = 0;
    }
}

/* The side of edge p q on which c lies, all seen along x. c is moved in y, z by (h, h^2), h -> 0: the derivatives of
 * the orientation decide. 0: the edge is parallel to x. */
static int gxbp_moved_turn(const double *p, const double *q, const double *c) {
    const int turn = gxb_orient2d(p + 1, q + 1, c + 1);
    if (turn != 0) return turn;
    return !gxbp_is_zero(gxbp_fence(p[2] - q[2])) ? gxbp_compare_doubles(p[2], q[2]) : gxbp_compare_doubles(q[1], p[1]);
}

/* Does the ray from c along x, moved, cross a triangle that turns as turn says, seen from its end? */
static int gxbp_ray_crosses(const double *p, const double *q, const double *r, const double *c, int turn) {
    int k;
    for (k = 1; k < 3; k++)
        if ((p[k] > c[k] && q[k] > c[k] && r[k] > c[k]) || (p[k] < c[k] && q[k] < c[k] && r[k] < c[k])) return 0;
    return gxbp_moved_turn(p, q, c) == turn && gxbp_moved_turn(q, r, c) == turn && gxbp_moved_turn(r, p, c) == turn;
}

/* Does the middle of a closed surface see all of its triangles from the same side, and does the surface wind around it
   once? Seen from there, triangles cover the directions evenly, as often as the surface winds, since none is seen from
   its other side. So no two of them share a direction but in common edges and vertices, and the surface is simple. */
static GXBP_APART int gxbp_is_star(const gxb_boolean *b, const gxbp_operand *o) {
    double c[3];
    uint32_t s, crossed = 0;
    int side = 0;
    if (o->operation == GXB_SPLIT) return 0;
    gxbp_middle_of(b, o, c);
    for (s = o->source; s < o->source + o->source_count; s++) {
        const double *p = gxbp_corner_of(b, s, 0), *q = gxbp_corner_of(b, s, 1), *r = gxbp_corner_of(b, s, 2);
        const int turn = gxb_orient3d(p, q, r, c);
        if (turn == 0 || turn == -side) return 0;
        side = turn;
        crossed += (uint32_t)gxbp_ray_crosses(p, q, r, c, side);
    }
    return crossed == 1;
}

/* >>encounters: pairs of triangles whose boxes meet ---------------------------------------------------------------- */
/* In: the trees of two operands. Out: all pairs of their sources whose boxes overlap, given to gxbp_meet. With the
   host's threads, pairs of boxes are searched side by side, and each pair of sources is judged there as far as filters
   go. The pairs are then met in the order in which they would be without threads. Touches what >>meet does. */

/* What tasks found out about a pair. BESIDE: all of t is on one side of s's plane. APART: they do not meet, and
   nothing else is known. ACROSS: they meet, each across the other's plane, and the signs are behind the judgement:
   those of the corners of s, of t, and of gxbp_orient_pairs; 1 where one is positive. */
enum { GXBP_PAIR_OPEN, GXBP_PAIR_BESIDE, GXBP_PAIR_APART, GXBP_PAIR_ACROSS, GXBP_JUDGEMENT_BITS = 2 };
typedef struct gxbp_encounter {
    uint32_t s, t, judged;
} gxbp_encounter;

/* Where a walk through two trees puts what it finds: pairs of boxes of level floor or below it, or pairs of sources */
typedef struct gxbp_finds {
    uint32_t floor;
    int boxes;            /* 1: pairs of boxes, in b->work.box_pairs; else pairs of sources, in the list */
    gxbp_encounter *list; /* capacity */
    uint32_t count, capacity;
    int full;
    uint64_t filter_calls;
} gxbp_finds;
enum {
    GXBP_FLOOR = 3,                   /* of pairs of boxes: 64 sources in each */
    GXBP_TASK_BOXES = 16,             /* pairs of boxes for a task */
    GXBP_TASK_ENCOUNTERS = GXBP_PART, /* of a task: if there are more, the rest is left to the caller */
    GXBP_TASKS = 32                   /* at a time */
};

static void gxbp_source_filter(const gxb_boolean *b, uint32_t s, gxb_plane_filter *f) {
    const gxbp_source *source = &b->in.sources[s];
    const gxb_ball *p = &b->store.points[source->point[0]].ball;
    double u[3], v[3], eu, ev;
    if (source->plane != GXB_NONE) {
        *f = b->store.planes[source->plane].filter;
        return;
    }
    eu = gxbp_filter_difference(u, p, &b->store.points[source->point[1]].ball);
    ev = gxbp_filter_difference(v, p, &b->store.points[source->point[2]].ball);
    gxbp_filter_plane(f, p, u, eu, v, ev);
}

/* Sides of a source's corners by the filter, 0 where it leaves them open. Returns how many are not. */
static int gxbp_sides_by_filter(const gxb_boolean *b, uint32_t s, const gxb_plane_filter *f, int side[3]) {
    int k, known = 0;
    for (k = 0; k < 3; k++) {
        double bound;
        const double value = gxbp_filter_side(&b->store.points[b->in.sources[s].point[k]].ball, f, &bound);
        side[k] = gxbp_filter_sign(value, bound);
        known += side[k] != 0;
    }
    return known;
}

/* Do the edges at a lone corner, on this side, pass beside the other triangle? sign: by the edge, then by the other
   triangle's edge */
static int gxbp_passes_beside(int side, int sign[2][2]) {
    return (-side * sign[0][0] < 0 || side * sign[0][1] < 0) && (-side * sign[1][0] < 0 || side * sign[1][1] < 0);
}

/* What gxbp_meet would do with a pair, as far as filters tell. f: of s's plane */
static uint32_t gxbp_judge_pair(const gxb_boolean *b, uint32_t s, uint32_t t, const gxb_plane_filter *f,
                                gxbp_finds *finds) {
    gxb_plane_filter g;
    const double *q[3], *p[3];
    int side_s[3], side_t[3], sign[2][2], turned[2][2], i, j, k;
    const int known = gxbp_sides_by_filter(b, t, f, side_t);
    uint32_t judged = GXBP_PAIR_ACROSS, bit = 1u << GXBP_JUDGEMENT_BITS;
    finds->filter_calls += 3;
    if (gxbp_all_on_one_side(side_t)) return GXBP_PAIR_BESIDE;
    if (b->in.sources[s].operand == b->in.sources[t].operand && gxbp_are_neighbours(b, s, t))
        return known > 0 ? GXBP_PAIR_APART : GXBP_PAIR_OPEN;
    if (known < 3) return GXBP_PAIR_OPEN;
    gxbp_source_filter(b, t, &g);
    finds->filter_calls += 3;
    k = gxbp_sides_by_filter(b, s, &g, side_s);
    if (gxbp_all_on_one_side(side_s)) return GXBP_PAIR_APART;
    if (k < 3) return GXBP_PAIR_OPEN;
    i = gxbp_lone_corner(side_s);
    j = gxbp_lone_corner(side_t);
    gxbp_list_corners(b, s, i, t, j, q, p);
    finds->filter_calls += 4;
    if (!gxbp_orient_pairs_by_filter(q, p, sign)) return GXBP_PAIR_OPEN;
    for (k = 0; k < 4; k++) turned[k % 2][k / 2] = sign[k / 2][k % 2];
    if (gxbp_passes_beside(side_s[i], sign) && gxbp_passes_beside(side_t[j], turned)) return GXBP_PAIR_APART;
    for (k = 0; k < 3; k++, bit *= 2) judged |= side_s[k] > 0 ? bit : 0;
    for (k = 0; k < 3; k++, bit *= 2) judged |= side_t[k] > 0 ? bit : 0;
    for (k = 0; k < 4; k++, bit *= 2) judged |= sign[k / 2][k % 2] > 0 ? bit : 0;
    return judged;
}

/* Does with a pair what gxbp_meet does, in fewer steps where it is judged. */
static void gxbp_meet_judged(gxb_boolean *b, const gxbp_encounter *e) {
    int side_s[3], side_t[3], sign[2][2], k;
    uint32_t kind = e->judged & 3, bits = e->judged >> GXBP_JUDGEMENT_BITS;
    gxbp_meeting m;
    if (kind == GXBP_PAIR_OPEN) {
        gxbp_meet(b, e->s, e->t);
        return;
    }
    if (b->error != GX_OK || !gxbp_need_plane(b, e->s) || kind == GXBP_PAIR_BESIDE || !gxbp_need_plane(b, e->t) ||
        kind == GXBP_PAIR_APART)
        return;
    for (k = 0; k < 3; k++, bits /= 2) side_s[k] = bits & 1 ? 1 : -1;
    for (k = 0; k < 3; k++, bits /= 2) side_t[k] = bits & 1 ? 1 : -1;
    for (k = 0; k < 4; k++, bits /= 2) sign[k / 2][k % 2] = bits & 1 ? 1 : -1;
    m.count = m.left = 0;
    gxbp_meet_across(b, e->s, e->t, side_s, side_t, sign, &m);
    gxbp_record_meeting(b, e->s, e->t, &m);
}

static void gxbp_find_encounter(const gxb_boolean *b, gxbp_finds *finds, uint32_t s, uint32_t t, gxb_plane_filter *f,
                                int *filtered) {
    gxbp_encounter *e = &finds->list[finds->count];
    if (finds->count == finds->capacity) {
        finds->full = 1;
        return;
    }
    if (!*filtered) gxbp_source_filter(b, s, f);
    *filtered = 1;
    e->s = s;
    e->t = t;
    e->judged = gxbp_judge_pair(b, s, t, f, finds);
    finds->count++;
}

/* finds NULL: the pairs of two leaves meet; else they are listed there. */
static GXBP_APART void gxbp_meet_leaves(gxb_boolean *b, const gxbp_operand *o, uint32_t i, const gxbp_operand *q,
                                        uint32_t j, gxbp_finds *finds) {
    uint32_t first[GXBP_LEAF], second[GXBP_LEAF], x, y;
    gxbp_test_leaf(&b->in.bounds[o->bounds + i], &b->in.boxes[q->tree.first + j], first);
    for (x = 0; x < GXBP_LEAF; x++) {
        gxb_plane_filter f;
        int filtered = 0;
        gxbp_box box;
        uint32_t s;
        if (!first[x]) continue;
        s = o->order[i * GXBP_LEAF + x];
        if (b->in.sources[s].flags & GXBP_DEGENERATE) continue;
        box = gxbp_leaf_box(&b->in.bounds[o->bounds + i], x);
        if (!gxbp_test_leaf(&b->in.bounds[q->bounds + j], &box, second)) continue;
        for (y = o == q && i == j ? x + 1 : 0; y < GXBP_LEAF; y++) {
            if (!second[y] || b->in.sources[q->order[j * GXBP_LEAF + y]].flags & GXBP_DEGENERATE) continue;
            if (finds == NULL)
                gxbp_meet(b, s, q->order[j * GXBP_LEAF + y]);
            else
                gxbp_find_encounter(b, finds, s, q->order[j * GXBP_LEAF + y], &f, &filtered);
        }
    }
}

static void gxbp_list_box_pair(gxb_boolean *b, uint32_t i, uint32_t j) {
    if (!GXBP_ROOM(b, work.box_pairs, work.box_pair, 2)) return;
    b->work.box_pairs[b->work.box_pair_count++] = i;
    b->work.box_pairs[b->work.box_pair_count++] = j;
}

/* Box i of level l of one tree meets box j of level m of the other. Goes down to the boxes within the one of the higher
 * level, or within both. The depth of the recursion is the higher level. finds NULL: all pairs of sources meet */
static GXBP_APART void gxbp_meet_boxes(gxb_boolean *b, const gxbp_operand *o, uint32_t l, uint32_t i,
                                       const gxbp_operand *q, uint32_t m, uint32_t j, gxbp_finds *finds) {
    const gxbp_tree *s = &o->tree, *t = &q->tree;
    const uint32_t down_s = l >= m, down_t = m >= l;
    uint32_t c, d;
    if (b->error != GX_OK || (finds != NULL && finds->full)) return;
    if (finds != NULL && finds->boxes && l <= finds->floor && m <= finds->floor) {
        gxbp_list_box_pair(b, i, j);
        return;
    }
    if (l == 0 && m == 0) {
        gxbp_meet_leaves(b, o, i, q, j, finds);
        return;
    }
    for (c = i << down_s; c < (i + 1) << down_s && c < s->size[l - down_s]; c++)
        for (d = o == q && c > j << down_t ? c : j << down_t; d < (j + 1) << down_t && d < t->size[m - down_t]; d++)
            if (gxbp_boxes_meet(b, s, l - down_s, c, t, m - down_t, d))
                gxbp_meet_boxes(b, o, l - down_s, c, q, m - down_t, d, finds);
}

/* --- the same on the host's threads --- */

/* Two operands, the levels of their pairs of boxes, and up to GXBP_TASKS tasks, with pairs from first on. done: how
   many of its pairs of boxes a task has searched to the end */
typedef struct gxbp_search {
    gxb_boolean *b;
    const gxbp_operand *o, *q;
    uint32_t l, m, first;
    gxbp_finds finds[GXBP_TASKS];
    uint32_t done[GXBP_TASKS];
} gxbp_search;

/* Pairs of boxes of a task, in b->work.box_pairs; *end: behind the last one */
static uint32_t gxbp_first_pair(const gxbp_search *search, size_t task, uint32_t *end) {
    const uint32_t count = search->b->work.box_pair_count / 2,
                   first = search->first + (uint32_t)task * (uint32_t)GXBP_TASK_BOXES;
    *end = count - first < (uint32_t)GXBP_TASK_BOXES ? count : first + (uint32_t)GXBP_TASK_BOXES;
    return first;
}

static void gxbp_meet_pair(const gxbp_search *search, uint32_t pair, gxbp_finds *finds) {
    const uint32_t *boxes = search->b->work.box_pairs + 2 * (size_t)pair;
    gxbp_meet_boxes(search->b, search->o, search->l, boxes[0], search->q, search->m, boxes[1], finds);
}

static void gxbp_search_boxes(void *context, size_t task) {
    gxbp_search *search = (gxbp_search *)context;
    gxbp_finds finds = search->finds[task]; /* not beside those of other threads */
    uint32_t end, i = gxbp_first_pair(search, task, &end), known;
    for (search->done[task] = 0; i < end; i++) {
        known = finds.count;
        gxbp_meet_pair(search, i, &finds);
        if (finds.full) {
            finds.count = known;
            break;
        }
        search->done[task]++;
    }
    search->finds[task] = finds;
}

/* Meets what a task has found, then what it has left. */
static void gxbp_meet_found(const gxbp_search *search, size_t task) {
    gxb_boolean *b = search->b;
    const gxbp_finds *finds = &search->finds[task];
    uint32_t end, i = gxbp_first_pair(search, task, &end) + search->done[task], k;
    b->store.filter_calls += finds->filter_calls;
    for (k = 0; k < finds->count && b->error == GX_OK; k++) gxbp_meet_judged(b, &finds->list[k]);
    for (; i < end && b->error == GX_OK; i++) gxbp_meet_pair(search, i, NULL);
}

static GXBP_COLD void gxbp_meet_by_parts(gxb_boolean *b, const gxbp_operand *o, uint32_t l, const gxbp_operand *q,
                                         uint32_t m) {
    const uint32_t floor = GXBP_FLOOR;
    gxbp_search search;
    gxbp_finds finds;
    uint32_t count, k;
    memset(&finds, 0, sizeof finds);
    finds.floor = floor;
    finds.boxes = 1;
    b->work.box_pair_count = b->work.encounter_count = 0;
    gxbp_meet_boxes(b, o, l, 0, q, m, 0, &finds);
    if (!GXBP_ROOM(b, work.encounters, work.encounter, GXBP_TASKS * GXBP_TASK_ENCOUNTERS)) return;
    search.b = b;
    search.o = o;
    search.q = q;
    search.l = l < floor ? l : floor;
    search.m = m < floor ? m : floor;
    for (search.first = 0; search.first < b->work.box_pair_count / 2 && b->error == GX_OK;
         search.first += (uint32_t)(GXBP_TASKS * GXBP_TASK_BOXES)) {
        count = (b->work.box_pair_count / 2 - search.first + (uint32_t)GXBP_TASK_BOXES - 1) / (uint32_t)GXBP_TASK_BOXES;
        if (count > (uint32_t)GXBP_TASKS) count = GXBP_TASKS;
        for (k = 0; k < count; k++) {
            memset(&search.finds[k], 0, sizeof *search.finds);
            search.finds[k].list = b->work.encounters + k * (uint32_t)GXBP_TASK_ENCOUNTERS;
            search.finds[k].capacity = GXBP_TASK_ENCOUNTERS;
        }
        gxbp_each_part(b, count, gxbp_search_boxes, &search);
        for (k = 0; k < count; k++) gxbp_meet_found(&search, k);
    }
}

/* A surface that is found not to meet itself is simple. */
static void gxbp_meet_operands(gxb_boolean *b, uint32_t i, uint32_t j) {
    gxbp_operand *o = &b->in.operands[i], *q = &b->in.operands[j];
    const uint32_t l = o->tree.levels - 1, m = q->tree.levels - 1, marks = b->crossings.marks;
    if (i == j && !o->simple) o->simple = (uint32_t)gxbp_is_star(b, o);
    if (i == j && o->simple) return;
    if (gxbp_has_jobs(b) && gxbp_part_count((size_t)o->source_count + q->source_count) > 1)
        gxbp_meet_by_parts(b, o, l, q, m);
    else
        gxbp_meet_boxes(b, o, l, 0, q, m, 0, NULL);
    if (i == j) o->simple = b->crossings.marks == marks && b->error == GX_OK;
}

/* >>edges: points on edges in order -------------------------------------------------------------------------------- */
/* In: hits, that is points on edges of surfaces. Out: the points of each edge in order; equal points become one.
   Touches the edges and their points. */

/* gxbp_compare_points for points in which two planes cut one line through two input points. p's side of q's plane says
   to which end of the line p lies nearer than q. Sides of points given by doubles, and of points on their lines, take
   no exact numbers. */
static GXBP_COLD int gxbp_compare_on_line(gxb_boolean *b, uint32_t p, uint32_t q, uint32_t axis) {
    const gxb_cpoint *x = b->store.points, *u = &x[p], *v = &x[q];
    int end_side, along, side;
    if (u->kind != GXB_LINE_PLANE || v->kind != GXB_LINE_PLANE || u->exact != NULL || v->exact != NULL ||
        !((u->def[0] == v->def[0] && u->def[1] == v->def[1]) || (u->def[0] == v->def[1] && u->def[1] == v->def[0])))
        return GXBP_UNKNOWN;
    end_side = gxbp_point_side(b, u->def[0], v->def[2]);
    if (end_side == 0 || gxbp_point_side(b, u->def[1], v->def[2]) != -end_side) return GXBP_UNKNOWN;
    along = gxbp_compare_doubles(x[u->def[1]].ball.x[axis], x[u->def[0]].ball.x[axis]);
    side = gxbp_exact_sign(&b->store, u->kind, u->def, p, v->def[2]);
    return side == end_side ? -along : side == 0 ? 0 : along;
}

/* Sign of p[axis] - q[axis]; 0: the filter leaves it open */
static int gxbp_compare_by_filter(const gxb_boolean *b, uint32_t p, uint32_t q, uint32_t axis) {
    const gxb_ball *a = &b->store.points[p].ball, *c = &b->store.points[q].ball;
    const double difference = gxbp_fence(a->x[axis] - c->x[axis]);
    return gxbp_filter_sign(difference, 2 * (a->error + c->error) + 2 * GXBP_U * gxbp_abs(difference) + GXBP_TINY);
}

/* Sign of p[axis] - q[axis] */
static int gxbp_compare_points(gxb_boolean *b, uint32_t p, uint32_t q, uint32_t axis) {
    const int sign = gxbp_compare_by_filter(b, p, q, axis);
    gxbp_vec s, t;
    const gxb_num *x, *y;
    GXB_NUM(r);
    int known;
    b->store.filter_calls++;
    if (sign != 0 || p == q) return sign;
    known = gxbp_compare_on_line(b, p, q, axis);
    if (known != GXBP_UNKNOWN) return known;
    b->store.exact_calls++;
    x = gxbp_exact_cpoint(&b->store, p, &s);
    y = gxbp_exact_cpoint(&b->store, q, &t);
    gxbp_num_det2(&r, &x[axis], &y[3], &y[axis], &x[3]);
    return r.sign;
}

/* Insertion sort of points along an axis; equal ones become the first of them. Returns how many remain. */
static uint32_t gxbp_insert_points(gxb_boolean *b, uint32_t *p, uint32_t count, uint32_t axis, int direction) {
    uint32_t i, j, n = 0;
    for (i = 0; i < count; i++) {
        const uint32_t x = gxbp_same(b, p[i]);
        int sign = 1;
        for (j = n; j > 0; j--) {
            sign = gxbp_compare_points(b, x, p[j - 1], axis) * direction;
            if (sign >= 0) break;
        }
        if (j > 0 && sign == 0) {
            gxbp_unite(b, p[j - 1], x);
            continue;
        }
        memmove(p + j + 1, p + j, (n++ - j) * sizeof *p);
        p[j] = x;
    }
    return n;
}

/* Merge sort of points along an axis, each pair compared once; equal ones become one. work: count words. Returns how
 * many remain. */
static uint32_t gxbp_sort_points(gxb_boolean *b, uint32_t *p, uint32_t count, uint32_t axis, int direction,
                                 uint32_t *work) {
    const uint32_t half = count / 2;
    uint32_t i, j, k, left, end;
    if (count <= 8) return gxbp_insert_points(b, p, count, axis, direction);
    left = gxbp_sort_points(b, p, half, axis, direction, work);
    end = half + gxbp_sort_points(b, p + half, count - half, axis, direction, work);
    memcpy(work, p, left * sizeof *p);
    for (i = 0, j = half, k = 0; i < left && j < end; k++) {
        /* sorting the right half may have given another name to a point of the left one */
        const uint32_t x = gxbp_same(b, work[i]), y = gxbp_same(b, p[j]);
        const int sign = gxbp_compare_points(b, y, x, axis) * direction;
        p[k] = sign < 0 ? y : x;
        i += sign >= 0;
        j += sign <= 0;
        if (sign == 0) gxbp_unite(b, x, y);
    }
    for (; i < left; i++) p[k++] = gxbp_same(b, work[i]);
    for (; j < end; j++) p[k++] = p[j];
    return k;
}

/* The axis along which an edge is longest, and the edge's direction along it. An edge has a length, so that difference
 * never underflows. */
static uint32_t gxbp_edge_axis(const double *p, const double *q, int *direction) {
    uint32_t axis = 0, k;
    for (k = 1; k < 3; k++)
        if (gxbp_abs(gxbp_fence(q[k] - p[k])) > gxbp_abs(gxbp_fence(q[axis] - p[axis]))) axis = k;
    *direction = gxbp_compare_doubles(q[axis], p[axis]);
    return axis;
}

/* Puts the new points of an edge, which are in b->work.ordered, in order with its old ones. */
static void gxbp_order_edge(gxb_boolean *b, uint32_t edge) {
    gxbp_surface_edge *e = &b->crossings.edges[edge];
    const uint32_t s = e->half_edge / 3, k = e->half_edge % 3;
    const double *p = gxbp_corner_of(b, s, (int)k), *q = gxbp_corner_of(b, s, (int)(k + 1) % 3);
    uint32_t count, axis;
    int direction;
    if (!GXBP_ROOM(b, work.ordered, work.ordered, e->count)) return;
    if (e->count > 0)
        memcpy(b->work.ordered + b->work.ordered_count, b->crossings.edge_points + e->first,
               e->count * sizeof *b->work.ordered);
    b->work.ordered_count += e->count;
    count = b->work.ordered_count;
    if (!GXBP_ROOM(b, work.ordered, work.ordered, count) ||
        !GXBP_ROOM(b, crossings.edge_points, crossings.edge_point, count))
        return;
    axis = gxbp_edge_axis(p, q, &direction);
    count = gxbp_sort_points(b, b->work.ordered, count, axis, direction, b->work.ordered + b->work.ordered_count);
    e->first = b->crossings.edge_point_count;
    e->count = count;
    memcpy(b->crossings.edge_points + e->first, b->work.ordered, count * sizeof *b->crossings.edge_points);
    b->crossings.edge_point_count += count;
}

/* Sorts hits by edge; those of one edge keep their order. work: room for half of them */
static void gxbp_sort_hits(gxbp_hit *h, uint32_t count, gxbp_hit *work) {
    const uint32_t half = count / 2;
    uint32_t i, j, k;
    if (count < 2) return;
    gxbp_sort_hits(h, half, work);
    gxbp_sort_hits(h + half, count - half, work);
    memcpy(work, h, half * sizeof *h);
    for (i = 0, j = half, k = 0; i < half; k++) h[k] = j < count && h[j].edge < work[i].edge ? h[j++] : work[i++];
}

/* The hits begin with count ones of an edge. */
static void gxbp_order_hits(gxb_boolean *b, const gxbp_hit *h, uint32_t count) {
    uint32_t i;
    b->work.ordered_count = 0;
    if (!GXBP_ROOM(b, work.ordered, work.ordered, count)) return;
    for (i = 0; i < count; i++) b->work.ordered[b->work.ordered_count++] = h[i].point;
    gxbp_order_edge(b, h->edge);
}

/* A few hits, among many edges */
static GXBP_COLD void gxbp_order_few_edges(gxb_boolean *b) {
    const uint32_t n = b->crossings.hit_count;
    gxbp_hit *h = b->crossings.hits;
    uint32_t i, j;
    gxbp_hit *work = (gxbp_hit *)gxbp_borrow(b, (n / 2 + 1) * sizeof *work);
    if (work == NULL) return;
    gxbp_sort_hits(h, n, work);
    for (i = 0; i < n && b->error == GX_OK; i = j) {
        for (j = i + 1; j < n && h[j].edge == h[i].edge; j++) {}
        gxbp_order_hits(b, h + i, j - i);
    }
}

/* --- the same on the host's threads: new edges of which filters tell the order --- */

/* points: of all hits, those of edge i from first[i] on. base: where these begin in b->crossings.edge_points.
 * filter_calls: of each part */
typedef struct gxbp_ordering {
    gxb_boolean *b;
    const uint32_t *first, *points;
    uint32_t base, *filter_calls;
} gxbp_ordering;
enum { GXBP_EDGE_HITS = 32 }; /* the most of an edge that a task puts in order by insertion */

/* Is an edge in order? Its points are then where a task has put them. */
static int gxbp_is_ordered(const gxbp_ordering *o, uint32_t edge) {
    const gxbp_surface_edge *e = &o->b->crossings.edges[edge];
    return e->count > 0 && e->first == o->base + o->first[edge];
}

/* Puts points in order where they will stand, each once. Returns how many there are; 0: a filter leaves one open, or a
   point has another name. */
static uint32_t gxbp_order_by_filter(const gxbp_ordering *o, uint32_t edge, uint32_t *to, uint32_t *filter_calls) {
    const gxb_boolean *b = o->b;
    const uint32_t h = b->crossings.edges[edge].half_edge, *point = o->points + o->first[edge],
                   *end = o->points + o->first[edge + 1];
    uint32_t axis, n = 0, j;
    int direction;
    axis =
        gxbp_edge_axis(gxbp_corner_of(b, h / 3, (int)(h % 3)), gxbp_corner_of(b, h / 3, (int)(h + 1) % 3), &direction);
    for (; point < end; point++) {
        int sign = 1;
        if (b->points.vertices[*point].same != *point) return 0;
        for (j = n; j > 0 && to[j - 1] != *point; j--) {
            sign = gxbp_compare_by_filter(b, *point, to[j - 1], axis) * direction;
            (*filter_calls)++;
            if (sign >= 0) break;
        }
        if (sign == 0) return 0;
        if (j > 0 && to[j - 1] == *point) continue;
        memmove(to + j + 1, to + j, (n++ - j) * sizeof *to);
        to[j] = *point;
    }
    return n;
}

static void gxbp_order_part(void *context, size_t part) {
    const gxbp_ordering *o = (const gxbp_ordering *)context;
    gxb_boolean *b = o->b;
    uint32_t end, i = gxbp_part_first(part, b->crossings.edge_count, &end), filter_calls = 0;
    for (; i < end; i++) {
        gxbp_surface_edge *e = &b->crossings.edges[i];
        const uint32_t hits = o->first[i + 1] - o->first[i];
        uint32_t n;
        if (hits == 0 || hits > (uint32_t)GXBP_EDGE_HITS || e->count > 0) continue;
        n = gxbp_order_by_filter(o, i, b->crossings.edge_points + o->base + o->first[i], &filter_calls);
        if (n == 0) continue;
        e->first = o->base + o->first[i];
        e->count = n;
    }
    o->filter_calls[part] = filter_calls;
}

/* Orders what tasks can, in room for all hits. */
static GXBP_COLD void gxbp_order_by_parts(gxb_boolean *b, gxbp_ordering *o) {
    const size_t parts = gxbp_part_count(b->crossings.edge_count);
    size_t part;
    o->filter_calls = (uint32_t *)gxbp_borrow(b, parts * sizeof *o->filter_calls);
    if (o->filter_calls == NULL || !GXBP_ROOM(b, crossings.edge_points, crossings.edge_point, b->crossings.hit_count))
        return;
    gxbp_each_part(b, parts, gxbp_order_part, o);
    for (part = 0; part < parts; part++) b->store.filter_calls += o->filter_calls[part];
    b->crossings.edge_point_count += b->crossings.hit_count;
}

/* A counting sort of the hits by edge, then each edge's points. */
static GXBP_APART void gxbp_order_all_edges(gxb_boolean *b) {
    const size_t words = (size_t)b->crossings.edge_count + 1 + b->crossings.hit_count;
    const int together = gxbp_has_jobs(b) && gxbp_part_count(b->crossings.edge_count) > 1;
    uint32_t *first, *points, i;
    gxbp_ordering ordering;
    first = (uint32_t *)gxbp_allocate(&b->store.allocator, words * sizeof *first);
    if (first == NULL) {
        gxbp_stop(b, GX_ERROR_MEMORY);
        return;
    }
    points = first + b->crossings.edge_count + 1;
    memset(first, 0, ((size_t)b->crossings.edge_count + 1) * sizeof *first);
    for (i = 0; i < b->crossings.hit_count; i++) first[b->crossings.hits[i].edge]++;
    for (i = 1; i <= b->crossings.edge_count; i++) first[i] += first[i - 1];
    for (i = b->crossings.hit_count; i-- > 0;) points[--first[b->crossings.hits[i].edge]] = b->crossings.hits[i].point;
    ordering.b = b;
    ordering.first = first;
    ordering.points = points;
    ordering.base = b->crossings.edge_point_count;
    if (together) gxbp_order_by_parts(b, &ordering);
    for (i = 0; i < b->crossings.edge_count && b->error == GX_OK; i++) {
        const uint32_t count = first[i + 1] - first[i];
        b->work.ordered_count = 0;
        if (count == 0 || (together && gxbp_is_ordered(&ordering, i)) ||
            !GXBP_ROOM(b, work.ordered, work.ordered, count))
            continue;
        memcpy(b->work.ordered, points + first[i], count * sizeof *points);
        b->work.ordered_count = count;
        gxbp_order_edge(b, i);
    }
    gxbp_release(&b->store.allocator, first, words * sizeof *first);
}

static void gxbp_order_edges(gxb_boolean *b) {
    if (b->error != GX_OK || b->crossings.hit_count == 0) return;
    if (b->crossings.edge_count > 16 * (uint64_t)b->crossings.hit_count)
        gxbp_order_few_edges(b);
    else
        gxbp_order_all_edges(b);
    b->crossings.hit_count = 0;
}

/* >>triangulate: points into a triangulation ----------------------------------------------------------------------- */
/* In: a source, or the root of a flat, with a triangulation, and a point of its plane. Out: the point as a vertex. A
   walk along a straight line from a vertex finds the point. Touches the subtriangles of this source and the hints of
   vertices. */

/* Is the point an end of this line of two input points, or defined as a point of it? */
static int gxbp_on_input_line(const gxb_cpoint *p, uint32_t from, uint32_t to) {
    if (p->kind == GXB_EXPLICIT) return p->def[0] == from || p->def[0] == to;
    return p->kind == GXB_LINE_PLANE &&
           ((p->def[0] == from && p->def[1] == to) || (p->def[0] == to && p->def[1] == from));
}

static uint32_t gxbp_plane_beside(const gxb_boolean *b, uint32_t half_edge) {
    return half_edge == GXB_NONE ? GXB_NONE : b->in.sources[half_edge / 3].plane;
}

/* Planes that contain a point by its definition: its own, and those of the input triangles at the edge in its key */
static uint32_t gxbp_planes_of(const gxb_boolean *b, uint32_t v, uint32_t plane[3]) {
    const gxb_cpoint *p = &b->store.points[v];
    const uint32_t *key = b->points.vertices[v].key;
    if (p->kind == GXB_EXPLICIT) return 0;
    memcpy(plane, p->def, sizeof p->def);
    if (p->kind == GXB_THREE_PLANES) return 3;
    plane[0] = p->def[2];
    if (key[0] != GXB_FROM_EDGE_TRIANGLE) return 1;
    plane[1] = gxbp_plane_beside(b, key[1]);
    plane[2] = gxbp_plane_beside(b, b->in.sources[key[1] / 3].twin[key[1] % 3]);
    return 3;
}

static int gxbp_is_in_plane(const gxb_boolean *b, uint32_t v, uint32_t plane) {
    const gxb_cpoint *p = &b->store.points[v];
    uint32_t planes[3], count = gxbp_planes_of(b, v, planes), k;
    for (k = 0; k < count; k++)
        if (planes[k] == plane) return 1;
    return gxbp_incident(&b->store, p->kind, p->def, p->kind == GXB_EXPLICIT ? p->def[0] : v, plane);
}

/* Do three points of a plane lie on one line by their definitions? They do in a second common plane (one plane may have
   several names), or on one edge. */
static int gxbp_on_definition_line(gxb_boolean *b, uint32_t p, uint32_t q, uint32_t r, uint32_t plane) {
    const gxb_cpoint *x = b->store.points, *a = &x[p];
    uint32_t planes[3], count = gxbp_planes_of(b, p, planes), k;
    if (a->kind == GXB_LINE_PLANE && gxbp_on_input_line(&x[q], a->def[0], a->def[1]) &&
        gxbp_on_input_line(&x[r], a->def[0], a->def[1]))
        return 1;
    for (k = 0; k < count; k++)
        if (planes[k] != plane && planes[k] != GXB_NONE && gxbp_is_in_plane(b, q, planes[k]) &&
            gxbp_is_in_plane(b, r, planes[k]) && gxbp_planes_cross(&b->store, planes[k], plane))
            return 1;
    return 0;
}

/* Orientation in a plane; 0: the filter does not settle it */
static inline int gxbp_plane_turn_by_filter(gxb_boolean *b, uint32_t plane, uint32_t p, uint32_t q, uint32_t r) {
    const gxb_cplane *f = &b->store.planes[plane];
    const gxb_cpoint *x = b->store.points;
    b->store.filter_calls++;
    return f->axis_sign *
           gxbp_filter_turn(&x[p].ball, &x[q].ball, &x[r].ball, (int)(f->axis + 1) % 3, (int)(f->axis + 2) % 3);
}

/* Orientation in a plane. */
static GXBP_APART int gxbp_plane_turn(gxb_boolean *b, uint32_t plane, uint32_t p, uint32_t q, uint32_t r) {
    const int turn = gxbp_plane_turn_by_filter(b, plane, p, q, r);
    if (turn != 0) return turn;
    if (p == q || q == r || r == p) return 0;
    if (gxbp_on_definition_line(b, p, q, r, plane) || gxbp_on_definition_line(b, q, r, p, plane) ||
        gxbp_on_definition_line(b, r, p, q, plane))
        return 0;
    b->store.exact_calls++;
    return gxbp_store_turn(&b->store, p, q, r, plane);
}

/* The same in the plane of the triangulation at work. */
static int gxbp_turn_by_filter(gxb_boolean *b, uint32_t p, uint32_t q, uint32_t r) {
    return gxbp_plane_turn_by_filter(b, b->work.plane, p, q, r);
}

static int gxbp_turn(gxb_boolean *b, uint32_t p, uint32_t q, uint32_t r) {
    return gxbp_plane_turn(b, b->work.plane, p, q, r);
}

static uint32_t gxbp_new_subtriangle(gxb_boolean *b, uint32_t source) {
    gxbp_subtriangle *f;
    if (!GXBP_ROOM(b, mesh.subtriangles, mesh.subtriangle, 1)) return GXB_NONE;
    f = &b->mesh.subtriangles[b->mesh.subtriangle_count];
    f->source = source;
    f->next = b->in.sources[source].subtriangle;
    f->covers = f->state = GXB_NONE;
    b->in.sources[source].subtriangle = b->mesh.subtriangle_count;
    return b->mesh.subtriangle_count++;
}

static void gxbp_set_subtriangle(gxb_boolean *b, uint32_t f, uint32_t p, uint32_t q, uint32_t r) {
    gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
    int k;
    sub->v[0] = p;
    sub->v[1] = q;
    sub->v[2] = r;
    for (k = 0; k < 3; k++) {
        b->points.vertices[sub->v[k]].hint = f;
        b->points.vertices[sub->v[k]].stamp = b->work.stamp;
    }
}

static void gxbp_set_edge(gxb_boolean *b, uint32_t f, int k, uint32_t near, uint32_t labels) {
    b->mesh.subtriangles[f].near[k] = near;
    b->mesh.subtriangles[f].labels[k] = labels;
}

static int gxbp_corner_index(const gxbp_subtriangle *f, uint32_t v) { return f->v[0] == v ? 0 : f->v[1] == v ? 1 : 2; }

/* Tells the neighbour across the edge from p to q (as seen from f) that f is there now. */
static void gxbp_link_neighbour(gxb_boolean *b, uint32_t near, uint32_t p, uint32_t q, uint32_t f) {
    gxbp_subtriangle *n;
    int k;
    if (near == GXB_NONE) return;
    n = &b->mesh.subtriangles[near];
    for (k = 0; k < 3; k++)
        if (n->v[k] == q && n->v[(k + 1) % 3] == p) n->near[k] = f;
}

/* Begins work on a source's (root's) triangulation: its vertices get their present names and hints. */
static void gxbp_open_triangulation(gxb_boolean *b, uint32_t s) {
    uint32_t f;
    int k;
    b->work.plane = b->in.sources[s].plane;
    b->work.stamp++;
    for (f = b->in.sources[s].subtriangle; f != GXB_NONE; f = b->mesh.subtriangles[f].next)
        for (k = 0; k < 3; k++) {
            const uint32_t v = gxbp_same(b, b->mesh.subtriangles[f].v[k]);
            b->mesh.subtriangles[f].v[k] = v;
            b->points.vertices[v].hint = f;
            b->points.vertices[v].stamp = b->work.stamp;
        }
}

/* One half of an edge that x divides: f = (p, q, r) with the edge at k becomes (p, x, r), the new one is (x, q, r). */
static uint32_t gxbp_split_half(gxb_boolean *b, uint32_t f, int k, uint32_t x) {
    const uint32_t g = gxbp_new_subtriangle(b, b->mesh.subtriangles[f].source);
    gxbp_subtriangle old;
    uint32_t p, q, r;
    if (g == GXB_NONE) return GXB_NONE;
    old = b->mesh.subtriangles[f];
    b->mesh.subtriangles[g].state = old.state;
    p = old.v[k];
    q = old.v[(k + 1) % 3];
    r = old.v[(k + 2) % 3];
    gxbp_set_subtriangle(b, f, p, x, r);
    gxbp_set_edge(b, f, 0, GXB_NONE, old.labels[k]);
    gxbp_set_edge(b, f, 1, g, GXBP_LOOSE);
    gxbp_set_edge(b, f, 2, old.near[(k + 2) % 3], old.labels[(k + 2) % 3]);
    gxbp_set_subtriangle(b, g, x, q, r);
    gxbp_set_edge(b, g, 0, GXB_NONE, old.labels[k]);
    gxbp_set_edge(b, g, 1, old.near[(k + 1) % 3], old.labels[(k + 1) % 3]);
    gxbp_set_edge(b, g, 2, f, GXBP_LOOSE);
    gxbp_link_neighbour(b, old.near[(k + 1) % 3], q, r, g);
    return g;
}

static void gxbp_split_side(gxb_boolean *b, uint32_t f, int k, uint32_t x) {
    const uint32_t other = b->mesh.subtriangles[f].near[k], p = b->mesh.subtriangles[f].v[k];
    uint32_t g, h;
    if (!GXBP_ROOM(b, mesh.subtriangles, mesh.subtriangle, 2)) return;
    g = gxbp_split_half(b, f, k, x);
    if (other == GXB_NONE) return;
    k = (gxbp_corner_index(&b->mesh.subtriangles[other], p) + 2) % 3;
    h = gxbp_split_half(b, other, k, x); /* other: (q, x, r'), h: (x, p, r') */
    b->mesh.subtriangles[f].near[0] = h;
    b->mesh.subtriangles[h].near[0] = f;
    b->mesh.subtriangles[g].near[0] = other;
    b->mesh.subtriangles[other].near[0] = g;
}

static void gxbp_split_inside(gxb_boolean *b, uint32_t f, uint32_t x) {
    gxbp_subtriangle old;
    uint32_t part[3];
    int k;
    if (!GXBP_ROOM(b, mesh.subtriangles, mesh.subtriangle, 2)) return;
    old = b->mesh.subtriangles[f];
    part[0] = f;
    part[1] = gxbp_new_subtriangle(b, old.source);
    part[2] = gxbp_new_subtriangle(b, old.source);
    for (k = 0; k < 3; k++) {
        b->mesh.subtriangles[part[k]].state = old.state;
        gxbp_set_subtriangle(b, part[k], old.v[k], old.v[(k + 1) % 3], x);
        gxbp_set_edge(b, part[k], 0, old.near[k], old.labels[k]);
        gxbp_set_edge(b, part[k], 1, part[(k + 1) % 3], GXBP_LOOSE);
        gxbp_set_edge(b, part[k], 2, part[(k + 2) % 3], GXBP_LOOSE);
        gxbp_link_neighbour(b, old.near[k], old.v[k], old.v[(k + 1) % 3], part[k]);
    }
}

static int gxbp_has_label(const gxb_boolean *b, uint32_t list, uint32_t label) {
    for (; list != GXBP_LOOSE && list != GXBP_BARE; list = b->mesh.links[list].next)
        if (b->mesh.links[list].value == label) return 1;
    return 0;
}

static void gxbp_label_edge(gxb_boolean *b, uint32_t f, int k, uint32_t label) {
    const uint32_t old = b->mesh.subtriangles[f].labels[k], near = b->mesh.subtriangles[f].near[k],
                   p = b->mesh.subtriangles[f].v[k];
    uint32_t list;
    if (gxbp_has_label(b, old, label)) return;
    list = gxbp_new_link(b, label, old == GXBP_LOOSE ? GXBP_BARE : old);
    b->mesh.subtriangles[f].labels[k] = list;
    if (near != GXB_NONE)
        b->mesh.subtriangles[near].labels[(gxbp_corner_index(&b->mesh.subtriangles[near], p) + 2) % 3] = list;
}

/* --- along a straight line through a triangulation --- */

/* The line from p to x. If a triangle (source) meets the plane at work along it, a point's side of the line is its side
   of the triangle's plane, times sigma. Else plane is GXB_NONE. */
typedef struct gxbp_line {
    uint32_t p, x, plane, source;
    int sigma;
} gxbp_line;

static GXBP_RARE void gxbp_set_line(gxb_boolean *b, gxbp_line *line, uint32_t s, uint32_t p, uint32_t x, uint32_t label,
                                    int left) {
    int k;
    line->p = p;
    line->x = x;
    line->plane = GXB_NONE;
    line->source = label;
    line->sigma = 1;
    if (label & GXBP_EDGE_LABEL) return;
    if (left != 0) {
        line->plane = b->in.sources[label].plane;
        line->sigma = left;
        return;
    }
    for (k = 0; k < 3; k++) {
        const int side = gxbp_point_side(b, b->in.sources[s].point[k], b->in.sources[label].plane);
        if (side == 0) continue;
        line->plane = b->in.sources[label].plane;
        line->sigma = side * gxbp_turn(b, p, x, b->in.sources[s].point[k]);
        if (line->sigma != 0) return;
    }
    line->plane = GXB_NONE;
}

/* The key of v is an edge and a triangle. Does it put v in triangle t, and not on t's edge j? */
static int gxbp_is_named_in(const gxb_boolean *b, uint32_t v, uint32_t t, uint32_t j) {
    const uint32_t *key = b->points.vertices[v].key, twin = b->in.sources[key[1] / 3].twin[key[1] % 3];
    return key[2] == t || (key[1] / 3 == t && key[1] % 3 != j) || (twin != GXB_NONE && twin / 3 == t && twin % 3 != j);
}

/* The side of a source's plane. All points of a neighbour that are not on the common edge lie on the side of its far
   corner. So the halves of a face that is flat up to rounding need no exact numbers of points computed in them. */
static int gxbp_side_of_source(gxb_boolean *b, uint32_t v, uint32_t s) {
    const uint32_t plane = b->in.sources[s].plane;
    double bound, value;
    int k;
    if (b->store.points[v].kind != GXB_LINE_PLANE || b->points.vertices[v].key[0] != GXB_FROM_EDGE_TRIANGLE)
        return gxbp_point_side(b, v, plane);
    value = gxbp_filter_side(&b->store.points[v].ball, &b->store.planes[plane].filter, &bound);
    if (value > bound || value < -bound) {
        b->store.filter_calls++;
        return value > 0 ? 1 : -1;
    }
    for (k = 0; k < 3; k++) {
        const uint32_t twin = b->in.sources[s].twin[k];
        if (twin != GXB_NONE && gxbp_is_named_in(b, v, twin / 3, twin % 3))
            return gxbp_point_side(b, b->in.sources[twin / 3].point[(twin % 3 + 2) % 3], plane);
    }
    return gxbp_point_side(b, v, plane);
}

/* 1: v lies to the left */
static int gxbp_left(gxb_boolean *b, const gxbp_line *line, uint32_t v) {
    const gxb_cpoint *p = &b->store.points[v];
    if (v == line->p || v == line->x || (p->kind == GXB_LINE_PLANE && p->def[2] == line->plane)) return 0;
    if (line->plane != GXB_NONE) return line->sigma * gxbp_side_of_source(b, v, line->source);
    return gxbp_turn(b, line->p, line->x, v);
}

/* gxbp_left by the filter; 0: it is on the line, or the filter does not settle it */
static int gxbp_left_by_filter(gxb_boolean *b, const gxbp_line *line, uint32_t v) {
    const gxb_store *store = &b->store;
    double value, bound;
    if (line->plane == GXB_NONE) return gxbp_turn_by_filter(b, line->p, line->x, v);
    value = gxbp_filter_side(&store->points[v].ball, &store->planes[line->plane].filter, &bound);
    return line->sigma * gxbp_filter_sign(value, bound);
}

/* Where a line leaves the star of a vertex, which is corner k of subtriangle f. ahead 0: through the opposite edge,
   from u on its right to w on its left. ahead 1: along edge k, to u. ahead 2: along edge k + 2, to w. The rest is for
   the walk around the vertex. side_w: w's side by the filter, 2 if not computed; w is u of the next subtriangle. back
   1: the walk has met the rim, and goes the other way round from its start. */
typedef struct gxbp_way {
    uint32_t f;
    int k, ahead, side_w, back;
} gxbp_way;

static void gxbp_begin_star(const gxb_boolean *b, uint32_t v, gxbp_way *way) {
    way->f = b->points.vertices[v].hint;
    way->k = gxbp_corner_index(&b->mesh.subtriangles[way->f], v);
    way->side_w = 2;
    way->back = 0;
}

/* The next subtriangle around v. 0: there are no more. */
static int gxbp_next_in_star(const gxb_boolean *b, uint32_t v, gxbp_way *way) {
    uint32_t next = way->back ? GXB_NONE : b->mesh.subtriangles[way->f].near[(way->k + 2) % 3];
    if (next == GXB_NONE) {
        if (!way->back) gxbp_begin_star(b, v, way);
        way->back = 1;
        way->side_w = 2;
        next = b->mesh.subtriangles[way->f].near[way->k];
    }
    if (next == GXB_NONE || next == b->points.vertices[v].hint) return 0;
    way->f = next;
    way->k = gxbp_corner_index(&b->mesh.subtriangles[next], v);
    return 1;
}

static int gxbp_try_way(gxb_boolean *b, const gxbp_line *line, gxbp_way *way) {
    const gxbp_subtriangle *f = &b->mesh.subtriangles[way->f];
    const uint32_t u = f->v[(way->k + 1) % 3], w = f->v[(way->k + 2) % 3];
    int side_u = way->side_w == 2 ? gxbp_left_by_filter(b, line, u) : way->side_w, side_w;
    way->side_w = 2;
    if (side_u > 0) return 0;
    side_w = way->side_w = gxbp_left_by_filter(b, line, w);
    if (side_w < 0) return 0;
    if (side_u == 0) side_u = gxbp_left(b, line, u);
    if (side_u > 0) return 0;
    if (side_w == 0) side_w = gxbp_left(b, line, w);
    if (side_u == 0 && side_w > 0) {
        way->ahead = 1;
        return 1;
    }
    if (side_w == 0 && side_u < 0) {
        way->ahead = 2;
        return 1;
    }
    way->ahead = 0;
    return side_u < 0 && side_w > 0;
}

/* Is there an edge from v to goal? It is the way, whatever the signs of the line are. */
static int gxbp_find_edge(const gxb_boolean *b, uint32_t v, uint32_t goal, gxbp_way *way) {
    gxbp_begin_star(b, v, way);
    do {
        const gxbp_subtriangle *f = &b->mesh.subtriangles[way->f];
        way->ahead = f->v[(way->k + 1) % 3] == goal ? 1 : 2;
        if (f->v[(way->k + way->ahead) % 3] == goal) return 1;
    } while (gxbp_next_in_star(b, v, way));
    return 0;
}

static int gxbp_find_way(gxb_boolean *b, const gxbp_line *line, uint32_t v, gxbp_way *way) {
    gxbp_begin_star(b, v, way);
    do
        if (gxbp_try_way(b, line, way)) return 1;
    while (gxbp_next_in_star(b, v, way));
    return 0;
}

/* Where a point of the source lies in its triangulation: at a vertex, on edge k of subtriangle f, or inside f (k -1).
 */
typedef struct gxbp_location {
    uint32_t vertex, f;
    int k;
} gxbp_location;

/* Crosses subtriangles from way's edge on. 1: found. 0: *v is a vertex on the line before the point. */
static int gxbp_cross_subtriangles(gxb_boolean *b, const gxbp_line *line, gxbp_way way, uint32_t *v,
                                   gxbp_location *location) {
    uint32_t f = way.f;
    int k = (way.k + 1) % 3; /* the edge to cross, from u to w */
    uint32_t u = b->mesh.subtriangles[f].v[k], w = b->mesh.subtriangles[f].v[(k + 1) % 3];
    int t = gxbp_turn(b, u, w, line->x);
    for (;;) {
        uint32_t c;
        int side_c, j;
        location->vertex = GXB_NONE;
        location->f = f;
        location->k = t == 0 ? k : -1;
        if (t >= 0) return 1;
        f = b->mesh.subtriangles[f].near[k];
        if (f == GXB_NONE) {
            gxbp_stop(b, GX_ERROR_OVERLAP);
            return 1;
        }
        j = gxbp_corner_index(&b->mesh.subtriangles[f], w); /* (w, u, c) */
        c = b->mesh.subtriangles[f].v[(j + 2) % 3];
        location->f = f;
        location->k = -1;
        if (gxbp_turn_by_filter(b, u, c, line->x) > 0 && gxbp_turn_by_filter(b, c, w, line->x) > 0) return 1;
        side_c = gxbp_left(b, line, c);
        if (side_c < 0) {
            u = c;
            k = (j + 2) % 3;
            t = gxbp_turn(b, c, w, line->x);
        } else {
            k = (j + 1) % 3;
            t = gxbp_turn(b, u, c, line->x);
            if (side_c > 0) w = c;
        }
        if (side_c != 0) continue;
        location->vertex = t == 0 ? c : GXB_NONE;
        location->f = f;
        location->k = -1;
        *v = c;
        return t >= 0;
    }
}

static GXBP_RARE gxbp_location gxbp_locate(gxb_boolean *b, const gxbp_line *line) {
    gxbp_location location;
    uint32_t v = line->p;
    memset(&location, 0, sizeof location);
    while (b->error == GX_OK) {
        gxbp_way way;
        uint32_t ahead;
        int t;
        if (!gxbp_find_way(b, line, v, &way)) {
            gxbp_stop(b, GX_ERROR_OVERLAP);
            break;
        }
        if (way.ahead == 0) {
            if (gxbp_cross_subtriangles(b, line, way, &v, &location)) return location;
            continue;
        }
        ahead = b->mesh.subtriangles[way.f].v[(way.k + way.ahead) % 3];
        t = gxbp_turn(b, b->mesh.subtriangles[way.f].v[(way.k + 1) % 3], b->mesh.subtriangles[way.f].v[(way.k + 2) % 3],
                      line->x);
        location.vertex = t == 0 ? ahead : GXB_NONE;
        location.f = way.f;
        location.k = way.ahead == 1 ? way.k : (way.k + 2) % 3;
        if (t >= 0) return location;
        v = ahead;
    }
    return location;
}

/* Have the keys of two points an edge in common? Then the points are not equal: equal ones were united when the points
 * of the edge were sorted. */
static GXBP_RARE int gxbp_share_edge(const gxb_boolean *b, uint32_t p, uint32_t q) {
    const uint32_t *k = b->points.vertices[p].key, *m = b->points.vertices[q].key;
    if ((k[0] != GXB_FROM_EDGE_TRIANGLE && k[0] != GXB_FROM_EDGE_EDGE) ||
        (m[0] != GXB_FROM_EDGE_TRIANGLE && m[0] != GXB_FROM_EDGE_EDGE))
        return 0;
    return k[1] == m[1] || (k[0] == GXB_FROM_EDGE_EDGE && k[2] == m[1]) ||
           (m[0] == GXB_FROM_EDGE_EDGE && (k[1] == m[2] || (k[0] == m[0] && k[2] == m[2])));
}

/* Does q lie off a plane that contains p by its definition? */
static GXBP_RARE int gxbp_leaves_plane(gxb_boolean *b, uint32_t p, uint32_t q) {
    uint32_t planes[3], count = gxbp_planes_of(b, p, planes), k;
    for (k = 0; k < count; k++)
        if (planes[k] != GXB_NONE && !gxbp_is_in_plane(b, q, planes[k]) && gxbp_point_side(b, q, planes[k]) != 0)
            return 1;
    return 0;
}

static int gxbp_points_equal(gxb_boolean *b, uint32_t p, uint32_t q) {
    const gxb_ball *x = &b->store.points[p].ball, *y = &b->store.points[q].ball;
    const double reach = 2 * (x->error + y->error) + GXBP_TINY;
    uint32_t k;
    for (k = 0; k < 3; k++)
        if (gxbp_abs(gxbp_fence(x->x[k] - y->x[k])) > 2 * reach) return 0;
    if (p == q) return 1;
    if (gxbp_share_edge(b, p, q) || gxbp_leaves_plane(b, p, q)) return 0;
    for (k = 0; k < 3; k++)
        if (gxbp_compare_points(b, p, q, k) != 0) return 0;
    return 1;
}

static int gxbp_is_placed(gxb_boolean *b, uint32_t v) { return b->points.vertices[v].stamp == b->work.stamp; }

/* Makes point x a vertex of the triangulation of source s. The search starts at vertex p. Returns the vertex. */
static uint32_t gxbp_insert_point(gxb_boolean *b, uint32_t s, uint32_t x, uint32_t p, uint32_t label, int left) {
    gxbp_line line;
    gxbp_location location;
    x = gxbp_same(b, x);
    if (gxbp_is_placed(b, x)) return x;
    if (gxbp_points_equal(b, p, x)) {
        gxbp_unite(b, p, x);
        return p;
    }
    gxbp_set_line(b, &line, s, p, x, label, left);
    location = gxbp_locate(b, &line);
    if (b->error != GX_OK) return x;
    if (location.vertex != GXB_NONE) {
        gxbp_unite(b, location.vertex, x);
        return location.vertex;
    }
    if (location.k >= 0)
        gxbp_split_side(b, location.f, location.k, x);
    else
        gxbp_split_inside(b, location.f, x);
    return x;
}

/* >>constrain: constrained edges ----------------------------------------------------------------------------------- */
/* In: two vertices of a triangulation and a label. Out: a path of labelled edges between them. The crossed subtriangles
   are replaced by a triangulation of each side. Touches the subtriangles of this source, links and the two rims. */

/* Appends a vertex to a rim, with the neighbour beyond edge k of f and that edge's labels. */
static void gxbp_push_rim_vertex(gxb_boolean *b, gxbp_rim_vertex **list, uint32_t *count, uint32_t *capacity,
                                 uint32_t vertex, uint32_t f, int k) {
    gxbp_rim_vertex *r;
    if (*count == *capacity && !gxbp_room(b, list, *count, capacity, sizeof **list, 1)) return;
    r = *list + (*count)++;
    r->vertex = vertex;
    r->made = GXB_NONE;
    r->dangling = 0;
    r->near = f == GXB_NONE ? GXB_NONE : b->mesh.subtriangles[f].near[k];
    r->labels = f == GXB_NONE ? GXBP_LOOSE : b->mesh.subtriangles[f].labels[k];
}

/* The apex over the base from rim[high] to rim[low]: no other vertex between them lies in this triangle. */
static uint32_t gxbp_choose_apex(gxb_boolean *b, const gxbp_rim_vertex *rim, uint32_t low, uint32_t high) {
    uint32_t best = low + 1, i;
    for (i = low + 2; i < high; i++) {
        const uint32_t v = rim[i].vertex;
        if (v == rim[best].vertex || v == rim[low].vertex || v == rim[high].vertex) continue;
        if (gxbp_turn(b, rim[low].vertex, rim[best].vertex, v) >= 0 &&
            gxbp_turn(b, rim[best].vertex, rim[high].vertex, v) >= 0)
            best = i;
    }
    return best;
}

/* Joins edge k of f to the neighbour beyond the rim's edge i. Both sides of a dangling edge are in the rim. */
static void gxbp_attach_rim(gxb_boolean *b, gxbp_rim_vertex *rim, uint32_t count, uint32_t i, uint32_t f, int k) {
    uint32_t j;
    gxbp_set_edge(b, f, k, rim[i].near, rim[i].labels);
    if (!rim[i].dangling) {
        gxbp_link_neighbour(b, rim[i].near, rim[i].vertex, rim[i + 1].vertex, f);
        return;
    }
    rim[i].made = f;
    b->mesh.subtriangles[f].near[k] = GXB_NONE;
    for (j = 0; j + 1 < count; j++) {
        if (rim[j].vertex != rim[i + 1].vertex || rim[j + 1].vertex != rim[i].vertex || rim[j].made == GXB_NONE)
            continue;
        b->mesh.subtriangles[f].near[k] = rim[j].made;
        gxbp_link_neighbour(b, rim[j].made, rim[i].vertex, rim[i + 1].vertex, f);
    }
}

/* Triangulates the polygon of rim[low] ... rim[high]. Its subtriangles are the last ones of the crossed list. Returns
 * the one at the base from rim[high] to rim[low]. */
static GXBP_APART uint32_t gxbp_fill_rim(gxb_boolean *b, gxbp_rim_vertex *rim, uint32_t count, uint32_t low,
                                         uint32_t high) {
    const uint32_t apex = gxbp_choose_apex(b, rim, low, high), f = b->work.crossed[--b->work.crossed_count];
    uint32_t g;
    gxbp_set_subtriangle(b, f, rim[high].vertex, rim[low].vertex, rim[apex].vertex);
    gxbp_set_edge(b, f, 0, GXB_NONE, GXBP_LOOSE);
    if (apex == low + 1)
        gxbp_attach_rim(b, rim, count, low, f, 1);
    else {
        g = gxbp_fill_rim(b, rim, count, low, apex);
        gxbp_set_edge(b, f, 1, g, GXBP_LOOSE);
        b->mesh.subtriangles[g].near[0] = f;
    }
    if (apex + 1 == high)
        gxbp_attach_rim(b, rim, count, apex, f, 2);
    else {
        g = gxbp_fill_rim(b, rim, count, apex, high);
        gxbp_set_edge(b, f, 2, g, GXBP_LOOSE);
        b->mesh.subtriangles[g].near[0] = f;
    }
    return f;
}

/* The point where the line of a triangle (label) crosses a constrained edge. */
static GXBP_RARE uint32_t gxbp_crossing_point(gxb_boolean *b, uint32_t s, uint32_t labels, uint32_t label) {
    uint32_t other = GXB_NONE, id[3];
    int is_new;
    for (; other == GXB_NONE && labels != GXBP_BARE; labels = b->mesh.links[labels].next)
        if (!(b->mesh.links[labels].value & GXBP_EDGE_LABEL)) other = b->mesh.links[labels].value;
    if (other == GXB_NONE || label & GXBP_EDGE_LABEL) {
        gxbp_stop(b, GX_ERROR_OVERLAP);
        return GXB_NONE;
    }
    id[0] = s;
    id[1] = label;
    id[2] = other;
    gxbp_sort3(id);
    other = gxbp_keyed_point(b, GXB_FROM_THREE_TRIANGLES, id[0], id[1], id[2], &is_new);
    if (is_new)
        gxbp_place_point(b, other, GXB_THREE_PLANES, b->in.sources[id[0]].plane, b->in.sources[id[1]].plane,
                         b->in.sources[id[2]].plane);
    return other;
}

static void gxbp_push_crossed(gxb_boolean *b, uint32_t f) {
    if (GXBP_ROOM(b, work.crossed, work.crossed, 1)) b->work.crossed[b->work.crossed_count++] = f;
}

/* Lists the subtriangles that the line crosses from way on, up to the first vertex on it, and their rims: on its right,
   with the start vertex, and on its left, without it. 0: the line crosses a constrained edge, which is now divided. */
static int gxbp_collect_crossed(gxb_boolean *b, uint32_t s, const gxbp_line *line, gxbp_way way, uint32_t label) {
    uint32_t f = way.f, u = b->mesh.subtriangles[f].v[(way.k + 1) % 3], w = b->mesh.subtriangles[f].v[(way.k + 2) % 3];
    int k = (way.k + 1) % 3;
    b->work.crossed_count = b->work.right_count = b->work.left_count = 0;
    gxbp_push_rim_vertex(b, &b->work.rights, &b->work.right_count, &b->work.right_capacity,
                         b->mesh.subtriangles[f].v[way.k], f, way.k);
    gxbp_push_rim_vertex(b, &b->work.lefts, &b->work.left_count, &b->work.left_capacity, w, f, (way.k + 2) % 3);
    gxbp_push_crossed(b, f);
    while (b->error == GX_OK) {
        uint32_t c;
        int j, side_c;
        if (b->mesh.subtriangles[f].labels[k] != GXBP_LOOSE) {
            const uint32_t x = gxbp_crossing_point(b, s, b->mesh.subtriangles[f].labels[k], label);
            if (x == GXB_NONE) return 0;
            if (gxbp_is_placed(b, x)) {
                gxbp_stop(b, GX_ERROR_OVERLAP);
                return 0;
            }
            gxbp_split_side(b, f, k, x);
            return 0;
        }
        f = b->mesh.subtriangles[f].near[k];
        if (f == GXB_NONE) {
            gxbp_stop(b, GX_ERROR_OVERLAP);
            return 0;
        }
        gxbp_push_crossed(b, f);
        j = gxbp_corner_index(&b->mesh.subtriangles[f], w);
        c = b->mesh.subtriangles[f].v[(j + 2) % 3];
        side_c = gxbp_left(b, line, c);
        if (side_c <= 0)
            gxbp_push_rim_vertex(b, &b->work.rights, &b->work.right_count, &b->work.right_capacity, u, f, (j + 1) % 3);
        if (side_c >= 0)
            gxbp_push_rim_vertex(b, &b->work.lefts, &b->work.left_count, &b->work.left_capacity, c, f, (j + 2) % 3);
        if (side_c == 0) {
            gxbp_push_rim_vertex(b, &b->work.rights, &b->work.right_count, &b->work.right_capacity, c, GXB_NONE, 0);
            return b->error == GX_OK;
        }
        if (side_c < 0) {
            u = c;
            k = (j + 2) % 3;
        } else {
            w = c;
            k = (j + 1) % 3;
        }
    }
    return 0;
}

#define GXBP_REMOVED (UINT32_MAX - 1)

static void gxbp_find_dangling(const gxb_boolean *b, gxbp_rim_vertex *rim, uint32_t count) {
    uint32_t i;
    for (i = 0; i < count; i++)
        rim[i].dangling = rim[i].near != GXB_NONE && b->mesh.subtriangles[rim[i].near].state == GXBP_REMOVED;
}

/* Replaces the crossed subtriangles by others, with an edge from the start to the vertex in which the right rim ends.
 */
static void gxbp_refill(gxb_boolean *b, uint32_t start) {
    const uint32_t state = b->mesh.subtriangles[b->work.crossed[0]].state; /* that of all: no label is between them */
    uint32_t i, n, f, g;
    for (i = 0; i < b->work.crossed_count; i++) b->mesh.subtriangles[b->work.crossed[i]].state = GXBP_REMOVED;
    gxbp_push_rim_vertex(b, &b->work.lefts, &b->work.left_count, &b->work.left_capacity, start, GXB_NONE, 0);
    if (b->error != GX_OK) return;
    /* the left rim runs backwards: reverse all of it but the start */
    n = b->work.left_count - 1;
    for (i = 0; i < n / 2; i++) {
        const gxbp_rim_vertex swap = b->work.lefts[i];
        b->work.lefts[i] = b->work.lefts[n - 1 - i];
        b->work.lefts[n - 1 - i] = swap;
    }
    gxbp_find_dangling(b, b->work.rights, b->work.right_count);
    gxbp_find_dangling(b, b->work.lefts, b->work.left_count);
    for (i = 0; i < b->work.crossed_count; i++) b->mesh.subtriangles[b->work.crossed[i]].state = state;
    f = gxbp_fill_rim(b, b->work.rights, b->work.right_count, 0, b->work.right_count - 1);
    g = gxbp_fill_rim(b, b->work.lefts, b->work.left_count, 0, b->work.left_count - 1);
    b->mesh.subtriangles[f].near[0] = g;
    b->mesh.subtriangles[g].near[0] = f;
}

static uint32_t gxbp_take_way(gxb_boolean *b, const gxbp_way *way, uint32_t label) {
    const uint32_t ahead = b->mesh.subtriangles[way->f].v[(way->k + way->ahead) % 3];
    gxbp_label_edge(b, way->f, way->ahead == 1 ? way->k : (way->k + 2) % 3, label);
    return ahead;
}

/* Makes p q a labelled edge, or a path of labelled edges where vertices lie on it. */
static void gxbp_force_edge(gxb_boolean *b, uint32_t s, uint32_t p, uint32_t q, uint32_t label, int left) {
    gxbp_line line;
    gxbp_way way;
    /* 1: there is no edge from p to q, by a search since which nothing was refilled */
    int known = 1;
    if (p == q) return;
    if (gxbp_find_edge(b, p, q, &way)) {
        gxbp_take_way(b, &way, label);
        return;
    }
    gxbp_set_line(b, &line, s, p, q, label, left);
    while (p != q && b->error == GX_OK) {
        if ((known || !gxbp_find_edge(b, p, q, &way)) && !gxbp_find_way(b, &line, p, &way)) {
            gxbp_stop(b, GX_ERROR_OVERLAP);
            return;
        }
        known = 0;
        if (way.ahead != 0)
            p = gxbp_take_way(b, &way, label);
        else if (gxbp_collect_crossed(b, s, &line, way, label))
            gxbp_refill(b, p);
        else
            known = 1;
    }
}

/* >>divide: a source that is alone in its plane -------------------------------------------------------------------- */
/* In: a dirty source with its new segments and the points on its edges. Out: its triangulation, with all segments as
   edges. Chains of a simple surface divide an undivided source into polygons. In all other cases segments are inserted
   one by one. */

/* Point i of an edge: its start, its inner points in order, its end. */
static uint32_t gxbp_edge_point(gxb_boolean *b, uint32_t s, uint32_t k, uint32_t i) {
    const uint32_t edge = b->in.sources[s].edge[k], count = edge == GXB_NONE ? 0 : b->crossings.edges[edge].count;
    if (i == 0) return gxbp_same(b, b->in.sources[s].point[k]);
    if (i > count) return gxbp_same(b, b->in.sources[s].point[(k + 1) % 3]);
    return gxbp_same(b,
                     b->crossings.edge_points[b->crossings.edges[edge].first +
                                              (b->crossings.edges[edge].half_edge == 3 * s + k ? i - 1 : count - i)]);
}

static uint32_t gxbp_edge_points(const gxb_boolean *b, uint32_t s, uint32_t k) {
    return 2 + (b->in.sources[s].edge[k] == GXB_NONE ? 0 : b->crossings.edges[b->in.sources[s].edge[k]].count);
}

/* Makes inner point x of an edge a vertex. u: the vertex before it on that edge */
static void gxbp_split_rim(gxb_boolean *b, uint32_t u, uint32_t x) {
    uint32_t f = b->points.vertices[u].hint;
    int j = gxbp_corner_index(&b->mesh.subtriangles[f], u);
    while (b->mesh.subtriangles[f].near[j] != GXB_NONE) {
        f = b->mesh.subtriangles[f].near[j];
        j = gxbp_corner_index(&b->mesh.subtriangles[f], u);
    }
    if (b->mesh.subtriangles[f].v[(j + 1) % 3] != x) gxbp_split_side(b, f, j, x);
}

/* Makes all inner points of edge k vertices */
static void gxbp_divide_rim(gxb_boolean *b, uint32_t s, uint32_t k) {
    const uint32_t points = gxbp_edge_points(b, s, k);
    uint32_t i;
    for (i = 1; i + 1 < points && b->error == GX_OK; i++)
        gxbp_split_rim(b, gxbp_edge_point(b, s, k, i - 1), gxbp_edge_point(b, s, k, i));
}

/* Records in rim_place which inner point of which edge of the source an end of a segment is; GXB_NONE: it is none. */
static void gxbp_find_rim_ends(gxb_boolean *b, uint32_t s, uint32_t n) {
    uint32_t i, k;
    for (i = 0; i < n; i++) {
        const gxbp_segment *segment = &b->crossings.segments[b->work.segment_ends[3 * i]];
        b->points.vertices[gxbp_same(b, segment->p)].rim_place =
            b->points.vertices[gxbp_same(b, segment->q)].rim_place = GXB_NONE;
    }
    for (k = 0; k < 3; k++)
        for (i = 1; i + 1 < gxbp_edge_points(b, s, k); i++)
            b->points.vertices[gxbp_edge_point(b, s, k, i)].rim_place = 3 * i + k;
}

/* Is the end of a segment in the triangulation? One on the rim is inserted here, when a segment needs it: earlier it
   would only add subtriangles for segments to cross. */
static int gxbp_enter(gxb_boolean *b, uint32_t s, uint32_t v) {
    const uint32_t k = b->points.vertices[v].rim_place % 3;
    uint32_t i = b->points.vertices[v].rim_place / 3, u;
    if (gxbp_is_placed(b, v)) return 1;
    if (b->points.vertices[v].rim_place == GXB_NONE) return 0;
    do u = gxbp_edge_point(b, s, k, --i);
    while (!gxbp_is_placed(b, u));
    gxbp_split_rim(b, u, v);
    return b->error == GX_OK;
}

/* A segment that ends in v and is not inserted yet, from the lists of gxbp_chain_segments. */
static uint32_t gxbp_next_segment(const gxb_boolean *b, uint32_t v) {
    uint32_t e = b->points.vertices[v].head_stamp == b->work.head_stamp ? b->points.vertices[v].head : GXB_NONE;
    while (e != GXB_NONE && b->work.segment_ends[3 * (e / 2)] == GXB_NONE)
        e = b->work.segment_ends[3 * (e / 2) + 1 + e % 2];
    return e == GXB_NONE ? GXB_NONE : e / 2;
}

/* Lists the source's new segments by their ends. A record of b->work.segment_ends is a segment and, for each of its
   ends, the next end 2 i + e in the list of that vertex. Vertices hold the heads. Returns the number of segments. */
static uint32_t gxbp_chain_segments(gxb_boolean *b, uint32_t s) {
    uint32_t i, n = 0;
    b->work.segment_end_count = 0;
    b->work.head_stamp++;
    for (i = b->in.sources[s].segments; i != GXB_NONE && i >= b->crossings.segment_mark;
         i = b->crossings.segments[i].next) {
        uint32_t e;
        if (!GXBP_ROOM(b, work.segment_ends, work.segment_end, 3)) return 0;
        b->work.segment_ends[3 * n] = i;
        for (e = 0; e < 2; e++) {
            gxbp_vertex *v =
                &b->points.vertices[gxbp_same(b, e == 0 ? b->crossings.segments[i].p : b->crossings.segments[i].q)];
            b->work.segment_ends[3 * n + 1 + e] = v->head_stamp == b->work.head_stamp ? v->head : GXB_NONE;
            v->head_stamp = b->work.head_stamp;
            v->head = 2 * n + e;
        }
        b->work.segment_end_count += 3;
        n++;
    }
    return n;
}

/* Inserts segments from segment i on, so that each begins where the last one ended. */
static void gxbp_trace_segments(gxb_boolean *b, uint32_t s, uint32_t i) {
    const gxbp_segment *first = &b->crossings.segments[b->work.segment_ends[3 * i]];
    uint32_t v = gxbp_same(b, first->p);
    if (!gxbp_enter(b, s, v) && gxbp_enter(b, s, gxbp_same(b, first->q))) v = gxbp_same(b, first->q);
    if (!gxbp_is_placed(b, v))
        v = gxbp_insert_point(b, s, v, gxbp_same(b, b->in.sources[s].point[0]), GXBP_EDGE_LABEL, 0);
    for (; i != GXB_NONE && b->error == GX_OK; i = gxbp_next_segment(b, v)) {
        const gxbp_segment segment = b->crossings.segments[b->work.segment_ends[3 * i]];
        const int forward = gxbp_same(b, segment.p) == v;
        const uint32_t other = gxbp_same(b, forward ? segment.q : segment.p);
        const int left = forward ? segment.left : -segment.left;
        uint32_t end = other;
        b->work.segment_ends[3 * i] = GXB_NONE;
        if (!gxbp_enter(b, s, other)) end = gxbp_insert_point(b, s, other, v, segment.label, left);
        if (b->error == GX_OK) gxbp_force_edge(b, s, v, end, segment.label, left);
        v = end;
    }
}

/* Lists a source's subtriangles as changed, if there is a result that shows them. */
static void gxbp_list_changed(gxb_boolean *b, uint32_t s) {
    uint32_t f;
    if (b->out.shown_count == 0) return;
    for (f = b->in.sources[s].subtriangle; f != GXB_NONE; f = b->mesh.subtriangles[f].next)
        if (GXBP_ROOM(b, mesh.changed, mesh.changed, 1)) b->mesh.changed[b->mesh.changed_count++] = f;
}

static void gxbp_note_divided(gxb_boolean *b, uint32_t s) { b->in.sources[s].flags |= GXBP_DIVIDED; }

/* --- dividing a source by chains: the generic small case --- */

/* The source is undivided. All segments are of one simple surface. Each chain leads from rim to rim, and none touches
   another. So chains divide the source into polygons, which are triangulated by cutting off ears. Bends are known
   without predicates except at the chains' inner points. */
enum { GXBP_SMALL = 24 }; /* the most rim points and segments; with more, the general way is taken */

/* A vertex of a polygon, whose inside is to the left. on: the edges of the source that contain it, as bits. slot: of
   the edge to the next vertex. On the rim it is GXB_NONE; at the start of the source's edge k it is GXBP_RIM + k. bend:
   1 convex, 0 straight, -1 reflex. before, after: in gxbp_division.polygon */
#define GXBP_RIM (UINT32_MAX - 3)
typedef struct gxbp_polygon_vertex {
    uint32_t vertex, on, slot;
    int bend;
    uint32_t before, after;
} gxbp_polygon_vertex;
/* A chain: its segments in gxbp_division.step, and the rim points at its two ends */
typedef struct gxbp_chain {
    uint32_t first, count, from, to;
} gxbp_chain;

typedef struct gxbp_division {
    uint32_t source, spare, state; /* spare: the source's only subtriangle, until it is used */
    gxbp_polygon_vertex rim[GXBP_SMALL];
    uint32_t rim_count;
    uint32_t corner[3]; /* places of the source's corners in the rim */
    /* records of the source's edges; other 1: the record's half-edge is that of the neighbour */
    uint32_t edge[3], other[3];
    uint32_t chain_at[GXBP_SMALL]; /* for each rim point: the chain that ends there, or GXB_NONE */
    gxbp_chain chains[GXBP_SMALL];
    uint32_t chain_count;
    /* of each step along a chain: the point that it leaves; its segment, by the place in b->work.segment_ends */
    gxbp_polygon_vertex step[GXBP_SMALL];
    uint32_t segment[GXBP_SMALL];
    uint32_t step_count, labels; /* the segments' links, one after the other */
    gxbp_polygon_vertex polygon[GXBP_SMALL];
    /* for each step, then for each diagonal: the edge 3 f + k of the first subtriangle there */
    uint32_t half[4 * GXBP_SMALL];
    uint32_t slot_count;
} gxbp_division;

static int gxbp_is_generic(const gxb_boolean *b, uint32_t s, uint32_t n) {
    uint32_t i, operand;
    if (n > GXBP_SMALL || b->mesh.subtriangles[b->in.sources[s].subtriangle].next != GXB_NONE) return 0;
    for (i = 0; i < n; i++) {
        const gxbp_segment *segment = &b->crossings.segments[b->work.segment_ends[3 * i]];
        operand = b->in.sources[segment->label].operand;
        if (segment->left == 0 || !b->in.operands[operand].simple ||
            operand != b->in.sources[b->crossings.segments[b->work.segment_ends[0]].label].operand)
            return 0;
    }
    return 1;
}

/* Lists the rim points. Stamps mark them, and hints are their places in the list. 0: there are too many, or two are
   equal. */
static int gxbp_collect_rim(gxb_boolean *b, gxbp_division *d, uint32_t n) {
    const uint32_t s = d->source;
    uint32_t k, i, on;
    d->rim_count = 0;
    b->work.stamp++;
    for (k = 0; k < 3; k++) {
        const uint32_t count = gxbp_edge_points(b, s, k) - 1;
        if (d->rim_count + count + n > GXBP_SMALL) return 0;
        d->corner[k] = d->rim_count;
        on = 1u << k | 1u << (k == 0 ? 2 : k - 1);
        for (i = 0; i < count; i++, on = 1u << k) {
            gxbp_polygon_vertex *added = &d->rim[d->rim_count];
            added->vertex = gxbp_edge_point(b, s, k, i);
            if (gxbp_is_placed(b, added->vertex)) return 0;
            b->points.vertices[added->vertex].stamp = b->work.stamp;
            b->points.vertices[added->vertex].hint = d->rim_count;
            added->on = on;
            added->bend = i == 0;
            added->slot = GXB_NONE;
            d->chain_at[d->rim_count++] = GXB_NONE;
        }
    }
    return 1;
}

/* Marks the rim points from which the edges at the starts of the records' half-edges leave. 0: no memory */
static int gxbp_mark_starts(gxb_boolean *b, gxbp_division *d) {
    uint32_t k;
    for (k = 0; k < 3; k++) {
        const uint32_t edge = d->edge[k] = gxbp_need_surface_edge(b, d->source, (int)k),
                       end = d->corner[k == 2 ? 0 : k + 1];
        if (edge == GXB_NONE) return 0;
        d->other[k] = b->crossings.edges[edge].half_edge != 3 * d->source + k;
        d->rim[!d->other[k] ? d->corner[k] : (end == 0 ? d->rim_count : end) - 1].slot = GXBP_RIM + k;
    }
    return 1;
}

/* The other end 2 i + e at an inner point of a chain (see gxbp_chain_segments). GXB_NONE: there are not two ends */
static uint32_t gxbp_other_end(const gxb_boolean *b, uint32_t v, uint32_t end) {
    const uint32_t first = b->points.vertices[v].head, second = b->work.segment_ends[3 * (first / 2) + 1 + first % 2];
    if (second == GXB_NONE || b->work.segment_ends[3 * (second / 2) + 1 + second % 2] != GXB_NONE) return GXB_NONE;
    return first == end ? second : first;
}

/* Follows the chain that leaves a rim point by an end of a segment. 0: it does not lead to another part of the rim. */
static GXBP_APART int gxbp_follow_chain(gxb_boolean *b, gxbp_division *d, uint32_t from, uint32_t end, uint32_t n) {
    gxbp_chain *chain = &d->chains[d->chain_count];
    uint32_t v = d->rim[from].vertex;
    chain->first = d->step_count;
    chain->from = from;
    while (end != GXB_NONE && d->step_count < n) {
        const gxbp_segment *segment = &b->crossings.segments[b->work.segment_ends[3 * (end / 2)]];
        d->step[d->step_count].vertex = v;
        d->segment[d->step_count++] = end / 2;
        end ^= 1;
        v = gxbp_same(b, end % 2 == 0 ? segment->p : segment->q);
        if (gxbp_is_placed(b, v)) {
            const uint32_t to = b->points.vertices[v].hint;
            chain->to = to;
            chain->count = d->step_count - chain->first;
            if (d->chain_at[to] != GXB_NONE || to == from || (chain->count == 1 && d->rim[from].on & d->rim[to].on))
                return 0;
            d->chain_at[from] = d->chain_at[to] = d->chain_count++;
            d->rim[from].bend = d->rim[to].bend = 1;
            return 1;
        }
        end = gxbp_other_end(b, v, end);
    }
    return 0;
}

/* 1: v lies left of segment i (see gxbp_chain_segments), walked from p to q. v is neither of these. */
static int gxbp_left_of_segment(gxb_boolean *b, uint32_t i, uint32_t p, uint32_t q, uint32_t v) {
    const gxbp_segment *segment = &b->crossings.segments[b->work.segment_ends[3 * i]];
    gxbp_line line;
    line.p = p;
    line.x = q;
    line.plane = b->in.sources[segment->label].plane;
    line.source = segment->label;
    line.sigma = gxbp_same(b, segment->p) == p ? segment->left : -segment->left;
    return gxbp_left(b, &line, v);
}

/* The bend of a chain at the start of its step m, between the step before and the point next. Where the chain crosses
 * an edge of the other surface, it bends as the surface is folded there. */
static int gxbp_bend_of_chain(gxb_boolean *b, const gxbp_division *d, uint32_t m, uint32_t next) {
    const uint32_t from = d->step[m - 1].vertex, middle = d->step[m].vertex;
    const gxbp_segment *segment = &b->crossings.segments[b->work.segment_ends[3 * d->segment[m - 1]]];
    const uint32_t *key = b->points.vertices[middle].key, t = segment->label,
                   u = b->crossings.segments[b->work.segment_ends[3 * d->segment[m]]].label;
    const uint32_t twin = key[0] == GXB_FROM_EDGE_TRIANGLE ? b->in.sources[key[1] / 3].twin[key[1] % 3] : GXB_NONE;
    if (twin == GXB_NONE || !((key[1] / 3 == t && twin / 3 == u) || (key[1] / 3 == u && twin / 3 == t)))
        return gxbp_left_of_segment(b, d->segment[m - 1], from, middle, next);
    return gxbp_fold(b, key[1], twin / 3, twin % 3) *
           (gxbp_same(b, segment->p) == from ? segment->left : -segment->left);
}

static GXBP_APART int gxbp_collect_chains(gxb_boolean *b, gxbp_division *d, uint32_t n) {
    uint32_t i, m;
    d->chain_count = d->step_count = 0;
    for (i = 0; i < d->rim_count; i++) {
        const gxbp_vertex *v = &b->points.vertices[d->rim[i].vertex];
        if (v->head_stamp != b->work.head_stamp) continue;
        if (b->work.segment_ends[3 * (v->head / 2) + 1 + v->head % 2] != GXB_NONE) return 0;
        if (d->chain_at[i] == GXB_NONE && !gxbp_follow_chain(b, d, i, v->head, n)) return 0;
    }
    if (d->step_count < n) return 0;
    for (i = 0; i < d->chain_count; i++)
        for (m = d->chains[i].first + 1; m < d->chains[i].first + d->chains[i].count; m++) {
            const int last = m + 1 == d->chains[i].first + d->chains[i].count;
            d->step[m].on = 0;
            d->step[m].bend =
                gxbp_bend_of_chain(b, d, m, last ? d->rim[d->chains[i].to].vertex : d->step[m + 1].vertex);
        }
    return 1;
}

/* 1: p comes before q along an edge (bit) of the source; -1: after it */
static int gxbp_along_rim(const gxb_boolean *b, const gxbp_division *d, const gxbp_polygon_vertex *p,
                          const gxbp_polygon_vertex *q, uint32_t edge) {
    const uint32_t first = d->corner[edge >> 1], i = b->points.vertices[p->vertex].hint,
                   j = b->points.vertices[q->vertex].hint;
    return (i < first ? i + d->rim_count : i) < (j < first ? j + d->rim_count : j) ? 1 : -1;
}

/* gxbp_polygon_turn by the segment from p to q, as the side of its plane; GXBP_UNKNOWN: there is no segment */
static int gxbp_turn_by_segment(gxb_boolean *b, const gxbp_division *d, const gxbp_polygon_vertex *p,
                                const gxbp_polygon_vertex *q, const gxbp_polygon_vertex *r) {
    if (p->slot >= d->step_count || &d->polygon[p->after] != q) return GXBP_UNKNOWN;
    return gxbp_left_of_segment(b, d->segment[p->slot], p->vertex, q->vertex, r->vertex);
}

static GXBP_COLD int gxbp_turn_by_segments(gxb_boolean *b, const gxbp_division *d, const gxbp_polygon_vertex *p,
                                           const gxbp_polygon_vertex *q, const gxbp_polygon_vertex *r) {
    int turn = gxbp_turn_by_segment(b, d, p, q, r);
    if (turn == GXBP_UNKNOWN) turn = gxbp_turn_by_segment(b, d, q, r, p);
    if (turn == GXBP_UNKNOWN) turn = gxbp_turn_by_segment(b, d, r, p, q);
    return turn == GXBP_UNKNOWN ? gxbp_turn(b, p->vertex, q->vertex, r->vertex) : turn;
}

/* Orientation of three vertices. Two on one edge of the source determine it: the third one is not right of that edge.
 */
static GXBP_RARE int gxbp_polygon_turn(gxb_boolean *b, const gxbp_division *d, const gxbp_polygon_vertex *p,
                                       const gxbp_polygon_vertex *q, const gxbp_polygon_vertex *r) {
    const uint32_t pq = p->on & q->on, qr = q->on & r->on, rp = r->on & p->on;
    int turn;
    if (pq & r->on) return 0;
    if (pq) return gxbp_along_rim(b, d, p, q, pq);
    if (qr) return gxbp_along_rim(b, d, q, r, qr);
    if (rp) return gxbp_along_rim(b, d, r, p, rp);
    turn = gxbp_turn_by_filter(b, p->vertex, q->vertex, r->vertex);
    return turn != 0 ? turn : gxbp_turn_by_segments(b, d, p, q, r);
}

/* Does w lie right of the edge from p to q? */
static int gxbp_is_beyond(gxb_boolean *b, const gxbp_division *d, const gxbp_polygon_vertex *p,
                          const gxbp_polygon_vertex *q, const gxbp_polygon_vertex *w) {
    if (p->slot >= d->step_count) return gxbp_polygon_turn(b, d, p, q, w) < 0;
    return gxbp_left_of_segment(b, d->segment[p->slot], p->vertex, q->vertex, w->vertex) < 0;
}

/* Is no other vertex in the triangle of a convex vertex? If others are, one of them is not convex. The fourth one of a
 * quadrilateral is in it if it is not convex. */
static int gxbp_is_ear(gxb_boolean *b, const gxbp_division *d, const gxbp_polygon_vertex *q) {
    const gxbp_polygon_vertex *p = &d->polygon[q->before], *r = &d->polygon[q->after], *w;
    if (r->after == p->before) return d->polygon[r->after].bend > 0;
    for (w = &d->polygon[r->after]; w != p; w = &d->polygon[w->after])
        if (w->bend <= 0 && !(w->before == q->after && r->bend < 0) && !(w->after == q->before && p->bend < 0) &&
            !gxbp_is_beyond(b, d, p, q, w) && !gxbp_is_beyond(b, d, q, r, w) && gxbp_polygon_turn(b, d, r, p, w) >= 0)
            return 0;
    return 1;
}

/* Enters edge k of a subtriangle in a slot. The second subtriangle of a slot becomes the first one's neighbour. */
static inline void gxbp_use_slot(gxb_boolean *b, gxbp_division *d, uint32_t f, uint32_t k, uint32_t slot) {
    gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
    uint32_t other;
    sub->near[k] = GXB_NONE;
    sub->labels[k] = GXBP_BARE;
    if (slot >= GXBP_RIM) {
        if (slot != GXB_NONE) b->crossings.edges[d->edge[slot - GXBP_RIM]].rim[d->other[slot - GXBP_RIM]] = 3 * f + k;
        return;
    }
    sub->labels[k] = slot < d->step_count ? d->labels + slot : GXBP_LOOSE;
    other = d->half[slot];
    d->half[slot] = 3 * f + k;
    if (other == GXB_NONE) return;
    sub->near[k] = other / 3;
    b->mesh.subtriangles[other / 3].near[other % 3] = f;
}

static void gxbp_cut_ear(gxb_boolean *b, gxbp_division *d, gxbp_polygon_vertex *p, const gxbp_polygon_vertex *q,
                         const gxbp_polygon_vertex *r, uint32_t slot) {
    const uint32_t f = d->spare != GXB_NONE ? d->spare : gxbp_new_subtriangle(b, d->source);
    gxbp_subtriangle *sub;
    if (f == GXB_NONE) return;
    d->spare = GXB_NONE;
    sub = &b->mesh.subtriangles[f];
    sub->v[0] = p->vertex;
    sub->v[1] = q->vertex;
    sub->v[2] = r->vertex;
    sub->state = d->state;
    gxbp_use_slot(b, d, f, 0, p->slot);
    gxbp_use_slot(b, d, f, 1, q->slot);
    gxbp_use_slot(b, d, f, 2, slot);
}

/* Renews a vertex's bend after a neighbour was cut off: only a reflex one may stay reflex. Returns 1 if it became
   convex. */
static uint32_t gxbp_bend_again(gxb_boolean *b, gxbp_division *d, gxbp_polygon_vertex *v) {
    const int old = v->bend;
    v->bend = old >= 0 ? 1 : gxbp_polygon_turn(b, d, &d->polygon[v->before], v, &d->polygon[v->after]);
    return old <= 0 && v->bend > 0;
}

/* Triangulates the polygon by cutting off ears. Those beside vertices that are not convex come first, since a chain
   that is almost straight makes other ears thin. */
static GXBP_APART void gxbp_fill_polygon(gxb_boolean *b, gxbp_division *d, uint32_t n) {
    gxbp_polygon_vertex *polygon = d->polygon, *q = polygon, *p, *r;
    uint32_t i, tried = 0, concave = 0;
    for (i = 0; i < n; i++) {
        polygon[i].before = i == 0 ? n - 1 : i - 1;
        polygon[i].after = i + 1 == n ? 0 : i + 1;
        concave += polygon[i].bend <= 0;
    }
    for (; b->error == GX_OK; q = r) {
        p = &polygon[q->before];
        r = &polygon[q->after];
        if (n > 3) {
            if (tried++ > 2 * n) gxbp_stop(b, GX_ERROR_OVERLAP);
            if (q->bend <= 0 || (concave > 0 && ((tried <= n && p->bend > 0 && r->bend > 0) || !gxbp_is_ear(b, d, q))))
                continue;
            d->half[d->slot_count] = GXB_NONE;
        }
        gxbp_cut_ear(b, d, p, q, r, n == 3 ? r->slot : d->slot_count);
        if (n == 3) return;
        p->slot = d->slot_count++;
        p->after = q->after;
        r->before = q->before;
        concave -= gxbp_bend_again(b, d, p) + gxbp_bend_again(b, d, r);
        tried = 0;
        n--;
    }
}

/* Appends a chain, from rim point i on, to the polygon. Returns the rim point in which it ends. */
static uint32_t gxbp_walk_chain(gxbp_division *d, uint32_t i, uint32_t *n) {
    const gxbp_chain *chain = &d->chains[d->chain_at[i]];
    const int forward = chain->from == i;
    uint32_t m;
    d->polygon[*n] = d->rim[i];
    d->polygon[(*n)++].slot = forward ? chain->first : chain->first + chain->count - 1;
    for (m = 1; m < chain->count; m++) {
        const uint32_t step = chain->first + (forward ? m : chain->count - m);
        gxbp_polygon_vertex *added = &d->polygon[(*n)++];
        *added = d->step[step];
        added->slot = forward ? step : step - 1;
        if (!forward) added->bend = -added->bend;
    }
    return forward ? chain->to : chain->from;
}

/* Each polygon has an edge on the rim. Walks the rim for those that are not done yet. A chain is between two polygons,
   and so there is room for each of them, unless it crosses another one: then the surface is not simple. */
static GXBP_APART void gxbp_fill_polygons(gxb_boolean *b, gxbp_division *d) {
    uint32_t done = 0, walked, start, i, n;
    for (start = 0; start < d->rim_count; start++) {
        if (done >> start & 1) continue;
        i = start;
        n = walked = 0;
        do {
            done |= 1u << i;
            d->polygon[n++] = d->rim[i];
            i = i + 1 == d->rim_count ? 0 : i + 1;
            if (d->chain_at[i] == GXB_NONE) continue;
            if (walked >> d->chain_at[i] & 1) {
                gxbp_stop(b, GX_ERROR_OVERLAP);
                return;
            }
            walked |= 1u << d->chain_at[i];
            i = gxbp_walk_chain(d, i, &n);
        } while (i != start);
        gxbp_fill_polygon(b, d, n);
    }
}

/* Returns 0 if this is not the generic case; nothing is divided then. */
static GXBP_APART int gxbp_divide_by_chains(gxb_boolean *b, uint32_t s, uint32_t n) {
    gxbp_division d;
    uint32_t i;
    if (!gxbp_is_generic(b, s, n)) return 0;
    d.source = s;
    b->work.plane = b->in.sources[s].plane;
    if (!gxbp_collect_rim(b, &d, n) || !gxbp_collect_chains(b, &d, n)) return 0;
    if (!GXBP_ROOM(b, mesh.links, mesh.link, n) || !gxbp_mark_starts(b, &d)) return 1;
    for (i = 0; i < n; i++) {
        gxbp_new_link(b, b->crossings.segments[b->work.segment_ends[3 * d.segment[i]]].label, GXBP_BARE);
        d.half[i] = GXB_NONE;
    }
    d.slot_count = n;
    d.labels = b->mesh.link_count - n;
    d.spare = b->in.sources[s].subtriangle;
    d.state = b->mesh.subtriangles[d.spare].state;
    gxbp_fill_polygons(b, &d);
    return 1;
}

/* Records the subtriangles at the starts of a source's edges. If the record's half-edge is the neighbour's, the start
 * is the edge's second corner. */
static void gxbp_note_rims(gxb_boolean *b, uint32_t s) {
    uint32_t leaves[3], comes[3], *rim[3], edge[3], f, k, j;
    for (k = 0; k < 3; k++)
        if ((edge[k] = gxbp_need_surface_edge(b, s, (int)k)) == GXB_NONE) return;
    for (k = 0; k < 3; k++) {
        const int other = b->crossings.edges[edge[k]].half_edge != 3 * s + k;
        leaves[k] = other ? GXB_NONE : gxbp_same(b, b->in.sources[s].point[k]);
        comes[k] = other ? gxbp_same(b, b->in.sources[s].point[(k + 1) % 3]) : GXB_NONE;
        rim[k] = &b->crossings.edges[edge[k]].rim[other];
    }
    for (f = b->in.sources[s].subtriangle; f != GXB_NONE; f = b->mesh.subtriangles[f].next) {
        const gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
        for (j = 0; j < 3; j++) {
            const uint32_t p = sub->v[j], q = sub->v[j == 2 ? 0 : j + 1];
            if (sub->near[j] == GXB_NONE)
                for (k = 0; k < 3; k++)
                    if (p == leaves[k] || q == comes[k]) *rim[k] = 3 * f + j;
        }
    }
}

/* Inserts segments one by one, first those with an end in the triangulation or on the rim */
static GXBP_APART void gxbp_divide_by_segments(gxb_boolean *b, uint32_t s, uint32_t n) {
    uint32_t i, k, pass;
    gxbp_open_triangulation(b, s);
    gxbp_find_rim_ends(b, s, n);
    for (pass = 0; pass < 2; pass++)
        for (i = 0; i < n && b->error == GX_OK; i++) {
            const gxbp_segment *segment;
            if (b->work.segment_ends[3 * i] == GXB_NONE) continue;
            segment = &b->crossings.segments[b->work.segment_ends[3 * i]];
            if (pass == 1 || gxbp_enter(b, s, gxbp_same(b, segment->p)) || gxbp_enter(b, s, gxbp_same(b, segment->q)))
                gxbp_trace_segments(b, s, i);
        }
    for (k = 0; k < 3; k++) gxbp_divide_rim(b, s, k);
}

static void gxbp_divide_source(gxb_boolean *b, uint32_t s) {
    uint32_t n;
    if (!gxbp_need_plane(b, s)) return;
    gxbp_list_changed(b, s);
    gxbp_note_divided(b, s);
    n = gxbp_chain_segments(b, s);
    if (b->error != GX_OK) return;
    if (gxbp_divide_by_chains(b, s, n)) return;
    gxbp_divide_by_segments(b, s, n);
    if (b->error == GX_OK) gxbp_note_rims(b, s);
}

/* >>flats: sources that overlap in one plane ----------------------------------------------------------------------- */
/* In: dirty sources. Out: their triangulations. Sources that overlap in one plane form a flat: they are divided
   together, within a frame around them, and each subtriangle lists the sources that cover it. */

/* A corner of the frame: where a line along the plane's axis meets it. */
static GXBP_COLD uint32_t gxbp_frame_corner(gxb_boolean *b, uint32_t plane, double x, double y) {
    const uint32_t axis = b->store.planes[plane].axis;
    uint32_t id[3], k;
    for (k = 0; k < 3; k++) {
        id[k] = gxbp_new_vertex(b, GXB_FROM_VERTEX, GXB_NONE, GXB_NONE, 0);
        if (id[k] == GXB_NONE) return GXB_NONE;
    }
    for (k = 0; k < 2; k++) {
        gxb_cpoint *p = &b->store.points[id[k]];
        p->ball.x[axis] = k;
        p->ball.x[(axis + 1) % 3] = x;
        p->ball.x[(axis + 2) % 3] = y;
        p->ball.error = 0;
        p->def[0] = id[k];
    }
    gxbp_place_point(b, id[2], GXB_LINE_PLANE, id[0], id[1], plane);
    return id[2];
}

static GXBP_COLD void gxbp_make_frame(gxb_boolean *b, uint32_t r) {
    const uint32_t plane = b->in.sources[r].plane, i = (b->store.planes[plane].axis + 1u) % 3,
                   j = (b->store.planes[plane].axis + 2u) % 3;
    uint32_t t, k, corner[4], f, g;
    double low[3], high[3], dx, dy;
    gxbp_extent(b, r, low, high);
    for (t = b->in.sources[r].next; t != GXB_NONE; t = b->in.sources[t].next) {
        double its_low[3], its_high[3];
        gxbp_extent(b, t, its_low, its_high);
        for (k = 0; k < 3; k++) {
            low[k] = gxbp_min(its_low[k], low[k]);
            high[k] = gxbp_max(its_high[k], high[k]);
        }
    }
    dx = gxbp_fence(high[i] - low[i]);
    dy = gxbp_fence(high[j] - low[j]);
    corner[0] = gxbp_frame_corner(b, plane, low[i] - dx, low[j] - dy);
    corner[1] = gxbp_frame_corner(b, plane, high[i] + dx, low[j] - dy);
    corner[2] = gxbp_frame_corner(b, plane, high[i] + dx, high[j] + dy);
    corner[3] = gxbp_frame_corner(b, plane, low[i] - dx, high[j] + dy);
    f = gxbp_new_subtriangle(b, r);
    g = gxbp_new_subtriangle(b, r);
    if (b->error != GX_OK) return;
    if (b->store.planes[plane].axis_sign < 0) {
        t = corner[1];
        corner[1] = corner[3];
        corner[3] = t;
    }
    gxbp_set_subtriangle(b, f, corner[0], corner[1], corner[2]);
    gxbp_set_subtriangle(b, g, corner[0], corner[2], corner[3]);
    for (t = 0; t < 3; t++) {
        gxbp_set_edge(b, f, (int)t, GXB_NONE, GXBP_BARE);
        gxbp_set_edge(b, g, (int)t, GXB_NONE, GXBP_BARE);
    }
    gxbp_set_edge(b, f, 2, g, GXBP_LOOSE);
    gxbp_set_edge(b, g, 0, f, GXBP_LOOSE);
}

/* Inserts each edge before the points of the next one, so that searches stay short. Returns the last vertex. */
static GXBP_RARE uint32_t gxbp_place_flat_edges(gxb_boolean *b, uint32_t r) {
    uint32_t last = b->mesh.subtriangles[b->in.sources[r].subtriangle].v[0], t, k, i;
    for (t = r; t != GXB_NONE; t = b->in.sources[t].next)
        for (k = 0; k < 3; k++)
            for (i = 0; i < gxbp_edge_points(b, t, k) && b->error == GX_OK; i++) {
                const uint32_t v = last;
                last = gxbp_insert_point(b, r, gxbp_edge_point(b, t, k, i), v, GXBP_EDGE_LABEL, 0);
                if (i > 0 && b->error == GX_OK)
                    gxbp_force_edge(b, r, v, last, gxbp_edge_name(b, t, (int)k) | GXBP_EDGE_LABEL, 0);
            }
    return last;
}

static GXBP_RARE void gxbp_place_flat_segments(gxb_boolean *b, uint32_t r, uint32_t last) {
    uint32_t t, i;
    for (t = r; t != GXB_NONE; t = b->in.sources[t].next)
        for (i = b->in.sources[t].segments; i != GXB_NONE && b->error == GX_OK; i = b->crossings.segments[i].next) {
            const gxbp_segment segment = b->crossings.segments[i];
            const uint32_t v = gxbp_insert_point(b, r, segment.p, last, GXBP_EDGE_LABEL, 0);
            if (b->error != GX_OK) return;
            last = gxbp_insert_point(b, r, segment.q, v, GXBP_EDGE_LABEL, 0);
            if (b->error == GX_OK) gxbp_force_edge(b, r, v, last, segment.label, 0);
        }
}

/* 1: t faces as the plane's normal does. */
static int gxbp_facing(const gxb_boolean *b, uint32_t r, uint32_t t) {
    return r == t ? 1
                  : gxbp_flat_turn(b, b->in.sources[r].plane, gxbp_corner_of(b, t, 0), gxbp_corner_of(b, t, 1),
                                   gxbp_corner_of(b, t, 2));
}

/* A subtriangle at the start of t's first edge, inside t. */
static GXBP_RARE uint32_t gxbp_first_covered(gxb_boolean *b, uint32_t r, uint32_t t) {
    const uint32_t u = gxbp_edge_point(b, t, 0, 0);
    const int facing = gxbp_facing(b, r, t);
    gxbp_line line;
    gxbp_way way;
    gxbp_set_line(b, &line, r, u, gxbp_edge_point(b, t, 0, 1), GXBP_EDGE_LABEL, 0);
    if (!gxbp_find_edge(b, u, line.x, &way) && (!gxbp_find_way(b, &line, u, &way) || way.ahead == 0)) {
        gxbp_stop(b, GX_ERROR_OVERLAP);
        return GXB_NONE;
    }
    if (way.ahead == (facing > 0 ? 1 : 2)) return way.f;
    return b->mesh.subtriangles[way.f].near[way.ahead == 1 ? way.k : (way.k + 2) % 3];
}

static int gxbp_covers(const gxb_boolean *b, uint32_t f, uint32_t t) {
    uint32_t c;
    for (c = b->mesh.subtriangles[f].covers; c != GXB_NONE; c = b->mesh.links[c].next)
        if (b->mesh.links[c].value == t) return 1;
    return 0;
}

static int gxbp_is_edge_of(const gxb_boolean *b, uint32_t labels, uint32_t t) {
    int k;
    for (k = 0; k < 3; k++)
        if (gxbp_has_label(b, labels, gxbp_edge_name(b, t, k) | GXBP_EDGE_LABEL)) return 1;
    return 0;
}

/* Lists a member as a cover of all subtriangles within its edges. */
static GXBP_RARE void gxbp_cover_subtriangles(gxb_boolean *b, uint32_t r, uint32_t t) {
    const uint32_t first = gxbp_first_covered(b, r, t);
    int k;
    b->work.visit_count = 0;
    if (first == GXB_NONE) return;
    b->mesh.subtriangles[first].covers = gxbp_new_link(b, t, b->mesh.subtriangles[first].covers);
    gxbp_push_visit(b, first);
    while (b->work.visit_count > 0 && b->error == GX_OK) {
        const uint32_t f = b->work.visits[--b->work.visit_count];
        for (k = 0; k < 3; k++) {
            const uint32_t g = b->mesh.subtriangles[f].near[k];
            if (g == GXB_NONE || gxbp_is_edge_of(b, b->mesh.subtriangles[f].labels[k], t) || gxbp_covers(b, g, t))
                continue;
            b->mesh.subtriangles[g].covers = gxbp_new_link(b, t, b->mesh.subtriangles[g].covers);
            gxbp_push_visit(b, g);
        }
    }
}

static GXBP_COLD void gxbp_divide_flat(gxb_boolean *b, uint32_t r) {
    uint32_t t, f;
    if (!gxbp_need_plane(b, r)) return;
    for (t = r; t != GXB_NONE; t = b->in.sources[t].next) {
        gxbp_list_changed(b, t);
        for (f = b->in.sources[t].subtriangle; f != GXB_NONE; f = b->mesh.subtriangles[f].next)
            b->mesh.subtriangles[f].source = GXB_NONE;
        b->in.sources[t].subtriangle = GXB_NONE;
        gxbp_note_divided(b, t);
        b->in.sources[t].flags |= GXBP_FLAT;
        b->in.sources[t].flags &= ~(uint32_t)GXBP_DIRTY;
    }
    gxbp_open_triangulation(b, r);
    gxbp_make_frame(b, r);
    if (b->error != GX_OK) return;
    gxbp_place_flat_segments(b, r, gxbp_place_flat_edges(b, r));
    for (t = r; t != GXB_NONE && b->error == GX_OK; t = b->in.sources[t].next) gxbp_cover_subtriangles(b, r, t);
}

/* Of the dirty sources only those that were divided stay in the list, each flat by its root. */
static GXBP_APART void gxbp_divide_dirty(gxb_boolean *b) {
    uint32_t i, n = 0;
    for (i = 0; i < b->crossings.dirty_count && b->error == GX_OK; i++) {
        const uint32_t s = b->crossings.dirty[i], r = gxbp_root(b, s);
        if (!(b->in.sources[s].flags & GXBP_DIRTY)) continue;
        if (b->in.sources[r].flags & GXBP_FLAT)
            gxbp_divide_flat(b, r);
        else
            gxbp_divide_source(b, s);
        b->in.sources[s].flags &= ~(uint32_t)GXBP_DIRTY;
        b->crossings.dirty[n++] = r;
    }
    b->crossings.dirty_count = n;
}

/* >>merge: equal points that did not meet in a triangulation ------------------------------------------------------- */
/* In: the points computed since the last evaluation. Out: equal points united, under the older name. Touches the
   union-find and the list of points along a direction. */

typedef struct gxbp_projected {
    double t;
    uint32_t point;
} gxbp_projected;

/* Merges the first half items with the others; work: room for these. */
static inline void gxbp_merge_projected(gxbp_projected *p, uint32_t half, uint32_t count, gxbp_projected *work) {
    uint32_t i, j, k;
    memcpy(work, p, half * sizeof *p);
    for (i = 0, j = half, k = 0; i < half; k++) p[k] = j < count && p[j].t < work[i].t ? p[j++] : work[i++];
}

static inline void gxbp_sort_few_projected(gxbp_projected *p, uint32_t count) {
    uint32_t i, j;
    for (i = 1; i < count; i++) {
        const gxbp_projected mine = p[i];
        for (j = i; j > 0 && mine.t < p[j - 1].t; j--) p[j] = p[j - 1];
        p[j] = mine;
    }
}

static GXBP_APART void gxbp_sort_projected(gxbp_projected *p, uint32_t count, gxbp_projected *work) {
    if (count <= 16) {
        gxbp_sort_few_projected(p, count);
        return;
    }
    gxbp_sort_projected(p, count / 2, work);
    gxbp_sort_projected(p + count / 2, count - count / 2, work);
    gxbp_merge_projected(p, count / 2, count, work);
}

static inline void gxbp_merge_pair(gxb_boolean *b, uint32_t p, uint32_t q) {
    p = gxbp_same(b, p);
    q = gxbp_same(b, q);
    if (p != q && (p >= b->points.merged_count || q >= b->points.merged_count) && gxbp_points_equal(b, p, q))
        gxbp_unite(b, p < q ? p : q, p < q ? q : p);
}

/* Compares the new points, from first on, with those of a run, from j to its end. Steps to the next one become longer
 * where the run is the denser of the two. */
static void gxbp_merge_with_run(gxb_boolean *b, uint32_t first, uint32_t j, uint32_t end) {
    const gxbp_projected *p = b->points.projected;
    const double reach = 8 * b->points.reach;
    uint32_t i, k, step;
    for (i = first; i < b->points.projected_count; i++) {
        for (step = 1; step <= end - j && p[j + step - 1].t < p[i].t - reach; step *= 2) j += step;
        for (; step > 0; step /= 2)
            if (step <= end - j && p[j + step - 1].t < p[i].t - reach) j += step;
        for (k = j; k < end && p[k].t <= p[i].t + reach; k++) gxbp_merge_pair(b, p[i].point, p[k].point);
    }
}

/* Appends the points from first on as a run. Runs of similar size become one, so that there are few. */
static void gxbp_append_run(gxb_boolean *b, uint32_t first, gxbp_projected *work) {
    uint32_t n = b->points.run_count, end = b->points.projected_count;
    for (; n > 0; n--) {
        const uint32_t start = n > 1 ? b->points.run[n - 2] : 0;
        if (first - start > 2 * (uint64_t)(end - first)) break;
        gxbp_merge_projected(b->points.projected + start, first - start, end - start, work);
        first = start;
    }
    b->points.run[n] = end;
    b->points.run_count = n + 1;
}

/* Compares each new computed point with all points within both errors along a direction in which few points agree. The
 * older name stays, whatever the order of discovery. */
static GXBP_APART void gxbp_merge_points(gxb_boolean *b) {
    static const double direction[3] = {0.6180339887, 0.4142135623, 0.7320508075};
    const uint32_t old = b->points.projected_count;
    const size_t added = b->points.vertex_count - b->points.merged_count, size = (old + added) * sizeof(gxbp_projected);
    gxbp_projected *p, *work;
    uint32_t i, j;
    if (b->error != GX_OK || added == 0 || !GXBP_ROOM(b, points.projected, points.projected, added)) return;
    work = (gxbp_projected *)gxbp_allocate(&b->store.allocator, size);
    if (work == NULL) {
        gxbp_stop(b, GX_ERROR_MEMORY);
        return;
    }
    p = b->points.projected;
    for (i = b->points.merged_count; i < b->points.vertex_count; i++) {
        const gxb_ball *x = &b->store.points[i].ball;
        if (b->points.vertices[i].key[0] == GXB_FROM_VERTEX || b->points.vertices[i].same != i) continue;
        p[b->points.projected_count].t = direction[0] * x->x[0] + direction[1] * x->x[1] + direction[2] * x->x[2];
        p[b->points.projected_count++].point = i;
        b->points.reach = gxbp_max(b->points.reach, x->error + 4 * GXBP_U * gxbp_max3(x->x));
    }
    gxbp_sort_projected(p + old, b->points.projected_count - old, work);
    for (i = 0; i < b->points.run_count; i++)
        gxbp_merge_with_run(b, old, i > 0 ? b->points.run[i - 1] : 0, b->points.run[i]);
    for (i = old; i < b->points.projected_count; i++)
        for (j = i + 1; j < b->points.projected_count && p[j].t - p[i].t <= 8 * b->points.reach; j++)
            gxbp_merge_pair(b, p[i].point, p[j].point);
    gxbp_append_run(b, old, work);
    gxbp_release(&b->store.allocator, work, size);
    b->points.merged_count = b->points.vertex_count;
}

/* >>states: vectors of winding numbers ----------------------------------------------------------------------------- */
/* In: a state and a change of winding numbers. Out: the state with them. A state is a vector of one number per operand,
   stored once, without its zeros. So an operand that is added leaves all states as they are. Touches the states and
   their table only. */

static int gxbp_counts(uint32_t rule, int32_t winding) {
    switch (rule) {
    case GXB_POSITIVE: return winding > 0;
    case GXB_NEGATIVE: return winding < 0;
    case GXB_ODD: return winding % 2 != 0;
    default: return winding != 0;
    }
}

/* The caller's function on a state */
static GXBP_COLD int gxbp_ask_inside(gxb_boolean *b, const gxbp_state *state) {
    const gxbp_operand_number *numbers = b->winding.numbers + state->first;
    const uint32_t n = b->in.operand_count;
    uint32_t i;
    int inside;
    if (n > b->winding.vector_count) {
        if (!GXBP_ROOM(b, winding.vector, winding.vector, n - b->winding.vector_count)) return 0;
        memset(b->winding.vector + b->winding.vector_count, 0, (n - b->winding.vector_count) * sizeof(int32_t));
        b->winding.vector_count = n;
    }
    for (i = 0; i < state->count; i++)
        if (!b->in.operands[numbers[i].operand].removed) b->winding.vector[numbers[i].operand] = numbers[i].winding;
    inside = b->options.inside(b->options.user, b->winding.vector, n) != 0;
    for (i = 0; i < state->count; i++) b->winding.vector[numbers[i].operand] = 0;
    return inside;
}

/* Operands with the number 0 change nothing, unless they are intersections. */
static GXBP_COLD int gxbp_apply_operations(const gxb_boolean *b, const gxbp_state *state) {
    const gxbp_operand_number *numbers = b->winding.numbers + state->first;
    uint32_t k, next = 0;
    int inside = 0;
    for (k = 0; k < state->count; k++) {
        const uint32_t i = numbers[k].operand;
        const gxbp_operand *o = &b->in.operands[i];
        const int counts = o->operation == GXB_SPLIT ? 0 : gxbp_counts(o->rule, numbers[k].winding);
        if (o->removed) continue;
        if (i > next && b->in.operands[i - 1].narrowed >= next) inside = 0;
        switch (i == b->in.first && o->operation != GXB_SPLIT ? (uint32_t)GXB_UNION : o->operation) {
        case GXB_UNION: inside = inside || counts; break;
        case GXB_INTERSECTION: inside = inside && counts; break;
        case GXB_DIFFERENCE: inside = inside && !counts; break;
        case GXB_SYMMETRIC_DIFFERENCE: inside = inside != counts; break;
        default: break;
        }
        next = i + 1;
    }
    return inside && (next == b->in.operand_count || b->in.operands[b->in.operand_count - 1].narrowed < next);
}

/* Is a state inside? An operand that is newer than the answer has the number 0. */
static GXBP_COLD uint32_t gxbp_judge_state(gxb_boolean *b, uint32_t state) {
    gxbp_state *s = &b->winding.states[state];
    const uint32_t n = b->in.operand_count;
    if (b->options.inside != NULL)
        s->inside = (uint32_t)gxbp_ask_inside(b, s);
    else if (s->known == 0)
        s->inside = (uint32_t)gxbp_apply_operations(b, s);
    else if (b->in.operands[n - 1].narrowed >= s->known)
        s->inside = 0;
    s->known = n;
    return s->inside;
}

/* The caller's function may answer otherwise at each evaluation, so it is asked anew. */
static void gxbp_forget_answers(gxb_boolean *b) {
    uint32_t i;
    if (b->options.inside == NULL) return;
    for (i = 0; i < b->winding.state_count; i++) b->winding.states[i].known = 0;
}

static uint32_t gxbp_is_inside(gxb_boolean *b, uint32_t state) {
    if (b->error != GX_OK) return 0;
    return b->winding.states[state].known == b->in.operand_count ? b->winding.states[state].inside
                                                                 : gxbp_judge_state(b, state);
}

enum { GXBP_FEW_STATES = 8 }; /* fewer are searched without a table */

/* A table of all states, with room for one more */
static GXBP_COLD int gxbp_list_states(gxb_boolean *b) {
    uint32_t size = b->winding.table_size == 0 ? 64 : b->winding.table_size, i, k;
    while (2 * (b->winding.state_count + 1) > size) size *= 2;
    if (size > b->winding.table_size && !gxbp_renew_table(b, &b->winding.table, &b->winding.table_size, size)) return 0;
    memset(b->winding.table, 0xff, (size_t)b->winding.table_size * sizeof *b->winding.table);
    for (i = 0; i < b->winding.state_count; i++) {
        for (k = b->winding.states[i].hash & (size - 1); b->winding.table[k] != GXB_NONE; k = (k + 1) & (size - 1)) {}
        b->winding.table[k] = i;
    }
    b->winding.listed = b->winding.state_count;
    return 1;
}

/* Is this state the draft? */
static int gxbp_is_draft(const gxb_boolean *b, uint32_t state, uint32_t hash) {
    const gxbp_state *s = &b->winding.states[state];
    return s->hash == hash && s->count == b->winding.draft_count &&
           memcmp(b->winding.numbers + s->first, b->winding.numbers + b->winding.number_count,
                  s->count * sizeof *b->winding.numbers) == 0;
}

/* The state with the draft's numbers: a known one, or a new one. */
static uint32_t gxbp_find_state(gxb_boolean *b) {
    const gxbp_operand_number *draft = b->winding.numbers + b->winding.number_count;
    gxbp_state *state;
    uint32_t hash = 0, i, k = 0;
    if (!GXBP_ROOM(b, winding.states, winding.state, 1)) return 0;
    for (i = 0; i < b->winding.draft_count; i++) hash = gxbp_mix(hash + draft[i].operand, (uint32_t)draft[i].winding);
    if (b->winding.state_count < GXBP_FEW_STATES) {
        for (; k < b->winding.state_count; k++)
            if (gxbp_is_draft(b, k, hash)) return k;
    } else {
        if ((b->winding.listed < b->winding.state_count || 2 * (b->winding.state_count + 1) > b->winding.table_size) &&
            !gxbp_list_states(b))
            return 0;
        for (k = hash & (b->winding.table_size - 1); b->winding.table[k] != GXB_NONE;
             k = (k + 1) & (b->winding.table_size - 1))
            if (gxbp_is_draft(b, b->winding.table[k], hash)) return b->winding.table[k];
        b->winding.table[k] = b->winding.state_count;
        b->winding.listed++;
    }
    state = &b->winding.states[b->winding.state_count];
    state->first = b->winding.number_count;
    state->count = b->winding.draft_count;
    state->hash = hash;
    state->inside = state->known = 0;
    b->winding.number_count += b->winding.draft_count;
    return b->winding.state_count++;
}

/* Begins a draft: a copy of a state, or all numbers 0 (GXB_NONE). 0: after an error, when there may be no such state.
 */
static int gxbp_begin_draft(gxb_boolean *b, uint32_t state) {
    const uint32_t count = state == GXB_NONE || b->error != GX_OK ? 0 : b->winding.states[state].count;
    if (b->error != GX_OK || !GXBP_ROOM(b, winding.numbers, winding.number, (size_t)count + 1)) return 0;
    if (count > 0)
        memcpy(b->winding.numbers + b->winding.number_count, b->winding.numbers + b->winding.states[state].first,
               count * sizeof *b->winding.numbers);
    b->winding.draft_count = count;
    return 1;
}

/* Room for one more number in the draft, which moves with the others if they move */
static int gxbp_draft_room(gxb_boolean *b) {
    int room;
    b->winding.number_count += b->winding.draft_count;
    room = GXBP_ROOM(b, winding.numbers, winding.number, 1);
    b->winding.number_count -= b->winding.draft_count;
    return room;
}

/* Adds to an operand's number in the draft. */
static void gxbp_add_number(gxb_boolean *b, uint32_t operand, int change) {
    gxbp_operand_number *draft;
    uint32_t i = b->winding.draft_count;
    if (change == 0 || !gxbp_draft_room(b)) return;
    draft = b->winding.numbers + b->winding.number_count;
    while (i > 0 && draft[i - 1].operand > operand) i--;
    if (i > 0 && draft[i - 1].operand == operand) {
        draft[i - 1].winding += change;
        if (draft[i - 1].winding != 0) return;
        memmove(draft + i - 1, draft + i, (b->winding.draft_count-- - i) * sizeof *draft);
        return;
    }
    memmove(draft + i + 1, draft + i, (b->winding.draft_count++ - i) * sizeof *draft);
    draft[i].operand = operand;
    draft[i].winding = change;
}

static GXBP_APART uint32_t gxbp_new_step(gxb_boolean *b, gxbp_state_step *step, uint32_t from, uint32_t operand,
                                         int change) {
    if (!gxbp_begin_draft(b, from)) return 0;
    gxbp_add_number(b, operand, change);
    step->from = from;
    step->operand = operand;
    step->change = change;
    step->to = gxbp_find_state(b);
    return step->to;
}

/* The place of a step among the latest ones */
static gxbp_state_step *gxbp_step_place(gxb_boolean *b, uint32_t from, uint32_t operand, int change) {
    return &b->winding.steps[(2 * (from + 5 * operand) + (change > 0)) % GXBP_STEPS];
}

static uint32_t gxbp_step_state(gxb_boolean *b, uint32_t from, uint32_t operand, int change) {
    gxbp_state_step *step = gxbp_step_place(b, from, operand, change);
    if (step->change == change && step->from == from && step->operand == operand) return step->to;
    return gxbp_new_step(b, step, from, operand, change);
}

/* >>winding: a state for each subtriangle -------------------------------------------------------------------------- */
/* In: a finished arrangement. Out: the state in front of each subtriangle. A ray gives the first state of a connected
   surface. Labels of edges give those of neighbours. In older states a new operand has the number 0 wherever its box
   does not reach. Touches the states of subtriangles and their vertices' names. */

static int gxbp_winds(const gxb_boolean *b, uint32_t s) {
    return b->in.operands[b->in.sources[s].operand].operation != GXB_SPLIT;
}

static uint32_t gxbp_root_plane(const gxb_boolean *b, uint32_t f) {
    return b->in.sources[b->mesh.subtriangles[f].source].plane;
}

/* gxbp_side_of_subtriangle; 0: the filter does not settle it */
static inline int gxbp_side_of_subtriangle_by_filter(const gxb_boolean *b, uint32_t f, int k, uint32_t t) {
    const gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
    const gxb_plane_filter *filter = &b->store.planes[b->in.sources[t].plane].filter;
    const gxb_cplane *plane = &b->store.planes[gxbp_root_plane(b, f)];
    const gxb_cpoint *x = b->store.points;
    double bound, value = gxbp_filter_side(&x[sub->v[(k + 2) % 3]].ball, filter, &bound);
    int side = gxbp_filter_sign(value, bound), i;
    for (i = 0; i < 3 && side == 0; i++) {
        const uint32_t corner = b->in.sources[sub->source].point[i];
        value = gxbp_filter_side(&x[corner].ball, filter, &bound);
        side = gxbp_filter_sign(value, bound) * plane->axis_sign *
               gxbp_filter_turn(&x[sub->v[k]].ball, &x[sub->v[(k + 1) % 3]].ball, &x[corner].ball,
                                (int)(plane->axis + 1) % 3, (int)(plane->axis + 2) % 3);
    }
    return side;
}

/* The side of t's plane on which subtriangle f lies, whose edge k is in that plane. If the filter does not settle the
   apex, any corner of the source serves: its side times its orientation with the edge is the same for all points. */
static int gxbp_side_of_subtriangle(gxb_boolean *b, uint32_t f, int k, uint32_t t) {
    const int side = gxbp_side_of_subtriangle_by_filter(b, f, k, t);
    b->store.filter_calls++;
    return side != 0 ? side : gxbp_side_of_source(b, b->mesh.subtriangles[f].v[(k + 2) % 3], t);
}

/* How a label of edge k changes the winding number of its operand: if the labelling triangle t has a part in front of
   f's plane, the way across the edge crosses it, from the side on which f lies. */
static int gxbp_label_step(gxb_boolean *b, uint32_t f, int k, uint32_t t) {
    int i;
    if (t & GXBP_EDGE_LABEL || b->in.operands[b->in.sources[t].operand].operation == GXB_SPLIT) return 0;
    for (i = 0; i < 3; i++)
        if (gxbp_corner_side(b, t, i, gxbp_root_plane(b, f), 0) > 0) return gxbp_side_of_subtriangle(b, f, k, t);
    return 0;
}

/* The state in front of the subtriangle beyond edge k. */
static inline uint32_t gxbp_state_beyond(gxb_boolean *b, uint32_t f, int k) {
    uint32_t list = b->mesh.subtriangles[f].labels[k];
    int begun = 0;
    for (; list != GXBP_LOOSE && list != GXBP_BARE; list = b->mesh.links[list].next) {
        const uint32_t t = b->mesh.links[list].value;
        const int change = gxbp_label_step(b, f, k, t);
        if (change == 0) continue;
        if (!begun && b->mesh.links[list].next == GXBP_BARE)
            return gxbp_step_state(b, b->mesh.subtriangles[f].state, b->in.sources[t].operand, change);
        if (!begun && !gxbp_begin_draft(b, b->mesh.subtriangles[f].state)) return 0;
        begun = 1;
        gxbp_add_number(b, b->in.sources[t].operand, change);
    }
    return begun ? gxbp_find_state(b) : b->mesh.subtriangles[f].state;
}

/* Adds sign times the subtriangle's own surfaces to the draft. Behind it, the winding number is larger by one for each
 * surface that faces as its plane does. */
static GXBP_COLD void gxbp_add_covers(gxb_boolean *b, uint32_t f, int sign) {
    const uint32_t r = b->mesh.subtriangles[f].source;
    uint32_t c;
    if (b->mesh.subtriangles[f].covers == GXB_NONE) {
        if (gxbp_winds(b, r)) gxbp_add_number(b, b->in.sources[r].operand, sign);
        return;
    }
    for (c = b->mesh.subtriangles[f].covers; c != GXB_NONE; c = b->mesh.links[c].next) {
        const uint32_t t = b->mesh.links[c].value;
        if (gxbp_winds(b, t)) gxbp_add_number(b, b->in.sources[t].operand, sign * gxbp_facing(b, r, t));
    }
}

static uint32_t gxbp_state_behind(gxb_boolean *b, uint32_t f) {
    const uint32_t s = b->mesh.subtriangles[f].source;
    if (b->mesh.subtriangles[f].covers == GXB_NONE)
        return gxbp_winds(b, s) ? gxbp_step_state(b, b->mesh.subtriangles[f].state, b->in.sources[s].operand, 1)
                                : b->mesh.subtriangles[f].state;
    if (!gxbp_begin_draft(b, b->mesh.subtriangles[f].state)) return 0;
    gxbp_add_covers(b, f, 1);
    return gxbp_find_state(b);
}

/* --- a first state, by a ray along x from a point inside the subtriangle. In y, z it is moved by (h, h^2), h -> 0 (see
   gxbp_ray_side) */

typedef struct gxbp_ray {
    gxb_ball ball;
    gxbp_box box; /* around the whole ray */
    uint32_t f;
    int32_t winding;  /* of the operand at work */
    int exact;        /* 1: probe has been computed */
    gxbp_probe probe; /* the sum of the corners' homogeneous coordinates */
} gxbp_ray;

static const gxbp_probe *gxbp_exact_probe(gxb_boolean *b, gxbp_ray *ray) {
    if (!ray->exact) {
        gxbp_probe_init(&b->store, b->mesh.subtriangles[ray->f].v, 3, &ray->probe);
        ray->probe.shift = 0; /* triangles are given in the frame */
        ray->exact = 1;
    }
    b->store.exact_calls++;
    return &ray->probe;
}

/* Starts the ray at a ball around the sum of the corners' homogeneous coordinates: their mean if all weights are 1. */
static void gxbp_set_ray(gxb_boolean *b, gxbp_ray *ray, uint32_t f) {
    const gxb_cpoint *p[3];
    int k, given = 1;
    ray->f = f;
    ray->exact = 0;
    for (k = 0; k < 3; k++) {
        p[k] = &b->store.points[b->mesh.subtriangles[f].v[k]];
        given = given && p[k]->kind == GXB_EXPLICIT;
    }
    if (!given) gxbp_exact_probe(b, ray);
    for (k = 0; k < 3; k++)
        ray->ball.x[k] = given ? (p[0]->ball.x[k] + p[1]->ball.x[k] + p[2]->ball.x[k]) / 3 : ray->probe.rough[k];
    ray->ball.error = gxbp_max3(ray->ball.x);
    for (k = 0; k < 3 && given; k++) ray->ball.error = gxbp_max(ray->ball.error, gxbp_max3(p[k]->ball.x));
    ray->ball.error = gxbp_power(-49) * ray->ball.error + GXBP_TINY;
    for (k = 0; k < 3; k++) {
        ray->box.low[k] = gxbp_float_below(ray->ball.x[k] - 2 * ray->ball.error);
        ray->box.high[k] = k == 0 ? (float)gxbp_power(125) : gxbp_float_above(ray->ball.x[k] + 2 * ray->ball.error);
    }
}

static int gxbp_ray_left(gxb_boolean *b, gxbp_ray *ray, const gxb_ball *p, const gxb_ball *q) {
    const int turn = gxbp_filter_turn(p, q, &ray->ball, 1, 2);
    return turn != 0 ? turn : gxbp_probe_side(gxbp_exact_probe(b, ray), p->x, q->x);
}

static void gxbp_cross_ray(gxb_boolean *b, gxbp_ray *ray, uint32_t s) {
    const gxb_ball *p = &b->store.points[b->in.sources[s].point[0]].ball,
                   *q = &b->store.points[b->in.sources[s].point[1]].ball;
    const gxb_ball *r = &b->store.points[b->in.sources[s].point[2]].ball;
    const uint32_t own = b->mesh.subtriangles[ray->f].source;
    const double *x[3];
    double value, bound;
    int left, behind;
    if (s == own || (b->in.sources[s].flags & GXBP_DEGENERATE) || gxbp_covers(b, ray->f, s)) return;
    left = gxbp_ray_left(b, ray, p, q);
    if (left == 0 || gxbp_ray_left(b, ray, q, r) != left || gxbp_ray_left(b, ray, r, p) != left ||
        !gxbp_need_plane(b, s))
        return;
    value = gxbp_filter_side(&ray->ball, &b->store.planes[b->in.sources[s].plane].filter, &bound);
    behind = -gxbp_filter_sign(value, bound);
    x[0] = p->x;
    x[1] = q->x;
    x[2] = r->x;
    if (behind == 0) behind = gxbp_probe_orient(gxbp_exact_probe(b, ray), x);
    if (behind == left) ray->winding += left;
}

static GXBP_APART void gxbp_shoot(gxb_boolean *b, gxbp_ray *ray, const gxbp_operand *o, uint32_t l, uint32_t i) {
    uint32_t meets[GXBP_LEAF], c;
    if (!gxbp_box_meets(&ray->box, &b->in.boxes[o->tree.first + o->tree.level[l] + i])) return;
    if (l > 0) {
        for (c = 2 * i; c < 2 * i + 2 && c < o->tree.size[l - 1]; c++) gxbp_shoot(b, ray, o, l - 1, c);
        return;
    }
    gxbp_test_leaf(&b->in.bounds[o->bounds + i], &ray->box, meets);
    for (c = 0; c < GXBP_LEAF; c++)
        if (meets[c]) gxbp_cross_ray(b, ray, o->order[i * GXBP_LEAF + c]);
}

/* The side of a plane to which moving by (h, h^2) takes a point of it; 0: the plane is normal to x. */
static int gxbp_moved_side(gxb_boolean *b, uint32_t plane) {
    const int side = gxbp_normal_sign(&b->store, plane, 1);
    return side != 0 ? side : gxbp_normal_sign(&b->store, plane, 2);
}

/* The moved start lies on one side of the subtriangle's plane: the sign of the first nonzero one of n_y, n_z, n_x. From
   behind (n_x > 0) or from in front (n_x < 0) the ray crosses the subtriangle itself. */
static GXBP_RARE void gxbp_cross_own(gxb_boolean *b, const gxbp_ray *ray) {
    const uint32_t plane = gxbp_root_plane(b, ray->f);
    const int nx = gxbp_normal_sign(&b->store, plane, 0);
    int side = gxbp_moved_side(b, plane);
    if (side == 0) side = nx;
    if (nx * side < 0) gxbp_add_covers(b, ray->f, nx);
    if (side < 0) gxbp_add_covers(b, ray->f, -1); /* from the state behind to the one in front */
}

/* The state in front of a subtriangle. state is right for the operands before first; GXB_NONE: all numbers are 0. */
static GXBP_APART uint32_t gxbp_state_by_ray(gxb_boolean *b, uint32_t f, uint32_t state, uint32_t first) {
    gxbp_ray ray;
    uint32_t i;
    if (!gxbp_need_plane(b, b->mesh.subtriangles[f].source)) return 0;
    if (!gxbp_begin_draft(b, state)) return 0;
    gxbp_set_ray(b, &ray, f);
    gxbp_find_operands(b, &ray.box, first, b->in.operand_count);
    for (i = 0; i < b->work.found_count && b->error == GX_OK; i++) {
        const gxbp_operand *o = &b->in.operands[b->work.found[i]];
        if (o->operation == GXB_SPLIT) continue;
        ray.winding = 0;
        gxbp_shoot(b, &ray, o, o->tree.levels - 1, 0);
        gxbp_add_number(b, b->work.found[i], ray.winding);
    }
    /* else the subtriangle is of an older operand, and state contains its own surfaces */
    if (first == 0) gxbp_cross_own(b, &ray);
    return gxbp_find_state(b);
}

/* --- states spread from subtriangle to subtriangle --- */

/* The first source of operands without states */
static uint32_t gxbp_new_sources(const gxb_boolean *b) {
    return b->winding.stated < b->in.operand_count ? b->in.operands[b->winding.stated].source : b->in.source_count;
}

static void gxbp_rename_subtriangle(gxb_boolean *b, uint32_t f) {
    uint32_t k;
    for (k = 0; k < 3; k++) b->mesh.subtriangles[f].v[k] = gxbp_same(b, b->mesh.subtriangles[f].v[k]);
}

static void gxbp_rename_source(gxb_boolean *b, uint32_t s) {
    uint32_t f;
    for (f = b->in.sources[s].subtriangle; f != GXB_NONE; f = b->mesh.subtriangles[f].next)
        gxbp_rename_subtriangle(b, f);
}

/* Renames the vertices of sources (of their flats) that meet a box, below box i of level l of a tree. */
static GXBP_RARE void gxbp_rename_below(gxb_boolean *b, const gxbp_operand *o, uint32_t l, uint32_t i,
                                        const gxbp_box *box) {
    uint32_t meets[GXBP_LEAF], c;
    if (!gxbp_box_meets(box, &b->in.boxes[o->tree.first + o->tree.level[l] + i])) return;
    if (l > 0) {
        for (c = 2 * i; c < 2 * i + 2 && c < o->tree.size[l - 1]; c++) gxbp_rename_below(b, o, l - 1, c, box);
        return;
    }
    gxbp_test_leaf(&b->in.bounds[o->bounds + i], box, meets);
    for (c = 0; c < GXBP_LEAF; c++)
        if (meets[c]) gxbp_rename_source(b, gxbp_root(b, o->order[i * GXBP_LEAF + c]));
}

/* Renames a dropped point wherever it is a vertex: in sources whose boxes hold it. */
static GXBP_COLD void gxbp_rename_point(gxb_boolean *b, uint32_t point) {
    const gxb_ball *x = &b->store.points[point].ball;
    gxbp_box box;
    uint32_t i;
    int k;
    for (k = 0; k < 3; k++) {
        box.low[k] = gxbp_float_below(x->x[k] - 2 * x->error);
        box.high[k] = gxbp_float_above(x->x[k] + 2 * x->error);
    }
    gxbp_find_operands(b, &box, 0, b->in.operand_count);
    for (i = 0; i < b->work.found_count; i++) {
        const gxbp_operand *o = &b->in.operands[b->work.found[i]];
        gxbp_rename_below(b, o, o->tree.levels - 1, 0, &box);
    }
}

/* Gives vertices their final names after points were united. A new point is a vertex only of sources that this
 * evaluation has divided. */
static GXBP_RARE void gxbp_rename_vertices(gxb_boolean *b) {
    uint32_t i;
    if (b->points.dropped_count > b->mesh.subtriangle_count / 64) {
        for (i = 0; i < b->mesh.subtriangle_count; i++) gxbp_rename_subtriangle(b, i);
    } else {
        for (i = 0; i < b->crossings.dirty_count; i++) gxbp_rename_source(b, b->crossings.dirty[i]);
        for (i = 0; i < b->points.dropped_count; i++) gxbp_rename_point(b, b->points.dropped[i]);
    }
    b->points.united = 0;
}

/* The subtriangle at the start of edge k of a source that is not in a flat. GXB_NONE: another surface meets it there.
 */
static uint32_t gxbp_rim_subtriangle(const gxb_boolean *b, uint32_t s, uint32_t k) {
    const gxbp_source *source = &b->in.sources[s];
    const gxbp_surface_edge *edge;
    uint32_t h;
    if (!(source->flags & GXBP_DIVIDED)) return source->subtriangle;
    edge = &b->crossings.edges[source->edge[k]];
    h = edge->rim[edge->half_edge != 3 * s + k];
    return b->mesh.subtriangles[h / 3].labels[h % 3] == GXBP_BARE ? h / 3 : GXB_NONE;
}

/* The neighbour, across the surface's edge, of the subtriangle at the start of edge k of a source. GXB_NONE unless only
   these two meet there. */
static uint32_t gxbp_across_rim(const gxb_boolean *b, uint32_t s, uint32_t k) {
    const uint32_t twin = b->in.sources[s].twin[k];
    if (twin == GXB_NONE || b->in.sources[twin / 3].flags & GXBP_FLAT || gxbp_rim_subtriangle(b, s, k) == GXB_NONE)
        return GXB_NONE;
    return gxbp_rim_subtriangle(b, twin / 3, twin % 3);
}

/* The subtriangle beyond edge k of f. Across the rim of a divided source, only those at the starts of its edges have
   one; GXB_NONE: there is none. */
static uint32_t gxbp_neighbour(const gxb_boolean *b, uint32_t f, int k) {
    const gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
    const gxbp_source *s = &b->in.sources[sub->source];
    uint32_t i;
    if (s->flags & GXBP_FLAT)
        return sub->near[k] != GXB_NONE && b->mesh.subtriangles[sub->near[k]].covers != GXB_NONE ? sub->near[k]
                                                                                                 : GXB_NONE;
    if (sub->near[k] != GXB_NONE) return sub->near[k];
    if (!(s->flags & GXBP_DIVIDED)) return gxbp_across_rim(b, sub->source, (uint32_t)k);
    for (i = 0; i < 3; i++) {
        const gxbp_surface_edge *edge = &b->crossings.edges[s->edge[i]];
        if (edge->rim[edge->half_edge != 3 * sub->source + i] == 3 * f + (uint32_t)k)
            return gxbp_across_rim(b, sub->source, i);
    }
    return GXB_NONE;
}

/* The only source that crosses edge k of a subtriangle. GXB_NONE: none or several do, or one has an edge there. */
static uint32_t gxbp_crossing_source(const gxb_boolean *b, uint32_t f, int k) {
    const uint32_t list = b->mesh.subtriangles[f].labels[k];
    if (b->mesh.subtriangles[f].near[k] == GXB_NONE || list == GXBP_LOOSE || list == GXBP_BARE ||
        b->mesh.links[list].next != GXBP_BARE)
        return GXB_NONE;
    return b->mesh.links[list].value & GXBP_EDGE_LABEL ? GXB_NONE : b->mesh.links[list].value;
}

/* The subtriangle of a source whose edge *k leads from u to w; GXB_NONE: there is none. */
static uint32_t gxbp_subtriangle_at(const gxb_boolean *b, uint32_t s, uint32_t u, uint32_t w, int *k) {
    uint32_t f;
    for (f = b->in.sources[s].subtriangle; f != GXB_NONE; f = b->mesh.subtriangles[f].next)
        for (*k = 0; *k < 3; (*k)++)
            if (b->mesh.subtriangles[f].v[*k] == u && b->mesh.subtriangles[f].v[(*k + 1) % 3] == w) return f;
    return GXB_NONE;
}

static void gxbp_note_reached(gxb_boolean *b, uint32_t s) {
    gxbp_operand *o = &b->in.operands[b->in.sources[s].operand];
    b->winding.unreached -= !o->reached;
    o->reached = 1;
}

/* Takes the state to an operand that has none yet. A triangle t of it crosses f in its edge k, and nothing else is
   there: four subtriangles meet in the edge, two of each source. The plane of one source separates the numbers of its
   own operand only. The subtriangle of t that gets a state goes to b->work.pending. */
static void gxbp_reach_operand(gxb_boolean *b, uint32_t f, int k) {
    const uint32_t s = b->mesh.subtriangles[f].source, t = gxbp_crossing_source(b, f, k);
    uint32_t g;
    int j, side, other;
    if (t == GXB_NONE || b->in.operands[b->in.sources[t].operand].reached || b->in.sources[t].flags & GXBP_FLAT) return;
    g = gxbp_subtriangle_at(b, t, b->mesh.subtriangles[f].v[k], b->mesh.subtriangles[f].v[(k + 1) % 3], &j);
    if (g == GXB_NONE || gxbp_crossing_source(b, g, j) != s || b->mesh.subtriangles[g].state != GXB_NONE ||
        !GXBP_ROOM(b, work.pending, work.pending, 1))
        return;
    side = gxbp_side_of_subtriangle(b, f, k, t);
    other = gxbp_side_of_subtriangle(b, g, j, s);
    if (side == 0 || other == 0 || !gxbp_begin_draft(b, b->mesh.subtriangles[f].state)) return;
    if (other < 0 && gxbp_winds(b, s)) gxbp_add_number(b, b->in.sources[s].operand, 1);
    if (side < 0 && gxbp_winds(b, t)) gxbp_add_number(b, b->in.sources[t].operand, -1);
    b->mesh.subtriangles[g].state = gxbp_find_state(b);
    gxbp_note_reached(b, t);
    b->work.pending[b->work.pending_count++] = g;
}

/* gxbp_find_states has reserved the room. */
static void gxbp_add_visit(gxb_boolean *b, uint32_t f) { b->work.visits[b->work.visit_count++] = f; }

/* Spreads the state to all subtriangles of f's triangulation that can be reached. */
static inline void gxbp_spread_within(gxb_boolean *b, uint32_t f) {
    const uint32_t base = b->work.visit_count, flat = b->in.sources[b->mesh.subtriangles[f].source].flags & GXBP_FLAT;
    gxbp_add_visit(b, f);
    while (b->work.visit_count > base && b->error == GX_OK) {
        int k;
        f = b->work.visits[--b->work.visit_count];
        for (k = 0; k < 3; k++) {
            const uint32_t near = b->mesh.subtriangles[f].near[k];
            if (near == GXB_NONE || b->mesh.subtriangles[near].state != GXB_NONE ||
                (flat && b->mesh.subtriangles[near].covers == GXB_NONE))
                continue;
            b->mesh.subtriangles[near].state = gxbp_state_beyond(b, f, k);
            if (b->winding.unreached > 0 && !flat) gxbp_reach_operand(b, f, k);
            gxbp_add_visit(b, near);
        }
    }
}

/* Spreads a state within a source, then across its edges to sources without states. The order is breadth-first, so that
 * many cache misses overlap. */
static inline void gxbp_spread_state(gxb_boolean *b, uint32_t first) {
    uint32_t i;
    b->work.visit_count = 0;
    gxbp_add_visit(b, first);
    for (i = 0; i < b->work.visit_count && b->error == GX_OK; i++) {
        const uint32_t f = b->work.visits[i], s = b->mesh.subtriangles[f].source;
        uint32_t k;
        b->in.sources[s].flags |= GXBP_REACHED;
        if (b->in.sources[s].flags & (GXBP_DIVIDED | GXBP_FLAT)) gxbp_spread_within(b, f);
        if (b->in.sources[s].flags & GXBP_FLAT) continue;
        for (k = 0; k < 3; k++) {
            const uint32_t twin = b->in.sources[s].twin[k];
            uint32_t g;
            if (twin == GXB_NONE || b->in.sources[twin / 3].flags & (GXBP_REACHED | GXBP_FLAT)) continue;
            g = gxbp_across_rim(b, s, k);
            if (g == GXB_NONE) continue;
            b->mesh.subtriangles[g].state = b->mesh.subtriangles[gxbp_rim_subtriangle(b, s, k)].state;
            b->in.sources[twin / 3].flags |= GXBP_REACHED;
            gxbp_add_visit(b, g);
        }
    }
}

static int gxbp_is_surface(const gxb_boolean *b, uint32_t f) {
    const uint32_t s = b->mesh.subtriangles[f].source;
    return s != GXB_NONE && (!(b->in.sources[s].flags & GXBP_FLAT) || b->mesh.subtriangles[f].covers != GXB_NONE);
}

/* --- states of earlier evaluations: new operands get the number 0, which is right outside of their boxes --- */

/* An operand that is an intersection leaves nothing outside of it. Operands before i are noted. */
static void gxbp_note_intersections(gxb_boolean *b, uint32_t i) {
    for (; i < b->in.operand_count; i++) {
        gxbp_operand *o = &b->in.operands[i];
        const uint32_t before = i > 0 ? b->in.operands[i - 1].narrowed : 0;
        o->narrowed = i > b->in.first && o->operation == GXB_INTERSECTION && !o->removed ? i : before;
    }
}

/* An open state has this bit: it does not count the new operands yet. */
#define GXBP_OPEN ((uint32_t)1 << 31)

static int gxbp_is_open(const gxb_boolean *b, uint32_t f) {
    return b->mesh.subtriangles[f].state != GXB_NONE && b->mesh.subtriangles[f].state & GXBP_OPEN;
}

/* Is the subtriangle certainly on one side of the box along this axis? */
static int gxbp_subtriangle_misses(const gxb_boolean *b, uint32_t f, const gxbp_box *box, int axis) {
    int i, side = 0;
    for (i = 0; i < 3; i++) {
        const gxb_ball *x = &b->store.points[b->mesh.subtriangles[f].v[i]].ball;
        const int mine = x->x[axis] + 2 * x->error < 16 * (double)box->low[axis]
                           ? -1
                           : x->x[axis] - 2 * x->error > 16 * (double)box->high[axis];
        if (mine == 0 || mine == -side) return 0;
        side = mine;
    }
    return 1;
}

/* Opens the states of a source's (root's) subtriangles that may meet the box, and lists them in b->work.pending. The
   axis along which the box is shortest is tested first. */
static void gxbp_open_source(gxb_boolean *b, uint32_t s, const gxbp_box *box, int axis) {
    uint32_t f;
    for (f = b->in.sources[s].subtriangle; f != GXB_NONE; f = b->mesh.subtriangles[f].next) {
        if (b->mesh.subtriangles[f].source == GXB_NONE || b->mesh.subtriangles[f].state == GXB_NONE ||
            gxbp_is_open(b, f) || gxbp_subtriangle_misses(b, f, box, axis) ||
            gxbp_subtriangle_misses(b, f, box, (axis + 1) % 3) || gxbp_subtriangle_misses(b, f, box, (axis + 2) % 3))
            continue;
        if (!GXBP_ROOM(b, work.pending, work.pending, 1)) return;
        b->work.pending[b->work.pending_count++] = f;
        b->mesh.subtriangles[f].state |= GXBP_OPEN;
    }
}

/* Opens states in what lies below box i of level l of an operand's tree. A flat is marked dirty and listed in
   b->work.visits, so that it is visited once. */
static GXBP_RARE void gxbp_open_below(gxb_boolean *b, const gxbp_operand *o, uint32_t l, uint32_t i,
                                      const gxbp_box *box, int axis) {
    uint32_t meets[GXBP_LEAF], c;
    if (!gxbp_box_meets(box, &b->in.boxes[o->tree.first + o->tree.level[l] + i])) return;
    if (l > 0) {
        for (c = 2 * i; c < 2 * i + 2 && c < o->tree.size[l - 1]; c++) gxbp_open_below(b, o, l - 1, c, box, axis);
        return;
    }
    gxbp_test_leaf(&b->in.bounds[o->bounds + i], box, meets);
    for (c = 0; c < GXBP_LEAF; c++) {
        uint32_t s;
        if (!meets[c]) continue;
        s = gxbp_root(b, o->order[i * GXBP_LEAF + c]);
        if (b->in.sources[s].flags & GXBP_FLAT) {
            if (b->in.sources[s].flags & GXBP_DIRTY) continue;
            b->in.sources[s].flags |= GXBP_DIRTY;
            gxbp_push_visit(b, s);
        }
        gxbp_open_source(b, s, box, axis);
    }
}

/* Opens the states of all subtriangles of older operands that may meet the box. */
static void gxbp_open_states(gxb_boolean *b, const gxbp_box *box) {
    uint32_t i;
    int axis = 0, k;
    for (k = 1; k < 3; k++)
        if (box->high[k] - box->low[k] < box->high[axis] - box->low[axis]) axis = k;
    b->work.visit_count = 0;
    gxbp_find_operands(b, box, 0, b->winding.stated);
    for (i = 0; i < b->work.found_count && b->error == GX_OK; i++) {
        const gxbp_operand *o = &b->in.operands[b->work.found[i]];
        gxbp_open_below(b, o, o->tree.levels - 1, 0, box, axis);
    }
    for (i = 0; i < b->work.visit_count; i++) b->in.sources[b->work.visits[i]].flags &= ~(uint32_t)GXBP_DIRTY;
}

/* The state of open subtriangle f beyond edge k of g, which is not open: f's own numbers; for new operands those of g,
 * changed by the labels of the edge. */
static uint32_t gxbp_close_state(gxb_boolean *b, uint32_t g, int k, uint32_t f) {
    const uint32_t m = b->winding.stated, own = b->mesh.subtriangles[f].state & ~GXBP_OPEN;
    const gxbp_state *from = &b->winding.states[b->mesh.subtriangles[g].state];
    uint32_t list = b->mesh.subtriangles[g].near[k] == f ? b->mesh.subtriangles[g].labels[k] : GXBP_BARE, i;
    if (!gxbp_begin_draft(b, own)) return own;
    for (i = from->first; i < from->first + from->count; i++)
        if (b->winding.numbers[i].operand >= m)
            gxbp_add_number(b, b->winding.numbers[i].operand, b->winding.numbers[i].winding);
    for (; list != GXBP_LOOSE && list != GXBP_BARE; list = b->mesh.links[list].next) {
        const uint32_t t = b->mesh.links[list].value;
        if (!(t & GXBP_EDGE_LABEL) && b->in.sources[t].operand >= m)
            gxbp_add_number(b, b->in.sources[t].operand, gxbp_label_step(b, g, k, t));
    }
    return b->winding.draft_count > b->winding.states[own].count ? gxbp_find_state(b) : own;
}

/* Closes the states of open subtriangles, from neighbour to neighbour */
static void gxbp_spread_closed(gxb_boolean *b, uint32_t first) {
    b->work.visit_count = 0;
    gxbp_push_visit(b, first);
    while (b->work.visit_count > 0 && b->error == GX_OK) {
        const uint32_t f = b->work.visits[--b->work.visit_count];
        int k;
        for (k = 0; k < 3; k++) {
            const uint32_t g = gxbp_neighbour(b, f, k);
            if (g == GXB_NONE || !gxbp_is_open(b, g)) continue;
            b->mesh.subtriangles[g].state = gxbp_close_state(b, f, k, g);
            gxbp_push_visit(b, g);
        }
    }
}

/* Open states are closed from neighbours that are not open. Where there are none, a ray closes the first one. */
static GXBP_COLD void gxbp_close_states(gxb_boolean *b) {
    uint32_t f, i, pass;
    int k;
    b->work.pending_count = 0;
    for (i = b->winding.stated; i < b->in.operand_count; i++) gxbp_open_states(b, gxbp_operand_box(b, i));
    if (b->out.shown_count > 0 && GXBP_ROOM(b, mesh.changed, mesh.changed, b->work.pending_count))
        for (i = 0; i < b->work.pending_count; i++) b->mesh.changed[b->mesh.changed_count++] = b->work.pending[i];
    for (pass = 0; pass < 2; pass++)
        for (i = 0; i < b->work.pending_count && b->error == GX_OK; i++) {
            f = b->work.pending[i];
            for (k = 0; k < 3 && gxbp_is_open(b, f); k++) {
                const uint32_t g = gxbp_neighbour(b, f, k);
                if (g != GXB_NONE && b->mesh.subtriangles[g].state != GXB_NONE && !gxbp_is_open(b, g))
                    gxbp_spread_closed(b, g);
            }
            if (pass == 0 || !gxbp_is_open(b, f)) continue;
            b->mesh.subtriangles[f].state =
                gxbp_state_by_ray(b, f, b->mesh.subtriangles[f].state & ~GXBP_OPEN, b->winding.stated);
            gxbp_spread_closed(b, f);
        }
}

/* >>floods: states spread by threads ------------------------------------------------------------------------------- */
/* In: a finished arrangement, and the states of the evaluation before. Out: a state for each subtriangle. With the
   host's threads, the states of large operands spread side by side, one task for each: a task writes to its own
   operand's sources and subtriangles. Where the filter settles no sign, or a state is not known yet, the task waits.
   The caller answers between two rounds. Touches what >>winding does. */

enum {
    GXBP_FLOOD_STACK = GXBP_PART / 8, /* subtriangles of one source to visit; with more, the caller goes on */
    GXBP_FLOOD_ROUNDS = 64            /* after these, too */
};
#define GXBP_NO_ANSWER (GXB_NONE - 1)
typedef struct gxbp_flood {
    gxb_boolean *b;
    uint32_t *queue; /* a subtriangle of each source that was reached */
    uint32_t count, next;
    uint32_t stack[GXBP_FLOOD_STACK], stack_count; /* in the source of queue[next] */
    uint32_t answer;                               /* the state beyond edge k of stack[stack_count - 1] */
    int k, entered, waiting, stuck;                /* entered: the stack is that of queue[next] */
    uint64_t filter_calls;
} gxbp_flood;

/* gxbp_label_step; 2: the filter does not settle it */
static int gxbp_label_step_by_filter(gxbp_flood *flood, uint32_t f, int k, uint32_t t) {
    const gxb_boolean *b = flood->b;
    const gxb_plane_filter *plane;
    int i, side, open = 0;
    if (t & GXBP_EDGE_LABEL || b->in.operands[b->in.sources[t].operand].operation == GXB_SPLIT) return 0;
    plane = &b->store.planes[gxbp_root_plane(b, f)].filter;
    for (i = 0; i < 3; i++) {
        double bound;
        const double value = gxbp_filter_side(&b->store.points[b->in.sources[t].point[i]].ball, plane, &bound);
        flood->filter_calls++;
        if (value > bound) break;
        open |= !(value < -bound);
    }
    if (i == 3) return open ? 2 : 0;
    flood->filter_calls++;
    side = gxbp_side_of_subtriangle_by_filter(b, f, k, t);
    return side != 0 ? side : 2;
}

/* gxbp_state_beyond, if it is known; else GXBP_NO_ANSWER */
static uint32_t gxbp_known_state_beyond(gxbp_flood *flood, uint32_t f, int k) {
    const gxb_boolean *b = flood->b;
    const uint32_t from = b->mesh.subtriangles[f].state;
    const gxbp_state_step *step;
    uint32_t list = b->mesh.subtriangles[f].labels[k], operand;
    int change;
    if (list == GXBP_LOOSE || list == GXBP_BARE) return from;
    if (b->mesh.links[list].next != GXBP_BARE) return GXBP_NO_ANSWER;
    change = gxbp_label_step_by_filter(flood, f, k, b->mesh.links[list].value);
    if (change == 0) return from;
    if (change == 2) return GXBP_NO_ANSWER;
    operand = b->in.sources[b->mesh.links[list].value].operand;
    step = gxbp_step_place(flood->b, from, operand, change);
    return step->change == change && step->from == from && step->operand == operand ? step->to : GXBP_NO_ANSWER;
}

/* As gxbp_spread_within. 0: the flood waits, or is stuck. */
static int gxbp_flood_within(gxbp_flood *flood) {
    gxbp_subtriangle *sub = flood->b->mesh.subtriangles;
    while (flood->stack_count > 0) {
        const uint32_t f = flood->stack[--flood->stack_count];
        for (; flood->k < 3; flood->k++) {
            const uint32_t near = sub[f].near[flood->k];
            uint32_t state;
            if (near == GXB_NONE || sub[near].state != GXB_NONE) continue;
            state = flood->answer != GXBP_NO_ANSWER ? flood->answer : gxbp_known_state_beyond(flood, f, flood->k);
            flood->answer = GXBP_NO_ANSWER;
            flood->waiting = state == GXBP_NO_ANSWER;
            flood->stuck = flood->stack_count + 1 >= GXBP_FLOOD_STACK;
            if (flood->waiting || flood->stuck) {
                flood->stack[flood->stack_count++] = f;
                return 0;
            }
            sub[near].state = state;
            flood->stack[flood->stack_count++] = near;
        }
        flood->k = 0;
    }
    return 1;
}

/* As gxbp_spread_state */
static void gxbp_flood_across(gxbp_flood *flood, uint32_t s) {
    gxb_boolean *b = flood->b;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        const uint32_t twin = b->in.sources[s].twin[k];
        uint32_t g;
        if (twin == GXB_NONE || b->in.sources[twin / 3].flags & (GXBP_REACHED | GXBP_FLAT)) continue;
        g = gxbp_across_rim(b, s, k);
        if (g == GXB_NONE) continue;
        b->mesh.subtriangles[g].state = b->mesh.subtriangles[gxbp_rim_subtriangle(b, s, k)].state;
        b->in.sources[twin / 3].flags |= GXBP_REACHED;
        flood->queue[flood->count++] = g;
    }
}

static void gxbp_run_flood(void *context, size_t i) {
    gxbp_flood *flood = &((gxbp_flood *)context)[i];
    gxb_boolean *b = flood->b;
    flood->waiting = 0;
    for (; flood->next < flood->count && !flood->stuck; flood->next++) {
        const uint32_t f = flood->queue[flood->next], s = b->mesh.subtriangles[f].source;
        if (b->in.sources[s].flags & GXBP_DIVIDED) {
            if (!flood->entered) {
                flood->entered = 1;
                flood->k = 0;
                flood->stack_count = 1;
                flood->stack[0] = f;
            }
            if (!gxbp_flood_within(flood)) return;
            flood->entered = 0;
        }
        gxbp_flood_across(flood, s);
    }
}

/* Answers floods that wait. Returns how many did. */
static GXBP_COLD size_t gxbp_answer_floods(gxb_boolean *b, gxbp_flood *floods, size_t count) {
    size_t i, answered = 0;
    for (i = 0; i < count && b->error == GX_OK; i++) {
        if (!floods[i].waiting || floods[i].stuck) continue;
        floods[i].answer = gxbp_state_beyond(b, floods[i].stack[floods[i].stack_count - 1], floods[i].k);
        answered++;
    }
    return answered;
}

/* Spreads states from where they are new. */
static void gxbp_spread_pending(gxb_boolean *b) {
    while (b->work.pending_count > 0 && b->error == GX_OK)
        gxbp_spread_state(b, b->work.pending[--b->work.pending_count]);
}

/* Goes on where a flood has ended too early. The source at which it is comes first: its neighbours read its states. */
static GXBP_COLD void gxbp_finish_flood(gxb_boolean *b, gxbp_flood *flood) {
    uint32_t i;
    b->store.filter_calls += flood->filter_calls;
    b->work.visit_count = 0;
    if (flood->entered)
        for (i = 0; i < flood->stack_count && b->error == GX_OK; i++) gxbp_spread_within(b, flood->stack[i]);
    for (i = flood->next; i < flood->count && GXBP_ROOM(b, work.pending, work.pending, 1); i++)
        b->work.pending[b->work.pending_count++] = flood->queue[i];
    gxbp_spread_pending(b);
}

/* The first source of an operand that is neither divided nor in a flat; GXB_NONE: there is none */
static uint32_t gxbp_first_whole(const gxb_boolean *b, const gxbp_operand *o) {
    uint32_t s;
    for (s = o->source; s < o->source + o->source_count; s++)
        if (!(b->in.sources[s].flags & (GXBP_DIVIDED | GXBP_FLAT | GXBP_DEGENERATE))) return s;
    return GXB_NONE;
}

static size_t gxbp_begin_floods(gxb_boolean *b, gxbp_flood *floods, uint32_t *queue) {
    size_t count = 0;
    uint32_t i;
    for (i = b->winding.stated; i < b->in.operand_count; i++) {
        const gxbp_operand *o = &b->in.operands[i];
        const uint32_t s = o->source_count < GXBP_PART ? GXB_NONE : gxbp_first_whole(b, o);
        gxbp_flood *flood = &floods[count];
        if (s == GXB_NONE || b->error != GX_OK) continue;
        memset(flood, 0, sizeof *flood);
        flood->b = b;
        flood->answer = GXBP_NO_ANSWER;
        flood->queue = queue;
        flood->queue[flood->count++] = b->in.sources[s].subtriangle;
        gxbp_note_reached(b, s);
        b->in.sources[s].flags |= GXBP_REACHED;
        b->mesh.subtriangles[queue[0]].state = gxbp_state_by_ray(b, queue[0], GXB_NONE, 0);
        queue += o->source_count;
        count++;
    }
    return count;
}

/* left: of each part, whether one of its subtriangles needs a state */
typedef struct gxbp_openings {
    const gxb_boolean *b;
    uint32_t *left;
} gxbp_openings;

static int gxbp_needs_state(const gxb_boolean *b, uint32_t f) {
    return b->mesh.subtriangles[f].state == GXB_NONE && gxbp_is_surface(b, f);
}

static void gxbp_find_open(void *context, size_t part) {
    const gxbp_openings *openings = (const gxbp_openings *)context;
    const gxb_boolean *b = openings->b;
    uint32_t end, i = gxbp_part_first(part, b->mesh.subtriangle_count - b->mesh.stated, &end);
    while (i < end && !gxbp_needs_state(b, b->mesh.stated + i)) i++;
    openings->left[part] = i < end;
}

/* Have the floods reached all? 0 also if there is no memory. */
static GXBP_COLD int gxbp_is_all_flooded(gxb_boolean *b) {
    const size_t parts = gxbp_part_count(b->mesh.subtriangle_count - b->mesh.stated);
    gxbp_openings openings;
    uint32_t left = 0;
    size_t part;
    openings.b = b;
    openings.left = (uint32_t *)gxbp_borrow(b, parts * sizeof *openings.left);
    if (openings.left == NULL) return 0;
    gxbp_each_part(b, parts, gxbp_find_open, &openings);
    for (part = 0; part < parts; part++) left += openings.left[part];
    return left == 0;
}

/* Spreads states in large new operands, if there are at least two. Returns whether all subtriangles have states. */
static GXBP_COLD int gxbp_flood_operands(gxb_boolean *b) {
    size_t count = 0, sources = 0, i;
    uint32_t n, rounds;
    gxbp_flood *floods;
    for (n = b->winding.stated; n < b->in.operand_count; n++)
        if (b->in.operands[n].source_count >= GXBP_PART) {
            count++;
            sources += b->in.operands[n].source_count;
        }
    if (count < 2) return 0;
    floods = (gxbp_flood *)gxbp_borrow(b, count * sizeof *floods + sources * sizeof(uint32_t));
    if (floods == NULL) return 0;
    count = gxbp_begin_floods(b, floods, (uint32_t *)(void *)(floods + count));
    for (rounds = 0; rounds < (uint32_t)GXBP_FLOOD_ROUNDS && b->error == GX_OK; rounds++) {
        gxbp_each_part(b, count, gxbp_run_flood, floods);
        if (gxbp_answer_floods(b, floods, count) == 0) break;
    }
    for (i = 0; i < count; i++) gxbp_finish_flood(b, &floods[i]);
    return gxbp_is_all_flooded(b);
}

/* Finds a state by a ray and spreads it to all subtriangles that can be reached. */
static void gxbp_find_state_of(gxb_boolean *b, uint32_t f) {
    gxbp_note_reached(b, b->mesh.subtriangles[f].source);
    b->mesh.subtriangles[f].state = gxbp_state_by_ray(b, f, GXB_NONE, 0);
    if (!GXBP_ROOM(b, work.pending, work.pending, 1)) return;
    b->work.pending[b->work.pending_count++] = f;
    gxbp_spread_pending(b);
}

/* Finds states where none has come yet. Undivided sources first: their rays are cheap. */
static GXBP_APART void gxbp_find_all_states(gxb_boolean *b) {
    uint32_t s, f;
    for (s = gxbp_new_sources(b); s < b->in.source_count && b->error == GX_OK; s++) {
        f = b->in.sources[s].subtriangle;
        if (!(b->in.sources[s].flags & GXBP_DIVIDED) && f != GXB_NONE && gxbp_needs_state(b, f))
            gxbp_find_state_of(b, f);
    }
    for (f = b->mesh.stated; f < b->mesh.subtriangle_count && b->error == GX_OK; f++)
        if (gxbp_needs_state(b, f)) gxbp_find_state_of(b, f);
}

static GXBP_APART void gxbp_find_states(gxb_boolean *b) {
    uint32_t s;
    if (b->error != GX_OK) return;
    if (b->points.united) gxbp_rename_vertices(b);
    if (b->winding.stated == 0) {
        b->mesh.stated = 0;
        memset(b->winding.steps, 0, sizeof b->winding.steps);
        b->winding.state_count = b->winding.number_count = b->winding.listed = 0;
    }
    gxbp_note_intersections(b, b->winding.stated);
    for (s = b->winding.stated; s < b->in.operand_count; s++) b->in.operands[s].reached = 0;
    b->winding.unreached = b->in.operand_count - b->winding.stated;
    if (b->winding.stated > 0) gxbp_close_states(b);
    b->work.pending_count = b->work.visit_count = 0;
    /* each source and each subtriangle is pushed at most once */
    if (!GXBP_ROOM(b, work.visits, work.visit, (size_t)b->in.source_count + b->mesh.subtriangle_count)) return;
    if (!gxbp_has_jobs(b) || !gxbp_flood_operands(b)) gxbp_find_all_states(b);
    for (s = b->winding.stated; s < b->in.operand_count; s++) b->in.operands[s].reached = 1;
    b->winding.stated = b->in.operand_count;
    b->mesh.stated = b->mesh.subtriangle_count;
}

/* >>result: subtriangles between inside and outside ---------------------------------------------------------------- */
/* In: states. Out: the output's triangles with their sources, its vertices rounded and with their origins, and the
   triangles that rounding turned over. Touches the output only, and the planes of sources that had none. */

/* A coordinate in the input's units, from the frame's */
static double gxbp_unscale(const gxb_boolean *b, double y) {
    const int e = gxbp_exponent_bits(y);
    if (e - b->store.shift <= 0 || e == 0) return 0;
    return gxbp_double(gxbp_bits(y) - ((uint64_t)(int64_t)b->store.shift << 52));
}

#define GXBP_VERTEX_ERROR 1e-10 /* relative to the largest coordinate: a larger ball gives way to exact coordinates */

/* Sign of |num / den| minus the middle of two doubles, which are given by their bits */
static GXBP_RARE int gxbp_beyond_middle(const gxb_num *num, const gxb_num *den, uint64_t low, uint64_t high) {
    GXB_NUM(p);
    GXB_NUM(q);
    GXB_NUM(sum);
    GXB_NUM(middle);
    GXB_NUM(twice);
    gxb_num_set(&p, gxbp_double(low), 0);
    gxb_num_set(&q, gxbp_double(high), 0);
    gxb_num_add(&sum, &p, &q);
    gxb_num_mul(&middle, &sum, den);
    gxb_num_add(&twice, num, num);
    return gxbp_num_compare_magnitude(&twice, &middle);
}

/* The double nearest to num / den; of two equally near, the even one. Starts a few units of the last place away. */
static GXBP_RARE double gxbp_nearest(const gxb_num *num, const gxb_num *den) {
    uint64_t bits = gxbp_bits(gxbp_abs(gxb_num_ratio(num, den)));
    int side;
    if (gxbp_is_zero(gxbp_double(bits))) return 0;
    while ((side = gxbp_beyond_middle(num, den, bits, bits + 1)) > 0 || (side == 0 && (bits & 1))) bits++;
    while ((side = gxbp_beyond_middle(num, den, bits - 1, bits)) < 0 || (side == 0 && (bits & 1))) bits--;
    return gxbp_double(num->sign * den->sign < 0 ? bits | (uint64_t)1 << 63 : bits);
}

static GXBP_COLD void gxbp_round_exactly(gxb_boolean *b, uint32_t point, double out[3]) {
    gxbp_vec store;
    const gxb_num *x = gxbp_exact_cpoint(&b->store, point, &store);
    int k;
    for (k = 0; k < 3; k++) out[k] = gxbp_unscale(b, gxbp_nearest(&x[k], &x[3]));
}

static int gxbp_is_fine(const gxb_boolean *b) { return b->options.fine || b->options.mend != NULL; }

/* An input vertex as it was given; else the ball's middle where the ball is small, else from exact coordinates. */
static void gxbp_round_point(gxb_boolean *b, uint32_t point, double out[3]) {
    const gxb_cpoint *p = &b->store.points[point];
    int k;
    if (p->kind != GXB_EXPLICIT && (gxbp_is_fine(b) || p->ball.error > GXBP_VERTEX_ERROR * gxbp_max3(p->ball.x)))
        gxbp_round_exactly(b, point, out);
    else
        for (k = 0; k < 3; k++) out[k] = gxbp_unscale(b, p->ball.x[k]);
}

static void gxbp_name_source(const gxb_boolean *b, uint32_t s, uint32_t corner, uint32_t *operand, uint32_t *index) {
    *operand = b->in.sources[s].operand;
    *index = s - b->in.operands[*operand].source;
    if (corner < 3) *index = 3 * *index + corner;
}

/* Is a point of its plane in a source, edges included? */
static GXBP_COLD int gxbp_holds_point(gxb_boolean *b, uint32_t s, uint32_t plane, uint32_t point) {
    int k, left = 0, right = 0;
    for (k = 0; k < 3; k++) {
        const int turn =
            gxbp_store_turn(&b->store, b->in.sources[s].point[k], b->in.sources[s].point[(k + 1) % 3], point, plane);
        left |= turn > 0;
        right |= turn < 0;
    }
    return !(left && right);
}

/* The source that contains a point which was found in s. Members of a flat share a triangulation, so it may be another
 * of them. */
static GXBP_RARE uint32_t gxbp_member_at(gxb_boolean *b, uint32_t s, uint32_t point) {
    const uint32_t root = gxbp_root(b, s), plane = b->in.sources[root].plane;
    uint32_t t;
    if (!(b->in.sources[s].flags & GXBP_FLAT) || gxbp_holds_point(b, s, plane, point)) return s;
    for (t = root; t != GXB_NONE && !gxbp_holds_point(b, t, plane, point); t = b->in.sources[t].next) {}
    return t == GXB_NONE ? s : t;
}

static GXBP_APART void gxbp_describe_point(gxb_boolean *b, uint32_t point, gxb_origin *o) {
    const gxb_cpoint *p = &b->store.points[point];
    const uint32_t *key = b->points.vertices[p->kind == GXB_EXPLICIT ? p->def[0] : point].key;
    int k;
    memset(o, 0, sizeof *o);
    o->kind = key[0];
    if (key[0] == GXB_FROM_VERTEX) {
        o->operand[0] = key[1];
        o->index[0] = key[2];
        return;
    }
    if (key[0] == GXB_FROM_THREE_TRIANGLES) {
        for (k = 0; k < 3; k++)
            gxbp_name_source(b, gxbp_member_at(b, key[1 + k], point), 3, &o->operand[k], &o->index[k]);
        return;
    }
    gxbp_name_source(b, key[1] / 3, key[1] % 3, &o->operand[0], &o->index[0]);
    if (key[0] == GXB_FROM_EDGE_EDGE)
        gxbp_name_source(b, key[2] / 3, key[2] % 3, &o->operand[1], &o->index[1]);
    else
        gxbp_name_source(b, key[2], 3, &o->operand[1], &o->index[1]);
}

/* The vertex of a point. vertex: of each point; GXB_NONE: it has none yet */
static uint32_t gxbp_out_vertex(gxb_boolean *b, uint32_t *vertex, uint32_t point) {
    if (vertex[point] != GXB_NONE) return vertex[point];
    if (!GXBP_ROOM(b, out.points, out.point, 1)) return 0;
    b->out.points[b->out.point_count] = point;
    return vertex[point] = b->out.point_count++;
}

/* Is the source one of a sheet (sheets 1) or of a closed surface, and not removed? */
static int gxbp_takes_part(const gxb_boolean *b, uint32_t s, int sheets) {
    const gxbp_operand *o = &b->in.operands[b->in.sources[s].operand];
    return (o->operation == GXB_SPLIT) == sheets && !o->removed;
}

/* A source that covers a subtriangle: one of a sheet (sheets 1) or of a closed surface. GXB_NONE: there is none. */
static uint32_t gxbp_cover_of(const gxb_boolean *b, uint32_t f, int sheets) {
    const uint32_t r = b->mesh.subtriangles[f].source;
    uint32_t c;
    if (b->mesh.subtriangles[f].covers == GXB_NONE) return gxbp_takes_part(b, r, sheets) ? r : GXB_NONE;
    for (c = b->mesh.subtriangles[f].covers; c != GXB_NONE; c = b->mesh.links[c].next)
        if (gxbp_takes_part(b, b->mesh.links[c].value, sheets)) return b->mesh.links[c].value;
    return GXB_NONE;
}

/* The arrays with one item for each triangle grow together. */
static GXBP_APART int gxbp_more_triangles(gxb_boolean *b, size_t extra) {
    return GXBP_ROOM(b, out.operands, out.operand, extra) && GXBP_ROOM(b, out.subtriangles, out.subtriangle, extra) &&
           GXBP_ROOM(b, out.reversed, out.reversed, extra) && GXBP_ROOM(b, out.sources, out.triangle, extra);
}

/* Names triangle i's source, and the subtriangle that it shows. reversed: the outside is behind the subtriangle's
 * plane. */
static inline void gxbp_name_triangle(gxb_boolean *b, uint32_t i, uint32_t f, int reversed, uint32_t source) {
    gxbp_name_source(b, source, 3, &b->out.operands[i], &b->out.sources[i]);
    b->out.subtriangles[i] = 2 * f + (uint32_t)reversed;
    b->out.reversed[i] = reversed != (gxbp_facing(b, b->mesh.subtriangles[f].source, source) < 0);
}

static void gxbp_emit(gxb_boolean *b, uint32_t *vertex, uint32_t f, int reversed, uint32_t source) {
    const uint32_t n = b->out.corner_count, *v = b->mesh.subtriangles[f].v;
    if (!GXBP_ROOM(b, out.triangles, out.corner, 3) ||
        (b->out.triangle_count == b->out.triangle_capacity && !gxbp_more_triangles(b, 1)))
        return;
    b->out.triangles[n] = gxbp_out_vertex(b, vertex, v[0]);
    b->out.triangles[n + 1] = gxbp_out_vertex(b, vertex, v[reversed ? 2 : 1]);
    b->out.triangles[n + 2] = gxbp_out_vertex(b, vertex, v[reversed ? 1 : 2]);
    b->out.corner_count += 3;
    gxbp_name_triangle(b, b->out.triangle_count++, f, reversed, source);
    b->out.operand_count++;
    b->out.subtriangle_count++;
    b->out.reversed_count++;
}

static GXBP_APART void gxbp_set_triangle_count(gxb_boolean *b, uint32_t n) {
    b->out.corner_count = 3 * n;
    b->out.triangle_count = b->out.operand_count = b->out.subtriangle_count = b->out.reversed_count = n;
}

/* What a subtriangle shows in the result: a triangle that faces as its plane does, one that faces against it. A sheet
 * shows both. GXBP_SHOWS_SHEETS: it is inside on both sides, where only sheets show. */
enum { GXBP_SHOWS = 1, GXBP_SHOWS_BACK = 2, GXBP_SHOWS_SHEETS = 4 };

/* Of the last subtriangle judged, if only its own source covers it; else state is GXB_NONE. */
typedef struct gxbp_judgement {
    uint32_t state, operand, shows;
} gxbp_judgement;

static GXBP_APART void gxbp_judge_sides(gxb_boolean *b, uint32_t f, gxbp_judgement *last) {
    const uint32_t behind = gxbp_state_behind(b, f); /* may move the states */
    const gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
    const uint32_t back = gxbp_is_inside(b, behind), front = gxbp_is_inside(b, sub->state);
    last->state = sub->covers == GXB_NONE ? sub->state : GXB_NONE;
    last->operand = b->in.sources[sub->source].operand;
    if (front != 0)
        last->shows = back != 0 ? GXBP_SHOWS_SHEETS : GXBP_SHOWS_BACK;
    else
        last->shows = back != 0 ? GXBP_SHOWS : 0;
}

static inline uint32_t gxbp_judge_subtriangle(gxb_boolean *b, uint32_t f, gxbp_judgement *last) {
    const gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
    if (!gxbp_is_surface(b, f)) return 0;
    if (sub->covers != GXB_NONE || sub->state != last->state || b->in.sources[sub->source].operand != last->operand)
        gxbp_judge_sides(b, f, last);
    if (last->shows != GXBP_SHOWS_SHEETS) return last->shows;
    return gxbp_cover_of(b, f, 1) != GXB_NONE ? GXBP_SHOWS | GXBP_SHOWS_BACK : 0;
}

/* Room for what subtriangles show; those that are new show nothing yet. */
static int gxbp_show_room(gxb_boolean *b) {
    const uint32_t n = b->out.shown_count, added = b->mesh.subtriangle_count - n;
    if (!GXBP_ROOM(b, out.shown, out.shown, added)) return 0;
    memset(b->out.shown + n, 0, added);
    b->out.shown_count = b->mesh.subtriangle_count;
    return 1;
}

/* Does what an older evaluation judged hold, apart from what has changed? An intersection leaves nothing outside of it;
 * what the caller's function says is not known. */
static int gxbp_judgements_hold(const gxb_boolean *b) {
    return b->out.shown_count > 0 && b->options.inside == NULL &&
           b->in.operands[b->in.operand_count - 1].narrowed < b->out.judged;
}

/* Judges what has changed since the last evaluation. */
static GXBP_COLD void gxbp_judge_changed(gxb_boolean *b) {
    gxbp_judgement last = {GXB_NONE, GXB_NONE, 0};
    uint32_t i, f = b->out.shown_count;
    if (!gxbp_show_room(b)) return;
    for (i = 0; i < b->mesh.changed_count; i++)
        b->out.shown[b->mesh.changed[i]] = (uint8_t)gxbp_judge_subtriangle(b, b->mesh.changed[i], &last);
    for (; f < b->mesh.subtriangle_count; f++) b->out.shown[f] = (uint8_t)gxbp_judge_subtriangle(b, f, &last);
}

static void gxbp_emit_shown(gxb_boolean *b, uint32_t *vertex, uint32_t f, uint32_t shows) {
    const int sheet = shows == (GXBP_SHOWS | GXBP_SHOWS_BACK);
    const uint32_t source = gxbp_cover_of(b, f, sheet);
    if (shows & GXBP_SHOWS) gxbp_emit(b, vertex, f, 0, source);
    if (shows & GXBP_SHOWS_BACK) gxbp_emit(b, vertex, f, 1, source);
}

static GXBP_APART void gxbp_extract(gxb_boolean *b) {
    const int judged = gxbp_judgements_hold(b);
    gxbp_judgement last = {GXB_NONE, GXB_NONE, 0};
    uint32_t *vertex, f;
    if (judged) gxbp_judge_changed(b);
    vertex = (uint32_t *)gxbp_borrow(b, b->points.vertex_count * sizeof *vertex);
    if (vertex == NULL || !gxbp_show_room(b)) return;
    memset(vertex, 0xff, b->points.vertex_count * sizeof *vertex);
    gxbp_set_triangle_count(b, 0);
    b->out.point_count = b->out.vertex_count = b->out.origin_count = 0;
    if (!gxbp_more_triangles(b, b->mesh.subtriangle_count / 2) ||
        !GXBP_ROOM(b, out.triangles, out.corner, 3 * (size_t)(b->mesh.subtriangle_count / 2)))
        return;
    for (f = 0; f < b->mesh.subtriangle_count && b->error == GX_OK; f++) {
        if (!judged) b->out.shown[f] = (uint8_t)gxbp_judge_subtriangle(b, f, &last);
        if (b->out.shown[f] != 0) gxbp_emit_shown(b, vertex, f, b->out.shown[f]);
    }
    b->out.judged = b->in.operand_count;
    b->kept.valid = 0;
}

static uint32_t gxbp_out_corner(const gxb_boolean *b, uint32_t t, uint32_t k) {
    return b->out.points[b->out.triangles[3 * t + k % 3]];
}

/* A source that met nothing may have had no plane yet. GXB_NONE: no memory. */
static uint32_t gxbp_out_plane(gxb_boolean *b, uint32_t t) {
    const uint32_t s = b->mesh.subtriangles[b->out.subtriangles[t] / 2].source;
    return gxbp_need_plane(b, s) ? b->in.sources[s].plane : GXB_NONE;
}

/* Copies a triangle's source and orientation. */
static GXBP_COLD void gxbp_copy_origin(gxb_boolean *b, uint32_t to, uint32_t from) {
    b->out.operands[to] = b->out.operands[from];
    b->out.sources[to] = b->out.sources[from];
    b->out.subtriangles[to] = b->out.subtriangles[from];
    b->out.reversed[to] = b->out.reversed[from];
}

/* Removes vertices that no triangle uses, before or after rounding. map: a word for each vertex. */
static GXBP_COLD void gxbp_drop_lonely(gxb_boolean *b, uint32_t *map) {
    const int rounded = b->out.vertex_count > 0;
    uint32_t i, n = 0;
    memset(map, 0xff, b->out.point_count * sizeof *map);
    for (i = 0; i < b->out.corner_count; i++) map[b->out.triangles[i]] = 0;
    for (i = 0; i < b->out.point_count; i++) {
        if (map[i] == GXB_NONE) continue;
        if (rounded) {
            memmove(b->out.vertices + 3 * (size_t)n, b->out.vertices + 3 * (size_t)i, 3 * sizeof *b->out.vertices);
            b->out.origins[n] = b->out.origins[i];
        }
        b->out.points[n] = b->out.points[i];
        map[i] = n++;
    }
    for (i = 0; i < b->out.corner_count; i++) b->out.triangles[i] = map[b->out.triangles[i]];
    b->out.point_count = n;
    if (rounded) {
        b->out.origin_count = n;
        b->out.vertex_count = 3 * n;
    }
}

static void gxbp_round_vertex(gxb_boolean *b, uint32_t i) {
    gxbp_round_point(b, b->out.points[i], b->out.vertices + 3 * (size_t)i);
    gxbp_describe_point(b, b->out.points[i], &b->out.origins[i]);
}

/* Is a vertex rounded and described without exact numbers or names that are looked up? */
static int gxbp_rounds_simply(const gxb_boolean *b, uint32_t point) {
    const gxb_cpoint *p = &b->store.points[point];
    const uint32_t *key = b->points.vertices[point].key;
    if (p->kind == GXB_EXPLICIT) return 1;
    if (gxbp_is_fine(b) || p->ball.error > GXBP_VERTEX_ERROR * gxbp_max3(p->ball.x)) return 0;
    return key[0] != GXB_FROM_THREE_TRIANGLES ||
           !((b->in.sources[key[1]].flags | b->in.sources[key[2]].flags | b->in.sources[key[3]].flags) & GXBP_FLAT);
}

/* left: of each part, how many vertices were not rounded */
typedef struct gxbp_rounding {
    gxb_boolean *b;
    uint32_t *left;
} gxbp_rounding;

static void gxbp_round_part(void *context, size_t part) {
    const gxbp_rounding *r = (const gxbp_rounding *)context;
    uint32_t end, i = gxbp_part_first(part, r->b->out.point_count, &end), left = 0;
    for (; i < end; i++)
        if (gxbp_rounds_simply(r->b, r->b->out.points[i]))
            gxbp_round_vertex(r->b, i);
        else
            left++;
    r->left[part] = left;
}

static GXBP_COLD void gxbp_round_by_parts(gxb_boolean *b) {
    const size_t parts = gxbp_part_count(b->out.point_count);
    gxbp_rounding r;
    size_t part;
    r.b = b;
    r.left = (uint32_t *)gxbp_borrow(b, parts * sizeof *r.left);
    if (r.left == NULL) return;
    gxbp_each_part(b, parts, gxbp_round_part, &r);
    for (part = 0; part < parts; part++) {
        uint32_t end, i = gxbp_part_first(part, b->out.point_count, &end);
        for (; i < end && r.left[part] > 0; i++) {
            if (gxbp_rounds_simply(b, b->out.points[i])) continue;
            gxbp_round_vertex(b, i);
            r.left[part]--;
        }
    }
}

static GXBP_APART void gxbp_round_vertices(gxb_boolean *b) {
    uint32_t i;
    if (b->error != GX_OK || !GXBP_ROOM(b, out.vertices, out.vertex, 3 * (size_t)b->out.point_count) ||
        !GXBP_ROOM(b, out.origins, out.origin, b->out.point_count))
        return;
    if (gxbp_has_jobs(b) && gxbp_part_count(b->out.point_count) > 1)
        gxbp_round_by_parts(b);
    else
        for (i = 0; i < b->out.point_count; i++) gxbp_round_vertex(b, i);
    b->out.vertex_count = 3 * b->out.point_count;
    b->out.origin_count = b->out.point_count;
}

static GXBP_COLD int gxbp_faces_exactly(gxb_boolean *b, uint32_t plane, const double *p, const double *q,
                                        const double *r) {
    gxbp_vec store, given[3];
    gxbp_large n;
    GXB_NUM(value);
    gxbp_vec_set(&given[0], p);
    gxbp_vec_set(&given[1], q);
    gxbp_vec_set(&given[2], r);
    gxbp_large_init(&n);
    gxbp_exact_plane(n.c, given[0].c, given[1].c, given[2].c);
    gxbp_num_dot(&value, n.c, gxbp_exact_cplane(&b->store, plane, &store));
    return value.sign;
}

/* Sign of n.((q - p) x (r - p)) for a plane's normal n and rounded points, exact. The filter's bound is that of
   gxbp_rough_volume, with n for d0. */
static int gxbp_faces(gxb_boolean *b, uint32_t plane, const double *p, const double *q, const double *r) {
    const gxb_plane_filter *f;
    double u[3], v[3], m[3], E, N;
    int k, sign = 0;
    if (plane == GXB_NONE) return 1; /* no memory for it */
    f = &b->store.planes[plane].filter;
    /* else coordinates are not the frame's, and may be too large or too small to filter */
    if (b->store.shift == 0) {
        for (k = 0; k < 3; k++) {
            u[k] = gxbp_fence(q[k] - p[k]);
            v[k] = gxbp_fence(r[k] - p[k]);
        }
        E = gxbp_filter_cross(m, u, 2 * GXBP_U * gxbp_max3(u) + GXBP_TINY, v, 2 * GXBP_U * gxbp_max3(v) + GXBP_TINY);
        N = gxbp_max3(m);
        sign = gxbp_filter_sign(f->n[0] * m[0] + f->n[1] * m[1] + f->n[2] * m[2],
                                6 * (f->norm * E + f->error * (N + E)) + 48 * GXBP_U * f->norm * N + GXBP_TINY);
    }
    return sign != 0 ? sign : gxbp_faces_exactly(b, plane, p, q, r);
}

/* Finds triangles that rounding has turned over or left without area. A triangle of input vertices is no defect unless
 * mending has changed it. */
static GXBP_APART void gxbp_find_defects(gxb_boolean *b) {
    uint32_t t, k;
    b->out.defect_count = 0;
    for (t = 0; t < b->out.triangle_count && b->error == GX_OK; t++) {
        const double *x[3];
        int given = b->options.mend == NULL;
        for (k = 0; k < 3; k++) {
            given = given && b->store.points[gxbp_out_corner(b, t, k)].kind == GXB_EXPLICIT;
            x[k] = b->out.vertices + 3 * (size_t)b->out.triangles[3 * t + k];
        }
        if (given || gxbp_faces(b, gxbp_out_plane(b, t), x[0], x[1], x[2]) == (b->out.subtriangles[t] & 1 ? -1 : 1))
            continue;
        if (GXBP_ROOM(b, out.defects, out.defect, 1)) b->out.defects[b->out.defect_count++] = t;
    }
    b->out.examined = b->error == GX_OK;
}

/* >>retained: a result that keeps its place ------------------------------------------------------------------------ */
/* In: the subtriangles that an evaluation changed, and the result of the evaluation before. Out: the result, changed
   where it differs, and what differs. Triangles stay where they are, unless they fill the place of one that has gone.
   Vertices stay. Touches the output and what keeps it. */

/* Appends to an array count words that are GXB_NONE. */
#define GXBP_PAD(b, array, counter, count)                                                                             \
    ((count) <= (b)->counter##_count ||                                                                                \
     (GXBP_ROOM(b, array, counter, (count) - (b)->counter##_count) &&                                                  \
      (memset((b)->array + (b)->counter##_count, 0xff, ((count) - (b)->counter##_count) * sizeof *(b)->array),         \
       (b)->counter##_count = (uint32_t)(count), 1)))

static void gxbp_note_vertex(gxb_boolean *b, uint32_t v) {
    if (GXBP_ROOM(b, kept.new_vertices, kept.new_vertex, 1)) b->kept.new_vertices[b->kept.new_vertex_count++] = v;
}

static void gxbp_note_triangle(gxb_boolean *b, uint32_t t) {
    if (GXBP_ROOM(b, kept.new_triangles, kept.new_triangle, 1)) b->kept.new_triangles[b->kept.new_triangle_count++] = t;
}

/* The vertex of a point for one more corner */
static uint32_t gxbp_keep_vertex(gxb_boolean *b, uint32_t point) {
    uint32_t v = b->kept.vertices[point];
    if (v == GXB_NONE) {
        if (b->kept.spare_count > 0)
            v = b->kept.spare[--b->kept.spare_count];
        else {
            if (!GXBP_ROOM(b, out.points, out.point, 1) || !GXBP_ROOM(b, kept.uses, kept.use, 1)) return 0;
            v = b->out.point_count++;
            b->kept.use_count++;
        }
        b->out.points[v] = point;
        b->kept.uses[v] = 0; /* a spare one has GXB_NONE */
        b->kept.vertices[point] = v;
        gxbp_note_vertex(b, v);
    }
    b->kept.uses[v]++;
    return v;
}

/* A place for one more triangle: that of one that has gone, or the next. GXB_NONE: no memory. */
static uint32_t gxbp_keep_place(gxb_boolean *b) {
    if (b->kept.hole_count > 0) return b->kept.holes[--b->kept.hole_count];
    if (!GXBP_ROOM(b, out.triangles, out.corner, 3) || !gxbp_more_triangles(b, 1)) return GXB_NONE;
    gxbp_set_triangle_count(b, b->out.triangle_count + 1);
    return b->out.triangle_count - 1;
}

static void gxbp_keep_triangle(gxb_boolean *b, uint32_t f, int reversed, uint32_t source) {
    const uint32_t t = gxbp_keep_place(b), *v = b->mesh.subtriangles[f].v;
    uint32_t k;
    if (t == GXB_NONE) return;
    for (k = 0; k < 3; k++) b->out.triangles[3 * t + k] = gxbp_keep_vertex(b, v[reversed && k > 0 ? 3 - k : k]);
    gxbp_name_triangle(b, t, f, reversed, source);
    b->kept.places[2 * f + (uint32_t)reversed] = t;
    gxbp_note_triangle(b, t);
}

/* Takes a triangle out of the result. Its place is a hole. Vertices without triangles are noted, and sorted out later.
 */
static void gxbp_drop_triangle(gxb_boolean *b, uint32_t t) {
    uint32_t k;
    if (!GXBP_ROOM(b, kept.holes, kept.hole, 1)) return;
    for (k = 0; k < 3; k++) {
        const uint32_t v = b->out.triangles[3 * t + k];
        if (--b->kept.uses[v] == 0) gxbp_note_vertex(b, v);
    }
    b->kept.places[b->out.subtriangles[t]] = GXB_NONE;
    b->out.subtriangles[t] = GXB_NONE;
    b->kept.holes[b->kept.hole_count++] = t;
}

/* Does triangle t have the corners of subtriangle f? */
static int gxbp_still_shows(const gxb_boolean *b, uint32_t t, uint32_t f, int reversed) {
    const gxbp_subtriangle *sub = &b->mesh.subtriangles[f];
    uint32_t k;
    if (sub->source == GXB_NONE) return 0;
    for (k = 0; k < 3; k++)
        if (b->out.points[b->out.triangles[3 * t + k]] != sub->v[reversed && k > 0 ? 3 - k : k]) return 0;
    return 1;
}

/* Takes out triangles of a subtriangle that has other corners now. */
static void gxbp_drop_old(gxb_boolean *b, uint32_t f) {
    int side;
    for (side = 0; side < 2; side++) {
        const uint32_t t = b->kept.places[2 * f + (uint32_t)side];
        if (t != GXB_NONE && !gxbp_still_shows(b, t, f, side)) {
            gxbp_drop_triangle(b, t);
            b->out.shown[f] &= (uint8_t) ~(side ? GXBP_SHOWS_BACK : GXBP_SHOWS);
        }
    }
}

/* Does a triangle of the subtriangle bear the name of an operand that was removed? */
static int gxbp_names_removed(const gxb_boolean *b, uint32_t f) {
    const uint32_t *place = b->kept.places + 2 * (size_t)f;
    int side;
    for (side = 0; side < 2; side++)
        if (place[side] != GXB_NONE && b->in.operands[b->out.operands[place[side]]].removed) return 1;
    return 0;
}

/* Makes the result show what a subtriangle shows now. A triangle that stays bears another name where the other side has
   appeared or gone: a sheet's, or a closed surface's. */
static void gxbp_show_again(gxb_boolean *b, uint32_t f, gxbp_judgement *last) {
    const uint32_t now = gxbp_judge_subtriangle(b, f, last), before = b->out.shown[f];
    uint32_t source;
    int side;
    if (now == before && !gxbp_names_removed(b, f)) return;
    source = gxbp_cover_of(b, f, now == (GXBP_SHOWS | GXBP_SHOWS_BACK));
    for (side = 0; side < 2; side++) {
        const uint32_t bit = side ? GXBP_SHOWS_BACK : GXBP_SHOWS, t = b->kept.places[2 * f + (uint32_t)side];
        if (now & before & bit) {
            gxbp_name_triangle(b, t, f, side, source);
            gxbp_note_triangle(b, t);
        } else if (before & bit)
            gxbp_drop_triangle(b, t);
        else if (now & bit)
            gxbp_keep_triangle(b, f, side, source);
    }
    b->out.shown[f] = (uint8_t)now;
}

/* Points that have other names or definitions keep their vertices. */
static GXBP_COLD void gxbp_rename_kept(gxb_boolean *b) {
    uint32_t i;
    for (i = 0; i < b->points.dropped_count; i++) {
        const uint32_t old = b->points.dropped[i], point = gxbp_same(b, old), v = b->kept.vertices[old];
        if (v == GXB_NONE) continue;
        b->kept.vertices[old] = GXB_NONE;
        b->kept.vertices[point] = v;
        b->out.points[v] = point;
        gxbp_note_vertex(b, v);
    }
}

/* The last triangles fill the holes. */
static void gxbp_fill_holes(gxb_boolean *b) {
    uint32_t n = b->out.triangle_count, i;
    for (i = 0; i < b->kept.hole_count; i++) {
        const uint32_t t = b->kept.holes[i];
        while (n > 0 && b->out.subtriangles[n - 1] == GXB_NONE) n--;
        if (t >= n) continue;
        memcpy(b->out.triangles + 3 * (size_t)t, b->out.triangles + 3 * (size_t)--n, 3 * sizeof *b->out.triangles);
        gxbp_copy_origin(b, t, n);
        b->kept.places[b->out.subtriangles[t]] = t;
        gxbp_note_triangle(b, t);
    }
    b->kept.hole_count = 0;
    gxbp_set_triangle_count(b, n);
}

/* Rounds new vertices; those without triangles become spare. */
static void gxbp_finish_vertices(gxb_boolean *b) {
    const uint32_t added = b->out.point_count - b->out.origin_count;
    uint32_t i;
    if (b->error != GX_OK || !GXBP_ROOM(b, out.vertices, out.vertex, 3 * (size_t)added) ||
        !GXBP_ROOM(b, out.origins, out.origin, added))
        return;
    for (i = 0; i < b->kept.new_vertex_count; i++) {
        const uint32_t v = b->kept.new_vertices[i];
        if (b->kept.uses[v] == GXB_NONE) continue;
        if (b->kept.uses[v] > 0)
            gxbp_round_vertex(b, v);
        else if (GXBP_ROOM(b, kept.spare, kept.spare, 1)) {
            b->kept.vertices[b->out.points[v]] = GXB_NONE;
            b->kept.uses[v] = GXB_NONE;
            b->kept.spare[b->kept.spare_count++] = v;
        }
    }
    b->out.vertex_count = 3 * b->out.point_count;
    b->out.origin_count = b->out.point_count;
}

/* There is no result to change, or its vertices were rounded in another way: the next one is made from nothing. */
static void gxbp_begin_kept(gxb_boolean *b) {
    gxbp_set_triangle_count(b, 0);
    b->out.point_count = b->out.vertex_count = b->out.origin_count = b->out.shown_count = 0;
    b->kept.place_count = b->kept.vertex_count = b->kept.use_count = b->kept.spare_count = b->kept.hole_count = 0;
    b->kept.fine = gxbp_is_fine(b);
}

/* Changes the result of the last evaluation into that of this one. */
static GXBP_COLD void gxbp_patch(gxb_boolean *b) {
    gxbp_judgement last = {GXB_NONE, GXB_NONE, 0};
    uint32_t i, f;
    int all;
    if (!b->kept.valid || b->kept.fine != gxbp_is_fine(b)) gxbp_begin_kept(b);
    all = !gxbp_judgements_hold(b);
    f = all ? 0 : b->out.shown_count;
    b->kept.valid = 0;
    b->kept.new_vertex_count = b->kept.new_triangle_count = 0;
    if (!gxbp_show_room(b) || !GXBP_PAD(b, kept.places, kept.place, 2 * (size_t)b->mesh.subtriangle_count) ||
        !GXBP_PAD(b, kept.vertices, kept.vertex, b->points.vertex_count))
        return;
    gxbp_rename_kept(b);
    for (i = 0; i < b->mesh.changed_count; i++) gxbp_drop_old(b, b->mesh.changed[i]);
    for (i = 0; i < b->mesh.changed_count && b->error == GX_OK; i++) gxbp_show_again(b, b->mesh.changed[i], &last);
    for (; f < b->mesh.subtriangle_count && b->error == GX_OK; f++) gxbp_show_again(b, f, &last);
    gxbp_fill_holes(b);
    gxbp_finish_vertices(b);
    b->out.judged = b->in.operand_count;
    b->kept.valid = b->error == GX_OK;
}

/* Sorts words; work: room for half of them */
static void gxbp_sort_words(uint32_t *p, uint32_t count, uint32_t *work) {
    const uint32_t half = count / 2;
    uint32_t i, j, k;
    if (count < 2) return;
    gxbp_sort_words(p, half, work);
    gxbp_sort_words(p + half, count - half, work);
    memcpy(work, p, half * sizeof *p);
    for (i = 0, j = half, k = 0; i < half; k++) p[k] = j < count && p[j] < work[i] ? p[j++] : work[i++];
}

/* Turns a list of indices into ranges below end. ranges: room for one for each of them. Returns their number. */
static uint32_t gxbp_make_ranges(gxb_boolean *b, uint32_t *list, uint32_t count, uint32_t end, gxb_range *ranges) {
    uint32_t *work = (uint32_t *)gxbp_borrow(b, count * sizeof *work), i, n = 0;
    if (work == NULL) return 0;
    gxbp_sort_words(list, count, work);
    for (i = 0; i < count && list[i] < end; i++) {
        if (i > 0 && list[i] == list[i - 1]) continue;
        if (n > 0 && ranges[n - 1].first + ranges[n - 1].count == list[i]) {
            ranges[n - 1].count++;
            continue;
        }
        ranges[n].first = list[i];
        ranges[n++].count = 1;
    }
    return n;
}

/* Ranges of what the last evaluation changed; all, if its result was made from nothing. */
static GXBP_COLD void gxbp_find_changes(gxb_boolean *b) {
    gxbp_kept *kept = &b->kept;
    if (!kept->valid) kept->new_vertex_count = kept->new_triangle_count = 0;
    if (!GXBP_ROOM(b, kept.vertex_ranges, kept.vertex_range, kept->new_vertex_count + 1) ||
        !GXBP_ROOM(b, kept.triangle_ranges, kept.triangle_range, kept->new_triangle_count + 1))
        return;
    if (kept->valid) {
        kept->vertex_range_count =
            gxbp_make_ranges(b, kept->new_vertices, kept->new_vertex_count, b->out.point_count, kept->vertex_ranges);
        kept->triangle_range_count = gxbp_make_ranges(b, kept->new_triangles, kept->new_triangle_count,
                                                      b->out.triangle_count, kept->triangle_ranges);
        return;
    }
    kept->vertex_range_count = b->out.point_count > 0;
    kept->triangle_range_count = b->out.triangle_count > 0;
    kept->vertex_ranges[0].first = kept->triangle_ranges[0].first = 0;
    kept->vertex_ranges[0].count = b->out.point_count;
    kept->triangle_ranges[0].count = b->out.triangle_count;
}

/* >>coarse: fewer triangles of the same surface -------------------------------------------------------------------- */
/* In: the output's triangles before rounding. Out: each face in fewer triangles. Vertices that no outline needs are
   removed one by one, and the polygons around them filled again. Touches the output's triangles and points. */

/* The triangles of a face around a vertex, from outline to outline or all around. hint: one of the half-edges that
 * leave it there. */
typedef struct gxbp_fan {
    uint32_t vertex, hint, next;
} gxbp_fan;

/* A vertex of the polygon that the triangles of a fan fill */
typedef struct gxbp_fan_vertex {
    uint32_t fan;           /* the fan around it in the same face */
    uint32_t near;          /* the half-edge beyond the edge to the next vertex; GXB_NONE: none in the face */
    uint32_t before, after; /* in the polygon */
} gxbp_fan_vertex;

/* Half-edges are 3 t + k. */
typedef struct gxbp_coarse {
    /* of each half-edge: the one across it in the same face, GXB_NONE on the face's outline */
    uint32_t *near;
    /* of each half-edge: the fan that it leaves from; GXB_NONE: its triangle is gone */
    uint32_t *corner;
    gxbp_fan *fans;
    uint32_t fan_count;
    uint32_t *first;  /* of each vertex: its fans */
    uint32_t *degree; /* of each vertex: edges of outlines that end there */
} gxbp_coarse;

/* 1: triangle u is of t's face and faces as it does, -1: the other way (a sheet's other side), 0: it is of another
 * face. */
static int gxbp_same_face(gxb_boolean *b, uint32_t t, uint32_t u) {
    const int facing = b->out.subtriangles[t] & 1 ? -1 : 1;
    uint32_t plane, k;
    if (b->out.operands[t] == b->out.operands[u] && b->out.sources[t] == b->out.sources[u])
        return b->out.subtriangles[u] & 1 ? -facing : facing;
    if (b->options.triangulation != GXB_MERGED) return 0;
    plane = gxbp_out_plane(b, t);
    if (plane == GXB_NONE) return 0;
    for (k = 0; k < 3 && gxbp_out_plane(b, u) != plane; k++)
        if (gxbp_point_side(b, gxbp_out_corner(b, u, k), plane) != 0) return 0;
    return facing *
           gxbp_plane_turn(b, plane, gxbp_out_corner(b, u, 0), gxbp_out_corner(b, u, 1), gxbp_out_corner(b, u, 2));
}

/* Joins the half-edges between p and q that face alike, if all are of one face. 0: the edge belongs to an outline. */
static int gxbp_pair_edge(gxb_boolean *b, const gxbp_exits *exits, uint32_t p, uint32_t q, uint32_t *near) {
    uint32_t found[2][2], pass, i, first = GXB_NONE;
    memset(found, 0xff, sizeof found);
    for (pass = 0; pass < 2; pass++) {
        const uint32_t from = pass == 0 ? p : q, to = pass == 0 ? q : p;
        for (i = exits->first[from]; i < exits->first[from + 1]; i++) {
            const uint32_t h = exits->list[i].half_edge;
            int facing;
            if (exits->list[i].to != to) continue;
            if (first == GXB_NONE) first = h / 3;
            facing = gxbp_same_face(b, first, h / 3);
            if (facing == 0 || found[pass][facing > 0] != GXB_NONE) return 0;
            found[pass][facing > 0] = h;
        }
    }
    for (i = 0; i < 2; i++)
        if ((found[0][i] == GXB_NONE) != (found[1][i] == GXB_NONE)) return 0;
    for (i = 0; i < 2; i++)
        if (found[0][i] != GXB_NONE) {
            near[found[0][i]] = found[1][i];
            near[found[1][i]] = found[0][i];
        }
    return 1;
}

static void gxbp_find_outlines(gxb_boolean *b, const gxbp_exits *exits, gxbp_coarse *c) {
    uint32_t p, i, j;
    for (p = 0; p < b->out.point_count; p++)
        for (i = exits->first[p]; i < exits->first[p + 1]; i++) {
            const uint32_t q = exits->list[i].to;
            if (q < p || c->near[exits->list[i].half_edge] != GXB_NONE) continue;
            for (j = exits->first[p]; j < i && exits->list[j].to != q; j++) {}
            if (j < i || gxbp_pair_edge(b, exits, p, q, c->near)) continue;
            c->degree[p]++;
            c->degree[q]++;
        }
}

static void gxbp_make_fans(const gxb_boolean *b, gxbp_coarse *c) {
    uint32_t h, e;
    for (h = 0; h < b->out.corner_count; h++) {
        const uint32_t u = c->fan_count, v = b->out.triangles[h];
        if (c->corner[h] != GXB_NONE) continue;
        c->fans[u].vertex = v;
        c->fans[u].hint = h;
        c->fans[u].next = c->first[v];
        c->first[v] = c->fan_count++;
        for (e = h; e != GXB_NONE && c->corner[e] == GXB_NONE; e = c->near[gxbp_last_edge(e)]) c->corner[e] = u;
        for (e = c->near[h]; e != GXB_NONE && c->corner[gxbp_next_edge(e)] == GXB_NONE; e = c->near[gxbp_next_edge(e)])
            c->corner[gxbp_next_edge(e)] = u;
    }
}

/* Lists a fan's triangles, and the vertices of the polygon that they fill. 1: the fan is open; its vertex lies on the
   edge from the last vertex to the first. */
static int gxbp_open_fan(gxb_boolean *b, const gxbp_coarse *c, uint32_t u) {
    uint32_t start = c->fans[u].hint, e = start, n;
    while (c->near[e] != GXB_NONE && (e = gxbp_next_edge(c->near[e])) != start) {}
    start = e;
    b->work.fan_vertex_count = b->work.fan_triangle_count = 0;
    do {
        n = gxbp_next_edge(e);
        if (!GXBP_ROOM(b, work.fan_vertices, work.fan_vertex, 2) ||
            !GXBP_ROOM(b, work.fan_triangles, work.fan_triangle, 1))
            return 0;
        b->work.fan_vertices[b->work.fan_vertex_count].fan = c->corner[n];
        b->work.fan_vertices[b->work.fan_vertex_count++].near = c->near[n];
        b->work.fan_triangles[b->work.fan_triangle_count++] = e / 3;
        n = gxbp_next_edge(n);
        e = c->near[n];
    } while (e != GXB_NONE && e != start);
    if (e == start) return 0;
    b->work.fan_vertices[b->work.fan_vertex_count].fan = c->corner[n];
    b->work.fan_vertices[b->work.fan_vertex_count++].near = GXB_NONE;
    return 1;
}

static uint32_t gxbp_coarse_point(const gxb_boolean *b, const gxbp_coarse *c, uint32_t u) {
    return b->out.points[c->fans[u].vertex];
}

static void gxbp_link_half_edges(uint32_t *near, uint32_t h, uint32_t other) {
    near[h] = other;
    if (other != GXB_NONE) near[other] = h;
}

/* A triangle of the polygon's vertices p, q and r, one after the other; what is left has an edge from p to r. */
static void gxbp_fill_corner(gxb_boolean *b, gxbp_coarse *c, uint32_t p, uint32_t q, uint32_t r) {
    const uint32_t h = 3 * b->work.fan_triangles[--b->work.fan_triangle_count];
    uint32_t k;
    c->corner[h] = b->work.fan_vertices[p].fan;
    c->corner[h + 1] = b->work.fan_vertices[q].fan;
    c->corner[h + 2] = b->work.fan_vertices[r].fan;
    for (k = 0; k < 3; k++) c->fans[c->corner[h + k]].hint = h + k;
    gxbp_link_half_edges(c->near, h, b->work.fan_vertices[p].near);
    gxbp_link_half_edges(c->near, h + 1, b->work.fan_vertices[q].near);
    c->near[h + 2] = GXB_NONE;
    b->work.fan_vertices[p].near = h + 2;
}

/* Fills the polygon of a fan around v. All of it is visible from v. It stays so if a convex corner is cut off whose two
   neighbours are seen from v under no more than a straight angle: then v is left of the new edge or on it. At most two
   corners, adjacent ones, have neighbours seen under more. A polygon has three convex corners, so one of these serves.
   If v lies on an edge, the two are the ends of that edge. */
static void gxbp_fill_fan(gxb_boolean *b, gxbp_coarse *c, uint32_t plane, uint32_t v) {
    gxbp_fan_vertex *polygon = b->work.fan_vertices;
    const int facing = b->out.subtriangles[b->work.fan_triangles[0]] & 1 ? -1 : 1;
    uint32_t n = b->work.fan_vertex_count, i, q = 0, tried = 0;
    for (i = 0; i < n; i++) {
        polygon[i].after = (i + 1) % n;
        polygon[i].before = (i + n - 1) % n;
    }
    while (n > 3 && b->error == GX_OK) {
        const uint32_t p = polygon[q].before, r = polygon[q].after, end = gxbp_coarse_point(b, c, polygon[r].fan),
                       start = gxbp_coarse_point(b, c, polygon[p].fan);
        if (facing * gxbp_plane_turn(b, plane, start, gxbp_coarse_point(b, c, polygon[q].fan), end) > 0 &&
            facing * gxbp_plane_turn(b, plane, start, end, v) >= 0) {
            gxbp_fill_corner(b, c, p, q, r);
            polygon[p].after = r;
            polygon[r].before = p;
            q = p;
            n--;
            tried = 0;
        } else if (++tried <= n)
            q = r;
        else
            gxbp_stop(b, GX_ERROR_OVERLAP);
    }
    if (b->error != GX_OK) return;
    gxbp_fill_corner(b, c, polygon[q].before, q, polygon[q].after);
    gxbp_link_half_edges(c->near, polygon[polygon[q].before].near, polygon[polygon[q].after].near);
    for (i = 0; i < b->work.fan_triangle_count; i++) c->corner[3 * b->work.fan_triangles[i]] = GXB_NONE;
}

/* May the vertex be removed? Not where an outline bends, ends or branches. */
static int gxbp_is_needless(gxb_boolean *b, const gxbp_coarse *c, uint32_t v) {
    uint32_t u, plane, ends[2] = {GXB_NONE, GXB_NONE};
    if (c->degree[v] == 0) return 1;
    if (c->degree[v] != 2) return 0;
    for (u = c->first[v]; u != GXB_NONE; u = c->fans[u].next) {
        uint32_t p, q;
        if (!gxbp_open_fan(b, c, u)) continue;
        p = c->fans[b->work.fan_vertices[0].fan].vertex;
        q = c->fans[b->work.fan_vertices[b->work.fan_vertex_count - 1].fan].vertex;
        if (p == q || (ends[0] != GXB_NONE && (p < q ? p : q) != ends[0]) ||
            (ends[0] != GXB_NONE && (p < q ? q : p) != ends[1]))
            return 0;
        if (ends[0] != GXB_NONE) continue;
        ends[0] = p < q ? p : q;
        ends[1] = p < q ? q : p;
        plane = gxbp_out_plane(b, b->work.fan_triangles[0]);
        if (plane == GXB_NONE || gxbp_plane_turn(b, plane, b->out.points[p], b->out.points[v], b->out.points[q]) != 0)
            return 0;
    }
    return b->error == GX_OK;
}

static void gxbp_take_vertex(gxb_boolean *b, gxbp_coarse *c, uint32_t v) {
    uint32_t u, plane;
    for (u = c->first[v]; u != GXB_NONE && b->error == GX_OK; u = c->fans[u].next) {
        gxbp_open_fan(b, c, u);
        if (b->error != GX_OK) return;
        plane = gxbp_out_plane(b, b->work.fan_triangles[0]);
        if (b->error == GX_OK) gxbp_fill_fan(b, c, plane, b->out.points[v]);
    }
}

/* Writes the remaining triangles to the output. */
static void gxbp_close_coarse(gxb_boolean *b, const gxbp_coarse *c) {
    uint32_t t, k, n = 0;
    for (t = 0; t < b->out.triangle_count; t++) {
        if (c->corner[3 * t] == GXB_NONE) continue;
        for (k = 0; k < 3; k++) b->out.triangles[3 * n + k] = c->fans[c->corner[3 * t + k]].vertex;
        gxbp_copy_origin(b, n++, t);
    }
    gxbp_set_triangle_count(b, n);
    gxbp_drop_lonely(b, c->degree);
}

static GXBP_COLD void gxbp_coarsen(gxb_boolean *b) {
    const size_t halves = b->out.corner_count, points = b->out.point_count;
    const size_t bytes = halves * (2 * sizeof(uint32_t) + sizeof(gxbp_fan)) + 2 * points * sizeof(uint32_t);
    gxbp_coarse c;
    gxbp_exits exits;
    uint32_t v;
    if (!gxbp_list_exits(b, b->out.triangles, b->out.triangle_count, b->out.point_count, &exits)) return;
    c.fan_count = 0;
    c.near = (uint32_t *)gxbp_allocate(&b->store.allocator, bytes);
    if (c.near != NULL) {
        memset(c.near, 0xff, (2 * halves + points) * sizeof *c.near);
        c.corner = c.near + halves;
        c.first = c.corner + halves;
        c.degree = c.first + points;
        c.fans = (gxbp_fan *)(void *)(c.degree + points);
        memset(c.degree, 0, points * sizeof *c.degree);
        gxbp_find_outlines(b, &exits, &c);
        gxbp_make_fans(b, &c);
        for (v = 0; v < points && b->error == GX_OK; v++)
            if (gxbp_is_needless(b, &c, v)) gxbp_take_vertex(b, &c, v);
        if (b->error == GX_OK) gxbp_close_coarse(b, &c);
        gxbp_release(&b->store.allocator, c.near, bytes);
    } else
        gxbp_stop(b, GX_ERROR_MEMORY);
    gxbp_drop_exits(b, &exits);
}

/* >>components: shells --------------------------------------------------------------------------------------------- */
/* In: the output. Out: shells, that is sets of triangles joined where the solid between them is connected, and the
   corners of each. Touches the caller's sets, and the twins if the result is mended. */

static uint32_t gxbp_find_set(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void gxbp_join_sets(uint32_t *parent, uint32_t i, uint32_t j) {
    i = gxbp_find_set(parent, i);
    j = gxbp_find_set(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

/* Makes parent[i] the set of i. Parents come before their children. */
static void gxbp_flatten_sets(uint32_t *parent, uint32_t count) {
    uint32_t i;
    for (i = 0; i < count; i++) parent[i] = parent[parent[i]];
}

/* Triangles around an edge from p to q, by angle. Seen along the edge, a triangle that passes it forwards (from p to q)
   has the solid at smaller angles, one that passes it backwards at larger ones. */
typedef struct gxbp_radial {
    uint32_t half_edge, apex, plane;
    int forward, toward, group;
} gxbp_radial;
typedef struct gxbp_radials {
    gxbp_radial *list;
    uint32_t count, capacity;
} gxbp_radials;

/* 1: the apex of g lies at an angle between 0 and pi from f, -1: beyond, 0: in its plane */
static int gxbp_radial_side(gxb_boolean *b, const gxbp_radial *f, const gxbp_radial *g) {
    return f->toward * gxbp_point_side(b, g->apex, f->plane);
}

static int gxbp_radial_precedes(gxb_boolean *b, const gxbp_radial *f, const gxbp_radial *g) {
    int side;
    if (f->group != g->group) return f->group < g->group;
    side = f->group % 2 == 0 ? 0 : gxbp_radial_side(b, f, g);
    return side != 0 ? side > 0 : f->forward && !g->forward;
}

static GXBP_RARE void gxbp_make_radial(gxb_boolean *b, uint32_t h, uint32_t p, const gxbp_radial *first,
                                       gxbp_radial *radial, uint32_t q) {
    radial->half_edge = h;
    radial->apex = gxbp_out_corner(b, h / 3, h % 3 + 2);
    radial->plane = gxbp_out_plane(b, h / 3);
    radial->forward = gxbp_out_corner(b, h / 3, h % 3) == p;
    radial->toward = (b->out.subtriangles[h / 3] & 1 ? -1 : 1) * (radial->forward ? 1 : -1);
    radial->group = 0;
    if (first == NULL) return;
    radial->group = 2 - gxbp_radial_side(b, first, radial); /* 1: first half, 3: second half */
    if (radial->group != 2) return;
    if (gxbp_plane_turn(b, first->plane, p, q, radial->apex) == gxbp_plane_turn(b, first->plane, p, q, first->apex))
        radial->group = 0;
}

/* Around an edge that more than two triangles share: joins the triangles at the two sides of each wedge of the solid,
 * and makes them twins there. */
static GXBP_COLD void gxbp_join_wedges(gxb_boolean *b, const gxbp_exits *exits, uint32_t i, uint32_t j,
                                       uint32_t *parent, uint32_t *twin) {
    const uint32_t p = b->out.points[i], q = b->out.points[j];
    gxbp_radials radials = {NULL, 0, 0};
    uint32_t pass, k, m;
    for (pass = 0; pass < 2; pass++) {
        const uint32_t from = pass == 0 ? i : j, to = pass == 0 ? j : i;
        for (k = exits->first[from]; k < exits->first[from + 1]; k++) {
            gxbp_radial mine, *radial;
            if (exits->list[k].to != to) continue;
            if (!gxbp_room(b, &radials.list, radials.count, &radials.capacity, sizeof *radials.list, 1) ||
                gxbp_out_plane(b, exits->list[k].half_edge / 3) == GXB_NONE)
                break;
            radial = radials.list;
            gxbp_make_radial(b, exits->list[k].half_edge, p, radials.count == 0 ? NULL : radial, &mine, q);
            for (m = radials.count++; m > 1 && gxbp_radial_precedes(b, &mine, &radial[m - 1]); m--)
                radial[m] = radial[m - 1];
            radial[m] = mine;
        }
    }
    for (m = 0; m < radials.count; m++) {
        const uint32_t h = radials.list[m].half_edge, g = radials.list[(m + 1) % radials.count].half_edge;
        if (radials.list[m].forward) continue;
        gxbp_join_sets(parent, h / 3, g / 3);
        twin[h] = g;
        twin[g] = h;
    }
    gxbp_release(&b->store.allocator, radials.list, (size_t)radials.capacity * sizeof *radials.list);
}

/* Counts corners of the solid. The triangles around a vertex that twins join make one corner, which is counted at one
   of them. corners: of each triangle, the number counted there. Uses up the twins. */
static void gxbp_count_corners(uint32_t *twin, uint32_t count, int32_t *corners) {
    uint32_t h, g;
    for (h = 0; h < count; h++) corners[h] = 0;
    for (h = 0; h < 3 * count; h++) {
        if (twin[h] == GXB_NONE) continue;
        corners[h / 3]++;
        for (g = h; twin[g] != GXB_NONE;) { /* from one half-edge that leaves the corner to the next */
            const uint32_t next = twin[g];
            twin[g] = GXB_NONE;
            g = gxbp_last_edge(next);
        }
    }
}

/* Edges that more than two triangles share */
static GXBP_COLD void gxbp_join_all_wedges(gxb_boolean *b, uint32_t *parent, uint32_t *twin) {
    const uint32_t *v = b->out.triangles;
    uint32_t h;
    gxbp_exits exits;
    if (!gxbp_list_exits(b, v, b->out.triangle_count, b->out.point_count, &exits)) return;
    for (h = 0; h < 3 * b->out.triangle_count; h++)
        if (twin[h] == GXB_NONE && v[h] < v[gxbp_next_edge(h)])
            gxbp_join_wedges(b, &exits, v[h], v[gxbp_next_edge(h)], parent, twin);
    gxbp_drop_exits(b, &exits);
}

static GXBP_APART void gxbp_join_shells(gxb_boolean *b, uint32_t *parent, int32_t *corners) {
    const uint32_t count = b->out.triangle_count;
    const size_t words = 3 * (size_t)count;
    uint32_t *twin = (uint32_t *)gxbp_borrow(b, (words + gxbp_twin_room(b->out.point_count)) * sizeof *twin), h, open,
             shared = 0;
    b->out.twin_count = 0;
    if (twin == NULL) return;
    gxbp_find_twins(b->out.triangles, count, b->out.point_count, twin, &open, twin + words);
    for (h = 0; h < 3 * count; h++) {
        if (twin[h] == GXB_NONE)
            shared = 1;
        else if (twin[h] > h && parent[h / 3] != parent[twin[h] / 3])
            gxbp_join_sets(parent, h / 3, twin[h] / 3);
    }
    if (shared) gxbp_join_all_wedges(b, parent, twin);
    if (b->options.mend != NULL && GXBP_ROOM(b, out.twins, out.twin, words))
        memcpy(b->out.twins, twin, words * sizeof *twin);
    gxbp_count_corners(twin, count, corners);
}

/* >>volumes: volumes of shells ------------------------------------------------------------------------------------- */
/* In: the output and its shells. Out: six times the volume of each shell, by sums of doubles with bounds, or from
   coordinates of 180 bits or 720 where these bounds are too large. Touches the caller's arrays only. */

/* Coordinates have 45 bits for each step of division. */
enum { GXBP_FINE_BITS = 45, GXBP_FINE_STEPS = 4, GXBP_FINER_STEPS = 16 };

static GXBP_RARE void gxbp_fine_point(gxb_boolean *b, uint32_t point, int steps, gxbp_vec *fine) {
    gxbp_vec store, rest;
    const gxb_num *x = gxbp_exact_cpoint(&b->store, point, b->store.points[point].kind == GXB_EXPLICIT ? fine : &store);
    int k;
    if (x == fine->c) return;
    gxbp_vec_init(fine);
    gxbp_vec_init(&rest);
    for (k = 0; k < 3; k++) {
        gxbp_num_copy(&rest.c[k], &x[k], 1);
        gxbp_num_divide(&fine->c[k], &rest.c[k], &x[3], steps);
    }
}

/* Coordinates of the result's vertices, each computed once for each number of steps. first: the first of a vertex's
 * limbs. steps: 0 until they are computed */
typedef struct gxbp_fine {
    uint32_t first;
    int steps;
    gxb_num c[3];
} gxbp_fine;
typedef struct gxbp_fines {
    gxbp_fine *vertices;
    gxb_limb *limbs;
    uint32_t limb_count, limb_capacity;
    int steps; /* at work */
} gxbp_fines;

static GXBP_RARE void gxbp_need_fine(gxb_boolean *b, gxbp_fines *fines, uint32_t vertex) {
    const uint32_t point = b->out.points[vertex];
    gxbp_fine *v = &fines->vertices[vertex];
    gxbp_vec x;
    uint32_t k;
    if (v->steps == fines->steps) return;
    gxbp_fine_point(b, point, fines->steps, &x);
    if (!gxbp_room(b, &fines->limbs, fines->limb_count, &fines->limb_capacity, sizeof *fines->limbs,
                   (size_t)x.c[0].n + x.c[1].n + x.c[2].n))
        return;
    v->first = fines->limb_count;
    v->steps = fines->steps;
    for (k = 0; k < 3; k++) {
        v->c[k] = x.c[k];
        memcpy(fines->limbs + fines->limb_count, x.c[k].d, x.c[k].n * sizeof *fines->limbs);
        fines->limb_count += x.c[k].n;
    }
}

/* The coordinates of a vertex that has them; valid until the next vertex gets its own */
static const gxb_num *gxbp_use_fine(gxbp_fines *fines, uint32_t vertex) {
    gxbp_fine *v = &fines->vertices[vertex];
    v->c[0].d = fines->limbs + v->first;
    v->c[1].d = v->c[0].d + v->c[0].n;
    v->c[2].d = v->c[1].d + v->c[1].n;
    return v->c;
}

/* |a| < 2^bits; |a| >= 2^(bits - GXB_LIMB_BITS) unless it is 0 */
static int gxbp_num_bits(const gxb_num *a) { return (a->exp + (int)a->n) * GXB_LIMB_BITS; }

/* total: the sum of det(p, q, r) over a list of triangles, six times what they enclose. Returns whether its relative
   error is below 2^-53. Coordinates are below 2^size and have an error of 2^(size - 45 steps). A determinant is a sum
   of six products of three, so it has an error of 2^5 times that of a coordinate times 2^(2 size). */
static GXBP_RARE int gxbp_sum_fine(gxb_boolean *b, uint32_t t, const uint32_t *next, gxbp_fines *fines,
                                   gxb_num *total) {
    GXB_NUM(term);
    int size = -GXB_NUM_LIMBS * GXB_LIMB_BITS, bits;
    uint32_t k, j, count = 0;
    gxb_num_set(total, 0, 0);
    for (; t != GXB_NONE; t = next[t], count++) {
        const uint32_t *v = b->out.triangles + 3 * (size_t)t;
        for (k = 0; k < 3; k++) gxbp_need_fine(b, fines, v[k]);
        if (b->error != GX_OK) return 1;
        for (k = 0; k < 3; k++)
            for (j = 0; j < 3; j++) {
                bits = gxbp_num_bits(&fines->vertices[v[k]].c[j]);
                if (fines->vertices[v[k]].c[j].sign != 0 && bits > size) size = bits;
            }
        gxbp_num_det3(&term, gxbp_use_fine(fines, v[0]), gxbp_use_fine(fines, v[1]), gxbp_use_fine(fines, v[2]));
        gxbp_num_increase(total, &term, 1);
    }
    bits = 5 + 3 * size - GXBP_FINE_BITS * fines->steps;
    for (; count > 0; count >>= 1) bits++;
    return total->sign != 0 && gxbp_num_bits(total) - GXB_LIMB_BITS > bits + 53;
}

/* Six times the volume of a list of triangles. Its sign tells solids from cavities, so it must be certain. */
static GXBP_RARE double gxbp_fine_volume(gxb_boolean *b, uint32_t t, const uint32_t *next, gxbp_fines *fines) {
    GXB_NUM(total);
    fines->steps = GXBP_FINE_STEPS;
    if (!gxbp_sum_fine(b, t, next, fines, &total)) {
        fines->steps = GXBP_FINER_STEPS;
        (void)gxbp_sum_fine(b, t, next, fines, &total);
    }
    return gxb_num_to_double(&total);
}

/* The error bound of d0 . n, as in >>filter. E and N are error and size of n, e and D those of d0. The errors add
   3 (D E + e (N + E)), rounding adds 8u of three products. */
static double gxbp_volume_error(double D, double e, double N, double E) {
    return 6 * (D * E + e * (N + E)) + 48 * GXBP_U * D * N + GXBP_TINY;
}

/* Six times the volume of the tetrahedron from o to a triangle of the result, d0 . n */
static inline double gxbp_rough_volume(const gxb_boolean *b, uint32_t t, const gxb_ball *o) {
    const gxb_ball *x = &b->store.points[gxbp_out_corner(b, t, 0)].ball;
    double d0[3], d1[3], d2[3], n[3];
    gxbp_difference(d0, o, x);
    gxbp_difference(d1, x, &b->store.points[gxbp_out_corner(b, t, 1)].ball);
    gxbp_difference(d2, x, &b->store.points[gxbp_out_corner(b, t, 2)].ball);
    gxbp_cross(n, d1, d2);
    return d0[0] * n[0] + d0[1] * n[1] + d0[2] * n[2];
}

/* A bound of its error */
static inline double gxbp_rough_error(const gxb_boolean *b, uint32_t t, const gxb_ball *o) {
    const gxb_ball *x = &b->store.points[gxbp_out_corner(b, t, 0)].ball;
    double d0[3], d1[3], d2[3], n[3];
    const double e = gxbp_filter_difference(d0, o, x),
                 e1 = gxbp_filter_difference(d1, x, &b->store.points[gxbp_out_corner(b, t, 1)].ball);
    const double e2 = gxbp_filter_difference(d2, x, &b->store.points[gxbp_out_corner(b, t, 2)].ball),
                 E = gxbp_filter_cross(n, d1, e1, d2, e2);
    return gxbp_volume_error(gxbp_max3(d0), e, gxbp_max3(n), E);
}

/* A bound for all triangles, from the largest error of a vertex and the size S of the box around all vertices, which is
 * enlarged by 8u to cover its rounding */
static double gxbp_largest_rough_error(const gxb_boolean *b) {
    const gxb_ball *first = &b->store.points[b->out.points[0]].ball;
    double low[3], high[3], error = first->error, S = 0, e;
    uint32_t i, k;
    memcpy(low, first->x, sizeof low);
    memcpy(high, first->x, sizeof high);
    for (i = 1; i < b->out.point_count; i++) {
        const gxb_ball *ball = &b->store.points[b->out.points[i]].ball;
        for (k = 0; k < 3; k++) {
            low[k] = gxbp_min(ball->x[k], low[k]);
            high[k] = gxbp_max(ball->x[k], high[k]);
        }
        error = gxbp_max(ball->error, error);
    }
    for (k = 0; k < 3; k++) S = gxbp_max(high[k] - low[k], S);
    S += 8 * GXBP_U * S;
    e = 4 * error + 2 * GXBP_U * S + GXBP_TINY;
    return gxbp_volume_error(S, e, 2 * S * S, 8 * S * e + 4 * e * e + 32 * GXBP_U * S * S + GXBP_TINY);
}

#define GXBP_VOLUME_ERROR 1e-7 /* relative: a sum of doubles with a larger bound is replaced by an exact one */

static int gxbp_is_rough(double volume, double error) { return error > GXBP_VOLUME_ERROR * gxbp_abs(volume); }

/* Sums over the sets. Terms and their bounds are found by parts, and added in the order of triangles. */
typedef struct gxbp_volume_sums {
    gxb_boolean *b;
    const uint32_t *parent;
    double *volume, *error; /* in [root]: the sums */
    double *terms;          /* 2 for each triangle of all parts, or of one */
    double largest;         /* a bound for all triangles; 0: each has its own */
} gxbp_volume_sums;

static int gxbp_has_volume_parts(const gxb_boolean *b) {
    return gxbp_has_jobs(b) && gxbp_part_count(b->out.triangle_count) > 1;
}

static double *gxbp_terms_of(const gxbp_volume_sums *v, size_t part) {
    return v->terms + (gxbp_has_volume_parts(v->b) ? 2 * part * GXBP_PART : 0);
}

static void gxbp_find_volume_terms(void *context, size_t part) {
    const gxbp_volume_sums *v = (const gxbp_volume_sums *)context;
    double *term = gxbp_terms_of(v, part);
    uint32_t end, t = gxbp_part_first(part, v->b->out.triangle_count, &end);
    for (; t < end; t++) {
        const gxb_ball *o = &v->b->store.points[gxbp_out_corner(v->b, v->parent[t], 0)].ball;
        const double value = gxbp_rough_volume(v->b, t, o); /* both first: then they share what they read */
        const double error = v->largest > 0 ? v->largest : gxbp_rough_error(v->b, t, o);
        *term++ = value;
        *term++ = 2 * error;
    }
}

static void gxbp_sum_volumes(gxbp_volume_sums *v) {
    const uint32_t count = v->b->out.triangle_count;
    const size_t parts = gxbp_part_count(count);
    const int all = gxbp_has_volume_parts(v->b);
    uint32_t t, end;
    size_t part;
    if (all) gxbp_each_part(v->b, parts, gxbp_find_volume_terms, v);
    for (t = 0; t < count; t++) v->volume[t] = v->error[t] = 0;
    for (part = 0; part < parts; part++) {
        const double *term = gxbp_terms_of(v, part);
        if (!all) gxbp_find_volume_terms(v, part);
        for (t = gxbp_part_first(part, count, &end); t < end; t++) {
            v->volume[v->parent[t]] += *term++;
            v->error[v->parent[t]] += *term++;
        }
    }
}

static int gxbp_any_is_rough(const gxb_boolean *b, const uint32_t *parent, const double *volume, const double *error) {
    uint32_t t;
    for (t = 0; t < b->out.triangle_count; t++)
        if (parent[t] == t && gxbp_is_rough(volume[t], error[t])) return 1;
    return 0;
}

/* Exact sums where those of doubles are too rough, or of all */
static GXBP_COLD void gxbp_refine_volumes(gxb_boolean *b, const uint32_t *parent, double *volume, double *error,
                                          int all) {
    const uint32_t count = b->out.triangle_count;
    const size_t vertices = b->out.point_count * sizeof(gxbp_fine), bytes = vertices + 2 * count * sizeof(uint32_t);
    gxbp_fines fines = {NULL, NULL, 0, 0, 0};
    uint32_t t, *first, *next;
    fines.vertices = (gxbp_fine *)gxbp_allocate(&b->store.allocator, bytes);
    if (fines.vertices == NULL) {
        gxbp_stop(b, GX_ERROR_MEMORY);
        return;
    }
    first = (uint32_t *)(void *)((char *)fines.vertices + vertices);
    next = first + count;
    memset(first, 0xff, count * sizeof *first);
    for (t = count; t-- > 0;) {
        next[t] = first[parent[t]];
        first[parent[t]] = t;
    }
    for (t = 0; t < b->out.point_count; t++) fines.vertices[t].steps = 0;
    for (t = 0; t < count && b->error == GX_OK; t++)
        if (parent[t] == t && (all || gxbp_is_rough(volume[t], error[t]))) {
            volume[t] = gxbp_fine_volume(b, first[t], next, &fines);
            error[t] = 2 * GXBP_U * gxbp_abs(volume[t]);
        }
    gxbp_release(&b->store.allocator, fines.limbs, fines.limb_capacity * sizeof *fines.limbs);
    gxbp_release(&b->store.allocator, fines.vertices, bytes);
}

/* Doubles that measuring shells takes: 2 for each triangle and the terms */
static size_t gxbp_volume_room(const gxb_boolean *b) {
    const size_t count = b->out.triangle_count;
    return 2 * count + 2 * (gxbp_has_volume_parts(b) || count < GXBP_PART ? count : GXBP_PART);
}

/* Six times the volumes of the sets in volume[root], in the frame's units. One bound for all triangles costs less; it
 * is too large for many. terms: see gxbp_volume_room */
static GXBP_APART void gxbp_measure_shells(gxb_boolean *b, const uint32_t *parent, double *volume, double *error,
                                           double *terms) {
    const int few = b->out.triangle_count <= GXBP_FEW_TRIANGLES;
    gxbp_volume_sums v;
    v.b = b;
    v.parent = parent;
    v.volume = volume;
    v.error = error;
    v.terms = terms;
    v.largest = few ? gxbp_largest_rough_error(b) : 0;
    gxbp_sum_volumes(&v);
    if (!gxbp_any_is_rough(b, parent, volume, error)) return;
    v.largest = 0;
    if (few) gxbp_sum_volumes(&v);
    gxbp_refine_volumes(b, parent, volume, error, 0);
}

/* >>containers: which shell lies in which -------------------------------------------------------------------------- */
/* In: shells with their volumes. Out: components: each shell with its cavities and sheets; volume, Euler characteristic
   and sides of each. Rays along x pass the triangles of one column. Touches the output's components. */

/* gxbp_ray_left for points of the result, and a ray moved by way (h, h^2) */
static GXBP_COLD int gxbp_ray_left_of(gxb_boolean *b, gxbp_ray *ray, uint32_t p, uint32_t q, int way) {
    gxbp_vec s, t;
    const gxb_num *x, *y;
    int turn = gxbp_filter_turn(&b->store.points[p].ball, &b->store.points[q].ball, &ray->ball, 1, 2);
    if (turn != 0) return turn;
    x = gxbp_exact_cpoint(&b->store, p, &s);
    y = gxbp_exact_cpoint(&b->store, q, &t);
    turn = gxbp_orient_exact(x, y, gxbp_exact_probe(b, ray)->exact.c, 1, 2);
    if (turn == 0) turn = way * gxbp_compare_points(b, p, q, 2);
    return turn != 0 ? turn : way * gxbp_compare_points(b, q, p, 1);
}

/* A ray from a triangle. It begins on the side on which the triangle's solid lies. On the other side of a sheet another
 * solid may begin. */
static GXBP_COLD int gxbp_ray_from(gxb_boolean *b, gxbp_ray *ray, uint32_t t) {
    const uint32_t plane = gxbp_out_plane(b, t);
    const int turned = b->out.subtriangles[t] & 1 ? 1 : -1, moved = plane == GXB_NONE ? 0 : gxbp_moved_side(b, plane);
    gxbp_set_ray(b, ray, b->out.subtriangles[t] / 2);
    return moved == 0 ? 1 : moved * turned;
}

/* The change of its shell's winding number where a ray moved by way (h, h^2) passes a triangle */
static GXBP_COLD int gxbp_ray_passes(gxb_boolean *b, gxbp_ray *ray, int way, uint32_t t) {
    const uint32_t plane = gxbp_out_plane(b, t);
    const int facing = b->out.subtriangles[t] & 1 ? -1 : 1;
    double value, bound;
    int left, behind;
    uint32_t c[3], k;
    if (plane == GXB_NONE) return 0;
    for (k = 0; k < 3; k++) c[k] = gxbp_out_corner(b, t, k);
    left = gxbp_ray_left_of(b, ray, c[0], c[1], way);
    if (left == 0 || gxbp_ray_left_of(b, ray, c[1], c[2], way) != left ||
        gxbp_ray_left_of(b, ray, c[2], c[0], way) != left)
        return 0;
    value = gxbp_filter_side(&ray->ball, &b->store.planes[plane].filter, &bound);
    behind = -gxbp_filter_sign(value, bound);
    if (behind == 0) {
        GXB_NUM(side);
        gxbp_vec store;
        gxbp_exact_side(&side, gxbp_exact_probe(b, ray)->exact.c, gxbp_exact_cplane(&b->store, plane, &store));
        behind = -side.sign;
    }
    if (behind == 0) behind = -way * gxbp_moved_side(b, plane);
    if (behind == 0) behind = -facing; /* the other side of the subtriangle, which lies across x */
    return behind * facing == left ? left : 0;
}

/* The shell of triangle t. For a cavity whose container is known: the container */
static uint32_t gxbp_shell_of(const uint32_t *parent, uint32_t t) { return parent[parent[t]]; }

/* A grid of side x side columns along x, and the triangles that rays in each column may pass */
typedef struct gxbp_columns {
    uint32_t *first, *list; /* side x side + 1; where a column's triangles are in the list */
    uint32_t *hit;          /* room for one word per triangle */
    uint32_t side;
    size_t words; /* of the three, which begin with hit */
    double low[2], size[2], margin;
} gxbp_columns;

static uint32_t gxbp_column_at(const gxbp_columns *c, uint32_t k, double x) {
    const double position = (x - c->low[k]) / c->size[k] * c->side;
    return !(position > 0) ? 0 : position >= c->side ? c->side - 1 : (uint32_t)position;
}

/* The columns of a triangle: from[0] to upto[0] along y, from[1] to upto[1] along z; how many they are */
static uint32_t gxbp_columns_of(const gxb_boolean *b, const gxbp_columns *c, uint32_t t, uint32_t from[2],
                                uint32_t upto[2]) {
    uint32_t i, k;
    for (k = 0; k < 2; k++) {
        double low = b->store.points[gxbp_out_corner(b, t, 0)].ball.x[k + 1], high = low;
        for (i = 1; i < 3; i++) {
            const double x = b->store.points[gxbp_out_corner(b, t, i)].ball.x[k + 1];
            low = gxbp_min(x, low);
            high = gxbp_max(x, high);
        }
        from[k] = gxbp_column_at(c, k, low - c->margin);
        upto[k] = gxbp_column_at(c, k, high + c->margin);
    }
    return (upto[0] - from[0] + 1) * (upto[1] - from[1] + 1);
}

/* The margin exceeds the distance of any point or ray from the centre of its ball. */
static void gxbp_bound_columns(const gxb_boolean *b, gxbp_columns *c) {
    const gxb_ball *first = &b->store.points[b->out.points[0]].ball;
    double high[2], error = 0, largest = 0;
    uint32_t i, k;
    memcpy(c->low, first->x + 1, sizeof c->low);
    memcpy(high, first->x + 1, sizeof high);
    for (i = 0; i < b->out.point_count; i++) {
        const gxb_ball *ball = &b->store.points[b->out.points[i]].ball;
        for (k = 0; k < 2; k++) {
            c->low[k] = gxbp_min(ball->x[k + 1], c->low[k]);
            high[k] = gxbp_max(ball->x[k + 1], high[k]);
        }
        error = gxbp_max(ball->error, error);
        largest = gxbp_max(gxbp_max3(ball->x), largest);
    }
    c->margin = 2 * (error + gxbp_power(-48) * largest + GXBP_TINY);
    for (k = 0; k < 2; k++) c->size[k] = high[k] - c->low[k] + c->margin;
}

/* As many columns as triangles; fewer if a triangle would be in more than eight columns on average */
static GXBP_COLD int gxbp_make_columns(gxb_boolean *b, gxbp_columns *c) {
    const uint32_t count = b->out.triangle_count;
    uint32_t side = 1, t, i, j, from[2], upto[2];
    size_t total;
    gxbp_bound_columns(b, c);
    while (side < 1024 && (size_t)side * side < count) side *= 2;
    for (;; side /= 2) {
        c->side = side;
        for (t = 0, total = 0; t < count && total <= 8 * (size_t)count; t++)
            total += gxbp_columns_of(b, c, t, from, upto);
        if (side == 1 || total <= 8 * (size_t)count) break;
    }
    c->words = count + (size_t)side * side + 1 + total;
    c->hit = (uint32_t *)gxbp_allocate(&b->store.allocator, c->words * sizeof *c->hit);
    if (c->hit == NULL) return gxbp_stop(b, GX_ERROR_MEMORY);
    c->first = c->hit + count;
    c->list = c->first + (size_t)side * side + 1;
    memset(c->first, 0, ((size_t)side * side + 1) * sizeof *c->first);
    for (t = 0; t < count; t++) {
        gxbp_columns_of(b, c, t, from, upto);
        for (i = from[0]; i <= upto[0]; i++)
            for (j = from[1]; j <= upto[1]; j++) c->first[i * side + j]++;
    }
    for (i = 1; i <= side * side; i++) c->first[i] += c->first[i - 1];
    for (t = count; t-- > 0;) {
        gxbp_columns_of(b, c, t, from, upto);
        for (i = from[0]; i <= upto[0]; i++)
            for (j = from[1]; j <= upto[1]; j++) c->list[--c->first[i * side + j]] = t;
    }
    return 1;
}

/* The column that a ray is in */
static const uint32_t *gxbp_column_of(const gxbp_columns *c, const gxbp_ray *ray) {
    return c->first + gxbp_column_at(c, 0, ray->ball.x[1]) * c->side + gxbp_column_at(c, 1, ray->ball.x[2]);
}

/* Does shell t lie in shell u? Shells do not cross, so one triangle decides. */
static GXBP_COLD int gxbp_lies_in(gxb_boolean *b, uint32_t t, uint32_t u, const uint32_t *parent,
                                  const gxbp_columns *c) {
    gxbp_ray ray;
    const int way = gxbp_ray_from(b, &ray, t);
    const uint32_t *column = gxbp_column_of(c, &ray);
    int winding = 0;
    uint32_t i;
    for (i = column[0]; i < column[1]; i++)
        if (gxbp_shell_of(parent, c->list[i]) == u) winding += gxbp_ray_passes(b, &ray, way, c->list[i]);
    return winding != 0;
}

/* The innermost shell with volume around a cavity's (or a sheet's) shell. winding: of each triangle; all 0 before and
 * after */
static GXBP_COLD uint32_t gxbp_find_container(gxb_boolean *b, uint32_t cavity, const uint32_t *parent,
                                              const double *volume, int32_t *winding, const gxbp_columns *c) {
    gxbp_ray ray;
    const int way = gxbp_ray_from(b, &ray, cavity);
    const uint32_t *column = gxbp_column_of(c, &ray);
    uint32_t i, hits = 0, best = GXB_NONE;
    for (i = column[0]; i < column[1]; i++) {
        const uint32_t shell = gxbp_shell_of(parent, c->list[i]);
        const int passes = shell == cavity || !(volume[shell] > 0) ? 0 : gxbp_ray_passes(b, &ray, way, c->list[i]);
        if (passes == 0) continue;
        c->hit[hits++] = shell;
        winding[shell] += passes;
    }
    for (i = 0; i < hits; i++) {
        const uint32_t shell = c->hit[i];
        if (winding[shell] != 0 && (best == GXB_NONE || gxbp_lies_in(b, shell, best, parent, c))) best = shell;
        winding[shell] = 0;
    }
    return best;
}

/* Assigns cavities and sheets to their containers. Returns their number. */
static GXBP_APART uint32_t gxbp_place_cavities(gxb_boolean *b, uint32_t *parent, const double *volume,
                                               int32_t *winding) {
    const uint32_t count = b->out.triangle_count;
    gxbp_columns columns;
    uint32_t t, container, cavities = 0;
    columns.hit = NULL;
    columns.words = 0;
    for (t = 0; t < count; t++) {
        if (parent[t] != t || volume[t] > 0) continue;
        if (cavities++ == 0) {
            if (!gxbp_make_columns(b, &columns)) return 0;
            memset(winding, 0, count * sizeof *winding);
        }
        container = gxbp_find_container(b, t, parent, volume, winding, &columns);
        if (container != GXB_NONE) parent[t] = container;
    }
    gxbp_release(&b->store.allocator, columns.hit, columns.words * sizeof *columns.hit);
    return cavities;
}

/* Makes components of the sets. A shell and its cavity may nearly cancel; their difference is then summed again. */
static void gxbp_join_cavities(gxb_boolean *b, uint32_t *parent, double *volume, double *error, int32_t *winding) {
    int rough = 0;
    uint32_t t;
    if (gxbp_place_cavities(b, parent, volume, winding) > 0) {
        gxbp_flatten_sets(parent, b->out.triangle_count);
        for (t = 0; t < b->out.triangle_count; t++) {
            if (parent[t] == t) continue;
            volume[parent[t]] += volume[t];
            error[parent[t]] += error[t];
        }
        rough = gxbp_any_is_rough(b, parent, volume, error);
    }
    if (rough || gxbp_is_fine(b)) gxbp_refine_volumes(b, parent, volume, error, gxbp_is_fine(b));
}

/* number: room for a word per triangle */
static GXBP_APART void gxbp_number_components(gxb_boolean *b, const uint32_t *parent, const double *volume,
                                              uint32_t *number) {
    const uint32_t count = b->out.triangle_count;
    uint32_t t;
    memset(number, 0, count * sizeof *number); /* of a set, + 1 */
    for (t = 0; t < count && b->error == GX_OK; t++) {
        const uint32_t set = parent[t];
        if (number[set] == 0) {
            if (!GXBP_ROOM(b, out.volumes, out.volume, 1)) return;
            b->out.volumes[b->out.volume_count++] = volume[set] / 6;
            number[set] = b->out.volume_count;
        }
        b->out.components[t] = number[set] - 1;
    }
    b->out.component_count = count;
}

/* Euler characteristics: each triangle counts as 1 face and 3 / 2 edges. */
static void gxbp_find_eulers(gxb_boolean *b, const int32_t *corners) {
    uint32_t t;
    b->out.euler_count = 0;
    if (b->error != GX_OK || !GXBP_ROOM(b, out.eulers, out.euler, b->out.volume_count)) return;
    b->out.euler_count = b->out.volume_count;
    for (t = 0; t < b->out.euler_count; t++) b->out.eulers[t] = 0;
    for (t = 0; t < b->out.triangle_count; t++) b->out.eulers[b->out.components[t]] += 2 * corners[t] - 1;
    for (t = 0; t < b->out.euler_count; t++) b->out.eulers[t] /= 2;
}

/* Finds the sides of sheets on which components lie, by the triangles of sheets in their boundaries. */
static GXBP_RARE void gxbp_find_sides(gxb_boolean *b) {
    const size_t n = b->in.operand_count, size = (size_t)b->out.volume_count * n;
    size_t i;
    uint32_t t, sheets = 0;
    b->out.side_count = 0;
    if (b->error != GX_OK || !GXBP_ROOM(b, out.sides, out.side, size)) return;
    memset(b->out.sides, 0, size);
    for (i = 0; i < n; i++) sheets += b->in.operands[i].operation == GXB_SPLIT;
    for (t = 0; t < b->out.triangle_count && sheets > 0; t++) {
        int8_t *side = &b->out.sides[b->out.components[t] * n + b->out.operands[t]];
        const int8_t mine = b->out.reversed[t] ? 1 : -1;
        if (b->in.operands[b->out.operands[t]].operation == GXB_SPLIT) *side = *side == 0 || *side == mine ? mine : 2;
    }
    for (i = 0; i < size && sheets > 0; i++)
        if (b->out.sides[i] == 2) b->out.sides[i] = 0;
    b->out.side_count = (uint32_t)size;
}

/* From the frame's units */
static void gxbp_scale_volumes(gxb_boolean *b) {
    uint32_t i;
    for (i = 0; i < b->out.volume_count; i++) b->out.volumes[i] *= gxbp_power(-3 * b->store.shift);
}

/* parent: sets of triangles; work: room for a word per triangle; corners: see gxbp_count_corners */
static void gxbp_measure_components(gxb_boolean *b, uint32_t *parent, uint32_t *work, const int32_t *corners) {
    const size_t count = b->out.triangle_count;
    double *volume = (double *)gxbp_borrow(b, gxbp_volume_room(b) * sizeof *volume);
    if (volume == NULL) return;
    gxbp_flatten_sets(parent, b->out.triangle_count);
    gxbp_measure_shells(b, parent, volume, volume + count, volume + 2 * count);
    gxbp_join_cavities(b, parent, volume, volume + count, (int32_t *)work);
    gxbp_number_components(b, parent, volume, work);
    gxbp_scale_volumes(b);
    gxbp_find_eulers(b, corners);
}

static GXBP_APART void gxbp_find_components(gxb_boolean *b) {
    const uint32_t count = b->out.triangle_count;
    const size_t bytes = 3 * (size_t)count * sizeof(uint32_t);
    uint32_t *parent, t;
    int32_t *corners;
    b->out.component_count = b->out.volume_count = 0;
    if (b->error != GX_OK || count == 0 || !GXBP_ROOM(b, out.components, out.component, count)) return;
    parent = (uint32_t *)gxbp_allocate(&b->store.allocator, bytes);
    if (parent == NULL) {
        gxbp_stop(b, GX_ERROR_MEMORY);
        return;
    }
    corners = (int32_t *)(void *)(parent + 2 * (size_t)count);
    for (t = 0; t < count; t++) parent[t] = t;
    gxbp_join_shells(b, parent, corners);
    if (b->error == GX_OK) gxbp_measure_components(b, parent, parent + count, corners);
    gxbp_release(&b->store.allocator, parent, bytes);
    gxbp_find_sides(b);
    b->out.measured = b->error == GX_OK;
}

/* >>mend: removing defects within the rounding --------------------------------------------------------------------- */
/* In: the rounded output with its defects, components and twins. Out: fewer defects, or the same. The surface, taken
   apart where it only touches itself, stays closed and keeps its Euler characteristic. Touches the output only. */

/* In units in the last place of the largest coordinate: how near two vertices are that may be merged; how far a
   coordinate may be moved */
#define GXBP_MEND_REACH 4
#define GXBP_MEND_STEPS 2

/* The next half-edge that leaves the same corner of the surface */
static uint32_t gxbp_around(const gxb_boolean *b, uint32_t h) { return b->out.twins[gxbp_last_edge(h)]; }

static const double *gxbp_out_place(const gxb_boolean *b, uint32_t vertex) {
    return b->out.vertices + 3 * (size_t)vertex;
}

/* 1 where a triangle of three vertices would be a defect on the side of triangle t's plane */
static int gxbp_is_defect(gxb_boolean *b, uint32_t t, uint32_t p, uint32_t q, uint32_t r) {
    const int facing = b->out.subtriangles[t] & 1 ? -1 : 1;
    return gxbp_faces(b, gxbp_out_plane(b, t), gxbp_out_place(b, p), gxbp_out_place(b, q), gxbp_out_place(b, r)) !=
           facing;
}

static int gxbp_is_defective(gxb_boolean *b, uint32_t t) {
    const uint32_t *v = b->out.triangles + 3 * (size_t)t;
    return gxbp_is_defect(b, t, v[0], v[1], v[2]);
}

/* A unit in the last place of the largest coordinate of a vertex */
static double gxbp_unit_at(const gxb_boolean *b, uint32_t vertex) {
    const double size = gxbp_max3(gxbp_out_place(b, vertex));
    const int e = gxbp_is_zero(size) ? -1022 : gxbp_exponent(size) - 52;
    return gxbp_power(e < -1022 ? -1022 : e);
}

static int gxbp_are_near(const gxb_boolean *b, uint32_t v, uint32_t w) {
    const double *x = gxbp_out_place(b, v), *y = gxbp_out_place(b, w);
    const double reach = GXBP_MEND_REACH * gxbp_max(gxbp_unit_at(b, v), gxbp_unit_at(b, w));
    int k;
    for (k = 0; k < 3; k++)
        if (gxbp_abs(gxbp_fence(x[k] - y[k])) > reach) return 0;
    return 1;
}

/* Does a vertex that lies near the line through p and q lie between them? */
static int gxbp_is_between(const gxb_boolean *b, uint32_t vertex, uint32_t p, uint32_t q) {
    const double *x = gxbp_out_place(b, vertex), *y = gxbp_out_place(b, p), *z = gxbp_out_place(b, q);
    const double reach = GXBP_MEND_REACH * gxbp_max(gxbp_unit_at(b, p), gxbp_unit_at(b, q));
    int k;
    for (k = 0; k < 3; k++)
        if (gxbp_fence(gxbp_min(y[k], z[k]) - x[k]) > reach || gxbp_fence(x[k] - gxbp_max(y[k], z[k])) > reach)
            return 0;
    return 1;
}

static int gxbp_is_given(const gxb_boolean *b, uint32_t vertex) {
    return b->store.points[b->out.points[vertex]].kind == GXB_EXPLICIT;
}

/* How many edges leave the corner that h leaves. *to: how many of them lead to `vertex` */
static uint32_t gxbp_count_around(const gxb_boolean *b, uint32_t h, uint32_t vertex, uint32_t *to) {
    uint32_t g = h, n = 0;
    *to = 0;
    do {
        n++;
        *to += b->out.triangles[gxbp_next_edge(g)] == vertex;
        g = gxbp_around(b, g);
    } while (g != h);
    return n;
}

static void gxbp_set_out_triangle(gxb_boolean *b, uint32_t t, uint32_t p, uint32_t q, uint32_t r) {
    b->out.triangles[3 * t] = p;
    b->out.triangles[3 * t + 1] = q;
    b->out.triangles[3 * t + 2] = r;
}

static void gxbp_join_out(gxb_boolean *b, uint32_t h, uint32_t g) {
    b->out.twins[h] = g;
    b->out.twins[g] = h;
}

/* Flips the edge of h, from p to q, between triangles (p, q, r) and (q, p, o): it becomes one from r to o. The triangle
   of h has next to no area; the two new ones are of the other's source. r must lie between p and q, else they would
   reach beyond the old ones. */
static int gxbp_flip(gxb_boolean *b, uint32_t h) {
    const uint32_t g = b->out.twins[h], t = h / 3, s = g / 3, h1 = gxbp_next_edge(h), g1 = gxbp_next_edge(g);
    const uint32_t p = b->out.triangles[h], q = b->out.triangles[h1], r = b->out.triangles[gxbp_last_edge(h)],
                   o = b->out.triangles[gxbp_last_edge(g)];
    const uint32_t qr = b->out.twins[h1], rp = b->out.twins[gxbp_last_edge(h)], po = b->out.twins[g1],
                   oq = b->out.twins[gxbp_last_edge(g)];
    uint32_t known;
    if (r == o || qr / 3 == s || rp / 3 == s || !gxbp_is_between(b, r, p, q)) return 0;
    if (gxbp_is_defect(b, s, p, o, r) || gxbp_is_defect(b, s, o, q, r)) return 0; /* one of them might be large */
    gxbp_count_around(b, gxbp_last_edge(h), o, &known);
    if (known != 0) return 0;
    gxbp_set_out_triangle(b, t, p, o, r);
    gxbp_set_out_triangle(b, s, o, q, r);
    gxbp_join_out(b, 3 * t, po);
    gxbp_join_out(b, 3 * t + 1, 3 * s + 2);
    gxbp_join_out(b, 3 * t + 2, rp);
    gxbp_join_out(b, 3 * s, oq);
    gxbp_join_out(b, 3 * s + 1, qr);
    gxbp_copy_origin(b, t, s);
    return 1;
}

/* May the edge of h be collapsed? It may if its ends have just two neighbours in common, each of which keeps three
   edges or more. */
static int gxbp_links_meet(gxb_boolean *b, uint32_t h) {
    const uint32_t g = b->out.twins[h], v = b->out.triangles[h], w = b->out.triangles[g];
    const uint32_t r = gxbp_last_edge(h), o = gxbp_last_edge(g);
    uint32_t e = h, common = 0, known;
    if (b->out.triangles[r] == b->out.triangles[o] || gxbp_count_around(b, h, w, &known) < 3 || known != 1) return 0;
    if (gxbp_count_around(b, r, v, &known) < 4 || gxbp_count_around(b, o, v, &known) < 4) return 0;
    do {
        if (b->out.triangles[gxbp_next_edge(e)] != w) {
            gxbp_count_around(b, g, b->out.triangles[gxbp_next_edge(e)], &known);
            common += known;
        }
        e = gxbp_around(b, e);
    } while (e != h);
    return common == 2;
}

/* Collapses the edge of h: its start becomes its end, if fewer defects are left then. */
static int gxbp_collapse(gxb_boolean *b, uint32_t h) {
    const uint32_t g = b->out.twins[h], v = b->out.triangles[h], w = b->out.triangles[g];
    const uint32_t h1 = gxbp_next_edge(h), h2 = gxbp_next_edge(h1), g1 = gxbp_next_edge(g), g2 = gxbp_next_edge(g1);
    uint32_t e, before = 0, after = 0, last = h;
    if (v == w || gxbp_is_given(b, v) || !gxbp_are_near(b, v, w) || !gxbp_links_meet(b, h)) return 0;
    for (e = gxbp_around(b, h); e != h; e = gxbp_around(b, e)) {
        before += (uint32_t)gxbp_is_defective(b, e / 3);
        if (e != g1)
            after += (uint32_t)gxbp_is_defect(b, e / 3, w, b->out.triangles[gxbp_next_edge(e)],
                                              b->out.triangles[gxbp_last_edge(e)]);
        last = e;
    }
    if (after >= before + (uint32_t)gxbp_is_defective(b, h / 3)) return 0;
    for (e = gxbp_around(b, h);; e = gxbp_around(b, e)) {
        b->out.triangles[e] = w;
        if (e == last) break;
    }
    gxbp_join_out(b, b->out.twins[h1], b->out.twins[h2]);
    gxbp_join_out(b, b->out.twins[g1], b->out.twins[g2]);
    b->out.triangles[3 * (h / 3)] = b->out.triangles[3 * (g / 3)] = GXB_NONE; /* no longer there */
    return 1;
}

/* One pass over the defects. Returns the number of flips and collapses. */
static uint32_t gxbp_mend_edges(gxb_boolean *b) {
    uint32_t i, k, done = 0;
    for (i = 0; i < b->out.defect_count; i++) {
        const uint32_t t = b->out.defects[i];
        int helped = b->out.triangles[3 * t] == GXB_NONE || !gxbp_is_defective(b, t);
        for (k = 0; k < 3 && !helped; k++) helped = gxbp_flip(b, 3 * t + k) && ++done;
        for (k = 0; k < 3 && !helped; k++)
            helped = (gxbp_collapse(b, 3 * t + k) || gxbp_collapse(b, b->out.twins[3 * t + k])) && ++done;
    }
    return done;
}

/* Removes collapsed triangles from all lists. map: a word per triangle. */
static void gxbp_drop_collapsed(gxb_boolean *b, uint32_t *map) {
    const uint32_t count = b->out.triangle_count;
    uint32_t t, k, left = 0;
    for (t = 0; t < count; t++) map[t] = b->out.triangles[3 * t] == GXB_NONE ? GXB_NONE : left++;
    for (t = 0; t < count; t++) {
        const uint32_t n = map[t];
        if (n == GXB_NONE) continue;
        for (k = 0; k < 3; k++) {
            b->out.triangles[3 * n + k] = b->out.triangles[3 * t + k];
            b->out.twins[3 * n + k] = 3 * map[b->out.twins[3 * t + k] / 3] + b->out.twins[3 * t + k] % 3;
        }
        gxbp_copy_origin(b, n, t);
        b->out.components[n] = b->out.components[t];
    }
    gxbp_set_triangle_count(b, left);
    b->out.component_count = left;
    b->out.twin_count = 3 * left;
}

/* How many triangles around a vertex are defects, at all of its corners */
static uint32_t gxbp_defects_at(gxb_boolean *b, const gxbp_exits *exits, uint32_t v) {
    uint32_t i, n = 0;
    for (i = exits->first[v]; i < exits->first[v + 1]; i++)
        n += (uint32_t)gxbp_is_defective(b, exits->list[i].half_edge / 3);
    return n;
}

/* Moves a vertex to a place around its own (home): the first of those with the fewest defects. 1: it moved. */
static int gxbp_move_vertex(gxb_boolean *b, const gxbp_exits *exits, uint32_t v, const double home[3]) {
    enum { WIDTH = 2 * GXBP_MEND_STEPS + 1 };
    double *x = b->out.vertices + 3 * (size_t)v, best[3], old[3];
    const double unit = gxbp_unit_at(b, v);
    uint32_t before = gxbp_defects_at(b, exits, v), least = before, i;
    int k;
    memcpy(old, x, sizeof old);
    memcpy(best, x, sizeof best);
    for (i = 0; i < WIDTH * WIDTH * WIDTH && least > 0; i++) {
        const uint32_t digit[3] = {i % WIDTH, i / WIDTH % WIDTH, i / (WIDTH * WIDTH)};
        uint32_t n;
        for (k = 0; k < 3; k++) {
            const uint32_t steps = (digit[k] + 1) / 2;
            x[k] = gxbp_fence(home[k] + (digit[k] % 2 == 0 ? -(double)steps : (double)steps) * unit);
        }
        n = gxbp_defects_at(b, exits, v);
        if (n < least) {
            least = n;
            memcpy(best, x, sizeof best);
        }
    }
    memcpy(x, least < before ? best : old, sizeof old);
    return least < before;
}

static uint32_t gxbp_mend_places(gxb_boolean *b, const double *home) {
    gxbp_exits exits;
    uint32_t i, k, done = 0;
    if (!gxbp_list_exits(b, b->out.triangles, b->out.triangle_count, b->out.point_count, &exits)) return 0;
    for (i = 0; i < b->out.defect_count; i++)
        for (k = 0; k < 3 && gxbp_is_defective(b, b->out.defects[i]); k++) {
            const uint32_t v = b->out.triangles[3 * b->out.defects[i] + k];
            if (!gxbp_is_given(b, v)) done += (uint32_t)gxbp_move_vertex(b, &exits, v, home + 3 * (size_t)v);
        }
    gxbp_drop_exits(b, &exits);
    return done;
}

/* Mends as long as a step leaves fewer defects. */
static GXBP_COLD void gxbp_mend_defects(gxb_boolean *b) {
    const uint32_t words = b->out.triangle_count > b->out.point_count ? b->out.triangle_count : b->out.point_count;
    const size_t places = 3 * (size_t)b->out.point_count * sizeof(double), bytes = places + words * sizeof(uint32_t);
    double *home;
    uint32_t *map, found = b->out.defect_count, done = 1;
    home = (double *)gxbp_allocate(&b->store.allocator, bytes);
    if (home == NULL) {
        gxbp_stop(b, GX_ERROR_MEMORY);
        return;
    }
    map = (uint32_t *)(void *)((char *)home + places);
    memcpy(home, b->out.vertices, places);
    while (done > 0 && b->out.defect_count > 0 && b->error == GX_OK) {
        done = gxbp_mend_edges(b);
        gxbp_drop_collapsed(b, map);
        gxbp_find_defects(b);
        done += gxbp_mend_places(b, home);
        gxbp_find_defects(b);
    }
    gxbp_drop_lonely(b, map);
    b->out.mended_count = found - b->out.defect_count;
    gxbp_release(&b->store.allocator, home, bytes);
}

/* Components and twins belong to the exact surface, so they are computed before it is changed. */
static GXBP_COLD void gxbp_mend(gxb_boolean *b) {
    gxbp_find_defects(b);
    gxbp_find_components(b);
    if (b->error == GX_OK && b->out.defect_count > 0) gxbp_mend_defects(b);
}

/* >>leaving: operands that are taken out --------------------------------------------------------------------------- */
/* In: an operand that is taken out. Out: what may show something else without it; how much of the arrangement only such
   operands have made; once that is a quarter, the operands that are left, alone, to be arranged anew. Touches all but
   the caller's options. */

#ifndef GXBP_HOLDS_MUCH_DEAD /* sources and segments: dead ones, all; tests replace it */
#define GXBP_HOLDS_MUCH_DEAD(dead, all) ((dead) > (all) / 4)
#endif

/* Lists the subtriangles that may show something else without an operand: those that may meet its box. */
static GXBP_COLD void gxbp_list_near(gxb_boolean *b, const gxbp_box *box) {
    uint32_t i;
    b->work.pending_count = 0;
    gxbp_open_states(b, box);
    if (b->error == GX_OK && GXBP_ROOM(b, mesh.changed, mesh.changed, b->work.pending_count))
        for (i = 0; i < b->work.pending_count; i++) b->mesh.changed[b->mesh.changed_count++] = b->work.pending[i];
    for (i = 0; i < b->work.pending_count; i++) b->mesh.subtriangles[b->work.pending[i]].state &= ~GXBP_OPEN;
}

/* Counts what is dead once an operand is taken out: its sources, its segments, and those that it made in other
   operands, unless these went before and have been counted with them. */
static GXBP_COLD void gxbp_count_dead(gxb_boolean *b, uint32_t operand) {
    const gxbp_operand *o = &b->in.operands[operand];
    uint32_t s, i;
    b->crossings.dead += o->source_count;
    for (s = o->source; s < o->source + o->source_count; s++)
        for (i = b->in.sources[s].segments; i != GXB_NONE; i = b->crossings.segments[i].next) {
            const uint32_t other = b->in.sources[b->crossings.segments[i].label].operand;
            const gxbp_operand *q = &b->in.operands[other];
            if (other == operand)
                b->crossings.dead++;
            else if (!q->removed || operand >= q->removed - 1)
                b->crossings.dead += 2;
        }
}

/* Operands are as they were added, and nothing is arranged. Computed points stay known. */
static GXBP_COLD void gxbp_forget_arrangement(gxb_boolean *b) {
    uint32_t s;
    for (s = b->crossings.dead = 0; s < b->in.operand_count; s++)
        if (b->in.operands[s].removed) b->crossings.dead += b->in.operands[s].source_count;
    b->mesh.subtriangle_count = b->mesh.link_count = b->crossings.segment_count = b->crossings.edge_count =
        b->crossings.edge_point_count = b->crossings.hit_count = b->crossings.dirty_count = 0;
    b->crossings.arranged = b->crossings.segment_mark = b->winding.stated = b->out.shown_count = 0;
    b->kept.valid = 0;
    for (s = 0; s < b->in.source_count; s++) {
        b->in.sources[s].flags &= (uint32_t)GXBP_DEGENERATE;
        gxbp_make_whole(b, s, b->mesh.subtriangle_count++);
    }
}

/* Takes operands that were taken out off the lists of sources and boxes. They keep their indices, and an empty box. */
static GXBP_COLD void gxbp_close_ranks(gxb_boolean *b) {
    uint32_t i, s, k, source = 0, bound = 0, box = 0;
    for (i = 0; i < b->in.operand_count; i++) {
        gxbp_operand *o = &b->in.operands[i];
        const gxbp_tree *t = &o->tree;
        const uint32_t count = o->source_count, leaves = t->size[0], boxes = t->level[t->levels - 1] + 1,
                       back = o->source - source;
        if (o->removed) {
            gxbp_release(&b->store.allocator, o->order, (size_t)count * sizeof *o->order);
            o->order = NULL;
            o->source_count = o->tree.size[0] = o->tree.level[0] = 0;
            o->tree.levels = 1;
            for (k = 0; k < 3; k++) {
                b->in.boxes[box].low[k] = (float)gxbp_power(126);
                b->in.boxes[box].high[k] = -b->in.boxes[box].low[k];
            }
        } else {
            memmove(b->in.sources + source, b->in.sources + o->source, count * sizeof *b->in.sources);
            memmove(b->in.bounds + bound, b->in.bounds + o->bounds, leaves * sizeof *b->in.bounds);
            memmove(b->in.boxes + box, b->in.boxes + t->first, boxes * sizeof *b->in.boxes);
            for (s = 0; s < count; s++) {
                o->order[s] -= back;
                for (k = 0; k < 3; k++)
                    if (b->in.sources[source + s].twin[k] != GXB_NONE) b->in.sources[source + s].twin[k] -= 3 * back;
            }
        }
        o->source = source;
        o->bounds = bound;
        o->tree.first = box;
        source += o->source_count;
        bound += o->tree.size[0];
        box += o->removed ? 1 : boxes;
    }
    b->in.source_count = source;
    b->in.bound_count = bound;
    b->in.box_count = box;
    b->in.leaf_count = b->in.group_count = 0;
    for (i = 0; i < b->in.operand_count; i++) gxbp_list_operand_box(b, i);
}

/* Forgets the points from count on. */
static GXBP_COLD void gxbp_drop_points(gxb_boolean *b, uint32_t count) {
    if (b->points.table_size > 0) gxbp_list_points(b, count);
    b->points.vertex_count = b->store.point_count = count;
}

/* Keeps the input vertices of sources alone, in their order and each as it was when it was added. place: a word for
   each point. Planes and exact numbers are made again when needed. */
static GXBP_COLD void gxbp_keep_corners(gxb_boolean *b, uint32_t *place) {
    uint32_t s, k, i, n = 0;
    memset(place, 0, b->points.vertex_count * sizeof *place);
    for (s = 0; s < b->in.source_count; s++) {
        b->in.sources[s].plane = GXB_NONE;
        for (k = 0; k < 3; k++) place[b->in.sources[s].point[k]] = 1;
    }
    for (i = 0; i < b->points.vertex_count; i++) {
        gxbp_vertex *v = &b->points.vertices[n];
        gxb_cpoint *p = &b->store.points[n];
        uint32_t key[4];
        gxb_ball ball;
        if (!place[i]) continue;
        memcpy(key, b->points.vertices[i].key, sizeof key);
        ball = b->store.points[i].ball;
        memset(v, 0, sizeof *v);
        memset(p, 0, sizeof *p);
        memcpy(v->key, key, sizeof key);
        p->ball = ball;
        p->parameter[0] = -1;
        p->name = p->def[0] = v->same = place[i] = n++;
    }
    for (s = 0; s < b->in.source_count; s++)
        for (k = 0; k < 3; k++) b->in.sources[s].point[k] = place[b->in.sources[s].point[k]];
    gxbp_drop_numbers(&b->store, NULL);
    b->store.plane_count = 0;
    b->store.next_name = n;
    gxbp_drop_points(b, n);
    b->points.merged_count = b->points.projected_count = b->points.run_count = b->points.dropped_count = 0;
    b->points.united = b->points.renamed = 0;
    b->points.reach = 0;
}

/* Once a quarter of the arrangement is dead, the operands that are left are arranged anew. What has died since the last
   time took a share of the time for that. Without memory for it, the arrangement stays. */
static GXBP_COLD void gxbp_drop_dead(gxb_boolean *b) {
    uint32_t *place;
    if (!GXBP_HOLDS_MUCH_DEAD(b->crossings.dead, b->in.source_count + b->crossings.segment_count)) return;
    place = (uint32_t *)gxbp_borrow(b, b->points.vertex_count * sizeof *place);
    if (place == NULL) {
        b->error = GX_OK;
        b->budget.over_limit = 0;
        return;
    }
    gxbp_close_ranks(b);
    gxbp_keep_corners(b, place);
    gxbp_forget_arrangement(b);
    b->mesh.changed_count = 0;
}

/* >>api: the public functions of a Boolean ------------------------------------------------------------------------- */
/* Each checks its arguments and calls the sections above in their order: operands when added; meet to result when
   evaluated; components and defects when first requested. After an error the Boolean holds its operands only. */

static const gxbp_array gxbp_boolean_arrays[] = {/* all that grow */
                                                 GXBP_ARRAY(gxb_boolean, in.operands, in.operand),
                                                 GXBP_ARRAY(gxb_boolean, in.sources, in.source),
                                                 GXBP_ARRAY(gxb_boolean, in.bounds, in.bound),
                                                 GXBP_ARRAY(gxb_boolean, in.boxes, in.box),
                                                 GXBP_ARRAY(gxb_boolean, in.leaves, in.leaf),
                                                 GXBP_ARRAY(gxb_boolean, in.groups, in.group),
                                                 GXBP_ARRAY(gxb_boolean, points.dropped, points.dropped),
                                                 GXBP_ARRAY(gxb_boolean, work.found, work.found),
                                                 GXBP_ARRAY(gxb_boolean, points.vertices, points.vertex),
                                                 GXBP_ARRAY(gxb_boolean, mesh.subtriangles, mesh.subtriangle),
                                                 GXBP_ARRAY(gxb_boolean, mesh.links, mesh.link),
                                                 GXBP_ARRAY(gxb_boolean, crossings.segments, crossings.segment),
                                                 GXBP_ARRAY(gxb_boolean, crossings.edges, crossings.edge),
                                                 GXBP_ARRAY(gxb_boolean, crossings.edge_points, crossings.edge_point),
                                                 GXBP_ARRAY(gxb_boolean, crossings.hits, crossings.hit),
                                                 GXBP_ARRAY(gxb_boolean, crossings.dirty, crossings.dirty),
                                                 GXBP_ARRAY(gxb_boolean, points.projected, points.projected),
                                                 GXBP_ARRAY(gxb_boolean, work.rights, work.right),
                                                 GXBP_ARRAY(gxb_boolean, work.lefts, work.left),
                                                 GXBP_ARRAY(gxb_boolean, work.visits, work.visit),
                                                 GXBP_ARRAY(gxb_boolean, work.crossed, work.crossed),
                                                 GXBP_ARRAY(gxb_boolean, work.fan_vertices, work.fan_vertex),
                                                 GXBP_ARRAY(gxb_boolean, work.fan_triangles, work.fan_triangle),
                                                 GXBP_ARRAY(gxb_boolean, work.segment_ends, work.segment_end),
                                                 GXBP_ARRAY(gxb_boolean, work.box_pairs, work.box_pair),
                                                 GXBP_ARRAY(gxb_boolean, work.encounters, work.encounter),
                                                 GXBP_ARRAY(gxb_boolean, work.pending, work.pending),
                                                 GXBP_ARRAY(gxb_boolean, work.room, work.room),
                                                 GXBP_ARRAY(gxb_boolean, work.ordered, work.ordered),
                                                 GXBP_ARRAY(gxb_boolean, winding.numbers, winding.number),
                                                 GXBP_ARRAY(gxb_boolean, winding.states, winding.state),
                                                 GXBP_ARRAY(gxb_boolean, winding.vector, winding.vector),
                                                 GXBP_ARRAY(gxb_boolean, out.vertices, out.vertex),
                                                 GXBP_ARRAY(gxb_boolean, out.origins, out.origin),
                                                 GXBP_ARRAY(gxb_boolean, out.points, out.point),
                                                 GXBP_ARRAY(gxb_boolean, out.triangles, out.corner),
                                                 GXBP_ARRAY(gxb_boolean, out.operands, out.operand),
                                                 GXBP_ARRAY(gxb_boolean, out.sources, out.triangle),
                                                 GXBP_ARRAY(gxb_boolean, out.components, out.component),
                                                 GXBP_ARRAY(gxb_boolean, out.subtriangles, out.subtriangle),
                                                 GXBP_ARRAY(gxb_boolean, out.volumes, out.volume),
                                                 GXBP_ARRAY(gxb_boolean, out.defects, out.defect),
                                                 GXBP_ARRAY(gxb_boolean, out.reversed, out.reversed),
                                                 GXBP_ARRAY(gxb_boolean, out.sides, out.side),
                                                 GXBP_ARRAY(gxb_boolean, out.eulers, out.euler),
                                                 GXBP_ARRAY(gxb_boolean, out.twins, out.twin),
                                                 GXBP_ARRAY(gxb_boolean, out.shown, out.shown),
                                                 GXBP_ARRAY(gxb_boolean, mesh.changed, mesh.changed),
                                                 GXBP_ARRAY(gxb_boolean, kept.places, kept.place),
                                                 GXBP_ARRAY(gxb_boolean, kept.vertices, kept.vertex),
                                                 GXBP_ARRAY(gxb_boolean, kept.uses, kept.use),
                                                 GXBP_ARRAY(gxb_boolean, kept.spare, kept.spare),
                                                 GXBP_ARRAY(gxb_boolean, kept.holes, kept.hole),
                                                 GXBP_ARRAY(gxb_boolean, kept.new_vertices, kept.new_vertex),
                                                 GXBP_ARRAY(gxb_boolean, kept.new_triangles, kept.new_triangle),
                                                 GXBP_ARRAY(gxb_boolean, kept.vertex_ranges, kept.vertex_range),
                                                 GXBP_ARRAY(gxb_boolean, kept.triangle_ranges, kept.triangle_range)};

static GXBP_COLD void gxbp_drop_boolean(gxb_boolean *b) {
    uint32_t i;
    for (i = 0; i < b->in.operand_count; i++)
        gxbp_release(&b->store.allocator, b->in.operands[i].order,
                     (size_t)b->in.operands[i].source_count * sizeof(uint32_t));
    gxbp_store_destroy(&b->store);
    gxbp_drop_arrays(&b->store.allocator, b, gxbp_boolean_arrays,
                     sizeof gxbp_boolean_arrays / sizeof *gxbp_boolean_arrays);
    gxbp_release(&b->store.allocator, b->points.table, (size_t)b->points.table_size * sizeof *b->points.table);
    gxbp_release(&b->store.allocator, b->winding.table, (size_t)b->winding.table_size * sizeof *b->winding.table);
}

GXFEM_API gx_result gxb_boolean_create(const gxb_boolean_desc *desc, gxb_boolean **boolean, gx_failure *failure) {
    gxb_boolean_desc none;
    gxb_boolean *b;
    size_t arena;
    memset(&none, 0, sizeof none);
    if (boolean == NULL) return gxbp_refuse(failure, "boolean");
    if (desc == NULL) desc = &none;
    if (!gxb_is_allocator(&desc->allocator)) return gxbp_refuse(failure, "allocator");
    if (desc->memory_limit > 0 && desc->memory_limit < sizeof *b)
        return gxbp_fail(failure, GX_ERROR_LIMIT, "memory_limit", SIZE_MAX);
    if (!gxbp_arithmetic_holds(0)) return gxbp_end(failure, GX_ERROR_CONFIGURATION);
    arena = desc->memory_limit == 0 || desc->memory_limit >= 16 * GXBP_ARENA ? GXBP_ARENA : 0;
    b = (gxb_boolean *)gxbp_allocate(&desc->allocator, gxbp_whole_words(sizeof *b) + arena);
    if (b == NULL) return gxbp_end(failure, GX_ERROR_MEMORY);
    memset(b, 0, sizeof *b);
    b->budget.arena = (unsigned char *)b + gxbp_whole_words(sizeof *b);
    b->budget.arena_size = arena;
    b->budget.used = b->budget.peak = gxbp_whole_words(sizeof *b) + arena;
    b->budget.allocations = 1;
    b->budget.outer = desc->allocator;
    b->budget.limit = desc->memory_limit;
    b->options.inside = desc->inside;
    b->options.user = desc->user;
    b->options.jobs = desc->jobs;
    b->store.allocator.allocate = gxbp_count_allocate;
    b->store.allocator.release = gxbp_count_release;
    if (desc->allocator.allocate == NULL || desc->allocator.reallocate != NULL)
        b->store.allocator.reallocate = gxbp_count_reallocate;
    b->store.allocator.user = b;
    *boolean = b;
    return gxbp_end(failure, GX_OK);
}

GXFEM_API void gxb_boolean_destroy(gxb_boolean *boolean) {
    gx_allocator outer;
    if (boolean == NULL) return;
    outer = boolean->budget.outer;
    if (boolean->budget.allocations > 1) gxbp_drop_boolean(boolean); /* else all is in the arena */
    gxbp_release(&outer, boolean, gxbp_whole_words(sizeof *boolean) + boolean->budget.arena_size);
}

GXFEM_API gx_result gxb_boolean_set_triangulation(gxb_boolean *boolean, uint32_t triangulation, gx_failure *failure) {
    if (boolean == NULL) return gxbp_refuse(failure, "boolean");
    if (triangulation > GXB_MERGED) return gxbp_refuse(failure, "triangulation");
    boolean->options.triangulation = triangulation;
    boolean->options.coarsen = triangulation == GXB_DIVIDED ? NULL : gxbp_coarsen;
    return gxbp_end(failure, GX_OK);
}

GXFEM_API gx_result gxb_boolean_set_fine(gxb_boolean *boolean, int fine, gx_failure *failure) {
    if (boolean == NULL) return gxbp_refuse(failure, "boolean");
    boolean->options.fine = fine != 0;
    return gxbp_end(failure, GX_OK);
}

GXFEM_API gx_result gxb_boolean_set_mend(gxb_boolean *boolean, int mend, gx_failure *failure) {
    if (boolean == NULL) return gxbp_refuse(failure, "boolean");
    boolean->options.mend = mend != 0 ? gxbp_mend : NULL;
    return gxbp_end(failure, GX_OK);
}

GXFEM_API gx_result gxb_boolean_set_retained(gxb_boolean *boolean, int retained, gx_failure *failure) {
    if (boolean == NULL) return gxbp_refuse(failure, "boolean");
    boolean->options.patch = retained != 0 ? gxbp_patch : NULL;
    return gxbp_end(failure, GX_OK);
}

static gx_result gxbp_check_operand(const gxb_boolean *b, const gxb_operand *o, gx_failure *failure) {
    uint32_t largest = 0;
    size_t i;
    if (o->operation > GXB_SPLIT) return gxbp_refuse(failure, "operation");
    if (o->rule > GXB_ODD) return gxbp_refuse(failure, "rule");
    if (o->triangle_count == 0) return gxbp_fail(failure, GX_ERROR_EMPTY, "triangle_count", SIZE_MAX);
    if (o->vertex_count == 0) return gxbp_fail(failure, GX_ERROR_EMPTY, "vertex_count", SIZE_MAX);
    if (o->vertices == NULL) return gxbp_refuse(failure, "vertices");
    if (o->triangles == NULL) return gxbp_refuse(failure, "triangles");
    if (o->triangle_count > INT32_MAX / 12 || o->triangle_count + b->in.source_count > INT32_MAX / 12)
        return gxbp_fail(failure, GX_ERROR_LIMIT, "triangle_count", SIZE_MAX);
    if (o->vertex_count > INT32_MAX / 4) return gxbp_fail(failure, GX_ERROR_LIMIT, "vertex_count", SIZE_MAX);
    if (b->in.operand_count > INT32_MAX / 64) return gxbp_end(failure, GX_ERROR_LIMIT);
    for (i = 0; i < 3 * o->triangle_count; i++) largest = o->triangles[i] > largest ? o->triangles[i] : largest;
    if (largest < o->vertex_count) return GX_OK;
    for (i = 0; o->triangles[i] < o->vertex_count; i++) {}
    return gxbp_fail(failure, GX_ERROR_INDEX, "triangles", i / 3);
}

GXFEM_API gx_result gxb_boolean_add(gxb_boolean *b, const gxb_operand *operand, gx_failure *failure) {
    uint32_t sources, subtriangles, points, boxes, bounds;
    size_t bad = SIZE_MAX;
    gx_result result;
    if (b == NULL) return gxbp_refuse(failure, "boolean");
    if (operand == NULL) return gxbp_refuse(failure, "operand");
    result = gxbp_check_operand(b, operand, failure);
    if (result != GX_OK) return result;
    sources = b->in.source_count;
    subtriangles = b->mesh.subtriangle_count;
    points = b->points.vertex_count;
    boxes = b->in.box_count;
    bounds = b->in.bound_count;
    b->error = GX_OK;
    b->budget.over_limit = 0;
    result = b->in.operand_count == 0 ? gxbp_choose_scale(b, operand, &bad) : GX_OK;
    if (result == GX_OK) result = gxbp_append_operand(b, operand, &bad);
    if (result == GX_ERROR_MEMORY && b->budget.over_limit) result = GX_ERROR_LIMIT;
    if (result != GX_OK) {
        b->in.source_count = sources;
        b->in.bound_count = bounds;
        b->mesh.subtriangle_count = subtriangles;
        b->in.box_count = boxes;
        gxbp_drop_points(b, points);
    } else
        b->out.evaluated = 0;
    return result == GX_OK ? gxbp_end(failure, GX_OK)
                           : gxbp_fail(failure, result, gxbp_blamed(result, "vertices", "triangles"), bad);
}

GXFEM_API gx_result gxb_boolean_remove(gxb_boolean *b, uint32_t operand, gx_failure *failure) {
    gxbp_operand *o;
    uint32_t i;
    if (b == NULL) return gxbp_refuse(failure, "boolean");
    if (operand >= b->in.operand_count || b->in.operands[operand].removed)
        return gxbp_fail(failure, GX_ERROR_INDEX, "operand", operand);
    o = &b->in.operands[operand];
    b->error = GX_OK;
    b->budget.over_limit = 0;
    if (b->out.shown_count > 0) gxbp_list_near(b, gxbp_operand_box(b, operand));
    if (b->error != GX_OK) return gxbp_end(failure, b->error);
    /* without an intersection or the first operand, the result may differ anywhere */
    if (operand == b->in.first || o->operation == GXB_INTERSECTION) b->out.judged = 0;
    gxbp_count_dead(b, operand);
    o->removed = 1 + b->crossings.arranged;
    while (b->in.first < b->in.operand_count && b->in.operands[b->in.first].removed) b->in.first++;
    gxbp_note_intersections(b, 0);
    for (i = 0; i < b->winding.state_count; i++) b->winding.states[i].known = 0;
    b->out.evaluated = 0;
    return gxbp_end(failure, GX_OK);
}

/* Makes room for planes of a sixth of the new triangles. Unused room is never touched, and little is copied. */
static void gxbp_presize_planes(gxb_boolean *b) {
    const uint32_t added = b->crossings.arranged < b->in.operand_count
                             ? b->in.source_count - b->in.operands[b->crossings.arranged].source
                             : 0;
    const gx_result result = GXBP_RESERVE(&b->store.allocator, &b->store, planes, plane, added / 6);
    if (result != GX_OK) gxbp_stop(b, result);
}

static GXBP_APART void gxbp_arrange(gxb_boolean *b) {
    uint32_t i, j;
    gxbp_presize_planes(b);
    for (i = b->crossings.arranged; i < b->in.operand_count; i++) {
        if (b->in.operands[i].source_count == 0) continue;
        gxbp_find_operands(b, gxbp_operand_box(b, i), 0, i + 1);
        for (j = 0; j < b->work.found_count && b->error == GX_OK; j++) gxbp_meet_operands(b, i, b->work.found[j]);
    }
    gxbp_order_edges(b);
    if (b->error == GX_OK) gxbp_divide_dirty(b);
    gxbp_merge_points(b);
    b->crossings.segment_mark = b->crossings.segment_count;
    b->crossings.arranged = b->in.operand_count;
}

static GXBP_APART void gxbp_show_result(const gxb_boolean *b, gxb_boolean_result *result) {
    memset(result, 0, sizeof *result);
    result->vertices = b->out.vertices;
    result->vertex_count = b->out.point_count;
    result->triangles = b->out.triangles;
    result->triangle_count = b->out.triangle_count;
    result->vertex_origin = b->out.origins;
    result->triangle_operand = b->out.operands;
    result->triangle_source = b->out.sources;
    result->triangle_reversed = b->out.reversed;
}

GXFEM_API gx_result gxb_boolean_evaluate(gxb_boolean *b, gxb_boolean_result *result, gx_failure *failure) {
    if (b == NULL) return gxbp_refuse(failure, "boolean");
    if (result == NULL) return gxbp_refuse(failure, "result");
    if (b->in.operand_count == 0) return gxbp_fail(failure, GX_ERROR_SEQUENCE, "gxb_boolean_add", SIZE_MAX);
    b->error = GX_OK;
    b->budget.over_limit = b->out.measured = b->out.examined = 0;
    b->out.mended_count = 0;
    if (b->crossings.dead > 0) gxbp_drop_dead(b);
    gxbp_arrange(b);
    gxbp_find_states(b);
    gxbp_forget_answers(b);
    if (b->options.patch != NULL && b->options.coarsen == NULL && b->options.mend == NULL) {
        if (b->error == GX_OK) b->options.patch(b);
    } else {
        if (b->error == GX_OK) gxbp_extract(b);
        if (b->error == GX_OK && b->options.coarsen != NULL && b->out.triangle_count > 0) b->options.coarsen(b);
        gxbp_round_vertices(b);
        if (b->error == GX_OK && b->options.mend != NULL) b->options.mend(b);
    }
    b->crossings.dirty_count = b->points.dropped_count = b->mesh.changed_count = 0;
    b->out.evaluated = b->error == GX_OK;
    if (b->out.evaluated)
        gxbp_show_result(b, result);
    else
        gxbp_forget_arrangement(b);
    return b->error == GX_ERROR_OVERLAP ? gxbp_fail(failure, b->error, "simple", SIZE_MAX)
                                        : gxbp_end(failure, b->error);
}

/* Checks that there is a result, and an address for the answer, an argument of that name. */
static gx_result gxbp_begin_query(gxb_boolean *b, const void *answer, const char *name, gx_failure *failure) {
    if (b == NULL) return gxbp_refuse(failure, "boolean");
    if (answer == NULL) return gxbp_refuse(failure, name);
    if (!b->out.evaluated) return gxbp_fail(failure, GX_ERROR_SEQUENCE, "gxb_boolean_evaluate", SIZE_MAX);
    b->error = GX_OK;
    b->budget.over_limit = 0;
    return GX_OK;
}

GXFEM_API gx_result gxb_boolean_components(gxb_boolean *b, gxb_components *components, gx_failure *failure) {
    const gx_result asked = gxbp_begin_query(b, components, "components", failure);
    uint32_t i;
    if (asked != GX_OK) return asked;
    if (!b->out.measured) gxbp_find_components(b);
    if (gxbp_end(failure, b->error) != GX_OK) return b->error;
    memset(components, 0, sizeof *components);
    components->count = b->out.volume_count;
    components->volume = b->out.volumes;
    components->euler = b->out.eulers;
    components->side = b->out.sides;
    components->triangle = b->out.components;
    for (i = 0; i < b->out.volume_count; i++) components->total_volume += b->out.volumes[i];
    return GX_OK;
}

GXFEM_API gx_result gxb_boolean_defects(gxb_boolean *b, gxb_defects *defects, gx_failure *failure) {
    const gx_result asked = gxbp_begin_query(b, defects, "defects", failure);
    if (asked != GX_OK) return asked;
    if (!b->out.examined) gxbp_find_defects(b);
    if (gxbp_end(failure, b->error) != GX_OK) return b->error;
    defects->triangles = b->out.defects;
    defects->count = b->out.defect_count;
    defects->mended_count = b->out.mended_count;
    return GX_OK;
}

GXFEM_API gx_result gxb_boolean_changes(gxb_boolean *b, gxb_changes *changes, gx_failure *failure) {
    const gx_result asked = gxbp_begin_query(b, changes, "changes", failure);
    if (asked != GX_OK) return asked;
    gxbp_find_changes(b);
    if (gxbp_end(failure, b->error) != GX_OK) return b->error;
    changes->vertices = b->kept.vertex_ranges;
    changes->vertex_range_count = b->kept.vertex_range_count;
    changes->triangles = b->kept.triangle_ranges;
    changes->triangle_range_count = b->kept.triangle_range_count;
    return GX_OK;
}

GXFEM_API gx_result gxb_boolean_statistics(const gxb_boolean *b, gxb_statistics *statistics, gx_failure *failure) {
    if (b == NULL) return gxbp_refuse(failure, "boolean");
    if (statistics == NULL) return gxbp_refuse(failure, "statistics");
    statistics->filter_calls = b->store.filter_calls;
    statistics->exact_calls = b->store.exact_calls;
    statistics->allocations = b->budget.allocations;
    statistics->peak_bytes = b->budget.peak;
    return gxbp_end(failure, GX_OK);
}

#undef GXBP_FETCH
#undef GXBP_COLD
#undef GXBP_RARE
#undef GXBP_APART
#undef GXBP_REGISTER
#undef GXBP_NO_BALL_EXPONENT
#undef GXBP_U
#undef GXBP_INT128
#undef GXBP_TINY
#undef GXBP_NO_BALL
#undef GXBP_UNKNOWN
#undef GXBP_LIMBS
#undef GXBP_RESERVE
#undef GXBP_ARRAY
#undef GXBP_UNDO_ITEM
#undef GXBP_LAST_STAMP
#undef GXBP_TRIANGLE_EDGE
#undef GXBP_IN_ROOT
#undef GXBP_PAIR_U
#undef GXBP_PAIR_RANGE
#undef GXBP_PULLBACK_ERROR
#undef GXBP_PULLBACK_LOSS
#undef GXBP_DEPTH
#undef GXBP_UNSEEN
#undef GXBP_EDGE_LABEL
#undef GXBP_LOOSE
#undef GXBP_BARE
#undef GXBP_ARENA
#undef GXBP_PART
#undef GXBP_HOLDS_MUCH_DEAD
#undef GXBP_IS_SPARSE
#undef GXBP_FAILS
#undef GXBP_PLANS
#undef GXBP_CENSUS_WORDS
#undef GXBP_HAS_ROOM
#undef GXBP_SPARE
#undef GXBP_LARGEST
#undef GXBP_ROOM
#undef GXBP_REMOVED
#undef GXBP_RIM
#undef GXBP_OPEN
#undef GXBP_NO_ANSWER
#undef GXBP_PAD
#undef GXBP_VERTEX_ERROR
#undef GXBP_VOLUME_ERROR
#undef GXBP_MEND_REACH
#undef GXBP_MEND_STEPS
#if defined(GXFEM_SMALL) && defined(__clang__)
#pragma clang attribute pop
#endif
#ifdef GXFEM_SCALAR
#pragma clang attribute pop
#endif
#ifdef __cplusplus
}
#endif
#endif /* GXFEM_BOOLEAN_IMPLEMENTED */
