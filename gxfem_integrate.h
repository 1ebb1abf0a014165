/* SPDX-License-Identifier: MIT */
/* gxfem_integrate.h - exact integrals of polynomials over polyhedra and cut finite elements. Part of gxfem 0.2.0.

   The boundary triangles alone define a polyhedron: no tetrahedralisation, no quadrature points. The
   divergence theorem (GXFEM Eq. 21) turns an integral over the inside into a sum over the triangles, in closed form, to
   any degree; the shape may be non-convex, have tunnels and cavities, or be disconnected. Closed forms for linear
   tetrahedra (gradients, mass, load) and for parts of them (GXFEM Eq. 13, 14) build on it.

   ONE MINUTE

       #define GXFEM_IMPLEMENTATION            // in one source file
       #include "gxfem_integrate.h"
       #include <stdio.h>

       int main(void)
       {
           double p[] = { 0,0,0,  5,0,0,  0,4,0,  0,0,3 };                 // a tetrahedron
           uint32_t t[] = { 0,2,1,  0,1,3,  0,3,2,  1,2,3 };               // outward: counter-clockwise from outside
           gxi_surface surface = { p, 4, t, 4 };
           double moments[20], work[20];                                   // gxi_monomial_count(3) = 20
           if (gxi_polyhedron_monomials(&surface, p, 3, moments, work, NULL) != GX_OK) return 1;
           printf("volume %g, integral of x %g, ", moments[0], moments[1]);                        // 10, 12.5
           printf("of x y z %g\n", moments[gxi_monomial_index(1, 1, 1)]);                          // 5
           return 0;
       }

   CONTENTS (search for the anchors; functions call functions of their own section and of earlier ones only)
       >>shared       result codes
       >>types        the structs
       >>moments      volume, first and second moments: what linear elements need
       >>monomials    all monomials up to a degree: over polyhedra, over surfaces by area, over surfaces by normal
       >>element      linear tetrahedra: gradients, volume, mass
       >>part         parts of a linear tetrahedron: mass, load, loads on cut faces
       >>implementation, then >>config limits, >>math vectors, >>second-order volume, first and second moments,
       >>recurrence monomials, >>validation of surfaces, >>public the other public functions

   THE ORIGIN IS YOURS TO CHOOSE
   Moments are integrals of powers of x - origin. A triangle contributes the signed integral over its cone to the
   origin, with an error of a few roundings (2^-53) of e f r^(d + 1): e, f its edges, r the distance of its farthest
   point, d the degree. So:
   - Put the origin into or beside the polyhedron (a vertex of it, the centre of its box), never far away. Translate the
   result if you want it about another point. A body at 1e8 then loses no more digits than its coordinates had lost.
   - Triangles in a coordinate plane through the origin contribute exactly 0. Hence the parts of an element are
   integrated in its barycentric frame. A corner of size 1e-12 has all its moments to a relative error of 1e-15 if the
   origin is the vertex that it lies at, and a layer on a face likewise if the origin is a vertex of that face.

   WHAT IT DOES NOT DO
   - It does not check that a surface is closed: moments of an open surface are those of its cone to the origin. The
   triangles of a closed surface have area vectors that add up to 0 (gxi_surface_flux_monomials of degree 0 shows it).
   - It does not decide signs exactly: whether an element is flat is decided on the rounded determinant (gxfem_boolean.h
   has exact predicates).
   - It integrates polynomials only. Quadrature rules for other functions can be made from the moments.
   - It allocates nothing, calls nothing but sqrt, keeps no state. Different threads may use it at the same time.

   LIMITS
   - degree <= GXI_DEGREE_MAX. From degree 20 on, monomials are nearly dependent functions: keep |x - origin| about 1.
   - Overflow is refused (GX_ERROR_RANGE) by a bound on |x - origin|^(degree + 3). Underflow is not an error: numbers
   below 1e-308 become 0.
   - No result depends on how the compiler treats infinities and NaN; under -ffast-math the last digits differ.

   CONFIGURATION (before inclusion)
       GXFEM_IMPLEMENTATION             implementation of every gxfem header included
       GXFEM_INTEGRATE_IMPLEMENTATION   of this one only
       GXFEM_STATIC                     all functions static

   REFERENCES
   [GXFEM] Generalized eXtended Finite Element Method for Deformable Cutting via Boolean Operations, 2024. Eq. 13, 14,
   20, 21. [RXFEM] Robust eXtended Finite Elements for Complex Cutting of Deformables, 2017. Section 5 (integrals over
   cut faces). [BBLKV] Baldoni, Berline, De Loera, Koeppe, Vergne: How to integrate a polynomial over a simplex, Math.
   Comp. 80, 2011. [Mirtich] Fast and accurate computation of polyhedral mass properties, J. Graphics Tools 1(2), 1996
   (the ten integrals).
*/
#ifndef GXFEM_INTEGRATE_INCLUDED
#define GXFEM_INTEGRATE_INCLUDED

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

/* >>types ---------------------------------------------------------------------------------------------------------- */

/* The highest degree of a monomial: multinomial coefficients stay below 3^256 = 1e122, and every buffer below 2^27
 * bytes. */
#define GXI_DEGREE_MAX 256

/* Triangles in space, read only, owned by the caller. As the boundary of a polyhedron: closed, counter-clockwise seen
   from outside (clockwise: all results change sign). */
typedef struct gxi_surface {
    const double *positions; /* [position_count][3] */
    size_t position_count;
    const uint32_t *triangles; /* [triangle_count][3], indices of positions */
    size_t triangle_count;
} gxi_surface;

/* Integrals over a polyhedron of 1, of x_a, and of x_a x_b. Zero-initialised: nothing added yet. */
typedef struct gxi_moments2 {
    double volume;    /* length^3 */
    double first[3];  /* length^4: x y z */
    double second[6]; /* length^5: xx xy xz yy yz zz */
} gxi_moments2;

/* >>moments -------------------------------------------------------------------------------------------------------- */

/* The functions without a result code trust their arguments: no NULL, no NaN. */

/* Adds the cone from the origin of coordinates to the triangle a b c; its volume is positive if a b c is
   counter-clockwise seen from outside. Added for every boundary triangle, m holds the moments of the polyhedron. */
GXFEM_API void gxi_moments2_add_triangle(gxi_moments2 *m, const double a[3], const double b[3], const double c[3]);

/* m += other: the union of two disjoint polyhedra, both about the same origin. */
GXFEM_API void gxi_moments2_add(gxi_moments2 *m, const gxi_moments2 *other);

/* Moments of the polyhedron moved by shift. From moments about `origin` to moments about `other`: shift = origin -
 * other. */
GXFEM_API void gxi_moments2_translate(gxi_moments2 *m, const double shift[3]);

/* Moments of the polyhedron mapped by x -> matrix x + translation; matrix by rows. For instance from an element's
   barycentric frame to space. A mirroring (negative determinant) turns the sign of all moments, as it turns the
   triangles. */
GXFEM_API void gxi_moments2_map(gxi_moments2 *m, const double matrix[9], const double translation[3]);

/* Centre of mass, and the inertia tensor about it (xx xy xz yy yz zz, products of inertia with their minus sign), for a
   uniform density. Precondition: m->volume > 0. */
GXFEM_API void gxi_moments2_inertia(const gxi_moments2 *m, double density, double centre[3], double inertia[6]);

/* Repairs moments that are rounding errors themselves, as those of a part thinner than the spacing of doubles. They
   become moments that a mass within the box lower..upper can have: volume >= 0, centre in the box, covariance
   semi-definite and no wider than the box. So every matrix made from them is semi-definite. Moments that are right
   within rounding do not change. Returns 1 if it changed something, else 0. Precondition: lower <= upper, about the
   origin of m. */
GXFEM_API int gxi_moments2_repair(gxi_moments2 *m, const double lower[3], const double upper[3]);

/* Moments of a polyhedron about `origin`. On failure *m is as it was. NULL origin: (0, 0, 0).
   Fails: ARGUMENT, EMPTY, INDEX, NOT_FINITE, RANGE. */
GXFEM_API gx_result gxi_polyhedron_moments2(const gxi_surface *surface, const double origin[3], gxi_moments2 *m,
                                            gx_failure *failure /* or NULL */);

/* >>monomials ------------------------------------------------------------------------------------------------------ */

/* Results are ordered by degree, then by falling power of x, then of y: 1  x y z  xx xy xz yy yz zz  xxx xxy ...
   NULL origin: (0, 0, 0). On failure all buffers are as they were. All fail with: ARGUMENT, EMPTY, INDEX, NOT_FINITE,
   RANGE; failure may be NULL. */

/* Number of monomials x^i y^j z^k of degree <= `degree`: (degree + 1)(degree + 2)(degree + 3)/6. 0 above
 * GXI_DEGREE_MAX. */
GXFEM_API size_t gxi_monomial_count(unsigned degree);

/* Where x^i y^j z^k stands. Precondition: i + j + k <= GXI_DEGREE_MAX. */
GXFEM_API size_t gxi_monomial_index(unsigned i, unsigned j, unsigned k);

/* Integrals over the polyhedron of all monomials of x - origin up to `degree`.
   moments, work: [gxi_monomial_count(degree)] each, not overlapping; what they held does not matter.
   Time: about 20 gxi_monomial_count(degree) floating-point operations per triangle. */
GXFEM_API gx_result gxi_polyhedron_monomials(const gxi_surface *surface, const double origin[3], unsigned degree,
                                             double *moments, double *work, gx_failure *failure /* or NULL */);

/* The integral of one monomial, without a buffer: the sum over all ways to deal i, j, k out to three corners, which is
   ((i+1)(i+2)(j+1)(j+2)(k+1)(k+2))/8 terms per triangle. For more than a few of low degree use the function above. */
GXFEM_API gx_result gxi_polyhedron_monomial(const gxi_surface *surface, const double origin[3], unsigned i, unsigned j,
                                            unsigned k, double *moment, gx_failure *failure /* or NULL */);

/* Integrals over the triangles by area (dA) of all monomials of x - origin up to `degree`. Buffers as above.
   The surface may be open, and its orientation does not matter. Together with a traction: the load on a cut face. */
GXFEM_API gx_result gxi_surface_monomials(const gxi_surface *surface, const double origin[3], unsigned degree,
                                          double *moments, double *work, gx_failure *failure /* or NULL */);

/* The same by area vector (n dA, n the unit normal from which the triangle looks counter-clockwise): pressures and
   fluxes. moments: [gxi_monomial_count(degree)][3]; work: [gxi_monomial_count(degree)]. */
GXFEM_API gx_result gxi_surface_flux_monomials(const gxi_surface *surface, const double origin[3], unsigned degree,
                                               double *moments, double *work, gx_failure *failure /* or NULL */);

/* Moves integrals by volume or area to another origin, in place: those of monomials of x become those of x + shift.
   moments: [gxi_monomial_count(degree)]. Fails: ARGUMENT, NOT_FINITE, RANGE (degree). */
GXFEM_API gx_result gxi_monomials_translate(unsigned degree, const double shift[3], double *moments,
                                            gx_failure *failure /* or NULL */);

/* >>element -------------------------------------------------------------------------------------------------------- */

/* Linear tetrahedra. positions: [4][3]; the volume is positive if (x1 - x0) x (x2 - x0) points to the side of x3.
   Symmetric 4 x 4 blocks are stored as 10 numbers: 00 01 02 03 11 12 13 22 23 33. */

/* Signed volume. */
GXFEM_API double gxi_tet_volume(const double positions[12]);

/* Gradients of the shape functions, [4][3], 1 / length, adding up to 0; and the volume. volume may be NULL.
   Fails, and leaves the outputs as they were: ARGUMENT, NOT_FINITE, RANGE, FLAT, INVERTED. */
GXFEM_API gx_result gxi_tet_gradients(const double positions[12], double gradients[12], double *volume);

/* Mass of a whole element: density volume (1 + delta_ij) / 20 (GXFEM Eq. 13). */
GXFEM_API void gxi_tet_mass(double volume, double density, double mass[10]);

/* >>part ----------------------------------------------------------------------------------------------------------- */

/* A part of an element (a cell Omega^{e,s}, GXFEM Eq. 20) is bounded by triangles whose corners have barycentric
   coordinates lambda_0 ... lambda_3 in the element. It is integrated in a frame that has vertex k of the element as its
   origin and the lambdas of the other three as coordinates, where the element has volume 1/6. Choose as k the vertex
   that the part lies at. The moments of a small part are accurate if lambdas that should be 0 or 1 (corners on faces
   and at vertices of the element) are so exactly, and small ones have small relative errors. */

/* Which lambdas are the coordinates of the frame with origin k, in the order that keeps the orientation of the element:
   1 2 3, 0 3 2, 0 1 3, 0 2 1 for k = 0, 1, 2, 3. Precondition: k <= 3. */
GXFEM_API void gxi_part_axes(unsigned k, unsigned axes[3]);

/* Chooses k, the vertex with the largest sum of lambdas over the triangles' corners. Adds up the part's moments in its
   frame. Moments below rounding are repaired: the centre stays within the range of the corners' lambdas, and the load
   is not negative (volume 0: the part has no mass). lambdas: [lambda_count][4]; triangles:
   [triangle_count][3], outward as seen in an element of positive volume. Fails, and leaves the outputs as they were:
   ARGUMENT, EMPTY, INDEX (of a lambda), NOT_FINITE (a lambda), RANGE (a lambda beyond 65536). Functions that run once
   for each cell or element take no gx_failure: the result says what is wrong. */
GXFEM_API gx_result gxi_part_moments(const double *lambdas, size_t lambda_count, const uint32_t *triangles,
                                     size_t triangle_count, unsigned *k, gxi_moments2 *reference);

/* The same in the frame of a given k <= 3. Triangles in the element's faces through vertex k add nothing there. They
   may be left out, so the others need not close the surface. The vertex counts as a corner. */
GXFEM_API gx_result gxi_part_moments_at(const double *lambdas, size_t lambda_count, const uint32_t *triangles,
                                        size_t triangle_count, unsigned k, gxi_moments2 *reference);

/* Mass block of the part, density * integral of lambda_i lambda_j (GXFEM Eq. 13); semi-definite up to rounding of its
   own size. reference: the part's moments in the frame with origin k. The part's volume is 6 element_volume
   reference->volume. Linear in the moments: blocks of parts that make up the element add up to the block of the
   element. Precondition: k <= 3. */
GXFEM_API void gxi_part_mass(const gxi_moments2 *reference, unsigned k, double element_volume, double density,
                             double mass[10]);

/* Load of the part, density * integral of lambda_i (GXFEM Eq. 14). Times an acceleration, it is the nodal forces.
   Precondition: k <= 3. */
GXFEM_API void gxi_part_load(const gxi_moments2 *reference, unsigned k, double element_volume, double density,
                             double load[4]);

/* Area vector of a triangle in space: its normal times its area. Returns the area. */
GXFEM_API double gxi_triangle_area(const double a[3], const double b[3], const double c[3], double area_vector[3]);

/* Adds the integrals of lambda_i by area over a triangle of a cut face, whose corners have barycentric coordinates a,
   b, c and whose area in space is `area`. Times a traction, they are the nodal forces (RXFEM section 5). For a
   pressure, pass a component of the area vector instead. */
GXFEM_API void gxi_face_load_add(const double a[4], const double b[4], const double c[4], double area, double load[4]);

/* Likewise the integrals of lambda_i lambda_j: tractions that vary linearly, springs and dampers on the face. */
GXFEM_API void gxi_face_mass_add(const double a[4], const double b[4], const double c[4], double area, double mass[10]);

/* stop here for the API */

#ifdef __cplusplus
}
#endif
#endif /* GXFEM_INTEGRATE_INCLUDED */

/* >>implementation ------------------------------------------------------------------------------------------------- */

/* Outside the declaration guard, so that a file that included the header plainly first still gets the implementation.
 */
#if defined(GXFEM_IMPLEMENTATION) && !defined(GXFEM_INTEGRATE_IMPLEMENTATION)
#define GXFEM_INTEGRATE_IMPLEMENTATION
#endif
#if defined(GXFEM_INTEGRATE_IMPLEMENTATION) && !defined(GXFEM_INTEGRATE_IMPLEMENTED)
#define GXFEM_INTEGRATE_IMPLEMENTED

#include <math.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif
#ifdef GXFEM_SCALAR
#pragma clang attribute push(__attribute__((target("no-simd128"))), apply_to = function)
#endif
#if defined(GXFEM_SMALL) && defined(__clang__)
#pragma clang attribute push(__attribute__((minsize)), apply_to = function)
#endif

/* >>config: limits of rounding and of results ---------------------------------------------------------------------- */

/* In and out: macros only. Each says what it bounds; none of them changes a result that is right within rounding. */

/* Error of a moment relative to the mass that it is part of: a few roundings of 2^-53. */
#define GXIP_ROUNDING 1e-15

/* A larger lambda cannot belong to a part of an element: the coordinates are not barycentric. */
#define GXIP_LAMBDA_MAX 65536.0

/* COLD functions are seldom called: kept out of line and compiled for size. */
#if defined(__GNUC__) || defined(__clang__)
#define GXIP_COLD __attribute__((cold, noinline))
#else
#define GXIP_COLD
#endif

/* A bound 2^GXIP_EXPONENT_MAX on every intermediate result keeps them all finite. */
#define GXIP_EXPONENT_MAX 1022

/* >>math: bits and vectors of three -------------------------------------------------------------------------------- */

/* In and out: a few numbers. Differences are taken before products, so that small shapes far from the origin lose no
   more than their coordinates lost. */

/* The exponent bits of x, all set for infinity and NaN. Under -ffast-math comparisons with these fold away, bits do
 * not. */
static inline int gxip_exponent_field(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (int)((bits >> 52) & 0x7ff);
}

static inline int gxip_is_finite(double x) { return gxip_exponent_field(x) != 0x7ff; }

static int gxip_all_finite(const double *x, size_t count) {
    size_t i;
    for (i = 0; i < count; i++)
        if (!gxip_is_finite(x[i])) return 0;
    return 1;
}

static inline double gxip_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void gxip_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void gxip_subtract(const double a[3], const double b[3], double out[3]) {
    int d;
    for (d = 0; d < 3; d++) out[d] = a[d] - b[d];
}

/* Without overflow or underflow of the squares. */
static double gxip_length(const double v[3]) {
    double largest = fabs(v[0]), u[3];
    if (fabs(v[1]) > largest) largest = fabs(v[1]);
    if (fabs(v[2]) > largest) largest = fabs(v[2]);
    if (!(largest > 0)) return 0;
    u[0] = v[0] / largest;
    u[1] = v[1] / largest;
    u[2] = v[2] / largest;
    return largest * sqrt(gxip_dot(u, u));
}

static inline double gxip_clamp(double x, double lower, double upper) {
    return x < lower ? lower : x > upper ? upper : x;
}

/* n = (b - a) x (c - a), twice the area vector. Differences first: near corners subtract exactly (Sterbenz). */
static inline void gxip_double_area(const double a[3], const double b[3], const double c[3], double n[3]) {
    double u[3], v[3];
    gxip_subtract(b, a, u);
    gxip_subtract(c, a, v);
    gxip_cross(u, v, n);
}

/* det(a, b, c) = a . (b - a) x (c - a): six times the volume of the cone over the triangle, with an error relative to
   |a| |b - a| |c - a| instead of |a| |b| |c|. Exactly 0 if one coordinate of all three is 0. */
static inline double gxip_determinant(const double a[3], const double b[3], const double c[3]) {
    double n[3];
    gxip_double_area(a, b, c, n);
    return gxip_dot(a, n);
}

/* >>second-order: volume, first and second moments ----------------------------------------------------------------- */

/* In: triangles, or moments. Out: moments, moved, mapped or repaired. Pairs of axes as stored: xx xy xz yy yz zz; of
 * shape functions: 00 01 02 03 11 12 13 22 23 33. */

static inline size_t gxip_packed3(size_t a, size_t b) { return a < b ? a * (5 - a) / 2 + b : b * (5 - b) / 2 + a; }

static inline size_t gxip_packed4(size_t a, size_t b) { return a < b ? a * (7 - a) / 2 + b : b * (7 - b) / 2 + a; }

/* Integrals over the tetrahedron 0 a b c, the cone over a b c, with det = 6 volumes and s = a + b + c:
       of 1: det/6,   of x: det/24 s,   of x x^T: det/120 (a a^T + b b^T + c c^T + s s^T) */
GXFEM_API void gxi_moments2_add_triangle(gxi_moments2 *m, const double a[3], const double b[3], const double c[3]) {
    const double det = gxip_determinant(a, b, c), sixth = det / 6, quarter = 0.25 * sixth, part = det / 120;
    const double s[3] = {a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]};
    if (fabs(det) <= 0) return; /* most triangles of a part of an element: those in the faces around the origin */
    m->volume += sixth;
    m->first[0] += quarter * s[0];
    m->first[1] += quarter * s[1];
    m->first[2] += quarter * s[2];
    m->second[0] += part * (a[0] * a[0] + b[0] * b[0] + c[0] * c[0] + s[0] * s[0]);
    m->second[1] += part * (a[0] * a[1] + b[0] * b[1] + c[0] * c[1] + s[0] * s[1]);
    m->second[2] += part * (a[0] * a[2] + b[0] * b[2] + c[0] * c[2] + s[0] * s[2]);
    m->second[3] += part * (a[1] * a[1] + b[1] * b[1] + c[1] * c[1] + s[1] * s[1]);
    m->second[4] += part * (a[1] * a[2] + b[1] * b[2] + c[1] * c[2] + s[1] * s[2]);
    m->second[5] += part * (a[2] * a[2] + b[2] * b[2] + c[2] * c[2] + s[2] * s[2]);
}

GXFEM_API void gxi_moments2_add(gxi_moments2 *m, const gxi_moments2 *other) {
    int i;
    m->volume += other->volume;
    for (i = 0; i < 3; i++) m->first[i] += other->first[i];
    for (i = 0; i < 6; i++) m->second[i] += other->second[i];
}

/* (x + t)(x + t)^T = x x^T + x t^T + t x^T + t t^T */
GXFEM_API void gxi_moments2_translate(gxi_moments2 *m, const double shift[3]) {
    size_t i, j, entry = 0;
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++)
            m->second[entry++] += m->first[i] * shift[j] + shift[i] * m->first[j] + m->volume * shift[i] * shift[j];
    for (i = 0; i < 3; i++) m->first[i] += m->volume * shift[i];
}

/* Substitution x -> A x: volume det A, first det A A f, second det A A S A^T; then the translation. */
GXFEM_API void gxi_moments2_map(gxi_moments2 *m, const double matrix[9], const double translation[3]) {
    gxi_moments2 r;
    double normal[3], det, half[3][3]; /* half = A S */
    size_t i, j, p, entry = 0;
    gxip_cross(matrix + 3, matrix + 6, normal);
    det = gxip_dot(matrix, normal);
    r.volume = det * m->volume;
    for (i = 0; i < 3; i++) {
        r.first[i] = det * gxip_dot(matrix + 3 * i, m->first);
        for (j = 0; j < 3; j++) {
            half[i][j] = 0;
            for (p = 0; p < 3; p++) half[i][j] += matrix[3 * i + p] * m->second[gxip_packed3(p, j)];
        }
    }
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) r.second[entry++] = det * gxip_dot(half[i], matrix + 3 * j);
    gxi_moments2_translate(&r, translation);
    *m = r;
}

/* Inertia = trace(C) 1 - C, where C = density (S - volume c c^T) */
GXFEM_API void gxi_moments2_inertia(const gxi_moments2 *m, double density, double centre[3], double inertia[6]) {
    gxi_moments2 central = *m;
    double back[3], trace;
    size_t i, j;
    for (i = 0; i < 3; i++) centre[i] = m->first[i] / m->volume;
    for (i = 0; i < 3; i++) back[i] = -centre[i];
    gxi_moments2_translate(&central, back);
    trace = central.second[0] + central.second[3] + central.second[5];
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++)
            inertia[gxip_packed3(i, j)] = density * ((i == j ? trace : 0) - central.second[gxip_packed3(i, j)]);
}

/* Is c + shift 1 positive definite? By the pivots of its elimination. */
static int gxip_definite(const double c[6], double shift) {
    double p0 = c[0] + shift, p1, p2, l1, l2, off;
    if (!(p0 > 0)) return 0;
    l1 = c[1] / p0;
    l2 = c[2] / p0;
    p1 = c[3] + shift - l1 * c[1];
    if (!(p1 > 0)) return 0;
    off = c[4] - l1 * c[2];
    p2 = c[5] + shift - l2 * c[2] - off / p1 * off;
    return p2 > 0;
}

/* Clamps a covariance c to what a distribution of mean `mean` in a box can have: variances within 0 .. (upper - mean)
   (mean - lower) (Bhatia, Davis 2000), |c_ij|^2 <= c_ii c_jj, and semi-definite by lifting the diagonal. `rounding` is
   the error that is left as it is. Returns 1 if something changed. */
static int gxip_clamp_covariance(double c[6], const double mean[3], const double lower[3], const double upper[3],
                                 double rounding) {
    double shift = rounding;
    int changed = 0, attempt;
    size_t i, j, ij;
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) {
            double bound = (upper[i] - mean[i]) * (mean[i] - lower[i]) * (upper[j] - mean[j]) * (mean[j] - lower[j]);
            double high = bound > 0 ? sqrt(bound) : 0, low = i == j ? 0 : -high;
            ij = gxip_packed3(i, j);
            if (c[ij] >= low - rounding && c[ij] <= high + rounding) continue;
            c[ij] = gxip_clamp(c[ij], low, high);
            changed = 1;
        }
    if (!(rounding > 0) || gxip_definite(c, shift)) return changed;
    /* 1e-15 4^40 outgrows any entry */
    for (attempt = 0; attempt < 40 && !gxip_definite(c, shift); attempt++) shift *= 4;
    c[0] += shift;
    c[3] += shift;
    c[5] += shift;
    return 1;
}

/* Mean and covariance of m, moved into the box; *changed = 1 if they moved by more than `slack`. Sizes are compared
   before the division by a volume that may be next to nothing. */
static void gxip_clamp_mean(const gxi_moments2 *m, const double lower[3], const double upper[3], double slack,
                            double mean[3], double c[6], int *changed) {
    double v = m->volume, reach[3];
    size_t i, j, ij;
    for (i = 0; i < 3; i++) {
        reach[i] = fabs(lower[i]) > fabs(upper[i]) ? fabs(lower[i]) : fabs(upper[i]);
        reach[i] += slack;
        mean[i] = gxip_clamp(m->first[i], v * lower[i], v * upper[i]) / v;
        if (m->first[i] >= v * (lower[i] - slack) && m->first[i] <= v * (upper[i] + slack))
            mean[i] = m->first[i] / v;
        else
            *changed = 1;
    }
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) {
            double bound = v * reach[i] * reach[j];
            ij = gxip_packed3(i, j);
            c[ij] = gxip_clamp(m->second[ij], -bound, bound) / v - mean[i] * mean[j];
            if (fabs(m->second[ij]) > 2 * bound) *changed = 1;
        }
}

/* No volume, no mass. Returns 1 if there was something to remove. */
static int gxip_clear_moments(gxi_moments2 *m) {
    int i, changed = m->volume < 0;
    for (i = 0; i < 3; i++) changed |= fabs(m->first[i]) > 0;
    for (i = 0; i < 6; i++) changed |= fabs(m->second[i]) > 0;
    memset(m, 0, sizeof *m);
    return changed;
}

GXFEM_API int gxi_moments2_repair(gxi_moments2 *m, const double lower[3], const double upper[3]) {
    double mean[3], c[6], reach2 = 0;
    int changed = 0;
    size_t i, j, ij;
    if (!(m->volume > 0)) return gxip_clear_moments(m);
    for (i = 0; i < 3; i++) reach2 += lower[i] * lower[i] + upper[i] * upper[i];
    gxip_clamp_mean(m, lower, upper, GXIP_ROUNDING * sqrt(reach2), mean, c, &changed);
    changed |= gxip_clamp_covariance(c, mean, lower, upper, GXIP_ROUNDING * reach2);
    if (!changed) return 0;
    for (i = 0; i < 3; i++) m->first[i] = m->volume * mean[i];
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) {
            ij = gxip_packed3(i, j);
            m->second[ij] = m->volume * (c[ij] + mean[i] * mean[j]);
        }
    return 1;
}

/* >>recurrence: monomials of any degree ---------------------------------------------------------------------------- */

/* In: corners of a triangle. Out: sums over it or over its cone to the origin, before they are scaled.
   Let h_n(y_0, y_1, ...) be the sum of all products of n factors y. Over a simplex T of dimension s with corners
   v_0 ... v_s
       integral of (t.x)^n = |T| s! n! / (n + s)! h_n(t.v_0, ..., t.v_s)          ([BBLKV], section 3)
   and, summed over n, h_n has the generating function
       h_0 + h_1 + h_2 + ... = product over the corners of 1 / (1 - t.v).
   Compare coefficients of t^(i,j,k), n = i + j + k, where q_ijk is that of the product:
       integral of x^i y^j z^k = |T| s! i! j! k! / (n + s)! q_ijk.
   Multiplication by 1 / (1 - t.v) is the recurrence
       q'_ijk = q_ijk + v_x q'_(i-1)jk + v_y q'_i(j-1)k + v_z q'_ij(k-1),
   in place and without a subtraction. A corner at the origin is a factor 1: the cone over a triangle takes three sweeps
   like the triangle itself. */

/* Number of monomials of degree n exactly, and below n. */
static inline size_t gxip_layer(size_t n) { return (n + 1) * (n + 2) / 2; }

static inline size_t gxip_layers_below(size_t n) { return n * (n + 1) * (n + 2) / 6; }

/* q *= 1 / (1 - t.v). Within a degree n, the monomial with j + k = m stands at m (m + 1)/2 + k. */
static void gxip_sweep(double *q, size_t degree, const double v[3]) {
    size_t n, m, k, w;
    for (n = 1; n <= degree; n++) {
        double *layer = q + gxip_layers_below(n);
        const double *below = q + gxip_layers_below(n - 1);
        for (m = 0, w = 0; m <= n; m++)
            for (k = 0; k <= m; k++, w++) {
                double sum = layer[w];
                if (m < n) sum += v[0] * below[w];
                if (k < m) sum += v[1] * below[w - m];
                if (k > 0) sum += v[2] * below[w - m - 1];
                layer[w] = sum;
            }
    }
}

/* q of the triangle with corners p[0], p[1], p[2], times `factor`. */
static void gxip_coefficients(double *q, size_t count, size_t degree, double p[3][3], double factor) {
    size_t i;
    q[0] = factor;
    for (i = 1; i < count; i++) q[i] = 0;
    for (i = 0; i < 3; i++) gxip_sweep(q, degree, p[i]);
}

/* From sums of q to integrals: times i! j! k! / (n + s)! = 1 / (C(n, m) C(m, k) (n + 1) ... (n + s)), m = j + k.
   moments: [count][stride] */
static void gxip_normalise(double *moments, size_t stride, size_t degree, int s) {
    size_t n, m, k, d;
    for (n = 0; n <= degree; n++) {
        double rising = (double)(n + 1) * (double)(n + 2) * (s == 3 ? (double)(n + 3) : 1.0), outer = 1;
        for (m = 0; m <= n; m++) {
            double inner = 1;
            for (k = 0; k <= m; k++) {
                for (d = 0; d < stride; d++) *moments++ /= rising * outer * inner;
                inner = inner * (double)(m - k) / (double)(k + 1);
            }
            outer = outer * (double)(n - m) / (double)(m + 1);
        }
    }
}

/* (i + j + k)! / (i! j! k!) x^i y^j z^k */
static double gxip_term(const double v[3], unsigned i, unsigned j, unsigned k) {
    double product = 1;
    unsigned p, n = 0;
    for (p = 1; p <= i; p++) product *= v[0] * ++n / p;
    for (p = 1; p <= j; p++) product *= v[1] * ++n / p;
    for (p = 1; p <= k; p++) product *= v[2] * ++n / p;
    return product;
}

/* q_ijk alone: 1 / (1 - t.v) has the coefficients of gxip_term, and a product's are sums over all ways to deal i, j, k
 * out. */
static double gxip_coefficient(double p[3][3], unsigned i, unsigned j, unsigned k) {
    double sum = 0;
    unsigned i0, i1, j0, j1, k0, k1;
    for (i0 = 0; i0 <= i; i0++)
        for (j0 = 0; j0 <= j; j0++)
            for (k0 = 0; k0 <= k; k0++) {
                double rest = 0;
                for (i1 = 0; i1 <= i - i0; i1++)
                    for (j1 = 0; j1 <= j - j0; j1++)
                        for (k1 = 0; k1 <= k - k0; k1++)
                            rest +=
                                gxip_term(p[1], i1, j1, k1) * gxip_term(p[2], i - i0 - i1, j - j0 - j1, k - k0 - k1);
                sum += gxip_term(p[0], i0, j0, k0) * rest;
            }
    return sum;
}

/* >>validation: surfaces and reach --------------------------------------------------------------------------------- */

/* In: what the caller gives. Out: a result code, or the corners of a triangle about the origin. No result is written
   here. */

/* Smallest e >= -1022 with |x| < 2^e. */
static int gxip_exponent_above(double x) { return gxip_exponent_field(x) - 1022; }

/* Every |coordinate| < 2^e. A coefficient q_ijk has below 3^n (n + 1)(n + 2)/2 < 2^(1.6 n + 15) times a product of n
   coordinates, a determinant is below 18 2^(3e + 2) < 2^(3e + 7), and there are fewer than 2^(8 sizeof(size_t))
   triangles. The last may be taken as 2^40: more do not fit into memory. */
static gx_result gxip_check_reach(int e, unsigned degree) {
    int power = e > 0 ? e * ((int)degree + 3) : 3 * (e < -300 ? -300 : e);
    return power + 8 * (int)degree / 5 + 63 > GXIP_EXPONENT_MAX ? GX_ERROR_RANGE : GX_OK;
}

static gx_result gxip_end(gx_failure *failure, gx_result result) {
    if (failure) {
        failure->result = result;
        failure->field = NULL;
        failure->index = failure->surface = SIZE_MAX;
    }
    return result;
}

static GXIP_COLD gx_result gxip_fail(gx_failure *failure, gx_result result, const char *field, size_t index) {
    gxip_end(failure, result);
    if (failure) failure->field = field, failure->index = index;
    return result;
}

static gx_result gxip_check_surface(const gxi_surface *surface, const double *origin, unsigned degree,
                                    gx_failure *failure) {
    size_t t, i;
    int e, largest = -1022;
    if (!surface) return gxip_fail(failure, GX_ERROR_ARGUMENT, "surface", SIZE_MAX);
    if (!surface->positions) return gxip_fail(failure, GX_ERROR_ARGUMENT, "positions", SIZE_MAX);
    if (!surface->triangles) return gxip_fail(failure, GX_ERROR_ARGUMENT, "triangles", SIZE_MAX);
    if (surface->position_count == 0) return gxip_fail(failure, GX_ERROR_EMPTY, "position_count", SIZE_MAX);
    if (surface->triangle_count == 0) return gxip_fail(failure, GX_ERROR_EMPTY, "triangle_count", SIZE_MAX);
    if (degree > GXI_DEGREE_MAX) return gxip_fail(failure, GX_ERROR_RANGE, "degree", SIZE_MAX);
    if (origin && !gxip_all_finite(origin, 3)) return gxip_fail(failure, GX_ERROR_NOT_FINITE, "origin", SIZE_MAX);
    for (t = 0; t < surface->triangle_count; t++)
        for (i = 0; i < 9; i++) {
            uint32_t vertex = surface->triangles[3 * t + i / 3];
            double x;
            if (vertex >= surface->position_count) return gxip_fail(failure, GX_ERROR_INDEX, "triangles", t);
            x = surface->positions[3 * (size_t)vertex + i % 3];
            if (!gxip_is_finite(x)) return gxip_fail(failure, GX_ERROR_NOT_FINITE, "positions", vertex);
            e = gxip_exponent_above(origin ? x - origin[i % 3] : x);
            if (e > largest) largest = e;
        }
    return gxip_check_reach(largest, degree) == GX_OK ? gxip_end(failure, GX_OK)
                                                      : gxip_fail(failure, GX_ERROR_RANGE, "positions", SIZE_MAX);
}

/* Corners of triangle t about the origin. */
static void gxip_corners(const gxi_surface *surface, const double *origin, size_t t, double p[3][3]) {
    size_t i, d;
    for (i = 0; i < 3; i++)
        for (d = 0; d < 3; d++) {
            double x = surface->positions[3 * (size_t)surface->triangles[3 * t + i] + d];
            p[i][d] = origin ? x - origin[d] : x;
        }
}

/* >>public: the other public functions ----------------------------------------------------------------------------- */

/* Each checks what it is given and then adds up over triangles. Outputs are written only after all checks have passed.
 */

GXFEM_API gx_result gxi_polyhedron_moments2(const gxi_surface *surface, const double origin[3], gxi_moments2 *m,
                                            gx_failure *failure) {
    gx_result result =
        m ? gxip_check_surface(surface, origin, 2, failure) : gxip_fail(failure, GX_ERROR_ARGUMENT, "m", SIZE_MAX);
    double p[3][3];
    size_t t;
    if (result != GX_OK) return result;
    memset(m, 0, sizeof *m);
    for (t = 0; t < surface->triangle_count; t++) {
        gxip_corners(surface, origin, t, p);
        gxi_moments2_add_triangle(m, p[0], p[1], p[2]);
    }
    return GX_OK;
}

GXFEM_API size_t gxi_monomial_count(unsigned degree) {
    return degree > GXI_DEGREE_MAX ? 0 : gxip_layers_below((size_t)degree + 1);
}

GXFEM_API size_t gxi_monomial_index(unsigned i, unsigned j, unsigned k) {
    size_t m = (size_t)j + k;
    return gxip_layers_below(i + m) + m * (m + 1) / 2 + k;
}

/* The integrals that gxip_integrate sums over the triangles */
enum gxip_measure { GXIP_VOLUME, GXIP_AREA, GXIP_FLUX };

/* moments[count][stride] = integrals; stride 3 for GXIP_FLUX, else 1. With n = (b - a) x (c - a): |T| s! is a . n =
   det(a, b, c) for the cone (s = 3), |n| for the triangle (s = 2), and n instead of |n| makes it a flux. */
static gx_result gxip_integrate(const gxi_surface *surface, const double *origin, unsigned degree,
                                enum gxip_measure measure, double *moments, double *work, gx_failure *failure) {
    gx_result result = !moments ? gxip_fail(failure, GX_ERROR_ARGUMENT, "moments", SIZE_MAX)
                     : !work    ? gxip_fail(failure, GX_ERROR_ARGUMENT, "work", SIZE_MAX)
                                : gxip_check_surface(surface, origin, degree, failure);
    size_t count = gxi_monomial_count(degree), stride = measure == GXIP_FLUX ? 3 : 1, t, i, d;
    double p[3][3], n[3], factor;
    if (result != GX_OK) return result;
    for (i = 0; i < count * stride; i++) moments[i] = 0;
    for (t = 0; t < surface->triangle_count; t++) {
        gxip_corners(surface, origin, t, p);
        gxip_double_area(p[0], p[1], p[2], n);
        factor = measure == GXIP_VOLUME ? gxip_dot(p[0], n) : measure == GXIP_AREA ? gxip_length(n) : 1.0;
        gxip_coefficients(work, count, degree, p, factor);
        if (measure != GXIP_FLUX)
            for (i = 0; i < count; i++) moments[i] += work[i];
        else
            for (i = 0; i < count; i++)
                for (d = 0; d < 3; d++) moments[3 * i + d] += n[d] * work[i];
    }
    gxip_normalise(moments, stride, degree, measure == GXIP_VOLUME ? 3 : 2);
    return GX_OK;
}

GXFEM_API gx_result gxi_polyhedron_monomials(const gxi_surface *surface, const double origin[3], unsigned degree,
                                             double *moments, double *work, gx_failure *failure) {
    return gxip_integrate(surface, origin, degree, GXIP_VOLUME, moments, work, failure);
}

GXFEM_API gx_result gxi_surface_monomials(const gxi_surface *surface, const double origin[3], unsigned degree,
                                          double *moments, double *work, gx_failure *failure) {
    return gxip_integrate(surface, origin, degree, GXIP_AREA, moments, work, failure);
}

GXFEM_API gx_result gxi_surface_flux_monomials(const gxi_surface *surface, const double origin[3], unsigned degree,
                                               double *moments, double *work, gx_failure *failure) {
    return gxip_integrate(surface, origin, degree, GXIP_FLUX, moments, work, failure);
}

GXFEM_API gx_result gxi_polyhedron_monomial(const gxi_surface *surface, const double origin[3], unsigned i, unsigned j,
                                            unsigned k, double *moment, gx_failure *failure) {
    gx_result result;
    const double ones[3] = {1, 1, 1};
    double p[3][3], sum = 0, n = (double)i + (double)j + (double)k;
    size_t t;
    if (!moment) return gxip_fail(failure, GX_ERROR_ARGUMENT, "moment", SIZE_MAX);
    if (i > GXI_DEGREE_MAX || j > GXI_DEGREE_MAX || k > GXI_DEGREE_MAX || i + j + k > GXI_DEGREE_MAX)
        return gxip_fail(failure, GX_ERROR_RANGE, i >= j && i >= k ? "i" : j >= k ? "j" : "k", SIZE_MAX);
    result = gxip_check_surface(surface, origin, i + j + k, failure);
    if (result != GX_OK) return result;
    for (t = 0; t < surface->triangle_count; t++) {
        gxip_corners(surface, origin, t, p);
        sum += gxip_determinant(p[0], p[1], p[2]) * gxip_coefficient(p, i, j, k);
    }
    *moment = sum / (gxip_term(ones, i, j, k) * (n + 1) * (n + 2) * (n + 3));
    return GX_OK;
}

/* (x + t)^i by Pascal's triangle: i times x^p += t x^(p-1), for falling p. Here for the power `axis` of all monomials.
 */
static void gxip_translate_axis(double *moments, unsigned degree, int axis, double t) {
    unsigned r, n, m, k;
    for (r = 1; r <= degree; r++)
        for (n = degree; n >= r; n--) {
            double *layer = moments + gxip_layers_below(n);
            const double *below = moments + gxip_layers_below(n - 1u);
            size_t w = 0;
            for (m = 0; m <= n; m++)
                for (k = 0; k <= m; k++, w++) {
                    unsigned power = axis == 0 ? n - m : axis == 1 ? m - k : k;
                    if (power >= r) layer[w] += t * below[axis == 0 ? w : axis == 1 ? w - m : w - m - 1];
                }
        }
}

GXFEM_API gx_result gxi_monomials_translate(unsigned degree, const double shift[3], double *moments,
                                            gx_failure *failure) {
    int axis;
    if (!shift) return gxip_fail(failure, GX_ERROR_ARGUMENT, "shift", SIZE_MAX);
    if (!moments) return gxip_fail(failure, GX_ERROR_ARGUMENT, "moments", SIZE_MAX);
    if (degree > GXI_DEGREE_MAX) return gxip_fail(failure, GX_ERROR_RANGE, "degree", SIZE_MAX);
    if (!gxip_all_finite(shift, 3)) return gxip_fail(failure, GX_ERROR_NOT_FINITE, "shift", SIZE_MAX);
    for (axis = 0; axis < 3; axis++) gxip_translate_axis(moments, degree, axis, shift[axis]);
    return gxip_end(failure, GX_OK);
}

GXFEM_API double gxi_tet_volume(const double positions[12]) {
    double n[3], w[3];
    gxip_double_area(positions, positions + 3, positions + 6, n);
    gxip_subtract(positions + 9, positions, w);
    return gxip_dot(w, n) / 6;
}

/* With edges e_i = x_i - x_0 and D = e_1 . e_2 x e_3 = 6 volume: grad N_1 = e_2 x e_3 / D and cyclically. */
GXFEM_API gx_result gxi_tet_gradients(const double positions[12], double gradients[12], double *volume) {
    double e[3][3], g[12], det;
    int i, d, largest = -1022;
    if (!positions || !gradients) return GX_ERROR_ARGUMENT;
    if (!gxip_all_finite(positions, 12)) return GX_ERROR_NOT_FINITE;
    for (i = 0; i < 3; i++) {
        gxip_subtract(positions + 3 * (i + 1), positions, e[i]);
        for (d = 0; d < 3; d++)
            if (gxip_exponent_above(e[i][d]) > largest) largest = gxip_exponent_above(e[i][d]);
    }
    if (gxip_check_reach(largest, 0) != GX_OK) return GX_ERROR_RANGE;
    for (i = 0; i < 3; i++) gxip_cross(e[(i + 1) % 3], e[(i + 2) % 3], g + 3 * (i + 1));
    det = gxip_dot(e[0], g + 3);
    if (gxip_exponent_field(det) == 0) return GX_ERROR_FLAT; /* 0, or below the normal doubles */
    if (det < 0) return GX_ERROR_INVERTED;
    for (i = 3; i < 12; i++) g[i] /= det;
    for (d = 0; d < 3; d++) g[d] = -(g[3 + d] + g[6 + d] + g[9 + d]);
    if (!gxip_all_finite(g, 12)) return GX_ERROR_FLAT; /* det is so near 0 that the gradients overflow */
    memcpy(gradients, g, sizeof g);
    if (volume) *volume = det / 6;
    return GX_OK;
}

GXFEM_API void gxi_tet_mass(double volume, double density, double mass[10]) {
    size_t i, j, entry = 0;
    for (i = 0; i < 4; i++)
        for (j = i; j < 4; j++) mass[entry++] = density * volume / (i == j ? 10 : 20);
}

/* Row k: the three others such that (k, others) is an even permutation, which keeps the orientation. */
GXFEM_API void gxi_part_axes(unsigned k, unsigned axes[3]) {
    static const unsigned table[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    memcpy(axes, table[k], sizeof table[k]);
}

/* At most GXIP_LAMBDA_MAX, and a number: magnitudes are ordered as their bits are. */
static inline int gxip_is_lambda(double x) {
    const double most = GXIP_LAMBDA_MAX;
    uint64_t bits, limit;
    memcpy(&bits, &x, sizeof bits);
    memcpy(&limit, &most, sizeof limit);
    return bits << 1 <= limit << 1;
}

/* If the centre lies beyond x + y + z = limit (lambda_k below that of every corner), which only noise does, contracts
   the mass towards `lower` until it does not. Covariances shrink with it and stay what they must be. */
static void gxip_limit_sum(gxi_moments2 *m, const double lower[3], double limit) {
    double v = m->volume, base = v * (lower[0] + lower[1] + lower[2]), sum = m->first[0] + m->first[1] + m->first[2], s;
    double minus[3];
    int i;
    if (sum <= v * limit || sum <= base) return;
    s = v * limit > base ? (v * limit - base) / (sum - base) : 0;
    for (i = 0; i < 3; i++) minus[i] = -lower[i];
    gxi_moments2_translate(m, minus);
    for (i = 0; i < 3; i++) m->first[i] *= s;
    for (i = 0; i < 6; i++) m->second[i] *= s * s;
    gxi_moments2_translate(m, lower);
}

/* What a part's corners span: their lambdas, for each frame the largest sum of its three, and their sums over the
 * triangles' corners */
typedef struct gxip_span {
    double lower[4], upper[4], largest_sum[4], sum[4];
} gxip_span;

/* Adds a corner that so many triangles have. */
static inline gx_result gxip_span_add(gxip_span *span, const double lambda[4], double count) {
    const double rest[4] = {lambda[1] + lambda[2] + lambda[3], lambda[0] + lambda[3] + lambda[2],
                            lambda[0] + lambda[1] + lambda[3], lambda[0] + lambda[2] + lambda[1]};
    size_t i;
    if (!gxip_is_lambda(lambda[0]) || !gxip_is_lambda(lambda[1]) || !gxip_is_lambda(lambda[2]) ||
        !gxip_is_lambda(lambda[3]))
        return gxip_all_finite(lambda, 4) ? GX_ERROR_RANGE : GX_ERROR_NOT_FINITE;
    for (i = 0; i < 4; i++) {
        span->lower[i] = lambda[i] < span->lower[i] ? lambda[i] : span->lower[i];
        span->upper[i] = lambda[i] > span->upper[i] ? lambda[i] : span->upper[i];
        span->largest_sum[i] = rest[i] > span->largest_sum[i] ? rest[i] : span->largest_sum[i];
        span->sum[i] += count * lambda[i];
    }
    return GX_OK;
}

#define GXIP_FEW 64 /* corners: each is looked at once, not with each of its triangles */

/* The span of the corners that are referred to, which are checked. */
static gx_result gxip_part_span(const double *lambdas, size_t lambda_count, const uint32_t *triangles,
                                size_t triangle_count, gxip_span *span) {
    uint32_t uses[GXIP_FEW] = {0};
    gx_result result = GX_OK;
    size_t i;
    for (i = 0; i < 4; i++) {
        span->lower[i] = GXIP_LAMBDA_MAX;
        span->upper[i] = span->largest_sum[i] = -3 * GXIP_LAMBDA_MAX;
        span->sum[i] = 0;
    }
    for (i = 0; i < 3 * triangle_count && result == GX_OK; i++) {
        if (triangles[i] >= lambda_count) return GX_ERROR_INDEX;
        if (lambda_count <= GXIP_FEW)
            uses[triangles[i]]++;
        else
            result = gxip_span_add(span, lambdas + 4 * (size_t)triangles[i], 1);
    }
    for (i = 0; i < lambda_count && lambda_count <= GXIP_FEW && result == GX_OK; i++)
        if (uses[i] > 0) result = gxip_span_add(span, lambdas + 4 * i, uses[i]);
    return result;
}

static inline void gxip_part_corner(const double lambda[4], const unsigned axes[3], double p[3]) {
    p[0] = lambda[axes[0]];
    p[1] = lambda[axes[1]];
    p[2] = lambda[axes[2]];
}

/* Adds up the moments of a part whose corners have been looked at. */
static void gxip_part_sums(const double *lambdas, const uint32_t *triangles, size_t triangle_count,
                           const gxip_span *span, unsigned k, gxi_moments2 *reference) {
    double p[3][3], lower[3], upper[3];
    unsigned axes[3], i;
    gxi_moments2 m;
    size_t t;
    gxi_part_axes(k, axes);
    memset(&m, 0, sizeof m);
    for (t = 0; t < triangle_count; t++) {
        for (i = 0; i < 3; i++) gxip_part_corner(lambdas + 4 * (size_t)triangles[3 * t + i], axes, p[i]);
        gxi_moments2_add_triangle(&m, p[0], p[1], p[2]);
    }
    gxip_part_corner(span->lower, axes, lower);
    gxip_part_corner(span->upper, axes, upper);
    gxi_moments2_repair(&m, lower, upper);
    gxip_limit_sum(&m, lower, span->largest_sum[k]);
    *reference = m;
}

GXFEM_API gx_result gxi_part_moments(const double *lambdas, size_t lambda_count, const uint32_t *triangles,
                                     size_t triangle_count, unsigned *k, gxi_moments2 *reference) {
    unsigned vertex = 0, i;
    gxip_span span;
    gx_result result;
    if (!lambdas || !triangles || !k || !reference) return GX_ERROR_ARGUMENT;
    if (lambda_count == 0 || triangle_count == 0) return GX_ERROR_EMPTY;
    result = gxip_part_span(lambdas, lambda_count, triangles, triangle_count, &span);
    if (result != GX_OK) return result;
    for (i = 1; i < 4; i++)
        if (span.sum[i] > span.sum[vertex]) vertex = i;
    gxip_part_sums(lambdas, triangles, triangle_count, &span, vertex, reference);
    *k = vertex;
    return GX_OK;
}

GXFEM_API gx_result gxi_part_moments_at(const double *lambdas, size_t lambda_count, const uint32_t *triangles,
                                        size_t triangle_count, unsigned k, gxi_moments2 *reference) {
    double vertex[4] = {0, 0, 0, 0};
    gxip_span span;
    gx_result result;
    if (!lambdas || !triangles || k > 3 || !reference) return GX_ERROR_ARGUMENT;
    if (lambda_count == 0 || triangle_count == 0) return GX_ERROR_EMPTY;
    result = gxip_part_span(lambdas, lambda_count, triangles, triangle_count, &span);
    if (result != GX_OK) return result;
    vertex[k] = 1;
    (void)gxip_span_add(&span, vertex, 0);
    gxip_part_sums(lambdas, triangles, triangle_count, &span, k, reference);
    return GX_OK;
}

/* With a, b the frame's axes, f and S its first and second moments, and lambda_k = 1 - sum of lambda_a:
       lambda_a lambda_b: S_ab
       lambda_k lambda_a: f_a - sum_b S_ab
       lambda_k lambda_k: volume - sum_a (2 f_a - sum_b S_ab) */
GXFEM_API void gxi_part_mass(const gxi_moments2 *reference, unsigned k, double element_volume, double density,
                             double mass[10]) {
    double scale = 6 * element_volume * density, corner = reference->volume;
    unsigned axes[3];
    size_t a, b;
    gxi_part_axes(k, axes);
    for (a = 0; a < 3; a++) {
        double row = 0;
        for (b = 0; b < 3; b++) {
            double s = reference->second[gxip_packed3(a, b)];
            mass[gxip_packed4(axes[a], axes[b])] = scale * s;
            row += s;
        }
        mass[gxip_packed4(k, axes[a])] = scale * (reference->first[a] - row);
        corner -= 2 * reference->first[a] - row;
    }
    mass[gxip_packed4(k, k)] = scale * corner;
}

GXFEM_API void gxi_part_load(const gxi_moments2 *reference, unsigned k, double element_volume, double density,
                             double load[4]) {
    double scale = 6 * element_volume * density;
    unsigned axes[3];
    int a;
    gxi_part_axes(k, axes);
    load[k] = scale * (reference->volume - (reference->first[0] + reference->first[1] + reference->first[2]));
    for (a = 0; a < 3; a++) load[axes[a]] = scale * reference->first[a];
}

GXFEM_API double gxi_triangle_area(const double a[3], const double b[3], const double c[3], double area_vector[3]) {
    int d;
    gxip_double_area(a, b, c, area_vector);
    for (d = 0; d < 3; d++) area_vector[d] /= 2;
    return gxip_length(area_vector);
}

GXFEM_API void gxi_face_load_add(const double a[4], const double b[4], const double c[4], double area, double load[4]) {
    int i;
    for (i = 0; i < 4; i++) load[i] += area / 3 * (a[i] + b[i] + c[i]);
}

/* Over a triangle: integral of y z = area/12 (sum over the corners of y z + (sum of y)(sum of z)) for linear y, z. */
GXFEM_API void gxi_face_mass_add(const double a[4], const double b[4], const double c[4], double area,
                                 double mass[10]) {
    double s[4];
    size_t i, j, entry = 0;
    for (i = 0; i < 4; i++) s[i] = a[i] + b[i] + c[i];
    for (i = 0; i < 4; i++)
        for (j = i; j < 4; j++) mass[entry++] += area / 12 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
}

#undef GXIP_ROUNDING
#undef GXIP_LAMBDA_MAX
#undef GXIP_FEW
#undef GXIP_COLD
#undef GXIP_EXPONENT_MAX
#if defined(GXFEM_SMALL) && defined(__clang__)
#pragma clang attribute pop
#endif
#ifdef GXFEM_SCALAR
#pragma clang attribute pop
#endif
#ifdef __cplusplus
}
#endif
#endif /* GXFEM_INTEGRATE_IMPLEMENTED */
